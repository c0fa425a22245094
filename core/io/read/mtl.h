/* io/read/mtl.h - the material files of an OBJ: how its materials look, and which pictures lie on
 * them. Leaves out the OBJ's own text (obj.c) and decoding (mesh_images.h). [main] */
#ifndef MAROTTE_IO_MTL_H
#define MAROTTE_IO_MTL_H
#include "base/text.h"
#include "mesh/mesh.h"

typedef enum mtl_use { MTL_BASE = 0, MTL_CLEAR, MTL_EMISSION, MTL_NORMAL, MTL_USES } mtl_use;

typedef struct mtl_map { /* a picture, before anybody looked for it */
    char *file;          /* from the folder of the OBJ; NULL: none */
    mesh_texture placed; /* image 0 */
    float amount;        /* -bm */
} mtl_map;

typedef struct mtl_material {
    char *name;         /* printable */
    mesh_material look; /* without name and pictures */
    mtl_map map[MTL_USES];
    bool says_opacity; /* by d, which is clearer than Tr */
    size_t order;      /* in which it was read: of two of one name the later is meant */
} mtl_material;

enum { MTL_FILES_MAX = 16 };

typedef struct mtl_library {
    mtl_material *material;
    size_t count, capacity;
    char *file[MTL_FILES_MAX]; /* what was read, from the folder of the OBJ */
    uint32_t file_count;
    size_t malformed_count; /* lines that say nothing that can be read; of the first: */
    uint64_t malformed_line;
} mtl_library;

/* Appends the materials of one file. `folder`: of the file, seen from the OBJ's, "" or with its
 * last '/'. Lines that make no sense are counted, statements that are not needed passed over. */
CHECKED mrt_result mtl_parse(mtl_library *library, const void *data, size_t size,
                             const char *folder, error *err);
/* Appends what an mtllib statement of an OBJ in `directory` (as of obj_parse) names: a file, or
 * several. */
CHECKED mrt_result mtl_read(mtl_library *library, text_view names, const char *directory,
                            error *err);
void mtl_library_finish(mtl_library *library); /* accepts zeroed */

/* Gives the materials of a mesh the looks that the library has for their names, and, if it has
 * texture coordinates, the pictures on them, still encoded, in the budget of an OBJ of so many
 * bytes. What is missing stays as it was, and is noted. Returns how many materials have pictures
 * that have no place on it. */
uint32_t mtl_apply(mesh *m, mtl_library *library, const char *directory, size_t obj_size);

#endif
