/* face/rig_check_parts.h - the subjects of rig_check, a file each. Inside the room. [main] */
#ifndef MAROTTE_FACE_RIG_CHECK_PARTS_H
#define MAROTTE_FACE_RIG_CHECK_PARTS_H
#include "face/rig_check.h"
#include "face/rig/rig_document.h"
#include "face/rig/rig_head.h"

typedef struct rig_checking {
    const rig *r;
    const mesh *m;
    const topology *t;
    const binding *binding;  /* or NULL */
    const bind_marks *marks; /* or NULL: they could not be made */
    const rig_head *head;    /* or NULL: no profile was found */
    double radius_mm;        /* the rig's, or a quarter of the height */
    rig_findings *out;
    bool is_out_of_memory;
} rig_checking;

__attribute__((format(printf, 4, 5))) void rig_find(rig_checking *c, rig_severity severity,
                                                    const char *path, const char *format, ...);

/* rig_check_mesh.c */
void rig_check_size(rig_checking *c);
void rig_check_mesh_hash(rig_checking *c);
void rig_check_symmetry(rig_checking *c);
void rig_check_surface(rig_checking *c); /* loose parts, sides turned in, holes */
/* rig_check_contacts.c */
CHECKED mrt_result rig_check_seams(const rig *r, const mesh *m, const bind_marks *marks,
                                   const binding *b, error *err);
void rig_check_contacts(rig_checking *c);
/* rig_check_jaw.c */
CHECKED mrt_result rig_check_hinge(const rig *r, error *err);
void rig_check_jaw(rig_checking *c);

#endif
