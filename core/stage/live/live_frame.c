#include "stage/live/live_stage.h"
#include "base/clock.h"

#include <string.h>

/* The frame thread. First section: the timeline of a take that is paused, played, scrubbed or
 * overdubbed. */

/* Delay of the drawn instant during an overdub: samples that are still in transit arrive before
 * it. */
static const int64_t wait_ns = 15 * NS_PER_MS;

static const transport still = {.speed = 1.0};

static const transport *live_time_motion(const live_stage *stage)
{
    if (stage->mode == LIVE_OVERDUBS)
        return &stage->over->transport;
    return stage->timeline ? &stage->motion[slot_front(&stage->motion_slot)] : &still;
}

static void put_beats(const live_stage *stage, bool is_recorded, sound_motion *out)
{
    const live_click *click = &stage->click;
    uint32_t heard = click->when == LIVE_CLICK_ALWAYS ? SOUND_BEATS_AFTER : 0;
    if (is_recorded && click->when >= LIVE_CLICK_COUNT_IN)
        heard = SOUND_BEATS_BEFORE;
    if (is_recorded && click->when >= LIVE_CLICK_RECORDING)
        heard |= SOUND_BEATS_AFTER;
    out->beats = heard;
    out->beat_ns = heard ? 60e9 / click->bpm : 0.0;
    out->bar = click->bar;
}

void live_time_update_sound(live_stage *stage, int64_t now_ns)
{
    if (!stage->sound)
        return;
    sound_motion motion = {.host_ns = now_ns};
    if (stage->mode != LIVE_PERFORMS)
        motion = sound_motion_of(live_time_motion(stage), now_ns);
    else if (stage->count_ns)
        motion = (sound_motion){.host_ns = stage->count_ns, .speed = 1.0, .is_mute = true};
    put_beats(stage, stage->mode == LIVE_OVERDUBS || stage->count_ns, &motion);
    sound_move(stage->sound, &motion);
}

static void tell_error(live_stage *stage, const error *err)
{
    log_push(stage->log, MRT_LOG_ERROR, "take", err->text);
}

int64_t live_time_shown_at(const transport *motion, int64_t at_ns)
{
    return at_ns >= motion->end_ns && motion->end_ns > 0 ? motion->end_ns - 1 : at_ns;
}

/* ---- commands of [main] ---- */

/* Longest sleep of [main] before it checks again whether the frame thread has finished. */
static const int64_t patience_ns = 50 * NS_PER_MS;

mrt_result live_run_command(live *self, live_command_run *run, void *data, error *err)
{
    live_command command = {.run = run, .data = data, .err = err};
    if (!self->has_thread)
        return run(&self->stage, data, err);
    atomic_store(&self->command, &command);
    wake_signal(player_wake(self->stage.loop));
    for (;;) {
        uint32_t seen = wake_seen(&self->answered);
        if (!atomic_load(&self->command))
            return command.result;
        wake_wait_until_ns(&self->answered, seen, clock_now_ns() + patience_ns);
    }
}

/* [frame] Runs the pending command, if any. */
static void run_command(live *self)
{
    live_command *waiting = atomic_load(&self->command);
    if (!waiting)
        return;
    waiting->result = waiting->run(&self->stage, waiting->data, waiting->err);
    atomic_store(&self->command, NULL); /* [main] owns the command again */
    wake_signal(&self->answered);
}

/* ---- the thread of the timeline ---- */

static live_timeline_state next_state(live_timeline_state from, live_timeline_event event)
{
    bool is_here = from == LIVE_TIMELINE_HERE || from == LIVE_TIMELINE_ARRIVED;
    switch (event) {
    case LIVE_TIMELINE_SEND:
        return is_here ? LIVE_TIMELINE_AWAY : from;
    case LIVE_TIMELINE_RECEIVE:
        return from == LIVE_TIMELINE_BACK ? LIVE_TIMELINE_ARRIVED : from;
    case LIVE_TIMELINE_PUBLISH:
        return from == LIVE_TIMELINE_ARRIVED ? LIVE_TIMELINE_HERE : from;
    case LIVE_TIMELINE_HOLD:
        return from == LIVE_TIMELINE_AWAY ? LIVE_TIMELINE_RECALLED : LIVE_TIMELINE_HELD;
    case LIVE_TIMELINE_RELEASE:
        return from == LIVE_TIMELINE_HELD       ? LIVE_TIMELINE_HERE
               : from == LIVE_TIMELINE_RECALLED ? LIVE_TIMELINE_AWAY
                                                : from;
    case LIVE_TIMELINE_DONE:
        return from == LIVE_TIMELINE_AWAY       ? LIVE_TIMELINE_BACK
               : from == LIVE_TIMELINE_RECALLED ? LIVE_TIMELINE_HELD
                                                : from;
    }
    return from;
}

