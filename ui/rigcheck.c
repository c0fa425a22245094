/* marotte rig check: findings, one line each. */
#include "rig.h"

#include "face/rig_check.h"
#include "stage/perform/face_file.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

typedef struct checking {
    const char *path;
    bool as_json;
    rig_findings findings;
} checking;

static const char *const severity_name[] = {
    [RIG_NOTE] = "note", [RIG_WARNING] = "warning", [RIG_ERROR] = "error"};

static bool read_options(checking *c, int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--json") == 0)
            c->as_json = true;
        else if (!c->path && argv[i][0] != '-')
            c->path = argv[i];
        else
            return false;
    }
    return c->path != NULL;
}

static void print_text(const checking *c)
{
    const rig_findings *all = &c->findings;
    for (uint32_t i = 0; i < all->count; ++i)
        printf("%-8s %s: %s\n", severity_name[all->item[i].severity], all->item[i].path,
               all->item[i].text);
    printf("%s: %u errors, %u warnings, %u notes\n", c->path, rig_findings_count(all, RIG_ERROR),
           rig_findings_count(all, RIG_WARNING), rig_findings_count(all, RIG_NOTE));
}

static void print_json(const checking *c)
{
    const rig_findings *all = &c->findings;
    json_t *list = json_array();
    for (uint32_t i = 0; i < all->count; ++i)
        json_array_append_new(list, json_pack("{ss, ss, ss}", "severity",
                                              severity_name[all->item[i].severity], "path",
                                              all->item[i].path, "text", all->item[i].text));
    json_t *out = json_pack("{ss, si, si, si, so}", "file", c->path, "errors",
                            (int)rig_findings_count(all, RIG_ERROR), "warnings",
                            (int)rig_findings_count(all, RIG_WARNING), "notes",
                            (int)rig_findings_count(all, RIG_NOTE), "findings", list);
    json_dumpf(out, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(out);
}

static mrt_result check(checking *c, const face_file *f, error *err)
{
    binding b;
    error reason = {""};
    bool is_bound = binding_create(&b, f->rig, &f->mesh, &f->topology, &reason) >= 0;
    mrt_result result =
        rig_check(&c->findings, f->rig, &f->mesh, &f->topology, is_bound ? &b : NULL, err);
    if (is_bound)
        binding_destroy(&b);
    else if (result >= 0 && rig_findings_count(&c->findings, RIG_ERROR) == 0)
        result = error_set(err, MRT_ERR_UNSUPPORTED, "%s: %s", c->path, reason.text);
    return result;
}

int rigcheck_run(int argc, char **argv)
{
    checking c = {0};
    face_file f = {0};
    error err = {""};
    if (!read_options(&c, argc, argv))
        return command_usage(&command_rig, "check takes one rig file, and --json");
    mrt_result result = face_file_read(&f, c.path, MESH_UNIT_AUTO, FACE_FILE_ANY, &err);
    if (result >= 0 && !f.rig)
        result = error_set(&err, MRT_ERR_ARGUMENT,
                           "%s: is a mesh; marotte rig new drafts a rig for it", c.path);
    if (result >= 0)
        result = check(&c, &f, &err);
    if (result >= 0 && c.as_json)
        print_json(&c);
    else if (result >= 0)
        print_text(&c);
    bool is_right = result >= 0 && rig_findings_count(&c.findings, RIG_ERROR) == 0;
    rig_findings_finish(&c.findings);
    face_file_destroy(&f);
    if (result < 0)
        return command_failed(&command_rig, &err);
    return is_right ? COMMAND_DONE : COMMAND_FAILED;
}
