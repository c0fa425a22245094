/* Pictures: libpng, libjpeg-turbo and libwebp, for the textures of a head. (Pictures are written by
 * io/write/png.c.) */
#include "io/decode/decode.h"

#include "base/budget.h"

#include <jpeglib.h>
#include <png.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

typedef struct pixels {
    uint32_t width, height;
    uint8_t *rgba; /* width * height * 4, rows from the top */
} pixels;

static mrt_result check_size(uint64_t width, uint64_t height, size_t file_size, error *err)
{
    enum { SIDE_MAX = 16384 };
    if (width == 0 || height == 0 || width > SIDE_MAX || height > SIDE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "it has %llu x %llu pixels: each side must be 1 to %d",
                         (unsigned long long)width, (unsigned long long)height, SIDE_MAX);
    budget b = budget_of(BUDGET_IMAGE, file_size);
    return budget_spend_bytes(&b, width * height * 4, err);
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the picture");
}

static mrt_result decode_png(pixels *out, const void *data, size_t size, error *err)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_memory(&image, data, size))
        return error_set(err, MRT_ERR_FORMAT, "the PNG is damaged: %s", image.message);
    mrt_result result = check_size(image.width, image.height, size, err);
    image.format = PNG_FORMAT_RGBA;
    if (result == MRT_OK) {
        *out = (pixels){image.width, image.height, malloc(PNG_IMAGE_SIZE(image))};
        if (!out->rgba)
            result = no_memory(err);
    }
    if (result == MRT_OK && !png_image_finish_read(&image, NULL, out->rgba, 0, NULL))
        result = error_set(err, MRT_ERR_FORMAT, "the PNG is damaged: %s", image.message);
    png_image_free(&image);
    return result;
}

/* ---- JPEG ---- */

typedef struct jpeg_reader {
    struct jpeg_decompress_struct state;
    struct jpeg_error_mgr errors;
    jmp_buf failed;
    char message[JMSG_LENGTH_MAX];
} jpeg_reader;

static void jpeg_fail(j_common_ptr state)
{
    jpeg_reader *r = state->client_data;
    r->errors.format_message(state, r->message);
    longjmp(r->failed, 1);
}

static void jpeg_stay_silent(j_common_ptr state, int level)
{
    (void)state;
    (void)level;
}

/* Decodes at a reduced size if the picture is too large: eighths of its size cost almost nothing.
 * */
static void choose_scale(jpeg_reader *r, uint32_t side_max)
{
    uint32_t longer =
        r->state.image_width > r->state.image_height ? r->state.image_width : r->state.image_height;
    r->state.scale_num = 1;
    r->state.scale_denom = 1;
    while (r->state.scale_denom < 8 && longer / r->state.scale_denom > side_max)
        r->state.scale_denom *= 2;
}

static mrt_result read_jpeg(jpeg_reader *r, pixels *out, size_t size, uint32_t side_max, error *err)
{
    (void)jpeg_read_header(&r->state, TRUE);
    mrt_result result = check_size(r->state.image_width, r->state.image_height, size, err);
    if (result < 0)
        return result;
    choose_scale(r, side_max);
    r->state.out_color_space = JCS_EXT_RGBA;
    (void)jpeg_start_decompress(&r->state);
    uint32_t width = r->state.output_width, height = r->state.output_height;
    *out = (pixels){width, height, calloc((size_t)width * height, 4)};
    if (!out->rgba)
        return no_memory(err);
    while (r->state.output_scanline < height) {
        JSAMPROW row = out->rgba + (size_t)r->state.output_scanline * width * 4;
        (void)jpeg_read_scanlines(&r->state, &row, 1);
    }
    (void)jpeg_finish_decompress(&r->state);
    return MRT_OK;
}

static mrt_result decode_jpeg(pixels *out, const void *data, size_t size, uint32_t side_max,
                              error *err)
{
    jpeg_reader *r = calloc(1, sizeof *r);
    if (!r)
        return no_memory(err);
    r->state.err = jpeg_std_error(&r->errors);
    r->errors.error_exit = jpeg_fail;
    r->errors.emit_message = jpeg_stay_silent;
    r->state.client_data = r;
    mrt_result result;
    if (setjmp(r->failed) == 0) {
        jpeg_create_decompress(&r->state);
        r->state.client_data = r;
        jpeg_mem_src(&r->state, data, (unsigned long)size);
        result = read_jpeg(r, out, size, side_max, err);
    } else {
        result = error_set(err, MRT_ERR_FORMAT, "the JPEG is damaged: %s", r->message);
    }
    jpeg_destroy_decompress(&r->state);
    free(r);
    return result;
}

