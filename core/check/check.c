#include "check/check.h"

#include "base/clock.h"
#include "base/program.h"
#include "base/text.h"
#include "check/wire.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- one case in a separate process: start, messages, timeout ---- */

extern char **environ;

typedef struct process_words {
    const char *program, *library, *case_name;
    uint32_t type;
    uint64_t seed;                              /* below 2^63 */
    const char *input_address, *output_address; /* NULL: none */
    uint32_t padding; /* extra bytes on its stack, which shift all addresses */
} process_words;

typedef struct case_process {
    pid_t pid; /* 0: not running */
    int fd;
    int64_t deadline_ns;
    size_t used;
    char line[WIRE_LINE + 1];
    bool has_ended; /* it reported its end */
    bool was_late;  /* it was killed after the timeout */
    int status;     /* from waitpid, after its end */
} case_process;

/* Handles a line: kind, name, text. */
typedef void on_line_fn(void *data, char kind, const char *name, const char *text);

enum { PROCESSES_MAX = 64, PADDING_MAX = 8192, LISTEN_MS = 200 };

static mrt_result find_program(char out[PATH_MAX], error *err)
{
    return program_find(out, "marotte-plugincheck", "MAROTTE_PLUGINCHECK", "it checks plugins",
                        err);
}

/* ---- starting ---- */

/* Returns a copy of the environment with one more variable, which shifts the addresses after it;
 * NULL: no memory. */
static char **padded_environment(uint32_t padding, char *variable)
{
    size_t count = 0;
    while (environ[count])
        count += 1;
    char **out = calloc(count + 2, sizeof *out);
    if (!out)
        return NULL;
    memcpy(out, environ, count * sizeof *out);
    (void)snprintf(variable, PADDING_MAX, "MAROTTE_PADDING=%0*d",
                   (int)(padding % (PADDING_MAX - 32)), 0);
    out[count] = variable;
    return out;
}

static int spawn(case_process *out, const process_words *words, int told_fd)
{
    char type[16], seed[24], variable[PADDING_MAX];
    (void)snprintf(type, sizeof type, "%" PRIu32, words->type);
    (void)snprintf(seed, sizeof seed, "%" PRIu64, words->seed & INT64_MAX);
    char *arguments[] = {program_argument(words->program),
                         program_argument(words->library),
                         program_argument(words->case_name),
                         type,
                         seed,
                         program_argument(words->input_address ? words->input_address : "-"),
                         program_argument(words->output_address ? words->output_address : "-"),
                         NULL};
    char **environment = padded_environment(words->padding, variable);
    if (!environment)
        return ENOMEM;
    const program_start how = {.program = words->program,
                               .words = arguments,
                               .in = -1,
                               .out = -1,
                               .err = -1,
                               .passed = told_fd,
                               .passed_as = WIRE_FD,
                               .environment = environment};
    int failed = program_spawn(&out->pid, &how);
    free(environment);
    return failed;
}

static mrt_result process_start(case_process *out, const process_words *words, error *err)
{
    int end[2];
    *out = (case_process){.fd = -1};
    mrt_result result = program_pipe(end, err);
    if (result < 0)
        return result;
    int failed = spawn(out, words, end[1]);
    close(end[1]);
    if (failed) {
        close(end[0]);
        out->pid = 0;
        return error_set(err, MRT_ERR_IO, "%s cannot be run: %s", words->program, strerror(failed));
    }
    out->fd = end[0];
    out->deadline_ns = clock_now_ns() + CASE_LIMIT_S * NS_PER_S;
    return MRT_OK;
}

/* ---- reading messages ---- */

static void read_line(case_process *self, char *line, on_line_fn *on_line, void *data)
{
    char *name = line[0] && line[1] == ' ' ? line + 2 : NULL;
    char *blank = name ? strchr(name, ' ') : NULL;
    if (!blank)
        return;
    *blank = '\0';
    if (line[0] == WIRE_END)
        self->has_ended = true;
    else
        on_line(data, line[0], name, blank + 1);
}

