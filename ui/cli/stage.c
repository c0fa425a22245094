/* marotte: the stage, with or without a window. */
#include "cli/command.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "base/memory.h"
#include "base/suggest.h"
#include "cli/facts.h"
#include "cli/perform_session.h"
#include "window/open_any.h"
#include "window/streams.h"
#include "window/tour.h"
#include "window/workspace.h"
#include "stream/video.h"
#include "window/gui/window.h"
#include "window/script.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

enum { INPUTS_MAX = 8, WIDTH = 1280, HEIGHT = 720, WARM_FRAMES = 120 };

typedef struct stage_options {
    app_options app;
    const char *input[INPUTS_MAX];
    uint32_t width, height; /* points; 0: size of the last run */
    double scale, seconds;
    app_picture streamed; /* which options of it were given */
    bool has_picture;
    const char *script, *picture;
    const char *file; /* file that is neither show nor face; NULL: none */
    bool has_life;    /* --life was given */
    bool is_hidden, is_json;
} stage_options;

typedef struct stage {
    const stage_options *options;
    app *app;
    window *window;
    workspace *workspace;
    wake *changed; /* signal of the window */
    script *script;
    app_face_ahead *ahead;
    uint64_t sample_count;
    double warm_mb, end_mb;
    int64_t began_ns;
    char settings_note[1024]; /* note of the first reading of the settings */
} stage;

/* ---- options ---- */

static int read_size(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    char *end, *second = NULL;
    const unsigned long width = strtoul(text, &end, 10);
    const bool has_two = end != text && *end == 'x';
    const unsigned long height = has_two ? strtoul(end + 1, &second, 10) : 0;
    if (!has_two || second == end + 1 || *second || width < 320 || width > 8192 || height < 240 ||
        height > 8192)
        return command_usage(self, "--%s %s: expected WIDTHxHEIGHT in points, such as 1280x720",
                             name, text);
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
    return COMMAND_DONE;
}

static int add_input(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    (void)name;
    if (out->app.input_count == INPUTS_MAX)
        return command_usage(self, "--input is given more than %d times", INPUTS_MAX);
    out->input[out->app.input_count++] = text;
    out->app.inputs = out->input;
    return COMMAND_DONE;
}

/* ---- the picture for other programs: options that are not given have their defaults, not the
 * values of the last run ---- */

static int read_ground(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    float ground[4];
    out->has_picture = true;
    if (strlen(text) >= sizeof out->streamed.background || !streams_ground(text, ground))
        return command_usage(self,
                             "--%s %s: expected transparent, or a colour such as #00b140 (a "
                             "picture: the Scene panel)",
                             name, text);
    (void)snprintf(out->streamed.background, sizeof out->streamed.background, "%s", text);
    return COMMAND_DONE;
}

static int add_stream(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    char *targets = out->streamed.targets;
    const size_t used = strlen(targets), room = sizeof out->streamed.targets - used;
    out->has_picture = true;
    if (strchr(text, ' ') || strlen(text) + 2 > room)
        return command_usage(self, "--%s \"%s\" is too long or contains a space", name, text);
    (void)snprintf(targets + used, room, "%s%s", used ? " " : "", text);
    return COMMAND_DONE;
}

static int read_stream_look(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    app_picture *look = &out->streamed;
    char end;
    out->has_picture = true;
    const int got = sscanf(text, "%4ux%4u@%3u%c", &look->width, &look->height, &look->fps, &end);
    const bool is_good = got == 3 && look->width >= 64 && look->width <= 4096 &&
                         look->height >= 64 && look->height <= 4096 && look->fps >= 1 &&
                         look->fps <= 120;
    return is_good
               ? COMMAND_DONE
               : command_usage(self, "--%s %s: expected WxH@RATE, as in 1280x720@30", name, text);
}

/* Reads a show, a face, or another file that is opened after the stage. */
static int read_life(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    out->has_life = true;
    out->app.lives = strcmp(text, "on") == 0;
    if (out->app.lives || strcmp(text, "off") == 0)
        return COMMAND_DONE;
    return command_usage(self, "--%s \"%s\" is not on or off", name, text);
}

static int read_file(void *to, const command *self, const char *name, const char *text)
{
    stage_options *out = to;
    (void)name;
    switch (open_kind_of(text)) {
    case OPEN_SHOW:
        out->app.show_path = text;
        return COMMAND_DONE;
    case OPEN_FACE:
        out->app.face_path = text;
        return COMMAND_DONE;
    case OPEN_HANDS:
    case OPEN_VOICE:
    case OPEN_PICTURE:
        out->file = text;
        return COMMAND_DONE;
    default:
        return command_usage(self, "cannot open \"%s\"%s", text,
                             access(text, F_OK) == 0
                                 ? ": not a show, face, recording, sound or picture"
                                 : suggest_file(text).text);
    }
}

