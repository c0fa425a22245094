/* `marotte camera`: prints the address of the camera page, and downloads the package that it
 * needs. */
#include "cli/command.h"
#include "cli/facts.h"

#include "window/app/camera_package.h"
#include "window/app/camera_page.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct camera_options {
    bool is_setup, is_show, is_json;
    uint32_t port;
} camera_options;

/* ---- the package ---- */

static mrt_result set_up(facts *told, error *err)
{
    const camera_package *of = camera_package_used;
    camera_fetch going = {.is_shown = true};
    char folder[PATH_MAX];
    mrt_result result = camera_package_folder(folder, err);
    if (result < 0)
        return result;
    fprintf(stderr,
            "checking %s %s in\n"
            "  %s\n"
            "What is missing is downloaded: %.0f MB (Apache-2.0, by Google). It runs only in your\n"
            "browser, and finds hands in the pictures of a webcam.\n",
            of->name, of->version, folder, 1e-6 * (double)of->archive_size);
    result = camera_package_fetch(&going, err);
    if (result < 0)
        return result;
    facts_text(told, "package", "package",
               atomic_load(&going.whole) ? "downloaded and checked" : "is complete");
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
               camera_package_is_there() ? "is installed" : "is missing: marotte camera --setup");
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
        "  --setup   once: download MediaPipe Hands (the npm package @mediapipe/hands, 13 MB,\n"
        "            Apache-2.0) into your data folder and check its files, with npm or with curl\n"
        "            and tar. The stage does the same when you press \"Camera\". Only this needs\n"
        "            the network\n"
        "  --show    open the page in your browser\n"
        "  --port N  the port, as in --input camera:N (9130)\n"
        "  --json    print the facts as JSON\n",
    .examples = "camera\n"
                "camera --json\n"
                "camera --port 9131\n",
    .run = run,
    .options = option_table,
};
