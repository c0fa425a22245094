/* Faces that phones and webcam programs send: what each format's bytes mean, both orders of Live
 * Link's laterals, both versions of iFacialMocap's text, and that what is damaged is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "device/phone_datagrams.h"
#include "phone_parse.h"

#include <math.h>

static int place(const char *name)
{
    for (int i = 0; i < PHONE_VALUES; ++i)
        if (strcmp(phone_name[i], name) == 0)
            return i;
    fail_msg("there is no %s", name);
    return 0;
}

static float value_of(const phone_frame *frame, const char *name)
{
    assert_true(frame->is_told[place(name)]);
    return frame->value[place(name)];
}

static void assert_near(float a, float b)
{
    assert_float_equal(a, b, 1e-5f);
}

static void the_61_stand_in_the_order_of_the_protocol(void **state)
{
    (void)state;
    static datagram sent;
    phone_frame frame;
    float value[61];
    for (int i = 0; i < 61; ++i)
        value[i] = (float)i / 64;
    put_live_link(&sent, 1200, 0.5f, value);
    assert_int_equal(sent.size, 1 + 4 + 36 + 4 + 15 + 16 + 1 + 4 * 61);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_LIVE_LINK);
    assert_true(frame.has_face && frame.has_time);
    assert_float_equal(frame.time_s, 1200.5 / 60, 1e-9);
    for (int i = 0; i < 61; ++i)
        assert_near(frame.value[i], value[i]);
    /* places that the description of the format gives by number */
    assert_near(value_of(&frame, "eyeBlinkLeft"), 0 / 64.0f);
    assert_near(value_of(&frame, "eyeBlinkRight"), 7 / 64.0f);
    assert_near(value_of(&frame, "jawForward"), 14 / 64.0f);
    assert_near(value_of(&frame, "jawLeft"), 15 / 64.0f);
    assert_near(value_of(&frame, "jawRight"), 16 / 64.0f);
    assert_near(value_of(&frame, "jawOpen"), 17 / 64.0f);
    assert_near(value_of(&frame, "mouthLeft"), 21 / 64.0f);
    assert_near(value_of(&frame, "mouthRight"), 22 / 64.0f);
    assert_near(value_of(&frame, "mouthSmileLeft"), 23 / 64.0f);
    assert_near(value_of(&frame, "mouthSmileRight"), 24 / 64.0f);
    assert_near(value_of(&frame, "mouthPressLeft"), 35 / 64.0f);
    assert_near(value_of(&frame, "browDownLeft"), 41 / 64.0f);
    assert_near(value_of(&frame, "browInnerUp"), 43 / 64.0f);
    assert_near(value_of(&frame, "cheekPuff"), 46 / 64.0f);
    assert_near(value_of(&frame, "tongueOut"), 51 / 64.0f);
    assert_near(value_of(&frame, "headYaw"), 52 / 64.0f);
    assert_near(value_of(&frame, "leftEyeYaw"), 55 / 64.0f);
    assert_near(value_of(&frame, "rightEyeRoll"), 60 / 64.0f);
}

/* A mouth drawn to the left, from an app that sends the right one first. */
static void the_other_order_swaps_the_laterals_alone(void **state)
{
    (void)state;
    static datagram sent;
    phone_frame frame;
    float value[61];
    for (int i = 0; i < 61; ++i)
        value[i] = (float)i / 64;
    put_live_link(&sent, 0, 0, value);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_RIGHT_FIRST),
                     PHONE_LIVE_LINK);
    assert_near(value_of(&frame, "jawRight"), 15 / 64.0f);
    assert_near(value_of(&frame, "jawLeft"), 16 / 64.0f);
    assert_near(value_of(&frame, "mouthRight"), 21 / 64.0f);
    assert_near(value_of(&frame, "mouthLeft"), 22 / 64.0f);
    for (int i = 0; i < 61; ++i)
        if (i != 15 && i != 16 && i != 21 && i != 22)
            assert_near(frame.value[i], value[i]);
}

