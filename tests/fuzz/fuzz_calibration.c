/* A user's calibration, and one of VirtualHand: whatever the bytes are, they are read or refused
 * with a reason, what was read can be used, and what is written reads the same. */
#include "hand/calibration_file.h"
#include "hand/virtualhand.h"

#include "fuzz_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static void check_refusal(const calibration_file *file, const error *err)
{
    require(fuzz_is_reason(err->text), "one line of reason");
    require(!file->document && calibration_file_sensor_count(file) == 0, "nothing is left");
}

static void check_use(const calibration_file *file)
{
    hand_calibration use;
    float raw[MRT_ANGLES], rad[MRT_ANGLES];
    calibration_file_use(file, &use);
    require(fuzz_is_shown(file->name) && fuzz_is_shown(file->date), "names are shown");
    require(file->side <= MRT_RIGHT && memchr(file->name, 0, sizeof file->name) != NULL, "a name");
    for (int value = -1; value < 257; value += 43) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            raw[i] = value < 0 ? NAN : (float)value;
        hand_calibrate(&use, raw, rad);
        for (int i = 0; i < MRT_ANGLES; ++i)
            require(isfinite(rad[i]) && fabsf(rad[i]) < 3.2f && isfinite(use.neutral_rad[i]),
                    "angles are angles");
    }
}

/* Written, read and written again: the same text. */
static void check_round_trip(const calibration_file *file)
{
    calibration_file again;
    error err = {""};
    char *text = calibration_file_text(file);
    require(text != NULL, "a text");
    mrt_result result = calibration_file_parse(&again, text, strlen(text), "again", &err);
    /* Raw values that differ in their last bit may become one in seven digits. */
    require(result == MRT_OK || strstr(err.text, "above the one before"), "it reads again");
    if (result == MRT_OK) {
        char *twice = calibration_file_text(&again);
        require(twice && strcmp(text, twice) == 0, "it is written the same");
        free(twice);
    }
    calibration_file_finish(&again);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    calibration_file file;
    error err = {""};
    if (calibration_file_parse(&file, data, size, "fuzz.json", &err) < 0) {
        check_refusal(&file, &err);
    } else {
        check_use(&file);
        check_round_trip(&file);
        calibration_file_finish(&file);
    }
    err.text[0] = '\0';
    uint32_t side = size % 2 ? MRT_RIGHT : MRT_NO_HAND;
    if (virtualhand_parse(&file, data, size, "fuzz.cal", side, &err) < 0) {
        check_refusal(&file, &err);
    } else {
        check_use(&file);
        check_round_trip(&file);
    }
    return 0;
}
