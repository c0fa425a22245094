/* The implementation of tinygltf, alone: it takes 20 s to compile. */
#include <fstream> /* 2.7.0 with TINYGLTF_NO_FS does not include it */
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
