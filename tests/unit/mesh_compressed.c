/* tests/unit/mesh_compressed.c - glTF with Draco and meshopt: decoded in the child, the same mesh
 * as without; damaged, hostile and lying streams are refused by name and crash nothing. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include "io/decode/decode.h"

#include <meshoptimizer.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static int use_child(void **state)
{
    (void)state;
    return setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1);
}

/* The unit square of DOCUMENT_BUFFER as libdraco 1.5.5 writes it: attributes 0 positions, 1 normals
 * (both quantised), 2 four bytes a vertex. */
static const unsigned char DRACO_SQUARE[] = {
    0x44, 0x52, 0x41, 0x43, 0x4f, 0x02, 0x02, 0x01, 0x01, 0x00, 0x00, 0x00, 0x04, 0x02, 0x02,
    0x02, 0x00, 0x00, 0x01, 0x1f, 0xff, 0x01, 0x11, 0xff, 0x01, 0x11, 0xff, 0x01, 0x11, 0x03,
    0xff, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x01, 0x00, 0x09, 0x03, 0x00, 0x00,
    0x02, 0x01, 0x01, 0x09, 0x03, 0x00, 0x01, 0x03, 0x01, 0x04, 0x02, 0x04, 0x00, 0x02, 0x01,
    0x01, 0x01, 0x01, 0x00, 0x03, 0x03, 0x01, 0x30, 0x01, 0x10, 0x03, 0x00, 0x28, 0x82, 0x98,
    0x00, 0x00, 0x00, 0x00, 0x00, 0xff, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x3f, 0x0b, 0x00, 0x03, 0x01, 0x01,
    0x01, 0x80, 0x01, 0x01, 0x38, 0xff, 0xf7, 0x01, 0x08, 0x03, 0x00, 0x98, 0x84, 0xff, 0x00,
    0x00, 0x00, 0x7f, 0x00, 0x00, 0x00, 0x08, 0x01, 0x01, 0x01, 0x00, 0x03, 0x07, 0x01, 0x40,
    0x01, 0x00, 0x78, 0x03, 0x02, 0x02, 0x00, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00,
};

#define DRACO_DOCUMENT                                                                             \
    "'asset':{'version':'2.0'},'extensionsUsed':['KHR_draco_mesh_compression'],"                   \
    "'extensionsRequired':['KHR_draco_mesh_compression'],'buffers':[{'byteLength':149}],"          \
    "'bufferViews':[{'buffer':0,'byteLength':149}],"                                               \
    "'accessors':[{'componentType':5126,'count':4,'type':'VEC3'},"                                 \
    "{'componentType':5123,'count':6,'type':'SCALAR'},"                                            \
    "{'componentType':5126,'count':4,'type':'VEC3'},"                                              \
    "{'componentType':5121,'count':4,'type':'VEC4'}],"                                             \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':2,'_MARK':3},'indices':1,"      \
    "'extensions':{'KHR_draco_mesh_compression':{'bufferView':0,"                                  \
    "'attributes':{'POSITION':0,'NORMAL':1,'_MARK':2}}}}]}],'nodes':[{'mesh':0}]"

static mrt_result parse_draco(mesh *out, const void *data, size_t size, error *err)
{
    document d = document_glb_of(DRACO_DOCUMENT, data, size);
    return gltf_parse(out, d.bytes, d.size, NULL, err);
}

