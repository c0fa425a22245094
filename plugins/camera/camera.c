/* camera.c - the plugin "org.marotte.camera": a bare hand in front of a webcam. A page in the
 * user's browser finds the hand (camera_port.h), marotte converts its landmarks to angles
 * (MRT_LANDMARKS), and this plugin returns them as samples. README.md is the user's guide. */
#include "bare_hand.h"
#include "camera_port.h"
#include "device_io.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

static const int64_t ns_per_ms = 1000000;
/* The movement between two pictures is interpolated evenly. Otherwise, at a few pictures per
 * second, the hand would seem to disappear between pictures, and the face would ease all the time
 * and never arrive. */
static const int64_t between_ns = 100000000, slowest_ns = 1000000000;

struct mrt_plugin {
    const mrt_host *host;
    camera_port *port; /* NULL: closed */
    uint16_t number;
    camera_listener listener; /* joined while port is open */
    bare_hand hand;
    bool is_steady; /* the previous picture also had the hand */
    /* Interpolation from the last sample to the newest reading: steps still to return. */
    uint32_t step_count, step;
    int64_t from_ns, to_ns;
    float from[MRT_ANGLES];
};

/* ---- paths ---- */

static const char token_file[] = "token";

static bool is_token(const char *text)
{
    return strspn(text, "0123456789abcdef") == CAMERA_TOKEN && strlen(text) == CAMERA_TOKEN;
}

static bool read_token(const char *path, char out[CAMERA_TOKEN + 1])
{
    struct stat about;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (file < 0)
        return false;
    bool is_ours = fstat(file, &about) == 0 && S_ISREG(about.st_mode) &&
                   about.st_uid == geteuid() && (about.st_mode & 077) == 0;
    ssize_t size = is_ours ? read(file, out, CAMERA_TOKEN) : 0;
    close(file);
    out[CAMERA_TOKEN] = '\0';
    return size == CAMERA_TOKEN && is_token(out);
}

static bool draw_token(char out[CAMERA_TOKEN + 1])
{
    unsigned char bytes[CAMERA_TOKEN / 2];
    if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
        return false;
    for (size_t i = 0; i < sizeof bytes; ++i)
        (void)snprintf(out + 2 * i, 3, "%02x", bytes[i]);
    return true;
}

/* Reads or creates the token. It lasts as long as the user's settings, so that an open page finds
 * marotte again. Nobody else can read it. */
static bool find_token(const mrt_plugin *self, char out[CAMERA_TOKEN + 1])
{
    const mrt_folders *folders = self->host->service(self->host, MRT_FOLDERS);
    char folder[CAMERA_PATH], path[CAMERA_PATH + 16];
    if (!folders || folders->settings(self->host, folder, sizeof folder) < 0)
        return draw_token(out); /* for this once */
    (void)snprintf(path, sizeof path, "%s/%s", folder, token_file);
    if (read_token(path, out))
        return true;
    if (!draw_token(out))
        return false;
    (void)unlink(path);
    int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0)
        return true;
    bool is_kept = write(file, out, CAMERA_TOKEN) == CAMERA_TOKEN;
    close(file);
    if (!is_kept)
        (void)unlink(path);
    return true;
}

/* Folder in which `marotte camera --setup` installs the package. */
static void find_package(char *out, size_t capacity)
{
    static const char rest[] = "marotte/camera/node_modules/@mediapipe/hands";
    const char *own = getenv("MAROTTE_CAMERA_PACKAGE");
    const char *data = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    if (own && own[0] == '/')
        (void)snprintf(out, capacity, "%s", own);
    else if (data && data[0] == '/')
        (void)snprintf(out, capacity, "%s/%s", data, rest);
    else
        (void)snprintf(out, capacity, "%s/.local/share/%s", home ? home : "", rest);
}

static bool read_address(const char *address, uint16_t *out_port)
{
    char *end;
    *out_port = CAMERA_PORT_USUAL;
    if (address[0] == '\0')
        return true;
    if (strspn(address, "0123456789") != strlen(address) || strlen(address) > 5)
        return false;
    unsigned long port = strtoul(address, &end, 10);
    *out_port = (uint16_t)port;
    return port >= 1 && port <= 65535;
}

