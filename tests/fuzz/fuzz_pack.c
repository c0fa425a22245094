/* The list of a packed face: whatever it says, the face is found, or refused with a reason, and
 * nothing outside of its folder is ever read. */
#include "fuzz_text.h"

#include "base/file.h"
#include "show/hash.h"
#include "show/pack.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { PATH_TEXT = 256 };
static const char rig_text[] = "{\"mesh\": \"head.obj\"}", mesh_text[] = "v 0 0 0\n";
static char parent[64], folder[PATH_TEXT], rig[] = "head.rig.json";
static take_performance performed = {.rig = rig};

static void require(bool holds, const char *what)
{
    if (holds)
        return;
    fprintf(stderr, "not true: %s\n", what);
    abort();
}

static void write_in(const char *name, const void *bytes, size_t size)
{
    char path[PATH_TEXT * 2];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    require(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0, "a file");
}

static void remove_all(void)
{
    static const char *const all[] = {"face.rig.json", "head.obj", "files.json", "link", ""};
    char path[PATH_TEXT * 2];
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        (void)snprintf(path, sizeof path, "%s/%s", folder, all[i]);
        (void)remove(path);
    }
    (void)snprintf(path, sizeof path, "%s/a.pack", parent);
    (void)remove(path);
    (void)remove(parent);
}

static void make_folder(void)
{
    char path[PATH_TEXT * 2];
    if (parent[0])
        return;
    hash_bytes(performed.rig_hash, rig_text, sizeof rig_text - 1);
    hash_bytes(performed.mesh_hash, mesh_text, sizeof mesh_text - 1);
    strcpy(parent, access("/dev/shm", W_OK) == 0 ? "/dev/shm/marotte_fuzz_XXXXXX"
                                                 : "/tmp/marotte_fuzz_XXXXXX");
    require(mkdtemp(parent) != NULL, "a folder");
    (void)snprintf(path, sizeof path, "%s/a.pack", parent);
    require(mkdir(path, 0700) == 0, "a folder");
    (void)snprintf(folder, sizeof folder, "%s/a.pack/%.16s-%.16s", parent, performed.rig_hash,
                   performed.mesh_hash);
    require(mkdir(folder, 0700) == 0, "a folder");
    (void)snprintf(path, sizeof path, "%s/link", folder);
    require(symlink("/etc/passwd", path) == 0, "a link");
    write_in("face.rig.json", rig_text, sizeof rig_text - 1);
    write_in("head.obj", mesh_text, sizeof mesh_text - 1);
    (void)atexit(remove_all);
}

static bool contains(const uint8_t *data, size_t size, const char *word)
{
    const size_t length = strlen(word);
    for (size_t i = 0; i + length <= size; ++i)
        if (memcmp(data + i, word, length) == 0)
            return true;
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char secret[] = "root:"; /* of the file behind the link */
    char show[PATH_TEXT], face[PATH_MAX] = "";
    error err = {""};
    make_folder();
    write_in("files.json", data, size);
    (void)snprintf(show, sizeof show, "%s/a.marotte", parent);
    if (pack_find(face, show, &performed, &err) < 0) {
        require(fuzz_is_reason(err.text), "one line of reason");
        require(face[0] == '\0', "no face on failure");
        require(!strstr(err.text, secret) || contains(data, size, secret),
                "nothing from elsewhere is said");
        return 0;
    }
    require(strncmp(face, folder, strlen(folder)) == 0 &&
                strcmp(face + strlen(folder), "/face.rig.json") == 0,
            "the face is in its folder");
    return 0;
}
