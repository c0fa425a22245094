#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include <stdlib.h>

static const char GOOD[] = DOCUMENT_DATA DOCUMENT_HEAD;

static void assert_refused(const void *data, size_t size, const char *reason)
{
    mesh m;
    error err = {""};
    if (gltf_parse(&m, data, size, NULL, &err) >= 0)
        fail_msg("accepted, though \"%s\" was expected", reason);
    assert_null(m.position);
    if (!strstr(err.text, reason) || strchr(err.text, '\n') || !err.text[0])
        fail_msg("\"%s\" does not say \"%s\"", err.text, reason);
}

static void a_good_file_cut_anywhere_is_refused(void **state)
{
    (void)state;
    document d = document_glb(GOOD);
    for (size_t part = 0; part < 64; ++part)
        assert_refused(d.bytes, d.size * part / 64, "");
    assert_refused(d.bytes, d.size - 1, "");
    /* Also when the header is made to agree with the cut. */
    for (size_t part = 1; part < 64; ++part) {
        document cut = {.size = 8};
        size_t size = d.size * part / 64;
        memcpy(cut.bytes, d.bytes, d.size);
        document_put_u32(&cut, size);
        assert_refused(cut.bytes, size, "");
    }
}

/* One change each to the good document. */
static void every_lie_is_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *reason;
    } lies[] = {
        {"'version':'2.0'", "'version':'1.0'", "glTF version 1.0"},
        {"'asset':{'version':'2.0'},", "", "asset.version is missing"},
        {"'asset':{", "'asset':7,'x':{", "asset must be an object"},
        {"'byteLength':156", "'byteLength':157", "buffers[0] has 157 bytes, the BIN chunk 156"},
        {"'byteLength':156", "'byteLength':0", "buffers[0].byteLength"},
        {"'byteLength':156", "'byteLength':-1", "must be a whole number"},
        {"'byteLength':156", "'byteLength':99999999999", "must be a whole number"},
        {"{'byteLength':156}", "{'byteLength':156},{'byteLength':156}", "buffers[1] has no uri"},
        {"{'byteLength':156}", "{'byteLength':156,'uri':'x.bin'}", "buffer \"x.bin\""},
        {"{'byteLength':156}", "{'byteLength':3,'uri':'data:text/html;base64,AAAA'}",
         "only data URIs"},
        {"{'byteLength':156}", "{'byteLength':4,'uri':'data:application/octet-stream;base64,AAAA'}",
         "Failed to decode"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':1,'byteLength':48}",
         "the buffer of its bufferView does not exist"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':-1,'byteLength':48}", "bufferViews[0].buffer"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':157}",
         "bufferView goes past the end of the buffer"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteOffset':2147483647,'byteLength':48}",
         "bufferView goes past the end of the buffer"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':47}",
         "accessor 0: it goes past the end of its bufferView"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':48,'byteStride':8}",
         "accessor 0: the byteStride is less than an element"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':48,'byteStride':16}",
         "accessor 0: it goes past the end"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteLength':48,'byteStride':13}",
         "byteStride"},
        {"{'buffer':0,'byteLength':48}", "{'buffer':0,'byteOffset':2,'byteLength':48}",
         "accessor 0: it is not aligned"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':9,'componentType':5126,"
         "'count':4",
         "accessor 0: its bufferView does not exist"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':-7,'componentType':5126,'count':4", "accessors[0].bufferView must be"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'byteOffset':-4,'componentType':5126,'count':4",
         "accessors[0].byteOffset must be"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':5", "accessor 0: it goes past the end"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':2147483647", "accessor 0: its count"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':4000000000", "accessors[0].count must be"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':0", "accessor 0: its count"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':3.5", "accessors[0].count must be"},
        {"{'bufferView':0,'componentType':5126,'count':4",
         "{'bufferView':0,'componentType':5126,'count':3", "accessor 3: 4 of _MARK for 3"},
        {"{'bufferView':0,'componentType':5126", "{'bufferView':0,'componentType':5130",
         "component type"},
        {"{'bufferView':0,'componentType':5126", "{'bufferView':0,'componentType':5122",
         "accessor 0: POSITION must be FLOAT"},
        {"'count':4,'type':'VEC3'},", "'count':4,'type':'VEC2'},", "accessor 0: POSITION must be"},
        {"'count':4,'type':'VEC3'},", "'count':4,'type':'VEC9'},", "VEC9"},
        {"'componentType':5123,'count':6", "'componentType':5126,'count':3",
         "accessor 1: indices must be unsigned scalars"},
        {"'componentType':5123,'count':6", "'componentType':5123,'count':5", "triangles need 3"},
        {"'byteOffset':48,'byteLength':12", "'byteOffset':136,'byteLength':12",
         "accessor 1: index 16256"},
        {"'sparse':{'count':2", "'sparse':{'count':5", "accessor 2: sparse.count"},
        {"'sparse':{'count':2", "'sparse':{'count':0", "accessor 2: sparse.count"},
        {"'sparse':{'count':2", "'sparse':{'count':-2", "sparse.count must be"},
        {"'sparse':{'count':2", "'sparse':{'count':3", "past the end of its bufferView"},
        {"'indices':{'bufferView':2,'componentType':5123}",
         "'indices':{'bufferView':2,'componentType':5122}", "sparse.indices must be unsigned"},
        {"'indices':{'bufferView':2,'componentType':5123}",
         "'indices':{'bufferView':99,'componentType':5123}", "accessor 2: its bufferView"},
        {"'indices':{'bufferView':2,'componentType':5123}",
         "'indices':{'bufferView':2,'byteOffset':3,'componentType':5121}",
         "accessor 2: it goes past"},
        {"'byteOffset':60,'byteLength':4", "'byteOffset':52,'byteLength':4",
         "accessor 2: the sparse indices do not increase"},
        {"'byteOffset':60,'byteLength':4", "'byteOffset':112,'byteLength':4",
         "accessor 2: a sparse index is not below count"},
        {"'values':{'bufferView':3}", "'values':{'bufferView':2}", "past the end"},
        {"'values':{'bufferView':3}", "'x':0", "values"},
        {"'normalized':true", "'normalized':1", "normalized must be true or false"},
        {"'POSITION':0", "'POSITION':99", "accessor 99 is used, but the file has 5"},
        {"'POSITION':0", "'POSITION':4294967296", "POSITION must be a whole number"},
        {"'POSITION':0", "'POSITION':-1", "POSITION must be a whole number"},
        {"'POSITION':0,", "", "a primitive has no POSITION"},
        {"'NORMAL':4", "'NORMAL':3", "NORMAL must be VEC3"},
        {"'_MARK':3", "'_MARK':1", "accessor 1: 6 of _MARK for 4 vertices"},
        {"'_MARK':3", "'_MARK':77", "accessor 77"},
        {"'targets':[{'POSITION':2}]", "'targets':[{'POSITION':5}]", "accessor 5"},
        {"'targets':[{'POSITION':2}]", "'targets':[{'POSITION':3}]", "must be VEC3"},
        {"'targets':[{'POSITION':2}]", "'targets':[7]", "targets must be an object"},
        {"'indices':1", "'indices':9", "out of bounds"},
        {"'material':0", "'material':1", "material 1, but the file has 1"},
        {"'indices':1", "'indices':1,'mode':7", "primitive mode 7"},
        {"'indices':1", "'indices':1,'mode':1", "no triangles"},
        {"'baseColorFactor':[1,0.5,0.25,1]", "'baseColorFactor':[1,0.5]", "must have 4 numbers"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':1}]", "a node names mesh 1"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'children':[0]}]",
         "node 0 is below itself"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'children':[9]}]",
         "a node names node 9"},
        {"'nodes':[{'mesh':0,'name':'head'}]",
         "'nodes':[{'children':[1,2]},{'children':[2]},{'mesh':0}]", "node 2 has two parents"},
        {"'nodes':[{'mesh':0,'name':'head'}]",
         "'nodes':[{},{'children':[2],'mesh':0},{'children':[1]}]", "shows no triangles"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'scale':[1,1]}]",
         "scale must have 3 numbers"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'rotation':[0,0,0,0]}]",
         "node 0: its rotation"},
        {"'nodes':[{'mesh':0,'name':'head'}]",
         "'nodes':[{'mesh':0,'matrix':[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}]",
         "node 0: its matrix is not an affine transform"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'scale':[1e300,1,1]}]",
         "vertex 1 is not finite"},
        {"'nodes':[{'mesh':0,'name':'head'}]", "'nodes':[{'mesh':0,'translation':[1e999,1,1]}]",
         "the JSON is broken"},
        {"'nodes':[{'mesh':0,'name':'head'}],'scenes':[{'nodes':[0]}]",
         "'nodes':[{'mesh':0},{'children':[2],'mesh':0},{'children':[1]}],"
         "'scenes':[{'nodes':[0,2]}]",
         "node 2 is below itself"},
        {"'scenes':[{'nodes':[0]}]", "'scenes':[{'nodes':[4]}]", "the scene names node 4"},
        {"'scene':0", "'scene':3", "scene 3 does not exist"},
        {"'scene':0", "'scene':0,'extensionsRequired':['EXT_feature_metadata']",
         "the extension \"EXT_feature_metadata\""},
        {"'scene':0", "'scene':0,", "the JSON is broken"}};
    for (size_t i = 0; i < sizeof lies / sizeof *lies; ++i) {
        char json[6000];
        const char *at = strstr(GOOD, lies[i].from);
        if (!at)
            fail_msg("the document has no %s", lies[i].from);
        (void)snprintf(json, sizeof json, "%.*s%s%s", (int)(at - GOOD), GOOD, lies[i].to,
                       at + strlen(lies[i].from));
        document d = document_glb(json);
        assert_refused(d.bytes, d.size, lies[i].reason);
    }
}

