#include "stage/playback/replay.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "hand/calibration_file.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/null_mapping.h"
#include "stage/perform/patch_file.h"
#include "show/hash.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTE = 512 };
/* Default memory limit of the samples read ahead of one performance, and again of its mapping's
 * answers. */
static const size_t ahead_bytes_default = (size_t)64 << 20;

typedef struct track { /* one input of the performance */
    int64_t id;
    replay *of;
    show_reader *reader;
    channel_route route;
    bool has_pending;
    mrt_sample pending;
    mrt_sample *ahead; /* samples read ahead, by time; NULL: none */
    size_t ahead_count, ahead_at;
} track;

struct replay {
    replay_world world;
    show_performance info;
    take_part part;
    isolate *isolate; /* NULL: the mapping runs in this process */
    instance mapping;
    layer *layer;
    track track[TAKE_TRACKS_MAX];
    uint32_t track_count;
    stage_frame frame;   /* its steps, while it performs alone */
    scheduler scheduler; /* its tracks, likewise */
    scheduler_entry entry[TAKE_TRACKS_MAX];
    bool has_ahead;      /* plays from memory, without files and processes */
    int64_t ahead_to_ns; /* show time of the last usable sample in memory */
    int64_t asked_from_ns, asked_to_ns;
    answers answers;   /* answers of the isolated mapping to the samples in memory */
    char missing[160]; /* reason why ahead_to_ns is earlier than requested */
    /* stored state before the first sample in memory; no bytes: none */
    show_checkpoint ahead_state;
    double length_mm[2]; /* hand lengths of the calibrations; 0: unknown */
    take_event *event;   /* events of the whole performance, by time */
    size_t event_count, next_event;
    int64_t now_ns;
    unsigned char *taught; /* taught values at the start of the performance; NULL: none */
    size_t taught_size;
    bool keeps_taught;   /* the recording program kept taught values over a reset of the mapping */
    bool is_same_plugin; /* the library is the one that wrote the stored states */
    error damage;        /* last reported error of damaged data */
    char note[NOTE];
};

/* ---- the mapping of the recording ---- */

/* Fields of a text such as "org.marotte.anchored 1.0 0123abcd": type id, version, hash. */
typedef struct plugin_words {
    char id[128], version[32], hash[TAKE_HASH];
} plugin_words;

static plugin_words parse_identity(const char *text)
{
    plugin_words out = {{0}, {0}, {0}};
    (void)sscanf(text ? text : "", "%127s %31s %64s", out.id, out.version, out.hash);
    return out;
}

/* Runs a mapping that is not built in in its own process, as on the stage, so that a crash does not
 * end the program. */
static mrt_result isolate_foreign(replay *self, const char *library, const mrt_plugin_type **type,
                                  error *err)
{
    const isolate_settings settings = {.clock = CLOCK_VIRTUAL};
    if (!isolate_is_wanted(ISOLATE_FOREIGN, library))
        return MRT_OK;
    mrt_result result = isolate_create_mapping(&self->isolate, *type, library, &settings, err);
    if (result >= 0)
        *type = isolate_type(self->isolate);
    return result;
}

/* Parts that need no mapping: their samples move the face directly. */
static bool is_own_part(take_part part)
{
    return part == TAKE_PALETTE || part == TAKE_LIFE;
}

static mrt_result find_mapping(replay *self, const mrt_plugin_type **out_type, error *err)
{
    plugin_words then = parse_identity(self->info.performance.mapping);
    if (is_own_part(self->part) || strcmp(then.id, null_mapping_type.id) == 0) {
        *out_type = &null_mapping_type;
        self->is_same_plugin = true;
        return MRT_OK;
    }
    mrt_result result = plugin_list_find(self->world.plugins, then.id, MRT_MAPPING, out_type, err);
    if (result < 0)
        return result;
    char hash[TAKE_HASH] = "";
    error ignored = {""};
    const char *path = plugin_list_path_of(self->world.plugins, *out_type);
    self->is_same_plugin = hash_file(hash, path, &ignored) >= 0 && strcmp(hash, then.hash) == 0;
    if (!self->is_same_plugin)
        snprintf(
            self->note, sizeof self->note,
            "%s: the recording used another library (version %s, now %.40s). The same hands may "
            "move the face differently.",
            then.id, then.version[0] ? then.version : "unknown", (*out_type)->version);
    return isolate_foreign(self, path, out_type, err);
}

