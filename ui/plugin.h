/* ui/plugin.h - the parts of `marotte plugin`, one file each. argv[0] is the part's name. [main] */
#ifndef MAROTTE_UI_PLUGIN_H
#define MAROTTE_UI_PLUGIN_H
#include "command.h"

int plugin_list_run(int argc, char **argv);
int plugin_new_run(int argc, char **argv);
int plugin_check_run(int argc, char **argv);

#endif
