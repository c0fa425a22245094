#include "placement.h"
#include "mapping.h"

/* Points nearer to each other than this share of the radius form a group. */
static const float least_apart = 0.15f;
static const float hand_length_mm = 190.0f, reach_in_faces = 4.0f;
static const double rad_per_deg = 0.017453292519943295;

const char *const placement_hands_labels[] = {"Both", "Left", "Right", NULL};
const char *const placement_off_on_labels[] = {"Off", "On", NULL};
const char *const placement_posture_labels[] = {"In the head", "Before the face", NULL};

/* Default placement of two hands side by side, relative to the placement of one hand. The hands are
 * turned, thumbs down and fingers up, and moved a little down and further back, because a face
 * recedes beside its middle. In shares of the face's width. A hand of this length leaves a fifth of
 * the width between the index fingers, which are next to each other, and its little finger is
 * beside the cheek. */
static const double pair_roll_deg = 25.0, pair_pitch_deg = 45.0, pair_up = -4.0, pair_depth = -15.0;
static const double pair_apart = 0.62, pair_length = 1.4;

enum { HANDS_BOTH, HANDS_LEFT, HANDS_RIGHT };
enum { POSTURE_IN_HEAD, POSTURE_BEFORE_FACE };

/* Sine and cosine from their series after folding into a quarter turn: the same bits everywhere,
 * error below 1e-12. */
static void sine_cosine(double angle_deg, double *out_sine, double *out_cosine)
{
    int quarter = 0;
    while (angle_deg > 45.0)
        angle_deg -= 90.0, quarter += 1;
    while (angle_deg < -45.0)
        angle_deg += 90.0, quarter += 3;
    double x = angle_deg * rad_per_deg, sine = 0.0, cosine = 0.0, term = 1.0;
    for (int n = 0; n < 16; n += 2) {
        cosine += term;
        term *= x / (n + 1);
        sine += term;
        term *= -x / (n + 2);
    }
    for (quarter %= 4; quarter > 0; --quarter) {
        double turned = cosine;
        cosine = -sine;
        sine = turned;
    }
    *out_sine = sine;
    *out_cosine = cosine;
}

typedef struct rotation {
    double r[3][3];
} rotation;

static rotation rotation_about(int axis, double angle_deg)
{
    double s, c;
    sine_cosine(angle_deg, &s, &c);
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    rotation out = {{{0}}};
    out.r[axis][axis] = 1.0;
    out.r[a][a] = c;
    out.r[a][b] = -s;
    out.r[b][a] = s;
    out.r[b][b] = c;
    return out;
}

static rotation rotation_compose(const rotation *second, const rotation *first)
{
    rotation out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = second->r[i][0] * first->r[0][j] + second->r[i][1] * first->r[1][j] +
                          second->r[i][2] * first->r[2][j];
    return out;
}

/* Returns true if both hands pull and their distance is derived from the face. */
static bool is_pair(const mrt_frame *frame)
{
    return frame->params[PLACEMENT_APART] <= 0.0 && placement_pulls(frame, MRT_LEFT) &&
           placement_pulls(frame, MRT_RIGHT);
}