static void set_param(instance *mapping, uint32_t id, double value)
{
    const mrt_plugin_type *type = mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (type->params[i].id == id && value >= type->params[i].min &&
            value <= type->params[i].max)
            atomic_store(&mapping->wanted[i], value);
}

static void set_first_params(replay *self)
{
    const take_performance *p = &self->info.performance;
    for (uint32_t i = 0; i < self->mapping.type->param_count; ++i)
        atomic_store(&self->mapping.wanted[i], self->mapping.type->params[i].initial);
    for (uint32_t i = 0; i < p->param_count; ++i)
        set_param(&self->mapping, p->param[i].id, p->param[i].value);
}

/* ---- tracks ---- */

static mrt_result calibrate(replay *self, track *t, const take_track *as, error *err)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        calibration_file file;
        hand_calibration used;
        const char *anew = self->info.performance.again.calibration[side];
        const char *text = anew ? anew : as->calibration[side];
        if (!text)
            continue;
        mrt_result result =
            calibration_file_parse(&file, text, strlen(text), "the take's calibration", err);
        if (result < 0)
            return result;
        calibration_file_use(&file, &used);
        self->length_mm[side] = file.hand_length_mm;
        calibration_file_finish(&file);
        channel_route_calibrate(&t->route, side, &used);
    }
    return MRT_OK;
}

/* Whether the part has the samples of this track. */
static bool is_in_part(const replay *self, const take_track *of)
{
    const uint32_t semantic = of->channel_count > 0 ? of->channel[0].semantic : 0;
    const take_part part = semantic == PALETTE_SEMANTIC ? TAKE_PALETTE
                           : semantic == LIFE_SEMANTIC  ? TAKE_LIFE
                                                        : TAKE_HANDS;
    return self->part == TAKE_WHOLE || self->part == part;
}

/* Notes the poses of a palette that this face lacks. */
static void check_poses(replay *self, const take_track *of)
{
    const mapped_face *mapped = composer_mapped(self->world.scratch->composer);
    const char *first = NULL;
    uint32_t missing = 0;
    if (of->channel_count == 0 || of->channel[0].semantic != PALETTE_SEMANTIC)
        return;
    for (uint32_t c = 1; c < of->channel_count; ++c) {
        bool is_there = of->channel[c].semantic != PALETTE_SEMANTIC; /* how much jaw or lips */
        for (uint32_t i = 0; i < mapped->pose_count && !is_there; ++i)
            is_there = strcmp(mapped->pose[i].name, of->channel[c].name) == 0;
        first = is_there || first ? first : of->channel[c].name;
        missing += !is_there;
    }
    const size_t used = strlen(self->note);
    if (missing > 1)
        (void)snprintf(self->note + used, sizeof self->note - used,
                       "%sThe face lacks %u poses of the palette, such as \"%s\". They do not move "
                       "it.",
                       used ? " " : "", missing, first);
    else if (missing > 0)
        (void)snprintf(
            self->note + used, sizeof self->note - used,
            "%sThe face lacks the pose \"%s\" of the palette. It does not move the face.",
            used ? " " : "", first);
}

/* MRT_END: the part does not have this track. */
static mrt_result open_track(replay *self, track *t, error *err)
{
    show_track info;
    mrt_channel channel[MRT_MAX_CHANNELS];
    mrt_result result = show_track_read(self->world.show, t->id, &info, err);
    if (result < 0)
        return result;
    if (!is_in_part(self, &info.track)) {
        show_track_finish(&info);
        return MRT_END;
    }
    check_poses(self, &info.track);
    for (uint32_t i = 0; i < info.track.channel_count; ++i) {
        const take_channel *c = &info.track.channel[i];
        channel[i] = (mrt_channel){c->name, c->unit, c->semantic, c->hand, c->min, c->max};
    }
    channel_route_init(&t->route, channel, info.track.channel_count);
    channel_route_call(&t->route, info.track.device);
    result = calibrate(self, t, &info.track, err);
    show_track_finish(&info);
    if (result < 0)
        return result;
    return show_reader_open(&t->reader, self->world.show, t->id, self->info.from_ns,
                            self->info.to_ns, err);
}

