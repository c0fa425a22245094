#include "perform_options.h"
#include "base/file.h"
#include "base/text.h"
#include "base/installed.h"
#include "take/take.h"

#include <stdlib.h>
#include <string.h>

enum {
    OPTION_FACE = 256,
    OPTION_UNIT,
    OPTION_UP,
    OPTION_FORWARD,
    OPTION_INPUT,
    OPTION_MAP,
    OPTION_OUTPUT,
    OPTION_CURVES,
    OPTION_EXPORT,
    OPTION_FPS,
    OPTION_SECONDS,
    OPTION_SIZE,
    OPTION_VIEW,
    OPTION_MIRROR,
    OPTION_BACKGROUND,
    OPTION_LOOK,
    OPTION_TOLERANCE,
    OPTION_MAX_TARGETS,
    OPTION_BARE,
    OPTION_EXPORT_UNIT,
    OPTION_BY_PART,
    OPTION_HAND_LENGTH,
    OPTION_CALIBRATION,
    OPTION_REZERO_PEDAL,
    OPTION_PATCH,
    OPTION_RECORD,
    OPTION_SCENE,
    OPTION_SHOT,
    OPTION_SOUND,
    OPTION_ISOLATE,
    OPTION_WATCH_PLUGINS,
    OPTION_REALTIME,
    OPTION_JSON
};

static const struct option option_table[] = {
    {"face", required_argument, NULL, OPTION_FACE},
    {"unit", required_argument, NULL, OPTION_UNIT},
    {"up", required_argument, NULL, OPTION_UP},
    {"forward", required_argument, NULL, OPTION_FORWARD},
    {"input", required_argument, NULL, OPTION_INPUT},
    {"map", required_argument, NULL, OPTION_MAP},
    {"output", required_argument, NULL, OPTION_OUTPUT},
    {"curves", required_argument, NULL, OPTION_CURVES},
    {"export", required_argument, NULL, OPTION_EXPORT},
    {"fps", required_argument, NULL, OPTION_FPS},
    {"seconds", required_argument, NULL, OPTION_SECONDS},
    {"size", required_argument, NULL, OPTION_SIZE},
    {"view", required_argument, NULL, OPTION_VIEW},
    {"mirror", no_argument, NULL, OPTION_MIRROR},
    {"background", required_argument, NULL, OPTION_BACKGROUND},
    {"look", required_argument, NULL, OPTION_LOOK},
    {"tolerance", required_argument, NULL, OPTION_TOLERANCE},
    {"max-targets", required_argument, NULL, OPTION_MAX_TARGETS},
    {"bare", no_argument, NULL, OPTION_BARE},
    {"export-unit", required_argument, NULL, OPTION_EXPORT_UNIT},
    {"by-part", no_argument, NULL, OPTION_BY_PART},
    {"hand-length", required_argument, NULL, OPTION_HAND_LENGTH},
    {"calibration", required_argument, NULL, OPTION_CALIBRATION},
    {"rezero-pedal", required_argument, NULL, OPTION_REZERO_PEDAL},
    {"patch", required_argument, NULL, OPTION_PATCH},
    {"record", required_argument, NULL, OPTION_RECORD},
    {"scene", required_argument, NULL, OPTION_SCENE},
    {"shot", required_argument, NULL, OPTION_SHOT},
    {"sound", no_argument, NULL, OPTION_SOUND},
    {"isolate", required_argument, NULL, OPTION_ISOLATE},
    {"watch-plugins", no_argument, NULL, OPTION_WATCH_PLUGINS},
    {"realtime", no_argument, NULL, OPTION_REALTIME},
    {"json", no_argument, NULL, OPTION_JSON},
    {NULL, 0, NULL, 0},
};

void perform_options_finish(perform_options *options)
{
    for (uint32_t i = 0; i < options->input_count; ++i)
        spec_finish(&options->input[i]);
    spec_finish(&options->map);
    free(options->face);
}

