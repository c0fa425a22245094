/* stage/playback/sync.h - how late the mouth of a take is against its sound. The mouth's curve is
 * the jaw as performed. The voice's curve is the openness that the input `voice` measures in the
 * take's sound, on a virtual clock. Leaves out the edit that moves the mouth. sync_find is pure;
 * the rest is for any one thread that may read the show. */
#ifndef MAROTTE_STAGE_SYNC_H
#define MAROTTE_STAGE_SYNC_H
#include "show/edit.h"
#include "stage/playback/sequencer.h"

enum { SYNC_RATE = 100 }; /* values per second of a curve */
/* The longest span that is measured, and the largest offset that is found. */
static const int64_t SYNC_SPAN_NS = INT64_C(120000000000), SYNC_OFFSET_NS = 400000000;
/* What people do not notice (ITU-R BT.1359-1, detectability): the sound up to 45 ms before the
 * picture, so a mouth that is 45 ms late, or up to 125 ms after it, a mouth that is 125 ms early.
 */
static const int64_t SYNC_LATE_NS = 45000000, SYNC_EARLY_NS = 125000000;

typedef struct sync_offset {
    bool is_clear;
    int64_t late_ns;    /* > 0: the mouth moves later than the sound; < 0: earlier. Only if clear */
    double correlation; /* at that offset, -1..1 */
} sync_offset;

/* Finds the offset of two curves of `count` values. A curve that never moves gives no clear offset.
 */
void sync_find(sync_offset *out, const float *mouth, const float *voice, uint32_t count);

typedef struct sync_curves {
    int64_t from_ns; /* on the timeline, of the first values */
    uint32_t count;
    float *mouth; /* share of the range of jaw.open, 0..1 */
    float *voice; /* openness, 0..1 */
} sync_curves;

typedef struct sync_source {
    show *show;
    const plugin_list *plugins;
    log_queue *log;
    sequencer *sequencer; /* of this take; it is moved */
    const take *take;
    int64_t from_ns, to_ns; /* on the timeline; cut at SYNC_SPAN_NS */
    /* Called now and then with the share that is done, 0..1. Returning false cancels. */
    bool (*goes_on)(void *data, double part);
    void *data;
} sync_source;

/* Reads both curves. MRT_END: cancelled. One sentence says what a take lacks: sound, a jaw, motion
 * of the jaw, a voice in the sound. Finish the curves, whatever the result. */
CHECKED mrt_result sync_read(sync_curves *out, const sync_source *from, error *err);
void sync_curves_finish(sync_curves *self); /* accepts zeroed */

/* Writes the edits that move the layers of the mouth by -late_ns: those that are active and own
 * jaw.open. Returns their number, which may exceed `capacity`. */
uint32_t sync_edits(edit *out, uint32_t capacity, const take *t, int64_t late_ns);

/* Writes "The mouth is 34 ms late", or that there is no clear offset. */
typedef struct sync_words {
    char text[96];
} sync_words;
sync_words sync_describe(const sync_offset *of);

#endif
