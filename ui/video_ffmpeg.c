#include "video_ffmpeg.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* For what is left to encode and to write when the last picture was given. */
static const int64_t patience_ns = 600 * NS_PER_S;

enum { WORDS_MAX = 64, WORD = PATH_MAX + 64, SAID_MAX = 4096 };

struct video_ffmpeg {
    file_writer file; /* ffmpeg writes into its temporary file */
    FILE *said;       /* what ffmpeg says: a file without a name */
    pid_t pid;        /* 0: not running */
    int fd;           /* to ffmpeg; -1 */
    int status;       /* how it ended */
    size_t picture_size;
    uint64_t count; /* of pictures */
};

/* ---- which one ---- */

static bool is_program(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && access(path, X_OK) == 0;
}

static bool find_program(char out[PATH_MAX])
{
    const char *at = getenv("PATH");
    while (at && *at) {
        int length = (int)strcspn(at, ":");
        int written = snprintf(out, PATH_MAX, "%.*s%sffmpeg", length, at, length ? "/" : "");
        if (written > 0 && written < PATH_MAX && is_program(out))
            return true;
        at += length;
        at += *at == ':';
    }
    return false;
}

static mrt_result find(char out[PATH_MAX], const char *path, error *err)
{
    if (find_program(out))
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s: needs the program ffmpeg, which is not installed (package ffmpeg); "
                     "--export FOLDER/ writes pictures without it",
                     path);
}

mrt_result video_ffmpeg_check(const char *path, error *err)
{
    char program[PATH_MAX];
    return find(program, path, err);
}

/* ---- its command line ---- */

typedef struct words { /* of a command line */
    char text[WORDS_MAX][WORD];
    char *word[WORDS_MAX + 1];
    uint32_t count;
} words;

static void add_word(words *w, const char *word)
{
    if (w->count == WORDS_MAX)
        return;
    (void)snprintf(w->text[w->count], WORD, "%s", word);
    w->word[w->count] = w->text[w->count];
    w->word[++w->count] = NULL;
}

/* Blanks part them. */
static void add_words(words *w, const char *text)
{
    char word[256];
    for (const char *at = text; *at; at += strcspn(at, " "), at += *at == ' ') {
        (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(at, " "), at);
        add_word(w, word);
    }
}

/* A file's name may look like an option or a protocol: this one is neither. */
static void add_file(words *w, const char *path)
{
    char word[WORD];
    (void)snprintf(word, sizeof word, "file:%s", path);
    add_word(w, word);
}

/* Whole rates up to 120 and those of film and television have time code. */
static bool can_time_code(const video_ffmpeg_about *about)
{
    const timecode_rate rate = about->rate;
    bool is_whole = rate.den == 1 && rate.num >= 10 && rate.num <= 120;
    return about->timecode[0] && about->timecode[0] != '-' && (is_whole || rate.den == 1001);
}

static void describe_video(words *w, const char *program, const video_ffmpeg_about *about,
                           const char *path)
{
    char text[256];
    add_word(w, program);
    add_words(w, "-hide_banner -nostdin -nostats -loglevel error -y");
    (void)snprintf(text, sizeof text,
                   "-f rawvideo -pixel_format rgba -video_size %ux%u -framerate %u/%u -i pipe:0",
                   about->width, about->height, about->rate.num, about->rate.den);
    add_words(w, text);
    if (about->sound) {
        add_word(w, "-i");
        add_file(w, about->sound);
        add_words(w, "-map 0:v -map 1:a -c:a aac -b:a 192k");
    }
    add_words(w, "-vf scale=out_color_matrix=bt709:out_range=tv,format=yuv420p -c:v libx264 "
                 "-preset medium -crf 18 -color_range tv -colorspace bt709 -color_primaries bt709 "
                 "-color_trc bt709");
    if (can_time_code(about)) {
        add_word(w, "-timecode");
        add_word(w, about->timecode);
    }
    add_words(w, "-map_metadata -1 -movflags +faststart -f mp4");
    add_file(w, path);
}