static int read_number(const command *self, const char *option, const char *text, double min,
                       double max, double *out)
{
    if (text_double(text_view_of(text, strlen(text)), out) && *out >= min && *out <= max)
        return COMMAND_DONE;
    return command_usage(self, "--%s \"%s\" is not a number from %g to %g", option, text, min, max);
}

static int read_name(const command *self, const char *option, const char *text, const char **out)
{
    *out = text;
    if (strlen(text) < TAKE_NAME)
        return COMMAND_DONE;
    return command_usage(self, "--%s: at most %d letters are possible", option, TAKE_NAME - 1);
}

static int add_export(perform_options *out, const command *self, const char *path)
{
    if (out->export_count == EXPORTS_MAX)
        return command_usage(self, "at most %d exports are possible", EXPORTS_MAX);
    exports_file file = {path, exports_format_of(path)};
    if (file.format == EXPORTS_NONE)
        return command_usage(self, "--export %s: the name must end in %s", path, exports_names);
    out->exports[out->export_count++] = file;
    return COMMAND_DONE;
}

static int read_unit(double *out_mm, const command *self, const char *option, const char *text)
{
    return mesh_unit_parse(out_mm, text)
               ? COMMAND_DONE
               : command_usage(self, "--%s \"%s\" is not mm, cm, m or a number of mm", option,
                               text);
}

static int read_axis(const command *self, const char *option, const char *text, mesh_axis *out)
{
    return mesh_axis_parse(out, text)
               ? COMMAND_DONE
               : command_usage(self, "--%s \"%s\" is not x, y, z, -x, -y or -z", option, text);
}

static int add_input(perform_options *out, const command *self, const char *text)
{
    if (out->input_count == PERFORM_INPUTS_MAX)
        return command_usage(self, "at most %d inputs are possible", PERFORM_INPUTS_MAX);
    if (!spec_read(&out->input[out->input_count++], text))
        return command_usage(self, "--input \"%s\" is not PLUGIN[:ADDRESS][,key=value]", text);
    return COMMAND_DONE;
}

static int add_output(perform_options *out, const command *self, const char *text)
{
    if (out->output_count == PERFORM_OUTPUTS_MAX)
        return command_usage(self, "at most %d outputs are possible", PERFORM_OUTPUTS_MAX);
    out->output[out->output_count++] = text;
    return COMMAND_DONE;
}

static int set_map(perform_options *out, const command *self, const char *text)
{
    if (out->map.plugin)
        return command_usage(self, "one --map is possible");
    if (!spec_read(&out->map, text) || out->map.address[0])
        return command_usage(self, "--map \"%s\" is not PLUGIN[,key=value]", text);
    return COMMAND_DONE;
}

static int set_face(perform_options *out, const command *self, const char *text)
{
    if (out->face)
        return command_usage(self, "one --face is possible");
    out->face = installed_face(text);
    if (out->face)
        return COMMAND_DONE;
    const error no_memory = {"no memory"};
    return command_failed(self, &no_memory);
}

static int add_calibration(perform_options *out, const command *self, const char *path)
{
    if (out->calibration_count == PERFORM_CALIBRATIONS_MAX)
        return command_usage(self, "at most %d calibrations are possible, one per hand",
                             PERFORM_CALIBRATIONS_MAX);
    out->calibration[out->calibration_count++] = path;
    return COMMAND_DONE;
}

static int read_isolation(perform_options *out, const command *self, const char *text)
{
    static const char *const names[] = {"auto", "on", "off"};
    static const perform_isolation kinds[] = {PERFORM_ISOLATE_AUTO, PERFORM_ISOLATE_ON,
                                              PERFORM_ISOLATE_OFF};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        if (strcmp(names[i], text) != 0)
            continue;
        out->isolation = kinds[i];
        return COMMAND_DONE;
    }
    return command_usage(self, "--isolate \"%s\" is not auto, on or off", text);
}

