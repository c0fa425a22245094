/* The panels in the whole window: a hand performs, each panel is opened, parameters are moved and
 * taken back, a finger is linked to a contact by a click on the face. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

#include "window/panels/panels.h"
#include "window/viewport/viewport.h"

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const action panels[] = {ACTION_PANEL_DEVICES, ACTION_PANEL_MAPPING, ACTION_PANEL_ENGINE,
                                ACTION_PANEL_LOG};
static const char *const panel_name[] = {"devices", "mapping", "engine", "log"};

static bool performs(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->sample_count > 30;
}

static void open_with_hand(scene *s, uint32_t width, uint32_t height, float scale,
                           const char *mapping, const char *hand)
{
    const scene_options options = {.width_px = width,
                                   .height_px = height,
                                   .scale = scale,
                                   .mapping = mapping,
                                   .inputs = &hand,
                                   .input_count = 1};
    scene_open_with(s, &options);
    assert_true(scene_until(s, performs, NULL));
    scene_let_cut(s, "demo_hand");
    scene_let_cut(s, "panel_swing");
}

static void each_panel_can_be_read_while_a_hand_performs(void **state)
{
    (void)state;
    static const uint32_t size[2][2] = {{1280, 720}, {2560, 1440}};
    for (int k = 0; k < 2; ++k) {
        scene s;
        open_with_hand(&s, size[k][0], size[k][1], (float)(k + 1), "one_hand", demo);
        for (size_t i = 0; i < sizeof panels / sizeof panels[0]; ++i) {
            char name[64];
            scene_do(&s, panels[i]);
            scene_frames(&s, 4);
            (void)snprintf(name, sizeof name, "panel_scene_%s_%dx", panel_name[i], k + 1);
            scene_look(&s, name);
            scene_check_words(&s);
        }
        scene_close(&s);
    }
}

static double value_of(const scene *s, const char *name)
{
    const instance *mapping = live_mapping(app_live(s->app));
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, name) == 0)
            return instance_value(mapping, i);
    fail_msg("no parameter \"%s\"", name);
    return 0.0;
}

static void a_parameter_that_was_dragged_is_undone_by_the_undo_key(void **state)
{
    (void)state;
    scene s;
    open_with_hand(&s, 1280, 720, 1.0f, "anchored", demo);
    scene_do(&s, ACTION_PANEL_MAPPING);
    scene_click_word(&s, "Find a parameter");
    scene_type(&s, "gain");
    scene_key(&s, UI_KEY_ENTER, 0);
    const ui_word *label = scene_word(&s, "Gain");
    assert_non_null(label);
    float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    double before = value_of(&s, "Gain");
    scene_drag(&s, x, y, x + 80.0f, y, 6);
    double after = value_of(&s, "Gain");
    assert_true(after > before + 0.2);
    scene_do(&s, ACTION_UNDO);
    assert_float_equal(value_of(&s, "Gain"), before, 1e-9);
    scene_do(&s, ACTION_REDO);
    assert_float_equal(value_of(&s, "Gain"), after, 1e-9);
    scene_close(&s);
}

/* ---- learn ---- */

static bool is_asked_to_click(scene *s, void *data)
{
    (void)data;
    return scene_word_with(s, "Now click") != NULL;
}

/* The middle finger alone swings, four times in 5 s. */
static void write_swing(const char *path)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("time_s,right.index.mpj,right.middle.mpj,right.middle.pij,right.ring.mpj\n", file);
    for (int i = 0; i < 500; ++i)
        fprintf(file, "%.2f,0.3,%.4f,%.4f,0.3\n", 0.01 * i, 0.5 + 0.4 * sin(0.05 * i),
                0.5 + 0.4 * sin(0.05 * i));
    fclose(file);
}

static bool is_over_contact(scene *s, float x, float y)
{
    scene_move(s, x, y);
    scene_settle(s);
    return viewport_stroke_now(app_viewport(s->app))->contact != 0;
}

/* Contacts have their names beside them. */
static bool find_near(scene *s, ui_rectangle name, float *out_x, float *out_y)
{
    const float middle = name.y + 0.5f * name.height;
    for (float away = 4.0f; away < 40.0f; away += 6.0f)
        for (int side = 0; side < 2; ++side) {
            *out_x = side == 0 ? name.x - away : name.x + name.width + away;
            *out_y = middle;
            if (is_over_contact(s, *out_x, *out_y))
                return true;
        }
    return false;
}

/* Where the pointer is over some contact. */
static bool find_contact(scene *s, float *out_x, float *out_y)
{
    const mrt_face *about = app_view(s->app)->about;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        const ui_word *word = scene_word(s, about->contacts[i].name);
        if (word && find_near(s, word->where, out_x, out_y))
            return true;
    }
    return false;
}

static void click_last_word(scene *s, const char *text)
{
    const ui_word *words, *last = NULL;
    const uint32_t count = ui_words(s->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            last = &words[i];
    assert_non_null(last);
    scene_click(s, last->where.x + 4.0f, last->where.y + 4.0f);
}

static uint32_t link_count(const scene *s)
{
    const instance *mapping = live_mapping(app_live(s->app));
    uint32_t count = 0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        count += strcmp(mapping->type->params[i].group, "Contacts") == 0 &&
                 instance_value(mapping, i) > 0.0;
    return count;
}

static void a_finger_is_linked_by_a_click_on_the_face(void **state)
{
    (void)state;
    scene s;
    float x = 0.0f, y = 0.0f;
    char path[] = "/tmp/panel_swing_XXXXXX", text[64];
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    write_swing(path);
    (void)snprintf(text, sizeof text, "log:%s,loop=1", path);
    open_with_hand(&s, 1280, 720, 1.0f, "anchored", text);
    assert_int_equal(unlink(path), 0);
    scene_do(&s, ACTION_PANEL_MAPPING);
    scene_click_word(&s, "Learn");
    click_last_word(&s, "Learn");
    assert_true(scene_until(&s, is_asked_to_click, NULL));
    assert_true(find_contact(&s, &x, &y));
    scene_look(&s, "panel_scene_learn");
    scene_check_words(&s);
    assert_int_equal(link_count(&s), 0);
    scene_click(&s, x, y);
    assert_int_equal(link_count(&s), 1);
    scene_do(&s, ACTION_UNDO);
    assert_int_equal(link_count(&s), 0);
    scene_do(&s, ACTION_REDO);
    assert_int_equal(link_count(&s), 1);
    scene_look(&s, "panel_scene_learnt");
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_panel_can_be_read_while_a_hand_performs),
        cmocka_unit_test(a_parameter_that_was_dragged_is_undone_by_the_undo_key),
        cmocka_unit_test(a_finger_is_linked_by_a_click_on_the_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