/* ---- opening ---- */

static void input_close(mrt_plugin *self)
{
    if (!self->port)
        return;
    camera_port_leave(self->port, &self->listener);
    camera_port_close(self->port);
    self->port = NULL;
}

static void begin(mrt_plugin *self, const double *params)
{
    bare_hand_begin(&self->hand, params);
    self->listener.hands_wanted = 1;
    self->is_steady = false;
    self->step_count = self->step = 0;
    self->hand.reading.angle[19] = 0.12f; /* palm arch, which a camera hardly sees */
    camera_port_join(self->port, &self->listener);
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    char token[CAMERA_TOKEN + 1], package[CAMERA_PATH], reason[CAMERA_REASON] = "";
    char url[CAMERA_ADDRESS];
    input_close(self);
    if (!read_address(address, &self->number)) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.40s\" is not a port: expected a number from 1 to 65535", address);
        return MRT_ERR_ARGUMENT;
    }
    if (!bare_hand_has_reader(&self->hand))
        return MRT_ERR_UNSUPPORTED;
    if (!find_token(self, token)) {
        device_log(self->host, MRT_LOG_ERROR, "cannot get random numbers from the system");
        return MRT_ERR_IO;
    }
    find_package(package, sizeof package);
    self->port = camera_port_open(self->number, token, package, self->host, reason);
    if (!self->port) {
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    begin(self, params);
    camera_port_address(self->number, token, url);
    device_log(self->host, MRT_LOG_INFO, "open %s in a browser on this computer", url);
    char file[CAMERA_PATH + 16];
    (void)snprintf(file, sizeof file, "%s/hands.js", package);
    if (access(file, R_OK) != 0)
        device_log(self->host, MRT_LOG_WARNING,
                   "the hand tracker is not installed: press Download on the stage, or run "
                   "`marotte camera --setup` once");
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->port ? MRT_ANGLES : 0;
    return self->hand.channel;
}

/* ---- reading ---- */

/* Chooses the hand that performs; NULL: none. */
static const camera_hand *choose(const bare_hand *shown, const camera_frame *seen)
{
    const camera_hand *best = NULL;
    for (uint32_t i = 0; i < seen->hand_count; ++i) {
        const camera_hand *hand = &seen->hand[i];
        if (shown->wanted != BARE_HAND_EITHER && hand->seen.side != shown->wanted)
            continue;
        bool is_followed = shown->has_shown && hand->seen.side == shown->shown_side;
        bool best_is_followed = best && shown->has_shown && best->seen.side == shown->shown_side;
        if (!best || is_followed > best_is_followed ||
            (is_followed == best_is_followed && hand->score > best->score))
            best = hand;
    }
    return best;
}

/* Returns true if the hand is plausible, and sets `reading`. For BARE_HAND_EITHER the bend of the
 * fingers decides the side rather than the page's value. */
static bool read_hand(bare_hand *self, const camera_hand *hand, uint32_t *out_side)
{
    mrt_hand_reading now = self->reading;
    mrt_landmarks seen = hand->seen;
    self->reader->read(self->host, &seen, &now);
    if (now.confidence < BARE_HAND_SURE && self->wanted == BARE_HAND_EITHER) {
        now = self->reading;
        seen.side = seen.side == MRT_LEFT ? MRT_RIGHT : MRT_LEFT;
        self->reader->read(self->host, &seen, &now);
    }
    *out_side = seen.side;
    if (now.confidence < BARE_HAND_SURE)
        return false;
    bare_hand_turn(self, seen.side, &now);
    self->reading = now;
    return true;
}

/* Returns false if the frame moves nothing. Then the pose is held, and the face eases back when the
 * hand returns. */
