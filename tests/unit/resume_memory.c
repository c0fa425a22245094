/* plugins/hands/mapping.h: what a mapping remembers comes back all or none, and only what it may
 * hold. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RESTING, PULLING, PHASES };

typedef struct mind {
    bool is_down[3];
    int phase;
    uint32_t count;
    mrt_vec3 position[2];
    double time_s;
} mind;

static const mind example = {{true, false, true}, PULLING, 4, {{1, -2, 3}, {0, 0.5f, -0.0f}}, 0.1};

static memory_list list_of(mind *m, const char *type, uint32_t version)
{
    return (memory_list){.type = type,
                         .version = version,
                         .parts = {MEMORY_BOOLS(m->is_down), MEMORY_WHOLES(m->phase, PHASES - 1),
                                   MEMORY_WHOLES(m->count, 4), MEMORY_FLOATS(m->position),
                                   MEMORY_DOUBLES(m->time_s)}};
}

enum { ROOM = 256 };

static size_t save(mind *m, unsigned char bytes[ROOM])
{
    memory_list list = list_of(m, "org.test.mind", 1);
    size_t size = memory_save(&list, NULL, 0);
    assert_true(size < ROOM);
    assert_int_equal(memory_save(&list, bytes, ROOM), size);
    return size;
}

static bool load(mind *m, const unsigned char *bytes, size_t size)
{
    memory_list list = list_of(m, "org.test.mind", 1);
    return memory_load(&list, bytes, size);
}

static void what_was_remembered_comes_back_bit_for_bit(void **state)
{
    (void)state;
    unsigned char bytes[ROOM];
    mind m = example, back = {.count = 0};
    size_t size = save(&m, bytes);
    assert_true(load(&back, bytes, size));
    assert_memory_equal(back.is_down, example.is_down, sizeof example.is_down);
    assert_int_equal(back.phase, PULLING);
    assert_int_equal(back.count, 4);
    assert_memory_equal(back.position, example.position, sizeof example.position);
    assert_memory_equal(&back.time_s, &example.time_s, sizeof example.time_s);
}

static void nothing_is_written_where_it_does_not_fit(void **state)
{
    (void)state;
    unsigned char bytes[ROOM];
    mind m = example;
    memory_list list = list_of(&m, "org.test.mind", 1);
    size_t size = memory_save(&list, NULL, 0);
    memset(bytes, 0x5a, sizeof bytes);
    assert_int_equal(memory_save(&list, bytes, size - 1), size);
    for (size_t i = 0; i < sizeof bytes; ++i)
        assert_int_equal(bytes[i], 0x5a);
}

static void every_flipped_bit_and_every_other_length_is_refused(void **state)
{
    (void)state;
    unsigned char bytes[ROOM] = {0};
    mind m = example, back;
    memset(&back, 0x11, sizeof back);
    mind before;
    memcpy(&before, &back, sizeof before);
    size_t size = save(&m, bytes);
    for (size_t at = 0; at < size; ++at)
        for (int bit = 0; bit < 8; ++bit) {
            bytes[at] ^= (unsigned char)(1u << bit);
            assert_false(load(&back, bytes, size));
            bytes[at] ^= (unsigned char)(1u << bit);
        }
    for (size_t other = 0; other < ROOM; ++other)
        assert_true(other == size || !load(&back, bytes, other));
    assert_false(load(&back, NULL, 0));
    assert_memory_equal(&back, &before, sizeof back); /* all or none */
    assert_true(load(&back, bytes, size));
}

static void another_plugin_and_another_version_are_refused(void **state)
{
    (void)state;
    unsigned char bytes[ROOM];
    mind m = example;
    size_t size = save(&m, bytes);
    memory_list other = list_of(&m, "org.test.mine", 1), later = list_of(&m, "org.test.mind", 2);
    assert_false(memory_load(&other, bytes, size));
    assert_false(memory_load(&later, bytes, size));
}

/* Their sum is right: somebody wrote them who knows how. */
static void forged_values_are_refused(void **state)
{
    (void)state;
    mind forged[6];
    for (int i = 0; i < 6; ++i)
        forged[i] = example;
    unsigned char odd = 2;
    memcpy(&forged[0].is_down[1], &odd, 1);
    forged[1].phase = PHASES;
    forged[2].phase = -1;
    forged[3].count = 5;
    forged[4].position[1].y = NAN;
    forged[5].time_s = INFINITY;
    for (int i = 0; i < 6; ++i) {
        unsigned char bytes[ROOM];
        mind back;
        memcpy(&back, &example, sizeof back);
        memory_list loose = {.type = "org.test.mind", .version = 1};
        memory_list strict = list_of(&forged[i], "org.test.mind", 1);
        /* the same parts as bytes that may hold anything */
        for (int k = 0; k < 5; ++k)
            loose.parts[k] = (memory_part){MEMORY_WHOLE, strict.parts[k].at, strict.parts[k].size,
                                           (double)UINT32_MAX};
        loose.parts[0].kind = MEMORY_BOOL;
        assert_int_equal(memory_save(&strict, bytes, sizeof bytes), 0); /* nor are they written */
        if (i == 0)
            continue;
        size_t size = memory_save(&loose, bytes, sizeof bytes);
        assert_true(size > 0);
        assert_false(load(&back, bytes, size));
        assert_memory_equal(&back, &example, sizeof back);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_was_remembered_comes_back_bit_for_bit),
        cmocka_unit_test(nothing_is_written_where_it_does_not_fit),
        cmocka_unit_test(every_flipped_bit_and_every_other_length_is_refused),
        cmocka_unit_test(another_plugin_and_another_version_are_refused),
        cmocka_unit_test(forged_values_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
