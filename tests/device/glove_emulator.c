#include "glove_emulator.h"

#include "base/clock.h"
#include "glove_motion.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/select.h>
#include <unistd.h>

enum { NOISE_BYTES = 12, CONTROL_LINE = 64 };
static const int64_t noise_period_ns = 10 * NS_PER_MS;

enum { TRUTH_ROWS = 1024 }; /* more than the line can queue */
typedef struct truth_row {
    uint32_t number;
    int64_t sample_ns;
    glove_spoil spoil;
    uint32_t size;
    uint8_t record[GLOVE_RECORD_MAX]; /* as the glove meant it */
} truth_row;

struct glove_emulator {
    const glove_settings *settings;
    glove_box box;
    glove_line line;
    glove_motion motion;
    FILE *truth;
    truth_row *row; /* TRUTH_ROWS, by record number */
    uint64_t random;
    int64_t start_ns;
    void (*on_ready)(const char *path); /* NULL: nobody learns */

    /* this life */
    bool is_deaf, is_silent, is_noisy;
    uint32_t life, command_count, stream_count;
    int64_t return_at_ns, noise_at_ns;
    int64_t restart_until_ns; /* 0: not restarting */
    glove_reply restart_reply;

    bool is_streaming;
    uint8_t head;
    int64_t next_ns;        /* when the next record is measured */
    bool is_late;           /* its turn came while the line was busy */
    uint32_t record_number; /* of all lives */
    uint32_t spoiled_count;

    char control[CONTROL_LINE];
    size_t control_size;
    bool is_over;
};

static volatile sig_atomic_t end_asked;

static void ask_end(int number)
{
    (void)number;
    end_asked = 1;
}

static uint32_t random_below(glove_emulator *self, uint32_t limit)
{
    self->random ^= self->random << 13;
    self->random ^= self->random >> 7;
    self->random ^= self->random << 17;
    return (uint32_t)((self->random >> 32) % limit);
}

/* ---- the ground truth: one line a record, written once its bytes are on their way ---- */

static const char *const spoil_names[GLOVE_SPOIL_COUNT] = {"sent", "zero", "head",
                                                           "end",  "lost", "twice"};

static void write_truth(void *data, int64_t label, int64_t time_ns)
{
    glove_emulator *self = data;
    const truth_row *row = &self->row[label % TRUTH_ROWS];
    if (!self->truth)
        return;
    fprintf(self->truth, "%u,%lld,%lld,%s,", row->number, (long long)row->sample_ns,
            (long long)time_ns, spoil_names[row->spoil]);
    for (uint32_t i = 0; i < row->size; ++i)
        fprintf(self->truth, "%02x", row->record[i]);
    fputc('\n', self->truth);
}

/* ---- records ---- */

/* The kinds asked for, in turn. */
static glove_spoil next_spoil(glove_emulator *self)
{
    unsigned kinds = self->settings->spoil_kinds;
    glove_spoil kind = GLOVE_SPOIL_NONE;
    for (uint32_t turn = self->spoiled_count++, i = 0; i < 64; ++i) {
        kind = (glove_spoil)(1 + (turn + i) % (GLOVE_SPOIL_COUNT - 1));
        if (kinds & 1u << kind)
            return kind;
    }
    return GLOVE_SPOIL_NONE;
}

static uint32_t spoil(glove_emulator *self, glove_spoil kind, uint8_t *record, uint32_t size)
{
    uint32_t sent[GLOVE_SENSORS];
    uint32_t sensor = 1 + random_below(self, glove_box_sent(&self->box, sent));
    switch (kind) {
    case GLOVE_SPOIL_ZERO:
        record[sensor] = 0;
        return size;
    case GLOVE_SPOIL_HEAD:
        record[0] = (uint8_t)('A' + random_below(self, 6));
        return size;
    case GLOVE_SPOIL_END:
        record[size - 1] = (uint8_t)(1 + random_below(self, 255));
        return size;
    case GLOVE_SPOIL_LOST:
        sensor = random_below(self, size - 1);
        memmove(record + sensor, record + sensor + 1, size - sensor - 1);
        return size - 1;
    case GLOVE_SPOIL_TWICE:
        memmove(record + sensor + 1, record + sensor, size - sensor);
        return size + 1;
    default:
        return size;
    }
}

