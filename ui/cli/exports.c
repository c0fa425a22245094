#include "cli/exports.h"
#include "draw/sheet.h"
#include "stream/video.h"

#include "base/file.h"
#include "base/text.h"
#include "io/curves.h"
#include "stage/mapping/plugins.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

const char exports_names[] = "one of"
#define X(format, ending, name, holds, lacks) " " ending
    EXPORTS_FORMATS(X);
#undef X

static const char *const endings[EXPORTS_END] = {
#define X(format, ending, name, holds, lacks) [EXPORTS_##format] = ending,
    EXPORTS_FORMATS(X)
#undef X
};

const char *exports_opener(exports_format format)
{
    static const char *const openers[EXPORTS_END] = {
        [EXPORTS_NONE] = "",
        [EXPORTS_GLB] = "open it in Blender: File > Import > glTF 2.0",
        [EXPORTS_VRM] = "open it in a VRM viewer, or in Blender with the VRM add-on",
        [EXPORTS_VRMA] = "load it as the animation of a VRM model",
        [EXPORTS_MP4] = "open it in a video player",
        [EXPORTS_FOLDER] = "numbered pictures; in Blender: Add > Image/Sequence",
        [EXPORTS_USD_POINTS] = "open it in Houdini: USD Import",
        [EXPORTS_USD] = "open it in Houdini, Unreal (USD Importer) or Blender: File > Import > USD",
        [EXPORTS_BVH] = "open it in Blender: File > Import > Motion Capture, scale 0.01",
        [EXPORTS_PC2] = "use it in Blender: Mesh Cache modifier, Forward +Z, Up +Y",
        [EXPORTS_MDD] = "use it in Blender: Mesh Cache modifier, Forward +Z, Up +Y",
        [EXPORTS_CSV] = "open it in a spreadsheet; marotte perform --curves performs it",
        [EXPORTS_LIVELINK] = "import it as a Live Link Face recording",
        [EXPORTS_PNG] = "open it in a picture viewer",
    };
    return openers[format];
}

/* If two endings match, the longer one counts. */
exports_format exports_format_of(const char *path)
{
    exports_format best = EXPORTS_NONE;
    size_t length = strlen(path), most = 0;
    if (video_is_stream(path))
        return EXPORTS_MP4;
    for (exports_format i = EXPORTS_NONE + 1; i < EXPORTS_END; ++i) {
        size_t size = strlen(endings[i]);
        if (size > most && size <= length && strcasecmp(path + length - size, endings[i]) == 0) {
            best = i;
            most = size;
        }
    }
    return best;
}

/* A video is written frame by frame during the performance, the other formats afterwards from a
 * clip. */
static bool exports_is_video(exports_format format)
{
    return format == EXPORTS_MP4 || format == EXPORTS_FOLDER;
}

bool exports_need_names(const exports_file *file, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (file[i].format == EXPORTS_LIVELINK || file[i].format == EXPORTS_VRMA)
            return true;
    return false;
}

bool exports_need_clip(const exports_file *file, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!exports_is_video(file[i].format))
            return true;
    return false;
}

bool exports_need_shapes(const exports_file *file, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!exports_is_video(file[i].format) && file[i].format != EXPORTS_CSV &&
            file[i].format != EXPORTS_BVH)
            return true;
    return false;
}

static mrt_result check_export(const char *path, error *err)
{
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is a %s, cannot write a file there", path,
                         S_ISDIR(status.st_mode) ? "directory" : "device or pipe");
    char *folder = file_directory(path);
    if (!folder)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    const bool is_writable = access(folder[0] ? folder : ".", W_OK) == 0;
    mrt_result result = is_writable
                            ? MRT_OK
                            : error_set(err, MRT_ERR_IO, "%s: cannot write into the folder %s: %s",
                                        path, folder[0] ? folder : ".", strerror(errno));
    free(folder);
    return result;
}

mrt_result exports_check(const exports_file *file, uint32_t count, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        if (video_is_stream(file[i].path))
            continue;
        result = file_make_parent(file[i].path, err);
        if (result >= 0 && file[i].format != EXPORTS_FOLDER) /* the video checks its folder */
            result = check_export(file[i].path, err);
    }
    return result;
}

