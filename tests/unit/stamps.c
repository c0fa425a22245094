/* Which parts have changed since who looked last. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/stamps.h"

static void create(stamps *s, uint32_t count)
{
    error err = {""};
    if (stamps_create(s, count, &err) < 0)
        fail_msg("%s", err.text);
}

static void a_reader_finds_each_change_once(void **state)
{
    (void)state;
    stamps s;
    stamps_reader first = {.seen = 0}, late = {.seen = 0};
    create(&s, 3);
    assert_true(stamps_is_new(&first, &s, 0) && stamps_is_new(&first, &s, 2));
    stamps_read(&first, &s);
    assert_false(stamps_may_have_changes(&first, &s) || stamps_is_new(&first, &s, 1));
    stamps_begin(&s);
    stamps_mark(&s, 1);
    assert_true(stamps_may_have_changes(&first, &s) && stamps_is_new(&first, &s, 1));
    assert_false(stamps_is_new(&first, &s, 0));
    stamps_read(&first, &s);
    stamps_begin(&s);
    stamps_mark(&s, 2);
    assert_true(!stamps_is_new(&first, &s, 1) && stamps_is_new(&first, &s, 2));
    assert_true(stamps_is_new(&late, &s, 0) && stamps_is_new(&late, &s, 1));
    stamps_destroy(&s);
}

static void another_source_is_new_all_over(void **state)
{
    (void)state;
    stamps a, b;
    stamps_reader reader = {.seen = 0};
    create(&a, 2);
    create(&b, 2);
    for (int i = 0; i < 5; ++i)
        stamps_begin(&a);
    stamps_read(&reader, &a);
    assert_true(stamps_may_have_changes(&reader, &b));
    assert_true(stamps_is_new(&reader, &b, 0) && stamps_is_new(&reader, &b, 1));
    stamps_read(&reader, &b);
    assert_true(stamps_is_new(&reader, &a, 0)); /* and so is the first, when it is back */
    stamps_destroy(&a);
    stamps_destroy(&b);
    create(&a, 2); /* perhaps where the other was */
    stamps_reader of_old = reader;
    assert_true(stamps_is_new(&of_old, &a, 0));
    stamps_destroy(&a);
}

static void a_copy_is_read_like_its_source(void **state)
{
    (void)state;
    stamps s, copy;
    stamps_reader reader = {.seen = 0};
    create(&s, 2);
    create(&copy, 2);
    stamps_read(&reader, &s);
    stamps_begin(&s);
    stamps_mark(&s, 0);
    stamps_copy(&copy, &s);
    assert_true(stamps_is_new(&reader, &copy, 0));
    assert_false(stamps_is_new(&reader, &copy, 1));
    stamps_destroy(&s);
    stamps_destroy(&copy);
    stamps_destroy(&copy);
    stamps_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_reader_finds_each_change_once),
        cmocka_unit_test(another_source_is_new_all_over),
        cmocka_unit_test(a_copy_is_read_like_its_source),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
