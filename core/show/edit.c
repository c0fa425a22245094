/* Edits as data: the operations with their arguments and ranges, and the line of JSON. */
#include "show/edit.h"

#include "base/json.h"
#include "base/text.h"
#include "show/own.h"
#include "base/timecode.h"

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- operations and their arguments ---- */

typedef enum edit_argument_kind {
    EDIT_COUNT,   /* uint32_t, low..high */
    EDIT_INTEGER, /* int64_t, low..high */
    EDIT_NUMBER,  /* double, low_number..high_number */
    EDIT_FLAG,
    EDIT_LINE,  /* char[size], no control characters */
    EDIT_PROSE, /* char[size], newlines allowed */
    EDIT_OWN,
    EDIT_LAYERS,
    EDIT_REGIONS,
    EDIT_WARP
} edit_argument_kind;

typedef struct edit_argument {
    const char *key;
    edit_argument_kind kind;
    size_t offset, size; /* in struct edit */
    int64_t low, high;
    double low_number, high_number;
} edit_argument;

enum { EDIT_ARGUMENTS_MAX = 12 };
typedef struct edit_use { /* how an operation uses an argument */
    const edit_argument *argument;
    bool is_optional;
} edit_use;

/* ---- every argument ---- */

typedef enum argument_id {
    A_END = 0,
    A_LAYER,
    A_CLIP,
    A_MARKER,
    A_PLACE,
    A_NUMBER,
    A_RATING,
    A_COLOUR,
    A_REGIONS,
    A_PART,
    A_MUTED,
    A_SOLO,
    A_ADDITIVE,
    A_DROP,
    A_RIPPLE,
    A_PERFORMANCE,
    A_AUDIO,
    A_FROM,
    A_TO,
    A_SOURCE,
    A_START,
    A_STOP,
    A_AT,
    A_IN,
    A_OUT,
    A_FADE,
    A_FADE_IN,
    A_FADE_OUT,
    A_LENGTH,
    A_OFFSET,
    A_FRAME,
    A_FPS,
    A_GAIN,
    A_SPEED,
    A_SMOOTH,
    A_NAME,
    A_SCENE,
    A_SHOT,
    A_TEXT,
    A_NOTE,
    A_LAYERS,
    A_OWN,
    A_WARP,
    A_COUNT
} argument_id;

#define AT(field)    offsetof(edit, field), sizeof((edit *)0)->field
#define TIME         -EDIT_TIME_MAX_NS, EDIT_TIME_MAX_NS, 0, 0
#define LENGTH       0, EDIT_TIME_MAX_NS, 0, 0
#define ANY_ID       1, UINT32_MAX - 1, 0, 0
#define SHOW_TIME    0, INT64_C(4000000000000000000), 0, 0 /* until the year 2096 */
#define FLOATS(a, b) 0, 0, (a), (b)
#define NO_RANGE     0, 0, 0, 0

