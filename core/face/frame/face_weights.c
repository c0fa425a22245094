#include "face/face_weights.h"

#include "face/frame/frame.h"
#include "face/frame/shape_solve.h"
#include "face/rig/rig_poses.h"
#include "mesh/position.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS_MAX = 3 * FACE_WEIGHTS_POINTS + MRT_MAX_DOFS, TERMS = 8 };
static const double ridge_part = 1e-4; /* of the shape's own square */
static const double ridge_mm = 0.01;   /* root mean square over the points */
static const double few_part = 0.005;  /* of the shape's own square: cost per unit of weight */
static const double dof_points = 20.0; /* number of points that a degree of freedom counts for */
static const double look_rad = 0.5236; /* full turn of an eye, if no pose defines it */
static const double least_mm = 0.02;   /* least size of a shape that is used */
static const double quiet_part = 0.15; /* least worth of a point, as a share of the greatest */

const char *const face_expression_name[FACE_EXPRESSIONS] = {
    "happy",      "angry",  "sad",      "relaxed",  "surprised", "aa",
    "ih",         "ou",     "ee",       "oh",       "blink",     "blinkLeft",
    "blinkRight", "lookUp", "lookDown", "lookLeft", "lookRight", "neutral"};
enum {
    HAPPY,
    SURPRISED = 4,
    OH = 9,
    BLINK,
    BLINK_LEFT,
    BLINK_RIGHT,
    LOOK_UP,
    LOOK_DOWN,
    LOOK_LEFT,
    LOOK_RIGHT,
    NEUTRAL
};

const char *const face_viseme_name[FACE_VISEMES] = {"sil", "PP", "FF", "TH",      "DD", "kk",
                                                    "CH",  "SS", "nn", "RR",      "aa", "E",
                                                    "I",   "O",  "U",  "laughter"};

/* A sum of the 52. A name with a left and a right side means both. */
typedef struct term {
    const char *name;
    double part;
} term;

/* Solved together, so that a laugh is not taken for a vowel. The other expressions come from the
 * eyes. */
static const term expression_sum[OH + 1][TERMS] = {
    /* happy */ {{"mouthSmile", 0.9}, {"cheekSquint", 0.6}, {"eyeSquint", 0.3}},
    /* angry */ {{"browDown", 0.9}, {"noseSneer", 0.4}, {"mouthPress", 0.4}, {"eyeSquint", 0.3}},
    /* sad */ {{"browInnerUp", 0.9}, {"mouthFrown", 0.8}, {"mouthShrugLower", 0.3}},
    /* relaxed */ {{"mouthSmile", 0.4}, {"browInnerUp", 0.2}, {"eyeBlink", 0.3}},
    /* surprised */
    {{"browInnerUp", 0.8}, {"browOuterUp", 0.8}, {"eyeWide", 0.7}, {"jawOpen", 0.3}},
    /* aa */ {{"jawOpen", 0.7}, {"mouthLowerDown", 0.2}, {"mouthUpperUp", 0.1}},
    /* ih */ {{"jawOpen", 0.2}, {"mouthStretch", 0.5}, {"mouthLowerDown", 0.3}},
    /* ou */ {{"jawOpen", 0.15}, {"mouthPucker", 0.8}, {"mouthFunnel", 0.2}},
    /* ee */ {{"jawOpen", 0.25}, {"mouthSmile", 0.3}, {"mouthStretch", 0.3}},
    /* oh */ {{"jawOpen", 0.4}, {"mouthFunnel", 0.7}}};