static bool is_nth(uint32_t number, uint32_t every)
{
    return every > 0 && number % every == every - 1;
}

static uint32_t tick_at(const glove_emulator *self, int64_t time_ns)
{
    double elapsed_s = (double)(time_ns - self->start_ns) * 1e-9;
    double glove_s =
        self->settings->uptime_s + elapsed_s * (1.0 + self->settings->drift_ppm * 1e-6);
    return (uint32_t)(uint64_t)(glove_s * GLOVE_TICKS_PER_S);
}

static void turn_switch(glove_emulator *self, int64_t time_ns)
{
    int64_t period_ns = self->settings->switch_ns;
    if (period_ns > 0)
        self->box.wrist_switch = (time_ns - self->start_ns) / period_ns % 2 == 1;
}

static unsigned marks_of(glove_emulator *self, bool is_late)
{
    uint32_t every = self->settings->unplugged_every, run = self->settings->unplugged_run;
    bool is_out = every > 0 && self->record_number % every + run >= every;
    bool is_fast = is_late || is_nth(self->record_number, self->settings->fast_every);
    self->box.is_unplugged = is_out;
    return (is_fast ? GLOVE_MARK_FAST : 0u) | (is_out ? GLOVE_MARK_UNPLUGGED : 0u);
}

/* Measures at time_ns and sends; if it is cut, the first half. */
static void send_record(glove_emulator *self, uint8_t head, int64_t time_ns, bool is_late,
                        bool is_cut)
{
    uint8_t sensor[GLOVE_SENSORS], bytes[GLOVE_RECORD_MAX + 1];
    glove_motion_at(&self->motion, time_ns - self->start_ns, sensor);
    if (self->settings->is_numbered)
        glove_motion_number(sensor, self->record_number);
    turn_switch(self, time_ns);
    unsigned marks = marks_of(self, is_late);
    truth_row *row = &self->row[self->record_number % TRUTH_ROWS];
    *row = (truth_row){.number = self->record_number, .sample_ns = time_ns};
    row->size = (uint32_t)glove_box_record(&self->box, head, sensor, tick_at(self, time_ns), marks,
                                           row->record);
    uint32_t size = row->size;
    memcpy(bytes, row->record, size);
    if (is_nth(self->record_number, self->settings->spoil_every)) {
        row->spoil = next_spoil(self);
        size = spoil(self, row->spoil, bytes, size);
    }
    if (is_cut)
        glove_line_send(&self->line, bytes, size / 2, time_ns, -1);
    else
        glove_line_send(&self->line, bytes, size, time_ns, self->record_number);
    self->record_number += 1;
}

/* ---- one life ---- */

static void die(glove_emulator *self, int64_t now_ns)
{
    glove_line_die(&self->line);
    self->is_streaming = false;
    self->return_at_ns =
        self->settings->return_ns >= 0 ? now_ns + self->settings->return_ns : INT64_MAX;
    if (self->settings->return_ns < 0 && !self->settings->is_controlled)
        self->is_over = true;
}

static void begin_life(glove_emulator *self, int64_t now_ns)
{
    glove_box_init(&self->box, &self->settings->model);
    self->is_deaf = self->is_silent = self->is_noisy = false;
    self->life += 1;
    self->command_count = self->stream_count = 0;
    self->restart_until_ns = 0;
    self->is_streaming = self->settings->is_streaming;
    self->head = 'S';
    self->next_ns = now_ns;
    self->noise_at_ns = now_ns;
    self->line.baud = self->settings->model.baud;
}

static bool has_faults(const glove_emulator *self)
{
    return self->settings->fault_lives == 0 || self->life <= self->settings->fault_lives;
}

static bool is_at(const glove_emulator *self, uint32_t count, uint32_t fault_at)
{
    return fault_at > 0 && count >= fault_at && has_faults(self);
}

/* The next record of the stream, or what happens instead. The glove measures when the line can
 * take what it says; a turn that finds the line busy waits, and its record is marked. */
