#include "coverage_face.h"

#include "base/clock.h"
#include "mesh/position.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void must(mrt_result result, const error *err)
{
    if (result >= 0)
        return;
    (void)fprintf(stderr, "coverage: %s\n", err->text);
    exit(1);
}

void *allocate(size_t count, size_t size)
{
    void *out = calloc(count + 1, size);
    if (!out) {
        (void)fprintf(stderr, "coverage: no memory\n");
        exit(1);
    }
    return out;
}

/* ---- the face: which points count ---- */

static const double lips_radius_mm = 12.0, brows_radius_mm = 12.0, iris_radius_mm = 12.0;

static bool is_near(const mesh *m, vec3 at, const uint32_t *vertex, uint32_t count,
                    double radius_mm)
{
    for (uint32_t i = 0; i < count; ++i)
        if (vec3_length(vec3_sub(at, mesh_position(m, vertex[i]))) <= radius_mm)
            return true;
    return false;
}

static bool is_near_brow(const scene *s, vec3 at)
{
    const rig *r = s->file.rig;
    for (uint32_t i = 0; i < r->contact_count; ++i)
        if (starts(r->contact[i].name, "brow") &&
            is_near(&s->file.mesh, at, &r->contact[i].vertex, 1, brows_radius_mm))
            return true;
    return false;
}

