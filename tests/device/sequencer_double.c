/* A double of ALSA's sequencer for machines whose kernel has none: clients of this process, their
 * ports, subscriptions and announcements, by the names that libasound gives them, so that what was
 * built against libasound finds this first. Linked before it; its coder (snd_midi_event_*) stays
 * the real one. A client called "device ..." stands for one of the kernel's. */
#define _GNU_SOURCE
#include <alsa/asoundlib.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdbool.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { CLIENTS = 8, PORTS = 4, QUEUE = 512, SUBSCRIPTIONS = 64, FIRST_CLIENT = 128 };
#define HERE __attribute__((visibility("default")))

typedef struct double_port {
    char name[64];
    unsigned capability, type;
} double_port;

struct _snd_seq {
    bool is_used, ran_over;
    char name[64];
    double_port port[PORTS];
    int port_count;
    snd_seq_event_t queue[QUEUE], given;
    int first, count, ends[2]; /* ends: of a pipe that holds a byte for each event */
};
struct _snd_seq_client_info {
    int client;
};
struct _snd_seq_port_info {
    snd_seq_addr_t at;
    int client, port; /* -1: before the first */
};

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static snd_seq_t clients[CLIENTS];
static struct subscription {
    bool is_used;
    snd_seq_addr_t from, to;
} subscriptions[SUBSCRIPTIONS];

static snd_seq_t *client_of(int number)
{
    int index = number - FIRST_CLIENT;
    return index >= 0 && index < CLIENTS && clients[index].is_used ? &clients[index] : NULL;
}

static double_port *port_of(int client, int port)
{
    snd_seq_t *of = client_of(client);
    return of && port >= 0 && port < of->port_count ? &of->port[port] : NULL;
}

static bool is_at(snd_seq_addr_t a, snd_seq_addr_t b)
{
    return a.client == b.client && a.port == b.port;
}

static snd_seq_addr_t address(int client, int port)
{
    return (snd_seq_addr_t){(unsigned char)client, (unsigned char)port};
}

static void queue_event(snd_seq_t *to, const snd_seq_event_t *event)
{
    if (to->count == QUEUE) {
        to->ran_over = true;
        return;
    }
    to->queue[(to->first + to->count++) % QUEUE] = *event;
    (void)!write(to->ends[1], "", 1);
}

static void send_event(const snd_seq_event_t *event)
{
    for (int i = 0; i < SUBSCRIPTIONS; ++i) {
        const struct subscription *s = &subscriptions[i];
        snd_seq_t *to = s->is_used ? client_of(s->to.client) : NULL;
        if (to && is_at(s->from, event->source))
            queue_event(to, event);
    }
}

static void announce(int type, int client, int port)
{
    snd_seq_event_t event;
    memset(&event, 0, sizeof event);
    event.type = (snd_seq_event_type_t)type;
    event.source = address(SND_SEQ_CLIENT_SYSTEM, SND_SEQ_PORT_SYSTEM_ANNOUNCE);
    event.data.addr = address(client, port);
    send_event(&event);
}

static int subscribe(snd_seq_addr_t from, snd_seq_addr_t to)
{
    for (int i = 0; i < SUBSCRIPTIONS; ++i)
        if (!subscriptions[i].is_used) {
            subscriptions[i] = (struct subscription){true, from, to};
            return 0;
        }
    return -ENOMEM;
}

/* ---- clients ---- */

HERE int snd_seq_open(snd_seq_t **out, const char *name, int streams, int mode)
{
    (void)name;
    (void)streams;
    (void)mode;
    pthread_mutex_lock(&lock);
    *out = NULL;
    for (int i = 0; i < CLIENTS && !*out; ++i)
        *out = clients[i].is_used ? NULL : &clients[i];
    if (*out && pipe2((*out)->ends, O_NONBLOCK | O_CLOEXEC) == 0) {
        (*out)->is_used = true;
        (*out)->port_count = (*out)->first = (*out)->count = 0;
        announce(SND_SEQ_EVENT_CLIENT_START, (int)(*out - clients) + FIRST_CLIENT, 0);
    }
    pthread_mutex_unlock(&lock);
    return *out ? 0 : -ENOMEM;
}

