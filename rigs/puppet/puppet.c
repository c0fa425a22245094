/* rigs/puppet/puppet.c - generate_puppet: writes puppet.glb, a puppet's head made for performing,
 * exactly symmetric in x, the same bytes on every run. */
#include "assembly.h"
#include "eyes.h"
#include "felt.h"
#include "io/export.h"
#include "skin.h"
#include "teeth.h"

#include <stdio.h>

enum { CAPACITY = 16384 };

static mrt_result sew(sheet *half, error *err)
{
    mrt_result result = skin_build(half, err);
    if (result < 0)
        return result;
    teeth_build(half);
    teeth_build_tongue(half);
    eyes_build(half);
    felt_build_brow(half);
    felt_build_ear(half);
    felt_build_hair(half);
    if (half->is_full)
        return error_set(err, MRT_ERR_ARGUMENT, "the half puppet has more than %d points or quads",
                         CAPACITY);
    return MRT_OK;
}

static mrt_result generate(const char *path, error *err)
{
    sheet half;
    mesh whole;
    mrt_result result = sheet_create(&half, CAPACITY, err);
    if (result < 0)
        return result;
    result = sew(&half, err);
    if (result >= 0)
        result = assembly_build(&whole, &half, err);
    sheet_destroy(&half);
    if (result < 0)
        return result;
    result = gltf_write_mesh(path, &whole, err);
    mesh_destroy(&whole);
    return result;
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        (void)fputs("usage: generate_puppet OUT.glb\n", stderr);
        return 2;
    }
    error err = {0};
    if (generate(argv[1], &err) < 0) {
        (void)fprintf(stderr, "generate_puppet: %s\n", err.text);
        return 1;
    }
    return 0;
}
