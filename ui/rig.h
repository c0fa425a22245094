/* ui/rig.h - the parts of `marotte rig`, one file each. argv[0] is the part's name. [main] */
#ifndef MAROTTE_UI_RIG_H
#define MAROTTE_UI_RIG_H
#include "command.h"

int rigcheck_run(int argc, char **argv);
int rigfit_run(int argc, char **argv);
int rignew_run(int argc, char **argv);
int rigshow_run(int argc, char **argv);

#endif
