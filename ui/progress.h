/* progress.h - a progress line on a terminal for whatever takes more than a second. Not a terminal:
 * nothing is printed, but with MAROTTE_PROGRESS=lines in the environment lines on stderr for the
 * program that waits for it, "progress 0.42 writing". [main] */
#ifndef MAROTTE_UI_PROGRESS_H
#define MAROTTE_UI_PROGRESS_H
#include <stdbool.h>
#include <stdint.h>

typedef struct progress {
    const char *what; /* "performing" */
    int64_t start_ns, shown_ns;
    bool is_terminal, has_shown, tells_lines;
} progress;

void progress_start(progress *self, const char *what);
/* done: 0..1, or < 0 when the end is not known; `text` may be "". Cheap: prints ten times a second.
 */
void progress_show(progress *self, double done, const char *text);
void progress_end(progress *self); /* clears the line */

#endif
