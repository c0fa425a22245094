/* window/panels/devices.h - how an input is doing, in the words and figures of the devices
 * panel; and which of the devices that are plugged in are open. Pure. */
#ifndef MAROTTE_UI_WINDOW_PANELS_DEVICES_H
#define MAROTTE_UI_WINDOW_PANELS_DEVICES_H
#include "stage/input/device_list.h"
#include "stage/input/health.h"

typedef enum devices_light {
    DEVICES_OVER = 0, /* it has ended, as it should */
    DEVICES_WELL,
    DEVICES_WAITS, /* away, silent: comes back by itself */
    DEVICES_FAILED
} devices_light;

enum { DEVICES_WORDS = 256, DEVICES_FACTS_MAX = 10 };

/* One or two lines: "running", "away for 3 s, tried again", "failed". out_why: what is known of the
 * reason; "". */
devices_light devices_words_state(const health_report *health, char out[DEVICES_WORDS],
                                  char out_why[DEVICES_WORDS]);

typedef struct devices_fact {
    const char *label;
    char value[96];
    const char *help;
    bool is_odd; /* worth a look */
} devices_fact;
/* Rate, jitter, lateness, what was lost, drift. Returns how many. */
uint32_t devices_words_facts(const health_report *health, devices_fact out[DEVICES_FACTS_MAX]);
/* "index MPJ, palm arch": channels that stand at an end of their range; "" none. Returns how many.
 */
uint32_t devices_words_saturated(const health_report *health, const mrt_channel *channels,
                                 uint32_t count, char out[DEVICES_WORDS]);

/* Whether an input that was opened as "PLUGIN:ADDRESS,..." holds this device. An input without an
 * address has the first of its plugin: is_first. */
bool devices_is_open(const char *input_text, const device_found *device, bool is_first);
/* "cyberglove:/dev/ttyUSB0"; false: the address cannot be written like that. */
bool devices_input_text(const device_found *device, char *out, size_t capacity);

#endif
