/* face/rig/rig_anatomy.h - what of a mesh is a head, and what of the head is what: the skin of the
 * face, eyes, teeth, hair; by the skeleton that the file brings, by the names of its parts, else by
 * where things lie. Leaves out what a rig makes of it (rig_draft.h). Inside the room. [main] */
#ifndef MAROTTE_FACE_RIG_ANATOMY_H
#define MAROTTE_FACE_RIG_ANATOMY_H
#include "face/rig/rig_head.h"
#include "mesh/topology.h"

typedef enum piece_kind {
    PIECE_UNKNOWN = 0, /* follows the surface that is nearest */
    PIECE_FACE,        /* the skin of the face, and what is one with it */
    PIECE_BODY,        /* not of the head */
    PIECE_RIDES,       /* on the skull: hair, hats, glasses, ears */
    PIECE_BEARD,       /* on the jaw */
    PIECE_TEETH_UPPER,
    PIECE_TEETH_LOWER,
    PIECE_TONGUE,
    PIECE_EYE_LEFT,
    PIECE_EYE_RIGHT
} piece_kind;

typedef enum anatomy_source { BY_SHAPE = 0, BY_NAME, BY_SKELETON } anatomy_source;

typedef struct anatomy_piece {
    piece_kind kind;
    anatomy_source source;
    uint32_t vertex;                    /* its first */
    uint32_t first_member, point_count; /* its points, in rig_anatomy.member */
    uint32_t head_count;                /* of them, those of the head */
    uint32_t part;                      /* of the mesh; that of its first triangle */
    vec3 low, high, mean;               /* of its points, mm */
} anatomy_piece;

typedef struct anatomy_eye {
    bool is_found;
    vec3 centre; /* mm */
    double radius_mm;
} anatomy_eye;

typedef struct rig_anatomy {
    uint32_t *of_vertex; /* vertex_count: its piece; piece_count: of no surface */
    anatomy_piece *piece;
    uint32_t piece_count;
    uint32_t *member; /* the points of all pieces */
    uint8_t *is_head; /* vertex_count */
    uint8_t *is_face; /* vertex_count: of the head and of the piece that is the face */
    float *hidden_mm; /* vertex_count: so far behind other skin of the face, from the front */
    uint32_t face;    /* the piece */
    anatomy_source source;
    uint32_t head_joint, jaw_joint; /* MESH_NO_JOINT: the file has none */
    bool has_body;
    vec3 neck;     /* where the head turns on a body, mm */
    bool has_face; /* `head` was measured; else it is a head without a profile */
    rig_head head;
    bool has_parted_lips; /* the surface leads from one to the other only around the corners */
    bool has_slit;        /* that, or an open mouth */
    double lips_mm;       /* from lip to lip along the surface */
    bool has_ears;
    vec3 ear;            /* the hole of the left one, mm */
    anatomy_eye eye[2];  /* left, right */
    uint32_t head_count; /* heads in the file; the others are taken for its body */
} rig_anatomy;

/* Unsupported where there is no head to be seen. */
CHECKED mrt_result rig_anatomy_find(rig_anatomy *out, const mesh *m, const topology *t, error *err);
void rig_anatomy_finish(rig_anatomy *a); /* accepts zeroed */

#endif
