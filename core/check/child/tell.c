#include "check/child/tell.h"
#include "check/wire.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int out = -1;
static bool has_failed[RULE_COUNT];
static check_rule blamed_rule = RULE_COUNT;
static char doing[WIRE_TEXT] = "";

void tell_to(int fd)
{
    out = fd;
}

/* Writes a line with one write(), so that it is complete or absent (PIPE_BUF). */
static void send_line(char kind, const char *name, const char *text)
{
    char line[WIRE_LINE];
    int length = snprintf(line, sizeof line, "%c %s %s", kind, name, text);
    size_t size = length < 0 ? 0 : (size_t)length;
    if (size >= sizeof line)
        size = sizeof line - 1;
    for (size_t i = 0; i < size; ++i)
        if ((unsigned char)line[i] < ' ')
            line[i] = ' ';
    line[size] = '\n';
    ssize_t written = write(out, line, size + 1);
    (void)written;
}

/* Formats into its own text, cut to fit. NOLINTBEGIN(bugprone-macro-parentheses) */
#define FORMAT_TEXT(text, format)                                                                  \
    char text[WIRE_TEXT];                                                                          \
    va_list arguments;                                                                             \
    va_start(arguments, format);                                                                   \
    (void)vsnprintf(text, sizeof text, format, arguments);                                         \
    va_end(arguments)
/* NOLINTEND(bugprone-macro-parentheses) */

void tell_doing(check_rule blamed, const char *format, ...)
{
    FORMAT_TEXT(text, format);
    blamed_rule = blamed;
    memcpy(doing, text, sizeof doing);
}

const char *tell_what(void)
{
    return doing;
}

check_rule tell_blamed(void)
{
    return blamed_rule;
}

void tell_failed(check_rule rule, const char *format, ...)
{
    if (has_failed[rule])
        return;
    FORMAT_TEXT(text, format);
    has_failed[rule] = true;
    send_line(WIRE_FAILED, check_rule_id(rule), text);
}

bool tell_has_failed(check_rule rule)
{
    return has_failed[rule];
}

bool tell_has_failed_any(void)
{
    for (int i = 0; i < RULE_COUNT; ++i)
        if (has_failed[i])
            return true;
    return false;
}

void tell_ok(check_rule rule, const char *format, ...)
{
    if (has_failed[rule])
        return;
    FORMAT_TEXT(text, format);
    send_line(WIRE_OK, check_rule_id(rule), text);
}

void tell_skipped(check_rule rule, const char *format, ...)
{
    FORMAT_TEXT(text, format);
    send_line(WIRE_SKIPPED, check_rule_id(rule), text);
}

void tell_fact(const char *name, const char *format, ...)
{
    FORMAT_TEXT(text, format);
    send_line(WIRE_FACT, name, text);
}

void tell_end(void)
{
    send_line(WIRE_END, "end", "");
}

void tell_down(check_rule rule, const char *how)
{
    tell_failed(blamed_rule == RULE_COUNT ? rule : blamed_rule, "%.400s, in %.300s", how,
                doing[0] ? doing : "nothing in particular");
}