static const term viseme_sum[FACE_VISEMES][TERMS] = {
    /* sil */ {{NULL, 0.0}},
    /* PP */ {{"mouthPress", 0.6}, {"mouthRollLower", 0.3}, {"mouthRollUpper", 0.3}},
    /* FF */ {{"jawOpen", 0.06}, {"mouthRollLower", 0.7}, {"mouthUpperUp", 0.3}},
    /* TH */ {{"jawOpen", 0.15}, {"tongueOut", 0.5}, {"mouthUpperUp", 0.2}},
    /* DD */ {{"jawOpen", 0.15}, {"mouthLowerDown", 0.3}, {"mouthUpperUp", 0.2}},
    /* kk */ {{"jawOpen", 0.25}, {"mouthLowerDown", 0.2}, {"mouthStretch", 0.2}},
    /* CH */
    {{"jawOpen", 0.12}, {"mouthFunnel", 0.6}, {"mouthUpperUp", 0.2}, {"mouthLowerDown", 0.3}},
    /* SS */
    {{"jawOpen", 0.05}, {"mouthStretch", 0.4}, {"mouthLowerDown", 0.4}, {"mouthUpperUp", 0.2}},
    /* nn */ {{"jawOpen", 0.12}, {"mouthLowerDown", 0.2}, {"mouthDimple", 0.3}},
    /* RR */ {{"jawOpen", 0.15}, {"mouthFunnel", 0.4}, {"mouthPucker", 0.3}},
    /* aa */ {{"jawOpen", 0.7}, {"mouthLowerDown", 0.2}, {"mouthUpperUp", 0.1}},
    /* E */ {{"jawOpen", 0.3}, {"mouthSmile", 0.25}, {"mouthStretch", 0.3}},
    /* I */ {{"jawOpen", 0.18}, {"mouthSmile", 0.5}, {"mouthDimple", 0.3}},
    /* O */ {{"jawOpen", 0.4}, {"mouthFunnel", 0.7}},
    /* U */ {{"jawOpen", 0.15}, {"mouthPucker", 0.8}, {"mouthFunnel", 0.2}},
    /* laughter */ {{"jawOpen", 0.5}, {"mouthSmile", 0.9}, {"cheekSquint", 0.6}}};

/* Shapes whose weights are solved together. */
typedef struct shape_set {
    uint32_t count;
    double *column; /* row_count by count */
    double *h;      /* count by count, with the ridge */
    double *few, *b, *low, *high, *weight, *scratch;
    bool *is_there;
} shape_set;

enum { IN, OUT, UP, DOWN, WAYS };

typedef struct eye {
    uint32_t bone;              /* RIG_NONE if it has none */
    uint32_t look[WAYS], blink; /* indices into the 52 */
    double whole_rad[WAYS];
} eye;

struct face_weights {
    arrays arrays; /* owner of the arrays of the sets */
    const rig *rig;
    bones bones;
    uint32_t vertex_count, point_count, row_count;
    uint32_t vertex[FACE_WEIGHTS_POINTS];
    vec3 rest[FACE_WEIGHTS_POINTS];
    double share[FACE_WEIGHTS_POINTS][RIG_BONES_MAX];
    uint32_t dof_row_count,
        dof_row[MRT_MAX_DOFS];      /* dof_row: index of the degree of freedom of each row */
    double dof_scale[MRT_MAX_DOFS]; /* factor of each of these rows */
    double y[ROWS_MAX];
    rigid pose[RIG_BONES_MAX]; /* pose of the frame */
    face_name_source source[ARKIT_CHANNELS];
    shape_set arkit, expressions, visemes;
    uint32_t jaw_open, mouth_close;
    uint32_t head; /* bone, or RIG_NONE */
    eye eye[2];    /* left, right */
    face_channels channels;
};

/* ---- creation: the meaning of each name ---- */

/* Meaning of a name during creation: offsets of all vertices, with the bones back at rest. */
typedef struct meaning {
    bool is_there;
    float *offset; /* vertex_count by 3, file order */
    double dof[MRT_MAX_DOFS];
} meaning;

enum {
    VISEME_MEANING = ARKIT_SHAPES,
    EXPRESSION_MEANING = VISEME_MEANING + FACE_VISEMES, /* those that are solved together */
    MEANINGS = EXPRESSION_MEANING + OH + 1
};

/* VRM's names for shapes that the 52 or the visemes call otherwise. */
static const struct {
    const char *expression, *name;
} same_word[] = {{"blinkLeft", "eyeBlinkLeft"},
                 {"blinkRight", "eyeBlinkRight"},
                 {"aa", "viseme_aa"},
                 {"ee", "viseme_E"},
                 {"ih", "viseme_I"},
                 {"oh", "viseme_O"},
                 {"ou", "viseme_U"}};

typedef struct making {
    arrays arrays; /* owner of position and of the offsets of the meanings */
    face_weights *self;
    face *f;
    const mesh *m;
    csrbf_settings solver;
    meaning of[MEANINGS];
    float *position; /* vertex_count by 3 */
} making;

/* Returns which of the 52, the visemes and the expressions a shape or a pose stands for, or
 * MEANINGS for none. "browInnerUp_L" is half of browInnerUp; a viseme begins as in "viseme_aa". */
