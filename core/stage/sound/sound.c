#include "stage/sound/sound.h"
#include "base/clock.h"
#include "stage/sound/sound_feed.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Smaller changes of the transport do not restart the sound. */
static const double motion_ns = 0.5e6;

typedef struct playback { /* player for sounds of one rate and channel count */
    uint32_t rate_hz, channel_count;
    ring *packets;
    sound_follow follow;
    sound_feed *feed;
    struct playback *next; /* next in `retired` */
} playback;

struct sound {
    sound_settings settings;
    sound_backend backend, portaudio;
    sound_board board;
    sound_motion posted; /* [frame] newest motion */
    /* playback */
    sound_device *out;
    playback *playback;   /* [main] current player */
    pthread_mutex_t lock; /* guards `coming` and `retired` between [main] and [opener] */
    playback *coming, *retired;
    playback *playing;     /* [opener], and [device] while it is open; NULL: only clicks */
    uint32_t out_channels; /* same threads: channels of the open device */
    sound_click click;     /* same threads */
    bool wants_beats;
    take_audio audio;
    uint32_t edition, request_number;
    /* recording */
    sound_device *in;
    sound_record *record;
    sound_record_status recorded; /* of the last recording */
    bool is_armed, is_disarming;
};

/* ---- [opener] [device] ---- */

static mrt_result out_opened(void *data, const sound_stream *stream, error *err)
{
    sound *self = data;
    pthread_mutex_lock(&self->lock);
    if (self->coming) {
        if (self->playing) {
            self->playing->next = self->retired;
            self->retired = self->playing;
        }
        self->playing = self->coming;
        self->coming = NULL;
    }
    pthread_mutex_unlock(&self->lock);
    if (stream->rate_hz == 0 || stream->channel_count == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "sound: '%.80s' has no channels: choose another loudspeaker",
                         stream->name);
    self->out_channels = stream->channel_count;
    sound_click_reset(&self->click, stream->rate_hz);
    if (self->playing)
        sound_follow_reset(&self->playing->follow, stream->rate_hz);
    return MRT_OK;
}

static void out_block(void *data, const sound_block *block)
{
    sound *self = data;
    const sound_break is_broken = block->is_broken ? SOUND_BROKEN : SOUND_GOES_ON;
    if (self->playing)
        sound_follow_fill(&self->playing->follow, block->out, block->frame_count,
                          self->out_channels, block->time_ns, is_broken);
    else
        memset(block->out, 0, (size_t)block->frame_count * self->out_channels * sizeof *block->out);
    sound_click_add(&self->click, block->out, block->frame_count, self->out_channels,
                    block->time_ns, is_broken);
}

static mrt_result in_opened(void *data, const sound_stream *stream, error *err)
{
    return sound_record_opened(((sound *)data)->record, stream, err);
}

static void in_block(void *data, const sound_block *block)
{
    sound_record_block(((sound *)data)->record, block);
}

/* ---- players ---- */

static void playback_destroy(playback *of)
{
    if (!of)
        return;
    sound_feed_destroy(of->feed);
    sound_follow_finish(&of->follow);
    ring_destroy(of->packets);
    free(of);
}

static playback *playback_create(sound *self, const show_audio *audio, error *err)
{
    playback *of = calloc(1, sizeof *of);
    if (!of) {
        (void)error_set(err, MRT_ERR_MEMORY, "no memory to play sound");
        return NULL;
    }
    of->rate_hz = audio->rate_hz;
    of->channel_count = audio->channel_count;
    of->packets = ring_create(sound_follow_record_size(audio->channel_count), SOUND_PACKETS);
    mrt_result result = of->packets ? sound_follow_init(&of->follow, of->rate_hz, of->channel_count,
                                                        of->packets, &self->board, err)
                                    : error_set(err, MRT_ERR_MEMORY, "no memory to play sound");
    if (result >= 0)
        result = sound_feed_create(&of->feed, show_path(self->settings.show), of->packets,
                                   &self->board, &of->follow, self->settings.threads, err);
    if (result >= 0)
        return of;
    playback_destroy(of);
    return NULL;
}

static void free_retired(sound *self)
{
    pthread_mutex_lock(&self->lock);
    playback *retired = self->retired;
    self->retired = NULL;
    pthread_mutex_unlock(&self->lock);
    while (retired) {
        playback *next = retired->next;
        playback_destroy(retired);
        retired = next;
    }
}

/* At least two channels, because many loudspeakers cannot be opened with one. */
static void want_out(sound *self, uint32_t rate_hz, uint32_t channel_count)
{
    sound_request request = {.rate_hz = rate_hz,
                             .channel_count = channel_count > 2 ? channel_count : 2,
                             .number = ++self->request_number};
    if (self->settings.out_name)
        snprintf(request.name, sizeof request.name, "%s", self->settings.out_name);
    sound_device_want(self->out, &request);
}

void sound_want_beats(sound *self)
{
    if (!self->playback && !self->wants_beats)
        want_out(self, 0, 2);
    self->wants_beats = true;
}

