/* Who gets the face of the output iFacialMocap, and until when; which addresses are near. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "receivers.h"

#include <errno.h>
#include <string.h>

static const int64_t s_ns = 1000000000, start_ns = 77000000000;

static udp_peer at_ip(uint8_t a, uint8_t b, uint8_t c, uint8_t d)
{
    return (udp_peer){.ip = {[10] = 0xff, [11] = 0xff, [12] = a, [13] = b, [14] = c, [15] = d},
                      .port = 49983};
}

static udp_peer number(uint32_t i)
{
    return at_ip(192, 168, 1, (uint8_t)i);
}

static void one_that_greets_once_is_kept_for_half_a_day(void **state)
{
    receivers r = {.count = 0};
    const udp_peer a = number(1), b = number(2);
    udp_peer who;
    (void)state;
    assert_int_equal(receivers_greeted(&r, &a, false, start_ns), RECEIVER_IS_NEW);
    assert_int_equal(receivers_greeted(&r, &b, true, start_ns), RECEIVER_IS_NEW);
    assert_int_equal(receivers_greeted(&r, &a, true, start_ns + 5 * s_ns), RECEIVER_IS_KNOWN);
    assert_true(receivers_find(&r, &a)->has_version_2);
    const int64_t over_ns = start_ns + RECEIVER_LASTS_S * s_ns;
    assert_int_equal(receivers_forget_one(&r, over_ns - 1, &who), RECEIVER_STAYS);
    assert_int_equal(receivers_forget_one(&r, over_ns, &who), RECEIVER_EXPIRED);
    assert_int_equal(who.ip[15], 2); /* the other one has greeted again */
    assert_int_equal(receivers_forget_one(&r, over_ns, &who), RECEIVER_STAYS);
    assert_int_equal(receivers_forget_one(&r, over_ns + 5 * s_ns, &who), RECEIVER_EXPIRED);
    assert_int_equal(r.count, 0);
}

static void one_where_nobody_listens_is_forgotten_after_some_seconds(void **state)
{
    receivers r = {.count = 0};
    const udp_peer a = number(1);
    udp_peer who;
    int64_t now_ns = start_ns;
    (void)state;
    (void)receivers_greeted(&r, &a, false, now_ns);
    receivers_failed(&r, &a, ECONNREFUSED, now_ns); /* it opens its port after the greeting */
    receivers_failed(&r, &a, ECONNREFUSED, now_ns + 2 * s_ns);
    assert_int_equal(receivers_forget_one(&r, now_ns + 2 * s_ns, &who), RECEIVER_STAYS);
    now_ns += 3600 * s_ns; /* an hour later it is started anew */
    receivers_failed(&r, &a, ECONNREFUSED, now_ns);
    assert_int_equal(receivers_forget_one(&r, now_ns, &who), RECEIVER_STAYS);
    for (int i = 0; i <= RECEIVER_REFUSES_S; ++i)
        receivers_failed(&r, &a, ECONNREFUSED, now_ns + i * s_ns);
    now_ns += RECEIVER_REFUSES_S * s_ns;
    assert_int_equal(receivers_forget_one(&r, now_ns, &who), RECEIVER_REFUSED);
    assert_int_equal(r.count, 0);
}

static void a_network_that_is_away_for_a_while_loses_nobody(void **state)
{
    receivers r = {.count = 0};
    const udp_peer a = number(1);
    udp_peer who;
    (void)state;
    (void)receivers_greeted(&r, &a, false, start_ns);
    for (int i = 0; i < 600; ++i) {
        receivers_failed(&r, &a, EHOSTUNREACH, start_ns + i * s_ns);
        assert_int_equal(receivers_forget_one(&r, start_ns + i * s_ns, &who), RECEIVER_STAYS);
    }
}

static void the_ninth_gets_the_place_of_one_that_is_away(void **state)
{
    receivers r = {.count = 0};
    const udp_peer ninth = number(9);
    (void)state;
    for (uint32_t i = 0; i < RECEIVERS_MAX; ++i) {
        const udp_peer a = number(20 + i);
        assert_int_equal(receivers_greeted(&r, &a, false, start_ns + i), RECEIVER_IS_NEW);
    }
    const udp_peer third = number(23), fifth = number(25);
    receivers_failed(&r, &third, EHOSTUNREACH, start_ns + 9 * s_ns);
    assert_int_equal(receivers_greeted(&r, &ninth, false, start_ns + 60 * s_ns),
                     RECEIVER_HAS_NO_PLACE); /* it has come back */
    receivers_failed(&r, &fifth, EHOSTUNREACH, start_ns + 60 * s_ns);
    receivers_failed(&r, &third, EHOSTUNREACH, start_ns + 60 * s_ns);
    assert_int_equal(receivers_greeted(&r, &ninth, false, start_ns + 61 * s_ns), RECEIVER_IS_NEW);
    assert_null(receivers_find(&r, &third)); /* greeted longest ago */
    assert_non_null(receivers_find(&r, &fifth));
    assert_int_equal(r.count, RECEIVERS_MAX);
}

static void one_that_the_person_names_stays(void **state)
{
    receivers r = {.count = 1, .of = {{.at = number(1), .is_named = true}}};
    udp_peer who;
    (void)state;
    for (int i = 0; i < 100; ++i)
        receivers_failed(&r, &r.of[0].at, ECONNREFUSED, start_ns + i * s_ns);
    assert_int_equal(receivers_forget_one(&r, start_ns + 99 * s_ns, &who), RECEIVER_STAYS);
    assert_int_equal(receivers_forget_one(&r, start_ns + 10 * RECEIVER_LASTS_S * s_ns, &who),
                     RECEIVER_STAYS);
}

static void near_is_what_is_in_a_network_of_this_computer(void **state)
{
    udp_net net[3] = {{.ip = {0}}};
    const udp_peer home = at_ip(192, 168, 1, 20), loopback = at_ip(127, 0, 0, 1);
    const udp_peer tunnel = at_ip(10, 8, 0, 2);
    (void)state;
    memcpy(net[0].ip, loopback.ip, 16);
    memset(net[0].mask, 0xff, 13);
    memcpy(net[1].ip, home.ip, 16);
    memset(net[1].mask, 0xff, 15);
    memcpy(net[2].ip, tunnel.ip, 16); /* to one computer alone */
    memset(net[2].mask, 0xff, 16);
    const udp_peer near[] = {at_ip(127, 9, 9, 9), at_ip(192, 168, 1, 1), at_ip(10, 8, 0, 2)};
    const udp_peer far[] = {at_ip(192, 168, 2, 1),
                            at_ip(10, 8, 0, 3),
                            at_ip(8, 8, 8, 8),
                            at_ip(255, 255, 255, 255),
                            {.ip = {0xfe, 0x80, [15] = 1}}};
    for (size_t i = 0; i < sizeof near / sizeof near[0]; ++i)
        assert_true(udp_peer_is_in(&near[i], net, 3));
    for (size_t i = 0; i < sizeof far / sizeof far[0]; ++i)
        assert_false(udp_peer_is_in(&far[i], net, 3));
    assert_false(udp_peer_is_in(&home, net, 0));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_that_greets_once_is_kept_for_half_a_day),
        cmocka_unit_test(one_where_nobody_listens_is_forgotten_after_some_seconds),
        cmocka_unit_test(a_network_that_is_away_for_a_while_loses_nobody),
        cmocka_unit_test(the_ninth_gets_the_place_of_one_that_is_away),
        cmocka_unit_test(one_that_the_person_names_stays),
        cmocka_unit_test(near_is_what_is_in_a_network_of_this_computer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
