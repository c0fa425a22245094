#include "advice.h"
#include "layouts.h"
#include "system.h"

#include <stdio.h>

#define RELOAD "sudo udevadm control --reload && sudo udevadm trigger, and plug it in again"

void advice_denied(char out[ADVICE_TEXT], const usb_seen *device)
{
    char node[SYSTEM_NODE];
    system_node(node, device);
    if (layouts_find(device->vendor, device->product))
        snprintf(out, ADVICE_TEXT,
                 "you may not use %s: sudo cp plugins/pedal/70-marotte.rules /etc/udev/rules.d/ "
                 "&& " RELOAD,
                 node);
    else
        snprintf(out, ADVICE_TEXT,
                 "you may not use %s: add SUBSYSTEM==\"usb\", ATTRS{idVendor}==\"%04x\", "
                 "ATTRS{idProduct}==\"%04x\", TAG+=\"uaccess\" as a line to "
                 "/etc/udev/rules.d/70-marotte.rules, then " RELOAD,
                 node, device->vendor, device->product);
}

void advice_busy(char out[ADVICE_TEXT], const usb_seen *device)
{
    char holder[SYSTEM_HOLDER];
    if (system_holder(holder, device))
        snprintf(out, ADVICE_TEXT, "in use by %s: end that program, or its use of the pedal",
                 holder);
    else
        snprintf(out, ADVICE_TEXT,
                 "in use by another user's program: end it (sudo fuser -v /dev/bus/usb/%03u/%03u "
                 "names it)",
                 device->bus, device->number);
}

void advice_unknown(char out[ADVICE_TEXT], const usb_seen *device)
{
    snprintf(out, ADVICE_TEXT,
             "not a pedal that is known: if it is one, teach its switches with "
             "marotte devices --learn pedal:usb:%s",
             device->path);
}

void advice_no_endpoint(char out[ADVICE_TEXT], const usb_seen *device)
{
    snprintf(out, ADVICE_TEXT,
             "usb:%04x:%04x has no HID interface that reports: it is no pedal, or it is damaged: "
             "name another device",
             device->vendor, device->product);
}
