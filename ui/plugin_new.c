/* marotte plugin new: the beginning of somebody's plugin. */
#include "plugin.h"

#include "base/file.h"
#include "base/program.h"
#include "base/text.h"
#include "place.h"
#include "template_files.h"

#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* With "org.example." before it a name fits into one line of the log. */
enum { NAME_MAX_LETTERS = 24 };

static const char placeholder[] = "template_name";

typedef struct wish {
    const char *name, *parent;
    const template_file *files; /* TEMPLATE_FILES of them; NULL: not said */
} wish;

/* ---- names ---- */

static const char name_letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

static bool is_word_of_the_language(const char *name)
{
    static const char words[] =
        " alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl "
        "const const_cast constexpr continue decltype default delete do double dynamic_cast else "
        "enum explicit export extern false float for friend goto if inline int long mutable "
        "namespace new noexcept not not_eq nullptr operator or or_eq private protected public "
        "register reinterpret_cast restrict return short signed sizeof static static_assert "
        "static_cast struct switch template this thread_local throw true try typedef typeid "
        "typename union unsigned using virtual void volatile wchar_t while xor xor_eq ";
    char word[NAME_MAX_LETTERS + 3];
    snprintf(word, sizeof word, " %s ", name);
    return strstr(words, word) != NULL;
}

static int check_name(const char *name)
{
    size_t length = strlen(name);
    char shown[80]; /* one line, whatever it holds */
    text_copy(shown, sizeof shown, text_view_of(name, length));
    bool begins_well = name[0] >= 'a' && name[0] <= 'z';
    if (!begins_well || strspn(name, name_letters) != length || length > NAME_MAX_LETTERS)
        return command_usage(&command_plugin,
                             "new: \"%s\" cannot be a plugin's name: lower-case letters, digits "
                             "and _, a letter first, at most %d (as in slow_jaw)",
                             shown, NAME_MAX_LETTERS);
    if (is_word_of_the_language(name))
        return command_usage(&command_plugin,
                             "new: \"%s\" is a word of C or C++: choose another name", name);
    return COMMAND_DONE;
}

/* ---- options ---- */

static int read_kind(wish *out, const template_file *files)
{
    if (out->files && out->files != files)
        return command_usage(&command_plugin, "new: --mapping or --input, not both");
    out->files = files;
    return COMMAND_DONE;
}

static int read_options(wish *out, int argc, char **argv)
{
    *out = (wish){.parent = "."};
    int code = COMMAND_DONE;
    for (int i = 1; i < argc && code == COMMAND_DONE; ++i) {
        if (strcmp(argv[i], "--mapping") == 0)
            code = read_kind(out, template_mapping);
        else if (strcmp(argv[i], "--input") == 0)
            code = read_kind(out, template_input);
        else if (strcmp(argv[i], "--dir") == 0 && i + 1 < argc)
            out->parent = argv[++i];
        else if (strcmp(argv[i], "--dir") == 0)
            code = command_usage(&command_plugin, "new: --dir needs a folder");
        else if (argv[i][0] == '-' || out->name)
            code = command_usage(&command_plugin, "new: \"%s\" is not expected here", argv[i]);
        else
            out->name = argv[i];
    }
    if (code != COMMAND_DONE)
        return code;
    if (!out->name)
        return command_usage(&command_plugin, "new: what is it to be called?");
    code = check_name(out->name);
    if (code == COMMAND_DONE && !out->files)
        code = command_usage(&command_plugin, "new: --mapping (hands in, a face out) or --input "
                                              "(where hands come from)?");
    return code;
}

/* ---- files ---- */

/* The text with the plugin's name in it, ended by a 0. NULL: no memory. */
static char *named(const char *text, size_t size, const char *name, size_t *out_size)
{
    size_t name_length = strlen(name), used = 0;
    const size_t held_length = sizeof placeholder - 1;
    /* No name is longer than twice the placeholder. */
    char *out = malloc(2 * size + 1);
    if (!out)
        return NULL;
    for (size_t i = 0; i < size;) {
        if (size - i >= held_length && memcmp(text + i, placeholder, held_length) == 0) {
            memcpy(out + used, name, name_length);
            used += name_length;
            i += held_length;
        } else {
            out[used++] = text[i++];
        }
    }
    out[used] = '\0';
    *out_size = used;
    return out;
}
_Static_assert(NAME_MAX_LETTERS <= 2 * (sizeof placeholder - 1), "named() has room for twice");

static mrt_result path_of(char out[PLACE_LENGTH], const wish *w, const template_file *file,
                          error *err)
{
    size_t size = 0;
    char *name = named(file->name, strlen(file->name), w->name, &size);
    if (!name)
        return error_set(err, MRT_ERR_MEMORY, "new: no memory");
    int length = snprintf(out, PLACE_LENGTH, "%s/%s/%s", w->parent, w->name, name);
    free(name);
    if (length < 0 || length >= PLACE_LENGTH)
        return error_set(err, MRT_ERR_ARGUMENT, "new: the path of the folder is too long");
    return MRT_OK;
}

