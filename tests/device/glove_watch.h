/* device/glove_watch.h - a performance with a device, watched from within: the plugin cyberglove
 * and the mapping one_hand as loaded from the build, each behind a type that passes every call on
 * and tells `watch` what went through. One performance at a time. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_WATCH_H
#define MAROTTE_TESTS_DEVICE_GLOVE_WATCH_H
#include "stage/perform/player.h"
#include "stage/mapping/plugins.h"

typedef struct glove_watch {
    /* [input] After a read that gave a sample. */
    void (*sample)(void *data, const mrt_channel *channels, const mrt_sample *sample);
    /* [frame] After process(), and when that was. */
    void (*pull)(void *data, const mrt_frame *frame, const mrt_pull *pull, int64_t done_ns);
    void *data;
} glove_watch;

typedef struct glove_stage {
    plugin_list plugins;
    log_queue *log;
    face_file face;
    input *input;
    instance mapping;
    performer *performer;
    glove_watch watch;
    double reader_cpu_s, reader_time_s; /* of the thread that reads, until its last sample */
} glove_stage;

/* build: the build folder; rig_path: of the face; address: of the glove. `out` must not move. */
CHECKED mrt_result glove_stage_create(glove_stage *out, const char *build, const char *rig_path,
                                      const char *address, const glove_watch *watch, error *err);
void glove_stage_destroy(glove_stage *stage); /* accepts a zeroed one */

#endif
