/* gltf_samples FOLDER: writes one .glb of each kind that the exporters know, for a validator. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "io/mesh_file.h"
#include "unit/export_scene.h"

static const char *folder;
static int failures;

static void say(const char *name, mrt_result result, const error *err)
{
    if (result == MRT_OK)
        return;
    (void)fprintf(stderr, "%s: %s\n", name, err->text);
    ++failures;
}

static void write_mesh(const char *name, const mesh *m)
{
    char path[512];
    error err = {""};
    scene_path(path, sizeof path, folder, name);
    say(name, gltf_write_mesh(path, m, &err), &err);
}

static void write_clip(const char *name, const clip *c)
{
    char path[512];
    error err = {""};
    scene_path(path, sizeof path, folder, name);
    say(name, gltf_write(path, c, NULL, NULL, NULL, &err), &err);
}

static void sample_meshes(void)
{
    mesh m = scene_sheet(12);
    write_mesh("plain.glb", &m);
    m.material[0] = (mesh_material){.name = m.material[0].name,
                                    .base_colour = {1.0f, 1.0f, 1.0f, 0.5f},
                                    .roughness = 1.0f,
                                    .metallic = 1.0f};
    scene_name(&m.material[0].name, "");
    m.attribute = calloc(4, sizeof *m.attribute);
    for (uint32_t i = 0; i < 4; ++i) {
        m.attribute[i].component_count = i + 1;
        m.attribute[i].value = calloc((size_t)m.vertex_count * (i + 1), sizeof(float));
        scene_name(&m.attribute[i].name, i < 2 ? "_SAME" : "unmarked");
    }
    m.attribute_count = 4;
    m.target = calloc(2, sizeof *m.target);
    for (uint32_t i = 0; i < 2; ++i) {
        m.target[i].offset = calloc((size_t)m.vertex_count * 3, sizeof(float));
        scene_name(&m.target[i].name, i ? "\xFF not UTF-8" : "");
    }
    m.target[1].offset[33] = 4.0f;
    m.target_count = 2;
    write_mesh("targets.glb", &m);
    m.triangle_count = m.part_count = 0;
    write_mesh("points.glb", &m);
    m.part_count = 2; /* mesh_destroy frees both */
    mesh_destroy(&m);
}

static void sample_degenerate(void)
{
    error err;
    mesh m;
    if (mesh_create(&m, 5, 2, &err) != MRT_OK)
        return;
    const uint32_t triangle[6] = {0, 1, 1, 2, 2, 2};
    memcpy(m.triangle, triangle, sizeof triangle);
    m.position[3] = 10.0f;
    write_mesh("degenerate.glb", &m);
    mesh_destroy(&m);
}

static void sample_clips(void)
{
    error err;
    mesh m = scene_sheet(24);
    float *base = malloc((size_t)m.vertex_count * 3 * sizeof *base);
    clip *c = clip_create(&m, 60.0, NULL, &err);
    scene_begin_segment(c, m.position, &err);
    scene_add_anchored(c, 1, 0.5);
    write_clip("one_frame.glb", c);
    scene_add_anchored(c, 30, 0.5);
    say("read", clip_read(c, 30, base, &err), &err);
    scene_begin_segment(c, base, &err);
    scene_add_anchored(c, 30, 1.5);
    write_clip("anchored.glb", c);
    scene_add_free(c, 200, 0.0, 3);
    write_clip("mixed.glb", c);
    clip_destroy(c);
    c = clip_create(&m, 29.97, NULL, &err);
    scene_add_free(c, 300, 0.0, 4);
    write_clip("free.glb", c);
    clip_destroy(c);
    mesh_destroy(&m);
    free(base);
}

/* A motion long enough to be split into windows of time. */
static void sample_windows(void)
{
    char path[512];
    error err = {""};
    gltf_report report = {0};
    mesh m = scene_sheet(24);
    clip *c = scene_clay(&m, 1200, 600);
    scene_path(path, sizeof path, folder, "windows.glb");
    say("windows.glb", gltf_write(path, c, NULL, NULL, &report, &err), &err);
    if (report.window_count < 2) {
        (void)fprintf(stderr, "windows.glb: %u windows, expected several\n", report.window_count);
        ++failures;
    }
    clip_destroy(c);
    mesh_destroy(&m);
}

/* A face of many parts that another tool made. */
static void sample_shared_face(void)
{
    char path[512];
    error err = {""};
    mesh m;
    const char *shared = getenv("MAROTTE_SHARED");
    (void)snprintf(path, sizeof path, "%s/data/faces/ict_face.glb",
                   shared ? shared : SOURCE_DIR "/../shared");
    if (access(path, R_OK) != 0) {
        (void)printf("without the ICT face: %s is not there\n", path);
        return;
    }
    if (mesh_file_read(&m, path, NULL, &err) != MRT_OK) {
        say(path, MRT_ERR_FORMAT, &err);
        return;
    }
    write_mesh("ict_face.glb", &m);
    mesh_destroy(&m);
}

int main(int argument_count, char **arguments)
{
    if (argument_count != 2) {
        (void)fprintf(stderr, "usage: gltf_samples FOLDER\n");
        return 2;
    }
    folder = arguments[1];
    sample_meshes();
    sample_degenerate();
    sample_clips();
    sample_windows();
    sample_shared_face();
    return failures ? 1 : 0;
}
