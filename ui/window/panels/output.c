/* The panel Send: each open output with its address, rate, number of faces and state, and a form
 * that sends the face to another program. */
#include "window/panels/panels.h"

#include "window/gui/theme.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ADDRESS = 200, NUMBER = 16, RECEIVERS_MAX = 32, SETUP_TEXT = 320 };
#define LABEL    62.0f /* x of the widgets in a row, points */
#define TO_LABEL 24.0f /* the names of the programs are long */
#define INDENT   18.0f

/* Programs that receive the face: one plugin with the settings that they need. */
typedef struct receiver {
    const char *plugin, *name; /* id of the plugin; names of the programs */
    const char *host;          /* "": the plugin has no usual address */
    uint32_t port;             /* the usual port of these programs; 0: none */
    const char *settings;      /* sent always, "role=performer"; "" */
    const char *setup;         /* what the user sets in the programs; %P is the port */
} receiver;

static const receiver known[] = {
    {"org.marotte.livelink", "Unreal (Live Link)", "127.0.0.1", 11111, "",
     "In Unreal, add the Live Link source Apple ARKit at port %P and choose the subject marotte."},
    {"org.marotte.vmc", "VSeeFace, Warudo, Blender (VMC)", "127.0.0.1", 39540, "",
     "In the program, switch on its VMC receiver at port %P. In Blender, use marotte's add-on."},
    {"org.marotte.vmc", "EVMC4U, whole person (VMC)", "127.0.0.1", 39539, "role=performer",
     "In Unity, set the port of EVMC4U to %P."},
    {"org.marotte.vts", "VTube Studio", "127.0.0.1", 8001, "",
     "In VTube Studio, switch on the plugin API at port %P and allow marotte when it asks."},
    {"org.marotte.ifacialmocap", "iFacialMocap receivers", "127.0.0.1", 49983, "",
     "In the program, enter 127.0.0.1 as the address of the phone. For a program on another "
     "computer, write 0.0.0.0 here and enter the address of this computer there."},
    {"org.marotte.face_osc", "OSC", "127.0.0.1", 9106, "",
     "In the program, listen for OSC at port %P: /marotte/1/face NAME VALUE ..."},
};

struct panel {
    app *app;
    /* the receivers that loaded plugins can send to */
    const char *name[RECEIVERS_MAX];
    const mrt_plugin_type *type[RECEIVERS_MAX];
    const receiver *receiver[RECEIVERS_MAX]; /* NULL: a plugin that `known` lacks */
    uint32_t count, chosen;
    const mrt_plugin_type *filled; /* the fields have the defaults of this receiver */
    const receiver *filled_receiver;
    char address[ADDRESS], port[NUMBER], rate[NUMBER], settings[ADDRESS];
    char refusal[128]; /* of the fields; "": none */
};

/* ---- receivers ---- */

/* Returns the receiver of the text of an output, "PLUGIN:ADDRESS,key=value". NULL: none. */
static const receiver *receiver_of(const char *text)
{
    const size_t length = strcspn(text, ":,");
    const receiver *found = NULL;
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        const char *id = known[i].plugin;
        const bool is_plugin = (strlen(id) == length && strncmp(id, text, length) == 0) ||
                               (strlen(strrchr(id, '.') + 1) == length &&
                                strncmp(strrchr(id, '.') + 1, text, length) == 0);
        if (is_plugin && strstr(text, known[i].settings) && (!found || known[i].settings[0]))
            found = &known[i];
    }
    return found;
}

static const mrt_param *rate_of(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (strcmp(type->params[i].name, "Rate") == 0)
            return &type->params[i];
    return NULL;
}

static void add_receiver(panel *self, const mrt_plugin_type *type, const receiver *of)
{
    if (self->count == RECEIVERS_MAX)
        return;
    self->type[self->count] = type;
    self->receiver[self->count] = of;
    self->name[self->count++] = of ? of->name : type->name;
}

static bool is_known(const mrt_plugin_type *type)
{
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (strcmp(known[i].plugin, type->id) == 0)
            return true;
    return false;
}

