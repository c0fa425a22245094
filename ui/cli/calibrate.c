/* `marotte calibrate`: guides a person at a terminal, or a script, through the calibration of a
 * glove or a bare hand (hand/guide.h). */
#include "cli/command.h"
#include "cli/facts.h"
#include "cli/terminal.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/text.h"
#include "hand/calibration_folder.h"
#include "hand/guide.h"
#include "hand/sensor.h"
#include "hand/virtualhand.h"
#include "stage/input/glove_channels.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct screen {
    FILE *stream;
    bool is_terminal, has_keys;
    int line_count; /* lines of the block that is on the terminal now; 0: none */
    uint32_t sensors;
    float raw_min, raw_max; /* range of the bars */
    float shown;            /* factor from raw value to displayed value: rad are shown in degrees */
    char news[512];
    bool is_away;
} screen;

typedef struct calibrate_options {
    plugin_spec input; /* zeroed: not given */
    bool is_json;
    const char *out, *name, *show, *virtualhand;
    uint32_t side; /* MRT_NO_HAND: not given */
    double hand_length_mm, timeout_s;
} calibrate_options;

/* ---- the screen ---- */

enum { BAR_WIDTH = 18, COLUMNS = 2, WIDTH = 78 };

static void screen_begin(screen *self, FILE *stream, bool has_keys, const glove_channels *glove)
{
    const bool is_bare = glove->input[0] != '\0';
    *self = (screen){.stream = stream,
                     .is_terminal = isatty(fileno(stream)) == 1,
                     .has_keys = has_keys,
                     .sensors = glove->sensors,
                     .raw_min = is_bare ? glove->low : 0.0f,
                     .raw_max = is_bare ? glove->high : 255.0f,
                     .shown = is_bare ? 57.29578f : 1.0f};
}

/* Prints the step that begins now. */
static void screen_step(screen *self, const guide *of)
{
    guide_step step = guide_current(of);
    if (self->is_terminal || step == GUIDE_STEPS)
        return;
    int count, number = guide_number(of, &count);
    fprintf(self->stream, "step %d of %d, %s: %s\n", number, count, guide_step_name[step],
            guide_instruction(of));
    fflush(self->stream);
}

/* "taken: flat hand", "not taken: ..." */
static void screen_print(screen *self, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(self->news, sizeof self->news, format, arguments);
    va_end(arguments);
    if (self->is_terminal)
        return;
    fprintf(self->stream, "  %s\n", self->news);
    fflush(self->stream);
}

/* ---- the block of bars and instructions ---- */

static void end_line(screen *self)
{
    fputs("\033[K\n", self->stream);
    self->line_count += 1;
}

/* Prints at most two lines, so that the height of the block stays the same. */
static void draw_words(screen *self, const char *words)
{
    size_t length = strlen(words), cut = length;
    if (length > WIDTH)
        for (cut = WIDTH; cut > 0 && words[cut] != ' ';)
            cut -= 1;
    if (cut == 0)
        cut = WIDTH;
    fprintf(self->stream, "%.*s", (int)cut, words);
    end_line(self);
    if (cut < length)
        fprintf(self->stream, "%.*s", WIDTH, words + cut + (words[cut] == ' '));
    end_line(self);
}

static int cell_of(const screen *self, float raw)
{
    float share = (raw - self->raw_min) / (self->raw_max - self->raw_min);
    float within = share > 0.0f ? share < 1.0f ? share : 1.0f : 0.0f;
    return (int)(within * (float)(BAR_WIDTH - 1) + 0.5f);
}

/* Prints "index.mpj   [...---#--......]  134": the range seen so far, and the current value. */
static void draw_bar(screen *self, int sensor, float raw, float low, float high)
{
    char bar[BAR_WIDTH + 1];
    int first = cell_of(self, low), last = cell_of(self, high), now = cell_of(self, raw);
    for (int i = 0; i < BAR_WIDTH; ++i)
        bar[i] = i == now ? '#' : i >= first && i <= last ? '-' : '.';
    bar[BAR_WIDTH] = '\0';
    fprintf(self->stream, "%-11s [%s] %4.0f", sensor_table[sensor].name, bar,
            (double)(raw * self->shown));
}

