/* stage/live/live_view.h - what the window sees of a live stage: the newest face, who moves it, and
 * where the timeline stands. Plain data, filled by the frame thread. */
#ifndef MAROTTE_STAGE_LIVE_VIEW_H
#define MAROTTE_STAGE_LIVE_VIEW_H
#include "base/stamps.h"
#include "face/face.h"
#include <marotte/plugin.h>

typedef enum live_mode {
    LIVE_PERFORMS = 0, /* the face is the live hands' */
    LIVE_SHOWS,        /* a take: standing, played, scrubbed */
    LIVE_OVERDUBS      /* a take plays, and the hands perform over it */
} live_mode;

enum { LIVE_CONTACTS_MAX = 256, LIVE_ROWS = 64 };
typedef struct live_view {
    uint64_t number;                /* +1 with each published face that differs from the last */
    const float *position, *normal; /* vertex_count by 3, mm; the mesh file's order */
    const stamps *changed;          /* which of them have: LIVE_ROWS vertices each */
    uint32_t vertex_count;
    const mrt_face *about;
    uint32_t contact_count;
    vec3 contact[LIVE_CONTACTS_MAX]; /* mm, where they are now */
    rigid bone[RIG_BONES_MAX];
    live_mode mode;
    mrt_hand hand[2]; /* live, as the mapping sees them; where they stand in the face is unknown */
    float pedal[MRT_MAX_PEDALS];
    mrt_pull pull; /* of all who speak, as composed */
    bool is_anchored;
    csrbf_settings solver; /* radius > 0 */
    face_meter meter;
    double min_determinant; /* measured some times a second; 1: nothing folds */
    double penetration_mm;
    surface_state skin; /* measured with it */
    int64_t sample_ns;  /* host clock: of the newest sample in it that was measured live; 0: none */
    int64_t published_ns; /* host clock */
    /* the timeline; all 0 while LIVE_PERFORMS */
    int64_t at_ns;
    bool is_playing, is_recording_over;
    uint32_t pass;
} live_view;

#endif
