/* draw/draw.h - the renderer: draws lit faces, with or without a window. It draws into its own
 * framebuffer; the stage window shows that framebuffer, and pictures are read from it. OpenGL 3.3
 * core, through libepoxy. Only the thread that created the context calls it. */
#ifndef MAROTTE_UI_DRAW_DRAW_H
#define MAROTTE_UI_DRAW_DRAW_H
#include "base/error.h"
#include "base/stamps.h"
#include "draw/lighting.h"
#include "mesh/mesh.h"

/* An OpenGL context without a window (EGL surfaceless). Creating it makes it current. */
typedef struct draw_context draw_context;
draw_context *draw_context_create(error *err); /* NULL: failed */
void draw_context_destroy(draw_context *self);
/* Returns the name of the driver: "llvmpipe (LLVM 15.0.6, 256 bits)". Valid until the context is
 * destroyed. */
const char *draw_context_driver(const draw_context *self);

typedef struct draw_target draw_target; /* a multisampled framebuffer and its picture */
draw_target *draw_target_create(uint32_t width, uint32_t height, error *err);
void draw_target_destroy(draw_target *self);
/* Returns the OpenGL name of the current picture, a 2D texture: sRGB-coded, first row at the
 * bottom. Valid until the target is destroyed. */
uint32_t draw_target_texture(draw_target *self);
/* Copies the current picture into a texture of its own, such as a thumbnail. Returns its OpenGL
 * name, for draw_texture_destroy. */
uint32_t draw_target_copy(draw_target *self);
void draw_texture_destroy(uint32_t texture); /* 0 is fine */

typedef struct draw_renderer draw_renderer; /* programs and lights */
draw_renderer *draw_renderer_create(error *err);
void draw_renderer_destroy(draw_renderer *self);
/* Live: a software renderer leaves out the fibres of felt, a quarter of its time. */
void draw_renderer_set_live(draw_renderer *self, bool is_live);

/* A mesh on the graphics card. The mesh may be freed after creation. */
typedef struct draw_face draw_face;
draw_face *draw_face_create(const mesh *m, error *err);
/* Creates the same in two parts, for a face that may be drawn later. draw_face_shade must be called
 * before drawing. It computes the ambient occlusion of each vertex, which takes a tenth of a
 * second. It needs the same mesh `m`, and resets the shape to rest. */
draw_face *draw_face_create_unshaded(const mesh *m, error *err);
CHECKED mrt_result draw_face_shade(draw_face *self, const mesh *m, error *err);
void draw_face_destroy(draw_face *self);
/* Sets the shape. position, normal: vertex_count by 3, mm; normal NULL: computed. */
void draw_face_update(draw_face *self, const float *position, const float *normal);
/* The same, if only some rows of DRAW_ROWS vertices have changed; `changed` covers positions and
 * normals. Reads and uploads only the changed rows. Returns false if there were none. */
enum { DRAW_ROWS = 64 };
bool draw_face_follow(draw_face *self, const float *position, const float *normal,
                      const stamps *changed);
/* Sets colours that replace the materials: vertex_count by 3, linear, 0..1. NULL: the materials
 * again. */
void draw_face_colour(draw_face *self, const float *rgb);

typedef struct draw_camera {
    float target[3]; /* mm: point in the centre of the view */
    float distance_mm;
    float yaw_rad, pitch_rad; /* 0, 0: from the front (+z), yaw to the subject's left, pitch up */
    float field_of_view_rad;  /* vertical */
} draw_camera;
/* Returns a camera that frames the box from the front, with a margin. */
draw_camera draw_camera_framing(const float low[3], const float high[3], float aspect);
/* A camera relative to `home`, the camera that frames the face, so that it works on every face. Yaw
 * and pitch in rad; distance as a multiple of home's; offset of the target as a multiple of home's
 * distance. */
enum { DRAW_VIEW_NUMBERS = 6 };
typedef struct draw_camera_view {
    double number[DRAW_VIEW_NUMBERS];
} draw_camera_view;
draw_camera_view draw_camera_keep(const draw_camera *camera, const draw_camera *home);
/* Returns home if the numbers are invalid. */
draw_camera draw_camera_recall(const draw_camera_view *kept, const draw_camera *home);

/* Sets the lights and the wall. NULL, and the default: the studio. */
void draw_light(draw_renderer *self, const lighting *light);
/* A picture on the graphics card, drawn behind the face instead of the wall. rgba: width * height
 * by 4, sRGB-coded, rows from the top; may be freed after creation. */
typedef struct draw_backdrop draw_backdrop;
draw_backdrop *draw_backdrop_create(uint32_t width, uint32_t height, const uint8_t *rgba,
                                    error *err);
void draw_backdrop_destroy(draw_backdrop *self); /* accepts NULL */
typedef enum draw_fit {
    DRAW_COVER = 0, /* fills the view; the rest of the picture is cut */
    DRAW_CONTAIN    /* the whole picture, with the wall beside it */
} draw_fit;
/* Sets the picture behind the face. NULL, and the default: the wall. The picture must exist until
 * another one is set. */
void draw_behind(draw_renderer *self, const draw_backdrop *backdrop, draw_fit fit);
/* Sets one colour behind the face, sRGB-coded, 0..1. With alpha 0 nothing is drawn there, and
 * draw_read returns the coverage of the face as alpha (straight, not premultiplied). NULL, and the
 * default: the wall or the picture. */
void draw_ground(draw_renderer *self, const float rgba[4]);
/* Clears a width x height rectangle of the target at x, y (from the top left) and draws the face.
 */
void draw_render(draw_renderer *self, draw_target *target, const draw_face *face,
                 const draw_camera *camera, uint32_t x, uint32_t y, uint32_t width,
                 uint32_t height);
/* Computes where draw_render, with the same camera and rectangle (x, y, width, height), draws a
 * point in mm. Result in pixels from the top left of the target. Returns false if the point is
 * behind the eye. */
bool draw_project(float out_px[2], const draw_camera *camera, const uint32_t rectangle[4],
                  const float point[3]);
/* A straight stroke with round ends over the picture, in pixels from the top left. A dot if both
 * ends are equal. rgba as for draw_text. */
typedef struct draw_stroke {
    float from[2], to[2], width_px, rgba[4];
} draw_stroke;
void draw_strokes(draw_renderer *self, draw_target *target, const draw_stroke *stroke,
                  uint32_t count);
/* Draws UTF-8 text at x, y in pixels from the top left of the target. size_px: height of a line;
 * rgba: 0..1, sRGB-coded. Draws nothing without a font. */
void draw_text(draw_renderer *self, draw_target *target, const char *words, float x, float y,
               float size_px, const float rgba[4]);
/* Returns the width of the text in draw_text, px; 0 without a font. */
float draw_text_width(draw_renderer *self, const char *words, float size_px);
/* Returns the path of the font in use. NULL: none was found (install fonts-inter). */
const char *draw_text_font(const draw_renderer *self);
/* Reads the picture. out_rgba: width * height * 4, rows from the top. */
void draw_read(draw_target *self, uint8_t *out_rgba);

#endif
