/* The patch panel: connections from channels to targets, with live meters. The user adds a
 * connection by moving a channel and clicking a target, or chooses both from lists. Changes can be
 * undone. */
#include "window/panels/panels.h"

#include "base/file.h"
#include "stage/perform/patch_file.h"
#include "window/app/channel_learn.h"
#include "window/gui/theme.h"
#include "window/panels/shown_unit.h"
#include "window/viewport/viewport.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ITEMS_MAX = 640, ITEM = 112 };
#define NOBODY UINT32_MAX
#define LABEL  74.0f

struct panel {
    app *app;
    patch work; /* patch as drawn; newer than the patch of the application while a slider is dragged
                 */
    uint32_t chosen; /* NOBODY: none */
    bool is_changed, is_held;
    char words[EDIT_TEXT];
    char file[512];

    /* learning */
    bool has_source, had_contacts;
    patch_connection source;
    channel_learner learner;

    char item[ITEMS_MAX][ITEM]; /* items of the list that is being drawn */
    const char *items[ITEMS_MAX];
    uint32_t item_count;
};

/* ---- changes and undo ---- */

static mrt_result set(void *owner, const void *value)
{
    app_set_patch(((panel *)owner)->app, value);
    return MRT_OK;
}

static void commit(panel *self)
{
    if (patch_equal(&self->work, app_patch(self->app)))
        return;
    const patch before = *app_patch(self->app);
    app_set_patch(self->app, &self->work);
    undo_change made = {.owner = self, .set = set};
    (void)snprintf(made.words, sizeof made.words, "patch: %.120s", self->words);
    app_add_copied_change(self->app, &made, &before, &self->work, sizeof before);
}

static void change(panel *self, const char *words)
{
    self->is_changed = true;
    (void)snprintf(self->words, sizeof self->words, "%s", words);
}

static void add(panel *self, const patch_connection *c)
{
    if (self->work.count == PATCH_CONNECTIONS_MAX)
        return;
    char words[EDIT_TEXT];
    self->work.connection[self->work.count++] = *c;
    patch_connection_describe(c, words, sizeof words);
    self->chosen = self->work.count - 1;
    change(self, words);
}

static void delete_chosen(panel *self)
{
    patch *p = &self->work;
    if (self->chosen >= p->count)
        return;
    p->count -= 1;
    memmove(&p->connection[self->chosen], &p->connection[self->chosen + 1],
            (p->count - self->chosen) * sizeof *p->connection);
    p->connection[p->count] = (patch_connection){.kind = PATCH_NOTHING};
    self->chosen = NOBODY;
    change(self, "connection deleted");
}

/* ---- current channel values ---- */

/* Computes the position of the channel in its input range, 0..1. Returns false if no input has the
 * channel. */
static bool share_of(const patch_connection *c, const channels_now *now, double *out_share)
{
    static const patch_range whole = {-1.0, 1.0, 0.0};
    mrt_channel channel;
    double raw;
    patch_connection plain = *c;
    if (!patch_read_channel(c, &now->frame, &channel, &raw))
        return false;
    plain.kind = PATCH_DOF; /* range 0 to 1, or -1 to 1 for a stick */
    plain.bend = plain.ease = 0.0;
    plain.out[0] = plain.out[1] = NAN;
    *out_share = fabs(patch_wanted(&plain, &channel, raw, &whole));
    return true;
}

/* ---- learning ---- */

static void end_learning(panel *self)
{
    viewport *view = app_viewport(self->app);
    app_patch_aim *aim = app_patch_aimed(self->app);
    if (!aim->is_learning)
        return;
    *aim = (app_patch_aim){.is_learning = false};
    app_looks_of(self->app)->shows_contacts = self->had_contacts;
    if (view)
        viewport_set_use(view, VIEWPORT_PERFORMS, 0.0f);
}

static void begin_learning(panel *self)
{
    app_looks *looks = app_looks_of(self->app);
    *app_patch_aimed(self->app) = (app_patch_aim){.is_learning = true};
    self->had_contacts = looks->shows_contacts;
    looks->shows_contacts = true;
    self->has_source = false;
    self->learner = (channel_learner){.count = 0};
}

