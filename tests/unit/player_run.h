/* unit/player_run.h - inputs performed by one performer, one mapping on one face, until they end.
 */
#ifndef MAROTTE_TESTS_PLAYER_RUN_H
#define MAROTTE_TESTS_PLAYER_RUN_H
#include "stage/perform/player.h"

static inline mrt_result player_run_step(void *self, const sample_step *s, error *err)
{
    (void)err;
    performer_step(self, s);
    return MRT_OK;
}

static inline mrt_result player_run_draw(void *self, int64_t time_ns, error *err)
{
    (void)time_ns;
    (void)err;
    performer_draw(self);
    return MRT_OK;
}

static inline mrt_result player_run(performer *p, input *const *inputs, uint32_t input_count,
                                    const player_settings *settings, const player_events *events,
                                    player_report *out_report, error *err)
{
    const player_stage stage = {p, player_run_step, player_run_draw};
    return player_run_stage(&stage, inputs, input_count, settings, events, out_report, err);
}

#endif
