/* Which instruction set is used: words, refusals, the environment. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/isa.h"

#include <stdlib.h>
#include <string.h>

static void generic_is_always_here(void **state)
{
    (void)state;
    assert_true(isa_is_here(ISA_GENERIC));
    assert_true(isa_is_here(isa_best()));
    assert_false(isa_is_here(ISA_COUNT));
}

static void a_level_has_all_levels_below_it(void **state)
{
    (void)state;
    for (int i = 0; i < ISA_COUNT; ++i)
        assert_int_equal(isa_is_here((isa)i), i <= (int)isa_best());
}

static void nothing_asked_is_the_best(void **state)
{
    (void)state;
    isa which = ISA_COUNT;
    assert_int_equal(isa_choose(&which, NULL, NULL), MRT_OK);
    assert_int_equal(which, isa_best());
    which = ISA_COUNT;
    assert_int_equal(isa_choose(&which, "", NULL), MRT_OK);
    assert_int_equal(which, isa_best());
}

static void names_choose_what_is_here_and_refuse_the_rest(void **state)
{
    (void)state;
    for (int i = 0; i < ISA_COUNT; ++i) {
        isa which = ISA_COUNT;
        error err = {""};
        mrt_result result = isa_choose(&which, isa_name((isa)i), &err);
        if (isa_is_here((isa)i)) {
            assert_int_equal(result, MRT_OK);
            assert_int_equal(which, i);
        } else {
            assert_int_equal(result, MRT_ERR_UNSUPPORTED);
            assert_non_null(strstr(err.text, "this machine has at most"));
            assert_non_null(strstr(err.text, isa_name((isa)i)));
        }
    }
}

static void unknown_words_are_refused_with_those_that_are_known(void **state)
{
    (void)state;
    static const char *const words[] = {"avx2", "V3", "v5", "v", "generic ", "4"};
    for (size_t i = 0; i < sizeof words / sizeof *words; ++i) {
        isa which = ISA_COUNT;
        error err = {""};
        assert_int_equal(isa_choose(&which, words[i], &err), MRT_ERR_ARGUMENT);
        assert_non_null(strstr(err.text, words[i]));
        assert_non_null(strstr(err.text, "generic, v2, v3 or v4"));
        assert_int_equal(which, isa_best());
    }
}

static void the_environment_is_heard(void **state)
{
    (void)state;
    error err = {""};
    setenv("MAROTTE_ISA", "generic", 1);
    assert_int_equal(isa_now(), ISA_GENERIC);
    assert_int_equal(isa_check(&err), MRT_OK);
    setenv("MAROTTE_ISA", "sse9", 1);
    assert_int_equal(isa_now(), isa_best());
    assert_int_equal(isa_check(&err), MRT_ERR_ARGUMENT);
    unsetenv("MAROTTE_ISA");
    assert_int_equal(isa_now(), isa_best());
    assert_int_equal(isa_check(&err), MRT_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(generic_is_always_here),
        cmocka_unit_test(a_level_has_all_levels_below_it),
        cmocka_unit_test(nothing_asked_is_the_best),
        cmocka_unit_test(names_choose_what_is_here_and_refuse_the_rest),
        cmocka_unit_test(unknown_words_are_refused_with_those_that_are_known),
        cmocka_unit_test(the_environment_is_heard),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
