/* base/json.h - what a JSON value is, in words for a message: what was found where something else
 * was expected. Leaves out reading JSON: each reader knows its own places. Pure; any thread. */
#ifndef MAROTTE_BASE_JSON_H
#define MAROTTE_BASE_JSON_H
#include <jansson.h>

typedef struct json_words {
    char text[96];
} json_words;

/* "an object", "an array of 3", "\"text\"" (printable, cut), "12", "true", "null"; NULL: "nothing".
 */
json_words json_describe(const json_t *value);

#endif