static void read_lines(case_process *self, on_line_fn *on_line, void *data)
{
    char *newline;
    self->line[self->used] = '\0';
    while ((newline = memchr(self->line, '\n', self->used))) {
        size_t length = (size_t)(newline - self->line) + 1;
        *newline = '\0';
        read_line(self, self->line, on_line, data);
        memmove(self->line, self->line + length, self->used - length);
        self->used -= length;
    }
    if (self->used == WIRE_LINE)
        self->used = 0; /* too long: not one of our lines */
}

static void reap(case_process *self)
{
    (void)program_wait(self->pid, &self->status, NS_PER_S);
    close(self->fd);
    self->fd = -1;
    self->pid = 0;
}

static void read_some(case_process *self, on_line_fn *on_line, void *data)
{
    ssize_t got = read(self->fd, self->line + self->used, WIRE_LINE - self->used);
    if (got < 0 && (errno == EINTR || errno == EAGAIN))
        return;
    if (got <= 0) {
        (void)kill(self->pid, SIGKILL); /* it closed its pipe */
        reap(self);
        return;
    }
    self->used += (size_t)got;
    read_lines(self, on_line, data);
}

/* Kills a process after its timeout. Its children may keep the pipe open, so the end of the process
 * itself counts. */
static void end_late(case_process *self)
{
    if (self->pid == 0 || clock_now_ns() < self->deadline_ns)
        return;
    self->was_late = true;
    (void)kill(self->pid, SIGKILL);
    reap(self);
}

/* Waits until a process sends lines or ends, at most 0.2 s. Returns false if none is running. A
 * process that has ended has pid 0 afterwards. on_line receives data[i] for running[i]. */
static bool process_listen(case_process *running, uint32_t count, on_line_fn *on_line,
                           void *const *data)
{
    struct pollfd waiting[PROCESSES_MAX];
    uint32_t of[PROCESSES_MAX];
    nfds_t waiting_count = 0;
    for (uint32_t i = 0; i < count && waiting_count < PROCESSES_MAX; ++i) {
        if (running[i].pid == 0)
            continue;
        of[waiting_count] = i;
        waiting[waiting_count++] = (struct pollfd){.fd = running[i].fd, .events = POLLIN};
    }
    if (waiting_count == 0)
        return false;
    int ready = poll(waiting, waiting_count, LISTEN_MS);
    for (nfds_t i = 0; i < waiting_count; ++i) {
        if (ready > 0 && waiting[i].revents)
            read_some(&running[of[i]], on_line, data[of[i]]);
        end_late(&running[of[i]]);
    }
    return true;
}

static void process_finish(case_process *self)
{
    if (self->pid == 0)
        return;
    (void)kill(self->pid, SIGKILL);
    reap(self);
}

/* ---- the plan ---- */

enum { JOBS_MAX = 16, CASES_MAX = 32, SUM_TEXT = 32, SUM_PADDING = 3001 };
static const uint64_t seed_step = 1000003; /* between processes of the same case */

/* A case, the types that it is for, and the number of its runs, each with its own seed. */
typedef struct case_plan {
    const char *name;
    uint32_t concerns, times;
    bool is_exclusive; /* opens a device: only one such case at a time */
} case_plan;

/* Long cases first, so that they run in parallel. */
static const case_plan plans[] = {{CASE_INPUT, CONCERNS_INPUT, 1, true},
                                  {CASE_STOP, CONCERNS_INPUT, 1, true},
                                  {CASE_WALK, CONCERNS_MAPPING, 1, false},
                                  {CASE_RESTLESS, CONCERNS_MAPPING, 3, false},
                                  {CASE_ENGAGE, CONCERNS_MAPPING, 1, false},
                                  {CASE_REPLAY, CONCERNS_MAPPING, 1, false},
                                  {CASE_FACES, CONCERNS_MAPPING, 1, false},
                                  {CASE_RESUME, CONCERNS_RESUME, 1, false},
                                  {CASE_RIG_POSES, CONCERNS_RIG_POSES, 1, false},
                                  {CASE_HANDS, CONCERNS_MAPPING, 1, false},
                                  {CASE_STATE, CONCERNS_STATE, 1, false},
                                  {CASE_DEADLINE, CONCERNS_MAPPING, 1, false},
                                  {CASE_GROWTH, CONCERNS_MAPPING, 1, false},
                                  {CASE_LIFE, CONCERNS_TYPE, 1, false},
                                  {CASE_DESTROY_NULL, CONCERNS_TYPE, 1, false},
                                  {CASE_ABSENT, CONCERNS_INPUT, 1, false},
                                  {CASE_RECORDED, CONCERNS_RECORDED, 1, true},
                                  {CASE_DEVICES, CONCERNS_DEVICES, 1, false},
                                  {CASE_OUTPUT, CONCERNS_OUTPUT, 1, false},
                                  {CASE_FACE_OUTPUT, CONCERNS_FACE_OUTPUT, 1, false},
                                  {CASE_SUM, CONCERNS_MAPPING, 2, false}};