/* Lists the known receivers in the order of the table, then the other plugins. */
static void list_receivers(panel *self)
{
    const plugin_list *all = app_plugins(self->app);
    self->count = 0;
    for (size_t k = 0; k < sizeof known / sizeof *known; ++k)
        for (uint32_t i = 0; i < all->entry_count; ++i)
            if (strcmp(all->entry[i].type->id, known[k].plugin) == 0 &&
                plugin_interface(all->entry[i].type, MRT_FACE_OUTPUT))
                add_receiver(self, all->entry[i].type, &known[k]);
    for (uint32_t i = 0; i < all->entry_count; ++i)
        if (plugin_interface(all->entry[i].type, MRT_FACE_OUTPUT) && !is_known(all->entry[i].type))
            add_receiver(self, all->entry[i].type, NULL);
    if (self->chosen >= self->count)
        self->chosen = 0;
}

/* Fills in the usual values of the chosen receiver, once. */
static void fill_fields(panel *self)
{
    const mrt_plugin_type *type = self->type[self->chosen];
    const receiver *of = self->receiver[self->chosen];
    const mrt_param *rate = rate_of(type);
    if (self->filled == type && self->filled_receiver == of)
        return;
    self->filled = type;
    self->filled_receiver = of;
    self->port[0] = self->rate[0] = self->settings[0] = self->refusal[0] = '\0';
    (void)snprintf(self->address, sizeof self->address, "%s", of ? of->host : "");
    if (of)
        (void)snprintf(self->port, sizeof self->port, "%u", of->port);
    if (rate && rate->initial > 0.0)
        (void)snprintf(self->rate, sizeof self->rate, "%.0f", rate->initial);
}

/* ---- open outputs ---- */

/* "1 234 567": groups of three digits. */
static void write_count(char out[32], uint64_t count)
{
    char digits[24];
    const int length = snprintf(digits, sizeof digits, "%llu", (unsigned long long)count);
    int n = 0;
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0)
            out[n++] = ' ';
        out[n++] = digits[i];
    }
    out[n] = '\0';
}

static void describe(char out[256], ui_style *style, const output_status *s)
{
    char count[32];
    write_count(count, s->sent);
    *style = UI_STYLE_DIM;
    if (s->state == OUTPUT_FAILED) {
        *style = UI_STYLE_BAD;
        (void)snprintf(out, 256, "%s. Retrying.", s->trouble);
    } else if (s->state == OUTPUT_NO_RECEIVER) {
        *style = UI_STYLE_WARNING;
        (void)snprintf(out, 256, "No program answers at this address. %s faces sent.", count);
    } else if (s->state == OUTPUT_OPENS || s->sent == 0) {
        (void)snprintf(out, 256, "Opening ...");
    } else if (!(s->rate_hz > 0.0)) { /* in the first second */
        (void)snprintf(out, 256, "%s faces sent", count);
    } else {
        (void)snprintf(out, 256, "%.0f per second, %s faces sent", s->rate_hz, count);
    }
}

static uint32_t light_of(output_state state)
{
    static const uint32_t colours[] = {[OUTPUT_OPENS] = THEME_DIM,
                                       [OUTPUT_SENDS] = THEME_GOOD,
                                       [OUTPUT_NO_RECEIVER] = THEME_WARNING,
                                       [OUTPUT_FAILED] = THEME_BAD};
    return colours[state];
}

