#include "cli/terminal.h"

#include "base/clock.h"
#include "base/program.h"
#include "base/text.h"

#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

/* ---- printed lines ---- */

void terminal_print(const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    char *text = length >= 0 ? malloc((size_t)length + 1) : NULL;
    if (text)
        (void)vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    for (char *line = text, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next)
            *next++ = '\0';
        text_make_printable(line);
        fputs(line, stdout);
        if (next)
            putchar('\n');
    }
    free(text);
}

void terminal_print_quoted(const char *word)
{
    const size_t capacity = 4 * strlen(word) + 4;
    char *quoted = malloc(capacity);
    if (quoted)
        program_quote(quoted, capacity, word);
    fputs(quoted ? quoted : "", stdout);
    free(quoted);
}

/* ---- log messages ---- */

void news_print_record(const log_record *record)
{
    static const char *const levels[] = {"debug", "note", "warning", "error"};
    if (record->level > MRT_LOG_DEBUG && record->level <= MRT_LOG_ERROR)
        fprintf(stderr, "%s: %s: %s\n", levels[record->level], record->source, record->text);
}

void news_print_notes(const char *lines)
{
    for (const char *line = lines; line && *line;) {
        size_t length = strcspn(line, "\n");
        fprintf(stderr, "note: %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

/* Each layer of a take reports the same messages of its mapping. */
static bool is_repeated(const log_record *record, const log_record *last)
{
    return record->level == last->level && strcmp(record->source, last->source) == 0 &&
           strcmp(record->text, last->text) == 0;
}

void news_print(log_queue *log)
{
    log_record record, last = {0};
    while (log && log_pop(log, &record)) {
        if (!is_repeated(&record, &last))
            news_print_record(&record);
        last = record;
    }
    uint32_t lost = log ? log_pop_lost(log) : 0;
    if (lost)
        fprintf(stderr, "warning: %u messages were lost, because there were too many\n", lost);
}

/* ---- progress ---- */

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

void progress_show_time(progress *self, double at_s, double total_s)
{
    char text[64];
    if (total_s > 0.0)
        (void)snprintf(text, sizeof text, "%.1f s of %.1f s", at_s, total_s);
    else
        (void)snprintf(text, sizeof text, "%.1f s", at_s);
    progress_show(self, total_s > 0.0 ? at_s / total_s : -1.0, text);
}

void progress_end(progress *self)
{
    if (self->has_shown)
        fprintf(stderr, "\r\033[K");
    self->has_shown = false;
}

bool progress_part(void *shown, double done)
{
    progress_show(shown, done, "");
    return true;
}

/* ---- keys ---- */

static struct termios before; /* settings of the terminal, restored at the end */
static bool is_changed, is_registered;

void keys_end(void)
{
    if (is_changed)
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &before);
    is_changed = false;
}

bool keys_begin(void)
{
    if (is_changed)
        return true;
    /* Changing the terminal from a background process would stop this process. */
    if (isatty(STDIN_FILENO) != 1 || tcgetpgrp(STDIN_FILENO) != getpgrp() ||
        tcgetattr(STDIN_FILENO, &before) != 0)
        return false;
    struct termios keys = before;
    keys.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    if (!is_registered)
        is_registered = atexit(keys_end) == 0;
    is_changed = tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
    return is_changed;
}

char keys_next(void)
{
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    char key = 0;
    if (!is_changed || poll(&input, 1, 0) != 1 || read(STDIN_FILENO, &key, 1) != 1)
        return 0;
    return key == '\r' ? '\n' : key;
}
