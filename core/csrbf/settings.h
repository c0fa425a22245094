/* csrbf/settings.h - settings of a field: kernel, polynomial, radius; and the classes of controls.
 * Pure. [any] */
#ifndef MAROTTE_CSRBF_SETTINGS_H
#define MAROTTE_CSRBF_SETTINGS_H
#include "csrbf/points.h"

typedef enum csrbf_kernel {
    CSRBF_WENDLAND_C2 = 0,
    CSRBF_WENDLAND_C0,
    CSRBF_WENDLAND_C4,
    CSRBF_WENDLAND_C6
} csrbf_kernel;

typedef enum csrbf_polynomial {
    CSRBF_NONE = 0, /* exactly local */
    CSRBF_CONSTANT, /* global */
    CSRBF_LINEAR,   /* global: the paper's equations (1) to (3) */
    CSRBF_WINDOWED  /* linear inside the union of supports, with the weight 1 - prod(1 - phi_i) */
} csrbf_polynomial;

#define CSRBF_STRETCH_MOST 8.0

typedef struct csrbf_settings {
    csrbf_kernel kernel;
    csrbf_polynomial polynomial;
    double radius; /* > 0, finite; the same for all centres */
    double ridge; /* >= 0; added to the diagonal, so that interpolation is approximate; default 0 */
    bool is_one_step;    /* unanchored: each sample is one step, even if the map folds */
    double stretch_most; /* used by a face (face/face.h), not by the engine: limit for stretching
                            and folding of its skin; 0: CSRBF_STRETCH_MOST; < 0: no limit */
} csrbf_settings;

/* Accept "wendland_c2" ..., "none" ...; false: unknown word. */
bool csrbf_kernel_named(const char *name, csrbf_kernel *out);
bool csrbf_polynomial_named(const char *name, csrbf_polynomial *out);
const char *csrbf_kernel_name(csrbf_kernel of);
const char *csrbf_polynomial_name(csrbf_polynomial of);
/* Rejects unknown, non-finite and out-of-range values. */
CHECKED mrt_result csrbf_settings_check(const csrbf_settings *settings, error *err);

/* If centres coincide (closer than 1e-3 R), only those of the highest class count. */
typedef enum csrbf_class { CSRBF_TIP = 0, CSRBF_JAW, CSRBF_SKULL } csrbf_class;

#endif