enum { PLANS = sizeof plans / sizeof *plans };

typedef struct job {
    const char *name;
    check_subject *subject;
    uint32_t type, repeat;
    bool is_exclusive, is_started;
    bool has_failed;    /* reported a failure */
    char sum[SUM_TEXT]; /* result of CASE_SUM */
} job;

typedef struct examiner {
    const char *path;
    const check_settings *settings;
    char program[PATH_MAX];
    check_report *report;
    uint32_t done, count; /* of all jobs, for the progress bar */
} examiner;

/* ---- findings ---- */

static check_subject *type_subject(const check_report *report, uint32_t type)
{
    return &report->library[1 + type];
}

/* A failure replaces an ok, and an ok replaces a skip. The first text of each verdict is kept. */
static void note(check_subject *subject, check_rule rule, check_verdict verdict, const char *text)
{
    check_finding *finding = &subject->finding[rule];
    if (verdict <= finding->verdict)
        return;
    finding->verdict = verdict;
    (void)snprintf(finding->text, sizeof finding->text, "%s", text);
}

static bool has_failed(const check_subject *subject)
{
    for (int i = 0; i < RULE_COUNT; ++i)
        if (subject->finding[i].verdict == CHECK_FAILED)
            return true;
    return false;
}

static bool read_number(text_view *rest, int64_t below, int64_t *out)
{
    text_view word;
    return text_next_word(rest, &word) && text_int(word, out) && *out >= 0 && *out < below;
}

static void read_type(examiner *self, const char *text)
{
    text_view rest = text_view_of(text, strlen(text));
    int64_t index, concerns;
    if (!read_number(&rest, CHECK_TYPES_MAX, &index) || !read_number(&rest, UINT32_MAX, &concerns))
        return;
    check_subject *subject = type_subject(self->report, (uint32_t)index);
    text_copy(subject->id, sizeof subject->id, text_trim(rest));
    subject->concerns = (uint32_t)concerns;
    if (index >= self->report->type_count)
        self->report->type_count = (uint32_t)index + 1;
}

typedef struct listener {
    examiner *examiner;
    job *job;
} listener;

static void on_line(void *data, char kind, const char *name, const char *text)
{
    listener *self = data;
    job *from = self->job;
    check_rule rule;
    if (kind == WIRE_FACT && strcmp(name, WIRE_TYPE) == 0)
        read_type(self->examiner, text);
    if (kind == WIRE_FACT && strcmp(name, WIRE_SUM) == 0)
        (void)snprintf(from->sum, sizeof from->sum, "%.31s", text);
    if (kind == WIRE_FACT || !check_rule_find(name, &rule))
        return;
    check_verdict verdict = kind == WIRE_FAILED ? CHECK_FAILED
                            : kind == WIRE_OK   ? CHECK_OK
                                                : CHECK_SKIPPED;
    bool is_of_library = check_rule_concerns(rule) == CONCERNS_LIBRARY;
    from->has_failed |= verdict == CHECK_FAILED;
    note(is_of_library ? self->examiner->report->library : from->subject, rule, verdict, text);
}

