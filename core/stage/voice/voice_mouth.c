#include "stage/voice/voice_mouth.h"
#include "stage/mapping/null_mapping.h"
#include "stage/perform/palette.h"
#include "stage/voice/mouth.h"
#include "show/sound_render.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RATE_HZ = 60, CHANNEL_FADE = 0, CHANNEL_JAW, CHANNEL_LIPS, CHANNEL_POSES };
enum { CHANNELS = CHANNEL_POSES + MOUTH_VISEMES };

/* ---- the face ---- */

static bool has_pose(const mrt_rig_pose *poses, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(poses[i].name, name) == 0)
            return true;
    return false;
}

mrt_result voice_mouth_check_face(const mrt_rig_pose *poses, uint32_t count, error *err)
{
    static const mouth_viseme needed[] = {MOUTH_PP, MOUTH_AA};
    for (size_t i = 0; i < sizeof needed / sizeof *needed; ++i)
        if (!has_pose(poses, count, mouth_pose_name[needed[i]]))
            return error_set(
                err, MRT_ERR_ARGUMENT,
                "the face has no pose \"%s\", so it cannot speak. Add it to the rig, or "
                "draft one with marotte rig new",
                mouth_pose_name[needed[i]]);
    return MRT_OK;
}

/* ---- the voice ---- */

typedef struct voice {
    sound_render *render;
    int64_t first; /* frame of the timeline at which it begins */
    uint32_t channel_count;
    float *block; /* interleaved; owned */
    size_t block_frames;
} voice;

/* A damaged piece of the sound is silent. */
static mrt_result read_voice(void *data, int64_t first, float *out, size_t count, error *err)
{
    voice *self = data;
    if (count > self->block_frames) {
        float *larger = realloc(self->block, count * self->channel_count * sizeof *larger);
        if (!larger)
            return error_set(err, MRT_ERR_MEMORY, "no memory for the voice");
        self->block = larger;
        self->block_frames = count;
    }
    error ignored;
    (void)!sound_render_frames(self->render, self->first + first, self->block, count, &ignored);
    for (size_t i = 0; i < count; ++i) {
        float sum = 0.0f;
        for (uint32_t c = 0; c < self->channel_count; ++c)
            sum += self->block[i * self->channel_count + c];
        out[i] = sum / (float)self->channel_count;
    }
    return MRT_OK;
}

/* The span of the timeline in which the sound plays. */
static mrt_result span_of(const take *t, const show_audio *audio, int64_t *out_from_ns,
                          int64_t *out_to_ns, error *err)
{
    const take_audio *a = &t->audio;
    const int64_t length_ns = (int64_t)(1e9 * (double)audio->frame_count / (double)audio->rate_hz);
    const int64_t end_ns = a->out_ns > 0 && a->out_ns < length_ns ? a->out_ns : length_ns;
    const int64_t from_ns = a->offset_ns + a->in_ns, to_ns = a->offset_ns + end_ns;
    *out_from_ns = from_ns > 0 ? from_ns : 0;
    *out_to_ns = to_ns < t->duration_ns ? to_ns : t->duration_ns;
    return *out_to_ns > *out_from_ns
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT,
                           "the sound lies outside of the take. Move it on the timeline first");
}

/* ---- the samples ---- */

typedef struct samples {
    const mouth *of;
    double start_s; /* on the timeline of the sounds */
    double jaw, lips;
    int64_t index, count;
    bool is_new; /* the last sample differs from the one before */
    mrt_sample last;
} samples;

/* A strength of a palette without a fade is reached with the next sample, so each sample has the
 * strengths of the next one. Samples that change nothing are left out. */
static bool next_sample(void *data, mrt_sample *out)
{
    samples *self = data;
    for (; self->index < self->count; ++self->index) {
        const bool is_end = self->index == 0 || self->index + 1 == self->count;
        mrt_sample now = {.count = CHANNELS, .sequence = (uint32_t)self->index};
        now.time_ns = self->index * NS_PER_S / RATE_HZ;
        const mouth_shape shape = mouth_at(
            self->of, self->start_s + (double)(self->index + 1) / RATE_HZ, self->jaw, self->lips);
        now.value[CHANNEL_JAW] = (float)shape.jaw;
        now.value[CHANNEL_LIPS] = (float)shape.lips;
        for (int v = 0; v < MOUTH_VISEMES; ++v)
            now.value[CHANNEL_POSES + v] = (float)shape.amount[v];
        const bool is_new = memcmp(now.value, self->last.value, sizeof now.value) != 0;
        const bool is_kept = is_end || is_new || self->is_new;
        self->is_new = is_new;
        self->last = now;
        if (!is_kept)
            continue;
        self->index += 1;
        *out = now;
        return true;
    }
    return false;
}

