#include "cli/take.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/installed.h"
#include "show/edit_store.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the command line ---- */

static int read_once(void *to, const command *self, const char *name, const char *text)
{
    const char **value = to;
    if (*value)
        return command_usage(self, "--%s is given twice", name);
    *value = text;
    return COMMAND_DONE;
}

static int add_export(void *to, const command *self, const char *name, const char *path)
{
    take_call *out = to;
    exports_file file = {path, exports_format_of(path)};
    (void)name;
    if (strcmp(file_extension_of(path).text, "wav") == 0) {
        out->wav = path;
        return COMMAND_DONE;
    }
    if (out->export_count == EXPORTS_MAX)
        return command_usage(self, "too many exports: \"%s\"", path);
    if (file.format == EXPORTS_NONE)
        return command_usage(self, "\"%s\" does not end in %s .wav", path, exports_names);
    out->exports[out->export_count++] = file;
    return COMMAND_DONE;
}

static int add_calibration(void *to, const command *self, const char *name, const char *path)
{
    take_call *out = to;
    (void)name;
    if (out->calibration_count == PERFORM_CALIBRATIONS_MAX)
        return command_usage(self, "too many calibrations: \"%s\": one per hand", path);
    out->calibration[out->calibration_count++] = path;
    return COMMAND_DONE;
}

static int add_input(void *to, const command *self, const char *name, const char *spec)
{
    take_call *out = to;
    (void)name;
    if (out->input_count == PERFORM_INPUTS_MAX)
        return command_usage(self, "too many inputs: \"%s\"", spec);
    out->input[out->input_count++] = spec;
    return COMMAND_DONE;
}

static int add_output(void *to, const command *self, const char *name, const char *spec)
{
    take_call *out = to;
    (void)name;
    if (out->output_count == PERFORM_OUTPUTS_MAX)
        return command_usage(self, "too many outputs: \"%s\"", spec);
    out->output[out->output_count++] = spec;
    out->text[TAKE_OUTPUT] = spec;
    return COMMAND_DONE;
}

#define VALUE(name, option)                                                                        \
    {                                                                                              \
        name, COMMAND_READ, .offset = offsetof(take_call, text[option]), .read = read_once         \
    }
#define FLAG(name, option)                                                                         \
    {                                                                                              \
        name, COMMAND_GIVEN, .offset = offsetof(take_call, text[option])                           \
    }
