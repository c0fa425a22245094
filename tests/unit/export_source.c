/* A face from a glTF file is exported as that file with the performance added: read back, each
 * target moves what it moves in the bare mesh, through nodes that turn, scale and mirror, through a
 * skin and two nodes of one mesh; all else in the file is as it was. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "io/export.h"
#include "io/mesh_file.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIDE = 5, VERTICES = SIDE * SIDE, TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1) };

static char folder[] = "/tmp/marotte_export_source_XXXXXX";
static char source[128], whole[128], bare[128], picture[128];

/* One sheet for two nodes, another one on a skin whose joints do not stand as it was bound; own
 * targets, a picture beside the file, extensions and extras that nobody here knows. */
static const char document[] =
    "{\"asset\":{\"version\":\"2.0\",\"generator\":\"somebody\",\"extras\":{\"mood\":\"fine\"}},"
    "\"extensionsUsed\":[\"ACME_strings\"],\"extensions\":{\"ACME_strings\":{\"count\":3}},"
    "\"scene\":0,\"scenes\":[{\"nodes\":[0,1,2,3],\"name\":\"show\"}],"
    "\"nodes\":["
    "{\"name\":\"left\",\"mesh\":0,\"translation\":[0.4,0,0],\"rotation\":[0,0,0.6,0.8],"
    "\"scale\":[2,1,1]},"
    "{\"name\":\"right\",\"mesh\":0,\"translation\":[-0.4,0,0],\"scale\":[-1,1,1]},"
    "{\"name\":\"skinned\",\"mesh\":1,\"skin\":0},"
    "{\"name\":\"Head\",\"rotation\":[0.6,0,0,0.8],\"children\":[4]},"
    "{\"name\":\"Jaw\",\"translation\":[0,0.1,0],\"extras\":{\"keep\":[1,2.5,\"three\"]}}],"
    "\"meshes\":["
    "{\"name\":\"sheet\",\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},"
    "\"indices\":2,\"material\":0}]},"
    "{\"name\":\"face\",\"weights\":[0.25],\"extras\":{\"targetNames\":[\"own smile\"]},"
    "\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"JOINTS_0\":3,\"WEIGHTS_0\":4},"
    "\"indices\":2,\"material\":0,\"targets\":[{\"POSITION\":5}]}]}],"
    "\"skins\":[{\"joints\":[3,4]}],"
    "\"materials\":[{\"name\":\"paint\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":"
    "0}}}],"
    "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"paint.png\"}],"
    "\"animations\":[{\"name\":\"own\",\"channels\":[{\"sampler\":0,\"target\":{\"node\":4,"
    "\"path\":\"translation\"}}],\"samplers\":[{\"input\":6,\"output\":7}]}],";

typedef struct block { /* an accessor and its view */
    const char *type;
    uint32_t component, count, parts;
    const void *data;
    size_t size;
} block;

