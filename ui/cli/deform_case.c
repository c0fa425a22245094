#include "cli/deform_case.h"

#include "base/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

static const double reach = (double)POINTS_REACH;

/* out: 3. */
static mrt_result read_row(double *out, const json_node *at, error *err)
{
    return json_node_numbers(out, 3, at, -reach, reach, "three numbers [x, y, z]", err);
}

/* out: one row for each element of the array. */
static mrt_result read_rows_into(double *out, const json_node *at, error *err)
{
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < json_array_size(at->value) && result >= 0; ++i) {
        json_node here = json_node_item(at, i);
        result = read_row(out + 3 * i, &here, err);
    }
    return result;
}

static mrt_result allocate(double **out, size_t count, error *err)
{
    *out = calloc(count + 1, sizeof **out);
    return *out ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for %zu numbers", count);
}

/* Reads rows of three numbers at `key` of the object, at most row_cap rows. */
static mrt_result read_rows(double **out, uint32_t *out_count, const json_node *object,
                            const char *key, uint32_t row_cap, error *err)
{
    json_node at = json_node_member(object, key);
    if (!json_is_array(at.value))
        return json_node_unexpected(err, &at, "an array of points [x, y, z]");
    if (json_array_size(at.value) > row_cap)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: %zu points are too many, at most %u",
                         at.path.text, json_array_size(at.value), row_cap);
    *out_count = (uint32_t)json_array_size(at.value);
    mrt_result result = allocate(out, (size_t)3 * *out_count, err);
    return result < 0 ? result : read_rows_into(*out, &at, err);
}

static mrt_result read_frames(deform_case *c, const json_node *root, error *err)
{
    json_node at = json_node_member(root, "frames");
    if (!json_is_array(at.value) || json_array_size(at.value) == 0)
        return json_node_unexpected(err, &at, "an array of at least one frame");
    size_t count = json_array_size(at.value), numbers = (size_t)3 * c->tip_count;
    if (count > DEFORM_NUMBER_CAP / (numbers + 3))
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: %zu frames are too many", at.path.text,
                         count);
    c->frame_count = (uint32_t)count;
    mrt_result result = allocate(&c->tip, count * numbers, err);
    for (size_t f = 0; result >= 0 && f < count; ++f) {
        json_node frame = json_node_item(&at, f);
        if (!json_is_array(frame.value) || json_array_size(frame.value) != c->tip_count) {
            char expected[64];
            (void)snprintf(expected, sizeof expected, "an array of %u points, as $.starts has",
                           c->tip_count);
            return json_node_unexpected(err, &frame, expected);
        }
        result = read_rows_into(c->tip + f * numbers, &frame, err);
    }
    return result;
}

/* Lists the keys of the object that are not in the NULL-ended list `known`. */
static void note_unknown(deform_case *c, const json_node *object, const char *const *known)
{
    void *at = NULL;
    for (const char *key; (key = json_node_unknown(object, known, &at)) != NULL;) {
        size_t used = strlen(c->unknown);
        (void)snprintf(c->unknown + used, sizeof c->unknown - used, "%s%s", used ? ", " : "",
                       json_node_member(object, key).path.text);
    }
}

static mrt_result read_pose(deform_case *c, size_t frame, const json_node *at, vec3 point,
                            vec3 axis, error *err)
{
    static const char *const known[] = {"angle", "translation", NULL};
    double angle = 0.0, translation[3] = {0.0};
    mrt_result result = json_node_object(at, "an object with angle and translation", err);
    if (result < 0)
        return result;
    note_unknown(c, at, known);
    json_node angle_at = json_node_member(at, "angle");
    json_node translation_at = json_node_member(at, "translation");
    result = json_node_number(&angle, &angle_at, -reach, reach, err);
    if (result >= 0)
        result = read_row(translation, &translation_at, err);
    if (result < 0)
        return result;
    c->pose[frame] = rigid_turn(point, axis, angle);
    c->pose[frame].t =
        vec3_add(c->pose[frame].t, (vec3){translation[0], translation[1], translation[2]});
    return MRT_OK;
}

