/* marotte rig: checks, drafts, draws, fits and measures rigs. */
#include "base/file.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/json.h"
#include "cli/command.h"
#include "face/rig_check.h"
#include "face/rig_draft.h"
#include "cli/terminal.h"
#include "cli/rigpicture.h"
#include "stage/perform/face_file.h"
#include "stream/video.h"
#include "face/fit.h"
#include "io/export.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reads a rig; a mesh file alone is an error. Destroy `out` whatever the result. */
static mrt_result read_rig(face_file *out, const char *path, face_file_strictness strictness,
                           error *err)
{
    mrt_result result = face_file_read(out, path, NULL, strictness, err);
    if (result < 0 || out->rig)
        return result;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: this is a mesh, not a rig; marotte rig new drafts a rig for it", path);
}

/* ---- rig check ---- */

typedef struct checking {
    char *path; /* owned */
    bool as_json;
    rig_findings findings;
} checking;

static const char *const severity_name[] = {
    [RIG_NOTE] = "note", [RIG_WARNING] = "warning", [RIG_ERROR] = "error"};

#define AT(member) .offset = offsetof(checking, member)
static const command_option check_options[] = {
    {"RIG", COMMAND_WORD, AT(path), .read = command_read_face},
    {"json", COMMAND_FLAG, AT(as_json)},
    {.name = NULL},
};
#undef AT

static void print_text(const checking *c)
{
    const rig_findings *all = &c->findings;
    for (uint32_t i = 0; i < all->count; ++i)
        terminal_print("%-8s %s: %s\n", severity_name[all->item[i].severity], all->item[i].path,
                       all->item[i].text);
    terminal_print("%s: %u errors, %u warnings, %u notes\n", c->path,
                   rig_findings_count(all, RIG_ERROR), rig_findings_count(all, RIG_WARNING),
                   rig_findings_count(all, RIG_NOTE));
}

static void print_json(const checking *c)
{
    const rig_findings *all = &c->findings;
    json_t *list = json_array();
    for (uint32_t i = 0; i < all->count; ++i)
        json_array_append_new(list, json_pack("{ss, so, so}", "severity",
                                              severity_name[all->item[i].severity], "path",
                                              json_text(all->item[i].path), "text",
                                              json_text(all->item[i].text)));
    json_t *out = json_pack("{so, si, si, si, so}", "file", json_text(c->path), "errors",
                            (int)rig_findings_count(all, RIG_ERROR), "warnings",
                            (int)rig_findings_count(all, RIG_WARNING), "notes",
                            (int)rig_findings_count(all, RIG_NOTE), "findings", list);
    facts_print_json(out, JSON_INDENT(2));
}

static mrt_result check(checking *c, const face_file *f, error *err)
{
    binding b;
    error reason = {""};
    bool is_bound = binding_create(&b, f->rig, &f->mesh, &f->topology, &reason) >= 0;
    mrt_result result =
        rig_check(&c->findings, f->rig, &f->mesh, &f->topology, is_bound ? &b : NULL, err);
    if (is_bound) {
        if (result >= 0 && rig_findings_count(&c->findings, RIG_ERROR) == 0)
            result = rig_check_poses(&c->findings, f->rig, &f->mesh, &f->topology, &b, err);
        binding_destroy(&b);
    } else if (result >= 0 && rig_findings_count(&c->findings, RIG_ERROR) == 0)
        result = error_set(err, MRT_ERR_UNSUPPORTED, "%s: %s", c->path, reason.text);
    return result;
}

static int rigcheck_run(int argc, char **argv)
{
    checking c = {0};
    face_file f = {0};
    error err = {""};
    int code = command_options(&c, &command_rig, check_options, argc, argv);
    if (code == COMMAND_DONE && !c.path)
        code = command_usage(&command_rig, "check needs one rig file");
    if (code != COMMAND_DONE) {
        free(c.path);
        return code;
    }
    mrt_result result = read_rig(&f, c.path, FACE_FILE_ANY, &err);
    if (result >= 0)
        result = check(&c, &f, &err);
    if (result >= 0 && c.as_json)
        print_json(&c);
    else if (result >= 0)
        print_text(&c);
    bool is_right = result >= 0 && rig_findings_count(&c.findings, RIG_ERROR) == 0;
    rig_findings_finish(&c.findings);
    face_file_destroy(&f);
    free(c.path);
    if (result < 0)
        return command_failed(&command_rig, &err);
    return is_right ? COMMAND_DONE : COMMAND_FAILED;
}

/* ---- rig new ---- */

enum { PATH_TEXT = 4096 };

typedef struct drafting {
    const char *mesh_path, *given_path; /* NULL: beside the mesh, with its name */
    char out_path[PATH_TEXT];
    mesh_frame frame;
    bool may_replace;
    bool cuts_mouth, leaves_mouth; /* neither: a mouth is cut where the lips show a clear groove */
} drafting;

