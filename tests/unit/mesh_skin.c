/* tests/unit/mesh_skin.c - glTF skins: vertices stand where the skeleton puts them, and keep what
 * they follow; VRM's humanoid maps name the joints; nonsense in either is refused or told. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include "mesh/topology.h"

#include <math.h>

typedef struct skin_buffer { /* 444 bytes without gaps */
    float position[12];      /* at 0: the unit square */
    uint16_t index[6];       /* at 48 */
    uint8_t joint[16];       /* at 60 */
    float weight[16];        /* at 76 */
    uint8_t joint_more[16];  /* at 140: a second set */
    float weight_more[16];   /* at 156 */
    float offset[12];        /* at 220 */
    float normal[12];        /* at 268 */
    float bind[2][16];       /* at 316: inverse, column-major */
} skin_buffer;

/* The square hangs on "neck" at (0 1 0) and "head" at (0 2 0): bound there. */
static skin_buffer good_buffer(void)
{
    skin_buffer b = {.position = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0},
                     .index = {0, 1, 2, 0, 2, 3},
                     .joint = {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0},
                     .weight = {1, 0, 0, 0, 1, 3, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0},
                     .offset = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1},
                     .normal = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}};
    for (int joint = 0; joint < 2; ++joint) {
        b.bind[joint][0] = b.bind[joint][5] = b.bind[joint][10] = b.bind[joint][15] = 1.0f;
        b.bind[joint][13] = joint == 0 ? -1.0f : -2.0f;
    }
    return b;
}

#define SKIN_DATA                                                                                  \
    "'asset':{'version':'2.0'},'buffers':[{'byteLength':444}],"                                    \
    "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12},"    \
    "{'buffer':0,'byteOffset':60,'byteLength':16},{'buffer':0,'byteOffset':76,'byteLength':64},"   \
    "{'buffer':0,'byteOffset':140,'byteLength':16},{'buffer':0,'byteOffset':156,'byteLength':64}," \
    "{'buffer':0,'byteOffset':220,'byteLength':48},{'buffer':0,'byteOffset':268,'byteLength':48}," \
    "{'buffer':0,'byteOffset':316,'byteLength':128}],"                                             \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"                  \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                             \
    "{'bufferView':2,'componentType':5121,'count':4,'type':'VEC4'},"                               \
    "{'bufferView':3,'componentType':5126,'count':4,'type':'VEC4'},"                               \
    "{'bufferView':4,'componentType':5121,'count':4,'type':'VEC4'},"                               \
    "{'bufferView':5,'componentType':5126,'count':4,'type':'VEC4'},"                               \
    "{'bufferView':6,'componentType':5126,'count':4,'type':'VEC3'},"                               \
    "{'bufferView':7,'componentType':5126,'count':4,'type':'VEC3'},"                               \
    "{'bufferView':8,'componentType':5126,'count':2,'type':'MAT4'}],"
#define SKIN_MESH                                                                                  \
    "'meshes':[{'name':'face','primitives':[{'attributes':{'POSITION':0,'NORMAL':7,'JOINTS_0':2,"  \
    "'WEIGHTS_0':3},'indices':1,'targets':[{'POSITION':6}]}]},"                                    \
    "{'name':'hat','primitives':[{'attributes':{'POSITION':0,'NORMAL':7},'indices':1}]}],"         \
    "'skins':[{'joints':[1,2],'inverseBindMatrices':8}],"
/* Moved by its own node, which a skin's vertices must not follow. `head`: members of that node. */
#define SKIN_NODES(head)                                                                           \
    "'nodes':[{'children':[1]},{'name':'neck','translation':[0,1,0],'children':[2]},"              \
    "{'name':'head','translation':[0,1,0]" head ",'children':[4]},"                                \
    "{'mesh':0,'skin':0,'name':'skin','translation':[50,0,0]},"                                    \
    "{'mesh':1,'name':'hat','translation':[0,0,3]}],'scenes':[{'nodes':[0,3]}]"

