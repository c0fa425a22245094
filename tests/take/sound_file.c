/* Sound from files into a show, and the sound of a take into a WAV. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "show_scene.h"
#include "take/sound_file.h"
#include "take/sound_pcm.h"

#include <fcntl.h>
#include <math.h>
#include <sndfile.h>
#include <stdbool.h>

/* libsndfile 1.2 lets go of an Ogg with damaged headers but for this, some 6 kB. */
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:vorbis_info_init";
}

typedef struct desk {
    scene scene;
    show *show;
    char file[SCENE_PATH];
} desk;

static int desk_make(void **state)
{
    error err = {""};
    desk *d = calloc(1, sizeof *d);
    assert_non_null(d);
    scene_make(&d->scene);
    scene_must(show_create(&d->show, d->scene.path, &err), &err);
    snprintf(d->file, sizeof d->file, "%s/voice.wav", d->scene.folder);
    *state = d;
    return 0;
}

static int desk_clear(void **state)
{
    desk *d = *state;
    show_close(d->show);
    scene_remove(&d->scene);
    free(d);
    return 0;
}

/* Sample c of frame n, exact in `bits`. */
static double sample(int64_t n, int c, int bits)
{
    int64_t range = (int64_t)1 << (bits - 1);
    int64_t value = (int64_t)(scene_random((uint64_t)(n * 8 + c)) % (uint64_t)(2 * range)) - range;
    return (double)value / (double)range;
}

static void write_sound(const desk *d, int format, int rate_hz, int channels, int64_t frames,
                        int bits)
{
    SF_INFO info = {.samplerate = rate_hz, .channels = channels, .format = format};
    SNDFILE *file = sf_open(d->file, SFM_WRITE, &info);
    int sub = format & SF_FORMAT_SUBMASK;
    bool is_float = sub == SF_FORMAT_FLOAT || sub == SF_FORMAT_DOUBLE || sub == SF_FORMAT_VORBIS;
    double block[16 * 256];
    int integers[16 * 256];
    if (!file)
        fail_msg("%s", sf_strerror(NULL));
    for (int64_t at = 0; at < frames; at += 256) {
        int64_t count = frames - at < 256 ? frames - at : 256;
        for (int64_t i = 0; i < count; ++i)
            for (int c = 0; c < channels; ++c)
                integers[i * channels + c] =
                    (int)(2147483648.0 * (block[i * channels + c] = sample(at + i, c, bits)));
        /* libsndfile makes integers of doubles with another scale than doubles of integers. */
        assert_int_equal(is_float ? sf_writef_double(file, block, count)
                                  : sf_writef_int(file, integers, count),
                         count);
    }
    assert_int_equal(sf_close(file), 0);
}

static int64_t import(const desk *d)
{
    error err = {""};
    int64_t id = 0;
    scene_must(sound_file_import(&id, d->show, d->file, SOUND_FILE_CUT_REFUSE, NULL, &err), &err);
    assert_true(id > 0);
    return id;
}

/* The show has no sound but `count` ones. */
static void expect_sounds(const desk *d, size_t count)
{
    error err = {""};
    int64_t *ids;
    size_t got;
    scene_must(show_audio_ids(d->show, &ids, &got, &err), &err);
    assert_int_equal(got, count);
    free(ids);
}

static void expect_samples(const desk *d, int64_t id, int channels, int64_t frames, int bits)
{
    error err = {""};
    show_audio info;
    unsigned char bytes[4096];
    float samples[4096];
    scene_must(show_audio_info(d->show, id, &info, &err), &err);
    sound_pcm format = sound_pcm_of(info.format);
    for (int64_t at = 0; at < frames;) {
        size_t size;
        scene_must(show_audio_read(d->show, id, at, bytes, sizeof bytes, &size, &err), &err);
        size_t count = size / sound_pcm_bytes(format) / (size_t)channels;
        assert_true(count > 0);
        sound_pcm_unpack(samples, bytes, count * (size_t)channels, format);
        for (size_t i = 0; i < count; ++i)
            for (int c = 0; c < channels; ++c)
                if ((double)samples[i * (size_t)channels + (size_t)c] !=
                    sample(at + (int64_t)i, c, bits))
                    fail_msg("frame %lld differs", (long long)(at + (int64_t)i));
        at += (int64_t)count;
    }
}

