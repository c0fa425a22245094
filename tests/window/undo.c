/* Hundreds of things that somebody does in the window, drawn by lot: takes, the rig, parameters,
 * the patch, pulls and clay, the voice, the light. All of them are undone, and everything is as it
 * was, bit for bit; all are done again, and it is as it was left. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"
#include "base/file.h"
#include "show/edit.h"
#include "window/app/kept_scenery.h"
#include "window/open_any.h"

static scene s;

/* ---- by lot ---- */

static uint64_t lot;

static uint32_t draw_lot(uint32_t below)
{
    lot = lot * 6364136223846793005u + 1442695040888963407u; /* Knuth's MMIX */
    return (uint32_t)(lot >> 33) % below;
}

static double draw_real(double least, double most)
{
    return least + (most - least) * (double)draw_lot(1 << 20) / (double)(1 << 20);
}

/* ---- all that a person can have changed, in words ---- */

typedef struct words {
    char *text;
    size_t size;
    FILE *file;
} words;

static void say_numbers(FILE *out, const char *name, const double *value, uint32_t count)
{
    (void)fprintf(out, "%s", name);
    for (uint32_t i = 0; i < count; ++i)
        (void)fprintf(out, " %a", value[i]);
    (void)fprintf(out, "\n");
}

static void say_clip(FILE *out, const take_clip *c)
{
    (void)fprintf(out, "  clip %u of %lld: %lld %lld at %lld %lld, fades %lld %lld, %d\n", c->id,
                  (long long)c->performance, (long long)c->from_ns, (long long)c->to_ns,
                  (long long)c->start_ns, (long long)c->end_ns, (long long)c->fade_in_ns,
                  (long long)c->fade_out_ns, c->is_muted);
    say_numbers(out, "  gain, smooth", (const double[]){c->gain, c->smooth_s}, 2);
    for (uint32_t i = 0; i < c->warp_count; ++i)
        (void)fprintf(out, "  %lld from %lld\n", (long long)c->warp[i].at_ns,
                      (long long)c->warp[i].source_ns);
}

static void say_take(FILE *out, const take *t)
{
    (void)fprintf(out, "take %lld \"%s\" \"%s\" %s/%s %u, %u stars, %lld ns, sound %lld at %lld\n",
                  (long long)t->id, t->name, t->note, t->scene, t->shot, t->number, t->rating,
                  (long long)t->duration_ns, (long long)t->audio.audio,
                  (long long)t->audio.offset_ns);
    say_numbers(out, " fps, gain of sound", (const double[]){t->fps, t->audio.gain}, 2);
    for (uint32_t i = 0; i < t->marker_count; ++i)
        (void)fprintf(out, " mark %lld \"%s\"\n", (long long)t->marker[i].at_ns, t->marker[i].text);
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        const take_layer *l = &t->layer[i];
        (void)fprintf(out, " layer %u \"%s\" %d %d %d at %lld\n", l->id, l->name, l->is_muted,
                      l->is_solo, l->is_additive, (long long)l->offset_ns);
        say_numbers(out, " gain", &l->gain, 1);
        for (uint32_t k = 0; k < l->clip_count; ++k)
            say_clip(out, &l->clip[k]);
    }
}

static void say_takes(FILE *out)
{
    const app_take_line *line;
    int64_t id[256];
    uint32_t count = app_takes(s.app, &line), kept = 0;
    for (uint32_t i = 0; i < count && kept < 256; ++i)
        if (!line[i].is_deleted)
            id[kept++] = line[i].id;
    for (uint32_t i = 0; i < kept; ++i) {
        assert_true(app_select_take(s.app, id[i]) >= 0);
        say_take(out, app_take(s.app));
    }
}

static void say_rig(FILE *out)
{
    error err = {0};
    char path[128];
    file_bytes bytes;
    (void)snprintf(path, sizeof path, "%s/now.rig.json", s.folder);
    if (rig_write(app_face(s.app)->rig, path, &err) < 0 ||
        file_read(&bytes, path, 1 << 24, &err) < 0)
        fail_msg("%s", err.text);
    (void)fwrite(bytes.data, 1, bytes.size, out);
    file_bytes_finish(&bytes);
    (void)unlink(path);
}

