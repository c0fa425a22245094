#include "io/read/mesh_images.h"

#include "io/decode/decode.h"

#include <stdlib.h>
#include <string.h>

/* The longest side with which so many pictures of four bytes a pixel keep the limit. */
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

void mesh_images_decode(mesh *m)
{
    error failed = {"no memory"};
    decode_job *job = m->image_count ? calloc(m->image_count, sizeof *job) : NULL;
    if (m->image_count == 0)
        return;
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
            mesh_note(m, "the picture \"%s\" is not drawn: %s", image->name, job[i].failed.text);
        free(image->encoded);
        image->encoded = NULL;
        image->encoded_size = 0;
    }
    free(job);
}