#define AT(member) .offset = offsetof(stage_options, member)
static const command_option option_table[] = {
    {"face", COMMAND_TEXT, AT(app.face_path)},
    {"map", COMMAND_TEXT, AT(app.mapping)},
    {"input", COMMAND_READ, .read = add_input},
    {"remote", COMMAND_TEXT, AT(app.remote)},
    {"stream", COMMAND_READ, .read = add_stream},
    {"stream-look", COMMAND_READ, .read = read_stream_look},
    {"background", COMMAND_READ, .read = read_ground},
    {"size", COMMAND_READ, .read = read_size},
    {"scale", COMMAND_NUMBER, AT(scale), .least = 0.5, .most = 4.0},
    {"hidden", COMMAND_FLAG, AT(is_hidden)},
    {"script", COMMAND_TEXT, AT(script)},
    {"picture", COMMAND_TEXT, AT(picture)},
    {"seconds", COMMAND_NUMBER, AT(seconds), .least = 0.0, .most = 1e6},
    {"life", COMMAND_READ, .read = read_life},
    {"settings", COMMAND_TEXT, AT(app.settings_path)},
    {"json", COMMAND_FLAG, AT(is_json)},
    {"FILE", COMMAND_WORD, .read = read_file},
    {.name = NULL},
};

static int read_options(stage_options *out, int argc, char **argv)
{
    *out = (stage_options){.scale = 1.0};
    int code = command_options(out, &command_stage, option_table, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (out->has_picture)
        out->app.picture = &out->streamed;
    if (!out->has_life)
        out->app.lives = !out->is_hidden;
    if (out->is_hidden && !out->app.settings_path)
        out->app.settings_path = "";
    if (out->is_hidden && !out->script && out->seconds <= 0.0)
        return command_usage(&command_stage, "--hidden needs --script or --seconds");
    return COMMAND_DONE;
}

/* ---- the stage ---- */

typedef struct left {
    double width, height; /* from --size, else from the last run, else the default */
    bool is_maximised;
} left;

/* Reads the settings. Rejects an invalid settings file before a window opens. Renames a damaged
 * default file; the application then finds none, and receives the note. */
static mrt_result read_left(stage *self, left *out, error *err)
{
    const stage_options *options = self->options;
    settings *kept;
    *out = (left){.width = WIDTH, .height = HEIGHT};
    const mrt_result result = settings_open(&kept, options->app.settings_path, self->settings_note,
                                            sizeof self->settings_note, err);
    if (result < 0)
        return result;
    const double width = settings_number(kept, "window.width", 0.0);
    const double height = settings_number(kept, "window.height", 0.0);
    if (options->width) {
        out->width = options->width;
        out->height = options->height;
    } else {
        if (width >= 800.0 && width <= 8192.0 && height >= 500.0 && height <= 8192.0) {
            out->width = width;
            out->height = height;
        }
        out->is_maximised = settings_number(kept, "window.maximised", 0.0) > 0.5;
    }
    if (options->app.face_path || !options->app.show_path) /* a show has its own face */
        self->ahead = app_face_ahead_start(options->app.face_path, kept);
    settings_close(kept);
    return MRT_OK;
}

static mrt_result open_window(stage *self, error *err)
{
    const stage_options *options = self->options;
    left was;
    mrt_result result = read_left(self, &was, err);
    if (result < 0)
        return result;
    if (options->is_hidden)
        return window_open_hidden(&self->window, (uint32_t)lround(was.width * options->scale),
                                  (uint32_t)lround(was.height * options->scale),
                                  (float)options->scale, 0.0, err);
    result = window_open_window(&self->window, (uint32_t)was.width, (uint32_t)was.height, "marotte",
                                err);
    if (result >= 0 && was.is_maximised)
        window_maximise(self->window);
    return result;
}

/* The first start of a visible window, without a face or an input on the command line. */
static bool is_first_run(const stage *self)
{
    const app_options *with = &self->options->app;
    return !self->options->is_hidden && !self->script && !with->input_count && !with->face_path &&
           !(with->settings_path && !with->settings_path[0]) && tour_is_new(self->app);
}

static mrt_result open_stage(stage *self, error *err)
{
    mrt_result result = MRT_OK;
    if (self->options->script)
        result = script_read(&self->script, self->options->script, err);
    if (result >= 0) /* opened first: without a display, nothing must be left behind */
        result = open_window(self, err);
    if (result >= 0)
        self->changed = window_signal(self->window);
    app_options with = self->options->app;
    with.note = self->settings_note;
    with.changed = self->changed;
    with.ahead = self->ahead;
    if (result >= 0)
        result = app_create(&self->app, &with, err);
    app_face_ahead_destroy(self->ahead);
    if (result >= 0)
        result = workspace_create(&self->workspace, self->app, self->window, err);
    if (result >= 0 && self->options->file)
        (void)!open_any(self->app, self->options->file); /* the application reports the error */
    if (result >= 0 && is_first_run(self))
        app_do(self->app, ACTION_TOUR);
    if (result >= 0 && self->script)
        ui_note_words(workspace_ui(self->workspace), true);
    return result;
}

/* Returns < 0 for an error, which is already printed. */
static mrt_result close_stage(stage *self)
{
    workspace_destroy(self->workspace);
    const mrt_result result = app_destroy(self->app);
    window_close(self->window);
    script_destroy(self->script);
    return result;
}

static double resident_mb(void)
{
    return (double)memory_resident() / 1e6;
}

/* Returns MRT_END at the end of the script. */
static mrt_result step_script(stage *self, error *err)
{
    const uint32_t width = window_width_px(self->window), height = window_height_px(self->window);
    const float scale = workspace_scale(self->workspace);
    const script_stage on = {
        .ui = workspace_ui(self->workspace),
        .app = self->app,
        .window = self->window,
        .screen = {.width = (float)width / scale, .height = (float)height / scale, .scale = scale}};
    return script_step(self->script, &on, err);
}

static mrt_result run(stage *self, error *err)
{
    uint64_t frames = 0;
    mrt_result result = MRT_OK;
    while (!cancel_is_requested()) {
        if (!workspace_frame(self->workspace))
            break;
        if (++frames == WARM_FRAMES)
            self->warm_mb = resident_mb();
        if (self->script && frames > 2)
            result = step_script(self, err);
        if (result != MRT_OK)
            break;
        const double left_s =
            self->options->seconds - (double)(clock_now_ns() - self->began_ns) / 1e9;
        if (self->options->seconds > 0.0 && left_s <= 0.0)
            break;
        if (self->options->seconds > 0.0)
            window_want_frame(self->window, left_s);
        if (self->script)
            window_want_frame(self->window, 0.0);
    }
    self->end_mb = resident_mb();
    self->sample_count = app_status(self->app)->sample_count;
    if (result >= 0 && self->options->picture)
        result = window_picture(self->window, self->options->picture, err);
    return result < 0 ? result : MRT_OK;
}

/* ---- results ---- */

static void report(const stage *self)
{
    workspace_counts counts;
    struct rusage used;
    facts *told = facts_create(self->options->is_json ? FACTS_JSON : FACTS_LINES);
    if (!told)
        return;
    workspace_counted(self->workspace, &counts);
    facts_number(told, "frames", "frames", (double)counts.frame_count, 0, "");
    facts_number(told, "drawn", "  drawn", (double)counts.drawn_count, 0, "");
    facts_number(told, "face_drawn", "  the face too", (double)counts.face_count, 0, "");
    for (int why = PACE_EVENT; why < PACE_REASONS; ++why) {
        char key[32], label[32];
        (void)snprintf(key, sizeof key, "frames_%s", pace_reason_names[why]);
        (void)snprintf(label, sizeof label, "  due: %s", pace_reason_names[why]);
        facts_number(told, key, label, (double)window_pace(self->window)->count[why], 0, "");
    }
    facts_number(told, "samples", "samples performed", (double)self->sample_count, 0, "");
    facts_number(told, "first_face_s", "first face", counts.first_face_s, 2, "s");
    facts_number(told, "interval_p50_ms", "a frame every", counts.fast.interval_p50_ms, 2, "ms");
    facts_number(told, "interval_p99_ms", "  99 %", counts.fast.interval_p99_ms, 2, "ms");
    facts_number(told, "draw_p50_ms", "drawing it", counts.fast.draw_p50_ms, 2, "ms");
    facts_number(told, "draw_p99_ms", "  99 %", counts.fast.draw_p99_ms, 2, "ms");
    facts_number(told, "panels_p50_ms", "panels", counts.fast.panels_p50_ms, 3, "ms");
    facts_number(told, "panels_p99_ms", "  99 %", counts.fast.panels_p99_ms, 3, "ms");
    facts_number(told, "latency_p50_ms", "hand to face", counts.fast.latency_p50_ms, 2, "ms");
    facts_number(told, "latency_p99_ms", "  99 %", counts.fast.latency_p99_ms, 2, "ms");
    if (self->warm_mb > 0.0) {
        facts_number(told, "memory_warm_mb", "memory, warm", self->warm_mb, 1, "MB");
        facts_number(told, "memory_end_mb", "memory, at the end", self->end_mb, 1, "MB");
    }
    if (getrusage(RUSAGE_SELF, &used) == 0)
        facts_number(told, "memory_peak_mb", "memory, at most", (double)used.ru_maxrss * 1024e-6, 1,
                     "MB");
    perform_outputs_report(live_outputs(app_live(self->app)), told);
    facts_finish(told);
}

static int stage_run(int argc, char **argv)
{
    stage_options options;
    error err = {0};
    const int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    stage self = {.options = &options, .began_ns = clock_now_ns()};
    cancel_on_signals(CANCEL_WAITS, NULL);
    mrt_result result = open_stage(&self, &err);
    if (result >= 0)
        result = run(&self, &err);
    if (result >= 0 && (options.is_json || options.is_hidden || options.script))
        report(&self);
    const mrt_result closed = close_stage(&self);
    if (result >= 0)
        return closed >= 0 ? COMMAND_DONE : COMMAND_FAILED;
    fprintf(stderr, "marotte: %s\n", err.text);
    return COMMAND_FAILED;
}

/* ---- whether an argument is for the stage ---- */

bool stage_accepts_argument(const char *first)
{
    if (strncmp(first, "--", 2) != 0) {
        const open_kind kind = open_kind_of(first);
        return kind == OPEN_SHOW || (kind != OPEN_ANY && access(first, F_OK) == 0);
    }
    for (const command_option *o = option_table; o->name; ++o)
        if (o->kind != COMMAND_WORD && strncmp(first + 2, o->name, strcspn(first + 2, "=")) == 0 &&
            first[2])
            return true;
    return false;
}

static int print_help(int argc, char **argv)
{
    (void)argc, (void)argv;
    fputs(
        "marotte [FILE] [OPTIONS]\n"
        "\n"
        "Opens the stage: a window with a face that hands perform, live and over takes. FILE is a\n"
        "show (.marotte, created if it does not exist), a face (.rig.json .glb .vrm .obj ...), a\n"
        "recording of hands (.csv), a sound or a picture. Without a show the last one is opened,\n"
        "or a new one in Documents/marotte. Press ? in the window for its keys.\n"
        "\n"
        "  --face FILE      a rig, a head, or puppet, moai (the show's, or the last one)\n"
        "  --map SPEC       the mapping: one_hand,smile_gain=130 (the last one)\n"
        "  --input SPEC     a device or a recording, once for each: log:demo,loop=1\n"
        "                   (the last ones, or all connected devices)\n"
        "  --remote [HOST:]PORT  let a phone, a Stream Deck or a script record, mark and pose,\n"
        "                   by OSC and WebSocket (the last setting, initially off).\n"
        "                   0.0.0.0:9110 also accepts other computers, with a pairing code\n"
        "  --stream TARGET  send the picture to other programs, up to 4: pipewire (a camera),\n"
        "                   /dev/videoN (v4l2loopback), srt://HOST:PORT, udp://HOST:PORT (ffmpeg)\n"
        "  --stream-look WxH@RATE  the size and rate of that picture (1280x720@30)\n"
        "  --background C   background of that picture and of the output window: transparent\n"
        "                   or #00b140\n"
        "  --size WxH       the size of the window, in points (the last size)\n"
        "  --life on|off    whether the face of a new show lives by itself: it blinks, looks "
        "around\n"
        "                   and breathes (on; with --hidden: off)\n"
        "  --settings FILE  the settings ($XDG_CONFIG_HOME/marotte/window.json; with --hidden:\n"
        "                   none); \"\": none\n"
        "\n"
        "For scripts:\n"
        "  --hidden         no window; needs no display\n"
        "  --scale S        pixels per point of a hidden window (1)\n"
        "  --seconds N      end after N seconds\n"
        "  --script FILE    run a script, then end\n"
        "  --picture FILE   write a PNG of the window at the end\n"
        "  --json           print the facts as JSON\n"
        "\n"
        "A script has one command a line; # begins a comment:\n",
        stdout);
    fputs(script_help(), stdout);
    fputs("Run random on copies: it may change the show and the face.\n", stdout);
    return COMMAND_DONE;
}

const command command_stage = {
    .name = "stage",
    .summary = "open the window in which a face is performed",
    .print_help = print_help,
    .examples = "stage\n"
                "girl.glb\n"
                "show.marotte\n"
                "stage --face moai --map anchored --input log:demo_hand.csv,loop=1\n",
    .run = stage_run,
    .options = option_table,
};
