/* What an empty stage offers, and whatever there is opened: by the dialog, by what was opened
 * lately, by a file that is dropped. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "window/open_any.h"
#include "scene.h"
#include "unit/closed_moai.h"

#include <math.h>
#include <time.h>
#include <unistd.h>
#include <utime.h>

static scene s;

static const char *newest(void)
{
    const news_list *news = app_news(s.app);
    const uint32_t count = news_list_count(news);
    return count ? news_list_at(news, count - 1)->text : "";
}

static bool has_hand(scene *of, void *data)
{
    (void)data;
    return live_input_count(app_live(of->app)) > 0;
}

/* ---- the first minute ---- */

static float y_of(const char *text)
{
    const ui_word *word = scene_word(&s, text);
    if (!word)
        fail_msg("\"%s\" is not offered", text);
    return word ? word->where.y : 0.0f;
}

static void an_empty_stage_offers_four_ways_in_this_order(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_true(y_of("Camera (13 MB)") < y_of("Keyboard hand"));
    assert_true(y_of("Keyboard hand") < y_of("Try a demo hand"));
    assert_true(y_of("Try a demo hand") < y_of("Mouse"));
    const float beside_head = 0.18f * s.height; /* of the middle of the face's picture */
    const float middle = 0.5f * (s.width - app_looks_of(s.app)->layouts.now.width[PLACE_RIGHT]);
    const ui_word *widest = scene_word(&s, "Try a demo hand");
    assert_true(widest && widest->where.x + widest->where.width < middle - beside_head);
    scene_look(&s, "opens_offers");
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_click_word(&s, "Keyboard hand");
    assert_true(app_has_hand_keys(s.app));
    assert_null(scene_word(&s, "Try a demo hand"));
    scene_close(&s);
}

static void a_click_brings_a_demo_hand_that_performs(void **state)
{
    (void)state;
    scene_open(&s, 800, 500, 1.0f);
    scene_look(&s, "opens_offers_small");
    scene_let_cut(&s, "No takes yet");
    scene_let_cut(&s, "night");
    scene_let_cut(&s, "puppet");
    scene_check_words(&s);
    scene_click_word(&s, "Try a demo hand");
    assert_true(scene_until(&s, has_hand, NULL));
    assert_null(scene_word(&s, "Try a demo hand"));
    scene_close(&s);
}

static void a_click_on_the_mouse_or_a_drag_clears_the_way(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_click_word(&s, "Mouse");
    assert_null(scene_word(&s, "Try a demo hand"));
    assert_non_null(strstr(newest(), "Shift"));
    scene_close(&s);
    scene_open(&s, 1280, 720, 1.0f);
    assert_non_null(scene_word(&s, "Try a demo hand"));
    scene_drag(&s, 440.0f, 260.0f, 460.0f, 285.0f, 8);
    assert_null(scene_word(&s, "Try a demo hand"));
    scene_close(&s);
}

/* ---- one Open ---- */

static void the_first_field_has_the_focus_enter_opens_and_esc_cancels(void **state)
{
    char path[512];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_OPEN);
    scene_look(&s, "opens_dialog");
    scene_type(&s, "nothing");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(ui_has_dialog(s.ui));
    scene_do(&s, ACTION_OPEN);
    scene_face_path(path, "moai");
    scene_type(&s, path);
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_false(ui_has_dialog(s.ui));
    assert_string_equal(app_face_path(s.app), path);
    scene_do(&s, ACTION_OPEN);
    assert_non_null(scene_word(&s, "Lately"));
    const ui_word *recent = scene_word_with(&s, "moai.rig.json   in");
    assert_non_null(recent);
    scene_look(&s, "opens_lately");
    scene_type(&s, "another");
    scene_key(&s, UI_KEY_ENTER, 0); /* a new name makes a show */
    assert_false(ui_has_dialog(s.ui));
    assert_non_null(strstr(show_path(app_show(s.app)), "another.marotte"));
    scene_close(&s);
}

static bool says_trouble(scene *of, void *data)
{
    (void)data;
    return app_opening_trouble(of->app)[0] != '\0';
}

static void a_broken_file_is_not_among_the_recent(void **state)
{
    static const char nothing[] = "time_s,nonsense\nx,y\n";
    const char *recent[OPEN_RECENT_MAX];
    char path[512];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    (void)snprintf(path, sizeof path, "%s/broken.csv", s.folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(nothing, file) >= 0);
    assert_int_equal(fclose(file), 0);
    window_drop(s.window, path);
    assert_true(scene_until(&s, says_trouble, NULL));
    assert_int_equal(open_recent(app_settings(s.app), recent), 0);
    scene_close(&s);
}

