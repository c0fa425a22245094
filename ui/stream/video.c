#include "stream/video.h"
#include "draw/offscreen.h"
#include "stream/mp4.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "base/text.h"
#include "io/export.h"

#include <jansson.h>

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ---- view and background ---- */

enum { SIDE_MIN = 16, SIDE_MAX = 16384 };

const char video_look_sizes[] = "WIDTHxHEIGHT in pixels, 16 to 16384 each, such as 1920x1080";
static const char look_views[] =
    "front, side or three-quarter, or 1 to 6, a camera view of the show";
const char video_look_grounds[] = "transparent, or a colour such as #00b140, or a .png or .jpg";
static const char look_scenes[] = "studio, theatre or daylight, or a show (.marotte)";

static const struct {
    const char *name;
    float yaw_rad, pitch_rad;
} views[] = {[VIDEO_FRONT] = {"front", 0.0f, 0.0f},
             [VIDEO_SIDE] = {"side", 1.5708f, 0.0f},
             [VIDEO_THREE_QUARTER] = {"three-quarter", 0.6109f, 0.0873f}}; /* 35 and 5 degrees */

video_look video_look_default(void)
{
    return (video_look){.width = 1280, .height = 720, .scene = scenery_default()};
}

static bool read_side(text_view word, uint32_t *out)
{
    int64_t value;
    if (!text_int(word, &value) || value < SIDE_MIN || value > SIDE_MAX)
        return false;
    *out = (uint32_t)value;
    return true;
}

bool video_look_size(video_look *self, const char *text)
{
    const char *cross = strchr(text, 'x');
    uint32_t width, height;
    if (!cross || !read_side(text_view_of(text, (size_t)(cross - text)), &width) ||
        !read_side(text_view_of(cross + 1, strlen(cross + 1)), &height))
        return false;
    self->width = width;
    self->height = height;
    self->is_sized = true;
    return true;
}

/* Reads "0.3,0.1,1,0,0,0". */
static bool read_own_view(video_look *self, const char *text)
{
    scenery made = scenery_default();
    char spaced[256];
    if (strlen(text) >= sizeof spaced)
        return false;
    for (size_t i = 0; i <= strlen(text); ++i)
        spaced[i] = text[i] == ',' ? ' ' : text[i];
    if (!scenery_parse_views(&made, spaced) || made.view_count != 1)
        return false;
    self->own_view = made.view[0];
    self->has_own_view = true;
    return true;
}

bool video_look_view(video_look *self, const char *text)
{
    for (size_t i = 0; i < sizeof views / sizeof *views; ++i) {
        if (strcmp(views[i].name, text) != 0)
            continue;
        self->view = (video_view)i;
        return true;
    }
    int64_t kept;
    if (text_int(text_view_of(text, strlen(text)), &kept) && kept >= 1 && kept <= SCENERY_VIEWS) {
        self->kept_view = (uint32_t)kept;
        return true;
    }
    return read_own_view(self, text);
}

static int digit_of(char letter)
{
    static const char digits[] = "0123456789abcdef";
    const char *at = memchr(digits, tolower((unsigned char)letter), 16);
    return at ? (int)(at - digits) : -1;
}

bool video_look_ground(video_look *self, const char *text)
{
    if (strcmp(text, "transparent") == 0) {
        self->ground = VIDEO_NOTHING;
        memset(self->rgba, 0, sizeof self->rgba);
        return true;
    }
    const file_extension end = file_extension_of(text);
    if (strcmp(end.text, "png") == 0 || strcmp(end.text, "jpg") == 0 ||
        strcmp(end.text, "jpeg") == 0) {
        self->ground = VIDEO_SCENE;
        self->picture_path = text;
        return true;
    }
    if (text[0] != '#' || strlen(text) != 7)
        return false;
    float rgba[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    for (int i = 0; i < 3; ++i) {
        int high = digit_of(text[1 + 2 * i]), low = digit_of(text[2 + 2 * i]);
        if (high < 0 || low < 0)
            return false;
        rgba[i] = (float)(16 * high + low) / 255.0f;
    }
    self->ground = VIDEO_COLOUR;
    memcpy(self->rgba, rgba, sizeof rgba);
    return true;
}

static const lighting_look *look_named(const char *name)
{
    for (size_t i = 0; i < LIGHTING_LOOKS; ++i)
        if (strcasecmp(lighting_looks[i].name, name) == 0)
            return &lighting_looks[i];
    return NULL;
}

static bool look_scene(video_look *self, const char *text)
{
    self->scene_of = text;
    return look_named(text) || strcmp(file_extension_of(text).text, "marotte") == 0;
}

const char *video_look_read(video_look *self, const char *name, const char *text)
{
    static const struct {
        const char *name, *possible;
        bool (*read)(video_look *self, const char *text);
    } options[] = {{"size", video_look_sizes, video_look_size},
                   {"view", look_views, video_look_view},
                   {"background", video_look_grounds, video_look_ground},
                   {"look", look_scenes, look_scene}};
    size_t i = 0;
    while (strcmp(options[i].name, name) != 0)
        ++i;
    return options[i].read(self, text) ? NULL : options[i].possible;
}

static mrt_result open_picture(video_look *self, error *err)
{
    file_bytes bytes;
    mrt_result result = file_read(&bytes, self->picture_path, SHOW_PICTURE_BYTES, err);
    if (result < 0)
        return result;
    result =
        scenery_picture_decode(&self->picture, bytes.data, bytes.size, self->picture_path, err);
    file_bytes_finish(&bytes);
    return result;
}

static mrt_result read_scene(video_look *self, show *from, error *err)
{
    mrt_result result = scenery_read(&self->scene, from, err);
    if (result < 0 || self->ground != VIDEO_SCENE || self->picture_path)
        return result;
    return scenery_picture_read(&self->picture, &self->scene, from, err);
}

static mrt_result read_scene_of(video_look *self, const char *path, error *err)
{
    show *of;
    mrt_result result = show_open(&of, path, SHOW_READ, err);
    if (result < 0)
        return result;
    result = read_scene(self, of, err);
    show_close(of);
    return result;
}

mrt_result video_look_open(video_look *self, show *from, log_queue *log, error *err)
{
    const lighting_look *look = self->scene_of ? look_named(self->scene_of) : NULL;
    mrt_result result = MRT_OK;
    error why = {""};
    self->scene = scenery_default();
    if (self->scene_of && !look)
        result = read_scene_of(self, self->scene_of, err);
    else if (from && read_scene(self, from, &why) < 0)
        log_push(log, MRT_LOG_WARNING, "show", why.text);
    if (look)
        self->scene.light = look->light;
    if (result >= 0 && self->picture_path)
        result = open_picture(self, err);
    if (result >= 0 && self->kept_view > self->scene.view_count)
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "--view %u: the show has %u camera views (Scene, Save view)",
                           self->kept_view, self->scene.view_count);
    return result < 0 ? result : MRT_OK;
}