static bool is_rig_laid(scene *of, void *data)
{
    (void)data;
    return !app_notes_of(of->app)->is_rig_pending;
}

static words say_all(void)
{
    words out = {.text = NULL};
    scene_stillness still = {0};
    assert_true(scene_until(&s, is_rig_laid, NULL));
    scene_do(&s, ACTION_LIVE);
    assert_true(scene_until(&s, scene_is_still, &still));
    out.file = open_memstream(&out.text, &out.size);
    assert_non_null(out.file);
    const live_view *view = app_view(s.app);
    for (uint32_t i = 0; i < view->vertex_count; ++i)
        (void)fprintf(out.file, "%a %a %a\n", (double)view->position[3 * i],
                      (double)view->position[3 * i + 1], (double)view->position[3 * i + 2]);
    (void)fprintf(out.file, "held %d\n", app_is_held(s.app));
    const instance *mapping = live_mapping(app_live(s.app));
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const double value = instance_value(mapping, i);
        say_numbers(out.file, mapping->type->params[i].name, &value, 1);
    }
    const patch *p = app_patch(s.app);
    for (uint32_t i = 0; i < p->count; ++i) {
        char text[EDIT_TEXT];
        patch_connection_describe(&p->connection[i], text, sizeof text);
        (void)fprintf(out.file, "patch %s\n", text);
    }
    const scenery *scene_now = kept_scenery_now(app_scenery(s.app));
    for (size_t i = 0; i < sizeof *scene_now; ++i)
        (void)fprintf(out.file, "%02x", ((const unsigned char *)scene_now)[i]);
    (void)fprintf(out.file, "\n");
    say_rig(out.file);
    say_takes(out.file);
    (void)fclose(out.file);
    return out;
}

static void expect_all(const words *wanted, const char *when)
{
    const words now = say_all();
    const char *a = wanted->text, *b = now.text;
    while (*a && *a == *b) {
        ++a;
        ++b;
    }
    if (*a || *b) {
        while (a > wanted->text && a[-1] != '\n') {
            --a;
            --b;
        }
        fail_msg("%s: \"%.*s\" instead of \"%.*s\"", when, (int)strcspn(b, "\n"), b,
                 (int)strcspn(a, "\n"), a);
    }
    free(now.text);
}

/* ---- what somebody does ---- */

static const float face_x = 420.0f, face_y = 250.0f; /* about its middle, at 1280x720 */

static void go_live(void)
{
    if (live_shown_take(app_live(s.app)))
        scene_do(&s, ACTION_LIVE);
}

static void drag_face(uint32_t modifiers)
{
    go_live();
    const float x = face_x + (float)draw_real(-50.0, 50.0),
                y = face_y + (float)draw_real(-60.0, 60.0);
    scene_modifiers(&s, modifiers, true);
    scene_drag(&s, x, y, x + (float)draw_real(-25.0, 25.0), y + (float)draw_real(-25.0, 25.0), 3);
    scene_modifiers(&s, modifiers, false);
}

static void show_panel(action of, app_panel panel)
{
    if (app_looks_of(s.app)->layouts.now.current != panel)
        scene_do(&s, of);
}

static void drag_parameter(void)
{
    show_panel(ACTION_PANEL_MAPPING, APP_MAPPING);
    const ui_word *label = scene_word(&s, "Gain");
    if (!label)
        return;
    const float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    scene_drag(&s, x, y, x + (float)draw_real(-60.0, 90.0), y, 3);
}

static void add_contact(void)
{
    go_live();
    show_panel(ACTION_PANEL_RIG, APP_RIG);
    if (!scene_word(&s, "Add a contact"))
        scene_click_word(&s, "Contacts");
    if (!scene_word(&s, "Add a contact"))
        return;
    scene_click_word(&s, "Add a contact");
    scene_click(&s, face_x + (float)draw_real(-40.0, 40.0), face_y + (float)draw_real(-50.0, 50.0));
}

