/* The mapping panel, as a person sees and uses it: parameters, steps of undo, presets, pedals, and
 * learn mode. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"
#include "stage/mapping/taught.h"

#include <png.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const mrt_contact contact[3] = {
    {"brow.inner.l", "skull", {10, 200, 70}, {0, 0, 1}},
    {"mouth.corner.l", "skull", {25, 90, 65}, {0, 0, 1}},
    {"mouth.corner.r", "skull", {-25, 90, 65}, {0, 0, 1}},
};
static const mrt_face about = {
    .contacts = contact, .contact_count = 3, .low = {-75, 0, -75}, .high = {75, 300, 75}};

static void open_with(stand *s, const char *mapping, float scale)
{
    stand_open(s, &panel_mapping, scale);
    stand_plugin(s, "plugins/anchored");
    stand_plugin(s, "plugins/one_hand");
    stand_plugin(s, "plugins/poses");
    stand_face(s, &about);
    stand_mapping(s, mapping);
    stand_settle(s);
}

static uint32_t index_of(const stand *s, const char *name)
{
    const mrt_plugin_type *type = s->mapping.type;
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (strcmp(type->params[i].name, name) == 0)
            return i;
    fail_msg("no parameter \"%s\"", name);
    return 0;
}

static double value_of(const stand *s, const char *name)
{
    return instance_value(&s->mapping, index_of(s, name));
}

static void undo(stand *s)
{
    const undo_change *step = &s->step[--s->step_count];
    (void)step->set(step->owner, step->before);
    stand_settle(s);
}

static void redo(stand *s)
{
    const undo_change *step = &s->step[s->step_count++];
    (void)step->set(step->owner, step->after);
    stand_settle(s);
}

/* ---- choice ---- */

