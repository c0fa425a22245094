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
    return settings_list(from, "recent", out, OPEN_RECENT_MAX);
}

static void note_recent(settings *to, const char *path)
{
    const char *before[OPEN_RECENT_MAX], *kept[OPEN_RECENT_MAX + 1] = {path};
    const uint32_t known = open_recent(to, before);
    uint32_t count = 1;
    for (uint32_t i = 0; i < known; ++i)
        if (strcmp(before[i], path) != 0)
            kept[count++] = before[i];
    settings_set_list(to, "recent", kept, count < OPEN_RECENT_MAX ? count : OPEN_RECENT_MAX,
                      OPEN_RECENT_MAX);
}

static mrt_result open_hands(app *of, const char *path)
{
    char text[FOLDER_PATH + 16];
    (void)snprintf(text, sizeof text, "log:%s,loop=1", path);
    return app_open_input(of, text);
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
        result = app_report(of, kept_scenery_choose(app_scenery(of), path, &err), &err);
        break;
    default:
        return app_report(of,
                          error_set(&err, MRT_ERR_FORMAT,
                                    "%s is no show, face, recording of hands, sound or picture",
                                    path),
                          &err);
    }
    if (result >= 0)
        note_recent(app_settings(of), path);
    return result;
}