/* ---- WebP ---- */

static mrt_result decode_webp(pixels *out, const void *data, size_t size, error *err)
{
    WebPBitstreamFeatures image;
    if (WebPGetFeatures(data, size, &image) != VP8_STATUS_OK)
        return error_set(err, MRT_ERR_FORMAT, "the WebP is damaged");
    if (image.has_animation)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "it is an animated WebP: export the texture as a still picture");
    mrt_result result = check_size((uint64_t)image.width, (uint64_t)image.height, size, err);
    if (result < 0)
        return result;
    uint32_t width = (uint32_t)image.width, height = (uint32_t)image.height;
    size_t row = (size_t)width * 4;
    *out = (pixels){width, height, malloc(row * height)};
    if (!out->rgba)
        return no_memory(err);
    if (!WebPDecodeRGBAInto(data, size, out->rgba, row * height, (int)row))
        return error_set(err, MRT_ERR_FORMAT, "the WebP is damaged");
    return MRT_OK;
}

/* ---- any of them ---- */

/* Halves the picture in place: each pixel is the mean of up to four. Odd last rows and columns are
 * used twice. */
static void halve(pixels *p)
{
    uint32_t width = (p->width + 1) / 2, height = (p->height + 1) / 2;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            size_t left = (size_t)2 * x, right = left + 1 < p->width ? left + 1 : left;
            size_t below = 2 * y + 1 < p->height ? 2 * y + 1 : 2 * y;
            for (size_t c = 0; c < 4; ++c) {
                const uint8_t *upper = p->rgba + (size_t)2 * y * p->width * 4 + c;
                const uint8_t *lower = p->rgba + below * p->width * 4 + c;
                int sum = upper[left * 4] + upper[right * 4] + lower[left * 4] + lower[right * 4];
                p->rgba[((size_t)y * width + x) * 4 + c] = (uint8_t)((sum + 2) / 4);
            }
        }
    p->width = width;
    p->height = height;
}

static mrt_result decode_any(pixels *out, const void *data, size_t size, uint32_t side_max,
                             error *err)
{
    const uint8_t *at = data;
    if (size >= 8 && memcmp(at, "\x89PNG\r\n\x1a\n", 8) == 0)
        return decode_png(out, data, size, err);
    if (size >= 3 && at[0] == 0xff && at[1] == 0xd8 && at[2] == 0xff)
        return decode_jpeg(out, data, size, side_max, err);
    if (size >= 12 && memcmp(at, "RIFF", 4) == 0 && memcmp(at + 8, "WEBP", 4) == 0)
        return decode_webp(out, data, size, err);
    if (size >= 12 && memcmp(at, "\xabKTX 20\xbb\r\n\x1a\n", 12) == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "it is KTX2 (Basis Universal), which is not read. "
                         "\"gltf-transform ktxdecompress\" converts it to PNG");
    if (size >= 12 && memcmp(at + 4, "ftypavif", 8) == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "AVIF is not read: export the textures as PNG or JPEG");
    return error_set(err, MRT_ERR_UNSUPPORTED, "it is not PNG, JPEG or WebP");
}

mrt_result image_decode(void **out_data, size_t *out_size, const decode_order *order,
                        const void *data, size_t size, error *err)
{
    pixels p = {0};
    uint32_t side_max = order->side_max ? order->side_max : UINT32_MAX;
    *out_data = NULL;
    *out_size = 0;
    mrt_result result = decode_any(&p, data, size, side_max, err);
    while (result == MRT_OK && (p.width > side_max || p.height > side_max))
        halve(&p);
    decode_image_size head = {p.width, p.height};
    size_t body = (size_t)p.width * p.height * 4;
    uint8_t *out = result == MRT_OK ? malloc(sizeof head + body) : NULL;
    if (result == MRT_OK && !out)
        result = no_memory(err);
    if (out) {
        memcpy(out, &head, sizeof head);
        memcpy(out + sizeof head, p.rgba, body);
        *out_data = out;
        *out_size = sizeof head + body;
    }
    free(p.rgba);
    return result;
}