static mrt_result parse(mesh *out, const skin_buffer *buffer, const char *json, error *err)
{
    document d = document_glb_of(json, buffer, sizeof *buffer);
    return gltf_parse(out, d.bytes, d.size, NULL, err);
}

static mesh read_good(const skin_buffer *buffer, const char *json)
{
    mesh m;
    error err = {""};
    if (parse(&m, buffer, json, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

static void assert_point(const float *value, double x, double y, double z)
{
    double off =
        fabs((double)value[0] - x) + fabs((double)value[1] - y) + fabs((double)value[2] - z);
    if (!(off < 1e-6))
        fail_msg("(%g %g %g) instead of (%g %g %g)", (double)value[0], (double)value[1],
                 (double)value[2], x, y, z);
}

static void a_skin_in_its_bind_pose_leaves_the_bits_of_the_file(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    mesh m = read_good(&b, SKIN_DATA SKIN_MESH SKIN_NODES(""));
    assert_int_equal(m.vertex_count, 8);
    /* The hat is a node below the head, the skin a root: in the order of the nodes. */
    assert_string_equal(m.part[0].name, "hat");
    assert_string_equal(m.part[1].name, "skin");
    assert_memory_equal(m.position + 12, b.position, sizeof b.position);
    assert_memory_equal(m.target[0].offset + 12, b.offset, sizeof b.offset);
    assert_point(m.position, 0, 2, 3);
    mesh_destroy(&m);
}

static void joints_keep_name_parent_and_place(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    mesh m = read_good(&b, SKIN_DATA SKIN_MESH SKIN_NODES(""));
    assert_int_equal(m.joint_count, 2);
    assert_string_equal(m.joint[0].name, "neck");
    assert_string_equal(m.joint[1].name, "head");
    assert_string_equal(m.joint[1].role, "");
    assert_int_equal(m.joint[0].parent, MESH_NO_JOINT);
    assert_int_equal(m.joint[1].parent, 0);
    assert_true(m.joint[1].rest[7] == 2.0f && m.joint[1].rest[0] == 1.0f);
    mesh_destroy(&m);
}

static void vertices_keep_what_they_follow(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    mesh m = read_good(&b, SKIN_DATA SKIN_MESH SKIN_NODES(""));
    const uint32_t *joint = m.skin_joint;
    const float *weight = m.skin_weight;
    assert_true(joint[0] == 1 && weight[0] == 1.0f && weight[1] == 0.0f); /* the hat, on the head */
    assert_true(joint[16] == 0 && weight[16] == 1.0f);
    /* 1 and 3: normalised, the larger first */
    assert_true(joint[20] == 1 && weight[20] == 0.75f && joint[21] == 0 && weight[21] == 0.25f);
    assert_true(weight[28] == 0.0f); /* the last follows none, and it is told */
    assert_non_null(strstr(m.note, "1 vertices of a skin follow none of its joints"));
    mesh_destroy(&m);
}

/* The head nods by a quarter turn about x: up becomes +z. */
#define NODDING ",'rotation':[0.70710678118,0,0,0.70710678118]"

static void a_skin_in_another_pose_is_put_into_it(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    mesh m = read_good(&b, SKIN_DATA SKIN_MESH SKIN_NODES(NODDING));
    const float *skin = m.position + 12;
    assert_point(skin, 0, 0, 0);               /* on the neck alone */
    assert_point(skin + 6, 1, 2, -1);          /* on the head alone: (1 1 0) about (0 2 0) */
    assert_point(skin + 3, 1, 1.5, -1.5);      /* 3/4 of (1 2 -2), 1/4 of (1 0 0) */
    assert_point(skin + 9, 0, 1, 0);           /* on nothing: as the first joint */
    assert_point(m.normal + 12 + 6, 0, -1, 0); /* +z nods down */
    assert_point(m.target[0].offset + 18, 0, -1, 0);
    mesh_destroy(&m);
}

static void more_than_four_influences_keep_the_largest(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    static const uint8_t first[4] = {0, 0, 0, 0}, second[4] = {1, 1, 0, 0};
    static const float light[4] = {0.1f, 0.1f, 0.1f, 0.1f}, heavy[4] = {0.5f, 0.2f, 0, 0};
    memcpy(b.joint, first, sizeof first);
    memcpy(b.weight, light, sizeof light);
    memcpy(b.joint_more, second, sizeof second);
    memcpy(b.weight_more, heavy, sizeof heavy);
    mesh m = read_good(&b, SKIN_DATA
                       "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':2,"
                       "'WEIGHTS_0':3,'JOINTS_1':4,'WEIGHTS_1':5},'indices':1}]},{}],"
                       "'skins':[{'joints':[1,2],'inverseBindMatrices':8}]," SKIN_NODES(""));
    const float expected[4] = {0.5f / 0.9f, 0.2f / 0.9f, 0.1f / 0.9f, 0.1f / 0.9f};
    for (int i = 0; i < 4; ++i)
        assert_true(fabsf(m.skin_weight[i] - expected[i]) < 1e-6f);
    assert_true(m.skin_joint[0] == 1 && m.skin_joint[1] == 1 && m.skin_joint[2] == 0);
    mesh_destroy(&m);
}

static void humanoid_maps_of_both_vrm_name_the_joints(void **state)
{
    (void)state;
    static const char *const maps[] = {
        ",'extensions':{'VRM':{'humanoid':{'humanBones':[{'bone':'neck','node':1},"
        "{'bone':'head','node':2},{'bone':'jaw','node':77},{'bone':3,'node':0},7]}}}",
        ",'extensions':{'VRMC_vrm':{'humanoid':{'humanBones':{'neck':{'node':1},"
        "'head':{'node':2},'jaw':{'node':-1},'leftEye':3}}}}"};
    static const mesh_axis forward[] = {MESH_AXIS_MINUS_Z, MESH_AXIS_Z};
    skin_buffer b = good_buffer();
    for (int i = 0; i < 2; ++i) {
        char json[6000];
        (void)snprintf(json, sizeof json, "%s%s", SKIN_DATA SKIN_MESH SKIN_NODES(""), maps[i]);
        mesh m = read_good(&b, json);
        assert_int_equal(m.joint_count, 2);
        assert_string_equal(m.joint[0].role, "neck");
        assert_string_equal(m.joint[1].role, "head");
        assert_int_equal(m.forward, forward[i]);
        mesh_destroy(&m);
    }
}

/* A joint that has a role keeps it. */
static void chains_that_vrm_swings_are_named(void **state)
{
    (void)state;
    static const char *const chains[] = {
        ",'extensions':{'VRM':{'humanoid':{'humanBones':[{'bone':'neck','node':1}]},"
        "'secondaryAnimation':{'boneGroups':[{'stiffiness':1,'bones':[1,2,77,'x']},7]}}}",
        ",'extensions':{'VRMC_vrm':{'humanoid':{'humanBones':{'neck':{'node':1}}}},"
        "'VRMC_springBone':{'springs':[{'joints':[{'node':2},{'node':1}]},{'joints':7},3]}}"};
    skin_buffer b = good_buffer();
    for (int i = 0; i < 2; ++i) {
        char json[6000];
        (void)snprintf(json, sizeof json, "%s%s", SKIN_DATA SKIN_MESH SKIN_NODES(""), chains[i]);
        mesh m = read_good(&b, json);
        assert_string_equal(m.joint[0].role, "neck");
        assert_string_equal(m.joint[1].role, "spring");
        mesh_destroy(&m);
    }
}

static void extensions_of_any_kind_are_no_harm(void **state)
{
    (void)state;
    static const char *const nonsense[] = {"{'VRM':7}",
                                           "{'VRM':{'humanoid':[1,2]}}",
                                           "{'VRM':{'humanoid':{'humanBones':{'head':1}}}}",
                                           "{'VRMC_vrm':{'humanoid':{'humanBones':[]}}}",
                                           "{'VRMC_vrm':'head'}",
                                           "{'VRM':{'secondaryAnimation':{'boneGroups':3}}}",
                                           "{'VRMC_springBone':{'springs':{'joints':1}}}",
                                           "{'VRMC_vrm':{'humanoid':{'humanBones':{'head':"
                                           "{'node':99999999999999}}}}}"};
    skin_buffer b = good_buffer();
    for (size_t i = 0; i < sizeof nonsense / sizeof *nonsense; ++i) {
        char json[6000];
        (void)snprintf(json, sizeof json, "%s,'extensions':%s", SKIN_DATA SKIN_MESH SKIN_NODES(""),
                       nonsense[i]);
        mesh m = read_good(&b, json);
        assert_int_equal(m.joint_count, 2);
        mesh_destroy(&m);
    }
}

static void nonsense_in_a_skin_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *json, *expected;
    } cases[] = {{SKIN_DATA SKIN_MESH "'nodes':[{'mesh':0,'skin':4}]", "skin 4"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                            "'skins':[{'joints':[]}],'nodes':[{'mesh':0,'skin':0}]",
                  "no joints"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                            "'skins':[{'joints':[9]}],'nodes':[{'mesh':0,'skin':0}]",
                  "names node 9"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                            "'skins':[{'joints':[-1]}],'nodes':[{'mesh':0,'skin':0}]",
                  "whole numbers"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                            "'skins':[{'joints':[0,0,0],'inverseBindMatrices':8}],"
                            "'nodes':[{'mesh':0,'skin':0}]",
                  "inverse bind matrices"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                            "'skins':[{'joints':[0],'inverseBindMatrices':0}],"
                            "'nodes':[{'mesh':0,'skin':0}]",
                  "inverse bind matrices"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':2,"
                            "'WEIGHTS_0':3},'indices':1}]}],'skins':[{'joints':[0]}],"
                            "'nodes':[{'mesh':0,'skin':0}]",
                  "follows joint 1"},
                 {SKIN_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':0,"
                            "'WEIGHTS_0':3},'indices':1}]}],'skins':[{'joints':[0]}],"
                            "'nodes':[{'mesh':0,'skin':0}]",
                  "JOINTS_0 and WEIGHTS_0 must be VEC4"},
                 {SKIN_DATA SKIN_MESH
                  "'nodes':[{'mesh':0,'skin':0,'children':[1]},{'children':[2]},"
                  "{'children':[1]}]",
                  "two parents"}};
    skin_buffer b = good_buffer();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m;
        error err = {""};
        if (parse(&m, &b, cases[i].json, &err) >= 0 || !strstr(err.text, cases[i].expected))
            fail_msg("case %zu: \"%s\"", i, err.text);
    }
    b.bind[1][3] = NAN;
    mesh m;
    error err = {""};
    assert_true(parse(&m, &b, SKIN_DATA SKIN_MESH SKIN_NODES(""), &err) < 0);
}

