/* The stage done from afar: OSC and WebSocket at one port, what is answered, what is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "app_fixture.h"
#include "window/app/pose_palette.h"
#include "window/app/presets.h"
#include "window/app/remote.h"
#include "window/app/remote_wire.h"

#include <arpa/inet.h>
#include <errno.h>
#include <linux/sockios.h>
#include <math.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

/* ---- a client: it waits with the application going on ---- */

typedef struct fixture {
    room room;
    const char *host; /* NULL: 127.0.0.1 */
    uint16_t port;
    int udp, tcp;
    char in[65536];
    size_t size;
} fixture;

static struct sockaddr_in at_host(const char *host, uint16_t port)
{
    return (struct sockaddr_in){.sin_family = AF_INET,
                                .sin_port = htons(port),
                                .sin_addr = {.s_addr = inet_addr(host ? host : "127.0.0.1")}};
}

static struct sockaddr_in here(uint16_t port)
{
    return at_host(NULL, port);
}

/* A port that is free now. */
static uint16_t free_port(void)
{
    struct sockaddr_in at = here(0);
    socklen_t size = sizeof at;
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&at, &size), 0);
    close(fd);
    return ntohs(at.sin_port);
}

static void write_settings(const room *r, const char *text)
{
    FILE *file = fopen(r->settings, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void open_fixture_at(fixture *d, const char *host, const char *kept, bool has_hand)
{
    error err = {0};
    char address[48];
    *d = (fixture){.port = free_port(), .udp = -1, .tcp = -1, .host = host};
    (void)snprintf(address, sizeof address, "%s%s%u", host ? host : "", host ? ":" : "",
                   (unsigned)d->port);
    make_room(&d->room);
    if (kept)
        write_settings(&d->room, kept);
    const app_options with = {.show_path = d->room.show,
                              .settings_path = kept ? d->room.settings : NULL,
                              .face_path = puppet,
                              .mapping = "one_hand",
                              .remote = address,
                              .inputs = has_hand ? demo_inputs : NULL,
                              .input_count = has_hand ? 1 : 0};
    if (open_with(&d->room, &with, &err) < 0)
        fail_msg("%s", err.text);
    const struct sockaddr_in at = at_host(host, d->port);
    d->udp = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    assert_int_equal(connect(d->udp, (const struct sockaddr *)&at, sizeof at), 0);
}

static void open_fixture(fixture *d, bool has_hand)
{
    open_fixture_at(d, NULL, NULL, has_hand);
}

static void close_fixture(fixture *d)
{
    if (d->tcp >= 0)
        close(d->tcp);
    close(d->udp);
    close_room(&d->room);
}

/* More of what came by TCP; false: it was closed, or nothing comes. */
static bool receive(fixture *d)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (clock_now_ns() < end_ns) {
        app_update(d->room.app, 0.005);
        const ssize_t size =
            recv(d->tcp, d->in + d->size, sizeof d->in - 1 - d->size, MSG_DONTWAIT);
        if (size > 0) {
            d->size += (size_t)size;
            d->in[d->size] = '\0';
            return true;
        }
        if (size == 0 || (errno != EAGAIN && errno != EINTR))
            return false;
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    return false;
}

static void ask_path(fixture *d, const char *path, const char *host, const char *more)
{
    char text[1024];
    const struct sockaddr_in at = at_host(d->host, d->port);
    if (d->tcp >= 0)
        close(d->tcp);
    app_update(d->room.app, 0.005);
    d->size = 0;
    d->tcp = socket(AF_INET, SOCK_STREAM, 0);
    assert_int_equal(connect(d->tcp, (const struct sockaddr *)&at, sizeof at), 0);
    const int length = snprintf(text, sizeof text,
                                "GET %s HTTP/1.1\r\nHost: %s\r\nConnection: Upgrade\r\nUpgrade: "
                                "websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
                                "dGhlIHNhbXBsZSBub25jZQ==\r\n%s\r\n",
                                path, host, more);
    assert_int_equal(send(d->tcp, text, (size_t)length, 0), length);
    assert_true(receive(d));
}

static void ask_http(fixture *d, const char *host, const char *more)
{
    ask_path(d, "/", host, more);
}

static void join(fixture *d)
{
    char host[32];
    (void)snprintf(host, sizeof host, "127.0.0.1:%u", (unsigned)d->port);
    ask_http(d, host, "");
    assert_non_null(strstr(d->in, "101 Switching"));
    assert_non_null(strstr(d->in, "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=")); /* of RFC 6455, 1.3 */
    d->size = 0;
}

/* `length` of the text, which may be a lie in the head. */
static void say_bytes(fixture *d, const char *text, size_t length)
{
    unsigned char bytes[5000] = {0x81};
    size_t head = 2;
    bytes[1] = (unsigned char)(0x80 | (length < 126 ? length : 126));
    if (length >= 126) {
        bytes[2] = (unsigned char)(length >> 8);
        bytes[3] = (unsigned char)length;
        head = 4;
    }
    head += 4; /* a mask of zeroes */
    memcpy(bytes + head, text, length);
    assert_int_equal(send(d->tcp, bytes, head + length, MSG_NOSIGNAL), (int)(head + length));
}

/* The text of the next frames has this; news of the stage may come before. */
static void hears(fixture *d, const char *part)
{
    while (!d->size || !memmem(d->in, d->size, part, strlen(part)))
        if (!receive(d))
            fail_msg("\"%s\" was not answered", part);
}

static void says(fixture *d, const char *text, const char *answered)
{
    d->size = 0;
    say_bytes(d, text, strlen(text));
    hears(d, answered);
}

typedef struct heard {
    char word[64], says[512];
    int32_t ok;
} heard;

static void take_answer(void *context, const osc_message *message)
{
    heard *out = context;
    assert_string_equal(message->address, "/marotte/remote/answer");
    assert_true(osc_message_int32(message, 1, &out->ok));
    (void)snprintf(out->word, sizeof out->word, "%s", osc_message_text(message, 0));
    (void)snprintf(out->says, sizeof out->says, "%s", osc_message_text(message, 2));
}

static heard osc_send(fixture *d, osc_builder *builder, const char *address)
{
    char bytes[1024];
    heard out = {.ok = -1};
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    const size_t size = osc_builder_finish(builder, address, bytes, sizeof bytes);
    assert_int_equal(send(d->udp, bytes, size, 0), (int)size);
    ssize_t got = -1;
    while (got < 0 && clock_now_ns() < end_ns) {
        app_update(d->room.app, 0.005);
        got = recv(d->udp, bytes, sizeof bytes, 0);
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    assert_true(got > 0);
    assert_int_equal(osc_wire_read(bytes, (size_t)got, take_answer, &out), OSC_FAULT_NONE);
    return out;
}

static heard osc(fixture *d, const char *address)
{
    osc_builder builder = osc_builder_start();
    return osc_send(d, &builder, address);
}

/* ---- off ---- */

static void nobody_listens_until_it_is_switched_on(void **state)
{
    room r;
    (void)state;
    open_room(&r, false);
    assert_string_equal(app_remote_now(r.app).address, "");
    assert_false(app_remote_now(r.app).is_listening);
    assert_int_equal(live_input_count(app_live(r.app)), 0);
    close_room(&r);
}

static void a_place_that_is_none_is_an_error_of_one_line(void **state)
{
    room r;
    error err = {0};
    (void)state;
    make_room(&r);
    const app_options with = {.show_path = r.show, .face_path = puppet, .remote = "over there"};
    assert_true(open_with(&r, &with, &err) < 0);
    assert_non_null(strstr(err.text, "over there"));
    assert_null(strchr(err.text, '\n'));
    close_room(&r);
}

/* ---- OSC ---- */

static void a_take_is_recorded_marked_and_ended_by_osc(void **state)
{
    fixture d;
    (void)state;
    open_fixture(&d, true);
    assert_true(until(&d.room, has_samples));
    heard h = osc(&d, "/marotte/remote/record");
    assert_string_equal(h.word, "record");
    assert_int_equal(h.ok, 1);
    assert_true(until(&d.room, is_recorded));
    h = osc(&d, "/marotte/remote/record"); /* begins only */
    assert_int_equal(h.ok, 0);
    assert_non_null(strstr(h.says, "already"));
    assert_true(app_status(d.room.app)->is_recording);
    h = osc(&d, "/marotte/remote/mark");
    assert_string_equal(h.says, "marker added to the live recording");
    h = osc(&d, "/marotte/remote/stop");
    assert_int_equal(h.ok, 1);
    assert_true(until(&d.room, has_ended));
    h = osc(&d, "/marotte/remote/keep");
    assert_int_equal(h.ok, 1);
    h = osc(&d, "/marotte/remote/neutral");
    assert_int_equal(h.ok, 1);
    h = osc(&d, "/marotte/remote/quit");
    assert_int_equal(h.ok, 0);
    close_fixture(&d);
}

static void a_button_that_is_let_go_does_nothing(void **state)
{
    fixture d;
    char bytes[256];
    (void)state;
    open_fixture(&d, true);
    assert_true(until(&d.room, has_samples));
    osc_builder builder = osc_builder_start();
    osc_builder_float(&builder, 0.0f);
    const size_t size = osc_builder_finish(&builder, "/marotte/remote/record", bytes, sizeof bytes);
    assert_int_equal(send(d.udp, bytes, size, 0), (int)size);
    (void)osc(&d, "/marotte/remote/status"); /* answered after it */
    assert_false(app_status(d.room.app)->is_recording);
    close_fixture(&d);
}

/* ---- WebSocket ---- */

static void a_script_asks_and_is_told_what_happens(void **state)
{
    fixture d;
    (void)state;
    open_fixture(&d, true);
    assert_true(until(&d.room, has_samples));
    join(&d);
    says(&d, "{\"do\":\"status\",\"id\":7}", "\"id\":7");
    hears(&d, "\"expressions\":[\"joy\"");
    says(&d, "{\"do\":\"record\"}", "\"did\":\"record\",\"ok\":true");
    hears(&d, "{\"recording\":true}");
    says(&d, "{\"do\":\"stop\"}", "\"did\":\"stop\",\"ok\":true");
    hears(&d, "{\"recording\":false}");
    says(&d, "{\"do\":\"stop\"}", "\"ok\":false");
    says(&d, "{\"do\":\"view_side\"}", "\"ok\":true");
    assert_true(app_take_request(d.room.app, ACTION_VIEW_SIDE));
    close_fixture(&d);
}

static void a_preset_of_the_mapping_is_asked_of_its_panel(void **state)
{
    fixture d;
    char key[PRESET_KEY];
    (void)state;
    open_fixture(&d, false);
    presets_key(key, live_mapping(app_live(d.room.app))->type, "calm");
    settings_set_text(app_settings(d.room.app), key, "smile=2");
    join(&d);
    says(&d, "{\"do\":\"preset\",\"name\":\"wild\"}", "\"ok\":false");
    assert_string_equal(app_notes_of(d.room.app)->preset, "");
    says(&d, "{\"do\":\"preset\",\"name\":\"calm\"}", "\"ok\":true");
    assert_string_equal(app_notes_of(d.room.app)->preset, "calm");
    close_fixture(&d);
}

/* ---- poses ---- */

static const double smiles_mm = 2.0;

/* How far the face is from rest. */
static double moved_mm(app *of)
{
    const live_view *view = app_view(of);
    const mesh *rest = &app_face(of)->mesh;
    double most = 0.0;
    for (uint32_t i = 0; view->position && i < 3 * view->vertex_count && i < 3 * rest->vertex_count;
         ++i)
        most = fmax(most, fabs((double)view->position[i] - (double)rest->position[i]));
    return most;
}

static bool is_smiling(app *of)
{
    return moved_mm(of) > smiles_mm;
}

static bool is_at_rest(app *of)
{
    return moved_mm(of) < 0.05;
}

static bool has_poses(app *of)
{
    return pose_palette_count(app_poses(of)) > 0;
}

static void a_named_pose_fades_in_and_out_and_is_in_the_take(void **state)
{
    fixture d;
    (void)state;
    open_fixture(&d, false);
    assert_true(until(&d.room, has_poses));
    join(&d);
    says(&d, "{\"do\":\"record\"}", "{\"recording\":true}");
    says(&d, "{\"do\":\"expression\",\"name\":\"joy\",\"fade_s\":0.2}", "\"ok\":true");
    assert_true(until(&d.room, is_smiling));
    assert_true(until(&d.room, is_recorded));
    says(&d, "{\"do\":\"stop\"}", "{\"recording\":false}");
    says(&d, "{\"do\":\"expression\",\"name\":\"joy\",\"amount\":0,\"fade_s\":0.2}", "joy to 0");
    assert_true(until(&d.room, is_at_rest));
    assert_true(until(&d.room, has_ended));
    app_seek(d.room.app, app_take(d.room.app)->duration_ns);
    assert_true(until(&d.room, shows_take));
    assert_true(until(&d.room, is_smiling)); /* the take performs it again */
    says(&d, "{\"do\":\"expression\",\"name\":\"grin of a cat\"}", "the face has no pose");
    close_fixture(&d);
}

static void neutral_lets_poses_go(void **state)
{
    fixture d;
    (void)state;
    open_fixture(&d, false);
    assert_true(until(&d.room, has_poses));
    const heard h = osc(&d, "/marotte/remote/expression/joy");
    assert_int_equal(h.ok, 1);
    assert_true(until(&d.room, is_smiling));
    app_do(d.room.app, ACTION_NEUTRAL);
    assert_true(until(&d.room, is_at_rest));
    close_fixture(&d);
}

/* ---- refused ---- */

static void other_hosts_and_origins_are_turned_away(void **state)
{
    fixture d;
    char own[64], origin[128];
    (void)state;
    open_fixture(&d, false);
    app_update(d.room.app, 0.005);
    (void)snprintf(own, sizeof own, "127.0.0.1:%u", (unsigned)d.port);
    ask_http(&d, "evil.example", "");
    assert_non_null(strstr(d.in, "403"));
    (void)snprintf(origin, sizeof origin, "evil.example:%u", (unsigned)d.port);
    ask_http(&d, origin, "");
    assert_non_null(strstr(d.in, "403"));
    ask_http(&d, own, "Origin: http://evil.example\r\n");
    assert_non_null(strstr(d.in, "403"));
    ask_http(&d, own, "Origin: null\r\n");
    assert_non_null(strstr(d.in, "403"));
    (void)snprintf(origin, sizeof origin, "Origin: http://%s\r\n", own);
    ask_http(&d, own, origin);
    assert_non_null(strstr(d.in, "101"));
    close_fixture(&d);
}

static void nonsense_is_refused_with_one_line_and_the_rest_goes_on(void **state)
{
    static const char *const bad[] = {
        "",
        "record",
        "[]",
        "{}",
        "{\"do\":7}",
        "{\"do\":\"quit\"}",
        "{\"do\":\"record\",\"do\":\"stop\"}",
        "{\"do\":\"record\",\"name\":\"x\"}",
        "{\"do\":\"expression\",\"amount\":2}",
        "{\"do\":\"expression\",\"name\":\"joy\",\"fade_s\":-1}",
        "{\"do\":\"expression\",\"name\":\"a\\nb\"}",
        "{\"do\":\"record\",\"when\":1}",
        "{\"do\":\"record\"} {\"do\":\"stop\"}",
    };
    fixture d;
    char large[2000];
    (void)state;
    open_fixture(&d, false);
    app_update(d.room.app, 0.005);
    join(&d);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        says(&d, bad[i], "\"ok\":false");
        assert_false(app_status(d.room.app)->is_recording);
    }
    assert_int_equal(send(d.udp, "no OSC at all", 13, 0), 13);
    assert_int_equal(osc(&d, "/marotte/remote/expression/joy").ok, 1);
    assert_int_equal(osc(&d, "/other/record").ok, 0);
    memset(large, ' ', sizeof large);
    d.size = 0;
    say_bytes(&d, large, sizeof large);
    while (receive(&d))
        continue;
    assert_true(d.size >= 4);
    assert_int_equal((unsigned char)d.in[d.size - 2] << 8 | (unsigned char)d.in[d.size - 1], 1009);
    join(&d); /* the next one is heard */
    says(&d, "{\"do\":\"status\"}", "\"ok\":true");
    close_fixture(&d);
}

/* ---- the network, here as another address of this computer ---- */

static bool has_news_of_port(app *of)
{
    return was_said(of, "remote control at 127.0.0.2");
}

static void one_that_the_network_reaches_needs_its_code(void **state)
{
    static const char kept[] = "{\"looks\": {}, \"remote\": {\"code\": \"k7m2p9qx\"}}";
    static const char *const others[] = {"/", "/record", "/k7m2p9q/", "/k7m2p9qy/", "/k7m2p9qx"};
    fixture d;
    char own[64], bytes[256];
    (void)state;
    open_fixture_at(&d, "127.0.0.2", kept, true);
    assert_true(until(&d.room, has_news_of_port));
    assert_true(was_said(d.room.app, "k7m2p9qx"));
    assert_true(until(&d.room, has_samples));
    (void)snprintf(own, sizeof own, "127.0.0.2:%u", (unsigned)d.port);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; ++i) {
        ask_path(&d, others[i], own, "");
        assert_non_null(strstr(d.in, "403"));
    }
    ask_path(&d, "/k7m2p9qx/", "evil.example", "");
    assert_non_null(strstr(d.in, "403"));
    ask_path(&d, "/k7m2p9qx/more", own, "");
    assert_non_null(strstr(d.in, "404"));
    ask_path(&d, "/k7m2p9qx/", own, "");
    assert_non_null(strstr(d.in, "101"));
    says(&d, "{\"do\":\"status\"}", "\"ok\":true");
    /* whoever has no code is not answered: the first answer is that of the status */
    static const char *const wrong[] = {"/marotte/remote/record", "/marotte/remote/k7m2p9qy/record",
                                        "/marotte/remote/k7m2p9qx", "/k7m2p9qx/record"};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        osc_builder builder = osc_builder_start();
        const size_t size = osc_builder_finish(&builder, wrong[i], bytes, sizeof bytes);
        assert_int_equal(send(d.udp, bytes, size, 0), (int)size);
    }
    assert_string_equal(osc(&d, "/marotte/remote/k7m2p9qx/status").word, "status");
    assert_false(app_status(d.room.app)->is_recording);
    assert_int_equal(osc(&d, "/marotte/remote/k7m2p9qx/record").ok, 1);
    close_fixture(&d);
}