static const command_option options[TAKE_OPTION_COUNT] = {
    [TAKE_JSON] = FLAG("json", TAKE_JSON),
    [TAKE_IN] = VALUE("in", TAKE_IN),
    [TAKE_OUT] = VALUE("out", TAKE_OUT),
    [TAKE_AT] = VALUE("at", TAKE_AT),
    [TAKE_CLIP] = VALUE("clip", TAKE_CLIP),
    [TAKE_LAYER] = VALUE("layer", TAKE_LAYER),
    [TAKE_TO] = VALUE("to", TAKE_TO),
    [TAKE_SPEED] = VALUE("speed", TAKE_SPEED),
    [TAKE_POINTS] = VALUE("points", TAKE_POINTS),
    [TAKE_OFF] = FLAG("off", TAKE_OFF),
    [TAKE_FADE] = VALUE("fade", TAKE_FADE),
    [TAKE_FADE_IN] = VALUE("fade-in", TAKE_FADE_IN),
    [TAKE_FADE_OUT] = VALUE("fade-out", TAKE_FADE_OUT),
    [TAKE_GAIN] = VALUE("gain", TAKE_GAIN),
    [TAKE_OFFSET] = VALUE("offset", TAKE_OFFSET),
    [TAKE_LENGTH] = VALUE("length", TAKE_LENGTH),
    [TAKE_RIPPLE] = FLAG("ripple", TAKE_RIPPLE),
    [TAKE_OWN] = VALUE("own", TAKE_OWN),
    [TAKE_PLACE] = VALUE("place", TAKE_PLACE),
    [TAKE_REGION] = VALUE("region", TAKE_REGION),
    [TAKE_FROM] = VALUE("from", TAKE_FROM),
    [TAKE_SOURCE] = VALUE("source", TAKE_SOURCE),
    [TAKE_SCENE] = VALUE("scene", TAKE_SCENE),
    [TAKE_SHOT] = VALUE("shot", TAKE_SHOT),
    [TAKE_NUMBER] = VALUE("number", TAKE_NUMBER),
    [TAKE_START] = VALUE("start", TAKE_START),
    [TAKE_FPS] = VALUE("fps", TAKE_FPS),
    [TAKE_LAST] = VALUE("last", TAKE_LAST),
    [TAKE_FACE] = VALUE("face", TAKE_FACE),
    [TAKE_MAP] = VALUE("map", TAKE_MAP),
    [TAKE_PATCH] = VALUE("patch", TAKE_PATCH),
    [TAKE_CALIBRATION] = {"calibration", COMMAND_READ, .read = add_calibration},
    [TAKE_HAND_LENGTH] = VALUE("hand-length", TAKE_HAND_LENGTH),
    [TAKE_FILTER] = VALUE("filter", TAKE_FILTER),
    [TAKE_EXPORT] = {"export", COMMAND_READ, .read = add_export},
    [TAKE_WAV] = FLAG("wav", TAKE_WAV),
    [TAKE_TOLERANCE] = VALUE("tolerance", TAKE_TOLERANCE),
    [TAKE_MAX_TARGETS] = VALUE("max-targets", TAKE_MAX_TARGETS),
    [TAKE_BARE] = FLAG("bare", TAKE_BARE),
    [TAKE_UNIT] = VALUE("unit", TAKE_UNIT),
    [TAKE_BY_PART] = FLAG("by-part", TAKE_BY_PART),
    [TAKE_CSV] = VALUE("csv", TAKE_CSV),
    [TAKE_TRACK] = VALUE("track", TAKE_TRACK),
    [TAKE_HASH_OPTION] = FLAG("hash", TAKE_HASH_OPTION),
    [TAKE_STEPS] = VALUE("steps", TAKE_STEPS),
    [TAKE_INPUT] = {"input", COMMAND_READ, .read = add_input},
    [TAKE_PREROLL] = VALUE("preroll", TAKE_PREROLL),
    [TAKE_COUNT_IN] = VALUE("count-in", TAKE_COUNT_IN),
    [TAKE_PASSES] = VALUE("passes", TAKE_PASSES),
    [TAKE_NAME_OPTION] = VALUE("name", TAKE_NAME_OPTION),
    [TAKE_REALTIME] = FLAG("realtime", TAKE_REALTIME),
    [TAKE_REZERO_PEDAL] = VALUE("rezero-pedal", TAKE_REZERO_PEDAL),
    [TAKE_SIZE] = VALUE("size", TAKE_SIZE),
    [TAKE_VIEW] = VALUE("view", TAKE_VIEW),
    [TAKE_MIRROR] = FLAG("mirror", TAKE_MIRROR),
    [TAKE_BACKGROUND] = VALUE("background", TAKE_BACKGROUND),
    [TAKE_LOOK] = VALUE("look", TAKE_LOOK),
    [TAKE_FRAMES] = VALUE("frames", TAKE_FRAMES),
    [TAKE_ALL] = FLAG("all", TAKE_ALL),
    [TAKE_JOBS] = VALUE("jobs", TAKE_JOBS),
    [TAKE_OUTPUT] = {"output", COMMAND_READ, .read = add_output},
    [TAKE_MOVE] = FLAG("move", TAKE_MOVE),
    [TAKE_WORDS] = VALUE("words", TAKE_WORDS),
    [TAKE_WORDS_FILE] = VALUE("words-file", TAKE_WORDS_FILE),
    [TAKE_JAW] = VALUE("jaw", TAKE_JAW),
    [TAKE_LIPS] = VALUE("lips", TAKE_LIPS),
    [TAKE_SOUND] = VALUE("sound", TAKE_SOUND),
};

const char *take_option_name(take_option option)
{
    return options[option].name;
}

/* Counts the words of "SHOW TAKE [VALUE]": required ones, and all. */
static void count_words(const char *words, uint32_t *out_least, uint32_t *out_most)
{
    *out_least = *out_most = 0;
    for (const char *at = words; *at; at += strcspn(at, " "), at += *at == ' ') {
        *out_most += 1;
        *out_least += *at != '[';
    }
}

static bool has_word(const char *words, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = words; *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == length && strncmp(at, word, length) == 0)
            return true;
    return false;
}

/* Lists the options and words that the subcommand accepts. */
static void list_options(command_option out[COMMAND_OPTIONS_MAX], const take_verb *verb,
                         uint32_t word_most)
{
    uint32_t count = 0, named_least, named_most;
    count_words(verb->options, &named_least, &named_most);
    for (int i = 0; i < TAKE_OPTION_COUNT; ++i)
        if (i == TAKE_JSON || has_word(verb->options, options[i].name))
            out[count++] = options[i];
    assert(count == named_most + 1); /* each name in verb->options is a known option */
    for (uint32_t i = 0; i < word_most; ++i)
        out[count++] = (command_option){"WORD", COMMAND_WORD,
                                        .offset = offsetof(take_call, word) + i * sizeof(char *)};
    out[count] = (command_option){.name = NULL};
}

