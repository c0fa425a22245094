#include "stage/perform/frame.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int64_t start_clock(const stage_frame *f)
{
    return f->now_ns ? f->now_ns() : 0;
}

static void end_phase(stage_frame *f, frame_phase phase, int64_t *since_ns)
{
    if (!f->now_ns)
        return;
    int64_t now_ns = f->now_ns();
    f->took_ns[phase] += now_ns - *since_ns;
    *since_ns = now_ns;
}

static void count_fault(performer *p, const char *source, const char *fault)
{
    p->counts->bad_pulls += 1;
    if (!p->counts->first_problem.text[0])
        error_set(&p->counts->first_problem, MRT_ERR_FORMAT, "%s gave %s", source, fault);
}

/* ---- phase 3, hands ---- */

/* A step that is older than the last one counts as simultaneous. */
static void pass_time(layer *of, int64_t time_ns)
{
    static const double dt_max_s = 0.1;
    if (of->has_time && time_ns < of->frame.time_ns)
        time_ns = of->frame.time_ns;
    uint64_t since_ns =
        (uint64_t)time_ns -
        (uint64_t)of->frame.time_ns; /* unsigned: the times of a recording may be arbitrary */
    double dt_s = of->has_time ? (double)since_ns / (double)NS_PER_S : 0.0;
    of->frame.dt_s = fmin(dt_s, dt_max_s);
    of->frame.time_ns = time_ns;
    of->has_time = true;
}

static void read_pointer(performer *p, layer *of, const sample_step *s)
{
    pointer_grip before = of->pointer.grip;
    (void)pointer_read(&of->pointer, of->about, s, of->frame.time_ns);
    of->resets |= of->pointer.grip == POINTER_NEUTRAL && before != POINTER_NEUTRAL;
    const char *fault = guard_fault(&of->guard, &of->pointer.pull);
    if (!fault)
        fault = guard_fault(&of->guard, &of->pointer.places);
    if (!fault)
        return;
    count_fault(p, "the pointer", fault);
    pointer_reset(&of->pointer);
}

/* ---- phase 4, patch ---- */

static void report_params(layer *of, int64_t time_ns)
{
    const mrt_plugin_type *type = of->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = of->mapping->params[i];
        if (memcmp(&value, &of->room->last_params[i], sizeof value) == 0)
            continue;
        of->room->last_params[i] = value;
        if (of->on_param)
            of->on_param(of->on_param_data, time_ns, type->params[i].id, value);
    }
}

/* ---- phase 5, mapping ---- */

static mrt_result run_mapping(layer *of)
{
    if (layer_is_answered(of))
        return answers_pop(of->answers, of->frame.time_ns, &of->pull);
    if (of->takeover && !layer_is_fading(of) &&
        of->takeover->take_over(of->mapping->self, &of->pull))
        layer_crossfade(of);
    mrt_result result = of->functions->process(of->mapping->self, &of->frame, &of->pull);
    if (of->answers)
        answers_add(of->answers, of->frame.time_ns, result, &of->pull);
    return result;
}

/* ---- phase 6, guard ---- */

static void accept_pull(performer *p, layer *of, mrt_result answer)
{
    char source[96];
    if (answer == MRT_HOLD) {
        layer_keep_good(of);
        return;
    }
    const char *fault = answer < 0 ? "an error" : guard_fault(&of->guard, &of->pull);
    if (!fault) {
        layer_use_pull(of);
        return;
    }
    (void)snprintf(source, sizeof source, "mapping %s", of->mapping->type->id);
    count_fault(p, source, fault);
    layer_keep_good(of);
}

/* ---- phases 7 and 8 ---- */

/* fresh: the voice whose mapping performed in this step; PERFORMER_NO_VOICE: none. dt_s: since its
 * last step. */
static void move_face(stage_frame *f, uint32_t fresh, double dt_s, int64_t *at_ns)
{
    performer *p = f->performer;
    performer_parts parts;
    if (f->is_pull_only)
        return;

    /* 7. Compose: collect the pulls of all voices, including patches, pointers, palettes, life and
     * pulls that fade out. */
    performer_compose(p, fresh, f->step.due_ns, &parts);
    end_phase(f, FRAME_COMPOSE, at_ns);

    /* 8. Solve: all parts are joined in one engagement, or drag the shape one after the other. */
    composer_swing_begin(p->composer, f->step.due_ns);
    composer_move(p->composer, parts.part, parts.count, dt_s);
    composer_swing(p->composer, f->step.due_ns);
    end_phase(f, FRAME_SOLVE, at_ns);

    if (f->performed)
        f->performed(f->self, f);
}

