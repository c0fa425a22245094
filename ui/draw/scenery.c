#include "draw/scenery.h"

#include "base/text.h"
#include "io/decode/decode.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char views_note[] = "views", picture_note[] = "background";
static const char *const fits[] = {[DRAW_COVER] = "cover", [DRAW_CONTAIN] = "contain"};
enum { NOTE = 32 * SCENERY_VIEWS * DRAW_VIEW_NUMBERS }; /* maximum length of any note */
_Static_assert((int)NOTE >= (int)LIGHTING_TEXT, "a note of lights has room");

scenery scenery_default(void)
{
    scenery out;
    memset(&out, 0, sizeof out);
    out.light = lighting_looks[0].light;
    return out;
}

/* ---- as text ---- */

static bool is_hash(text_view word)
{
    for (const char *at = word.at; at < word.end; ++at)
        if (!isdigit((unsigned char)*at) && !(*at >= 'a' && *at <= 'f'))
            return false;
    return word.end - word.at == TAKE_HASH - 1;
}

bool scenery_parse_picture(scenery *out, const char *text)
{
    text_view rest = text_view_of(text, strlen(text)), fit, hash;
    if (!text_next_word(&rest, &fit) || !text_next_word(&rest, &hash) || !is_hash(hash))
        return false;
    for (int i = DRAW_COVER; i <= DRAW_CONTAIN; ++i) {
        if ((size_t)(fit.end - fit.at) != strlen(fits[i]) ||
            memcmp(fit.at, fits[i], strlen(fits[i])) != 0)
            continue;
        while (rest.at < rest.end && *rest.at == ' ')
            ++rest.at;
        out->fit = (draw_fit)i;
        memset(out->picture_name, 0, sizeof out->picture_name);
        text_copy(out->picture, sizeof out->picture, hash);
        text_copy(out->picture_name, sizeof out->picture_name, rest);
        return true;
    }
    return false;
}

bool scenery_parse_views(scenery *out, const char *text)
{
    text_view rest = text_view_of(text, strlen(text)), word;
    draw_camera_view view[SCENERY_VIEWS];
    uint32_t count = 0;
    memset(view, 0, sizeof view);
    for (; text_next_word(&rest, &word); ++count) {
        double value;
        if (count == SCENERY_VIEWS * DRAW_VIEW_NUMBERS || !text_double(word, &value) ||
            !(fabs(value) <= 100.0))
            return false;
        view[count / DRAW_VIEW_NUMBERS].number[count % DRAW_VIEW_NUMBERS] = value;
    }
    if (count % DRAW_VIEW_NUMBERS != 0)
        return false;
    out->view_count = count / DRAW_VIEW_NUMBERS;
    memcpy(out->view, view, sizeof view);
    return true;
}

static void write_views(const scenery *self, char out[NOTE])
{
    size_t length = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < self->view_count * DRAW_VIEW_NUMBERS; ++i)
        length += (size_t)snprintf(out + length, NOTE - length, "%s%.17g", i ? " " : "",
                                   self->view[i / DRAW_VIEW_NUMBERS].number[i % DRAW_VIEW_NUMBERS]);
}

/* ---- notes of a show ---- */

static bool parse_light(scenery *out, const char *text)
{
    return lighting_parse(&out->light, text);
}

static const struct {
    const char *key, *trouble;
    bool (*parse)(scenery *, const char *);
} notes[] = {{LIGHTING_NOTE, "the lights are invalid. The studio lights are used", parse_light},
             {picture_note, "the picture behind the face is invalid. The wall is shown",
              scenery_parse_picture},
             {views_note, "the camera views are invalid and ignored", scenery_parse_views}};

mrt_result scenery_read(scenery *out, show *from, error *err)
{
    mrt_result result = MRT_OK;
    *out = scenery_default();
    for (size_t i = 0; from && i < sizeof notes / sizeof notes[0]; ++i) {
        char text[NOTE] = "";
        error why = {""};
        mrt_result read = show_note_read(from, notes[i].key, text, sizeof text, &why);
        if (read >= 0 && text[0] && !notes[i].parse(out, text))
            read = error_set(&why, MRT_ERR_FORMAT, "%s: %s", show_path(from), notes[i].trouble);
        if (read < 0)
            result = error_set(err, read, "%s", why.text);
    }
    return result;
}

mrt_result scenery_write(const scenery *self, show *into, error *err)
{
    char text[NOTE] = "";
    if (memcmp(&self->light, &lighting_looks[0].light, sizeof self->light) != 0)
        lighting_write(&self->light, text);
    mrt_result result = show_note_write(into, LIGHTING_NOTE, text, err);
    text[0] = '\0';
    if (self->picture[0])
        (void)snprintf(text, sizeof text, "%s %s %s", fits[self->fit], self->picture,
                       self->picture_name);
    if (result >= 0)
        result = show_note_write(into, picture_note, text, err);
    write_views(self, text);
    return result < 0 ? result : show_note_write(into, views_note, text, err);
}

/* ---- the picture ---- */

void scenery_picture_finish(scenery_picture *self)
{
    free(self->rgba);
    *self = (scenery_picture){0};
}

mrt_result scenery_picture_decode(scenery_picture *out, const void *bytes, size_t size,
                                  const char *name, error *err)
{
    decode_job job = {
        .order = {.kind = DECODE_IMAGE, .side_max = 4096}, .data = bytes, .size = size};
    error why = {""};
    *out = (scenery_picture){0};
    mrt_result result = decode_run(&job, 1, &why);
    if (result >= 0 && !job.out) {
        result = MRT_ERR_FORMAT;
        why = job.failed;
    }
    if (result < 0)
        return error_set(err, result, "%s cannot be shown: %s", name, why.text);
    decode_image_size is;
    memcpy(&is, job.out, sizeof is);
    memmove(job.out, (uint8_t *)job.out + sizeof is, job.out_size - sizeof is);
    *out = (scenery_picture){is.width, is.height, job.out};
    return MRT_OK;
}

mrt_result scenery_picture_read(scenery_picture *out, const scenery *of, show *from, error *err)
{
    void *bytes = NULL;
    size_t size;
    *out = (scenery_picture){0};
    if (!of->picture[0])
        return MRT_END;
    mrt_result result = show_picture_read(from, of->picture, &bytes, &size, err);
    if (result == MRT_END)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: the picture behind the face, %s, is missing in the show",
                         show_path(from), of->picture_name);
    if (result >= 0)
        result = scenery_picture_decode(out, bytes, size, of->picture_name, err);
    free(bytes);
    return result;
}
