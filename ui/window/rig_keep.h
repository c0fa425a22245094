/* window/rig_keep.h - the file that keeps a rig which is not saved yet, so that nothing is lost
 * when the program ends: NAME.rig.json.unsaved in the folder of the settings, or with a number in
 * its name where another rig of that name is kept there. [main] */
#ifndef MAROTTE_UI_WINDOW_RIG_KEEP_H
#define MAROTTE_UI_WINDOW_RIG_KEEP_H
#include "face/rig.h"
#include "mesh/mesh.h"

typedef struct rig_keep {
    char *path;       /* what is written now; NULL: nothing is kept */
    char *old_path;   /* of another time; NULL: none is there */
    char *taken_path; /* the same, taken up and not saved since; NULL: none */
    bool is_begun;
} rig_keep;

/* Looks whether something is kept of the rig at rig_path. folder "": nothing is kept. */
CHECKED mrt_result rig_keep_open(rig_keep *out, const char *folder, const char *rig_path,
                                 error *err);
void rig_keep_close(rig_keep *self); /* the files stay */
/* Where to write the rig as it is now; what another time has left is moved out of the way. NULL:
 * nowhere. Until rig_keep_close. */
const char *rig_keep_begin(rig_keep *self);
/* It is saved, or given up: the file goes. Nobody may be writing it. */
void rig_keep_end(rig_keep *self);
void rig_keep_drop_old(rig_keep *self); /* what is of another time goes */
bool rig_keep_has_old(const rig_keep *self);
/* What is of another time; refuses one for another mesh. */
CHECKED mrt_result rig_keep_read(rig_keep *self, rig *out, const mesh *m, error *err);

#endif
