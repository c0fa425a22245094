/* face/rig_edit_parts.h - what the files of rig_edit.h share. Inside the room. [any] */
#ifndef MAROTTE_FACE_RIG_EDIT_PARTS_H
#define MAROTTE_FACE_RIG_EDIT_PARTS_H
#include "face/rig_edit.h"

enum { RIG_EDIT_ENTRIES_MAX = 1024 }; /* as the reader lets a file have */

mrt_result rig_edit_no_memory(error *err);
/* What a file may call something. */
CHECKED mrt_result rig_edit_check_name(const char *name, error *err);
/* *out is owned: freed, and a copy of `name` instead. On error it stays. */
CHECKED mrt_result rig_edit_rename(char **out, const char *name, error *err);
/* Within what a file may say. */
bool rig_edit_is_place(vec3 p);
CHECKED mrt_result rig_edit_check_bone(const rig *r, uint32_t index, error *err);
uint32_t rig_edit_dof_count(const rig *r); /* of all bones */

/* ---- what a hand can mean: 0.01 mm, 0.01 degrees, shares of 0.001 ---- */

/* So a file stays readable. What is as `before` (NaN: nothing was) stays as it is: another program
 * may have written it. */
double rig_edit_round_mm(double mm, double before);
double rig_edit_round_rad(double rad, double before);
double rig_edit_round_share(double share, double before); /* NaN stays */
vec3 rig_edit_round_place(vec3 mm, vec3 before);
extern const vec3 rig_edit_nowhere; /* as `before`: nothing was */

#endif