static void look_for_click(panel *self)
{
    viewport *view = app_viewport(self->app);
    app_patch_aim *aim = app_patch_aimed(self->app);
    if (!view)
        return;
    viewport_set_use(view, VIEWPORT_PICKS, 0.0f);
    const viewport_stroke *stroke = viewport_stroke_now(view);
    const mrt_face *about = app_view(self->app)->about;
    if (!stroke || !stroke->is_pressed || stroke->contact == 0 || !about ||
        stroke->contact > about->contact_count)
        return;
    aim->kind = PATCH_CONTACT;
    (void)snprintf(aim->target, sizeof aim->target, "%.63s",
                   about->contacts[stroke->contact - 1].name);
}

static void connect(panel *self, patch_kind kind, const char *target)
{
    patch_connection c = patch_connection_of(kind);
    memcpy(c.input, self->source.input, sizeof c.input);
    memcpy(c.channel, self->source.channel, sizeof c.channel);
    (void)snprintf(c.target, sizeof c.target, "%.63s", target);
    add(self, &c);
    end_learning(self);
}

/* Runs also while another panel is open, because the user may click one of its sliders. */
static void update(panel *self, double dt_s)
{
    (void)dt_s;
    app_patch_aim *aim = app_patch_aimed(self->app);
    if (!aim->is_learning)
        return;
    channels_now now;
    channels_read(&now, self->app);
    self->work = *app_patch(self->app);
    self->has_source |= channel_learn(&self->learner, &now, &self->source);
    look_for_click(self);
    if (aim->kind == PATCH_NOTHING)
        return;
    if (self->has_source)
        connect(self, aim->kind, aim->target);
    else
        aim->kind = PATCH_NOTHING; /* the channel must be selected before the target */
    if (self->is_changed)
        commit(self);
    self->is_changed = false;
}

/* ---- lists ---- */

static void add_item(panel *self, const char *text)
{
    if (self->item_count == ITEMS_MAX)
        return;
    (void)snprintf(self->item[self->item_count], ITEM, "%.100s", text);
    self->items[self->item_count] = self->item[self->item_count];
    self->item_count += 1;
}

/* Returns the index of an item. Appends the item if it is missing. */
static uint32_t index_of(panel *self, const char *text)
{
    for (uint32_t i = 0; i < self->item_count; ++i)
        if (strcmp(self->items[i], text) == 0)
            return i;
    add_item(self, text);
    return self->item_count - 1;
}

static void list_targets(panel *self, patch_kind kind)
{
    const mrt_face *about = app_view(self->app)->about;
    const instance *mapping = live_mapping(app_live(self->app));
    const face_file *file = app_face(self->app);
    self->item_count = 0;
    for (uint32_t i = 0; kind == PATCH_PARAM && mapping && i < mapping->type->param_count; ++i) {
        char key[ITEM];
        instance_key(mapping->type, i, key, sizeof key);
        if (!(mapping->type->params[i].flags & MRT_PARAM_HIDDEN))
            add_item(self, key);
    }
    for (uint32_t i = 0; kind == PATCH_DOF && about && i < about->dof_count; ++i)
        add_item(self, about->dofs[i].name);
    for (uint32_t i = 0; kind == PATCH_CONTACT && about && i < about->contact_count; ++i)
        add_item(self, about->contacts[i].name);
    const bool is_pose =
        kind == PATCH_POSE || (kind == PATCH_SHAPE && file && !file->mesh.target_count);
    uint32_t pose_count = 0;
    const mrt_rig_pose *pose = live_poses(app_live(self->app), &pose_count);
    for (uint32_t i = 0; is_pose && i < pose_count; ++i)
        add_item(self, pose[i].name);
    for (uint32_t i = 0; kind == PATCH_ACTION && i < PATCH_ACTIONS; ++i)
        add_item(self, patch_action_names[i]);
    for (uint32_t i = 0; kind == PATCH_SHAPE && file && i < file->mesh.target_count; ++i)
        add_item(self, file->mesh.target[i].name);
    for (uint32_t i = 0; kind == PATCH_SHAPE && file && i < file->mesh.expression_count; ++i)
        (void)index_of(self, file->mesh.expression[i].name);
}

static void list_sources(panel *self, const channels_now *now)
{
    self->item_count = 0;
    for (uint32_t i = 0; i < now->frame.input_count; ++i)
        for (uint32_t c = 0; c < now->inputs[i].count; ++c) {
            patch_connection of = patch_connection_of(PATCH_DOF);
            char text[ITEM];
            channels_name(now, i, c, &of);
            (void)snprintf(text, sizeof text, "%.40s: %.60s", of.input, of.channel);
            (void)index_of(self, text);
        }
}

/* ---- the selected connection ---- */

