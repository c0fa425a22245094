/* face/rig.h - a rig file, NAME.rig.json version 1: the mesh, its bones, the regions of
 * vertices that they move, the contacts, and the settings of the solver. Reads, validates and
 * writes the file; bind.h applies it to a mesh. In memory all lengths are in mm and all angles
 * in rad, whatever the unit of the file. Unknown keys are kept and written back. [main] */
#ifndef MAROTTE_FACE_RIG_H
#define MAROTTE_FACE_RIG_H
#include "base/error.h"
#include "base/rigid.h"
#include "csrbf/csrbf.h"
#include "mesh/frame.h"

/* "select": the vertices of a region. It evaluates to a weight per vertex: 0 or 1, or any value
 * in between for attributes, joints and paints. */
typedef enum rig_select_kind {
    SELECT_NOTHING = 0,
    SELECT_VERTICES, /* "vertices": [204, "120-180"] */
    SELECT_GROUP, /* "group": name of a part, material or node; '*' at its end matches any rest */
    SELECT_ATTRIBUTE,     /* "attribute": "_SKULL" (first component, clamped to 0..1) */
    SELECT_BOX,           /* "box": { "low": [x,y,z], "high": [x,y,z] } */
    SELECT_ELLIPSOID,     /* "ellipsoid": { "centre": [x,y,z], "radii": [x,y,z] } */
    SELECT_HALF_SPACE,    /* "half_space": { "point": [x,y,z], "normal": [x,y,z] }: on the side that
                             the normal points to */
    SELECT_WITHIN,        /* "within": { "mm": d, "of": vertex }: distance along the surface */
    SELECT_ALL,           /* "all": [ ... ]: least of their weights */
    SELECT_ANY,           /* "any": [ ... ]: greatest of their weights */
    SELECT_NOT,           /* "not": { ... } */
    SELECT_PAINTED,       /* "painted": a name in the rig's "paints" */
    SELECT_PIECE,         /* "piece": vertex: the connected piece of surface that contains it */
    SELECT_PIECES_INSIDE, /* "pieces_inside": { ... }: pieces with every vertex selected */
    SELECT_JOINT /* "joint": a name: weight in the file's skin of that joint and of those below it
                  */
} rig_select_kind;

