/* Describes edits for the user. */
#include "show/edit_layers.h"
#include "show/own.h"
#include "base/timecode.h"

#include <stdio.h>
#include <string.h>

/* Rounds to 1 ms for display. */
static edit_words seconds(int64_t time_ns)
{
    int64_t ms = time_ns / 1000000, rest_ns = time_ns % 1000000;
    return edit_seconds((ms + rest_ns / 500000) * 1000000);
}

static edit_words span(int64_t from_ns, int64_t until_ns)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "%.40s .. %.40s s", seconds(from_ns).text,
                   seconds(until_ns).text);
    return out;
}

static edit_words layer_name(const take *t, uint32_t id)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "layer %u", id);
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].id == id)
            (void)snprintf(out.text, sizeof out.text, "'%.63s'", t->layer[i].name);
    return out;
}

static edit_words quoted(const char *text)
{
    edit_words out;
    (void)snprintf(out.text, sizeof out.text, "'%.95s'", text);
    return out;
}

typedef struct clip_name {
    edit_words words;         /* "'mouth'", or "'mouth' at 2.1 s" if the layer has several clips */
    int64_t start_ns, end_ns; /* shown */
} clip_name;

static clip_name name_clip(const take *t, uint32_t id)
{
    clip_name out = {.start_ns = 0};
    (void)snprintf(out.words.text, sizeof out.words.text, "clip %u", id);
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        const take_layer *layer = &t->layer[i];
        for (uint32_t k = 0; k < layer->clip_count; ++k) {
            if (layer->clip[k].id != id)
                continue;
            out.start_ns = layer->clip[k].start_ns + layer->offset_ns;
            out.end_ns = layer->clip[k].end_ns + layer->offset_ns;
            if (layer->clip_count > 1)
                (void)snprintf(out.words.text, sizeof out.words.text, "'%.63s' at %.30s s",
                               layer->name, seconds(out.start_ns).text);
            else
                out.words = quoted(layer->name);
        }
    }
    return out;
}

static edit_words patterns(const edit *e)
{
    edit_words out;
    size_t used = 0;
    (void)snprintf(out.text, sizeof out.text, "everything");
    for (uint32_t i = 0; i < e->own_count && used + 1 < sizeof out.text; ++i) {
        int length =
            snprintf(out.text + used, sizeof out.text - used, "%s%s", i ? ", " : "", e->own[i]);
        used += length > 0 ? (size_t)length : 0;
    }
    return out;
}

static edit_words regions(const edit *e)
{
    edit_words out;
    size_t used = 0;
    if (e->own_count)
        return patterns(e);
    out.text[0] = '\0';
    for (uint32_t i = 0; i < OWN_REGION_COUNT && used + 1 < sizeof out.text; ++i) {
        if (!(e->regions & 1u << i))
            continue;
        int length = snprintf(out.text + used, sizeof out.text - used, "%s%s", used ? ", " : "",
                              own_part_of((own_region)i)->name);
        used += length > 0 ? (size_t)length : 0;
    }
    return out;
}

static void describe_timecode(char out[EDIT_TEXT], const edit *e, const take *t)
{
    char label[TIMECODE_TEXT];
    timecode_rate rate;
    if (!t || !(t->fps > 0.0) || timecode_rate_of(&rate, t->fps, NULL) < 0) {
        (void)snprintf(out, EDIT_TEXT, "time code from frame %lld", (long long)e->frame);
        return;
    }
    rate.is_drop = e->is_drop && timecode_can_drop(rate);
    timecode_write(label, rate, e->frame);
    (void)snprintf(out, EDIT_TEXT, "time code from %s", label);
}

static void describe_take(char out[EDIT_TEXT], const edit *e, const take *t)
{
    switch (e->kind) {
    case EDIT_TAKE_SLATE:
        (void)snprintf(out, EDIT_TEXT, "slate: scene '%.30s', shot '%.30s', take %u", e->scene,
                       e->shot, e->number);
        break;
    case EDIT_TAKE_RENAME:
        (void)snprintf(out, EDIT_TEXT, "rename the take to '%s'", e->name);
        break;
    case EDIT_TAKE_NOTE:
        (void)snprintf(out, EDIT_TEXT, "note '%.100s'", e->note);
        break;
    case EDIT_TAKE_RATE:
        (void)snprintf(out, EDIT_TEXT, "rate the take %u of 5", e->rating);
        break;
    case EDIT_TAKE_FPS:
        (void)snprintf(out, EDIT_TEXT, "%.6g frames a second", e->fps);
        break;
    case EDIT_TAKE_TIMECODE:
        describe_timecode(out, e, t);
        break;
    default:
        (void)snprintf(out, EDIT_TEXT, "%s the take",
                       e->kind == EDIT_TAKE_DELETE ? "delete" : "restore");
        break;
    }
}

