/* The panel Hand, as a performer uses it: the card, the exercise, and two rounds of "Simon says"
 * that teach the real plugin a hand which differs from its table. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

/* The window has settings too. */
#define settings one_hand_settings
#include "faces.h"
#undef settings
#include "panel_stand.h"
#include "stage/mapping/taught.h"
#include "window/panels/hand_card.h"
#include "stage/perform/composer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The relaxed talk pose, rad, in sensor order. */
static const float talk[MRT_ANGLES] = {1.45f, 0.15f, 0.20f,  0.34f, 0.62f,  0.52f, 0.25f,  0.68f,
                                       0.60f, 0.3f,  -0.04f, 0.72f, 0.64f,  0.3f,  -0.05f, 0.70f,
                                       0.60f, 0.3f,  -0.04f, 0.12f, -0.08f, 0.0f};

typedef struct person {
    stand stand;
    face_file file;
    composer *composer;
    const mrt_mapping *functions;
    mrt_frame frame;
} person;

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* Time of the mapping goes on with the hand as it is; the stage shows what comes of it. */
static void perform(person *p, int frames)
{
    stand *s = &p->stand;
    for (int i = 0; i < frames; ++i) {
        p->frame.dt_s = p->frame.time_ns ? 0.01 : 0.0;
        p->frame.time_ns += 10 * 1000 * 1000;
        instance_latch(&s->mapping);
        p->frame.params = s->mapping.params;
        assert_true(p->functions->process(s->mapping.self, &p->frame, &s->view.pull) >= 0);
    }
    memcpy(s->view.hand, p->frame.hand, sizeof s->view.hand);
}

