/* The desktop's own file dialog: the window asks a portal on a session bus of the test's own. The
 * portal is played here, on a thread that says what the test tells it to. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

#ifdef MAROTTE_HAS_SDBUS
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>

extern char **environ;

static scene s;

/* ---- a session bus ---- */

typedef struct session {
    char folder[64], address[128];
    pid_t pid;
} session;

static session bus;

/* False: there is no dbus-daemon. */
static bool begin_bus(void)
{
    char config[128], said[256] = "", number[16];
    int ends[2];
    (void)snprintf(bus.folder, sizeof bus.folder, "/tmp/marotte_bus_XXXXXX");
    assert_non_null(mkdtemp(bus.folder));
    (void)snprintf(config, sizeof config, "%s/bus.conf", bus.folder);
    FILE *file = fopen(config, "w");
    assert_non_null(file);
    (void)fprintf(file,
                  "<busconfig><type>session</type><listen>unix:path=%s/bus</listen>"
                  "<policy context=\"default\"><allow send_destination=\"*\" eavesdrop=\"true\"/>"
                  "<allow eavesdrop=\"true\"/><allow own=\"*\"/></policy></busconfig>",
                  bus.folder);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(pipe(ends), 0);
    (void)snprintf(number, sizeof number, "%d", ends[1]);
    char option[160], print[32];
    (void)snprintf(option, sizeof option, "--config-file=%s", config);
    (void)snprintf(print, sizeof print, "--print-address=%s", number);
    char *const words[] = {
        (char[]){"timeout"},     (char[]){"3600"}, /* it outlives no test for long */
        (char[]){"dbus-daemon"}, option,           (char[]){"--nofork"}, print, NULL};
    posix_spawn_file_actions_t quiet;
    posix_spawn_file_actions_init(&quiet);
    posix_spawn_file_actions_addopen(&quiet, STDERR_FILENO, "/dev/null", 1, 0);
    if (posix_spawnp(&bus.pid, "timeout", &quiet, NULL, words, environ) != 0)
        bus.pid = 0;
    posix_spawn_file_actions_destroy(&quiet);
    (void)close(ends[1]);
    const ssize_t length = bus.pid ? read(ends[0], said, sizeof said - 1) : 0; /* it listens */
    (void)close(ends[0]);
    (void)snprintf(bus.address, sizeof bus.address, "unix:path=%s/bus", bus.folder);
    return length > 0;
}

static void end_bus(void)
{
    char command[96];
    if (bus.pid > 0) {
        (void)kill(bus.pid, SIGTERM);
        (void)waitpid(bus.pid, NULL, 0);
    }
    (void)snprintf(command, sizeof command, "rm -rf %s", bus.folder);
    assert_int_equal(system(command), 0);
}

/* ---- the portal's part ---- */

typedef enum behaviour {
    CHOOSES = 0,
    CANCELS,
    FAILS,    /* the dialog ended by itself */
    KEEPS_ON, /* the dialog stays open */
    IS_SILENT /* takes the question, and says nothing, ever */
} behaviour;

typedef struct played {
    behaviour how;
    char uri[600]; /* guarded */
    pthread_mutex_t guard;
    pthread_t thread;
    atomic_bool is_there, is_ending;
    atomic_int asked, closed;
    char member[32], title[64], name[128], folder[256], filters[2048]; /* of the last question */
} played;

static played double_of;

static int on_close(sd_bus_message *m, void *data, sd_bus_error *err)
{
    played *self = data;
    (void)err;
    atomic_fetch_add(&self->closed, 1);
    return sd_bus_reply_method_return(m, NULL);
}

