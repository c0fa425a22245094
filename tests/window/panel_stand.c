#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"

#include "base/clock.h"
#include "stage/mapping/taught.h"
#include "window/gui/theme.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { PATIENCE_S = 600 };

/* The only one there is: the contracts hand on pointers that stand for it. */
static stand *here;
static viewport *const a_viewport = (viewport *)(void *)&here;
static live *const a_live = (live *)(void *)&here;
static app *const a_studio = (app *)(void *)&here;

/* ---- the application ---- */

const plugin_list *app_plugins(app *self)
{
    (void)self;
    return &here->plugins;
}

log_queue *app_log(app *self)
{
    (void)self;
    return here->log;
}

live *app_live(app *self)
{
    (void)self;
    return a_live;
}

const live_view *app_view(const app *self)
{
    (void)self;
    return &here->view;
}

const live_status *app_status(const app *self)
{
    (void)self;
    return &here->status;
}

settings *app_settings(app *self)
{
    (void)self;
    return here->settings;
}

news_list *app_news(app *self)
{
    (void)self;
    return here->news;
}

const patch *app_patch(const app *self)
{
    (void)self;
    return &here->patch;
}

void app_set_patch(app *self, const patch *p)
{
    (void)self;
    here->patch = *p;
}

app_remote_status app_remote_now(const app *self)
{
    (void)self;
    return (app_remote_status){.address = here->remote, .code = "", .trouble = "", .last = ""};
}

void app_renew_remote_code(app *self)
{
    (void)self;
}

void app_set_remote(app *self, const char *address)
{
    (void)self;
    (void)snprintf(here->remote, sizeof here->remote, "%s", address);
}

const app_picture *app_picture_now(const app *self)
{
    (void)self;
    return &here->picture;
}

void app_set_picture(app *self, const app_picture *wanted)
{
    (void)self;
    here->picture = *wanted;
}

const char *app_picture_says(const app *self, uint32_t *out_streams)
{
    (void)self;
    *out_streams = 0;
    return "";
}

void app_ask(app *self, app_call of)
{
    (void)self;
    here->asked[of] += 1;
}

bool app_take_call(app *self, app_call of)
{
    (void)self, (void)of;
    return false;
}

