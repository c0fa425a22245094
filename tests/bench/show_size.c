/* What a show costs: show_size [--full] [FOLDER]
 * Records two gloves of 22 counts at 150 Hz and a pedal, as fast as they are written; prints the
 * size of the show, the time that opening, listing and seeking take, and what a sample costs the
 * recording thread. Ten minutes; --full: eight hours. The hands are the recordings in
 * ../shared/data/hands, or made up where there are none. Not a test: a clock decides nothing here.
 */
#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "hand/hand.h"
#include "show/show.h"
#include "show/writer.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    RATE_HZ = 150,
    PEDAL_RATE_HZ = 100,
    HANDS = 2,
    RECORDINGS = 3,
    FIELDS_BEFORE = 7, /* year month day hour minute second flag */
    COST_SAMPLES = 20000
};
static const double recorded_hz = 64.0; /* a record each 15.6 ms */

typedef struct hand_log {
    float *count; /* record by record, MRT_ANGLES each, as counts of a glove */
    size_t records;
} hand_log;

static int fail(const char *text)
{
    fprintf(stderr, "show_size: %s\n", text);
    return 1;
}

/* ---- hands ---- */

/* Counts of which the calibration makes these angles. */
static void to_counts(float *out, const double *rad, const hand_calibration *calibration)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const hand_table *table = &calibration->sensor[i];
        double slope =
            (double)(table->raw[1] - table->raw[0]) / (double)(table->rad[1] - table->rad[0]);
        double raw = (double)table->raw[0] + (rad[i] - (double)table->rad[0]) * slope;
        out[i] = (float)fmin(fmax(floor(raw + 0.5), 1.0), 255.0);
    }
}

static bool read_record(double out[MRT_ANGLES], text_view line)
{
    text_view word;
    for (int i = 0; i < FIELDS_BEFORE; ++i)
        if (!text_next_word(&line, &word))
            return false;
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!text_next_word(&line, &word) || !text_double(word, &out[i]))
            return false;
    return true;
}

static bool read_log(hand_log *out, const char *path, const hand_calibration *calibration)
{
    file_bytes bytes;
    error err;
    if (file_read(&bytes, path, 1 << 26, &err) < 0)
        return false;
    text_view rest = text_view_of(bytes.data, bytes.size), line;
    out->count = malloc((bytes.size / 64 + 1) * MRT_ANGLES * sizeof *out->count);
    double rad[MRT_ANGLES];
    while (out->count && text_next_line(&rest, &line) && read_record(rad, line))
        to_counts(out->count + out->records++ * MRT_ANGLES, rad, calibration);
    file_bytes_finish(&bytes);
    return out->records > 2;
}

/* Hands that wander where there is no recording: a sensor moves by a count now and then. */
static bool make_up_log(hand_log *out)
{
    uint64_t random = 1;
    out->records = 20000;
    out->count = malloc(out->records * MRT_ANGLES * sizeof *out->count);
    for (size_t i = 0; out->count && i < out->records * MRT_ANGLES; ++i) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        float last = i < MRT_ANGLES ? 128.0f : out->count[i - MRT_ANGLES];
        float step = (float)((int)(random >> 61) - 3) / 2.0f;
        out->count[i] = fminf(fmaxf(floorf(last + step), 20.0f), 235.0f);
    }
    return out->count != NULL;
}

static bool read_hands(hand_log logs[RECORDINGS])
{
    static const char *const names[RECORDINGS] = {"00_calib-rad-su01.txt",
                                                  "02_i_r_ex02-rad-021-grasp-su01.txt",
                                                  "10_ex01-rad-003-grasp-su04.txt"};
    const char *shared = getenv("MAROTTE_SHARED");
    hand_calibration calibration;
    bool recorded = true;
    hand_calibration_default(&calibration);
    for (int i = 0; i < RECORDINGS; ++i) {
        char path[1024];
        snprintf(path, sizeof path, "%s/data/hands/%s", shared ? shared : SOURCE_DIR "/../shared",
                 names[i]);
        if (read_log(&logs[i], path, &calibration))
            continue;
        recorded = false;
        free(logs[i].count);
        if (!make_up_log(&logs[i]))
            exit(fail("no memory"));
    }
    return recorded;
}

/* Sample n of a hand: recordings one after the other, each forward and back, the records between
 * their instants interpolated, one count of noise at times as a glove has it. */
