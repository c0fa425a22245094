#include "fuzz_glb.h"
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mesh m;
    error err = {""};
    return fuzz_mesh_check(gltf_parse(&m, data, size, NULL, &err), &m, &err);
}
