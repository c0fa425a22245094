#include "window/timeline/timeline.h"

#include "base/clock.h"
#include "base/text.h"
#include "show/edit_store.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GOOD_STARS = 3 };
static const char *const takes_filter_name[TAKES_FILTERS] = {"All", "3 stars +", "Deleted"};

/* ---- text ---- */

static int lower(char byte)
{
    return tolower((unsigned char)byte);
}

static bool contains(const char *text, text_view word)
{
    size_t length = (size_t)(word.end - word.at);
    for (; *text; ++text) {
        size_t i = 0;
        while (i < length && lower(text[i]) == lower(word.at[i]))
            i += 1;
        if (i == length)
            return true;
    }
    return false;
}

bool timeline_takes_matches(const app_take_line *line, const char *words)
{
    text_view rest = text_view_of(words, strlen(words)), word;
    while (text_next_word(&rest, &word))
        if (!contains(line->title, word) && !contains(line->note, word))
            return false;
    return true;
}

static bool is_shown(const timeline_takes *self, const app_take_line *line)
{
    if ((self->filter == TAKES_DELETED) != line->is_deleted)
        return false;
    if (self->filter == TAKES_GOOD && line->rating < GOOD_STARS)
        return false;
    return self->words[0] == '\0' || timeline_takes_matches(line, self->words);
}

/* ---- the list ---- */

static bool reserve(timeline_takes *self, uint32_t count)
{
    if (count <= self->capacity)
        return true;
    uint32_t capacity = count + count / 2 + 64;
    takes_row *row = realloc(self->row, capacity * sizeof *row);
    if (row)
        self->row = row;
    takes_root *root = realloc(self->root, capacity * sizeof *root);
    if (root)
        self->root = root;
    if (!row || !root)
        return false;
    self->capacity = capacity;
    return true;
}

/* Finds a line by id; lines are sorted by id. Returns `count` if there is none. */
static uint32_t find_index(const app_take_line *line, uint32_t count, int64_t id)
{
    uint32_t low = 0, high = count;
    while (low < high) {
        const uint32_t middle = low + (high - low) / 2;
        if (line[middle].id < id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && line[low].id == id ? low : count;
}

static int64_t *find_unfolded(timeline_takes *self, int64_t id)
{
    for (uint32_t i = 0; i < TAKES_UNFOLDED; ++i)
        if (self->unfolded[i] == id)
            return &self->unfolded[i];
    return NULL;
}

static void toggle_fold(timeline_takes *self, int64_t id)
{
    int64_t *at = find_unfolded(self, id);
    if (at)
        *at = 0;
    else
        self->unfolded[self->unfolded_next++ % TAKES_UNFOLDED] = id;
}

/* Finds the root of each take. Overdubs of overdubs are listed under the first take. */
static void find_roots(timeline_takes *self, const app_take_line *line, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t over = line[i].over ? find_index(line, i, line[i].over) : i;
        const uint32_t root = !is_shown(self, &line[i])                      ? UINT32_MAX
                              : over < i && self->root[over].at < UINT32_MAX ? self->root[over].at
                                                                             : i;
        self->root[i] = (takes_root){.at = root};
        if (root < i)
            self->root[root].over_count += 1;
    }
}

/* Inserts an overdub below its root, ordered by its time on the root's timeline. */
static void put_over(timeline_takes *self, const app_take_line *line, uint32_t i)
{
    takes_root *root = &self->root[self->root[i].at];
    const uint32_t first = root->row + 1;
    uint32_t at = first + root->put_count++;
    for (; at > first && line[self->row[at - 1].line].over_at_ns > line[i].over_at_ns; --at)
        self->row[at] = self->row[at - 1];
    self->row[at] = (takes_row){.line = i, .is_over = true};
}

/* Lays out the rows in each frame; without memory, none. Overdubs that are selected, being recorded
 * or found by the search stay visible. */
static void lay_out_rows(timeline_takes *self, const app_take_line *line, uint32_t count,
                         int64_t chosen)
{
    self->count = 0;
    if (!reserve(self, count))
        return;
    find_roots(self, line, count);
    const uint32_t at = find_index(line, count, chosen);
    for (uint32_t i = count; i-- > 0;) {
        takes_root *root = &self->root[i];
        if (root->at != i)
            continue;
        root->is_unfolded = self->words[0] || find_unfolded(self, line[i].id) ||
                            (at < count && at != i && self->root[at].at == i) ||
                            (self->root[count - 1].at == i && line[count - 1].is_recording);
        root->row = self->count++;
        self->row[root->row] = (takes_row){.line = i, .over_count = root->over_count};
        self->count += root->is_unfolded ? root->over_count : 0;
    }
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = self->root[i].at;
        if (root < i && self->root[root].is_unfolded)
            put_over(self, line, i);
    }
}

