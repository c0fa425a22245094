/* tests/unit/mesh_looks.c - how a glTF head looks: materials, textures and their coordinates,
 * vertex colours, VRM's toon; pictures inside, beside and missing; hostile ones are told, never
 * fatal. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "mesh_gltf_document.h"

#include "base/file.h"
#include "io/read/mesh_images.h"
#include "mesh/topology.h"

#include <math.h>
#include <stdlib.h>
#include <unistd.h>

#define SEEDS SOURCE_DIR "/tests/fuzz/seeds/image/" /* one byte, then the picture */

typedef struct looks_buffer { /* 2048 bytes */
    float position[12];       /* at 0 */
    float uv[8];              /* at 48 */
    float uv_more[8];         /* at 80 */
    uint8_t colour[16];       /* at 112: normalised */
    uint16_t index[6];        /* at 128 */
    uint8_t picture[1908];    /* at 140 */
} looks_buffer;

static looks_buffer buffer;
static size_t picture_size;

static void set_picture(const char *seed)
{
    file_bytes bytes;
    error err;
    char path[512];
    (void)snprintf(path, sizeof path, SEEDS "%s", seed);
    assert_int_equal(file_read(&bytes, path, sizeof buffer.picture, &err), MRT_OK);
    picture_size = bytes.size - 1;
    memcpy(buffer.picture, bytes.data + 1, picture_size);
    file_bytes_finish(&bytes);
}

static int make_buffer(void **state)
{
    (void)state;
    buffer =
        (looks_buffer){.position = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0},
                       .uv = {0, 1, 1, 1, 1, 0, 0, 0},
                       .uv_more = {0, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0},
                       .colour = {255, 0, 0, 255, 0, 255, 0, 51, 0, 0, 255, 0, 255, 255, 255, 255},
                       .index = {0, 1, 2, 0, 2, 3}};
    set_picture("a.png");
    return setenv("MAROTTE_MESHLOAD", BUILD_DIR "/marotte-meshload", 1);
}

/* `rest`: materials, textures and so on; `primitive`: members of the one primitive's attributes. */
static mrt_result parse(mesh *out, const char *primitive, const char *rest, const char *directory,
                        error *err)
{
    char json[5000];
    (void)snprintf(
        json, sizeof json,
        "'asset':{'version':'2.0'},'buffers':[{'byteLength':2048}],'bufferViews':["
        "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':32},"
        "{'buffer':0,'byteOffset':80,'byteLength':32},{'buffer':0,'byteOffset':112,'byteLength':16}"
        ","
        "{'buffer':0,'byteOffset':128,'byteLength':12},"
        "{'buffer':0,'byteOffset':140,'byteLength':%zu}],'accessors':["
        "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
        "{'bufferView':1,'componentType':5126,'count':4,'type':'VEC2'},"
        "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'},"
        "{'bufferView':3,'componentType':5121,'normalized':true,'count':4,'type':'VEC4'},"
        "{'bufferView':4,'componentType':5123,'count':6,'type':'SCALAR'}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0%s},'indices':4,'material':0}]}],"
        "'nodes':[{'mesh':0}],%s",
        picture_size, primitive, rest);
    document d = document_glb_of(json, &buffer, sizeof buffer);
    return gltf_parse(out, d.bytes, d.size, directory, err);
}

static mesh read_good(const char *primitive, const char *rest)
{
    mesh m;
    error err = {""};
    if (parse(&m, primitive, rest, NULL, &err) < 0)
        fail_msg("%s", err.text);
    assert_int_equal(mesh_validate(&m, &err), MRT_OK);
    return m;
}

#define PICTURE ",'textures':[{'source':0}],'images':[{'name':'face','bufferView':5}]"

