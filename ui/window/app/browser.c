#include "window/app/browser.h"

#include "base/program.h"

#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

static const int64_t patience_ns = 2000000000;

static const char *browser_program(void)
{
    const char *own = getenv("MAROTTE_BROWSER");
    return own && own[0] ? own : "xdg-open";
}

mrt_result browser_start(pid_t *out, const char *address, error *err)
{
    const char *program = browser_program();
    char *const words[] = {program_argument(program), program_argument(address), NULL};
    const program_start how = {.program = program,
                               .words = words,
                               .in = -1,
                               .out = -1,
                               .err = -1,
                               .signals = PROGRAM_USUAL_SIGNALS};
    const int failed = program_spawn(out, &how);
    return failed ? error_set(err, MRT_ERR_IO, "cannot run %s (%s): open %s in a browser", program,
                              strerror(failed), address)
                  : MRT_OK;
}

mrt_result browser_ended(int status, const char *address, error *err)
{
    return WIFEXITED(status) && WEXITSTATUS(status) == 0
               ? MRT_OK
               : error_set(err, MRT_ERR_IO, "%s found no browser. Open %s in a browser",
                           browser_program(), address);
}

/* xdg-open returns immediately, even if it starts a browser that keeps running; what
 * $MAROTTE_BROWSER names may be the browser itself. */
mrt_result browser_show(const char *address, error *err)
{
    pid_t pid = 0;
    int status = 0;
    const mrt_result result = browser_start(&pid, address, err);
    if (result < 0 || !program_ends_within(pid, &status, patience_ns))
        return result;
    return browser_ended(status, address, err);
}