static uint32_t find_bone(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (strcmp(r->bone[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

static bool belongs(const scene *s, region of, uint32_t v, bool is_skin, bool is_lid)
{
    const rig *r = s->file.rig;
    const mesh *m = &s->file.mesh;
    const binding *b = face_binding(composer_face(s->still->composer));
    const bool is_free = is_skin && b->mobility[v] > 0.0f;
    const vec3 at = mesh_position(m, v);
    const uint32_t tongue = find_bone(r, "tongue");
    switch (of) {
    case LIPS:
        return is_free && (is_near(m, at, r->mouth.upper, r->mouth.upper_count, lips_radius_mm) ||
                           is_near(m, at, r->mouth.lower, r->mouth.lower_count, lips_radius_mm));
    case BROWS:
        return is_free && is_near_brow(s, at);
    case LIDS:
        return is_lid;
    case TONGUE:
        return tongue != RIG_NONE && b->weight[(size_t)tongue * b->vertex_count + v] > 0.5f;
    default:
        return false;
    }
}

static void mark_regions(scene *s)
{
    const mesh *m = &s->file.mesh;
    const rig *r = s->file.rig;
    bool *is_skin = allocate(m->vertex_count, sizeof *is_skin);
    bool *is_lid = allocate(m->vertex_count, sizeof *is_lid);
    uint32_t count = 0;
    s->vertex = allocate((size_t)m->vertex_count * 2 + 16, sizeof *s->vertex);
    for (uint32_t p = 0; p < m->part_count; ++p)
        for (size_t i = 0; i < (size_t)3 * m->part[p].triangle_count; ++i) {
            const uint32_t v = m->triangle[(size_t)3 * m->part[p].first_triangle + i];
            is_skin[v] = is_skin[v] || !starts(m->part[p].name, "mouth");
            is_lid[v] = is_lid[v] || starts(m->part[p].name, "lid_");
        }
    s->skull = find_bone(r, "skull");
    for (uint32_t i = 0; i < r->bone_count && s->eye_count < 2; ++i)
        if (starts(r->bone[i].name, "eye."))
            s->eye[s->eye_count++] = i;
    for (region of = 0; of < REGIONS; ++of) {
        s->first[of] = count;
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            if (belongs(s, of, v, is_skin[v], is_lid[v]))
                s->vertex[count++] = v;
        if (of == IRIS)
            count += s->eye_count;
        if (of == HEAD)
            count += s->skull != RIG_NONE;
    }
    s->first[REGIONS] = count;
    free(is_skin);
    free(is_lid);
    if (s->first[LIPS] == s->first[LIPS + 1])
        must(MRT_ERR_FORMAT, &(error){"the face has no lips: a rig with \"mouth\" is needed"});
}

/* Where the points are in the face shown: in the skull's frame, but for the head itself. out: by 3.
 */
void measure_points(const scene *s, const face *f, double *out)
{
    rigid pose[RIG_BONES_MAX], back = rigid_identity();
    const bones *b = face_bones(f);
    const points_order *order = face_order(f);
    bones_pose(pose, b, face_metered(f)->dof);
    if (s->skull != RIG_NONE)
        back = rigid_inverse(&pose[s->skull]);
    for (uint32_t i = 0; i < s->first[REGIONS]; ++i) {
        const bool is_iris = i >= s->first[IRIS] && i < s->first[IRIS + 1];
        const vec3 ahead = {0.0, 0.0, iris_radius_mm};
        if (i >= s->first[HEAD]) {
            set_row(out, i, rigid_rotate(&pose[s->skull], ahead));
        } else if (is_iris) {
            const uint32_t bone = s->eye[i - s->first[IRIS]];
            const vec3 at = vec3_add(b->rig->bone[bone].centre, ahead);
            set_row(out, i, rigid_apply(&back, rigid_apply(&pose[bone], at)));
        } else {
            double at[3];
            points_at(at, face_shown(f), order->slot_of_file[s->vertex[i]]);
            set_row(out, i, rigid_apply(&back, (vec3){at[0], at[1], at[2]}));
        }
    }
}

/* Root mean square and greatest distance of the points of a region, mm; 0 of a region without. */
double region_rms(const scene *s, region of, const double *a, const double *b)
{
    double sum = 0.0;
    const size_t begin = 3 * (size_t)s->first[of], end = 3 * (size_t)s->first[of + 1];
    for (size_t i = begin; i < end; ++i)
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    return end > begin ? sqrt(3.0 * sum / (double)(end - begin)) : 0.0;
}

double region_most(const scene *s, region of, const double *a, const double *b)
{
    double most = 0.0;
    for (size_t i = s->first[of]; i < s->first[of + 1]; ++i) {
        const double x = a[3 * i] - b[3 * i], y = a[3 * i + 1] - b[3 * i + 1],
                     z = a[3 * i + 2] - b[3 * i + 2];
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most;
}

double upper_most(const scene *s, const double *a, const double *b)
{
    double most = 0.0;
    for (region of = BROWS; of < TONGUE; ++of)
        most = fmax(most, region_most(s, of, a, b));
    return most;
}

size_t point_numbers(const scene *s)
{
    return 3 * (size_t)s->first[REGIONS];
}

/* ---- performing ---- */

static bool holds_the_same(const mrt_pull *a, const mrt_pull *b)
{
    if (a->anchor != b->anchor || a->count != b->count || a->commit != b->commit)
        return false;
    for (uint32_t i = 0; i < a->count; ++i)
        if (a->vector[i].contact != b->vector[i].contact ||
            memcmp(&a->vector[i].start, &b->vector[i].start, sizeof a->vector[i].start) != 0)
            return false;
    return true;
}

/* By the engine, with its fold guard; out: points by 3, or NULL. */
face *perform(scene *s, const mrt_pull *pull, double *out)
{
    composer *c = s->still->composer;
    const composer_part part = {.is_fresh = true, .weight = 1.0, .gain = 1.0, .pull = pull};
    if (!holds_the_same(pull, &s->last_performed))
        composer_reset(c);
    s->last_performed = *pull;
    composer_move(c, &part, 1, 0.01);
    composer_draw(c);
    s->performances += 1;
    if (out)
        measure_points(s, composer_face(c), out);
    return composer_face(c);
}

/* ---- a mapping with a hand that is held ---- */

static const double hold_dt_s =
    0.1; /* the longest step of a mrt_frame: time constants settle soon */
enum { HOLD_LEAST = 3, HOLD_MOST = 25, NEUTRAL_FRAMES = 100 };
static const float settled_mm = 1e-3f;

/* The difference that a frame makes: mm, rad counted as 100 mm. */
static float pull_change(const scene *s, const mrt_pull *a, const mrt_pull *b)
{
    float most = a->count == b->count ? 0.0f : INFINITY;
    for (uint32_t i = 0; i < a->count && i < b->count; ++i) {
        const mrt_vec3 p = a->vector[i].end, q = b->vector[i].end;
        most = fmaxf(most, fmaxf(fabsf(p.x - q.x), fmaxf(fabsf(p.y - q.y), fabsf(p.z - q.z))));
    }
    for (uint32_t i = 0; i < s->dof_count; ++i)
        if (!isnan(a->dof[i]) && !isnan(b->dof[i]))
            most = fmaxf(most, 100.0f * fabsf(a->dof[i] - b->dof[i]));
    return most;
}

static void map_frame(scene *s, double dt_s, mrt_pull *pull)
{
    s->frame.dt_s = s->frame.time_ns == 0 ? 0.0 : dt_s;
    s->frame.time_ns += (int64_t)(dt_s * 1e9);
    s->frame.hand[MRT_RIGHT].time_ns = s->input.time_ns = s->frame.time_ns;
    instance_latch(&s->mapping);
    s->frame.params = s->mapping.params;
    const mrt_pull before = *pull;
    const mrt_result result = s->functions->process(s->mapping.self, &s->frame, pull);
    if (result == MRT_HOLD)
        *pull = before;
    if (result < 0)
        must(result, &(error){"the mapping's process() failed"});
}

static void hold_out(scene *s, const float *angle_rad)
{
    mrt_hand *hand = &s->frame.hand[MRT_RIGHT];
    const rigid still = rigid_identity();
    hand_reading reading = s->device.neutral;
    device_measure(&s->device, angle_rad, NULL, &reading, s->value);
    device_angles(&s->device, s->value, hand->angle);
    hand_pose(s->device.skeleton, hand->angle, &still, hand->joint, hand->palm);
    hand->present = true;
}

static void settle(scene *s, mrt_pull *pull)
{
    for (int i = 0; i < HOLD_MOST; ++i) {
        const mrt_pull before = *pull;
        map_frame(s, hold_dt_s, pull);
        if (i + 1 >= HOLD_LEAST && pull_change(s, &before, pull) < settled_mm)
            break;
    }
    s->evaluations += 1;
}

static void begin_at_neutral(scene *s, mrt_pull *pull)
{
    s->functions->reset(s->mapping.self);
    *pull = (mrt_pull){0};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    s->frame.time_ns = 0;
    hold_out(s, s->neutral_rad);
    for (int i = 0; i < NEUTRAL_FRAMES; ++i)
        map_frame(s, 0.01, pull);
    settle(s, pull);
}

/* The device performs from now on: its neutral hand comes first, and is remembered. */
void use_device(scene *s, device_kind kind)
{
    device_finish(&s->device);
    device_init(&s->device, kind, s->neutral_rad);
    s->input = (mrt_channels){.name = device_table[kind].input,
                              .channel = s->device.route.table.channel,
                              .value = s->value,
                              .count = s->device.count};
    s->frame = (mrt_frame){.near = true, .inputs = &s->input, .input_count = 1};
    begin_at_neutral(s, &s->neutral_pull);
    s->neutral_ns = s->frame.time_ns;
    s->state_size = s->resume ? s->resume->save(s->mapping.self, NULL, 0) : 0;
    free(s->state);
    s->state = allocate(s->state_size, 1);
    if (s->state_size > 0)
        (void)s->resume->save(s->mapping.self, s->state, s->state_size);
}

double process_us(scene *s, const float *angle_rad)
{
    enum { CALLS = 20000 };
    mrt_pull pull;
    map_hand(s, angle_rad, &pull);
    const int64_t start_ns = clock_now_ns();
    for (int i = 0; i < CALLS; ++i)
        map_frame(s, hold_dt_s, &pull);
    return 1e-3 * (double)(clock_now_ns() - start_ns) / CALLS;
}

/* From the neutral pose at once to this one, which is held until the pull settles. */
void map_hand(scene *s, const float *angle_rad, mrt_pull *out)
{
    if (s->state_size > 0 && s->resume->load(s->mapping.self, s->state, s->state_size) >= 0) {
        *out = s->neutral_pull;
        s->frame.time_ns = s->neutral_ns;
    } else {
        begin_at_neutral(s, out);
    }
    hold_out(s, angle_rad);
    settle(s, out);
}

/* The same from the hand of before. */
void map_on(scene *s, const float *angle_rad, mrt_pull *pull)
{
    hold_out(s, angle_rad);
    settle(s, pull);
}

/* ---- the linear model of the face ---- */

/* Contact offsets (contact by 3, mm) and degrees of freedom, those not driven as 0. */
void read_params(const scene *s, const mrt_pull *pull, double *out)
{
    memset(out, 0, s->param_count * sizeof *out);
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (v->contact == 0 || v->contact > s->contact_count)
            continue;
        double *at = out + 3 * (size_t)(v->contact - 1);
        at[0] = to_double(v->end.x) - to_double(v->start.x);
        at[1] = to_double(v->end.y) - to_double(v->start.y);
        at[2] = to_double(v->end.z) - to_double(v->start.z);
    }
    for (uint32_t i = 0; i < s->dof_count; ++i)
        if (!isnan(pull->dof[i]))
            out[3 * s->contact_count + i] = to_double(pull->dof[i]);
}

/* All contacts held, as far as the neutral pull of the mapping holds them in its order. */
mrt_pull pull_of_params(const scene *s, const double *param)
{
    mrt_pull out = {.mode = MRT_ANCHORED, .count = s->contact_count};
    for (uint32_t i = 0; i < s->contact_count; ++i) {
        const mrt_vec3 rest = s->contact[i].rest;
        out.vector[i] =
            (mrt_vector){rest,
                         {rest.x + (float)param[3 * i], rest.y + (float)param[3 * i + 1],
                          rest.z + (float)param[3 * i + 2]},
                         1 + i};
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] =
            (uint32_t)i < s->dof_count ? (float)param[3 * s->contact_count + (uint32_t)i] : NAN;
    return out;
}

static double model_amount(const scene *s, uint32_t param)
{
    if (param < 3 * s->contact_count)
        return 2.0;
    const bones_dof *d =
        &face_bones(composer_face(s->still->composer))->dof[param - 3 * s->contact_count];
    const double furthest = to_double(-d->min > d->max ? d->min : d->max);
    return d->unit[0] ? 0.4 * furthest : furthest;
}

/* Pivoted Cholesky of the Gram matrix of the responses. response: param_count by numbers of all. */
static void model_region(features *out, const scene *s, region of, const double *response)
{
    const uint32_t n = s->param_count;
    const size_t all = point_numbers(s);
    double *gram = allocate((size_t)n * n, sizeof *gram), *column = allocate(n, sizeof *column);
    double trace = 0.0;
    out->first = 3 * (size_t)s->first[of];
    out->numbers = 3 * (size_t)(s->first[of + 1] - s->first[of]);
    out->of = allocate((size_t)n * n, sizeof *out->of);
    for (uint32_t i = 0; i < n; ++i)
        for (uint32_t k = 0; k <= i; ++k) {
            double sum = 0.0;
            for (size_t j = 0; j < out->numbers; ++j)
                sum += response[i * all + out->first + j] * response[k * all + out->first + j];
            gram[i * n + k] = gram[k * n + i] =
                out->numbers ? 3.0 * sum / (double)out->numbers : 0.0;
        }
    for (uint32_t i = 0; i < n; ++i)
        trace = fmax(trace, gram[i * n + i]);
    for (out->count = 0; out->count < n; ++out->count) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < n; ++i)
            best = gram[i * n + i] > gram[best * n + best] ? i : best;
        const double diagonal = gram[best * n + best];
        if (!(diagonal > 1e-6 * trace) || !(diagonal > 1e-12))
            break;
        for (uint32_t i = 0; i < n; ++i)
            column[i] = gram[i * n + best] / sqrt(diagonal);
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t k = 0; k < n; ++k)
                gram[i * n + k] -= column[i] * column[k];
        memcpy(out->of + (size_t)out->count * n, column, n * sizeof *column);
        out->pivot[out->count] = best;
    }
    out->triangle = allocate((size_t)out->count * out->count, sizeof *out->triangle);
    out->direction = allocate(out->count * out->numbers, sizeof *out->direction);
    for (uint32_t i = 0; i < out->count; ++i) {
        for (uint32_t k = 0; k <= i; ++k)
            out->triangle[i * out->count + k] = out->of[(size_t)k * n + out->pivot[i]];
        memcpy(out->direction + i * out->numbers, response + out->pivot[i] * all + out->first,
               out->numbers * sizeof *response);
    }
    free(gram);
    free(column);
}

void model_init(model *out, scene *s)
{
    const size_t all = point_numbers(s);
    double param[PARAMS_MAX] = {0},
           *response = allocate((size_t)s->param_count * all, sizeof *response);
    *out = (model){.rest = allocate(all, sizeof *out->rest)};
    mrt_pull pull = pull_of_params(s, param);
    (void)perform(s, &pull, out->rest);
    for (uint32_t i = 0; i < s->param_count; ++i) {
        double *row = response + i * all;
        param[i] = model_amount(s, i);
        pull = pull_of_params(s, param);
        (void)perform(s, &pull, row);
        for (size_t j = 0; j < all; ++j)
            row[j] = (row[j] - out->rest[j]) / param[i];
        param[i] = 0.0;
    }
    for (region of = 0; of < REGIONS; ++of) {
        model_region(&out->region[of], s, of, response);
        out->first[of + 1] = out->first[of] + out->region[of].count;
    }
    free(response);
}

void model_finish(model *m)
{
    for (region of = 0; of < REGIONS; ++of) {
        free(m->region[of].of);
        free(m->region[of].triangle);
        free(m->region[of].direction);
    }
    free(m->rest);
}

/* All features, of parameters. */
void model_of_params(const model *m, const scene *s, const double *param, float *out)
{
    for (region of = 0; of < REGIONS; ++of)
        for (uint32_t i = 0; i < m->region[of].count; ++i) {
            const double *row = m->region[of].of + (size_t)i * s->param_count;
            double sum = 0.0;
            for (uint32_t k = 0; k < s->param_count; ++k)
                sum += row[k] * param[k];
            *out++ = (float)sum;
        }
}

/* All features, of points that the engine has shown: what the responses explain of them. */
void model_of_points(const model *m, const double *point, float *out)
{
    for (region of = 0; of < REGIONS; ++of) {
        const features *f = &m->region[of];
        for (uint32_t i = 0; i < f->count; ++i) {
            const double *along = f->direction + i * f->numbers;
            double sum = 0.0;
            for (size_t j = 0; j < f->numbers; ++j)
                sum += along[j] * (point[f->first + j] - m->rest[f->first + j]);
            sum *= 3.0 / (double)f->numbers;
            for (uint32_t k = 0; k < i; ++k)
                sum -= f->triangle[i * f->count + k] * to_double(out[k]);
            out[i] = (float)(sum / f->triangle[i * f->count + i]);
        }
        out += f->count;
    }
}

/* ---- made and unmade ---- */

static void create_mapping(scene *s, instance *out, performer **out_performer,
                           const mrt_plugin_type *type, const char *params)
{
    error err = {""};
    const performer_settings settings = {.rezero_pedal = 0};
    must(instance_create(out, type, CLOCK_VIRTUAL, s->log, &err), &err);
    must(instance_set_list(out, params, &err), &err);
    must(performer_create(out_performer, &s->file, out, &settings, &err), &err);
}

void scene_init(scene *s, const char *face_path, const char *map, const float *neutral_rad)
{
    error err = {""};
    char name[64], path[1024];
    const size_t length = strcspn(map, ",");
    const mrt_plugin_type *type = NULL;
    (void)snprintf(name, sizeof name, "%.*s", (int)length, map);
    (void)snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, name);
    must(face_file_read(&s->file, face_path, NULL, FACE_FILE_USABLE, &err), &err);
    if (!s->file.rig)
        must(MRT_ERR_ARGUMENT, &(error){"the face has no rig"});
    s->log = log_queue_create();
    must(plugin_list_add(&s->plugins, path, &err), &err);
    must(plugin_list_find(&s->plugins, name, MRT_MAPPING, &type, &err), &err);
    const char *params = map[length] == ',' ? map + length + 1 : "";
    create_mapping(s, &s->mapping, &s->still, type, params);
    create_mapping(s, &s->live_mapping, &s->live, type, params);
    s->functions = plugin_interface(type, MRT_MAPPING);
    s->resume = plugin_interface(type, MRT_RESUME);
    memcpy(s->neutral_rad, neutral_rad, sizeof s->neutral_rad);
    s->contact = face_contacts(composer_face(s->still->composer), &s->contact_count);
    s->dof_count = face_bones(composer_face(s->still->composer))->dof_count;
    s->param_count = 3 * s->contact_count + s->dof_count;
    if (s->contact_count > MRT_MAX_VECTORS)
        must(MRT_ERR_ARGUMENT, &(error){"the face has more contacts than can be held at once"});
    mark_regions(s);
}

void scene_finish(scene *s)
{
    log_record record;
    while (log_pop(s->log, &record))
        if (record.level >= MRT_LOG_WARNING)
            (void)fprintf(stderr, "coverage: %s: %s\n", record.source, record.text);
    performer_destroy(s->still);
    performer_destroy(s->live);
    instance_destroy(&s->mapping);
    instance_destroy(&s->live_mapping);
    plugin_list_destroy(&s->plugins);
    log_queue_destroy(s->log);
    device_finish(&s->device);
    face_file_destroy(&s->file);
    free(s->vertex);
    free(s->state);
}
