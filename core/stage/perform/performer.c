#include "stage/perform/performer.h"
#include "base/bytes.h"

#include <stdlib.h>

struct performer {
    composer *composer;
    layer *layer;
    performer_counts counts;
};

static void count(performer *self)
{
    const layer_counts *l = layer_counted(self->layer);
    const composer_counts *c = composer_counted(self->composer);
    self->counts.samples = l->samples;
    self->counts.steps = l->steps;
    self->counts.solves = c->solves;
    self->counts.bad_pulls = l->bad_pulls;
    self->counts.held_pulls = c->held_pulls;
    self->counts.limited_steps = c->limited_steps;
    self->counts.folded_steps = c->folded_steps;
    self->counts.substeps = c->substeps;
    self->counts.engagements = c->engagements;
    self->counts.commits = c->commits;
    self->counts.min_determinant = c->min_determinant;
    if (!self->counts.first_problem.text[0])
        self->counts.first_problem = l->first_problem.text[0] ? l->first_problem : c->first_problem;
}

mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                            const performer_settings *settings, error *err)
{
    *out = NULL;
    performer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the performer");
    mrt_result result = composer_create(&self->composer, file, &settings->solver, err);
    if (result < 0)
        goto fail;
    layer_settings guard = {.hands.rezero_pedal = settings->rezero_pedal, .keeps_taught = true};
    for (int side = 0; side < 2; ++side)
        guard.hands.length_mm[side] = settings->hand_length_mm > 0 ? settings->hand_length_mm
                                                                   : settings->side_length_mm[side];
    guard.reach_mm = composer_reach_mm(self->composer, &guard.centre);
    result = layer_create(&self->layer, mapping, composer_about(self->composer), &guard, err);
    if (result < 0)
        goto fail;
    count(self);
    *out = self;
    return MRT_OK;
fail:
    performer_destroy(self);
    return result;
}

void performer_destroy(performer *self)
{
    if (!self)
        return;
    layer_destroy(self->layer);
    composer_destroy(self->composer);
    free(self);
}

/* Over the mapping: what a contact is pulled by both adds up. */
static composer_part finger_part(const composer_part *as, uint32_t turn, const mrt_pull *pull)
{
    composer_part out = *as;
    out.slot += PERFORMER_SLOTS * turn;
    out.layer = 2 * as->layer + 1;
    out.is_additive = out.is_finger = true;
    out.pull = pull;
    return out;
}

static uint32_t pointer_parts(const layer *of, const composer_part *as, composer_part *out)
{
    const pointer *p = layer_pointer(of);
    uint32_t count = 0;
    if (p->pull.mode != MRT_IDLE)
        out[count++] = finger_part(as, 2, &p->pull);
    if (p->places.mode == MRT_IDLE && !p->commits && !(p->restore > 0.0))
        return count;
    out[count] = finger_part(as, 3, &p->places);
    out[count].is_fresh = as->is_fresh && p->is_fresh;
    out[count++].restore = as->is_fresh ? p->restore : 0.0;
    return count;
}

uint32_t performer_parts(const layer *of, const composer_part *as,
                         composer_part out[PERFORMER_PARTS_MAX])
{
    uint32_t part_count = 0;
    double weight = layer_weight(of);
    const mrt_pull *leaving = layer_leaving(of);
    if (leaving) {
        out[part_count] = *as;
        out[part_count].slot += PERFORMER_SLOTS * (1 - layer_side(of));
        out[part_count].layer = 2 * as->layer;
        out[part_count].is_fresh = false;
        out[part_count].weight *= 1.0 - weight;
        out[part_count++].pull = leaving;
    }
    out[part_count] = *as;
    out[part_count].slot += PERFORMER_SLOTS * layer_side(of);
    out[part_count].layer = 2 * as->layer;
    out[part_count++].weight *= weight;
    return part_count + pointer_parts(of, as, out + part_count);
}

void performer_move(layer *of, composer *shown)
{
    const composer_part all = {
        .is_fresh = true, .weight = 1.0, .gain = 1.0, .pull = layer_pull(of)};
    composer_part part[PERFORMER_PARTS_MAX];
    uint32_t part_count = performer_parts(of, &all, part);
    composer_move(shown, part, part_count, layer_frame(of)->dt_s);
}

void performer_map(performer *self, const sample_step *s)
{
    bool near = composer_is_near(self->composer, layer_pull(self->layer));
    layer_step(self->layer, s, near);
}

void performer_constrain(performer *self)
{
    performer_move(self->layer, self->composer);
    count(self);
}

void performer_step(performer *self, const sample_step *s)
{
    performer_map(self, s);
    performer_constrain(self);
}

mrt_result performer_rezero(performer *self, uint32_t side, error *why)
{
    return hands_rezero(layer_hands(self->layer), side, layer_frame(self->layer)->time_ns, why);
}

const rezero_counts *performer_rezeros(const performer *self)
{
    return hands_rezeros(layer_hands(self->layer));
}

void performer_draw(performer *self)
{
    composer_draw(self->composer);
}

composer *performer_composer(performer *self)
{
    return self->composer;
}

layer *performer_layer(performer *self)
{
    return self->layer;
}

face *performer_face(performer *self)
{
    return composer_face(self->composer);
}

csrbf_settings performer_solver(const performer *self)
{
    return composer_solver_of(self->composer, performer_pull(self));
}

const mrt_pull *performer_pull(const performer *self)
{
    return layer_pull(self->layer);
}

bool performer_is_anchored(const performer *self)
{
    return composer_is_anchored(self->composer);
}

/* ---- kept ---- */

size_t performer_save(performer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    size_t layer_size = layer_save(self->layer, NULL, 0);
    size_t face_size = composer_save(self->composer, NULL, 0);
    if (layer_size == 0)
        return 0;
    bytes_put_u32(&out, (uint32_t)layer_size);
    if (out.data && out.size + layer_size + face_size <= out.capacity) {
        layer_save(self->layer, out.data + out.size, layer_size);
        composer_save(self->composer, out.data + out.size + layer_size, face_size);
    }
    return out.size + layer_size + face_size;
}

mrt_result performer_load_into(layer *of, composer *shown, const void *bytes, size_t size,
                               error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    size_t layer_size = bytes_take_u32(&in);
    composer_reset(shown);
    if (in.failed || layer_size > (size_t)(in.end - in.at)) {
        layer_reset(of);
        return error_set(err, MRT_ERR_FORMAT, "the stored state of the performance is damaged");
    }
    mrt_result result = layer_load(of, in.at, layer_size, err);
    if (result >= 0)
        result =
            composer_load(shown, in.at + layer_size, (size_t)(in.end - in.at) - layer_size, err);
    if (result < 0)
        layer_reset(of);
    return result;
}

mrt_result performer_load(performer *self, const void *bytes, size_t size, error *err)
{
    return performer_load_into(self->layer, self->composer, bytes, size, err);
}

const performer_counts *performer_counted(const performer *self)
{
    return &self->counts;
}
