/* marotte calibrate: a person's glove becomes angles. */
#include "calibrate_guide.h"
#include "command.h"
#include "facts.h"
#include "base/text.h"
#include "hand/calibration_folder.h"
#include "hand/calibration_keep.h"
#include "hand/sensor.h"
#include "hand/virtualhand.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double DEGREES_PER_RADIAN = 57.29577951308232;
static const double SCRIPT_TIMEOUT_S = 60.0;
static const char *const side_name[2] = {"left", "right"};

typedef struct calibrate_options {
    plugin_spec input;
    bool has_input, is_json;
    const char *out, *name, *show, *virtualhand;
    uint32_t side; /* MRT_NO_HAND: not said */
    double hand_length_mm, timeout_s;
} calibrate_options;

/* ---- options ---- */

enum {
    OPTION_INPUT = 256,
    OPTION_OUT,
    OPTION_NAME,
    OPTION_HAND,
    OPTION_SHOW,
    OPTION_VIRTUALHAND,
    OPTION_HAND_LENGTH,
    OPTION_TIMEOUT,
    OPTION_JSON
};

static const struct option option_table[] = {
    {"input", required_argument, NULL, OPTION_INPUT},
    {"out", required_argument, NULL, OPTION_OUT},
    {"name", required_argument, NULL, OPTION_NAME},
    {"hand", required_argument, NULL, OPTION_HAND},
    {"show", required_argument, NULL, OPTION_SHOW},
    {"from-virtualhand", required_argument, NULL, OPTION_VIRTUALHAND},
    {"hand-length", required_argument, NULL, OPTION_HAND_LENGTH},
    {"timeout", required_argument, NULL, OPTION_TIMEOUT},
    {"json", no_argument, NULL, OPTION_JSON},
    {NULL, 0, NULL, 0},
};

static int read_number(const char *option, const char *text, double min, double max, double *out)
{
    if (text_double(text_view_of(text, strlen(text)), out) && *out >= min && *out <= max)
        return COMMAND_DONE;
    return command_usage(&command_calibrate, "--%s \"%s\" is not a number from %g to %g", option,
                         text, min, max);
}

static int read_side(calibrate_options *out, const char *text)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        if (strcmp(text, side_name[side]) != 0)
            continue;
        out->side = side;
        return COMMAND_DONE;
    }
    return command_usage(&command_calibrate, "--hand \"%s\" is not left or right", text);
}

static int set_input(calibrate_options *out, const char *text)
{
    if (out->has_input)
        return command_usage(&command_calibrate, "one --input is possible");
    out->has_input = true;
    if (spec_read(&out->input, text))
        return COMMAND_DONE;
    return command_usage(&command_calibrate, "--input \"%s\" is not PLUGIN[:ADDRESS][,key=value]",
                         text);
}

static int read_option(calibrate_options *out, int option, const char *text)
{
    switch (option) {
    case OPTION_INPUT:
        return set_input(out, text);
    case OPTION_OUT:
        out->out = text;
        return COMMAND_DONE;
    case OPTION_NAME:
        out->name = text;
        return strlen(text) < CALIBRATION_NAME
                   ? COMMAND_DONE
                   : command_usage(&command_calibrate, "--name has more than %d bytes",
                                   CALIBRATION_NAME - 1);
    case OPTION_HAND:
        return read_side(out, text);
    case OPTION_SHOW:
        out->show = text;
        return COMMAND_DONE;
    case OPTION_VIRTUALHAND:
        out->virtualhand = text;
        return COMMAND_DONE;
    case OPTION_HAND_LENGTH:
        return read_number("hand-length", text, HAND_LENGTH_MIN_MM, HAND_LENGTH_MAX_MM,
                           &out->hand_length_mm);
    case OPTION_TIMEOUT:
        return read_number("timeout", text, 1, 86400, &out->timeout_s);
    case OPTION_JSON:
        out->is_json = true;
        return COMMAND_DONE;
    default:
        return COMMAND_USAGE;
    }
}

static int check_options(const calibrate_options *options)
{
    int jobs = options->has_input + (options->show != NULL) + (options->virtualhand != NULL);
    if (jobs != 1)
        return command_usage(&command_calibrate,
                             "one of --input, --from-virtualhand and --show is needed");
    if (!options->show && !options->out && !options->name)
        return command_usage(&command_calibrate,
                             "--out FILE is missing, or --name NAME for the user's folder");
    return COMMAND_DONE;
}

static int read_options(calibrate_options *out, int argc, char **argv)
{
    *out = (calibrate_options){.side = MRT_NO_HAND};
    int code = COMMAND_DONE;
    opterr = 0;
    optind = 1;
    while (code == COMMAND_DONE) {
        int option = getopt_long(argc, argv, ":", option_table, NULL);
        if (option == -1)
            break;
        if (option == ':')
            code = command_usage(&command_calibrate, "%s needs a value", argv[optind - 1]);
        else if (option == '?')
            code = command_usage(&command_calibrate, "there is no option \"%s\"", argv[optind - 1]);
        else
            code = read_option(out, option, optarg);
    }
    if (code == COMMAND_DONE && optind < argc)
        code = command_usage(&command_calibrate, "\"%s\" is not expected here", argv[optind]);
    return code == COMMAND_DONE ? check_options(out) : code;
}

