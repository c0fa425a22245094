/* tests/unit/mesh_gltf_document.h - glTF documents for the tests of the reader: JSON written with
 * ' for ", and a buffer with a square, morph offsets, marks and normals. */
#ifndef MAROTTE_TESTS_MESH_GLTF_DOCUMENT_H
#define MAROTTE_TESTS_MESH_GLTF_DOCUMENT_H
#include "io/mesh_file.h"

#include <stdio.h>
#include <string.h>

typedef struct document_buffer { /* 156 bytes without gaps */
    float position[12];          /* at 0: the unit square */
    uint16_t index[6];           /* at 48 */
    uint16_t sparse_index[2];    /* at 60 */
    float sparse_value[6];       /* at 64: of vertices 1 and 3 */
    uint8_t mark[16];            /* at 88, one every 4 bytes */
    float normal[12];            /* at 104 */
    uint8_t unused[4];           /* at 152 */
} document_buffer;

static const document_buffer DOCUMENT_BUFFER = {
    .position = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0},
    .index = {0, 1, 2, 0, 2, 3},
    .sparse_index = {1, 3},
    .sparse_value = {0, 0, 0.5f, 0, 0, -0.5f},
    .mark = {0, 0, 0, 0, 51, 0, 0, 0, 102, 0, 0, 0, 255, 0, 0, 0},
    .normal = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}};

/* Accessors: 0 positions, 1 indices, 2 sparse offsets on zeros, 3 marks, 4 normals. */
#define DOCUMENT_DATA                                                                              \
    "'asset':{'version':'2.0'},"                                                                   \
    "'buffers':[{'byteLength':156}],"                                                              \
    "'bufferViews':[{'buffer':0,'byteLength':48},"                                                 \
    "{'buffer':0,'byteOffset':48,'byteLength':12},"                                                \
    "{'buffer':0,'byteOffset':60,'byteLength':4},"                                                 \
    "{'buffer':0,'byteOffset':64,'byteLength':24},"                                                \
    "{'buffer':0,'byteOffset':88,'byteLength':16,'byteStride':4},"                                 \
    "{'buffer':0,'byteOffset':104,'byteLength':48}],"                                              \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"                  \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                             \
    "{'componentType':5126,'count':4,'type':'VEC3','sparse':{'count':2,"                           \
    "'indices':{'bufferView':2,'componentType':5123},'values':{'bufferView':3}}},"                 \
    "{'bufferView':4,'componentType':5121,'normalized':true,'count':4,'type':'SCALAR'},"           \
    "{'bufferView':5,'componentType':5126,'count':4,'type':'VEC3'}],"

/* One node "head" with everything. */
#define DOCUMENT_HEAD                                                                              \
    "'materials':[{'name':'skin','pbrMetallicRoughness':{'baseColorFactor':[1,0.5,0.25,1],"        \
    "'roughnessFactor':0.5,'metallicFactor':0}}],"                                                 \
    "'meshes':[{'name':'face','primitives':[{'attributes':{'POSITION':0,'NORMAL':4,'_MARK':3},"    \
    "'indices':1,'material':0,'targets':[{'POSITION':2}]}],"                                       \
    "'weights':[0],'extras':{'targetNames':['smile']}}],"                                          \
    "'nodes':[{'mesh':0,'name':'head'}],'scenes':[{'nodes':[0]}],'scene':0"

typedef struct document {
    unsigned char bytes[8192];
    size_t size;
} document;

static inline void document_put_u32(document *d, size_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        d->bytes[d->size++] = (unsigned char)(value >> shift);
}

static inline void document_put_json(document *d, const char *json)
{
    for (; *json; ++json)
        d->bytes[d->size++] = *json == '\'' ? '"' : (unsigned char)*json;
}

/* A .glb from the inside of the JSON object and any bytes for BIN. */
static inline document document_glb_of(const char *json, const void *binary, size_t binary_size)
{
    document d = {.size = 0};
    size_t json_size = (strlen(json) + 2 + 3) / 4 * 4;
    size_t padded_size = (binary_size + 3) / 4 * 4;
    document_put_json(&d, "glTF");
    document_put_u32(&d, 2);
    document_put_u32(&d, 12 + 8 + json_size + (binary_size ? 8 + padded_size : 0));
    document_put_u32(&d, json_size);
    document_put_json(&d, "JSON{");
    document_put_json(&d, json);
    document_put_json(&d, "}");
    while (d.size % 4)
        d.bytes[d.size++] = ' ';
    if (binary_size) {
        document_put_u32(&d, padded_size);
        document_put_u32(&d, 0x004e4942);
        memcpy(d.bytes + d.size, binary, binary_size);
        d.size += padded_size;
    }
    return d;
}

static inline document document_glb(const char *json)
{
    return document_glb_of(json, &DOCUMENT_BUFFER, sizeof DOCUMENT_BUFFER);
}

/* The same as .gltf with the buffer as a data URI. */
static inline document document_gltf(const char *rest)
{
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    static const char data[] = DOCUMENT_DATA, mark[] = "'byteLength':156";
    document d = {.size = 0};
    const unsigned char *from = (const unsigned char *)&DOCUMENT_BUFFER;
    const char *at = strstr(data, mark);
    d.bytes[d.size++] = '{';
    for (const char *c = data; c < at; ++c)
        d.bytes[d.size++] = *c == '\'' ? '"' : (unsigned char)*c;
    document_put_json(&d, "'uri':'data:application/octet-stream;base64,");
    for (size_t i = 0; i < sizeof DOCUMENT_BUFFER; i += 3) {
        unsigned group = (unsigned)from[i] << 16 | (unsigned)from[i + 1] << 8 | from[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6)
            d.bytes[d.size++] = (unsigned char)digit[group >> shift & 63];
    }
    document_put_json(&d, "',");
    document_put_json(&d, at);
    document_put_json(&d, rest);
    document_put_json(&d, "}");
    return d;
}

#endif
