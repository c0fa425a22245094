/* Mappings: any face, any hands, a hundred thousand frames, in time. */
#include "check/child/play.h"
#include "check/child/random.h"
#include "check/child/tell.h"

#include <stdlib.h>
#include <time.h>

enum {
    WALK_FRAMES = 25000, /* four children walk: 100 000 */
    FACE_FRAMES = 600,
    HANDS_FRAMES = 3000,
    ENGAGE_FRAMES = 1500,
    ENGAGE_ROUNDS = 8,
    DEADLINE_FRAMES = 4000,
    DEADLINE_PASSES = 3
};
static actor mapping, fresh;
static stream hands, fresh_hands;

/* ---- faces ---- */

static bool perform_on(actor *self, stream *with, const examination *e, face_kind kind)
{
    tell_doing(RULE_COUNT, "%s, on %s", stream_name(STREAM_WALK), faces_name(kind));
    if (!stream_begin(with, STREAM_WALK, e->seed + 1, e->type))
        return false;
    play_frames(self, with, FACE_FRAMES);
    return true;
}

/* On the usual face it is as one that never had another. */
static void judge_return(const examination *e, face_kind from)
{
    bool is_refused;
    tell_doing(RULE_COUNT, "%s, after %s", stream_name(STREAM_WALK), faces_name(from));
    if (!actor_move(&mapping, faces_of(FACE_USUAL), &is_refused)) {
        if (is_refused)
            tell_failed(RULE_MAPPING_FACES, "after %s it refuses the usual face", faces_name(from));
        return;
    }
    actor_reset(&fresh);
    if (stream_begin(&hands, STREAM_WALK, e->seed + 2, e->type) &&
        stream_begin(&fresh_hands, STREAM_WALK, e->seed + 2, e->type))
        (void)play_same(&mapping, &hands, &fresh, &fresh_hands, PLAY_SPAN, RULE_MAPPING_FACES,
                        "something of the face before is left");
}

void cases_faces(const examination *e)
{
    bool is_refused;
    uint32_t refused_count = 0;
    if (!play_open(&mapping, &hands, e, STREAM_WALK, e->seed) ||
        !play_open(&fresh, &fresh_hands, e, STREAM_WALK, e->seed))
        return;
    for (int kind = FACE_USUAL; kind < FACE_KINDS; ++kind) {
        tell_doing(RULE_COUNT, "activate() on %s", faces_name((face_kind)kind));
        bool is_taken = actor_move(&mapping, faces_of((face_kind)kind), &is_refused);
        if (is_taken && !perform_on(&mapping, &hands, e, (face_kind)kind))
            return;
        refused_count += !is_taken;
        judge_return(e, (face_kind)kind);
        if (!mapping.face)
            return;
    }
    tell_ok(RULE_MAPPING_FACES, "%d faces, %u refused", FACE_KINDS, refused_count);
    actor_close(&mapping);
    actor_close(&fresh);
}

/* ---- hands ---- */

/* A mapping that is far too slow is told so by frame.deadline: it need not walk to the end. */
static const double budget_s = 6.0;

static bool has_time(void)
{
    return (double)clock() / CLOCKS_PER_SEC < budget_s;
}

static void walk(const examination *e, stream_kind kind, uint32_t frames)
{
    if (!play_open(&mapping, &hands, e, kind, e->seed))
        return;
    for (uint32_t i = 0; i < frames && has_time(); i += PLAY_SPAN)
        play_frames(&mapping, &hands, PLAY_SPAN);
    actor_close(&mapping);
}

void cases_walk(const examination *e)
{
    walk(e, STREAM_WALK, WALK_FRAMES);
    play_judged();
}

void cases_restless(const examination *e)
{
    walk(e, STREAM_RESTLESS, WALK_FRAMES);
    play_judged();
}

void cases_hands(const examination *e)
{
    walk(e, STREAM_EXTREMES, HANDS_FRAMES);
    walk(e, STREAM_ABSENT, HANDS_FRAMES);
    walk(e, STREAM_ONE_HAND, HANDS_FRAMES);
    play_judged();
}

/* ---- holds ---- */

/* A fiftieth of the face's largest extent is what a calm hand cannot do in a frame. */
static const double jump_in_faces = 0.02;

void cases_engage(const examination *e)
{
    uint32_t holds = 0;
    for (uint32_t round = 0; round < ENGAGE_ROUNDS; ++round) {
        if (!play_open(&mapping, &hands, e, STREAM_CALM, e->seed + round))
            return;
        if (round > 0)
            stream_shuffle_choices(&hands);
        mapping.max_jump_mm = jump_in_faces * mapping.reach_mm / 10.0;
        for (uint32_t i = 0; i < ENGAGE_FRAMES; ++i) {
            uint32_t before = mapping.good.anchor;
            play_frames(&mapping, &hands, 1);
            holds += mapping.good.anchor != before;
        }
        actor_close(&mapping);
    }
    tell_ok(RULE_MAPPING_JUMP, "%u holds", holds);
}

/* ---- in time ---- */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
static const double limit_us = 1000.0; /* this build is slow itself */
#else
static const double limit_us = 200.0;
#endif

static int by_size(const void *a, const void *b)
{
    int64_t x, y;
    x = *(const int64_t *)a;
    y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Of the processor time of process(). */
static double p99_us(const examination *e)
{
    static int64_t took_ns[DEADLINE_FRAMES];
    if (!play_open(&mapping, &hands, e, STREAM_RESTLESS, e->seed))
        return -1;
    mapping.is_measured = true;
    play_frames(&mapping, &hands, PLAY_SPAN); /* warms the caches up */
    for (uint32_t i = 0; i < DEADLINE_FRAMES; ++i) {
        play_frames(&mapping, &hands, 1);
        took_ns[i] = mapping.cpu_ns;
    }
    actor_close(&mapping);
    qsort(took_ns, DEADLINE_FRAMES, sizeof *took_ns, by_size);
    const size_t at = (size_t)DEADLINE_FRAMES * 99 / 100;
    return (double)took_ns[at] / 1e3;
}

/* A slow plugin is slow every time: the best of some passes does not blame it for others. */
void cases_deadline(const examination *e)
{
    double best_us = p99_us(e);
    for (int pass = 1; pass < DEADLINE_PASSES && best_us > limit_us; ++pass) {
        double us = p99_us(e);
        best_us = us < best_us ? us : best_us;
    }
    if (best_us < 0)
        return;
    if (best_us > limit_us)
        tell_failed(RULE_FRAME_DEADLINE, "p99 of process() is %.1f us in the best of %d passes",
                    best_us, DEADLINE_PASSES);
    tell_ok(RULE_FRAME_DEADLINE, "p99 %.1f us", best_us);
}
