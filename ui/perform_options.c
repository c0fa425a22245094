#include "perform_options.h"
#include "base/file.h"
#include "base/text.h"
#include "base/installed.h"
#include "take/take.h"

#include <stdlib.h>
#include <string.h>

void perform_options_finish(perform_options *options)
{
    for (uint32_t i = 0; i < options->input_count; ++i)
        spec_finish(&options->input[i]);
    spec_finish(&options->map);
    free(options->face);
}

static int read_name(void *to, const command *self, const char *name, const char *text)
{
    *(const char **)to = text;
    if (strlen(text) < TAKE_NAME)
        return COMMAND_DONE;
    return command_usage(self, "--%s: at most %d letters are possible", name, TAKE_NAME - 1);
}

static int add_export(void *to, const command *self, const char *name, const char *path)
{
    perform_options *out = to;
    if (out->export_count == EXPORTS_MAX)
        return command_usage(self, "at most %d exports are possible", EXPORTS_MAX);
    exports_file file = {path, exports_format_of(path)};
    if (file.format == EXPORTS_NONE)
        return command_usage(self, "--%s %s: the name must end in %s", name, path, exports_names);
    out->exports[out->export_count++] = file;
    return COMMAND_DONE;
}

static int add_input(void *to, const command *self, const char *name, const char *text)
{
    perform_options *out = to;
    if (out->input_count == PERFORM_INPUTS_MAX)
        return command_usage(self, "at most %d inputs are possible", PERFORM_INPUTS_MAX);
    return command_read_spec(&out->input[out->input_count++], self, name, text);
}

static int add_output(void *to, const command *self, const char *name, const char *text)
{
    perform_options *out = to;
    (void)name;
    if (out->output_count == PERFORM_OUTPUTS_MAX)
        return command_usage(self, "at most %d outputs are possible", PERFORM_OUTPUTS_MAX);
    out->output[out->output_count++] = text;
    return COMMAND_DONE;
}

static int set_map(void *to, const command *self, const char *name, const char *text)
{
    plugin_spec *map = to;
    if (map->plugin)
        return command_usage(self, "one --map is possible");
    if (!spec_read(map, text) || map->address[0])
        return command_usage(self, "--%s \"%s\" is not PLUGIN[,key=value]", name, text);
    return COMMAND_DONE;
}

static int add_calibration(void *to, const command *self, const char *name, const char *path)
{
    perform_options *out = to;
    (void)name;
    if (out->calibration_count == PERFORM_CALIBRATIONS_MAX)
        return command_usage(self, "at most %d calibrations are possible, one per hand",
                             PERFORM_CALIBRATIONS_MAX);
    out->calibration[out->calibration_count++] = path;
    return COMMAND_DONE;
}

static int read_isolation(void *to, const command *self, const char *name, const char *text)
{
    static const char *const names[] = {
        [ISOLATE_FOREIGN] = "auto", [ISOLATE_ALL] = "on", [ISOLATE_NONE] = "off"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        if (strcmp(names[i], text) != 0)
            continue;
        *(isolate_which *)to = (isolate_which)i;
        return COMMAND_DONE;
    }
    return command_usage(self, "--%s \"%s\" is not auto, on or off", name, text);
}

