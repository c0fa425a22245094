#include "card.h"

/* Places on the hand: joints of plugin.h. */
enum {
    AT_WRIST = 0,
    AT_THUMB_BASE = 1,
    AT_THUMB_MIDDLE = 2,
    AT_THUMB_TIP = 4,
    AT_INDEX_KNUCKLE = 5,
    AT_INDEX_MIDDLE = 6,
    AT_INDEX_TIP = 8,
    AT_MIDDLE_KNUCKLE = 9,
    AT_MIDDLE_TIP = 12,
    AT_RING_KNUCKLE = 13,
    AT_RING_TIP = 16,
    AT_LITTLE_KNUCKLE = 17,
    AT_LITTLE_TIP = 20
};

/* A movement of about 25 degrees counts as full. */
#define WAY 2.3f

static const mrt_card_line joints[] = {
    {"Thumb down", "jaw opens", AT_THUMB_TIP, {[3] = WAY}},
    {"Thumb pressed up", "lips close, then press (m, b, p)", AT_THUMB_MIDDLE, {[1] = 3.0f}},
    {"Thumb tip hooked", "lower lip under the teeth (f, v)", AT_THUMB_TIP, {[2] = 2.0f}},
    {"Thumb rolled across the palm, back",
     "eyes look aside; middle finger bent: wink, index lifted: one brow",
     AT_THUMB_BASE,
     {[0] = 3.5f}},
    {"Fingers spread", "lips wide (s, ee)", AT_MIDDLE_TIP, {[10] = 1.6f, [14] = 1.6f, [18] = 1.6f}},
    {"Index and middle finger curled",
     "lips round (o, oo)",
     AT_INDEX_TIP,
     {[5] = 0.7f, [8] = 0.7f}},
    {"Ring finger lifted, bent", "its corner smiles, frowns", AT_RING_TIP, {[11] = -WAY}},
    {"Little finger lifted, bent", "its corner smiles, frowns", AT_LITTLE_TIP, {[15] = -WAY}},
    {"Little finger curled", "tongue (th)", AT_LITTLE_KNUCKLE, {[16] = 1.4f}},
    {"Index knuckle lifted, bent", "brows up, down", AT_INDEX_KNUCKLE, {[4] = -WAY}},
    {"Middle knuckle bent, lifted", "eyes close, widen", AT_MIDDLE_KNUCKLE, {[7] = WAY}},
    {"Wrist", "head nods and turns", AT_WRIST, {[20] = WAY, [21] = WAY}},
    /* last, because points hardly show it */
    {"Palm arched", "inner brows up", AT_RING_KNUCKLE, {[19] = 5.0f}},
};

static const mrt_card_line curls[] = {
    {"Thumb down", "jaw opens", AT_THUMB_TIP, {[1] = -1.6f}},
    {"Thumb pressed up", "lips close, then press (m, b, p)", AT_THUMB_MIDDLE, {[1] = 3.0f}},
    {"Index finger lifted, bent", "brows up, down", AT_INDEX_TIP, {[4] = -WAY}},
    {"Middle finger bent, lifted", "eyes close, widen", AT_MIDDLE_TIP, {[7] = WAY}},
    {"Ring finger bent, lifted", "lips round, wide", AT_RING_TIP, {[11] = 1.6f}},
    {"Little finger lifted, bent", "smile; frown and tongue", AT_LITTLE_TIP, {[15] = -WAY}},
    {"Wrist", "head nods and turns", AT_WRIST, {[20] = WAY, [21] = WAY}},
};

const mrt_card_line *card_lines(const double *params, const mrt_channels *input, uint32_t side,
                                uint32_t *out_count)
{
    static const struct {
        const mrt_card_line *line;
        uint32_t count;
    } cards[DEVICE_KINDS] = {{joints, sizeof joints / sizeof *joints},
                             {joints, sizeof joints / sizeof *joints - 1},
                             {curls, sizeof curls / sizeof *curls}};
    const device_kind device = device_of_input(params, input, side);
    *out_count = cards[device].count;
    return cards[device].line;
}
