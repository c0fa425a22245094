/* stage/mapping/library_file.h - whether a file can be given to dlopen without harm: dlopen waits
 * for ever on a pipe, and a library that is cut short kills the program by SIGBUS when its missing
 * pages are touched. What is wrong otherwise is left to dlopen to say. [main] */
#ifndef MAROTTE_STAGE_LIBRARY_FILE_H
#define MAROTTE_STAGE_LIBRARY_FILE_H
#include "base/error.h"

/* Refuses what is not a regular file and libraries whose segments lie beyond the file's end. The
 * error does not name the path. */
CHECKED mrt_result library_file_check(const char *path, error *err);

#endif
