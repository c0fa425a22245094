/* show/show_schema.h - the tables of a show (README.md says what every column means), and how those
 * of older versions become today's. Leaves out whether a file may be written (show_open.c). */
#ifndef MAROTTE_TAKE_SHOW_SCHEMA_H
#define MAROTTE_TAKE_SHOW_SCHEMA_H
#include "show/sqlite.h"

enum { SHOW_VERSION = 3 };

typedef struct show_table {
    const char *name;
    const char *key;   /* by which its rows are in order */
    bool has_id;       /* the key is a number: rows behind damage can be asked for one by one */
    const char *kinds; /* what each column holds, as sqlite_prepare has it */
    const char *light; /* its columns but the blob, which is last; "*": there is none */
    int since;         /* the version that has it first */
} show_table;
enum { SHOW_TABLES = 20 };
extern const show_table show_tables[SHOW_TABLES];

/* Whether the tables of a file of that version are those that marotte makes, and nothing else is
 * there: SQLite would evaluate the expressions of columns, indexes and views. A newer version may
 * have more tables, and more columns of plain values. Reads only; *out_oldest_reader: the version
 * that a program must know to read it. */
CHECKED mrt_result show_schema_check(sqlite *db, int64_t version, int64_t *out_oldest_reader,
                                     error *err);
/* In an empty database. */
CHECKED mrt_result show_schema_create(sqlite *db, error *err);
/* From `version`, 1..SHOW_VERSION, to SHOW_VERSION in one transaction: all or nothing. */
CHECKED mrt_result show_schema_migrate(sqlite *db, int64_t version, error *err);

#endif
