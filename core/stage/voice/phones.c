#include "stage/voice/phones.h"
#include "stage/voice/hearing.h"
#include "stage/voice/recogniser.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the whole voice, in frames of 10 ms ---- */

enum { FRAME = HEARING_HOP, BLOCK = PHONES_RATE_HZ, MARGIN = (HEARING_WINDOW - HEARING_HOP) / 2 };
static const double frame_s = 0.01;

typedef struct analysis {
    const phones_source *from;
    const phones_settings *settings;
    float *level_db;      /* of each frame; owned */
    hearing_frame *heard; /* owned */
    size_t frame_count;
    double speech_db; /* a frame below it has no speech */
    recogniser *by;   /* NULL: without words */
    phone_list hints; /* what it heard without words; owned */
    word_list words;  /* count 0: not known */
    uint32_t next_word;
    phones_report *report;
} analysis;

static double level_db_of(const float *sound)
{
    double sum = 0.0;
    for (int i = 0; i < FRAME; ++i)
        sum += (double)sound[i] * (double)sound[i];
    return 10.0 * log10(sum / FRAME + 1e-12);
}

/* A window of hearing begins MARGIN before its frame and ends MARGIN after it. */
static mrt_result read_around(const analysis *self, size_t at, size_t count, float *out, error *err)
{
    const int64_t first = (int64_t)(at * FRAME) - MARGIN;
    const int64_t from = first < 0 ? 0 : first,
                  wanted_end = first + (int64_t)count * FRAME + 2 * MARGIN;
    const int64_t end = wanted_end < self->from->frame_count ? wanted_end : self->from->frame_count;
    memset(out, 0, (count * FRAME + 2 * MARGIN) * sizeof *out);
    return self->from->read(self->from->data, from, out + (from - first), (size_t)(end - from),
                            err);
}

static mrt_result measure_all(analysis *self, error *err)
{
    float *block = malloc((BLOCK + 2 * MARGIN) * sizeof *block);
    self->frame_count = (size_t)(self->from->frame_count / FRAME);
    self->level_db = calloc(self->frame_count + 1, sizeof *self->level_db);
    self->heard = calloc(self->frame_count + 1, sizeof *self->heard);
    mrt_result result = MRT_OK;
    if (!block || !self->level_db || !self->heard)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a voice of %.0f s",
                           (double)self->frame_count * frame_s);
    for (size_t at = 0; at < self->frame_count && result >= 0; at += BLOCK / FRAME) {
        size_t count = self->frame_count - at;
        count = count < BLOCK / FRAME ? count : BLOCK / FRAME;
        result = read_around(self, at, count, block, err);
        for (size_t i = 0; i < count && result >= 0; ++i) {
            self->level_db[at + i] = (float)level_db_of(block + MARGIN + i * FRAME);
            hearing_measure(&self->heard[at + i], block + i * FRAME);
        }
    }
    if (result >= 0)
        hearing_level(self->heard, self->frame_count);
    free(block);
    return result;
}

static int compare_floats(const void *a, const void *b)
{
    const float first = *(const float *)a, second = *(const float *)b;
    return (first > second) - (first < second);
}

/* Between the quiet and the loud frames, and refuses what is silent. */
static mrt_result find_speech(analysis *self, error *err)
{
    static const double silent_db = -60.0, below_loud_db = 32.0, above_quiet_db = 6.0;
    float *level = malloc((self->frame_count + 1) * sizeof *level);
    if (!level)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the voice");
    for (size_t i = 0; i < self->frame_count; ++i)
        level[i] = self->level_db[i];
    qsort(level, self->frame_count, sizeof *level, compare_floats);
    const size_t count = self->frame_count;
    const double quiet = count ? (double)level[count / 20] : silent_db;
    const double loud = count ? (double)level[count - 1 - count / 20] : silent_db;
    free(level);
    if (count < 10 || loud < silent_db)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the sound is silent. Attach the sound of a voice, or raise its level");
    self->speech_db = loud - below_loud_db;
    if (self->speech_db < quiet + above_quiet_db && loud - quiet > 2.0 * above_quiet_db)
        self->speech_db = quiet + above_quiet_db;
    return MRT_OK;
}

static bool goes_on(const analysis *self, size_t at)
{
    return !self->settings->goes_on ||
           self->settings->goes_on(self->settings->data,
                                   (double)at / ((double)self->frame_count + 1.0));
}

/* ---- parts that end at pauses ---- */

static const double part_least_s = 6.0, part_most_s = 15.0;

