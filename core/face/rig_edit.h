/* face/rig_edit.h - edits of a rig in memory. Changed numbers are rounded to what a person can set
 * by hand (0.01 mm, 0.01 degrees, shares of 0.001). After each edit the rig can be written and read
 * again; on error the rig is unchanged. Leaves out the undo commands (window/rig/model.h) and the
 * check against the mesh (rig_check.h). Vertices are indices of the mesh file. [any], one call at a
 * time */
#ifndef MAROTTE_FACE_RIG_EDIT_H
#define MAROTTE_FACE_RIG_EDIT_H
#include "face/rig.h"
#include "mesh/mesh.h"

/* ---- regions: later ones win ---- */

typedef struct rig_edit_region_values { /* values that a region sets for its vertices, see
                                           rig_region */
    uint32_t bone;                      /* RIG_NONE: the region sets only mobility */
    bool is_rigid;
    double weight, mobility; /* NaN: not set; both NaN for a rigid region */
} rig_edit_region_values;
/* Appends a region without vertices. name: NULL or "" for none, else not the name of another
 * region. */
CHECKED mrt_result rig_edit_add_region(rig *r, const char *name, const rig_edit_region_values *says,
                                       uint32_t *out_index, error *err);
CHECKED mrt_result rig_edit_remove_region(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_move_region(rig *r, uint32_t index, uint32_t to, error *err);
CHECKED mrt_result rig_edit_name_region(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_set_region(rig *r, uint32_t index, const rig_edit_region_values *says,
                                       error *err);
/* RIG_NONE if no region has this name. */
uint32_t rig_edit_find_region(const rig *r, const char *name);

/* True if the vertices of a region are listed one by one, so that a brush can change them. */
bool rig_edit_can_paint(const rig *r, uint32_t index);
/* Writes the shares of such a region, in 255ths. */
void rig_edit_values(uint8_t *out, const rig *r, uint32_t index, uint32_t vertex_count);
/* Replaces the selector of a region by these shares. They are stored as vertex numbers if all are 0
 * or 255, else as paint. */
CHECKED mrt_result rig_edit_paint(rig *r, uint32_t index, const uint8_t *value,
                                  uint32_t vertex_count, error *err);

/* Describes a selector for people: "part teeth_lower*, inside a box". */
void rig_edit_describe(const rig_select *select, char *out, size_t capacity);

/* The kind of entry that the JSON path of a message points to. */
typedef enum rig_edit_kind {
    RIG_EDIT_OTHER = 0,
    RIG_EDIT_REGION,
    RIG_EDIT_CONTACT,
    RIG_EDIT_BONE
} rig_edit_kind;
rig_edit_kind rig_edit_kind_at(const rig *r, const char *path, uint32_t *out_index);

/* ---- contacts ---- */

CHECKED mrt_result rig_edit_add_contact(rig *r, const char *name, uint32_t vertex,
                                        uint32_t *out_index, error *err);
/* Also removes it from contact sets and poses. */
CHECKED mrt_result rig_edit_remove_contact(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_name_contact(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_move_contact(rig *r, uint32_t index, uint32_t vertex, error *err);
/* bone RIG_NONE: moves by the weights of its vertex. */
CHECKED mrt_result rig_edit_set_contact_bone(rig *r, uint32_t index, uint32_t bone, error *err);
/* Moves the contact on the other side (NAME.r for NAME.l) to `vertex`, and links both as mirrors.
 * Creates that contact if it does not exist. */
CHECKED mrt_result rig_edit_mirror_contact(rig *r, uint32_t index, uint32_t vertex, error *err);

/* Turns "eye.l" into "eye.r" and vice versa. Returns false if the name has no side. */
bool rig_edit_other_side(const char *name, char *out, size_t capacity);

/* ---- bones: the first one carries the face and cannot be changed ---- */

/* Adds a child of the first bone that moves nothing yet. A jaw turns about an axis of that half
 * width through `at`, with an adult's limits; a rig can have only one. A ball turns about `at`, up
 * and down and to the sides. */
CHECKED mrt_result rig_edit_add_bone(rig *r, const char *name, rig_bone_kind kind, vec3 at,
                                     double half_mm, uint32_t *out_index, error *err);
/* Everything that moved with it moves with its parent. Poses no longer move it. */
CHECKED mrt_result rig_edit_remove_bone(rig *r, uint32_t index, error *err);
/* Poses are updated. */
CHECKED mrt_result rig_edit_name_bone(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_set_ball(rig *r, uint32_t index, vec3 centre, double radius_mm,
                                     error *err);
/* parent: a bone that is listed before it, or RIG_NONE. */
CHECKED mrt_result rig_edit_set_parent(rig *r, uint32_t index, uint32_t parent, error *err);

/* Edit the turns of a ball, 1 to RIG_TURNS_MAX; the first is applied last. The turn is copied and
 * its axis becomes a unit vector. The limits lie around 0, at most half a turn away. A new turn
 * cannot follow another. */
CHECKED mrt_result rig_edit_add_turn(rig *r, uint32_t bone, const rig_turn *turn,
                                     uint32_t *out_index, error *err);
/* Removes it from poses, and from turns that follow it. The last turn cannot be removed. */
CHECKED mrt_result rig_edit_remove_turn(rig *r, uint32_t bone, uint32_t turn, error *err);
/* Poses use the new name. */
CHECKED mrt_result rig_edit_set_turn(rig *r, uint32_t bone, uint32_t turn, const rig_turn *to,
                                     error *err);

/* Lets a ball swing, or sets the values of its spring. frequency_hz 0: it no longer swings. */
CHECKED mrt_result rig_edit_set_spring(rig *r, uint32_t bone, const rig_spring *spring, error *err);
/* Sets the share of their swing that loose parts show, 0..1. */
CHECKED mrt_result rig_edit_set_springs(rig *r, double share, error *err);

/* ---- collision shapes ---- */

CHECKED mrt_result rig_edit_add_proxy(rig *r, const rig_proxy *proxy, uint32_t *out_index,
                                      error *err);
CHECKED mrt_result rig_edit_remove_proxy(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_set_proxy(rig *r, uint32_t index, const rig_proxy *proxy, error *err);

/* ---- poses ---- */

/* Copies the pose. Its name must differ from those of all other poses. */
CHECKED mrt_result rig_edit_add_pose(rig *r, const rig_pose *pose, uint32_t *out_index, error *err);
CHECKED mrt_result rig_edit_remove_pose(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_name_pose(rig *r, uint32_t index, const char *name, error *err);

/* ---- the mouth ---- */

/* Copies the mouth. Whether its rims can be sealed is checked on the mesh (bind_lips). */
CHECKED mrt_result rig_edit_set_mouth(rig *r, const rig_mouth *mouth, error *err);
/* Also removes the seal from poses. */
void rig_edit_remove_mouth(rig *r);

/* ---- the jaw ---- */

typedef struct rig_edit_jaw {
    vec3 left, right, incisor; /* mm */
    bool has_incisor;
    double open_min_rad, open_max_rad, lateral_mm, forward_mm, slide_mm;
} rig_edit_jaw;
void rig_edit_jaw_of(rig_edit_jaw *out, const rig *r, uint32_t bone);
CHECKED mrt_result rig_edit_set_jaw(rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err);

/* ---- undo history of a rig ---- */

/* Numbered states, beginning with 0; the newest RIG_HISTORY_MAX are kept. [any], one call at a
 * time */
enum { RIG_HISTORY_MAX = 1025 }; /* 1024 edits; a state of the puppet takes 40 KB */
typedef struct rig_history rig_history;

/* Takes ownership of `first`, also on error. */
CHECKED mrt_result rig_history_create(rig_history **out, rig *first, error *err);
void rig_history_destroy(rig_history *self); /* accepts NULL */

const rig *rig_history_current(const rig_history *self); /* valid until the next change */
uint64_t rig_history_number(const rig_history *self);
/* Appends `changed`, a modified rig_copy of the current state, and takes ownership of it. Discards
 * states that were undone. */
void rig_history_push(rig_history *self, rig *changed);
/* Makes a stored state current. Returns false if it was evicted. */
bool rig_history_restore(rig_history *self, uint64_t number);

#endif
