/* The camera on an empty stage: one click downloads the hand tracker from a registry of the test's
 * own, with npm absent, and opens the page; the hand that the page sees is on the stage, and is
 * calibrated there. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "camera_lock.h"
#include "hand/guide.h"
#include "scene.h"
#include "show/hash.h"
#include "window/app/camera_package.h"
#include "window/gui/theme.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/socket.h>

static scene s;

/* ---- a registry ---- */

typedef enum answer { RIGHT = 0, WRONG, HALF, SILENT } answer;

static struct registry {
    pthread_t thread;
    int listening;
    uint16_t port;
    unsigned char *archive;
    size_t size;
    _Atomic int answer;
    _Atomic bool is_ending;
    _Atomic uint32_t requests;
} registry;

static void send_whole(int to, const void *bytes, size_t size)
{
    for (size_t sent = 0; sent < size;) {
        const ssize_t some =
            send(to, (const unsigned char *)bytes + sent, size - sent, MSG_NOSIGNAL);
        if (some <= 0)
            return;
        sent += (size_t)some;
    }
}

static void serve_one(int to)
{
    char request[4096], head[128];
    const answer how = (answer)atomic_load(&registry.answer);
    if (recv(to, request, sizeof request, 0) <= 0)
        return;
    atomic_fetch_add(&registry.requests, 1);
    while (how == SILENT && atomic_load(&registry.answer) == SILENT &&
           !atomic_load(&registry.is_ending)) {
        struct pollfd gone = {to, POLLIN, 0};
        if (poll(&gone, 1, 20) > 0)
            return;
    }
    (void)snprintf(head, sizeof head, "HTTP/1.1 200 OK\r\nContent-Length: %zu\r\n\r\n",
                   registry.size);
    send_whole(to, head, strlen(head));
    const size_t cut = registry.size / 2;
    send_whole(to, registry.archive, cut);
    if (how == HALF)
        return;
    unsigned char middle = registry.archive[cut];
    middle ^= how == WRONG;
    send_whole(to, &middle, 1);
    send_whole(to, registry.archive + cut + 1, registry.size - cut - 1);
}

static void *serve(void *data)
{
    (void)data;
    while (!atomic_load(&registry.is_ending)) {
        struct pollfd wanted = {registry.listening, POLLIN, 0};
        if (poll(&wanted, 1, 20) <= 0)
            continue;
        const int to = accept(registry.listening, NULL, NULL);
        if (to < 0)
            continue;
        serve_one(to);
        (void)shutdown(to, SHUT_RDWR);
        (void)close(to);
    }
    return NULL;
}

static void registry_begin(void)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    socklen_t length = sizeof at;
    char url[64];
    registry.listening = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_int_equal(bind(registry.listening, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(listen(registry.listening, 8), 0);
    assert_int_equal(getsockname(registry.listening, (struct sockaddr *)&at, &length), 0);
    registry.port = ntohs(at.sin_port);
    (void)snprintf(url, sizeof url, "http://127.0.0.1:%u", (unsigned)registry.port);
    assert_int_equal(setenv("npm_config_registry", url, 1), 0);
    assert_int_equal(pthread_create(&registry.thread, NULL, serve, NULL), 0);
}

static void registry_end(void)
{
    atomic_store(&registry.is_ending, true);
    (void)pthread_join(registry.thread, NULL);
    (void)close(registry.listening);
}

/* ---- a tracker: two files of a few MB, as an archive of the registry ---- */

static char work[] = "/tmp/marotte_camera_scene_XXXXXX";
static char script_sum[TAKE_HASH], model_sum[TAKE_HASH], archive_sum[TAKE_HASH];
static camera_package_file tracker_file[] = {{"hands.js", script_sum}, {"hand.model", model_sum}};
static camera_package tracker = {.name = "@mediapipe/hands",
                                 .version = "0.0.0",
                                 .archive = "@mediapipe/hands/-/hands-0.0.0.tgz",
                                 .archive_sha256 = archive_sum,
                                 .file = tracker_file,
                                 .file_count = 2};

static void write_file(const char *name, const void *bytes, size_t size)
{
    char path[256];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/%s", work, name);
    assert_int_equal(file_write(path, bytes, size, &err), MRT_OK);
}

static void make_tracker(void)
{
    enum { MODEL = 2000000 };
    static const char script[] = "/* none */\n";
    unsigned char *model = malloc(MODEL);
    char command[256], path[256];
    uint32_t noise = 1;
    file_bytes archive;
    error err = {""};
    assert_non_null(model);
    for (size_t i = 0; i < MODEL; ++i) { /* nothing to compress */
        noise = noise * 1664525u + 1013904223u;
        model[i] = (unsigned char)(noise >> 24);
    }
    write_file("package/hands.js", script, sizeof script - 1);
    write_file("package/hand.model", model, MODEL);
    hash_bytes(script_sum, script, sizeof script - 1);
    hash_bytes(model_sum, model, MODEL);
    (void)snprintf(command, sizeof command, "cd %s && tar -czf archive.tgz package", work);
    assert_int_equal(system(command), 0);
    (void)snprintf(path, sizeof path, "%s/archive.tgz", work);
    assert_int_equal(file_read(&archive, path, 8000000, &err), MRT_OK);
    registry.archive = archive.data;
    registry.size = archive.size;
    hash_bytes(archive_sum, archive.data, archive.size);
    tracker.archive_size = archive.size;
    tracker.installed_size = MODEL;
    camera_package_used = &tracker;
    free(model);
}

/* $PATH has what a download needs, but no npm. */
static bool leave_npm_out(void)
{
    static const char *const names[] = {"curl", "tar", "gzip", "rm"};
    char from[PATH_MAX], to[256], bin[64];
    (void)snprintf(bin, sizeof bin, "%s/bin", work);
    assert_int_equal(mkdir(bin, 0700), 0);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; ++i) {
        if (!program_on_path(from, names[i])) {
            print_message("SKIPPED: %s is not installed\n", names[i]);
            return false;
        }
        (void)snprintf(to, sizeof to, "%s/%s", bin, names[i]);
        assert_int_equal(symlink(from, to), 0);
    }
    assert_int_equal(setenv("PATH", bin, 1), 0);
    return true;
}

