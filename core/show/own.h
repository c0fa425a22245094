/* show/own.h - which layer of a take moves which part of the face: patterns of names, the parts
 * that people speak of (mouth, brows) as such patterns, and who speaks where several layers do.
 * A pattern is a name of a contact, a bone or a degree of freedom, and means it and all below it:
 * "jaw" and "jaw.*" own the bone "jaw", its "jaw.open" and the contact "jaw.angle.l", not
 * "jawline". A '*' elsewhere at the end stands for any rest: "lid_*" owns "lid_upper.l". Pure; any
 * thread. */
#ifndef MAROTTE_TAKE_OWN_H
#define MAROTTE_TAKE_OWN_H
#include "show/take.h"

typedef enum own_region {
    OWN_MOUTH = 0, /* lips, corners and tongue */
    OWN_JAW,       /* the bone and the chin */
    OWN_BROWS,     /* and forehead */
    OWN_LIDS,
    OWN_EYES,
    OWN_CHEEKS, /* and the folds beside the nose */
    OWN_NOSE,
    OWN_HEAD, /* turn and nod */
    OWN_REGION_COUNT
} own_region;

enum { OWN_REGION_PATTERNS = 4 };
typedef struct own_part {
    const char *name; /* "mouth" */
    uint32_t pattern_count;
    const char *pattern[OWN_REGION_PATTERNS];
} own_part;
const own_part *own_part_of(own_region region); /* for ever; NULL: no region */
bool own_region_named(const char *name, own_region *out);

bool own_matches(const char *pattern, const char *name);
/* Some name could match both. */
bool own_patterns_meet(const char *a, const char *b);
/* Not empty, without blanks and control characters, '*' only at its end. */
bool own_is_pattern(const char *text);

/* By its patterns; without patterns a layer owns everything. */
bool own_layer_owns(const take_layer *layer, const char *name);
/* A layer is heard if it is not muted, and if it is solo or none is. */
bool own_layer_is_heard(const take *t, uint32_t layer);

/* How much each layer moves `name` at an instant (out: layer_count), gains left out. From the top
 * down each takes its share, as much as its clips speak there, of what those above have left; an
 * additive layer adds its share and leaves all. The shares of layers that are not additive sum to
 * at most 1; what is missing is the rest pose. For tests: a show is performed by the composer. */
void own_weights(double *out, const take *t, const char *name, int64_t at_ns);

#endif
