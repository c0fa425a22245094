/* core/base/suggest: the names that "Did you mean" offers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/file.h"
#include "base/suggest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void distance_counts_edits(void **state)
{
    (void)state;
    assert_int_equal(suggest_distance("", ""), 0);
    assert_int_equal(suggest_distance("", "log"), 3);
    assert_int_equal(suggest_distance("puppet", "puppet"), 0);
    assert_int_equal(suggest_distance("Puppet", "puppet"), 0);
    assert_int_equal(suggest_distance("pupet", "puppet"), 1);
    assert_int_equal(suggest_distance("pupppet", "puppet"), 1);
    assert_int_equal(suggest_distance("poppet", "puppet"), 1);
    assert_int_equal(suggest_distance("lgo", "log"), 1); /* neighbours that changed places */
    assert_int_equal(suggest_distance("lits", "list"), 1);
    assert_int_equal(suggest_distance("kitten", "sitting"), 3);
    assert_int_equal(suggest_distance("ca", "abc"), 3); /* optimal string alignment */
    char longest[200];
    memset(longest, 'x', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    assert_true(suggest_distance(longest, "x") == UINT32_MAX);
    assert_true(suggest_distance("x", longest) == UINT32_MAX);
}

static const char *nearest(const char *word, const char *const *name)
{
    static suggest near;
    suggest_begin(&near, word);
    for (; *name; ++name)
        suggest_consider(&near, *name);
    return near.best;
}

static void only_a_near_name_is_offered(void **state)
{
    (void)state;
    static const char *const verbs[] = {"list", "show", "trim", "split", "retime", "export", NULL};
    static const char *const maps[] = {"one_hand", "anchored", "unanchored", NULL};
    assert_string_equal(nearest("lits", verbs), "list");
    assert_string_equal(nearest("exprot", verbs), "export");
    assert_string_equal(nearest("spilt", verbs), "split");
    assert_string_equal(nearest("waldo", verbs), "");
    assert_string_equal(nearest("t", verbs), ""); /* one letter says too little */
    assert_string_equal(nearest("", verbs), "");
    assert_string_equal(nearest("onehand", maps), "one_hand");
    assert_string_equal(nearest("Anchored", maps), "anchored");
    assert_string_equal(nearest("anch", maps), "anchored"); /* the beginning of a name */
    assert_string_equal(nearest("unanchord", maps), "unanchored");
}

static void the_question_names_the_best_or_is_empty(void **state)
{
    (void)state;
    suggest near;
    suggest_begin(&near, "moia");
    assert_string_equal(suggest_question(&near).text, "");
    suggest_consider(&near, "puppet");
    assert_string_equal(suggest_question(&near).text, "");
    suggest_consider(&near, "moai");
    assert_string_equal(suggest_question(&near).text, ". Did you mean \"moai\"?");
}

static void a_missing_file_offers_its_neighbour(void **state)
{
    (void)state;
    char folder[] = "/tmp/marotte_suggest_XXXXXX", path[200], expected[300];
    error err = {""};
    file_bytes bytes;
    assert_non_null(mkdtemp(folder));
    (void)snprintf(path, sizeof path, "%s/girl.glb", folder);
    assert_int_equal(file_write(path, "x", 1, &err), MRT_OK);
    (void)snprintf(expected, sizeof expected, ". Did you mean \"%s\"?", path);
    (void)snprintf(path, sizeof path, "%s/gril.glb", folder);
    assert_string_equal(suggest_file(path).text, expected);
    assert_true(file_read(&bytes, path, 100, &err) < 0); /* whoever reads a file offers it */
    assert_non_null(strstr(err.text, expected));
    (void)snprintf(path, sizeof path, "%s/nothing.like.it", folder);
    assert_string_equal(suggest_file(path).text, "");
    assert_true(file_read(&bytes, path, 100, &err) < 0);
    assert_null(strstr(err.text, "Did you mean"));
    (void)snprintf(path, sizeof path, "%s/none/girl.glb", folder);
    assert_string_equal(suggest_file(path).text, "");
    (void)snprintf(path, sizeof path, "%s/girl.glb", folder);
    (void)unlink(path);
    (void)rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distance_counts_edits),
        cmocka_unit_test(only_a_near_name_is_offered),
        cmocka_unit_test(the_question_names_the_best_or_is_empty),
        cmocka_unit_test(a_missing_file_offers_its_neighbour),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