static void open_person(person *p, const char *mapping)
{
    error err = {""};
    const csrbf_settings of_rig = {0};
    stand *s = &p->stand;
    *p = (person){.frame = {.time_ns = 0}};
    must(face_file_read(&p->file, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    must(composer_create(&p->composer, &p->file, &of_rig, &err), &err);
    stand_open(s, &panel_hand, 1.0f);
    stand_plugin(s, "plugins/anchored");
    stand_plugin(s, "plugins/one_hand");
    s->file = &p->file;
    stand_face(s, &composer_mapped(p->composer)->about);
    stand_mapping(s, mapping);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        s->view.pull.dof[i] = NAN;
    p->functions = plugin_interface(s->mapping.type, MRT_MAPPING);
    must(instance_activate(&s->mapping, composer_mapped(p->composer), &err), &err);
    p->functions->reset(s->mapping.self);
}

static void show_hand(person *p)
{
    mrt_hand *hand = &p->frame.hand[MRT_RIGHT];
    hand->present = true;
    memcpy(hand->angle, talk, sizeof talk);
    perform(p, 30); /* neutral */
    stand_settle(&p->stand);
}

static void close_person(person *p)
{
    instance_deactivate(&p->stand.mapping);
    stand_close(&p->stand);
    composer_destroy(p->composer);
    face_file_destroy(&p->file);
}

/* The hand that this performer holds as a face: the table's, but a quarter further and three
 * degrees beside it in every joint. `off_deg`: of this answer. */
static void hold(person *p, const char *name, float off_deg)
{
    static const int sensor[JOINT_COUNT] = {3, 1, 2, 5, 8, -1, 11, 12, 15, 16, 4, 7, 0, 19};
    static const int spreads[] = {10, 14, 18};
    mrt_hand *hand = &p->frame.hand[MRT_RIGHT];
    float from[MRT_ANGLES], to[MRT_ANGLES];
    memcpy(from, hand->angle, sizeof from);
    memcpy(to, talk, sizeof to);
    for (int f = 0; f < FACE_COUNT; ++f) {
        if (strcmp(face_recipes[f].name, name) != 0)
            continue;
        const int first = half_first_joint[face_recipes[f].half],
                  end = half_first_joint[face_recipes[f].half + 1];
        for (int i = first; i < end; ++i) {
            const float deg = 1.25f * (float)posed_hands[DEVICE_JOINTS][f].deg[i] + 3.0f + off_deg;
            for (int k = 0; k < 3; ++k)
                if (i == JOINT_SPREAD)
                    to[spreads[k]] += 0.01745329f * deg;
                else if (k == 0)
                    to[sensor[i]] += 0.01745329f * deg;
        }
    }
    for (int n = 1; n <= 20; ++n) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            hand->angle[i] = from[i] + (to[i] - from[i]) * (float)n / 20.0f;
        perform(p, 1);
    }
    perform(p, 100); /* all that takes time has come to rest */
    for (int i = 0; i < 60; ++i)
        stand_frame(&p->stand);
}

/* ---- the card ---- */

static void the_card_says_what_each_part_does_and_lights_what_moves(void **state)
{
    (void)state;
    person p;
    stand *s = &p.stand;
    open_person(&p, "one_hand");
    stand_settle(s);
    assert_true(stand_shows(s, "No hand is tracked"));
    show_hand(&p);
    assert_false(stand_shows(s, "No hand is tracked"));
    assert_true(stand_shows(s, "Thumb down"));
    assert_true(stand_shows(s, "jaw opens"));
    stand_check_words(s, NULL);
    stand_picture(s, "panel_hand_card");
    const uint32_t dark = stand_word(s, "Thumb down")->colour;
    for (int i = 0; i < 12; ++i) {
        p.frame.hand[MRT_RIGHT].angle[3] += 0.04f;
        perform(&p, 1);
        stand_frame(s);
    }
    assert_int_not_equal(stand_word(s, "Thumb down")->colour, dark);
    assert_int_equal(stand_word(s, "Fingers spread")->colour, dark);
    stand_picture(s, "panel_hand_lit");
    stand_click(s, "Show on the stage");
    assert_true(s->looks.shows_card);
    close_person(&p);
}

static const mrt_card_line *lines_of(person *p, uint32_t *out_count)
{
    const mrt_hand_card *card = plugin_interface(p->stand.mapping.type, MRT_HAND_CARD);
    instance_latch(&p->stand.mapping);
    return card->lines(p->stand.mapping.params, NULL, MRT_RIGHT, out_count);
}

static void fist_of(float out_rad[MRT_ANGLES])
{
    static const int bent[] = {4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 17};
    memcpy(out_rad, talk, sizeof talk);
    for (size_t i = 0; i < sizeof bent / sizeof *bent; ++i)
        out_rad[bent[i]] = 1.5f;
}

/* In one column and in two; a relaxed hand, a fist, and hands at random. */
static void leaders_of_the_card_do_not_cross(void **state)
{
    (void)state;
    person p;
    uint32_t random = 7, most = 0;
    float level[32] = {0.0f}, angle_rad[MRT_ANGLES];
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM);
    open_person(&p, "one_hand");
    hand_card card = {
        .level = level, .skeleton = skeleton, .rest_rad = angle_rad, .angle_rad = angle_rad};
    card.line = lines_of(&p, &card.count);
    stand_settle(&p.stand);
    for (int n = 0; n < 300; ++n) {
        memcpy(angle_rad, talk, sizeof talk);
        if (n == 1)
            fist_of(angle_rad);
        for (int i = 0; i < 20 && n > 1; ++i) {
            random = random * 1664525u + 1013904223u;
            angle_rad[i] += 0.8f * ((float)(random >> 8) / 8388608.0f - 1.0f);
        }
        for (int wide = 0; wide < 2; ++wide) {
            const ui_rectangle where = {10.0f, 20.0f, wide ? 900.0f : 460.0f, 640.0f};
            const uint32_t crossings = hand_card_crossings(p.stand.ui, where, &card);
            if (n < 2)
                assert_int_equal(crossings, 0);
            most = crossings > most ? crossings : most;
        }
    }
    assert_int_equal(most, 0);
    hand_skeleton_destroy(skeleton);
    close_person(&p);
}

/* How high each line stands; 0: in several rows. */
static void heights_of_lines(person *p, float out_y[32])
{
    uint32_t count;
    const mrt_card_line *line = lines_of(p, &count);
    memset(out_y, 0, 32 * sizeof *out_y);
    for (uint32_t i = 0; i < count; ++i) {
        const ui_word *word = stand_word(&p->stand, line[i].hand);
        out_y[i] = word ? word->where.y : 0.0f;
    }
}

