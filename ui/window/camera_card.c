#include "window/camera_card.h"
#include "window/app/camera_package.h"
#include "window/app/camera_page.h"
#include "window/app/camera_setup.h"
#include "window/gui/hand_figure.h"
#include "window/gui/theme.h"
#include "window/panels/calibrate_guide.h"

#include "base/angle.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum lesson { /* the calibration */
                      LESSON_NONE = 0,
                      LESSON_POSES,
                      LESSON_MISFIT, /* all poses are done, but do not fit */
                      LESSON_DONE    /* saved and used; shown for a while */
} lesson;

struct camera_card {
    app *app;
    camera_setup *setup;
    hand_skeleton *skeleton[2]; /* of the poses that are asked for, by side */
    camera_setup_state state;   /* of this frame */
    bool is_asked;              /* the camera is wanted: it is opened after the download */
    bool shows_page;            /* its page is opened when the input is open */
    uint16_t port;              /* of that page; 0: of the first camera */
    bool is_hidden;             /* the user hid the hand, until the camera is asked for again */
    input *camera;              /* NULL: none is open */
    uint32_t index;             /* of live_input */
    bool has_sight;
    hand_sight sight;
    double seen_s; /* for how long a hand is seen without a gap */
    lesson lesson;
    calibrate_guide guide;
    double shown_s; /* LESSON_DONE, so far */
    error trouble;  /* of the calibration */
};

static const int64_t sight_ns = 1200 * NS_PER_MS; /* a hand that was seen so long ago is away */
static const double steady_s = 1.0, told_s = 4.0;
static const float sure = 0.5f; /* confidence with which a hand performs, see plugin.h */
static const char skip_key[] = "camera.skips_calibration";
static const char *const side_word[2] = {"left", "right"};
enum { SAMPLES_A_FRAME = 512 };

camera_card *camera_card_create(app *of)
{
    camera_card *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    self->setup = camera_setup_create();
    for (uint32_t side = 0; side < 2; ++side)
        self->skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    if (self->setup && self->skeleton[0] && self->skeleton[1])
        return self;
    camera_card_destroy(self);
    return NULL;
}

void camera_card_destroy(camera_card *self)
{
    if (!self)
        return;
    calibrate_guide_end(&self->guide);
    camera_setup_destroy(self->setup);
    for (uint32_t side = 0; side < 2; ++side)
        hand_skeleton_destroy(self->skeleton[side]);
    free(self);
}

/* ---- from the button to the page ---- */

static void ask(camera_card *self)
{
    self->is_asked = true;
    self->is_hidden = false;
    camera_setup_fetch(self->setup);
}

static void open_camera(camera_card *self)
{
    self->shows_page = true;
    if (!self->camera && app_open_input(self->app, "camera") < 0)
        self->shows_page = false; /* the function reports its own error */
}

static void follow_setup(camera_card *self)
{
    if (app_take_call(self->app, APP_CALL_CAMERA)) {
        self->port = app_notes_of(self->app)->camera_port;
        app_notes_of(self->app)->camera_port = 0;
        ask(self);
    }
    self->state = camera_setup_now(self->setup);
    if (!self->is_asked || self->state.is_fetching)
        return;
    self->is_asked = false;
    if (self->state.has_tracker)
        open_camera(self);
}

static void find_camera(camera_card *self)
{
    live *stage = app_live(self->app);
    input *before = self->camera;
    self->camera = NULL;
    for (uint32_t i = 0; i < live_input_count(stage) && !self->camera; ++i)
        if (strcmp(input_plugin(live_input(stage, i))->id, CAMERA_PAGE_PLUGIN) == 0) {
            self->camera = live_input(stage, i);
            self->index = i;
        }
    if (self->camera != before) {
        self->has_sight = false;
        self->seen_s = 0.0;
    }
}

static void follow_page(camera_card *self)
{
    input_opening opening[INPUT_OPENINGS_MAX];
    if (!self->shows_page)
        return;
    if (self->camera) {
        const char *text = live_input_text(app_live(self->app), self->index);
        camera_setup_show(self->setup, self->port ? self->port : camera_page_port(text));
        self->shows_page = false;
    } else if (app_openings(self->app, opening) == 0 && app_opening_trouble(self->app)[0])
        self->shows_page = false; /* opening failed: the news say why */
}

/* ---- the hand ---- */

