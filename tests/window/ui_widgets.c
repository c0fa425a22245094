/* The facade of the panels: what is pushed as events arrives at widgets, and what is drawn can be
 * read. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "draw/system_font.h"
#include "window/gui/window.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

typedef struct bench {
    window *window;
    ui *ui;
    /* what the panel holds */
    uint32_t clicks, rows, choice, tab, ends;
    bool check, is_open, is_asked, is_disabled;
    bool has_gone, has_another; /* who asks; a panel that comes later */
    double value;
    char text[64];
    ui_canvas canvas;
    uint32_t doubles;
    float released_x;
    double dt_s; /* 0: as the window says */
    bool was_released;
} bench;

static const char *const items[] = {"first", "second", "third"};
static const char *const kernels[] = {"C0", "C2", "C4"};
static const ui_range range = {0.0, 10.0, "mm", 1, false, 2.0};

static void draw_panel(bench *b)
{
    ui *on = b->ui;
    ui_panel_begin(on, "panel", (ui_rectangle){20, 20, 330, 640}, UI_GROUND_PANEL);
    ui_tabs(on, "tabs", items, 3, &b->tab);
    ui_disabled_begin(on, b->is_disabled);
    b->clicks += ui_button(on, "Press", UI_PLAIN);
    ui_disabled_end(on);
    ui_check(on, "Check", &b->check);
    ui_choice(on, "Kernel", 100, kernels, 3, &b->choice);
    ui_slider(on, "Gain", 100, &range, &b->value);
    b->ends += ui_input(on, "##name", "Name", b->text, sizeof b->text);
    ui_fact(on, "Rate", 100, UI_STYLE_NUMBER, "149.8 Hz");
    b->is_open = ui_section(on, "Section", false);
    b->rows += ui_row(on, "A row", false) == UI_ROW_CLICKED;
    ui_text_wrapped(on, UI_STYLE_DIM,
                    "Déjà vu — a text that is longer than its panel is wide, and so has lines "
                    "● ■ ▶ ★ “that” end where words end…");
    ui_canvas_begin(on, "canvas", 0, 100, &b->canvas);
    ui_draw_box(on, b->canvas.where, THEME_WELL, 4);
    ui_draw_text(on, b->canvas.where.x + 8, b->canvas.where.y + 8, UI_STYLE_LARGE, THEME_TEXT, 0,
                 "00:01:23.4");
    ui_canvas_end(on);
    b->was_released |= b->canvas.is_released;
    b->doubles += b->canvas.is_double_clicked;
    if (b->canvas.is_released)
        b->released_x = b->canvas.x;
    ui_panel_end(on);
    if (!b->has_gone && ui_dialog_begin(on, "ask", "Really?", 300)) {
        ui_text(on, UI_STYLE_BODY, "This is a question.");
        b->is_asked = true;
        if (ui_button(on, "Yes", UI_ACCENT))
            ui_dialog_close(on);
        ui_dialog_end(on);
    } else {
        b->is_asked = false;
    }
    if (b->has_another) {
        ui_panel_begin(on, "another", (ui_rectangle){360, 20, 200, 200}, UI_GROUND_PANEL);
        ui_text(on, UI_STYLE_BODY, "Another panel");
        ui_panel_end(on);
    }
}

static void frame(bench *b)
{
    ui_screen screen;
    assert_true(window_begin(b->window, b->ui, &screen));
    if (b->dt_s > 0.0)
        screen.dt_s = b->dt_s;
    ui_begin(b->ui, &screen);
    draw_panel(b);
    ui_end(b->ui);
    window_end(b->window, b->ui);
}

static void settle(bench *b)
{
    for (int i = 0; i < 2 || !ui_is_idle(b->ui); ++i)
        frame(b);
    frame(b);
}

static void push(bench *b, ui_event event)
{
    ui_push(b->ui, &event);
}