static void live_link_without_a_face_ends_early(void **state)
{
    (void)state;
    static datagram sent;
    phone_frame frame;
    begin_live_link(&sent, 7, 0);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_LIVE_LINK);
    assert_false(frame.has_face);
}

static void live_link_that_is_cut_or_odd_is_refused(void **state)
{
    (void)state;
    static datagram sent;
    phone_frame frame;
    float value[61] = {0};
    put_live_link(&sent, 1, 0, value);
    const size_t header = sent.size - 1 - 4 * 61;
    for (size_t size = 0; size < sent.size; ++size)
        if (size != header && phone_parse(&frame, sent.bytes, size, PHONE_LEFT_FIRST) != PHONE_NONE)
            fail_msg("%zu bytes are taken for a face", size);
    sent.bytes[sent.size++] = 0; /* one too many */
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
    put_live_link(&sent, 1, 0, value);
    sent.bytes[header] = 51;
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
    put_live_link(&sent, 1, 0, value);
    sent.bytes[1] = 0x7f; /* a text of 2 GB */
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
    value[3] = NAN;
    put_live_link(&sent, 1, 0, value);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
    value[3] = INFINITY;
    put_live_link(&sent, 1, 0, value);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
    value[3] = 1e30f;
    put_live_link(&sent, 1, NAN, value);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_LIVE_LINK);
    assert_false(frame.has_time);
    assert_near(frame.value[3], 1);
}

static phone_protocol parse_text(phone_frame *out, const char *text)
{
    return phone_parse(out, text, strlen(text), PHONE_LEFT_FIRST);
}

static void both_versions_of_the_text_are_read(void **state)
{
    (void)state;
    phone_frame frame;
    assert_int_equal(
        parse_text(&frame,
                   "mouthSmile_R-0|eyeBlink_L-70|mouthLeft-7|jawOpen-100|unknown_X-3|hapihapi-0|"
                   "=head#-21.488958,-6.038993,-6.6019735,-0.030653415,-0.10287084,-0.6584072|"
                   "rightEye#6.0297494,2.4403017,0.25649446|leftEye#6.034903,-1.6660284,-0.1753|"),
        PHONE_IFACIALMOCAP);
    assert_true(frame.has_face);
    assert_near(value_of(&frame, "eyeBlinkLeft"), 0.7f);
    assert_near(value_of(&frame, "mouthSmileRight"), 0);
    assert_near(value_of(&frame, "mouthLeft"), 0.07f);
    assert_near(value_of(&frame, "jawOpen"), 1);
    assert_near(value_of(&frame, "headPitch"), -0.3750531f);
    assert_near(value_of(&frame, "headYaw"), -0.1054003f);
    assert_near(value_of(&frame, "rightEyeYaw"), 0.0425913f);
    assert_near(value_of(&frame, "leftEyePitch"), 0.1053289f);
    assert_false(frame.is_told[place("tongueOut")]);
    /* the second version: '&' before a value, which may be negative */
    assert_int_equal(
        parse_text(&frame, "mouthSmile_L&80.5|tongueOut&-3|trackingStatus&1|=head#1,2,3,4,5,6"),
        PHONE_IFACIALMOCAP);
    assert_near(value_of(&frame, "mouthSmileLeft"), 0.805f);
    assert_near(value_of(&frame, "tongueOut"), 0);
    assert_int_equal(parse_text(&frame, "trackingStatus-0|jawOpen-3|"), PHONE_IFACIALMOCAP);
    assert_false(frame.has_face);
}

