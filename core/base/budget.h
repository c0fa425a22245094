/* base/budget.h - how much memory and how much work one opened file may cost. A file that
 * somebody else made is only data: what it asks for is paid out of a budget that grows with the
 * file's size, and whoever reads it stops, and says so, when the budget is used up. The figures of
 * every kind of file stand in budget.c and nowhere else. Leaves out limits that a format itself has
 * (nesting, lengths of names). Pure; a budget belongs to one thread. */
#ifndef MAROTTE_BASE_BUDGET_H
#define MAROTTE_BASE_BUDGET_H
#include "base/error.h"

#include <stddef.h>
#include <stdint.h>

typedef enum budget_kind {
    BUDGET_SHOW = 0,  /* a show as it is played, listed, compared: takes, samples, checkpoints */
    BUDGET_SALVAGE,   /* a damaged show: pages and cells that are looked at */
    BUDGET_RIG,       /* a rig with all that it includes */
    BUDGET_SELECTORS, /* a rig's regions on a mesh; the size is the mesh's */
    BUDGET_MESH,
    BUDGET_IMAGE,
    BUDGET_KINDS
} budget_kind;

typedef struct budget {
    budget_kind kind;
    uint64_t file_size;             /* bytes */
    uint64_t bytes_left, work_left; /* work: steps of about ten nanoseconds */
} budget;

/* file_size: of the file, and of the files that belong to it. */
budget budget_of(budget_kind kind, uint64_t file_size);

/* Takes from what is left. When it does not suffice, nothing is taken and the answer is
 * MRT_ERR_UNSUPPORTED with one sentence: what is too much, how much is allowed, why. */
CHECKED mrt_result budget_spend_bytes(budget *b, uint64_t bytes, error *err);
CHECKED mrt_result budget_spend_work(budget *b, uint64_t steps, error *err);

#endif
