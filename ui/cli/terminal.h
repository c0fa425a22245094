/* ui/cli/terminal.h - the terminal that a command was started in: lines of news on stderr, a progress
 * line, and single keys. [main] */
#ifndef MAROTTE_UI_TERMINAL_H
#define MAROTTE_UI_TERMINAL_H
#include "base/log.h"

#include <stdbool.h>
#include <stdint.h>

/* ---- lines of a command's own ---- */

/* As printf, on stdout; what is not printable (base/text.h) becomes '?', but newlines stay: names
 * in it may be those of files that somebody else has made. */
__attribute__((format(printf, 1, 2))) void terminal_print(const char *format, ...);
/* The word as a shell reads it back: for commands to copy. */
void terminal_print_quoted(const char *word);

/* ---- what plugins and the stage say, on stderr: one line each ---- */

/* Prints and drains the log; debug lines are left out. NULL is fine. */
void news_print(log_queue *log);
void news_print_record(const log_record *record);
/* Each line of the text as a note; NULL is fine. */
void news_print_notes(const char *lines);

/* ---- a progress line ---- */

typedef struct progress {
    const char *what; /* "performing" */
    int64_t start_ns, shown_ns;
    bool is_terminal, has_shown, tells_lines;
} progress;

void progress_start(progress *self, const char *what);
/* done: 0..1, or < 0 when the end is not known; `text` may be "". Cheap: prints ten times a second.
 */
void progress_show(progress *self, double done, const char *text);
/* "3.2 s of 20.0 s"; total_s <= 0: not known. */
void progress_show_time(progress *self, double at_s, double total_s);
void progress_end(progress *self); /* clears the line */
/* The same for those who take a callback: of a progress. Always goes on. */
bool progress_part(void *shown, double done);

/* ---- keys ---- */

/* False: no terminal, or this process is not in its foreground. Ctrl-C stays a signal. */
bool keys_begin(void);
void keys_end(void); /* also when keys_begin said false */
/* The next key that was pressed, '\n' for Enter; 0: none. */
char keys_next(void);

#endif
