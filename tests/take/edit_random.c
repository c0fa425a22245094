/* core/show/edit.h, history.h: whatever is done to a take, in whatever order, it stays a take, and
 * undo and redo lead back to it. Seeded: the same sequences every time. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

#include "show/own.h"

enum { SEQUENCES = 2500, SEQUENCES_LONG = 10000, LENGTH = 16 };

/* ---- any edit ---- */

static uint64_t random_next(uint64_t *seed)
{
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return *seed >> 33;
}

static uint32_t below(uint64_t *seed, uint32_t count)
{
    return (uint32_t)(random_next(seed) % count);
}

/* Mostly on a grid, so that ends meet; sometimes anywhere. */
static int64_t any_time(uint64_t *seed)
{
    if (below(seed, 8) == 0)
        return (int64_t)below(seed, 12000) * 1000003 - help_s;
    return (int64_t)below(seed, 24) * (help_s / 2) - help_s;
}

static uint32_t any_id(uint64_t *seed, const take *t)
{
    return 1 + below(seed, t->id_count + 1);
}

static uint32_t any_layer(uint64_t *seed, const take *t)
{
    return t->layer_count && below(seed, 10) ? t->layer[below(seed, t->layer_count)].id
                                             : any_id(seed, t);
}

static uint32_t any_clip(uint64_t *seed, const take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        const take_layer *layer = &t->layer[(i + below(seed, 4)) % t->layer_count];
        if (layer->clip_count)
            return layer->clip[below(seed, layer->clip_count)].id;
    }
    return any_id(seed, t);
}

static void any_material(uint64_t *seed, edit *e)
{
    e->performance = 1 + below(seed, 5);
    e->from_ns = 1000 * help_s;
    e->to_ns = e->from_ns + (1 + below(seed, 15)) * help_s;
    if (below(seed, 3))
        e->source_ns = below(seed, 5) * help_s;
}

static void any_span(uint64_t *seed, edit *e)
{
    e->in_ns = any_time(seed);
    e->out_ns = e->in_ns + (1 + below(seed, 8)) * help_s / 2;
    e->fade_ns = below(seed, 5) * 50 * help_ms;
}

static char any_own[2][TAKE_NAME] = {"mouth.*", "jaw.open"};

static void fill(uint64_t *seed, edit *e, const take *t)
{
    e->layer = any_layer(seed, t);
    e->clip = any_clip(seed, t);
    e->marker = below(seed, 4);
    e->place = below(seed, 4);
    e->number = 1 + below(seed, 99);
    e->rating = below(seed, 6);
    e->is_muted = below(seed, 2);
    e->is_solo = below(seed, 2);
    e->is_additive = below(seed, 2);
    e->is_drop = below(seed, 2);
    e->is_ripple = below(seed, 2);
    e->audio = 1 + below(seed, 3);
    e->at_ns = any_time(seed);
    e->length_ns = 1 + below(seed, 3000) * help_ms;
    e->offset_ns = any_time(seed) / 4;
    e->frame = below(seed, 100000);
    e->fps = below(seed, 2) ? 29.97 : 24.0 + below(seed, 30);
    e->gain = below(seed, 100) / 50.0;
    e->speed = 0.25 + below(seed, 16) / 4.0;
    e->smooth_s = below(seed, 10) / 100.0;
    memcpy(e->name, "name", 5);
    any_material(seed, e);
    any_span(seed, e);
    if (below(seed, 3)) {
        e->start_ns = any_time(seed);
        e->fade_in_ns = below(seed, 4) * 100 * help_ms;
    }
    if (below(seed, 3) || e->start_ns == EDIT_UNSAID) {
        e->end_ns = any_time(seed);
        e->fade_out_ns = below(seed, 4) * 100 * help_ms;
    }
    if (below(seed, 3) == 0 && t->layer_count) {
        e->layer_count = 1;
        e->layers[0] = t->layer[below(seed, t->layer_count)].id;
    }
}

static void any_lists(uint64_t *seed, edit *e, take_warp_point warp[2])
{
    warp[0] = (take_warp_point){any_time(seed), below(seed, 5) * help_s};
    warp[1] = (take_warp_point){warp[0].at_ns + (1 + below(seed, 8)) * help_s,
                                warp[0].source_ns + (1 + below(seed, 8)) * help_s};
    if (e->kind == EDIT_CLIP_CURVE || (e->kind == EDIT_CLIP_ADD && below(seed, 4) == 0)) {
        e->warp = warp;
        e->warp_count = 1 + below(seed, 2);
        e->source_ns = EDIT_UNSAID;
    }
    if (e->kind == EDIT_LAYER_OWN || e->kind == EDIT_LAYER_ADD ||
        (e->kind == EDIT_COMP && below(seed, 3) == 0)) {
        e->own = any_own;
        e->own_count = below(seed, 3);
    }
    if (e->kind == EDIT_COMP && e->own_count == 0)
        e->regions = 1 + below(seed, (1u << OWN_REGION_COUNT) - 1);
    if (e->kind == EDIT_COMP)
        e->name[0] = '\0';
}

/* Half of them make or move clips: what else there is to go wrong depends on them. */
static edit any_edit(uint64_t *seed, const take *t, take_warp_point warp[2])
{
    static const edit_kind often[] = {
        EDIT_CLIP_ADD,   EDIT_CLIP_SPLIT, EDIT_CLIP_TRIM,    EDIT_CLIP_MOVE, EDIT_CLIP_SPEED,
        EDIT_CLIP_CURVE, EDIT_RANGE_CUT,  EDIT_RANGE_INSERT, EDIT_PUNCH,     EDIT_COMP};
    edit e;
    edit_kind kind = (edit_kind)(1 + below(seed, EDIT_KIND_COUNT - 1));
    if (below(seed, 2))
        kind = often[below(seed, sizeof often / sizeof often[0])];
    edit_init(&e, kind);
    fill(seed, &e, t);
    any_lists(seed, &e, warp);
    if (kind == EDIT_MOUTH && below(seed, 4)) { /* all of its recording, as a voice's is */
        e.layer = below(seed, 2) ? e.layer : 0;
        e.start_ns = any_time(seed);
        e.end_ns = e.start_ns + e.to_ns - e.from_ns;
    }
    return e;
}

