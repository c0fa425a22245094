#include "keys.h"

#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

static struct termios before; /* of the terminal, to be put back */
static bool is_changed, is_registered;

void keys_end(void)
{
    if (is_changed)
        (void)tcsetattr(STDIN_FILENO, TCSANOW, &before);
    is_changed = false;
}

bool keys_begin(void)
{
    if (is_changed)
        return true;
    /* Changing the terminal from the background would stop the process. */
    if (isatty(STDIN_FILENO) != 1 || tcgetpgrp(STDIN_FILENO) != getpgrp() ||
        tcgetattr(STDIN_FILENO, &before) != 0)
        return false;
    struct termios keys = before;
    keys.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
    keys.c_cc[VMIN] = 0;
    keys.c_cc[VTIME] = 0;
    if (!is_registered)
        is_registered = atexit(keys_end) == 0;
    is_changed = tcsetattr(STDIN_FILENO, TCSANOW, &keys) == 0;
    return is_changed;
}

char keys_next(void)
{
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    char key = 0;
    if (!is_changed || poll(&input, 1, 0) != 1 || read(STDIN_FILENO, &key, 1) != 1)
        return 0;
    return key == '\r' ? '\n' : key;
}
