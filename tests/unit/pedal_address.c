/* pedal/address.h: which device is meant, and that it stays the same one. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "address.h"

#include <string.h>

static void the_three_forms_are_read(void **state)
{
    (void)state;
    address a;
    assert_true(address_parse(&a, ""));
    assert_int_equal(a.kind, ADDRESS_ANY);
    assert_true(address_parse(&a, NULL));
    assert_int_equal(a.kind, ADDRESS_ANY);
    assert_true(address_parse(&a, "usb:05F3:00ff"));
    assert_int_equal(a.kind, ADDRESS_KIND);
    assert_int_equal(a.vendor, 0x05f3);
    assert_int_equal(a.product, 0x00ff);
    assert_true(address_parse(&a, "usb:1-2.3"));
    assert_int_equal(a.kind, ADDRESS_PORT);
    assert_string_equal(a.path, "1-2.3");
    assert_true(address_parse(&a, "usb:255-255.255.255.255.255.255.255"));
}

static void all_else_is_refused(void **state)
{
    static const char *const texts[] = {"1-2",
                                        "usb:",
                                        "usb:1",
                                        "usb:1-",
                                        "usb:1-2.",
                                        "usb:-2",
                                        "usb:0-1",
                                        "usb:1-0",
                                        "usb:1-02",
                                        "usb:1-256",
                                        "usb:1-2.3.4.5.6.7.8.9",
                                        "usb:1-2 ",
                                        "usb:05f3",
                                        "usb:05f3:",
                                        "usb:05f3:0ff",
                                        "usb:05f3:00ff0",
                                        "usb:05g3:00ff",
                                        "USB:1-2",
                                        "usb:1_2",
                                        "usb:05f3-00ff",
                                        "usb:99999-1"};
    (void)state;
    address a;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; ++i)
        if (address_parse(&a, texts[i]))
            fail_msg("%s", texts[i]);
}

static void sockets_are_in_the_order_in_which_people_count(void **state)
{
    static const char *const order[] = {"1-2", "1-2.1", "1-2.10", "1-3", "1-10", "2-1", "10-1"};
    (void)state;
    for (size_t i = 0; i < sizeof order / sizeof *order; ++i)
        for (size_t k = 0; k < sizeof order / sizeof *order; ++k) {
            int compared = address_compare_paths(order[i], order[k]);
            assert_int_equal((compared > 0) - (compared < 0), (i > k) - (i < k));
        }
}

static void without_an_address_only_known_pedals_match(void **state)
{
    (void)state;
    address any = {0};
    address_binding unbound = {0};
    assert_true(address_matches(&any, &unbound, "1-2", 1, 2, true));
    assert_false(address_matches(&any, &unbound, "1-2", 1, 2, false));
    address port = {.kind = ADDRESS_PORT, .path = "1-2"};
    assert_true(address_matches(&port, &unbound, "1-2", 1, 2, false));
    assert_false(address_matches(&port, &unbound, "1-2.1", 1, 2, true));
    address kind = {.kind = ADDRESS_KIND, .vendor = 1, .product = 2};
    assert_true(address_matches(&kind, &unbound, "9-9", 1, 2, false));
    assert_false(address_matches(&kind, &unbound, "9-9", 1, 3, true));
}

static void what_was_found_once_is_found_in_its_socket_only(void **state)
{
    (void)state;
    address any = {0}, kind = {.kind = ADDRESS_KIND, .vendor = 1, .product = 2};
    address_binding bound = {.is_bound = true, .vendor = 1, .product = 2, .path = "1-2"};
    assert_true(address_matches(&any, &bound, "1-2", 1, 2, true));
    assert_false(address_matches(&any, &bound, "1-3", 1, 2, true));
    assert_false(address_matches(&any, &bound, "1-2", 1, 3, true));
    assert_false(address_matches(&kind, &bound, "1-3", 1, 2, true));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_three_forms_are_read),
        cmocka_unit_test(all_else_is_refused),
        cmocka_unit_test(sockets_are_in_the_order_in_which_people_count),
        cmocka_unit_test(without_an_address_only_known_pedals_match),
        cmocka_unit_test(what_was_found_once_is_found_in_its_socket_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