static int read_look(perform_options *out, const command *self, int option, const char *text)
{
    bool is_understood = true;
    const char *name = "mirror", *possible = "";
    switch (option) {
    case OPTION_SIZE:
        name = "size", possible = video_look_sizes;
        is_understood = video_look_size(&out->look, text);
        break;
    case OPTION_VIEW:
        name = "view", possible = video_look_views;
        is_understood = video_look_view(&out->look, text);
        break;
    case OPTION_BACKGROUND:
        name = "background", possible = video_look_grounds;
        is_understood = video_look_ground(&out->look, text);
        break;
    case OPTION_LOOK:
        name = "look", possible = video_look_scenes;
        is_understood = video_look_scene(&out->look, text);
        break;
    default:
        out->look.is_mirrored = true;
    }
    return is_understood ? COMMAND_DONE
                         : command_usage(self, "--%s \"%s\" is not %s", name, text, possible);
}

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

static int read_option(void *data, const command *self, int option, const char *text)
{
    perform_options *out = data;
    double number = 0;
    int code;
    switch (option) {
    case OPTION_FACE:
        return set_face(out, self, text);
    case OPTION_UNIT:
        return read_unit(&out->frame.mm_per_unit, self, "unit", text);
    case OPTION_UP:
        return read_axis(self, "up", text, &out->frame.up);
    case OPTION_FORWARD:
        return read_axis(self, "forward", text, &out->frame.forward);
    case OPTION_INPUT:
        return add_input(out, self, text);
    case OPTION_MAP:
        return set_map(out, self, text);
    case OPTION_OUTPUT:
        return add_output(out, self, text);
    case OPTION_CURVES:
        out->curves = text;
        return COMMAND_DONE;
    case OPTION_EXPORT:
        return add_export(out, self, text);
    case OPTION_FPS:
        return read_number(self, "fps", text, 1, 1000, &out->fps);
    case OPTION_SECONDS:
        return read_number(self, "seconds", text, 0.001, 1e6, &out->seconds);
    case OPTION_SIZE:
    case OPTION_VIEW:
    case OPTION_MIRROR:
    case OPTION_BACKGROUND:
    case OPTION_LOOK:
        return read_look(out, self, option, text);
    case OPTION_TOLERANCE:
        return read_number(self, "tolerance", text, 1e-6, 1e3, &out->tolerance_mm);
    case OPTION_HAND_LENGTH:
        return read_number(self, "hand-length", text, 50, 400, &out->hand_length_mm);
    case OPTION_MAX_TARGETS:
        code = read_number(self, "max-targets", text, 1, 10000, &number);
        out->max_targets = (uint32_t)number;
        return code;
    case OPTION_BARE:
        out->is_bare = true;
        return COMMAND_DONE;
    case OPTION_EXPORT_UNIT:
        return read_unit(&out->export_mm_per_unit, self, "export-unit", text);
    case OPTION_BY_PART:
        out->is_by_part = true;
        return COMMAND_DONE;
    case OPTION_CALIBRATION:
        return add_calibration(out, self, text);
    case OPTION_REZERO_PEDAL:
        code = read_number(self, "rezero-pedal", text, 1, MRT_MAX_PEDALS, &number);
        out->rezero_pedal = (uint32_t)number;
        return code;
    case OPTION_PATCH:
        out->patch = text;
        return COMMAND_DONE;
    case OPTION_RECORD:
        out->record = text;
        return COMMAND_DONE;
    case OPTION_SCENE:
        return read_name(self, "scene", text, &out->scene);
    case OPTION_SHOT:
        return read_name(self, "shot", text, &out->shot);
    case OPTION_SOUND:
        out->has_sound = true;
        return COMMAND_DONE;
    case OPTION_ISOLATE:
        return read_isolation(out, self, text);
    case OPTION_WATCH_PLUGINS:
        out->watches_plugins = true;
        return COMMAND_DONE;
    case OPTION_REALTIME:
        out->is_realtime = true;
        return COMMAND_DONE;
    case OPTION_JSON:
        out->is_json = true;
        return COMMAND_DONE;
    default:
        return COMMAND_USAGE;
    }
}

int perform_options_read(perform_options *out, const command *self, int argc, char **argv)
{
    *out = (perform_options){.scene = "", .shot = "", .look = video_look_usual()};
    int code = command_options(self, argc, argv, option_table, read_option, out);
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