HERE int snd_seq_close(snd_seq_t *seq)
{
    pthread_mutex_lock(&lock);
    const int number = (int)(seq - clients) + FIRST_CLIENT;
    for (int i = 0; i < SUBSCRIPTIONS; ++i)
        if (subscriptions[i].to.client == number || subscriptions[i].from.client == number)
            subscriptions[i].is_used = false;
    for (int port = 0; port < seq->port_count; ++port)
        announce(SND_SEQ_EVENT_PORT_EXIT, number, port);
    announce(SND_SEQ_EVENT_CLIENT_EXIT, number, 0);
    close(seq->ends[0]);
    close(seq->ends[1]);
    seq->is_used = false;
    pthread_mutex_unlock(&lock);
    return 0;
}

HERE int snd_seq_client_id(snd_seq_t *seq)
{
    return (int)(seq - clients) + FIRST_CLIENT;
}

HERE int snd_seq_set_client_name(snd_seq_t *seq, const char *name)
{
    (void)snprintf(seq->name, sizeof seq->name, "%s", name);
    return 0;
}

HERE int snd_seq_set_client_pool_input(snd_seq_t *seq, size_t size)
{
    (void)seq;
    return size > 0 ? 0 : -EINVAL;
}

HERE int snd_seq_create_simple_port(snd_seq_t *seq, const char *name, unsigned capability,
                                    unsigned type)
{
    if (seq->port_count == PORTS)
        return -ENOMEM;
    double_port *port = &seq->port[seq->port_count];
    port->capability = capability;
    port->type = type;
    (void)snprintf(port->name, sizeof port->name, "%s", name);
    pthread_mutex_lock(&lock);
    announce(SND_SEQ_EVENT_PORT_START, snd_seq_client_id(seq), seq->port_count++);
    pthread_mutex_unlock(&lock);
    return seq->port_count - 1;
}

/* ---- what there is ---- */

HERE size_t snd_seq_client_info_sizeof(void)
{
    return sizeof(snd_seq_client_info_t);
}

HERE void snd_seq_client_info_set_client(snd_seq_client_info_t *info, int client)
{
    info->client = client;
}

HERE int snd_seq_client_info_get_client(const snd_seq_client_info_t *info)
{
    return info->client;
}

HERE const char *snd_seq_client_info_get_name(snd_seq_client_info_t *info)
{
    const snd_seq_t *of = client_of(info->client);
    return of ? of->name : "System";
}

HERE snd_seq_client_type_t snd_seq_client_info_get_type(const snd_seq_client_info_t *info)
{
    const snd_seq_t *of = client_of(info->client);
    const bool is_program = of && strncmp(of->name, "device ", 7) != 0;
    return is_program ? SND_SEQ_USER_CLIENT : SND_SEQ_KERNEL_CLIENT;
}

HERE int snd_seq_client_info_get_num_ports(const snd_seq_client_info_t *info)
{
    const snd_seq_t *of = client_of(info->client);
    return of ? of->port_count : 2;
}

HERE int snd_seq_query_next_client(snd_seq_t *seq, snd_seq_client_info_t *info)
{
    (void)seq;
    if (info->client < SND_SEQ_CLIENT_SYSTEM) {
        info->client = SND_SEQ_CLIENT_SYSTEM;
        return 0;
    }
    for (int next = info->client + 1; next < FIRST_CLIENT + CLIENTS; ++next)
        if (client_of(next)) {
            info->client = next;
            return 0;
        }
    return -ENOENT;
}

HERE size_t snd_seq_port_info_sizeof(void)
{
    return sizeof(snd_seq_port_info_t);
}

HERE void snd_seq_port_info_set_client(snd_seq_port_info_t *info, int client)
{
    info->client = client;
}

