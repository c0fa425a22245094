/* What a show says of its scene, from bytes: the first chooses which note. Refused, or every number
 * in its range and every word printable; lights that are written again come back as they were. */
#include "draw/scenery.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    (void)fprintf(stderr, "not so: %s\n", what);
    abort();
}

static void check_light(const char *text)
{
    lighting light = lighting_looks[1].light, again = lighting_looks[2].light;
    char written[LIGHTING_TEXT];
    if (!lighting_parse(&light, text)) {
        require(memcmp(&light, &lighting_looks[1].light, sizeof light) == 0,
                "what is refused changes nothing");
        return;
    }
    for (int i = 0; i < LIGHTING_LAMPS; ++i) {
        const lighting_lamp *lamp = &light.lamp[i];
        const float *d = lamp->direction;
        require(fabsf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1.0f) < 0.01f,
                "a light comes from somewhere");
        require(lamp->power >= 0.0f && lamp->power <= 4.0f, "a light's power");
    }
    require(light.room >= 0.0f && light.room <= 4.0f, "the room's light");
    lighting_write(&light, written);
    require(strlen(written) < LIGHTING_TEXT - 1, "what is written has room");
    require(lighting_parse(&again, written), "what is written is read");
    require(memcmp(&light, &again, sizeof light) == 0, "and is what it was");
}

static void check_rest(const char *text, bool is_picture)
{
    scenery made = scenery_default();
    if (is_picture ? !scenery_parse_picture(&made, text) : !scenery_parse_views(&made, text))
        return;
    const size_t hash = strlen(made.picture), name = strlen(made.picture_name);
    require(made.fit == DRAW_COVER || made.fit == DRAW_CONTAIN, "a fit");
    require(hash == (is_picture ? TAKE_HASH - 1 : 0) &&
                strspn(made.picture, "0123456789abcdef") == hash,
            "a picture's hash is one");
    require(name < SCENERY_NAME && text_is_printable(text_view_of(made.picture_name, name)),
            "a picture's name is printable");
    require(made.view_count <= SCENERY_VIEWS, "so many views");
    for (uint32_t i = 0; i < made.view_count; ++i)
        for (int k = 0; k < DRAW_VIEW_NUMBERS; ++k)
            require(fabs(made.view[i].number[k]) <= 100.0, "a view's number");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    char *text = malloc(size);
    if (!text)
        return 0;
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    if (data[0] == 'l')
        check_light(text);
    else
        check_rest(text, data[0] == 'p');
    free(text);
    return 0;
}
