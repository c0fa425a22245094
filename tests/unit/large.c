/* Large arrays: aligned, writable to their end, and refused when there is no room. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/large.h"

#include <stdlib.h>
#include <string.h>

static void every_size_is_aligned_and_writable(void **state)
{
    (void)state;
    static const size_t sizes[] = {0, 1, 64, 65, 100000, (8u << 20) - 1, 8u << 20, (11u << 20) + 5};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
        char *array = large_alloc(sizes[i]);
        assert_non_null(array);
        assert_int_equal((uintptr_t)array % LARGE_ALIGNMENT, 0);
        memset(array, 1, sizes[i]);
        large_free(array);
    }
}

static void sizes_that_cannot_be_are_refused(void **state)
{
    (void)state;
    assert_null(large_alloc(SIZE_MAX));
    assert_null(large_alloc(SIZE_MAX - 100));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_size_is_aligned_and_writable),
        cmocka_unit_test(sizes_that_cannot_be_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
