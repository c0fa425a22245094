/* closed_moai.h - a head without a mouth to open. */
#ifndef MAROTTE_TESTS_UNIT_CLOSED_MOAI_H
#define MAROTTE_TESTS_UNIT_CLOSED_MOAI_H
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The Moai without its bag, its lips grown together and the groove between them filled. */
static inline void write_closed_moai(const char *path)
{
    face_file moai;
    error err = {""};
    if (face_file_read(&moai, SOURCE_DIR "/rigs/moai/moai.glb", NULL, FACE_FILE_ANY, &err) < 0)
        fail_msg("%s", err.text);
    const mesh *m = &moai.mesh;
    assert_string_equal(m->part[m->part_count - 1].name, "mouth");
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const float *p = m->position + (size_t)3 * v;
        const double x = (double)p[0], y = (double)p[1], z = (double)p[2];
        const bool is_mouth = fabs(x) < 55.0 && fabs(y + 64.0) < 16.0 && z > 20.0;
        (void)fprintf(file, "v %.9g %.9g %.9g\n", x, y,
                      is_mouth ? fmax(z, 59.5 - 0.006 * x * x) : z);
    }
    for (uint32_t i = 0; i < 3 * m->part[m->part_count - 1].first_triangle; ++i) {
        const float *p = m->position + (size_t)3 * m->triangle[i];
        uint32_t v = 0;
        while (memcmp(p, m->position + (size_t)3 * v, 3 * sizeof *p) != 0)
            ++v;
        (void)fprintf(file, "%s%u%s", i % 3 ? " " : "f ", v + 1, i % 3 == 2 ? "\n" : "");
    }
    assert_int_equal(fclose(file), 0);
    face_file_destroy(&moai);
}

#endif