static void draw_source(panel *self, ui *on, patch_connection *c, const channels_now *now)
{
    char text[ITEM];
    list_sources(self, now);
    if (c->input[0])
        (void)snprintf(text, sizeof text, "%.40s: %.60s", c->input, c->channel);
    else
        (void)snprintf(text, sizeof text, "%.60s", c->channel);
    uint32_t at = index_of(self, text);
    if (!ui_choice(on, "Channel", LABEL, self->items, self->item_count, &at))
        return;
    const char *colon = strstr(self->items[at], ": ");
    if (!colon)
        return;
    (void)snprintf(c->input, sizeof c->input, "%.*s", (int)(colon - self->items[at]),
                   self->items[at]);
    (void)snprintf(c->channel, sizeof c->channel, "%.63s", colon + 2);
    change(self, "another channel");
}

static void draw_aim(panel *self, ui *on, patch_connection *c)
{
    static const char *const kinds[] = {"parameter", "bone",      "contact",
                                        "pose",      "transport", "shape"};
    uint32_t kind = (uint32_t)c->kind - PATCH_PARAM;
    if (ui_choice(on, "Target", LABEL, kinds, PATCH_KINDS - PATCH_PARAM, &kind)) {
        list_targets(self, (patch_kind)(kind + PATCH_PARAM));
        if (self->item_count > 0) {
            patch_connection other = patch_connection_of((patch_kind)(kind + PATCH_PARAM));
            memcpy(other.input, c->input, sizeof other.input);
            memcpy(other.channel, c->channel, sizeof other.channel);
            (void)snprintf(other.target, sizeof other.target, "%.63s", self->items[0]);
            *c = other;
            change(self, "another target");
        }
    }
    list_targets(self, c->kind);
    uint32_t at = index_of(self, c->target);
    if (ui_choice(on, "Name", LABEL, self->items, self->item_count, &at)) {
        (void)snprintf(c->target, sizeof c->target, "%.63s", self->items[at]);
        change(self, "another target");
    }
}

/* Switches the target between "brow.mid.l" and "brow.mid.*". */
static void draw_sides(panel *self, ui *on, patch_connection *c)
{
    if (c->kind != PATCH_DOF && c->kind != PATCH_CONTACT)
        return;
    for (char *dot = strchr(c->target, '.'); dot; dot = strchr(dot + 1, '.')) {
        bool is_end = dot[1] != '\0' && (dot[2] == '.' || dot[2] == '\0');
        if (!is_end || !strchr("lr*", dot[1]))
            continue;
        bool is_both = dot[1] == '*';
        if (ui_check(on, "Both sides", &is_both)) {
            dot[1] = is_both ? '*' : 'l';
            change(self, is_both ? "both sides" : "one side");
        }
        ui_hint(on, "Move the other side too, mirrored.");
        return;
    }
}

static void draw_way(panel *self, ui *on, patch_connection *c)
{
    static const char *const names[] = {"up",      "down", "to its left", "to its right",
                                        "forward", "back", "custom"};
    static const float ways[6][3] = {{0, 1, 0},  {0, -1, 0}, {1, 0, 0},
                                     {-1, 0, 0}, {0, 0, 1},  {0, 0, -1}};
    uint32_t at = 6;
    for (uint32_t i = 0; i < 6; ++i)
        if (memcmp(ways[i], c->way, sizeof c->way) == 0)
            at = i;
    if (c->kind != PATCH_CONTACT ||
        !ui_choice(on, "Direction", LABEL, names, at == 6 ? 7 : 6, &at) || at == 6)
        return;
    memcpy(c->way, ways[at], sizeof c->way);
    change(self, "another direction");
}

static void draw_number(panel *self, ui *on, const char *label, const ui_range *range,
                        double *value)
{
    const shown_unit unit = shown_unit_of(range->unit);
    const ui_range shown = {unit.factor * range->min,
                            unit.factor * range->max,
                            unit.name,
                            unit.factor > 1.0 ? 1 : range->digits,
                            range->is_whole,
                            unit.factor * range->initial};
    double number = unit.factor * *value;
    if (ui_slider(on, label, LABEL, &shown, &number)) {
        *value = number / unit.factor;
        change(self, label);
    }
    self->is_held |= ui_slider_is_held(on);
}

