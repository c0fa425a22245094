#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "viewport_stand.h"
#include "window/app/kept_scenery.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The only one there is: the contracts hand on pointers that stand for it. */
static viewport_stand *here;
static live *const a_live = (live *)(void *)&here;
static app *const a_studio = (app *)(void *)&here;

/* ---- the application ---- */

const live_view *app_view(const app *self)
{
    (void)self;
    return &here->view;
}

const face_file *app_face(const app *self)
{
    (void)self;
    return &here->file;
}

kept_scenery *app_scenery(const app *self)
{
    (void)self;
    return NULL;
}

const scenery *kept_scenery_now(const kept_scenery *self)
{
    static scenery studio;
    (void)self;
    studio = scenery_default();
    return &studio;
}

const scenery_picture *kept_scenery_picture(const kept_scenery *self, uint64_t *out_number)
{
    static const scenery_picture none;
    (void)self;
    *out_number = 0;
    return &none;
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

instance *live_mapping(live *self) /* none: the keys are named by their fingers */
{
    (void)self;
    return NULL;
}

const live_status *app_status(const app *self)
{
    static const live_status nobody_records;
    (void)self;
    return &nobody_records;
}

bool app_take_request(app *self, action of)
{
    (void)self;
    bool was = here->asked[of];
    here->asked[of] = false;
    return was;
}

bool app_is_held(const app *self)
{
    (void)self;
    return false;
}

app_notes *app_notes_of(app *self)
{
    static app_notes notes;
    (void)self;
    return &notes;
}

void app_begin_pull(app *self)
{
    (void)self;
}

void app_hold(app *self, const char *words)
{
    (void)self, (void)words;
}

void app_do(app *self, action of)
{
    (void)self, (void)of;
}

bool app_has_hand_keys(const app *self)
{
    (void)self;
    return here->has_hand_keys;
}

/* ---- the stage ---- */

void live_point(live *self, pointer_grip grip, const float rest[3], const float at[3], bool stays,
                double radius_mm)
{
    (void)self;
    assert_true(here->told_count < STAND_TOLD);
    stand_told *told = &here->told[here->told_count++];
    *told = (stand_told){.grip = grip, .stays = stays, .radius_mm = radius_mm};
    memcpy(told->rest, rest, sizeof told->rest);
    memcpy(told->at, at, sizeof told->at);
    if (!here->pulls)
        return;
    here->view.pull.count = grip == POINTER_PULLS ? 1 : 0;
    mrt_vector *vector = &here->view.pull.vector[0];
    *vector = (mrt_vector){.start = {rest[0], rest[1], rest[2]}, .end = {at[0], at[1], at[2]}};
    stand_perform(here);
}

uint32_t live_input_count(const live *self)
{
    (void)self;
    return here->made ? 1 : 0;
}

input *live_input(live *self, uint32_t index)
{
    (void)self;
    return index == 0 ? here->made : NULL;
}

mrt_result live_add_input(live *self, input *made, const char *text, error *err)
{
    (void)self;
    (void)text;
    assert_null(here->made);
    here->made = made;
    return input_start(made, err);
}

mrt_result live_remove_input(live *self, uint32_t index, error *err)
{
    (void)self;
    (void)err;
    assert_int_equal(index, 0);
    input_destroy(here->made);
    here->made = NULL;
    return MRT_OK;
}

mrt_result live_record_end(live *self, error *err)
{
    (void)self;
    (void)err;
    return MRT_OK;
}

/* ---- the face ---- */

/* Published as a stage does. */
static void publish(viewport_stand *s)
{
    const live_view *filled = live_board_fill(&s->board, s->composer, 0);
    s->view.position = filled->position;
    s->view.normal = filled->normal;
    s->view.changed = filled->changed;
    live_board_publish(&s->board);
}

void stand_perform(viewport_stand *s)
{
    live_view *view = &s->view;
    const composer_part part = {
        .layer = 0, .is_fresh = true, .weight = 1.0, .gain = 1.0, .pull = &view->pull};
    composer_move(s->composer, &part, 1, 0.0);
    composer_draw(s->composer);
    publish(s);
    face *f = composer_face(s->composer);
    view->number += 1;
    for (uint32_t i = 0; i < view->contact_count; ++i)
        view->contact[i] = face_contact_now(f, i + 1);
    bones_pose(view->bone, face_bones(f), face_metered(f)->dof);
    view->meter = *face_metered(f);
    view->penetration_mm = view->meter.penetration_mm;
}

uint32_t stand_contact(const viewport_stand *s, const char *name)
{
    uint32_t found = rig_find_contact(s->file.rig, name);
    assert_true(found != RIG_NONE);
    return found;
}

void stand_pull(viewport_stand *s, const char *contact, float x, float y, float z)
{
    uint32_t index = stand_contact(s, contact);
    const mrt_vec3 rest = s->view.about->contacts[index].rest;
    assert_true(s->view.pull.count < MRT_MAX_VECTORS);
    s->view.pull.vector[s->view.pull.count++] =
        (mrt_vector){rest, {rest.x + x, rest.y + y, rest.z + z}, index + 1};
    s->view.pull.anchor += 1;
    stand_perform(s);
}

static void open_face(viewport_stand *s, const char *face_path)
{
    char path[1024];
    error err = {{0}};
    snprintf(path, sizeof path, "%s/%s", SOURCE_DIR, face_path);
    if (face_file_read(&s->file, path, NULL, FACE_FILE_USABLE, &err) < 0)
        fail_msg("%s", err.text);
    const csrbf_settings solver = {.kernel = CSRBF_WENDLAND_C2};
    if (composer_create(&s->composer, &s->file, &solver, &err) < 0)
        fail_msg("%s", err.text);
    if (live_board_create(&s->board, s->composer, &err) < 0)
        fail_msg("%s", err.text);
    s->view = (live_view){.number = 1,
                          .vertex_count = s->file.mesh.vertex_count,
                          .about = composer_about(s->composer),
                          .is_anchored = true,
                          .solver = composer_solver(s->composer)};
    s->view.contact_count = s->view.about->contact_count;
    s->view.pull.mode = MRT_ANCHORED;
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        s->view.pull.dof[i] = NAN;
    stand_perform(s);
}

/* ---- opened and closed ---- */

static void open_screen(viewport_stand *s, uint32_t width, uint32_t height, float scale,
                        double dt_s)
{
    error err = {{0}};
    if (window_open_hidden(&s->window, width, height, scale, dt_s, &err) < 0) {
        print_message("SKIPPED: %s\n", err.text);
        skip();
    }
    if (ui_create(&s->ui, &err) < 0)
        fail_msg("%s", err.text);
    s->where = (ui_rectangle){0, 0, (float)width / scale, (float)height / scale};
}

static void create_viewport(viewport_stand *s)
{
    error err = {{0}};
    s->viewport = viewport_create(a_studio, &err);
    if (!s->viewport)
        fail_msg("%s", err.text);
    s->is_drawn = true;
    stand_frames(s, 3);
}

static void open_all(viewport_stand *s, const char *face_path, uint32_t width, uint32_t height,
                     float scale, double dt_s)
{
    error err = {{0}};
    char note[256];
    memset(s, 0, sizeof *s);
    here = s;
    open_screen(s, width, height, scale, dt_s);
    s->is_away = true;
    window_hidden_put_away(s->window, true);
    s->log = log_queue_create();
    s->news = news_list_create();
    assert_true(s->log && s->news);
    assert_int_equal(settings_open(&s->settings, "", note, sizeof note, &err), MRT_OK);
    open_face(s, face_path);
    create_viewport(s);
}

void stand_open(viewport_stand *s, const char *face_path, uint32_t width, uint32_t height,
                float scale)
{
    open_all(s, face_path, width, height, scale, 1.0 / 60.0);
}

void stand_open_slow(viewport_stand *s, const char *face_path, uint32_t width, uint32_t height,
                     float scale, double dt_s)
{
    open_all(s, face_path, width, height, scale, dt_s);
}

void stand_reopen(viewport_stand *s)
{
    viewport_destroy(s->viewport);
    create_viewport(s);
}

void stand_close(viewport_stand *s)
{
    viewport_destroy(s->viewport);
    assert_null(s->made);
    ui_destroy(s->ui);
    window_close(s->window);
    settings_close(s->settings);
    news_list_destroy(s->news);
    log_queue_destroy(s->log);
    live_board_destroy(&s->board);
    composer_destroy(s->composer);
    face_file_destroy(&s->file);
    here = NULL;
}

/* ---- frames and events ---- */

void stand_frame(viewport_stand *s)
{
    ui_screen screen;
    assert_true(window_begin(s->window, s->ui, &screen));
    ui_begin(s->ui, &screen);
    viewport_update(s->viewport, s->ui, s->has_pad ? &s->pad : NULL, screen.dt_s);
    if (s->is_drawn)
        viewport_draw(s->viewport, s->ui, s->where, screen.scale);
    ui_end(s->ui);
    window_end(s->window, s->ui);
}

void stand_frames(viewport_stand *s, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        stand_frame(s);
}

static void push(viewport_stand *s, ui_event event)
{
    ui_push(s->ui, &event);
    for (int i = 0; i < 8 && (i == 0 || !ui_is_idle(s->ui)); ++i)
        stand_frame(s);
}

void stand_move(viewport_stand *s, float x, float y)
{
    push(s, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

void stand_button(viewport_stand *s, uint32_t button, bool is_down)
{
    push(s, (ui_event){.kind = UI_EVENT_BUTTON, .code = button, .is_down = is_down});
}

void stand_wheel(viewport_stand *s, float notches)
{
    push(s, (ui_event){.kind = UI_EVENT_WHEEL, .y = notches});
}

void stand_key(viewport_stand *s, uint32_t key, bool is_down)
{
    push(s, (ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = is_down});
}

void stand_drag(viewport_stand *s, uint32_t button, float x0, float y0, float x1, float y1)
{
    enum { STEPS = 5 };
    stand_move(s, x0, y0);
    stand_button(s, button, true);
    for (int i = 1; i <= STEPS; ++i)
        stand_move(s, x0 + (x1 - x0) * (float)i / STEPS, y0 + (y1 - y0) * (float)i / STEPS);
    stand_button(s, button, false);
}

void stand_place(const viewport_stand *s, const float at[3], float *out_x, float *out_y)
{
    float low[3], high[3], px[2];
    mesh_bounds(&s->file.mesh, low, high);
    draw_camera camera = draw_camera_framing(low, high, s->where.width / s->where.height);
    const uint32_t rectangle[4] = {0, 0, (uint32_t)s->where.width, (uint32_t)s->where.height};
    assert_true(draw_project(px, &camera, rectangle, at));
    *out_x = s->where.x + (s->looks.is_mirrored ? s->where.width - px[0] : px[0]);
    *out_y = s->where.y + px[1];
}

void stand_show(viewport_stand *s)
{
    s->is_away = false;
    window_hidden_put_away(s->window, false);
}

void stand_picture(viewport_stand *s, const char *name)
{
    error err = {{0}};
    char path[1024];
    stand_frames(s, 1);
    if (!getenv("MAROTTE_PICTURES"))
        return;
    window_hidden_put_away(s->window, false);
    stand_frames(s, 1);
    window_hidden_put_away(s->window, s->is_away);
    snprintf(path, sizeof path, "%s/out", BUILD_DIR);
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    if (window_picture(s->window, path, &err) < 0)
        fail_msg("%s", err.text);
}
