/* plugins/cyberglove/glove_parse.h: records are found among bytes, damaged ones are lost alone. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "glove_parse.h"

#include <stdlib.h>
#include <string.h>

enum { SENSORS = 22, RECORD_MAX = 64, STREAM_RECORDS = 20000, EVERY = 50 };

static const glove_layout plain = {GLOVE_BYTES, 'S', SENSORS, false, false};
static const glove_layout stamped = {GLOVE_BYTES, 'S', SENSORS, true, true};
static const glove_layout words = {GLOVE_WORDS, 'S', SENSORS, false, false};

/* "S" 1..22 NUL */
static const unsigned char golden_plain[24] = {'S', 1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11,
                                               12,  13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 0};
/* 0x01020304 ticks, flags marked; in the box, switch on */
static const unsigned char golden_stamped[30] = {'S', 1,  2,  3,   4,  5,  6,  7,  8,    9,
                                                 10,  11, 12, 13,  14, 15, 16, 17, 18,   19,
                                                 20,  21, 22, 128, 4,  3,  2,  1,  0x83, 0};

static bool parse_one(const glove_layout *layout, const unsigned char *bytes, size_t size,
                      glove_record *out)
{
    glove_parse parse;
    glove_parse_init(&parse, layout);
    glove_parse_append(&parse, bytes, size);
    return glove_parse_next(&parse, out);
}

static void a_plain_record_is_read(void **state)
{
    (void)state;
    glove_record record;
    assert_true(parse_one(&plain, golden_plain, sizeof golden_plain, &record));
    for (uint16_t i = 0; i < SENSORS; ++i)
        assert_int_equal(record.sensor[i], i + 1);
    assert_int_equal(record.lost, 0);
    assert_int_equal(record.status, 0);
}

static void time_stamp_and_status_are_read(void **state)
{
    (void)state;
    glove_record record;
    assert_true(parse_one(&stamped, golden_stamped, sizeof golden_stamped, &record));
    assert_int_equal(record.ticks, 0x01020304);
    assert_int_equal(record.status, GLOVE_STATUS_VALID | GLOVE_STATUS_SWITCH | GLOVE_STATUS_IN);
}

static void zeros_of_a_stamp_come_back(void **state)
{
    (void)state;
    unsigned char bytes[30];
    memcpy(bytes, golden_stamped, sizeof bytes);
    memcpy(bytes + 23, (unsigned char[]){128 | 2 | 8, 7, 1, 9, 1}, 5);
    glove_record record;
    assert_true(parse_one(&stamped, bytes, sizeof bytes, &record));
    assert_int_equal(record.ticks, 0x00090007);
}

static void flags_of_zero_are_read_where_all_else_fits(void **state)
{
    (void)state;
    unsigned char bytes[60];
    memcpy(bytes, golden_stamped, 30);
    bytes[23] = 0;
    memcpy(bytes + 30, bytes, 30);
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, &stamped);
    for (size_t i = 0; i < sizeof bytes; ++i) {
        glove_parse_append(&parse, bytes + i, 1);
        assert_int_equal(glove_parse_next(&parse, &record), i == 29 || i == 59);
    }
    assert_int_equal(record.ticks, 0x01020304);
    assert_int_equal(parse.garbage_bytes, 0);
}

static void flags_of_zero_are_damage_in_a_glove_that_marks_them(void **state)
{
    (void)state;
    unsigned char bytes[90];
    for (size_t i = 0; i < 3; ++i)
        memcpy(bytes + 30 * i, golden_stamped, 30);
    bytes[30 + 23] = 0;
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, &stamped);
    glove_parse_append(&parse, bytes, sizeof bytes);
    assert_true(glove_parse_next(&parse, &record));
    assert_true(glove_parse_next(&parse, &record));
    assert_int_equal(record.lost, 1);
    assert_false(glove_parse_next(&parse, &record));
}

static void a_status_without_its_mark_is_not_believed(void **state)
{
    (void)state;
    unsigned char bytes[30];
    memcpy(bytes, golden_stamped, sizeof bytes);
    bytes[28] = 0x03;
    glove_record record;
    assert_true(parse_one(&stamped, bytes, sizeof bytes, &record));
    assert_int_equal(record.status, 0);
}

