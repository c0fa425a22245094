#include "evdev.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

enum { PATH = 96, LINE = 512, FOLDER_CAP = 4096 };
static const char folder[] = "/sys/class/input";

/* ---- /sys ---- */

/* One line without its end; control characters, which a device may well have in its name, and the
 * ',' that begins parameters are blanks. "" if there is none. */
static void read_line(uint32_t number, const char *file, char *out, size_t capacity)
{
    char path[PATH];
    out[0] = '\0';
    (void)snprintf(path, sizeof path, "%s/event%u/device/%s", folder, number, file);
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return;
    ssize_t size = read(descriptor, out, capacity - 1);
    close(descriptor);
    out[size > 0 ? size : 0] = '\0';
    out[strcspn(out, "\n")] = '\0';
    for (char *c = out; *c; ++c)
        if ((unsigned char)*c < ' ' || *c == 0x7f || *c == ',')
            *c = ' ';
}

/* "7cdb000000000000 0 0 0 0": words of a long each, the lowest last. */
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

static void find_identity(evdev_seen *out)
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

static bool see(evdev_seen *out, uint32_t number)
{
    char vendor[16];
    uint8_t axes[PAD_AXES / 8];
    *out = (evdev_seen){.number = number};
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

uint32_t evdev_look(evdev_seen out[EVDEV_SEEN])
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
    for (uint32_t i = 0; i < number_count && count < EVDEV_SEEN; ++i)
        count += see(&out[count], number[i]);
    return count;
}

/* ---- one that is open ---- */

bool evdev_read_state(int descriptor, const pad_model *model, pad_state *out)
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

int evdev_open(evdev_seen *seen, pad_state *out_state)
{
    const int clock = CLOCK_MONOTONIC;
    int descriptor = open(seen->node, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor < 0)
        return -1;
    for (uint32_t i = 0; i < PAD_AXES; ++i) {
        struct input_absinfo about = {0};
        pad_axis *axis = &seen->model.axis[i];
        if (axis->is_there && ioctl(descriptor, EVIOCGABS(i), &about) >= 0)
            *axis = (pad_axis){true, about.minimum, about.maximum};
    }
    if (ioctl(descriptor, EVIOCSCLOCKID, &clock) >= 0 &&
        evdev_read_state(descriptor, &seen->model, out_state))
        return descriptor;
    int error = errno;
    close(descriptor);
    errno = error;
    return -1;
}

void evdev_close(int descriptor)
{
    if (descriptor >= 0)
        close(descriptor);
}

int evdev_read(int descriptor, struct input_event *out, uint32_t capacity)
{
    ssize_t size = read(descriptor, out, capacity * sizeof *out);
    if (size >= (ssize_t)sizeof *out)
        return (int)((size_t)size / sizeof *out);
    return size < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}
