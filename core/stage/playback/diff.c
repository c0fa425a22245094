#include "stage/playback/diff.h"

#include <math.h>
#include <stdlib.h>

struct diff {
    uint32_t vertex_count;
    uint32_t count[DIFF_PART_COUNT];
    uint8_t *part; /* index of the part, for each vertex */
};

/* ---- region of each vertex ---- */

static uint32_t region_named(const char *name)
{
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        const own_part *own = own_part_of((own_region)region);
        for (uint32_t i = 0; i < own->pattern_count; ++i)
            if (own_matches(own->pattern[i], name))
                return region;
    }
    return DIFF_ELSEWHERE;
}

static double distance2(const float *a, const float *b)
{
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
        double step = (double)a[k] - (double)b[k];
        sum += step * step;
    }
    return sum;
}

static uint32_t part_of(const float *vertex, const mrt_face *about, const uint8_t *region,
                        double radius_mm)
{
    double least = radius_mm * radius_mm;
    uint32_t part = DIFF_ELSEWHERE;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        const mrt_vec3 *rest = &about->contacts[i].rest;
        const float at[3] = {rest->x, rest->y, rest->z};
        double away = distance2(vertex, at);
        if (away < least) {
            least = away;
            part = region[i];
        }
    }
    return part;
}

mrt_result diff_create(diff **out, const float *rest, uint32_t vertex_count, const mrt_face *about,
                       double radius_mm, error *err)
{
    *out = NULL;
    diff *self = calloc(1, sizeof *self);
    uint8_t *region = calloc((size_t)about->contact_count + 1, 1);
    if (self)
        self->part = calloc((size_t)vertex_count + 1, 1);
    if (!self || !region || !self->part) {
        diff_destroy(self);
        free(region);
        return error_set(err, MRT_ERR_MEMORY, "no memory to compare two takes");
    }
    for (uint32_t i = 0; i < about->contact_count; ++i)
        region[i] = (uint8_t)region_named(about->contacts[i].name);
    self->vertex_count = vertex_count;
    for (uint32_t v = 0; v < vertex_count; ++v) {
        self->part[v] = (uint8_t)part_of(rest + 3 * (size_t)v, about, region, radius_mm);
        self->count[self->part[v]] += 1;
    }
    self->count[DIFF_FACE] = vertex_count;
    free(region);
    *out = self;
    return MRT_OK;
}

void diff_destroy(diff *self)
{
    if (!self)
        return;
    free(self->part);
    free(self);
}

const char *diff_part_name(uint32_t part)
{
    const own_part *own = part < OWN_REGION_COUNT ? own_part_of((own_region)part) : NULL;
    return own ? own->name : part == DIFF_ELSEWHERE ? "elsewhere" : "face";
}

uint32_t diff_vertex_count(const diff *self, uint32_t part)
{
    return part < DIFF_PART_COUNT ? self->count[part] : 0;
}

/* ---- distances ---- */

void diff_measure(const diff *self, const float *a, const float *b, diff_frame *out)
{
    double greatest[DIFF_PART_COUNT] = {0}, sum[DIFF_PART_COUNT] = {0};
    for (uint32_t v = 0; v < self->vertex_count; ++v) {
        double away = distance2(a + 3 * (size_t)v, b + 3 * (size_t)v);
        uint32_t part = self->part[v];
        greatest[part] = away > greatest[part] ? away : greatest[part];
        sum[part] += away;
    }
    for (uint32_t part = 0; part < DIFF_FACE; ++part) {
        greatest[DIFF_FACE] =
            greatest[part] > greatest[DIFF_FACE] ? greatest[part] : greatest[DIFF_FACE];
        sum[DIFF_FACE] += sum[part];
    }
    for (uint32_t part = 0; part < DIFF_PART_COUNT; ++part) {
        out->max_mm[part] = sqrt(greatest[part]);
        out->rms_mm[part] = self->count[part] ? sqrt(sum[part] / self->count[part]) : 0.0;
    }
}

void diff_sum(uint32_t part, const diff_frame *frames, uint32_t count, diff_total *out)
{
    double sum = 0.0;
    *out = (diff_total){0};
    for (uint32_t i = 0; i < count; ++i) {
        sum += frames[i].rms_mm[part] * frames[i].rms_mm[part];
        if (frames[i].max_mm[part] > out->max_mm) {
            out->max_mm = frames[i].max_mm[part];
            out->worst = i;
        }
    }
    out->rms_mm = count ? sqrt(sum / count) : 0.0;
}

static bool is_apart(const uint32_t *chosen, uint32_t count, uint32_t frame, uint32_t apart)
{
    for (uint32_t i = 0; i < count; ++i)
        if ((chosen[i] > frame ? chosen[i] - frame : frame - chosen[i]) < apart)
            return false;
    return true;
}

uint32_t diff_worst(const diff_frame *frames, uint32_t count, uint32_t apart, uint32_t *out,
                    uint32_t capacity)
{
    uint32_t found = 0;
    while (found < capacity) {
        double greatest = 0.0;
        uint32_t best = 0;
        for (uint32_t i = 0; i < count; ++i)
            if (frames[i].max_mm[DIFF_FACE] > greatest && is_apart(out, found, i, apart)) {
                greatest = frames[i].max_mm[DIFF_FACE];
                best = i;
            }
        if (!(greatest > 0.0))
            break;
        out[found++] = best;
    }
    return found;
}
