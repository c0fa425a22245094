/* How near the poses that a draft gets of a model, the puppet, come to a head's own shapes of the
 * same names: bench_carried HEAD MODEL.rig.json
 * The head is drafted without its shapes. Prints of each shape: the residual |a pose - shape| /
 * |shape| with the best factor a, the cosine between pose and shape, |pose| / |shape|, and the
 * root of the mean square of the shape in mm; then the means. Each is measured over the piece of
 * surface that the tip of the nose is on, by area. Shapes below 0.05 mm are left out. */
#include "face/rig/rig_poses.h"
#include "face/rig_draft.h"
#include "mesh/arkit.h"
#include "mesh/position.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double least_mm = 0.05;

typedef struct scene {
    face_file file, model;
    mesh bare; /* borrowed, without shapes */
    rig rig;
    rig_poses_stage stage;
    double *area;       /* vertex_count: mm2; 0 off the piece */
    float *shape, *jaw; /* vertex_count by 3, mm: a shape; the pose jawOpen */
} scene;

/* "browInnerUp_L" and "browInnerUp_R" are halves of browInnerUp. */
static bool is_part_of(const char *target, const char *pose)
{
    const size_t size = strlen(pose);
    return arkit_is_same_name(target, pose) ||
           (strncmp(target, pose, size) == 0 &&
            (strcmp(target + size, "_L") == 0 || strcmp(target + size, "_R") == 0));
}

static bool find_shape(scene *s, const char *pose)
{
    const mesh *m = &s->file.mesh;
    bool found = false;
    memset(s->shape, 0, (size_t)3 * m->vertex_count * sizeof *s->shape);
    for (uint32_t t = 0; t < m->target_count; ++t) {
        if (!is_part_of(m->target[t].name, pose))
            continue;
        found = true;
        for (size_t i = 0; i < (size_t)3 * m->vertex_count; ++i)
            s->shape[i] += m->target[t].offset[i];
    }
    return found;
}

static mrt_result weigh(scene *s, error *err)
{
    const mesh *m = &s->bare;
    const uint32_t nose = rig_find_contact(&s->rig, "nose.tip");
    uint32_t *piece = calloc(m->vertex_count + (size_t)1, sizeof *piece), count;
    mrt_result result = nose == RIG_NONE || !piece
                            ? error_set(err, MRT_ERR_ARGUMENT, "the draft found no nose")
                            : topology_pieces(piece, &count, m, &s->file.topology, err);
    for (uint32_t t = 0; t < m->triangle_count && result >= 0; ++t) {
        const uint32_t *v = m->triangle + (size_t)3 * t;
        if (piece[v[0]] != piece[s->rig.contact[nose].vertex])
            continue;
        const vec3 at = mesh_position(m, v[0]);
        const vec3 cross =
            vec3_cross(vec3_sub(mesh_position(m, v[1]), at), vec3_sub(mesh_position(m, v[2]), at));
        for (int k = 0; k < 3; ++k)
            s->area[v[k]] += vec3_length(cross) / 6.0;
    }
    free(piece);
    return result;
}

/* As face_file_draft does it, with a model that is named. */
static mrt_result draft(scene *s, const char *path, error *err)
{
    char *confirm = NULL;
    mrt_result result =
        rig_draft_make(&s->rig, &confirm, &s->bare, &s->file.topology, path, NULL, 0, err);
    free(confirm);
    if (result >= 0)
        result = rig_poses_stage_init(&s->stage, &s->rig, &s->bare, &s->file.topology, err);
    if (result >= 0)
        result = rig_poses_transfer(&s->rig, &s->bare, s->stage.face, s->model.rig, &s->model.mesh,
                                    &s->model.topology, err);
    return result < 0 ? result : rig_poses_reduce(&s->rig, 0, &s->stage, err);
}

