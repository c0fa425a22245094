/* The table of the subcommands that perform takes. */
#include "take_play.h"

static const take_verb play_verbs[] = {
    {"record", "SHOW TAKE",
     "  --input SPEC, --map SPEC   who performs, as in marotte perform\n"
     "  --own NAMES    what the new layer moves (all): patterns or regions, see layer own\n"
     "  --name NAME    of the layer\n"
     "  --layer L      not a new layer: in place of what that one shows (punch-in)\n"
     "  --in T, --out T   where it is recorded (from 0, until the performance ends)\n"
     "  --fade S       cross-fade at both ends, seconds (0.25)\n"
     "  --count-in S   the take stands still for so long first\n"
     "  --preroll S    it plays so long before --in\n"
     "  --passes N     --in to --out again and again: a layer each; the last whole one is heard\n"
     "  --speed N      of the take, 0.1 to 4 (1)\n"
     "  --calibration FILE, --rezero-pedal N, --realtime, --face FILE   as in marotte perform\n"
     "Every pass is a take by itself too. q or Ctrl-C ends; what was performed is kept.\n",
     "performs over it: another layer, or a punch-in",
     TAKE_BIT(TAKE_INPUT) | TAKE_BIT(TAKE_MAP) | TAKE_BIT(TAKE_OWN) | TAKE_BIT(TAKE_NAME_OPTION) |
         TAKE_BIT(TAKE_LAYER) | TAKE_BIT(TAKE_IN) | TAKE_BIT(TAKE_OUT) | TAKE_BIT(TAKE_FADE) |
         TAKE_BIT(TAKE_COUNT_IN) | TAKE_BIT(TAKE_PREROLL) | TAKE_BIT(TAKE_PASSES) |
         TAKE_BIT(TAKE_SPEED) | TAKE_BIT(TAKE_CALIBRATION) | TAKE_BIT(TAKE_REZERO_PEDAL) |
         TAKE_BIT(TAKE_REALTIME) | TAKE_BIT(TAKE_FACE) | TAKE_BIT(TAKE_FPS),
     TAKE_RECORDS, take_record_run},
    {"export", "SHOW TAKE",
     "  --export FILE  .glb .pc2 .mdd .csv .png; .mp4: with its sound and time code; frames/: a\n"
     "                 folder of pictures; .wav: its sound; may be given many times\n"
     "  --wav          the sound too, beside the first file\n"
     "  --fps RATE     24, 25, 29.97, 30, 30000/1001, 29.97df ... (the take's, or 30)\n"
     "  --in T, --out T   a range of it\n"
     "  --face FILE    on this face (that which it was performed on)\n"
     "  --tolerance MM, --max-targets N   of glTF, as in marotte perform\n"
     "  --size WxH, --view front|side|three-quarter, --mirror, --background #RRGGBB|transparent\n"
     "                 of .mp4, pictures and sheets, as in marotte perform\n",
     "frames, pictures and sound for other programs",
     TAKE_BIT(TAKE_EXPORT) | TAKE_BIT(TAKE_WAV) | TAKE_BIT(TAKE_FPS) | TAKE_BIT(TAKE_IN) |
         TAKE_BIT(TAKE_OUT) | TAKE_BIT(TAKE_FACE) | TAKE_BIT(TAKE_TOLERANCE) |
         TAKE_BIT(TAKE_MAX_TARGETS) | TAKE_BIT(TAKE_SIZE) | TAKE_BIT(TAKE_VIEW) |
         TAKE_BIT(TAKE_MIRROR) | TAKE_BIT(TAKE_BACKGROUND),
     TAKE_READS, take_export_run},
    {"remap", "SHOW TAKE",
     "  --map SPEC        another mapping: PLUGIN[,key=value] (the same, as it was)\n"
     "  --face FILE       another face\n"
     "  --calibration FILE   of the performer's glove, one per hand\n"
     "  --hand-length MM  wrist to middle fingertip\n"
     "  --filter min_cutoff=HZ,beta=N   another One-Euro filter of the angles\n"
     "  --scene S, --shot S   of the new take's slate (as the old one's)\n"
     "The old take stays as it is. Says how far apart the two are.\n",
     "performs a take anew, as another take",
     TAKE_BIT(TAKE_MAP) | TAKE_BIT(TAKE_FACE) | TAKE_BIT(TAKE_CALIBRATION) |
         TAKE_BIT(TAKE_HAND_LENGTH) | TAKE_BIT(TAKE_FILTER) | TAKE_BIT(TAKE_SCENE) |
         TAKE_BIT(TAKE_SHOT),
     TAKE_WRITES, take_remap_run},
    {"diff", "SHOW TAKE TAKE",
     "  --region R,R   only these: mouth, jaw, brows, lids, eyes, cheeks, nose, head\n"
     "  --fps RATE     frames that are compared (the first take's, or 30)\n"
     "  --in T, --out T   a range\n"
     "  --face FILE    both on this face\n"
     "  --csv FILE     mm of each region at each frame\n"
     "A vertex belongs to the region of the contact that is nearest, within the rig's radius.\n",
     "how far apart two takes move the face",
     TAKE_BIT(TAKE_REGION) | TAKE_BIT(TAKE_FPS) | TAKE_BIT(TAKE_IN) | TAKE_BIT(TAKE_OUT) |
         TAKE_BIT(TAKE_FACE) | TAKE_BIT(TAKE_CSV),
     TAKE_READS, take_diff_run},
    {"log", "SHOW TAKE",
     "  --track N      which one (marotte take show); not needed where there is one\n"
     "  --out FILE.csv\n"
     "The table is that of plugins/log/README.md: --input log:FILE.csv performs it.\n",
     "a track's raw samples as a table", TAKE_BIT(TAKE_TRACK) | TAKE_BIT(TAKE_OUT), TAKE_READS,
     take_log_run},
};
const take_verbs take_play_verbs = {"Perform over, perform anew, compare, export", play_verbs,
                                    sizeof play_verbs / sizeof play_verbs[0]};
