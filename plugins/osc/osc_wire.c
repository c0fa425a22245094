#include "osc_wire.h"

#include <lo/lo.h>

#include <string.h>

/* Seconds from 1900, the epoch of time tags, to 1970. */
static const int64_t epoch_s = 2208988800;
static const int64_t ns_per_s = 1000000000;
enum { BUNDLE_HEAD = 16, SIZE_FIELD = 4 };

static uint32_t big_endian(const unsigned char *at)
{
    return (uint32_t)at[0] << 24 | (uint32_t)at[1] << 16 | (uint32_t)at[2] << 8 | (uint32_t)at[3];
}

static int64_t tag_time_ns(const unsigned char *at)
{
    uint32_t seconds = big_endian(at), fraction = big_endian(at + 4);
    if (seconds == 0)
        return OSC_NO_TIME; /* 0.1 means immediately; some send 0.0 */
    int64_t part_ns = (int64_t)(((uint64_t)fraction * (uint64_t)ns_per_s) >> 32);
    return ((int64_t)seconds - epoch_s) * ns_per_s + part_ns;
}

/* ---- reading ---- */

typedef struct reader {
    osc_wire_take *take;
    void *context;
    uint32_t message_count;
} reader;

static osc_fault read_message(reader *self, unsigned char *bytes, size_t size, int64_t tag_ns)
{
    if (++self->message_count > OSC_MESSAGES_MAX)
        return OSC_FAULT_SIZE;
    lo_message message = lo_message_deserialise(bytes, size, NULL);
    if (!message)
        return OSC_FAULT_PACKET;
    osc_fault fault = OSC_FAULT_NONE;
    int count = lo_message_get_argc(message);
    if (count < 0 || count > OSC_ARGUMENTS_MAX)
        fault = OSC_FAULT_SIZE;
    else
        self->take(self->context,
                   &(osc_message){.address = (const char *)bytes,
                                  .types = lo_message_get_types(message),
                                  .count = (uint32_t)count,
                                  .tag_ns = tag_ns,
                                  .argument = (void **)lo_message_get_argv(message)});
    lo_message_free(message);
    return fault;
}

/* Unread part of a bundle, or of the packet. */
typedef struct span {
    unsigned char *at, *end;
    int64_t tag_ns;
} span;

static bool is_bundle(const unsigned char *bytes, size_t size)
{
    return size >= BUNDLE_HEAD && memcmp(bytes, "#bundle", 8) == 0;
}

/* Removes one element from `rest`. Returns false if its size is invalid. */
static bool next_element(span *rest, unsigned char **out_at, size_t *out_size)
{
    size_t left = (size_t)(rest->end - rest->at);
    if (left < SIZE_FIELD)
        return false;
    size_t size = big_endian(rest->at);
    if (size == 0 || size % 4 != 0 || size > left - SIZE_FIELD)
        return false;
    *out_at = rest->at + SIZE_FIELD;
    *out_size = size;
    rest->at += SIZE_FIELD + size;
    return true;
}

static osc_fault read_bundle(reader *self, unsigned char *bytes, size_t size)
{
    span stack[OSC_DEPTH_MAX];
    uint32_t depth = 1;
    stack[0] = (span){bytes + BUNDLE_HEAD, bytes + size, tag_time_ns(bytes + 8)};
    while (depth > 0) {
        span *rest = &stack[depth - 1];
        if (rest->at == rest->end) {
            depth -= 1;
            continue;
        }
        unsigned char *element;
        size_t element_size;
        if (!next_element(rest, &element, &element_size))
            return OSC_FAULT_PACKET;
        if (!is_bundle(element, element_size)) {
            osc_fault fault = read_message(self, element, element_size, rest->tag_ns);
            if (fault != OSC_FAULT_NONE)
                return fault;
            continue;
        }
        if (depth == OSC_DEPTH_MAX)
            return OSC_FAULT_SIZE;
        stack[depth++] =
            (span){element + BUNDLE_HEAD, element + element_size, tag_time_ns(element + 8)};
    }
    return OSC_FAULT_NONE;
}

osc_fault osc_wire_read(void *bytes, size_t size, osc_wire_take *take, void *context)
{
    reader self = {take, context, 0};
    unsigned char *at = bytes;
    if (size < 8 || size % 4 != 0)
        return OSC_FAULT_PACKET; /* the shortest message is an address and an empty type tag */
    if (size >= OSC_PACKET_MAX)
        return OSC_FAULT_SIZE;
    if (is_bundle(at, size))
        return read_bundle(&self, at, size);
    return read_message(&self, at, size, OSC_NO_TIME);
}

/* ---- arguments ---- */

static bool has_type(const osc_message *message, uint32_t index, char type)
{
    return index < message->count && message->types[index] == type;
}

/* Arguments in liblo are aligned to 4 bytes only, so they are copied. */
bool osc_message_int32(const osc_message *message, uint32_t index, int32_t *out)
{
    if (!has_type(message, index, LO_INT32))
        return false;
    memcpy(out, message->argument[index], sizeof *out);
    return true;
}

