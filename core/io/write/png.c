#include "base/file.h"
#include "io/export.h"

#include <png.h>

enum { MAX_SIDE = 32768 };

mrt_result png_write(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                     error *err)
{
    if (width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: a picture of %u by %u: expected 1 to %d pixels a side", path, width,
                         height, MAX_SIDE);
    file_writer writer;
    mrt_result result = file_writer_open(&writer, path, err);
    if (result < 0)
        return result;
    png_image image = {
        .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGBA};
    if (!png_image_write_to_stdio(&image, writer.stream, 0, rgba, 0, NULL)) {
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", path, image.message);
        png_image_free(&image);
        file_writer_abandon(&writer);
        return result;
    }
    return file_writer_commit(&writer, err);
}
