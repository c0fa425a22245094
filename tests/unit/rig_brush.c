/* The brush of the rig panel on the puppet: it stays on its lip, both sides are alike, what is
 * erased comes back, what is undone is undone to the byte. mm. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "face/rig_edit.h"
#include "unit/brush_scene.h"

#include <math.h>
#include <unistd.h>

static char *text_of(const rig *r)
{
    error err = {""};
    char path[] = "/tmp/marotte_brush_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    (void)close(file);
    file_bytes bytes;
    must(rig_write(r, path, &err), &err);
    must(file_read(&bytes, path, 1 << 24, &err), &err);
    (void)unlink(path);
    char *text = strdup((const char *)bytes.data);
    file_bytes_finish(&bytes);
    return text;
}

static void assert_same_file(const rig *a, const rig *b)
{
    char *first = text_of(a), *second = text_of(b);
    assert_string_equal(first, second);
    free(first);
    free(second);
}

/* ---- the brush ---- */

static void a_stroke_over_the_lower_lip_leaves_the_upper_one_alone(void **state)
{
    (void)state;
    error err = {""};
    uint32_t lower = contact("lip.lower.mid"), upper = contact("lip.upper.mid");
    float *above = calloc(puppet.mesh.vertex_count, sizeof *above);
    assert_non_null(above);
    brush_begin(tool, &wide);
    must(brush_move(tool, upper, place_of(upper), &err), &err);
    memcpy(above, brush_touch(tool, BRUSH_HERE), puppet.mesh.vertex_count * sizeof *above);
    brush_begin(tool, &wide);
    must(brush_move(tool, lower, place_of(lower), &err), &err);
    const float *below = brush_touch(tool, BRUSH_HERE);
    double gap_mm = 0.0;
    for (int i = 0; i < 3; ++i)
        gap_mm += pow((double)place_of(upper)[i] - (double)place_of(lower)[i], 2.0);
    assert_true(sqrt(gap_mm) < wide.radius_mm); /* a ball would touch both */
    uint32_t touched = 0;
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
        touched += below[v] > 0.0f;
        assert_false(below[v] > 0.0f && above[v] > 0.0f);
    }
    assert_true(touched > 20);
    assert_true(below[lower] >= 1.0f);
    free(above);
}

static void a_dab_is_round_and_falls_off_smoothly(void **state)
{
    (void)state;
    error err = {""};
    uint32_t cheek = contact("cheek.l");
    brush_begin(tool, &wide);
    must(brush_move(tool, cheek, place_of(cheek), &err), &err);
    const float *touch = brush_touch(tool, BRUSH_HERE);
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
        double square = 0.0;
        for (int i = 0; i < 3; ++i)
            square += pow((double)place_of(v)[i] - (double)place_of(cheek)[i], 2.0);
        assert_true(touch[v] >= 0.0f && touch[v] <= 1.0f);
        if (sqrt(square) >= wide.radius_mm)
            assert_true(touch[v] <= 0.0f);
    }
    brush_shape hard = wide;
    hard.falloff = BRUSH_HARD;
    brush_begin(tool, &hard);
    must(brush_move(tool, cheek, place_of(cheek), &err), &err);
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v)
        assert_true(touch[v] <= 0.0f || touch[v] >= 1.0f);
}

static void what_lies_between_two_places_is_touched(void **state)
{
    (void)state;
    error err = {""};
    uint32_t from = contact("cheek.l"), to = contact("cheek.lower.l");
    const brush_shape thin = {.radius_mm = 5.0};
    brush_begin(tool, &thin);
    must(brush_move(tool, from, place_of(from), &err), &err);
    must(brush_move(tool, to, place_of(to), &err), &err);
    const float *touch = brush_touch(tool, BRUSH_HERE);
    const float *a = place_of(from), *b = place_of(to);
    double least = 1.0;
    for (int k = 0; k <= 10; ++k) { /* the strongest touch near each place of the way */
        double best = 0.0;
        for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
            double square = 0.0;
            for (int i = 0; i < 3; ++i)
                square += pow((double)place_of(v)[i] -
                                  ((double)a[i] + ((double)b[i] - (double)a[i]) * k / 10.0),
                              2.0);
            if (square < 36.0)
                best = fmax(best, (double)touch[v]);
        }
        least = fmin(least, best);
    }
    assert_true(least > 0.8);
}

