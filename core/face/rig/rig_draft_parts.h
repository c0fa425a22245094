/* face/rig_draft_parts.h - the subjects of rig_draft, a file each. Coordinates in the JSON are mm.
 * Inside the room. [main] */
#ifndef MAROTTE_FACE_RIG_DRAFT_PARTS_H
#define MAROTTE_FACE_RIG_DRAFT_PARTS_H
#include "face/rig_draft.h"
#include "face/rig/rig_head.h"
#include "face/rig/rig_json.h"

typedef struct rig_drafting {
    const mesh *m;
    rig_head head;
    double reach_mm; /* from the nose down to the chin: what a face is measured in */
    json_t *bones, *regions, *contacts;
    char *confirm; /* lines */
} rig_drafting;

json_t *rig_draft_point(vec3 p); /* to 0.1 mm */

/* rig_draft_contacts.c: the 27 standard contacts, as far as the face has room for them. */
void rig_draft_contacts(rig_drafting *d);
/* The vertex of a contact that is there; RIG_NONE: it is not. */
uint32_t rig_draft_contact_vertex(const rig_drafting *d, const char *name);
/* rig_draft_regions.c */
void rig_draft_regions_by_name(rig_drafting *d); /* teeth, tongue, eyes; eyes become bones */
void rig_draft_regions_by_place(rig_drafting *d);

#endif
