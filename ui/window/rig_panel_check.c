/* What is wrong with a rig, while it is edited: a click goes to what a finding speaks of. */
#include "window/rig_panel_inside.h"

#include <stdio.h>
#include <string.h>

enum { TITLE = 200 };

static void title_of(const rig *r, const rig_finding *finding, uint32_t number, char *out,
                     size_t capacity)
{
    uint32_t index;
    switch (rig_edit_kind_at(r, finding->path, &index)) {
    case RIG_EDIT_REGION:
        if (r->region[index].name)
            (void)snprintf(out, capacity, "Region %s##finding%u", r->region[index].name, number);
        else
            (void)snprintf(out, capacity, "Region %u##finding%u", index + 1, number);
        break;
    case RIG_EDIT_CONTACT:
        (void)snprintf(out, capacity, "Contact %s##finding%u", r->contact[index].name, number);
        break;
    case RIG_EDIT_BONE:
        (void)snprintf(out, capacity, "Bone %s##finding%u", r->bone[index].name, number);
        break;
    case RIG_EDIT_OTHER:
        (void)snprintf(out, capacity, "%.100s##finding%u",
                       strcmp(finding->path, "$") == 0        ? "The rig"
                       : strncmp(finding->path, "$.", 2) == 0 ? finding->path + 2
                                                              : finding->path,
                       number);
        break;
    }
}

static void go_to(rig_panel *self, const rig *r, const rig_finding *finding)
{
    uint32_t index;
    rig_edit_kind kind = rig_edit_kind_at(r, finding->path, &index);
    if (kind == RIG_EDIT_REGION)
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
    if (kind == RIG_EDIT_CONTACT)
        rig_panel_choose(self, RIG_TAB_CONTACTS, index);
    if (kind == RIG_EDIT_BONE && r->bone[index].kind == BONE_JAW)
        rig_panel_choose(self, RIG_TAB_JAW, index);
    self->shown.is_shape_new = true;
}

static void draw_finding(rig_panel *self, ui *on, const rig *r, const rig_finding *finding,
                         uint32_t number)
{
    static const ui_style style[] = {
        [RIG_NOTE] = UI_STYLE_DIM, [RIG_WARNING] = UI_STYLE_WARNING, [RIG_ERROR] = UI_STYLE_BAD};
    char title[TITLE];
    title_of(r, finding, number, title, sizeof title);
    if (title[0] >= 'a' && title[0] <= 'z')
        title[0] = (char)(title[0] - 'a' + 'A');
    if (ui_row(on, title, false) != UI_ROW_NONE)
        go_to(self, r, finding);
    ui_text_wrapped(on, style[finding->severity], finding->text);
    ui_space(on, 4.0f);
}

static void draw_confirm(rig_panel *self, ui *on)
{
    char line[512];
    if (!self->confirm || !ui_section(on, "Guessed by the draft", true))
        return;
    for (const char *at = self->confirm; *at;) {
        size_t length = strcspn(at, "\n");
        (void)snprintf(line, sizeof line, "%.*s", (int)length, at);
        ui_text_wrapped(on, UI_STYLE_BODY, line);
        ui_space(on, 4.0f);
        at += length + (at[length] == '\n');
    }
}

static void draw_summary(const rig_work *work, bool is_laid, ui *on)
{
    uint32_t errors = rig_findings_count(&work->findings, RIG_ERROR);
    uint32_t warnings = rig_findings_count(&work->findings, RIG_WARNING);
    char text[128];
    if (!is_laid) {
        ui_text(on, UI_STYLE_DIM, "Looking at the last change \xe2\x80\xa6");
        return;
    }
    if (errors > 0)
        (void)snprintf(text, sizeof text, "%u to be mended: the stage keeps the rig before.",
                       errors);
    else if (warnings > 0)
        (void)snprintf(text, sizeof text, "It performs; %u to look at.", warnings);
    else
        (void)snprintf(text, sizeof text, "Nothing is wrong with it.");
    ui_text_wrapped(on, errors ? UI_STYLE_BAD : warnings ? UI_STYLE_WARNING : UI_STYLE_GOOD, text);
}

void rig_panel_draw_check(rig_panel *self, ui *on)
{
    const rig_work *work = rig_model_work(self->model);
    const rig *r = rig_model_rig(self->model);
    if (!work) {
        ui_text(on, UI_STYLE_DIM, "Looking at it \xe2\x80\xa6");
        return;
    }
    draw_summary(work, rig_model_is_laid(self->model), on);
    ui_space(on, 4.0f);
    for (uint32_t i = 0; i < work->findings.count; ++i)
        draw_finding(self, on, r, &work->findings.item[i], i);
    draw_confirm(self, on);
}
