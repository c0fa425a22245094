/* face/rig_edit.h - changes of a rig in memory, as a person makes them: numbers that change become
 * what a hand can mean (0.01 mm, 0.01 degrees, shares of 0.001). Each leaves a rig that can be
 * written and read again, or an error and the rig as it was. Leaves out what is undone
 * (window/rig/model.h) and whether the rig fits its mesh (rig_check.h). Vertices are the mesh
 * file's. [any], one at a time */
#ifndef MAROTTE_FACE_RIG_EDIT_H
#define MAROTTE_FACE_RIG_EDIT_H
#include "face/rig.h"
#include "mesh/mesh.h"

/* ---- regions: later ones win ---- */

typedef struct rig_edit_says { /* what a region says of its vertices, see rig_region */
    uint32_t bone;             /* RIG_NONE: only mobility is said */
    bool is_rigid;
    double weight, mobility; /* NaN: says nothing; both NaN where it is rigid */
} rig_edit_says;
/* Behind the others, of no vertex yet. name NULL or "": none; else no other region's. */
CHECKED mrt_result rig_edit_add_region(rig *r, const char *name, const rig_edit_says *says,
                                       uint32_t *out_index, error *err);
CHECKED mrt_result rig_edit_remove_region(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_move_region(rig *r, uint32_t index, uint32_t to, error *err);
CHECKED mrt_result rig_edit_name_region(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_set_region(rig *r, uint32_t index, const rig_edit_says *says,
                                       error *err);
/* RIG_NONE: no region has it. */
uint32_t rig_edit_find_region(const rig *r, const char *name);

/* Whether a region's vertices are given one by one, so that a brush can change them. */
bool rig_edit_can_paint(const rig *r, uint32_t index);
/* The shares of such a region, in 255ths. */
void rig_edit_values(uint8_t *out, const rig *r, uint32_t index, uint32_t vertex_count);
/* They become the region's, whatever selected its vertices before: stored as vertex numbers where
 * all are 0 or 255, else as paint. */
CHECKED mrt_result rig_edit_paint(rig *r, uint32_t index, const uint8_t *value,
                                  uint32_t vertex_count, error *err);

/* "part teeth_lower*, inside a box": for people. */
void rig_edit_describe(const rig_select *select, char *out, size_t capacity);

/* Of which entry a message's JSON path speaks. */
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
/* It goes out of contact sets and poses too. */
CHECKED mrt_result rig_edit_remove_contact(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_name_contact(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_move_contact(rig *r, uint32_t index, uint32_t vertex, error *err);
/* bone RIG_NONE: by the weights of its vertex. */
CHECKED mrt_result rig_edit_ride(rig *r, uint32_t index, uint32_t bone, error *err);
/* The contact on the other side (NAME.l has NAME.r; made when there is none) is put to `vertex`,
 * and each is the other's mirror. */
CHECKED mrt_result rig_edit_mirror_contact(rig *r, uint32_t index, uint32_t vertex, error *err);

/* "eye.l" gives "eye.r" and the other way round; false: it has no side. */
bool rig_edit_other_side(const char *name, char *out, size_t capacity);

/* ---- bones: the first one carries the face and stays ---- */

/* Of the first bone. A jaw turns about an axis of that half width through `at`, with an adult's
 * limits, and there is one; a ball turns about `at`, up and down and to the sides. Nothing rides on
 * it yet. */
CHECKED mrt_result rig_edit_add_bone(rig *r, const char *name, rig_bone_kind kind, vec3 at,
                                     double half_mm, uint32_t *out_index, error *err);
/* What rode on it rides on its parent; poses no longer move it. */
CHECKED mrt_result rig_edit_remove_bone(rig *r, uint32_t index, error *err);
/* Poses follow. */
CHECKED mrt_result rig_edit_name_bone(rig *r, uint32_t index, const char *name, error *err);
CHECKED mrt_result rig_edit_set_ball(rig *r, uint32_t index, vec3 centre, double radius_mm,
                                     error *err);
/* On a bone that is listed before it; RIG_NONE: on none. */
CHECKED mrt_result rig_edit_ride_bone(rig *r, uint32_t index, uint32_t parent, error *err);

/* The turns of a ball, 1 to RIG_TURNS_MAX, the first is applied last. Copied; the axis becomes
 * unit; the limits are around 0, at most half a turn away. A new one follows none. */
CHECKED mrt_result rig_edit_add_turn(rig *r, uint32_t bone, const rig_turn *turn,
                                     uint32_t *out_index, error *err);
/* Poses no longer turn by it, and no turn follows it. One stays. */
CHECKED mrt_result rig_edit_remove_turn(rig *r, uint32_t bone, uint32_t turn, error *err);
/* Poses follow its name. */
CHECKED mrt_result rig_edit_set_turn(rig *r, uint32_t bone, uint32_t turn, const rig_turn *to,
                                     error *err);

/* ---- what the skin does not enter ---- */

CHECKED mrt_result rig_edit_add_proxy(rig *r, const rig_proxy *proxy, uint32_t *out_index,
                                      error *err);
CHECKED mrt_result rig_edit_remove_proxy(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_set_proxy(rig *r, uint32_t index, const rig_proxy *proxy, error *err);

/* ---- poses ---- */

/* Copied. Its name is no other pose's. */
CHECKED mrt_result rig_edit_add_pose(rig *r, const rig_pose *pose, uint32_t *out_index, error *err);
CHECKED mrt_result rig_edit_remove_pose(rig *r, uint32_t index, error *err);
CHECKED mrt_result rig_edit_name_pose(rig *r, uint32_t index, const char *name, error *err);

/* ---- the mouth ---- */

/* Copied. Whether the rims can be sealed is seen on the mesh (bind_lips). */
CHECKED mrt_result rig_edit_set_mouth(rig *r, const rig_mouth *mouth, error *err);
/* Poses no longer seal the lips. */
void rig_edit_remove_mouth(rig *r);

/* ---- the jaw ---- */

typedef struct rig_edit_jaw {
    vec3 left, right, incisor; /* mm */
    bool has_incisor;
    double open_min_rad, open_max_rad, lateral_mm, forward_mm, slide_mm;
} rig_edit_jaw;
void rig_edit_jaw_of(rig_edit_jaw *out, const rig *r, uint32_t bone);
CHECKED mrt_result rig_edit_set_jaw(rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err);

/* ---- undo: a rig that is being edited, with what it was before each change ---- */

/* Numbered states, 0 the first; the newest RIG_HISTORY_MAX are kept. [any], one at a time */
enum { RIG_HISTORY_MAX = 1025 }; /* 1 024 changes; a state of the puppet takes 40 KB */
typedef struct rig_history rig_history;

/* Takes `first` over, also on error. */
CHECKED mrt_result rig_history_create(rig_history **out, rig *first, error *err);
void rig_history_destroy(rig_history *self); /* NULL is fine */

const rig *rig_history_now(const rig_history *self); /* until the next change */
uint64_t rig_history_number(const rig_history *self);
/* The rig as changed (a rig_copy of the one now) becomes the next state, and is taken over. States
 * that were undone are forgotten. */
void rig_history_push(rig_history *self, rig *changed);
/* Goes to a state that is kept; false: it is not. */
bool rig_history_go(rig_history *self, uint64_t number);

#endif
