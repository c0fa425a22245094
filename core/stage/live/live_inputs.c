#include "stage/live/live_stage.h"
#include "base/clock.h"
#include "hand/calibration_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* [main] The pointer, which is always present, the other inputs, and the calibration of hands. */

/* After the pointer lets go, its samples continue for this time, while the skin springs back. */
static const int64_t spring_ns = 350 * NS_PER_MS;
static const char *const side_name[2] = {"left", "right"};

/* ---- the pointer ---- */

static void give(live *self, feed_activity activity)
{
    feed_push(self->pointer_feed, self->pointed, activity);
}

static void point(live *self, pointer_grip grip)
{
    self->pointed[POINTER_GRIP] = (float)grip;
    bool is_held = grip == POINTER_PULLS || grip == POINTER_KNEADS;
    bool was_held = self->is_pointing;
    self->is_pointing = is_held;
    if (is_held) {
        self->rests_at_ns = 0;
        self->moves = true;
    } else if (was_held || grip != POINTER_AWAY) {
        self->rests_at_ns = clock_now_ns() + spring_ns;
        self->moves = true;
    }
    give(self, self->moves || self->patch_moves ? FEED_MOVES : FEED_RESTS);
}

void live_point(live *self, pointer_grip grip, const float rest[3], const float at[3], bool stays,
                double radius_mm)
{
    float *to = self->pointed;
    bool is_away = grip == POINTER_AWAY && to[POINTER_GRIP] <= 0.0f;
    if (is_away)
        return; /* the pointer only hovers */
    if (grip != POINTER_AWAY) {
        memcpy(to + POINTER_REST_X, rest, 3 * sizeof *rest);
        memcpy(to + POINTER_AT_X, at, 3 * sizeof *at);
        to[POINTER_RADIUS] = (float)fmax(radius_mm, 0.0);
        to[POINTER_STAYS] = stays ? 1.0f : 0.0f;
    }
    point(self, grip);
}

void live_neutral(live *self)
{
    point(self, POINTER_AWAY); /* so that a second call is also detected as a change */
    point(self, POINTER_NEUTRAL);
}

void live_ease(live *self)
{
    if (self->is_pointing)
        return; /* its samples continue anyway */
    self->rests_at_ns = clock_now_ns() + spring_ns;
    self->moves = true;
    give(self, FEED_MOVES);
}

static void pointer_eases(live *self)
{
    point(self, POINTER_AWAY);
    live_ease(self);
}

static void let_pointer_rest(live *self)
{
    if (!self->moves || self->rests_at_ns == 0 || clock_now_ns() < self->rests_at_ns)
        return;
    self->moves = false;
    self->rests_at_ns = 0;
    if (!self->is_pointing)
        self->pointed[POINTER_GRIP] = POINTER_AWAY;
    give(self, self->patch_moves ? FEED_MOVES : FEED_RESTS);
}

/* A fader sends samples only while it moves. The pointer's feed supplies the samples that finish
 * the movement. */
static void follow_patch(live *self)
{
    bool is_moving = self->stage.pulse[slot_front(&self->stage.pulse_slot)].is_patch_moving;
    if (is_moving == self->patch_moves)
        return;
    self->patch_moves = is_moving;
    if (!self->moves)
        give(self, is_moving ? FEED_MOVES : FEED_RESTS);
}

/* ---- save and restore what the pointer pulled ---- */

typedef struct pulled {
    live_change change;
    void *bytes;
    size_t size, capacity;
    int grip; /* current grip of the pointer */
} pulled;

/* MRT_HOLD: the sample in which the pointer let go is not performed yet. */
static mrt_result await_pointer(const live_stage *stage, const pulled *p)
{
    return (int)stage->pointed.value[POINTER_GRIP] == p->grip ? MRT_OK : MRT_HOLD;
}

static mrt_result run_pulled(live *self, live_command_run *run, pulled *p, error *err)
{
    const int64_t until_ns = clock_now_ns() + NS_PER_S / 2;
    mrt_result result = live_run_command(self, run, p, err);
    while (result == MRT_HOLD && clock_now_ns() < until_ns) {
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
        result = live_run_command(self, run, p, err);
    }
    return result == MRT_HOLD ? error_set(err, MRT_ERR_ARGUMENT, "the stage is busy: try again")
                              : result;
}

static mrt_result save_pulled(live_stage *stage, void *data, error *err)
{
    (void)err;
    pulled *p = data;
    if (await_pointer(stage, p) == MRT_HOLD)
        return MRT_HOLD;
    p->size = performer_save_pointer(stage->scene->performer, p->bytes, p->capacity);
    return MRT_OK;
}

