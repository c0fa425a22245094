/* A mapping that did not come with the program performs on a live stage in a process of its own,
 * and its library is rebuilt meanwhile. */
#include "window/live_fixture.h"

static void copy_file(const char *from, const char *to)
{
    char part[FIXTURE_PATH + 8];
    char bytes[4096];
    size_t size;
    snprintf(part, sizeof part, "%s.part", to);
    FILE *in = fopen(from, "rb"), *out = fopen(part, "wb");
    assert_non_null(in);
    assert_non_null(out);
    while ((size = fread(bytes, 1, sizeof bytes, in)) > 0)
        assert_int_equal(fwrite(bytes, 1, size, out), size);
    assert_int_equal(fclose(in), 0);
    assert_int_equal(fclose(out), 0);
    assert_int_equal(rename(part, to), 0);
}

typedef struct counts {
    uint32_t taken, refused;
} counts;

static bool is_answered(live_fixture *d, void *data)
{
    live_status status;
    const counts *before = data;
    live_status_of(d->live, &status);
    return status.reload_taken > before->taken || status.reload_refused > before->refused;
}

/* On a busy machine a new version may answer too late and be refused: it is built again. */
static void rebuild(live_fixture *d, const char *built, const char *own)
{
    live_status status;
    live_status_of(d->live, &status);
    const uint32_t taken = status.reload_taken;
    for (int tries = 0; tries < 10 && status.reload_taken == taken; ++tries) {
        counts before = {status.reload_taken, status.reload_refused};
        copy_file(built, own);
        assert_true(fixture_until(d, is_answered, &before));
        live_status_of(d->live, &status);
    }
    assert_int_equal(status.reload_taken, taken + 1);
}

static double value_of(const instance *of, uint32_t param)
{
    return atomic_load(&of->wanted[param]);
}

static void rebuilt_mapping_takes_over_and_keeps_its_parameters(void **state)
{
    (void)state;
    live_fixture d;
    error err = {""};
    char built[FIXTURE_PATH], own[FIXTURE_PATH];
    fixture_start(&d, "puppet", NULL, FIXTURE_SHOW);
    snprintf(built, sizeof built, "%s/plugins/poses.so", BUILD_DIR);
    snprintf(own, sizeof own, "%s/poses.so", d.folder);
    copy_file(built, own);
    fixture_must(plugin_list_add(&d.plugins, own, &err), &err);
    fixture_must(live_set_mapping(d.live, "poses", &err), &err);
    instance *mapping = live_mapping(d.live);
    assert_non_null(mapping);
    const mrt_param *p = &mapping->type->params[0];
    double wanted = p->flags & MRT_PARAM_STEPPED ? p->max : 0.5 * (p->min + p->max);
    atomic_store(&mapping->wanted[0], wanted);
    /* time goes on: something moves */
    uint32_t corner = fixture_contact(&d, "mouth.corner.l");
    vec3 rest = fixture_rest(&d, corner);
    fixture_point(&d, POINTER_PULLS, rest, rest, false);
    fixture_perform(&d, 0.5);
    for (int n = 0; n < 2; ++n) {
        rebuild(&d, built, own);
        mapping = live_mapping(d.live);
        assert_non_null(mapping);
        assert_true(fabs(value_of(mapping, 0) - wanted) < 1e-9);
        fixture_perform(&d, 0.4);
    }
    fixture_must(live_set_mapping(d.live, NULL, &err), &err);
    fixture_perform(&d, 0.5);
    (void)unlink(own);
    fixture_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rebuilt_mapping_takes_over_and_keeps_its_parameters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