void video_look_close(video_look *self)
{
    scenery_picture_finish(&self->picture);
}

mrt_result video_look_check_mp4(const video_look *self, const char *path, error *err)
{
    uint32_t width = self->width + self->width % 2, height = self->height + self->height % 2;
    if (self->ground == VIDEO_NOTHING)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: an .mp4 cannot be transparent. Choose --background #rrggbb, or "
                         "write pictures with --export FOLDER/",
                         path);
    if (width != self->width || height != self->height)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: an .mp4 needs an even number of pixels on each side: --size %ux%u",
                         path, width, height);
    return MRT_OK;
}

draw_camera video_look_camera(const video_look *self, const float low[3], const float high[3])
{
    const float chin = 0.03f,
                nearer = 0.92f; /* the view does not turn, so the face may fill more */
    const float lowest[3] = {low[0], low[1] - chin * (high[1] - low[1]), low[2]};
    draw_camera camera =
        draw_camera_framing(lowest, high, (float)self->width / (float)self->height);
    camera.distance_mm *= nearer;
    camera.yaw_rad = views[self->view].yaw_rad;
    camera.pitch_rad = views[self->view].pitch_rad;
    const draw_camera home =
        draw_camera_framing(low, high, (float)self->width / (float)self->height);
    if (self->has_own_view)
        return draw_camera_recall(&self->own_view, &home);
    if (self->kept_view > 0)
        return draw_camera_recall(&self->scene.view[self->kept_view - 1], &home);
    return camera;
}

void video_look_mirror(uint8_t *rgba, uint32_t width, uint32_t height)
{
    for (uint32_t y = 0; y < height; ++y) {
        uint8_t *row = rgba + (size_t)y * width * 4;
        for (uint32_t x = 0; x < width / 2; ++x) {
            uint8_t kept[4], *left = row + (size_t)x * 4,
                             *right = row + (size_t)(width - 1 - x) * 4;
            memcpy(kept, left, 4);
            memcpy(left, right, 4);
            memcpy(right, kept, 4);
        }
    }
}

/* ---- a folder of pictures ---- */

enum { DIGITS = 5, NOTE_BYTES_MAX = 1 << 16, FRAMES_MAX = 99999999 };
static const char note_name[] = "frames.json";

struct video_folder {
    char path[PATH_MAX];      /* ends with '/' */
    char meanwhile[PATH_MAX]; /* temporary folder within it, ends with '/'; "": none */
    bool was_made;            /* we created the folder, and may remove it */
    uint32_t earlier_count;   /* number of pictures of the sequence that is replaced */
    uint32_t count;
    video_folder_about about;
    char timecode[TIMECODE_TEXT];
};

static mrt_result name_in(char out[PATH_MAX], const char *folder, const char *name, error *err)
{
    int length = snprintf(out, PATH_MAX, "%s%s", folder, name);
    if (length > 0 && length < PATH_MAX)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", folder);
}

static mrt_result picture_in(char out[PATH_MAX], const char *folder, uint32_t number, error *err)
{
    char name[32];
    (void)snprintf(name, sizeof name, "%0*u.png", DIGITS, number);
    return name_in(out, folder, name, err);
}

/* Returns the number of a picture of a sequence; 0: another name. */
static uint32_t number_of(const char *name)
{
    char *end;
    if (strlen(name) < DIGITS + 4 || name[0] < '0' || name[0] > '9')
        return 0;
    unsigned long number = strtoul(name, &end, 10);
    return strcmp(end, ".png") == 0 && number <= FRAMES_MAX ? (uint32_t)number : 0;
}

/* ---- the existing folder ---- */

/* Returns the number of pictures in our note; 0: no note of ours. */
static uint32_t noted_count(const char *folder)
{
    char path[PATH_MAX];
    file_bytes bytes;
    error ignored;
    if (name_in(path, folder, note_name, &ignored) < 0 ||
        file_read(&bytes, path, NOTE_BYTES_MAX, &ignored) < 0)
        return 0;
    json_t *note = json_loadb((const char *)bytes.data, bytes.size, 0, NULL);
    file_bytes_finish(&bytes);
    json_int_t version = json_integer_value(json_object_get(note, "marotte_frames"));
    json_int_t count = json_integer_value(json_object_get(note, "count"));
    json_decref(note);
    return version == 1 && count > 0 && count <= FRAMES_MAX ? (uint32_t)count : 0;
}

static mrt_result check_entry(const char *path, const char *name, uint32_t earlier_count,
                              error *err)
{
    uint32_t number = number_of(name);
    if (name[0] == '.')
        return MRT_OK;
    if (earlier_count == 0)
        return error_set(err, MRT_ERR_IO,
                         "%s: contains %s and no pictures that marotte wrote. Choose an empty "
                         "or a new folder",
                         path, name);
    if (number > earlier_count)
        return error_set(err, MRT_ERR_IO,
                         "%s: %s is not one of the %u pictures that marotte wrote there. Move "
                         "it away, or choose another folder",
                         path, name, earlier_count);
    return MRT_OK;
}

static mrt_result check_entries(const char *path, uint32_t earlier_count, error *err)
{
    DIR *folder = opendir(path);
    if (!folder)
        return error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    mrt_result result = MRT_OK;
    const struct dirent *entry;
    while (result >= 0 && (entry = readdir(folder)))
        result = check_entry(path, entry->d_name, earlier_count, err);
    closedir(folder);
    return result;
}

