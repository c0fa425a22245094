/* stage/output/board.h - the face for the outputs: its names, and a slot with its newest values.
 * Made for one face on [main]. [frame] fills it without waiting. The thread of outputs.h, [taker],
 * reads it and adds the weights (face/face_weights.h). Leaves out the destination of the data. */
#ifndef MAROTTE_STAGE_OUTPUT_BOARD_H
#define MAROTTE_STAGE_OUTPUT_BOARD_H
#include "base/slot.h"
#include "face/face_weights.h"
#include "stage/mapping/isolate_wire.h"
#include "stage/perform/composer.h"

typedef struct board_face { /* one of three buffers */
    int64_t time_ns, take_ns;
    uint64_t number;
    bool has_vertices;
    float *value; /* layout of isolate_sample_floats, with vertices */
} board_face;

typedef struct face_board {
    publish_slot slot;
    isolate_names of; /* own copy of the names */
    board_face face[3];
    uint64_t number;
    _Atomic uint32_t references;
    const face_file *file;
    /* Created by [taker] with the first face. NULL until then, or if they cannot be created. */
    face_weights *weights;
    /* true: `weights` is final, so [frame] copies only the vertices that it needs. Before that it
     * copies all vertices. */
    _Atomic bool has_final_weights;
    double residual_mm; /* of the face that was read last, see face_channels */
} face_board;

/* [main] Creates the board with one reference. It does not need the composer later. The file must
 * stay valid while faces are read. */
CHECKED mrt_result face_board_create(face_board **out, composer *of, const face_file *file,
                                     error *err);
face_board *face_board_retain(face_board *self); /* [any] adds a reference */
void face_board_release(face_board *self);       /* [any but frame] accepts NULL */

/* [main] Creates the weights now instead of with the first face. */
void face_board_prepare(face_board *self);

/* [frame] Copies the face that the composer has drawn. It must be similar to the face of the
 * board. */
void face_board_fill(face_board *self, composer *of, int64_t time_ns, int64_t take_ns,
                     bool with_vertices);
/* [taker] Returns the newest face with its weights, valid until the next call. NULL: none since the
 * last call. The first call takes about 100 ms longer, because it creates the weights. */
const board_face *face_board_read(face_board *self);

#endif
