#include "midi_port.h"
#include "device_io.h"

#ifdef MIDI_HAS_ALSA
#include <alsa/asoundlib.h>
#endif

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

/* ---- a device of the kernel (/dev/snd/midiC1D0, /dev/midi1), a serial line or a pipe ---- */

static const char *advice(int error)
{
    switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return "it does not exist: plug it in, or list the devices with: marotte devices";
    case EACCES:
    case EPERM:
        return "you have no permission to open it: run sudo adduser $USER audio, then log in again";
    case EBUSY:
    case EAGAIN:
        return "another program uses it: close that program, or use the device's sequencer port";
    default:
        return strerror(error);
    }
}

/* Finds the sound card's name of /dev/snd/midiC1D0: "nanoKONTROL2". */
static void find_name(const char *path, char out[MIDI_PORT_NAME])
{
    static const char prefix[] = "/dev/snd/midiC";
    char file[64];
    out[0] = '\0';
    unsigned card = 0;
    if (strncmp(path, prefix, sizeof prefix - 1) != 0 ||
        sscanf(path + sizeof prefix - 1, "%3u", &card) != 1)
        return;
    (void)snprintf(file, sizeof file, "/sys/class/sound/card%u/id", card);
    device_read_line(file, out, MIDI_PORT_NAME);
}

/* Turns off the interpretation of bytes as commands on a serial line. */
static void make_plain(int descriptor)
{
    struct termios line;
    if (tcgetattr(descriptor, &line) != 0)
        return;
    cfmakeraw(&line);
    (void)tcsetattr(descriptor, TCSANOW, &line);
}

/* Returns -1 on failure, with the reason in out_reason. out_can_write: motors can be driven. A pipe
 * stays open when its writer ends and another one starts. */
static int raw_open(const char *path, char out_name[MIDI_PORT_NAME], bool *out_can_write,
                    char out_reason[MIDI_REASON])
{
    const int flags = O_NONBLOCK | O_CLOEXEC | O_NOCTTY;
    struct stat about;
    int descriptor = -1, error = 0;
    if (stat(path, &about) != 0) {
        error = errno;
    } else if (!S_ISCHR(about.st_mode) && !S_ISFIFO(about.st_mode)) {
        (void)snprintf(out_reason, MIDI_REASON,
                       "%.100s is neither a device nor a pipe: create a pipe with mkfifo and write "
                       "MIDI bytes to it",
                       path);
        return -1;
    } else {
        /* write access also for a pipe: so it always has a writer and never ends */
        descriptor = open(path, flags | O_RDWR);
        *out_can_write = descriptor >= 0 && S_ISCHR(about.st_mode);
        if (descriptor < 0 && (errno == EACCES || errno == EROFS))
            descriptor = open(path, flags | O_RDONLY);
        error = descriptor < 0 ? errno : 0;
    }
    if (descriptor < 0) {
        (void)snprintf(out_reason, MIDI_REASON, "%.100s: %s", path, advice(error));
        return -1;
    }
    if (isatty(descriptor))
        make_plain(descriptor);
    find_name(path, out_name);
    return descriptor;
}

