/* Each example of plugins/osc/README.md, run as it stands there but for the port: a plain `oscsend`
 * is understood without a complaint, and gives what the README says. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "osc_network.h"

enum { LINE = 512, EXAMPLES = 8 };
static const int64_t s_ns = 1000000000;

static bool has_oscsend(void)
{
    return system("command -v oscsend >/dev/null 2>&1") == 0;
}

/* The README's lines of code that call oscsend. */
static int read_examples(char line[][LINE], int capacity)
{
    FILE *file = fopen(SOURCE_DIR "/plugins/osc/README.md", "r");
    assert_non_null(file);
    int count = 0;
    char text[LINE * 4];
    while (fgets(text, sizeof text, file))
        if (strncmp(text, "oscsend localhost 9105 ", 23) == 0 && count < capacity) {
            text[strcspn(text, "\n")] = '\0';
            assert_true(strlen(text) < LINE);
            strcpy(line[count++], text + 23);
        }
    fclose(file);
    return count;
}

static void send_example(const char *arguments, uint16_t port)
{
    char command[LINE + 64];
    snprintf(command, sizeof command, "oscsend osc.udp://127.0.0.1:%u %s", (unsigned)port,
             arguments);
    assert_int_equal(system(command), 0);
}

/* Examples 0 to 4 are simple messages and VMC, 5 to 7 a forwarded source. */
static void the_simple_examples_move_what_they_say(void **state)
{
    (void)state;
    static char line[EXAMPLES][LINE];
    uint16_t port = osc_network_free_port();
    assert_int_equal(read_examples(line, EXAMPLES), EXAMPLES);
    char address[16];
    snprintf(address, sizeof address, "%u", (unsigned)port);
    input_host *hand = osc_node_create(), *wrist = osc_node_create();
    wrist->params[OSC_CONTENT] = 1;
    hand->params[OSC_SILENCE] = wrist->params[OSC_SILENCE] = 0; /* a busy machine may be silent */
    assert_int_equal(input_host_open(hand, address), MRT_OK);
    assert_int_equal(input_host_open(wrist, address), MRT_OK);
    mrt_sample sample;
    send_example(line[0], port);
    assert_int_equal(input_host_read(hand, s_ns, &sample), MRT_OK);
    assert_true(sample.value[0] == 0.6f && sample.value[18] == 0.1f);
    send_example(line[1], port);
    assert_int_equal(input_host_read(hand, s_ns, &sample), MRT_OK);
    assert_true(sample.value[4] == 0.9f && sample.value[6] == 0.3f);
    send_example(line[2], port);
    for (int i = 0; i < 3; ++i) /* it has heard the first two as well */
        assert_int_equal(input_host_read(wrist, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES + 2] == -100 && sample.value[4] == 0.9f);
    send_example(line[3], port);
    assert_int_equal(input_host_read(hand, s_ns, &sample), MRT_OK);
    assert_true(sample.value[MRT_ANGLES] == 1);
    send_example(line[4], port);
    assert_int_equal(input_host_read(hand, s_ns, &sample), MRT_OK);
    assert_float_equal(sample.value[4], 0.7853982f, 1e-6f);
    assert_int_equal(hand->said[MRT_LOG_WARNING] + hand->said[MRT_LOG_INFO], 0);
    input_host_destroy(hand);
    input_host_destroy(wrist);
}

/* Each call of oscsend is another sender, so the three of a source go out through one that waits.
 */
static void the_forwarding_examples_are_taken_as_messages(void **state)
{
    (void)state;
    static char line[EXAMPLES][LINE];
    uint16_t port = osc_network_free_port();
    assert_int_equal(read_examples(line, EXAMPLES), EXAMPLES);
    char address[16];
    snprintf(address, sizeof address, "%u", (unsigned)port);
    input_host *watch = osc_node_create(); /* takes all that comes to the port */
    watch->params[OSC_SILENCE] = 0;
    watch->params[OSC_CONTENT] = 1; /* a content that was chosen follows no source */
    assert_int_equal(input_host_open(watch, address), MRT_OK);
    mrt_sample sample;
    send_example(line[5], port);
    assert_int_equal(input_host_read(watch, s_ns / 10, &sample), MRT_TIMEOUT);
    input_host *glove = osc_node_create();
    glove->params[OSC_SILENCE] = 0;
    snprintf(address, sizeof address, "%u/myglove", (unsigned)port);
    assert_int_equal(input_host_open(glove, address), MRT_OK);
    uint32_t count;
    assert_string_equal(glove->input->channels(glove->plugin, &count)[0].name, "index");
    assert_int_equal(count, 1);
    send_example(line[7], port); /* the end, of a sender who is not the first: nothing happens */
    assert_int_equal(input_host_read(glove, s_ns / 10, &sample), MRT_TIMEOUT);
    assert_int_equal(watch->said[MRT_LOG_WARNING] + glove->said[MRT_LOG_WARNING], 0);
    send_example(line[6], port); /* a second sender: well understood, and refused */
    assert_int_equal(input_host_read(glove, s_ns / 10, &sample), MRT_TIMEOUT);
    assert_int_equal(watch->said[MRT_LOG_WARNING] + glove->said[MRT_LOG_WARNING], 1);
    assert_non_null(strstr(glove->last_text, "myglove"));
    input_host_destroy(glove);
    input_host_destroy(watch);
}

int main(void)
{
    if (!has_oscsend() || osc_network_free_port() == 0) {
        printf("SKIPPED: oscsend (package liblo-tools) or sockets are missing\n");
        return 77;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_simple_examples_move_what_they_say),
        cmocka_unit_test(the_forwarding_examples_are_taken_as_messages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