static mrt_result check_parent(const char *path, error *err)
{
    char parent[PATH_MAX];
    struct stat status;
    size_t length = strlen(path);
    while (length > 0 && path[length - 1] == '/')
        --length;
    while (length > 0 && path[length - 1] != '/')
        --length;
    (void)snprintf(parent, sizeof parent, "%.*s", (int)length, path);
    const char *folder = parent[0] ? parent : ".";
    if (stat(folder, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: the folder %s: %s", path, folder, strerror(errno));
    if (!S_ISDIR(status.st_mode) || access(folder, W_OK | X_OK) != 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot create a folder in %s", path, folder);
    return MRT_OK;
}

mrt_result video_folder_check(const char *path, error *err)
{
    struct stat status;
    if (strlen(path) > PATH_MAX - 64)
        return error_set(err, MRT_ERR_ARGUMENT, "%.200s...: the path is too long", path);
    if (stat(path, &status) != 0)
        return errno == ENOENT ? check_parent(path, err)
                               : error_set(err, MRT_ERR_IO, "%s: %s", path, strerror(errno));
    if (access(path, R_OK | W_OK | X_OK) != 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot write pictures into it: %s", path,
                         strerror(errno));
    return check_entries(path, noted_count(path), err);
}

/* ---- writing ---- */

static mrt_result make_folders(video_folder *self, error *err)
{
    self->was_made = mkdir(self->path, 0777) == 0;
    if (!self->was_made && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "%s: cannot create it: %s", self->path, strerror(errno));
    char meanwhile[PATH_MAX];
    mrt_result result = name_in(meanwhile, self->path, "unfinished.XXXXXX", err);
    if (result < 0)
        return result;
    if (!mkdtemp(meanwhile))
        return error_set(err, MRT_ERR_IO, "%s: cannot write: %s", self->path, strerror(errno));
    return name_in(self->meanwhile, meanwhile, "/", err);
}

mrt_result video_folder_open(video_folder **out, const char *path, const video_folder_about *about,
                             error *err)
{
    *out = NULL;
    mrt_result result = video_folder_check(path, err);
    video_folder *self = result >= 0 ? calloc(1, sizeof *self) : NULL;
    if (!self)
        return result < 0 ? result : error_set(err, MRT_ERR_MEMORY, "no memory for pictures");
    size_t length = strlen(path);
    (void)snprintf(self->path, sizeof self->path, "%s%s", path,
                   length > 0 && path[length - 1] == '/' ? "" : "/");
    self->earlier_count = noted_count(self->path);
    self->about = *about;
    (void)snprintf(self->timecode, sizeof self->timecode, "%s", about->timecode);
    result = make_folders(self, err);
    if (result < 0)
        video_folder_abandon(self);
    else
        *out = self;
    return result;
}

mrt_result video_folder_add(video_folder *self, const uint8_t *rgba, error *err)
{
    char path[PATH_MAX];
    error why = {""};
    if (self->count == FRAMES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: at most %d pictures", self->path,
                         FRAMES_MAX);
    mrt_result result = picture_in(path, self->meanwhile, self->count + 1, err);
    if (result < 0)
        return result;
    if (access(self->meanwhile, F_OK) != 0) /* otherwise png_write_as would create the folder again,
                                               and the sequence would have gaps */
        return error_set(err, MRT_ERR_IO, "%s%0*u.png: cannot write: %s", self->path, DIGITS,
                         self->count + 1, strerror(errno));
    result = png_write_as(path, rgba, self->about.width, self->about.height,
                          self->about.has_alpha ? PNG_WITH_ALPHA : PNG_OPAQUE, &why);
    if (result < 0) { /* the message names the final path, not the temporary one */
        const char *reason = strstr(why.text, "cannot write: ");
        return error_set(err, result, "%s%0*u.png: %s", self->path, DIGITS, self->count + 1,
                         reason ? reason : why.text);
    }
    self->count += 1;
    return MRT_OK;
}

static mrt_result write_note(const video_folder *self, uint32_t count, error *err)
{
    char path[PATH_MAX], rate[32];
    (void)snprintf(rate, sizeof rate, "%u/%u", self->about.rate.num, self->about.rate.den);
    mrt_result result = name_in(path, self->path, note_name, err);
    json_t *note =
        json_pack("{si,sI,ss,si,si}", "marotte_frames", 1, "count", (json_int_t)count, "rate", rate,
                  "width", (int)self->about.width, "height", (int)self->about.height);
    if (note && self->timecode[0])
        (void)json_object_set_new(note, "timecode", json_string(self->timecode));
    char *text = note ? json_dumps(note, JSON_INDENT(2)) : NULL;
    json_decref(note);
    if (result >= 0 && !text)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    if (result >= 0)
        result = file_write(path, text, strlen(text), err);
    free(text);
    return result;
}

static mrt_result move_picture(const video_folder *self, uint32_t number, error *err)
{
    char from[PATH_MAX], to[PATH_MAX];
    mrt_result result = picture_in(from, self->meanwhile, number, err);
    if (result >= 0)
        result = picture_in(to, self->path, number, err);
    if (result >= 0 && rename(from, to) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: cannot write: %s", to, strerror(errno));
    return result;
}

static void remove_pictures(const char *folder, uint32_t first, uint32_t last)
{
    char path[PATH_MAX];
    error ignored;
    for (uint32_t i = first; i <= last; ++i)
        if (picture_in(path, folder, i, &ignored) >= 0)
            (void)unlink(path);
}

mrt_result video_folder_commit(video_folder *self, error *err)
{
    /* If this is interrupted, the note already covers all pictures in the folder. */
    uint32_t moved = 0,
             most = self->count > self->earlier_count ? self->count : self->earlier_count;
    mrt_result result = write_note(self, most, err);
    for (; moved < self->count && result >= 0; moved += result >= 0)
        result = move_picture(self, moved + 1, err);
    if (result >= 0) {
        remove_pictures(self->path, self->count + 1, self->earlier_count);
        result = write_note(self, self->count, err);
    }
    self->was_made = self->was_made && result < 0 && moved == 0;
    video_folder_abandon(self);
    return result;
}

void video_folder_abandon(video_folder *self)
{
    if (!self)
        return;
    if (self->meanwhile[0]) {
        remove_pictures(self->meanwhile, 1, self->count + 1);
        (void)rmdir(self->meanwhile);
    }
    if (self->was_made)
        (void)rmdir(self->path);
    free(self);
}

/* ---- the ffmpeg program ---- */

static const int64_t usual_patience_ns = 30 * NS_PER_S; /* for an encoder without progress */
static const int64_t slice_ns = 100 * NS_PER_MS;        /* interval of checks for a cancel */
static const int64_t goodbye_ns = NS_PER_S;             /* time for a regular end */
/* An encoder of a file counts as busy if it uses at least a 300th of the patience as processor
 * time. */
enum { BUSY_PART = 300 };

enum { WORDS_MAX = 64, WORD = PATH_MAX + 64, STDERR_MAX = 4096 };

typedef struct ffmpeg_signs { /* signs of life of ffmpeg, besides the bytes that it reads */
    int64_t busy_ns;          /* processor time */
    struct timespec written;  /* last change of its file */
} ffmpeg_signs;

struct video_ffmpeg {
    file_writer file;   /* ffmpeg writes into its temporary file */
    FILE *child_stderr; /* stderr of ffmpeg, a file without a name */
    pid_t pid;          /* 0: not running */
    int fd;             /* pipe to ffmpeg; -1: closed */
    int status;         /* exit status */
    bool is_live, has_sound;
    const _Atomic bool *gives_up; /* set to cancel; NULL: never */
    int64_t patience_ns;
    size_t picture_size, written; /* bytes of a picture; bytes of it already written */
    uint64_t count;               /* number of pictures that ffmpeg has read */
    ffmpeg_signs signs;           /* the last that showed progress */
    int64_t signs_ns;             /* time of these signs */
};

/* ---- finding the program ---- */

static mrt_result find(char out[PATH_MAX], const char *path, error *err)
{
    if (program_on_path(out, "ffmpeg"))
        return MRT_OK;
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "%s: needs the program ffmpeg, which is not installed (package ffmpeg). "
                     "--export FOLDER/ writes pictures without it",
                     path);
}

mrt_result video_ffmpeg_check(const char *path, error *err)
{
    char program[PATH_MAX];
    return find(program, path, err);
}

/* ---- its command line ---- */

typedef struct words { /* words of a command line */
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

/* Adds words that are separated by blanks. */
static void add_words(words *w, const char *text)
{
    char word[256];
    for (const char *at = text; *at; at += strcspn(at, " "), at += *at == ' ') {
        (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(at, " "), at);
        add_word(w, word);
    }
}

/* Adds a file so that ffmpeg does not read its name as an option or a protocol. */
static void add_file(words *w, const char *path)
{
    char word[WORD];
    (void)snprintf(word, sizeof word, "file:%s", path);
    add_word(w, word);
}

/* Time code exists for whole rates up to 120, and for the rates of film and television. */
static bool can_time_code(const video_ffmpeg_about *about)
{
    const timecode_rate rate = about->rate;
    bool is_whole = rate.den == 1 && rate.num >= 10 && rate.num <= 120;
    return about->timecode[0] && about->timecode[0] != '-' && (is_whole || rate.den == 1001);
}

bool video_is_stream(const char *path)
{
    return strncmp(path, "srt://", 6) == 0 || strncmp(path, "udp://", 6) == 0;
}

/* Fast encoding, with a key frame every second for receivers that connect later. */
static void describe_stream(words *w, const video_ffmpeg_about *about, const char *path)
{
    char text[64];
    (void)snprintf(text, sizeof text, "-preset veryfast -tune zerolatency -g %u",
                   about->rate.num / about->rate.den + 1);
    add_words(w, text);
    add_words(w, "-flush_packets 1 -f mpegts");
    add_word(w, path);
}

static void describe_video(words *w, const char *program, const video_ffmpeg_about *about,
                           const char *path)
{
    char text[256];
    add_word(w, program);
    add_words(w, "-hide_banner -nostdin -nostats -loglevel error -y");
    const bool is_stream = video_is_stream(path);
    if (is_stream)
        add_words(w, about->is_live ? "-use_wallclock_as_timestamps 1" : "-re");
    (void)snprintf(text, sizeof text,
                   "-f rawvideo -pixel_format rgba -video_size %ux%u -framerate %u/%u -i pipe:0",
                   about->width, about->height, about->rate.num, about->rate.den);
    add_words(w, text);
    if (about->sound && !is_stream) {
        add_word(w, "-i");
        add_file(w, about->sound);
        add_words(w, "-map 0:v -map 1:a -c:a aac -b:a 192k");
    }
    add_words(w, "-vf scale=out_color_matrix=bt709:out_range=tv,format=yuv420p -c:v libx264 "
                 "-color_range tv -colorspace bt709 -color_primaries bt709 "
                 "-color_trc bt709");
    if (is_stream) {
        describe_stream(w, about, path);
        return;
    }
    add_words(w, "-preset medium -crf 18");
    if (can_time_code(about)) {
        add_word(w, "-timecode");
        add_word(w, about->timecode);
    }
    add_words(w, "-map_metadata -1 -movflags +faststart -f mp4");
    add_file(w, path);
}

static void describe_sound(words *w, const char *program, const char *pictures, const char *sound,
                           const char *path)
{
    add_word(w, program);
    add_words(w, "-hide_banner -nostdin -nostats -loglevel error -y -i");
    add_file(w, pictures);
    add_word(w, "-i");
    add_file(w, sound);
    add_words(w, "-map 0:v -map 1:a -c:v copy -c:a aac -b:a 192k -movflags +faststart -f mp4");
    add_file(w, path);
}

/* ---- starting it ---- */

static mrt_result run_ffmpeg(video_ffmpeg *self, words *w, int in_fd, error *err)
{
    self->child_stderr = tmpfile();
    if (!self->child_stderr)
        return error_set(err, MRT_ERR_IO, "%s: no temporary file: %s", self->file.path,
                         strerror(errno));
    (void)fcntl(fileno(self->child_stderr), F_SETFD, FD_CLOEXEC);
    const program_start how = {.program = w->word[0],
                               .words = w->word,
                               .in = in_fd,
                               .out = -1,
                               .err = fileno(self->child_stderr),
                               .signals = PROGRAM_USUAL_SIGNALS};
    int failed = program_spawn(&self->pid, &how);
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
    (void)fcntl(self->fd, F_SETFL, O_NONBLOCK); /* only this end of the pipe */
    result = run_ffmpeg(self, w, end[0], err);
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
    (*out)->patience_ns = usual_patience_ns;
    if (!video_is_stream(path))
        return file_writer_open(&(*out)->file, path, err);
    (*out)->file.path = strdup(path);
    return (*out)->file.path ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
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
        (*out)->is_live = about->is_live;
        (*out)->has_sound = about->sound != NULL;
        (*out)->gives_up = about->gives_up;
        if (about->patience_ns > 0)
            (*out)->patience_ns = about->patience_ns;
        const char *to = (*out)->file.temporary_path;
        describe_video(w, program, about, to ? to : path);
        result = run_with_pipe(*out, w, err);
    }
    free(w);
    if (result >= 0)
        return result;
    video_ffmpeg_abandon(*out);
    *out = NULL;
    return result;
}

/* ---- waiting for it ---- */

/* Returns signs only if it writes a file: an ffmpeg that waits for a receiver also uses processor
 * time. */
static ffmpeg_signs signs_of(const video_ffmpeg *self)
{
    ffmpeg_signs out = {.busy_ns = 0};
    struct timespec busy;
    struct stat status;
    clockid_t clock;
    if (!self->file.stream)
        return out;
    if (clock_getcpuclockid(self->pid, &clock) == 0 && clock_gettime(clock, &busy) == 0)
        out.busy_ns = busy.tv_sec * NS_PER_S + busy.tv_nsec;
    if (fstat(fileno(self->file.stream), &status) == 0)
        out.written = status.st_mtim;
    return out;
}

static void begin_patience(video_ffmpeg *self)
{
    self->signs = signs_of(self);
    self->signs_ns = clock_now_ns();
}

static mrt_result stopped(const char *path, uint64_t frame, error *err)
{
    return error_set(err, MRT_ERR_IO, "%s: stopped at frame %ju, and not written", path,
                     (uintmax_t)frame);
}

/* Returns < 0 if ffmpeg has made no progress for its patience, or if the caller cancels. */
static mrt_result check_patience(video_ffmpeg *self, error *err)
{
    if (self->gives_up && atomic_load(self->gives_up))
        return stopped(self->file.path, self->count, err);
    const ffmpeg_signs now = signs_of(self);
    if (now.written.tv_sec != self->signs.written.tv_sec ||
        now.written.tv_nsec != self->signs.written.tv_nsec ||
        now.busy_ns - self->signs.busy_ns >= self->patience_ns / BUSY_PART)
        begin_patience(self);
    if (clock_now_ns() - self->signs_ns < self->patience_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO,
                     "%s: ffmpeg stood still for %.3g s after %ju frames and was ended: %s",
                     self->file.path, (double)self->patience_ns / 1e9, (uintmax_t)self->count,
                     video_is_stream(self->file.path) ? "start the receiver first"
                                                      : "export again, or to another folder");
}

static void close_pipe(video_ffmpeg *self)
{
    if (self->fd >= 0)
        close(self->fd);
    self->fd = -1;
}

static mrt_result wait_for_end(video_ffmpeg *self, error *err)
{
    mrt_result result = MRT_OK;
    close_pipe(self);
    while (self->pid != 0 && result >= 0) {
        if (program_ends_within(self->pid, &self->status, slice_ns))
            self->pid = 0;
        else
            result = check_patience(self, err);
    }
    return result;
}

/* ---- the result: judged by the file and the messages of ffmpeg, not only by its exit code ---- */

/* Reads the end of ffmpeg's messages, without trailing blanks. */
static void read_stderr(video_ffmpeg *self, char out[STDERR_MAX])
{
    out[0] = '\0';
    if (fseek(self->child_stderr, 0, SEEK_END) != 0)
        return;
    long size = ftell(self->child_stderr);
    if (size <= 0 ||
        fseek(self->child_stderr, size < STDERR_MAX ? 0 : size - STDERR_MAX + 1, SEEK_SET) != 0)
        return;
    size_t length = fread(out, 1, STDERR_MAX - 1, self->child_stderr);
    while (length > 0 && (unsigned char)out[length - 1] <= ' ')
        --length;
    out[length] = '\0';
}

/* Returns the errno of the message why ffmpeg could not write; 0: unknown. */
static int write_error_of(const char *said)
{
    static const int reasons[] = {ENOSPC, EDQUOT, EFBIG, EIO, EROFS};
    for (size_t i = 0; i < sizeof reasons / sizeof reasons[0]; ++i)
        if (strstr(said, strerror(reasons[i])))
            return reasons[i];
    return 0;
}

static bool is_full(const char *folder)
{
    struct statvfs disk;
    return statvfs(folder, &disk) == 0 && disk.f_bavail == 0;
}

static mrt_result explain_write(const video_ffmpeg *self, int reason, error *err)
{
    const char *path = self->file.path;
    char *directory = file_directory(path);
    const char *folder = directory && directory[0] ? directory : "./";
    mrt_result result = MRT_ERR_IO;
    if (reason == ENOSPC || reason == EDQUOT || (reason == 0 && is_full(folder)))
        error_set(err, result,
                  "%s: no space is left in %s. Free some, or export to another "
                  "folder",
                  path, folder);
    else if (reason == EFBIG)
        error_set(err, result,
                  "%s: %s takes no file of this size. Export a shorter range, or to another "
                  "folder",
                  path, folder);
    else if (reason != 0)
        error_set(err, result, "%s: ffmpeg could not write into %s: %s", path, folder,
                  strerror(reason));
    else
        result = MRT_OK;
    free(directory);
    return result;
}

static mrt_result check_file(const video_ffmpeg *self, error *err)
{
    mp4_facts file;
    mp4_read(&file, fileno(self->file.stream));
    if (!file.is_complete)
        return error_set(err, MRT_ERR_IO, "%s: ffmpeg did not finish the file: export it again",
                         self->file.path);
    if (file.picture_count < self->count)
        return error_set(err, MRT_ERR_IO, "%s: ffmpeg wrote %ju of %ju frames: export it again",
                         self->file.path, (uintmax_t)file.picture_count, (uintmax_t)self->count);
    if (self->has_sound && !file.has_sound)
        return error_set(err, MRT_ERR_IO, "%s: ffmpeg wrote no sound: export it again",
                         self->file.path);
    return MRT_OK;
}

/* ffmpeg 5.1 exits with 0 even if it could not write the end of its file. So its file and its
 * messages are checked, too. */
static mrt_result judge(video_ffmpeg *self, error *err)
{
    char said[STDERR_MAX];
    error incomplete = {""};
    mrt_result result = wait_for_end(self, err);
    if (result < 0)
        return result;
    read_stderr(self, said);
    const bool is_file = self->file.stream != NULL;
    const int reason = write_error_of(said);
    if (WIFEXITED(self->status) && WEXITSTATUS(self->status) == 0) {
        result = is_file ? check_file(self, &incomplete) : MRT_OK;
        if (result >= 0 && (!is_file || (reason == 0 && !strstr(said, "Error writing"))))
            return MRT_OK;
    }
    if (is_file && explain_write(self, reason, err) < 0)
        return MRT_ERR_IO;
    if (result < 0)
        return error_set(err, result, "%s", incomplete.text);
    if (WIFSIGNALED(self->status))
        return error_set(err, MRT_ERR_IO, "%s: ffmpeg was ended (%s) after %ju frames",
                         self->file.path, strsignal(WTERMSIG(self->status)),
                         (uintmax_t)self->count);
    const char *newline = strrchr(said, '\n'), *line = newline ? newline + 1 : said;
    return error_set(err, MRT_ERR_IO, "%s: ffmpeg failed after %ju frames: %.400s", self->file.path,
                     (uintmax_t)self->count, line[0] ? line : "it gives no reason");
}

/* Reports why ffmpeg accepts no more pictures. */
static mrt_result stopped_taking(video_ffmpeg *self, int reason, error *err)
{
    mrt_result result = judge(self, err);
    if (result < 0)
        return result;
    return error_set(err, MRT_ERR_IO, "%s: ffmpeg took no more pictures after %ju frames: %s",
                     self->file.path, (uintmax_t)self->count, strerror(reason));
}

/* ---- writing pictures to it ---- */

mrt_result video_ffmpeg_offer(video_ffmpeg *self, const uint8_t *rgba, error *err)
{
    const int64_t until_ns = clock_now_ns() + slice_ns;
    while (self->written < self->picture_size) {
        const ssize_t got =
            write(self->fd, rgba + self->written, self->picture_size - self->written);
        if (got < 0 && errno != EINTR && errno != EAGAIN)
            return stopped_taking(self, errno, err);
        if (got > 0) {
            self->written += (size_t)got;
            continue;
        }
        const int64_t left_ns = until_ns - clock_now_ns();
        struct pollfd room = {.fd = self->fd, .events = POLLOUT};
        if (left_ns <= 0)
            return MRT_TIMEOUT;
        (void)poll(&room, 1, (int)(left_ns / NS_PER_MS) + 1);
    }
    self->written = 0;
    self->count += 1;
    return MRT_OK;
}

mrt_result video_ffmpeg_add(video_ffmpeg *self, const uint8_t *rgba, error *err)
{
    size_t before = 0;
    mrt_result result;
    begin_patience(self);
    while ((result = video_ffmpeg_offer(self, rgba, err)) == MRT_TIMEOUT) {
        if (self->written != before)
            begin_patience(self);
        before = self->written;
        const mrt_result checked = check_patience(self, err);
        if (checked < 0)
            return checked;
    }
    return result;
}

mrt_result video_ffmpeg_commit(video_ffmpeg *self, error *err)
{
    begin_patience(self);
    mrt_result result = judge(self, err);
    if (result >= 0 && self->file.stream)
        result = file_writer_commit(&self->file, err);
    video_ffmpeg_abandon(self);
    return result;
}

/* A live ffmpeg is asked to end, so that the receiver is informed. One that writes a file is
 * killed, and the file is removed. */
bool video_ffmpeg_abandon(video_ffmpeg *self)
{
    if (!self)
        return true;
    bool has_ended = true;
    close_pipe(self);
    if (self->pid != 0) {
        (void)kill(self->pid, self->is_live ? SIGTERM : SIGKILL);
        has_ended = program_wait(self->pid, &self->status, goodbye_ns);
    }
    if (self->child_stderr)
        (void)fclose(self->child_stderr);
    file_writer_abandon(&self->file);
    free(self);
    return has_ended;
}

/* Returns the number of pictures of an .mp4; 0: not an .mp4. */
static uint64_t pictures_of(const char *path)
{
    mp4_facts file = {.picture_count = 0};
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0)
        return 0;
    mp4_read(&file, fd);
    close(fd);
    return file.picture_count;
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
        self->count = pictures_of(path);
        self->has_sound = true;
        describe_sound(w, program, path, sound, self->file.temporary_path);
        result = run_ffmpeg(self, w, -1, err);
    }
    free(w);
    if (result >= 0)
        return video_ffmpeg_commit(self, err);
    video_ffmpeg_abandon(self);
    return result;
}

/* ---- frames to pictures ---- */

enum { QUEUE = 4 };
static const uint64_t paired_area_max = 9u << 20; /* pixels; larger: one target, to save memory */

typedef struct sink { /* one output of a video */
    video_folder *folder;
    video_ffmpeg *ffmpeg;
} sink;

typedef struct frame { /* a frame to draw */
    float *position;   /* vertex_count by 3, in the order of the file */
    uint32_t repeats;  /* how often its picture is repeated */
} frame;

typedef enum video_state {
    VIDEO_OPENS = 0,
    VIDEO_RUNS,
    VIDEO_ENDS, /* draws the waiting frames, then ends */
    VIDEO_GIVES_UP
} video_state;

struct video {
    video_settings settings;
    video_file file[VIDEO_FILES_MAX];
    uint32_t file_count;
    uint64_t frame_count; /* number of added frames */
    pthread_t thread;
    bool has_thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    /* guarded by the lock */
    video_state state;
    bool has_ended;        /* the thread has ended its work */
    _Atomic bool gives_up; /* cancels waits for ffmpeg; needs no lock */
    frame queue[QUEUE];
    uint32_t first, count; /* of the waiting frames */
    mrt_result result;     /* < 0: failed, see `why` */
    error why;
    /* used by the thread, then by [main] */
    offscreen offscreen;
    draw_target *target[2]; /* one is drawn into while the other is read; may be equal */
    float *drawn;           /* positions of the latest picture, as in frame */
    bool has_drawn;
    uint32_t latest; /* index of the target with the latest picture */
    uint32_t owed;   /* number of times it must still be written; 0: already read */
    draw_camera camera;
    sink sink[VIDEO_FILES_MAX];
    video_report report;
};

mrt_result video_check(const video_file *file, uint32_t count, const video_look *look, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        if (file[i].is_folder) {
            result = video_folder_check(file[i].path, err);
            continue;
        }
        result = video_look_check_mp4(look, file[i].path, err);
        if (result >= 0)
            result = video_ffmpeg_check(file[i].path, err);
    }
    return result;
}

