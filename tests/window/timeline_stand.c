#include "timeline_stand.h"

#include "base/clock.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static stand *here; /* the application and the stage of all fakes below */

/* ---- the application ---- */

struct app {
    int nothing;
};
static app the_studio;
struct live {
    int nothing;
};
static live the_stage;

const plugin_list *app_plugins(app *self)
{
    (void)self;
    return NULL;
}

live *app_live(app *self)
{
    (void)self;
    return &the_stage;
}

const live_view *app_view(const app *self)
{
    static const live_view performs = {.mode = LIVE_PERFORMS};
    (void)self;
    return &performs;
}

const live_status *app_status(const app *self)
{
    (void)self;
    return &here->status;
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

const char *app_face_path(const app *self)
{
    (void)self;
    return "none";
}

show *app_show(app *self)
{
    (void)self;
    return NULL;
}

news_list *app_news(app *self)
{
    (void)self;
    return here->news;
}

uint32_t app_takes(const app *self, const app_take_line **out)
{
    (void)self;
    *out = here->line;
    return here->line_count;
}

uint32_t app_marks_of(const app *self, const int64_t **out_at_ns)
{
    (void)self;
    *out_at_ns = NULL;
    return 0;
}

int64_t app_take_id(const app *self)
{
    (void)self;
    return here->take.id;
}

mrt_result app_speech_begin(app *self, const app_speech_wish *wish)
{
    (void)self;
    (void)wish;
    return MRT_OK;
}

double app_speech_part(const app *self)
{
    (void)self;
    return -1.0;
}

void app_speech_cancel(app *self)
{
    (void)self;
}

const char *app_speech_result(const app *self)
{
    (void)self;
    return "";
}

mrt_result app_sync_begin(app *self, int64_t from_ns, int64_t to_ns)
{
    (void)self;
    (void)from_ns;
    (void)to_ns;
    return MRT_OK;
}

double app_sync_part(const app *self)
{
    (void)self;
    return -1.0;
}

void app_sync_cancel(app *self)
{
    (void)self;
}

const char *app_sync_result(const app *self)
{
    (void)self;
    return "";
}

const app_sync_found *app_sync_of(const app *self)
{
    (void)self;
    return NULL;
}

mrt_result app_sync_move(app *self)
{
    (void)self;
    return MRT_OK;
}

void app_add_change(app *self, const undo_change *step)
{
    (void)self;
    assert_true(here->did_count < STAND_STEPS);
    here->step[here->did_count++] = here->did = *step;
}

app_lead_in app_lead_in_of(const app *self)
{
    (void)self;
    return (app_lead_in){0};
}

live_click app_click(const app *self)
{
    (void)self;
    return (live_click){.bpm = 120.0, .bar = 4};
}

bool app_outside_code(const app *self, timecode_rate *out_rate, int64_t *out_frame)
{
    (void)self, (void)out_rate, (void)out_frame;
    return false;
}

bool app_chases(const app *self)
{
    (void)self;
    return false;
}

void app_set_chases(app *self, bool chases)
{
    (void)self, (void)chases;
}

void app_set_click(app *self, const live_click *to)
{
    (void)self;
    (void)to;
}

void app_set_lead_in(app *self, app_lead_in to)
{
    (void)self;
    (void)to;
}

void app_forget_changes(app *self, const void *owner)
{
    (void)self;
    (void)owner;
    for (uint32_t i = 0; i < here->did_count; ++i) {
        free(here->step[i].before);
        free(here->step[i].after);
    }
    here->did_count = 0;
}

mrt_result app_choose_take(app *self, int64_t id)
{
    (void)self;
    here->rated_id = id;
    here->done = ACTION_COUNT;
    return MRT_OK;
}

mrt_result app_select_take(app *self, int64_t id)
{
    (void)self;
    here->selected_id = id;
    return MRT_OK;
}

bool app_is_take_shown(const app *self)
{
    (void)self;
    return here->take.id != 0;
}

const take *app_take(const app *self)
{
    (void)self;
    return here->take.id ? &here->take : NULL;
}

uint64_t app_take_edition(const app *self)
{
    (void)self;
    return here->edition;
}

const history *app_history(const app *self)
{
    (void)self;
    return NULL;
}

mrt_result app_history_go(app *self, int64_t head)
{
    (void)self, (void)head;
    return MRT_OK;
}

void app_preview_take(app *self, const take *t)
{
    (void)self;
    error err = {""};
    take_finish(&here->preview);
    here->preview = (take){0};
    if (t)
        assert_int_equal(take_copy(&here->preview, t, &err), MRT_OK);
    here->preview_count += 1;
}

static mrt_result apply(const edit *e)
{
    here->refused.text[0] = '\0';
    mrt_result result = edit_apply(&here->take, e, &here->refused);
    if (result < 0)
        return result;
    if (here->edit_count < STAND_EDITS)
        snprintf(here->edited[here->edit_count], sizeof here->edited[0], "%s", edit_name(e->kind));
    here->edit_count += 1;
    here->edition += 1;
    app_preview_take(NULL, NULL);
    here->last = *e;
    here->transport.end_ns = here->take.duration_ns;
    return MRT_OK;
}

mrt_result app_edit(app *self, const edit *e)
{
    (void)self;
    here->step_count += 1;
    return apply(e);
}

mrt_result app_edit_all(app *self, const edit *const *e, uint32_t count)
{
    (void)self;
    mrt_result result = MRT_OK;
    here->step_count += 1;
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = apply(e[i]);
    return result;
}

const char *app_redo_words(const app *self)
{
    (void)self;
    return "";
}

mrt_result app_duplicate_take(app *self, int64_t id)
{
    (void)self;
    here->duplicated = id;
    return MRT_OK;
}

mrt_result app_edit_take(app *self, int64_t id, const edit *e)
{
    (void)self;
    here->rated_id = id;
    here->rated = e->rating;
    here->last = *e;
    for (uint32_t i = 0; i < here->line_count; ++i)
        if (here->line[i].id == id && e->kind == EDIT_TAKE_RATE)
            here->line[i].rating = e->rating;
    return MRT_OK;
}

const char *app_undo_words(const app *self)
{
    (void)self;
    return here->edit_count ? here->edited[(here->edit_count - 1) % STAND_EDITS] : "";
}

app_choice *app_chosen(app *self)
{
    (void)self;
    return &here->choice;
}

bool app_take_request(app *self, action of)
{
    (void)self;
    bool is_asked = here->asked == of;
    if (is_asked)
        here->asked = ACTION_NONE;
    return is_asked;
}

bool app_can(app *self, action of, const char **out_why_not)
{
    (void)self;
    bool needs_take = of != ACTION_RECORD && of != ACTION_KEEP && of != ACTION_MARK;
    if (out_why_not)
        *out_why_not = "no take is selected";
    return here->take.id || !needs_take;
}

void app_do(app *self, action of)
{
    (void)self;
    here->done = of;
}

/* ---- the stage ---- */

const transport *live_transport(const live *self)
{
    (void)self;
    return &here->transport;
}

transport_position live_position(const live *self)
{
    (void)self;
    return transport_at(&here->transport, here->clock_ns);
}

void app_seek(app *self, int64_t at_ns)
{
    (void)self;
    here->seeks += 1;
    transport_seek(&here->transport, here->clock_ns, at_ns);
}

void app_set_range(app *self, int64_t in_ns, int64_t out_ns)
{
    (void)self;
    if (!transport_set_loop(&here->transport, here->clock_ns, in_ns, out_ns))
        here->transport.loop_in_ns = here->transport.loop_out_ns = 0;
}

void app_keep(app *self, int64_t from_ns, int64_t to_ns)
{
    (void)self;
    here->kept_from_ns = from_ns;
    here->kept_to_ns = to_ns;
}

uint32_t live_input_count(const live *self)
{
    (void)self;
    return here->input_count;
}

const char *live_input_text(const live *self, uint32_t index)
{
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i"};
    (void)self;
    return names[index];
}

input *live_input(live *self, uint32_t index)
{
    (void)self, (void)index;
    return NULL;
}

bool live_input_sample(live *self, uint32_t index, mrt_sample *out)
{
    (void)self;
    double t = (double)clock_now_ns() * 1e-9;
    *out = (mrt_sample){.count = 2};
    out->value[0] = (float)sin(t * (2.0 + index));
    return true;
}

const mrt_channel *input_channels(const input *self, uint32_t *out_count)
{
    static const mrt_channel channel[2] = {{"a", "rad", 1, 1, -2, 2}, {"b", "rad", 2, 1, -2, 2}};
    (void)self;
    *out_count = 2;
    return channel;
}

const char *input_name(const input *self)
{
    (void)self;
    return "CyberGlove 22, right, port 1-2";
}

/* ---- the worker ---- */

struct timeline_worker {
    timeline_request request;
    timeline_result result;
};

timeline_worker *timeline_worker_create(const plugin_list *plugins)
{
    (void)plugins;
    return calloc(1, sizeof(timeline_worker));
}

void timeline_worker_destroy(timeline_worker *self)
{
    free(self);
}

void timeline_worker_set_show(timeline_worker *self, const char *show_path, const char *face_path)
{
    (void)self, (void)show_path, (void)face_path;
}

void timeline_request_clear(timeline_request *request)
{
    memset(request, 0, sizeof *request);
}

bool timeline_request_add(timeline_request *request, const timeline_strip *strip)
{
    if (request->strip_count >= TIMELINE_STRIPS_MAX ||
        strip->bin_count > TIMELINE_BINS_MAX - request->bin_count)
        return false;
    request->strip[request->strip_count] = *strip;
    request->strip[request->strip_count++].first_bin = request->bin_count;
    request->bin_count += strip->bin_count;
    return true;
}

/* A face that speaks: syllables within phrases. */
static float movement(double s, int64_t performance)
{
    double seed = (double)performance * 1.7;
    double phrase = fmax(0.0, sin(s * 0.9 + seed) + 0.35);
    double syllable = 0.5 + 0.5 * sin(s * 11.0 + 2.0 * sin(s * 1.3 + seed));
    return (float)(phrase * (0.03 + 0.15 * syllable));
}

void timeline_worker_request(timeline_worker *self, const timeline_request *request)
{
    timeline_result *result = &self->result;
    if (memcmp(request, &self->request, sizeof *request) == 0)
        return;
    self->request = *request;
    result->strip_count = request->strip_count;
    memcpy(result->strip, request->strip, sizeof result->strip);
    for (uint32_t i = 0; i < request->strip_count; ++i) {
        const timeline_strip *strip = &request->strip[i];
        double step_s = (double)(strip->to_ns - strip->from_ns) * 1e-9 / strip->bin_count;
        for (uint32_t k = 0; k < strip->bin_count; ++k) {
            double s = (double)strip->from_ns * 1e-9 + k * step_s;
            float most = 0.0f;
            for (int part = 0; part < 6; ++part)
                most = fmaxf(most, movement(s + step_s * part / 6.0, strip->performance));
            result->bin[strip->first_bin + k] = (activity_bin){0.5f * most, most};
        }
    }
    result->audio = request->audio;
    result->about = (show_audio){
        .id = request->audio, .rate_hz = 48000, .channel_count = 1, .frame_count = 48000 * 3600};
    snprintf(result->about.name, sizeof result->about.name, "Boom microphone");
    result->has_wave = request->audio != 0 && request->audio_to > request->audio_from;
    int64_t per_pair = 1;
    while ((request->audio_to - request->audio_from) / per_pair > 1000)
        per_pair *= 2;
    result->wave.first_frame = request->audio_from / per_pair * per_pair;
    result->wave.frames_per_pair = per_pair;
    result->wave.count = 0;
    for (int64_t f = result->wave.first_frame; f < request->audio_to && result->wave.count < 4096;
         f += per_pair) {
        float size = movement((double)f / 48000.0, 3) * 2.5f;
        float tone = per_pair > 8 ? 1.0f : (float)sin((double)f * 0.05);
        result->wave.pair[result->wave.count++] =
            (waveform_pair){per_pair > 8 ? -size : size * tone, size * tone};
    }
}

const timeline_result *timeline_worker_result(timeline_worker *self)
{
    return &self->result;
}

const timeline_strip *timeline_result_strip(const timeline_result *result, uint32_t owner,
                                            uint32_t clip)
{
    for (uint32_t i = 0; i < result->strip_count; ++i)
        if (result->strip[i].clip == clip && result->strip[i].owner == owner)
            return &result->strip[i];
    return NULL;
}

bool timeline_worker_is_busy(const timeline_worker *self)
{
    (void)self;
    return false;
}

const timeline_comps *timeline_worker_comps(timeline_worker *self)
{
    (void)self;
    return here->comps;
}

/* ---- the screen ---- */

void stand_open(stand *s, float width, float height, float scale)
{
    error err = {""};
    *s = (stand){.width = width, .height = height, .news = news_list_create()};
    s->choice.marker = -1;
    s->status.can_record = true;
    s->looks.is_snapping = true;
    s->status.journal_ns = 1800 * NS_PER_S;
    transport_init(&s->transport, 0);
    here = s;
    if (window_open_hidden(&s->window, (uint32_t)lroundf(width * scale),
                           (uint32_t)lroundf(height * scale), scale, 1.0 / 60.0, &err) < 0) {
        print_message("SKIPPED: %s\n", err.text);
        news_list_destroy(s->news);
        skip();
    }
    window_hidden_put_away(s->window, true);
    assert_int_equal(ui_create(&s->ui, &err), MRT_OK);
    ui_note_words(s->ui, true);
    s->panel = panel_timeline.create(&the_studio);
    assert_non_null(s->panel);
    stand_settle(s);
}

void stand_close(stand *s)
{
    panel_timeline.destroy(s->panel);
    ui_destroy(s->ui);
    window_close(s->window);
    news_list_destroy(s->news);
    take_finish(&s->take);
    for (uint32_t i = 0; s->comps && i < s->comps->count; ++i)
        take_finish(&s->comps->take[i]);
    free(s->comps);
}

void stand_frame(stand *s)
{
    ui_screen screen;
    s->clock_ns += s->transport.is_playing ? NS_PER_S / 60 : 0;
    assert_true(window_begin(s->window, s->ui, &screen));
    ui_begin(s->ui, &screen);
    panel_timeline.update(s->panel, 1.0 / 60.0);
    panel_timeline.draw(s->panel, s->ui, (ui_rectangle){0.0f, 0.0f, s->width, s->height});
    ui_end(s->ui);
    window_end(s->window, s->ui);
}

void stand_settle(stand *s)
{
    for (int i = 0; i < 3 || !ui_is_idle(s->ui); ++i)
        stand_frame(s);
    stand_frame(s);
}

void stand_choose(stand *s, take t)
{
    take_finish(&s->take);
    s->take = t;
    s->edition += 1;
    transport_init(&s->transport, t.duration_ns);
    stand_settle(s);
}

void stand_list(stand *s, uint32_t count)
{
    static const char *const names[] = {"night ride", "", "the letter, angry and then very quiet",
                                        "again"};
    s->line_count = count < STAND_TAKES ? count : STAND_TAKES;
    for (uint32_t i = 0; i < s->line_count; ++i) {
        app_take_line *line = &s->line[i];
        *line = (app_take_line){.id = i + 1,
                                .rating = i * 7 % 6,
                                .duration_ns = (int64_t)(3 + i * 37 % 400) * NS_PER_S,
                                .is_deleted = i % 11 == 10};
        snprintf(line->title, sizeof line->title, "1/a %u%s%s", i + 1, names[i % 4][0] ? " " : "",
                 names[i % 4]);
        snprintf(line->note, sizeof line->note, "%s", i % 3 == 0 ? "breath before the line" : "");
    }
}

/* ---- the pointer ---- */

float stand_x(const stand *s, double time_s)
{
    return timeline_axis_x(&s->panel->axis, (int64_t)llround(time_s * 1e9));
}

float stand_y(const stand *s, uint32_t row)
{
    const timeline_row *of = &s->panel->rows.row[row];
    return of->y + 0.7f * of->height;
}

void stand_move(stand *s, float x, float y)
{
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
    stand_settle(s);
}

void stand_button(stand *s, uint32_t button, bool is_down)
{
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_BUTTON, .code = button, .is_down = is_down});
    stand_settle(s);
}