static const sd_bus_vtable request_table[] = {
    SD_BUS_VTABLE_START(0), SD_BUS_METHOD("Close", "", "", on_close, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_SIGNAL("Response", "ua{sv}", 0), SD_BUS_VTABLE_END};

static void read_filters(played *self, sd_bus_message *m)
{
    const char *name, *pattern;
    size_t length = 0;
    uint32_t kind;
    assert_true(sd_bus_message_enter_container(m, 'a', "(sa(us))") >= 0);
    while (sd_bus_message_enter_container(m, 'r', "sa(us)") > 0) {
        assert_true(sd_bus_message_read(m, "s", &name) > 0);
        length +=
            (size_t)snprintf(self->filters + length, sizeof self->filters - length, "%s:", name);
        assert_true(sd_bus_message_enter_container(m, 'a', "(us)") >= 0);
        while (sd_bus_message_read(m, "(us)", &kind, &pattern) > 0)
            length += (size_t)snprintf(self->filters + length, sizeof self->filters - length, " %s",
                                       pattern);
        assert_true(length + 1 < sizeof self->filters);
        self->filters[length++] = '\n';
        (void)sd_bus_message_exit_container(m);
        (void)sd_bus_message_exit_container(m);
    }
    self->filters[length] = '\0';
    (void)sd_bus_message_exit_container(m);
}

static void read_option(played *self, sd_bus_message *m, char token[64])
{
    const char *key, *text, *contents;
    const void *bytes;
    size_t size;
    char type;
    assert_true(sd_bus_message_read(m, "s", &key) > 0);
    assert_true(sd_bus_message_peek_type(m, &type, &contents) > 0);
    assert_true(sd_bus_message_enter_container(m, 'v', contents) > 0);
    if (strcmp(key, "handle_token") == 0 || strcmp(key, "current_name") == 0) {
        assert_true(sd_bus_message_read(m, "s", &text) > 0);
        (void)snprintf(key[0] == 'h' ? token : self->name, key[0] == 'h' ? 64 : sizeof self->name,
                       "%s", text);
    } else if (strcmp(key, "current_folder") == 0) {
        assert_true(sd_bus_message_read_array(m, 'y', &bytes, &size) > 0);
        assert_true(size > 0 && size < sizeof self->folder && !((const char *)bytes)[size - 1]);
        memcpy(self->folder, bytes, size);
    } else if (strcmp(key, "filters") == 0) {
        read_filters(self, m);
    } else {
        assert_true(sd_bus_message_skip(m, contents) >= 0);
    }
    (void)sd_bus_message_exit_container(m);
}

static int on_ask(sd_bus_message *m, void *data, sd_bus_error *err)
{
    played *self = data;
    const char *parent, *title;
    char token[64] = "", sender[64], request[256];
    (void)err;
    assert_true(sd_bus_message_read(m, "ss", &parent, &title) > 0);
    (void)snprintf(self->title, sizeof self->title, "%s", title);
    (void)snprintf(self->member, sizeof self->member, "%s", sd_bus_message_get_member(m));
    assert_true(sd_bus_message_enter_container(m, 'a', "{sv}") >= 0);
    while (sd_bus_message_enter_container(m, 'e', "sv") > 0) {
        read_option(self, m, token);
        (void)sd_bus_message_exit_container(m);
    }
    (void)snprintf(sender, sizeof sender, "%s", sd_bus_message_get_sender(m) + 1);
    for (char *c = sender; *c; ++c)
        *c = *c == '.' ? '_' : *c;
    (void)snprintf(request, sizeof request, "/org/freedesktop/portal/desktop/request/%s/%s", sender,
                   token);
    atomic_fetch_add(&self->asked, 1);
    if (self->how == IS_SILENT)
        return 1;
    sd_bus *on = sd_bus_message_get_bus(m);
    assert_true(sd_bus_add_object_vtable(on, NULL, request, "org.freedesktop.portal.Request",
                                         request_table, self) >= 0);
    assert_true(sd_bus_reply_method_return(m, "o", request) >= 0);
    if (self->how == KEEPS_ON)
        return 1;
    char uri[sizeof self->uri];
    assert_int_equal(pthread_mutex_lock(&self->guard), 0);
    (void)snprintf(uri, sizeof uri, "%s", self->uri);
    assert_int_equal(pthread_mutex_unlock(&self->guard), 0);
    const uint32_t how = self->how == CHOOSES ? 0 : self->how == CANCELS ? 1 : 2;
    sd_bus_message *answer = NULL;
    assert_true(sd_bus_message_new_signal(on, &answer, request, "org.freedesktop.portal.Request",
                                          "Response") >= 0);
    assert_true(sd_bus_message_append(answer, "u", how) >= 0);
    assert_true(how == 0 ? sd_bus_message_append(answer, "a{sv}", 2, "choices", "s", "none", "uris",
                                                 "as", 1, uri) >= 0
                         : sd_bus_message_append(answer, "a{sv}", 0) >= 0);
    assert_true(sd_bus_send_to(on, answer, sd_bus_message_get_sender(m), NULL) >= 0);
    sd_bus_message_unref(answer);
    return 1;
}

static const sd_bus_vtable chooser_table[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("OpenFile", "ssa{sv}", "o", on_ask, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SaveFile", "ssa{sv}", "o", on_ask, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_VTABLE_END};

static void *play(void *data)
{
    played *self = data;
    sd_bus *on = NULL;
    assert_true(sd_bus_new(&on) >= 0);
    assert_true(sd_bus_set_address(on, bus.address) >= 0);
    assert_true(sd_bus_set_bus_client(on, 1) >= 0);
    assert_true(sd_bus_start(on) >= 0);
    assert_true(sd_bus_add_object_vtable(on, NULL, "/org/freedesktop/portal/desktop",
                                         "org.freedesktop.portal.FileChooser", chooser_table,
                                         self) >= 0);
    assert_true(sd_bus_request_name(on, "org.freedesktop.portal.Desktop", 0) >= 0);
    atomic_store(&self->is_there, true);
    while (!atomic_load(&self->is_ending)) {
        const int more = sd_bus_process(on, NULL);
        assert_true(more >= 0);
        if (more == 0)
            (void)sd_bus_wait(on, 10000);
    }
    (void)sd_bus_flush(on);
    sd_bus_close(on);
    sd_bus_unref(on);
    return NULL;
}

static void let_choose(const char *uri)
{
    assert_int_equal(pthread_mutex_lock(&double_of.guard), 0);
    (void)snprintf(double_of.uri, sizeof double_of.uri, "%s", uri);
    assert_int_equal(pthread_mutex_unlock(&double_of.guard), 0);
}

static void begin_portal(behaviour how, const char *uri)
{
    double_of = (played){.how = how, .guard = PTHREAD_MUTEX_INITIALIZER};
    let_choose(uri);
    assert_int_equal(pthread_create(&double_of.thread, NULL, play, &double_of), 0);
    while (!atomic_load(&double_of.is_there))
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
}

static void end_portal(void)
{
    atomic_store(&double_of.is_ending, true);
    assert_int_equal(pthread_join(double_of.thread, NULL), 0);
}

/* ---- the window ---- */

static void open_scene(double wait_s)
{
    const scene_options with = {.width_px = 1280, .height_px = 720, .scale = 1.0f, .has_bus = true};
    scene_open_with(&s, &with);
    settings_set_number(app_settings(s.app), "open.desktop_wait_s", wait_s);
}

static bool has_no_dialog(scene *of, void *data)
{
    (void)data;
    return !ui_has_dialog(of->ui);
}

static bool shows_word(scene *of, void *text)
{
    return scene_word_with(of, text) != NULL;
}

static bool was_asked(scene *of, void *data)
{
    (void)of;
    (void)data;
    return atomic_load(&double_of.asked) > 0;
}

static bool was_closed(scene *of, void *data)
{
    (void)of;
    (void)data;
    return atomic_load(&double_of.closed) > 0;
}

static bool was_closed_twice(scene *of, void *data)
{
    (void)of;
    (void)data;
    return atomic_load(&double_of.closed) == 2;
}

static bool shows_no_word(scene *of, void *text)
{
    return !shows_word(of, text);
}

static char asks_at_all[] = "dialog of the desktop";
static char waits[] = "Opening the dialog of the desktop", asks[] = "Choose the file in the dialog",
            of_list[] = "Shows";

static void what_is_chosen_there_is_opened(void **state)
{
    char path[512], uri[600];
    (void)state;
    scene_face_path(path, "moai");
    (void)snprintf(uri, sizeof uri, "file://%s/%%72igs/moai/moai.rig.json", SOURCE_DIR);
    begin_portal(CHOOSES, uri);
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, has_no_dialog, NULL));
    end_portal();
    assert_string_equal(app_face_path(s.app), path);
    assert_string_equal(double_of.member, "OpenFile");
    assert_string_equal(double_of.title, "Open");
    assert_int_equal(strncmp(double_of.filters, "All: *.[mM][aA][rR][oO][tT][tT][eE] ", 36), 0);
    assert_non_null(strstr(double_of.filters, "\nShows: *.[mM][aA][rR][oO][tT][tT][eE]\n"));
    assert_non_null(strstr(double_of.filters, "*.[mM][pP]3"));
    assert_true(double_of.folder[0] == '/');
    scene_do(&s, ACTION_OPEN); /* it has gone: the list, with the folder of what was chosen */
    assert_true(scene_until(&s, shows_word, of_list));
    assert_non_null(scene_word(&s, "moai.rig.json"));
    scene_close(&s);
}

static void a_file_that_is_not_there_is_said_and_nothing_is_made(void **state)
{
    char uri[600], path[512];
    (void)state;
    begin_portal(CHOOSES, "");
    open_scene(300.0);
    (void)snprintf(path, sizeof path, "%s/gone.marotte", s.folder);
    (void)snprintf(uri, sizeof uri, "file://%s", path);
    let_choose(uri);
    scene_do(&s, ACTION_OPEN);
    (void)snprintf(uri, sizeof uri, "%s does not exist", path);
    assert_true(scene_until(&s, shows_word, uri));
    end_portal();
    assert_int_not_equal(access(path, F_OK), 0);
    assert_true(ui_has_dialog(s.ui)); /* the list goes on, at that folder */
    assert_non_null(scene_word(&s, of_list));
    scene_close(&s);
}

static void what_is_no_file_of_this_computer_brings_the_list(void **state)
{
    static const char *const bad[] = {"http://example.org/a.marotte",
                                      "file://elsewhere/a.marotte",
                                      "file:///a%0",
                                      "file:///a%00b",
                                      "",
                                      "marotte"};
    (void)state;
    begin_portal(CHOOSES, "");
    open_scene(300.0);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        let_choose(bad[i]);
        scene_do(&s, ACTION_OPEN);
        assert_true(scene_until(&s, shows_word, of_list));
        scene_key(&s, UI_KEY_ESCAPE, 0);
        assert_false(ui_has_dialog(s.ui));
    }
    end_portal();
    scene_close(&s);
}