/* argv[0]: name of the subcommand. Returns COMMAND_DONE, or reports the mistake and returns
 * COMMAND_USAGE. */
static int take_options_read(take_call *out, const take_verb *verb, int argc, char **argv)
{
    command_option known[COMMAND_OPTIONS_MAX];
    uint32_t least, most;
    *out = (take_call){.verb = verb};
    (void)snprintf(out->name, sizeof out->name, "take %s", verb->name);
    out->self.name = out->name;
    count_words(verb->words, &least, &most);
    list_options(known, verb, most);
    int code = command_options(out, &out->self, known, argc, argv);
    while (out->word_count < most && out->word[out->word_count])
        out->word_count += 1;
    if (code == COMMAND_DONE && out->word_count < least)
        code = command_usage(&out->self, "expected %s", verb->words);
    return code;
}

/* ---- numbers, times and rates of options ---- */

mrt_result take_misused(take_call *call, error *err, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(err->text, sizeof err->text, format, arguments);
    va_end(arguments);
    call->is_usage = true;
    return MRT_ERR_ARGUMENT;
}

mrt_result take_need(take_call *call, take_option option, error *err)
{
    if (call->text[option])
        return MRT_OK;
    return take_misused(call, err, "--%s is missing", take_option_name(option));
}

mrt_result take_number_of(take_call *call, const char *what, const char *text, double least,
                          double most, double *out, error *err)
{
    if (text_double(text_view_of(text, strlen(text)), out) && *out >= least && *out <= most)
        return MRT_OK;
    return take_misused(call, err, "%s \"%s\" is not a number from %g to %g", what, text, least,
                        most);
}

mrt_result take_number(take_call *call, take_option option, double least, double most, double *out,
                       error *err)
{
    char what[32];
    if (!call->text[option])
        return MRT_OK;
    (void)snprintf(what, sizeof what, "--%s", take_option_name(option));
    return take_number_of(call, what, call->text[option], least, most, out, err);
}

/* ---- rates ---- */

mrt_result take_rate(take_call *call, const take *t, timecode_rate *out, error *err)
{
    const char *text = call->text[TAKE_FPS];
    double fps = t && t->fps > 0.0 ? t->fps : 30.0;
    if (!text) {
        mrt_result result = timecode_rate_of(out, fps, err);
        if (result >= 0)
            out->is_drop = t && t->is_drop_frame && timecode_can_drop(*out);
        return result;
    }
    if (timecode_rate_parse(out, text, err) >= 0)
        return MRT_OK;
    char why[sizeof err->text / 2];
    (void)snprintf(why, sizeof why, "%.500s", err->text);
    return take_misused(call, err, "--fps: %s", why);
}

/* Number of time code labels per second. */
static int64_t nominal(timecode_rate rate)
{
    return ((int64_t)rate.num + rate.den - 1) / rate.den;
}

/* Returns the label with the same hours, minutes, seconds and share of the second at another
 * rate. */
static int64_t relabel(timecode_rate from, timecode_rate to, int64_t frame)
{
    char text[TIMECODE_TEXT + 32];
    long long hours, minutes, seconds, frames;
    int64_t out;
    error ignored = {""};
    timecode_write(text, from, frame);
    if (sscanf(text, "%lld:%lld:%lld%*[:;]%lld", &hours, &minutes, &seconds, &frames) != 4)
        return frame;
    frames = frames * nominal(to) / nominal(from);
    for (; frames < nominal(to); ++frames) { /* drop-frame skips labels */
        (void)snprintf(text, sizeof text, "%02lld:%02lld:%02lld%c%02lld", hours, minutes, seconds,
                       to.is_drop ? ';' : ':', frames);
        if (timecode_parse(&out, to, text, &ignored) >= 0)
            return out;
    }
    return frame;
}

int64_t take_label_frame(const take *t, timecode_rate rate, int64_t frame)
{
    timecode_rate own = rate;
    error ignored = {""};
    if (t->timecode_frame == 0 || !(t->fps > 0.0) || timecode_rate_of(&own, t->fps, &ignored) < 0)
        return t->timecode_frame + frame;
    own.is_drop = t->is_drop_frame && timecode_can_drop(own);
    bool is_same = own.num == rate.num && own.den == rate.den && own.is_drop == rate.is_drop;
    return (is_same ? t->timecode_frame : relabel(own, rate, t->timecode_frame)) + frame;
}