/* While a hand moves the lines keep their places. A fist that is held has them in another order. */
static void a_fist_that_is_held_orders_the_lines(void **state)
{
    (void)state;
    person p;
    float relaxed[32], now[32];
    open_person(&p, "one_hand");
    show_hand(&p);
    heights_of_lines(&p, relaxed);
    mrt_hand *hand = &p.frame.hand[MRT_RIGHT];
    fist_of(hand->angle);
    perform(&p, 1);
    for (int i = 0; i < 10; ++i)
        stand_frame(&p.stand);
    heights_of_lines(&p, now);
    assert_memory_equal(now, relaxed, sizeof now);
    for (int i = 0; i < 240; ++i)
        stand_frame(&p.stand);
    heights_of_lines(&p, now);
    assert_memory_not_equal(now, relaxed, sizeof now);
    stand_picture(&p.stand, "panel_hand_fist");
    close_person(&p);
}

static void a_mapping_without_a_card_says_so(void **state)
{
    (void)state;
    person p;
    open_person(&p, "anchored");
    stand_settle(&p.stand);
    assert_true(stand_shows(&p.stand, "Anchored has no hand card"));
    stand_check_words(&p.stand, NULL);
    close_person(&p);
}

/* ---- Simon says ---- */

/* The face that is asked for, as its name stands below the picture. */
static const char *asked_face(const stand *s)
{
    for (int i = 0; i < FACE_NAMES; ++i)
        if (stand_word(s, face_names[i]))
            return face_names[i];
    fail_msg("no face is asked for");
    return "";
}

static void answer(person *p, float off_deg)
{
    stand *s = &p->stand;
    const char *name = asked_face(s);
    hold(p, name, off_deg);
    const uint32_t before = s->step_count;
    stand_key(s, ' ');
    perform(p, 3);
    for (int i = 0; i < 30; ++i)
        stand_frame(s);
    if (s->step_count != before + 1)
        fail_msg("%s was not learned", name);
}

/* The hand performs, and "Simon says" waits for its first answer. */
static void begin_simon(person *p)
{
    open_person(p, "one_hand");
    show_hand(p);
    stand_click(&p->stand, "Simon says");
    stand_wait_for(&p->stand, "twelve faces");
    stand_key(&p->stand, ' ');
}

static void two_rounds_teach_the_mapping_and_faces_are_met(void **state)
{
    (void)state;
    static const char *const faces[] = {"PP",      "FF",    "aa",       "I",
                                        "O",       "U",     "smile",    "joy",
                                        "sadness", "anger", "surprise", "wink left"};
    static unsigned char first[TAUGHT_BYTES_MAX], now[TAUGHT_BYTES_MAX];
    person p;
    stand *s = &p.stand;
    begin_simon(&p);
    assert_true(s->looks.is_answering);
    assert_true(stand_shows(s, "Round 1, face 1 of 12"));
    assert_true(stand_shows(s, "Hold the hand pose for this face."));
    stand_check_words(s, NULL);
    stand_picture(s, "panel_hand_simon");
    (void)taught_save(&s->mapping, first, sizeof first);
    answer(&p, 0.0f);
    assert_true(stand_shows(s, "Round 1, face 2 of 12"));
    /* Undo asks for the same face again, redo does not. */
    const undo_change step = s->step[s->step_count - 1];
    assert_string_equal(step.words, "hand pose for PP");
    const size_t size = taught_save(&s->mapping, now, sizeof now);
    assert_memory_not_equal(now, first, size);
    (void)step.set(step.owner, step.before);
    stand_settle(s);
    assert_int_equal(taught_save(&s->mapping, now, sizeof now), size);
    assert_memory_equal(now, first, size);
    assert_true(stand_shows(s, "Round 1, face 1 of 12"));
    (void)step.set(step.owner, step.after);
    stand_settle(s);
    assert_true(stand_shows(s, "Round 1, face 2 of 12"));
    for (int i = 1; i < 12; ++i)
        answer(&p, 0.0f);
    assert_true(stand_shows(s, "Round 1 is over"));
    stand_picture(s, "panel_hand_round");
    stand_key(s, ' ');
    for (int i = 0; i < 12; ++i)
        answer(&p, i % 2 ? 1.0f : -1.0f);
    assert_true(stand_shows(s, "The mapping has learned your hand."));
    stand_picture(s, "panel_hand_learned");
    stand_key(s, ' '); /* Try it */
    stand_settle(s);
    stand_key(s, ' ');
    for (int i = 0; i < 12; ++i) {
        assert_non_null(stand_word(s, faces[i]));
        stand_picture(s, "panel_hand_say_it");
        hold(&p, faces[i], 0.0f);
        if (stand_word(s, faces[i])) {
            print_message("%s is not met\n", faces[i]);
            stand_key(s, ' ');
        }
    }
    stand_check_words(s, NULL);
    const char *met = NULL;
    const ui_word *words;
    for (uint32_t i = 0; i < ui_words(s->ui, &words); ++i)
        if (strstr(words[i].text, " of 22 done"))
            met = words[i].text;
    assert_non_null(met);
    print_message("%s\n", met);
    assert_true(atoi(met) >= 10);
    close_person(&p);
}

