/* The plugin org.marotte.voice on a pipe, and on a microphone of ALSA's that a file stands for. */
#define _XOPEN_SOURCE 700
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "input_host.h"

#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

enum { RATE = 48000, HOP = RATE / 100 };
enum { LEVEL, OPENNESS, WIDE, ROUND, CLOSURE, HISS, CHANNELS };
static const int64_t s_ns = 1000000000;

typedef struct room {
    input_host *host;
    char folder[64], pipe[96];
    int writer;
} room;

static int set_up(void **state)
{
    room *r = calloc(1, sizeof *r);
    snprintf(r->folder, sizeof r->folder, "/tmp/marotte_voice_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    snprintf(r->pipe, sizeof r->pipe, "%s/pipe", r->folder);
    assert_int_equal(mkfifo(r->pipe, 0600), 0);
    r->writer = open(r->pipe, O_RDWR | O_NONBLOCK);
    r->host = input_host_create(BUILD_DIR "/plugins/voice.so");
    *state = r;
    return 0;
}

static int tear_down(void **state)
{
    room *r = *state;
    input_host_destroy(r->host);
    close(r->writer);
    unlink(r->pipe);
    rmdir(r->folder);
    free(r);
    return 0;
}

/* 10 ms of a tone of that amplitude, full scale being 1. */
static void hum(int16_t out[HOP], double amplitude)
{
    for (int i = 0; i < HOP; ++i)
        out[i] = (int16_t)lrint(32767.0 * amplitude * sin(6.283185307179586 * i * 20.0 / HOP));
}

static void say(room *r, double amplitude)
{
    int16_t sound[HOP];
    hum(sound, amplitude);
    assert_int_equal(write(r->writer, sound, sizeof sound), sizeof sound);
}

static float hear(room *r)
{
    mrt_sample sample;
    assert_int_equal(input_host_read(r->host, 60 * s_ns, &sample), MRT_OK);
    assert_int_equal(sample.count, CHANNELS);
    return sample.value[0];
}

static void a_tone_has_its_level(void **state)
{
    /* a sine's root mean square is 3.01 dB below its peak */
    static const double amplitude[] = {1.0, 0.1, 0.01, 0.0, 1e-4};
    static const double expected[] = {1.0 - 3.01 / 60.0, 1.0 - 23.01 / 60.0, 1.0 - 43.01 / 60.0,
                                      0.0, 0.0};
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int i = 0; i < 5; ++i) {
        float last = -1.0f;
        for (int k = 0; k < 3; ++k) {
            say(r, amplitude[i]);
            last = hear(r);
        }
        assert_float_equal(last, expected[i], 2e-3);
    }
}

static void times_go_on_by_the_sound_and_never_lie_ahead(void **state)
{
    room *r = *state;
    mrt_sample before = {0}, now;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int i = 0; i < 4; ++i)
        say(r, 0.5);
    for (uint32_t i = 0; i < 4; ++i) {
        assert_int_equal(input_host_read(r->host, 60 * s_ns, &now), MRT_OK);
        assert_true(now.time_ns <= input_host_now_ns(&r->host->host));
        assert_int_equal(now.sequence, before.sequence + (i > 0));
        assert_true(now.time_ns >= before.time_ns);
        before = now;
    }
}

static void a_frame_may_come_in_halves(void **state)
{
    room *r = *state;
    int16_t sound[HOP];
    mrt_sample sample;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    hum(sound, 1.0);
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(write(r->writer, sound, 301), 301);
        assert_int_equal(input_host_read(r->host, 0, &sample), MRT_TIMEOUT);
        assert_int_equal(write(r->writer, (char *)sound + 301, sizeof sound - 301),
                         sizeof sound - 301);
        sample.value[0] = hear(r);
    }
    assert_float_equal(sample.value[0], 1.0f - 3.01f / 60.0f, 2e-3f);
}

static void silence_in_the_pipe_is_waited_for_and_no_longer(void **state)
{
    room *r = *state;
    mrt_sample sample;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    int64_t begin_ns = input_host_now_ns(&r->host->host);
    assert_int_equal(input_host_read(r->host, s_ns / 50, &sample), MRT_TIMEOUT);
    assert_true(input_host_now_ns(&r->host->host) - begin_ns >= s_ns / 50);
}