/* ---- the thread ---- */

static mrt_result open_sinks(video *self, error *err)
{
    const video_settings *s = &self->settings;
    const video_folder_about folder = {s->look.width, s->look.height,
                                       s->look.ground == VIDEO_NOTHING, s->rate, s->timecode};
    const video_ffmpeg_about film = {.width = s->look.width,
                                     .height = s->look.height,
                                     .rate = s->rate,
                                     .timecode = s->timecode,
                                     .sound = s->sound,
                                     .gives_up = &self->gives_up};
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i) {
        const char *path = self->file[i].path;
        result = self->file[i].is_folder
                     ? video_folder_open(&self->sink[i].folder, path, &folder, err)
                     : video_ffmpeg_open(&self->sink[i].ffmpeg, path, &film, err);
    }
    return result;
}

static mrt_result open_drawing(video *self, error *err)
{
    const video_look *look = &self->settings.look;
    float low[3], high[3];
    mesh_focus(self->settings.mesh, low, high);
    self->camera = video_look_camera(look, low, high);
    mrt_result result =
        offscreen_init(&self->offscreen, self->settings.mesh, look->width, look->height, err);
    if (result < 0)
        return result;
    result = offscreen_set_scene(&self->offscreen, &look->scene, &look->picture, err);
    if (result < 0)
        return result;
    draw_ground(self->offscreen.renderer, look->ground == VIDEO_SCENE ? NULL : look->rgba);
    self->target[0] = self->target[1] = self->offscreen.target;
    if ((uint64_t)look->width * look->height <= paired_area_max)
        self->target[1] = draw_target_create(look->width, look->height, err);
    return self->target[1] ? open_sinks(self, err) : MRT_ERR_UNSUPPORTED;
}

