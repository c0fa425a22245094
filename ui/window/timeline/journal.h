/* window/timeline/journal.h - how much each input moved in the last half hour, as long as nobody
 * recorded: bins of a tenth of a second, written while the window looks, in memory that does not
 * grow. Leaves out drawing, and the journal itself (take/journal.h). Pure; time is any clock's that
 * does not go back. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_JOURNAL_H
#define MAROTTE_UI_WINDOW_TIMELINE_JOURNAL_H
#include <marotte/plugin.h>
#include <stdbool.h>

enum { JOURNAL_LANES = 9, JOURNAL_BINS = 18000 }; /* 30 min */
#define JOURNAL_BIN_NS 100000000LL

typedef struct timeline_journal timeline_journal;

timeline_journal *timeline_journal_create(void);       /* NULL: no memory */
void timeline_journal_destroy(timeline_journal *self); /* NULL is fine */
/* The newest sample of an input, seen at now_ns; its channels say what a whole movement is. of:
 * which input, whatever its place among them; the one that was not seen for longest makes room. */
void timeline_journal_note(timeline_journal *self, uint64_t of, int64_t now_ns,
                           const mrt_sample *sample, const mrt_channel *channel);
/* The greatest movement between two instants, 0..1: of a lane's channels, as a mean share of their
 * range in a tenth of a second, made visible. 0 where nothing is known. */
float timeline_journal_read(const timeline_journal *self, uint64_t of, int64_t from_ns,
                            int64_t to_ns);

/* Of a span that somebody swiped, in either direction, what can be kept: the journal reaches back
 * reach_ns, and what ends near now ends now. False: too short. */
bool timeline_keep_span(int64_t *io_from_ns, int64_t *io_to_ns, int64_t now_ns, int64_t reach_ns);

#endif