static void stream(glove_emulator *self, int64_t now_ns)
{
    const glove_settings *s = self->settings;
    uint32_t count = self->stream_count++;
    bool is_cut = is_at(self, count, s->cut_after);
    if (is_at(self, count, s->die_after)) {
        die(self, now_ns);
        return;
    }
    if (is_at(self, count, s->noise_after))
        self->is_noisy = true;
    if (count == s->reset_after && is_at(self, count, s->reset_after)) {
        glove_box_init(&self->box, &s->model);
        self->is_streaming = false;
        return;
    }
    if (is_at(self, count, s->silent_after) || is_cut)
        self->is_silent = self->is_deaf = true;
    if ((!self->is_silent && !self->is_noisy) || (is_cut && count == s->cut_after))
        send_record(self, self->head, self->next_ns, self->is_late, is_cut);
    int64_t wanted_ns = self->next_ns + glove_box_period_ns(&self->box);
    self->is_late = self->line.free_ns > wanted_ns;
    self->next_ns = self->is_late ? self->line.free_ns : wanted_ns;
}

static void act(glove_emulator *self, const glove_reply *reply, int64_t now_ns)
{
    switch (reply->action) {
    case GLOVE_RECORD:
        send_record(self, reply->head, now_ns, false, false);
        return;
    case GLOVE_STREAM:
        self->is_streaming = true;
        self->head = reply->head;
        self->next_ns = now_ns;
        self->is_late = false;
        return;
    case GLOVE_STOP:
        self->is_streaming = false;
        break;
    case GLOVE_RESTART:
        self->is_streaming = false;
        self->restart_until_ns = now_ns + self->settings->restart_ns;
        self->restart_reply = *reply;
        return;
    default:
        break;
    }
    glove_line_send(&self->line, reply->bytes, (uint32_t)reply->size, now_ns, -1);
    self->line.baud = self->box.baud;
}

static void hear_as_glove(glove_emulator *self, uint8_t byte, int64_t now_ns)
{
    bool is_control = byte == 0x03 || byte == 0x12;
    if (self->is_deaf || self->restart_until_ns > 0 || (self->is_streaming && !is_control))
        return;
    glove_reply reply;
    glove_box_receive(&self->box, byte, &reply);
    if (reply.action == GLOVE_WAIT)
        return;
    self->command_count += 1;
    if (is_at(self, self->command_count, self->settings->die_at_command))
        die(self, now_ns);
    else if (is_at(self, self->command_count, self->settings->mute_from_command))
        self->is_deaf = true;
    else
        act(self, &reply, now_ns);
}

static void hear_as_modem(glove_emulator *self, uint8_t byte, int64_t now_ns)
{
    static const char error_text[] = "\r\nERROR\r\n";
    glove_line_send(&self->line, &byte, 1, now_ns, -1);
    if (byte == '\r')
        glove_line_send(&self->line, error_text, sizeof error_text - 1, now_ns, -1);
}

static void hear_bytes(glove_emulator *self, const uint8_t *bytes, size_t size, int64_t now_ns)
{
    for (size_t i = 0; i < size && self->line.master >= 0; ++i)
        if (self->settings->nature == GLOVE_IS_GLOVE)
            hear_as_glove(self, bytes[i], now_ns);
        else if (self->settings->nature == GLOVE_IS_MODEM)
            hear_as_modem(self, bytes[i], now_ns);
        else if (self->settings->nature == GLOVE_IS_ECHO)
            glove_line_send(&self->line, &bytes[i], 1, now_ns, -1);
}

static void hear(glove_emulator *self, int64_t now_ns)
{
    uint8_t bytes[256];
    hear_bytes(self, bytes, glove_line_receive(&self->line, bytes, sizeof bytes), now_ns);
}

void glove_emulator_written(glove_emulator *self, int64_t now_ns, int file, size_t size)
{
    uint8_t bytes[256];
    if (!glove_line_is_terminal(&self->line, file))
        return;
    while (size > 0 && self->line.master >= 0) {
        size_t wanted = size < sizeof bytes ? size : sizeof bytes;
        size_t received = glove_line_receive_all(&self->line, bytes, wanted);
        if (received == 0)
            return;
        hear_bytes(self, bytes, received, now_ns);
        size -= received;
    }
}

