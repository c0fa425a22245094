/* ui/cli/facts.h - the results of a command: one line per fact, a brief summary, or one JSON
 * object. Keys are lower case and end with the unit ("frame_median_ms"). [main] */
#ifndef MAROTTE_UI_FACTS_H
#define MAROTTE_UI_FACTS_H
#include "base/error.h"

#include <stdbool.h>

struct json_t;
typedef struct facts facts;

/* Prints the JSON object of a command and a newline, with the flags of json_dumpf. Frees the
 * object. */
void facts_print_json(struct json_t *object, size_t flags);

typedef enum facts_form {
    FACTS_LINES = 0, /* every fact */
    FACTS_BRIEF,     /* headlines, files and warnings */
    FACTS_JSON
} facts_form;

facts *facts_create(facts_form form); /* NULL: no memory */
bool facts_is_brief(const facts *self);
/* JSON: prints the object. Brief: prints the warnings, or that there are none. Frees self; accepts
 * NULL. */
void facts_finish(facts *self);
/* JSON only: writes the object to a file. */
CHECKED mrt_result facts_save(const facts *self, const char *path, error *err);
/* Frees self and prints nothing more: the command failed. */
void facts_abandon(facts *self);

/* Adds "label  value unit", with this number of decimals. */
void facts_number(facts *self, const char *key, const char *label, double value, int decimals,
                  const char *unit);
void facts_text(facts *self, const char *key, const char *label, const char *value);
/* Adds a line for a person; also printed in brief form. */
void facts_headline(facts *self, const char *label, const char *text);
/* Adds a written file to the list "files". opener: how to open it, or "". */
void facts_file(facts *self, const char *path, const char *opener);
/* facts_number for a problem; in brief form it is printed as a warning at the end. */
void facts_warning(facts *self, const char *key, const char *label, double value, int decimals,
                   const char *unit);
/* facts_list for a problem, likewise. */
void facts_warning_list(facts *self, const char *key, const char *label, const char *value);
/* Adds a text to a list, and prints it as "label  value". */
void facts_list(facts *self, const char *key, const char *label, const char *value);

/* Adds a row to a list: "label  line" for a person, an object in JSON. */
typedef struct facts_cell {
    const char *key;
    const char *text; /* NULL: use the number */
    double number;
    int decimals; /* 0: an integer; < 0: a boolean */
} facts_cell;
void facts_row(facts *self, const char *key, const char *label, const char *line,
               const facts_cell *cells, int count);

#endif