static void the_field_keeps_the_focus_in_a_folder_and_after_what_cannot_be_opened(void **state)
{
    char path[512], folder[512];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_face_path(path, "moai");
    (void)snprintf(folder, sizeof folder, "%s", path);
    char *name = strrchr(folder, '/');
    *name++ = '\0';
    scene_do(&s, ACTION_OPEN);
    scene_type(&s, folder);
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_true(ui_has_dialog(s.ui));
    scene_type(&s, "none.glb");
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_non_null(scene_word_with(&s, "does not exist"));
    scene_type(&s, name);
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_false(ui_has_dialog(s.ui));
    assert_string_equal(app_face_path(s.app), path);
    scene_close(&s);
}

static void the_list_says_how_large_a_file_is_and_when_it_was_changed(void **state)
{
    static const char names[][128] = {
        "head.glb",
        "a head whose name is as long as those that people give to what they download from "
        "somewhere, version 2 final.glb"};
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    struct tm when = {.tm_year = 126, .tm_mon = 2, .tm_mday = 4, .tm_hour = 15, .tm_isdst = -1};
    const time_t changed_s = mktime(&when);
    const struct utimbuf times = {changed_s, changed_s};
    for (size_t i = 0; i < 2; ++i) {
        char path[512];
        (void)snprintf(path, sizeof path, "%s/%s", s.folder, names[i]);
        FILE *file = fopen(path, "w");
        assert_non_null(file);
        assert_int_equal(ftruncate(fileno(file), i ? 900 : 2400000), 0);
        (void)fclose(file);
        assert_int_equal(utime(path, &times), 0);
    }
    scene_do(&s, ACTION_OPEN);
    scene_type(&s, s.folder);
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_look(&s, "opens_sizes");
    assert_non_null(scene_word(&s, "2.4 MB"));
    assert_non_null(scene_word(&s, "1 KB"));
    assert_non_null(scene_word(&s, "2026-03-04 15:00"));
    assert_int_equal(scene_word_faults(&s), 1); /* of the long name, which a hint tells whole */
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_close(&s);
}

static bool performs(scene *of, void *data)
{
    (void)data;
    return live_mapping(app_live(of->app)) != NULL;
}

static bool rests(scene *of, void *data)
{
    (void)data;
    return !live_mapping(app_live(of->app));
}

/* A head as people download it: the mapping that needs a rig rests, and performs after one click.
 */
static void a_mesh_without_a_rig_performs_after_one_click(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_true(performs(&s, NULL));
    assert_true(app_open_face(s.app, SOURCE_DIR "/rigs/moai/moai.glb") >= 0);
    scene_frames(&s, 5);
    assert_true(rests(&s, NULL));
    scene_look(&s, "opens_without_rig");
    assert_non_null(scene_word(&s, "moai.glb has no rig yet"));
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, performs, NULL));
    assert_non_null(app_face(s.app)->rig);
    assert_null(scene_word(&s, "moai.glb has no rig yet"));
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, rests, NULL));
    assert_null(app_face(s.app)->rig);
    scene_do(&s, ACTION_REDO);
    assert_true(scene_until(&s, performs, NULL));
    scene_close(&s);
}

static bool has_drafted(scene *of, void *data)
{
    (void)data;
    return !app_notes_of(of->app)->is_drafting && app_face(of->app)->rig;
}

/* What this process has worked: however busy the machine is, waiting for a draft is all the work of
 * the draft. */
static double worked_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double frame_s(void)
{
    const double before_s = worked_s();
    scene_frames(&s, 1);
    return worked_s() - before_s;
}

/* A draft takes seconds: whoever opens another face meanwhile does not wait for it. */
static void a_draft_that_is_left_holds_nothing_up(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_true(app_open_face(s.app, SOURCE_DIR "/rigs/puppet/puppet.glb") >= 0);
    scene_frames(&s, 5);
    const double before_s = worked_s();
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, has_drafted, NULL));
    const double draft_s = worked_s() - before_s;
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, rests, NULL));
    scene_frames(&s, 30);
    scene_click_word(&s, "Draft a rig");
    while (!app_notes_of(s.app)->is_drafting)
        scene_frames(&s, 1);
    assert_true(app_open_face(s.app, SOURCE_DIR "/rigs/moai/moai.rig.json") >= 0);
    const double left_s = frame_s(); /* the rig panel's, which lets the draft go */
    print_message("a draft takes %.2f s, leaving it %.2f s\n", draft_s, left_s);
    assert_false(app_notes_of(s.app)->is_drafting);
    assert_true(left_s < 0.5 * draft_s);
    scene_close(&s);
}