static void connect(void)
{
    show_panel(ACTION_PANEL_PATCH, APP_PATCH);
    if (app_patch(s.app)->count < 8 && scene_word(&s, "Add"))
        scene_click_word(&s, "Add");
}

static void move_light(void)
{
    kept_scenery *of = app_scenery(s.app);
    scenery next = *kept_scenery_now(of);
    next.light.room = (float)draw_real(0.2, 1.0);
    kept_scenery_set(of, &next);
    kept_scenery_keep(of);
}

static void choose_take(void)
{
    const app_take_line *line;
    const uint32_t count = app_takes(s.app, &line), which = draw_lot(count);
    if (!line[which].is_deleted && app_take_id(s.app) != line[which].id)
        assert_true(app_choose_take(s.app, line[which].id) >= 0);
    scene_frame(&s);
}

static const take_clip *any_clip(const take *t)
{
    const take_layer *l = t->layer_count ? &t->layer[draw_lot(t->layer_count)] : NULL;
    return l && l->clip_count ? &l->clip[draw_lot(l->clip_count)] : NULL;
}

/* What is not possible now is refused, and changes nothing. */
static void edit_a_take(void)
{
    static const edit_kind kinds[] = {
        EDIT_TAKE_RATE,    EDIT_TAKE_RENAME,   EDIT_TAKE_NOTE,    EDIT_MARKER_ADD,
        EDIT_MARKER_MOVE,  EDIT_MARKER_REMOVE, EDIT_LAYER_GAIN,   EDIT_LAYER_MUTE,
        EDIT_LAYER_OFFSET, EDIT_CLIP_TRIM,     EDIT_CLIP_SPLIT,   EDIT_CLIP_GAIN,
        EDIT_CLIP_MUTE,    EDIT_CLIP_MOVE,     EDIT_AUDIO_OFFSET, EDIT_AUDIO_GAIN,
        EDIT_AUDIO_DETACH, EDIT_RANGE_CUT,     EDIT_LAYER_ADD};
    if (!app_take(s.app))
        choose_take();
    const take *t = app_take(s.app);
    const take_clip *clip = t ? any_clip(t) : NULL;
    edit e;
    if (!clip)
        return;
    edit_init(&e, kinds[draw_lot(sizeof kinds / sizeof kinds[0])]);
    e.layer = t->layer[draw_lot(t->layer_count)].id;
    e.clip = clip->id;
    e.rating = draw_lot(6);
    e.marker = t->marker_count ? draw_lot(t->marker_count) : 0;
    e.gain = draw_real(0.2, 1.5);
    e.is_muted = draw_lot(2) == 0;
    e.offset_ns = (int64_t)draw_real(0.0, 2e8);
    e.at_ns = (int64_t)draw_real(0.0, 9e8);
    e.start_ns = clip->start_ns + (int64_t)draw_real(0.0, 1e8);
    e.in_ns = (int64_t)draw_real(0.0, 4e8);
    e.out_ns = e.in_ns + 1000000 + (int64_t)draw_real(0.0, 1e8);
    (void)snprintf(e.name, sizeof e.name, "name %u", draw_lot(1000));
    (void)snprintf(e.note, sizeof e.note, "note %u", draw_lot(1000));
    (void)snprintf(e.text, sizeof e.text, "mark %u", draw_lot(1000));
    if (app_edit(s.app, &e) < 0)
        scene_frame(&s);
    edit_finish(&e);
}

static bool has_read(scene *of, void *data)
{
    (void)data;
    return app_voice_part(of->app) < 0.0;
}

static void attach_voice(void)
{
    char path[128];
    (void)snprintf(path, sizeof path, "%s/voice.au", s.folder);
    if (app_take(s.app) && app_take(s.app)->audio.audio == 0)
        if (open_any(s.app, path) < 0)
            fail_msg("%s",
                     news_list_at(app_news(s.app), news_list_count(app_news(s.app)) - 1)->text);
    assert_true(scene_until(&s, has_read, NULL));
}