/* Returns false if the user closes the output. */
static bool draw_output(panel *self, ui *on, uint32_t index)
{
    output_status s;
    char text[256];
    ui_style style;
    ui_canvas light;
    outputs_status(live_outputs(app_live(self->app)), index, &s);
    const receiver *of = receiver_of(s.text);
    ui_canvas_begin(on, "light", 12.0f, ui_row_height(on), &light);
    ui_draw_disc(on, light.where.x + 6.0f, light.where.y + 0.5f * light.where.height, 4.5f,
                 light_of(s.state));
    ui_canvas_end(on);
    ui_same_line(on);
    ui_at(on, INDENT);
    ui_label(on, "text", ui_available_width(on) - 66.0f, THEME_TEXT, of ? of->name : s.name);
    ui_hint(on, s.text);
    ui_same_line(on);
    bool is_removed = ui_button(on, "Close", UI_QUIET);
    ui_hint(on, "Stop sending to this address.");
    const size_t begin = strcspn(s.text, ":,");
    const char *address = s.text[begin] == ':' ? s.text + begin + 1 : "";
    (void)snprintf(text, sizeof text, "%.*s", (int)strcspn(address, ","), address);
    if (text[0])
        ui_text(on, UI_STYLE_NUMBER, text);
    describe(text, &style, &s);
    ui_text_wrapped(on, style, text);
    if (s.state == OUTPUT_SENDS && s.sent > 0) {
        (void)snprintf(text, sizeof text, "%.1f ms after the hand%s", s.p50_ms,
                       s.is_isolated ? ", in a separate process" : "");
        ui_hint(on, text);
    }
    return !is_removed;
}