static mrt_result open_tracks(replay *self, error *err)
{
    mrt_result result = MRT_OK;
    const take_performance *p = &self->info.performance;
    for (uint32_t i = 0; i < p->track_count && result >= 0; ++i) {
        track *t = &self->track[self->track_count];
        t->id = p->track[i];
        result = open_track(self, t, err);
        self->track_count += result == MRT_OK;
    }
    return result < 0 ? result : MRT_OK;
}

static bool is_of_track(const replay *self, const take_event *e)
{
    const take_performance *p = &self->info.performance;
    for (uint32_t i = 0; i < p->track_count; ++i)
        if (p->track[i] == e->track)
            return true;
    return false;
}

/* Reads the events that change the performance: re-zeros and parameters. */
static mrt_result read_events(replay *self, error *err)
{
    mrt_result result = show_events(self->world.show, self->info.from_ns, self->info.to_ns,
                                    &self->event, &self->event_count, err);
    if (result < 0)
        return result;
    size_t kept = 0;
    for (size_t i = 0; i < self->event_count; ++i) {
        const take_event *e = &self->event[i];
        bool is_heard =
            e->kind == TAKE_EVENT_REZERO ||
            (e->kind == TAKE_EVENT_PARAM && !self->info.performance.again.ignores_params);
        if (is_heard && is_of_track(self, e))
            self->event[kept++] = *e;
    }
    self->event_count = kept;
    return MRT_OK;
}

/* Skips damaged chunks and logs each error once. The readable samples are performed. */
static mrt_result read_sample(replay *self, track *t, error *err)
{
    mrt_result result;
    if (self->has_ahead && t->ahead_at == t->ahead_count)
        return MRT_END;
    if (self->has_ahead) {
        t->pending = t->ahead[t->ahead_at++];
        return MRT_OK;
    }
    while ((result = show_reader_next(t->reader, &t->pending, err)) == MRT_ERR_FORMAT) {
        if (strcmp(self->damage.text, err->text) == 0)
            continue;
        self->damage = *err;
        log_push(self->world.log, MRT_LOG_WARNING, "take", err->text);
    }
    return result;
}

static mrt_result peek_track(void *data, mrt_sample *out, uint32_t *out_version, error *err)
{
    track *t = data;
    if (!t->has_pending) {
        mrt_result result = read_sample(t->of, t, err);
        if (result != MRT_OK)
            return result;
    }
    t->has_pending = true;
    *out = t->pending;
    *out_version = 0;
    return MRT_OK;
}

static void pop_sample(void *data)
{
    ((track *)data)->has_pending = false;
}

void replay_schedule(replay *self, scheduler *into, const sample_source *as)
{
    for (uint32_t i = 0; i < self->track_count; ++i) {
        track *t = &self->track[i];
        sample_source from = *as;
        from.self = t;
        from.peek = peek_track;
        from.take = pop_sample;
        t->of = self;
        scheduler_add(into, &from, &t->route);
    }
}

/* ---- taught values of the mapping ---- */

typedef struct kept_bytes {
    const unsigned char *data;
    size_t size;
} kept_bytes;

/* Parts of a stored state: the taught values of the mapping, the parts that are performed alone,
 * and the rest. */
typedef struct kept_parts {
    int64_t show_offset_ns;
    kept_bytes taught, palette, life, state;
} kept_parts;

/* Last versions without these parts. */
enum { WITHOUT_TAUGHT = 2, WITHOUT_PALETTE = 3, WITHOUT_LIFE = 4 };

static kept_bytes read_kept(bytes_in *in)
{
    const size_t size = bytes_read_u32(in);
    const kept_bytes out = {in->at, size};
    in->failed |= size > (size_t)(in->end - in->at);
    in->at += in->failed ? 0 : size;
    return out;
}

