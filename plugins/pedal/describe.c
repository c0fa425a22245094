#include "describe.h"

#include <stdio.h>
#include <string.h>

/* HID usage tables 1.3 */
enum {
    PAGE_DESKTOP = 0x01,
    PAGE_SIMULATION = 0x02,
    PAGE_KEYBOARD = 0x07,
    PAGE_BUTTON = 0x09,
    DESKTOP_X = 0x30,
    DESKTOP_WHEEL = 0x38,
    SIMULATION_RUDDER = 0xba,
    SIMULATION_THROTTLE = 0xbb,
    SIMULATION_ACCELERATOR = 0xc4,
    SIMULATION_BRAKE = 0xc5,
    SIMULATION_CLUTCH = 0xc6
};

static bool is_button(const descriptor_field *field)
{
    return field->page == PAGE_BUTTON && !field->is_array && field->width == 1;
}

static bool is_foot_axis(const descriptor_field *field)
{
    return field->page == PAGE_SIMULATION && !field->is_array &&
           (field->usage == SIMULATION_ACCELERATOR || field->usage == SIMULATION_BRAKE ||
            field->usage == SIMULATION_CLUTCH);
}

bool describe_is_axis(const descriptor_field *field)
{
    if (field->is_array || field->is_relative || field->width < 4)
        return false;
    return is_foot_axis(field) ||
           (field->page == PAGE_DESKTOP && field->usage >= DESKTOP_X &&
            field->usage <= DESKTOP_WHEEL) ||
           (field->page == PAGE_SIMULATION &&
            (field->usage == SIMULATION_RUDDER || field->usage == SIMULATION_THROTTLE));
}

static const char *axis_name(const descriptor_field *field)
{
    static const char *const desktop[] = {"axis x",  "axis y", "axis z", "axis rx", "axis ry",
                                          "axis rz", "slider", "dial",   "wheel"};
    if (field->page == PAGE_DESKTOP)
        return desktop[field->usage - DESKTOP_X];
    switch (field->usage) {
    case SIMULATION_RUDDER:
        return "rudder";
    case SIMULATION_THROTTLE:
        return "throttle";
    case SIMULATION_ACCELERATOR:
        return "accelerator";
    case SIMULATION_BRAKE:
        return "brake";
    default:
        return "clutch";
    }
}

static void add_switch(layout *out, const descriptor_field *field)
{
    if (out->switch_count == LAYOUT_SWITCHES)
        return;
    layout_switch *s = &out->switches[out->switch_count++];
    *s = (layout_switch){.report_id = field->report_id,
                         .bit = field->bit,
                         .width = field->width,
                         .is_signed = field->is_signed,
                         .up = field->low,
                         .down = field->high};
    if (is_button(field))
        snprintf(s->name, sizeof s->name, "button %u", field->usage);
    else
        snprintf(s->name, sizeof s->name, "%s", axis_name(field));
}

static void add_buttons(layout *out, const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i)
        if (is_button(&from->field[i]))
            add_switch(out, &from->field[i]);
}

/* The pedals' own axes, if it names any; else all but those that are skipped. */
static void add_axes(layout *out, const descriptor *from, bool has_foot_axes)
{
    uint32_t passed = 0;
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        if (has_foot_axes ? is_foot_axis(field)
                          : describe_is_axis(field) && passed++ >= out->axis_skip)
            add_switch(out, field);
    }
}

static bool has_any(const descriptor *from, bool (*is)(const descriptor_field *))
{
    for (uint32_t i = 0; i < from->field_count; ++i)
        if (is(&from->field[i]))
            return true;
    return false;
}

bool describe_switches(layout *out, const descriptor *from)
{
    out->switch_count = 0;
    bool has_foot_axes = has_any(from, is_foot_axis);
    bool axes_first = has_foot_axes || out->axis_skip > 0;
    if (axes_first)
        add_axes(out, from, has_foot_axes);
    add_buttons(out, from);
    if (!axes_first)
        add_axes(out, from, false);
    return out->switch_count > 0;
}

bool describe_keys(layout *out, const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        if (!field->is_array || field->page != PAGE_KEYBOARD || field->width != 8 ||
            field->bit % 8 != 0 || field->count > UINT8_MAX || field->bit / 8 > UINT8_MAX)
            continue;
        out->key_report_id = field->report_id;
        out->key_at = (uint8_t)(field->bit / 8);
        out->key_count = (uint8_t)field->count;
        return true;
    }
    return false;
}

bool describe_may_be_pedal(const descriptor *from)
{
    for (uint32_t i = 0; i < from->field_count; ++i) {
        const descriptor_field *field = &from->field[i];
        bool is_of_mouse = field->page == PAGE_DESKTOP && field->is_relative;
        if (is_of_mouse || field->page == PAGE_KEYBOARD)
            return false;
    }
    return has_any(from, is_button) || has_any(from, describe_is_axis);
}
