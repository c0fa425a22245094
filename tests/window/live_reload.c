/* A mapping that did not come with the program performs on a live stage in a process of its own,
 * and its library is rebuilt meanwhile. */
#include "window/live_desk.h"

static void copy_file(const char *from, const char *to)
{
    char part[DESK_PATH + 8];
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

static bool was_taken(live_desk *d, void *data)
{
    live_status status;
    const uint32_t *count = data;
    live_status_of(d->live, &status);
    if (status.reload_refused > 0)
        fail_msg("the rebuilt mapping was refused");
    return status.reload_taken >= *count;
}

static double value_of(const instance *of, uint32_t param)
{
    return atomic_load(&of->wanted[param]);
}

static void rebuilt_mapping_takes_over_and_keeps_its_parameters(void **state)
{
    (void)state;
    live_desk d;
    error err = {""};
    live_status status;
    char built[DESK_PATH], own[DESK_PATH];
    desk_start(&d, "puppet", NULL, DESK_SHOW);
    snprintf(built, sizeof built, "%s/plugins/poses.so", BUILD_DIR);
    snprintf(own, sizeof own, "%s/poses.so", d.folder);
    copy_file(built, own);
    desk_must(plugin_list_add(&d.plugins, own, &err), &err);
    desk_must(live_set_mapping(d.live, "poses", &err), &err);
    instance *mapping = live_mapping(d.live);
    assert_non_null(mapping);
    const mrt_param *p = &mapping->type->params[0];
    double wanted = p->flags & MRT_PARAM_STEPPED ? p->max : 0.5 * (p->min + p->max);
    atomic_store(&mapping->wanted[0], wanted);
    /* time goes on: something moves */
    uint32_t corner = desk_contact(&d, "mouth.corner.l");
    vec3 rest = desk_rest(&d, corner);
    desk_point(&d, POINTER_PULLS, rest, rest, false);
    desk_perform(&d, 0.5);
    for (uint32_t count = 1; count <= 2; ++count) {
        copy_file(built, own);
        assert_true(desk_until(&d, was_taken, &count));
        mapping = live_mapping(d.live);
        assert_non_null(mapping);
        assert_true(fabs(value_of(mapping, 0) - wanted) < 1e-9);
        desk_perform(&d, 0.4);
    }
    live_status_of(d.live, &status);
    assert_int_equal(status.isolated.failed, 0);
    desk_must(live_set_mapping(d.live, NULL, &err), &err);
    desk_perform(&d, 0.5);
    (void)unlink(own);
    desk_finish(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rebuilt_mapping_takes_over_and_keeps_its_parameters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
