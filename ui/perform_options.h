/* perform_options.h - the command line of `marotte perform`. [main] */
#ifndef MAROTTE_UI_PERFORM_OPTIONS_H
#define MAROTTE_UI_PERFORM_OPTIONS_H
#include "command.h"
#include "exports.h"
#include "io/mesh_file.h"
#include "stage/input/spec.h"
#include "stage/mapping/isolate.h"
#include "stream/video.h"

enum { PERFORM_INPUTS_MAX = 8, PERFORM_OUTPUTS_MAX = 8, PERFORM_CALIBRATIONS_MAX = 2 };

typedef struct perform_options {
    char *face;       /* a path; owned */
    mesh_frame frame; /* of a mesh alone: --unit, --up, --forward */
    plugin_spec input[PERFORM_INPUTS_MAX];
    uint32_t input_count;
    plugin_spec map;
    const char *output[PERFORM_OUTPUTS_MAX]; /* where the face is sent; in real time then */
    uint32_t output_count;
    const char *curves; /* a table to perform in place of hands; NULL: none */
    exports_file exports[EXPORTS_MAX];
    uint32_t export_count;
    video_look look; /* of the videos among them */
    double fps, seconds, tolerance_mm, hand_length_mm;
    const char *calibration[PERFORM_CALIBRATIONS_MAX]; /* paths, or one "none" */
    uint32_t calibration_count, rezero_pedal;
    uint32_t max_targets;
    bool is_bare;    /* glTF exports have the mesh alone */
    bool is_by_part; /* exports_settings */
    double export_mm_per_unit;
    const char *patch;        /* its file; NULL: none */
    const char *record;       /* the show; NULL: nothing is recorded */
    const char *scene, *shot; /* of the take; "" */
    bool has_sound;           /* of the microphone */
    isolate_which isolation;
    bool watches_plugins, is_realtime, is_json;
} perform_options;

/* Returns COMMAND_DONE, or COMMAND_USAGE after saying why. */
int perform_options_read(perform_options *out, const command *self, int argc, char **argv);
void perform_options_finish(perform_options *options);

#endif
