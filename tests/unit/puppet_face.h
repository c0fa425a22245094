/* unit/puppet_face.h - the committed puppet, read once for the tests of a file, and its pieces. */
#ifndef MAROTTE_TESTS_UNIT_PUPPET_FACE_H
#define MAROTTE_TESTS_UNIT_PUPPET_FACE_H
#include "base/rigid.h"
#include "io/mesh_file.h"
#include "io/openmesh.h"

#include <stdlib.h>
#include <string.h>

#define PUPPET SOURCE_DIR "/rigs/puppet/puppet.glb"

static mesh face;
static topology net;

static inline int read_puppet(void **state)
{
    (void)state;
    error err = {0};
    if (mesh_file_read(&face, PUPPET, NULL, &err) < 0 || openmesh_topology(&net, &face, &err) < 0) {
        print_error("%s\n", err.text);
        return -1;
    }
    return 0;
}

static inline int forget_puppet(void **state)
{
    (void)state;
    topology_destroy(&net);
    mesh_destroy(&face);
    return 0;
}

static inline vec3 point_of(uint32_t vertex)
{
    const float *p = face.position + 3 * (size_t)vertex;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static inline vec3 corner_of(uint32_t triangle, uint32_t corner)
{
    return point_of(face.triangle[3 * (size_t)triangle + corner]);
}

static inline double distance(vec3 a, vec3 b)
{
    return vec3_length(vec3_sub(a, b));
}

/* Readers keep the names of materials: each part has one of its own. */
static inline const mesh_part *part_named(const char *name)
{
    for (uint32_t i = 0; i < face.part_count; ++i)
        if (strcmp(face.material[face.part[i].material].name, name) == 0)
            return &face.part[i];
    fail_msg("no part \"%s\"", name);
    return NULL;
}

/* 1 for each vertex of the part; for the caller to free. */
static inline uint8_t *vertices_of(const char *name)
{
    const mesh_part *part = part_named(name);
    uint8_t *used = calloc(face.vertex_count, 1);
    assert_non_null(used);
    for (size_t i = 0; i < 3 * (size_t)part->triangle_count; ++i)
        used[face.triangle[3 * (size_t)part->first_triangle + i]] = 1;
    return used;
}

static inline const float *attribute_named(const char *name)
{
    for (uint32_t i = 0; i < face.attribute_count; ++i)
        if (strcmp(face.attribute[i].name, name) == 0)
            return face.attribute[i].value;
    fail_msg("no attribute \"%s\"", name);
    return NULL;
}

#endif