mrt_result live_save_pulled(live *self, void **out, size_t *out_size, error *err)
{
    pulled p = {.capacity = (size_t)64 << 10, .grip = (int)self->pointed[POINTER_GRIP]};
    for (;;) {
        p.bytes = malloc(p.capacity);
        mrt_result result = p.bytes ? run_pulled(self, save_pulled, &p, err)
                                    : error_set(err, MRT_ERR_MEMORY, "no memory for undo");
        if (result >= 0 && p.size <= p.capacity) {
            *out = p.bytes;
            *out_size = p.size;
            return MRT_OK;
        }
        free(p.bytes);
        if (result < 0)
            return result;
        p.capacity = p.size + p.size / 4; /* the face may change until the next try */
    }
}

static mrt_result load_pulled(live_stage *stage, void *data, error *err)
{
    pulled *p = data;
    if (await_pointer(stage, p) == MRT_HOLD)
        return MRT_HOLD;
    mrt_result result = performer_load_pointer(stage->scene->performer, p->bytes, p->size, err);
    return result < 0 ? result : live_cast_begin(stage, &p->change, err);
}

mrt_result live_load_pulled(live *self, const void *bytes, size_t size, error *err)
{
    pulled p = {.bytes = (void *)(uintptr_t)bytes, .size = size};
    mrt_result result = live_check_free(self, "undo of a pull", err);
    if (result >= 0)
        result = live_cast_prepare(self, &p.change, err);
    if (result >= 0) {
        pointer_eases(self);
        result = run_pulled(self, load_pulled, &p, err);
    }
    live_cast_dismiss(self, &p.change);
    return result;
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
    layer *of = stage->scene->performer->voice[0].layer;
    uint32_t count;
    const mrt_channel *channels = input_channels(player_input(stage->loop, c->remove), &count);
    layer_remove_hands(of, channels, count, c->keeps_clay);
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

/* The entry is already in the list. The caller removes it after an error. */
static mrt_result join_input(live *self, live_input_entry *entry, error *err)
{
    live_change c = {.add = entry->input, .heard = entry->heard};
    mrt_result result = live_cast_prepare(self, &c, err);
    input_set_wake(entry->input, player_wake(self->stage.loop));
    if (result >= 0)
        result = input_start(entry->input, err);
    if (result >= 0)
        result = live_run_command(self, add_input, &c, err);
    live_cast_dismiss(self, &c);
    return result;
}

mrt_result live_add_input(live *self, input *made, const char *text, error *err)
{
    mrt_result result = live_check_free(self, text, err);
    if (result >= 0 && self->entry_count == LIVE_INPUTS_MAX)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: the limit of %d inputs is reached: remove one first", text,
                           LIVE_INPUTS_MAX);
    live_input_entry entry = {
        .input = made, .text = strdup(text), .heard = calloc(1, sizeof(live_sample_board))};
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
        return error_set(err, MRT_ERR_ARGUMENT, "input %u does not exist", index);
    mrt_result result = live_check_free(self, self->entry[index].text, err);
    if (result < 0)
        return result;
    live_input_entry gone = self->entry[index], *at = &self->entry[index];
    live_change c = {.remove = index + 1, .keeps_clay = self->settings.keeps_clay};
    self->entry_count -= 1;
    size_t behind = (self->entry_count - index) * sizeof *at;
    memmove(at, at + 1, behind);
    result = live_cast_prepare(self, &c, err);
    if (result < 0) { /* the other inputs cannot be recorded without it: keep it */
        memmove(at + 1, at, behind);
        *at = gone;
        self->entry_count += 1;
        return result;
    }
    result = live_run_command(self, remove_input, &c, err);
    live_cast_dismiss(self, &c);
    live_ease(self);
    finish_entry(&gone);
    return result;
}

uint32_t live_input_count(const live *self)
{
    return self->entry_count;
}

bool live_input_is_own(const live *self, uint32_t index)
{
    bool is_own = false;
    for (int k = 0; index < self->entry_count && k < TAKE_OWN_PARTS; ++k)
        is_own |=
            strcmp(input_plugin(self->entry[index].input)->id, take_own_part_of[k].plugin) == 0;
    return is_own;
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
    (void)slot_receive(&board->slot);
    *out = board->sample[slot_front(&board->slot)];
    return out->count > 0;
}

uint64_t live_input_presses(live *self, uint32_t index)
{
    return index < self->entry_count ? atomic_exchange(&self->entry[index].heard->presses, 0) : 0;
}

void live_tap(live *self, uint32_t index)
{
    tap_select(self->tap, index < self->entry_count ? index : UINT32_MAX);
}

bool live_pop_tapped(live *self, mrt_sample *out)
{
    return tap_pop(self->tap, out);
}

/* ---- calibration of hands ---- */

static mrt_result recalibrate(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    player_calibrate(stage->loop, c->side, c->calibration);
    c->skeleton =
        hands_change(stage->scene->performer->voice[0].layer->hands, c->side, c->skeleton);
    return live_cast_begin(stage, c, err);
}