static void numbers_that_are_not_finite_are_refused(void **state)
{
    (void)state;
    static const size_t offsets[] = {8, 72, 112}; /* a position, a sparse value, a normal */
    static const unsigned char nan_bytes[] = {0, 0, 0xc0, 0x7f}, infinity[] = {0, 0, 0x80, 0xff};
    for (size_t i = 0; i < sizeof offsets / sizeof *offsets; ++i) {
        document_buffer buffer = DOCUMENT_BUFFER;
        memcpy((unsigned char *)&buffer + offsets[i], i % 2 ? infinity : nan_bytes, 4);
        document d = document_glb_of(GOOD, &buffer, sizeof buffer);
        assert_refused(d.bytes, d.size, "a number in it is not finite");
    }
}

static void broken_containers_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t at;
        unsigned char value;
        const char *reason;
    } changes[] = {{4, 1, "glTF version 1"},
                   {4, 3, "glTF version 3"},
                   {9, 0xff, "the header says"},
                   {13, 0xff, "chunk 0 goes past the end"},
                   {16, 'X', "the first chunk, and no other"}};
    for (size_t i = 0; i < sizeof changes / sizeof *changes; ++i) {
        document d = document_glb(GOOD);
        d.bytes[changes[i].at] = changes[i].value;
        assert_refused(d.bytes, d.size, changes[i].reason);
    }
    document whole = document_glb(GOOD);
    assert_refused(whole.bytes, whole.size / 2, "it is cut off");
    assert_refused("", 0, "the JSON is broken");
    assert_refused("[]", 2, "not an object");
    assert_refused("{\"asset\":{\"version\":\"2.0\"}}", 27, "no triangles");
    assert_refused("{\"asset\":{\"version\":\"2.0\"},\"x\":\"\xff\"}", 36, "the JSON is broken");
}

