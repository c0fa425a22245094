#include "base/installed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* From the folder of the program: installed, and in the build folder. */
static const char *const prefixes[] = {MAROTTE_PREFIX_FROM_PROGRAM, "."};
static const char *const data[] = {MAROTTE_DATA_FROM_PROGRAM, "share/marotte"};
static const char *const rigs[] = {MAROTTE_DATA_FROM_PROGRAM "/rigs", "share/marotte/rigs"};
enum { PLACES = 2 };

bool installed_program(char out[INSTALLED_LENGTH])
{
    ssize_t length = readlink("/proc/self/exe", out, INSTALLED_LENGTH - 1);
    out[length > 0 ? length : 0] = '\0';
    return length > 0 && length < INSTALLED_LENGTH - 1;
}

/* The first of the folders, as seen from the program's folder, in which there is such a file. */
static bool find(char out[INSTALLED_LENGTH], const char *const folder[PLACES], const char *file)
{
    char program[INSTALLED_LENGTH];
    if (!installed_program(program))
        return false;
    int folder_length = (int)(strrchr(program, '/') - program);
    for (int i = 0; i < PLACES; ++i) {
        int length =
            snprintf(out, INSTALLED_LENGTH, "%.*s/%s/%s", folder_length, program, folder[i], file);
        if (length > 0 && length < INSTALLED_LENGTH && access(out, R_OK) == 0)
            return true;
    }
    return false;
}

bool installed_prefix(char out[INSTALLED_LENGTH])
{
    static const char header[] = "include/marotte/plugin.h";
    if (!find(out, prefixes, header))
        return false;
    out[strlen(out) - sizeof header] = '\0';
    char *real = realpath(out, NULL);
    bool fits = real && strlen(real) < INSTALLED_LENGTH;
    if (fits)
        memcpy(out, real, strlen(real) + 1);
    free(real);
    return fits;
}

bool installed_data(char out[INSTALLED_LENGTH], const char *file)
{
    return find(out, data, file);
}

static bool is_file(const char *path)
{
    struct stat about;
    return stat(path, &about) == 0 && !S_ISDIR(about.st_mode);
}

static bool is_name(const char *given)
{
    return given[0] != '\0' && given[0] != '.' && !strchr(given, '/') && !is_file(given);
}

char *installed_face(const char *given)
{
    char file[INSTALLED_LENGTH], found[INSTALLED_LENGTH];
    int length = snprintf(file, sizeof file, "%s/%s.rig.json", given, given);
    if (is_name(given) && length > 0 && length < INSTALLED_LENGTH && find(found, rigs, file))
        return realpath(found, NULL);
    return strdup(given);
}

char *installed_patch(const char *given)
{
    char file[INSTALLED_LENGTH], found[INSTALLED_LENGTH];
    int length = snprintf(file, sizeof file, "patches/%s.json", given);
    if (is_name(given) && length > 0 && length < INSTALLED_LENGTH && find(found, data, file))
        return realpath(found, NULL);
    return strdup(given);
}
