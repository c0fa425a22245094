#include "base/budget.h"

#include <inttypes.h>

typedef struct allowance { /* fixed part, and part per byte of the file */
    uint64_t floor, per_byte;
} allowance;

static const struct {
    const char *name;
    allowance bytes, work;
} kinds[BUDGET_KINDS] = {
    /* The fixed parts are large enough for every valid file of any size. A step of work takes about
     * 10 ns: 200 million are 2 s. The selectors of a face are evaluated several times until it is
     * loaded. */
    [BUDGET_SHOW] = {"show", {256u << 20, 20}, {200000000, 100}},
    [BUDGET_SALVAGE] = {"damaged show", {64u << 20, 4}, {200000000, 100}},
    [BUDGET_RIG] = {"rig", {256u << 20, 20}, {200000000, 20}},
    [BUDGET_SELECTORS] = {"rig on a mesh", {64u << 20, 20}, {50000000, 20}},
    [BUDGET_MESH] = {"mesh", {64u << 20, 20}, {200000000, 100}},
    [BUDGET_IMAGE] = {"image", {256u << 20, 20}, {200000000, 100}},
};

static uint64_t allowed(allowance a, uint64_t file_size)
{
    return file_size <= (UINT64_MAX - a.floor) / a.per_byte ? a.floor + a.per_byte * file_size
                                                            : UINT64_MAX;
}

budget budget_of(budget_kind kind, uint64_t file_size)
{
    return (budget){.kind = kind,
                    .file_size = file_size,
                    .bytes_left = allowed(kinds[kind].bytes, file_size),
                    .work_left = allowed(kinds[kind].work, file_size)};
}

static mrt_result spend(const budget *b, uint64_t *left, uint64_t amount, allowance of,
                        const char *what, error *err)
{
    if (amount > *left)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "it needs more than %" PRIu64 " %s, the limit for a %s of %" PRIu64
                         " bytes. The file is damaged, or made to stall the program",
                         allowed(of, b->file_size), what, kinds[b->kind].name, b->file_size);
    *left -= amount;
    return MRT_OK;
}

mrt_result budget_spend_bytes(budget *b, uint64_t bytes, error *err)
{
    return spend(b, &b->bytes_left, bytes, kinds[b->kind].bytes, "bytes of memory", err);
}

mrt_result budget_spend_work(budget *b, uint64_t steps, error *err)
{
    return spend(b, &b->work_left, steps, kinds[b->kind].work, "steps of work", err);
}