static void finish_measured(live_measured *m)
{
    free(m->path);
    free(m->text);
    free(m->use);
}

static mrt_result read_calibration(live_measured *out, uint32_t side, const char *path, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    *out = (live_measured){.use = malloc(sizeof *out->use), .path = strdup(path)};
    mrt_result result = MRT_OK;
    if (!file || !out->use || !out->path)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    if (result >= 0)
        result = calibration_file_read(file, path, err);
    if (result >= 0) {
        if (file->side != side)
            result = error_set(err, MRT_ERR_ARGUMENT,
                               "%s: this calibration is for the %s hand, not for the %s hand", path,
                               side_name[file->side % 2], side_name[side]);
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

/* Swaps the calibration: afterwards `m` has the old one. */
static void use_calibration(live *self, uint32_t side, live_measured *m)
{
    const live_measured before = self->hand[side];
    self->hand[side] = *m;
    *m = before;
}

mrt_result live_calibrate(live *self, uint32_t side, const char *path, error *err)
{
    live_measured m = {0};
    if (side > MRT_RIGHT)
        return error_set(err, MRT_ERR_ARGUMENT, "hand %u does not exist", side);
    mrt_result result = live_check_free(self, path ? path : "the calibration", err);
    if (result >= 0 && path)
        result = read_calibration(&m, side, path, err);
    if (result < 0)
        return result;
    live_change c = {.side = side, .calibration = m.use};
    double length_mm = m.length_mm > 0.0 ? m.length_mm : HAND_LENGTH_MM;
    use_calibration(self, side, &m);
    c.skeleton = hand_skeleton_create(side, length_mm);
    if (!c.skeleton)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    if (result >= 0)
        result = live_cast_prepare(self, &c, err);
    if (result >= 0)
        result = live_run_command(self, recalibrate, &c, err);
    else
        use_calibration(self, side, &m);
    live_cast_dismiss(self, &c);
    hand_skeleton_destroy(c.skeleton);
    finish_measured(&m);
    return result;
}

const char *live_calibration(const live *self, uint32_t side)
{
    return side <= MRT_RIGHT ? self->hand[side].path : NULL;
}

static mrt_result rezero(live_stage *stage, void *data, error *err)
{
    (void)data, (void)err;
    layer *of = stage->scene->performer->voice[0].layer;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        error why = {""};
        if (!of->frame.hand[side].present)
            continue;
        if (hands_rezero(of->hands, side, of->frame.time_ns, &why) != MRT_OK)
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
    (void)!live_run_command(self, rezero, NULL, &ignored);
}

static mrt_result change_pedal(live_stage *stage, void *data, error *err)
{
    live_change *c = data;
    hands_set_rezero_pedal(stage->scene->performer->voice[0].layer->hands, c->pedal);
    return live_cast_begin(stage, c, err);
}

/* Waits while a take is recorded. */
static void follow_pedal(live *self)
{
    error err = {""};
    live_change c = {.pedal = self->rezero_wanted};
    if (self->rezero_wanted == self->rezero_pedal || self->status.is_recording)
        return;
    self->rezero_pedal = self->rezero_wanted;
    if (live_cast_change(self, change_pedal, &c, &err) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err.text);
}

void live_set_rezero_pedal(live *self, uint32_t pedal)
{
    self->rezero_wanted = pedal <= MRT_MAX_PEDALS ? pedal : 0;
    follow_pedal(self);
}

/* ---- create and destroy ---- */

mrt_result live_pointer_open(live *self, error *err)
{
    feed_settings settings = {.id = "org.marotte.pointer", .name = "Mouse on the face"};
    settings.channels = pointer_channels(&settings.channel_count);
    self->tap = tap_create();
    mrt_result result =
        self->tap ? feed_create(&self->pointer_feed, &settings, err)
                  : error_set(err, MRT_ERR_MEMORY, "no memory to buffer the samples of an input");
    if (result >= 0)
        result = input_create(&self->pointer, feed_type(self->pointer_feed), "", "", CLOCK_REAL,
                              self->settings.log, err);
    if (result < 0)
        return result;
    input_set_wake(self->pointer, player_wake(self->stage.loop));
    player_add_input(self->stage.loop, self->pointer);
    self->stage.input_count = 1;
    return MRT_OK;
}

void live_inputs_finish(live *self)
{
    for (uint32_t i = 0; i < self->entry_count; ++i)
        finish_entry(&self->entry[i]);
    input_destroy(self->pointer);
    feed_destroy(self->pointer_feed);
    tap_destroy(self->tap);
    for (int side = 0; side < 2; ++side) {
        finish_measured(&self->hand[side]);
    }
}

void live_inputs_update(live *self)
{
    let_pointer_rest(self);
    follow_patch(self);
    follow_pedal(self);
}
