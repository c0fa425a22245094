/* face/rig.h - a rig file, NAME.rig.json version 1: which mesh, which bones, which vertices belong
 * to them, where a face can be pulled, and how its surface is solved. Parsing, validating, writing;
 * what the numbers do to a mesh is in bind.h. In memory all lengths are mm and all angles rad,
 * whatever the file's unit. Unknown keys are kept and written back. [main] */
#ifndef MAROTTE_FACE_RIG_H
#define MAROTTE_FACE_RIG_H
#include "base/error.h"
#include "base/rigid.h"
#include "csrbf/csrbf.h"
#include "mesh/frame.h"

/* "select": which vertices. Evaluated to a weight of 0..1 per vertex (0 or 1 but for attributes and
 * what is painted). */
typedef enum rig_select_kind {
    SELECT_NOTHING = 0,
    SELECT_VERTICES, /* "vertices": [204, "120-180"] */
    SELECT_GROUP, /* "group": name of a part, material or node; '*' at its end matches any rest */
    SELECT_ATTRIBUTE,  /* "attribute": "_SKULL" (first component, clamped to 0..1) */
    SELECT_BOX,        /* "box": { "low": [x,y,z], "high": [x,y,z] } */
    SELECT_ELLIPSOID,  /* "ellipsoid": { "centre": [x,y,z], "radii": [x,y,z] } */
    SELECT_HALF_SPACE, /* "half_space": { "point": [x,y,z], "normal": [x,y,z] }: where normal points
                        */
    SELECT_WITHIN,     /* "within": { "mm": d, "of": vertex }: along the surface */
    SELECT_ALL,        /* "all": [ ... ]: the least of them */
    SELECT_ANY,        /* "any": [ ... ]: the greatest of them */
    SELECT_NOT,        /* "not": { ... } */
    SELECT_PAINTED,    /* "painted": a name in the rig's "paints" */
    SELECT_PIECE,      /* "piece": vertex: the connected piece of surface that it is in */
    SELECT_PIECES_INSIDE, /* "pieces_inside": { ... }: pieces of which every vertex is selected */
    SELECT_JOINT /* "joint": a name: how far the file's skin follows it and the joints below it */
} rig_select_kind;

typedef struct rig_select {
    rig_select_kind kind;
    char *path;             /* JSON path, for messages */
    char *name;             /* group, attribute, paint or joint */
    uint32_t *first, *last; /* vertices: range_count inclusive ranges; painted: ascending */
    uint8_t *value;         /* painted: of each range, in 255ths, 1..255; else NULL */
    uint32_t range_count;
    vec3 a, b; /* low and high; centre and radii; point and normal; mm */
    uint32_t vertex;
    double within_mm;
    struct rig_select *child;
    uint32_t child_count;
} rig_select;

typedef enum rig_bone_kind {
    BONE_FIXED = 0,
    BONE_JAW, /* "hinge": open, lateral, forward; slides forward-down as it opens */
    BONE_BALL /* "ball": turns about a centre */
} rig_bone_kind;

#define RIG_NONE UINT32_MAX
/* The degree of freedom that a rig with a mouth has besides those of its bones: 0 open .. 1 sealed.
 */
#define RIG_LIPS_SEAL          "lips.seal"
#define RIG_UPPER_SHARE        0.35
#define RIG_STICKINESS_MOST_MM 50.0
enum { RIG_RIM_LEAST = 3, RIG_RIM_MOST = 4096 }; /* vertices of a rim */
enum { RIG_TURNS_MAX = 3, RIG_BONES_MAX = 16 };

typedef struct rig_follow { /* "follows": { "dof": "eye.l.pitch", "share": -0.6 }: see bones_pose */
    uint32_t bone, turn;    /* a turn of a ball that is listed before and follows none */
    double share;           /* -1..1; 0: it follows none */
} rig_follow;

typedef struct rig_turn { /* of a ball: "turns": [ { "name", "axis": [x,y,z], "deg": [min, max] } ]
                           */
    char *name;
    vec3 axis; /* unit; right-handed */
    double min_rad, max_rad;
    rig_follow follows;
} rig_turn;

