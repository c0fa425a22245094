#include "cli/perform_session.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "hand/calibration_folder.h"
#include "stage/input/glove_channels.h"
#include "stage/mapping/null_mapping.h"
#include "stage/perform/life_input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- inputs ---- */

mrt_result perform_inputs_open(perform_inputs *out, const plugin_spec *spec, uint32_t count,
                               plugin_list *plugins, log_queue *log, instance_clock clock,
                               error *err)
{
    const mrt_plugin_type *type[PERFORM_INPUTS_MAX];
    *out = (perform_inputs){.spec = spec, .clock = clock};
    for (uint32_t i = 0; i < count; ++i) {
        mrt_result result = plugin_list_choose(plugins, spec[i].plugin, MRT_INPUT, &type[i], err);
        if (result < 0)
            return result;
        if (!input_is_recording(type[i], spec[i].address))
            out->clock = CLOCK_REAL; /* a device performs in real time */
    }
    for (; out->count < count; ++out->count) {
        const plugin_spec *of = &spec[out->count];
        mrt_result result =
            input_create_stoppable(&out->input[out->count], type[out->count], of->address,
                                   of->params, out->clock, log, cancel_flag(), err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

mrt_result perform_inputs_add_life(perform_inputs *self, const char *params, double seconds,
                                   const mapped_face *mapped, log_queue *log, error *err)
{
    input *made;
    char length[32];
    const life_body body = life_body_of(mapped);
    if (self->count == PERFORM_INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "--life: %d inputs are open already. Remove one",
                         PERFORM_INPUTS_MAX);
    mrt_result result = input_create(&made, &life_input_type, "", params, self->clock, log, err);
    if (result < 0)
        return result;
    self->input[self->count++] = made;
    for (int kind = 0; kind < LIFE_KINDS; ++kind)
        if (input_value(made, (uint32_t)kind) > 0.0 && life_missing(&body, (life_kind)kind))
            fprintf(stderr, "note: %s\n", life_missing(&body, (life_kind)kind));
    (void)snprintf(length, sizeof length, "%.9g", seconds);
    return input_set(made, "seconds", length, err);
}

double perform_inputs_duration_s(const perform_inputs *self)
{
    double longest_s = 0.0;
    for (uint32_t i = 0; i < self->count; ++i) {
        const double duration_s = input_duration_s(self->input[i]);
        if (duration_s < 0.0)
            return 0.0;
        longest_s = duration_s > longest_s ? duration_s : longest_s;
    }
    return longest_s;
}

void perform_inputs_close(perform_inputs *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        input_destroy(self->input[i]);
    self->count = 0;
}

void perform_inputs_incident(const perform_inputs *self, recorder *into, const input *from,
                             const input_incident *what, double time_s)
{
    for (uint32_t i = 0; into && i < self->count; ++i)
        if (self->input[i] == from)
            recorder_incident(into, i, what);
    if (what->kind == INPUT_WAS_LOST)
        fprintf(stderr, "note: %s went away at %.1f s%s%s%s; the pose is held\n", input_name(from),
                time_s, what->text[0] ? " (" : "", what->text, what->text[0] ? ")" : "");
    else
        fprintf(stderr, "note: %s came back after %.1f s\n", input_name(from),
                (double)what->away_ns / 1e9);
}

/* ---- hands ---- */

static const char *const side_name[2] = {"left", "right"};

/* ---- which calibration ---- */

/* Returns the input that needs a calibration for this hand, and writes the kind of calibration
 * (hand_calibration): "" for a glove in counts, which is preferred to a bare hand. NULL: none. A
 * recording in rad is performed unchanged. */
static const input *find_hand(char out[HAND_INPUT], const perform_inputs *from, uint32_t side)
{
    const input *bare = NULL;
    for (uint32_t i = 0; i < from->count; ++i) {
        uint32_t count;
        const input *in = from->input[i];
        const mrt_channel *channel = input_channels(in, &count);
        const mrt_input *functions = plugin_interface(input_plugin(in), MRT_INPUT);
        const glove_channels_kind kind = glove_channels_of(channel, count, side);
        if (kind == GLOVE_CHANNELS_COUNT) {
            out[0] = '\0';
            return in;
        }
        if (kind != GLOVE_CHANNELS_RAD || bare || functions->flags & MRT_INPUT_RECORDED)
            continue;
        glove_channels_input(out, input_name(in));
        bare = in;
    }
    return bare;
}

/* Writes the address as it was given: "osc:0.0.0.0:39539". */
static void write_address(char *out, size_t capacity, const perform_inputs *from, const input *of)
{
    out[0] = '\0';
    for (uint32_t i = 0; i < from->count; ++i)
        if (from->input[i] == of)
            (void)snprintf(out, capacity, "%s%s%s", from->spec[i].plugin,
                           from->spec[i].address[0] ? ":" : "", from->spec[i].address);
}

/* Copies the needed parts of the file, and finishes it. Takes ownership of path. */
static void use_calibration(perform_hands *self, calibration_file *file, char *path)
{
    uint32_t side = file->side;
    self->path[side] = path;
    self->length_mm[side] = file->hand_length_mm;
    calibration_file_use(file, &self->use[side]);
    news_print_notes(file->note);
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
                           "%s: for the %s hand, like %s. Give one calibration per hand", path,
                           side_name[file->side], self->path[file->side]);
        calibration_file_finish(file);
        return result;
    }
    char *copy = strdup(path);
    if (copy) {
        use_calibration(self, file, copy);
        return MRT_OK;
    }
    calibration_file_finish(file);
    return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
}

static mrt_result choose_newest(perform_hands *self, uint32_t side, const char *of,
                                calibration_file *file, error *err)
{
    char *path;
    error note;
    mrt_result result = calibration_folder_newest(file, &path, side, of, &note, err);
    if (result < 0)
        return result;
    if (note.text[0])
        fprintf(stderr, "note: %s\n", note.text);
    if (result == MRT_OK) {
        fprintf(stderr, "note: %s hand: %s (%s, %s)\n", side_name[side], path,
                file->name[0] ? file->name : "no name", file->date[0] ? file->date : "no date");
        use_calibration(self, file, path);
    }
    return MRT_OK;
}

static mrt_result choose(perform_hands *self, const char *const *path, uint32_t count,
                         const perform_inputs *from, calibration_file *file, error *err)
{
    bool has_none = count > 0 && strcmp(path[0], "none") == 0;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; !has_none && i < count && result >= 0; ++i)
        result = choose_named(self, path[i], file, err);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT && result >= 0; ++side) {
        char of[HAND_INPUT], address[256];
        const input *hand = find_hand(of, from, side);
        const bool is_needed = hand != NULL;
        write_address(address, sizeof address, from, hand);
        if (self->path[side] && !(is_needed && strcmp(of, self->use[side].input) == 0))
            fprintf(stderr, "note: %s: not used: no %s provides a %s hand\n", self->path[side],
                    self->use[side].input[0] ? self->use[side].input : "glove in counts",
                    side_name[side]);
        if (is_needed && !self->path[side] && !has_none)
            result = choose_newest(self, side, of, file, err);
        if (result >= 0 && is_needed && !self->path[side] && !of[0])
            fprintf(stderr,
                    "note: the %s hand is not calibrated; the shipped defaults are used. Calibrate "
                    "it: marotte calibrate --input PLUGIN:ADDRESS --name NAME --hand %s\n",
                    side_name[side], side_name[side]);
        if (result >= 0 && is_needed && !self->path[side] && of[0])
            fprintf(stderr,
                    "note: the %s hand of %s is not calibrated. Calibrate it in ten seconds: "
                    "marotte calibrate --input %s --name NAME\n",
                    side_name[side], of, address[0] ? address : of);
    }
    return result;
}