/* Hands a player to the opener, which uses it when the device is opened for it. */
static void hand_over(sound *self, playback *of)
{
    pthread_mutex_lock(&self->lock);
    playback *never_played = self->coming;
    self->coming = of;
    pthread_mutex_unlock(&self->lock);
    playback_destroy(never_played);
    self->playback = of;
    want_out(self, of->rate_hz, of->channel_count);
}

mrt_result sound_load(sound *self, const take_audio *audio, error *err)
{
    static const take_audio none = {0};
    const take_audio *wanted = audio && audio->audio != 0 ? audio : &none;
    show_audio info;
    if (wanted->audio == self->audio.audio && wanted->offset_ns == self->audio.offset_ns &&
        wanted->in_ns == self->audio.in_ns && wanted->out_ns == self->audio.out_ns &&
        wanted->gain == self->audio.gain)
        return MRT_OK;
    if (wanted->audio != 0) {
        mrt_result result = show_audio_info(self->settings.show, wanted->audio, &info, err);
        if (result < 0)
            return result;
        if (!self->playback || self->playback->rate_hz != info.rate_hz ||
            self->playback->channel_count != info.channel_count) {
            playback *of = playback_create(self, &info, err);
            if (!of)
                return MRT_ERR_MEMORY;
            hand_over(self, of);
        }
    }
    self->audio = *wanted;
    self->edition += 1;
    if (self->playback)
        sound_feed_load(self->playback->feed, wanted, self->edition);
    atomic_store(&self->board.edition, self->edition);
    return MRT_OK;
}

/* ---- the transport ---- */

static bool is_change(const sound_motion *a, const sound_motion *b)
{
    if (a->revision == 0 || a->speed != b->speed || a->loop_from_ns != b->loop_from_ns ||
        a->loop_to_ns != b->loop_to_ns || a->is_mute != b->is_mute || a->beat_ns != b->beat_ns ||
        a->bar != b->bar || a->beats != b->beats)
        return true;
    double passed_ns = (double)(b->host_ns - a->host_ns) * a->speed;
    double at_ns = (double)a->at_ns + passed_ns;
    if (a->loop_to_ns > a->loop_from_ns && a->at_ns < a->loop_to_ns &&
        at_ns >= (double)a->loop_to_ns)
        at_ns = (double)a->loop_from_ns +
                fmod(at_ns - (double)a->loop_to_ns, (double)(a->loop_to_ns - a->loop_from_ns));
    double off_ns = fabs(at_ns - (double)b->at_ns);
    /* Positions just before and just after the end of a loop are close to each other. */
    double lap_ns = (double)(a->loop_to_ns - a->loop_from_ns);
    return off_ns > motion_ns && !(lap_ns > 0.0 && fabs(off_ns - lap_ns) <= motion_ns);
}

void sound_move(sound *self, const sound_motion *motion)
{
    if (!is_change(&self->posted, motion))
        return;
    uint32_t revision = self->posted.revision + 1;
    self->posted = *motion;
    self->posted.revision = revision ? revision : 1;
    sound_board_post(&self->board, &self->posted);
}

sound_motion sound_motion_of(const transport *t, int64_t clock_ns)
{
    transport_position at = transport_at(t, clock_ns);
    sound_motion out = {.host_ns = clock_ns > t->clock_ns ? clock_ns : t->clock_ns,
                        .at_ns = at.at_ns,
                        .speed = t->is_playing && !at.has_stopped ? t->speed : 0.0};
    if (t->is_looping) {
        out.loop_from_ns = t->loop_in_ns;
        out.loop_to_ns = t->loop_out_ns;
    }
    return out;
}

int64_t sound_lead_ns(sound *self)
{
    /* the latency of the device, and two rounds of the feeder */
    return sound_device_read_status(self->out)->stream.latency_ns + 50 * NS_PER_MS;
}

/* ---- status ---- */

static void explain_silence(sound *self, sound_play_status *out)
{
    sound_motion motion = {0};
    error trouble = {""};
    if (!out->is_loaded && !self->wants_beats)
        return;
    (void)sound_board_read(&self->board, &motion);
    if (self->playback)
        sound_feed_trouble(self->playback->feed, &trouble);
    if (trouble.text[0])
        snprintf(out->text, sizeof out->text, "%.255s", trouble.text);
    else if (out->device.state == SOUND_DEVICE_AWAY)
        snprintf(out->text, sizeof out->text, "%.255s", out->device.text);
    else if (out->is_loaded && motion.speed != 0.0 && motion.speed != 1.0)
        snprintf(out->text, sizeof out->text, "sound is muted at %gx: it plays only at 1x",
                 motion.speed);
    else if (self->playback && self->playback->channel_count > 2 &&
             out->device.state == SOUND_DEVICE_RUNNING &&
             out->device.stream.channel_count < self->playback->channel_count)
        snprintf(out->text, sizeof out->text,
                 "only the first %u of %u channels are played: the loudspeaker has no more",
                 out->device.stream.channel_count, self->playback->channel_count);
}

