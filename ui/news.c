#include "news.h"

#include <stdio.h>

void news_print_record(const log_record *record)
{
    static const char *const levels[] = {"debug", "note", "warning", "error"};
    if (record->level > MRT_LOG_DEBUG && record->level <= MRT_LOG_ERROR)
        fprintf(stderr, "%s: %s: %s\n", levels[record->level], record->source, record->text);
}

void news_print(log_queue *log)
{
    log_record record;
    while (log && log_pop(log, &record))
        news_print_record(&record);
    uint32_t lost = log ? log_take_lost(log) : 0;
    if (lost)
        fprintf(stderr, "warning: %u lines of news were lost: there were too many\n", lost);
}