/* ---- the stage ---- */

static char page_file[128], settings_file[128];

/* A fresh profile, and a browser that only notes which page it was to open. */
static void open_stage(uint32_t width, uint32_t height)
{
    const scene_options options = {
        .width_px = width, .height_px = height, .scale = 1.0f, .settings_path = settings_file};
    char browser[128], script[192];
    error err = {""};
    scene_prepare(&s, &options);
    (void)snprintf(settings_file, sizeof settings_file, "%s/settings.json", s.folder);
    (void)snprintf(page_file, sizeof page_file, "%s/page", s.folder);
    (void)snprintf(browser, sizeof browser, "%s/browser", s.folder);
    (void)snprintf(script, sizeof script, "#!/bin/sh\necho \"$1\" > %s\n", page_file);
    assert_int_equal(file_write(browser, script, strlen(script), &err), MRT_OK);
    assert_int_equal(chmod(browser, 0755), 0);
    assert_int_equal(setenv("MAROTTE_BROWSER", browser, 1), 0);
    assert_int_equal(setenv("XDG_CONFIG_HOME", s.folder, 1), 0);
    scene_open_again(&s, &options);
}

/* Also across the lines of a text that is wrapped. */
static bool says(scene *of, void *data)
{
    static char all[16384];
    const ui_word *words;
    const uint32_t count = ui_words(of->ui, &words);
    size_t used = 0;
    all[0] = '\0';
    for (uint32_t i = 0; i < count && used + strlen(words[i].text) + 2 < sizeof all; ++i) {
        used += (size_t)sprintf(all + used, "%s", words[i].text);
        if (used > 0 && all[used - 1] != ' ') /* a line may end with its blank */
            all[used++] = ' ';
        all[used] = '\0';
    }
    return strstr(all, data) != NULL;
}

static bool says_not(scene *of, void *data)
{
    return !says(of, data);
}