bool osc_message_int64(const osc_message *message, uint32_t index, int64_t *out)
{
    if (!has_type(message, index, LO_INT64))
        return false;
    memcpy(out, message->argument[index], sizeof *out);
    return true;
}

bool osc_message_float(const osc_message *message, uint32_t index, float *out)
{
    if (!has_type(message, index, LO_FLOAT))
        return false;
    memcpy(out, message->argument[index], sizeof *out);
    return true;
}

const char *osc_message_text(const osc_message *message, uint32_t index)
{
    if (!has_type(message, index, LO_STRING) && !has_type(message, index, LO_SYMBOL))
        return NULL;
    return message->argument[index];
}

bool osc_message_number(const osc_message *message, uint32_t index, double *out)
{
    int32_t whole;
    int64_t long_whole;
    float single;
    if (has_type(message, index, LO_DOUBLE))
        memcpy(out, message->argument[index], sizeof *out);
    else if (has_type(message, index, LO_TRUE) || has_type(message, index, LO_FALSE))
        *out = message->types[index] == LO_TRUE ? 1 : 0;
    else if (osc_message_float(message, index, &single))
        *out = (double)single;
    else if (osc_message_int32(message, index, &whole))
        *out = whole;
    else if (osc_message_int64(message, index, &long_whole))
        *out = (double)long_whole;
    else
        return false;
    return true;
}

/* ---- writing ---- */

osc_builder osc_builder_start(void)
{
    lo_message message = lo_message_new();
    return (osc_builder){message, !message};
}

void osc_builder_int32(osc_builder *builder, int32_t value)
{
    if (!builder->failed)
        builder->failed = lo_message_add_int32(builder->message, value) != 0;
}

void osc_builder_int64(osc_builder *builder, int64_t value)
{
    if (!builder->failed)
        builder->failed = lo_message_add_int64(builder->message, value) != 0;
}

void osc_builder_float(osc_builder *builder, float value)
{
    if (!builder->failed)
        builder->failed = lo_message_add_float(builder->message, value) != 0;
}

void osc_builder_text(osc_builder *builder, const char *text)
{
    if (!builder->failed)
        builder->failed = lo_message_add_string(builder->message, text) != 0;
}

size_t osc_builder_finish(osc_builder *builder, const char *address, void *out, size_t capacity)
{
    size_t size = 0;
    if (!builder->failed && lo_message_length(builder->message, address) <= capacity)
        if (!lo_message_serialise(builder->message, address, out, &size))
            size = 0;
    if (builder->message)
        lo_message_free(builder->message);
    *builder = (osc_builder){NULL, true};
    return size;
}

/* ---- sending ---- */

static void put_big_endian(unsigned char *at, uint32_t value)
{
    for (int i = 0; i < 4; ++i)
        at[i] = (unsigned char)(value >> (24 - 8 * i));
}

static void send_bundle(osc_sender *self)
{
    if (self->size <= BUNDLE_HEAD)
        return;
    mrt_result result = udp_sender_send(&self->to, self->bundle, self->size);
    if (result < 0 || self->worst == MRT_OK)
        self->worst = result;
    self->size = 0;
}

static void start_bundle(osc_sender *self)
{
    memcpy(self->bundle, "#bundle", 8);
    put_big_endian(self->bundle + 8, (uint32_t)(self->tag >> 32));
    put_big_endian(self->bundle + 12, (uint32_t)self->tag);
    self->size = BUNDLE_HEAD;
}

void osc_sender_begin(osc_sender *self, int64_t utc_ns)
{
    const uint64_t second_ns = (uint64_t)ns_per_s, ns = utc_ns > 0 ? (uint64_t)utc_ns : 0;
    self->tag = utc_ns > 0 ? (ns / second_ns + (uint64_t)epoch_s) << 32 |
                                 ((ns % second_ns) << 32) / second_ns
                           : 1; /* immediately */
    self->size = 0;
    self->worst = MRT_OK;
}

void osc_sender_add(osc_sender *self, osc_builder *message, const char *address)
{
    unsigned char bytes[OSC_BUNDLE_MAX - BUNDLE_HEAD - SIZE_FIELD];
    size_t size = osc_builder_finish(message, address, bytes, sizeof bytes);
    if (size == 0)
        return; /* out of memory: the next frame repeats the values */
    if (self->size > BUNDLE_HEAD && self->size + SIZE_FIELD + size > OSC_BUNDLE_MAX)
        send_bundle(self);
    if (self->size == 0)
        start_bundle(self);
    put_big_endian(self->bundle + self->size, (uint32_t)size);
    memcpy(self->bundle + self->size + SIZE_FIELD, bytes, size);
    self->size += SIZE_FIELD + size;
}

mrt_result osc_sender_end(osc_sender *self)
{
    send_bundle(self);
    return self->worst;
}
