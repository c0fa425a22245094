#include "face/rig/rig_check_parts.h"

#include "face/bones.h"
#include "face/rig/rig_mirror.h"

#include <math.h>

static const double degree_per_radian = 57.29577951308232;

static uint32_t find_jaw(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (r->bone[i].kind == BONE_JAW)
            return i;
    return RIG_NONE;
}

mrt_result rig_check_hinge(const rig *r, error *err)
{
    uint32_t jaw = find_jaw(r);
    if (jaw == RIG_NONE || r->bone[jaw].hinge_left.x > r->bone[jaw].hinge_right.x)
        return MRT_OK;
    rig_place place = rig_where(r, RIG_BONES, jaw);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.hinge: left lies at x = %.1f mm and right at %.1f mm; exchange them: +x "
                     "is the subject's left",
                     place.text, r->bone[jaw].hinge_left.x, r->bone[jaw].hinge_right.x);
}

/* Where heads have it (theory 4.2), with room for puppets: as shares of chin to top above the chin,
 * and of back to front before the back. */
static void check_axis(rig_checking *c, const rig_bone *jaw, const rig_place *place)
{
    const rig_head *head = c->head;
    vec3 middle = vec3_scale(vec3_add(jaw->hinge_left, jaw->hinge_right), 0.5);
    double up = (middle.y - head->chin.y) / (head->top_y - head->chin.y);
    double forward = (middle.z - head->back_z) / (head->nose.z - head->back_z);
    bool is_usual = up > 0.22 && up < 0.55 && forward > 0.35 && forward < 0.68;
    rig_find(c, is_usual ? RIG_NOTE : RIG_WARNING, place->text,
             "the axis lies at %.2f of the way from chin to top and %.2f of the way from back to "
             "front%s",
             up, forward,
             is_usual ? "" : "; 0.25 to 0.45 and 0.45 to 0.6 are usual: just before the ears");
    double aside = middle.x - head->middle_x;
    if (fabs(aside) > 2.0)
        rig_find(c, RIG_WARNING, place->text,
                 "the middle of the axis is %.1f mm aside of the symmetry plane", aside);
}

/* The front edge of what is rigid on the jaw: the foremost vertex. */
static bool find_incisor(vec3 *out, const rig_checking *c, uint32_t jaw)
{
    bool found = c->r->bone[jaw].has_incisor;
    *out = c->r->bone[jaw].incisor;
    for (uint32_t v = 0; c->marks && !c->r->bone[jaw].has_incisor && v < c->m->vertex_count; ++v) {
        vec3 p = rig_mirror_position(c->m, v);
        if (c->marks->rigid_bone[v] != jaw || (found && p.z <= out->z))
            continue;
        *out = p;
        found = true;
    }
    return found;
}

static void check_opening(rig_checking *c, uint32_t jaw, const rig_place *place)
{
    vec3 incisor;
    bones b;
    error err = {""};
    if (!find_incisor(&incisor, c, jaw)) {
        rig_find(c, RIG_NOTE, place->text,
                 "no vertex is rigid on the jaw and no \"incisor\" is given: millimetres of motion "
                 "are measured at a guess");
        return;
    }
    if (bones_init(&b, c->r, incisor, &err) < 0) {
        rig_find(c, RIG_ERROR, place->text, "%s", err.text);
        return;
    }
    const rig_bone *bone = &c->r->bone[jaw];
    rigid motion = bones_jaw(&b, bone->open_max_rad, 0.0, 0.0);
    double gap_mm = vec3_length(vec3_sub(rigid_apply(&motion, incisor), incisor));
    double head_mm = c->head ? c->head->top_y - c->head->chin.y : 225.0;
    double usual_mm = 50.0 * head_mm / 225.0;
    bool is_usual = gap_mm > 0.6 * usual_mm && gap_mm < 1.5 * usual_mm;
    rig_find(
        c, is_usual ? RIG_NOTE : RIG_WARNING, place->text,
        "fully open (%.0f degrees) the incisors are %.1f mm apart%s%.0f mm would be usual for a "
        "head of %.0f mm",
        bone->open_max_rad * degree_per_radian, gap_mm, is_usual ? "; about " : "; ", usual_mm,
        head_mm);
}

void rig_check_jaw(rig_checking *c)
{
    uint32_t jaw = find_jaw(c->r);
    if (jaw == RIG_NONE) {
        rig_find(c, RIG_NOTE, "$.bones", "no bone has a hinge: the mouth does not open");
        return;
    }
    rig_place place = rig_where(c->r, RIG_BONES, jaw);
    if (c->head)
        check_axis(c, &c->r->bone[jaw], &place);
    check_opening(c, jaw, &place);
}