static void without_a_mapping_it_says_so(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "", 1.0f);
    assert_true(stand_shows(&s, "No mapping is active"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_mapping_none");
    stand_close(&s);
}

static void another_mapping_is_one_step_with_its_values(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored,gain=0.9", 1.0f);
    stand_click(&s, "Anchored");
    stand_picture(&s, "panel_mapping_choice");
    stand_click_last(&s, "One hand");
    assert_string_equal(s.mapping.type->id, "org.marotte.one_hand");
    assert_int_equal(s.step_count, 1);
    assert_string_equal(s.step[0].words, "mapping One hand");
    undo(&s);
    assert_string_equal(s.mapping.type->id, "org.marotte.anchored");
    assert_float_equal(value_of(&s, "Gain"), 0.9, 1e-9);
    redo(&s);
    assert_string_equal(s.mapping.type->id, "org.marotte.one_hand");
    stand_close(&s);
}

static void clay_is_kept_where_a_person_ticks_it(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    stand_click(&s, "Keep the clay");
    assert_true(s.keeps_clay);
    assert_float_equal(settings_number(s.settings, "stage.keeps_clay", 0.0), 1.0, 1e-9);
    stand_click(&s, "Keep the clay");
    assert_false(s.keeps_clay);
    stand_close(&s);
}

/* Takes of it play, and then the list shows it, chosen. */
static void a_replaced_mapping_is_listed_only_while_it_performs(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    stand_click(&s, "Anchored");
    assert_true(stand_shows(&s, "One hand"));
    assert_false(stand_shows(&s, "Poses"));
    stand_key(&s, UI_KEY_ESCAPE);
    stand_mapping(&s, "poses");
    stand_settle(&s);
    assert_true(stand_shows(&s, "Poses"));
    stand_close(&s);
}

static void a_refused_mapping_leaves_the_old_one_and_says_why(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    s.refusal = "a take is being recorded: stop it first";
    stand_click(&s, "Anchored");
    stand_click_last(&s, "One hand");
    assert_string_equal(s.mapping.type->id, "org.marotte.anchored");
    assert_int_equal(s.step_count, 0);
    assert_int_equal(news_list_count(s.news), 1);
    stand_close(&s);
}

/* ---- parameters ---- */

static void find(stand *s, const char *name)
{
    stand_click(s, "Find a parameter");
    stand_type(s, name);
    stand_key(s, UI_KEY_ENTER);
}

static void a_drag_of_a_slider_is_one_step(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    find(&s, "gain");
    const ui_word *label = stand_word(&s, "Gain");
    assert_non_null(label);
    float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    stand_drag(&s, x, y, x + 90.0f, y);
    assert_true(value_of(&s, "Gain") > 1.0);
    assert_int_equal(s.step_count, 1);
    assert_non_null(strstr(s.step[0].words, "Gain"));
    double after = value_of(&s, "Gain");
    undo(&s);
    assert_float_equal(value_of(&s, "Gain"), 0.6, 1e-9);
    redo(&s);
    assert_float_equal(value_of(&s, "Gain"), after, 1e-9);
    stand_close(&s);
}

static void changed_values_are_marked_and_reset_by_a_double_click(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored,gain=2", 1.0f);
    find(&s, "gain");
    const ui_word *label = stand_word(&s, "Gain \xe2\x80\xa2");
    assert_non_null(label);
    float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    static const ui_event press = {.kind = UI_EVENT_BUTTON, .is_down = true},
                          release = {.kind = UI_EVENT_BUTTON};
    const ui_event move = {.kind = UI_EVENT_MOVE, .x = x, .y = y};
    ui_push(s.ui, &move);
    for (int i = 0; i < 2; ++i) {
        ui_push(s.ui, &press);
        ui_push(s.ui, &release);
    }
    stand_settle(&s);
    assert_float_equal(value_of(&s, "Gain"), 0.6, 1e-9);
    assert_null(stand_word(&s, "Gain \xe2\x80\xa2"));
    stand_close(&s);
}

static void reset_all_is_one_step_and_leaves_links(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored,gain=2,size=120,right_index=2", 1.0f);
    stand_click(&s, "Reset all");
    assert_float_equal(value_of(&s, "Gain"), 0.6, 1e-9);
    assert_float_equal(value_of(&s, "Size"), 90.0, 1e-9);
    assert_float_equal(value_of(&s, "Right index"), 2.0, 1e-9);
    assert_int_equal(s.step_count, 1);
    undo(&s);
    assert_float_equal(value_of(&s, "Gain"), 2.0, 1e-9);
    assert_float_equal(value_of(&s, "Size"), 120.0, 1e-9);
    stand_close(&s);
}

static void a_button_presses_its_trigger(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    find(&s, "engage");
    stand_click(&s, "Engage");
    instance_latch(&s.mapping);
    assert_float_equal(s.mapping.params[index_of(&s, "Engage")], 1.0, 1e-9);
    instance_latch(&s.mapping);
    assert_float_equal(s.mapping.params[index_of(&s, "Engage")], 0.0, 1e-9);
    stand_close(&s);
}

static void many_parameters_are_folded_by_group(void **state)
{
    (void)state;
    static const float scales[] = {1.0f, 2.0f};
    for (int i = 0; i < 2; ++i) {
        stand s = {.input_count = 0};
        open_with(&s, "one_hand,intensity=120,jaw.gain=1", scales[i]);
        stand_check_words(&s, NULL);
        stand_picture(&s, i == 0 ? "panel_mapping_one_hand" : "panel_mapping_one_hand_2x");
        find(&s, "head");
        assert_true(stand_shows(&s, "Head gain"));
        stand_check_words(&s, NULL);
        stand_picture(&s, i == 0 ? "panel_mapping_find" : "panel_mapping_find_2x");
        stand_close(&s);
    }
}

/* ---- presets ---- */

static void a_preset_is_saved_used_and_deleted(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored,gain=2,size=120", 1.0f);
    stand_click(&s, "Save as\xe2\x80\xa6");
    stand_type(&s, "soft v1.2");
    stand_key(&s, UI_KEY_ENTER);
    assert_true(stand_shows(&s, "soft v1-2")); /* a name is one level of a key */
    stand_picture(&s, "panel_mapping_preset");
    stand_click(&s, "Reset all");
    assert_true(stand_shows(&s, "soft v1-2 (changed)"));
    stand_click(&s, "soft v1-2 (changed)");
    stand_click_last(&s, "soft v1-2");
    assert_float_equal(value_of(&s, "Gain"), 2.0, 1e-9);
    assert_float_equal(value_of(&s, "Size"), 120.0, 1e-9);
    assert_int_equal(s.step_count, 3); /* saved, reset, used */
    undo(&s);
    assert_float_equal(value_of(&s, "Gain"), 0.6, 1e-9);
    stand_click(&s, "Delete");
    assert_true(stand_shows(&s, "none saved"));
    stand_close(&s);
}

/* As a person holds a hand and presses the button, or Forget. */
static void hold_and_press(stand *s, const char *button)
{
    static mrt_frame frame;
    static mrt_pull pull;
    const mrt_mapping *functions = plugin_interface(s->mapping.type, MRT_MAPPING);
    frame.hand[MRT_RIGHT].present = true;
    for (int i = 0; i < MRT_ANGLES; ++i)
        frame.hand[MRT_RIGHT].angle[i] = 0.03f * (float)(i + 1);
    instance_trigger(&s->mapping, index_of(s, button));
    instance_latch(&s->mapping);
    frame.params = s->mapping.params;
    assert_true(functions->process(s->mapping.self, &frame, &pull) >= 0);
}

static size_t lessons_of(const stand *s, unsigned char out[TAUGHT_BYTES_MAX])
{
    size_t size = taught_save(&s->mapping, out, TAUGHT_BYTES_MAX);
    assert_true(size > 0);
    return size;
}

static bool news_say(stand *s, const char *words)
{
    for (uint32_t i = 0; i < news_list_count(s->news); ++i)
        if (strstr(news_list_at(s->news, i)->text, words))
            return true;
    return false;
}

/* How many pixels of the picture have a colour like the right hand. */
static uint32_t hand_pixels(stand *s, const char *name)
{
    char path[1024];
    uint32_t count = 0;
    png_image image = {.version = PNG_IMAGE_VERSION};
    error err = {""};
    stand_picture(s, name);
    (void)mkdir(BUILD_DIR "/out", 0777);
    (void)snprintf(path, sizeof path, "%s/out/%s.png", BUILD_DIR, name);
    if (window_picture(s->window, path, &err) < 0)
        fail_msg("%s", err.text);
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    for (size_t i = 0; i < (size_t)image.width * image.height; ++i) {
        const uint8_t *at = rgb + 3 * i;
        count += at[0] > 110 && at[0] > at[1] + 30 && abs(at[1] - at[2]) < 50; /* skin */
    }
    free(rgb);
    return count;
}

static void what_is_taught_is_drawn_as_a_hand_above_its_button(void **state)
{
    static unsigned char bytes[TAUGHT_BYTES_MAX];
    float fist[MRT_ANGLES], flat[MRT_ANGLES], none[MRT_ANGLES];
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    const uint32_t before = hand_pixels(&s, "panel_mapping_no_hands");
    stand_mapping(&s, "poses");
    stand_settle(&s);
    stand_check_words(&s, NULL);
    assert_true(hand_pixels(&s, "panel_mapping_hands") > before + 1000);
    const mrt_taught_poses *poses = plugin_interface(s.mapping.type, MRT_TAUGHT_POSES);
    assert_non_null(poses);
    const size_t size = taught_save(&s.mapping, bytes, sizeof bytes);
    const uint32_t fist_id = s.mapping.type->params[index_of(&s, "Teach frown")].id;
    const uint32_t flat_id = s.mapping.type->params[index_of(&s, "Teach smile")].id;
    const uint32_t amount_id = s.mapping.type->params[index_of(&s, "Amount")].id;
    assert_int_equal(poses->pose(bytes, size, fist_id, fist), MRT_OK);
    assert_int_equal(poses->pose(bytes, size, flat_id, flat), MRT_OK);
    assert_int_equal(poses->pose(bytes, size, amount_id, none), MRT_END);
    assert_true(fist[7] > flat[7] + 1.0f); /* the middle finger's knuckle */
    stand_close(&s);
}

/* One wrong click is taken back. */
static void what_was_taught_is_undone(void **state)
{
    static unsigned char shipped[TAUGHT_BYTES_MAX], taught[TAUGHT_BYTES_MAX], now[TAUGHT_BYTES_MAX];
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "poses", 1.0f);
    const mrt_mapping *functions = plugin_interface(s.mapping.type, MRT_MAPPING);
    assert_true(functions->activate(s.mapping.self, &about) >= 0);
    functions->reset(s.mapping.self);
    const size_t size = lessons_of(&s, shipped);
    stand_click(&s, "Teach smile");
    hold_and_press(&s, "Teach smile");
    assert_int_equal(lessons_of(&s, taught), size);
    assert_memory_not_equal(taught, shipped, size);
    for (int i = 0; i < 60 && s.step_count == 0; ++i)
        stand_frame(&s);
    assert_int_equal(s.step_count, 1);
    assert_non_null(strstr(s.step[0].words, "Teach smile"));
    assert_true(s.step[0].set(s.step[0].owner, s.step[0].before) >= 0);
    (void)lessons_of(&s, now);
    assert_memory_equal(now, shipped, size);
    assert_true(s.step[0].set(s.step[0].owner, s.step[0].after) >= 0);
    (void)lessons_of(&s, now);
    assert_memory_equal(now, taught, size);
    stand_close(&s);
}

