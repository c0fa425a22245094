/* io/write/gltf_source_check.hpp - what must hold of a glTF document before an export carries it
 * over: all that it names is there, all ranges are within their buffers, and what grows is a list.
 * The reader looks only at what the scene shows; an export takes all of it along, and appends to
 * it. Private to the glTF writer; failures are gltf_failure and name the place as a JSON pointer.
 */
#ifndef MAROTTE_IO_GLTF_SOURCE_CHECK_HPP
#define MAROTTE_IO_GLTF_SOURCE_CHECK_HPP
#include "io/read/gltf_load.hpp"

#include <nlohmann/json.hpp>

/* The document is one that gltf_load took. buffer_size: bytes of each of its buffers; of one that
 * does not travel, those that it says. */
void gltf_source_check(const nlohmann::ordered_json &document,
                       const std::vector<size_t> &buffer_size);

#endif
