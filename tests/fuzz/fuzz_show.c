/* Any file is a show or is refused with a reason; whatever it says, everything in it can be asked
 * for, and it can be recovered or not. The bytes say how a whole show is changed: its length in
 * pages (0: as it is), then 3 bytes of where and 1 of what, again and again. */
#include "base/file.h"
#include "take/writer.h"
#include "take/show.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { TRIES_MAX = 20000 };

static void write_file(const char *path, const uint8_t *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size)
        abort();
    fclose(file);
}

static void read_track(show *s, int64_t id)
{
    error err;
    show_track track;
    show_reader *reader;
    mrt_sample sample;
    if (show_track_read(s, id, &track, &err) >= 0)
        show_track_finish(&track);
    if (show_reader_open(&reader, s, id, INT64_MIN, INT64_MAX, &err) < 0)
        return;
    int tries = 0;
    while (show_reader_next(reader, &sample, &err) != MRT_END && tries < TRIES_MAX)
        ++tries;
    show_reader_close(reader);
}

static void read_take(show *s, int64_t id)
{
    error err;
    take base;
    show_edits edits;
    show_span *spans;
    size_t count;
    if (show_take_base(s, id, &base, &err) >= 0)
        take_finish(&base);
    if (show_edits_read(s, id, &edits, &err) >= 0)
        show_edits_finish(&edits);
    if (show_take_spans(s, id, &spans, &count, &err) >= 0)
        free(spans);
}

static void read_performance(show *s, int64_t id)
{
    error err;
    show_performance performance;
    show_checkpoint checkpoint;
    if (show_performance_read(s, id, &performance, &err) >= 0)
        show_performance_finish(&performance);
    if (show_checkpoint_before(s, id, INT64_MAX, 0, &checkpoint, &err) >= 0)
        show_checkpoint_finish(&checkpoint);
}

static void read_audio(show *s, int64_t id)
{
    static uint8_t sound[1 << 16];
    error err;
    size_t size;
    if (show_audio_read(s, id, 0, sound, sizeof sound, &size, &err) >= 0)
        assert(size <= sizeof sound);
}

static void each(show *s, mrt_result (*list)(show *, int64_t **, size_t *, error *),
                 void (*read)(show *, int64_t))
{
    error err;
    int64_t *ids;
    size_t count;
    if (list(s, &ids, &count, &err) < 0)
        return;
    for (size_t i = 0; i < count && i < 64; ++i)
        read(s, ids[i]);
    free(ids);
}

static void read_all(show *s)
{
    error err;
    show_take *takes;
    take_event *events;
    size_t count;
    each(s, show_track_ids, read_track);
    each(s, show_performance_ids, read_performance);
    each(s, show_audio_ids, read_audio);
    if (show_takes(s, &takes, &count, &err) >= 0) {
        for (size_t i = 0; i < count && i < 64; ++i)
            read_take(s, takes[i].id);
        free(takes);
    }
    if (show_events(s, INT64_MIN, INT64_MAX, &events, &count, &err) >= 0)
        free(events);
}

static char path[64], out_path[64];
static file_bytes whole;

static void must(mrt_result result)
{
    if (result < 0)
        abort();
}

static void record(writer *w)
{
    char input[] = "input";
    take_track track = {.input = input, .channel_count = 3};
    must(writer_add_track(w, &track, NULL));
    take_performance performance = {.mapping = input, .rig = input, .track_count = 1};
    performance.track[0] = track.id;
    must(writer_begin_performance(w, &performance, 0, NULL));
    int64_t id;
    must(writer_take_begin(w, 0, &(writer_slate){.scene = "1"}, &id, NULL));
    for (uint32_t n = 0; n < 700; ++n) {
        mrt_sample sample = {.time_ns = n * 6666667, .sequence = n, .count = 3};
        sample.value[1] = (float)(n % 17);
        sample.value[2] = 0.1f * (float)n;
        writer_sample(w, track.id, &sample);
    }
    must(writer_mark(w, 5, "mark", NULL));
    uint8_t *buffer = writer_checkpoint_buffer(w);
    memset(buffer, 7, 5000);
    writer_checkpoint(w, performance.id, 3, 1, buffer, 5000);
}

static void make_whole(void)
{
    show *s;
    writer *w;
    int64_t audio_id;
    const char *folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    snprintf(path, sizeof path, "%s/fuzz_show_%ld.marotte", folder, (long)getpid());
    snprintf(out_path, sizeof out_path, "%s/fuzz_show_%ld_out.marotte", folder, (long)getpid());
    (void)unlink(path);
    must(show_create(&s, path, NULL));
    must(writer_start(&w, s, &(writer_options){.program = "fuzz", .checkpoint_bytes = 5000}, NULL));
    record(w);
    must(writer_stop(w, NULL));
    for (int i = 0; i < 3; ++i)
        must(show_edit_append(s, 1, "{\"op\":\"take.rate\",\"rating\":3}", i, NULL, 0, NULL));
    show_audio audio = {.name = "a", .rate_hz = 48000, .channel_count = 1, .format = "s16"};
    must(show_audio_create(s, &audio, &audio_id, NULL));
    must(show_audio_write(s, audio_id, 0, "12345678", 8, NULL));
    show_close(s);
    must(file_read(&whole, path, 1 << 24, NULL));
}

static size_t change(uint8_t *out, const uint8_t *bytes, size_t size)
{
    memcpy(out, whole.data, whole.size);
    for (size_t i = 1; i + 4 <= size; i += 4) {
        size_t at = (size_t)bytes[i] << 16 | (size_t)bytes[i + 1] << 8 | bytes[i + 2];
        out[at % whole.size] ^= bytes[i + 3];
    }
    size_t pages = size > 0 ? bytes[0] : 0;
    return pages > 0 && pages * 4096 < whole.size ? pages * 4096 : whole.size;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (!whole.data)
        make_whole();
    uint8_t *changed = malloc(whole.size);
    assert(changed);
    size_t changed_size = change(changed, bytes, size);
    for (int mode = SHOW_READ; mode <= SHOW_WRITE; ++mode) {
        show *s;
        error err = {""};
        write_file(path, changed, changed_size);
        if (show_open(&s, path, (show_mode)mode, &err) < 0) {
            assert(strlen(err.text) > 0 && !s);
            continue;
        }
        read_all(s);
        show_close(s);
    }
    error err = {""};
    show_recovery got;
    write_file(path, changed, changed_size);
    if (show_recover(&got, path, out_path, &err) < 0)
        assert(strlen(err.text) > 0);
    (void)unlink(out_path);
    (void)unlink(path);
    free(changed);
    return 0;
}
