/* No sample allocates: steps 3 to 7 of the frame are counted while a hand performs, engages anew,
 * commits, releases. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "frame_run.h"
#include "stage/mapping/plugins.h"
#include "unit/allocation_count.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GRID = 40, SENSORS = MRT_ANGLES, SAMPLES = 300 };

static void make_face(face_file *file)
{
    error err;
    mesh *out = &file->mesh;
    *file = (face_file){0};
    assert_int_equal(mesh_create(out, GRID * GRID, 2 * (GRID - 1) * (GRID - 1), &err), MRT_OK);
    for (uint32_t i = 0; i < GRID * GRID; ++i) {
        out->position[3 * i] = (float)(i % GRID) * 5.0f;
        out->position[3 * i + 1] = (float)(i / GRID) * 7.0f;
    }
    uint32_t *t = out->triangle;
    for (uint32_t y = 0; y + 1 < GRID; ++y)
        for (uint32_t x = 0; x + 1 < GRID; ++x, t += 6) {
            uint32_t a = y * GRID + x;
            const uint32_t quad[6] = {a, a + 1, a + GRID + 1, a, a + GRID + 1, a + GRID};
            memcpy(t, quad, sizeof quad);
        }
}

static void press(instance *plugin, const char *name)
{
    for (uint32_t i = 0; i < plugin->type->param_count; ++i)
        if (strcmp(plugin->type->params[i].name, name) == 0)
            instance_trigger(plugin, i);
}

static void perform(performer *p, instance *plugin, const channel_route *route)
{
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        mrt_sample sample = {
            .time_ns = (int64_t)i * 10 * NS_PER_MS, .sequence = i, .count = SENSORS};
        for (uint32_t k = 0; k < SENSORS; ++k)
            sample.value[k] = 0.2f + 0.01f * (float)((i * (k + 3)) % 40);
        if (i == 50)
            press(plugin, "Commit");
        if (i == 100)
            press(plugin, "Engage");
        if (i == 150)
            press(plugin, "Release");
        if (i == 200)
            press(plugin, "Engage");
        const sample_step next = sample_step_of(route, &sample);
        frame_run(p, &next);
        if (i % 2)
            composer_draw(p->composer);
    }
}

static void no_sample_allocates(void **state)
{
    (void)state;
    if (!ALLOCATIONS_ARE_COUNTED) {
        print_message("SKIPPED: the sanitizer has an allocator of its own\n");
        skip();
    }
    static const char *const names[] = {"anchored", "unanchored"};
    mrt_channel channels[SENSORS];
    for (uint32_t k = 0; k < SENSORS; ++k)
        channels[k] = (mrt_channel){"angle", "rad", MRT_CH_ANGLE + k, MRT_RIGHT, -3, 3};
    for (int n = 0; n < 2; ++n) {
        char path[1024];
        error err = {""};
        plugin_list list = {0};
        const mrt_plugin_type *type;
        instance plugin;
        performer *p;
        face_file file;
        channel_route route;
        make_face(&file);
        snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, names[n]);
        assert_int_equal(plugin_list_add(&list, path, &err), MRT_OK);
        assert_int_equal(plugin_list_find(&list, names[n], MRT_MAPPING, &type, &err), MRT_OK);
        assert_int_equal(instance_create(&plugin, type, CLOCK_VIRTUAL, NULL, &err), MRT_OK);
        performer_settings settings = {.hand_length_mm = 0};
        assert_int_equal(performer_create(&p, &file, &plugin, &settings, &err), MRT_OK);
        channel_route_init(&route, channels, SENSORS);

        uint64_t before = atomic_load(&allocation_count);
        perform(p, &plugin, &route);
        uint64_t after = atomic_load(&allocation_count);
        const composer_counts *counts = p->counts;
        print_message("%s: %ju samples, %ju engagements, %ju substeps, %ju allocations\n", names[n],
                      (uintmax_t)counts->samples, (uintmax_t)counts->engagements,
                      (uintmax_t)counts->substeps, (uintmax_t)(after - before));
        assert_true(before > 0); /* the count counts */
        assert_int_equal(after - before, 0);
        assert_int_equal(counts->samples, SAMPLES);
        assert_int_equal(counts->bad_pulls + counts->held_pulls, 0);
        assert_int_equal(counts->commits, 1);
        assert_true(n == 1 || counts->engagements == 4);
        assert_true(n == 0 || counts->substeps > SAMPLES / 2);
        performer_destroy(p);
        instance_destroy(&plugin);
        plugin_list_destroy(&list);
        face_file_destroy(&file);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_sample_allocates)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