bool app_demo_hand(char out[APP_DEMO_TEXT])
{
    (void)snprintf(out, APP_DEMO_TEXT, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    return true;
}

app_patch_aim *app_patch_aimed(app *self)
{
    (void)self;
    return &here->aim;
}

const face_file *app_face(const app *self)
{
    (void)self;
    return here->file;
}

bool app_has_hand_keys(const app *self)
{
    (void)self;
    return false;
}

uint64_t viewport_output_drawn(const viewport *self, viewport_taker to)
{
    (void)self, (void)to;
    return 0;
}

uint32_t viewport_portrait(viewport *self, const float *position, uint32_t vertex_count,
                           const float ground[4], const float frame[6], uint32_t width,
                           uint32_t height)
{
    (void)self, (void)position, (void)vertex_count, (void)ground, (void)frame;
    (void)width, (void)height;
    return 0;
}

const mrt_rig_pose *live_poses(const live *self, uint32_t *out_count)
{
    static mrt_rig_pose pose[128];
    const rig *r = here->file ? here->file->rig : NULL;
    (void)self;
    *out_count = r && r->pose_count < 128 ? r->pose_count : 0;
    for (uint32_t i = 0; i < *out_count; ++i)
        pose[i] = (mrt_rig_pose){.name = r->pose[i].name, .part = (uint32_t)r->pose[i].part};
    return pose;
}

const char *live_patch_note(const live *self)
{
    (void)self;
    return "";
}

void app_want_frame(app *self, double in_s)
{
    (void)self, (void)in_s;
}

app_looks *app_looks_of(app *self)
{
    (void)self;
    return &here->looks;
}

app_notes *app_notes_of(app *self)
{
    (void)self;
    return &here->notes;
}

static void stand_forget(undo_change *step)
{
    free(step->before);
    free(step->after);
    step->before = step->after = NULL;
}

void app_add_change(app *self, const undo_change *step)
{
    (void)self;
    assert_true(here->step_count < STAND_STEPS);
    for (uint32_t i = here->step_count; i < here->all_count; ++i)
        stand_forget(&here->step[i]);
    here->step[here->step_count++] = *step;
    here->all_count = here->step_count;
}

void app_forget_changes(app *self, const void *owner)
{
    (void)self;
    for (uint32_t i = 0; i < here->all_count; ++i)
        if (here->step[i].owner == owner)
            stand_forget(&here->step[i]);
}

void app_do(app *self, action of)
{
    (void)self;
    here->done = of;
}

viewport *app_viewport(app *self)
{
    (void)self;
    return a_viewport;
}

void viewport_set_use(viewport *self, viewport_use use, float brush_mm)
{
    (void)self;
    (void)brush_mm;
    here->use = use;
}

const viewport_stroke *viewport_stroke_now(const viewport *self)
{
    (void)self;
    return &here->stroke;
}

/* Nothing takes long here; what is on its way is said by the test. */
mrt_result app_open_input(app *self, const char *text)
{
    (void)self;
    stand_input(here, text);
    return MRT_OK;
}

uint32_t app_openings(app *self, input_opening out[INPUT_OPENINGS_MAX])
{
    (void)self;
    memcpy(out, here->opening, here->opening_count * sizeof *out);
    return here->opening_count;
}

void app_give_up_opening(app *self, uint64_t id)
{
    (void)self;
    here->given_up = id;
}

const char *app_opening_trouble(const app *self)
{
    (void)self;
    return here->opening_trouble ? here->opening_trouble : "";
}

/* ---- the live stage ---- */

static mrt_result refused(error *err)
{
    const char *why = here->refusal;
    here->refusal = NULL;
    return why ? error_set(err, MRT_ERR_UNSUPPORTED, "%s", why) : MRT_OK;
}

mrt_result live_remove_input(live *self, uint32_t index, error *err)
{
    (void)self;
    mrt_result result = refused(err);
    if (result < 0)
        return result;
    input_destroy(here->input[index]);
    here->input_count -= 1;
    for (uint32_t i = index; i < here->input_count; ++i) {
        here->input[i] = here->input[i + 1];
        here->has_sample[i] = here->has_sample[i + 1];
        memmove(here->input_text[i], here->input_text[i + 1], sizeof here->input_text[i]);
    }
    return MRT_OK;
}

uint32_t live_input_count(const live *self)
{
    (void)self;
    return here->input_count;
}

bool live_input_is_own(const live *self, uint32_t index)
{
    (void)self, (void)index;
    return false;
}

input *live_input(live *self, uint32_t index)
{
    (void)self;
    return here->input[index];
}

const char *live_input_text(const live *self, uint32_t index)
{
    (void)self;
    return here->input_text[index];
}

bool live_input_sample(live *self, uint32_t index, mrt_sample *out)
{
    (void)self;
    *out = here->sample[index];
    return here->has_sample[index];
}

void live_tap(live *self, uint32_t index)
{
    (void)self;
    here->tapped = index;
    here->tap_count = here->tap_taken = 0;
}

bool live_pop_tapped(live *self, mrt_sample *out)
{
    (void)self;
    if (here->tap_taken == here->tap_count)
        return false;
    *out = here->tap[here->tap_taken++];
    return true;
}

mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err)
{
    (void)self;
    mrt_result result = refused(err);
    if (result >= 0)
        (void)snprintf(here->calibration[side], sizeof here->calibration[side], "%s",
                       path ? path : "");
    return result;
}

const char *live_calibration(const live *self, uint32_t side)
{
    (void)self;
    return here->calibration[side][0] ? here->calibration[side] : NULL;
}

void live_set_rezero_pedal(live *self, uint32_t pedal)
{
    (void)self;
    here->rezero_pedal = pedal;
}

mrt_result live_set_mapping(live *self, const char *text, error *err)
{
    (void)self;
    mrt_result result = refused(err);
    if (result >= 0)
        stand_mapping(here, text);
    return result;
}

size_t live_taught(live *self, void *bytes, size_t capacity)
{
    (void)self;
    return here->has_mapping ? taught_save(&here->mapping, bytes, capacity) : 0;
}

void live_keep_clay(live *self, bool keeps)
{
    (void)self;
    here->keeps_clay = keeps;
}

bool live_keeps_clay(const live *self)
{
    (void)self;
    return here->keeps_clay;
}

