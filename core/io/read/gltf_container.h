/* io/gltf_container.h - what surrounds a glTF document: the chunks of a .glb, and the limits that
 * its JSON must keep before any parser sees it. Private to the glTF reader; pure. */
#ifndef MAROTTE_IO_GLTF_CONTAINER_H
#define MAROTTE_IO_GLTF_CONTAINER_H
#include "base/error.h"
#include "base/text.h"

enum {
    GLTF_NESTING_MAX = 64,
    GLTF_VALUES_MAX = 500000,     /* commas and opening brackets outside strings */
    GLTF_JSON_SIZE_MAX = 1 << 28, /* bytes; data URIs count */
};

typedef struct gltf_container { /* pieces of the caller's bytes */
    text_view json;
    text_view binary; /* the BIN chunk of a .glb; empty: none */
    bool is_binary;
} gltf_container;

#ifdef __cplusplus
extern "C" {
#endif
/* A .glb by its first four bytes, else the whole is JSON. The JSON keeps the limits. */
CHECKED mrt_result gltf_container_parse(gltf_container *out, const void *data, size_t size,
                                        error *err);
#ifdef __cplusplus
}
#endif

#endif