static void describe_sound(words *w, const char *program, const char *video, const char *sound,
                           const char *path)
{
    add_word(w, program);
    add_words(w, "-hide_banner -nostdin -nostats -loglevel error -y -i");
    add_file(w, video);
    add_word(w, "-i");
    add_file(w, sound);
    add_words(w, "-map 0:v -map 1:a -c:v copy -c:a aac -b:a 192k -movflags +faststart -f mp4");
    add_file(w, path);
}

/* ---- started ---- */

static int set_actions(posix_spawn_file_actions_t *actions, int in_fd, int said_fd)
{
    int failed = in_fd >= 0 ? posix_spawn_file_actions_adddup2(actions, in_fd, STDIN_FILENO)
                            : posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null",
                                                               O_RDONLY, 0);
    if (!failed)
        failed = posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    return failed ? failed : posix_spawn_file_actions_adddup2(actions, said_fd, STDERR_FILENO);
}

/* Signals as usual; a group of its own, which Ctrl-C does not reach. */
static int set_attributes(posix_spawnattr_t *attributes)
{
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGINT);
    sigaddset(&usual, SIGTERM);
    int failed = posix_spawnattr_setsigmask(attributes, &none);
    if (!failed)
        failed = posix_spawnattr_setsigdefault(attributes, &usual);
    if (!failed)
        failed = posix_spawnattr_setpgroup(attributes, 0);
    return failed ? failed
                  : posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK |
                                                             POSIX_SPAWN_SETSIGDEF |
                                                             POSIX_SPAWN_SETPGROUP);
}

static int spawn(pid_t *out_pid, words *w, int in_fd, int said_fd)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawnattr_init(&attributes);
    if (!failed) {
        failed = set_actions(&actions, in_fd, said_fd);
        if (!failed)
            failed = set_attributes(&attributes);
        if (!failed)
            failed = posix_spawn(out_pid, w->word[0], &actions, &attributes, w->word, environ);
        (void)posix_spawnattr_destroy(&attributes);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    return failed;
}

static mrt_result run(video_ffmpeg *self, words *w, int in_fd, error *err)
{
    self->said = tmpfile();
    if (!self->said)
        return error_set(err, MRT_ERR_IO, "%s: no temporary file: %s", self->file.path,
                         strerror(errno));
    (void)fcntl(fileno(self->said), F_SETFD, FD_CLOEXEC);
    int failed = spawn(&self->pid, w, in_fd, fileno(self->said));
    if (!failed)
        return MRT_OK;
    self->pid = 0;
    return error_set(err, MRT_ERR_IO, "%s: %s cannot be run: %s", self->file.path, w->word[0],
                     strerror(failed));
}

static mrt_result run_with_pipe(video_ffmpeg *self, words *w, error *err)
{
    int end[2];
    mrt_result result = program_pipe(end, err);
    if (result < 0)
        return result;
    self->fd = end[1];
    result = run(self, w, end[0], err);
    close(end[0]);
    return result;
}

static mrt_result create(video_ffmpeg **out, words **out_words, const char *path, error *err)
{
    *out = calloc(1, sizeof **out);
    *out_words = calloc(1, sizeof **out_words);
    if (!*out || !*out_words)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    (*out)->fd = -1;
    return file_writer_open(&(*out)->file, path, err);
}

mrt_result video_ffmpeg_open(video_ffmpeg **out, const char *path, const video_ffmpeg_about *about,
                             error *err)
{
    char program[PATH_MAX];
    words *w = NULL;
    *out = NULL;
    mrt_result result = find(program, path, err);
    if (result < 0)
        return result;
    result = create(out, &w, path, err);
    if (result >= 0) {
        (*out)->picture_size = (size_t)about->width * about->height * 4;
        describe_video(w, program, about, (*out)->file.temporary_path);
        result = run_with_pipe(*out, w, err);
    }
    free(w);
    if (result >= 0)
        return result;
    video_ffmpeg_abandon(*out);
    *out = NULL;
    return result;
}

