/* A serial port: opened for us alone, 8N1, raw, without the adapter's waiting; or a line that says
 * why not and what to do. */
#include "glove_find.h"
#include "glove_port.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct speed {
    uint32_t baud;
    speed_t code;
} speed;

static const speed speeds[] = {{115200, B115200}, {57600, B57600}, {38400, B38400},
                               {19200, B19200},   {9600, B9600},   {4800, B4800}};

static bool speed_code(uint32_t baud, speed_t *out)
{
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; ++i)
        if (speeds[i].baud == baud) {
            *out = speeds[i].code;
            return true;
        }
    return false;
}

/* A terminal that a program made: no wire, no adapter, and its maker has it open as well. */
static bool is_pseudo(const char *path)
{
    char real[PATH_CAPACITY];
    glove_find_real(path, real, sizeof real);
    return strncmp(real, "/dev/pts/", 9) == 0;
}

static mrt_result say_busy(const char *path, const char *holder, glove_why *why)
{
    return glove_why_set(why, MRT_ERR_IO, "%s is in use by %s: close that first", path,
                         holder[0] ? holder : "another program");
}

/* own: our descriptor of it, or -1. */
static mrt_result explain(const char *path, int failure, int own, glove_why *why)
{
    char advice[384], holder[96];
    switch (failure) {
    case EACCES:
    case EPERM:
        glove_find_advice(path, advice, sizeof advice);
        return glove_why_set(why, MRT_ERR_IO, "%s: no permission: %s", path, advice);
    case EBUSY:
        glove_find_other_holder(path, own, holder, sizeof holder);
        return say_busy(path, holder, why);
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return glove_why_set(why, MRT_ERR_IO, "%s is not there: is the glove plugged in?", path);
    default:
        return glove_why_set(why, MRT_ERR_IO, "%s cannot be opened: %s", path, strerror(failure));
    }
}

/* Nobody else may read from it: two readers would share the bytes out between them. */
static mrt_result take_alone(glove_port *self, const char *path, glove_why *why)
{
    char holder[96] = "";
    bool pseudo = is_pseudo(path);
    int is_taken = 0;
    if (ioctl(self->file, TIOCGEXCL, &is_taken) == 0 && is_taken)
        return explain(path, EBUSY, self->file, why);
    if (flock(self->file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        return explain(path, EBUSY, self->file, why);
    if (pseudo)
        return MRT_OK;
    if (glove_find_other_holder(path, self->file, holder, sizeof holder))
        return say_busy(path, holder, why);
    self->is_exclusive = ioctl(self->file, TIOCEXCL) == 0;
    return MRT_OK;
}

static mrt_result set_line(glove_port *self, const char *path, speed_t code, glove_why *why)
{
    if (tcgetattr(self->file, &self->before) != 0)
        return explain(path, errno, self->file, why);
    self->has_before = true;
    struct termios line = self->before;
    cfmakeraw(&line);
    line.c_cflag |= CLOCAL | CREAD | CS8;
    line.c_cflag &= ~(tcflag_t)(CRTSCTS | CSTOPB | PARENB);
    line.c_iflag &= ~(tcflag_t)(IXON | IXOFF | IXANY);
    line.c_cc[VMIN] = 0;
    line.c_cc[VTIME] = 0;
    cfsetispeed(&line, code);
    cfsetospeed(&line, code);
    if (tcsetattr(self->file, TCSANOW, &line) != 0)
        return explain(path, errno, self->file, why);
    return MRT_OK;
}

static uint32_t read_latency_ms(const char *path)
{
    char text[16] = "";
    int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0)
        return 0;
    ssize_t got = read(file, text, sizeof text - 1);
    close(file);
    return got > 0 ? (uint32_t)strtoul(text, NULL, 10) : 0;
}

static void write_latency(const char *path)
{
    int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0)
        return;
    ssize_t written = write(file, "1", 1);
    (void)written; /* what came of it is read back */
    close(file);
}

/* An FTDI adapter collects bytes for 16 ms unless told not to. */
static void hurry(glove_port *self, const char *path)
{
    struct serial_struct settings;
    if (ioctl(self->file, TIOCGSERIAL, &settings) == 0) {
        settings.flags = (int)((unsigned)settings.flags | ASYNC_LOW_LATENCY);
        ioctl(self->file, TIOCSSERIAL, &settings);
    }
    char real[PATH_CAPACITY];
    glove_find_real(path, real, sizeof real);
    const char *slash = strrchr(real, '/');
    snprintf(self->latency_file, sizeof self->latency_file,
             "/sys/class/tty/%.64s/device/latency_timer", slash ? slash + 1 : real);
    if (read_latency_ms(self->latency_file) > 1)
        write_latency(self->latency_file);
    self->latency_ms = read_latency_ms(self->latency_file);
}

static mrt_result take(glove_port *self, const char *path, speed_t code, glove_why *why)
{
    struct stat about;
    if (fstat(self->file, &about) != 0 || !S_ISCHR(about.st_mode) || !isatty(self->file))
        return glove_why_set(why, MRT_ERR_UNSUPPORTED, "%s is no serial port", path);
    mrt_result result = take_alone(self, path, why);
    if (result < 0)
        return result;
    return set_line(self, path, code, why);
}

mrt_result glove_port_open_serial(glove_port *self, const char *path, uint32_t baud, trace *traced,
                                  glove_why *why)
{
    *self = (glove_port){.file = -1, .trace = traced, .baud = baud};
    snprintf(self->name, sizeof self->name, "%s", path);
    speed_t code;
    if (!speed_code(baud, &code))
        return glove_why_set(why, MRT_ERR_ARGUMENT, "%u baud is no speed of a CyberGlove", baud);
    self->file = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (self->file < 0)
        return explain(path, errno, self->file, why);
    mrt_result result = take(self, path, code, why);
    if (result < 0) {
        glove_port_close(self);
        return result;
    }
    hurry(self, path);
    return MRT_OK;
}
