/* One marotte's samples at another, datagram by datagram on a clock of the test's own: bits,
 * channels and gaps are kept, late and double datagrams are dropped, senders come, go and quarrel.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "osc_room.h"

#include <math.h>

static const int64_t ms_ns = 1000000, sender_epoch_ns = 77000000000;
static const mrt_channel glove[3] = {
    {"right.index.mpj", "count", MRT_CH_ANGLE + 4, MRT_RIGHT, 1, 255},
    {"battery", "mV", MRT_CH_OTHER, MRT_NO_HAND, 0, 9000},
    {"pedal.1", "1", MRT_CH_PEDAL, MRT_NO_HAND, 0, 1},
};

static void set_table(osc_table *out, const char *source, int32_t version)
{
    assert_true(osc_table_set(out, source, version, glove, 3));
}

static void announce(osc_room *room, const udp_peer *peer, const char *source, int32_t version)
{
    osc_table table;
    set_table(&table, source, version);
    osc_bytes packet;
    packet.size = osc_table_write(&table, packet.data, sizeof packet.data);
    assert_true(packet.size > 0);
    osc_room_take(room, peer, &packet);
}

/* Measured and sent at time_ns of the sender. */
static void send_sample(osc_room *room, const udp_peer *peer, const char *source, int32_t version,
                        uint32_t sequence, int64_t time_ns)
{
    osc_table table;
    set_table(&table, source, version);
    mrt_sample sample = {
        .time_ns = time_ns, .sequence = sequence, .count = 3, .value = {(float)sequence, 7400, 1}};
    osc_bytes packet;
    packet.size = osc_table_write_sample(&table, &sample, time_ns, packet.data, sizeof packet.data);
    assert_true(packet.size > 0);
    osc_room_take(room, peer, &packet);
}

static void send_end(osc_room *room, const udp_peer *peer, const char *source)
{
    osc_table table;
    set_table(&table, source, 1);
    osc_bytes packet;
    packet.size = osc_table_write_end(&table, packet.data, sizeof packet.data);
    osc_room_take(room, peer, &packet);
}

/* The next sample's first value is this, its sequence this far ahead. */
static void expect(osc_room *room, float value, uint32_t step)
{
    osc_item item;
    assert_true(osc_listener_pop(&room->listener, &item));
    assert_true(item.value[0] == value);
    assert_int_equal(item.step, step);
}

static void expect_nothing(osc_room *room)
{
    osc_item item;
    assert_false(osc_listener_pop(&room->listener, &item));
}

static void channels_are_told_with_all_that_they_say(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("");
    announce(room, &osc_room_one, "cyberglove ttyUSB0", 1);
    assert_true(osc_table_has(&room->listener.table, glove, 3));
    assert_string_equal(room->listener.bound, "cyberglove ttyUSB0");
    free(room);
}

static void every_bit_of_a_value_arrives(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    static const float value[3] = {-0.0f, 1.17549435e-38f, 3.4028235e38f};
    mrt_sample sample = {.time_ns = 5, .sequence = 0xffffffffu, .count = 3};
    memcpy(sample.value, value, sizeof value);
    osc_table table;
    set_table(&table, "glove", 1);
    osc_bytes packet;
    packet.size = osc_table_write_sample(&table, &sample, 9, packet.data, sizeof packet.data);
    osc_room_take(room, &osc_room_one, &packet);
    osc_item item;
    assert_true(osc_listener_pop(&room->listener, &item));
    assert_memory_equal(item.value, value, sizeof value);
    assert_int_equal(item.time_ns, room->now_ns - 4); /* sent 4 ns after it was measured */
    /* The sequence goes on over the end of 32 bits. */
    send_sample(room, &osc_room_one, "glove", 1, 1, 20);
    expect(room, 1, 2);
    free(room);
}

static void gaps_stay_and_late_and_double_datagrams_go(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    static const uint32_t sent[] = {10, 11, 11, 14, 12, 13, 15, 10, 15};
    for (size_t i = 0; i < sizeof sent / sizeof *sent; ++i) {
        send_sample(room, &osc_room_one, "glove", 1, sent[i],
                    sender_epoch_ns + 10 * ms_ns * sent[i]);
        room->now_ns += 10 * ms_ns;
    }
    expect(room, 10, 1);
    expect(room, 11, 1);
    expect(room, 14, 3);
    expect(room, 15, 1);
    expect_nothing(room);
    assert_int_equal(room->dispatcher.late_count, 3);
    assert_int_equal(room->dispatcher.double_count, 2);
    assert_int_equal(osc_room_faults(room), 0);
    free(room);
}

