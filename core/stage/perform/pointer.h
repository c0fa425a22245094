/* stage/perform/pointer.h - the mouse on the face: it takes hold of
 * a contact or of any place of the skin and pulls it, beside whatever mapping performs. Its
 * channels are those of an input (feed.h), recorded like all others; the layer lays what it pulls
 * over its mapping's pull as a part of its own. A function of its samples alone.
 *
 * What is pulled lightly springs back within POINTER_SPRING_S when it is let go, unless it is to
 * stay: a contact then keeps its offset, a place of the skin becomes a part of the base. Clay is an
 * unanchored drag: it stays. [frame] no allocation */
#ifndef MAROTTE_STAGE_POINTER_H
#define MAROTTE_STAGE_POINTER_H
#include "stage/perform/hands.h"

#define POINTER_SPRING_S 0.25

typedef enum pointer_grip {
    POINTER_AWAY = 0,
    POINTER_PULLS,   /* anchored */
    POINTER_KNEADS,  /* clay */
    POINTER_LETS_GO, /* of everything that stays: contacts ease back to rest */
    POINTER_NEUTRAL  /* the same, the mapping begins anew, and the base becomes the rest shape */
} pointer_grip;

/* The channels, all MRT_NO_HAND: semantic POINTER_SEMANTIC + these; beyond all that a
 * plugin may say. */
enum { POINTER_SEMANTIC = 96 };
typedef enum pointer_channel {
    POINTER_REST_X = 0, /* mm: the place of the rest face that is held: exactly a contact's rest, or
                           any other */
    POINTER_REST_Y,
    POINTER_REST_Z,
    POINTER_AT_X, /* mm, face shown: where the pointer is; when it takes hold: that place as shown
                   */
    POINTER_AT_Y,
    POINTER_AT_Z,
    POINTER_GRIP,   /* pointer_grip */
    POINTER_STAYS,  /* 1: what is let go of stays */
    POINTER_RADIUS, /* mm; 0: the rig's */
    POINTER_CHANNELS
} pointer_channel;
const mrt_channel *pointer_channels(uint32_t *out_count); /* const data */

enum { POINTER_STAYING_MAX = 24 }; /* contacts that keep an offset; the oldest eases back then */

typedef struct pointer_offset { /* of a contact, or of a place of the skin */
    uint32_t contact;           /* 1 + index; 0: a place */
    vec3 rest;                  /* of the place */
    vec3 offset, from;
    bool eases;
    double eased_s;
} pointer_offset;

/* A composer hears it as a finger's parts (composer.h): from where the face is when it takes hold.
 */
typedef struct pointer {
    mrt_pull pull;   /* of contacts: anchored, or idle: nothing */
    mrt_pull places; /* of the skin: anchored; clay: unanchored; idle: nothing */
    bool is_known;   /* some sample of it has come */
    bool is_fresh;   /* the newest sample was its own: clay moves */
    bool commits;    /* with the newest sample places have become parts of the base */
    int64_t time_ns;
    pointer_grip grip;
    bool stays;
    float radius_mm;
    vec3 held_rest, held_at; /* when it took hold */
    vec3 at;
    uint32_t held; /* 1 + contact; 0: a place of the skin */
    bool restores; /* the base is on its way back to rest, since: */
    double restores_s;
    double restore; /* 0..1: with the newest sample, so much of what is left of it */
    uint32_t count; /* of offset, the oldest first */
    pointer_offset offset[POINTER_STAYING_MAX + 1];
} pointer;

void pointer_reset(pointer *self);
/* Every step, in time order: it takes what the routes say is the pointer's. True: the step speaks
 * of the pointer. about: contacts are known by their rest; time_ns: of the frame. */
bool pointer_read(pointer *self, const mrt_face *about, const sample_step *s, int64_t time_ns);

/* All that is to come depends on, as bytes; as hands_save. */
size_t pointer_save(const pointer *self, void *bytes, size_t capacity);
bool pointer_load(pointer *self, const void *bytes, size_t size); /* false: reset */
void pointer_shift_time(pointer *self, int64_t by_ns);

#endif
