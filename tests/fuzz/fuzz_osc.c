/* Datagrams from anybody. The input is cut into datagrams by two bytes of length each (low first),
 * which go to a dispatcher where a forwarded source is known and four listeners wait. Whatever
 * comes out is finite and in time order. */
#include "osc_dispatcher.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void say_nothing(const mrt_host *host, int32_t level, const char *text)
{
    (void)host;
    (void)level;
    if (!memchr(text, '\0', 512))
        abort();
}

static void take(osc_dispatcher *dispatcher, const mrt_host *host, const uint8_t *data, size_t size,
                 uint16_t port, int64_t now_ns)
{
    udp_peer peer = {{0}, port};
    unsigned char *copy = malloc(size + 1); /* its end is watched */
    if (!copy)
        return;
    memcpy(copy, data, size);
    osc_dispatcher_process(dispatcher, copy, size, &peer, now_ns, host);
    free(copy);
}

static void check(osc_listener *listener, int64_t now_ns)
{
    osc_item item;
    while (osc_listener_pop(listener, &item)) {
        if (item.time_ns > now_ns && item.step > 0)
            abort();
        for (uint32_t i = 0; item.step > 0 && i < listener->table.count; ++i)
            if (!isfinite(item.value[i]))
                abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static osc_dispatcher dispatcher;
    static osc_listener listener[4];
    static const mrt_channel channel[2] = {{"right.index.mpj", "rad", 5, MRT_RIGHT, 0, 1},
                                           {"pedal.1", "1", 64, MRT_NO_HAND, 0, 1}};
    const mrt_host host = {.log = say_nothing};
    unsigned char told[512];
    osc_table table;
    int64_t now_ns = 1000000000000;
    osc_dispatcher_start(&dispatcher);
    osc_listener_start_forwarded(&listener[0], "");
    osc_listener_start_simple(&listener[1], MRT_RIGHT, OSC_CONTENT_PEDALS);
    osc_listener_start_simple(&listener[2], MRT_LEFT, OSC_CONTENT_WRIST);
    osc_listener_start_simple(&listener[3], MRT_RIGHT, OSC_CONTENT_CONTROLS);
    for (int i = 0; i < 4; ++i)
        osc_dispatcher_join(&dispatcher, &listener[i], now_ns);
    if (!osc_table_set(&table, "glove", 1, channel, 2))
        abort();
    take(&dispatcher, &host, told, osc_table_write(&table, told, sizeof told), 1, now_ns);
    while (size > 2) {
        size_t length = (size_t)data[0] | (size_t)data[1] << 8;
        uint16_t port = length & 0x8000 ? 2 : 1;
        length &= 0x7fff;
        data += 2;
        size -= 2;
        if (length > size)
            length = size;
        now_ns += 300000000;
        take(&dispatcher, &host, data, length, port, now_ns);
        for (int i = 0; i < 4; ++i)
            check(&listener[i], now_ns);
        data += length;
        size -= length;
    }
    return 0;
}