static const edit_argument arguments[A_COUNT] = {
    [A_LAYER] = {"layer", EDIT_COUNT, AT(layer), ANY_ID},
    [A_CLIP] = {"clip", EDIT_COUNT, AT(clip), ANY_ID},
    [A_MARKER] = {"marker", EDIT_COUNT, AT(marker), 0, EDIT_MARKERS_MAX - 1, 0, 0},
    [A_PLACE] = {"place", EDIT_COUNT, AT(place), 0, EDIT_LAYERS_MAX - 1, 0, 0},
    [A_NUMBER] = {"number", EDIT_COUNT, AT(number), 1, 99999, 0, 0},
    [A_RATING] = {"rating", EDIT_COUNT, AT(rating), 0, 5, 0, 0},
    [A_COLOUR] = {"colour", EDIT_COUNT, AT(colour), 0, TAKE_COLOURS - 1, 0, 0},
    [A_REGIONS] = {"regions", EDIT_REGIONS, AT(regions), NO_RANGE},
    [A_PART] = {"part", EDIT_COUNT, AT(part), 1, TAKE_PARTS - 1, 0, 0},
    [A_MUTED] = {"muted", EDIT_FLAG, AT(is_muted), NO_RANGE},
    [A_SOLO] = {"solo", EDIT_FLAG, AT(is_solo), NO_RANGE},
    [A_ADDITIVE] = {"additive", EDIT_FLAG, AT(is_additive), NO_RANGE},
    [A_DROP] = {"drop", EDIT_FLAG, AT(is_drop), NO_RANGE},
    [A_RIPPLE] = {"ripple", EDIT_FLAG, AT(is_ripple), NO_RANGE},
    [A_PERFORMANCE] = {"performance", EDIT_INTEGER, AT(performance), 1, INT64_MAX, 0, 0},
    [A_AUDIO] = {"audio", EDIT_INTEGER, AT(audio), 1, INT64_MAX, 0, 0},
    [A_FROM] = {"from_ns", EDIT_INTEGER, AT(from_ns), SHOW_TIME},
    [A_TO] = {"to_ns", EDIT_INTEGER, AT(to_ns), SHOW_TIME},
    [A_SOURCE] = {"source_ns", EDIT_INTEGER, AT(source_ns), LENGTH},
    [A_START] = {"start_ns", EDIT_INTEGER, AT(start_ns), TIME},
    [A_STOP] = {"end_ns", EDIT_INTEGER, AT(end_ns), TIME},
    [A_AT] = {"at_ns", EDIT_INTEGER, AT(at_ns), TIME},
    [A_IN] = {"in_ns", EDIT_INTEGER, AT(in_ns), TIME},
    [A_OUT] = {"out_ns", EDIT_INTEGER, AT(out_ns), TIME},
    [A_FADE] = {"fade_ns", EDIT_INTEGER, AT(fade_ns), LENGTH},
    [A_FADE_IN] = {"fade_in_ns", EDIT_INTEGER, AT(fade_in_ns), LENGTH},
    [A_FADE_OUT] = {"fade_out_ns", EDIT_INTEGER, AT(fade_out_ns), LENGTH},
    [A_LENGTH] = {"length_ns", EDIT_INTEGER, AT(length_ns), 1, EDIT_TIME_MAX_NS, 0, 0},
    [A_OFFSET] = {"offset_ns", EDIT_INTEGER, AT(offset_ns), TIME},
    [A_FRAME] = {"frame", EDIT_INTEGER, AT(frame), 0, 100000000, 0, 0},
    [A_FPS] = {"fps", EDIT_NUMBER, AT(fps), FLOATS(TIMECODE_FPS_MIN, TIMECODE_FPS_MAX)},
    [A_GAIN] = {"gain", EDIT_NUMBER, AT(gain), FLOATS(0.0, 10.0)},
    [A_SPEED] = {"speed", EDIT_NUMBER, AT(speed), FLOATS(0.01, 100.0)},
    [A_SMOOTH] = {"smooth_s", EDIT_NUMBER, AT(smooth_s), FLOATS(0.0, 10.0)},
    [A_NAME] = {"name", EDIT_LINE, AT(name), NO_RANGE},
    [A_SCENE] = {"scene", EDIT_LINE, AT(scene), NO_RANGE},
    [A_SHOT] = {"shot", EDIT_LINE, AT(shot), NO_RANGE},
    [A_TEXT] = {"text", EDIT_LINE, AT(text), NO_RANGE},
    [A_NOTE] = {"note", EDIT_PROSE, AT(note), NO_RANGE},
    [A_LAYERS] = {"layers", EDIT_LAYERS, AT(layers), NO_RANGE},
    [A_OWN] = {"own", EDIT_OWN, AT(own), NO_RANGE},
    [A_WARP] = {"warp", EDIT_WARP, AT(warp), NO_RANGE},
};

/* ---- all operations: required arguments, A_END, optional arguments, A_END ---- */

#define MATERIAL A_PERFORMANCE, A_FROM, A_TO

typedef struct operation {
    const char *name;
    uint8_t needs[8], takes[8];
} operation;

