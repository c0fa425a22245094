/* A take on a live stage: shown, scrubbed, played, looped, performed over. */
#include "window/live_fixture.h"

#include "stage/playback/kept_solver.h"
#include "stage/mapping/taught.h"
#include "stage/playback/sequencer.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

/* A take of two seconds in which the mouse drags the left corner of the mouth. */
static int64_t record_a_drag(live_fixture *d, const char *name, vec3 way)
{
    error err = {""};
    live_status status;
    uint32_t contact = fixture_contact(d, name);
    fixture_must(live_record(d->live, &slate, &err), &err);
    fixture_pass(d, 0.2);
    fixture_drag(d, POINTER_PULLS, contact, way, false);
    fixture_perform(d, 0.8);
    fixture_let_go(d);
    fixture_must(live_record_end(d->live, &err), &err);
    live_status_of(d->live, &status);
    return status.take;
}

static void show_take_on(live_fixture *d, int64_t id, take *out)
{
    error err = {""};
    fixture_take(d, id, out);
    fixture_must(live_show_take(d->live, out, &err), &err);
}

static bool stands_at(live_fixture *d, void *data)
{
    const int64_t *at_ns = data;
    return d->view->mode == LIVE_SHOWS && d->view->at_ns == *at_ns;
}

typedef struct projector { /* the take by itself, apart from the stage */
    show *show;
    sequencer *plays;
    float *rows;
} projector;

static void project(live_fixture *d, const take *t, projector *out)
{
    error err = {""};
    fixture_must(show_open(&out->show, d->show_path, SHOW_READ, &err), &err);
    const sequencer_settings settings = {
        .show = out->show, .plugins = &d->plugins, .log = d->log, .face = &d->face};
    fixture_must(sequencer_create(&out->plays, &settings, t, &err), &err);
    out->rows = malloc((size_t)d->view->vertex_count * 3 * sizeof *out->rows);
}

static uint64_t projected(live_fixture *d, projector *of, int64_t at_ns)
{
    error err = {""};
    composer *shown = sequencer_performer(of->plays)->composer;
    fixture_must(sequencer_play_to(of->plays, at_ns, &err), &err);
    composer_draw(shown);
    points_to_rows(of->rows, face_shown(composer_face(shown)), face_order(composer_face(shown)));
    return fixture_hash(of->rows, (size_t)d->view->vertex_count * 3);
}

typedef struct expected {
    int64_t at_ns;
    uint64_t hash;
} expected;

static bool shows(live_fixture *d, void *data)
{
    const expected *e = data;
    return d->view->mode == LIVE_SHOWS && d->view->at_ns == e->at_ns &&
           fixture_hash(d->view->position, (size_t)d->view->vertex_count * 3) == e->hash;
}

static bool is_pulled(live_fixture *d, void *data)
{
    return fixture_moved_mm(d, *(const uint32_t *)data) > 3.0;
}

static bool performs_at_rest(live_fixture *d, void *data)
{
    return d->view->mode == LIVE_PERFORMS && fixture_is_at_rest(d, data);
}

static bool has_eased(live_fixture *d, void *data)
{
    const int64_t *from_ns = data;
    return d->view->published_ns > *from_ns + NS_PER_S * 3 / 10 ||
           clock_now_ns() > *from_ns + 2 * NS_PER_S;
}

/* What eases over, from a change of now, has eased. */
static void ease(live_fixture *d)
{
    int64_t now_ns = clock_now_ns();
    assert_true(fixture_until(d, has_eased, &now_ns));
}

static void pack_up(projector *of)
{
    sequencer_destroy(of->plays);
    show_close(of->show);
    free(of->rows);
}

static void shown_take_stands_where_it_is_sought(void **state)
{
    (void)state;
    live_fixture d;
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    show_take_on(&d, id, &t);
    assert_int_equal(live_shown_take(d.live), id);
    const int64_t instants[] = {t.duration_ns / 2, t.duration_ns / 4, t.duration_ns * 3 / 4, 0};
    projector alone;
    project(&d, &t, &alone);
    for (size_t i = 0; i < 4; ++i) {
        expected e = {instants[i], projected(&d, &alone, instants[i])};
        live_seek(d.live, instants[i]);
        if (!fixture_until(&d, shows, &e))
            fail_msg("instant %u of the take is not shown as it was recorded", (unsigned)i);
    }
    pack_up(&alone);
    for (int64_t i = 0; i <= 100; ++i) /* scrubbing: only the last one counts */
        live_seek(d.live, t.duration_ns * i / 100);
    assert_true(fixture_until(&d, stands_at, &t.duration_ns));
    live_show_hands(d.live);
    assert_true(fixture_until(&d, performs_at_rest, NULL));
    assert_int_equal(live_shown_take(d.live), 0);
    take_finish(&t);
    fixture_finish(&d);
}