static void cancelled_there_is_cancelled_here(void **state)
{
    (void)state;
    begin_portal(CANCELS, "");
    open_scene(300.0);
    const uint64_t before = news_list_count(app_news(s.app));
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, has_no_dialog, NULL));
    assert_int_equal(news_list_count(app_news(s.app)), before);
    end_portal();
    scene_close(&s);
}

static void a_dialog_that_fails_brings_the_list(void **state)
{
    (void)state;
    begin_portal(FAILS, "");
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, shows_word, of_list));
    end_portal();
    scene_close(&s);
}

static void without_a_portal_or_a_bus_the_list_comes(void **state)
{
    (void)state;
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN); /* the bus says that there is none */
    assert_true(scene_until(&s, shows_word, of_list));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    (void)setenv("DBUS_SESSION_BUS_ADDRESS", "unix:path=/nonexistent", 1);
    scene_do(&s, ACTION_OPEN);
    assert_non_null(scene_word(&s, of_list));
    assert_null(scene_word(&s, "Desktop's dialog"));
    scene_close(&s);
    (void)setenv("DBUS_SESSION_BUS_ADDRESS", bus.address, 1);
}

static void a_portal_that_never_answers_holds_nothing_up(void **state)
{
    char path[512];
    (void)state;
    begin_portal(IS_SILENT, "");
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, was_asked, NULL));
    const uint64_t number = app_view(s.app)->number;
    scene_frames(&s, 5);
    assert_true(app_view(s.app)->number >= number && scene_word_with(&s, waits));
    scene_face_path(path, "moai"); /* a path that is typed is not held up either */
    scene_type(&s, path);
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_string_equal(app_face_path(s.app), path);
    settings_set_number(app_settings(s.app), "open.desktop_wait_s", 0.5);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, shows_word, of_list)); /* its time is over */
    end_portal();
    scene_close(&s);
}