static void write_source(void)
{
    static float position[VERTICES * 3], normal[VERTICES * 3], weight[VERTICES * 4],
        smile[VERTICES * 3];
    static uint16_t index[TRIANGLES * 3], joint[VERTICES * 4];
    static const float time_s[2] = {0, 1}, way[6] = {0, 0.1f, 0, 0, 0.2f, 0};
    uint16_t *corner = index;
    for (uint16_t v = 0; v < VERTICES; ++v) {
        int x = v % SIDE, y = v / SIDE;
        position[3 * v] = 0.05f * (float)x;
        position[3 * v + 1] = 0.05f * (float)y;
        position[3 * v + 2] = 0.01f * (float)(x * y);
        normal[3 * v + 2] = 1.0f;
        joint[4 * v + 1] = 1;
        weight[4 * v + 1] = (float)x / (SIDE - 1);
        weight[4 * v] = 1.0f - weight[4 * v + 1];
        smile[3 * v + 1] = 0.002f * (float)x;
        if (x == SIDE - 1 || y == SIDE - 1)
            continue;
        const uint16_t quad[6] = {v,
                                  (uint16_t)(v + 1),
                                  (uint16_t)(v + SIDE),
                                  (uint16_t)(v + 1),
                                  (uint16_t)(v + SIDE + 1),
                                  (uint16_t)(v + SIDE)};
        memcpy(corner, quad, sizeof quad);
        corner += 6;
    }
    const block blocks[] = {{"VEC3", 5126, VERTICES, 3, position, sizeof position},
                            {"VEC3", 5126, VERTICES, 3, normal, sizeof normal},
                            {"SCALAR", 5123, TRIANGLES * 3, 1, index, sizeof index},
                            {"VEC4", 5123, VERTICES, 4, joint, sizeof joint},
                            {"VEC4", 5126, VERTICES, 4, weight, sizeof weight},
                            {"VEC3", 5126, VERTICES, 3, smile, sizeof smile},
                            {"SCALAR", 5126, 2, 1, time_s, sizeof time_s},
                            {"VEC3", 5126, 2, 3, way, sizeof way}};
    enum { BLOCKS = sizeof blocks / sizeof blocks[0] };
    char binary[160];
    snprintf(binary, sizeof binary, "%s/data.bin", folder);
    FILE *bin = fopen(binary, "wb"), *gltf = fopen(source, "wb"), *png = fopen(picture, "wb");
    assert_true(bin && gltf && png);
    fputs("\x89PNG\r\n\x1a\n: not a whole picture, and none that is looked at", png);
    fprintf(gltf, "%s\"accessors\":[", document);
    for (int i = 0; i < BLOCKS; ++i)
        fprintf(
            gltf,
            "%s{\"bufferView\":%d,\"componentType\":%u,\"count\":%u,\"type\":\"%s\",\"min\":[%s],"
            "\"max\":[%s]}",
            i ? "," : "", i, blocks[i].component, blocks[i].count, blocks[i].type,
            i == 0   ? "0,0,0"
            : i == 6 ? "0"
                     : "",
            i == 0   ? "0.2,0.2,0.16"
            : i == 6 ? "1"
                     : "");
    fprintf(gltf, "],\"bufferViews\":[");
    size_t at = 0;
    for (int i = 0; i < BLOCKS; ++i) {
        fprintf(gltf, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}", i ? "," : "", at,
                blocks[i].size);
        assert_int_equal(fwrite(blocks[i].data, 1, blocks[i].size, bin), blocks[i].size);
        at += blocks[i].size;
    }
    fprintf(gltf, "],\"buffers\":[{\"uri\":\"data.bin\",\"byteLength\":%zu}]}", at);
    assert_int_equal(fclose(bin) | fclose(gltf) | fclose(png), 0);
}

/* min and max of accessors that need none are empty: taken out, as nobody writes them so. */
static void tidy_source(void)
{
    json_t *root = json_load_file(source, 0, NULL);
    size_t i;
    json_t *accessor;
    json_array_foreach(json_object_get(root, "accessors"), i,
                       accessor) if (json_array_size(json_object_get(accessor, "min")) == 0)
    {
        json_object_del(accessor, "min");
        json_object_del(accessor, "max");
    }
    assert_int_equal(json_dump_file(root, source, 0), 0);
    json_decref(root);
}

static int make_files(void **state)
{
    (void)state;
    assert_non_null(mkdtemp(folder));
    snprintf(source, sizeof source, "%s/head.gltf", folder);
    snprintf(whole, sizeof whole, "%s/whole.glb", folder);
    snprintf(bare, sizeof bare, "%s/bare.glb", folder);
    snprintf(picture, sizeof picture, "%s/paint.png", folder);
    write_source();
    tidy_source();
    return 0;
}

