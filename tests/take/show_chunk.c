/* core/show/chunk.h: samples to bytes and back, exactly; anything else is refused with a reason. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show/chunk.h"
#include "take/show_scene.h"

#include <float.h>
#include <zlib.h>

enum { SAMPLES = 300 };

typedef struct packed {
    uint8_t *bytes;
    size_t size;
} packed;

static packed pack(int64_t track, uint32_t ordinal, const mrt_sample *samples, uint32_t count)
{
    error err = {""};
    packed out = {malloc(chunk_bound(count, samples[0].count)), 0};
    assert_non_null(out.bytes);
    scene_must(chunk_encode(out.bytes, &out.size, track, ordinal, samples, count, &err), &err);
    assert_true(out.size <= chunk_bound(count, samples[0].count));
    return out;
}

static void expect_round_trip(const mrt_sample *samples, uint32_t count)
{
    static mrt_sample got[CHUNK_SAMPLES_MAX];
    error err = {""};
    chunk_head head;
    packed p = pack(INT64_MAX - 5, UINT32_MAX - 1, samples, count);
    scene_must(chunk_decode(got, &head, p.bytes, p.size, &err), &err);
    assert_int_equal(head.track, INT64_MAX - 5);
    assert_int_equal(head.ordinal, UINT32_MAX - 1);
    assert_int_equal(head.from_ns, samples[0].time_ns);
    assert_int_equal(head.sample_count, count);
    assert_int_equal(head.channel_count, samples[0].count);
    for (uint32_t i = 0; i < count; ++i) {
        assert_int_equal(got[i].time_ns, samples[i].time_ns);
        assert_int_equal(got[i].sequence, samples[i].sequence);
        assert_int_equal(got[i].count, samples[i].count);
        assert_memory_equal(got[i].value, samples[i].value, samples[i].count * sizeof(float));
    }
    free(p.bytes);
}

static void hands_come_back(void **state)
{
    (void)state;
    mrt_sample samples[SAMPLES];
    for (int i = 0; i < SAMPLES; ++i)
        samples[i] = scene_sample(3, i);
    expect_round_trip(samples, SAMPLES);
    expect_round_trip(samples, 1);
}

/* Bits of every kind but NaN and infinity: denormals, both zeros, the largest, the whole numbers at
 * which floats stop to be exact. */
static void every_finite_float_comes_back(void **state)
{
    (void)state;
    static const float special[] = {0.0f,        -0.0f,    1e-45f,     -1e-45f, FLT_MIN,
                                    FLT_MAX,     -FLT_MAX, 16777215.f, 1.0f,    16777216.f,
                                    -16777215.f, 0.1f,     -16777216.f};
    enum { COUNT = sizeof special / sizeof special[0] };
    mrt_sample samples[SAMPLES];
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        samples[i] = (mrt_sample){.time_ns = i, .sequence = i, .count = MRT_MAX_CHANNELS};
        for (uint32_t c = 0; c < MRT_MAX_CHANNELS; ++c) {
            uint64_t random = scene_random(i * 64 + c);
            uint32_t bits = (uint32_t)random;
            if ((bits >> 23 & 255) == 255)
                bits ^= 1u << 30;
            if (c < COUNT)
                samples[i].value[c] = special[(i + c * (uint32_t)(random >> 60)) % COUNT];
            else
                memcpy(&samples[i].value[c], &bits, sizeof bits);
        }
    }
    expect_round_trip(samples, SAMPLES);
}

static void times_and_numbers_of_any_size_come_back(void **state)
{
    (void)state;
    mrt_sample samples[6] = {{.time_ns = INT64_MIN, .sequence = UINT32_MAX},
                             {.time_ns = -1, .sequence = 0},
                             {.time_ns = 0, .sequence = 1},
                             {.time_ns = 0, .sequence = 1},
                             {.time_ns = 5, .sequence = 0x80000000u},
                             {.time_ns = INT64_MAX, .sequence = 7}};
    for (int i = 0; i < 6; ++i)
        samples[i].count = 1;
    expect_round_trip(samples, 6);
}

