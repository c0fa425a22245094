/* base/error.h - errors: a result code, and one line of text that names the failed thing and the
 * remedy. The function that detects an error writes the text; callers pass it on; the program
 * prints it once. Leaves out log messages (log.h). [any] */
#ifndef MAROTTE_BASE_ERROR_H
#define MAROTTE_BASE_ERROR_H
#include <marotte/plugin.h>

#define CHECKED __attribute__((warn_unused_result))

typedef struct error {
    char text[1024]; /* one line without a newline; "" without an error */
} error;

/* Writes the text, cut at the end if it is too long, and returns `code`. `out` may be NULL. Makes
 * the text printable (text_make_printable), because it may contain file names and texts from
 * untrusted sources. */
__attribute__((format(printf, 3, 4))) mrt_result error_set(error *out, mrt_result code,
                                                           const char *format, ...);

#ifdef __clang_analyzer__
/* The analyzer sees one file at a time. This macro tells it that error_set returns `code`. */
void error_check_format(const char *format, ...);
#define error_set(out, code, ...) (error_check_format(__VA_ARGS__), (void)(out), (code))
#endif

/* Prepends "prefix: " to the text; a caller that knows the file adds its name. */
void error_prefix(error *out, const char *prefix);

#endif