/* Rotation from the hand frame to the face frame. The left hand is mirrored. */
static rotation posture_turn(const mrt_frame *frame, uint32_t side)
{
    const double *params = frame->params;
    double mirror = side == MRT_LEFT ? -1.0 : 1.0;
    static const rotation in_head = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    static const rotation before_face = {{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
    bool is_before_face = (int)params[PLACEMENT_POSTURE] == POSTURE_BEFORE_FACE;
    bool is_turned = !is_before_face && is_pair(frame);
    double roll_deg = params[PLACEMENT_ROLL] + (is_turned ? pair_roll_deg : 0.0);
    double pitch_deg = params[PLACEMENT_PITCH] + (is_turned ? pair_pitch_deg : 0.0);
    rotation out = is_before_face ? before_face : in_head;
    rotation roll = rotation_about(2, mirror * roll_deg);
    rotation pitch = rotation_about(0, -pitch_deg);
    rotation yaw = rotation_about(1, mirror * params[PLACEMENT_YAW]);
    out = rotation_compose(&roll, &out);
    out = rotation_compose(&pitch, &out);
    return rotation_compose(&yaw, &out);
}

void placement_activate(placement *self, const mrt_face *face)
{
    self->low = face->low;
    self->size = vec_difference(face->high, face->low);
    placement_reset(self);
}

void placement_reset(placement *self)
{
    self->is_laid[0] = self->is_laid[1] = false;
}

float placement_face_height(const placement *self)
{
    return self->size.y > 1.0f ? self->size.y : 1.0f;
}

bool placement_pulls(const mrt_frame *frame, uint32_t side)
{
    int hands = (int)frame->params[PLACEMENT_HANDS];
    bool wanted = hands == HANDS_BOTH || (hands == HANDS_LEFT) == (side == MRT_LEFT);
    return wanted && frame->hand[side].present;
}

static mrt_vec3 centre_of_tips(const mrt_hand *hand)
{
    mrt_vec3 sum = {0, 0, 0};
    for (int finger = 0; finger < 5; ++finger)
        sum = vec_sum(sum, 1.0f, hand->joint[4 + 4 * finger]);
    return (mrt_vec3){sum.x / 5.0f, sum.y / 5.0f, sum.z / 5.0f};
}

static mrt_vec3 hand_position(const placement *self, const mrt_frame *frame, uint32_t side)
{
    const double *params = frame->params;
    double across = params[PLACEMENT_ACROSS], up = params[PLACEMENT_UP];
    double depth = params[PLACEMENT_DEPTH], half = side == MRT_LEFT ? 0.5 : -0.5;
    if (is_pair(frame)) {
        across += half * 100.0 * pair_apart;
        up += pair_up;
        depth += pair_depth;
    } else if (placement_pulls(frame, MRT_LEFT) && placement_pulls(frame, MRT_RIGHT)) {
        across += half * params[PLACEMENT_APART];
    }
    return (mrt_vec3){self->low.x + self->size.x * (float)(0.01 * across),
                      self->low.y + self->size.y * (float)(0.01 * up),
                      self->low.z + self->size.z * (float)(0.01 * depth)};
}

/* Scale from mm of the hand to mm of the face. */
static float scale_of(const placement *self, const mrt_frame *frame)
{
    float length_mm = placement_face_height(self) * (float)(0.01 * frame->params[PLACEMENT_SIZE]);
    float most_mm = self->size.x * (float)pair_length;
    if (is_pair(frame) && length_mm > most_mm)
        length_mm = most_mm;
    return length_mm / hand_length_mm;
}

static mrt_vec3 laid(const rotation *t, float scale, mrt_vec3 home, mrt_vec3 position, mrt_vec3 p)
{
    double x = (double)(p.x - home.x), y = (double)(p.y - home.y), z = (double)(p.z - home.z);
    return (mrt_vec3){
        position.x + scale * (float)(t->r[0][0] * x + t->r[0][1] * y + t->r[0][2] * z),
        position.y + scale * (float)(t->r[1][0] * x + t->r[1][1] * y + t->r[1][2] * z),
        position.z + scale * (float)(t->r[2][0] * x + t->r[2][1] * y + t->r[2][2] * z)};
}

uint32_t placement_points(placement *self, const mrt_frame *frame,
                          mrt_vec3 out_point[PLACEMENT_POINTS_MAX])
{
    const double *params = frame->params;
    float scale = scale_of(self, frame);
    uint32_t count = 0;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        const mrt_hand *hand = &frame->hand[side];
        if (!placement_pulls(frame, side))
            continue;
        if (!self->is_laid[side]) {
            self->home[side] = centre_of_tips(hand);
            self->is_laid[side] = true;
        }
        rotation t = posture_turn(frame, side);
        mrt_vec3 home = self->home[side], position = hand_position(self, frame, side);
        for (int finger = 0; finger < 5; ++finger)
            out_point[count++] = laid(&t, scale, home, position, hand->joint[4 + 4 * finger]);
        for (int i = 0; i < MRT_PALM && params[PLACEMENT_PALM] > 0.5; ++i)
            out_point[count++] = laid(&t, scale, home, position, hand->palm[i]);
    }
    return count;
}

static bool are_near(mrt_vec3 a, mrt_vec3 b, float least_mm)
{
    float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return x * x + y * y + z * z < least_mm * least_mm;
}

void placement_share(placement *self, const mrt_host *host, const mrt_vec3 *point, uint32_t count,
                     float radius_mm, uint32_t out_leader[PLACEMENT_POINTS_MAX])
{
    float least_mm = least_apart * radius_mm;
    uint32_t shared_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        out_leader[i] = i;
        for (uint32_t k = 0; k < i; ++k) {
            if (!are_near(point[k], point[i], least_mm) || out_leader[k] == out_leader[i])
                continue;
            uint32_t first = out_leader[k] < out_leader[i] ? out_leader[k] : out_leader[i];
            uint32_t other = out_leader[k] < out_leader[i] ? out_leader[i] : out_leader[k];
            for (uint32_t j = 0; j <= i; ++j)
                if (out_leader[j] == other)
                    out_leader[j] = first;
            ++shared_count;
        }
    }
    if (shared_count > 0 && !self->has_told)
        host->log(host, MRT_LOG_WARNING,
                  "some fingertips share one point of the face, which follows their mean: move the "
                  "hands further apart, or reduce the radius");
    self->has_told |= shared_count > 0;
}

