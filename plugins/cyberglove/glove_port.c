#include "glove_port.h"

#include "device_io.h"
#include "glove_find.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- errors ---- */

mrt_result glove_error_set(glove_error *out, mrt_result code, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    vsnprintf(out->text, sizeof out->text, format, values);
    va_end(values);
    return code;
}

void glove_error_hex(char *out, size_t capacity, const unsigned char *bytes, size_t count)
{
    size_t used = (size_t)snprintf(out, capacity, "%s", count > 0 ? "" : "nothing");
    for (size_t i = 0; i < count && used + 4 <= capacity; ++i)
        used += (size_t)snprintf(out + used, capacity - used, "%s%02x", i > 0 ? " " : "", bytes[i]);
}

/* ---- bytes, for both kinds ---- */

enum { EMPTY_READS_MAX = 3, BITS_PER_BYTE = 10 };
static const int64_t NS_PER_S = 1000000000, NS_PER_MS = 1000000;
static const int64_t write_limit_ns = 250000000, drain_limit_ns = 100000000;
static const size_t flush_limit = 65536;

/* Rounded up, so that the wait is over after it; at most a minute. */
static int poll_ms(int64_t wait_ns)
{
    if (wait_ns <= 0)
        return 0;
    if (wait_ns > 60 * NS_PER_S)
        wait_ns = 60 * NS_PER_S;
    return (int)((wait_ns + NS_PER_MS - 1) / NS_PER_MS);
}

/* Returns revents; 0: nothing before the deadline; -1: error. */
static int wait_for(const glove_port *self, short events, int64_t deadline_ns)
{
    for (;;) {
        struct pollfd wanted = {.fd = self->file, .events = events};
        int64_t now_ns = device_clock_ns();
        int ready = poll(&wanted, 1, poll_ms(deadline_ns - now_ns));
        if (ready > 0)
            return wanted.revents;
        if (ready < 0 && errno != EINTR)
            return -1;
        if (device_clock_ns() >= deadline_ns)
            return 0;
    }
}

/* Interprets a read without bytes. A port that is repeatedly ready without bytes was lost. */
static int without_bytes(glove_port *self, ssize_t got, int ready)
{
    bool would_wait = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    if (ready & (POLLHUP | POLLERR | POLLNVAL))
        return -1;
    if (got < 0 && !would_wait)
        return -1;
    if (got == 0 && self->baud == 0)
        return -1;
    self->empty_reads += 1;
    return self->empty_reads > EMPTY_READS_MAX ? -1 : 0;
}

int glove_port_read(glove_port *self, unsigned char *out, size_t capacity, int64_t deadline_ns)
{
    if (self->file < 0)
        return -1;
    int ready = wait_for(self, POLLIN, deadline_ns);
    if (ready == 0)
        return 0;
    if (ready < 0)
        return -1;
    ssize_t got = read(self->file, out, capacity);
    if (got <= 0)
        return without_bytes(self, got, ready);
    self->empty_reads = 0;
    trace_received(self->trace, device_clock_ns(), out, (size_t)got);
    return (int)got;
}

/* Sends without SIGPIPE, so that a closed connection does not end the program. */
static ssize_t send_some(const glove_port *self, const unsigned char *bytes, size_t size)
{
    return self->baud == 0 ? send(self->file, bytes, size, MSG_NOSIGNAL)
                           : write(self->file, bytes, size);
}

bool glove_port_write(glove_port *self, const void *bytes, size_t size)
{
    if (self->file < 0)
        return false;
    const unsigned char *from = bytes;
    trace_sent(self->trace, device_clock_ns(), bytes, size);
    int64_t deadline_ns = device_clock_ns() + write_limit_ns;
    while (size > 0) {
        int ready = wait_for(self, POLLOUT, deadline_ns);
        if (ready <= 0 || !(ready & POLLOUT))
            return false;
        ssize_t sent = send_some(self, from, size);
        if (sent < 0 && errno != EAGAIN && errno != EINTR)
            return false;
        if (sent > 0) {
            from += sent;
            size -= (size_t)sent;
        } else if (device_clock_ns() >= deadline_ns) {
            return false;
        }
    }
    return true;
}

