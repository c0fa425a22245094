/* What works beside the application, by the machine's time: a pad whose buttons it obeys, a process
 * that exports. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "app_fixture.h"
#include "window/app/exporter.h"

#include <fcntl.h>
#include <sys/stat.h>

/* ---- a pad ---- */

/* A pad's button, pressed until it is obeyed: what is down when it is first heard was not pressed.
 */
static bool press_until(room *r, int pad, uint8_t controller, condition *holds)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    for (uint8_t value = 0; clock_now_ns() < end_ns; value = value ? 0 : 127) {
        const uint8_t message[3] = {0xb0, controller, value};
        assert_int_equal(write(pad, message, sizeof message), sizeof message);
        for (int i = 0; i < 10; ++i) {
            app_update(r->app, 0.005);
            if (holds(r->app))
                return true;
            clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
        }
    }
    return false;
}

static bool is_marked(app *of)
{
    return was_said(of, "marker added");
}

static void buttons_of_a_patch_record_mark_and_stop(void **state)
{
    room r;
    char path[96], pad_input[128];
    error err = {0};
    (void)state;
    make_room(&r);
    (void)snprintf(path, sizeof path, "%s/pad", r.folder);
    (void)snprintf(pad_input, sizeof pad_input, "midi:%s", path);
    assert_int_equal(mkfifo(path, 0600), 0);
    const int pad = open(path, O_RDWR | O_NONBLOCK);
    assert_true(pad >= 0);
    const char *const inputs[] = {pad_input};
    const app_options with = {.show_path = r.show,
                              .face_path = puppet,
                              .mapping = "one_hand",
                              .inputs = inputs,
                              .input_count = 1};
    if (open_with(&r, &with, &err) < 0)
        fail_msg("%s", err.text);
    static patch p = {.name = "pad", .count = 3};
    for (int i = 0; i < 3; ++i) {
        p.connection[i] = patch_connection_of(PATCH_ACTION);
        (void)snprintf(p.connection[i].channel, PATCH_NAME, "cc.%d", 20 + i);
        (void)snprintf(p.connection[i].target, PATCH_NAME, "%s", patch_action_names[i]);
    }
    app_set_patch(r.app, &p);
    assert_true(press_until(&r, pad, 20, is_recording));
    assert_true(press_until(&r, pad, 22, is_marked));
    assert_true(until(&r, is_recorded));
    assert_true(press_until(&r, pad, 21, has_ended));
    assert_int_equal(count_takes(r.app), 1);
    assert_true(app_take(r.app)->duration_ns > 200 * NS_PER_MS);
    assert_true(press_until(&r, pad, 20, is_recording)); /* and the next one */
    assert_true(until(&r, is_recorded));
    assert_true(press_until(&r, pad, 21, has_ended));
    assert_int_equal(count_takes(r.app), 2);
    (void)close(pad);
    close_room(&r);
}

/* ---- export ---- */

static bool exports_are_over(app *of)
{
    return exporter_count(app_exporter(of)) == 0;
}

static void a_take_is_exported_beside_the_stage(void **state)
{
    room r;
    export_request request = {.fps = 25.0};
    struct stat info;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    (void)snprintf(request.file, sizeof request.file, "%s/take.pc2", r.folder);
    assert_int_equal(app_export_take(r.app, app_take_id(r.app), &request), MRT_OK);
    assert_true(until(&r, exports_are_over));
    if (stat(request.file, &info) != 0) {
        const news_list *news = app_news(r.app);
        fail_msg("%s", news_list_at(news, news_list_count(news) - 1)->text);
    }
    assert_true(was_said(r.app, "exported"));
    (void)snprintf(request.file, sizeof request.file, "%s/take.nonsense", r.folder);
    assert_int_equal(app_export_take(r.app, app_take_id(r.app), &request), MRT_OK);
    assert_true(until(&r, exports_are_over));
    assert_true(was_said(r.app, "was not exported"));
    close_room(&r);
}

static bool export_is_told(app *of)
{
    return exporter_count(app_exporter(of)) == 0 || exporter_at(app_exporter(of), 0).done > 0.0;
}

static void an_export_says_how_far_it_is_and_is_cancelled(void **state)
{
    room r;
    export_request request = {.fps = 60.0};
    struct stat info;
    (void)state;
    open_room(&r, true);
    record_a_take(&r);
    (void)snprintf(request.file, sizeof request.file, "%s/pictures/", r.folder);
    assert_int_equal(app_export_take(r.app, app_take_id(r.app), &request), MRT_OK);
    assert_int_equal(exporter_count(app_exporter(r.app)), 1);
    assert_string_equal(exporter_at(app_exporter(r.app), 0).file, request.file);
    assert_true(until(&r, export_is_told));
    if (exporter_count(app_exporter(r.app)) == 0) { /* nothing can be drawn here */
        close_room(&r);
        skip();
    }
    assert_string_equal(exporter_at(app_exporter(r.app), 0).doing, "performing");
    exporter_cancel(app_exporter(r.app), 0);
    assert_true(until(&r, exports_are_over));
    assert_true(was_said(r.app, "was cancelled"));
    assert_int_not_equal(stat(request.file, &info), 0);
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buttons_of_a_patch_record_mark_and_stop),
        cmocka_unit_test(a_take_is_exported_beside_the_stage),
        cmocka_unit_test(an_export_says_how_far_it_is_and_is_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