void sound_play_read_status(sound *self, sound_play_status *out)
{
    *out = (sound_play_status){.device = *sound_device_read_status(self->out),
                               .is_loaded = self->audio.audio != 0,
                               .click_count = atomic_load(&self->click.count)};
    if (self->playback) {
        sound_count *count = &self->playback->follow.count;
        out->is_heard = out->device.state == SOUND_DEVICE_RUNNING && atomic_load(&count->is_heard);
        out->drift_ppm = (double)atomic_load(&count->drift_ppb) / 1000.0;
        out->spliced_count = atomic_load(&count->spliced);
        out->jumped_count = atomic_load(&count->jumped);
        out->starved_count = atomic_load(&count->starved);
        out->broken_count = atomic_load(&count->broken);
    }
    explain_silence(self, out);
}

void sound_in_read_status(sound *self, sound_in_status *out)
{
    *out = (sound_in_status){.record = self->recorded};
    if (self->in)
        out->device = *sound_device_read_status(self->in);
    if (self->record)
        sound_record_read_status(self->record, &out->record);
}

/* ---- recording ---- */

mrt_result sound_arm(sound *self, writer *w, uint32_t channel_count, error *err)
{
    if (self->is_armed)
        return error_set(err, MRT_ERR_ARGUMENT, "sound: the microphone is already armed");
    if (channel_count > 2)
        return error_set(err, MRT_ERR_ARGUMENT, "sound: %u channels: only 1 or 2 can be recorded",
                         channel_count);
    const sound_user user = {.data = self, .opened = in_opened, .block = in_block};
    sound_request request = {.channel_count = channel_count ? channel_count : 1};
    if (self->settings.in_name)
        snprintf(request.name, sizeof request.name, "%s", self->settings.in_name);
    mrt_result result =
        sound_record_create(&self->record, self->settings.show, w, self->settings.threads, err);
    if (result >= 0)
        result = sound_device_create(&self->in, SOUND_IN, &self->backend, &user, self->settings.log,
                                     self->settings.threads, err);
    if (result < 0) {
        sound_record_destroy(self->record);
        self->record = NULL;
        return result;
    }
    self->is_armed = true;
    self->is_disarming = false;
    self->recorded = (sound_record_status){0};
    sound_device_want(self->in, &request);
    return MRT_OK;
}

void sound_disarm(sound *self)
{
    if (!self->is_armed)
        return;
    self->is_disarming = true;
    sound_device_leave(self->in);
}

bool sound_is_armed(const sound *self)
{
    return self->is_armed;
}

/* Returns true if the backend is still used by a device that does not answer. */
static bool end_recording(sound *self)
{
    bool is_left_behind = !sound_device_destroy(self->in);
    self->in = NULL;
    if (self->record) {
        sound_record_end(self->record);
        sound_record_read_status(self->record, &self->recorded);
    }
    sound_record_destroy(self->record);
    self->record = NULL;
    self->is_armed = self->is_disarming = false;
    return is_left_behind;
}

/* ---- create and destroy ---- */

void sound_update(sound *self)
{
    free_retired(self);
    if (self->record)
        sound_record_update(self->record);
    if (self->is_disarming && sound_device_has_left(self->in) && end_recording(self))
        self->portaudio.self = NULL;
}

void sound_work(sound *self, int64_t now_ns)
{
    (void)sound_device_work(self->out, now_ns);
    if (self->in)
        (void)sound_device_work(self->in, now_ns);
    if (self->playback)
        sound_feed_work(self->playback->feed);
    if (self->record)
        sound_record_work(self->record);
}

mrt_result sound_create(sound **out, const sound_settings *settings, error *err)
{
    *out = NULL;
    sound *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
    pthread_mutex_init(&self->lock, NULL);
    self->click.board = &self->board;
    self->settings = *settings;
    mrt_result result = MRT_OK;
    if (!settings->backend)
        result = sound_portaudio_create(&self->portaudio, err);
    self->backend = settings->backend ? *settings->backend : self->portaudio;
    const sound_user user = {.data = self, .opened = out_opened, .block = out_block};
    if (result >= 0)
        result = sound_device_create(&self->out, SOUND_OUT, &self->backend, &user, settings->log,
                                     settings->threads, err);
    if (result < 0) {
        sound_portaudio_destroy(&self->portaudio);
        pthread_mutex_destroy(&self->lock);
        free(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void sound_destroy(sound *self)
{
    if (!self)
        return;
    bool is_left_behind = !sound_device_destroy(self->out);
    is_left_behind |= end_recording(self);
    if (self->coming != self->playing)
        playback_destroy(self->coming);
    playback_destroy(self->playing);
    free_retired(self);
    if (!is_left_behind)
        sound_portaudio_destroy(&self->portaudio);
    pthread_mutex_destroy(&self->lock);
    free(self);
}