/* 60 s at 100 Hz; each datagram is up to 5 ms late, one in fifty 40 ms. */
static void times_are_the_senders_whatever_the_network_does(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    int64_t start_ns = room->now_ns;
    uint32_t seed = 7;
    double sum = 0, squares = 0;
    int count = 0;
    for (uint32_t i = 0; i < 6000; ++i) {
        seed = seed * 1664525u + 1013904223u;
        int64_t late_ns = (int64_t)((seed >> 8) % 5000000u) + (i % 50 == 49 ? 40 * ms_ns : 0);
        int64_t true_ns = start_ns + 10 * ms_ns * i;
        room->now_ns = true_ns + late_ns;
        send_sample(room, &osc_room_one, "glove", 1, i, sender_epoch_ns + 10 * ms_ns * i);
        osc_item item;
        assert_true(osc_listener_pop(&room->listener, &item));
        assert_true(item.time_ns <= room->now_ns);
        if (i < 200)
            continue;
        double error_ms = (double)(item.time_ns - true_ns) / 1e6;
        sum += error_ms;
        squares += error_ms * error_ms;
        ++count;
    }
    double sd_ms = sqrt(squares / count - sum / count * (sum / count));
    print_message("time error: mean %.3f ms, sd %.3f ms\n", sum / count, sd_ms);
    assert_true(sd_ms < 0.1);
    free(room);
}

static void samples_before_their_channels_wait_for_them(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    send_sample(room, &osc_room_one, "glove", 1, 1, 0);
    announce(room, &osc_room_one, "glove", 1);
    send_sample(room, &osc_room_one, "glove", 2, 2, 0); /* of channels not yet told */
    expect_nothing(room);
    assert_int_equal(room->dispatcher.untold_count, 2);
    send_sample(room, &osc_room_one, "glove", 1, 3, 0);
    expect(room, 3, 1);
    free(room);
}

static void who_joins_late_has_the_channels_and_the_last_sample(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("pedal");
    announce(room, &osc_room_one, "pedal", 1);
    send_sample(room, &osc_room_one, "pedal", 1, 5, sender_epoch_ns);
    osc_listener *late = calloc(1, sizeof *late);
    osc_listener_start_forwarded(late, "pedal");
    room->now_ns += 100 * ms_ns;
    osc_dispatcher_join(&room->dispatcher, late, room->now_ns);
    assert_true(osc_table_has(&late->table, glove, 3));
    send_sample(room, &osc_room_one, "pedal", 1, 5, sender_epoch_ns); /* said again */
    osc_item item;
    assert_true(osc_listener_pop(late, &item));
    assert_true(item.value[0] == 5);
    expect(room, 5, 1);
    expect_nothing(room); /* the other one has had it */
    osc_dispatcher_leave(&room->dispatcher, late);
    free(late);
    free(room);
}

static void a_name_finds_its_source_and_no_other(void **state)
{
    (void)state;
    static const struct {
        const char *wanted, *source;
        int finds;
    } cases[] = {{"", "anything", 1},
                 {"cyberglove", "cyberglove", 1},
                 {"cyberglove", "cyberglove ttyUSB0", 1},
                 {"cyberglove", "cyberglove2", 0},
                 {"cyberglove ttyUSB0", "cyberglove", 0},
                 {"pedal", "cyberglove", 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        osc_listener *listener = calloc(1, sizeof *listener);
        osc_listener_start_forwarded(listener, cases[i].wanted);
        assert_int_equal(osc_listener_wants(listener, cases[i].source), cases[i].finds);
        free(listener);
    }
}

/* The sender was killed; the new one counts from 0 and has another port. */
static void a_sender_that_starts_again_is_heard_after_a_second(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    send_sample(room, &osc_room_one, "glove", 1, 500, sender_epoch_ns);
    expect(room, 500, 1);
    room->now_ns += 500 * ms_ns;
    announce(room, &osc_room_two, "glove", 1);
    send_sample(room, &osc_room_two, "glove", 1, 0, 0);
    expect_nothing(room);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SENDER], 2);
    assert_int_equal(room->said[MRT_LOG_WARNING], 1);
    room->now_ns += 600 * ms_ns;
    send_sample(room, &osc_room_two, "glove", 1, 1, 0); /* its channels may be others */
    expect_nothing(room);
    announce(room, &osc_room_two, "glove", 1);
    send_sample(room, &osc_room_two, "glove", 1, 2, 0);
    expect(room, 2, 1);
    free(room);
}

static void a_sender_that_says_its_end_is_followed_at_once(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    send_sample(room, &osc_room_one, "glove", 1, 500, sender_epoch_ns);
    send_end(room, &osc_room_two, "glove"); /* not its to end */
    assert_false(room->listener.has_ended);
    send_end(room, &osc_room_one, "glove");
    assert_true(room->listener.has_ended);
    announce(room, &osc_room_two, "glove", 1);
    send_sample(room, &osc_room_two, "glove", 1, 0, 0);
    expect(room, 500, 1);
    osc_item item;
    assert_true(osc_listener_pop(&room->listener, &item));
    assert_int_equal(item.step, 0); /* pedals up */
    expect(room, 0, 1);
    assert_int_equal(osc_room_faults(room), 0);
    free(room);
}

