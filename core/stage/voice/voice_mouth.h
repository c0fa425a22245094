/* stage/voice/voice_mouth.h - "Mouth from this voice": the sound of a take becomes poses of the
 * mouth, as a layer of the take. The poses are stored like those that were played on the palette
 * (perform/palette.h), so they replay bit for bit wherever they were found. Leaves out the edit's
 * undo, and who runs it. Any thread that may block and owns the show object. */
#ifndef MAROTTE_STAGE_VOICE_VOICE_MOUTH_H
#define MAROTTE_STAGE_VOICE_VOICE_MOUTH_H
#include "stage/mapping/instance.h"
#include "stage/voice/phones.h"
#include "show/edit.h"
#include "show/show.h"

#define VOICE_MOUTH_LAYER     "voice mouth"
#define VOICE_MOUTH_AXIS_MOST 1.5 /* of jaw and lips */

typedef struct voice_mouth_settings {
    const take *take;             /* with its edits and its sound */
    const take_performance *like; /* its face: rig, hashes; NULL: that of its first clip */
    double jaw, lips;             /* 0..VOICE_MOUTH_AXIS_MOST; 1: as the poses are */
    phones_settings phones;
} voice_mouth_settings;

typedef struct voice_mouth_report {
    phones_report phones;
    double length_s; /* of the voice within the take */
    bool is_again;   /* it replaces the layer of an earlier run */
} voice_mouth_report;

/* Whether a face can say something: its poses have lips that close and an open mouth. Else the
 * error names the first missing pose. */
CHECKED mrt_result voice_mouth_check_face(const mrt_rig_pose *poses, uint32_t count, error *err);
/* Writes the mouth into the show, and returns the edit that adds it to the take. `sounds` may be
 * NULL; the caller finishes it. MRT_END: cancelled. */
CHECKED mrt_result voice_mouth_make(edit *out, voice_mouth_report *report, phone_list *sounds,
                                    show *s, const voice_mouth_settings *settings, error *err);
/* Returns one line about a result: "412 sounds in 37 s; 2 words are not in the dictionary: ...". */
void voice_mouth_describe(char *out, size_t capacity, const voice_mouth_report *report);

#endif
