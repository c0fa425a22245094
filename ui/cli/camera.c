/* `marotte camera`: prints the address of the camera page, and downloads the package that it
 * needs. */
#include "cli/command.h"
#include "cli/facts.h"

#include "base/file.h"
#include "base/program.h"
#include "show/hash.h"
#include "window/app/camera_page.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct camera_options {
    bool is_setup, is_show, is_json;
    uint32_t port;
} camera_options;

static const char package_name[] = "@mediapipe/hands";
static const int64_t npm_patience_ns = 900000000000;

/* Files that the page loads, with their SHA-256 in version CAMERA_PAGE_VERSION of the package. */
static const struct {
    const char *name, *sha256;
} package_file[] = {
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

/* ---- the package ---- */

static mrt_result check_file(const char *folder, size_t index, error *err)
{
    char path[PATH_MAX + 128], sum[TAKE_HASH];
    (void)snprintf(path, sizeof path, "%s/node_modules/%s/%s", folder, package_name,
                   package_file[index].name);
    mrt_result result = hash_file(sum, path, err);
    if (result < 0 || strcmp(sum, package_file[index].sha256) == 0)
        return result;
    return error_set(err, MRT_ERR_FORMAT, "%s: not the file of %s %s. It is not used", path,
                     package_name, CAMERA_PAGE_VERSION);
}

static mrt_result check_package(const char *folder, error *err)
{
    for (size_t i = 0; i < sizeof package_file / sizeof package_file[0]; ++i) {
        mrt_result result = check_file(folder, i, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result run_npm(const char *folder, error *err)
{
    static const char what[] = "@mediapipe/hands@" CAMERA_PAGE_VERSION;
    static const char *const word[] = {"npm",          "install",   "--ignore-scripts",
                                       "--no-audit",   "--no-fund", "--no-update-notifier",
                                       "--save-exact", "--prefix"};
    enum { WORDS = sizeof word / sizeof word[0] };
    char *arguments[WORDS + 3];
    pid_t pid = 0;
    int status = 0;
    for (size_t i = 0; i < WORDS; ++i)
        arguments[i] = program_argument(word[i]);
    arguments[WORDS] = program_argument(folder);
    arguments[WORDS + 1] = program_argument(what);
    arguments[WORDS + 2] = NULL;
    const program_start how = {.program = arguments[0],
                               .words = arguments,
                               .in = STDIN_FILENO,
                               .out = STDERR_FILENO, /* npm's output is not part of the facts */
                               .err = STDERR_FILENO};
    const int failed = program_spawn(&pid, &how);
    if (failed)
        return error_set(err, MRT_ERR_IO, "cannot run npm (%s): install it (apt install npm)",
                         strerror(failed));
    if (program_wait(pid, &status, npm_patience_ns) && WIFEXITED(status) &&
        WEXITSTATUS(status) == 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "npm could not download %s: see its messages above", what);
}

/* Downloads into a folder beside the final one, checks the files, and then renames the folder. */
static mrt_result set_up(facts *told, error *err)
{
    char folder[PATH_MAX], part[PATH_MAX + 32];
    mrt_result result = camera_page_package(folder, err);
    if (result < 0)
        return result;
    if (check_package(folder, err) >= 0) {
        facts_text(told, "package", "package", "is complete");
        facts_text(told, "folder", "folder", folder);
        return MRT_OK;
    }
    if (access(folder, F_OK) == 0)
        return error_set(
            err, MRT_ERR_FORMAT,
            "%s: the files changed since they were downloaded. Remove the folder and try again",
            folder);
    (void)snprintf(part, sizeof part, "%s.%d", folder, (int)getpid());
    fprintf(stderr,
            "downloading %s %s (Apache-2.0, by Google; 24 MB) with npm into\n"
            "  %s\n"
            "It runs only in your browser, and finds hands in the pictures of a webcam.\n",
            package_name, CAMERA_PAGE_VERSION, folder);
    result = file_make_folders(part, err);
    if (result >= 0)
        result = run_npm(part, err);
    if (result >= 0)
        result = check_package(part, err);
    if (result >= 0 && rename(part, folder) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: %s", folder, strerror(errno));
    if (result < 0)
        return result;
    facts_text(told, "package", "package", "downloaded and checked");
    facts_text(told, "folder", "folder", folder);
    return MRT_OK;
}

/* ---- the state ---- */

static bool is_listening(uint16_t port)
{
    const struct sockaddr_in to = {.sin_family = AF_INET,
                                   .sin_port = htons(port),
                                   .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool found = fd >= 0 && connect(fd, (const struct sockaddr *)&to, sizeof to) == 0;
    if (fd >= 0)
        close(fd);
    return found;
}

static mrt_result report(const camera_options *options, facts *told, error *err)
{
    const uint16_t port = (uint16_t)options->port;
    char address[CAMERA_PAGE_ADDRESS];
    error why;
    facts_text(told, "package", "package",
               camera_page_has_package() ? "is installed" : "is missing: marotte camera --setup");
    facts_text(told, "state", "state",
               is_listening(port)
                   ? "open: a browser finds the page at its address"
                   : "not open. Start marotte stage and choose \"Use the camera\", or use "
                     "--input camera");
    if (camera_page_address(address, port, &why) >= 0)
        facts_text(told, "address", "address", address);
    return options->is_show ? camera_page_show(port, err) : MRT_OK;
}

/* ---- the command ---- */

#define AT(member) .offset = offsetof(camera_options, member)
static const command_option option_table[] = {
    {"setup", COMMAND_FLAG, AT(is_setup)},
    {"show", COMMAND_FLAG, AT(is_show)},
    {"port", COMMAND_WHOLE, AT(port), .least = 1, .most = 65535},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

static int run(int argc, char **argv)
{
    camera_options options = {.port = CAMERA_PAGE_PORT};
    error err = {""};
    int code = command_options(&options, &command_camera, option_table, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    facts *told = facts_create(options.is_json ? FACTS_JSON : FACTS_LINES);
    mrt_result result = !told              ? error_set(&err, MRT_ERR_MEMORY, "no memory")
                        : options.is_setup ? set_up(told, &err)
                                           : report(&options, told, &err);
    return command_end(&command_camera, told, result, &err);
}

const command command_camera = {
    .name = "camera",
    .summary = "set up a webcam as an input for a bare hand",
    .help =
        "marotte camera [--port N] [--show] [--json]\n"
        "marotte camera --setup [--json]\n"
        "\n"
        "A page in your browser finds your hand in the pictures of a webcam, and marotte performs\n"
        "with it: \"Use the camera\" on the stage, or --input camera. This command checks the\n"
        "setup and prints the address of the page.\n"
        "\n"
        "  --setup   once: download MediaPipe Hands (the npm package @mediapipe/hands, 24 MB,\n"
        "            Apache-2.0) into your data folder and check its files. Only this needs npm\n"
        "            and the network\n"
        "  --show    open the page in your browser\n"
        "  --port N  the port, as in --input camera:N (9130)\n"
        "  --json    print the facts as JSON\n",
    .examples = "camera\n"
                "camera --json\n"
                "camera --port 9131\n",
    .run = run,
};
