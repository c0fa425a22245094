/* face/rig_check.h - checks of a rig against its mesh. rig_validate reports the first error that
 * makes the rig unusable; rig_check reports everything that a person should look at. [main] */
#ifndef MAROTTE_FACE_RIG_CHECK_H
#define MAROTTE_FACE_RIG_CHECK_H
#include "face/bind.h"

/* Reports the first of these errors: another vertex count, a vertex that does not exist, a selector
 * that names nothing, a bone without vertices, overlapping rigid regions, a hinge with its ends
 * exchanged, a contact on a seam between bones. Messages begin with the JSON path. */
CHECKED mrt_result rig_validate(const rig *r, const mesh *m, const topology *t, error *err);

typedef enum rig_severity { RIG_NOTE = 0, RIG_WARNING, RIG_ERROR } rig_severity;

typedef struct rig_finding {
    rig_severity severity;
    char path[128]; /* JSON path */
    char text[512]; /* one line: the finding, and what to do */
} rig_finding;

typedef struct rig_findings {
    rig_finding *item; /* errors first, then warnings, then notes */
    uint32_t count, capacity;
} rig_findings;

/* Fills `out`. Returns an error only if there is no memory. b: the binding, or NULL if none could
 * be made; checks that need filled weights are then left out. */
CHECKED mrt_result rig_check(rig_findings *out, const rig *r, const mesh *m, const topology *t,
                             const binding *b, error *err);
/* Adds how far the limit holds each pose back, as a warning above 0.5 mm. Also adds how much
 * complete poses differ from poses with only the named contacts (rig_poses_complete). Takes some ms
 * per pose. The rig must be valid. */
CHECKED mrt_result rig_check_poses(rig_findings *out, const rig *r, const mesh *m,
                                   const topology *t, const binding *b, error *err);
void rig_findings_finish(rig_findings *findings); /* accepts zeroed */
uint32_t rig_findings_count(const rig_findings *findings, rig_severity severity);

#endif