static bool take_seen(mrt_plugin *self, const camera_frame *seen)
{
    float from[MRT_ANGLES];
    uint32_t side;
    bare_hand *shown = &self->hand;
    const camera_hand *hand = choose(shown, seen);
    bool was_steady = self->is_steady;
    shown->lost += seen->lost;
    self->is_steady = false;
    memcpy(from, shown->reading.angle, sizeof from);
    if (!hand || !read_hand(shown, hand, &side))
        return false;
    if (shown->has_shown && side != shown->shown_side &&
        seen->time_ns - shown->shown_ns < BARE_HAND_CHANGE_NS)
        return false;
    was_steady &= shown->has_shown && side == shown->shown_side;
    self->from_ns = self->to_ns = shown->last_ns;
    (void)device_sample_ns(self->host, seen->time_ns + shown->host_offset_ns, &self->to_ns);
    memcpy(self->from, from, sizeof from);
    int64_t gap_ns = self->to_ns - self->from_ns;
    self->step = 0;
    self->step_count = was_steady && gap_ns <= slowest_ns ? 1 + (uint32_t)(gap_ns / between_ns) : 1;
    self->is_steady = true;
    bare_hand_show(shown, side, seen->time_ns);
    return true;
}

/* Returns the next interpolation step; the last one is exactly the newest reading. */
static void give_step(mrt_plugin *self, mrt_sample *out)
{
    const bool is_there = ++self->step == self->step_count;
    const float share = (float)self->step / (float)self->step_count;
    const int64_t gap_ns = self->to_ns - self->from_ns;
    bare_hand_write_sample(
        &self->hand,
        is_there ? self->to_ns : self->from_ns + gap_ns / self->step_count * self->step, out);
    for (int i = 0; i < MRT_ANGLES && !is_there; ++i)
        out->value[i] = self->from[i] + share * (self->hand.reading.angle[i] - self->from[i]);
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (!self->port)
        return MRT_ERR_IO;
    bare_hand_follow(&self->hand, params);
    int64_t until_ns = device_deadline_ns(self->host, deadline_ns);
    for (bool has_waited = false;; has_waited = true) {
        camera_frame seen;
        while (self->step == self->step_count &&
               camera_port_pop(self->port, &self->listener, &seen) && !take_seen(self, &seen))
            ;
        if (self->step < self->step_count) {
            give_step(self, out_sample);
            return MRT_OK;
        }
        if (has_waited && device_clock_ns() + ns_per_ms / 10 >= until_ns)
            return MRT_TIMEOUT;
        if (!camera_port_wait(self->port, &self->listener, until_ns, self->host)) {
            device_log(self->host, MRT_LOG_ERROR, "port %u: %s", (unsigned)self->number,
                       strerror(errno));
            return MRT_ERR_IO;
        }
    }
}

/* ---- devices ---- */

static void fill_device(const mrt_plugin *self, mrt_device *out)
{
    char package[CAMERA_PATH], file[CAMERA_PATH + 16];
    memset(out, 0, sizeof *out);
    (void)snprintf(out->address, sizeof out->address, "%u", (unsigned)self->number);
    (void)snprintf(out->name, sizeof out->name, "Webcam, for bare hands");
    find_package(package, sizeof package);
    (void)snprintf(file, sizeof file, "%s/hands.js", package);
    /* "Open all ready inputs" must not start the camera. */
    out->state = MRT_DEVICE_UNSURE;
    (void)snprintf(
        out->advice, sizeof out->advice, "%s",
        access(file, R_OK) == 0
            ? "a page in your browser sees the hand; open the input to get its address"
            : "press \"Camera\" on the empty stage, or run `marotte camera --setup` once: "
              "it downloads the hand tracker");
}

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    glob_t found;
    bool is_there = glob("/dev/video[0-9]*", 0, NULL, &found) == 0;
    globfree(&found);
    if (!is_there)
        return 0;
    if (capacity > 0) {
        if (!self->port)
            self->number = CAMERA_PORT_USUAL;
        fill_device(self, out);
    }
    return 1;
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    if (self->port)
        fill_device(self, out);
    return self->port != NULL;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    bare_hand_init(&self->hand, host);
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    input_close(self);
    free(self);
}

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    BARE_HAND_PARAMS,
    bare_hand_params,
    interfaces,
    "org.marotte.camera",
    "Camera",
    MAROTTE_VERSION,
    "A bare hand in front of a webcam, tracked by a page in your browser",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
