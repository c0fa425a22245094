#include "io/read/mesh_child.h"

#include "base/clock.h"
#include "base/program.h"
#include "base/text.h"
#include "base/trace.h"
#include "io/decode/decode.h"
#include "io/read/mesh_build.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/memfd.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- the format between the two processes ---- */

enum { MAGIC_SIZE = 8, HEADER_SIZE = 20, COUNT_MAX = INT32_MAX / 3 };
static const char MESH_MAGIC[MAGIC_SIZE + 1] = "MRTMESH1",
                                          FAILURE_MAGIC[MAGIC_SIZE + 1] = "MRTFAIL1";

/* The header: magic, vertex count, triangle count, note length; then positions, triangles, note. */
void mesh_wire_write(FILE *stream, const mesh *m)
{
    uint32_t note_length = m->note ? (uint32_t)strlen(m->note) : 0;
    uint32_t header[3] = {m->vertex_count, m->triangle_count, note_length};
    (void)fwrite(MESH_MAGIC, 1, MAGIC_SIZE, stream);
    (void)fwrite(header, sizeof *header, 3, stream);
    (void)fwrite(m->position, 3 * sizeof *m->position, m->vertex_count, stream);
    (void)fwrite(m->triangle, 3 * sizeof *m->triangle, m->triangle_count, stream);
    if (note_length)
        (void)fwrite(m->note, 1, note_length, stream);
}

void mesh_wire_write_failure(FILE *stream, const char *text)
{
    (void)fwrite(FAILURE_MAGIC, 1, MAGIC_SIZE, stream);
    (void)fwrite(text, 1, strlen(text), stream);
}

static mrt_result parse_failure(const char *text, size_t length, error *err)
{
    char reason[512];
    text_copy(reason, sizeof reason, text_view_of(text, length));
    return error_set(err, MRT_ERR_FORMAT, "%s", reason);
}

static void copy_note(mesh *out, const char *at, const char *end)
{
    text_view rest = {at, end}, line;
    char text[256];
    while (text_next_line(&rest, &line)) {
        text_copy(text, sizeof text, line);
        mesh_note(out, "%s", text);
    }
}

mrt_result mesh_wire_parse(mesh *out, const void *data, size_t size, error *err)
{
    const char *at = data;
    uint32_t header[3];
    *out = (mesh){0};
    if (size >= MAGIC_SIZE && memcmp(at, FAILURE_MAGIC, MAGIC_SIZE) == 0)
        return parse_failure(at + MAGIC_SIZE, size - MAGIC_SIZE, err);
    if (size < HEADER_SIZE || memcmp(at, MESH_MAGIC, MAGIC_SIZE) != 0)
        return error_set(err, MRT_ERR_FORMAT, "the reader did not finish");
    memcpy(header, at + MAGIC_SIZE, sizeof header);
    uint64_t position_size = (uint64_t)header[0] * 12, triangle_size = (uint64_t)header[1] * 12;
    if (header[0] > COUNT_MAX || header[1] > COUNT_MAX ||
        HEADER_SIZE + position_size + triangle_size + header[2] != size)
        return error_set(err, MRT_ERR_FORMAT, "the reader did not finish");
    mrt_result result = mesh_create(out, header[0], header[1], err);
    if (result < 0)
        return result;
    memcpy(out->position, at + HEADER_SIZE, (size_t)position_size);
    memcpy(out->triangle, at + HEADER_SIZE + position_size, (size_t)triangle_size);
    copy_note(out, at + HEADER_SIZE + position_size + triangle_size, at + size);
    result = mesh_validate(out, err);
    if (result < 0)
        mesh_destroy(out);
    return result;
}

/* ---- the child process ---- */

static const int64_t PATIENCE_NS = 20 * NS_PER_S;
static const size_t ANSWER_SIZE_MAX = (size_t)1536 << 20; /* memory limit of the child, bytes */

typedef struct child_output {
    char *data;
    size_t size, capacity;
} child_output;

static mrt_result find_program(char out[PATH_MAX], error *err)
{
    return program_find(out, "marotte-meshload", "MAROTTE_MESHLOAD", "it reads this format", err);
}

