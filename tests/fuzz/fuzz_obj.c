#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    mesh m;
    error err = {""};
    return fuzz_mesh_check(obj_parse(&m, data, size, NULL, MESH_VERTICES_ALL, &err), &m, &err);
}