void timeline_takes_finish(timeline_takes *self)
{
    free(self->row);
    free(self->root);
    *self = (timeline_takes){0};
}

void timeline_takes_duration(char *out, size_t capacity, int64_t duration_ns)
{
    const int64_t tenth_ns = NS_PER_S / 10;
    const int64_t tenths = duration_ns < 0 ? 0 : (duration_ns + tenth_ns / 2) / tenth_ns;
    const int64_t s = tenths / 10;
    if (s < 60)
        (void)snprintf(out, capacity, "%d.%d s", (int)s, (int)(tenths % 10));
    else if (s < 3600)
        (void)snprintf(out, capacity, "%d:%02d", (int)(s / 60), (int)(s % 60));
    else
        (void)snprintf(out, capacity, "%d:%02d:%02d", (int)(s / 3600), (int)(s / 60 % 60),
                       (int)(s % 60));
}

/* ---- the list on the screen ---- */

#define ROW_HEIGHT  26.0f
#define STAR_WIDTH  12.0f
#define STARS_WIDTH (5.0f * STAR_WIDTH)
#define TIME_WIDTH  50.0f
#define ASK_LABEL   70.0f
enum { STARS = 5 };

/* ---- a line ---- */

static void paint_stars(ui *on, float x, float y, uint32_t rating)
{
    for (uint32_t i = 0; i < STARS; ++i)
        if (i < rating)
            ui_draw_text(on, x + (float)i * STAR_WIDTH, y, UI_STYLE_BODY, THEME_ACCENT, 0.0f,
                         "\u2605");
        else
            ui_draw_disc(on, x + (float)i * STAR_WIDTH + 5.5f, y + 9.0f, 1.5f, 0x565b62ffu);
}

/* Draws the rating: all five stars if the user can click them, otherwise only the rated ones.
 * Returns the x of the first star. */
static float paint_rating(ui *on, float right, float y, uint32_t rating, bool is_wide)
{
    char words[16];
    if (is_wide) {
        paint_stars(on, right - STARS_WIDTH, y, rating);
        return right - STARS_WIDTH;
    }
    if (rating == 0)
        return right;
    (void)snprintf(words, sizeof words, "%u\u2605", rating);
    float width = ui_text_width(on, UI_STYLE_BODY, words);
    ui_draw_text(on, right - width, y, UI_STYLE_BODY, THEME_ACCENT, 0.0f, words);
    return right - width;
}

#define FOLD_WIDTH 14.0f

static bool is_folded(const panel *self, const takes_row *row)
{
    const takes_row *next = row + 1;
    return next >= self->takes.row + self->takes.count || !next->is_over;
}

/* Draws the fold arrow. It points down while the overdubs are visible. */
static void paint_fold(ui *on, float x, float y, bool is_folded)
{
    const float right[6] = {x, y - 4.0f, x, y + 4.0f, x + 5.0f, y};
    const float down[6] = {x - 1.5f, y - 2.5f, x + 6.5f, y - 2.5f, x + 2.5f, y + 2.5f};
    ui_draw_triangle(on, is_folded ? right : down, THEME_DIM);
}

/* Writes the title of a row. An overdub also has its time: "at 12.3 s 1/a/4 Poses". */
static void put_title(char out[256], const app_take_line *line, bool is_over)
{
    char at[24];
    timeline_takes_duration(at, sizeof at, line->over_at_ns);
    (void)snprintf(out, 256, "%s%s%s%s", is_over ? "at " : "", is_over ? at : "",
                   is_over ? "  " : "", line->title);
}

