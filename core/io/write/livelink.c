#include "io/arkit.h"

#include "io/write/export_stream.h"

#include <locale.h>
#include <math.h>
#include <string.h>

/* ---- what says what ---- */

/* A degree of freedom by its name, and the channels that its sides are. */
static const struct {
    const char *dof, *plus, *minus;
} sides[] = {{"jaw.open", "JawOpen", NULL},
             {"jaw.lateral", "JawLeft", "JawRight"},
             {"jaw.forward", "JawForward", NULL},
             {"lid_upper.l.close", "EyeBlinkLeft", "EyeWideLeft"},
             {"lid_upper.r.close", "EyeBlinkRight", "EyeWideRight"}};

/* A turn by the ends of its name; which way it goes is seen from what it moves. */
static const struct {
    const char *bone, *turn, *channel, *plus, *minus;
    int axis;    /* x to the left, y up */
    int tallest; /* of the place that tells: 1 the highest, 2 the one furthest in front */
} turns[] = {{"skull", "turn", "HeadYaw", NULL, NULL, 0, 2},
             {"skull", "yaw", "HeadYaw", NULL, NULL, 0, 2},
             {"skull", "nod", "HeadPitch", NULL, NULL, 1, 2},
             {"skull", "pitch", "HeadPitch", NULL, NULL, 1, 2},
             {"skull", "tilt", "HeadRoll", NULL, NULL, 0, 1},
             {"skull", "roll", "HeadRoll", NULL, NULL, 0, 1},
             {"eye.l", "yaw", "LeftEyeYaw", "EyeLookOutLeft", "EyeLookInLeft", 0, 2},
             {"eye.l", "pitch", "LeftEyePitch", "EyeLookUpLeft", "EyeLookDownLeft", 1, 2},
             {"eye.r", "yaw", "RightEyeYaw", "EyeLookInRight", "EyeLookOutRight", 0, 2},
             {"eye.r", "pitch", "RightEyePitch", "EyeLookUpRight", "EyeLookDownRight", 1, 2}};

static void say(arkit_map *out, const char *channel, uint32_t curve, double sign)
{
    uint32_t index = channel ? arkit_find(channel) : ARKIT_NONE;
    if (index == ARKIT_NONE || out->of[index].curve != UINT32_MAX)
        return;
    out->of[index].curve = curve;
    out->of[index].sign = sign;
    out->shape_count += index < ARKIT_SHAPES;
    out->turn_count += index >= ARKIT_SHAPES;
}

/* Which way the place that tells goes along an axis when the curve is at its most: 1 or -1; 0:
 * nowhere. */
static double way_of_turn(const clip *c, const clip_curve *curve, int axis, int tallest)
{
    const mesh *m = clip_mesh(c);
    const float *moves = curve->at_max ? curve->at_max : curve->at_min;
    double front = -INFINITY, way = 0.0;
    for (size_t v = 0; moves && v < m->vertex_count; ++v) {
        const float *to = moves + v * 3, *at = m->position + v * 3;
        bool is_moved = fabsf(to[0]) + fabsf(to[1]) + fabsf(to[2]) > 1e-3f;
        if (is_moved && (double)at[tallest] > front) {
            front = (double)at[tallest];
            way = (double)to[axis];
        }
    }
    if (moves == curve->at_min)
        way = -way;
    return way > 0.0 ? 1.0 : way < 0.0 ? -1.0 : 0.0;
}

static void say_turn(arkit_map *out, const clip *c, uint32_t curve, size_t turn)
{
    double way = way_of_turn(c, clip_curve_at(c, curve), turns[turn].axis, turns[turn].tallest);
    if (way == 0.0)
        return;
    say(out, turns[turn].channel, curve, way);
    say(out, turns[turn].plus, curve, way);
    say(out, turns[turn].minus, curve, -way);
}

