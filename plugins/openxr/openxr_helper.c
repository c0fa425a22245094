#include "openxr_helper.h"
#include "device_io.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const int64_t ns_per_ms = 1000000;
/* Limits of silence. Drivers and services may have to start before the first frame; after it there
 * is one every 5 ms. */
static const int64_t start_ns = 20000000000, silence_ns = 2000000000;
static const int64_t retry_least_ns = 500000000, retry_most_ns = 8000000000;
static const int64_t healthy_ns = 5000000000; /* then the restart delay is reset */
static const int64_t reset_ns = 500000000;

enum { RING = 16 };

typedef struct watcher { /* used only by the watcher thread */
    pid_t pid;           /* 0: none runs */
    int pipe;            /* -1: none runs */
    size_t size;         /* bytes of `record` received */
    openxr_record record;
    int64_t started_ns, heard_ns, retry_ns, next_start_ns;
    bool has_frames; /* of this process */
    clock_map clock;
    bool has_time, has_hands;
    int64_t newest_ns, newest_arrival_ns; /* first time in the writer's clock */
    openxr_hand last[2];
    char last_reason[OPENXR_REASON]; /* last reported failure, until it has run well for a while */
} watcher;

static struct {
    pthread_mutex_t mutex;
    uint32_t user_count;
    /* The fields below are valid only while there is a user. */
    pthread_cond_t changed;
    pthread_t thread;
    int stop; /* an eventfd */
    char program[PATH_MAX];
    openxr_frame frame[RING];
    uint64_t frame_count, text_count;
    int text_kind;
    char text[OPENXR_REASON];
} shared = {.mutex = PTHREAD_MUTEX_INITIALIZER};

/* Held while joining or leaving, until the thread has started or ended. */
static pthread_mutex_t coming_and_going = PTHREAD_MUTEX_INITIALIZER;

bool openxr_helper_find(char *out, size_t capacity, char out_reason[OPENXR_REASON])
{
    static const char name[] = "marotte-openxr-hands";
    const char *own = getenv("MAROTTE_OPENXR_HANDS");
    char program[PATH_MAX];
    int length = -1;
    ssize_t size = readlink("/proc/self/exe", program, sizeof program - 1);
    if (own && own[0]) {
        length = snprintf(out, capacity, "%s", own);
    } else if (size > 0) {
        program[size] = '\0';
        char *slash = strrchr(program, '/');
        length =
            slash ? snprintf(out, capacity, "%.*s/%s", (int)(slash - program), program, name) : -1;
    }
    if (length > 0 && (size_t)length < capacity && access(out, X_OK) == 0)
        return true;
    (void)snprintf(out_reason, OPENXR_REASON,
                   "%s is not next to the program: marotte was built without OpenXR. Install "
                   "libopenxr-dev and build again",
                   name);
    return false;
}

/* ---- messages to the instances ---- */

static void publish_text(int kind, const char *text)
{
    pthread_mutex_lock(&shared.mutex);
    shared.text_kind = kind;
    (void)snprintf(shared.text, sizeof shared.text, "%s", text);
    shared.text_count += 1;
    pthread_cond_broadcast(&shared.changed);
    pthread_mutex_unlock(&shared.mutex);
}

static void publish_frame(const openxr_hand hand[2], int64_t time_ns)
{
    pthread_mutex_lock(&shared.mutex);
    openxr_frame *out = &shared.frame[shared.frame_count % RING];
    out->time_ns = time_ns;
    memcpy(out->hand, hand, sizeof out->hand);
    shared.frame_count += 1;
    pthread_cond_broadcast(&shared.changed);
    pthread_mutex_unlock(&shared.mutex);
}

/* Logs each message once, not for every new attempt. */
static void report_trouble(watcher *self, const char *text)
{
    if (strcmp(self->last_reason, text) == 0)
        return;
    (void)snprintf(self->last_reason, sizeof self->last_reason, "%s", text);
    publish_text(OPENXR_HEARD_TROUBLE, text);
}

/* ---- the process ---- */

