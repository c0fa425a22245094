#include "face/rig_check.h"

#include "face/rig/rig_check_parts.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- findings ---- */

static rig_finding *add_finding(rig_checking *c)
{
    rig_findings *out = c->out;
    if (out->count == out->capacity) {
        uint32_t capacity = out->capacity * 2 + 16;
        rig_finding *grown = realloc(out->item, capacity * sizeof *grown);
        if (!grown) {
            c->is_out_of_memory = true;
            return NULL;
        }
        out->item = grown;
        out->capacity = capacity;
    }
    out->count += 1;
    return &out->item[out->count - 1];
}

void rig_find(rig_checking *c, rig_severity severity, const char *path, const char *format, ...)
{
    rig_finding *finding = add_finding(c);
    if (!finding)
        return;
    finding->severity = severity;
    (void)snprintf(finding->path, sizeof finding->path, "%s", path);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(finding->text, sizeof finding->text, format, arguments);
    va_end(arguments);
}

/* "base.rig.json: $.bones[1]: text" is a path and a text. */
static void find_error(rig_checking *c, const error *err)
{
    const char *path_start = strchr(err->text, '$');
    const char *colon = path_start ? strstr(path_start, ": ") : NULL;
    if (!colon) {
        rig_find(c, RIG_ERROR, "$", "%s", err->text);
        return;
    }
    char path[128];
    (void)snprintf(path, sizeof path, "%.*s", (int)(colon - err->text), err->text);
    rig_find(c, RIG_ERROR, path, "%s", colon + 2);
}

static void sort_by_severity(rig_findings *findings)
{
    for (uint32_t i = 1; i < findings->count; ++i) { /* stable, and short lists */
        rig_finding moved = findings->item[i];
        uint32_t at = i;
        for (; at > 0 && findings->item[at - 1].severity < moved.severity; --at)
            findings->item[at] = findings->item[at - 1];
        findings->item[at] = moved;
    }
}

void rig_findings_finish(rig_findings *findings)
{
    free(findings->item);
    *findings = (rig_findings){0};
}

uint32_t rig_findings_count(const rig_findings *findings, rig_severity severity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < findings->count; ++i)
        count += findings->item[i].severity == severity;
    return count;
}

/* ---- what makes it unusable ---- */

mrt_result rig_validate(const rig *r, const mesh *m, const topology *t, error *err)
{
    bind_marks marks;
    mrt_result result = bind_marks_create(&marks, r, m, t, err);
    if (result < 0)
        return result;
    result = rig_check_hinge(r, err);
    if (result >= 0)
        result = rig_check_seams(r, m, &marks, NULL, err);
    bind_marks_destroy(&marks);
    return result;
}

/* ---- everything ---- */

static void note_lines(rig_checking *c, const char *note)
{
    while (note && *note) {
        size_t length = strcspn(note, "\n");
        const char *colon = strstr(note, ": ");
        if (note[0] == '$' && colon && (size_t)(colon - note) < length) {
            char path[128];
            (void)snprintf(path, sizeof path, "%.*s", (int)(colon - note), note);
            rig_find(c, RIG_NOTE, path, "%.*s", (int)(length - (size_t)(colon + 2 - note)),
                     colon + 2);
        } else {
            rig_find(c, RIG_NOTE, "$", "%.*s", (int)length, note);
        }
        note += length + (note[length] == '\n');
    }
}

static void check_unusable(rig_checking *c, bind_marks *marks)
{
    error err = {""};
    if (bind_marks_create(marks, c->r, c->m, c->t, &err) < 0)
        find_error(c, &err);
    else
        c->marks = marks;
    if (rig_check_hinge(c->r, &err) < 0)
        find_error(c, &err);
    if (c->marks && rig_check_seams(c->r, c->m, c->marks, c->binding, &err) < 0)
        find_error(c, &err);
}

static double height_of(const mesh *m)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    return (double)high[1] - (double)low[1];
}

mrt_result rig_check(rig_findings *out, const rig *r, const mesh *m, const topology *t,
                     const binding *b, error *err)
{
    bind_marks marks = {0};
    rig_head head;
    *out = (rig_findings){0};
    rig_checking c = {.r = r, .m = m, .t = t, .binding = b, .out = out};
    c.radius_mm = r->solver.radius > 0.0 ? r->solver.radius : 0.25 * height_of(m);
    if (rig_head_measure(&head, m, NULL) >= 0)
        c.head = &head;
    check_unusable(&c, &marks);
    rig_check_size(&c);
    rig_check_mesh_hash(&c);
    rig_check_symmetry(&c);
    rig_check_surface(&c);
    if (c.marks)
        rig_check_contacts(&c);
    rig_check_jaw(&c);
    if (!c.marks)
        rig_find(&c, RIG_NOTE, "$.regions",
                 "contacts and parts are checked once this has no errors");
    note_lines(&c, r->note);
    bind_marks_destroy(&marks);
    sort_by_severity(out);
    return c.is_out_of_memory ? error_set(err, MRT_ERR_MEMORY, "no memory to check the rig")
                              : MRT_OK;
}