static bool is_seen(const camera_card *self)
{
    return self->has_sight && clock_now_ns() - self->sight.time_ns < sight_ns;
}

static bool is_clear(const camera_card *self)
{
    return is_seen(self) && self->sight.confidence >= sure;
}

static void follow_hand(camera_card *self, double dt_s)
{
    self->has_sight = self->camera && input_sight(self->camera, &self->sight);
    self->seen_s = is_clear(self) ? self->seen_s + dt_s : 0.0;
}

/* ---- calibration ---- */

static void leave_lesson(camera_card *self)
{
    if (self->lesson == LESSON_POSES || self->lesson == LESSON_MISFIT)
        live_tap(app_live(self->app), UINT32_MAX);
    calibrate_guide_end(&self->guide);
    self->lesson = LESSON_NONE;
}

/* Returns false if no hand of the camera can be calibrated. */
static bool find_side(const camera_card *self, uint32_t *out_side)
{
    uint32_t count;
    const mrt_channel *channels = input_channels(self->camera, &count);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (glove_channels_of(channels, count, side) == GLOVE_CHANNELS_RAD) {
            *out_side = side;
            return true;
        }
    return false;
}

static void begin_lesson(camera_card *self)
{
    uint32_t count, side = MRT_RIGHT;
    leave_lesson(self);
    self->trouble = (error){""};
    if (!find_side(self, &side))
        return;
    const mrt_channel *channels = input_channels(self->camera, &count);
    if (calibrate_guide_begin(&self->guide, channels, count, side, input_name(self->camera),
                              &self->trouble) < 0)
        return;
    live_tap(app_live(self->app), self->index);
    self->lesson = LESSON_POSES;
}

static void skip_lesson(camera_card *self)
{
    settings_set_number(app_settings(self->app), skip_key, 1.0);
    leave_lesson(self);
}

/* The first time that a hand is seen for a while. */
static bool is_lesson_due(const camera_card *self)
{
    uint32_t side;
    return self->lesson == LESSON_NONE && self->seen_s >= steady_s && !self->is_hidden &&
           !app_status(self->app)->is_recording && find_side(self, &side) &&
           !live_calibration(app_live(self->app), side) &&
           settings_number(app_settings(self->app), skip_key, 0.0) == 0.0;
}

static void keep_lesson(camera_card *self)
{
    char name[32], *path = NULL;
    const uint32_t side = self->guide.glove.side;
    (void)snprintf(name, sizeof name, "%s hand", side_word[side]);
    mrt_result result = calibrate_guide_keep(&self->guide, name, 0.0, &path, &self->trouble);
    if (result >= 0)
        result = calibrate_use(self->app, side, path, &self->trouble);
    free(path);
    leave_lesson(self);
    self->lesson = result < 0 ? LESSON_NONE : LESSON_DONE;
    self->shown_s = 0.0;
}

static bool is_wrong(const guide_judgement *of)
{
    for (uint32_t i = 0; i < of->flaw_count; ++i)
        if (guide_flaw_is_wrong(&of->flaw[i]))
            return true;
    return false;
}

static void follow_lesson(camera_card *self, double dt_s)
{
    mrt_sample sample;
    if (!self->camera) {
        leave_lesson(self);
        return;
    }
    self->shown_s += dt_s;
    if (self->lesson == LESSON_DONE && self->shown_s > told_s)
        self->lesson = LESSON_NONE;
    if (is_lesson_due(self))
        begin_lesson(self);
    if (self->lesson != LESSON_POSES)
        return;
    for (int i = 0; i < SAMPLES_A_FRAME && live_pop_tapped(app_live(self->app), &sample); ++i)
        calibrate_guide_sample(&self->guide, &sample);
    if (guide_current(self->guide.guide) < GUIDE_STEPS)
        return;
    if (!self->guide.result || is_wrong(&self->guide.judgement))
        self->lesson = LESSON_MISFIT;
    else
        keep_lesson(self);
}

void camera_card_update(camera_card *self, double dt_s)
{
    app_notes *notes = app_notes_of(self->app);
    find_camera(self);
    follow_setup(self);
    follow_page(self);
    follow_hand(self, dt_s);
    follow_lesson(self, dt_s);
    notes->has_tracker = self->state.has_tracker;
    notes->is_camera_ready = self->state.has_tracker && self->state.has_browser;
    notes->is_camera_busy = self->is_asked || self->shows_page;
    if (!self->state.is_known || self->is_asked || self->shows_page || self->lesson != LESSON_NONE)
        app_want_frame(self->app, 0.1);
    else if (self->camera)
        app_want_frame(self->app, 0.25); /* the light goes out without a new face */
}

