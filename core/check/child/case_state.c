/* State and resume: bytes out and back, nothing beside them, and nothing from elsewhere. */
#include "check/child/play.h"
#include "check/child/random.h"
#include "check/child/tell.h"
#include "check/child/watch.h"

#include <stdlib.h>
#include <string.h>

enum { SIZE_MAX_BYTES = 16 << 20, GUARD = 32, GUARD_BYTE = 0x5c, TRIES = 60 };
static actor first, second, third;
static stream first_hands, second_hands, third_hands;
static const size_t odd_sizes[] = {0, 1, 3, 8, 31, 200, 4096};
enum { ODD_SIZES = sizeof odd_sizes / sizeof *odd_sizes };

/* A pair of functions that save and load, of whichever interface. */
typedef struct store {
    size_t (*save)(mrt_plugin *self, void *out, size_t capacity);
    mrt_result (*load)(mrt_plugin *self, const void *bytes, size_t size);
    bool is_frame; /* [frame], else [main] */
    check_rule size_rule, refuses_rule, whole_rule;
    const char *name;
} store;

typedef struct kept {
    unsigned char *bytes; /* and GUARD more */
    size_t size;
} kept;

static size_t save(const store *s, actor *mapping, void *out, size_t capacity)
{
    tell_doing(RULE_COUNT, "save() of %s", s->name);
    watch_next();
    if (s->is_frame)
        actor_frame_enter();
    size_t size = s->save(mapping->self, out, capacity);
    if (s->is_frame)
        actor_frame_leave("save()");
    return size;
}

static mrt_result load(const store *s, actor *mapping, const void *bytes, size_t size)
{
    tell_doing(RULE_COUNT, "load() of %s with %zu bytes", s->name, size);
    watch_next();
    if (s->is_frame)
        actor_frame_enter();
    mrt_result result = s->load(mapping->self, bytes, size);
    if (s->is_frame)
        actor_frame_leave("load()");
    return result;
}

/* ---- sizes ---- */

static bool is_guarded(const unsigned char *at)
{
    for (int i = 0; i < GUARD; ++i)
        if (at[i] != GUARD_BYTE)
            return false;
    return true;
}

/* What the plugin says with that much room; false: it wrote beyond, or says another size. */
static bool judge_capacity(const store *s, actor *mapping, const kept *of, size_t capacity)
{
    memset(of->bytes, GUARD_BYTE, of->size + GUARD);
    size_t size = save(s, mapping, of->bytes, capacity);
    if (!is_guarded(of->bytes + capacity))
        tell_failed(s->size_rule, "save() wrote beyond its capacity of %zu bytes", capacity);
    else if (size != of->size)
        tell_failed(s->size_rule, "save() says %zu bytes with a capacity of %zu, and %zu with none",
                    size, capacity, of->size);
    else
        return true;
    return false;
}

/* Saved bytes; NULL bytes: there are none. */
static kept keep(const store *s, actor *mapping)
{
    kept out = {.size = save(s, mapping, NULL, 0)};
    if (out.size == 0)
        return out;
    if (out.size > SIZE_MAX_BYTES) {
        tell_failed(s->size_rule, "save() wants %zu bytes", out.size);
        return out;
    }
    out.bytes = malloc(out.size + GUARD);
    if (!out.bytes)
        return out;
    if (judge_capacity(s, mapping, &out, 0) && judge_capacity(s, mapping, &out, out.size - 1) &&
        judge_capacity(s, mapping, &out, out.size))
        return out;
    free(out.bytes);
    out.bytes = NULL;
    return out;
}

static bool is_same_kept(const kept *a, const kept *b)
{
    return a->size == b->size && memcmp(a->bytes, b->bytes, a->size) == 0;
}

/* ---- what is refused ---- */

/* False: it took them. */
static bool refuses(const store *s, actor *mapping, const void *bytes, size_t size,
                    const char *what)
{
    mrt_result result = load(s, mapping, bytes, size);
    if (result < 0)
        return true;
    tell_failed(s->refuses_rule, "load() took %zu bytes that are %s", size, what);
    return false;
}

