#include "stage/perform/performer.h"
#include "base/bytes.h"

#include <math.h>
#include <stdlib.h>

/* ---- create and destroy ---- */

mrt_result performer_make_layer(const performer *self, instance *mapping,
                                const performer_settings *as, layer **out, error *err)
{
    layer_settings settings = {.hands.rezero_pedal = as->rezero_pedal, .keeps_taught = true};
    for (int side = 0; side < 2; ++side)
        settings.hands.length_mm[side] =
            as->hand_length_mm > 0 ? as->hand_length_mm : as->side_length_mm[side];
    settings.reach_mm = composer_reach_mm(self->composer, &settings.centre);
    mrt_result result = layer_create(out, mapping, composer_mapped(self->composer), &settings, err);
    if (result < 0 || !as->patch)
        return result;
    patch_plan *plan, *none;
    result = performer_make_patch(self, as->patch, &plan, err);
    if (result >= 0) {
        patch_plan_check_params(plan, mapping->type);
        (void)patch_bay_set(&(*out)->bay, plan,
                            &none); /* cannot fail: nothing fades in a new layer */
    } else {
        layer_destroy(*out);
    }
    *out = result < 0 ? NULL : *out;
    return result;
}

mrt_result performer_make_patch(const performer *self, const patch *p, patch_plan **out, error *err)
{
    return patch_plan_create(out, p, composer_about(self->composer), composer_rig(self->composer),
                             composer_face(self->composer), err);
}

mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                            const performer_settings *settings, error *err)
{
    *out = NULL;
    performer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the performer");
    mrt_result result = composer_create(&self->composer, file, &settings->solver, err);
    if (result >= 0 && mapping)
        result = performer_make_layer(self, mapping, settings, &self->own, err);
    if (result < 0) {
        performer_destroy(self);
        return result;
    }
    self->voice[0] =
        (performer_voice){.layer = self->own, .is_seen = true, .weight = 1.0, .gain = 1.0};
    self->counts = composer_get_counts(self->composer);
    *out = self;
    return MRT_OK;
}

void performer_destroy(performer *self)
{
    if (!self)
        return;
    layer_destroy(self->own);
    composer_destroy(self->composer);
    free(self);
}

/* ---- compose: voices become parts ---- */

/* Smooths the ends of the vectors and the degrees of freedom of a pull. */
static const mrt_pull *smoothed(performer_voice *v, const mrt_pull *pull, int64_t now_ns)
{
    bool is_continued = v->has_smooth && v->smooth.count == pull->count &&
                        v->smooth.anchor == pull->anchor && v->smooth.mode == pull->mode;
    if (!(v->smooth_s > 0.0) || pull->mode != MRT_ANCHORED)
        return pull;
    double dt_s = (double)(now_ns - v->smooth_ns) * 1e-9;
    double share = dt_s > 0.0 ? dt_s / (v->smooth_s + dt_s) : 0.0;
    mrt_pull before = v->smooth;
    v->smooth = *pull;
    v->smooth_ns = now_ns;
    v->has_smooth = true;
    for (uint32_t i = 0; is_continued && i < pull->count; ++i) {
        mrt_vec3 *to = &v->smooth.vector[i].end;
        const mrt_vec3 *from = &before.vector[i].end;
        to->x = (float)((double)from->x + share * ((double)to->x - (double)from->x));
        to->y = (float)((double)from->y + share * ((double)to->y - (double)from->y));
        to->z = (float)((double)from->z + share * ((double)to->z - (double)from->z));
    }
    for (uint32_t i = 0; is_continued && i < MRT_MAX_DOFS; ++i)
        if (!isnan(before.dof[i]) && !isnan(pull->dof[i]))
            v->smooth.dof[i] = (float)((double)before.dof[i] +
                                       share * ((double)pull->dof[i] - (double)before.dof[i]));
    return &v->smooth;
}

/* The layers of a lane, bottom first. */
enum {
    LANE_MAPPING = 0,
    LANE_INSTEAD,
    LANE_ADDED,
    LANE_POINTER,
    LANE_PALETTE,
    LANE_LIFE,
    LANE_LAYERS
};

