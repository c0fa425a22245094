/* What stands between a camera's page and the face: camera_latency [FRAMES] [--gate MS]
 * A client sends landmarks to the camera's socket 30 times a second, as the page does; the hand
 * performs the puppet on the live stage, through one_hand. Prints how long a frame takes from the
 * socket until the stage has published the face that follows it. --gate: exits 1 when the median is
 * worse in ten measurements one after the other: a busy machine may miss it once. */
#include "base/clock.h"
#include "camera_wire.h"
#include "stage/perform/face_file.h"
#include "hand/hand.h"
#include "stage/live/live.h"

#include <arpa/inet.h>
#include <math.h>
#include <netinet/in.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { FRAMES_MAX = 10000, ROUNDS = 10 };
static const int64_t period_ns = 33333333, patience_ns = 20 * NS_PER_S;

static void must(mrt_result result, const error *err)
{
    if (result >= 0)
        return;
    (void)fprintf(stderr, "camera_latency: %s\n", err->text);
    exit(1);
}

/* ---- the page ---- */

static void read_token(const char *home, char out[CAMERA_TOKEN + 1])
{
    char path[256];
    (void)snprintf(path, sizeof path, "%s/marotte/plugins/org.marotte.camera/token", home);
    FILE *file = fopen(path, "r");
    if (!file || fread(out, 1, CAMERA_TOKEN, file) != CAMERA_TOKEN) {
        (void)fprintf(stderr, "camera_latency: no token in %s\n", path);
        exit(1);
    }
    out[CAMERA_TOKEN] = '\0';
    (void)fclose(file);
}

static void send_all(int fd, const void *bytes, size_t size)
{
    for (size_t sent = 0; sent < size;) {
        ssize_t n = send(fd, (const char *)bytes + sent, size - sent, MSG_NOSIGNAL);
        if (n <= 0) {
            perror("camera_latency: the socket");
            exit(1);
        }
        sent += (size_t)n;
    }
}

static int open_page(uint16_t port, const char *token)
{
    char request[1024], answer[2048] = "";
    struct sockaddr_in to = {
        .sin_family = AF_INET, .sin_port = htons(port), .sin_addr = {htonl(INADDR_LOOPBACK)}};
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    if (fd < 0 || connect(fd, (struct sockaddr *)&to, sizeof to) != 0) {
        perror("camera_latency: the camera's port");
        exit(1);
    }
    (void)snprintf(
        request, sizeof request,
        "GET /%s/socket HTTP/1.1\r\nHost: 127.0.0.1:%u\r\nOrigin: http://127.0.0.1:%u\r\n"
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        "Sec-WebSocket-Protocol: " CAMERA_PROTOCOL "\r\n\r\n",
        token, (unsigned)port, (unsigned)port);
    send_all(fd, request, strlen(request));
    for (size_t size = 0; !strstr(answer, "\r\n\r\n");) {
        ssize_t n = recv(fd, answer + size, sizeof answer - 1 - size, 0);
        if (n <= 0 || (size += (size_t)n) == sizeof answer - 1) {
            (void)fprintf(stderr, "camera_latency: no page is wanted: %s\n", answer);
            exit(1);
        }
        answer[size] = '\0';
    }
    return fd;
}

static size_t put(unsigned char *out, const void *value, size_t size)
{
    memcpy(out, value, size); /* little-endian, as every machine that this is run on */
    return size;
}

/* A right hand whose fingers open and close, as the page says it; in one WebSocket frame. */
static void send_hand(int fd, const hand_skeleton *skeleton, uint32_t number)
{
    static const unsigned char mask[4] = {0x12, 0x34, 0x56, 0x78};
    const float bent = 0.5f + 0.4f * sinf(0.3f * (float)number), score = 0.9f, nothing = 0.5f;
    const float angle_rad[MRT_ANGLES] = {0.6f, 0.2f, 0.2f, 0.4f, bent, bent, 0.4f, bent, bent,
                                         0.4f, 0.1f, bent, bent, 0.4f, 0.1f, bent, bent, 0.4f};
    const double xyzw[4] = {0.3, 0.1, -0.2, 0.9};
    const rigid wrist = rigid_from_quaternion(xyzw, (vec3){20, -30, 10});
    const double time_ms = (double)clock_now_ns() / 1e6;
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    unsigned char message[1024], frame[1040];
    hand_pose(skeleton, angle_rad, &wrist, joint, palm);
    size_t size = 0, at = 4;
    message[size++] = CAMERA_SEEN;
    size += put(message + size, &number, 4);
    size += put(message + size, &time_ms, 8);
    message[size++] = 1;
    message[size++] = MRT_RIGHT;
    size += put(message + size, &score, 4);
    for (int i = 0; i < MRT_JOINTS; ++i) {
        const float point[3] = {joint[i].x / 1000, -joint[i].y / 1000, -joint[i].z / 1000};
        size += put(message + size, point, sizeof point);
    }
    for (int i = 0; i < 2 * MRT_JOINTS; ++i)
        size += put(message + size, &nothing, 4);
    frame[0] = 0x82;
    frame[1] = 0x80 | 126;
    frame[2] = (unsigned char)(size >> 8);
    frame[3] = (unsigned char)size;
    at += put(frame + at, mask, 4);
    for (size_t i = 0; i < size; ++i)
        frame[at++] = message[i] ^ mask[i % 4];
    send_all(fd, frame, at);
}

