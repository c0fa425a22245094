/* tests/fuzz/fuzz_glb.h - how a .glb is mutated. Random bytes hardly ever keep its lengths right,
 * nor its JSON whole. So most mutations change one number of the JSON, or the JSON or the buffer
 * alone, and put the container in order. One target includes it: it defines libFuzzer's mutator. */
#ifndef MAROTTE_TESTS_FUZZ_GLB_H
#define MAROTTE_TESTS_FUZZ_GLB_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { JSON_START = 20, PIECE_MAX = 65536 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);

typedef struct pieces {
    uint8_t json[PIECE_MAX], binary[PIECE_MAX];
    size_t json_size, binary_size;
} pieces;

static uint32_t read_u32(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static uint8_t *write_u32(uint8_t *at, size_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        *at++ = (uint8_t)(value >> shift);
    return at;
}

static bool split(pieces *out, const uint8_t *data, size_t size)
{
    if (size < JSON_START || memcmp(data, "glTF", 4) != 0)
        return false;
    out->json_size = read_u32(data + 12);
    if (out->json_size > size - JSON_START || out->json_size > PIECE_MAX / 2)
        return false;
    size_t binary_start = JSON_START + out->json_size + 8;
    out->binary_size = size > binary_start ? size - binary_start : 0;
    if (out->binary_size > PIECE_MAX)
        return false;
    memcpy(out->json, data + JSON_START, out->json_size);
    memcpy(out->binary, data + size - out->binary_size, out->binary_size);
    return true;
}

static size_t join(const pieces *p, uint8_t *data, size_t max_size)
{
    size_t json_size = (p->json_size + 3) / 4 * 4, binary_size = p->binary_size / 4 * 4;
    size_t size = JSON_START + json_size + (binary_size ? 8 + binary_size : 0);
    if (size > max_size)
        return 0;
    uint8_t *at = write_u32(data, 0x46546c67);
    at = write_u32(at, 2);
    at = write_u32(at, size);
    at = write_u32(at, json_size);
    at = write_u32(at, 0x4e4f534a);
    memset(at, ' ', json_size);
    memcpy(at, p->json, p->json_size);
    if (binary_size) {
        at = write_u32(at + json_size, binary_size);
        at = write_u32(at, 0x004e4942);
        memcpy(at, p->binary, binary_size);
    }
    return size;
}

static bool is_digit(uint8_t c)
{
    return c >= '0' && c <= '9';
}

/* Another number in the place of the n-th. */
static void replace_number(pieces *p, unsigned int n, unsigned int choice)
{
    static const char *const number[] = {"0",    "1",    "2",    "3",          "4",    "5",
                                         "6",    "7",    "8",    "12",         "48",   "-1",
                                         "1e30", "0.5",  "5120", "5121",       "5122", "5123",
                                         "5125", "5126", "255",  "2147483647", "65536"};
    const char *with = number[choice % (sizeof number / sizeof *number)];
    size_t count = 0, start, end;
    for (size_t i = 1; i < p->json_size; ++i)
        count += is_digit(p->json[i]) && !is_digit(p->json[i - 1]);
    if (count == 0)
        return;
    n %= (unsigned int)count;
    for (start = 1; start < p->json_size; ++start)
        if (is_digit(p->json[start]) && !is_digit(p->json[start - 1]) && n-- == 0)
            break;
    for (end = start; end < p->json_size && is_digit(p->json[end]);)
        ++end;
    size_t length = strlen(with);
    if (p->json_size + length > PIECE_MAX / 2)
        return;
    memmove(p->json + start + length, p->json + end, p->json_size - end);
    memcpy(p->json + start, with, length);
    p->json_size += length - (end - start);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
    static pieces p;
    size_t joined = 0;
    if (seed % 16 != 0 && split(&p, data, size)) {
        if (seed % 16 < 10)
            replace_number(&p, seed >> 4, seed >> 16);
        else if (seed % 16 < 13)
            p.json_size = LLVMFuzzerMutate(p.json, p.json_size, PIECE_MAX / 2);
        else
            p.binary_size = LLVMFuzzerMutate(p.binary, p.binary_size, PIECE_MAX);
        joined = join(&p, data, max_size);
    }
    return joined ? joined : LLVMFuzzerMutate(data, size, max_size);
}

#endif
