#include "base/error.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#undef error_set
mrt_result error_set(error *out, mrt_result code, const char *format, ...)
{
    if (out) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(out->text, sizeof out->text, format, arguments);
        va_end(arguments);
        text_make_printable(out->text);
    }
    return code;
}

void error_prefix(error *out, const char *prefix)
{
    if (!out)
        return;
    char text[sizeof out->text];
    memcpy(text, out->text, sizeof text);
    int length = snprintf(out->text, sizeof out->text, "%s: ", prefix);
    if (length < 0 || (size_t)length >= sizeof out->text)
        return;
    size_t room = sizeof out->text - (size_t)length - 1;
    size_t text_length = strnlen(text, sizeof text - 1);
    if (text_length > room)
        text_length = room;
    memcpy(out->text + length, text, text_length);
    out->text[(size_t)length + text_length] = '\0';
    text_make_printable(out->text);
}