/* ---- times ---- */

static mrt_result time_of_label(take_call *call, const char *text, const take *t, int64_t *out,
                                error *err)
{
    timecode_rate rate;
    int64_t frame;
    if (!call->text[TAKE_FPS] && !(t->fps > 0.0))
        return take_misused(call, err,
                            "\"%s\" is time code, but the take has no frame rate. Give --fps N, or "
                            "set the rate first: marotte take timecode SHOW TAKE --fps N",
                            text);
    mrt_result result = take_rate(call, t, &rate, err);
    if (result < 0)
        return result;
    rate.is_drop = strchr(text, ';') != NULL && timecode_can_drop(rate);
    if (timecode_parse(&frame, rate, text, err) < 0) {
        call->is_usage = true;
        return MRT_ERR_ARGUMENT;
    }
    *out = timecode_time_ns(rate, frame - take_label_frame(t, rate, 0));
    return MRT_OK;
}

static mrt_result take_time_of(take_call *call, const char *what, const char *text, const take *t,
                               int64_t *out, error *err)
{
    double seconds;
    if (strchr(text, ':') || strchr(text, ';'))
        return time_of_label(call, text, t, out, err);
    mrt_result result = take_number_of(call, what, text, -1e6, 1e6, &seconds, err);
    if (result >= 0)
        *out = llround(seconds * 1e9);
    return result;
}

mrt_result take_time(take_call *call, take_option option, const take *t, int64_t *out, error *err)
{
    char what[32];
    if (!call->text[option])
        return MRT_OK;
    (void)snprintf(what, sizeof what, "--%s", take_option_name(option));
    return take_time_of(call, what, call->text[option], t, out, err);
}

/* ---- the show, and the take, clip or layer in it ---- */

static mrt_result take_open_show(take_call *call, error *err)
{
    static const show_mode modes[] = {
        [TAKE_READS] = SHOW_READ, [TAKE_WRITES] = SHOW_WRITE, [TAKE_RECORDS] = SHOW_RECORD};
    const take_use use = call->verb->use;
    const bool moves = use == TAKE_MOVES && call->text[TAKE_MOVE];
    const show_mode mode = use == TAKE_MOVES ? (moves ? SHOW_WRITE : SHOW_READ) : modes[use];
    const bool writes = mode != SHOW_READ;
    if (access(call->word[0], F_OK) != 0 && errno == ENOENT)
        return error_set(err, MRT_ERR_IO, "%s: %s%s", call->word[0], strerror(ENOENT),
                         suggest_file(call->word[0]).text);
    mrt_result result = show_open(&call->show, call->word[0], mode, err);
    if (result < 0)
        return result;
    if (mode != SHOW_RECORD)
        show_limit_work(call->show);
    const char *notice = show_notice(call->show);
    if (writes && !show_is_writable(call->show))
        return error_set(err, MRT_ERR_IO, "%s", notice);
    if (notice[0])
        fprintf(stderr, "note: %s\n", notice);
    error why = {""};
    if (writes && edit_store_add_recovered_marks(call->show, clock_utc_ms, &why) < 0)
        fprintf(stderr, "warning: %s\n", why.text);
    return MRT_OK;
}

/* ---- finding a take ---- */

static void list_ids(char *out, size_t capacity, const show_take *takes, size_t count)
{
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < count && used + 24 < capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%lld", i ? ", " : "",
                                 (long long)takes[i].id);
}

/* Edits can change the slate, so the take is read with its edits. */
static bool has_slate(take_call *call, const show_take *of, const char *text)
{
    take t;
    error ignored = {""};
    mrt_result result = edit_store_take_of(&t, call->show, of, &ignored);
    bool is_named =
        result >= 0 && strcmp(take_slate_text(t.scene, t.shot, t.number).text, text) == 0;
    take_finish(&t);
    return is_named;
}

static int64_t find_among(take_call *call, const char *text, const show_take *takes, size_t count)
{
    int64_t id;
    if (count > 0 && strcmp(text, "last") == 0)
        return takes[count - 1].id;
    if (text_int(text_view_of(text, strlen(text)), &id)) {
        for (size_t i = 0; i < count; ++i)
            if (takes[i].id == id)
                return id;
        return 0;
    }
    for (size_t i = count; strchr(text, '/') && i-- > 0;)
        if (has_slate(call, &takes[i], text))
            return takes[i].id;
    return 0;
}