static bool write_all(int fd, const char *at, size_t size)
{
    while (size > 0) {
        ssize_t written = write(fd, at, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        at += written;
        size -= (size_t)written;
    }
    return lseek(fd, 0, SEEK_SET) == 0;
}

/* Opens an unnamed file with the input. With a pipe both processes could wait for each other. */
static mrt_result open_input(int *out_fd, const void *input, size_t size, error *err)
{
    int fd = input ? (int)syscall(SYS_memfd_create, "marotte-decode", MFD_CLOEXEC)
                   : open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return error_set(err, MRT_ERR_IO, "no space for the input of its reader: %s",
                         strerror(errno));
    if (input && !write_all(fd, input, size)) {
        int code = errno;
        close(fd);
        return error_set(err, MRT_ERR_MEMORY, "out of memory for the input of its reader: %s",
                         strerror(code));
    }
    *out_fd = fd;
    return MRT_OK;
}

static mrt_result start(pid_t *out_pid, int *out_fd, const char *argument, int input_fd, error *err)
{
    char program[PATH_MAX];
    int end[2];
    mrt_result result = find_program(program, err);
    if (result < 0)
        return result;
    result = program_pipe(end, err);
    if (result < 0)
        return result;
    char *words[] = {program, program_argument(argument), NULL};
    const program_start how = {
        .program = program, .words = words, .in = input_fd, .out = end[1], .err = -1};
    int failed = program_spawn(out_pid, &how);
    close(end[1]);
    if (failed) {
        close(end[0]);
        return error_set(err, MRT_ERR_IO, "%s cannot be run: %s", program, strerror(failed));
    }
    *out_fd = end[0];
    return MRT_OK;
}

/* ---- the answer of the child ---- */

/* Returns MRT_END at the end of the output. */
static mrt_result read_some(child_output *a, int fd, error *err)
{
    const size_t step = 1 << 16;
    if (a->size > ANSWER_SIZE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "the mesh is too large");
    mrt_result result = mesh_build_grow((void **)&a->data, &a->capacity, a->size + step, 1, err);
    if (result < 0)
        return result;
    ssize_t got = read(fd, a->data + a->size, step);
    if (got < 0)
        return errno == EINTR ? MRT_OK : error_set(err, MRT_ERR_IO, "%s", strerror(errno));
    a->size += (size_t)got;
    return got ? MRT_OK : MRT_END;
}

static mrt_result read_answer(child_output *a, int fd, error *err)
{
    int64_t deadline_ns = clock_now_ns() + PATIENCE_NS;
    mrt_result result = MRT_OK;
    while (result == MRT_OK) {
        int64_t left_ns = deadline_ns - clock_now_ns();
        struct pollfd waiting = {.fd = fd, .events = POLLIN};
        if (left_ns <= 0)
            return error_set(err, MRT_ERR_FORMAT,
                             "its reader took more than %lld s: the file is "
                             "probably damaged",
                             (long long)(PATIENCE_NS / NS_PER_S));
        int ready = poll(&waiting, 1, (int)(left_ns / NS_PER_MS) + 1);
        if (ready > 0)
            result = read_some(a, fd, err);
        else if (ready < 0 && errno != EINTR)
            return error_set(err, MRT_ERR_IO, "%s", strerror(errno));
    }
    return result;
}

/* Maximum time from the end of the answer to the exit of the child. */
static const int64_t goodbye_ns = 10 * NS_PER_S;

/* Sets the reason if the child was ended by a signal. */
static mrt_result judge(pid_t pid, error *err)
{
    int status;
    if (!program_wait(pid, &status, goodbye_ns))
        return error_set(err, MRT_ERR_FORMAT,
                         "its reader did not end: the file is probably damaged");
    if (!WIFSIGNALED(status))
        return MRT_OK;
    if (WTERMSIG(status) == SIGXCPU)
        return error_set(err, MRT_ERR_FORMAT,
                         "its reader used up its processor time: the file is probably damaged");
    return error_set(err, MRT_ERR_FORMAT, "its reader crashed (%s): the file is probably damaged",
                     strsignal(WTERMSIG(status)));
}

/* Starts marotte-meshload with one argument and these bytes as its standard input (NULL: none), and
 * waits for its end. The caller frees its answer after any result. The error describes an abnormal
 * end. */
static mrt_result run_child(void **out_answer, size_t *out_size, const char *argument,
                            const void *input, size_t input_size, error *err)
{
    child_output a = {0};
    pid_t pid = 0;
    int input_fd = -1, fd = -1;
    *out_answer = NULL;
    *out_size = 0;
    mrt_result result = open_input(&input_fd, input, input_size, err);
    if (result < 0)
        return result;
    result = start(&pid, &fd, argument, input_fd, err);
    close(input_fd);
    if (result < 0)
        return result;
    result = read_answer(&a, fd, err);
    close(fd);
    if (result < 0) {
        (void)kill(pid, SIGKILL);
        error ignored;
        (void)judge(pid, &ignored);
    } else {
        result = judge(pid, err);
    }
    *out_answer = a.data;
    *out_size = a.size;
    TRACE(TRACE_IO, "process %d decoded %s: %zu bytes", (int)pid, argument, a.size);
    return result;
}

mrt_result mesh_child_read(mesh *out, const char *path, error *err)
{
    void *answer = NULL;
    size_t size = 0;
    *out = (mesh){0};
    mrt_result result = run_child(
        &answer, &size, strcmp(path, MESH_CHILD_DECODE) == 0 ? "./" MESH_CHILD_DECODE : path, NULL,
        0, err);
    if (result == MRT_OK)
        result = mesh_wire_parse(out, answer, size, err);
    free(answer);
    return result;
}

/* ---- decoding jobs and their answers: an answer must match its order exactly ---- */

/* Returns the size in bytes; 0: not a glTF type. */
static size_t component_size(uint32_t type)
{
    static const uint8_t size[] = {1, 1, 2, 2, 0, 4, 4}; /* from 5120 */
    return type >= 5120 && type <= 5126 ? size[type - 5120] : 0;
}

size_t decode_answer_size(const decode_order *order)
{
    const uint64_t size_max = (uint64_t)1 << 30;
    uint64_t size = (uint64_t)order->index_count * 4;
    if (order->count == 0)
        return 0;
    if (order->kind == DECODE_MESHOPT)
        size = (uint64_t)order->count * order->stride;
    else if (order->kind != DECODE_DRACO || order->attribute_count > DECODE_ATTRIBUTES_MAX)
        return 0;
    for (uint32_t i = 0; order->kind == DECODE_DRACO && i < order->attribute_count; ++i) {
        const decode_attribute *attribute = &order->attribute[i];
        size_t each = component_size(attribute->component_type);
        if (each == 0 || attribute->component_count == 0 || attribute->component_count > 16)
            return 0;
        size += (uint64_t)order->count * attribute->component_count * each;
    }
    return size <= size_max ? (size_t)size : 0;
}

static void *put(char *at, const void *data, size_t size)
{
    if (size)
        memcpy(at, data, size);
    return at + size;
}

static mrt_result make_request(void **out, size_t *out_size, const decode_job *job, uint32_t count,
                               error *err)
{
    *out_size = 0;
    for (uint32_t i = 0; i < count; ++i)
        *out_size += sizeof job[i].order + sizeof(uint64_t) + job[i].size;
    char *at = *out = malloc(*out_size + 1);
    if (!at)
        return error_set(err, MRT_ERR_MEMORY, "out of memory for the data to decode");
    for (uint32_t i = 0; i < count; ++i) {
        uint64_t size = job[i].size;
        at = put(at, &job[i].order, sizeof job[i].order);
        at = put(at, &size, sizeof size);
        at = put(at, job[i].data, job[i].size);
    }
    return MRT_OK;
}

/* Returns true if an answer of that size is valid for the order. */
static bool fits(const decode_order *order, const void *answer, uint64_t size)
{
    decode_image_size image;
    if (order->kind != DECODE_IMAGE)
        return size == decode_answer_size(order) && size > 0;
    if (size < sizeof image)
        return false;
    memcpy(&image, answer, sizeof image);
    return image.width > 0 && image.height > 0 &&
           (!order->side_max ||
            (image.width <= order->side_max && image.height <= order->side_max)) &&
           size == sizeof image + (uint64_t)image.width * image.height * 4;
}

/* Returns the number of answered jobs. */
static uint32_t read_answers(decode_job *job, uint32_t count, const char *at, size_t size)
{
    for (uint32_t i = 0; i < count; ++i) {
        uint64_t head[2];
        if (size < sizeof head)
            return i;
        memcpy(head, at, sizeof head);
        if (head[1] > size - sizeof head)
            return i;
        const char *body = at + sizeof head;
        if (head[0] == 0) {
            text_copy(job[i].failed.text, sizeof job[i].failed.text,
                      text_view_of(body, (size_t)head[1]));
        } else if (!fits(&job[i].order, body, head[1])) {
            (void)error_set(&job[i].failed, MRT_ERR_FORMAT, "its decoder returned invalid data");
        } else {
            job[i].out = malloc((size_t)head[1]);
            job[i].out_size = (size_t)head[1];
            if (job[i].out)
                memcpy(job[i].out, body, (size_t)head[1]);
            else
                (void)error_set(&job[i].failed, MRT_ERR_MEMORY,
                                "out of memory for the decoded data");
        }
        at = body + head[1];
        size -= sizeof head + (size_t)head[1];
    }
    return count;
}

mrt_result decode_run(decode_job *job, uint32_t count, error *err)
{
    enum { CRASHES_MAX = 2 };
    for (int crash = 0; count > 0; ++crash) {
        void *request = NULL, *answer = NULL;
        size_t request_size = 0, answer_size = 0;
        error ended = {"its decoder did not finish"};
        mrt_result result = make_request(&request, &request_size, job, count, err);
        if (result < 0)
            return result;
        result = run_child(&answer, &answer_size, MESH_CHILD_DECODE, request, request_size, &ended);
        uint32_t done = read_answers(job, count, answer, answer_size);
        bool was_there = answer != NULL || result == MRT_OK;
        free(request);
        free(answer);
        if (!was_there && result != MRT_ERR_FORMAT)
            return error_set(err, result, "%s", ended.text);
        job += done;
        count -= done;
        /* The next job crashed the child. After a few crashes the remaining jobs are skipped. */
        for (uint32_t i = 0; i < count && (i == 0 || crash == CRASHES_MAX); ++i)
            job[i].failed = ended;
        uint32_t passed_over = crash == CRASHES_MAX ? count : count > 0;
        job += passed_over;
        count -= passed_over;
    }
    return MRT_OK;
}

void decode_job_finish(decode_job *job)
{
    free(job->out);
    job->out = NULL;
    job->out_size = 0;
}