typedef struct rig_bone {
    char *name;
    rig_bone_kind kind;
    uint32_t parent;              /* "parent": name; default skull, for the skull none: RIG_NONE */
    vec3 hinge_left, hinge_right; /* mm: the condyles */
    double open_min_rad, open_max_rad, lateral_mm, forward_mm, slide_mm;
    vec3 incisor; /* mm: lower incisor edge, "incisor": [x,y,z]; jaw: where mm of motion are
                     measured; has_incisor false: derived from the mesh (front of the jaw's rigid
                     vertices) */
    bool has_incisor;
    vec3 centre;                  /* ball, mm */
    double radius_mm;             /* 0: not given */
    rig_turn turn[RIG_TURNS_MAX]; /* the first listed is applied last (outermost) */
    uint32_t turn_count;
} rig_bone;

typedef struct rig_region {
    char *name;      /* NULL: none */
    uint32_t source; /* 1 + which of the file's entries it is; 0: new */
    uint32_t bone;
    bool is_rigid;   /* weight 1 on the bone and mobility 0, and no blending into it */
    double weight;   /* 0..1 on the bone; NaN: this region says nothing of weight */
    double mobility; /* 0..1; NaN: says nothing of mobility */
    rig_select select;
} rig_region;

/* Whether an ink of the brush has made it: it has the name of one, and vertices one by one. What is
 * painted does not mark the surface for the fill: it changes what was filled, where it is. */
bool rig_region_is_paint(const rig_region *region);

typedef struct rig_contact {
    char *name;
    uint32_t bone;   /* RIG_NONE: "auto", by the weights of its vertex */
    uint32_t vertex; /* of the mesh file */
    uint32_t mirror; /* index of the contact on the other side; RIG_NONE */
    uint32_t source; /* as of a region */
} rig_contact;

typedef enum rig_proxy_kind {
    PROXY_ELLIPSOID = 0,
    PROXY_TEETH /* "teeth": a row; an ellipse seen from above, level edges */
} rig_proxy_kind;

typedef struct rig_proxy { /* "skull_proxy": skin does not enter it */
    rig_proxy_kind kind;
    uint32_t bone;
    vec3 centre, radii; /* mm */
    uint32_t source;    /* as of a region */
} rig_proxy;

/* "part": "mouth" or "upper": a pose of one half leaves the other half of the face as it is. */
typedef enum rig_pose_part { POSE_WHOLE = 0, POSE_MOUTH, POSE_UPPER } rig_pose_part;

typedef struct rig_pose { /* "poses": [ { "name", "part", "dofs": { name: value }, "pulls": {
                             contact: [x,y,z] } } ] */
    char *name;
    rig_pose_part part;
    char **dof_name;
    double *dof_value; /* rad or mm */
    uint32_t dof_count;
    uint32_t *pull_contact;
    vec3 *pull_mm;
    uint32_t pull_count;
    uint32_t follow_count; /* pulls of other contacts, behind those: see rig_poses_complete; of no
                              file */
} rig_pose;

typedef enum rig_seal_from { SEAL_FROM_CORNERS = 0, SEAL_FROM_MIDDLE } rig_seal_from;

/* "mouth": the two rims of the slit between the lips, which "lips.seal" brings together. */
typedef struct rig_mouth {
    uint32_t *upper, *lower; /* vertices along each rim, from the subject's right corner to the left
                                one; upper NULL: the rig declares no mouth */
    uint32_t upper_count, lower_count;
    double upper_share;   /* 0..1: the upper lip's part of the way; RIG_UPPER_SHARE if not given */
    double stickiness_mm; /* lips closer than that at some place draw together there; 0: none */
    rig_seal_from seal_from; /* where lips close first */
    char *fault;             /* why the file's mouth cannot be read; NULL: it can, or has none */
} rig_mouth;

