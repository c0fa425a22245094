/* draw/face.h - internals of a face on the graphics card: its buffers, its surfaces and its seams.
 * A surface is how a material is drawn, from its numbers and from words in its name
 * (rigs/README.md). A seam is a pair of vertices that are one point of a smooth surface, but two in
 * the file, because texture or material differ. Their normals are joined, so that the seam stays
 * invisible when the surface deforms. Points that only touch, such as closed lips, are not joined.
 * Surfaces and seams are pure. [thread of the context] */
#ifndef MAROTTE_UI_DRAW_FACE_H
#define MAROTTE_UI_DRAW_FACE_H
#include "draw/draw.h"
#include "draw/gl.h"

#include "base/error.h"
#include "mesh/mesh.h"

typedef enum surface_kind {
    SURFACE_SMOOTH = 0,
    SURFACE_STONE,   /* pores, weathering, grain */
    SURFACE_FELT,    /* fibres, fuzz at the edges, contact shadows */
    SURFACE_PAINTED, /* smooth, with the features of the file: textures, vertex colours, toon, unlit
                      */
    SURFACE_KINDS
} surface_kind;

typedef struct surface {
    surface_kind kind;
    float softness;   /* 0..1: light that enters the surface: latex, foam, skin */
    float coat;       /* 0..1: wet film on the surface */
    float cornea;     /* 0..1: the lamps are seen in it: eyes */
    bool has_nap;     /* felt whose fibres stand out at its edge */
    bool is_in_mouth; /* shown only when the mouth is open */
} surface;
surface surface_of(const mesh_material *material);

typedef struct seams {
    uint32_t *vertex, *leader; /* pair_count each: vertex takes the normal of leader */
    uint32_t pair_count;
} seams;

/* Finds the seams. position, normal: vertex_count by 3, at rest. Paired normals differ by at most
 * the angle of least_cosine. */
CHECKED mrt_result seams_init(seams *out, const float *position, const float *normal,
                              uint32_t vertex_count, float least_cosine, error *err);
void seams_finish(seams *s);
/* Joins unit normals, given as a structure of arrays. */
void seams_join(const seams *s, float *nx, float *ny, float *nz);

enum { /* vertex attributes, as in shaders/face.vert */
       FACE_POSITION = 0,
       FACE_NORMAL = 1,
       FACE_REST = 2,
       FACE_OPENNESS = 3,
       FACE_COLOUR = 4,
       FACE_TINT = 5,
       FACE_UV = 6
};

enum { /* textures of a material, in the order of its uniforms */
       FACE_BASE = 0,
       FACE_NORMAL_MAP,
       FACE_EMISSION,
       FACE_ROUGH_METAL,
       FACE_TEXTURES
};

typedef struct face_batch { /* the triangles of one material */
    GLsizei index_count;
    size_t first_index;
    mesh_material look; /* look.name is NULL */
    surface surface;
    GLuint texture[FACE_TEXTURES]; /* owned by the face; 0: none */
    bool is_clear;                 /* drawn after the others, the farthest first */
    float centre[3];               /* mm, at rest */
} face_batch;

typedef struct face_texture { /* a picture on the graphics card, in the form that one of its users
                                 needs */
    GLuint name;
    uint32_t image; /* index in the mesh, counted from 1 */
    mesh_wrap wrap[2];
    bool is_colour; /* sRGB-coded */
} face_texture;

typedef struct face_box { /* box around the finite vertices of a part; low > high: none */
    float low[3], high[3];
    bool is_whole; /* all vertices are finite */
} face_box;

struct draw_face {
    GLuint vertex_array, position_buffer, normal_buffer, rest_buffer, openness_buffer, index_buffer;
    GLuint colour_buffer;          /* 0: colours of the materials */
    GLuint tint_buffer, uv_buffer; /* 0: the mesh has none */
    face_texture *texture;
    uint32_t texture_count;
    uint32_t vertex_count, triangle_count;
    uint32_t solid_count; /* triangles that are not transparent; they come first */
    face_batch *batch;
    uint32_t batch_count;
    uint32_t *triangle; /* triangle_count by 3, sorted by batch */
    seams seam;
    float *lane[6];             /* x y z, nx ny nz: vertex_count each */
    float *normal;              /* vertex_count by 3 */
    stamps_reader seen;         /* changes that were already read from draw_face_follow */
    face_box *box;              /* one for each DRAW_ROWS vertices */
    float centre[3], radius_mm; /* ball around the current shape */
    float height_mm;            /* at rest */
};

/* Draws all triangles that are not transparent, or the vertices as points if there are no
 * triangles. The caller binds the program and the vertex array. */
void face_draw_all(const draw_face *face);

/* Computes a rectangle of clip space (x, y, x, y; the picture is -1..1) that contains all
 * triangles. projection: column-major. Returns false if it is unknown: a vertex is not finite or
 * not in front of the eye, or the vertices are drawn as points. */
bool face_find_rectangle(float out[4], const draw_face *face, const float projection[16]);

/* Computes the ambient occlusion of each vertex in the rest shape: eye sockets and nostrils are
 * dark, noses are not. Renders the mesh from many sides, once. Surfaces in the mouth get at least
 * the value of an open mouth, because closed lips hide them at rest. */
/* out_openness: one per vertex, 0 (fully occluded) .. 1. The face has its normals and buffers,
 * except that of the openness. position: vertex_count by 3, mm. */
CHECKED mrt_result occlusion_bake(float *out_openness, const draw_face *face, const float *position,
                                  error *err);

#endif
