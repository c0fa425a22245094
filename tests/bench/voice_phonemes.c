/* voice_phonemes VOICE WORDS OUT.wav OUT.csv - speaks words with espeak-ng and writes the voice and
 * when each of its phonemes begins, as the truth for tests of "Mouth from this voice". */
#include <espeak-ng/speak_lib.h>
#include <sndfile.h>

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { WORDS_A_MINUTE = 150, SECONDS_MAX = 120, LEAD_FRAMES = 6615 }; /* 0.3 s of silence */
static struct {
    FILE *phonemes;
    short sound[22050 * SECONDS_MAX];
    sf_count_t frame_count;
} out;

static int on_sound(short *sound, int count, espeak_EVENT *events)
{
    for (; events->type != espeakEVENT_LIST_TERMINATED; ++events) {
        const char *name = events->id.string;
        const char first = name[0];
        if (events->type != espeakEVENT_PHONEME)
            continue;
        fprintf(out.phonemes, "%.3f,%.8s\n", 0.3 + events->audio_position / 1000.0,
                isalpha((unsigned char)first) || strchr("@03", first) ? name : "_");
    }
    for (int i = 0; sound && i < count && out.frame_count < 22050 * SECONDS_MAX; ++i)
        out.sound[out.frame_count++] = sound[i];
    return 0;
}

int main(int argc, char **argv)
{
    if (argc != 5) {
        fputs("usage: voice_phonemes VOICE WORDS OUT.wav OUT.csv\n", stderr);
        return 2;
    }
    const int rate_hz =
        espeak_Initialize(AUDIO_OUTPUT_SYNCHRONOUS, 0, NULL,
                          espeakINITIALIZE_PHONEME_EVENTS | espeakINITIALIZE_DONT_EXIT);
    if (rate_hz != 22050 || espeak_SetVoiceByName(argv[1]) != EE_OK) {
        fprintf(stderr, "voice_phonemes: espeak-ng has no voice %s\n", argv[1]);
        return 1;
    }
    out.phonemes = fopen(argv[4], "wb");
    if (!out.phonemes)
        return 1;
    out.frame_count = LEAD_FRAMES;
    espeak_SetParameter(espeakRATE, WORDS_A_MINUTE, 0);
    espeak_SetSynthCallback(on_sound);
    const int is_said = espeak_Synth(argv[2], strlen(argv[2]) + 1, 0, POS_CHARACTER, 0,
                                     espeakCHARS_UTF8, NULL, NULL) == EE_OK;
    espeak_Terminate();
    SF_INFO info = {
        .samplerate = rate_hz, .channels = 1, .format = SF_FORMAT_WAV | SF_FORMAT_PCM_16};
    SNDFILE *file = sf_open(argv[3], SFM_WRITE, &info);
    const int is_written =
        file && sf_write_short(file, out.sound, out.frame_count) == out.frame_count;
    if (file)
        sf_close(file);
    return fclose(out.phonemes) == 0 && is_said && is_written ? 0 : 1;
}