static void a_preset_keeps_what_was_taught(void **state)
{
    (void)state;
    static unsigned char shipped[TAUGHT_BYTES_MAX], taught[TAUGHT_BYTES_MAX], now[TAUGHT_BYTES_MAX];
    stand s = {.input_count = 0};
    open_with(&s, "poses", 1.0f);
    const mrt_mapping *functions = plugin_interface(s.mapping.type, MRT_MAPPING);
    assert_true(functions->activate(s.mapping.self, &about) >= 0);
    functions->reset(s.mapping.self);
    size_t size = lessons_of(&s, shipped);
    assert_true(stand_shows(&s, "Teach frown")); /* what does not fit begins another line */
    stand_check_words(&s, NULL);
    hold_and_press(&s, "Teach smile");
    assert_int_equal(lessons_of(&s, taught), size);
    assert_memory_not_equal(taught, shipped, size);
    stand_click(&s, "Save as\xe2\x80\xa6");
    stand_type(&s, "my hand");
    stand_key(&s, UI_KEY_ENTER);
    hold_and_press(&s, "Forget");
    assert_int_equal(lessons_of(&s, now), size);
    assert_memory_equal(now, shipped, size);
    stand_settle(&s);
    stand_picture(&s, "panel_mapping_preset_taught");
    stand_click(&s, "Reload");
    assert_int_equal(lessons_of(&s, now), size);
    assert_memory_equal(now, taught, size);
    undo(&s);
    assert_int_equal(lessons_of(&s, now), size);
    assert_memory_equal(now, shipped, size);
    redo(&s);
    assert_int_equal(lessons_of(&s, now), size);
    assert_memory_equal(now, taught, size);
    /* Somebody else's file: it says what is wrong, and what was taught stays. */
    const uint32_t steps = s.step_count;
    settings_set_text(s.settings, "mapping.poses.preset.my hand", "amount=50,taught:00nonsense");
    stand_click(&s, "Reload");
    assert_float_equal(value_of(&s, "Amount"), 50.0, 1e-9);
    assert_true(news_say(&s, "damaged"));
    settings_set_text(s.settings, "mapping.poses.preset.my hand", "amount=50,taught:00112233");
    stand_click(&s, "Reload");
    assert_true(news_say(&s, "cannot restore the learned hand poses"));
    assert_int_equal(lessons_of(&s, now), size);
    assert_memory_equal(now, taught, size);
    assert_int_equal(s.step_count, steps + 1); /* the values, once */
    functions->deactivate(s.mapping.self);
    stand_close(&s);
}