static int spawn(pid_t *out_pid, char *program, int pipe_end)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    char *arguments[] = {program, NULL};
    /* The output of runtimes is shown only with XR_LOADER_DEBUG. */
    bool is_loud = getenv("XR_LOADER_DEBUG") != NULL;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    sigemptyset(&none);
    sigfillset(&all);
    failed = posix_spawnattr_init(&attributes);
    if (!failed)
        failed = posix_spawnattr_setsigmask(&attributes, &none);
    if (!failed)
        failed = posix_spawnattr_setsigdefault(&attributes, &all);
    /* A separate process group, because Ctrl-C is for the program. */
    if (!failed)
        failed = posix_spawnattr_setflags(
            &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    if (!failed)
        failed = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (!failed)
        failed =
            posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (!failed && !is_loud)
        failed = posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    if (!failed)
        failed = posix_spawn_file_actions_adddup2(&actions, pipe_end, OPENXR_FD);
    if (!failed)
        failed = posix_spawn(out_pid, program, &actions, &attributes, arguments, environ);
    (void)posix_spawnattr_destroy(&attributes);
    (void)posix_spawn_file_actions_destroy(&actions);
    return failed;
}

static void start(watcher *self, int64_t now_ns)
{
    char text[OPENXR_REASON];
    int end[2];
    int failed = pipe2(end, O_CLOEXEC) == 0 ? 0 : errno;
    if (!failed) {
        failed = spawn(&self->pid, shared.program, end[1]);
        close(end[1]);
        if (failed)
            close(end[0]);
    }
    self->started_ns = self->heard_ns = now_ns;
    self->size = 0;
    self->has_frames = self->has_time = self->has_hands = false;
    clock_map_reset(&self->clock);
    if (!failed) {
        self->pipe = end[0];
        (void)fcntl(self->pipe, F_SETFL, O_NONBLOCK);
        return;
    }
    self->pid = 0;
    self->next_start_ns = now_ns + retry_most_ns;
    (void)snprintf(text, sizeof text, "cannot run %.200s: %s", shared.program, strerror(failed));
    report_trouble(self, text);
}

/* Waits this long for the process to end, then kills it. Does not wait forever for a process that
 * the system blocks. Returns its exit status, 0: unknown. */
static int end(watcher *self, int patience_ms)
{
    int status = 0;
    if (self->pid == 0)
        return 0;
    pid_t gone = 0;
    for (int waited_ms = 0; gone == 0 && waited_ms < patience_ms; waited_ms += 5)
        if ((gone = waitpid(self->pid, &status, WNOHANG)) == 0)
            (void)poll(NULL, 0, 5);
    if (gone == 0)
        (void)kill(self->pid, SIGKILL);
    for (int i = 0; gone == 0 && i < 200; ++i)
        if ((gone = waitpid(self->pid, &status, WNOHANG)) == 0)
            (void)poll(NULL, 0, 5);
    close(self->pipe);
    self->pid = 0;
    self->pipe = -1;
    return gone > 0 ? status : 0;
}

/* Ends the process and schedules a restart. why NULL: it ended without a reason. */
static void give_up(watcher *self, const char *why)
{
    char text[OPENXR_REASON];
    int64_t now_ns = device_clock_ns();
    if (self->has_frames && now_ns - self->started_ns >= healthy_ns) {
        self->retry_ns = retry_least_ns;
        self->last_reason[0] = '\0';
    }
    self->next_start_ns = now_ns + self->retry_ns;
    self->retry_ns = self->retry_ns * 2 < retry_most_ns ? self->retry_ns * 2 : retry_most_ns;
    /* The pipe closes a moment before the process ends: wait for its exit status. */
    int status = end(self, why ? 0 : 200);
    if (why)
        (void)snprintf(text, sizeof text, "%s", why);
    else if (WIFSIGNALED(status))
        (void)snprintf(text, sizeof text,
                       "the OpenXR runtime crashed (%s): hands are held, restarting it",
                       strsignal(WTERMSIG(status)));
    else
        (void)snprintf(text, sizeof text,
                       "the OpenXR runtime ended its program (code %d): restarting it",
                       WIFEXITED(status) ? WEXITSTATUS(status) : 0);
    report_trouble(self, text);
}