/* ---- what is in a calibration ---- */

static int sensors_of(const calibration_file *file, calibration_source source)
{
    int count = 0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        count += file->sensor[i].table.count > 0 && file->sensor[i].source == source;
    return count;
}

/* -1: none has a residual. */
static int worst_sensor(const calibration_file *file)
{
    int worst = -1;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &file->sensor[i];
        if (sensor->table.count == 0 || !sensor->has_residual)
            continue;
        if (worst < 0 || sensor->residual_rad > file->sensor[worst].residual_rad)
            worst = i;
    }
    return worst;
}

static void append(char *text, size_t capacity, const char *more)
{
    size_t used = strlen(text);
    if (used + strlen(more) < capacity)
        memcpy(text + used, more, strlen(more) + 1);
}

/* "index.mpj  measured  58..150 counts -4..92 deg, residual 1.2 deg, moves middle.mpj 0.21" */
static void report_sensor(const calibration_file *file, int index, facts *told)
{
    const calibration_sensor *sensor = &file->sensor[index];
    char text[512], part[96];
    (void)snprintf(text, sizeof text, "%-11s %-8s", sensor_table[index].name,
                   calibration_source_name[sensor->source]);
    if (sensor->has_range) {
        (void)snprintf(part, sizeof part, " %3.0f..%3.0f counts %4.0f..%3.0f deg",
                       (double)sensor->raw_range[0], (double)sensor->raw_range[1],
                       (double)sensor->rad_range[0] * DEGREES_PER_RADIAN,
                       (double)sensor->rad_range[1] * DEGREES_PER_RADIAN);
        append(text, sizeof text, part);
    }
    (void)snprintf(part, sizeof part, ", neutral %.0f deg",
                   (double)sensor->neutral_rad * DEGREES_PER_RADIAN);
    append(text, sizeof text, part);
    if (sensor->has_residual) {
        (void)snprintf(part, sizeof part, ", residual %.1f deg",
                       (double)sensor->residual_rad * DEGREES_PER_RADIAN);
        append(text, sizeof text, part);
    }
    const char *joint = ", moves ";
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (fabsf(sensor->cross_talk[i]) < 0.05f)
            continue;
        (void)snprintf(part, sizeof part, "%s%s %.2f", joint, sensor_table[i].name,
                       (double)sensor->cross_talk[i]);
        append(text, sizeof text, part);
        joint = " ";
    }
    facts_list(told, "sensors", "sensor", text);
}

static void report_flaws(const guide_judgement *judgement, facts *told)
{
    char text[200];
    facts_number(told, "flaw_count", "flaws", judgement->flaw_count, 0, "");
    for (uint32_t i = 0; i < judgement->flaw_count; ++i) {
        guide_flaw_text(&judgement->flaw[i], text, sizeof text);
        facts_list(told, "flaws", "  flaw", text);
    }
}

static void report(const calibration_file *file, const guide_judgement *judgement, const char *path,
                   facts *told)
{
    facts_text(told, "file", "file", path);
    facts_text(told, "name", "name", file->name);
    facts_text(told, "date", "date", file->date);
    facts_text(told, "hand", "hand", side_name[file->side]);
    if (file->hand_length_mm > 0)
        facts_number(told, "hand_length_mm", "hand length", file->hand_length_mm, 1, "mm");
    facts_number(told, "sensor_count", "sensors", calibration_file_sensor_count(file), 0, "");
    facts_number(told, "sensors_measured", "  measured", sensors_of(file, CALIBRATION_MEASURED), 0,
                 "");
    facts_number(told, "sensors_imported", "  imported", sensors_of(file, CALIBRATION_IMPORTED), 0,
                 "");
    facts_number(told, "sensors_zeroed", "  zero measured", sensors_of(file, CALIBRATION_ZEROED), 0,
                 "with the shipped gain");
    facts_number(told, "sensors_shipped", "  shipped", sensors_of(file, CALIBRATION_SHIPPED), 0,
                 "");
    int worst = worst_sensor(file);
    if (worst >= 0)
        facts_number(told, "worst_residual_deg", "worst residual",
                     (double)file->sensor[worst].residual_rad * DEGREES_PER_RADIAN, 2, "deg");
    report_flaws(judgement, told);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (file->sensor[i].table.count > 0)
            report_sensor(file, i, told);
}