typedef struct rig_select {
    rig_select_kind kind;
    char *path;             /* JSON path, for messages */
    char *name;             /* group, attribute, paint or joint */
    uint32_t *first, *last; /* vertices: range_count inclusive ranges; ascending for paints */
    uint8_t *value;         /* value of each range for paints, in 255ths, 1..255; else NULL */
    uint32_t range_count;
    vec3 a, b; /* low and high, centre and radii, or point and normal; mm */
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
/* Degree of freedom of a rig with a mouth, in addition to those of its bones: 0 open .. 1
 * sealed. */
#define RIG_LIPS_SEAL          "lips.seal"
#define RIG_UPPER_SHARE        0.35
#define RIG_STICKINESS_MOST_MM 50.0
enum { RIG_RIM_LEAST = 3, RIG_RIM_MOST = 4096 }; /* vertex count of a rim */
enum { RIG_TURNS_MAX = 3, RIG_BONES_MAX = 16 };

typedef struct rig_follow { /* "follows": { "dof": "eye.l.pitch", "share": -0.6 }: see bones_pose */
    uint32_t bone, turn; /* a turn of a ball that is listed before, and that follows none itself */
    double share;        /* -1..1; 0 if the turn follows none */
} rig_follow;

/* Of a ball: "turns": [ { "name", "axis": [x,y,z], "deg": [min, max] } ] */
typedef struct rig_turn {
    char *name;
    vec3 axis; /* unit; right-handed */
    double min_rad, max_rad;
    rig_follow follows;
} rig_turn;

/* Of a ball: "spring": { "tip", "frequency_hz", "damping", "inertia", "gravity", "radius_mm" }. The
 * part swings about the pose to which its turns are driven, within their limits. */
typedef struct rig_spring {
    vec3 tip;            /* the middle of its mass, mm */
    double frequency_hz; /* of its free swing; 0: the bone does not swing */
    double damping;      /* ratio: 1 returns without swinging on */
    double inertia;      /* 0..1: share of the motion of its root that the mass resists */
    double gravity;      /* 0..1: share of the weight that pulls it down when its parent tilts */
    double radius_mm;    /* of the ball around the tip that collision shapes push away */
} rig_spring;
#define RIG_SPRING_LEAST_HZ     0.2
#define RIG_SPRING_MOST_HZ      20.0
#define RIG_SPRING_LEAST_DAMPED 0.02
#define RIG_SPRING_MOST_DAMPED  4.0
#define RIG_SPRING_LEAST_MM     0.1 /* least distance of the tip from the centre */
/* A spring as most loose parts have it. */
#define RIG_SPRING_HZ      3.0
#define RIG_SPRING_DAMPING 0.3

typedef struct rig_bone {
    char *name;
    rig_bone_kind kind;
    uint32_t parent;              /* "parent": name; the default is skull; RIG_NONE for the skull */
    vec3 hinge_left, hinge_right; /* the condyles, mm */
    double open_min_rad, open_max_rad, lateral_mm, forward_mm, slide_mm;
    vec3 incisor; /* lower incisor edge, mm, "incisor": [x,y,z]; the motion of a jaw in mm is
                     measured here; without has_incisor it is derived from the mesh (front of the
                     jaw's rigid vertices) */
    bool has_incisor;
    vec3 centre;                  /* of a ball, mm */
    double radius_mm;             /* 0: not given */
    rig_turn turn[RIG_TURNS_MAX]; /* the first listed is applied last (outermost) */
    uint32_t turn_count;
    rig_spring spring;
} rig_bone;

typedef struct rig_region {
    char *name;      /* NULL if it has none */
    uint32_t source; /* 1 + index of its entry in the file; 0 if new */
    uint32_t bone;
    bool is_rigid;   /* weight 1 on the bone, mobility 0, no blending into it */
    double weight;   /* 0..1 on the bone; NaN if this region sets no weight */
    double mobility; /* 0..1; NaN if this region sets no mobility */
    rig_select select;
} rig_region;

/* True for a region made with the brush: it has the name of a brush ink, and single vertices.
 * The fill ignores painted regions. They change its result afterwards, where they are painted. */
bool rig_region_is_paint(const rig_region *region);

typedef struct rig_contact {
    char *name;
    uint32_t bone;   /* RIG_NONE: "auto", from the weights of its vertex */
    uint32_t vertex; /* index in the mesh file */
    uint32_t mirror; /* index of the contact on the other side, or RIG_NONE */
    uint32_t source; /* as in rig_region */
} rig_contact;

typedef enum rig_proxy_kind {
    PROXY_ELLIPSOID = 0,
    PROXY_TEETH /* "teeth": a row of teeth: an ellipse seen from above, with level edges */
} rig_proxy_kind;

typedef struct rig_proxy { /* "skull_proxy": a shape that the skin cannot enter */
    rig_proxy_kind kind;
    uint32_t bone;
    vec3 centre, radii; /* mm */
    uint32_t source;    /* as in rig_region */
} rig_proxy;

/* "part": "mouth" or "upper". A pose of one half does not move the other half of the face. */
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
    uint32_t follow_count; /* number of derived pulls, of other contacts, stored after those of the
                              file (rig_poses_complete) */
} rig_pose;

typedef enum rig_seal_from { SEAL_FROM_CORNERS = 0, SEAL_FROM_MIDDLE } rig_seal_from;

/* "mouth": the two rims of the slit between the lips. RIG_LIPS_SEAL brings them together. */
typedef struct rig_mouth {
    uint32_t *upper, *lower; /* vertices along each rim, from the subject's right corner to the left
                                one; upper NULL: the rig declares no mouth */
    uint32_t upper_count, lower_count;
    double upper_share;      /* 0..1: the part of the way that the upper lip moves; default
                                RIG_UPPER_SHARE */
    double stickiness_mm;    /* lips that are closer than this draw together; 0: none */
    rig_seal_from seal_from; /* the place where lips close first */
    char *fault; /* why the mouth in the file cannot be read; NULL if it can, or if there is none */
} rig_mouth;

typedef struct rig_contact_set { /* "contact_sets": { "fit10": [names] } */
    char *name;
    uint32_t *contact;
    uint32_t contact_count;
} rig_contact_set;

