/* check/child/faces.h - faces to try a mapping on: one like a puppet's, and odd ones. */
#ifndef MAROTTE_CHECK_CHILD_FACES_H
#define MAROTTE_CHECK_CHILD_FACES_H
#include <marotte/plugin.h>

typedef enum face_kind {
    FACE_USUAL = 0, /* 27 contacts, jaw, eyes and lids: the names of rigs/README.md */
    FACE_BARE,      /* no contact, no degree of freedom: a mesh without a rig */
    FACE_ONE,       /* one contact, one degree of freedom */
    FACE_FULL,      /* 64 contacts, MRT_MAX_DOFS degrees of freedom */
    FACE_NO_JAW,    /* contacts, nothing of a jaw */
    FACE_FLAT,      /* no depth at all */
    FACE_TINY,      /* half a millimetre high */
    FACE_HUGE,      /* a hundred metres high */
    FACE_AWAY,      /* 2 m beside the origin */
    FACE_KINDS
} face_kind;

/* Static data: stays. */
const mrt_face *faces_of(face_kind kind);
const char *faces_name(face_kind kind); /* "a flat face" */

/* The host's guard: nothing is pulled further from the face's centre than this, mm. */
double faces_reach_mm(const mrt_face *face, double out_centre[3]);

#endif