/* ---- drawing: the download ---- */

static const float margin = 12.0f;

/* A small stage needs its room for the face. */
static bool is_small(ui_rectangle over)
{
    return over.width < 640.0f || over.height < 400.0f;
}

static const float column = 180.0f; /* of a small stage */

static void begin_card(ui *on, ui_rectangle over, float height)
{
    ui_rectangle box = {over.x + margin, over.y + margin, 216.0f, height};
    if (is_small(over))
        box = (ui_rectangle){over.x, over.y, column, over.height};
    ui_panel_begin(on, "camera", box, UI_GROUND_PANEL);
}

static void draw_download(camera_card *self, ui *on, ui_rectangle over)
{
    const double mb = 1e-6, done = (double)self->state.done, whole = (double)self->state.whole;
    char words[64];
    begin_card(on, over, 112.0f);
    ui_text(on, UI_STYLE_STRONG, "Hand tracker");
    if (whole > 0.0)
        (void)snprintf(words, sizeof words, "%.0f of %.0f MB", fmin(done, whole) * mb, whole * mb);
    else
        (void)snprintf(words, sizeof words, "Checking\xe2\x80\xa6");
    ui_text(on, UI_STYLE_DIM, words);
    ui_bar(on, whole > 0.0 ? (float)fmin(done / whole, 1.0) : 0.0f, 0.0f, 8.0f, UI_STYLE_BODY);
    ui_space(on, 2.0f);
    if (ui_button(on, "Cancel", UI_PLAIN)) {
        camera_setup_cancel(self->setup);
        self->is_asked = false;
    }
    ui_panel_end(on);
}

static void draw_trouble(camera_card *self, ui *on, ui_rectangle over)
{
    begin_card(on, over, 152.0f);
    ui_scroll_begin(on, "trouble", 0.0f, 104.0f);
    ui_text_wrapped(on, UI_STYLE_WARNING, self->state.trouble.text);
    ui_scroll_end(on);
    if (ui_button(on, "Try again", UI_ACCENT))
        ask(self);
    ui_same_line(on);
    if (ui_button(on, "Close", UI_PLAIN))
        camera_setup_forget_trouble(self->setup);
    ui_panel_end(on);
}

/* A camera that was opened in another way. */
static void draw_missing(camera_card *self, ui *on, ui_rectangle over)
{
    char words[48];
    begin_card(on, over, 92.0f);
    ui_text_wrapped(on, UI_STYLE_BODY, "The camera needs a hand tracker, once.");
    (void)snprintf(words, sizeof words, "Download %.0f MB",
                   1e-6 * (double)camera_package_used->archive_size);
    if (ui_button(on, words, UI_ACCENT))
        ask(self);
    ui_hint(on, "MediaPipe Hands, from the npm registry. It runs only in your browser.");
    ui_same_line(on);
    if (ui_button(on, "Hide", UI_PLAIN))
        self->is_hidden = true;
    ui_panel_end(on);
}

/* ---- drawing: the hand ---- */

static void draw_sight_light(const camera_card *self, ui *on)
{
    ui_canvas at;
    const bool is_dim = !is_seen(self);
    const uint32_t colour = is_dim ? THEME_DIM : is_clear(self) ? THEME_GOOD : THEME_WARNING;
    const char *words = is_dim ? "No hand seen" : is_clear(self) ? "Hand seen" : "Hand unclear";
    ui_canvas_begin(on, "light", 0.0f, 20.0f, &at);
    const float middle = at.where.y + 0.5f * at.where.height;
    if (is_dim)
        ui_draw_ring(on, at.where.x + 6.0f, middle, 4.5f, colour, 1.5f);
    else
        ui_draw_disc(on, at.where.x + 6.0f, middle, 5.0f, colour);
    ui_draw_text(on, at.where.x + 18.0f, middle - 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                 UI_STYLE_STRONG, THEME_TEXT, at.where.width - 20.0f, words);
    ui_canvas_end(on);
    ui_hint(on, "Keep the whole hand and the wrist in the picture, with light from the front.");
}

