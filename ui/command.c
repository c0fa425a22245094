#include "command.h"

#include "base/program.h"
#include "base/text.h"

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

int command_options(const command *self, int argc, char **argv, const struct option *table,
                    command_read_option *read, void *data)
{
    int code = COMMAND_DONE, option;
    opterr = 0;
    optind = 1;
    while (code == COMMAND_DONE && (option = getopt_long(argc, argv, ":", table, NULL)) != -1) {
        if (option == ':')
            code = command_usage(self, "%s needs a value", argv[optind - 1]);
        else if (option == '?')
            code = command_usage(self, "there is no option \"%s\"", argv[optind - 1]);
        else
            code = read(data, self, option, optarg);
    }
    if (code == COMMAND_DONE && optind < argc)
        code = command_usage(self, "\"%s\" is not expected here", argv[optind]);
    return code;
}