static const operation operations[EDIT_KIND_COUNT] = {
    [EDIT_NONE] = {"", {0}, {0}},
    [EDIT_TAKE_SLATE] = {"take.slate", {A_SCENE, A_SHOT, A_NUMBER}, {0}},
    [EDIT_TAKE_RENAME] = {"take.rename", {A_NAME}, {0}},
    [EDIT_TAKE_NOTE] = {"take.note", {A_NOTE}, {0}},
    [EDIT_TAKE_RATE] = {"take.rate", {A_RATING}, {0}},
    [EDIT_TAKE_FPS] = {"take.fps", {A_FPS}, {0}},
    [EDIT_TAKE_TIMECODE] = {"take.timecode", {A_FRAME}, {A_DROP}},
    [EDIT_TAKE_DELETE] = {"take.delete", {0}, {0}},
    [EDIT_TAKE_RESTORE] = {"take.restore", {0}, {0}},
    [EDIT_MARKER_ADD] = {"marker.add", {A_AT, A_TEXT}, {0}},
    [EDIT_MARKER_MOVE] = {"marker.move", {A_MARKER, A_AT}, {0}},
    [EDIT_MARKER_RENAME] = {"marker.rename", {A_MARKER, A_TEXT}, {0}},
    [EDIT_MARKER_REMOVE] = {"marker.remove", {A_MARKER}, {0}},
    [EDIT_LAYER_ADD] = {"layer.add", {A_NAME}, {A_OWN, A_PLACE}},
    [EDIT_LAYER_REMOVE] = {"layer.remove", {A_LAYER}, {0}},
    [EDIT_LAYER_RENAME] = {"layer.rename", {A_LAYER, A_NAME}, {0}},
    [EDIT_LAYER_ORDER] = {"layer.order", {A_LAYER, A_PLACE}, {0}},
    [EDIT_LAYER_MUTE] = {"layer.mute", {A_LAYER, A_MUTED}, {0}},
    [EDIT_LAYER_SOLO] = {"layer.solo", {A_LAYER, A_SOLO}, {0}},
    [EDIT_LAYER_ADDITIVE] = {"layer.additive", {A_LAYER, A_ADDITIVE}, {0}},
    [EDIT_LAYER_GAIN] = {"layer.gain", {A_LAYER, A_GAIN}, {0}},
    [EDIT_LAYER_OFFSET] = {"layer.offset", {A_LAYER, A_OFFSET}, {0}},
    [EDIT_LAYER_COLOUR] = {"layer.colour", {A_LAYER, A_COLOUR}, {0}},
    [EDIT_LAYER_OWN] = {"layer.own", {A_LAYER, A_OWN}, {0}},
    [EDIT_CLIP_ADD] = {"clip.add",
                       {A_LAYER, A_PERFORMANCE},
                       {A_FROM, A_TO, A_SOURCE, A_WARP, A_START, A_STOP, A_PART}},
    [EDIT_CLIP_REMOVE] = {"clip.remove", {A_CLIP}, {A_RIPPLE}},
    [EDIT_CLIP_TRIM] = {"clip.trim", {A_CLIP}, {A_START, A_STOP, A_RIPPLE}},
    [EDIT_CLIP_SPLIT] = {"clip.split", {A_CLIP, A_AT}, {0}},
    [EDIT_CLIP_MOVE] = {"clip.move", {A_CLIP}, {A_START, A_LAYER, A_RIPPLE}},
    [EDIT_CLIP_SPEED] = {"clip.speed", {A_CLIP, A_SPEED}, {A_AT, A_RIPPLE}},
    [EDIT_CLIP_CURVE] = {"clip.curve", {A_CLIP, A_WARP}, {0}},
    [EDIT_CLIP_SMOOTH] = {"clip.smooth", {A_CLIP, A_SMOOTH}, {0}},
    [EDIT_CLIP_GAIN] = {"clip.gain", {A_CLIP, A_GAIN}, {0}},
    [EDIT_CLIP_FADE] = {"clip.fade", {A_CLIP}, {A_FADE_IN, A_FADE_OUT}},
    [EDIT_CLIP_MUTE] = {"clip.mute", {A_CLIP, A_MUTED}, {0}},
    [EDIT_CLIP_COLOUR] = {"clip.colour", {A_CLIP, A_COLOUR}, {0}},
    [EDIT_CLIP_PERFORM] = {"clip.perform", {A_CLIP, A_PERFORMANCE}, {0}},
    [EDIT_RANGE_KEEP] = {"range.keep", {A_IN, A_OUT}, {0}},
    [EDIT_RANGE_CUT] = {"range.cut", {A_IN, A_OUT}, {A_RIPPLE, A_LAYERS}},
    [EDIT_RANGE_INSERT] = {"range.insert", {A_AT, A_LENGTH}, {A_LAYERS}},
    [EDIT_PUNCH] = {"punch", {A_LAYER, MATERIAL, A_IN, A_OUT, A_FADE}, {A_SOURCE, A_WARP, A_PART}},
    [EDIT_COMP] = {"comp",
                   {MATERIAL, A_IN, A_OUT, A_FADE},
                   {A_REGIONS, A_OWN, A_NAME, A_SOURCE, A_WARP}},
    [EDIT_MOUTH] = {"mouth", {A_NAME, MATERIAL, A_START, A_STOP}, {A_LAYER}},
    [EDIT_AUDIO_ATTACH] = {"audio.attach", {A_AUDIO}, {A_OFFSET, A_GAIN}},
    [EDIT_AUDIO_OFFSET] = {"audio.offset", {A_OFFSET}, {0}},
    [EDIT_AUDIO_TRIM] = {"audio.trim", {0}, {A_START, A_STOP}},
    [EDIT_AUDIO_GAIN] = {"audio.gain", {A_GAIN}, {0}},
    [EDIT_AUDIO_DETACH] = {"audio.detach", {0}, {0}},
};

