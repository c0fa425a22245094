/* ui/stage.h - `marotte` alone, or with a show: the stage. [main] */
#ifndef MAROTTE_UI_STAGE_H
#define MAROTTE_UI_STAGE_H
#include "command.h"

extern const command command_stage;

/* Whether the first argument is a show or an option of the stage, and no command. */
bool stage_is_meant(const char *first);

#endif