static void random_chunks_come_back(void **state)
{
    (void)state;
    mrt_sample samples[SAMPLES];
    for (uint64_t round = 0; round < 200; ++round) {
        uint64_t seed = scene_random(round);
        uint32_t count = 1 + (uint32_t)(seed % SAMPLES);
        uint32_t channels = 1 + (uint32_t)(seed >> 10) % MRT_MAX_CHANNELS;
        int64_t time_ns = (int64_t)(seed >> 3);
        for (uint32_t i = 0; i < count; ++i) {
            uint64_t random = scene_random(seed + i);
            time_ns += (int64_t)(random % (1u << (random >> 40) % 31));
            samples[i] = (mrt_sample){
                .time_ns = time_ns, .sequence = (uint32_t)(random >> 20), .count = channels};
            for (uint32_t c = 0; c < channels; ++c)
                samples[i].value[c] = c % 3
                                          ? (float)(int32_t)(random >> (c % 48 + 8) & 1023) - 512.0f
                                          : (float)(random >> c % 48) * 1e-9f;
        }
        expect_round_trip(samples, count);
    }
}

static void still_hands_take_little(void **state)
{
    (void)state;
    mrt_sample samples[150];
    for (int i = 0; i < 150; ++i) {
        samples[i] = scene_sample(1, 0);
        samples[i].time_ns += i * scene_step_ns;
        samples[i].sequence += (uint32_t)i;
    }
    packed p = pack(1, 0, samples, 150);
    assert_true(p.size < 200); /* bytes, of 3300 counts */
    free(p.bytes);
}

static void what_cannot_be_packed_is_refused(void **state)
{
    (void)state;
    error err = {""};
    size_t size;
    mrt_sample samples[2] = {scene_sample(1, 0), scene_sample(1, 1)};
    uint8_t *out = malloc(chunk_bound(2, MRT_MAX_CHANNELS));
    assert_non_null(out);
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, 0, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, CHUNK_SAMPLES_MAX + 1, &err),
                     MRT_ERR_ARGUMENT);
    samples[1].count = 21;
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, 2, &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "sample 1 has 21 values"));
    samples[1] = scene_sample(1, 1);
    samples[1].value[4] = 0.0f / 0.0f;
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, 2, &err), MRT_ERR_ARGUMENT);
    samples[1] = scene_sample(1, 0);
    samples[1].time_ns -= 1;
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, 2, &err), MRT_ERR_ARGUMENT);
    samples[0].count = 0;
    assert_int_equal(chunk_encode(out, &size, 1, 0, samples, 1, &err), MRT_ERR_ARGUMENT);
    free(out);
}

static void any_flipped_bit_and_any_cut_is_noticed(void **state)
{
    (void)state;
    mrt_sample samples[20], got[CHUNK_SAMPLES_MAX];
    chunk_head head;
    error err = {""};
    for (int i = 0; i < 20; ++i)
        samples[i] = scene_sample(1, i);
    packed p = pack(1, 0, samples, 20);
    for (size_t bit = 0; bit < 8 * p.size; ++bit) {
        p.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
        assert_int_equal(chunk_decode(got, &head, p.bytes, p.size, &err), MRT_ERR_FORMAT);
        assert_true(strlen(err.text) > 0);
        p.bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
    }
    for (size_t size = 0; size < p.size; ++size)
        assert_int_equal(chunk_decode(got, &head, p.bytes, size, &err), MRT_ERR_FORMAT);
    free(p.bytes);
}

/* Bytes with a right CRC that somebody made up: refused by what they say. */
static void made_up_chunks_are_refused(void **state)
{
    (void)state;
    static mrt_sample got[CHUNK_SAMPLES_MAX];
    chunk_head head;
    error err = {""};
    mrt_sample samples[20];
    for (int i = 0; i < 20; ++i)
        samples[i] = scene_sample(1, i);
    packed p = pack(1, 0, samples, 20);
    int accepted = 0;
    for (uint64_t round = 0; round < 20000; ++round) {
        uint64_t random = scene_random(round);
        uint8_t *byte = &p.bytes[5 + random % (p.size - 5)], was = *byte;
        *byte = (uint8_t)(random >> 40);
        uLong crc = crc32(0, p.bytes + 5, (uInt)(p.size - 5));
        for (int i = 0; i < 4; ++i)
            p.bytes[1 + i] = (uint8_t)(crc >> (8 * i));
        accepted += chunk_decode(got, &head, p.bytes, p.size, &err) >= 0;
        *byte = was;
    }
    assert_true(accepted < 20000);
    free(p.bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hands_come_back),
        cmocka_unit_test(every_finite_float_comes_back),
        cmocka_unit_test(times_and_numbers_of_any_size_come_back),
        cmocka_unit_test(random_chunks_come_back),
        cmocka_unit_test(still_hands_take_little),
        cmocka_unit_test(what_cannot_be_packed_is_refused),
        cmocka_unit_test(any_flipped_bit_and_any_cut_is_noticed),
        cmocka_unit_test(made_up_chunks_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
