#include "take/edit_parts.h"
#include "take/timecode.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- every argument ---- */

typedef enum argument_id {
    A_END = 0,
    A_LAYER,
    A_CLIP,
    A_MARKER,
    A_PLACE,
    A_NUMBER,
    A_RATING,
    A_REGIONS,
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
    [A_REGIONS] = {"regions", EDIT_REGIONS, AT(regions), NO_RANGE},
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

/* ---- every operation: what it needs, A_END, what it may be given, A_END ---- */

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
    [EDIT_LAYER_OWN] = {"layer.own", {A_LAYER, A_OWN}, {0}},
    [EDIT_CLIP_ADD] = {"clip.add",
                       {A_LAYER, A_PERFORMANCE},
                       {A_FROM, A_TO, A_SOURCE, A_WARP, A_START, A_STOP}},
    [EDIT_CLIP_REMOVE] = {"clip.remove", {A_CLIP}, {0}},
    [EDIT_CLIP_TRIM] = {"clip.trim", {A_CLIP}, {A_START, A_STOP}},
    [EDIT_CLIP_SPLIT] = {"clip.split", {A_CLIP, A_AT}, {0}},
    [EDIT_CLIP_MOVE] = {"clip.move", {A_CLIP}, {A_START, A_LAYER}},
    [EDIT_CLIP_SPEED] = {"clip.speed", {A_CLIP, A_SPEED}, {A_AT}},
    [EDIT_CLIP_CURVE] = {"clip.curve", {A_CLIP, A_WARP}, {0}},
    [EDIT_CLIP_SMOOTH] = {"clip.smooth", {A_CLIP, A_SMOOTH}, {0}},
    [EDIT_CLIP_GAIN] = {"clip.gain", {A_CLIP, A_GAIN}, {0}},
    [EDIT_CLIP_FADE] = {"clip.fade", {A_CLIP}, {A_FADE_IN, A_FADE_OUT}},
    [EDIT_CLIP_MUTE] = {"clip.mute", {A_CLIP, A_MUTED}, {0}},
    [EDIT_CLIP_PERFORM] = {"clip.perform", {A_CLIP, A_PERFORMANCE}, {0}},
    [EDIT_RANGE_KEEP] = {"range.keep", {A_IN, A_OUT}, {0}},
    [EDIT_RANGE_CUT] = {"range.cut", {A_IN, A_OUT}, {A_RIPPLE, A_LAYERS}},
    [EDIT_RANGE_INSERT] = {"range.insert", {A_AT, A_LENGTH}, {A_LAYERS}},
    [EDIT_PUNCH] = {"punch", {A_LAYER, MATERIAL, A_IN, A_OUT, A_FADE}, {A_SOURCE, A_WARP}},
    [EDIT_COMP] = {"comp",
                   {MATERIAL, A_IN, A_OUT, A_FADE},
                   {A_REGIONS, A_OWN, A_NAME, A_SOURCE, A_WARP}},
    [EDIT_AUDIO_ATTACH] = {"audio.attach", {A_AUDIO}, {A_OFFSET, A_GAIN}},
    [EDIT_AUDIO_OFFSET] = {"audio.offset", {A_OFFSET}, {0}},
    [EDIT_AUDIO_GAIN] = {"audio.gain", {A_GAIN}, {0}},
    [EDIT_AUDIO_DETACH] = {"audio.detach", {0}, {0}},
};

const char *edit_name(edit_kind kind)
{
    return (unsigned)kind < EDIT_KIND_COUNT ? operations[kind].name : "";
}

edit_kind edit_kind_named(const char *name)
{
    for (edit_kind kind = EDIT_NONE + 1; kind < EDIT_KIND_COUNT; ++kind)
        if (strcmp(operations[kind].name, name) == 0)
            return kind;
    return EDIT_NONE;
}

uint32_t edit_uses(edit_use out[EDIT_ARGUMENTS_MAX], edit_kind kind)
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

bool edit_says(const edit *e, const edit_argument *argument)
{
    if (argument->kind == EDIT_OWN)
        return e->own_count > 0;
    if (argument->kind == EDIT_WARP)
        return e->warp_count > 0;
    if (argument->kind == EDIT_LAYERS)
        return e->layer_count > 0;
    edit unsaid;
    edit_init(&unsaid, e->kind);
    const char *said = (const char *)e + argument->offset;
    const char *other = (const char *)&unsaid + argument->offset;
    if (argument->kind == EDIT_LINE)
        return said[0] != '\0';
    return memcmp(said, other, argument->size) != 0;
}

/* ---- ranges ---- */

mrt_result edit_unexpected(error *err, const edit_argument *argument, const char *found)
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
    return edit_unexpected(err, argument, value == EDIT_UNSAID ? "nothing" : found);
}

static mrt_result check_number(const edit_argument *argument, double value, error *err)
{
    char found[32];
    if (value >= argument->low_number && value <= argument->high_number)
        return MRT_OK;
    (void)snprintf(found, sizeof found, "%.9g", value);
    return edit_unexpected(err, argument, found);
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
    return holds ? MRT_OK : edit_unexpected(err, argument, "other");
}

mrt_result edit_check_arguments(const edit *e, error *err)
{
    if (edit_name(e->kind)[0] == '\0')
        return error_set(err, MRT_ERR_ARGUMENT, "edit of kind %d: there is no such operation",
                         (int)e->kind);
    edit_use use[EDIT_ARGUMENTS_MAX];
    uint32_t count = edit_uses(use, e->kind);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const edit_argument *argument = use[i].argument;
        if (!use[i].is_optional || edit_says(e, argument))
            result = check_argument(e, argument, err);
        if (result >= 0 && argument->kind == EDIT_WARP && !use[i].is_optional && !e->warp_count)
            result = edit_unexpected(err, argument, "none");
    }
    return result;
}
