#include "window/gui/hand_figure.h"
#include "window/gui/theme.h"

#include <math.h>
#include <stdlib.h>

enum { FINGERS = 5, JOINTS_A_FINGER = 4, BONES = FINGERS * JOINTS_A_FINGER };

#define TURN_S    5.0 /* to and fro */
#define TURN_RAD  1.0
#define TILT_RAD  0.30  /* towards the eye, that bent fingers are seen */
#define REACH_MM  130.0 /* from the middle of the hand to what may be farthest from it */
#define MIDDLE_MM 88.0  /* of a flat hand, from the wrist */
/* A hand that stands still: turned a little, so that bent fingers are seen; room for spread ones.
 */
#define STILL_YAW_RAD 0.25
#define STILL_WIDE_MM 165.0f
#define STILL_HIGH_MM 210.0f

/* Of a hand that is seen: from the wrist to the middle knuckle, and from there to the farthest
 * fingertip. */
#define PALM_MM   95.0f
#define AROUND_MM 125.0f
enum { WRIST = 0, MIDDLE_KNUCKLE = 9 };

typedef struct bone {
    float from[2], to[2]; /* points on the screen */
    float near;           /* 0 far .. 1 near */
    float width;
} bone;

typedef struct projected {
    float x, y, depth; /* mm; depth grows towards the eye */
} projected;

/* Fingers up, the back of the hand towards the eye. */
static projected turned(mrt_vec3 at, double yaw_rad)
{
    const double x = -(double)at.x, y = (double)at.z - MIDDLE_MM, z = (double)at.y;
    const double across = cos(yaw_rad) * x + sin(yaw_rad) * z;
    const double deep = cos(yaw_rad) * z - sin(yaw_rad) * x;
    return (projected){(float)across, (float)(cos(TILT_RAD) * y - sin(TILT_RAD) * deep),
                       (float)(sin(TILT_RAD) * y + cos(TILT_RAD) * deep)};
}

static int by_depth(const void *a, const void *b)
{
    const float x = ((const bone *)a)->near, y = ((const bone *)b)->near;
    return x < y ? -1 : x > y;
}

/* Nearer parts are brighter. */
static uint32_t shaded(uint32_t colour, float near)
{
    return (colour & 0xffffff00u) | (uint32_t)(90.0f + 165.0f * near);
}

static void draw_bone(ui *on, const bone *b, uint32_t ground, uint32_t colour)
{
    for (int rim = 1; rim >= 0; --rim) { /* a rim of the ground parts what crosses */
        const float width = b->width + (rim ? 3.0f : 0.0f);
        const uint32_t ink = rim ? ground : shaded(colour, b->near);
        if (rim || b->near > 0.98f)
            ui_draw_disc(on, b->to[0], b->to[1], 0.5f * width, ink);
        ui_draw_line(on, b->from[0], b->from[1], b->to[0], b->to[1], ink, width);
    }
    ui_draw_disc(on, b->to[0], b->to[1], 0.5f * b->width + 0.5f, colour);
}

typedef struct figure { /* where a hand is drawn */
    float x, y;         /* of the middle of a flat hand, points */
    float scale;
    double yaw_rad;
} figure;

static void find_joints(const figure *of, const hand_skeleton *skeleton, const float *angle_rad,
                        projected out[MRT_JOINTS])
{
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    const rigid still = rigid_identity();
    hand_pose(skeleton, angle_rad, &still, joint, palm);
    for (int i = 0; i < MRT_JOINTS; ++i)
        out[i] = turned(joint[i], of->yaw_rad);
}