static void a_material_keeps_what_it_says(void **state)
{
    (void)state;
    mesh m = read_good(
        ",'TEXCOORD_0':1",
        "'materials':[{'name':'skin','alphaMode':'MASK','alphaCutoff':0.25,'doubleSided':true,"
        "'emissiveFactor':[0.5,0,1],'pbrMetallicRoughness':{'metallicFactor':0.25,"
        "'baseColorFactor':[1,0.5,0.25,0.75],'baseColorTexture':{'index':0,'extensions':"
        "{'KHR_texture_transform':{'offset':[0.5,0.25],'scale':[2,3],'rotation':0}}}},"
        "'normalTexture':{'index':1,'scale':0.5},"
        "'extensions':{'KHR_materials_emissive_strength':{'emissiveStrength':2}}}],"
        "'textures':[{'source':0,'sampler':0},{'source':0}],"
        "'samplers':[{'wrapS':33071,'wrapT':33648}],"
        "'images':[{'name':'face','mimeType':'image/png','bufferView':5}]");
    const mesh_material *look = &m.material[0];
    assert_int_equal(look->alpha, MESH_ALPHA_MASK);
    assert_true(look->alpha_cutoff == 0.25f && look->base_colour[3] == 0.75f);
    assert_false(look->is_single_sided);
    assert_false(look->has_roughness);
    assert_true(look->roughness == 1.0f && look->metallic == 0.25f);
    assert_true(look->emission_colour[0] == 1.0f && look->emission_colour[2] == 2.0f);
    assert_true(look->base.image == 1 && look->normal.image == 1 && look->emission.image == 0);
    assert_true(look->normal_scale == 0.5f);
    assert_int_equal(look->base.wrap[0], MESH_WRAP_CLAMP);
    assert_int_equal(look->base.wrap[1], MESH_WRAP_MIRROR);
    static const float uv_transform[6] = {2, 0, 0.5f, 0, 3, 0.25f};
    for (int i = 0; i < 6; ++i)
        assert_true(fabsf(look->base.uv_transform[i] - uv_transform[i]) < 1e-6f);
    assert_int_equal(m.image_count, 1);
    assert_string_equal(m.image[0].name, "face");
    assert_int_equal(m.image[0].encoded_size, picture_size);
    assert_memory_equal(m.uv, buffer.uv, sizeof buffer.uv);
    assert_null(m.colour);
    assert_null(m.note);
    mesh_destroy(&m);
}

static void opaque_is_opaque_and_one_sided(void **state)
{
    (void)state;
    mesh m = read_good("", "'materials':[{'pbrMetallicRoughness':{'roughnessFactor':0.9,"
                           "'baseColorFactor':[1,1,1,0.5]}}]");
    assert_true(m.material[0].base_colour[3] == 1.0f);
    assert_true(m.material[0].is_single_sided && m.material[0].has_roughness);
    assert_null(m.uv);
    mesh_destroy(&m);
}

static void colours_and_other_coordinates_are_read(void **state)
{
    (void)state;
    mesh m = read_good(",'TEXCOORD_0':1,'TEXCOORD_1':2,'COLOR_0':3",
                       "'materials':[{'name':'skin','pbrMetallicRoughness':{'baseColorTexture':"
                       "{'index':0,'texCoord':1}},'normalTexture':{'index':0},'emissiveTexture':"
                       "{'index':0,'texCoord':1}}]" PICTURE);
    assert_memory_equal(m.uv, buffer.uv_more, sizeof buffer.uv_more);
    assert_true(m.colour[0] == 1.0f && m.colour[1] == 0.0f && m.colour[7] == 0.2f);
    assert_true(m.material[0].base.image == 1 && m.material[0].emission.image == 1);
    assert_int_equal(m.material[0].normal.image, 0);
    assert_non_null(strstr(m.note,
                           "material \"skin\": its normal map is not drawn: it uses texture "
                           "coordinates 0, the other textures use 1"));
    mesh copy;
    error err;
    assert_int_equal(mesh_copy(&copy, &m, &err), MRT_OK);
    mesh_destroy(&m);
    assert_int_equal(mesh_validate(&copy, &err), MRT_OK);
    assert_true(copy.colour[7] == 0.2f && copy.image[0].encoded_size == picture_size);
    mesh_destroy(&copy);
}

/* Without a base texture, the first other texture chooses the coordinates. */
static void any_texture_may_use_the_second_coordinates(void **state)
{
    (void)state;
    static const char *const materials[] = {
        "'normalTexture':{'index':0,'texCoord':1}",
        "'pbrMetallicRoughness':{'metallicRoughnessTexture':{'index':0,'texCoord':1}}",
        "'emissiveTexture':{'index':0,'texCoord':1}",
        "'emissiveTexture':{'index':0,'extensions':{'KHR_texture_transform':{'texCoord':1}}}"};
    for (size_t i = 0; i < sizeof materials / sizeof *materials; ++i) {
        char rest[512];
        (void)snprintf(rest, sizeof rest, "'materials':[{%s}]" PICTURE, materials[i]);
        mesh m = read_good(",'TEXCOORD_0':1,'TEXCOORD_1':2", rest);
        const mesh_material *look = &m.material[0];
        assert_int_equal(look->normal.image + look->surface.image + look->emission.image, 1);
        assert_memory_equal(m.uv, buffer.uv_more, sizeof buffer.uv_more);
        assert_null(m.note);
        mesh_destroy(&m);
    }
}