/* Returns the frame at which the part from `from` on ends: amid the quietest 0.2 s. */
static size_t end_of_part(const analysis *self, size_t from)
{
    enum { NEAR = 10 };
    const size_t least = from + (size_t)(part_least_s / frame_s);
    const size_t most = from + (size_t)(part_most_s / frame_s);
    if (self->frame_count <= most)
        return self->frame_count;
    size_t best = most;
    double best_db = HUGE_VAL, sum = 0.0;
    for (size_t i = least - NEAR; i < most + NEAR && i < self->frame_count; ++i) {
        sum += (double)self->level_db[i];
        if (i >= least + NEAR)
            sum -= (double)self->level_db[i - 2 * NEAR];
        if (i >= least + NEAR && sum < best_db) {
            best_db = sum;
            best = i - NEAR;
        }
    }
    return best;
}

static bool has_speech(const analysis *self, size_t from, size_t end)
{
    size_t count = 0;
    for (size_t i = from; i < end; ++i)
        count += (double)self->level_db[i] > self->speech_db;
    return count > 5;
}

/* ---- sounds ---- */

/* The sounds by the words that are known, else hints for hearing. */
static mrt_result recognise(analysis *self, size_t from, size_t end, phone_list *out, error *err)
{
    const size_t count = (end - from) * FRAME;
    float *sound = malloc(count * sizeof *sound);
    int16_t *whole = malloc(count * sizeof *whole);
    mrt_result result =
        sound && whole ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the voice");
    if (result >= 0)
        result = self->from->read(self->from->data, (int64_t)(from * FRAME), sound, count, err);
    for (size_t i = 0; i < count && result >= 0; ++i)
        whole[i] = (int16_t)lrint(fmin(fmax(32767.0 * (double)sound[i], -32768.0), 32767.0));
    double score;
    const recogniser_part part = {whole, count, (double)from * frame_s};
    if (result >= 0 && self->words.count > 0)
        result = recogniser_align(self->by, &part, &self->words, self->next_word,
                                  end == self->frame_count, &self->next_word, out, err);
    else if (result >= 0)
        result = recogniser_listen(self->by, &part, out, &score, err);
    free(sound);
    free(whole);
    return result;
}

static mrt_result hear(analysis *self, size_t from, size_t end, phone_list *out, error *err)
{
    const mrt_result result = self->by ? recognise(self, from, end, &self->hints, err) : MRT_OK;
    return result < 0
               ? result
               : hearing_listen(out, self->heard, self->frame_count, from, end, &self->hints, err);
}

/* MRT_END: the words do not fit. */
static mrt_result find_all(analysis *self, phone_list *out, error *err)
{
    for (size_t from = 0; from < self->frame_count;) {
        const size_t end = end_of_part(self, from);
        mrt_result result;
        if (!goes_on(self, from))
            return error_set(err, MRT_ERR_IO, "cancelled");
        if (!has_speech(self, from, end))
            result =
                phone_list_add(out, PHONE_REST, (double)from * frame_s, (double)end * frame_s, err);
        else if (self->words.count > 0)
            result = recognise(self, from, end, out, err);
        else
            result = hear(self, from, end, out, err);
        if (result != MRT_OK)
            return result;
        from = end;
    }
    return self->words.count > 0 && self->next_word < self->words.count ? MRT_END : MRT_OK;
}

/* ---- afterwards ---- */

/* A short gap before a stop or a nasal is its closure; another one belongs to the sound before. */
static void close_gaps(phone_list *list)
{
    static const double gap_most_s = 0.2;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < list->count; ++i) {
        const phone *p = &list->phone[i];
        const bool is_gap = p->sound == PHONE_REST && kept > 0 && i + 1 < list->count &&
                            p->end_s - p->start_s < gap_most_s &&
                            list->phone[kept - 1].sound != PHONE_REST;
        if (!is_gap) {
            list->phone[kept++] = *p;
            continue;
        }
        switch (list->phone[i + 1].sound) {
        case PHONE_P:
        case PHONE_B:
        case PHONE_M:
        case PHONE_T:
        case PHONE_D:
        case PHONE_K:
        case PHONE_G:
        case PHONE_CH:
        case PHONE_JH:
        case PHONE_N:
            list->phone[i + 1].start_s = p->start_s;
            break;
        default:
            list->phone[kept - 1].end_s = p->end_s;
            break;
        }
    }
    list->count = kept;
    kept = 0;
    for (uint32_t i = 0; i < list->count; ++i) { /* pauses that meet are one */
        if (kept > 0 && list->phone[i].sound == PHONE_REST &&
            list->phone[kept - 1].sound == PHONE_REST)
            list->phone[kept - 1].end_s = list->phone[i].end_s;
        else
            list->phone[kept++] = list->phone[i];
    }
    list->count = kept;
}

static double level_of(const analysis *self, const phone *p)
{
    double level = -120.0;
    for (size_t i = (size_t)(p->start_s / frame_s);
         i < self->frame_count && (double)i * frame_s < p->end_s; ++i)
        level = fmax(level, (double)self->level_db[i]);
    return level;
}