static void draw_hand(const camera_card *self, ui *on, float height)
{
    ui_canvas at;
    if (!self->has_sight) {
        ui_scroll_begin(on, "first", 0.0f, height);
        ui_text_wrapped(on, UI_STYLE_BODY,
                        "In the page of your browser, press \"Start the camera\", allow the "
                        "camera, and show a hand.");
        ui_scroll_end(on);
        return;
    }
    ui_canvas_begin(on, "hand", 0.0f, height, &at);
    ui_draw_box(on, at.where, THEME_WELL, 4.0f);
    const uint32_t own = self->sight.seen.side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT;
    if (is_seen(self))
        hand_figure_draw_seen(on, at.where, self->sight.seen.at, is_clear(self) ? own : THEME_DIM);
    ui_canvas_end(on);
}

/* ---- drawing: the calibration ---- */

static const float ring_large = 76.0f, ring_small = 60.0f;

/* From the top, clockwise. */
static void draw_arc(ui *on, float x, float y, float radius, double share, uint32_t colour)
{
    enum { PIECES = 64 };
    float xy[2 * (PIECES + 1)];
    const uint32_t count = (uint32_t)lround(share * PIECES) + 1;
    for (uint32_t i = 0; i < count; ++i) {
        const double angle_rad = 2.0 * ANGLE_PI * i / PIECES;
        xy[2 * i] = x + radius * (float)sin(angle_rad);
        xy[2 * i + 1] = y - radius * (float)cos(angle_rad);
    }
    if (count > 1)
        ui_draw_lines(on, xy, count, colour, 4.0f);
}

/* The pose that is asked for, in a ring that fills while it is held. */
static void draw_pose(const camera_card *self, ui *on, float size)
{
    float angle_rad[MRT_ANGLES];
    ui_canvas at;
    const uint32_t side = self->guide.glove.side;
    const double held = is_seen(self) ? guide_held(self->guide.guide) : 0.0;
    guide_pose(guide_current(self->guide.guide), angle_rad);
    ui_canvas_begin(on, "pose", size, size, &at);
    const float x = at.where.x + 0.5f * size, y = at.where.y + 0.5f * size;
    const float radius = 0.5f * size - 3.0f, inside = 0.62f * size;
    ui_draw_ring(on, x, y, radius, THEME_WELL, 4.0f);
    draw_arc(on, x, y, radius, held, THEME_ACCENT);
    hand_figure_draw_still(on, (ui_rectangle){x - 0.5f * inside, y - 0.5f * inside, inside, inside},
                           self->skeleton[side], angle_rad,
                           side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT);
    ui_canvas_end(on);
}

static void draw_poses(camera_card *self, ui *on, float ring_size)
{
    static const char *const short_words[GUIDE_STEPS] = {
        [GUIDE_FLAT] = "Flat hand", [GUIDE_FIST] = "Fist", [GUIDE_SPREAD] = "Spread"};
    const guide_step step = guide_current(self->guide.guide);
    const guide_wait waits = guide_waiting(self->guide.guide);
    char words[48];
    int of = 0;
    const int number = guide_number(self->guide.guide, &of);
    draw_pose(self, on, ring_size);
    ui_same_line(on);
    ui_scroll_begin(on, "words", 0.0f, ring_size);
    ui_text(on, UI_STYLE_TITLE, short_words[step] ? short_words[step] : guide_step_name[step]);
    (void)snprintf(words, sizeof words, "%d of %d", number, of);
    if (ring_size >= ring_large)
        ui_text(on, UI_STYLE_DIM, words);
    ui_text_wrapped(on, UI_STYLE_BODY,
                    is_seen(self) && waits != GUIDE_WAITS_FOR_SAMPLES ? guide_wait_text[waits]
                                                                      : "show the hand");
    ui_scroll_end(on);
    ui_hint(on, guide_instruction(self->guide.guide));
    ui_scroll_begin(on, "why", 0.0f, 70.0f);
    if (self->guide.tone == CALIBRATE_REFUSED)
        ui_text_wrapped(on, UI_STYLE_WARNING, self->guide.news);
    else
        ui_text_wrapped(on, UI_STYLE_DIM, guide_instruction(self->guide.guide));
    ui_scroll_end(on);
    if (ui_button(on, "Skip", UI_PLAIN))
        skip_lesson(self);
    ui_hint(on, "Perform without a calibration. \"Calibrate\" starts it later.");
}