static uint32_t meaning_of(const char *name)
{
    char whole[64];
    uint32_t found = arkit_find(name);
    if (found < ARKIT_SHAPES)
        return found;
    for (uint32_t i = 0; i < FACE_VISEMES; ++i)
        if (strncmp(name, "viseme_", 7) == 0 && strcmp(name + 7, face_viseme_name[i]) == 0)
            return VISEME_MEANING + i;
    for (uint32_t i = 0; i <= OH; ++i)
        if (strcmp(name, face_expression_name[i]) == 0)
            return EXPRESSION_MEANING + i;
    size_t size = strlen(name);
    if (size < 3 || size >= sizeof whole || name[size - 2] != '_')
        return MEANINGS;
    memcpy(whole, name, size - 2);
    whole[size - 2] = '\0';
    found = arkit_find(whole);
    return found < ARKIT_SHAPES ? found : MEANINGS;
}

/* Adds this part of one of the head's own shapes. */
static void add_own_shape(making *k, uint32_t at, uint32_t own, double part)
{
    meaning *to = &k->of[at];
    float *one = k->position;
    face_shape_offset(k->f, own, one);
    for (size_t n = 0; n < (size_t)3 * k->m->vertex_count; ++n)
        to->offset[n] += (float)part * one[n];
    for (uint32_t d = 0; d < k->self->bones.dof_count; ++d)
        to->dof[d] += part * (double)face_shape_dofs(k->f, own)[d];
    to->is_there = true;
    if (at < ARKIT_SHAPES)
        k->self->source[at] = FACE_NAME_SHAPE;
}

static void add_own_shapes(making *k)
{
    for (uint32_t i = 0; i < face_shape_count(k->f); ++i) {
        uint32_t at = meaning_of(face_shape_name(k->f, i));
        if (at < MEANINGS)
            add_own_shape(k, at, i, 1.0);
    }
}

/* Adds an expression that the mesh's table combines from several shapes, if no shape has its
 * name. */
static void add_expression(making *k, uint32_t at, const char *name)
{
    float part[FACE_SHAPES_MAX];
    const bool is_there = face_shape_count(k->f) > 0 && face_shape_parts(k->f, name, part);
    for (uint32_t i = 0; is_there && i < face_shape_count(k->f); ++i)
        if (part[i] > 0.0f)
            add_own_shape(k, at, i, (double)part[i]);
}

static void add_expressions(making *k)
{
    const mesh *m = k->m;
    for (uint32_t i = 0; i < m->expression_count; ++i) {
        const char *name = m->expression[i].name;
        uint32_t at = meaning_of(name);
        if (i > 0 && strcmp(name, m->expression[i - 1].name) == 0)
            continue;
        if (at < MEANINGS && !k->of[at].is_there)
            add_expression(k, at, name);
        for (size_t w = 0; w < sizeof same_word / sizeof *same_word; ++w)
            if (strcmp(same_word[w].expression, name) == 0 &&
                !k->of[at = meaning_of(same_word[w].name)].is_there)
                add_expression(k, at, name);
    }
}

/* Uses the targets of a mesh without a rig directly, since it moves only its vertices. */
static void add_targets(making *k)
{
    for (uint32_t i = 0; i < k->m->target_count && !face_bones(k->f)->rig; ++i) {
        uint32_t at = meaning_of(k->m->target[i].name);
        if (at == MEANINGS)
            continue;
        for (size_t n = 0; n < (size_t)3 * k->m->vertex_count; ++n)
            k->of[at].offset[n] += k->m->target[i].offset[n];
        k->of[at].is_there = true;
        if (at < ARKIT_SHAPES)
            k->self->source[at] = FACE_NAME_SHAPE;
    }
}

static void shares_of(double *out, const binding *b, size_t vertex)
{
    for (size_t bone = 0; bone < b->bone_count; ++bone)
        out[bone] = (double)b->weight[bone * b->vertex_count + vertex];
}

/* Adds the motion of a pose, with the bones back at rest. */
static mrt_result add_pose(making *k, const rig *r, uint32_t pose, meaning *to, error *err)
{
    const bones *b = &k->self->bones;
    mrt_result result = rig_poses_show_on(k->f, r, pose, &k->solver, err);
    if (result < 0)
        return result;
    float dof[MRT_MAX_DOFS];
    points_to_rows(k->position, face_shown(k->f), face_order(k->f));
    bones_unlimit(dof, b, face_metered(k->f)->dof);
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        double share[RIG_BONES_MAX];
        const float *at = k->position + (size_t)3 * v, *rest = k->m->position + (size_t)3 * v;
        shares_of(share, face_binding(k->f), v);
        blend here = blend_of(share, k->f->pose, b->moves, b->bone_count);
        vec3 back = blend_undo(&here, (vec3){(double)at[0], (double)at[1], (double)at[2]});
        to->offset[3 * (size_t)v] += (float)(back.x - (double)rest[0]);
        to->offset[3 * (size_t)v + 1] += (float)(back.y - (double)rest[1]);
        to->offset[3 * (size_t)v + 2] += (float)(back.z - (double)rest[2]);
    }
    for (uint32_t d = 0; d < b->dof_count; ++d)
        to->dof[d] += (double)dof[d];
    to->is_there = true;
    return MRT_OK;
}

