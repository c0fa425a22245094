/* The glTF file that a face was read from, as the export carries it over: whatever it says, the
 * export ends with a file or with a reason. What is written is read again, has the same surface and
 * no fewer targets. */
#include "fuzz_glb.h"
#include "fuzz_mesh.h"

#include "io/export.h"

#include <unistd.h>

enum { PATH_TEXT = 128, VERTICES_MAX = 3000, FRAMES = 3 };
static char folder[64], out[PATH_TEXT];

static void path_in(char path[PATH_TEXT], const char *name)
{
    (void)snprintf(path, PATH_TEXT, "%s/%s", folder, name);
}

static void remove_all(void)
{
    static const char *const all[] = {"head.glb", "head.gltf", "out.glb", ""};
    char path[PATH_TEXT];
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        path_in(path, all[i]);
        (void)remove(path);
    }
}

static void make_folder(void)
{
    if (folder[0])
        return;
    strcpy(folder, access("/dev/shm", W_OK) == 0 ? "/dev/shm/marotte_fuzz_XXXXXX"
                                                 : "/tmp/marotte_fuzz_XXXXXX");
    fuzz_mesh_require(mkdtemp(folder) != NULL, "a folder");
    path_in(out, "out.glb");
    (void)atexit(remove_all);
}

/* Each vertex moves, the first of the file's own targets is played, a bone turns. */
static clip *perform(const mesh *m)
{
    error err = {""};
    size_t count = (size_t)m->vertex_count * 3;
    float *shape = malloc(count * sizeof *shape);
    clip *c = clip_create(m, 30.0, "/dev/shm", &err);
    char bone[] = "jaw", unit[] = "";
    fuzz_mesh_require(shape && c, "memory");
    clip_curve curve = {.unit = unit, .max = 1.0, .is_own = true};
    if (m->target_count > 0) {
        curve.name = m->target[0].name;
        curve.at_max = m->target[0].offset;
        fuzz_mesh_require(clip_add_curve(c, &curve, &err) >= 0, "the curve of a target");
    }
    fuzz_mesh_require(clip_add_bone(c, &(clip_bone){bone, CLIP_NO_BONE, {0, 1, 2}}, &err) >= 0,
                      "a bone");
    for (int frame = 0; frame < FRAMES; ++frame) {
        const double part = 0.5 * frame, pose[7] = {0, 0, 0, 1, frame, 1, 2};
        for (size_t i = 0; i < count; ++i)
            shape[i] = m->position[i] + (float)(frame * (i % 7 == 0));
        fuzz_mesh_require(clip_add_free(c, shape, &err) >= 0, "a frame");
        fuzz_mesh_require(clip_add_named(c, &part, NULL, &err) >= 0, "the values of a frame");
        fuzz_mesh_require(clip_add_pose(c, pose, &err) >= 0, "the pose of a frame");
    }
    free(shape);
    return c;
}

static void check_export(const mesh *m, const gltf_report *report)
{
    error err = {""};
    mesh again;
    if (mesh_file_read(&again, out, NULL, &err) < 0)
        fuzz_mesh_require(false, err.text);
    fuzz_mesh_require(again.vertex_count == m->vertex_count, "as many vertices");
    fuzz_mesh_require(again.triangle_count == m->triangle_count, "as many triangles");
    if (!report->why_bare.text[0])
        fuzz_mesh_require(again.target_count >= m->target_count, "no fewer targets");
    mesh_destroy(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char path[PATH_TEXT];
    mesh m;
    error err = {""};
    gltf_report report;
    make_folder();
    path_in(path, size > 0 && data[0] == 'g' ? "head.glb" : "head.gltf");
    FILE *file = fopen(path, "wb");
    fuzz_mesh_require(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "a file");
    if (mesh_file_read(&m, path, NULL, &err) < 0)
        return 0;
    if (m.vertex_count <= VERTICES_MAX) {
        clip *c = perform(&m);
        if (gltf_write(out, c, NULL, NULL, &report, &err) >= 0)
            check_export(&m, &report);
        else
            fuzz_mesh_require(fuzz_is_reason(err.text), "one line of reason");
        clip_destroy(c);
    }
    mesh_destroy(&m);
    return 0;
}