const char *edit_name(edit_kind kind)
{
    return (unsigned)kind < EDIT_KIND_COUNT ? operations[kind].name : "";
}

static edit_kind kind_named(const char *name)
{
    for (edit_kind kind = EDIT_NONE + 1; kind < EDIT_KIND_COUNT; ++kind)
        if (strcmp(operations[kind].name, name) == 0)
            return kind;
    return EDIT_NONE;
}

/* Returns the arguments of an operation, in the order of the JSON text. */
static uint32_t uses_of(edit_use out[EDIT_ARGUMENTS_MAX], edit_kind kind)
{
    const operation *known = &operations[(unsigned)kind < EDIT_KIND_COUNT ? kind : EDIT_NONE];
    uint32_t count = 0;
    for (const uint8_t *id = known->needs; *id != A_END; ++id)
        out[count++] = (edit_use){.argument = &arguments[*id]};
    for (const uint8_t *id = known->takes; *id != A_END; ++id)
        out[count++] = (edit_use){.argument = &arguments[*id], .is_optional = true};
    return count;
}

/* ---- an edit without its arguments ---- */

void edit_init(edit *out, edit_kind kind)
{
    *out = (edit){.kind = kind, .place = UINT32_MAX, .gain = 1.0};
    int64_t *const times[] = {&out->from_ns,    &out->to_ns,       &out->source_ns, &out->start_ns,
                              &out->end_ns,     &out->at_ns,       &out->in_ns,     &out->out_ns,
                              &out->fade_in_ns, &out->fade_out_ns, &out->offset_ns};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; ++i)
        *times[i] = EDIT_UNSAID;
}

void edit_finish(edit *e)
{
    if (!e)
        return;
    free(e->own);
    free(e->warp);
    *e = (edit){0};
}

/* Returns false for an optional argument that still has the value of edit_init. */
static bool is_given(const edit *e, const edit_argument *argument)
{
    if (argument->kind == EDIT_OWN)
        return e->own_count > 0;
    if (argument->kind == EDIT_WARP)
        return e->warp_count > 0;
    if (argument->kind == EDIT_LAYERS)
        return e->layer_count > 0;
    edit blank;
    edit_init(&blank, e->kind);
    const char *value = (const char *)e + argument->offset;
    const char *other = (const char *)&blank + argument->offset;
    if (argument->kind == EDIT_LINE)
        return value[0] != '\0';
    return memcmp(value, other, argument->size) != 0;
}

/* ---- ranges ---- */

