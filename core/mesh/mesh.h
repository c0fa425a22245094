/* mesh/mesh.h - a mesh as read from a file: plain arrays in the file's own vertex order, mm, with
 * the names of its parts. Vertices are never duplicated, dropped or renumbered; separate arrays
 * tell which vertices are one point of the surface. Leaves out topology (topology.h) and the layout
 * for the engine (csrbf/points.h). [main] builds it; read-only afterwards on any thread. */
#ifndef MAROTTE_MESH_MESH_H
#define MAROTTE_MESH_MESH_H
#include "base/error.h"
#include "mesh/frame.h"

/* A picture of the file. */
typedef struct mesh_image {
    char *name;       /* "" if the file has none */
    uint8_t *encoded; /* as in the file, encoded_size bytes; NULL: decoded */
    uint8_t *rgba;    /* width by height by 4, rows from the top; NULL: none */
    size_t encoded_size;
    uint32_t width, height; /* px */
} mesh_image;

typedef enum mesh_wrap { MESH_WRAP_REPEAT = 0, MESH_WRAP_MIRROR, MESH_WRAP_CLAMP } mesh_wrap;

typedef struct mesh_texture { /* a picture on a surface */
    uint32_t image;           /* 1 + index into mesh.image; 0: none */
    mesh_wrap wrap[2];
    float uv_transform[6]; /* from mesh.uv to the picture: two rows of three; the last number of a
                              row is a shift */
} mesh_texture;

typedef enum mesh_alpha { MESH_ALPHA_OPAQUE = 0, MESH_ALPHA_MASK, MESH_ALPHA_BLEND } mesh_alpha;

typedef enum mesh_lighting {
    MESH_LIGHTING_FULL = 0,
    MESH_LIGHTING_NONE, /* colours without lighting */
    MESH_LIGHTING_TOON  /* two tones: the base colour, and the shade colour where it is dark */
} mesh_lighting;

typedef struct mesh_material {
    char *name;           /* "" if the file has none */
    float base_colour[4]; /* linear RGBA, 0..1: multiplies the base texture and mesh.colour */
    float roughness;      /* 0..1 */
    float metallic;       /* 0..1 */
    bool has_roughness;   /* the file has a roughness; false: default of the format */
    bool is_single_sided; /* back faces are not drawn */
    mesh_alpha alpha;
    float alpha_cutoff; /* MASK: a lower alpha is not drawn */
    mesh_texture base, normal, emission;
    mesh_texture surface; /* green multiplies the roughness, blue the metallic */
    float normal_scale;
    float emission_colour[3]; /* linear, >= 0: multiplies its texture */
    mesh_lighting lighting;
    float shade_colour[3];          /* TOON: linear, in shadow instead of base_colour */
    float shade_shift, shade_toony; /* TOON: factors of VRMC_materials_mtoon */
} mesh_material;

/* A run of triangles that belong together: an OBJ group x material, a glTF primitive. Parts are
 * disjoint, in order, and cover all triangles. */
typedef struct mesh_part {
    char *name;        /* name of the group, object, node or mesh; "" if the file has none */
    uint32_t material; /* index into mesh.material */
    uint32_t first_triangle, triangle_count;
    uint32_t first_vertex, vertex_count; /* range of vertices that its triangles use */
} mesh_part;

typedef struct mesh_attribute { /* a custom per-vertex attribute: glTF "_NAME" */
    char *name;
    uint32_t component_count; /* 1..4 */
    float *value;             /* vertex_count by component_count */
} mesh_attribute;

typedef struct mesh_target { /* a morph target */
    char *name;
    float *offset; /* vertex_count by 3, mm, added to position */
} mesh_target;

/* One shape of an expression of VRM: one row for each shape; the rows of an expression are
 * consecutive. */
typedef struct mesh_expression {
    char *name;      /* name in VRM 1.0 ("aa", "happy", "blinkLeft"), else the name in the file */
    uint32_t target; /* index into mesh.target */
    float weight;    /* weight 0..1 of the shape in the full expression */
} mesh_expression;

