/* MIDI bytes as they come over a wire: what they mean, whatever stands between them and wherever
 * they are cut; and the table of channels that a device's controls make. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "midi_table.h"

#include <stdio.h>
#include <string.h>

enum { EVENTS_MAX = 64 };

typedef struct heard {
    midi_parser parser;
    midi_event event[EVENTS_MAX];
    uint32_t count;
} heard;

static void hear(heard *self, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; ++i)
        if (midi_parser_add_byte(&self->parser, bytes[i], &self->event[self->count]))
            assert_true(++self->count < EVENTS_MAX);
}

#define HEAR(self, ...)                                                                            \
    do {                                                                                           \
        const uint8_t bytes_[] = {__VA_ARGS__};                                                    \
        (self)->count = 0;                                                                         \
        hear(self, bytes_, sizeof bytes_);                                                         \
    } while (0)

static void assert_event(const midi_event *event, midi_kind kind, uint8_t channel, uint16_t number,
                         float value)
{
    assert_int_equal(event->kind, kind);
    assert_int_equal(event->channel, channel);
    assert_int_equal(event->number, number);
    assert_float_equal(event->value, value, 1e-6f);
}

static void each_message_has_its_meaning(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0x90, 60, 127, 0x91, 61, 0, 0x82, 62, 64, 0xa3, 63, 127, 0xb4, 7, 127, 0xc5, 99, 0xd6,
         127, 0xe7, 0x7f, 0x7f, 0xe0, 0, 0, 0xe0, 0, 64);
    assert_int_equal(of.count, 10);
    assert_event(&of.event[0], MIDI_NOTE, 0, 60, 1);
    assert_event(&of.event[1], MIDI_NOTE, 1, 61, 0); /* velocity 0 is off */
    assert_event(&of.event[2], MIDI_NOTE, 2, 62, 0);
    assert_event(&of.event[3], MIDI_KEY_PRESSURE, 3, 63, 1);
    assert_event(&of.event[4], MIDI_CONTROLLER, 4, 7, 1);
    assert_event(&of.event[5], MIDI_PROGRAM, 5, 0, 99);
    assert_event(&of.event[6], MIDI_PRESSURE, 6, 0, 1);
    assert_event(&of.event[7], MIDI_BEND, 7, 0, 1);
    assert_event(&of.event[8], MIDI_BEND, 0, 0, -1);
    assert_true(of.event[9].value > 0 && of.event[9].value < 1e-4f); /* the middle is 8192 */
}

static void a_status_runs_on_until_another_one(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0xb0, 1, 0, 1, 64, 2, 127, 0xf6, 3, 127, 0xb0, 4, 127);
    assert_int_equal(of.count, 4); /* f6 ends it: "3, 127" belongs to nothing */
    assert_event(&of.event[1], MIDI_CONTROLLER, 0, 1, 64 / 127.0f);
    assert_event(&of.event[2], MIDI_CONTROLLER, 0, 2, 1);
    assert_event(&of.event[3], MIDI_CONTROLLER, 0, 4, 1);
}

static void real_time_bytes_may_stand_anywhere(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0xf8, 0xb0, 0xf8, 7, 0xfe, 127, 0xfa, 8, 0xfc, 0);
    assert_int_equal(of.count, 3);
    assert_event(&of.event[0], MIDI_SENSING, 0, 0, 0);
    assert_event(&of.event[1], MIDI_CONTROLLER, 0, 7, 1);
    assert_event(&of.event[2], MIDI_CONTROLLER, 0, 8, 0);
    HEAR(&of, 0xf0, 1, 2, 0xf8, 3, 0xf7, 0xe0, 0xf8, 0x7f, 0xfb, 0x7f);
    assert_int_equal(of.count, 1);
    assert_event(&of.event[0], MIDI_BEND, 0, 0, 1);
}

static void low_bits_refine_a_controller(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, true);
    HEAR(&of, 0xb0, 7, 127, 39, 127, 7, 64, 39, 1);
    assert_int_equal(of.count, 4);
    assert_event(&of.event[0], MIDI_CONTROLLER, 0, 7, 1);
    assert_event(&of.event[1], MIDI_CONTROLLER, 0, 7, 1);
    assert_event(&of.event[3], MIDI_CONTROLLER, 0, 7, 8193 / 16383.0f);
    /* one that sends seven bits reaches both ends all the same */
    HEAR(&of, 0xb0, 8, 127, 8, 0);
    assert_event(&of.event[0], MIDI_CONTROLLER, 0, 8, 1);
    /* and without that, 39 is a control of its own */
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0xb0, 7, 127, 39, 127);
    assert_event(&of.event[1], MIDI_CONTROLLER, 0, 39, 1);
}

