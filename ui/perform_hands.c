#include "perform_hands.h"

#include "hand/calibration_folder.h"
#include "keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const side_name[2] = {"left", "right"};

/* ---- which calibration ---- */

static bool is_in_counts(const input *from, uint32_t side)
{
    uint32_t count;
    const mrt_channel *channel = input_channels(from, &count);
    for (uint32_t i = 0; i < count; ++i)
        if (channel[i].hand == side && channel[i].semantic >= MRT_CH_ANGLE &&
            channel[i].semantic < MRT_CH_ANGLE + MRT_ANGLES &&
            strcmp(channel[i].unit, "count") == 0)
            return true;
    return false;
}

static bool needs_calibration(input *const *inputs, uint32_t input_count, uint32_t side)
{
    for (uint32_t i = 0; i < input_count; ++i)
        if (is_in_counts(inputs[i], side))
            return true;
    return false;
}

static void print_lines(const char *text)
{
    for (const char *line = text; *line;) {
        size_t length = strcspn(line, "\n");
        fprintf(stderr, "note: %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

/* Takes what is needed of the file, and finishes it; path: taken over. */
static void put_on(perform_hands *self, calibration_file *file, char *path)
{
    uint32_t side = file->side;
    self->path[side] = path;
    self->length_mm[side] = file->hand_length_mm;
    calibration_file_use(file, &self->use[side]);
    print_lines(file->note);
    calibration_file_finish(file);
}

static mrt_result choose_named(perform_hands *self, const char *path, calibration_file *file,
                               error *err)
{
    mrt_result result = calibration_file_read(file, path, err);
    if (result < 0)
        return result;
    if (self->path[file->side]) {
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: is of the %s hand, as %s is: one calibration per hand", path,
                           side_name[file->side], self->path[file->side]);
        calibration_file_finish(file);
        return result;
    }
    char *copy = strdup(path);
    if (copy) {
        put_on(self, file, copy);
        return MRT_OK;
    }
    calibration_file_finish(file);
    return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

static mrt_result choose_newest(perform_hands *self, uint32_t side, calibration_file *file,
                                error *err)
{
    char *path;
    error note;
    mrt_result result = calibration_folder_newest(file, &path, side, &note, err);
    if (result < 0)
        return result;
    if (note.text[0])
        fprintf(stderr, "note: %s\n", note.text);
    if (result == MRT_OK) {
        fprintf(stderr, "note: %s hand: %s (%s, %s)\n", side_name[side], path,
                file->name[0] ? file->name : "no name", file->date[0] ? file->date : "no date");
        put_on(self, file, path);
    }
    return MRT_OK;
}

static mrt_result choose(perform_hands *self, const perform_options *options, input *const *inputs,
                         uint32_t input_count, calibration_file *file, error *err)
{
    bool has_named = options->calibration_count > 0;
    bool has_none = has_named && strcmp(options->calibration[0], "none") == 0;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; !has_none && i < options->calibration_count && result >= 0; ++i)
        result = choose_named(self, options->calibration[i], file, err);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT && result >= 0; ++side) {
        bool is_needed = needs_calibration(inputs, input_count, side);
        if (self->path[side] && !is_needed)
            fprintf(stderr, "note: %s: not used: no glove gives counts of a %s hand\n",
                    self->path[side], side_name[side]);
        if (is_needed && !self->path[side] && !has_none)
            result = choose_newest(self, side, file, err);
        if (result >= 0 && is_needed && !self->path[side])
            fprintf(stderr,
                    "note: %s hand not calibrated: shipped defaults; marotte calibrate --input "
                    "PLUGIN:ADDRESS --name NAME --hand %s\n",
                    side_name[side], side_name[side]);
    }
    return result;
}

mrt_result perform_hands_choose(perform_hands *out, const perform_options *options,
                                input *const *inputs, uint32_t input_count, error *err)
{
    memset(out, 0, sizeof *out);
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = choose(out, options, inputs, input_count, file, err);
    free(file);
    return result;
}

void perform_hands_finish(perform_hands *self)
{
    for (int side = 0; side < 2; ++side) {
        free(self->path[side]);
        self->path[side] = NULL;
    }
}

const hand_calibration *perform_hands_calibration(const perform_hands *self, uint32_t side)
{
    return self->path[side] ? &self->use[side] : NULL;
}

mrt_result perform_hands_text(char **out, const char *path, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    mrt_result result = calibration_file_read(file, path, err);
    if (result >= 0) {
        *out = calibration_file_text(file);
        calibration_file_finish(file);
        if (!*out)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    }
    free(file);
    return result;
}

/* ---- while it goes on, and afterwards ---- */

void perform_hands_report(const perform_hands *self, const performer *p, facts *told)
{
    const rezero_counts *rezeros = performer_rezeros(p);
    for (int side = 0; side < 2; ++side)
        if (self->path[side])
            facts_list(told, "calibrations", "calibration", self->path[side]);
    if (rezeros->done + rezeros->refused == 0)
        return;
    facts_number(told, "rezeros", "re-zeros", rezeros->done, 0, "");
    facts_number(told, "rezeros_refused", "  refused", rezeros->refused, 0, rezeros->refusal.text);
}

static uint32_t rezero(performer *p)
{
    uint32_t done = 0;
    const mrt_hand *hand = layer_frame(performer_layer(p))->hand;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        if (!hand[side].present)
            continue;
        error why = {""};
        if (performer_rezero(p, side, &why) == MRT_OK) {
            done |= 1u << side;
            fprintf(stderr, "note: the %s hand's pose is its neutral pose now\n", side_name[side]);
        } else {
            fprintf(stderr, "note: not re-zeroed: %s\n", why.text);
        }
    }
    return done;
}

uint32_t perform_hands_keys(performer *p, _Atomic bool *stop, progress *shown)
{
    uint32_t done = 0;
    for (char key = keys_next(); key; key = keys_next()) {
        progress_end(shown);
        if (key == 'z')
            done |= rezero(p);
        else if (key == 'q')
            atomic_store(stop, true);
    }
    return done;
}
