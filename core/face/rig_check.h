/* face/rig_check.h - is this rig right for this mesh? rig_validate says what makes it unusable;
 * rig_check says everything that a person should look at. [main] */
#ifndef MAROTTE_FACE_RIG_CHECK_H
#define MAROTTE_FACE_RIG_CHECK_H
#include "face/bind.h"

/* The first of: another vertex count, a vertex that is not there, a selector that names nothing, a
 * bone without vertices, overlapping rigid regions, a hinge with its ends exchanged, a contact on a
 * seam between bones. Messages begin with the JSON path. */
CHECKED mrt_result rig_validate(const rig *r, const mesh *m, const topology *t, error *err);

typedef enum rig_severity { RIG_NOTE = 0, RIG_WARNING, RIG_ERROR } rig_severity;

typedef struct rig_finding {
    rig_severity severity;
    char path[128]; /* JSON path */
    char text[512]; /* one line: what, and what to do */
} rig_finding;

typedef struct rig_findings {
    rig_finding *item; /* errors first, then warnings, then notes */
    uint32_t count, capacity;
} rig_findings;

/* Fills `out`; an error only where there is no memory. `b`: the binding where one could be made,
 * or NULL: then what needs filled weights is left out. */
CHECKED mrt_result rig_check(rig_findings *out, const rig *r, const mesh *m, const topology *t,
                             const binding *b, error *err);
/* Adds how far the fold guard holds each pose back, warnings above 0.5 mm; and how near complete
 * poses come to what the contacts that they name do alone (rig_poses_complete). Some ms for each
 * pose. The rig is valid. */
CHECKED mrt_result rig_check_poses(rig_findings *out, const rig *r, const mesh *m,
                                   const topology *t, const binding *b, error *err);
void rig_findings_finish(rig_findings *findings); /* accepts zeroed */
uint32_t rig_findings_count(const rig_findings *findings, rig_severity severity);

#endif
