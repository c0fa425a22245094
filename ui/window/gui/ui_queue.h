/* window/gui/ui_queue.h - a queue of events that gives each frame at most one change of a key or
 * button, and no motion between a press and its target. So slow frames lose no tap. All typed
 * letters are delivered together. Uses only its own memory; one thread. */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_QUEUE_H
#define MAROTTE_UI_WINDOW_GUI_UI_QUEUE_H
#include "window/gui/ui_types.h"

enum { UI_QUEUE_EVENTS = 4096, UI_QUEUE_TEXT = 64, UI_BUTTONS = 3 };

typedef struct ui_frame_input { /* what a frame sees */
    float x, y;                 /* points */
    float wheel_x, wheel_y;
    bool key[UI_KEY_COUNT];     /* held */
    bool pressed[UI_KEY_COUNT]; /* went down in this frame */
    bool button[UI_BUTTONS];
    uint32_t text[UI_QUEUE_TEXT]; /* code points typed in this frame */
    uint32_t text_count;
    bool has_pointer; /* it was somewhere */
    bool is_typing;   /* letters go into a text field; set before the frame is read */
} ui_frame_input;

typedef struct ui_queue {
    ui_event event[UI_QUEUE_EVENTS];
    uint32_t first, count;
} ui_queue;

void ui_queue_init(ui_queue *self);
/* Moves that follow each other become one. A queue that is full forgets everything, and all keys
 * and buttons go up. */
void ui_queue_push(ui_queue *self, const ui_event *event);
bool ui_queue_is_empty(const ui_queue *self);
/* Clears what `input` has for one frame only, then moves events from the queue into it. Held keys
 * stay held. An event that must wait for another frame stays in the queue. */
void ui_queue_take(ui_queue *self, ui_frame_input *input);
/* A frame in which nothing happens but that time passes: the queue waits. */
void ui_queue_pass(ui_frame_input *input);
uint32_t ui_frame_modifiers(const ui_frame_input *input);

#endif
