/* MRT_LANDMARKS as a plugin gets it: points of a hand that stands somewhere come back as its angles
 * and its place, through the instance's host. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "stage/mapping/instance.h"

#include <math.h>
#include <string.h>

static const mrt_host *host_of_plugin;
static char self_of_plugin;

static mrt_plugin *create(const mrt_host *host)
{
    host_of_plugin = host;
    return (mrt_plugin *)(void *)&self_of_plugin;
}

static void destroy(mrt_plugin *self)
{
    (void)self;
}

static const mrt_interface no_interfaces[] = {{NULL, NULL}};
static const mrt_plugin_type type = {.abi = MRT_ABI,
                                     .interfaces = no_interfaces,
                                     .id = "org.example.seeing",
                                     .name = "seeing",
                                     .version = "1",
                                     .about = "It asks.",
                                     .create = create,
                                     .destroy = destroy};

typedef struct room {
    log_queue *log;
    instance plugin;
    const mrt_landmark_reader *reader;
} room;

static void enter(room *self)
{
    error err = {""};
    *self = (room){.log = log_queue_create()};
    assert_non_null(self->log);
    assert_int_equal(instance_create(&self->plugin, &type, CLOCK_REAL, self->log, &err), MRT_OK);
    assert_null(host_of_plugin->service(host_of_plugin, "marotte.nothing/1"));
    self->reader = host_of_plugin->service(host_of_plugin, MRT_LANDMARKS);
    assert_non_null(self->reader);
    assert_ptr_equal(host_of_plugin->service(host_of_plugin, MRT_LANDMARKS), self->reader);
}

static void leave(room *self)
{
    instance_destroy(&self->plugin);
    log_queue_destroy(self->log);
}

static void landmarks_come_back_as_angles(void **state)
{
    (void)state;
    static const double turn[3][4] = {
        {0, 0, 0, 1}, {0.8, 0.1, -0.3, 0.5}, {0.02, 0.99, 0.1, -0.05}};
    room here;
    enter(&here);
    for (uint32_t n = 0; n < 6; ++n) {
        const uint32_t side = n % 2;
        hand_skeleton *skeleton = hand_skeleton_create(side, HAND_LENGTH_MM);
        mrt_landmarks seen = {.side = side};
        mrt_hand_reading reading = {.confidence = 0.0f};
        mrt_vec3 palm[MRT_PALM];
        float angle_rad[MRT_ANGLES] = {0.6f, 0.2f, 0.3f, 0.5f, 0.9f, 0.7f, 0.4f, 0.3f, 0.2f, 0.1f,
                                       0.1f, 0.5f, 0.4f, 0.3f, 0.1f, 0.6f, 0.5f, 0.3f, 0.1f, 0.12f};
        rigid wrist = rigid_from_quaternion(turn[n / 2], (vec3){10, -200, 30});
        hand_pose(skeleton, angle_rad, &wrist, seen.at, palm);
        here.reader->read(host_of_plugin, &seen, &reading);
        assert_true(reading.confidence > 0.9f);
        for (int i = 0; i < MRT_ANGLES; ++i)
            assert_float_equal(reading.angle[i], angle_rad[i], 0.02);
        assert_float_equal(reading.wrist[0], 10, 0.1);
        assert_float_equal(reading.wrist[1], -200, 0.1);
        assert_float_equal(reading.wrist[2], 30, 0.1);
        assert_float_equal(reading.size, 1, 0.01);
        double xyzw[4];
        for (int i = 0; i < 4; ++i)
            xyzw[i] = (double)reading.wrist[3 + i];
        rigid back = rigid_from_quaternion(xyzw, (vec3){10, -200, 30});
        for (int i = 0; i < 9; ++i)
            assert_float_equal(back.r[i / 3][i % 3], wrist.r[i / 3][i % 3], 0.01);
        hand_skeleton_destroy(skeleton);
    }
    leave(&here);
}

static void a_hand_of_no_side_is_not_read(void **state)
{
    (void)state;
    room here;
    enter(&here);
    const mrt_landmarks seen = {.side = MRT_NO_HAND};
    mrt_hand_reading reading = {.confidence = 1.0f, .angle = {0.5f}};
    here.reader->read(host_of_plugin, &seen, &reading);
    assert_true(reading.confidence == 0.0f);
    assert_true(reading.angle[0] == 0.5f);
    leave(&here);
}

static const struct CMUnitTest tests[] = {
    cmocka_unit_test(landmarks_come_back_as_angles),
    cmocka_unit_test(a_hand_of_no_side_is_not_read),
};

int main(void)
{
    return cmocka_run_group_tests(tests, NULL, NULL);
}