static bool parse_checkpoint(kept_parts *out, const show_checkpoint *kept)
{
    *out = (kept_parts){0};
    if (!kept->bytes || kept->version < WITHOUT_TAUGHT || kept->version > REPLAY_CHECKPOINT_VERSION)
        return false;
    bytes_in in = {.at = kept->bytes, .end = (const unsigned char *)kept->bytes + kept->size};
    bytes_read(&in, &out->show_offset_ns, sizeof out->show_offset_ns);
    if (kept->version > WITHOUT_TAUGHT)
        out->taught = read_kept(&in);
    if (kept->version > WITHOUT_PALETTE)
        out->palette = read_kept(&in);
    if (kept->version > WITHOUT_LIFE)
        out->life = read_kept(&in);
    out->state = (kept_bytes){in.at, (size_t)(in.end - in.at)};
    return !in.failed;
}

/* Returns the largest possible size of a stored state of this face. */
static size_t most_kept(const replay *self)
{
    const points *rest = face_rest(composer_face(self->world.scratch->composer));
    return REPLAY_CHECKPOINT_BYTES + (size_t)rest->padded_count * 2 * 3 * sizeof(float);
}

/* Reads the taught values at the start of the performance. A reset restores them. */
static mrt_result read_taught(replay *self, error *err)
{
    show_checkpoint kept;
    kept_parts parts;
    const take_performance *p = &self->info.performance;
    if (!plugin_interface(self->mapping.type, MRT_STATE))
        return MRT_OK;
    mrt_result result = show_checkpoint_before(self->world.show, p->again.of ? p->again.of : p->id,
                                               self->info.from_ns, most_kept(self), &kept, err);
    if (result == MRT_ERR_FORMAT)
        log_push(self->world.log, MRT_LOG_WARNING, "take", err->text);
    else if (result < 0)
        return result;
    error why = {""};
    if (result >= 0 && parse_checkpoint(&parts, &kept) && parts.taught.size > 0) {
        self->keeps_taught = true;
        if (taught_load(&self->mapping, parts.taught.data, parts.taught.size, &why) < 0)
            log_push(self->world.log, MRT_LOG_WARNING, "take", why.text);
    }
    if (result >= 0)
        show_checkpoint_finish(&kept);
    self->taught_size = taught_save(&self->mapping, NULL, 0);
    self->taught = self->taught_size > 0 ? malloc(self->taught_size) : NULL;
    if (self->taught)
        (void)taught_save(&self->mapping, self->taught, self->taught_size);
    return MRT_OK;
}

/* ---- open and close ---- */

static mrt_result set_patch(replay *self, error *err)
{
    const char *text = self->info.performance.patch;
    patch *p = text ? malloc(sizeof *p) : NULL;
    patch_plan *plan = NULL, *none;
    if (!text)
        return MRT_OK;
    if (!p)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    mrt_result result = patch_file_parse(p, text, strlen(text), "the take's patch", err);
    if (result >= 0)
        result = performer_make_patch(self->world.scratch, p, &plan, err);
    free(p);
    if (result >= 0)
        (void)patch_bay_set(&self->layer->bay, plan, &none);
    return result;
}

mrt_result replay_open(replay **out, const replay_world *world, int64_t performance, take_part part,
                       error *err)
{
    *out = NULL;
    replay *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
    self->world = *world;
    self->part = part;
    self->now_ns = INT64_MIN;
    const mrt_plugin_type *type = NULL;
    mrt_result result = show_performance_read(world->show, performance, &self->info, err);
    if (result >= 0)
        result = find_mapping(self, &type, err);
    if (result >= 0)
        result = instance_create(&self->mapping, type, CLOCK_VIRTUAL, world->log, err);
    if (result < 0)
        goto fail;
    set_first_params(self);
    result = read_taught(self, err);
    if (result >= 0)
        result = open_tracks(self, err);
    if (result < 0)
        goto fail;
    const sample_source alone = {.voice = 0};
    scheduler_init(&self->scheduler, SCHEDULE_RECORDED, self->entry, NULL, TAKE_TRACKS_MAX);
    self->frame = (stage_frame){.performer = world->scratch, .sources = &self->scheduler};
    replay_schedule(self, &self->scheduler, &alone);
    const take_performance *p = &self->info.performance;
    layer_settings settings = {.hands.rezero_pedal = p->rezero_pedal,
                               .hands.min_cutoff_hz = p->again.min_cutoff_hz,
                               .hands.has_beta = p->again.has_beta,
                               .hands.beta = p->again.beta,
                               .keeps_taught = self->keeps_taught};
    for (int side = 0; side < 2; ++side)
        settings.hands.length_mm[side] =
            p->hand_length_mm > 0 ? p->hand_length_mm : self->length_mm[side];
    const composer *shown = world->scratch->composer;
    settings.reach_mm = composer_reach_mm(shown, &settings.centre);
    result = layer_create(&self->layer, &self->mapping, composer_mapped(shown), &settings, err);
    if (result >= 0 && !is_own_part(part))
        result = set_patch(self, err);
    if (result >= 0)
        result = read_events(self, err);
    if (result < 0)
        goto fail;
    *out = self;
    return MRT_OK;
fail:
    replay_close(self);
    return result;
}

