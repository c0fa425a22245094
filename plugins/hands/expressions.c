#include "expressions.h"
#include "mapping.h"

#include <math.h>
#include <string.h>

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))

const char *const expression_names[EXPRESSION_COUNT + 1] = {
    "Neutral", "Smile", "Frown", "Jaw open", "Brows up", "Brows down",
    "Pucker",  "Blink", "Wink",  "Nod",      NULL};

/* Movements for a head 240 mm high, in mm; out: away from the midline. Neighbouring contacts follow
 * in part, because a contact that is not pulled holds its place. "x.*": both x.l and x.r. */
static const struct pull_part {
    expression expression;
    const char *contact;
    float out, up, front;
} pull_parts[] = {
    {EXPRESSION_SMILE, "mouth.corner.*", 6, 8, -3.5f},
    {EXPRESSION_SMILE, "nasolabial.*", 2.5f, 4.5f, 1},
    {EXPRESSION_SMILE, "cheek.lower.*", 3, 4.5f, 0},
    {EXPRESSION_SMILE, "lip.upper.side.*", 3.5f, 4, -1.5f},
    {EXPRESSION_SMILE, "lip.lower.side.*", 3.5f, 3.5f, -1.5f},
    {EXPRESSION_SMILE, "cheek.*", 1.2f, 5, 2},
    {EXPRESSION_FROWN, "mouth.corner.*", 1.2f, -9.5f, -1.5f},
    {EXPRESSION_FROWN, "nasolabial.*", 0, -3, 0},
    {EXPRESSION_FROWN, "cheek.lower.*", 0, -3, 0},
    {EXPRESSION_FROWN, "lip.upper.side.*", 0.5f, -3, 0},
    {EXPRESSION_FROWN, "lip.lower.side.*", 0.5f, -4.5f, 0},
    {EXPRESSION_FROWN, "cheek.*", 0, -2, 0},
    {EXPRESSION_FROWN, "brow.inner.*", -1, 4, 0},
    {EXPRESSION_BROWS_UP, "brow.inner.*", 0, 8.5f, 0},
    {EXPRESSION_BROWS_UP, "brow.mid.*", 0, 10, 0},
    {EXPRESSION_BROWS_UP, "brow.outer.*", 0, 7.5f, 0},
    {EXPRESSION_BROWS_UP, "forehead.mid", 0, 3, 0},
    {EXPRESSION_BROWS_DOWN, "brow.inner.*", -2.5f, -6, 1},
    {EXPRESSION_BROWS_DOWN, "brow.mid.*", -1, -5, 0},
    {EXPRESSION_BROWS_DOWN, "brow.outer.*", 0, -2, 0},
    {EXPRESSION_BROWS_DOWN, "forehead.mid", 0, -1.5f, 0},
    {EXPRESSION_PUCKER, "mouth.corner.*", -8, 0, 4},
    {EXPRESSION_PUCKER, "lip.upper.side.*", -4.4f, 0, 5},
    {EXPRESSION_PUCKER, "lip.lower.side.*", -4.4f, 0, 5},
    {EXPRESSION_PUCKER, "lip.upper.mid", 0, 0, 6},
    {EXPRESSION_PUCKER, "lip.lower.mid", 0, 0, 6},
    {EXPRESSION_PUCKER, "nasolabial.*", -1.6f, 0, 1.2f},
    {EXPRESSION_PUCKER, "cheek.lower.*", -2.8f, 0, 1},
};

/* Share of the range from rest to the end in that direction. */
static const struct turn_part {
    expression expression;
    const char *dof;
    float part;
} turn_parts[] = {
    {EXPRESSION_JAW_OPEN, "jaw.open", 0.7f},
    {EXPRESSION_SMILE, "jaw.open", 0.06f},
    {EXPRESSION_BLINK, "lid_upper.l.close", 1},
    {EXPRESSION_BLINK, "lid_upper.r.close", 1},
    {EXPRESSION_BLINK, "lid_lower.l.close", 0.8f},
    {EXPRESSION_BLINK, "lid_lower.r.close", 0.8f},
    {EXPRESSION_WINK, "lid_upper.l.close", 1},
    {EXPRESSION_WINK, "lid_lower.l.close", 0.8f},
    {EXPRESSION_SMILE, "lid_lower.l.close", 0.35f},
    {EXPRESSION_SMILE, "lid_lower.r.close", 0.35f},
    {EXPRESSION_BROWS_UP, "lid_upper.l.close", -0.5f},
    {EXPRESSION_BROWS_UP, "lid_upper.r.close", -0.5f},
    {EXPRESSION_NOD, "skull.nod", 0.5f},
};