static void complaints_stand_between_data_and_end(void **state)
{
    (void)state;
    unsigned char bytes[28];
    glove_record record;
    memcpy(bytes, golden_plain, 23);
    memcpy(bytes + 23, "es", 3);
    assert_true(parse_one(&plain, bytes, 26, &record));
    assert_true(record.is_too_fast && !record.is_unplugged);
    memcpy(bytes + 23, "eg", 3);
    assert_true(parse_one(&plain, bytes, 26, &record));
    assert_true(!record.is_too_fast && record.is_unplugged);
    memcpy(bytes + 23, "eseg", 5);
    assert_true(parse_one(&plain, bytes, 28, &record));
    assert_true(record.is_too_fast && record.is_unplugged);
    assert_int_equal(record.sensor[21], 22);
    memcpy(bytes + 23, "ex", 3);
    assert_false(parse_one(&plain, bytes, 26, &record));
}

static void eighteen_sensors_make_a_shorter_record(void **state)
{
    (void)state;
    static const glove_layout layout = {GLOVE_BYTES, 'G', 18, false, true};
    static const unsigned char bytes[21] = {'G', 9, 9, 9, 9, 9, 9, 9, 9,    9, 9,
                                            9,   9, 9, 9, 9, 9, 9, 7, 0x81, 0};
    glove_record record;
    assert_int_equal(glove_layout_size(&layout), 21);
    assert_true(parse_one(&layout, bytes, sizeof bytes, &record));
    assert_int_equal(record.sensor[17], 7);
    assert_int_equal(record.status, 0x81);
}

/* ---- streams with damage ---- */

typedef struct stream {
    unsigned char *bytes;
    size_t size, record_size;
} stream;

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* Record i carries its number in the first three sensors; 'S' and 'e' are frequent values. */
static void write_record(const glove_layout *layout, uint32_t i, uint32_t *seed, unsigned char *out)
{
    size_t size = glove_layout_size(layout);
    for (size_t k = 0; k < size; ++k) {
        uint32_t dice = next_random(seed);
        out[k] = (unsigned char)(dice % 4 == 0 ? 'S' : dice % 7 == 0 ? 'e' : 1 + dice % 255);
    }
    out[0] = layout->head;
    out[1] = (unsigned char)(1 + i % 250);
    out[2] = (unsigned char)(1 + i / 250 % 250);
    if (layout->has_time)
        out[1 + layout->sensor_count] = 128;
    if (layout->has_status)
        out[size - 2] = 0x81;
    out[size - 1] = 0;
}

static stream stream_of(const glove_layout *layout, uint32_t count, uint32_t seed)
{
    stream out = {.record_size = glove_layout_size(layout)};
    out.size = out.record_size * count;
    out.bytes = malloc(out.size);
    assert_non_null(out.bytes);
    for (uint32_t i = 0; i < count; ++i)
        write_record(layout, i, &seed, out.bytes + out.record_size * i);
    return out;
}

static uint32_t number_of(const glove_record *record)
{
    return (record->sensor[0] - 1u) + 250 * (record->sensor[1] - 1u);
}

/* Reads all in pieces of odd sizes; every record not damaged must come, in order, and no other. */
static void assert_only_these_are_lost(const glove_layout *layout, const stream *s,
                                       const unsigned char *damaged, uint32_t count)
{
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, layout);
    uint32_t expected = 0, seed = 5, lost = 0;
    for (size_t at = 0; at < s->size;) {
        size_t part = 1 + next_random(&seed) % 70;
        part = part < s->size - at ? part : s->size - at;
        assert_true(part <= glove_parse_room(&parse));
        glove_parse_append(&parse, s->bytes + at, part);
        at += part;
        while (glove_parse_next(&parse, &record)) {
            uint32_t skipped = 0;
            for (; expected < count && damaged[expected]; ++expected)
                skipped += 1;
            assert_int_equal(number_of(&record), expected);
            assert_int_equal(record.lost, skipped);
            lost += skipped;
            expected += 1;
        }
    }
    while (expected < count && damaged[expected])
        expected += 1;
    assert_int_equal(expected, count);
    assert_int_equal(parse.lost_count, lost);
}

typedef enum damage {
    BYTE_TO_ZERO,
    END_TO_S,
    END_TO_OTHER,
    HEAD_TO_OTHER,
    HEAD_TO_ZERO,
    DAMAGE_COUNT
} damage;

static void harm(unsigned char *record, size_t size, damage kind, uint32_t dice)
{
    switch (kind) {
    case BYTE_TO_ZERO:
        record[1 + dice % (size - 2)] = 0;
        break;
    case END_TO_S:
        record[size - 1] = 'S';
        break;
    case END_TO_OTHER:
        record[size - 1] = (unsigned char)(1 + dice % 255);
        break;
    case HEAD_TO_OTHER:
        record[0] = (unsigned char)(1 + dice % ('S' - 1));
        break;
    default:
        record[0] = 0;
        break;
    }
}

