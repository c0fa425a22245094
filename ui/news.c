#include "news.h"

#include <stdio.h>
#include <string.h>

void news_print_record(const log_record *record)
{
    static const char *const levels[] = {"debug", "note", "warning", "error"};
    if (record->level > MRT_LOG_DEBUG && record->level <= MRT_LOG_ERROR)
        fprintf(stderr, "%s: %s: %s\n", levels[record->level], record->source, record->text);
}

/* Every layer of a take says the same of its mapping. */
static bool is_said_again(const log_record *record, const log_record *last)
{
    return record->level == last->level && strcmp(record->source, last->source) == 0 &&
           strcmp(record->text, last->text) == 0;
}

void news_print(log_queue *log)
{
    log_record record, last = {0};
    while (log && log_pop(log, &record)) {
        if (!is_said_again(&record, &last))
            news_print_record(&record);
        last = record;
    }
    uint32_t lost = log ? log_take_lost(log) : 0;
    if (lost)
        fprintf(stderr, "warning: %u lines of news were lost: there were too many\n", lost);
}