static void move(bench *b, float x, float y)
{
    push(b, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

static void button(bench *b, bool is_down)
{
    push(b, (ui_event){.kind = UI_EVENT_BUTTON, .is_down = is_down});
}

static void key(bench *b, uint32_t code)
{
    push(b, (ui_event){.kind = UI_EVENT_KEY, .code = code, .is_down = true});
    push(b, (ui_event){.kind = UI_EVENT_KEY, .code = code});
}

static const ui_word *word(bench *b, const char *text)
{
    const ui_word *words;
    const uint32_t count = ui_words(b->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, text) == 0)
            return &words[i];
    return NULL;
}

static void click_word(bench *b, const char *text)
{
    const ui_word *w = word(b, text);
    assert_non_null(w);
    move(b, w->where.x + 0.5f * w->where.width, w->where.y + 0.5f * w->where.height);
    button(b, true);
    button(b, false);
    settle(b);
}

static void type(bench *b, const char *text)
{
    for (; *text; ++text)
        push(b, (ui_event){.kind = UI_EVENT_TEXT, .code = (uint32_t)*text});
}

static void open_bench(bench *b, float scale)
{
    error err = {0};
    *b = (bench){.value = 5.0};
    const uint32_t width = (uint32_t)lroundf(800.0f * scale),
                   height = (uint32_t)lroundf(700.0f * scale);
    if (window_open_hidden(&b->window, width, height, scale, 1.0 / 60.0, &err) < 0) {
        print_message("SKIPPED: %s\n", err.text);
        skip();
    }
    window_hidden_put_away(b->window, true);
    assert_int_equal(ui_create(&b->ui, &err), MRT_OK);
    ui_note_words(b->ui, true);
    settle(b);
}

static void close_bench(bench *b)
{
    ui_destroy(b->ui);
    window_close(b->window);
}

static void each_widget_takes_a_click(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    click_word(&b, "Press");
    assert_int_equal(b.clicks, 1);
    click_word(&b, "Check");
    assert_true(b.check);
    click_word(&b, "second");
    assert_int_equal(b.tab, 1);
    click_word(&b, "Section");
    assert_true(b.is_open);
    click_word(&b, "A row");
    assert_int_equal(b.rows, 1);
    close_bench(&b);
}

static void a_tap_within_one_frame_is_a_click(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    const ui_word *w = word(&b, "Press");
    move(&b, w->where.x + 4, w->where.y + 4);
    for (int i = 0; i < 5; ++i) {
        button(&b, true);
        button(&b, false);
    }
    settle(&b);
    assert_int_equal(b.clicks, 5);
    close_bench(&b);
}

static void what_is_disabled_takes_no_click(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    b.is_disabled = true;
    settle(&b);
    click_word(&b, "Press");
    assert_int_equal(b.clicks, 0);
    close_bench(&b);
}

static void a_choice_is_made_in_its_list(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    const ui_word *label = word(&b, "Kernel");
    move(&b, label->where.x + 150, label->where.y + 5);
    button(&b, true);
    button(&b, false);
    settle(&b);
    click_word(&b, "C4");
    assert_int_equal(b.choice, 2);
    click_word(&b, "C4");
    assert_non_null(word(&b, "C2"));
    key(&b, UI_KEY_ESCAPE); /* closes the list, and no more */
    settle(&b);
    assert_null(word(&b, "C2"));
    assert_int_equal(b.choice, 2);
    close_bench(&b);
}

static void a_slider_is_dragged_typed_and_put_back(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    const ui_word *shown = word(&b, "5.0 mm");
    assert_non_null(shown);
    const float x = shown->where.x + 10, y = shown->where.y + 5;
    move(&b, x, y);
    button(&b, true);
    move(&b, x + 60, y);
    button(&b, false);
    settle(&b);
    assert_true(b.value > 6.0);
    for (int i = 0; i < 30; ++i)
        frame(&b);
    push(&b, (ui_event){.kind = UI_EVENT_KEY, .code = UI_KEY_CONTROL, .is_down = true});
    button(&b, true);
    button(&b, false);
    push(&b, (ui_event){.kind = UI_EVENT_KEY, .code = UI_KEY_CONTROL});
    settle(&b);
    assert_true(ui_is_typing(b.ui));
    key(&b, UI_KEY_BACKSPACE);
    type(&b, "3.5");
    key(&b, UI_KEY_ENTER);
    settle(&b);
    assert_float_equal(b.value, 3.5, 1e-9);
    for (int i = 0; i < 30; ++i)
        frame(&b);
    button(&b, true);
    button(&b, false);
    button(&b, true);
    button(&b, false);
    settle(&b);
    assert_float_equal(b.value, 2.0, 1e-9);
    close_bench(&b);
}

static void typing_ends_with_enter_and_takes_the_keys_meanwhile(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    click_word(&b, "Name");
    assert_true(ui_is_typing(b.ui));
    type(&b, "ab");
    key(&b, UI_KEY_BACKSPACE);
    type(&b, "c?");
    push(&b, (ui_event){.kind = UI_EVENT_KEY, .code = 'R', .is_down = true});
    for (int i = 0; i < 8; ++i) {
        frame(&b);
        assert_false(ui_pressed(b.ui, 'R', 0));
        assert_false(ui_pressed(b.ui, '/', UI_SHIFT));
    }
    push(&b, (ui_event){.kind = UI_EVENT_KEY, .code = 'R'});
    assert_int_equal(b.ends, 0);
    key(&b, UI_KEY_ENTER);
    settle(&b);
    assert_string_equal(b.text, "ac?");
    assert_int_equal(b.ends, 1);
    click_word(&b, "ac?");
    type(&b, "zz");
    key(&b, UI_KEY_ESCAPE);
    settle(&b);
    assert_string_equal(b.text, "ac?");
    assert_int_equal(b.ends, 1);
    close_bench(&b);
}

static uint32_t times_pressed(bench *b, uint32_t code, uint32_t modifiers)
{
    uint32_t times = 0;
    for (int i = 0; i < 12; ++i) {
        frame(b);
        times += ui_pressed(b->ui, code, modifiers);
    }
    return times;
}

static void chord(bench *b, uint32_t code)
{
    push(b, (ui_event){.kind = UI_EVENT_KEY, .code = UI_KEY_CONTROL, .is_down = true});
    key(b, code);
    push(b, (ui_event){.kind = UI_EVENT_KEY, .code = UI_KEY_CONTROL});
}

/* The text is kept before the key does what it does: what it does may put the field away. */
static void keys_that_write_nothing_end_the_text_and_do_what_they_do(void **state)
{
    (void)state;
    static const struct {
        uint32_t code, modifiers;
    } commands[] = {{UI_KEY_F1 + 1, 0},    {UI_KEY_F12, 0},   {UI_KEY_PAGE_UP, 0},
                    {UI_KEY_PAGE_DOWN, 0}, {'S', UI_CONTROL}, {'Q', UI_CONTROL}};
    bench b;
    open_bench(&b, 1.0f);
    for (uint32_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        click_word(&b, i == 0 ? "Name" : b.text);
        assert_true(ui_is_typing(b.ui));
        char letter[2] = {(char)('a' + i), '\0'};
        type(&b, letter);
        if (commands[i].modifiers)
            chord(&b, commands[i].code);
        else
            key(&b, commands[i].code);
        uint32_t times = 0;
        for (int k = 0; k < 12; ++k) {
            frame(&b);
            bool is_pressed = ui_pressed(b.ui, commands[i].code, commands[i].modifiers);
            times += is_pressed;
            if (is_pressed)
                assert_int_equal(b.ends, i + 1);
        }
        assert_int_equal(times, 1);
        assert_false(ui_is_typing(b.ui));
        assert_string_equal(b.text, letter);
    }
    close_bench(&b);
}

static void keys_that_a_text_uses_stay_with_it(void **state)
{
    (void)state;
    static const char used[] = "ACVXYZ";
    bench b;
    open_bench(&b, 1.0f);
    click_word(&b, "Name");
    type(&b, "word");
    settle(&b);
    for (const char *c = used; *c; ++c) {
        chord(&b, (uint32_t)*c);
        assert_int_equal(times_pressed(&b, (uint32_t)*c, UI_CONTROL), 0);
        assert_true(ui_is_typing(b.ui));
    }
    key(&b, UI_KEY_HOME);
    assert_int_equal(times_pressed(&b, UI_KEY_HOME, 0), 0);
    key(&b, UI_KEY_DELETE);
    assert_int_equal(times_pressed(&b, UI_KEY_DELETE, 0), 0);
    assert_true(ui_is_typing(b.ui));
    key(&b, UI_KEY_ESCAPE);
    assert_int_equal(times_pressed(&b, UI_KEY_ESCAPE, 0), 0);
    assert_false(ui_is_typing(b.ui));
    close_bench(&b);
}

static void ask(bench *b)
{
    ui_dialog_open(b->ui, "ask");
    settle(b);
    assert_true(b->is_asked);
}

static void a_question_keeps_the_keys_and_escape_closes_it(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    ask(&b);
    assert_non_null(word(&b, "This is a question."));
    push(&b, (ui_event){.kind = UI_EVENT_KEY, .code = 'R', .is_down = true});
    frame(&b);
    assert_false(ui_pressed(b.ui, 'R', 0));
    click_word(&b, "Yes");
    assert_false(b.is_asked);
    ask(&b);
    key(&b, UI_KEY_ESCAPE);
    settle(&b);
    assert_false(b.is_asked);
    close_bench(&b);
}

/* As the calibration of a glove that is unplugged. */
static void a_question_goes_with_whoever_asked_it(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    ask(&b);
    b.has_gone = true;
    settle(&b);
    assert_false(ui_has_dialog(b.ui));
    b.has_another = true;
    settle(&b);
    assert_non_null(word(&b, "Another panel"));
    click_word(&b, "Press");
    assert_int_equal(b.clicks, 1);
    b.has_gone = false;
    settle(&b);
    assert_false(b.is_asked);
    ask(&b);
    close_bench(&b);
}

static void a_panel_may_come_with_a_question(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    b.has_another = true;
    ask(&b);
    assert_non_null(word(&b, "Another panel"));
    close_bench(&b);
}

static void a_canvas_is_dragged_to_its_last_place(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 2.0f);
    const ui_rectangle where = b.canvas.where;
    move(&b, where.x + 10, where.y + 20);
    button(&b, true);
    move(&b, where.x + 50, where.y + 30);
    move(&b, where.x + 90, where.y + 30);
    button(&b, false);
    settle(&b);
    assert_true(b.was_released);
    assert_float_equal(b.released_x, 90.0f, 0.51f);
    close_bench(&b);
}

