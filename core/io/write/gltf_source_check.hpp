/* io/write/gltf_source_check.hpp - checks a glTF document before an export copies it: all
 * references exist, all ranges are within their buffers, and all extended values are lists. The
 * reader checks only the parts of the shown scene; an export copies everything, and appends to it.
 * Private to the glTF writer; failures are gltf_failure and give the place as a JSON pointer. */
#ifndef MAROTTE_IO_GLTF_SOURCE_CHECK_HPP
#define MAROTTE_IO_GLTF_SOURCE_CHECK_HPP
#include "io/read/gltf_load.hpp"

#include <nlohmann/json.hpp>

/* gltf_load must have accepted the document. buffer_size: bytes of each buffer; for a buffer that
 * is not copied, its byteLength. */
void gltf_source_check(const nlohmann::ordered_json &document,
                       const std::vector<size_t> &buffer_size);

#endif