static void draw_bars(screen *self, const guide *of, const float *raw)
{
    float low[MRT_ANGLES], high[MRT_ANGLES];
    guide_range(of, low, high);
    int column = 0;
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (!(self->sensors >> sensor & 1u))
            continue;
        draw_bar(self, sensor, raw[sensor], low[sensor], high[sensor]);
        column = (column + 1) % COLUMNS;
        if (column == 0)
            end_line(self);
        else
            fputs("  ", self->stream);
    }
    if (column != 0)
        end_line(self);
}

/* Redraws the block. Does nothing where there is no terminal. */
static void screen_draw(screen *self, const guide *of, const float *raw)
{
    if (!self->is_terminal)
        return;
    if (self->line_count > 0)
        fprintf(self->stream, "\033[%dA\r", self->line_count);
    self->line_count = 0;
    guide_step step = guide_current(of);
    const char *words = guide_instruction(of);
    const char *waits =
        self->is_away ? "the hand is away: waiting for it" : guide_wait_text[guide_waiting(of)];
    int count, number = guide_number(of, &count);
    fprintf(self->stream, "step %d of %d: %s (%s)", number, count,
            step < GUIDE_STEPS ? guide_step_name[step] : "done", waits);
    end_line(self);
    draw_words(self, words);
    draw_bars(self, of, raw);
    draw_words(self, self->news);
    if (self->has_keys) {
        fputs(step < GUIDE_STEPS ? "Enter takes the pose now, r repeats the last, s skips, q quits"
                                 : "Enter saves, r repeats the named pose or the last one, q quits",
              self->stream);
        end_line(self);
    }
    fflush(self->stream);
}

/* ---- the guided part ---- */

static const int64_t IDLE_NS = 4 * NS_PER_MS, DRAW_NS = 66 * NS_PER_MS;

typedef struct guiding {
    const calibrate_options *options;
    double timeout_s; /* limit for each pose, and for silence of the input; 0: no limit */
    log_queue *log;
    plugin_list plugins;
    instance_clock clock;
    input *input;
    glove_channels glove;
    guide *guide;
    screen screen;
    double still_s;
    bool is_saved, is_quit;
    float raw[MRT_ANGLES];
    int64_t heard_ns, drawn_ns; /* host clock: time of the last sample, time of the last drawing */
} guiding;

/* ---- the glove ---- */

static mrt_result open_glove(guiding *self, error *err)
{
    const plugin_spec *spec = &self->options->input;
    const mrt_plugin_type *type;
    mrt_result result = plugin_list_load(&self->plugins, err);
    if (result >= 0)
        result = plugin_list_choose(&self->plugins, spec->plugin, MRT_INPUT, &type, err);
    if (result < 0)
        return result;
    const mrt_input *functions = plugin_interface(type, MRT_INPUT);
    self->clock = functions->flags & MRT_INPUT_RECORDED ? CLOCK_VIRTUAL : CLOCK_REAL;
    result = input_create_stoppable(&self->input, type, spec->address, spec->params, self->clock,
                                    self->log, cancel_flag(), err);
    if (result < 0)
        return result;
    uint32_t count;
    const mrt_channel *channel = input_channels(self->input, &count);
    return glove_channels_find(&self->glove, channel, count, self->options->side,
                               input_name(self->input), err);
}

static void print_log(guiding *self)
{
    log_record record;
    while (self->log && log_pop(self->log, &record)) {
        if (!self->screen.is_terminal)
            news_print_record(&record);
        else if (record.level > MRT_LOG_DEBUG && record.level <= MRT_LOG_ERROR)
            screen_print(&self->screen, "%s: %s", record.source, record.text);
    }
}

/* ---- the guide ---- */

static mrt_result judge(const guiding *self, guide_judgement *out, error *err)
{
    calibration_file *made = calloc(1, sizeof *made);
    if (!made)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = guide_result(self->guide, made, err);
    if (result >= 0)
        guide_judge(out, self->guide, made);
    free(made);
    return result;
}