/* ---- presets ---- */

static void press(person *p, const char *button)
{
    const mrt_plugin_type *type = p->stand.mapping.type;
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (strcmp(type->params[i].name, button) == 0)
            instance_trigger(&p->stand.mapping, i);
    perform(p, 100);
}

static double pulls_apart(const mrt_pull *a, const mrt_pull *b)
{
    double most_mm = 0.0;
    assert_int_equal(a->count, b->count);
    for (uint32_t i = 0; i < a->count; ++i) {
        const mrt_vec3 x = a->vector[i].end, y = b->vector[i].end;
        most_mm = fmax(most_mm, fabs((double)(x.x - y.x)));
        most_mm = fmax(most_mm, fabs((double)(x.y - y.y)));
        most_mm = fmax(most_mm, fabs((double)(x.z - y.z)));
    }
    return most_mm;
}

/* Answers are given in one panel, and the other one keeps them as a preset. */
static void a_preset_brings_the_answers_of_simon_says_back(void **state)
{
    (void)state;
    static unsigned char answered[TAUGHT_BYTES_MAX], now[TAUGHT_BYTES_MAX];
    person p;
    stand *s = &p.stand;
    begin_simon(&p);
    for (int i = 0; i < 5; ++i)
        answer(&p, 0.0f);
    const size_t size = taught_save(&s->mapping, answered, sizeof answered);
    hold(&p, "U", 0.0f);
    const mrt_pull learned = s->view.pull;
    stand_change_panel(s, &panel_mapping);
    stand_settle(s);
    stand_click(s, "Save as\xe2\x80\xa6");
    stand_type(s, "my hand");
    stand_key(s, UI_KEY_ENTER);
    press(&p, "Forget all");
    assert_int_equal(taught_save(&s->mapping, now, sizeof now), size);
    assert_memory_not_equal(now, answered, size);
    assert_true(pulls_apart(&learned, &s->view.pull) > 1.0);
    stand_settle(s);
    stand_click(s, "Reload");
    perform(&p, 100);
    assert_int_equal(taught_save(&s->mapping, now, sizeof now), size);
    assert_memory_equal(now, answered, size);
    assert_true(pulls_apart(&learned, &s->view.pull) < 0.001);
    close_person(&p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_card_says_what_each_part_does_and_lights_what_moves),
        cmocka_unit_test(leaders_of_the_card_do_not_cross),
        cmocka_unit_test(a_fist_that_is_held_orders_the_lines),
        cmocka_unit_test(a_mapping_without_a_card_says_so),
        cmocka_unit_test(two_rounds_teach_the_mapping_and_faces_are_met),
        cmocka_unit_test(a_preset_brings_the_answers_of_simon_says_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