static void tell_words(void)
{
    const ui_word *words;
    const uint32_t count = ui_words(s.ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        print_message("%s | ", words[i].text);
    print_message("\n");
}

static void wait_for(const char *words)
{
    char copy[128];
    (void)snprintf(copy, sizeof copy, "%s", words);
    if (!scene_until(&s, says, copy)) {
        tell_words();
        scene_look(&s, "camera_failed");
        fail_msg("\"%s\" is not said", words);
    }
}

static char camera_button[32];

static void ask_for_camera(void)
{
    scene_click_word(&s, camera_button);
    scene_move(&s, 1.0f, 1.0f); /* its hint covers what is below it */
}

static const char *tracker_path(void)
{
    static char path[256];
    (void)snprintf(path, sizeof path, "%s/marotte/camera/node_modules/@mediapipe/hands/hands.js",
                   s.folder);
    return path;
}

/* Nothing of it is left where data is kept. */
static void assert_nothing_is_kept(void)
{
    char command[160];
    assert_int_not_equal(access(tracker_path(), F_OK), 0);
    (void)snprintf(command, sizeof command,
                   "for f in %s/marotte/camera*; do [ ! -e \"$f\" ] || exit 1; done", s.folder);
    assert_int_equal(system(command), 0);
}

static bool is_accent(const char *text)
{
    const ui_word *word = scene_word(&s, text);
    assert_non_null(word);
    return word->ground == THEME_ACCENT;
}

static bool is_page_open(scene *of, void *data)
{
    struct stat about;
    (void)of, (void)data;
    return stat(page_file, &about) == 0 && about.st_size > 20;
}

/* ---- a page that sees a hand ---- */

static struct page {
    int socket;
    uint32_t sequence;
    int64_t due_ns;
    float now[MRT_ANGLES];
    const char *pose; /* its name on the stage; NULL: none is asked for */
    hand_skeleton *skeleton;
} page;

static const int64_t period_ns = 33333333;

static void send_frame(unsigned opcode, const unsigned char *payload, size_t size)
{
    unsigned char bytes[600];
    size_t used = 0;
    bytes[used++] = (unsigned char)(0x80u | opcode);
    if (size >= 126) {
        bytes[used++] = 0xfe;
        bytes[used++] = (unsigned char)(size >> 8);
        bytes[used++] = (unsigned char)size;
    } else {
        bytes[used++] = (unsigned char)(0x80u | size);
    }
    memset(bytes + used, 0, 4); /* the mask */
    used += 4;
    memcpy(bytes + used, payload, size);
    send_whole(page.socket, bytes, used + size);
}

static void page_begin(void)
{
    char url[128] = "", request[600], token[33];
    unsigned port = 0;
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    FILE *file = fopen(page_file, "r");
    assert_non_null(file);
    assert_non_null(fgets(url, sizeof url, file));
    (void)fclose(file);
    assert_int_equal(sscanf(url, "http://127.0.0.1:%u/%32[0-9a-f]/", &port, token), 2);
    page = (struct page){.socket = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0),
                         .skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM)};
    assert_non_null(page.skeleton);
    to.sin_port = htons((uint16_t)port);
    assert_int_equal(connect(page.socket, (struct sockaddr *)&to, sizeof to), 0);
    (void)snprintf(
        request, sizeof request,
        "GET /%s/socket HTTP/1.1\r\nHost: 127.0.0.1:%u\r\nOrigin: http://127.0.0.1:%u\r\n"
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Protocol: marotte.camera.1\r\n\r\n",
        token, port, port);
    send_whole(page.socket, request, strlen(request));
}

static void page_end(void)
{
    (void)close(page.socket);
    hand_skeleton_destroy(page.skeleton);
}

/* One picture: fingers up, the back of the hand towards the camera, as MediaPipe's landmarks. */
static void show_hand(void)
{
    unsigned char message[14 + 425] = {1};
    const rigid still = rigid_identity();
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    const double now_ms = 1e-6 * (double)clock_now_ns();
    const float score = 0.95f;
    hand_pose(page.skeleton, page.now, &still, joint, palm);
    memcpy(message + 1, &page.sequence, 4);
    memcpy(message + 5, &now_ms, 8);
    message[13] = 1;
    message[14] = MRT_RIGHT;
    memcpy(message + 15, &score, 4);
    for (int i = 0; i < MRT_JOINTS; ++i) {
        const float world_m[3] = {-1e-3f * joint[i].x, -1e-3f * joint[i].z, -1e-3f * joint[i].y};
        memcpy(message + 19 + 12 * i, world_m, sizeof world_m);
    }
    page.sequence += 1;
    send_frame(2, message, sizeof message);
}

static void send_ping(void)
{
    unsigned char message[9] = {2};
    const double now_ms = 1e-6 * (double)clock_now_ns();
    memcpy(message + 1, &now_ms, 8);
    send_frame(2, message, sizeof message);
}

/* Does what the stage asks for: a performer. */
static void page_frame(void)
{
    static const struct {
        const char *name;
        guide_step step;
    } poses[] = {{"Flat hand", GUIDE_FLAT}, {"Fist", GUIDE_FIST}, {"Spread", GUIDE_SPREAD}};
    float to[MRT_ANGLES];
    const int64_t now_ns = clock_now_ns();
    if (now_ns < page.due_ns)
        return;
    page.due_ns = now_ns + period_ns;
    guide_pose(GUIDE_RELAXED, to);
    for (size_t i = 0; i < sizeof poses / sizeof poses[0]; ++i)
        if (scene_word(&s, poses[i].name))
            guide_pose(poses[i].step, to);
    for (int i = 0; i < MRT_ANGLES; ++i)
        page.now[i] += fminf(fmaxf(to[i] - page.now[i], -0.15f), 0.15f);
    if (page.sequence % 30 == 0)
        send_ping();
    show_hand();
}

