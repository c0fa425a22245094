#include "show/export_name.h"

#include <stdio.h>
#include <string.h>

static const char pattern_words[] = "{show}, {take}, {slate}, {scene}, {shot}, {number} and {name}";

take_name take_slate_text(const char *scene, const char *shot, uint32_t number)
{
    take_name out;
    (void)snprintf(out.text, sizeof out.text, "%s%s%s%s%u", scene, scene[0] ? "/" : "", shot,
                   shot[0] ? "/" : "", number);
    return out;
}

/* Appends a word of a take to a file name: a single path component, never hidden. */
static void add_word(char *out, size_t capacity, const char *word, size_t length)
{
    size_t used = strlen(out);
    for (const char *at = word; at < word + length && used + 1 < capacity; ++at) {
        bool is_bad = *at == '/' || *at == '\\' || (unsigned char)*at < ' ' || *at == 127;
        bool starts = used == 0 || out[used - 1] == '/';
        out[used++] = is_bad ? '-' : *at == '.' && starts ? '_' : *at;
    }
    out[used] = '\0';
}

mrt_result export_name(char *out, size_t capacity, const char *pattern, const export_name_of *of,
                       error *err)
{
    char number[24], id[24];
    (void)snprintf(number, sizeof number, "%u", of->number);
    (void)snprintf(id, sizeof id, "%lld", (long long)of->take);
    const take_name slate = take_slate_text(of->scene, of->shot, of->number);
    const char *slash = strrchr(of->show, '/'), *show = slash ? slash + 1 : of->show;
    const char *dot = strrchr(show, '.');
    const struct {
        const char *key, *word;
        size_t length;
    } words[] = {{"{show}", show, dot ? (size_t)(dot - show) : strlen(show)},
                 {"{take}", id, strlen(id)},
                 {"{slate}", slate.text, strlen(slate.text)},
                 {"{scene}", of->scene, strlen(of->scene)},
                 {"{shot}", of->shot, strlen(of->shot)},
                 {"{number}", number, strlen(number)},
                 {"{name}", of->name, strlen(of->name)}};
    out[0] = '\0';
    for (const char *at = pattern; *at;) {
        size_t i = 0, used = strlen(out);
        while (i < sizeof words / sizeof *words &&
               strncmp(at, words[i].key, strlen(words[i].key)) != 0)
            ++i;
        if (i < sizeof words / sizeof *words) {
            add_word(out, capacity, words[i].word, words[i].length);
            at += strlen(words[i].key);
            continue;
        }
        if (*at == '{')
            return error_set(err, MRT_ERR_ARGUMENT, "\"%s\": a name can contain only %s", pattern,
                             pattern_words);
        if (used + 2 > capacity)
            return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", pattern);
        out[used] = *at++;
        out[used + 1] = '\0';
    }
    return MRT_OK;
}
