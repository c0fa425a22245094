/* window/viewport/heat.h - heat maps of a face with their legends: bone weights, mobility, strain
 * and approach to the skull. Leaves out drawing. [main] */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_HEAT_H
#define MAROTTE_UI_WINDOW_VIEWPORT_HEAT_H
#include "face/bind.h"
#include "window/app/app.h"

typedef struct viewport_heat viewport_heat;

/* Creates the heat maps. Computes the binding again, which takes some tenths of a second. The file
 * must outlive the result. */
CHECKED mrt_result viewport_heat_create(viewport_heat **out, const face_file *file, error *err);
void viewport_heat_destroy(viewport_heat *self); /* NULL is fine */

/* Computes the colours. position: vertex_count by 3, mm, as shown; bone: one pose for each bone of
 * the rig. out_rgb: vertex_count by 3, linear. */
void viewport_heat_colour(const viewport_heat *self, float *out_rgb, app_heat kind,
                          const float *position, const rigid *bone);
/* Returns whether the colours are independent of the shape, as for APP_HEAT_WEIGHTS and _MOBILITY.
 */
bool viewport_heat_is_fixed(app_heat kind);

enum { VIEWPORT_HEAT_STOPS = 5 };
typedef struct viewport_heat_legend {
    const char *title;                  /* "Strain: area against rest" */
    const char *low, *mid, *high;       /* labels with units; mid NULL: none */
    uint32_t stop[VIEWPORT_HEAT_STOPS]; /* colours from low to high, 0xRRGGBBff */
    uint32_t bone_count;                /* > 0: names with colours instead of a scale */
} viewport_heat_legend;
void viewport_heat_legend_of(const viewport_heat *self, app_heat kind, viewport_heat_legend *out);
/* Returns the colour of a bone as 0xRRGGBBff. bone < bone_count. */
uint32_t viewport_heat_bone(const viewport_heat *self, uint32_t bone, const char **out_name);

#endif
