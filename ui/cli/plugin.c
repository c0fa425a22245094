/* marotte plugin: lists, checks and creates plugins. */
#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "base/suggest.h"
#include "base/text.h"
#include "check/check.h"
#include "base/json.h"
#include "cli/command.h"
#include "base/installed.h"
#include "stage/mapping/plugins.h"
#include "template_files.h"
#include "cli/terminal.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- plugin list ---- */

/* Writes the kinds of a plugin, such as "input and output". */
static const char *kind_of(const mrt_plugin_type *type, char out[64])
{
    static const char *const kind[][2] = {{MRT_INPUT, "input"},
                                          {MRT_MAPPING, "mapping"},
                                          {MRT_OUTPUT, "output"},
                                          {MRT_FACE_OUTPUT, "face output"}};
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < sizeof kind / sizeof *kind; ++i)
        if (plugin_interface(type, kind[i][0]))
            used +=
                (size_t)snprintf(out + used, 64 - used, "%s%s", used ? " and " : "", kind[i][1]);
    return out;
}

static void print_params(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i) {
        const mrt_param *p = &type->params[i];
        if (p->flags & MRT_PARAM_HIDDEN)
            continue;
        terminal_print("    %-14s %-14s %g .. %g %s%s(%g)  %s\n", p->group, p->name, p->min, p->max,
                       p->unit, p->unit[0] ? " " : "", p->initial, p->help);
        for (size_t k = 0; p->labels && p->labels[k] && (double)k <= p->max - p->min; ++k)
            terminal_print("    %-14s %-14s   %g = %s\n", "", "", p->min + (double)k, p->labels[k]);
    }
}

static void print_list(const plugin_list *list, bool with_params)
{
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        char kind[64];
        if (!plugin_is_offered(type))
            continue;
        terminal_print("%-24s %-16s %-6s %s\n", type->id, kind_of(type, kind), type->version,
                       type->about);
        terminal_print("    from %s\n", list->entry[i].path);
        if (with_params)
            print_params(type);
    }
    for (uint32_t i = 0; i < list->refusal_count; ++i)
        terminal_print("not used: %s: %s\n", list->refusal[i].path, list->refusal[i].reason);
}

static json_t *param_to_json(const mrt_param *p)
{
    json_t *out =
        json_pack("{s:i, s:o, s:o, s:o, s:o, s:f, s:f, s:f}", "id", (int)p->id, "name",
                  json_text(p->name), "group", json_text(p->group), "unit", json_text(p->unit),
                  "help", json_text(p->help), "min", p->min, "max", p->max, "initial", p->initial);
    if (p->labels) {
        json_t *labels = json_array();
        for (size_t k = 0; p->labels[k] && (double)k <= p->max - p->min; ++k)
            json_array_append_new(labels, json_text(p->labels[k]));
        json_object_set_new(out, "labels", labels);
    }
    return out;
}

static void print_list_json(const plugin_list *list)
{
    json_t *plugins = json_array();
    json_t *refused = json_array();
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        char kind[64];
        json_t *params = json_array();
        for (uint32_t k = 0; k < type->param_count; ++k)
            json_array_append_new(params, param_to_json(&type->params[k]));
        json_array_append_new(
            plugins, json_pack("{s:o, s:o, s:s, s:o, s:o, s:o, s:o}", "id", json_text(type->id),
                               "name", json_text(type->name), "kind", kind_of(type, kind),
                               "version", json_text(type->version), "about", json_text(type->about),
                               "path", json_text(list->entry[i].path), "params", params));
    }
    for (uint32_t i = 0; i < list->refusal_count; ++i)
        json_array_append_new(refused,
                              json_pack("{s:o, s:o}", "path", json_text(list->refusal[i].path),
                                        "reason", json_text(list->refusal[i].reason)));
    json_t *all = json_pack("{s:o, s:o}", "plugins", plugins, "refused", refused);
    facts_print_json(all, JSON_INDENT(2));
}

