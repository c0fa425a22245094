/* face/rig/rig_document.h - the JSON of a rig: its file and the files that it includes, and the
 * source entry of each bone, region, contact and so on. The rig owns it. So keys that this version
 * does not know are written back, and messages can name the entry. Private to this folder. [main]
 */
#ifndef MAROTTE_FACE_RIG_DOCUMENT_H
#define MAROTTE_FACE_RIG_DOCUMENT_H
#include "base/budget.h"
#include "base/json.h"
#include "face/rig.h"

/* ---- values, in addition to base/json.h ---- */

enum { RIG_NAME_MAX = 63 };

mrt_result rig_no_memory(error *err); /* sets the error; always MRT_ERR_MEMORY */
/* Reads 1..length_max bytes of printable text (text_is_printable). The caller frees the copy. */
CHECKED mrt_result rig_json_text(char **out, const json_node *at, const char *expected,
                                 size_t length_max, error *err);

/* Appends one line. Does nothing once the note has 8 KiB. */
__attribute__((format(printf, 2, 3))) void rig_note(char **note, const char *format, ...);

/* ---- files ---- */

typedef enum rig_section {
    RIG_BONES = 0,
    RIG_REGIONS,
    RIG_CONTACTS,
    RIG_PROXIES,
    RIG_POSES,
    RIG_SETS, /* an object with names as keys */
    RIG_SECTIONS
} rig_section;
extern const char *const rig_section_key[RIG_SECTIONS]; /* "bones" ... */

typedef struct rig_entry {
    json_node node;
    const char *name; /* "" if it has none; owned by the JSON */
    uint32_t file;
} rig_entry;

typedef struct rig_file {
    char *path;
    char *real_path; /* with links resolved; NULL if read from bytes */
    json_t *root;
    json_path root_path; /* "$", or "base.rig.json: $" for an included one */
    double mm_per_unit;  /* unit of its coordinates */
} rig_file;

enum { RIG_FILES_MAX = 64, RIG_INCLUDE_DEPTH_MAX = 8 };

typedef struct rig_document {
    rig_file file[RIG_FILES_MAX]; /* included files come before the file that includes them */
    uint32_t file_count;
    rig_entry *entry[RIG_SECTIONS]; /* in the order of the rig's arrays */
    uint32_t entry_count[RIG_SECTIONS];
    budget budget;   /* for reading the file with everything that it includes */
    bool is_trusted; /* files that it names can be anywhere */
    _Atomic uint32_t
        holder_count; /* number of further rigs that share it; above 0 it is read-only */
} rig_document;

/* Reads the file and everything that it includes, each file once. folder: all named files must be
 * in it or below; NULL if the file is trusted. */
CHECKED mrt_result rig_document_read(rig_document **out, const char *path, const char *folder,
                                     error *err);
/* Reads from bytes. Includes are refused. */
CHECKED mrt_result rig_document_parse(rig_document **out, const void *data, size_t size,
                                      const char *path, error *err);
void rig_document_retain(
    rig_document *d); /* adds an owner that will call rig_document_destroy; [any] */
void rig_document_destroy(rig_document *d); /* [any] */

/* Returns the member `key` of the last file that has it, so the rig's own value wins over included
 * ones. The value is NULL if no file has it. */
json_node rig_document_scalar(const rig_document *d, const char *key, uint32_t *out_file);

/* Returns the paint of that name from the last file that has it. The value is NULL if no file has
 * it. */
json_node rig_document_paint(const rig_document *d, const char *name, uint32_t *out_file);

/* Returns the file's entry for an entry of the rig, or NULL if that is new. */
const rig_entry *rig_source(const rig *r, rig_section section, uint32_t index);
/* Returns the JSON path of entry `index` of a section, for messages. Works for rigs without a
 * document, too. In a changed section it is the path that will be written. */
json_path rig_entry_path(const rig *r, rig_section section, uint32_t index);

/* ---- shared by reading, writing and editing ---- */

extern const rig_bone rig_adult_jaw; /* an adult's limits, the default */
void rig_select_finish(rig_select *select);
void rig_select_free_ranges(rig_select *select); /* of vertices or of a paint */
bool rig_select_uses_paint(const rig_select *select,
                           const char *name); /* true for the selector itself or one inside it */
const char *rig_select_key(rig_select_kind kind); /* "box" ...; its key in the file */
json_t *rig_number_to_json(double value);         /* whole numbers get no decimal point */
json_t *rig_point_to_json(vec3 point, double mm_per_unit);
vec3 rig_round_axis(vec3 axis); /* as a file stores it: to 1e-6, so not exactly of length 1 */

/* ---- paints ----
 *
 * "paints": { "jaw": ["120-180:ff", "204:0c1f33"] } in the file, ranges of a selector in memory.
 * Values are 255ths, two digits 0-9a-f each. A range has one value for all its vertices. A single
 * vertex has a value for itself and for each vertex directly after it. [any] */

/* Fills first, last, value and range_count. Charges the budget (NULL: it was already charged).
 * Neighbours of equal value become one range; 0 is left out. */
CHECKED mrt_result rig_paint_parse(rig_select *out, const json_node *at, budget *b, error *err);
json_t *rig_paint_to_json(const rig_select *select); /* NULL without memory */
bool rig_paint_equals(const rig_select *a, const rig_select *b);
/* Fills the ranges from a dense array. Frees the previous ones. */
CHECKED mrt_result rig_paint_set(rig_select *out, const uint8_t *value, uint32_t vertex_count,
                                 error *err);

/* ---- degrees of freedom ---- */

/* Unit of a degree of freedom in a pose. */
typedef enum rig_dof_unit {
    RIG_DOF_UNKNOWN = 0,
    RIG_DOF_RAD,
    RIG_DOF_MM,
    RIG_DOF_SHARE
} rig_dof_unit;
rig_dof_unit rig_dof_unit_of(const rig *r, const char *name);

#endif
