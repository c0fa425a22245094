/* What the constraints of a rig cost: face_cost NAME.rig.json
 * Prints the time of an engagement and of a frame with the rig, and of the same controls on the
 * same mesh without one; medians. Not a test: a clock decides nothing here. */
#include "base/clock.h"
#include "face/face.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 301, ENGAGEMENTS = 21 };

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_size);
    return value[count / 2];
}

static double ms_since(int64_t start_ns)
{
    return (double)(clock_now_ns() - start_ns) * 1e-6;
}

typedef struct cost {
    double engage_ms, frame_ms;
    uint32_t column_count;
} cost;

/* A talking jaw and controls that wander by up to 4 mm. */
static void aim(double *end, float *dof, const face_control *control, const bones *b,
                uint32_t count, int frame)
{
    for (uint32_t i = 0; i < b->dof_count; ++i) {
        int phase = (frame * (int)(i + 3)) % 41;
        dof[i] = b->dof[i].min + (b->dof[i].max - b->dof[i].min) * (float)phase / 41.0f;
    }
    for (uint32_t k = 0; k < count; ++k) {
        end[3 * k] = control[k].start.x + 0.1 * (double)((frame * 7 + (int)k) % 40);
        end[3 * k + 1] = control[k].start.y - 0.1 * (double)((frame * 3 + (int)k) % 40);
        end[3 * k + 2] = control[k].start.z + 0.1 * (double)((frame * 5 + (int)k) % 20);
    }
}

static mrt_result measure(cost *out, face *f, const csrbf_settings *settings,
                          const face_control *control, uint32_t count, error *err)
{
    static double engage_ms[ENGAGEMENTS], frame_ms[FRAMES];
    double end[MRT_MAX_VECTORS * 3];
    float dof[MRT_MAX_DOFS];
    mrt_result result = MRT_OK;
    for (int i = 0; i < ENGAGEMENTS && result >= 0; ++i) {
        int64_t start_ns = clock_now_ns();
        result = face_engage(f, settings, control, count, err);
        engage_ms[i] = ms_since(start_ns);
    }
    for (int i = 0; i < FRAMES && result >= 0; ++i) {
        aim(end, dof, control, face_bones(f), count, i);
        int64_t start_ns = clock_now_ns();
        result = face_pull(f, end, dof, err);
        frame_ms[i] = ms_since(start_ns);
    }
    out->engage_ms = median(engage_ms, ENGAGEMENTS);
    out->frame_ms = median(frame_ms, FRAMES);
    out->column_count = face_columns_now(f).count;
    return result;
}

static void print_cost(const char *what, const cost *c)
{
    printf("%s: %u columns, engaging %.2f ms, a frame %.3f ms\n", what, c->column_count,
           c->engage_ms, c->frame_ms);
}

static mrt_result compare(const face_file *file, error *err)
{
    face *with = NULL, *without = NULL;
    face_control control[MRT_MAX_VECTORS], point[MRT_MAX_VECTORS];
    cost rigged = {0}, plain = {0};
    csrbf_settings settings = file->rig->solver;
    if (!(settings.radius > 0.0))
        settings.radius = 60.0;
    int64_t start_ns = clock_now_ns();
    mrt_result result =
        face_create(&with, file->rig, &file->mesh, &file->topology, MRT_MAX_VECTORS, err);
    if (result >= 0)
        printf("%u vertices, %u bones, %u contacts, R = %g mm; bound in %.0f ms\n",
               file->mesh.vertex_count, file->rig->bone_count, file->rig->contact_count,
               settings.radius, ms_since(start_ns));
    if (result >= 0)
        result = face_create(&without, NULL, &file->mesh, &file->topology, MRT_MAX_VECTORS, err);
    uint32_t count = 0;
    if (result >= 0) {
        const mrt_contact *contact = face_contacts(with, &count);
        count = count < MRT_MAX_VECTORS ? count : MRT_MAX_VECTORS;
        for (uint32_t i = 0; i < count; ++i) {
            mrt_vec3 at = contact[i].rest;
            control[i] = (face_control){{(double)at.x, (double)at.y, (double)at.z}, 1 + i};
            point[i] = (face_control){control[i].start, 0};
        }
        result = measure(&plain, without, &settings, point, count, err);
    }
    if (result >= 0)
        result = measure(&rigged, with, &settings, control, count, err);
    if (result >= 0) {
        print_cost("without the rig", &plain);
        print_cost("with the rig", &rigged);
        printf("a frame with constraints costs %.2f x a frame without\n",
               rigged.frame_ms / plain.frame_ms);
    }
    face_destroy(with);
    face_destroy(without);
    return result;
}

int main(int argc, char **argv)
{
    error err = {""};
    face_file file = {0};
    if (argc != 2) {
        fprintf(stderr, "usage: face_cost NAME.rig.json\n");
        return 2;
    }
    mrt_result result = face_file_read(&file, argv[1], NULL, FACE_FILE_USABLE, &err);
    if (result >= 0 && !file.rig)
        result = error_set(&err, MRT_ERR_ARGUMENT, "%s: expected a rig", argv[1]);
    if (result >= 0)
        result = compare(&file, &err);
    face_file_destroy(&file);
    if (result < 0)
        fprintf(stderr, "%s\n", err.text);
    return result < 0;
}
