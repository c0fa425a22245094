/* voice_fit --sentences | [WAV CSV]... - fits the network of core/stage/voice/hearing.c and writes
 * core/stage/voice/hearing_weights.h to stdout. Learns from voices of espeak-ng, whose own phoneme
 * events are the truth, and from the given recordings (one channel, 22 050 Hz) with their sounds as
 * `marotte take mouth --out` writes them. The sentences and voices are others than those that
 * tests/bench/voice.sh measures. Level, colour, noise and the length of the throat vary. Prints to
 * stderr, after each round, how many frames of voices and sentences that were held out are in the
 * right group. --sentences: prints what is said, for voices of other programs (voice_fit.sh). */
#include "stage/voice/hearing.h"

#include <espeak-ng/speak_lib.h>
#include <sndfile.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    RATE_HZ = 22050,
    SOUND_MAX = RATE_HZ * 30,
    PHONEMES_MAX = 1000,
    FRAMES_MAX = 2000000,
    LEAD = PHONES_RATE_HZ / 2,
    TAPS = 16
};

static const char *const fit_voices[] = {
    "en-us+m1",        "en-us+m2",           "en-us+m4",          "en-us+m6",
    "en-us+m7",        "en-us+f1",           "en-us+f2",          "en-us+f4",
    "en-us+Andy",      "en-us+Annie",        "en-us+linda",       "en-us+Michael",
    "en-us+steph",     "en-us+Mario",        "en-us+rob",         "en-gb-x-rp",
    "en-gb-x-rp+m1",   "en-gb-x-rp+m7",      "en-gb-x-rp+f2",     "en-gb-x-rp+f4",
    "en-gb-x-rp+Lee",  "en-gb-scotland+m4",  "en-gb-scotland+f1", "en-gb-x-gbclan+m2",
    "en-us+klatt2",    "en-gb-x-rp+belinda", "en-us+max",         "en-us+klatt4",
    "en-gb-x-rp+adam",
};
static const char *const held_voices[] = {"en-us+f5", "en-us+m8", "en-gb-x-rp+m5"};
static const char *const fit_sentences[] = {
    "The big brown fox jumped over my lazy lamb. Papa made a pumpkin pie, and mama ate most of it.",
    "We saw a huge shoe in the zoo. Far from the park, a calm farmer feeds three sheep.",
    "Bob and Tim amble home by moonlight. You may keep the cheap ship, but give me the bigger map.",
    "No one knows how long the king sang. Hide the purple book under a chair before noon.",
    "He thought all of us ought to be at work early. Easy rules keep folk cheerful and quiet.",
    "I am a member of the members club, and I remember number nine. Perhaps my pet rabbit sleeps.",
    "A pot of tea helps to pass the evening. Rice is often served in round bowls.",
    "The juice of lemons makes fine punch. Four hours of steady work faced us.",
    "Glue the sheet to the dark green background. These days a chicken leg is a rare dish.",
    "Give us a hint, and we shall guess the rest. Doctor Gray took a taxi to the airport.",
    "Kick the ball straight and follow through. Help the woman get back to her feet.",
    "Several boats bobbed about in the harbour. Nobody noticed the empty cabin by the lake.",
    "Vera gave Victor seven very heavy velvet covers. If Phil laughs, half of the staff laugh.",
    "Watch which way the wind was blowing. We wish you would wait while William washes up.",
    "Your yellow yacht is younger than you think. Those brothers breathe through their teeth.",
    "Measure the treasure at leisure. The judge changed the charges in January.",
    "Good cooks should look at the sugar. Two cool fools flew to the moon in June.",
    "Boys enjoy noisy toys. The loud crowd found a way out of town around the house.",
    "Pete keeps a pack of paper maps in the top pocket of his damp camping bag.",
    "Mobile phones began to ring beneath the seats. Stop grabbing the cupboard, Abby.",
    "A simple sample of maple syrup came from Mabel. Jump up, lap it up, and climb back.",
    "The robber grabbed a ruby and a rubber band. Problems with plumbing trouble the public.",
    "What time does the next train to Paddington depart? I left my umbrella upon the platform.",
    "Under the bridge, ten dancing ducks did tricks. Don't dare to touch that wet paint today.",
    "Cats like cream, and crows like corn. Great green goggles go well with a grey gown.",
    "Long strings hang along the ceiling. Sing a new song while the young king is dining.",
    "Little Lily rolled a yellow lolly along the long hall. Really, rural rulers rarely worry.",
    "Early birds turn and chirp first. Her nurse heard the world's worst words on Thursday.",
    "Hot coffee got Don to stop at the shop. A strong dog got lost on top of a rock.",
    "Bad apples hang on black branches. That man had a bag of candy in his left hand.",
    "Up above, some young monks come to lunch. The sun and the rain must be enough for us.",
    "Red hens get eggs ready. Ten men sent seven letters and then went to bed.",
    "Six thin kids sit still in this dim inn. It is his fifth visit since the winter.",
    "Say, may they play a game on the same day? Eight grey whales came late to the bay.",
    "My wife likes to drive at night, while I like to ride my bike by the wide white pines.",
    "Go home, Joe, and close the old window slowly. Only those boats float over the cold ocean.",
    "Lord George walked to the law court on the fourth morning. Pour more water for the horse.",
    "Hello there! How are you? Thank you, I'm fine. Well, maybe not. Come on, let's begin!",
    "Oh no, I forgot my line again. What was it? Mumble, mumble, something about a baby bee.",
    "Ladies and gentlemen, welcome to the show. Please hush, for the puppets are about to speak.",
    "Twenty thousand people from Spain and Poland came past the palace between March and April.",
    "Smooth snow swirled and sparkled. Clumsy clowns blow bubbles. Fresh fruit from France.",
};
static const char *const held_sentences[] = {
    "A brave black bull bumped into the barn. My grandmother bakes plain bread for Pam.",
    "The captain promised to explore every part of the map. Five vans move fast from Vienna.",
    "Why did the umpire blame Robin? Maybe Ben can mop up a bit of jam with a napkin.",
    "She was sure that the blue chair would fit. Two wolves howled near the frozen river.",
};
#define COUNT(a) ((int)(sizeof(a) / sizeof *(a)))

