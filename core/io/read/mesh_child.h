/* io/read/mesh_child.h - reads a mesh file in another process, marotte-meshload, which may crash,
 * hang or use up its memory without harm. The decoders of decode_run (io/decode/decode.h) run there
 * too. The program is found in $MAROTTE_MESHLOAD, beside the running program, or in the build
 * folder. [main], waits up to 20 s. */
#ifndef MAROTTE_IO_MESH_CHILD_H
#define MAROTTE_IO_MESH_CHILD_H
#include "mesh/mesh.h"

#include <stdio.h>

CHECKED mrt_result mesh_child_read(mesh *out, const char *path, error *err);

/* Argument that selects decoding of jobs. A file with this name is passed as ./--decode. */
#define MESH_CHILD_DECODE "--decode"

/* ---- the output of marotte-meshload: a mesh without parts, or an error ---- */

/* The reader validates all of it. Native byte order: both processes run on one machine. */
/* Write errors stay in the stream; the caller checks it. */
void mesh_wire_write(FILE *stream, const mesh *m);
void mesh_wire_write_failure(FILE *stream, const char *text);

/* Parses the output. A written failure is returned as an error. */
CHECKED mrt_result mesh_wire_parse(mesh *out, const void *data, size_t size, error *err);

#endif