/* A head whose up is z and that is 2.2 units high, which is no head's height in any unit. */
static void write_upright(const mesh *m, const char *path)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    const double unit = 2.2 / (double)(high[1] - low[1]);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        const float *p = m->position + (size_t)3 * v;
        (void)fprintf(file, "v %.7f %.7f %.7f\n", unit * (double)p[0], -unit * (double)p[2],
                      unit * (double)p[1]);
    }
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        const uint32_t *corner = m->triangle + (size_t)3 * t;
        (void)fprintf(file, "f %u %u %u\n", corner[0] + 1, corner[1] + 1, corner[2] + 1);
    }
    assert_int_equal(fclose(file), 0);
}

/* A ball has no nose and no mouth: the stage says that it guessed where the face is. */
static void a_face_that_was_guessed_is_called_unsure(void **state)
{
    enum { AROUND = 24, ROWS = 13 };
    const double pi = 3.14159265358979323846;
    char path[200];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    (void)snprintf(path, sizeof path, "%s/ball.obj", s.folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    for (int row = 0; row < ROWS; ++row)
        for (int i = 0; i < AROUND; ++i) {
            const double a = 2.0 * pi * i / AROUND, b = pi * ((row + 0.5) / ROWS - 0.5);
            (void)fprintf(file, "v %.3f %.3f %.3f\n", 110.0 * cos(b) * sin(a), 110.0 * sin(b),
                          110.0 * cos(b) * cos(a));
        }
    for (int row = 0; row + 1 < ROWS; ++row)
        for (int i = 0; i < AROUND; ++i) {
            const int at = 1 + row * AROUND, next = (i + 1) % AROUND;
            (void)fprintf(file, "f %d %d %d %d\n", at + i, at + next, at + next + AROUND,
                          at + i + AROUND);
        }
    assert_int_equal(fclose(file), 0);
    assert_true(app_open_face(s.app, path) >= 0);
    scene_frames(&s, 5);
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, has_drafted, NULL));
    assert_non_null(strstr(newest(), "its face is unsure"));
    scene_close(&s);
}

static bool has_saved(scene *of, void *data)
{
    (void)of;
    return access(data, R_OK) == 0;
}

/* What the stage drafts and saves is the same face when it is opened again, with its poses. */
static void a_drafted_rig_is_read_again_as_it_was_drafted(void **state)
{
    char path[200], saved[200];
    float low[3], high[3], again_low[3], again_high[3];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_true(app_open_face(s.app, SOURCE_DIR "/rigs/puppet/puppet.glb") >= 0);
    (void)snprintf(path, sizeof path, "%s/upright.obj", s.folder);
    (void)snprintf(saved, sizeof saved, "%s/upright.rig.json", s.folder);
    write_upright(&app_face(s.app)->mesh, path);
    assert_true(app_open_face(s.app, path) >= 0);
    scene_frames(&s, 5);
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_look(&s, "opens_unit");
    assert_non_null(scene_word_with(&s, " mm high. Its unit:"));
    assert_int_equal(app_face(s.app)->mesh.up, MESH_AXIS_Z); /* as it was seen to be */
    assert_int_equal(app_face(s.app)->mesh.forward, MESH_AXIS_MINUS_Y);
    for (int tip = 0; tip < 4; ++tip) {
        scene_click_word(&s, "Tip it up");
        scene_frames(&s, 5);
        assert_int_equal(app_face(s.app)->mesh.up == MESH_AXIS_Z, tip == 3);
    }
    assert_int_equal(app_face(s.app)->mesh.forward, MESH_AXIS_MINUS_Y);
    scene_look(&s, "opens_tipped");
    for (int quarter = 0; quarter < 4; ++quarter) {
        scene_click_word(&s, "Turn it");
        scene_frames(&s, 5);
        assert_int_equal(app_face(s.app)->mesh.forward == MESH_AXIS_MINUS_Y, quarter == 3);
    }
    scene_click_word(&s, "cm");
    scene_frames(&s, 5);
    assert_int_equal(app_face(s.app)->mesh.up, MESH_AXIS_Z);
    mesh_bounds(&app_face(s.app)->mesh, low, high);
    assert_float_equal(high[1] - low[1], 22.0f, 0.01f);
    assert_non_null(scene_word(&s, "22 mm high. Its unit:"));
    assert_true(app_open_face(s.app, path) >= 0);
    scene_frames(&s, 5);
    mesh_bounds(&app_face(s.app)->mesh, low, high);
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, performs, NULL));
    const uint32_t poses = app_face(s.app)->rig->pose_count;
    assert_true(poses > 10);
    scene_do(&s, ACTION_PANEL_RIG);
    scene_frames(&s, 10);
    scene_click_word(&s, "Save");
    assert_true(scene_until(&s, has_saved, saved));
    assert_true(app_open_face(s.app, saved) >= 0);
    mesh_bounds(&app_face(s.app)->mesh, again_low, again_high);
    for (int k = 0; k < 3; ++k) {
        assert_float_equal(again_low[k], low[k], 1e-3f);
        assert_float_equal(again_high[k], high[k], 1e-3f);
    }
    assert_int_equal(app_face(s.app)->rig->pose_count, poses);
    scene_close(&s);
}

