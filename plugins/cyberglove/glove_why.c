#include "glove_why.h"

#include <stdarg.h>
#include <stdio.h>

mrt_result glove_why_set(glove_why *out, mrt_result code, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(out->text, sizeof out->text, format, values);
    va_end(values);
    return code;
}

void glove_why_hex(char *out, size_t capacity, const unsigned char *bytes, size_t count)
{
    size_t used = (size_t)snprintf(out, capacity, "%s", count > 0 ? "" : "nothing");
    for (size_t i = 0; i < count && used + 4 <= capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%02x", i > 0 ? " " : "", bytes[i]);
}