static void text_that_is_no_face_is_refused(void **state)
{
    (void)state;
    static const char *const bad[] = {"",
                                      "|",
                                      "hello",
                                      "iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719",
                                      "jawOpen-",
                                      "jawOpen-x|",
                                      "jawOpen-nan|",
                                      "jawOpen-inf|",
                                      "jawOpen-0x10|",
                                      "jawOpen-1e99|",
                                      "jawOpen&1,5",
                                      "=head#1,2|",
                                      "=head#1,nan,2|",
                                      "=head#|",
                                      "jawOpen-1|jawOpen-1111111111111111111111111111111111",
                                      "unknown-3|other-4|"};
    phone_frame frame;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; ++i)
        if (parse_text(&frame, bad[i]) != PHONE_NONE)
            fail_msg("\"%s\" is a face", bad[i]);
}

static void openseeface_is_put_at_the_nearest_shapes(void **state)
{
    (void)state;
    static datagram sent;
    phone_frame frame;
    openseeface_face face = {.time_s = 1700000000.25,
                             .right_open = 0.25f,
                             .left_open = 0.9f,
                             .has_3d = 1,
                             .euler = {-170, 20, 100}}; /* pitch -10, yaw 20, roll 10 */
    const float feature[14] = {-0.1f, 0.3f, 0, 0.5f,  0, 0,    -0.2f,
                               0,     0.6f, 0, -0.4f, 0, 0.7f, -0.8f};
    memcpy(face.feature, feature, sizeof feature);
    sent.size = 0;
    put_openseeface(&sent, &face);
    assert_int_equal(sent.size, 1785);
    put_openseeface(&sent, &face); /* a second face in the picture */
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST),
                     PHONE_OPENSEEFACE);
    assert_true(frame.has_face && frame.has_time);
    assert_float_equal(frame.time_s, 1700000000.25, 1e-6);
    assert_near(value_of(&frame, "eyeBlinkRight"), 0.75f);
    assert_near(value_of(&frame, "eyeBlinkLeft"), 0.1f);
    assert_near(value_of(&frame, "eyeWideLeft"), 0);
    assert_near(value_of(&frame, "eyeWideRight"), 0.3f);
    assert_near(value_of(&frame, "browOuterUpLeft"), 0.5f);
    assert_near(value_of(&frame, "browDownLeft"), 0);
    assert_near(value_of(&frame, "browDownRight"), 0.2f);
    assert_near(value_of(&frame, "browInnerUp"), 0.15f);
    assert_near(value_of(&frame, "mouthSmileLeft"), 0.6f);
    assert_near(value_of(&frame, "mouthFrownRight"), 0.4f);
    assert_near(value_of(&frame, "jawOpen"), 0.7f);
    assert_near(value_of(&frame, "mouthPucker"), 0.8f);
    assert_near(value_of(&frame, "mouthStretchLeft"), 0);
    assert_near(value_of(&frame, "headPitch"), -0.1745329f);
    assert_near(value_of(&frame, "headYaw"), 0.3490659f);
    assert_near(value_of(&frame, "headRoll"), 0.1745329f);
    assert_false(frame.is_told[place("leftEyeYaw")]);

    for (size_t size = 1; size < 1785; ++size)
        if (phone_parse(&frame, sent.bytes, size, PHONE_LEFT_FIRST) != PHONE_NONE)
            fail_msg("%zu bytes are taken for a face", size);
    face.has_3d = 0;
    sent.size = 0;
    put_openseeface(&sent, &face);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST),
                     PHONE_OPENSEEFACE);
    assert_false(frame.has_face);
    face.has_3d = 1;
    face.euler[1] = NAN;
    sent.size = 0;
    put_openseeface(&sent, &face);
    assert_int_equal(phone_parse(&frame, sent.bytes, sent.size, PHONE_LEFT_FIRST), PHONE_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_61_stand_in_the_order_of_the_protocol),
        cmocka_unit_test(the_other_order_swaps_the_laterals_alone),
        cmocka_unit_test(live_link_without_a_face_ends_early),
        cmocka_unit_test(live_link_that_is_cut_or_odd_is_refused),
        cmocka_unit_test(both_versions_of_the_text_are_read),
        cmocka_unit_test(text_that_is_no_face_is_refused),
        cmocka_unit_test(openseeface_is_put_at_the_nearest_shapes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