static void describe_marker(char out[EDIT_TEXT], const edit *e, const take *t)
{
    edit_words name;
    (void)snprintf(name.text, sizeof name.text, "marker %u", e->marker);
    if (e->marker < t->marker_count)
        (void)snprintf(name.text, sizeof name.text, "marker '%.40s'", t->marker[e->marker].text);
    switch (e->kind) {
    case EDIT_MARKER_ADD:
        if (e->text[0])
            (void)snprintf(out, EDIT_TEXT, "mark %.30s s '%.95s'", seconds(e->at_ns).text, e->text);
        else
            (void)snprintf(out, EDIT_TEXT, "mark %.30s s", seconds(e->at_ns).text);
        break;
    case EDIT_MARKER_MOVE:
        (void)snprintf(out, EDIT_TEXT, "move %s to %.30s s", name.text, seconds(e->at_ns).text);
        break;
    case EDIT_MARKER_RENAME:
        (void)snprintf(out, EDIT_TEXT, "rename %.60s to '%.80s'", name.text, e->text);
        break;
    default:
        (void)snprintf(out, EDIT_TEXT, "remove %s", name.text);
        break;
    }
}

static const char *colour_name(uint32_t colour)
{
    static const char *const names[TAKE_COLOURS] = {
        [TAKE_COLOUR_NONE] = "none",     [TAKE_COLOUR_RED] = "red",
        [TAKE_COLOUR_ORANGE] = "orange", [TAKE_COLOUR_YELLOW] = "yellow",
        [TAKE_COLOUR_GREEN] = "green",   [TAKE_COLOUR_TEAL] = "teal",
        [TAKE_COLOUR_BLUE] = "blue",     [TAKE_COLOUR_VIOLET] = "violet"};
    return names[colour < TAKE_COLOURS ? colour : TAKE_COLOUR_NONE];
}

static void describe_layer(char out[EDIT_TEXT], const edit *e, const take *t)
{
    edit_words name = layer_name(t, e->layer);
    switch (e->kind) {
    case EDIT_LAYER_ADD:
        (void)snprintf(out, EDIT_TEXT, "add layer '%s' for %.70s", e->name, patterns(e).text);
        break;
    case EDIT_LAYER_RENAME:
        (void)snprintf(out, EDIT_TEXT, "rename %.66s to '%s'", name.text, e->name);
        break;
    case EDIT_LAYER_ORDER:
        (void)snprintf(out, EDIT_TEXT, "move %s to place %u", name.text, e->place);
        break;
    case EDIT_LAYER_MUTE:
        (void)snprintf(out, EDIT_TEXT, "%s %s", e->is_muted ? "mute" : "unmute", name.text);
        break;
    case EDIT_LAYER_SOLO:
        (void)snprintf(out, EDIT_TEXT, "%s %s", e->is_solo ? "solo" : "unsolo", name.text);
        break;
    case EDIT_LAYER_ADDITIVE:
        (void)snprintf(out, EDIT_TEXT, "%s %s", name.text,
                       e->is_additive ? "adds to the layers below" : "replaces the layers below");
        break;
    case EDIT_LAYER_GAIN:
        (void)snprintf(out, EDIT_TEXT, "gain of %s %g", name.text, e->gain);
        break;
    case EDIT_LAYER_COLOUR:
        (void)snprintf(out, EDIT_TEXT, "colour of %s %s", name.text, colour_name(e->colour));
        break;
    case EDIT_LAYER_OFFSET:
        (void)snprintf(out, EDIT_TEXT, "offset of %s %.30s s", name.text,
                       seconds(e->offset_ns).text);
        break;
    case EDIT_LAYER_OWN:
        (void)snprintf(out, EDIT_TEXT, "%.66s owns %.80s", name.text, patterns(e).text);
        break;
    default:
        (void)snprintf(out, EDIT_TEXT, "remove %s", name.text);
        break;
    }
}

