/* marotte rig fit: can this rig make these faces? */
#include "rigfit.h"

#include "base/json.h"
#include "terminal.h"

#include "base/text.h"
#include "face/fit.h"
#include "io/export.h"
#include "stage/perform/face_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SUGGEST_MAX = 256 };

typedef struct fitting {
    const char *rig_path, *targets_path, *set_name, *out_path, *poses_path;
    uint32_t suggest_count;
    bool as_json;
    face_file face;
    mesh targets;
    uint32_t *contact; /* those that may be pulled */
    uint32_t contact_count;
    fit_result *result; /* targets.target_count */
    uint32_t result_count;
    uint32_t suggested[SUGGEST_MAX], suggested_count;
} fitting;

/* ---- what is asked ---- */

static bool read_count(uint32_t *out, const char *word)
{
    int64_t value;
    if (!text_int(text_view_of(word, strlen(word)), &value) || value < 1 || value > SUGGEST_MAX)
        return false;
    *out = (uint32_t)value;
    return true;
}

static bool read_options(fitting *f, int argc, char **argv)
{
    for (int i = 1; i < argc; ++i) {
        const char *value = i + 1 < argc ? argv[i + 1] : NULL;
        const char **text = strcmp(argv[i], "--contacts") == 0     ? &f->set_name
                            : strcmp(argv[i], "--out") == 0        ? &f->out_path
                            : strcmp(argv[i], "--save-poses") == 0 ? &f->poses_path
                                                                   : NULL;
        if (strcmp(argv[i], "--json") == 0) {
            f->as_json = true;
        } else if (text && value) {
            *text = value;
            i += 1;
        } else if (strcmp(argv[i], "--suggest") == 0 && value &&
                   read_count(&f->suggest_count, value)) {
            i += 1;
        } else if (argv[i][0] != '-' && !f->rig_path) {
            f->rig_path = argv[i];
        } else if (argv[i][0] != '-' && !f->targets_path) {
            f->targets_path = argv[i];
        } else {
            return false;
        }
    }
    return f->rig_path && f->targets_path;
}

static mrt_result choose_contacts(fitting *f, error *err)
{
    const rig *r = f->face.rig;
    const rig_contact_set *set = f->set_name ? rig_find_contact_set(r, f->set_name) : NULL;
    if (f->set_name && !set)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: $.contact_sets has no \"%s\"; add it, or leave --contacts away to "
                         "use them all",
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
    mrt_result result = face_file_read(&f->face, f->rig_path, NULL, FACE_FILE_USABLE, err);
    if (result >= 0 && !f->face.rig)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: is a mesh; marotte rig new drafts a rig for it", f->rig_path);
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

/* ---- the work ---- */

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

static mrt_result suggest(fitting *f, error *err)
{
    const face_file *file = &f->face;
    return fit_suggest(f->suggested, &f->suggested_count, f->suggest_count, file->rig, &file->mesh,
                       &file->topology, &f->targets, &file->rig->solver, err);
}

/* ---- the faces as a file ---- */

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

/* To what a file needs: 0.01 degrees, 0.01 mm. */
static double rounded(double value)
{
    return round(100.0 * value) / 100.0;
}

static double rounded_dof(const bones_dof *dof, double value)
{
    const double radian_per_degree = 0.017453292519943295;
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

/* In the place of a pose of that name, or after the others. */
static mrt_result put_pose(rig *r, rig_pose *pose, error *err)
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
    mrt_result result = bones_init(&b, r, (vec3){0}, err); /* for the names alone */
    for (uint32_t i = 0; result >= 0 && i < f->result_count; ++i) {
        rig_pose pose;
        result = fill_pose(&pose, f, &b, &f->result[i])
                     ? put_pose(r, &pose, err)
                     : error_set(err, MRT_ERR_MEMORY, "no memory for a pose");
        if (result < 0)
            rig_pose_finish(&pose);
    }
    return result < 0 ? result : rig_write(r, f->poses_path, err);
}

/* ---- what is said ---- */

typedef struct means {
    double residual, paper_residual, worst_mm, rigid_mm, penetration_mm, determinant;
} means;

/* Means of the residuals; the worst of the rest. */
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

static void print_text(const fitting *f)
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

static void print_json(const fitting *f)
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
    json_dumpf(out, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    putchar('\n');
    json_decref(out);
}

static void print_suggestion(const fitting *f)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < f->suggested_count; ++i)
        json_array_append_new(list, json_integer((json_int_t)f->suggested[i]));
    for (uint32_t i = 0; !f->as_json && i < f->suggested_count; ++i) {
        const float *p = f->face.mesh.position + (size_t)f->suggested[i] * 3;
        terminal_print("suggested  vertex %6u at (%6.1f, %6.1f, %6.1f) mm\n", f->suggested[i],
                       (double)p[0], (double)p[1], (double)p[2]);
    }
    if (f->as_json) {
        json_t *out = json_pack("{sO}", "suggested_vertices", list);
        json_dumpf(out, stdout, JSON_INDENT(2));
        putchar('\n');
        json_decref(out);
    }
    json_decref(list);
}

static mrt_result work(fitting *f, error *err)
{
    mrt_result result = read_files(f, err);
    if (result >= 0 && f->suggest_count > 0) {
        result = suggest(f, err);
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
        print_json(f);
    else if (result >= 0)
        print_text(f);
    return result;
}

int rigfit_run(int argc, char **argv)
{
    fitting f = {0};
    error err = {""};
    if (!read_options(&f, argc, argv))
        return command_usage(&command_rig,
                             "fit takes a rig and a mesh with morph targets, --contacts SET, "
                             "--json, --out, --save-poses, --suggest 1..%d",
                             SUGGEST_MAX);
    mrt_result result = work(&f, &err);
    fit_results_destroy(f.result, f.result_count);
    free(f.result);
    free(f.contact);
    mesh_destroy(&f.targets);
    face_file_destroy(&f.face);
    return result < 0 ? command_failed(&command_rig, &err) : COMMAND_DONE;
}
