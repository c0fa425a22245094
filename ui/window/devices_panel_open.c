#include "window/devices_panel_inside.h"
#include "window/devices_panel_words.h"
#include "window/panel_label.h"
#include "window/theme.h"

#include <stdio.h>
#include <string.h>

static const float button = 64.0f;

static const char *const state_words[] = {[MRT_DEVICE_READY] = "ready",
                                          [MRT_DEVICE_BUSY] = "another program holds it",
                                          [MRT_DEVICE_DENIED] = "you may not open it",
                                          [MRT_DEVICE_UNSURE] = "something may be there"};

/* ---- what is plugged in ---- */

static bool is_open(const devices_panel *self, const device_found *device, bool is_first)
{
    const live *stage = studio_live(self->studio);
    for (uint32_t i = 0; i < live_input_count(stage); ++i)
        if (devices_is_open(live_input_text(stage, i), device, is_first))
            return true;
    for (uint32_t i = 0; i < self->opening_count; ++i)
        if (devices_is_open(self->opening[i].text, device, is_first))
            return true;
    return false;
}

static bool is_first_of_plugin(const device_list *list, uint32_t index)
{
    for (uint32_t i = 0; i < index; ++i)
        if (list->one[i].type == list->one[index].type)
            return false;
    return true;
}

static void draw_device(devices_panel *self, ui *on, const device_found *found)
{
    const mrt_device *device = &found->device;
    char text[256];
    bool is_known = device->state >= MRT_DEVICE_READY && device->state <= MRT_DEVICE_UNSURE;
    bool can_open = device->state == MRT_DEVICE_READY || device->state == MRT_DEVICE_UNSURE;
    ui_text(on, UI_STYLE_STRONG, device->name[0] ? device->name : device->address);
    const char *words = is_known ? state_words[device->state] : "not known";
    if (can_open && devices_input_text(found, text, sizeof text)) {
        panel_label(on, "state", ui_available_width(on) - button - 8.0f, THEME_DIM, words);
        ui_width(on, button);
        if (ui_button(on, "Open", UI_PLAIN))
            devices_panel_add(self, text);
        ui_hint(on, text);
    } else {
        ui_text(on, UI_STYLE_WARNING, words);
    }
    if (device->advice[0])
        ui_text_wrapped(on, UI_STYLE_DIM, device->advice);
    ui_space(on, 6.0f);
}

static void draw_found(devices_panel *self, ui *on)
{
    const device_list *list = self->seen.devices;
    uint32_t shown = 0;
    for (uint32_t i = 0; self->seen.is_known && i < list->count; ++i) {
        if (is_open(self, &list->one[i], is_first_of_plugin(list, i)))
            continue;
        ui_id_begin(on, list->one[i].device.address);
        draw_device(self, on, &list->one[i]);
        ui_id_end(on);
        shown += 1;
    }
    if (!self->search)
        ui_text_wrapped(on, UI_STYLE_DIM, "Devices cannot be looked for: start marotte again.");
    else if (!self->seen.is_known)
        ui_text(on, UI_STYLE_DIM, "Looking\xe2\x80\xa6");
    else if (shown == 0 && list->count > 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "Everything that is plugged in is open.");
    else if (shown == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "Nothing was found. Plug in a glove or a pedal: it appears here.");
    if (self->seen.note[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, self->seen.note);
}

/* ---- what has no plug ---- */

static void open_recording(devices_panel *self)
{
    char text[DEVICES_PATH + 32];
    if (!self->path[0])
        devices_panel_say(self, "Say which recording: the path of a log file.");
    else if (strchr(self->path, ','))
        devices_panel_say(self, "A path with a comma cannot be opened: rename the file.");
    else {
        (void)snprintf(text, sizeof text, "log:%s%s", self->path, self->repeats ? ",loop=1" : "");
        devices_panel_add(self, text);
    }
}

static void draw_recording(devices_panel *self, ui *on)
{
    ui_text(on, UI_STYLE_DIM, "A recording of a hand");
    ui_width(on, -(button + 8.0f));
    (void)ui_input(on, "##path", "path of a log file", self->path, sizeof self->path);
    ui_hint(on, "A table of a hand's angles or counts: .csv, or a recording of GraspDB14.");
    ui_same_line(on);
    ui_width(on, button);
    if (ui_button(on, "Open##recording", UI_PLAIN))
        open_recording(self);
    (void)ui_check(on, "Again and again", &self->repeats);
}

static void draw_network(devices_panel *self, ui *on)
{
    char text[160];
    ui_text(on, UI_STYLE_DIM, "Over the network (OSC)");
    ui_width(on, -(button + 8.0f));
    (void)ui_input(on, "##osc", "9105", self->osc, sizeof self->osc);
    ui_hint(on, "A port: heard from this computer alone. 0.0.0.0:9105: from every computer. "
                "9105/NAME: what another marotte forwards.");
    ui_same_line(on);
    ui_width(on, button);
    if (!ui_button(on, "Open##osc", UI_PLAIN))
        return;
    (void)snprintf(text, sizeof text, "osc:%s", self->osc[0] ? self->osc : "9105");
    devices_panel_add(self, text);
}

void devices_open_draw(devices_panel *self, ui *on)
{
    ui_text(on, UI_STYLE_TITLE, "Plugged in");
    ui_space(on, 2.0f);
    draw_found(self, on);
    ui_space(on, 6.0f);
    ui_rule(on);
    draw_recording(self, on);
    ui_space(on, 4.0f);
    draw_network(self, on);
}