static bool says_to_page(scene *of, void *data)
{
    page_frame();
    return says(of, data);
}

static void perform_until(const char *words)
{
    char copy[128];
    (void)snprintf(copy, sizeof copy, "%s", words);
    if (!scene_until(&s, says_to_page, copy)) {
        tell_words();
        scene_look(&s, "camera_failed");
        fail_msg("\"%s\" is not said", words);
    }
}

/* The face is moved by a sample of the hand. */
static bool is_moved(scene *of, void *data)
{
    (void)data;
    page_frame();
    return app_view(of->app)->sample_ns > 0;
}

/* ---- tests ---- */

static void one_click_downloads_the_tracker_and_the_hand_moves_the_face(void **state)
{
    (void)state;
    atomic_store(&registry.answer, RIGHT);
    open_stage(1280, 720);
    wait_for(camera_button);
    assert_true(is_accent("Try a demo hand")); /* what works here now */
    assert_false(is_accent(camera_button));
    scene_look(&s, "camera_offer");
    const int64_t began_ns = clock_now_ns();
    ask_for_camera();
    assert_true(scene_until(&s, is_page_open, NULL));
    assert_int_equal(access(tracker_path(), R_OK), 0);
    wait_for("Start the camera");
    assert_null(scene_word(&s, "Try a demo hand"));
    scene_look(&s, "camera_waits");
    scene_check_words(&s);
    page_begin();
    assert_true(scene_until(&s, is_moved, NULL));
    const double took_s = 1e-9 * (double)(clock_now_ns() - began_ns);
    print_message("from the click to a face that the hand moves: %.1f s\n", took_s);
    perform_until("Hand seen");
    scene_look(&s, "camera_seen");
    perform_until("Flat hand");
    scene_let_cut(&s, "night");
    scene_look(&s, "camera_flat");
    scene_check_words(&s);
    perform_until("Fist");
    perform_until("hold still");
    scene_look(&s, "camera_fist");
    perform_until("Spread");
    assert_null(live_calibration(app_live(s.app), MRT_RIGHT));
    perform_until("Calibrated to your hand.");
    scene_look(&s, "camera_calibrated");
    scene_check_words(&s);
    const char *used = live_calibration(app_live(s.app), MRT_RIGHT);
    assert_non_null(used);
    assert_non_null(strstr(used, "right hand, camera.json"));
    assert_int_equal(access(used, R_OK), 0);
    page_end();
    wait_for("No hand seen");
    scene_look(&s, "camera_away");
    scene_click_word(&s, "Hide");
    assert_null(scene_word(&s, "No hand seen"));
    /* The next start: the camera is the first choice, and nothing is downloaded. */
    const uint32_t requests = atomic_load(&registry.requests);
    const scene_options again = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .settings_path = settings_file};
    (void)remove(page_file);
    scene_open_again(&s, &again);
    wait_for("Camera");
    char old_button[32];
    (void)snprintf(old_button, sizeof old_button, "%s", camera_button);
    assert_true(scene_until(&s, says_not, old_button));
    assert_true(is_accent("Camera"));
    assert_non_null(live_calibration(app_live(s.app), MRT_RIGHT));
    scene_click_word(&s, "Camera");
    assert_true(scene_until(&s, is_page_open, NULL));
    assert_int_equal(atomic_load(&registry.requests), requests);
    scene_close(&s);
}

/* A small stage has no room for a card over the face. */
static void assert_beside_face(const char *text)
{
    const ui_word *word = scene_word(&s, text);
    assert_non_null(word);
    assert_false(ui_rectangles_meet(word->where, workspace_face(s.workspace)));
}