static void deep_nesting_and_endless_lists_are_refused_before_parsing(void **state)
{
    (void)state;
    enum { SIZE = 1 << 20 };
    char *text = malloc(SIZE);
    assert_non_null(text);
    memset(text, '[', SIZE);
    assert_refused(text, SIZE, "nested more than 64 deep");
    for (size_t i = 0; i < SIZE; ++i)
        text[i] = i % 2 ? ',' : '0';
    text[0] = '[';
    assert_refused(text, SIZE, "more than 500000 values");
    free(text);
}

/* 2000 targets of 16 million zeros each would be 400 GB. */
static void documents_that_unfold_without_end_are_refused(void **state)
{
    (void)state;
    enum { TARGETS = 2000 };
    char *json = malloc(200000);
    assert_non_null(json);
    size_t used = (size_t)sprintf(
        json, "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[{\"componentType\":5126,"
              "\"count\":16777215,\"type\":\"VEC3\"}],\"meshes\":[{\"primitives\":["
              "{\"attributes\":{\"POSITION\":0},\"targets\":[");
    for (int i = 0; i < TARGETS; ++i)
        used += (size_t)sprintf(json + used, "%s{\"POSITION\":0}", i ? "," : "");
    used += (size_t)sprintf(json + used, "]}]}],\"nodes\":[{\"mesh\":0}]}");
    assert_refused(json, used, "bytes of memory, the limit for a mesh of");
    free(json);
}