void placement_blend(mrt_vec3 *point, uint32_t count, const uint32_t *leader)
{
    mrt_vec3 sum[PLACEMENT_POINTS_MAX] = {{0, 0, 0}};
    float share_count[PLACEMENT_POINTS_MAX] = {0};
    for (uint32_t i = 0; i < count; ++i) {
        mrt_vec3 *s = &sum[leader[i]];
        *s = vec_sum(*s, 1.0f, point[i]);
        share_count[leader[i]] += 1.0f;
    }
    for (uint32_t i = 0; i < count; ++i) {
        mrt_vec3 s = sum[leader[i]];
        float n = share_count[leader[i]];
        if (n > 1.0f)
            point[i] = (mrt_vec3){s.x / n, s.y / n, s.z / n};
    }
}

static float larger(float a, float b)
{
    return a > b ? a : b;
}

static float clamped(float value, float low, float size, float reach_mm)
{
    float least = low - reach_mm, most = low + size + reach_mm;
    return value < least ? least : value > most ? most : value;
}

mrt_vec3 placement_within_reach(const placement *self, mrt_vec3 p)
{
    mrt_vec3 low = self->low, size = self->size;
    float reach_mm = reach_in_faces * larger(larger(size.x, size.y), larger(size.z, 1.0f));
    return (mrt_vec3){clamped(p.x, low.x, size.x, reach_mm), clamped(p.y, low.y, size.y, reach_mm),
                      clamped(p.z, low.z, size.z, reach_mm)};
}

/* ---- solver settings ---- */

static const float least_stretch = 1.1f;

const char *const solver_preset_labels[] = {"Own", "Paper", NULL};

bool solver_is_paper(const double *solver)
{
    return solver[SOLVER_PRESET] > 0.5;
}

void solver_set(mrt_pull *pull, const double *solver, float share_mm)
{
    float radius_mm = (float)solver[SOLVER_RADIUS_MM], stretch = (float)solver[SOLVER_STRETCH];
    bool is_paper = solver_is_paper(solver);
    pull->radius_mm = radius_mm > 0.0f ? radius_mm : share_mm;
    pull->solve = is_paper ? MRT_SOLVE_LINEAR | MRT_SOLVE_ONCE : 0;
    pull->stretch_most = stretch > least_stretch ? stretch : least_stretch;
    if (is_paper || !(stretch > 0.0f))
        pull->stretch_most = -1.0f;
}
