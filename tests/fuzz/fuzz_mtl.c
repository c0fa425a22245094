#include "io/read/mtl.h"

#include "fuzz_mesh.h"

#define QUAD                                                                                       \
    "mtllib a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"               \
    "usemtl skin\nf 1/1 2/2 3/3\nusemtl eye\nf 1/3 3/2 4/4\n"

/* A file of materials, onto a mesh of two. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mesh m;
    mtl_library library = {0};
    error err = {""};
    fuzz_mesh_require(obj_parse(&m, QUAD, strlen(QUAD), NULL, MESH_VERTICES_ALL, &err) == MRT_OK,
                      "a mesh");
    mrt_result result = mtl_parse(&library, data, size, "sub/", &err);
    fuzz_mesh_require(result == MRT_OK || fuzz_is_reason(err.text), "one line of reason");
    for (size_t i = 0; i < library.count; ++i)
        for (int use = 0; use < MTL_USES; ++use) {
            const char *file = library.material[i].map[use].file;
            fuzz_mesh_require(!file || file[0], "a name");
        }
    mtl_apply(&m, &library, NULL, size);
    mtl_library_finish(&library);
    return fuzz_mesh_check(MRT_OK, &m, &err);
}
