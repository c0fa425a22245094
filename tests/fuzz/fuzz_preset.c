/* A preset's name and text, as a settings file has them: values stay in their ranges, what is not
 * understood is said in a line, and what is written of the values is read as the same values. */
#include "fuzz_text.h"
#include "window/app/presets.h"

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

enum { PARAMS = 5 };
static const mrt_param params[PARAMS] = {
    {.name = "Push", .group = "Hand", .min = 0.0, .max = 4.0, .initial = 1.0},
    {.name = "Ease", .group = "Hand", .min = -1e9, .max = 1e9, .initial = 0.0},
    {.name = "Ease", .group = "Lids", .min = 0.25, .max = 0.5, .initial = 0.25},
    {.name = "Mode",
     .group = "",
     .min = 0.0,
     .max = 3.0,
     .initial = 2.0,
     .flags = MRT_PARAM_STEPPED},
    {.name = "Teach", .group = "", .min = 0.0, .max = 1.0, .flags = MRT_PARAM_TRIGGER}};
static const mrt_plugin_type type = {
    .id = "fuzz.mapping", .name = "Fuzzed", .params = params, .param_count = PARAMS};

static void check_name(const char *text)
{
    char name[PRESET_NAME], key[PRESET_KEY];
    if (!presets_clean_name(name, text))
        return;
    require(name[0] && !strchr(name, '.') && !strchr(name, '\n'), "a name is one level of a key");
    presets_key(key, &type, name);
    require(strlen(key) < PRESET_KEY - 1, "a key");
    require(strlen(key) >= strlen(name) && strcmp(key + strlen(key) - strlen(name), name) == 0,
            "the whole name is in the key");
}

static void check_values(const char *text)
{
    double value[PARAMS], again[PARAMS];
    _Atomic double wanted[PARAMS];
    char written[PRESET_TEXT];
    error note;
    presets_values(&type, text, value, &note);
    require(fuzz_is_shown(note.text), "one line");
    for (int i = 0; i < PARAMS; ++i) {
        require(value[i] >= params[i].min && value[i] <= params[i].max, "values are in range");
        wanted[i] = value[i];
    }
    require(value[4] == 0.0, "no preset presses a button");
    instance kept = {.type = &type, .wanted = wanted};
    presets_text(&kept, written, sizeof written);
    presets_values(&type, written, again, &note);
    require(note.text[0] == '\0', "what is written is understood");
    for (int i = 0; i < PARAMS; ++i)
        require(fabs(again[i] - value[i]) <= 1e-8 * fmax(1.0, fabs(value[i])), "the same values");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    require(text != NULL, "memory");
    memcpy(text, data, size);
    text[size] = '\0';
    check_name(text);
    check_values(text);
    free(text);
    return 0;
}
