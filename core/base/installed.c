#include "base/installed.h"

#include "base/os.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Relative to the folder of the program: in an installation, and in the build folder. */
static const char *const prefixes[] = {MAROTTE_PREFIX_FROM_PROGRAM, "."};
static const char *const data[] = {MAROTTE_DATA_FROM_PROGRAM, "share/marotte"};
enum { PLACES = 2, ENTRIES_MOST = 10000 };

bool installed_program(char out[INSTALLED_LENGTH])
{
    return os_program_path(out, INSTALLED_LENGTH);
}

/* Finds the first of the folders, relative to the program's folder, that contains the file. */
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
    char *real = os_real_path(out);
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

/* ---- files with short names ---- */

static const struct {
    const char *noun, *folder; /* below the data folder */
    const char *ending;        /* ending of the entries; "": each has its own folder */
} kinds[INSTALLED_KINDS] = {[INSTALLED_FACE] = {"face", "rigs", ""},
                            [INSTALLED_PATCH] = {"patch", "patches", ".json"},
                            [INSTALLED_RECORDING] = {"recording", ".", ".csv"}};

static bool is_name(const char *given)
{
    return given[0] != '\0' && given[0] != '.' && !strchr(given, '/');
}

/* Finds the installed file with that short name. */
static bool find_named(char out[INSTALLED_LENGTH], installed_kind kind, const char *name)
{
    char file[INSTALLED_LENGTH];
    int length = -1;
    switch (kind) {
    case INSTALLED_FACE:
        length = snprintf(file, sizeof file, "rigs/%s/%s.rig.json", name, name);
        break;
    case INSTALLED_PATCH:
        length = snprintf(file, sizeof file, "patches/%s.json", name);
        break;
    case INSTALLED_RECORDING: /* the file name, as in earlier versions, or without its ending */
        length = snprintf(file, sizeof file, "%s", name);
        if (length > 0 && length < INSTALLED_LENGTH && find(out, data, file) && is_file(out))
            return true;
        length = snprintf(file, sizeof file, "%s.csv", name);
        break;
    case INSTALLED_KINDS:
        break;
    }
    return length > 0 && length < INSTALLED_LENGTH && find(out, data, file) && is_file(out);
}

char *installed_path(installed_kind kind, const char *given)
{
    char found[INSTALLED_LENGTH];
    if (is_name(given) && !is_file(given) && find_named(found, kind, given))
        return os_real_path(found);
    return strdup(given);
}

char *installed_kept_face(const char *path)
{
    char found[INSTALLED_LENGTH];
    const char *place = NULL; /* in the data folder: "rigs/puppet/puppet.rig.json" */
    for (const char *at = path; (at = strstr(at, "/rigs/")) != NULL; ++at)
        place = at + 1;
    if (place && !is_file(path) && find(found, data, place) && is_file(found))
        return realpath(found, NULL);
    return strdup(path);
}

static int by_text(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Returns the names of all entries of a folder, sorted; the caller frees each and the list. NULL:
 * none. */
static char **read_folder(const char *folder, size_t *out_count)
{
    DIR *opened = opendir(folder);
    char **list = NULL;
    size_t count = 0;
    for (const struct dirent *entry; opened && count < ENTRIES_MOST && (entry = readdir(opened));) {
        char **longer = realloc(list, (count + 1) * sizeof *list);
        if (!longer)
            break;
        list = longer;
        list[count] = strdup(entry->d_name);
        count += list[count] != NULL;
    }
    if (opened)
        closedir(opened);
    if (count > 0)
        qsort(list, count, sizeof *list, by_text);
    *out_count = count;
    return list;
}

/* Writes "moai, puppet", and also considers each name for `near`. */
static void list_names(char *out, size_t capacity, installed_kind kind, suggest *near)
{
    char folder[INSTALLED_LENGTH], path[INSTALLED_LENGTH];
    const char *ending = kinds[kind].ending;
    size_t used = 0, count = 0;
    out[0] = '\0';
    char **entry = find(folder, data, kinds[kind].folder) ? read_folder(folder, &count) : NULL;
    for (size_t i = 0; i < count; ++i) {
        char *name = entry[i], *dot = strrchr(name, '.');
        const bool is_ending = !ending[0] || (dot && strcmp(dot, ending) == 0);
        if (is_ending && ending[0])
            *dot = '\0';
        if (is_ending && is_name(name) && find_named(path, kind, name) && used < capacity) {
            suggest_consider(near, name);
            const int length =
                snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", name);
            used += length > 0 ? (size_t)length : 0;
        }
        free(name);
    }
    free(entry);
}

suggest_text installed_suggest(installed_kind kind, const char *given)
{
    char names[256];
    suggest near;
    if (!is_name(given))
        return suggest_file(given);
    suggest_begin(&near, given);
    list_names(names, sizeof names, kind, &near);
    suggest_folder(&near, "");
    suggest_text out = suggest_question(&near);
    const size_t used = strlen(out.text);
    if (names[0])
        (void)snprintf(out.text + used, sizeof out.text - used, "%s Installed: %s", used ? "" : ".",
                       names);
    return out;
}

mrt_result installed_check(installed_kind kind, const char *given, error *err)
{
    char names[256], found[INSTALLED_LENGTH];
    suggest near;
    if (!is_name(given) || access(given, F_OK) == 0 || find_named(found, kind, given))
        return MRT_OK;
    suggest_begin(&near, given);
    list_names(names, sizeof names, kind, &near);
    suggest_folder(&near, "");
    return error_set(err, MRT_ERR_IO, "there is no %s \"%s\"%s%s Installed: %s", kinds[kind].noun,
                     given, suggest_question(&near).text, near.best[0] ? "" : ".",
                     names[0] ? names : "none");
}
