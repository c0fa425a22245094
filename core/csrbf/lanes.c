#include "csrbf/lanes.h"

#include <stddef.h>

#define LANES_TABLE(variant)                                                                       \
    LANES_DECLARE(variant);                                                                        \
    static const lanes table_##variant = {                                                         \
        .columns_sum = LANES_OF(columns_sum, variant),                                             \
        .columns_add = LANES_OF(columns_add, variant),                                             \
        .columns_move = LANES_OF(columns_move, variant),                                           \
        .is_zero = LANES_OF(is_zero, variant),                                                     \
        .add_weighted = LANES_OF(add_weighted, variant),                                           \
        .field_block = LANES_OF(field_block, variant),                                             \
        .gradient_block = LANES_OF(gradient_block, variant),                                       \
        .determinants = LANES_OF(determinants, variant),                                           \
        .squares = LANES_OF(squares, variant),                                                     \
        .responses_block = LANES_OF(responses_block, variant),                                     \
        .first_neighbour = LANES_OF(first_neighbour, variant),                                     \
        .kernel_row = LANES_OF(kernel_row, variant),                                               \
        .factor = LANES_OF(factor, variant),                                                       \
        .solve_few = LANES_OF(solve_few, variant),                                                 \
        .solve_many = LANES_OF(solve_many, variant),                                               \
    }

LANES_TABLE(generic);
#ifdef MAROTTE_LANES_X86
LANES_TABLE(v2);
LANES_TABLE(v3);
LANES_TABLE(v4);
static const lanes *const tables[ISA_COUNT] = {&table_generic, &table_v2, &table_v3, &table_v4};
#else
static const lanes *const tables[ISA_COUNT] = {&table_generic};
#endif

const lanes *lanes_of(isa which)
{
    return (unsigned)which < ISA_COUNT && isa_is_here(which) ? tables[which] : NULL;
}

const lanes *lanes_now(void)
{
    const lanes *found = lanes_of(isa_now());
    return found ? found : &table_generic;
}