HERE void snd_seq_port_info_set_port(snd_seq_port_info_t *info, int port)
{
    info->port = port;
}

HERE int snd_seq_query_next_port(snd_seq_t *seq, snd_seq_port_info_t *info)
{
    (void)seq;
    if (!port_of(info->client, info->port + 1))
        return -ENOENT;
    info->port += 1;
    info->at = address(info->client, info->port);
    return 0;
}

HERE const snd_seq_addr_t *snd_seq_port_info_get_addr(const snd_seq_port_info_t *info)
{
    return &info->at;
}

HERE const char *snd_seq_port_info_get_name(const snd_seq_port_info_t *info)
{
    return port_of(info->client, info->port)->name;
}

HERE unsigned snd_seq_port_info_get_capability(const snd_seq_port_info_t *info)
{
    return port_of(info->client, info->port)->capability;
}

HERE unsigned snd_seq_port_info_get_type(const snd_seq_port_info_t *info)
{
    return port_of(info->client, info->port)->type;
}

/* ---- subscriptions and events ---- */

HERE int snd_seq_connect_from(snd_seq_t *seq, int port, int client, int from)
{
    const unsigned wanted = SND_SEQ_PORT_CAP_READ | SND_SEQ_PORT_CAP_SUBS_READ;
    const double_port *source = port_of(client, from);
    const bool is_system = client == SND_SEQ_CLIENT_SYSTEM && from == SND_SEQ_PORT_SYSTEM_ANNOUNCE;
    if (!is_system && (!source || (source->capability & wanted) != wanted))
        return source ? -EPERM : -ENODEV;
    pthread_mutex_lock(&lock);
    int result = subscribe(address(client, from), address(snd_seq_client_id(seq), port));
    pthread_mutex_unlock(&lock);
    return result;
}

HERE int snd_seq_connect_to(snd_seq_t *seq, int port, int client, int to)
{
    const unsigned wanted = SND_SEQ_PORT_CAP_WRITE | SND_SEQ_PORT_CAP_SUBS_WRITE;
    const double_port *listener = port_of(client, to);
    if (!listener || (listener->capability & wanted) != wanted)
        return listener ? -EPERM : -ENODEV;
    pthread_mutex_lock(&lock);
    int result = subscribe(address(snd_seq_client_id(seq), port), address(client, to));
    pthread_mutex_unlock(&lock);
    return result;
}

HERE int snd_seq_poll_descriptors(snd_seq_t *seq, struct pollfd *out, unsigned capacity,
                                  short events)
{
    if (capacity == 0)
        return 0;
    *out = (struct pollfd){.fd = seq->ends[0], .events = events};
    return 1;
}

HERE int snd_seq_event_input(snd_seq_t *seq, snd_seq_event_t **out)
{
    char byte;
    int result = -EAGAIN;
    pthread_mutex_lock(&lock);
    if (seq->ran_over) {
        seq->ran_over = false;
        result = -ENOSPC;
    } else if (seq->count > 0) {
        (void)!read(seq->ends[0], &byte, 1);
        seq->given = seq->queue[seq->first];
        seq->first = (seq->first + 1) % QUEUE;
        seq->count -= 1;
        *out = &seq->given;
        result = 1;
    }
    pthread_mutex_unlock(&lock);
    return result;
}

HERE int snd_seq_event_output_direct(snd_seq_t *seq, snd_seq_event_t *event)
{
    event->source.client = (unsigned char)snd_seq_client_id(seq);
    pthread_mutex_lock(&lock);
    send_event(event);
    pthread_mutex_unlock(&lock);
    return (int)sizeof *event;
}

/* ---- the kernel's node ---- */

HERE int access(const char *path, int mode)
{
    if (strcmp(path, "/dev/snd/seq") == 0 && !getenv("MAROTTE_TEST_NO_SEQUENCER"))
        return 0;
    return (int)syscall(SYS_faccessat, AT_FDCWD, path, mode);
}