void glove_port_flush(glove_port *self)
{
    if (self->file < 0)
        return;
    if (self->baud > 0) {
        tcflush(self->file, TCIOFLUSH);
        return;
    }
    unsigned char bytes[512];
    for (size_t all = 0; all < flush_limit;) {
        ssize_t got = recv(self->file, bytes, sizeof bytes, MSG_DONTWAIT);
        if (got <= 0)
            return;
        all += (size_t)got;
    }
}

void glove_port_drain(const glove_port *self)
{
    if (self->file < 0 || self->baud == 0)
        return;
    int64_t deadline_ns = device_clock_ns() + drain_limit_ns;
    int waiting = 0;
    while (ioctl(self->file, TIOCOUTQ, &waiting) == 0 && waiting > 0 &&
           device_clock_ns() < deadline_ns) {
        const struct timespec moment = {.tv_nsec = NS_PER_MS};
        nanosleep(&moment, NULL);
    }
}

int64_t glove_port_wire_ns(const glove_port *self, size_t bytes)
{
    return self->baud > 0 ? (int64_t)bytes * BITS_PER_BYTE * NS_PER_S / self->baud : 0;
}

void glove_port_close(glove_port *self)
{
    if (self->file < 0)
        return;
    if (self->baud > 0) {
        /* Discard unsent bytes: they would block close() for half a minute. */
        int waiting = 0;
        bool is_stuck = ioctl(self->file, TIOCOUTQ, &waiting) == 0 && waiting > 0;
        tcflush(self->file, is_stuck ? TCIOFLUSH : TCIFLUSH);
        if (self->has_before)
            tcsetattr(self->file, TCSANOW, &self->before);
        if (self->is_exclusive)
            ioctl(self->file, TIOCNXCL);
    }
    close(self->file);
    self->file = -1;
}

/* ---- a serial port ---- */

/* Opens the port exclusively, 8N1, raw, without the adapter's delay; on failure sets the reason and
 * advice. */

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

/* Returns true for a pseudo terminal: it has no wire and no adapter, and its creator has it open as
 * well. */
static bool is_pseudo(const char *path)
{
    char real[PATH_CAPACITY];
    glove_find_real(path, real, sizeof real);
    return strncmp(real, "/dev/pts/", 9) == 0;
}

static mrt_result report_busy(const char *path, const char *holder, glove_error *why)
{
    return glove_error_set(why, MRT_ERR_IO, "%s is in use by %s: close that program first", path,
                           holder[0] ? holder : "another program");
}

/* own: our descriptor of the port, or -1. */
static mrt_result explain(const char *path, int failure, int own, glove_error *why)
{
    char advice[384], holder[96];
    switch (failure) {
    case EACCES:
    case EPERM:
        glove_find_advice(path, advice, sizeof advice);
        return glove_error_set(why, MRT_ERR_IO, "%s: no permission: %s", path, advice);
    case EBUSY:
        glove_find_other_holder(path, own, holder, sizeof holder);
        return report_busy(path, holder, why);
    case ENOENT:
    case ENODEV:
    case ENXIO:
        return glove_error_set(why, MRT_ERR_IO, "%s does not exist: is the glove plugged in?",
                               path);
    default:
        return glove_error_set(why, MRT_ERR_IO, "cannot open %s: %s", path, strerror(failure));
    }
}

/* Locks the port, because two readers would get only parts of the bytes. */
static mrt_result lock_port(glove_port *self, const char *path, glove_error *why)
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
        return report_busy(path, holder, why);
    self->is_exclusive = ioctl(self->file, TIOCEXCL) == 0;
    return MRT_OK;
}

static mrt_result set_line(glove_port *self, const char *path, speed_t code, glove_error *why)
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
    char text[16];
    device_read_line(path, text, sizeof text);
    return (uint32_t)strtoul(text, NULL, 10);
}

static void write_latency(const char *path)
{
    int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0)
        return;
    ssize_t written = write(file, "1", 1);
    (void)written; /* the result is read back */
    close(file);
}

/* Turns off the delay of an FTDI adapter, which collects bytes for 16 ms by default. */
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

static mrt_result take(glove_port *self, const char *path, speed_t code, glove_error *why)
{
    struct stat about;
    if (fstat(self->file, &about) != 0 || !S_ISCHR(about.st_mode) || !isatty(self->file))
        return glove_error_set(why, MRT_ERR_UNSUPPORTED, "%s is not a serial port", path);
    mrt_result result = lock_port(self, path, why);
    if (result < 0)
        return result;
    return set_line(self, path, code, why);
}

