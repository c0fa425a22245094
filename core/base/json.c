#include "base/json.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

json_words json_describe(const json_t *value)
{
    json_words out = {"nothing"};
    char word[64];
    switch (value ? (int)json_typeof(value) : -1) {
    case JSON_OBJECT:
        (void)snprintf(out.text, sizeof out.text, "an object");
        break;
    case JSON_ARRAY:
        (void)snprintf(out.text, sizeof out.text, "an array of %zu", json_array_size(value));
        break;
    case JSON_STRING:
        text_copy(word, sizeof word,
                  text_view_of(json_string_value(value), json_string_length(value)));
        (void)snprintf(out.text, sizeof out.text, "\"%s\"", word);
        break;
    case JSON_INTEGER:
        (void)snprintf(out.text, sizeof out.text, "%lld", (long long)json_integer_value(value));
        break;
    case JSON_REAL:
        (void)snprintf(out.text, sizeof out.text, "%.9g", json_real_value(value));
        break;
    case JSON_TRUE:
    case JSON_FALSE:
        (void)snprintf(out.text, sizeof out.text, "%s", json_is_true(value) ? "true" : "false");
        break;
    case JSON_NULL:
        (void)snprintf(out.text, sizeof out.text, "null");
        break;
    default:
        break;
    }
    return out;
}

json_t *json_text(const char *text)
{
    char *shown = malloc(strlen(text) + 1), *out = shown;
    while (shown) {
        size_t length = strcspn(text, "\n\t");
        text_copy(out, length + 1, text_view_of(text, length));
        out += strlen(out);
        text += length;
        if (*text == '\0')
            break;
        *out++ = *text++;
    }
    if (!shown)
        return NULL;
    *out = '\0';
    json_t *value = json_string(shown);
    free(shown);
    return value;
}