static void a_code_is_drawn_kept_and_renewed(void **state)
{
    fixture d;
    char code[REMOTE_CODE + 1];
    (void)state;
    open_fixture_at(&d, "127.0.0.2", "{\"looks\": {}, \"remote\": {\"code\": \"\\u001b[2J\"}}",
                    false);
    (void)snprintf(code, sizeof code, "%s", app_remote_now(d.room.app).code);
    assert_true(remote_is_code(code));
    app_set_remote(d.room.app, "");
    assert_string_equal(app_remote_now(d.room.app).code, "");
    app_set_remote(d.room.app, "127.0.0.2:9");
    assert_string_equal(app_remote_now(d.room.app).code, code);
    app_renew_remote_code(d.room.app);
    assert_true(remote_is_code(app_remote_now(d.room.app).code));
    assert_string_not_equal(app_remote_now(d.room.app).code, code);
    assert_string_equal(app_remote_now(d.room.app).address, "127.0.0.2:9");
    close_fixture(&d);
}

/* The remote control of the next start. */
static const char *next_start(room *r, const char *kept)
{
    error err = {0};
    const app_options with = {
        .show_path = r->show, .face_path = puppet, .settings_path = r->settings};
    if (kept)
        write_settings(r, kept);
    if (open_with(r, &with, &err) < 0)
        fail_msg("%s", err.text);
    return app_remote_now(r->app).address;
}