/* Prints the judgement of all poses. The person uses it to decide whether to save. */
static mrt_result print_judgement(guiding *self, error *err)
{
    guide_judgement judgement;
    char words[96], first[200] = "";
    mrt_result result = judge(self, &judgement, err);
    if (result < 0)
        return result;
    guide_judgement_text(&judgement, words, sizeof words);
    if (judgement.flaw_count > 0)
        guide_flaw_text(&judgement.flaw[0], first, sizeof first);
    screen_print(&self->screen, "%s%s%s", words, first[0] ? " " : "", first);
    return MRT_OK;
}

/* Repeats the last pose or, at the end, the pose that the judgement names. */
static mrt_result repeat(guiding *self, error *err)
{
    guide_judgement judgement = {.flaw_count = 0};
    mrt_result result = MRT_OK;
    if (guide_current(self->guide) == GUIDE_STEPS)
        result = judge(self, &judgement, err);
    if (result >= 0 && judgement.flaw_count > 0)
        guide_again(self->guide, judgement.flaw[0].step);
    else if (result >= 0)
        guide_repeat(self->guide);
    if (result < 0)
        return result;
    screen_print(&self->screen, "again: %s", guide_step_name[guide_current(self->guide)]);
    screen_step(&self->screen, self->guide);
    return MRT_OK;
}

static mrt_result follow_news(guiding *self, guide_news news, guide_step step, error *err)
{
    const char *reason = guide_reason(self->guide);
    switch (news) {
    case GUIDE_NOTHING:
        return MRT_OK;
    case GUIDE_TAKEN:
        screen_print(&self->screen, "taken: %s%s%s", guide_step_name[step], reason[0] ? "; " : "",
                     reason);
        break;
    case GUIDE_SKIPPED:
        screen_print(&self->screen, "skipped: %s", guide_step_name[step]);
        break;
    case GUIDE_REFUSED:
        screen_print(&self->screen, "not taken: %s", reason);
        return MRT_OK;
    case GUIDE_TIMED_OUT:
        return error_set(err, MRT_ERR_IO, "%s", reason);
    }
    screen_step(&self->screen, self->guide);
    return guide_current(self->guide) == GUIDE_STEPS ? print_judgement(self, err) : MRT_OK;
}

static mrt_result follow_keys(guiding *self, error *err)
{
    mrt_result result = MRT_OK;
    for (char key = keys_next(); key && result >= 0; key = keys_next()) {
        guide_step step = guide_current(self->guide);
        if (key == '\n' && step == GUIDE_STEPS) {
            self->is_saved = true;
        } else if (key == '\n' && self->screen.is_away) {
            screen_print(&self->screen, "not taken: the hand is away");
        } else if (key == '\n') {
            result = follow_news(self, guide_next(self->guide), step, err);
        } else if (key == 's') {
            result = follow_news(self, guide_skip(self->guide), step, err);
        } else if (key == 'r') {
            result = repeat(self, err);
        } else if (key == 'q') {
            self->is_quit = true;
        }
    }
    return result;
}

static mrt_result follow_sample(guiding *self, const mrt_sample *sample, error *err)
{
    if (input_version(self->input) != 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: the sensors of the device changed. Start the calibration again",
                         input_name(self->input));
    glove_channels_read(&self->glove, sample, self->raw);
    guide_step step = guide_current(self->guide);
    return follow_news(self, guide_sample(self->guide, self->raw, sample->time_ns), step, err);
}

static void follow_incidents(guiding *self)
{
    input_incident incident;
    while (input_pop_incident(self->input, &incident)) {
        self->screen.is_away = incident.kind == INPUT_WAS_LOST;
        if (incident.kind == INPUT_WAS_LOST)
            screen_print(&self->screen, "the hand is away: waiting for it%s%s",
                         incident.text[0] ? ": " : "", incident.text);
        else
            screen_print(&self->screen, "the hand is back");
    }
}

/* Handles a time without samples. Scripts give up after a timeout; a person may need time to plug
 * the glove in again. */
static mrt_result follow_silence(guiding *self, int64_t now_ns, error *err)
{
    double timeout_s = self->timeout_s;
    double silent_s = (double)(now_ns - self->heard_ns) / 1e9;
    if (timeout_s > 0 && silent_s > timeout_s)
        return error_set(err, MRT_ERR_IO, "%s: no sample arrived for %.0f s",
                         input_name(self->input), timeout_s);
    clock_sleep_until_ns(now_ns + IDLE_NS);
    return MRT_OK;
}