void replay_forget_ahead(replay *self)
{
    for (uint32_t i = 0; i < self->track_count; ++i) {
        free(self->track[i].ahead);
        self->track[i].ahead = NULL;
        self->track[i].ahead_count = 0;
    }
    show_checkpoint_finish(&self->ahead_state);
    answers_finish(&self->answers);
    if (self->layer)
        self->layer->answers = NULL;
    self->has_ahead = false;
    self->missing[0] = '\0';
}

void replay_close(replay *self)
{
    if (!self)
        return;
    replay_forget_ahead(self);
    for (uint32_t i = 0; i < self->track_count; ++i)
        show_reader_close(self->track[i].reader);
    layer_destroy(self->layer);
    instance_destroy(&self->mapping);
    isolate_destroy(self->isolate);
    free(self->event);
    free(self->taught);
    show_performance_finish(&self->info);
    free(self);
}

bool replay_is_of(const replay *self, const take_clip *clip)
{
    return self->info.performance.id == clip->performance && self->part == clip->part;
}

layer *replay_layer(replay *self)
{
    return self->layer;
}

const char *replay_note(const replay *self)
{
    return self->note;
}

mrt_result replay_check(const replay *self, error *err)
{
    return isolate_check(&self->mapping, err);
}

int64_t replay_now_ns(const replay *self)
{
    return self->now_ns;
}

/* ---- step ---- */

void replay_prepare(replay *self, const sample_step *s)
{
    for (; self->next_event < self->event_count; ++self->next_event) {
        const take_event *e = &self->event[self->next_event];
        error why = {""};
        if (e->time_ns > s->time_ns)
            break;
        if (e->kind == TAKE_EVENT_PARAM)
            set_param(&self->mapping, e->param, e->value);
        else if (hands_rezero(self->layer->hands, e->hand, self->layer->frame.time_ns, &why) !=
                 MRT_OK)
            continue; /* the re-zero was refused in the recording too */
    }
    self->now_ns = s->time_ns;
}

static void perform_alone(replay *self, performer *on)
{
    performer_voice *alone = &on->voice[0];
    if (alone->layer != self->layer)
        *alone =
            (performer_voice){.layer = self->layer, .is_seen = true, .weight = 1.0, .gain = 1.0};
}

static mrt_result perform_next(replay *self, int64_t before_ns, error *err)
{
    sample_step *next = &self->frame.step;
    int64_t ignored_ns;
    mrt_result result = scheduler_next(&self->scheduler, 0, next, &ignored_ns, err);
    if (result < 0)
        return result;
    if (result != MRT_OK || next->time_ns >= before_ns)
        return MRT_END;
    perform_alone(self, self->world.scratch);
    replay_prepare(self, next);
    return frame_step(&self->frame, err);
}

mrt_result replay_pull(replay *self, int64_t before_ns, error *err)
{
    self->frame.is_pull_only = true;
    mrt_result result = perform_next(self, before_ns, err);
    self->frame.is_pull_only = false;
    return result;
}

/* ---- seek ---- */