static mrt_result add_poses(making *k, const rig *r, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; r && i < r->pose_count && result >= 0; ++i) {
        uint32_t at = meaning_of(r->pose[i].name);
        if (at == MEANINGS || k->of[at].is_there)
            continue;
        result = add_pose(k, r, i, &k->of[at], err);
        if (at < ARKIT_SHAPES)
            k->self->source[at] = FACE_NAME_POSE;
    }
    /* mouthClose was shown over the open jaw, so jawOpen is subtracted. */
    meaning *close = &k->of[k->self->mouth_close], *open = &k->of[k->self->jaw_open];
    if (k->self->source[k->self->mouth_close] != FACE_NAME_POSE || !open->is_there ||
        k->self->source[k->self->jaw_open] != FACE_NAME_POSE)
        return result;
    for (size_t n = 0; n < (size_t)3 * k->m->vertex_count; ++n)
        close->offset[n] -= open->offset[n];
    for (uint32_t d = 0; d < MRT_MAX_DOFS; ++d)
        close->dof[d] -= open->dof[d];
    return result;
}

/* ---- creation: the sampled points ---- */

/* Returns how far all meanings together move a vertex, mm. */
static double stir_at(const making *k, uint32_t v)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < MEANINGS; ++i) {
        const float *o = k->of[i].offset + (size_t)3 * v;
        if (k->of[i].is_there)
            sum += (double)o[0] * (double)o[0] + (double)o[1] * (double)o[1] +
                   (double)o[2] * (double)o[2];
    }
    return sqrt(sum);
}

/* Chooses the vertices furthest from those chosen before; denser where more is moved. */
static mrt_result choose_points(making *k, error *err)
{
    face_weights *self = k->self;
    const binding *b = face_binding(k->f);
    uint32_t count = k->m->vertex_count;
    double *worth = calloc((size_t)2 * count + 1, sizeof *worth), *near = worth + count, most = 0.0;
    if (!worth)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the points of the face");
    for (uint32_t v = 0; v < count; ++v) {
        worth[v] = b->mobility[v] > 0.0f ? stir_at(k, v) : 0.0;
        most = fmax(most, worth[v]);
        near[v] = 1e30;
    }
    for (uint32_t v = 0; v < count; ++v)
        worth[v] = worth[v] > 0.0 ? worth[v] + quiet_part * most : 0.0;
    while (self->point_count < FACE_WEIGHTS_POINTS) {
        uint32_t best = count;
        for (uint32_t v = 0; v < count; ++v)
            if (worth[v] * near[v] > (best < count ? worth[best] * near[best] : 0.0))
                best = v;
        if (best == count)
            break;
        uint32_t p = self->point_count++;
        self->vertex[p] = best;
        self->rest[p] = mesh_position(k->m, best);
        shares_of(self->share[p], b, best);
        for (uint32_t v = 0; v < count; ++v) {
            vec3 way = vec3_sub(mesh_position(k->m, v), self->rest[p]);
            near[v] = fmin(near[v], vec3_length(way));
        }
    }
    free(worth);
    return MRT_OK;
}

static bool is_of_eye(const face_weights *self, uint32_t dof)
{
    uint32_t bone = self->bones.dof[dof].bone;
    return bone == self->eye[0].bone || bone == self->eye[1].bone;
}

/* Returns the root mean square of how far a change by 1 moves the vertices that the bone
 * carries. */
static double reach_of(const making *k, uint32_t d)
{
    const bones *b = &k->self->bones;
    const binding *bound = face_binding(k->f);
    float dof[MRT_MAX_DOFS] = {0};
    rigid pose[RIG_BONES_MAX];
    double sum = 0.0;
    uint32_t count = 0, bone = b->dof[d].bone;
    dof[d] = 0.5f * (b->dof[d].max > 0.0f ? b->dof[d].max : b->dof[d].min);
    bones_pose(pose, b, dof);
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        vec3 at = mesh_position(k->m, v);
        if (!(bound->weight[bone * (size_t)bound->vertex_count + v] > 0.5f))
            continue;
        vec3 way = vec3_sub(rigid_apply(&pose[bone], at), at);
        sum += vec3_dot(way, way);
        count += 1;
    }
    return count > 0 && dof[d] != 0.0f ? sqrt(sum / count) / fabs((double)dof[d]) : 0.0;
}

