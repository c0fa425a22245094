/* window/timeline/take_list.h - which takes the list shows, newest first: all, the good ones, or
 * those that were deleted, with some words in title or note. Leaves out drawing. Pure but for its
 * memory, which is kept. [main] */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_TAKE_LIST_H
#define MAROTTE_UI_WINDOW_TIMELINE_TAKE_LIST_H
#include "window/app/app.h"

typedef enum takes_filter {
    TAKES_ALL = 0,
    TAKES_GOOD, /* three stars and more */
    TAKES_DELETED,
    TAKES_FILTERS
} takes_filter;
extern const char *const takes_filter_name[TAKES_FILTERS];

enum { TAKES_WORDS = 64, TAKES_SEARCH_FROM = 9 }; /* so many takes are worth a search field */
typedef struct timeline_takes {
    takes_filter filter;
    char words[TAKES_WORDS]; /* all of them must be there, in any case */
    uint32_t *index;         /* of the lines, in the order in which they are shown */
    uint32_t count, capacity;
} timeline_takes;

void timeline_takes_finish(timeline_takes *self); /* accepts zeroed */

/* "5.3 s", "2:05", "1:02:05" */
void timeline_takes_duration(char *out, size_t capacity, int64_t duration_ns);
/* All words of `words` are in the title or the note, in any case. */
bool timeline_takes_matches(const app_take_line *line, const char *words);

#endif
