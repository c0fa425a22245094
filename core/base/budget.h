/* base/budget.h - limits on memory and work for one opened file. A file from an untrusted source
 * must not stall the program: its reader spends a budget that grows with the size of the file, and
 * fails with an error when the budget is used up. budget.c has the limits for all kinds of files.
 * Leaves out limits of a format itself (nesting, lengths of names). Pure; a budget belongs to one
 * thread. */
#ifndef MAROTTE_BASE_BUDGET_H
#define MAROTTE_BASE_BUDGET_H
#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef enum budget_kind {
    BUDGET_SHOW = 0,  /* playing, listing or comparing a show: takes, samples, checkpoints */
    BUDGET_SALVAGE,   /* recovering a damaged show: examined pages and cells */
    BUDGET_RIG,       /* a rig with all included files */
    BUDGET_SELECTORS, /* the regions of a rig on a mesh; the size is that of the mesh */
    BUDGET_MESH,
    BUDGET_IMAGE,
    BUDGET_KINDS
} budget_kind;

typedef struct budget {
    budget_kind kind;
    uint64_t file_size;             /* bytes */
    uint64_t bytes_left, work_left; /* one step of work is about ten nanoseconds */
} budget;

/* file_size: size of the file and of the files that belong to it. */
budget budget_of(budget_kind kind, uint64_t file_size);

/* Subtract from the budget. If too little is left, subtract nothing and return MRT_ERR_UNSUPPORTED.
 * The error names the resource, the limit and the reason. */
CHECKED mrt_result budget_spend_bytes(budget *b, uint64_t bytes, error *err);
CHECKED mrt_result budget_spend_work(budget *b, uint64_t steps, error *err);

#endif