static void a_calibration_can_be_skipped_and_stays_so(void **state)
{
    (void)state;
    atomic_store(&registry.answer, RIGHT);
    open_stage(800, 500);
    scene_let_cut(&s, "night");
    wait_for(camera_button);
    ask_for_camera();
    assert_true(scene_until(&s, is_page_open, NULL));
    page_begin();
    perform_until("Flat hand");
    scene_look(&s, "camera_flat_small");
    assert_beside_face("Flat hand");
    assert_beside_face("Skip");
    assert_true(workspace_face(s.workspace).width > 260.0f);
    scene_click_word(&s, "Skip");
    assert_null(scene_word(&s, "Flat hand"));
    for (int i = 0; i < 120; ++i) {
        page_frame();
        scene_frame(&s);
        clock_sleep_until_ns(clock_now_ns() + 16 * NS_PER_MS);
    }
    assert_null(scene_word(&s, "Flat hand"));
    assert_null(live_calibration(app_live(s.app), MRT_RIGHT));
    scene_look(&s, "camera_skipped_small");
    assert_beside_face("Calibrate");
    assert_beside_face("Hide");
    scene_click_word(&s, "Calibrate");
    wait_for("Flat hand");
    page_end();
    scene_close(&s);
}

/* The sentence is said, nothing is kept, the button is there, and the next try works. */
static void fail_then_succeed(answer how, const char *sentence, const char *picture)
{
    atomic_store(&registry.answer, (int)how);
    open_stage(800, 500);
    scene_let_cut(&s, "night");
    wait_for(camera_button);
    ask_for_camera();
    wait_for(sentence);
    scene_look(&s, picture);
    scene_let_cut(&s, "No takes yet");
    scene_check_words(&s);
    assert_nothing_is_kept();
    assert_int_equal(live_input_count(app_live(s.app)), 0);
    assert_non_null(scene_word(&s, camera_button));
    atomic_store(&registry.answer, RIGHT);
    scene_click_word(&s, "Try again");
    if (!scene_until(&s, is_page_open, NULL)) {
        tell_words();
        fail_msg("the page is not opened");
    }
    assert_int_equal(access(tracker_path(), R_OK), 0);
    scene_close(&s);
}

static void a_wrong_file_is_not_used(void **state)
{
    (void)state;
    fail_then_succeed(WRONG, "The download is not", "camera_wrong");
}

static void half_a_file_is_not_used(void **state)
{
    (void)state;
    fail_then_succeed(HALF, "The download was cut off", "camera_half");
}

static void a_registry_that_does_not_answer_is_given_up(void **state)
{
    (void)state;
    fail_then_succeed(SILENT, "does not answer", "camera_silent");
}

static void a_download_can_be_cancelled(void **state)
{
    (void)state;
    atomic_store(&registry.answer, SILENT);
    open_stage(1280, 720);
    wait_for(camera_button);
    ask_for_camera();
    wait_for("0 of 2 MB");
    scene_look(&s, "camera_downloads");
    scene_check_words(&s);
    scene_click_word(&s, "Cancel");
    assert_null(scene_word(&s, "Cancel"));
    scene_frames(&s, 100);
    assert_null(scene_word(&s, "Try again"));
    assert_non_null(scene_word(&s, camera_button));
    assert_int_equal(live_input_count(app_live(s.app)), 0);
    scene_end(&s); /* waits for its end */
    assert_nothing_is_kept();
    scene_close(&s);
}

static void without_a_network_it_says_so_and_the_button_stays(void **state)
{
    (void)state;
    registry_end();
    open_stage(1280, 720);
    wait_for(camera_button);
    ask_for_camera();
    wait_for("No connection to 127.0.0.1");
    scene_look(&s, "camera_no_network");
    scene_check_words(&s);
    assert_nothing_is_kept();
    scene_click_word(&s, "Close");
    assert_null(scene_word(&s, "Try again"));
    assert_non_null(scene_word(&s, camera_button));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_click_downloads_the_tracker_and_the_hand_moves_the_face),
        cmocka_unit_test(a_calibration_can_be_skipped_and_stays_so),
        cmocka_unit_test(a_wrong_file_is_not_used),
        cmocka_unit_test(half_a_file_is_not_used),
        cmocka_unit_test(a_registry_that_does_not_answer_is_given_up),
        cmocka_unit_test(a_download_can_be_cancelled),
        cmocka_unit_test(without_a_network_it_says_so_and_the_button_stays),
    };
    char command[96];
    if (!mkdtemp(work))
        return 1;
    make_tracker();
    (void)snprintf(camera_button, sizeof camera_button, "Camera (%.0f MB)",
                   1e-6 * (double)tracker.archive_size);
    if (!leave_npm_out())
        return 77;
    camera_lock();
    registry_begin();
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    (void)snprintf(command, sizeof command, "rm -rf %s", work);
    if (system(command) != 0)
        print_message("%s stays\n", work);
    free(registry.archive);
    return failed;
}
