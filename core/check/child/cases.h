/* check/child/cases.h - the cases: each runs in a separate process, judges rules, and reports its
 * findings. A rule that a case reports as ok was judged without a finding. */
#ifndef MAROTTE_CHECK_CHILD_CASES_H
#define MAROTTE_CHECK_CHILD_CASES_H
#include <marotte/plugin.h>

/* ---- the types of the library ---- */

enum { TYPES_MAX = 16, TYPES_PARAMS_MAX = 1024, TYPES_INTERFACES_MAX = 64 };

typedef struct types {
    uint32_t count;
    const mrt_plugin_type *type[TYPES_MAX];
} types;

/* Returns false after reporting the broken rule (library.load, library.symbol, library.abi). */
bool types_load(types *out, const char *path);

const void *types_interface(const mrt_plugin_type *type, const char *id);

/* Returns a checksum of the tables and of everything that they point to. */
uint64_t types_sum(const mrt_plugin_type *type);

/* ---- cases ---- */

typedef struct examination {
    const mrt_plugin_type *type;
    uint64_t seed;
    const char *input_address, *output_address; /* NULL: not given */
    uint32_t divisor;                           /* of the number of random frames; at least 1 */
} examination;

void cases_tables(const types *all);   /* for the library; runs before all others */
void cases_type(const examination *e); /* for the tables of a type; runs before the rest */
void cases_smoke(const examination *e);
void cases_life(const examination *e);
void cases_destroy_null(const examination *e);
void cases_faces(const examination *e);
void cases_growth(const examination *e);
void cases_walk(const examination *e);
void cases_restless(const examination *e);
void cases_hands(const examination *e);
void cases_engage(const examination *e);
void cases_deadline(const examination *e);
void cases_replay(const examination *e);
void cases_sum(const examination *e);
void cases_state(const examination *e);
void cases_resume(const examination *e);
void cases_rig_poses(const examination *e);
void cases_absent(const examination *e);
void cases_input(const examination *e);
void cases_recorded(const examination *e);
void cases_stop(const examination *e);
void cases_devices(const examination *e);
void cases_output(const examination *e);
void cases_face_output(const examination *e);

#endif
