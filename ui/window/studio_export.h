/* window/studio_export.h - takes as files for other programs: `marotte take export` in a process of
 * its own beside the window, so that nothing waits for it. [main] */
#ifndef MAROTTE_UI_WINDOW_STUDIO_EXPORT_H
#define MAROTTE_UI_WINDOW_STUDIO_EXPORT_H
#include "base/error.h"

enum { EXPORT_FILE = 1024 };

typedef struct studio_export studio_export;

typedef struct export_wish {
    char file[EXPORT_FILE]; /* NAME.glb, .pc2, .mdd, .csv, .mp4, or a folder/ of pictures */
    double fps;             /* 0: the take's own */
    int64_t in_ns, out_ns;  /* in >= out: all of it */
} export_wish;

studio_export *studio_export_create(void); /* NULL: no memory */
/* Those that go on are ended: what they were writing is not there. NULL is fine. */
void studio_export_destroy(studio_export *self);
/* < 0: at once why not. */
CHECKED mrt_result studio_export_begin(studio_export *self, const char *show_path, int64_t take,
                                       const char *face_path, const export_wish *wish, error *err);
typedef struct export_going {
    char file[EXPORT_FILE];
    char doing[32]; /* "performing", "writing"; "" at first */
    double done;    /* of that, 0..1; < 0: not known */
    bool is_cancelled;
} export_going;
uint32_t studio_export_count(const studio_export *self); /* that go on */
/* index: 0..count - 1, the oldest first. */
export_going studio_export_at(const studio_export *self, uint32_t index);
/* It ends soon, with nothing of it left; the news say so. */
void studio_export_cancel(studio_export *self, uint32_t index);
/* Once a frame. True: one has ended; *out_result < 0: it failed. out_text: one line. */
bool studio_export_ended(studio_export *self, mrt_result *out_result, char *out_text,
                         size_t capacity);

#endif
