/* draw/lighting.h - lights and wall around a face: three lamps, ambient light, the wall. Contains a
 * table of looks, and the text form that a show stores. Everything that draws uses it through
 * draw_light. Leaves out drawing. Pure. [any] */
#ifndef MAROTTE_UI_DRAW_LIGHTING_H
#define MAROTTE_UI_DRAW_LIGHTING_H
#include <stdbool.h>
#include <stddef.h>

typedef enum lighting_lamp_name {
    LIGHTING_KEY = 0, /* casts the shadow */
    LIGHTING_FILL,
    LIGHTING_RIM,
    LIGHTING_LAMPS
} lighting_lamp_name;

typedef struct lighting_lamp {
    float direction[3]; /* unit, towards the lamp at camera yaw 0: it turns with the camera */
    float rgb[3];       /* linear */
    float power;        /* factor of rgb */
} lighting_lamp;

typedef struct lighting {
    lighting_lamp lamp[LIGHTING_LAMPS];
    float room;                        /* ambient light; 1: as in the studio */
    float wall_edge[3], wall_light[3]; /* sRGB-coded, at the edges and where the light falls */
} lighting;

typedef struct lighting_look {
    const char *name, *about;
    lighting light;
} lighting_look;
enum { LIGHTING_LOOKS = 3 };
extern const lighting_look lighting_looks[LIGHTING_LOOKS]; /* the first is the default */

/* Moves a lamp to a place on a ball in front of the camera, right and up -1..1. The lamp stays in
 * front of the face or behind it. */
void lighting_move(lighting_lamp *lamp, float right, float up);
void lighting_turn_behind(lighting_lamp *lamp); /* from front to back, and vice versa */

#define LIGHTING_NOTE "lighting" /* key for show_note_read */
enum { LIGHTING_TEXT = 512 };
void lighting_write(const lighting *of, char out[LIGHTING_TEXT]);
/* Returns false and leaves `out` unchanged if the text is invalid. */
bool lighting_parse(lighting *out, const char *text);

#endif