static const struct {
    hearing_group group;
    const char *names; /* of espeak-ng, between spaces */
} groups[] = {
    {HEARING_LIPS, " p b m "},
    {HEARING_TEETH, " f v "},
    {HEARING_TONGUE, " T D "},
    {HEARING_TIP, " t d t# t2 * "},
    {HEARING_BACK, " k g N h "},
    {HEARING_HUSH, " S Z tS dZ "},
    {HEARING_HISS, " s z "},
    {HEARING_NASAL, " n l "},
    {HEARING_R, " r r- 3: 3 "},
    {HEARING_A, " a A: A@ V aI aU aa a: O2 aI@ aU@ "},
    {HEARING_SCHWA, " @ @2 @5 @L a# "},
    {HEARING_E, " eI E e@ e "},
    {HEARING_I, " i: i I i@ j I2 i@3 I# "},
    {HEARING_O, " oU O O: o@ O@ OI 0# o: "},
    {HEARING_U, " w u: u U U@ "},
};

static hearing_group group_of(const char *name, bool is_british)
{
    char between[12];
    (void)snprintf(between, sizeof between, " %.8s ", name);
    if (strcmp(name, "0") == 0)
        return is_british ? HEARING_O : HEARING_A;
    for (int i = 0; i < COUNT(groups); ++i)
        if (strstr(groups[i].names, between))
            return groups[i].group;
    return HEARING_REST;
}

static hearing_group group_named(const char *name, double length_s)
{
    for (int i = 1; i < PHONE_COUNT; ++i)
        if (strcmp(phone_name[i], name) == 0)
            return hearing_group_of((phone_sound)i, length_s);
    return HEARING_REST;
}

/* ---- voices ---- */

static struct {
    short sound[SOUND_MAX];
    int count, phoneme_count;
    struct {
        double at_s;
        hearing_group group;
    } phoneme[PHONEMES_MAX];
    bool is_british;
} said;

typedef struct examples {
    hearing_frame *frame; /* FRAMES_MAX, with silence between the utterances */
    uint8_t *group;
    int count;
} examples;

static uint32_t seed = 1;

static double chance(void)
{
    seed = seed * 1664525u + 1013904223u;
    return (double)(seed >> 8) / 16777216.0;
}

