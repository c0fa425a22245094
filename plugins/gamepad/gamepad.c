/* gamepad.c - the plugin "org.marotte.gamepad": sticks, triggers and buttons of any number of
 * gamepads as named channels (pad.h), even when another window has the focus. The guide is
 * plugins/devices/README.md. */
#include "device_io.h"
#include "pad.h"
#include "trace.h"

#include <marotte/plugin.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/input.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* ---- Linux input devices: finds the connected pads in /sys without opening them, and opens one
 * for its events ---- */

enum { EVDEV_DEVICES = 16, EVDEV_NAME = 64, EVDEV_IDENTITY = 96 };

typedef struct evdev_device {
    uint32_t number; /* of /dev/input/eventN */
    char node[32], name[EVDEV_NAME];
    /* USB port, or address of the radio: the same after reconnecting. */
    char identity[EVDEV_IDENTITY];
    pad_model model; /* without the ranges of the axes */
} evdev_device;

enum { PATH = 96, LINE = 512, FOLDER_CAP = 4096 };
static const char folder[] = "/sys/class/input";

/* Replaces ',' by a blank, because it begins parameters in the text of an input. */
static void read_line(uint32_t number, const char *file, char *out, size_t capacity)
{
    char path[PATH];
    (void)snprintf(path, sizeof path, "%s/event%u/device/%s", folder, number, file);
    device_read_line(path, out, capacity);
    for (char *c = out; *c; ++c)
        if (*c == ',')
            *c = ' ';
}

/* Parses "7cdb000000000000 0 0 0 0": words of the size of a long, the lowest last. */
static void read_bits(uint32_t number, const char *file, uint8_t *out, size_t size)
{
    char line[LINE];
    uint32_t word_count = 0;
    memset(out, 0, size);
    read_line(number, file, line, sizeof line);
    for (char *end = line + strlen(line); end > line; ++word_count) {
        char *begin = end;
        while (begin > line && begin[-1] != ' ')
            --begin;
        const unsigned long word = strtoul(begin, NULL, 16);
        for (size_t i = 0; i < sizeof word && word_count * sizeof word + i < size; ++i)
            out[word_count * sizeof word + i] = (uint8_t)(word >> (8 * i));
        end = begin > line ? begin - 1 : begin;
        *end = '\0';
    }
}

static void find_identity(evdev_device *out)
{
    read_line(out->number, "uniq", out->identity, sizeof out->identity);
    if (out->identity[0] == '\0')
        read_line(out->number, "phys", out->identity, sizeof out->identity);
    if (out->identity[0] == '\0')
        (void)snprintf(out->identity, sizeof out->identity, "event%u", out->number);
    for (char *c = out->identity; *c; ++c)
        if (*c == '/')
            *c = '.';
}

static bool see(evdev_device *out, uint32_t number)
{
    char vendor[16];
    uint8_t axes[PAD_AXES / 8];
    *out = (evdev_device){.number = number};
    read_bits(number, "capabilities/key", out->model.key, sizeof out->model.key);
    read_bits(number, "capabilities/abs", axes, sizeof axes);
    for (uint16_t i = 0; i < PAD_AXES; ++i)
        out->model.axis[i].is_there = axes[i / 8] >> i % 8 & 1;
    if (!pad_is_pad(&out->model))
        return false;
    read_line(number, "id/vendor", vendor, sizeof vendor);
    out->model.vendor = (uint16_t)strtoul(vendor, NULL, 16);
    read_line(number, "name", out->name, sizeof out->name);
    (void)snprintf(out->node, sizeof out->node, "/dev/input/event%u", number);
    find_identity(out);
    return true;
}

