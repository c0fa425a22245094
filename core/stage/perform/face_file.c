#include "stage/perform/face_file.h"

#include "base/file.h"
#include "base/installed.h"
#include "csrbf/points.h"
#include "face/face.h"
#include "face/face_weights.h"
#include "face/rig/rig_poses.h"
#include "face/rig_check.h"
#include "face/rig_draft.h"
#include "io/openmesh.h"
#include "mesh/cut.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the face");
}

static bool is_rig_path(const char *path)
{
    return strcmp(file_extension_of(path).text, "json") == 0;
}

static bool is_gltf_path(const char *path)
{
    const file_extension extension = file_extension_of(path);
    return strcmp(extension.text, "glb") == 0 || strcmp(extension.text, "gltf") == 0 ||
           strcmp(extension.text, "vrm") == 0;
}

/* Returns the frame in the rig. If it has no unit, the unit of the rig applies, but a glTF file is
 * always in metres. */
static mesh_frame frame_of_mesh(const rig *r)
{
    mesh_frame frame = r->frame;
    if (frame.mm_per_unit <= 0.0 && !is_gltf_path(r->mesh_path))
        frame.mm_per_unit = r->mm_per_unit;
    return frame;
}

static mrt_result read_rig(face_file *f, const char *path, error *err)
{
    f->rig = calloc(1, sizeof *f->rig);
    return f->rig ? rig_read(f->rig, path, err) : no_memory(err);
}

static mrt_result read_and_cut(mesh *out, const face_file *f, const char *path,
                               const mesh_frame *frame, error *err)
{
    mrt_result result = mesh_file_read(out, f->rig ? f->rig->mesh_path : path, frame, err);
    if (result < 0 && f->rig) {
        error_prefix(err, "$.mesh");
        error_prefix(err, path);
    }
    if (result >= 0 && f->rig && f->rig->cut_mouth) {
        result = mesh_cut_mouth(out, f->rig->cut_mouth, f->rig->cut_mouth_count, err);
        if (result < 0) {
            error_prefix(err, "$.cut_mouth");
            error_prefix(err, path);
            mesh_destroy(out);
        }
    }
    return result;
}

/* Older rigs of an OBJ count its vertices as written in the file, without the splits at texture
 * seams. Reads the mesh with the vertex count that the rig was made for. */
static mrt_result read_mesh(face_file *f, const char *path, const mesh_frame *frame, error *err)
{
    mesh_frame of_rig = f->rig ? frame_of_mesh(f->rig) : (mesh_frame){0};
    mrt_result result = read_and_cut(&f->mesh, f, path, f->rig ? &of_rig : frame, err);
    const uint32_t made_for = f->rig ? f->rig->mesh_vertex_count : 0;
    if (made_for == 0 || (result >= 0 && f->mesh.vertex_count == made_for) ||
        strcmp(file_extension_of(f->rig->mesh_path).text, "obj") != 0)
        return result;
    mesh written;
    error ignored = {""};
    of_rig.vertices = MESH_VERTICES_AS_WRITTEN;
    if (read_and_cut(&written, f, path, &of_rig, &ignored) < 0)
        return result;
    if (written.vertex_count != made_for) {
        mesh_destroy(&written);
        return result;
    }
    mesh_destroy(&f->mesh);
    f->mesh = written;
    return MRT_OK;
}

/* Checks that all coordinates are within the range of the engine. Reading has checked that they are
 * finite. */
static mrt_result check_reach(const mesh *m, const char *path, error *err)
{
    for (size_t i = 0; i < (size_t)3 * m->vertex_count; ++i)
        if (!(fabsf(m->position[i]) <= POINTS_REACH))
            return error_set(err, MRT_ERR_UNSUPPORTED,
                             "%s: vertex %zu: coordinate %g mm is not within +-%g mm. Scale the "
                             "mesh, or set --unit",
                             path, i / 3, (double)m->position[i], (double)POINTS_REACH);
    return MRT_OK;
}

static mrt_result validate(const face_file *f, const char *path, error *err)
{
    mrt_result result = rig_validate(f->rig, &f->mesh, &f->topology, err);
    if (result < 0)
        error_prefix(err, path);
    return result;
}

