/* A folder with rigs that include each other: they are read or refused with a reason, nothing
 * outside of the folder is ever read, and what was read can be written as one file that says the
 * same. The bytes are the files, one behind the other, with a byte 30 between them: a.rig.json,
 * which is opened, then b, c, below/d.rig.json. "link.rig.json" leads out of the folder. */
#include "fuzz_rig.h"

#include "base/file.h"

#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FILES = 4, PATH_TEXT = 128, SEPARATOR = 30 };
static const char *const names[FILES] = {"a.rig.json", "b.rig.json", "c.rig.json",
                                         "below/d.rig.json"};
static const char secret[] = "kept_to_itself"; /* in the file outside */
static char parent[64];

static void path_of(char out[PATH_TEXT], const char *name)
{
    (void)snprintf(out, PATH_TEXT, "%s/folder/%s", parent, name);
}

static void remove_all(void)
{
    static const char *const all[] = {"folder/a.rig.json",   "folder/b.rig.json",
                                      "folder/c.rig.json",   "folder/below/d.rig.json",
                                      "folder/out.rig.json", "folder/link.rig.json",
                                      "folder/below",        "folder",
                                      "outside.rig.json",    ""};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        char path[PATH_TEXT];
        (void)snprintf(path, sizeof path, "%s/%s", parent, all[i]);
        (void)remove(path);
    }
}

static void make_folder(void)
{
    static const char outside[] =
        "{\"marotte_rig\": 1, \"name\": \"kept_to_itself\", \"mesh\": \"kept_to_itself.obj\", "
        "\"kept_to_itself\": 1}";
    char path[PATH_TEXT];
    error err;
    if (parent[0])
        return;
    strcpy(parent, access("/dev/shm", W_OK) == 0 ? "/dev/shm/marotte_fuzz_XXXXXX"
                                                 : "/tmp/marotte_fuzz_XXXXXX");
    require(mkdtemp(parent) != NULL, "a folder");
    path_of(path, "");
    require(mkdir(path, 0700) == 0, "a folder");
    path_of(path, "below");
    require(mkdir(path, 0700) == 0, "a folder");
    path_of(path, "link.rig.json");
    require(symlink("../outside.rig.json", path) == 0, "a link");
    (void)snprintf(path, sizeof path, "%s/outside.rig.json", parent);
    require(file_write(path, outside, sizeof outside - 1, &err) == MRT_OK, "a file");
    (void)atexit(remove_all);
}

static void put(const char *name, const uint8_t *data, size_t size)
{
    char path[PATH_TEXT];
    path_of(path, name);
    FILE *file = fopen(path, "wb");
    require(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "a file");
}

static void put_all(const uint8_t *data, size_t size)
{
    for (int i = 0; i < FILES; ++i) {
        const uint8_t *end = i + 1 < FILES && size > 0 ? memchr(data, SEPARATOR, size) : NULL;
        size_t length = end ? (size_t)(end - data) : size;
        put(names[i], data, length);
        data += length + (end ? 1 : 0);
        size -= length + (end ? 1 : 0);
    }
}

static void check_written(const rig *r)
{
    rig again;
    error err = {""};
    char path[PATH_TEXT];
    path_of(path, "out.rig.json");
    require(rig_write(r, path, &err) == MRT_OK, "it can be written");
    if (rig_read(&again, path, &err) < 0) {
        fprintf(stderr, "%s\n", err.text);
        require(false, "what is written is read");
    }
    require(r->bone_count == again.bone_count && r->region_count == again.region_count &&
                r->contact_count == again.contact_count && r->pose_count == again.pose_count &&
                r->proxy_count == again.proxy_count &&
                r->contact_set_count == again.contact_set_count,
            "it says the same");
    rig_destroy(&again);
}

static bool contains(const uint8_t *data, size_t size, const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i + length <= size; ++i)
        if (memcmp(data + i, text, length) == 0)
            return true;
    return false;
}

static bool reads_outside(const rig *r)
{
    return (r->note && strstr(r->note, secret)) || strstr(r->mesh_path, secret) ||
           strstr(r->name, secret);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    rig r;
    error err = {""};
    char path[PATH_TEXT];
    make_folder();
    put_all(data, size);
    path_of(path, names[0]);
    const clock_t start = clock();
    if (rig_read(&r, path, &err) < 0) {
        require(fuzz_is_reason(err.text), "one line of reason");
        require(!r.document && !r.bone && !r.note, "nothing is left on failure");
        return 0;
    }
    require(!reads_outside(&r) || contains(data, size, secret), "nothing outside is read");
    check_indices(&r);
    check_names(&r);
    check_use(&r);
    check_written(&r);
    rig_destroy(&r);
    fuzz_require_quick(start);
    return 0;
}
