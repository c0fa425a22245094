/* show/own.h - which layer of a take moves which part of the face. A layer owns patterns of names;
 * common parts (mouth, brows) are sets of such patterns. Also computes the weights where several
 * layers move the same name. Leaves out the blending itself (stage).
 *
 * A pattern is the name of a contact, a bone or a degree of freedom, and includes all names below
 * it. "jaw" and "jaw.*" own the bone "jaw", its "jaw.open" and the contact "jaw.angle.l", but not
 * "jawline". A '*' after another letter matches any rest: "lid_*" owns "lid_upper.l". Pure; any
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
const own_part *own_part_of(own_region region); /* never freed; NULL: invalid region */
bool own_region_named(const char *name, own_region *out);

bool own_matches(const char *pattern, const char *name);
/* Returns true if some name could match both patterns. */
bool own_patterns_overlap(const char *a, const char *b);
/* Returns true if the text is not empty, has no spaces or control characters, and has '*' only at
 * its end. */
bool own_is_pattern(const char *text);

/* Returns true if a pattern of the layer matches. A layer without patterns owns all names. */
bool own_layer_owns(const take_layer *layer, const char *name);
/* Returns true if the layer is active: it is not muted, and it is solo or no layer is solo. */
bool own_layer_is_active(const take *t, uint32_t layer);

/* Computes the weight of each layer for `name` at an instant, without gains. out: layer_count. From
 * the top layer down, each layer gets its share of the weight that the layers above have left. Its
 * share is the weight of its clips at that instant. An additive layer adds its share and leaves the
 * remaining weight unchanged. The weights of the other layers sum to at most 1, and the rest pose
 * has the remaining weight. For tests: the composer performs a show. */
void own_weights(double *out, const take *t, const char *name, int64_t at_ns);

#endif