static void sounds_are_kept_as_they_are_in_the_narrowest_format(void **state)
{
    static const struct kind {
        int format, rate_hz, channels, bits;
        const char *kept;
    } kinds[] = {
        {SF_FORMAT_WAV | SF_FORMAT_PCM_16, 44100, 2, 16, "s16"},
        {SF_FORMAT_WAV | SF_FORMAT_PCM_24, 48000, 1, 24, "s24"},
        {SF_FORMAT_WAV | SF_FORMAT_PCM_24, 48000, 1, 16, "s16"},
        {SF_FORMAT_WAV | SF_FORMAT_PCM_U8, 22050, 1, 8, "s16"},
        {SF_FORMAT_WAV | SF_FORMAT_FLOAT, 96000, 6, 24, "s24"},
        {SF_FORMAT_WAV | SF_FORMAT_DOUBLE, 8000, 1, 16, "s16"},
        {SF_FORMAT_AIFF | SF_FORMAT_PCM_16, 44100, 2, 16, "s16"},
        {SF_FORMAT_FLAC | SF_FORMAT_PCM_24, 48000, 2, 24, "s24"},
        {SF_FORMAT_RF64 | SF_FORMAT_PCM_16, 48000, 2, 16, "s16"},
    };
    desk *d = *state;
    error err = {""};
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; ++k) {
        show_audio info;
        write_sound(d, kinds[k].format, kinds[k].rate_hz, kinds[k].channels, 40001, kinds[k].bits);
        int64_t id = import(d);
        scene_must(show_audio_info(d->show, id, &info, &err), &err);
        assert_string_equal(info.format, kinds[k].kept);
        assert_string_equal(info.name, "voice.wav");
        assert_int_equal(info.rate_hz, kinds[k].rate_hz);
        assert_int_equal(info.channel_count, kinds[k].channels);
        assert_int_equal(info.frame_count, 40001);
        assert_int_equal(info.start_ns, 0);
        expect_samples(d, id, kinds[k].channels, 40001, kinds[k].bits);
    }
}

static void floats_that_are_no_integers_stay_floats(void **state)
{
    desk *d = *state;
    error err = {""};
    show_audio info;
    float samples[3] = {0.1f, -3.5f, 1e-30f}, got[3];
    size_t size;
    SF_INFO as = {.samplerate = 48000, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_FLOAT};
    SNDFILE *file = sf_open(d->file, SFM_WRITE, &as);
    assert_non_null(file);
    assert_int_equal(sf_writef_float(file, samples, 3), 3);
    sf_close(file);
    int64_t id = import(d);
    scene_must(show_audio_info(d->show, id, &info, &err), &err);
    assert_string_equal(info.format, "f32");
    scene_must(show_audio_read(d->show, id, 0, got, sizeof got, &size, &err), &err);
    assert_memory_equal(got, samples, sizeof got);
}

static void ogg_is_read(void **state)
{
    desk *d = *state;
    error err = {""};
    show_audio info;
    write_sound(d, SF_FORMAT_OGG | SF_FORMAT_VORBIS, 44100, 1, 44100, 8);
    scene_must(show_audio_info(d->show, import(d), &info, &err), &err);
    assert_string_equal(info.format, "f32");
    assert_int_equal(info.frame_count, 44100);
}

static void refuses(const desk *d, const char *words)
{
    error err = {""};
    int64_t id = 77;
    assert_true(sound_file_import(&id, d->show, d->file, SOUND_FILE_CUT_REFUSE, NULL, &err) < 0);
    assert_int_equal(id, 0);
    if (!strstr(err.text, d->file) || !strstr(err.text, words) || strchr(err.text, '\n'))
        fail_msg("'%s' instead of '%s'", err.text, words);
    expect_sounds(d, 0);
}