static void the_list_is_a_click_away_and_remembered(void **state)
{
    (void)state;
    begin_portal(KEEPS_ON, "");
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, shows_word, asks));
    scene_look(&s, "desktop_dialog_waits");
    scene_check_words(&s);
    scene_click_word(&s, "List in this window");
    assert_true(scene_until(&s, was_closed, NULL)); /* the desktop's is gone */
    assert_null(scene_word_with(&s, asks));
    scene_look(&s, "desktop_dialog_list");
    scene_check_words(&s);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_do(&s, ACTION_OPEN);
    assert_non_null(scene_word(&s, of_list));
    assert_int_equal(atomic_load(&double_of.asked), 1);
    scene_click_word(&s, "Desktop's dialog");
    assert_true(scene_until(&s, shows_word, asks));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_false(ui_has_dialog(s.ui));
    assert_true(scene_until(&s, was_closed_twice, NULL));
    end_portal();
    scene_close(&s);
}

static bool is_show_open(scene *of, void *path)
{
    return strcmp(show_path(app_show(of->app)), path) == 0;
}

static void save_as_asks_there_too(void **state)
{
    char path[512], uri[600];
    (void)state;
    begin_portal(CANCELS, "");
    open_scene(300.0);
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT);
    assert_true(scene_until(&s, has_no_dialog, NULL));
    assert_string_equal(double_of.member, "SaveFile");
    assert_string_equal(double_of.name, "night 2.marotte");
    assert_string_equal(double_of.folder, s.folder);
    end_portal();
    (void)snprintf(path, sizeof path, "%s/the other.marotte", s.folder);
    (void)snprintf(uri, sizeof uri, "file://%s/the%%20other", s.folder);
    begin_portal(CHOOSES, uri);
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT);
    assert_true(scene_until(&s, is_show_open, path));
    assert_true(scene_until(&s, has_no_dialog, NULL));
    end_portal();
    scene_key(&s, 'S', UI_CONTROL | UI_SHIFT); /* none is there: the field asks alone */
    assert_true(scene_until(&s, shows_no_word, asks_at_all));
    assert_true(ui_has_dialog(s.ui));
    scene_close(&s);
}