static mrt_result write_file(const wish *w, const template_file *file, error *err)
{
    char path[PLACE_LENGTH];
    mrt_result result = path_of(path, w, file, err);
    if (result < 0)
        return result;
    size_t size = 0;
    char *text = named(file->bytes, file->size, w->name, &size);
    if (!text)
        return error_set(err, MRT_ERR_MEMORY, "new: no memory");
    result = file_write(path, text, size, err);
    free(text);
    return result;
}

static mrt_result make_folder(char out[PLACE_LENGTH], const wish *w, error *err)
{
    struct stat about;
    if (stat(w->parent, &about) != 0 || !S_ISDIR(about.st_mode))
        return error_set(err, MRT_ERR_IO, "new: there is no folder %s to write into", w->parent);
    int length = snprintf(out, PLACE_LENGTH, "%s/%s", w->parent, w->name);
    if (length < 0 || length >= PLACE_LENGTH)
        return error_set(err, MRT_ERR_ARGUMENT, "new: the path of the folder is too long");
    if (mkdir(out, 0777) == 0)
        return MRT_OK;
    if (errno == EEXIST)
        return error_set(err, MRT_ERR_IO,
                         "new: %s is there already and stays as it is: choose another name, or "
                         "another --dir",
                         out);
    return error_set(err, MRT_ERR_IO, "new: %s cannot be made: %s", out, strerror(errno));
}

static void remove_all(const wish *w, const char *folder)
{
    error none;
    char path[PLACE_LENGTH];
    for (int i = 0; i < TEMPLATE_FILES; ++i)
        if (path_of(path, w, &w->files[i], &none) >= 0)
            unlink(path);
    rmdir(folder);
}

/* All files, or nothing. */
static mrt_result write_all(const wish *w, error *err)
{
    char folder[PLACE_LENGTH];
    assert(w->files);
    mrt_result result = make_folder(folder, w, err);
    if (result < 0)
        return result;
    for (int i = 0; i < TEMPLATE_FILES && result >= 0; ++i)
        result = write_file(w, &w->files[i], err);
    if (result < 0)
        remove_all(w, folder);
    return result;
}

/* ---- what is next ---- */

static void print_quoted(const char *text)
{
    char word[4 * PLACE_LENGTH + 4];
    program_quote(word, sizeof word, text);
    fputs(word, stdout);
}

static bool is_on_path(const char *program)
{
    const char *path = getenv("PATH");
    while (path && *path) {
        size_t length = strcspn(path, ":");
        char candidate[PLACE_LENGTH];
        int written = snprintf(candidate, sizeof candidate, "%.*s/marotte", (int)length, path);
        char *real =
            written > 0 && written < PLACE_LENGTH && length > 0 ? realpath(candidate, NULL) : NULL;
        if (real) { /* the first one is the one that runs */
            bool is_it = strcmp(real, program) == 0;
            free(real);
            return is_it;
        }
        path += length + (path[length] == ':');
    }
    return false;
}

static void print_program(void)
{
    char program[PLACE_LENGTH];
    if (!place_program(program) || is_on_path(program))
        fputs("marotte", stdout);
    else
        print_quoted(program);
}

/* What cmake does not find by itself. */
static void print_prefix(void)
{
    char prefix[PLACE_LENGTH];
    if (!place_prefix(prefix)) {
        fputs(" -DMAROTTE_INCLUDE=FOLDER_OF_marotte/plugin.h", stdout);
    } else if (strcmp(prefix, "/usr") != 0 && strcmp(prefix, "/usr/local") != 0) {
        fputs(" -DCMAKE_PREFIX_PATH=", stdout);
        print_quoted(prefix);
    }
}

static void print_next(const wish *w)
{
    bool is_mapping = w->files == template_mapping;
    char folder[PLACE_LENGTH];
    snprintf(folder, sizeof folder, "%s/%s", w->parent, w->name);
    const char *shown = strncmp(folder, "./", 2) == 0 ? folder + 2 : folder;
    printf("wrote %s: %s.c is the %s, README.md says the rest. Next:\n  cd ", shown, w->name,
           is_mapping ? "mapping" : "input");
    print_quoted(shown);
    fputs(" && cmake -B build", stdout);
    print_prefix();
    fputs(" && cmake --build build\n  ", stdout);
    print_program();
    printf(" plugin check build/%s.so\n  ", w->name);
    print_program();
    if (is_mapping)
        printf(" perform --face puppet --input log:take.csv --map build/%s.so --export face.png\n",
               w->name);
    else
        printf(" perform --face puppet --input build/%s.so --map one_hand --export face.png\n",
               w->name);
}

int plugin_new_run(int argc, char **argv)
{
    wish w;
    error err = {""};
    int code = read_options(&w, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    if (write_all(&w, &err) < 0)
        return command_failed(&command_plugin, &err);
    print_next(&w);
    return COMMAND_DONE;
}
