#include "window/offers.h"
#include "window/app/camera_package.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>

typedef enum offer {
    OFFER_CAMERA = 0, /* the order in which they are offered */
    OFFER_KEYBOARD,
    OFFER_DEMO,
    OFFER_MOUSE,
    OFFERS
} offer;

static const struct {
    const char *title, *help;
} offer_words[OFFERS] = {
    {"Camera", "Track your bare hand with a webcam, in a page of your browser."},
    {"Keyboard hand", "Bend the fingers of a virtual hand with the keys. Press Esc to stop."},
    {"Try a demo hand", "A recorded hand performs in a loop until you remove it."},
    {"Mouse", "Drag the face. Shift holds the pull, Ctrl shapes it like clay."},
};

/* What the camera needs is downloaded by its first click, which the button says. */
static const char *title_of(app *of, offer which, char out[32])
{
    const bool is_download = which == OFFER_CAMERA && !app_notes_of(of)->has_tracker;
    (void)snprintf(out, 32, is_download ? "%s (%.0f MB)" : "%s", offer_words[which].title,
                   1e-6 * (double)camera_package_used->archive_size);
    return out;
}

static const char *help_of(app *of, offer which)
{
    return which == OFFER_CAMERA && !app_notes_of(of)->has_tracker
               ? "Download the hand tracker once (MediaPipe Hands, from the npm registry), then "
                 "track your bare hand with a webcam, in a page of your browser."
               : offer_words[which].help;
}

/* The way that works here at once is the first choice. */
static bool is_first_choice(app *of, offer which)
{
    return which == (app_notes_of(of)->is_camera_ready ? OFFER_CAMERA : OFFER_DEMO);
}

/* A face is there, and nothing that an offer would be in the way of. */
static bool can_be_asked(app *of)
{
    return !app_status(of)->is_recording && !app_looks_of(of)->is_helping && app_view(of)->number;
}

static bool is_empty(app *of)
{
    input_opening opening[INPUT_OPENINGS_MAX];
    const live *stage = app_live(of);
    uint32_t opened = 0;
    for (uint32_t i = 0; i < live_input_count(stage); ++i)
        opened += !live_input_is_own(stage, i);
    return opened == 0 && app_openings(of, opening) == 0 && !app_has_hand_keys(of) &&
           !app_pull_count(of) && !app_take_id(of);
}

static bool is_there(app *of, offer which)
{
    const mrt_plugin_type *type;
    char text[APP_DEMO_TEXT];
    error err = {0};
    if (which == OFFER_CAMERA)
        return plugin_list_find(app_plugins(of), "camera", MRT_INPUT, &type, &err) >= 0;
    return which != OFFER_DEMO || app_demo_hand(text);
}

static void accept(app *of, offer which)
{
    char text[APP_DEMO_TEXT];
    switch (which) {
    case OFFER_CAMERA:
        app_ask(of, APP_CALL_CAMERA);
        break;
    case OFFER_KEYBOARD:
        app_do(of, ACTION_HAND_KEYS);
        break;
    case OFFER_DEMO:
        if (app_demo_hand(text))
            (void)!app_open_input(of, text); /* the error is in the messages */
        break;
    default:
        news_list_add(app_news(of), MRT_LOG_INFO, "stage", offer_words[OFFER_MOUSE].help);
        break;
    }
}

/* A mesh without a rig, on which nothing performs. */
static bool is_without_rig(app *of)
{
    const face_file *file = app_face(of);
    return file && !file->rig && !live_mapping(app_live(of)) && app_view(of)->mode == LIVE_PERFORMS;
}

static const float padding = 8.0f, pitch = 31.0f; /* of lines of buttons */

/* At the lower edge of the face, in its middle. */
static void begin_box(ui *on, const char *id, ui_rectangle over, float width, float height)
{
    const ui_rectangle box = {over.x + 8.0f, over.y + over.height - height - 8.0f, width, height};
    ui_panel_begin(on, id, box, UI_GROUND_PANEL);
}

static float width_of(app *of, const ui *on, offer which)
{
    char title[32];
    return ui_text_width(on, UI_STYLE_BODY, title_of(of, which, title)) + 22.0f;
}

static const struct {
    const char *name;
    double mm;
} units[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}};
enum { UNITS = sizeof units / sizeof units[0] };

