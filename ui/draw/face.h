/* draw/face.h - a face on the graphics card, from the inside: its buffers, the surfaces that its
 * materials are drawn as (by their numbers, and by words in their names: rigs/README.md lists
 * them), and its seams: vertices that are one point of one smooth surface although the file has
 * them twice (along seams of texture or material). Their normals are joined, so that no seam shows
 * when the surface deforms; points that merely touch, like closed lips, stay apart. The thread of
 * the context; surfaces and seams are pure. */
#ifndef MAROTTE_UI_DRAW_FACE_H
#define MAROTTE_UI_DRAW_FACE_H
#include "draw/draw.h"
#include "draw/gl.h"

#include "base/error.h"
#include "mesh/mesh.h"

typedef enum surface_kind {
    SURFACE_SMOOTH = 0,
    SURFACE_STONE,   /* pores, weather, grain */
    SURFACE_FELT,    /* fibres, a pale fuzz where it turns away */
    SURFACE_PAINTED, /* smooth, with what the file brings: textures, vertex colours, toon, no light
                      */
    SURFACE_KINDS
} surface_kind;

typedef struct surface {
    surface_kind kind;
    float softness;   /* 0..1: light goes under it: latex, foam, skin */
    float coat;       /* 0..1: a wet film over it */
    bool is_in_mouth; /* shown only when the mouth is open */
} surface;
surface surface_of(const mesh_material *material);

typedef struct seams {
    uint32_t *vertex, *leader; /* pair_count each: vertex takes the normal of leader */
    uint32_t pair_count;
} seams;

/* position, normal: vertex_count by 3, at rest; the normals may differ by angles up to that of the
 * cosine. */
CHECKED mrt_result seams_init(seams *out, const float *position, const float *normal,
                              uint32_t vertex_count, float least_cosine, error *err);
void seams_finish(seams *s);
/* Normals as a structure of arrays, unit. */
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
    mesh_material look; /* without its name */
    surface surface;
    GLuint texture[FACE_TEXTURES]; /* the face's; 0: none */
    bool is_clear;                 /* drawn after the others, the farthest first */
    float centre[3];               /* mm, at rest */
} face_batch;

typedef struct face_texture { /* a picture on the graphics card, as one of its users wants it */
    GLuint name;
    uint32_t image; /* of the mesh, counted from 1 */
    mesh_wrap wrap[2];
    bool is_colour; /* sRGB-coded */
} face_texture;

typedef struct face_box { /* around the vertices of a part that are numbers; low > high: none */
    float low[3], high[3];
    bool is_whole; /* all are numbers */
} face_box;

struct draw_face {
    GLuint vertex_array, position_buffer, normal_buffer, rest_buffer, openness_buffer, index_buffer;
    GLuint colour_buffer;          /* 0: the materials' colours */
    GLuint tint_buffer, uv_buffer; /* 0: the mesh has none */
    face_texture *texture;
    uint32_t texture_count;
    uint32_t vertex_count, triangle_count;
    uint32_t solid_count; /* of the triangles: the others, behind them, are clear */
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

/* Draws every triangle that is not clear, or the vertices as points when there is none; the program
 * and the vertex array are bound by the caller. */
void face_draw_all(const draw_face *face);

/* The rectangle of clip space (x, y, x, y; -1..1 is the picture) that has every triangle in it.
 * projection: column-major. false: unknown; a vertex is no number or not before the eye, or the
 * vertices are drawn as points. */
bool face_find_rectangle(float out[4], const draw_face *face, const float projection[16]);

/* How much of the room each vertex sees in the rest shape: eye sockets and nostrils are dark, noses
 * are not. Baked once by looking at the mesh from many sides. What is in the mouth sees at least
 * as much as in an open one: at rest the lips close it in. */
/* out_openness: one per vertex, 0 (sees nothing) .. 1. The face's buffers (but not the openness)
 * and normals are there. position: vertex_count by 3, mm. */
CHECKED mrt_result occlusion_bake(float *out_openness, const draw_face *face, const float *position,
                                  error *err);

#endif
