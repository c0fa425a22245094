#include "base/suggest.h"

#include <ctype.h>
#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { WORD_MAX = 63, PREFIX_LEAST = 3, EDITS_MOST = 3, ENTRIES_MOST = 10000 };

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static bool is_same(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

uint32_t suggest_distance(const char *a, const char *b)
{
    const size_t rows = strlen(a), columns = strlen(b);
    uint32_t row[3][WORD_MAX + 1]; /* of the table: the current row and the two above */
    if (rows > WORD_MAX || columns > WORD_MAX)
        return UINT32_MAX;
    uint32_t *before = row[0], *above = row[1], *now = row[2];
    for (size_t k = 0; k <= columns; ++k)
        now[k] = (uint32_t)k;
    for (size_t i = 1; i <= rows; ++i) {
        uint32_t *oldest = before;
        before = above;
        above = now;
        now = oldest;
        now[0] = (uint32_t)i;
        for (size_t k = 1; k <= columns; ++k) {
            now[k] = above[k - 1] + !is_same(a[i - 1], b[k - 1]);
            now[k] = least(now[k], least(above[k], now[k - 1]) + 1);
            if (i > 1 && k > 1 && is_same(a[i - 1], b[k - 2]) && is_same(a[i - 2], b[k - 1]))
                now[k] = least(now[k], before[k - 2] + 1);
        }
    }
    return now[columns];
}

void suggest_begin(suggest *self, const char *word)
{
    *self = (suggest){.word = word, .distance = UINT32_MAX};
}

static bool begins_with(const char *name, const char *word, size_t length)
{
    size_t i = 0;
    while (i < length && name[i] && is_same(name[i], word[i]))
        ++i;
    return i == length;
}

void suggest_consider(suggest *self, const char *name)
{
    const size_t length = strlen(self->word);
    const uint32_t most = least((uint32_t)(length + 1) / 3, EDITS_MOST);
    uint32_t distance = suggest_distance(self->word, name);
    if (length >= PREFIX_LEAST && begins_with(name, self->word, length))
        distance = least(distance, 1);
    if (length < 2 || distance > most || distance >= self->distance ||
        strlen(name) >= sizeof self->best)
        return;
    self->distance = distance;
    (void)snprintf(self->best, sizeof self->best, "%s", name);
}

suggest_text suggest_question(const suggest *self)
{
    suggest_text out = {""};
    if (self->best[0])
        (void)snprintf(out.text, sizeof out.text, ". Did you mean \"%s\"?", self->best);
    return out;
}

void suggest_folder(suggest *self, const char *folder)
{
    DIR *opened = opendir(folder[0] ? folder : ".");
    const struct dirent *entry = NULL;
    for (int i = 0; opened && i < ENTRIES_MOST && (entry = readdir(opened)); ++i)
        if (entry->d_name[0] != '.')
            suggest_consider(self, entry->d_name);
    if (opened)
        closedir(opened);
}

suggest_text suggest_file(const char *path)
{
    suggest near;
    char folder[SUGGEST_LENGTH] = "";
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const size_t length = (size_t)(name - path);
    if (length >= sizeof folder)
        return (suggest_text){""};
    memcpy(folder, path, length);
    suggest_begin(&near, name);
    suggest_folder(&near, folder);
    if (near.best[0] == '\0' || length + strlen(near.best) >= sizeof near.best)
        return (suggest_text){""};
    memmove(near.best + length, near.best, strlen(near.best) + 1);
    memcpy(near.best, folder, length);
    return suggest_question(&near);
}