static mrt_result find_effort(const analysis *self, phone_list *list, error *err)
{
    static const double effort_db = 12.0;
    float *level = malloc((list->count + 1) * sizeof *level);
    uint32_t count = 0;
    if (!level)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the voice");
    for (uint32_t i = 0; i < list->count; ++i)
        if (phone_is_vowel(list->phone[i].sound))
            level[count++] = (float)level_of(self, &list->phone[i]);
    qsort(level, count, sizeof *level, compare_floats);
    const double median = count > 0 ? (double)level[count / 2] : 0.0;
    free(level);
    for (uint32_t i = 0; i < list->count; ++i) {
        phone *p = &list->phone[i];
        const double effort = (level_of(self, p) - median) / effort_db;
        p->effort = p->sound == PHONE_REST || count == 0 ? 0.0 : fmin(fmax(effort, -1.0), 1.0);
    }
    return MRT_OK;
}

static uint32_t count_sounds(const phone_list *list)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < list->count; ++i)
        count += list->phone[i].sound != PHONE_REST;
    return count;
}

/* A voice has vowels and other sounds in turn, a few each second. */
static mrt_result check_voice(const phone_list *list, error *err)
{
    uint32_t vowels = 0;
    double spoken_s = 0.0;
    for (uint32_t i = 0; i < list->count; ++i) {
        const phone *p = &list->phone[i];
        vowels += phone_is_vowel(p->sound);
        spoken_s += p->sound != PHONE_REST ? p->end_s - p->start_s : 0.0;
    }
    if (vowels > 0 && count_sounds(list) >= 1.5 * spoken_s)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "no speech was found in the sound. It may be music or noise: attach the sound "
                     "of a voice");
}

static void note_unknown(analysis *self)
{
    phones_report *r = self->report;
    r->word_count = self->words.count;
    for (uint32_t i = 0; self->by && i < self->words.count; ++i) {
        const char *word = self->words.word[i];
        bool is_new = !recogniser_knows(self->by, word);
        for (uint32_t k = 0; k < i && is_new; ++k)
            is_new = strcmp(self->words.word[k], word) != 0;
        if (!is_new)
            continue;
        const size_t used = strlen(r->unknown);
        r->unknown_count += 1;
        if (used + strlen(word) + 8 < sizeof r->unknown)
            (void)snprintf(r->unknown + used, sizeof r->unknown - used, "%s%s", used ? ", " : "",
                           word);
    }
}

static mrt_result find_sounds(analysis *self, phone_list *out, error *err)
{
    phones_report *r = self->report;
    error why = {""};
    mrt_result result = recogniser_open(&self->by, &why);
    if (result == MRT_ERR_UNSUPPORTED)
        (void)snprintf(r->note, sizeof r->note,
                       "The mouth follows the spectrum alone, which is coarser: %s.", why.text);
    else if (result < 0)
        return error_set(err, result, "%s", why.text);
    note_unknown(self);
    if (!self->by)
        self->words.count = 0;
    result = find_all(self, out, err);
    if (result != MRT_END)
        return result;
    (void)snprintf(r->note, sizeof r->note,
                   "The words do not fit the voice, so the sounds were found without them. Type "
                   "exactly what is said, in English.");
    self->words.count = 0;
    out->count = 0;
    return find_all(self, out, err);
}

mrt_result phones_find(phone_list *out, phones_report *report, const phones_source *from,
                       const phones_settings *settings, error *err)
{
    analysis self = {.from = from, .settings = settings, .report = report};
    *out = (phone_list){0};
    *report = (phones_report){0};
    mrt_result result = MRT_OK;
    if (settings->words && settings->words[0])
        result = word_list_parse(&self.words, settings->words, err);
    if (result >= 0)
        result = measure_all(&self, err);
    if (result >= 0)
        result = find_speech(&self, err);
    const bool is_stopped = result >= 0 && !goes_on(&self, 0);
    if (result >= 0 && !is_stopped)
        result = find_sounds(&self, out, err);
    if (result >= 0 && !is_stopped) {
        close_gaps(out);
        close_gaps(&self.hints);
        /* Music and noise do not fool the model of the recogniser so easily. */
        result = check_voice(self.hints.count > 0 ? &self.hints : out, err);
        report->sound_count = count_sounds(out);
    }
    if (result >= 0 && !is_stopped)
        result = find_effort(&self, out, err);
    if (!is_stopped && settings->goes_on && result < 0 && !settings->goes_on(settings->data, 1.0))
        result = MRT_END;
    recogniser_close(self.by);
    word_list_finish(&self.words);
    phone_list_finish(&self.hints);
    free(self.level_db);
    free(self.heard);
    if (result != MRT_OK)
        phone_list_finish(out);
    return is_stopped ? MRT_END : result;
}
