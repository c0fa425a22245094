/* face/rig/rig_document.h - the JSON behind a rig: its file and the files that it includes, and
 * which entry of which file each bone, region, contact ... comes from. Kept while the rig lives, so
 * that what this version does not know is written back, and messages name the entry. Inside the
 * room. [main] */
#ifndef MAROTTE_FACE_RIG_DOCUMENT_H
#define MAROTTE_FACE_RIG_DOCUMENT_H
#include "base/budget.h"
#include "base/json.h"
#include "face/rig.h"

/* ---- values: what base/json.h leaves out ---- */

enum { RIG_NAME_MAX = 63 };

CHECKED mrt_result rig_json_index(uint32_t *out, const json_node *at, error *err);
/* Three numbers within +-1e6, times `scale`. */
CHECKED mrt_result rig_json_point(vec3 *out, const json_node *at, double scale, error *err);
/* 1..length_max bytes that can be shown (text_is_printable); a copy to be freed. */
CHECKED mrt_result rig_json_text(char **out, const json_node *at, const char *expected,
                                 size_t length_max, error *err);

/* As above for what may be absent: `out` keeps its value then. */
CHECKED mrt_result rig_json_optional_number(double *out, const json_node *of, const char *key,
                                            double low, double high, error *err);
CHECKED mrt_result rig_json_optional_point(vec3 *out, bool *out_has, const json_node *of,
                                           const char *key, double scale, error *err);

/* Appends a line "PLACE.key: ..." to the note for every key that is not in the NULL-ended list. */
void rig_json_note_unknown(char **note, const json_node *object, const char *const *known);
/* Appends one line; beyond 8 KiB nothing more. */
__attribute__((format(printf, 2, 3))) void rig_note(char **note, const char *format, ...);

/* ---- files ---- */

typedef enum rig_section {
    RIG_BONES = 0,
    RIG_REGIONS,
    RIG_CONTACTS,
    RIG_PROXIES,
    RIG_POSES,
    RIG_SETS, /* an object: its keys are the names */
    RIG_SECTIONS
} rig_section;
extern const char *const rig_section_key[RIG_SECTIONS]; /* "bones" ... */

typedef struct rig_entry {
    json_node node;
    const char *name; /* "" where it has none; of the JSON */
    uint32_t file;
} rig_entry;

typedef struct rig_file {
    char *path;
    char *real_path; /* links followed; NULL: from bytes */
    json_t *root;
    json_path root_path; /* "$", or "base.rig.json: $" for an included one */
    double mm_per_unit;  /* of its coordinates */
} rig_file;

enum { RIG_FILES_MAX = 64, RIG_INCLUDE_DEPTH_MAX = 8 };

typedef struct rig_document {
    rig_file file[RIG_FILES_MAX]; /* what is included comes before what includes it */
    uint32_t file_count;
    rig_entry *entry[RIG_SECTIONS]; /* in the order of the rig's arrays */
    uint32_t entry_count[RIG_SECTIONS];
    budget budget;                 /* for reading it, with all that it includes */
    bool is_trusted;               /* what it names may lie anywhere */
    _Atomic uint32_t holder_count; /* besides the first: rigs that share it; read-only then */
} rig_document;

/* Reads the file and what it includes, each file once. `folder`: what it names must be in there or
 * below; NULL: it is trusted. */
CHECKED mrt_result rig_document_read(rig_document **out, const char *path, const char *folder,
                                     error *err);
/* From bytes; refuses to include. */
CHECKED mrt_result rig_document_parse(rig_document **out, const void *data, size_t size,
                                      const char *path, error *err);
void rig_document_hold(rig_document *d);    /* one more rig_document_destroy to come; [any] */
void rig_document_destroy(rig_document *d); /* [any] */

/* The member `key` of the last file that has it (own win over included); value NULL: none has. */
json_node rig_document_scalar(const rig_document *d, const char *key, uint32_t *out_file);

/* The paint of that name: of the last file that has it; value NULL: none has. */
json_node rig_document_paint(const rig_document *d, const char *name, uint32_t *out_file);

/* Which entry of the file an entry of the rig is; NULL: it is new. */
const rig_entry *rig_source(const rig *r, rig_section section, uint32_t index);
/* Where entry `index` of a rig's section is, for messages: also of rigs without a document; as it
 * will be written where it was changed. */
json_path rig_entry_path(const rig *r, rig_section section, uint32_t index);

/* ---- what reading, writing and changing share ---- */

extern const rig_bone rig_adult_jaw; /* the limits of one, where a file says none */
/* A selector alone, to be finished also on error; of what is painted only the name. */
CHECKED mrt_result rig_select_parse(rig_select *out, const json_node *at, double mm_per_unit,
                                    error *err);
void rig_select_finish(rig_select *select);
void rig_select_free_ranges(rig_select *select); /* of vertices, or of what is painted */
bool rig_select_uses_paint(const rig_select *select, const char *name); /* it, or one within */
/* What a file calls a kind of selector, and its two points if it has some; NULL else. */
typedef struct rig_select_words {
    const char *key, *first, *second;
} rig_select_words;
const rig_select_words *rig_select_words_of(rig_select_kind kind);
json_t *rig_number_to_json(double value); /* a whole number without a point */
json_t *rig_point_to_json(vec3 point, double mm_per_unit);
vec3 rig_round_axis(vec3 axis); /* as a file has it: to 1e-6, no longer quite of length 1 */

/* ---- what was painted ----
 *
 * "paints": { "jaw": ["120-180:ff", "204:0c1f33"] } in the file, ranges of a selector in memory.
 * Values are 255ths, two digits 0-9a-f each: of all vertices of a range, or of those that follow
 * one. [any] */

/* Out of the budget (NULL: it was read before) fills first, last, value, range_count; neighbours of
 * one value are one range, 0 is left away. */
CHECKED mrt_result rig_paint_parse(rig_select *out, const json_node *at, budget *b, error *err);
json_t *rig_paint_to_json(const rig_select *select); /* NULL: no memory */
bool rig_paint_equals(const rig_select *a, const rig_select *b);
/* Of a dense array; what was there is freed. */
CHECKED mrt_result rig_paint_set(rig_select *out, const uint8_t *value, uint32_t vertex_count,
                                 error *err);

/* ---- degrees of freedom ---- */

/* What a degree of freedom of a pose is measured in. */
typedef enum rig_dof_unit {
    RIG_DOF_UNKNOWN = 0,
    RIG_DOF_RAD,
    RIG_DOF_MM,
    RIG_DOF_SHARE
} rig_dof_unit;
rig_dof_unit rig_dof_unit_of(const rig *r, const char *name);

#endif
