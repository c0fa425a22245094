/* Every message that plugins/osc/README.md documents, as bytes that other software would send: what
 * it gives, and that what is wrong with it is counted, said once and dropped. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "osc_room.h"

#include <math.h>

enum { PEDALS_AT = MRT_ANGLES, WRIST_AT = MRT_ANGLES };
static const int64_t ms_ns = 1000000;

static osc_item pop(osc_room *room)
{
    osc_item item;
    assert_true(osc_listener_pop(&room->listener, &item));
    return item;
}

static void assert_silent(osc_room *room)
{
    osc_item item;
    assert_false(osc_listener_pop(&room->listener, &item));
}

static void angles_come_as_they_were_sent(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    osc_bytes packet = {.size = 0};
    float angle[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle[i] = (float)i * 0.1f - 1.0f;
    osc_bytes_floats(&packet, "/marotte/hand/right/angles", angle, MRT_ANGLES);
    osc_room_take(room, &osc_room_one, &packet);
    osc_item item = pop(room);
    assert_memory_equal(item.value, angle, sizeof angle);
    assert_int_equal(item.step, 1);
    assert_int_equal(item.time_ns, room->now_ns);
    osc_bytes_floats(&packet, "/marotte/hand/left/angles", angle, MRT_ANGLES);
    osc_room_take(room, &osc_room_one, &packet);
    assert_silent(room);
    assert_int_equal(osc_room_faults(room), 0);
    free(room);
}

static void a_joint_message_sets_sensors_from_the_one_named(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_LEFT, OSC_CONTENT_PEDALS);
    osc_bytes packet = {.size = 0};
    osc_bytes_message(&packet, "/marotte/hand/left/joint", "ifdi", 20, 0.5, -0.25, 1);
    osc_room_take(room, &osc_room_one, &packet); /* 20, 21, and one too many */
    assert_silent(room);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_VALUE], 1);
    osc_bytes_message(&packet, "/marotte/hand/left/joint", "ifd", 20, 0.5, -0.25);
    osc_room_take(room, &osc_room_one, &packet);
    osc_item item = pop(room);
    assert_true(item.value[20] == 0.5f && item.value[21] == -0.25f && item.value[19] == 0);
    free(room);
}

static void pedals_are_numbered_from_one(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS_ONLY);
    osc_bytes packet = {.size = 0};
    assert_int_equal(room->listener.table.count, MRT_MAX_PEDALS);
    osc_bytes_message(&packet, "/marotte/pedal", "if", 1, 0.5);
    osc_room_take(room, &osc_room_one, &packet);
    assert_true(pop(room).value[0] == 0.5f);
    osc_bytes_message(&packet, "/marotte/pedal", "iT", 4);
    osc_room_take(room, &osc_room_one, &packet);
    osc_item item = pop(room);
    assert_true(item.value[0] == 0.5f && item.value[3] == 1);
    osc_bytes_message(&packet, "/marotte/pedal", "ii", 1, 0);
    osc_room_take(room, &osc_room_one, &packet);
    assert_true(pop(room).value[0] == 0);
    free(room);
}

static void the_wrist_has_its_place_in_a_hand_that_asks_for_it(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_WRIST);
    osc_bytes packet = {.size = 0};
    static const float wrist[7] = {10, -20, 30.5f, 0, 0.6f, 0, 0.8f};
    osc_bytes_floats(&packet, "/marotte/hand/right/wrist", wrist, 7);
    osc_room_take(room, &osc_room_one, &packet);
    assert_memory_equal(pop(room).value + WRIST_AT, wrist, sizeof wrist);
    const osc_table *table = &room->listener.table;
    assert_int_equal(table->count, 29);
    assert_int_equal(table->channel[WRIST_AT + 3].semantic, MRT_CH_WRIST + 3);
    assert_string_equal(table->channel[WRIST_AT].unit, "mm");
    assert_string_equal(table->channel[4].name, "right.index.mpj");
    assert_string_equal(table->channel[4].unit, "rad");
    free(room);
}

static void put_bone(osc_bytes *packet, const char *name, double radians)
{
    osc_bytes_message(packet, "/VMC/Ext/Bone/Pos", "sfffffff", name, 0.1, 0.0, 0.0, 0.0, 0.0,
                      -sin(radians / 2), cos(radians / 2));
}