static void take_is_solved_as_its_show_says_wherever_it_plays(void **state)
{
    (void)state;
    live_fixture d;
    take t = {0};
    error err = {""};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    const kept_solver kept = {true, {.kernel = CSRBF_WENDLAND_C6, .polynomial = CSRBF_CONSTANT}};
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    fixture_must(live_set_solver(d.live, &kept.as, &err), &err);
    show_take_on(&d, id, &t);
    projector before, after;
    project(&d, &t, &before);
    fixture_must(kept_solver_write(d.show, &kept, &err), &err);
    project(&d, &t, &after);
    expected e = {t.duration_ns / 2, projected(&d, &after, t.duration_ns / 2)};
    live_seek(d.live, e.at_ns);
    assert_true(fixture_until(&d, shows, &e));
    (void)projected(&d, &before, e.at_ns);
    double most_mm = 0.0;
    for (size_t i = 0; i < (size_t)d.view->vertex_count * 3; ++i)
        most_mm = fmax(most_mm, fabs((double)before.rows[i] - (double)after.rows[i]));
    assert_true(most_mm > 0.5);
    fixture_must(kept_solver_write(d.show, &(kept_solver){.is_kept = false}, &err), &err);
    kept_solver none;
    fixture_must(kept_solver_read(&none, d.show, &err), &err);
    assert_false(none.is_kept);
    fixture_must(show_note_write(d.show, "solver", "thin_plate none 3", &err), &err);
    assert_true(kept_solver_read(&none, d.show, &err) < 0);
    assert_true(strstr(err.text, "solver \"thin_plate none 3\" is unknown") != NULL);
    pack_up(&before);
    pack_up(&after);
    take_finish(&t);
    fixture_finish(&d);
}

static void take_plays_to_its_end_and_loops(void **state)
{
    (void)state;
    live_fixture d;
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    show_take_on(&d, id, &t);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    double most_mm = 0.0;
    int64_t until_ns = clock_now_ns() + 20 * NS_PER_S;
    live_play(d.live);
    while (!live_position(d.live).has_stopped && clock_now_ns() < until_ns) {
        fixture_frame(&d);
        most_mm = fmax(most_mm, fixture_moved_mm(&d, corner));
    }
    assert_true(live_position(d.live).has_stopped);
    assert_true(most_mm > 5.0);
    int64_t in_ns = t.duration_ns / 4, out_ns = t.duration_ns / 2;
    live_set_loop(d.live, in_ns, out_ns);
    live_seek(d.live, in_ns);
    live_play(d.live);
    while (live_position(d.live).pass < 2 && clock_now_ns() < until_ns) {
        fixture_frame(&d);
        assert_true(live_position(d.live).at_ns < out_ns);
    }
    assert_true(live_position(d.live).pass >= 2);
    live_set_loop(d.live, 0, 0);
    live_pause(d.live);
    live_seek(d.live, 0);
    live_step_frames(d.live, 3);
    int64_t third_ns = 100 * NS_PER_MS;
    assert_true(fixture_until(&d, stands_at, &third_ns));
    take_finish(&t);
    fixture_finish(&d);
}

/* What stays on the face at the end of a take is still there when it has been played. */
static void at_its_end_a_take_shows_what_it_ends_with(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    live_status status;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_drag(&d, POINTER_PULLS, corner, (vec3){0, 6, 2}, true);
    fixture_let_go(&d);
    fixture_must(live_record_end(d.live, &err), &err);
    live_status_of(d.live, &status);
    show_take_on(&d, status.take, &t);
    live_seek(d.live, t.duration_ns);
    assert_true(fixture_until(&d, stands_at, &t.duration_ns));
    assert_true(fixture_until(&d, is_pulled, &corner));
    live_seek(d.live, 0);
    live_play(d.live);
    int64_t until_ns = clock_now_ns() + 20 * NS_PER_S;
    while (!live_position(d.live).has_stopped && clock_now_ns() < until_ns)
        fixture_frame(&d);
    assert_true(live_position(d.live).has_stopped);
    assert_true(fixture_until(&d, stands_at, &t.duration_ns));
    assert_true(fixture_until(&d, is_pulled, &corner));
    take_finish(&t);
    fixture_finish(&d);
}

