/* A device that goes away, a disk that is full: the stage goes on. */
#include "window/live_fixture.h"

#include "take/show_disk.h"

static const writer_slate slate = {.scene = "1", .shot = "a"};

/* ---- a device that goes away when a test says so ---- */

static _Atomic bool is_away;

struct mrt_plugin {
    const mrt_host *host;
    uint32_t sequence;
    int64_t next_ns;
};

static mrt_plugin *device_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (self)
        self->host = host;
    return self;
}

static void device_destroy(mrt_plugin *self)
{
    free(self);
}

static mrt_result device_open(mrt_plugin *self, const char *address, const double *params)
{
    (void)address, (void)params;
    self->next_ns = self->host->now_ns(self->host);
    return atomic_load(&is_away) ? MRT_ERR_IO : MRT_OK;
}

static void device_close(mrt_plugin *self)
{
    (void)self;
}

static const mrt_channel *device_channels(mrt_plugin *self, uint32_t *out_count)
{
    static const mrt_channel channel[] = {
        {"thumb", "rad", MRT_CH_ANGLE + 1, MRT_RIGHT, -2.0f, 2.0f},
        {"index", "rad", MRT_CH_ANGLE + 4, MRT_RIGHT, -2.0f, 2.0f},
        {"middle", "rad", MRT_CH_ANGLE + 7, MRT_RIGHT, -2.0f, 2.0f},
        {"ring", "rad", MRT_CH_ANGLE + 11, MRT_RIGHT, -2.0f, 2.0f},
    };
    (void)self;
    *out_count = 4;
    return channel;
}

/* The fingers bend over half a second, and stay bent. */
static mrt_result device_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                              mrt_sample *out)
{
    (void)params;
    if (atomic_load(&is_away))
        return MRT_ERR_IO;
    if (self->next_ns > deadline_ns) {
        (void)self->host->wait_until_ns(self->host, deadline_ns);
        return MRT_TIMEOUT;
    }
    out->time_ns = self->host->wait_until_ns(self->host, self->next_ns);
    self->next_ns = out->time_ns + NS_PER_S / 150;
    out->sequence = self->sequence++;
    out->count = 4;
    float share = fminf((float)out->sequence / 75.0f, 1.0f);
    for (int i = 0; i < 4; ++i)
        out->value[i] = (i == 0 ? 0.4f : -0.4f) * share;
    return MRT_OK;
}

static const mrt_input device_functions = {
    .open = device_open, .channels = device_channels, .read = device_read, .close = device_close};
static const mrt_interface device_interfaces[] = {{MRT_INPUT, &device_functions}, {NULL, NULL}};
static const mrt_plugin_type device_type = {.abi = MRT_ABI,
                                            .interfaces = device_interfaces,
                                            .id = "org.marotte.test.device",
                                            .name = "Device",
                                            .version = "1",
                                            .about = "",
                                            .create = device_create,
                                            .destroy = device_destroy};

static bool is_in_state(live_fixture *d, void *data)
{
    const input_state *state = data;
    return input_state_of(live_input(d->live, 0)) == *state;
}

static void device_that_goes_away_holds_the_pose(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    input *in;
    input_state lost = INPUT_LOST, runs = INPUT_RUNNING;
    atomic_store(&is_away, false);
    fixture_start(&d, "puppet", "one_hand", FIXTURE_SHOW);
    fixture_must(input_create(&in, &device_type, "", "", CLOCK_REAL, d.log, &err), &err);
    input_set_patience_ns(in, 20 * NS_PER_MS, 20 * NS_PER_MS);
    fixture_must(live_add_input(d.live, in, "device", &err), &err);
    fixture_perform(&d, 1.2);
    size_t size = (size_t)d.view->vertex_count * 3;
    assert_true(fixture_apart_mm(&d, d.first) > 1.0);
    fixture_must(live_record(d.live, &slate, &err), &err);
    atomic_store(&is_away, true);
    assert_true(fixture_until(&d, is_in_state, &lost));
    fixture_pass(&d, 0.3); /* what was measured before has come */
    float *held = malloc(size * sizeof *held);
    memcpy(held, d.view->position, size * sizeof *held);
    /* the mouse goes on meanwhile */
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    double before_mm = fixture_moved_mm(&d, corner);
    fixture_drag(&d, POINTER_PULLS, corner, (vec3){0, 4, 0}, false);
    assert_true(fabs(fixture_moved_mm(&d, corner) - before_mm) > 1.0);
    fixture_let_go(&d);
    assert_true(fixture_apart_mm(&d, held) < 1e-3);
    atomic_store(&is_away, false);
    assert_true(fixture_until(&d, is_in_state, &runs));
    fixture_perform(&d, 0.5);
    assert_true(fixture_apart_mm(&d, held) < 1e-2);
    fixture_must(live_record_end(d.live, &err), &err);
    free(held);
    fixture_finish(&d);
}

/* ---- a disk that is full ---- */

static bool is_waiting(live_fixture *d, void *data)
{
    live_status status;
    (void)data;
    live_status_of(d->live, &status);
    return status.writer.state == WRITER_WAITING && status.problem[0] != '\0';
}

static bool is_well(live_fixture *d, void *data)
{
    live_status status;
    (void)data;
    live_status_of(d->live, &status);
    return status.writer.state == WRITER_OK && status.problem[0] == '\0';
}

static void full_disk_stops_nothing_and_loses_nothing(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    live_status status;
    take t = {0};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    fixture_must(live_record(d.live, &slate, &err), &err);
    fixture_pass(&d, 0.2);
    atomic_store(&disk_answer, SQLITE_FULL);
    fixture_drag(&d, POINTER_PULLS, corner, (vec3){0, 4, 0}, false);
    assert_true(fixture_until(&d, is_waiting, NULL));
    assert_true(fabs(fixture_moved_mm(&d, corner) - 4.0) < 0.1);
    live_status_of(d.live, &status);
    assert_true(status.is_recording);
    fixture_let_go(&d);
    fixture_must(live_record_end(d.live, &err), &err);
    atomic_store(&disk_answer, SQLITE_OK);
    assert_true(fixture_until(&d, is_well, NULL));
    live_status_of(d.live, &status);
    assert_int_equal(status.writer.lost_count, 0);
    fixture_take(&d, status.take, &t);
    assert_true(t.duration_ns > NS_PER_S / 5);
    take_finish(&t);
    fixture_finish(&d);
}

static void show_is_deleted_while_it_is_recorded_into(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    fixture_must(live_record(d.live, &slate, &err), &err);
    assert_int_equal(unlink(d.show_path), 0);
    fixture_pass(&d, 0.3);
    fixture_must(live_record_end(d.live, &err), &err);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(device_that_goes_away_holds_the_pose),
        cmocka_unit_test(full_disk_stops_nothing_and_loses_nothing),
        cmocka_unit_test(show_is_deleted_while_it_is_recorded_into),
    };
    disk_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
