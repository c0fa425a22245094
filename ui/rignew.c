/* marotte rig new: a first rig for a mesh. */
#include "rig.h"

#include "base/file.h"
#include "face/rig_check.h"
#include "face/rig_draft.h"
#include "stage/perform/face_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_TEXT = 4096 };

typedef struct drafting {
    const char *mesh_path;
    char out_path[PATH_TEXT];
    mesh_unit unit;
    bool may_replace;
} drafting;

static bool read_unit(mesh_unit *out, const char *word)
{
    static const char *const names[] = {
        [MESH_UNIT_MM] = "mm", [MESH_UNIT_CM] = "cm", [MESH_UNIT_M] = "m"};
    for (int unit = MESH_UNIT_MM; unit <= MESH_UNIT_M; ++unit)
        if (strcmp(names[unit], word) == 0) {
            *out = (mesh_unit)unit;
            return true;
        }
    return false;
}

static bool read_options(drafting *d, int argc, char **argv)
{
    const char *out_path = NULL;
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--force") == 0)
            d->may_replace = true;
        else if (strcmp(argv[i], "--out") == 0 && i + 1 < argc)
            out_path = argv[++i];
        else if (strcmp(argv[i], "--unit") == 0 && i + 1 < argc && read_unit(&d->unit, argv[i + 1]))
            ++i;
        else if (!d->mesh_path && argv[i][0] != '-')
            d->mesh_path = argv[i];
        else
            return false;
    }
    if (!d->mesh_path)
        return false;
    const char *slash = strrchr(d->mesh_path, '/');
    const char *dot = strrchr(slash ? slash : d->mesh_path, '.');
    int stem = dot ? (int)(dot - d->mesh_path) : (int)strlen(d->mesh_path);
    int length = out_path ? snprintf(d->out_path, PATH_TEXT, "%s", out_path)
                          : snprintf(d->out_path, PATH_TEXT, "%.*s.rig.json", stem, d->mesh_path);
    return length < PATH_TEXT;
}

static void print_lines(const char *prefix, const char *lines)
{
    while (lines && *lines) {
        int length = (int)strcspn(lines, "\n");
        printf("%s%.*s\n", prefix, length, lines);
        lines += length + (lines[length] == '\n');
    }
}

/* Where rigs may not name it, a person must be told. */
static void print_place(const drafting *d)
{
    error err = {""};
    char *folder = file_directory(d->out_path);
    if (folder && file_check_below(folder, d->mesh_path, &err) < 0)
        printf("confirm  $.mesh: %s\n", err.text);
    free(folder);
}

static mrt_result draft(const drafting *d, error *err)
{
    face_file f;
    rig r;
    char *confirm = NULL;
    mrt_result result = face_file_read(&f, d->mesh_path, d->unit, FACE_FILE_ANY, err);
    if (result < 0)
        return result;
    if (f.rig)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: is a rig; new takes a mesh", d->mesh_path);
    else
        result = rig_draft_make(&r, &confirm, &f.mesh, d->mesh_path, err);
    if (result >= 0) {
        result = rig_validate(&r, &f.mesh, &f.topology, err);
        if (result >= 0)
            result = rig_write(&r, d->out_path, err);
        rig_destroy(&r);
    }
    if (result >= 0) {
        printf("wrote    %s\n", d->out_path);
        print_lines("note     ", f.note);
        print_lines("confirm  ", confirm);
        print_place(d);
        printf("next     marotte rig check %s\n", d->out_path);
        printf("next     marotte rig show %s --out rig.png\n", d->out_path);
    }
    free(confirm);
    face_file_destroy(&f);
    return result;
}

int rignew_run(int argc, char **argv)
{
    drafting d = {0};
    error err = {""};
    if (!read_options(&d, argc, argv))
        return command_usage(&command_rig, "new takes a mesh, --out, --unit mm|cm|m and --force");
    if (!d.may_replace && access(d.out_path, F_OK) == 0) {
        (void)error_set(&err, MRT_ERR_ARGUMENT,
                        "%s: is there already; --force writes over it, --out elsewhere",
                        d.out_path);
        return command_failed(&command_rig, &err);
    }
    return draft(&d, &err) < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}