#define AT(member) .offset = offsetof(perform_options, member)
static const command_option option_table[] = {
    {"face", COMMAND_READ, AT(face), .read = command_read_face},
    {"unit", COMMAND_READ, AT(frame.mm_per_unit), .read = command_read_unit},
    {"up", COMMAND_READ, AT(frame.up), .read = command_read_axis},
    {"forward", COMMAND_READ, AT(frame.forward), .read = command_read_axis},
    {"input", COMMAND_READ, .read = add_input},
    {"map", COMMAND_READ, AT(map), .read = set_map},
    {"output", COMMAND_READ, .read = add_output},
    {"curves", COMMAND_TEXT, AT(curves)},
    {"export", COMMAND_READ, .read = add_export},
    {"fps", COMMAND_NUMBER, AT(fps), .least = 1, .most = 1000},
    {"seconds", COMMAND_NUMBER, AT(seconds), .least = 0.001, .most = 1e6},
    {"size", COMMAND_READ, AT(look), .read = command_read_look},
    {"view", COMMAND_READ, AT(look), .read = command_read_look},
    {"mirror", COMMAND_FLAG, AT(look.is_mirrored)},
    {"background", COMMAND_READ, AT(look), .read = command_read_look},
    {"look", COMMAND_READ, AT(look), .read = command_read_look},
    {"tolerance", COMMAND_NUMBER, AT(tolerance_mm), .least = 1e-6, .most = 1e3},
    {"max-targets", COMMAND_WHOLE, AT(max_targets), .least = 1, .most = 10000},
    {"bare", COMMAND_FLAG, AT(is_bare)},
    {"export-unit", COMMAND_READ, AT(export_mm_per_unit), .read = command_read_unit},
    {"by-part", COMMAND_FLAG, AT(is_by_part)},
    {"hand-length", COMMAND_NUMBER, AT(hand_length_mm), .least = 50, .most = 400},
    {"calibration", COMMAND_READ, .read = add_calibration},
    {"rezero-pedal", COMMAND_WHOLE, AT(rezero_pedal), .least = 1, .most = MRT_MAX_PEDALS},
    {"patch", COMMAND_TEXT, AT(patch)},
    {"record", COMMAND_TEXT, AT(record)},
    {"scene", COMMAND_READ, AT(scene), .read = read_name},
    {"shot", COMMAND_READ, AT(shot), .read = read_name},
    {"sound", COMMAND_FLAG, AT(has_sound)},
    {"isolate", COMMAND_READ, AT(isolation), .read = read_isolation},
    {"watch-plugins", COMMAND_FLAG, AT(watches_plugins)},
    {"realtime", COMMAND_FLAG, AT(is_realtime)},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

/* What the look cannot be of. */
static int check_look(const perform_options *out, const command *self)
{
    error err;
    for (uint32_t i = 0; i < out->export_count; ++i)
        if (out->exports[i].format == EXPORTS_MP4 &&
            video_look_check_mp4(&out->look, out->exports[i].path, &err) < 0)
            return command_usage(self, "%s", err.text);
    return COMMAND_DONE;
}

int perform_options_read(perform_options *out, const command *self, int argc, char **argv)
{
    *out = (perform_options){.scene = "", .shot = "", .look = video_look_usual()};
    int code = command_options(out, self, option_table, argc, argv);
    if (code == COMMAND_DONE && !out->face)
        code = command_usage(self, "--face is missing");
    if (code == COMMAND_DONE && out->curves &&
        (out->input_count > 0 || out->map.plugin || out->record || out->is_realtime ||
         out->output_count > 0))
        code = command_usage(self, "--curves stands in place of --input and --map; it is neither "
                                   "recorded nor performed in real time, nor sent anywhere");
    if (code == COMMAND_DONE && out->input_count == 0 && !out->curves)
        code = command_usage(self, "--input is missing");
    if (code == COMMAND_DONE && !out->map.plugin && !out->curves)
        code = command_usage(self, "--map is missing");
    if (code == COMMAND_DONE && !out->curves && !(out->fps > 0.0))
        out->fps = 30.0;
    if (code == COMMAND_DONE && out->record && (out->frame.up || out->frame.forward))
        code =
            command_usage(self, "--up and --forward are kept in a rig, not in a show: marotte rig "
                                "new MESH --up AXIS --forward AXIS, then perform with that rig");
    if (code == COMMAND_DONE && out->has_sound && !out->record)
        code = command_usage(self, "--sound needs --record SHOW, where it is kept");
    if (code == COMMAND_DONE)
        code = check_look(out, self);
    if (code != COMMAND_DONE)
        perform_options_finish(out);
    return code;
}