static size_t count_before(const track *t, int64_t time_ns)
{
    size_t low = 0, high = t->ahead_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (t->ahead[middle].time_ns < time_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Moves the tracks and events to the first one after now_ns. */
static mrt_result position(replay *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->track_count && result >= 0; ++i) {
        track *t = &self->track[i];
        int64_t from_ns = self->now_ns == INT64_MIN ? self->info.from_ns : self->now_ns + 1;
        t->has_pending = false;
        if (self->has_ahead)
            t->ahead_at = count_before(t, from_ns);
        else
            result = show_reader_seek(t->reader, from_ns, err);
    }
    self->next_event = 0;
    while (self->next_event < self->event_count &&
           self->event[self->next_event].time_ns <= self->now_ns)
        self->next_event += 1;
    return result;
}

static mrt_result rewind_all(replay *self, error *err)
{
    error why = {""};
    self->now_ns = INT64_MIN;
    set_first_params(self);
    if (self->taught && !self->answers.is_given &&
        taught_load(&self->mapping, self->taught, self->taught_size, &why) < 0)
        log_push(self->world.log, MRT_LOG_WARNING, "take", why.text);
    layer_reset(self->layer);
    composer_reset(self->world.scratch->composer);
    return position(self, err);
}

/* The same for a part that needs no mapping. */
static mrt_result resume_own(replay *self, const kept_parts *kept, performer *into, error *err)
{
    layer *of = self->layer;
    const kept_bytes *bytes = self->part == TAKE_LIFE ? &kept->life : &kept->palette;
    layer_reset(of);
    composer_reset(into->composer);
    if (bytes->size > 0 && self->part == TAKE_LIFE &&
        !life_load(&of->life, &of->guard, bytes->data, bytes->size))
        return error_set(err, MRT_ERR_FORMAT, "the stored life of the face is damaged");
    if (bytes->size > 0 && self->part == TAKE_PALETTE &&
        !palette_load(&of->palette, &of->guard, bytes->data, bytes->size))
        return error_set(err, MRT_ERR_FORMAT, "the stored palette is of other poses");
    palette_shift_time(&of->palette, kept->show_offset_ns);
    life_shift_time(&of->life, kept->show_offset_ns);
    frame_recompose(into, 0);
    return MRT_OK;
}

/* Restores a state that replay_write_state wrote. */
static mrt_result resume(replay *self, const kept_parts *kept, performer *into, error *err)
{
    layer *of = self->layer;
    perform_alone(self, into);
    if (is_own_part(self->part))
        return resume_own(self, kept, into, err);
    mrt_result result = performer_load(into, kept->state.data, kept->state.size, err);
    if (result >= 0 && self->part == TAKE_HANDS && (of->palette.is_known || of->life.is_known)) {
        palette_reset(&of->palette);
        life_reset(&of->life);
        frame_recompose(into, 0);
    }
    if (result >= 0) {
        layer_shift_time(self->layer, kept->show_offset_ns);
        composer_shift_time(into->composer, kept->show_offset_ns);
    }
    return result;
}

mrt_result replay_restore(replay *self, int64_t time_ns, int64_t least_ns, performer *into,
                          error *err)
{
    show_checkpoint kept;
    error ignored = {""};
    if (!self->is_same_plugin || time_ns == INT64_MIN)
        return MRT_HOLD;
    bool has_kept = self->has_ahead;
    if (has_kept && (!self->ahead_state.bytes || self->ahead_state.time_ns >= time_ns))
        return MRT_HOLD;
    mrt_result result = MRT_OK;
    if (has_kept)
        kept = self->ahead_state;
    else
        result = show_checkpoint_before(self->world.show, self->info.performance.id, time_ns - 1,
                                        most_kept(self), &kept, err);
    if (result == MRT_ERR_FORMAT)
        return MRT_HOLD; /* damaged: perform the samples instead, which reports the damage */
    if (result < 0)
        return result;
    kept_parts parts;
    bool is_wanted =
        kept.time_ns >= least_ns && parse_checkpoint(&parts, &kept) && parts.state.size > 0;
    bool is_usable = is_wanted && resume(self, &parts, into, &ignored) >= 0;
    int64_t then_ns = kept.time_ns;
    if (!has_kept)
        show_checkpoint_finish(&kept);
    if (!is_wanted)
        return MRT_HOLD;
    if (!is_usable)
        return rewind_all(self, err) < 0 ? MRT_ERR_FORMAT : MRT_HOLD;
    self->now_ns = then_ns;
    return position(self, err);
}

mrt_result replay_seek(replay *self, int64_t time_ns, error *err)
{
    mrt_result result = replay_restore(self, time_ns, INT64_MIN, self->world.scratch, err);
    if (result == MRT_HOLD)
        result = rewind_all(self, err);
    if (result < 0)
        return result;
    while (result == MRT_OK)
        result = perform_next(self, time_ns, err);
    return result < 0 ? result : MRT_OK;
}

/* ---- play from memory ---- */

static size_t ahead_bytes(const replay *self)
{
    return self->world.ahead_bytes ? self->world.ahead_bytes : ahead_bytes_default;
}

/* Ends the usable span in memory at a show time. */
static void end_ahead(replay *self, int64_t at_ns, const char *why)
{
    int64_t since_ns = at_ns > self->info.from_ns ? at_ns - self->info.from_ns : 0;
    self->ahead_to_ns = at_ns;
    for (uint32_t i = 0; i < self->track_count; ++i)
        self->track[i].ahead_count = count_before(&self->track[i], at_ns + 1);
    (void)snprintf(self->missing, sizeof self->missing,
                   "during the overdub, performance %lld keeps its last pose after %.1f s: %s",
                   (long long)self->info.performance.id, (double)since_ns * 1e-9, why);
}

/* Reads samples up to ahead_to_ns. If the memory limit is reached, ahead_to_ns moves to the last
 * sample that fits. */
static mrt_result read_track_ahead(replay *self, track *t, int64_t from_ns, error *err)
{
    size_t most = ahead_bytes(self) / sizeof *t->ahead / self->track_count, capacity = 0;
    mrt_result result = show_reader_seek(t->reader, from_ns, err);
    while (result >= 0 && (result = read_sample(self, t, err)) == MRT_OK) {
        if (t->pending.time_ns > self->ahead_to_ns)
            break;
        if (t->ahead_count == most) {
            end_ahead(self, t->pending.time_ns - 1, "its samples exceed the memory limit");
            break;
        }
        if (t->ahead_count == capacity) {
            capacity = capacity * 2 + 256;
            mrt_sample *grown = realloc(t->ahead, capacity * sizeof *grown);
            if (!grown)
                return error_set(err, MRT_ERR_MEMORY, "no memory to read the take ahead");
            t->ahead = grown;
        }
        t->ahead[t->ahead_count++] = t->pending;
    }
    return result < 0 ? result : MRT_OK;
}

/* Reads the last stored state before the requested span. Returns the show time of the first sample
 * to read: after that state, or the start of the performance. */
static int64_t read_state_ahead(replay *self)
{
    kept_parts parts;
    error ignored = {""};
    if (!self->is_same_plugin ||
        show_checkpoint_before(self->world.show, self->info.performance.id, self->asked_from_ns - 1,
                               most_kept(self), &self->ahead_state, &ignored) < 0)
        return self->info.from_ns;
    if (parse_checkpoint(&parts, &self->ahead_state) && parts.state.size > 0 &&
        self->ahead_state.time_ns >= self->info.from_ns)
        return self->ahead_state.time_ns + 1;
    show_checkpoint_finish(&self->ahead_state);
    return self->info.from_ns;
}

static mrt_result read_ahead(replay *self, error *err)
{
    replay_forget_ahead(self);
    self->ahead_to_ns = self->asked_to_ns < self->info.to_ns ? self->asked_to_ns : self->info.to_ns;
    int64_t from_ns = read_state_ahead(self);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->track_count && result >= 0; ++i)
        result = read_track_ahead(self, &self->track[i], from_ns, err);
    self->has_ahead = result >= 0;
    self->answers.is_given = self->has_ahead && self->isolate;
    self->layer->answers = self->answers.is_given ? &self->answers : NULL;
    return result;
}

