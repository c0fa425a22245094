/* demo_voice TEXT VOICE.ogg PHONEMES.csv - synthesises the demo's text with espeak-ng. Writes the
 * voice and the times of its phonemes from one run, so that they match. Built only with
 * libespeak-ng. Users do not need espeak-ng, because both files are in the repository. */
#include <espeak-ng/speak_lib.h>
#include <sndfile.h>

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const char voice_name[] = "en-gb-x-rp+m3";
enum { WORDS_A_MINUTE = 128, PITCH = 46, PITCH_RANGE = 62, TEXT_MAX = 4096, WORD_MAX = 32 };
/* Before the first phoneme the hand shows its neutral pose, then starts to move. */
static const double lead_s = 1.5, tail_s = 0.8;
static const double loudest = 0.7, vorbis_quality = 0.35;

typedef struct script {
    char text[TEXT_MAX]; /* without the stars */
    bool is_stressed[TEXT_MAX];
    size_t length;
} script;

typedef struct output { /* for the callback, which gets no user data */
    const script *from;
    FILE *phonemes;
    char word[WORD_MAX]; /* begins with the next phoneme */
    short sound[22050 * 60];
    size_t frame_count;
} output;
static output out;

/* Reads the text without comment lines and stars. Returns false if the file is too long or cannot
 * be read. */
static bool read_script(script *to, const char *path)
{
    FILE *in = fopen(path, "rb");
    bool is_comment = false, is_stressed = false, is_line_start = true;
    int c;
    if (!in)
        return false;
    while ((c = fgetc(in)) != EOF && to->length < TEXT_MAX - 1) {
        is_comment = is_line_start ? c == '#' : is_comment;
        is_line_start = c == '\n';
        if (c == '*')
            is_stressed = !is_stressed;
        if (is_comment || c == '*')
            continue;
        to->is_stressed[to->length] = is_stressed;
        to->text[to->length++] = (char)(c == '\n' ? ' ' : c);
    }
    const bool is_read = c == EOF && !ferror(in);
    fclose(in);
    return is_read;
}

/* position: index of the word's first letter, from 1. A star follows a stressed word. */
static void note_word(int position)
{
    const size_t first = position > 0 ? (size_t)position - 1 : 0;
    size_t used = 0;
    for (size_t i = first; i < out.from->length && used < WORD_MAX - 2; ++i) {
        if (!isalpha((unsigned char)out.from->text[i]))
            break;
        out.word[used++] = out.from->text[i];
    }
    if (used > 0 && out.from->is_stressed[first])
        out.word[used++] = '*';
    out.word[used] = '\0';
}

static void write_phoneme(const espeak_EVENT *event)
{
    const char *name = event->id.string;
    const bool is_sound =
        isalpha((unsigned char)name[0]) || name[0] == '@' || name[0] == '0' || name[0] == '3';
    const int time_ms = event->audio_position + (int)(1000.0 * lead_s);
    fprintf(out.phonemes, "%d.%03d,%.8s,%s\n", time_ms / 1000, time_ms % 1000,
            is_sound ? name : "_", is_sound ? out.word : "");
    if (is_sound)
        out.word[0] = '\0';
}

static int on_sound(short *sound, int count, espeak_EVENT *events)
{
    for (; events->type != espeakEVENT_LIST_TERMINATED; ++events) {
        if (events->type == espeakEVENT_WORD)
            note_word(events->text_position);
        if (events->type == espeakEVENT_PHONEME)
            write_phoneme(events);
    }
    for (int i = 0; sound && i < count && out.frame_count < sizeof out.sound / sizeof *out.sound;
         ++i)
        out.sound[out.frame_count++] = sound[i];
    return 0;
}

static bool write_voice(const char *path, int rate_hz)
{
    SF_INFO info = {
        .samplerate = rate_hz, .channels = 1, .format = SF_FORMAT_OGG | SF_FORMAT_VORBIS};
    double quality = vorbis_quality, most = 1.0;
    SNDFILE *file = sf_open(path, SFM_WRITE, &info);
    if (!file)
        return false;
    sf_command(file, SFC_SET_VBR_ENCODING_QUALITY, &quality, sizeof quality);
    for (size_t i = 0; i < out.frame_count; ++i)
        most = fmax(most, fabs((double)out.sound[i]));
    const long lead = lround(lead_s * rate_hz), tail = lround(tail_s * rate_hz);
    bool is_written = true;
    for (long i = -lead; i < (long)out.frame_count + tail; ++i) {
        const bool is_sound = i >= 0 && i < (long)out.frame_count;
        const double value = is_sound ? loudest * out.sound[i] / most : 0.0;
        is_written = is_written && sf_write_double(file, &value, 1) == 1;
    }
    return sf_close(file) == 0 && is_written;
}

int main(int argument_count, char **arguments)
{
    static script from;
    if (argument_count != 4) {
        fputs("usage: demo_voice TEXT VOICE.ogg PHONEMES.csv\n", stderr);
        return 2;
    }
    if (!read_script(&from, arguments[1])) {
        fprintf(stderr, "demo_voice: cannot read %s, or it is too long\n", arguments[1]);
        return 1;
    }
    const int rate_hz =
        espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, 0, NULL,
                          espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT);
    if (rate_hz <= 0 || espeak_SetVoiceByName(voice_name) != EE_OK) {
        fprintf(stderr, "demo_voice: espeak-ng has no voice %s\n", voice_name);
        return 1;
    }
    out.from = &from;
    out.phonemes = fopen(arguments[3], "wb");
    if (!out.phonemes) {
        fprintf(stderr, "demo_voice: cannot write %s\n", arguments[3]);
        return 1;
    }
    fprintf(out.phonemes,
            "# When the phonemes of demo.ogg begin. Written by plugins/log/demo_voice.c from "
            "demo.txt;\n# espeak-ng's names, _ is a pause, a star follows a stressed word.\n"
            "time_s,phoneme,word\n");
    espeak_SetParameter(espeakRATE, WORDS_A_MINUTE, 0);
    espeak_SetParameter(espeakPITCH, PITCH, 0);
    espeak_SetParameter(espeakRANGE, PITCH_RANGE, 0);
    espeak_SetSynthCallback(on_sound);
    const bool is_said = espeak_Synth(from.text, from.length + 1, 0, POS_CHARACTER, 0,
                                      espeakCHARS_UTF8, NULL, NULL) == EE_OK;
    espeak_Terminate();
    const bool is_complete = fclose(out.phonemes) == 0 && write_voice(arguments[2], rate_hz);
    if (!is_said || !is_complete) {
        fputs("demo_voice: the files are not complete\n", stderr);
        return 1;
    }
    return 0;
}