static void put_bytes(const desk *d, const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    (void)d;
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static void what_is_no_sound_is_refused_with_a_reason(void **state)
{
    desk *d = *state;
    refuses(d, "No such file");
    put_bytes(d, d->file, "", 0);
    refuses(d, "is empty");
    put_bytes(d, d->file, "these are words and no sound at all, whatever it is called", 58);
    refuses(d, "not a sound");
    assert_int_equal(unlink(d->file), 0);
    assert_int_equal(mkfifo(d->file, 0600), 0);
    refuses(d, "is not a file");
    assert_int_equal(unlink(d->file), 0);
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 0, 16);
    refuses(d, "no frames");
}

/* 8 bytes of the header: rate, and the rest as they are. */
static void patch(const desk *d, long at, const void *bytes, size_t size)
{
    FILE *file = fopen(d->file, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static void absurd_headers_are_refused(void **state)
{
    desk *d = *state;
    uint32_t slow = 10, fast = 900000000;
    uint16_t none = 0;
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 1000, 16);
    patch(d, 24, &slow, 4);
    refuses(d, "10 Hz");
    patch(d, 24, &fast, 4);
    refuses(d, "Hz");
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 1000, 16);
    patch(d, 22, &none, 2);
    refuses(d, "");
}

static void a_sound_of_more_than_a_day_is_refused(void **state)
{
    desk *d = *state;
    /* 1000 Hz, 8 bits: 86 400 001 frames of a sparse file. */
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_U8, 1000, 1, 1000, 8);
    uint32_t size = 86400001, whole = size + 36;
    patch(d, 40, &size, 4);
    patch(d, 4, &whole, 4);
    assert_int_equal(truncate(d->file, (off_t)whole + 8), 0);
    refuses(d, "at most 24 h");
}

static void a_cut_file_is_refused_unless_it_is_asked_to_be_kept(void **state)
{
    static const struct kind {
        int format;
        const char *words;
    } kinds[] = {{SF_FORMAT_WAV | SF_FORMAT_PCM_16, "of the 480044 bytes"},
                 {SF_FORMAT_AIFF | SF_FORMAT_PCM_16, "was cut"},
                 {SF_FORMAT_FLAC | SF_FORMAT_PCM_16, "of the 5.000 s"},
                 {SF_FORMAT_OGG | SF_FORMAT_VORBIS, "has no end"}};
    desk *d = *state;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; ++k) {
        error err = {""};
        struct stat status;
        int64_t id;
        write_sound(d, kinds[k].format, 48000, 1, 240000, 16);
        assert_int_equal(stat(d->file, &status), 0);
        assert_int_equal(truncate(d->file, status.st_size / 2 + 1), 0);
        refuses(d, kinds[k].words);
        scene_must(sound_file_import(&id, d->show, d->file, SOUND_FILE_CUT_KEEP, NULL, &err), &err);
        show_audio info;
        scene_must(show_audio_info(d->show, id, &info, &err), &err);
        assert_true(info.frame_count > 1000);
        assert_true(info.frame_count < 240000);
        desk_clear(state);
        desk_make(state);
        d = *state;
    }
}

static void samples_that_no_format_keeps_are_refused(void **state)
{
    desk *d = *state;
    double fine[2] = {0.5, 1.0 / 3.0};
    float no_number[2] = {0.5f, NAN};
    SF_INFO as = {.samplerate = 48000, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_DOUBLE};
    SNDFILE *file = sf_open(d->file, SFM_WRITE, &as);
    assert_int_equal(sf_writef_double(file, fine, 2), 2);
    sf_close(file);
    refuses(d, "frame 1 has more than 24 bits");
    as.format = SF_FORMAT_WAV | SF_FORMAT_FLOAT;
    file = sf_open(d->file, SFM_WRITE, &as);
    assert_int_equal(sf_writef_float(file, no_number, 2), 2);
    sf_close(file);
    refuses(d, "frame 1 is not a number");
}

static bool until_third(void *data, double part)
{
    int *left = data;
    assert_true(part >= 0.0 && part <= 1.0);
    return --*left > 0;
}

static void giving_up_leaves_nothing_behind(void **state)
{
    desk *d = *state;
    error err = {""};
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 2, 200000, 16);
    for (int when = 1; when < 14; when += 3) {
        int left = when;
        int64_t id = 5;
        sound_file_watch watch = {until_third, &left};
        assert_int_equal(
            sound_file_import(&id, d->show, d->file, SOUND_FILE_CUT_REFUSE, &watch, &err), MRT_END);
        assert_int_equal(id, 0);
        expect_sounds(d, 0);
    }
}