/* Of vertex 1, in the floats of TEXCOORD_1. */
static void a_colour_that_is_not_a_number_is_white(void **state)
{
    (void)state;
    static const float colour[8] = {0.5f, 0.25f, 0, 1, 0, NAN, INFINITY, 0.5f};
    memcpy(buffer.uv_more, colour, sizeof colour);
    mesh m;
    error err = {""};
    char json[2000];
    (void)snprintf(json, sizeof json,
                   "'asset':{'version':'2.0'},'buffers':[{'byteLength':2048}],'bufferViews':["
                   "{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':80,'byteLength':32,"
                   "'byteStride':16}],'accessors':["
                   "{'bufferView':0,'componentType':5126,'count':2,'type':'VEC3'},"
                   "{'bufferView':1,'componentType':5126,'count':2,'type':'VEC4'},"
                   "{'bufferView':0,'byteOffset':8,'componentType':5123,'count':3,"
                   "'type':'SCALAR'}],"
                   "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'COLOR_0':1},"
                   "'indices':2}]}],'nodes':[{'mesh':0}]");
    document d = document_glb_of(json, &buffer, sizeof buffer);
    if (gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0)
        fail_msg("%s", err.text);
    static const float expected[8] = {0.5f, 0.25f, 0, 1, 1, 1, 1, 1};
    assert_memory_equal(m.colour, expected, sizeof expected);
    assert_non_null(strstr(m.note, "the colours of 1 vertices are not numbers"));
    mesh_destroy(&m);
    static const float coordinates[8] = {0, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0};
    memcpy(buffer.uv_more, coordinates, sizeof coordinates);
}

static void of_many_lost_textures_some_are_named_and_the_others_counted(void **state)
{
    (void)state;
    enum { MATERIALS = 12 };
    char json[6000];
    mesh m;
    error err = {""};
    int used = snprintf(json, sizeof json,
                        "'asset':{'version':'2.0'},'buffers':[{'byteLength':2048}],'bufferViews':["
                        "{'buffer':0,'byteLength':48}],'accessors':[{'bufferView':0,"
                        "'componentType':5126,'count':3,'type':'VEC3'}],'textures':[{}],"
                        "'nodes':[{'mesh':0}],'materials':[{}");
    for (int i = 1; i < MATERIALS; ++i)
        used += snprintf(json + used, sizeof json - (size_t)used,
                         ",{'normalTexture':{'index':0},'emissiveTexture':{'index':0,'texCoord':1},"
                         "'pbrMetallicRoughness':{'metallicRoughnessTexture':{'index':0,"
                         "'texCoord':2}}}");
    used += snprintf(json + used, sizeof json - (size_t)used, "],'meshes':[{'primitives':[");
    for (int i = 0; i < MATERIALS; ++i)
        used += snprintf(json + used, sizeof json - (size_t)used,
                         "%s{'attributes':{'POSITION':0},'material':%d}", i ? "," : "", i);
    (void)snprintf(json + used, sizeof json - (size_t)used, "]}]");
    document d = document_glb_of(json, &buffer, sizeof buffer);
    if (gltf_parse(&m, d.bytes, d.size, NULL, &err) < 0)
        fail_msg("%s", err.text);
    assert_non_null(strstr(m.note, "material \"\": its picture is missing"));
    assert_non_null(strstr(m.note, "its emission texture is not drawn: it uses texture coordinates "
                                   "1, the other textures use 0"));
    assert_non_null(strstr(m.note, "\n17 more textures of its materials are not drawn"));
    mesh_destroy(&m);
}