static void parameters_without_a_registered_number_are_controls(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0xb2, 99, 10, 98, 5, 6, 127, 38, 127, 6, 64, 38, 0);
    assert_int_equal(of.count, 4);
    assert_event(&of.event[0], MIDI_NRPN, 2, 1285, 1);
    assert_event(&of.event[1], MIDI_NRPN, 2, 1285, 1);
    assert_event(&of.event[3], MIDI_NRPN, 2, 1285, 8192 / 16383.0f);
    /* 6 of another channel, and after 7f 7f, is an ordinary controller; a registered one is silent
     */
    HEAR(&of, 0xb1, 6, 127);
    assert_event(&of.event[0], MIDI_CONTROLLER, 1, 6, 1);
    HEAR(&of, 0xb2, 101, 0, 100, 0, 6, 2);
    assert_int_equal(of.count, 0);
    HEAR(&of, 0xb2, 101, 127, 100, 127, 6, 127);
    assert_int_equal(of.count, 1);
    assert_event(&of.event[0], MIDI_CONTROLLER, 2, 6, 1);
}

static void time_codes_are_frames(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    /* 01:02:03:04 at 25 a second, in eight quarter frames: seven quarters have passed by then */
    HEAR(&of, 0xf1, 0x04, 0xf1, 0x10, 0xf1, 0x23, 0xf1, 0x30, 0xf1, 0x42, 0xf1, 0x50, 0xf1, 0x61,
         0xf1, 0x72);
    assert_int_equal(of.count, 1);
    assert_event(&of.event[0], MIDI_TIMECODE, 0, 0, 3723 * 25 + 5.75f);
    assert_float_equal(of.event[0].rate, 25.0f, 0.0f);
    /* whole, 30 drop: 00:01:00:02 is one frame after 00:00:59:29 */
    HEAR(&of, 0xf0, 0x7f, 0x7f, 1, 1, 0x40, 1, 0, 2, 0xf7);
    assert_int_equal(of.count, 1);
    assert_event(&of.event[0], MIDI_TIMECODE, 0, 0, 1800);
    assert_float_equal(of.event[0].rate, -29.97003f, 1e-5f);
    /* a missing piece, an hour 24, a minute 60, one byte more */
    HEAR(&of, 0xf1, 0x04, 0xf1, 0x10, 0xf1, 0x30, 0xf1, 0x42, 0xf1, 0x50, 0xf1, 0x61, 0xf1, 0x72,
         0xf0, 0x7f, 0x7f, 1, 1, 0x38, 0, 0, 0, 0xf7, 0xf0, 0x7f, 0x7f, 1, 1, 0x21, 60, 0, 0, 0xf7,
         0xf0, 0x7f, 0x7f, 1, 1, 0x21, 0, 0, 0, 0, 0xf7);
    assert_int_equal(of.count, 0);
}

static void what_ends_notes_is_told(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 0xb3, 123, 0, 120, 0, 121, 0, 122, 0, 0xff);
    assert_int_equal(of.count, 4); /* 122, local control, is not ours */
    assert_event(&of.event[0], MIDI_RELEASE, 3, 0, 0);
    assert_event(&of.event[3], MIDI_RELEASE, MIDI_ALL_CHANNELS, 0, 0);
}

static void cut_and_damaged_messages_say_nothing(void **state)
{
    (void)state;
    heard of = {0};
    midi_parser_init(&of.parser, false);
    HEAR(&of, 7, 127, 0xb0, 7, 0x90, 60, 0xf4, 0xf5, 1, 2, 0xf7, 0xf2, 1, 0xf3, 0xf0, 1, 2, 3);
    assert_int_equal(of.count, 0);
    HEAR(&of, 0xb0, 7, 127); /* also ends the exclusive message that never did */
    assert_int_equal(of.count, 1);
}

/* Any cut gives the same: the parser takes bytes one by one, so it is enough that its state is
 * whole between them. */
static void noise_stays_within_its_ranges(void **state)
{
    (void)state;
    static const float most[] = {[MIDI_PROGRAM] = 127, [MIDI_TIMECODE] = 2592000};
    midi_parser parser;
    uint32_t seed = 1, count = 0;
    midi_parser_init(&parser, true);
    for (int i = 0; i < 1000000; ++i) {
        midi_event event;
        seed = seed * 1664525 + 1013904223;
        if (!midi_parser_add_byte(&parser, (uint8_t)(seed >> 24), &event) ||
            event.kind == MIDI_RELEASE)
            continue;
        count += 1;
        float high =
            event.kind >= MIDI_PROGRAM && event.kind <= MIDI_TIMECODE ? most[event.kind] : 1;
        assert_true(event.value >= (event.kind == MIDI_BEND ? -1.0f : 0.0f) && event.value <= high);
        assert_true(event.channel < MIDI_CHANNELS && event.number < MIDI_NUMBERS);
    }
    assert_true(count > 10000);
}

/* ---- the table ---- */

static midi_control control(midi_kind kind, uint8_t channel, uint16_t number)
{
    return midi_control_of(&(midi_event){kind, channel, number, 0, 0});
}

