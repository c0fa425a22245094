#include "stage/voice/recogniser.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef MAROTTE_POCKETSPHINX

#include <pocketsphinx.h>
#include <sphinxbase/err.h>
#include <sphinxbase/fsg_model.h>

/* The folder of the model: that of Debian's package, or $MAROTTE_SPEECH_MODEL. */
typedef struct model_path {
    char text[1024];
} model_path;

static model_path file_of(const char *name)
{
    const char *folder = getenv("MAROTTE_SPEECH_MODEL");
    model_path out;
    (void)snprintf(out.text, sizeof out.text, "%s/%s", folder ? folder : MAROTTE_POCKETSPHINX,
                   name);
    return out;
}

/* A frame of the model covers 25.6 ms from its start on. */
static const double frame_s = 0.01, frame_middle_s = 0.0128;

struct recogniser {
    ps_decoder_t *listener, *aligner; /* NULL: not needed yet */
};

static mrt_result start(ps_decoder_t **out, cmd_ln_t *config, error *err)
{
    *out = config ? ps_init(config) : NULL;
    cmd_ln_free_r(config);
    return *out ? MRT_OK
                : error_set(err, MRT_ERR_UNSUPPORTED,
                            "the model of the speech recognition in %s cannot be read. Install "
                            "pocketsphinx-en-us again",
                            file_of("").text);
}

mrt_result recogniser_open(recogniser **out, error *err)
{
    *out = NULL;
    if (access(file_of("en-us/mdef").text, R_OK) != 0 ||
        access(file_of("en-us-phone.lm.bin").text, R_OK) != 0 ||
        access(file_of("cmudict-en-us.dict").text, R_OK) != 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the model of the speech recognition is missing. Install "
                         "pocketsphinx-en-us");
    err_set_logfp(NULL); /* else it prints everything that it does */
    err_set_callback(NULL, NULL);
    *out = calloc(1, sizeof **out);
    return *out ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to recognise speech");
}

void recogniser_close(recogniser *self)
{
    if (!self)
        return;
    if (self->listener)
        ps_free(self->listener);
    if (self->aligner)
        ps_free(self->aligner);
    free(self);
}

/* ---- sounds ---- */

static phone_sound sound_named(const char *name)
{
    for (uint32_t i = 1; i < PHONE_COUNT; ++i)
        if (strcmp(phone_name[i], name) == 0)
            return (phone_sound)i;
    return PHONE_REST; /* silence and noises */
}

static bool run(ps_decoder_t *decoder, const recogniser_part *part)
{
    return ps_start_utt(decoder) >= 0 &&
           ps_process_raw(decoder, part->frame, part->count, FALSE, TRUE) >= 0 &&
           ps_end_utt(decoder) >= 0;
}

/* Names of the aligner have a '=' before the sound. */
static mrt_result read_sounds(ps_decoder_t *decoder, const recogniser_part *part, phone_list *out,
                              double *out_score, error *err)
{
    mrt_result result = MRT_OK;
    double score = 0.0, frames = 1.0;
    for (ps_seg_t *at = ps_seg_iter(decoder); at; at = ps_seg_next(at)) {
        int first, last;
        const char *name = ps_seg_word(at);
        ps_seg_frames(at, &first, &last);
        if (last < first || result < 0)
            continue;
        int32 acoustic, language, back;
        (void)ps_seg_prob(at, &acoustic, &language, &back);
        score += acoustic;
        frames += last - first + 1;
        const double from_s = first == 0 ? 0.0 : first * frame_s + frame_middle_s;
        result = phone_list_add(out, sound_named(name + (name[0] == '=')), part->at_s + from_s,
                                part->at_s + (last + 1) * frame_s + frame_middle_s, err);
    }
    *out_score = score / frames;
    return result;
}

mrt_result recogniser_listen(recogniser *self, const recogniser_part *part, phone_list *out,
                             double *out_score, error *err)
{
    mrt_result result = MRT_OK;
    *out_score = 0.0;
    if (!self->listener)
        result = start(&self->listener,
                       cmd_ln_init(NULL, ps_args(), TRUE, "-hmm", file_of("en-us").text,
                                   "-allphone", file_of("en-us-phone.lm.bin").text, "-lw", "2.0",
                                   "-beam", "1e-20", "-pbeam", "1e-20", "-remove_silence", "no",
                                   "-cmn", "batch", "-allphone_ci", "yes", NULL),
                       err);
    if (result >= 0 && !run(self->listener, part))
        result = error_set(err, MRT_ERR_IO, "the speech recognition failed at %.1f s", part->at_s);
    return result < 0 ? result : read_sounds(self->listener, part, out, out_score, err);
}

/* ---- words that are known: a graph of their sounds, each sound a word of the recogniser ---- */

enum { PRONUNCIATIONS = 9, PART_WORDS = 120 };

