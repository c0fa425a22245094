/* perform_options.h - the command line of `marotte perform`. [main] */
#ifndef MAROTTE_UI_PERFORM_OPTIONS_H
#define MAROTTE_UI_PERFORM_OPTIONS_H
#include "command.h"
#include "io/mesh_file.h"
#include "spec.h"

enum { PERFORM_INPUTS_MAX = 8, PERFORM_EXPORTS_MAX = 16, PERFORM_CALIBRATIONS_MAX = 2 };

typedef enum export_format {
    EXPORT_NONE = 0,
    EXPORT_GLB,
    EXPORT_PC2,
    EXPORT_MDD,
    EXPORT_CSV,
    EXPORT_PNG
} export_format;

typedef struct perform_export {
    const char *path;
    export_format format;
} perform_export;

typedef struct perform_options {
    const char *face;
    mesh_unit unit;
    plugin_spec input[PERFORM_INPUTS_MAX];
    uint32_t input_count;
    plugin_spec map;
    perform_export exports[PERFORM_EXPORTS_MAX];
    uint32_t export_count;
    double fps, seconds, tolerance_mm, hand_length_mm;
    const char *calibration[PERFORM_CALIBRATIONS_MAX]; /* paths, or one "none" */
    uint32_t calibration_count, rezero_pedal;
    uint32_t max_targets;
    bool is_realtime, is_json;
} perform_options;

/* Returns COMMAND_DONE, or COMMAND_USAGE after saying why. */
int perform_options_read(perform_options *out, const command *self, int argc, char **argv);
void perform_options_finish(perform_options *options);

#endif
