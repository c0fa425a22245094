#include "teach.h"
#include "layout_file.h"

#include <string.h>

static void ask(const mrt_plugin *self)
{
    uint32_t found = self->learn.found.switch_count;
    if (found == 0)
        pedal_say(self, MRT_LOG_INFO, "learn: press switch 1 and let it go");
    else
        pedal_say(self, MRT_LOG_INFO,
                  "learn: switch %u is known: press switch %u and let it go, or an earlier one "
                  "again if that was all",
                  found, found + 1);
}

/* Channels stay what they were until the input is opened again. */
static void adopt(mrt_plugin *self)
{
    if (self->layout.switch_count != self->learn.found.switch_count) {
        self->host->request_restart(self->host);
        return;
    }
    self->layout = self->learn.found;
    self->analogue = 0;
    for (uint32_t i = 0; i < self->layout.switch_count; ++i)
        if (layout_is_analogue(&self->layout.switches[i]))
            self->analogue |= 1u << i;
    memset(self->value, 0, sizeof self->value);
}

static void finish(mrt_plugin *self)
{
    char reason[LAYOUT_FILE_REASON], path[LAYOUT_FILE_PATH];
    const layout *found = &self->learn.found;
    if (layout_file_store(found, reason) < 0) {
        pedal_say(self, MRT_LOG_ERROR, "learn: given up: %s", reason);
        return;
    }
    (void)layout_file_path(path, found->vendor, found->product);
    pedal_say(self, MRT_LOG_INFO, "learn: done: %u switches of %.60s are in %s",
              found->switch_count, found->name, path);
    adopt(self);
}

static void say_progress(mrt_plugin *self)
{
    switch (self->learn.stage) {
    case LEARN_WAIT:
        ask(self);
        break;
    case LEARN_DONE:
        finish(self);
        break;
    case LEARN_FAILED:
        pedal_say(self, MRT_LOG_WARNING,
                  "learn: given up: no switch was pressed and let go within 15 s: begin again");
        break;
    default:
        break;
    }
}

void teach_begin(mrt_plugin *self, int64_t now_ns)
{
    if (learn_is_running(&self->learn))
        return;
    learn_start(&self->learn, &self->layout, self->fields.field_count > 0 ? &self->fields : NULL,
                now_ns);
    pedal_say(self, MRT_LOG_INFO, "learn: take your feet off %.60s at usb:%s", self->name,
              self->device.path);
}

void teach_report(mrt_plugin *self, const usb_report *report)
{
    if (learn_report(&self->learn, report->bytes, report->size, report->time_ns))
        say_progress(self);
}

void teach_tick(mrt_plugin *self, int64_t now_ns)
{
    if (learn_tick(&self->learn, now_ns))
        say_progress(self);
}

void teach_lose(mrt_plugin *self)
{
    if (!learn_is_running(&self->learn))
        return;
    self->learn.stage = LEARN_FAILED;
    pedal_say(self, MRT_LOG_WARNING, "learn: given up: the device went away: begin again");
}
