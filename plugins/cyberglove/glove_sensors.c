#include "glove_sensors.h"

enum { MASK_BITS = 24, INDEX_ABDUCTION_BIT = 7, WRIST_YAW_BIT = 22 };

static const char *const sensor_name[MRT_ANGLES] = {
    "thumb.roll", "thumb.mpj",  "thumb.ij",    "thumb.abd",  "index.mpj",  "index.pij",
    "index.dij",  "middle.mpj", "middle.pij",  "middle.dij", "middle.abd", "ring.mpj",
    "ring.pij",   "ring.dij",   "ring.abd",    "little.mpj", "little.pij", "little.dij",
    "little.abd", "palm.arch",  "wrist.pitch", "wrist.yaw"};

const char *glove_sensor_name(uint32_t semantic)
{
    bool is_angle = semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
    return is_angle ? sensor_name[semantic - MRT_CH_ANGLE] : "extra";
}

/* Bits are in the order of the sensors; the index finger has no abduction of its own. */
static uint32_t semantic_of_bit(uint32_t bit)
{
    if (bit == INDEX_ABDUCTION_BIT || bit > WRIST_YAW_BIT)
        return MRT_CH_OTHER;
    return MRT_CH_ANGLE + (bit < INDEX_ABDUCTION_BIT ? bit : bit - 1);
}

static glove_sensors of_mask(uint32_t mask)
{
    glove_sensors out = {0};
    for (uint32_t bit = 0; bit < MASK_BITS; ++bit)
        if (mask >> bit & 1u)
            out.semantic[out.count++] = semantic_of_bit(bit);
    return out;
}

static uint32_t bit_count(uint32_t mask)
{
    uint32_t count = 0;
    for (; mask; mask &= mask - 1)
        count += 1;
    return count;
}

static uint32_t mask_of_count(uint32_t count)
{
    return count == 22 ? GLOVE_MASK_22 : count == 18 ? GLOVE_MASK_18 : 0;
}

void glove_sensors_of_count(uint32_t count, glove_sensors *out)
{
    *out = of_mask(mask_of_count(count));
}

/* The low byte comes first, but the other order is known by its 18-sensor mask. */
static uint32_t in_order(uint32_t mask)
{
    uint32_t turned = (mask & 0xFFu) << 16 | (mask & 0xFF00u) | mask >> 16;
    return turned == GLOVE_MASK_18 ? turned : mask;
}

/* The hardware mask, unless it contradicts a number of sensors that gloves have. */
static uint32_t hardware_mask(const glove_census *census)
{
    uint32_t mask = in_order(census->hardware_mask & 0xFFFFFFu);
    uint32_t usual = mask_of_count(census->sensor_count);
    return usual && bit_count(mask) != census->sensor_count ? usual : mask;
}

bool glove_sensors_find(const glove_census *census, glove_sensors *out)
{
    uint32_t mask = hardware_mask(census);
    uint32_t sent_mask = mask & in_order(census->software_mask & 0xFFFFFFu);
    if (sent_mask)
        mask = sent_mask;
    if (!mask)
        return false;
    *out = of_mask(mask);
    if (census->sent_count > 0 && census->sent_count < out->count)
        out->count = census->sent_count;
    return true;
}
