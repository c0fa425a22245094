/* The window's settings: whatever lies in the default file, the window starts; a damaged file is
 * renamed, and a note says so. What is set is kept, beside what was there. */
#include "fuzz_text.h"
#include "window/app/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[64], below[96], path[128], aside[160];

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "does not hold: %s\n", what);
    abort();
}

static void remove_all(void)
{
    (void)unlink(path);
    (void)unlink(aside);
    (void)rmdir(below);
    (void)rmdir(folder);
}

static void make_folder(void)
{
    if (folder[0])
        return;
    strcpy(folder, access("/dev/shm", W_OK) == 0 ? "/dev/shm/marotte_fuzz_XXXXXX"
                                                 : "/tmp/marotte_fuzz_XXXXXX");
    require(mkdtemp(folder) != NULL, "a folder");
    (void)snprintf(below, sizeof below, "%s/marotte", folder);
    require(mkdir(below, 0700) == 0 && setenv("XDG_CONFIG_HOME", folder, 1) == 0, "its folder");
    (void)snprintf(path, sizeof path, "%s/window.json", below);
    (void)snprintf(aside, sizeof aside, "%s.damaged", path);
    (void)atexit(remove_all);
}

static settings *opened(char *note, size_t capacity)
{
    settings *self;
    error err = {""};
    require(settings_open(&self, NULL, note, capacity, &err) == MRT_OK, "the window starts");
    return self;
}

/* All that is there can be asked for; and what is below it. */
static void walk(const settings *self, const char *key, int depth)
{
    char **name, inner[300];
    uint32_t count = settings_keys(self, key, &name);
    (void)settings_number(self, key, 0.0);
    const char *text = settings_text(self, key, "");
    require(text != NULL && strlen(text) < 1u << 22, "a text");
    for (uint32_t i = 0; i < count && depth < 6 && i < 64; ++i) {
        int length = snprintf(inner, sizeof inner, "%s.%s", key, name[i]);
        if (length > 0 && length < (int)sizeof inner)
            walk(self, inner, depth + 1);
    }
    free(name);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char note[512], key[64];
    error err = {""};
    make_folder();
    FILE *file = fopen(path, "wb");
    require(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "a file");
    (void)unlink(aside);
    settings *self = opened(note, sizeof note);
    require((note[0] != '\0') == (access(aside, F_OK) == 0),
            "what made no sense is aside, and said");
    require(fuzz_is_shown(note), "one line");
    (void)snprintf(key, sizeof key, "%.*s", (int)(size < 40 ? size : 40), (const char *)data);
    walk(self, "mapping", 0);
    walk(self, "looks", 0);
    (void)settings_text(self, key, NULL);
    settings_set_number(self, key, 2.5);
    settings_set_text(self, "mapping.one_hand.preset.soft", "push=2");
    settings_set_number(self, "looks.timeline_height", 0.25);
    settings_set_text(self, "looks.gone", NULL);
    require(settings_write(self, &err) == MRT_OK, "it is written");
    settings_close(self);
    self = opened(note, sizeof note);
    require(note[0] == '\0', "what was written makes sense");
    require(strcmp(settings_text(self, "mapping.one_hand.preset.soft", ""), "push=2") == 0 &&
                settings_number(self, "looks.timeline_height", 0.0) == 0.25,
            "it is kept");
    settings_close(self);
    return 0;
}
