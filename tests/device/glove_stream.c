/* plugins/cyberglove against the emulated glove: every kind of glove, line and setting gives the
 * very values that were measured, and damage costs the damaged records alone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "glove_session.h"

enum { TAKEN = 60, PATIENCE_S = 10 };

static uint32_t hand_of(const glove_session *s)
{
    for (uint32_t c = 0; c < s->channel_count; ++c)
        if (s->channel[c].semantic == MRT_CH_ANGLE)
            return s->channel[c].hand;
    return MRT_NO_HAND;
}

/* Takes `count` samples of one glove and ends the session. */
static void take(glove_session *s, glove_truth *truth, const char *const *options,
                 const char *params, uint32_t count)
{
    session_begin(s, options);
    session_open(s, params);
    if (!session_take(s, count, PATIENCE_S)) {
        session_say_log(s);
        fail_msg("%u samples of %u in %d s", s->count, count, PATIENCE_S);
    }
    session_read_truth(s, truth);
}

/* Every value is true, and none is missing. */
static void check(const char *const *options, const char *params, uint32_t sensor_count,
                  uint32_t hand)
{
    glove_session s;
    glove_truth truth;
    uint32_t gap_count;
    take(&s, &truth, options, params, TAKEN);
    assert_int_equal(hand_of(&s), hand);
    session_check_values(&s, &truth, sensor_count, &gap_count);
    assert_int_equal(gap_count, 0);
    glove_truth_finish(&truth);
    session_end(&s);
}

static void a_right_glove_of_22_sensors(void **state)
{
    (void)state;
    check(OPTIONS("--numbered"), "", 22, MRT_RIGHT);
}

static void a_left_glove_of_18_sensors(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--sensors", "18", "--left"), "", 18, MRT_LEFT);
}

static void a_newer_glove_that_refuses_settings(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--flavour", "cg2"), "", 22, MRT_RIGHT);
    check(OPTIONS("--numbered", "--flavour", "cg2", "--sensors", "18", "--left",
                  "--refuses-each-byte"),
          "", 18, MRT_LEFT);
}

static void without_time_stamps(void **state)
{
    (void)state;
    check(OPTIONS("--numbered"), "time_stamps=off", 22, MRT_RIGHT);
}

/* Their flags are 0 then, within the record, once the glove has been on for 145 s. */
static void time_stamps_with_bare_flags(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--bare-stamp-flags", "--uptime-s", "1000"), "", 22, MRT_RIGHT);
}

/* After 10 h 21 min 22.7 s. */
static void time_stamps_that_wrap(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--uptime-s", "37282.4"), "", 22, MRT_RIGHT);
}

static void polled(void **state)
{
    (void)state;
    check(OPTIONS("--numbered"), "mode=polled", 22, MRT_RIGHT);
    check(OPTIONS("--numbered", "--flavour", "cg2", "--sensors", "18"), "mode=polled", 18,
          MRT_RIGHT);
}

static void bytes_in_pieces(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--chunk-bytes", "7"), "", 22, MRT_RIGHT);
}

static void a_glove_that_was_left_streaming(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--streaming"), "", 22, MRT_RIGHT);
}

static void a_slow_line_at_its_own_rate(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--baud", "38400", "--minds-baud"), "baud=38400,rate=60", 22,
          MRT_RIGHT);
}

/* A record takes 7.8 ms there, and its turn comes every 6.7 ms: the glove marks it. */
static void records_that_the_glove_calls_late(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--baud", "38400", "--minds-baud"), "baud=38400,rate=150", 22,
          MRT_RIGHT);
}

static void records_that_the_glove_calls_too_fast(void **state)
{
    (void)state;
    check(OPTIONS("--numbered", "--fast-every", "7"), "", 22, MRT_RIGHT);
}

/* Of 60 records 30 come from sensors that are not there: of each such run at most the first is
 * shown, which might be a loose contact. */
static void an_unplugged_glove_is_not_shown(void **state)
{
    (void)state;
    enum { EVERY = 60, RUN = 30 };
    glove_session s;
    glove_truth truth;
    uint32_t gap_count, shown = 0;
    take(&s, &truth, OPTIONS("--numbered", "--unplugged-every", "60", "--unplugged-run", "30"), "",
         TAKEN);
    session_check_values(&s, &truth, 22, &gap_count);
    for (uint32_t i = 0; i < s.count; ++i) {
        int32_t place = glove_motion_number_in(s.channel, &s.sample[i]) % EVERY - (EVERY - RUN);
        shown += place == 0;
        if (place > 0)
            fail_msg("sample %u shows record %d of a run without a glove", i, (int)place);
    }
    print_message("  %u missing, %u shown of runs without a glove\n", gap_count, shown);
    assert_true(gap_count >= RUN - 1);
    glove_truth_finish(&truth);
    session_end(&s);
}

