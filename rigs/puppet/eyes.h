/* rigs/puppet/eyes.h - the left ball with iris and pupil, and its lids: shells around it that turn
 * about the line through its middle along x. [main] */
#ifndef MAROTTE_RIGS_PUPPET_EYES_H
#define MAROTTE_RIGS_PUPPET_EYES_H
#include "sheet.h"

void eyes_build(sheet *s);

#endif