typedef struct rig {
    char *path; /* of the file */
    char *name;
    char *mesh_path;    /* usable for opening: relative to the working directory, or absolute */
    double mm_per_unit; /* unit of the numbers in this file */
    mesh_frame frame;   /* "mesh_unit", "mesh_up", "mesh_forward" of the mesh; zeros if not set */
    uint32_t mesh_vertex_count; /* "mesh_vertices": vertex count of its mesh; 0 if not set */
    uint64_t mesh_hash;         /* "mesh_hash": see rig_mesh_hash; 0 if not set */
    uint32_t *cut_mouth;        /* "cut_mouth": the chain for mesh_cut_mouth; NULL if none */
    uint32_t cut_mouth_count;
    rig_bone *bone;
    rig_region *region; /* in order: where two regions set the same vertex, the later one wins */
    rig_contact *contact;
    rig_proxy *proxy;
    rig_pose *pose;
    rig_contact_set *contact_set;
    rig_mouth mouth;
    uint32_t bone_count, region_count, contact_count, proxy_count, pose_count, contact_set_count;
    csrbf_settings solver; /* radius in mm; 0 if not set */
    double shapes;  /* 0..1: strength with which the mesh's own shapes answer pulls; default 1 */
    double springs; /* 0..1: share of their swing that loose parts show; 0: they hold still */
    void *document; /* the JSON that was read, with keys that this version does not know */
    char *note;     /* unknown keys and other remarks, lines that end in \n; NULL if none */
    size_t copied_bytes; /* memory that rig_copy took for it; 0 if it is not a copy */
} rig;

/* Reads a rig. Files that it names must be in its folder or below (file_check_below); a budget
 * limits the work. Error messages name the file, the JSON path ("$.contacts[3].vertex"), what
 * was expected, and a remedy. */
CHECKED mrt_result rig_read(rig *out, const char *path, error *err);
/* Reads a rig that the program itself stored. The files that it names can be anywhere. */
CHECKED mrt_result rig_read_trusted(rig *out, const char *path, error *err);
/* Reads a rig from bytes, for tests and the fuzzer. `path` is used only for messages and
 * relative names. Includes are refused. */
CHECKED mrt_result rig_parse(rig *out, const void *data, size_t size, const char *path, error *err);
/* Writes everything that was read, with the current solver, contacts, regions, bones, poses and
 * contact sets. The result is one file, without includes. It is written under another name and then
 * renamed. */
CHECKED mrt_result rig_write(const rig *r, const char *path, error *err);
/* Deep copy, but the JSON that was read is shared. On error `out` is zeroed. [any] */
CHECKED mrt_result rig_copy(rig *out, const rig *r, error *err);
void rig_destroy(rig *r);             /* accepts NULL and zeroed; [any] */
void rig_pose_finish(rig_pose *pose); /* accepts zeroed; [any] */

/* "mouth", "upper"; NULL for the whole face */
extern const char *const rig_pose_part_name[POSE_UPPER + 1];
uint32_t rig_find_bone(const rig *r, const char *name); /* RIG_NONE if not found */
uint32_t rig_find_jaw(const rig *r);                    /* RIG_NONE if not found */
/* True if `dof` (such as "eye.l.pitch") is a turn of a ball. */
bool rig_find_turn(const rig *r, const char *dof, uint32_t *out_bone, uint32_t *out_turn);
/* Returns why a turn cannot follow the turn in its `follows`: the end of a sentence that begins
 * with that turn. NULL if it can, or if it follows none. */
const char *rig_follow_fault(const rig *r, uint32_t bone, uint32_t turn);
uint32_t rig_find_contact(const rig *r, const char *name); /* RIG_NONE if not found */
const rig_contact_set *rig_find_contact_set(const rig *r, const char *name); /* NULL if not found */

/* Returns the core of a row of teeth as a share of its radii. The core is a level plate; skin
 * is pushed away from its nearest point. 0 for an ellipsoid. */
double rig_teeth_core(const rig_proxy *proxy);

/* FNV-1a, 64 bits, of the vertex count and the triangles. */
uint64_t rig_mesh_hash(uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count);

#endif
