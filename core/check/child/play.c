#include "check/child/play.h"
#include "check/child/tell.h"

bool play_open(actor *out, stream *out_hands, const examination *e, stream_kind kind, uint64_t seed)
{
    bool is_refused;
    tell_doing(RULE_COUNT, "activate() on %s", faces_name(FACE_USUAL));
    if (!actor_open(out, e->type, faces_of(FACE_USUAL), &is_refused))
        return false;
    tell_doing(RULE_COUNT, "%s", stream_name(kind));
    return stream_begin(out_hands, kind, seed, e->type);
}

void play_frames(actor *mapping, stream *hands, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        stream_next(hands, &mapping->frame);
        actor_step(mapping);
    }
}

bool play_same(actor *a, stream *a_hands, actor *b, stream *b_hands, uint32_t count,
               check_rule rule, const char *text)
{
    char what[400];
    for (uint32_t i = 0; i < count; ++i) {
        play_frames(a, a_hands, 1);
        play_frames(b, b_hands, 1);
        actor_difference(a, b, what, sizeof what);
        if (a->result != b->result)
            tell_failed(rule, "%s: frame %u: process() returns %d and %d", text, i, a->result,
                        b->result);
        else if (what[0])
            tell_failed(rule, "%s: frame %u: %s", text, i, what);
        else
            continue;
        return false;
    }
    return true;
}

void play_judged(void)
{
    static const check_rule rules[] = {
        RULE_MAPPING_RESULT,  RULE_MAPPING_MODE,   RULE_MAPPING_COUNT,    RULE_MAPPING_FINITE,
        RULE_MAPPING_REACH,   RULE_MAPPING_RADIUS, RULE_MAPPING_LEAK,     RULE_MAPPING_GATE,
        RULE_MAPPING_CONTACT, RULE_MAPPING_CONST,  RULE_MAPPING_OVERRUN,  RULE_MAPPING_HOLD,
        RULE_MAPPING_ANCHOR,  RULE_FRAME_HOST,     RULE_FRAME_ALLOCATION, RULE_FRAME_LOCK,
        RULE_FRAME_FILE,      RULE_FRAME_NETWORK,  RULE_FRAME_CLOCK,      RULE_FRAME_SLEEP,
        RULE_FRAME_PROCESS};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
}