/* ---- records ---- */

static const float farthest_m = 1000.0f;

static bool is_sound(const openxr_hand *hand)
{
    if (hand->active != 1)
        return false;
    for (uint32_t i = 0; i < OPENXR_JOINTS; ++i)
        for (int k = 0; k < 3 && (hand->valid >> i & 1u); ++k)
            if (!(fabsf(hand->at[i][k]) <= farthest_m))
                return false;
    return true;
}

static void clean_text(char text[OPENXR_TEXT])
{
    text[OPENXR_TEXT - 1] = '\0';
    for (char *c = text; *c; ++c)
        if (*c < ' ' || *c > '~')
            *c = '?';
}

bool openxr_record_validate(openxr_record *record)
{
    if (record->magic != OPENXR_MAGIC || record->kind < OPENXR_FRAME || record->kind > OPENXR_END)
        return false;
    clean_text(record->text);
    for (int side = 0; side < 2; ++side)
        if (!is_sound(&record->hand[side]))
            memset(&record->hand[side], 0, sizeof record->hand[side]);
    return true;
}

static void take_frame(watcher *self, const openxr_record *record, int64_t arrival_ns)
{
    self->has_frames = true;
    if (record->time_ns != device_time_ns(record->time_ns))
        return; /* out of range */
    /* A frame from the past is dropped; if the clock stays in the past, it was set. */
    if (self->has_time && record->time_ns <= self->newest_ns &&
        arrival_ns - self->newest_arrival_ns < reset_ns)
        return;
    self->has_time = true;
    self->newest_ns = record->time_ns;
    self->newest_arrival_ns = arrival_ns;
    /* Runtimes repeat a frame until the next one. */
    if (self->has_hands && memcmp(self->last, record->hand, sizeof record->hand) == 0)
        return;
    self->has_hands = true;
    memcpy(self->last, record->hand, sizeof record->hand);
    publish_frame(record->hand, clock_map_to_host(&self->clock, record->time_ns, arrival_ns));
}

/* Returns false if this has ended the runtime's program: it sent invalid data, or said that it
 * ends. */
static bool take_record(watcher *self, int64_t arrival_ns)
{
    char line[OPENXR_REASON];
    openxr_record *record = &self->record;
    if (!openxr_record_validate(record)) {
        give_up(self, "the OpenXR runtime's program sent invalid data: restarting it");
        return false;
    }
    self->heard_ns = arrival_ns;
    if (record->kind == OPENXR_FRAME) {
        take_frame(self, record, arrival_ns);
        return true;
    }
    if (record->kind == OPENXR_END) {
        give_up(self, record->text);
        return false;
    }
    if (self->last_reason[0] == '\0') {
        (void)snprintf(line, sizeof line, "hands come from the OpenXR runtime \"%s\"",
                       record->text);
        publish_text(OPENXR_HEARD_NEWS, line);
    }
    return true;
}

/* Reads only a few records at a time, so that a writer that never stops does not block the
 * watcher. */
static void read_records(watcher *self)
{
    for (int i = 0; i < RING; ++i) {
        ssize_t got =
            read(self->pipe, (char *)&self->record + self->size, sizeof self->record - self->size);
        if (got < 0 && (errno == EAGAIN || errno == EINTR))
            return;
        if (got <= 0) {
            give_up(self, NULL);
            return;
        }
        self->size += (size_t)got;
        if (self->size < sizeof self->record)
            continue;
        self->size = 0;
        if (!take_record(self, device_clock_ns()))
            return;
    }
}

static int64_t next_ns(const watcher *self)
{
    if (self->pid == 0)
        return self->next_start_ns;
    return self->heard_ns + (self->has_frames ? silence_ns : start_ns);
}

