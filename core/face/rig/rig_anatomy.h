/* face/rig/rig_anatomy.h - the parts of a head in a mesh: the skin of the face, eyes, teeth, hair.
 * They are found by the skeleton of the file, by the names of its parts, or by their position.
 * Leaves out the rig that is made from them (rig_draft.h). Private to this folder. [main] */
#ifndef MAROTTE_FACE_RIG_ANATOMY_H
#define MAROTTE_FACE_RIG_ANATOMY_H
#include "face/rig/rig_head.h"
#include "mesh/topology.h"

typedef enum piece_kind {
    PIECE_UNKNOWN = 0, /* follows the nearest surface */
    PIECE_FACE,        /* skin of the face, and everything connected to it */
    PIECE_BODY,        /* not part of the head */
    PIECE_RIDES,       /* rigid on the skull: hair, hats, glasses, ears */
    PIECE_BEARD,       /* rigid on the jaw */
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
    uint32_t vertex;                    /* its first vertex */
    uint32_t first_member, point_count; /* its points, in rig_anatomy.member */
    uint32_t head_count;                /* number of its points that belong to the head */
    uint32_t part;                      /* part of the mesh, from its first triangle */
    vec3 low, high, mean;               /* of its points, mm */
} anatomy_piece;

typedef struct anatomy_eye {
    bool is_found;
    vec3 centre; /* mm */
    double radius_mm;
} anatomy_eye;

typedef struct rig_anatomy {
    uint32_t *of_vertex; /* vertex_count: index of its piece; piece_count: no surface */
    anatomy_piece *piece;
    uint32_t piece_count;
    uint32_t *member; /* the points of all pieces */
    uint8_t *is_head; /* vertex_count */
    uint8_t *is_face; /* vertex_count: belongs to the head and to the face's piece */
    float *hidden_mm; /* vertex_count: depth behind other skin of the face, seen from the front */
    uint32_t face;    /* index of the face's piece */
    anatomy_source source;
    uint32_t head_piece; /* the piece that is the head of a figure; UINT32_MAX: not found so */
    uint32_t head_joint, jaw_joint; /* MESH_NO_JOINT if the file has none */
    bool has_body;
    bool is_on_four_legs; /* the body lies behind the head and below legs_y, not only below it */
    double legs_y;        /* mm; legs may reach further forward than the head */
    vec3 neck;            /* centre of the head's rotation on a body, mm */
    vec3 neck_up;         /* unit vector from the body to the head */
    bool has_face;        /* `head` was measured; false for a head without a profile */
    rig_head head;
    bool is_mouth_of_shape; /* its place is from a shape of the file, not from the profile */
    bool has_parted_lips;   /* the surface connects the lips only around the corners */
    bool has_slit;          /* parted lips or an open mouth */
    double lips_mm;         /* distance from lip to lip along the surface */
    bool has_ears;
    vec3 ear;            /* hole of the left ear, mm */
    anatomy_eye eye[2];  /* left, right */
    uint32_t head_count; /* number of heads in the file; the others count as body */
} rig_anatomy;

/* Returns an unsupported error if no head is found. */
CHECKED mrt_result rig_anatomy_find(rig_anatomy *out, const mesh *m, const topology *t, error *err);
void rig_anatomy_finish(rig_anatomy *a); /* accepts zeroed */

#endif
