/* Every action: whether it can be done now, and who does it. */
#include "window/studio_state.h"

#include <stddef.h>

static const char *why_no_record(const studio *self)
{
    if (self->status.is_recording || self->status.can_record)
        return NULL;
    return self->status.why_not[0] ? self->status.why_not : "nothing can be recorded now";
}

static const char *why_no_keep(const studio *self)
{
    const char *why = why_no_record(self);
    if (why)
        return why;
    return self->status.journal_ns > 0 ? NULL : "nothing was performed yet";
}

static const char *why_no_transport(const studio *self, action of)
{
    if (self->status.is_recording)
        return "a take is being recorded: end it first";
    if (of == ACTION_TAKE_BEFORE || of == ACTION_TAKE_NEXT)
        return self->line_count ? NULL : "there is no take yet";
    if (!self->history)
        return "no take is chosen";
    if (of == ACTION_STOP && self->view->mode == LIVE_PERFORMS)
        return "no take is on the stage";
    return NULL;
}

/* NULL: it can be done. */
static const char *why_not(studio *self, action of)
{
    switch (of) {
    case ACTION_RECORD:
        return why_no_record(self);
    case ACTION_KEEP:
        return why_no_keep(self);
    case ACTION_MARK:
        return self->view->mode == LIVE_PERFORMS ? why_no_record(self)
                                                 : studio_edit_why_not(self, of);
    case ACTION_LIVE:
        return self->view->mode == LIVE_PERFORMS ? "the live hands are on the stage" : NULL;
    case ACTION_SOUND_ARM:
        return self->status.is_recording ? "a take is being recorded: end it first" : NULL;
    case ACTION_UNDO:
        return studio_can_undo(self) ? NULL : "there is nothing to undo";
    case ACTION_REDO:
        return studio_can_redo(self) ? NULL : "there is nothing to do again";
    case ACTION_EXPORT:
        return self->chosen ? NULL : "no take is chosen";
    case ACTION_NONE:
    case ACTION_COUNT:
        return "";
    default:
        break;
    }
    const action_group group = action_of(of)->group;
    if (group == ACTION_TRANSPORT)
        return why_no_transport(self, of);
    return group == ACTION_EDIT ? studio_edit_why_not(self, of) : NULL;
}

bool studio_can(studio *self, action of, const char **out_why_not)
{
    const char *why = why_not(self, of);
    if (out_why_not)
        *out_why_not = why ? why : "";
    return why == NULL;
}

/* ---- doing ---- */

static void arm_sound(studio *self)
{
    error err = {0};
    if (self->status.is_sound_armed)
        live_disarm_sound(self->live);
    else
        (void)studio_said(self, live_arm_sound(self->live, 1, &err), &err);
}

static void do_performance(studio *self, action of)
{
    switch (of) {
    case ACTION_RECORD:
        studio_record_toggle(self);
        break;
    case ACTION_KEEP:
        studio_keep(self);
        break;
    case ACTION_MARK:
        studio_mark(self);
        break;
    case ACTION_NEUTRAL:
        live_neutral(self->live);
        break;
    case ACTION_REZERO:
        live_rezero(self->live);
        break;
    case ACTION_LIVE:
        live_show_hands(self->live);
        break;
    case ACTION_HAND_KEYS:
        self->has_hand_keys = !self->has_hand_keys;
        break;
    default:
        break;
    }
}

/* The switch of the looks that an action is; NULL: it is none. */
static bool *switch_of(studio_looks *looks, action of)
{
    switch (of) {
    case ACTION_VIEW_MIRROR:
        return &looks->is_mirrored;
    case ACTION_VIEW_TURNTABLE:
        return &looks->is_turning;
    case ACTION_SHOW_HANDS:
        return &looks->shows_hands;
    case ACTION_SHOW_VECTORS:
        return &looks->shows_vectors;
    case ACTION_SHOW_SUPPORTS:
        return &looks->shows_supports;
    case ACTION_SHOW_CONTACTS:
        return &looks->shows_contacts;
    case ACTION_SHOW_JAW:
        return &looks->shows_jaw;
    case ACTION_OUTPUT:
        return &looks->has_output;
    case ACTION_OUTPUT_MIRROR:
        return &looks->is_output_mirrored;
    case ACTION_FACE_ONLY:
        return &looks->is_face_only;
    case ACTION_TIMELINE:
        return &looks->has_timeline;
    case ACTION_HELP:
        return &looks->is_helping;
    default:
        return NULL;
    }
}

static void do_look(studio *self, action of)
{
    studio_looks *looks = &self->looks;
    bool *value = switch_of(looks, of);
    if (value) {
        *value = !*value;
        if (of == ACTION_TIMELINE && *value)
            looks->is_face_only = false;
    } else if (of == ACTION_HEAT_NEXT) {
        looks->heat = (studio_heat)((looks->heat + 1) % STUDIO_HEATS);
    } else if (of >= ACTION_PANEL_DEVICES && of <= ACTION_PANEL_LOG) {
        looks->panel = (studio_panel)(of - ACTION_PANEL_DEVICES);
        looks->is_face_only = false;
    } else if (of == ACTION_QUIT) {
        self->wants_to_quit = true;
    } else {
        self->asked[of] = true;
    }
}

void studio_do(studio *self, action of)
{
    const char *why = "";
    if (!studio_can(self, of, &why)) {
        if (why[0])
            studio_say(self, MRT_LOG_INFO, "%s: %s", action_of(of)->title, why);
        return;
    }
    if (of == ACTION_UNDO)
        studio_heard(studio_undo(self));
    else if (of == ACTION_REDO)
        studio_heard(studio_redo(self));
    else if (of == ACTION_SOUND_ARM)
        arm_sound(self);
    else if (of == ACTION_EXPORT)
        self->asked[of] = true;
    else if (of == ACTION_DUPLICATE)
        studio_heard(studio_duplicate_take(self, self->chosen));
    else if (action_of(of)->group == ACTION_PERFORMANCE)
        do_performance(self, of);
    else if (action_of(of)->group == ACTION_TRANSPORT)
        studio_play_do(self, of);
    else if (action_of(of)->group == ACTION_EDIT)
        studio_edit_do(self, of);
    else
        do_look(self, of);
}

bool studio_asked(studio *self, action of)
{
    const bool was_asked = self->asked[of];
    self->asked[of] = false;
    return was_asked;
}

bool studio_wants_to_quit(const studio *self)
{
    return self->wants_to_quit;
}

void studio_stay(studio *self)
{
    self->wants_to_quit = false;
}

bool studio_has_hand_keys(const studio *self)
{
    return self->has_hand_keys;
}