typedef struct pronunciation {
    phone_sound sound[WORD_SOUNDS];
    uint32_t count;
} pronunciation;

static mrt_result open_aligner(recogniser *self, error *err)
{
    if (self->aligner)
        return MRT_OK;
    mrt_result result =
        start(&self->aligner,
              cmd_ln_init(NULL, ps_args(), TRUE, "-hmm", file_of("en-us").text, "-dict",
                          file_of("cmudict-en-us.dict").text, "-remove_silence", "no", "-cmn",
                          "batch", "-fsgusefiller", "no", "-fsgusealtpron", "no", "-beam", "1e-300",
                          "-pbeam", "1e-300", "-wbeam", "1e-300", "-lw", "1", NULL),
              err);
    for (uint32_t i = 1; i < PHONE_COUNT && result >= 0; ++i) {
        char name[8];
        (void)snprintf(name, sizeof name, "=%s", phone_name[i]);
        if (ps_add_word(self->aligner, name, phone_name[i], i + 1 == PHONE_COUNT) < 0)
            result =
                error_set(err, MRT_ERR_UNSUPPORTED,
                          "the model of the speech recognition lacks the sound %s", phone_name[i]);
    }
    return result;
}

static bool look_up(recogniser *self, const char *word, uint32_t which, pronunciation *out)
{
    char name[WORD_BYTES + 8];
    (void)snprintf(name, sizeof name, which ? "%s(%u)" : "%s", word, which + 1);
    char *text = ps_lookup_word(self->aligner, name), *rest = NULL;
    out->count = 0;
    for (char *at = text ? strtok_r(text, " ", &rest) : NULL; at && out->count < WORD_SOUNDS;
         at = strtok_r(NULL, " ", &rest))
        out->sound[out->count++] = sound_named(at);
    free(text);
    return out->count > 0;
}

bool recogniser_knows(recogniser *self, const char *word)
{
    pronunciation first;
    error ignored;
    return open_aligner(self, &ignored) >= 0 && look_up(self, word, 0, &first);
}

/* Returns the number of pronunciations, at least 1: by the dictionary, else by rules. */
static uint32_t pronounce(recogniser *self, const char *word, pronunciation out[PRONUNCIATIONS])
{
    uint32_t count = 0;
    while (count < PRONUNCIATIONS && look_up(self, word, count, &out[count]))
        count += 1;
    if (count > 0)
        return count;
    out[0].count = word_spell(out[0].sound, word);
    return 1;
}

static void add_path(fsg_model_t *graph, const pronunciation *p, int32_t from, int32_t to,
                     int32_t *next)
{
    int32_t at = from;
    for (uint32_t i = 0; i < p->count; ++i) {
        char name[8];
        (void)snprintf(name, sizeof name, "=%s", phone_name[p->sound[i]]);
        const int32_t end = i + 1 == p->count ? to : (*next)++;
        fsg_model_trans_add(graph, at, end, 0, fsg_model_word_add(graph, name));
        at = end;
    }
}

/* States 0..count lie between the words; state count + 1 is the end. */
static mrt_result set_graph(recogniser *self, pronunciation (*of)[PRONUNCIATIONS],
                            const uint32_t *of_count, uint32_t count, bool is_last, error *err)
{
    static const float silence = 1e-37f; /* a pause within speech is rare */
    int32_t next = (int32_t)count + 2, states = next;
    for (uint32_t w = 0; w < count; ++w)
        for (uint32_t k = 0; k < of_count[w]; ++k)
            states += (int32_t)of[w][k].count;
    fsg_model_t *graph = fsg_model_init("words", ps_get_logmath(self->aligner), 1.0f, states);
    if (!graph)
        return error_set(err, MRT_ERR_MEMORY, "no memory to recognise speech");
    graph->start_state = 0;
    graph->final_state = (int32_t)count + 1;
    for (uint32_t w = 0; w < count; ++w)
        for (uint32_t k = 0; k < of_count[w]; ++k)
            add_path(graph, &of[w][k], (int32_t)w, (int32_t)w + 1, &next);
    for (uint32_t w = 0; w <= count; ++w) {
        (void)fsg_model_add_silence(graph, "<sil>", (int)w, silence);
        if (w == count || (w > 0 && !is_last))
            (void)fsg_model_null_trans_add(graph, (int32_t)w, graph->final_state, 0);
    }
    const bool is_set = ps_set_fsg(self->aligner, "words", graph) >= 0 &&
                        ps_set_search(self->aligner, "words") >= 0;
    fsg_model_free(graph);
    return is_set ? MRT_OK
                  : error_set(err, MRT_ERR_MEMORY, "the speech recognition refused the words");
}