mrt_result live_teach(live *self, const void *bytes, size_t size, error *err)
{
    (void)self;
    mrt_result result = refused(err);
    return result < 0 ? result : taught_load(&here->mapping, bytes, size, err);
}

instance *live_mapping(live *self)
{
    (void)self;
    return here->has_mapping ? &here->mapping : NULL;
}

const csrbf_settings *app_solver(const app *self)
{
    (void)self;
    return here->has_solver ? &here->solver : NULL;
}

mrt_result app_set_solver(app *self, const csrbf_settings *solver, error *err)
{
    (void)self;
    static const csrbf_settings of_rig = {.radius = 60.0};
    mrt_result result = refused(err);
    if (result < 0)
        return result;
    here->solver_count += 1;
    here->has_solver = solver != NULL;
    here->solver = solver ? *solver : (csrbf_settings){.radius = 0.0};
    here->view.solver = solver ? *solver : of_rig;
    if (!(here->view.solver.radius > 0.0))
        here->view.solver.radius = of_rig.radius;
    return MRT_OK;
}

/* ---- what the test says ---- */

void stand_plugin(stand *s, const char *file)
{
    char path[1024];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/%s.so", BUILD_DIR, file);
    if (plugin_list_add(&s->plugins, path, &err) < 0)
        fail_msg("%s", err.text);
}

void stand_input(stand *s, const char *text)
{
    char plugin[64], address[512] = "", params[512] = "";
    error err = {""};
    const mrt_plugin_type *type;
    (void)snprintf(plugin, sizeof plugin, "%.*s", (int)strcspn(text, ":,"), text);
    const char *rest = text + strlen(plugin);
    if (*rest == ':') {
        (void)snprintf(address, sizeof address, "%.*s", (int)strcspn(rest + 1, ","), rest + 1);
        rest += 1 + strlen(address);
    }
    if (*rest == ',')
        (void)snprintf(params, sizeof params, "%s", rest + 1);
    uint32_t i = s->input_count;
    assert_true(i < STAND_INPUTS);
    if (plugin_list_find(&s->plugins, plugin, MRT_INPUT, &type, &err) < 0 ||
        input_create(&s->input[i], type, address, params, CLOCK_REAL, s->log, &err) < 0 ||
        input_start(s->input[i], &err) < 0)
        fail_msg("%s", err.text);
    (void)snprintf(s->input_text[i], sizeof s->input_text[i], "%s", text);
    s->has_sample[i] = false;
    s->input_count += 1;
}

void stand_mapping(stand *s, const char *text)
{
    char plugin[64];
    error err = {""};
    const mrt_plugin_type *type;
    if (s->has_mapping)
        instance_destroy(&s->mapping);
    s->has_mapping = text[0] != '\0';
    if (!text[0])
        return;
    (void)snprintf(plugin, sizeof plugin, "%.*s", (int)strcspn(text, ","), text);
    const char *params = text + strlen(plugin);
    if (plugin_list_find(&s->plugins, plugin, MRT_MAPPING, &type, &err) < 0 ||
        instance_create(&s->mapping, type, CLOCK_REAL, s->log, &err) < 0 ||
        instance_set_list(&s->mapping, *params ? params + 1 : "", &err) < 0)
        fail_msg("%s", err.text);
}

void stand_face(stand *s, const mrt_face *about)
{
    s->view.about = about;
    s->view.contact_count = about ? about->contact_count : 0;
}

static void take_samples(stand *s)
{
    for (uint32_t i = 0; i < s->input_count; ++i) {
        input_incident incident;
        while (input_peek(s->input[i], &s->sample[i])) {
            input_pop(s->input[i]);
            s->has_sample[i] = true;
        }
        while (input_pop_incident(s->input[i], &incident))
            continue;
    }
}

/* ---- the screen ---- */

void stand_frame(stand *s)
{
    ui_screen screen;
    take_samples(s);
    news_list_update(s->news, s->log, 1.0 / 60.0);
    assert_true(window_begin(s->window, s->ui, &screen));
    ui_begin(s->ui, &screen);
    if (s->type->update)
        s->type->update(s->panel, screen.dt_s);
    s->type->draw(s->panel, s->ui, s->where);
    ui_end(s->ui);
    window_end(s->window, s->ui);
}