/* ---- ended ---- */

static void wait_for(video_ffmpeg *self)
{
    if (self->fd >= 0)
        close(self->fd);
    self->fd = -1;
    if (self->pid == 0)
        return;
    (void)program_wait(self->pid, &self->status, patience_ns);
    self->pid = 0;
}

/* The last line that ffmpeg said; "" nothing. */
static void read_last_line(video_ffmpeg *self, char *out, size_t capacity)
{
    char text[SAID_MAX];
    out[0] = '\0';
    if (fseek(self->said, 0, SEEK_END) != 0)
        return;
    long size = ftell(self->said);
    if (size <= 0 || fseek(self->said, size < SAID_MAX ? 0 : size - SAID_MAX + 1, SEEK_SET) != 0)
        return;
    size_t length = fread(text, 1, sizeof text - 1, self->said);
    while (length > 0 && (unsigned char)text[length - 1] <= ' ')
        --length;
    text[length] = '\0';
    const char *newline = strrchr(text, '\n');
    (void)snprintf(out, capacity, "%.400s", newline ? newline + 1 : text);
}

static mrt_result judge(video_ffmpeg *self, error *err)
{
    char line[512];
    wait_for(self);
    if (WIFEXITED(self->status) && WEXITSTATUS(self->status) == 0)
        return MRT_OK;
    if (WIFSIGNALED(self->status))
        return error_set(err, MRT_ERR_IO, "%s: ffmpeg was ended (%s) at frame %ju", self->file.path,
                         strsignal(WTERMSIG(self->status)), (uintmax_t)self->count);
    read_last_line(self, line, sizeof line);
    return error_set(err, MRT_ERR_IO, "%s: ffmpeg failed at frame %ju: %s", self->file.path,
                     (uintmax_t)self->count, line[0] ? line : "it does not say why");
}

/* ffmpeg takes no more: why. */
static mrt_result stopped_taking(video_ffmpeg *self, int reason, error *err)
{
    mrt_result result = judge(self, err);
    if (result < 0)
        return result;
    return error_set(err, MRT_ERR_IO, "%s: ffmpeg took no more pictures from frame %ju on: %s",
                     self->file.path, (uintmax_t)self->count, strerror(reason));
}

mrt_result video_ffmpeg_add(video_ffmpeg *self, const uint8_t *rgba, error *err)
{
    size_t written = 0;
    self->count += 1;
    while (written < self->picture_size) {
        ssize_t got = write(self->fd, rgba + written, self->picture_size - written);
        if (got < 0 && errno != EINTR)
            return stopped_taking(self, errno, err);
        written += got > 0 ? (size_t)got : 0;
    }
    return MRT_OK;
}

mrt_result video_ffmpeg_commit(video_ffmpeg *self, error *err)
{
    mrt_result result = judge(self, err);
    if (result >= 0)
        result = file_writer_commit(&self->file, err);
    video_ffmpeg_abandon(self);
    return result;
}

void video_ffmpeg_abandon(video_ffmpeg *self)
{
    if (!self)
        return;
    if (self->pid)
        (void)kill(self->pid, SIGKILL);
    wait_for(self);
    if (self->said)
        (void)fclose(self->said);
    file_writer_abandon(&self->file);
    free(self);
}

mrt_result video_ffmpeg_add_sound(const char *path, const char *sound, error *err)
{
    char program[PATH_MAX];
    video_ffmpeg *self = NULL;
    words *w = NULL;
    mrt_result result = find(program, path, err);
    if (result < 0)
        return result;
    result = create(&self, &w, path, err);
    if (result >= 0) {
        describe_sound(w, program, path, sound, self->file.temporary_path);
        result = run(self, w, -1, err);
    }
    free(w);
    if (result >= 0)
        return video_ffmpeg_commit(self, err);
    video_ffmpeg_abandon(self);
    return result;
}
