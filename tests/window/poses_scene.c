/* The panel Poses in the whole window: poses are learnt and played by clicks, keys, a MIDI pad and
 * the remote control, recorded, shown again bit for bit, edited and exported by name. */
#include "window/live_seen.h"

#include "scene.h"
#include "window/app/pose_palette.h"

#include <fcntl.h>

static int pad = -1; /* writing end of the pipe that stands for a MIDI device */

static pose_palette *poses(scene *s)
{
    return app_poses(s->app);
}

static bool has_poses(scene *s, void *data)
{
    (void)data;
    return pose_palette_count(poses(s)) > 60;
}

static uint32_t find(scene *s, const char *name)
{
    const uint32_t found = pose_palette_find(poses(s), name);
    if (found == UINT32_MAX)
        fail_msg("no pose %s", name);
    return found;
}

typedef struct played {
    const char *name;
    double strength;
} played;

static bool is_played(scene *s, void *data)
{
    const played *p = data;
    return fabs(pose_palette_wanted(poses(s), find(s, p->name)) - p->strength) < 0.01;
}

static void await_strength(scene *s, const char *name, double strength)
{
    played p = {name, strength};
    if (!scene_until(s, is_played, &p))
        fail_msg("%s has the strength %g", name, pose_palette_wanted(poses(s), find(s, name)));
}

static void send_note(uint8_t note, uint8_t velocity)
{
    const uint8_t bytes[3] = {0x90, note, velocity};
    assert_int_equal(write(pad, bytes, sizeof bytes), sizeof bytes);
}

static uint32_t midi_input(scene *s)
{
    live *stage = app_live(s->app);
    for (uint32_t i = 0; i < live_input_count(stage); ++i)
        if (strstr(live_input_text(stage, i), "midi"))
            return i;
    return UINT32_MAX;
}

/* The plugin names a pad after its first hit. */
static bool has_pad(scene *s, void *data)
{
    uint32_t count = 0;
    const uint32_t at = midi_input(s);
    (void)data;
    const mrt_channel *channel =
        at == UINT32_MAX ? NULL : input_channels(live_input(app_live(s->app), at), &count);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(channel[i].name, "note.36") == 0)
            return true;
    return false;
}

static void open_poses(scene *s, bool has_pipe)
{
    static char hand[512], midi[128];
    static const char *const inputs[] = {hand, midi};
    scene_options options = {
        .width_px = 1440, .height_px = 900, .scale = 1.0f, .inputs = inputs, .input_count = 1};
    (void)snprintf(hand, sizeof hand, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    scene_prepare(s, &options);
    if (has_pipe) {
        char path[112];
        (void)snprintf(path, sizeof path, "%s/pad", s->folder);
        assert_int_equal(mkfifo(path, 0600), 0);
        pad = open(path, O_RDWR | O_NONBLOCK);
        assert_true(pad >= 0);
        (void)snprintf(midi, sizeof midi, "midi:%s", path);
        options.input_count = 2;
    }
    scene_open_again(s, &options);
    scene_do(s, ACTION_PANEL_POSES);
    assert_true(scene_until(s, has_poses, NULL));
    scene_frames(s, 3);
}

static void close_poses(scene *s)
{
    scene_close(s);
    if (pad >= 0)
        close(pad);
    pad = -1;
}

static void learn_key(scene *s, const char *label, uint32_t key)
{
    scene_click_word(s, label);
    scene_key(s, key, 0);
}

static const pose_trigger *trigger_of(scene *s, const char *pose)
{
    const pose_settings *now = pose_palette_settings(poses(s));
    for (uint32_t i = 0; i < now->trigger_count; ++i)
        if (strcmp(now->trigger[i].pose, pose) == 0)
            return &now->trigger[i];
    return NULL;
}

/* ---- playing and recording ---- */

static bool is_recording(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > NS_PER_S / 10;
}

static bool has_take(scene *s, void *data)
{
    (void)data;
    return app_take(s->app) != NULL && !app_status(s->app)->is_recording;
}

static bool has_learnt(scene *s, void *data)
{
    return trigger_of(s, data) != NULL;
}

static void watch(scene *s, seen_faces *faces, uint32_t frames)
{
    for (uint32_t i = 0; i < frames; ++i) {
        live_fixture as = {.view = app_view(s->app)};
        clock_sleep_until_ns(clock_now_ns() + NS_PER_S / 60);
        scene_frame(s);
        as.view = app_view(s->app);
        seen_remember(&as, faces);
    }
}

/* The take of the window shows the faces that were seen. */
static uint32_t compare(scene *s, const seen_faces *faces)
{
    error err = {""};
    live_fixture as = {.plugins = *app_plugins(s->app),
                       .log = app_log(s->app),
                       .face = *app_face(s->app),
                       .live = app_live(s->app),
                       .view = app_view(s->app)};
    (void)snprintf(as.show_path, sizeof as.show_path, "%s", s->show);
    fixture_must(show_open(&as.show, s->show, SHOW_READ, &err), &err);
    const uint32_t compared = seen_compare(&as, app_take_id(s->app), faces);
    show_close(as.show);
    return compared;
}

static int32_t layer_named(scene *s, const char *name)
{
    const take *t = app_take(s->app);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        if (strcmp(t->layer[i].name, name) == 0)
            return (int32_t)i;
    return -1;
}

/* The largest value of a column of a table whose head has its name. */
static double most_of(const char *path, const char *column)
{
    static char line[1 << 16];
    FILE *file = fopen(path, "r");
    double most = -1.0;
    int at = -1;
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        int number = 0;
        for (char *word = strtok(line, ",\r\n"); word; word = strtok(NULL, ",\r\n"), ++number) {
            if (at < 0 && strcmp(word, column) == 0)
                at = number;
            else if (at >= 0 && number == at)
                most = fmax(most, strtod(word, NULL));
        }
    }
    fclose(file);
    return most;
}

