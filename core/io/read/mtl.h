/* io/read/mtl.h - reads the material files of an OBJ: the look of its materials, and their
 * pictures. Does not cover the text of the OBJ (obj.c) and decoding (mesh_images.h). [main] */
#ifndef MAROTTE_IO_MTL_H
#define MAROTTE_IO_MTL_H
#include "base/text.h"
#include "mesh/mesh.h"

typedef enum mtl_use { MTL_BASE = 0, MTL_CLEAR, MTL_EMISSION, MTL_NORMAL, MTL_USES } mtl_use;

typedef struct mtl_map { /* a picture that has not been read yet */
    char *file;          /* relative to the folder of the OBJ; NULL: none */
    mesh_texture placed; /* image 0 */
    float amount;        /* -bm */
} mtl_map;

typedef struct mtl_material {
    char *name;         /* printable */
    mesh_material look; /* without name and pictures */
    mtl_map map[MTL_USES];
    bool says_opacity; /* set by d, which has priority over Tr */
    size_t order;      /* reading order: of two materials with one name the later one is used */
} mtl_material;

enum { MTL_FILES_MAX = 16 };

typedef struct mtl_library {
    mtl_material *material;
    size_t count, capacity;
    char *file[MTL_FILES_MAX]; /* files that were read, relative to the folder of the OBJ */
    uint32_t file_count;
    size_t malformed_count; /* unreadable lines; the number of the first one follows */
    uint64_t malformed_line;
} mtl_library;

/* Appends the materials of one file. `folder`: that of the file, relative to the OBJ, "" or with
 * its last '/'. Invalid lines are counted. Unused statements are skipped. */
CHECKED mrt_result mtl_parse(mtl_library *library, const void *data, size_t size,
                             const char *folder, error *err);
/* Appends the files of an mtllib statement of an OBJ in `directory` (as in obj_parse): one file, or
 * several. */
CHECKED mrt_result mtl_read(mtl_library *library, text_view names, const char *directory,
                            error *err);
void mtl_library_finish(mtl_library *library); /* accepts zeroed */

/* Applies the library's looks to the materials of a mesh by name. If the mesh has texture
 * coordinates, also adds their pictures, still encoded, within the budget of an OBJ of obj_size
 * bytes. Missing materials are unchanged, and noted. Returns the number of materials whose pictures
 * need texture coordinates that the mesh lacks. */
uint32_t mtl_apply(mesh *m, mtl_library *library, const char *directory, size_t obj_size);

#endif