static void draw_misfit(camera_card *self, ui *on, float ring_size)
{
    char words[96];
    guide_judgement_text(&self->guide.judgement, words, sizeof words);
    ui_scroll_begin(on, "why", 0.0f, ring_size + 74.0f);
    ui_text_wrapped(on, UI_STYLE_WARNING, self->guide.result ? words : self->guide.news);
    ui_scroll_end(on);
    if (ui_button(on, "Try again", UI_ACCENT)) {
        begin_lesson(self);
        return;
    }
    ui_same_line(on);
    if (ui_button(on, "Skip", UI_PLAIN))
        skip_lesson(self);
}

static void draw_idle(camera_card *self, ui *on)
{
    if (self->lesson == LESSON_DONE)
        ui_text(on, UI_STYLE_GOOD, "Calibrated to your hand.");
    if (self->trouble.text[0]) {
        ui_scroll_begin(on, "why", 0.0f, 52.0f);
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble.text);
        ui_scroll_end(on);
    }
    if (!self->has_sight) {
        if (ui_button(on, "Open page", UI_PLAIN))
            ask(self);
        ui_hint(on, "Open the page in your browser again.");
    } else {
        if (ui_button(on, "Calibrate", UI_PLAIN))
            begin_lesson(self);
        ui_hint(on, "Adapt to your hand with three poses: flat, fist, spread.");
    }
    ui_same_line(on);
    if (ui_button(on, "Hide", UI_PLAIN))
        self->is_hidden = true;
    ui_hint(on, "Hide the hand until the camera is asked for again. It goes on to perform.");
}

static void draw_preview(camera_card *self, ui *on, ui_rectangle over)
{
    const bool is_teaching = self->lesson == LESSON_POSES || self->lesson == LESSON_MISFIT;
    const float ring_size = is_small(over) ? ring_small : ring_large;
    const float below = is_teaching                   ? ring_size + 70.0f + 40.0f
                        : self->trouble.text[0]       ? 92.0f
                        : self->lesson == LESSON_DONE ? 60.0f
                                                      : 38.0f;
    const float hand = !self->has_sight  ? is_small(over) ? 88.0f : 72.0f
                       : !is_small(over) ? 150.0f
                       : is_teaching     ? 0.0f
                                         : 100.0f;
    begin_card(on, over, hand + below + 44.0f);
    draw_sight_light(self, on);
    if (hand > 0.0f)
        draw_hand(self, on, hand);
    if (self->lesson == LESSON_POSES)
        draw_poses(self, on, ring_size);
    else if (self->lesson == LESSON_MISFIT)
        draw_misfit(self, on, ring_size);
    else
        draw_idle(self, on);
    ui_panel_end(on);
}

typedef enum card_page {
    PAGE_NONE = 0,
    PAGE_DOWNLOAD,
    PAGE_TROUBLE,
    PAGE_MISSING,
    PAGE_PREVIEW
} card_page;

static card_page page_of(const camera_card *self)
{
    if (self->is_asked && self->state.is_fetching)
        return PAGE_DOWNLOAD;
    if (self->state.trouble.text[0])
        return PAGE_TROUBLE;
    if (!self->camera || self->is_hidden || !self->state.is_known)
        return PAGE_NONE;
    if (!self->state.has_tracker && !self->has_sight)
        return PAGE_MISSING;
    return settings_number(app_settings(self->app), APP_CAMERA_PREVIEW, 1.0) > 0.0 ? PAGE_PREVIEW
                                                                                   : PAGE_NONE;
}

float camera_card_width(const camera_card *self, ui_rectangle stage)
{
    return is_small(stage) && page_of(self) != PAGE_NONE ? column : 0.0f;
}

bool camera_card_draw(camera_card *self, ui *on, ui_rectangle stage)
{
    if (self->lesson == LESSON_POSES && ui_has_dialog(on))
        leave_lesson(self); /* the dialog Calibrate taps the input too */
    const card_page page = page_of(self);
    switch (page) {
    case PAGE_DOWNLOAD:
        draw_download(self, on, stage);
        break;
    case PAGE_TROUBLE:
        draw_trouble(self, on, stage);
        break;
    case PAGE_MISSING:
        draw_missing(self, on, stage);
        break;
    case PAGE_PREVIEW:
        draw_preview(self, on, stage);
        break;
    case PAGE_NONE:
        break;
    }
    return page != PAGE_NONE && !is_small(stage);
}
