/* A live stage for tests: a face, plugins, a show in a folder of its own; and what a test does with
 * it: waits until something holds, drags the mouse, hashes what is seen. */
#ifndef MAROTTE_TESTS_LIVE_FIXTURE_H
#define MAROTTE_TESTS_LIVE_FIXTURE_H
/* clang-format off */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
/* clang-format on */
#include "base/clock.h"
#include "stage/input/feed.h"
#include "stage/live/live.h"
#include "stage/live/live_stage.h"
#include "stage/mapping/plugins.h"
#include "show/edit_store.h"
#include "show/history.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FIXTURE_PATH = 512, FIXTURE_PATIENCE_S = 600 };

typedef struct live_fixture {
    char folder[FIXTURE_PATH / 2], show_path[FIXTURE_PATH], face_path[FIXTURE_PATH];
    plugin_list plugins;
    log_queue *log;
    face_file face;
    show *show;
    live *live;
    const live_view *view; /* the newest that was looked at */
    float *first;          /* the face at rest, as rows */
} live_fixture;

static inline void fixture_must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

typedef enum fixture_record { FIXTURE_NO_SHOW = 0, FIXTURE_SHOW } fixture_record;

static inline void fixture_start_heard(live_fixture *d, const char *name, const char *mapping,
                                       fixture_record records, const sound_backend *backend)
{
    static const char *const libraries[] = {"log", "anchored", "unanchored", "one_hand"};
    const char *temporary = getenv("TMPDIR");
    char path[FIXTURE_PATH];
    error err = {""};
    memset(d, 0, sizeof *d);
    d->log = log_queue_create();
    for (size_t i = 0; i < sizeof libraries / sizeof *libraries; ++i) {
        snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, libraries[i]);
        fixture_must(plugin_list_add(&d->plugins, path, &err), &err);
    }
    snprintf(d->folder, sizeof d->folder, "%s/marotte_fixture_XXXXXX",
             temporary ? temporary : "/tmp");
    assert_non_null(mkdtemp(d->folder));
    snprintf(d->show_path, sizeof d->show_path, "%s/fixture.marotte", d->folder);
    snprintf(d->face_path, sizeof d->face_path, "%s/rigs/%s/%s.rig.json", SOURCE_DIR, name, name);
    fixture_must(face_file_read(&d->face, d->face_path, NULL, FACE_FILE_USABLE, &err), &err);
    if (records == FIXTURE_SHOW)
        fixture_must(show_create(&d->show, d->show_path, &err), &err);
    const live_settings settings = {.plugins = &d->plugins,
                                    .log = d->log,
                                    .show = d->show,
                                    .face = &d->face,
                                    .face_path = d->face_path,
                                    .mapping = mapping,
                                    .sound = backend};
    fixture_must(live_start(&d->live, &settings, &err), &err);
    assert_true(live_read_view(d->live, &d->view));
    size_t size = (size_t)d->view->vertex_count * 3 * sizeof *d->first;
    d->first = malloc(size);
    assert_non_null(d->first);
    memcpy(d->first, d->view->position, size);
}

static inline void fixture_start(live_fixture *d, const char *name, const char *mapping,
                                 fixture_record records)
{
    fixture_start_heard(d, name, mapping, records, NULL);
}

static inline void fixture_stop_live(live_fixture *d)
{
    error err = {""};
    if (d->live)
        fixture_must(live_stop(d->live, &err), &err);
    d->live = NULL;
}

static inline void fixture_finish(live_fixture *d)
{
    char path[FIXTURE_PATH + 8];
    static const char *const endings[] = {"", "-wal", "-shm", "-lock", ".lock"};
    fixture_stop_live(d);
    show_close(d->show);
    face_file_destroy(&d->face);
    plugin_list_destroy(&d->plugins);
    log_queue_destroy(d->log);
    free(d->first);
    for (size_t i = 0; i < sizeof endings / sizeof *endings; ++i) {
        snprintf(path, sizeof path, "%s%s", d->show_path, endings[i]);
        (void)unlink(path);
    }
    (void)rmdir(d->folder);
}

/* ---- inputs ---- */

/* Opens it and brings it onto the stage. */
static inline mrt_result fixture_add_input(live_fixture *d, const char *text, error *err)
{
    input *made = NULL;
    plugin_spec of;
    const mrt_plugin_type *type;
    mrt_result result = MRT_OK;
    if (!plugin_spec_read(&of, text))
        result = error_set(err, MRT_ERR_ARGUMENT, "%s names no plugin", text);
    if (result >= 0)
        result = plugin_list_find(&d->plugins, of.plugin, MRT_INPUT, &type, err);
    if (result >= 0)
        result = input_create(&made, type, of.address, of.params, CLOCK_REAL, d->log, err);
    plugin_spec_finish(&of);
    return result < 0 ? result : live_add_input(d->live, made, text, err);
}

/* ---- time ---- */

