/* io/read/gltf_material.hpp - the materials of a glTF file: textures, VRM's toon shading, and their
 * pictures, still encoded. Private to the glTF reader. Failures are gltf_failure, but a missing
 * picture is only noted. */
#ifndef MAROTTE_IO_GLTF_MATERIAL_HPP
#define MAROTTE_IO_GLTF_MATERIAL_HPP
#include "io/read/gltf_load.hpp"

extern "C" {
#include "mesh/mesh.h"
}

/* Replaces out's materials; with_default: mesh_create's grey one follows the file's. Pictures are
 * read only for materials in `is_used`. `directory`: as in gltf_parse. `file_size` limits the
 * memory for pictures. */
void gltf_materials(mesh &out, const gltf_document &document, const std::vector<bool> &is_used,
                    bool with_default, const char *directory, size_t file_size);

/* Returns n of the TEXCOORD_n of the material's textures. */
int gltf_material_uv_set(const tinygltf::Model &model, int material);

/* Returns a printable copy of a name, which mesh_destroy frees. */
char *gltf_clean_name(const std::string &name);

#endif