mrt_result glove_port_open_serial(glove_port *self, const char *path, uint32_t baud, trace *traced,
                                  glove_error *why)
{
    *self = (glove_port){.file = -1, .trace = traced, .baud = baud};
    snprintf(self->name, sizeof self->name, "%s", path);
    speed_t code;
    if (!speed_code(baud, &code))
        return glove_error_set(why, MRT_ERR_ARGUMENT, "a CyberGlove does not support %u baud",
                               baud);
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

/* ---- the wireless CyberGlove III: a TCP connection ---- */

/* Only numeric addresses, because a name lookup can take half a minute. */

typedef struct tcp_address {
    char host[96], service[8];
} tcp_address;

/* "HOST:PORT", "[HOST]:PORT" */
static bool split(const char *address, tcp_address *out)
{
    const char *colon = strrchr(address, ':');
    if (!colon || colon == address)
        return false;
    size_t host_length = (size_t)(colon - address);
    size_t digits = strspn(colon + 1, "0123456789");
    if (digits == 0 || digits > 5 || colon[1 + digits] != '\0')
        return false;
    long port = strtol(colon + 1, NULL, 10);
    if (port < 1 || port > 65535)
        return false;
    if (address[0] == '[') {
        if (host_length < 3 || address[host_length - 1] != ']')
            return false;
        address += 1;
        host_length -= 2;
    }
    if (host_length >= sizeof out->host)
        return false;
    memcpy(out->host, address, host_length);
    out->host[host_length] = '\0';
    memcpy(out->service, colon + 1, digits + 1);
    if (strcmp(out->host, "localhost") == 0)
        snprintf(out->host, sizeof out->host, "127.0.0.1");
    return true;
}

/* 0: connected; else an errno. */
static int connect_by(int file, const struct addrinfo *to, int64_t deadline_ns)
{
    if (connect(file, to->ai_addr, to->ai_addrlen) == 0)
        return 0;
    if (errno != EINPROGRESS)
        return errno;
    int64_t wait_ns = deadline_ns - device_clock_ns();
    struct pollfd wanted = {.fd = file, .events = POLLOUT};
    if (poll(&wanted, 1, wait_ns > 0 ? (int)(wait_ns / 1000000) + 1 : 0) <= 0)
        return ETIMEDOUT;
    int failure = 0;
    socklen_t size = sizeof failure;
    if (getsockopt(file, SOL_SOCKET, SO_ERROR, &failure, &size) != 0)
        return errno;
    return failure;
}

static int open_socket(const struct addrinfo *to)
{
    int file = socket(to->ai_family, SOCK_STREAM, 0);
    if (file < 0)
        return -1;
    int one = 1;
    setsockopt(file, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    if (fcntl(file, F_SETFD, FD_CLOEXEC) != 0 || fcntl(file, F_SETFL, O_NONBLOCK) != 0) {
        close(file);
        return -1;
    }
    return file;
}

mrt_result glove_port_open_tcp(glove_port *self, const char *address, int64_t deadline_ns,
                               trace *traced, glove_error *why)
{
    *self = (glove_port){.file = -1, .trace = traced};
    snprintf(self->name, sizeof self->name, "%s", address);
    tcp_address parts;
    if (!split(address, &parts))
        return glove_error_set(why, MRT_ERR_ARGUMENT,
                               "tcp:%.80s: expected tcp:ADDRESS:PORT, as in tcp:192.168.1.5:3000",
                               address);
    struct addrinfo hints = {.ai_socktype = SOCK_STREAM,
                             .ai_flags = AI_NUMERICHOST | AI_NUMERICSERV};
    struct addrinfo *to = NULL;
    if (getaddrinfo(parts.host, parts.service, &hints, &to) != 0)
        return glove_error_set(
            why, MRT_ERR_ARGUMENT,
            "tcp:%.80s: write the glove's address as numbers, as in tcp:192.168.1.5:3000", address);
    int file = open_socket(to);
    int failure = file < 0 ? errno : connect_by(file, to, deadline_ns);
    freeaddrinfo(to);
    if (failure == 0) {
        self->file = file;
        return MRT_OK;
    }
    if (file >= 0)
        close(file);
    return glove_error_set(
        why, MRT_ERR_IO, "%.80s: no connection (%s): is the glove switched on and in this network?",
        address, strerror(failure));
}