/* Long enough after the last one not to be a double click. */
static void wait_a_moment(stand *s)
{
    for (int i = 0; i < 40; ++i)
        stand_frame(s);
}

void stand_click(stand *s, float x, float y)
{
    wait_a_moment(s);
    stand_move(s, x, y);
    stand_button(s, 0, true);
    stand_button(s, 0, false);
}

void stand_double_click(stand *s, float x, float y)
{
    stand_click(s, x, y);
    stand_button(s, 0, true);
    stand_button(s, 0, false);
}

void stand_drag(stand *s, float x0, float y0, float x1, float y1)
{
    wait_a_moment(s);
    stand_move(s, x0, y0);
    stand_button(s, 0, true);
    for (int i = 1; i <= 4; ++i)
        stand_move(s, x0 + (x1 - x0) * (float)i / 4.0f, y0 + (y1 - y0) * (float)i / 4.0f);
    stand_button(s, 0, false);
}

void stand_wheel(stand *s, float x, float y, float notches)
{
    stand_move(s, x, y);
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_WHEEL, .y = notches});
    stand_settle(s);
}

void stand_key(stand *s, uint32_t key, bool is_down)
{
    ui_push(s->ui, &(ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = is_down});
    stand_settle(s);
}

void stand_type(stand *s, const char *text)
{
    for (; *text; ++text)
        ui_push(s->ui, &(ui_event){.kind = UI_EVENT_TEXT, .code = (unsigned char)*text});
    stand_settle(s);
}

