#include "io/read/gltf_container.h"

#include <string.h>

enum { HEADER_SIZE = 12, CHUNK_HEADER_SIZE = 8 };
static const uint32_t JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942; /* "JSON" "BIN\0" */

static uint32_t read_u32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static mrt_result check_header(text_view file, error *err)
{
    size_t size = (size_t)(file.end - file.at);
    if (size < HEADER_SIZE + CHUNK_HEADER_SIZE)
        return error_set(err, MRT_ERR_FORMAT, "the .glb ends within its header");
    if (read_u32(file.at + 4) != 2)
        return error_set(err, MRT_ERR_UNSUPPORTED, "glTF version %u: only version 2 is read",
                         read_u32(file.at + 4));
    if (read_u32(file.at + 8) > size)
        return error_set(err, MRT_ERR_FORMAT,
                         "it is cut off: the header says %u bytes, the file has %zu; get it again",
                         read_u32(file.at + 8), size);
    if (read_u32(file.at + 8) != size)
        return error_set(err, MRT_ERR_FORMAT, "the header says %u bytes, the file has %zu",
                         read_u32(file.at + 8), size);
    return MRT_OK;
}

static mrt_result split_chunks(gltf_container *out, text_view file, error *err)
{
    mrt_result result = check_header(file, err);
    if (result < 0)
        return result;
    text_view rest = {file.at + HEADER_SIZE, file.end};
    for (int chunk = 0; rest.at < rest.end; ++chunk) {
        size_t left = (size_t)(rest.end - rest.at);
        if (left < CHUNK_HEADER_SIZE || read_u32(rest.at) > left - CHUNK_HEADER_SIZE)
            return error_set(err, MRT_ERR_FORMAT, "chunk %d goes past the end of the file", chunk);
        uint32_t length = read_u32(rest.at), type = read_u32(rest.at + 4);
        text_view content = {rest.at + CHUNK_HEADER_SIZE, rest.at + CHUNK_HEADER_SIZE + length};
        if ((chunk == 0) != (type == JSON_CHUNK))
            return error_set(err, MRT_ERR_FORMAT, "the first chunk, and no other, must be JSON");
        if (chunk == 0)
            out->json = content;
        else if (chunk == 1 && type == BINARY_CHUNK)
            out->binary = content;
        rest.at = content.end;
    }
    return MRT_OK;
}

/* The end of the string that starts at `at` (on its quote), or `end`. */
static const char *skip_string(const char *at, const char *end)
{
    for (++at; at < end && *at != '"'; ++at)
        if (*at == '\\' && at + 1 < end)
            ++at;
    return at < end ? at + 1 : end;
}

static mrt_result check_limits(text_view json, error *err)
{
    int nesting = 0, value_count = 0;
    if (json.end - json.at > GLTF_JSON_SIZE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the JSON is longer than %d bytes: export it as .glb", GLTF_JSON_SIZE_MAX);
    for (const char *at = json.at; at < json.end;) {
        if (*at == '"') {
            at = skip_string(at, json.end);
            continue;
        }
        bool opens = *at == '{' || *at == '[';
        nesting += opens;
        nesting -= *at == '}' || *at == ']';
        value_count += opens || *at == ',';
        if (nesting > GLTF_NESTING_MAX)
            return error_set(err, MRT_ERR_FORMAT, "the JSON is nested more than %d deep",
                             GLTF_NESTING_MAX);
        if (value_count > GLTF_VALUES_MAX)
            return error_set(err, MRT_ERR_UNSUPPORTED, "the JSON has more than %d values",
                             GLTF_VALUES_MAX);
        at += 1;
    }
    return MRT_OK;
}

mrt_result gltf_container_parse(gltf_container *out, const void *data, size_t size, error *err)
{
    text_view file = text_view_of(data, size);
    *out = (gltf_container){.json = file};
    out->is_binary = size >= 4 && memcmp(data, "glTF", 4) == 0;
    if (out->is_binary) {
        mrt_result result = split_chunks(out, file, err);
        if (result < 0)
            return result;
    }
    return check_limits(out->json, err);
}
