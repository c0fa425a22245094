/* news.h - what plugins and the stage say, on stderr: one line each. [main] */
#ifndef MAROTTE_UI_NEWS_H
#define MAROTTE_UI_NEWS_H
#include "base/log.h"

/* Prints and drains the log; debug lines are left out. NULL is fine. */
void news_print(log_queue *log);
void news_print_record(const log_record *record);

#endif