mrt_result perform_hands_choose(perform_hands *out, const char *const *path, uint32_t count,
                                const perform_inputs *from, error *err)
{
    memset(out, 0, sizeof *out);
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = choose(out, path, count, from, file, err);
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

mrt_result perform_hands_text(char *out[2], const char *path, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    mrt_result result = calibration_file_read(file, path, err);
    if (result >= 0) {
        char **text = &out[file->side];
        free(*text);
        *text = calibration_file_text(file);
        if (!*text)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        calibration_file_finish(file);
    }
    free(file);
    return result;
}

/* ---- hands during and after the performance ---- */

void perform_hands_report(const perform_hands *self, const performer *p, facts *told)
{
    const rezero_counts *rezeros = hands_rezeros(p->voice[0].layer->hands);
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
    layer *of = p->voice[0].layer;
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        if (!of->frame.hand[side].present)
            continue;
        error why = {""};
        if (hands_rezero(of->hands, side, of->frame.time_ns, &why) == MRT_OK) {
            done |= 1u << side;
            fprintf(stderr, "note: the pose of the %s hand is its neutral pose now\n",
                    side_name[side]);
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

/* ---- mapping ---- */

static mrt_result isolate_mapping(perform_mapping *self, const mrt_plugin_type **type, error *err)
{
    mrt_result result =
        isolate_create_mapping(&self->isolate, *type, self->library, &self->settings, err);
    if (result >= 0)
        *type = isolate_type(self->isolate);
    return result;
}

mrt_result perform_mapping_open(perform_mapping *out, const plugin_spec *spec,
                                const perform_mapping_settings *with, error *err)
{
    const mrt_plugin_type *type;
    *out = (perform_mapping){.settings = {.clock = with->clock, .writes_reports = true}};
    mrt_result result = MRT_OK;
    if (spec->plugin)
        result = plugin_list_choose(with->plugins, spec->plugin, MRT_MAPPING, &type, err);
    else
        type = &null_mapping_type;
    if (result < 0)
        return result;
    out->library = plugin_list_path_of(with->plugins, type);
    if (spec->plugin && isolate_is_wanted(with->isolation, out->library))
        result = isolate_mapping(out, &type, err);
    if (result >= 0)
        result = instance_create(&out->instance, type, with->clock, with->log, err);
    if (result >= 0 && spec->plugin)
        result = instance_set_list(&out->instance, spec->params, err);
    return result;
}

mrt_result perform_mapping_watch(perform_mapping *self, performer *of, log_queue *log, error *err)
{
    const reload_settings settings = {.library = self->library,
                                      .mapping = &self->instance,
                                      .mapped = composer_mapped(of->composer),
                                      .log = log,
                                      .clock = self->settings.clock,
                                      .isolate = self->isolate ? &self->settings : NULL};
    return reload_start(&self->reload, &settings, err);
}

void perform_mapping_step(perform_mapping *self, performer *of, recorder *into)
{
    if (!self->reload || !reload_step(self->reload, of->voice[0].layer))
        return;
    self->current = of->voice[0].layer->mapping;
    if (into)
        recorder_change_mapping(into, reload_identity(self->reload));
}

/* Sums the counts of the first mapping and of the current one. Those between are closed. */
static isolate_counts counts_of(const perform_mapping *self)
{
    isolate_counts sum = {0};
    const instance *const both[2] = {&self->instance, self->current};
    for (int i = 0; i < 2; ++i) {
        if (!self->isolate || !both[i] || !both[i]->self || (i > 0 && both[i] == both[0]))
            continue;
        isolate_counts one = isolate_counted(both[i]->self);
        sum.failed += one.failed;
        sum.restarted += one.restarted;
        sum.late += one.late;
        sum.is_away |= one.is_away;
    }
    return sum;
}

mrt_result perform_mapping_check(const perform_mapping *self, error *err)
{
    if (self->settings.clock == CLOCK_REAL)
        return MRT_OK;
    mrt_result result = isolate_check(&self->instance, err);
    return result >= 0 && self->current ? isolate_check(self->current, err) : result;
}

void perform_mapping_report(const perform_mapping *self, facts *told)
{
    isolate_counts counts = counts_of(self);
    if (self->isolate)
        facts_text(told, "isolated", "isolated", "in a separate process");
    if (counts.failed) {
        facts_warning(told, "mapping_failed", "mapping failed", counts.failed, 0, "times");
        facts_number(told, "mapping_restarted", "  restarted", counts.restarted, 0, "times");
    }
    if (counts.late)
        facts_warning(told, "mapping_late", "mapping late", counts.late, 0,
                      "samples in which the face was held");
    if (self->reload) {
        reload_counts reloads = reload_get_counts(self->reload);
        facts_number(told, "reloads", "reloads", reloads.taken, 0, "");
        facts_number(told, "reloads_refused", "  refused", reloads.refused, 0, "");
    }
}

void perform_mapping_close(perform_mapping *self)
{
    reload_stop(self->reload);
    instance_destroy(&self->instance);
    isolate_destroy(self->isolate);
    *self = (perform_mapping){.library = NULL};
}

/* ---- outputs ---- */

/* Minimum interval between drawn faces, so that drawing takes at most about a quarter of the time;
 * the same as on the live stage. */
static const int64_t least_apart_ns = 4 * NS_PER_MS;

mrt_result perform_outputs_open(perform_outputs *out, const char *const *text, uint32_t count,
                                const perform_mapping_settings *with, composer *of,
                                const face_file *file, error *err)
{
    const outputs_settings settings = {with->plugins, with->log, with->isolation};
    *out = (perform_outputs){.board = NULL};
    if (count == 0)
        return MRT_OK;
    mrt_result result = face_board_create(&out->board, of, file, err);
    if (result >= 0)
        result = outputs_create(&out->outputs, &settings, err);
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        char *spec = NULL;
        result = plugin_list_choose_spec(with->plugins, text[i], MRT_FACE_OUTPUT, &spec, err);
        if (result >= 0)
            result = outputs_add(out->outputs, spec, err);
        free(spec);
    }
    if (result < 0)
        return result;
    face_board_prepare(out->board);
    outputs_show(out->outputs, out->board);
    return MRT_OK;
}

void perform_outputs_step(perform_outputs *self, performer *p, int64_t sample_ns)
{
    int64_t apart_ns = 3 * self->draw_ns > least_apart_ns ? 3 * self->draw_ns : least_apart_ns;
    int64_t now_ns = clock_now_ns();
    self->step_ns = sample_ns;
    self->is_behind = true;
    if (!outputs_are_wanted(self->outputs) || now_ns - self->drawn_ns < apart_ns)
        return;
    composer_draw(p->composer);
    self->drawn_ns = now_ns;
    self->draw_ns = clock_now_ns() - now_ns;
    perform_outputs_show(self, p, sample_ns, -1);
}

void perform_outputs_frame(perform_outputs *self, performer *p)
{
    self->is_behind |= outputs_pop_request(self->outputs);
    if (self->is_behind && outputs_are_wanted(self->outputs))
        perform_outputs_show(self, p, self->step_ns, -1);
}

void perform_outputs_show(perform_outputs *self, performer *p, int64_t time_ns, int64_t take_ns)
{
    outputs_publish(self->outputs, self->board, p->composer, time_ns, take_ns);
    self->is_behind = false;
}

void perform_outputs_report(outputs *of, facts *told)
{
    static const char *const states[] = {"was not open yet", "sent", "nobody listened", "failed"};
    uint32_t count = of ? outputs_count(of) : 0;
    for (uint32_t i = 0; i < count; ++i) {
        output_status s;
        char line[512];
        outputs_status(of, i, &s);
        (void)snprintf(line, sizeof line,
                       "%.160s: %s%s%.200s, %ju faces, sample to sent %.2f ms (p99 %.2f ms)",
                       s.text, states[s.state], s.trouble[0] ? ": " : "", s.trouble,
                       (uintmax_t)s.sent, s.p50_ms, s.p99_ms);
        const facts_cell cells[] = {
            {"output", s.text, 0, 0},          {"state", states[s.state], 0, 0},
            {"trouble", s.trouble, 0, 0},      {"isolated", NULL, s.is_isolated, -1},
            {"sent", NULL, (double)s.sent, 0}, {"replaced", NULL, (double)s.replaced, 0},
            {"p50_ms", NULL, s.p50_ms, 3},     {"p99_ms", NULL, s.p99_ms, 3}};
        if (facts_is_brief(told))
            facts_headline(told, "output", line);
        facts_row(told, "outputs", "output", line, cells, sizeof cells / sizeof cells[0]);
    }
    if (count > 0)
        facts_number(told, "residual_mm", "expressed in weights", outputs_residual_mm(of), 2,
                     "mm error of the last face");
}

void perform_outputs_close(perform_outputs *self)
{
    outputs_destroy(self->outputs);
    face_board_release(self->board);
    *self = (perform_outputs){.board = NULL};
}

/* ---- the patch ---- */

void perform_patch_report(const layer *of)
{
    const patch_plan *plan = of->bay.plan;
    news_print_notes(plan ? patch_plan_note(plan) : NULL);
}

/* ---- the show that is recorded into ---- */

void perform_record_watch_writer(writer *of, bool *is_told)
{
    char text[512];
    writer_status status = writer_status_of(of);
    bool is_well = status.state == WRITER_OK && !status.is_missing;
    if (is_well == !*is_told)
        return;
    *is_told = !is_well;
    writer_message(of, text, sizeof text);
    fprintf(stderr, "%s: %s\n", is_well ? "note" : "warning",
            is_well ? "the recording continues; the samples in memory are written" : text);
}

mrt_result perform_record_rescue(show *of, mrt_result so_far, error *err)
{
    error sentence = {""};
    const show_rescue_state state = of ? show_rescue_missing(of, &sentence) : SHOW_RESCUE_NONE;
    if (state == SHOW_RESCUE_NONE)
        return so_far;
    if (state != SHOW_RESCUE_BESIDE && so_far >= 0)
        return error_set(err, MRT_ERR_IO, "%s", sentence.text);
    fprintf(stderr, "%s: %s\n", state == SHOW_RESCUE_BESIDE ? "warning" : "error", sentence.text);
    return so_far;
}