static bool is_over(const guiding *self)
{
    input_state state = input_state_of(self->input);
    return state == INPUT_ENDED || state == INPUT_FAILED;
}

static mrt_result report_end(const guiding *self, error *err)
{
    guide_step step = guide_current(self->guide);
    const char *name = input_name(self->input);
    int count, number = guide_number(self->guide, &count);
    if (input_state_of(self->input) == INPUT_FAILED)
        return error_set(err, MRT_ERR_IO, "%s: the input failed in step %d of %d, %s", name, number,
                         count, guide_step_name[step]);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: the input ended in step %d of %d, %s: the hand did not reach the pose, "
                     "or did not hold it still for %.1f s",
                     name, number, count, guide_step_name[step], self->still_s);
}

/* Done: a script is done after the last pose. A person may want to repeat, and ends with Enter. */
static bool is_done(const guiding *self)
{
    bool waits = self->screen.has_keys && self->clock == CLOCK_REAL;
    return guide_current(self->guide) == GUIDE_STEPS && (self->is_saved || !waits);
}

static mrt_result follow_glove(guiding *self, error *err)
{
    mrt_sample sample;
    int64_t now_ns = clock_now_ns();
    mrt_result result = MRT_OK;
    bool over = is_over(self); /* read first: samples from before the end are still in the ring */
    bool has_sample = input_peek(self->input, &sample);
    follow_incidents(self);
    if (has_sample) {
        input_pop(self->input);
        self->heard_ns = now_ns;
        result = follow_sample(self, &sample, err);
    } else if (over || self->clock == CLOCK_VIRTUAL) {
        return report_end(self, err);
    } else {
        result = follow_silence(self, now_ns, err);
    }
    if (now_ns - self->drawn_ns >= DRAW_NS) {
        self->drawn_ns = now_ns;
        print_log(self);
        screen_draw(&self->screen, self->guide, self->raw);
    }
    return result;
}

static mrt_result guide_person(guiding *self, error *err)
{
    self->heard_ns = clock_now_ns();
    screen_step(&self->screen, self->guide);
    mrt_result result = input_start(self->input, err);
    while (result >= 0 && !is_done(self)) {
        result = follow_keys(self, err);
        if (result >= 0 && (self->is_quit || cancel_is_requested()))
            result = error_set(err, MRT_ERR_ARGUMENT, "stopped; nothing was written");
        if (result >= 0 && !is_done(self))
            result = follow_glove(self, err);
    }
    screen_draw(&self->screen, self->guide, self->raw);
    self->screen.line_count = 0; /* the block stays on the terminal; later output goes below it */
    return result;
}

static mrt_result prepare(guiding *self, error *err)
{
    cancel_on_signals(CANCEL_WAITS, NULL);
    self->log = log_queue_create();
    if (!self->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = open_glove(self, err);
    if (result < 0)
        return result;
    const glove_channels *glove = &self->glove;
    guide_settings settings = glove->input[0]
                                  ? guide_settings_bare(glove->side, glove->sensors, glove->input)
                                  : guide_settings_default(glove->side, glove->sensors);
    self->still_s = settings.still_s;
    settings.timeout_s = self->timeout_s;
    self->guide = guide_create(&settings);
    if (!self->guide)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the guide");
    screen_begin(&self->screen, self->options->is_json ? stderr : stdout, keys_begin(), glove);
    return MRT_OK;
}

/* Guides through every pose. Does not set name, date and hand length of `out`. */
static mrt_result run_guide(guiding *self, calibration_file *out, guide_judgement *out_judgement,
                            error *err)
{
    mrt_result result = guide_person(self, err);
    if (result >= 0)
        result = guide_result(self->guide, out, err);
    if (result >= 0)
        guide_judge(out_judgement, self->guide, out);
    return result;
}

static void finish(guiding *self)
{
    keys_end();
    guide_destroy(self->guide);
    input_destroy(self->input);
    plugin_list_destroy(&self->plugins);
    print_log(self);
    log_queue_destroy(self->log);
}

/* ---- the command ---- */

static const double DEGREES_PER_RADIAN = 57.29577951308232;
static const double SCRIPT_TIMEOUT_S = 60.0;
static const char *const side_name[2] = {"left", "right"};

/* ---- options ---- */

static int read_side(void *to, const command *self, const char *name, const char *text)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        if (strcmp(text, side_name[side]) != 0)
            continue;
        *(uint32_t *)to = side;
        return COMMAND_DONE;
    }
    return command_usage(self, "--%s \"%s\" is not left or right", name, text);
}

