#include "window/app/camera_page.h"
#include "window/app/browser.h"

#include "base/file.h"
#include "base/program.h"
#include "stage/mapping/services.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { TOKEN = 32, LONGEST_TOKEN = 256 };
static const int64_t patience_ns = 2000000000;

uint16_t camera_page_port(const char *input_text)
{
    const char *colon = strchr(input_text, ':'), *comma = strchr(input_text, ',');
    if (!colon || (comma && comma < colon))
        return CAMERA_PAGE_PORT;
    unsigned long port = strtoul(colon + 1, NULL, 10);
    return port >= 1 && port <= 65535 ? (uint16_t)port : CAMERA_PAGE_PORT;
}

/* As plugins/camera/camera.c wrote it. */
mrt_result camera_page_address(char out[CAMERA_PAGE_ADDRESS], uint16_t port, error *err)
{
    char folder[PATH_MAX], path[PATH_MAX + 16];
    file_bytes token;
    mrt_result result = services_settings_folder(CAMERA_PAGE_PLUGIN, folder, sizeof folder, err);
    if (result < 0)
        return result;
    (void)snprintf(path, sizeof path, "%s/token", folder);
    error why;
    if (file_read(&token, path, LONGEST_TOKEN, &why) < 0)
        return error_set(err, MRT_ERR_IO,
                         "the camera was never opened: use --input camera, or press \"Use the "
                         "camera\" on the stage");
    const char *text = (const char *)token.data;
    bool is_good = token.size == TOKEN && strspn(text, "0123456789abcdef") == TOKEN;
    if (is_good)
        (void)snprintf(out, CAMERA_PAGE_ADDRESS, "http://127.0.0.1:%u/%s/", (unsigned)port, text);
    file_bytes_finish(&token);
    return is_good
               ? MRT_OK
               : error_set(err, MRT_ERR_FORMAT, "%s: was not written by marotte: remove it", path);
}

mrt_result camera_page_show(uint16_t port, error *err)
{
    char address[CAMERA_PAGE_ADDRESS];
    const mrt_result result = camera_page_address(address, port, err);
    return result < 0 ? result : browser_show(address, err);
}

/* Writes the first letters that the program prints. */
static bool read_program(char *out, size_t capacity, char *const *words)
{
    int end[2], status = 0;
    pid_t pid = 0;
    error err;
    out[0] = '\0';
    if (program_pipe(end, &err) < 0)
        return false;
    const program_start how = {
        .program = words[0], .words = words, .in = -1, .out = end[1], .err = -1};
    const bool runs = program_spawn(&pid, &how) == 0;
    close(end[1]);
    const bool has_ended = runs && program_wait(pid, &status, patience_ns);
    const ssize_t size = has_ended ? read(end[0], out, capacity - 1) : 0;
    out[size > 0 ? size : 0] = '\0';
    close(end[0]);
    return size > 0;
}

bool camera_page_has_browser(void)
{
    char path[PATH_MAX], text[256];
    const char *own = getenv("MAROTTE_BROWSER"), *usual = getenv("BROWSER");
    if (own && own[0])
        return program_on_path(path, own);
    if (!program_on_path(path, "xdg-open"))
        return false;
    if ((usual && usual[0]) || program_on_path(path, "x-www-browser"))
        return true;
    char *const words[] = {program_argument("xdg-mime"), program_argument("query"),
                           program_argument("default"), program_argument("x-scheme-handler/http"),
                           NULL};
    return program_on_path(path, words[0]) && read_program(text, sizeof text, words);
}
