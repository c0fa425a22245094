/* draw/face.h - the inside of a face on the graphics card. The thread of the context. */
#ifndef MAROTTE_UI_DRAW_FACE_H
#define MAROTTE_UI_DRAW_FACE_H
#include "draw/draw.h"
#include "draw/gl.h"
#include "draw/seams.h"
#include "draw/surface.h"

enum { /* vertex attributes, as in shaders/face.vert */
       FACE_POSITION = 0,
       FACE_NORMAL = 1,
       FACE_REST = 2,
       FACE_OPENNESS = 3,
       FACE_COLOUR = 4
};

typedef struct face_batch { /* the triangles of one material */
    GLsizei index_count;
    size_t first_index;
    float base_colour[4], roughness, metallic;
    surface surface;
} face_batch;

typedef struct face_box { /* around the vertices of a part that are numbers; low > high: none */
    float low[3], high[3];
} face_box;

struct draw_face {
    GLuint vertex_array, position_buffer, normal_buffer, rest_buffer, openness_buffer, index_buffer;
    GLuint colour_buffer; /* 0: the materials' colours */
    uint32_t vertex_count, triangle_count;
    face_batch *batch;
    uint32_t batch_count;
    uint32_t *triangle; /* triangle_count by 3, sorted by batch */
    seams seam;
    float *lane[6];             /* x y z, nx ny nz: vertex_count each */
    float *normal;              /* vertex_count by 3 */
    stamps_reader seen;         /* of what draw_face_follow was given */
    face_box *box;              /* one for DRAW_ROWS vertices each */
    float centre[3], radius_mm; /* a ball around the shape now */
    float height_mm;            /* at rest */
};

/* ---- face_update.c ---- */

uint32_t
face_parts(const draw_face *self); /* of DRAW_ROWS vertices each; the last may have fewer */
/* The ball around the shape; changed: the parts that are new to self->seen; NULL: all. */
void face_measure(draw_face *self, const float *position, const stamps *changed);

/* ---- face.c ---- */

/* self->normal := smooth normals of the shape, joined at seams. */
void face_compute_normals(draw_face *self, const float *position);
/* Draws every triangle, or the vertices as points when there is none; the program and the vertex
 * array are bound by the caller. */
void face_draw_all(const draw_face *face);

#endif
