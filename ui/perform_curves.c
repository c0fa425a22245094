#include "perform_curves.h"

#include "base/cancel.h"
#include "io/curves.h"
#include "recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns of the table; CURVE_TABLE_NONE: it has none of that name. */
typedef struct curve_columns {
    uint32_t dof[MRT_MAX_DOFS];
    uint32_t *contact;                  /* 3 for each */
    uint32_t point[MRT_MAX_VECTORS][6]; /* of free points: start, end */
    uint32_t anchor, commit, radius, kernel, polynomial, stretch_most;
    uint32_t used_count;
} curve_columns;

typedef struct curve_performance {
    const perform_options *options;
    curve_table table;
    curve_columns at;
    face_file face;
    composer *composer;
    csrbf_settings solver;
    recording recording;
    exports_video videos;
    progress progress;
    double fps;
} curve_performance;

/* ---- which column is what ---- */

static mrt_result find_column(curve_performance *self, uint32_t *out, const char *name, error *err)
{
    const curve_table *t = &self->table;
    *out = curve_table_find(t, name);
    if (*out == CURVE_TABLE_NONE)
        return MRT_OK;
    self->at.used_count += 1;
    if (t->bad_row[*out] > 0)
        return error_set(err, MRT_ERR_FORMAT, "%s:%u: %s is not a number", self->options->curves,
                         t->line[t->bad_row[*out] - 1], name);
    return MRT_OK;
}

static mrt_result find_vector(curve_performance *self, uint32_t out[3], const char *name,
                              error *err)
{
    mrt_result result = MRT_OK;
    for (int axis = 0; axis < 3 && result >= 0; ++axis) {
        char column[160];
        (void)snprintf(column, sizeof column, "%s.%c", name, "xyz"[axis]);
        result = find_column(self, &out[axis], column, err);
    }
    return result;
}

static mrt_result find_points(curve_performance *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t k = 0; k < MRT_MAX_VECTORS && result >= 0; ++k) {
        char start[32], end[32];
        (void)snprintf(start, sizeof start, "control%u.start", k + 1);
        (void)snprintf(end, sizeof end, "control%u.end", k + 1);
        result = find_vector(self, self->at.point[k], start, err);
        if (result >= 0)
            result = find_vector(self, self->at.point[k] + 3, end, err);
    }
    return result;
}

static mrt_result find_columns(curve_performance *self, error *err)
{
    const mrt_face *about = composer_about(self->composer);
    curve_columns *at = &self->at;
    mrt_result result = MRT_OK;
    at->contact = calloc((size_t)about->contact_count * 3 + 1, sizeof *at->contact);
    if (!at->contact)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u contacts", about->contact_count);
    for (uint32_t i = 0; i < about->dof_count && result >= 0; ++i)
        result = find_column(self, &at->dof[i], about->dofs[i].name, err);
    for (uint32_t i = 0; i < about->contact_count && result >= 0; ++i)
        result = find_vector(self, at->contact + 3 * i, about->contacts[i].name, err);
    if (result >= 0)
        result = find_points(self, err);
    const struct {
        uint32_t *column;
        const char *name;
    } solver[] = {
        {&at->anchor, "solver.anchor"},         {&at->commit, "solver.commit"},
        {&at->radius, "solver.radius"},         {&at->kernel, "solver.kernel"},
        {&at->polynomial, "solver.polynomial"}, {&at->stretch_most, "solver.stretch_most"}};
    uint32_t found = at->used_count;
    for (size_t i = 0; i < sizeof solver / sizeof *solver && result >= 0; ++i)
        result = find_column(self, solver[i].column, solver[i].name, err);
    if (result >= 0 && found == 0)
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: no column is a degree of freedom or contact of %s; such as \"%s\"",
                           self->options->curves, self->options->face,
                           about->dof_count > 0 ? about->dofs[0].name : "control1.start.x");
    return result;
}

/* It labels a row, or says what the pulls made of the head's own shapes. */
static bool is_told_only(const curve_performance *self, const char *column)
{
    static const char *const labels[] = {"frame", "timecode", "time_s", "shape"};
    const face *f = composer_face(self->composer);
    bool is = false;
    for (size_t i = 0; i < sizeof labels / sizeof *labels; ++i)
        is = is || strcmp(column, labels[i]) == 0;
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        is = is || strncmp(column, face_shape_name(f, i), strlen(face_shape_name(f, i))) == 0;
    return is;
}

/* What nobody has used: a mistake in a name, or another face's. */
static void tell_unused(const curve_performance *self)
{
    uint32_t told_only = 0, unused = self->table.column_count - self->at.used_count;
    for (uint32_t i = 0; i < self->table.column_count; ++i)
        told_only += is_told_only(self, self->table.name[i]);
    if (unused > told_only)
        fprintf(stderr, "note: %u columns of %s are of nothing that this face has\n",
                unused - told_only, self->options->curves);
}

/* ---- what a row says ---- */

