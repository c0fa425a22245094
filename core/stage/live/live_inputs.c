/* [main] The inputs of a live stage, and how hands are measured. */
#include "base/clock.h"
#include "hand/calibration_file.h"
#include "stage/live/live_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const side_name[2] = {"left", "right"};

static char *copy_of(const char *text)
{
    return text ? strdup(text) : NULL;
}

/* ---- inputs ---- */

static mrt_result add_input(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    stage->heard[stage->input_count++] = c->heard;
    player_add_input(stage->loop, c->add);
    return live_cast_begin(stage, c, err);
}

static mrt_result remove_input(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    player_remove_input(stage->loop, c->remove);
    stage->input_count -= 1;
    for (uint32_t i = c->remove; i < stage->input_count; ++i)
        stage->heard[i] = stage->heard[i + 1];
    return live_cast_begin(stage, c, err);
}

static void finish_entry(live_input_entry *entry)
{
    input_destroy(entry->input);
    free(entry->text);
    free(entry->heard);
}

/* The entry is in the list; taken out again when it cannot be. */
static mrt_result join_input(live *self, live_input_entry *entry, error *err)
{
    live_change c = {.add = entry->input, .heard = entry->heard};
    const recorder_settings as = live_cast_settings(self, true);
    mrt_result result = live_cast_prepare(self, &as, &c, err);
    input_set_wake(entry->input, player_wake(self->stage.loop));
    if (result >= 0)
        result = input_start(entry->input, err);
    if (result >= 0)
        result = live_ask(self, add_input, &c, err);
    live_cast_dismiss(self, &c);
    return result;
}

mrt_result live_add_input(live *self, input *made, const char *text, error *err)
{
    mrt_result result = live_check_free(self, text, err);
    if (result >= 0 && self->entry_count == LIVE_INPUTS_MAX)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: %d inputs are open, more are not possible",
                           text, LIVE_INPUTS_MAX);
    live_input_entry entry = {
        .input = made, .text = copy_of(text), .heard = calloc(1, sizeof(live_sample_board))};
    if (result >= 0 && (!entry.text || !entry.heard))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for input %s", text);
    if (result < 0) {
        finish_entry(&entry);
        return result;
    }
    slot_init(&entry.heard->slot);
    self->entry[self->entry_count++] = entry;
    result = join_input(self, &entry, err);
    if (result < 0) {
        self->entry_count -= 1;
        finish_entry(&entry);
    }
    return result;
}

