#include "window/timeline_takes.h"

#include "base/clock.h"
#include "base/text.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GOOD_STARS = 3 };
const char *const takes_filter_name[TAKES_FILTERS] = {"All", "3 stars +", "Deleted"};

/* ---- words ---- */

static int lower(char byte)
{
    return tolower((unsigned char)byte);
}

static bool contains(const char *text, text_view word)
{
    size_t length = (size_t)(word.end - word.at);
    for (; *text; ++text) {
        size_t i = 0;
        while (i < length && lower(text[i]) == lower(word.at[i]))
            i += 1;
        if (i == length)
            return true;
    }
    return false;
}

bool timeline_takes_matches(const studio_take_line *line, const char *words)
{
    text_view rest = text_view_of(words, strlen(words)), word;
    while (text_next_word(&rest, &word))
        if (!contains(line->title, word) && !contains(line->note, word))
            return false;
    return true;
}

static bool is_shown(const timeline_takes *self, const studio_take_line *line)
{
    if ((self->filter == TAKES_DELETED) != line->is_deleted)
        return false;
    if (self->filter == TAKES_GOOD && line->rating < GOOD_STARS)
        return false;
    return self->words[0] == '\0' || timeline_takes_matches(line, self->words);
}

/* ---- the list ---- */

static bool reserve(timeline_takes *self, uint32_t count)
{
    if (count <= self->capacity)
        return true;
    uint32_t capacity = count + count / 2 + 64;
    uint32_t *index = realloc(self->index, capacity * sizeof *index);
    if (!index)
        return false;
    self->index = index;
    self->capacity = capacity;
    return true;
}

bool timeline_takes_look(timeline_takes *self, const studio_take_line *line, uint32_t count)
{
    bool has_room = reserve(self, count);
    self->count = 0;
    for (uint32_t i = count; i-- > 0 && self->count < self->capacity;)
        if (is_shown(self, &line[i]))
            self->index[self->count++] = i;
    return has_room;
}

void timeline_takes_finish(timeline_takes *self)
{
    free(self->index);
    *self = (timeline_takes){0};
}

void timeline_takes_duration(char *out, size_t capacity, int64_t duration_ns)
{
    const int64_t tenth_ns = NS_PER_S / 10;
    const int64_t tenths = duration_ns < 0 ? 0 : (duration_ns + tenth_ns / 2) / tenth_ns;
    const int64_t s = tenths / 10;
    if (s < 60)
        (void)snprintf(out, capacity, "%d.%d s", (int)s, (int)(tenths % 10));
    else if (s < 3600)
        (void)snprintf(out, capacity, "%d:%02d", (int)(s / 60), (int)(s % 60));
    else
        (void)snprintf(out, capacity, "%d:%02d:%02d", (int)(s / 3600), (int)(s / 60 % 60),
                       (int)(s % 60));
}