static void draw_figure(ui *on, const figure *of, const projected at[MRT_JOINTS], uint32_t colour)
{
    bone all[BONES];
    const float scale = of->scale, x = of->x, y = of->y;
    for (int i = 0; i < BONES; ++i) {
        const int to = i + 1, from = i % JOINTS_A_FINGER ? to - 1 : 0;
        all[i] = (bone){
            .from = {x + scale * at[from].x, y - scale * at[from].y},
            .to = {x + scale * at[to].x, y - scale * at[to].y},
            .near = fminf(fmaxf(0.5f + 0.5f * (at[from].depth + at[to].depth) / 90.0f, 0.0f), 1.0f),
            .width = scale * (i < JOINTS_A_FINGER ? 19.0f : 16.0f)};
    }
    qsort(all, BONES, sizeof all[0], by_depth);
    for (int i = 0; i < FINGERS; ++i) { /* the palm: wrist, thumb's base, knuckles */
        const int first = i == 0 ? 1 : 1 + JOINTS_A_FINGER * i;
        const int next = i + 1 < FINGERS ? 1 + JOINTS_A_FINGER * (i + 1) : first;
        const float corner[6] = {x + scale * at[0].x,     y - scale * at[0].y,
                                 x + scale * at[first].x, y - scale * at[first].y,
                                 x + scale * at[next].x,  y - scale * at[next].y};
        ui_draw_triangle(on, corner, shaded(colour, 0.1f));
    }
    for (int i = 0; i < BONES; ++i)
        draw_bone(on, &all[i], THEME_PANEL, colour);
}

void hand_figure_draw(ui *on, ui_rectangle where, const hand_skeleton *of, const float *angle_rad,
                      double at_s, uint32_t colour)
{
    projected at[MRT_JOINTS];
    const figure turning = {
        .x = where.x + 0.5f * where.width,
        .y = where.y + 0.5f * where.height,
        .scale = 0.5f * fminf(where.width, where.height) / (float)REACH_MM,
        .yaw_rad = TURN_RAD * sin(2.0 * 3.14159265358979 * at_s / TURN_S),
    };
    find_joints(&turning, of, angle_rad, at);
    draw_figure(on, &turning, at, colour);
}

static figure still_figure(ui_rectangle where)
{
    return (figure){.x = where.x + 0.5f * where.width,
                    .y = where.y + 0.5f * where.height,
                    .scale = fminf(where.width / STILL_WIDE_MM, where.height / STILL_HIGH_MM),
                    .yaw_rad = STILL_YAW_RAD};
}

void hand_figure_draw_still(ui *on, ui_rectangle where, const hand_skeleton *of,
                            const float *angle_rad, uint32_t colour)
{
    projected at[MRT_JOINTS];
    const figure still = still_figure(where);
    find_joints(&still, of, angle_rad, at);
    draw_figure(on, &still, at, colour);
}

void hand_figure_joints(ui_rectangle where, const hand_skeleton *of, const float *angle_rad,
                        float out_xy[MRT_JOINTS][2])
{
    projected at[MRT_JOINTS];
    const figure still = still_figure(where);
    find_joints(&still, of, angle_rad, at);
    for (int i = 0; i < MRT_JOINTS; ++i) {
        out_xy[i][0] = still.x + still.scale * at[i].x;
        out_xy[i][1] = still.y - still.scale * at[i].y;
    }
}

void hand_figure_draw_seen(ui *on, ui_rectangle where, const mrt_vec3 at[MRT_JOINTS],
                           uint32_t colour)
{
    const mrt_vec3 wrist = at[WRIST], middle = at[MIDDLE_KNUCKLE];
    const float palm = sqrtf((wrist.x - middle.x) * (wrist.x - middle.x) +
                             (wrist.y - middle.y) * (wrist.y - middle.y) +
                             (wrist.z - middle.z) * (wrist.z - middle.z));
    projected seen[MRT_JOINTS];
    if (!(palm > 0.0f))
        return;
    const float mm = PALM_MM / palm;
    for (int i = 0; i < MRT_JOINTS; ++i)
        seen[i] = (projected){mm * (middle.x - at[i].x), mm * (at[i].y - middle.y),
                              mm * (at[i].z - middle.z)};
    const figure as_seen = {.x = where.x + 0.5f * where.width,
                            .y = where.y + 0.5f * where.height,
                            .scale = 0.5f * fminf(where.width, where.height) / AROUND_MM};
    draw_figure(on, &as_seen, seen, colour);
}