static void describe_trim_or_move(char out[EDIT_TEXT], const edit *e, const take *t)
{
    clip_name name = name_clip(t, e->clip);
    int64_t start_ns = e->start_ns == EDIT_UNSAID ? name.start_ns : e->start_ns;
    int64_t end_ns = e->end_ns == EDIT_UNSAID ? name.end_ns : e->end_ns;
    if (e->kind == EDIT_CLIP_TRIM)
        (void)snprintf(out, EDIT_TEXT, "trim %.90s to %.60s", name.words.text,
                       span(start_ns, end_ns).text);
    else if (e->layer == 0)
        (void)snprintf(out, EDIT_TEXT, "move %s to %.30s s", name.words.text,
                       seconds(start_ns).text);
    else
        (void)snprintf(out, EDIT_TEXT, "move %.70s to %.30s s in %.40s", name.words.text,
                       seconds(start_ns).text, layer_name(t, e->layer).text);
}

static void describe_fade(char out[EDIT_TEXT], const edit *e, const take *t)
{
    edit_words in = {""}, until = {""};
    if (e->fade_in_ns != EDIT_UNSAID)
        (void)snprintf(in.text, sizeof in.text, " in %.30s s", seconds(e->fade_in_ns).text);
    if (e->fade_out_ns != EDIT_UNSAID)
        (void)snprintf(until.text, sizeof until.text, " out %.30s s", seconds(e->fade_out_ns).text);
    (void)snprintf(out, EDIT_TEXT, "fade %.70s%.36s%.36s", name_clip(t, e->clip).words.text,
                   in.text, until.text);
}

static void describe_clip(char out[EDIT_TEXT], const edit *e, const take *t)
{
    edit_words name = name_clip(t, e->clip).words;
    switch (e->kind) {
    case EDIT_CLIP_ADD:
        (void)snprintf(out, EDIT_TEXT, "show performance %lld in %s", (long long)e->performance,
                       layer_name(t, e->layer).text);
        break;
    case EDIT_CLIP_TRIM:
    case EDIT_CLIP_MOVE:
        describe_trim_or_move(out, e, t);
        break;
    case EDIT_CLIP_SPLIT:
        (void)snprintf(out, EDIT_TEXT, "split %s at %.30s s", name.text, seconds(e->at_ns).text);
        break;
    case EDIT_CLIP_SPEED:
        (void)snprintf(out, EDIT_TEXT, "play %s at %g times its speed", name.text, e->speed);
        break;
    case EDIT_CLIP_CURVE:
        (void)snprintf(out, EDIT_TEXT, "retime %s with a curve of %u points", name.text,
                       e->warp_count);
        break;
    case EDIT_CLIP_SMOOTH:
        (void)snprintf(out, EDIT_TEXT, "smooth %s over %g s", name.text, e->smooth_s);
        break;
    case EDIT_CLIP_GAIN:
        (void)snprintf(out, EDIT_TEXT, "gain of %s %g", name.text, e->gain);
        break;
    case EDIT_CLIP_FADE:
        describe_fade(out, e, t);
        break;
    case EDIT_CLIP_MUTE:
        (void)snprintf(out, EDIT_TEXT, "%s %s", e->is_muted ? "mute" : "unmute", name.text);
        break;
    case EDIT_CLIP_COLOUR:
        (void)snprintf(out, EDIT_TEXT, "colour of %s %s", name.text, colour_name(e->colour));
        break;
    case EDIT_CLIP_PERFORM:
        (void)snprintf(out, EDIT_TEXT, "replace %s by performance %lld", name.text,
                       (long long)e->performance);
        break;
    default:
        (void)snprintf(out, EDIT_TEXT, "remove %s", name.text);
        break;
    }
    const bool can_ripple = e->kind == EDIT_CLIP_REMOVE || e->kind == EDIT_CLIP_TRIM ||
                            e->kind == EDIT_CLIP_MOVE || e->kind == EDIT_CLIP_SPEED;
    if (can_ripple && e->is_ripple) {
        const size_t used = strlen(out);
        (void)snprintf(out + used, EDIT_TEXT - used, ", with ripple");
    }
}