/* Returns how many words the sounds from `from` on are; UINT32_MAX: they are none of these. */
static uint32_t count_words(const phone_list *list, uint32_t from,
                            pronunciation (*of)[PRONUNCIATIONS], const uint32_t *of_count,
                            uint32_t count)
{
    const uint32_t size = list->count - from;
    phone_sound *sound = calloc(size + 1, sizeof *sound);
    bool *is_at = calloc(2 * ((size_t)size + 1), sizeof *is_at), *now = is_at;
    uint32_t sounds = 0, found = UINT32_MAX;
    for (uint32_t i = from; sound && i < list->count; ++i)
        if (list->phone[i].sound != PHONE_REST)
            sound[sounds++] = list->phone[i].sound;
    if (now)
        now[0] = true;
    for (uint32_t w = 0; sound && now && w < count && found == UINT32_MAX; ++w) {
        bool *then = now == is_at ? is_at + size + 1 : is_at;
        memset(then, 0, ((size_t)size + 1) * sizeof *then);
        for (uint32_t at = 0; at <= sounds; ++at)
            for (uint32_t k = 0; now[at] && k < of_count[w]; ++k) {
                const pronunciation *p = &of[w][k];
                if (at + p->count <= sounds &&
                    memcmp(sound + at, p->sound, p->count * sizeof *sound) == 0)
                    then[at + p->count] = true;
            }
        now = then;
        found = now[sounds] ? w + 1 : UINT32_MAX;
    }
    free(sound);
    free(is_at);
    return found;
}

mrt_result recogniser_align(recogniser *self, const recogniser_part *part, const word_list *words,
                            uint32_t first, bool is_last, uint32_t *out_next, phone_list *out,
                            error *err)
{
    const double words_a_second = 7.0;
    /* Frames score 14 to 29 lower with the right words than with any sounds, and 35 to 50 lower
     * with other words, in the sentences of tests/bench/voice.sh. */
    const double other_words_score = 33.0;
    const double part_s = (double)part->count / PHONES_RATE_HZ;
    uint32_t count = words->count - first;
    const uint32_t most = (uint32_t)(part_s * words_a_second) + 2;
    *out_next = first;
    if (count == 0)
        return MRT_END;
    if (!is_last && count > most)
        count = most;
    if (count > most + PART_WORDS) /* nobody says so many words in that time */
        return MRT_END;
    mrt_result result = open_aligner(self, err);
    pronunciation(*of)[PRONUNCIATIONS] = calloc(count, sizeof *of);
    uint32_t *of_count = calloc(count, sizeof *of_count);
    if (result >= 0 && (!of || !of_count))
        result = error_set(err, MRT_ERR_MEMORY, "no memory to recognise speech");
    for (uint32_t w = 0; w < count && result >= 0; ++w)
        of_count[w] = pronounce(self, words->word[first + w], of[w]);
    if (result >= 0)
        result = set_graph(self, of, of_count, count, is_last, err);
    if (result >= 0 && !run(self->aligner, part))
        result = error_set(err, MRT_ERR_IO, "the speech recognition failed at %.1f s", part->at_s);
    int32 score;
    double score_with = 0.0, score_without = 0.0;
    if (result >= 0 && !ps_get_hyp(self->aligner, &score))
        result = MRT_END;
    const uint32_t before = out->count;
    if (result == MRT_OK)
        result = read_sounds(self->aligner, part, out, &score_with, err);
    if (result == MRT_OK) {
        const uint32_t said = count_words(out, before, of, of_count, count);
        phone_list any = {0};
        result = recogniser_listen(self, part, &any, &score_without, err);
        phone_list_finish(&any);
        if (result == MRT_OK &&
            (said == UINT32_MAX || score_with < score_without - other_words_score)) {
            out->count = before;
            result = MRT_END;
        } else if (result == MRT_OK) {
            *out_next = first + said;
        }
    }
    free(of);
    free(of_count);
    return result;
}

#else /* without pocketsphinx */

mrt_result recogniser_open(recogniser **out, error *err)
{
    *out = NULL;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "marotte was built without speech recognition. Install " RECOGNISER_PACKAGES
                     ", and build it again");
}

void recogniser_close(recogniser *self)
{
    (void)self;
}

mrt_result recogniser_listen(recogniser *self, const recogniser_part *part, phone_list *out,
                             double *out_score, error *err)
{
    (void)self;
    (void)part;
    (void)out;
    *out_score = 0.0;
    return error_set(err, MRT_ERR_UNSUPPORTED, "marotte was built without speech recognition");
}

mrt_result recogniser_align(recogniser *self, const recogniser_part *part, const word_list *words,
                            uint32_t first, bool is_last, uint32_t *out_next, phone_list *out,
                            error *err)
{
    (void)words;
    (void)is_last;
    double score;
    *out_next = first;
    return recogniser_listen(self, part, out, &score, err);
}

bool recogniser_knows(recogniser *self, const char *word)
{
    (void)self;
    (void)word;
    return false;
}

#endif