static void do_something(void)
{
    const uint32_t what = draw_lot(100);
    if (what < 8)
        drag_face(UI_SHIFT);
    else if (what < 14)
        drag_face(UI_CONTROL);
    else if (what < 15)
        scene_do(&s, ACTION_NEUTRAL);
    else if (what < 25)
        drag_parameter();
    else if (what < 29)
        add_contact();
    else if (what < 32)
        connect();
    else if (what < 40)
        move_light();
    else if (what < 46)
        choose_take();
    else if (what < 48 && app_take(s.app))
        app_do(s.app, ACTION_DUPLICATE);
    else if (what < 52)
        attach_voice();
    else
        edit_a_take();
}

/* ---- back and forth ---- */

/* What the window says stands in the way is done: going back to the live face, waiting. */
static uint32_t go_all(action way)
{
    const char *why = "";
    uint32_t count = 0, waits = 0;
    for (;;) {
        const char *next = way == ACTION_UNDO ? app_undo_words(s.app) : app_redo_words(s.app);
        if (!next[0])
            return count;
        if (app_can(s.app, way, &why)) {
            app_do(s.app, way);
            scene_frame(&s);
            /* Where the step's take came in front only, what is next is still the same. */
            count += next != (way == ACTION_UNDO ? app_undo_words(s.app) : app_redo_words(s.app));
            waits = 0;
        } else {
            if (strstr(why, "Press L to go back") || way == ACTION_REDO)
                go_live();
            scene_frame(&s);
            if (++waits == 3000)
                fail_msg("\"%s\" after %u: %s", next, count, why);
        }
    }
}

static void make_show(void)
{
    char command[1024];
    for (int i = 0; i < 2; ++i) {
        (void)snprintf(command, sizeof command,
                       "%s/marotte perform --face %s/rigs/puppet/puppet.rig.json --input "
                       "log:%s/plugins/log/demo_hand.csv,end=1 --map one_hand --record %s "
                       ">/dev/null 2>&1",
                       BUILD_DIR, SOURCE_DIR, SOURCE_DIR, s.show);
        assert_int_equal(system(command), 0);
    }
    (void)snprintf(command, sizeof command, "%s/voice.au", s.folder);
    FILE *voice = fopen(command, "wb"); /* half a second of a hum, 8 kHz, mu-law */
    assert_non_null(voice);
    (void)fwrite(".snd\0\0\0\30\377\377\377\377\0\0\0\1\0\0\37\100\0\0\0\1", 1, 24, voice);
    for (int i = 0; i < 4000; ++i)
        (void)fputc(i * i % 251, voice);
    (void)fclose(voice);
}

static void undo_goes_back_to_the_first_state_and_redo_to_the_last(void **state)
{
    const char *seed = getenv("MAROTTE_SEED"), *wanted = getenv("MAROTTE_ACTIONS");
    const uint32_t actions = wanted ? (uint32_t)atoi(wanted) : 200;
    (void)state;
    lot = seed ? strtoull(seed, NULL, 10) : 1;
    const scene_options with = {.width_px = 1280, .height_px = 720, .scale = 1.0f};
    scene_prepare(&s, &with);
    make_show();
    scene_open_again(&s, &with);
    words first = say_all();
    show_panel(ACTION_PANEL_MAPPING, APP_MAPPING);
    scene_click_word(&s, "Find a parameter");
    scene_type(&s, "gain");
    scene_key(&s, UI_KEY_ENTER, 0);
    for (uint32_t i = 0; i < actions; ++i)
        do_something();
    show_panel(ACTION_PANEL_MAPPING, APP_MAPPING);
    words last = say_all();
    const uint32_t undone = go_all(ACTION_UNDO);
    print_message("%u steps were undone\n", undone);
    assert_true(undone > actions / 3 && undone < 1024); /* the others were not possible */
    expect_all(&first, "all undone");
    const uint32_t redone = go_all(ACTION_REDO);
    assert_int_equal(redone, undone);
    expect_all(&last, "all done again");
    free(first.text);
    free(last.text);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(undo_goes_back_to_the_first_state_and_redo_to_the_last),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