static void one_that_the_network_reaches_is_not_open_again_at_the_next_start(void **state)
{
    room r;
    (void)state;
    make_room(&r);
    assert_string_equal(next_start(&r, "{\"looks\": {}, \"remote\": {\"place\": \"0.0.0.0:9\"}}"),
                        "");
    assert_true(was_said(r.app, "not switched on automatically"));
    app_set_remote(r.app, "127.0.0.1:9");
    app_destroy(r.app);
    assert_string_equal(next_start(&r, NULL), "127.0.0.1:9");
    app_set_remote(r.app, "127.0.0.2:9");
    app_destroy(r.app);
    assert_string_equal(next_start(&r, NULL), "127.0.0.1:9");
    app_set_remote(r.app, "");
    app_set_remote(r.app, "127.0.0.2:9");
    app_destroy(r.app);
    assert_string_equal(next_start(&r, NULL), "");
    close_room(&r);
}

/* ---- who sends without a pause ---- */

/* Until the other side's system has all that was sent. */
static void wait_until_delivered(int fd)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    int waiting = 1;
    while (clock_now_ns() < end_ns && ioctl(fd, SIOCOUTQ, &waiting) == 0 && waiting > 0)
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    assert_int_equal(waiting, 0);
}

/* Two looks: what is handled in the first is answered in the second. */
static void look(fixture *d)
{
    app_update(d->room.app, 0.005);
    app_update(d->room.app, 0.005);
}