static void paint_line(panel *self, ui *on, const app_take_line *line, const takes_row *row,
                       ui_rectangle where, bool is_hovered)
{
    char title[256];
    bool is_chosen = app_take_id(self->app) == line->id;
    float x = where.x + 10.0f, y = where.y + 0.5f * (where.height - 17.0f);
    float right = where.x + where.width - 8.0f;
    char time[24];
    timeline_takes_duration(time, sizeof time, line->duration_ns);
    if (is_chosen)
        ui_draw_box(on, where, THEME_RAISED, 0.0f);
    else if (is_hovered)
        ui_draw_box(on, where, 0x25292effu, 0.0f);
    if (is_chosen)
        ui_draw_box(on, (ui_rectangle){where.x, where.y, 3.0f, where.height}, THEME_ACCENT, 0.0f);
    if (line->is_recording) {
        ui_draw_disc(on, x + 4.0f, y + 9.0f, 4.5f, THEME_RECORD);
        x += 16.0f;
    }
    put_title(title, line, row->is_over);
    if (row->over_count > 0)
        paint_fold(on, x, y + 9.0f, is_folded(self, row));
    if (row->over_count > 0 || row->is_over)
        x += FOLD_WIDTH;
    float width = ui_text_width(on, UI_STYLE_NUMBER, time);
    ui_draw_text(on, right - width, y, UI_STYLE_NUMBER, THEME_DIM, 0.0f, time);
    const uint32_t rating = self->rates.take == line->id
                                ? self->rates.rating
                                : line->rating; /* rating shown directly after the click */
    float stars = paint_rating(on, right - TIME_WIDTH - 4.0f, y, rating, is_hovered && is_chosen);
    ui_draw_text(on, x, y, is_chosen ? UI_STYLE_STRONG : UI_STYLE_BODY,
                 is_chosen          ? THEME_ACCENT
                 : line->is_deleted ? THEME_DIM
                                    : THEME_TEXT,
                 stars - 8.0f - x, title);
}

/* ---- actions ---- */

static void edit_take(panel *self, int64_t id, edit *e)
{
    if (app_take_id(self->app) == id)
        (void)!app_edit(self->app, e);
    else
        (void)!app_edit_take(self->app, id, e);
    edit_finish(e);
}

/* Longer than the interval of a double click (ui.h). */
#define RATES_AFTER_S 0.35

static void rate(panel *self, const app_take_line *line, uint32_t stars)
{
    self->rates.take = line->id;
    self->rates.rating = stars == line->rating ? stars - 1 : stars;
    self->rates.wait_s = RATES_AFTER_S;
}

void timeline_takes_update(panel *self, double dt_s)
{
    edit e;
    self->rates.wait_s -= dt_s;
    if (self->rates.take && self->rates.wait_s > 0.0)
        app_want_frame(self->app, self->rates.wait_s);
    if (!self->rates.take || self->rates.wait_s > 0.0)
        return;
    edit_init(&e, EDIT_TAKE_RATE);
    e.rating = self->rates.rating;
    edit_take(self, self->rates.take, &e);
    self->rates.take = 0;
}

static void choose_take(panel *self, int64_t id)
{
    (void)!app_choose_take(self->app, id); /* the function reports its own errors */
}

/* Selects a take, so that Space and Del apply to it. */
static void select_take(panel *self, int64_t id)
{
    (void)!app_select_take(self->app, id);
    app_choice *choice = app_chosen(self->app);
    *choice = (app_choice){.marker = -1, .armed = choice->armed, .is_take = true};
}

/* Returns the star under the pointer, 1..5. */
static uint32_t star_at(ui_rectangle where, float x)
{
    float from = where.x + where.width - 8.0f - TIME_WIDTH - STARS_WIDTH - 4.0f;
    if (x < from || x >= from + STARS_WIDTH)
        return 0;
    return 1 + (uint32_t)((x - from) / STAR_WIDTH);
}

static bool is_on_fold(const takes_row *row, const ui_canvas *canvas)
{
    return row->over_count > 0 && canvas->x < 10.0f + FOLD_WIDTH;
}

static void click_line(panel *self, const app_take_line *line, const ui_canvas *canvas,
                       ui_rectangle where)
{
    /* A click anywhere on an unselected line selects it. */
    const bool is_chosen = app_take_id(self->app) == line->id;
    const uint32_t star = is_chosen ? star_at(where, canvas->where.x + canvas->x) : 0;
    const bool is_click = canvas->is_pressed && canvas->button == 0 && !line->is_recording;
    if (canvas->is_double_clicked && canvas->button == 0 && !line->is_deleted) {
        self->rates.take = 0;
        choose_take(self, line->id);
    } else if (is_click && star)
        rate(self, line, star);
    else if (is_click && !line->is_deleted)
        select_take(self, line->id);
    else if (canvas->is_pressed && canvas->button == 1)
        self->takes_menu = line->id;
}