/* ---- what holds ---- */

static void require_voices(const take *t, uint64_t *seed)
{
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        take_voice voice[2];
        int64_t at_ns = any_time(seed);
        uint32_t count = take_at(voice, &t->layer[i], at_ns);
        double sum = 0.0;
        for (uint32_t k = 0; k < count; ++k) {
            assert_true(voice[k].source_ns >= 0 &&
                        voice[k].source_ns <= voice[k].clip->to_ns - voice[k].clip->from_ns);
            sum += voice[k].weight;
        }
        assert_true(sum >= 0.0 && sum <= 1.0 + 1e-12);
        assert_true(count < 2 || sum >= 1.0 - 1e-12);
    }
}

static void require_round_trip(const edit *e)
{
    char *text, *again;
    edit back;
    error err;
    if (edit_write(&text, e, &err) < 0 || edit_parse(&back, text, strlen(text), &err) < 0 ||
        edit_write(&again, &back, &err) < 0)
        fail_msg("%s", err.text);
    assert_string_equal(text, again);
    free(text);
    free(again);
    edit_finish(&back);
}

typedef struct tally {
    uint32_t applied[EDIT_KIND_COUNT], refused[EDIT_KIND_COUNT];
} tally;

static void one_step(history *h, uint64_t *seed, tally *counts)
{
    take_warp_point warp[2];
    error err = {""};
    edit e = any_edit(seed, history_take(h), warp);
    take before;
    assert_int_equal(take_copy(&before, history_take(h), NULL), MRT_OK);
    if (history_do(h, &e, &err) < 0) {
        ++counts->refused[e.kind];
        assert_true(err.text[0] != '\0' && strchr(err.text, '\n') == NULL);
        assert_true(help_same(history_take(h), &before));
    } else {
        ++counts->applied[e.kind];
        require_round_trip(&e);
        assert_true(history_words(h, history_head(h))[0] != '\0');
    }
    take_finish(&before);
    help_check(history_take(h));
    require_voices(history_take(h), seed);
}

static void go_back_and_forth(history *h, const take *start, uint64_t *seed)
{
    take end;
    int64_t count = history_head(h);
    assert_int_equal(take_copy(&end, history_take(h), NULL), MRT_OK);
    for (int64_t i = 0; i < count; ++i)
        assert_int_equal(history_undo(h, NULL), MRT_OK);
    assert_int_equal(history_undo(h, NULL), MRT_END);
    assert_true(help_same(history_take(h), start));
    for (int64_t i = 0; i < count; ++i)
        assert_int_equal(history_redo(h, NULL), MRT_OK);
    assert_true(help_same(history_take(h), &end));
    if (count && below(seed, 2))
        assert_int_equal(history_go(h, below(seed, (uint32_t)count + 1), NULL), MRT_OK);
    take_finish(&end);
}

/* Edits, all the way back and forth, some undone, other edits, all the way again, opened anew. */
static void one_sequence(uint64_t seed, tally *counts)
{
    help_list list = {.base_count = 0};
    help_list_base(&list, "{'op':'layer.add','name':'face'}");
    help_list_base(&list, "{'op':'clip.add','layer':1,'performance':1}");
    help_list_base(&list, "{'op':'take.fps','fps':29.97}");
    help_list_base(&list, "{'op':'marker.add','at_ns':2000m,'text':'two'}");
    help_list_base(&list, "{'op':'marker.add','at_ns':5000m,'text':'five'}");
    help_list_base(&list, "{'op':'audio.attach','audio':1,'offset_ns':20000m}");
    take bare = {.id = 1, .start_ns = 1000 * help_s, .duration_ns = 10 * help_s}, start;
    history_store store = help_store(&list);
    history *h, *anew;
    error err;
    assert_int_equal(history_open(&h, &bare, &store, &err), MRT_OK);
    assert_int_equal(take_copy(&start, history_take(h), NULL), MRT_OK);
    for (int half = 0; half < 2; ++half) {
        for (int i = 0; i < LENGTH / 2; ++i)
            one_step(h, &seed, counts);
        go_back_and_forth(h, &start, &seed);
    }
    assert_int_equal(history_open(&anew, &bare, &store, &err), MRT_OK);
    assert_true(help_same(history_take(anew), history_take(h)));
    for (int64_t n = 1; n <= history_last(h); ++n)
        assert_string_equal(history_words(anew, n), history_words(h, n));
    history_close(anew);
    history_close(h);
    take_finish(&start);
    help_list_finish(&list);
}

static void any_edits_keep_a_take_and_undo_leads_back(void **state)
{
    (void)state;
    tally counts = {{0}, {0}};
    const uint64_t sequences = getenv("MAROTTE_TEST_LONG") ? SEQUENCES_LONG : SEQUENCES;
    for (uint64_t i = 0; i < sequences; ++i)
        one_sequence(i, &counts);
    for (int kind = EDIT_NONE + 1; kind < EDIT_KIND_COUNT; ++kind) {
        printf("%-16s %6u applied %6u refused\n", edit_name((edit_kind)kind), counts.applied[kind],
               counts.refused[kind]);
        if (counts.applied[kind] < 100)
            fail_msg("%s was hardly ever applied", edit_name((edit_kind)kind));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_edits_keep_a_take_and_undo_leads_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