/* Offers the possible units of the height. The current one is highlighted. */
static void draw_unit(app *of, ui *on, mesh_frame *wanted)
{
    const mesh *m = &app_face(of)->mesh;
    float low[3], high[3];
    char text[96], hint[96];
    mesh_bounds(m, low, high);
    const double height_mm = (double)high[1] - (double)low[1];
    (void)snprintf(text, sizeof text, "%.0f mm high. Its unit:", height_mm);
    ui_text(on, UI_STYLE_BODY, text);
    for (uint32_t i = 0; i < UNITS; ++i) {
        ui_same_line(on);
        if (ui_button(on, units[i].name, m->mm_per_unit == units[i].mm ? UI_ACCENT : UI_PLAIN))
            wanted->mm_per_unit = units[i].mm;
        (void)snprintf(hint, sizeof hint, "With this unit it is %.4g mm high.",
                       height_mm / m->mm_per_unit * units[i].mm);
        ui_hint(on, hint);
    }
}

static mesh_axis opposite(mesh_axis axis)
{
    return axis >= MESH_AXIS_MINUS_X ? axis - 3 : axis + 3;
}

/* At right angles to both, as x is to y and z. */
static mesh_axis across(mesh_axis up, mesh_axis forward)
{
    const uint32_t u = (up - 1u) % 3, f = (forward - 1u) % 3, line = 3 - u - f;
    const bool is_turned = (u + 1) % 3 != f;
    const bool is_minus = is_turned ^ (up >= MESH_AXIS_MINUS_X) ^ (forward >= MESH_AXIS_MINUS_X);
    return (mesh_axis)(MESH_AXIS_X + line + (is_minus ? 3u : 0u));
}

/* A head that is seen from above, from behind or from the side. */
static void draw_turns(app *of, ui *on, mesh_frame *wanted)
{
    const mesh *m = &app_face(of)->mesh;
    if (ui_button(on, "Tip it up", UI_PLAIN)) {
        wanted->up = m->forward;
        wanted->forward = opposite(m->up);
    }
    ui_hint(on, "Turn by 90 degrees until the head is upright.");
    ui_same_line(on);
    if (ui_button(on, "Turn it", UI_PLAIN)) {
        wanted->up = m->up;
        wanted->forward = across(m->up, m->forward);
    }
    ui_hint(on, "Turn by 90 degrees until the face looks at you.");
}

/* Opens the face with another unit or orientation. Other values stay as chosen or guessed. */
static void reframe(app *of, mesh_frame *wanted, double unit_mm)
{
    const mesh *m = &app_face(of)->mesh;
    if (wanted->mm_per_unit == 0.0)
        wanted->mm_per_unit = unit_mm;
    if (wanted->up == MESH_AXIS_AUTO) {
        wanted->up = m->up;
        wanted->forward = m->forward;
    }
    (void)!app_set_face_frame(of, wanted); /* the error is in the messages */
}

static void draw_rig_offer(app *of, ui *on, ui_rectangle over)
{
    char text[160];
    const bool is_drafting = app_notes_of(of)->is_drafting;
    (void)snprintf(text, sizeof text,
                   is_drafting ? "Looking for the face in %.80s..." : "%.80s has no rig yet",
                   file_name_of(app_face_path(of)));
    const float wide = ui_text_width(on, UI_STYLE_DIM, text) + 22.0f + 2.0f * padding;
    const double unit_mm = app_face_unit_mm(of);
    const bool asks = !is_drafting && (app_face(of)->mesh.is_unit_guessed || unit_mm > 0.0);
    const float width = fmaxf(wide, is_drafting ? 150.0f : 320.0f);
    const float height = 34.0f + (is_drafting ? 0.0f : pitch) + (asks ? pitch : 0.0f);
    mesh_frame wanted = {.mm_per_unit = 0.0};
    begin_box(on, "rig offer", over, width, height);
    ui_text(on, UI_STYLE_DIM, text);
    if (asks)
        draw_unit(of, on, &wanted);
    if (!is_drafting && ui_button(on, "Draft a rig", UI_ACCENT))
        app_ask_draft(of);
    if (!is_drafting) {
        char hint[192], keys[KEY_WORDS + 4];
        key_map_after(&app_looks_of(of)->keys, ACTION_PANEL_RIG, keys);
        (void)snprintf(hint, sizeof hint,
                       "Find the face by its skeleton, parts and shape, and make it perform. The "
                       "panel Rig%s shows what was guessed.",
                       keys);
        ui_hint(on, hint);
        ui_same_line(on);
        draw_turns(of, on, &wanted);
    }
    ui_panel_end(on);
    if (wanted.mm_per_unit > 0.0 || wanted.up != MESH_AXIS_AUTO)
        reframe(of, &wanted, unit_mm);
}

