/* ui/cli/facts.h - the results of a command: one line per fact for a person, a few lines of them, or
 * one JSON object for a machine. Keys are lower case with the unit at their end
 * ("frame_median_ms"). [main] */
#ifndef MAROTTE_UI_FACTS_H
#define MAROTTE_UI_FACTS_H
#include "base/error.h"

#include <stdbool.h>

struct json_t;
typedef struct facts facts;

/* An object of a command's own, and a newline, with the flags of json_dumpf. Frees it. */
void facts_print_json(struct json_t *object, size_t flags);

typedef enum facts_form {
    FACTS_LINES = 0, /* every fact */
    FACTS_BRIEF,     /* headlines, files and warnings */
    FACTS_JSON
} facts_form;

facts *facts_create(facts_form form); /* NULL: no memory */
bool facts_is_brief(const facts *self);
/* As JSON: prints the object. In brief: prints the warnings, or that there are none. Frees it; NULL
 * is fine. */
void facts_finish(facts *self);
/* As JSON only: writes the object into a file. */
CHECKED mrt_result facts_save(const facts *self, const char *path, error *err);
/* Frees it and prints nothing more: the command failed. */
void facts_abandon(facts *self);

/* "label  value unit", value with so many decimals. */
void facts_number(facts *self, const char *key, const char *label, double value, int decimals,
                  const char *unit);
void facts_text(facts *self, const char *key, const char *label, const char *value);
/* A line for a person, also in brief. */
void facts_headline(facts *self, const char *label, const char *text);
/* A file that was written, for the list "files"; `opener` names programs that open it, or "". */
void facts_file(facts *self, const char *path, const char *opener);
/* facts_number of something that went wrong; in brief it is printed as a warning at the end. */
void facts_warning(facts *self, const char *key, const char *label, double value, int decimals,
                   const char *unit);
/* facts_list, likewise. */
void facts_warning_list(facts *self, const char *key, const char *label, const char *value);
/* Adds to a list of texts: "label  value" for each. */
void facts_list(facts *self, const char *key, const char *label, const char *value);

/* One thing of a list of things: "label  line" for a person, an object for a machine. */
typedef struct facts_cell {
    const char *key;
    const char *text; /* NULL: the number */
    double number;
    int decimals; /* 0: whole; < 0: true or false */
} facts_cell;
void facts_row(facts *self, const char *key, const char *label, const char *line,
               const facts_cell *cells, int count);

#endif
