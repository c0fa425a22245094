#include "system.h"

#include "device_io.h"
#include "layouts.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- information from the system ---- */

enum { FILE_PATH = 400, FOLDER_CAP = 4096, NODE = 32, HOLDER = 64 };
static const char devices_folder[] = "/sys/bus/usb/devices";

/* ---- names and folders ---- */

void system_product(char out[SYSTEM_NAME], const char *path)
{
    char file[FILE_PATH];
    snprintf(file, sizeof file, "%s/%s/product", devices_folder, path);
    device_read_line(file, out, SYSTEM_NAME);
}

/* Returns the folder of an interface in the active configuration: ".../1-2:1.0". */
static void interface_folder(char out[FILE_PATH], const char *path, uint8_t interface_number)
{
    char file[FILE_PATH], configuration[8];
    snprintf(file, sizeof file, "%s/%s/bConfigurationValue", devices_folder, path);
    device_read_line(file, configuration, sizeof configuration);
    snprintf(out, FILE_PATH, "%s/%s:%s.%u", devices_folder, path, configuration, interface_number);
}

/* ---- drivers ---- */

/* The HID driver's folder is below the interface's: "0003:VENDOR:PRODUCT.NUMBER". */
size_t system_descriptor(const char *path, uint8_t interface_number, uint8_t *out, size_t capacity)
{
    char folder[FILE_PATH], file[FILE_PATH + 300];
    interface_folder(folder, path, interface_number);
    DIR *listing = opendir(folder);
    size_t size = 0;
    if (!listing)
        return 0;
    const struct dirent *entry;
    for (int i = 0; size == 0 && i < FOLDER_CAP && (entry = readdir(listing)) != NULL; ++i) {
        if (strncmp(entry->d_name, "0003:", 5) != 0)
            continue;
        snprintf(file, sizeof file, "%s/%s/report_descriptor", folder, entry->d_name);
        size = device_read_file(file, out, capacity);
    }
    closedir(listing);
    return size;
}

bool system_is_claimed(const char *path, uint8_t interface_number)
{
    char folder[FILE_PATH], file[FILE_PATH + 16], driver[256];
    interface_folder(folder, path, interface_number);
    snprintf(file, sizeof file, "%s/driver", folder);
    ssize_t length = readlink(file, driver, sizeof driver - 1);
    if (length <= 0)
        return false;
    driver[length] = '\0';
    const char *slash = strrchr(driver, '/');
    return strcmp(slash ? slash + 1 : driver, "usbfs") == 0;
}

/* ---- the node ---- */

/* "/dev/bus/usb/001/002" */
static void find_node(char out[NODE], const usb_device *device)
{
    snprintf(out, NODE, "/dev/bus/usb/%03u/%03u", device->bus, device->number);
}

bool system_can_open(const usb_device *device)
{
    char node[NODE];
    find_node(node, device);
    return access(node, R_OK | W_OK) == 0;
}

static bool has_open(const char *process, const struct stat *node)
{
    char folder[FILE_PATH], file[FILE_PATH + 300];
    struct stat status;
    snprintf(folder, sizeof folder, "/proc/%.20s/fd", process);
    DIR *listing = opendir(folder);
    bool has = false;
    if (!listing)
        return false;
    const struct dirent *entry;
    for (int i = 0; !has && i < FOLDER_CAP && (entry = readdir(listing)) != NULL; ++i) {
        snprintf(file, sizeof file, "%s/%s", folder, entry->d_name);
        has = entry->d_name[0] != '.' && stat(file, &status) == 0 &&
              status.st_dev == node->st_dev && status.st_ino == node->st_ino;
    }
    closedir(listing);
    return has;
}

static void name_process(char out[HOLDER], const char *process)
{
    char file[FILE_PATH], name[32];
    snprintf(file, sizeof file, "/proc/%.20s/comm", process);
    device_read_line(file, name, sizeof name);
    snprintf(out, HOLDER, "%s (process %.20s)", name[0] ? name : "a program", process);
}

/* Finds the program that has the node open: "mplayer (process 1234)". Returns false if this user
 * cannot see one. */
static bool find_holder(char out[HOLDER], const usb_device *device)
{
    char node[NODE];
    struct stat status;
    find_node(node, device);
    out[0] = '\0';
    DIR *listing = stat(node, &status) == 0 ? opendir("/proc") : NULL;
    if (!listing)
        return false;
    const struct dirent *entry;
    bool found = false;
    for (int i = 0; !found && i < FOLDER_CAP && (entry = readdir(listing)) != NULL; ++i) {
        if (entry->d_name[0] < '1' || entry->d_name[0] > '9' || !has_open(entry->d_name, &status))
            continue;
        name_process(out, entry->d_name);
        found = true;
    }
    closedir(listing);
    return found;
}

/* ---- advice ---- */

#define RELOAD "sudo udevadm control --reload && sudo udevadm trigger, and plug it in again"

void advice_denied(char out[ADVICE_TEXT], const usb_device *device)
{
    char node[NODE];
    find_node(node, device);
    snprintf(out, ADVICE_TEXT,
             "you have no permission to use %s: add SUBSYSTEM==\"usb\", "
             "ATTRS{idVendor}==\"%04x\", ATTRS{idProduct}==\"%04x\", TAG+=\"uaccess\" as a "
             "line to /etc/udev/rules.d/70-marotte.rules, then run " RELOAD,
             node, device->vendor, device->product);
}

void advice_busy(char out[ADVICE_TEXT], const usb_device *device)
{
    char holder[HOLDER];
    if (find_holder(holder, device))
        snprintf(out, ADVICE_TEXT, "in use by %s: close that program, or stop its use of the pedal",
                 holder);
    else
        snprintf(out, ADVICE_TEXT,
                 "in use by another user's program: close it (sudo fuser -v /dev/bus/usb/%03u/%03u "
                 "names it)",
                 device->bus, device->number);
}

void advice_unknown(char out[ADVICE_TEXT], const usb_device *device)
{
    snprintf(out, ADVICE_TEXT,
             "not a known pedal: if it is a pedal, teach its switches with marotte devices --learn "
             "pedal:usb:%s",
             device->path);
}

void advice_no_endpoint(char out[ADVICE_TEXT], const usb_device *device)
{
    snprintf(out, ADVICE_TEXT,
             "usb:%04x:%04x has no HID interface with reports: it is not a pedal, or it is "
             "damaged. Name another device",
             device->vendor, device->product);
}