static void *watch(void *unused)
{
    (void)unused;
    watcher self = {.pipe = -1, .retry_ns = retry_least_ns};
    self.next_start_ns = device_clock_ns();
    for (;;) {
        int64_t now_ns = device_clock_ns();
        if (now_ns >= next_ns(&self)) {
            if (self.pid == 0)
                start(&self, now_ns);
            else
                give_up(&self, "the OpenXR runtime hangs: hands are held, restarting it");
            continue;
        }
        int64_t left_ms = (next_ns(&self) - now_ns) / ns_per_ms + 1;
        struct pollfd wanted[2] = {{shared.stop, POLLIN, 0}, {self.pipe, POLLIN, 0}};
        (void)poll(wanted, 2, (int)left_ms);
        if (wanted[0].revents)
            break;
        if (wanted[1].revents)
            read_records(&self);
    }
    (void)end(&self, 0);
    return NULL;
}

/* ---- joining and leaving ---- */

static bool begin(char out_reason[OPENXR_REASON])
{
    sigset_t all, before;
    if (!openxr_helper_find(shared.program, sizeof shared.program, out_reason))
        return false;
    shared.stop = eventfd(0, EFD_CLOEXEC);
    if (shared.stop < 0) {
        (void)snprintf(out_reason, OPENXR_REASON, "OpenXR: %s", strerror(errno));
        return false;
    }
    device_condition_init(&shared.changed);
    shared.frame_count = shared.text_count = 0;
    sigfillset(&all); /* signals are handled by the program */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    int failed = pthread_create(&shared.thread, NULL, watch, NULL);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (!failed)
        return true;
    (void)snprintf(out_reason, OPENXR_REASON, "OpenXR: cannot start a thread: %s",
                   strerror(failed));
    pthread_cond_destroy(&shared.changed);
    close(shared.stop);
    return false;
}

bool openxr_helper_join(openxr_listener *out, char out_reason[OPENXR_REASON])
{
    pthread_mutex_lock(&coming_and_going);
    bool is_there = shared.user_count > 0 || begin(out_reason);
    if (is_there) {
        pthread_mutex_lock(&shared.mutex);
        shared.user_count += 1;
        *out = (openxr_listener){shared.frame_count,
                                 0}; /* report the current failure to this user again */
        pthread_mutex_unlock(&shared.mutex);
    }
    pthread_mutex_unlock(&coming_and_going);
    return is_there;
}

void openxr_helper_leave(void)
{
    const uint64_t one = 1;
    pthread_mutex_lock(&coming_and_going);
    if (--shared.user_count == 0) {
        (void)!write(shared.stop, &one, sizeof one);
        pthread_join(shared.thread, NULL);
        pthread_cond_destroy(&shared.changed);
        close(shared.stop);
    }
    pthread_mutex_unlock(&coming_and_going);
}

/* ---- hearing ---- */

static int next(openxr_listener *self, openxr_frame *out, char out_text[OPENXR_REASON])
{
    if (self->text_count != shared.text_count) {
        self->text_count = shared.text_count;
        (void)snprintf(out_text, OPENXR_REASON, "%s", shared.text);
        return shared.text_kind;
    }
    if (self->frame_count == shared.frame_count)
        return OPENXR_HEARD_NOTHING;
    uint64_t oldest = shared.frame_count > RING ? shared.frame_count - RING : 0;
    uint64_t lost = self->frame_count < oldest ? oldest - self->frame_count : 0;
    self->frame_count += lost;
    *out = shared.frame[self->frame_count % RING];
    out->lost = (uint32_t)lost;
    self->frame_count += 1;
    return OPENXR_HEARD_FRAME;
}

int openxr_helper_wait(openxr_listener *self, openxr_frame *out, char out_text[OPENXR_REASON],
                       int64_t until_ns)
{
    pthread_mutex_lock(&shared.mutex);
    int heard = next(self, out, out_text);
    while (heard == OPENXR_HEARD_NOTHING &&
           device_condition_wait(&shared.changed, &shared.mutex, until_ns))
        heard = next(self, out, out_text);
    pthread_mutex_unlock(&shared.mutex);
    return heard;
}