/* Sets the error "$.gain: expected a number from 0 to 10, found FOUND". */
static mrt_result refuse_argument(error *err, const edit_argument *argument, const char *found)
{
    char expected[160] = "";
    switch (argument->kind) {
    case EDIT_COUNT:
    case EDIT_INTEGER:
        (void)snprintf(expected, sizeof expected, "a whole number from %lld to %lld",
                       (long long)argument->low, (long long)argument->high);
        break;
    case EDIT_NUMBER:
        (void)snprintf(expected, sizeof expected, "a number from %g to %g", argument->low_number,
                       argument->high_number);
        break;
    case EDIT_FLAG:
        (void)snprintf(expected, sizeof expected, "true or false");
        break;
    case EDIT_LINE:
    case EDIT_PROSE:
        (void)snprintf(expected, sizeof expected, "a text of at most %zu bytes%s",
                       argument->size - 1,
                       argument->kind == EDIT_LINE ? " without control characters" : "");
        break;
    case EDIT_OWN:
        (void)snprintf(expected, sizeof expected, "up to %d patterns of names, such as \"mouth.*\"",
                       EDIT_OWN_MAX);
        break;
    case EDIT_LAYERS:
        (void)snprintf(expected, sizeof expected, "1 to %d ids of layers, each once",
                       EDIT_LAYERS_MAX);
        break;
    case EDIT_REGIONS:
        (void)snprintf(expected, sizeof expected,
                       "some of mouth, jaw, brows, lids, eyes, cheeks, nose, head, each once");
        break;
    case EDIT_WARP:
        (void)snprintf(
            expected, sizeof expected,
            "1 to %d points [at_ns, source_ns], both ascending, from 1/1000 to 1000 times "
            "as fast",
            EDIT_WARP_MAX);
        break;
    }
    return error_set(err, MRT_ERR_FORMAT, "$.%s: expected %s, found %s", argument->key, expected,
                     found);
}

enum { SPEED_MAX = 1000 }; /* and 1 / SPEED_MAX */

bool edit_is_warp(const take_warp_point *warp, uint32_t count, int64_t limit_ns)
{
    for (uint32_t i = 0; i < count; ++i) {
        const take_warp_point *p = &warp[i];
        if (p->at_ns < -limit_ns || p->at_ns > limit_ns || p->source_ns < -limit_ns ||
            p->source_ns > limit_ns)
            return false;
        if (i == 0)
            continue;
        int64_t at_ns = p->at_ns - p[-1].at_ns, source_ns = p->source_ns - p[-1].source_ns;
        if (at_ns <= 0 || source_ns <= 0 || source_ns > at_ns * SPEED_MAX ||
            at_ns > source_ns * SPEED_MAX)
            return false;
    }
    return count >= 1 && count <= EDIT_WARP_MAX;
}

static bool is_text(const char *text, size_t size, bool is_prose)
{
    size_t length = strnlen(text, size);
    for (size_t i = 0; i < length; ++i) {
        unsigned char byte = (unsigned char)text[i];
        if ((byte < ' ' || byte == 0x7f) && !(is_prose && (byte == '\n' || byte == '\t')))
            return false;
    }
    return length < size;
}

static bool is_own(const edit *e)
{
    for (uint32_t i = 0; i < e->own_count && i < EDIT_OWN_MAX; ++i)
        if (!is_text(e->own[i], TAKE_NAME, false) || !own_is_pattern(e->own[i]))
            return false;
    return e->own_count <= EDIT_OWN_MAX;
}

static bool is_layers(const edit *e)
{
    if (e->layer_count > EDIT_LAYERS_MAX)
        return false;
    for (uint32_t i = 0; i < e->layer_count; ++i)
        for (uint32_t j = 0; j <= i; ++j)
            if (e->layers[i] == 0 || (j < i && e->layers[i] == e->layers[j]))
                return false;
    return true;
}

static mrt_result check_integer(const edit_argument *argument, int64_t value, error *err)
{
    char found[32];
    if (value >= argument->low && value <= argument->high)
        return MRT_OK;
    (void)snprintf(found, sizeof found, "%lld", (long long)value);
    return refuse_argument(err, argument, value == EDIT_UNSAID ? "nothing" : found);
}

