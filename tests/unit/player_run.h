/* unit/player_run.h - inputs performed by one performer, one mapping on one face, until they end.
 */
#ifndef MAROTTE_TESTS_PLAYER_RUN_H
#define MAROTTE_TESTS_PLAYER_RUN_H
#include "stage/perform/player.h"

static inline mrt_result player_run(performer *p, input *const *inputs, uint32_t input_count,
                                    const player_settings *settings, const player_events *events,
                                    player_report *out_report, error *err)
{
    stage_frame f = {.performer = p};
    return player_run_stage(&f, inputs, input_count, settings, events, out_report, err);
}

#endif
