/* The sound of a take into a WAV. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sound_fixture.h"

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

static void out_path(const fixture *d, char *out, size_t capacity)
{
    snprintf(out, capacity, "%s/out.wav", d->scene.folder);
}

static sound_file_report export(const fixture *d, const take *t, int64_t from_ns, int64_t to_ns,
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

static size_t read_out(const fixture *d, double *out, size_t frames_max, SF_INFO *info)
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
    fixture *d = *state;
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
    fixture *d = *state;
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

static void what_is_trimmed_is_not_heard_and_fades(void **state)
{
    static double got[48000];
    fixture *d = *state;
    SF_INFO info;
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 40000, 16);
    take t = take_of(import(d), NS_PER_S / 4, 1.0);
    t.audio.in_ns = NS_PER_S / 4;  /* frame 24000 of the timeline */
    t.audio.out_ns = NS_PER_S / 2; /* 36000 */
    (void)export(d, &t, 0, NS_PER_S, 0);
    assert_int_equal(read_out(d, got, 48000, &info), 48000);
    for (int64_t i = 0; i < 48000; ++i) {
        const double whole = sample(i - 12000, 0, 16);
        if (i < 24000 || i >= 36000)
            assert_true(got[i] == 0.0);
        else if (i >= 24000 + 250 && i < 36000 - 250)
            assert_true(got[i] == whole);
        else
            assert_true(fabs(got[i]) <= fabs(whole) + 1e-4 && got[i] * whole >= 0.0);
    }
    assert_true(fabs(got[24001]) < 0.01 && fabs(got[35999]) < 0.01);
}

static void the_file_says_when_it_was(void **state)
{
    fixture *d = *state;
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
    fixture *d = *state;
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
    fixture *d = *state;
    error err = {""};
    char path[SCENE_PATH];
    sound_file_report report;
    struct stat status;
    write_sound(d, SF_FORMAT_WAV | SF_FORMAT_PCM_16, 48000, 1, 100000, 16);
    take t = take_of(import(d), 0, 1.0);
    out_path(d, path, sizeof path);
    put_bytes(path, "old", 3);
    int left = 2;
    sound_file_watch watch = {until_count, &left};
    sound_file_export what = {.take = &t, .to_ns = 2 * NS_PER_S};
    assert_int_equal(sound_file_write(&report, d->show, &what, path, &watch, &err), MRT_END);
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_size, 3);
    assert_true(sound_file_write(&report, d->show, &what, "/dev/null/all.wav", NULL, &err) < 0);
    assert_non_null(strstr(err.text, "/dev/null"));
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
    fixture *d = *state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        WITH_FIXTURE(a_range_goes_out_as_it_came_in_with_silence_around),
        WITH_FIXTURE(gain_is_applied_and_what_is_too_loud_is_counted),
        WITH_FIXTURE(what_is_trimmed_is_not_heard_and_fades),
        WITH_FIXTURE(the_file_says_when_it_was),
        WITH_FIXTURE(another_rate_is_made_only_when_asked_for),
        WITH_FIXTURE(what_cannot_be_written_leaves_what_was_there),
        WITH_FIXTURE(the_same_range_gives_the_same_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