static mrt_result check_number(const edit_argument *argument, double value, error *err)
{
    char found[32];
    if (value >= argument->low_number && value <= argument->high_number)
        return MRT_OK;
    (void)snprintf(found, sizeof found, "%.9g", value);
    return refuse_argument(err, argument, found);
}

static mrt_result check_argument(const edit *e, const edit_argument *argument, error *err)
{
    const char *at = (const char *)e + argument->offset;
    uint32_t count;
    int64_t integer;
    double number;
    bool holds = true;
    switch (argument->kind) {
    case EDIT_COUNT:
        memcpy(&count, at, sizeof count);
        return check_integer(argument, count, err);
    case EDIT_INTEGER:
        memcpy(&integer, at, sizeof integer);
        return check_integer(argument, integer, err);
    case EDIT_NUMBER:
        memcpy(&number, at, sizeof number);
        return check_number(argument, number, err);
    case EDIT_FLAG:
        break;
    case EDIT_LINE:
    case EDIT_PROSE:
        holds = is_text(at, argument->size, argument->kind == EDIT_PROSE);
        break;
    case EDIT_OWN:
        holds = is_own(e);
        break;
    case EDIT_LAYERS:
        holds = is_layers(e);
        break;
    case EDIT_REGIONS:
        holds = e->regions < 1u << OWN_REGION_COUNT;
        break;
    case EDIT_WARP:
        holds = e->warp_count <= EDIT_WARP_MAX &&
                (!e->warp_count || edit_is_warp(e->warp, e->warp_count, EDIT_TIME_MAX_NS));
        break;
    }
    return holds ? MRT_OK : refuse_argument(err, argument, "other");
}

mrt_result edit_check_arguments(const edit *e, error *err)
{
    if (edit_name(e->kind)[0] == '\0')
        return error_set(err, MRT_ERR_ARGUMENT, "edit of kind %d: unknown operation", (int)e->kind);
    edit_use use[EDIT_ARGUMENTS_MAX];
    uint32_t count = uses_of(use, e->kind);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const edit_argument *argument = use[i].argument;
        if (!use[i].is_optional || is_given(e, argument))
            result = check_argument(e, argument, err);
        if (result >= 0 && argument->kind == EDIT_WARP && !use[i].is_optional && !e->warp_count)
            result = refuse_argument(err, argument, "none");
    }
    return result;
}

/* ---- as JSON ---- */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
}

/* ---- reading ---- */

static mrt_result unexpected(error *err, const edit_argument *argument, const json_t *value)
{
    return refuse_argument(err, argument, json_describe(value).text);
}

static mrt_result read_scalar(char *at, const edit_argument *argument, const json_t *value,
                              error *err)
{
    int64_t integer = json_integer_value(value);
    uint32_t count = (uint32_t)integer;
    double number = json_number_value(value);
    bool flag = json_is_true(value), fits;
    if (argument->kind == EDIT_NUMBER)
        fits = json_is_number(value);
    else if (argument->kind == EDIT_FLAG)
        fits = json_is_boolean(value);
    else
        fits = json_is_integer(value) && integer >= argument->low && integer <= argument->high;
    if (!fits)
        return unexpected(err, argument, value);
    const void *from = argument->kind == EDIT_NUMBER  ? (const void *)&number
                       : argument->kind == EDIT_FLAG  ? (const void *)&flag
                       : argument->kind == EDIT_COUNT ? (const void *)&count
                                                      : (const void *)&integer;
    memcpy(at, from, argument->size);
    return MRT_OK;
}

static mrt_result read_text(char *at, const edit_argument *argument, const json_t *value,
                            error *err)
{
    if (!json_is_string(value) || json_string_length(value) >= argument->size)
        return unexpected(err, argument, value);
    memcpy(at, json_string_value(value), json_string_length(value));
    return MRT_OK;
}