static int compare_numbers(const void *a, const void *b)
{
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* Lists pads in the order in which they were connected, at most EVDEV_SEEN. Returns their
 * number. */
static uint32_t evdev_look(evdev_device out[EVDEV_DEVICES])
{
    enum { NUMBERS = 256 };
    uint32_t number[NUMBERS], number_count = 0, count = 0;
    DIR *listing = opendir(folder);
    if (!listing)
        return 0;
    const struct dirent *entry;
    for (int i = 0; i < FOLDER_CAP && number_count < NUMBERS && (entry = readdir(listing)); ++i)
        if (sscanf(entry->d_name, "event%9u", &number[number_count]) == 1)
            number_count += 1;
    closedir(listing);
    qsort(number, number_count, sizeof *number, compare_numbers);
    for (uint32_t i = 0; i < number_count && count < EVDEV_DEVICES; ++i)
        count += see(&out[count], number[i]);
    return count;
}

/* ---- an open pad ---- */

/* Reads the state of all controls, also after lost events. Returns false if the device was lost. */
static bool evdev_read_state(int descriptor, const pad_model *model, pad_state *out)
{
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < PAD_AXES; ++i) {
        struct input_absinfo about = {0};
        if (!model->axis[i].is_there)
            continue;
        if (ioctl(descriptor, EVIOCGABS(i), &about) < 0)
            return false;
        pad_set_axis(out, (uint16_t)i, about.value);
    }
    return ioctl(descriptor, EVIOCGKEY(sizeof out->key), out->key) >= 0;
}

/* Opens a pad, completes its model and reads its state. Returns -1 and errno on failure. Events
 * have times of the monotonic clock. Several programs can have a pad open. */
static int evdev_open(evdev_device *device, pad_state *out_state)
{
    const int clock = CLOCK_MONOTONIC;
    int descriptor = open(device->node, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0)
        return -1;
    for (uint32_t i = 0; i < PAD_AXES; ++i) {
        struct input_absinfo about = {0};
        pad_axis *axis = &device->model.axis[i];
        if (axis->is_there && ioctl(descriptor, EVIOCGABS(i), &about) >= 0)
            *axis = (pad_axis){true, about.minimum, about.maximum};
    }
    if (ioctl(descriptor, EVIOCSCLOCKID, &clock) >= 0 &&
        evdev_read_state(descriptor, &device->model, out_state))
        return descriptor;
    int error = errno;
    close(descriptor);
    errno = error;
    return -1;
}

