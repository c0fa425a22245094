#include "paper/page.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_MAX = 4096, SHORT_WORD = 40 };

typedef struct half { /* one of the two forms of the page */
    FILE *stream;
    char *text;
    size_t size;
} half;

struct page {
    half html, markdown;
    bool has_numbers[PAGE_COLUMNS_MAX]; /* columns of the open table */
    uint32_t column_count;
};

/* Ink, calm and paper are also the colours of the drawings. */
static const char style[] =
    ":root{color-scheme:light dark;--paper:#fcfcfa;--ink:#1c1e22;--calm:#5b6068;--line:#d5d7d2;"
    "--wash:#f0f1ec;--link:#0b5fa5}\n"
    "@media(prefers-color-scheme:dark){:root{--paper:#16181b;--ink:#e6e8ea;--calm:#9ba1a9;"
    "--line:#363a40;--wash:#202328;--link:#7ab8f5}}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0 auto;padding:1.5rem 1rem 4rem;max-width:72rem;background:var(--paper);"
    "color:var(--ink);font:1rem/1.55 system-ui,-apple-system,\"Segoe UI\",sans-serif;"
    "overflow-wrap:break-word}\n"
    "h1{font-size:1.9rem;line-height:1.2;margin:.5rem 0 1rem}\n"
    "h2{font-size:1.35rem;margin:2.6rem 0 .6rem;padding-top:.8rem;border-top:1px solid "
    "var(--line)}\n"
    "h3{font-size:1.08rem;margin:1.8rem 0 .4rem}\n"
    "p{margin:.6rem 0;max-width:46rem}\n"
    "a{color:var(--link)}\n"
    "code,pre{font-family:ui-monospace,\"DejaVu Sans Mono\",monospace;font-size:.86em}\n"
    "code{background:var(--wash);padding:.05em .3em;border-radius:3px}\n"
    "pre{background:var(--wash);border:1px solid var(--line);border-radius:5px;padding:.6rem "
    ".8rem;white-space:pre-wrap;overflow-wrap:anywhere;margin:.5rem 0}\n"
    ".wide{overflow-x:auto;margin:.9rem 0}\n"
    ".wide img{display:block;width:100%;height:auto;border:1px solid var(--line);"
    "border-radius:5px}\n"
    "table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums}\n"
    "th,td{padding:.3rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid "
    "var(--line)}\n"
    "th{font-weight:600;vertical-align:bottom;border-bottom-width:2px}\n"
    "td.n,th.n{text-align:right}\n"
    "td.n{white-space:nowrap}\n"
    "pre span{white-space:nowrap}\n"
    "tbody tr:nth-child(even){background:var(--wash)}\n"
    ".caption{color:var(--calm);font-size:.9rem;margin-top:.3rem}\n";

/* ---- writing into both ---- */

/* Escapes for HTML and XML. */
static void write_letter(FILE *out, char letter)
{
    static const char special[] = "&<>\"";
    static const char *const written[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    const char *at = strchr(special, letter);
    if (at)
        fputs(written[at - special], out);
    else
        fputc(letter, out);
}

static void write_escaped(FILE *out, const char *text)
{
    for (; *text; ++text)
        write_letter(out, *text);
}

static void write_html(FILE *out, const char *text)
{
    bool is_code = false;
    for (; *text; ++text) {
        if (*text != '`') {
            write_letter(out, *text);
            continue;
        }
        is_code = !is_code;
        fputs(is_code ? "<code>" : "</code>", out);
    }
}

/* Escapes the special characters of Markdown; in code only those that end a cell of a table. */
static void write_markdown(FILE *out, const char *text)
{
    bool is_code = false;
    for (; *text; ++text) {
        is_code = is_code != (*text == '`');
        if (*text == '|' || (!is_code && strchr("*_<>[]\\", *text)))
            fputc('\\', out);
        fputc(*text, out);
    }
}

static void write_both(page *self, const char *before, const char *text, const char *after,
                       const char *mark)
{
    fputs(before, self->html.stream);
    write_html(self->html.stream, text);
    fputs(after, self->html.stream);
    fputs(mark, self->markdown.stream);
    write_markdown(self->markdown.stream, text);
    fputs("\n\n", self->markdown.stream);
}

/* ---- beginning of the page ---- */

static bool open_half(half *self)
{
    self->stream = open_memstream(&self->text, &self->size);
    return self->stream != NULL;
}

static void close_half(half *self)
{
    if (self->stream)
        fclose(self->stream);
    free(self->text);
    *self = (half){0};
}

page *page_create(const char *title)
{
    page *self = calloc(1, sizeof *self);
    if (!self || !open_half(&self->html) || !open_half(&self->markdown)) {
        page_destroy(self);
        return NULL;
    }
    FILE *html = self->html.stream;
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta name=\"generator\" content=\"marotte " MAROTTE_VERSION "\">\n<title>",
          html);
    write_html(html, title);
    fprintf(html, "</title>\n<style>\n%s</style>\n</head>\n<body>\n", style);
    write_both(self, "<h1>", title, "</h1>\n", "# ");
    return self;
}

