/* The panel Send in the whole window: a program is chosen by its name, a receiver gets the face,
 * and the line of the output says where to, how often and how many. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "window/scene.h"

#include <arpa/inet.h>
#include <sys/socket.h>

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo};

/* A receiver of datagrams on this computer. */
static int open_receiver(char out_port[16])
{
    struct sockaddr_in at = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t size = sizeof at;
    const int fd = socket(AF_INET, SOCK_DGRAM, 0);
    assert_true(fd >= 0 && bind(fd, (struct sockaddr *)&at, sizeof at) == 0);
    assert_int_equal(getsockname(fd, (struct sockaddr *)&at, &size), 0);
    (void)snprintf(out_port, 16, "%u", ntohs(at.sin_port));
    return fd;
}

static bool has_face(scene *s, void *data)
{
    char bytes[2048];
    (void)s;
    const ssize_t size = recv(*(int *)data, bytes, sizeof bytes, MSG_DONTWAIT);
    return size > 0 && memmem(bytes, (size_t)size, "/marotte/1/face", 15) != NULL;
}

static bool is_said(scene *s, void *data)
{
    return scene_word_with(s, data) != NULL;
}

static void write_into(scene *s, const char *field, const char *text)
{
    const ui_word *label = scene_word(s, field);
    if (!label)
        fail_msg("no field %s", field);
    scene_click(s, label->where.x + 80.0f, label->where.y + 0.5f * label->where.height);
    scene_key(s, UI_KEY_BACKSPACE, 0);
    scene_type(s, text);
    scene_key(s, UI_KEY_TAB, 0);
}

static void send_at(uint32_t width, uint32_t height, const char *picture)
{
    scene s;
    char port[16], address[32], sent[] = "faces sent";
    const scene_options options = {.width_px = width,
                                   .height_px = height,
                                   .scale = 1.0f,
                                   .inputs = demo_inputs,
                                   .input_count = 1};
    int receiver = open_receiver(port);
    scene_open_with(&s, &options);
    scene_let_cut(&s, "demo_hand");
    scene_do(&s, ACTION_PANEL_OUTPUT);
    assert_null(scene_word_with(&s, "org.marotte"));
    scene_click_word(&s, "Unreal (Live Link)");
    scene_look(&s, "send_programs");
    scene_click_word(&s, "OSC");
    write_into(&s, "Port", port);
    scene_check_words(&s);
    if (!scene_word(&s, "Start sending")) { /* in a small window it is below */
        scene_push(&s, (ui_event){.kind = UI_EVENT_WHEEL, .y = -20.0f});
        scene_settle(&s);
    }
    scene_look(&s, picture);
    scene_click_word(&s, "Start sending");
    scene_push(&s, (ui_event){.kind = UI_EVENT_WHEEL, .y = 20.0f});
    scene_settle(&s);
    assert_true(scene_until(&s, has_face, &receiver));
    (void)snprintf(address, sizeof address, "127.0.0.1:%s", port);
    assert_true(scene_until(&s, is_said, address));
    assert_true(scene_until(&s, is_said, sent));
    scene_check_words(&s);
    scene_look(&s, picture);
    scene_click_word(&s, "Close");
    assert_null(scene_word_with(&s, address));
    scene_close(&s);
    close(receiver);
}

static void a_receiver_gets_the_face_after_its_program_was_chosen(void **state)
{
    (void)state;
    send_at(1280, 720, "send");
    send_at(800, 500, "send_small");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_receiver_gets_the_face_after_its_program_was_chosen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
