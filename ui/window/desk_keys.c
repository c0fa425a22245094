/* Keys: each action by its own, but while something is typed or the keyboard is a hand. */
#include "window/desk_state.h"

#define REPEAT_AFTER_S 0.40
#define REPEAT_EVERY_S 0.07

/* What goes on while its key is held. */
static bool repeats(action of)
{
    return of == ACTION_FRAME_BACK || of == ACTION_FRAME_FORWARD || of == ACTION_SECOND_BACK ||
           of == ACTION_SECOND_FORWARD;
}

/* A hand needs the letters, not these. */
static bool is_beside_hand(const action_entry *entry)
{
    return (entry->modifiers & (UI_CONTROL | UI_ALT)) != 0 ||
           (entry->key >= UI_KEY_F1 && entry->key <= UI_KEY_F12);
}

static bool is_held_again(desk *self, const action_entry *entry)
{
    if (!repeats(entry->id) || self->held_key != entry->key || !ui_is_down(self->ui, entry->key))
        return false;
    self->held_s += self->screen.dt_s;
    if (self->held_s < REPEAT_AFTER_S)
        return false;
    self->held_s -= REPEAT_EVERY_S;
    return true;
}

static bool is_wanted(desk *self, const action_entry *entry)
{
    if (ui_pressed(self->ui, entry->key, entry->modifiers)) {
        self->held_key = entry->key;
        self->held_s = 0.0;
        return true;
    }
    return is_held_again(self, entry);
}

static void escape(desk *self)
{
    studio_looks *looks = studio_looks_of(self->studio);
    if (studio_has_hand_keys(self->studio))
        studio_do(self->studio, ACTION_HAND_KEYS);
    else if (looks->is_helping)
        looks->is_helping = false;
    else if (looks->is_face_only)
        looks->is_face_only = false;
}

/* The brush of the rig panel has these while it is on. */
static bool is_of_brush(desk *self, const action_entry *entry)
{
    return studio_looks_of(self->studio)->is_painting && entry->modifiers == 0 &&
           (entry->key == '[' || entry->key == ']');
}

void desk_dispatch_keys(desk *self)
{
    const bool is_hand = studio_has_hand_keys(self->studio);
    if (ui_pressed(self->ui, UI_KEY_ESCAPE, 0)) {
        escape(self);
        return;
    }
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        const action_entry *entry = action_of((action)i);
        if (entry->key == 0 || (is_hand && !is_beside_hand(entry)) || is_of_brush(self, entry))
            continue;
        if (is_wanted(self, entry))
            studio_do(self->studio, entry->id);
    }
}
