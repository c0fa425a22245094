/* draw/scenery.h - the scene of a show: the lights, the picture behind the face, and the camera
 * views. They are stored as notes of the show, so that everything that draws the show draws the
 * same scene. The file of the picture is stored in the show. Leaves out drawing (draw.h). [any
 * thread that may block] */
#ifndef MAROTTE_UI_DRAW_SCENERY_H
#define MAROTTE_UI_DRAW_SCENERY_H
#include "draw/draw.h"
#include "draw/lighting.h"
#include "show/show.h"

enum { SCENERY_VIEWS = 6, SCENERY_NAME = 128 };

typedef struct scenery {
    lighting light;
    char picture[TAKE_HASH]; /* SHA-256 of the file; "": the wall */
    char picture_name[SCENERY_NAME];
    draw_fit fit;
    uint32_t view_count;
    draw_camera_view view[SCENERY_VIEWS];
} scenery;

scenery scenery_default(void); /* unused bytes are 0, so that memcmp can compare two */
/* Reads the scene of a show; NULL: default scene. Invalid notes are replaced by defaults, and
 * returned as an error. */
CHECKED mrt_result scenery_read(scenery *out, show *from, error *err);
/* Writes the notes. Removes notes with default values. */
CHECKED mrt_result scenery_write(const scenery *self, show *into, error *err);
/* Parses the note of the picture: fit, hash, name. Returns false if it is invalid. */
bool scenery_parse_picture(scenery *out, const char *text);
/* Parses the note of the views, six numbers each. */
bool scenery_parse_views(scenery *out, const char *text);

typedef struct scenery_picture { /* a decoded picture */
    uint32_t width, height;
    uint8_t *rgba; /* sRGB-coded, straight alpha, rows from the top; NULL: none */
} scenery_picture;
void scenery_picture_finish(scenery_picture *self); /* accepts a zeroed struct */
/* Decodes PNG or JPEG in a separate process, because the bytes may come from an untrusted source.
 * Reduces pictures to at most 4096 pixels a side. Waits up to 20 s. */
CHECKED mrt_result scenery_picture_decode(scenery_picture *out, const void *bytes, size_t size,
                                          const char *name, error *err);
/* Reads the picture that `of` names. MRT_END: the scene has the wall. */
CHECKED mrt_result scenery_picture_read(scenery_picture *out, const scenery *of, show *from,
                                        error *err);

#endif