typedef struct rig_contact_set { /* "contact_sets": { "fit10": [names] } */
    char *name;
    uint32_t *contact;
    uint32_t contact_count;
} rig_contact_set;

typedef struct rig {
    char *path; /* of the file */
    char *name;
    char *mesh_path;    /* as it can be opened: relative to the working directory, or absolute */
    double mm_per_unit; /* of this file's numbers */
    mesh_frame frame;   /* "mesh_unit", "mesh_up", "mesh_forward": of the mesh; zeros: not said */
    uint32_t mesh_vertex_count; /* "mesh_vertices": of the mesh it was made for; 0: not said */
    uint64_t mesh_hash;         /* "mesh_hash": see rig_mesh_hash; 0: not said */
    uint32_t
        *cut_mouth; /* "cut_mouth": what mesh_cut_mouth opens in the mesh as read; NULL: nothing */
    uint32_t cut_mouth_count;
    rig_bone *bone;
    rig_region *region; /* in order: later ones win where two speak of one vertex */
    rig_contact *contact;
    rig_proxy *proxy;
    rig_pose *pose;
    rig_contact_set *contact_set;
    rig_mouth mouth;
    uint32_t bone_count, region_count, contact_count, proxy_count, pose_count, contact_set_count;
    csrbf_settings solver; /* radius in mm; 0: not said */
    double shapes;         /* 0..1: how far the mesh's own shapes answer pulls; 1: not said */
    void *document;        /* the JSON as read, for what this version does not know */
    char *note;            /* unknown keys and the like, lines ended by \n; NULL: nothing */
    size_t copied_bytes;   /* of memory that rig_copy has taken for it; 0: it is no copy */
} rig;

/* What it names must lie in its folder or below (file_check_below), and is paid out of a budget.
 * Errors name the file, the JSON path ("$.contacts[3].vertex"), what was expected, and a remedy. */
CHECKED mrt_result rig_read(rig *out, const char *path, error *err);
/* One that the program itself has put aside: what it names may lie anywhere. */
CHECKED mrt_result rig_read_trusted(rig *out, const char *path, error *err);
/* From bytes, for tests and the fuzzer: `path` is only for messages and for relative names;
 * includes are refused. */
CHECKED mrt_result rig_parse(rig *out, const void *data, size_t size, const char *path, error *err);
/* Writes what was read, included files too, plus what changed in the struct's solver, contacts,
 * regions, bones, poses, contact sets, as one file; beside and renamed. */
CHECKED mrt_result rig_write(const rig *r, const char *path, error *err);
/* Deep; what was read is shared. On error `out` is zeroed. [any] */
CHECKED mrt_result rig_copy(rig *out, const rig *r, error *err);
void rig_destroy(rig *r);             /* accepts NULL and zeroed; [any] */
void rig_pose_finish(rig_pose *pose); /* accepts zeroed; [any] */

/* "mouth", "upper"; NULL: the whole. */
extern const char *const rig_pose_part_name[POSE_UPPER + 1];
uint32_t rig_find_bone(const rig *r, const char *name); /* RIG_NONE */
uint32_t rig_find_jaw(const rig *r);                    /* RIG_NONE */
/* Whether `dof` ("eye.l.pitch") is a turn of a ball. */
bool rig_find_turn(const rig *r, const char *dof, uint32_t *out_bone, uint32_t *out_turn);
/* Why a turn cannot follow what its `follows` names, one sentence; NULL: it can, or follows none.
 */
const char *rig_follow_fault(const rig *r, uint32_t bone, uint32_t turn);
uint32_t rig_find_contact(const rig *r, const char *name);                   /* RIG_NONE */
const rig_contact_set *rig_find_contact_set(const rig *r, const char *name); /* NULL */

/* The share of the radii of a row of teeth that is its core, a level plate: skin is pushed away
 * from the nearest point of it. 0 of an ellipsoid. */
double rig_teeth_core(const rig_proxy *proxy);

/* FNV-1a, 64 bits, of vertex count and triangles. */
uint64_t rig_mesh_hash(uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count);

#endif
