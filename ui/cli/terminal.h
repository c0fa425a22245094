/* ui/cli/terminal.h - the terminal of a command: log messages on stderr, a progress line, and
 * single keys. [main] */
#ifndef MAROTTE_UI_TERMINAL_H
#define MAROTTE_UI_TERMINAL_H
#include "base/log.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- printed lines ---- */

/* Prints like printf, on stdout. Replaces characters that are not printable (base/text.h) by '?',
 * except newlines: the text may contain file names from an untrusted source. */
__attribute__((format(printf, 1, 2))) void terminal_print(const char *format, ...);
/* Prints a word with the quotes that a shell needs, for commands to copy. */
void terminal_print_quoted(const char *word);

/* ---- messages of plugins and the stage, on stderr: one line each ---- */

/* Prints and drains the log, without debug lines. Accepts NULL. */
void news_print(log_queue *log);
void news_print_record(const log_record *record);
/* Prints each line of the text as a note. Accepts NULL. */
void news_print_notes(const char *lines);

/* ---- a progress line ---- */

typedef struct progress {
    const char *what; /* "performing" */
    int64_t start_ns, shown_ns;
    bool is_terminal, has_shown, tells_lines;
} progress;

void progress_start(progress *self, const char *what);
/* done: 0..1, or < 0 if the end is unknown; `text` may be "". Cheap: prints at most ten times a
 * second. */
void progress_show(progress *self, double done, const char *text);
/* Shows "3.2 s of 20.0 s"; total_s <= 0: unknown. */
void progress_show_time(progress *self, double at_s, double total_s);
void progress_end(progress *self); /* clears the line */
/* The same as a callback; `shown` is a progress. Always returns true. */
bool progress_part(void *shown, double done);

/* ---- keys ---- */

/* Returns false if there is no terminal, or if this process is not in its foreground. Ctrl-C stays
 * a signal. */
bool keys_begin(void);
void keys_end(void); /* call it even if keys_begin returned false */
/* Returns the next pressed key, '\n' for Enter; 0: none. */
char keys_next(void);

#endif
