/* tests/unit/mesh_expression.c - VRM's expressions, of both its versions: in the words of the
 * second, by the shapes that they are made of. Nonsense in them is told, and never costs the head.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include "mesh/topology.h"

#include <math.h>

/* Two meshes, one of which the scene does not show; both faces share the target "smile". */
#define FACE_PRIMITIVE "{'attributes':{'POSITION':0},'indices':1,'targets':[{'POSITION':2}"
#define FACES                                                                                      \
    DOCUMENT_DATA                                                                                  \
    "'meshes':[{'primitives':[" FACE_PRIMITIVE ",{'POSITION':2}]}],"                               \
    "'extras':{'targetNames':['smile','Fcl_MTH_A']}},"                                             \
    "{'primitives':[" FACE_PRIMITIVE "]}],'extras':{'targetNames':['smile']}},"                    \
    "{'primitives':[" FACE_PRIMITIVE "]}]}],"                                                      \
    "'nodes':[{'mesh':0},{'mesh':1},{'mesh':2}],'scenes':[{'nodes':[0,1]}],'scene':0"

static mesh read_with(const char *extension)
{
    static char json[7000];
    mesh m;
    error err = {""};
    (void)snprintf(json, sizeof json, "%s,'extensions':%s", FACES, extension);
    document d = document_glb(json);
    if (gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0)
        fail_msg("%s: %s", extension, err.text);
    assert_int_equal(m.target_count, 2);
    return m;
}

static void assert_row(const mesh *m, const char *name, const char *target, double weight)
{
    for (uint32_t i = 0; i < m->expression_count; ++i) {
        const mesh_expression *row = &m->expression[i];
        if (strcmp(row->name, name) == 0 && strcmp(m->target[row->target].name, target) == 0) {
            assert_true(fabs((double)row->weight - weight) < 1e-6);
            return;
        }
    }
    fail_msg("%s has no part in \"%s\"", target, name);
}

static void both_versions_say_the_same(void **state)
{
    static const char *const said[] = {
        "{'VRM':{'blendShapeMaster':{'blendShapeGroups':["
        "{'name':'Joy','presetName':'joy','binds':[{'mesh':0,'index':0,'weight':50},"
        "{'mesh':1,'index':0,'weight':25},{'mesh':0,'index':1,'weight':100}]},"
        "{'name':'A','presetName':'a','binds':[{'mesh':0,'index':1,'weight':100}]},"
        "{'name':'Surprised','presetName':'unknown','binds':[{'mesh':0,'index':0,'weight':100}]},"
        "{'name':'JawOpen','presetName':'unknown','binds':[{'mesh':0,'index':1,'weight':80}]},"
        "{'name':'Neutral','presetName':'neutral','binds':[]}]}}}",
        "{'VRMC_vrm':{'expressions':{'preset':{"
        "'happy':{'morphTargetBinds':[{'node':0,'index':0,'weight':0.5},"
        "{'node':1,'index':0,'weight':0.25},{'node':0,'index':1,'weight':1}]},"
        "'aa':{'morphTargetBinds':[{'node':0,'index':1,'weight':1}]},"
        "'surprised':{'morphTargetBinds':[{'node':0,'index':0,'weight':1}]}},"
        "'custom':{'JawOpen':{'morphTargetBinds':[{'node':0,'index':1,'weight':0.8}]}}}}}"};
    (void)state;
    for (int i = 0; i < 2; ++i) {
        error err = {""};
        mesh m = read_with(said[i]), copy;
        assert_int_equal(m.expression_count, 5);
        assert_row(&m, "happy", "smile", 0.5); /* of two meshes: the larger */
        assert_row(&m, "happy", "Fcl_MTH_A", 1.0);
        assert_row(&m, "aa", "Fcl_MTH_A", 1.0);
        assert_row(&m, "surprised", "smile", 1.0);
        assert_row(&m, "JawOpen", "Fcl_MTH_A", 0.8);
        assert_null(m.note ? strstr(m.note, "expressions") : NULL);
        assert_int_equal(mesh_copy(&copy, &m, &err), MRT_OK);
        mesh_destroy(&m);
        assert_row(&copy, "happy", "smile", 0.5);
        mesh_destroy(&copy);
    }
}

static void nonsense_is_no_harm(void **state)
{
    static const struct {
        const char *extension;
        bool is_told;
    } cases[] = {
        {"{'VRM':{'blendShapeMaster':7}}", false},
        {"{'VRM':{'blendShapeMaster':{'blendShapeGroups':[7,{'binds':{}},{'binds':[3]}]}}}", true},
        {"{'VRM':{'blendShapeMaster':{'blendShapeGroups':[{'name':'x','binds':[{'mesh':2,'index':"
         "0,'weight':100},{'mesh':-1,'index':0},{'mesh':0,'index':99999999999}]}]}}}",
         true},
        {"{'VRM':{'blendShapeMaster':{'blendShapeGroups':[{'name':'x','binds':[{'mesh':0,'index':"
         "0,'weight':'much'},{'mesh':0,'index':0,'weight':-3}]}]}}}",
         false},
        {"{'VRM':{'blendShapeMaster':{'blendShapeGroups':[{'binds':[{'mesh':0,'index':0,'weight':"
         "100}]}]}}}",
         false},
        {"{'VRMC_vrm':{'expressions':[]}}", false},
        {"{'VRMC_vrm':{'expressions':{'preset':{'happy':3},'custom':{'x':{'morphTargetBinds':[{"
         "'node':77,'index':0,'weight':1}]}}}}}",
         true}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m = read_with(cases[i].extension);
        assert_int_equal(m.expression_count, 0);
        assert_int_equal(m.note && strstr(m.note, "expressions name do not exist"),
                         cases[i].is_told);
        mesh_destroy(&m);
    }
}

static void a_weight_is_at_most_1(void **state)
{
    (void)state;
    mesh m = read_with("{'VRM':{'blendShapeMaster':{'blendShapeGroups':[{'name':'x','presetName':"
                       "'BLINK_L','binds':[{'mesh':0,'index':0,'weight':1e300}]}]}}}");
    assert_row(&m, "blinkLeft", "smile", 1.0);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_versions_say_the_same),
        cmocka_unit_test(nonsense_is_no_harm),
        cmocka_unit_test(a_weight_is_at_most_1),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
