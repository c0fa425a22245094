/* What the tests of sound in files share: a show, a file, and sound whose every sample is known
 * from its number. */
#ifndef MAROTTE_TESTS_SOUND_FIXTURE_H
#define MAROTTE_TESTS_SOUND_FIXTURE_H
#include "show_scene.h"
#include "show/sound_file.h"

#include <math.h>
#include <sndfile.h>
#include <stdbool.h>

typedef struct fixture {
    scene scene;
    show *show;
    char file[SCENE_PATH];
} fixture;

static inline int fixture_make(void **state)
{
    error err = {""};
    fixture *d = calloc(1, sizeof *d);
    assert_non_null(d);
    scene_make(&d->scene);
    scene_must(show_create(&d->show, d->scene.path, &err), &err);
    snprintf(d->file, sizeof d->file, "%s/voice.wav", d->scene.folder);
    *state = d;
    return 0;
}

static inline int fixture_clear(void **state)
{
    fixture *d = *state;
    show_close(d->show);
    scene_remove(&d->scene);
    free(d);
    return 0;
}

/* Sample c of frame n, exact in `bits`. */
static inline double sample(int64_t n, int c, int bits)
{
    int64_t range = (int64_t)1 << (bits - 1);
    int64_t value = (int64_t)(scene_random((uint64_t)(n * 8 + c)) % (uint64_t)(2 * range)) - range;
    return (double)value / (double)range;
}

static inline void write_sound(const fixture *d, int format, int rate_hz, int channels,
                               int64_t frames, int bits)
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

static inline int64_t import(const fixture *d)
{
    error err = {""};
    int64_t id = 0;
    scene_must(sound_file_import(&id, d->show, d->file, NULL, &err), &err);
    assert_true(id > 0);
    return id;
}

static inline void put_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* Goes on until it has been asked so many times. */
static inline bool until_count(void *data, double part)
{
    int *left = data;
    assert_true(part >= 0.0 && part <= 1.0);
    return --*left > 0;
}

#define WITH_FIXTURE(test) cmocka_unit_test_setup_teardown(test, fixture_make, fixture_clear)

#endif