/* Whether no sample of the step is for hands, patch or mapping. Then these do not notice it. */
static bool is_without_hands(const sample_step *s)
{
    bool is_without = s->count > 0;
    for (uint32_t i = 0; i < s->count; ++i)
        is_without &= palette_is_route(s->of[i].route) || life_is_route(s->of[i].route);
    return is_without;
}

/* ---- a step, from its samples to the fields of the face ---- */

mrt_result frame_step(stage_frame *f, error *err)
{
    sample_step *s = &f->step;
    int64_t at_ns = start_clock(f);

    /* 1. Schedule: the samples leave their sources and get the time of the step. */
    if (f->sources)
        scheduler_consume(f->sources, s);
    end_phase(f, FRAME_SCHEDULE, &at_ns);

    /* 2. Record the samples before any other phase reads them. */
    mrt_result result = f->record ? f->record(f->self, f, err) : MRT_OK;
    end_phase(f, FRAME_RECORD, &at_ns);
    if (result != MRT_OK)
        return result < 0 ? result : MRT_OK;

    performer *p = f->performer;
    layer *of = p->voice[s->voice].layer;
    mrt_frame *in = &of->frame;
    p->counts->samples += s->count;
    p->counts->steps += 1;
    (void)palette_read(&of->palette, &of->guard, s);
    (void)life_read(&of->life, &of->guard, s);
    if (is_without_hands(s)) {
        move_face(f, PERFORMER_NO_VOICE, 0.0, &at_ns);
        return MRT_OK;
    }

    /* 3. Hands: calibrate, filter and pose the samples. Read the pointer: the mouse on the face
     * pulls too. */
    in->near = composer_is_near(p->composer, layer_pull(of));
    pass_time(of, s->time_ns);
    hands_read(of->hands, s, in);
    frame_inputs_read(&of->inputs, s, in->time_ns);
    in->inputs = of->inputs.shown;
    in->input_count = of->inputs.count;
    read_pointer(p, of, s);
    layer_advance(of);
    end_phase(f, FRAME_HANDS, &at_ns);

    /* 4. Patch: channels become parameters here. The pulls of the patch join in phase 7. */
    instance_latch(of->mapping);
    report_params(of, s->time_ns);
    patch_bay_step(&of->bay, in, of->mapping->type, of->mapping->params, &of->good);
    in->params = of->mapping->params;
    if (of->bay.plan) {
        patch_bay_params(&of->bay, of->mapping->params, of->room->patched_params);
        in->params = of->room->patched_params;
    }
    end_phase(f, FRAME_PATCH, &at_ns);

    /* 5. Mapping: the plugin turns hands into a pull: control vectors, degrees of freedom. */
    mrt_result answer = run_mapping(of);
    end_phase(f, FRAME_MAPPING, &at_ns);

    /* 6. Guard: an invalid pull is dropped, and the last valid one is kept. */
    accept_pull(p, of, answer);
    end_phase(f, FRAME_GUARD, &at_ns);
    move_face(f, s->voice, in->dt_s, &at_ns);
    return MRT_OK;
}

void frame_recompose(performer *p, int64_t now_ns)
{
    performer_parts parts;
    performer_compose(p, PERFORMER_NO_VOICE, now_ns, &parts);
    composer_move(p->composer, parts.part, parts.count, 0.0);
}

/* ---- a drawn frame, from the fields of the face to its sinks ---- */

mrt_result frame_draw(stage_frame *f, int64_t time_ns, error *err)
{
    int64_t at_ns = start_clock(f);

    /* 9. Deform: compute positions within the limits of the skin, collisions and normals. */
    mrt_result result = f->show ? f->show(f->self, f, time_ns, err) : MRT_OK;
    if (result < 0 || !f->performer)
        return result;
    composer_draw(f->performer->composer);
    end_phase(f, FRAME_DEFORM, &at_ns);

    /* 10. Publish: send the newest face to its sinks, which never wait for each other. */
    mrt_result published = f->publish ? f->publish(f->self, f, err) : MRT_OK;
    end_phase(f, FRAME_PUBLISH, &at_ns);
    return published < 0 ? published : result;
}
