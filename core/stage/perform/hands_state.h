/* stage/perform/hands_state.h - what the hands are made of. Inside hands*.c. */
#ifndef MAROTTE_STAGE_HANDS_STATE_H
#define MAROTTE_STAGE_HANDS_STATE_H
#include "hand/ease.h"
#include "hand/still.h"
#include "stage/hands.h"

typedef struct one_hand {
    hand_skeleton *skeleton;
    hand_filter filter;
    float raw[MRT_ANGLES];
    float wrist_raw[EASE_WRIST];
    bool has_wrist;
    still_window window; /* filtered angles, as the tables say: before the offset */
    float neutral_rad[MRT_ANGLES];
    ease_offset offset;
    ease_angles eased;
    ease_wrist eased_wrist;
    float angle_rad[MRT_ANGLES]; /* as shown */
} one_hand;

struct hands {
    one_hand hand[2]; /* left, right */
    hands_settings settings;
    uint32_t rezero_pedal; /* 0: none */
    bool is_rezero_down, is_rezero_pressed;
    rezero_counts counts;
};

#endif
