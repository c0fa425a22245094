/* What hot reload asks of a library before it takes it: check_quick. And what check_run tells. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "check/check.h"

#include <stdio.h>
#include <string.h>

static const char *broken(const char *name)
{
    static char path[1024];
    snprintf(path, sizeof path, "%s/tests/plugin/%s.so", BUILD_DIR, name);
    return path;
}

static void a_sound_plugin_passes(void **state)
{
    (void)state;
    error err = {""};
    assert_int_equal(check_quick(broken("sound"), &err), MRT_OK);
    assert_string_equal(err.text, "");
}

static void a_refusal_names_the_rule_and_what_was_found(void **state)
{
    (void)state;
    static const struct {
        const char *name, *words;
    } cases[] = {{"library_load", "library.load: "},
                 {"symbol", "library.symbol: "},
                 {"abi", "library.abi: "},
                 {"type_functions", "type.functions: "},
                 {"param", "param.range: \"Gain\""},
                 {"create", "life.create: create() returned NULL: no licence for this machine"},
                 {"mapping_activate", "mapping.activate: "},
                 {"nan", "mapping.finite: frame 3 of a random walk"},
                 {"frame_allocation", "frame.allocation: process() called malloc()"},
                 {"run_crash", "run.crash: "},
                 {"run_hang", "run.hang: more than 1 s of processor time"},
                 {"run_exit", "run.exit: "}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        error err = {""};
        assert_int_equal(check_quick(broken(cases[i].name), &err), MRT_ERR_FORMAT);
        if (!strstr(err.text, cases[i].words))
            fail_msg("%s: \"%s\" lacks \"%s\"", cases[i].name, err.text, cases[i].words);
    }
}

static void a_library_that_is_not_there_is_refused(void **state)
{
    (void)state;
    error err = {""};
    assert_true(check_quick("/nowhere/none.so", &err) < 0);
    assert_non_null(strstr(err.text, "/nowhere/none.so: not a file"));
}

static void every_rule_has_an_id_and_words_of_its_own(void **state)
{
    (void)state;
    for (int i = 0; i < RULE_COUNT; ++i) {
        check_rule found;
        assert_true(check_rule_find(check_rule_id((check_rule)i), &found));
        assert_int_equal(found, i);
        assert_true(strlen(check_rule_text((check_rule)i)) > 10);
        assert_int_not_equal(check_rule_concerns((check_rule)i), 0);
    }
    check_rule none;
    assert_false(check_rule_find("mapping.waldo", &none));
}

static uint32_t progress_calls, progress_last, progress_count;

static void on_progress(void *data, uint32_t done, uint32_t count)
{
    (void)data;
    progress_calls += 1;
    assert_int_equal(done, progress_last + 1);
    progress_last = done;
    progress_count = count;
}

static void a_report_judges_each_concerned_rule_and_counts_them(void **state)
{
    (void)state;
    check_report report;
    error err = {""};
    const check_settings settings = {.seed = 3, .jobs = 3, .on_progress = on_progress};
    assert_int_equal(check_run(&report, broken("sound"), &settings, &err), MRT_OK);
    assert_int_equal(report.type_count, 1);
    assert_string_equal(report.library[1].id, "org.example.broken");
    assert_int_equal(report.failed_count, 0);
    assert_int_equal(report.ok_count, RULE_COUNT);
    assert_int_equal(progress_last, progress_calls);
    assert_int_equal(progress_count, progress_calls);
    assert_int_equal(report.library[0].finding[RULE_LIBRARY_LOAD].verdict, CHECK_OK);
    assert_int_equal(report.library[1].finding[RULE_LIBRARY_LOAD].verdict, CHECK_NOT_CONCERNED);
    check_report_finish(&report);
    check_report_finish(&report);
}

static void what_comes_behind_a_failure_is_skipped_with_its_reason(void **state)
{
    (void)state;
    check_report report;
    error err = {""};
    const check_settings settings = {.seed = 3};
    assert_int_equal(check_run(&report, broken("create"), &settings, &err), MRT_OK);
    assert_int_equal(report.failed_count, 1);
    const check_finding *finding = &report.library[1].finding[RULE_MAPPING_FINITE];
    assert_int_equal(finding->verdict, CHECK_SKIPPED);
    assert_string_equal(finding->text, "not reached: life.create comes first");
    check_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_plugin_passes),
        cmocka_unit_test(a_refusal_names_the_rule_and_what_was_found),
        cmocka_unit_test(a_library_that_is_not_there_is_refused),
        cmocka_unit_test(every_rule_has_an_id_and_words_of_its_own),
        cmocka_unit_test(a_report_judges_each_concerned_rule_and_counts_them),
        cmocka_unit_test(what_comes_behind_a_failure_is_skipped_with_its_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