/* ---- the list ---- */

/* Scrolls to a take that was selected elsewhere. */
static void keep_in_sight(panel *self, const app_take_line *line, float height)
{
    int64_t chosen = app_take_id(self->app);
    if (chosen == self->takes_shown)
        return;
    self->takes_shown = chosen;
    for (uint32_t i = 0; i < self->takes.count; ++i) {
        float y = (float)i * ROW_HEIGHT;
        if (line[self->takes.row[i].line].id != chosen)
            continue;
        if (y < self->takes_scroll)
            self->takes_scroll = y;
        if (y + ROW_HEIGHT > self->takes_scroll + height)
            self->takes_scroll = y + ROW_HEIGHT - height;
    }
}

static void hold_scroll(panel *self, float height)
{
    float most = (float)self->takes.count * ROW_HEIGHT - height;
    if (self->takes_scroll > most)
        self->takes_scroll = most;
    if (self->takes_scroll < 0.0f)
        self->takes_scroll = 0.0f;
}

static void paint_scrollbar(panel *self, ui *on, const ui_canvas *canvas)
{
    float all = (float)self->takes.count * ROW_HEIGHT, height = canvas->where.height;
    if (all <= height)
        return;
    float size = height * height / all;
    size = size < 20.0f ? 20.0f : size;
    float y = (height - size) * self->takes_scroll / (all - height);
    ui_draw_box(on,
                (ui_rectangle){canvas->where.x + canvas->where.width - 4.0f, canvas->where.y + y,
                               3.0f, size},
                THEME_HOVER, 1.5f);
}

static void paint_none(panel *self, ui *on, const ui_canvas *canvas, uint32_t count)
{
    const key_map *keys = &app_looks_of(self->app)->keys;
    char first[3][KEY_WORDS + 24] = {"No takes yet."}, record[KEY_WORDS], keep[KEY_WORDS];
    key_map_words(keys, ACTION_RECORD, record);
    key_map_words(keys, ACTION_KEEP, keep);
    (void)snprintf(first[1], sizeof first[1], "%s records a take.", record[0] ? record : "The dot");
    (void)snprintf(first[2], sizeof first[2], "%s keeps the last 30 s.", keep[0] ? keep : "Keep");
    const char *words =
        self->takes.filter == TAKES_DELETED ? "No deleted takes." : "No matching takes.";
    float x = canvas->where.x + 10.0f, y = canvas->where.y + 8.0f;
    float width = canvas->where.width - 16.0f;
    if (count > 0)
        ui_draw_text(on, x, y, UI_STYLE_BODY, THEME_DIM, width, words);
    for (uint32_t i = 0; count == 0 && i < 3; ++i)
        ui_draw_text(on, x, y + 20.0f * (float)i, UI_STYLE_BODY, THEME_DIM, width, first[i]);
}

static void paint_list(panel *self, ui *on, const ui_canvas *canvas, const app_take_line *line,
                       uint32_t count)
{
    float pointed = canvas->y + self->takes_scroll;
    int64_t hovered =
        canvas->is_hovered && canvas->y >= 0.0f ? (int64_t)(pointed / ROW_HEIGHT) : -1;
    uint32_t first = (uint32_t)(self->takes_scroll / ROW_HEIGHT);
    self->hint = "";
    if (self->takes.count == 0)
        paint_none(self, on, canvas, count);
    for (uint32_t i = first; i < self->takes.count; ++i) {
        ui_rectangle where = {canvas->where.x,
                              canvas->where.y + (float)i * ROW_HEIGHT - self->takes_scroll,
                              canvas->where.width, ROW_HEIGHT};
        if (where.y >= canvas->where.y + canvas->where.height)
            break;
        const app_take_line *of = &line[self->takes.row[i].line];
        paint_line(self, on, of, &self->takes.row[i], where, hovered == (int64_t)i);
        if (hovered != (int64_t)i)
            continue;
        (void)snprintf(self->hint_words, sizeof self->hint_words, "%s\n%s", of->title,
                       of->note[0] ? of->note
                                   : "Click to select the take, double-click to show it on the "
                                     "stage, right-click for more actions.");
        self->hint = self->hint_words;
        if (is_on_fold(&self->takes.row[i], canvas)) {
            self->hint = "Show or hide the overdubs of this take.";
            if (canvas->is_pressed && canvas->button == 0)
                toggle_fold(&self->takes, of->id);
        } else if (canvas->is_pressed || canvas->is_double_clicked)
            click_line(self, of, canvas, where);
    }
    paint_scrollbar(self, on, canvas);
}