static void toon_and_unlit_are_known(void **state)
{
    (void)state;
    mesh m = read_good("", "'materials':[{'extensions':{'KHR_materials_unlit':{}}}]");
    assert_int_equal(m.material[0].lighting, MESH_LIGHTING_NONE);
    mesh_destroy(&m);
    m = read_good("", "'materials':[{'extensions':{'KHR_materials_unlit':{},'VRMC_materials_mtoon':"
                      "{'shadeColorFactor':[0.5,0.25,0],'shadingShiftFactor':-0.2,"
                      "'shadingToonyFactor':0.8}}}]");
    assert_int_equal(m.material[0].lighting, MESH_LIGHTING_TOON);
    assert_true(m.material[0].shade_colour[1] == 0.25f && m.material[0].shade_toony == 0.8f);
    mesh_destroy(&m);
    m = read_good("", "'materials':[{}],'extensions':{'VRM':{'materialProperties':[{'shader':"
                      "'VRM/MToon','floatProperties':{'_ShadeShift':0,'_ShadeToony':0.5},"
                      "'vectorProperties':{'_ShadeColor':[1,0.5,0,1]}}]}}");
    assert_int_equal(m.material[0].lighting, MESH_LIGHTING_TOON);
    assert_true(fabsf(m.material[0].shade_colour[1] - 0.2140f) < 1e-3f); /* sRGB 0.5 */
    assert_true(fabsf(m.material[0].shade_toony - 0.75f) < 1e-6f);
    assert_true(fabsf(m.material[0].shade_shift + 0.25f) < 1e-6f);
    mesh_destroy(&m);
}

static void pictures_are_decoded_in_the_child(void **state)
{
    (void)state;
    static const struct {
        const char *seed;
        uint32_t width, height;
    } cases[] = {{"a.png", 24, 16}, {"a.jpg", 24, 16},  {"b.png", 9, 7},    {"c.png", 9, 7},
                 {"d.png", 24, 16}, {"a.webp", 24, 16}, {"b.webp", 24, 16}, {"c.webp", 12, 10}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        set_picture(cases[i].seed);
        mesh m = read_good(",'TEXCOORD_0':1", "'materials':[{'pbrMetallicRoughness':{"
                                              "'baseColorTexture':{'index':0}}}]" PICTURE);
        mesh_images_decode(&m);
        assert_null(m.note);
        assert_null(m.image[0].encoded);
        assert_int_equal(m.image[0].width, cases[i].width);
        assert_int_equal(m.image[0].height, cases[i].height);
        assert_int_equal(m.image[0].rgba[7], 255);
        mesh_destroy(&m);
    }
    set_picture("a.png");
}

/* b.webp was written from a.png without loss. */
static void a_webp_has_the_pixels_of_its_png(void **state)
{
    (void)state;
    static const char rest[] = "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':"
                               "{'index':0}}}]" PICTURE;
    mesh png = read_good(",'TEXCOORD_0':1", rest);
    mesh_images_decode(&png);
    set_picture("b.webp");
    mesh webp = read_good(",'TEXCOORD_0':1", rest);
    mesh_images_decode(&webp);
    assert_null(webp.note);
    assert_memory_equal(webp.image[0].rgba, png.image[0].rgba, 24 * 16 * 4);
    mesh_destroy(&webp);
    mesh_destroy(&png);
    set_picture("c.webp");
    webp = read_good(",'TEXCOORD_0':1", rest);
    mesh_images_decode(&webp);
    assert_int_equal(webp.image[0].rgba[3], 51);
    mesh_destroy(&webp);
    set_picture("a.png");
}