/* ---- finding ---- */

/* Compares a name with a pattern. side: 1: the subject's left, -1: right, 0: none. Returns false if
 * the name does not match. */
static bool is_named(const char *name, const char *pattern, float *out_side)
{
    size_t length = strlen(pattern);
    *out_side = 0.0f;
    if (length < 2 || pattern[length - 1] != '*')
        return strcmp(name, pattern) == 0;
    if (strncmp(name, pattern, length - 1) != 0 || !strchr("lr", name[length - 1]) ||
        strlen(name) != length)
        return false;
    *out_side = name[length - 1] == 'l' ? 1.0f : -1.0f;
    return true;
}

/* Returns the slot of the face's contact; EXPRESSIONS_CONTACTS_MAX if full. */
static uint32_t contact_slot(expressions *self, const mrt_face *face, uint32_t contact)
{
    uint32_t slot = 0;
    while (slot < self->contact_count && self->contact[slot] != contact)
        ++slot;
    if (slot == self->contact_count && slot < EXPRESSIONS_CONTACTS_MAX) {
        self->contact[slot] = contact;
        self->rest[slot] = face->contacts[contact].rest;
        self->contact_count += 1;
    }
    return slot;
}

static uint32_t dof_slot(expressions *self, uint32_t dof)
{
    uint32_t slot = 0;
    while (slot < self->dof_count && self->dof[slot] != dof)
        ++slot;
    if (slot == self->dof_count && slot < EXPRESSIONS_DOFS_MAX)
        self->dof[self->dof_count++] = dof;
    return slot;
}

static void find_pulls(expressions *self, const mrt_face *face, const struct pull_part *part,
                       float scale)
{
    float side;
    for (uint32_t i = 0; i < face->contact_count; ++i) {
        if (!is_named(face->contacts[i].name, part->contact, &side))
            continue;
        uint32_t slot = contact_slot(self, face, i);
        if (slot == EXPRESSIONS_CONTACTS_MAX)
            return;
        self->way[part->expression][slot] =
            (mrt_vec3){side * scale * part->out, scale * part->up, scale * part->front};
        self->can[part->expression] = true;
    }
}

static void find_turns(expressions *self, const mrt_face *face, const struct turn_part *part)
{
    for (uint32_t i = 0; i < face->dof_count && i < MRT_MAX_DOFS; ++i) {
        const mrt_dof *dof = &face->dofs[i];
        if (strcmp(dof->name, part->dof) != 0)
            continue;
        uint32_t slot = dof_slot(self, i);
        float end = part->part < 0.0f ? -dof->min : dof->max;
        if (slot == EXPRESSIONS_DOFS_MAX || !(end > 0.0f) || !isfinite(end))
            return;
        self->turn[part->expression][slot] = part->part * end;
        self->can[part->expression] = true;
    }
}

static void report_missing(const expressions *self, const mrt_host *host)
{
    char line[200] = "the face has no contact or degree of freedom for:";
    size_t head = strlen(line), used = head;
    for (int i = EXPRESSION_NEUTRAL + 1; i < EXPRESSION_COUNT; ++i) {
        size_t length = strlen(expression_names[i]);
        if (self->can[i] || used + length + 3 > sizeof line)
            continue;
        if (used > head)
            line[used++] = ',';
        line[used++] = ' ';
        memcpy(line + used, expression_names[i], length + 1);
        used += length;
    }
    if (used > head)
        host->log(host, MRT_LOG_WARNING, line);
}