static void a_vmc_bone_moves_its_sensor_and_the_rest_of_the_body_none(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    osc_bytes packet = {.size = 0};
    put_bone(&packet, "RightIndexProximal", 1.5707963);
    osc_room_take(room, &osc_room_one, &packet);
    osc_bytes_message(&packet, "/VMC/Ext/OK", "i", 1);
    osc_room_take(room, &osc_room_one, &packet);
    assert_float_equal(pop(room).value[4], 1.5707963f, 1e-6f);
    put_bone(&packet, "Head", 0.7);
    osc_room_take(room, &osc_room_one, &packet);
    osc_bytes_message(&packet, "/VMC/Ext/OK", "i", 1);
    osc_room_take(room, &osc_room_one, &packet);
    osc_bytes_message(&packet, "/VMC/Ext/Blend/Val", "sf", "Joy", 1.0);
    osc_room_take(room, &osc_room_one, &packet);
    assert_silent(room);
    assert_int_equal(osc_room_faults(room), 0);
    free(room);
}

/* A pose is larger than a datagram. */
static void bones_of_several_datagrams_are_one_sample(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    osc_bytes packet = {.size = 0};
    for (int frame = 1; frame <= 3; ++frame) {
        put_bone(&packet, "RightIndexProximal", 0.1 * frame);
        osc_room_take(room, &osc_room_one, &packet);
        room->now_ns += ms_ns;
        put_bone(&packet, "RightLittleDistal", 0.2 * frame);
        osc_room_take(room, &osc_room_one, &packet);
        assert_silent(room);
        osc_bytes_message(&packet, "/VMC/Ext/T", "f", 0.0);
        osc_room_take(room, &osc_room_two, &packet); /* somebody else's says nothing */
        assert_silent(room);
        if (frame == 1)
            osc_bytes_message(&packet, "/VMC/Ext/T", "f", 1.0);
        else
            osc_bytes_message(&packet, "/VMC/Ext/OK", "i", 1);
        osc_room_take(room, &osc_room_one, &packet);
        osc_item item = pop(room);
        assert_float_equal(item.value[4], 0.1f * (float)frame, 1e-6f);
        assert_float_equal(item.value[17], 0.2f * (float)frame, 1e-6f);
        assert_int_equal(item.time_ns, room->now_ns);
        assert_silent(room);
        room->now_ns += 15 * ms_ns;
    }
    /* without a word about its end: when a bone comes again, */
    put_bone(&packet, "RightIndexProximal", 0.5);
    osc_room_take(room, &osc_room_one, &packet);
    put_bone(&packet, "RightIndexDistal", 0.5);
    osc_room_take(room, &osc_room_one, &packet);
    put_bone(&packet, "RightIndexProximal", 0.6);
    osc_room_take(room, &osc_room_one, &packet);
    assert_float_equal(pop(room).value[4], 0.5f, 1e-6f);
    assert_silent(room);
    /* or after 4 ms */
    assert_int_equal(osc_listener_frame_due_ns(&room->listener), room->now_ns + 4 * ms_ns);
    osc_listener_close_frame_if_due(&room->listener, room->now_ns + 4 * ms_ns - 1);
    assert_silent(room);
    osc_listener_close_frame_if_due(&room->listener, room->now_ns + 4 * ms_ns);
    osc_item item = pop(room);
    assert_float_equal(item.value[4], 0.6f, 1e-6f);
    assert_int_equal(item.time_ns, room->now_ns);
    assert_true(osc_listener_frame_due_ns(&room->listener) == INT64_MAX);
    free(room);
}

/* VRM 1's Metacarpal, Proximal, Distal are VRM 0's Proximal, Intermediate, Distal. */
static void both_names_of_a_thumb_are_known(void **state)
{
    (void)state;
    static const char *const name[2][3] = {
        {"RightThumbProximal", "RightThumbIntermediate", "RightThumbDistal"},
        {"RightThumbMetacarpal", "RightThumbProximal", "RightThumbDistal"}};
    osc_item item[2];
    for (int version = 0; version < 2; ++version) {
        osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
        osc_bytes packet = {.size = 0};
        for (int joint = 0; joint < 3; ++joint) {
            osc_bytes_message(&packet, "/VMC/Ext/Bone/Pos", "sfffffff", name[version][joint], 0.0,
                              0.0, 0.0, 0.0, sin(0.1 * (joint + 1)), 0.0, cos(0.1 * (joint + 1)));
            osc_room_take(room, &osc_room_one, &packet);
        }
        osc_bytes_message(&packet, "/VMC/Ext/OK", "i", 1);
        osc_room_take(room, &osc_room_one, &packet);
        item[version] = pop(room);
        assert_silent(room);
        free(room);
    }
    assert_memory_equal(item[0].value, item[1].value, MRT_ANGLES * sizeof(float));
    assert_float_equal(item[0].value[1], 0.4f, 1e-6f);
    assert_float_equal(item[0].value[2], 0.6f, 1e-6f);
}

