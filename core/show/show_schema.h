/* show/show_schema.h - the tables of a show (show_format.md describes each column), and the
 * migration of older versions. Leaves out whether a file may be written (show_open.c). The thread
 * of the connection. */
#ifndef MAROTTE_TAKE_SHOW_SCHEMA_H
#define MAROTTE_TAKE_SHOW_SCHEMA_H
#include "show/sqlite.h"

enum { SHOW_VERSION = 3 };

typedef struct show_table {
    const char *name;
    const char *key; /* column that sorts its rows */
    bool has_id; /* true if the key is a number, so that rows after damage can be read one by one */
    const char *kinds; /* type of each column, as for sqlite_prepare */
    const char *light; /* its columns except the blob, which is last; "*": it has no blob */
    int since;         /* first version that has it */
} show_table;
enum { SHOW_TABLES = 20 };
extern const show_table show_tables[SHOW_TABLES];

/* Checks that the file has exactly the tables of that version. SQLite would evaluate expressions in
 * columns, indexes and views, so all other schema objects are refused. A newer version may have
 * more tables, and more columns of plain values. Only reads. *out_oldest_reader: the lowest format
 * version that can read the file. */
CHECKED mrt_result show_schema_check(sqlite *db, int64_t version, int64_t *out_oldest_reader,
                                     error *err);
/* Creates the tables in an empty database. */
CHECKED mrt_result show_schema_create(sqlite *db, error *err);
/* Migrates from `version`, 1..SHOW_VERSION, to SHOW_VERSION in one transaction: all steps or none.
 */
CHECKED mrt_result show_schema_migrate(sqlite *db, int64_t version, error *err);

#endif