static mrt_result read_own(edit *e, const edit_argument *argument, const json_t *value, error *err)
{
    size_t count = json_array_size(value);
    if (!json_is_array(value) || count > EDIT_OWN_MAX)
        return unexpected(err, argument, value);
    e->own = calloc(count + 1, sizeof *e->own);
    if (!e->own)
        return no_memory(err);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        if (!json_is_string(item) || json_string_length(item) >= TAKE_NAME)
            return unexpected(err, argument, item);
        memcpy(e->own[i], json_string_value(item), json_string_length(item));
    }
    e->own_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_layers(edit *e, const edit_argument *argument, const json_t *value,
                              error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > EDIT_LAYERS_MAX)
        return unexpected(err, argument, value);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        int64_t id = json_integer_value(item);
        if (!json_is_integer(item) || id < 1 || id >= UINT32_MAX)
            return unexpected(err, argument, item);
        e->layers[i] = (uint32_t)id;
    }
    e->layer_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_regions(edit *e, const edit_argument *argument, const json_t *value,
                               error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > OWN_REGION_COUNT)
        return unexpected(err, argument, value);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        own_region region = OWN_MOUTH;
        if (!json_is_string(item) || !own_region_named(json_string_value(item), &region) ||
            (e->regions & 1u << region))
            return unexpected(err, argument, item);
        e->regions |= 1u << region;
    }
    return MRT_OK;
}

static mrt_result read_warp(edit *e, const edit_argument *argument, const json_t *value, error *err)
{
    size_t count = json_array_size(value);
    if (count < 1 || count > EDIT_WARP_MAX)
        return unexpected(err, argument, value);
    e->warp = calloc(count, sizeof *e->warp);
    if (!e->warp)
        return no_memory(err);
    for (size_t i = 0; i < count; ++i) {
        const json_t *item = json_array_get(value, i);
        const json_t *at = json_array_get(item, 0), *source = json_array_get(item, 1);
        if (json_array_size(item) != 2 || !json_is_integer(at) || !json_is_integer(source))
            return unexpected(err, argument, item);
        e->warp[i] = (take_warp_point){json_integer_value(at), json_integer_value(source)};
    }
    e->warp_count = (uint32_t)count;
    return MRT_OK;
}

static mrt_result read_argument(edit *e, const edit_argument *argument, const json_t *value,
                                error *err)
{
    switch (argument->kind) {
    case EDIT_LINE:
    case EDIT_PROSE:
        return read_text((char *)e + argument->offset, argument, value, err);
    case EDIT_OWN:
        return read_own(e, argument, value, err);
    case EDIT_LAYERS:
        return read_layers(e, argument, value, err);
    case EDIT_REGIONS:
        return read_regions(e, argument, value, err);
    case EDIT_WARP:
        return read_warp(e, argument, value, err);
    default:
        return read_scalar((char *)e + argument->offset, argument, value, err);
    }
}

static mrt_result read_kind(edit_kind *out, const json_t *object, error *err)
{
    const json_t *op = json_object_get(object, "op");
    if (!json_is_string(op))
        return error_set(err, MRT_ERR_FORMAT,
                         "$.op: expected the name of an operation, such as \"clip.trim\"");
    *out = kind_named(json_string_value(op));
    if (*out != EDIT_NONE)
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "$.op: unknown edit %s; a newer marotte may have made it",
                     json_describe(op).text);
}

static bool is_used(const edit_use *use, uint32_t count, const char *key)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(use[i].argument->key, key) == 0)
            return true;
    return false;
}

static mrt_result refuse_unknown_keys(const edit_use *use, uint32_t count, edit_kind kind,
                                      json_t *object, error *err)
{
    const char *key;
    json_t *value;
    json_object_foreach(object, key, value)
    {
        if (strcmp(key, "op") == 0 || is_used(use, count, key))
            continue;
        char word[64];
        text_copy(word, sizeof word, text_view_of(key, strlen(key)));
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "$.%s: unknown argument of %s; a newer marotte may "
                         "have made it",
                         word, edit_name(kind));
    }
    return MRT_OK;
}

static mrt_result read_edit(edit *e, json_t *object, error *err)
{
    edit_kind kind = EDIT_NONE;
    edit_use use[EDIT_ARGUMENTS_MAX];
    mrt_result result = read_kind(&kind, object, err);
    if (result < 0)
        return result;
    uint32_t count = uses_of(use, kind);
    edit_init(e, kind);
    result = refuse_unknown_keys(use, count, kind, object, err);
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const json_t *value = json_object_get(object, use[i].argument->key);
        if (value)
            result = read_argument(e, use[i].argument, value, err);
        else if (!use[i].is_optional)
            result = refuse_argument(err, use[i].argument, "nothing");
    }
    return result < 0 ? result : edit_check_arguments(e, err);
}

