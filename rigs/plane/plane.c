/* rigs/plane/plane.c - generate_plane: the planar models of the paper's Table 1 as binary PLY
 * files. A square of side 66.12 mm around the origin in the plane z = 0, +z its front: three plain
 * grids, and one whose quads have a centre vertex. */
#include "base/file.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const double SIDE_MM = 66.12;

typedef enum split { SPLIT_DIAGONAL, SPLIT_CENTRE } split;

typedef struct plane {
    uint32_t triangle_count;
    uint32_t quads_per_side;
    split split;
} plane;

static const plane PLANES[] = {
    {2048, 32, SPLIT_DIAGONAL},
    {8192, 64, SPLIT_DIAGONAL},
    {32768, 128, SPLIT_DIAGONAL},
    {65536, 128, SPLIT_CENTRE},
};

static const plane *plane_named(const char *triangle_count)
{
    for (size_t i = 0; i < sizeof PLANES / sizeof PLANES[0]; ++i) {
        char name[16];
        (void)snprintf(name, sizeof name, "%" PRIu32, PLANES[i].triangle_count);
        if (strcmp(name, triangle_count) == 0)
            return &PLANES[i];
    }
    return NULL;
}

static uint32_t plane_vertex_count(const plane *p)
{
    uint32_t row = p->quads_per_side + 1;
    uint32_t centres = p->split == SPLIT_CENTRE ? p->quads_per_side * p->quads_per_side : 0;
    return row * row + centres;
}

static void put_u32(FILE *stream, uint32_t value)
{
    unsigned char byte[4] = {(unsigned char)(value & 0xff), (unsigned char)(value >> 8 & 0xff),
                             (unsigned char)(value >> 16 & 0xff), (unsigned char)(value >> 24)};
    (void)fwrite(byte, 1, sizeof byte, stream);
}

static void put_f32(FILE *stream, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_u32(stream, bits);
}

/* The coordinate at `half_steps` half quads from the low side; exactly odd about the middle. */
static float coordinate_mm(const plane *p, uint32_t half_steps)
{
    double from_middle = (double)half_steps - (double)p->quads_per_side;
    return (float)(from_middle * SIDE_MM / (2.0 * p->quads_per_side));
}

static void put_vertex(FILE *stream, const plane *p, uint32_t half_column, uint32_t half_row)
{
    put_f32(stream, coordinate_mm(p, half_column));
    put_f32(stream, coordinate_mm(p, half_row));
    put_f32(stream, 0.0f);
}

static void put_triangle(FILE *stream, uint32_t a, uint32_t b, uint32_t c)
{
    (void)fputc(3, stream);
    put_u32(stream, a);
    put_u32(stream, b);
    put_u32(stream, c);
}

static void put_header(FILE *stream, const plane *p)
{
    (void)fprintf(stream,
                  "ply\n"
                  "format binary_little_endian 1.0\n"
                  "comment mm\n"
                  "element vertex %" PRIu32 "\n"
                  "property float x\n"
                  "property float y\n"
                  "property float z\n"
                  "element face %" PRIu32 "\n"
                  "property list uchar int vertex_indices\n"
                  "end_header\n",
                  plane_vertex_count(p), p->triangle_count);
}

/* The corners row by row from the low side, then the centres in the same order. */
static void put_vertices(FILE *stream, const plane *p)
{
    for (uint32_t row = 0; row <= p->quads_per_side; ++row)
        for (uint32_t column = 0; column <= p->quads_per_side; ++column)
            put_vertex(stream, p, 2 * column, 2 * row);
    if (p->split != SPLIT_CENTRE)
        return;
    for (uint32_t row = 0; row < p->quads_per_side; ++row)
        for (uint32_t column = 0; column < p->quads_per_side; ++column)
            put_vertex(stream, p, 2 * column + 1, 2 * row + 1);
}

static void put_quad(FILE *stream, const plane *p, uint32_t column, uint32_t row)
{
    uint32_t stride = p->quads_per_side + 1;
    uint32_t a = row * stride + column, b = a + 1, c = b + stride, d = a + stride;
    if (p->split == SPLIT_DIAGONAL) {
        put_triangle(stream, a, b, c);
        put_triangle(stream, a, c, d);
        return;
    }
    uint32_t centre = stride * stride + row * p->quads_per_side + column;
    put_triangle(stream, a, b, centre);
    put_triangle(stream, b, c, centre);
    put_triangle(stream, c, d, centre);
    put_triangle(stream, d, a, centre);
}

static mrt_result plane_write(const plane *p, const char *path, error *err)
{
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result < 0)
        return result;
    put_header(writer.stream, p);
    put_vertices(writer.stream, p);
    for (uint32_t row = 0; row < p->quads_per_side; ++row)
        for (uint32_t column = 0; column < p->quads_per_side; ++column)
            put_quad(writer.stream, p, column, row);
    return file_writer_commit(&writer, err);
}

int main(int argc, char **argv)
{
    const plane *p = argc == 3 ? plane_named(argv[1]) : NULL;
    if (!p) {
        (void)fputs("usage: generate_plane 2048|8192|32768|65536 OUT.ply\n", stderr);
        return 2;
    }
    error err = {0};
    if (plane_write(p, argv[2], &err) < 0) {
        (void)fprintf(stderr, "generate_plane: %s\n", err.text);
        return 1;
    }
    return EXIT_SUCCESS;
}
