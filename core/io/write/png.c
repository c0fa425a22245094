#include "base/file.h"
#include "io/export.h"

#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <string.h>

enum {
    MAX_SIDE = 32768,
    LEVEL = 2 /* zlib level: with these filters the files are small and fast to write */
};

/* Error handler of libpng; must not return. */
static void on_error(png_structp png, png_const_charp message)
{
    error *why = png_get_error_ptr(png);
    (void)error_set(why, MRT_ERR_IO, "%s", message);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* Replaces libpng's own function, whose error message has no reason. */
static void write_bytes(png_structp png, png_bytep bytes, png_size_t size)
{
    if (fwrite(bytes, 1, size, png_get_io_ptr(png)) != size)
        png_error(png, strerror(errno));
}

static void keep_bytes(png_structp png)
{
    (void)png; /* the file is flushed when it is complete */
}

static void write_rows(png_structp png, png_infop info, const uint8_t *rgba, uint32_t width,
                       uint32_t height, png_kind kind)
{
    png_set_IHDR(png, info, width, height, 8,
                 kind == PNG_OPAQUE ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_compression_level(png, LEVEL);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_write_info(png, info);
    if (kind == PNG_OPAQUE)
        png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (uint32_t y = 0; y < height; ++y)
        png_write_row(png, rgba + (size_t)y * width * 4);
    png_write_end(png, info);
}

static bool write_stream(FILE *stream, const uint8_t *rgba, uint32_t width, uint32_t height,
                         png_kind kind, error *why)
{
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, why, on_error, on_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        return false;
    }
    if (setjmp(png_jmpbuf(png)) != 0) {
        png_destroy_write_struct(&png, &info);
        return false;
    }
    png_set_write_fn(png, stream, write_bytes, keep_bytes);
    write_rows(png, info, rgba, width, height, kind);
    png_destroy_write_struct(&png, &info);
    return true;
}

mrt_result png_write_as(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                        png_kind kind, error *err)
{
    if (width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: a picture of %u by %u: expected 1 to %d pixels a side", path, width,
                         height, MAX_SIDE);
    file_writer writer;
    error why = {"no memory"};
    mrt_result result = file_writer_open(&writer, path, err);
    if (result < 0)
        return result;
    if (!write_stream(writer.stream, rgba, width, height, kind, &why)) {
        file_writer_abandon(&writer);
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path, why.text);
    }
    return file_writer_commit(&writer, err);
}

mrt_result png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                     error *err)
{
    return png_write_as(path, rgba, width, height, PNG_WITH_ALPHA, err);
}
