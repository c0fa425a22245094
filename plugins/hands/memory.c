#include "memory.h"

#include <string.h>

/* FNV-1a of the type's id, version, size of the body; the body; FNV-1a of all that, the id first.
 */
enum { HEAD = 16, SUM = 8 };
_Static_assert(sizeof(int) == 4 && sizeof(bool) == 1 && sizeof(memory_kind) == 4, "stored so");

static uint64_t sum_on(uint64_t sum, const unsigned char *bytes, size_t size)
{
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ bytes[i]) * UINT64_C(0x100000001b3);
    return sum;
}

static uint64_t sum_of_type(const memory_list *list)
{
    return sum_on(UINT64_C(0xcbf29ce484222325), (const unsigned char *)list->type,
                  strlen(list->type));
}

static size_t size_of(memory_kind kind)
{
    return kind == MEMORY_BOOL ? 1 : kind == MEMORY_DOUBLE ? 8 : 4;
}

/* NULL behind the last one. */
static const memory_part *part_of(const memory_list *list, uint32_t i)
{
    return i < MEMORY_PARTS_MAX && list->parts[i].at ? &list->parts[i] : NULL;
}

static size_t body_of(const memory_list *list)
{
    const memory_part *part;
    size_t size = 0;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i)
        size += part->size;
    return size;
}

static void write_head(const memory_list *list, unsigned char out[HEAD])
{
    uint64_t type = sum_of_type(list);
    uint32_t body = (uint32_t)body_of(list);
    memcpy(out, &type, 8);
    memcpy(out + 8, &list->version, 4);
    memcpy(out + 12, &body, 4);
}

static bool is_value_allowed(const memory_part *part, const unsigned char *at)
{
    float single;
    double value = 0.0;
    uint32_t whole;
    switch (part->kind) {
    case MEMORY_BOOL:
        return *at <= 1;
    case MEMORY_WHOLE:
        memcpy(&whole, at, sizeof whole);
        return (double)whole <= part->most;
    case MEMORY_FLOAT:
        memcpy(&single, at, sizeof single);
        value = (double)single;
        break;
    case MEMORY_DOUBLE:
        memcpy(&value, at, sizeof value);
        break;
    }
    return value >= -part->most && value <= part->most;
}

/* Whether the variable may hold what is there. */
static bool is_allowed(const memory_part *part, const void *there)
{
    const unsigned char *at = there;
    for (size_t k = 0; k < part->size; k += size_of(part->kind))
        if (!is_value_allowed(part, at + k))
            return false;
    return true;
}

static bool are_allowed(const memory_list *list, const unsigned char *at)
{
    const memory_part *part;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        if (!is_allowed(part, at))
            return false;
        at += part->size;
    }
    return true;
}

size_t memory_save(const memory_list *list, void *out, size_t capacity)
{
    const memory_part *part;
    size_t size = HEAD + body_of(list) + SUM;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i)
        if (!is_allowed(part, part->at))
            return 0;
    if (!out || capacity < size)
        return size;
    unsigned char *bytes = out, *at = bytes + HEAD;
    write_head(list, bytes);
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        memcpy(at, part->at, part->size);
        at += part->size;
    }
    uint64_t sum = sum_on(sum_of_type(list), bytes, (size_t)(at - bytes));
    memcpy(at, &sum, SUM);
    return size;
}

bool memory_load(const memory_list *list, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    unsigned char head[HEAD];
    uint64_t sum;
    write_head(list, head);
    if (!at || size != HEAD + body_of(list) + SUM || memcmp(at, head, HEAD) != 0)
        return false;
    memcpy(&sum, at + size - SUM, SUM);
    if (sum != sum_on(sum_of_type(list), at, size - SUM) || !are_allowed(list, at + HEAD))
        return false;
    at += HEAD;
    const memory_part *part;
    for (uint32_t i = 0; (part = part_of(list, i)); ++i) {
        memcpy(part->at, at, part->size);
        at += part->size;
    }
    return true;
}