static bool asks_mouth(scene *of, void *data)
{
    (void)data;
    return !app_notes_of(of->app)->is_drafting && scene_word(of, "The lips are joined.");
}

static bool has_cut(scene *of, void *data)
{
    (void)data;
    return app_face(of->app)->rig && app_face(of->app)->rig->cut_mouth;
}

static bool is_clay(scene *of, void *data)
{
    (void)data;
    return app_face(of->app)->rig && !app_face(of->app)->rig->cut_mouth;
}

static double jaw_opens_rad(void)
{
    const rig *r = app_face(s.app)->rig;
    return r->bone[rig_find_bone(r, "jaw")].open_max_rad;
}

/* Whoever drafts a head whose lips are one surface is asked; the answer is one step of undo, with
 * the rig's tabs open too, and the face that was saved is the one that was cut. */
static void a_mouth_is_cut_where_a_head_has_none(void **state)
{
    char path[200], saved[200];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    (void)snprintf(path, sizeof path, "%s/closed.obj", s.folder);
    (void)snprintf(saved, sizeof saved, "%s/closed.rig.json", s.folder);
    write_closed_moai(path);
    assert_true(app_open_face(s.app, path) >= 0);
    scene_frames(&s, 5);
    const uint32_t whole = app_face(s.app)->mesh.vertex_count;
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, asks_mouth, NULL));
    assert_true(scene_until(&s, performs, NULL));
    assert_true(jaw_opens_rad() < 0.2);
    scene_look(&s, "opens_no_mouth");
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    scene_click_word(&s, "Perform as clay");
    scene_frames(&s, 3);
    assert_null(scene_word(&s, "Cut the mouth"));
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, rests, NULL));
    scene_frames(&s, 30);
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, asks_mouth, NULL));
    scene_click_word(&s, "Cut the mouth");
    assert_true(scene_until(&s, has_cut, NULL));
    const uint32_t cut = app_face(s.app)->mesh.vertex_count;
    assert_true(cut > whole);
    assert_true(jaw_opens_rad() > 0.2);
    assert_true(scene_until(&s, performs, NULL));
    assert_null(scene_word(&s, "Cut the mouth"));
    scene_do(&s, ACTION_PANEL_RIG);
    scene_frames(&s, 10);
    scene_click_word(&s, "Jaw"); /* which shows the face opened */
    scene_frames(&s, 10);
    scene_look(&s, "opens_mouth_cut");
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, is_clay, NULL));
    assert_int_equal(app_face(s.app)->mesh.vertex_count, whole);
    const ui_word *tab = scene_word_with(&s, "Check");
    assert_non_null(tab);
    scene_click(&s, tab->where.x + 0.5f * tab->where.width,
                tab->where.y + 0.5f * tab->where.height);
    scene_frames(&s, 10);
    scene_look(&s, "opens_mouth_asked_in_rig");
    assert_non_null(scene_word(&s, "Cut the mouth")); /* it is asked in Rig too */
    scene_click_word(&s, "Jaw");
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, rests, NULL));
    scene_do(&s, ACTION_REDO);
    scene_do(&s, ACTION_REDO);
    assert_true(scene_until(&s, has_cut, NULL));
    assert_int_equal(app_face(s.app)->mesh.vertex_count, cut);
    scene_click_word(&s, "Save");
    assert_true(scene_until(&s, has_saved, saved));
    assert_true(app_open_face(s.app, saved) >= 0);
    scene_frames(&s, 5);
    assert_int_equal(app_face(s.app)->mesh.vertex_count, cut);
    assert_true(performs(&s, NULL));
    scene_close(&s);
}