static void close_drawing(video *self)
{
    if (self->target[1] != self->target[0])
        draw_target_destroy(self->target[1]);
    offscreen_finish(&self->offscreen);
}

/* Issues the drawing commands without waiting for them. */
static void draw_picture(video *self, const float *position)
{
    const video_look *look = &self->settings.look;
    offscreen *e = &self->offscreen;
    self->latest ^= 1;
    draw_target *target = self->target[self->latest];
    draw_face_update(e->face, position, NULL);
    draw_render(e->renderer, target, e->face, &self->camera, 0, 0, look->width, look->height);
    (void)draw_target_texture(target);
}

static mrt_result write_pixels(video *self, uint32_t times, error *err)
{
    const uint8_t *pixels = self->offscreen.pixels;
    mrt_result result = MRT_OK;
    for (uint32_t k = 0; k < times && result >= 0; ++k) {
        for (uint32_t i = 0; i < self->file_count && result >= 0; ++i)
            result = self->sink[i].folder ? video_folder_add(self->sink[i].folder, pixels, err)
                                          : video_ffmpeg_add(self->sink[i].ffmpeg, pixels, err);
        self->report.picture_count += result >= 0;
    }
    return result;
}

/* Reads a picture, which waits until it is drawn, and writes it. */
static mrt_result write_picture(video *self, uint32_t target, uint32_t times, error *err)
{
    const video_look *look = &self->settings.look;
    offscreen *e = &self->offscreen;
    draw_read(self->target[target], e->pixels);
    if (look->is_mirrored)
        video_look_mirror(e->pixels, look->width, look->height);
    return write_pixels(self, times, err);
}