static void a_preset_that_was_deleted_or_written_over_comes_back(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored,gain=2", 1.0f);
    stand_click(&s, "Save as\xe2\x80\xa6");
    stand_type(&s, "mine");
    stand_key(&s, UI_KEY_ENTER);
    assert_string_equal(s.step[s.step_count - 1].words, "preset 'mine' saved");
    stand_click(&s, "Reset all");
    stand_click(&s, "Save as\xe2\x80\xa6"); /* the same name: over it */
    stand_key(&s, UI_KEY_ENTER);
    assert_int_equal(s.step_count, 3);
    assert_true(stand_shows(&s, "mine"));
    undo(&s);
    stand_settle(&s);
    assert_true(stand_shows(&s, "mine (changed)")); /* it has the gain again that is reset */
    stand_click(&s, "Delete");
    assert_true(stand_shows(&s, "none saved"));
    assert_string_equal(s.step[s.step_count - 1].words, "preset 'mine' deleted");
    undo(&s);
    stand_settle(&s);
    stand_click(&s, "mine (changed)");
    stand_click_last(&s, "mine");
    assert_float_equal(value_of(&s, "Gain"), 2.0, 1e-9);
    stand_close(&s);
}

/* ---- pedals ---- */

static void pedals_say_what_they_do_and_how_far_they_are_down(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "one_hand", 1.0f);
    s.view.pedal[0] = 0.7f;
    settings_set_number(s.settings, "hands.rezero_pedal", 4);
    stand_click(&s, "Pedals");
    assert_non_null(stand_word(&s, "Re-zero"));
    assert_non_null(stand_word(&s, "not used") ? NULL : &s);
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_mapping_pedals");
    stand_click(&s, "Pedal 2"); /* of Hold */
    stand_click_last(&s, "Pedal 1");
    assert_float_equal(value_of(&s, "Hold pedal"), 1.0, 1e-9);
    assert_non_null(stand_word(&s, "Anchor, Hold"));
    assert_int_equal(s.step_count, 1);
    stand_close(&s);
}

