/* marotte rig show: a rig on a picture. */
#include "rig.h"

#include "rigpicture.h"
#include "stage/face_file.h"

#include "base/text.h"

#include <stdio.h>
#include <string.h>

typedef struct showing {
    const char *path, *out_path;
    rigpicture_view view[RIGPICTURE_VIEWS_MAX];
    uint32_t view_count;
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
    return s->path && s->out_path;
}

static void use_usual_views(showing *s)
{
    const float quarter = (float)(35.0 * radian_per_degree),
                side = (float)(90.0 * radian_per_degree);
    s->view[0] = (rigpicture_view){0.0f, 0.0f};
    s->view[1] = (rigpicture_view){quarter, 0.14f};
    s->view[2] = (rigpicture_view){side, 0.0f};
    s->view_count = 3;
}

static mrt_result show(const showing *s, error *err)
{
    face_file f;
    binding b;
    mrt_result result = face_file_read(&f, s->path, MESH_UNIT_AUTO, FACE_FILE_USABLE, err);
    if (result < 0)
        return result;
    if (!f.rig)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: is a mesh; marotte rig new drafts a rig for it", s->path);
    else
        result = binding_create(&b, f.rig, &f.mesh, &f.topology, err);
    if (result >= 0) {
        result = rigpicture_write(s->out_path, f.rig, &f.mesh, &b, s->view, s->view_count, err);
        binding_destroy(&b);
    }
    if (result >= 0)
        printf("wrote %s: %u bones, %u contacts, %u views\n", s->out_path, f.rig->bone_count,
               f.rig->contact_count, s->view_count);
    face_file_destroy(&f);
    return result;
}

int rigshow_run(int argc, char **argv)
{
    showing s = {0};
    error err = {""};
    if (!read_options(&s, argc, argv))
        return command_usage(&command_rig,
                             "show takes a rig file, --out PICTURE.png, and --yaw and --pitch in "
                             "degrees");
    if (s.view_count == 0)
        use_usual_views(&s);
    return show(&s, &err) < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}
