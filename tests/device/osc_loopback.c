/* The OSC plugin over real sockets of this computer: from one instance to another, from a plain
 * liblo client, from a sender that is killed, and from datagrams of nonsense. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "osc_network.h"

#include <lo/lo.h>

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

static const int64_t ms_ns = 1000000, s_ns = 1000000000;
static const int64_t patience_ns = 60000000000; /* of a busy machine */
static const mrt_channel glove[3] = {
    {"right.index.mpj", "count", MRT_CH_ANGLE + 4, MRT_RIGHT, 1, 255},
    {"battery", "mV", MRT_CH_OTHER, MRT_NO_HAND, 0, 9000},
    {"pedal.1", "1", MRT_CH_PEDAL, MRT_NO_HAND, 0, 1},
};

typedef struct wire {
    uint16_t port;
    char to[32];      /* for an output */
    char from[3][64]; /* for an input: simple, "glove", "other" */
    int fd;           /* sends raw bytes */
    input_host *in, *out;
} wire;

static int set_up(void **state)
{
    wire *w = calloc(1, sizeof *w);
    uint16_t own_port = 0;
    w->port = osc_network_free_port();
    w->fd = osc_network_socket(&own_port);
    if (w->port == 0 || w->fd < 0) {
        print_message("SKIPPED: sockets are refused here: %s\n", strerror(errno));
        free(w);
        exit(77);
    }
    snprintf(w->to, sizeof w->to, "127.0.0.1:%u", (unsigned)w->port);
    snprintf(w->from[0], sizeof w->from[0], "%u", (unsigned)w->port);
    snprintf(w->from[1], sizeof w->from[1], "udp:localhost:%u/glove", (unsigned)w->port);
    snprintf(w->from[2], sizeof w->from[2], "%u/other", (unsigned)w->port);
    w->in = osc_node_create();
    w->out = osc_node_create();
    *state = w;
    return 0;
}

static int tear_down(void **state)
{
    wire *w = *state;
    input_host_destroy(w->in);
    input_host_destroy(w->out);
    close(w->fd);
    free(w);
    return 0;
}

static int64_t now_ns(void)
{
    return input_host_now_ns(NULL);
}

static void write_as(wire *w, const char *source, uint32_t sequence, float pedal)
{
    mrt_sample sample = {.time_ns = now_ns(),
                         .sequence = sequence,
                         .count = 3,
                         .value = {(float)sequence * 1.1f, -0.0f, pedal}};
    assert_int_equal(w->out->output->write(w->out->plugin, source, glove, &sample), MRT_OK);
}

/* The output has said its channels, so that the input opens at once. */
static void connect_glove(wire *w)
{
    assert_int_equal(osc_node_open_output(w->out, w->to), MRT_OK);
    write_as(w, "glove", 0, 0);
    assert_int_equal(input_host_open(w->in, w->from[1]), MRT_OK);
    mrt_sample sample; /* it follows the channels, or is repeated */
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
}

static void an_input_has_the_outputs_channels_and_every_bit(void **state)
{
    wire *w = *state;
    connect_glove(w);
    uint32_t count;
    const mrt_channel *channel = w->in->input->channels(w->in->plugin, &count);
    assert_int_equal(count, 3);
    for (uint32_t i = 0; i < count; ++i) {
        assert_string_equal(channel[i].name, glove[i].name);
        assert_string_equal(channel[i].unit, glove[i].unit);
        assert_int_equal(channel[i].semantic, glove[i].semantic);
        assert_int_equal(channel[i].hand, glove[i].hand);
        assert_true(channel[i].min == glove[i].min && channel[i].max == glove[i].max);
    }
    uint32_t last = 0;
    for (uint32_t i = 1; i <= 200; ++i) {
        uint32_t sequence = i < 100 ? i : i + 5; /* five are lost on the way to the output */
        write_as(w, "glove", sequence, 0);
        mrt_sample sample;
        assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
        float expected[3] = {(float)sequence * 1.1f, -0.0f, 0};
        assert_memory_equal(sample.value, expected, sizeof expected);
        assert_int_equal(sample.count, 3);
        if (i > 1)
            assert_int_equal(sample.sequence - last, i == 100 ? 6 : 1);
        last = sample.sequence;
    }
    assert_int_equal(w->in->said[MRT_LOG_WARNING], 0);
}