/* Its head is what is looked at, and how high a head is, not the body below it. */
static void a_head_on_a_body_is_looked_at(void **state)
{
    char avatar[512];
    const char *shared = getenv("MAROTTE_SHARED");
    (void)state;
    (void)snprintf(avatar, sizeof avatar, "%s/data/heads/rpm_arkit.glb",
                   shared ? shared : SOURCE_DIR "/../shared");
    if (access(avatar, R_OK) != 0) {
        print_message("SKIPPED: no %s\n", avatar);
        skip();
    }
    scene_open(&s, 1280, 720, 1.0f);
    assert_true(app_open_face(s.app, avatar) >= 0);
    scene_frames(&s, 5);
    scene_click_word(&s, "Draft a rig");
    assert_true(scene_until(&s, performs, NULL));
    assert_true(app_face(s.app)->mesh.has_focus);
    scene_look(&s, "opens_head_on_a_body");
    scene_click_word(&s, "Rig");
    scene_frames(&s, 30);
    assert_null(scene_word_with(&s, "check the unit"));
    scene_close(&s);
}

static void put(char out[160], const char *name, const char *bytes)
{
    error err = {0};
    (void)snprintf(out, 160, "%s/%s", s.folder, name);
    assert_int_equal(file_write(out, bytes, strlen(bytes), &err), MRT_OK);
}

static void drop(const char *path)
{
    window_drop(s.window, path);
    scene_frames(&s, 3);
}

static void whatever_is_dropped_is_opened_as_what_it_is(void **state)
{
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    char path[512], file[160];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_face_path(path, "moai");
    drop(path);
    assert_string_equal(app_face_path(s.app), path);
    (void)snprintf(path, sizeof path, "%s/other.marotte", s.folder);
    drop(path); /* there is none: a show of that name is made */
    assert_string_equal(show_path(app_show(s.app)), path);
    put(file, "voice.WAV", "RIFF");
    drop(file);
    assert_non_null(strstr(newest(), "select the take"));
    put(file, "letter", "Dear Sir,");
    drop(file);
    assert_non_null(strstr(newest(), "is not a show, face, recorded hand, sound or picture"));
    drop(s.folder);
    assert_true(ui_has_dialog(s.ui));
    assert_non_null(scene_word(&s, "other.marotte"));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    put(file, "corner.obj", obj);
    drop(file);
    assert_true(strcmp(app_face_path(s.app), file) == 0 || newest()[0]);
    put(file, "hand", "time_s,right.index.mpj\nunit,deg\n0,10\n0.01,11\n0.02,12\n");
    drop(file); /* its name says nothing: it is looked into */
    assert_true(scene_until(&s, has_hand, NULL));
    scene_close(&s);
}

static void what_a_file_is_is_decided_by_its_end_then_by_its_beginning(void **state)
{
    static const struct {
        const char *name;
        open_kind kind;
    } all[] = {{"/a/night.marotte", OPEN_SHOW}, {"/a/Puppet.RIG.JSON", OPEN_FACE},
               {"/a/x.vrm", OPEN_FACE},         {"/a/hand.csv", OPEN_HANDS},
               {"/a/line.flac", OPEN_VOICE},    {"/a/wall.JPG", OPEN_PICTURE},
               {"/a/notes.json", OPEN_ANY},     {"/a/none", OPEN_ANY}};
    (void)state;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; ++i)
        assert_int_equal(open_kind_of(all[i].name), all[i].kind);
}

/* ---- save as ---- */

static const char *const demo_hand[] = {"log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1"};

static bool has_recorded(scene *of, void *data)
{
    (void)data;
    return app_status(of->app)->recorded_ns > NS_PER_S / 3;
}

static bool has_takes(scene *of, void *data)
{
    const app_take_line *line;
    const uint32_t count = app_takes(of->app, &line);
    return count == *(const uint32_t *)data && !app_status(of->app)->is_recording &&
           !line[count - 1].is_recording && app_take_id(of->app) == line[count - 1].id;
}