/* ---- the mouth ---- */

/* Ten milliseconds of a vowel: a voice of 120 Hz through three formants (Klatt 1980). */
typedef struct vowel {
    double first_hz, second_hz, third_hz, y[3][2];
    int at;
} vowel;

static double resonate(double x, double hz, double bandwidth_hz, double y[2])
{
    const double pi = 3.141592653589793, r = exp(-pi * bandwidth_hz / RATE);
    const double b = 2.0 * r * cos(2.0 * pi * hz / RATE), c = -r * r;
    const double out = (1.0 - b - c) * x + b * y[0] + c * y[1];
    y[1] = y[0];
    y[0] = out;
    return out;
}

static void sing(vowel *of, int16_t out[HOP], double amplitude)
{
    for (int i = 0; i < HOP; ++i, ++of->at) {
        const double phase = (double)(of->at % (RATE / 120)) / (RATE / 120);
        double x = phase < 0.4 ? sin(3.141592653589793 * phase / 0.4) : 0.0;
        x -= phase < 0.05 ? 8.0 * phase : 0.0;
        x = resonate(x, of->first_hz, 80.0, of->y[0]);
        x = resonate(x, of->second_hz, 100.0, of->y[1]);
        x = resonate(x, of->third_hz, 150.0, of->y[2]);
        out[i] = (int16_t)fmin(fmax(6000.0 * amplitude * x, -32000.0), 32000.0);
    }
}

static void write_hop(room *r, const int16_t *sound, mrt_sample *out)
{
    assert_int_equal(write(r->writer, sound, HOP * sizeof *sound), HOP * sizeof *sound);
    assert_int_equal(input_host_read(r->host, 60 * s_ns, out), MRT_OK);
}

static void an_open_vowel_opens_the_mouth_within_60_ms(void **state)
{
    room *r = *state;
    vowel ah = {.first_hz = 750.0, .second_hz = 1250.0, .third_hz = 2600.0};
    int16_t sound[HOP] = {0};
    mrt_sample sample;
    float value[60];
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int i = 0; i < 50; ++i)
        write_hop(r, sound, &sample);
    assert_float_equal(sample.value[OPENNESS], 0.0f, 1e-3f);
    for (int i = 0; i < 60; ++i) {
        sing(&ah, sound, 1.0);
        write_hop(r, sound, &sample);
        value[i] = sample.value[OPENNESS];
    }
    int crossing = 0;
    while (value[crossing] < 0.5f * value[59])
        crossing += 1;
    print_message("openness %.2f; half of it %d ms after the sound began\n", (double)value[59],
                  10 * (crossing + 1));
    assert_true(value[59] > 0.3f);
    assert_true(10 * (crossing + 1) <= 60);
}

static void vowels_differ_at_any_loudness(void **state)
{
    room *r = *state;
    static const double amplitude[] = {1.0, 0.1};
    int16_t sound[HOP] = {0};
    mrt_sample ah, ee, oo, sample;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int loud = 0; loud < 2; ++loud) {
        vowel of[] = {{.first_hz = 750.0, .second_hz = 1250.0, .third_hz = 2600.0},
                      {.first_hz = 290.0, .second_hz = 2250.0, .third_hz = 3000.0},
                      {.first_hz = 310.0, .second_hz = 870.0, .third_hz = 2250.0}};
        mrt_sample *heard[] = {&ah, &ee, &oo};
        for (int v = 0; v < 3; ++v) {
            for (int i = 0; i < 40; ++i) {
                sing(&of[v], sound, amplitude[loud]);
                write_hop(r, sound, heard[v]);
            }
            memset(sound, 0, sizeof sound);
            for (int i = 0; i < 100; ++i)
                write_hop(r, sound, &sample);
        }
        print_message(
            "openness: ah %.2f ee %.2f oo %.2f; wide: ee %.2f oo %.2f; round: ee %.2f oo %.2f\n",
            (double)ah.value[OPENNESS], (double)ee.value[OPENNESS], (double)oo.value[OPENNESS],
            (double)ee.value[WIDE], (double)oo.value[WIDE], (double)ee.value[ROUND],
            (double)oo.value[ROUND]);
        assert_true(ah.value[OPENNESS] > ee.value[OPENNESS] + 0.1f);
        assert_true(ah.value[OPENNESS] > oo.value[OPENNESS] + 0.05f);
        assert_true(ee.value[WIDE] - ee.value[ROUND] > oo.value[WIDE] - oo.value[ROUND] + 0.1f);
    }
}