static void describe_channels(take_track *out)
{
    out->channel_count = CHANNELS;
    for (uint32_t c = 0; c < CHANNELS; ++c) {
        take_channel *channel = &out->channel[c];
        *channel = (take_channel){.semantic = PALETTE_SEMANTIC, .hand = MRT_NO_HAND, .max = 1.0f};
        if (c >= CHANNEL_POSES)
            (void)snprintf(channel->name, sizeof channel->name, "%s",
                           mouth_pose_name[c - CHANNEL_POSES]);
    }
    (void)snprintf(out->channel[CHANNEL_FADE].name, sizeof out->channel->name, "fade");
    (void)snprintf(out->channel[CHANNEL_FADE].unit, sizeof out->channel->unit, "s");
    (void)snprintf(out->channel[CHANNEL_JAW].name, sizeof out->channel->name, "jaw");
    (void)snprintf(out->channel[CHANNEL_LIPS].name, sizeof out->channel->name, "lips");
    out->channel[CHANNEL_FADE].max = (float)PALETTE_FADE_MOST_S;
    out->channel[CHANNEL_JAW].semantic = PALETTE_JAW;
    out->channel[CHANNEL_LIPS].semantic = PALETTE_LIPS;
    out->channel[CHANNEL_JAW].max = out->channel[CHANNEL_LIPS].max = (float)PALETTE_SHARE_MOST;
}

static mrt_result store(show *s, const voice_mouth_settings *of, const take_performance *like,
                        samples *from, int64_t *out_performance, int64_t length_ns, error *err)
{
    char input[] = "palette:voice", device[] = "mouth from a voice", plugin[] = PALETTE_ID " 1.0 -";
    char mapping[TAKE_IDENTITY];
    (void)snprintf(mapping, sizeof mapping, "%s %s -", null_mapping_type.id,
                   null_mapping_type.version);
    take_track *track = calloc(1, sizeof *track);
    take_performance *performance = calloc(1, sizeof *performance);
    mrt_result result = MRT_OK;
    if (!track || !performance)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the mouth");
    if (result >= 0) {
        *track = (take_track){.input = input, .device = device, .plugin = plugin};
        describe_channels(track);
        *performance = (take_performance){.mapping = mapping,
                                          .rig = like->rig,
                                          .rig_json = like->rig_json,
                                          .unit_mm = like->unit_mm,
                                          .hand_length_mm = like->hand_length_mm};
        memcpy(performance->rig_hash, like->rig_hash, sizeof performance->rig_hash);
        memcpy(performance->mesh_hash, like->mesh_hash, sizeof performance->mesh_hash);
        const show_computed made = {.take = of->take->id,
                                    .program = "marotte " MAROTTE_VERSION,
                                    .track = track,
                                    .performance = performance,
                                    .length_ns = length_ns,
                                    .next = next_sample,
                                    .data = from};
        result = show_computed_create(s, &made, err);
        *out_performance = performance->id;
    }
    free(track);
    free(performance);
    return result;
}

/* ---- the layer ---- */

/* Returns the id of the layer of an earlier run; 0: none. */
static uint32_t layer_of_before(const take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        const take_layer *layer = &t->layer[i];
        bool is_mouth = strcmp(layer->name, VOICE_MOUTH_LAYER) == 0;
        for (uint32_t k = 0; k < layer->clip_count; ++k)
            is_mouth &= layer->clip[k].part == TAKE_PALETTE;
        if (is_mouth)
            return layer->id;
    }
    return 0;
}

static int64_t first_performance(const take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].clip_count > 0)
            return t->layer[i].clip[0].performance;
    return 0;
}

