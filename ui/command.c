#include "command.h"

#include "base/program.h"
#include "base/text.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN_WORD = 40, TYPED_MAX = 8192 };

/* "log:/a/long/way/plugins/log/hand.csv,end=8" becomes "log:…/log/hand.csv,end=8". */
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
        return word; /* what would be gained is less than it hides */
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

void command_typed(char *out, size_t capacity)
{
    char line[TYPED_MAX];
    FILE *stream = fopen("/proc/self/cmdline", "re");
    size_t size = stream ? fread(line, 1, sizeof line - 1, stream) : 0, used = 0;
    if (stream)
        fclose(stream);
    line[size] = '\0';
    out[0] = '\0';
    bool is_written = false; /* a file that is written: where it lies is no part of how */
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

void command_options_list(struct option out[COMMAND_OPTIONS_MAX], const command_option *table)
{
    int count = 0;
    for (; table[count].name; ++count) {
        assert(count < COMMAND_OPTIONS_MAX - 1);
        int has_value = table[count].kind == COMMAND_FLAG ? no_argument : required_argument;
        out[count] =
            (struct option){table[count].name, has_value, NULL, COMMAND_OPTION_FIRST + count};
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

int command_option_put(void *options, const command *self, const command_option *which,
                       const char *text)
{
    void *to = (char *)options + which->offset;
    double number = 0.0;
    int code = COMMAND_DONE;
    switch (which->kind) {
    case COMMAND_FLAG:
        *(bool *)to = true;
        break;
    case COMMAND_TEXT:
        *(const char **)to = text;
        break;
    case COMMAND_NUMBER:
        return read_number(self, which, text, to);
    case COMMAND_WHOLE:
        code = read_number(self, which, text, &number);
        if (code == COMMAND_DONE)
            *(uint32_t *)to = (uint32_t)number;
        break;
    case COMMAND_READ:
        return which->read(to, self, which->name, text);
    }
    return code;
}

int command_options(void *options, const command *self, const command_option *table, int argc,
                    char **argv)
{
    struct option known[COMMAND_OPTIONS_MAX];
    int code = COMMAND_DONE, option;
    command_options_list(known, table);
    opterr = 0;
    optind = 1;
    while (code == COMMAND_DONE && (option = getopt_long(argc, argv, ":", known, NULL)) != -1) {
        if (option == ':')
            code = command_usage(self, "%s needs a value", argv[optind - 1]);
        else if (option == '?')
            code = command_usage(self, "there is no option \"%s\"", argv[optind - 1]);
        else
            code = command_option_put(options, self, &table[option - COMMAND_OPTION_FIRST], optarg);
    }
    if (code == COMMAND_DONE && optind < argc)
        code = command_usage(self, "\"%s\" is not expected here", argv[optind]);
    return code;
}
