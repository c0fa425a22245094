/* marotte rig show: a rig, or its poses, on a picture. */
#include "rig.h"

#include "rigportraits.h"
#include "video.h"
#include "stage/perform/face_file.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

typedef struct showing {
    const char *path, *out_path;
    rigpicture_view view[RIGPICTURE_VIEWS_MAX];
    uint32_t view_count; /* 0: from the usual sides */
    bool has_poses;      /* --poses: them instead of the rig */
    video_look look;     /* its size */
} showing;

static const double radian_per_degree = 0.017453292519943295;

static bool read_angle(float *out_rad, const char *word)
{
    double deg;
    if (!text_double(text_view_of(word, strlen(word)), &deg) || deg < -360.0 || deg > 360.0)
        return false;
    *out_rad = (float)(deg * radian_per_degree);
    return true;
}

static bool read_options(showing *s, int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) {
        bool has_value = i + 1 < argc;
        if (strcmp(argv[i], "--out") == 0 && has_value) {
            s->out_path = argv[++i];
        } else if (strcmp(argv[i], "--poses") == 0) {
            s->has_poses = true;
        } else if (strcmp(argv[i], "--size") == 0 && has_value) {
            if (!video_look_size(&s->look, argv[++i]))
                return false;
        } else if (strcmp(argv[i], "--yaw") == 0 && has_value) {
            s->view_count = 1;
            if (!read_angle(&s->view[0].yaw_rad, argv[++i]))
                return false;
        } else if (strcmp(argv[i], "--pitch") == 0 && has_value) {
            s->view_count = 1;
            if (!read_angle(&s->view[0].pitch_rad, argv[++i]))
                return false;
        } else if (!s->path && argv[i][0] != '-') {
            s->path = argv[i];
        } else {
            return false;
        }
    }
    return s->path && (s->out_path || s->has_poses);
}

/* ---- the rig ---- */

static void use_usual_views(showing *s)
{
    const float quarter = (float)(35.0 * radian_per_degree),
                side = (float)(90.0 * radian_per_degree);
    s->view[0] = (rigpicture_view){0.0f, 0.0f};
    s->view[1] = (rigpicture_view){quarter, 0.14f};
    s->view[2] = (rigpicture_view){side, 0.0f};
    s->view_count = 3;
}

static mrt_result show_rig(showing *s, const face_file *f, error *err)
{
    binding b;
    if (s->view_count == 0)
        use_usual_views(s);
    mrt_result result = binding_create(&b, f->rig, &f->mesh, &f->topology, err);
    if (result < 0)
        return result;
    char typed[1024];
    command_typed(typed, sizeof typed);
    const rigpicture_about about = {typed, s->look.width, s->look.height};
    result =
        rigpicture_write(s->out_path, f->rig, &f->mesh, &b, s->view, s->view_count, &about, err);
    binding_destroy(&b);
    if (result >= 0)
        printf("wrote %s: %u bones, %u contacts, %u views\n", s->out_path, f->rig->bone_count,
               f->rig->contact_count, s->view_count);
    return result;
}

/* ---- its poses ---- */

static mrt_result print_poses(rigpose_stage *stage, rigportraits_frame *frame, error *err)
{
    for (uint32_t i = 0; i < stage->rig->pose_count; ++i) {
        mrt_result result = rigpose_show(stage, i, err);
        if (result < 0)
            return result;
        if (i < RIGPORTRAITS_MAX)
            rigportraits_frame_add(frame, stage->position, stage->mesh->vertex_count);
        rigpose_measure m = rigpose_measured(stage);
        printf("%-20s least determinant %6.3f   penetration %.2f mm   furthest %.1f mm (vertex "
               "%u)%s\n",
               stage->rig->pose[i].name, m.least_determinant, m.penetration_mm, m.furthest_mm,
               m.furthest_vertex, m.least_determinant > 0.0 ? "" : "   FOLDS");
    }
    return MRT_OK;
}

static mrt_result draw_poses(const showing *s, rigpose_stage *stage,
                             const rigportraits_frame *frame, error *err)
{
    char title[256], typed[1024];
    command_typed(typed, sizeof typed);
    (void)snprintf(title, sizeof title, "%s: %u poses", stage->rig->name, stage->rig->pose_count);
    const rigportraits_about about = {title, typed, s->look.width, s->look.height};
    mrt_result result = rigportraits_write(s->out_path, stage, frame, &about, err);
    if (result < 0)
        return result;
    if (stage->rig->pose_count > RIGPORTRAITS_MAX)
        printf("wrote %s: the first %d of %u poses\n", s->out_path, RIGPORTRAITS_MAX,
               stage->rig->pose_count);
    else
        printf("wrote %s: %u poses\n", s->out_path, stage->rig->pose_count);
    return result;
}

static mrt_result show_poses(const showing *s, const face_file *f, error *err)
{
    rigpose_stage stage;
    if (f->rig->pose_count == 0)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s: $.poses is empty: no poses to show; write some, as rigs/README.md says", s->path);
    mrt_result result = rigpose_stage_init(&stage, f->rig, &f->mesh, &f->topology, err);
    if (result < 0)
        return result;
    rigportraits_frame frame =
        rigportraits_frame_empty(s->view_count > 0 ? s->view[0] : rigportraits_usual_view());
    result = print_poses(&stage, &frame, err);
    if (result >= 0 && s->out_path)
        result = draw_poses(s, &stage, &frame, err);
    rigpose_stage_finish(&stage);
    return result;
}

static mrt_result show(showing *s, error *err)
{
    face_file f;
    mrt_result result = face_file_read(&f, s->path, MESH_UNIT_AUTO, FACE_FILE_USABLE, err);
    if (result < 0)
        return result;
    if (!f.rig)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: is a mesh; marotte rig new drafts a rig for it", s->path);
    else
        result = s->has_poses ? show_poses(s, &f, err) : show_rig(s, &f, err);
    face_file_destroy(&f);
    return result;
}

int rigshow_run(int argc, char **argv)
{
    showing s = {0};
    error err = {""};
    if (!read_options(&s, argc, argv))
        return command_usage(
            &command_rig, "show takes a rig file, --out PICTURE.png, --yaw and --pitch in "
                          "degrees, --size WIDTHxHEIGHT of 16 to 16384 pixels, and --poses for its "
                          "poses (then --out may be left away)");
    return show(&s, &err) < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}