static float channel(uint32_t colour, uint32_t shift)
{
    const float s = (float)(colour >> shift & 0xffu) / 255.0f;
    return s <= 0.04045f ? s / 12.92f : powf((s + 0.055f) / 1.055f, 2.4f);
}

static float luminance(uint32_t colour)
{
    return 0.2126f * channel(colour, 24) + 0.7152f * channel(colour, 16) +
           0.0722f * channel(colour, 8);
}

static void words_do_not_overlap_and_can_be_read(bench *b)
{
    const ui_word *words;
    const uint32_t count = ui_words(b->ui, &words);
    assert_true(count > 12);
    for (uint32_t i = 0; i < count; ++i) {
        const ui_word *w = &words[i];
        assert_false(w->is_cut);
        assert_int_not_equal(w->ground, 0);
        const float ink = luminance(w->colour), ground = luminance(w->ground);
        const float contrast = (fmaxf(ink, ground) + 0.05f) / (fminf(ink, ground) + 0.05f);
        if (contrast < 4.5f)
            fail_msg("%s: contrast %.2f", w->text, (double)contrast);
        for (uint32_t k = 0; k < i; ++k) {
            const ui_rectangle p = w->where, q = words[k].where;
            if (p.x < q.x + q.width && q.x < p.x + p.width && p.y < q.y + q.height &&
                q.y < p.y + p.height)
                fail_msg("\"%s\" overlaps \"%s\"", w->text, words[k].text);
        }
    }
}

