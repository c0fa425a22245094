/* Datagrams as phones and webcam programs send them, built byte by byte from the descriptions of
 * the formats, not with the reader's tables. */
#ifndef TESTS_DEVICE_PHONE_DATAGRAMS_H
#define TESTS_DEVICE_PHONE_DATAGRAMS_H
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct datagram {
    uint8_t bytes[4096];
    size_t size;
} datagram;

static inline void put_big(datagram *to, uint32_t word)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        to->bytes[to->size++] = (uint8_t)(word >> shift);
}

static inline void put_big_float(datagram *to, float value)
{
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    put_big(to, word);
}

static inline void put_text(datagram *to, const char *text)
{
    put_big(to, (uint32_t)strlen(text));
    memcpy(to->bytes + to->size, text, strlen(text));
    to->size += strlen(text);
}

/* Live Link Face up to the count of values: u8 6, id, subject, frame, its part, rate. */
static inline void begin_live_link(datagram *to, uint32_t frame, float part)
{
    to->size = 0;
    to->bytes[to->size++] = 6;
    put_text(to, "8A1F54C2-3F0B-4E7C-9D53-0C6B5B7A2E11");
    put_text(to, "iPhone of \xc3\x84nne");
    put_big(to, frame);
    put_big_float(to, part);
    put_big(to, 60);
    put_big(to, 1);
}

static inline void put_live_link(datagram *to, uint32_t frame, float part, const float value[61])
{
    begin_live_link(to, frame, part);
    to->bytes[to->size++] = 61;
    for (int i = 0; i < 61; ++i)
        put_big_float(to, value[i]);
}

static inline void put_little(datagram *to, const void *number, size_t size)
{
    /* what runs these tests is little-endian, as every machine is that OpenSeeFace runs on */
    memcpy(to->bytes + to->size, number, size);
    to->size += size;
}

static inline void put_little_float(datagram *to, float value)
{
    put_little(to, &value, sizeof value);
}

typedef struct openseeface_face {
    double time_s;
    float right_open, left_open;
    uint8_t has_3d;
    float euler[3];
    float feature[14];
} openseeface_face;

static inline void put_openseeface(datagram *to, const openseeface_face *face)
{
    const int32_t id = 0;
    put_little(to, &face->time_s, 8);
    put_little(to, &id, 4);
    put_little_float(to, 640);
    put_little_float(to, 480);
    put_little_float(to, face->right_open);
    put_little_float(to, face->left_open);
    to->bytes[to->size++] = face->has_3d;
    put_little_float(to, 12.5f); /* error */
    for (int i = 0; i < 4; ++i)
        put_little_float(to, 0.5f); /* quaternion */
    for (int i = 0; i < 3; ++i)
        put_little_float(to, face->euler[i]);
    for (int i = 0; i < 3; ++i)
        put_little_float(to, 1.0f); /* translation */
    for (int i = 0; i < 68 + 2 * 68 + 3 * 70; ++i)
        put_little_float(to, 0.25f); /* confidence, points, points in space */
    for (int i = 0; i < 14; ++i)
        put_little_float(to, face->feature[i]);
}

#endif
