/* The program: finds the command and runs it. Also the functions that all commands share
 * (command.h). */
#include "cli/command.h"

#include "base/installed.h"
#include "base/isa.h"
#include "base/memory.h"
#include "base/pool.h"
#include "base/trace.h"
#include "base/program.h"
#include "base/suggest.h"
#include "base/text.h"
#include "io/mesh_file.h"
#include "stage/mapping/plugins.h"
#include "stream/video.h"

#include <assert.h>
#include <getopt.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SHOWN_WORD = 40, TYPED_MAX = 8192 };

/* ---- the typed command line, and the end of a command ---- */

/* Shortens "log:/a/long/way/plugins/log/hand.csv,end=8" to "log:…/log/hand.csv,end=8". */
static const char *shortened(char *word)
{
    char *end = strrchr(word, '/'), *colon = strchr(word, ':');
    char *path = colon && colon < end ? colon + 1 : word;
    if (strlen(word) <= SHOWN_WORD || !end || end == path)
        return word;
    char *folder = end - 1;
    while (folder > path && *folder != '/')
        --folder;
    if (folder - path < 4)
        return word; /* too short to be worth it */
    static const char ellipsis[] = "…";
    memcpy(path, ellipsis, sizeof ellipsis - 1);
    memmove(path + sizeof ellipsis - 1, folder, strlen(folder) + 1);
    return word;
}

static bool is_plain(const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_-./:=,+%@…";
    return word[0] != '\0' && word[strspn(word, plain)] == '\0';
}

void command_line_text(char *out, size_t capacity)
{
    char line[TYPED_MAX];
    FILE *stream = fopen("/proc/self/cmdline", "re");
    size_t size = stream ? fread(line, 1, sizeof line - 1, stream) : 0, used = 0;
    if (stream)
        fclose(stream);
    line[size] = '\0';
    out[0] = '\0';
    bool is_written = false; /* the next word is an output file: its folder is left out */
    for (char *word = line; word < line + size && used < capacity;) {
        char *next = word + strlen(word) + 1, quoted[TYPED_MAX];
        const char *slash = is_written ? strrchr(word, '/') : NULL;
        bool has_file = slash && slash[1] != '\0';
        const char *shown = word == line ? "marotte" : has_file ? slash + 1 : shortened(word);
        is_written = strcmp(word, "--export") == 0 || strcmp(word, "--out") == 0;
        if (!is_plain(shown)) {
            program_quote(quoted, sizeof quoted, shown);
            shown = quoted;
        }
        used += (size_t)snprintf(out + used, capacity - used, "%s%s", used ? " " : "", shown);
        word = next;
    }
}

void command_print_examples(const char *lines)
{
    fputs("\nExamples:\n", stdout);
    while (lines[0]) {
        const int length = (int)strcspn(lines, "\n");
        printf("  marotte%s%.*s\n", length ? " " : "", length, lines);
        lines += length + (lines[length] == '\n');
    }
}

int command_usage(const command *self, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_printable(text);
    fprintf(stderr, "marotte %s: %s (marotte %s --help)\n", self->name, text, self->name);
    return COMMAND_USAGE;
}

int command_failed(const command *self, const error *err)
{
    fprintf(stderr, "marotte %s: %s\n", self->name, err->text);
    return COMMAND_FAILED;
}

int command_end(const command *self, facts *told, mrt_result result, const error *err)
{
    if (result < 0) {
        facts_abandon(told);
        return command_failed(self, err);
    }
    facts_finish(told);
    return COMMAND_DONE;
}

/* ---- options ---- */

enum { OPTION_FIRST = 256 }; /* value that getopt_long returns for the first row */

static void list_options(struct option out[COMMAND_OPTIONS_MAX], const command_option *table)
{
    size_t count = 0;
    for (int row = 0; table[row].name; ++row) {
        const command_option_kind kind = table[row].kind;
        const bool has_value = kind != COMMAND_FLAG && kind != COMMAND_GIVEN;
        if (kind == COMMAND_WORD)
            continue;
        assert(count < COMMAND_OPTIONS_MAX - 1);
        out[count++] = (struct option){table[row].name, has_value ? required_argument : no_argument,
                                       NULL, OPTION_FIRST + row};
    }
    out[count] = (struct option){NULL, 0, NULL, 0};
}

static int read_number(const command *self, const command_option *which, const char *text,
                       double *out)
{
    if (text_double(text_view_of(text, strlen(text)), out) && *out >= which->least &&
        *out <= which->most)
        return COMMAND_DONE;
    return command_usage(self, "--%s \"%s\" is not a number from %g to %g", which->name, text,
                         which->least, which->most);
}