static mrt_result read_axis(vec3 *out_point, vec3 *out_direction, const json_node *jaw, error *err)
{
    double point[3] = {0.0}, direction[3] = {0.0};
    json_node point_at = json_node_member(jaw, "axis_point");
    json_node direction_at = json_node_member(jaw, "axis_dir");
    mrt_result result = read_row(point, &point_at, err);
    if (result >= 0)
        result = read_row(direction, &direction_at, err);
    if (result < 0)
        return result;
    vec3 none = {0.0, 0.0, 0.0};
    *out_point = (vec3){point[0], point[1], point[2]};
    *out_direction = vec3_normalised((vec3){direction[0], direction[1], direction[2]}, none);
    if (vec3_dot(*out_direction, *out_direction) == 0.0)
        return error_set(err, MRT_ERR_FORMAT, "%s: expected a direction, but its length is 0",
                         direction_at.path.text);
    return MRT_OK;
}

static mrt_result read_jaw(deform_case *c, const json_node *root, error *err)
{
    static const char *const known[] = {"centres", "axis_point", "axis_dir", "poses", NULL};
    json_node jaw = json_node_member(root, "jaw");
    vec3 point, direction;
    if (!jaw.value)
        return MRT_OK;
    mrt_result result = json_node_object(&jaw, "an object with centres, axis and poses", err);
    if (result < 0)
        return result;
    note_unknown(c, &jaw, known);
    result = read_rows(&c->jaw, &c->jaw_count, &jaw, "centres", DEFORM_CENTRE_CAP, err);
    if (result >= 0)
        result = read_axis(&point, &direction, &jaw, err);
    if (result < 0)
        return result;
    json_node poses = json_node_member(&jaw, "poses");
    if (!json_is_array(poses.value) || json_array_size(poses.value) != c->frame_count) {
        char expected[64];
        (void)snprintf(expected, sizeof expected, "an array of %u poses, one per frame",
                       c->frame_count);
        return json_node_unexpected(err, &poses, expected);
    }
    c->pose = calloc(c->frame_count, sizeof *c->pose);
    if (!c->pose)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u poses", c->frame_count);
    for (size_t f = 0; result >= 0 && f < c->frame_count; ++f) {
        json_node pose = json_node_item(&poses, f);
        result = read_pose(c, f, &pose, point, direction, err);
    }
    return result;
}

/* Returns the text at `at`, or "" if the value is not a text. */
static const char *word_at(const json_node *at)
{
    const char *word = json_string_value(at->value);
    return word ? word : "";
}

static mrt_result read_settings(deform_case *c, const json_node *root, error *err)
{
    json_node kernel = json_node_member(root, "kernel"), mode = json_node_member(root, "mode");
    json_node polynomial = json_node_member(root, "polynomial");
    json_node radius = json_node_member(root, "radius");
    if (!csrbf_kernel_named(word_at(&kernel), &c->settings.kernel))
        return json_node_unexpected(
            err, &kernel, "\"wendland_c2\", \"wendland_c0\", \"wendland_c4\" or \"wendland_c6\"");
    if (!csrbf_polynomial_named(word_at(&polynomial), &c->settings.polynomial))
        return json_node_unexpected(err, &polynomial,
                                    "\"none\", \"constant\", \"linear\" or \"windowed\"");
    c->mode = strcmp(word_at(&mode), "anchored") == 0 ? DEFORM_ANCHORED : DEFORM_UNANCHORED;
    if (c->mode == DEFORM_UNANCHORED && strcmp(word_at(&mode), "unanchored") != 0)
        return json_node_unexpected(err, &mode, "\"anchored\" or \"unanchored\"");
    c->settings.radius = json_number_value(radius.value);
    if (!(c->settings.radius >= 1e-14 && c->settings.radius <= 1e14))
        return json_node_unexpected(err, &radius, "a number > 0, from 1e-14 to 1e14");
    return MRT_OK;
}

