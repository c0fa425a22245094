#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define FACE_MESH                                                                                  \
    "'meshes':[{'name':'face','primitives':[{'attributes':{'POSITION':0},'indices':1}]}]"

static mesh read_document(const document *d, const char *directory)
{
    mesh m;
    error err = {""};
    if (gltf_parse(&m, d->bytes, d->size, directory, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

static mesh read_good(const char *rest)
{
    char json[6000];
    (void)snprintf(json, sizeof json, "%s%s", DOCUMENT_DATA, rest);
    document d = document_glb(json);
    return read_document(&d, NULL);
}

static void assert_vertex(const float *value, double x, double y, double z)
{
    double off =
        fabs((double)value[0] - x) + fabs((double)value[1] - y) + fabs((double)value[2] - z);
    if (!(off < 1e-6))
        fail_msg("(%g %g %g) instead of (%g %g %g)", (double)value[0], (double)value[1],
                 (double)value[2], x, y, z);
}

static void assert_is_head(const mesh *m)
{
    assert_int_equal(m->vertex_count, 4);
    assert_memory_equal(m->position, DOCUMENT_BUFFER.position, sizeof DOCUMENT_BUFFER.position);
    static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(m->triangle_count, 2);
    assert_memory_equal(m->triangle, triangles, sizeof triangles);
    assert_non_null(m->normal);
    assert_memory_equal(m->normal, DOCUMENT_BUFFER.normal, sizeof DOCUMENT_BUFFER.normal);
    assert_int_equal(m->part_count, 1);
    assert_string_equal(m->part[0].name, "head");
    assert_int_equal(m->part[0].vertex_count, 4);
    assert_int_equal(m->material_count, 1);
    assert_string_equal(m->material[0].name, "skin");
    assert_true(m->material[0].base_colour[1] == 0.5f && m->material[0].roughness == 0.5f &&
                m->material[0].metallic == 0.0f);
    assert_int_equal(m->target_count, 1);
    assert_string_equal(m->target[0].name, "smile");
    assert_vertex(m->target[0].offset, 0, 0, 0);
    assert_vertex(m->target[0].offset + 3, 0, 0, 0.5);
    assert_vertex(m->target[0].offset + 9, 0, 0, -0.5);
    assert_int_equal(m->attribute_count, 1);
    assert_string_equal(m->attribute[0].name, "_MARK");
    assert_int_equal(m->attribute[0].component_count, 1);
    assert_true(m->attribute[0].value[1] == 0.2f && m->attribute[0].value[3] == 1.0f);
    assert_null(m->note);
}

static void a_binary_file_is_read_with_all_it_has(void **state)
{
    (void)state;
    mesh m = read_good(DOCUMENT_HEAD);
    assert_is_head(&m);
    mesh_destroy(&m);
}

static void a_text_file_with_a_data_uri_is_the_same(void **state)
{
    (void)state;
    document d = document_gltf(DOCUMENT_HEAD);
    mesh m = read_document(&d, NULL);
    assert_is_head(&m);
    mesh_destroy(&m);
}

static void external_buffers_are_read_from_the_directory_only(void **state)
{
    (void)state;
    static const struct {
        const char *uri;
        mrt_result expected;
    } cases[] = {{"head.bin", MRT_OK},
                 {"he%61d.bin", MRT_OK},
                 {"head.bin'},{'byteLength':156,'uri':'head.bin", MRT_ERR_IO}, /* twice */
                 {"none.bin", MRT_ERR_IO},
                 {"../io/head.bin", MRT_ERR_IO},
                 {"/etc/passwd", MRT_ERR_IO},
                 {"%2e%2e%2fhead.bin", MRT_ERR_IO},
                 {"file:head.bin", MRT_ERR_IO},
                 {".hidden", MRT_ERR_IO},
                 {"..", MRT_ERR_IO},
                 {"a\\\\b", MRT_ERR_IO},
                 {"marotte:binary", MRT_ERR_IO},
                 {"", MRT_ERR_IO}};
    char directory[] = "/tmp/marotte-test-XXXXXX", path[64];
    assert_non_null(mkdtemp(directory));
    (void)snprintf(path, sizeof path, "%s/head.bin", directory);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(&DOCUMENT_BUFFER, 1, 156, file), 156);
    assert_int_equal(fclose(file), 0);
    char with_slash[64];
    (void)snprintf(with_slash, sizeof with_slash, "%s/", directory);
    mrt_result result[sizeof cases / sizeof *cases], without;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char json[6000];
        static const char data[] = DOCUMENT_DATA, place[] = "{'byteLength':156}";
        const char *at = strstr(data, place);
        (void)snprintf(json, sizeof json, "{%.*s{'byteLength':156,'uri':'%s'}%s%s}",
                       (int)(at - data), data, cases[i].uri, at + strlen(place), DOCUMENT_HEAD);
        document d = {.size = 0};
        document_put_json(&d, json);
        mesh m;
        result[i] = gltf_parse(&m, d.bytes, d.size, with_slash, NULL);
        if (i == 0) {
            mesh unused;
            without = gltf_parse(&unused, d.bytes, d.size, NULL, NULL);
        }
        mesh_destroy(&m);
    }
    (void)unlink(path);
    (void)rmdir(directory);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        if ((result[i] < 0) != (cases[i].expected < 0))
            fail_msg("\"%s\" gave %d", cases[i].uri, result[i]);
    assert_true(without < 0);
}

static void nodes_are_placed_by_matrix_and_by_parts(void **state)
{
    (void)state;
    /* A half turn about z, scaled by 2, moved; within a parent moved by (0, 0, 5). */
    mesh m = read_good(FACE_MESH ",'nodes':[{'children':[1,2],'translation':[0,0,5]},"
                                 "{'mesh':0,'name':'left','rotation':[0,0,1,0],'scale':[2,2,2],"
                                 "'translation':[10,0,0]},"
                                 "{'mesh':0,'matrix':[0,1,0,0,-1,0,0,0,0,0,1,0,7,8,9,1]}],"
                                 "'scenes':[{'nodes':[0]}]");
    assert_int_equal(m.vertex_count, 8);
    assert_int_equal(m.part_count, 2);
    assert_string_equal(m.part[0].name, "left");
    assert_string_equal(m.part[1].name, "face");
    assert_int_equal(m.part[1].first_vertex, 4);
    assert_vertex(m.position + 0, 10, 0, 5);
    assert_vertex(m.position + 6, 8, -2, 5);
    assert_vertex(m.position + 12, 7, 8, 14);
    assert_vertex(m.position + 15, 7, 9, 14);
    assert_vertex(m.position + 21, 6, 8, 14);
    assert_int_equal(m.triangle[6], 4);
    mesh_destroy(&m);
}

static void parts_are_named_by_their_primitive_where_it_says(void **state)
{
    (void)state;
    static const char *const extras[] = {"{'name':'upper lip'}", "{'name':7}", "{'name':''}",
                                         "{'other':'x'}",        "'name'",     "[]"};
    static const char *const expected[] = {"upper lip", "left", "left", "left", "left", "left"};
    for (size_t i = 0; i < sizeof extras / sizeof *extras; ++i) {
        char json[4096];
        (void)snprintf(json, sizeof json,
                       DOCUMENT_DATA "'meshes':[{'primitives':[{'attributes':{'POSITION':0},"
                                     "'indices':1,'extras':%s}]}],"
                                     "'nodes':[{'mesh':0,'name':'left'}],'scenes':[{'nodes':[0]}]",
                       extras[i]);
        mesh m = read_good(json);
        assert_string_equal(m.part[0].name, expected[i]);
        mesh_destroy(&m);
    }
}

static void mirrored_nodes_keep_the_outside_outside(void **state)
{
    (void)state;
    mesh m = read_good("'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':4},"
                       "'indices':1,'targets':[{'POSITION':2}]}]}],"
                       "'nodes':[{'mesh':0,'scale':[1,1,-3]}]");
    /* The normal was +z, seen from outside; mirrored in z, the outside is -z. */
    static const uint32_t flipped[] = {0, 2, 1, 0, 3, 2};
    assert_memory_equal(m.triangle, flipped, sizeof flipped);
    assert_vertex(m.normal, 0, 0, -1);
    assert_vertex(m.target[0].offset + 3, 0, 0, -1.5);
    mesh_destroy(&m);
}

static void normals_turn_by_the_inverse_transpose(void **state)
{
    (void)state;
    /* Sheared: z += x. The square's normal (0 0 1) becomes (-1 0 1) / sqrt 2. */
    mesh m = read_good("'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':4},"
                       "'indices':1}]}],"
                       "'nodes':[{'mesh':0,'matrix':[1,0,1,0,0,1,0,0,0,0,1,0,0,0,0,1]}]");
    assert_vertex(m.normal, -0.70710678, 0, 0.70710678);
    assert_vertex(m.position + 3, 1, 0, 1);
    mesh_destroy(&m);
}

static void primitives_that_share_vertices_do_not_double_them(void **state)
{
    (void)state;
    mesh m = read_good("'materials':[{'name':'a'},{'name':'b'}],"
                       "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1,"
                       "'material':0},{'attributes':{'POSITION':0},'indices':1,'material':1},"
                       "{'attributes':{'POSITION':0},'indices':1}]}],"
                       "'nodes':[{'mesh':0}]");
    assert_int_equal(m.vertex_count, 4);
    assert_int_equal(m.triangle_count, 6);
    assert_int_equal(m.part_count, 3);
    assert_int_equal(m.material_count, 3);
    assert_int_equal(m.part[1].material, 1);
    assert_int_equal(m.part[2].material, 2);
    assert_string_equal(m.material[2].name, "");
    mesh_destroy(&m);
}

static void targets_of_one_name_are_one_and_others_stay_zero(void **state)
{
    (void)state;
#define PRIMITIVE "'primitives':[{'attributes':{'POSITION':0},'indices':1,'targets':"
    mesh m = read_good("'meshes':["
                       "{'name':'skin'," PRIMITIVE "[{'POSITION':2},{}]}],"
                       "'extras':{'targetNames':['smile','frown']}},"
                       "{'name':'teeth'," PRIMITIVE "[{'POSITION':2},{'POSITION':2}]}],"
                       "'extras':{'targetNames':['smile']}},"
                       "{'name':'hair','primitives':[{'attributes':{'POSITION':0}}]}],"
                       "'nodes':[{'mesh':0},{'mesh':1},{'mesh':1}]");
#undef PRIMITIVE
    assert_int_equal(m.vertex_count, 12);
    assert_int_equal(m.target_count, 3);
    assert_string_equal(m.target[0].name, "smile");
    assert_string_equal(m.target[1].name, "frown");
    assert_string_equal(m.target[2].name, "teeth.1");
    for (int instance = 0; instance < 3; ++instance) {
        size_t at = ((size_t)instance * 4 + 1) * 3;
        assert_vertex(m.target[0].offset + at, 0, 0, 0.5);
        assert_vertex(m.target[1].offset + at, 0, 0, 0);
        assert_vertex(m.target[2].offset + at, 0, 0, instance == 0 ? 0 : 0.5);
    }
    mesh_destroy(&m);
}

static void strips_and_fans_become_triangles(void **state)
{
    (void)state;
    static const uint32_t strip[] = {0, 1, 2, 1, 3, 2}, fan[] = {1, 2, 0, 2, 3, 0};
    mesh m = read_good("'meshes':[{'primitives':[{'attributes':{'POSITION':0},'mode':5},"
                       "{'attributes':{'POSITION':0},'mode':6},"
                       "{'attributes':{'POSITION':0},'mode':0}]}],'nodes':[{'mesh':0}]");
    assert_int_equal(m.vertex_count, 4);
    assert_int_equal(m.triangle_count, 4);
    assert_memory_equal(m.triangle, strip, sizeof strip);
    assert_memory_equal(m.triangle + 6, fan, sizeof fan);
    assert_non_null(strstr(m.note, "1 primitives of points or lines"));
    mesh_destroy(&m);
}

static void what_is_not_applied_is_noted(void **state)
{
    (void)state;
    mesh m =
        read_good("'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1,"
                  "'targets':[{'POSITION':2}]}],'weights':[0.5]}],"
                  "'nodes':[{'mesh':0,'skin':0},{}],'skins':[{'joints':[1]}],"
                  "'scenes':[{'nodes':[0]},{'nodes':[]}],"
                  "'images':[{'uri':'missing.png'},{'bufferView':99}],"
                  "'animations':[{'channels':7}],'extensionsRequired':['KHR_materials_unlit']");
    assert_non_null(strstr(m.note, "1 skins were not applied"));
    assert_non_null(strstr(m.note, "default weights"));
    assert_non_null(strstr(m.note, "one of 2 scenes"));
    assert_string_equal(m.target[0].name, "target.0");
    mesh_destroy(&m);
}

static void a_file_without_nodes_shows_its_meshes(void **state)
{
    (void)state;
    mesh m = read_good(FACE_MESH);
    assert_int_equal(m.triangle_count, 2);
    assert_non_null(strstr(m.note, "no nodes"));
    mesh_destroy(&m);
}

/* Each node moves by 1, 10 or 100 in x, so that a position gives the path to its node. */
static void nodes_that_the_scene_names_beside_their_parents_are_read_once(void **state)
{
    (void)state;
    static const struct {
        const char *nodes;
        uint32_t part_count;
        float x;
        const char *note;
    } cases[] = {
        {"0", 1, 111, NULL},
        {"0,1,2", 1, 111, "the scene lists 2 nodes twice, or also nodes above them"},
        {"2,1,0", 1, 111, "the scene lists 2 nodes twice"},
        {"2,0", 1, 111, "the scene lists 1 nodes twice"},
        {"0,0", 1, 111, "the scene lists 1 nodes twice"},
        {"1", 1, 110, "1 nodes of the scene have a parent outside it: its transform is not"},
        {"2,1", 1, 110, "1 nodes of the scene have a parent outside it"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char json[1024];
        (void)snprintf(json, sizeof json,
                       FACE_MESH ",'nodes':[{'children':[1],'translation':[1,0,0]},"
                                 "{'children':[2],'translation':[10,0,0]},"
                                 "{'mesh':0,'translation':[100,0,0]}],'scenes':[{'nodes':[%s]}]",
                       cases[i].nodes);
        mesh m = read_good(json);
        assert_int_equal(m.part_count, cases[i].part_count);
        assert_true(m.position[0] == cases[i].x);
        if (cases[i].note ? !m.note || !strstr(m.note, cases[i].note) : m.note != NULL)
            fail_msg("%s: \"%s\"", cases[i].nodes, m.note);
        mesh_destroy(&m);
    }
}

static void of_instances_the_mesh_is_read_once_and_noted(void **state)
{
    (void)state;
    mesh m = read_good(FACE_MESH ",'nodes':[{'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':"
                                 "{'attributes':{'TRANSLATION':0}}}},"
                                 "{'extensions':{'EXT_mesh_gpu_instancing':7}}],"
                                 "'extensionsRequired':['EXT_mesh_gpu_instancing']");
    assert_int_equal(m.part_count, 1);
    assert_memory_equal(m.position, DOCUMENT_BUFFER.position, sizeof DOCUMENT_BUFFER.position);
    assert_non_null(strstr(m.note, "1 nodes repeat their mesh (EXT_mesh_gpu_instancing): each is "
                                   "read once, its instances are not drawn"));
    mesh_destroy(&m);
}

/* Every component type, as it is and normalised. */
static void custom_attributes_of_any_type_are_read(void **state)
{
    (void)state;
    static const struct {
        int type, size, normalised;
        unsigned char first[4];
        float expected;
    } cases[] = {
        {5120, 1, 0, {0x80}, -128.0f},         {5120, 1, 1, {0x80}, -1.0f},
        {5121, 1, 0, {200}, 200.0f},           {5121, 1, 1, {255}, 1.0f},
        {5122, 2, 0, {0x00, 0x80}, -32768.0f}, {5122, 2, 1, {0xff, 0x7f}, 1.0f},
        {5123, 2, 0, {0xff, 0xff}, 65535.0f},  {5123, 2, 1, {0xff, 0xff}, 1.0f},
        {5125, 4, 0, {1, 0, 1, 0}, 65537.0f},  {5125, 4, 1, {0xff, 0xff, 0xff, 0xff}, 1.0f},
        {5126, 4, 0, {0, 0, 0xc0, 0x3f}, 1.5f}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        unsigned char binary[48 + 32] = {0};
        char json[2000];
        memcpy(binary, DOCUMENT_BUFFER.position, 48);
        memcpy(binary + 48, cases[i].first, 4);
        (void)snprintf(json, sizeof json,
                       "'asset':{'version':'2.0'},'buffers':[{'byteLength':80}],'bufferViews':["
                       "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':32}],"
                       "'accessors':[{'bufferView':0,'componentType':5126,'count':3,"
                       "'type':'VEC3'},{'bufferView':1,'componentType':%d,'count':3,"
                       "'normalized':%s,'type':'VEC2'}],'meshes':[{'primitives':[{'attributes':{"
                       "'POSITION':0,'_A':1}}]}]",
                       cases[i].type, cases[i].normalised ? "true" : "false");
        document d = document_glb_of(json, binary, sizeof binary);
        mesh m = read_document(&d, NULL);
        assert_int_equal(m.attribute_count, 1);
        assert_int_equal(m.attribute[0].component_count, 2);
        assert_true(m.attribute[0].value[0] == cases[i].expected);
        mesh_destroy(&m);
    }
}

static void the_real_face_is_read(void **state)
{
    static const char *const names[] = {
        "jawOpen",       "mouthSmile_L",  "mouthSmile_R",   "browInnerUp_L", "browInnerUp_R",
        "browOuterUp_L", "browOuterUp_R", "mouthPucker",    "mouthFrown_L",  "mouthFrown_R",
        "eyeBlink_L",    "eyeBlink_R",    "mouthUpperUp_L", "mouthUpperUp_R"};
    (void)state;
    char path[1024];
    const char *shared = getenv("MAROTTE_SHARED");
    (void)snprintf(path, sizeof path, "%s/data/faces/ict_face.glb",
                   shared ? shared : SOURCE_DIR "/../shared");
    if (access(path, R_OK) != 0) {
        print_message("SKIPPED: %s is not there\n", path);
        skip();
    }
    mesh m;
    error err = {""};
    if (mesh_file_read(&m, path, NULL, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(m.vertex_count, 26719);
    assert_int_equal(m.triangle_count, 52220);
    assert_int_equal(m.target_count, 14);
    for (size_t i = 0; i < 14; ++i)
        assert_string_equal(m.target[i].name, names[i]);
    assert_true(m.mm_per_unit == 1000.0);
    float low[3], high[3];
    mesh_bounds(&m, low, high);
    assert_true(fabs((double)low[1] + 193.08) < 0.01 && fabs((double)high[1] - 145.05) < 0.01);
    double deepest = 0.0; /* jawOpen pulls the chin 35.36 mm down */
    for (size_t v = 0; v < m.vertex_count; ++v)
        deepest = fmin(deepest, (double)m.target[0].offset[v * 3 + 1]);
    assert_true(fabs(deepest + 35.36) < 0.01);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_binary_file_is_read_with_all_it_has),
        cmocka_unit_test(a_text_file_with_a_data_uri_is_the_same),
        cmocka_unit_test(external_buffers_are_read_from_the_directory_only),
        cmocka_unit_test(nodes_are_placed_by_matrix_and_by_parts),
        cmocka_unit_test(parts_are_named_by_their_primitive_where_it_says),
        cmocka_unit_test(mirrored_nodes_keep_the_outside_outside),
        cmocka_unit_test(normals_turn_by_the_inverse_transpose),
        cmocka_unit_test(primitives_that_share_vertices_do_not_double_them),
        cmocka_unit_test(targets_of_one_name_are_one_and_others_stay_zero),
        cmocka_unit_test(strips_and_fans_become_triangles),
        cmocka_unit_test(what_is_not_applied_is_noted),
        cmocka_unit_test(a_file_without_nodes_shows_its_meshes),
        cmocka_unit_test(nodes_that_the_scene_names_beside_their_parents_are_read_once),
        cmocka_unit_test(of_instances_the_mesh_is_read_once_and_noted),
        cmocka_unit_test(custom_attributes_of_any_type_are_read),
        cmocka_unit_test(the_real_face_is_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