static int set_option(void *options, const command *self, const command_option *which,
                      const char *text)
{
    void *to = (char *)options + which->offset;
    double number = 0.0;
    int code = COMMAND_DONE;
    switch (which->kind) {
    case COMMAND_FLAG:
        *(bool *)to = true;
        break;
    case COMMAND_GIVEN:
        *(const char **)to = "";
        break;
    case COMMAND_TEXT:
        *(const char **)to = text;
        break;
    case COMMAND_NUMBER:
        return read_number(self, which, text, to);
    case COMMAND_WHOLE:
        code = read_number(self, which, text, &number);
        if (code == COMMAND_DONE && number - floor(number) > 0.0)
            code = command_usage(self, "--%s \"%s\" is not a whole number", which->name, text);
        if (code == COMMAND_DONE)
            *(uint32_t *)to = (uint32_t)number;
        break;
    case COMMAND_READ:
        return which->read(to, self, which->name, text);
    case COMMAND_WORD:
        if (which->read)
            return which->read(to, self, which->name, text);
        *(const char **)to = text;
        break;
    }
    return code;
}

/* Stores the words without dashes in the rows of COMMAND_WORD, in order. */
static int set_words(void *options, const command *self, const command_option *table, int count,
                     char **word)
{
    int code = COMMAND_DONE;
    const command_option *row = table;
    for (int i = 0; i < count && code == COMMAND_DONE; ++i, ++row) {
        while (row->name && row->kind != COMMAND_WORD)
            ++row;
        if (!row->name)
            return command_usage(self, "unexpected argument \"%s\"", word[i]);
        code = set_option(options, self, row, word[i]);
    }
    return code;
}

/* Reports an unknown option such as "--fsp=3", and suggests a similar one from the table. */
static int no_such_option(const command *self, const command_option *table, const char *typed)
{
    char word[64], name[64];
    suggest near;
    (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(typed, "="), typed);
    suggest_begin(&near, word);
    for (; table->name; ++table) {
        (void)snprintf(name, sizeof name, "--%s", table->name);
        if (table->kind != COMMAND_WORD)
            suggest_consider(&near, name);
    }
    return command_usage(self, "there is no option \"%s\"%s", typed, suggest_question(&near).text);
}

int command_options(void *options, const command *self, const command_option *table, int argc,
                    char **argv)
{
    struct option known[COMMAND_OPTIONS_MAX];
    int code = COMMAND_DONE, option;
    list_options(known, table);
    opterr = 0;
    optind = 1;
    while (code == COMMAND_DONE && (option = getopt_long(argc, argv, ":", known, NULL)) != -1) {
        if (option == ':')
            code = command_usage(self, "%s needs a value", argv[optind - 1]);
        else if (option == '?')
            code = no_such_option(self, table, argv[optind - 1]);
        else
            code = set_option(options, self, &table[option - OPTION_FIRST], optarg);
    }
    return code == COMMAND_DONE ? set_words(options, self, table, argc - optind, argv + optind)
                                : code;
}

/* ---- readers of option values that several commands use ---- */

int command_read_unit(void *to_mm, const command *self, const char *name, const char *text)
{
    return mesh_unit_parse(to_mm, text)
               ? COMMAND_DONE
               : command_usage(self, "--%s \"%s\" is not mm, cm, m or a number of mm", name, text);
}

int command_read_axis(void *to, const command *self, const char *name, const char *text)
{
    return mesh_axis_parse(to, text)
               ? COMMAND_DONE
               : command_usage(self, "--%s \"%s\" is not x, y, z, -x, -y or -z", name, text);
}

int command_read_face(void *to, const command *self, const char *name, const char *text)
{
    char **path = to;
    if (*path)
        return command_usage(self, "--%s is given twice", name);
    *path = installed_path(INSTALLED_FACE, text);
    return *path ? COMMAND_DONE : command_failed(self, &(error){"no memory"});
}

int command_read_spec(void *to, const command *self, const char *name, const char *text)
{
    plugin_spec *spec = to;
    if (spec->plugin)
        return command_usage(self, "--%s is given twice", name);
    return plugin_spec_read(spec, text)
               ? COMMAND_DONE
               : command_usage(self, "--%s \"%s\" is not PLUGIN[:ADDRESS][,key=value]", name, text);
}

int command_read_look(void *to, const command *self, const char *name, const char *text)
{
    const char *possible = video_look_read(to, name, text);
    return possible ? command_usage(self, "--%s \"%s\" is not %s", name, text, possible)
                    : COMMAND_DONE;
}

/* ---- the program ---- */

static const command *const commands[] = {&command_stage,     &command_perform, &command_camera,
                                          &command_calibrate, &command_devices, &command_deform,
                                          &command_plugin,    &command_rig,     &command_take,
                                          &command_bench,     &command_paper};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_help(void)
{
    fputs(
        "marotte " MAROTTE_VERSION ": perform a face with your hands\n\n"
        "  marotte [FILE] [OPTIONS]       opens the stage, a window; FILE is a show (.marotte), a\n"
        "                                 face (.rig.json .glb .vrm .obj ...) or a recording\n"
        "  marotte COMMAND [OPTIONS]      runs a command without a window\n"
        "  marotte help COMMAND           explains a command; the same as marotte COMMAND --help\n"
        "  marotte help --options         lists the options of all commands, for other programs\n"
        "  marotte --version\n\n"
        "Commands:\n",
        stdout);
    for (int i = 0; i < COMMAND_COUNT; ++i)
        printf("  %-10s %s\n", commands[i]->name, commands[i]->summary);
    fputs("\nExit codes: 0 done, 1 failed, 2 wrong usage.\n", stdout);
    command_print_examples("\n"
                           "girl.glb\n"
                           "perform --face puppet --input log:demo --map one_hand --export "
                           "out/puppet.glb\n"
                           "help take export\n");
}

