/* draw/surface.h - which surface a material is drawn as: by its numbers, and by words in its name
 * (rigs/README.md lists them). Pure; any thread. */
#ifndef MAROTTE_UI_DRAW_SURFACE_H
#define MAROTTE_UI_DRAW_SURFACE_H
#include "mesh/mesh.h"

typedef enum surface_kind {
    SURFACE_SMOOTH = 0,
    SURFACE_STONE, /* pores, weather, grain */
    SURFACE_FELT,  /* fibres, a pale fuzz where it turns away */
    SURFACE_KINDS
} surface_kind;

typedef struct surface {
    surface_kind kind;
    float softness; /* 0..1: light goes under it: latex, foam, skin */
    float coat;     /* 0..1: a wet film over it */
} surface;
surface surface_of(const mesh_material *material);

#endif