/* ---- the stage ---- */

/* Looks as a window does, only more often. Until a face is published whose newest sample is later
 * than `last_ns`; when that was. */
static int64_t await_face(live *stage, int64_t *last_ns)
{
    const int64_t until_ns = clock_now_ns() + patience_ns;
    for (;;) {
        const live_view *view;
        if (live_read_view(stage, &view) && view->sample_ns > *last_ns) {
            *last_ns = view->sample_ns;
            return view->published_ns;
        }
        if (clock_now_ns() > until_ns) {
            (void)fprintf(stderr, "camera_latency: no face follows the hand\n");
            exit(1);
        }
        clock_sleep_until_ns(clock_now_ns() + 100000);
    }
}

static int by_size(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* The median, ms. */
static double measure(live *stage, int fd, const hand_skeleton *skeleton, int frames)
{
    static int64_t took_ns[FRAMES_MAX];
    static uint32_t number;
    static int64_t last_ns;
    for (int i = 0; i < frames; ++i) {
        const int64_t sent_ns = clock_now_ns();
        send_hand(fd, skeleton, number++);
        took_ns[i] = await_face(stage, &last_ns) - sent_ns;
        live_update(stage);
        clock_sleep_until_ns(sent_ns + period_ns);
    }
    qsort(took_ns, (size_t)frames, sizeof *took_ns, by_size);
    printf("from the socket to the published face: p50 %.2f ms, p95 %.2f ms, worst %.2f ms of %d\n",
           (double)took_ns[frames / 2] / 1e6, (double)took_ns[frames * 95 / 100] / 1e6,
           (double)took_ns[frames - 1] / 1e6, frames);
    return (double)took_ns[frames / 2] / 1e6;
}

static void add_plugin(plugin_list *plugins, const char *name)
{
    char path[512];
    error err = {""};
    (void)snprintf(path, sizeof path, "%s/plugins/%s.so", BUILD_DIR, name);
    must(plugin_list_add(plugins, path, &err), &err);
}

int main(int argc, char **argv)
{
    char home[] = "/tmp/camera_latency_XXXXXX", token[CAMERA_TOKEN + 1], address[16], text[64];
    const char *number = argc > 1 && argv[1][0] != '-' ? argv[1] : "300";
    const char *gate = argc > 2 && strcmp(argv[argc - 2], "--gate") == 0 ? argv[argc - 1] : NULL;
    const int frames = atoi(number);
    const uint16_t port = (uint16_t)(20000 + getpid() % 20000);
    const mrt_plugin_type *type;
    plugin_list plugins = {0};
    face_file puppet;
    input *made = NULL;
    live *stage = NULL;
    error err = {""};
    if (frames < 1 || frames > FRAMES_MAX || !mkdtemp(home) ||
        setenv("XDG_CONFIG_HOME", home, 1) != 0) {
        (void)fprintf(stderr, "camera_latency [FRAMES] [--gate MS]\n");
        return 2;
    }
    add_plugin(&plugins, "camera");
    add_plugin(&plugins, "one_hand");
    must(face_file_read(&puppet, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    log_queue *log = log_queue_create();
    const live_settings with = {.plugins = &plugins,
                                .log = log,
                                .face = &puppet,
                                .face_path = SOURCE_DIR "/rigs/puppet/puppet.rig.json",
                                .mapping = "one_hand",
                                .fps = 60.0};
    must(live_start(&stage, &with, &err), &err);
    must(plugin_list_find(&plugins, "camera", MRT_INPUT, &type, &err), &err);
    (void)snprintf(address, sizeof address, "%u", (unsigned)port);
    (void)snprintf(text, sizeof text, "camera:%u", (unsigned)port);
    must(input_create(&made, type, address, "", CLOCK_REAL, log, &err), &err);
    must(live_add_input(stage, made, text, &err), &err);
    read_token(home, token);
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM);
    const int fd = open_page(port, token);
    double best_ms = measure(stage, fd, skeleton, frames);
    for (int i = 1; gate && i < ROUNDS && best_ms > atof(gate); ++i)
        best_ms = fmin(best_ms, measure(stage, fd, skeleton, frames));
    close(fd);
    hand_skeleton_destroy(skeleton);
    must(live_stop(stage, &err), &err);
    face_file_destroy(&puppet);
    plugin_list_destroy(&plugins);
    log_queue_destroy(log);
    (void)snprintf(text, sizeof text, "rm -r %s", home);
    (void)!system(text);
    return gate && best_ms > atof(gate);
}