static void times_are_those_of_the_measurement(void **state)
{
    wire *w = *state;
    connect_glove(w);
    double sum = 0, squares = 0, worst = 0;
    int count = 0;
    for (uint32_t i = 1; i <= 300; ++i) {
        int64_t measured_ns = now_ns(), next_ns = measured_ns + s_ns / 150;
        write_as(w, "glove", i, 0);
        mrt_sample sample;
        assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
        assert_true(sample.time_ns <= now_ns());
        double error_ms = (double)(sample.time_ns - measured_ns) / 1e6;
        if (i > 30) { /* the first ones find the clock's offset */
            sum += error_ms;
            squares += error_ms * error_ms;
            worst = fmax(worst, fabs(error_ms));
            count += 1;
        }
        while (now_ns() < next_ns - 2 * ms_ns) /* on a busy machine it may be repeated meanwhile */
            assert_true(input_host_read(w->in, next_ns - now_ns(), &sample) >= 0);
    }
    double sd_ms = sqrt(squares / count - sum / count * (sum / count));
    print_message("time error at 150 Hz: mean %.3f, sd %.3f, worst %.3f ms\n", sum / count, sd_ms,
                  worst);
    assert_true(sd_ms < 1.0);
}

static int64_t cpu_ns(void)
{
    struct rusage used;
    getrusage(RUSAGE_SELF, &used);
    return (used.ru_utime.tv_sec + used.ru_stime.tv_sec) * s_ns +
           (used.ru_utime.tv_usec + used.ru_stime.tv_usec) * 1000;
}

static void read_waits_for_its_deadline_and_does_not_spin(void **state)
{
    wire *w = *state;
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    int64_t cpu_before_ns = cpu_ns(), before_ns = now_ns();
    for (int i = 0; i < 10; ++i) {
        mrt_sample sample;
        int64_t deadline_ns = now_ns() + 50 * ms_ns;
        assert_int_equal(input_host_read(w->in, 50 * ms_ns, &sample), MRT_TIMEOUT);
        assert_true(now_ns() > deadline_ns - 3 * ms_ns);
    }
    double share = (double)(cpu_ns() - cpu_before_ns) / (double)(now_ns() - before_ns);
    print_message("waiting takes %.2f %% of a core\n", 100 * share);
    assert_true(share < 0.1);
}

static void two_hands_share_a_port(void **state)
{
    wire *w = *state;
    input_host *left = osc_node_create();
    left->params[OSC_HAND] = MRT_LEFT;
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    assert_int_equal(input_host_open(left, w->from[0]), MRT_OK);
    osc_bytes packet = {.size = 0};
    mrt_sample sample;
    for (int i = 0; i < 10; ++i) {
        osc_bytes_message(&packet, "/marotte/hand/left/joint", "if", 4, 0.25);
        osc_network_send(w->fd, w->port, &packet);
        osc_bytes_message(&packet, "/marotte/hand/right/joint", "if", 4, 0.5);
        osc_network_send(w->fd, w->port, &packet);
        assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
        assert_true(sample.value[4] == 0.5f);
        assert_int_equal(input_host_read(left, s_ns, &sample), MRT_OK);
        assert_true(sample.value[4] == 0.25f);
    }
    input_host_destroy(left); /* the other one keeps the port */
    osc_bytes_message(&packet, "/marotte/hand/right/joint", "if", 4, 0.75);
    osc_network_send(w->fd, w->port, &packet);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[4] == 0.75f);
}

/* Reads on a thread of its own, as the host does. */
typedef struct reader {
    input_host *node;
    uint32_t wanted;
    _Atomic uint32_t got;
    uint32_t lost;
} reader;

static void *read_all(void *data)
{
    reader *r = data;
    uint32_t next = 0;
    int64_t until_ns = now_ns() + patience_ns;
    while (r->got < r->wanted && now_ns() < until_ns) {
        mrt_sample sample;
        mrt_result result = input_host_read(r->node, 100 * ms_ns, &sample);
        if (result < 0)
            break;
        if (result != MRT_OK)
            continue;
        if (r->got > 0)
            r->lost += sample.sequence - next;
        next = sample.sequence + 1;
        r->got += 1;
    }
    return NULL;
}