mrt_result exports_check_face(const exports_file *file, uint32_t count, const mesh *m, error *err)
{
    file_extension extension = file_extension_of(m->path ? m->path : "");
    for (uint32_t i = 0; i < count; ++i)
        if (file[i].format == EXPORTS_VRM && strcmp(extension.text, "vrm") != 0)
            return error_set(err, MRT_ERR_UNSUPPORTED,
                             "%s: the face is not from a .vrm file; --export a .glb", file[i].path);
    return MRT_OK;
}

/* The size of a cache is known before: every vertex in every frame. */
mrt_result exports_check_room(const exports_file *file, uint32_t count, const mesh *m,
                              int64_t frame_count, error *err)
{
    const double gigabyte = 1e9, bytes = 12.0 * m->vertex_count * (double)frame_count;
    for (uint32_t i = 0; i < count; ++i) {
        struct statvfs disk;
        char *directory = file_directory(file[i].path);
        bool is_known = (file[i].format == EXPORTS_PC2 || file[i].format == EXPORTS_MDD) &&
                        directory && statvfs(directory[0] ? directory : ".", &disk) == 0;
        free(directory);
        double room = is_known ? (double)disk.f_bavail * (double)disk.f_frsize : (double)INFINITY;
        if (bytes > room)
            return error_set(err, MRT_ERR_IO,
                             "%s: %lld frames of %u vertices need %.1f GB, but only %.1f GB are "
                             "free. Use --in and --out, a lower --fps, .glb or .mp4",
                             file[i].path, (long long)frame_count, m->vertex_count,
                             bytes / gigabyte, room / gigabyte);
    }
    return MRT_OK;
}

/* Returns the meaning of a choice: "gain 1, no soft reach." for the label "Paper" in the help text
 * "Paper: gain 1, no soft reach." */
static const char *explanation_of(const char *help, const char *label)
{
    size_t length = strlen(label);
    bool is_explained = strncmp(help, label, length) == 0 && strncmp(help + length, ": ", 2) == 0;
    return is_explained ? help + length + 2 : NULL;
}

void exports_describe_params(char *out, size_t capacity, const mrt_plugin_type *type,
                             const double *value)
{
    int used = snprintf(out, capacity, "%s %s", plugin_short_name(type), type->version);
    const char *between = ": ";
    for (uint32_t i = 0; i < type->param_count && used > 0 && (size_t)used < capacity; ++i) {
        const mrt_param *p = &type->params[i];
        /* A value that a show stores may be out of range. */
        double at = value[i] >= p->min && value[i] <= p->max ? value[i] : p->initial;
        const char *label = p->labels ? p->labels[(size_t)(at - p->min + 0.5)] : NULL;
        bool is_off =
            label ? strcmp(label, "Off") == 0 || strcmp(label, "None") == 0 : fabs(at) <= 0.0;
        const bool is_hidden = (p->flags & MRT_PARAM_HIDDEN) && fabs(at - p->initial) <= 0.0;
        if ((p->flags & MRT_PARAM_TRIGGER) || is_hidden || (is_off && at <= p->initial))
            continue;
        size_t left = capacity - (size_t)used;
        bool is_usual = fabs(at - p->initial) < 0.5;
        const char *explained = label && !is_usual ? explanation_of(p->help, label) : NULL;
        if (explained)
            used += snprintf(out + used, left, "%s%s %s (%.*s)", between, p->name, label,
                             (int)strcspn(explained, "."), explained);
        else if (label)
            used += snprintf(out + used, left, "%s%s %s", between, p->name, label);
        else
            used += snprintf(out + used, left, "%s%s %g%s%s", between, p->name, at,
                             p->unit[0] ? " " : "", p->unit);
        between = ", ";
    }
}

static double unit_of(const exports_settings *settings, double usual_mm)
{
    return settings->mm_per_unit > 0.0 ? settings->mm_per_unit : usual_mm;
}

static void on_export(void *data, double done)
{
    progress_show(data, done, "");
}

/* prefix: first part of the names of the facts, such as "gltf". */
static void report_targets(const gltf_report *report, const clip *frames, const char *prefix,
                           facts *told)
{
    const bool is_named = clip_is_named(frames);
    const struct {
        const char *name, *label;
        double value;
        int decimals;
        const char *unit;
        bool is_left_out;
    } line[] = {
        {"targets", "morph targets", report->target_count, 0, "", false},
        {"named_targets", "  of them named", report->exact_target_count, 0, "", !is_named},
        {"remainder_mm", "remainder", report->remainder_mm, 2,
         "mm at most, shown by the other targets: bones turn, skin slides, clay", !is_named},
        {"mean_remainder_mm", "  on average", report->mean_remainder_mm, 2, "mm", !is_named},
        {"exact_targets", "  of them exact", report->exact_target_count, 0, "", is_named},
        {"max_error_mm", "greatest error", report->max_error_mm, 4, "mm", false},
        {"tolerance_mm", "tolerance", report->tolerance_mm, 4, "mm", false},
    };
    for (size_t i = 0; i < sizeof line / sizeof line[0]; ++i) {
        char name[64];
        (void)snprintf(name, sizeof name, "%s_%s", prefix, line[i].name);
        if (!line[i].is_left_out)
            facts_number(told, name, line[i].label, line[i].value, line[i].decimals, line[i].unit);
    }
}

