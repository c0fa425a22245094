/* The grip of a control: the bones that move it at its place, and its mobility there. */
#include "face/frame/frame.h"

#include <math.h>

static const double share_least = 0.02; /* least share of a bone for a control to be in its field */
static const double mobility_exact = 0.1;  /* below this a control lands short */
static const double mobility_least = 0.01; /* below this it moves nothing */
static const double riding_begins = 0.5, riding_ends = 0.9;

/* Joins the fields of the bones with the greatest shares. */
static void join_bones(face_grip *grip, uint32_t bone_count)
{
    for (uint32_t joined = 0; joined < FACE_BONES_PER_CONTROL; ++joined) {
        uint32_t best = RIG_NONE;
        for (uint32_t b = 0; b < bone_count; ++b)
            if (!grip->belongs[b] && grip->share[b] > share_least &&
                (best == RIG_NONE || grip->share[b] > grip->share[best]))
                best = b;
        if (best == RIG_NONE)
            return;
        grip->belongs[best] = true;
    }
}

static bool rides_on(const face *f, uint32_t bone, uint32_t on)
{
    while (bone != RIG_NONE && bone != on)
        bone = f->rig->bone[bone].parent;
    return bone == on;
}

static double riding_of(const face *f, const double *share)
{
    double sum = 0.0;
    if (f->bones.jaw == RIG_NONE)
        return 0.0;
    for (uint32_t b = 0; b < f->bone_count; ++b)
        sum += rides_on(f, b, f->bones.jaw) ? share[b] : 0.0;
    double t = (sum - riding_begins) / (riding_ends - riding_begins);
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return t * t * (3.0 - 2.0 * t);
}

blend face_blend_at(const face *f, const face_grip *grip, const rigid *pose)
{
    return blend_of(grip->share, pose, f->bones.moves, f->bone_count);
}

double face_share_held(const face *f, const face_grip *grip)
{
    double sum = 0.0;
    for (uint32_t b = 0; b < f->bone_count; ++b)
        sum += grip->belongs[b] ? grip->share[b] : 0.0;
    return sum;
}

/* Skips the search if all vertices are alike. */
static uint32_t slot_at(const face *f, vec3 at, uint32_t contact)
{
    if (contact > 0)
        return f->contact_slot[contact - 1];
    return f->bone_count == 1 && f->field[0].is_whole ? 0 : points_nearest(&f->shown, at);
}

void face_grip_at(face_grip *out, const face *f, vec3 at, uint32_t contact)
{
    uint32_t slot = slot_at(f, at, contact);
    *out = (face_grip){.mobility = 1.0, .contact = contact};
    for (uint32_t b = 0; b < f->bone_count; ++b)
        out->share[b] = (double)f->field[b].weight[slot];
    double mobility = (double)f->mobility[slot];
    out->is_dropped = mobility < mobility_least;
    out->mobility = mobility < mobility_exact ? mobility_exact : mobility;
    if (!out->is_dropped)
        join_bones(out, f->bone_count);
    out->is_dropped = !(face_share_held(f, out) > 0.0);
    out->riding = riding_of(f, out->share);
    blend posed = face_blend_at(f, out, f->pose);
    out->start = vec3_sub(blend_undo(&posed, at), face_shapes_led_slot(f, slot));
}

void face_assign(face *f, const face_grip *grip, uint32_t count)
{
    uint32_t column = f->shape_column_count;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        face_field *field = &f->field[b];
        field->control_count = 0;
        field->first_column = column;
        for (uint32_t k = 0; k < count; ++k)
            if (grip[k].belongs[b])
                field->control[field->control_count++] = k;
        column += field->control_count;
    }
    f->control_column_count = column;
}

bool face_can_grip(const face *f, vec3 at)
{
    face_grip grip;
    face_grip_at(&grip, f, at, 0);
    return !grip.is_dropped;
}

bool face_movable_near(const face *f, vec3 at, const vec3 *taken, uint32_t count, double apart_mm,
                       vec3 *out)
{
    double least_mm = (double)INFINITY;
    for (uint32_t slot = 0; slot < f->shown.count; ++slot) {
        const vec3 p = points_position(&f->shown, slot);
        const double mm = vec3_length(vec3_sub(p, at));
        bool is_free = (double)f->mobility[slot] > 0.5 && mm < least_mm;
        for (uint32_t i = 0; is_free && i < count; ++i)
            is_free = vec3_length(vec3_sub(p, taken[i])) >= apart_mm;
        if (!is_free)
            continue;
        least_mm = mm;
        *out = p;
    }
    return isfinite(least_mm);
}