static void hands_are_recorded_while_a_take_is_shown(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0}, kept = {0};
    int64_t kept_id;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    show_take_on(&d, id, &t);
    ease(&d);
    uint64_t shown = fixture_hash(d.view->position, (size_t)d.view->vertex_count * 3);
    uint32_t right = fixture_contact(&d, "mouth.corner.r");
    fixture_drag(&d, POINTER_PULLS, right, (vec3){0, -5, 0}, false);
    assert_true(shown == fixture_hash(d.view->position, (size_t)d.view->vertex_count * 3));
    fixture_must(
        live_keep(d.live, clock_now_ns() - NS_PER_S / 10, clock_now_ns(), &slate, &kept_id, &err),
        &err);
    fixture_let_go(&d);
    fixture_take(&d, kept_id, &kept);
    projector alone;
    project(&d, &kept, &alone);
    assert_true(projected(&d, &alone, kept.duration_ns - 1) != shown);
    pack_up(&alone);
    take_finish(&kept);
    take_finish(&t);
    fixture_finish(&d);
}

/* ---- over it ---- */

typedef struct film_frame {
    int64_t at_ns;
    uint64_t hash;
} film_frame;
enum { FRAMES_MAX = 4096 };

static void apply_edits(live_fixture *d, take *t, edit *edits, uint32_t count)
{
    error err = {""};
    for (uint32_t i = 0; i < count; ++i) {
        fixture_must(edit_apply(t, &edits[i], &err), &err);
        edit_finish(&edits[i]);
    }
    free(edits);
    (void)d;
}

