/* device/terminal.h - a pseudo terminal whose two ends are one thread's, as where a device lives by
 * the virtual clock (virtual_clock.h): what one end writes is waited for at the other, because the
 * system carries it across when it has time. */
#ifndef MAROTTE_TESTS_DEVICE_TERMINAL_H
#define MAROTTE_TESTS_DEVICE_TERMINAL_H
#include <errno.h>
#include <poll.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

static inline int terminal_readable(int slave)
{
    int size = 0;
    return ioctl(slave, FIONREAD, &size) == 0 ? size : 0;
}

/* Until the slave has so many bytes to read. One that is full, or not raw, shows a part of what has
 * arrived: then it is not waited for. */
static inline void terminal_await(int slave, int size)
{
    enum { SHOWN_MAX = 2048 };
    const struct timespec moment = {.tv_nsec = 20000};
    struct termios settings;
    if (size > SHOWN_MAX || tcgetattr(slave, &settings) != 0 || (settings.c_lflag & ICANON))
        return;
    while (terminal_readable(slave) < size)
        nanosleep(&moment, NULL);
}

/* What has been written to the slave, all of it; less: it has gone. */
static inline size_t terminal_receive(int master, unsigned char *out, size_t size)
{
    size_t received = 0;
    while (received < size) {
        struct pollfd file = {.fd = master, .events = POLLIN};
        if (poll(&file, 1, -1) < 0 && errno != EINTR)
            break;
        ssize_t more = read(master, out + received, size - received);
        if (more <= 0 && (file.revents & ~POLLIN))
            break;
        received += more > 0 ? (size_t)more : 0;
    }
    return received;
}

/* Whether `file` is the terminal at this path. */
static inline bool terminal_is(const char *path, int file)
{
    struct stat mine, other;
    return stat(path, &mine) == 0 && fstat(file, &other) == 0 && S_ISCHR(other.st_mode) &&
           other.st_rdev == mine.st_rdev;
}

#endif
