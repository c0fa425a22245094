/* draw/scenery.h - the scene of a show: how its face is lit, the picture behind it, the views of
 * its camera; as notes of the show, so that whoever draws the show draws what was seen. The picture
 * is in the show itself, as its file was. Leaves out drawing (draw.h). Any thread that may block.
 */
#ifndef MAROTTE_UI_DRAW_SCENERY_H
#define MAROTTE_UI_DRAW_SCENERY_H
#include "draw/draw.h"
#include "draw/lighting.h"
#include "show/show.h"

enum { SCENERY_VIEWS = 6, SCENERY_NAME = 128 };

typedef struct scenery {
    lighting light;
    char picture[TAKE_HASH]; /* SHA-256 of its file; "": the wall */
    char picture_name[SCENERY_NAME];
    draw_fit fit;
    uint32_t view_count;
    draw_camera_view view[SCENERY_VIEWS];
} scenery;

scenery scenery_usual(void); /* padding and all that is not used is 0: two can be compared */
/* Of a show, NULL as well. What makes no sense is as usual, and an error says so. */
CHECKED mrt_result scenery_read(scenery *out, show *from, error *err);
/* Notes of what is usual are taken away. */
CHECKED mrt_result scenery_write(const scenery *self, show *into, error *err);
/* The note of the picture behind: fit, hash, name. False: it makes no sense. */
bool scenery_parse_picture(scenery *out, const char *text);
/* The note of the views, six numbers each. */
bool scenery_parse_views(scenery *out, const char *text);

typedef struct scenery_picture { /* decoded */
    uint32_t width, height;
    uint8_t *rgba; /* sRGB-coded, straight alpha, rows from the top; NULL: none */
} scenery_picture;
void scenery_picture_finish(scenery_picture *self); /* accepts zeroed */
/* PNG or JPEG, by a process of its own: the bytes may be anybody's. At most 4096 pixels a side,
 * larger ones are made smaller. Waits up to 20 s. */
CHECKED mrt_result scenery_picture_decode(scenery_picture *out, const void *bytes, size_t size,
                                          const char *name, error *err);
/* The show's, as `of` says; MRT_END: it has the wall. */
CHECKED mrt_result scenery_picture_read(scenery_picture *out, const scenery *of, show *from,
                                        error *err);

#endif