/* Returns the range of the target. `out`: range of the sliders. */
static patch_range range_of(const panel *self, const patch_connection *c, ui_range *out)
{
    const mrt_face *about = app_view(self->app)->about;
    const instance *mapping = live_mapping(app_live(self->app));
    *out = (ui_range){-1.0, 1.0, "", 2, false, 0.0};
    if (c->kind == PATCH_CONTACT) {
        *out = (ui_range){-20.0, 20.0, "mm", 1, false, 0.0};
        return (patch_range){-10.0, 10.0, 0.0};
    }
    for (uint32_t i = 0; c->kind == PATCH_PARAM && mapping && i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        char key[ITEM];
        instance_key(mapping->type, i, key, sizeof key);
        if (strcmp(key, c->target) != 0)
            continue;
        *out = (ui_range){p->min, p->max, p->unit, 2, false, p->initial};
        return (patch_range){p->min, p->max, p->initial};
    }
    for (uint32_t i = 0; c->kind == PATCH_DOF && about && i < about->dof_count; ++i) {
        const mrt_dof *dof = &about->dofs[i];
        const char *star = strchr(c->target, '*');
        size_t before = star ? (size_t)(star - c->target) : strlen(c->target) + 1;
        if (strncmp(dof->name, c->target, before) != 0 ||
            (star && strlen(dof->name) != strlen(c->target)))
            continue;
        *out = (ui_range){(double)dof->min, (double)dof->max, dof->unit, 2, false, 0.0};
        return (patch_range){(double)dof->min, (double)dof->max, 0.0};
    }
    return (patch_range){-1.0, 1.0, 0.0};
}

static void draw_ranges(panel *self, ui *on, patch_connection *c, const channels_now *now)
{
    mrt_channel channel = {"", "", 0, 0, 0.0f, 1.0f};
    double raw;
    ui_range sliders;
    (void)patch_read_channel(c, &now->frame, &channel, &raw);
    const patch_range range = range_of(self, c, &sliders);
    const ui_range in = {(double)channel.min, (double)channel.max, channel.unit, 2, false, 0.0};
    double from = isnan(c->in[0]) ? in.min : c->in[0], to = isnan(c->in[1]) ? in.max : c->in[1];
    double from_was = from, to_was = to;
    if (in.max > in.min) {
        draw_number(self, on, "Input", &in, &from);
        draw_number(self, on, "to", &in, &to);
    }
    if ((from < from_was || from > from_was || to < to_was || to > to_was) && from < to) {
        c->in[0] = from;
        c->in[1] = to;
    }
    if (c->kind == PATCH_ACTION)
        return;
    bool has_middle = from < 0.0 && to > 0.0;
    double low = has_middle || c->kind == PATCH_PARAM ? range.low : range.rest, high = range.high;
    if (!isnan(c->out[0])) {
        low = c->out[0];
        high = c->out[1];
    }
    if (c->kind == PATCH_POSE || c->kind == PATCH_SHAPE)
        sliders.min = fmin(low, 0.0); /* below 0 where a channel with a middle plays it so */
    double low_was = low, high_was = high;
    draw_number(self, on, "Output##low", &sliders, &low);
    draw_number(self, on, "to##high", &sliders, &high);
    if (low < low_was || low > low_was || high < high_was || high > high_was) {
        c->out[0] = low;
        c->out[1] = high;
    }
}

/* Draws the curve and the current position of the channel on it. */
static void draw_curve(ui *on, const patch_connection *c, const channels_now *now)
{
    enum { POINTS = 33 };
    float xy[2 * POINTS];
    ui_canvas at;
    double share;
    ui_canvas_begin(on, "curve", 0.0f, 84.0f, &at);
    const float inset = 6.0f, width = at.where.width - 2.0f * inset,
                height = at.where.height - 2.0f * inset;
    ui_draw_box(on, at.where, THEME_WELL, 3.0f);
    for (int i = 0; i < POINTS; ++i) {
        double x = i / (double)(POINTS - 1);
        xy[2 * i] = at.where.x + inset + width * (float)x;
        xy[2 * i + 1] =
            at.where.y + inset + height * (float)(1.0 - patch_curve(x, c->bend, c->ease));
    }
    ui_draw_lines(on, xy, POINTS, THEME_ACCENT, 1.5f);
    if (share_of(c, now, &share))
        ui_draw_disc(on, at.where.x + inset + width * (float)share,
                     at.where.y + inset +
                         height * (float)(1.0 - patch_curve(share, c->bend, c->ease)),
                     4.0f, THEME_GOOD);
    ui_canvas_end(on);
}

