#include "midi_raw.h"

#include <errno.h>
#include <fcntl.h>
#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

/* ---- opening ---- */

static const char *advice(int error)
{
    switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return "nothing is there: plug it in, or see what there is with: marotte devices";
    case EACCES:
    case EPERM:
        return "you may not open it: sudo adduser $USER audio, then log in again";
    case EBUSY:
    case EAGAIN:
        return "another program has it: end that, or name it as a port of the sequencer";
    default:
        return strerror(error);
    }
}

/* Of /dev/snd/midiC1D0 the sound card's own name: "nanoKONTROL2". */
static void find_name(const char *path, char out[MIDI_RAW_NAME])
{
    static const char prefix[] = "/dev/snd/midiC";
    char file[64];
    out[0] = '\0';
    unsigned card = 0;
    if (strncmp(path, prefix, sizeof prefix - 1) != 0 ||
        sscanf(path + sizeof prefix - 1, "%3u", &card) != 1)
        return;
    (void)snprintf(file, sizeof file, "/sys/class/sound/card%u/id", card);
    FILE *from = fopen(file, "re");
    if (!from)
        return;
    if (!fgets(out, MIDI_RAW_NAME, from))
        out[0] = '\0';
    (void)fclose(from);
    out[strcspn(out, "\n")] = '\0';
}

/* A serial line must not take bytes for commands. */
static void make_plain(int descriptor)
{
    struct termios line;
    if (tcgetattr(descriptor, &line) != 0)
        return;
    cfmakeraw(&line);
    (void)tcsetattr(descriptor, TCSANOW, &line);
}

int midi_raw_open(const char *path, char out_name[MIDI_RAW_NAME], bool *out_can_write,
                  char out_reason[MIDI_RAW_REASON])
{
    const int flags = O_NONBLOCK | O_CLOEXEC | O_NOCTTY;
    struct stat about;
    int descriptor = -1, error = 0;
    if (stat(path, &about) != 0) {
        error = errno;
    } else if (!S_ISCHR(about.st_mode) && !S_ISFIFO(about.st_mode)) {
        (void)snprintf(out_reason, MIDI_RAW_REASON,
                       "%.100s is neither a device nor a pipe: make one with mkfifo, and send "
                       "MIDI bytes into it",
                       path);
        return -1;
    } else {
        /* of a pipe too: it then has a writer always, and never ends */
        descriptor = open(path, flags | O_RDWR);
        *out_can_write = descriptor >= 0 && S_ISCHR(about.st_mode);
        if (descriptor < 0 && (errno == EACCES || errno == EROFS))
            descriptor = open(path, flags | O_RDONLY);
        error = descriptor < 0 ? errno : 0;
    }
    if (descriptor < 0) {
        (void)snprintf(out_reason, MIDI_RAW_REASON, "%.100s: %s", path, advice(error));
        return -1;
    }
    if (isatty(descriptor))
        make_plain(descriptor);
    find_name(path, out_name);
    return descriptor;
}

void midi_raw_close(int descriptor)
{
    if (descriptor >= 0)
        close(descriptor);
}

/* ---- bytes ---- */

int midi_raw_read(int descriptor, uint8_t *out, size_t capacity)
{
    ssize_t size = read(descriptor, out, capacity);
    if (size > 0)
        return (int)size;
    return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

bool midi_raw_write(int descriptor, const uint8_t *bytes, size_t size)
{
    return write(descriptor, bytes, size) == (ssize_t)size;
}

/* ---- what there is ---- */

static const char pattern[] = "/dev/snd/midiC*D*", old_pattern[] = "/dev/midi*";

/* Those of before ALSA are the same devices once more, if ALSA is there. */
static bool look(glob_t *out)
{
    if (glob(pattern, 0, NULL, out) == 0 && out->gl_pathc > 0)
        return true;
    globfree(out);
    return glob(old_pattern, 0, NULL, out) == 0;
}

bool midi_raw_find(uint32_t n, char out_path[32])
{
    glob_t found;
    bool is_there = look(&found) && n < found.gl_pathc;
    if (is_there)
        (void)snprintf(out_path, 32, "%s", found.gl_pathv[n]);
    globfree(&found);
    return is_there;
}

uint32_t midi_raw_list(mrt_device *out, uint32_t capacity)
{
    char path[32], name[MIDI_RAW_NAME];
    uint32_t count = 0;
    for (; midi_raw_find(count, path); ++count) {
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
