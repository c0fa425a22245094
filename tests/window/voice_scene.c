/* The voice of a take in the window: read beside all else, laid, trimmed and taken away;
 * what its mouth is, and how late. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene.h"
#include "show/take.h"
#include "window/open_any.h"

enum { RATE_HZ = 48000 };

static bool has_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool has_read(scene *s, void *data)
{
    (void)data;
    return app_voice_part(s->app) < 0.0;
}

static bool has_wave(scene *s, void *data)
{
    return scene_word(s, data) != NULL;
}

/* A tone, as Sun/NeXT audio. */
static void write_sound(const scene *s, const char *name, int32_t seconds)
{
    const uint32_t head[6] = {0x2e736e64, 24, 0xffffffffu, 3 /* 16 bits */, RATE_HZ, 1};
    char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", s->folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    for (int i = 0; i < 6; ++i)
        for (int byte = 3; byte >= 0; --byte)
            (void)fputc((int)(head[i] >> 8 * byte & 0xff), file);
    for (int32_t i = 0; i < seconds * RATE_HZ; ++i) {
        const uint32_t sample = (uint32_t)(int32_t)(12000.0 * sin((double)i * 0.05));
        (void)fputc((int)(sample >> 8 & 0xff), file);
        (void)fputc((int)(sample & 0xff), file);
    }
    assert_int_equal(fclose(file), 0);
}

static mrt_result open_file(scene *s, const char *name)
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s/%s", s->folder, name);
    return open_any(s->app, path);
}

static void open_with_a_take_until(scene *s, scene_condition *is_long)
{
    static char hand[512];
    static const char *const inputs[] = {hand};
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = inputs, .input_count = 1};
    scene_open_with(s, &options);
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, is_long, NULL));
    scene_do(s, ACTION_RECORD);
    assert_true(scene_until(s, has_take, NULL));
}

static void open_with_a_take(scene *s)
{
    open_with_a_take_until(s, has_recorded);
}

static const take_audio *voice(scene *s)
{
    return &app_take(s->app)->audio;
}

/* Where a time of the take lies across: all of it is seen, however long it became. */
static float across(scene *s, double time_s)
{
    const float left = 398.0f, width = 431.0f;
    return left + width * (float)(1e9 * time_s / (double)app_take(s->app)->duration_ns);
}

/* Among the times of the ruler, the lowest that are on the screen. */
static float ruler_y(scene *s)
{
    const ui_word *words;
    const uint32_t count = ui_words(s->ui, &words);
    float y = 0.0f;
    for (uint32_t i = 0; i < count; ++i)
        if (strncmp(words[i].text, "00:00:", 6) == 0)
            y = fmaxf(y, words[i].where.y);
    return y + 8.0f;
}

static void a_voice_is_read_beside_all_else_trimmed_and_taken_away(void **state)
{
    (void)state;
    scene s;
    char name[] = "line.au";
    open_with_a_take(&s);
    write_sound(&s, name, 1);
    assert_int_equal(open_file(&s, name), MRT_OK);
    assert_true(scene_until(&s, has_read, NULL));
    assert_true(scene_until(&s, has_wave, name));
    scene_frames(&s, 30);
    const ui_word *head = scene_word(&s, name);
    assert_non_null(head);
    const float y = head->where.y + 18.0f;
    scene_drag(&s, across(&s, 0.0), y, across(&s, 0.4), y, 8);
    assert_true(voice(&s)->in_ns > 0 && voice(&s)->out_ns == 0 && voice(&s)->offset_ns == 0);
    scene_look(&s, "voice_trimmed");
    scene_check_words(&s);
    const int64_t in_ns = voice(&s)->in_ns;
    scene_do(&s, ACTION_UNDO);
    assert_true(voice(&s)->in_ns == 0);
    scene_do(&s, ACTION_REDO);
    assert_true(voice(&s)->in_ns == in_ns);
    scene_drag(&s, across(&s, 0.55), y, across(&s, 0.7), y, 8); /* it takes its trim along */
    assert_true(voice(&s)->in_ns == in_ns && voice(&s)->offset_ns > 0);
    scene_click_with(&s, across(&s, 0.7), y, 1);
    scene_look(&s, "voice_menu");
    scene_click_word(&s, "Align with the take start");
    assert_true(voice(&s)->offset_ns == 0);
    scene_click_with(&s, across(&s, 0.7), y, 1);
    scene_click_word(&s, "Restore the whole sound");
    assert_true(voice(&s)->in_ns == 0 && voice(&s)->out_ns == NS_PER_S);
    scene_click(&s, across(&s, 0.5), ruler_y(&s));
    scene_frames(&s, 3);
    scene_click_with(&s, across(&s, 0.7), y, 1);
    scene_click_word(&s, "Trim end to playhead");
    const int64_t out_ns = voice(&s)->out_ns;
    assert_true(out_ns > 350 * NS_PER_MS && out_ns < 650 * NS_PER_MS);
    scene_click_with(&s, across(&s, 0.2), y, 1);
    scene_click_word(&s, "Remove sound");
    assert_true(voice(&s)->audio == 0);
    scene_do(&s, ACTION_UNDO);
    assert_true(voice(&s)->audio != 0 && voice(&s)->out_ns == out_ns);
    scene_close(&s);
}

