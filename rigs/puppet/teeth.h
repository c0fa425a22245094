/* rigs/puppet/teeth.h - what is in the mouth: two rows of teeth in their gums, and the tongue. */
#ifndef MAROTTE_RIGS_PUPPET_TEETH_H
#define MAROTTE_RIGS_PUPPET_TEETH_H
#include "sheet.h"

void teeth_build(sheet *s);
void teeth_build_tongue(sheet *s);

#endif