static mrt_result write_owed(video *self, error *err)
{
    const uint32_t owed = self->owed;
    self->owed = 0;
    return owed > 0 ? write_picture(self, self->latest, owed, err) : MRT_OK;
}

static bool is_drawn(const video *self, const float *position)
{
    const size_t size = (size_t)self->settings.mesh->vertex_count * 3 * sizeof *position;
    return self->has_drawn && memcmp(self->drawn, position, size) == 0;
}

/* Reads and writes the previous picture while this one is drawn. A face that has not moved is not
 * drawn again. */
static mrt_result show_frame(video *self, frame *next, error *err)
{
    const uint32_t times = 1 + next->repeats;
    mrt_result result = MRT_OK;
    if (is_drawn(self, next->position)) {
        result = write_owed(self, err);
        return result < 0 ? result : write_pixels(self, times, err);
    }
    if (self->target[0] == self->target[1])
        result = write_owed(self, err);
    if (result < 0)
        return result;
    const uint32_t before = self->latest, owed = self->owed;
    draw_picture(self, next->position);
    self->owed = times;
    float *free_position = self->drawn;
    self->drawn = next->position;
    next->position = free_position;
    self->has_drawn = true;
    return owed > 0 ? write_picture(self, before, owed, err) : MRT_OK;
}