static void a_copy_has_the_skeleton_too(void **state)
{
    (void)state;
    skin_buffer b = good_buffer();
    mesh m = read_good(&b, SKIN_DATA SKIN_MESH SKIN_NODES("")), copy;
    error err = {""};
    assert_int_equal(mesh_copy(&copy, &m, &err), MRT_OK);
    mesh_destroy(&m);
    assert_int_equal(mesh_validate(&copy, &err), MRT_OK);
    assert_string_equal(copy.joint[1].name, "head");
    assert_true(copy.skin_weight[20] == 0.75f);
    mesh_destroy(&copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_skin_in_its_bind_pose_leaves_the_bits_of_the_file),
        cmocka_unit_test(joints_keep_name_parent_and_place),
        cmocka_unit_test(vertices_keep_what_they_follow),
        cmocka_unit_test(a_skin_in_another_pose_is_put_into_it),
        cmocka_unit_test(more_than_four_influences_keep_the_largest),
        cmocka_unit_test(humanoid_maps_of_both_vrm_name_the_joints),
        cmocka_unit_test(chains_that_vrm_swings_are_named),
        cmocka_unit_test(extensions_of_any_kind_are_no_harm),
        cmocka_unit_test(nonsense_in_a_skin_is_refused),
        cmocka_unit_test(a_copy_has_the_skeleton_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
