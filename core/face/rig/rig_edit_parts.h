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

#endif