/* ---- the switch at the wrist, as a pedal ---- */

static void the_switch_is_a_pedal(void **state)
{
    (void)state;
    glove_session s;
    glove_truth truth;
    uint32_t down_count = 0, pedal = 0;
    take(&s, &truth, OPTIONS("--numbered", "--switch-ms", "100"), "switch=pedal 1", TAKEN);
    while (pedal < s.channel_count && s.channel[pedal].semantic != MRT_CH_PEDAL)
        ++pedal;
    assert_true(pedal < s.channel_count);
    for (uint32_t i = 1; i < s.count; ++i) { /* the first status alone may be damage */
        int32_t number = glove_motion_number_in(s.channel, &s.sample[i]);
        const glove_truth_row *row = glove_truth_find(&truth, (uint32_t)number);
        assert_non_null(row);
        bool is_down = row->record[row->size - 2] & 2; /* status, bit 1 */
        if ((s.sample[i].value[pedal] > 0.5f) != is_down)
            fail_msg("sample %u: the switch is %s, the pedal not", i, is_down ? "down" : "up");
        down_count += is_down;
    }
    assert_true(down_count > TAKEN / 4 && down_count < TAKEN * 3 / 4);
    glove_truth_finish(&truth);
    session_end(&s);
}

/* ---- damage ---- */

static uint32_t spoiled_between(const glove_session *s, const glove_truth *truth)
{
    int32_t first = glove_motion_number_in(s->channel, &s->sample[0]);
    int32_t last = glove_motion_number_in(s->channel, &s->sample[s->count - 1]);
    uint32_t count = 0;
    for (int32_t number = first; number <= last; ++number) {
        const glove_truth_row *row = glove_truth_find(truth, (uint32_t)number);
        assert_non_null(row);
        count += row->is_spoiled;
    }
    return count;
}

static void check_damage(const char *kinds, const char *every, uint32_t taken, uint32_t least)
{
    glove_session s;
    glove_truth truth;
    uint32_t gap_count;
    take(&s, &truth, OPTIONS("--numbered", "--spoil-every", every, "--spoil-kinds", kinds), "",
         taken);
    session_check_values(&s, &truth, 22, &gap_count);
    uint32_t spoiled = spoiled_between(&s, &truth);
    print_message("  %s: %u of %u spoiled, %u missing\n", kinds, spoiled, s.count + gap_count,
                  gap_count);
    assert_true(spoiled >= least);
    assert_int_equal(gap_count, spoiled);
    glove_truth_finish(&truth);
    session_end(&s);
}

static void one_spoiled_record_in_50_is_lost_alone(void **state)
{
    (void)state;
    check_damage("zero,head,end,lost,twice", "50", 300, 5);
}

static void every_kind_of_damage_costs_its_own_record(void **state)
{
    (void)state;
    static const char *const kinds[] = {"zero", "head", "end", "lost", "twice"};
    for (int i = 0; i < 5; ++i)
        check_damage(kinds[i], "4", 90, 25);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_right_glove_of_22_sensors),
        cmocka_unit_test(a_left_glove_of_18_sensors),
        cmocka_unit_test(a_newer_glove_that_refuses_settings),
        cmocka_unit_test(without_time_stamps),
        cmocka_unit_test(time_stamps_with_bare_flags),
        cmocka_unit_test(time_stamps_that_wrap),
        cmocka_unit_test(polled),
        cmocka_unit_test(bytes_in_pieces),
        cmocka_unit_test(a_glove_that_was_left_streaming),
        cmocka_unit_test(a_slow_line_at_its_own_rate),
        cmocka_unit_test(records_that_the_glove_calls_late),
        cmocka_unit_test(records_that_the_glove_calls_too_fast),
        cmocka_unit_test(an_unplugged_glove_is_not_shown),
        cmocka_unit_test(the_switch_is_a_pedal),
        cmocka_unit_test(one_spoiled_record_in_50_is_lost_alone),
        cmocka_unit_test(every_kind_of_damage_costs_its_own_record),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