/* ---- learn ---- */

static void move_finger(stand *s, int mpj, double seconds)
{
    for (int i = 0; i < (int)(seconds * 60.0); ++i) {
        double t = (double)i / 60.0;
        s->view.hand[MRT_RIGHT].angle[mpj] = (float)(0.4 + 0.5 * sin(6.0 * t));
        stand_frame(s);
    }
}

static void a_finger_is_moved_and_a_contact_clicked(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    s.view.hand[MRT_RIGHT].present = true;
    stand_click(&s, "Learn"); /* the tab */
    stand_click_last(&s, "Learn");
    assert_true(stand_shows(&s, "Move one finger."));
    assert_int_equal(s.use, VIEWPORT_PICKS);
    assert_true(s.looks.shows_contacts);
    move_finger(&s, 7, 1.2);
    assert_true(stand_shows(&s, "Now click a"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_mapping_learn");
    s.stroke = (viewport_stroke){.is_on_face = true, .is_pressed = true};
    stand_frame(&s);
    s.stroke.is_pressed = false;
    stand_settle(&s);
    assert_true(stand_shows(&s, "No contact at this point"));
    s.stroke = (viewport_stroke){.is_on_face = true, .is_pressed = true, .contact = 3};
    stand_frame(&s);
    s.stroke.is_pressed = false;
    stand_settle(&s);
    assert_float_equal(value_of(&s, "Right middle"), 3.0, 1e-9);
    assert_true(stand_shows(&s, "mouth.corner.r"));
    assert_int_equal(s.step_count, 1);
    stand_click(&s, "Done");
    assert_int_equal(s.use, VIEWPORT_PERFORMS);
    assert_false(s.looks.shows_contacts);
    stand_picture(&s, "panel_mapping_links");
    stand_click(&s, "Remove");
    assert_float_equal(value_of(&s, "Right middle"), 0.0, 1e-9);
    undo(&s);
    assert_float_equal(value_of(&s, "Right middle"), 3.0, 1e-9);
    stand_close(&s);
}

static void learning_ends_when_the_panel_is_left(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "anchored", 1.0f);
    stand_click(&s, "Learn");
    stand_click_last(&s, "Learn");
    assert_int_equal(s.use, VIEWPORT_PICKS);
    stand_click(&s, "Parameters");
    assert_int_equal(s.use, VIEWPORT_PERFORMS);
    stand_close(&s);
}

static void a_mapping_that_links_nothing_offers_one_that_does(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, "one_hand", 1.0f);
    stand_click(&s, "Learn");
    stand_picture(&s, "panel_mapping_cannot_learn");
    stand_click(&s, "Switch to Anchored");
    assert_string_equal(s.mapping.type->id, "org.marotte.anchored");
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_mapping_it_says_so),
        cmocka_unit_test(a_replaced_mapping_is_listed_only_while_it_performs),
        cmocka_unit_test(clay_is_kept_where_a_person_ticks_it),
        cmocka_unit_test(another_mapping_is_one_step_with_its_values),
        cmocka_unit_test(a_refused_mapping_leaves_the_old_one_and_says_why),
        cmocka_unit_test(a_drag_of_a_slider_is_one_step),
        cmocka_unit_test(changed_values_are_marked_and_reset_by_a_double_click),
        cmocka_unit_test(reset_all_is_one_step_and_leaves_links),
        cmocka_unit_test(a_button_presses_its_trigger),
        cmocka_unit_test(many_parameters_are_folded_by_group),
        cmocka_unit_test(a_preset_is_saved_used_and_deleted),
        cmocka_unit_test(what_is_taught_is_drawn_as_a_hand_above_its_button),
        cmocka_unit_test(what_was_taught_is_undone),
        cmocka_unit_test(a_preset_keeps_what_was_taught),
        cmocka_unit_test(a_preset_that_was_deleted_or_written_over_comes_back),
        cmocka_unit_test(pedals_say_what_they_do_and_how_far_they_are_down),
        cmocka_unit_test(a_finger_is_moved_and_a_contact_clicked),
        cmocka_unit_test(learning_ends_when_the_panel_is_left),
        cmocka_unit_test(a_mapping_that_links_nothing_offers_one_that_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
