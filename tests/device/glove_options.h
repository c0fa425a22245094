/* device/glove_options.h - the settings of the emulated glove as words: "--sensors", "18". */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_OPTIONS_H
#define MAROTTE_TESTS_DEVICE_GLOVE_OPTIONS_H
#include "glove_emulator.h"

/* words: NULL-ended; they outlive the settings. Settings without a word stay as they are. */
CHECKED mrt_result glove_options_read(const char *const *words, glove_settings *out, error *err);
void glove_options_print(void); /* one line each */

#endif