/* Chooses the degrees of freedom of bones that some shape moves, except those of eyes. */
static void choose_dofs(making *k)
{
    face_weights *self = k->self;
    for (uint32_t d = 0; d < self->bones.dof_count; ++d) {
        bool is_moved = false;
        for (uint32_t i = 0; i < MEANINGS; ++i)
            is_moved = is_moved || fabs(k->of[i].dof[d]) > 0.0;
        bool counts = is_moved && d != self->bones.seal && !is_of_eye(self, d);
        double reach = counts ? reach_of(k, d) : 0.0;
        if (!(reach > 0.0))
            continue;
        self->dof_row[self->dof_row_count] = d;
        self->dof_scale[self->dof_row_count++] = reach * sqrt(dof_points);
    }
    self->row_count = 3 * self->point_count + self->dof_row_count;
}

/* ---- creation: the least squares ---- */

static void set_create(shape_set *out, arrays *a, uint32_t count, uint32_t rows)
{
    out->count = count;
    out->column = arrays_add(a, (size_t)rows * count, sizeof *out->column);
    out->h = arrays_add(a, (size_t)count * count, sizeof *out->h);
    out->few = arrays_add(a, count, sizeof *out->few);
    out->b = arrays_add(a, count, sizeof *out->b);
    out->low = arrays_add(a, count, sizeof *out->low);
    out->high = arrays_add(a, count, sizeof *out->high);
    out->weight = arrays_add(a, count, sizeof *out->weight);
    out->scratch = arrays_add(a, SHAPE_SOLVE_SCRATCH(count), sizeof *out->scratch);
    out->is_there = arrays_add(a, count, sizeof *out->is_there);
}

static void fill_column(shape_set *s, uint32_t at, const face_weights *self, const meaning *from)
{
    for (uint32_t p = 0; p < self->point_count; ++p)
        for (uint32_t axis = 0; axis < 3; ++axis)
            s->column[(size_t)(3 * p + axis) * s->count + at] =
                (double)from->offset[(size_t)3 * self->vertex[p] + axis];
    for (uint32_t i = 0; i < self->dof_row_count; ++i)
        s->column[(size_t)(3 * self->point_count + i) * s->count + at] =
            self->dof_scale[i] * from->dof[self->dof_row[i]];
}

/* Adds a part of one of the 52. */
static void add_term(shape_set *to, uint32_t at, const face_weights *self, const char *name,
                     const char *side, double part)
{
    char whole[64];
    (void)snprintf(whole, sizeof whole, "%s%s", name, side);
    uint32_t from = arkit_find(whole);
    for (size_t r = 0; from < ARKIT_SHAPES && r < self->row_count; ++r)
        to->column[r * to->count + at] += part * self->arkit.column[r * ARKIT_SHAPES + from];
}

static void fill_sum(shape_set *to, uint32_t at, const face_weights *self, const term of[TERMS])
{
    for (int i = 0; i < TERMS && of[i].name; ++i) {
        add_term(to, at, self, of[i].name, "", of[i].part);
        add_term(to, at, self, of[i].name, "Left", of[i].part);
        add_term(to, at, self, of[i].name, "Right", of[i].part);
    }
}

static void set_finish(shape_set *s, const face_weights *self, double price)
{
    uint32_t n = s->count;
    for (size_t r = 0; r < self->row_count; ++r)
        for (uint32_t i = 0; i < n; ++i)
            for (uint32_t j = 0; j < n; ++j)
                s->h[(size_t)i * n + j] += s->column[r * n + i] * s->column[r * n + j];
    for (uint32_t i = 0; i < n; ++i) {
        double *own = &s->h[(size_t)i * n + i];
        s->is_there[i] = *own > least_mm * least_mm * self->point_count;
        s->few[i] = price * *own;
        *own += ridge_part * *own + 3.0 * self->point_count * ridge_mm * ridge_mm;
        s->high[i] = s->is_there[i] ? 1.0 : 0.0;
    }
}

