/* io/read/gltf_load.hpp - loads a glTF document as tinygltf's model: extracted from its .glb,
 * checked for everything that tinygltf does not check (types, whole numbers, sizes, external
 * buffers), decompressed. Private to the glTF reader and writer. Failures are gltf_failure, up to
 * the C functions in gltf_reader.cpp. */
#ifndef MAROTTE_IO_GLTF_LOAD_HPP
#define MAROTTE_IO_GLTF_LOAD_HPP
#include <stdexcept>
#include <string>
#include <vector>

#include <tiny_gltf.h>

extern "C" {
#include "base/error.h"
#include "base/text.h"
}

struct gltf_failure : std::runtime_error {
    gltf_failure(mrt_result code_, const std::string &text) : std::runtime_error(text), code(code_)
    {
    }
    mrt_result code;
};

[[noreturn, gnu::format(printf, 2, 3)]] void gltf_fail(mrt_result code, const char *format, ...);

/* Names of the extension of compressed buffer views. */
constexpr const char *GLTF_MESHOPT_NAMES[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

struct gltf_container { /* pieces of the caller's bytes */
    text_view json;
    text_view binary; /* the BIN chunk of a .glb; empty: none */
    bool is_binary;
};

/* Parses a .glb, detected by its first four bytes, else plain JSON. The JSON must keep the limits
 * on its size, nesting and number of values. */
CHECKED mrt_result gltf_container_parse(gltf_container *out, const void *data, size_t size,
                                        error *err);

struct gltf_image { /* the description of a picture, not checked yet */
    std::string name, uri;
    int view; /* -1: none */
};

struct gltf_document {
    tinygltf::Model model; /* without images, animations, cameras, lights */
    std::vector<gltf_image> images;
    std::vector<bool> has_roughness; /* of each material */
};

/* `directory`: as in gltf_parse. */
gltf_document gltf_load(const gltf_container &container, const char *directory);

/* Returns the text in printable form. */
std::string gltf_printable(const std::string &text);
/* "a%20b" of a URI. */
std::string gltf_percent_decoded(const std::string &uri);

/* Decodes compressed data. `file_size` limits the memory for it. */
void gltf_decode(tinygltf::Model &model, size_t file_size);

const tinygltf::Accessor &gltf_accessor_at(const tinygltf::Model &model, int index);

/* ---- values of extensions, not checked yet ---- */

/* Returns a member of an object, else an empty value. */
const tinygltf::Value &gltf_member(const tinygltf::Value &of, const char *key);
/* Returns a whole number, else `otherwise`. */
int64_t gltf_whole(const tinygltf::Value &value, int64_t otherwise);

#endif
