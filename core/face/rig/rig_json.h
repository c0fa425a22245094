/* face/rig_json.h - reading JSON strictly: values together with their place in the file, so that
 * every message can say "$.contacts[3].vertex". Knows nothing of rigs. Inside the room. [main] */
#ifndef MAROTTE_FACE_RIG_JSON_H
#define MAROTTE_FACE_RIG_JSON_H
#include "base/error.h"
#include "base/rigid.h"

#include <jansson.h>

enum { RIG_PLACE_TEXT = 256, RIG_NAME_MAX = 63, RIG_WORD_TEXT = 64 };

typedef struct rig_place {
    char text[RIG_PLACE_TEXT]; /* "$.bones[2].hinge", or "base.rig.json: $.bones[2].hinge" */
} rig_place;

typedef struct rig_node {
    const json_t *value; /* NULL: there is none at this place */
    rig_place place;
} rig_node;

/* About how many bytes the values of a text take once they are parsed. */
size_t rig_json_memory(const void *data, size_t size);

rig_node rig_json_member(const rig_node *of, const char *key);
rig_node rig_json_item(const rig_node *of, size_t index);

/* "PLACE: expected EXPECTED, found ..."; always MRT_ERR_FORMAT. */
mrt_result rig_json_unexpected(error *err, const rig_node *at, const char *expected);

CHECKED mrt_result rig_json_object(const rig_node *at, const char *expected, error *err);
/* An array of at most item_cap. */
CHECKED mrt_result rig_json_array(const rig_node *at, const char *expected, size_t item_cap,
                                  error *err);
/* low <= value <= high. */
CHECKED mrt_result rig_json_number(double *out, const rig_node *at, double low, double high,
                                   error *err);
CHECKED mrt_result rig_json_flag(bool *out, const rig_node *at, error *err);
CHECKED mrt_result rig_json_index(uint32_t *out, const rig_node *at, error *err);
/* Three numbers within +-1e6, times `scale`. */
CHECKED mrt_result rig_json_point(vec3 *out, const rig_node *at, double scale, error *err);
/* 1..length_max bytes that can be shown (text_is_printable); a copy to be freed. */
CHECKED mrt_result rig_json_text(char **out, const rig_node *at, const char *expected,
                                 size_t length_max, error *err);

/* As above for what may be absent: `out` keeps its value then. */
CHECKED mrt_result rig_json_optional_number(double *out, const rig_node *of, const char *key,
                                            double low, double high, error *err);
CHECKED mrt_result rig_json_optional_point(vec3 *out, bool *out_has, const rig_node *of,
                                           const char *key, double scale, error *err);

/* Appends a line "PLACE.key: ..." to the note for every key that is not in the NULL-ended list. */
void rig_json_note_unknown(char **note, const rig_node *object, const char *const *known);
/* Appends one line; beyond 8 KiB nothing more. */
__attribute__((format(printf, 2, 3))) void rig_note(char **note, const char *format, ...);

/* Bytes from somebody else, for a message: what does not print becomes '?'. */
typedef struct rig_word {
    char text[RIG_WORD_TEXT];
} rig_word;
rig_word rig_word_of(const char *text);

#endif