static int read_name(void *to, const command *self, const char *name, const char *text)
{
    *(const char **)to = text;
    return strlen(text) < CALIBRATION_NAME
               ? COMMAND_DONE
               : command_usage(self, "--%s is longer than %d bytes", name, CALIBRATION_NAME - 1);
}

#define AT(member) .offset = offsetof(calibrate_options, member)
static const command_option option_table[] = {
    {"input", COMMAND_READ, AT(input), .read = command_read_spec},
    {"out", COMMAND_TEXT, AT(out)},
    {"name", COMMAND_READ, AT(name), .read = read_name},
    {"hand", COMMAND_READ, AT(side), .read = read_side},
    {"show", COMMAND_TEXT, AT(show)},
    {"from-virtualhand", COMMAND_TEXT, AT(virtualhand)},
    {"hand-length", COMMAND_NUMBER, AT(hand_length_mm), .least = HAND_LENGTH_MIN_MM,
     .most = HAND_LENGTH_MAX_MM},
    {"timeout", COMMAND_NUMBER, AT(timeout_s), .least = 1, .most = 86400},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

static int check_options(const calibrate_options *options)
{
    int jobs =
        (options->input.plugin != NULL) + (options->show != NULL) + (options->virtualhand != NULL);
    if (jobs != 1)
        return command_usage(&command_calibrate,
                             "give one of --input, --from-virtualhand and --show");
    if (!options->show && !options->out && !options->name)
        return command_usage(&command_calibrate,
                             "--out FILE is missing, or --name NAME for the user's folder");
    return COMMAND_DONE;
}

static int read_options(calibrate_options *out, int argc, char **argv)
{
    *out = (calibrate_options){.side = MRT_NO_HAND};
    int code = command_options(out, &command_calibrate, option_table, argc, argv);
    return code == COMMAND_DONE ? check_options(out) : code;
}

/* ---- contents of a calibration ---- */

static int sensors_of(const calibration_file *file, calibration_source source)
{
    int count = 0;
    for (int i = 0; i < MRT_ANGLES; ++i)
        count += file->sensor[i].table.count > 0 && file->sensor[i].source == source;
    return count;
}

/* Returns -1 if no sensor has a residual. */
static int worst_sensor(const calibration_file *file)
{
    int worst = -1;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &file->sensor[i];
        if (sensor->table.count == 0 || !sensor->has_residual)
            continue;
        if (worst < 0 || sensor->residual_rad > file->sensor[worst].residual_rad)
            worst = i;
    }
    return worst;
}

static void append(char *text, size_t capacity, const char *more)
{
    size_t used = strlen(text);
    if (used + strlen(more) < capacity)
        memcpy(text + used, more, strlen(more) + 1);
}

/* Prints "index.mpj  measured  58..150 counts -4..92 deg, residual 1.2 deg, moves middle.mpj
 * 0.21". */