static void a_draco_mesh_is_decoded(void **state)
{
    (void)state;
    mesh m;
    error err = {""};
    if (parse_draco(&m, DRACO_SQUARE, sizeof DRACO_SQUARE, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(m.vertex_count, 4);
    assert_int_equal(m.triangle_count, 2);
    double area = 0.0;
    for (const uint32_t *t = m.triangle; t < m.triangle + 6; t += 3) {
        const float *a = m.position + t[0] * 3, *b = m.position + t[1] * 3,
                    *c = m.position + t[2] * 3;
        area += 0.5 * (double)((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    assert_true(area > 0.999 && area < 1.001); /* and counter-clockwise */
    for (size_t v = 0; v < 4; ++v) {           /* the file's own marks say which corner is which */
        static const float corner[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const float *mark = m.attribute[0].value + v * 4, *at = m.position + v * 3;
        assert_true(mark[3] == 3.0f && mark[2] == 2.0f);
        assert_true(at[0] == corner[(int)mark[0]][0] && at[1] == corner[(int)mark[0]][1]);
        assert_true(m.normal[v * 3 + 2] > 0.999f);
    }
    mesh_destroy(&m);
}

static void damaged_draco_is_refused_or_harmless(void **state)
{
    (void)state;
    unsigned char bad[sizeof DRACO_SQUARE];
    for (size_t i = 0; i < sizeof bad; i += 3)
        for (int kind = 0; kind < 2; ++kind) {
            mesh m;
            error err = {""};
            memcpy(bad, DRACO_SQUARE, sizeof bad);
            if (kind == 0)
                bad[i] ^= 0xff;
            else
                memset(bad + i, 0, sizeof bad - i);
            if (parse_draco(&m, bad, sizeof bad, &err) < 0)
                assert_non_null(strstr(err.text, "meshes[0].primitives[0]: "));
            else
                assert_int_equal(mesh_validate(&m, &err), MRT_OK);
            mesh_destroy(&m);
        }
}

/* One change each to the good document. */
static void lies_about_draco_are_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to, *reason;
    } lies[] = {
        {"'count':4,'type':'VEC3'},{", "'count':5,'type':'VEC3'},{", "differ"},
        {"'count':6", "'count':9", "has 4 vertices and 2 triangles, the file says 4 and 3"},
        {"'count':6", "'count':2000000000", "its counts are invalid"},
        {"'count':6", "'count':60000000", "it needs more than"},
        {"{'bufferView':0,'attr", "{'bufferView':3,'attr", "compressed data is missing"},
        {"{'bufferView':0,'attr", "{'bufferView':'x','attr", "compressed data is missing"},
        {"{'buffer':0,'byteLength':149}", "{'buffer':0,'byteLength':999}", "past the end"},
        {"{'buffer':0,'byteLength':149}", "{'buffer':7,'byteLength':149}", "buffer does not exist"},
        {"'_MARK':2}}", "'_MARK':9}}", "attribute 9 is not in the Draco data"},
        {"5121,'count':4", "5124,'count':4", "its compression settings are invalid"},
        {"'indices':1,", "'indices':1,'mode':5,", "only triangles"},
        {"'indices':1,", "'indices':99,", "accessor"}};
    for (size_t i = 0; i < sizeof lies / sizeof *lies; ++i) {
        char json[4096];
        const char *at = strstr(DRACO_DOCUMENT, lies[i].from);
        assert_non_null(at);
        (void)snprintf(json, sizeof json, "%.*s%s%s", (int)(at - DRACO_DOCUMENT), DRACO_DOCUMENT,
                       lies[i].to, at + strlen(lies[i].from));
        document d = document_glb_of(json, DRACO_SQUARE, sizeof DRACO_SQUARE);
        mesh m;
        error err = {""};
        if (gltf_parse(&m, d.bytes, d.size, NULL, &err) >= 0 || !strstr(err.text, lies[i].reason))
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, err.text, lies[i].reason);
    }
}

/* ---- meshopt ---- */

typedef struct meshopt_square {
    unsigned char bytes[1024];
    size_t offset[3], size[3], end; /* positions, normals (octahedral), triangles */
} meshopt_square;

static void append(meshopt_square *s, int i, size_t size)
{
    s->offset[i] = s->end;
    s->size[i] = size;
    s->end += (size + 3) / 4 * 4;
}

static meshopt_square make_meshopt(void)
{
    static const int8_t normal[16] = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
    static const unsigned int index[6] = {0, 1, 2, 0, 2, 3};
    meshopt_square s = {{0}, {0}, {0}, 0};
    append(&s, 0, meshopt_encodeVertexBuffer(s.bytes, 1024, DOCUMENT_BUFFER.position, 4, 12));
    append(&s, 1, meshopt_encodeVertexBuffer(s.bytes + s.end, 1024 - s.end, normal, 4, 4));
    append(&s, 2, meshopt_encodeIndexBuffer(s.bytes + s.end, 1024 - s.end, index, 6));
    assert_true(s.size[0] > 0 && s.size[1] > 0 && s.size[2] > 0);
    return s;
}

#define MESHOPT(i, rest)                                                                           \
    "'extensions':{'EXT_meshopt_compression':{'buffer':0,'byteOffset':%zu,'byteLength':%zu," rest  \
    "}}}"

static void meshopt_json(char json[4096], const meshopt_square *s, const char *filter)
{
    (void)snprintf(
        json, 4096,
        "'asset':{'version':'2.0'},'extensionsUsed':['KHR_mesh_quantization'],"
        "'extensionsRequired':['EXT_meshopt_compression'],"
        "'buffers':[{'byteLength':%zu},{'byteLength':76,'extensions':{'EXT_meshopt_compression':"
        "{'fallback':true}}}],'bufferViews':["
        "{'buffer':1,'byteLength':48,'byteStride':12," MESHOPT(
            0, "'byteStride':12,'count':4,'mode':'ATTRIBUTES'") ","
                                                                "{'buffer':1,'byteOffset':48,'"
                                                                "byteLength':16,'byteStride':"
                                                                "4," MESHOPT(
                                                                    1,
                                                                    "'byteStride':4,'count':4,'"
                                                                    "mode':'ATTRIBUTES','filter':'%"
                                                                    "s'") ","
                                                                          "{'buffer':1,'byteOffset'"
                                                                          ":64,'byteLength':"
                                                                          "12," MESHOPT(
                                                                              2,
                                                                              "'byteStride':2,'"
                                                                              "count':6,'mode':'"
                                                                              "TRIANGLES'") "],"
                                                                                            "'acces"
                                                                                            "sors':"
                                                                                            "[{'"
                                                                                            "buffer"
                                                                                            "View':"
                                                                                            "0,'"
                                                                                            "compon"
                                                                                            "entTyp"
                                                                                            "e':"
                                                                                            "5126,'"
                                                                                            "count'"
                                                                                            ":4,'"
                                                                                            "type':"
                                                                                            "'VEC3'"
                                                                                            "},"
                                                                                            "{'"
                                                                                            "buffer"
                                                                                            "View':"
                                                                                            "1,'"
                                                                                            "compon"
                                                                                            "entTyp"
                                                                                            "e':"
                                                                                            "5120,'"
                                                                                            "normal"
                                                                                            "ized':"
                                                                                            "true,'"
                                                                                            "count'"
                                                                                            ":4,'"
                                                                                            "type':"
                                                                                            "'VEC3'"
                                                                                            "},"
                                                                                            "{'"
                                                                                            "buffer"
                                                                                            "View':"
                                                                                            "2,'"
                                                                                            "compon"
                                                                                            "entTyp"
                                                                                            "e':"
                                                                                            "5123,'"
                                                                                            "count'"
                                                                                            ":6,'"
                                                                                            "type':"
                                                                                            "'SCALA"
                                                                                            "R'}],"
                                                                                            "'meshe"
                                                                                            "s':[{'"
                                                                                            "primit"
                                                                                            "ives':"
                                                                                            "[{'"
                                                                                            "attrib"
                                                                                            "utes':"
                                                                                            "{'"
                                                                                            "POSITI"
                                                                                            "ON':0,"
                                                                                            "'NORMA"
                                                                                            "L':1},"
                                                                                            "'indic"
                                                                                            "es':2}"
                                                                                            "]}],"
                                                                                            "'nodes"
                                                                                            "':[{'"
                                                                                            "mesh':"
                                                                                            "0}]",
        s->end, s->offset[0], s->size[0], s->offset[1], s->size[1], filter, s->offset[2],
        s->size[2]);
}

static document meshopt_document(const meshopt_square *s, const char *filter)
{
    char json[4096];
    meshopt_json(json, s, filter);
    return document_glb_of(json, s->bytes, s->end);
}

static void meshopt_views_are_decoded(void **state)
{
    (void)state;
    meshopt_square s = make_meshopt();
    document d = meshopt_document(&s, "OCTAHEDRAL");
    mesh m;
    error err = {""};
    if (gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0)
        fail_msg("%s", err.text);
    assert_memory_equal(m.position, DOCUMENT_BUFFER.position, sizeof DOCUMENT_BUFFER.position);
    assert_int_equal(m.triangle_count, 2);
    for (size_t v = 0; v < 4; ++v)
        assert_true(m.normal[v * 3 + 2] > 0.999f);
    mesh_destroy(&m);
}

/* A buffer without bytes needs none if all its views are compressed in another one. */
static void a_fallback_buffer_without_a_uri_is_not_needed(void **state)
{
    (void)state;
    static const char mark[] =
        ",'extensions':{'EXT_meshopt_compression':{'fallback':true}}}],'bufferViews':[";
    static const struct {
        const char *instead, *reason; /* NULL: the file is read */
    } cases[] = {
        {mark, NULL},
        {",'extensions':{'EXT_meshopt_compression':{}}}],'bufferViews':[", NULL},
        {",'extensions':{'KHR_meshopt_compression':{'fallback':true}}}],'bufferViews':[", NULL},
        {"}],'bufferViews':[", NULL},
        {",'extensions':{}}],'bufferViews':[", NULL},
        {",'extensions':7}],'bufferViews':[", NULL},
        {"},{'byteLength':8}],'bufferViews':[", "buffers[2] has no uri"}};
    meshopt_square s = make_meshopt();
    char json[4096], changed[4096];
    meshopt_json(json, &s, "OCTAHEDRAL");
    const char *at = strstr(json, mark);
    assert_non_null(at);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        (void)snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - json), json,
                       cases[i].instead, at + strlen(mark));
        document d = document_glb_of(changed, s.bytes, s.end);
        mesh m;
        error err = {""};
        bool is_read = gltf_parse(&m, d.bytes, d.size, NULL, &err) >= 0;
        if (is_read != !cases[i].reason || (!is_read && !strstr(err.text, cases[i].reason)))
            fail_msg("%s: %s", cases[i].instead, err.text);
        if (is_read)
            assert_memory_equal(m.position, DOCUMENT_BUFFER.position,
                                sizeof DOCUMENT_BUFFER.position);
        mesh_destroy(&m);
    }
    /* A view without the extension needs the bytes. */
    (void)snprintf(changed, sizeof changed, "%.*s}],'bufferViews':[{'buffer':1,'byteLength':8},%s",
                   (int)(at - json), json, at + strlen(mark));
    document d = document_glb_of(changed, s.bytes, s.end);
    mesh m;
    error err = {""};
    assert_true(gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "buffers[1] has no uri"));
}

