#include "stage/playback/activity.h"
#include "base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BINS = 8192, ALL = OWN_REGION_COUNT };
static const int64_t first_bin_ns = 4 * NS_PER_MS;
/* An unanchored drag counts as the distance that it covers in this time at its current speed. */
static const double drag_span_s = 0.1;

/* Values of a lane in units of 1 / bin_steps, plus 1. greatest 0: unknown. */
typedef struct packed_bin {
    uint16_t least, greatest;
} packed_bin;
static const float bin_steps = 4096.0f;

typedef struct lane_bins {
    packed_bin bin[BINS];
} lane_bins;

struct activity {
    replay_world world;
    take_part part;
    int64_t performance, from_ns, to_ns; /* show time: span of the recording when it was opened */
    replay *replay;   /* NULL: all recorded samples are processed, or it cannot be opened */
    bool has_failed;  /* the replay cannot be opened */
    int64_t known_ns; /* source time */
    int64_t bin_ns;
    lane_bins *lane;                             /* ACTIVITY_LANES elements */
    uint32_t *region_of_contact, *region_of_dof; /* one bit for each lane */
    double unit_mm;                              /* a tenth of the height of the face */
    float held[ACTIVITY_LANES];                  /* value since the last sample */
    void *state;                                 /* saved state of the replay */
    size_t state_size, state_capacity;           /* size 0: no saved state */
};

/* ---- bins ---- */

static activity_bin unknown(void)
{
    return (activity_bin){INFINITY, -INFINITY};
}

static uint16_t packed(float value)
{
    return (uint16_t)(1.0f + roundf(fminf(value * bin_steps, (float)(UINT16_MAX - 1))));
}

static float unpacked(uint16_t steps)
{
    return (float)(steps - 1) / bin_steps;
}

static packed_bin join(packed_bin a, packed_bin b)
{
    if (a.greatest == 0 || b.greatest == 0)
        return a.greatest == 0 ? b : a;
    return (packed_bin){a.least < b.least ? a.least : b.least,
                        a.greatest > b.greatest ? a.greatest : b.greatest};
}

static void add(lane_bins *of, size_t bin, float value)
{
    const packed_bin one = {packed(value), packed(value)};
    of->bin[bin] = join(of->bin[bin], one);
}

/* Doubles the time that each bin covers. */
static void coarsen(lane_bins *of)
{
    packed_bin *b = of->bin;
    for (size_t i = 0; i < BINS / 2; ++i)
        b[i] = join(b[2 * i], b[2 * i + 1]);
    memset(b + BINS / 2, 0, BINS / 2 * sizeof *b);
}

/* Fills the bins since the last sample with its value, then adds the new value. */
static void note(activity *self, int64_t source_ns, const float *value)
{
    while (source_ns / self->bin_ns >= BINS) {
        for (uint32_t i = 0; i < ACTIVITY_LANES; ++i)
            coarsen(&self->lane[i]);
        self->bin_ns *= 2;
    }
    size_t bin = (size_t)(source_ns / self->bin_ns);
    for (uint32_t i = 0; i < ACTIVITY_LANES; ++i) {
        size_t first = self->known_ns < 0 ? bin : (size_t)(self->known_ns / self->bin_ns) + 1;
        for (size_t between = first; between < bin; ++between)
            add(&self->lane[i], between, self->held[i]);
        add(&self->lane[i], bin, value[i]);
        self->held[i] = value[i];
    }
    self->known_ns = source_ns;
}

/* ---- activity of a pull in each region ---- */

static uint32_t regions_of(const char *name)
{
    uint32_t out = 1u << ALL;
    for (uint32_t r = 0; r < OWN_REGION_COUNT; ++r) {
        const own_part *part = own_part_of((own_region)r);
        for (uint32_t i = 0; part && i < part->pattern_count; ++i)
            if (own_matches(part->pattern[i], name))
                out |= 1u << r;
    }
    return out;
}

