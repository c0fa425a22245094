#include "command.h"
#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>

int command_usage(const command *self, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_printable(text);
    fprintf(stderr, "marotte %s: %s (marotte %s --help)\n", self->name, text, self->name);
    return COMMAND_USAGE;
}

int command_failed(const command *self, const error *err)
{
    fprintf(stderr, "marotte %s: %s\n", self->name, err->text);
    return COMMAND_FAILED;
}