static void two_sources_are_read_by_two_threads_at_one_port(void **state)
{
    enum { SAMPLES = 2000, AHEAD = 16 };
    wire *w = *state;
    connect_glove(w);
    input_host *other = osc_node_create();
    write_as(w, "other", 0, 0);
    assert_int_equal(input_host_open(other, w->from[2]), MRT_OK);
    reader readers[2] = {{w->in, SAMPLES, 0, 0}, {other, SAMPLES, 0, 0}};
    pthread_t thread[2];
    for (int i = 0; i < 2; ++i)
        assert_int_equal(pthread_create(&thread[i], NULL, read_all, &readers[i]), 0);
    for (uint32_t i = 1; i <= SAMPLES + 1; ++i) {
        write_as(w, "glove", i, 0);
        write_as(w, "other", i, 0);
        int64_t until_ns = now_ns() + patience_ns; /* what nobody reads in time the system drops */
        while ((readers[0].got + AHEAD < i || readers[1].got + AHEAD < i) && now_ns() < until_ns)
            input_host_wait(&w->out->host, now_ns() + ms_ns / 10);
    }
    for (int i = 0; i < 2; ++i)
        pthread_join(thread[i], NULL);
    for (int i = 0; i < 2; ++i) {
        assert_int_equal(readers[i].got, SAMPLES);
        assert_int_equal(readers[i].lost, 0);
    }
    input_host_destroy(other);
}

/* Forwards "glove" with the pedal down until it is killed. */
static pid_t start_sender(wire *w)
{
    pid_t child = fork();
    if (child != 0)
        return child;
    input_host *node = osc_node_create();
    uint32_t sequence = 0;
    if (osc_node_open_output(node, w->to) < 0)
        _exit(1);
    for (;;) {
        mrt_sample sample = {
            .time_ns = now_ns(), .sequence = sequence++, .count = 3, .value = {5, 6, 1}};
        (void)node->output->write(node->plugin, "glove", glove, &sample);
        input_host_wait(&node->host, now_ns() + 10 * ms_ns);
    }
}

static void kill_sender(pid_t sender)
{
    kill(sender, SIGKILL);
    waitpid(sender, NULL, 0);
}

/* As the host does: opens again until it works. */
static bool reopens(input_host *node, const char *address)
{
    int64_t before_ns = now_ns();
    node->input->close(node->plugin);
    while (input_host_open(node, address) < 0)
        if (now_ns() - before_ns > patience_ns)
            return false;
    return true;
}

/* The port alone is enough: with nothing else there, what is forwarded is what is meant. */
static void a_port_without_a_source_follows_what_is_forwarded_to_it(void **state)
{
    wire *w = *state;
    mrt_sample sample;
    uint32_t count;
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    assert_int_equal(input_host_read(w->in, 50 * ms_ns, &sample), MRT_TIMEOUT);
    assert_int_equal(osc_node_open_output(w->out, w->to), MRT_OK);
    write_as(w, "glove", 0, 0);
    mrt_result result = MRT_TIMEOUT;
    for (int i = 0; i < 100 && result == MRT_TIMEOUT; ++i)
        result = input_host_read(w->in, s_ns, &sample);
    assert_int_equal(result, MRT_ERR_IO); /* its channels are others now */
    assert_true(reopens(w->in, w->from[0]));
    const mrt_channel *channel = w->in->input->channels(w->in->plugin, &count);
    assert_int_equal(count, 3);
    assert_string_equal(channel[0].name, glove[0].name);
    write_as(w, "glove", 1, 0);
    do
        assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    while (sample.value[0] < 1.0f);
    assert_true(sample.value[0] == 1.1f);
}