/* ---- menu and dialog ---- */

static void ask_take(panel *self, ui *on, int64_t id)
{
    error err = {""};
    take t = {0};
    show *from = app_show(self->app);
    if (!from || (edit_store_take(&t, from, id, &err) < 0 && t.id == 0)) {
        timeline_report(self, &err);
        return;
    }
    self->asked_take = id;
    timeline_slip *slip = &self->slip;
    memset(slip, 0, sizeof *slip);
    memcpy(slip->name, t.name, sizeof slip->name);
    memcpy(slip->scene, t.scene, sizeof slip->scene);
    memcpy(slip->shot, t.shot, sizeof slip->shot);
    memcpy(slip->note, t.note, sizeof slip->note);
    (void)snprintf(slip->number, sizeof slip->number, "%u", t.number % 100000);
    self->slip_before = *slip;
    take_finish(&t);
    self->is_asked_first = true;
    ui_dialog_open(on, "timeline_take");
}

static void delete_take(panel *self, const app_take_line *line)
{
    edit e;
    edit_init(&e, line->is_deleted ? EDIT_TAKE_RESTORE : EDIT_TAKE_DELETE);
    edit_take(self, line->id, &e);
}

static void menu(panel *self, ui *on, const app_take_line *line, uint32_t count)
{
    const uint32_t at = find_index(line, count, self->takes_menu);
    const app_take_line *of = &line[at];
    char keys[KEY_WORDS];
    if (at == count || !ui_menu_begin(on, "takes_menu"))
        return;
    if (ui_menu_item(on, "Show on the stage", "", !of->is_deleted && !of->is_recording))
        choose_take(self, of->id);
    else if (ui_menu_item(on, "Name, slate, note \u2026", "", !of->is_recording))
        ask_take(self, on, of->id);
    key_map_words(&app_looks_of(self->app)->keys, ACTION_EXPORT, keys);
    if (ui_menu_item(on, "Export \u2026", keys, !of->is_deleted && !of->is_recording)) {
        if (app_take_id(self->app) != of->id)
            choose_take(self, of->id);
        app_do(self->app, ACTION_EXPORT);
    }
    key_map_words(&app_looks_of(self->app)->keys, ACTION_DUPLICATE, keys);
    if (ui_menu_item(on, "Duplicate", app_take_id(self->app) == of->id ? keys : "",
                     !of->is_deleted && !of->is_recording))
        (void)!app_duplicate_take(self->app, of->id); /* the function reports its own errors */
    else if (ui_menu_item(on, of->is_deleted ? "Restore" : "Delete", "", !of->is_recording))
        delete_take(self, of);
    ui_menu_end(on);
}

static bool read_number(const timeline_slip *slip, uint32_t *out)
{
    int64_t number;
    text_view word = text_trim(text_view_of(slip->number, strlen(slip->number)));
    if (!text_int(word, &number) || number < 1 || number > 99999)
        return false;
    *out = (uint32_t)number;
    return true;
}

static bool is_same_slate(const timeline_slip *a, const timeline_slip *b)
{
    return strcmp(a->scene, b->scene) == 0 && strcmp(a->shot, b->shot) == 0 &&
           strcmp(a->number, b->number) == 0;
}

/* Applies only the changed values. For the selected take this is one undo step. */
static void answer_take(panel *self)
{
    const timeline_slip *slip = &self->slip, *before = &self->slip_before;
    edit name, note, slate;
    const edit *list[3];
    uint32_t count = 0;
    edit_init(&name, EDIT_TAKE_RENAME);
    edit_init(&note, EDIT_TAKE_NOTE);
    edit_init(&slate, EDIT_TAKE_SLATE);
    memcpy(name.name, slip->name, sizeof name.name);
    memcpy(note.note, slip->note, sizeof note.note);
    memcpy(slate.scene, slip->scene, sizeof slate.scene);
    memcpy(slate.shot, slip->shot, sizeof slate.shot);
    if (strcmp(slip->name, before->name) != 0)
        list[count++] = &name;
    if (strcmp(slip->note, before->note) != 0)
        list[count++] = &note;
    if (!is_same_slate(slip, before) && read_number(slip, &slate.number))
        list[count++] = &slate;
    if (count && app_take_id(self->app) == self->asked_take)
        (void)!app_edit_all(self->app, list, count);
    else
        for (uint32_t i = 0; i < count; ++i)
            (void)!app_edit_take(self->app, self->asked_take, list[i]);
}

