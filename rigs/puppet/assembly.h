/* rigs/puppet/assembly.h - the half sheet with its mirror image as a mesh with parts, materials and
 * the attributes _SKULL and _JAW. [main] */
#ifndef MAROTTE_RIGS_PUPPET_ASSEMBLY_H
#define MAROTTE_RIGS_PUPPET_ASSEMBLY_H
#include "mesh/mesh.h"
#include "sheet.h"

CHECKED mrt_result assembly_build(mesh *out, const sheet *half, error *err);

#endif