/* Half a second a picture, as Mesa draws on a busy machine. */
static void a_double_click_is_one_however_slowly_it_is_drawn(void **state)
{
    (void)state;
    static const double frames_s[] = {1.0 / 60.0, 0.2, 0.5};
    for (size_t i = 0; i < sizeof frames_s / sizeof frames_s[0]; ++i) {
        bench b;
        open_bench(&b, 1.0f);
        b.dt_s = frames_s[i];
        click_word(&b, "00:01:23.4");
        for (int k = 0; k < 40; ++k)
            frame(&b);
        assert_int_equal(b.doubles, 0);
        for (int k = 0; k < 2; ++k) {
            button(&b, true);
            button(&b, false);
        }
        settle(&b);
        assert_int_equal(b.doubles, 1);
        close_bench(&b);
    }
}

static void what_is_drawn_can_be_read_at_each_scale(void **state)
{
    (void)state;
    static const float scales[] = {1.0f, 1.5f, 2.0f};
    bench b;
    error err = {0};
    (void)mkdir(BUILD_DIR "/out", 0777);
    for (size_t i = 0; i < 3; ++i) {
        char path[256];
        open_bench(&b, scales[i]);
        words_do_not_overlap_and_can_be_read(&b);
        window_hidden_put_away(b.window, false);
        frame(&b);
        (void)snprintf(path, sizeof path, BUILD_DIR "/out/ui_widgets_%g.png", (double)scales[i]);
        assert_int_equal(window_picture(b.window, path, &err), MRT_OK);
        close_bench(&b);
    }
}