/* NaN: nothing. */
static double cell(const curve_performance *self, uint32_t row, uint32_t column)
{
    if (column == CURVE_TABLE_NONE)
        return (double)NAN;
    return self->table.value[(size_t)row * self->table.column_count + column];
}

static double cell_or(const curve_performance *self, uint32_t row, uint32_t column,
                      double otherwise)
{
    double value = cell(self, row, column);
    return isnan(value) ? otherwise : value;
}

/* False: none of the three is said. */
static bool read_vector(const curve_performance *self, uint32_t row, const uint32_t column[3],
                        mrt_vec3 *out)
{
    double x = cell(self, row, column[0]), y = cell(self, row, column[1]),
           z = cell(self, row, column[2]);
    *out = (mrt_vec3){isnan(x) ? 0.0f : (float)x, isnan(y) ? 0.0f : (float)y,
                      isnan(z) ? 0.0f : (float)z};
    return !isnan(x) || !isnan(y) || !isnan(z);
}

static void add_vector(mrt_pull *out, uint32_t contact, mrt_vec3 start, mrt_vec3 end)
{
    if (out->count < MRT_MAX_VECTORS)
        out->vector[out->count++] = (mrt_vector){start, end, contact};
}

static void read_pulls(const curve_performance *self, uint32_t row, mrt_pull *out)
{
    const mrt_face *about = composer_about(self->composer);
    mrt_vec3 start, way;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        if (!read_vector(self, row, self->at.contact + 3 * i, &way))
            continue;
        start = about->contacts[i].rest;
        add_vector(out, i + 1, start,
                   (mrt_vec3){start.x + way.x, start.y + way.y, start.z + way.z});
    }
    for (uint32_t k = 0; k < MRT_MAX_VECTORS; ++k)
        if (read_vector(self, row, self->at.point[k], &start) &&
            read_vector(self, row, self->at.point[k] + 3, &way))
            add_vector(out, 0, start, way);
}

/* A degree of freedom is written as it was posed: the pose softens what comes near its limit. */
static void read_dofs(const curve_performance *self, uint32_t row, float *out)
{
    const mrt_face *about = composer_about(self->composer);
    float posed[MRT_MAX_DOFS] = {0};
    for (uint32_t i = 0; i < about->dof_count; ++i)
        posed[i] = (float)cell_or(self, row, self->at.dof[i], 0.0);
    memcpy(out, posed, sizeof posed);
    bones_unlimit(out, face_bones(composer_face(self->composer)), posed);
}

static void read_pull(const curve_performance *self, uint32_t row, mrt_pull *out)
{
    *out = (mrt_pull){.mode = MRT_ANCHORED};
    read_dofs(self, row, out->dof);
    read_pulls(self, row, out);
    out->anchor = (uint32_t)cell_or(self, row, self->at.anchor, 0.0);
    out->commit = (uint32_t)cell_or(self, row, self->at.commit, 0.0);
    out->radius_mm = (float)cell_or(self, row, self->at.radius, 0.0);
    out->stretch_most = (float)cell_or(self, row, self->at.stretch_most, 0.0);
    if (cell_or(self, row, self->at.polynomial, 0.0) == CSRBF_LINEAR)
        out->solve = MRT_SOLVE_LINEAR;
}

/* Of the first row that says it; each row has a radius of its own. */
static csrbf_settings solver_of(const curve_performance *self)
{
    csrbf_settings out = {0};
    uint32_t kernel = curve_table_find(&self->table, "solver.kernel"),
             polynomial = curve_table_find(&self->table, "solver.polynomial");
    if (self->face.rig)
        out = self->face.rig->solver;
    for (uint32_t row = self->table.row_count; row-- > 0;) {
        double is = cell(self, row, kernel), with = cell(self, row, polynomial);
        if (is >= CSRBF_WENDLAND_C2 && is <= CSRBF_WENDLAND_C6)
            out.kernel = (csrbf_kernel)is;
        if (with >= CSRBF_NONE && with <= CSRBF_WINDOWED && with != CSRBF_LINEAR)
            out.polynomial = (csrbf_polynomial)with;
    }
    return out;
}

/* ---- performed ---- */

/* Of the column time_s, unless --fps says it. */
static mrt_result find_rate(curve_performance *self, error *err)
{
    const curve_table *t = &self->table;
    uint32_t time = curve_table_find(t, "time_s");
    double span_s = cell(self, t->row_count - 1, time) - cell(self, 0, time);
    timecode_rate rate;
    self->fps = self->options->fps > 0.0 ? self->options->fps : 30.0;
    if (self->options->fps > 0.0 || time == CURVE_TABLE_NONE || t->row_count < 2)
        return MRT_OK;
    for (uint32_t row = 1; row < t->row_count; ++row)
        if (!(cell(self, row, time) > cell(self, row - 1, time)))
            return error_set(err, MRT_ERR_FORMAT, "%s:%u: time_s does not go on",
                             self->options->curves, t->line[row]);
    mrt_result result = timecode_rate_of(&rate, (t->row_count - 1) / span_s, err);
    if (result < 0) {
        error_prefix(err, self->options->curves);
        return result;
    }
    self->fps = timecode_fps(rate);
    return MRT_OK;
}