static void export_and_check(scene *s)
{
    char command[768], path[160];
    (void)snprintf(path, sizeof path, "%s/out.livelink.csv", s->folder);
    (void)snprintf(command, sizeof command, "%s/marotte take export %s last --export %s >/dev/null",
                   BUILD_DIR, s->show, path);
    assert_int_equal(system(command), 0);
    if (most_of(path, "JawOpen") < 0.5 || most_of(path, "MouthPucker") < 0.2)
        fail_msg("exported: JawOpen %g, MouthPucker %g", most_of(path, "JawOpen"),
                 most_of(path, "MouthPucker"));
}

static void poses_are_played_recorded_edited_and_exported(void **state)
{
    scene s;
    error err = {""};
    char pucker[] = "mouthPucker";
    (void)state;
    open_poses(&s, true);
    seen_faces *faces = calloc(1, sizeof *faces);
    assert_non_null(faces);
    /* learn */
    scene_click_word(&s, "Learn");
    learn_key(&s, "Jaw open", 'Q');
    assert_int_equal(trigger_of(&s, "jawOpen")->key, 'Q');
    send_note(36, 100); /* its first hit makes it a channel */
    assert_true(scene_until(&s, has_pad, NULL));
    send_note(36, 0);
    scene_frames(&s, 30);
    scene_click_word(&s, "Mouth pucker");
    scene_frames(&s, 10);
    send_note(36, 100);
    assert_true(scene_until(&s, has_learnt, pucker));
    assert_string_equal(trigger_of(&s, "mouthPucker")->channel, "note.36");
    assert_false(trigger_of(&s, "mouthPucker")->follows);
    send_note(36, 0);
    scene_click_word(&s, "Stop learning");
    await_strength(&s, "mouthPucker", 0.0);
    scene_look(&s, "poses_learnt");
    /* play */
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recording, NULL));
    watch(&s, faces, 10);
    scene_hold_key(&s, 'Q', true);
    await_strength(&s, "jawOpen", 1.0);
    watch(&s, faces, 25);
    scene_look(&s, "poses_played");
    scene_hold_key(&s, 'Q', false);
    await_strength(&s, "jawOpen", 0.0);
    watch(&s, faces, 10);
    send_note(36, 64);
    await_strength(&s, "mouthPucker", 64.0 / 127.0);
    watch(&s, faces, 25);
    send_note(36, 0);
    await_strength(&s, "mouthPucker", 0.0);
    const ui_word *label = scene_word(&s, "Mouth left");
    assert_non_null(label);
    scene_move(&s, label->where.x + 4.0f, label->where.y - 30.0f);
    scene_settle(&s);
    scene_button(&s, 0, true);
    await_strength(&s, "mouthLeft", 1.0);
    watch(&s, faces, 20);
    scene_button(&s, 0, false);
    await_strength(&s, "mouthLeft", 0.0);
    for (uint32_t i = 0; i < pose_palette_count(poses(&s)); ++i) /* as the remote control does */
        fixture_must(pose_palette_set(poses(&s), pose_palette_name(poses(&s), i), 1.0, 0.2, &err),
                     &err);
    await_strength(&s, "browInnerUp", 1.0);
    watch(&s, faces, 25);
    pose_palette_release_all(poses(&s), 0.2);
    await_strength(&s, "browInnerUp", 0.0);
    watch(&s, faces, 25);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    /* shown again */
    const uint32_t compared = compare(&s, faces);
    if (compared < 20)
        fail_msg("only %u faces were compared", compared);
    free(faces);
    /* a lane of its own, edited and undone */
    const int32_t lane = layer_named(&s, "palette");
    assert_int_equal(lane, 1);
    scene_frames(&s, 30);
    assert_non_null(scene_word(&s, "palette"));
    scene_look(&s, "poses_lane");
    edit e;
    edit_init(&e, EDIT_LAYER_OFFSET);
    e.layer = app_take(s.app)->layer[lane].id;
    e.offset_ns = 50 * NS_PER_MS;
    fixture_must(app_edit(s.app, &e), &err);
    assert_true(app_take(s.app)->layer[lane].offset_ns == e.offset_ns);
    edit_init(&e, EDIT_LAYER_REMOVE);
    e.layer = app_take(s.app)->layer[lane].id;
    fixture_must(app_edit(s.app, &e), &err);
    assert_int_equal(layer_named(&s, "palette"), -1);
    scene_do(&s, ACTION_UNDO);
    scene_do(&s, ACTION_UNDO);
    assert_int_equal(layer_named(&s, "palette"), 1);
    assert_true(app_take(s.app)->layer[lane].offset_ns == 0);
    scene_end(&s);
    export_and_check(&s);
    close_poses(&s);
}