static void say_dof(arkit_map *out, const clip *c, uint32_t curve)
{
    const char *name = clip_curve_at(c, curve)->name;
    for (size_t i = 0; i < sizeof sides / sizeof *sides; ++i) {
        if (strcmp(name, sides[i].dof) != 0)
            continue;
        say(out, sides[i].plus, curve, 1.0);
        say(out, sides[i].minus, curve, -1.0);
    }
    for (size_t i = 0; i < sizeof turns / sizeof *turns; ++i) {
        size_t bone = strlen(turns[i].bone);
        if (strncmp(name, turns[i].bone, bone) == 0 && name[bone] == '.' &&
            strcmp(name + bone + 1, turns[i].turn) == 0)
            say_turn(out, c, curve, i);
    }
}

void arkit_map_find(arkit_map *out, const clip *c)
{
    *out = (arkit_map){.shape_count = 0};
    for (uint32_t i = 0; i < ARKIT_CHANNELS; ++i)
        out->of[i].curve = UINT32_MAX;
    for (uint32_t i = 0; i < clip_curve_count(c); ++i) {
        uint32_t index = arkit_find(clip_curve_at(c, i)->name);
        if (index < ARKIT_SHAPES && clip_curve_at(c, i)->max > 0.0)
            say(out, arkit_name[index], i, 1.0);
    }
    for (uint32_t i = 0; i < clip_curve_count(c); ++i)
        say_dof(out, c, i);
}

void arkit_values(double out[ARKIT_CHANNELS], const arkit_map *map, const clip *c, uint32_t frame)
{
    const double *value = clip_values(c, frame);
    for (uint32_t i = 0; i < ARKIT_CHANNELS; ++i) {
        uint32_t curve = map->of[i].curve;
        out[i] = 0.0;
        if (!value || curve == UINT32_MAX || isnan(value[curve]))
            continue;
        out[i] =
            i < ARKIT_SHAPES
                ? fmax(map->of[i].sign * clip_curve_part(clip_curve_at(c, curve), value[curve]),
                       0.0)
                : map->of[i].sign * value[curve];
    }
}

/* ---- the table ---- */

static void put_frame(FILE *stream, const clip *c, uint32_t frame, const arkit_map *map,
                      const char *timecode)
{
    double value[ARKIT_CHANNELS];
    arkit_values(value, map, c, frame);
    (void)fprintf(stream, "%s.000,%d", timecode, ARKIT_CHANNELS);
    for (int i = 0; i < ARKIT_CHANNELS; ++i)
        (void)fprintf(stream, ",%.9g", value[i] + 0.0); /* no -0 */
    (void)fputc('\n', stream);
}

static void put_all(FILE *stream, const clip *c, const export_progress *progress)
{
    arkit_map map;
    timecode_rate rate;
    int64_t first;
    char timecode[TIMECODE_TEXT] = "00:00:00:00";
    export_timecode(&rate, &first, c);
    arkit_map_find(&map, c);
    (void)fputs("Timecode,BlendShapeCount", stream);
    for (int i = 0; i < ARKIT_CHANNELS; ++i)
        (void)fprintf(stream, ",%s", arkit_name[i]);
    (void)fputc('\n', stream);
    for (uint32_t frame = 0; frame < clip_frame_count(c) && !ferror(stream); ++frame) {
        if (rate.num > 0)
            timecode_write(timecode, rate, first + frame);
        for (char *at = timecode; *at; ++at)
            *at = *at == ';' ? ':' : *at;
        put_frame(stream, c, frame, &map, timecode);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
}

mrt_result livelink_write(const char *path, const clip *c, const export_progress *progress,
                          error *err)
{
    locale_t plain = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
    if (!plain)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result == MRT_OK) {
        locale_t kept = uselocale(plain);
        put_all(writer.stream, c, progress); /* what failed is found by commit */
        (void)uselocale(kept);
        result = file_writer_commit(&writer, err);
    }
    freelocale(plain);
    return result;
}