/* Judges a process that did not report its end. */
static void judge_end(const case_process *process, job *of)
{
    char text[CHECK_TEXT];
    if (process->has_ended || of->has_failed)
        return;
    bool is_library = strcmp(of->name, CASE_TABLES) == 0;
    if (process->was_late) {
        (void)snprintf(text, sizeof text, "the case \"%s\" was stopped after %d s", of->name,
                       CASE_LIMIT_S);
        note(of->subject, is_library ? RULE_LIBRARY_LOAD : RULE_RUN_HANG, CHECK_FAILED, text);
        return;
    }
    if (WIFSIGNALED(process->status))
        (void)snprintf(text, sizeof text, "the case \"%s\" was stopped by a signal: %s", of->name,
                       strsignal(WTERMSIG(process->status)));
    else
        (void)snprintf(text, sizeof text, "the case \"%s\" exited early, with exit code %d",
                       of->name, WEXITSTATUS(process->status));
    note(of->subject, is_library ? RULE_LIBRARY_LOAD : RULE_RUN_EXIT, CHECK_FAILED, text);
}

/* ---- running jobs ---- */

static mrt_result start(const examiner *self, case_process *process, const job *of, error *err)
{
    bool is_second_sum = strcmp(of->name, CASE_SUM) == 0 && of->repeat > 0;
    uint64_t seed = self->settings->seed + (is_second_sum ? 0 : of->repeat * seed_step);
    const process_words words = {.program = self->program,
                                 .library = self->path,
                                 .case_name = of->name,
                                 .type = of->type,
                                 .seed = seed & INT64_MAX,
                                 .input_address = self->settings->input_address,
                                 .output_address = self->settings->output_address,
                                 .padding = is_second_sum ? SUM_PADDING : 1};
    return process_start(process, &words, err);
}

static uint32_t count_jobs_at_once(const examiner *self)
{
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t wanted = self->settings->jobs ? self->settings->jobs
                      : processors > 0     ? (uint32_t)processors
                                           : 1;
    return wanted < JOBS_MAX ? wanted : JOBS_MAX;
}

/* Running processes: each slot has a process, its job, and its listener. */
typedef struct slots {
    uint32_t count;
    case_process process[JOBS_MAX];
    listener listener[JOBS_MAX];
    void *data[JOBS_MAX];
} slots;

static void init_slots(slots *out, examiner *self)
{
    memset(out, 0, sizeof *out);
    out->count = count_jobs_at_once(self);
    for (uint32_t i = 0; i < out->count; ++i) {
        out->listener[i].examiner = self;
        out->data[i] = &out->listener[i];
    }
}

/* Returns the next job that may start beside the running ones; NULL: none. */
static job *next_job(job *jobs, uint32_t count, const slots *running)
{
    bool is_device_open = false;
    for (uint32_t i = 0; i < running->count; ++i)
        is_device_open |= running->listener[i].job && running->listener[i].job->is_exclusive;
    for (uint32_t i = 0; i < count; ++i)
        if (!jobs[i].is_started && !(jobs[i].is_exclusive && is_device_open))
            return &jobs[i];
    return NULL;
}

static void finish_job(examiner *self, case_process *process, listener *of)
{
    judge_end(process, of->job);
    of->job = NULL;
    self->done += 1;
    if (self->settings->on_progress)
        self->settings->on_progress(self->settings->data, self->done, self->count);
}

static mrt_result run_jobs(examiner *self, job *jobs, uint32_t count, error *err)
{
    slots running;
    mrt_result result = MRT_OK;
    init_slots(&running, self);
    do {
        for (uint32_t i = 0; i < running.count; ++i)
            if (running.process[i].pid == 0 && running.listener[i].job)
                finish_job(self, &running.process[i], &running.listener[i]);
        for (uint32_t i = 0; i < running.count && result >= 0; ++i) {
            job *next = running.process[i].pid == 0 ? next_job(jobs, count, &running) : NULL;
            if (!next)
                continue;
            next->is_started = true;
            running.listener[i].job = next;
            result = start(self, &running.process[i], next, err);
        }
    } while (result >= 0 && process_listen(running.process, running.count, on_line, running.data));
    for (uint32_t i = 0; i < running.count; ++i)
        process_finish(&running.process[i]);
    return result;
}