static void print_note(const char *note)
{
    for (const char *line = note; *line;) {
        size_t length = strcspn(line, "\n");
        fprintf(stderr, "note: %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

/* ---- making one ---- */

static mrt_result import(calibration_file *out, guide_judgement *out_judgement,
                         const calibrate_options *options, error *err)
{
    mrt_result result = virtualhand_read(out, options->virtualhand, options->side, err);
    if (result >= 0)
        guide_judge(out_judgement, NULL, out);
    return result;
}

static mrt_result make(calibration_file *out, guide_judgement *out_judgement,
                       const calibrate_options *options, error *err)
{
    if (options->virtualhand)
        return import(out, out_judgement, options, err);
    bool is_script = isatty(STDIN_FILENO) != 1;
    calibrate_guide_options guided = {.input = &options->input,
                                      .side = options->side,
                                      .timeout_s = options->timeout_s,
                                      .screen = options->is_json ? stderr : stdout};
    if (!(guided.timeout_s > 0) && is_script)
        guided.timeout_s = SCRIPT_TIMEOUT_S;
    return calibrate_guide_run(out, out_judgement, &guided, err);
}

/* old: what was at `path`; made: a scratch. */
static mrt_result make_and_write(const calibrate_options *options, const char *path,
                                 calibration_file *old, calibration_file *made, facts *told,
                                 error *err)
{
    guide_judgement judgement;
    mrt_result result = calibration_keep_old(old, path, err);
    if (result < 0)
        return result;
    result = make(made, &judgement, options, err);
    if (result >= 0) {
        calibration_keep_sign(made, old, options->name, options->hand_length_mm);
        print_note(old->note);
        print_note(made->note);
        result = calibration_keep_write(made, old, path, err);
    }
    if (result >= 0) {
        report(made, &judgement, path, told);
        facts_list(told, "files", "wrote", path);
    }
    calibration_file_finish(old);
    return result;
}

static mrt_result calibrate(const calibrate_options *options, facts *told, error *err)
{
    char *placed = NULL;
    mrt_result result = MRT_OK;
    if (!options->out)
        result = calibration_folder_place(&placed, options->name, err);
    calibration_file *scratch = calloc(2, sizeof *scratch);
    if (result >= 0 && !scratch)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    if (result >= 0)
        result = make_and_write(options, options->out ? options->out : placed, &scratch[0],
                                &scratch[1], told, err);
    free(scratch);
    free(placed);
    return result;
}

static mrt_result show(const char *path, facts *told, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = calibration_file_read(file, path, err);
    if (result >= 0) {
        guide_judgement judgement;
        guide_judge(&judgement, NULL, file);
        print_note(file->note);
        report(file, &judgement, path, told);
        calibration_file_finish(file);
    }
    free(file);
    return result;
}

static int run(int argc, char **argv)
{
    calibrate_options options;
    int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE) {
        spec_finish(&options.input);
        return code;
    }
    error err = {""};
    facts *told = facts_create(options.is_json);
    mrt_result result = told ? MRT_OK : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = options.show ? show(options.show, told, &err) : calibrate(&options, told, &err);
    if (result >= 0)
        facts_finish(told);
    else
        facts_abandon(told);
    spec_finish(&options.input);
    return result < 0 ? command_failed(&command_calibrate, &err) : COMMAND_DONE;
}

const command command_calibrate = {
    .name = "calibrate",
    .summary = "guides through the calibration of a glove, shows or imports one",
    .help =
        "marotte calibrate --input PLUGIN[:ADDRESS][,key=value] [--out FILE.json] [--name NAME]\n"
        "                  [--hand left|right] [--hand-length MM] [--timeout S] [--json]\n"
        "marotte calibrate --from-virtualhand FILE.cal [--out FILE.json] [--name NAME] ...\n"
        "marotte calibrate --show FILE.json [--json]\n"
        "\n"
        "Ten poses, a minute and a half: each is taken once the hand has moved into it and holds\n"
        "still. The file is written when all are done; until then what was there stays.\n"
        "\n"
        "  --input SPEC       the glove, as for marotte perform\n"
        "  --out FILE         where the calibration goes (the folder below, NAME.json)\n"
        "  --name NAME        of the person\n"
        "  --hand SIDE        of a glove that could be either\n"
        "  --hand-length MM   wrist to middle fingertip, for mappings\n"
        "  --timeout S        give up when no pose is taken for so long (at a terminal: never;\n"
        "                     in a script 60)\n"
        "  --from-virtualhand FILE   import a calibration of VirtualHand 1.x (text)\n"
        "  --show FILE        what is in a calibration\n"
        "  --json             the facts for machines\n"
        "\n"
        "Keys: Enter takes the pose now, r repeats the last one, s skips, q quits. At the end "
        "each\n"
        "sensor is judged: what is wrong is said with the pose that mends it, which r repeats.\n"
        "marotte perform uses the newest calibration of each hand in\n"
        "$XDG_CONFIG_HOME/marotte/calibrations (~/.config/marotte/calibrations), or "
        "--calibration.\n",
    .run = run,
};
