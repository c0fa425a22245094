#include "draw/lighting.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const lighting_look lighting_looks[LIGHTING_LOOKS] = {
    {"Studio",
     "A soft key light from the left and a cool rim light. All parts of the face are visible. "
     "The default look.",
     {.lamp = {{{-0.5571f, 0.5970f, 0.5772f}, {3.10f, 2.92f, 2.66f}, 1.0f},
               {{0.8165f, 0.0272f, 0.5767f}, {0.22f, 0.26f, 0.34f}, 1.0f},
               {{0.5388f, 0.5089f, -0.6713f}, {0.80f, 0.90f, 1.05f}, 1.0f}},
      .room = 1.0f,
      .wall_edge = {0.078f, 0.082f, 0.092f},
      .wall_light = {0.200f, 0.208f, 0.224f}}},
    {"Theatre",
     "A warm spot from high up, a strong blue rim and little else. Suits felt and strong "
     "features.",
     {.lamp = {{{-0.3015f, 0.7035f, 0.6436f}, {4.30f, 3.45f, 2.40f}, 1.0f},
               {{0.8165f, 0.0272f, 0.5767f}, {0.16f, 0.12f, 0.22f}, 1.0f},
               {{0.6324f, 0.3953f, -0.6662f}, {1.30f, 1.90f, 3.30f}, 1.0f}},
      .room = 0.5f,
      .wall_edge = {0.045f, 0.030f, 0.040f},
      .wall_light = {0.235f, 0.110f, 0.105f}}},
    {"Daylight",
     "A wide soft light and a bright wall, with almost no shadow. Suits children's films and "
     "cut-outs.",
     {.lamp = {{{0.4360f, 0.5970f, 0.6735f}, {2.05f, 2.02f, 1.92f}, 1.0f},
               {{-0.8165f, 0.1500f, 0.5575f}, {0.62f, 0.68f, 0.76f}, 1.0f},
               {{-0.5388f, 0.5089f, -0.6713f}, {0.60f, 0.60f, 0.56f}, 1.0f}},
      .room = 1.75f,
      .wall_edge = {0.520f, 0.610f, 0.680f},
      .wall_light = {0.790f, 0.850f, 0.880f}}},
};

/* ---- lamps ---- */

void lighting_move(lighting_lamp *lamp, float right, float up)
{
    const float most = 0.985f, far = sqrtf(right * right + up * up);
    const float share = far > most ? most / far : 1.0f;
    if (!isfinite(far))
        return;
    const float x = share * right, y = share * up;
    const float z = sqrtf(fmaxf(1.0f - x * x - y * y, 0.0f));
    lamp->direction[0] = x;
    lamp->direction[1] = y;
    lamp->direction[2] = lamp->direction[2] < 0.0f ? -z : z;
}

void lighting_turn_behind(lighting_lamp *lamp)
{
    lamp->direction[2] = -lamp->direction[2];
}

/* ---- as text: "1" and the numbers in the order of the struct ---- */

enum { NUMBERS = 7 * LIGHTING_LAMPS + 1 + 6 };

static void list(const lighting *of, float out[NUMBERS])
{
    float *at = out;
    for (int i = 0; i < LIGHTING_LAMPS; ++i) {
        memcpy(at, of->lamp[i].direction, sizeof of->lamp[i].direction);
        memcpy(at + 3, of->lamp[i].rgb, sizeof of->lamp[i].rgb);
        at[6] = of->lamp[i].power;
        at += 7;
    }
    *at++ = of->room;
    memcpy(at, of->wall_edge, sizeof of->wall_edge);
    memcpy(at + 3, of->wall_light, sizeof of->wall_light);
}

void lighting_write(const lighting *of, char out[LIGHTING_TEXT])
{
    float number[NUMBERS];
    size_t length = 1;
    list(of, number);
    (void)snprintf(out, LIGHTING_TEXT, "1");
    for (int i = 0; i < NUMBERS; ++i)
        length +=
            (size_t)snprintf(out + length, LIGHTING_TEXT - length, " %.9g", (double)number[i]);
}

static bool read_lamp(lighting_lamp *out, const float *number)
{
    const float far = sqrtf(number[0] * number[0] + number[1] * number[1] + number[2] * number[2]);
    if (!(far > 0.5f && far < 2.0f))
        return false;
    const float unit =
        fabsf(far - 1.0f) < 1e-3f ? 1.0f : far; /* same numbers after write and read */
    for (int i = 0; i < 3; ++i) {
        out->direction[i] = number[i] / unit;
        out->rgb[i] = number[3 + i];
        if (!(out->rgb[i] >= 0.0f && out->rgb[i] <= 20.0f))
            return false;
    }
    out->power = number[6];
    return out->power >= 0.0f && out->power <= 4.0f;
}

bool lighting_parse(lighting *out, const char *text)
{
    text_view rest = text_view_of(text, strlen(text)), word;
    float number[NUMBERS];
    lighting made;
    if (!text_next_word(&rest, &word) || word.end - word.at != 1 || word.at[0] != '1')
        return false;
    for (int i = 0; i < NUMBERS; ++i) {
        double value;
        if (!text_next_word(&rest, &word) || !text_double(word, &value) || !(fabs(value) <= 20.0))
            return false;
        number[i] = (float)value;
    }
    if (text_next_word(&rest, &word))
        return false;
    const float *at = number;
    for (int i = 0; i < LIGHTING_LAMPS; ++i, at += 7)
        if (!read_lamp(&made.lamp[i], at))
            return false;
    made.room = *at++;
    for (int i = 0; i < 6; ++i)
        if (!(at[i] >= 0.0f && at[i] <= 1.0f))
            return false;
    memcpy(made.wall_edge, at, sizeof made.wall_edge);
    memcpy(made.wall_light, at + 3, sizeof made.wall_light);
    if (!(made.room >= 0.0f && made.room <= 4.0f))
        return false;
    *out = made;
    return true;
}
