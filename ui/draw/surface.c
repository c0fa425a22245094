#include "draw/surface.h"

#include <ctype.h>
#include <string.h>

static const float dry_roughness = 0.8f;  /* what is rougher has a grain */
static const float hard_roughness = 0.4f; /* what is smoother lets no light in */

static const char *const felt_words[] = {"felt",    "fleece", "wool",   "fur",  "hair",
                                         "cloth",   "foam",   "fabric", "skin", "brow",
                                         "eyebrow", "lid",    "eyelid", "ear"};
static const char *const stone_words[] = {"stone", "rock", "moai", "clay", "plaster", "concrete"};
static const char *const wet_words[] = {"tooth", "teeth", "gum", "tongue", "mouth", "lip"};

static bool is_letter(char c)
{
    return isalpha((unsigned char)c) != 0;
}

/* "lid" is a word of "lid_upper.l" and of "Lids", not of "solid". */
static bool has_word(const char *name, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = name; *at; ++at) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)at[i]) == word[i])
            ++i;
        bool begins = at == name || !is_letter(at[-1]);
        const char *end = at + i + (i == length && tolower((unsigned char)at[i]) == 's');
        if (i == length && begins && !is_letter(*end))
            return true;
    }
    return false;
}

static bool has_any(const char *name, const char *const *word, size_t count)
{
    for (size_t i = 0; name && i < count; ++i)
        if (has_word(name, word[i]))
            return true;
    return false;
}
#define HAS_ANY(name, words) has_any(name, words, sizeof words / sizeof *words)

surface surface_of(const mesh_material *material)
{
    surface s = {SURFACE_SMOOTH, 0.0f, 0.0f};
    if (material->metallic >= 0.5f)
        return s;
    if (material->roughness > dry_roughness) {
        bool is_felt = HAS_ANY(material->name, felt_words) && !HAS_ANY(material->name, stone_words);
        s.kind = is_felt ? SURFACE_FELT : SURFACE_STONE;
        return s;
    }
    bool is_wet = HAS_ANY(material->name, wet_words);
    if (material->roughness > hard_roughness)
        s.softness = 1.0f;
    else if (is_wet)
        s.softness = 0.4f; /* teeth are not stone either */
    s.coat = is_wet ? 1.0f : 0.0f;
    return s;
}
