#include "show/own.h"

#include <string.h>

/* Names as in rigs/README.md. */
static const own_part parts[OWN_REGION_COUNT] = {
    [OWN_MOUTH] = {"mouth", 4, {"mouth.*", "lip.*", "lips.*", "tongue.*"}},
    [OWN_JAW] = {"jaw", 2, {"jaw.*", "chin.*"}},
    [OWN_BROWS] = {"brows", 2, {"brow.*", "forehead.*"}},
    [OWN_LIDS] = {"lids", 1, {"lid_*"}},
    [OWN_EYES] = {"eyes", 1, {"eye.*"}},
    [OWN_CHEEKS] = {"cheeks", 2, {"cheek.*", "nasolabial.*"}},
    [OWN_NOSE] = {"nose", 1, {"nose.*"}},
    [OWN_HEAD] = {"head", 4, {"skull.*", "hair.*", "ear.*", "hat.*"}},
};

const own_part *own_part_of(own_region region)
{
    return (unsigned)region < OWN_REGION_COUNT ? &parts[region] : NULL;
}

bool own_region_named(const char *name, own_region *out)
{
    for (own_region region = OWN_MOUTH; region < OWN_REGION_COUNT; ++region)
        if (strcmp(parts[region].name, name) == 0) {
            *out = region;
            return true;
        }
    return false;
}

/* ---- patterns ---- */

typedef struct stem { /* the prefix that a name must have */
    size_t length;
    bool is_open; /* any rest may follow, not only one after '.' */
} stem;

static stem stem_of(const char *pattern)
{
    size_t length = strlen(pattern);
    if (length == 0 || pattern[length - 1] != '*')
        return (stem){.length = length};
    if (length > 1 && pattern[length - 2] == '.')
        return (stem){.length = length - 2};
    return (stem){.length = length - 1, .is_open = true};
}

bool own_matches(const char *pattern, const char *name)
{
    stem s = stem_of(pattern);
    if (strncmp(pattern, name, s.length) != 0)
        return false;
    return s.is_open || name[s.length] == '\0' || name[s.length] == '.';
}

/* Returns true if `pattern` matches names that begin with `longer`. */
static bool reaches(const char *pattern, stem s, const char *longer, stem l)
{
    if (strncmp(pattern, longer, s.length) != 0)
        return false;
    return s.is_open || s.length == l.length || longer[s.length] == '.';
}

bool own_patterns_overlap(const char *a, const char *b)
{
    stem of_a = stem_of(a), of_b = stem_of(b);
    return of_a.length <= of_b.length ? reaches(a, of_a, b, of_b) : reaches(b, of_b, a, of_a);
}

bool own_is_pattern(const char *text)
{
    size_t length = strlen(text);
    for (size_t i = 0; i < length; ++i)
        if ((unsigned char)text[i] <= ' ' || text[i] == 0x7f || (text[i] == '*' && i + 1 < length))
            return false;
    return length > 0 && text[0] != '.';
}

/* ---- layers ---- */

bool own_layer_owns(const take_layer *layer, const char *name)
{
    for (uint32_t i = 0; i < layer->own_count; ++i)
        if (own_matches(layer->own[i], name))
            return true;
    return layer->own_count == 0;
}

bool own_layer_is_active(const take *t, uint32_t layer)
{
    bool is_solo_used = false;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        is_solo_used |= t->layer[i].is_solo;
    return !t->layer[layer].is_muted && (t->layer[layer].is_solo || !is_solo_used);
}

static double own_presence(const take_layer *layer, int64_t at_ns)
{
    take_voice voice[2];
    double sum = 0.0;
    uint32_t count = take_at(voice, layer, at_ns);
    for (uint32_t i = 0; i < count; ++i)
        sum += voice[i].weight;
    return sum > 1.0 ? 1.0 : sum;
}

void own_weights(double *out, const take *t, const char *name, int64_t at_ns)
{
    double left = 1.0;
    for (uint32_t i = t->layer_count; i-- > 0;) {
        const take_layer *layer = &t->layer[i];
        bool speaks = own_layer_is_active(t, i) && own_layer_owns(layer, name);
        double share = speaks ? own_presence(layer, at_ns) : 0.0;
        out[i] = left * share;
        if (!layer->is_additive)
            left *= 1.0 - share;
    }
}