static void what_is_performed_over_plays_as_it_was_seen(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    edit *edits;
    uint32_t count, frames = 0, compared = 0;
    film_frame *frame = calloc(FRAMES_MAX, sizeof *frame);
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    /* something stays on the live face: it is not to be in what is performed over the take */
    fixture_drag(&d, POINTER_PULLS, fixture_contact(&d, "chin"), (vec3){0, -3, 0}, true);
    fixture_let_go(&d);
    show_take_on(&d, id, &t);
    ease(&d);
    const overdub_plan over = {.passes = 1};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    uint32_t right = fixture_contact(&d, "mouth.corner.r");
    vec3 rest = fixture_rest(&d, right);
    int64_t until_ns = clock_now_ns() + 1300 * NS_PER_MS;
    double step = 0.0;
    while (clock_now_ns() < until_ns || frames < 10) {
        step = fmin(step + 0.1, 6.0);
        if (step > 1.0)
            fixture_point(&d, POINTER_PULLS, rest, vec3_add(rest, (vec3){-step, step, 0}), false);
        fixture_frame(&d);
        bool is_new = frames == 0 || frame[frames - 1].at_ns != d.view->at_ns;
        if (d.view->mode != LIVE_OVERDUBS || !is_new || frames == FRAMES_MAX)
            continue;
        frame[frames].at_ns = d.view->at_ns;
        frame[frames++].hash = fixture_hash(d.view->position, (size_t)d.view->vertex_count * 3);
    }
    live_status status;
    live_status_of(d.live, &status);
    assert_true(status.is_recording);
    fixture_must(live_record_end(d.live, &err), &err);
    fixture_point(&d, POINTER_AWAY, rest, rest, false);
    if (!live_overdub_edits(d.live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    assert_true(count >= 2);
    apply_edits(&d, &t, edits, count);
    assert_int_equal(t.layer_count, 2);
    projector alone;
    project(&d, &t, &alone);
    for (uint32_t i = 0; i < frames; ++i) {
        if (frame[i].at_ns < t.layer[1].clip[0].start_ns ||
            frame[i].at_ns >= t.layer[1].clip[0].end_ns)
            continue;
        compared += 1;
        if (projected(&d, &alone, frame[i].at_ns) != frame[i].hash)
            fail_msg("face %u of %u, at %.4f s, is another one", i, frames,
                     (double)frame[i].at_ns / 1e9);
    }
    pack_up(&alone);
    assert_true(compared > frames / 2);
    assert_false(live_overdub_edits(d.live, &edits, &count, &err));
    fixture_must(live_show_take(d.live, &t, &err), &err);
    ease(&d);
    assert_int_equal(d.view->mode, LIVE_SHOWS);
    free(frame);
    take_finish(&t);
    fixture_finish(&d);
}

static bool has_performed(live_fixture *d, void *data)
{
    live_status status;
    live_status_of(d->live, &status);
    return status.sample_count > *(const uint64_t *)data;
}

static void let_perform(live_fixture *d, uint64_t samples)
{
    live_status status;
    live_status_of(d->live, &status);
    uint64_t until = status.sample_count + samples;
    assert_true(fixture_until(d, has_performed, &until));
}

static void add_hand(live_fixture *d)
{
    char text[FIXTURE_PATH + 64];
    error err = {""};
    snprintf(text, sizeof text, "log:%s/plugins/log/demo_hand.csv,loop=1", SOURCE_DIR);
    fixture_must(fixture_add_input(d, text, &err), &err);
}

/* ---- plugins are called where plugin.h says ---- */

enum { SPIED_MAX = 256, SHORT_TAKES = 20 };
static struct {
    const mrt_plugin_type *real;
    live *on;
    _Atomic(mrt_plugin *) instance[SPIED_MAX];
    _Atomic uint32_t inside[SPIED_MAX]; /* calls into it now */
    _Atomic uint32_t made, main_calls, main_on_frame_thread, overlaps;
} spied;

static uint32_t enter(mrt_plugin *self)
{
    uint32_t i = 0;
    while (i < SPIED_MAX - 1 && atomic_load(&spied.instance[i]) != self)
        i += 1;
    if (atomic_fetch_add(&spied.inside[i], 1) > 0 && i < SPIED_MAX - 1)
        atomic_fetch_add(&spied.overlaps, 1);
    return i;
}

static void leave(uint32_t at)
{
    atomic_fetch_sub(&spied.inside[at], 1);
}

static void note_main(void)
{
    atomic_fetch_add(&spied.main_calls, 1);
    if (spied.on && pthread_equal(pthread_self(), spied.on->thread))
        atomic_fetch_add(&spied.main_on_frame_thread, 1);
}

static mrt_plugin *spied_create(const mrt_host *host)
{
    note_main();
    mrt_plugin *self = spied.real->create(host);
    uint32_t i = atomic_fetch_add(&spied.made, 1);
    if (i < SPIED_MAX - 1)
        atomic_store(&spied.instance[i], self);
    return self;
}

static void spied_destroy(mrt_plugin *self)
{
    note_main();
    uint32_t at = enter(self);
    spied.real->destroy(self);
    atomic_store(&spied.instance[at], NULL); /* its memory may become another one's */
    leave(at);
}

static const mrt_mapping *real_mapping(void)
{
    return plugin_interface(spied.real, MRT_MAPPING);
}

static mrt_result spied_activate(mrt_plugin *self, const mrt_face *about)
{
    note_main();
    uint32_t at = enter(self);
    mrt_result result = real_mapping()->activate(self, about);
    leave(at);
    return result;
}

static void spied_deactivate(mrt_plugin *self)
{
    note_main();
    uint32_t at = enter(self);
    real_mapping()->deactivate(self);
    leave(at);
}

static void spied_reset(mrt_plugin *self)
{
    uint32_t at = enter(self);
    real_mapping()->reset(self);
    leave(at);
}

static mrt_result spied_process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    uint32_t at = enter(self);
    mrt_result result = real_mapping()->process(self, frame, pull);
    leave(at);
    return result;
}

static size_t spied_save(mrt_plugin *self, void *out, size_t capacity)
{
    const mrt_state *real = plugin_interface(spied.real, MRT_STATE);
    uint32_t at = enter(self);
    size_t size = real->save(self, out, capacity);
    leave(at);
    return size;
}

static mrt_result spied_load(mrt_plugin *self, const void *bytes, size_t size)
{
    const mrt_state *real = plugin_interface(spied.real, MRT_STATE);
    uint32_t at = enter(self);
    mrt_result result = real->load(self, bytes, size);
    leave(at);
    return result;
}

static size_t spied_resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    const mrt_resume *real = plugin_interface(spied.real, MRT_RESUME);
    uint32_t at = enter(self);
    size_t size = real->save(self, out, capacity);
    leave(at);
    return size;
}