static void strokes_on_both_sides_are_mirror_images(void **state)
{
    (void)state;
    brush_shape both = wide;
    both.sides = BRUSH_BOTH_SIDES;
    uint32_t lip = contact("lip.lower.side.l");
    rig after = painted(puppet.rig, &both, rides_on("jaw"), lip);
    uint32_t region = rig_edit_find_region(&after, "painted jaw");
    assert_true(region != RIG_NONE);
    uint8_t *value = calloc(puppet.mesh.vertex_count, 1);
    assert_non_null(value);
    rig_edit_values(value, &after, region, puppet.mesh.vertex_count);
    uint32_t count = 0;
    for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v) {
        if (value[v] == 0)
            continue;
        uint32_t image = brush_mirror_of(tool, v);
        assert_int_equal(value[image], value[v]);
        count += image != v;
    }
    assert_true(count > 40);
    assert_int_equal(value[contact("lip.lower.side.r")], 255);
    free(value);
    rig_destroy(&after);
}

static void a_bone_of_one_side_is_the_others_on_the_other_side(void **state)
{
    (void)state;
    brush_shape both = wide;
    both.sides = BRUSH_BOTH_SIDES;
    rig after = painted(puppet.rig, &both, rides_on("eye.l"), contact("cheek.l"));
    uint32_t left = rig_edit_find_region(&after, "painted eye.l");
    uint32_t right = rig_edit_find_region(&after, "painted eye.r");
    assert_true(left != RIG_NONE && right != RIG_NONE);
    assert_int_equal(after.region[right].bone, rig_find_bone(puppet.rig, "eye.r"));
    float *share = calloc(puppet.mesh.vertex_count, sizeof *share);
    assert_non_null(share);
    error err = {""};
    must(bind_select(share, &after.region[right].select, &puppet.mesh, &puppet.topology, &err),
         &err);
    assert_true(share[contact("cheek.r")] >= 1.0f);
    assert_true(share[contact("cheek.l")] <= 0.0f);
    free(share);
    rig_destroy(&after);
}

/* ---- inks ---- */

static void inks_of_bones_make_room_for_each_other(void **state)
{
    (void)state;
    uint32_t cheek = contact("cheek.l"), count = puppet.mesh.vertex_count;
    rig jaw = painted(puppet.rig, &wide, rides_on("jaw"), cheek);
    rig both = painted(&jaw, &wide, rides_on("skull"), cheek);
    uint8_t *of_jaw = calloc(count, 1), *of_skull = calloc(count, 1);
    assert_true(of_jaw && of_skull);
    rig_edit_values(of_jaw, &both, rig_edit_find_region(&both, "painted jaw"), count);
    rig_edit_values(of_skull, &both, rig_edit_find_region(&both, "painted skull"), count);
    assert_int_equal(of_skull[cheek], 255);
    assert_int_equal(of_jaw[cheek], 0);
    for (uint32_t v = 0; v < count; ++v)
        assert_true(of_jaw[v] + of_skull[v] <= 255);
    free(of_jaw);
    free(of_skull);
    rig_destroy(&jaw);
    rig_destroy(&both);
}

static void what_is_erased_is_as_before(void **state)
{
    (void)state;
    error err = {""};
    uint32_t cheek = contact("cheek.l");
    rig_stroke_ink eraser = {.ink = RIG_INK_ERASER, .strength = 1.0};
    brush_shape hard = wide;
    hard.falloff = BRUSH_HARD;
    rig jaw = painted(puppet.rig, &wide, rides_on("jaw"), cheek);
    rig erased = painted(&jaw, &hard, eraser, cheek);
    bind_marks before, after;
    must(bind_marks_create(&before, puppet.rig, &puppet.mesh, &puppet.topology, &err), &err);
    must(bind_marks_create(&after, &erased, &puppet.mesh, &puppet.topology, &err), &err);
    size_t count = puppet.mesh.vertex_count;
    assert_memory_equal(before.weight, after.weight,
                        count * puppet.rig->bone_count * sizeof *before.weight);
    assert_memory_equal(before.mobility, after.mobility, count * sizeof *before.mobility);
    bind_marks_destroy(&before);
    bind_marks_destroy(&after);
    rig_destroy(&jaw);
    rig_destroy(&erased);
}

