/* stage/perform/layer_state.h - what a layer is made of. Inside layer*.c. */
#ifndef MAROTTE_STAGE_LAYER_STATE_H
#define MAROTTE_STAGE_LAYER_STATE_H
#include "stage/guard.h"
#include "stage/layer.h"
#include "stage/seam.h"

struct layer_room {
    double *last_params;   /* of the sample before */
    double *stored_params; /* while a state is loaded */
    unsigned char
        *taught; /* TAUGHT_BYTES_MAX, while the mapping is reset; NULL: it learns nothing */
};

/* From one who pulls to another. */
typedef struct cut {
    bool is_waiting; /* for the first pull of the new one */
    bool is_other;   /* while waiting: the new one is another mapping */
    bool is_fading;
    bool is_leaving; /* while fading: `leaving` is seen */
    bool is_homing;  /* while fading: to rest, before the new one begins (layer_go_home) */
    double fade_s;
    uint32_t side;
    uint32_t anchor_shift;     /* added to the mapping's anchors */
    float posed[MRT_MAX_DOFS]; /* of another mapping: the bones when it came */
    mrt_pull leaving;
    mrt_pull shown; /* with the shift, or at rest; in use while there is one, or while homing */
} cut;

/* What is pulled on the way home: nothing, and the bones that `leaving` drove are at rest. */
mrt_pull layer_home(const mrt_pull *leaving);

struct layer {
    instance *mapping;
    const mrt_mapping *functions;
    const mrt_resume *resume; /* NULL: it has none */
    const stage_seam *seam;   /* NULL: nobody takes turns */
    const mrt_face *about;
    guard guard;
    layer_settings settings;
    hands *hands;
    pointer pointer;
    bool resets; /* the mapping is to begin anew, once nothing is between */
    mrt_frame frame;
    mrt_pull pull; /* what the mapping fills; it sees its own last values */
    mrt_pull good; /* the last that passed the guard */
    cut cut;
    bool has_time;
    layer_room *room;
    layer_on_param *on_param;
    void *on_param_data;
    layer_counts counts;
};

#endif