static mrt_result fill_sets(making *k, error *err)
{
    face_weights *self = k->self;
    set_create(&self->arkit, &self->arrays, ARKIT_SHAPES, self->row_count);
    set_create(&self->expressions, &self->arrays, OH + 1, self->row_count);
    set_create(&self->visemes, &self->arrays, FACE_VISEMES, self->row_count);
    if (self->arrays.failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the weights of a face");
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i)
        if (k->of[i].is_there)
            fill_column(&self->arkit, i, self, &k->of[i]);
    for (uint32_t i = 0; i <= OH; ++i)
        if (k->of[EXPRESSION_MEANING + i].is_there)
            fill_column(&self->expressions, i, self, &k->of[EXPRESSION_MEANING + i]);
        else
            fill_sum(&self->expressions, i, self, expression_sum[i]);
    for (uint32_t i = 0; i < FACE_VISEMES; ++i)
        if (k->of[VISEME_MEANING + i].is_there)
            fill_column(&self->visemes, i, self, &k->of[VISEME_MEANING + i]);
        else
            fill_sum(&self->visemes, i, self, viseme_sum[i]);
    set_finish(&self->arkit, self, few_part);
    set_finish(&self->expressions, self, 0.0);
    set_finish(&self->visemes, self, 0.0);
    return MRT_OK;
}

/* ---- eyes ---- */

/* Computes the direction of the gaze relative to the bone's parent: to the face's left, and up. */
static void look_of(double *out_yaw_rad, double *out_pitch_rad, const face_weights *self,
                    uint32_t bone, const rigid *pose)
{
    uint32_t parent = self->rig->bone[bone].parent;
    vec3 to = rigid_rotate(&pose[bone], (vec3){0, 0, 1});
    if (parent != RIG_NONE) {
        rigid back = rigid_inverse(&pose[parent]);
        to = rigid_rotate(&back, to);
    }
    *out_yaw_rad = atan2(to.x, to.z);
    *out_pitch_rad = asin(fmin(fmax(to.y, -1.0), 1.0));
}

static void find_eyes(making *k)
{
    static const char *const names[2] = {"eye.l", "eye.r"};
    static const char *const looks[2][WAYS] = {
        {"eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft", "eyeLookDownLeft"},
        {"eyeLookInRight", "eyeLookOutRight", "eyeLookUpRight", "eyeLookDownRight"}};
    face_weights *self = k->self;
    for (int side = 0; side < 2; ++side) {
        eye *e = &self->eye[side];
        e->bone = self->rig ? rig_find_bone(self->rig, names[side]) : RIG_NONE;
        for (int way = 0; way < WAYS; ++way)
            e->look[way] = arkit_find(looks[side][way]);
        e->blink = arkit_find(side == 0 ? "eyeBlinkLeft" : "eyeBlinkRight");
    }
}

/* Marks the turns that bones provide: yaw, pitch and, for the head, roll. */
static void find_turns(face_weights *self)
{
    const uint32_t bone[3] = {self->head, self->eye[0].bone, self->eye[1].bone};
    for (uint32_t i = 0; i < 3; ++i)
        for (uint32_t axis = 0; axis < (i == 0 ? 3u : 2u); ++axis)
            if (bone[i] != RIG_NONE && self->bones.moves[bone[i]])
                self->source[ARKIT_SHAPES + 3 * i + axis] = FACE_NAME_BONES;
}

/* Measures the full turn of each eye in each direction. */
static void measure_eyes(making *k)
{
    face_weights *self = k->self;
    for (int side = 0; side < 2; ++side)
        for (int way = 0; way < WAYS; ++way) {
            eye *e = &self->eye[side];
            const meaning *of = &k->of[e->look[way]];
            float dof[MRT_MAX_DOFS] = {0};
            rigid pose[RIG_BONES_MAX];
            double yaw, pitch;
            if (e->bone == RIG_NONE)
                continue;
            for (uint32_t d = 0; d < self->bones.dof_count; ++d)
                dof[d] =
                    of->is_there && self->bones.dof[d].bone == e->bone ? (float)of->dof[d] : 0.0f;
            bones_pose(pose, &self->bones, dof);
            look_of(&yaw, &pitch, self, e->bone, pose);
            e->whole_rad[way] = fabs(way < UP ? yaw : pitch);
            if (!(e->whole_rad[way] > 0.05))
                e->whole_rad[way] = look_rad;
            self->source[e->look[way]] = FACE_NAME_BONES;
        }
}

/* ---- creating and destroying ---- */

