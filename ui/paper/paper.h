/* paper/paper.h - `marotte paper`: what its sections share. Each measures or draws its own part,
 * adds it to the page, and tells its figures. [main] */
#ifndef MAROTTE_UI_PAPER_PAPER_H
#define MAROTTE_UI_PAPER_PAPER_H
#include "cli/facts.h"
#include "paper/page.h"
#include "cli/terminal.h"

#include <limits.h>

enum { PAPER_FILES_MAX = 32, PAPER_NAME = 64 };

typedef struct paper {
    bool is_quick;
    page *page;
    facts *told; /* as JSON: the page's figures, for paper.json and --json */
    progress shown;
    char folder[PATH_MAX];    /* where the page will be, ends in '/' */
    char meanwhile[PATH_MAX]; /* where it is written until it is whole, ends in '/'; "" none */
    bool was_made;            /* the folder is ours to remove */
    char file[PAPER_FILES_MAX][PAPER_NAME]; /* of the page, in the order in which they come */
    uint32_t file_count;
    /* Who draws: "software (llvmpipe ...)"; "": nobody, and no_drawing says why. */
    char drawn_by[160];
    error no_drawing;
    double worst_pairs_off; /* share: of the counted pairs, beside those of the paper */
} paper;

/* Where a file of the page is written until the page is whole. */
CHECKED mrt_result paper_add_file(paper *self, char out_path[PATH_MAX], const char *name,
                                  error *err);
/* False: somebody wants it to end. For between two parts. */
CHECKED mrt_result paper_check_stop(error *err);

/* "39 195", with thin spaces. */
void paper_count(char out[32], double value);

/* ---- the sections, in the order of the page ---- */

CHECKED mrt_result paper_hands(paper *self, error *err);  /* Figures 1 and 2 */
CHECKED mrt_result paper_table(paper *self, error *err);  /* Table 1 and Figure 3 */
CHECKED mrt_result paper_moai(paper *self, error *err);   /* Figures 4 and 5 */
CHECKED mrt_result paper_solver(paper *self, error *err); /* its claims, and the reference */

#endif
