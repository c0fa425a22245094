/* base/error.h - how a failure travels: a result code, and one line of text that names the thing
 * that failed and what can be done. Whoever detects an error writes the text once; callers pass it
 * on; the program prints it once. Leaves out logging of news (log.h). Any thread. */
#ifndef MAROTTE_BASE_ERROR_H
#define MAROTTE_BASE_ERROR_H
#include <marotte/plugin.h>

#define CHECKED __attribute__((warn_unused_result))

typedef struct error {
    char text[1024]; /* one line without a newline; "" when nothing failed */
} error;

/* Writes the text (cut at the end if too long) and returns `code`. `out` may be NULL. Whatever
 * names of files and words of others are in it, it is one printable line (text_make_printable). */
__attribute__((format(printf, 3, 4))) mrt_result error_set(error *out, mrt_result code,
                                                           const char *format, ...);

#ifdef __clang_analyzer__
/* The analyzer sees one file at a time: this tells it that an error returns its code. */
void error_check_format(const char *format, ...);
#define error_set(out, code, ...) (error_check_format(__VA_ARGS__), (void)(out), (code))
#endif

/* Puts "prefix: " before the text that is there: a caller that knows the file names it. */
void error_prefix(error *out, const char *prefix);

#endif
