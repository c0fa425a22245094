/* mesh/mesh.h - a mesh as read from a file: plain arrays in the file's own vertex order, mm, with
 * the names that the file gave its parts. Vertices are never duplicated, dropped or renumbered;
 * which of them are one point of the surface is said beside.
 * Leaves out topology (topology.h) and the layout that the engine deforms (csrbf/points.h).
 * [main] builds it; read-only afterwards on any thread. */
#ifndef MAROTTE_MESH_MESH_H
#define MAROTTE_MESH_MESH_H
#include "base/error.h"
#include "mesh/frame.h"

/* A picture of the file. */
typedef struct mesh_image {
    char *name;       /* "" when the file has none */
    uint8_t *encoded; /* as it is in the file: encoded_size bytes; NULL: it is decoded */
    uint8_t *rgba;    /* width by height by 4, rows from the top; NULL: there is none */
    size_t encoded_size;
    uint32_t width, height; /* px */
} mesh_image;

typedef enum mesh_wrap { MESH_WRAP_REPEAT = 0, MESH_WRAP_MIRROR, MESH_WRAP_CLAMP } mesh_wrap;

typedef struct mesh_texture { /* a picture on a surface */
    uint32_t image;           /* 1 + index into mesh.image; 0: none */
    mesh_wrap wrap[2];
    float uv_transform[6]; /* from mesh.uv to the picture: two rows of three, the last of a row a
                              shift */
} mesh_texture;

typedef enum mesh_alpha { MESH_ALPHA_OPAQUE = 0, MESH_ALPHA_MASK, MESH_ALPHA_BLEND } mesh_alpha;

typedef enum mesh_lighting {
    MESH_LIGHTING_FULL = 0,
    MESH_LIGHTING_NONE, /* its colours as they are */
    MESH_LIGHTING_TOON  /* two tones: the base colour, and the shade's where no light falls */
} mesh_lighting;

typedef struct mesh_material {
    char *name;           /* "" when the file has none */
    float base_colour[4]; /* linear RGBA, 0..1: multiplies the base texture and mesh.colour */
    float roughness;      /* 0..1 */
    float metallic;       /* 0..1 */
    bool says_roughness;  /* false: the format's default */
    bool is_single_sided; /* what is seen from behind is not drawn */
    mesh_alpha alpha;
    float alpha_cutoff; /* MASK: less is not there */
    mesh_texture base, normal, emission;
    mesh_texture surface; /* green multiplies the roughness, blue the metal */
    float normal_scale;
    float emission_colour[3]; /* linear, >= 0: multiplies its texture */
    mesh_lighting lighting;
    float shade_colour[3];          /* TOON: linear, in the place of base_colour */
    float shade_shift, shade_toony; /* TOON: VRMC_materials_mtoon's factors */
} mesh_material;

/* A run of triangles that belong together: an OBJ group x material, a glTF primitive. Parts are
 * disjoint, in order, and cover all triangles. */
typedef struct mesh_part {
    char *name;        /* group, object, node or mesh name; "" when the file has none */
    uint32_t material; /* index into mesh.material */
    uint32_t first_triangle, triangle_count;
    uint32_t first_vertex, vertex_count; /* the range that its triangles use */
} mesh_part;

typedef struct mesh_attribute { /* a custom per-vertex attribute: glTF "_NAME" */
    char *name;
    uint32_t component_count; /* 1..4 */
    float *value;             /* vertex_count by component_count */
} mesh_attribute;

typedef struct mesh_target { /* a morph target */
    char *name;
    float *offset; /* vertex_count by 3, mm, to be added to position */
} mesh_target;

/* A shape's part in what a face shows under a word of its own: VRM's expressions, one row for each
 * shape; the rows of one expression follow each other. */
typedef struct mesh_expression {
    char *name;      /* VRM 1.0's word ("aa", "happy", "blinkLeft"), else the file's */
    uint32_t target; /* index into mesh.target */
    float weight;    /* 0..1: of the shape, where the expression is whole */
} mesh_expression;

