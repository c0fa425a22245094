/* perform/frame_inputs.h: mappings see all channels, in their own process too. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/mapping/isolate_wire.h"
#include "stage/perform/frame_inputs.h"
#include "stage/perform/pointer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const mrt_channel faders[2] = {{"fader 1", "", MRT_CH_OTHER, MRT_NO_HAND, 0, 1},
                                      {"pitch", "", MRT_CH_OTHER, MRT_NO_HAND, -1, 1}};

static void give(frame_inputs *to, const channel_route *route, int64_t time_ns, float first)
{
    mrt_sample sample = {.time_ns = time_ns, .count = route->table.count, .value = {first, 0.5f}};
    const sample_step s = sample_step_of(route, &sample);
    frame_inputs_read(to, &s, time_ns);
}

static channel_route *route_of(const char *name, const mrt_channel *channel, uint32_t count)
{
    channel_route *out = calloc(1, sizeof *out);
    assert_non_null(out);
    channel_route_init(out, channel, count);
    channel_route_call(out, name);
    return out;
}

static frame_inputs *none(void)
{
    frame_inputs *out = calloc(1, sizeof *out);
    assert_non_null(out);
    return out;
}

static void an_input_is_seen_from_its_first_sample_on(void **state)
{
    (void)state;
    frame_inputs *all = none();
    channel_route *box = route_of("midi box", faders, 2), *pad = route_of("gamepad 1", faders, 2);
    assert_int_equal(all->count, 0);
    give(all, box, 5, 0.25f);
    give(all, pad, 6, 0.75f);
    give(all, box, 7, 0.3f);
    assert_int_equal(all->count, 2);
    assert_string_equal(all->shown[0].name, "midi box");
    assert_int_equal(all->shown[0].time_ns, 7);
    assert_int_equal(all->shown[0].count, 2);
    assert_string_equal(all->shown[0].channel[1].name, "pitch");
    assert_float_equal(all->shown[0].value[0], 0.3f, 0);
    assert_float_equal(all->shown[1].value[0], 0.75f, 0);
    free(box); /* what is shown stays */
    assert_string_equal(all->shown[0].channel[0].name, "fader 1");
    free(pad);
    free(all);
}

static void a_restarted_input_has_its_new_channels(void **state)
{
    (void)state;
    frame_inputs *all = none();
    channel_route *box = route_of("midi box", faders, 2);
    give(all, box, 1, 0.5f);
    channel_route_init(box, faders + 1, 1);
    channel_route_call(box, "midi box");
    give(all, box, 2, -0.5f);
    assert_int_equal(all->count, 1);
    assert_int_equal(all->shown[0].count, 1);
    assert_string_equal(all->shown[0].channel[0].name, "pitch");
    free(box);
    free(all);
}

static void the_pointer_is_no_input(void **state)
{
    (void)state;
    frame_inputs *all = none();
    uint32_t count = 0;
    const mrt_channel *channel = pointer_channels(&count);
    channel_route *finger = route_of("pointer", channel, count);
    give(all, finger, 1, 0.0f);
    assert_int_equal(all->count, 0);
    free(finger);
    free(all);
}

static void the_longest_silent_makes_room(void **state)
{
    (void)state;
    frame_inputs *all = none();
    for (int i = 0; i <= MRT_MAX_INPUTS; ++i) {
        char name[32];
        (void)snprintf(name, sizeof name, "midi %d", i);
        channel_route *box = route_of(name, faders, 2);
        give(all, box, i, (float)i);
        if (i == MRT_MAX_INPUTS - 1) { /* the first speaks again: the second is the oldest */
            channel_route *first = route_of("midi 0", faders, 2);
            give(all, first, i, 0.5f);
            free(first);
        }
        free(box);
    }
    assert_int_equal(all->count, MRT_MAX_INPUTS);
    assert_string_equal(all->shown[0].name, "midi 0");
    assert_string_equal(all->shown[1].name, "midi 8");
    free(all);
}

