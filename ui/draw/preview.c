/* draw_preview MESH OUT.png [yaw_deg pitch_deg]... : draws a mesh file from several sides into one
 * picture, for people who model faces. */
#include "draw/offscreen.h"
#include "io/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VIEWS_MAX = 8, VIEW_WIDTH = 640, VIEW_HEIGHT = 800 };

typedef struct view_angles {
    float yaw_deg, pitch_deg;
} view_angles;

static bool read_angle(const char *word, float *out)
{
    char *end;
    double value = strtod(word, &end);
    *out = (float)value;
    return end != word && *end == '\0' && value >= -360.0 && value <= 360.0;
}

/* Returns 0 for wrong usage. */
static uint32_t read_views(int argc, char **argv, view_angles out[VIEWS_MAX])
{
    static const view_angles usual[4] = {
        {0.0f, 0.0f}, {35.0f, 8.0f}, {90.0f, 0.0f}, {180.0f, 0.0f}};
    if (argc == 0) {
        memcpy(out, usual, sizeof usual);
        return 4;
    }
    if (argc % 2 != 0 || argc > 2 * VIEWS_MAX)
        return 0;
    for (int i = 0; i < argc / 2; ++i)
        if (!read_angle(argv[2 * i], &out[i].yaw_deg) ||
            !read_angle(argv[2 * i + 1], &out[i].pitch_deg))
            return 0;
    return (uint32_t)argc / 2;
}

static void draw_views(const offscreen *on, const mesh *m, const view_angles *view,
                       uint32_t view_count)
{
    const float degree = 3.14159265f / 180.0f, ink[4] = {0.72f, 0.74f, 0.78f, 1.0f};
    float low[3], high[3];
    mesh_bounds(m, low, high);
    draw_camera camera = draw_camera_framing(low, high, (float)VIEW_WIDTH / VIEW_HEIGHT);
    for (uint32_t i = 0; i < view_count; ++i) {
        camera.yaw_rad = view[i].yaw_deg * degree;
        camera.pitch_rad = view[i].pitch_deg * degree;
        draw_render(on->renderer, on->target, on->face, &camera, i * VIEW_WIDTH, 0, VIEW_WIDTH,
                    VIEW_HEIGHT);
        char label[64];
        snprintf(label, sizeof label, "yaw %g°  pitch %g°", (double)view[i].yaw_deg,
                 (double)view[i].pitch_deg);
        draw_text(on->renderer, on->target, label, (float)(i * VIEW_WIDTH) + 16.0f,
                  VIEW_HEIGHT - 36.0f, 20.0f, ink);
    }
}

static mrt_result draw_picture(const mesh *m, const char *path, const view_angles *view,
                               uint32_t view_count, error *err)
{
    offscreen on;
    mrt_result result = offscreen_init(&on, m, view_count * VIEW_WIDTH, VIEW_HEIGHT, err);
    if (result < 0)
        return result;
    draw_views(&on, m, view, view_count);
    result = offscreen_save(&on, path, err);
    offscreen_finish(&on);
    return result;
}

int main(int argc, char **argv)
{
    view_angles view[VIEWS_MAX] = {{0}};
    uint32_t view_count = argc >= 3 ? read_views(argc - 3, argv + 3, view) : 0;
    if (view_count == 0) {
        fprintf(stderr, "usage: draw_preview MESH OUT.png [yaw_deg pitch_deg]... (at most %d)\n",
                VIEWS_MAX);
        return 2;
    }
    error err = {{0}};
    mesh m;
    if (mesh_file_read(&m, argv[1], NULL, &err) != MRT_OK) {
        fprintf(stderr, "draw_preview: %s\n", err.text);
        return 1;
    }
    if (m.note)
        fputs(m.note, stdout);
    mrt_result result = draw_picture(&m, argv[2], view, view_count, &err);
    mesh_destroy(&m);
    if (result != MRT_OK)
        fprintf(stderr, "draw_preview: %s\n", err.text);
    return result == MRT_OK ? 0 : 1;
}