static void damaged_meshopt_is_refused_or_harmless(void **state)
{
    (void)state;
    meshopt_square s = make_meshopt();
    for (size_t i = 0; i < s.end; i += 3) {
        meshopt_square bad = s;
        bad.bytes[i] ^= 0xff;
        document d = meshopt_document(&bad, "OCTAHEDRAL");
        mesh m;
        error err = {""};
        if (gltf_parse(&m, d.bytes, d.size, NULL, &err) >= 0)
            assert_int_equal(mesh_validate(&m, &err), MRT_OK);
        mesh_destroy(&m);
    }
    meshopt_square cut = s;
    cut.size[0] -= 4;
    document d = meshopt_document(&cut, "OCTAHEDRAL");
    mesh m;
    error err = {""};
    assert_true(gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "bufferViews[0]: the meshopt data is damaged"));
    d = meshopt_document(&s, "QUATERNION"); /* which takes 8 bytes each */
    assert_true(gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0);
    assert_non_null(strstr(err.text, "bufferViews[1]: its mode, filter and byteStride 4"));
}

/* ---- the child ---- */

static void a_job_that_ends_the_child_fails_alone(void **state)
{
    (void)state;
    char path[] = "/tmp/marotte-test-XXXXXX";
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    /* Answers one job, then dies; started again, the same: every second job is lost. */
    static const char script[] =
        "#!/bin/sh\nprintf '\\0\\0\\0\\0\\0\\0\\0\\0\\3\\0\\0\\0\\0\\0\\0\\0bad'\n"
        "kill -SEGV $$\n";
    assert_int_equal(write(fd, script, strlen(script)), strlen(script));
    assert_int_equal(fchmod(fd, 0700), 0);
    assert_int_equal(close(fd), 0);
    assert_int_equal(setenv("MAROTTE_MESHLOAD", path, 1), 0);
    decode_job job[5];
    memset(job, 0, sizeof job);
    for (size_t i = 0; i < 5; ++i)
        job[i].order.kind = DECODE_IMAGE;
    error err = {""};
    assert_int_equal(decode_run(job, 5, &err), MRT_OK);
    for (size_t i = 0; i < 5; ++i) {
        assert_null(job[i].out);
        assert_non_null(strstr(job[i].failed.text, i % 2 ? "crashed" : "bad"));
    }
    (void)unlink(path);
    assert_int_equal(decode_run(job, 1, &err) < 0, 1);
    assert_non_null(strstr(err.text, "MAROTTE_MESHLOAD"));
    (void)use_child(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_draco_mesh_is_decoded),
        cmocka_unit_test(damaged_draco_is_refused_or_harmless),
        cmocka_unit_test(lies_about_draco_are_refused_by_name),
        cmocka_unit_test(meshopt_views_are_decoded),
        cmocka_unit_test(a_fallback_buffer_without_a_uri_is_not_needed),
        cmocka_unit_test(damaged_meshopt_is_refused_or_harmless),
        cmocka_unit_test(a_job_that_ends_the_child_fails_alone),
    };
    return cmocka_run_group_tests(tests, use_child, NULL);
}