static void one_damaged_byte_in_fifty_records_loses_exactly_those(void **state)
{
    (void)state;
    static const glove_layout layouts[] = {{GLOVE_BYTES, 'S', 22, false, false},
                                           {GLOVE_BYTES, 'S', 22, true, true},
                                           {GLOVE_BYTES, 'S', 18, true, false},
                                           {GLOVE_BYTES, 'S', 18, false, true}};
    for (uint32_t k = 0; k < 4; ++k)
        for (int kind = 0; kind < DAMAGE_COUNT; ++kind) {
            stream s = stream_of(&layouts[k], STREAM_RECORDS, 17);
            unsigned char *damaged = calloc(STREAM_RECORDS, 1);
            assert_non_null(damaged);
            uint32_t seed = 3;
            for (uint32_t i = 10; i < STREAM_RECORDS - 10; i += EVERY) {
                uint32_t victim = i + next_random(&seed) % (EVERY - 2);
                if (victim >= STREAM_RECORDS - 1)
                    break;
                harm(s.bytes + s.record_size * victim, s.record_size, (damage)kind,
                     next_random(&seed));
                damaged[victim] = 1;
            }
            assert_only_these_are_lost(&layouts[k], &s, damaged, STREAM_RECORDS);
            free(damaged);
            free(s.bytes);
        }
}

static void a_byte_too_few_or_too_many_loses_one_record(void **state)
{
    (void)state;
    enum { COUNT = 5, VICTIM = 2 };
    for (size_t at = 0; at < 24; ++at)
        for (int insert = 0; insert < 2; ++insert) {
            stream s = stream_of(&plain, COUNT, 29);
            unsigned char *bytes = malloc(s.size + 1);
            assert_non_null(bytes);
            size_t cut = s.record_size * VICTIM + at;
            memcpy(bytes, s.bytes, cut);
            bytes[cut] = 77;
            size_t from = insert ? cut : cut + 1;
            memcpy(bytes + cut + (size_t)insert, s.bytes + from, s.size - from);
            stream changed = {bytes, insert ? s.size + 1 : s.size - 1, s.record_size};
            /* An extra byte at the start of a record is garbage before it. */
            unsigned char damaged[COUNT] = {0};
            damaged[VICTIM] = 1;
            assert_only_these_are_lost(&plain, &changed, damaged, COUNT);
            free(bytes);
            free(s.bytes);
        }
}

static void a_start_in_the_middle_of_a_record_is_no_loss(void **state)
{
    (void)state;
    stream s = stream_of(&plain, 3, 11);
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, &plain);
    glove_parse_append(&parse, s.bytes + 9, s.size - 9);
    assert_true(glove_parse_next(&parse, &record));
    assert_int_equal(number_of(&record), 1);
    assert_int_equal(record.lost, 0);
    assert_true(glove_parse_next(&parse, &record));
    free(s.bytes);
}

static void noise_without_end_is_dropped_and_the_record_after_it_found(void **state)
{
    (void)state;
    unsigned char noise[100];
    memset(noise, 'S', sizeof noise);
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, &plain);
    for (int i = 0; i < 1000; ++i) {
        size_t room = glove_parse_room(&parse);
        assert_true(room > 0);
        glove_parse_append(&parse, noise, room < sizeof noise ? room : sizeof noise);
        assert_false(glove_parse_next(&parse, &record));
    }
    glove_parse_append(&parse, (const unsigned char *)"\0", 1);
    (void)glove_parse_next(&parse, &record); /* 22 times 'S' may well be a hand */
    glove_parse_append(&parse, golden_plain, sizeof golden_plain);
    assert_true(glove_parse_next(&parse, &record));
    assert_int_equal(record.sensor[21], 22);
}

/* ---- words ---- */

static size_t write_words(unsigned char *out, uint16_t first)
{
    memcpy(out, "10:59:07:29:3S", 14);
    for (uint16_t i = 0; i < SENSORS; ++i) {
        out[14 + 2 * i] = (unsigned char)((first + i) >> 8);
        out[15 + 2 * i] = (unsigned char)(first + i);
    }
    memcpy(out + 58, "\r\n", 3);
    return 61;
}

