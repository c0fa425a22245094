/* OSC packets made byte by byte, independent of liblo and of the plugin: what other software sends.
 */
#ifndef TESTS_DEVICE_OSC_BYTES_H
#define TESTS_DEVICE_OSC_BYTES_H
#include <assert.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

typedef struct osc_bytes {
    unsigned char data[65536];
    size_t size;
} osc_bytes;

static inline void osc_bytes_raw(osc_bytes *out, const void *bytes, size_t size)
{
    assert(out->size + size <= sizeof out->data);
    memcpy(out->data + out->size, bytes, size);
    out->size += size;
}

static inline void osc_bytes_32(osc_bytes *out, uint32_t value)
{
    unsigned char big[4] = {(unsigned char)(value >> 24), (unsigned char)(value >> 16),
                            (unsigned char)(value >> 8), (unsigned char)value};
    osc_bytes_raw(out, big, 4);
}

static inline void osc_bytes_64(osc_bytes *out, uint64_t value)
{
    osc_bytes_32(out, (uint32_t)(value >> 32));
    osc_bytes_32(out, (uint32_t)value);
}

static inline void osc_bytes_text(osc_bytes *out, const char *text)
{
    static const unsigned char zeros[4] = {0};
    size_t length = strlen(text);
    osc_bytes_raw(out, text, length);
    osc_bytes_raw(out, zeros, 4 - length % 4);
}

static inline void osc_bytes_float(osc_bytes *out, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    osc_bytes_32(out, bits);
}

static inline void osc_bytes_arguments(osc_bytes *out, const char *types, va_list arguments)
{
    for (const char *type = types; *type; ++type) {
        if (*type == 'i') {
            osc_bytes_32(out, (uint32_t)va_arg(arguments, int));
        } else if (*type == 'h') {
            osc_bytes_64(out, (uint64_t)va_arg(arguments, int64_t));
        } else if (*type == 'f') {
            osc_bytes_float(out, (float)va_arg(arguments, double));
        } else if (*type == 'd') {
            double value = va_arg(arguments, double);
            uint64_t bits;
            memcpy(&bits, &value, sizeof bits);
            osc_bytes_64(out, bits);
        } else if (*type == 's') {
            osc_bytes_text(out, va_arg(arguments, const char *));
        }
    }
}

/* One message: osc_bytes_message(&b, "/marotte/pedal", "if", 1, 0.5). Types without arguments (T F)
 * take none. */
static inline void osc_bytes_message(osc_bytes *out, const char *address, const char *types, ...)
{
    char tag[300] = ",";
    assert(strlen(types) < sizeof tag - 1);
    strcat(tag, types);
    osc_bytes_text(out, address);
    osc_bytes_text(out, tag);
    va_list arguments;
    va_start(arguments, types);
    osc_bytes_arguments(out, types, arguments);
    va_end(arguments);
}

/* The same with `count` floats after what `types` says. */
static inline void osc_bytes_floats(osc_bytes *out, const char *address, const float *value,
                                    uint32_t count)
{
    char tag[300] = ",";
    for (uint32_t i = 0; i < count; ++i)
        strcat(tag, "f");
    osc_bytes_text(out, address);
    osc_bytes_text(out, tag);
    for (uint32_t i = 0; i < count; ++i)
        osc_bytes_float(out, value[i]);
}

/* A bundle's head; tag 1 is "immediately". */
static inline void osc_bytes_bundle(osc_bytes *out, uint64_t tag)
{
    osc_bytes_raw(out, "#bundle", 8);
    osc_bytes_64(out, tag);
}

static inline void osc_bytes_element(osc_bytes *out, const osc_bytes *element)
{
    osc_bytes_32(out, (uint32_t)element->size);
    osc_bytes_raw(out, element->data, element->size);
}

#endif