static void draw_chosen(panel *self, ui *on, const channels_now *now)
{
    static const char *const modes[] = {"instead of the mapping", "added to the mapping"};
    static const ui_range bend = {-1.0, 1.0, "", 2, false, 0.0};
    static const ui_range smooth = {0.0, 1.0, "s", 2, false, 0.0};
    patch_connection *c = &self->work.connection[self->chosen];
    uint32_t mode = c->adds;
    ui_id_begin(on, "chosen");
    ui_rule(on);
    draw_source(self, on, c, now);
    draw_aim(self, on, c);
    draw_way(self, on, c);
    draw_sides(self, on, c);
    draw_ranges(self, on, c, now);
    if (c->kind != PATCH_ACTION) {
        draw_curve(on, c, now);
        draw_number(self, on, "Bend", &bend, &c->bend);
        ui_hint(on, "Bend the curve: right starts slowly, left starts fast.");
        draw_number(self, on, "Ease", &bend, &c->ease);
        ui_hint(on, "Ease the curve: right is slow at both ends.");
        draw_number(self, on, "Smooth", &smooth, &c->smooth_s);
        if (ui_choice(on, "Mode", LABEL, modes, 2, &mode)) {
            c->adds = mode == 1;
            change(self, modes[mode]);
        }
        if (ui_check(on, "Pick up", &c->picks_up))
            change(self, c->picks_up ? "pick up" : "no pick up");
        ui_hint(
            on,
            "Wait until the channel reaches the current value, so that the face does not jump.");
        ui_same_line(on);
        ui_at(on, 110.0f);
    }
    if (ui_check(on, "Off", &c->is_muted))
        change(self, c->is_muted ? "off" : "on");
    ui_same_line(on);
    ui_at(on, 180.0f);
    if (ui_button(on, "Delete", UI_PLAIN))
        delete_chosen(self);
    ui_id_end(on);
}

/* ---- the list ---- */

static void draw_row(panel *self, ui *on, uint32_t i, const channels_now *now)
{
    const patch_connection *c = &self->work.connection[i];
    char id[16], words[2 * PATCH_NAME + 8];
    ui_canvas at;
    double share = 0.0;
    bool is_heard = share_of(c, now, &share);
    bool speaks = (app_status(self->app)->patch_speaks >> i & 1u) != 0;
    (void)snprintf(id, sizeof id, "row%u", i);
    (void)snprintf(words, sizeof words, "%s \xe2\x86\x92 %s", c->channel, c->target);
    ui_canvas_begin(on, id, 0.0f, 30.0f, &at);
    if (at.is_pressed)
        self->chosen = self->chosen == i ? NOBODY : i;
    const ui_rectangle box = {at.where.x, at.where.y + 1.0f, at.where.width, 28.0f};
    if (self->chosen == i || at.is_hovered)
        ui_draw_box(on, box, self->chosen == i ? THEME_RAISED : THEME_HOVER, 3.0f);
    ui_draw_text(on, box.x + 6.0f, box.y + 2.0f, UI_STYLE_BODY,
                 c->is_muted || !is_heard ? THEME_DIM : THEME_TEXT, box.width - 22.0f, words);
    ui_draw_box(on, (ui_rectangle){box.x + 6.0f, box.y + 22.0f, box.width - 24.0f, 3.0f},
                THEME_WELL, 1.0f);
    ui_draw_box(on,
                (ui_rectangle){box.x + 6.0f, box.y + 22.0f,
                               (box.width - 24.0f) * (float)fmin(share, 1.0), 3.0f},
                speaks || c->kind == PATCH_ACTION ? THEME_ACCENT : THEME_DIM, 1.0f);
    if (speaks)
        ui_draw_disc(on, box.x + box.width - 9.0f, box.y + 14.0f, 3.5f, THEME_GOOD);
    else
        ui_draw_ring(on, box.x + box.width - 9.0f, box.y + 14.0f, 3.5f, THEME_DIM, 1.0f);
    ui_canvas_end(on);
    ui_hint(on, c->is_muted   ? "Off."
                : !is_heard   ? "No open input has this channel."
                : speaks      ? "This connection moves the face."
                : c->picks_up ? "Move the control past the current value to pick it up."
                              : "Press the control to run the action.");
}