/* Silence, hum of the mains and noise: the mouth rests, and does not flap. */
static void what_is_no_voice_leaves_the_mouth_at_rest(void **state)
{
    room *r = *state;
    int16_t sound[HOP];
    mrt_sample sample;
    uint32_t seed = 1;
    assert_int_equal(input_host_open(r->host, r->pipe), MRT_OK);
    for (int kind = 0; kind < 3; ++kind) {
        float most = 0.0f, moved = 0.0f, before = 0.0f;
        for (int i = 0; i < 300; ++i) {
            for (int k = 0; k < HOP; ++k) {
                seed = seed * 1664525u + 1013904223u;
                const double noise = (double)seed / 4294967296.0 - 0.5;
                const double mains = sin(6.283185307179586 * 50.0 * (i * HOP + k) / RATE);
                sound[k] = (int16_t)(kind == 0 ? 0.0 : kind == 1 ? 2000.0 * mains : 6000.0 * noise);
            }
            write_hop(r, sound, &sample);
            most = fmaxf(most, sample.value[OPENNESS]);
            moved += fabsf(sample.value[OPENNESS] - before);
            before = sample.value[OPENNESS];
        }
        print_message("%s: openness %.2f at most, moves %.2f a second\n",
                      kind == 0   ? "silence"
                      : kind == 1 ? "hum"
                                  : "noise",
                      (double)most, (double)moved / 3.0);
        assert_true(most < 0.2f);
        assert_true(moved / 3.0f < 1.0f);
    }
}

/* ---- files ---- */

static void write_wav(const char *path, uint32_t rate_hz, uint16_t channels, uint16_t bits,
                      uint16_t format, double amplitude)
{
    const uint32_t frames = rate_hz / 2, size = frames * channels * bits / 8u, riff = 36 + size,
                   sixteen = 16, rate_bytes = rate_hz * channels * bits / 8u;
    const uint16_t frame_bytes = (uint16_t)(channels * bits / 8);
    FILE *to = fopen(path, "wb");
    fwrite("RIFF", 4, 1, to), fwrite(&riff, 4, 1, to), fwrite("WAVEfmt ", 8, 1, to);
    fwrite(&sixteen, 4, 1, to), fwrite(&format, 2, 1, to), fwrite(&channels, 2, 1, to);
    fwrite(&rate_hz, 4, 1, to), fwrite(&rate_bytes, 4, 1, to), fwrite(&frame_bytes, 2, 1, to);
    fwrite(&bits, 2, 1, to), fwrite("data", 4, 1, to), fwrite(&size, 4, 1, to);
    for (uint32_t i = 0; i < frames * channels; ++i) {
        const double x = amplitude * sin(6.283185307179586 * 1000.0 * (i / channels) / rate_hz);
        const float single = (float)x;
        const int32_t whole = (int32_t)lrint(x * 2147483520.0) >> (32 - bits);
        fwrite(format == 3 ? (const void *)&single : &whole, bits / 8u, 1, to);
    }
    fclose(to);
}

static void a_file_of_any_format_has_the_level_of_its_sound(void **state)
{
    static const struct {
        uint32_t rate_hz;
        uint16_t channels, bits, format;
    } files[] = {{44100, 1, 16, 1},
                 {22050, 2, 24, 1},
                 {48000, 2, 32, 3},
                 {8000, 1, 16, 1},
                 {192000, 1, 24, 1}};
    room *r = *state;
    char path[96];
    snprintf(path, sizeof path, "%s/tone.wav", r->folder);
    for (int i = 0; i < 5; ++i) {
        mrt_sample sample, before = {0};
        write_wav(path, files[i].rate_hz, files[i].channels, files[i].bits, files[i].format, 0.1);
        assert_int_equal(input_host_open(r->host, path), MRT_OK);
        int count = 0;
        while (input_host_read(r->host, 60 * s_ns, &sample) == MRT_OK) {
            if (++count > 2) {
                assert_float_equal(sample.value[LEVEL], 1.0f - 23.01f / 60.0f, 3e-3f);
                assert_in_range(sample.time_ns - before.time_ns, 9940000, 10060000);
            }
            before = sample;
        }
        assert_int_equal(count, 50);
    }
    unlink(path);
}

