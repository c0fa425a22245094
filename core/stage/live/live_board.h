/* live/live_board.h - where faces are published: the frame thread fills, [main] takes the newest,
 * and neither waits. Only what has changed is written, into the buffers and for those who look.
 * Made for one face. */
#ifndef MAROTTE_STAGE_LIVE_BOARD_H
#define MAROTTE_STAGE_LIVE_BOARD_H
#include "base/slot.h"
#include "stage/live/live_view.h"
#include "stage/perform/composer.h"

/* What of a composer's face has been taken over. */
typedef struct live_taken {
    stamps_reader position, normal;
} live_taken;

typedef struct live_board {
    publish_slot slot;
    live_view view[3];
    float *rows[3];              /* of each: positions, then normals: vertex_count by 3 */
    live_taken taken[3];         /* into each */
    stamps changed_in[3];        /* of each: `changed` as it was filled, for the one who looks */
    live_taken noted;            /* in `changed` */
    stamps changed;              /* of LIVE_ROWS vertices each, positions and normals alike */
    uint32_t *first_part, *part; /* of each block of the face, and the end: where its parts begin;
                                    the parts of `changed` that it has vertices in */
    uint32_t vertex_count;
    uint64_t number;
    _Atomic bool is_taken; /* the newest was; also before any */
    /* While what is shown is another face than before: eased from it. */
    float *from; /* as rows */
    bool has_shown, is_easing;
    bool is_new; /* the filled face differs from the published one */
    int64_t eases_from_ns;
    uint32_t shown; /* the buffer published last */
} live_board;

CHECKED mrt_result live_board_create(live_board *out, const composer *of, error *err);
void live_board_destroy(live_board *self); /* zeroed is fine */

/* ---- [frame], or [main] before it starts ---- */

/* The buffer to fill, again and again until it is published: what the composer shows is in it,
 * drawn. now_ns: for easing. */
live_view *live_board_fill(live_board *self, composer *of, int64_t now_ns);
/* The filled face differs from the published one. */
bool live_board_is_new(const live_board *self);
/* The published face; NULL: none yet. */
const live_view *live_board_published(const live_board *self);
void live_board_publish(live_board *self);
/* Publishes the same face for a later sample: its number stays. */
void live_board_publish_again(live_board *self);
/* From the next face on it eases over from the last one. */
void live_board_ease(live_board *self, int64_t now_ns);
/* The same from another board's, if it is of as many vertices. */
void live_board_ease_from(live_board *self, const live_board *other, int64_t now_ns);
bool live_board_is_easing(const live_board *self);
/* The window has the newest one, and waits for the next. */
bool live_board_is_taken(const live_board *self);

/* ---- [main] ---- */

bool live_board_look(live_board *self, const live_view **out);

#endif