static mrt_result write_glb(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    gltf_options options = {.tolerance_mm = settings->tolerance_mm,
                            .max_targets = settings->max_targets,
                            .is_bare = settings->is_bare};
    gltf_report report;
    mrt_result result = gltf_write(path, frames, &options, steps, &report, err);
    if (result < 0)
        return result;
    if (report.why_bare.text[0])
        facts_text(told, "gltf_bare", "mesh alone", report.why_bare.text);
    report_targets(&report, frames, "gltf", told);
    return MRT_OK;
}

static mrt_result write_sheet(const char *path, const clip *frames,
                              const exports_settings *settings, const export_progress *steps,
                              facts *told, error *err)
{
    (void)steps, (void)told;
    const video_look *look = settings->look;
    const sheet_about about = {.title = settings->title,
                               .made_from = settings->made_from,
                               .width = look->is_sized ? look->width : 0,
                               .height = look->is_sized ? look->height : 0,
                               .scene = &look->scene,
                               .picture = &look->picture};
    return sheet_write(path, frames, &about, err);
}

static mrt_result write_usd(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    gltf_options options = {.tolerance_mm = settings->tolerance_mm,
                            .max_targets = settings->max_targets};
    gltf_report report;
    mrt_result result =
        usd_write(path, frames, &options, unit_of(settings, 1.0), steps, &report, err);
    if (result >= 0)
        report_targets(&report, frames, "usd", told);
    return result;
}

static mrt_result write_usd_points(const char *path, const clip *frames,
                                   const exports_settings *settings, const export_progress *steps,
                                   facts *told, error *err)
{
    (void)told;
    return usd_write_points(path, frames, unit_of(settings, 1.0), steps, err);
}

static mrt_result write_bvh(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    (void)told;
    return bvh_write(path, frames, unit_of(settings, 10.0), steps, err);
}

typedef mrt_result write_cache(const char *path, const clip *c, const cache_options *options,
                               const export_progress *progress, error *err);

/* Returns "face.3.teeth.pc2" for "face.pc2": a name that every file system accepts. */
static char *path_of_part(const char *path, uint32_t number, const char *part)
{
    char name[96];
    const char *dot = strrchr(path, '.');
    text_copy(name, sizeof name, text_view_of(part, strlen(part)));
    for (char *at = name; *at; ++at)
        if (strchr("/\\:*?\"<>|", *at))
            *at = '_';
    size_t size = strlen(path) + sizeof name + 16;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%.*s.%u%s%s%s", (int)(dot - path), path, number,
                       name[0] ? "." : "", name, dot);
    return out;
}

/* Neighbouring parts with the same name are one part: several primitives of a glTF mesh, several
 * materials of an OBJ group. */
static mrt_result write_by_part(write_cache *write, const char *path, const clip *frames,
                                cache_options options, const export_progress *steps, facts *told,
                                error *err)
{
    const mesh *m = clip_mesh(frames);
    mrt_result result = MRT_OK;
    uint32_t number = 1;
    for (uint32_t i = 0; i < m->part_count && result >= 0; i += options.part_count) {
        options.first_part = i;
        options.part_count = 1;
        while (i + options.part_count < m->part_count &&
               strcmp(m->part[i + options.part_count].name, m->part[i].name) == 0)
            options.part_count += 1;
        char *name = path_of_part(path, number++, m->part[i].name);
        result = name ? write(name, frames, &options, steps, err)
                      : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
        if (result >= 0)
            facts_file(told, name, exports_opener(exports_format_of(path)));
        free(name);
    }
    return result;
}

static mrt_result write_pc2(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    const cache_options options = {.mm_per_unit = unit_of(settings, 1.0)};
    return settings->is_by_part ? write_by_part(pc2_write, path, frames, options, steps, told, err)
                                : pc2_write(path, frames, &options, steps, err);
}