void page_destroy(page *self)
{
    if (!self)
        return;
    close_half(&self->html);
    close_half(&self->markdown);
    free(self);
}

void page_heading(page *self, const char *text)
{
    write_both(self, "<h2>", text, "</h2>\n", "## ");
}

void page_subheading(page *self, const char *text)
{
    write_both(self, "<h3>", text, "</h3>\n", "### ");
}

void page_text(page *self, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    write_both(self, "<p>", text, "</p>\n", "");
}

void page_caption(page *self, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    write_both(self, "<p class=\"caption\">", text, "</p>\n", "");
}

/* Breaks lines between words, and within a word only if it is long. */
void page_command(page *self, const char *command)
{
    FILE *html = self->html.stream;
    fputs("<pre>", html);
    for (const char *word = command; *word;) {
        char text[TEXT_MAX];
        size_t length = strcspn(word, " ");
        bool is_short = length < SHORT_WORD;
        (void)snprintf(text, sizeof text, "%.*s", (int)length, word);
        fputs(is_short ? "<span>" : "", html);
        write_html(html, text);
        fputs(is_short ? "</span>" : "", html);
        word += length;
        for (; *word == ' '; ++word)
            fputc(' ', html);
    }
    fputs("</pre>\n", html);
    fprintf(self->markdown.stream, "```sh\n%s\n```\n\n", command);
}

/* ---- tables and pictures ---- */

static void write_cells(page *self, const char *const *cell, const char *tag)
{
    FILE *html = self->html.stream, *markdown = self->markdown.stream;
    fputs("<tr>", html);
    fputc('|', markdown);
    for (uint32_t i = 0; i < self->column_count; ++i) {
        fprintf(html, "<%s%s>", tag, self->has_numbers[i] ? " class=\"n\"" : "");
        write_html(html, cell[i]);
        fprintf(html, "</%s>", tag);
        fputc(' ', markdown);
        write_markdown(markdown, cell[i]);
        fputs(" |", markdown);
    }
    fputs("</tr>\n", html);
    fputc('\n', markdown);
}

void page_table(page *self, const char *const *head, uint32_t column_count)
{
    const char *word[PAGE_COLUMNS_MAX];
    self->column_count = column_count < PAGE_COLUMNS_MAX ? column_count : PAGE_COLUMNS_MAX;
    for (uint32_t i = 0; i < self->column_count; ++i) {
        self->has_numbers[i] = head[i][0] == '>';
        word[i] = head[i] + self->has_numbers[i];
    }
    fputs("<div class=\"wide\"><table>\n<thead>\n", self->html.stream);
    write_cells(self, word, "th");
    fputs("</thead>\n<tbody>\n", self->html.stream);
    fputc('|', self->markdown.stream);
    for (uint32_t i = 0; i < self->column_count; ++i)
        fputs(self->has_numbers[i] ? "---:|" : "---|", self->markdown.stream);
    fputc('\n', self->markdown.stream);
}

void page_row(page *self, const char *const *cell)
{
    write_cells(self, cell, "td");
}

void page_table_end(page *self)
{
    fputs("</tbody>\n</table></div>\n", self->html.stream);
    fputc('\n', self->markdown.stream);
}

