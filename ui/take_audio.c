/* Subcommands of a take's sound. */
#include "take/sound_file.h"
#include "take_change.h"

#include <math.h>

static bool show_part(void *data, double part)
{
    progress_show(data, part, "");
    return true;
}

static mrt_result ask_attach(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    double offset_s = 0.0, gain = 1.0;
    mrt_result result = take_number(call, TAKE_OFFSET, -1e6, 1e6, &offset_s, err);
    if (result >= 0)
        result = take_number(call, TAKE_GAIN, 0.0, 10.0, &gain, err);
    if (result < 0)
        return result;
    const sound_file_watch watch = {show_part, &call->shown};
    edit *e = take_change_add(out, EDIT_AUDIO_ATTACH);
    e->offset_ns = llround(offset_s * 1e9);
    e->gain = gain;
    progress_start(&call->shown, "sound");
    result =
        sound_file_import(&e->audio, call->show, call->word[2], SOUND_FILE_CUT_REFUSE, &watch, err);
    progress_end(&call->shown);
    return result;
}

static mrt_result ask_offset(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    double offset_s = 0.0;
    edit *e = take_change_add(out, EDIT_AUDIO_OFFSET);
    mrt_result result = take_number_of(call, "SECONDS", call->word[2], -1e6, 1e6, &offset_s, err);
    e->offset_ns = llround(offset_s * 1e9);
    return result;
}

static mrt_result ask_gain(take_call *call, const take *t, take_change *out, error *err)
{
    (void)t;
    edit *e = take_change_add(out, EDIT_AUDIO_GAIN);
    return take_number_of(call, "GAIN", call->word[2], 0.0, 10.0, &e->gain, err);
}

static mrt_result ask_detach(take_call *call, const take *t, take_change *out, error *err)
{
    (void)call, (void)t, (void)err;
    take_change_add(out, EDIT_AUDIO_DETACH);
    return MRT_OK;
}

#define RUN(name)                                                                                  \
    static mrt_result run_##name(take_call *call, error *err)                                      \
    {                                                                                              \
        return take_change_run(call, ask_##name, err);                                             \
    }
RUN(attach)
RUN(offset)
RUN(gain)
RUN(detach)

static const take_verb audio_verbs[] = {
    {"audio attach", "SHOW TAKE FILE",
     "  --offset S   where it starts on the take's timeline, seconds (0)\n"
     "  --gain G     0 to 10 (1)\n"
     "WAV, FLAC, Ogg, AIFF and others; it is kept in the show, sample by sample.\n",
     "gives a take a sound", TAKE_BIT(TAKE_OFFSET) | TAKE_BIT(TAKE_GAIN), TAKE_WRITES, run_attach},
    {"audio offset", "SHOW TAKE SECONDS", "", "moves its sound", 0, TAKE_WRITES, run_offset},
    {"audio gain", "SHOW TAKE GAIN", "", "how loud its sound is", 0, TAKE_WRITES, run_gain},
    {"audio detach", "SHOW TAKE", "", "takes its sound away", 0, TAKE_WRITES, run_detach},
};
const take_verbs take_audio_verbs = {"Sound", audio_verbs,
                                     sizeof audio_verbs / sizeof audio_verbs[0]};