static mrt_result run_one(examiner *self, const char *name, uint32_t type, error *err)
{
    bool is_library = strcmp(name, CASE_TABLES) == 0 || strcmp(name, CASE_QUICK) == 0;
    job one = {.name = name,
               .subject = is_library ? self->report->library : type_subject(self->report, type),
               .type = type};
    return run_jobs(self, &one, 1, err);
}

/* ---- planning ---- */

static uint32_t plan_type(const examiner *self, uint32_t type, job *out, uint32_t capacity)
{
    uint32_t count = 0;
    check_subject *subject = type_subject(self->report, type);
    for (int i = 0; i < PLANS; ++i)
        for (uint32_t repeat = 0; repeat < plans[i].times && count < capacity; ++repeat)
            if (subject->concerns & plans[i].concerns)
                out[count++] = (job){.name = plans[i].name,
                                     .subject = subject,
                                     .type = type,
                                     .repeat = repeat,
                                     .is_exclusive = plans[i].is_exclusive};
    return count;
}

static void compare_sums(const job *jobs, uint32_t count, check_subject *subject)
{
    const job *sum[2] = {NULL, NULL};
    char text[CHECK_TEXT];
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(jobs[i].name, CASE_SUM) == 0 && jobs[i].sum[0])
            sum[jobs[i].repeat % 2] = &jobs[i];
    if (!sum[0] || !sum[1])
        return;
    if (strcmp(sum[0]->sum, sum[1]->sum) == 0) {
        note(subject, RULE_REPLAY_PROCESS, CHECK_OK, "");
        return;
    }
    (void)snprintf(text, sizeof text,
                   "the pulls of the same take sum up to %s and %s. They depend on addresses, "
                   "on the environment, on time or on random numbers",
                   sum[0]->sum, sum[1]->sum);
    note(subject, RULE_REPLAY_PROCESS, CHECK_FAILED, text);
}

/* Checks its tables, then whether it runs at all, then all other rules. */
static mrt_result examine_type(examiner *self, uint32_t type, error *err)
{
    job jobs[CASES_MAX];
    check_subject *subject = type_subject(self->report, type);
    mrt_result result = run_one(self, CASE_TYPE, type, err);
    if (result < 0 || has_failed(subject))
        return result;
    result = run_one(self, CASE_SMOKE, type, err);
    bool is_dead = subject->finding[RULE_LIFE_CREATE].verdict == CHECK_FAILED ||
                   subject->finding[RULE_RUN_CRASH].verdict == CHECK_FAILED ||
                   subject->finding[RULE_RUN_HANG].verdict == CHECK_FAILED ||
                   subject->finding[RULE_RUN_EXIT].verdict == CHECK_FAILED;
    if (result < 0 || is_dead)
        return result;
    uint32_t count = plan_type(self, type, jobs, CASES_MAX);
    result = run_jobs(self, jobs, count, err);
    compare_sums(jobs, count, subject);
    return result;
}

/* ---- the report ---- */

/* If the first rule fails, the second cannot be judged. */
static const check_rule consequences[][2] = {
    {RULE_REPLAY_SAME, RULE_REPLAY_PROCESS},
    {RULE_REPLAY_SAME, RULE_REPLAY_INSTANCES},
    {RULE_REPLAY_SAME, RULE_REPLAY_RESET},
    {RULE_REPLAY_SAME, RULE_MAPPING_FACES},
    {RULE_REPLAY_SAME, RULE_RESUME_SAME},
    {RULE_REPLAY_SAME, RULE_RESUME_SILENT},
    {RULE_REPLAY_SAME, RULE_RESUME_ALL_OR_NONE},
    {RULE_REPLAY_INSTANCES, RULE_REPLAY_RESET},
    {RULE_REPLAY_INSTANCES, RULE_MAPPING_FACES},
    {RULE_REPLAY_INSTANCES, RULE_RESUME_SAME},
    {RULE_REPLAY_INSTANCES, RULE_RESUME_SILENT},
    {RULE_REPLAY_INSTANCES, RULE_RESUME_ALL_OR_NONE},
    {RULE_REPLAY_RESET, RULE_MAPPING_FACES},
    {RULE_REPLAY_SAME, RULE_RIG_POSES_CHANGE},
    {RULE_REPLAY_INSTANCES, RULE_RIG_POSES_CHANGE},
    {RULE_REPLAY_RESET, RULE_RIG_POSES_CHANGE},
};