/* Answers that have come by TCP, without a look. */
static uint32_t answers_to(fixture *d, const char *part)
{
    uint32_t count = 0;
    ssize_t size;
    while ((size = recv(d->tcp, d->in + d->size, sizeof d->in - 1 - d->size, MSG_DONTWAIT)) > 0)
        d->size += (size_t)size;
    for (const char *at = d->in;
         (at = memmem(at, d->size - (size_t)(at - d->in), part, strlen(part))); ++at)
        count += 1;
    return count;
}

/* Another client is answered after this look, without another one. */
static void is_answered(fixture *second, const char *part)
{
    struct pollfd wait = {.fd = second->tcp, .events = POLLIN};
    while (answers_to(second, part) == 0)
        assert_int_equal(poll(&wait, 1, PATIENCE_S * 1000), 1);
}

static void a_client_that_sends_without_a_pause_gets_its_share_of_a_look(void **state)
{
    enum { FLOOD = 12 * REMOTE_MESSAGES_A_LOOK };
    const int room_bytes = 1 << 20;
    fixture d;
    char text[1001];
    (void)state;
    open_fixture(&d, false);
    app_update(d.room.app, 0.005);
    fixture second = {.room = d.room, .port = d.port, .udp = -1, .tcp = -1};
    join(&second);
    join(&d);
    (void)setsockopt(d.tcp, SOL_SOCKET, SO_SNDBUF, &room_bytes, sizeof room_bytes);
    for (int i = 0; i < FLOOD; ++i) {
        const int length = snprintf(text, sizeof text, "{\"do\":\"view_front\",\"id\":%d}", i);
        memset(text + length, ' ', sizeof text - (size_t)length);
        say_bytes(&d, text, sizeof text - 1);
    }
    say_bytes(&second, "{\"do\":\"status\"}", 15);
    wait_until_delivered(second.tcp);
    look(&d);
    assert_true(answers_to(&d, "view_front") <= REMOTE_MESSAGES_A_LOOK);
    is_answered(&second, "\"did\":\"status\",\"ok\":true");
    while (answers_to(&d, "view_front") < FLOOD)
        if (!receive(&d))
            fail_msg("%u of %d were answered", answers_to(&d, "view_front"), (int)FLOOD);
    for (int i = 0; i < FLOOD; ++i) {
        (void)snprintf(text, sizeof text, "\"id\":%d}", i);
        assert_int_equal(answers_to(&d, text), 1);
    }
    close(second.tcp);
    close_fixture(&d);
}