static void hand_sample(mrt_sample *out, const hand_log logs[RECORDINGS], int hand, int64_t n)
{
    double at = (double)n * recorded_hz / RATE_HZ + 900.0 * hand;
    int64_t cycle = 0;
    for (int i = 0; i < RECORDINGS; ++i)
        cycle += 2 * (int64_t)(logs[i].records - 1);
    double within = fmod(at, (double)cycle);
    int i = 0;
    while (within >= 2.0 * (double)(logs[i].records - 1))
        within -= 2.0 * (double)(logs[i++].records - 1);
    if (within >= (double)(logs[i].records - 1))
        within = 2.0 * (double)(logs[i].records - 1) - within;
    size_t record = (size_t)fmin(within, (double)(logs[i].records - 2));
    const float *a = logs[i].count + record * MRT_ANGLES, *b = a + MRT_ANGLES;
    uint64_t random = (uint64_t)(n * HANDS + hand) * 6364136223846793005u + 1442695040888963407u;
    random ^= random >> 29;
    random *= 0xbf58476d1ce4e5b9u;
    out->time_ns =
        n * 6666667 + (int64_t)(random >> 46) * 8; /* up to 2 ms late, by the USB frame */
    out->sequence = (uint32_t)n;
    out->count = MRT_ANGLES;
    for (int c = 0; c < MRT_ANGLES; ++c) {
        double share = within - (double)record;
        double value = (double)a[c] + share * (double)(b[c] - a[c]);
        double noise = (random >> c & 15) == 0 ? 1.0 : 0.0;
        out->value[c] = (float)floor(value + noise + 0.5);
    }
}

static void pedal_sample(mrt_sample *out, int64_t n)
{
    *out = (mrt_sample){
        .time_ns = n * (NS_PER_S / PEDAL_RATE_HZ), .sequence = (uint32_t)n, .count = 3};
    out->value[0] = (float)(n / 317 % 2);
    out->value[1] = (float)(n / 1021 % 5 == 0);
}

/* ---- recording ---- */

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        exit(fail(err->text));
}

static int64_t add_track(writer *w, const char *input, const char *unit, uint32_t channel_count)
{
    error err = {""};
    char name[64];
    snprintf(name, sizeof name, "%s", input);
    take_track track = {.input = name, .channel_count = channel_count};
    for (uint32_t c = 0; c < channel_count; ++c) {
        snprintf(track.channel[c].name, sizeof track.channel[c].name, "channel %u", c);
        snprintf(track.channel[c].unit, sizeof track.channel[c].unit, "%s", unit);
    }
    must(writer_add_track(w, &track, &err), &err);
    return track.id;
}

/* In commits of 40 ms, as in life. */
static void record_second(writer *w, const hand_log logs[RECORDINGS],
                          const int64_t track[HANDS + 1], int64_t second)
{
    error err = {""};
    mrt_sample sample = {0};
    for (int64_t n = second * RATE_HZ; n < (second + 1) * RATE_HZ; ++n) {
        for (int hand = 0; hand < HANDS; ++hand) {
            hand_sample(&sample, logs, hand, n);
            writer_sample(w, track[hand], &sample);
        }
        if (n % 3 != 2) {
            pedal_sample(&sample, n / 3 * 2 + n % 3);
            writer_sample(w, track[HANDS], &sample);
        }
        if (n % 6 == 5)
            must(writer_flush(w, &err), &err);
    }
}

static void record(const char *path, const hand_log logs[RECORDINGS], int64_t seconds)
{
    error err = {""};
    show *s;
    writer *w;
    int64_t take_id, track[HANDS + 1];
    writer_options options = {.utc_ns = 1780000000000000000, .program = "show_size"};
    must(show_create(&s, path, &err), &err);
    must(writer_start(&w, s, &options, &err), &err);
    track[0] = add_track(w, "cyberglove:left", "count", MRT_ANGLES);
    track[1] = add_track(w, "cyberglove:right", "count", MRT_ANGLES);
    track[2] = add_track(w, "pedal", "", 3);
    take_performance performance = {.track_count = HANDS + 1,
                                    .track = {track[0], track[1], track[2]}};
    must(writer_begin_performance(w, &performance, 0, &err), &err);
    for (int64_t second = 0; second < seconds; ++second) {
        if (second % 120 == 0)
            must(writer_take_begin(w, second * NS_PER_S, &(writer_slate){.scene = "1"}, &take_id,
                                   &err),
                 &err);
        record_second(w, logs, track, second);
        if (second % 120 == 119)
            must(writer_take_end(w, take_id, (second + 1) * NS_PER_S, &err), &err);
    }
    must(writer_stop(w, &err), &err);
    show_close(s);
}

/* ---- measuring ---- */

