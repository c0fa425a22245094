/* unit/rig_help.h - what the tests of rigs share: rigs from text, a small mesh with topology. */
#ifndef MAROTTE_TESTS_UNIT_RIG_HELP_H
#define MAROTTE_TESTS_UNIT_RIG_HELP_H
#include "face/rig.h"
#include "io/openmesh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static inline mrt_result rig_from(rig *out, const char *text, error *err)
{
    return rig_parse(out, text, strlen(text), "head.rig.json", err);
}

/* A rig around one section: {"marotte_rig": 1, "mesh": "m.obj", BODY}. */
static inline mrt_result rig_with(rig *out, const char *body, error *err)
{
    char text[4096];
    int length = snprintf(text, sizeof text, "{\"marotte_rig\": 1, \"mesh\": \"m.obj\", %s}", body);
    if (length < 0 || (size_t)length >= sizeof text)
        abort();
    return rig_from(out, text, err);
}

enum { SHEET_SIDE = 5, SHEET_VERTICES = SHEET_SIDE * SHEET_SIDE };

/* Vertex row * 5 + column at (10 column - 20, 10 row - 20, 0) mm, facing +z: symmetric in x. */
static inline mesh make_sheet(void)
{
    mesh m;
    error err;
    const uint32_t cells = SHEET_SIDE - 1;
    if (mesh_create(&m, SHEET_VERTICES, cells * cells * 2, &err) != MRT_OK)
        abort();
    for (uint32_t v = 0; v < SHEET_VERTICES; ++v) {
        m.position[v * 3 + 0] = 10.0f * (float)(v % SHEET_SIDE) - 20.0f;
        m.position[v * 3 + 1] = 10.0f * (float)(v / SHEET_SIDE) - 20.0f;
    }
    uint32_t *t = m.triangle;
    for (uint32_t cell = 0; cell < cells * cells; ++cell) {
        uint32_t a = cell / cells * SHEET_SIDE + cell % cells, b = a + SHEET_SIDE;
        const uint32_t corner[6] = {a, a + 1, b + 1, a, b + 1, b};
        memcpy(t, corner, sizeof corner);
        t += 6;
    }
    return m;
}

static inline topology make_topology(const mesh *m)
{
    topology t;
    error err;
    if (openmesh_topology(&t, m, &err) != MRT_OK)
        abort();
    return t;
}

#endif