/* Bytes of a sound, some of them wrong: whatever comes of it, nothing crashes or hangs. */
static void damaged_files_do_no_harm(void **state)
{
    static const int formats[] = {
        SF_FORMAT_WAV | SF_FORMAT_PCM_16, SF_FORMAT_FLAC | SF_FORMAT_PCM_16,
        SF_FORMAT_OGG | SF_FORMAT_VORBIS, SF_FORMAT_AIFF | SF_FORMAT_PCM_24};
    desk *d = *state;
    int taken = 0, refused = 0;
    for (uint64_t i = 0; i < 120; ++i) {
        error err = {""};
        int64_t id;
        struct stat status;
        write_sound(d, formats[i % 4], 48000, 2, 3000, 16);
        assert_int_equal(stat(d->file, &status), 0);
        for (uint64_t k = 0; k < 4; ++k) {
            uint64_t random = scene_random(i * 4 + k);
            unsigned char byte = (unsigned char)(random >> 40);
            long reach = k < 3 && status.st_size > 100 ? 100 : (long)status.st_size;
            patch(d, (long)(random % (uint64_t)reach), &byte, 1);
        }
        mrt_result result =
            sound_file_import(&id, d->show, d->file, SOUND_FILE_CUT_REFUSE, NULL, &err);
        taken += result == MRT_OK;
        refused += result < 0;
        assert_true(result == MRT_OK || (result < 0 && err.text[0]));
    }
    assert_true(taken > 0);
    assert_true(refused > 0);
}

/* ---- out ---- */

static take take_of(int64_t audio, int64_t offset_ns, double gain)
{
    take t = {.id = 3,
              .start_ns = scene_utc_ns,
              .duration_ns = 10 * NS_PER_S,
              .number = 4,
              .scene = "12",
              .shot = "b",
              .audio = {.audio = audio, .offset_ns = offset_ns, .gain = gain}};
    return t;
}

static void out_path(const desk *d, char *out, size_t capacity)
{
    snprintf(out, capacity, "%s/out.wav", d->scene.folder);
}

static sound_file_report export(const desk *d, const take *t, int64_t from_ns, int64_t to_ns,
                                uint32_t rate_hz)
{
    error err = {""};
    char path[SCENE_PATH];
    sound_file_report report;
    sound_file_export what = {.take = t, .from_ns = from_ns, .to_ns = to_ns, .rate_hz = rate_hz};
    out_path(d, path, sizeof path);
    scene_must(sound_file_write(&report, d->show, &what, path, NULL, &err), &err);
    return report;
}

static size_t read_out(const desk *d, double *out, size_t frames_max, SF_INFO *info)
{
    char path[SCENE_PATH];
    out_path(d, path, sizeof path);
    *info = (SF_INFO){0};
    SNDFILE *file = sf_open(path, SFM_READ, info);
    assert_non_null(file);
    sf_count_t got = sf_readf_double(file, out, (sf_count_t)frames_max);
    sf_close(file);
    return (size_t)got;
}

static void a_range_goes_out_as_it_came_in_with_silence_around(void **state)
{
    static double got[2 * 48000];
    static const int kinds[][2] = {{SF_FORMAT_PCM_16, 16}, {SF_FORMAT_PCM_24, 24}};
    desk *d = *state;
    for (int k = 0; k < 2; ++k) {
        SF_INFO info;
        write_sound(d, SF_FORMAT_WAV | kinds[k][0], 48000, 2, 30000, kinds[k][1]);
        /* It starts at 0.25 s of the timeline: frame 12000. Out: 0.1 to 1.1 s. */
        take t = take_of(import(d), NS_PER_S / 4, 1.0);
        sound_file_report report = export(d, &t, NS_PER_S / 10, 11 * NS_PER_S / 10, 0);
        assert_string_equal(report.format, k == 0 ? "s16" : "s24");
        assert_int_equal(report.splice_count + (uint64_t)report.cut_count, 0);
        assert_int_equal(read_out(d, got, 48000, &info), 48000);
        assert_int_equal(info.format & SF_FORMAT_SUBMASK, kinds[k][0]);
        assert_int_equal(info.samplerate, 48000);
        for (int64_t i = 0; i < 48000; ++i) {
            int64_t n = i + 4800 - 12000;
            for (int c = 0; c < 2; ++c)
                if (got[2 * i + c] != (n < 0 || n >= 30000 ? 0.0 : sample(n, c, kinds[k][1])))
                    fail_msg("frame %lld differs", (long long)i);
        }
    }
}

