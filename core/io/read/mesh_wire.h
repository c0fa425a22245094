/* io/mesh_wire.h - what marotte-meshload says to the program that started it: a mesh without parts,
 * or why there is none. The reader trusts nothing in it. Native byte order: one machine. [main] */
#ifndef MAROTTE_IO_MESH_WIRE_H
#define MAROTTE_IO_MESH_WIRE_H
#include "mesh/mesh.h"

#include <stdio.h>

/* Errors are left in the stream. */
void mesh_wire_write(FILE *stream, const mesh *m);
void mesh_wire_write_failure(FILE *stream, const char *text);

/* A failure that was written comes back as one. */
CHECKED mrt_result mesh_wire_parse(mesh *out, const void *data, size_t size, error *err);

#endif
