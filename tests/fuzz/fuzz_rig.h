/* fuzz/fuzz_rig.h - what must hold of a rig that was read, whatever it was read from. */
#ifndef MAROTTE_FUZZ_RIG_H
#define MAROTTE_FUZZ_RIG_H
#include "face/bind.h"
#include "face/rig_check.h"
#include "fuzz_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static inline void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

enum { SIDE = 5, VERTICES = SIDE * SIDE };

/* A grid of quads, joined up and across: enough for every selector. */
typedef struct grid {
    mesh m;
    topology t;
    uint32_t neighbour_start[VERTICES + 1], neighbour[VERTICES * 4];
    uint8_t on_border[VERTICES];
} grid;

static inline void link_grid(grid *g)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < VERTICES; ++v) {
        g->neighbour_start[v] = count;
        if (v >= SIDE)
            g->neighbour[count++] = v - SIDE;
        if (v % SIDE > 0)
            g->neighbour[count++] = v - 1;
        if (v % SIDE < SIDE - 1)
            g->neighbour[count++] = v + 1;
        if (v + SIDE < VERTICES)
            g->neighbour[count++] = v + SIDE;
    }
    g->neighbour_start[VERTICES] = count;
    g->t = (topology){.vertex_count = VERTICES,
                      .neighbour_start = g->neighbour_start,
                      .neighbour = g->neighbour,
                      .on_border = g->on_border};
}

static inline grid *the_grid(void)
{
    static grid *made;
    if (made)
        return made;
    error err;
    made = calloc(1, sizeof *made);
    require(made && mesh_create(&made->m, VERTICES, (SIDE - 1) * (SIDE - 1), &err) == MRT_OK,
            "memory");
    for (uint32_t v = 0; v < VERTICES; ++v) {
        made->m.position[v * 3 + 0] = 20.0f * (float)(v % SIDE) - 40.0f;
        made->m.position[v * 3 + 1] = 20.0f * (float)(v / SIDE) - 40.0f;
    }
    for (uint32_t i = 0; i < (SIDE - 1) * (SIDE - 1); ++i) {
        uint32_t corner = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        const uint32_t triangle[3] = {corner, corner + 1, corner + SIDE};
        memcpy(made->m.triangle + (size_t)i * 3, triangle, sizeof triangle);
    }
    link_grid(made);
    return made;
}

static inline void check_indices(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        require(r->bone[i].parent == RIG_NONE || r->bone[i].parent < i, "parents come first");
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        uint32_t mirror = r->contact[i].mirror;
        require(mirror == RIG_NONE || (mirror < r->contact_count && r->contact[mirror].mirror == i),
                "mirrors point back");
    }
    for (uint32_t i = 0; i < r->pose_count; ++i)
        for (uint32_t k = 0; k < r->pose[i].pull_count; ++k)
            require(r->pose[i].pull_contact[k] < r->contact_count, "pulls pull contacts");
}

/* All that is printed of it. */
static inline void check_names(const rig *r)
{
    require(fuzz_is_reason(r->name) && fuzz_is_reason(r->mesh_path), "names are shown");
    for (uint32_t i = 0; i < r->bone_count; ++i)
        require(fuzz_is_reason(r->bone[i].name), "bones are shown");
    for (uint32_t i = 0; i < r->region_count; ++i)
        require(!r->region[i].name || fuzz_is_reason(r->region[i].name), "regions are shown");
    for (uint32_t i = 0; i < r->contact_count; ++i)
        require(fuzz_is_reason(r->contact[i].name), "contacts are shown");
    for (uint32_t i = 0; i < r->pose_count; ++i)
        require(fuzz_is_reason(r->pose[i].name), "poses are shown");
    for (uint32_t i = 0; i < r->contact_set_count; ++i)
        require(fuzz_is_reason(r->contact_set[i].name), "sets are shown");
    for (const char *at = r->note; at && *at; ++at)
        require(*at == '\n' || (*at & 0x60) != 0 || (*at & 0x80) != 0, "notes are shown");
}

static inline void check_findings(const rig_findings *findings)
{
    for (uint32_t i = 0; i < findings->count; ++i)
        require(fuzz_is_reason(findings->item[i].text), "findings are shown");
}

/* What was read can be laid on a mesh, or is refused with a reason. */
static inline void check_use(const rig *r)
{
    grid *g = the_grid();
    bind_marks marks;
    rig_findings findings;
    error err = {""};
    mrt_result result = bind_marks_create(&marks, r, &g->m, &g->t, &err);
    require(result == MRT_OK || fuzz_is_reason(err.text), "one line of reason");
    if (result == MRT_OK)
        bind_marks_destroy(&marks);
    require(rig_check(&findings, r, &g->m, &g->t, NULL, &err) == MRT_OK, "a check");
    require(result == MRT_OK || rig_findings_count(&findings, RIG_ERROR) > 0, "it is found");
    check_findings(&findings);
    rig_findings_finish(&findings);
}

/* Nothing takes long without a word: a budget that is reached is an error with a reason. */
static inline void fuzz_require_quick(clock_t start)
{
    enum { SECONDS = 5 };
    require(clock() - start < (clock_t)SECONDS * CLOCKS_PER_SEC,
            "it ends, or says what is too much");
}

#endif