static void names_are_read_as_they_are_written(void **state)
{
    (void)state;
    static const struct {
        midi_kind kind;
        uint8_t channel;
        uint16_t number;
        const char *name;
    } known[] = {{MIDI_CONTROLLER, 0, 7, "cc.7"},
                 {MIDI_CONTROLLER, 1, 119, "ch2.cc.119"},
                 {MIDI_BEND, 8, 0, "bend.9"},
                 {MIDI_NOTE, 9, 36, "ch10.note.36"},
                 {MIDI_PRESSURE, 15, 0, "ch16.pressure"},
                 {MIDI_KEY_PRESSURE, 0, 1, "key_pressure.1"},
                 {MIDI_NRPN, 0, 16383, "nrpn.16383"},
                 {MIDI_TIMECODE, 0, 0, "timecode"},
                 {MIDI_TIMECODE_RATE, 0, 0, "timecode_rate"}};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        char name[MIDI_NAME];
        midi_control one = control(known[i].kind, known[i].channel, known[i].number), again = 0;
        midi_control_name(one, name);
        assert_string_equal(name, known[i].name);
        assert_true(midi_control_parse(&again, name, strlen(name)));
        assert_int_equal(again, one);
    }
    static const char *const bad[] = {
        "",         "cc",         "cc.",          "cc.120",         "cc.7x",
        "ch0.cc.7", "ch17.cc.7",  "ch2.bend.3",   "bend.0",         "bend.17",
        "note.128", "nrpn.16384", "ch2.timecode", "cc.99999999999", "ch2.",
        "none"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i) {
        midi_control none;
        if (midi_control_parse(&none, bad[i], strlen(bad[i])))
            fail_msg("\"%s\" is a name", bad[i]);
    }
}

static void what_was_heard_comes_before_the_usual(void **state)
{
    (void)state;
    static midi_table table, again;
    midi_table_build(&table, false);
    assert_int_equal(table.count, 41);
    assert_string_equal(table.channel[0].name, "cc.0");
    assert_string_equal(table.channel[40].name, "bend.9");
    assert_true(table.channel[40].min == -1);
    uint32_t heard_count = 0;
    for (uint16_t i = 40; i < 128; ++i)
        heard_count += midi_table_add(&table, control(MIDI_NOTE, 0, i));
    assert_int_equal(heard_count, MRT_MAX_CHANNELS);
    assert_false(midi_table_add(&table, control(MIDI_NOTE, 0, 40)));
    midi_table_build(&table, false);
    assert_int_equal(table.count, MRT_MAX_CHANNELS);
    assert_string_equal(table.channel[0].name, "note.40");
    assert_int_equal(midi_table_find(&table, control(MIDI_CONTROLLER, 0, 7)), -1);

    char text[MIDI_TABLE_TEXT];
    size_t size = midi_table_write(&table, text, sizeof text);
    midi_table_read(&again, text, size);
    assert_int_equal(again.heard_count, table.heard_count);
    assert_memory_equal(again.heard, table.heard, sizeof table.heard);
}

static void the_pedals_of_a_piano_are_pedals_when_asked(void **state)
{
    (void)state;
    static midi_table table;
    midi_table_build(&table, true);
    int sustain = midi_table_find(&table, control(MIDI_CONTROLLER, 0, 64));
    assert_true(sustain >= 0);
    assert_int_equal(table.channel[sustain].semantic, MRT_CH_PEDAL);
    assert_int_equal(table.channel[0].semantic, MRT_CH_OTHER);
}

static void a_damaged_table_gives_what_is_whole(void **state)
{
    (void)state;
    static midi_table table;
    static const char text[] = "cc.81\n\nnonsense\ncc.81\ncc.999\n\xff\xfe\nnote.3";
    midi_table_read(&table, text, sizeof text - 1);
    assert_int_equal(table.heard_count, 2);
    assert_int_equal(table.heard[1], control(MIDI_NOTE, 0, 3));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_message_has_its_meaning),
        cmocka_unit_test(a_status_runs_on_until_another_one),
        cmocka_unit_test(real_time_bytes_may_stand_anywhere),
        cmocka_unit_test(low_bits_refine_a_controller),
        cmocka_unit_test(parameters_without_a_registered_number_are_controls),
        cmocka_unit_test(time_codes_are_frames),
        cmocka_unit_test(what_ends_notes_is_told),
        cmocka_unit_test(cut_and_damaged_messages_say_nothing),
        cmocka_unit_test(noise_stays_within_its_ranges),
        cmocka_unit_test(names_are_read_as_they_are_written),
        cmocka_unit_test(what_was_heard_comes_before_the_usual),
        cmocka_unit_test(the_pedals_of_a_piano_are_pedals_when_asked),
        cmocka_unit_test(a_damaged_table_gives_what_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
