/* textures HEAD.glb [FRAMES] - what the pictures of a head cost: the same head is drawn with them
 * and without, in turn, so that a busy machine is busy for both; prints the median of each, the
 * ratio of each pair's, and how long both took to get ready. At most 1.5 is promised for the median
 * ratio (software renderer); exits 1 where it is more. */
#include "base/clock.h"
#include "draw/draw.h"
#include "io/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 640, HEIGHT = 480, FRAMES_MAX = 1000 };
static const double ratio_max = 1.5;

static int compare(const void *left, const void *right)
{
    const double *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

static double median(double *value, size_t count)
{
    qsort(value, count, sizeof *value, compare);
    return value[count / 2];
}

/* The upper part of whatever it is: where a head is. */
static draw_camera camera_of(const mesh *m)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    float height = high[1] - low[1], depth = high[2] - low[2];
    if (height > 3.0f * depth) { /* a whole body */
        low[1] = high[1] - 0.2f * height;
        low[0] = -0.1f * height;
        high[0] = 0.1f * height;
    }
    return draw_camera_framing(low, high, (float)WIDTH / HEIGHT);
}

static double draw_ms(draw_renderer *renderer, draw_target *target, const draw_face *face,
                      const draw_camera *camera, uint8_t *pixels)
{
    int64_t start_ns = clock_now_ns();
    draw_render(renderer, target, face, camera, 0, 0, WIDTH, HEIGHT);
    draw_read(target, pixels);
    return (double)(clock_now_ns() - start_ns) / 1e6;
}

static mrt_result run(mesh *m, size_t frame_count, double *out_ratio, error *err)
{
    static uint8_t pixels[WIDTH * HEIGHT * 4];
    static double with_ms[FRAMES_MAX], without_ms[FRAMES_MAX], ratio[FRAMES_MAX];
    mrt_result result = MRT_ERR_UNSUPPORTED;
    draw_context *context = draw_context_create(err);
    draw_target *target = context ? draw_target_create(WIDTH, HEIGHT, err) : NULL;
    draw_renderer *renderer = target ? draw_renderer_create(err) : NULL;
    draw_face *with = renderer ? draw_face_create(m, err) : NULL, *without = NULL;
    draw_camera camera = camera_of(m);
    for (uint32_t i = 0; i < m->material_count; ++i) {
        mesh_material *look = &m->material[i];
        look->base.image = look->normal.image = look->emission.image = look->surface.image = 0;
        look->metallic = 0.0f; /* its picture said where */
    }
    if (with)
        without = draw_face_create(m, err);
    if (without) {
        for (size_t i = 0; i < 3; ++i) { /* what is compiled and made when it is first drawn */
            (void)draw_ms(renderer, target, with, &camera, pixels);
            (void)draw_ms(renderer, target, without, &camera, pixels);
        }
        for (size_t i = 0; i < frame_count; ++i) {
            with_ms[i] = draw_ms(renderer, target, with, &camera, pixels);
            without_ms[i] = draw_ms(renderer, target, without, &camera, pixels);
            ratio[i] = with_ms[i] / without_ms[i];
        }
        *out_ratio = median(ratio, frame_count);
        printf("%s: %zu frames of %d x %d: %.1f ms with pictures, %.1f ms without; ratio %.2f\n",
               draw_context_driver(context), frame_count, WIDTH, HEIGHT,
               median(with_ms, frame_count), median(without_ms, frame_count), *out_ratio);
        result = MRT_OK;
    }
    draw_face_destroy(with);
    draw_face_destroy(without);
    draw_renderer_destroy(renderer);
    draw_target_destroy(target);
    draw_context_destroy(context);
    return result;
}

int main(int argc, char **argv)
{
    error err = {""};
    mesh m = {0};
    double ratio = 0.0;
    long frame_count = argc == 3 ? strtol(argv[2], NULL, 10) : 60;
    if (argc < 2 || argc > 3 || frame_count < 1 || frame_count > FRAMES_MAX) {
        fprintf(stderr, "usage: textures HEAD.glb [FRAMES]\n");
        return 2;
    }
    mrt_result result = mesh_file_read(&m, argv[1], NULL, &err);
    if (result >= 0)
        result = run(&m, (size_t)frame_count, &ratio, &err);
    mesh_destroy(&m);
    if (result < 0)
        fprintf(stderr, "%s\n", err.text);
    return result < 0 || ratio > ratio_max;
}