/* A texture may name its picture in one extension, in several, or besides. */
static void a_texture_takes_the_picture_that_can_be_read(void **state)
{
    (void)state;
    static const struct {
        const char *textures, *image;
    } cases[] = {
        {"'textures':[{'extensions':{'EXT_texture_webp':{'source':1}}}]", "webp"},
        {"'textures':[{'source':0,'extensions':{'EXT_texture_webp':{'source':1}}}]", "png"},
        {"'textures':[{'extensions':{'KHR_texture_basisu':{'source':2},'EXT_texture_avif':"
         "{'source':2},'EXT_texture_webp':{'source':1}}}]",
         "webp"},
        {"'textures':[{'source':0,'extensions':{'KHR_texture_basisu':{'source':2}}}]", "png"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char rest[1024];
        (void)snprintf(rest, sizeof rest,
                       "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}],"
                       "'extensionsRequired':['EXT_texture_webp'],'images':["
                       "{'name':'png','mimeType':'image/png','bufferView':5},"
                       "{'name':'webp','mimeType':'image/webp','bufferView':5},"
                       "{'name':'ktx2','mimeType':'image/ktx2','bufferView':5}],%s",
                       cases[i].textures);
        mesh m = read_good(",'TEXCOORD_0':1", rest);
        assert_int_equal(m.material[0].base.image, 1);
        assert_string_equal(m.image[0].name, cases[i].image);
        assert_null(m.note);
        mesh_destroy(&m);
    }
}

/* The smallest WebP: one white pixel, without loss. */
static void a_data_uri_may_be_webp(void **state)
{
    (void)state;
    mesh m = read_good(",'TEXCOORD_0':1",
                       "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}],"
                       "'textures':[{'extensions':{'EXT_texture_webp':{'source':0}}}],'images':["
                       "{'uri':'data:image/webp;base64,"
                       "UklGRh4AAABXRUJQVlA4TBEAAAAvAAAAAAfQ//73v/+BiOh/AAA='}]");
    mesh_images_decode(&m);
    assert_null(m.note);
    assert_int_equal(m.image[0].width, 1);
    assert_string_equal(m.image[0].name, "images[0]");
    mesh_destroy(&m);
}

/* A head without its picture and one sentence. */
static void a_picture_that_cannot_be_had_is_told(void **state)
{
    (void)state;
    static const struct {
        const char *textures, *note;
    } cases[] = {
        {"'textures':[{'source':0}],'images':[{'uri':'missing.png'}]",
         "the picture \"missing.png\" is not drawn: "},
        {"'textures':[{'source':0}],'images':[{'uri':'../../etc/passwd'}]", "is not drawn: "},
        {"'textures':[{'source':0}],'images':[{'uri':'/etc/passwd'}]", "only files beside"},
        {"'textures':[{'source':0}],'images':[{'uri':'http://a/b.png'}]", "only files beside"},
        {"'textures':[{'source':0}],'images':[{'uri':'data:image/png;base64,'}]", "data URI"},
        {"'textures':[{'source':0}],'images':[{'bufferView':99}]", "bufferView does not exist"},
        {"'textures':[{'source':7}]", "its picture is missing"},
        {"'textures':[{}]", "its picture is missing"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        char rest[1024];
        mesh m;
        error err = {""};
        (void)snprintf(rest, sizeof rest,
                       "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}],%s",
                       cases[i].textures);
        if (parse(&m, ",'TEXCOORD_0':1", rest, SOURCE_DIR "/rigs/", &err) < 0)
            fail_msg("%zu: %s", i, err.text);
        assert_int_equal(m.material[0].base.image, 0);
        if (!m.note || !strstr(m.note, cases[i].note))
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, m.note, cases[i].note);
        mesh_destroy(&m);
    }
}

static void of_many_pictures_that_cannot_be_had_one_is_told_and_the_others_counted(void **state)
{
    (void)state;
    mesh m;
    error err = {""};
    assert_int_equal(parse(&m, ",'TEXCOORD_0':1",
                           "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0}},"
                           "'emissiveTexture':{'index':1},'normalTexture':{'index':2}}],"
                           "'textures':[{'source':0},{'source':1},{'source':2}],"
                           "'images':[{'uri':'a.png'},{'uri':'b.png'},{'uri':'c.png'}]",
                           SOURCE_DIR "/rigs/", &err),
                     MRT_OK);
    mesh_images_decode(&m);
    const char *first = strstr(m.note, "the picture \"");
    assert_non_null(first);
    assert_null(strstr(first + 1, "the picture \""));
    assert_non_null(strstr(m.note, "\n2 more of its pictures are not drawn\n"));
    mesh_destroy(&m);
}

static mesh decode_of(const void *bytes, size_t size)
{
    memcpy(buffer.picture, bytes, size);
    picture_size = size;
    mesh m = read_good(",'TEXCOORD_0':1", "'materials':[{'pbrMetallicRoughness':{"
                                          "'baseColorTexture':{'index':0}}}]" PICTURE);
    mesh_images_decode(&m);
    return m;
}

static void damaged_and_foreign_pictures_are_told(void **state)
{
    (void)state;
    static const char ktx2[] = "\xabKTX 20\xbb\r\n\x1a\n1234", webp[] = "RIFF1234WEBPVP8 ";
    static const char avif[] = "\0\0\0\x1c"
                               "ftypavif\0\0\0\0";
    mesh m = decode_of(ktx2, sizeof ktx2);
    assert_non_null(strstr(m.note, "the picture \"face\" is not drawn: it is KTX2"));
    assert_non_null(strstr(m.note, "gltf-transform ktxdecompress"));
    assert_null(m.image[0].rgba);
    mesh_destroy(&m);
    m = decode_of(webp, sizeof webp);
    assert_non_null(strstr(m.note, "the WebP is damaged"));
    assert_null(m.image[0].rgba);
    mesh_destroy(&m);
    m = decode_of(avif, sizeof avif);
    assert_non_null(strstr(m.note, "AVIF is not read"));
    mesh_destroy(&m);
    m = decode_of("GIF89a", 6);
    assert_non_null(strstr(m.note, "not PNG, JPEG or WebP"));
    mesh_destroy(&m);
    static uint8_t whole[2048];
    set_picture("d.webp");
    memcpy(whole, buffer.picture, picture_size);
    m = decode_of(whole, picture_size);
    assert_null(m.image[0].rgba);
    assert_non_null(strstr(m.note, "an animated WebP"));
    mesh_destroy(&m);
    static const char *const seeds[] = {"a.png", "a.jpg", "a.webp", "b.webp", "c.webp"};
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; ++i) {
        set_picture(seeds[i]);
        size_t size = picture_size;
        memcpy(whole, buffer.picture, size);
        for (size_t part = 1; part < 8; ++part) {
            m = decode_of(whole, size * part / 8);
            assert_true(m.image[0].rgba || m.note);
            mesh_destroy(&m);
        }
        if (i > 1) /* a WebP has at most 16 383 pixels a side */
            continue;
        /* 60 000 pixels a side: refused before there is memory for it. */
        uint8_t huge[2048];
        memcpy(huge, whole, size);
        if (i == 0)
            memcpy(huge + 16, "\0\0\xea\x60\0\0\xea\x60", 8);
        else
            for (size_t at = 0; at + 9 < size; ++at)
                if (huge[at] == 0xff && huge[at + 1] == 0xc0)
                    memcpy(huge + at + 5, "\xea\x60\xea\x60", 4);
        m = decode_of(huge, size);
        assert_null(m.image[0].rgba);
        assert_non_null(m.note);
        mesh_destroy(&m);
    }
    set_picture("a.png");
}

