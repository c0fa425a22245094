#include "exports.h"
#include "base/file.h"
#include "draw/sheet.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

const char exports_names[] = ".glb, .pc2, .mdd, .csv, .png, .mp4 or / (a folder)";

static const struct {
    const char *extension;
    exports_format format;
} formats[] = {
    {"glb", EXPORTS_GLB}, {"pc2", EXPORTS_PC2}, {"mdd", EXPORTS_MDD},
    {"csv", EXPORTS_CSV}, {"png", EXPORTS_PNG}, {"mp4", EXPORTS_MP4},
};

exports_format exports_format_of(const char *path)
{
    file_extension extension = file_extension_of(path);
    size_t length = strlen(path);
    if (length > 0 && path[length - 1] == '/')
        return EXPORTS_FOLDER;
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i)
        if (strcmp(extension.text, formats[i].extension) == 0)
            return formats[i].format;
    return EXPORTS_NONE;
}

bool exports_is_video(exports_format format)
{
    return format == EXPORTS_MP4 || format == EXPORTS_FOLDER;
}

bool exports_need_clip(const exports_file *file, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        if (!exports_is_video(file[i].format))
            return true;
    return false;
}

static mrt_result check_export(const char *path, error *err)
{
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is a %s, cannot write a file there", path,
                         S_ISDIR(status.st_mode) ? "directory" : "device or pipe");
    char *directory = file_directory(path);
    if (!directory)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    const char *folder = directory[0] ? directory : ".";
    mrt_result result = MRT_OK;
    if (stat(folder, &status) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: the folder %s: %s", path, folder, strerror(errno));
    else if (!S_ISDIR(status.st_mode) || access(folder, W_OK) != 0)
        result = error_set(err, MRT_ERR_IO, "%s: cannot write into %s", path, folder);
    free(directory);
    return result;
}

mrt_result exports_check(const exports_file *file, uint32_t count, error *err)
{
    for (uint32_t i = 0; i < count; ++i) {
        if (file[i].format == EXPORTS_FOLDER)
            continue; /* video_folder.h knows better */
        mrt_result result = check_export(file[i].path, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

void exports_tell_params(char *out, size_t capacity, const mrt_plugin_type *type,
                         const double *value)
{
    const char *dot = strrchr(type->id, '.');
    int used = snprintf(out, capacity, "%s %s", dot ? dot + 1 : type->id, type->version);
    const char *between = ": ";
    for (uint32_t i = 0; i < type->param_count && used > 0 && (size_t)used < capacity; ++i) {
        const mrt_param *p = &type->params[i];
        const char *label = p->labels ? p->labels[(size_t)(value[i] - p->min + 0.5)] : NULL;
        bool is_off =
            label ? strcmp(label, "Off") == 0 || strcmp(label, "None") == 0 : fabs(value[i]) <= 0.0;
        if ((p->flags & MRT_PARAM_TRIGGER) || (is_off && value[i] <= p->initial))
            continue;
        size_t left = capacity - (size_t)used;
        if (label)
            used += snprintf(out + used, left, "%s%s %s", between, p->name, label);
        else
            used += snprintf(out + used, left, "%s%s %g%s%s", between, p->name, value[i],
                             p->unit[0] ? " " : "", p->unit);
        between = ", ";
    }
}

static void on_export(void *data, double done)
{
    progress_show(data, done, "");
}

static mrt_result write_glb(const char *path, const clip *frames, const exports_settings *settings,
                            const export_progress *steps, facts *told, error *err)
{
    gltf_options options = {.tolerance_mm = settings->tolerance_mm,
                            .max_targets = settings->max_targets};
    gltf_report report;
    mrt_result result = gltf_write(path, frames, &options, steps, &report, err);
    if (result < 0)
        return result;
    facts_number(told, "gltf_targets", "morph targets", report.target_count, 0, "");
    facts_number(told, "gltf_exact_targets", "  of them exact", report.exact_target_count, 0, "");
    facts_number(told, "gltf_max_error_mm", "greatest error", report.max_error_mm, 4, "mm");
    facts_number(told, "gltf_tolerance_mm", "tolerance", report.tolerance_mm, 4, "mm");
    return MRT_OK;
}

static mrt_result write_one(const exports_file *file, const clip *frames,
                            const exports_settings *settings, const export_progress *steps,
                            facts *told, error *err)
{
    switch (file->format) {
    case EXPORTS_GLB:
        return write_glb(file->path, frames, settings, steps, told, err);
    case EXPORTS_PC2:
        return pc2_write(file->path, frames, steps, err);
    case EXPORTS_MDD:
        return mdd_write(file->path, frames, steps, err);
    case EXPORTS_CSV:
        return csv_write(file->path, frames, steps, err);
    case EXPORTS_PNG:
        return sheet_write(
            file->path, frames,
            &(sheet_about){settings->title, settings->made_from, settings->width, settings->height},
            err);
    case EXPORTS_NONE:
    case EXPORTS_MP4:
    case EXPORTS_FOLDER:
        break;
    }
    return error_set(err, MRT_ERR_UNSUPPORTED, "%s: unknown format", file->path);
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
        result = write_one(&file[i], frames, settings, &steps, told, err);
        progress_end(shown);
        if (result >= 0)
            facts_list(told, "files", "wrote", file[i].path);
    }
    struct rusage usage;
    if (result >= 0 && getrusage(RUSAGE_SELF, &usage) == 0)
        facts_number(told, "peak_memory_mib", "peak memory", (double)usage.ru_maxrss / 1024.0, 1,
                     "MiB");
    return result;
}