mrt_result take_find(take_call *call, const char *text, int64_t *out_id, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_takes(call->show, &takes, &count, err);
    if (result < 0)
        return result;
    *out_id = find_among(call, text, takes, count);
    char ids[200];
    list_ids(ids, sizeof ids, takes, count);
    free(takes);
    if (*out_id)
        return MRT_OK;
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: has no takes. Record one: marotte perform --record %s", call->word[0],
                         call->word[0]);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: has no take \"%.80s\". Takes: %s, \"last\" or SCENE/SHOT/NUMBER",
                     call->word[0], text, ids);
}

mrt_result take_read(take_call *call, const char *text, take *out, error *err)
{
    int64_t id;
    *out = (take){0};
    mrt_result result = take_find(call, text, &id, err);
    if (result < 0)
        return result;
    error why = {""};
    result = edit_store_take(out, call->show, id, &why);
    if (result >= 0)
        return MRT_OK;
    if (out->id == 0)
        return error_set(err, result, "%s", why.text);
    fprintf(stderr, "warning: take %lld: %s; the edits before that one are used\n", (long long)id,
            why.text);
    return MRT_OK;
}

/* ---- finding a clip or a layer ---- */

static mrt_result id_of(take_call *call, take_option option, uint32_t *out, error *err)
{
    double number = 0.0;
    mrt_result result = take_number(call, option, 1, 4e9, &number, err);
    *out = (uint32_t)number;
    return result;
}

static bool is_at(const take_layer *on, const take_clip *c, int64_t at_ns)
{
    return at_ns == EDIT_UNSAID ||
           (c->start_ns + on->offset_ns <= at_ns && at_ns < c->end_ns + on->offset_ns);
}

mrt_result take_find_clip(take_call *call, const take *t, int64_t at_ns, uint32_t *out, error *err)
{
    uint32_t count = 0;
    if (call->text[TAKE_CLIP])
        return id_of(call, TAKE_CLIP, out, err);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (is_at(&t->layer[i], &t->layer[i].clip[k], at_ns)) {
                *out = t->layer[i].clip[k].id;
                count += 1;
            }
    if (count == 1)
        return MRT_OK;
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld has no clip%s", (long long)t->id,
                         at_ns == EDIT_UNSAID ? "" : " at that instant");
    return take_misused(call, err,
                        "take %lld has %u clips%s. Choose one with --clip N (marotte take show)",
                        (long long)t->id, count, at_ns == EDIT_UNSAID ? "" : " at that instant");
}

mrt_result take_find_layer(take_call *call, const take *t, uint32_t *out, error *err)
{
    const char *text = call->text[TAKE_LAYER];
    if (!text && t->layer_count == 1) {
        *out = t->layer[0].id;
        return MRT_OK;
    }
    if (!text)
        return take_misused(
            call, err, "take %lld has %u layers. Choose one with --layer and its number or name",
            (long long)t->id, t->layer_count);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (strcmp(t->layer[i].name, text) == 0) {
            *out = t->layer[i].id;
            return MRT_OK;
        }
    int64_t id;
    if (!text_int(text_view_of(text, strlen(text)), &id) || id < 1 || id > UINT32_MAX - 1)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld has no layer \"%.80s\"",
                         (long long)t->id, text);
    *out = (uint32_t)id;
    return MRT_OK;
}

/* ---- subcommands that perform takes, or read recorded samples ---- */

