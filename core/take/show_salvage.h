/* take/show_salvage.h - rows out of an SQLite file whose tree of pages is broken: every page that
 * looks like rows of a table is read on its own. What comes out may be old, or nonsense: only rows
 * that carry their own CRC are worth it. Reads any bytes. For show_recover.c. */
#ifndef MAROTTE_TAKE_SHOW_SALVAGE_H
#define MAROTTE_TAKE_SHOW_SALVAGE_H
#include "base/budget.h"

enum { SHOW_SALVAGE_COLUMNS_MAX = 8 };

typedef struct show_salvage_value {
    int64_t number; /* 0 for NULL, texts and blobs */
    const uint8_t *bytes;
    size_t size;
    bool is_blob;
} show_salvage_value;
typedef struct show_salvage_row {
    int64_t id; /* of the row; the column that stands for it is NULL */
    uint32_t column_count;
    show_salvage_value column[SHOW_SALVAGE_COLUMNS_MAX];
} show_salvage_row;

/* Calls `each` for every row of at most SHOW_SALVAGE_COLUMNS_MAX columns, until it fails. MRT_END:
 * what may be spent was used up before the end of the file. */
CHECKED mrt_result show_salvage(const char *path,
                                mrt_result (*each)(void *data, const show_salvage_row *row),
                                void *data, budget *left, error *err);

#endif
