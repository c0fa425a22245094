/* The faces that are looked at while a stage is live, and whether a take shows them again, bit for
 * bit. */
#ifndef MAROTTE_TESTS_LIVE_SEEN_H
#define MAROTTE_TESTS_LIVE_SEEN_H
#include "window/live_fixture.h"

#include "stage/playback/sequencer.h"

enum { SEEN_MAX = 4096 };
static const int64_t seen_apart_ns =
    30 * NS_PER_MS; /* as pictures: each is performed again twice */

typedef struct seen_faces { /* the faces that were looked at while a take was recorded */
    uint32_t count;
    int64_t sample_ns[SEEN_MAX];
    uint64_t hash[SEEN_MAX];
} seen_faces;

static inline void seen_remember(live_fixture *d, seen_faces *s)
{
    bool is_new = s->count == 0 || d->view->sample_ns - s->sample_ns[s->count - 1] >= seen_apart_ns;
    if (!is_new || s->count == SEEN_MAX)
        return;
    s->sample_ns[s->count] = d->view->sample_ns;
    s->hash[s->count++] = fixture_hash(d->view->position, (size_t)d->view->vertex_count * 3);
}

/* For so long, and until the last that was measured by then is seen. */
static inline void seen_watch(live_fixture *d, seen_faces *s, double seconds)
{
    int64_t until_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    int64_t last_ns = until_ns + 20 * NS_PER_S;
    while (clock_now_ns() < until_ns || (d->view->sample_ns < until_ns - NS_PER_S / 20 &&
                                         d->live->moves && clock_now_ns() < last_ns)) {
        fixture_frame(d);
        seen_remember(d, s);
    }
}

static inline int64_t seen_record_end(live_fixture *d)
{
    error err = {""};
    live_status status;
    fixture_must(live_record_end(d->live, &err), &err);
    live_status_of(d->live, &status);
    assert_false(status.is_recording);
    return status.take;
}

/* The faces that were seen from start_ns on are those of the take, after any other instant. */
static inline uint32_t seen_compare_take(live_fixture *d, const take *t, int64_t start_ns,
                                         const seen_faces *s)
{
    error err = {""};
    sequencer *plays;
    uint32_t compared = 0;
    show *reading;
    fixture_must(show_open(&reading, d->show_path, SHOW_READ, &err), &err);
    const sequencer_settings settings = {
        .show = reading, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    fixture_must(sequencer_create(&plays, &settings, t, &err), &err);
    composer *shown = sequencer_performer(plays)->composer;
    size_t size = (size_t)d->view->vertex_count * 3;
    float *rows = malloc(size * sizeof *rows);
    for (uint32_t n = 0; n < 2 * s->count; ++n) { /* on, and then back, by what was kept */
        uint32_t i = n < s->count ? n : 2 * s->count - 1 - n;
        int64_t at_ns = s->sample_ns[i] - start_ns;
        if (at_ns < 0 || at_ns >= t->duration_ns)
            continue;
        fixture_must(sequencer_play_to(plays, at_ns, &err), &err);
        composer_draw(shown);
        points_to_rows(rows, face_shown(composer_face(shown)), face_order(composer_face(shown)));
        if (fixture_hash(rows, size) != s->hash[i])
            fail_msg("face %u of %u, at %.4f s of %.4f s, is another one%s", i, s->count,
                     (double)at_ns / 1e9, (double)t->duration_ns / 1e9,
                     n < s->count ? "" : " when it is sought");
        compared += n < s->count;
    }
    free(rows);
    sequencer_destroy(plays);
    show_close(reading);
    return compared;
}

/* The same for the newest recording of the stage. */
static inline uint32_t seen_compare(live_fixture *d, int64_t take_id, const seen_faces *s)
{
    take t = {0};
    fixture_take(d, take_id, &t);
    const uint32_t compared = seen_compare_take(d, &t, d->live->take_begun_ns, s);
    take_finish(&t);
    return compared;
}

#endif
