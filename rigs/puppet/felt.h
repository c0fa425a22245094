/* rigs/puppet/felt.h - what is sewn onto the head: the left brow and ear, and the tuft of hair. */
#ifndef MAROTTE_RIGS_PUPPET_FELT_H
#define MAROTTE_RIGS_PUPPET_FELT_H
#include "sheet.h"

void felt_build_brow(sheet *s);
/* Both are open where they sit on the skin. */
void felt_build_ear(sheet *s);
void felt_build_hair(sheet *s);

#endif