static void painted_shares_are_the_weights(void **state)
{
    (void)state;
    error err = {""};
    uint32_t cheek = contact("cheek.l"), bone = rig_find_bone(puppet.rig, "jaw");
    rig_stroke_ink half = rides_on("jaw");
    half.strength = 0.5;
    rig after = painted(puppet.rig, &wide, half, cheek);
    bind_marks marks;
    must(bind_marks_create(&marks, &after, &puppet.mesh, &puppet.topology, &err), &err);
    float weight = marks.weight[(size_t)bone * puppet.mesh.vertex_count + cheek];
    assert_true(fabsf(weight - 128.0f / 255.0f) < 1e-6f);
    bind_marks_destroy(&marks);
    rig_destroy(&after);
}

static void still_and_rigid_say_all_or_nothing(void **state)
{
    (void)state;
    rig_stroke_ink still = {.ink = RIG_INK_STILL, .strength = 1.0};
    rig_stroke_ink hold = rides_on("skull");
    hold.ink = RIG_INK_RIGID;
    uint32_t cheek = contact("cheek.l");
    rig a = painted(puppet.rig, &wide, still, cheek);
    rig b = painted(&a, &wide, hold, cheek);
    uint32_t at = rig_edit_find_region(&b, "painted still");
    uint32_t rigid_at = rig_edit_find_region(&b, "rigid skull");
    assert_int_equal(b.region[at].select.kind, SELECT_VERTICES);
    assert_int_equal(b.region[rigid_at].select.kind, SELECT_VERTICES);
    assert_true(b.region[rigid_at].is_rigid);
    rig_destroy(&a);
    rig_destroy(&b);
}

static void only_regions_of_vertices_can_be_painted(void **state)
{
    (void)state;
    error err = {""};
    rig_stroke *stroke;
    rig_stroke_ink ink = {.ink = RIG_INK_REGION, .region = 0, .strength = 1.0};
    assert_true(rig_stroke_begin(&stroke, puppet.rig, puppet.mesh.vertex_count, &ink, NULL, &err) <
                0);
    assert_null(stroke);
    assert_non_null(strstr(err.text, "Make paintable"));
}

/* ---- files ---- */

static void paint_survives_writing_and_reading(void **state)
{
    (void)state;
    error err = {""};
    rig soft = painted(puppet.rig, &wide, rides_on("jaw"), contact("cheek.l"));
    rig again;
    char path[] = "/tmp/marotte_brush_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    (void)close(file);
    must(rig_write(&soft, path, &err), &err);
    must(rig_read_trusted(&again, path, &err), &err);
    (void)unlink(path);
    uint32_t a = rig_edit_find_region(&soft, "painted jaw"), count = puppet.mesh.vertex_count;
    uint32_t b = rig_edit_find_region(&again, "painted jaw");
    assert_int_equal(again.region[b].select.kind, SELECT_PAINTED);
    uint8_t *first = calloc(count, 1), *second = calloc(count, 1);
    assert_true(first && second);
    rig_edit_values(first, &soft, a, count);
    rig_edit_values(second, &again, b, count);
    assert_memory_equal(first, second, count);
    assert_same_file(&soft, &again);
    free(first);
    free(second);
    rig_destroy(&soft);
    rig_destroy(&again);
}

static void undo_gives_the_same_file(void **state)
{
    (void)state;
    error err = {""};
    rig first = copy_of(puppet.rig);
    rig_history *history;
    must(rig_history_create(&history, &first, &err), &err);
    char *before = text_of(rig_history_current(history));
    static const char *const at[] = {"cheek.l", "chin", "lip.lower.mid"};
    for (int i = 0; i < 3; ++i) {
        rig next = painted(rig_history_current(history), &wide, rides_on(i == 1 ? "skull" : "jaw"),
                           contact(at[i]));
        rig_history_push(history, &next);
    }
    char *after = text_of(rig_history_current(history));
    assert_true(strcmp(before, after) != 0);
    assert_true(rig_history_restore(history, 0));
    char *undone = text_of(rig_history_current(history));
    assert_string_equal(before, undone);
    assert_true(rig_history_restore(history, 3));
    char *redone = text_of(rig_history_current(history));
    assert_string_equal(after, redone);
    assert_false(rig_history_restore(history, 4));
    free(before);
    free(after);
    free(undone);
    free(redone);
    rig_history_destroy(history);
}