static void gain_is_applied_and_what_is_too_loud_is_counted(void **state)
{
    static double got[1000];
    desk *d = *state;
    SF_INFO info;
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 1000, 16);
    take t = take_of(import(d), 0, 0.5);
    sound_file_report report = export(d, &t, 0, NS_PER_S / 48, 0);
    assert_string_equal(report.format, "s24");
    assert_int_equal(report.cut_count, 0);
    assert_int_equal(read_out(d, got, 1000, &info), 1000);
    for (int64_t i = 0; i < 1000; ++i)
        assert_true(got[i] == 0.5 * sample(i, 0, 16));
    t.audio.gain = 4.0;
    report = export(d, &t, 0, NS_PER_S / 48, 0);
    assert_true(report.cut_count > 500);
    assert_int_equal(read_out(d, got, 1000, &info), 1000);
    for (int64_t i = 0; i < 1000; ++i)
        assert_true(fabs(got[i]) <= 1.0 && got[i] * sample(i, 0, 16) >= 0.0);
}

static void the_file_says_when_it_was(void **state)
{
    desk *d = *state;
    char path[SCENE_PATH];
    SF_BROADCAST_INFO bext;
    SF_INFO info = {0};
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 1000, 16);
    take t = take_of(import(d), 0, 1.0);
    /* scene_utc_ns is 2026-05-28 20:26:40 UTC. */
    (void)export(d, &t, 2 * NS_PER_S, 3 * NS_PER_S, 0);
    out_path(d, path, sizeof path);
    SNDFILE *file = sf_open(path, SFM_READ, &info);
    assert_int_equal(sf_command(file, SFC_GET_BROADCAST_INFO, &bext, sizeof bext), SF_TRUE);
    assert_memory_equal(bext.origination_date, "2026-05-28", 10);
    assert_memory_equal(bext.origination_time, "20:26:42", 8);
    assert_int_equal(bext.time_reference_low, ((20 * 60 + 26) * 60 + 42) * 48000u & 0xffffffffu);
    assert_string_equal(bext.originator, "marotte");
    assert_string_equal(sf_get_string(file, SF_STR_TITLE), "12 b take 4");
    sf_close(file);
    /* With a time code that is what counts: 01:00:00:00 at 25. */
    t.fps = 25;
    t.timecode_frame = 90000;
    (void)export(d, &t, 2 * NS_PER_S, 3 * NS_PER_S, 0);
    file = sf_open(path, SFM_READ, &info);
    assert_int_equal(sf_command(file, SFC_GET_BROADCAST_INFO, &bext, sizeof bext), SF_TRUE);
    assert_int_equal(bext.time_reference_low, 3602u * 48000u);
    sf_close(file);
}