mrt_result edit_parse(edit *out, const char *text, size_t size, error *err)
{
    *out = (edit){0};
    if (size > EDIT_BYTES_MAX)
        return error_set(err, MRT_ERR_FORMAT, "$: an edit of %zu bytes; expected at most %d", size,
                         EDIT_BYTES_MAX);
    json_error_t where;
    json_t *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    if (!object) {
        char why[JSON_ERROR_TEXT_LENGTH];
        text_copy(why, sizeof why, text_view_of(where.text, strlen(where.text)));
        return error_set(err, MRT_ERR_FORMAT, "$: byte %d is not JSON: %s", where.position, why);
    }
    mrt_result result =
        json_is_object(object)
            ? read_edit(out, object, err)
            : error_set(err, MRT_ERR_FORMAT, "$: expected an object such as {\"op\":\"...\"}");
    json_decref(object);
    if (result < 0)
        edit_finish(out);
    return result;
}

/* ---- writing ---- */

/* Returns the array with the item appended; NULL: the item or the array is NULL. */
static json_t *with_item(json_t *array, json_t *item)
{
    if (json_array_append_new(array, item) == 0)
        return array;
    json_decref(array);
    return NULL;
}

static json_t *layer_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < e->layer_count; ++i)
        array = with_item(array, json_integer(e->layers[i]));
    return array;
}

static json_t *own_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < e->own_count; ++i)
        array = with_item(array, json_string(e->own[i]));
    return array;
}

static json_t *region_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < OWN_REGION_COUNT; ++i)
        if (e->regions & 1u << i)
            array = with_item(array, json_string(own_part_of((own_region)i)->name));
    return array;
}

static json_t *warp_array(const edit *e)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i < e->warp_count; ++i)
        array = with_item(array, json_pack("[I,I]", (json_int_t)e->warp[i].at_ns,
                                           (json_int_t)e->warp[i].source_ns));
    return array;
}

static json_t *written(const edit *e, const edit_argument *argument)
{
    const char *at = (const char *)e + argument->offset;
    uint32_t count;
    int64_t integer;
    double number;
    bool flag;
    switch (argument->kind) {
    case EDIT_COUNT:
        memcpy(&count, at, sizeof count);
        return json_integer(count);
    case EDIT_INTEGER:
        memcpy(&integer, at, sizeof integer);
        return json_integer(integer);
    case EDIT_NUMBER:
        memcpy(&number, at, sizeof number);
        return json_real(number);
    case EDIT_FLAG:
        memcpy(&flag, at, sizeof flag);
        return json_boolean(flag);
    case EDIT_LINE:
    case EDIT_PROSE:
        return json_string(at); /* NULL: not UTF-8 */
    case EDIT_OWN:
        return own_array(e);
    case EDIT_LAYERS:
        return layer_array(e);
    case EDIT_REGIONS:
        return region_array(e);
    case EDIT_WARP:
        return warp_array(e);
    }
    return NULL;
}

mrt_result edit_write(char **out, const edit *e, error *err)
{
    *out = NULL;
    mrt_result result = edit_check_arguments(e, err);
    if (result < 0)
        return result;
    edit_use use[EDIT_ARGUMENTS_MAX];
    uint32_t count = uses_of(use, e->kind);
    json_t *object = json_pack("{s:s}", "op", edit_name(e->kind));
    for (uint32_t i = 0; object && i < count; ++i) {
        const edit_argument *argument = use[i].argument;
        if (use[i].is_optional && !is_given(e, argument))
            continue;
        if (json_object_set_new(object, argument->key, written(e, argument)) < 0) {
            json_decref(object);
            return refuse_argument(err, argument, "a text that is not UTF-8, or no memory");
        }
    }
    *out = object ? json_dumps(object, JSON_COMPACT) : NULL;
    json_decref(object);
    return *out ? MRT_OK : no_memory(err);
}