/* ---- trouble ---- */

static void a_key_learnt_twice_plays_the_last_and_undo_brings_the_first_back(void **state)
{
    scene s;
    (void)state;
    open_poses(&s, false);
    scene_click_word(&s, "Learn");
    learn_key(&s, "Jaw open", 'K');
    learn_key(&s, "Mouth funnel", 'K');
    scene_click_word(&s, "Stop learning");
    assert_null(trigger_of(&s, "jawOpen"));
    assert_int_equal(trigger_of(&s, "mouthFunnel")->key, 'K');
    scene_hold_key(&s, 'K', true); /* instead of Keep */
    await_strength(&s, "mouthFunnel", 1.0);
    assert_true(app_take(s.app) == NULL);
    scene_hold_key(&s, 'K', false);
    await_strength(&s, "mouthFunnel", 0.0);
    scene_do(&s, ACTION_UNDO);
    assert_int_equal(trigger_of(&s, "jawOpen")->key, 'K');
    assert_null(trigger_of(&s, "mouthFunnel"));
    close_poses(&s);
}

static void a_pad_that_is_unplugged_while_it_is_held_lets_its_pose_go(void **state)
{
    scene s;
    error err = {""};
    char jaw[] = "jawOpen";
    (void)state;
    open_poses(&s, true);
    send_note(36, 127);
    assert_true(scene_until(&s, has_pad, NULL));
    send_note(36, 0);
    scene_frames(&s, 30);
    pose_palette_learn(poses(&s), find(&s, jaw));
    scene_frames(&s, 5);
    send_note(36, 127);
    assert_true(scene_until(&s, has_learnt, jaw));
    await_strength(&s, jaw, 1.0);
    fixture_must(live_remove_input(app_live(s.app), midi_input(&s), &err), &err);
    await_strength(&s, jaw, 0.0);
    close_poses(&s);
}