static void draw_outputs(panel *self, ui *on)
{
    const outputs *of = live_outputs(app_live(self->app));
    uint32_t removed = UINT32_MAX;
    for (uint32_t i = 0; i < outputs_count(of); ++i) {
        char id[32];
        (void)snprintf(id, sizeof id, "output %u", i);
        ui_id_begin(on, id);
        if (!draw_output(self, on, i))
            removed = i;
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    if (outputs_count(of) == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "Nothing is sent. Choose a program below. It receives the face live and "
                        "while a take plays.");
    if (removed != UINT32_MAX)
        app_remove_output(self->app, removed);
}

/* Draws the error of the approximation by the 52 ARKit weights. */
static void draw_residual(const panel *self, ui *on)
{
    char text[32];
    outputs *of = live_outputs(app_live(self->app));
    double residual_mm = outputs_residual_mm(of);
    if (outputs_count(of) == 0 || !(residual_mm > 0.0))
        return;
    (void)snprintf(text, sizeof text, "%.2f mm off", residual_mm);
    ui_fact(on, "In ARKit's 52", 110.0f, UI_STYLE_NUMBER, text);
    ui_hint(on, "Distance between the face and its approximation by the ARKit weights.");
}

/* ---- new output ---- */

/* Whether the field is a whole number of the range, with nothing after it. */
static bool is_number(const char *text, double min, double max)
{
    char *end;
    const double value = strtod(text, &end);
    return end != text && *end == '\0' && value >= min && value <= max;
}

/* Checks the fields. False: `refusal` says what to write. */
static bool check_fields(panel *self)
{
    const receiver *of = self->receiver[self->chosen];
    const mrt_param *rate = rate_of(self->type[self->chosen]);
    self->refusal[0] = '\0';
    if ((of || self->port[0]) && (strspn(self->port, "0123456789") != strlen(self->port) ||
                                  !is_number(self->port, 1.0, 65535.0)))
        (void)snprintf(self->refusal, sizeof self->refusal, "Write a port from 1 to 65535.");
    else if (of && !self->address[0])
        (void)snprintf(self->refusal, sizeof self->refusal,
                       "Write an address. 127.0.0.1 is this computer.");
    else if (strchr(self->address, ','))
        (void)snprintf(self->refusal, sizeof self->refusal, "Write one address, without a comma.");
    else if (rate && self->rate[0] && !is_number(self->rate, rate->min, rate->max))
        (void)snprintf(self->refusal, sizeof self->refusal,
                       "Write a rate from %.0f to %.0f faces per second.", rate->min, rate->max);
    return !self->refusal[0];
}

static void send(panel *self)
{
    char text[3 * ADDRESS];
    const receiver *of = self->receiver[self->chosen];
    const bool is_rate = rate_of(self->type[self->chosen]) && self->rate[0];
    if (!check_fields(self))
        return;
    (void)snprintf(text, sizeof text, "%s%s%s%s%s%s%s%s%s%s%s", self->type[self->chosen]->id,
                   self->address[0] || self->port[0] ? ":" : "", self->address,
                   self->address[0] && self->port[0] ? ":" : "", self->port,
                   of && of->settings[0] ? "," : "", of ? of->settings : "",
                   is_rate ? ",rate=" : "", is_rate ? self->rate : "", self->settings[0] ? "," : "",
                   self->settings);
    if (app_add_output(self->app, text) >= 0)
        self->filled = NULL; /* the defaults again */
}

/* A field with its label. Returns whether Enter ended it. */
static bool draw_field(ui *on, const char *label, const char *placeholder, float width, char *text,
                       size_t capacity, const char *hint)
{
    char id[32];
    (void)snprintf(id, sizeof id, "##%s", label);
    ui_label(on, label, LABEL, THEME_DIM, label);
    ui_hint(on, hint);
    ui_same_line(on);
    ui_at(on, LABEL);
    ui_width(on, width);
    (void)ui_input(on, id, placeholder, text, capacity);
    return ui_input_is_entered(on);
}

/* Draws what the user sets in the receiver, with the port of the field. */
static void draw_setup(const panel *self, ui *on)
{
    char text[SETUP_TEXT];
    const receiver *of = self->receiver[self->chosen];
    const char *setup = of ? of->setup : self->type[self->chosen]->about;
    const char *port = strstr(setup, "%P");
    if (port)
        (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(port - setup), setup,
                       self->port[0] ? self->port : "?", port + 2);
    else
        (void)snprintf(text, sizeof text, "%s", setup);
    ui_text_wrapped(on, UI_STYLE_BODY, text);
}

static void draw_new(panel *self, ui *on)
{
    list_receivers(self);
    ui_text(on, UI_STYLE_TITLE, "Send the face");
    if (self->count == 0) {
        ui_text_wrapped(on, UI_STYLE_DIM, "No output plugin was found.");
        return;
    }
    (void)ui_choice(on, "To", TO_LABEL, self->name, self->count, &self->chosen);
    ui_hint(on, self->type[self->chosen]->about);
    fill_fields(self);
    bool is_entered = draw_field(on, "Address", "127.0.0.1 is this computer", 0.0f, self->address,
                                 sizeof self->address,
                                 "Address of the computer that receives. 127.0.0.1 is this one.");
    is_entered |= draw_field(on, "Port", "1 to 65535", 90.0f, self->port, sizeof self->port,
                             "Port at which the program listens.");
    const mrt_param *rate = rate_of(self->type[self->chosen]);
    if (rate) {
        is_entered |= draw_field(on, "Rate", rate->initial > 0.0 ? "faces" : "every face", 90.0f,
                                 self->rate, sizeof self->rate, rate->help);
        ui_same_line(on);
        ui_text(on, UI_STYLE_DIM, "per second");
    }
    if (ui_section(on, "More", false))
        is_entered |=
            draw_field(on, "Settings", "names=arkit", 0.0f, self->settings, sizeof self->settings,
                       "Set parameters of the plugin. \"marotte plugin list --params\" "
                       "lists them.");
    ui_space(on, 2.0f);
    draw_setup(self, on);
    ui_space(on, 2.0f);
    bool is_full = outputs_count(live_outputs(app_live(self->app))) == OUTPUTS_MAX;
    ui_disabled_begin(on, is_full);
    if (ui_button(on, "Start sending", UI_ACCENT) || (is_entered && !is_full))
        send(self);
    ui_hint(on, is_full ? "The maximum number of outputs is open. Close one first."
                        : "Send the face to this address, now and at each start of marotte.");
    ui_disabled_end(on);
    const char *trouble = self->refusal[0] ? self->refusal : app_output_trouble(self->app);
    if (trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, trouble);
}

/* ---- the panel ---- */

static void draw(panel *self, ui *on, ui_rectangle where)
{
    ui_panel_begin(on, "output", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    draw_outputs(self, on);
    draw_residual(self, on);
    ui_space(on, 6.0f);
    draw_new(self, on);
    ui_scroll_end(on);
    ui_panel_end(on);
}

static void destroy(panel *self)
{
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (self)
        self->app = of;
    return self;
}

const panel_type panel_output = {create, destroy, draw, NULL};