static mrt_result commit(video *self, error *err)
{
    mrt_result result = MRT_OK;
    if (self->report.picture_count == 0)
        return error_set(err, MRT_ERR_FORMAT, "%s: the performance has no frames",
                         self->file[0].path);
    for (uint32_t i = 0; i < self->file_count && result >= 0; ++i) {
        sink s = self->sink[i];
        self->sink[i] = (sink){0};
        result = s.folder ? video_folder_commit(s.folder, err) : video_ffmpeg_commit(s.ffmpeg, err);
    }
    return result;
}

static bool is_to_be_kept(video *self)
{
    pthread_mutex_lock(&self->lock);
    const bool is_kept = self->state == VIDEO_ENDS;
    pthread_mutex_unlock(&self->lock);
    return is_kept;
}

/* Waits for a frame, and lends it to the thread until give_back. NULL: the video has ended. */
static frame *next_frame(video *self)
{
    pthread_mutex_lock(&self->lock);
    while (self->count == 0 && self->state == VIDEO_RUNS)
        pthread_cond_wait(&self->changed, &self->lock);
    bool is_there = self->count > 0 && self->state != VIDEO_GIVES_UP;
    frame *next = is_there ? &self->queue[self->first] : NULL;
    pthread_mutex_unlock(&self->lock);
    return next;
}

static void give_back(video *self)
{
    pthread_mutex_lock(&self->lock);
    self->first = (self->first + 1) % QUEUE;
    self->count -= 1;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
}

