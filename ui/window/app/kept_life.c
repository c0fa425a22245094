#include "window/app/kept_life.h"

#include "base/clock.h"
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTE = 256 };
static const char note_key[] = "life";
static const char *const kind_name[LIFE_KINDS] = {
    [LIFE_BLINK] = "blink", [LIFE_GAZE] = "gaze", [LIFE_BREATH] = "breath", [LIFE_LEAN] = "lean"};

struct kept_life {
    app *of;
    bool lives;
    life_settings now;
};

/* ---- the note of a show: "blink on 0.5 gaze off 0.5 ... seed 12" ---- */

static life_settings settings_by_default(void)
{
    life_settings out = {.seed = 1};
    for (int i = 0; i < LIFE_KINDS; ++i)
        out.strength[i] = 0.5;
    return out;
}

static void write_note(const life_settings *from, char out[NOTE])
{
    int length = 0;
    for (int i = 0; i < LIFE_KINDS; ++i)
        length += snprintf(out + length, NOTE - (size_t)length, "%s %s %.6g ", kind_name[i],
                           from->is_on[i] ? "on" : "off", from->strength[i]);
    (void)snprintf(out + length, NOTE - (size_t)length, "seed %u", from->seed);
}

static bool read_number(text_view *rest, double most, double *out)
{
    text_view word;
    return text_next_word(rest, &word) && text_double(word, out) && *out >= 0.0 && *out <= most;
}

static bool parse_note(life_settings *out, const char *text)
{
    text_view rest = text_view_of(text, strlen(text)), word;
    double number = 0.0;
    for (int i = 0; i < LIFE_KINDS; ++i) {
        if (!text_next_word(&rest, &word) || !text_equals(word, kind_name[i]) ||
            !text_next_word(&rest, &word))
            return false;
        out->is_on[i] = text_equals(word, "on");
        if ((!out->is_on[i] && !text_equals(word, "off")) || !read_number(&rest, 1.0, &number))
            return false;
        out->strength[i] = number;
    }
    if (!text_next_word(&rest, &word) || !text_equals(word, "seed") ||
        !read_number(&rest, LIFE_SEED_MOST, &number))
        return false;
    out->seed = (uint32_t)number;
    return !text_next_word(&rest, &word);
}

static void keep(kept_life *self)
{
    show *into = app_show(self->of);
    char text[NOTE];
    error err = {""};
    write_note(&self->now, text);
    if (into && show_is_writable(into) && show_note_write(into, note_key, text, &err) < 0)
        news_list_add(app_news(self->of), MRT_LOG_ERROR, "life", err.text);
}

/* A show in which nothing was performed yet. */
static bool is_new(show *of)
{
    int64_t *id = NULL;
    size_t count = 1;
    error ignored = {""};
    const bool is_empty = show_performance_ids(of, &id, &count, &ignored) >= 0 && count == 0;
    free(id);
    return is_empty;
}

void kept_life_read(kept_life *self)
{
    show *from = app_show(self->of);
    char text[NOTE] = "";
    error err = {""};
    app_forget_changes(self->of, self);
    self->now = settings_by_default();
    if (!from)
        return;
    mrt_result result = show_note_read(from, note_key, text, sizeof text, &err);
    life_settings read = self->now;
    if (result >= 0 && text[0] && !parse_note(&read, text))
        result = error_set(&err, MRT_ERR_FORMAT,
                           "%s: the settings of life are invalid. The face does not live.",
                           show_path(from));
    if (result < 0)
        news_list_add(app_news(self->of), MRT_LOG_WARNING, "life", err.text);
    else if (text[0])
        self->now = read;
    if (result < 0 || text[0] || !self->lives || !show_is_writable(from) || !is_new(from))
        return;
    for (int i = 0; i < LIFE_KINDS; ++i)
        self->now.is_on[i] = true;
    self->now.seed = (uint32_t)(clock_utc_ms() % ((int64_t)LIFE_SEED_MOST + 1));
    keep(self);
}

/* ---- changes ---- */

static mrt_result set(void *owner, const void *value)
{
    kept_life *self = owner;
    self->now = *(const life_settings *)value;
    keep(self);
    return MRT_OK;
}

const life_settings *kept_life_now(const kept_life *self)
{
    return &self->now;
}

void kept_life_change(kept_life *self, const life_settings *to, const char *words)
{
    const life_settings before = self->now;
    undo_change made = {.owner = self, .set = set};
    (void)snprintf(made.words, sizeof made.words, "life: %.120s", words);
    (void)set(self, to);
    app_add_copied_change(self->of, &made, &before, to, sizeof before);
}

void kept_life_toggle(kept_life *self)
{
    life_settings to = self->now;
    bool is_any = false;
    for (int i = 0; i < LIFE_KINDS; ++i)
        is_any |= to.is_on[i];
    for (int i = 0; i < LIFE_KINDS; ++i)
        to.is_on[i] = !is_any;
    kept_life_change(self, &to, is_any ? "off" : "on");
}

kept_life *kept_life_create(app *of, bool lives)
{
    kept_life *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    *self = (kept_life){.of = of, .lives = lives, .now = settings_by_default()};
    return self;
}

void kept_life_destroy(kept_life *self)
{
    free(self);
}
