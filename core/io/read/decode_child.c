/* The program's side of decode.h: jobs to the child, answers back. Nothing in an answer is trusted
 * but what the order allows. */
#include "io/decode/decode.h"
#include "io/read/mesh_child.h"

#include "base/text.h"

#include <stdlib.h>
#include <string.h>

/* 0: not one of glTF's. */
static size_t component_size(uint32_t type)
{
    static const uint8_t size[] = {1, 1, 2, 2, 0, 4, 4}; /* from 5120 */
    return type >= 5120 && type <= 5126 ? size[type - 5120] : 0;
}

size_t decode_answer_size(const decode_order *order)
{
    const uint64_t size_max = (uint64_t)1 << 30;
    uint64_t size = (uint64_t)order->index_count * 4;
    if (order->count == 0)
        return 0;
    if (order->kind == DECODE_MESHOPT)
        size = (uint64_t)order->count * order->stride;
    else if (order->kind != DECODE_DRACO || order->attribute_count > DECODE_ATTRIBUTES_MAX)
        return 0;
    for (uint32_t i = 0; order->kind == DECODE_DRACO && i < order->attribute_count; ++i) {
        const decode_attribute *attribute = &order->attribute[i];
        size_t each = component_size(attribute->component_type);
        if (each == 0 || attribute->component_count == 0 || attribute->component_count > 16)
            return 0;
        size += (uint64_t)order->count * attribute->component_count * each;
    }
    return size <= size_max ? (size_t)size : 0;
}

static void *put(char *at, const void *data, size_t size)
{
    if (size)
        memcpy(at, data, size);
    return at + size;
}

static mrt_result make_request(void **out, size_t *out_size, const decode_job *job, uint32_t count,
                               error *err)
{
    *out_size = 0;
    for (uint32_t i = 0; i < count; ++i)
        *out_size += sizeof job[i].order + sizeof(uint64_t) + job[i].size;
    char *at = *out = malloc(*out_size + 1);
    if (!at)
        return error_set(err, MRT_ERR_MEMORY, "no memory for what is to be decoded");
    for (uint32_t i = 0; i < count; ++i) {
        uint64_t size = job[i].size;
        at = put(at, &job[i].order, sizeof job[i].order);
        at = put(at, &size, sizeof size);
        at = put(at, job[i].data, job[i].size);
    }
    return MRT_OK;
}

/* Whether an answer of so many bytes can be one to the order. */
static bool fits(const decode_order *order, const void *answer, uint64_t size)
{
    decode_image_size image;
    if (order->kind != DECODE_IMAGE)
        return size == decode_answer_size(order) && size > 0;
    if (size < sizeof image)
        return false;
    memcpy(&image, answer, sizeof image);
    return image.width > 0 && image.height > 0 &&
           (!order->side_max ||
            (image.width <= order->side_max && image.height <= order->side_max)) &&
           size == sizeof image + (uint64_t)image.width * image.height * 4;
}

/* How many of the jobs have been answered. */
static uint32_t take_answers(decode_job *job, uint32_t count, const char *at, size_t size)
{
    for (uint32_t i = 0; i < count; ++i) {
        uint64_t head[2];
        if (size < sizeof head)
            return i;
        memcpy(head, at, sizeof head);
        if (head[1] > size - sizeof head)
            return i;
        const char *body = at + sizeof head;
        if (head[0] == 0) {
            text_copy(job[i].failed.text, sizeof job[i].failed.text,
                      text_view_of(body, (size_t)head[1]));
        } else if (!fits(&job[i].order, body, head[1])) {
            (void)error_set(&job[i].failed, MRT_ERR_FORMAT, "its decoder answers nonsense");
        } else {
            job[i].out = malloc((size_t)head[1]);
            job[i].out_size = (size_t)head[1];
            if (job[i].out)
                memcpy(job[i].out, body, (size_t)head[1]);
            else
                (void)error_set(&job[i].failed, MRT_ERR_MEMORY, "no memory for what was decoded");
        }
        at = body + head[1];
        size -= sizeof head + (size_t)head[1];
    }
    return count;
}

mrt_result decode_run(decode_job *job, uint32_t count, error *err)
{
    enum { CRASHES_MAX = 2 };
    for (int crash = 0; count > 0; ++crash) {
        void *request = NULL, *answer = NULL;
        size_t request_size = 0, answer_size = 0;
        error ended = {"its decoder did not finish"};
        mrt_result result = make_request(&request, &request_size, job, count, err);
        if (result < 0)
            return result;
        result =
            mesh_child_ask(&answer, &answer_size, MESH_CHILD_DECODE, request, request_size, &ended);
        uint32_t done = take_answers(job, count, answer, answer_size);
        bool was_there = answer != NULL || result == MRT_OK;
        free(request);
        free(answer);
        if (!was_there && result != MRT_ERR_FORMAT)
            return error_set(err, result, "%s", ended.text);
        job += done;
        count -= done;
        /* The next one ended it. After a few, the others are not tried any more. */
        for (uint32_t i = 0; i < count && (i == 0 || crash == CRASHES_MAX); ++i)
            job[i].failed = ended;
        uint32_t passed_over = crash == CRASHES_MAX ? count : count > 0;
        job += passed_over;
        count -= passed_over;
    }
    return MRT_OK;
}

void decode_job_finish(decode_job *job)
{
    free(job->out);
    job->out = NULL;
    job->out_size = 0;
}
