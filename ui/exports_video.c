#include "exports_video.h"

#include "take/sound_file.h"
#include "video_ffmpeg.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void exports_video_choose(exports_video *out, const exports_file *file, uint32_t count,
                          const video_look *look)
{
    *out = (exports_video){.look = *look};
    for (uint32_t i = 0; i < count && out->count < VIDEO_FILES_MAX; ++i)
        if (exports_is_video(file[i].format))
            out->file[out->count++] = (video_file){file[i].path, file[i].format == EXPORTS_FOLDER};
}

const char *exports_video_mp4(const exports_video *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (!self->file[i].is_folder)
            return self->file[i].path;
    return NULL;
}

mrt_result exports_video_check(const exports_video *self, error *err)
{
    return video_check(self->file, self->count, &self->look, err);
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
        fprintf(stderr, "warning: %s; the performance goes on\n", why.text);
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
        facts_number(told, "pictures_repeated", "  repeated", (double)report.repeated_count, 0,
                     "could not be drawn in time: --record, then marotte take export, draws all");
    for (uint32_t i = 0; i < self->count; ++i)
        facts_list(told, "files", "wrote", self->file[i].path);
    return MRT_OK;
}

void exports_video_close(exports_video *self)
{
    video_destroy(self->video);
    self->video = NULL;
}

/* ---- sound ---- */

static bool show_part(void *data, double part)
{
    progress_show(data, part, "");
    return true;
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
    (void)error_set(err, MRT_ERR_IO, "%s: no room for its sound beside it: %s", path,
                    strerror(errno));
    free(out);
    return NULL;
}

mrt_result exports_video_sound(char **out_path, show *s, const take *t, int64_t from_ns,
                               int64_t to_ns, const char *beside, progress *shown, error *err)
{
    sound_file_report report;
    const sound_file_watch watch = {show_part, shown};
    const sound_file_export what = {.take = t, .from_ns = from_ns, .to_ns = to_ns};
    *out_path = name_beside(beside, err);
    if (!*out_path)
        return MRT_ERR_IO;
    progress_start(shown, "sound");
    mrt_result result = sound_file_write(&report, s, &what, *out_path, &watch, err);
    progress_end(shown);
    if (result >= 0 && report.damaged_count)
        fprintf(stderr, "warning: %lld pieces of the sound are damaged: they are silent\n",
                (long long)report.damaged_count);
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
        if (!self->file[i].is_folder)
            result = video_ffmpeg_add_sound(self->file[i].path, sound, err);
    return result;
}