static int remove_files(void **state)
{
    (void)state;
    char command[160];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

/* Each part moves in its own way; the last one stays for a while. */
static void perform(const mesh *m, gltf_report *out_whole, gltf_report *out_bare)
{
    error err = {""};
    float *shape = malloc((size_t)m->vertex_count * 3 * sizeof *shape);
    clip *c = clip_create(m, 30.0, NULL, &err);
    assert_non_null(c);
    for (int frame = 0; frame < 20; ++frame) {
        for (uint32_t i = 0; i < m->vertex_count * 3; ++i)
            shape[i] = m->position[i] + 3.0f * (float)(sin(0.3 * frame + i / 75) * cos(0.2 * i));
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
    }
    const gltf_options with = {.tolerance_mm = 0.01},
                       without = {.tolerance_mm = 0.01, .is_bare = true};
    if (gltf_write(whole, c, &with, NULL, out_whole, &err) < 0 ||
        gltf_write(bare, c, &without, NULL, out_bare, &err) < 0)
        fail_msg("%s", err.text);
    clip_destroy(c);
    free(shape);
}

static const mesh_target *target_named(const mesh *m, const char *name)
{
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (strcmp(m->target[i].name, name) == 0)
            return &m->target[i];
    return NULL;
}

static void each_target_moves_what_it_moves_in_the_bare_mesh(void **state)
{
    (void)state;
    error err = {""};
    mesh m, a, b;
    gltf_report first, second;
    assert_int_equal(mesh_file_read(&m, source, NULL, &err), MRT_OK);
    perform(&m, &first, &second);
    assert_string_equal(first.why_bare.text, "");
    assert_int_equal(first.target_count, second.target_count);
    assert_int_equal(mesh_file_read(&a, whole, NULL, &err), MRT_OK);
    assert_int_equal(mesh_file_read(&b, bare, NULL, &err), MRT_OK);
    assert_int_equal(a.vertex_count, b.vertex_count);
    assert_int_equal(a.target_count, b.target_count + 1);
    assert_non_null(target_named(&a, "own smile"));
    for (uint32_t t = 0; t < b.target_count; ++t) {
        const mesh_target *same = target_named(&a, b.target[t].name);
        assert_non_null(same);
        for (uint32_t i = 0; i < m.vertex_count * 3; ++i)
            assert_float_equal(same->offset[i], b.target[t].offset[i], 1e-3);
    }
    mesh_destroy(&m);
    mesh_destroy(&a);
    mesh_destroy(&b);
}

static json_t *json_of_glb(const char *path)
{
    FILE *file = fopen(path, "rb");
    uint32_t head[5];
    assert_true(file && fread(head, 4, 5, file) == 5);
    char *text = malloc(head[3]);
    assert_true(text && fread(text, 1, head[3], file) == head[3]);
    fclose(file);
    json_t *root = json_loadb(text, head[3], 0, NULL);
    assert_non_null(root);
    free(text);
    return root;
}

static void all_else_is_as_it_was(void **state)
{
    (void)state;
    error err = {""};
    mesh m;
    gltf_report first, second;
    assert_int_equal(mesh_file_read(&m, source, NULL, &err), MRT_OK);
    perform(&m, &first, &second);
    json_t *before = json_load_file(source, 0, NULL), *after = json_of_glb(whole);
    static const char *const kept[] = {"asset",  "extensionsUsed", "extensions", "scene",
                                       "scenes", "skins",          "materials",  "textures"};
    for (size_t i = 0; i < sizeof kept / sizeof kept[0]; ++i)
        assert_true(json_equal(json_object_get(before, kept[i]), json_object_get(after, kept[i])));
    json_t *nodes = json_object_get(after, "nodes");
    for (size_t i = 0; i < json_array_size(nodes);
         ++i) /* but for the mesh that the second shares */
        if (i != 1)
            assert_true(json_equal(json_array_get(json_object_get(before, "nodes"), i),
                                   json_array_get(nodes, i)));
    assert_int_equal(json_array_size(json_object_get(after, "meshes")), 3);
    /* The picture is inside; the file's own animation plays behind the performance. */
    json_t *image = json_array_get(json_object_get(after, "images"), 0);
    assert_null(json_object_get(image, "uri"));
    assert_string_equal(json_string_value(json_object_get(image, "mimeType")), "image/png");
    json_t *animations = json_object_get(after, "animations");
    assert_int_equal(json_array_size(animations), 2);
    assert_true(json_equal(json_array_get(json_object_get(before, "animations"), 0),
                           json_array_get(animations, 1)));
    assert_int_equal(json_array_size(json_object_get(json_array_get(animations, 0), "channels")),
                     3);
    /* Its own target keeps its place, its weight and its name. */
    json_t *face = json_array_get(json_object_get(after, "meshes"), 1);
    assert_true(json_real_value(json_array_get(json_object_get(face, "weights"), 0)) == 0.25);
    json_t *names = json_object_get(json_object_get(face, "extras"), "targetNames");
    assert_string_equal(json_string_value(json_array_get(names, 0)), "own smile");
    assert_int_equal(json_array_size(names), json_array_size(json_object_get(face, "weights")));
    json_decref(before);
    json_decref(after);
    mesh_destroy(&m);
}

/* One that rests at 0: the curve of its name gives its weights, and no second one is added. */
static void its_own_target_is_played_by_the_curve_of_its_name(void **state)
{
    (void)state;
    error err = {""};
    mesh m;
    gltf_report report;
    char copy[160], name[] = "own smile", unit[] = "";
    json_t *root = json_load_file(source, 0, NULL);
    json_array_set_new(
        json_object_get(json_array_get(json_object_get(root, "meshes"), 1), "weights"), 0,
        json_real(0.0));
    snprintf(copy, sizeof copy, "%s/at_rest.gltf", folder);
    assert_int_equal(json_dump_file(root, copy, 0), 0);
    json_decref(root);
    assert_int_equal(mesh_file_read(&m, copy, NULL, &err), MRT_OK);
    clip *c = clip_create(&m, 30.0, NULL, &err);
    clip_curve curve = {name, unit, 0.0, 1.0, NULL, target_named(&m, name)->offset, true};
    assert_int_equal(clip_add_curve(c, &curve, &err), MRT_OK);
    float *shape = malloc((size_t)m.vertex_count * 3 * sizeof *shape);
    for (int frame = 0; frame < 3; ++frame) {
        double part = 0.5 * frame;
        for (uint32_t i = 0; i < m.vertex_count * 3; ++i)
            shape[i] = m.position[i] + (float)part * curve.at_max[i];
        assert_int_equal(clip_add_free(c, shape, &err), MRT_OK);
        assert_int_equal(clip_add_named(c, &part, NULL, &err), MRT_OK);
    }
    assert_int_equal(gltf_write(whole, c, NULL, NULL, &report, &err), MRT_OK);
    assert_string_equal(report.why_bare.text, "");
    assert_int_equal(report.target_count, 1);
    json_t *after = json_of_glb(whole), *face = json_array_get(json_object_get(after, "meshes"), 1);
    json_t *names = json_object_get(json_object_get(face, "extras"), "targetNames");
    assert_int_equal(json_array_size(names), 1);
    json_t *animation = json_array_get(json_object_get(after, "animations"), 0);
    json_t *sampler = json_array_get(json_object_get(animation, "samplers"), 0);
    json_t *weights =
        json_array_get(json_object_get(after, "accessors"),
                       (size_t)json_integer_value(json_object_get(sampler, "output")));
    assert_true(json_real_value(json_array_get(json_object_get(weights, "max"), 0)) == 1.0);
    assert_int_equal(json_integer_value(json_object_get(weights, "count")), 3);
    json_decref(after);
    clip_destroy(c);
    free(shape);
    mesh_destroy(&m);
}

/* Sets what a JSON pointer leads to, "-" being one more item; NULL: takes it away. */
static void set_at(json_t *root, const char *pointer, const char *text)
{
    char key[64];
    json_t *at = root;
    for (const char *rest = pointer; *rest;) {
        size_t length = strcspn(rest + 1, "/");
        snprintf(key, sizeof key, "%.*s", (int)length, rest + 1);
        rest += 1 + length;
        bool is_list = json_is_array(at), is_last = !*rest;
        size_t index = strcmp(key, "-") == 0 ? json_array_size(at) : (size_t)atoi(key);
        json_t *value = is_last && text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
        assert_true(!is_last || !text || value);
        if (is_last && is_list)
            assert_int_equal(text ? index < json_array_size(at)
                                        ? json_array_set_new(at, index, value)
                                        : json_array_append_new(at, value)
                                  : json_array_remove(at, index),
                             0);
        else if (is_last)
            assert_int_equal(text ? json_object_set_new(at, key, value) : json_object_del(at, key),
                             0);
        else
            at = is_list ? json_array_get(at, index) : json_object_get(at, key);
        assert_non_null(at);
    }
}

/* The reader looks only at what is shown. An export takes all along and appends to it: what does
 * not hold there leaves the mesh alone in the export, and the place is told. */
static void what_cannot_be_carried_over_is_told_by_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *pointer, *text, *place; /* place NULL: pointer */
    } wrong[] = {
        {"/bufferViews/-", "{\"buffer\":1000,\"byteLength\":4}", "/bufferViews/8/buffer"},
        {"/bufferViews/-", "{\"buffer\":20000,\"byteLength\":4}", "/bufferViews/8/buffer"},
        {"/bufferViews/-", "{\"buffer\":0,\"byteOffset\":2000000000,\"byteLength\":4}",
         "/bufferViews/8"},
        {"/bufferViews/-", "{\"buffer\":0,\"byteLength\":2147483647}", "/bufferViews/8"},
        {"/meshes/-", "{}", "/meshes/2/primitives"},
        {"/meshes/-", "{\"primitives\":[]}", "/meshes/2/primitives"},
        {"/meshes/-", "{\"primitives\":[{\"attributes\":{}}]}", "/meshes/2/primitives/0"},
        {"/meshes/-", "{\"primitives\":[{\"attributes\":{\"POSITION\":99}}]}",
         "/meshes/2/primitives/0/attributes/POSITION"},
        {"/meshes/0/primitives/-", "{\"attributes\":{\"POSITION\":99},\"mode\":0}",
         "/meshes/0/primitives/1/attributes/POSITION"},
        {"/meshes/0/primitives/-", "{\"attributes\":{\"NORMAL\":1},\"mode\":0}",
         "/meshes/0/primitives/1"},
        {"/meshes/1/primitives/-", "{\"attributes\":{\"POSITION\":0},\"mode\":0}",
         "/meshes/1/primitives/1"},
        {"/meshes/0/primitives/0/attributes/a~b", "99", "/meshes/0/primitives/0/attributes/a~0b"},
        {"/meshes/1/extras", "[]", NULL},
        {"/meshes/1/extras/targetNames", "\"smile\"", NULL},
        {"/meshes/1/weights", "[0,0,0]", NULL},
        {"/meshes/1/weights", "[\"much\"]", NULL},
        {"/nodes/2/weights", "[0,0]", NULL},
        {"/nodes/-", "{\"mesh\":9}", "/nodes/5/mesh"},
        {"/nodes/-", "{\"skin\":9}", "/nodes/5/skin"},
        {"/nodes/-", "{\"camera\":0}", "/nodes/5/camera"},
        {"/skins/-", "{\"joints\":[3,44]}", "/skins/1/joints/1"},
        {"/skins/0/skeleton", "77", NULL},
        {"/skins/-", "{\"joints\":[3],\"inverseBindMatrices\":77}", "/skins/1/inverseBindMatrices"},
        {"/scenes/-", "{\"nodes\":[77]}", "/scenes/1/nodes/0"},
        {"/textures/-", "{\"source\":7}", "/textures/1/source"},
        {"/textures/-", "{\"sampler\":0}", "/textures/1/sampler"},
        {"/images/-", "{\"bufferView\":77}", "/images/1/bufferView"},
        {"/materials/-", "{\"occlusionTexture\":{\"index\":8}}",
         "/materials/1/occlusionTexture/index"},
        {"/accessors/-",
         "{\"bufferView\":77,\"componentType\":5126,\"count\":1,\"type\":\"SCALAR\"}",
         "/accessors/8/bufferView"},
        {"/accessors/-", "{\"bufferView\":0,\"componentType\":5126,\"count\":26,\"type\":\"VEC3\"}",
         "/accessors/8"},
        {"/accessors/-",
         "{\"bufferView\":0,\"byteOffset\":2147483647,\"componentType\":5126,\"count\":1,"
         "\"type\":\"MAT3\"}",
         "/accessors/8"},
        {"/accessors/-",
         "{\"componentType\":5126,\"count\":9,\"type\":\"VEC3\",\"sparse\":{\"count\":9,"
         "\"indices\":{\"bufferView\":55,\"componentType\":5123},\"values\":{\"bufferView\":0}}}",
         "/accessors/8/sparse/indices/bufferView"},
        {"/animations/0/channels/0/sampler", "1", NULL},
        {"/animations/0/channels/0/target/node", "-1", NULL},
        {"/animations/0/samplers/0/input", "1e3", NULL},
        {"/animations/0/samplers/0/output", "\"none\"", NULL},
        {"/animations/-", "7", "/animations/1"},
        {"/animations", "{}", NULL},
    };
    char copy[160];
    snprintf(copy, sizeof copy, "%s/wrong.gltf", folder);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        error err = {""};
        mesh m, again;
        gltf_report with, without;
        const char *place = wrong[i].place ? wrong[i].place : wrong[i].pointer;
        json_t *root = json_load_file(source, 0, NULL);
        set_at(root, wrong[i].pointer, wrong[i].text);
        assert_int_equal(json_dump_file(root, copy, 0), 0);
        json_decref(root);
        if (mesh_file_read(&m, copy, NULL, &err) < 0)
            fail_msg("%s = %s is refused by the reader already: %s", wrong[i].pointer,
                     wrong[i].text, err.text);
        perform(&m, &with, &without);
        size_t length = strlen(place);
        if (strncmp(with.why_bare.text, place, length) != 0 || with.why_bare.text[length] != ' ')
            fail_msg("%s = %s: \"%s\"", wrong[i].pointer, wrong[i].text, with.why_bare.text);
        assert_int_equal(with.byte_count, without.byte_count);
        assert_int_equal(mesh_file_read(&again, whole, NULL, &err), MRT_OK);
        mesh_destroy(&again);
        mesh_destroy(&m);
    }
}