const ui_word *stand_word(stand *s, const char *text)
{
    const ui_word *words;
    uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            return &words[i];
    return NULL;
}

void stand_click_word(stand *s, const char *text)
{
    const ui_word *word = stand_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    stand_click(s, word->where.x + 0.5f * word->where.width,
                word->where.y + 0.5f * word->where.height);
}

/* ---- looking ---- */

void stand_picture(stand *s, const char *name)
{
    char path[512];
    error err = {""};
    window_hidden_put_away(s->window, false);
    stand_frame(s);
    window_hidden_put_away(s->window, true);
    if (!getenv("MAROTTE_PICTURES"))
        return;
    mkdir(BUILD_DIR "/out", 0777);
    snprintf(path, sizeof path, "%s/out/timeline_%s.png", BUILD_DIR, name);
    if (window_picture(s->window, path, &err) < 0)
        fail_msg("%s", err.text);
}

static bool overlap(ui_rectangle a, ui_rectangle b)
{
    const float slack = 1.0f;
    return a.x + slack < b.x + b.width && b.x + slack < a.x + a.width &&
           a.y + slack < b.y + b.height && b.y + slack < a.y + a.height;
}

/* What of a word is not cut away by the edge of a list. */
static ui_rectangle seen(const ui_word *word)
{
    const ui_rectangle at = word->where, clip = word->clip;
    const float left = fmaxf(at.x, clip.x), top = fmaxf(at.y, clip.y);
    return (ui_rectangle){left, top, fminf(at.x + at.width, clip.x + clip.width) - left,
                          fminf(at.y + at.height, clip.y + clip.height) - top};
}

void stand_check_words(stand *s)
{
    const ui_word *words;
    uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i) {
        const ui_rectangle at = words[i].where;
        if (at.x < -0.5f || at.x + at.width > s->width + 0.5f)
            fail_msg("\"%s\" is cut off by the screen", words[i].text);
        for (uint32_t k = i + 1; k < count; ++k)
            if (overlap(seen(&words[i]), seen(&words[k])))
                fail_msg("\"%s\" and \"%s\" overlap", words[i].text, words[k].text);
    }
}
