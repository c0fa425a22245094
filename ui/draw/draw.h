/* draw/draw.h - the renderer: faces lit well, with or without a window. It draws into a framebuffer
 * of its own; the stage window shows that framebuffer, pictures read it back. OpenGL 3.3 core by
 * libepoxy. One thread: the one that created the device. */
#ifndef MAROTTE_UI_DRAW_DRAW_H
#define MAROTTE_UI_DRAW_DRAW_H
#include "base/error.h"
#include "base/stamps.h"
#include "draw/lighting.h"
#include "mesh/mesh.h"

/* An OpenGL context without a window (EGL surfaceless); it is made current. */
typedef struct draw_context draw_context;
draw_context *draw_context_create(error *err); /* NULL: failed */
void draw_context_destroy(draw_context *self);
/* What draws, as the driver calls it: "llvmpipe (LLVM 15.0.6, 256 bits)". Until it is destroyed. */
const char *draw_context_driver(const draw_context *self);

typedef struct draw_target draw_target; /* a multisampled framebuffer and its picture */
draw_target *draw_target_create(uint32_t width, uint32_t height, error *err);
void draw_target_destroy(draw_target *self);
/* The OpenGL name of the picture as a 2D texture, brought up to date: colours as they go to a
 * screen (sRGB-coded), first row at the bottom. Until the target is destroyed. */
uint32_t draw_target_texture(draw_target *self);

typedef struct draw_renderer draw_renderer; /* programs and lights */
draw_renderer *draw_renderer_create(error *err);
void draw_renderer_destroy(draw_renderer *self);

/* A mesh on the graphics card; the mesh itself is not needed any more. */
typedef struct draw_face draw_face;
draw_face *draw_face_create(const mesh *m, error *err);
/* The same in two parts, for a face that may not be drawn soon: before it is, draw_face_shade finds
 * how much of the room each vertex sees, which takes a tenth of a second; m: the same mesh. The
 * shape is that at rest then. */
draw_face *draw_face_create_unshaded(const mesh *m, error *err);
CHECKED mrt_result draw_face_shade(draw_face *self, const mesh *m, error *err);
void draw_face_destroy(draw_face *self);
/* position, normal: vertex_count by 3, mm; normal NULL: computed. */
void draw_face_update(draw_face *self, const float *position, const float *normal);
/* The same where `changed` says which rows have, of both: DRAW_ROWS each. Only what it has not seen
 * of them is read and goes to the graphics card. False: that was nothing. */
enum { DRAW_ROWS = 64 };
bool draw_face_follow(draw_face *self, const float *position, const float *normal,
                      const stamps *changed);
/* Colours instead of the materials': vertex_count by 3, linear, 0..1; NULL: the materials again. */
void draw_face_colour(draw_face *self, const float *rgb);

typedef struct draw_camera {
    float target[3]; /* mm: what it looks at */
    float distance_mm;
    float yaw_rad, pitch_rad; /* 0, 0: from the front (+z), yaw to the subject's left, pitch up */
    float field_of_view_rad;  /* vertical */
} draw_camera;
/* Frames the box from the front, with air around it. */
draw_camera draw_camera_framing(const float low[3], const float high[3], float aspect);
/* A camera in shares of the one that frames the face (`home`), so that it means the same on every
 * face: yaw and pitch, rad; distance in home's; target from home's, in home's distances. */
enum { DRAW_VIEW_NUMBERS = 6 };
typedef struct draw_camera_view {
    double number[DRAW_VIEW_NUMBERS];
} draw_camera_view;
draw_camera_view draw_camera_keep(const draw_camera *camera, const draw_camera *home);
/* Numbers that make no sense give home. */
draw_camera draw_camera_recall(const draw_camera_view *kept, const draw_camera *home);

/* How faces are lit, and the wall; NULL, and at first: the studio. */
void draw_light(draw_renderer *self, const lighting *light);
/* A picture on the graphics card, to be behind the face in place of the wall. rgba: width * height
 * by 4, sRGB-coded, rows from the top; not needed any more then. */
typedef struct draw_backdrop draw_backdrop;
draw_backdrop *draw_backdrop_create(uint32_t width, uint32_t height, const uint8_t *rgba,
                                    error *err);
void draw_backdrop_destroy(draw_backdrop *self); /* NULL is fine */
typedef enum draw_fit {
    DRAW_COVER = 0, /* no wall is seen; what is too much is cut */
    DRAW_CONTAIN    /* all of it is seen, the wall beside it */
} draw_fit;
/* NULL, and at first: the wall. It must stay until another one is. */
void draw_behind(draw_renderer *self, const draw_backdrop *backdrop, draw_fit fit);
/* What draw_render has behind the face: one colour, sRGB-coded, 0..1; with alpha 0 nothing, and
 * draw_read has the face's coverage as alpha (straight, not premultiplied). NULL, and at first: the
 * wall, or the picture before it. */
void draw_ground(draw_renderer *self, const float rgba[4]);
/* Clears a width x height rectangle of the target at x, y (from the top left) and draws the face.
 */
void draw_render(draw_renderer *self, draw_target *target, const draw_face *face,
                 const draw_camera *camera, uint32_t x, uint32_t y, uint32_t width,
                 uint32_t height);
/* Where draw_render with the same camera and rectangle (x, y, width, height) puts a point, mm: in
 * pixels from the top left of the target; false: behind the eye. */
bool draw_project(float out_px[2], const draw_camera *camera, const uint32_t rectangle[4],
                  const float point[3]);
/* A straight stroke with round ends over the picture, pixels from the top left; a dot where its
 * ends are one. rgba as for draw_text. */
typedef struct draw_stroke {
    float from[2], to[2], width_px, rgba[4];
} draw_stroke;
void draw_strokes(draw_renderer *self, draw_target *target, const draw_stroke *stroke,
                  uint32_t count);
/* Text (UTF-8) in pixels from the top left of the target; size = height of a line. rgba 0..1, as on
 * a screen (sRGB). Draws nothing when there is no font. */
void draw_text(draw_renderer *self, draw_target *target, const char *words, float x, float y,
               float size_px, const float rgba[4]);
/* How wide draw_text would be, px; 0 when there is no font. */
float draw_text_width(draw_renderer *self, const char *words, float size_px);
/* The font file in use; NULL: none was found (installing fonts-inter helps). */
const char *draw_text_font(const draw_renderer *self);
/* out_rgba: width * height * 4, rows from the top. */
void draw_read(draw_target *self, uint8_t *out_rgba);

#endif
