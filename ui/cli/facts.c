#include "cli/facts.h"
#include "base/text.h"

#include "base/file.h"
#include "base/json.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARNINGS_MAX = 16, WARNING_LENGTH = 256 };

struct facts {
    facts_form form;
    json_t *object; /* FACTS_JSON */
    uint32_t warning_count;
    char warning[WARNINGS_MAX][WARNING_LENGTH]; /* FACTS_BRIEF */
};

/* Replaces characters that are not printable: the text may contain file names from an untrusted
 * source. */
static void print_text(const char *text)
{
    char *shown = strdup(text);
    if (shown)
        text_make_printable(shown);
    fputs(shown ? shown : "", stdout);
    free(shown);
}

static void print_line(const char *label, const char *text)
{
    printf("%-18s ", label);
    print_text(text);
    putchar('\n');
}

void facts_print_json(json_t *object, size_t flags)
{
    (void)json_dumpf(object, stdout, flags);
    putchar('\n');
    json_decref(object);
}

facts *facts_create(facts_form form)
{
    facts *self = calloc(1, sizeof *self);
    if (self)
        self->form = form;
    if (!self || form != FACTS_JSON)
        return self;
    self->object = json_object();
    if (self->object)
        return self;
    free(self);
    return NULL;
}

bool facts_is_brief(const facts *self)
{
    return self->form == FACTS_BRIEF;
}

void facts_abandon(facts *self)
{
    if (!self)
        return;
    json_decref(self->object);
    free(self);
}

mrt_result facts_save(const facts *self, const char *path, error *err)
{
    char *text = json_dumps(self->object, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    size_t length = text ? strlen(text) : 0;
    mrt_result result = text ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    if (result >= 0) {
        text[length] = '\n'; /* replaces the final 0 */
        result = file_write(path, text, length + 1, err);
    }
    free(text);
    return result;
}

void facts_finish(facts *self)
{
    if (self && self->object)
        facts_print_json(json_incref(self->object), JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    for (uint32_t i = 0; self && i < self->warning_count; ++i)
        print_line("warning", self->warning[i]);
    if (self && facts_is_brief(self) && self->warning_count == 0)
        print_line("warnings", "none");
    facts_abandon(self);
}

void facts_number(facts *self, const char *key, const char *label, double value, int decimals,
                  const char *unit)
{
    if (self->object)
        json_object_set_new(self->object, key,
                            decimals == 0 ? json_integer((json_int_t)llround(value))
                                          : json_real(value));
    else if (self->form == FACTS_LINES)
        printf("%-18s %.*f%s%s\n", label, decimals, value, unit[0] ? " " : "", unit);
}

void facts_warning(facts *self, const char *key, const char *label, double value, int decimals,
                   const char *unit)
{
    while (*label == ' ')
        ++label;
    if (!facts_is_brief(self))
        facts_number(self, key, label, value, decimals, unit);
    else if (self->warning_count < WARNINGS_MAX)
        (void)snprintf(self->warning[self->warning_count++], WARNING_LENGTH, "%s: %.*f%s%s", label,
                       decimals, value, unit[0] ? " " : "", unit);
}

void facts_headline(facts *self, const char *label, const char *text)
{
    if (self->form != FACTS_JSON)
        print_line(label, text);
}

void facts_text(facts *self, const char *key, const char *label, const char *value)
{
    if (self->object)
        json_object_set_new(self->object, key, json_text(value));
    else if (self->form == FACTS_LINES)
        print_line(label, value);
}

static json_t *list_of(facts *self, const char *key)
{
    json_t *list = json_object_get(self->object, key);
    if (!list) {
        list = json_array();
        json_object_set_new(self->object, key, list);
    }
    return list;
}

void facts_list(facts *self, const char *key, const char *label, const char *value)
{
    if (self->object)
        json_array_append_new(list_of(self, key), json_text(value));
    else if (self->form == FACTS_LINES)
        print_line(label, value);
}

void facts_file(facts *self, const char *path, const char *opener)
{
    char line[4352];
    (void)snprintf(line, sizeof line, "%.4000s%s%.300s", path, opener[0] ? " - " : "", opener);
    if (self->object)
        json_array_append_new(list_of(self, "files"), json_text(path));
    else
        print_line("wrote", line);
}

static json_t *value_of(const facts_cell *cell)
{
    if (cell->text)
        return json_text(cell->text);
    if (cell->decimals < 0)
        return json_boolean(cell->number > 0.0);
    return cell->decimals == 0 ? json_integer((json_int_t)llround(cell->number))
                               : json_real(cell->number);
}

void facts_warning_list(facts *self, const char *key, const char *label, const char *value)
{
    facts_list(self, key, label, value);
    if (facts_is_brief(self) && self->warning_count < WARNINGS_MAX)
        (void)snprintf(self->warning[self->warning_count++], WARNING_LENGTH, "%s: %s", label,
                       value);
}

void facts_row(facts *self, const char *key, const char *label, const char *line,
               const facts_cell *cells, int count)
{
    if (self->form == FACTS_LINES)
        print_line(label, line);
    if (!self->object)
        return;
    json_t *row = json_object();
    for (int i = 0; i < count; ++i)
        json_object_set_new(row, cells[i].key, value_of(&cells[i]));
    json_array_append_new(list_of(self, key), row);
}