void page_picture(page *self, const char *file, const char *what, uint32_t least_px,
                  uint32_t most_px)
{
    FILE *html = self->html.stream, *markdown = self->markdown.stream;
    fprintf(html, "<div class=\"wide\"><a href=\"%s\"><img src=\"%s\" style=\"min-width:%upx", file,
            file, least_px);
    if (most_px)
        fprintf(html, ";max-width:%upx", most_px);
    fputs("\" alt=\"", html);
    write_html(html, what);
    fputs("\"></a></div>\n", html);
    fputs("![", markdown);
    write_markdown(markdown, what);
    fprintf(markdown, "](%s)\n\n", file);
}

/* ---- into files ---- */

static mrt_result write_half(half *self, const char *path, error *err)
{
    bool is_whole = !ferror(self->stream) && fclose(self->stream) == 0;
    self->stream = NULL;
    if (!is_whole)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    return file_write(path, self->text, self->size, err);
}

mrt_result page_write(page *self, const char *html_path, const char *markdown_path, error *err)
{
    fputs("</body>\n</html>\n", self->html.stream);
    mrt_result result = write_half(&self->markdown, markdown_path, err);
    return result < 0 ? result : write_half(&self->html, html_path, err);
}

/* ---- drawings ---- */

static const char *const ink_class[SVG_INKS] = {"ink", "calm", "line", "wash", "a", "b"};
static const char *const anchor_name[] = {"start", "middle", "end"};

/* The colours of the drawings; ink, calm and paper are those of the page (style). Written in full
 * for each class: programs other than browsers know classes, but neither variables nor the dark
 * theme. */
#define FILL_AND_STROKE(name, colour) ".f-" name "{fill:" colour "}.s-" name "{stroke:" colour "}"
#define THEME(ink, calm, line, wash, a, b, paper)                                                  \
    FILL_AND_STROKE("ink", ink)                                                                    \
    FILL_AND_STROKE("calm", calm)                                                                  \
    FILL_AND_STROKE("line", line)                                                                  \
    FILL_AND_STROKE("wash", wash)                                                                  \
    FILL_AND_STROKE("a", a)                                                                        \
    FILL_AND_STROKE("b", b)                                                                        \
    FILL_AND_STROKE("paper", paper)
static const char svg_style[] =
    "<style>\n"
    "svg{font-family:system-ui,\"Segoe UI\",\"Inter\",\"DejaVu Sans\",sans-serif}\n" THEME(
        "#1c1e22", "#5b6068", "#c9ccc6", "#eceee8", "#0a67b1", "#c25400",
        "#fcfcfa") "\n@media(prefers-color-scheme:dark){" THEME("#e6e8ea", "#9ba1a9", "#41464d",
                                                                "#24282d", "#63b0f5", "#ff9e4f",
                                                                "#16181b") "}\n</style>\n";

mrt_result svg_open(svg *out, const char *path, uint32_t width, uint32_t height, const char *title,
                    error *err)
{
    *out = (svg){0};
    mrt_result result = file_writer_open(&out->writer, path, err);
    if (result < 0)
        return result;
    FILE *stream = out->writer.stream;
    fprintf(stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %u %u\" width=\"%u\" "
            "height=\"%u\" role=\"img\">\n<title>",
            width, height, width, height);
    write_escaped(stream, title);
    fprintf(stream, "</title>\n%s<rect class=\"f-paper\" width=\"%u\" height=\"%u\"/>\n", svg_style,
            width, height);
    return MRT_OK;
}

mrt_result svg_finish(svg *self, error *err)
{
    fputs("</svg>\n", self->writer.stream);
    return file_writer_commit(&self->writer, err);
}

void svg_line(svg *self, svg_ink ink, double width, const double from[2], const double to[2])
{
    fprintf(self->writer.stream,
            "<line class=\"s-%s\" stroke-width=\"%g\" x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" "
            "y2=\"%.2f\"/>\n",
            ink_class[ink], width, from[0], from[1], to[0], to[1]);
}

