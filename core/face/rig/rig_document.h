/* face/rig_document.h - the JSON behind a rig: its file and the files that it includes, and which
 * entry of which file each bone, region, contact ... comes from. Kept while the rig lives, so that
 * what this version does not know is written back, and messages name the entry. Inside the room.
 * [main] */
#ifndef MAROTTE_FACE_RIG_DOCUMENT_H
#define MAROTTE_FACE_RIG_DOCUMENT_H
#include "base/budget.h"
#include "face/rig.h"
#include "face/rig/rig_json.h"

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
    rig_node node;
    const char *name; /* "" where it has none; of the JSON */
    uint32_t file;
} rig_entry;

typedef struct rig_file {
    char *path;
    char *real_path; /* links followed; NULL: from bytes */
    json_t *root;
    rig_place place;    /* "$", or "base.rig.json: $" for an included one */
    double mm_per_unit; /* of its coordinates */
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
rig_node rig_document_scalar(const rig_document *d, const char *key, uint32_t *out_file);

/* The paint of that name: of the last file that has it; value NULL: none has. */
rig_node rig_document_paint(const rig_document *d, const char *name, uint32_t *out_file);

/* Which entry of the file an entry of the rig is; NULL: it is new. */
const rig_entry *rig_source(const rig *r, rig_section section, uint32_t index);
/* Where entry `index` of a rig's section is, for messages: also of rigs without a document; as it
 * will be written where it was changed. */
rig_place rig_where(const rig *r, rig_section section, uint32_t index);

/* Steps of reading, each with its own file; all leave `r` such that rig_destroy frees it. */
CHECKED mrt_result rig_fill(rig *r, rig_document *d, error *err); /* rig_parse.c */
/* rig_parse_bone.c: fills r->bone, whose memory is there. */
CHECKED mrt_result rig_fill_bones(rig *r, rig_document *d, error *err);
extern const rig_bone rig_adult_jaw; /* the limits of one, where a file says none */
/* rig_parse_pose.c: as above, for poses and contact sets. */
CHECKED mrt_result rig_fill_poses(rig *r, rig_document *d, error *err);
CHECKED mrt_result rig_fill_contact_sets(rig *r, rig_document *d, error *err);
/* rig_parse_select.c */
typedef struct rig_selecting {
    double mm_per_unit; /* of the file that the selector is in */
    char **note;
    uint32_t depth, node_count;   /* of all selectors so far: they are bounded */
    const rig_document *document; /* whose paints are taken; NULL: only their names */
    budget *budget;
} rig_selecting;
CHECKED mrt_result rig_select_parse(rig_select *out, const rig_node *at, rig_selecting *s,
                                    error *err);
void rig_select_finish(rig_select *select);
/* rig_write_select.c: a new JSON value; NULL: no memory. */
json_t *rig_select_to_json(const rig_select *select, double mm_per_unit);
bool rig_select_equals(const rig_select *a, const rig_select *b); /* of paints: the name */
/* rig_write_paints.c: puts "paints" into the root of the file that is written: what the rig's
 * selectors say. */
CHECKED mrt_result rig_write_paints(json_t *root, const rig *r, error *err);
/* rig_write_entry.c: entry `index` of a section as JSON for a file of `mm_per_unit`: a copy of its
 * source (NULL: none), whose file has source_mm_per_unit, in which only what differs is changed.
 * NULL: no memory. */
json_t *rig_entry_to_json(const rig *r, rig_section section, uint32_t index, const json_t *source,
                          double source_mm_per_unit, double mm_per_unit);
/* A whole number without a point. */
json_t *rig_number_to_json(double value);
json_t *rig_point_to_json(vec3 point, double mm_per_unit);
vec3 rig_round_axis(vec3 axis); /* as a file has it: to 1e-6, no longer quite of length 1 */

/* What a degree of freedom of a pose is measured in. */
typedef enum rig_dof_unit { RIG_DOF_UNKNOWN = 0, RIG_DOF_RAD, RIG_DOF_MM } rig_dof_unit;
rig_dof_unit rig_dof_unit_of(const rig *r, const char *name);

#endif