/* The device behind the source came back and counts anew: another version, the same channels. */
static void a_source_that_counts_anew_goes_on(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    send_sample(room, &osc_room_one, "glove", 1, 500, sender_epoch_ns);
    announce(room, &osc_room_one, "glove", 2);
    send_sample(room, &osc_room_one, "glove", 2, 0, sender_epoch_ns + ms_ns);
    expect(room, 500, 1);
    expect(room, 0, 1);
    assert_false(room->listener.has_other_channels);
    free(room);
}

static void other_channels_are_noticed(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    osc_table other;
    assert_true(osc_table_set(&other, "glove", 2, glove, 2));
    osc_bytes packet;
    packet.size = osc_table_write(&other, packet.data, sizeof packet.data);
    osc_room_take(room, &osc_room_one, &packet);
    assert_true(room->listener.has_other_channels);
    assert_int_equal(room->listener.table.count, 3); /* fixed while open */
    osc_dispatcher_leave(&room->dispatcher, &room->listener);
    osc_listener_reset(&room->listener);
    osc_dispatcher_join(&room->dispatcher, &room->listener, room->now_ns);
    assert_int_equal(room->listener.table.count, 2);
    assert_false(room->listener.has_other_channels);
    free(room);
}

static void hundreds_of_sources_do_not_push_out_the_one_that_is_heard(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    for (int i = 0; i < 300; ++i) {
        char name[32];
        snprintf(name, sizeof name, "flood %d", i);
        announce(room, &osc_room_two, name, 1);
    }
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SOURCES], 300 - (OSC_SOURCES_MAX - 1));
    assert_int_equal(room->said[MRT_LOG_WARNING], 1);
    send_sample(room, &osc_room_one, "glove", 1, 1, 0);
    expect(room, 1, 1);
    /* Silent ones make room. */
    room->now_ns += 2000 * ms_ns;
    announce(room, &osc_room_two, "late", 1);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SOURCES], 300 - (OSC_SOURCES_MAX - 1));
    free(room);
}

static void samples_that_cannot_be_are_faults(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    static const struct {
        int64_t time_ns, sent_ns;
        float value;
    } cases[] = {{10, 5, 0}, {0, INT64_MAX, 0}, {INT64_MIN, 0, 0}, {0, 0, NAN}, {0, 0, INFINITY}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        osc_bytes packet = {.size = 0};
        osc_bytes_message(&packet, "/marotte/1/sample", "siihhfff", "glove", 1, 1, cases[i].time_ns,
                          cases[i].sent_ns, (double)cases[i].value, 0.0, 0.0);
        osc_room_take(room, &osc_room_one, &packet);
    }
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_VALUE], 5);
    osc_bytes packet = {.size = 0};
    osc_bytes_message(&packet, "/marotte/1/sample", "siihhff", "glove", 1, 1, (int64_t)0,
                      (int64_t)0, 0.0, 0.0);
    osc_room_take(room, &osc_room_one, &packet);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_TYPES], 1);
    expect_nothing(room);
    free(room);
}

/* Clocks at the ends of what is allowed: no time runs backwards, nothing overflows. */
static void a_senders_clock_may_jump_anywhere(void **state)
{
    (void)state;
    osc_room *room = osc_room_forwarded("glove");
    announce(room, &osc_room_one, "glove", 1);
    static const int64_t clock_ns[] = {0, INT64_C(1) << 61, -(INT64_C(1) << 61), 5,
                                       INT64_C(1) << 61};
    int64_t last_ns = INT64_MIN;
    for (uint32_t i = 0; i < 5; ++i) {
        send_sample(room, &osc_room_one, "glove", 1, i, clock_ns[i]);
        osc_item item;
        assert_true(osc_listener_pop(&room->listener, &item));
        assert_true(item.time_ns >= last_ns && item.time_ns <= room->now_ns);
        last_ns = item.time_ns;
        room->now_ns += 10 * ms_ns;
    }
    free(room);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_are_told_with_all_that_they_say),
        cmocka_unit_test(every_bit_of_a_value_arrives),
        cmocka_unit_test(gaps_stay_and_late_and_double_datagrams_go),
        cmocka_unit_test(times_are_the_senders_whatever_the_network_does),
        cmocka_unit_test(samples_before_their_channels_wait_for_them),
        cmocka_unit_test(who_joins_late_has_the_channels_and_the_last_sample),
        cmocka_unit_test(a_name_finds_its_source_and_no_other),
        cmocka_unit_test(a_sender_that_starts_again_is_heard_after_a_second),
        cmocka_unit_test(a_sender_that_says_its_end_is_followed_at_once),
        cmocka_unit_test(a_source_that_counts_anew_goes_on),
        cmocka_unit_test(other_channels_are_noticed),
        cmocka_unit_test(hundreds_of_sources_do_not_push_out_the_one_that_is_heard),
        cmocka_unit_test(samples_that_cannot_be_are_faults),
        cmocka_unit_test(a_senders_clock_may_jump_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
