/* ui/rigfit.h - `marotte rig fit`. argv[0] is "fit". [main] */
#ifndef MAROTTE_UI_RIGFIT_H
#define MAROTTE_UI_RIGFIT_H
#include "command.h"

int rigfit_run(int argc, char **argv);

#endif