static void controllers_and_keys_of_vmc_are_channels(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_CONTROLS);
    osc_bytes packet = {.size = 0};
    const osc_table *table = &room->listener.table;
    assert_int_equal(table->count, 58);
    assert_string_equal(table->channel[7].name, "cc.7");
    assert_string_equal(table->channel[32].name, "key.a");
    assert_int_equal(table->channel[57].semantic, MRT_CH_BUTTON);
    osc_bytes_message(&packet, "/VMC/Ext/Midi/CC/Val", "if", 7, 0.5);
    osc_room_take(room, &osc_room_one, &packet);
    assert_float_equal(pop(room).value[7], 0.5f, 0);
    osc_bytes_message(&packet, "/VMC/Ext/Key", "isi", 1, "B", 66);
    osc_room_take(room, &osc_room_one, &packet);
    osc_item item = pop(room);
    assert_float_equal(item.value[33], 1, 0);
    assert_float_equal(item.value[7], 0.5f, 0);
    osc_bytes_message(&packet, "/VMC/Ext/Key", "isi", 0, "B", 66);
    osc_room_take(room, &osc_room_one, &packet);
    assert_float_equal(pop(room).value[33], 0, 0);
    osc_bytes_message(&packet, "/VMC/Ext/Key", "isi", 1, "F12", 123); /* has no channel */
    osc_room_take(room, &osc_room_one, &packet);
    osc_bytes_message(&packet, "/VMC/Ext/Midi/CC/Val", "if", 99, 0.5);
    osc_room_take(room, &osc_room_one, &packet);
    put_bone(&packet, "RightIndexProximal", 0.5); /* is no control */
    osc_room_take(room, &osc_room_one, &packet);
    assert_silent(room);
    assert_int_equal(osc_room_faults(room), 0);
    osc_bytes_message(&packet, "/VMC/Ext/Midi/CC/Val", "if", 7, 1.5);
    osc_room_take(room, &osc_room_one, &packet);
    osc_bytes_message(&packet, "/VMC/Ext/Key", "is", 1, "B");
    osc_room_take(room, &osc_room_one, &packet);
    assert_silent(room);
    assert_int_equal(osc_room_faults(room), 2);
    free(room);
}

/* Two messages in a bundle in a bundle, tagged, then the same 10 ms later but 4 ms late. */
static void a_bundle_is_one_sample_at_its_senders_time(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    int64_t first_ns = room->now_ns;
    for (uint32_t i = 0; i < 2; ++i) {
        osc_bytes inner = {.size = 0}, bundle = {.size = 0}, packet = {.size = 0};
        osc_bytes_message(&inner, "/marotte/pedal", "ii", 2, 1);
        uint64_t fraction = 42949673; /* 10 ms */
        osc_bytes_bundle(&bundle, ((uint64_t)3900000000u << 32) + i * fraction);
        osc_bytes_element(&bundle, &inner);
        inner.size = 0;
        osc_bytes_message(&inner, "/marotte/hand/right/joint", "if", 4, 0.25);
        osc_bytes_element(&bundle, &inner);
        osc_bytes_bundle(&packet, 1);
        osc_bytes_element(&packet, &bundle);
        osc_room_take(room, &osc_room_one, &packet);
        osc_item item = pop(room);
        assert_true(item.value[4] == 0.25f && item.value[PEDALS_AT + 1] == 1);
        assert_true(llabs(item.time_ns - first_ns - (int64_t)i * 10 * ms_ns) < 1000);
        assert_silent(room);
        room->now_ns += 14 * ms_ns;
    }
    free(room);
}

typedef struct wrong {
    const char *address, *types;
    double number[3]; /* for f and i in order */
    osc_fault fault;
} wrong;

static void put_wrong(osc_bytes *packet, const wrong *from)
{
    char tag[64] = ",";
    strcat(tag, from->types);
    osc_bytes_text(packet, from->address);
    osc_bytes_text(packet, tag);
    for (int i = 0; from->types[i]; ++i) {
        if (from->types[i] == 'i')
            osc_bytes_32(packet, (uint32_t)(int32_t)from->number[i % 3]);
        else if (from->types[i] == 'f')
            osc_bytes_float(packet, (float)from->number[i % 3]);
        else if (from->types[i] == 's')
            osc_bytes_text(packet, "RightIndexProximal");
    }
}