static mrt_result spied_resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    const mrt_resume *real = plugin_interface(spied.real, MRT_RESUME);
    uint32_t at = enter(self);
    mrt_result result = real->load(self, bytes, size);
    leave(at);
    return result;
}

static void spy_on(live_fixture *d, mrt_plugin_type *spy)
{
    static const mrt_mapping mapping = {spied_activate, spied_deactivate, spied_reset,
                                        spied_process};
    static const mrt_state kept = {spied_save, spied_load};
    static const mrt_resume resume = {spied_resume_save, spied_resume_load};
    static const mrt_interface all[] = {
        {MRT_MAPPING, &mapping}, {MRT_STATE, &kept}, {MRT_RESUME, &resume}, {NULL, NULL}};
    memset(&spied, 0, sizeof spied);
    for (uint32_t i = 0; i < d->plugins.entry_count; ++i)
        if (strcmp(d->plugins.entry[i].type->id, "org.marotte.one_hand") == 0) {
            spied.real = d->plugins.entry[i].type;
            *spy = *spied.real;
            d->plugins.entry[i].type = spy;
        }
    spy->create = spied_create;
    spy->destroy = spied_destroy;
    spy->interfaces = all;
    spied.on = d->live;
}

/* A take of `count` clips one after the other, each of a performance of its own. */
static void make_a_mosaic(live_fixture *d, uint32_t count, take *out)
{
    error err = {""};
    live_status status;
    for (uint32_t i = 0; i < count; ++i) {
        take t = {0};
        fixture_must(live_record(d->live, &slate, &err), &err);
        fixture_perform(d, 0.08);
        fixture_must(live_record_end(d->live, &err), &err);
        fixture_must(live_cast_restart(d->live, &err), &err);
        live_status_of(d->live, &status);
        fixture_take(d, status.take, i == 0 ? out : &t);
        if (i == 0)
            continue;
        const take_clip *c = &t.layer[0].clip[0];
        assert_true(c->performance != out->layer[0].clip[out->layer[0].clip_count - 1].performance);
        edit e;
        edit_init(&e, EDIT_CLIP_ADD);
        e.layer = out->layer[0].id;
        e.performance = c->performance;
        e.from_ns = c->from_ns;
        e.to_ns = c->to_ns;
        e.source_ns = 0;
        e.start_ns = out->duration_ns;
        e.end_ns = out->duration_ns + 50 * NS_PER_MS;
        fixture_must(edit_apply(out, &e, &err), &err);
        edit_finish(&e);
        take_finish(&t);
    }
    assert_int_equal(out->layer[0].clip_count, count);
}

static void plugins_are_called_on_threads_that_may_and_one_at_a_time(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0}, mosaic = {0};
    live_status status;
    mrt_plugin_type spy = {0};
    fixture_start(&d, "puppet", "", FIXTURE_SHOW);
    spy_on(&d, &spy);
    fixture_must(live_set_mapping(d.live, "one_hand", &err), &err);
    add_hand(&d);
    make_a_mosaic(&d, SHORT_TAKES, &mosaic);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    show_take_on(&d, id, &t);
    uint32_t made = spied.made;
    for (int i = 0; i < 6; ++i) { /* there and back */
        int64_t at_ns = i % 2 ? t.duration_ns * 3 / 4 : 10 * NS_PER_MS;
        live_seek(d.live, at_ns);
        assert_true(fixture_until(&d, stands_at, &at_ns));
    }
    const take *over_which[] = {&t, &mosaic};
    for (int i = 0; i < 2; ++i) {
        fixture_must(live_show_take(d.live, over_which[i], &err), &err);
        const overdub_plan over = {.in_ns = over_which[i]->duration_ns / 5,
                                   .out_ns = over_which[i]->duration_ns * 4 / 5,
                                   .passes = 2,
                                   .name = "again"};
        fixture_must(live_overdub_start(d.live, &over, &err), &err);
        int64_t until_ns = clock_now_ns() + 20 * NS_PER_S;
        do {
            fixture_frame(&d);
            live_status_of(d.live, &status);
        } while (status.is_recording && clock_now_ns() < until_ns);
        assert_false(status.is_recording);
    }
    live_show_hands(d.live);
    live_neutral(d.live);
    let_perform(&d, 20);
    assert_true(spied.made >= made + SHORT_TAKES / 2); /* a replay for each clip that was shown */
    assert_true(spied.made < SPIED_MAX && spied.main_calls > 2 * spied.made);
    spied.on = NULL;
    assert_int_equal(spied.main_on_frame_thread, 0);
    assert_int_equal(spied.overlaps, 0);
    take_finish(&t);
    take_finish(&mosaic);
    fixture_finish(&d);
    assert_int_equal(spied.overlaps, 0);
}

