#include "stage/voice/words.h"

#include <stdlib.h>
#include <string.h>

static const char *const digit_name[10] = {"zero", "one", "two",   "three", "four",
                                           "five", "six", "seven", "eight", "nine"};

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static mrt_result add_word(word_list *list, const char *text, size_t length, error *err)
{
    while (length > 0 && text[length - 1] == '\'')
        length -= 1;
    while (length > 0 && *text == '\'') {
        text += 1;
        length -= 1;
    }
    if (length == 0)
        return MRT_OK;
    if (list->count == WORDS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the text has more than %d words. Split the take, or leave the words out",
                         WORDS_MAX);
    if (length >= WORD_BYTES)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the word \"%.*s...\" is longer than %d letters. Check the text", 20, text,
                         WORD_BYTES - 1);
    char *out = list->word[list->count++];
    for (size_t i = 0; i < length; ++i)
        out[i] = (char)(text[i] >= 'A' && text[i] <= 'Z' ? text[i] - 'A' + 'a' : text[i]);
    out[length] = '\0';
    return MRT_OK;
}

mrt_result word_list_parse(word_list *out, const char *text, error *err)
{
    const size_t size = strnlen(text, PHONES_WORDS_BYTES + 1);
    mrt_result result = MRT_OK;
    *out = (word_list){0};
    if (size > PHONES_WORDS_BYTES)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the text has more than %d bytes. Split the take, or leave the words out",
                         PHONES_WORDS_BYTES);
    out->word = calloc(WORDS_MAX, sizeof *out->word);
    if (!out->word)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the words");
    for (size_t i = 0; i < size && result >= 0;) {
        size_t end = i;
        while (end < size && (is_letter(text[end]) || text[end] == '\''))
            end += 1;
        if (end > i) {
            result = add_word(out, text + i, end - i, err);
        } else if (text[i] >= '0' && text[i] <= '9') {
            const char *name = digit_name[text[i] - '0'];
            result = add_word(out, name, strlen(name), err);
        }
        i = end > i ? end : i + 1;
    }
    if (result >= 0 && out->count == 0)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "the text has no English word. Type the words that are said, or leave "
                           "them out");
    if (result < 0)
        word_list_finish(out);
    return result;
}

void word_list_finish(word_list *list)
{
    free(list->word);
    *list = (word_list){0};
}

/* ---- spelling ---- */

typedef struct rule { /* the first rule that fits is used */
    const char *letters;
    phone_sound sound[3]; /* up to PHONE_REST */
} rule;

/* '$' is the end of the word. */
static const rule rules[] = {
    {"tion", {PHONE_SH, PHONE_AH, PHONE_N}},
    {"sion", {PHONE_ZH, PHONE_AH, PHONE_N}},
    {"eigh", {PHONE_EY}},
    {"igh", {PHONE_AY}},
    {"tch", {PHONE_CH}},
    {"dge", {PHONE_JH}},
    {"air", {PHONE_EH, PHONE_R}},
    {"ear", {PHONE_IH, PHONE_R}},
    {"sh", {PHONE_SH}},
    {"ch", {PHONE_CH}},
    {"th", {PHONE_TH}},
    {"ph", {PHONE_F}},
    {"gh", {PHONE_G}},
    {"ck", {PHONE_K}},
    {"ng", {PHONE_NG}},
    {"qu", {PHONE_K, PHONE_W}},
    {"wh", {PHONE_W}},
    {"kn", {PHONE_N}},
    {"wr", {PHONE_R}},
    {"oo", {PHONE_UW}},
    {"ee", {PHONE_IY}},
    {"ea", {PHONE_IY}},
    {"ie", {PHONE_IY}},
    {"ou", {PHONE_AW}},
    {"ow", {PHONE_OW}},
    {"oa", {PHONE_OW}},
    {"ai", {PHONE_EY}},
    {"ay", {PHONE_EY}},
    {"ei", {PHONE_EY}},
    {"ey", {PHONE_IY}},
    {"oi", {PHONE_OY}},
    {"oy", {PHONE_OY}},
    {"au", {PHONE_AO}},
    {"aw", {PHONE_AO}},
    {"ew", {PHONE_UW}},
    {"ue", {PHONE_UW}},
    {"er", {PHONE_ER}},
    {"ir", {PHONE_ER}},
    {"ur", {PHONE_ER}},
    {"ar", {PHONE_AA, PHONE_R}},
    {"or", {PHONE_AO, PHONE_R}},
    {"le$", {PHONE_AH, PHONE_L}},
    {"ce", {PHONE_S, PHONE_EH}},
    {"ci", {PHONE_S, PHONE_IH}},
    {"cy", {PHONE_S, PHONE_IY}},
    {"ge$", {PHONE_JH}},
    {"gi", {PHONE_JH, PHONE_IH}},
    {"e$", {PHONE_REST}},
    {"y$", {PHONE_IY}},
    {"a$", {PHONE_AH}},
    {"o$", {PHONE_OW}},
    {"a", {PHONE_AE}},
    {"b", {PHONE_B}},
    {"c", {PHONE_K}},
    {"d", {PHONE_D}},
    {"e", {PHONE_EH}},
    {"f", {PHONE_F}},
    {"g", {PHONE_G}},
    {"h", {PHONE_HH}},
    {"i", {PHONE_IH}},
    {"j", {PHONE_JH}},
    {"k", {PHONE_K}},
    {"l", {PHONE_L}},
    {"m", {PHONE_M}},
    {"n", {PHONE_N}},
    {"o", {PHONE_AA}},
    {"p", {PHONE_P}},
    {"r", {PHONE_R}},
    {"s", {PHONE_S}},
    {"t", {PHONE_T}},
    {"u", {PHONE_AH}},
    {"v", {PHONE_V}},
    {"w", {PHONE_W}},
    {"x", {PHONE_K, PHONE_S}},
    {"y", {PHONE_Y}},
    {"z", {PHONE_Z}},
};

/* Returns the number of letters that the rule covers; 0: it does not fit. */
static size_t fits(const rule *r, const char *at)
{
    size_t length = 0;
    for (; r->letters[length] && r->letters[length] != '$'; ++length)
        if (at[length] != r->letters[length])
            return 0;
    return r->letters[length] == '$' && at[length] ? 0 : length;
}

uint32_t word_spell(phone_sound out[WORD_SOUNDS], const char *word)
{
    uint32_t count = 0;
    for (const char *at = word; *at;) {
        size_t used = 0;
        if (at > word && at[0] == at[-1] && !strchr("aeiou", at[0])) { /* "bb" is one sound */
            at += 1;
            continue;
        }
        for (size_t i = 0; i < sizeof rules / sizeof *rules && !used; ++i) {
            used = fits(&rules[i], at);
            for (int k = 0; used && k < 3 && rules[i].sound[k] && count < WORD_SOUNDS; ++k)
                out[count++] = rules[i].sound[k];
        }
        at += used ? used : 1;
    }
    if (count == 0)
        out[count++] = PHONE_AH;
    return count;
}