static bool asks_for_help(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; ++i)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return true;
    return false;
}

/* Returns failure if stdout could not be written, for example to a full disk. */
static int flushed(int code)
{
    bool failed = ferror(stdout) != 0;
    failed |= fflush(stdout) != 0;
    if (!failed || code != COMMAND_DONE)
        return code;
    fputs("marotte: the output could not be written\n", stderr);
    return COMMAND_FAILED;
}

static int show_help(const command *self, int argc, char **argv)
{
    int code = COMMAND_DONE;
    if (self->print_help)
        code = self->print_help(argc, argv);
    else
        fputs(self->help, stdout);
    if (self->more_help)
        fputs(self->more_help, stdout);
    if (self->examples && code == COMMAND_DONE)
        command_print_examples(self->examples);
    return flushed(code);
}

static int start(const command *self, int argc, char **argv)
{
    return asks_for_help(argc, argv) ? show_help(self, argc, argv) : flushed(self->run(argc, argv));
}

static const command *find_command(const char *name)
{
    for (int i = 0; i < COMMAND_COUNT; ++i)
        if (strcmp(name, commands[i]->name) == 0)
            return commands[i];
    return NULL;
}

/* Reports a word that is neither a command nor a file that can be opened. */
static int refuse(const char *word, const char *expected)
{
    char text[512];
    suggest near;
    suggest_begin(&near, word);
    suggest_consider(&near, "help");
    for (int i = 0; i < COMMAND_COUNT; ++i)
        suggest_consider(&near, commands[i]->name);
    suggest_text question = suggest_question(&near);
    if (!near.best[0])
        question = suggest_file(word);
    if (access(word, F_OK) == 0)
        (void)snprintf(text, sizeof text,
                       "cannot open \"%s\": not a show, face, recording, sound or picture", word);
    else
        (void)snprintf(text, sizeof text, "there is no %s \"%s\"%s", expected, word, question.text);
    text_make_printable(text);
    fprintf(stderr, "marotte: %s (marotte --help)\n", text);
    return COMMAND_USAGE;
}

/* Prints the name and the summary of a command, then each option: "--fps", and what follows it. */
static void list_command(const char *name, const command_part *about)
{
    static const char *const follows[] = {
        [COMMAND_FLAG] = "nothing",  [COMMAND_GIVEN] = "nothing", [COMMAND_TEXT] = "value",
        [COMMAND_NUMBER] = "number", [COMMAND_WHOLE] = "number",  [COMMAND_READ] = "value"};
    printf("%s%s%s\t%s\n", name, about->name[0] ? " " : "", about->name, about->summary);
    for (const command_option *o = about->options; o && o->name; ++o)
        if (o->kind != COMMAND_WORD)
            printf("\t--%s\t%s\n", o->name, follows[o->kind]);
}

/* The subcommands of a command follow it. */
static int list_all(void)
{
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        const command *self = commands[i];
        command_part part = {"", self->summary, self->options, NULL};
        command_option table[COMMAND_OPTIONS_MAX];
        list_command(self->name, &part);
        for (size_t place = 0; self->part && self->part(&part, table, place); ++place)
            list_command(self->name, &part);
    }
    return flushed(COMMAND_DONE);
}

/* "help", "help perform", "help take trim", "help --options". */
static int help(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "--options") == 0)
        return list_all();
    const command *about = argc > 1 ? find_command(argv[1]) : NULL;
    if (about)
        return show_help(about, argc - 1, argv + 1);
    if (argc > 1)
        return refuse(argv[1], "command");
    print_help();
    return flushed(COMMAND_DONE);
}

int main(int argc, char **argv)
{
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a write beyond the file size limit then fails with an error */
    memory_set_up();
    error err = {""};
    if (isa_check(&err) < 0 || pool_check(&err) < 0 || trace_start(&err) < 0) {
        fprintf(stderr, "marotte: %s\n", err.text);
        return COMMAND_USAGE;
    }
    if (argc < 2)
        return start(&command_stage, argc, argv);
    const char *name = argv[1];
    if (strcmp(name, "help") == 0)
        return help(argc - 1, argv + 1);
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0)
        return help(1, argv);
    if (strcmp(name, "--version") == 0) {
        puts("marotte " MAROTTE_VERSION);
        return flushed(COMMAND_DONE);
    }
    const command *named = find_command(name);
    if (named)
        return start(named, argc - 1, argv + 1);
    if (stage_accepts_argument(name))
        return start(&command_stage, argc, argv);
    return refuse(name, "command or file");
}