/* A drawn frame of the window. */
static inline void fixture_frame(live_fixture *d)
{
    live_update(d->live);
    (void)live_read_view(d->live, &d->view);
    clock_sleep_until_ns(clock_now_ns() + 4 * NS_PER_MS);
}

typedef bool fixture_condition(live_fixture *d, void *data);

/* Frames until it holds; false: it did not within FIXTURE_PATIENCE_S. */
static inline bool fixture_until(live_fixture *d, fixture_condition *holds, void *data)
{
    int64_t until_ns = clock_now_ns() + FIXTURE_PATIENCE_S * NS_PER_S;
    while (!holds(d, data)) {
        if (clock_now_ns() > until_ns)
            return false;
        fixture_frame(d);
    }
    return true;
}

static inline void fixture_pass(live_fixture *d, double seconds)
{
    int64_t until_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    while (clock_now_ns() < until_ns)
        fixture_frame(d);
}

static inline bool fixture_is_performed(live_fixture *d, void *data)
{
    const int64_t *until_ns = data;
    return d->view->sample_ns >= *until_ns;
}

/* Until a sample is seen that was measured so much later than now; something must move. */
static inline void fixture_perform(live_fixture *d, double seconds)
{
    int64_t until_ns = clock_now_ns() + (int64_t)(seconds * 1e9);
    if (!fixture_until(d, fixture_is_performed, &until_ns))
        fail_msg("no sample was performed for %d s", FIXTURE_PATIENCE_S);
}

/* ---- the face ---- */

static inline uint32_t fixture_contact(const live_fixture *d, const char *name)
{
    for (uint32_t i = 0; i < d->view->about->contact_count; ++i)
        if (strcmp(d->view->about->contacts[i].name, name) == 0)
            return i;
    fail_msg("no contact %s", name);
    return 0;
}

static inline vec3 fixture_rest(const live_fixture *d, uint32_t contact)
{
    mrt_vec3 r = d->view->about->contacts[contact].rest;
    return (vec3){(double)r.x, (double)r.y, (double)r.z};
}

/* How far a contact is from its rest. */
static inline double fixture_moved_mm(const live_fixture *d, uint32_t contact)
{
    return vec3_length(vec3_sub(d->view->contact[contact], fixture_rest(d, contact)));
}

/* How far any vertex is from where it was in `rows`. */
static inline double fixture_apart_mm(const live_fixture *d, const float *rows)
{
    double most = 0.0;
    for (size_t v = 0; v < d->view->vertex_count; ++v) {
        double sum = 0.0;
        for (size_t k = 0; k < 3; ++k) {
            double way = (double)d->view->position[3 * v + k] - (double)rows[3 * v + k];
            sum += way * way;
        }
        most = fmax(most, sum);
    }
    return sqrt(most);
}

static inline uint64_t fixture_hash(const float *rows, size_t count)
{
    const unsigned char *bytes = (const unsigned char *)rows;
    uint64_t hash = 1469598103934665603u;
    for (size_t i = 0; i < count * sizeof *rows; ++i)
        hash = (hash ^ bytes[i]) * 1099511628211u;
    return hash;
}

static inline bool fixture_is_at_rest(live_fixture *d, void *data)
{
    (void)data;
    return fixture_apart_mm(d, d->first) < 1e-3;
}

/* ---- the mouse ---- */

static inline void fixture_point(live_fixture *d, pointer_grip grip, vec3 rest, vec3 at, bool stays)
{
    const float r[3] = {(float)rest.x, (float)rest.y, (float)rest.z};
    const float a[3] = {(float)at.x, (float)at.y, (float)at.z};
    live_point(d->live, grip, r, a, stays, 0.0);
}

/* What springs back has done so. */
static inline void fixture_let_go(live_fixture *d)
{
    const vec3 nowhere = {0, 0, 0};
    fixture_point(d, POINTER_AWAY, nowhere, nowhere, false);
    fixture_perform(d, 0.3);
}

/* Takes hold of a contact and pulls it so far, in steps. */
static inline void fixture_drag(live_fixture *d, pointer_grip grip, uint32_t contact, vec3 way,
                                bool stays)
{
    vec3 rest = fixture_rest(d, contact), from = d->view->contact[contact];
    fixture_point(d, grip, rest, from, stays);
    for (int i = 1; i <= 20; ++i) {
        fixture_frame(d);
        fixture_point(d, grip, rest, vec3_add(from, vec3_scale(way, (double)i / 20.0)), stays);
    }
    fixture_perform(d, 0.0);
}

/* ---- takes ---- */

static inline void fixture_take(const live_fixture *d, int64_t id, take *out)
{
    error err = {""};
    if (d->live && d->live->recorder)
        fixture_must(writer_flush(recorder_writer(d->live->recorder), &err), &err);
    fixture_must(edit_store_take(out, d->show, id, &err), &err);
}

#endif
