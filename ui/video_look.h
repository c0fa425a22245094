/* video_look.h - how the face is seen in a video: size, side, what is behind it; as a person writes
 * it and as the renderer takes it. Leaves out drawing (video.h). Pure. */
#ifndef MAROTTE_UI_VIDEO_LOOK_H
#define MAROTTE_UI_VIDEO_LOOK_H
#include "draw/draw.h"

typedef enum video_view { VIDEO_FRONT = 0, VIDEO_SIDE, VIDEO_THREE_QUARTER } video_view;
typedef enum video_ground {
    VIDEO_WALL = 0, /* of the studio */
    VIDEO_COLOUR,
    VIDEO_NOTHING /* alpha is the face's coverage */
} video_ground;

typedef struct video_look {
    uint32_t width, height; /* pixels */
    bool is_sized;          /* by the person; else a contact sheet has a size of its own */
    video_view view;
    bool is_mirrored;
    video_ground ground;
    float rgba[4]; /* of VIDEO_COLOUR and VIDEO_NOTHING: sRGB-coded */
} video_look;

/* 1280 by 720, from the front, before the wall. */
video_look video_look_usual(void);

/* What an option says: "1920x1080"; "front", "side", "three-quarter"; "#00b140", "transparent".
 * false: it is none, and the text below says what is. */
bool video_look_size(video_look *self, const char *text);
bool video_look_view(video_look *self, const char *text);
bool video_look_ground(video_look *self, const char *text);
extern const char video_look_sizes[], video_look_views[], video_look_grounds[];

/* Whether H.264 can show it; the error says what to write instead. */
CHECKED mrt_result video_look_check_mp4(const video_look *self, const char *path, error *err);

/* Shows a face with these bounds at rest, with room for a jaw that opens. */
draw_camera video_look_camera(const video_look *self, const float low[3], const float high[3]);
/* Left and right change places; rows of width pixels, in place. */
void video_look_mirror(uint8_t *rgba, uint32_t width, uint32_t height);

#endif