static void a_killed_sender_leaves_no_pedal_down_and_may_come_back(void **state)
{
    wire *w = *state;
    pid_t sender = start_sender(w);
    assert_true(sender > 0);
    assert_int_equal(input_host_open(w->in, w->from[1]), MRT_OK);
    mrt_sample sample;
    for (int i = 0; i < 20; ++i)
        assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[2] == 1);
    kill_sender(sender);
    int64_t last_ns = sample.time_ns, released_ns = 0; /* last_ns: the sender's last word */
    uint32_t last = sample.sequence;
    mrt_result result;
    while ((result = input_host_read(w->in, 100 * ms_ns, &sample)) >= 0) {
        if (result != MRT_OK)
            continue;
        assert_int_equal(sample.sequence, last + 1);
        last = sample.sequence;
        if (sample.value[2] == 0)
            released_ns = now_ns();
        else
            last_ns = sample.time_ns;
        assert_true(sample.value[0] == 5 && sample.value[1] == 6); /* the hand stays */
    }
    int64_t lost_ns = now_ns();
    assert_int_equal(w->in->said[MRT_LOG_ERROR], 1); /* why, for whoever shows the loss */
    print_message("killed: pedal up after %.2f s, lost after %.2f s\n",
                  (double)(released_ns - last_ns) / 1e9, (double)(lost_ns - last_ns) / 1e9);
    assert_int_equal(result, MRT_ERR_IO);
    assert_true(released_ns - last_ns > 950 * ms_ns);
    assert_true(lost_ns - last_ns > 2900 * ms_ns);
    w->in->input->close(w->in->plugin);
    assert_true(input_host_open(w->in, w->from[1]) < 0); /* nobody there */
    sender = start_sender(w);
    assert_true(reopens(w->in, w->from[1]));
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[2] == 1);
    kill_sender(sender);
}

static void a_sender_that_closes_is_followed_by_the_next_at_once(void **state)
{
    wire *w = *state;
    connect_glove(w);
    write_as(w, "glove", 1, 1);
    mrt_sample sample;
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    w->out->output->close(w->out->plugin);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[2] == 0); /* the pedal goes up before the input is lost */
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_ERR_IO);
    assert_int_equal(osc_node_open_output(w->out, w->to), MRT_OK);
    write_as(w, "glove", 0, 0);
    assert_true(reopens(w->in, w->from[1]));
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
}

/* A pedal that is held is not sent again by its input; the output repeats it four times a second,
 * which a busy machine may put off. */
static void a_pedal_held_down_stays_down(void **state)
{
    wire *w = *state;
    w->in->params[OSC_SILENCE] = 4;
    connect_glove(w);
    write_as(w, "glove", 1, 1);
    mrt_sample sample;
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    int64_t until_ns = now_ns() + 6 * s_ns;
    while (now_ns() < until_ns)
        assert_int_equal(input_host_read(w->in, 100 * ms_ns, &sample), MRT_TIMEOUT);
}

static void other_software_that_stops_is_lost_and_heard_again(void **state)
{
    wire *w = *state;
    w->in->params[OSC_SILENCE] = 0.1;
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    osc_bytes packet = {.size = 0};
    mrt_sample sample;
    assert_int_equal(input_host_read(w->in, 500 * ms_ns, &sample), MRT_TIMEOUT); /* not yet there */
    osc_bytes_message(&packet, "/marotte/pedal", "ii", 2, 1);
    osc_network_send(w->fd, w->port, &packet);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES + 1] == 1);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES + 1] == 0);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_ERR_IO);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_ERR_IO);
    w->in->input->close(w->in->plugin);
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_ERR_IO);
    /* One message while it is closed brings it back, and is not missed. */
    osc_bytes_message(&packet, "/marotte/pedal", "if", 3, 0.5);
    osc_network_send(w->fd, w->port, &packet);
    w->in->params[OSC_SILENCE] = 20;
    assert_true(reopens(w->in, w->from[0]));
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES + 2] == 0.5f);
}

static void silence_of_zero_is_for_ever(void **state)
{
    wire *w = *state;
    w->in->params[OSC_SILENCE] = 0;
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    osc_bytes packet = {.size = 0};
    mrt_sample sample;
    osc_bytes_message(&packet, "/marotte/pedal", "ii", 1, 1);
    osc_network_send(w->fd, w->port, &packet);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    for (int i = 0; i < 15; ++i)
        assert_int_equal(input_host_read(w->in, 100 * ms_ns, &sample), MRT_TIMEOUT);
}

static void a_source_that_nobody_forwards_is_refused_with_advice(void **state)
{
    wire *w = *state;
    int64_t before_ns = now_ns();
    assert_int_equal(input_host_open(w->in, w->from[1]), MRT_ERR_IO);
    assert_true(now_ns() - before_ns > 1500 * ms_ns);
    assert_non_null(strstr(w->in->last_text, "--forward"));
    connect_glove(w); /* another source than this: */
    input_host *other = osc_node_create();
    assert_int_equal(input_host_open(other, w->from[2]), MRT_ERR_IO);
    assert_non_null(strstr(other->last_text, "\"glove\""));
    other->is_stopping = true;
    int waits = other->wait_count;
    assert_int_equal(input_host_open(other, w->from[2]), MRT_ERR_IO);
    assert_int_equal(other->wait_count, waits + 1); /* given up at the first */
    input_host_destroy(other);
}

