#include "window/app/action.h"
#include "window/gui/ui.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

const char *const action_group_name[ACTION_GROUPS] = {"Performance", "Transport", "Edits", "View",
                                                      "Program"};

static const action_entry entries[ACTION_COUNT] = {
    [ACTION_RECORD] =
        {ACTION_RECORD, ACTION_PERFORMANCE, "record", "Record",
         "Begins a take, ends it. Over a take that is shown: performs over it as a new layer.", 'R',
         0},
    [ACTION_KEEP] =
        {ACTION_KEEP, ACTION_PERFORMANCE, "keep", "Keep the last 30 s",
         "What was performed in the last 30 seconds becomes a take, though nobody recorded it.",
         'K', 0},
    [ACTION_MARK] = {ACTION_MARK, ACTION_PERFORMANCE, "mark", "Mark", "Marks this instant.", 'M',
                     0},
    [ACTION_NEUTRAL] = {ACTION_NEUTRAL, ACTION_PERFORMANCE, "neutral", "Neutral",
                        "Everything that is held or pulled eases back to rest.", 'N', 0},
    [ACTION_REZERO] = {ACTION_REZERO, ACTION_PERFORMANCE, "rezero", "Re-zero",
                       "The pose that the hands hold now becomes their neutral one.", 'Z', 0},
    [ACTION_LIVE] = {ACTION_LIVE, ACTION_PERFORMANCE, "live", "Live",
                     "Back from a take to the live hands; again: to what was always recorded.", 'L',
                     0},
    [ACTION_HAND_KEYS] = {ACTION_HAND_KEYS, ACTION_PERFORMANCE, "hand_keys", "Keyboard as a hand",
                          "The keyboard moves a virtual hand, until Escape.", 'Y', 0},
    [ACTION_PLAY] = {ACTION_PLAY, ACTION_TRANSPORT, "play", "Play",
                     "Plays the take, or stands still.", ' ', 0},
    [ACTION_STOP] = {ACTION_STOP, ACTION_TRANSPORT, "stop", "Stop",
                     "Stands still where it was started.", ' ', UI_SHIFT},
    [ACTION_TO_START] = {ACTION_TO_START, ACTION_TRANSPORT, "to_start", "To the start",
                         "Goes to the take's start.", UI_KEY_HOME, 0},
    [ACTION_TO_END] = {ACTION_TO_END, ACTION_TRANSPORT, "to_end", "To the end",
                       "Goes to the take's end.", UI_KEY_END, 0},
    [ACTION_FRAME_BACK] = {ACTION_FRAME_BACK, ACTION_TRANSPORT, "frame_back", "A frame back",
                           "Goes one frame back.", ',', 0},
    [ACTION_FRAME_FORWARD] = {ACTION_FRAME_FORWARD, ACTION_TRANSPORT, "frame_forward", "A frame on",
                              "Goes one frame on.", '.', 0},
    [ACTION_SECOND_BACK] = {ACTION_SECOND_BACK, ACTION_TRANSPORT, "second_back", "A second back",
                            "Goes one second back.", UI_KEY_LEFT, 0},
    [ACTION_SECOND_FORWARD] = {ACTION_SECOND_FORWARD, ACTION_TRANSPORT, "second_forward",
                               "A second on", "Goes one second on.", UI_KEY_RIGHT, 0},
    [ACTION_LOOP] = {ACTION_LOOP, ACTION_TRANSPORT, "loop", "Loop",
                     "Plays the range again and again.", 'O', 0},
    [ACTION_LOOP_IN] = {ACTION_LOOP_IN, ACTION_TRANSPORT, "loop_in", "Range from here",
                        "The range begins at the play head.", 'I', 0},
    [ACTION_LOOP_OUT] = {ACTION_LOOP_OUT, ACTION_TRANSPORT, "loop_out", "Range to here",
                         "The range ends at the play head.", 'I', UI_SHIFT},
    [ACTION_SLOWER] = {ACTION_SLOWER, ACTION_TRANSPORT, "slower", "Slower",
                       "Plays at the next slower speed.", '-', 0},
    [ACTION_FASTER] = {ACTION_FASTER, ACTION_TRANSPORT, "faster", "Faster",
                       "Plays at the next faster speed.", '=', 0},
    [ACTION_TAKE_BEFORE] = {ACTION_TAKE_BEFORE, ACTION_TRANSPORT, "take_before", "Older take",
                            "Chooses the take before: the next one down the list.",
                            UI_KEY_PAGE_DOWN, 0},
    [ACTION_TAKE_NEXT] = {ACTION_TAKE_NEXT, ACTION_TRANSPORT, "take_next", "Newer take",
                          "Chooses the take after: the next one up the list.", UI_KEY_PAGE_UP, 0},
    [ACTION_SOUND_ARM] = {ACTION_SOUND_ARM, ACTION_TRANSPORT, "sound_arm", "Arm the microphone",
                          "The microphone is recorded with the hands.", 'A', 0},
    [ACTION_UNDO] = {ACTION_UNDO, ACTION_EDIT, "undo", "Undo", "Takes the last step back.", 'Z',
                     UI_CONTROL},
    [ACTION_REDO] = {ACTION_REDO, ACTION_EDIT, "redo", "Redo", "Does again what was taken back.",
                     'Z', UI_CONTROL | UI_SHIFT},
    [ACTION_SPLIT] = {ACTION_SPLIT, ACTION_EDIT, "split", "Split",
                      "Splits the chosen clip at the play head.", 'S', 0},
    [ACTION_TRIM_START] = {ACTION_TRIM_START, ACTION_EDIT, "trim_start", "Trim the start",
                           "The chosen clip, or the take, begins at the play head.", '[', 0},
    [ACTION_TRIM_END] = {ACTION_TRIM_END, ACTION_EDIT, "trim_end", "Trim the end",
                         "The chosen clip, or the take, ends at the play head.", ']', 0},
    [ACTION_REMOVE] = {ACTION_REMOVE, ACTION_EDIT, "remove", "Remove",
                       "Removes the chosen clip, layer or marker. Nothing recorded is lost.",
                       UI_KEY_DELETE, 0},
    [ACTION_MUTE] = {ACTION_MUTE, ACTION_EDIT, "mute", "Mute", "Mutes the chosen clip or layer.",
                     'U', 0},
    [ACTION_SOLO] = {ACTION_SOLO, ACTION_EDIT, "solo", "Solo", "The chosen layer alone.", 'U',
                     UI_SHIFT},
    [ACTION_RATE_0] = {ACTION_RATE_0, ACTION_EDIT, "rate_0", "0 stars",
                       "Rates the chosen take with 0 stars.", '0', 0},
    [ACTION_RATE_1] = {ACTION_RATE_1, ACTION_EDIT, "rate_1", "1 star",
                       "Rates the chosen take with 1 star.", '1', 0},
    [ACTION_RATE_2] = {ACTION_RATE_2, ACTION_EDIT, "rate_2", "2 stars",
                       "Rates the chosen take with 2 stars.", '2', 0},
    [ACTION_RATE_3] = {ACTION_RATE_3, ACTION_EDIT, "rate_3", "3 stars",
                       "Rates the chosen take with 3 stars.", '3', 0},
    [ACTION_RATE_4] = {ACTION_RATE_4, ACTION_EDIT, "rate_4", "4 stars",
                       "Rates the chosen take with 4 stars.", '4', 0},
    [ACTION_RATE_5] = {ACTION_RATE_5, ACTION_EDIT, "rate_5", "5 stars",
                       "Rates the chosen take with 5 stars.", '5', 0},
    [ACTION_DUPLICATE] = {ACTION_DUPLICATE, ACTION_EDIT, "duplicate", "Duplicate the take",
                          "Makes another take that shows the same and is edited by itself.", 'D',
                          UI_CONTROL},
    [ACTION_EXPORT] = {ACTION_EXPORT, ACTION_EDIT, "export", "Export",
                       "Writes the chosen take as a file for other programs.", 'E', UI_CONTROL},
    [ACTION_VIEW_FRONT] = {ACTION_VIEW_FRONT, ACTION_VIEW, "view_front", "Front",
                           "Looks at the face from the front.", 'F', 0},
    [ACTION_VIEW_SIDE] = {ACTION_VIEW_SIDE, ACTION_VIEW, "view_side", "Side",
                          "Looks at the face from its side.", 'D', 0},
    [ACTION_VIEW_THREE_QUARTER] = {ACTION_VIEW_THREE_QUARTER, ACTION_VIEW, "view_three_quarter",
                                   "Three quarters", "Looks at the face half from the side.", 'G',
                                   0},
    [ACTION_VIEW_MIRROR] = {ACTION_VIEW_MIRROR, ACTION_VIEW, "view_mirror", "Mirror",
                            "Shows the face as in a mirror.", 'X', 0},
    [ACTION_VIEW_FRAME] = {ACTION_VIEW_FRAME, ACTION_VIEW, "view_frame", "Whole face",
                           "Brings the whole face into view.", 'F', UI_SHIFT},
    [ACTION_VIEW_TURNTABLE] = {ACTION_VIEW_TURNTABLE, ACTION_VIEW, "view_turntable", "Turntable",
                               "Turns the face slowly.", 'T', 0},
    [ACTION_SHOW_HANDS] = {ACTION_SHOW_HANDS, ACTION_VIEW, "show_hands", "Hands",
                           "Shows the hands beside the face.", 'H', 0},
    [ACTION_SHOW_VECTORS] = {ACTION_SHOW_VECTORS, ACTION_VIEW, "show_vectors", "Control vectors",
                             "Shows what is pulled, and where to.", 'V', 0},
    [ACTION_SHOW_SUPPORTS] =
        {ACTION_SHOW_SUPPORTS, ACTION_VIEW, "show_supports", "Supports",
         "Shows how far each control vector reaches: spheres at half its strength.", 'V', UI_SHIFT},
    [ACTION_SHOW_CONTACTS] = {ACTION_SHOW_CONTACTS, ACTION_VIEW, "show_contacts", "Contacts",
                              "Shows the named places of the face.", 'C', 0},
    [ACTION_SHOW_JAW] = {ACTION_SHOW_JAW, ACTION_VIEW, "show_jaw", "Jaw axis",
                         "Shows the axis about which the jaw opens.", 'J', 0},
    [ACTION_HEAT_NEXT] = {ACTION_HEAT_NEXT, ACTION_VIEW, "heat_next", "Heat map",
                          "The next colouring: none, bone weights, mobility, strain, penetration.",
                          'W', 0},
    [ACTION_OUTPUT] = {ACTION_OUTPUT, ACTION_VIEW, "output", "Output",
                       "The face alone, full screen on the second monitor.", UI_KEY_F1 + 10, 0},
    [ACTION_OUTPUT_MIRROR] = {ACTION_OUTPUT_MIRROR, ACTION_VIEW, "output_mirror", "Output mirrored",
                              "The output shows the face as in a mirror.", UI_KEY_F1 + 10,
                              UI_SHIFT},
    [ACTION_FACE_ONLY] = {ACTION_FACE_ONLY, ACTION_VIEW, "face_only", "Face only",
                          "Puts all panels away, and brings them back.", UI_KEY_TAB, 0},
    [ACTION_PANEL_DEVICES] = {ACTION_PANEL_DEVICES, ACTION_PROGRAM, "panel_devices", "Devices",
                              "Gloves, pedals and other inputs.", UI_KEY_F1 + 1, 0},
    [ACTION_PANEL_MAPPING] = {ACTION_PANEL_MAPPING, ACTION_PROGRAM, "panel_mapping", "Mapping",
                              "How hands become a face.", UI_KEY_F1 + 2, 0},
    [ACTION_PANEL_RIG] = {ACTION_PANEL_RIG, ACTION_PROGRAM, "panel_rig", "Rig",
                          "Skull, jaw, contacts: what the face can do.", UI_KEY_F1 + 3, 0},
    [ACTION_PANEL_ENGINE] = {ACTION_PANEL_ENGINE, ACTION_PROGRAM, "panel_engine", "Engine",
                             "How the surface is solved, and how fast.", UI_KEY_F1 + 4, 0},
    [ACTION_PANEL_LOG] = {ACTION_PANEL_LOG, ACTION_PROGRAM, "panel_log", "Log",
                          "What the program had to say.", UI_KEY_F1 + 5, 0},
    [ACTION_PANEL_PATCH] = {ACTION_PANEL_PATCH, ACTION_PROGRAM, "panel_patch", "Patch",
                            "Which faders, sticks and shapes move what.", UI_KEY_F1 + 2, UI_SHIFT},
    [ACTION_PANEL_OUTPUT] = {ACTION_PANEL_OUTPUT, ACTION_PROGRAM, "panel_output", "Send",
                             "Which programs get the face, live.", UI_KEY_F1 + 1, UI_SHIFT},
    [ACTION_TIMELINE] = {ACTION_TIMELINE, ACTION_PROGRAM, "timeline", "Timeline",
                         "Shows the timeline, or puts it away.", UI_KEY_F1 + 6, 0},
    [ACTION_TIMELINE_FIT] = {ACTION_TIMELINE_FIT, ACTION_PROGRAM, "timeline_fit",
                             "Fit the timeline", "The whole take fits the timeline.", 'Z',
                             UI_SHIFT},
    [ACTION_OPEN] = {ACTION_OPEN, ACTION_PROGRAM, "open", "Open", "Opens a show or a face.", 'O',
                     UI_CONTROL},
    [ACTION_SAVE] = {ACTION_SAVE, ACTION_PROGRAM, "save", "Save the rig", "Writes the rig file.",
                     'S', UI_CONTROL},
    [ACTION_HELP] = {ACTION_HELP, ACTION_PROGRAM, "help", "Help", "Lists all keys and pedals.", '/',
                     UI_SHIFT},
    [ACTION_QUIT] = {ACTION_QUIT, ACTION_PROGRAM, "quit", "Quit",
                     "Ends the program. What is being recorded is kept.", 'Q', UI_CONTROL},
};