static size_t save_two(unsigned char *bytes, size_t capacity)
{
    frame_inputs *all = none();
    channel_route *box = route_of("midi box", faders, 2), *unnamed = route_of("", faders + 1, 1);
    give(all, box, 5, 0.25f);
    give(all, unnamed, 6, -0.75f);
    size_t size = frame_inputs_save(all, bytes, capacity);
    free(box);
    free(unnamed);
    free(all);
    return size;
}

static void what_is_kept_is_shown_again(void **state)
{
    (void)state;
    unsigned char bytes[1024], again[1024];
    size_t size = save_two(bytes, sizeof bytes);
    assert_in_range(size, 1, sizeof bytes);
    frame_inputs *all = none();
    assert_true(frame_inputs_load(all, bytes, size));
    assert_int_equal(all->count, 2);
    assert_string_equal(all->shown[0].channel[1].name, "pitch");
    assert_float_equal(all->shown[1].value[0], -0.75f, 0);
    assert_int_equal(frame_inputs_save(all, again, sizeof again), size);
    assert_memory_equal(bytes, again, size);
    frame_inputs_shift_time(all, 100);
    assert_int_equal(all->shown[1].time_ns, 106);
    free(all);
}

/* Whatever byte is damaged: refused, or taken as finite values within their arrays. */
static void damaged_bytes_do_no_harm(void **state)
{
    (void)state;
    unsigned char bytes[1024], damaged[1024];
    size_t size = save_two(bytes, sizeof bytes);
    frame_inputs *all = none();
    for (size_t cut = 0; cut < size; ++cut)
        assert_false(frame_inputs_load(all, bytes, cut));
    for (size_t i = 0; i < 8 * size; ++i) {
        memcpy(damaged, bytes, size);
        damaged[i / 8] ^= (unsigned char)(1u << i % 8);
        if (!frame_inputs_load(all, damaged, size))
            continue;
        assert_in_range(all->count, 0, MRT_MAX_INPUTS);
        for (uint32_t k = 0; k < all->count; ++k) {
            assert_in_range(all->shown[k].count, 1, MRT_MAX_CHANNELS);
            assert_in_range(strlen(all->shown[k].name), 0, ROUTE_NAME - 1);
        }
    }
    free(all);
}

static void a_process_of_its_own_sees_the_same(void **state)
{
    (void)state;
    frame_inputs *all = none();
    channel_route *box = route_of("midi box", faders, 2), *pad = route_of("gamepad 1", faders, 2);
    isolate_block *block = calloc(1, sizeof *block);
    mrt_channels seen[MRT_MAX_INPUTS];
    assert_non_null(block);
    give(all, box, 5, 0.25f);
    give(all, pad, 6, 0.75f);
    block->frame = (mrt_frame){.inputs = all->shown, .input_count = all->count};
    isolate_inputs_write(block, &block->frame);
    free(all);
    isolate_inputs_read(block, seen);
    assert_int_equal(block->frame.input_count, 2);
    assert_string_equal(block->frame.inputs[1].name, "gamepad 1");
    assert_string_equal(block->frame.inputs[1].channel[1].name, "pitch");
    assert_float_equal(block->frame.inputs[1].value[0], 0.75f, 0);
    assert_float_equal(block->frame.inputs[0].channel[1].min, -1.0f, 0);
    assert_int_equal(block->frame.inputs[0].time_ns, 5);
    free(block);
    free(box);
    free(pad);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_input_is_seen_from_its_first_sample_on),
        cmocka_unit_test(a_restarted_input_has_its_new_channels),
        cmocka_unit_test(the_pointer_is_no_input),
        cmocka_unit_test(the_longest_silent_makes_room),
        cmocka_unit_test(what_is_kept_is_shown_again),
        cmocka_unit_test(damaged_bytes_do_no_harm),
        cmocka_unit_test(a_process_of_its_own_sees_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
