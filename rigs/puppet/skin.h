/* rigs/puppet/skin.h - the skin: neck, head, sockets, nose and mouth as one surface of quads whose
 * rows run around eyes, nose and lips. [main] */
#ifndef MAROTTE_RIGS_PUPPET_SKIN_H
#define MAROTTE_RIGS_PUPPET_SKIN_H
#include "sheet.h"

CHECKED mrt_result skin_build(sheet *s, error *err);

#endif