static mrt_result read_skull(deform_case *c, const json_node *root, error *err)
{
    if (!json_object_get(root->value, "skull"))
        return MRT_OK;
    return read_rows(&c->skull, &c->skull_count, root, "skull", DEFORM_CENTRE_CAP, err);
}

static mrt_result read_case(deform_case *c, const json_node *root, error *err)
{
    static const char *const known[] = {
        "name",  "comment", "kernel", "radius",   "polynomial", "mode",    "starts",  "frames",
        "skull", "jaw",     "points", "expected", "info",       "tol_f64", "tol_f32", NULL};
    mrt_result result = json_node_object(root, "an object", err);
    if (result < 0)
        return result;
    note_unknown(c, root, known);
    result = read_settings(c, root, err);
    if (result >= 0)
        result = read_rows(&c->start, &c->tip_count, root, "starts", DEFORM_CENTRE_CAP, err);
    if (result >= 0)
        result = read_frames(c, root, err);
    if (result >= 0)
        result = read_skull(c, root, err);
    if (result >= 0)
        result = read_jaw(c, root, err);
    if (result >= 0)
        result = read_rows(&c->point, &c->point_count, root, "points",
                           DEFORM_NUMBER_CAP / 3 / c->frame_count, err);
    if (result >= 0 && c->tip_count + c->skull_count + c->jaw_count > DEFORM_CENTRE_CAP)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "$: %u tips, %u skull and %u jaw centres are too many, at most %d",
                           c->tip_count, c->skull_count, c->jaw_count, DEFORM_CENTRE_CAP);
    return result;
}

mrt_result deform_case_read(deform_case *out, const void *bytes, size_t size, const char *name,
                            error *err)
{
    json_t *value;
    *out = (deform_case){.unknown = ""};
    mrt_result result = json_parse(&value, bytes, size, err);
    if (result >= 0) {
        json_node root = json_node_root(value, NULL);
        result = read_case(out, &root, err);
        json_decref(value);
    }
    if (result < 0) {
        error_prefix(err, name);
        deform_case_destroy(out);
    }
    return result;
}

void deform_case_destroy(deform_case *c)
{
    if (!c)
        return;
    free(c->start);
    free(c->tip);
    free(c->skull);
    free(c->jaw);
    free(c->pose);
    free(c->point);
    *c = (deform_case){.unknown = ""};
}

/* ---- running ---- */

static uint32_t control_count(const deform_case *c)
{
    return c->tip_count + c->skull_count + c->jaw_count;
}

static void copy_rows(double *out, const double *row, uint32_t count)
{
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        out[i] = row[i];
}

/* Writes the positions of tips, skull and jaw at one time, 0 .. frame_count. */
static void controls_at(const deform_case *c, uint32_t time, double *out)
{
    const double *tip =
        time == 0 ? c->start : c->tip + (size_t)3 * c->tip_count * (size_t)(time - 1);
    copy_rows(out, tip, c->tip_count);
    out += (size_t)3 * c->tip_count;
    copy_rows(out, c->skull, c->skull_count);
    out += (size_t)3 * c->skull_count;
    for (uint32_t i = 0; i < c->jaw_count; ++i, out += 3) {
        const double *rest = c->jaw + (size_t)3 * i;
        vec3 at = {rest[0], rest[1], rest[2]};
        if (time > 0)
            at = rigid_apply(&c->pose[time - 1], at);
        copy_rows(out, (const double[3]){at.x, at.y, at.z}, 1);
    }
}

/* Memory of a run. */
typedef struct run {
    csrbf_solver *solver;
    csrbf_class *class;
    double *from, *to; /* controls by 3: positions; `to` is then converted to displacements */
    points_order order;
    points rest, shown; /* float32 only */
    float *rows;        /* point_count by 3 */
} run;