static void report_sensor(const calibration_file *file, int index, facts *told)
{
    const calibration_sensor *sensor = &file->sensor[index];
    char text[512], part[96];
    (void)snprintf(text, sizeof text, "%-11s %-8s", sensor_table[index].name,
                   calibration_source_name[sensor->source]);
    if (sensor->has_range) {
        const bool is_bare = file->input[0] != '\0';
        const double shown = is_bare ? DEGREES_PER_RADIAN : 1.0;
        (void)snprintf(part, sizeof part, " %3.0f..%3.0f %s %4.0f..%3.0f deg",
                       shown * (double)sensor->raw_range[0], shown * (double)sensor->raw_range[1],
                       is_bare ? "deg seen," : "counts",
                       (double)sensor->rad_range[0] * DEGREES_PER_RADIAN,
                       (double)sensor->rad_range[1] * DEGREES_PER_RADIAN);
        append(text, sizeof text, part);
    }
    (void)snprintf(part, sizeof part, ", neutral %.0f deg",
                   (double)sensor->neutral_rad * DEGREES_PER_RADIAN);
    append(text, sizeof text, part);
    if (sensor->has_residual) {
        (void)snprintf(part, sizeof part, ", residual %.1f deg",
                       (double)sensor->residual_rad * DEGREES_PER_RADIAN);
        append(text, sizeof text, part);
    }
    const char *joint = ", moves ";
    for (int i = 0; i < MRT_ANGLES; ++i) {
        if (fabsf(sensor->cross_talk[i]) < 0.05f)
            continue;
        (void)snprintf(part, sizeof part, "%s%s %.2f", joint, sensor_table[i].name,
                       (double)sensor->cross_talk[i]);
        append(text, sizeof text, part);
        joint = " ";
    }
    facts_list(told, "sensors", "sensor", text);
}

static void report_flaws(const guide_judgement *judgement, facts *told)
{
    char text[200];
    facts_number(told, "flaw_count", "flaws", judgement->flaw_count, 0, "");
    for (uint32_t i = 0; i < judgement->flaw_count; ++i) {
        guide_flaw_text(&judgement->flaw[i], text, sizeof text);
        facts_list(told, "flaws", "  flaw", text);
    }
}

static void report(const calibration_file *file, const guide_judgement *judgement, const char *path,
                   facts *told)
{
    facts_text(told, "file", "file", path);
    facts_text(told, "name", "name", file->name);
    facts_text(told, "date", "date", file->date);
    facts_text(told, "hand", "hand", side_name[file->side]);
    if (file->input[0])
        facts_text(told, "input", "seen by", file->input);
    if (file->hand_length_mm > 0)
        facts_number(told, "hand_length_mm", "hand length", file->hand_length_mm, 1, "mm");
    facts_number(told, "sensor_count", "sensors", calibration_file_sensor_count(file), 0, "");
    facts_number(told, "sensors_measured", "  measured", sensors_of(file, CALIBRATION_MEASURED), 0,
                 "");
    facts_number(told, "sensors_imported", "  imported", sensors_of(file, CALIBRATION_IMPORTED), 0,
                 "");
    facts_number(told, "sensors_zeroed", "  zero measured", sensors_of(file, CALIBRATION_ZEROED), 0,
                 file->input[0] ? "else as seen" : "with the shipped gain");
    facts_number(told, "sensors_shipped", "  shipped", sensors_of(file, CALIBRATION_SHIPPED), 0,
                 "");
    int worst = worst_sensor(file);
    if (worst >= 0)
        facts_number(told, "worst_residual_deg", "worst residual",
                     (double)file->sensor[worst].residual_rad * DEGREES_PER_RADIAN, 2, "deg");
    report_flaws(judgement, told);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (file->sensor[i].table.count > 0)
            report_sensor(file, i, told);
}

/* ---- making a calibration ---- */

static mrt_result import(calibration_file *out, guide_judgement *out_judgement,
                         const calibrate_options *options, error *err)
{
    mrt_result result = virtualhand_read(out, options->virtualhand, options->side, err);
    if (result >= 0)
        guide_judge(out_judgement, NULL, out);
    return result;
}

/* old: the calibration that `path` held before; made: scratch. */
static mrt_result make_and_write(const calibrate_options *options, guiding *guided,
                                 const char *path, calibration_file *old, calibration_file *made,
                                 facts *told, error *err)
{
    guide_judgement judgement;
    mrt_result result = calibration_keep_old(old, path, err);
    if (result < 0)
        return result;
    result = options->virtualhand ? import(made, &judgement, options, err)
                                  : run_guide(guided, made, &judgement, err);
    if (result >= 0) {
        result = calibration_keep_fits(made, old, path, err);
    }
    if (result >= 0) {
        calibration_keep_sign(made, old, options->name, options->hand_length_mm);
        news_print_notes(old->note);
        news_print_notes(made->note);
        result = calibration_keep_write(made, old, path, err);
    }
    if (result >= 0) {
        report(made, &judgement, path, told);
        facts_file(told, path, "");
    }
    calibration_file_finish(old);
    return result;
}

