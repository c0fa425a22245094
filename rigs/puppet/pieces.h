/* rigs/puppet/pieces.h - what is no skin: two rows of teeth in their gums, the tongue; the left
 * ball with iris and pupil, and its lids with their lashes, shells around it that turn about the
 * line through its middle along x; what is sewn on: the left brow and ear, the tuft of hair, the
 * collar. [main] */
#ifndef MAROTTE_RIGS_PUPPET_PIECES_H
#define MAROTTE_RIGS_PUPPET_PIECES_H
#include "sheet.h"

/* Ears and hair are open where they sit on the skin. */
void pieces_build(sheet *s);

#endif
