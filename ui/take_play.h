/* take_play.h - the subcommands that perform takes, or read what was recorded: a file each;
 * take_play.c has their table. [main] */
#ifndef MAROTTE_UI_TAKE_PLAY_H
#define MAROTTE_UI_TAKE_PLAY_H
#include "take.h"

CHECKED mrt_result take_check_run(take_call *call, error *err);
CHECKED mrt_result take_diff_run(take_call *call, error *err);
CHECKED mrt_result take_export_run(take_call *call, error *err);
CHECKED mrt_result take_record_run(take_call *call, error *err);
CHECKED mrt_result take_log_run(take_call *call, error *err);
CHECKED mrt_result take_remap_run(take_call *call, error *err);
CHECKED mrt_result take_show_run(take_call *call, error *err);

/* How far apart two takes move the face, by regions, and when most. */
CHECKED mrt_result take_diff_tell(take_call *call, const char *a, const char *b, error *err);

#endif
