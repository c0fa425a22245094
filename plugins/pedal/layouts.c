#include "layouts.h"

/* One bit of a byte; a byte that is 0 or 1; a key or another. */
#define BIT(byte, n)     .bit = 8 * (byte) + (n), .width = 1, .up = 0, .down = 1
#define BYTE(byte)       .bit = 8 * (byte), .width = 8, .up = 0, .down = 1
#define KEY(code, other) .kind = LAYOUT_KEY, .key = {(code), (other)}

#define DEVICE(id_vendor, id_product)                                                              \
    .source = LAYOUT_OF_TABLE, .vendor = (id_vendor), .product = (id_product)

/* Interface 0, "01 modifiers 00 k k k k k": factory keys a b c, or the codes 1 2 3 that the
 * programming tools for Linux give to keep letters free. */
#define PCSENSOR(id_vendor, id_product)                                                            \
    DEVICE(id_vendor, id_product), .interface_number = 0, .key_report_id = 1, .key_at = 3,         \
                                   .key_count = 5, .switch_count = 3,                              \
                                   .switches = {{.name = "left", KEY(4, 1)},                       \
                                                {.name = "centre", KEY(5, 2)},                     \
                                                {.name = "right", KEY(6, 3)}}

/* A boot keyboard, "modifiers 00 k k k k k k", whose keys are not known: any is the one switch. */
#define KEYBOARD(id_vendor, id_product)                                                            \
    DEVICE(id_vendor, id_product), .interface_number = LAYOUT_ANY, .key_at = 2, .key_count = 6,    \
                                   .any_key = true, .switch_count = 1,                             \
                                   .switches = {{.name = "any key", KEY(0, 0)}}

#define OLYMPUS(id_product)                                                                        \
    DEVICE(0x07b4, id_product), .interface_number = LAYOUT_ANY, .endpoint = 0x83,                  \
                                .switch_count = 3,                                                 \
                                .switches = {{.name = "left", BIT(2, 3)},                          \
                                             {.name = "middle", BIT(2, 1)},                        \
                                             {.name = "right", BIT(2, 2)}}

#define PHILIPS(id_product)                                                                        \
    DEVICE(0x0911, id_product), .interface_number = LAYOUT_ANY, .switch_count = 4,                 \
                                .switches = {{.name = "rewind", BIT(0, 0)},                        \
                                             {.name = "play", BIT(0, 1)},                          \
                                             {.name = "forward", BIT(0, 2)},                       \
                                             {.name = "end of letter", BIT(0, 3)}}

/* Its axes are as the device says; `skip` of them come before those of the pedals. */
#define DESCRIBED(id_vendor, id_product, skip)                                                     \
    .source = LAYOUT_OF_DESCRIPTOR, .vendor = (id_vendor), .product = (id_product),                \
    .interface_number = LAYOUT_ANY, .axis_skip = (skip)

static const layout table[] = {
    {.name = "VEC USB Footpedal",
     DEVICE(0x05f3, 0x00ff),
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {{.name = "left", BIT(0, 0)},
                  {.name = "centre", BIT(0, 1)},
                  {.name = "right", BIT(0, 2)}}},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x0c45, 0x7403)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x0c45, 0x7404)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x413d, 0x2107)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x1a86, 0xe026)},
    {.name = "PCsensor FootSwitch", PCSENSOR(0x3553, 0xb001)},
    {.name = "Olympus RS-26", OLYMPUS(0x0202)},
    {.name = "Olympus RS-28", OLYMPUS(0x0218)},
    {.name = "Philips ACC2310/2320", PHILIPS(0x1844)},
    {.name = "Philips ACC2330", PHILIPS(0x091a)},
    {.name = "X-keys XK-3 foot pedal",
     DEVICE(0x05f3, 0x042c),
     .interface_number = LAYOUT_ANY,
     .head = {0, 1},
     .head_count = 2,
     .switch_count = 3,
     .switches = {{.name = "left", BIT(2, 1)},
                  {.name = "middle", BIT(2, 2)},
                  {.name = "right", BIT(2, 3)}}},
    {.name = "Elgato Stream Deck Pedal",
     DEVICE(0x0fd9, 0x0086),
     .interface_number = LAYOUT_ANY,
     .switch_count = 3,
     .switches = {{.name = "left", BYTE(4)},
                  {.name = "middle", BYTE(5)},
                  {.name = "right", BYTE(6)}}},
    {.name = "Scythe USB Foot Switch", KEYBOARD(0x0426, 0x3011)},
    {.name = "Scythe USB Foot Switch", KEYBOARD(0x055a, 0x0998)},
    {.name = "FS1-P foot switch", KEYBOARD(0x5131, 0x2019)},
    {.name = "Logitech RS50 pedals", DESCRIBED(0x046d, 0xc276, 1)}, /* after the wheel */
    {.name = "CH Pro Pedals", DESCRIBED(0x068e, 0x0501, 0)},
    {.name = "OpenSimHardware pedals", DESCRIBED(0x1209, 0x3100, 0)},
    {.name = "EffigyLabs pedal", DESCRIBED(0x1209, 0xeffe, 0)},
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
