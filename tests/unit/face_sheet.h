/* A sheet of skin in the plane z = 0 with a mouth: a slit along y = 0 from x = -25 to 25 mm, whose
 * two edges are apart as surface and together in space. Mirrored at x = 0, triangles included. */
#ifndef TESTS_UNIT_FACE_SHEET_H
#define TESTS_UNIT_FACE_SHEET_H
#include "face/bind.h"
#include "io/openmesh.h"

#include <stdlib.h>
#include <string.h>

enum {
    SHEET_SIDE = 21, /* vertices along a side, 5 mm apart; the middle one is at 0 */
    SHEET_MIDDLE = 10,
    SHEET_SLIT = 5, /* columns from the middle to the corner of the mouth */
    SHEET_LIPS = 2 * SHEET_SLIT - 1,
    SHEET_COUNT = SHEET_SIDE * SHEET_SIDE + SHEET_LIPS
};

typedef struct sheet {
    mesh mesh;
    topology topology;
    rig rig;
    binding binding;
} sheet;

/* column and row: -10 .. 10 from the middle, rows upwards. On the slit this is the upper lip. */
static inline uint32_t sheet_at(int column, int row)
{
    return (uint32_t)((row + SHEET_MIDDLE) * SHEET_SIDE + column + SHEET_MIDDLE);
}

/* column: -4 .. 4 */
static inline uint32_t sheet_lower_lip(int column)
{
    return (uint32_t)(SHEET_SIDE * SHEET_SIDE + column + SHEET_SLIT - 1);
}

static inline uint32_t sheet_corner(int column, int row, bool is_below)
{
    bool is_slit = row == 0 && abs(column) < SHEET_SLIT;
    return is_slit && is_below ? sheet_lower_lip(column) : sheet_at(column, row);
}

static inline void sheet_put(mesh *m, uint32_t *at, uint32_t a, uint32_t b, uint32_t c)
{
    m->triangle[3 * *at] = a;
    m->triangle[3 * *at + 1] = b;
    m->triangle[3 * *at + 2] = c;
    *at += 1;
}

static inline void sheet_put_square(mesh *m, uint32_t *at, int column, int row)
{
    bool is_below = row < 0;
    uint32_t a = sheet_corner(column, row, is_below), b = sheet_corner(column + 1, row, is_below);
    uint32_t c = sheet_corner(column + 1, row + 1, is_below);
    uint32_t d = sheet_corner(column, row + 1, is_below);
    if (column < 0) {
        sheet_put(m, at, a, b, d);
        sheet_put(m, at, b, c, d);
    } else {
        sheet_put(m, at, a, b, c);
        sheet_put(m, at, a, c, d);
    }
}

/* extra: vertices and triangles that the caller adds behind the sheet's. */
static inline void sheet_create_mesh(mesh *m, uint32_t extra_vertices, uint32_t extra_triangles)
{
    uint32_t squares = 2 * (SHEET_SIDE - 1) * (SHEET_SIDE - 1), at = 0;
    error err;
    assert_int_equal(mesh_create(m, SHEET_COUNT + extra_vertices, squares + extra_triangles, &err),
                     MRT_OK);
    for (int row = -SHEET_MIDDLE; row <= SHEET_MIDDLE; row++)
        for (int column = -SHEET_MIDDLE; column <= SHEET_MIDDLE; column++) {
            m->position[3 * sheet_at(column, row)] = 5.0f * (float)column;
            m->position[3 * sheet_at(column, row) + 1] = 5.0f * (float)row;
        }
    for (int column = 1 - SHEET_SLIT; column < SHEET_SLIT; column++)
        m->position[3 * sheet_lower_lip(column)] = 5.0f * (float)column;
    for (int row = -SHEET_MIDDLE; row < SHEET_MIDDLE; row++)
        for (int column = -SHEET_MIDDLE; column < SHEET_MIDDLE; column++)
            sheet_put_square(m, &at, column, row);
}

static inline void sheet_parse_rig(rig *r, const char *json)
{
    error err = {""};
    if (rig_parse(r, json, strlen(json), "sheet.rig.json", &err) < 0)
        fail_msg("%s", err.text);
}

static inline void sheet_bind(sheet *s, const char *json)
{
    error err = {""};
    assert_int_equal(openmesh_topology(&s->topology, &s->mesh, &err), MRT_OK);
    sheet_parse_rig(&s->rig, json);
    if (binding_create(&s->binding, &s->rig, &s->mesh, &s->topology, &err) != MRT_OK)
        fail_msg("%s", err.text);
}

static inline void sheet_create(sheet *s, const char *json)
{
    *s = (sheet){0};
    sheet_create_mesh(&s->mesh, 0, 0);
    sheet_bind(s, json);
}

static inline void sheet_destroy(sheet *s)
{
    binding_destroy(&s->binding);
    rig_destroy(&s->rig);
    topology_destroy(&s->topology);
    mesh_destroy(&s->mesh);
}

static inline float sheet_weight(const sheet *s, uint32_t bone, uint32_t vertex)
{
    return s->binding.weight[(size_t)bone * s->binding.vertex_count + vertex];
}

/* Forehead, upper lip: skull; chin, lower lip: jaw. Vertices 451 and 8 are the middle of the slit's
 * lower edge and of the lowest row. */
#define SHEET_BONES                                                                                \
    "\"marotte_rig\": 1, \"mesh\": \"sheet.obj\", \"unit\": \"mm\", \"bones\": ["                  \
    "{\"name\": \"skull\"}, {\"name\": \"jaw\", \"hinge\": {\"left\": [40, 20, -80], "             \
    "\"right\": [-40, 20, -80]}, \"open_deg\": [0, 30], \"lateral_mm\": 8, \"forward_mm\": 6, "    \
    "\"slide_mm\": 0, \"incisor\": [0, 0, 0]}]"
#define SHEET_REGIONS                                                                              \
    "{\"bone\": \"skull\", \"rigid\": true, \"select\": {\"vertices\": [\"420-440\"]}}, "          \
    "{\"bone\": \"jaw\", \"weight\": 1, \"mobility\": 1, \"select\": {\"vertices\": "              \
    "[\"0-20\"]}}, "                                                                               \
    "{\"bone\": \"jaw\", \"weight\": 0, \"select\": {\"vertices\": [\"218-222\"]}}, "              \
    "{\"bone\": \"jaw\", \"weight\": 1, \"select\": {\"vertices\": [\"443-447\"]}}"

#endif