/* ---- how long it takes: said, not judged ---- */

static rig with_thirty_regions(void)
{
    error err = {""};
    rig r = copy_of(puppet.rig);
    uint8_t *value = calloc(puppet.mesh.vertex_count, 1);
    assert_non_null(value);
    for (uint32_t i = r.region_count; i < 30; ++i) {
        char name[32];
        uint32_t index;
        rig_edit_region_values says = {rig_find_bone(&r, "jaw"), false, 1.0, (double)NAN};
        (void)snprintf(name, sizeof name, "painted %u", i);
        must(rig_edit_add_region(&r, name, &says, &index, &err), &err);
        for (uint32_t v = 0; v < puppet.mesh.vertex_count; ++v)
            value[v] = (uint8_t)((v * 31u + i * 7u) % 200u);
        must(rig_edit_paint(&r, index, value, puppet.mesh.vertex_count, &err), &err);
    }
    free(value);
    return r;
}

static void a_rig_of_thirty_regions_is_painted(void **state)
{
    (void)state;
    error err = {""};
    rig r = with_thirty_regions();
    assert_int_equal(r.region_count, 30);
    brush_shape both = {.radius_mm = 20.0, .sides = BRUSH_BOTH_SIDES};
    rig_stroke_ink ink = rides_on("jaw");
    rig_stroke *stroke;
    int64_t began_ns = clock_now_ns();
    must(rig_stroke_begin(&stroke, &r, puppet.mesh.vertex_count, &ink, NULL, &err), &err);
    int64_t ready_ns = clock_now_ns();
    brush_begin(tool, &both);
    uint32_t from = contact("cheek.l"), to = contact("cheek.lower.l");
    int64_t longest_ns = 0;
    for (int step = 0; step < 60; ++step) {
        uint32_t vertex = step % 2 ? to : from;
        int64_t start_ns = clock_now_ns();
        must(brush_move(tool, vertex, place_of(vertex), &err), &err);
        rig_stroke_update(stroke, tool);
        int64_t took_ns = clock_now_ns() - start_ns;
        longest_ns = took_ns > longest_ns ? took_ns : longest_ns;
    }
    uint32_t changed;
    int64_t end_ns = clock_now_ns();
    must(rig_stroke_end(stroke, &r, &changed, &err), &err);
    print_message("begin %.2f ms, longest of 60 steps %.2f ms, end %.2f ms\n",
                  (double)(ready_ns - began_ns) * 1e-6, (double)longest_ns * 1e-6,
                  (double)(clock_now_ns() - end_ns) * 1e-6);
    assert_true(changed > 100);
    rig_stroke_destroy(stroke);
    rig_destroy(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stroke_over_the_lower_lip_leaves_the_upper_one_alone),
        cmocka_unit_test(a_dab_is_round_and_falls_off_smoothly),
        cmocka_unit_test(what_lies_between_two_places_is_touched),
        cmocka_unit_test(strokes_on_both_sides_are_mirror_images),
        cmocka_unit_test(a_bone_of_one_side_is_the_others_on_the_other_side),
        cmocka_unit_test(inks_of_bones_make_room_for_each_other),
        cmocka_unit_test(what_is_erased_is_as_before),
        cmocka_unit_test(painted_shares_are_the_weights),
        cmocka_unit_test(still_and_rigid_say_all_or_nothing),
        cmocka_unit_test(only_regions_of_vertices_can_be_painted),
        cmocka_unit_test(paint_survives_writing_and_reading),
        cmocka_unit_test(undo_gives_the_same_file),
        cmocka_unit_test(a_rig_of_thirty_regions_is_painted),
    };
    return cmocka_run_group_tests(tests, open_puppet, close_puppet);
}