static const take_verb play_verbs[] = {
    {"play", "SHOW TAKE",
     "  --output SPEC  send the face to this output, in the take's own time; up to 8 times, as in\n"
     "                 marotte perform\n"
     "  --in T, --out T   a range of the take\n"
     "  --face FILE    perform on this face (the face of the recording)\n",
     "play a take into outputs", "output in out face", TAKE_READS, .run = take_play_run,
     .examples = "take play show.marotte last --output vmc:127.0.0.1:39540\n"
                 "take play show.marotte last --output vmc:127.0.0.1:39540 --in 1 --out 1.5\n"},
    {"record", "SHOW TAKE",
     "  --input SPEC, --map SPEC   the hands and the mapping, as in marotte perform\n"
     "  --own NAMES    the parts of the face that the new layer moves (all), see layer own\n"
     "  --name NAME    the name of the new layer\n"
     "  --layer L      punch in: replace a span of this layer instead of adding one\n"
     "  --in T, --out T   the span to record (from 0, until the performance ends)\n"
     "  --fade S       cross-fade at both ends, seconds (0.25)\n"
     "  --count-in S   wait this long before the take starts to play\n"
     "  --preroll S    start to play this long before --in\n"
     "  --passes N     repeat --in to --out, a layer each; the last complete pass is audible\n"
     "  --speed N      speed of the take, 0.1 to 4 (1)\n"
     "  --fps RATE     frame rate for time code, if the take has none\n"
     "  --patch FILE, --calibration FILE, --rezero-pedal N, --realtime, --face FILE\n"
     "                 as in marotte perform\n"
     "Every pass is also a take of its own. q or Ctrl-C ends and keeps the performance.\n",
     "perform over a take: add a layer, or punch in",
     "input map patch own name layer in out fade count-in preroll passes speed calibration "
     "rezero-pedal realtime face fps",
     TAKE_RECORDS, .run = take_record_run,
     .examples =
         "take record show.marotte last --input log:demo_hand.csv,end=2 --map one_hand --own "
         "brows\n"
         "take record show.marotte 2 --input log:demo_hand.csv --map one_hand --layer 1 --in 1 "
         "--out 2\n"},
    {"export", "SHOW [TAKE]",
     "  --export FILE  up to 16 times; the end of the name chooses the format:\n" EXPORTS_HELP
     "      .wav            its sound\n"
     "  --wav          also write the sound, beside the first file\n"
     "  --fps RATE     24, 25, 29.97, 30, 30000/1001, 29.97df ... (the take's, or 30)\n"
     "  --in T, --out T   a range of the take\n"
     "  --frames A-B   only frames A to B of that range, from 1: a part of a video, without sound\n"
     "  --all          export every take; the names of the files contain {show}, {take}, {slate},\n"
     "                 {scene}, {shot}, {number} or {name}. Complete, current files are skipped\n"
     "  --jobs N       takes that are exported at the same time (1)\n"
     "  --face FILE    perform on this face (the face of the recording)\n"
     "  --tolerance MM, --max-targets N, --bare   for glTF, as in marotte perform\n"
     "  --unit mm|cm|m|MM   the unit of .pc2 .mdd .usda .bvh\n"
     "  --by-part      .pc2 and .mdd: a file for each part of the mesh, NAME.1.PART.pc2\n"
     "  --size WxH, --view front|side|three-quarter|1..6, --mirror,\n"
     "  --background #RRGGBB|transparent|PICTURE, --look studio|theatre|daylight|SHOW\n"
     "                 for .mp4, pictures and sheets, as in marotte perform (the show's scene)\n",
     "export takes as animation, pictures, video and sound",
     "export wav fps in out face tolerance max-targets bare unit by-part size view mirror "
     "background look frames all jobs",
     TAKE_READS, .run = take_export_run,
     .examples = "take export show.marotte last --export out/take.glb --export out/take.csv\n"
                 "take export show.marotte last --export out/take.png --size 640x320\n"
                 "take export show.marotte --all --export \"out/{slate}.pc2\" --fps 25\n"},
    {"mouth", "SHOW [TAKE]",
     "  --words TEXT   the words that are said: the mouth is more exact with them\n"
     "  --words-file FILE   the same, from a text file\n"
     "  --jaw N        how much the jaw opens, 0 to 1.5 (1)\n"
     "  --lips N       how much the lips move, 0 to 1.5 (1); lips that close always close\n"
     "  --sound FILE --face FILE   make a take from this voice, instead of TAKE; SHOW may be new\n"
     "  --out FILE.csv write the sounds and their times\n"
     "Adds the layer \"voice mouth\" below the others, which become additive. Run it again to\n"
     "replace it. Speech is recognised by pocketsphinx, in English.\n",
     "move the mouth by the voice of a take", "words words-file jaw lips sound face out",
     TAKE_OPENS_ITSELF, .run = take_mouth_run,
     .examples = "take mouth show.marotte last --words \"hello, my name is Bob\"\n"
                 "take mouth new.marotte --sound voice.wav --face puppet --jaw 1.2\n"},
    {"remap", "SHOW TAKE",
     "  --map SPEC        another mapping: PLUGIN[,key=value] (the recorded one)\n"
     "  --patch FILE      another patch; none: no patch\n"
     "  --face FILE       another face\n"
     "  --calibration FILE   another calibration, one per hand\n"
     "  --hand-length MM  wrist to middle fingertip\n"
     "  --filter min_cutoff=HZ,beta=N   a One-Euro filter of the angles, of a camera too\n"
     "  --scene S, --shot S   the slate of the new take (that of the old one)\n"
     "The old take is not changed. Prints how much the two differ.\n",
     "perform a take again with other settings, as a new take",
     "map patch face calibration hand-length filter scene shot", TAKE_WRITES, .run = take_remap_run,
     .examples = "take remap show.marotte last --map one_hand,smile_gain=130\n"
                 "take remap show.marotte last --face moai --map one_hand\n"
                 "take remap show.marotte last --filter min_cutoff=0.5,beta=0.01\n"},
    {"diff", "SHOW TAKE TAKE",
     "  --region R,R   only these: mouth, jaw, brows, lids, eyes, cheeks, nose, head\n"
     "  --fps RATE     frame rate of the comparison (the first take's, or 30)\n"
     "  --in T, --out T   a range\n"
     "  --face FILE    perform both on this face\n"
     "  --csv FILE     write the difference of each region at each frame, mm\n"
     "A vertex belongs to the region of its nearest contact, within the rig's radius.\n",
     "measure the difference of two takes", "region fps in out face csv", TAKE_READS,
     .run = take_diff_run,
     .examples = "take diff show.marotte 1 2\n"
                 "take diff show.marotte 1 last --region mouth,jaw --csv out/difference.csv\n"},
    {"sync", "SHOW [TAKE]",
     "  --move         also move the layers of the mouth, as edits: marotte take undo\n"
     "  --in T, --out T   a range; at most 120 s of it are compared\n"
     "  --face FILE    perform on this face (the face of the recording)\n"
     "Compares the jaw with the voice in the take's sound. People notice a mouth that is more "
     "than\n"
     "45 ms late or 125 ms early (ITU-R BT.1359). TAKE: the last one if left out.\n",
     "measure how late the mouth is", "move in out face", TAKE_MOVES, .run = take_sync_run,
     .ask = take_sync_edits,
     .examples = "take sync show.marotte last\n"
                 "take sync show.marotte 2 --move --json\n"},
    {"log", "SHOW TAKE",
     "  --track N      the track's number (marotte take show); optional if there is one\n"
     "  --out FILE.csv\n"
     "marotte perform --input log:FILE.csv performs the table.\n",
     "write the raw samples of a track as a table", "track out", TAKE_READS, .run = take_log_run,
     .examples = "take log show.marotte 2 --out out/samples.csv\n"
                 "take log show.marotte 1 --track 1 --out out/first.csv\n"},
};
static const take_verbs take_play_verbs = {"Play, record over, perform again, compare, export",
                                           play_verbs, sizeof play_verbs / sizeof play_verbs[0]};

