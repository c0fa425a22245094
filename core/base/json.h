/* base/json.h - JSON for people and machines: what a value is, in words for a message, and texts of
 * others as values. Leaves out reading JSON: each reader knows its own places. Pure; any thread. */
#ifndef MAROTTE_BASE_JSON_H
#define MAROTTE_BASE_JSON_H
#include <jansson.h>

typedef struct json_words {
    char text[96];
} json_words;

/* "an object", "an array of 3", "\"text\"" (printable, cut), "12", "true", "null"; NULL: "nothing".
 */
json_words json_describe(const json_t *value);

/* A text from outside (base/text.h) as a string: printable, but for newlines and tabs, which JSON
 * escapes. A new reference; NULL: no memory. */
json_t *json_text(const char *text);

#endif
