/* marotte take log: the samples of a track as a log table (plugins/log/README.md). */
#include "base/file.h"
#include "hand/sensor.h"
#include "take_play.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const wrist_name[7] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

/* ---- which track, and when ---- */

typedef struct log_span {
    int64_t track, from_ns, to_ns;
} log_span;

/* Of all tracks behind the take's clips: what of them is shown. */
static mrt_result add_performance(take_call *call, const take_clip *c, log_span *list,
                                  uint32_t *count, error *err)
{
    show_performance of;
    mrt_result result = show_performance_read(call->show, c->performance, &of, err);
    for (uint32_t i = 0; result >= 0 && i < of.performance.track_count; ++i) {
        uint32_t k = 0;
        while (k < *count && list[k].track != of.performance.track[i])
            ++k;
        if (k == *count && k < TAKE_TRACKS_MAX * 8)
            list[(*count)++] = (log_span){of.performance.track[i], c->from_ns, c->to_ns};
        else if (k < *count && c->from_ns < list[k].from_ns)
            list[k].from_ns = c->from_ns;
        if (k < *count && c->to_ns > list[k].to_ns)
            list[k].to_ns = c->to_ns;
    }
    if (result >= 0)
        show_performance_finish(&of);
    return result;
}

static mrt_result choose(take_call *call, const take *t, log_span *out, error *err)
{
    log_span list[TAKE_TRACKS_MAX * 8];
    uint32_t count = 0;
    double wanted = 0.0;
    mrt_result result = take_number(call, TAKE_TRACK, 1, 1e15, &wanted, err);
    for (uint32_t i = 0; i < t->layer_count && result >= 0; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count && result >= 0; ++k)
            result = add_performance(call, &t->layer[i].clip[k], list, &count, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < count; ++i)
        if (list[i].track == (int64_t)wanted || (count == 1 && !call->text[TAKE_TRACK])) {
            *out = list[i];
            return MRT_OK;
        }
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it has no track",
                         (long long)t->id);
    if (!call->text[TAKE_TRACK])
        return take_misused(call, err, "take %lld has %u tracks: --track N says which",
                            (long long)t->id, count);
    return error_set(err, MRT_ERR_ARGUMENT, "take %lld has no track %lld (marotte take show)",
                     (long long)t->id, (long long)wanted);
}

/* ---- the table ---- */

static void put_column(FILE *stream, const take_channel *c, uint32_t i)
{
    const char *side = c->hand == MRT_LEFT ? "left" : "right";
    if (c->semantic >= MRT_CH_PEDAL && c->semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS)
        fprintf(stream, ",pedal.%u", c->semantic - MRT_CH_PEDAL + 1);
    else if (c->hand <= MRT_RIGHT && c->semantic >= MRT_CH_ANGLE &&
             c->semantic < MRT_CH_ANGLE + MRT_ANGLES)
        fprintf(stream, ",%s.%s", side, sensor_table[c->semantic - MRT_CH_ANGLE].name);
    else if (c->hand <= MRT_RIGHT && c->semantic >= MRT_CH_WRIST && c->semantic < MRT_CH_WRIST + 7)
        fprintf(stream, ",%s.wrist.%s", side, wrist_name[c->semantic - MRT_CH_WRIST]);
    else
        fprintf(stream, ",channel.%u", i + 1);
}

static void put_head(FILE *stream, const show_track *of)
{
    fputs("# a track of a marotte take, as it was measured\ntime_ns", stream);
    for (uint32_t i = 0; i < of->track.channel_count; ++i)
        put_column(stream, &of->track.channel[i], i);
    fputs("\nunit", stream);
    for (uint32_t i = 0; i < of->track.channel_count; ++i) {
        const take_channel *c = &of->track.channel[i];
        bool is_angle = c->semantic >= MRT_CH_ANGLE && c->semantic < MRT_CH_ANGLE + MRT_ANGLES;
        fprintf(stream, ",%s", !is_angle ? "" : strcmp(c->unit, "count") == 0 ? "count" : "rad");
    }
    fputc('\n', stream);
}

static mrt_result put_samples(FILE *stream, show_reader *reader, const log_span *span,
                              uint64_t *out_count, error *err)
{
    mrt_sample sample;
    mrt_result result;
    while ((result = show_reader_next(reader, &sample, err)) != MRT_END) {
        if (result == MRT_ERR_FORMAT) {
            fprintf(stderr, "warning: %s\n", err->text);
            continue;
        }
        if (result < 0)
            return result;
        fprintf(stream, "%lld", (long long)(sample.time_ns - span->from_ns));
        for (uint32_t i = 0; i < sample.count; ++i)
            fprintf(stream, ",%.9g", (double)sample.value[i]);
        fputc('\n', stream);
        *out_count += 1;
    }
    return MRT_OK;
}

static mrt_result write_table(take_call *call, const log_span *span, const char *path, error *err)
{
    show_track of;
    show_reader *reader = NULL;
    file_writer writer;
    uint64_t count = 0;
    mrt_result result = show_track_read(call->show, span->track, &of, err);
    if (result < 0)
        return result;
    result = show_reader_open(&reader, call->show, span->track, span->from_ns, span->to_ns, err);
    if (result >= 0)
        result = file_writer_open(&writer, path, err);
    if (result >= 0) {
        put_head(writer.stream, &of);
        result = put_samples(writer.stream, reader, span, &count, err);
        if (result >= 0)
            result = file_writer_commit(&writer, err);
        else
            file_writer_abandon(&writer);
    }
    show_reader_close(reader);
    if (result >= 0) {
        facts_number(call->told, "track", "track", (double)span->track, 0, "");
        facts_text(call->told, "device", "device", of.track.device);
        facts_number(call->told, "channels", "channels", of.track.channel_count, 0, "");
        facts_number(call->told, "samples", "samples", (double)count, 0, "");
        facts_list(call->told, "files", "wrote", path);
    }
    show_track_finish(&of);
    return result;
}

mrt_result take_log_run(take_call *call, error *err)
{
    take t;
    log_span span = {0, 0, 0};
    mrt_result result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = take_read(call, call->word[1], &t, err);
    if (result < 0)
        return result;
    const exports_file table = {call->text[TAKE_OUT], EXPORTS_NONE};
    result = exports_check(&table, 1, err);
    if (result >= 0)
        result = choose(call, &t, &span, err);
    if (result >= 0)
        result = write_table(call, &span, call->text[TAKE_OUT], err);
    take_finish(&t);
    return result;
}