static void make_noise(glove_emulator *self, int64_t now_ns)
{
    uint8_t bytes[NOISE_BYTES];
    for (int i = 0; i < NOISE_BYTES; ++i)
        bytes[i] = (uint8_t)random_below(self, 256);
    glove_line_send(&self->line, bytes, NOISE_BYTES, now_ns, -1);
    self->noise_at_ns = now_ns + noise_period_ns;
}

static bool is_noise(const glove_emulator *self)
{
    return self->settings->nature == GLOVE_IS_NOISE || (self->is_noisy && self->is_streaming);
}

/* ---- control: one word a line ---- */

void glove_emulator_obey(glove_emulator *self, const char *word, int64_t now_ns)
{
    if (strcmp(word, "unplug") == 0 && self->line.master >= 0) {
        die(self, now_ns);
        self->return_at_ns = INT64_MAX;
    } else if (strcmp(word, "plug") == 0 && self->line.master < 0)
        self->return_at_ns = now_ns;
    else if (strcmp(word, "silent") == 0)
        self->is_silent = self->is_deaf = true;
    else if (strcmp(word, "speak") == 0)
        self->is_silent = self->is_deaf = false;
    else if (strcmp(word, "quit") == 0)
        self->is_over = true;
}

static void read_control(glove_emulator *self, int64_t now_ns)
{
    char bytes[CONTROL_LINE];
    ssize_t size = read(STDIN_FILENO, bytes, sizeof bytes);
    if (size <= 0) {
        self->is_over = size == 0 || (errno != EINTR && errno != EAGAIN);
        return;
    }
    for (ssize_t i = 0; i < size; ++i) {
        if (bytes[i] != '\n') {
            if (self->control_size + 1 < CONTROL_LINE)
                self->control[self->control_size++] = bytes[i];
            continue;
        }
        self->control[self->control_size] = 0;
        self->control_size = 0;
        glove_emulator_obey(self, self->control, now_ns);
    }
}

/* ---- the loop ---- */

