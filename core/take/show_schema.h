/* take/show_schema.h - the tables of a show (README.md says what every column means), and how those
 * of older versions become today's. Leaves out whether a file may be written (show.c). */
#ifndef MAROTTE_TAKE_SHOW_SCHEMA_H
#define MAROTTE_TAKE_SHOW_SCHEMA_H
#include "take/sqlite.h"

/* "MaRT" in the file's header says that it is a show. */
enum { SHOW_APPLICATION = 0x4d615254, SHOW_VERSION = 2 };

/* In an empty database. */
CHECKED mrt_result show_schema_create(sqlite *db, error *err);
/* From `version`, 1..SHOW_VERSION, to SHOW_VERSION in one transaction: all or nothing. */
CHECKED mrt_result show_schema_migrate(sqlite *db, int64_t version, error *err);

#endif