static void what_is_read_is_given_up_with_its_show_and_one_at_a_time(void **state)
{
    (void)state;
    scene s;
    char other[256];
    open_with_a_take(&s);
    write_sound(&s, "long.au", 300);
    write_sound(&s, "line.au", 1);
    assert_int_equal(open_file(&s, "long.au"), MRT_OK);
    assert_true(app_voice_part(s.app) >= 0.0);
    assert_true(open_file(&s, "line.au") < 0);
    scene_frame(&s);
    assert_non_null(scene_word_with(&s, "is being read"));
    assert_non_null(scene_word_with(&s, "Reading the voice"));
    scene_look(&s, "voice_is_read");
    (void)snprintf(other, sizeof other, "%s/other.marotte", s.folder);
    assert_int_equal(app_open_show(s.app, other), MRT_OK);
    assert_true(app_voice_part(s.app) < 0.0);
    assert_int_equal(app_open_show(s.app, s.show), MRT_OK);
    assert_true(app_select_take(s.app, 1) >= 0);
    assert_true(voice(&s)->audio == 0);
    assert_true(open_file(&s, "none.au") >= 0);
    assert_true(scene_until(&s, has_read, NULL));
    assert_non_null(scene_word_with(&s, "none.au"));
    assert_true(voice(&s)->audio == 0);
    scene_close(&s);
}

static bool has_spoken(scene *s, void *data)
{
    (void)data;
    return app_speech_part(s->app) < 0.0;
}

static void press_move(scene *s)
{
    scene_click_word(s, "Move the mouth");
    assert_true(scene_until(s, has_spoken, NULL));
    scene_frames(s, 3);
}

/* The recorded voice of the demo, from its third second on. */
static void a_voice_moves_the_mouth_by_one_edit(void **state)
{
    (void)state;
    scene s;
    edit later;
    char path[512], name[] = "demo.ogg";
    open_with_a_take(&s);
    (void)snprintf(path, sizeof path, "%s/plugins/log/%s", SOURCE_DIR, name);
    assert_int_equal(open_any(s.app, path), MRT_OK);
    assert_true(scene_until(&s, has_read, NULL));
    assert_true(scene_until(&s, has_wave, name));
    edit_init(&later, EDIT_AUDIO_OFFSET);
    later.offset_ns = -2 * NS_PER_S;
    assert_int_equal(app_edit(s.app, &later), MRT_OK);
    scene_frames(&s, 30);
    const uint32_t layers = app_take(s.app)->layer_count;
    const float y = scene_word(&s, name)->where.y + 18.0f;
    scene_click_with(&s, across(&s, 0.5), y, 1);
    scene_click_word(&s, "Mouth from this voice \u2026");
    scene_frames(&s, 3);
    assert_non_null(scene_word(&s, "Mouth from this voice"));
    press_move(&s);
    assert_non_null(scene_word_with(&s, "sounds in"));
    scene_look(&s, "voice_mouth");
    scene_check_words(&s);
    const take *now = app_take(s.app);
    assert_int_equal(now->layer_count, layers + 1);
    assert_string_equal(now->layer[0].name, "voice mouth");
    assert_int_equal(now->layer[0].clip[0].part, TAKE_PALETTE);
    for (uint32_t i = 1; i < now->layer_count; ++i)
        assert_true(now->layer[i].is_additive);
    press_move(&s); /* again: it is replaced */
    assert_int_equal(app_take(s.app)->layer_count, layers + 1);
    scene_click_word(&s, "Close");
    scene_do(&s, ACTION_UNDO);
    scene_do(&s, ACTION_UNDO);
    assert_int_equal(app_take(s.app)->layer_count, layers);
    assert_false(app_take(s.app)->layer[0].is_additive);
    scene_do(&s, ACTION_REDO);
    assert_int_equal(app_take(s.app)->layer_count, layers + 1);
    scene_close(&s);
}

