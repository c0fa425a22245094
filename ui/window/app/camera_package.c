#include "window/app/camera_package.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "show/hash.h"

#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const camera_package_file hands_file[] = {
    {"hand_landmark_full.tflite",
     "8c026882c9ec059ce0f8e75266bee5a9a23c341a40e0000df755374d3d1b9b68"},
    {"hand_landmark_lite.tflite",
     "d7fde8ac11f8ce03f8663775bfc323f4fc9f2a38062b4f4efa142874ef5b2a48"},
    {"hands.binarypb", "ab76c4215fca99cc2db1b5885cb8398d210e59ebe685245f72e692b4b58421e4"},
    {"hands.js", "a68b21c9553d614384f7f459622e46e02e3c9cfdf7392915a2fa1d615e338473"},
    {"hands_solution_packed_assets.data",
     "bdce7b66bfc5b39ba86a47775c98e0b186fe73f8308c2279f852af4c89ffdf42"},
    {"hands_solution_packed_assets_loader.js",
     "d05c073a62a0c8d2d21c18bc8f158424ece0078ea00a636e9527083b10ca1e17"},
    {"hands_solution_simd_wasm_bin.js",
     "7720172e0775636e64955fb1091958c8294e01aa100c3272b59b2a543c028cb5"},
    {"hands_solution_simd_wasm_bin.wasm",
     "78ef7eb86ebc6424ac06b13f89b9a1fc01ff35e07520e37de98887cf88c06653"},
    {"hands_solution_wasm_bin.js",
     "2e1faa9965a87f496316e85731c41bde1d9b07dd448f6cd30f5c2262bcd35e29"},
    {"hands_solution_wasm_bin.wasm",
     "4e70eaf8063e0e9ac10e682d9d6b55c08d0788f0a8d49925e2e484636526e157"}};

static const camera_package hands = {
    .name = "@mediapipe/hands",
    .version = "0.4.1675469240",
    .archive = "@mediapipe/hands/-/hands-0.4.1675469240.tgz",
    .archive_sha256 = "bdd5be939c60cbd72a49f4b6141407683cf2a67263598e1a44757d70b3dfcb8a",
    .archive_size = 13207873,
    .installed_size = 24433035,
    .file = hands_file,
    .file_count = sizeof hands_file / sizeof hands_file[0],
};
const camera_package *camera_package_used = &hands;

/* npm reads its registry from the same variable. */
static const char registry_variable[] = "npm_config_registry";
static const char usual_registry[] = "https://registry.npmjs.org";
static const int64_t look_ns = 100 * NS_PER_MS, patience_ns = 900 * NS_PER_S;
/* A download without a byte for 10 s has stopped. */
static const char silent_s[] = "10", npm_silent[] = "--fetch-timeout=10000";

/* ---- where it lies ---- */

mrt_result camera_package_folder(char out[PATH_MAX], error *err)
{
    return file_home_path(out, PATH_MAX, FILE_HOME_DATA, "camera", err);
}

/* The folder of the files; $MAROTTE_CAMERA_PACKAGE, or below `folder`. */
static void path_of_files(char *out, size_t capacity, const char *folder)
{
    (void)snprintf(out, capacity, "%s/node_modules/%s", folder, camera_package_used->name);
}

enum { LONG_PATH = PATH_MAX + 256 };

static const char *own_folder(void)
{
    const char *own = getenv("MAROTTE_CAMERA_PACKAGE");
    return own && own[0] == '/' ? own : NULL;
}

bool camera_package_is_there(void)
{
    char folder[PATH_MAX], files[LONG_PATH], path[LONG_PATH + 16];
    error err;
    if (own_folder())
        (void)snprintf(files, sizeof files, "%s", own_folder());
    else if (camera_package_folder(folder, &err) < 0)
        return false;
    else
        path_of_files(files, sizeof files, folder);
    (void)snprintf(path, sizeof path, "%s/hands.js", files);
    return access(path, R_OK) == 0;
}

/* ---- checking ---- */

static mrt_result check_file(const char *path, const char *sha256, error *err)
{
    char sum[TAKE_HASH];
    mrt_result result = hash_file(sum, path, err);
    if (result < 0 || strcmp(sum, sha256) == 0)
        return result;
    return error_set(err, MRT_ERR_FORMAT,
                     "The download is not the file of %s %s (%s). It is not used. Try again later",
                     camera_package_used->name, camera_package_used->version, file_name_of(path));
}

static mrt_result check_all(const char *folder, error *err)
{
    const camera_package *of = camera_package_used;
    char files[LONG_PATH], path[LONG_PATH + 128];
    path_of_files(files, sizeof files, folder);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < of->file_count && result >= 0; ++i) {
        (void)snprintf(path, sizeof path, "%s/%s", files, of->file[i].name);
        result = check_file(path, of->file[i].sha256, err);
    }
    return result;
}

/* ---- folders ---- */

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)about, (void)kind, (void)where;
    (void)remove(path);
    return 0;
}

