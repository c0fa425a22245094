/* check/child/play.h - what the cases of mappings share: performing a stretch of a stream. */
#ifndef MAROTTE_CHECK_CHILD_PLAY_H
#define MAROTTE_CHECK_CHILD_PLAY_H
#include "check/child/actor.h"
#include "check/child/cases.h"
#include "check/child/stream.h"
#include "check/rules.h"

enum { PLAY_SPAN = 500 };

/* On the usual face, with that stream. False: it could not be made; nothing to judge. */
bool play_open(actor *out, stream *out_hands, const examination *e, stream_kind kind,
               uint64_t seed);
void play_frames(actor *mapping, stream *hands, uint32_t count);
/* Both go on by that many frames, each with its own copy of the same stream. Fails `rule` at the
 * first difference: "TEXT: frame 12: vector 3 ends at ..."; false then. */
bool play_same(actor *a, stream *a_hands, actor *b, stream *b_hands, uint32_t count,
               check_rule rule, const char *text);
/* Tells that the rules of frames and pulls were judged. */
void play_judged(void);

#endif