#define AT(member) .offset = offsetof(drafting, member)
static const command_option new_options[] = {
    {"MESH", COMMAND_WORD, AT(mesh_path)},
    {"out", COMMAND_TEXT, AT(given_path)},
    {"unit", COMMAND_READ, AT(frame.mm_per_unit), .read = command_read_unit},
    {"up", COMMAND_READ, AT(frame.up), .read = command_read_axis},
    {"forward", COMMAND_READ, AT(frame.forward), .read = command_read_axis},
    {"cut-mouth", COMMAND_FLAG, AT(cuts_mouth)},
    {"no-cut-mouth", COMMAND_FLAG, AT(leaves_mouth)},
    {"force", COMMAND_FLAG, AT(may_replace)},
    {.name = NULL},
};
#undef AT

/* Returns false if the path is too long. */
static bool choose_out_path(drafting *d)
{
    const char *slash = strrchr(d->mesh_path, '/');
    const char *dot = strrchr(slash ? slash : d->mesh_path, '.');
    int stem = dot ? (int)(dot - d->mesh_path) : (int)strlen(d->mesh_path);
    int length = d->given_path
                     ? snprintf(d->out_path, PATH_TEXT, "%s", d->given_path)
                     : snprintf(d->out_path, PATH_TEXT, "%.*s.rig.json", stem, d->mesh_path);
    return length < PATH_TEXT;
}

static void print_lines(const char *prefix, const char *lines)
{
    while (lines && *lines) {
        int length = (int)strcspn(lines, "\n");
        terminal_print("%s%.*s\n", prefix, length, lines);
        lines += length + (lines[length] == '\n');
    }
}

/* Warns about a mesh path that a rig must not contain. */
static void warn_mesh_path(const drafting *d)
{
    error err = {""};
    char *folder = file_directory(d->out_path);
    if (folder && file_check_below(folder, d->mesh_path, &err) < 0)
        terminal_print("confirm  $.mesh: %s\n", err.text);
    free(folder);
}

/* What is drafted: the mesh as read, or with its mouth cut open. */
typedef struct drafted {
    face_file file;
    rig rig;
    char *confirm;
    uint32_t *chain, chain_count; /* of the cut; NULL: none */
} drafted;

static void drafted_finish(drafted *d)
{
    free(d->chain);
    free(d->confirm);
    rig_destroy(&d->rig);
    face_file_destroy(&d->file);
    *d = (drafted){.chain = NULL};
}

/* Whether the mouth can open as a mouth does, and no contact lies on its rims. */
static bool is_good_mouth(const drafted *d)
{
    const double least_rad = 0.2;
    const rig *r = &d->rig;
    const uint32_t jaw = rig_find_jaw(r);
    bool is_good = jaw != RIG_NONE && r->mouth.upper && r->bone[jaw].open_max_rad > least_rad;
    for (uint32_t c = 0; c < r->contact_count; ++c)
        for (uint32_t i = 0; i < d->chain_count; ++i)
            is_good = is_good && r->contact[c].vertex != d->chain[i];
    return is_good;
}

/* *out_is_clear: of the groove between the lips; rig_draft_mouth. */
static mrt_result draft_once(drafted *out, const drafting *d, bool cuts, bool *out_is_clear,
                             error *err)
{
    *out = (drafted){.chain = NULL};
    *out_is_clear = false;
    mrt_result result = face_file_read(&out->file, d->mesh_path, &d->frame, FACE_FILE_ANY, err);
    if (result >= 0 && out->file.rig)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: this is a rig; rig new needs a mesh",
                           d->mesh_path);
    else if (result >= 0 && cuts) {
        result = rig_draft_mouth(&out->chain, &out->chain_count, out_is_clear, &out->file.mesh,
                                 &out->file.topology, err);
        if (result >= 0 && out->chain)
            result = face_file_cut_mouth(&out->file, out->chain, out->chain_count, err);
        if (result < 0)
            error_prefix(err, d->mesh_path);
    }
    if (result >= 0 && (!cuts || d->cuts_mouth || *out_is_clear))
        result = face_file_draft(&out->rig, &out->confirm, &out->file.mesh, &out->file.topology,
                                 d->mesh_path, out->chain, out->chain_count, err);
    if (result < 0)
        drafted_finish(out);
    return result;
}

/* Without --cut-mouth the mouth is cut where the lips show a clear groove, and it opens well. */
static mrt_result draft_best(drafted *out, const drafting *d, error *err)
{
    bool is_clear;
    error ignored = {""};
    if (d->cuts_mouth || d->leaves_mouth)
        return draft_once(out, d, d->cuts_mouth, &is_clear, err);
    if (draft_once(out, d, true, &is_clear, &ignored) >= 0) {
        if (is_clear && is_good_mouth(out))
            return MRT_OK;
        drafted_finish(out);
    }
    return draft_once(out, d, false, &is_clear, err);
}

static mrt_result draft(const drafting *d, error *err)
{
    drafted made;
    mrt_result result = draft_best(&made, d, err);
    if (result < 0)
        return result;
    result = rig_write(&made.rig, d->out_path, err);
    if (result >= 0) {
        terminal_print("wrote    %s\n", d->out_path);
        print_lines("note     ", made.file.note);
        if (d->cuts_mouth && !made.chain)
            print_lines("note     ", "mouth: the lips are open already; nothing was cut");
        if (!d->cuts_mouth && made.chain)
            print_lines("note     ", "mouth: cut open along the groove between the lips, with a "
                                     "dark bag behind them. The mesh file is not changed. To keep "
                                     "the lips closed: --no-cut-mouth");
        print_lines("confirm  ", made.confirm);
        warn_mesh_path(d);
        fputs("next     marotte rig check ", stdout);
        terminal_print_quoted(d->out_path);
        fputs("\nnext     marotte rig show ", stdout);
        terminal_print_quoted(d->out_path);
        fputs(" --out rig.png\n", stdout);
    }
    drafted_finish(&made);
    return result;
}