static void judge_random(const store *s, actor *mapping, const kept *good, uint64_t seed)
{
    size_t capacity = good->size > 4096 ? good->size : 4096;
    unsigned char *bytes = malloc(capacity);
    for (int i = 0; bytes && i < TRIES; ++i) {
        size_t size = i % 2 ? good->size : odd_sizes[(size_t)i / 2 % ODD_SIZES];
        random_bytes(&seed, bytes, size);
        if (!refuses(s, mapping, bytes, size, size ? "random" : "none at all"))
            break;
    }
    free(bytes);
}

/* Cut short, and with a bit turned. */
static void judge_damaged(const store *s, actor *mapping, const kept *good, uint64_t seed)
{
    unsigned char *bytes = malloc(good->size);
    for (int i = 0; bytes && i < TRIES; ++i) {
        size_t size = random_below(&seed, (uint32_t)good->size);
        memcpy(bytes, good->bytes, good->size);
        if (!refuses(s, mapping, bytes, size, "cut short"))
            break;
        size_t at = random_below(&seed, (uint32_t)good->size);
        bytes[at] ^= (unsigned char)(1u << random_below(&seed, 8));
        if (!refuses(s, mapping, bytes, good->size, "damaged by one bit"))
            break;
    }
    free(bytes);
}

/* ---- state ---- */

static void judge_explained(const store *s, actor *mapping)
{
    static const char nonsense[] = "no state at all";
    uint32_t before = mapping->host.error_count;
    if (load(s, mapping, nonsense, sizeof nonsense) < 0 && mapping->host.error_count == before)
        tell_failed(RULE_RUN_EXPLAINED, "load() of %s refused bytes, and logged no error", s->name);
}

static void judge_state_round(const store *s, const kept *good)
{
    mrt_result result = load(s, &second, good->bytes, good->size);
    if (result < 0) {
        tell_failed(RULE_STATE_ROUND, "load() returned %d for what save() wrote", result);
        return;
    }
    kept again = keep(s, &second);
    if (again.bytes && !is_same_kept(&again, good))
        tell_failed(RULE_STATE_ROUND, "loaded and saved again its %zu bytes are others (%zu)",
                    good->size, again.size);
    else if (!again.bytes && !tell_has_failed(s->size_rule))
        tell_failed(RULE_STATE_ROUND, "after load() save() has nothing to say");
    free(again.bytes);
}

static void judge_state_unchanged(const store *s, const kept *before)
{
    kept after = keep(s, &first);
    if (after.bytes && !is_same_kept(&after, before))
        tell_failed(s->whole_rule, "after load() refused bytes save() gives others than before");
    free(after.bytes);
}

void cases_state(const examination *e)
{
    static const check_rule rules[] = {RULE_STATE_SIZE, RULE_STATE_ROUND, RULE_STATE_REFUSES,
                                       RULE_STATE_ALL_OR_NONE};
    const mrt_state *functions = types_interface(e->type, MRT_STATE);
    const store s = {functions->save,    functions->load,        false,      RULE_STATE_SIZE,
                     RULE_STATE_REFUSES, RULE_STATE_ALL_OR_NONE, "MRT_STATE"};
    if (!play_open(&first, &first_hands, e, STREAM_WALK, e->seed) ||
        !play_open(&second, &second_hands, e, STREAM_WALK, e->seed))
        return;
    play_frames(&first, &first_hands, PLAY_SPAN);
    kept good = keep(&s, &first);
    if (good.size == 0) {
        for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
            tell_skipped(rules[i], "save() has nothing to keep");
        return;
    }
    if (!good.bytes)
        return;
    judge_state_round(&s, &good);
    judge_random(&s, &first, &good, e->seed);
    if (!tell_has_failed(s.refuses_rule)) {
        judge_explained(&s, &first);
        judge_state_unchanged(&s, &good);
    }
    free(good.bytes);
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
}

/* ---- resume ---- */

enum { MOMENTS = 12 };
static const uint32_t moments[MOMENTS] = {0,    3,    41,   137,  307,  700, /* frames */
                                          1103, 1499, 2000, 2617, 3301, 4001};
static uint64_t sums[PLAY_SPAN]; /* of what nobody interrupted */
static stream then_hands;        /* at the moment */
static actor then;               /* the host's own part of it */