static mrt_result calibrate(const calibrate_options *options, facts *told, error *err)
{
    char *placed = NULL;
    bool is_script = isatty(STDIN_FILENO) != 1;
    guiding guided = {.options = options, .timeout_s = options->timeout_s};
    if (!(guided.timeout_s > 0) && is_script)
        guided.timeout_s = SCRIPT_TIMEOUT_S;
    mrt_result result = MRT_OK;
    if (!options->virtualhand)
        result = prepare(&guided, err);
    if (result >= 0 && !options->out)
        result = calibration_folder_place(&placed, options->name, guided.glove.input, err);
    calibration_file *scratch = calloc(2, sizeof *scratch);
    if (result >= 0 && !scratch)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    if (result >= 0)
        result = make_and_write(options, &guided, options->out ? options->out : placed, &scratch[0],
                                &scratch[1], told, err);
    finish(&guided);
    free(scratch);
    free(placed);
    return result;
}

static mrt_result show(const char *path, facts *told, error *err)
{
    calibration_file *file = malloc(sizeof *file);
    if (!file)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = calibration_file_read(file, path, err);
    if (result >= 0) {
        guide_judgement judgement;
        guide_judge(&judgement, NULL, file);
        news_print_notes(file->note);
        report(file, &judgement, path, told);
        calibration_file_finish(file);
    }
    free(file);
    return result;
}

static int run(int argc, char **argv)
{
    calibrate_options options;
    int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE) {
        plugin_spec_finish(&options.input);
        return code;
    }
    error err = {""};
    facts *told = facts_create(options.is_json ? FACTS_JSON : FACTS_LINES);
    mrt_result result = told ? MRT_OK : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = options.show ? show(options.show, told, &err) : calibrate(&options, told, &err);
    plugin_spec_finish(&options.input);
    return command_end(&command_calibrate, told, result, &err);
}

const command command_calibrate = {
    .name = "calibrate",
    .summary = "calibrate a glove or a bare hand; show or import a calibration",
    .help =
        "marotte calibrate --input PLUGIN[:ADDRESS][,key=value] [--out FILE.json] [--name NAME]\n"
        "                  [--hand left|right] [--hand-length MM] [--timeout S] [--json]\n"
        "marotte calibrate --from-virtualhand FILE.cal [--out FILE.json] [--name NAME] ...\n"
        "marotte calibrate --show FILE.json [--json]\n"
        "\n"
        "A glove needs ten poses, about 90 seconds. A hand from a camera, a headset or a VMC\n"
        "sender needs three (flat, fist, spread), about 10 seconds. Each pose is taken when the\n"
        "hand has moved into it and holds still. The file is written after the last pose. Until\n"
        "then an older file is kept.\n"
        "\n"
        "  --input SPEC       the glove or hand, as for marotte perform: cyberglove, camera,\n"
        "                     openxr, osc:0.0.0.0:39539\n"
        "  --out FILE         the file to write (NAME.json in the folder below; for a bare hand\n"
        "                     \"NAME, camera.json\" and so on)\n"
        "  --name NAME        the name of the performer\n"
        "  --hand SIDE        left or right, if the device does not report it\n"
        "  --hand-length MM   wrist to middle fingertip, for mappings\n"
        "  --timeout S        give up if no pose is taken for S seconds (60; at a terminal never)\n"
        "  --from-virtualhand FILE   import a calibration of VirtualHand 1.x (text)\n"
        "  --show FILE        print a calibration\n"
        "  --json             print the facts as JSON\n"
        "\n"
        "Keys: Enter takes the pose now, r repeats the last pose, s skips, q quits. At the end\n"
        "each sensor is judged. For a bad sensor the pose to repeat is printed; r repeats it.\n"
        "marotte perform uses the newest calibration of each hand and kind of input in\n"
        "$XDG_CONFIG_HOME/marotte/calibrations (~/.config/marotte/calibrations); --calibration\n"
        "chooses another.\n",
    .examples = "calibrate --input cyberglove --name anna\n"
                "calibrate --input camera --name anna --hand right\n"
                "calibrate --input osc:0.0.0.0:39539 --name ben --hand left --out out/ben.json\n",
    .run = run,
    .options = option_table,
};