static void recording_over_ends_by_itself_at_its_out(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    edit *edits = NULL;
    uint32_t count = 0;
    live_status status;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    show_take_on(&d, id, &t);
    const overdub_plan over = {
        .in_ns = 200 * NS_PER_MS, .out_ns = 600 * NS_PER_MS, .passes = 2, .name = "again"};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    uint32_t right = fixture_contact(&d, "mouth.corner.r");
    vec3 rest = fixture_rest(&d, right);
    int64_t until_ns = clock_now_ns() + 20 * NS_PER_S;
    do {
        fixture_point(&d, POINTER_PULLS, rest, vec3_add(rest, (vec3){-4, 4, 0}), false);
        fixture_frame(&d);
        live_status_of(d.live, &status);
    } while (status.is_recording && clock_now_ns() < until_ns);
    assert_false(status.is_recording);
    if (!live_overdub_edits(d.live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    apply_edits(&d, &t, edits, count);
    assert_int_equal(t.layer_count, 3);
    assert_string_equal(t.layer[2].name, "again 2");
    assert_true(t.layer[1].is_muted);
    assert_false(t.layer[2].is_muted);
    take_finish(&t);
    fixture_finish(&d);
}

/* ---- what a mapping was taught ---- */

static void add_poses(live_fixture *d)
{
    char path[FIXTURE_PATH];
    error err = {""};
    snprintf(path, sizeof path, "%s/plugins/poses.so", BUILD_DIR);
    fixture_must(plugin_list_add(&d->plugins, path, &err), &err);
    fixture_must(live_set_mapping(d->live, "poses", &err), &err);
    add_hand(d);
    let_perform(d, 60);
}

static void press(live_fixture *d, const char *group)
{
    instance *mapping = live_mapping(d->live);
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].group, group) == 0 &&
            mapping->type->params[i].flags & MRT_PARAM_TRIGGER) {
            instance_trigger(mapping, i);
            return;
        }
    fail_msg("%s has no button to teach", mapping->type->id);
}

enum { NOTE = 2 * TAUGHT_BYTES_MAX + 1 };

static char *note_of(live_fixture *d)
{
    error err = {""};
    char *out = calloc(NOTE, 1);
    live_cast_keep_taught(d->live);
    fixture_must(show_note_read(d->show, "taught.org.marotte.poses", out, NOTE, &err), &err);
    return out;
}

static void what_was_taught_stays_with_the_take_and_the_show(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    take t = {0};
    edit *edits;
    uint32_t count, frames = 0, compared = 0;
    film_frame *frame = calloc(FRAMES_MAX, sizeof *frame);
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){0, 6, 2});
    add_poses(&d);
    char *shipped = note_of(&d);
    press(&d, "Teach");
    let_perform(&d, 30);
    char *taught = note_of(&d);
    assert_true(taught[0] && strcmp(taught, shipped) != 0);
    live_neutral(d.live); /* which resets the mapping */
    let_perform(&d, 100);
    char *after_reset = note_of(&d);
    assert_string_equal(after_reset, taught);
    show_take_on(&d, id, &t);
    ease(&d);
    const overdub_plan over = {.passes = 1};
    fixture_must(live_overdub_start(d.live, &over, &err), &err);
    int64_t until_ns = clock_now_ns() + 1000 * NS_PER_MS;
    while (clock_now_ns() < until_ns || frames < 10) {
        fixture_frame(&d);
        bool is_new = frames == 0 || frame[frames - 1].at_ns != d.view->at_ns;
        if (d.view->mode != LIVE_OVERDUBS || !is_new || frames == FRAMES_MAX)
            continue;
        frame[frames].at_ns = d.view->at_ns;
        frame[frames++].hash = fixture_hash(d.view->position, (size_t)d.view->vertex_count * 3);
    }
    fixture_must(live_record_end(d.live, &err), &err);
    if (!live_overdub_edits(d.live, &edits, &count, &err))
        fail_msg("nothing was performed: %s", err.text);
    apply_edits(&d, &t, edits, count);
    projector alone;
    project(&d, &t, &alone);
    for (uint32_t i = 0; i < frames; ++i) {
        if (frame[i].at_ns < t.layer[1].clip[0].start_ns ||
            frame[i].at_ns >= t.layer[1].clip[0].end_ns)
            continue;
        compared += 1;
        if (projected(&d, &alone, frame[i].at_ns) != frame[i].hash)
            fail_msg("face %u of %u, at %.4f s, is another one", i, frames,
                     (double)frame[i].at_ns / 1e9);
    }
    assert_true(compared > frames / 2);
    pack_up(&alone);
    char *after_over = note_of(&d);
    assert_string_equal(after_over, taught);
    /* Another session of the show. */
    fixture_stop_live(&d);
    const live_settings settings = {.plugins = &d.plugins,
                                    .log = d.log,
                                    .show = d.show,
                                    .face = &d.face,
                                    .face_path = d.face_path,
                                    .mapping = "poses"};
    fixture_must(live_start(&d.live, &settings, &err), &err);
    char *another_session = note_of(&d);
    assert_string_equal(another_session, taught);
    free(shipped), free(taught), free(after_reset), free(after_over), free(another_session);
    free(frame);
    take_finish(&t);
    fixture_finish(&d);
}