typedef struct list_options {
    bool as_json, with_params;
} list_options;

static const command_option list_option_table[] = {
    {"json", COMMAND_FLAG, .offset = offsetof(list_options, as_json)},
    {"params", COMMAND_FLAG, .offset = offsetof(list_options, with_params)},
    {.name = NULL},
};

static int plugin_list_run(int argc, char **argv)
{
    list_options options = {.as_json = false};
    plugin_list list = {0};
    error err = {""};
    int code = command_options(&options, &command_plugin, list_option_table, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (plugin_list_load(&list, &err) < 0)
        return command_failed(&command_plugin, &err);
    if (options.as_json)
        print_list_json(&list);
    else
        print_list(&list, options.with_params);
    plugin_list_destroy(&list);
    return COMMAND_DONE;
}

/* ---- plugin check ---- */

typedef struct check_options {
    const char *path;
    check_settings check;
    int64_t seed, repeat;
    bool as_json, lists_rules;
} check_options;

/* ---- option values ---- */

/* Reads an integer: --seed from 0, --repeat from 1. */
static int read_whole(void *to, const command *self, const char *name, const char *text)
{
    const int least = strcmp(name, "repeat") == 0;
    return text_int(text_view_of(text, strlen(text)), to) && *(int64_t *)to >= least
               ? COMMAND_DONE
               : command_usage(self, "--%s %s: expected a whole number from %d", name, text, least);
}

#define AT(member) .offset = offsetof(check_options, member)
static const command_option check_option_table[] = {
    {"FILE", COMMAND_WORD, AT(path)},
    {"input", COMMAND_TEXT, AT(check.input_address)},
    {"output", COMMAND_TEXT, AT(check.output_address)},
    {"seed", COMMAND_READ, AT(seed), .read = read_whole},
    {"repeat", COMMAND_READ, AT(repeat), .read = read_whole},
    {"rules", COMMAND_FLAG, AT(lists_rules)},
    {"json", COMMAND_FLAG, AT(as_json)},
    {.name = NULL},
};
#undef AT

/* ---- the rules ---- */

static void list_rules(void)
{
    for (int i = 0; i < RULE_COUNT; ++i)
        terminal_print("%-20s %s\n", check_rule_id((check_rule)i), check_rule_text((check_rule)i));
}

static void list_rules_as_json(void)
{
    json_t *all = json_array();
    for (int i = 0; i < RULE_COUNT; ++i)
        json_array_append_new(all, json_pack("{s:s, s:s}", "rule", check_rule_id((check_rule)i),
                                             "says", check_rule_text((check_rule)i)));
    facts_print_json(all, JSON_INDENT(2));
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
    terminal_print("  %-20s %-7s  %s\n", check_rule_id(rule), verdict_word(finding->verdict), text);
    if (finding->verdict == CHECK_FAILED)
        terminal_print("  %-20s %-7s  plugin.h: %s\n", "", "", check_rule_text(rule));
}

static void print_subject(const check_subject *subject)
{
    const char *last = "";
    if (subject->id[0])
        terminal_print("%s\n", subject->id);
    for (int i = 0; i < RULE_COUNT; ++i) {
        const check_finding *finding = &subject->finding[i];
        if (finding->verdict == CHECK_NOT_CONCERNED)
            continue;
        bool is_again = finding->verdict == CHECK_SKIPPED && strcmp(finding->text, last) == 0;
        print_finding((check_rule)i, finding, is_again ? "as above" : finding->text);
        last = finding->text;
    }
}

static void print_report(const check_options *o, const check_report *report)
{
    terminal_print("%s\n", o->path);
    for (uint32_t i = 0; i <= report->type_count; ++i)
        print_subject(&report->library[i]);
    terminal_print("%u failed, %u ok, %u skipped; %.1f s, seed %" PRId64 "\n", report->failed_count,
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
            json_pack("{s:s, s:s, s:o, s:s}", "rule", check_rule_id((check_rule)i), "verdict",
                      finding->verdict == CHECK_FAILED ? "failed" : verdict_word(finding->verdict),
                      "text", json_text(finding->text), "says", check_rule_text((check_rule)i)));
    }
    return json_pack("{s:o, s:o}", "id", json_text(subject->id), "rules", rules);
}

