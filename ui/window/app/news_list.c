#include "window/app/news_list.h"

#include "base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct news_list {
    news_item item[NEWS_MAX]; /* a ring */
    uint32_t first, count;
    uint64_t total;
};

/* The same line again within this time is shown once: layers of one take tell the same of their
 * mapping, and so does a device with a loose cable. */
static const double REPEAT_S = 2.0;

news_list *news_list_create(void)
{
    return calloc(1, sizeof(news_list));
}

void news_list_destroy(news_list *self)
{
    free(self);
}

static news_item *at(news_list *self, uint32_t index)
{
    return &self->item[(self->first + index) % NEWS_MAX];
}

static bool is_repeated(news_list *self, const news_item *item)
{
    if (self->count == 0)
        return false;
    const news_item *last = at(self, self->count - 1);
    return last->age_s < REPEAT_S && last->level == item->level &&
           strcmp(last->source, item->source) == 0 && strcmp(last->text, item->text) == 0;
}

/* Copies the text as one line: line ends become blanks. */
static void copy_line(char *out, size_t capacity, const char *text)
{
    (void)snprintf(out, capacity, "%s", text);
    for (char *c = out; *c; ++c)
        if ((unsigned char)*c < 0x20)
            *c = ' ';
}

void news_list_add(news_list *self, int32_t level, const char *source, const char *text)
{
    news_item item = {.level = level, .utc_ms = clock_utc_ms()};
    copy_line(item.source, sizeof item.source, source);
    copy_line(item.text, sizeof item.text, text);
    if (is_repeated(self, &item))
        return;
    self->total += 1;
    if (self->count == NEWS_MAX)
        self->first = (self->first + 1) % NEWS_MAX;
    else
        self->count += 1;
    *at(self, self->count - 1) = item;
}

void news_list_update(news_list *self, log_queue *from, double dt_s)
{
    log_record record;
    for (uint32_t i = 0; i < self->count; ++i)
        at(self, i)->age_s += dt_s;
    while (from && log_pop(from, &record))
        if (record.level > MRT_LOG_DEBUG)
            news_list_add(self, record.level, record.source, record.text);
    const uint32_t lost = from ? log_pop_lost(from) : 0;
    if (lost) {
        char text[80];
        (void)snprintf(text, sizeof text, "%u messages were lost, because there were too many",
                       lost);
        news_list_add(self, MRT_LOG_WARNING, "news", text);
    }
}

uint32_t news_list_count(const news_list *self)
{
    return self->count;
}

uint64_t news_list_total(const news_list *self)
{
    return self->total;
}

const news_item *news_list_at(const news_list *self, uint32_t index)
{
    return &self->item[(self->first + index) % NEWS_MAX];
}

uint32_t news_list_first_after(const news_list *self, uint64_t total)
{
    const uint64_t fresh = self->total - total;
    return fresh < self->count ? self->count - (uint32_t)fresh : 0;
}

const char *news_list_newest(const news_list *self)
{
    return self->count ? news_list_at(self, self->count - 1)->text : "";
}