/* ---- the command ---- */

static const take_verbs *const groups[] = {&take_file_verbs, &take_edit_verbs, &take_layer_verbs,
                                           &take_audio_verbs, &take_play_verbs};
enum { GROUP_COUNT = sizeof groups / sizeof groups[0], HELP_COLUMN = 36 };

/* ---- help ---- */

static void print_overview(void)
{
    fputs("marotte take COMMAND SHOW.marotte [TAKE] [OPTIONS]\n"
          "marotte help take COMMAND          explains a command\n"
          "\n"
          "marotte perform --record SHOW makes takes, from devices or from recordings (--input\n"
          "log:FILE imports one). TAKE is a number, SCENE/SHOT/NUMBER, or last. Times are seconds\n"
          "on the take's timeline, or time code (01:00:02:12). Recorded data never changes; every\n"
          "edit can be undone.\n",
          stdout);
    for (int g = 0; g < GROUP_COUNT; ++g) {
        printf("\n%s\n", groups[g]->title);
        for (uint32_t i = 0; i < groups[g]->count; ++i) {
            const take_verb *verb = &groups[g]->verb[i];
            char call[160];
            (void)snprintf(call, sizeof call, "%s %s", verb->name, verb->words);
            printf("  %-*s %s\n", HELP_COLUMN, call, verb->summary);
        }
    }
    fputs("\nAll: --json prints the facts as JSON. Exit codes: 0 done, 1 failed, 2 wrong usage.\n",
          stdout);
    command_print_examples("take list show.marotte\n"
                           "take trim show.marotte last --in 1 --out 3\n"
                           "take export show.marotte last --export out/take.glb\n");
}

static void print_help(const take_verb *verb)
{
    printf("marotte take %s %s [OPTIONS] [--json]\n\n%c%s.\n%s%s", verb->name, verb->words,
           verb->summary[0] >= 'a' && verb->summary[0] <= 'z' ? verb->summary[0] - 'a' + 'A'
                                                              : verb->summary[0],
           verb->summary + 1, verb->options_text[0] ? "\n" : "", verb->options_text);
    command_print_examples(verb->examples);
}

