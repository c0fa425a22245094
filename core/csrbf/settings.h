/* csrbf/settings.h - what a field is asked to be: kernel, polynomial, radius; and the classes of
 * controls. Pure; any thread. */
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
    CSRBF_NONE = 0, /* exact locality */
    CSRBF_CONSTANT, /* global */
    CSRBF_LINEAR,   /* global: the paper's equations (1) to (3) */
    CSRBF_WINDOWED  /* linear inside the union of supports, faded by 1 - prod(1 - phi_i) */
} csrbf_polynomial;

#define CSRBF_STRETCH_MOST 8.0

typedef struct csrbf_settings {
    csrbf_kernel kernel;
    csrbf_polynomial polynomial;
    double radius; /* > 0, finite; one for all centres */
    double ridge; /* >= 0; added to the diagonal: interpolation becomes approximate; 0 by default */
    bool is_one_step;    /* unanchored: each sample is one step, even where the map folds */
    double stretch_most; /* of a face (face/face.h), not of the engine: nothing of its skin is
                            stretched further, nor folds; 0: CSRBF_STRETCH_MOST; < 0: no limit */
} csrbf_settings;

/* "wendland_c2" ..., "none" ...; false: unknown word. */
bool csrbf_kernel_named(const char *name, csrbf_kernel *out);
bool csrbf_polynomial_named(const char *name, csrbf_polynomial *out);
const char *csrbf_kernel_name(csrbf_kernel of);
const char *csrbf_polynomial_name(csrbf_polynomial of);
/* Refuses what is unknown, not finite or out of range. */
CHECKED mrt_result csrbf_settings_check(const csrbf_settings *settings, error *err);

/* When centres coincide (closer than 1e-3 R), only those of the highest class present count. */
typedef enum csrbf_class { CSRBF_TIP = 0, CSRBF_JAW, CSRBF_SKULL } csrbf_class;

#endif
