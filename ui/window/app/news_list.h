/* window/app/news_list.h - the last news for the person in front of the program, with their times:
 * the log panel, and the one line that is shown for a while. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_NEWS_LIST_H
#define MAROTTE_UI_WINDOW_APP_NEWS_LIST_H
#include "base/log.h"

enum { NEWS_MAX = 500 };
typedef struct news_item {
    int32_t level; /* MRT_LOG_* */
    int64_t utc_ms;
    double age_s;
    char source[LOG_SOURCE];
    char text[1024];
} news_item;
typedef struct news_list news_list;
news_list *news_list_create(void); /* NULL: no memory */
void news_list_destroy(news_list *self);
void news_list_add(news_list *self, int32_t level, const char *source, const char *text);
/* Takes everything that is in the queue, and lets time pass. */
void news_list_update(news_list *self, log_queue *from, double dt_s);
uint32_t news_list_count(const news_list *self);
uint64_t news_list_total(const news_list *self); /* how many there were, also those not kept */
const news_item *news_list_at(const news_list *self, uint32_t index); /* 0: the oldest kept */
/* Index of the first kept message after the first `total` ones; their count: none. */
uint32_t news_list_first_after(const news_list *self, uint64_t total);
const char *news_list_newest(const news_list *self); /* its text; "": none */

#endif
