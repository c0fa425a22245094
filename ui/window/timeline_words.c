#include "window/timeline_state.h"

#include <stdio.h>
#include <string.h>

static bool has_pattern(const take_layer *lane, const char *pattern)
{
    for (uint32_t i = 0; i < lane->own_count; ++i)
        if (strcmp(lane->own[i], pattern) == 0)
            return true;
    return false;
}

static bool has_region(const take_layer *lane, const own_part *part)
{
    for (uint32_t i = 0; i < part->pattern_count; ++i)
        if (!has_pattern(lane, part->pattern[i]))
            return false;
    return part->pattern_count > 0;
}

uint32_t timeline_own_regions(const take_layer *lane)
{
    uint32_t out = 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region)
        if (has_region(lane, own_part_of((own_region)region)))
            out |= 1u << region;
    return out;
}

static bool is_of_regions(const char *pattern, uint32_t regions)
{
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        const own_part *part = own_part_of((own_region)region);
        for (uint32_t i = 0; regions & 1u << region && i < part->pattern_count; ++i)
            if (strcmp(part->pattern[i], pattern) == 0)
                return true;
    }
    return false;
}

static void append(char *out, size_t capacity, const char *word)
{
    size_t used = strlen(out);
    (void)snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", word);
}

void timeline_own_words(const take_layer *lane, char *out, size_t capacity)
{
    uint32_t regions = timeline_own_regions(lane);
    out[0] = '\0';
    if (lane->own_count == 0)
        append(out, capacity, "everything");
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region)
        if (regions & 1u << region)
            append(out, capacity, own_part_of((own_region)region)->name);
    for (uint32_t i = 0; i < lane->own_count; ++i)
        if (!is_of_regions(lane->own[i], regions))
            append(out, capacity, lane->own[i]);
}
