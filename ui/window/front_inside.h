/* window/front_inside.h - what the two fronts have in common, and what each does its own way.
 * Inside front*.c. [main] */
#ifndef MAROTTE_UI_WINDOW_FRONT_INSIDE_H
#define MAROTTE_UI_WINDOW_FRONT_INSIDE_H
#include "window/front.h"

typedef struct front_type {
    void (*close)(front *self);
    bool (*begin)(front *self, ui *to, ui_screen *out_screen);
    void (*end)(front *self, ui *from);
    mrt_result (*picture)(front *self, const char *png_path, error *err);
    void (*set_title)(front *self, const char *title); /* NULL: there is nothing to write it on */
    bool (*read_gamepad)(front *self, front_gamepad *out);
    mrt_result (*open_output)(front *self, error *err);
    void (*close_output)(front *self);
    bool (*has_output)(const front *self);
    void (*output_size)(const front *self, uint32_t *out_width, uint32_t *out_height);
    void (*show_output)(front *self, uint32_t texture, bool is_mirrored);
} front_type;

struct front { /* the first member of either */
    const front_type *type;
    uint32_t width_px, height_px;
};

/* A framebuffer that a frame is drawn into: it can be read whatever a display does with its own. */
typedef struct front_sheet {
    uint32_t framebuffer, colour; /* a texture */
    uint32_t width_px, height_px;
} front_sheet;
CHECKED mrt_result front_sheet_init(front_sheet *out, uint32_t width, uint32_t height, error *err);
void front_sheet_finish(front_sheet *self); /* accepts zeroed */

/* The framebuffer that is bound, cleared to the colour behind the face. */
void front_clear(uint32_t width_px, uint32_t height_px);
/* Rows of the framebuffer that is bound for reading, as a PNG. */
CHECKED mrt_result front_write_picture(uint32_t width_px, uint32_t height_px, const char *png_path,
                                       error *err);

/* Draws a texture over all of the framebuffer that is bound. */
typedef struct front_fill {
    uint32_t program, vertex_array;
    int32_t mirror;
} front_fill;
CHECKED mrt_result front_fill_init(front_fill *out, error *err);
void front_fill_finish(front_fill *self);
void front_fill_draw(const front_fill *self, uint32_t texture, bool is_mirrored, uint32_t width_px,
                     uint32_t height_px);

#endif
