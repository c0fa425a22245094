/* draw/lighting.h - the scene around a face: three lights, the light of the room, the wall behind
 * it; a table of looks that flatter a puppet, and the scene as a line of text that a show keeps.
 * Everything that draws takes the same (draw_light). Leaves out drawing. Pure; any thread. */
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
    float direction[3]; /* unit, towards it, for a camera at yaw 0: it turns with the camera */
    float rgb[3];       /* linear */
    float power;        /* 1: as rgb says */
} lighting_lamp;

typedef struct lighting {
    lighting_lamp lamp[LIGHTING_LAMPS];
    float room;                        /* light from all sides; 1: as in the studio */
    float wall_edge[3], wall_light[3]; /* the wall's edges, and where a light falls: sRGB-coded */
} lighting;

typedef struct lighting_look {
    const char *name, *about;
    lighting light;
} lighting_look;
enum { LIGHTING_LOOKS = 3 };
extern const lighting_look lighting_looks[LIGHTING_LOOKS]; /* the first: whoever says nothing */

/* Moves a lamp to where it is seen on a ball before the camera, right and up -1..1; it stays before
 * the face or behind it. */
void lighting_move(lighting_lamp *lamp, float right, float up);
void lighting_turn_behind(lighting_lamp *lamp); /* from before the face to behind it, and back */

#define LIGHTING_NOTE "lighting" /* the key of show_note_read */
enum { LIGHTING_TEXT = 512 };
void lighting_write(const lighting *of, char out[LIGHTING_TEXT]);
/* False: it makes no sense, and `out` is as it was. */
bool lighting_parse(lighting *out, const char *text);

#endif