static void a_portal_that_ends_leaves_the_list(void **state)
{
    (void)state;
    begin_portal(KEEPS_ON, "");
    open_scene(300.0);
    scene_do(&s, ACTION_OPEN);
    assert_true(scene_until(&s, shows_word, asks));
    end_portal();
    assert_true(scene_until(&s, shows_word, of_list));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_chosen_there_is_opened),
        cmocka_unit_test(a_file_that_is_not_there_is_said_and_nothing_is_made),
        cmocka_unit_test(what_is_no_file_of_this_computer_brings_the_list),
        cmocka_unit_test(cancelled_there_is_cancelled_here),
        cmocka_unit_test(a_dialog_that_fails_brings_the_list),
        cmocka_unit_test(without_a_portal_or_a_bus_the_list_comes),
        cmocka_unit_test(a_portal_that_never_answers_holds_nothing_up),
        cmocka_unit_test(the_list_is_a_click_away_and_remembered),
        cmocka_unit_test(a_portal_that_ends_leaves_the_list),
        cmocka_unit_test(save_as_asks_there_too),
    };
    if (!begin_bus()) {
        end_bus();
        print_message("SKIPPED: dbus-daemon is not installed\n");
        return 77;
    }
    (void)setenv("DBUS_SESSION_BUS_ADDRESS", bus.address, 1);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    end_bus();
    return failed;
}

#else
int main(void)
{
    print_message("SKIPPED: libsystemd-dev is not installed\n");
    return 77;
}
#endif