live_timeline_state live_timeline_move(live_timeline *self, live_timeline_event event)
{
    uint32_t from = atomic_load(&self->state);
    live_timeline_state to;
    do
        to = next_state((live_timeline_state)from, event);
    while (!atomic_compare_exchange_weak(&self->state, &from, (uint32_t)to));
    return to;
}

static bool has_work(live_timeline *self)
{
    uint32_t state = atomic_load(&self->state);
    return state == LIVE_TIMELINE_AWAY || state == LIVE_TIMELINE_RECALLED;
}

static void *run_timeline(void *data)
{
    live_timeline *self = data;
    while (!atomic_load(&self->stop)) {
        uint32_t seen = wake_seen(&self->work);
        if (!has_work(self)) {
            if (!atomic_load(&self->stop))
                wake_wait_until_ns(&self->work, seen, clock_now_ns() + NS_PER_S);
            continue;
        }
        self->failed.text[0] = '\0';
        mrt_result result = self->is_seek
                                ? sequencer_seek(self->sequencer, self->to_ns, &self->failed)
                                : sequencer_play_to(self->sequencer, self->to_ns, &self->failed);
        if (result >= 0)
            self->failed.text[0] = '\0';
        (void)live_timeline_move(self, LIVE_TIMELINE_DONE);
        wake_signal(self->done);
    }
    return NULL;
}