static void draw_learning(panel *self, ui *on)
{
    const app_patch_aim *aim = app_patch_aimed(self->app);
    char words[2 * PATCH_NAME + 80];
    if (!aim->is_learning)
        return;
    if (self->has_source)
        (void)snprintf(
            words, sizeof words,
            "Selected: %s. Now click its target: a dot on the face, or a slider in Mapping.",
            self->source.channel);
    else
        (void)snprintf(words, sizeof words, "Move one fader, stick, finger or pedal.");
    ui_text_wrapped(on, UI_STYLE_STRONG, words);
    if (self->has_source && ui_button(on, "The jaw", UI_PLAIN))
        connect(self, PATCH_DOF, "jaw.open");
    if (self->has_source)
        ui_same_line(on);
    if (ui_button(on, "Cancel", UI_QUIET) || ui_pressed(on, UI_KEY_ESCAPE, 0))
        end_learning(self);
}

static void use_patch(panel *self, const char *given)
{
    error err = {""};
    if (patch_file_find(&self->work, given, &err) < 0) {
        log_push(app_log(self->app), MRT_LOG_ERROR, "patch", err.text);
        self->work = *app_patch(self->app);
        return;
    }
    self->chosen = NOBODY;
    change(self, given);
}

static void save_patch(panel *self)
{
    error err = {""};
    char *text = NULL;
    mrt_result result = patch_file_write(&text, &self->work, &err);
    if (result >= 0)
        result = file_write(self->file, text, strlen(text), &err);
    free(text);
    log_push(app_log(self->app), result < 0 ? MRT_LOG_ERROR : MRT_LOG_INFO, "patch",
             result < 0 ? err.text : "patch saved");
}

static void draw_head(panel *self, ui *on)
{
    static const char *const names[] = {"Choose a patch", "faders", "gamepad", "phone",
                                        "phone_face",     "voice",  "none"};
    enum { NAMES = sizeof names / sizeof *names };
    uint32_t at = 0;
    const bool is_chosen = ui_choice(on, "Use", LABEL, names, NAMES, &at);
    ui_hint(on, "Replace this patch by a built-in patch, or by none.");
    if (is_chosen && at > 0) {
        if (at < NAMES - 1) {
            use_patch(self, names[at]);
        } else {
            self->work = (patch){.name = ""};
            self->chosen = NOBODY;
            change(self, "no connections");
        }
    }
    if (!app_patch_aimed(self->app)->is_learning && ui_button(on, "Learn", UI_ACCENT))
        begin_learning(self);
    ui_hint(on, "Add a connection: move a fader, then click its target.");
}

static void draw_file(panel *self, ui *on)
{
    if (!ui_section(on, "File", false))
        return;
    ui_width(on, 0.0f);
    (void)ui_input(on, "##file", "/path/of/patch.json", self->file, sizeof self->file);
    ui_disabled_begin(on, !self->file[0]);
    if (ui_button(on, "Open", UI_PLAIN))
        use_patch(self, self->file);
    ui_same_line(on);
    if (ui_button(on, "Save", UI_PLAIN))
        save_patch(self);
    ui_disabled_end(on);
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    channels_now now;
    channels_read(&now, self->app);
    if (live_input_count(app_live(self->app)) >
        0) /* a moving fader does not always move the face, so the meters need their own frames */
        ui_want_frame(on, app_patch_aimed(self->app)->is_learning ? 0.03 : 0.1);
    bool is_recording = app_status(self->app)->is_recording;
    if (!self->is_held)
        self->work = *app_patch(self->app);
    if (self->chosen != NOBODY && self->chosen >= self->work.count)
        self->chosen = NOBODY;
    self->is_held = false;
    ui_panel_begin(on, "patch", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    if (is_recording)
        ui_text_wrapped(on, UI_STYLE_DIM, "Recording. End the take to change the patch.");
    ui_disabled_begin(on, is_recording);
    draw_head(self, on);
    draw_learning(self, on);
    if (self->work.count == 0 && !app_patch_aimed(self->app)->is_learning)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "Connect faders, sticks, tracked shapes and fingers to parameters, bones, "
                        "contacts and poses. Connections are applied after the mapping.");
    for (uint32_t i = 0; i < self->work.count; ++i) {
        draw_row(self, on, i, &now);
        if (self->chosen == i)
            draw_chosen(self, on, &now);
    }
    const char *note = live_patch_note(app_live(self->app));
    if (note[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, note);
    draw_file(self, on);
    ui_disabled_end(on);
    ui_scroll_end(on);
    ui_panel_end(on);
    if (!self->is_changed || self->is_held)
        return;
    self->is_changed = false;
    commit(self);
}

/* ---- create and destroy ---- */

static void destroy(panel *self)
{
    if (!self)
        return;
    app_forget_changes(self->app, self);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->chosen = NOBODY;
    return self;
}

const panel_type panel_patch = {create, destroy, draw, update};
