/* io/ply_header.h - the header of a PLY file: its format and what its elements consist of. Every
 * count in it is checked against the bytes that follow. Private to the PLY reader; pure. */
#ifndef MAROTTE_IO_PLY_HEADER_H
#define MAROTTE_IO_PLY_HEADER_H
#include "base/error.h"
#include "base/text.h"

enum { PLY_ELEMENTS_MAX = 32, PLY_PROPERTIES_MAX = 256, PLY_LINE_LENGTH_MAX = 1 << 20 };

typedef enum ply_format { PLY_ASCII = 0, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_format;

typedef enum ply_type {
    PLY_NONE = 0,
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT32,
    PLY_FLOAT64
} ply_type;

typedef struct ply_property {
    char name[64];
    ply_type type;
    ply_type list_type; /* of the count of a list; PLY_NONE: a single value */
} ply_property;

typedef struct ply_element {
    char name[64];
    int64_t count;
    uint32_t first_property, property_count;
} ply_element;

typedef struct ply_header {
    ply_format format;
    ply_element element[PLY_ELEMENTS_MAX];
    ply_property property[PLY_PROPERTIES_MAX];
    uint32_t element_count, property_count;
    uint64_t line_count;
} ply_header;

/* Takes the header off `rest`. */
CHECKED mrt_result ply_header_parse(ply_header *out, text_view *rest, error *err);
size_t ply_type_size(ply_type type); /* bytes */

#endif