static void note_unused_shapes(face_file *f)
{
    uint32_t count = f->mesh.target_count, used_count = face_shapes_of(&f->mesh);
    if (!f->rig || used_count == count)
        return;
    if (used_count > 0)
        mesh_note(&f->mesh, "%s: the mesh has %u shapes; only the first %u are used",
                  f->rig->mesh_path, count, used_count);
    else
        mesh_note(&f->mesh,
                  "%s: %u shapes of %u vertices need more than 1 GiB. They are skipped, "
                  "and the face performs without shapes",
                  f->rig->mesh_path, count, f->mesh.vertex_count);
}

static mrt_result note_unsealed_lips(face_file *f, error *err)
{
    char fault[BIND_FAULT] = "";
    mrt_result result = MRT_OK;
    if (f->rig)
        result = bind_lips_fault(fault, f->rig, &f->mesh, &f->topology, err);
    if (fault[0])
        mesh_note(&f->mesh, "%s: $.mouth: %s; the face performs, but its lips are not sealed",
                  f->rig->path, fault);
    return result;
}

static mrt_result join_notes(face_file *f, error *err)
{
    const char *from_rig = f->rig && f->rig->note ? f->rig->note : "";
    const char *from_mesh = f->mesh.note ? f->mesh.note : "";
    size_t size = strlen(from_rig) + strlen(from_mesh) + 1;
    if (size == 1)
        return MRT_OK;
    f->note = malloc(size);
    if (!f->note)
        return no_memory(err);
    (void)snprintf(f->note, size, "%s%s", from_rig, from_mesh);
    return MRT_OK;
}

mrt_result face_file_read(face_file *out, const char *path, const mesh_frame *frame,
                          face_file_strictness strictness, error *err)
{
    *out = (face_file){0};
    mrt_result result = installed_check(INSTALLED_FACE, path, err);
    if (result >= 0 && is_rig_path(path))
        result = read_rig(out, path, err);
    if (result >= 0)
        result = read_mesh(out, path, frame, err);
    if (result >= 0)
        result = check_reach(&out->mesh, out->rig ? out->rig->mesh_path : path, err);
    if (result >= 0)
        result = openmesh_topology(&out->topology, &out->mesh, err);
    if (result >= 0 && out->rig && strictness == FACE_FILE_USABLE)
        result = validate(out, path, err);
    if (result >= 0 && out->rig)
        bind_focus(&out->mesh, out->rig, &out->topology);
    if (result >= 0)
        note_unused_shapes(out);
    if (result >= 0)
        result = note_unsealed_lips(out, err);
    if (result >= 0)
        result = join_notes(out, err);
    if (result < 0)
        face_file_destroy(out);
    return result;
}

mrt_result face_file_cut_mouth(face_file *f, const uint32_t *chain, uint32_t count, error *err)
{
    topology cut = {0};
    mrt_result result = mesh_cut_mouth(&f->mesh, chain, count, err);
    if (result >= 0)
        result = openmesh_topology(&cut, &f->mesh, err);
    if (result < 0)
        return result;
    topology_destroy(&f->topology);
    f->topology = cut;
    free(f->note);
    f->note = NULL;
    return join_notes(f, err);
}

/* Adds the puppet's poses to a rig (rig_poses_transfer). f: a face of r, whose mesh is m. */
static mrt_result carry_poses(rig *r, const mesh *m, const face *f, error *err)
{
    face_file model;
    char *path = installed_path(INSTALLED_FACE, "puppet");
    mrt_result result =
        path ? face_file_read(&model, path, NULL, FACE_FILE_USABLE, err) : no_memory(err);
    free(path);
    if (result < 0)
        return result;
    if (model.rig)
        result = rig_poses_transfer(r, m, f, model.rig, &model.mesh, &model.topology, err);
    face_file_destroy(&model);
    return result;
}