static json_t *report_to_json(const check_options *o, const check_report *report)
{
    json_t *types = json_array();
    for (uint32_t i = 1; i <= report->type_count; ++i)
        json_array_append_new(types, subject_to_json(&report->library[i]));
    return json_pack("{s:o, s:o, s:o, s:i, s:i, s:i, s:f, s:I}", "plugin", json_text(o->path),
                     "library", subject_to_json(report->library), "types", types, "failed",
                     (int)report->failed_count, "ok", (int)report->ok_count, "skipped",
                     (int)report->skipped_count, "seconds", report->wall_s, "seed",
                     (json_int_t)o->seed);
}

/* ---- running ---- */

static void show_progress(void *data, uint32_t done, uint32_t count)
{
    progress_show(data, count ? (double)done / (double)count : -1.0, "");
}

static int check_once(check_options *o, json_t *all)
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
        terminal_print("%s: nothing found; %.1f s, seed %" PRId64 "\n", o->path, report.wall_s,
                       o->seed);
    (void)fflush(stdout);
    check_report_finish(&report);
    return has_failed ? COMMAND_FAILED : COMMAND_DONE;
}

static int check_often(check_options *o, json_t *all)
{
    int code = COMMAND_DONE;
    for (int64_t i = 0; i < o->repeat; ++i, ++o->seed) {
        int one = check_once(o, all);
        code = one == COMMAND_DONE ? code : one;
    }
    return code;
}

static int plugin_check_run(int argc, char **argv)
{
    /* A different seed for each run, short enough to type. */
    check_options o = {.repeat = 1, .seed = clock_now_ns() / 1000 % 1000000};
    int code = command_options(&o, &command_plugin, check_option_table, argc, argv);
    if (code == COMMAND_DONE && !o.path && !o.lists_rules)
        code =
            command_usage(&command_plugin, "the plugin is missing: marotte plugin check FILE.so");
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
    if (json_array_size(all) > 0) /* one report, or an array if there are several */
        facts_print_json(json_incref(json_array_size(all) == 1 ? json_array_get(all, 0) : all),
                         JSON_INDENT(2));
    json_decref(all);
    return code;
}

/* ---- plugin new ---- */

enum { KINDS = 3 };
typedef struct plugin_kind {
    const char *name;
    const template_file *files; /* TEMPLATE_FILES elements */
    const char *try_it; /* command that tries the plugin: the text before and after its name */
    const char *and_then;
} plugin_kind;
static const plugin_kind kinds[KINDS] = {
    {"mapping", template_mapping, "perform --face puppet --input log:take.csv --map build/",
     ".so --export face.png"},
    {"input", template_input, "perform --face puppet --input build/",
     ".so --map one_hand --export face.png"},
    {"output", template_output,
     "perform --face puppet --input log:take.csv --map one_hand --output build/",
     ".so:127.0.0.1:9200"}};

/* With "org.example." before it, a name of this length fits into one line of the log. */
enum { NAME_MAX_LETTERS = 24 };

static const char placeholder[] = "template_name";

typedef struct new_options {
    const char *name, *parent;
    bool is_kind[KINDS]; /* --mapping, --input, --output */
    const plugin_kind *kind;
} new_options;

/* ---- names ---- */

static const char name_letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