static void addresses_that_cannot_be_are_refused_with_advice(void **state)
{
    wire *w = *state;
    static const char *const inputs[] = {"x",      "0",     "65536", "9105x", "a:b:9105",
                                         "[::1:9", "1:2:3", "udp:",  ":9105"};
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; ++i) {
        mrt_result result = input_host_open(w->in, inputs[i]);
        if (strcmp(inputs[i], "udp:") == 0) /* "" with its kind: the usual port */
            continue;
        assert_int_equal(result, MRT_ERR_ARGUMENT);
        assert_non_null(strstr(w->in->last_text, "expected [HOST:]PORT"));
    }
    assert_int_equal(input_host_open(w->in, "192.0.2.1:9105"), MRT_ERR_IO);
    assert_non_null(strstr(w->in->last_text, "0.0.0.0"));
    assert_int_equal(input_host_open(w->in, "stage-left:9105"), MRT_ERR_IO);
    assert_non_null(strstr(w->in->last_text, "0.0.0.0:9105"));
    uint16_t taken = 0;
    int fd = osc_network_socket(&taken);
    char address[16];
    snprintf(address, sizeof address, "%u", (unsigned)taken);
    assert_int_equal(input_host_open(w->in, address), MRT_ERR_IO);
    assert_non_null(strstr(w->in->last_text, "another"));
    close(fd);
    assert_int_equal(osc_node_open_output(w->out, ""), MRT_ERR_ARGUMENT);
    assert_int_equal(osc_node_open_output(w->out, "127.0.0.1:9105/glove"), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(w->out->last_text, "HOST:PORT"));
}

static void an_output_that_nobody_hears_says_so_once(void **state)
{
    wire *w = *state;
    assert_int_equal(osc_node_open_output(w->out, w->to), MRT_OK);
    for (uint32_t i = 0; i < 100; ++i)
        write_as(w, "glove", i, 0);
    assert_int_equal(w->out->said[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(w->out->last_text, "no program listens"));
    mrt_sample sample = {.count = 3, .value = {NAN}};
    assert_int_equal(w->out->output->write(w->out->plugin, "glove", glove, &sample),
                     MRT_ERR_ARGUMENT);
    sample = (mrt_sample){.count = MRT_MAX_CHANNELS + 1};
    assert_int_equal(w->out->output->write(w->out->plugin, "glove", glove, &sample),
                     MRT_ERR_ARGUMENT);
    mrt_channel unnamed[1] = {{NULL, "rad", 1, MRT_LEFT, 0, 1}};
    sample = (mrt_sample){.count = 1};
    assert_int_equal(w->out->output->write(w->out->plugin, "unnamed", unnamed, &sample),
                     MRT_ERR_UNSUPPORTED);
    assert_int_equal(w->out->said[MRT_LOG_ERROR], 1);
    /* Who listens from now on hears it. */
    assert_int_equal(input_host_open(w->in, w->from[1]), MRT_OK);
    write_as(w, "glove", 100, 0);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
}

static void a_plain_liblo_client_is_understood(void **state)
{
    wire *w = *state;
    w->in->params[OSC_CONTENT] = 1; /* hand and wrist */
    assert_int_equal(input_host_open(w->in, w->from[0]), MRT_OK);
    char port[8];
    snprintf(port, sizeof port, "%u", (unsigned)w->port);
    lo_address to = lo_address_new("127.0.0.1", port);
    mrt_sample sample;
    assert_true(lo_send(to, "/marotte/hand/right/joint", "iff", 4, 0.5, 0.25) > 0);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[4] == 0.5f && sample.value[5] == 0.25f);
    assert_true(
        lo_send(to, "/marotte/hand/right/wrist", "fffffff", 1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0) > 0);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES + 2] == 3 && sample.value[MRT_ANGLES + 6] == 1);
    lo_timetag tag;
    lo_timetag_now(&tag);
    lo_bundle bundle = lo_bundle_new(tag);
    lo_message message = lo_message_new();
    lo_message_add(message, "sfffffff", "RightIndexProximal", 0.0, 0.0, 0.0, 0.0, 0.0, -0.70710678,
                   0.70710678);
    lo_bundle_add_message(bundle, "/VMC/Ext/Bone/Pos", message);
    assert_true(lo_send_bundle(to, bundle) > 0);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_float_equal(sample.value[4], 1.5707963f, 1e-6f);
    lo_bundle_free_recursive(bundle);
    lo_address_free(to);
}