static void remove_folder(const char *folder)
{
    (void)nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

static _Thread_local uint64_t counted; /* nftw has no data of the caller */

static int count_one(const char *path, const struct stat *about, int kind, struct FTW *where)
{
    (void)path, (void)where;
    if (kind == FTW_F && S_ISREG(about->st_mode))
        counted += (uint64_t)about->st_size;
    return 0;
}

static uint64_t size_of_folder(const char *folder)
{
    counted = 0;
    (void)nftw(folder, count_one, 16, FTW_PHYS);
    return counted;
}

/* Removes what programs left that were killed while they downloaded: "camera.part.PID". */
static void remove_leftovers(const char *folder)
{
    char *above = file_directory(folder), start[64], path[LONG_PATH];
    DIR *all = above ? opendir(above[0] ? above : ".") : NULL;
    (void)snprintf(start, sizeof start, "%s.part.", file_name_of(folder));
    for (struct dirent *one; all && (one = readdir(all)) != NULL;) {
        if (strncmp(one->d_name, start, strlen(start)) != 0)
            continue;
        const long pid = strtol(one->d_name + strlen(start), NULL, 10);
        if (pid <= 0 || kill((pid_t)pid, 0) == 0 || errno != ESRCH)
            continue;
        (void)snprintf(path, sizeof path, "%s%s", above, one->d_name);
        remove_folder(path);
    }
    if (all)
        (void)closedir(all);
    free(above);
}

/* ---- programs ---- */

static mrt_result cancelled(error *err)
{
    return error_set(err, MRT_ERR_IO, "the download was cancelled");
}

/* Runs a program to its end. out_code: its exit code, -1: it did not end by itself. An error: it
 * cannot be started, or the download was cancelled. */
static mrt_result run(camera_fetch *going, const char *const *word, const char *folder,
                      int *out_code, error *err)
{
    char *words[24];
    size_t count = 0;
    pid_t pid = 0;
    int status = 0;
    for (; word[count] && count + 1 < sizeof words / sizeof words[0]; ++count)
        words[count] = program_argument(word[count]);
    words[count] = NULL;
    const int out = going->is_shown ? STDERR_FILENO : -1;
    const program_start how = {.program = words[0],
                               .words = words,
                               .in = -1,
                               .out = out, /* not standard output, which is for facts */
                               .err = out,
                               .signals = going->is_shown ? PROGRAM_SHARES_SIGNALS
                                                          : PROGRAM_USUAL_SIGNALS};
    const int failed = program_spawn(&pid, &how);
    if (failed)
        return error_set(err, MRT_ERR_IO, "cannot run %s: %s", words[0], strerror(failed));
    const int64_t until_ns = clock_now_ns() + patience_ns;
    bool has_ended = false;
    while (!(has_ended = program_ends_within(pid, &status, look_ns)) &&
           !atomic_load(&going->is_cancelled) && clock_now_ns() < until_ns)
        atomic_store(&going->done, size_of_folder(folder));
    if (!has_ended) {
        (void)kill(going->is_shown ? pid : -pid, SIGKILL);
        (void)program_wait(pid, &status, NS_PER_S);
    }
    *out_code = has_ended && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return atomic_load(&going->is_cancelled) ? cancelled(err) : MRT_OK;
}

static mrt_result fetch_with_npm(camera_fetch *going, const char *part, error *err)
{
    const camera_package *of = camera_package_used;
    char what[160];
    int code = 0;
    (void)snprintf(what, sizeof what, "%s@%s", of->name, of->version);
    const char *const word[] = {"npm",
                                "install",
                                "--ignore-scripts",
                                "--no-audit",
                                "--no-fund",
                                "--no-update-notifier",
                                "--save-exact",
                                "--fetch-retries=1",
                                "--fetch-retry-mintimeout=1000",
                                npm_silent,
                                "--prefix",
                                part,
                                what,
                                NULL};
    atomic_store(&going->whole, of->installed_size);
    mrt_result result = run(going, word, part, &code, err);
    if (result < 0 || code == 0)
        return result;
    return error_set(err, MRT_ERR_IO,
                     "npm could not download %s. Check the internet connection, and try again",
                     of->name);
}

/* The host of "https://registry.npmjs.org/x", for messages. */
static void host_of(char *out, size_t capacity, const char *url)
{
    const char *host = strstr(url, "://");
    host = host ? host + 3 : url;
    (void)snprintf(out, capacity, "%.*s", (int)strcspn(host, "/"), host);
}

/* Exit codes of curl, from its manual. */
static mrt_result explain_curl(int code, const char *url, error *err)
{
    enum { NO_PROXY = 5, NO_HOST = 6, NO_CONNECTION = 7, REFUSED = 22, NO_WRITE = 23, SILENT = 28 };
    char host[128];
    host_of(host, sizeof host, url);
    switch (code) {
    case NO_PROXY:
    case NO_HOST:
    case NO_CONNECTION:
        return error_set(err, MRT_ERR_IO,
                         "No connection to %s. Connect to the internet, and try again", host);
    case REFUSED:
        return error_set(err, MRT_ERR_IO, "%s does not have the hand tracker now. Try again later",
                         host);
    case NO_WRITE:
        return error_set(err, MRT_ERR_IO,
                         "The hand tracker cannot be saved. Is the disk full? It needs 40 MB");
    case SILENT:
        return error_set(err, MRT_ERR_IO, "%s does not answer", host);
    default:
        return error_set(err, MRT_ERR_IO, "The download was cut off before its end");
    }
}

static mrt_result fetch_with_curl(camera_fetch *going, const char *part, error *err)
{
    const camera_package *of = camera_package_used;
    const char *registry = getenv(registry_variable);
    char url[1024], archive[LONG_PATH], files[LONG_PATH], most[32];
    int code = 0;
    if (!registry || !registry[0])
        registry = usual_registry;
    const size_t length = strlen(registry);
    (void)snprintf(url, sizeof url, "%s%s%s", registry, registry[length - 1] == '/' ? "" : "/",
                   of->archive);
    (void)snprintf(archive, sizeof archive, "%s/archive.tgz", part);
    (void)snprintf(most, sizeof most, "%llu", (unsigned long long)of->archive_size);
    path_of_files(files, sizeof files, part);
    const char *const get[] = {"curl",
                               "--silent",
                               "--show-error",
                               "--fail",
                               "--location",
                               "--proto",
                               "=http,https",
                               "--connect-timeout",
                               silent_s,
                               "--speed-limit",
                               "1",
                               "--speed-time",
                               silent_s,
                               "--max-filesize",
                               most,
                               "--output",
                               archive,
                               url,
                               NULL};
    const char *const unpack[] = {"tar",
                                  "--extract",
                                  "--gzip",
                                  "--no-same-owner",
                                  "--strip-components=1",
                                  "--file",
                                  archive,
                                  "--directory",
                                  files,
                                  NULL};
    atomic_store(&going->done, 0);
    atomic_store(&going->whole, of->archive_size);
    mrt_result result = run(going, get, part, &code, err);
    if (result >= 0 && code != 0)
        return explain_curl(code, url, err);
    if (result >= 0)
        result = check_file(archive, of->archive_sha256, err);
    if (result >= 0)
        result = file_make_folders(files, err);
    if (result >= 0)
        result = run(going, unpack, archive, &code, err);
    if (result >= 0 && code != 0)
        return error_set(err, MRT_ERR_IO,
                         "tar could not unpack the hand tracker. Is the disk full? It needs 40 MB");
    (void)remove(archive);
    return result;
}

/* ---- all together ---- */

static mrt_result fetch_into(camera_fetch *going, const char *part, error *err)
{
    char path[PATH_MAX];
    const bool has_npm = program_on_path(path, "npm");
    const bool has_curl = program_on_path(path, "curl") && program_on_path(path, "tar");
    if (!has_npm && !has_curl)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "The download needs curl and tar, or npm. Install them (apt install curl "
                         "tar), and try again");
    mrt_result result = file_make_folders(part, err);
    if (result >= 0 && has_npm)
        result = fetch_with_npm(going, part, err);
    if (has_curl && (!has_npm || result < 0) && !atomic_load(&going->is_cancelled))
        result = fetch_with_curl(going, part, err);
    return result < 0 ? result : check_all(part, err);
}