static mrt_result prepare(making *k, error *err)
{
    face_weights *self = k->self;
    self->jaw_open = arkit_find("jawOpen");
    self->mouth_close = arkit_find("mouthClose");
    self->head = self->rig ? rig_find_bone(self->rig, "skull") : RIG_NONE;
    k->position = arrays_add(&k->arrays, (size_t)3 * k->m->vertex_count, sizeof *k->position);
    for (uint32_t i = 0; i < MEANINGS; ++i)
        k->of[i].offset = arrays_add(&k->arrays, (size_t)3 * k->m->vertex_count, sizeof(float));
    if (k->arrays.failed)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the shapes of %u vertices",
                         k->m->vertex_count);
    return MRT_OK;
}

static mrt_result make(making *k, error *err)
{
    mrt_result result = prepare(k, err);
    if (result < 0)
        return result;
    find_eyes(k);
    find_turns(k->self);
    add_targets(k);
    add_own_shapes(k);
    add_expressions(k);
    result = add_poses(k, face_bones(k->f)->rig, err);
    if (result >= 0)
        result = choose_points(k, err);
    if (result < 0)
        return result;
    choose_dofs(k);
    measure_eyes(k);
    return fill_sets(k, err);
}

mrt_result face_weights_create(face_weights **out, face *f, const rig *r, const mesh *m, error *err)
{
    *out = NULL;
    face_weights *self = calloc(1, sizeof *self);
    making *k = calloc(1, sizeof *k);
    mrt_result result =
        self && k ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the weights of a face");
    if (result >= 0) {
        self->rig = r;
        self->bones = *face_bones(f);
        self->bones.rig = r;
        self->vertex_count = m->vertex_count;
        *k = (making){
            .self = self, .f = f, .m = m, .solver = rig_poses_solver(face_bones(f)->rig, m)};
        k->solver.stretch_most = r ? r->solver.stretch_most : 0.0; /* as in a performance */
        result = make(k, err);
        face_reset(f);
        arrays_free(&k->arrays);
    }
    free(k);
    if (result < 0)
        face_weights_destroy(self);
    else
        *out = self;
    return result;
}

void face_weights_destroy(face_weights *self)
{
    if (!self)
        return;
    arrays_free(&self->arrays);
    free(self);
}

face_name_source face_weights_source(const face_weights *self, uint32_t channel)
{
    return channel < ARKIT_CHANNELS ? self->source[channel] : FACE_NAME_NONE;
}

/* ---- a frame ---- */

/* Sets self->y to the offsets of the points with the bones back at rest, followed by the degrees of
 * freedom. */
static bool read_frame(face_weights *self, const float *position, const float *dof)
{
    const bones *b = &self->bones;
    float asked[MRT_MAX_DOFS];
    double sum = 0.0;
    bones_unlimit(asked, b, dof);
    bones_pose(self->pose, b, asked);
    for (uint32_t p = 0; p < self->point_count; ++p) {
        const float *at = position + (size_t)3 * self->vertex[p];
        blend here = blend_of(self->share[p], self->pose, b->moves, b->bone_count);
        vec3 back = blend_undo(&here, (vec3){(double)at[0], (double)at[1], (double)at[2]});
        vec3 way = vec3_sub(back, self->rest[p]);
        vec3_set_row(self->y, p, way);
        sum += vec3_dot(way, way);
    }
    for (uint32_t i = 0; i < self->dof_row_count; ++i) {
        double value = self->dof_scale[i] * (double)asked[self->dof_row[i]];
        self->y[3 * self->point_count + i] = value;
        sum += value * value;
    }
    return isfinite(sum);
}

/* Sets the weights of an eye's in, out, up and down shapes from its bone. */
static void read_eye(face_weights *self, int side)
{
    const eye *e = &self->eye[side];
    double yaw, pitch, *angle_rad = self->channels.arkit + ARKIT_SHAPES + 3 + 3 * side;
    if (e->bone == RIG_NONE)
        return;
    look_of(&yaw, &pitch, self, e->bone, self->pose);
    angle_rad[0] = yaw;
    angle_rad[1] = pitch;
    double out = side == 0 ? yaw : -yaw;
    const double way[WAYS] = {-out, out, pitch, -pitch};
    for (int i = 0; i < WAYS; ++i) {
        double part = fmin(fmax(way[i] / e->whole_rad[i], 0.0), 1.0);
        self->channels.arkit[e->look[i]] = part;
        self->arkit.low[e->look[i]] = self->arkit.high[e->look[i]] = part;
    }
}

