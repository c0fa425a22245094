/* io/gltf_load.hpp - a glTF document as tinygltf's model, checked for what tinygltf takes on trust:
 * types, whole numbers, sizes, buffers from outside. Private to the glTF reader. Failures travel as
 * gltf_failure up to the C border in gltf_reader.cpp. */
#ifndef MAROTTE_IO_GLTF_LOAD_HPP
#define MAROTTE_IO_GLTF_LOAD_HPP
#include <stdexcept>
#include <string>

#include <tiny_gltf.h>

extern "C" {
#include "io/read/gltf_container.h"
}

struct gltf_failure : std::runtime_error {
    gltf_failure(mrt_result code_, const std::string &text) : std::runtime_error(text), code(code_)
    {
    }
    mrt_result code;
};

[[noreturn, gnu::format(printf, 2, 3)]] void gltf_fail(mrt_result code, const char *format, ...);

/* The part of the model that shapes need: no images, textures, animations, cameras, lights.
 * `directory`: as in gltf_parse. */
tinygltf::Model gltf_load(const gltf_container &container, const char *directory);

/* Decodes what is compressed in it. `file_size` bounds what that may take. */
void gltf_decode(tinygltf::Model &model, size_t file_size);

/* ---- what extensions say, which nobody has checked ---- */

/* A member of an object, else an empty value. */
const tinygltf::Value &gltf_member(const tinygltf::Value &of, const char *key);
/* A whole number, else `otherwise`. */
int64_t gltf_whole(const tinygltf::Value &value, int64_t otherwise);

#endif