static int raw_read(int descriptor, uint8_t *out, size_t capacity)
{
    ssize_t size = read(descriptor, out, capacity);
    if (size > 0)
        return (int)size;
    return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

static const char pattern[] = "/dev/snd/midiC*D*", old_pattern[] = "/dev/midi*";

/* Lists the old names /dev/midi* only without ALSA, because with it they are the same devices. */
static bool look(glob_t *out)
{
    if (glob(pattern, 0, NULL, out) == 0 && out->gl_pathc > 0)
        return true;
    globfree(out);
    return glob(old_pattern, 0, NULL, out) == 0;
}

/* Finds the n-th device of this computer, from 0. Returns false if there are fewer. */
static bool raw_find(uint32_t n, char out_path[32])
{
    glob_t found;
    bool is_there = look(&found) && n < found.gl_pathc;
    if (is_there)
        (void)snprintf(out_path, 32, "%s", found.gl_pathv[n]);
    globfree(&found);
    return is_there;
}

static uint32_t raw_list(mrt_device *out, uint32_t capacity)
{
    char path[32], name[MIDI_PORT_NAME];
    uint32_t count = 0;
    for (; raw_find(count, path); ++count) {
        if (count >= capacity)
            continue;
        out[count] = (mrt_device){.state = MRT_DEVICE_READY};
        find_name(path, name);
        (void)snprintf(out[count].name, sizeof out[count].name, "%s",
                       name[0] ? name : "MIDI device");
        (void)snprintf(out[count].address, sizeof out[count].address, "%s", path);
        if (access(path, R_OK) != 0) {
            out[count].state = MRT_DEVICE_DENIED;
            (void)snprintf(out[count].advice, sizeof out[count].advice, "%s", advice(EACCES));
        }
    }
    return count;
}

#ifdef MIDI_HAS_ALSA

enum { INPUT_POOL = 1000, MESSAGE = 4096 };

typedef struct midi_seq {
    snd_seq_t *seq;
    snd_midi_event_t *coder;
    int port, descriptor;
    bool wants_any; /* for "": connects to the next device that appears */
    bool is_connected;
    snd_seq_addr_t source;
} midi_seq;

static const char node[] = "/dev/snd/seq";

static bool seq_is_there(void)
{
    return access(node, R_OK | W_OK) == 0;
}

/* ---- the sequencer: other programs' ports ---- */

typedef struct found_port {
    snd_seq_addr_t at;
    bool is_device;            /* not a program's */
    char name[MIDI_PORT_NAME]; /* name of its client, and of the port if the client has several */
} found_port;

static bool can_be_heard(const snd_seq_port_info_t *port)
{
    const unsigned wanted = SND_SEQ_PORT_CAP_READ | SND_SEQ_PORT_CAP_SUBS_READ;
    const unsigned has = snd_seq_port_info_get_capability(port);
    return (has & wanted) == wanted && !(has & SND_SEQ_PORT_CAP_NO_EXPORT);
}

static void name_port(found_port *out, snd_seq_client_info_t *client,
                      const snd_seq_port_info_t *port)
{
    const char *client_name = snd_seq_client_info_get_name(client);
    const char *port_name = snd_seq_port_info_get_name(port);
    if (snd_seq_client_info_get_num_ports(client) <= 1 || !port_name)
        (void)snprintf(out->name, sizeof out->name, "%s", client_name ? client_name : "");
    else if (client_name && strncmp(client_name, port_name, strlen(client_name)) == 0)
        (void)snprintf(out->name, sizeof out->name, "%s", port_name);
    else
        (void)snprintf(out->name, sizeof out->name, "%.30s %.30s", client_name ? client_name : "",
                       port_name);
    for (char *c = out->name; *c; ++c) /* a ',' begins parameters in the text of an input */
        if ((unsigned char)*c < ' ' || *c == 0x7f || *c == ',')
            *c = ' ';
}

/* Calls `visit` for each port that can be read, until it returns true. */
static bool visit_ports(snd_seq_t *seq, bool (*visit)(const found_port *port, void *data),
                        void *data)
{
    snd_seq_client_info_t *client;
    snd_seq_port_info_t *port;
    snd_seq_client_info_alloca(&client);
    snd_seq_port_info_alloca(&port);
    snd_seq_client_info_set_client(client, -1);
    while (snd_seq_query_next_client(seq, client) >= 0) {
        const int number = snd_seq_client_info_get_client(client);
        if (number == SND_SEQ_CLIENT_SYSTEM || number == snd_seq_client_id(seq))
            continue;
        snd_seq_port_info_set_client(port, number);
        snd_seq_port_info_set_port(port, -1);
        while (snd_seq_query_next_port(seq, port) >= 0) {
            found_port found = {.at = *snd_seq_port_info_get_addr(port),
                                .is_device =
                                    snd_seq_client_info_get_type(client) == SND_SEQ_KERNEL_CLIENT};
            /* "Midi Through" returns the messages of other programs: it is not a device */
            found.is_device &= (snd_seq_port_info_get_type(port) & SND_SEQ_PORT_TYPE_HARDWARE) != 0;
            name_port(&found, client, port);
            if (can_be_heard(port) && visit(&found, data))
                return true;
        }
    }
    return false;
}

typedef struct search {
    const char *wanted;
    found_port found;
} search;

static bool is_wanted(const found_port *port, void *data)
{
    search *self = data;
    char numbers[16];
    (void)snprintf(numbers, sizeof numbers, "%u:%u", port->at.client, port->at.port);
    bool fits = self->wanted[0] == '\0' ? port->is_device
                                        : strcmp(self->wanted, numbers) == 0 ||
                                              strstr(port->name, self->wanted) != NULL;
    if (fits)
        self->found = *port;
    return fits;
}

/* ---- the sequencer: opening ---- */

static bool connect_to(midi_seq *self, const snd_seq_addr_t *source)
{
    if (snd_seq_connect_from(self->seq, self->port, source->client, source->port) < 0)
        return false;
    /* for motors; fails on a device that does not receive */
    (void)snd_seq_connect_to(self->seq, self->port, source->client, source->port);
    self->source = *source;
    self->is_connected = true;
    return true;
}

static int open_descriptor(snd_seq_t *seq)
{
    struct pollfd wanted;
    return snd_seq_poll_descriptors(seq, &wanted, 1, POLLIN) == 1 ? wanted.fd : -1;
}

static bool join(midi_seq *self)
{
    const unsigned may = SND_SEQ_PORT_CAP_WRITE | SND_SEQ_PORT_CAP_SUBS_WRITE |
                         SND_SEQ_PORT_CAP_READ | SND_SEQ_PORT_CAP_SUBS_READ;
    if (snd_seq_open(&self->seq, "default", SND_SEQ_OPEN_DUPLEX, SND_SEQ_NONBLOCK) < 0) {
        self->seq = NULL;
        return false;
    }
    (void)snd_seq_set_client_name(self->seq, "marotte");
    (void)snd_seq_set_client_pool_input(self->seq, INPUT_POOL);
    self->port = snd_seq_create_simple_port(
        self->seq, "marotte", may, SND_SEQ_PORT_TYPE_MIDI_GENERIC | SND_SEQ_PORT_TYPE_APPLICATION);
    self->descriptor = open_descriptor(self->seq);
    if (self->port < 0 || self->descriptor < 0 || snd_midi_event_new(MESSAGE, &self->coder) < 0)
        return false;
    snd_midi_event_no_status(self->coder, 1);
    /* announcements of clients that appear and disappear */
    return snd_seq_connect_from(self->seq, self->port, SND_SEQ_CLIENT_SYSTEM,
                                SND_SEQ_PORT_SYSTEM_ANNOUNCE) >= 0;
}

static void seq_close(midi_seq *self)
{
    if (!self)
        return;
    if (self->coder)
        snd_midi_event_free(self->coder);
    if (self->seq)
        (void)snd_seq_close(self->seq);
    free(self);
}

/* Creates the port "marotte" and connects the wanted port to it. Returns NULL on failure, with the
 * reason in out_reason. */
static midi_seq *seq_open(const char *wanted, char out_name[MIDI_PORT_NAME],
                          char out_reason[MIDI_REASON])
{
    midi_seq *self = calloc(1, sizeof *self);
    search sought = {.wanted = wanted};
    out_name[0] = '\0';
    if (!self || !join(self)) {
        (void)snprintf(out_reason, MIDI_REASON,
                       "cannot open the ALSA sequencer: is snd-seq loaded, and can this user open "
                       "%s (group audio)?",
                       node);
        seq_close(self);
        return NULL;
    }
    self->wants_any = wanted[0] == '\0';
    const bool is_found = visit_ports(self->seq, is_wanted, &sought);
    if (is_found && connect_to(self, &sought.found.at)) {
        (void)snprintf(out_name, MIDI_PORT_NAME, "%s", sought.found.name);
        return self;
    }
    if (!is_found && self->wants_any)
        return self;
    (void)snprintf(out_reason, MIDI_REASON,
                   is_found ? "cannot connect the MIDI port \"%.100s\": another program uses it "
                              "exclusively: close that program"
                            : "no MIDI port has the name \"%.100s\": plug it in, or list the "
                              "devices with: marotte devices",
                   wanted);
    seq_close(self);
    return NULL;
}

/* ---- the sequencer: bytes ---- */

/* Returns false if the source was lost. */
static bool take_news(midi_seq *self, const snd_seq_event_t *event)
{
    const snd_seq_addr_t *at = &event->data.addr;
    const bool is_ours =
        self->is_connected && at->client == self->source.client &&
        (event->type == SND_SEQ_EVENT_CLIENT_EXIT || at->port == self->source.port);
    if (is_ours &&
        (event->type == SND_SEQ_EVENT_CLIENT_EXIT || event->type == SND_SEQ_EVENT_PORT_EXIT))
        return false;
    if (event->type == SND_SEQ_EVENT_PORT_START && self->wants_any && !self->is_connected) {
        search sought = {.wanted = ""};
        if (visit_ports(self->seq, is_wanted, &sought))
            (void)connect_to(self, &sought.found.at);
    }
    return true;
}

static int seq_read(midi_seq *self, uint8_t *out, size_t capacity)
{
    for (;;) {
        snd_seq_event_t *event = NULL;
        int result = snd_seq_event_input(self->seq, &event);
        if (result == -EAGAIN)
            return 0;
        if (result == -ENOSPC) /* the queue overflowed: continue with the next events */
            continue;
        if (result < 0 || !event)
            return -1;
        if (event->source.client == SND_SEQ_CLIENT_SYSTEM) {
            if (!take_news(self, event))
                return -1;
            continue;
        }
        long size = snd_midi_event_decode(self->coder, out, (long)capacity, event);
        if (size > 0)
            return (int)size;
    }
}

static bool seq_write(midi_seq *self, const uint8_t *bytes, size_t size)
{
    snd_seq_event_t event;
    snd_midi_event_reset_encode(self->coder);
    while (size > 0) {
        snd_seq_ev_clear(&event);
        long used = snd_midi_event_encode(self->coder, bytes, (long)size, &event);
        if (used <= 0)
            return false;
        bytes += used;
        size -= (size_t)used;
        if (event.type == SND_SEQ_EVENT_NONE)
            continue;
        snd_seq_ev_set_source(&event, (unsigned char)self->port);
        snd_seq_ev_set_subs(&event);
        snd_seq_ev_set_direct(&event);
        if (snd_seq_event_output_direct(self->seq, &event) < 0)
            return false;
    }
    return true;
}

/* ---- the sequencer: the list ---- */

typedef struct listing {
    mrt_device *out;
    uint32_t count, capacity;
} listing;

/* The address is the name, which stays the same after reconnecting; the numbers if several ports
 * have the same name. */
static bool list_port(const found_port *port, void *data)
{
    listing *self = data;
    if (!port->is_device)
        return false;
    if (self->count < self->capacity) {
        mrt_device *out = &self->out[self->count];
        *out = (mrt_device){.state = MRT_DEVICE_READY};
        (void)snprintf(out->name, sizeof out->name, "%s", port->name);
        (void)snprintf(out->address, sizeof out->address, "%s", port->name);
        for (uint32_t i = 0; i < self->count; ++i)
            if (strstr(self->out[i].name, port->name))
                (void)snprintf(out->address, sizeof out->address, "%u:%u", port->at.client,
                               port->at.port);
    }
    self->count += 1;
    return false;
}

static uint32_t seq_list(mrt_device *out, uint32_t capacity)
{
    snd_seq_t *seq;
    listing made = {out, 0, capacity};
    if (!seq_is_there() || snd_seq_open(&seq, "default", SND_SEQ_OPEN_INPUT, 0) < 0)
        return 0;
    (void)visit_ports(seq, list_port, &made);
    (void)snd_seq_close(seq);
    return made.count;
}

#else

typedef struct midi_seq {
    int descriptor;
} midi_seq;

static bool seq_is_there(void)
{
    return false;
}

static midi_seq *seq_open(const char *wanted, char out_name[MIDI_PORT_NAME],
                          char out_reason[MIDI_REASON])
{
    (void)wanted;
    out_name[0] = out_reason[0] = '\0';
    return NULL;
}

static void seq_close(midi_seq *self)
{
    (void)self;
}

static int seq_read(midi_seq *self, uint8_t *out, size_t capacity)
{
    (void)self;
    (void)out;
    (void)capacity;
    return -1;
}

static bool seq_write(midi_seq *self, const uint8_t *bytes, size_t size)
{
    (void)self;
    (void)bytes;
    (void)size;
    return false;
}

static uint32_t seq_list(mrt_device *out, uint32_t capacity)
{
    (void)out;
    (void)capacity;
    return 0;
}

#endif

/* ---- either ---- */

void midi_port_init(midi_port *self)
{
    *self = (midi_port){.descriptor = -1};
}

/* Only a kernel device if there is no sequencer. */
bool midi_port_open(midi_port *self, const char *wanted, char out_name[MIDI_PORT_NAME],
                    char out_reason[MIDI_REASON])
{
    char path[32];
    if (!strchr(wanted, '/') && seq_is_there()) {
        self->seq = seq_open(wanted, out_name, out_reason);
        self->descriptor = self->seq ? self->seq->descriptor : -1;
        self->can_write = self->seq != NULL;
        return self->can_write;
    }
    if (wanted[0] == '\0' && raw_find(0, path))
        wanted = path;
    if (!strchr(wanted, '/')) {
        (void)snprintf(out_reason, MIDI_REASON,
                       "%s%.100s%s: this system has no MIDI sequencer (/dev/snd/seq): name a "
                       "device or a pipe, as in midi:/dev/snd/midiC1D0",
                       wanted[0] ? "\"" : "no MIDI device found", wanted, wanted[0] ? "\"" : "");
        return false;
    }
    self->descriptor = raw_open(wanted, out_name, &self->can_write, out_reason);
    return self->descriptor >= 0;
}

void midi_port_close(midi_port *self)
{
    if (self->seq)
        seq_close(self->seq);
    else if (self->descriptor >= 0)
        close(self->descriptor);
    midi_port_init(self);
}

int midi_port_read(midi_port *self, uint8_t *out, size_t capacity)
{
    return self->seq ? seq_read(self->seq, out, capacity)
                     : raw_read(self->descriptor, out, capacity);
}

bool midi_port_write(midi_port *self, const uint8_t *bytes, size_t size)
{
    return self->seq ? seq_write(self->seq, bytes, size)
                     : write(self->descriptor, bytes, size) == (ssize_t)size;
}

uint32_t midi_port_list(mrt_device *out, uint32_t capacity)
{
    return seq_is_there() ? seq_list(out, capacity) : raw_list(out, capacity);
}