/* Returns a part of the pointer. It is above the mapping and adds to it. */
static composer_part pointer_part(const composer_part *as, uint32_t bank, const mrt_pull *pull)
{
    composer_part out = *as;
    out.slot += PERFORMER_VOICES_MAX * bank;
    out.layer += LANE_POINTER;
    out.is_additive = out.is_pointer = true;
    out.pull = pull;
    return out;
}

/* The parts of the patch of a voice: its pulls, and the pulls that fade out. */
static uint32_t patch_parts(const layer *of, const composer_part *as, composer_part *out)
{
    static const uint32_t lane_of[PATCH_PULLS] = {LANE_INSTEAD, LANE_ADDED};
    const patch_bay *bay = &of->bay;
    double weight = patch_bay_weight(bay);
    uint32_t part_count = 0;
    for (uint32_t which = 0; which < PATCH_PULLS; ++which)
        for (uint32_t is_new = 0; is_new < 2; ++is_new) {
            const mrt_pull *pull = is_new ? &bay->pull[which] : &bay->leaving[which];
            uint32_t side = is_new ? bay->side : 1 - bay->side;
            if (pull->mode != MRT_ANCHORED)
                continue;
            composer_part *to = &out[part_count++];
            *to = *as;
            to->slot += PERFORMER_VOICES_MAX * (4 + 2 * which + side);
            to->layer += lane_of[which];
            to->is_additive |= which == PATCH_ADDED;
            to->weight *= is_new ? weight : 1.0 - weight;
            to->pull = pull;
            to->shapes = !bay->shape_count ? NULL
                         : is_new          ? bay->shape[which]
                                           : bay->leaving_shape[which];
        }
    return part_count;
}

static uint32_t pointer_parts(const layer *of, const composer_part *as, composer_part *out)
{
    const pointer *p = &of->pointer;
    uint32_t part_count = 0;
    if (p->pull.mode != MRT_IDLE)
        out[part_count++] = pointer_part(as, 2, &p->pull);
    if (p->places.mode == MRT_IDLE && !p->commits && !(p->restore > 0.0))
        return part_count;
    out[part_count] = pointer_part(as, 3, &p->places);
    out[part_count].is_fresh = as->is_fresh && p->is_fresh;
    out[part_count++].restore = as->is_fresh ? p->restore : 0.0;
    return part_count;
}

/* The poses of the palette add to everything below. */
static uint32_t palette_parts(const layer *of, const composer_part *as, composer_part *out)
{
    if (of->palette.pull.mode == MRT_IDLE)
        return 0;
    *out = *as;
    out->slot += PERFORMER_VOICES_MAX * 8;
    out->layer += LANE_PALETTE;
    out->is_additive = true;
    out->pull = &of->palette.pull;
    return 1;
}

/* Life adds to everything, too. */
static uint32_t life_parts(const layer *of, const composer_part *as, composer_part *out)
{
    if (of->life.pull.mode == MRT_IDLE)
        return 0;
    *out = *as;
    out->slot += PERFORMER_VOICES_MAX * 9;
    out->layer += LANE_LIFE;
    out->is_additive = out->is_life = true;
    out->pull = &of->life.pull;
    return 1;
}

/* Lists the parts of a voice: the pulls of its mapping (current and fading out), its patch, its
 * pointer, its palette and its life. The pointer has separate parts for contacts and for other
 * points of the skin. */
static uint32_t parts_of(performer *self, uint32_t index, bool is_fresh, int64_t now_ns,
                         composer_part out[PERFORMER_PARTS_MAX])
{
    performer_voice *v = &self->voice[index];
    const composer_part whole = {.slot = index,
                                 .layer = LANE_LAYERS * v->lane,
                                 .is_additive = v->is_additive,
                                 .is_fresh = is_fresh,
                                 .weight = v->weight,
                                 .gain = v->gain,
                                 .pull = smoothed(v, layer_pull(v->layer), now_ns),
                                 .owns = v->owns};
    uint32_t part_count = 0;
    double weight = layer_weight(v->layer);
    const mrt_pull *leaving = layer_leaving(v->layer);
    if (leaving) {
        out[part_count] = whole;
        out[part_count].slot += PERFORMER_VOICES_MAX * (1 - v->layer->crossfade.side);
        out[part_count].is_fresh = false;
        out[part_count].weight *= 1.0 - weight;
        out[part_count++].pull = leaving;
    }
    out[part_count] = whole;
    out[part_count].slot += PERFORMER_VOICES_MAX * v->layer->crossfade.side;
    out[part_count++].weight *= weight;
    part_count += patch_parts(v->layer, &whole, out + part_count);
    part_count += pointer_parts(v->layer, &whole, out + part_count);
    part_count += palette_parts(v->layer, &whole, out + part_count);
    return part_count + life_parts(v->layer, &whole, out + part_count);
}

