/* heads_apart FACE FRAMES.pc2: of a performance that was exported as a vertex cache, how far the
 * vertices of one point of the surface ever part, and how far what is rigid on a bone (teeth, eyes,
 * hair) is bent: the greatest change of a distance between two of its vertices. mm, two numbers. */
#include "face/bind.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct frames {
    FILE *file;
    uint32_t vertex_count, count;
    float *at; /* vertex_count by 3 */
} frames;

static bool open_frames(frames *f, const char *path, uint32_t vertex_count)
{
    struct {
        char magic[12];
        int32_t version, points;
        float start, rate;
        int32_t samples;
    } head;
    f->file = fopen(path, "rb");
    if (!f->file || fread(&head, sizeof head, 1, f->file) != 1 ||
        memcmp(head.magic, "POINTCACHE2", 12) != 0 || head.points != (int32_t)vertex_count)
        return false;
    *f = (frames){f->file, vertex_count, (uint32_t)head.samples,
                  malloc((size_t)vertex_count * 3 * sizeof(float))};
    return f->at != NULL;
}

static double distance(const float *at, uint32_t a, uint32_t b)
{
    double square = 0.0;
    for (size_t i = 0; i < 3; ++i) {
        double d = (double)at[3 * (size_t)a + i] - (double)at[3 * (size_t)b + i];
        square += d * d;
    }
    return sqrt(square);
}

int main(int argc, char **argv)
{
    enum { PAIRS = 4000 };
    face_file face;
    bind_marks marks;
    frames f;
    error err = {""};
    if (argc != 3 || face_file_read(&face, argv[1], NULL, FACE_FILE_USABLE, &err) < 0 ||
        !face.rig || bind_marks_create(&marks, face.rig, &face.mesh, &face.topology, &err) < 0 ||
        !open_frames(&f, argv[2], face.mesh.vertex_count)) {
        fprintf(stderr, "heads_apart FACE FRAMES.pc2: %s\n", err.text);
        return 2;
    }
    const mesh *m = &face.mesh;
    uint32_t last[RIG_BONES_MAX], pair_count = 0;
    static uint32_t pair[PAIRS][2];
    memset(last, 0xff, sizeof last);
    for (uint32_t v = 0; v < m->vertex_count && pair_count < PAIRS;
         v += 1 + m->vertex_count / PAIRS) {
        uint32_t bone = marks.rigid_bone[v];
        if (bone == RIG_NONE)
            continue;
        if (last[bone] != UINT32_MAX) {
            pair[pair_count][0] = last[bone];
            pair[pair_count++][1] = v;
        }
        last[bone] = v;
    }
    double parted_mm = 0.0, bent_mm = 0.0;
    for (uint32_t i = 0; i < f.count; ++i) {
        if (fread(f.at, 3 * sizeof(float), f.vertex_count, f.file) != f.vertex_count)
            break;
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            parted_mm = fmax(parted_mm, distance(f.at, v, mesh_point(m, v)));
        for (uint32_t k = 0; k < pair_count; ++k)
            bent_mm = fmax(bent_mm, fabs(distance(f.at, pair[k][0], pair[k][1]) -
                                         distance(m->position, pair[k][0], pair[k][1])));
    }
    printf("%.4f %.4f\n", parted_mm, bent_mm);
    fclose(f.file);
    free(f.at);
    bind_marks_destroy(&marks);
    face_file_destroy(&face);
    return 0;
}