static void text_that_does_not_fit_ends_with_an_ellipsis(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    ui_screen screen;
    assert_true(window_begin(b.window, b.ui, &screen));
    ui_begin(b.ui, &screen);
    ui_panel_begin(b.ui, "narrow", (ui_rectangle){0, 0, 80, 60}, UI_GROUND_PANEL);
    ui_text(b.ui, UI_STYLE_BODY, "far too long for that");
    ui_panel_end(b.ui);
    ui_end(b.ui);
    const ui_word *words;
    assert_int_equal(ui_words(b.ui, &words), 1);
    assert_true(words[0].is_cut);
    assert_true(words[0].where.x + words[0].where.width <= 80.0f - 8.0f);
    close_bench(&b);
}

/* Dear ImGui would break lines behind any point. */
static void a_number_is_not_broken_in_two(void **state)
{
    (void)state;
    bench b;
    open_bench(&b, 1.0f);
    for (float width = 60.0f; width < 200.0f; width += 1.0f) {
        ui_screen screen;
        const ui_word *words;
        assert_true(window_begin(b.window, b.ui, &screen));
        ui_begin(b.ui, &screen);
        ui_panel_begin(b.ui, "narrow", (ui_rectangle){0, 0, width, 300}, UI_GROUND_PANEL);
        ui_text_wrapped(b.ui, UI_STYLE_BODY, "left and right: x = 0.25 mm");
        ui_panel_end(b.ui);
        ui_end(b.ui);
        window_end(b.window, b.ui);
        const uint32_t count = ui_words(b.ui, &words);
        uint32_t whole = 0;
        for (uint32_t i = 0; i < count; ++i)
            whole += strstr(words[i].text, "0.25") != NULL;
        assert_int_equal(whole, 1);
    }
    close_bench(&b);
}