static mrt_result list_regions(activity *self, error *err)
{
    const mrt_face *about = composer_about(self->world.scratch->composer);
    self->region_of_contact =
        calloc((size_t)about->contact_count + 1, sizeof *self->region_of_contact);
    self->region_of_dof = calloc((size_t)about->dof_count + 1, sizeof *self->region_of_dof);
    if (!self->region_of_contact || !self->region_of_dof)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the activity lanes of a take");
    for (uint32_t i = 0; i < about->contact_count; ++i)
        self->region_of_contact[i] = regions_of(about->contacts[i].name);
    for (uint32_t i = 0; i < about->dof_count; ++i)
        self->region_of_dof[i] = regions_of(about->dofs[i].name);
    self->unit_mm = fmax(0.1 * ((double)about->high.y - (double)about->low.y), 1e-6);
    return MRT_OK;
}

typedef struct sums {
    double square[ACTIVITY_LANES];
    uint32_t count[ACTIVITY_LANES];
} sums;

static void add_amount(sums *s, uint32_t regions, double amount)
{
    for (uint32_t i = 0; i < ACTIVITY_LANES; ++i) {
        if (!(regions & (1u << i)))
            continue;
        s->square[i] += amount * amount;
        s->count[i] += 1;
    }
}

static double squared_mm(mrt_vec3 a, mrt_vec3 b)
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y,
           z = (double)a.z - (double)b.z;
    return x * x + y * y + z * z;
}

/* A free point belongs to the regions of the nearest contact. */
static uint32_t regions_at(const activity *self, mrt_vec3 position)
{
    const mrt_face *about = composer_about(self->world.scratch->composer);
    uint32_t out = 1u << ALL;
    double least = INFINITY;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        double away = squared_mm(about->contacts[i].rest, position);
        if (away >= least)
            continue;
        least = away;
        out = self->region_of_contact[i];
    }
    return out;
}

static void add_pull(const activity *self, sums *s, const mrt_pull *pull, double dt_s)
{
    const mrt_face *about = composer_about(self->world.scratch->composer);
    double scale = 1.0 / self->unit_mm;
    if (pull->mode == MRT_IDLE)
        return;
    if (pull->mode == MRT_UNANCHORED)
        scale *= dt_s > 0.0 ? drag_span_s / dt_s : 0.0;
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        bool is_known = v->contact > 0 && v->contact <= about->contact_count;
        uint32_t regions =
            is_known ? self->region_of_contact[v->contact - 1] : regions_at(self, v->start);
        add_amount(s, regions, scale * sqrt(squared_mm(v->end, v->start)));
    }
    for (uint32_t i = 0; i < about->dof_count; ++i) {
        double value = (double)pull->dof[i];
        double end = value < 0.0 ? (double)about->dofs[i].min : (double)about->dofs[i].max;
        if (!isnan(value) && fabs(end) > 0.0)
            add_amount(s, self->region_of_dof[i], value / end);
    }
}

static void measure(const activity *self, float out[ACTIVITY_LANES])
{
    const layer *of = replay_layer(self->replay);
    const pointer *finger = &of->pointer;
    double dt_s = of->frame.dt_s;
    sums s = {{0}, {0}};
    add_pull(self, &s, layer_pull(of), dt_s);
    add_pull(self, &s, &finger->pull, dt_s);
    add_pull(self, &s, &finger->places, finger->is_fresh ? dt_s : 0.0);
    add_pull(self, &s, &of->palette.pull, dt_s);
    add_pull(self, &s, &of->life.pull, dt_s);
    for (uint32_t i = 0; i < ACTIVITY_LANES; ++i)
        out[i] = s.count[i] > 0 ? (float)sqrt(s.square[i] / s.count[i]) : 0.0f;
}

/* ---- create and destroy ---- */

static mrt_result open_replay(activity *self, error *err)
{
    show_performance of;
    mrt_result result = show_performance_read(self->world.show, self->performance, &of, err);
    if (result < 0)
        return result;
    self->from_ns = of.from_ns;
    self->to_ns = of.to_ns;
    show_performance_finish(&of);
    return replay_open(&self->replay, &self->world, self->performance, self->part, err);
}