static mrt_result add_poses(rig *r, const mesh *m, const topology *t, error *err)
{
    rig_poses_stage stage;
    const uint32_t first = r->pose_count;
    mrt_result result = rig_poses_stage_init(&stage, r, m, t, err);
    if (result < 0)
        return result;
    result = carry_poses(r, m, stage.face, err);
    if (result >= 0)
        result = rig_poses_reduce(r, first, &stage, err);
    rig_poses_stage_finish(&stage);
    while (result < 0 && r->pose_count > first)
        rig_pose_finish(&r->pose[--r->pose_count]);
    return result;
}

/* Stores in the rig the unit and axes with which the mesh was read, so that it is read the same way
 * again. */
static void keep_frame(rig *r, const mesh *m, const char *mesh_path)
{
    const bool is_gltf = is_gltf_path(mesh_path);
    double mm = m->mm_per_unit;
    bool is_named = mm == 1.0 || mm == 10.0 || mm == 1000.0;
    if (!is_named)
        r->mm_per_unit = 1.0; /* the numbers of a rig are in a named unit: mm, cm or m */
    if (!is_named || (is_gltf && mm != 1000.0))
        r->frame.mm_per_unit = mm;
    if (m->up != MESH_AXIS_Y || m->forward != MESH_AXIS_Z) {
        r->frame.up = m->up;
        r->frame.forward = m->forward;
    }
}

static mrt_result add_line(char **text, const char *prefix, const char *reason, error *err)
{
    const size_t used = *text ? strlen(*text) : 0,
                 size = used + strlen(prefix) + strlen(reason) + 2;
    char *longer = realloc(*text, size);
    if (!longer)
        return no_memory(err);
    (void)snprintf(longer + used, size - used, "%s%s\n", prefix, reason);
    *text = longer;
    return MRT_OK;
}

mrt_result face_file_draft(rig *out, char **out_confirm, const mesh *m, const topology *t,
                           const char *mesh_path, const uint32_t *cut_mouth, uint32_t cut_count,
                           error *err)
{
    error reason = {""};
    mrt_result result =
        rig_draft_make(out, out_confirm, m, t, mesh_path, cut_mouth, cut_count, err);
    if (result < 0)
        return result;
    keep_frame(out, m, mesh_path);
    if (add_poses(out, m, t, &reason) < 0)
        result = add_line(out_confirm, "poses: ", reason.text, err);
    if (result < 0) {
        rig_destroy(out);
        free(*out_confirm);
        *out_confirm = NULL;
    }
    return result;
}

/* own: a copy of the rig, or NULL. It gets more poses. */
static mrt_result find_weights(face_weights **out, const face_file *f, rig *own, error *err)
{
    binding bound = {0};
    face *performed = NULL;
    mrt_result result = f->bound ? binding_copy(&bound, f->bound, own ? own->contact_count : 0, err)
                                 : binding_create(&bound, own, &f->mesh, &f->topology, err);
    if (result >= 0)
        result = face_create_shaped(&performed, own, &f->mesh, &bound, MRT_MAX_VECTORS, err);
    if (result >= 0 && own) {
        const csrbf_settings solver = rig_poses_solver(own, &f->mesh);
        error ignored = {""}; /* only fewer names */
        if (carry_poses(own, &f->mesh, performed, &ignored) < 0)
            ignored.text[0] = '\0';
        face_set_shapes(performed, own->shapes);
        result = rig_poses_complete(own, 0, performed, &solver, err);
    }
    if (result >= 0)
        result = face_weights_create(out, performed, f->rig, &f->mesh, err);
    face_destroy(performed);
    return result;
}

mrt_result face_file_weights(face_weights **out, const face_file *f, error *err)
{
    rig own = {0};
    *out = NULL;
    if (!f->rig)
        return find_weights(out, f, NULL, err);
    mrt_result result = rig_copy(&own, f->rig, err);
    if (result < 0)
        return result;
    result = find_weights(out, f, &own, err);
    rig_destroy(&own);
    return result;
}

void face_file_destroy(face_file *f)
{
    if (!f)
        return;
    rig_destroy(f->rig);
    free(f->rig);
    mesh_destroy(&f->mesh);
    topology_destroy(&f->topology);
    if (f->bound)
        binding_destroy(f->bound);
    free(f->bound);
    free(f->note);
    *f = (face_file){0};
}