/* Random bytes, and messages of ours with some bytes changed. */
static void put_nonsense(osc_bytes *packet, uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    uint32_t kind = *seed >> 30;
    if (kind == 0) {
        packet->size = (*seed >> 8) % 600;
        for (size_t i = 0; i < packet->size; ++i) {
            *seed = *seed * 1664525u + 1013904223u;
            packet->data[i] = (unsigned char)(*seed >> 24);
        }
        return;
    }
    osc_bytes inner = {.size = 0};
    if (kind == 1)
        osc_bytes_message(packet, "/marotte/1/sample", "siihhfff", "glove", 1, 7, (int64_t)1,
                          (int64_t)2, 1.0, 2.0, 3.0);
    else if (kind == 2)
        osc_bytes_message(packet, "/marotte/1/channels", "sissiiff", "glove", 1, "a", "rad", 1, 1,
                          0.0, 1.0);
    else {
        osc_bytes_message(&inner, "/marotte/hand/right/joint", "if", 4, 0.5);
        osc_bytes_bundle(packet, 1);
        osc_bytes_element(packet, &inner);
    }
    for (int i = 0; i < 4; ++i) {
        *seed = *seed * 1664525u + 1013904223u;
        packet->data[(*seed >> 8) % packet->size] = (unsigned char)(*seed >> 24);
    }
}

static void nonsense_is_survived_and_said_once_a_kind(void **state)
{
    const int datagrams = getenv("MAROTTE_TEST_LONG") ? 100000 : 20000;
    wire *w = *state;
    connect_glove(w);
    osc_bytes *packet = calloc(1, sizeof *packet);
    uint32_t seed = 1;
    mrt_sample sample;
    int64_t worst_ns = 0;
    for (int i = 0; i < datagrams; ++i) {
        put_nonsense(packet, &seed);
        osc_network_send(w->fd, w->port, packet);
        if (i % 50 != 49)
            continue;
        int64_t before_ns = now_ns();
        mrt_result result = input_host_read(w->in, 0, &sample);
        assert_true(result == MRT_OK || result == MRT_TIMEOUT);
        int64_t took_ns = now_ns() - before_ns;
        worst_ns = took_ns > worst_ns ? took_ns : worst_ns;
        while (input_host_read(w->in, 2 * ms_ns, &sample) == MRT_OK)
            ;
    }
    print_message("worst read with nothing to wait for: %.2f ms\n", (double)worst_ns / 1e6);
    assert_true(w->in->said[MRT_LOG_WARNING] + w->in->said[MRT_LOG_INFO] <= 7);
    write_as(w, "glove", 1, 1);
    assert_int_equal(input_host_read(w->in, s_ns, &sample), MRT_OK);
    assert_true(sample.value[2] == 1);
    free(packet);
}

int main(void)
{
#define NETWORK_TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        NETWORK_TEST(an_input_has_the_outputs_channels_and_every_bit),
        NETWORK_TEST(times_are_those_of_the_measurement),
        NETWORK_TEST(read_waits_for_its_deadline_and_does_not_spin),
        NETWORK_TEST(two_hands_share_a_port),
        NETWORK_TEST(two_sources_are_read_by_two_threads_at_one_port),
        NETWORK_TEST(a_port_without_a_source_follows_what_is_forwarded_to_it),
        NETWORK_TEST(a_killed_sender_leaves_no_pedal_down_and_may_come_back),
        NETWORK_TEST(a_sender_that_closes_is_followed_by_the_next_at_once),
        NETWORK_TEST(a_pedal_held_down_stays_down),
        NETWORK_TEST(other_software_that_stops_is_lost_and_heard_again),
        NETWORK_TEST(silence_of_zero_is_for_ever),
        NETWORK_TEST(a_source_that_nobody_forwards_is_refused_with_advice),
        NETWORK_TEST(addresses_that_cannot_be_are_refused_with_advice),
        NETWORK_TEST(an_output_that_nobody_hears_says_so_once),
        NETWORK_TEST(a_plain_liblo_client_is_understood),
        NETWORK_TEST(nonsense_is_survived_and_said_once_a_kind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
