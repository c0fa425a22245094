/* Faces that go out: that the newest wins and nobody waits, in the program and in a process of its
 * own; plugins that crash, hang and fail come back; and the bytes of each protocol, read here as
 * its specification says, without the writer's code. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/clock.h"
#include "stage/output/outputs.h"
#include "unit/composer_scene.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define TROUBLED       BUILD_DIR "/tests/plugin/troubled_output.so"
#define TROUBLED_LATER BUILD_DIR "/tests/plugin/troubled_output_later.so"
static const int64_t patience_ns =
    60 * NS_PER_S; /* of a busy machine; nobody waits for it to end */
static char folder[] = "/tmp/marotte-output-XXXXXX";

/* ---- a face that is performed, its outputs, and who listens ---- */

typedef struct stand {
    fixture fixture;
    mrt_pull *pull;
    plugin_list plugins;
    log_queue *log;
    face_board *board;
    outputs *outputs;
    uint64_t published;
} stand;

static void stand_up(stand *s, const char *face_name, isolate_which isolation)
{
    error err = {""};
    *s = (stand){.log = log_queue_create()};
    fixture_set_up(&s->fixture, face_name);
    s->pull = fixture_add_part(&s->fixture, 0, 0);
    const outputs_settings settings = {&s->plugins, s->log, isolation};
    scene_must(face_board_create(&s->board, s->fixture.composer, &s->fixture.file, &err), &err);
    scene_must(outputs_create(&s->outputs, &settings, &err), &err);
    outputs_show(s->outputs, s->board);
}

static void lie_down(stand *s)
{
    outputs_destroy(s->outputs);
    face_board_release(s->board);
    plugin_list_destroy(&s->plugins);
    fixture_tear_down(&s->fixture);
    log_queue_destroy(s->log);
}

/* path: of the library; its plugin is added as "NAME:PORT,params". */
static void add(stand *s, const char *path, int port, const char *params)
{
    char text[1200], *spec = NULL;
    error err = {""};
    (void)snprintf(text, sizeof text, "%s:%d,%s", path, port, params);
    scene_must(plugin_list_choose_spec(&s->plugins, text, MRT_FACE_OUTPUT, &spec, &err), &err);
    scene_must(outputs_add(s->outputs, spec, &err), &err);
    free(spec);
}

static void publish(stand *s)
{
    fixture_move(&s->fixture);
    composer_draw(s->fixture.composer);
    outputs_publish(s->outputs, s->board, s->fixture.composer, clock_now_ns(), -1);
    s->published += 1;
}

static output_status status_of(stand *s, uint32_t index)
{
    output_status out;
    outputs_status(s->outputs, index, &out);
    return out;
}