static int64_t earlier(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

int64_t glove_emulator_due_ns(const glove_emulator *self)
{
    if (self->line.master < 0)
        return self->return_at_ns;
    int64_t due_ns = glove_line_due_ns(&self->line);
    if (self->is_streaming)
        due_ns = earlier(due_ns, self->next_ns);
    if (is_noise(self))
        due_ns = earlier(due_ns, self->noise_at_ns);
    if (self->restart_until_ns > 0)
        due_ns = earlier(due_ns, self->restart_until_ns);
    return due_ns;
}

mrt_result glove_emulator_live(glove_emulator *self, int64_t now_ns, error *err)
{
    if (self->line.master < 0) {
        if (now_ns < self->return_at_ns)
            return MRT_OK;
        mrt_result result = glove_line_revive(&self->line, err);
        if (result < 0)
            return result;
        begin_life(self, now_ns);
        if (self->on_ready)
            self->on_ready(self->line.path);
        return MRT_OK;
    }
    while (self->is_streaming && self->next_ns <= now_ns)
        stream(self, now_ns);
    if (self->line.master >= 0 && is_noise(self) && self->noise_at_ns <= now_ns)
        make_noise(self, now_ns);
    if (self->restart_until_ns > 0 && self->restart_until_ns <= now_ns) {
        self->restart_until_ns = 0;
        glove_line_send(&self->line, self->restart_reply.bytes, (uint32_t)self->restart_reply.size,
                        now_ns, -1);
    }
    glove_line_pump(&self->line, now_ns, write_truth, self);
    return MRT_OK;
}

static void wait_for_event(glove_emulator *self)
{
    int control = self->settings->is_controlled ? STDIN_FILENO : -1;
    fd_set files;
    FD_ZERO(&files);
    if (self->line.master >= 0)
        FD_SET(self->line.master, &files);
    if (control >= 0)
        FD_SET(control, &files);
    int64_t due_ns = glove_emulator_due_ns(self), now_ns = clock_now_ns();
    int64_t left_ns = due_ns > now_ns ? due_ns - now_ns : 0;
    struct timespec left = {(time_t)(left_ns / NS_PER_S), (long)(left_ns % NS_PER_S)};
    sigset_t none;
    sigemptyset(&none);
    int highest = self->line.master > control ? self->line.master : control;
    if (pselect(highest + 1, &files, NULL, NULL, due_ns == INT64_MAX ? NULL : &left, &none) <= 0)
        return;
    now_ns = clock_now_ns();
    if (self->line.master >= 0 && FD_ISSET(self->line.master, &files))
        hear(self, now_ns);
    if (control >= 0 && FD_ISSET(control, &files))
        read_control(self, now_ns);
}

/* Signals arrive only while it waits: none is missed. */
static void catch_signals(void)
{
    struct sigaction action = {.sa_handler = ask_end};
    sigset_t ends;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    sigprocmask(SIG_BLOCK, &ends, NULL);
    signal(SIGPIPE, SIG_IGN);
}

static mrt_result open_truth(glove_emulator *self, error *err)
{
    const char *path = self->settings->truth;
    if (!path)
        return MRT_OK;
    self->truth = fopen(path, "w");
    if (!self->truth)
        return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    setvbuf(self->truth, NULL, _IOLBF, 4096);
    fprintf(self->truth, "number,sample_ns,written_ns,fate,bytes\n");
    return MRT_OK;
}

glove_settings glove_settings_default(void)
{
    return (glove_settings){
        .model = {.sensor_count = 22, .is_right = true, .native_hz = 150, .baud = 115200},
        .line = {.is_paced = true},
        .motion = "sweep",
        .seed = 1,
        .uptime_s = 3.0,
        .restart_ns = 1750 * NS_PER_MS,
        .spoil_kinds = ~0u,
        .unplugged_run = 1,
        .return_ns = -1,
    };
}

static void release(glove_emulator *self)
{
    glove_line_destroy(&self->line);
    glove_motion_finish(&self->motion);
    free(self->row);
    if (self->truth)
        fclose(self->truth);
    free(self);
}

mrt_result glove_emulator_destroy(glove_emulator *self, error *err)
{
    mrt_result result = MRT_OK;
    if (!self)
        return MRT_OK;
    if (self->truth && fclose(self->truth) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: %s", self->settings->truth, strerror(errno));
    self->truth = NULL;
    release(self);
    return result;
}

mrt_result glove_emulator_create(glove_emulator **out, const glove_settings *settings, error *err)
{
    glove_emulator *self = calloc(1, sizeof *self);
    truth_row *row = calloc(TRUTH_ROWS, sizeof *row);
    if (!self || !row) {
        free(self);
        free(row);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the ground truth");
    }
    self->settings = settings;
    self->row = row;
    self->random = 0x9E3779B97F4A7C15u ^ settings->seed;
    self->start_ns = clock_now_ns();
    mrt_result result = glove_motion_open(&self->motion, settings->motion, err);
    if (result >= 0)
        result = open_truth(self, err);
    if (result >= 0)
        result = glove_line_create(&self->line, &settings->line, settings->model.baud, err);
    if (result < 0) {
        release(self);
        return result;
    }
    begin_life(self, self->start_ns);
    *out = self;
    return MRT_OK;
}

mrt_result glove_emulator_run(const glove_settings *settings, void (*on_ready)(const char *path),
                              error *err)
{
    glove_emulator *self = NULL;
    error ignored;
    mrt_result result = glove_emulator_create(&self, settings, err);
    if (result < 0)
        return result;
    catch_signals();
    self->on_ready = on_ready;
    on_ready(self->line.path);
    while (result >= 0 && !self->is_over && !end_asked) {
        result = glove_emulator_live(self, clock_now_ns(), err);
        if (result >= 0 && !self->is_over)
            wait_for_event(self);
    }
    mrt_result end = glove_emulator_destroy(self, result < 0 ? &ignored : err);
    return result < 0 ? result : end;
}
