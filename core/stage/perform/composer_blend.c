/* What the pulls of all voices add up to, layer by layer. */
#include "stage/perform/composer_state.h"

#include <math.h>
#include <string.h>

vec3 composer_vec3(mrt_vec3 p)
{
    return (vec3){(double)p.x, (double)p.y, (double)p.z};
}

double composer_share(const voice *v)
{
    return v->part.weight * v->part.gain;
}

static bool is_one(double share)
{
    return !(fabs(share - 1.0) > 0.0);
}

typedef struct blended {
    double value[3];
    double cover;  /* of the layer at hand */
    double sum[3]; /* of the layer at hand */
    bool is_additive;
    uint32_t layer;
    uint32_t voices;
} blended;

static void close_layer(blended *b)
{
    double below = b->is_additive ? 1.0 : 1.0 - fmin(b->cover, 1.0);
    if (b->cover > 0.0)
        for (int axis = 0; axis < 3; ++axis)
            b->value[axis] = below > 0.0 ? b->sum[axis] + below * b->value[axis] : b->sum[axis];
    b->cover = 0.0;
    memset(b->sum, 0, sizeof b->sum);
}

static void add_voice(blended *b, const voice *v, double weight, const double *added)
{
    if (b->layer != v->part.layer)
        close_layer(b);
    b->voices += 1;
    b->layer = v->part.layer;
    b->is_additive = v->part.is_additive;
    if (b->cover > 0.0)
        for (int axis = 0; axis < 3; ++axis)
            b->sum[axis] += added[axis];
    else
        memcpy(b->sum, added, sizeof b->sum);
    b->cover += weight;
}

bool composer_counts_anybody(const composer *self, bool (*counts)(const voice *v))
{
    for (uint32_t i = 0; counts && i < self->joined_count; ++i) {
        const voice *v = &self->voice[self->joined_order[i]];
        if (v->is_joined && counts(v))
            return true;
    }
    return !counts;
}

void composer_blend_ends(const composer *self, bool (*counts)(const voice *v), double *end,
                         uint8_t *rides)
{
    blended at[MRT_MAX_VECTORS];
    memset(at, 0, sizeof at);
    bool is_held = composer_counts_anybody(self, counts);
    for (uint32_t k = 0; is_held && k < self->control_count; ++k) {
        const vec3 *held = &self->control[k].held;
        at[k].value[0] = held->x;
        at[k].value[1] = held->y;
        at[k].value[2] = held->z;
    }
    for (uint32_t i = 0; i < COMPOSER_PARTS_MAX; ++i) {
        const voice *v = &self->voice[self->joined_order[i]];
        for (uint32_t j = 0; i < self->joined_count && v->is_joined && j < v->joined.count; ++j) {
            uint32_t k = v->control[j];
            if (k == COMPOSER_NO_CONTROL || (counts && !counts(v)))
                continue;
            vec3 start = composer_vec3(v->joined.vector[j].start),
                 to = composer_vec3(v->joined.vector[j].end);
            const double added[3] = {v->share * (to.x - start.x), v->share * (to.y - start.y),
                                     v->share * (to.z - start.z)};
            add_voice(&at[k], v, v->weight, added);
        }
    }
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *c = &self->control[k];
        close_layer(&at[k]);
        rides[k] = c->contact != 0;
        memcpy(end + 3 * k, at[k].value, sizeof at[k].value);
        if (rides[k])
            continue;
        const voice *v = &self->voice[c->slot];
        vec3 place = c->start;
        if (v->is_joined && !v->part.is_finger && at[k].voices == 1 && is_one(v->share) &&
            (!counts || counts(v))) {
            /* it lands on its end itself: no digits lost on the way */
            place = composer_vec3(v->joined.vector[c->vector].end);
            memset(end + 3 * k, 0, 3 * sizeof *end);
        }
        end[3 * k] += place.x;
        end[3 * k + 1] += place.y;
        end[3 * k + 2] += place.z;
    }
}

void composer_blend_dofs(const composer *self, float *out)
{
    for (uint32_t d = 0; d < MRT_MAX_DOFS; ++d) {
        blended at = {.cover = 0};
        bool is_driven = false;
        for (uint32_t i = 0; i < self->order_count; ++i) {
            const voice *v = &self->voice[self->order[i]];
            const mrt_pull *pull = v->part.pull->mode == MRT_UNANCHORED ? v->part.pull : &v->said;
            bool speaks = v->has_said || v->part.pull->mode == MRT_UNANCHORED;
            if (!speaks || isnan(pull->dof[d]) || d >= self->about.dof_count ||
                (v->part.owns && !v->part.owns[self->about.contact_count + d]))
                continue;
            const double added[3] = {composer_share(v) * (double)pull->dof[d], 0, 0};
            add_voice(&at, v, v->part.weight, added);
            is_driven = true;
        }
        close_layer(&at);
        out[d] = is_driven ? (float)at.value[0] : NAN;
    }
}