static mrt_result write_mdd(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    const cache_options options = {.mm_per_unit = unit_of(settings, 1.0)};
    return settings->is_by_part ? write_by_part(mdd_write, path, frames, options, steps, told, err)
                                : mdd_write(path, frames, &options, steps, err);
}

static mrt_result write_csv(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    (void)settings, (void)told;
    return csv_write(path, frames, steps, err);
}

static mrt_result write_livelink(const char *path, const clip *frames,
                                 const exports_settings *settings, const export_progress *steps,
                                 facts *told, error *err)
{
    const clip_arkit *arkit = clip_arkit_of(frames);
    char missing[2048] = "";
    size_t used = 0;
    (void)settings;
    for (uint32_t i = 0; i < ARKIT_SHAPES && used < sizeof missing; ++i)
        if (!arkit->is_said[i])
            used += (size_t)snprintf(missing + used, sizeof missing - used, "%s%s",
                                     used > 0 ? " " : "", arkit_name[i]);
    if (arkit->shape_count + arkit->turn_count == 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: this face has no shape or pose with an ARKit name, and no head or "
                         "eyes that turn",
                         path);
    facts_number(told, "arkit_shapes", "ARKit shapes", arkit->shape_count, 0, "of 52");
    facts_number(told, "arkit_turns", "  turns", arkit->turn_count, 0, "of 9, of head and eyes");
    if (used > 0)
        facts_text(told, "arkit_missing", "  always 0", missing);
    return livelink_write(path, frames, steps, err);
}

static mrt_result write_vrma(const char *path, const clip *frames, const exports_settings *settings,
                             const export_progress *steps, facts *told, error *err)
{
    (void)settings, (void)told;
    return vrma_write(path, frames, steps, err);
}

/* Writers that read a clip. NULL: a video, which is written during the performance. */
static mrt_result (*const writers[EXPORTS_END])(const char *path, const clip *frames,
                                                const exports_settings *settings,
                                                const export_progress *steps, facts *told,
                                                error *err) = {
    [EXPORTS_GLB] = write_glb,           [EXPORTS_PC2] = write_pc2,
    [EXPORTS_MDD] = write_mdd,           [EXPORTS_CSV] = write_csv,
    [EXPORTS_LIVELINK] = write_livelink, [EXPORTS_VRM] = write_glb,
    [EXPORTS_VRMA] = write_vrma,         [EXPORTS_PNG] = write_sheet,
    [EXPORTS_USD] = write_usd,           [EXPORTS_USD_POINTS] = write_usd_points,
    [EXPORTS_BVH] = write_bvh,
};

/* Returns whether the writer lists its files itself, because it may write one for each part. */
static bool is_cache(exports_format format)
{
    return format == EXPORTS_PC2 || format == EXPORTS_MDD;
}

mrt_result exports_write(const exports_file *file, uint32_t count, const clip *frames,
                         const exports_settings *settings, progress *shown, facts *told, error *err)
{
    export_progress steps = {on_export, shown};
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        if (exports_is_video(file[i].format))
            continue;
        progress_start(shown, "writing");
        result = writers[file[i].format](file[i].path, frames, settings, &steps, told, err);
        progress_end(shown);
        if (result >= 0 && !(settings->is_by_part && is_cache(file[i].format)))
            facts_file(told, file[i].path, exports_opener(file[i].format));
    }
    struct rusage usage;
    if (result >= 0 && getrusage(RUSAGE_SELF, &usage) == 0)
        facts_number(told, "peak_memory_mib", "peak memory", (double)usage.ru_maxrss / 1024.0, 1,
                     "MiB");
    return result;
}

/* ---- videos ---- */

mrt_result exports_prepare(exports_video *out, const exports_file *file, uint32_t count,
                           const video_look *look, error *err)
{
    *out = (exports_video){.look = *look};
    for (uint32_t i = 0; i < count && out->count < VIDEO_FILES_MAX; ++i)
        if (exports_is_video(file[i].format))
            out->file[out->count++] = (video_file){file[i].path, file[i].format == EXPORTS_FOLDER};
    mrt_result result = exports_check(file, count, err);
    return result < 0 ? result : video_check(out->file, out->count, look, err);
}

const char *exports_video_mp4(const exports_video *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (!self->file[i].is_folder && !video_is_stream(self->file[i].path))
            return self->file[i].path;
    return NULL;
}

