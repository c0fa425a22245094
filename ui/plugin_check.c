/* marotte plugin check: every rule of plugin.h, and what a plugin makes of it. */
#include "base/clock.h"
#include "base/text.h"
#include "check/check.h"
#include "plugin.h"
#include "progress.h"

#include <jansson.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef struct options {
    const char *path;
    check_settings check;
    int64_t seed, repeat;
    bool as_json, lists_rules;
} options;

/* ---- the words ---- */

static bool is_number(const char *word, int64_t low, int64_t *out)
{
    return text_int(text_view_of(word, strlen(word)), out) && *out >= low;
}

/* COMMAND_DONE: understood. */
static int take_option(options *out, const char *name, const char *value)
{
    if (!value)
        return command_usage(&command_plugin, "\"%s\" needs a value, or is not expected", name);
    if (strcmp(name, "--input") == 0)
        out->check.input_address = value;
    else if (strcmp(name, "--output") == 0)
        out->check.output_address = value;
    else if (strcmp(name, "--seed") == 0 && !is_number(value, 0, &out->seed))
        return command_usage(&command_plugin, "--seed %s: expected a whole number from 0", value);
    else if (strcmp(name, "--repeat") == 0 && !is_number(value, 1, &out->repeat))
        return command_usage(&command_plugin, "--repeat %s: expected a whole number from 1", value);
    else if (strcmp(name, "--seed") != 0 && strcmp(name, "--repeat") != 0)
        return command_usage(&command_plugin, "\"%s\" is not expected here", name);
    return COMMAND_DONE;
}

static int take_words(options *out, int argc, char **argv)
{
    int code = COMMAND_DONE;
    for (int i = 1; i < argc && code == COMMAND_DONE; ++i) {
        if (strcmp(argv[i], "--json") == 0)
            out->as_json = true;
        else if (strcmp(argv[i], "--rules") == 0)
            out->lists_rules = true;
        else if (argv[i][0] == '-') {
            code = take_option(out, argv[i], i + 1 < argc ? argv[i + 1] : NULL);
            ++i;
        } else if (out->path)
            return command_usage(&command_plugin, "one plugin at a time: \"%s\" is too many",
                                 argv[i]);
        else
            out->path = argv[i];
    }
    if (code == COMMAND_DONE && !out->path && !out->lists_rules)
        return command_usage(&command_plugin, "say which plugin to check: check FILE.so");
    return code;
}

/* ---- the rules ---- */

static void list_rules(void)
{
    for (int i = 0; i < RULE_COUNT; ++i)
        printf("%-20s %s\n", check_rule_id((check_rule)i), check_rule_says((check_rule)i));
}