/* A joint of a skeleton. Parents come before their children. */
typedef struct mesh_joint {
    char *name;      /* of its node; "" if the file has none */
    char *role;      /* its name in VRM ("head", "jaw", "leftEye"), "spring": the first joint of a
                        chain that VRM swings; "": not in the file */
    uint32_t parent; /* index into mesh.joint; MESH_NO_JOINT: a root */
    float rest[12];  /* transform from joint to mesh at rest: three rows of four; the last number of
                        a row is in mm */
} mesh_joint;
#define MESH_NO_JOINT UINT32_MAX
enum { MESH_SKIN_WIDTH = 4 }; /* maximum number of joints that move a vertex */

typedef struct mesh {
    uint32_t vertex_count, triangle_count;
    float *position; /* vertex_count by 3, mm, finite */
    uint32_t
        *triangle; /* triangle_count by 3, each < vertex_count, counter-clockwise from outside */
    float *normal; /* vertex_count by 3, unit; NULL if the file has none */
    /* vertex_count each, or both NULL: every vertex is a separate point (weld.h). point: the first
     * vertex of the same point of the surface, at exactly the same place. smooth: among those of
     * one point, the first one that faces the same way, so that no edge is shown between them. A
     * reader may set only point: vertices that are one in the file itself, before weld.h. */
    uint32_t *point, *smooth;
    float *uv;     /* vertex_count by 2, as in glTF: (0, 0) is the upper left; NULL: none */
    float *colour; /* vertex_count by 4, linear RGBA, 0..1; NULL: none */
    mesh_image *image;
    mesh_material *material;
    mesh_part *part;
    mesh_attribute *attribute;
    mesh_target *target;
    mesh_expression *expression;
    uint32_t image_count, material_count, part_count, attribute_count, target_count;
    uint32_t expression_count;
    uint32_t undrawn_count; /* number of pictures in the file that could not be read */
    /* The skeleton in its rest pose, which is the pose of the positions. */
    mesh_joint *joint;
    uint32_t joint_count;
    uint32_t *skin_joint; /* vertex_count by MESH_SKIN_WIDTH; NULL: no vertex follows a joint */
    float *skin_weight;   /* the same size: largest first, sum 1; or all 0: it follows no joint */
    bool has_focus; /* a box around the parts that perform, if the mesh has a body: bind_focus */
    float focus_low[3], focus_high[3];
    double mm_per_unit;    /* factor of the file's coordinates */
    bool is_unit_guessed;  /* guessed from the height: it was not given */
    mesh_axis up, forward; /* axes of the file; the mesh itself has up +y, forward +z */
    char *path;            /* path of the file as given; NULL: none */
    char *note;            /* messages for the user, each line ended by \n; NULL: none */
} mesh;

/* Allocates position and triangle, zeroed, with one part "" and one grey material. */
CHECKED mrt_result mesh_create(mesh *out, uint32_t vertex_count, uint32_t triangle_count,
                               error *err);
/* Makes a deep copy; on error `out` is zeroed. [any] */
CHECKED mrt_result mesh_copy(mesh *out, const mesh *m, error *err);
/* Frees everything; accepts NULL and a zeroed mesh. */
void mesh_destroy(mesh *m);

/* Appends a line to the note: a message for the user, not an error. */
__attribute__((format(printf, 2, 3))) void mesh_note(mesh *m, const char *format, ...);

static inline uint32_t mesh_point(const mesh *m, uint32_t vertex)
{
    return m->point ? m->point[vertex] : vertex;
}

/* Computes the bounds of the positions. */
void mesh_bounds(const mesh *m, float out_low[3], float out_high[3]);
/* Computes the bounds for cameras and for placing hands: those of the focus, or of all vertices. */
void mesh_focus(const mesh *m, float out_low[3], float out_high[3]);

/* Returns a grey surface, the default material. Its name is NULL. */
mesh_material mesh_material_grey(void);

/* Checks a mesh; all readers call it for their result. Finite positions, targets and weights,
 * indices in range, parts disjoint and covering, parents of joints before their children. */
CHECKED mrt_result mesh_validate(const mesh *m, error *err);

#endif