static void a_hit_shorter_than_a_frame_is_played(void **state)
{
    scene s;
    char jaw[] = "jawOpen";
    (void)state;
    open_poses(&s, true);
    send_note(36, 127);
    assert_true(scene_until(&s, has_pad, NULL));
    send_note(36, 0);
    scene_frames(&s, 30);
    pose_settings to = *pose_palette_settings(poses(&s));
    to.mode = POSE_LATCH;
    to.trigger[to.trigger_count++] =
        (pose_trigger){.pose = "jawOpen", .input = "midi", .channel = "note.36"};
    pose_palette_change(poses(&s), &to, "test");
    scene_frames(&s, 5);
    for (int i = 0; i < 4; ++i) {
        send_note(36, 127);
        send_note(36, 0);
        clock_sleep_until_ns(clock_now_ns() + 50 * NS_PER_MS); /* no frame of the window */
        await_strength(&s, jaw, i % 2 ? 0.0 : 1.0);
    }
    close_poses(&s);
}

static void send_fader(uint8_t value)
{
    const uint8_t bytes[3] = {0xb0, 1, value};
    assert_int_equal(write(pad, bytes, sizeof bytes), sizeof bytes);
}

static void a_fader_is_followed(void **state)
{
    scene s;
    char jaw[] = "jawOpen";
    (void)state;
    open_poses(&s, true);
    send_fader(0);
    scene_frames(&s, 30);
    pose_palette_learn(poses(&s), find(&s, jaw));
    scene_frames(&s, 5);
    for (uint8_t value = 1; value < 60; ++value) { /* by hand, not in one step */
        send_fader(value);
        scene_frames(&s, 2);
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
    }
    assert_true(scene_until(&s, has_learnt, jaw));
    assert_string_equal(trigger_of(&s, jaw)->channel, "cc.1");
    assert_true(trigger_of(&s, jaw)->follows);
    send_fader(32);
    await_strength(&s, jaw, 32.0 / 127.0);
    send_fader(127);
    await_strength(&s, jaw, 1.0);
    send_fader(0);
    await_strength(&s, jaw, 0.0);
    close_poses(&s);
}

static void latch_favourites_and_search(void **state)
{
    scene s;
    (void)state;
    open_poses(&s, false);
    pose_settings to = *pose_palette_settings(poses(&s));
    to.mode = POSE_LATCH;
    to.strength = 0.6;
    (void)snprintf(to.favourite[to.favourite_count++], POSE_NAME, "mouthFunnel");
    pose_palette_change(poses(&s), &to, "test");
    scene_frames(&s, 3);
    const ui_word *first = scene_word(&s, "Favourites");
    assert_non_null(first);
    assert_true(scene_word(&s, "Mouth funnel")->where.y < scene_word(&s, "Mouths")->where.y);
    scene_click_word(&s, "Mouth funnel");
    await_strength(&s, "mouthFunnel", 0.6);
    scene_click_word(&s, "Jaw open");
    await_strength(&s, "jawOpen", 0.6);
    scene_click_word(&s, "Mouth funnel");
    await_strength(&s, "mouthFunnel", 0.0);
    scene_do(&s, ACTION_NEUTRAL);
    await_strength(&s, "jawOpen", 0.0);
    scene_click_word(&s, "Search");
    scene_type(&s, "pucker");
    scene_frames(&s, 3);
    assert_non_null(scene_word(&s, "Mouth pucker"));
    assert_null(scene_word(&s, "Jaw open"));
    scene_look(&s, "poses_search");
    scene_check_words(&s);
    close_poses(&s);
}

static void a_face_without_poses_says_so(void **state)
{
    scene s;
    char head[512];
    (void)state;
    (void)snprintf(head, sizeof head, "%s/rigs/puppet/puppet.glb", SOURCE_DIR);
    const scene_options options = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .face = head, .mapping = ""};
    scene_open_with(&s, &options);
    scene_do(&s, ACTION_PANEL_POSES);
    scene_frames(&s, 5);
    assert_non_null(scene_word_with(&s, "has no poses"));
    error err = {""};
    assert_true(pose_palette_set(poses(&s), "jawOpen", 1.0, 0.1, &err) < 0);
    assert_non_null(strstr(err.text, "no poses"));
    close_poses(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_are_played_recorded_edited_and_exported),
        cmocka_unit_test(a_key_learnt_twice_plays_the_last_and_undo_brings_the_first_back),
        cmocka_unit_test(a_pad_that_is_unplugged_while_it_is_held_lets_its_pose_go),
        cmocka_unit_test(a_hit_shorter_than_a_frame_is_played),
        cmocka_unit_test(a_fader_is_followed),
        cmocka_unit_test(latch_favourites_and_search),
        cmocka_unit_test(a_face_without_poses_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
