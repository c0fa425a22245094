#include "placement.h"

static const float hand_length_mm = 190.0f, reach_in_faces = 4.0f;
static const double rad_per_deg = 0.017453292519943295;

const char *const placement_hands_labels[] = {"Both", "Left", "Right", NULL};
const char *const placement_off_on_labels[] = {"Off", "On", NULL};
const char *const placement_posture_labels[] = {"In the head", "Before the face", NULL};

enum { HANDS_BOTH, HANDS_LEFT, HANDS_RIGHT };
enum { POSTURE_IN_HEAD, POSTURE_BEFORE_FACE };

/* Sine and cosine by their series after folding into a quarter turn: the same bits everywhere,
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

typedef struct turn {
    double r[3][3];
} turn;

static turn turn_about(int axis, double angle_deg)
{
    double s, c;
    sine_cosine(angle_deg, &s, &c);
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    turn out = {{{0}}};
    out.r[axis][axis] = 1.0;
    out.r[a][a] = c;
    out.r[a][b] = -s;
    out.r[b][a] = s;
    out.r[b][b] = c;
    return out;
}

static turn turn_compose(const turn *second, const turn *first)
{
    turn out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = second->r[i][0] * first->r[0][j] + second->r[i][1] * first->r[1][j] +
                          second->r[i][2] * first->r[2][j];
    return out;
}

/* Hand frame to face frame, without the place. The left hand is turned as in a mirror. */
static turn posture_turn(const double *params, uint32_t side)
{
    double mirror = side == MRT_LEFT ? -1.0 : 1.0;
    static const turn in_head = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    static const turn before_face = {{{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}};
    turn out = (int)params[PLACEMENT_POSTURE] == POSTURE_BEFORE_FACE ? before_face : in_head;
    turn roll = turn_about(2, mirror * params[PLACEMENT_ROLL]);
    turn pitch = turn_about(0, -params[PLACEMENT_PITCH]);
    turn yaw = turn_about(1, mirror * params[PLACEMENT_YAW]);
    out = turn_compose(&roll, &out);
    out = turn_compose(&pitch, &out);
    return turn_compose(&yaw, &out);
}

void placement_activate(placement *self, const mrt_face *face)
{
    self->low = face->low;
    self->size = (mrt_vec3){face->high.x - face->low.x, face->high.y - face->low.y,
                            face->high.z - face->low.z};
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
    for (int finger = 0; finger < 5; ++finger) {
        mrt_vec3 tip = hand->joint[4 + 4 * finger];
        sum = (mrt_vec3){sum.x + tip.x, sum.y + tip.y, sum.z + tip.z};
    }
    return (mrt_vec3){sum.x / 5.0f, sum.y / 5.0f, sum.z / 5.0f};
}

static mrt_vec3 place_of(const placement *self, const mrt_frame *frame, uint32_t side)
{
    const double *params = frame->params;
    double across = params[PLACEMENT_ACROSS];
    if (placement_pulls(frame, MRT_LEFT) && placement_pulls(frame, MRT_RIGHT))
        across += (side == MRT_LEFT ? 0.5 : -0.5) * params[PLACEMENT_APART];
    return (mrt_vec3){self->low.x + self->size.x * (float)(0.01 * across),
                      self->low.y + self->size.y * (float)(0.01 * params[PLACEMENT_UP]),
                      self->low.z + self->size.z * (float)(0.01 * params[PLACEMENT_DEPTH])};
}

static mrt_vec3 laid(const turn *t, float scale, mrt_vec3 home, mrt_vec3 place, mrt_vec3 p)
{
    double x = (double)(p.x - home.x), y = (double)(p.y - home.y), z = (double)(p.z - home.z);
    return (mrt_vec3){place.x + scale * (float)(t->r[0][0] * x + t->r[0][1] * y + t->r[0][2] * z),
                      place.y + scale * (float)(t->r[1][0] * x + t->r[1][1] * y + t->r[1][2] * z),
                      place.z + scale * (float)(t->r[2][0] * x + t->r[2][1] * y + t->r[2][2] * z)};
}

uint32_t placement_points(placement *self, const mrt_frame *frame,
                          mrt_vec3 out_point[PLACEMENT_POINTS_MAX])
{
    const double *params = frame->params;
    float scale =
        placement_face_height(self) * (float)(0.01 * params[PLACEMENT_SIZE]) / hand_length_mm;
    uint32_t count = 0;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        const mrt_hand *hand = &frame->hand[side];
        if (!placement_pulls(frame, side))
            continue;
        if (!self->is_laid[side]) {
            self->home[side] = centre_of_tips(hand);
            self->is_laid[side] = true;
        }
        turn t = posture_turn(params, side);
        mrt_vec3 home = self->home[side], place = place_of(self, frame, side);
        for (int finger = 0; finger < 5; ++finger)
            out_point[count++] = laid(&t, scale, home, place, hand->joint[4 + 4 * finger]);
        for (int i = 0; i < MRT_PALM && params[PLACEMENT_PALM] > 0.5; ++i)
            out_point[count++] = laid(&t, scale, home, place, hand->palm[i]);
    }
    return count;
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
