#include "settings.h"

#include "faces.h"
#include "mapping.h"
#include "placement.h"

static const char *const mode_labels[] = {"Classic", "Mask", "Layered waldo", "Speaking", NULL};
static const char *const device_labels[] = {"Automatic", "Every joint", "Points", "Five curls",
                                            NULL};
static const char *const neutral_labels[] = {"At engage", "Stored", NULL};
static const char *const layer_labels[] = {"Mouth", "Brows and lids", "Head", NULL};
static const char *const region_labels[] = {"Whole face", "Mouth", "Brows and lids", "Head", NULL};

/* clang-format off */
#define NUMBER(set, id, group, name, unit, min, max, initial, help) \
    [set] = {id, 0, name, group, unit, help, min, max, initial, NULL}
#define CHOICE(set, id, group, name, max, initial, labels, help) \
    [set] = {id, MRT_PARAM_STEPPED, name, group, "", help, 0, max, initial, labels}
#define HIDDEN_NUMBER(set, id, group, name, unit, min, max, initial, help) \
    [set] = {id, MRT_PARAM_HIDDEN, name, group, unit, help, min, max, initial, NULL}
#define HIDDEN_BUTTON(set, id, group, name, help) \
    [set] = {id, MRT_PARAM_TRIGGER | MRT_PARAM_HIDDEN, name, group, "", help, 0, 1, 0, NULL}
#define HIDDEN_PEDAL(set, id, name, initial, help) \
    HIDDEN_CHOICE(set, id, "Pedals", name, 4, initial, clutch_pedal_labels, help)
#define HIDDEN_CHOICE(set, id, group, name, max, initial, labels, help) \
    [set] = {id, MRT_PARAM_STEPPED | MRT_PARAM_HIDDEN, name, group, "", help, 0, max, initial, labels}