static void list_rules_as_json(void)
{
    json_t *all = json_array();
    for (int i = 0; i < RULE_COUNT; ++i)
        json_array_append_new(all, json_pack("{s:s, s:s}", "rule", check_rule_id((check_rule)i),
                                             "says", check_rule_says((check_rule)i)));
    json_dumpf(all, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(all);
}

/* ---- the report ---- */

static const char *verdict_word(check_verdict verdict)
{
    static const char *const words[] = {[CHECK_NOT_CONCERNED] = "",
                                        [CHECK_SKIPPED] = "skipped",
                                        [CHECK_OK] = "ok",
                                        [CHECK_FAILED] = "FAILED"};
    return words[verdict];
}

static void print_finding(check_rule rule, const check_finding *finding, const char *text)
{
    printf("  %-20s %-7s  %s\n", check_rule_id(rule), verdict_word(finding->verdict), text);
    if (finding->verdict == CHECK_FAILED)
        printf("  %-20s %-7s  plugin.h: %s\n", "", "", check_rule_says(rule));
}

static void print_subject(const check_subject *subject)
{
    const char *last = "";
    if (subject->id[0])
        printf("%s\n", subject->id);
    for (int i = 0; i < RULE_COUNT; ++i) {
        const check_finding *finding = &subject->finding[i];
        if (finding->verdict == CHECK_NOT_CONCERNED)
            continue;
        bool is_again = finding->verdict == CHECK_SKIPPED && strcmp(finding->text, last) == 0;
        print_finding((check_rule)i, finding, is_again ? "as above" : finding->text);
        last = finding->text;
    }
}

static void print_report(const options *o, const check_report *report)
{
    printf("%s\n", o->path);
    for (uint32_t i = 0; i <= report->type_count; ++i)
        print_subject(&report->library[i]);
    printf("%u failed, %u ok, %u skipped; %.1f s, seed %" PRId64 "\n", report->failed_count,
           report->ok_count, report->skipped_count, report->wall_s, o->seed);
}

static json_t *subject_to_json(const check_subject *subject)
{
    json_t *rules = json_array();
    for (int i = 0; i < RULE_COUNT; ++i) {
        const check_finding *finding = &subject->finding[i];
        if (finding->verdict == CHECK_NOT_CONCERNED)
            continue;
        json_array_append_new(
            rules,
            json_pack("{s:s, s:s, s:s, s:s}", "rule", check_rule_id((check_rule)i), "verdict",
                      finding->verdict == CHECK_FAILED ? "failed" : verdict_word(finding->verdict),
                      "text", finding->text, "says", check_rule_says((check_rule)i)));
    }
    return json_pack("{s:s, s:o}", "id", subject->id, "rules", rules);
}

static json_t *report_to_json(const options *o, const check_report *report)
{
    json_t *types = json_array();
    for (uint32_t i = 1; i <= report->type_count; ++i)
        json_array_append_new(types, subject_to_json(&report->library[i]));
    return json_pack("{s:s, s:o, s:o, s:i, s:i, s:i, s:f, s:I}", "plugin", o->path, "library",
                     subject_to_json(report->library), "types", types, "failed",
                     (int)report->failed_count, "ok", (int)report->ok_count, "skipped",
                     (int)report->skipped_count, "seconds", report->wall_s, "seed",
                     (json_int_t)o->seed);
}

/* ---- running ---- */

static void show_progress(void *data, uint32_t done, uint32_t count)
{
    progress_show(data, count ? (double)done / (double)count : -1.0, "");
}

static int check_once(options *o, json_t *all)
{
    progress line;
    check_report report;
    error err = {""};
    progress_start(&line, "examining");
    o->check.seed = (uint64_t)o->seed;
    o->check.on_progress = show_progress;
    o->check.data = &line;
    mrt_result result = check_run(&report, o->path, &o->check, &err);
    progress_end(&line);
    if (result < 0)
        return command_failed(&command_plugin, &err);
    bool has_failed = report.failed_count > 0;
    if (all)
        json_array_append_new(all, report_to_json(o, &report));
    else if (o->repeat == 1 || has_failed)
        print_report(o, &report);
    else
        printf("%s: nothing found; %.1f s, seed %" PRId64 "\n", o->path, report.wall_s, o->seed);
    (void)fflush(stdout);
    check_report_finish(&report);
    return has_failed ? COMMAND_FAILED : COMMAND_DONE;
}

static int check_often(options *o, json_t *all)
{
    int code = COMMAND_DONE;
    for (int64_t i = 0; i < o->repeat; ++i, ++o->seed) {
        int one = check_once(o, all);
        code = one == COMMAND_DONE ? code : one;
    }
    return code;
}

/* One report; an array of them when it was examined more than once. */
static void print_json(const json_t *all)
{
    json_dumpf(json_array_size(all) == 1 ? json_array_get(all, 0) : all, stdout, JSON_INDENT(2));
    putchar('\n');
}

int plugin_check_run(int argc, char **argv)
{
    /* Another seed each time, short enough to be typed. */
    options o = {.repeat = 1, .seed = clock_now_ns() / 1000 % 1000000};
    int code = take_words(&o, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (o.lists_rules) {
        if (o.as_json)
            list_rules_as_json();
        else
            list_rules();
        return COMMAND_DONE;
    }
    json_t *all = o.as_json ? json_array() : NULL;
    code = check_often(&o, all);
    if (all && json_array_size(all) > 0)
        print_json(all);
    json_decref(all);
    return code;
}