/* Returns the number of events read; 0: none; -1: the device was lost. */
static int evdev_read(int descriptor, struct input_event *out, uint32_t capacity)
{
    ssize_t size = read(descriptor, out, capacity * sizeof *out);
    if (size >= (ssize_t)sizeof *out)
        return (int)((size_t)size / sizeof *out);
    return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

/* ---- the input ---- */

enum { PARAM_DEAD, PARAM_COUNT };
enum { EVENTS = 64 };

static const int64_t ns_per_s = 1000000000;
/* An unchanged state is repeated at this interval, so that silence shows a fault. */
static const int64_t repeat_ns = 1000000000;

struct mrt_plugin {
    const mrt_host *host;
    int descriptor;                /* -1: closed */
    char address[192];             /* as opened */
    char identity[EVDEV_IDENTITY]; /* the pad first found at this address; "": none yet */
    evdev_device pad;
    pad_state state;
    trace trace;
    mrt_channel channel[PAD_CHANNELS];

    struct input_event event[EVENTS]; /* received and unread */
    uint32_t event_count, event_at;
    bool has_dropped; /* the system lost events: those up to the next report are useless */
    bool is_lost, has_told_loss, is_due;
    int64_t host_offset_ns, last_ns, repeat_due_ns;
    uint32_t sequence;
    float given[PAD_CHANNELS];
};

/* ---- choosing the pad ---- */

/* "": the first, "2": the second, else an identity or a node. */
static bool is_wanted(const mrt_plugin *self, const evdev_device *device, uint32_t index)
{
    char *end;
    if (self->identity[0])
        return strcmp(self->identity, device->identity) == 0;
    unsigned long number = strtoul(self->address, &end, 10);
    if (self->address[0] == '\0' || (*end == '\0' && number > 0))
        return index + 1 == (self->address[0] ? number : 1);
    return strcmp(self->address, device->identity) == 0 || strcmp(self->address, device->node) == 0;
}

static const char *advice(int error)
{
    if (error == EACCES || error == EPERM)
        return "you have no permission to read it: run sudo adduser $USER input, then log in again";
    return "plug it in again";
}

/* ---- opening ---- */

static void input_close(mrt_plugin *self)
{
    if (self->descriptor < 0)
        return;
    close(self->descriptor);
    trace_close(&self->trace);
    self->descriptor = -1;
}

static mrt_result report_absent(const mrt_plugin *self, uint32_t count)
{
    if (self->identity[0])
        device_log(self->host, MRT_LOG_ERROR,
                   "the gamepad at %.90s is not connected: plug it in again", self->identity);
    else if (self->address[0])
        device_log(self->host, MRT_LOG_ERROR,
                   "no gamepad matches \"%.60s\" (%u connected): plug it in, or list the devices "
                   "with: marotte devices",
                   self->address, count);
    else
        device_log(self->host, MRT_LOG_ERROR, "no gamepad found: plug one in");
    return MRT_ERR_IO;
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    evdev_device device[EVDEV_DEVICES];
    (void)params;
    input_close(self);
    if (strcmp(self->address, address) != 0)
        self->identity[0] = '\0';
    (void)snprintf(self->address, sizeof self->address, "%s", address);
    const uint32_t count = evdev_look(device);
    uint32_t at = 0;
    while (at < count && !is_wanted(self, &device[at], at))
        at += 1;
    if (at == count)
        return report_absent(self, count);
    self->pad = device[at];
    self->descriptor = evdev_open(&self->pad, &self->state);
    if (self->descriptor < 0) {
        device_log(self->host, MRT_LOG_ERROR, "%.60s (%s): %s: %s", self->pad.name, self->pad.node,
                   strerror(errno), advice(errno));
        return MRT_ERR_IO;
    }
    (void)snprintf(self->identity, sizeof self->identity, "%s", self->pad.identity);
    trace_open(&self->trace, self->host, "gamepad");
    self->event_count = self->event_at = 0;
    self->has_dropped = self->is_lost = self->has_told_loss = false;
    self->host_offset_ns = device_clock_host_offset_ns(self->host);
    self->last_ns = self->host->now_ns(self->host);
    self->is_due = true; /* current state of all controls */
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->descriptor >= 0 ? PAD_CHANNELS : 0;
    return self->channel;
}

/* ---- samples ---- */

static float dead_of(const double *params)
{
    const double percent = params[PARAM_DEAD];
    return percent > 0.0 ? (float)(percent < 50.0 ? percent * 0.01 : 0.5) : 0.0f;
}

static mrt_result give(mrt_plugin *self, const double *params, int64_t time_ns, mrt_sample *out)
{
    memset(out, 0, sizeof *out);
    out->time_ns = device_sample_ns(self->host, time_ns, &self->last_ns);
    self->repeat_due_ns = self->host->now_ns(self->host) + repeat_ns;
    self->is_due = false;
    out->sequence = self->sequence++;
    out->count = PAD_CHANNELS;
    pad_read(&self->pad.model, &self->state, dead_of(params), out->value);
    memcpy(self->given, out->value, sizeof self->given);
    return MRT_OK;
}

/* Releases the buttons; sticks and triggers keep their position. */
static mrt_result lose(mrt_plugin *self, mrt_sample *out)
{
    bool is_any_down = false;
    for (int i = PAD_BUTTONS; i < PAD_CHANNELS; ++i) {
        is_any_down |= self->given[i] > 0.0f;
        self->given[i] = 0.0f;
    }
    if (is_any_down) {
        memset(out, 0, sizeof *out);
        out->time_ns = device_sample_ns(self->host, self->host->now_ns(self->host), &self->last_ns);
        out->sequence = self->sequence++;
        out->count = PAD_CHANNELS;
        memcpy(out->value, self->given, sizeof self->given);
        return MRT_OK;
    }
    if (!self->has_told_loss)
        device_log(self->host, MRT_LOG_ERROR,
                   "%.60s was disconnected: plug it in again, or switch it on", self->pad.name);
    self->has_told_loss = true;
    return MRT_ERR_IO;
}

static int64_t time_of(const mrt_plugin *self, const struct input_event *event)
{
    return (int64_t)event->input_event_sec * ns_per_s + (int64_t)event->input_event_usec * 1000 +
           self->host_offset_ns;
}

/* Returns true if a report is complete. */
static bool take_event(mrt_plugin *self, const struct input_event *event)
{
    if (event->type == EV_SYN && event->code == SYN_DROPPED) {
        self->has_dropped = true;
        return false;
    }
    if (self->has_dropped && (event->type != EV_SYN || event->code != SYN_REPORT))
        return false;
    if (event->type == EV_ABS)
        pad_set_axis(&self->state, event->code, event->value);
    else if (event->type == EV_KEY)
        pad_set_key(&self->state, event->code, event->value != 0);
    if (event->type != EV_SYN || event->code != SYN_REPORT)
        return false;
    if (self->has_dropped && !evdev_read_state(self->descriptor, &self->pad.model, &self->state))
        self->is_lost = true;
    self->has_dropped = false;
    return true;
}

/* Returns the next sample from the received events. Returns false if there are no more. */
static bool give_event(mrt_plugin *self, const double *params, mrt_sample *out)
{
    while (self->event_at < self->event_count) {
        const struct input_event *event = &self->event[self->event_at++];
        if (take_event(self, event)) {
            (void)give(self, params, time_of(self, event), out);
            return true;
        }
    }
    return false;
}

static void receive(mrt_plugin *self)
{
    const int count = evdev_read(self->descriptor, self->event, EVENTS);
    self->event_at = 0;
    self->event_count = count > 0 ? (uint32_t)count : 0;
    self->is_lost = count < 0;
    if (count > 0)
        trace_received(&self->trace, self->host->now_ns(self->host), self->event,
                       (size_t)count * sizeof *self->event);
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (self->descriptor < 0)
        return MRT_ERR_IO;
    for (;;) {
        if (self->is_lost)
            return lose(self, out_sample);
        if (give_event(self, params, out_sample))
            return MRT_OK;
        const int64_t now_ns = self->host->now_ns(self->host);
        if (self->is_due || now_ns >= self->repeat_due_ns)
            return give(self, params, now_ns, out_sample);
        receive(self);
        if (self->event_count > 0 && now_ns < deadline_ns)
            continue;
        if (self->is_lost)
            continue;
        if (now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        const int64_t until_ns =
            deadline_ns < self->repeat_due_ns ? deadline_ns : self->repeat_due_ns;
        if (device_wait(self->descriptor, until_ns - now_ns) < 0)
            self->is_lost = true;
    }
}

/* ---- devices ---- */

static void fill_device(const evdev_device *device, mrt_device *out)
{
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    (void)snprintf(out->address, sizeof out->address, "%s", device->identity);
    (void)snprintf(out->name, sizeof out->name, "%s", device->name[0] ? device->name : "Gamepad");
    if (access(device->node, R_OK) != 0) {
        out->state = MRT_DEVICE_DENIED;
        (void)snprintf(out->advice, sizeof out->advice, "%s", advice(EACCES));
    }
}

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    evdev_device device[EVDEV_DEVICES];
    const uint32_t count = evdev_look(device);
    (void)self;
    for (uint32_t i = 0; i < count && i < capacity; ++i)
        fill_device(&device[i], &out[i]);
    return count;
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    if (self->descriptor < 0 || self->is_lost)
        return false;
    fill_device(&self->pad, out);
    return true;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->descriptor = -1;
    self->trace.file = -1;
    for (int i = 0; i < PAD_CHANNELS; ++i)
        self->channel[i] = (mrt_channel){pad_name[i],
                                         "",
                                         i < PAD_BUTTONS ? MRT_CH_OTHER : MRT_CH_BUTTON,
                                         MRT_NO_HAND,
                                         i >= PAD_LEFT_TRIGGER && i <= PAD_RIGHT_TRIGGER ? 0.0f
                                         : i < PAD_BUTTONS                               ? -1.0f
                                                                                         : 0.0f,
                                         1.0f};
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    input_close(self);
    free(self);
}

static const mrt_param params_table[PARAM_COUNT] = {
    [PARAM_DEAD] = {1, 0, "dead", "Gamepad", "%",
                    "Range around the rest of a stick or trigger that counts as rest", 0, 50, 12,
                    NULL},
};

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params_table,
    interfaces,
    "org.marotte.gamepad",
    "Gamepad",
    MAROTTE_VERSION,
    "Sticks, triggers and buttons, even when another window has the focus; address 2: the second "
    "gamepad",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