static void another_rate_is_made_only_when_asked_for(void **state)
{
    static double got[48000];
    static float tone[44100];
    desk *d = *state;
    SF_INFO info,
        as = {.samplerate = 44100, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_FLOAT};
    for (int i = 0; i < 44100; ++i)
        tone[i] = (float)(0.5 * sin(6.283185307179586 * 1000.0 * i / 44100.0));
    SNDFILE *file = sf_open(d->file, SFM_WRITE, &as);
    assert_int_equal(sf_writef_float(file, tone, 44100), 44100);
    sf_close(file);
    take t = take_of(import(d), 0, 1.0);
    assert_int_equal(export(d, &t, 0, NS_PER_S, 0).rate_hz, 44100);
    sound_file_report report = export(d, &t, 0, NS_PER_S, 48000);
    assert_int_equal(report.rate_hz, 48000);
    assert_int_equal(report.frame_count, 48000);
    assert_int_equal(read_out(d, got, 48000, &info), 48000);
    double worst = 0;
    for (int i = 500; i < 47500; ++i)
        worst = fmax(worst, fabs(got[i] - 0.5 * sin(6.283185307179586 * 1000.0 * i / 48000.0)));
    print_message("44100 to 48000 Hz: a tone of 1 kHz is off by %.1e at worst\n", worst);
    assert_true(worst < 1e-5);
    /* Downwards, what is above the new Nyquist frequency goes. */
    for (int i = 0; i < 44100; ++i)
        tone[i] = (float)(0.5 * sin(6.283185307179586 * 15000.0 * i / 44100.0));
    file = sf_open(d->file, SFM_WRITE, &as);
    assert_int_equal(sf_writef_float(file, tone, 44100), 44100);
    sf_close(file);
    t = take_of(import(d), 0, 1.0);
    (void)export(d, &t, 0, NS_PER_S, 22050);
    assert_int_equal(read_out(d, got, 48000, &info), 22050);
    worst = 0;
    for (int i = 500; i < 21500; ++i)
        worst = fmax(worst, fabs(got[i]));
    assert_true(worst < 5e-5);
}

static void what_cannot_be_written_leaves_what_was_there(void **state)
{
    desk *d = *state;
    error err = {""};
    char path[SCENE_PATH];
    sound_file_report report;
    struct stat status;
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 100000, 16);
    take t = take_of(import(d), 0, 1.0);
    out_path(d, path, sizeof path);
    put_bytes(d, path, "old", 3);
    int left = 2;
    sound_file_watch watch = {until_third, &left};
    sound_file_export what = {.take = &t, .to_ns = 2 * NS_PER_S};
    assert_int_equal(sound_file_write(&report, d->show, &what, path, &watch, &err), MRT_END);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_size, 3);
    assert_true(sound_file_write(&report, d->show, &what, "/nowhere/at/all.wav", NULL, &err) < 0);
    assert_non_null(strstr(err.text, "/nowhere/at/all.wav"));
    what.to_ns = 0;
    assert_true(sound_file_write(&report, d->show, &what, path, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "range"));
    what.to_ns = NS_PER_S;
    t.audio.audio = 0;
    assert_true(sound_file_write(&report, d->show, &what, path, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "has no sound"));
    t.audio.audio = 99;
    assert_true(sound_file_write(&report, d->show, &what, path, NULL, &err) < 0);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_size, 3);
}

static void the_same_range_gives_the_same_bytes(void **state)
{
    desk *d = *state;
    char path[SCENE_PATH], other[SCENE_PATH], command[3 * SCENE_PATH];
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_FLOAT, 48000, 1, 48000, 24);
    take t = take_of(import(d), 0, 0.7);
    out_path(d, path, sizeof path);
    snprintf(other, sizeof other, "%s/first.wav", d->scene.folder);
    (void)export(d, &t, 0, NS_PER_S, 0);
    assert_int_equal(rename(path, other), 0);
    (void)export(d, &t, 0, NS_PER_S, 0);
    snprintf(command, sizeof command, "cmp '%s' '%s'", path, other);
    assert_int_equal(system(command), 0);
}

#define DESK(test) cmocka_unit_test_setup_teardown(test, desk_make, desk_clear)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DESK(sounds_are_kept_as_they_are_in_the_narrowest_format),
        DESK(floats_that_are_no_integers_stay_floats),
        DESK(ogg_is_read),
        DESK(what_is_no_sound_is_refused_with_a_reason),
        DESK(absurd_headers_are_refused),
        DESK(a_sound_of_more_than_a_day_is_refused),
        DESK(a_cut_file_is_refused_unless_it_is_asked_to_be_kept),
        DESK(samples_that_no_format_keeps_are_refused),
        DESK(giving_up_leaves_nothing_behind),
        DESK(damaged_files_do_no_harm),
        DESK(a_range_goes_out_as_it_came_in_with_silence_around),
        DESK(gain_is_applied_and_what_is_too_loud_is_counted),
        DESK(the_file_says_when_it_was),
        DESK(another_rate_is_made_only_when_asked_for),
        DESK(what_cannot_be_written_leaves_what_was_there),
        DESK(the_same_range_gives_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
