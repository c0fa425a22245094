/* stage/perform/pointer.h - the mouse on the face. It grips a contact or any point of the skin and
 * pulls it, in addition to the active mapping. The pointer is an input (feed.h), and its channels
 * are recorded like those of any other input. Its pull is a separate part above the pull of the
 * mapping. The result depends only on the samples.
 *
 * A released pull springs back within POINTER_SPRING_S, unless POINTER_STAYS is set. With
 * POINTER_STAYS a contact keeps its offset, and a point of the skin is baked into the base.
 * Kneading is an unanchored drag, so its result always stays. [frame] no allocation. */
#ifndef MAROTTE_STAGE_POINTER_H
#define MAROTTE_STAGE_POINTER_H
#include "stage/perform/hands.h"

#define POINTER_SPRING_S 0.25

typedef enum pointer_grip {
    POINTER_AWAY = 0,
    POINTER_PULLS,       /* anchored pull */
    POINTER_KNEADS,      /* unanchored drag, as on clay */
    POINTER_RELEASE_ALL, /* releases all offsets that stay: contacts ease back to rest */
    POINTER_NEUTRAL      /* the same, resets the mapping, and returns the base to the rest shape */
} pointer_grip;

/* The channels; all are MRT_NO_HAND. The semantic is POINTER_SEMANTIC + the value below, which is
 * outside the range for plugins. */
enum { POINTER_SEMANTIC = 96 };
typedef enum pointer_channel {
    POINTER_REST_X = 0, /* mm: gripped point of the rest face: exactly the rest position of a
                           contact, or any other point */
    POINTER_REST_Y,
    POINTER_REST_Z,
    POINTER_AT_X, /* mm, on the shown face: position of the pointer; at the start of a grip: the
                   * gripped point */
    POINTER_AT_Y,
    POINTER_AT_Z,
    POINTER_GRIP,   /* pointer_grip */
    POINTER_STAYS,  /* 1: a released pull stays */
    POINTER_RADIUS, /* mm; 0: the rig's */
    POINTER_CHANNELS
} pointer_channel;
const mrt_channel *pointer_channels(uint32_t *out_count); /* const data */

enum {
    POINTER_KEPT_MAX = 24
}; /* contacts that keep an offset; beyond this the oldest eases back */

typedef struct pointer_offset { /* of a contact, or of a point of the skin */
    uint32_t contact;           /* 1 + index; 0: a point of the skin */
    vec3 rest;                  /* of the point, mm */
    vec3 offset, from;
    bool eases;
    double eased_s;
} pointer_offset;

/* The composer treats its pulls as pointer parts (composer.h): offsets start from the current shape
 * when the grip begins. */
typedef struct pointer {
    mrt_pull pull;   /* pulls of contacts: anchored, or idle: none */
    mrt_pull places; /* pulls of the skin: anchored, unanchored while kneading, or idle: none */
    bool is_known;   /* has had a sample */
    bool is_fresh;   /* the last step had a sample of the pointer: kneading moves the skin */
    bool commits;    /* in the last step, pulled points were baked into the base */
    int64_t time_ns;
    pointer_grip grip;
    bool stays;
    float radius_mm;
    vec3 held_rest, held_at; /* values at the start of the grip */
    vec3 at;
    uint32_t held;     /* 1 + contact; 0: a point of the skin */
    bool restores;     /* the base is returning to rest */
    double restores_s; /* time since the base began to return to rest; < 0: begins with the next
                          step */
    double restore;    /* 0..1: share of the remaining way to rest in the last step */
    uint32_t count;    /* number of entries in `offset`, oldest first */
    pointer_offset offset[POINTER_KEPT_MAX + 1];
} pointer;

void pointer_reset(pointer *self);
/* Returns the base to the rest shape within POINTER_SPRING_S of the next steps. */
void pointer_restore_base(pointer *self);
/* Call for every step, in time order. Reads the samples whose route has pointer channels. Returns
 * true if the step has one. about: gives the rest positions that identify contacts; time_ns: time
 * of the frame. */
bool pointer_read(pointer *self, const mrt_face *about, const sample_step *s, int64_t time_ns);

/* Serialises everything that later steps depend on. Same contract as hands_save. */
size_t pointer_save(const pointer *self, void *bytes, size_t capacity);
bool pointer_load(pointer *self, const void *bytes, size_t size); /* false: invalid, and reset */
void pointer_shift_time(pointer *self, int64_t by_ns);

#endif