/* Time code goes on from the table's. */
static void label_clip(curve_performance *self)
{
    timecode_rate rate;
    error ignored;
    clip_start start = {.frame = 0};
    if (!self->recording.clip || timecode_rate_of(&rate, self->fps, &ignored) < 0)
        return;
    rate.is_drop = strchr(self->table.timecode, ';') != NULL;
    if (timecode_parse(&start.frame, rate, self->table.timecode, &ignored) < 0)
        return;
    start.rate_num = rate.num;
    start.rate_den = rate.den;
    timecode_write(start.timecode, rate, start.frame);
    clip_set_start(self->recording.clip, &start);
}

static mrt_result prepare(curve_performance *self, error *err)
{
    const perform_options *o = self->options;
    exports_video_choose(&self->videos, o->exports, o->export_count, &o->look);
    mrt_result result = exports_check(o->exports, o->export_count, err);
    if (result >= 0)
        result = exports_video_check(&self->videos, err);
    if (result >= 0)
        result = video_look_open(&self->videos.look, NULL, NULL, err);
    if (result >= 0)
        result = curve_table_read(&self->table, o->curves, err);
    if (result >= 0)
        result = face_file_read(&self->face, o->face, &o->frame, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = exports_check_face(o->exports, o->export_count, &self->face.mesh, err);
    if (result < 0)
        return result;
    self->solver = solver_of(self);
    result = composer_create(&self->composer, &self->face, &self->solver, err);
    if (result >= 0)
        result = find_columns(self, err);
    if (result >= 0)
        result = find_rate(self, err);
    if (result >= 0)
        result = recording_create(&self->recording, &self->face, self->fps,
                                  recording_use_of(o->exports, o->export_count), err);
    video_settings settings = {.mesh = &self->face.mesh, .pace = VIDEO_EVERY_FRAME, .timecode = ""};
    if (result >= 0)
        result = timecode_rate_of(&settings.rate, self->fps, err);
    return result < 0 ? result : exports_video_open(&self->videos, &settings, err);
}

static mrt_result perform(curve_performance *self, error *err)
{
    mrt_result result = MRT_OK;
    progress_start(&self->progress, "performing");
    for (uint32_t row = 0; row < self->table.row_count && result >= 0; ++row) {
        mrt_pull pull;
        read_pull(self, row, &pull);
        const composer_part part = {.weight = 1.0, .gain = 1.0, .is_fresh = true, .pull = &pull};
        composer_move(self->composer, &part, 1, 1.0 / self->fps);
        composer_draw(self->composer);
        result = exports_video_add(&self->videos, self->composer, err);
        if (result >= 0)
            result = recording_add_face(&self->recording, self->composer, 0, err);
        if (cancel_is_asked())
            break;
        progress_show(&self->progress, (double)(row + 1) / self->table.row_count, "");
    }
    progress_end(&self->progress);
    const composer_counts *counts = composer_counted(self->composer);
    if (result >= 0 && counts->held_pulls > 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: %s", self->options->curves,
                           counts->first_problem.text);
    return result;
}

/* Rows whose shape the numbers alone do not give. */
static void tell_others(const curve_performance *self)
{
    if (self->table.other_shapes > 0)
        fprintf(stderr,
                "note: %u rows of %s were performed on clay or on a shape that was committed: here "
                "they are performed on the face at rest\n",
                self->table.other_shapes, self->options->curves);
}

mrt_result perform_curves(const perform_options *options, facts *told, error *err)
{
    curve_performance self = {.options = options};
    const exports_settings settings = {.tolerance_mm = options->tolerance_mm,
                                       .max_targets = options->max_targets,
                                       .is_bare = options->is_bare,
                                       .title = options->curves,
                                       .made_from = "",
                                       .look = &self.videos.look};
    mrt_result result = prepare(&self, err);
    if (result >= 0) {
        tell_unused(&self);
        tell_others(&self);
        result = perform(&self, err);
    }
    if (result >= 0) {
        facts_text(told, "face", "face", options->face);
        facts_text(told, "curves", "curves", options->curves);
        facts_number(told, "columns", "columns used", self.at.used_count, 0, "");
        facts_number(told, "frames", "frames", self.recording.frame_count, 0, "");
        facts_number(told, "fps", "frame rate", self.fps, 2, "per second");
        recording_tell_surface(&self.recording, told);
        label_clip(&self);
        result = exports_video_finish(&self.videos, told, err);
    }
    if (result >= 0)
        result = exports_write(options->exports, options->export_count, self.recording.clip,
                               &settings, &self.progress, told, err);
    exports_video_close(&self.videos);
    recording_destroy(&self.recording);
    composer_destroy(self.composer);
    face_file_destroy(&self.face);
    free(self.at.contact);
    curve_table_finish(&self.table);
    return result;
}
