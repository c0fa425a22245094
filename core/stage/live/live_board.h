/* live/live_board.h - publishes faces. The frame thread fills a buffer, [main] reads the newest
 * one, and neither waits for the other. Only changed vertices are written and reported. Made for
 * one face. */
#ifndef MAROTTE_STAGE_LIVE_BOARD_H
#define MAROTTE_STAGE_LIVE_BOARD_H
#include "base/slot.h"
#include "stage/live/live_view.h"
#include "stage/perform/composer.h"

/* Which changes of a composer's face are already copied. */
typedef struct live_taken {
    stamps_reader position, normal;
} live_taken;

typedef struct live_board {
    publish_slot slot;
    live_view view[3];
    float *rows[3];       /* for each buffer: positions, then normals; vertex_count by 3 */
    live_taken taken[3];  /* changes already copied to each buffer */
    stamps changed_in[3]; /* for each buffer: `changed` when it was filled, for the reader */
    live_taken noted;     /* changes already marked in `changed` */
    stamps changed;       /* groups of LIVE_ROWS vertices with changed positions or normals */
    uint32_t *first_part, *part; /* first_part[block]..first_part[block + 1]: indices in `part` of
                                    the groups with vertices of that block */
    uint32_t vertex_count;
    uint64_t number;
    _Atomic bool is_taken; /* [main] has read the newest buffer; also true before the first one */
    /* Last face, during the crossfade to another face. */
    float *from; /* same layout as rows */
    bool has_shown, is_easing;
    bool is_new; /* the filled face differs from the published one */
    int64_t eases_from_ns;
    uint32_t shown; /* last published buffer */
} live_board;

CHECKED mrt_result live_board_create(live_board *out, const composer *of, error *err);
void live_board_destroy(live_board *self); /* accepts a zeroed struct */

/* ---- [frame], or [main] before the thread starts ---- */

/* Returns the buffer to fill, with the composer's face copied into it. Each call before the next
 * publish returns the same buffer. now_ns: for the crossfade. */
live_view *live_board_fill(live_board *self, composer *of, int64_t now_ns);
/* Returns whether the filled face differs from the published one. */
bool live_board_is_new(const live_board *self);
/* Returns the published face. NULL: none yet. */
const live_view *live_board_published(const live_board *self);
void live_board_publish(live_board *self);
/* Publishes the same face for a later sample. Its number stays. */
void live_board_publish_again(live_board *self);
/* Starts a crossfade from the last published face to the next ones. */
void live_board_ease(live_board *self, int64_t now_ns);
/* Starts a crossfade from the face of another board. Ignored if the vertex counts differ. */
void live_board_ease_from(live_board *self, const live_board *other, int64_t now_ns);
bool live_board_is_easing(const live_board *self);
/* Returns whether [main] has read the newest face. */
bool live_board_is_taken(const live_board *self);

/* ---- [main] ---- */

bool live_board_look(live_board *self, const live_view **out);

#endif