mrt_result exports_video_open(exports_video *self, const video_settings *settings, error *err)
{
    video_settings all = *settings;
    all.look = self->look;
    return self->count == 0 ? MRT_OK
                            : video_create(&self->video, self->file, self->count, &all, err);
}

mrt_result exports_video_add(exports_video *self, composer *from, error *err)
{
    error why;
    if (!self->video)
        return MRT_OK;
    const face *f = composer_face(from);
    mrt_result result = video_add(self->video, face_shown(f), face_order(f), err);
    if (result >= 0 && !self->is_told && video_has_failed(self->video, &why)) {
        self->is_told = true;
        fprintf(stderr, "warning: %s; the performance continues\n", why.text);
    }
    return result;
}

mrt_result exports_video_finish(exports_video *self, facts *told, error *err)
{
    char size[32];
    if (!self->video)
        return MRT_OK;
    mrt_result result = video_finish(self->video, err);
    if (result < 0)
        return result;
    video_report report = video_reported(self->video);
    (void)snprintf(size, sizeof size, "%ux%u", self->look.width, self->look.height);
    facts_number(told, "pictures", "pictures", (double)report.picture_count, 0, "");
    facts_text(told, "picture_size", "  size", size);
    if (report.repeated_count)
        facts_warning(told, "pictures_repeated", "pictures repeated", (double)report.repeated_count,
                      0, "not drawn in time. Use --record, then marotte take export, to draw all");
    for (uint32_t i = 0; i < self->count; ++i)
        facts_file(told, self->file[i].path,
                   video_is_stream(self->file[i].path)
                       ? ""
                       : exports_opener(self->file[i].is_folder ? EXPORTS_FOLDER : EXPORTS_MP4));
    return MRT_OK;
}

void exports_video_close(exports_video *self)
{
    video_destroy(self->video);
    self->video = NULL;
    video_look_close(&self->look);
}

/* ---- sound ---- */

mrt_result exports_sound(const char *path, show *s, const sound_file_export *what,
                         sound_file_report *out, progress *shown, error *err)
{
    const sound_file_watch watch = {progress_part, shown};
    progress_start(shown, "sound");
    mrt_result result = sound_file_write(out, s, what, path, &watch, err);
    progress_end(shown);
    if (result >= 0 && out->damaged_count)
        fprintf(stderr, "warning: the sound is damaged in %lld places, which are silent\n",
                (long long)out->damaged_count);
    return result;
}

static char *name_beside(const char *path, error *err)
{
    static const char ending[] = ".XXXXXX.wav";
    size_t size = strlen(path) + sizeof ending;
    char *out = malloc(size);
    if (out) {
        (void)snprintf(out, size, "%s%s", path, ending);
        int fd = mkstemps(out, 4);
        if (fd >= 0) {
            close(fd);
            return out;
        }
    }
    (void)error_set(err, MRT_ERR_IO, "%s: cannot write its sound beside it: %s", path,
                    strerror(errno));
    free(out);
    return NULL;
}

mrt_result exports_video_sound(char **out_path, show *s, const take *t, int64_t from_ns,
                               int64_t to_ns, const char *beside, progress *shown, error *err)
{
    sound_file_report report;
    const sound_file_export what = {.take = t, .from_ns = from_ns, .to_ns = to_ns};
    *out_path = name_beside(beside, err);
    if (!*out_path)
        return MRT_ERR_IO;
    mrt_result result = exports_sound(*out_path, s, &what, &report, shown, err);
    if (result >= 0)
        return MRT_OK;
    exports_video_sound_remove(*out_path);
    *out_path = NULL;
    return result;
}

mrt_result exports_video_sound_file(char **out_path, const char *sound, double start_s,
                                    double length_s, const char *beside, error *err)
{
    *out_path = name_beside(beside, err);
    if (!*out_path)
        return MRT_ERR_IO;
    const mrt_result result = sound_file_cut(*out_path, sound, start_s, length_s, err);
    if (result >= 0)
        return MRT_OK;
    exports_video_sound_remove(*out_path);
    *out_path = NULL;
    return result;
}

void exports_video_sound_remove(char *path)
{
    if (path)
        (void)unlink(path);
    free(path);
}

mrt_result exports_video_add_sound(const exports_video *self, const char *sound, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->count && result >= 0; ++i)
        if (!self->file[i].is_folder && !video_is_stream(self->file[i].path))
            result = video_ffmpeg_add_sound(self->file[i].path, sound, err);
    return result;
}