static int listen_somewhere(int *out_port)
{
    struct sockaddr_in at = {.sin_family = AF_INET};
    socklen_t size = sizeof at;
    int fd = socket(AF_INET, SOCK_DGRAM, 0), room = 4 << 20;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    assert_true(fd >= 0);
    (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    assert_int_equal(bind(fd, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&at, &size), 0);
    *out_port = ntohs(at.sin_port);
    return fd;
}

/* One datagram; 0: none within so many ms. */
static size_t hear(int fd, void *out, size_t capacity, int wait_ms)
{
    struct pollfd wanted = {fd, POLLIN, 0};
    if (poll(&wanted, 1, wait_ms) <= 0)
        return 0;
    ssize_t size = recv(fd, out, capacity, 0);
    return size > 0 ? (size_t)size : 0;
}

/* Publishes until the listener has heard "VERSION NUMBER ..." of that version, and of a face after
 * `after`; returns the number. */
static uint64_t hear_number(stand *s, int fd, int version, uint64_t after)
{
    char text[256];
    for (int64_t until_ns = clock_now_ns() + patience_ns; clock_now_ns() < until_ns;) {
        int heard = 0;
        unsigned long long number = 0;
        publish(s);
        size_t size = hear(fd, text, sizeof text - 1, 10);
        text[size] = '\0';
        if (size > 0 && sscanf(text, "%d %llu", &heard, &number) == 2 && heard == version &&
            number > after)
            return number;
    }
    fail_msg("nothing was heard of version %d after face %ju", version, (uintmax_t)after);
    return 0;
}

static void wait_for_state(stand *s, uint32_t index, output_state state)
{
    for (int64_t until_ns = clock_now_ns() + patience_ns; status_of(s, index).state != state;) {
        if (clock_now_ns() > until_ns)
            fail_msg("output %u is %d, not %d: %s", index, (int)status_of(s, index).state,
                     (int)state, status_of(s, index).trouble);
        publish(s);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
}

/* ---- in the program and in a process ---- */

static void what_is_published_arrives_and_the_newest_wins(void **state)
{
    (void)state;
    static const isolate_which how[] = {ISOLATE_NONE, ISOLATE_ALL};
    for (int i = 0; i < 2; ++i) {
        stand s;
        int port, fd = listen_somewhere(&port);
        char text[64] = "";
        stand_up(&s, "plane", how[i]);
        add(&s, TROUBLED, port, "slow=20");
        (void)hear_number(&s, fd, 1, 0);
        for (int n = 0; n < 400; ++n)
            publish(&s);
        uint64_t last = s.published, heard = 0, count = 0, number = 0;
        while (heard < last && hear(fd, text, sizeof text - 1, 20000) > 0) {
            int version, has_vertices;
            assert_int_equal(
                sscanf(text, "%d %ju %d", &version, (uintmax_t *)&number, &has_vertices), 3);
            assert_true(number >= heard); /* in order */
            assert_int_equal(has_vertices, 1);
            heard = number;
            count += 1;
        }
        assert_int_equal(heard, last); /* the newest is never left out */
        assert_true(count < 400);      /* the others are, by one that is slow */
        assert_int_equal(status_of(&s, 0).is_isolated, i);
        lie_down(&s);
        close(fd);
    }
}

/* Each crash, hang and error is said, and it goes on with the next face. */
static void what_crashes_hangs_or_fails_comes_back(void **state)
{
    (void)state;
    static const char *const trouble[] = {"trouble=1", "trouble=2", "trouble=3"};
    static const char *const messages[] = {"signal 6", "hangs", "it is broken"};
    for (int i = 0; i < 3; ++i) {
        stand s;
        int port, fd = listen_somewhere(&port);
        stand_up(&s, "plane", ISOLATE_ALL);
        add(&s, TROUBLED, port, trouble[i]);
        uint64_t at = 0;
        bool has_said = false;
        while (!has_said) {
            at = hear_number(&s, fd, 1, at);
            log_record line;
            while (log_pop(s.log, &line))
                has_said |= strstr(line.text, messages[i]) != NULL;
        }
        (void)hear_number(&s, fd, 1, s.published);
        lie_down(&s);
        close(fd);
    }
}

static void what_cannot_be_opened_is_said_once_and_costs_nobody_anything(void **state)
{
    (void)state;
    stand s;
    int port, fd = listen_somewhere(&port), lines = 0;
    log_record line;
    stand_up(&s, "plane", ISOLATE_NONE);
    add(&s, TROUBLED, port, "trouble=4");
    add(&s, TROUBLED, port, "");
    (void)hear_number(&s, fd, 1, 0);
    int64_t until_ns = clock_now_ns() + 3 * NS_PER_S; /* it is tried about three times */
    while (clock_now_ns() < until_ns)
        (void)hear_number(&s, fd, 1, s.published);
    while (log_pop(s.log, &line))
        lines += strstr(line.text, "the door is locked") != NULL;
    assert_int_equal(lines, 1);
    assert_int_equal(status_of(&s, 0).state, OUTPUT_FAILED);
    assert_string_equal(status_of(&s, 0).trouble, "the door is locked");
    assert_int_equal(status_of(&s, 1).state, OUTPUT_SENDS);
    lie_down(&s);
    close(fd);
}

static void copy_file(const char *from, const char *to)
{
    char command[2100];
    (void)snprintf(command, sizeof command, "cp '%s' '%s.new' && mv '%s.new' '%s'", from, to, to,
                   to);
    assert_int_equal(system(command), 0);
}

static void a_library_that_was_built_anew_is_taken(void **state)
{
    (void)state;
    stand s;
    int port, fd = listen_somewhere(&port);
    char library[128];
    (void)snprintf(library, sizeof library, "%s/changing.so", folder);
    copy_file(TROUBLED, library);
    stand_up(&s, "plane", ISOLATE_FOREIGN);
    add(&s, library, port, "");
    (void)hear_number(&s, fd, 1, 0);
    copy_file(TROUBLED_LATER, library);
    (void)hear_number(&s, fd, 2, 0);
    assert_true(unlink(library) == 0);
    lie_down(&s);
    close(fd);
}

static void another_face_is_begun_with_its_own_names(void **state)
{
    (void)state;
    error err = {""};
    stand s, other;
    int port, fd = listen_somewhere(&port);
    stand_up(&s, "plane", ISOLATE_ALL);
    stand_up(&other, "puppet", ISOLATE_NONE);
    add(&s, TROUBLED, port, "");
    const uint64_t before = hear_number(&s, fd, 1, 100);
    outputs_show(other.outputs, NULL); /* a board has one taker */
    outputs_show(s.outputs, other.board);
    fixture_move(&other.fixture);
    composer_draw(other.fixture.composer);
    char text[64] = "";
    int64_t until_ns = clock_now_ns() + patience_ns;
    unsigned long long number = 0;
    do { /* the puppet's board counts from 1 */
        outputs_publish(s.outputs, other.board, other.fixture.composer, clock_now_ns(), 7);
        size_t size = hear(fd, text, sizeof text - 1, 1000);
        text[size] = '\0';
        assert_true(clock_now_ns() < until_ns);
    } while (sscanf(text, "1 %llu", &number) != 1 || number >= before);
    /* A face that is not the board's is left out. */
    outputs_publish(s.outputs, s.board, other.fixture.composer, clock_now_ns(), -1);
    outputs_show(s.outputs, NULL);
    (void)err;
    lie_down(&s);
    lie_down(&other);
    close(fd);
}

static void unknown_ones_and_a_ninth_are_refused_in_words(void **state)
{
    (void)state;
    stand s;
    error err = {""};
    stand_up(&s, "plane", ISOLATE_NONE);
    assert_true(outputs_add(s.outputs, "nobody:1", &err) < 0);
    assert_non_null(strstr(err.text, "there is no face output plugin \"nobody\""));
    add(&s, TROUBLED, 9, "");
    assert_true(outputs_add(s.outputs, "troubled_output:9,colour=3", &err) < 0);
    assert_non_null(strstr(err.text, "colour"));
    for (int i = 1; i < OUTPUTS_MAX; ++i)
        scene_must(outputs_add(s.outputs, "troubled_output:9", &err), &err);
    assert_true(outputs_add(s.outputs, "troubled_output:9", &err) < 0);
    outputs_remove(s.outputs, 3);
    assert_int_equal(outputs_count(s.outputs), OUTPUTS_MAX - 1);
    lie_down(&s);
}

/* ---- OSC 1.0, as the specification has it: big endian, everything padded to four bytes ---- */

typedef struct osc_seen {
    char address[64], types[512], name[64];
    float number[8]; /* of an f or i behind the name */
    uint32_t numbers;
    const unsigned char *at;
    size_t size;
} osc_seen;

enum { MESSAGES_MAX = 1024 };
typedef struct osc_frame { /* all messages of one face */
    osc_seen messages[MESSAGES_MAX];
    uint32_t count, bundles;
    size_t largest;
} osc_frame;

static uint32_t big_endian(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | at[3];
}

static size_t padded(size_t size)
{
    return (size + 4) / 4 * 4; /* a text ends with one to four zeros */
}

static void read_osc_message(osc_seen *out, const unsigned char *at, size_t size)
{
    *out = (osc_seen){.at = at, .size = size};
    assert_int_equal(size % 4, 0);
    size_t used = padded(strlen((const char *)at));
    (void)snprintf(out->address, sizeof out->address, "%s", (const char *)at);
    assert_int_equal(at[used], ',');
    const char *types = (const char *)at + used;
    (void)snprintf(out->types, sizeof out->types, "%s", types);
    used += padded(strlen(types));
    for (const char *t = types + 1; *t; ++t) {
        if (*t == 's') {
            if (!out->name[0])
                (void)snprintf(out->name, sizeof out->name, "%s", (const char *)at + used);
            used += padded(strlen((const char *)at + used));
            continue;
        }
        assert_true(*t == 'f' || *t == 'i');
        uint32_t word = big_endian(at + used);
        float value;
        memcpy(&value, &word, sizeof value);
        if (out->numbers < 8)
            out->number[out->numbers++] = *t == 'f' ? value : (float)(int32_t)word;
        used += 4;
    }
    assert_int_equal(used, size);
}

static void read_osc_bundle(osc_frame *out, const unsigned char *at, size_t size)
{
    assert_true(size < 1500 - 28); /* with the heads of IP and UDP */
    assert_memory_equal(at, "#bundle", 8);
    out->bundles += 1;
    out->largest = size > out->largest ? size : out->largest;
    for (size_t used = 16; used < size;) {
        uint32_t length = big_endian(at + used);
        assert_true(out->count < MESSAGES_MAX && used + 4 + length <= size);
        read_osc_message(&out->messages[out->count++], at + used + 4, length);
        used += 4 + length;
    }
}

static const osc_seen *osc_find(const osc_frame *of, const char *address, const char *name)
{
    for (uint32_t i = 0; i < of->count; ++i)
        if (strcmp(of->messages[i].address, address) == 0 &&
            (!name || strcmp(of->messages[i].name, name) == 0))
            return &of->messages[i];
    return NULL;
}

/* The puppet with its jaw half open, its head turned and a smile. */
static void make_a_face(stand *s)
{
    const mrt_face *about = composer_about(s->fixture.composer);
    fixture_hold_contact(&s->fixture, s->pull, "mouth.corner.l", 5.0f, 7.0f, -2.0f);
    fixture_hold_contact(&s->fixture, s->pull, "mouth.corner.r", -5.0f, 7.0f, -2.0f);
    for (uint32_t i = 0; i < about->dof_count; ++i) {
        if (strcmp(about->dofs[i].name, "jaw.open") == 0)
            s->pull->dof[i] = 0.3f;
        if (strcmp(about->dofs[i].name, "skull.turn") == 0)
            s->pull->dof[i] = 0.4f; /* to its left */
        if (strcmp(about->dofs[i].name, "eye.l.pitch") == 0)
            s->pull->dof[i] = 0.2f; /* up */
        if (strcmp(about->dofs[i].name, "lid_upper.l.close") == 0)
            s->pull->dof[i] = 0.5f;
    }
}

/* A whole face: from a message at `first` up to one at `last`. */
static void hear_frame(stand *s, int fd, osc_frame *out, const char *first, const char *last)
{
    static unsigned char kept[2][64][2048]; /* what the last two frames point to */
    static int turn;
    turn = !turn;
    unsigned char(*packets)[2048] = kept[turn];
    int64_t until_ns = clock_now_ns() + patience_ns;
    int n = 0;
    for (bool has_begun = false; clock_now_ns() < until_ns;) {
        if (!has_begun)
            publish(s);
        size_t size = hear(fd, packets[n], sizeof kept[0][0], 200);
        if (size == 0)
            continue;
        osc_frame one = {.count = 0};
        read_osc_bundle(&one, packets[n], size);
        if (strcmp(one.messages[0].address, first) == 0 &&
            (!has_begun || strcmp(first, last) != 0)) {
            *out = (osc_frame){.count = 0};
            has_begun = true;
        }
        if (!has_begun)
            continue;
        read_osc_bundle(out, packets[n], size);
        n += 1;
        assert_true(n < 64);
        if (strcmp(out->messages[out->count - 1].address, last) == 0)
            return;
    }
    fail_msg("no whole face was heard");
}

static void shipped(char out[1024], const char *name)
{
    (void)snprintf(out, 1024, "%s/plugins/%s.so", BUILD_DIR, name);
}

static void expect_near(float got, double expected, double within, const char *what)
{
    if (!(fabs((double)got - expected) <= within))
        fail_msg("%s is %g instead of %g", what, (double)got, expected);
}

static void vmc_says_bones_and_blend_shapes_as_the_protocol_has_them(void **state)
{
    (void)state;
    static osc_frame frame;
    stand s;
    char path[1024];
    int port, fd = listen_somewhere(&port);
    shipped(path, "vmc");
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    make_a_face(&s);
    add(&s, path, port, "");
    hear_frame(&s, fd, &frame, "/VMC/Ext/OK", "/VMC/Ext/Blend/Apply");
    assert_true(frame.bundles >= 2);
    assert_string_equal(frame.messages[0].types, ",i");
    expect_near(frame.messages[0].number[0], 1, 0, "OK");
    assert_string_equal(osc_find(&frame, "/VMC/Ext/T", NULL)->types, ",f");
    const osc_seen *head = osc_find(&frame, "/VMC/Ext/Bone/Pos", "Head");
    assert_non_null(head);
    assert_string_equal(head->types, ",sfffffff");
    /* Unity is left-handed: a turn about +y goes to the right there, and this one is to the left.
     */
    expect_near(head->number[4], -sin(0.2), 1e-3, "the head's y");
    expect_near(head->number[6], cos(0.2), 1e-3, "the head's w");
    const osc_seen *eye = osc_find(&frame, "/VMC/Ext/Bone/Pos", "LeftEye");
    assert_non_null(eye); /* about the head, whose turn is not in it; about -x: up */
    expect_near(eye->number[3], -sin(0.1), 1e-3, "the eye's x");
    expect_near(eye->number[4], 0, 1e-3, "the eye's y");
    assert_null(osc_find(&frame, "/VMC/Ext/Bone/Pos", "Jaw"));
    assert_null(osc_find(&frame, "/VMC/Ext/Bone/Pos", "Hips"));
    uint32_t blends = 0;
    for (uint32_t i = 0; i < frame.count; ++i)
        if (strcmp(frame.messages[i].address, "/VMC/Ext/Blend/Val") == 0) {
            blends += 1;
            assert_string_equal(frame.messages[i].types, ",sf");
            assert_true(frame.messages[i].number[0] >= 0.0f && frame.messages[i].number[0] <= 1.0f);
        }
    assert_int_equal(blends, 52 + 13);
    static const char *const some[] = {"EyeBlinkLeft", "TongueOut", "BrowInnerUp", "A",
                                       "Blink_R",      "Joy",       "JawOpen"};
    for (size_t i = 0; i < sizeof some / sizeof *some; ++i)
        if (!osc_find(&frame, "/VMC/Ext/Blend/Val", some[i]))
            fail_msg("no %s", some[i]);
    static const char *const seen[] = {"JawOpen", "MouthSmileLeft", "EyeBlinkLeft", "A"};
    for (size_t i = 0; i < sizeof seen / sizeof *seen; ++i) {
        float weight = osc_find(&frame, "/VMC/Ext/Blend/Val", seen[i])->number[0];
        if (!(weight > 0.1f && weight <= 1.0f))
            fail_msg("%s is %g of a face that smiles, blinks and opens its mouth", seen[i],
                     (double)weight);
    }
    lie_down(&s);
    unsigned char packet[2048];
    while (hear(fd, packet, sizeof packet, 0) > 0) /* what was sent before is not the next one's */
        ;

    stand_up(&s, "puppet", ISOLATE_ALL);
    add(&s, path, port, "role=performer,names=presets,jaw=on");
    hear_frame(&s, fd, &frame, "/VMC/Ext/OK", "/VMC/Ext/Blend/Apply");
    assert_string_equal(osc_find(&frame, "/VMC/Ext/Root/Pos", "root")->types, ",sfffffff");
    uint32_t bone_count = 0;
    for (uint32_t i = 0; i < frame.count; ++i)
        bone_count += strcmp(frame.messages[i].address, "/VMC/Ext/Bone/Pos") == 0;
    assert_int_equal(bone_count, 55);
    assert_non_null(osc_find(&frame, "/VMC/Ext/Bone/Pos", "RightLittleDistal"));
    assert_null(osc_find(&frame, "/VMC/Ext/Blend/Val", "EyeBlinkLeft"));
    lie_down(&s);
    close(fd);
}

static void face_osc_says_named_numbers(void **state)
{
    (void)state;
    static osc_frame frame;
    stand s;
    char path[1024];
    int port, fd = listen_somewhere(&port);
    shipped(path, "face_osc");
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    make_a_face(&s);
    add(&s, path, port, "weights=off,contacts=off,shapes=off");
    hear_frame(&s, fd, &frame, "/marotte/1/face", "/marotte/1/face");
    const mrt_face *about = composer_about(s.fixture.composer);
    const osc_seen *all = &frame.messages[0];
    assert_int_equal(frame.count, 1);
    assert_int_equal(strlen(all->types), 1 + 2 * about->dof_count);
    assert_string_equal(all->name, about->dofs[0].name); /* skull.turn */
    expect_near(all->number[0], 0.4, 0.01, all->name);
    lie_down(&s);
    close(fd);
}

/* ---- Live Link Face: a table of bytes ---- */

static float big_endian_float(const unsigned char *at)
{
    uint32_t word = big_endian(at);
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* What face_osc says of this name, of the face that is published again and again. */
static float said_by_osc(const osc_frame *frame, const char *name)
{
    for (uint32_t i = 0; i < frame->count; ++i) {
        const unsigned char *at = frame->messages[i].at;
        size_t used = padded(strlen((const char *)at));
        const char *types = (const char *)at + used;
        used += padded(strlen(types));
        for (const char *t = types + 1; *t; t += 2) {
            const char *word = (const char *)at + used;
            used += padded(strlen(word));
            if (strcmp(word, name) == 0)
                return big_endian_float(at + used);
            used += 4;
        }
    }
    return NAN;
}

static const struct {
    int place;
    const char *name;
} live_link_table[] = {{0, "EyeBlinkLeft"},     {1, "EyeLookDownLeft"},   {6, "EyeWideLeft"},
                       {7, "EyeBlinkRight"},    {14, "JawForward"},       {15, "JawLeft"},
                       {16, "JawRight"},        {17, "JawOpen"},          {18, "MouthClose"},
                       {21, "MouthLeft"},       {22, "MouthRight"},       {23, "MouthSmileLeft"},
                       {24, "MouthSmileRight"}, {31, "MouthRollLower"},   {41, "BrowDownLeft"},
                       {43, "BrowInnerUp"},     {45, "BrowOuterUpRight"}, {46, "CheekPuff"},
                       {50, "NoseSneerRight"},  {51, "TongueOut"},        {52, "HeadYaw"},
                       {53, "HeadPitch"},       {55, "LeftEyeYaw"},       {59, "RightEyePitch"}};

static void livelink_sends_the_datagram_of_the_app(void **state)
{
    (void)state;
    static osc_frame frame[2]; /* it says the 52 in two bundles */
    for (int swap = 0; swap < 2; ++swap) {
        stand s;
        char path[1024];
        unsigned char packet[2048];
        int port, fd = listen_somewhere(&port), osc_port, osc_fd = listen_somewhere(&osc_port);
        stand_up(&s, "puppet", ISOLATE_FOREIGN);
        make_a_face(&s);
        shipped(path, "livelink");
        add(&s, path, port, swap ? "swap_laterals=on,subject=3" : "");
        shipped(path, "face_osc");
        add(&s, path, osc_port, "contacts=off,shapes=off,motions=off");
        for (int i = 0; i < 20; ++i)
            hear_frame(&s, osc_fd, &frame[i % 2], "/marotte/1/face", "/marotte/1/face");
        while (hear(fd, packet, sizeof packet, 0) > 0)
            ;
        publish(&s);
        const char *subject = swap ? "marotte3" : "marotte";
        size_t n = strlen(subject);
        assert_int_equal(hear(fd, packet, sizeof packet, 60000), 306 + n);
        assert_int_equal(packet[0], 6);
        assert_int_equal(big_endian(packet + 1), 36);
        assert_int_equal(big_endian(packet + 41), n);
        assert_memory_equal(packet + 45, subject, n);
        const unsigned char *at = packet + 45 + n;
        assert_true(big_endian(at) < 24 * 3600 * 60);
        assert_true(big_endian_float(at + 4) >= 0.0f && big_endian_float(at + 4) < 1.0f);
        assert_int_equal(big_endian(at + 8), 60);
        assert_int_equal(big_endian(at + 12), 1);
        assert_int_equal(at[16], 61);
        for (size_t i = 0; i < sizeof live_link_table / sizeof *live_link_table; ++i) {
            int place = live_link_table[i].place;
            if (swap && (place == 15 || place == 16 || place == 21 || place == 22))
                place = place % 2 ? place + 1 : place - 1;
            const char *name = live_link_table[i].name;
            float messages = said_by_osc(&frame[0], name);
            if (isnan(messages))
                messages = said_by_osc(&frame[1], name);
            expect_near(big_endian_float(at + 17 + 4 * place), (double)messages, 5e-3, name);
        }
        lie_down(&s);
        close(fd);
        close(osc_fd);
    }
}

/* ---- iFacialMocap: it is greeted, and answers to the port that receivers listen at ---- */

static int listen_at(const char *host, uint16_t port)
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_port = htons(port)};
    int fd = socket(AF_INET, SOCK_DGRAM, 0);
    at.sin_addr.s_addr = inet_addr(host);
    if (fd >= 0 && bind(fd, (struct sockaddr *)&at, sizeof at) == 0)
        return fd;
    close(fd);
    return -1;
}

static void read_ifacialmocap(const char *text, char between)
{
    static const char *const some[] = {"mouthSmile_L", "eyeBlink_R", "jawOpen",    "jawLeft",
                                       "mouthRight",   "tongueOut",  "browInnerUp"};
    char copy[4096], *rest = copy;
    int shapes = 0, found = 0, value;
    float x, y, z;
    (void)snprintf(copy, sizeof copy, "%s", text);
    for (char *part = strtok_r(rest, "|", &rest); part; part = strtok_r(NULL, "|", &rest)) {
        char *number = strrchr(part, between);
        if (strchr(part, '#')) {
            const char *values = strchr(part, '#') + 1;
            assert_int_equal(sscanf(values, "%f,%f,%f", &x, &y, &z), 3);
            found += strncmp(part, "=head#", 6) == 0 || strncmp(part, "leftEye#", 8) == 0 ||
                     strncmp(part, "rightEye#", 9) == 0;
            continue;
        }
        assert_non_null(number);
        *number = '\0';
        assert_int_equal(sscanf(number + 1, "%d", &value), 1);
        if (strcmp(part, "trackingStatus") == 0) {
            assert_int_equal(value, 1);
            continue;
        }
        assert_true(value >= 0 && value <= 100);
        shapes += 1;
        for (size_t i = 0; i < sizeof some / sizeof *some; ++i)
            found += strcmp(part, some[i]) == 0;
    }
    assert_int_equal(shapes, 52);
    assert_int_equal(found, 3 + (int)(sizeof some / sizeof *some));
}

static void ifacialmocap_answers_its_greeting_in_both_versions(void **state)
{
    (void)state;
    static const char *const greeting[] = {
        "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719",
        "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719|sendDataVersion=v2"};
    stand s;
    char path[1024], text[4096];
    struct sockaddr_in phone = {.sin_family = AF_INET, .sin_port = htons(49983)};
    phone.sin_addr.s_addr = inet_addr("127.0.0.2");
    int fd = listen_at("127.0.0.3", 49983), taken = listen_at("127.0.0.2", 49983);
    if (fd < 0 || taken < 0) {
        printf("SKIPPED: port 49983 is in use here\n");
        skip();
    }
    error err = {""};
    shipped(path, "ifacialmocap");
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    add(&s, path, 49983, ""); /* loads it; of this computer's usual address */
    outputs_remove(s.outputs, 0);
    scene_must(outputs_add(s.outputs, "ifacialmocap:127.0.0.2:49983", &err), &err);
    int64_t until_ns = clock_now_ns() + patience_ns;
    while (status_of(&s, 0).state != OUTPUT_FAILED && clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    assert_non_null(strstr(status_of(&s, 0).trouble, "49983")); /* the port is in use */
    close(taken);                                               /* and comes back by itself */
    while (status_of(&s, 0).state != OUTPUT_NO_RECEIVER && clock_now_ns() < until_ns)
        publish(&s);
    for (int version = 0; version < 2; ++version) {
        size_t size = 0;
        (void)sendto(fd, "garbage\0|&", 10, 0, (struct sockaddr *)&phone, sizeof phone);
        (void)sendto(fd, greeting[version], strlen(greeting[version]), 0, (struct sockaddr *)&phone,
                     sizeof phone);
        do {
            publish(&s);
            size = hear(fd, text, sizeof text - 1, 20);
            text[size] = '\0';
            assert_true(clock_now_ns() < until_ns);
        } while (!strchr(text, version ? '&' : '-') || (version == 0 && strchr(text, '&')));
        read_ifacialmocap(text, version ? '&' : '-');
    }
    assert_int_equal(status_of(&s, 0).state, OUTPUT_SENDS);
    lie_down(&s);
    close(fd);
}

/* A greeting may be forged: whoever is sent to without listening is forgotten. */
static void ifacialmocap_forgets_who_does_not_listen(void **state)
{
    (void)state;
    static const char greeting[] = "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719";
    stand s;
    char path[1024], text[4096];
    struct sockaddr_in phone = {.sin_family = AF_INET, .sin_port = htons(49983)};
    phone.sin_addr.s_addr = inet_addr("127.0.0.4");
    int free_here = listen_at("127.0.0.4", 49983);
    if (free_here < 0) {
        printf("SKIPPED: port 49983 is in use here\n");
        skip();
    }
    close(free_here);
    error err = {""};
    shipped(path, "ifacialmocap");
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    add(&s, path, 49983, ""); /* loads it; of this computer's usual address */
    outputs_remove(s.outputs, 0);
    scene_must(outputs_add(s.outputs, "ifacialmocap:127.0.0.4:49983", &err), &err);
    wait_for_state(&s, 0, OUTPUT_NO_RECEIVER);
    for (int round = 0; round < 2; ++round) { /* and it may come back */
        int fd = listen_at("127.0.0.5", 49983);
        int64_t until_ns = clock_now_ns() + patience_ns;
        assert_true(fd >= 0);
        (void)sendto(fd, greeting, sizeof greeting - 1, 0, (struct sockaddr *)&phone, sizeof phone);
        do
            publish(&s);
        while (hear(fd, text, sizeof text, 20) == 0 && clock_now_ns() < until_ns);
        wait_for_state(&s, 0, OUTPUT_SENDS);
        close(fd);
        if (round == 0)
            wait_for_state(&s, 0, OUTPUT_NO_RECEIVER);
    }
    lie_down(&s);
}

static void a_second_program_that_is_the_same_device_waits_for_the_first(void **state)
{
    (void)state;
    stand s;
    char path[1024];
    int port, fd = listen_somewhere(&port);
    shipped(path, "livelink");
    stand_up(&s, "plane", ISOLATE_FOREIGN);
    add(&s, path, port, "");
    wait_for_state(&s, 0, OUTPUT_SENDS);
    add(&s, path, port, "");
    wait_for_state(&s, 1, OUTPUT_FAILED);
    assert_non_null(strstr(status_of(&s, 1).trouble, "set subject=2"));
    add(&s, path, port, "subject=2");
    wait_for_state(&s, 2, OUTPUT_SENDS);
    outputs_remove(s.outputs, 0);
    wait_for_state(&s, 0, OUTPUT_SENDS);
    lie_down(&s);
    close(fd);
}

/* ---- VTube Studio, whoever is there in its place ---- */

static int serve_somewhere(int *out_port)
{
    struct sockaddr_in at = {.sin_family = AF_INET};
    socklen_t size = sizeof at;
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    assert_true(fd >= 0);
    assert_int_equal(bind(fd, (struct sockaddr *)&at, sizeof at), 0);
    assert_int_equal(listen(fd, 8), 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&at, &size), 0);
    *out_port = ntohs(at.sin_port);
    return fd;
}

static int accept_while_published(stand *s, int fd)
{
    for (int64_t until_ns = clock_now_ns() + patience_ns; clock_now_ns() < until_ns; publish(s)) {
        struct pollfd wanted = {fd, POLLIN, 0};
        if (poll(&wanted, 1, 10) > 0)
            return accept(fd, NULL, NULL);
    }
    fail_msg("nobody asks");
    return -1;
}

/* Noise before and after the greeting, frames that are none, and an end: it asks again each time.
 */
static void garbage_in_place_of_vtube_studio_is_borne(void **state)
{
    (void)state;
    static const char welcome[] = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                                  "Connection: Upgrade\r\nSec-WebSocket-Accept: nonsense\r\n\r\n";
    stand s;
    char path[1024], noise[4096];
    int port, fd = serve_somewhere(&port);
    uint32_t random = 1;
    shipped(path, "vts");
    stand_up(&s, "plane", ISOLATE_FOREIGN);
    add(&s, path, port, "");
    for (int round = 0; round < 3; ++round) {
        int peer = accept_while_published(&s, fd);
        for (size_t i = 0; i < sizeof noise; ++i)
            noise[i] = (char)((random = random * 1664525u + 1013904223u) >> 24);
        if (round > 0)
            (void)!send(peer, welcome, sizeof welcome - 1, MSG_NOSIGNAL);
        (void)!send(peer, noise, sizeof noise, MSG_NOSIGNAL);
        publish(&s);
        close(peer);
    }
    wait_for_state(&s, 0, OUTPUT_NO_RECEIVER);
    lie_down(&s);
    close(fd);
}

/* ---- what they cost the frame ---- */

enum { COST_FRAMES = 300 };

static double cpu_now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static int by_cost(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How often this thread has waited for another. */
static unsigned long waits_now(void)
{
    char line[256];
    unsigned long count = 0;
    FILE *file = fopen("/proc/thread-self/status", "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file))
        if (sscanf(line, "voluntary_ctxt_switches: %lu", &count) == 1)
            break;
    fclose(file);
    return count;
}

typedef struct frame_cost { /* ms of this thread */
    double p50, p99;
    unsigned long waits; /* while it published */
} frame_cost;

static frame_cost cost_of_frames(stand *s)
{
    static double took[COST_FRAMES];
    frame_cost out = {.waits = 0};
    for (int i = 0; i < COST_FRAMES; ++i) {
        double before_ms = cpu_now_ms();
        int64_t before_ns = clock_now_ns();
        fixture_move(&s->fixture);
        composer_draw(s->fixture.composer);
        double drawn_ms = cpu_now_ms();
        unsigned long before = waits_now();
        double looked_ms = cpu_now_ms();
        if (outputs_are_wanted(s->outputs))
            outputs_publish(s->outputs, s->board, s->fixture.composer, clock_now_ns(), -1);
        took[i] = cpu_now_ms() - looked_ms + drawn_ms - before_ms;
        out.waits += waits_now() - before;
        clock_sleep_until_ns(before_ns + NS_PER_S / 150);
    }
    qsort(took, COST_FRAMES, sizeof *took, by_cost);
    out.p50 = took[COST_FRAMES / 2];
    out.p99 = took[COST_FRAMES * 99 / 100];
    return out;
}

static void tell_cost(const char *of, const frame_cost *c)
{
    printf("  %-26s p50 %.3f ms, p99 %.3f ms of the thread; %lu waits\n", of, c->p50, c->p99,
           c->waits);
}

/* The processor's time of the thread that publishes, in one run; and it never waits. */
static void who_hangs_and_a_network_that_is_gone_cost_the_frame_nothing(void **state)
{
    (void)state;
    stand s;
    error err = {""};
    char path[1024];
    int udp_port, udp = listen_somewhere(&udp_port), port, mute = serve_somewhere(&port);
    double ratio = 1e9;
    unsigned long waits = 1;
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    make_a_face(&s);
    for (int again = 0; again < 5 && (ratio >= 1.5 || waits > 0); ++again) {
        frame_cost without = cost_of_frames(&s);
        shipped(path, "vmc");
        add(&s, path, udp_port, "");
        frame_cost well = cost_of_frames(&s);
        add(&s, TROUBLED, udp_port, "trouble=2"); /* hangs in its process */
        shipped(path, "vts");
        add(&s, path, port, ""); /* is let in, and never answered */
        scene_must(outputs_add(s.outputs, "vmc:nowhere.invalid:1", &err), &err);
        scene_must(outputs_add(s.outputs, "vmc:192.0.2.1:9", &err), &err); /* nobody's network */
        frame_cost badly = cost_of_frames(&s);
        tell_cost("no output", &without);
        tell_cost("one that is heard", &well);
        tell_cost("and four in trouble", &badly);
        ratio = badly.p50 / without.p50;
        printf("  ratio of p50 %.2f, of p99 %.2f\n", ratio, badly.p99 / without.p99);
        waits = badly.waits;
        while (outputs_count(s.outputs) > 0)
            outputs_remove(s.outputs, 0);
    }
    assert_int_equal(waits, 0);
#if !defined(__SANITIZE_THREAD__) /* it watches what fills the board, not the sums of a frame */
    assert_true(ratio < 1.5);
#endif
    lie_down(&s);
    close(udp);
    close(mute);
}

/* ---- how late, how many ---- */

static void nothing_is_lost_on_loopback_and_it_is_soon_there(void **state)
{
    (void)state;
    enum { FACES = 300 };
    stand s;
    char path[1024];
    unsigned char packet[2048];
    int port, fd = listen_somewhere(&port);
    uint32_t heard = 0;
    shipped(path, "vmc");
    stand_up(&s, "puppet", ISOLATE_FOREIGN);
    make_a_face(&s);
    add(&s, path, port, "names=presets");
    static osc_frame frame;
    hear_frame(&s, fd, &frame, "/VMC/Ext/OK", "/VMC/Ext/Blend/Apply");
    while (hear(fd, packet, sizeof packet, 50) > 0)
        ;
    uint64_t before = status_of(&s, 0).sent;
    int64_t next_ns = clock_now_ns();
    for (int i = 0; i < FACES; ++i) {
        publish(&s);
        next_ns += NS_PER_S / 150;
        clock_sleep_until_ns(next_ns);
    }
    while (hear(fd, packet, sizeof packet, 2000) > 0 && heard < status_of(&s, 0).sent - before)
        heard += 1;
    output_status now = status_of(&s, 0);
    printf("vmc at 150 Hz: %ju sent, %u heard, %ju replaced; sample to sent p50 %.2f ms, p99 %.2f "
           "ms\n",
           (uintmax_t)(now.sent - before), heard, (uintmax_t)now.replaced, now.p50_ms, now.p99_ms);
    assert_true(heard >= now.sent - before - 4); /* those on their way when it was asked */
    assert_true(now.p50_ms < 1000.0);            /* of a machine that does other things */
    lie_down(&s);
    close(fd);
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_published_arrives_and_the_newest_wins),
        cmocka_unit_test(what_crashes_hangs_or_fails_comes_back),
        cmocka_unit_test(what_cannot_be_opened_is_said_once_and_costs_nobody_anything),
        cmocka_unit_test(a_library_that_was_built_anew_is_taken),
        cmocka_unit_test(another_face_is_begun_with_its_own_names),
        cmocka_unit_test(unknown_ones_and_a_ninth_are_refused_in_words),
        cmocka_unit_test(vmc_says_bones_and_blend_shapes_as_the_protocol_has_them),
        cmocka_unit_test(face_osc_says_named_numbers),
        cmocka_unit_test(livelink_sends_the_datagram_of_the_app),
        cmocka_unit_test(ifacialmocap_answers_its_greeting_in_both_versions),
        cmocka_unit_test(ifacialmocap_forgets_who_does_not_listen),
        cmocka_unit_test(a_second_program_that_is_the_same_device_waits_for_the_first),
        cmocka_unit_test(garbage_in_place_of_vtube_studio_is_borne),
        cmocka_unit_test(who_hangs_and_a_network_that_is_gone_cost_the_frame_nothing),
        cmocka_unit_test(nothing_is_lost_on_loopback_and_it_is_soon_there),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
