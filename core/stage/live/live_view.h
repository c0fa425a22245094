/* stage/live/live_view.h - the data that the window displays of a live stage: the newest face, the
 * hands, and the position on the timeline. Plain data, filled by the frame thread. */
#ifndef MAROTTE_STAGE_LIVE_VIEW_H
#define MAROTTE_STAGE_LIVE_VIEW_H
#include "base/stamps.h"
#include "face/face.h"
#include <marotte/plugin.h>

typedef enum live_mode {
    LIVE_PERFORMS = 0, /* the live hands move the face */
    LIVE_SHOWS,        /* a take is paused, played or scrubbed */
    LIVE_OVERDUBS      /* a take plays and the hands perform over it */
} live_mode;

enum { LIVE_CONTACTS_MAX = 256, LIVE_ROWS = 64 };
typedef struct live_view {
    uint64_t number;                /* +1 with each published face that differs from the last one */
    const float *position, *normal; /* vertex_count by 3, mm, in the order of the mesh file */
    const stamps *changed;          /* changed vertices, in groups of LIVE_ROWS */
    uint32_t vertex_count;
    const mrt_face *about;
    uint32_t contact_count;
    vec3 contact[LIVE_CONTACTS_MAX]; /* current positions, mm */
    rigid bone[RIG_BONES_MAX];
    live_mode mode;
    mrt_hand hand[2]; /* live hands as the mapping receives them, without a position relative to the
                         face */
    float pedal[MRT_MAX_PEDALS];
    mrt_pull pull; /* pull of all layers and the pointer */
    bool is_anchored;
    csrbf_settings solver; /* radius > 0 */
    face_meter meter;
    double min_determinant; /* measured some times per second; 1: no fold */
    double penetration_mm;
    surface_state skin;   /* measured together with min_determinant */
    int64_t sample_ns;    /* host clock: time of the newest live sample in it; 0: none */
    int64_t published_ns; /* host clock */
    /* the timeline; all 0 in LIVE_PERFORMS */
    int64_t at_ns;
    bool is_playing, is_recording_over;
    uint32_t pass;
} live_view;

#endif
