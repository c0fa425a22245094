#include "glove_find.h"
#include "device_io.h"

#include <ctype.h>
#include <dirent.h>
#include <grp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const tty_folder = "/sys/class/tty";
static const char *const link_folder = "/dev/serial/by-path";
static const char *const vendor_of_adapters[] = {"0403", "067b"}; /* FTDI, Prolific */

static void read_line(const char *folder, const char *name, char *out, size_t capacity)
{
    char path[PATH_CAPACITY + 32];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    device_read_line(path, out, capacity);
}

/* Cuts `path` after the component of a USB interface: "1-1.4:1.0". */
static bool cut_at_interface(char *path, const char **out_name)
{
    for (char *slash = strrchr(path, '/'); slash; slash = strrchr(path, '/')) {
        if (isdigit((unsigned char)slash[1]) && strchr(slash, '-') && strchr(slash, ':')) {
            *out_name = slash + 1;
            return true;
        }
        *slash = '\0';
    }
    return false;
}

static uint32_t likeliness_of(const char *device, const char *product)
{
    char maker[64], vendor[16];
    read_line(device, "manufacturer", maker, sizeof maker);
    read_line(device, "idVendor", vendor, sizeof vendor);
    for (const char *at = product; *at; ++at)
        if (strncasecmp(at, "glove", 5) == 0)
            return 2;
    if (strncasecmp(maker, "CyberGlove", 10) == 0 || strncasecmp(maker, "Immersion", 9) == 0)
        return 2;
    for (size_t i = 0; i < sizeof vendor_of_adapters / sizeof *vendor_of_adapters; ++i)
        if (strcmp(vendor, vendor_of_adapters[i]) == 0)
            return 1;
    return 0;
}

/* Reads the USB port and the product name from /sys/class/tty/NAME/device. */
static void describe(const char *root, const char *name, glove_found *out)
{
    char folder[PATH_CAPACITY], real[PATH_CAPACITY], number[16];
    const char *interface;
    snprintf(folder, sizeof folder, "%s%s/%s/device", root, tty_folder, name);
    read_line(folder, "port_number", number, sizeof number);
    glove_find_real(folder, real, sizeof real);
    if (!cut_at_interface(real, &interface))
        return;
    snprintf(out->usb_path, sizeof out->usb_path, "%.40s%s%.8s", interface, number[0] ? "/" : "",
             number);
    char *slash = strrchr(real, '/');
    *slash = '\0'; /* the device of the interface */
    read_line(real, "product", out->product, sizeof out->product);
    out->likeliness = likeliness_of(real, out->product);
}

/* Chooses the first of several links in alphabetical order, without those that are too long for an
 * address. */
static void take_better_link(const char *path, glove_found *out)
{
    size_t length = strlen(path);
    if (length >= sizeof out->link || (out->link[0] && strcmp(path, out->link) > 0))
        return;
    memcpy(out->link, path, length + 1);
}

static void find_link(const char *root, glove_found *out)
{
    char folder[PATH_CAPACITY], wanted[PATH_CAPACITY], real[PATH_CAPACITY];
    snprintf(folder, sizeof folder, "%s%s", root, link_folder);
    glove_find_real(out->path, wanted, sizeof wanted);
    DIR *links = opendir(folder);
    if (!links)
        return;
    const struct dirent *entry;
    while ((entry = readdir(links)) != NULL) {
        char path[sizeof folder + sizeof entry->d_name];
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        glove_find_real(path, real, sizeof real);
        if (entry->d_name[0] != '.' && strcmp(real, wanted) == 0)
            take_better_link(path, out);
    }
    closedir(links);
}

static int by_likeliness(const void *left, const void *right)
{
    const glove_found *a = left, *b = right;
    if (a->likeliness != b->likeliness)
        return a->likeliness > b->likeliness ? -1 : 1;
    int order = strcmp(a->usb_path, b->usb_path);
    return order ? order : strcmp(a->path, b->path);
}

uint32_t glove_find_ports(const char *root, glove_found *out, uint32_t capacity)
{
    char folder[PATH_CAPACITY];
    snprintf(folder, sizeof folder, "%s%s", root, tty_folder);
    DIR *names = opendir(folder);
    if (!names)
        return 0;
    uint32_t count = 0;
    const struct dirent *entry;
    while (count < capacity && (entry = readdir(names)) != NULL) {
        const char *name = entry->d_name;
        if ((strncmp(name, "ttyUSB", 6) != 0 && strncmp(name, "ttyACM", 6) != 0) ||
            strlen(name) > 32)
            continue;
        glove_found *found = &out[count++];
        *found = (glove_found){.likeliness = 0};
        snprintf(found->path, sizeof found->path, "%.80s/dev/%.32s", root, name);
        describe(root, name, found);
        find_link(root, found);
    }
    closedir(names);
    qsort(out, count, sizeof *out, by_likeliness);
    return count;
}