static void describe_range(char out[EDIT_TEXT], const edit *e, const take *t)
{
    const char *where = e->layer_count == 0   ? ""
                        : e->layer_count == 1 ? " of "
                                              : " of several layers";
    edit_words name = {""};
    if (e->layer_count == 1)
        name = layer_name(t, e->layers[0]);
    edit_words range = {""};
    if (e->kind != EDIT_RANGE_INSERT)
        range = span(e->in_ns, e->out_ns);
    if (e->kind == EDIT_RANGE_KEEP)
        (void)snprintf(out, EDIT_TEXT, "trim the take to %s", range.text);
    else if (e->kind == EDIT_RANGE_CUT)
        (void)snprintf(out, EDIT_TEXT, "cut %.50s%.18s%.66s%s", range.text, where, name.text,
                       e->is_ripple ? "" : ", leaving a gap");
    else
        (void)snprintf(out, EDIT_TEXT, "insert %.30s s at %.30s s%s%.66s",
                       seconds(e->length_ns).text, seconds(e->at_ns).text,
                       e->layer_count ? where : "", name.text);
}

static void describe_punch(char out[EDIT_TEXT], const edit *e, const take *t)
{
    edit_words range = span(e->in_ns, e->out_ns);
    if (e->kind == EDIT_PUNCH)
        (void)snprintf(out, EDIT_TEXT, "punch performance %lld into %.66s at %.60s",
                       (long long)e->performance, layer_name(t, e->layer).text, range.text);
    else
        (void)snprintf(out, EDIT_TEXT, "%.70s from performance %lld at %.60s", regions(e).text,
                       (long long)e->performance, range.text);
}

static void describe_mouth(char out[EDIT_TEXT], const edit *e)
{
    (void)snprintf(out, EDIT_TEXT, "mouth from the voice at %.60s",
                   span(e->start_ns, e->end_ns).text);
}

static void describe_audio(char out[EDIT_TEXT], const edit *e)
{
    if (e->kind == EDIT_AUDIO_ATTACH)
        (void)snprintf(out, EDIT_TEXT, "attach audio %lld", (long long)e->audio);
    else if (e->kind == EDIT_AUDIO_OFFSET)
        (void)snprintf(out, EDIT_TEXT, "audio from %s s", seconds(e->offset_ns).text);
    else if (e->kind == EDIT_AUDIO_TRIM && e->start_ns == EDIT_UNSAID)
        (void)snprintf(out, EDIT_TEXT, "trim the audio to end at %s s", seconds(e->end_ns).text);
    else if (e->kind == EDIT_AUDIO_TRIM && e->end_ns == EDIT_UNSAID)
        (void)snprintf(out, EDIT_TEXT, "trim the audio to begin at %s s",
                       seconds(e->start_ns).text);
    else if (e->kind == EDIT_AUDIO_TRIM)
        (void)snprintf(out, EDIT_TEXT, "trim the audio to %.60s to %.60s s",
                       seconds(e->start_ns).text, seconds(e->end_ns).text);
    else if (e->kind == EDIT_AUDIO_GAIN)
        (void)snprintf(out, EDIT_TEXT, "gain of the audio %g", e->gain);
    else
        (void)snprintf(out, EDIT_TEXT, "detach the audio");
}

static size_t utf8_length(unsigned char first)
{
    return first < 0x80 ? 1 : first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 0;
}

/* Texts may be cut within a UTF-8 character: removes an incomplete character. Replaces newlines by
 * spaces. */
static void mend(char text[EDIT_TEXT])
{
    size_t kept = 0, length = strlen(text);
    for (size_t i = 0; i < length;) {
        size_t size = utf8_length((unsigned char)text[i]), got = 1;
        while (got < size && ((unsigned char)text[i + got] & 0xc0) == 0x80)
            ++got;
        if (got == size)
            memmove(text + kept, text + i, size);
        if (got == size && size == 1 && (unsigned char)text[kept] < ' ')
            text[kept] = ' ';
        kept += got == size ? size : 0;
        i += got;
    }
    text[kept] = '\0';
}

void edit_describe(char out[EDIT_TEXT], const edit *e, const take *before)
{
    if (e->kind <= EDIT_TAKE_RESTORE)
        describe_take(out, e, before);
    else if (e->kind <= EDIT_MARKER_REMOVE)
        describe_marker(out, e, before);
    else if (e->kind <= EDIT_LAYER_OWN)
        describe_layer(out, e, before);
    else if (e->kind <= EDIT_CLIP_PERFORM)
        describe_clip(out, e, before);
    else if (e->kind <= EDIT_RANGE_INSERT)
        describe_range(out, e, before);
    else if (e->kind <= EDIT_COMP)
        describe_punch(out, e, before);
    else if (e->kind == EDIT_MOUTH)
        describe_mouth(out, e);
    else
        describe_audio(out, e);
    mend(out);
}
