/* Sound from files into a show. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sound_fixture.h"
#include "show/sound_pcm.h"

#include <fcntl.h>

/* libsndfile 1.2 lets go of an Ogg with damaged headers but for this, some 6 kB. */
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:vorbis_info_init";
}

/* The show has no sound but `count` ones. */
static void expect_sounds(const fixture *d, size_t count)
{
    error err = {""};
    int64_t *ids;
    size_t got;
    scene_must(show_audio_ids(d->show, &ids, &got, &err), &err);
    assert_int_equal(got, count);
    free(ids);
}

static void expect_samples(const fixture *d, int64_t id, int channels, int64_t frames, int bits)
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
    fixture *d = *state;
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
    fixture *d = *state;
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
    fixture *d = *state;
    error err = {""};
    show_audio info;
    write_sound(d, SF_FORMAT_OGG | SF_FORMAT_VORBIS, 44100, 1, 44100, 8);
    scene_must(show_audio_info(d->show, import(d), &info, &err), &err);
    assert_string_equal(info.format, "f32");
    assert_int_equal(info.frame_count, 44100);
}

static void refuses(const fixture *d, const char *words)
{
    error err = {""};
    int64_t id = 77;
    assert_true(sound_file_import(&id, d->show, d->file, NULL, &err) < 0);
    assert_int_equal(id, 0);
    if (!strstr(err.text, d->file) || !strstr(err.text, words) || strchr(err.text, '\n'))
        fail_msg("'%s' instead of '%s'", err.text, words);
    expect_sounds(d, 0);
}

static void what_is_no_sound_is_refused_with_a_reason(void **state)
{
    fixture *d = *state;
    refuses(d, "No such file");
    put_bytes(d->file, "", 0);
    refuses(d, "is empty");
    put_bytes(d->file, "these are words and no sound at all, whatever it is called", 58);
    refuses(d, "not a supported sound file");
    assert_int_equal(unlink(d->file), 0);
    assert_int_equal(mkfifo(d->file, 0600), 0);
    refuses(d, "is not a file");
    assert_int_equal(unlink(d->file), 0);
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 0, 16);
    refuses(d, "contains no sound");
}

/* 8 bytes of the header: rate, and the rest as they are. */
static void patch(const fixture *d, long at, const void *bytes, size_t size)
{
    FILE *file = fopen(d->file, "r+b");
    assert_non_null(file);
    assert_int_equal(fseek(file, at, SEEK_SET), 0);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static void absurd_headers_are_refused(void **state)
{
    fixture *d = *state;
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
    fixture *d = *state;
    /* 1000 Hz, 8 bits: 86 400 001 frames of a sparse file. */
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_U8, 1000, 1, 1000, 8);
    uint32_t size = 86400001, whole = size + 36;
    patch(d, 40, &size, 4);
    patch(d, 4, &whole, 4);
    assert_int_equal(truncate(d->file, (off_t)whole + 8), 0);
    refuses(d, "at most 24 h");
}

static void a_cut_file_is_refused(void **state)
{
    static const struct kind {
        int format;
        const char *words;
    } kinds[] = {{SF_FORMAT_WAV | SF_FORMAT_PCM_16, "of 480044 bytes"},
                 {SF_FORMAT_AIFF | SF_FORMAT_PCM_16, "is truncated"},
                 {SF_FORMAT_FLAC | SF_FORMAT_PCM_16, "of 5.000 s"},
                 {SF_FORMAT_OGG | SF_FORMAT_VORBIS, "its end is missing"}};
    fixture *d = *state;
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; ++k) {
        struct stat status;
        write_sound(d, kinds[k].format, 48000, 1, 240000, 16);
        assert_int_equal(stat(d->file, &status), 0);
        assert_int_equal(truncate(d->file, status.st_size / 2 + 1), 0);
        refuses(d, kinds[k].words);
        fixture_clear(state);
        fixture_make(state);
        d = *state;
    }
}

static void samples_that_no_format_keeps_are_refused(void **state)
{
    fixture *d = *state;
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

static void giving_up_leaves_nothing_behind(void **state)
{
    fixture *d = *state;
    error err = {""};
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 2, 200000, 16);
    for (int when = 1; when < 14; when += 3) {
        int left = when;
        int64_t id = 5;
        sound_file_watch watch = {until_count, &left};
        assert_int_equal(sound_file_import(&id, d->show, d->file, &watch, &err), MRT_END);
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
    fixture *d = *state;
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
        mrt_result result = sound_file_import(&id, d->show, d->file, NULL, &err);
        taken += result == MRT_OK;
        refused += result < 0;
        assert_true(result == MRT_OK || (result < 0 && err.text[0]));
    }
    assert_true(taken > 0);
    assert_true(refused > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_FIXTURE(sounds_are_kept_as_they_are_in_the_narrowest_format),
        WITH_FIXTURE(floats_that_are_no_integers_stay_floats),
        WITH_FIXTURE(ogg_is_read),
        WITH_FIXTURE(what_is_no_sound_is_refused_with_a_reason),
        WITH_FIXTURE(absurd_headers_are_refused),
        WITH_FIXTURE(a_sound_of_more_than_a_day_is_refused),
        WITH_FIXTURE(a_cut_file_is_refused),
        WITH_FIXTURE(samples_that_no_format_keeps_are_refused),
        WITH_FIXTURE(giving_up_leaves_nothing_behind),
        WITH_FIXTURE(damaged_files_do_no_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