static mrt_result run_create(run *r, const deform_case *c, error *err)
{
    size_t controls = control_count(c), numbers = (size_t)3 * c->point_count;
    *r = (run){.solver = csrbf_solver_create(control_count(c)),
               .class = calloc(controls + 1, sizeof *r->class),
               .from = calloc(3 * controls + 1, sizeof *r->from),
               .to = calloc(3 * controls + 1, sizeof *r->to),
               .rows = calloc(numbers + 1, sizeof *r->rows)};
    if (!r->solver || !r->class || !r->from || !r->to || !r->rows) /* run_destroy frees the rest */
        return error_set(err, MRT_ERR_MEMORY, "no memory for %zu controls", controls); // NOLINT
    for (size_t i = c->tip_count; i < controls; ++i)
        r->class[i] = i < c->tip_count + c->skull_count ? CSRBF_SKULL : CSRBF_JAW;
    for (size_t i = 0; i < numbers; ++i)
        r->rows[i] = (float)c->point[i];
    mrt_result result = points_order_create(&r->order, r->rows, c->point_count, err);
    if (result >= 0)
        result = points_create(&r->rest, &r->order, r->rows, err);
    if (result >= 0)
        result = points_create(&r->shown, &r->order, r->rows, err);
    return result;
}

static void run_destroy(run *r)
{
    csrbf_solver_destroy(r->solver);
    free(r->class);
    free(r->from);
    free(r->to);
    free(r->rows);
    points_order_destroy(&r->order);
    points_destroy(&r->rest);
    points_destroy(&r->shown);
}

/* Solves for the field that moves the controls from their places at one time to those at
 * another. */
static mrt_result solve_way(run *r, const deform_case *c, uint32_t from, uint32_t to, error *err)
{
    uint32_t controls = control_count(c);
    controls_at(c, from, r->from);
    controls_at(c, to, r->to);
    if (c->mode == DEFORM_UNANCHORED || to == 1) {
        mrt_result result = csrbf_factor(r->solver, &c->settings, r->from, r->class, controls, err);
        if (result < 0)
            return result;
    }
    for (size_t i = 0; i < (size_t)3 * controls; ++i)
        r->to[i] -= r->from[i];
    return csrbf_solve(r->solver, r->to, err);
}

/* Writes the positions after this frame. out: point_count by 3; before: the positions that the
 * field moves. */
static void move_points(run *r, const deform_case *c, deform_precision precision,
                        const double *before, double *out)
{
    size_t numbers = (size_t)3 * c->point_count;
    if (precision == DEFORM_F64) {
        copy_rows(out, before, c->point_count);
        csrbf_move_f64(r->solver, out, c->point_count);
        return;
    }
    csrbf_move(r->solver, &r->shown, c->mode == DEFORM_ANCHORED ? &r->rest : &r->shown);
    points_to_rows(r->rows, &r->shown, &r->order);
    for (size_t i = 0; i < numbers; ++i)
        out[i] = (double)r->rows[i];
}

static mrt_result check_points(const double *row, uint32_t count, error *err)
{
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        if (!(fabs(row[i]) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_UNSUPPORTED, "point %zu is moved beyond +-1e15", i / 3);
    return MRT_OK;
}

mrt_result deform_case_run(const deform_case *c, deform_precision precision, double *out,
                           error *err)
{
    run r;
    size_t numbers = (size_t)3 * c->point_count;
    mrt_result result = run_create(&r, c, err);
    for (uint32_t frame = 0; result >= 0 && frame < c->frame_count; ++frame) {
        bool anchored = c->mode == DEFORM_ANCHORED;
        const double *before = anchored || frame == 0 ? c->point : out + (frame - 1) * numbers;
        result = solve_way(&r, c, anchored ? 0 : frame, frame + 1, err);
        if (result >= 0) {
            move_points(&r, c, precision, before, out + frame * numbers);
            result = check_points(out + frame * numbers, c->point_count, err);
        }
        if (result < 0) {
            char path[32];
            (void)snprintf(path, sizeof path, "$.frames[%u]", frame);
            error_prefix(err, path);
        }
    }
    run_destroy(&r);
    return result;
}