static bool describe(command_part *out, command_option *table, size_t place)
{
    for (int g = 0; g < GROUP_COUNT; ++g) {
        if (place < groups[g]->count) {
            const take_verb *verb = &groups[g]->verb[place];
            list_options(table, verb, 0);
            *out = (command_part){verb->name, verb->summary, table, NULL};
            return true;
        }
        place -= groups[g]->count;
    }
    return false;
}

/* ---- finding the subcommand ---- */

static bool is_named(const take_verb *verb, int argc, char **argv, int *out_used)
{
    const size_t length = argc > 1 ? strlen(argv[1]) : 0;
    *out_used = 1;
    if (argc < 2)
        return false;
    if (strcmp(verb->name, argv[1]) == 0)
        return true;
    if (argc < 3 || strncmp(verb->name, argv[1], length) != 0 || verb->name[length] != ' ')
        return false;
    *out_used = 2;
    return strcmp(verb->name + length + 1, argv[2]) == 0;
}

static const take_verb *find(int argc, char **argv, int *out_used)
{
    for (int g = 0; g < GROUP_COUNT; ++g)
        for (uint32_t i = 0; i < groups[g]->count; ++i)
            if (is_named(&groups[g]->verb[i], argc, argv, out_used))
                return &groups[g]->verb[i];
    return NULL;
}

/* ---- run ---- */

static mrt_result work(take_call *call, error *err)
{
    mrt_result result = MRT_OK;
    cancel_on_signals(call->verb->use == TAKE_RECORDS ? CANCEL_WAITS : CANCEL_A_SECOND, NULL);
    if (call->verb->use != TAKE_OPENS_ITSELF)
        result = take_open_show(call, err);
    if (result < 0)
        return result;
    return call->verb->run ? call->verb->run(call, err) : take_change_run(call, err);
}

static int run_call(take_call *call)
{
    error err = {""};
    const char *named = call->text[TAKE_FACE];
    char *found = named ? installed_path(INSTALLED_FACE, named) : NULL;
    if (found)
        call->text[TAKE_FACE] = found;
    call->told = facts_create(call->text[TAKE_JSON] ? FACTS_JSON : FACTS_LINES);
    mrt_result result =
        call->told ? work(call, &err) : error_set(&err, MRT_ERR_MEMORY, "no memory");
    progress_end(&call->shown);
    show_close(call->show);
    free(found);
    if (result >= 0 || call->is_told)
        facts_finish(call->told);
    else
        facts_abandon(call->told);
    if (result >= 0)
        return COMMAND_DONE;
    return call->is_usage ? command_usage(&call->self, "%s", err.text)
                          : command_failed(&call->self, &err);
}

/* Reports an unknown subcommand. */
static int refuse(int argc, char **argv)
{
    char word[64];
    suggest near;
    const char *second = argc > 2 && argv[2][0] != '-' ? argv[2] : NULL;
    const bool is_group = strcmp(argv[1], "layer") == 0 || strcmp(argv[1], "audio") == 0;
    (void)snprintf(word, sizeof word, "%.30s%s%.30s", argv[1], is_group && second ? " " : "",
                   is_group && second ? second : "");
    suggest_begin(&near, word);
    for (int g = 0; g < GROUP_COUNT; ++g)
        for (uint32_t i = 0; i < groups[g]->count; ++i)
            suggest_consider(&near, groups[g]->verb[i].name);
    return command_usage(&command_take, "there is no command \"take %s\"%s", word,
                         suggest_question(&near).text);
}

static int print_verb_help(int argc, char **argv)
{
    int used;
    const take_verb *verb = find(argc, argv, &used);
    if (verb)
        print_help(verb);
    else if (argc > 1 && argv[1][0] != '-')
        return refuse(argc, argv);
    else
        print_overview();
    return COMMAND_DONE;
}

static int run(int argc, char **argv)
{
    take_call call;
    int used;
    if (argc < 2)
        return command_usage(&command_take, "a command is missing: list, show, trim, export ...");
    const take_verb *verb = find(argc, argv, &used);
    if (!verb)
        return refuse(argc, argv);
    int code = take_options_read(&call, verb, argc - used, argv + used);
    return code == COMMAND_DONE ? run_call(&call) : code;
}

const command command_take = {.name = "take",
                              .summary = "list, edit, perform again and export takes",
                              .print_help = print_verb_help,
                              .run = run,
                              .part = describe};