/* A joint of a skeleton. Parents come before their children. */
typedef struct mesh_joint {
    char *name;      /* of its node; "" when the file has none */
    char *role;      /* VRM's word for it ("head", "jaw", "leftEye"); "": the file does not say */
    uint32_t parent; /* index into mesh.joint; MESH_NO_JOINT: a root */
    float rest[12];  /* joint to mesh at rest: three rows of four, the last of a row in mm */
} mesh_joint;
#define MESH_NO_JOINT UINT32_MAX
enum { MESH_SKIN_WIDTH = 4 }; /* joints that a vertex follows at most */

typedef struct mesh {
    uint32_t vertex_count, triangle_count;
    float *position; /* vertex_count by 3, mm, finite */
    uint32_t
        *triangle; /* triangle_count by 3, each < vertex_count, counter-clockwise from outside */
    float *normal; /* vertex_count by 3, unit, or NULL when the file has none */
    /* vertex_count each, or both NULL: every vertex is by itself (weld.h). The first vertex of the
     * same point of the surface, at the same place bit for bit; of those of one point, the first
     * that faces the same way, so that no edge shows between them. A point without smooth, from a
     * reader: what the file itself has as one vertex, before weld.h looked at it. */
    uint32_t *point, *smooth;
    float *uv;     /* vertex_count by 2, as glTF: (0, 0) is the upper left; NULL: none */
    float *colour; /* vertex_count by 4, linear RGBA, 0..1; NULL: none */
    mesh_image *image;
    mesh_material *material;
    mesh_part *part;
    mesh_attribute *attribute;
    mesh_target *target;
    mesh_expression *expression;
    uint32_t image_count, material_count, part_count, attribute_count, target_count;
    uint32_t expression_count;
    uint32_t undrawn_count; /* pictures of the file that could not be had */
    /* The skeleton at rest, which is how the positions stand. */
    mesh_joint *joint;
    uint32_t joint_count;
    uint32_t *skin_joint; /* vertex_count by MESH_SKIN_WIDTH; NULL: no vertex follows a joint */
    float *skin_weight;   /* likewise: largest first, sum 1, or all 0: it follows none */
    bool has_focus; /* a box in which all is that performs, of a mesh with a body: bind_focus */
    float focus_low[3], focus_high[3];
    double mm_per_unit;    /* what the file's coordinates were multiplied by */
    bool is_unit_guessed;  /* by its height: neither the file nor a person says it */
    mesh_axis up, forward; /* of the file's coordinates; the mesh itself has up +y, forward +z */
    char *path;            /* the file that it was read from, as it was named; NULL: none */
    char *note;            /* what a person should know of it, lines ended by \n; NULL: nothing */
} mesh;

/* Allocates position and triangle, zeroed, with one part "" and one grey material. */
CHECKED mrt_result mesh_create(mesh *out, uint32_t vertex_count, uint32_t triangle_count,
                               error *err);
/* Deep; on error `out` is zeroed. [any] */
CHECKED mrt_result mesh_copy(mesh *out, const mesh *m, error *err);
/* Frees everything; accepts NULL and a zeroed mesh. */
void mesh_destroy(mesh *m);

/* Appends one line to the note (a message for a person, not an error). */
__attribute__((format(printf, 2, 3))) void mesh_note(mesh *m, const char *format, ...);

static inline uint32_t mesh_point(const mesh *m, uint32_t vertex)
{
    return m->point ? m->point[vertex] : vertex;
}

/* Bounds of the positions. */
void mesh_bounds(const mesh *m, float out_low[3], float out_high[3]);
/* Of what is looked at, and where hands are put: its focus, or all. */
void mesh_focus(const mesh *m, float out_low[3], float out_high[3]);

/* A grey surface: what is not said of one. The name is NULL. */
mesh_material mesh_material_grey(void);

/* What every reader's result is checked with, and what a caller with a mesh of his own can use:
 * finite positions, targets and weights, indices in range, parts disjoint and covering, parents of
 * joints before them. */
CHECKED mrt_result mesh_validate(const mesh *m, error *err);

#endif