static void draw_name(bench *b, const char *name)
{
    ui_screen screen;
    assert_true(window_begin(b->window, b->ui, &screen));
    ui_begin(b->ui, &screen);
    ui_panel_begin(b->ui, "names", (ui_rectangle){0, 0, 300, 60}, UI_GROUND_PANEL);
    ui_text(b->ui, UI_STYLE_BODY, name);
    ui_panel_end(b->ui);
    ui_end(b->ui);
    window_end(b->window, b->ui);
}

static float drawn_width(bench *b, const char *name)
{
    draw_name(b, name); /* asks for the characters */
    assert_true(ui_wanted_s(b->ui) == 0.0 || strchr(name, '?'));
    draw_name(b, name);
    const ui_word *w = word(b, name);
    assert_non_null(w);
    return w->where.width;
}

static void names_of_other_scripts_are_drawn(void **state)
{
    (void)state;
    static const struct {
        const char *script, *name;
        uint32_t first, count; /* its first character; how many */
    } names[] = {{"Greek", "\xcf\x8e\xcf\x81\xce\xb1", 0x3ce, 3},
                 {"Cyrillic", "\xd2\x90\xd0\xb0\xd0\xbd\xd0\xbe\xd0\xba", 0x490, 5},
                 {"Hebrew", "\xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d", 0x5e9, 4},
                 {"Arabic", "\xd8\xb3\xd9\x84\xd8\xa7\xd9\x85", 0x633, 4},
                 {"Chinese", "\xe6\xbc\xa2\xe5\xad\x97", 0x6f22, 2},
                 {"Japanese", "\xe4\xba\xba\xe5\xbd\xa2\xe5\x8a\x87", 0x4eba, 3},
                 {"Korean", "\xec\x9d\xb8\xed\x98\x95", 0xc778, 2},
                 {"Devanagari", "\xe0\xa4\xa8\xe0\xa4\xae\xe0\xa4\xa8", 0x928, 3}};
    system_fonts *fonts = system_fonts_create();
    assert_non_null(fonts);
    bench b;
    open_bench(&b, 1.0f);
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        if (!system_fonts_find(fonts, names[i].first).path) {
            print_message("SKIPPED: no font for %s\n", names[i].script);
            continue;
        }
        char unknown[8] = "????????";
        unknown[names[i].count] = '\0';
        assert_true(fabsf(drawn_width(&b, names[i].name) - drawn_width(&b, unknown)) > 0.5f);
    }
    draw_name(&b, names[0].name); /* is kept: no more frames are asked for */
    assert_true(ui_wanted_s(b.ui) > 0.0);
    close_bench(&b);
    system_fonts_destroy(fonts);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_widget_takes_a_click),
        cmocka_unit_test(a_tap_within_one_frame_is_a_click),
        cmocka_unit_test(what_is_disabled_takes_no_click),
        cmocka_unit_test(a_choice_is_made_in_its_list),
        cmocka_unit_test(a_slider_is_dragged_typed_and_put_back),
        cmocka_unit_test(typing_ends_with_enter_and_takes_the_keys_meanwhile),
        cmocka_unit_test(keys_that_write_nothing_end_the_text_and_do_what_they_do),
        cmocka_unit_test(keys_that_a_text_uses_stay_with_it),
        cmocka_unit_test(a_question_keeps_the_keys_and_escape_closes_it),
        cmocka_unit_test(a_question_goes_with_whoever_asked_it),
        cmocka_unit_test(a_panel_may_come_with_a_question),
        cmocka_unit_test(a_canvas_is_dragged_to_its_last_place),
        cmocka_unit_test(a_double_click_is_one_however_slowly_it_is_drawn),
        cmocka_unit_test(what_is_drawn_can_be_read_at_each_scale),
        cmocka_unit_test(text_that_does_not_fit_ends_with_an_ellipsis),
        cmocka_unit_test(a_number_is_not_broken_in_two),
        cmocka_unit_test(names_of_other_scripts_are_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