static int rignew_run(int argc, char **argv)
{
    drafting d = {0};
    error err = {""};
    int code = command_options(&d, &command_rig, new_options, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (!d.mesh_path || !choose_out_path(&d))
        return command_usage(&command_rig,
                             "new needs a mesh: marotte rig new MESH [--out NAME.rig.json]");
    if (!d.may_replace && access(d.out_path, F_OK) == 0) {
        (void)error_set(
            &err, MRT_ERR_ARGUMENT,
            "%s: exists already. Overwrite it with --force, or choose another file with --out",
            d.out_path);
        return command_failed(&command_rig, &err);
    }
    return draft(&d, &err) < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}

/* ---- rig teeth ---- */

typedef struct fitting_teeth {
    char *path;
    const char *out_path; /* NULL: print the entries */
} fitting_teeth;

#define AT(member) .offset = offsetof(fitting_teeth, member)
static const command_option teeth_options[] = {
    {"RIG", COMMAND_WORD, AT(path), .read = command_read_face},
    {"out", COMMAND_TEXT, AT(out_path)},
    {.name = NULL},
};
#undef AT

static mrt_result fit_teeth(const fitting_teeth *self, const face_file *f, error *err)
{
    rig r;
    uint32_t rows = 0;
    mrt_result result = rig_copy(&r, f->rig, err);
    if (result < 0)
        return result;
    result = rig_draft_teeth(&r, &f->mesh, &f->topology, err);
    for (uint32_t i = 0; result >= 0 && i < r.proxy_count; ++i) {
        const rig_proxy *p = &r.proxy[i];
        if (p->kind != PROXY_TEETH)
            continue;
        terminal_print(
            "{\"teeth\": {\"centre\": [%.10g, %.10g, %.10g], \"radii\": [%.10g, %.10g, %.10g], "
            "\"bone\": \"%s\"}}\n",
            p->centre.x / r.mm_per_unit, p->centre.y / r.mm_per_unit, p->centre.z / r.mm_per_unit,
            p->radii.x / r.mm_per_unit, p->radii.y / r.mm_per_unit, p->radii.z / r.mm_per_unit,
            r.bone[p->bone].name);
        rows += 1;
    }
    if (result >= 0 && rows == 0)
        terminal_print("no teeth were found\n");
    if (result >= 0 && self->out_path)
        result = rig_write(&r, self->out_path, err);
    if (result >= 0 && self->out_path)
        terminal_print("wrote    %s\n", self->out_path);
    rig_destroy(&r);
    return result;
}

static int rigteeth_run(int argc, char **argv)
{
    fitting_teeth self = {0};
    face_file f = {0};
    error err = {""};
    int code = command_options(&self, &command_rig, teeth_options, argc, argv);
    if (code == COMMAND_DONE && !self.path)
        code = command_usage(&command_rig, "teeth needs one rig file");
    mrt_result result =
        code == COMMAND_DONE ? read_rig(&f, self.path, FACE_FILE_ANY, &err) : MRT_OK;
    if (code == COMMAND_DONE && result >= 0)
        result = fit_teeth(&self, &f, &err);
    face_file_destroy(&f);
    free(self.path);
    if (code != COMMAND_DONE)
        return code;
    return result < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}

/* ---- rig show ---- */

typedef struct showing {
    char *path; /* owned */
    const char *out_path;
    double yaw_deg, pitch_deg; /* NAN: not given */
    rigpicture_view view[RIGPICTURE_VIEWS_MAX];
    uint32_t view_count; /* 0: the standard views */
    bool has_poses;      /* --poses: draw the poses instead of the rig */
    const char *only;    /* names of poses, separated by commas; NULL: all */
    video_look look;     /* only its size is used */
} showing;

static const double radian_per_degree = 0.017453292519943295;

#define AT(member) .offset = offsetof(showing, member)
static const command_option show_options[] = {
    {"RIG", COMMAND_WORD, AT(path), .read = command_read_face},
    {"out", COMMAND_TEXT, AT(out_path)},
    {"poses", COMMAND_FLAG, AT(has_poses)},
    {"only", COMMAND_TEXT, AT(only)},
    {"size", COMMAND_READ, AT(look), .read = command_read_look},
    {"yaw", COMMAND_NUMBER, AT(yaw_deg), .least = -360.0, .most = 360.0},
    {"pitch", COMMAND_NUMBER, AT(pitch_deg), .least = -360.0, .most = 360.0},
    {.name = NULL},
};
#undef AT

static void choose_view(showing *s)
{
    if (isnan(s->yaw_deg) && isnan(s->pitch_deg))
        return;
    s->view_count = 1;
    if (!isnan(s->yaw_deg))
        s->view[0].yaw_rad = (float)(s->yaw_deg * radian_per_degree);
    if (!isnan(s->pitch_deg))
        s->view[0].pitch_rad = (float)(s->pitch_deg * radian_per_degree);
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

/* Prints a line for each degree of freedom that follows another one. */
static void print_follows(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        for (uint32_t k = 0; k < r->bone[i].turn_count; ++k) {
            const rig_bone *bone = &r->bone[i];
            const rig_follow *follows = &bone->turn[k].follows;
            const rig_bone *other = &r->bone[follows->bone];
            if (follows->share != 0.0)
                terminal_print("%s.%s follows %s.%s by %g\n", bone->name, bone->turn[k].name,
                               other->name, other->turn[follows->turn].name, follows->share);
        }
}

/* Prints one line about the mouth. */
static void print_mouth(const face_file *f, const bind_lips *lips)
{
    const rig_mouth *mouth = &f->rig->mouth;
    double open_mm = 0.0;
    for (uint32_t i = 0; i < lips->station_count; ++i) {
        vec3 upper = bind_station_position(&lips->upper[i], &f->mesh);
        vec3 lower = bind_station_position(&lips->lower[i], &f->mesh);
        open_mm = fmax(open_mm, vec3_dot(vec3_sub(upper, lower), lips->up));
    }
    if (!mouth->upper)
        terminal_print("mouth: the rig declares none, so the lips are not sealed\n");
    else if (lips->station_count == 0)
        terminal_print("mouth: %s; the lips are not sealed\n", lips->why_not);
    else
        terminal_print("mouth: rims of %u and %u vertices, %.1f mm wide, %.1f mm open at rest, "
                       "sealed from the %s\n",
                       mouth->upper_count, mouth->lower_count, lips->width_mm, open_mm,
                       mouth->seal_from == SEAL_FROM_MIDDLE ? "middle" : "corners");
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
    command_line_text(typed, sizeof typed);
    const rigpicture_about about = {
        .made_from = typed, .width = s->look.width, .height = s->look.height};
    result =
        rigpicture_write(s->out_path, f->rig, &f->mesh, &b, s->view, s->view_count, &about, err);
    if (result >= 0) {
        print_mouth(f, &b.lips);
        print_follows(f->rig);
        terminal_print("wrote %s: %u bones, %u contacts, %u views\n", s->out_path,
                       f->rig->bone_count, f->rig->contact_count, s->view_count);
    }
    binding_destroy(&b);
    return result;
}

/* ---- its poses ---- */

/* Moves the selected poses to the front, in the order of their names in --only. Returns their
 * number. */
static mrt_result choose_poses(uint32_t *out_count, const showing *s, rig *r, error *err)
{
    *out_count = s->only ? 0 : r->pose_count;
    for (const char *at = s->only; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        size_t length = strcspn(at, ",");
        uint32_t found = *out_count;
        while (found < r->pose_count && (strlen(r->pose[found].name) != length ||
                                         strncmp(r->pose[found].name, at, length) != 0))
            found += 1;
        if (found == r->pose_count)
            return error_set(err, MRT_ERR_ARGUMENT, "%s: $.poses has no \"%.*s\"", s->path,
                             (int)length, at);
        rig_pose kept = r->pose[*out_count];
        r->pose[*out_count] = r->pose[found];
        r->pose[found] = kept;
        *out_count += 1;
    }
    return MRT_OK;
}

/* If the head is on a body, only the head is framed. */
static void add_to_frame(rigportraits_frame *frame, const rig_poses_stage *stage)
{
    const mesh *m = stage->mesh;
    float low[3], high[3];
    uint32_t first = 0;
    mesh_focus(m, low, high);
    for (uint32_t v = 0; v <= m->vertex_count; ++v) {
        bool is_in = v < m->vertex_count;
        for (size_t i = 0; is_in && i < 3; ++i)
            is_in = m->position[3 * (size_t)v + i] >= low[i] &&
                    m->position[3 * (size_t)v + i] <= high[i];
        if (is_in)
            continue;
        rigportraits_frame_add(frame, stage->position + 3 * (size_t)first, v - first);
        first = v + 1;
    }
}

static mrt_result print_poses(rig_poses_stage *stage, uint32_t count, rigportraits_frame *frame,
                              error *err)
{
    for (uint32_t i = 0; i < count; ++i) {
        mrt_result result = rig_poses_show(stage, i, err);
        if (result < 0)
            return result;
        if (i < RIGPORTRAITS_MAX)
            add_to_frame(frame, stage);
        rig_poses_measure m = rig_poses_measured(stage);
        const char *part = rig_pose_part_name[stage->rig.pose[i].part];
        terminal_print(
            "%-20s %-6s least determinant %6.3f   penetration %.2f mm   furthest %.1f mm (vertex "
            "%u)%s\n",
            stage->rig.pose[i].name, part ? part : "", m.least_determinant, m.penetration_mm,
            m.furthest_mm, m.furthest_vertex, m.least_determinant > 0.0 ? "" : "   FOLDS");
    }
    return MRT_OK;
}

static mrt_result draw_poses(const showing *s, rig_poses_stage *stage, uint32_t count,
                             const rigportraits_frame *frame, error *err)
{
    char title[256], typed[1024];
    uint32_t drawn = count < RIGPORTRAITS_MAX ? count : RIGPORTRAITS_MAX;
    command_line_text(typed, sizeof typed);
    stage->solver.stretch_most = stage->rig.solver.stretch_most; /* as in a performance */
    (void)snprintf(title, sizeof title, "%s: %u poses", stage->rig.name, count);
    const rigpicture_about about = {title, typed, s->look.width, s->look.height};
    mrt_result result = rigportraits_write(s->out_path, stage, drawn, frame, &about, err);
    if (result < 0)
        return result;
    if (count > drawn)
        terminal_print("wrote %s: the first %d of %u poses\n", s->out_path, drawn, count);
    else
        terminal_print("wrote %s: %u poses\n", s->out_path, count);
    return result;
}

static mrt_result show_poses(const showing *s, const face_file *f, error *err)
{
    rig_poses_stage stage;
    uint32_t count;
    if (f->rig->pose_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the rig has no poses ($.poses)", s->path);
    mrt_result result = choose_poses(&count, s, f->rig, err);
    if (result >= 0)
        result = rig_poses_stage_init(&stage, f->rig, &f->mesh, &f->topology, err);
    if (result < 0)
        return result;
    rigportraits_frame frame =
        rigportraits_frame_empty(s->view_count > 0 ? s->view[0] : rigportraits_default_view());
    result = print_poses(&stage, count, &frame, err);
    if (result >= 0 && s->out_path)
        result = draw_poses(s, &stage, count, &frame, err);
    rig_poses_stage_finish(&stage);
    return result;
}

static mrt_result show_any(showing *s, error *err)
{
    face_file f;
    mrt_result result = read_rig(&f, s->path, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = s->has_poses ? show_poses(s, &f, err) : show_rig(s, &f, err);
    face_file_destroy(&f);
    return result;
}

static int rigshow_run(int argc, char **argv)
{
    showing s = {.yaw_deg = (double)NAN, .pitch_deg = (double)NAN};
    error err = {""};
    int code = command_options(&s, &command_rig, show_options, argc, argv);
    if (code == COMMAND_DONE &&
        (!s.path || !(s.out_path || s.has_poses) || (s.only && !s.has_poses)))
        code = command_usage(
            &command_rig,
            "show needs a rig file, and --out PICTURE.png or --poses; --only needs --poses");
    if (code == COMMAND_DONE) {
        choose_view(&s);
        if (show_any(&s, &err) < 0)
            code = command_failed(&command_rig, &err);
    }
    free(s.path);
    return code;
}

/* ---- rig fit: can this rig make these faces? ---- */

enum { SUGGEST_MAX = 256 };

typedef struct fitting {
    char *rig_path; /* owned path */
    const char *targets_path, *set_name, *out_path, *poses_path;
    uint32_t suggest_count;
    bool as_json;
    face_file face;
    mesh targets;
    uint32_t *contact; /* contacts that may be pulled */
    uint32_t contact_count;
    fit_result *result; /* one for each morph target */
    uint32_t result_count;
    uint32_t suggested[SUGGEST_MAX], suggested_count;
} fitting;

/* ---- options ---- */

#define AT(member) .offset = offsetof(fitting, member)
static const command_option fit_options_table[] = {
    {"RIG", COMMAND_WORD, AT(rig_path), .read = command_read_face},
    {"TARGETS", COMMAND_WORD, AT(targets_path)},
    {"contacts", COMMAND_TEXT, AT(set_name)},
    {"out", COMMAND_TEXT, AT(out_path)},
    {"save-poses", COMMAND_TEXT, AT(poses_path)},
    {"suggest", COMMAND_WHOLE, AT(suggest_count), .least = 1, .most = SUGGEST_MAX},
    {"json", COMMAND_FLAG, AT(as_json)},
    {.name = NULL},
};
#undef AT

static mrt_result choose_contacts(fitting *f, error *err)
{
    const rig *r = f->face.rig;
    const rig_contact_set *set = f->set_name ? rig_find_contact_set(r, f->set_name) : NULL;
    if (f->set_name && !set)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "%s: $.contact_sets has no \"%s\". Add it, or use all contacts: without --contacts",
            f->rig_path, f->set_name);
    f->contact_count = set ? set->contact_count : r->contact_count;
    f->contact = calloc(f->contact_count + 1u, sizeof *f->contact);
    if (!f->contact)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the contacts");
    for (uint32_t i = 0; i < f->contact_count; ++i)
        f->contact[i] = set ? set->contact[i] : i;
    return MRT_OK;
}

static mrt_result read_files(fitting *f, error *err)
{
    mrt_result result = read_rig(&f->face, f->rig_path, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = mesh_file_read(&f->targets, f->targets_path, NULL, err);
    if (result < 0)
        return result;
    if (f->targets.target_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: has no morph targets to fit", f->targets_path);
    if (f->targets.vertex_count != f->face.mesh.vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: has %u vertices, but the mesh of %s has %u; both must be one mesh in "
                         "one order",
                         f->targets_path, f->targets.vertex_count, f->rig_path,
                         f->face.mesh.vertex_count);
    return choose_contacts(f, err);
}

/* ---- fitting ---- */

static mrt_result fit(fitting *f, error *err)
{
    const face_file *file = &f->face;
    fit_options options = {
        .contact = f->contact, .contact_count = f->contact_count, .settings = file->rig->solver};
    f->result = calloc(f->targets.target_count, sizeof *f->result);
    if (!f->result)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u fits", f->targets.target_count);
    mrt_result result =
        fit_targets(f->result, file->rig, &file->mesh, &file->topology, &f->targets, &options, err);
    if (result >= 0)
        f->result_count = f->targets.target_count;
    return result;
}

static mrt_result suggest_contacts(fitting *f, error *err)
{
    const face_file *file = &f->face;
    return fit_suggest(f->suggested, &f->suggested_count, f->suggest_count, file->rig, &file->mesh,
                       &file->topology, &f->targets, &file->rig->solver, err);
}

/* ---- the fitted faces as a file ---- */

static void targets_finish(mesh_target *target, uint32_t count)
{
    for (uint32_t i = 0; target && i < count; ++i)
        free(target[i].offset);
    free(target);
}

static mesh_target *make_targets(const fitting *f)
{
    size_t count = (size_t)f->face.mesh.vertex_count * 3;
    mesh_target *out = calloc(f->result_count, sizeof *out);
    for (uint32_t i = 0; out && i < f->result_count; ++i) {
        out[i].name = f->targets.target[i].name;
        out[i].offset = malloc((count + 1) * sizeof *out[i].offset);
        if (!out[i].offset) {
            targets_finish(out, i);
            return NULL;
        }
        for (size_t k = 0; k < count; ++k)
            out[i].offset[k] = f->result[i].position[k] - f->face.mesh.position[k];
    }
    return out;
}

static mrt_result write_fitted(const fitting *f, error *err)
{
    mesh fitted = f->face.mesh; /* borrowed */
    fitted.target = make_targets(f);
    fitted.target_count = f->result_count;
    if (!fitted.target)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the fitted faces");
    mrt_result result = gltf_write_mesh(f->out_path, &fitted, err);
    targets_finish(fitted.target, f->result_count);
    return result;
}

/* ---- poses ---- */

/* Rounds to the precision of a file: 0.01 degrees, 0.01 mm. */
static double rounded(double value)
{
    return round(100.0 * value) / 100.0;
}

static double rounded_dof(const bones_dof *dof, double value)
{
    bool is_angle = strcmp(dof->unit, "rad") == 0;
    return is_angle ? rounded(value / radian_per_degree) * radian_per_degree : rounded(value);
}

static vec3 rounded_pull(vec3 pull)
{
    return (vec3){rounded(pull.x), rounded(pull.y), rounded(pull.z)};
}

static bool fill_pose(rig_pose *out, const fitting *f, const bones *b, const fit_result *fitted)
{
    *out = (rig_pose){.name = strndup(fitted->name, 63)};
    out->dof_name = calloc(b->dof_count + 1u, sizeof *out->dof_name);
    out->dof_value = calloc(b->dof_count + 1u, sizeof *out->dof_value);
    out->pull_contact = calloc(f->contact_count + 1u, sizeof *out->pull_contact);
    out->pull_mm = calloc(f->contact_count + 1u, sizeof *out->pull_mm);
    if (!out->name || !out->dof_name || !out->dof_value || !out->pull_contact || !out->pull_mm)
        return false;
    for (uint32_t i = 0; i < b->dof_count; ++i) {
        double value = rounded_dof(&b->dof[i], (double)fitted->dof[i]);
        if (!(fabs(value) > 0.0))
            continue;
        out->dof_name[out->dof_count] = strdup(b->dof[i].name);
        if (!out->dof_name[out->dof_count])
            return false;
        out->dof_value[out->dof_count++] = value;
    }
    for (uint32_t i = 0; i < f->contact_count; ++i) {
        out->pull_contact[i] = f->contact[i];
        out->pull_mm[i] = rounded_pull(fitted->pull[i]);
    }
    out->pull_count = f->contact_count;
    return true;
}

/* Replaces the pose with the same name, or appends the pose. */
static mrt_result set_pose(rig *r, rig_pose *pose, error *err)
{
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        if (strcmp(r->pose[i].name, pose->name) != 0)
            continue;
        rig_pose_finish(&r->pose[i]);
        r->pose[i] = *pose;
        return MRT_OK;
    }
    rig_pose *grown = realloc(r->pose, (r->pose_count + 1u) * sizeof *grown);
    if (!grown)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
    r->pose = grown;
    r->pose[r->pose_count] = *pose;
    r->pose_count += 1;
    return MRT_OK;
}

static mrt_result save_poses(fitting *f, error *err)
{
    rig *r = f->face.rig;
    bones b;
    mrt_result result = bones_init(&b, r, (vec3){0}, err); /* only for the names */
    for (uint32_t i = 0; result >= 0 && i < f->result_count; ++i) {
        rig_pose pose;
        result = fill_pose(&pose, f, &b, &f->result[i])
                     ? set_pose(r, &pose, err)
                     : error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
        if (result < 0)
            rig_pose_finish(&pose);
    }
    return result < 0 ? result : rig_write(r, f->poses_path, err);
}

/* ---- output ---- */

typedef struct means {
    double residual, paper_residual, worst_mm, rigid_mm, penetration_mm, determinant;
} means;

/* Returns the means of the residuals, and the worst of the other figures. */
static means summarise(const fitting *f)
{
    means out = {.determinant = (double)INFINITY};
    for (uint32_t i = 0; i < f->result_count; ++i) {
        const fit_result *one = &f->result[i];
        out.residual += one->relative_residual / f->result_count;
        out.paper_residual += one->paper_residual / f->result_count;
        out.worst_mm = fmax(out.worst_mm, one->worst_mm);
        out.rigid_mm = fmax(out.rigid_mm, one->rigid_motion_mm);
        out.penetration_mm = fmax(out.penetration_mm, one->penetration_mm);
        out.determinant = fmin(out.determinant, one->min_determinant);
    }
    return out;
}

static void print_row(const char *name, const double value[7])
{
    terminal_print("%-24.24s %9.3f %9.2f %9.3f %9.3f %9.3f %9.3f %9.2f\n", name, value[0], value[1],
                   value[2], value[3], value[4], value[5], value[6]);
}

static void print_fit_text(const fitting *f)
{
    terminal_print("%-24s %9s %9s %9s %9s %9s %9s %9s\n", "", "residual", "worst", "rigid",
                   "inside", "least", "paper's", "paper's");
    terminal_print("%-24s %9s %9s %9s %9s %9s %9s %9s\n", "target", "", "mm", "mm", "mm",
                   "jacobian", "residual", "rigid mm");
    double paper_rigid_mm = 0.0;
    for (uint32_t i = 0; i < f->result_count; ++i) {
        const fit_result *one = &f->result[i];
        paper_rigid_mm = fmax(paper_rigid_mm, one->paper_rigid_motion_mm);
        print_row(one->name,
                  (const double[]){one->relative_residual, one->worst_mm, one->rigid_motion_mm,
                                   one->penetration_mm, one->min_determinant, one->paper_residual,
                                   one->paper_rigid_motion_mm});
    }
    means all = summarise(f);
    print_row("mean, or worst",
              (const double[]){all.residual, all.worst_mm, all.rigid_mm, all.penetration_mm,
                               all.determinant, all.paper_residual, paper_rigid_mm});
}

static json_t *result_to_json(const fitting *f, const fit_result *one)
{
    json_t *pulls = json_object();
    for (uint32_t i = 0; i < f->contact_count; ++i)
        json_object_set_new(pulls, f->face.rig->contact[f->contact[i]].name,
                            json_pack("[fff]", one->pull[i].x, one->pull[i].y, one->pull[i].z));
    return json_pack("{so, sf, sf, sf, sf, sf, sf, sf, so}", "name", json_text(one->name),
                     "relative_residual", one->relative_residual, "worst_mm", one->worst_mm,
                     "rigid_motion_mm", one->rigid_motion_mm, "penetration_mm", one->penetration_mm,
                     "min_determinant", one->min_determinant, "paper_residual", one->paper_residual,
                     "paper_rigid_motion_mm", one->paper_rigid_motion_mm, "pulls_mm", pulls);
}

static void print_fit_json(const fitting *f)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < f->result_count; ++i)
        json_array_append_new(list, result_to_json(f, &f->result[i]));
    means all = summarise(f);
    json_t *out = json_pack(
        "{so, so, si, so, sf, sf, sf, sf, sf, sf}", "rig", json_text(f->rig_path), "targets_file",
        json_text(f->targets_path), "contacts", (int)f->contact_count, "targets", list,
        "mean_relative_residual", all.residual, "mean_paper_residual", all.paper_residual,
        "worst_mm", all.worst_mm, "worst_rigid_motion_mm", all.rigid_mm, "worst_penetration_mm",
        all.penetration_mm, "min_determinant", all.determinant);
    facts_print_json(out, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
}

static void print_suggestion(const fitting *f)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < f->suggested_count; ++i) {
        const float *p = f->face.mesh.position + (size_t)f->suggested[i] * 3;
        json_array_append_new(list, json_integer((json_int_t)f->suggested[i]));
        if (!f->as_json)
            terminal_print("suggested  vertex %6u at (%6.1f, %6.1f, %6.1f) mm\n", f->suggested[i],
                           (double)p[0], (double)p[1], (double)p[2]);
    }
    if (f->as_json)
        facts_print_json(json_pack("{sO}", "suggested_vertices", list), JSON_INDENT(2));
    json_decref(list);
}

static mrt_result fit_any(fitting *f, error *err)
{
    mrt_result result = read_files(f, err);
    if (result >= 0 && f->suggest_count > 0) {
        result = suggest_contacts(f, err);
        if (result >= 0)
            print_suggestion(f);
        return result;
    }
    if (result >= 0)
        result = fit(f, err);
    if (result >= 0 && f->out_path)
        result = write_fitted(f, err);
    if (result >= 0 && f->poses_path)
        result = save_poses(f, err);
    if (result >= 0 && f->as_json)
        print_fit_json(f);
    else if (result >= 0)
        print_fit_text(f);
    return result;
}

static int rigfit_run(int argc, char **argv)
{
    fitting f = {0};
    error err = {""};
    int code = command_options(&f, &command_rig, fit_options_table, argc, argv);
    if (code == COMMAND_DONE && !f.targets_path)
        code = command_usage(
            &command_rig, "fit needs a rig and a mesh with morph targets; --suggest takes 1 to %d",
            SUGGEST_MAX);
    if (code == COMMAND_DONE && fit_any(&f, &err) < 0)
        code = command_failed(&command_rig, &err);
    fit_results_destroy(f.result, f.result_count);
    free(f.result);
    free(f.contact);
    mesh_destroy(&f.targets);
    face_file_destroy(&f.face);
    free(f.rig_path);
    return code;
}

/* ---- the command ---- */

static const command_part parts[] = {
    {"check", "list the problems of a rig", check_options, rigcheck_run},
    {"fit", "measure a rig against morph targets", fit_options_table, rigfit_run},
    {"new", "draft a rig for a mesh", new_options, rignew_run},
    {"show", "draw a rig, or list its poses", show_options, rigshow_run},
    {"teeth", "fit the collision shapes of the lips", teeth_options, rigteeth_run},
};
enum { PART_COUNT = sizeof parts / sizeof parts[0] };

static bool describe(command_part *out, command_option *options, size_t place)
{
    (void)options;
    if (place >= PART_COUNT)
        return false;
    *out = parts[place];
    return true;
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return command_usage(&command_rig, "choose check, show, new, fit or teeth");
    suggest near;
    suggest_begin(&near, argv[1]);
    for (size_t i = 0; i < PART_COUNT; ++i) {
        if (strcmp(argv[1], parts[i].name) == 0)
            return parts[i].run(argc - 1, argv + 1);
        suggest_consider(&near, parts[i].name);
    }
    return command_usage(&command_rig, "there is no command \"rig %s\"%s", argv[1],
                         suggest_question(&near).text);
}

const command command_rig = {
    .name = "rig",
    .summary = "draft, check, show and measure rigs",
    .help =
        "marotte rig check FILE.rig.json [--json]\n"
        "  Lists all problems of the rig, errors first, with their places in the file.\n"
        "  Exit code 1: the rig has errors. The names of installed rigs (puppet) work here too.\n"
        "\n"
        "marotte rig show FILE.rig.json --out PICTURE.png [--yaw DEGREES] [--pitch DEGREES]\n"
        "                [--size WxH]\n"
        "  Draws the rig from the front, from three quarters and from the side: a colour for each\n"
        "  bone (pale: cannot be pulled), the contacts with their names, the axis of the jaw, the\n"
        "  rims of the mouth.\n"
        "  --yaw and --pitch: draw only one view, from there; yaw turns to the subject's left.\n"
        "\n"
        "marotte rig show FILE.rig.json --poses [--only NAME,NAME...] [--out PICTURE.png]\n"
        "                [--yaw DEGREES] [--pitch DEGREES] [--size WxH]\n"
        "  Lists the rig's poses: the least determinant (above 0: no fold), the penetration of\n"
        "  skin into the skull, the vertex furthest from rest. --out: draw each pose.\n"
        "\n"
        "marotte rig new MESH [--out NAME.rig.json] [--unit mm|cm|m|MM] [--up AXIS]\n"
        "        [--forward AXIS] [--cut-mouth|--no-cut-mouth] [--force]\n"
        "  Drafts a rig for a mesh from its shape and the names of its parts, and lists what to\n"
        "  confirm. Closed lips with a clear groove are cut open, and get a dark bag behind\n"
        "  them; the mesh file is not changed. --cut-mouth: cut them without a clear groove,\n"
        "  too. --no-cut-mouth: never. --out: the file (the mesh's name with .rig.json).\n"
        "  --force: overwrite.\n"
        "\n"
        "marotte rig fit RIG.rig.json TARGETS.glb [--contacts SET] [--json] [--out FITTED.glb]\n"
        "                [--save-poses OUT.rig.json] [--suggest N]\n"
        "  Measures how well the rig reproduces morph targets (same vertices as the rig's mesh).\n"
        "  For each: the error that the best bone poses and pulls leave, relative to the target,\n"
        "  its worst vertex, the motion of rigid parts, the penetration into the skull, the\n"
        "  smallest Jacobian (above 0: no fold), and the error of the paper's unconstrained warp.\n"
        "  --contacts: a name in the rig's contact_sets. --out: write the fitted faces as "
        "targets.\n"
        "  --save-poses: write the rig with a pose for each target. --suggest: propose N more\n"
        "  contacts, in pairs.\n"
        "\n"
        "marotte rig teeth RIG.rig.json [--out OUT.rig.json]\n"
        "  Fits the collision shapes of the lips to the upper and lower teeth of the mesh, and\n"
        "  prints them as entries of skull_proxy. --out: write the rig with them in place of its\n"
        "  own.\n",
    .examples = "rig new girl.glb --out out/girl.rig.json\n"
                "rig check puppet\n"
                "rig show moai --out out/moai_rig.png\n"
                "rig show puppet --poses --only joy,surprise\n",
    .run = run,
    .part = describe,
};