static void a_tone_is_no_voice(void **state)
{
    (void)state;
    scene s;
    char name[] = "line.au";
    open_with_a_take(&s);
    write_sound(&s, name, 1);
    assert_int_equal(open_file(&s, name), MRT_OK);
    assert_true(scene_until(&s, has_read, NULL));
    assert_true(scene_until(&s, has_wave, name));
    scene_frames(&s, 30);
    scene_click_with(&s, across(&s, 0.5), scene_word(&s, name)->where.y + 18.0f, 1);
    scene_click_word(&s, "Mouth from this voice \u2026");
    scene_frames(&s, 3);
    const uint32_t layers = app_take(s.app)->layer_count;
    press_move(&s);
    assert_non_null(scene_word_with(&s, "no speech was found"));
    assert_int_equal(app_take(s.app)->layer_count, layers);
    scene_close(&s);
}

static bool has_measured(scene *s, void *data)
{
    (void)data;
    return app_sync_part(s->app) < 0.0;
}

static void open_sync(scene *s, const char *name, double at_s)
{
    scene_click_with(s, across(s, at_s), scene_word(s, name)->where.y + 18.0f, 1);
    scene_click_word(s, "Sync of mouth and sound \u2026");
    assert_true(scene_until(s, has_measured, NULL));
    scene_frames(s, 3);
}

static bool is_long_enough(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->recorded_ns > 5 * NS_PER_S;
}

