/* csrbf/lanes_choose.h - which columns count in a block: those that are not zero there and weigh
 * something, ascending. Inline: each file that includes it gets it for its own instruction set.
 * Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_LANES_CHOOSE_H
#define MAROTTE_CSRBF_LANES_CHOOSE_H
#include "csrbf/columns.h"

typedef struct chosen {
    uint16_t column[2 * COLUMNS_WORD];
    uint32_t count;
    uint32_t next; /* the word of the weights to look at next */
} chosen;

static inline const uint64_t *marks_of(const columns *c, uint32_t block)
{
    return c->mark + (size_t)block * c->mark_words;
}

static inline void choose_word(chosen *to, uint64_t bits, uint32_t word)
{
    for (; bits != 0; bits &= bits - 1)
        to->column[to->count++] = (uint16_t)(word * COLUMNS_WORD + (uint32_t)__builtin_ctzll(bits));
}

/* The next columns that count: at most as many as there is room for. False: none is left. Start
 * with next = 0; the rest is better not set, it is large. */
static inline bool choose_more(chosen *to, const columns_weights *w, const uint64_t *mark)
{
    to->count = 0;
    while (to->next < w->word_count && to->count <= COLUMNS_WORD) {
        uint32_t word = w->word[to->next++];
        choose_word(to, mark[word] & w->live[word], word);
    }
    return to->count > 0;
}

/* The same columns count where there are these marks and those. */
static inline bool choose_the_same(const columns_weights *w, const uint64_t *a, const uint64_t *b)
{
    uint64_t other = 0;
    for (uint32_t i = 0; i < w->word_count; ++i)
        other |= (a[w->word[i]] ^ b[w->word[i]]) & w->live[w->word[i]];
    return other == 0;
}

#endif