/* Small files that would take all memory: a large description shown by many nodes. */
static void copies_of_a_mesh_cost_no_more_than_its_file(void **state)
{
    (void)state;
    enum { NODES = 3000, LETTERS = 300000 };
    error err = {""};
    mesh m;
    gltf_report with;
    char copy[160], *text = calloc(LETTERS + 1, 1);
    json_t *root = json_load_file(source, 0, NULL);
    memset(text, 'a', LETTERS);
    json_object_set_new(json_array_get(json_object_get(root, "meshes"), 0), "name",
                        json_string(text));
    for (int i = 0; i < NODES; ++i) {
        set_at(root, "/nodes/-", "{\"mesh\":0}");
        json_array_append_new(
            json_object_get(json_array_get(json_object_get(root, "scenes"), 0), "nodes"),
            json_integer(5 + i));
    }
    snprintf(copy, sizeof copy, "%s/copies.gltf", folder);
    assert_int_equal(json_dump_file(root, copy, 0), 0);
    json_decref(root);
    free(text);
    if (mesh_file_read(&m, copy, NULL, &err) < 0)
        fail_msg("%s", err.text);
    clip *c = clip_create(&m, 30.0, NULL, &err);
    assert_int_equal(clip_add_free(c, m.position, &err), MRT_OK);
    assert_int_equal(gltf_write(whole, c, NULL, NULL, &with, &err), MRT_OK);
    assert_non_null(strstr(with.why_bare.text, "/meshes/0 is shown by many nodes: "));
    clip_destroy(c);
    mesh_destroy(&m);
}

