#include "glove_open.h"
#include "device_io.h"

#include <stdio.h>
#include <string.h>

static const int64_t connect_limit_ms = 2000;

/* The adapter's port at which a glove is looked for, and how. */
typedef struct attempt {
    glove_drive *drive;
    const char *root;
    glove_effort effort;
    glove_why *why;
} attempt;

void glove_open_address(const glove_found *port, char *out, size_t capacity)
{
    if (port->link[0])
        snprintf(out, capacity, "serial:%s", port->link);
    else if (port->usb_path[0])
        snprintf(out, capacity, "usb:%s", port->usb_path);
    else
        snprintf(out, capacity, "serial:%s", port->path);
}

/* ---- one port ---- */

static mrt_result start(const attempt *by)
{
    glove_drive *drive = by->drive;
    mrt_result result = glove_start(&drive->port, drive->host, &drive->settings, by->effort,
                                    &drive->unit, &drive->parse, by->why);
    if (result < 0)
        glove_drive_end(drive);
    else
        glove_drive_begin(drive);
    return result;
}

static mrt_result open_path(const attempt *by, const char *path)
{
    glove_drive *drive = by->drive;
    trace_note(&drive->trace, device_clock_ns(), path);
    mrt_result result =
        glove_port_open_serial(&drive->port, path, drive->settings.baud, &drive->trace, by->why);
    return result < 0 ? result : start(by);
}

static mrt_result open_tcp(const attempt *by, const char *address)
{
    glove_drive *drive = by->drive;
    int64_t limit_ns = (int64_t)((double)(connect_limit_ms * 1000000) * drive->settings.patience);
    mrt_result result = glove_port_open_tcp(&drive->port, address, device_clock_ns() + limit_ns,
                                            &drive->trace, by->why);
    return result < 0 ? result : start(by);
}

static mrt_result open_usb(const attempt *by, const char *usb_path, glove_memory *memory)
{
    if (!glove_find_usb(by->root, usb_path, &memory->port))
        return glove_why_set(by->why, MRT_ERR_IO,
                             "nothing is plugged in at USB port %.60s: plug the glove in there",
                             usb_path);
    return open_path(by, memory->port.path);
}

/* ---- the first found ---- */

static void add_reason(glove_why *all, const char *reason)
{
    size_t used = strlen(all->text);
    snprintf(all->text + used, sizeof all->text - used, "%s%.300s", used ? "; " : "", reason);
}

/* False: the port is not to be disturbed, and why. */
static bool may_ask(const char *path, glove_why *why)
{
    char text[384];
    if (!glove_find_may_open(path)) {
        glove_find_advice(path, text, sizeof text);
        glove_why_set(why, MRT_ERR_IO, "%s: no permission: %s", path, text);
        return false;
    }
    if (glove_find_holder(path, text, sizeof text)) {
        glove_why_set(why, MRT_ERR_IO, "%s is in use by %s", path, text);
        return false;
    }
    return true;
}

static bool is_wanted_hand(const glove_drive *drive)
{
    int settings = drive->settings.hand;
    bool is_left = drive->unit.hand == MRT_LEFT;
    return settings == GLOVE_HAND_AUTO || (settings == GLOVE_HAND_LEFT) == is_left;
}

/* Among several, the side that the glove itself reports decides, not the requested one. */
static mrt_result open_found(const attempt *by, const glove_found *port)
{
    int settings = by->drive->settings.hand;
    by->drive->settings.hand = GLOVE_HAND_AUTO;
    mrt_result result = open_path(by, port->path);
    by->drive->settings.hand = settings;
    if (result < 0 || is_wanted_hand(by->drive))
        return result;
    glove_drive_end(by->drive);
    return glove_why_set(by->why, MRT_ERR_UNSUPPORTED,
                         "%s: its glove says that it is for the other hand: to use it all the "
                         "same, name it, as in serial:%s",
                         port->path, port->path);
}

static mrt_result open_first(attempt *by, glove_memory *memory)
{
    glove_found ports[GLOVE_PORTS_MAX];
    uint32_t count = glove_find_ports(by->root, ports, GLOVE_PORTS_MAX);
    glove_why reasons = {""};
    by->effort = count > 1 ? GLOVE_JUST_ASK : GLOVE_MAY_RESTART;
    for (uint32_t i = 0; i < count; ++i) {
        if (may_ask(ports[i].path, by->why) && open_found(by, &ports[i]) == MRT_OK) {
            memory->port = ports[i];
            return MRT_OK;
        }
        add_reason(&reasons, by->why->text);
    }
    if (count == 0)
        return glove_why_set(by->why, MRT_ERR_IO,
                             "no USB serial port is plugged in: connect the glove, or name its "
                             "port, as in serial:/dev/ttyS0 or tcp:192.168.1.5:3000");
    return glove_why_set(by->why, MRT_ERR_IO, "no CyberGlove was found: %s", reasons.text);
}

static mrt_result open_again(const attempt *by, glove_memory *memory)
{
    if (memory->port.usb_path[0])
        return open_usb(by, memory->port.usb_path, memory);
    return open_path(by, memory->port.path);
}

/* ---- addresses ---- */

/* A port that the person named; one that was there and is gone may be back under another name. */
static mrt_result open_named(const attempt *by, const char *path, bool is_again,
                             glove_memory *memory)
{
    glove_found now;
    bool is_there = glove_find_path(by->root, path, &now);
    if (!is_there && is_again && memory->port.usb_path[0])
        return open_usb(by, memory->port.usb_path, memory);
    mrt_result result = open_path(by, path);
    if (result < 0)
        return result;
    if (!is_there) {
        now = (glove_found){.likeliness = 0};
        snprintf(now.path, sizeof now.path, "%s", path);
    }
    memory->port = now;
    return MRT_OK;
}

static const char *after(const char *text, const char *prefix)
{
    size_t length = strlen(prefix);
    return strncmp(text, prefix, length) == 0 ? text + length : NULL;
}

static mrt_result open_address(attempt *by, const char *address, bool is_again,
                               glove_memory *memory)
{
    const char *rest;
    if (address[0] == '\0')
        return is_again ? open_again(by, memory) : open_first(by, memory);
    if ((rest = after(address, "tcp:")) != NULL)
        return open_tcp(by, rest);
    if ((rest = after(address, "usb:")) != NULL)
        return open_usb(by, rest, memory);
    rest = after(address, "serial:");
    const char *path = rest ? rest : address;
    if (path[0] == '/')
        return open_named(by, path, is_again, memory);
    return glove_why_set(by->why, MRT_ERR_ARGUMENT,
                         "\"%.80s\" is no address of a glove: expected serial:/dev/ttyUSB0, "
                         "usb:1-1.4:1.0/0, tcp:192.168.1.5:3000, or nothing to look for one",
                         address);
}

mrt_result glove_open(glove_drive *drive, const char *address, const char *root,
                      glove_memory *memory, glove_why *why)
{
    attempt by = {drive, root, GLOVE_MAY_RESTART, why};
    bool is_again = memory->has_had && strcmp(memory->address, address) == 0;
    mrt_result result = open_address(&by, address, is_again, memory);
    if (result < 0)
        return result;
    memory->has_had = true;
    snprintf(memory->address, sizeof memory->address, "%s", address);
    return MRT_OK;
}