/* A mouth that was made from its voice is shifted: the dialog finds that, and moves it back. */
static void a_late_mouth_is_found_and_moved_by_one_edit(void **state)
{
    (void)state;
    scene s;
    edit later;
    char path[512], name[] = "demo.ogg";
    open_with_a_take_until(&s, is_long_enough);
    (void)snprintf(path, sizeof path, "%s/plugins/log/%s", SOURCE_DIR, name);
    assert_int_equal(open_any(s.app, path), MRT_OK);
    assert_true(scene_until(&s, has_read, NULL));
    assert_true(scene_until(&s, has_wave, name));
    edit_init(&later, EDIT_AUDIO_OFFSET);
    later.offset_ns = -2 * NS_PER_S;
    assert_int_equal(app_edit(s.app, &later), MRT_OK);
    const app_speech_wish wish = {"", 1.0, 1.0};
    assert_int_equal(app_speech_begin(s.app, &wish), MRT_OK);
    assert_true(scene_until(&s, has_spoken, NULL));
    const take_layer *mouth = &app_take(s.app)->layer[0];
    assert_string_equal(mouth->name, "voice mouth");
    for (uint32_t i = app_take(s.app)->layer_count - 1; i > 0; --i) { /* the hands */
        edit_init(&later, EDIT_LAYER_REMOVE);
        later.layer = app_take(s.app)->layer[i].id;
        assert_int_equal(app_edit(s.app, &later), MRT_OK);
    }
    scene_frames(&s, 30);
    open_sync(&s, name, 0.5);
    assert_non_null(app_sync_of(s.app));
    const int64_t own_ns = app_sync_of(s.app)->offset.late_ns; /* as it was made */
    scene_click_word(&s, "Close");

    edit_init(&later, EDIT_LAYER_OFFSET);
    later.layer = app_take(s.app)->layer[0].id;
    later.offset_ns = 150 * NS_PER_MS;
    assert_int_equal(app_edit(s.app, &later), MRT_OK);
    scene_frames(&s, 3);
    assert_null(app_sync_of(s.app)); /* of the take before the edit */
    open_sync(&s, name, 0.5);
    const sync_offset found = app_sync_of(s.app)->offset;
    char words[64];
    assert_true(found.is_clear);
    assert_true(llabs(found.late_ns - own_ns - later.offset_ns) < 15 * NS_PER_MS);
    (void)snprintf(words, sizeof words, "The mouth is %.0f ms late", 1e-6 * (double)found.late_ns);
    assert_non_null(scene_word(&s, words));
    scene_look(&s, "voice_sync");
    scene_check_words(&s);
    (void)snprintf(words, sizeof words, "Move the mouth by %+.0f ms",
                   -1e-6 * (double)found.late_ns);
    scene_click_word(&s, words);
    scene_frames(&s, 3);
    assert_true(app_take(s.app)->layer[0].offset_ns == later.offset_ns - found.late_ns);
    assert_non_null(scene_word_with(&s, "The mouth was moved by"));
    assert_null(scene_word(&s, words)); /* once */
    assert_non_null(strstr(app_undo_words(s.app), "move the mouth by"));
    scene_look(&s, "voice_sync_moved");
    scene_check_words(&s);
    scene_click_word(&s, "Measure again");
    assert_true(scene_until(&s, has_measured, NULL));
    assert_true(app_sync_of(s.app)->offset.is_clear);
    assert_true(llabs(app_sync_of(s.app)->offset.late_ns) < 15 * NS_PER_MS);
    scene_frames(&s, 3);
    scene_click_word(&s, "Close");
    scene_do(&s, ACTION_UNDO);
    assert_true(app_take(s.app)->layer[0].offset_ns == later.offset_ns);

    /* Cancelled. A take that changes, or is closed with its show, while it is measured. */
    assert_int_equal(app_sync_begin(s.app, 0, app_take(s.app)->duration_ns), MRT_OK);
    assert_true(app_sync_begin(s.app, 0, app_take(s.app)->duration_ns) < 0);
    app_sync_cancel(s.app);
    assert_true(scene_until(&s, has_measured, NULL));
    assert_null(app_sync_of(s.app));
    assert_non_null(strstr(app_sync_result(s.app), "Cancelled"));
    assert_int_equal(app_sync_begin(s.app, 0, app_take(s.app)->duration_ns), MRT_OK);
    edit_init(&later, EDIT_AUDIO_DETACH);
    assert_int_equal(app_edit(s.app, &later), MRT_OK);
    assert_true(scene_until(&s, has_measured, NULL));
    assert_null(app_sync_of(s.app));
    assert_non_null(strstr(app_sync_result(s.app), "The take has changed"));
    assert_int_equal(app_sync_begin(s.app, 0, app_take(s.app)->duration_ns), MRT_OK);
    assert_true(scene_until(&s, has_measured, NULL));
    assert_non_null(strstr(app_sync_result(s.app), "The take has no sound"));
    assert_int_equal(app_sync_begin(s.app, 0, app_take(s.app)->duration_ns), MRT_OK);
    (void)snprintf(path, sizeof path, "%s/other.marotte", s.folder);
    assert_int_equal(app_open_show(s.app, path), MRT_OK);
    assert_true(app_sync_part(s.app) < 0.0);
    assert_string_equal(app_sync_result(s.app), "");
    scene_close(&s);
}

/* A sound or a take that cannot be compared is refused by one sentence, and nothing is offered. */
static void what_cannot_be_compared_is_said_in_the_dialog(void **state)
{
    (void)state;
    scene s;
    char name[] = "line.au";
    open_with_a_take(&s);
    write_sound(&s, name, 1);
    assert_int_equal(open_file(&s, name), MRT_OK);
    assert_true(scene_until(&s, has_read, NULL));
    assert_true(scene_until(&s, has_wave, name));
    scene_frames(&s, 30);
    open_sync(&s, name, 0.5);
    assert_non_null(scene_word_with(&s, "The span is too short"));
    assert_null(scene_word_with(&s, "Move the mouth by"));
    scene_look(&s, "voice_sync_refused");
    scene_check_words(&s);
    scene_click_word(&s, "Close");
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_voice_is_read_beside_all_else_trimmed_and_taken_away),
        cmocka_unit_test(what_is_read_is_given_up_with_its_show_and_one_at_a_time),
        cmocka_unit_test(a_voice_moves_the_mouth_by_one_edit),
        cmocka_unit_test(a_tone_is_no_voice),
        cmocka_unit_test(a_late_mouth_is_found_and_moved_by_one_edit),
        cmocka_unit_test(what_cannot_be_compared_is_said_in_the_dialog),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
