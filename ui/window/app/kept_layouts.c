#include "window/app/kept_layouts.h"

#include "show/hash.h"

#include <stdio.h>
#include <string.h>

static const char shows_key[] = "layouts.shows", recent_key[] = "layouts.recent", of_new[] = "new";
static const char *const layout_name[LAYOUTS] = {
    [LAYOUT_PERFORM] = "perform", [LAYOUT_EDIT] = "edit", [LAYOUT_RIG] = "rig"};

typedef char key[96];

/* "layouts.shows.s0123456789abcdef.edit", "layouts.shows.new.edit" */
static void write_key(key out, const char *show, const char *what)
{
    (void)snprintf(out, sizeof(key), "%s.%s.%s", shows_key, show[0] ? show : of_new, what);
}

/* What the settings have for a layout of a show, or for new shows; NULL: nothing. */
static const char *text_of(const settings *from, const char *show, app_layout of)
{
    key own, other;
    write_key(own, show, layout_name[of]);
    write_key(other, "", layout_name[of]);
    return settings_text(from, own, settings_text(from, other, NULL));
}

static void read_one(arrangement *out, const settings *from, const char *show, app_layout of)
{
    const char *text = text_of(from, show, of);
    arrangement_init(out, of);
    if (text)
        arrangement_read(out, of, text);
}

static app_layout layout_of(const settings *from, const char *show)
{
    key own, other;
    write_key(own, show, "layout");
    write_key(other, "", "layout");
    const char *name = settings_text(from, own, settings_text(from, other, ""));
    for (app_layout i = LAYOUT_PERFORM; i < LAYOUTS; ++i)
        if (strcmp(name, layout_name[i]) == 0)
            return i;
    return LAYOUT_PERFORM;
}

void kept_layouts_read(kept_layouts *self, const settings *from, const char *show_path)
{
    char hash[TAKE_HASH];
    self->show[0] = '\0';
    if (show_path) {
        hash_bytes(hash, show_path, strlen(show_path));
        (void)snprintf(self->show, sizeof self->show, "s%.16s", hash);
    }
    self->of = layout_of(from, self->show);
    read_one(&self->now, from, self->show, self->of);
}

/* The newest first; the settings lose the layouts of the show that is one too many. */
static void note_recent(const char *show, settings *to)
{
    const char *list[KEPT_LAYOUT_SHOWS + 1];
    char kept[KEPT_LAYOUT_SHOWS][sizeof((kept_layouts *)NULL)->show];
    key oldest;
    uint32_t count = 0;
    const uint32_t before = settings_list(to, recent_key, list, KEPT_LAYOUT_SHOWS);
    if (before > 0 && strcmp(list[0], show) == 0)
        return;
    for (uint32_t i = 0; i < before; ++i)
        if (strcmp(list[i], show) != 0)
            (void)snprintf(kept[count++], sizeof kept[0], "%s", list[i]);
    if (count == KEPT_LAYOUT_SHOWS) {
        (void)snprintf(oldest, sizeof oldest, "%s.%s", shows_key, kept[--count]);
        settings_set_text(to, oldest, NULL);
    }
    list[0] = show;
    for (uint32_t i = 0; i < count; ++i)
        list[i + 1] = kept[i];
    settings_set_list(to, recent_key, list, count + 1, KEPT_LAYOUT_SHOWS);
}

void kept_layouts_write(const kept_layouts *self, settings *to)
{
    arrangement as_read;
    char text[ARRANGEMENT_TEXT], before[ARRANGEMENT_TEXT];
    key at;
    read_one(&as_read, to, self->show, self->of);
    arrangement_write(&as_read, before);
    arrangement_write(&self->now, text);
    const bool is_same = strcmp(text, before) == 0;
    if (is_same && layout_of(to, self->show) == self->of)
        return;
    write_key(at, self->show, layout_name[self->of]);
    if (!is_same)
        settings_set_text(to, at, text);
    write_key(at, self->show, "layout");
    settings_set_text(to, at, layout_name[self->of]);
    if (self->show[0])
        note_recent(self->show, to);
}

void kept_layouts_switch(kept_layouts *self, settings *in, app_layout to)
{
    kept_layouts_write(self, in);
    self->of = to;
    read_one(&self->now, in, self->show, to);
}

void kept_layouts_reset(kept_layouts *self)
{
    arrangement_init(&self->now, self->of);
}

/* Writes all layouts of one show as those of another; "": of new shows. */
static void copy_layouts(settings *in, const char *from, app_layout shown, const char *to)
{
    char text[ARRANGEMENT_TEXT];
    key at;
    for (app_layout i = LAYOUT_PERFORM; i < LAYOUTS; ++i) {
        arrangement one;
        read_one(&one, in, from, i);
        arrangement_write(&one, text);
        write_key(at, to, layout_name[i]);
        settings_set_text(in, at, text);
    }
    write_key(at, to, "layout");
    settings_set_text(in, at, layout_name[shown]);
}

void kept_layouts_use_for_new(const kept_layouts *self, settings *to)
{
    kept_layouts_write(self, to);
    copy_layouts(to, self->show, self->of, "");
}

void kept_layouts_copy(kept_layouts *self, settings *in, const kept_layouts *from)
{
    kept_layouts_write(from, in);
    copy_layouts(in, from->show, from->of, self->show);
    self->of = from->of;
    read_one(&self->now, in, self->show, self->of);
    if (self->show[0])
        note_recent(self->show, in);
}