static void read_head(face_weights *self)
{
    double *angle_rad = self->channels.arkit + ARKIT_SHAPES;
    if (self->head == RIG_NONE)
        return;
    const rigid *head = &self->pose[self->head];
    vec3 to = rigid_rotate(head, (vec3){0, 0, 1}), left = rigid_rotate(head, (vec3){1, 0, 0});
    angle_rad[0] = atan2(to.x, to.z);
    angle_rad[1] = asin(fmin(fmax(to.y, -1.0), 1.0));
    angle_rad[2] = asin(fmin(fmax(-left.y, -1.0), 1.0));
}

static void solve_set(shape_set *s, const face_weights *self)
{
    for (uint32_t i = 0; i < s->count; ++i)
        s->b[i] = -s->few[i];
    for (size_t r = 0; r < self->row_count; ++r) {
        const double *row = s->column + r * s->count, y = self->y[r];
        for (uint32_t i = 0; i < s->count; ++i)
            s->b[i] += row[i] * y;
    }
    const shape_problem problem = {s->h, s->b, s->low, s->high, s->count};
    (void)shape_solve(s->weight, &problem, s->scratch);
}

/* Solves the 52. mouthClose closes the lips of an open jaw, so it is at most jawOpen. */
static void solve_arkit(face_weights *self)
{
    shape_set *s = &self->arkit;
    const uint32_t close = self->mouth_close;
    s->high[close] = s->is_there[close] ? 1.0 : 0.0;
    solve_set(s, self);
    if (s->weight[close] > s->weight[self->jaw_open]) {
        const shape_problem problem = {s->h, s->b, s->low, s->high, s->count};
        s->high[close] = s->weight[self->jaw_open];
        (void)shape_solve(s->weight, &problem, s->scratch);
        s->weight[close] = fmin(s->weight[close], s->weight[self->jaw_open]);
    }
    memcpy(self->channels.arkit, s->weight, ARKIT_SHAPES * sizeof *s->weight);
}

static double left_over_mm(const face_weights *self)
{
    const shape_set *s = &self->arkit;
    double sum = 0.0;
    for (size_t r = 0; r < (size_t)3 * self->point_count; ++r) {
        double left = self->y[r];
        for (uint32_t i = 0; i < s->count; ++i)
            left -= s->column[r * s->count + i] * s->weight[i];
        sum += left * left;
    }
    return self->point_count > 0 ? sqrt(sum / self->point_count) : 0.0;
}

/* Returns the mean of one direction of the gaze over both eyes. */
static double mean_look(const face_weights *self, int left, int right)
{
    const double *channels = self->channels.arkit;
    return 0.5 * (channels[self->eye[0].look[left]] + channels[self->eye[1].look[right]]);
}

static void set_eye_expressions(face_weights *self)
{
    double *out = self->channels.expression, felt = 0.0;
    out[BLINK_LEFT] = self->channels.arkit[self->eye[0].blink];
    out[BLINK_RIGHT] = self->channels.arkit[self->eye[1].blink];
    out[BLINK] = fmin(out[BLINK_LEFT], out[BLINK_RIGHT]);
    out[LOOK_UP] = mean_look(self, UP, UP);
    out[LOOK_DOWN] = mean_look(self, DOWN, DOWN);
    out[LOOK_LEFT] = mean_look(self, OUT, IN);
    out[LOOK_RIGHT] = mean_look(self, IN, OUT);
    for (int i = HAPPY; i <= SURPRISED; ++i)
        felt += out[i];
    out[NEUTRAL] = fmax(0.0, 1.0 - felt);
}

const face_channels *face_weights_solve(face_weights *self, const float *position, const float *dof)
{
    if (!read_frame(self, position, dof))
        return &self->channels;
    read_eye(self, 0);
    read_eye(self, 1);
    read_head(self);
    solve_arkit(self);
    self->channels.residual_mm = left_over_mm(self);
    solve_set(&self->expressions, self);
    memcpy(self->channels.expression, self->expressions.weight, (OH + 1) * sizeof(double));
    set_eye_expressions(self);
    solve_set(&self->visemes, self);
    double spoken = 0.0;
    memcpy(self->channels.viseme, self->visemes.weight, sizeof self->channels.viseme);
    for (int i = 1; i < FACE_VISEMES; ++i)
        spoken += self->channels.viseme[i];
    self->channels.viseme[0] = fmax(0.0, 1.0 - spoken);
    return &self->channels;
}

const uint32_t *face_weights_points(const face_weights *self, uint32_t *out_count)
{
    *out_count = self->point_count;
    return self->vertex;
}