mrt_result activity_create(activity **out, const replay_world *world, int64_t performance,
                           take_part part, error *err)
{
    *out = NULL;
    activity *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the activity lanes of a take");
    self->world = *world;
    self->performance = performance;
    self->part = part;
    self->known_ns = -1;
    self->bin_ns = first_bin_ns;
    self->lane = calloc(ACTIVITY_LANES, sizeof *self->lane);
    mrt_result result =
        self->lane ? list_regions(self, err)
                   : error_set(err, MRT_ERR_MEMORY, "no memory for the activity lanes of a take");
    if (result >= 0)
        result = open_replay(self, err);
    if (result >= 0) /* the performance may begin away from neutral */
        result = replay_seek(self->replay, self->from_ns, err);
    if (result < 0) {
        activity_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void activity_destroy(activity *self)
{
    if (!self)
        return;
    replay_close(self->replay);
    free(self->lane);
    free(self->region_of_contact);
    free(self->region_of_dof);
    free(self->state);
    free(self);
}

/* ---- perform ---- */

static size_t keep_state(activity *self)
{
    const size_t size = replay_save(self->replay, NULL, 0);
    if (size > self->state_capacity) {
        void *grown = realloc(self->state, size);
        if (!grown)
            return 0;
        self->state = grown;
        self->state_capacity = size;
    }
    return size > 0 && replay_save(self->replay, self->state, size) == size ? size : 0;
}

/* Closes the replay after all recorded samples are processed. Its saved state needs less memory. */
static void park(activity *self)
{
    if (!self->replay)
        return;
    self->state_size = keep_state(self);
    replay_close(self->replay);
    self->replay = NULL;
}

/* Opens a performance again that is still being recorded, because it has more samples and events
 * now. */
static mrt_result reopen(activity *self, error *err)
{
    park(self);
    mrt_result result = open_replay(self, err);
    if (result >= 0)
        result = self->state_size > 0
                     ? replay_load(self->replay, self->state, self->state_size, err)
                     : replay_seek(self->replay, self->from_ns + self->known_ns + 1, err);
    self->has_failed = result < 0;
    return result;
}

static mrt_result check_for_more(activity *self, bool *out_has_more, error *err)
{
    show_performance of;
    *out_has_more = false;
    mrt_result result = show_performance_read(self->world.show, self->performance, &of, err);
    if (result < 0)
        return result;
    *out_has_more = of.to_ns > self->to_ns;
    show_performance_finish(&of);
    if (*out_has_more)
        return reopen(self, err);
    park(self);
    return MRT_OK;
}

mrt_result activity_step(activity *self, uint32_t samples_max, error *err)
{
    float value[ACTIVITY_LANES];
    bool has_looked = false, has_more = true;
    for (uint32_t n = 0; n < samples_max;) {
        mrt_result result = self->replay ? replay_pull(self->replay, INT64_MAX, err) : MRT_END;
        if (result < 0)
            return result;
        if (result == MRT_END) {
            if (has_looked || self->has_failed)
                return MRT_END;
            has_looked = true;
            result = check_for_more(self, &has_more, err);
            if (result < 0 || !has_more)
                return result < 0 ? result : MRT_END;
            continue;
        }
        measure(self, value);
        int64_t source_ns = replay_now_ns(self->replay) - self->from_ns;
        note(self, source_ns > 0 ? source_ns : 0, value);
        n += 1;
    }
    return MRT_OK;
}

/* ---- read ---- */

static activity_bin read_bin(const activity *self, const lane_bins *of, int64_t from_ns,
                             int64_t to_ns)
{
    packed_bin out = {0, 0};
    if (to_ns <= 0 || from_ns > self->known_ns)
        return unknown();
    int64_t first = from_ns > 0 ? from_ns / self->bin_ns : 0, last = (to_ns - 1) / self->bin_ns;
    last = last < first ? first : last;
    for (int64_t i = first; i <= last && i < BINS; ++i)
        out = join(out, of->bin[i]);
    return out.greatest == 0 ? unknown()
                             : (activity_bin){unpacked(out.least), unpacked(out.greatest)};
}

void activity_read(const activity *self, uint32_t lane, int64_t from_ns, int64_t to_ns,
                   uint32_t count, activity_bin *out)
{
    double span_ns = (double)(to_ns - from_ns);
    for (uint32_t i = 0; i < count; ++i) {
        int64_t a = from_ns + (int64_t)(span_ns * (double)i / (double)count);
        int64_t b = from_ns + (int64_t)(span_ns * (double)(i + 1) / (double)count);
        out[i] = lane < ACTIVITY_LANES ? read_bin(self, &self->lane[lane], a, b) : unknown();
    }
}

int64_t activity_known_ns(const activity *self)
{
    return self->known_ns > 0 ? self->known_ns : 0;
}