static void other_files_are_refused_in_one_sentence(void **state)
{
    room *r = *state;
    char path[96];
    snprintf(path, sizeof path, "%s/other.wav", r->folder);
    write_wav(path, 44100, 1, 8, 1, 0.1);
    assert_int_equal(input_host_open(r->host, path), MRT_ERR_FORMAT);
    assert_non_null(strstr(r->host->last_text, "16 bit, 24 bit or float"));
    FILE *to = fopen(path, "w");
    fputs("no sound at all", to);
    fclose(to);
    assert_int_equal(input_host_open(r->host, path), MRT_ERR_FORMAT);
    assert_non_null(strstr(r->host->last_text, "is not a WAV file"));
    write_wav(path, 44100, 1, 16, 1, 0.1);
    assert_int_equal(truncate(path, 44), 0);
    assert_int_equal(input_host_open(r->host, path), MRT_ERR_FORMAT);
    assert_non_null(strstr(r->host->last_text, "has no sound"));
    assert_int_equal(r->host->said[MRT_LOG_ERROR], 3);
    unlink(path);
}

/* ALSA's own "file" stands for a microphone, the real library reads it. */
static void a_microphone_of_alsas_is_heard_by_its_name(void **state)
{
    room *r = *state;
    char path[2][96];
    int16_t sound[HOP];
    if (access("/usr/share/alsa/alsa.conf", R_OK) != 0)
        skip();
    snprintf(path[0], sizeof path[0], "%s/alsa.conf", r->folder);
    snprintf(path[1], sizeof path[1], "%s/sound", r->folder);
    FILE *config = fopen(path[0], "w"), *recorded = fopen(path[1], "w");
    fprintf(config,
            "</usr/share/alsa/alsa.conf>\n"
            "pcm.talk { type file slave.pcm null file /dev/null infile \"%s\" format raw }\n",
            path[1]);
    hum(sound, 0.1);
    for (int i = 0; i < 50; ++i)
        fwrite(sound, sizeof sound, 1, recorded);
    fclose(config);
    fclose(recorded);
    setenv("ALSA_CONFIG_PATH", path[0], 1);
    mrt_result result = input_host_open(r->host, "talk");
    if (result == MRT_ERR_IO && strstr(r->host->last_text, "libasound2-dev"))
        skip(); /* built without it */
    assert_int_equal(result, MRT_OK);
    (void)hear(r);
    for (int i = 0; i < 20; ++i)
        assert_float_equal(hear(r), 1.0f - 23.01f / 60.0f, 2e-3f);
    unlink(path[0]);
    unlink(path[1]);
}

static void what_cannot_be_heard_is_refused_with_advice(void **state)
{
    room *r = *state;
    assert_int_equal(input_host_open(r->host, r->folder), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "mkfifo"));
    assert_int_equal(input_host_open(r->host, "no_such_microphone"), MRT_ERR_IO);
    assert_non_null(strstr(r->host->last_text, "no_such_microphone"));
    assert_int_equal(r->host->said[MRT_LOG_ERROR], 2);
}

#define ROOM_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
int main(void)
{
    const struct CMUnitTest tests[] = {
        ROOM_TEST(a_tone_has_its_level),
        ROOM_TEST(times_go_on_by_the_sound_and_never_lie_ahead),
        ROOM_TEST(a_frame_may_come_in_halves),
        ROOM_TEST(silence_in_the_pipe_is_waited_for_and_no_longer),
        ROOM_TEST(an_open_vowel_opens_the_mouth_within_60_ms),
        ROOM_TEST(vowels_differ_at_any_loudness),
        ROOM_TEST(what_is_no_voice_leaves_the_mouth_at_rest),
        ROOM_TEST(a_file_of_any_format_has_the_level_of_its_sound),
        ROOM_TEST(other_files_are_refused_in_one_sentence),
        ROOM_TEST(a_microphone_of_alsas_is_heard_by_its_name),
        ROOM_TEST(what_cannot_be_heard_is_refused_with_advice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