static void record_take(uint32_t then)
{
    scene_key(&s, 'R', 0);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_key(&s, 'R', 0);
    assert_true(scene_until(&s, has_takes, &then));
}

static bool is_show_open(scene *of, void *path)
{
    return strcmp(show_path(app_show(of->app)), path) == 0;
}

static size_t count_takes_of(const char *path)
{
    show *read = NULL;
    show_take *row = NULL;
    size_t count = 0;
    error err = {0};
    if (show_open(&read, path, SHOW_READ, &err) < 0 || show_takes(read, &row, &count, &err) < 0)
        fail_msg("%s", err.text);
    free(row);
    show_close(read);
    return count;
}

static bool says_nowhere(scene *of, void *data)
{
    (void)of;
    (void)data;
    return strstr(newest(), "/nowhere/at/all") != NULL;
}

static void type_path(const char *path)
{
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT);
    assert_true(ui_has_dialog(s.ui));
    scene_key(&s, 'A', UI_CONTROL);
    scene_type(&s, path);
    scene_key(&s, UI_KEY_ENTER, 0);
}

static void a_show_goes_on_under_another_name(void **state)
{
    char before[128], path[128];
    uint32_t one = 1;
    (void)state;
    const scene_options with = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = demo_hand, .input_count = 1};
    scene_open_with(&s, &with);
    assert_true(scene_until(&s, has_hand, NULL));
    record_take(1);
    const int64_t id = app_take_id(s.app);
    assert_true(id != 0);
    (void)snprintf(before, sizeof before, "%s", show_path(app_show(s.app)));
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT);
    (void)snprintf(path, sizeof path, "%s/night 2.marotte", s.folder);
    assert_non_null(scene_word(&s, path));
    scene_look(&s, "opens_save_as");
    scene_let_cut(&s, "demo_hand");
    scene_check_words(&s);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_int_not_equal(access(path, F_OK), 0);
    type_path("evening"); /* beside the old one, with its ending */
    assert_false(ui_has_dialog(s.ui));
    (void)snprintf(path, sizeof path, "%s/evening.marotte", s.folder);
    assert_true(scene_until(&s, is_show_open, path));
    assert_true(scene_until(&s, has_takes, &one));
    assert_int_equal(app_take_id(s.app), id);
    scene_key(&s, 'L', 0);
    record_take(2);
    assert_int_equal(count_takes_of(path), 2);
    assert_int_equal(count_takes_of(before), 1);

    type_path(before); /* a show is never written over */
    assert_true(ui_has_dialog(s.ui));
    assert_non_null(scene_word_with(&s, "already exists"));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    type_path("/nowhere/at/all.marotte"); /* what fails is said, and the old one goes on */
    assert_true(scene_until(&s, says_nowhere, NULL));
    assert_string_equal(show_path(app_show(s.app)), path);
    scene_key(&s, 'L', 0);
    scene_key(&s, 'R', 0);
    assert_true(scene_until(&s, has_recorded, NULL));
    type_path("late"); /* not in the middle of a take */
    assert_non_null(scene_word_with(&s, "stop it first"));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_file_is_is_decided_by_its_end_then_by_its_beginning),
        cmocka_unit_test(an_empty_stage_offers_four_ways_in_this_order),
        cmocka_unit_test(a_click_brings_a_demo_hand_that_performs),
        cmocka_unit_test(a_click_on_the_mouse_or_a_drag_clears_the_way),
        cmocka_unit_test(the_first_field_has_the_focus_enter_opens_and_esc_cancels),
        cmocka_unit_test(a_broken_file_is_not_among_the_recent),
        cmocka_unit_test(the_field_keeps_the_focus_in_a_folder_and_after_what_cannot_be_opened),
        cmocka_unit_test(the_list_says_how_large_a_file_is_and_when_it_was_changed),
        cmocka_unit_test(a_mesh_without_a_rig_performs_after_one_click),
        cmocka_unit_test(a_draft_that_is_left_holds_nothing_up),
        cmocka_unit_test(a_drafted_rig_is_read_again_as_it_was_drafted),
        cmocka_unit_test(a_mouth_is_cut_where_a_head_has_none),
        cmocka_unit_test(a_face_that_was_guessed_is_called_unsure),
        cmocka_unit_test(a_head_on_a_body_is_looked_at),
        cmocka_unit_test(whatever_is_dropped_is_opened_as_what_it_is),
        cmocka_unit_test(a_show_goes_on_under_another_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