static void datagrams_without_a_pause_get_their_share_of_a_look(void **state)
{
    enum { FLOOD = 5 * REMOTE_DATAGRAMS_A_LOOK };
    fixture d;
    char bytes[1024];
    uint32_t answered = 0;
    (void)state;
    open_fixture(&d, false);
    app_update(d.room.app, 0.005);
    join(&d);
    osc_builder builder = osc_builder_start();
    const size_t size =
        osc_builder_finish(&builder, "/marotte/remote/view_front", bytes, sizeof bytes);
    for (int i = 0; i < FLOOD; ++i)
        assert_int_equal(send(d.udp, bytes, size, 0), (int)size);
    say_bytes(&d, "{\"do\":\"status\"}", 15);
    wait_until_delivered(d.tcp);
    look(&d);
    while (recv(d.udp, bytes, sizeof bytes, 0) > 0)
        answered += 1;
    assert_true(answered <= REMOTE_DATAGRAMS_A_LOOK);
    is_answered(&d, "\"did\":\"status\",\"ok\":true");
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    while (answered < FLOOD && clock_now_ns() < end_ns) {
        app_update(d.room.app, 0.005);
        while (recv(d.udp, bytes, sizeof bytes, 0) > 0)
            answered += 1;
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    assert_int_equal(answered, FLOOD);
    close_fixture(&d);
}

static bool is_in_trouble(app *of)
{
    return app_remote_now(of).trouble[0] != '\0';
}

static bool is_listening(app *of)
{
    return app_remote_now(of).is_listening;
}

static void a_port_that_is_taken_is_said_and_comes_back_by_itself(void **state)
{
    room r;
    error err = {0};
    char address[16];
    const uint16_t port = free_port();
    const struct sockaddr_in at = here(port);
    (void)state;
    const int taken = socket(AF_INET, SOCK_DGRAM, 0);
    assert_int_equal(bind(taken, (const struct sockaddr *)&at, sizeof at), 0);
    (void)snprintf(address, sizeof address, "%u", (unsigned)port);
    make_room(&r);
    const app_options with = {.show_path = r.show, .face_path = puppet, .remote = address};
    assert_int_equal(open_with(&r, &with, &err), MRT_OK);
    assert_true(until(&r, is_in_trouble));
    assert_false(app_remote_now(r.app).is_listening);
    close(taken);
    assert_true(until(&r, is_listening));
    app_set_remote(r.app, "");
    assert_false(app_remote_now(r.app).is_listening);
    close_room(&r);
}

/* ---- whatever comes ---- */

static uint32_t random_state = 2463534242u;
static uint32_t random_number(uint32_t below)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state % below;
}