bool glove_find_usb(const char *root, const char *usb_path, glove_found *out)
{
    glove_found ports[GLOVE_PORTS_MAX];
    uint32_t count = glove_find_ports(root, ports, GLOVE_PORTS_MAX);
    for (uint32_t i = 0; i < count; ++i)
        if (usb_path[0] && strcmp(ports[i].usb_path, usb_path) == 0) {
            *out = ports[i];
            return true;
        }
    return false;
}

bool glove_find_path(const char *root, const char *path, glove_found *out)
{
    glove_found ports[GLOVE_PORTS_MAX];
    char wanted[PATH_CAPACITY], real[PATH_CAPACITY];
    uint32_t count = glove_find_ports(root, ports, GLOVE_PORTS_MAX);
    glove_find_real(path, wanted, sizeof wanted);
    for (uint32_t i = 0; i < count; ++i) {
        glove_find_real(ports[i].path, real, sizeof real);
        if (strcmp(real, wanted) == 0) {
            *out = ports[i];
            return true;
        }
    }
    return false;
}

void glove_find_real(const char *path, char *out, size_t capacity)
{
    char *real = realpath(path, NULL);
    const char *found = real ? real : path;
    size_t length = strlen(found) < capacity ? strlen(found) : capacity - 1;
    memcpy(out, found, length);
    out[length] = '\0';
    free(real);
}

/* Reasons why a port cannot be used: the process that has it open, and its owner. */

enum { GROUP_TEXT = 2048 };

/* Returns true if one of the process's descriptors refers to this file. `own`: a descriptor to
 * ignore; -1: none. */
static bool has_open(const char *process, const char *real, int own)
{
    char folder[64], target[PATH_CAPACITY];
    snprintf(folder, sizeof folder, "/proc/%.20s/fd", process);
    DIR *files = opendir(folder);
    if (!files)
        return false;
    bool found = false;
    const struct dirent *entry;
    while (!found && (entry = readdir(files)) != NULL) {
        if (!isdigit((unsigned char)entry->d_name[0]) ||
            (own >= 0 && strtol(entry->d_name, NULL, 10) == own))
            continue;
        ssize_t length = readlinkat(dirfd(files), entry->d_name, target, sizeof target - 1);
        if (length <= 0)
            continue;
        target[length] = '\0';
        found = strcmp(target, real) == 0;
    }
    closedir(files);
    return found;
}

static void name_process(const char *process, char *out, size_t capacity)
{
    char path[64], name[32];
    snprintf(path, sizeof path, "/proc/%.20s/comm", process);
    device_read_line(path, name, sizeof name);
    snprintf(out, capacity, "%s (process %.20s)", name[0] ? name : "a program", process);
}

/* The creator of a pseudo terminal has both its ends open, so it does not count as the user of the
 * port. */
static bool may_have_made(const char *process, const char *real)
{
    return strncmp(real, "/dev/pts/", 9) == 0 &&
           (has_open(process, "/dev/ptmx", -1) || has_open(process, "/dev/pts/ptmx", -1));
}

bool glove_find_other_holder(const char *path, int own, char *out, size_t capacity)
{
    char real[PATH_CAPACITY], self[24];
    out[0] = '\0';
    glove_find_real(path, real, sizeof real);
    snprintf(self, sizeof self, "%ld", (long)getpid());
    DIR *processes = opendir("/proc");
    if (!processes)
        return false;
    bool found = false, is_sure = false;
    const struct dirent *entry;
    while (!is_sure && (entry = readdir(processes)) != NULL) {
        bool is_self = strcmp(entry->d_name, self) == 0;
        if (!isdigit((unsigned char)entry->d_name[0]) ||
            !has_open(entry->d_name, real, is_self ? own : -1))
            continue;
        found = true;
        is_sure = !may_have_made(entry->d_name, real);
        if (is_self)
            snprintf(out, capacity, "marotte itself, as another input");
        else
            name_process(entry->d_name, out, capacity);
    }
    closedir(processes);
    return found;
}

bool glove_find_holder(const char *path, char *out, size_t capacity)
{
    return glove_find_other_holder(path, -1, out, capacity);
}

bool glove_find_can_open(const char *path)
{
    return access(path, R_OK | W_OK) == 0;
}

void glove_find_advice(const char *path, char *out, size_t capacity)
{
    struct stat about;
    struct group entry, *group = NULL;
    char text[GROUP_TEXT];
    if (stat(path, &about) != 0 || getgrgid_r(about.st_gid, &entry, text, sizeof text, &group) != 0)
        group = NULL;
    if (group && (about.st_mode & S_IRGRP) && (about.st_mode & S_IWGRP) && about.st_gid != 0)
        snprintf(out, capacity,
                 "it belongs to the group \"%.32s\": run \"sudo usermod -aG %.32s $USER\" and log "
                 "in again",
                 group->gr_name, group->gr_name);
    else
        snprintf(out, capacity,
                 "only its owner can open it: run \"sudo chmod a+rw %.96s\", or add a udev rule",
                 path);
}