static void words_are_read_high_byte_first(void **state)
{
    (void)state;
    unsigned char bytes[64];
    glove_record record;
    assert_int_equal(glove_layout_size(&words), 61);
    assert_true(parse_one(&words, bytes, write_words(bytes, 250), &record));
    for (uint16_t i = 0; i < SENSORS; ++i)
        assert_int_equal(record.sensor[i], 250 + i);
}

static void words_may_look_like_an_end_or_a_beginning(void **state)
{
    (void)state;
    unsigned char bytes[64];
    write_words(bytes, 300);
    memcpy(bytes + 21, "\r\n\0", 3); /* low, high, low */
    memcpy(bytes + 31, "\x0a\x00\x05", 3);
    glove_record record;
    assert_true(parse_one(&words, bytes, 61, &record));
    assert_int_equal(record.sensor[4], 0x0a00);
}

static void a_prefix_before_the_time_is_no_damage(void **state)
{
    (void)state;
    unsigned char bytes[200];
    size_t size = write_words(bytes, 100);
    memcpy(bytes + size, "1S", 2);
    size += 2;
    size += write_words(bytes + size, 200);
    glove_parse parse;
    glove_record record;
    glove_parse_init(&parse, &words);
    glove_parse_append(&parse, bytes, size);
    assert_true(glove_parse_next(&parse, &record));
    assert_true(glove_parse_next(&parse, &record));
    assert_int_equal(record.sensor[0], 200);
    assert_int_equal(record.lost, 0);
}

static void damaged_words_are_lost_alone(void **state)
{
    (void)state;
    for (size_t at = 0; at < 61; ++at) {
        unsigned char bytes[3 * 61];
        for (uint16_t i = 0; i < 3; ++i)
            write_words(bytes + (size_t)(61 * i), (uint16_t)(500 + 500 * i));
        bool is_low = at >= 14 && at < 58 && at % 2 == 1;
        bytes[61 + at] = is_low ? bytes[61 + at] : 0xff; /* a low byte may be anything */
        glove_parse parse;
        glove_record record;
        glove_parse_init(&parse, &words);
        glove_parse_append(&parse, bytes, sizeof bytes);
        assert_true(glove_parse_next(&parse, &record));
        assert_true(glove_parse_next(&parse, &record));
        assert_int_equal(record.sensor[0], is_low ? 1000 : 1500);
        assert_int_equal(record.lost, is_low ? 0 : 1);
    }
}

/* ---- another layout ---- */

static void a_layout_that_was_not_said_is_guessed(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 8; ++k) {
        glove_layout sent = {GLOVE_BYTES, 'S', k & 4 ? 18 : 22, (k & 2) != 0, (k & 1) != 0};
        stream s = stream_of(&sent, 6, 23);
        glove_layout guess = {GLOVE_BYTES, 'S', sent.sensor_count, !sent.has_time, true};
        assert_true(glove_layout_guess(s.bytes + 3, s.size - 3, &guess));
        assert_int_equal(guess.sensor_count, sent.sensor_count);
        assert_int_equal(guess.has_time, sent.has_time);
        assert_int_equal(guess.has_status, sent.has_status);
        assert_false(glove_layout_guess(s.bytes, 3 * s.record_size, &guess));
        free(s.bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_record_is_read),
        cmocka_unit_test(time_stamp_and_status_are_read),
        cmocka_unit_test(zeros_of_a_stamp_come_back),
        cmocka_unit_test(flags_of_zero_are_read_where_all_else_fits),
        cmocka_unit_test(flags_of_zero_are_damage_in_a_glove_that_marks_them),
        cmocka_unit_test(a_status_without_its_mark_is_not_believed),
        cmocka_unit_test(complaints_stand_between_data_and_end),
        cmocka_unit_test(eighteen_sensors_make_a_shorter_record),
        cmocka_unit_test(one_damaged_byte_in_fifty_records_loses_exactly_those),
        cmocka_unit_test(a_byte_too_few_or_too_many_loses_one_record),
        cmocka_unit_test(a_start_in_the_middle_of_a_record_is_no_loss),
        cmocka_unit_test(noise_without_end_is_dropped_and_the_record_after_it_found),
        cmocka_unit_test(words_are_read_high_byte_first),
        cmocka_unit_test(words_may_look_like_an_end_or_a_beginning),
        cmocka_unit_test(a_prefix_before_the_time_is_no_damage),
        cmocka_unit_test(damaged_words_are_lost_alone),
        cmocka_unit_test(a_layout_that_was_not_said_is_guessed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