static void what_is_wrong_is_counted_and_dropped(void **state)
{
    (void)state;
    static const wrong cases[] = {
        {"/marotte/hand/right/angles", "fff", {0, 0, 0}, OSC_FAULT_TYPES},
        {"/marotte/hand/right/angles", "fffffffffffffffffffffs", {0, 0, 0}, OSC_FAULT_TYPES},
        {"/marotte/hand/right/angles", "ffffffffffffffffffffff", {45, 0, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/right/angles", "ffffffffffffffffffffff", {NAN, 0, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/right/angles", "ffffffffffffffffffffff", {0, INFINITY, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/right/joint", "i", {0}, OSC_FAULT_TYPES},
        {"/marotte/hand/right/joint", "ff", {0, 0}, OSC_FAULT_TYPES},
        {"/marotte/hand/right/joint", "if", {22, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/right/joint", "if", {-1, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/right/wrist", "fff", {0, 0, 0}, OSC_FAULT_TYPES},
        {"/marotte/hand/right/wrist", "fffffff", {0, 0, 0}, OSC_FAULT_VALUE},
        {"/marotte/hand/middle/angles", "f", {0}, OSC_FAULT_ADDRESS},
        {"/marotte/hand/right/toes", "f", {0}, OSC_FAULT_ADDRESS},
        {"/marotte/2/sample", "f", {0}, OSC_FAULT_ADDRESS},
        {"/fader/1", "f", {0}, OSC_FAULT_ADDRESS},
        {"/marotte/pedal", "if", {0, 1}, OSC_FAULT_VALUE},
        {"/marotte/pedal", "if", {5, 1}, OSC_FAULT_VALUE},
        {"/marotte/pedal", "if", {1, 127}, OSC_FAULT_VALUE},
        {"/marotte/pedal", "if", {1, NAN}, OSC_FAULT_VALUE},
        {"/marotte/pedal", "f", {1}, OSC_FAULT_TYPES},
        {"/marotte/1/sample", "s", {0}, OSC_FAULT_TYPES},
        {"/marotte/1/sample", "siihhf", {0}, OSC_FAULT_PACKET}, /* cut short */
        {"/marotte/1/channels", "si", {0, 1}, OSC_FAULT_TYPES},
        {"/marotte/1/channels", "sis", {0, 1}, OSC_FAULT_TYPES},
        {"/marotte/1/end", "i", {1}, OSC_FAULT_TYPES},
        {"/VMC/Ext/Bone/Pos", "sff", {0, 0, 0}, OSC_FAULT_TYPES},
        {"/VMC/Ext/Bone/Pos", "sfffffff", {0, 0, 0}, OSC_FAULT_VALUE},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
        for (int times = 0; times < 3; ++times) {
            osc_bytes packet = {.size = 0};
            put_wrong(&packet, &cases[i]);
            osc_room_take(room, &osc_room_one, &packet);
        }
        if (room->dispatcher.fault_count[cases[i].fault] != 3 || osc_room_faults(room) != 3)
            fail_msg("case %zu, %s: \"%s\"", i, cases[i].address, room->last_text);
        int said = room->said[MRT_LOG_WARNING] + room->said[MRT_LOG_INFO];
        assert_int_equal(said, 1);
        assert_silent(room);
        free(room);
    }
}

static void packets_that_are_no_osc_are_counted(void **state)
{
    (void)state;
    static const struct {
        unsigned char bytes[32];
        size_t size;
    } cases[] = {
        {"", 0},
        {"x", 1},
        {"/abc", 4},
        {"/abc\0\0\0\0", 8},
        {"GET / HTTP/1.1\r\n", 16},
        {"#bundle\0\0\0\0\0\0\0\0\1\0\0\0\7/a\0\0", 24},
        {"#bundle\0\0\0\0\0\0\0\0\1\0\0\0\0/a\0\0", 24},
        {"#bundle\0\0\0\0\0\0\0\0\1\x7f\xff\xff\xfc/a\0", 24},
        {"#bundle\0\0\0\0\0\0\0\0\1\xff\xff\xff\xfc/a\0", 24},
        {"/a\0\0,s\0\0abcd", 12},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
        osc_bytes packet = {.size = 0};
        osc_bytes_raw(&packet, cases[i].bytes, cases[i].size);
        osc_room_take(room, &osc_room_one, &packet);
        if (osc_room_faults(room) != 1)
            fail_msg("case %zu was taken", i);
        assert_silent(room);
        free(room);
    }
}

static void bundles_in_bundles_and_thousands_of_messages_are_absurd(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    osc_bytes *inner = calloc(1, sizeof *inner), *outer = calloc(1, sizeof *outer);
    osc_bytes_message(inner, "/marotte/pedal", "ii", 1, 1);
    for (int depth = 0; depth < 10; ++depth) {
        outer->size = 0;
        osc_bytes_bundle(outer, 1);
        osc_bytes_element(outer, inner);
        *inner = *outer;
    }
    osc_room_take(room, &osc_room_one, outer);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SIZE], 1);
    inner->size = outer->size = 0;
    osc_bytes_message(inner, "/x", "");
    osc_bytes_bundle(outer, 1);
    for (int i = 0; i < 3000; ++i)
        osc_bytes_element(outer, inner);
    osc_room_take(room, &osc_room_one, outer);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SIZE], 2);
    assert_silent(room);
    free(inner);
    free(outer);
    free(room);
}