static int by_size(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

static double ms_since(int64_t start_ns)
{
    return (double)(clock_now_ns() - start_ns) * 1e-6;
}

static void print_size(const char *path, int64_t seconds)
{
    struct stat status;
    if (stat(path, &status) != 0)
        exit(fail("the show is gone"));
    double hourly_mb = (double)status.st_size * 1e-6 * 3600.0 / (double)seconds;
    printf("size: %.2f MB for %lld s: %.2f MB an hour, %.1f MB in 8 h\n",
           (double)status.st_size * 1e-6, (long long)seconds, hourly_mb, 8 * hourly_mb);
}

static void print_opening(const char *path)
{
    error err = {""};
    show *s;
    show_take *takes;
    size_t count;
    int64_t start_ns = clock_now_ns();
    must(show_open(&s, path, SHOW_WRITE, &err), &err);
    double open_ms = ms_since(start_ns);
    must(show_takes(s, &takes, &count, &err), &err);
    printf("opening: %.2f ms, and with a list of %zu takes %.2f ms\n", open_ms, count,
           ms_since(start_ns));
    free(takes);
    show_close(s);
}

static void print_reading(const char *path, int64_t seconds)
{
    enum { SEEKS = 500 };
    static int64_t seek_ns[SEEKS];
    error err = {""};
    show *s;
    show_reader *reader;
    mrt_sample sample;
    must(show_open(&s, path, SHOW_READ, &err), &err);
    must(show_reader_open(&reader, s, 1, INT64_MIN, INT64_MAX, &err), &err);
    int64_t start_ns = clock_now_ns(), count = 0, first_ns = 0;
    mrt_result result;
    while ((result = show_reader_next(reader, &sample, &err)) == MRT_OK)
        if (count++ == 0)
            first_ns = sample.time_ns;
    must(result, &err);
    printf("reading: %.0f samples a ms in order\n", (double)count / ms_since(start_ns));
    uint64_t random = 1;
    for (int i = 0; i < SEEKS; ++i) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        int64_t at_ns = first_ns + (int64_t)(random >> 16) % (seconds * NS_PER_S);
        start_ns = clock_now_ns();
        must(show_reader_seek(reader, at_ns, &err), &err);
        must(show_reader_next(reader, &sample, &err), &err);
        seek_ns[i] = clock_now_ns() - start_ns;
    }
    qsort(seek_ns, SEEKS, sizeof seek_ns[0], by_size);
    printf("seeking: median %.3f ms, worst of %d %.3f ms\n", (double)seek_ns[SEEKS / 2] * 1e-6,
           SEEKS, (double)seek_ns[SEEKS - 1] * 1e-6);
    show_reader_close(reader);
    show_close(s);
}

/* In real time, four samples after each other, so that the writer's thread works beside. */
static void print_cost(const char *path, const hand_log logs[RECORDINGS])
{
    static int64_t cost_ns[COST_SAMPLES];
    error err = {""};
    show *s;
    writer *w;
    writer_options options = {.utc_ns = 1780000000000000000, .program = "show_size"};
    must(show_create(&s, path, &err), &err);
    must(writer_start(&w, s, &options, &err), &err);
    int64_t track = add_track(w, "cyberglove:left", "count", MRT_ANGLES);
    mrt_sample sample = {0};
    int64_t begun_ns = clock_now_ns();
    for (int64_t n = 0; n < COST_SAMPLES; ++n) {
        if (n % 4 == 0)
            clock_sleep_until_ns(begun_ns + n * NS_PER_S / 2000);
        hand_sample(&sample, logs, 0, n);
        int64_t start_ns = clock_now_ns();
        writer_sample(w, track, &sample);
        cost_ns[n] = clock_now_ns() - start_ns;
    }
    must(writer_stop(w, &err), &err);
    show_close(s);
    qsort(cost_ns, COST_SAMPLES, sizeof cost_ns[0], by_size);
    printf("a sample costs the recording thread: median %.2f us, p99 %.2f us, p99.9 %.2f us, worst "
           "%.1f us\n",
           (double)cost_ns[COST_SAMPLES / 2] * 1e-3,
           (double)cost_ns[COST_SAMPLES * 99 / 100] * 1e-3,
           (double)cost_ns[COST_SAMPLES * 999 / 1000] * 1e-3,
           (double)cost_ns[COST_SAMPLES - 1] * 1e-3);
}

int main(int count, char **arguments)
{
    bool full = count > 1 && strcmp(arguments[1], "--full") == 0;
    const char *folder = count > 1 + full ? arguments[1 + full] : "/tmp";
    int64_t seconds = full ? 8 * 3600 : 600;
    char path[1024], other[1024];
    hand_log logs[RECORDINGS] = {{0}};
    snprintf(path, sizeof path, "%s/show_size_%ld.marotte", folder, (long)getpid());
    snprintf(other, sizeof other, "%s/show_size_%ld_cost.marotte", folder, (long)getpid());
    printf("two gloves of 22 counts at %d Hz and a pedal at %d Hz, hands %s\n", RATE_HZ,
           PEDAL_RATE_HZ, read_hands(logs) ? "as recorded" : "made up");
    int64_t start_ns = clock_now_ns();
    record(path, logs, seconds);
    printf("recorded %.0f times as fast as life\n", (double)seconds * 1e3 / ms_since(start_ns));
    print_size(path, seconds);
    print_opening(path);
    print_reading(path, seconds);
    print_cost(other, logs);
    for (int i = 0; i < RECORDINGS; ++i)
        free(logs[i].count);
    (void)unlink(path);
    (void)unlink(other);
    return 0;
}
