/* tests/fuzz/fuzz_mesh.h - what must hold after any mesh reader, whatever it was given. */
#ifndef MAROTTE_TESTS_FUZZ_MESH_H
#define MAROTTE_TESTS_FUZZ_MESH_H
#include "fuzz_text.h"
#include "io/mesh_file.h"
#include "io/openmesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void fuzz_mesh_require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

/* Every accepted triangle is an edge list in the adjacency, every other is rejected. */
static inline void fuzz_mesh_check_topology(const mesh *m)
{
    topology t;
    error err = {""};
    if (m->vertex_count > 100000 || m->triangle_count > 100000)
        return; /* OpenMesh is slow under sanitizers */
    fuzz_mesh_require(openmesh_topology(&t, m, &err) == MRT_OK, "topology of a valid mesh");
    fuzz_mesh_require(t.vertex_count == m->vertex_count, "as many vertices");
    fuzz_mesh_require(t.rejected_count <= m->triangle_count, "rejected are triangles");
    for (uint32_t v = 0; v < t.vertex_count; ++v)
        for (uint32_t i = t.neighbour_start[v]; i < t.neighbour_start[v + 1]; ++i)
            fuzz_mesh_require(
                t.neighbour[i] < t.vertex_count && t.neighbour[i] != v &&
                    (i == t.neighbour_start[v] || t.neighbour[i] > t.neighbour[i - 1]),
                "neighbours ascend");
    topology_destroy(&t);
}

static inline int fuzz_mesh_check(mrt_result result, mesh *m, const error *err)
{
    error reason = {""};
    if (result < 0) {
        fuzz_mesh_require(fuzz_is_reason(err->text), "one line of reason");
        fuzz_mesh_require(!m->position && !m->triangle && !m->note, "nothing is left on failure");
        return 0;
    }
    if (mesh_validate(m, &reason) < 0)
        fuzz_mesh_require(false, reason.text);
    fuzz_mesh_require(m->triangle_count > 0, "a surface");
    fuzz_mesh_check_topology(m);
    mesh_destroy(m);
    return 0;
}

#endif