/* Puts the new folder in the place of an older one, if there is one. */
static mrt_result put_in_place(const char *part, const char *folder, error *err)
{
    char old[PATH_MAX + 64];
    (void)snprintf(old, sizeof old, "%s.part.%d.old", folder, (int)getpid());
    const bool has_old = rename(folder, old) == 0;
    mrt_result result = MRT_OK;
    if (rename(part, folder) != 0) {
        result = error_set(err, MRT_ERR_IO, "%s: %s", folder, strerror(errno));
        if (has_old)
            (void)rename(old, folder);
    }
    remove_folder(old);
    return result;
}

mrt_result camera_package_fetch(camera_fetch *going, error *err)
{
    char folder[PATH_MAX], part[PATH_MAX + 64];
    if (own_folder())
        return camera_package_is_there()
                   ? MRT_OK
                   : error_set(err, MRT_ERR_IO,
                               "MAROTTE_CAMERA_PACKAGE: there is no hands.js in %s", own_folder());
    mrt_result result = camera_package_folder(folder, err);
    if (result < 0 || check_all(folder, err) >= 0)
        return result;
    err->text[0] = '\0';
    remove_leftovers(folder);
    (void)snprintf(part, sizeof part, "%s.part.%d", folder, (int)getpid());
    remove_folder(part);
    result = fetch_into(going, part, err);
    if (result >= 0)
        result = put_in_place(part, folder, err);
    if (result < 0)
        remove_folder(part);
    return result;
}