static void press(osc_room *room, const udp_peer *peer, float value)
{
    osc_bytes packet = {.size = 0};
    osc_bytes_message(&packet, "/marotte/pedal", "if", 1, (double)value);
    osc_room_take(room, peer, &packet);
}

static void of_two_senders_the_first_counts_until_it_is_silent(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    press(room, &osc_room_one, 0.5f);
    press(room, &osc_room_one, 0.5f);
    for (int i = 0; i < 20; ++i) {
        press(room, &osc_room_two, 1);
        room->now_ns += 10 * ms_ns;
        press(room, &osc_room_one, 0.5f);
    }
    osc_item item;
    while (osc_listener_pop(&room->listener, &item))
        assert_true(item.value[PEDALS_AT] == 0.5f);
    assert_int_equal(room->dispatcher.fault_count[OSC_FAULT_SENDER], 20);
    assert_int_equal(room->said[MRT_LOG_WARNING], 1);
    room->now_ns += 1100 * ms_ns;
    press(room, &osc_room_two, 1);
    assert_true(pop(room).value[PEDALS_AT] == 1);
    free(room);
}

/* `oscsend` has another port each time it is called. */
static void programs_that_send_once_do_not_shut_each_other_out(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    for (uint16_t i = 0; i < 20; ++i) {
        udp_peer once = osc_room_one;
        once.port = (uint16_t)(5000 + i);
        press(room, &once, (float)(i % 2));
        assert_true(pop(room).value[PEDALS_AT] == (float)(i % 2));
        room->now_ns += 10 * ms_ns;
    }
    assert_int_equal(osc_room_faults(room), 0);
    free(room);
}

/* Two that alternate from the start: the first to come back has it. */
static void two_streams_from_the_start_do_not_mix(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    for (int i = 0; i < 20; ++i) {
        press(room, i % 2 == 0 ? &osc_room_one : &osc_room_two, (float)(i % 2));
        room->now_ns += 10 * ms_ns;
    }
    osc_item item;
    for (int i = 0; osc_listener_pop(&room->listener, &item); ++i)
        assert_true(i < 2 || item.value[PEDALS_AT] == 0);
    free(room);
}

static void a_full_queue_loses_the_oldest_and_says_so(void **state)
{
    (void)state;
    osc_room *room = osc_room_simple(MRT_RIGHT, OSC_CONTENT_PEDALS);
    for (int i = 0; i < OSC_QUEUE_ITEMS + 10; ++i)
        press(room, &osc_room_one, (float)(i % 2));
    uint32_t steps = 0, items = 0;
    osc_item item;
    while (osc_listener_pop(&room->listener, &item)) {
        steps += item.step;
        items += 1;
    }
    assert_int_equal(items, OSC_QUEUE_ITEMS);
    assert_int_equal(steps, OSC_QUEUE_ITEMS + 10);
    free(room);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(angles_come_as_they_were_sent),
        cmocka_unit_test(a_joint_message_sets_sensors_from_the_one_named),
        cmocka_unit_test(pedals_are_numbered_from_one),
        cmocka_unit_test(the_wrist_has_its_place_in_a_hand_that_asks_for_it),
        cmocka_unit_test(a_vmc_bone_moves_its_sensor_and_the_rest_of_the_body_none),
        cmocka_unit_test(bones_of_several_datagrams_are_one_sample),
        cmocka_unit_test(both_names_of_a_thumb_are_known),
        cmocka_unit_test(controllers_and_keys_of_vmc_are_channels),
        cmocka_unit_test(a_bundle_is_one_sample_at_its_senders_time),
        cmocka_unit_test(what_is_wrong_is_counted_and_dropped),
        cmocka_unit_test(packets_that_are_no_osc_are_counted),
        cmocka_unit_test(bundles_in_bundles_and_thousands_of_messages_are_absurd),
        cmocka_unit_test(of_two_senders_the_first_counts_until_it_is_silent),
        cmocka_unit_test(programs_that_send_once_do_not_shut_each_other_out),
        cmocka_unit_test(two_streams_from_the_start_do_not_mix),
        cmocka_unit_test(a_full_queue_loses_the_oldest_and_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