static bool is_below(const performer_voice *a, const performer_voice *b)
{
    return a->lane != b->lane ? a->lane < b->lane : a->rank < b->rank;
}

static uint32_t list_voices(const performer *self, uint32_t out[PERFORMER_VOICES_MAX])
{
    uint32_t voice_count = 0;
    for (uint32_t i = 0; i < PERFORMER_VOICES_MAX; ++i) {
        const performer_voice *v = &self->voice[i];
        uint32_t at = voice_count;
        if (!v->layer || !v->is_seen)
            continue;
        for (; at > 0 && is_below(v, &self->voice[out[at - 1]]); --at)
            out[at] = out[at - 1];
        out[at] = i;
        voice_count += 1;
    }
    return voice_count;
}

void performer_compose(performer *self, uint32_t fresh, int64_t now_ns, performer_parts *out)
{
    uint32_t seen[PERFORMER_VOICES_MAX];
    uint32_t voice_count = list_voices(self, seen);
    bool has_vectors = false; /* of a mapping, which then derives or drives the other bones */
    for (uint32_t i = 0; i < voice_count; ++i) {
        const mrt_pull *pull = layer_pull(self->voice[seen[i]].layer);
        has_vectors |= pull->mode != MRT_IDLE && pull->count > 0;
    }
    for (uint32_t i = 0; i < voice_count; ++i)
        palette_hold_rest(&self->voice[seen[i]].layer->palette, !has_vectors);
    out->count = 0;
    for (uint32_t i = 0; i < voice_count; ++i)
        out->count += parts_of(self, seen[i], seen[i] == fresh, now_ns, out->part + out->count);
}

/* ---- save and load ---- */

size_t performer_save(performer *self, void *bytes, size_t capacity)
{
    layer *of = self->voice[0].layer;
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    size_t layer_size = layer_save(of, NULL, 0);
    size_t face_size = composer_save(self->composer, NULL, 0);
    if (layer_size == 0)
        return 0;
    bytes_write_u32(&out, (uint32_t)layer_size);
    if (out.data && out.size + layer_size + face_size <= out.capacity) {
        layer_save(of, out.data + out.size, layer_size);
        composer_save(self->composer, out.data + out.size + layer_size, face_size);
    }
    return out.size + layer_size + face_size;
}

mrt_result performer_load(performer *self, const void *bytes, size_t size, error *err)
{
    layer *of = self->voice[0].layer;
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    size_t layer_size = bytes_read_u32(&in);
    composer_reset(self->composer);
    if (in.failed || layer_size > (size_t)(in.end - in.at)) {
        layer_reset(of);
        return error_set(err, MRT_ERR_FORMAT, "the stored state of the performance is damaged");
    }
    mrt_result result = layer_load(of, in.at, layer_size, err);
    if (result >= 0)
        result = composer_load(self->composer, in.at + layer_size,
                               (size_t)(in.end - in.at) - layer_size, err);
    if (result < 0)
        layer_reset(of);
    return result;
}

size_t performer_save_pointer(performer *self, void *bytes, size_t capacity)
{
    const pointer *p = &self->voice[0].layer->pointer;
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const size_t held = pointer_save(p, NULL, 0),
                 face_size = composer_save(self->composer, NULL, 0);
    bytes_write_u32(&out, (uint32_t)held);
    if (out.data && out.size + held + face_size <= out.capacity) {
        pointer_save(p, out.data + out.size, held);
        composer_save(self->composer, out.data + out.size + held, face_size);
    }
    return out.size + held + face_size;
}

mrt_result performer_load_pointer(performer *self, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    const size_t held = bytes_read_u32(&in), left = (size_t)(in.end - in.at);
    if (in.failed || held > left || !layer_set_pointer(self->voice[0].layer, in.at, held))
        return error_set(err, MRT_ERR_FORMAT,
                         "the stored pointer pulls do not belong to this face");
    return composer_load(self->composer, in.at + held, left - held, err);
}