/* The first of the coming frames that is not as in sums[]; PLAY_SPAN: none. */
static uint32_t go_on(actor *mapping, stream *hands, const char *doing)
{
    tell_doing(RULE_COUNT, "%s, %s", stream_name(then_hands.kind), doing);
    for (uint32_t i = 0; i < PLAY_SPAN; ++i) {
        play_frames(mapping, hands, 1);
        if (actor_sum(mapping) != sums[i])
            return i;
    }
    return PLAY_SPAN;
}

/* As the stage takes a take up: a new instance, and the host's own part as it was. */
static bool open_loaded(const store *s, const examination *e, const kept *good)
{
    actor_close(&second);
    if (!play_open(&second, &second_hands, e, then_hands.kind, e->seed))
        return false;
    mrt_result result = load(s, &second, good->bytes, good->size);
    if (result < 0) {
        tell_failed(RULE_RESUME_SAME, "load() returned %d for what save() wrote", result);
        return false;
    }
    second_hands = then_hands;
    memcpy(&second.frame, &then.frame, sizeof then.frame);
    second.room.pull = then.room.pull;
    second.good = then.good;
    second.anchored = then.anchored;
    second.has_anchored = then.has_anchored;
    return true;
}

static void judge_resumed(const store *s, const examination *e, const kept *good, uint32_t moment)
{
    if (!open_loaded(s, e, good))
        return;
    uint32_t at = go_on(&second, &second_hands, "taken up");
    if (at < PLAY_SPAN) {
        tell_failed(RULE_RESUME_SAME,
                    "taken up at frame %u it goes on as before for %u frames, then differs", moment,
                    at);
        return;
    }
    if (!open_loaded(s, e, good))
        return;
    judge_random(s, &second, good, e->seed);
    judge_damaged(s, &second, good, e->seed);
    if (!tell_has_failed(s->refuses_rule) &&
        go_on(&second, &second_hands, "after load() refused") < PLAY_SPAN)
        tell_failed(s->whole_rule, "after load() refused bytes it does not go on as before");
}

/* False: nothing more can be judged. */
static bool judge_moment(const store *s, const examination *e, stream_kind kind, uint32_t moment)
{
    if (!play_open(&first, &first_hands, e, kind, e->seed) ||
        !play_open(&third, &third_hands, e, kind, e->seed))
        return false;
    play_frames(&first, &first_hands, moment);
    play_frames(&third, &third_hands, moment);
    for (uint32_t i = 0; i < PLAY_SPAN; ++i) {
        play_frames(&third, &third_hands, 1);
        sums[i] = actor_sum(&third);
    }
    then_hands = first_hands;
    then = first;
    kept good = keep(s, &first);
    bool can_go_on = good.bytes != NULL;
    if (good.size == 0)
        tell_skipped(RULE_RESUME_SAME, "save() had nothing to keep at frame %u", moment);
    if (can_go_on && go_on(&first, &first_hands, "after save()") < PLAY_SPAN) {
        tell_failed(RULE_RESUME_SILENT, "saved at frame %u it does not go on as one that was not",
                    moment);
        can_go_on = false;
    }
    if (can_go_on)
        judge_resumed(s, e, &good, moment);
    free(good.bytes);
    actor_close(&first);
    actor_close(&second);
    actor_close(&third);
    return can_go_on;
}

void cases_resume(const examination *e)
{
    static const check_rule rules[] = {RULE_RESUME_SIZE, RULE_RESUME_SAME, RULE_RESUME_SILENT,
                                       RULE_RESUME_REFUSES, RULE_RESUME_ALL_OR_NONE};
    const mrt_resume *functions = types_interface(e->type, MRT_RESUME);
    const store s = {functions->save,     functions->load,         true,        RULE_RESUME_SIZE,
                     RULE_RESUME_REFUSES, RULE_RESUME_ALL_OR_NONE, "MRT_RESUME"};
    for (int i = 0; i < MOMENTS; ++i)
        if (!judge_moment(&s, e, i % 2 ? STREAM_WALK : STREAM_RESTLESS, moments[i]))
            return;
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%d moments", MOMENTS);
}