/* What the file names by a link that leads out of its folder is not taken along; what it names
 * often is taken once. */
static void pictures_come_from_the_folder_alone_and_once(void **state)
{
    (void)state;
    error err = {""};
    mesh m;
    gltf_report with, without;
    char copy[160], other[] = "/tmp/marotte_export_picture_XXXXXX", link[160], command[512];
    assert_non_null(mkdtemp(other));
    snprintf(command, sizeof command,
             "cp %s %s/secret.png && ln -s %s/secret.png %s/link.png && printf "
             "'RIFF\\4\\0\\0\\0WEBPVP8 ' >%s/paint.webp",
             picture, other, other, folder, folder);
    assert_int_equal(system(command), 0);
    json_t *root = json_load_file(source, 0, NULL);
    set_at(root, "/images/-", "{\"uri\":\"link.png\"}");
    set_at(root, "/images/-", "{\"uri\":\"paint.png\"}");
    set_at(root, "/images/-", "{\"uri\":\"paint.webp\"}");
    snprintf(copy, sizeof copy, "%s/links.gltf", folder);
    assert_int_equal(json_dump_file(root, copy, 0), 0);
    json_decref(root);
    assert_int_equal(mesh_file_read(&m, copy, NULL, &err), MRT_OK);
    perform(&m, &with, &without);
    assert_string_equal(with.why_bare.text, "");
    json_t *after = json_of_glb(whole), *images = json_object_get(after, "images");
    json_t *first = json_array_get(images, 0), *again = json_array_get(images, 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(images, 1), "uri")),
                        "link.png");
    assert_true(json_equal(first, again));
    assert_string_equal(json_string_value(json_object_get(json_array_get(images, 3), "mimeType")),
                        "image/webp");
    json_decref(after);
    mesh_destroy(&m);
    snprintf(link, sizeof link, "%s/link.png", folder);
    assert_int_equal(unlink(link), 0);
    snprintf(command, sizeof command, "rm -rf %s", other);
    assert_int_equal(system(command), 0);
}