mrt_result live_timeline_start(live_timeline *self, wake *done, error *err)
{
    wake_init(&self->work);
    self->done = done;
    atomic_init(&self->stop, false);
    atomic_init(&self->state, LIVE_TIMELINE_HERE);
    if (pthread_create(&self->thread, NULL, run_timeline, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "cannot create the playback thread of the take");
    self->has_thread = true;
    return MRT_OK;
}

void live_timeline_stop(live_timeline *self)
{
    if (!self->has_thread)
        return;
    atomic_store(&self->stop, true);
    wake_signal(&self->work);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

static live_timeline_state state_of(const live_stage *stage)
{
    return (live_timeline_state)atomic_load(&stage->timeline->state);
}

/* Returns whether the frame thread owns the sequencer of the timeline. */
static bool live_time_is_here(const live_stage *stage)
{
    return stage->timeline &&
           (state_of(stage) == LIVE_TIMELINE_HERE || state_of(stage) == LIVE_TIMELINE_ARRIVED);
}

/* Accepts the result of the timeline's thread after it has finished its last seek or playback. */
static void receive(live_stage *stage)
{
    if (!stage->timeline || state_of(stage) != LIVE_TIMELINE_BACK)
        return;
    (void)live_timeline_move(stage->timeline, LIVE_TIMELINE_RECEIVE);
    stage->is_dirty = true;
    if (stage->timeline->failed.text[0])
        tell_error(stage, &stage->timeline->failed);
}

/* Between steps: returns whether a face is ready to be published. */
static bool live_time_may_show(live_stage *stage, int64_t now_ns)
{
    receive(stage);
    return stage->mode != LIVE_SHOWS || !stage->timeline ||
           (now_ns >= stage->hold_until_ns && live_time_is_here(stage) &&
            (state_of(stage) == LIVE_TIMELINE_ARRIVED || !stage->has_pending_seek));
}

/* Sends the timeline's thread to the newest requested instant. Earlier requests are dropped. */
static void live_time_send(live_stage *stage, int64_t now_ns)
{
    receive(stage);
    if (stage->mode != LIVE_SHOWS || !live_time_is_here(stage) || now_ns < stage->hold_until_ns)
        return;
    live_timeline *to = stage->timeline;
    const transport *motion = live_time_motion(stage);
    int64_t at_ns = live_time_shown_at(motion, transport_at(motion, now_ns).at_ns);
    if (!stage->has_pending_seek && at_ns == sequencer_now_ns(to->sequencer))
        return;
    to->to_ns = at_ns;
    to->is_seek = stage->has_pending_seek;
    stage->has_pending_seek = false;
    (void)live_timeline_move(to, LIVE_TIMELINE_SEND);
    wake_signal(&to->work);
}

/* ---- overdub ---- */

/* The last face of the overdub stays until the take is shown with the new layer, or for
 * LIVE_HOLD_NS. */
static void end_over(live_stage *stage, int64_t now_ns)
{
    sequencer_set_live(stage->timeline->sequencer, NULL, NULL, false);
    stage->mode = LIVE_SHOWS;
    stage->hold_until_ns = now_ns + LIVE_HOLD_NS;
    stage->has_pending_seek = true;
}

void live_time_end_over(live_stage *stage, int64_t now_ns, error *err)
{
    error why = {""};
    if (overdub_run_end(stage->over, stage->recorder, &why) < 0) {
        tell_error(stage, &why);
        (void)error_set(err, MRT_ERR_IO, "%s", why.text);
    }
    end_over(stage, now_ns);
}

static performer *shown_over(live_stage *stage, int64_t now_ns)
{
    error err = {""};
    if (overdub_run_play_to(stage->over, stage->timeline->sequencer, stage->recorder,
                            now_ns - wait_ns, &err) < 0)
        tell_error(stage, &err);
    player_show_until(stage->loop, stage->over->played_ns);
    if (stage->over->state == OVERDUB_OVER)
        end_over(stage, now_ns);
    return sequencer_performer(stage->timeline->sequencer);
}

/* Returns the performer whose face is shown now. NULL: the published face stays. */
static performer *live_time_shown(live_stage *stage, int64_t now_ns)
{
    if (stage->mode == LIVE_PERFORMS || !stage->timeline)
        return stage->scene->performer;
    live_time_update_sound(stage, now_ns);
    if (stage->mode == LIVE_OVERDUBS)
        return shown_over(stage, now_ns);
    if (!live_time_may_show(stage, now_ns))
        return NULL;
    (void)live_timeline_move(stage->timeline, LIVE_TIMELINE_PUBLISH);
    return sequencer_performer(stage->timeline->sequencer);
}

/* ---- perform and record samples, publish the newest face ---- */

static const int64_t meter_span_ns = 250 * NS_PER_MS;
/* Minimum interval between published faces that [main] has not read, so that fast inputs cannot
 * saturate the thread. */
static const int64_t least_apart_ns = 4 * NS_PER_MS;

static void tell_main(const live_stage *stage)
{
    if (stage->changed)
        wake_signal(stage->changed);
}

/* ---- steps ---- */

static void hear(live_sample_board *board, const mrt_sample *sample)
{
    uint64_t presses = 0;
    if (!board)
        return;
    for (uint32_t i = 0; i < sample->count; ++i) {
        if (board->last[i] <= 0.0f && sample->value[i] > 0.0f)
            presses |= UINT64_C(1) << i;
        board->last[i] = sample->value[i];
    }
    if (presses)
        atomic_fetch_or(&board->presses, presses);
    board->sample[slot_back(&board->slot)] = *sample;
    slot_publish(&board->slot);
}

static void follow_reload(live_stage *stage)
{
    reload *r = stage->reload;
    if (r && reload_step(r, stage->scene->performer->voice[0].layer) && stage->recorder)
        recorder_change_mapping(stage->recorder, reload_identity(r));
}

/* Life reacts to what the face did in the step before, the take below an overdub included. */
static void watch_face(live_stage *stage, sample_step *s)
{
    const performer *shown = stage->mode == LIVE_OVERDUBS
                                 ? sequencer_performer(stage->timeline->sequencer)
                                 : stage->scene->performer;
    life_watch(s, &stage->scene->performer->voice[0].layer->life.body,
               composer_watched(shown->composer));
}

/* stage_frame.record: runs before any phase reads the samples, and chooses the performer. */
static mrt_result record_step(void *data, stage_frame *f, error *err)
{
    live *self = data;
    live_stage *stage = &self->stage;
    const sample_step *s = &f->step;
    follow_reload(stage);
    watch_face(stage, &f->step);
    if (stage->recorder)
        recorder_step(stage->recorder, s);
    for (uint32_t i = 0; i < s->count; ++i) {
        const step_sample *of = &s->of[i];
        if (of->input == 0)
            stage->pointed = of->sample;
        else
            tap_push(self->tap, of->input - 1, &of->sample);
        hear(stage->heard[of->input], &of->sample);
    }
    stage->is_dirty = true;
    f->performer = stage->scene->performer;
    if (stage->mode != LIVE_OVERDUBS)
        return MRT_OK;
    if (overdub_run_step(stage->over, stage->timeline->sequencer, stage->recorder, f, err) < 0)
        tell_error(stage, err);
    if (stage->over->state == OVERDUB_OVER) /* the hand alone performs this step */
        end_over(stage, s->time_ns);
    return MRT_OK;
}

static void note_step(void *data, const stage_frame *f)
{
    live_stage *stage = &((live *)data)->stage;
    const sample_step *s = &f->step;
    live_pulse *now = &stage->now;
    if (stage->recorder)
        recorder_performed(stage->recorder, s);
    const double lag_ms = (double)(clock_now_ns() - s->time_ns) / (double)NS_PER_MS;
    const bool is_life = s->count == 1 && life_is_route(s->of[0].route);
    if (!is_life) /* nobody waits for a tick of life */
        now->lag_ms[now->lag_count++ % LIVE_LAGS] = (float)lag_ms;
    now->sample_count += s->count;
    now->last_ns = stage->sample_ns = s->time_ns;
}

static void on_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    (void)time_s;
    live *self = data;
    live_stage *stage = &self->stage;
    for (uint32_t i = 0; stage->recorder && i < stage->input_count; ++i)
        if (player_input(stage->loop, i) == from)
            recorder_incident(stage->recorder, i, what);
    if (what->kind == INPUT_WAS_LOST)
        log_pushf(stage->log, MRT_LOG_WARNING, input_name(from),
                  "%s. The face keeps its last pose.",
                  what->text[0] ? what->text : "the device was disconnected");
    else
        log_pushf(stage->log, MRT_LOG_INFO, input_name(from), "is back after %.1f s",
                  (double)what->away_ns / 1e9);
    tell_main(stage);
}

mrt_result live_frame_tick(live_stage *stage, error *err)
{
    mrt_sample sample = stage->pointed;
    sample.time_ns = clock_now_ns();
    sample.count = POINTER_CHANNELS;
    return player_perform_sample(stage->loop, 0, &sample, err);
}

/* ---- faces ---- */

static void meter(live_stage *stage, const face *f, int64_t now_ns)
{
    if (stage->is_metered || now_ns - stage->metered_ns < meter_span_ns)
        return;
    stage->is_metered = true;
    stage->metered_ns = now_ns;
    const face_surface judged = face_measure_surface(f);
    stage->min_determinant = judged.min_determinant;
    stage->skin = judged.skin;
    stage->penetration_mm = face_penetration_mm(f);
}

static void describe_face(live_stage *stage, live_view *view, composer *of)
{
    const face *f = composer_face(of);
    float dof[MRT_MAX_DOFS] = {0.0f};
    /* Uses the description of the live scene. The description of the take's face is equal, but it
     * is freed when another take is shown, and the view lives longer. */
    view->about = composer_about(stage->scene->performer->composer);
    view->contact_count = view->about->contact_count < LIVE_CONTACTS_MAX
                              ? view->about->contact_count
                              : LIVE_CONTACTS_MAX;
    for (uint32_t i = 0; i < view->contact_count; ++i)
        view->contact[i] = face_contact_now(f, i + 1);
    view->meter = *face_metered(f);
    bones_unlimit(dof, face_bones(f), view->meter.dof);
    bones_pose(view->bone, face_bones(f), dof);
    view->pull = *composer_pull(of);
    view->is_anchored = composer_is_anchored(of);
    view->solver = composer_solver(of);
    view->min_determinant = stage->min_determinant;
    view->penetration_mm = stage->penetration_mm;
    view->skin = stage->skin;
}

static void describe_stage(live_stage *stage, live_view *view)
{
    const mrt_frame *frame = &stage->scene->performer->voice[0].layer->frame;
    const transport *motion = live_time_motion(stage);
    memcpy(view->hand, frame->hand, sizeof view->hand);
    memcpy(view->pedal, frame->pedal, sizeof view->pedal);
    view->mode = stage->mode;
    view->sample_ns = stage->sample_ns;
    if (stage->mode == LIVE_PERFORMS || !stage->timeline)
        return;
    int64_t at_ns = sequencer_now_ns(stage->timeline->sequencer);
    bool is_at_end = at_ns == live_time_shown_at(motion, motion->end_ns);
    view->at_ns = at_ns <= 0 ? 0 : is_at_end ? motion->end_ns : at_ns;
    view->is_playing = motion->is_playing;
    if (stage->mode == LIVE_OVERDUBS) {
        view->is_recording_over = overdub_run_is_recording(stage->over);
        view->pass = overdub_run_pass(stage->over);
        view->is_playing = true;
    }
}

/* The displayed hand stays still while no joint moves further than tremble_mm. After a larger
 * movement it follows exactly for hand_moves_ns, so that a slow movement is displayed without
 * steps. */
static const float tremble_mm = 1.5f;
static const int64_t hand_moves_ns = 400 * NS_PER_MS;

static bool has_moved(const mrt_hand *now, const mrt_vec3 from[MRT_JOINTS])
{
    for (int i = 0; i < MRT_JOINTS; ++i) {
        const mrt_vec3 p = now->joint[i], q = from[i];
        const float x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
        if (!(x * x + y * y + z * z <= tremble_mm * tremble_mm))
            return true;
    }
    return false;
}

static bool is_same_hand(live_stage *stage, const mrt_hand *seen, const mrt_hand *now,
                         uint32_t side, int64_t now_ns)
{
    mrt_vec3 *from = stage->hand_from[side];
    if (seen->present != now->present || (seen->time_ns == 0) != (now->time_ns == 0))
        return false;
    if (has_moved(now, from)) {
        memcpy(from, now->joint, sizeof now->joint);
        stage->hand_until_ns[side] = now_ns + hand_moves_ns;
    }
    return now_ns > stage->hand_until_ns[side] ||
           memcmp(seen->joint, now->joint, sizeof now->joint) == 0;
}

#define IS_SAME(member) (memcmp(&a->member, &b->member, sizeof a->member) == 0)
static bool is_same_face(const live_view *a, const live_view *b)
{
    return a->about == b->about && a->contact_count == b->contact_count &&
           memcmp(a->contact, b->contact, a->contact_count * sizeof *a->contact) == 0 &&
           IS_SAME(bone) && IS_SAME(pull) && a->is_anchored == b->is_anchored && IS_SAME(solver) &&
           IS_SAME(meter) && IS_SAME(min_determinant) && IS_SAME(penetration_mm) && IS_SAME(skin);
}

static bool is_same_stage(const live_view *a, const live_view *b)
{
    return a->mode == b->mode && IS_SAME(pedal) && a->at_ns == b->at_ns &&
           a->is_playing == b->is_playing && a->is_recording_over == b->is_recording_over &&
           a->pass == b->pass;
}
#undef IS_SAME

/* Returns whether the view equals the view that [main] displays now. */
static bool is_seen(live_stage *stage, const live_view *view, int64_t now_ns)
{
    const live_board *board = &stage->scene->board;
    const live_view *seen = live_board_published(board);
    bool is_same =
        seen && !live_board_is_new(board) && is_same_face(seen, view) && is_same_stage(seen, view);
    for (uint32_t side = 0; seen && side < 2; ++side)
        is_same &= is_same_hand(stage, &seen->hand[side], &view->hand[side], side, now_ns);
    return is_same;
}

/* Of the panel: several phases of a frame are one line there. */
static const live_phase line_of[FRAME_PHASES] = {
    [FRAME_SCHEDULE] = LIVE_PHASE_MAP,      [FRAME_RECORD] = LIVE_PHASE_MAP,
    [FRAME_HANDS] = LIVE_PHASE_MAP,         [FRAME_PATCH] = LIVE_PHASE_MAP,
    [FRAME_MAPPING] = LIVE_PHASE_MAP,       [FRAME_GUARD] = LIVE_PHASE_MAP,
    [FRAME_COMPOSE] = LIVE_PHASE_CONSTRAIN, [FRAME_SOLVE] = LIVE_PHASE_CONSTRAIN,
    [FRAME_DEFORM] = LIVE_PHASE_DEFORM,     [FRAME_PUBLISH] = LIVE_PHASE_PUBLISH};

static void note_frame(live_stage *stage)
{
    live_pulse *now = &stage->now;
    uint32_t at = now->frame_count++ % LIVE_HISTORY;
    double line_ms[LIVE_PHASES] = {0.0}, sum_ms = 0.0;
    for (int i = 0; i < FRAME_PHASES; ++i)
        line_ms[line_of[i]] += (double)stage->frame.took_ns[i] / (double)NS_PER_MS;
    for (int i = 0; i < LIVE_PHASES; ++i) {
        now->phase_ms[i][at] = (float)line_ms[i];
        sum_ms += line_ms[i];
    }
    now->frame_ms[at] = (float)sum_ms;
    memset(stage->frame.took_ns, 0, sizeof stage->frame.took_ns);
}

/* Publishes the face to the outputs. A face of a take gets the host time at which its instant was
 * due. */
static void send_on(live_stage *stage, performer *shown, int64_t now_ns)
{
    int64_t time_ns = stage->sample_ns, take_ns = -1;
    if (!outputs_are_wanted(stage->outputs))
        return;
    if (stage->mode != LIVE_PERFORMS && stage->timeline) {
        const transport *motion = live_time_motion(stage);
        take_ns = sequencer_now_ns(stage->timeline->sequencer);
        double late_ns = (double)(transport_at(motion, now_ns).at_ns - take_ns);
        bool is_late = motion->is_playing && late_ns > 0.0 && late_ns < 1e9;
        time_ns = is_late ? now_ns - (int64_t)(late_ns / motion->speed) : now_ns;
    }
    outputs_publish(stage->outputs, stage->scene->outgoing, shown->composer, time_ns, take_ns);
}

/* The frame's show: NULL where what is seen stays. */
static mrt_result show_face(void *data, stage_frame *f, int64_t time_ns, error *err)
{
    (void)err;
    f->performer = live_time_shown(&((live *)data)->stage, time_ns);
    return MRT_OK;
}

/* The frame's publish. */
static mrt_result publish_face(void *data, const stage_frame *f, error *err)
{
    (void)err;
    live_stage *stage = &((live *)data)->stage;
    composer *shown = f->performer->composer;
    live_board *board = &stage->scene->board;
    int64_t now_ns = stage->drawn_ns;
    bool was_dirty = stage->is_dirty;
    stage->is_dirty = false;
    live_view *view = live_board_fill(board, shown, now_ns);
    stage->is_metered &= !live_board_is_new(board);
    meter(stage, composer_face(shown), now_ns);
    describe_face(stage, view, shown);
    describe_stage(stage, view);
    view->published_ns = stage->published_ns = clock_now_ns();
    if (is_seen(stage, view, now_ns)) {
        memcpy(view->hand, live_board_published(board)->hand, sizeof view->hand);
        live_board_publish_again(board);
    } else {
        live_board_publish(board);
        tell_main(stage);
    }
    if (was_dirty || stage->mode != LIVE_PERFORMS)
        send_on(stage, f->performer, now_ns);
    return MRT_OK;
}

void live_frame_publish(live_stage *stage)
{
    error ignored = {""};
    stage->drawn_ns = clock_now_ns();
    if (frame_draw(&stage->frame, stage->drawn_ns, &ignored) >= 0 && stage->frame.performer)
        note_frame(stage);
}

static void describe_patch(live_pulse *now, const patch_bay *bay)
{
    now->patch_speaks = 0;
    now->is_patch_moving = !patch_bay_is_settled(bay);
    for (uint32_t i = 0; i < PATCH_CONNECTIONS_MAX; ++i)
        now->patch_speaks |= (uint64_t)bay->may_pull[i] << i;
    memcpy(now->patch_pressed, bay->pressed, sizeof now->patch_pressed);
}

void live_frame_pulse(live_stage *stage)
{
    const performer *p = stage->scene->performer;
    live_pulse *now = &stage->now;
    now->counts = *p->counts;
    now->rezeros = *hands_rezeros(p->voice[0].layer->hands);
    describe_patch(now, &stage->scene->performer->voice[0].layer->bay);
    now->mode = stage->mode;
    if (!stage->timeline || live_time_is_here(stage))
        now->kept_bytes = stage->timeline ? sequencer_kept_bytes(stage->timeline->sequencer) : 0;
    now->take = stage->recorder ? recorder_take(stage->recorder) : 0;
    now->code = stage->recorder ? recorder_latest_code(stage->recorder) : (recorder_code){0};
    stage->pulse[slot_back(&stage->pulse_slot)] = *now;
    slot_publish(&stage->pulse_slot);
}

static bool is_moving(const live_stage *stage)
{
    bool is_timed = stage->mode != LIVE_PERFORMS && live_time_motion(stage)->is_playing;
    return is_timed || stage->mode == LIVE_OVERDUBS || live_board_is_easing(&stage->scene->board);
}

static mrt_result on_draw(void *data, int64_t time_ns, error *err)
{
    (void)time_ns, (void)err;
    live *self = data;
    live_stage *stage = &self->stage;
    stage->is_dirty |= outputs_pop_request(stage->outputs);
    if (stage->is_dirty || is_moving(stage))
        live_frame_publish(stage);
    live_time_send(stage, clock_now_ns());
    live_frame_pulse(stage);
    return MRT_OK;
}

/* ---- between steps ---- */

static bool on_between(void *data)
{
    live *self = data;
    live_stage *stage = &self->stage;
    run_command(self);
    if (slot_receive(&stage->motion_slot))
        stage->has_pending_seek = stage->is_dirty = true;
    /* A face that [main] has not read is also replaced (after least_apart_ns), so that [main]
     * always reads a new one. */
    int64_t now_ns = clock_now_ns();
    return live_time_may_show(stage, now_ns) && stage->is_dirty &&
           (live_board_is_taken(&stage->scene->board) ||
            now_ns - stage->published_ns >= least_apart_ns);
}

static void *run(void *data)
{
    live *self = data;
    error err = {""};
    while (!atomic_load(&self->stop))
        if (player_run_live(self->stage.loop, &err) < 0)
            log_push(self->stage.log, MRT_LOG_ERROR, "stage", err.text);
    return NULL;
}

mrt_result live_frame_start(live *self, error *err)
{
    const player_settings settings = {.fps = self->settings.fps > 0.0 ? self->settings.fps : 60.0,
                                      .stop = &self->stop};
    const player_events events = {
        .incident = on_incident, .between = on_between, .draw = on_draw, .data = self};
    self->stage.frame = (stage_frame){.self = self,
                                      .record = record_step,
                                      .performed = note_step,
                                      .show = show_face,
                                      .publish = publish_face,
                                      .now_ns = clock_now_ns};
    return player_create(&self->stage.loop, &self->stage.frame, &settings, &events, err);
}

void live_frame_stop(live *self)
{
    if (self->has_thread) {
        atomic_store(&self->stop, true);
        wake_signal(player_wake(self->stage.loop));
        pthread_join(self->thread, NULL);
    }
    self->has_thread = false;
}

mrt_result live_frame_run(live *self, error *err)
{
    if (pthread_create(&self->thread, NULL, run, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "cannot create the frame thread");
    self->has_thread = true;
    return MRT_OK;
}