static int on_sound(short *sound, int count, espeak_EVENT *events)
{
    for (; events->type != espeakEVENT_LIST_TERMINATED; ++events)
        if (events->type == espeakEVENT_PHONEME && said.phoneme_count < PHONEMES_MAX) {
            said.phoneme[said.phoneme_count].at_s = 1e-3 * events->audio_position;
            said.phoneme[said.phoneme_count++].group = group_of(events->id.string, said.is_british);
        }
    for (int i = 0; sound && i < count && said.count < SOUND_MAX; ++i)
        said.sound[said.count++] = sound[i];
    return 0;
}

/* The sound at a frame of PHONES_RATE_HZ: a sinc under a Hann window, below 7.4 kHz. */
static double sound_at(int at, double pace)
{
    enum { STEP = 441, PHASES = 320 }; /* RATE_HZ : PHONES_RATE_HZ */
    static double kernel[PHASES][2 * TAPS];
    const double pi = 3.14159265358979323846, pass = 0.67;
    static bool is_ready;
    for (int k = 0; !is_ready && k < PHASES * 2 * TAPS; ++k) {
        const double x = k % (2 * TAPS) - TAPS + 1 - (double)(k / (2 * TAPS)) / PHASES;
        const double y = pi * pass * x;
        kernel[k / (2 * TAPS)][k % (2 * TAPS)] =
            pass * (fabs(y) > 1e-9 ? sin(y) / y : 1.0) * (0.5 + 0.5 * cos(pi * x / TAPS));
    }
    is_ready = true;
    const int64_t place = (int64_t)(pace * at * STEP);
    const int first = (int)(place / PHASES) - TAPS + 1;
    double sum = 0.0;
    for (int k = 0; at >= 0 && k < 2 * TAPS; ++k)
        if (first + k >= 0 && first + k < said.count)
            sum += said.sound[first + k] / 32768.0 * kernel[place % PHASES][k];
    return sum;
}

static void add_utterance(examples *to)
{
    const double gain = 0.1 + 0.9 * chance(), noise = pow(10.0, -3.5 + 1.5 * chance()) * gain;
    const double tilt = 0.6 * chance() - 0.3, pace = 0.9 + 0.2 * chance();
    const int count =
        (int)((double)said.count / pace / RATE_HZ * 100.0) + 2 * LEAD / HEARING_HOP - 3;
    const int sounds = (count + 3) * HEARING_HOP;
    float *sound = malloc((size_t)sounds * sizeof *sound);
    double last = 0.0;
    if (!sound || to->count + count + HEARING_MOMENTS > FRAMES_MAX)
        fputs("too many frames\n", stderr), exit(1);
    for (int i = 0; i < sounds; ++i) {
        const double now = sound_at(i - LEAD, pace);
        sound[i] = (float)(gain * (now + tilt * last) + noise * (chance() + chance() - 1.0));
        last = now;
    }
    for (int i = 0, p = -1; i < count; ++i) {
        const int first = i * HEARING_HOP - HEARING_HOP / 2;
        float window[HEARING_WINDOW] = {0};
        for (int k = 0; k < HEARING_WINDOW; ++k)
            window[k] = first + k >= 0 ? sound[first + k] : 0.0f;
        hearing_measure(&to->frame[to->count + i], window);
        const double at_s = pace * ((i + 0.5) / 100.0 - (double)LEAD / PHONES_RATE_HZ);
        while (p + 1 < said.phoneme_count && said.phoneme[p + 1].at_s <= at_s)
            p += 1;
        to->group[to->count + i] = (uint8_t)(p < 0 ? HEARING_REST : said.phoneme[p].group);
    }
    hearing_level(to->frame + to->count, (size_t)count);
    to->count += count;
    free(sound);
}

static void speak(examples *to, const char *voice, const char *text, int rate)
{
    said.count = said.phoneme_count = 0;
    said.is_british = strncmp(voice, "en-gb", 5) == 0;
    espeak_SetParameter(espeakRATE, rate, 0);
    if (espeak_SetVoiceByName(voice) != EE_OK ||
        espeak_Synth(text, strlen(text) + 1, 0, POS_CHARACTER, 0, espeakCHARS_UTF8, NULL, NULL) !=
            EE_OK ||
        said.count == 0) {
        fprintf(stderr, "espeak-ng has no voice %s\n", voice);
        exit(1);
    }
    add_utterance(to);
}

