/* face/rig/rig_fields.h - the fields of the rig file as tables: one row for each key, with its
 * type, range and unit. The same row reads the key, checks it and writes it. Leaves out the rows
 * (rig_format.c). Private to this folder. [main] */
#ifndef MAROTTE_FACE_RIG_FIELDS_H
#define MAROTTE_FACE_RIG_FIELDS_H
#include "face/rig/rig_document.h"

typedef struct rig_reading { /* file that is read */
    rig *r;                  /* bones and contacts that names refer to; NULL for a lone selector */
    rig_document *document;  /* its paints and budget; NULL: of a paint only the name is read */
    char **note;             /* lines about unknown keys */
    double mm_per_unit;      /* unit of the coordinates */
    uint32_t depth, select_count; /* nesting of the current selector, and all so far; limited */
} rig_reading;

typedef struct rig_writing { /* file that is written */
    const rig *r;
    double source_mm_per_unit, mm_per_unit; /* unit of the text that is changed, and of the file */
    bool failed;                            /* a value was lost for lack of memory */
} rig_writing;

typedef enum rig_field_kind { /* type in memory, and in the file if that differs */
                              FIELD_CUSTOM = 0, /* functions read and write it */
                              FIELD_NUMBER,     /* double, low..high */
                              FIELD_POINT,      /* vec3, mm; in the unit of the file */
                              FIELD_RADII,      /* the same, each greater than 0 */
                              FIELD_DIRECTION,  /* vec3 longer than 0, without a unit */
                              FIELD_AXIS,       /* the same, of length 1 in memory */
                              FIELD_RANGE,  /* two doubles, rad; [least, greatest] deg in low..high,
                                               includes 0 */
                              FIELD_TEXT,   /* char *, at most `high` bytes */
                              FIELD_VERTEX, /* uint32_t */
                              FIELD_VERTICES, /* uint32_t *, with low..high elements, and their
                                                 count */
                              FIELD_FLAG,     /* bool */
                              FIELD_WORD,     /* enum, low..high; a word */
                              FIELD_BONE,     /* uint32_t, a bone that was read before; its name;
                                                 optional: RIG_NONE is "auto" */
                              FIELD_OBJECT    /* struct with a table of its own */
} rig_field_kind;

typedef enum rig_field_use {
    FIELD_NEEDED = 0,
    FIELD_OPTIONAL, /* an absent key means `usual` */
    FIELD_OMITTED   /* the same, and `usual` is never written; RIG_NONE for a bone */
} rig_field_use;

typedef struct rig_field {
    const char *key; /* NULL ends the table */
    rig_field_kind kind;
    rig_field_use use;
    size_t offset, count_offset; /* in the struct of the table */
    double low, high, usual;     /* in the unit of the file; of a range: usual greatest, rad */
    const char *expected;        /* for messages: "a name like \"jaw\"" */
    const char *(*word)(int value);
    const struct rig_field *inner; /* of an object */
    /* Checks the struct after the value was read. `at`: the value. */
    mrt_result (*check)(const void *of, const json_node *at, error *err);
    /* Of a custom field. `out`, `of`: struct of the table; `at`, `to`: object with the key. NULL:
     * nothing to read, or to write. */
    mrt_result (*read)(void *out, const json_node *at, rig_reading *in, error *err);
    void (*write)(json_t *to, const void *of, rig_writing *w);
} rig_field;

/* Reads all fields of an object into a struct with their usual values, in the order of the table.
 * Notes unknown keys. at: NULL for the root, where each key comes from the last file that has it.
 * On error the struct can be finished. */
CHECKED mrt_result rig_fields_read(void *out, const rig_field *fields, const json_node *at,
                                   rig_reading *in, error *err);
CHECKED mrt_result rig_field_read(void *out, const rig_field *f, const json_node *at,
                                  rig_reading *in, error *err); /* a single field */
/* Returns the member `key`, of the root too. */
json_node rig_field_member(const json_node *at, const char *key, const rig_reading *in);
void rig_fields_note_unknown(const rig_field *fields, const json_node *at, rig_reading *in);

/* Sets the keys whose meaning in `to` differs from the struct. */
void rig_fields_write(json_t *to, const rig_field *fields, const void *of, rig_writing *w);
void rig_field_write(json_t *to, const rig_field *f, const void *of, rig_writing *w);

extern const rig_field rig_root_fields[]; /* the whole file; rig_format.c */
void rig_write_paints(json_t *to, const void *of, rig_writing *w); /* "paints"; rig_write.c */

/* ---- values, for custom fields ---- */

CHECKED mrt_result rig_json_point(vec3 *out, const json_node *at, double scale, error *err);
CHECKED mrt_result rig_json_vertex(uint32_t *out, const json_node *at, error *err);

void rig_set(json_t *to, const char *key, json_t *value, rig_writing *w); /* takes the value */
void rig_set_text(json_t *to, const char *key, const char *text, rig_writing *w);
/* usual: meaning of an absent key; NaN: none. The file has value / scale. */
void rig_set_number(json_t *to, const char *key, double value, double scale, double usual,
                    rig_writing *w);
void rig_set_point(json_t *to, const char *key, vec3 point, rig_writing *w);
json_t *rig_set_object(json_t *to, const char *key, rig_writing *w); /* existing or new; borrowed */

#endif
