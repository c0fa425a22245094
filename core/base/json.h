/* base/json.h - JSON values with their paths, so that messages can say "$.contacts[3].vertex:
 * expected ..., found ..."; and safe conversion of untrusted texts. Leaves out the meaning of a
 * file, which its reader defines. Pure. [any] */
#ifndef MAROTTE_BASE_JSON_H
#define MAROTTE_BASE_JSON_H
#include "base/error.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

/* ---- texts for messages ---- */

typedef struct json_words {
    char text[96];
} json_words;

/* Describes a value: "an object", "an array of 3", "\"text\"" (printable, cut), "12", "true",
 * "null"; NULL: "nothing". */
json_words json_describe(const json_t *value);
/* Makes an untrusted text printable: at most 63 bytes, other characters become '?'. */
json_words json_shown(const char *text);

/* Converts an untrusted text (base/text.h) to a JSON string: printable, except newlines and tabs,
 * which JSON escapes. Returns a new reference; NULL: no memory. */
json_t *json_text(const char *text);

/* ---- values and their paths ---- */

typedef struct json_path {
    char text[320]; /* "$.bones[2].hinge", or "base.rig.json: $.bones[2].hinge"; cut if longer */
} json_path;

typedef struct json_node {
    const json_t *value; /* borrowed; NULL: no value at this path */
    json_path path;
} json_node;

/* Parses a text without duplicate keys or zero bytes, and returns a new reference. Else
 * MRT_ERR_FORMAT, "line 3, column 7: is not JSON: ...". */
CHECKED mrt_result json_parse(json_t **out, const void *data, size_t size, error *err);

/* Returns the root node, with the path "$" or "NAME: $". */
json_node json_node_root(const json_t *value, const char *name);
/* Returns a member, with the path "PATH.key", or "PATH[\"a.b\"]" if the key contains a dot. */
json_node json_node_member(const json_node *of, const char *key);
json_node json_node_item(const json_node *of, size_t index);

/* Returns the next key of the object that is not in the NULL-ended list; NULL: no more. *at: NULL
 * before the first call. */
const char *json_node_unknown(const json_node *object, const char *const *known, void **at);

/* Sets the error "PATH: expected EXPECTED, found ...". Always returns MRT_ERR_FORMAT. */
mrt_result json_node_unexpected(error *err, const json_node *at, const char *expected);

/* Checks the format version of a file of marotte, which is 1. Error of a newer one: it was made by
 * a newer marotte. */
CHECKED mrt_result json_node_version(const json_node *root, const char *key, error *err);

/* Read the expected type, or fail with json_node_unexpected. They write `out` only on success. */
CHECKED mrt_result json_node_object(const json_node *at, const char *expected, error *err);
/* Accepts at most item_cap items. */
CHECKED mrt_result json_node_array(const json_node *at, const char *expected, size_t item_cap,
                                   error *err);
/* Accepts low <= value <= high. */
CHECKED mrt_result json_node_number(double *out, const json_node *at, double low, double high,
                                    error *err);
/* Reads an array of exactly `count` such numbers. expected: describes the whole, "three numbers [x,
 * y, z]". */
CHECKED mrt_result json_node_numbers(double *out, size_t count, const json_node *at, double low,
                                     double high, const char *expected, error *err);
CHECKED mrt_result json_node_flag(bool *out, const json_node *at, error *err);

#endif