/* As a preset does it. */
static void what_is_taught_anew_is_recorded_with_it(void **state)
{
    (void)state;
    static unsigned char shipped[TAUGHT_BYTES_MAX], taught[TAUGHT_BYTES_MAX], now[TAUGHT_BYTES_MAX];
    live_fixture d;
    error err = {""};
    take t = {0};
    live_status status;
    projector alone;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    add_poses(&d);
    size_t size = live_taught(d.live, shipped, sizeof shipped);
    assert_true(size > 0 && size <= sizeof shipped);
    press(&d, "Teach");
    let_perform(&d, 30);
    assert_int_equal(live_taught(d.live, taught, sizeof taught), size);
    assert_memory_not_equal(taught, shipped, size);
    fixture_must(live_teach(d.live, shipped, size, &err), &err);
    assert_int_equal(live_taught(d.live, now, sizeof now), size);
    assert_memory_equal(now, shipped, size);
    /* What makes no sense is refused, and changes nothing. */
    assert_true(live_teach(d.live, taught, size / 2, &err) < 0);
    assert_non_null(strstr(err.text, "org.marotte.poses"));
    fixture_must(live_teach(d.live, taught, size, &err), &err);
    assert_true(live_teach(d.live, "nonsense", 8, &err) < 0);
    assert_int_equal(live_taught(d.live, now, sizeof now), size);
    assert_memory_equal(now, taught, size);
    let_perform(&d, 60); /* the blend is over */
    fixture_must(live_record(d.live, &slate, &err), &err);
    assert_true(live_teach(d.live, shipped, size, &err) < 0); /* not while a take is recorded */
    let_perform(&d, 60);
    fixture_must(live_record_end(d.live, &err), &err);
    live_status_of(d.live, &status);
    show_take_on(&d, status.take, &t);
    fixture_must(live_teach(d.live, shipped, size, &err), &err);
    /* Whatever it is taught now, the take is performed with what it knew then. */
    project(&d, &t, &alone);
    (void)projected(&d, &alone, t.duration_ns / 2);
    layer *then = sequencer_performer(alone.plays)->voice[0].layer;
    assert_int_equal(taught_save(then->mapping, now, sizeof now), size);
    assert_memory_equal(now, taught, size);
    pack_up(&alone);
    take_finish(&t);
    fixture_finish(&d);
}

/* What the stage was taught is that of the show that is open. */
typedef struct lesson {
    unsigned char bytes[TAUGHT_BYTES_MAX];
    size_t size;
} lesson;

static bool knows(live_fixture *d, void *data)
{
    static lesson now;
    const lesson *wanted = data;
    now.size = live_taught(d->live, now.bytes, sizeof now.bytes);
    return now.size == wanted->size && memcmp(now.bytes, wanted->bytes, now.size) == 0;
}

static void teach_another(live_fixture *d, const lesson *before, lesson *out)
{
    press(d, "Teach");
    let_perform(d, 30);
    out->size = live_taught(d->live, out->bytes, sizeof out->bytes);
    assert_int_equal(out->size, before->size);
    assert_memory_not_equal(out->bytes, before->bytes, out->size);
}