#define AXIS(axis, id, name, what) \
    NUMBER(SET_GAIN + AXIS_##axis, id, "Movement", name " gain", "%", 20, 300, 100, "Strength of " what "."), \
    NUMBER(SET_RANGE + AXIS_##axis, (id) + 1, "Movement", name " range", "%", 0, 150, 100, "Limit of " what ".")
#define BUTTON(set, id, group, name, help) \
    [set] = {id, MRT_PARAM_TRIGGER, name, group, "", help, 0, 1, 0, NULL}
#define PEDAL(set, id, name, initial, help) \
    CHOICE(set, id, "Pedals", name, 4, initial, clutch_pedal_labels, help)

const mrt_param settings[SET_COUNT] = {
    HIDDEN_CHOICE(SET_MODE, 1, "Map", "Mode", 3, MODE_SPEAKING, mode_labels,
           "Speaking, or one of the modes of earlier versions, which their takes need."),
    CHOICE(SET_HAND, 2, "Map", "Hand", 2, HAND_EITHER, performing_hand_labels,
           "Which hand performs; either: the right one where both are there."),
    CHOICE(SET_DEVICE, 140, "Map", "Device", 3, DEVICE_AUTOMATIC, device_labels,
           "What measures the hand. Automatic: as the channels of the input say."),
    NUMBER(SET_PRESS, 141, "Map", "Press", "deg", 4, 30, 11,
           "Bend of the thumb beyond neutral that closes the lips. At half of it they open again."),
    AXIS(JAW, 150, "Jaw", "the jaw for a movement of the thumb"),
    AXIS(LOWER_LIP, 152, "Lower lip", "the lower lip under the teeth for a bend of the thumb's tip"),
    AXIS(ROUND, 154, "Round", "round lips for a curl of index and middle finger"),
    AXIS(WIDTH, 156, "Width", "wide lips for a spread of the fingers"),
    AXIS(SMILE, 158, "Smile", "smile and frown for a movement of the knuckles of ring and little finger"),
    AXIS(TONGUE, 160, "Tongue", "the tongue for a curl of ring and little finger"),
    AXIS(BROWS, 162, "Brows", "the brows for a movement of the index finger's knuckle"),
    AXIS(LIDS, 164, "Lids", "the lids for a movement of the middle finger's knuckle"),
    AXIS(GAZE, 166, "Gaze", "gaze and single lids for a movement of the thumb aside"),
    AXIS(TILT, 168, "Brow tilt", "the tilt of the brows for an arch of the palm"),
    AXIS(HEAD, 170, "Head", "the head for a movement of the wrist"),
    CHOICE(SET_ANSWERED_FACE, 180, "Your hand", "Face", FACE_NAMES - 1, 0, face_names,
           "Face that your hand pose stands for."),
    BUTTON(SET_ANSWER, 181, "Your hand", "Answer",
           "Add the current hand pose to your hand poses for this face."),
    BUTTON(SET_UNDO_ANSWER, 182, "Your hand", "Undo", "Undo the last change of your hand poses."),
    BUTTON(SET_FORGET_ANSWER, 183, "Your hand", "Forget",
           "Use the default hand pose for this face."),
    BUTTON(SET_FORGET_ANSWERS, 184, "Your hand", "Forget all",
           "Use the default hand poses for all faces."),
    NUMBER(SET_INTENSITY, 3, "Map", "Intensity", "%", 0, 150, 100,
           "Size of expressions and mouths, but not of jaw, seal, gaze and head."),
    NUMBER(SET_SIZE, 4, "Map", "Size", "%", 10, 400, 100,
           "Of all movements in mm; 100: as the face's own size says."),
    HIDDEN_NUMBER(SET_REACH, 5, "Map", "Reach", "mm", 1, 100, 13,
           "Where the pull at a contact is softly stopped, whatever adds up there."),
    NUMBER(SET_LEVER, 6, "Map", "Lever", "mm", 20, 300, 90,
           "From the jaw's hinge to the incisors: what turns an opening into mm."),

    CHOICE(SET_NEUTRAL_FROM, 10, "Neutral", "Neutral", 1, NEUTRAL_AT_ENGAGE, neutral_labels,
           "The hand's pose that gives the rest face: as the hand is at engage, or as stored."),
    NUMBER(SET_NEUTRAL_SAMPLES, 11, "Neutral", "Samples", "", 1, 1000, 20,
           "How many samples the neutral pose is the mean of; the face rests meanwhile."),

    PEDAL(SET_ANCHOR_PEDAL, 20, "Anchor pedal", 1,
          "Makes the hand's pose of now the neutral one; the face stays as it is. A second tap "
          "takes it back."),
    PEDAL(SET_HOLD_PEDAL, 21, "Hold pedal", 2,
          "Freezes the face while down; a double tap freezes until the next press. Together with "
          "the anchor pedal: eases to neutral."),
    HIDDEN_PEDAL(SET_LAYER_PEDAL, 22, "Layer pedal", 3,
          "The other layer while down, the rest holds; a double tap stays there."),
    PEDAL(SET_INTENSITY_PEDAL, 23, "Intensity pedal", 0,
          "Multiplies the intensity: 0 % up, 150 % down."),
    BUTTON(SET_ANCHOR, 24, "Pedals", "Anchor",
           "Makes the hand's pose of now the neutral one; the face stays as it is."),
    BUTTON(SET_REVERT, 25, "Pedals", "Revert", "Takes the last anchor back."),
    BUTTON(SET_TO_NEUTRAL, 26, "Pedals", "Ease to neutral",
           "The face eases to its rest; the hand's pose of now becomes the neutral one."),
    CHOICE(SET_HOLD, 27, "Pedals", "Hold", 1, 0, placement_off_on_labels, "Freezes the face."),
    CHOICE(SET_HOLD_REGION, 28, "Pedals", "Hold region", 3, 0, region_labels,
           "What the hold freezes."),
    NUMBER(SET_DOUBLE_TAP, 29, "Pedals", "Double tap", "s", 0.05, 1, 0.25,
           "Two presses within this time are a double tap, presses of two pedals a chord."),
    NUMBER(SET_REATTACH, 30, "Pedals", "Re-attach time", "s", 0.02, 2, 0.2,
           "How long the face takes to follow the hand again after a hold or a change of layer."),
    NUMBER(SET_NEUTRAL_TIME, 31, "Pedals", "Neutral time", "s", 0.02, 2, 0.25,
           "How long easing to neutral takes."),

    HIDDEN_CHOICE(SET_LAYER, 35, "Layers", "Layer", 2, LAYER_MOUTH, layer_labels,
           "Layered waldo: the layer that the hand moves; the others hold."),
    HIDDEN_CHOICE(SET_OTHER_LAYER, 36, "Layers", "Other layer", 2, LAYER_HEAD, layer_labels,
           "Muppet+ and mask: what the layer pedal gives the hand. Layered waldo takes the next."),
    HIDDEN_BUTTON(SET_NEXT_LAYER, 37, "Layers", "Next layer", "As a double tap of the layer pedal."),

    HIDDEN_NUMBER(SET_JAW_ROLL, 40, "Jaw", "Roll share", "", -2, 2, 0.25,
           "How much 1 deg of thumb rotation across the palm drops the jaw."),
    HIDDEN_NUMBER(SET_JAW_MPJ, 41, "Jaw", "MPJ share", "", -2, 2, 1,
           "How much 1 deg of stretching the thumb's middle joint drops the jaw."),
    HIDDEN_NUMBER(SET_JAW_IJ, 42, "Jaw", "IJ share", "", -2, 2, 1,
           "How much 1 deg of stretching the thumb's tip joint drops the jaw."),
    HIDDEN_NUMBER(SET_JAW_GAIN, 43, "Jaw", "Gain", "deg/deg", 0, 4, 0.65,
           "Opening for a drop of the thumb by 1 deg, over the whole travel."),
    HIDDEN_NUMBER(SET_JAW_DEAD, 44, "Jaw", "Dead zone", "deg", 0, 30, 1.5,
           "Drop of the thumb that moves nothing."),
    HIDDEN_NUMBER(SET_JAW_RANGE, 45, "Jaw", "Range", "deg", 1, 60, 30, "Widest opening."),
    HIDDEN_NUMBER(SET_JAW_KNEE_TRAVEL, 46, "Jaw", "Knee travel", "%", 5, 95, 20,
           "The first part of the thumb's travel ..."),
    HIDDEN_NUMBER(SET_JAW_KNEE_GAPE, 47, "Jaw", "Knee gape", "%", 5, 95, 30,
           "... makes this part of the opening: quiet speech shows."),
    HIDDEN_NUMBER(SET_ASIDE_FOLLOW, 50, "Jaw aside", "Follow", "deg/deg", 0, 3, 1,
           "How far the thumb's abduction may go along with its drop and move nothing aside."),
    HIDDEN_NUMBER(SET_ASIDE_GAIN, 51, "Jaw aside", "Gain", "mm/deg", -4, 4, 0.4,
           "Jaw to the thumb's side for 1 deg of abduction."),
    HIDDEN_NUMBER(SET_ASIDE_DEAD, 52, "Jaw aside", "Dead zone", "deg", 0, 30, 3,
           "Abduction that moves nothing."),
    HIDDEN_NUMBER(SET_ASIDE_RANGE, 53, "Jaw aside", "Range", "mm", 0, 20, 8, "To either side."),

    HIDDEN_NUMBER(SET_BROW_GAIN, 60, "Brows", "Gain", "mm/deg", -4, 4, 0.5,
           "Brows up for 1 deg of stretching the index finger's knuckle."),
    HIDDEN_NUMBER(SET_BROW_DEAD, 61, "Brows", "Dead zone", "deg", 0, 30, 2,
           "Index finger movement that moves nothing."),
    HIDDEN_NUMBER(SET_BROW_UP, 62, "Brows", "Up", "mm", 0, 30, 10, "Highest lift of the brows."),
    HIDDEN_NUMBER(SET_BROW_DOWN, 63, "Brows", "Down", "mm", 0, 30, 7, "Lowest drop of the brows."),
    HIDDEN_NUMBER(SET_BROW_FOREHEAD, 64, "Brows", "Forehead", "mm/mm", 0, 1, 0.35,
           "How far the forehead goes along with the brows."),
    HIDDEN_NUMBER(SET_TILT_GAIN, 65, "Brow tilt", "Gain", "mm/deg", -4, 4, 0.25,
           "Inner brows up and outer brows down (worry) for 1 deg that the index finger is "
           "stretched more than the middle finger."),
    HIDDEN_NUMBER(SET_TILT_DEAD, 66, "Brow tilt", "Dead zone", "deg", 0, 30, 3,
           "Difference of the two fingers that moves nothing."),
    HIDDEN_NUMBER(SET_TILT_RANGE, 67, "Brow tilt", "Range", "mm", 0, 20, 6, "Up and down."),

    BUTTON(SET_BLINK, 70, "Lids", "Blink", "Blinks once."),
    HIDDEN_NUMBER(SET_BLINK_SPEED, 71, "Lids", "Blink speed", "deg/s", 20, 2000, 150,
           "The middle finger bent faster than this blinks."),
    HIDDEN_NUMBER(SET_BLINK_STROKE, 72, "Lids", "Blink stroke", "deg", 1, 60, 15,
           "How far the quick bend must go."),
    NUMBER(SET_BLINK_CLOSE, 73, "Lids", "Closing time", "ms", 10, 1000, 80, "Of a blink."),
    NUMBER(SET_BLINK_OPEN, 74, "Lids", "Opening time", "ms", 10, 1000, 150, "Of a blink."),
    HIDDEN_NUMBER(SET_DROOP_GAIN, 75, "Lids", "Droop gain", "%/deg", -20, 20, 2,
           "Lids closed for 1 deg of slow bending of the middle finger's knuckle."),
    HIDDEN_NUMBER(SET_DROOP_DEAD, 76, "Lids", "Droop dead zone", "deg", 0, 30, 4,
           "Middle finger movement that moves nothing."),
    HIDDEN_NUMBER(SET_DROOP_RANGE, 77, "Lids", "Droop range", "%", 0, 100, 60,
           "How far lids droop; 100: closed."),
    HIDDEN_NUMBER(SET_DROOP_TIME, 78, "Lids", "Droop time", "s", 0, 2, 0.12,
           "Time constant of the droop, so that a quick bend only blinks."),
    HIDDEN_NUMBER(SET_LOWER_LID, 79, "Lids", "Lower lid", "%", 0, 100, 100,
           "How much of their way the lower lids go when the upper ones go all of theirs."),

    HIDDEN_NUMBER(SET_CORNER_GAIN, 80, "Mouth corners", "Gain", "mm/deg", -4, 4, 0.5,
           "Smile for 1 deg of stretching the knuckles of ring and little finger."),
    HIDDEN_NUMBER(SET_CORNER_DEAD, 81, "Mouth corners", "Dead zone", "deg", 0, 30, 2,
           "Movement of ring and little finger that moves nothing."),
    HIDDEN_NUMBER(SET_CORNER_SMILE, 82, "Mouth corners", "Smile", "mm", 0, 30, 12,
           "Corners up, out and back."),
    HIDDEN_NUMBER(SET_CORNER_FROWN, 83, "Mouth corners", "Frown", "mm", 0, 30, 8, "Corners down."),
    HIDDEN_NUMBER(SET_CORNER_CHEEK, 84, "Mouth corners", "Cheeks", "mm/mm", 0, 1, 0.4,
           "How far the cheeks go along with the corners."),
    HIDDEN_NUMBER(SET_SMIRK_GAIN, 85, "Smirk", "Gain", "mm/deg", -4, 4, 0.15,
           "Corner on the ring finger's side up, the other down, for 1 deg that the ring finger is "
           "stretched more than the little finger."),
    HIDDEN_NUMBER(SET_SMIRK_DEAD, 86, "Smirk", "Dead zone", "deg", 0, 60, 8,
           "Difference of the two fingers that moves nothing."),
    HIDDEN_NUMBER(SET_SMIRK_RANGE, 87, "Smirk", "Range", "mm", 0, 20, 6, "Up and down."),

    HIDDEN_NUMBER(SET_WIDE_GAIN, 90, "Mouth width", "Wide gain", "mm/deg", 0, 4, 0.55,
           "Each corner out for 1 deg of spread, mean of the three."),
    HIDDEN_NUMBER(SET_NARROW_GAIN, 91, "Mouth width", "Narrow gain", "mm/deg", 0, 8, 1.2,
           "Each corner in for 1 deg of closing the fingers: less of it is left in a hand."),
    HIDDEN_NUMBER(SET_WIDTH_DEAD, 92, "Mouth width", "Dead zone", "deg", 0, 30, 3,
           "Spread that moves nothing."),
    HIDDEN_NUMBER(SET_WIDE_RANGE, 93, "Mouth width", "Wide", "mm", 0, 30, 8, "Each corner out."),
    HIDDEN_NUMBER(SET_NARROW_RANGE, 94, "Mouth width", "Narrow", "mm", 0, 30, 8, "Each corner in."),
    HIDDEN_NUMBER(SET_PROTRUSION, 95, "Mouth width", "Protrusion", "mm/mm", 0, 3, 0.75,
           "How far the lips come forward for 1 mm of narrowing."),

    HIDDEN_NUMBER(SET_SNEER_GAIN, 100, "Sneer", "Gain", "mm/deg", -4, 4, 0.3,
           "Nose wings, upper lip and cheeks up for 1 deg of palm arch."),
    HIDDEN_NUMBER(SET_SNEER_DEAD, 101, "Sneer", "Dead zone", "deg", 0, 30, 5,
           "Arch that moves nothing."),
    HIDDEN_NUMBER(SET_SNEER_RANGE, 102, "Sneer", "Range", "mm", 0, 20, 6, "Up."),
    HIDDEN_NUMBER(SET_LIP_GAIN, 105, "Upper lip", "Gain", "mm/deg", -4, 4, 0.15,
           "Upper lip up for 1 deg of stretching the middle joints of all four fingers."),
    HIDDEN_NUMBER(SET_LIP_DEAD, 106, "Upper lip", "Dead zone", "deg", 0, 30, 4,
           "Movement of the middle joints that moves nothing."),
    HIDDEN_NUMBER(SET_LIP_RANGE, 107, "Upper lip", "Range", "mm", 0, 20, 4, "Up."),
    HIDDEN_NUMBER(SET_LIP_HEAD, 108, "Upper lip", "Head", "deg/deg", 0, 2, 0.2,
           "Head up on the open: by how much it tips back for 1 deg of the same."),

    HIDDEN_NUMBER(SET_HEAD_GAIN, 110, "Head", "Gain", "deg/deg", -4, 4, 0.8,
           "Nod and turn for 1 deg of the wrist."),
    HIDDEN_NUMBER(SET_HEAD_DEAD, 111, "Head", "Dead zone", "deg", 0, 30, 2,
           "Wrist movement that moves nothing."),
    HIDDEN_NUMBER(SET_HEAD_NOD, 112, "Head", "Nod", "deg", 0, 90, 20, "Down and up."),
    HIDDEN_NUMBER(SET_HEAD_TURN, 113, "Head", "Turn", "deg", 0, 90, 30, "To either side."),
    HIDDEN_NUMBER(SET_HEAD_EYES, 114, "Head", "Eyes", "%", 0, 100, 0,
           "How much the eyes go along with the head's turn and nod."),

    HIDDEN_NUMBER(SET_MASK_THUMB, 120, "Mask", "Thumb", "mm/mm", 0, 3, 0.6,
           "Chin and jaw for 1 mm of the thumb's tip."),
    HIDDEN_NUMBER(SET_MASK_INDEX, 121, "Mask", "Index", "mm/mm", 0, 3, 0.5,
           "One brow for 1 mm of the index finger's tip."),
    HIDDEN_NUMBER(SET_MASK_MIDDLE, 122, "Mask", "Middle", "mm/mm", 0, 3, 0.5,
           "Other brow for 1 mm of the middle finger's tip."),
    HIDDEN_NUMBER(SET_MASK_RING, 123, "Mask", "Ring", "mm/mm", 0, 3, 0.5,
           "One mouth corner for 1 mm of the ring finger's tip."),
    HIDDEN_NUMBER(SET_MASK_LITTLE, 124, "Mask", "Little", "mm/mm", 0, 3, 0.5,
           "Other mouth corner for 1 mm of the little finger's tip."),
    HIDDEN_NUMBER(SET_MASK_PALM, 125, "Mask", "Palm", "mm/mm", -4, 4, 1.5,
           "Cheeks for 1 mm of the outer palm, which moves little."),
    HIDDEN_NUMBER(SET_MASK_DEAD, 126, "Mask", "Dead zone", "mm", 0, 30, 1.5,
           "Movement of a tip that moves nothing."),
    HIDDEN_NUMBER(SET_MASK_BROW_ASIDE, 127, "Mask", "Brow aside", "mm", 0, 30, 1.5,
           "How far brows go aside and forwards; up and down as the group Brows says."),

    HIDDEN_NUMBER(SET_ARC_THUMB, 130, "Waldo", "Thumb arc", "deg", 2, 120, 45,
           "Drop of the thumb for the whole range."),
    HIDDEN_NUMBER(SET_ARC_INDEX, 131, "Waldo", "Index arc", "deg", 2, 120, 40,
           "Movement of the index finger's knuckle for the whole range."),
    HIDDEN_NUMBER(SET_ARC_SPREAD, 132, "Waldo", "Spread arc", "deg", 2, 60, 15,
           "Mean spread for the whole range."),
    HIDDEN_NUMBER(SET_ARC_LITTLE, 133, "Waldo", "Ring and little arc", "deg", 2, 120, 40,
           "Movement of their knuckles for the whole range."),
    HIDDEN_NUMBER(SET_ARC_WRIST, 134, "Waldo", "Wrist arc", "deg", 2, 90, 20,
           "Movement of the wrist for the whole range."),
    HIDDEN_NUMBER(SET_ARC_DEAD, 135, "Waldo", "Dead zone", "deg", 0, 30, 2,
           "Movement of any of them that moves nothing."),
    HIDDEN_NUMBER(SET_ARC_FORWARD, 136, "Waldo", "Jaw forward", "mm", 0, 20, 6, "By the wrist."),
    HIDDEN_NUMBER(SET_ARC_GAZE_YAW, 137, "Waldo", "Gaze aside", "deg", 0, 60, 30,
           "By the wrist, with brows and lids."),
    HIDDEN_NUMBER(SET_ARC_GAZE_PITCH, 138, "Waldo", "Gaze up", "deg", 0, 60, 20,
           "By the wrist, with brows and lids."),
};
/* clang-format on */