bool expressions_find(expressions *out, const mrt_face *face, const mrt_host *host)
{
    memset(out, 0, sizeof *out);
    float height = face->high.y - face->low.y;
    float scale = isfinite(height) && height > 0.0f ? height / 240.0f : 1.0f;
    for (size_t i = 0; i < COUNT_OF(pull_parts); ++i)
        find_pulls(out, face, &pull_parts[i], scale);
    for (size_t i = 0; i < COUNT_OF(turn_parts); ++i)
        find_turns(out, face, &turn_parts[i]);
    if (out->contact_count + out->dof_count == 0) {
        host->log(host, MRT_LOG_ERROR,
                  "the face has no contact or degree of freedom for expressions (mouth.corner.l, "
                  "jaw.open ...): open a face with a rig");
        return false;
    }
    report_missing(out, host);
    return true;
}

/* ---- writing ---- */

static mrt_vec3 way_of(const expressions *self, const double part[EXPRESSION_COUNT], uint32_t slot)
{
    double x = 0.0, y = 0.0, z = 0.0;
    for (int i = 0; i < EXPRESSION_COUNT; ++i) {
        x += part[i] * (double)self->way[i][slot].x;
        y += part[i] * (double)self->way[i][slot].y;
        z += part[i] * (double)self->way[i][slot].z;
    }
    return (mrt_vec3){(float)x, (float)y, (float)z};
}

static float turn_of(const expressions *self, const double part[EXPRESSION_COUNT], uint32_t slot)
{
    double sum = 0.0;
    for (int i = 0; i < EXPRESSION_COUNT; ++i)
        sum += part[i] * (double)self->turn[i][slot];
    return (float)sum;
}

/* ---- chosen poses ---- */

void expression_poses_set(expression_poses *out, const mrt_face *face, const mrt_rig_pose *poses,
                          uint32_t count)
{
    *out = (expression_poses){.face = face, .pose = poses};
    out->count = count < EXPRESSIONS_POSES_MAX ? count : (uint32_t)EXPRESSIONS_POSES_MAX;
    for (uint32_t i = 0; i < out->count; ++i)
        out->value[i] = mrt_pose_value(poses[i].name);
}

const mrt_rig_pose *expression_poses_find(const expression_poses *self, double value)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if ((double)self->value[i] <= value && (double)self->value[i] >= value)
            return &self->pose[i];
    return NULL;
}

static uint32_t vector_of(mrt_vector *vector, uint32_t *count, const mrt_face *face,
                          uint32_t contact)
{
    for (uint32_t i = 0; i < *count; ++i)
        if (vector[i].contact == contact + 1)
            return i;
    const mrt_vec3 rest = face->contacts[contact].rest;
    vector[*count] = (mrt_vector){rest, rest, contact + 1};
    return (*count)++;
}

static void add_pose(const expression_poses *of, const expression_played *played,
                     mrt_vector *vector, uint32_t *count, mrt_pull *pull)
{
    const mrt_face *face = of->face;
    const float strength = (float)played->strength;
    for (uint32_t k = 0; k < face->contact_count && k < MRT_MAX_VECTORS; ++k) {
        mrt_vector *v = &vector[vector_of(vector, count, face, k)];
        v->end = vec_sum(v->end, strength, played->pose->pulls[k]);
    }
    for (uint32_t d = 0; d < face->dof_count && d < MRT_MAX_DOFS; ++d) {
        const float turn = strength * played->pose->dofs[d];
        pull->dof[d] = (isnan(pull->dof[d]) ? 0.0f : pull->dof[d]) + turn;
    }
}

void expressions_write(const expressions *self, const double part[EXPRESSION_COUNT],
                       const expression_poses *of, const expression_played *played,
                       uint32_t played_count, mrt_pull *pull)
{
    mrt_vector vector[EXPRESSIONS_CONTACTS_MAX + MRT_MAX_VECTORS];
    uint32_t count = self->contact_count;
    for (uint32_t i = 0; i < self->contact_count; ++i) {
        mrt_vec3 rest = self->rest[i], way = way_of(self, part, i);
        vector[i] = (mrt_vector){rest, vec_sum(rest, 1.0f, way), 1 + self->contact[i]};
    }
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
    for (uint32_t i = 0; i < self->dof_count; ++i)
        pull->dof[self->dof[i]] = turn_of(self, part, i);
    for (uint32_t i = 0; i < played_count; ++i)
        if (played[i].pose)
            add_pose(of, &played[i], vector, &count, pull);
    mapping_pull(pull, vector, count < MRT_MAX_VECTORS ? count : (uint32_t)MRT_MAX_VECTORS, 0.0f);
}