void stand_settle(stand *s)
{
    for (int i = 0; i < 2 || !ui_is_idle(s->ui); ++i)
        stand_frame(s);
    stand_frame(s);
}

/* What is looked for beside the panel moves what is below it once it is found. */
/* What is waited for has the processor. */
static void wait_a_frame(stand *s)
{
    stand_frame(s);
    clock_sleep_until_ns(clock_now_ns() + 4 * NS_PER_MS);
}

static void settle_first(stand *s)
{
    const int64_t until_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    stand_settle(s);
    while (stand_shows(s, "Searching\xe2\x80\xa6") && clock_now_ns() < until_ns)
        wait_a_frame(s);
    stand_settle(s);
}

void stand_open_with(stand *s, const panel_type *type, float scale, const char *settings_path)
{
    error err = {""};
    char note[512];
    const uint32_t width = (uint32_t)lroundf(1280.0f * scale),
                   height = (uint32_t)lroundf(720.0f * scale);
    here = s;
    s->type = type;
    s->where = (ui_rectangle){1280.0f - THEME_DOCK_WIDTH, THEME_BAR_HEIGHT, THEME_DOCK_WIDTH,
                              720.0f - THEME_BAR_HEIGHT};
    s->tapped = UINT32_MAX;
    s->view.solver = (csrbf_settings){.radius = 60.0};
    s->view.min_determinant = 1.0;
    s->status.counts.min_determinant = 1.0;
    s->log = log_queue_create();
    s->news = news_list_create();
    assert_true(s->log && s->news);
    assert_int_equal(settings_open(&s->settings, settings_path, note, sizeof note, &err), MRT_OK);
    if (window_open_hidden(&s->window, width, height, scale, 1.0 / 60.0, &err) < 0) {
        print_message("SKIPPED: %s\n", err.text);
        skip();
    }
    if (ui_create(&s->ui, &err) < 0)
        fail_msg("%s", err.text);
    ui_note_words(s->ui, true);
    window_hidden_put_away(s->window, true);
    s->panel = type->create(a_studio);
    assert_non_null(s->panel);
    settle_first(s);
}

void stand_open(stand *s, const panel_type *type, float scale)
{
    stand_open_with(s, type, scale, "");
}

void stand_reopen_panel(stand *s)
{
    stand_change_panel(s, s->type);
}

void stand_change_panel(stand *s, const panel_type *to)
{
    s->type->destroy(s->panel);
    s->type = to;
    s->panel = s->type->create(a_studio);
    assert_non_null(s->panel);
    settle_first(s);
}

void stand_close(stand *s)
{
    s->type->destroy(s->panel);
    ui_destroy(s->ui);
    window_close(s->window);
    for (uint32_t i = 0; i < s->input_count; ++i)
        input_destroy(s->input[i]);
    if (s->has_mapping)
        instance_destroy(&s->mapping);
    settings_close(s->settings);
    news_list_destroy(s->news);
    log_queue_destroy(s->log);
    plugin_list_destroy(&s->plugins);
    here = NULL;
}

bool stand_shows(const stand *s, const char *part)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strstr(words[i].text, part))
            return true;
    return false;
}

void stand_wait_for(stand *s, const char *part)
{
    const int64_t until_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    do
        wait_a_frame(s);
    while (!stand_shows(s, part) && clock_now_ns() < until_ns);
    if (!stand_shows(s, part))
        fail_msg("\"%s\" does not come", part);
}

const ui_word *stand_word(const stand *s, const char *text)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            return &words[i];
    return NULL;
}

static void push(stand *s, ui_event event)
{
    ui_push(s->ui, &event);
}

void stand_drag(stand *s, float x0, float y0, float x1, float y1)
{
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x0, .y = y0});
    push(s, (ui_event){.kind = UI_EVENT_BUTTON, .is_down = true});
    stand_settle(s);
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = 0.5f * (x0 + x1), .y = 0.5f * (y0 + y1)});
    stand_settle(s);
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x1, .y = y1});
    push(s, (ui_event){.kind = UI_EVENT_BUTTON});
    stand_settle(s);
}