static mrt_result work(video *self, error *err)
{
    frame *next;
    mrt_result result = MRT_OK;
    while (result >= 0 && (next = next_frame(self))) {
        result = show_frame(self, next, err);
        give_back(self);
    }
    if (result >= 0 && is_to_be_kept(self))
        result = write_owed(self, err);
    if (result < 0)
        return result;
    return is_to_be_kept(self) ? commit(self, err)
                               : stopped(self->file[0].path, self->report.picture_count, err);
}

static void set_state(video *self, video_state state, mrt_result result, const error *why)
{
    pthread_mutex_lock(&self->lock);
    if (self->state == VIDEO_OPENS)
        self->state = state;
    if (result < 0) {
        self->result = result;
        self->why = *why;
    }
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
}

static void *run(void *data)
{
    video *self = data;
    error err = {""};
    mrt_result result = open_drawing(self, &err);
    set_state(self, VIDEO_RUNS, result, &err);
    if (result >= 0)
        result = work(self, &err);
    for (uint32_t i = 0; i < self->file_count; ++i) {
        video_folder_abandon(self->sink[i].folder);
        (void)video_ffmpeg_abandon(self->sink[i].ffmpeg);
    }
    close_drawing(self);
    set_state(self, VIDEO_RUNS, result, &err);
    pthread_mutex_lock(&self->lock);
    self->has_ended = true;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    return NULL;
}

/* The thread blocks all signals, so that other threads receive them. Writing to a closed pipe is
 * then an ordinary error. */
static mrt_result start_thread(video *self, error *err)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    int failed = pthread_create(&self->thread, NULL, run, self);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    if (failed)
        return error_set(err, MRT_ERR_IO, "no thread for the video: %s", strerror(failed));
    self->has_thread = true;
    pthread_mutex_lock(&self->lock);
    while (self->state == VIDEO_OPENS)
        pthread_cond_wait(&self->changed, &self->lock);
    mrt_result result = self->result;
    if (result < 0 && err)
        *err = self->why;
    pthread_mutex_unlock(&self->lock);
    return result;
}

/* ---- [main] ---- */

static mrt_result make_queue(video *self, error *err)
{
    const size_t size = ((size_t)self->settings.mesh->vertex_count * 3 + 1) * sizeof(float);
    bool enough = (self->drawn = malloc(size)) != NULL;
    for (int i = 0; i < QUEUE; ++i)
        enough = (self->queue[i].position = malloc(size)) != NULL && enough;
    return enough ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the video");
}

mrt_result video_create(video **out, const video_file *file, uint32_t count,
                        const video_settings *settings, error *err)
{
    *out = NULL;
    video *self = count <= VIDEO_FILES_MAX ? calloc(1, sizeof *self) : NULL;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the video");
    self->settings = *settings;
    self->file_count = count;
    memcpy(self->file, file, count * sizeof *file);
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_mutex_init(&self->lock, NULL);
    pthread_cond_init(&self->changed, &monotonic);
    pthread_condattr_destroy(&monotonic);
    mrt_result result = make_queue(self, err);
    if (result >= 0)
        result = start_thread(self, err);
    if (result < 0)
        video_destroy(self);
    else
        *out = self;
    return result;
}

static bool is_cancelled(const video *self)
{
    return self->settings.cancel && atomic_load(self->settings.cancel);
}

/* Called under the lock. Waits for a change, or until it is time to check for a cancel, which does
 * not wake the thread. */
static void wait_for_change(video *self)
{
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    const int64_t ns = until.tv_nsec + slice_ns;
    until.tv_sec += (time_t)(ns / NS_PER_S);
    until.tv_nsec = (long)(ns % NS_PER_S);
    (void)pthread_cond_timedwait(&self->changed, &self->lock, &until);
}

static void end_thread(video *self, video_state state)
{
    if (!self->has_thread)
        return;
    pthread_mutex_lock(&self->lock);
    self->state = state;
    pthread_cond_broadcast(&self->changed);
    while (!self->has_ended) {
        if (self->state == VIDEO_GIVES_UP || is_cancelled(self)) {
            self->state = VIDEO_GIVES_UP;
            atomic_store(&self->gives_up, true);
        }
        wait_for_change(self);
    }
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

void video_destroy(video *self)
{
    if (!self)
        return;
    end_thread(self, VIDEO_GIVES_UP);
    for (int i = 0; i < QUEUE; ++i)
        free(self->queue[i].position);
    free(self->drawn);
    pthread_cond_destroy(&self->changed);
    pthread_mutex_destroy(&self->lock);
    free(self);
}

/* Called under the lock. Returns NULL if a frame cannot be added: the video has failed, was
 * cancelled, or is live and late. */
static frame *room(video *self)
{
    bool waits = self->settings.pace == VIDEO_EVERY_FRAME;
    while (waits && self->count == QUEUE && self->result >= 0 && !is_cancelled(self))
        wait_for_change(self);
    if (self->result < 0 || (waits && is_cancelled(self)))
        return NULL;
    if (self->count < QUEUE)
        return &self->queue[(self->first + self->count) % QUEUE];
    self->queue[(self->first + QUEUE - 1) % QUEUE].repeats += 1;
    self->report.repeated_count += 1;
    return NULL;
}

mrt_result video_add(video *self, const points *shape, const points_order *order, error *err)
{
    pthread_mutex_lock(&self->lock);
    frame *next = room(self);
    mrt_result result = self->settings.pace == VIDEO_LIVE ? MRT_OK : self->result;
    if (result < 0 && err)
        *err = self->why;
    else if (!next && self->settings.pace == VIDEO_EVERY_FRAME)
        result = stopped(self->file[0].path, self->frame_count, err);
    pthread_mutex_unlock(&self->lock);
    if (!next)
        return result;
    points_to_rows(next->position, shape, order);
    self->frame_count += 1;
    next->repeats = 0;
    pthread_mutex_lock(&self->lock);
    self->count += 1;
    pthread_cond_broadcast(&self->changed);
    pthread_mutex_unlock(&self->lock);
    return result;
}

bool video_has_failed(video *self, error *out_why)
{
    pthread_mutex_lock(&self->lock);
    bool has_failed = self->result < 0;
    if (has_failed)
        *out_why = self->why;
    pthread_mutex_unlock(&self->lock);
    return has_failed;
}

mrt_result video_finish(video *self, error *err)
{
    end_thread(self, VIDEO_ENDS);
    if (self->result < 0 && err)
        *err = self->why;
    return self->result;
}

video_report video_reported(const video *self)
{
    return self->report;
}
