/* window/viewport/heat.h - numbers over a face as colours: whose bone a vertex rides on, how freely
 * it can be pulled, how it is stretched, how near to the skull it is pressed; and what the colours
 * mean. Leaves out drawing. [main] */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_HEAT_H
#define MAROTTE_UI_WINDOW_VIEWPORT_HEAT_H
#include "face/bind.h"
#include "window/app/app.h"

typedef struct viewport_heat viewport_heat;

/* Finds the binding anew, which takes some tenths of a second. The file must outlive it. */
CHECKED mrt_result viewport_heat_create(viewport_heat **out, const face_file *file, error *err);
void viewport_heat_destroy(viewport_heat *self); /* NULL is fine */

/* position: vertex_count by 3, mm, as shown; bone: poses, as many as the rig has bones.
 * out_rgb: vertex_count by 3, linear. */
void viewport_heat_colour(const viewport_heat *self, float *out_rgb, app_heat kind,
                          const float *position, const rigid *bone);
/* Of APP_HEAT_WEIGHTS and _MOBILITY: the colours do not depend on the shape shown. */
bool viewport_heat_is_fixed(app_heat kind);

enum { VIEWPORT_HEAT_STOPS = 5 };
typedef struct viewport_heat_legend {
    const char *title;                  /* "Strain: area against rest" */
    const char *low, *mid, *high;       /* with their units; mid NULL: none */
    uint32_t stop[VIEWPORT_HEAT_STOPS]; /* colours from low to high, 0xRRGGBBff */
    uint32_t bone_count;                /* > 0: names with colours instead of a scale */
} viewport_heat_legend;
void viewport_heat_legend_of(const viewport_heat *self, app_heat kind, viewport_heat_legend *out);
/* 0xRRGGBBff; bone < bone_count. */
uint32_t viewport_heat_bone(const viewport_heat *self, uint32_t bone, const char **out_name);

#endif
