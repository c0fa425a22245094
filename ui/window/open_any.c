#include "window/open_any.h"
#include "window/app/kept_scenery.h"
#include "window/folder.h"

#include "base/budget.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- what it is ---- */

#define FACES    ".rig.json", ".glb", ".gltf", ".vrm", ".obj", ".ply", ".off", ".stl"
#define HANDS    ".csv", ".log"
#define VOICES   ".wav", ".flac", ".ogg", ".oga", ".opus", ".aif", ".aiff", ".mp3", ".au", ".snd"
#define PICTURES ".png", ".jpg", ".jpeg"

static const char *const endings[OPEN_KINDS][32] = {
    [OPEN_ANY] = {".marotte", FACES, HANDS, VOICES, PICTURES, NULL},
    [OPEN_SHOW] = {".marotte", NULL},
    [OPEN_FACE] = {FACES, NULL},
    [OPEN_HANDS] = {HANDS, NULL},
    [OPEN_VOICE] = {VOICES, NULL},
    [OPEN_PICTURE] = {PICTURES, NULL},
};

const char *const *open_endings(open_kind kind)
{
    return endings[kind < OPEN_KINDS ? kind : OPEN_ANY];
}

typedef struct beginning {
    const char *bytes;
    open_kind kind;
} beginning;

/* What its first bytes say, where its name says nothing. */
static open_kind kind_of_content(const char *path)
{
    static const beginning known[] = {{"SQLite format 3", OPEN_SHOW},
                                      {"glTF", OPEN_FACE},
                                      {"ply", OPEN_FACE},
                                      {"OFF", OPEN_FACE},
                                      {"time_s,", OPEN_HANDS},
                                      {"time_ns,", OPEN_HANDS},
                                      {"RIFF", OPEN_VOICE},
                                      {"fLaC", OPEN_VOICE},
                                      {"OggS", OPEN_VOICE},
                                      {"FORM", OPEN_VOICE},
                                      {".snd", OPEN_VOICE},
                                      {"\x89PNG", OPEN_PICTURE},
                                      {"\xff\xd8\xff", OPEN_PICTURE}};
    char first[16] = "";
    FILE *file = fopen(path, "rb");
    if (!file)
        return OPEN_ANY;
    const size_t length = fread(first, 1, sizeof first, file);
    (void)fclose(file);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; ++i) {
        const size_t wanted = strlen(known[i].bytes);
        if (length >= wanted && memcmp(first, known[i].bytes, wanted) == 0)
            return known[i].kind;
    }
    return OPEN_ANY;
}

open_kind open_kind_of(const char *path)
{
    for (open_kind kind = OPEN_SHOW; kind < OPEN_KINDS; ++kind)
        if (folder_name_ends(path, endings[kind]))
            return kind;
    return kind_of_content(path);
}

/* ---- opened ---- */

uint32_t open_recent(const settings *from, const char *out[OPEN_RECENT_MAX])
{
    uint32_t count = 0;
    char key[32];
    for (uint32_t i = 0; i < OPEN_RECENT_MAX; ++i) {
        (void)snprintf(key, sizeof key, "recent.%u", i);
        const char *path = settings_text(from, key, "");
        if (path[0])
            out[count++] = path;
    }
    return count;
}

static void note_recent(settings *to, const char *path)
{
    const char *before[OPEN_RECENT_MAX];
    char *kept[OPEN_RECENT_MAX + 1] = {strdup(path)}, key[32];
    uint32_t count = kept[0] ? 1 : 0;
    const uint32_t known = open_recent(to, before);
    for (uint32_t i = 0; i < known && count > 0; ++i)
        if (strcmp(before[i], path) != 0 && (kept[count] = strdup(before[i])))
            count += 1;
    for (uint32_t i = 0; i < count; ++i) {
        (void)snprintf(key, sizeof key, "recent.%u", i);
        if (i < OPEN_RECENT_MAX)
            settings_set_text(to, key, kept[i]);
        free(kept[i]);
    }
}

static mrt_result open_hands(app *of, const char *path)
{
    char text[FOLDER_PATH + 16];
    (void)snprintf(text, sizeof text, "log:%s,loop=1", path);
    return app_open_input(of, text);
}

static mrt_result say(app *of, mrt_result result, const error *err)
{
    if (result < 0)
        news_list_add(app_news(of), MRT_LOG_ERROR, "stage", err->text);
    return result;
}

mrt_result open_any(app *of, const char *path)
{
    error err = {0};
    mrt_result result;
    switch (open_kind_of(path)) {
    case OPEN_SHOW:
        result = app_open_show(of, path);
        break;
    case OPEN_FACE:
        result = app_open_face(of, path);
        break;
    case OPEN_HANDS:
        result = open_hands(of, path);
        break;
    case OPEN_VOICE:
        result = app_attach_voice(of, path);
        break;
    case OPEN_PICTURE:
        result = say(of, kept_scenery_choose(app_scenery(of), path, &err), &err);
        break;
    default:
        return say(of,
                   error_set(&err, MRT_ERR_FORMAT,
                             "%s is no show, face, recording of hands, sound or picture", path),
                   &err);
    }
    if (result >= 0)
        note_recent(app_settings(of), path);
    return result;
}
