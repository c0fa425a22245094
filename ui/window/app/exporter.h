/* window/app/exporter.h - takes as files for other programs: `marotte take export` in a process of
 * its own beside the window, so that nothing waits for it. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_EXPORTER_H
#define MAROTTE_UI_WINDOW_APP_EXPORTER_H
#include "base/error.h"

enum { EXPORT_FILE = 1024 };

typedef struct exporter exporter;

typedef struct export_request {
    char file[EXPORT_FILE]; /* its end says the format: exports.h */
    double fps;             /* 0: the take's own */
    int64_t in_ns, out_ns;  /* in >= out: all of it */
    /* For videos and pictures: values of --size, --view and --background of take export; "":
     * default. */
    char size[24], view[24], background[EXPORT_FILE];
} export_request;

exporter *exporter_create(void); /* NULL: no memory */
/* Cancels running exports, removes their files, and drops waiting ones. Accepts NULL. */
void exporter_destroy(exporter *self);
/* Starts an export, or queues it while two are running. < 0: it cannot start. */
CHECKED mrt_result exporter_begin(exporter *self, const char *show_path, int64_t take,
                                  const char *face_path, const export_request *request, error *err);
typedef struct export_progress {
    char file[EXPORT_FILE];
    char doing[32]; /* "performing", "writing"; "" at first */
    double done;    /* of that, 0..1; < 0: not known */
    bool is_cancelled, is_waiting;
} export_progress;
uint32_t exporter_count(const exporter *self); /* that go on or wait */
/* index: 0..count - 1, the oldest first. */
export_progress exporter_at(const exporter *self, uint32_t index);
/* Cancels an export and removes its file. A message reports it. */
void exporter_cancel(exporter *self, uint32_t index);
/* Once a frame. True: one has ended; *out_result < 0: it failed. out_text: one line. */
bool exporter_ended(exporter *self, mrt_result *out_result, char *out_text, size_t capacity);

#endif