static void check_command(const remote_command *c)
{
    assert_true(c->amount >= 0.0 && c->amount <= 1.0);
    assert_true(c->fade_s >= 0.0 && c->fade_s <= REMOTE_FADE_MOST_S);
    assert_true(c->verb <= REMOTE_ACTION && memchr(c->name, 0, sizeof c->name));
    if (c->verb == REMOTE_ACTION)
        assert_true(action_of(c->of)->group != ACTION_PROGRAM &&
                    action_of(c->of)->group != ACTION_EDIT);
    else
        assert_int_equal(c->of, ACTION_NONE);
}

static void take_any(void *context, const osc_message *message)
{
    remote_command c;
    char why[REMOTE_WHY] = "";
    uint32_t *understood = context;
    if (remote_command_of_osc(&c, message, "", why)) {
        check_command(&c);
        *understood += 1;
    } else {
        assert_true(why[0] && !strchr(why, '\n'));
    }
}

/* Good messages with some bytes changed, cut anywhere, from the heap's end. */
static void whatever_comes_is_a_command_or_one_line(void **state)
{
    static const char good[] =
        "{\"do\":\"expression\",\"name\":\"joy\",\"amount\":0.5,\"fade_s\":1,\"id\":7}";
    uint32_t json_good = 0, osc_good = 0;
    (void)state;
    for (int round = 0; round < 20000; ++round) {
        char why[REMOTE_WHY] = "";
        remote_command c;
        unsigned char osc_bytes[256];
        osc_builder builder = osc_builder_start();
        osc_builder_text(&builder, "joy");
        osc_builder_float(&builder, 0.5f);
        osc_builder_float(&builder, 1.0f);
        const size_t osc_size =
            osc_builder_finish(&builder, "/marotte/remote/expression", osc_bytes, sizeof osc_bytes);
        const bool is_json = round % 2 == 0;
        size_t size = is_json ? sizeof good - 1 : osc_size;
        if (round >= 2 && random_number(3) == 0)
            size = random_number((uint32_t)size) + 1;
        unsigned char *bytes = malloc(size);
        assert_non_null(bytes);
        memcpy(bytes, is_json ? (const unsigned char *)good : osc_bytes, size);
        for (uint32_t k = round < 2 ? 0 : random_number(5); k > 0; --k)
            bytes[random_number((uint32_t)size)] = (unsigned char)random_number(256);
        if (!is_json) {
            (void)osc_wire_read(bytes, size, take_any, &osc_good);
        } else if (remote_command_of_json(&c, (const char *)bytes, size, why)) {
            check_command(&c);
            json_good += 1;
        } else {
            assert_true(why[0] && !strchr(why, '\n'));
        }
        free(bytes);
    }
    assert_true(json_good > 100 && osc_good > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whatever_comes_is_a_command_or_one_line),
        cmocka_unit_test(nobody_listens_until_it_is_switched_on),
        cmocka_unit_test(a_place_that_is_none_is_an_error_of_one_line),
        cmocka_unit_test(a_take_is_recorded_marked_and_ended_by_osc),
        cmocka_unit_test(a_button_that_is_let_go_does_nothing),
        cmocka_unit_test(a_script_asks_and_is_told_what_happens),
        cmocka_unit_test(a_preset_of_the_mapping_is_asked_of_its_panel),
        cmocka_unit_test(a_named_pose_fades_in_and_out_and_is_in_the_take),
        cmocka_unit_test(neutral_lets_poses_go),
        cmocka_unit_test(other_hosts_and_origins_are_turned_away),
        cmocka_unit_test(nonsense_is_refused_with_one_line_and_the_rest_goes_on),
        cmocka_unit_test(one_that_the_network_reaches_needs_its_code),
        cmocka_unit_test(a_code_is_drawn_kept_and_renewed),
        cmocka_unit_test(one_that_the_network_reaches_is_not_open_again_at_the_next_start),
        cmocka_unit_test(a_client_that_sends_without_a_pause_gets_its_share_of_a_look),
        cmocka_unit_test(datagrams_without_a_pause_get_their_share_of_a_look),
        cmocka_unit_test(a_port_that_is_taken_is_said_and_comes_back_by_itself),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