static mrt_result find_sounds(phone_list *out, voice_mouth_report *report, show *s,
                              const voice_mouth_settings *of, int64_t *out_from_ns,
                              int64_t *out_to_ns, error *err)
{
    voice self = {.channel_count = 1};
    take_audio whole = of->take->audio;
    whole.gain = 1.0; /* a sound that is turned down is still a voice */
    mrt_result result = sound_render_create(&self.render, s, &whole, PHONES_RATE_HZ, err);
    if (result < 0)
        return result;
    const show_audio *audio = sound_render_audio(self.render);
    self.channel_count = audio->channel_count;
    result = span_of(of->take, audio, out_from_ns, out_to_ns, err);
    if (result >= 0) {
        const double length_s = 1e-9 * (double)(*out_to_ns - *out_from_ns);
        self.first = sound_render_frame(PHONES_RATE_HZ, *out_from_ns);
        report->length_s = length_s;
        const phones_source source = {
            .frame_count = (int64_t)(length_s * PHONES_RATE_HZ), .read = read_voice, .data = &self};
        result = phones_find(out, &report->phones, &source, &of->phones, err);
    }
    sound_render_destroy(self.render);
    free(self.block);
    return result;
}

static mrt_result lay(edit *out, voice_mouth_report *report, const phone_list *sounds, show *s,
                      const voice_mouth_settings *of, int64_t from_ns, int64_t to_ns, error *err)
{
    mouth shaped = {0};
    show_performance then = {{0}, 0, 0};
    int64_t performance = 0;
    mrt_result result = MRT_OK;
    if (!of->like)
        result = show_performance_read(s, first_performance(of->take), &then, err);
    if (result >= 0)
        result = mouth_create(&shaped, sounds, err);
    const int64_t length_ns = to_ns - from_ns;
    samples from = {.of = &shaped, .jaw = of->jaw, .lips = of->lips};
    from.count = length_ns * RATE_HZ / NS_PER_S + 1;
    if (result >= 0)
        result = store(s, of, of->like ? of->like : &then.performance, &from, &performance,
                       length_ns, err);
    mouth_finish(&shaped);
    show_performance_finish(&then);
    if (result < 0)
        return result;
    edit_init(out, EDIT_MOUTH);
    (void)snprintf(out->name, sizeof out->name, VOICE_MOUTH_LAYER);
    out->layer = layer_of_before(of->take);
    out->performance = performance;
    out->from_ns = SHOW_COMPUTED_NS;
    out->to_ns = SHOW_COMPUTED_NS + length_ns;
    out->start_ns = from_ns;
    out->end_ns = to_ns;
    report->is_again = out->layer != 0;
    return MRT_OK;
}

mrt_result voice_mouth_make(edit *out, voice_mouth_report *report, phone_list *sounds, show *s,
                            const voice_mouth_settings *settings, error *err)
{
    phone_list found = {0};
    int64_t from_ns = 0, to_ns = 0;
    *report = (voice_mouth_report){.length_s = 0.0};
    if (sounds)
        *sounds = (phone_list){0};
    if (!settings->take->audio.audio)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld has no sound. Attach a voice first (marotte take audio attach)",
                         (long long)settings->take->id);
    if (!settings->like && first_performance(settings->take) == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld is empty: it has no face that could speak",
                         (long long)settings->take->id);
    mrt_result result = find_sounds(&found, report, s, settings, &from_ns, &to_ns, err);
    if (result == MRT_OK)
        result = lay(out, report, &found, s, settings, from_ns, to_ns, err);
    if (result == MRT_OK && sounds)
        *sounds = found;
    else
        phone_list_finish(&found);
    return result;
}

void voice_mouth_describe(char *out, size_t capacity, const voice_mouth_report *report)
{
    const phones_report *p = &report->phones;
    char words[256] = "";
    if (p->unknown_count == 1)
        (void)snprintf(words, sizeof words, "; 1 word is not in the dictionary: %s", p->unknown);
    else if (p->unknown_count > 1)
        (void)snprintf(words, sizeof words, "; %u words are not in the dictionary: %s",
                       p->unknown_count, p->unknown);
    (void)snprintf(out, capacity, "%u sounds in %.1f s%s%s%s", p->sound_count, report->length_s,
                   words, p->note[0] ? ". " : "", p->note);
}
