/* paper/paper.h - shared by the sections of `marotte paper`. Each section measures or draws its
 * part, adds it to the page, and reports its figures. [main] */
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
    facts *told; /* figures of the page as JSON, for paper.json and --json */
    progress shown;
    char folder[PATH_MAX];    /* final folder of the page, ends with '/' */
    char meanwhile[PATH_MAX]; /* temporary folder until the page is complete, ends with '/'; "":
                                 none */
    bool was_made;            /* we created the folder, and may remove it */
    char file[PAPER_FILES_MAX][PAPER_NAME]; /* names of the files of the page, in order */
    uint32_t file_count;
    /* Name of the renderer: "software (llvmpipe ...)". "": drawing is not possible, for the reason
     * in no_drawing. */
    char drawn_by[160];
    error no_drawing;
    double worst_pairs_off; /* greatest difference of the counted pairs from those of the paper, as
                               a share */
} paper;

/* Adds a file to the page. Returns the path to write to until the page is complete. */
CHECKED mrt_result paper_add_file(paper *self, char out_path[PATH_MAX], const char *name,
                                  error *err);
/* Returns < 0 if the user wants to stop. Call it between two parts. */
CHECKED mrt_result paper_check_stop(error *err);

/* Writes "39 195", with thin spaces. */
void paper_count(char out[32], double value);

/* ---- the sections, in the order of the page ---- */

CHECKED mrt_result paper_hands(paper *self, error *err);  /* Figures 1 and 2 */
CHECKED mrt_result paper_table(paper *self, error *err);  /* Table 1 and Figure 3 */
CHECKED mrt_result paper_moai(paper *self, error *err);   /* Figures 4 and 5 */
CHECKED mrt_result paper_solver(paper *self, error *err); /* claims, and the reference solve */

#endif