static bool is_word_of_the_language(const char *name)
{
    static const char words[] =
        " alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl "
        "const const_cast constexpr continue decltype default delete do double dynamic_cast else "
        "enum explicit export extern false float for friend goto if inline int long mutable "
        "namespace new noexcept not not_eq nullptr operator or or_eq private protected public "
        "register reinterpret_cast restrict return short signed sizeof static static_assert "
        "static_cast struct switch template this thread_local throw true try typedef typeid "
        "typename union unsigned using virtual void volatile wchar_t while xor xor_eq ";
    char word[NAME_MAX_LETTERS + 3];
    snprintf(word, sizeof word, " %s ", name);
    return strstr(words, word) != NULL;
}

static int check_name(const char *name)
{
    size_t length = strlen(name);
    char shown[80]; /* one line, also for an invalid name */
    text_copy(shown, sizeof shown, text_view_of(name, length));
    bool begins_well = name[0] >= 'a' && name[0] <= 'z';
    if (!begins_well || strspn(name, name_letters) != length || length > NAME_MAX_LETTERS)
        return command_usage(&command_plugin,
                             "new: \"%s\" cannot be a plugin's name. Use lower-case letters, "
                             "digits and _, a letter first, at most %d characters, as in "
                             "slow_jaw",
                             shown, NAME_MAX_LETTERS);
    if (is_word_of_the_language(name))
        return command_usage(&command_plugin,
                             "new: \"%s\" is a word of C or C++: choose another name", name);
    return COMMAND_DONE;
}

/* ---- options ---- */

#define AT(member) .offset = offsetof(new_options, member)
static const command_option new_option_table[] = {
    {"NAME", COMMAND_WORD, AT(name)},        {"mapping", COMMAND_FLAG, AT(is_kind[0])},
    {"input", COMMAND_FLAG, AT(is_kind[1])}, {"output", COMMAND_FLAG, AT(is_kind[2])},
    {"dir", COMMAND_TEXT, AT(parent)},       {.name = NULL},
};
#undef AT

static int read_options(new_options *out, int argc, char **argv)
{
    *out = (new_options){.parent = "."};
    int code = command_options(out, &command_plugin, new_option_table, argc, argv);
    for (int i = 0; i < KINDS && code == COMMAND_DONE; ++i) {
        if (out->is_kind[i] && out->kind)
            code = command_usage(&command_plugin,
                                 "new: choose only one of --mapping, --input and --output");
        if (out->is_kind[i])
            out->kind = &kinds[i];
    }
    if (code != COMMAND_DONE)
        return code;
    if (!out->name)
        return command_usage(&command_plugin, "new: NAME is missing");
    code = check_name(out->name);
    if (code == COMMAND_DONE && !out->kind)
        code = command_usage(&command_plugin, "new: choose --mapping, --input or --output");
    return code;
}

/* ---- files ---- */

/* Returns the text with the plugin's name in place of the placeholder, ended by a 0. NULL: no
 * memory. */
static char *named(const char *text, size_t size, const char *name, size_t *out_size)
{
    size_t name_length = strlen(name), used = 0;
    const size_t held_length = sizeof placeholder - 1;
    /* No name is longer than twice the placeholder. */
    char *out = malloc(2 * size + 1);
    if (!out)
        return NULL;
    for (size_t i = 0; i < size;) {
        if (size - i >= held_length && memcmp(text + i, placeholder, held_length) == 0) {
            memcpy(out + used, name, name_length);
            used += name_length;
            i += held_length;
        } else {
            out[used++] = text[i++];
        }
    }
    out[used] = '\0';
    *out_size = used;
    return out;
}
_Static_assert(NAME_MAX_LETTERS <= 2 * (sizeof placeholder - 1), "named() has room for twice");

static mrt_result path_of(char out[INSTALLED_LENGTH], const new_options *w,
                          const template_file *file, error *err)
{
    size_t size = 0;
    char *name = named(file->name, strlen(file->name), w->name, &size);
    if (!name)
        return error_set(err, MRT_ERR_MEMORY, "new: no memory");
    int length = snprintf(out, INSTALLED_LENGTH, "%s/%s/%s", w->parent, w->name, name);
    free(name);
    if (length < 0 || length >= INSTALLED_LENGTH)
        return error_set(err, MRT_ERR_ARGUMENT, "new: the path of the folder is too long");
    return MRT_OK;
}

