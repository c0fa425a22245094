#include "take.h"

#include "base/file.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

enum { OPTION_FIRST = 256 };

static const struct {
    const char *name;
    bool has_value;
} options[TAKE_OPTION_COUNT] = {
    [TAKE_JSON] = {"json", false},
    [TAKE_IN] = {"in", true},
    [TAKE_OUT] = {"out", true},
    [TAKE_AT] = {"at", true},
    [TAKE_CLIP] = {"clip", true},
    [TAKE_LAYER] = {"layer", true},
    [TAKE_TO] = {"to", true},
    [TAKE_SPEED] = {"speed", true},
    [TAKE_POINTS] = {"points", true},
    [TAKE_OFF] = {"off", false},
    [TAKE_FADE] = {"fade", true},
    [TAKE_FADE_IN] = {"fade-in", true},
    [TAKE_FADE_OUT] = {"fade-out", true},
    [TAKE_GAIN] = {"gain", true},
    [TAKE_OFFSET] = {"offset", true},
    [TAKE_LENGTH] = {"length", true},
    [TAKE_RIPPLE] = {"ripple", false},
    [TAKE_OWN] = {"own", true},
    [TAKE_PLACE] = {"place", true},
    [TAKE_REGION] = {"region", true},
    [TAKE_FROM] = {"from", true},
    [TAKE_SOURCE] = {"source", true},
    [TAKE_SCENE] = {"scene", true},
    [TAKE_SHOT] = {"shot", true},
    [TAKE_NUMBER] = {"number", true},
    [TAKE_START] = {"start", true},
    [TAKE_FPS] = {"fps", true},
    [TAKE_LAST] = {"last", true},
    [TAKE_FACE] = {"face", true},
    [TAKE_MAP] = {"map", true},
    [TAKE_CALIBRATION] = {"calibration", true},
    [TAKE_HAND_LENGTH] = {"hand-length", true},
    [TAKE_FILTER] = {"filter", true},
    [TAKE_EXPORT] = {"export", true},
    [TAKE_WAV] = {"wav", false},
    [TAKE_TOLERANCE] = {"tolerance", true},
    [TAKE_MAX_TARGETS] = {"max-targets", true},
    [TAKE_CSV] = {"csv", true},
    [TAKE_TRACK] = {"track", true},
    [TAKE_HASH_OPTION] = {"hash", false},
    [TAKE_STEPS] = {"steps", true},
    [TAKE_INPUT] = {"input", true},
    [TAKE_PREROLL] = {"preroll", true},
    [TAKE_COUNT_IN] = {"count-in", true},
    [TAKE_PASSES] = {"passes", true},
    [TAKE_NAME_OPTION] = {"name", true},
    [TAKE_REALTIME] = {"realtime", false},
    [TAKE_REZERO_PEDAL] = {"rezero-pedal", true},
    [TAKE_SIZE] = {"size", true},
    [TAKE_VIEW] = {"view", true},
    [TAKE_MIRROR] = {"mirror", false},
    [TAKE_BACKGROUND] = {"background", true},
};

const char *take_option_name(take_option option)
{
    return options[option].name;
}

static int misused(const take_verb *verb, const char *what, const char *text)
{
    fprintf(stderr, "marotte take %s: \"%s\" %s (marotte take %s --help)\n", verb->name, text, what,
            verb->name);
    return COMMAND_USAGE;
}

static int add_export(take_call *out, const char *path)
{
    exports_file file = {path, exports_format_of(path)};
    if (strcmp(file_extension_of(path).text, "wav") == 0) {
        out->wav = path;
        return COMMAND_DONE;
    }
    if (out->export_count == EXPORTS_MAX)
        return misused(out->verb, "is one export too many", path);
    if (file.format == EXPORTS_NONE)
        return misused(out->verb,
                       "does not end in .glb, .pc2, .mdd, .csv, .png, .mp4, .wav or / (a folder)",
                       path);
    out->exports[out->export_count++] = file;
    return COMMAND_DONE;
}

static int add_calibration(take_call *out, const char *path)
{
    if (out->calibration_count == TAKE_CALIBRATIONS_MAX)
        return misused(out->verb, "is one calibration too many: one per hand", path);
    out->calibration[out->calibration_count++] = path;
    return COMMAND_DONE;
}

static int add_input(take_call *out, const char *spec)
{
    if (out->input_count == TAKE_INPUTS_MAX)
        return misused(out->verb, "is one input too many", spec);
    out->input[out->input_count++] = spec;
    return COMMAND_DONE;
}

static int take_one(take_call *out, take_option option, const char *value)
{
    if (option == TAKE_EXPORT)
        return add_export(out, value);
    if (option == TAKE_CALIBRATION)
        return add_calibration(out, value);
    if (option == TAKE_INPUT)
        return add_input(out, value);
    if (out->text[option] && value)
        return misused(out->verb, "was given twice", options[option].name);
    out->text[option] = value ? value : "";
    return COMMAND_DONE;
}

/* "SHOW TAKE [VALUE]": so many must be there, so many may be. */
static void count_words(const char *words, uint32_t *out_least, uint32_t *out_most)
{
    *out_least = *out_most = 0;
    for (const char *at = words; *at; at += strcspn(at, " "), at += *at == ' ') {
        *out_most += 1;
        *out_least += *at != '[';
    }
}

static int take_words(take_call *out, int argc, char **argv)
{
    uint32_t least, most;
    count_words(out->verb->words, &least, &most);
    for (int i = optind; i < argc; ++i) {
        if (out->word_count == most)
            return misused(out->verb, "is not expected here", argv[i]);
        out->word[out->word_count++] = argv[i];
    }
    if (out->word_count >= least)
        return COMMAND_DONE;
    fprintf(stderr, "marotte take %s: say %s (marotte take %s --help)\n", out->verb->name,
            out->verb->words, out->verb->name);
    return COMMAND_USAGE;
}

static uint32_t list_options(struct option *out, const take_verb *verb)
{
    uint32_t count = 0;
    for (int i = 0; i < TAKE_OPTION_COUNT; ++i)
        if (i == TAKE_JSON || verb->options & TAKE_BIT(i))
            out[count++] = (struct option){options[i].name,
                                           options[i].has_value ? required_argument : no_argument,
                                           NULL, OPTION_FIRST + i};
    out[count] = (struct option){NULL, 0, NULL, 0};
    return count;
}

int take_options_read(take_call *out, const take_verb *verb, int argc, char **argv)
{
    struct option known[TAKE_OPTION_COUNT + 1];
    *out = (take_call){.verb = verb};
    (void)list_options(known, verb);
    int code = COMMAND_DONE, option;
    opterr = 0;
    while (code == COMMAND_DONE && (option = getopt_long(argc, argv, ":", known, NULL)) != -1) {
        if (option == ':')
            code = misused(verb, "needs a value", argv[optind - 1]);
        else if (option == '?')
            code = misused(verb, "is no option of it", argv[optind - 1]);
        else
            code = take_one(out, (take_option)(option - OPTION_FIRST), optarg);
    }
    return code == COMMAND_DONE ? take_words(out, argc, argv) : code;
}
