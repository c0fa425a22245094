#include "progress.h"
#include "base/clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BAR_WIDTH = 30 };

void progress_start(progress *self, const char *what)
{
    int64_t now = clock_now_ns();
    const char *wanted = getenv("MAROTTE_PROGRESS");
    *self = (progress){.what = what,
                       .start_ns = now,
                       .shown_ns = now,
                       .is_terminal = isatty(STDERR_FILENO) == 1,
                       .tells_lines = wanted && strcmp(wanted, "lines") == 0};
}

static void show_line(const progress *self, double done, const char *text)
{
    if (done < 0) {
        fprintf(stderr, "\r%-12s %s\033[K", self->what, text);
        return;
    }
    char bar[BAR_WIDTH + 1];
    for (int i = 0; i < BAR_WIDTH; ++i)
        bar[i] = (double)i < done * BAR_WIDTH ? '#' : '.';
    bar[BAR_WIDTH] = '\0';
    fprintf(stderr, "\r%-12s [%s] %3.0f %% %s\033[K", self->what, bar, 100.0 * done, text);
}

void progress_show(progress *self, double done, const char *text)
{
    if (!self->is_terminal && !self->tells_lines)
        return;
    int64_t now = clock_now_ns();
    int64_t first_ns = self->tells_lines ? 0 : NS_PER_S;
    if (now - self->start_ns < first_ns || now - self->shown_ns < NS_PER_S / 10)
        return;
    self->shown_ns = now;
    if (self->tells_lines) {
        fprintf(stderr, "progress %.3f %s\n", done, self->what);
        return;
    }
    self->has_shown = true;
    show_line(self, done, text);
    fflush(stderr);
}

void progress_end(progress *self)
{
    if (self->has_shown)
        fprintf(stderr, "\r\033[K");
    self->has_shown = false;
}