void svg_curve(svg *self, svg_ink ink, double width, const char *dash, const double *point,
               uint32_t count)
{
    FILE *out = self->writer.stream;
    fprintf(out, "<polyline class=\"s-%s\" fill=\"none\" stroke-width=\"%g\"", ink_class[ink],
            width);
    if (dash[0])
        fprintf(out, " stroke-dasharray=\"%s\"", dash);
    fputs(" points=\"", out);
    for (uint32_t i = 0; i < count; ++i)
        fprintf(out, "%s%.2f,%.2f", i ? " " : "", point[2 * i], point[2 * i + 1]);
    fputs("\"/>\n", out);
}

void svg_box(svg *self, svg_ink fill, svg_ink border, double x, double y, double width,
             double height)
{
    fprintf(self->writer.stream,
            "<rect class=\"f-%s s-%s\" x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" "
            "rx=\"5\"/>\n",
            ink_class[fill], ink_class[border], x, y, width, height);
}

void svg_point(svg *self, svg_ink ink, svg_mark mark, double x, double y, double radius)
{
    bool is_filled = mark == SVG_DOT || mark == SVG_SQUARE;
    const char *fill = is_filled ? ink_class[ink] : "paper";
    if (mark == SVG_DOT || mark == SVG_RING)
        fprintf(self->writer.stream,
                "<circle class=\"f-%s s-%s\" stroke-width=\"2\" cx=\"%.2f\" cy=\"%.2f\" "
                "r=\"%.2f\"/>\n",
                fill, ink_class[ink], x, y, radius);
    else
        fprintf(self->writer.stream,
                "<rect class=\"f-%s s-%s\" stroke-width=\"2\" x=\"%.2f\" y=\"%.2f\" "
                "width=\"%.2f\" height=\"%.2f\"/>\n",
                fill, ink_class[ink], x - radius, y - radius, 2.0 * radius, 2.0 * radius);
}

void svg_arrow(svg *self, svg_ink ink, const double from[2], const double to[2])
{
    /* all arrows here follow an axis */
    double way[2] = {(to[0] > from[0]) - (to[0] < from[0]), (to[1] > from[1]) - (to[1] < from[1])};
    const double neck[2] = {to[0] - 8.0 * way[0], to[1] - 8.0 * way[1]};
    svg_line(self, ink, 1.6, from, neck);
    fprintf(self->writer.stream, "<path class=\"f-%s\" d=\"M%.2f %.2fL%.2f %.2fL%.2f %.2fZ\"/>\n",
            ink_class[ink], to[0], to[1], neck[0] + 4.5 * way[1], neck[1] + 4.5 * way[0],
            neck[0] - 4.5 * way[1], neck[1] - 4.5 * way[0]);
}

static void write_words(svg *self, svg_ink ink, double size, svg_anchor anchor, const char *more,
                        double x, double y, const char *words)
{
    FILE *out = self->writer.stream;
    fprintf(out,
            "<text class=\"f-%s\" font-size=\"%g\" text-anchor=\"%s\" x=\"%.2f\" y=\"%.2f\"%s>",
            ink_class[ink], size, anchor_name[anchor], x, y, more);
    write_escaped(out, words);
    fputs("</text>\n", out);
}

void svg_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
               const char *words)
{
    write_words(self, ink, size, anchor, "", x, y, words);
}

void svg_strong_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
                      const char *words)
{
    write_words(self, ink, size, anchor, " font-weight=\"600\"", x, y, words);
}

void svg_words_upwards(svg *self, svg_ink ink, double size, double x, double y, const char *words)
{
    char transform[64];
    (void)snprintf(transform, sizeof transform, " transform=\"rotate(-90 %.2f %.2f)\"", x, y);
    write_words(self, ink, size, SVG_MIDDLE, transform, x, y, words);
}

void svg_cells_begin(svg *self, svg_ink ink)
{
    fprintf(self->writer.stream, "<path class=\"f-%s\" shape-rendering=\"crispEdges\" d=\"",
            ink_class[ink]);
}

void svg_cells(svg *self, double x, double y, double side, uint32_t row, uint32_t column,
               uint32_t count)
{
    fprintf(self->writer.stream, "M%.2f %.2fh%.2fv%.2fh%.2fz", x + side * column, y + side * row,
            side * count, side, -side * count);
}

void svg_cells_end(svg *self)
{
    fputs("\"/>\n", self->writer.stream);
}