mrt_result live_remove_input(live *self, uint32_t index, error *err)
{
    if (index >= self->entry_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no input %u", index);
    mrt_result result = live_check_free(self, self->entry[index].text, err);
    if (result < 0)
        return result;
    live_input_entry gone = self->entry[index], *at = &self->entry[index];
    live_change c = {.remove = index + 1};
    self->entry_count -= 1;
    size_t behind = (self->entry_count - index) * sizeof *at;
    memmove(at, at + 1, behind);
    const recorder_settings as = live_cast_settings(self, true);
    result = live_cast_prepare(self, &as, &c, err);
    if (result < 0) { /* it is recorded with the others: it stays */
        memmove(at + 1, at, behind);
        *at = gone;
        self->entry_count += 1;
        return result;
    }
    result = live_ask(self, remove_input, &c, err);
    live_cast_dismiss(self, &c);
    finish_entry(&gone);
    return result;
}

uint32_t live_input_count(const live *self)
{
    return self->entry_count;
}

input *live_input(live *self, uint32_t index)
{
    return index < self->entry_count ? self->entry[index].input : NULL;
}

const char *live_input_text(const live *self, uint32_t index)
{
    return index < self->entry_count ? self->entry[index].text : "";
}

bool live_input_sample(live *self, uint32_t index, mrt_sample *out)
{
    if (index >= self->entry_count)
        return false;
    live_sample_board *board = self->entry[index].heard;
    (void)slot_take(&board->slot);
    *out = board->sample[slot_front(&board->slot)];
    return out->count > 0;
}

void live_tap(live *self, uint32_t index)
{
    tap_listen(self->tap, index < self->entry_count ? index : UINT32_MAX);
}

bool live_take_tapped(live *self, mrt_sample *out)
{
    return tap_take(self->tap, out);
}

/* ---- how hands are measured ---- */

static mrt_result recalibrate(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    player_calibrate(stage->loop, c->side, c->calibration);
    c->skeleton =
        hands_change(layer_hands(performer_layer(stage->scene->performer)), c->side, c->skeleton);
    return live_cast_begin(stage, c, err);
}

typedef struct measured { /* a calibration that was read */
    char *path, *text;
    hand_calibration *use;
    double length_mm;
} measured;

static void finish_measured(measured *m)
{
    free(m->path);
    free(m->text);
    free(m->use);
}

static mrt_result read_calibration(measured *out, uint32_t side, const char *path, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    *out = (measured){.use = malloc(sizeof *out->use), .path = copy_of(path)};
    mrt_result result = MRT_OK;
    if (!file || !out->use || !out->path)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    if (result >= 0)
        result = calibration_file_read(file, path, err);
    if (result >= 0) {
        if (file->side != side)
            result = error_set(err, MRT_ERR_ARGUMENT, "%s: is of the %s hand, not of the %s one",
                               path, side_name[file->side % 2], side_name[side]);
        calibration_file_use(file, out->use);
        out->length_mm = file->hand_length_mm;
        out->text = calibration_file_text(file);
        if (!out->text && result >= 0)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        calibration_file_finish(file);
    }
    free(file);
    if (result < 0)
        finish_measured(out);
    return result;
}

/* What it was until now comes out in `m`. */
static void put_on(live *self, uint32_t side, measured *m)
{
    const measured before = {self->calibration_path[side], self->calibration_text[side],
                             self->calibration[side], self->length_mm[side]};
    self->calibration_path[side] = m->path;
    self->calibration_text[side] = m->text;
    self->calibration[side] = m->use;
    self->length_mm[side] = m->length_mm;
    *m = before;
}

mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err)
{
    measured m = {0};
    if (side > MRT_RIGHT)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no hand %u", side);
    mrt_result result = live_check_free(self, path ? path : "the calibration", err);
    if (result >= 0 && path)
        result = read_calibration(&m, side, path, err);
    if (result < 0)
        return result;
    live_change c = {.side = side, .calibration = m.use};
    double length_mm = m.length_mm > 0.0 ? m.length_mm : HAND_LENGTH_MM;
    put_on(self, side, &m);
    const recorder_settings as = live_cast_settings(self, true);
    c.skeleton = hand_skeleton_create(side, length_mm);
    if (!c.skeleton)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    if (result >= 0)
        result = live_cast_prepare(self, &as, &c, err);
    if (result >= 0)
        result = live_ask(self, recalibrate, &c, err);
    else
        put_on(self, side, &m);
    live_cast_dismiss(self, &c);
    hand_skeleton_destroy(c.skeleton);
    finish_measured(&m);
    return result;
}

const char *live_calibration(const live *self, uint32_t side)
{
    return side <= MRT_RIGHT ? self->calibration_path[side] : NULL;
}

static mrt_result rezero(live_stage *stage, void *data, error *err)
{
    (void)data, (void)err;
    performer *p = stage->scene->performer;
    const mrt_hand *hand = layer_frame(performer_layer(p))->hand;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        error why = {""};
        if (!hand[side].present)
            continue;
        if (performer_rezero(p, side, &why) != MRT_OK)
            log_pushf(stage->log, MRT_LOG_INFO, "stage", "%s hand not re-zeroed: %s",
                      side_name[side], why.text);
        else if (stage->recorder)
            recorder_rezero(stage->recorder, side);
    }
    return MRT_OK;
}

void live_rezero(live *self)
{
    error ignored = {""};
    (void)!live_ask(self, rezero, NULL, &ignored);
}

static mrt_result change_pedal(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    hands_set_rezero_pedal(layer_hands(performer_layer(stage->scene->performer)), c->pedal);
    return live_cast_begin(stage, c, err);
}

void live_inputs_change_pedal(live *self)
{
    error err = {""};
    live_change c = {.pedal = self->rezero_wanted};
    self->rezero_pedal = self->rezero_wanted;
    const recorder_settings as = live_cast_settings(self, true);
    mrt_result result = live_cast_prepare(self, &as, &c, &err);
    if (result >= 0)
        result = live_ask(self, change_pedal, &c, &err);
    if (result < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
    live_cast_dismiss(self, &c);
}

void live_set_rezero_pedal(live *self, uint32_t pedal)
{
    self->rezero_wanted = pedal <= MRT_MAX_PEDALS ? pedal : 0;
    live_cast_update(self);
}