/* A scene that lists a node with many children again and again. */
static void repeated_nodes_are_read_in_bounded_time(void **state)
{
    (void)state;
    enum { CHILDREN = 100000, TIMES = 150000 };
    char *json = malloc(4 << 20);
    assert_non_null(json);
    size_t used =
        (size_t)sprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[1");
    for (int i = 2; i <= CHILDREN; ++i)
        used += (size_t)sprintf(json + used, ",%d", i);
    used += (size_t)sprintf(json + used, "]}");
    for (int i = 1; i <= CHILDREN; ++i)
        used += (size_t)sprintf(json + used, ",{}");
    used += (size_t)sprintf(json + used, "],\"scenes\":[{\"nodes\":[0");
    for (int i = 1; i < TIMES; ++i)
        used += (size_t)sprintf(json + used, ",0");
    used += (size_t)sprintf(json + used, "]}]}");
    assert_refused(json, used, "no triangles");
    free(json);
}

/* Each instance reads its skin: 3000 of 4000 joints; or one of a matrix for each of 16 million. */
static void skins_that_unfold_without_end_are_refused(void **state)
{
    (void)state;
    enum { JOINTS = 4000, INSTANCES = 3000 };
    char *json = malloc(200000);
    assert_non_null(json);
    size_t used = (size_t)sprintf(json, "{'asset':{'version':'2.0'},'accessors':[{'componentType':"
                                        "5126,'count':3,'type':'VEC3'}],'meshes':[{'primitives':[{"
                                        "'attributes':{'POSITION':0}}]}],'skins':[{'joints':[0");
    for (int i = 1; i < JOINTS; ++i)
        used += (size_t)sprintf(json + used, ",%d", i);
    used += (size_t)sprintf(json + used, "]}],'nodes':[{}");
    for (int i = 1; i < JOINTS; ++i)
        used += (size_t)sprintf(json + used, ",{}");
    for (int i = 0; i < INSTANCES; ++i)
        used += (size_t)sprintf(json + used, ",{'mesh':0,'skin':0}");
    used += (size_t)sprintf(json + used, "]}");
    for (size_t i = 0; i < used; ++i)
        json[i] = json[i] == '\'' ? '"' : json[i];
    assert_refused(json, used, "steps of work, the limit for a mesh of");
    free(json);

    const document d = document_glb(
        "'asset':{'version':'2.0'},'accessors':[{'componentType':5126,'count':3,'type':'VEC3'},"
        "{'componentType':5126,'count':16777215,'type':'MAT4'}],'meshes':[{'primitives':[{"
        "'attributes':{'POSITION':0}}]}],'skins':[{'joints':[0],'inverseBindMatrices':1}],"
        "'nodes':[{},{'mesh':0,'skin':0}]");
    assert_refused(d.bytes, d.size, "steps of work, the limit for a mesh of");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_good_file_cut_anywhere_is_refused),
        cmocka_unit_test(every_lie_is_refused_by_name),
        cmocka_unit_test(numbers_that_are_not_finite_are_refused),
        cmocka_unit_test(broken_containers_are_refused),
        cmocka_unit_test(deep_nesting_and_endless_lists_are_refused_before_parsing),
        cmocka_unit_test(documents_that_unfold_without_end_are_refused),
        cmocka_unit_test(repeated_nodes_are_read_in_bounded_time),
        cmocka_unit_test(skins_that_unfold_without_end_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
