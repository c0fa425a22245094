/* paper/page.h - a page that is written twice with the same contents: as HTML, which follows the
 * reader's light or dark colours and fits a telephone, and as Markdown. Texts are plain, in UTF-8;
 * what stands between ` is code. Leaves out what the page says. [main] */
#ifndef MAROTTE_UI_PAPER_PAGE_H
#define MAROTTE_UI_PAPER_PAGE_H
#include "base/error.h"

typedef struct page page;

page *page_create(const char *title); /* NULL: no memory */
void page_destroy(page *self);        /* NULL is fine */

void page_heading(page *self, const char *text);
void page_subheading(page *self, const char *text);
__attribute__((format(printf, 2, 3))) void page_text(page *self, const char *format, ...);
/* Something to type, on a line of its own. */
void page_command(page *self, const char *command);

/* Columns that are PAGE_NUMBERS stand to the right. head, cell: column_count. */
typedef enum page_column { PAGE_WORDS = 0, PAGE_NUMBERS } page_column;
enum { PAGE_COLUMNS_MAX = 16 };
void page_table(page *self, const char *const *head, const page_column *column,
                uint32_t column_count);
void page_row(page *self, const char *const *cell);
void page_table_end(page *self);

/* A picture that lies beside the page. `what` says in one sentence what is seen, for whoever does
 * not see it. As wide as the page, but not narrower than least_px, where a telephone scrolls it,
 * nor wider than most_px (0: any). */
void page_picture(page *self, const char *file, const char *what, uint32_t least_px,
                  uint32_t most_px);
/* Below a picture or a table. */
__attribute__((format(printf, 2, 3))) void page_caption(page *self, const char *format, ...);

/* Writes both. After this only page_destroy. */
CHECKED mrt_result page_write(page *self, const char *html_path, const char *markdown_path,
                              error *err);

#endif