void stand_click_at(stand *s, float x, float y)
{
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
    push(s, (ui_event){.kind = UI_EVENT_BUTTON, .is_down = true});
    push(s, (ui_event){.kind = UI_EVENT_BUTTON});
    stand_settle(s);
    for (int i = 0; i < 30; ++i) /* so that the next one is no double click */
        stand_frame(s);
}

static void click_word(stand *s, const ui_word *word, const char *text)
{
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    stand_click_at(s, word->where.x + 0.5f * word->where.width,
                   word->where.y + 0.5f * word->where.height);
}

void stand_click(stand *s, const char *text)
{
    click_word(s, stand_word(s, text), text);
}

void stand_click_last(stand *s, const char *text)
{
    const ui_word *words, *last = NULL;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            last = &words[i];
    click_word(s, last, text);
}

void stand_key(stand *s, uint32_t key)
{
    push(s, (ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = true});
    push(s, (ui_event){.kind = UI_EVENT_KEY, .code = key});
    stand_settle(s);
}

void stand_type(stand *s, const char *text)
{
    for (; *text; ++text)
        push(s, (ui_event){.kind = UI_EVENT_TEXT, .code = (uint32_t)*text});
    stand_settle(s);
}

/* ---- looking ---- */

static float channel(uint32_t colour, uint32_t shift)
{
    const float c = (float)(colour >> shift & 0xffu) / 255.0f;
    return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static float luminance(uint32_t colour)
{
    return 0.2126f * channel(colour, 24) + 0.7152f * channel(colour, 16) +
           0.0722f * channel(colour, 8);
}

static bool is_listed(const char *text, const char *const *list)
{
    for (; list && *list; ++list)
        if (strncmp(*list, text, strlen(text)) == 0)
            return true;
    return false;
}

/* What can be seen of it. */
static ui_rectangle seen(const ui_word *w)
{
    float left = fmaxf(w->where.x, w->clip.x), top = fmaxf(w->where.y, w->clip.y);
    float right = fminf(w->where.x + w->where.width, w->clip.x + w->clip.width);
    float bottom = fminf(w->where.y + w->where.height, w->clip.y + w->clip.height);
    return (ui_rectangle){left, top, fmaxf(right - left, 0.0f), fmaxf(bottom - top, 0.0f)};
}

static void check_word(const ui_word *w, const char *const *may_be_cut)
{
    const ui_rectangle ink = seen(w);
    if (ink.width <= 0.0f || ink.height <= 0.0f)
        return; /* scrolled away */
    if (w->is_cut && !is_listed(w->text, may_be_cut))
        fail_msg("\"%s\" is cut", w->text);
    if (ink.width < w->where.width - 0.5f)
        fail_msg("\"%s\" is cut at its side", w->text);
    const float one = luminance(w->colour), other = luminance(w->ground);
    const float contrast = (fmaxf(one, other) + 0.05f) / (fminf(one, other) + 0.05f);
    bool is_on_mark = w->ground == THEME_ACCENT && w->colour == THEME_TEXT; /* a slider's, 2 px */
    if (w->ground != 0 && !is_on_mark && contrast < 4.5f)
        fail_msg("\"%s\": contrast %.2f", w->text, (double)contrast);
}

void stand_check_words(stand *s, const char *const *may_be_cut)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    assert_true(count > 0);
    for (uint32_t i = 0; i < count; ++i) {
        check_word(&words[i], may_be_cut);
        const ui_rectangle p = seen(&words[i]);
        for (uint32_t k = 0; k < i; ++k) {
            const ui_rectangle q = seen(&words[k]);
            const float across = fminf(p.x + p.width, q.x + q.width) - fmaxf(p.x, q.x);
            const float down = fminf(p.y + p.height, q.y + q.height) - fmaxf(p.y, q.y);
            if (across > 0.5f && down > 0.5f && p.height > 0 && q.height > 0)
                fail_msg("\"%s\" overlaps \"%s\"", words[i].text, words[k].text);
        }
    }
}

void stand_picture(stand *s, const char *name)
{
    char path[1024];
    error err = {""};
    window_hidden_put_away(s->window, false);
    stand_frame(s);
    window_hidden_put_away(s->window, true);
    if (!getenv("MAROTTE_PICTURES"))
        return;
    (void)mkdir(BUILD_DIR "/out", 0777);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    if (window_picture(s->window, path, &err) < 0)
        fail_msg("%s", err.text);
}