static void open_show(live_fixture *d, show *s)
{
    error err = {""};
    fixture_must(live_set_show(d->live, s, &err), &err);
}

static void each_show_keeps_what_was_taught_in_it(void **state)
{
    (void)state;
    static lesson shipped, here, there;
    live_fixture d;
    error err = {""};
    char path[FIXTURE_PATH];
    show *other;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    add_poses(&d);
    fixture_must(instance_set_text(live_mapping(d.live), "amount", "50", &err), &err);
    shipped.size = live_taught(d.live, shipped.bytes, sizeof shipped.bytes);
    teach_another(&d, &shipped, &here);
    snprintf(path, sizeof path, "%s/other.marotte", d.folder);
    fixture_must(show_create(&other, path, &err), &err);
    open_show(&d, other);
    assert_true(fixture_until(&d, knows, &shipped));
    teach_another(&d, &shipped, &there);
    teach_another(&d, &here, &there);
    open_show(&d, d.show);
    assert_true(fixture_until(&d, knows, &here));
    open_show(&d, other);
    assert_true(fixture_until(&d, knows, &there));
    /* Before it has faded over, what the show before was taught is nobody's else. */
    open_show(&d, d.show);
    open_show(&d, other);
    open_show(&d, d.show);
    assert_true(fixture_until(&d, knows, &here));
    open_show(&d, other);
    assert_true(fixture_until(&d, knows, &there));
    char value[32];
    const instance *mapping = live_mapping(d.live);
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        instance_key(mapping->type, i, value, sizeof value);
        if (strcmp(value, "amount") == 0)
            assert_float_equal(instance_value(mapping, i), 50.0, 1e-9);
    }
    open_show(&d, d.show);
    show_close(other);
    (void)unlink(path);
    fixture_finish(&d);
}

static bool has_noted(live_fixture *d, void *data)
{
    error err = {""};
    char *note = calloc(NOTE, 1);
    fixture_must(show_note_read(d->show, "taught.org.marotte.poses", note, NOTE, &err), &err);
    const bool is_there = strcmp(note, data) == 0;
    free(note);
    return is_there;
}

/* So that it is there after a crash. */
static void what_is_taught_is_in_the_show_soon_after(void **state)
{
    (void)state;
    static lesson shipped, taught;
    live_fixture d;
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    add_poses(&d);
    shipped.size = live_taught(d.live, shipped.bytes, sizeof shipped.bytes);
    teach_another(&d, &shipped, &taught);
    char *wanted = taught_text(taught.bytes, taught.size);
    assert_true(fixture_until(&d, has_noted, wanted));
    free(wanted);
    fixture_finish(&d);
}

/* What is seen of a take stays when the take goes. */
static void seen_face_is_described_by_the_stage_alone(void **state)
{
    (void)state;
    live_fixture d;
    take t = {0};
    int64_t start_ns = 0;
    fixture_start(&d, "puppet", "", FIXTURE_SHOW);
    int64_t id = record_a_drag(&d, "mouth.corner.l", (vec3){4, 3, 2});
    const mrt_face *about = d.view->about;
    show_take_on(&d, id, &t);
    assert_true(fixture_until(&d, stands_at, &start_ns));
    assert_ptr_equal(d.view->about, about);
    take_finish(&t);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shown_take_stands_where_it_is_sought),
        cmocka_unit_test(take_is_solved_as_its_show_says_wherever_it_plays),
        cmocka_unit_test(take_plays_to_its_end_and_loops),
        cmocka_unit_test(at_its_end_a_take_shows_what_it_ends_with),
        cmocka_unit_test(hands_are_recorded_while_a_take_is_shown),
        cmocka_unit_test(what_is_performed_over_plays_as_it_was_seen),
        cmocka_unit_test(plugins_are_called_on_threads_that_may_and_one_at_a_time),
        cmocka_unit_test(recording_over_ends_by_itself_at_its_out),
        cmocka_unit_test(what_was_taught_stays_with_the_take_and_the_show),
        cmocka_unit_test(what_is_taught_anew_is_recorded_with_it),
        cmocka_unit_test(each_show_keeps_what_was_taught_in_it),
        cmocka_unit_test(what_is_taught_is_in_the_show_soon_after),
        cmocka_unit_test(seen_face_is_described_by_the_stage_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