static void read_recording(examples *to, const char *wav, const char *csv)
{
    enum { TIMES = 4 }; /* each with other variations */
    SF_INFO info = {0};
    SNDFILE *sound = sf_open(wav, SFM_READ, &info);
    FILE *sounds = fopen(csv, "r");
    char line[256], name[9];
    double from_s, to_s;
    if (!sound || !sounds || info.samplerate != RATE_HZ || info.channels != 1) {
        fprintf(stderr, "%s must have one channel of %d Hz, and %s its sounds\n", wav, RATE_HZ,
                csv);
        exit(1);
    }
    said.count = (int)sf_read_short(sound, said.sound, SOUND_MAX);
    said.phoneme_count = 0;
    while (fgets(line, sizeof line, sounds) && said.phoneme_count < PHONEMES_MAX)
        if (sscanf(line, "%lf,%lf,%8s", &from_s, &to_s, name) == 3) {
            said.phoneme[said.phoneme_count].at_s = from_s;
            said.phoneme[said.phoneme_count++].group = group_named(name, to_s - from_s);
        }
    sf_close(sound);
    (void)fclose(sounds);
    for (int i = 0; i < TIMES; ++i)
        add_utterance(to);
}

static examples speak_all(const char *const *voices, int voice_count, const char *const *sentences,
                          int sentence_count)
{
    examples out = {calloc(FRAMES_MAX, sizeof *out.frame), calloc(FRAMES_MAX, 1), 0};
    if (!out.frame || !out.group)
        exit(1);
    for (int v = 0; v < voice_count; ++v)
        for (int s = 0; s < sentence_count; ++s)
            speak(&out, voices[v], sentences[s], 125 + (int)(75.0 * chance()));
    return out;
}

/* ---- the network, in float; Adam (Kingma and Ba, 2015) ---- */

enum { INS = HEARING_INPUTS + 1, MIDS = HEARING_HIDDEN + 1, FIRST = HEARING_HIDDEN * INS };
enum { WEIGHTS = FIRST + HEARING_GROUPS * MIDS, BATCH = 64 };
static float weight[WEIGHTS], slope[WEIGHTS], mean[WEIGHTS], square[WEIGHTS];

typedef struct pass {
    float in[INS], sum[HEARING_HIDDEN], mid[MIDS], out[HEARING_GROUPS];
} pass;

static int hear(pass *p, const examples *from, int at)
{
    int best = 0;
    hearing_look(p->in, from->frame, (size_t)from->count, (size_t)at);
    p->in[HEARING_INPUTS] = 1.0f;
    for (int h = 0; h < HEARING_HIDDEN; ++h) {
        float sum = 0.0f;
        for (int i = 0; i < INS; ++i)
            sum += weight[h * INS + i] * p->in[i];
        p->sum[h] = sum;
        p->mid[h] = sum / (1.0f + fabsf(sum));
    }
    p->mid[HEARING_HIDDEN] = 1.0f;
    for (int g = 0; g < HEARING_GROUPS; ++g) {
        float sum = 0.0f;
        for (int h = 0; h < MIDS; ++h)
            sum += weight[FIRST + g * MIDS + h] * p->mid[h];
        p->out[g] = sum;
        best = sum > p->out[best] ? g : best;
    }
    return best;
}

static void learn(const examples *from, int at)
{
    pass p;
    float total = 0.0f, back[HEARING_HIDDEN] = {0};
    const float top = p.out[hear(&p, from, at)];
    for (int g = 0; g < HEARING_GROUPS; ++g)
        total += p.out[g] = expf(p.out[g] - top);
    for (int g = 0; g < HEARING_GROUPS; ++g) {
        const float off = p.out[g] / total - (g == from->group[at] ? 1.0f : 0.0f);
        for (int h = 0; h < MIDS; ++h)
            slope[FIRST + g * MIDS + h] += off * p.mid[h];
        for (int h = 0; h < HEARING_HIDDEN; ++h)
            back[h] += off * weight[FIRST + g * MIDS + h];
    }
    for (int h = 0; h < HEARING_HIDDEN; ++h) {
        const float bend = 1.0f + fabsf(p.sum[h]), off = back[h] / (bend * bend);
        for (int i = 0; i < INS; ++i)
            slope[h * INS + i] += off * p.in[i];
    }
}

