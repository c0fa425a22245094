/* base/json.h - JSON for people and machines: values with the path at which they stand, so that
 * every message can say "$.contacts[3].vertex: expected ..., found ..."; and texts of others as
 * values. Leaves out what a file means: its reader knows that. Pure; any thread. */
#ifndef MAROTTE_BASE_JSON_H
#define MAROTTE_BASE_JSON_H
#include "base/error.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* ---- words for messages ---- */

typedef struct json_words {
    char text[96];
} json_words;

/* "an object", "an array of 3", "\"text\"" (printable, cut), "12", "true", "null"; NULL: "nothing".
 */
json_words json_describe(const json_t *value);
/* Bytes from somebody else: at most 63, what does not print becomes '?'. */
json_words json_shown(const char *text);

/* A text from outside (base/text.h) as a string: printable, but for newlines and tabs, which JSON
 * escapes. A new reference; NULL: no memory. */
json_t *json_text(const char *text);

/* ---- values and their paths ---- */

typedef struct json_path {
    char text[320]; /* "$.bones[2].hinge", or "base.rig.json: $.bones[2].hinge"; cut if longer */
} json_path;

typedef struct json_node {
    const json_t *value; /* borrowed; NULL: there is none at this path */
    json_path path;
} json_node;

/* A text without duplicate keys or zero bytes; a new reference. Else MRT_ERR_FORMAT, "line 3,
 * column 7: is not JSON: ...". */
CHECKED mrt_result json_parse(json_t **out, const void *data, size_t size, error *err);

/* "$", or "NAME: $". */
json_node json_node_root(const json_t *value, const char *name);
/* "PATH.key", or "PATH[\"a.b\"]" of a key with a dot in it. */
json_node json_node_member(const json_node *of, const char *key);
json_node json_node_item(const json_node *of, size_t index);

/* The next key of the object that is not in the NULL-ended list; NULL: there is none any more. *at:
 * NULL before the first call. */
const char *json_node_unknown(const json_node *object, const char *const *known, void **at);

/* "PATH: expected EXPECTED, found ..."; always MRT_ERR_FORMAT. */
mrt_result json_node_unexpected(error *err, const json_node *at, const char *expected);

/* What is expected, or json_node_unexpected; `out` is only written on success. */
CHECKED mrt_result json_node_object(const json_node *at, const char *expected, error *err);
/* At most item_cap items. */
CHECKED mrt_result json_node_array(const json_node *at, const char *expected, size_t item_cap,
                                   error *err);
/* low <= value <= high */
CHECKED mrt_result json_node_number(double *out, const json_node *at, double low, double high,
                                    error *err);
/* An array of exactly `count` such numbers; expected: of the whole, "three numbers [x, y, z]". */
CHECKED mrt_result json_node_numbers(double *out, size_t count, const json_node *at, double low,
                                     double high, const char *expected, error *err);
CHECKED mrt_result json_node_flag(bool *out, const json_node *at, error *err);

#endif
