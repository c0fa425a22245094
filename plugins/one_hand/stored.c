#include "stored.h"

#include <stdint.h>
#include <string.h>

/* "MRT1HAND", a version, which hands are known (bit per side), two poses, FNV-1a of all that. */
static const unsigned char magic[8] = {'M', 'R', 'T', '1', 'H', 'A', 'N', 'D'};
enum { VERSION = 1, HEAD = 16, BODY = HEAD + 2 * READING_COUNT * 8, SIZE = BODY + 8 };

static void put(unsigned char *out, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; ++i)
        out[i] = (unsigned char)(value >> (8 * i));
}

static uint64_t get(const unsigned char *in, int bytes)
{
    uint64_t value = 0;
    for (int i = 0; i < bytes; ++i)
        value |= (uint64_t)in[i] << (8 * i);
    return value;
}

static uint64_t sum_of(const unsigned char *bytes, size_t size)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ bytes[i]) * UINT64_C(0x100000001b3);
    return sum;
}

size_t stored_write(void *out, size_t capacity, const neutral hands[2])
{
    if (!out || capacity < SIZE)
        return SIZE;
    unsigned char *bytes = out;
    memcpy(bytes, magic, sizeof magic);
    put(bytes + 8, VERSION, 4);
    put(bytes + 12, (hands[0].is_known ? 1u : 0u) | (hands[1].is_known ? 2u : 0u), 4);
    unsigned char *at = bytes + HEAD;
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < READING_COUNT; ++i, at += 8) {
            double value = hands[side].is_known ? hands[side].pose.value[i] : 0.0;
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            put(at, bits, 8);
        }
    put(bytes + BODY, sum_of(bytes, BODY), 8);
    return SIZE;
}

bool stored_read(neutral hands[2], const void *in, size_t size)
{
    const unsigned char *bytes = in;
    if (!bytes || size != SIZE || memcmp(bytes, magic, sizeof magic) != 0 ||
        get(bytes + 8, 4) != VERSION || get(bytes + 12, 4) > 3 ||
        get(bytes + BODY, 8) != sum_of(bytes, BODY))
        return false;
    neutral read[2];
    const unsigned char *at = bytes + HEAD;
    for (int side = 0; side < 2; ++side) {
        read[side].is_known = get(bytes + 12, 4) >> side & 1;
        for (int i = 0; i < READING_COUNT; ++i, at += 8) {
            uint64_t bits = get(at, 8);
            memcpy(&read[side].pose.value[i], &bits, sizeof bits);
        }
        if (!reading_is_plausible(&read[side].pose))
            return false;
    }
    memcpy(hands, read, sizeof read);
    return true;
}