static void step(int number, float rate)
{
    const float keep = 0.9f, keep_square = 0.999f, decay = 1e-4f;
    const float warm =
        sqrtf(1.0f - powf(keep_square, (float)number)) / (1.0f - powf(keep, (float)number));
    for (int i = 0; i < WEIGHTS; ++i) {
        const float s = slope[i] / BATCH + decay * weight[i];
        mean[i] = keep * mean[i] + (1.0f - keep) * s;
        square[i] = keep_square * square[i] + (1.0f - keep_square) * s * s;
        weight[i] -= rate * warm * mean[i] / (sqrtf(square[i]) + 1e-7f);
        slope[i] = 0.0f;
    }
}

static void fit(const examples *from, const examples *held)
{
    enum { ROUNDS = 6 };
    const int steps = from->count / BATCH;
    for (int i = 0; i < WEIGHTS; ++i)
        weight[i] = (float)(0.16 * (chance() - 0.5));
    for (int round = 0, number = 0; round < ROUNDS; ++round) {
        for (int s = 0; s < steps; ++s) {
            const float left = 1.0f - (float)number / (float)(ROUNDS * steps);
            for (int b = 0; b < BATCH; ++b)
                learn(from, (int)(chance() * from->count));
            step(++number, 0.002f * left);
        }
        int right = 0, lips = 0, lips_right = 0;
        for (int i = 0; i < held->count; ++i) {
            pass p;
            const int group = hear(&p, held, i);
            right += group == held->group[i];
            lips += held->group[i] == HEARING_LIPS;
            lips_right += group == HEARING_LIPS && held->group[i] == HEARING_LIPS;
        }
        fprintf(stderr, "round %d: %.1f %% of held out frames, %.1f %% of closed ones\n", round + 1,
                100.0 * right / held->count, 100.0 * lips_right / lips);
    }
}

static void print(const char *name, int row_count, int count, const float *of)
{
    printf("static const int16_t %s[%d][%d] = {\n", name, row_count, count);
    for (int r = 0; r < row_count; ++r) {
        printf("{");
        for (int i = 0; i < count; ++i)
            printf("%s%.0f", i ? ", " : "",
                   fmin(fmax(256.0 * (double)of[r * count + i], -32767.0), 32767.0));
        printf("},\n");
    }
    printf("};\n");
}

#define INTEGERS "stdint" /* header of int16_t */

int main(int argc, char **argv)
{
    for (int i = 0; argc == 2 && i < COUNT(fit_sentences); ++i)
        puts(fit_sentences[i]);
    if (argc == 2)
        return 0;
    if (espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, 0, NULL,
                          espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT) !=
        RATE_HZ) {
        fputs("espeak-ng has no voices of 22 050 Hz\n", stderr);
        return 1;
    }
    espeak_SetSynthCallback(on_sound);
    examples from = speak_all(fit_voices, COUNT(fit_voices), fit_sentences, COUNT(fit_sentences));
    for (int i = 1; i + 1 < argc; i += 2)
        read_recording(&from, argv[i], argv[i + 1]);
    const examples held =
        speak_all(held_voices, COUNT(held_voices), held_sentences, COUNT(held_sentences));
    fprintf(stderr, "%d frames, %d held out\n", from.count, held.count);
    fit(&from, &held);
    puts("/* stage/voice/hearing_weights.h - weights of the network of hearing.c, in units of "
         "1/256; the\n"
         " * last of each row is added. Written by tests/bench/voice_fit. Only for hearing.c. */\n"
         "#ifndef MAROTTE_STAGE_VOICE_HEARING_WEIGHTS_H\n"
         "#define MAROTTE_STAGE_VOICE_HEARING_WEIGHTS_H\n"
         "#include <" INTEGERS ".h>\n\n"
         "#define HEARING_WEIGHT_UNIT 256.0f\n");
    print("hearing_first", HEARING_HIDDEN, INS, weight);
    print("hearing_second", HEARING_GROUPS, MIDS, weight + FIRST);
    puts("\n#endif");
    return 0;
}
