/* paper/page.h - a page that is written twice with the same contents: as HTML, which follows the
 * light or dark theme of the reader and fits a telephone, and as Markdown. Texts are plain UTF-8;
 * text between ` is code. Also drawings as SVG. Leaves out the contents of the page. [main] */
#ifndef MAROTTE_UI_PAPER_PAGE_H
#define MAROTTE_UI_PAPER_PAGE_H
#include "base/file.h"

typedef struct page page;

page *page_create(const char *title); /* NULL: no memory */
void page_destroy(page *self);        /* accepts NULL */

void page_heading(page *self, const char *text);
void page_subheading(page *self, const char *text);
__attribute__((format(printf, 2, 3))) void page_text(page *self, const char *format, ...);
/* Adds a command on its own line. */
void page_command(page *self, const char *command);

/* Columns whose head begins with '>' contain numbers, which are aligned to the right. head, cell:
 * column_count. */
enum { PAGE_COLUMNS_MAX = 16 };
void page_table(page *self, const char *const *head, uint32_t column_count);
void page_row(page *self, const char *const *cell);
void page_table_end(page *self);

/* Adds a picture that is stored beside the page. what: one sentence that describes it, for people
 * who cannot see it. As wide as the page, but at least least_px (a telephone then scrolls it) and
 * at most most_px (0: no limit). */
void page_picture(page *self, const char *file, const char *what, uint32_t least_px,
                  uint32_t most_px);
/* Adds a caption below a picture or a table. */
__attribute__((format(printf, 2, 3))) void page_caption(page *self, const char *format, ...);

/* Writes both. After this only page_destroy may be called. */
CHECKED mrt_result page_write(page *self, const char *html_path, const char *markdown_path,
                              error *err);

/* ---- drawings as SVG: lines, boxes and words in a few inks, which follow the light or dark theme
 * of the reader, on their own background. Coordinates in pixels from the top left ---- */

typedef enum svg_ink {
    SVG_INK = 0, /* words, axes */
    SVG_CALM,    /* explanations */
    SVG_LINE,    /* grids, borders */
    SVG_WASH,    /* areas behind words */
    SVG_FIRST,   /* the first curve: blue */
    SVG_SECOND,  /* the second: orange */
    SVG_INKS
} svg_ink;

typedef struct svg {
    file_writer writer;
} svg;

/* title: description for people who cannot see the drawing. */
CHECKED mrt_result svg_open(svg *out, const char *path, uint32_t width, uint32_t height,
                            const char *title, error *err);
CHECKED mrt_result svg_finish(svg *self, error *err);

void svg_line(svg *self, svg_ink ink, double width, const double from[2], const double to[2]);
/* point: count by 2; dash: "" or as stroke-dasharray. */
void svg_curve(svg *self, svg_ink ink, double width, const char *dash, const double *point,
               uint32_t count);
void svg_box(svg *self, svg_ink fill, svg_ink border, double x, double y, double width,
             double height);
/* Draws a mark around a point: round or square, filled or not. */
typedef enum svg_mark { SVG_DOT = 0, SVG_RING, SVG_SQUARE, SVG_SQUARE_RING } svg_mark;
void svg_point(svg *self, svg_ink ink, svg_mark mark, double x, double y, double radius);
/* Draws an arrow with its head at `to`. */
void svg_arrow(svg *self, svg_ink ink, const double from[2], const double to[2]);
typedef enum svg_anchor { SVG_START = 0, SVG_MIDDLE, SVG_END } svg_anchor;
/* Draws text with its baseline at y. */
void svg_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
               const char *words);
/* The same in bold; and upwards, centred, along a vertical axis. */
void svg_strong_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
                      const char *words);
void svg_words_upwards(svg *self, svg_ink ink, double size, double x, double y, const char *words);
/* Draws cells of a grid with sides of `side` px and the corner at x, y: `count` cells of `row`,
 * starting at `column`. Begin and end frame all cells of one ink. */
void svg_cells_begin(svg *self, svg_ink ink);
void svg_cells(svg *self, double x, double y, double side, uint32_t row, uint32_t column,
               uint32_t count);
void svg_cells_end(svg *self);

#endif