static void drop_consequences(check_subject *subject)
{
    for (size_t i = 0; i < sizeof consequences / sizeof *consequences; ++i) {
        check_finding *finding = &subject->finding[consequences[i][1]];
        if (subject->finding[consequences[i][0]].verdict != CHECK_FAILED ||
            finding->verdict != CHECK_FAILED)
            continue;
        finding->verdict = CHECK_SKIPPED;
        (void)snprintf(finding->text, sizeof finding->text, "cannot be judged while %s fails",
                       check_rule_id(consequences[i][0]));
    }
}

static void close_subject(check_report *report, check_subject *subject)
{
    const char *cause = NULL;
    drop_consequences(subject);
    for (int i = 0; i < RULE_COUNT && !cause; ++i)
        if (subject->finding[i].verdict == CHECK_FAILED)
            cause = check_rule_id((check_rule)i);
    for (int i = 0; i < RULE_COUNT; ++i) {
        check_finding *finding = &subject->finding[i];
        bool is_concerned = check_rule_concerns((check_rule)i) & subject->concerns;
        if (finding->verdict == CHECK_NOT_CONCERNED && is_concerned) {
            finding->verdict = CHECK_SKIPPED;
            (void)snprintf(finding->text, sizeof finding->text, "not reached%s%s%s",
                           cause ? ": " : "", cause ? cause : "", cause ? " comes first" : "");
        }
        report->failed_count += finding->verdict == CHECK_FAILED;
        report->ok_count += finding->verdict == CHECK_OK;
        report->skipped_count += finding->verdict == CHECK_SKIPPED;
    }
}

static mrt_result begin(examiner *self, const char *path, const check_settings *settings,
                        check_report *report, error *err)
{
    *report = (check_report){0};
    *self = (examiner){.path = path, .settings = settings, .report = report};
    report->library = calloc(CHECK_TYPES_MAX + 1, sizeof *report->library);
    if (!report->library)
        return error_set(err, MRT_ERR_MEMORY, "no memory to examine %s", path);
    report->library->concerns = CONCERNS_LIBRARY;
    return find_program(self->program, err);
}

static uint32_t count_all(examiner *self)
{
    job jobs[CASES_MAX];
    uint32_t count = 1;
    for (uint32_t type = 0; type < self->report->type_count; ++type)
        count += 2 + plan_type(self, type, jobs, CASES_MAX);
    return count;
}

mrt_result check_run(check_report *out, const char *path, const check_settings *settings,
                     error *err)
{
    examiner self;
    int64_t began_ns = clock_now_ns();
    mrt_result result = begin(&self, path, settings, out, err);
    if (result >= 0)
        result = run_one(&self, CASE_TABLES, 0, err);
    self.count = result < 0 ? 0 : count_all(&self);
    bool is_library_good = result >= 0 && !has_failed(out->library);
    for (uint32_t type = 0; type < out->type_count && is_library_good && result >= 0; ++type)
        result = examine_type(&self, type, err);
    if (result < 0) {
        check_report_finish(out);
        return result;
    }
    for (uint32_t i = 0; i <= out->type_count; ++i)
        close_subject(out, &out->library[i]);
    out->wall_s = (double)(clock_now_ns() - began_ns) / 1e9;
    return MRT_OK;
}

void check_report_finish(check_report *report)
{
    free(report->library);
    *report = (check_report){0};
}

mrt_result check_quick(const char *path, error *err)
{
    static const check_settings settings = {.seed = 1, .jobs = 1};
    examiner self;
    check_report report;
    mrt_result result = begin(&self, path, &settings, &report, err);
    if (result >= 0)
        result = run_one(&self, CASE_QUICK, 0, err);
    for (int i = 0; i < RULE_COUNT && result >= 0; ++i)
        if (report.library->finding[i].verdict == CHECK_FAILED)
            result = error_set(err, MRT_ERR_FORMAT, "%s: %s", check_rule_id((check_rule)i),
                               report.library->finding[i].text);
    check_report_finish(&report);
    return result;
}
