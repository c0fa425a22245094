#include "io/read/mesh_images.h"

#include "base/text.h"
#include "io/decode/decode.h"
#include "io/read/mesh_build.h"

#include <stdlib.h>
#include <string.h>

enum { IMAGES_MAX = 64 };

mrt_result mesh_image_room(const mesh *m, error *err)
{
    return m->image_count < IMAGES_MAX
               ? MRT_OK
               : error_set(err, MRT_ERR_UNSUPPORTED, "more than %d pictures are not drawn",
                           IMAGES_MAX);
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for a picture");
}

mrt_result mesh_image_add(mesh *m, uint32_t *out_image, const char *name, const void *data,
                          size_t size, budget *b, error *err)
{
    char clean[MESH_BUILD_NAME_LENGTH_MAX + 1];
    if (size == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED, "it is empty");
    mrt_result result = budget_spend_bytes(b, size, err);
    if (result < 0)
        return result;
    if (!m->image)
        m->image = calloc(IMAGES_MAX, sizeof *m->image);
    if (!m->image)
        return no_memory(err);
    text_copy(clean, sizeof clean, text_view_of(name, strlen(name)));
    mesh_image image = {.name = strdup(clean), .encoded = malloc(size), .encoded_size = size};
    if (!image.name || !image.encoded) {
        free(image.name);
        free(image.encoded);
        return no_memory(err);
    }
    memcpy(image.encoded, data, size);
    m->image[m->image_count++] = image;
    *out_image = m->image_count;
    return MRT_OK;
}

void mesh_image_note(mesh *m, const char *name, const char *why)
{
    char clean[MESH_BUILD_NAME_LENGTH_MAX + 1];
    if (m->undrawn_count++ > 0)
        return;
    text_copy(clean, sizeof clean, text_view_of(name, strlen(name)));
    mesh_note(m, "the picture \"%s\" is not drawn: %s", clean, why);
}

/* Returns the longest side that keeps `count` pictures of four bytes per pixel within the limit. */
static uint32_t side_max_for(uint32_t count)
{
    uint32_t side = 2048;
    while (side > 64 && (uint64_t)side * side * 4 * count > (uint64_t)256 << 20)
        side /= 2;
    return side;
}

static void take(mesh_image *image, decode_job *job)
{
    decode_image_size size;
    memcpy(&size, job->out, sizeof size);
    image->width = size.width;
    image->height = size.height;
    memmove(job->out, (uint8_t *)job->out + sizeof size, job->out_size - sizeof size);
    image->rgba = job->out;
    job->out = NULL;
}

static void decode_all(mesh *m)
{
    error failed = {"no memory"};
    decode_job *job = calloc(m->image_count, sizeof *job);
    for (uint32_t i = 0; job && i < m->image_count; ++i) {
        job[i].order.kind = DECODE_IMAGE;
        job[i].order.side_max = side_max_for(m->image_count);
        job[i].data = m->image[i].encoded;
        job[i].size = m->image[i].encoded_size;
    }
    mrt_result result = job ? decode_run(job, m->image_count, &failed) : MRT_ERR_MEMORY;
    if (result < 0)
        mesh_note(m, "its %u pictures are not drawn: %s", m->image_count, failed.text);
    for (uint32_t i = 0; i < m->image_count; ++i) {
        mesh_image *image = &m->image[i];
        if (result >= 0 && job[i].out)
            take(image, &job[i]);
        else if (result >= 0)
            mesh_image_note(m, image->name, job[i].failed.text);
        free(image->encoded);
        image->encoded = NULL;
        image->encoded_size = 0;
    }
    free(job);
}

void mesh_images_decode(mesh *m)
{
    if (m->image_count > 0)
        decode_all(m);
    if (m->undrawn_count > 1)
        mesh_note(m, "%u more of its pictures are not drawn", m->undrawn_count - 1);
}