static mrt_result write_file(const new_options *w, const template_file *file, error *err)
{
    char path[INSTALLED_LENGTH];
    mrt_result result = path_of(path, w, file, err);
    if (result < 0)
        return result;
    size_t size = 0;
    char *text = named(file->bytes, file->size, w->name, &size);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "new: no memory");
    result = file_write(path, text, size, err);
    free(text);
    return result;
}

static mrt_result make_folder(char out[INSTALLED_LENGTH], const new_options *w, error *err)
{
    int length = snprintf(out, INSTALLED_LENGTH, "%s/%s", w->parent, w->name);
    if (length < 0 || length >= INSTALLED_LENGTH)
        return error_set(err, MRT_ERR_ARGUMENT, "new: the path of the folder is too long");
    mrt_result result = file_make_parent(out, err);
    if (result < 0)
        return result;
    if (mkdir(out, 0777) == 0)
        return MRT_OK;
    if (errno == EEXIST)
        return error_set(err, MRT_ERR_IO,
                         "new: %s exists already. Choose another name, or another --dir", out);
    return error_set(err, MRT_ERR_IO, "new: cannot create the folder %s: %s", out, strerror(errno));
}

static void remove_all(const new_options *w, const char *folder)
{
    error none;
    char path[INSTALLED_LENGTH];
    for (int i = 0; i < TEMPLATE_FILES; ++i)
        if (path_of(path, w, &w->kind->files[i], &none) >= 0)
            unlink(path);
    rmdir(folder);
}

/* Writes all files, or none. */
static mrt_result write_all(const new_options *w, error *err)
{
    char folder[INSTALLED_LENGTH];
    assert(w->kind);
    mrt_result result = make_folder(folder, w, err);
    if (result < 0)
        return result;
    for (int i = 0; i < TEMPLATE_FILES && result >= 0; ++i)
        result = write_file(w, &w->kind->files[i], err);
    if (result < 0)
        remove_all(w, folder);
    return result;
}

/* ---- next steps ---- */

static bool is_on_path(const char *program)
{
    const char *path = getenv("PATH");
    while (path && *path) {
        size_t length = strcspn(path, ":");
        char candidate[INSTALLED_LENGTH];
        int written = snprintf(candidate, sizeof candidate, "%.*s/marotte", (int)length, path);
        char *real = written > 0 && written < INSTALLED_LENGTH && length > 0
                         ? realpath(candidate, NULL)
                         : NULL;
        if (real) { /* the shell would run the first one */
            bool is_it = strcmp(real, program) == 0;
            free(real);
            return is_it;
        }
        path += length + (path[length] == ':');
    }
    return false;
}

static void print_program(void)
{
    char program[INSTALLED_LENGTH];
    if (!installed_program(program) || is_on_path(program))
        fputs("marotte", stdout);
    else
        terminal_print_quoted(program);
}

/* Prints the path of the headers if cmake cannot find it by itself. */
static void print_prefix(void)
{
    char prefix[INSTALLED_LENGTH];
    if (!installed_prefix(prefix)) {
        fputs(" -DMAROTTE_INCLUDE=FOLDER_OF_marotte/plugin.h", stdout);
    } else if (strcmp(prefix, "/usr") != 0 && strcmp(prefix, "/usr/local") != 0) {
        fputs(" -DCMAKE_PREFIX_PATH=", stdout);
        terminal_print_quoted(prefix);
    }
}