static void nonsense_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *primitive, *rest, *reason;
    } cases[] = {{",'TEXCOORD_0':0", "'materials':[{}]", "TEXCOORD"},
                 {",'TEXCOORD_0':77", "'materials':[{}]", "accessor 77"},
                 {",'COLOR_0':1", "'materials':[{}]", "COLOR_0"},
                 {"", "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':5}}}]",
                  "texture 5"},
                 {"", "'materials':[{'normalTexture':{'index':-1}}]", "whole number"},
                 {"", "'materials':[{'emissiveFactor':[1,2]}]", "must have 3 numbers"},
                 {"", "'materials':[{}],'images':[{'uri':7}]", "must be a string"},
                 {"", "'materials':[{}],'textures':[{'source':1.5}]", "whole number"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        mesh m;
        error err = {""};
        if (parse(&m, cases[i].primitive, cases[i].rest, NULL, &err) >= 0 ||
            !strstr(err.text, cases[i].reason))
            fail_msg("%zu: \"%s\" does not say \"%s\"", i, err.text, cases[i].reason);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_material_keeps_what_it_says),
        cmocka_unit_test(opaque_is_opaque_and_one_sided),
        cmocka_unit_test(colours_and_other_coordinates_are_read),
        cmocka_unit_test(any_texture_may_use_the_second_coordinates),
        cmocka_unit_test(a_colour_that_is_not_a_number_is_white),
        cmocka_unit_test(of_many_lost_textures_some_are_named_and_the_others_counted),
        cmocka_unit_test(toon_and_unlit_are_known),
        cmocka_unit_test(pictures_are_decoded_in_the_child),
        cmocka_unit_test(a_webp_has_the_pixels_of_its_png),
        cmocka_unit_test(a_texture_takes_the_picture_that_can_be_read),
        cmocka_unit_test(a_data_uri_may_be_webp),
        cmocka_unit_test(a_picture_that_cannot_be_had_is_told),
        cmocka_unit_test(of_many_pictures_that_cannot_be_had_one_is_told_and_the_others_counted),
        cmocka_unit_test(damaged_and_foreign_pictures_are_told),
        cmocka_unit_test(nonsense_is_refused),
    };
    return cmocka_run_group_tests(tests, make_buffer, NULL);
}