const action_entry *action_of(action id)
{
    assert((uint32_t)id < ACTION_COUNT);
    return &entries[id];
}

action action_named(const char *name)
{
    for (uint32_t i = 1; i < ACTION_COUNT; ++i)
        if (strcmp(entries[i].name, name) == 0)
            return entries[i].id;
    return ACTION_NONE;
}

typedef struct key_name {
    uint32_t key;
    const char *name;
} key_name;
static const key_name key_names[] = {
    {' ', "Space"},
    {UI_KEY_ESCAPE, "Esc"},
    {UI_KEY_ENTER, "Enter"},
    {UI_KEY_TAB, "Tab"},
    {UI_KEY_BACKSPACE, "Backspace"},
    {UI_KEY_DELETE, "Del"},
    {UI_KEY_INSERT, "Ins"},
    {UI_KEY_LEFT, "Left"},
    {UI_KEY_RIGHT, "Right"},
    {UI_KEY_UP, "Up"},
    {UI_KEY_DOWN, "Down"},
    {UI_KEY_PAGE_UP, "Page up"},
    {UI_KEY_PAGE_DOWN, "Page down"},
    {UI_KEY_HOME, "Home"},
    {UI_KEY_END, "End"},
};

static void write_key(char *out, size_t capacity, uint32_t key)
{
    for (size_t i = 0; i < sizeof key_names / sizeof key_names[0]; ++i)
        if (key_names[i].key == key) {
            snprintf(out, capacity, "%s", key_names[i].name);
            return;
        }
    if (key >= UI_KEY_F1 && key <= UI_KEY_F12)
        snprintf(out, capacity, "F%u", key - UI_KEY_F1 + 1);
    else
        snprintf(out, capacity, "%c", (int)key);
}

void action_keys(action id, char out[ACTION_KEYS])
{
    const action_entry *entry = action_of(id);
    char key[16] = "";
    bool is_question = entry->key == '/' && entry->modifiers == UI_SHIFT;
    write_key(key, sizeof key, entry->key);
    snprintf(out, ACTION_KEYS, "%s%s%s%s", entry->modifiers & UI_CONTROL ? "Ctrl+" : "",
             entry->modifiers & UI_ALT ? "Alt+" : "",
             entry->modifiers & UI_SHIFT && !is_question ? "Shift+" : "", is_question ? "?" : key);
}