/* The file is another one by now: the mesh alone is written, and why is told. */
static void a_file_that_has_changed_is_not_used(void **state)
{
    (void)state;
    error err = {""};
    mesh m;
    gltf_report first, second;
    assert_int_equal(mesh_file_read(&m, source, NULL, &err), MRT_OK);
    m.position[0] += 50.0f;
    perform(&m, &first, &second);
    assert_non_null(strstr(first.why_bare.text, "differs from the performed mesh"));
    assert_int_equal(first.byte_count, second.byte_count);
    m.position[0] -= 50.0f;
    FILE *file = fopen(source, "wb");
    assert_true(file && fputs("{\"asset\":{}}", file) >= 0 && fclose(file) == 0);
    perform(&m, &first, &second);
    assert_true(first.why_bare.text[0] != '\0');
    assert_int_equal(unlink(source), 0);
    perform(&m, &first, &second);
    assert_non_null(strstr(first.why_bare.text, "No such file"));
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_target_moves_what_it_moves_in_the_bare_mesh),
        cmocka_unit_test(all_else_is_as_it_was),
        cmocka_unit_test(its_own_target_is_played_by_the_curve_of_its_name),
        cmocka_unit_test(what_cannot_be_carried_over_is_told_by_its_place),
        cmocka_unit_test(copies_of_a_mesh_cost_no_more_than_its_file),
        cmocka_unit_test(pictures_come_from_the_folder_alone_and_once),
        cmocka_unit_test(a_file_that_has_changed_is_not_used),
    };
    return cmocka_run_group_tests(tests, make_files, remove_files);
}
