#include "progress.h"
#include "base/clock.h"

#include <stdio.h>
#include <unistd.h>

enum { BAR_WIDTH = 30 };

void progress_start(progress *self, const char *what)
{
    int64_t now = clock_now_ns();
    *self = (progress){
        .what = what, .start_ns = now, .shown_ns = now, .is_terminal = isatty(STDERR_FILENO) == 1};
}

void progress_show(progress *self, double done, const char *text)
{
    if (!self->is_terminal)
        return;
    int64_t now = clock_now_ns();
    if (now - self->start_ns < NS_PER_S || now - self->shown_ns < NS_PER_S / 10)
        return;
    self->shown_ns = now;
    self->has_shown = true;
    if (done < 0) {
        fprintf(stderr, "\r%-12s %s\033[K", self->what, text);
    } else {
        char bar[BAR_WIDTH + 1];
        for (int i = 0; i < BAR_WIDTH; ++i)
            bar[i] = (double)i < done * BAR_WIDTH ? '#' : '.';
        bar[BAR_WIDTH] = '\0';
        fprintf(stderr, "\r%-12s [%s] %3.0f %% %s\033[K", self->what, bar, 100.0 * done, text);
    }
    fflush(stderr);
}

void progress_end(progress *self)
{
    if (self->has_shown)
        fprintf(stderr, "\r\033[K");
    self->has_shown = false;
}