/* Returns true if the user pressed Enter. */
static bool ask_line(ui *on, const char *label, const char *id, char *text, size_t capacity,
                     float width)
{
    ui_label(on, label, ASK_LABEL, THEME_DIM, label);
    ui_at(on, ASK_LABEL);
    ui_width(on, width);
    (void)ui_input(on, id, "", text, capacity);
    return ui_input_is_entered(on);
}

/* Returns true if the user pressed Enter in a field. */
static bool ask_lines(panel *self, ui *on)
{
    timeline_slip *slip = &self->slip;
    if (self->is_asked_first)
        ui_input_take_keys(on);
    self->is_asked_first = false;
    bool is_entered = ask_line(on, "Name", "##name", slip->name, sizeof slip->name, -1.0f);
    is_entered |= ask_line(on, "Scene", "##scene", slip->scene, sizeof slip->scene, 120.0f);
    is_entered |= ask_line(on, "Shot", "##shot", slip->shot, sizeof slip->shot, 120.0f);
    return ask_line(on, "Number", "##number", slip->number, sizeof slip->number, 60.0f) ||
           is_entered;
}

void timeline_takes_dialog(panel *self, ui *on)
{
    timeline_slip *slip = &self->slip;
    uint32_t number;
    if (!ui_dialog_begin(on, "timeline_take", "Take", 420.0f))
        return;
    bool is_entered = ask_lines(self, on);
    ui_label(on, "note", ASK_LABEL, THEME_DIM, "Note");
    ui_at(on, ASK_LABEL);
    ui_width(on, -1.0f);
    (void)ui_input_lines(on, "##note", slip->note, sizeof slip->note, 70.0f);
    ui_space(on, 8.0f);
    ui_disabled_begin(on, !read_number(slip, &number));
    if (ui_button(on, "Change", UI_ACCENT) || (is_entered && read_number(slip, &number))) {
        answer_take(self);
        ui_dialog_close(on);
    }
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_QUIET))
        ui_dialog_close(on);
    ui_dialog_end(on);
}

/* ---- */

static void put_filter(panel *self, ui *on, uint32_t count)
{
    uint32_t filter = self->takes.filter;
    if (ui_tabs(on, "filter", takes_filter_name, TAKES_FILTERS, &filter)) {
        self->takes.filter = (takes_filter)filter;
        self->takes_scroll = 0.0f;
    }
    if (count < TAKES_SEARCH_FROM && !self->takes.words[0])
        return;
    ui_width(on, -1.0f);
    (void)ui_input(on, "##search", "Search", self->takes.words, sizeof self->takes.words);
}

#define BACK_HEIGHT 32.0f

/* Draws the button that returns to the journal of the last half hour. */
static void put_back(panel *self, ui *on)
{
    if (ui_row(on, "Always recorded", false) != UI_ROW_NONE)
        choose_take(self, 0);
    ui_hint(on, "Show the last half hour in place of the take. Swipe over a span to keep it as a "
                "take (press L twice).");
}

void timeline_takes_draw(panel *self, ui *on, ui_rectangle where)
{
    const app_take_line *line;
    uint32_t count = app_takes(self->app, &line);
    const bool has_back = app_take(self->app) && !app_status(self->app)->is_recording;
    ui_canvas canvas;
    ui_panel_begin(on, "timeline_takes", where, UI_GROUND_PANEL);
    put_filter(self, on, count);
    lay_out_rows(&self->takes, line, count, app_take_id(self->app));
    ui_canvas_begin(on, "takes", 0.0f, has_back ? -BACK_HEIGHT : 0.0f, &canvas);
    ui_draw_box(on, canvas.where, THEME_WELL, 4.0f);
    if (canvas.is_hovered)
        self->takes_scroll -= canvas.wheel_y * 2.0f * ROW_HEIGHT;
    keep_in_sight(self, line, canvas.where.height);
    hold_scroll(self, canvas.where.height);
    paint_list(self, on, &canvas, line, count);
    ui_canvas_end(on);
    menu(self, on, line, count);
    ui_hint(on, self->hint);
    if (has_back)
        put_back(self, on);
    ui_panel_end(on);
}
