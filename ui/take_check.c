/* marotte take check: everything of a show is read once. */
#include "base/cancel.h"
#include "take/edit_store.h"
#include "take_play.h"

#include <stdio.h>
#include <stdlib.h>

enum { TOLD_MAX = 100, PIECE_BYTES = 1 << 16 };

typedef struct checking {
    take_call *call;
    uint32_t problem_count;
    uint64_t sample_count;
    uint64_t audio_frames;
} checking;

static void note(checking *self, const error *problem)
{
    if (self->problem_count++ < TOLD_MAX)
        facts_list(self->call->told, "problems", "damaged", problem->text);
}

static mrt_result check_track(checking *self, int64_t id, error *err)
{
    show_track of;
    show_reader *reader = NULL;
    mrt_sample sample;
    error problem = {""};
    mrt_result result = show_track_read(self->call->show, id, &of, &problem);
    if (result < 0) {
        note(self, &problem);
        return MRT_OK;
    }
    result = show_reader_open(&reader, self->call->show, id, of.from_ns, of.to_ns, err);
    show_track_finish(&of);
    if (result < 0)
        return result;
    while ((result = show_reader_next(reader, &sample, &problem)) != MRT_END) {
        if (result == MRT_OK)
            self->sample_count += 1;
        else
            note(self, &problem);
        if (result < 0 && (self->problem_count > 100000 || cancel_is_asked()))
            break;
    }
    show_reader_close(reader);
    return MRT_OK;
}

static mrt_result check_tracks(checking *self, error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = show_track_ids(self->call->show, &ids, &count, err);
    if (result < 0)
        return result;
    progress_start(&self->call->shown, "reading");
    for (size_t i = 0; i < count && result >= 0; ++i) {
        progress_show(&self->call->shown, (double)i / (double)count, "");
        result = check_track(self, ids[i], err);
    }
    progress_end(&self->call->shown);
    free(ids);
    facts_number(self->call->told, "tracks", "tracks", (double)count, 0, "");
    facts_number(self->call->told, "samples", "samples", (double)self->sample_count, 0, "");
    return result;
}

static void check_states(checking *self, int64_t performance, int64_t from_ns, int64_t to_ns)
{
    error problem = {""};
    for (int64_t at_ns = to_ns; at_ns >= from_ns;) {
        show_checkpoint kept;
        if (show_checkpoint_before(self->call->show, performance, at_ns, 0, &kept, &problem) < 0) {
            note(self, &problem);
            return;
        }
        if (!kept.bytes)
            return;
        bool is_first = kept.time_ns == INT64_MIN;
        at_ns = is_first ? at_ns : kept.time_ns - 1;
        show_checkpoint_finish(&kept);
        if (is_first)
            return;
    }
}

static mrt_result check_performances(checking *self, error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = show_performance_ids(self->call->show, &ids, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_asked(); ++i) {
        show_performance of;
        error problem = {""};
        if (show_performance_read(self->call->show, ids[i], &of, &problem) < 0) {
            note(self, &problem);
            continue;
        }
        check_states(self, ids[i], of.from_ns, of.to_ns);
        show_performance_finish(&of);
    }
    free(ids);
    facts_number(self->call->told, "performances", "performances", (double)count, 0, "");
    return MRT_OK;
}

static mrt_result check_takes(checking *self, error *err)
{
    show_take *takes;
    size_t count;
    mrt_result result = show_takes(self->call->show, &takes, &count, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < count && !cancel_is_asked(); ++i) {
        take t;
        error problem = {""};
        if (edit_store_take_of(&t, self->call->show, &takes[i], &problem) < 0)
            note(self, &problem);
        take_finish(&t);
    }
    free(takes);
    facts_number(self->call->told, "takes", "takes", (double)count, 0, "");
    return MRT_OK;
}

static void check_sound(checking *self, int64_t id, void *piece)
{
    show_audio of;
    error problem = {""};
    mrt_result result = show_audio_info(self->call->show, id, &of, &problem);
    for (int64_t frame = 0; result >= 0 && frame < of.frame_count;) {
        size_t size = 0;
        size_t width = of.channel_count * (of.format[1] == '1'   ? 2u
                                           : of.format[1] == '2' ? 3u
                                                                 : 4u);
        result = show_audio_read(self->call->show, id, frame, piece, PIECE_BYTES, &size, &problem);
        if (result < 0 || size < width || width == 0)
            break;
        frame += (int64_t)(size / width);
        self->audio_frames += size / width;
    }
    if (result < 0)
        note(self, &problem);
}

static mrt_result check_sounds(checking *self, error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = show_audio_ids(self->call->show, &ids, &count, err);
    if (result < 0)
        return result;
    void *piece = malloc(PIECE_BYTES);
    for (size_t i = 0; piece && i < count && !cancel_is_asked(); ++i)
        check_sound(self, ids[i], piece);
    free(ids);
    if (!piece)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    free(piece);
    facts_number(self->call->told, "sounds", "sounds", (double)count, 0, "");
    return MRT_OK;
}

mrt_result take_check_run(take_call *call, error *err)
{
    checking self = {.call = call};
    mrt_result result = check_tracks(&self, err);
    if (result >= 0)
        result = check_performances(&self, err);
    if (result >= 0)
        result = check_takes(&self, err);
    if (result >= 0)
        result = check_sounds(&self, err);
    if (result >= 0)
        result = cancel_check(err);
    if (result < 0)
        return result;
    error whole = {""};
    if (self.problem_count == 0 && show_check(call->show, &whole) < 0)
        note(&self, &whole);
    facts_number(call->told, "problem_count", "damaged places", self.problem_count, 0, "");
    if (self.problem_count == 0)
        return MRT_OK;
    call->is_told = true;
    return error_set(err, MRT_ERR_FORMAT,
                     "%s is damaged in %u places: marotte take recover %s --out NEW.marotte saves "
                     "the rest",
                     call->word[0], self.problem_count, call->word[0]);
}
