/* stage/output/board.h - the face for the outputs: its names, and a slot with its newest values.
 * Made for one face on [main]; filled by [frame] without waiting; taken by the thread of outputs.h,
 * which says it in weights (face/face_weights.h). Leaves out where it goes. */
#ifndef MAROTTE_STAGE_OUTPUT_BOARD_H
#define MAROTTE_STAGE_OUTPUT_BOARD_H
#include "base/slot.h"
#include "face/face_weights.h"
#include "stage/mapping/isolate_wire.h"
#include "stage/perform/composer.h"

typedef struct board_face { /* one of three */
    int64_t time_ns, take_ns;
    uint64_t number;
    bool has_vertices;
    float *value; /* as isolate_sample_floats, vertices included */
} board_face;

typedef struct face_board {
    publish_slot slot;
    isolate_names of; /* its own copy */
    board_face face[3];
    uint64_t number;
    _Atomic uint32_t references;
    const face_file *file;
    /* Made by [taker] with the first face; NULL until then, and if they cannot be made. */
    face_weights *weights;
    /* `weights` does not change any more. From then on [frame] copies only the vertices that the
     * weights are found from; before that it cannot know which, and copies all. */
    _Atomic bool has_final_weights;
    double residual_mm; /* of the face taken last, face_channels */
} face_board;

/* [main] With one reference. The composer may go before it; the file must be there as long as faces
 * are taken. */
CHECKED mrt_result face_board_create(face_board **out, composer *of, const face_file *file,
                                     error *err);
face_board *face_board_keep(face_board *self); /* [any] one reference more */
void face_board_drop(face_board *self);        /* [any but frame] NULL is fine */

/* [main] Makes what weights are found with now, instead of with the first face that is taken. */
void face_board_prepare(face_board *self);

/* [frame] What the composer shows, drawn; a face like the one that it was made for. */
void face_board_fill(face_board *self, composer *of, int64_t time_ns, int64_t take_ns,
                     bool with_vertices);
/* [taker] The newest face, with its weights, until the next call; NULL: none since the last one.
 * The first call takes some 100 ms more, to make what the weights are found with. */
const board_face *face_board_take(face_board *self);

#endif
