#include "layouts.h"

/* A switch that is one bit of a byte; a byte that is 0 or 1; a key, or the key after the bar. */
#define BIT(label, byte, n)                                                                        \
    {                                                                                              \
        .name = label, .bit = 8 * (byte) + (n), .width = 1, .up = 0, .down = 1                     \
    }
#define BYTE(label, byte)                                                                          \
    {                                                                                              \
        .name = label, .bit = 8 * (byte), .width = 8, .up = 0, .down = 1                           \
    }
#define KEY(label, code, other)                                                                    \
    {                                                                                              \
        .name = label, .kind = LAYOUT_KEY, .key = {(code), (other) }                               \
    }

/* Interface 0, "01 modifiers 00 k k k k k": factory keys a b c, or the codes 1 2 3 that the
 * programming tools for Linux give to keep letters free. */
#define PCSENSOR(id_vendor, id_product)                                                            \
    {                                                                                              \
        .source = LAYOUT_OF_TABLE, .vendor = (id_vendor), .product = (id_product),                 \
        .name = "PCsensor FootSwitch", .interface_number = 0, .key_report_id = 1, .key_at = 3,     \
        .key_count = 5, .switch_count = 3, .switches = {                                           \
            KEY("left", 4, 1),                                                                     \
            KEY("centre", 5, 2),                                                                   \
            KEY("right", 6, 3)                                                                     \
        }                                                                                          \
    }
/* A boot keyboard, "modifiers 00 k k k k k k", whose keys are not known: any is the one switch. */
#define KEYBOARD(id_vendor, id_product, label)                                                     \
    {                                                                                              \
        .source = LAYOUT_OF_TABLE, .vendor = (id_vendor), .product = (id_product), .name = label,  \
        .interface_number = LAYOUT_ANY, .key_at = 2, .key_count = 6, .any_key = true,              \
        .switch_count = 1, .switches = {                                                           \
            KEY("any key", 0, 0)                                                                   \
        }                                                                                          \
    }
#define DESCRIBED(id_vendor, id_product, label, skip)                                              \
    {                                                                                              \
        .source = LAYOUT_OF_DESCRIPTOR, .vendor = (id_vendor), .product = (id_product),            \
        .name = label, .interface_number = LAYOUT_ANY, .axis_skip = (skip)                         \
    }
#define OLYMPUS(id_product, label)                                                                 \
    {                                                                                              \
        .source = LAYOUT_OF_TABLE, .vendor = 0x07b4, .product = (id_product), .name = label,       \
        .interface_number = LAYOUT_ANY, .endpoint = 0x83, .switch_count = 3, .switches = {         \
            BIT("left", 2, 3),                                                                     \
            BIT("middle", 2, 1),                                                                   \
            BIT("right", 2, 2)                                                                     \
        }                                                                                          \
    }
#define PHILIPS(id_product, label)                                                                 \
    {                                                                                              \
        .source = LAYOUT_OF_TABLE, .vendor = 0x0911, .product = (id_product), .name = label,       \
        .interface_number = LAYOUT_ANY, .switch_count = 4, .switches = {                           \
            BIT("rewind", 0, 0),                                                                   \
            BIT("play", 0, 1),                                                                     \
            BIT("forward", 0, 2),                                                                  \
            BIT("end of letter", 0, 3)                                                             \
        }                                                                                          \
    }

static const layout table[] = {
    {.source = LAYOUT_OF_TABLE,
     .vendor = 0x05f3,
     .product = 0x00ff,
     .name = "VEC USB Footpedal",
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {BIT("left", 0, 0), BIT("centre", 0, 1), BIT("right", 0, 2)}},
    PCSENSOR(0x0c45, 0x7403),
    PCSENSOR(0x0c45, 0x7404),
    PCSENSOR(0x413d, 0x2107),
    PCSENSOR(0x1a86, 0xe026),
    PCSENSOR(0x3553, 0xb001),
    OLYMPUS(0x0202, "Olympus RS-26"),
    OLYMPUS(0x0218, "Olympus RS-28"),
    PHILIPS(0x1844, "Philips ACC2310/2320"),
    PHILIPS(0x091a, "Philips ACC2330"),
    {.source = LAYOUT_OF_TABLE,
     .vendor = 0x05f3,
     .product = 0x042c,
     .name = "X-keys XK-3 foot pedal",
     .interface_number = LAYOUT_ANY,
     .head = {0, 1},
     .head_count = 2,
     .switch_count = 3,
     .switches = {BIT("left", 2, 1), BIT("middle", 2, 2), BIT("right", 2, 3)}},
    {.source = LAYOUT_OF_TABLE,
     .vendor = 0x0fd9,
     .product = 0x0086,
     .name = "Elgato Stream Deck Pedal",
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {BYTE("left", 4), BYTE("middle", 5), BYTE("right", 6)}},
    KEYBOARD(0x0426, 0x3011, "Scythe USB Foot Switch"),
    KEYBOARD(0x055a, 0x0998, "Scythe USB Foot Switch"),
    KEYBOARD(0x5131, 0x2019, "FS1-P foot switch"),
    DESCRIBED(0x046d, 0xc276, "Logitech RS50 pedals", 1), /* the wheel is the first axis */
    DESCRIBED(0x068e, 0x0501, "CH Pro Pedals", 0),
    DESCRIBED(0x1209, 0x3100, "OpenSimHardware pedals", 0),
    DESCRIBED(0x1209, 0xeffe, "EffigyLabs pedal", 0),
};

const layout *layouts_table(size_t *out_count)
{
    *out_count = sizeof table / sizeof *table;
    return table;
}

const layout *layouts_find(uint16_t vendor, uint16_t product)
{
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i)
        if (table[i].vendor == vendor && table[i].product == product)
            return &table[i];
    return NULL;
}

bool layout_is_analogue(const layout_switch *s)
{
    int64_t way = (int64_t)s->down - s->up;
    return s->kind == LAYOUT_FIELD && (way > 1 || way < -1);
}