static void print_next(const new_options *w)
{
    char folder[INSTALLED_LENGTH];
    snprintf(folder, sizeof folder, "%s/%s", w->parent, w->name);
    const char *shown = strncmp(folder, "./", 2) == 0 ? folder + 2 : folder;
    terminal_print("wrote %s: %s.c is the %s, README.md explains the rest. Next:\n"
                   "  cd ",
                   shown, w->name, w->kind->name);
    terminal_print_quoted(shown);
    fputs(" && cmake -B build", stdout);
    print_prefix();
    fputs(" && cmake --build build\n  ", stdout);
    print_program();
    terminal_print(" plugin check build/%s.so\n  ", w->name);
    print_program();
    terminal_print(" %s%s%s\n", w->kind->try_it, w->name, w->kind->and_then);
}

static int plugin_new_run(int argc, char **argv)
{
    new_options w;
    error err = {""};
    int code = read_options(&w, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (write_all(&w, &err) < 0)
        return command_failed(&command_plugin, &err);
    print_next(&w);
    return COMMAND_DONE;
}

/* ---- the command ---- */

static const command_part parts[] = {
    {"list", "list the plugins", list_option_table, plugin_list_run},
    {"new", "start a new plugin", new_option_table, plugin_new_run},
    {"check", "check a plugin against every rule", check_option_table, plugin_check_run},
};
enum { PART_COUNT = sizeof parts / sizeof parts[0] };

static bool describe(command_part *out, command_option *options, size_t place)
{
    (void)options;
    if (place >= PART_COUNT)
        return false;
    *out = parts[place];
    return true;
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return command_usage(&command_plugin, "choose list, new or check");
    suggest near;
    suggest_begin(&near, argv[1]);
    for (size_t i = 0; i < PART_COUNT; ++i) {
        if (strcmp(argv[1], parts[i].name) == 0)
            return parts[i].run(argc - 1, argv + 1);
        suggest_consider(&near, parts[i].name);
    }
    return command_usage(&command_plugin, "there is no command \"plugin %s\"%s", argv[1],
                         suggest_question(&near).text);
}

const command command_plugin = {
    .name = "plugin",
    .summary = "list plugins, start a new one, check one",
    .help =
        "marotte plugin list [--params] [--json]\n"
        "  Lists the loaded plugins and their files, and the refused ones with the reason.\n"
        "\n"
        "  --params   also their parameters: group, name, range, unit (initial value)\n"
        "  --json     print the list as JSON\n"
        "\n"
        "  marotte loads the plugins of $MAROTTE_PLUGIN_PATH (folders with ':' between them), of\n"
        "  $XDG_DATA_HOME/marotte/plugins, of the installed folder, and beside the program.\n"
        "\n"
        "marotte plugin new NAME --mapping|--input|--output [--dir FOLDER]\n"
        "  Creates a folder NAME with a working plugin in one commented C file, its build file, a\n"
        "  guide, and a recorded hand to try it. Prints the next three commands.\n"
        "\n"
        "  --mapping  a plugin that turns hands into a face\n"
        "  --input    a plugin that provides hands\n"
        "  --output   a plugin that sends a face to another program\n"
        "  --dir      the parent folder (.)\n"
        "\n"
        "marotte plugin check FILE.so [--json] [--rules]\n"
        "                     [--input ADDRESS] [--output ADDRESS] [--seed N] [--repeat N]\n"
        "  Checks a plugin against every rule of <marotte/plugin.h> and explains each violation:\n"
        "  unusual faces and hands, 100 000 random frames, real-time rules, equal bits in a\n"
        "  second run. The plugin runs in separate processes. Exit code 1: it breaks a rule.\n"
        "\n"
        "  --rules    list the rules instead\n"
        "  --input    the address that an input opens (the first one found)\n"
        "  --output   the address that an output sends to (none)\n"
        "  --seed     the seed of the random numbers; repeats an earlier check\n"
        "  --repeat   check N times, each time with the next seed\n"
        "  --json     print the report as JSON\n",
    .examples = "plugin list --params\n"
                "plugin new wave --mapping --dir out\n"
                "plugin check --rules\n",
    .run = run,
    .part = describe,
};