/* A head without a slit between its lips was drafted. */
static void draw_mouth_offer(app *of, ui *on, ui_rectangle over)
{
    const bool is_cutting = app_notes_of(of)->is_drafting;
    const char *text = is_cutting ? "Cutting the mouth..." : APP_MOUTH_QUESTION;
    const float wide = ui_text_width(on, UI_STYLE_DIM, text) + 22.0f + 2.0f * padding;
    const float width = fmaxf(wide, is_cutting ? 150.0f : 260.0f);
    const float height = 34.0f + (is_cutting ? 0.0f : pitch);
    begin_box(on, "mouth offer", over, width, height);
    ui_text(on, UI_STYLE_DIM, text);
    if (!is_cutting) {
        if (ui_button(on, "Cut the mouth", UI_ACCENT))
            app_notes_of(of)->mouth_answer = APP_MOUTH_CUT;
        ui_hint(on, APP_MOUTH_CUT_HINT);
        ui_same_line(on);
        if (ui_button(on, "Perform as clay", UI_PLAIN))
            app_notes_of(of)->mouth_answer = APP_MOUTH_CLAY;
        ui_hint(on, APP_MOUTH_CLAY_HINT);
    }
    ui_panel_end(on);
}

static bool is_offered(const offers *self, app *of, offer which)
{
    if (self->when == OFFERS_DEMO && which != OFFER_DEMO)
        return false;
    if (self->when == OFFERS_OWN_HAND && which != OFFER_CAMERA && which != OFFER_KEYBOARD)
        return false;
    return is_there(of, which);
}

float offers_draw(offers *self, app *of, ui *on, ui_rectangle over)
{
    offer list[OFFERS];
    uint32_t count = 0;
    char title[32];
    float width = ui_text_width(on, UI_STYLE_DIM, "Perform with");
    if (app_looks_of(of)->layouts.now.current == APP_RIG || !can_be_asked(of))
        return 0.0f; /* in Rig the face is worked on, and a draft is offered there */
    if (is_without_rig(of)) {
        draw_rig_offer(of, on, over);
        return 0.0f;
    }
    if (app_notes_of(of)->is_mouth_asked) {
        draw_mouth_offer(of, on, over);
        return 0.0f;
    }
    if (self->when == OFFERS_NEVER ||
        (self->when == OFFERS_WHEN_EMPTY && (self->is_gone || !is_empty(of))))
        return 0.0f;
    for (uint32_t i = 0; i < OFFERS; ++i)
        if (is_offered(self, of, (offer)i)) {
            list[count++] = (offer)i;
            width = fmaxf(width, width_of(of, on, (offer)i));
        }
    const float height = 34.0f + (float)count * pitch;
    const float wide = width + 2.0f * padding;
    const ui_rectangle box = {self->has_camera ? over.x + over.width - wide - 4.0f : over.x + 4.0f,
                              over.y + over.height - height - 4.0f, wide, height};
    ui_panel_begin(on, "offers", box, UI_GROUND_PANEL);
    ui_text(on, UI_STYLE_DIM, "Perform with");
    for (uint32_t i = 0; i < count; ++i) {
        ui_disabled_begin(on, list[i] == OFFER_CAMERA && app_notes_of(of)->is_camera_busy);
        if (ui_button(on, title_of(of, list[i], title),
                      is_first_choice(of, list[i]) ? UI_ACCENT : UI_PLAIN)) {
            self->is_gone =
                list[i] != OFFER_CAMERA; /* a download may fail, and is asked for again */
            accept(of, list[i]);
        }
        ui_disabled_end(on);
        ui_hint(on, help_of(of, list[i]));
    }
    ui_panel_end(on);
    return height + 4.0f;
}
