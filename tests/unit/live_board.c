/* Faces that are published: whoever takes only what is said to have changed has the whole face,
 * whenever he looks, whoever is shown. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "stage/live/live_board.h"
#include "unit/composer_scene.h"

enum { FRAMES = 200, DESKS = 2 };

typedef struct stand {
    fixture fixture[DESKS]; /* of one face: the hands', and a take's */
    live_board board;
    float *looked; /* positions, then normals: what changed was copied */
    stamps_reader seen;
    uint64_t copied, left; /* parts */
    int64_t now_ns;
} stand;

static double number(uint64_t *seed)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u); /* SplitMix64 (Steele, Lea, Flood 2014) */
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void begin(stand *s)
{
    error err = {""};
    *s = (stand){.now_ns = NS_PER_S};
    for (int i = 0; i < DESKS; ++i) {
        fixture_set_up(&s->fixture[i], "puppet");
        mrt_pull *pull = fixture_add_part(&s->fixture[i], 0, 0);
        fixture_hold_contact(&s->fixture[i], pull, "mouth.corner.l", 0.0f, 0.0f, 0.0f);
        fixture_hold_contact(&s->fixture[i], pull, "brow.inner.r", 0.0f, 0.0f, 0.0f);
    }
    scene_must(live_board_create(&s->board, s->fixture[0].composer, &err), &err);
    s->looked = calloc((size_t)s->board.vertex_count * 6, sizeof *s->looked);
    assert_non_null(s->looked);
}

static void end(stand *s)
{
    live_board_destroy(&s->board);
    for (int i = 0; i < DESKS; ++i)
        fixture_tear_down(&s->fixture[i]);
    free(s->looked);
}

static void perform(fixture *d, uint64_t *seed)
{
    mrt_pull *pull = &d->pull[0];
    if (number(seed) < 0.3)
        return; /* held */
    uint32_t which = number(seed) < 0.5;
    pull->vector[which].end.y += (float)(4.0 * number(seed) - 2.0);
    if (number(seed) < 0.2)
        pull->dof[0] = (float)(0.3 * number(seed));
    fixture_move(d);
}

static void perform_once(fixture *d)
{
    d->pull[0].vector[0].end.y += 5.0f;
    fixture_move(d);
    composer_draw(d->composer);
}

/* The whole face, straight from the composer, in the file's order. */
static void whole(const stand *s, composer *of, float *out)
{
    const points *p = face_shown(composer_face(of));
    const points_order *order = face_order(composer_face(of));
    const float *const at[3] = {p->x, p->y, p->z};
    for (uint32_t slot = 0; slot < order->count; ++slot)
        for (uint32_t axis = 0; axis < 3; ++axis) {
            size_t row = (size_t)3 * order->file_of_slot[slot] + axis;
            out[row] = at[axis][slot];
            out[(size_t)3 * s->board.vertex_count + row] =
                shading_normal(composer_shading(of), axis)[slot];
        }
}

static void look(stand *s)
{
    const live_view *view;
    if (!live_board_look(&s->board, &view))
        return;
    size_t floats = (size_t)3 * s->board.vertex_count;
    for (uint32_t part = 0; part < view->changed->count; ++part) {
        size_t first = (size_t)3 * LIVE_ROWS * part, size = 3 * LIVE_ROWS;
        size = first + size < floats ? size : floats - first;
        bool is_new = stamps_is_new(&s->seen, view->changed, part);
        s->copied += is_new;
        s->left += !is_new;
        if (!is_new)
            continue;
        memcpy(s->looked + first, view->position + first, size * sizeof(float));
        memcpy(s->looked + floats + first, view->normal + first, size * sizeof(float));
    }
    stamps_read(&s->seen, view->changed);
    assert_memory_equal(s->looked, view->position, floats * sizeof(float));
    assert_memory_equal(s->looked + floats, view->normal, floats * sizeof(float));
}

static void what_changed_is_all_that_is_missed(void **state)
{
    (void)state;
    static stand s;
    uint64_t seed = 3;
    begin(&s);
    float *expected = malloc((size_t)6 * s.board.vertex_count * sizeof *expected);
    uint32_t shown = 0;
    for (int i = 0; i < FRAMES; ++i) {
        if (number(&seed) < 0.04) { /* a take is shown, or the hands are again */
            shown = 1 - shown;
            if (number(&seed) < 0.6)
                live_board_ease(&s.board, s.now_ns);
        }
        fixture *d = &s.fixture[shown];
        perform(d, &seed);
        s.now_ns += 16 * NS_PER_MS;
        composer_draw(d->composer);
        const live_view *view = live_board_fill(&s.board, d->composer, s.now_ns);
        if (!live_board_is_easing(&s.board)) {
            whole(&s, d->composer, expected);
            assert_memory_equal(view->position, expected,
                                (size_t)6 * s.board.vertex_count * sizeof *expected);
        }
        live_board_publish(&s.board);
        if (number(&seed) < 0.6)
            look(&s);
    }
    assert_true(s.copied > 0 && s.left > s.copied / 4);
    free(expected);
    end(&s);
}

static void who_comes_from_another_board_misses_nothing(void **state)
{
    (void)state;
    static stand s, other;
    const live_view *view;
    begin(&s);
    begin(&other);
    for (int i = 0; i < 9; ++i) {
        live_board_fill(&s.board, s.fixture[0].composer, 0);
        live_board_publish(&s.board);
        look(&s);
    }
    composer_draw(other.fixture[0].composer);
    live_board_fill(&other.board, other.fixture[0].composer, 0);
    live_board_publish(&other.board);
    assert_true(live_board_look(&other.board, &view));
    for (uint32_t part = 0; part < view->changed->count; ++part)
        assert_true(stamps_is_new(&s.seen, view->changed, part));
    perform_once(&other.fixture[0]);
    live_board_fill(&other.board, other.fixture[0].composer, 0);
    live_board_publish(&other.board);
    live_board_ease_from(&s.board, &other.board, 0);
    live_board_fill(&s.board, s.fixture[0].composer, NS_PER_MS);
    live_board_publish(&s.board);
    look(&s);
    end(&s);
    end(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_changed_is_all_that_is_missed),
        cmocka_unit_test(who_comes_from_another_board_misses_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
