/* take/writer_leftover.h - brings what a killed writer had been given, and had not committed, into
 * the show. For show.c, which opens it next. */
#ifndef MAROTTE_TAKE_WRITER_LEFTOVER_H
#define MAROTTE_TAKE_WRITER_LEFTOVER_H
#include "take/show_file.h"

/* In a transaction of its own. Nothing left is no error. */
CHECKED mrt_result writer_leftover_commit(show *s, error *err);

#endif