mrt_result replay_read_ahead(replay *self, int64_t from_ns, int64_t to_ns, error *err)
{
    if (self->has_ahead && self->asked_from_ns < from_ns)
        from_ns = self->asked_from_ns;
    if (self->has_ahead && self->asked_to_ns > to_ns)
        to_ns = self->asked_to_ns;
    self->asked_from_ns = from_ns;
    self->asked_to_ns = to_ns;
    mrt_result result = read_ahead(self, err);
    mrt_result placed = position(self, err);
    return result < 0 ? result : placed;
}

/* Returns why replay_answer_ahead must stop. NULL: continue. */
static const char *stop_reason(const replay *self, int64_t until_ns)
{
    error ignored = {""};
    if (replay_check(self, &ignored) < 0)
        return "the process of its mapping has failed";
    if (clock_now_ns() >= until_ns)
        return "its mapping is too slow";
    bool is_too_much = self->answers.is_full || answers_size(&self->answers) > ahead_bytes(self);
    return is_too_much ? "the answers of its mapping exceed the memory limit" : NULL;
}

mrt_result replay_answer_ahead(replay *self, int64_t until_ns, error *err)
{
    const char *why = NULL;
    self->answers.is_given = false; /* call the mapping and store its answers */
    mrt_result result = replay_restore(self, INT64_MAX, INT64_MIN, self->world.scratch, err);
    if (result == MRT_HOLD &&
        self->ahead_state.bytes) { /* the state cannot be loaded: perform from the start */
        self->is_same_plugin = false;
        result = read_ahead(self, err) < 0 ? MRT_ERR_IO : MRT_HOLD;
        self->answers.is_given = false;
    }
    if (result == MRT_HOLD)
        result = rewind_all(self, err);
    while (self->isolate && result >= 0 && !why &&
           (result = perform_next(self, INT64_MAX, err)) == MRT_OK)
        why = stop_reason(self, until_ns);
    if (why)
        end_ahead(self, self->now_ns - 1, why);
    self->answers.is_given = self->isolate != NULL;
    return result < 0 ? result : MRT_OK;
}

