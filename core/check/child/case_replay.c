/* Same take, same bits: again, beside another instance, after a reset, in another process. */
#include "check/child/play.h"
#include "check/child/random.h"
#include "check/child/tell.h"
#include "check/wire.h"

#include <inttypes.h>
#include <malloc.h>
#include <string.h>

enum { TAKE_FRAMES = 2000, RESETS = 6 };
static actor first, second, other;
static stream first_hands, second_hands, other_hands;
static uint64_t sums[TAKE_FRAMES];

/* New memory of the heap is not zero but this: what is read before it is written shows. */
static void soil(int with)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    (void)mallopt(M_PERTURB, with);
#else
    (void)with;
#endif
}

static bool open_soiled(actor *out, stream *out_hands, const examination *e, stream_kind kind,
                        uint64_t seed, int with)
{
    soil(with);
    return play_open(out, out_hands, e, kind, seed);
}

/* The first frame at which the take is not as in sums[]; TAKE_FRAMES: it is the same. */
static uint32_t compare_take(actor *mapping, stream *hands, actor *beside, stream *beside_hands)
{
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(mapping, hands, 1);
        if (beside)
            play_frames(beside, beside_hands, 1);
        if (actor_sum(mapping) != sums[i])
            return i;
    }
    return TAKE_FRAMES;
}

static bool judge_again(const examination *e)
{
    if (!open_soiled(&first, &first_hands, e, STREAM_RESTLESS, e->seed, 0x11))
        return false;
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(&first, &first_hands, 1);
        sums[i] = actor_sum(&first);
    }
    actor_close(&first);
    if (!open_soiled(&second, &second_hands, e, STREAM_RESTLESS, e->seed, 0xd3))
        return false;
    uint32_t at = compare_take(&second, &second_hands, NULL, NULL);
    actor_close(&second);
    if (at < TAKE_FRAMES)
        tell_failed(RULE_REPLAY_SAME,
                    "the same take through a new instance differs from frame %u on: it depends on "
                    "memory that was never written, on a variable that outlives the instance, on "
                    "time or on chance",
                    at);
    tell_ok(RULE_REPLAY_SAME, "%d frames", TAKE_FRAMES);
    return at == TAKE_FRAMES;
}

static void judge_beside(const examination *e)
{
    if (!open_soiled(&first, &first_hands, e, STREAM_RESTLESS, e->seed, 0x11) ||
        !open_soiled(&other, &other_hands, e, STREAM_WALK, e->seed + 7, 0xd3))
        return;
    uint32_t at = compare_take(&first, &first_hands, &other, &other_hands);
    if (at < TAKE_FRAMES)
        tell_failed(RULE_REPLAY_INSTANCES,
                    "the take differs from frame %u on when another instance performs beside it: "
                    "they share a variable",
                    at);
    tell_ok(RULE_REPLAY_INSTANCES, "%s", "");
    actor_close(&first);
    actor_close(&other);
}

/* False: nothing more can be judged. */
static bool judge_reset_after(const examination *e, stream_kind kind, uint64_t seed)
{
    if (!open_soiled(&first, &first_hands, e, kind, seed, 0x11))
        return false;
    play_frames(&first, &first_hands, PLAY_SPAN);
    tell_doing(RULE_COUNT, "%s, after reset()", stream_name(kind));
    actor_reset(&first);
    if (!open_soiled(&second, &second_hands, e, kind, seed + 1, 0x11) ||
        !stream_begin(&first_hands, kind, seed + 1, e->type))
        return false;
    bool is_same = play_same(&first, &first_hands, &second, &second_hands, TAKE_FRAMES,
                             RULE_REPLAY_RESET, "one that was reset, and a new one");
    actor_close(&first);
    actor_close(&second);
    return is_same;
}

static void judge_reset(const examination *e)
{
    for (uint64_t i = 0; i < RESETS; ++i)
        if (!judge_reset_after(e, i % 2 ? STREAM_WALK : STREAM_RESTLESS, e->seed + 3 + 11 * i))
            return;
    tell_ok(RULE_REPLAY_RESET, "%d times", RESETS);
}

void cases_replay(const examination *e)
{
    if (!judge_again(e))
        return;
    judge_beside(e);
    judge_reset(e);
}

void cases_sum(const examination *e)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    if (!play_open(&first, &first_hands, e, STREAM_RESTLESS, e->seed))
        return;
    for (uint32_t i = 0; i < TAKE_FRAMES; ++i) {
        play_frames(&first, &first_hands, 1);
        sum = (sum ^ actor_sum(&first)) * UINT64_C(0x100000001b3);
    }
    actor_close(&first);
    tell_fact(WIRE_SUM, "%016" PRIx64, sum);
}