static mrt_result open_scene(scene *s, const char *path, const char *model, error *err)
{
    mrt_result result = face_file_read(&s->model, model, NULL, FACE_FILE_USABLE, err);
    if (result >= 0 && !s->model.rig)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: expected a rig", model);
    if (result >= 0)
        result = face_file_read(&s->file, path, NULL, FACE_FILE_ANY, err);
    if (result < 0)
        return result;
    s->bare = s->file.mesh;
    s->bare.target_count = s->bare.expression_count = 0;
    const size_t count = s->bare.vertex_count + (size_t)1;
    s->area = calloc(count, sizeof *s->area);
    s->shape = calloc(count, 3 * sizeof *s->shape);
    s->jaw = calloc(count, 3 * sizeof *s->jaw);
    if (!s->area || !s->shape || !s->jaw)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    result = draft(s, path, err);
    return result < 0 ? result : weigh(s, err);
}

/* Writes how far each vertex is from `rest`. */
static void subtract(float *position, const float *rest, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        position[i] -= rest[i];
}

/* out: residual, cosine, size, mm. Returns false for a shape that is too small. */
static bool compare(double out[4], const scene *s, const float *pose)
{
    double of_pose = 0.0, of_shape = 0.0, both = 0.0, area = 0.0;
    for (size_t i = 0; i < (size_t)3 * s->bare.vertex_count; ++i) {
        const double w = s->area[i / 3], a = (double)pose[i], b = (double)s->shape[i];
        of_pose += w * a * a;
        of_shape += w * b * b;
        both += w * a * b;
        area += w / 3.0;
    }
    out[1] = of_pose > 0.0 ? both / sqrt(of_pose * of_shape) : 0.0;
    out[0] = out[1] > 0.0 ? sqrt(fmax(1.0 - out[1] * out[1], 0.0)) : 1.0;
    out[2] = sqrt(of_pose / of_shape);
    out[3] = sqrt(of_shape / area);
    return out[3] >= least_mm;
}

static mrt_result run(scene *s, error *err)
{
    double sum[3] = {0.0}, is[4];
    uint32_t count = 0;
    const rig *r = &s->stage.rig;
    const size_t numbers = (size_t)3 * s->bare.vertex_count;
    printf("%-20s %8s %9s %6s %6s\n", "shape", "residual", "direction", "size", "mm");
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        mrt_result result = rig_poses_show(&s->stage, i, err);
        if (result < 0)
            return result;
        float *at = s->stage.position;
        subtract(at, s->bare.position, numbers);
        if (strcmp(r->pose[i].name, "jawOpen") == 0)
            memcpy(s->jaw, at, numbers * sizeof *at);
        if (strcmp(r->pose[i].name, "mouthClose") == 0)
            subtract(at, s->jaw, numbers);
        if (!find_shape(s, r->pose[i].name) || !compare(is, s, at))
            continue;
        printf("%-20s %8.3f %9.2f %6.2f %6.2f\n", r->pose[i].name, is[0], is[1], is[2], is[3]);
        for (int k = 0; k < 3; ++k)
            sum[k] += is[k];
        count += 1;
    }
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "no pose has a shape of its name");
    printf("%-20s %8.3f %9.2f %6.2f\n", "mean", sum[0] / count, sum[1] / count, sum[2] / count);
    return MRT_OK;
}

int main(int argc, char **argv)
{
    static scene s;
    error err = {""};
    if (argc != 3) {
        fprintf(stderr, "usage: bench_carried HEAD MODEL.rig.json\n");
        return 2;
    }
    mrt_result result = open_scene(&s, argv[1], argv[2], &err);
    if (result >= 0)
        result = run(&s, &err);
    rig_poses_stage_finish(&s.stage);
    rig_destroy(&s.rig);
    face_file_destroy(&s.file);
    face_file_destroy(&s.model);
    free(s.area);
    free(s.shape);
    free(s.jaw);
    if (result < 0)
        fprintf(stderr, "%s\n", err.text);
    return result < 0;
}