const char *replay_missing(const replay *self)
{
    return self->missing;
}

/* ---- states ---- */

size_t replay_write_state(const instance *mapping, performer *of, int64_t show_offset_ns,
                          void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const layer *from = of ? of->voice[0].layer : NULL;
    const size_t taught = taught_save(mapping, NULL, 0),
                 size = of ? performer_save(of, NULL, 0) : 0,
                 poses = from && from->palette.is_known ? palette_save(&from->palette, NULL, 0) : 0,
                 lives = from && from->life.is_known ? life_save(&from->life, NULL, 0) : 0;
    if (size == 0 && taught == 0)
        return 0;
    bytes_write(&out, &show_offset_ns, sizeof show_offset_ns);
    bytes_write_u32(&out, (uint32_t)taught);
    if (out.data && taught > 0 && taught <= out.capacity - out.size)
        (void)taught_save(mapping, out.data + out.size, taught);
    out.size += taught;
    bytes_write_u32(&out, (uint32_t)poses);
    if (out.data && poses > 0 && out.size <= out.capacity && poses <= out.capacity - out.size)
        (void)palette_save(&from->palette, out.data + out.size, poses);
    out.size += poses;
    bytes_write_u32(&out, (uint32_t)lives);
    if (out.data && lives > 0 && out.size <= out.capacity && lives <= out.capacity - out.size)
        (void)life_save(&from->life, out.data + out.size, lives);
    out.size += lives;
    if (out.data && size > 0 && out.size <= out.capacity && size <= out.capacity - out.size)
        performer_save(of, out.data + out.size, size);
    return out.size + size;
}

size_t replay_save(replay *self, void *bytes, size_t capacity)
{
    size_t size = layer_save(self->layer, NULL, 0);
    if (size == 0)
        return 0;
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write(&out, &self->now_ns, sizeof self->now_ns);
    if (out.data && out.size + size <= out.capacity)
        layer_save(self->layer, out.data + out.size, size);
    return out.size + size;
}

mrt_result replay_load(replay *self, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    bytes_read(&in, &self->now_ns, sizeof self->now_ns);
    if (in.failed)
        return error_set(err, MRT_ERR_FORMAT, "the saved state of a performance is damaged");
    mrt_result result = layer_load(self->layer, in.at, (size_t)(in.end - in.at), err);
    return result < 0 ? result : position(self, err);
}
