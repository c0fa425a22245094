/* window/panels/devices.h - state and statistics of an input as text for the devices panel, and
 * matching of connected devices with open inputs. Pure. */
#ifndef MAROTTE_UI_WINDOW_PANELS_DEVICES_H
#define MAROTTE_UI_WINDOW_PANELS_DEVICES_H
#include "stage/input/device_list.h"
#include "stage/input/health.h"

typedef enum devices_light {
    DEVICES_OVER = 0, /* ended normally */
    DEVICES_WELL,
    DEVICES_WAITS, /* disconnected or silent; retried automatically */
    DEVICES_FAILED
} devices_light;

enum { DEVICES_WORDS = 256, DEVICES_FACTS_MAX = 10 };

/* Describes the state in one or two lines: "running", "disconnected for 3 s, retrying", "failed".
 * out_why: the reason if known, else "". */
devices_light devices_words_state(const health_report *health, char out[DEVICES_WORDS],
                                  char out_why[DEVICES_WORDS]);

typedef struct devices_fact {
    const char *label;
    char value[96];
    const char *help;
    bool is_odd; /* out of the normal range */
} devices_fact;
/* Writes rate, jitter, lateness, losses and drift. Returns the number of facts. */
uint32_t devices_words_facts(const health_report *health, devices_fact out[DEVICES_FACTS_MAX]);
/* Writes the names of the channels at an end of their range, such as "index MPJ, palm arch", or "".
 * Returns the number of these channels. */
uint32_t devices_words_saturated(const health_report *health, const mrt_channel *channels,
                                 uint32_t count, char out[DEVICES_WORDS]);

/* Returns whether an input that was opened as "PLUGIN:ADDRESS,..." uses this device. An input
 * without an address uses the first device of its plugin (is_first). */
bool devices_is_open(const char *input_text, const device_found *device, bool is_first);
/* Writes "cyberglove:/dev/ttyUSB0". Returns false if the address contains a comma or does not fit.
 */
bool devices_input_text(const device_found *device, char *out, size_t capacity);

#endif
