#include "paper/page.h"

#include "base/file.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT_MAX = 4096, SHORT_WORD = 40 };

typedef struct half { /* the page in one of its two forms */
    FILE *stream;
    char *text;
    size_t size;
} half;

struct page {
    half html, markdown;
    page_column column[PAGE_COLUMNS_MAX];
    uint32_t column_count; /* of the table that is open */
};

/* Colours are those of ui/paper/svg.c. */
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

static void put_html(FILE *out, const char *text)
{
    bool is_code = false;
    for (; *text; ++text)
        if (*text == '`') {
            is_code = !is_code;
            fputs(is_code ? "<code>" : "</code>", out);
        } else if (*text == '&') {
            fputs("&amp;", out);
        } else if (*text == '<') {
            fputs("&lt;", out);
        } else if (*text == '>') {
            fputs("&gt;", out);
        } else if (*text == '"') {
            fputs("&quot;", out);
        } else {
            fputc(*text, out);
        }
}

/* What Markdown would take for its own is escaped; in code only what ends a table's cell. */
static void put_markdown(FILE *out, const char *text)
{
    bool is_code = false;
    for (; *text; ++text) {
        is_code = is_code != (*text == '`');
        if (*text == '|' || (!is_code && strchr("*_<>[]\\", *text)))
            fputc('\\', out);
        fputc(*text, out);
    }
}

static void put_both(page *self, const char *before, const char *text, const char *after,
                     const char *mark)
{
    fputs(before, self->html.stream);
    put_html(self->html.stream, text);
    fputs(after, self->html.stream);
    fputs(mark, self->markdown.stream);
    put_markdown(self->markdown.stream, text);
    fputs("\n\n", self->markdown.stream);
}

/* ---- from the top ---- */

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
    put_html(html, title);
    fprintf(html, "</title>\n<style>\n%s</style>\n</head>\n<body>\n", style);
    put_both(self, "<h1>", title, "</h1>\n", "# ");
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
    put_both(self, "<h2>", text, "</h2>\n", "## ");
}

void page_subheading(page *self, const char *text)
{
    put_both(self, "<h3>", text, "</h3>\n", "### ");
}

void page_text(page *self, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_both(self, "<p>", text, "</p>\n", "");
}

void page_caption(page *self, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_both(self, "<p class=\"caption\">", text, "</p>\n", "");
}

/* Lines are broken between its words; within one only where it is long. */
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
        put_html(html, text);
        fputs(is_short ? "</span>" : "", html);
        word += length;
        for (; *word == ' '; ++word)
            fputc(' ', html);
    }
    fputs("</pre>\n", html);
    fprintf(self->markdown.stream, "```sh\n%s\n```\n\n", command);
}

/* ---- tables and pictures ---- */

static void put_cells(page *self, const char *const *cell, const char *tag)
{
    FILE *html = self->html.stream, *markdown = self->markdown.stream;
    fputs("<tr>", html);
    fputc('|', markdown);
    for (uint32_t i = 0; i < self->column_count; ++i) {
        fprintf(html, "<%s%s>", tag, self->column[i] == PAGE_NUMBERS ? " class=\"n\"" : "");
        put_html(html, cell[i]);
        fprintf(html, "</%s>", tag);
        fputc(' ', markdown);
        put_markdown(markdown, cell[i]);
        fputs(" |", markdown);
    }
    fputs("</tr>\n", html);
    fputc('\n', markdown);
}

void page_table(page *self, const char *const *head, const page_column *column,
                uint32_t column_count)
{
    self->column_count = column_count < PAGE_COLUMNS_MAX ? column_count : PAGE_COLUMNS_MAX;
    memcpy(self->column, column, self->column_count * sizeof *column);
    fputs("<div class=\"wide\"><table>\n<thead>\n", self->html.stream);
    put_cells(self, head, "th");
    fputs("</thead>\n<tbody>\n", self->html.stream);
    fputc('|', self->markdown.stream);
    for (uint32_t i = 0; i < self->column_count; ++i)
        fputs(column[i] == PAGE_NUMBERS ? "---:|" : "---|", self->markdown.stream);
    fputc('\n', self->markdown.stream);
}

void page_row(page *self, const char *const *cell)
{
    put_cells(self, cell, "td");
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
    put_html(html, what);
    fputs("\"></a></div>\n", html);
    fputs("![", markdown);
    put_markdown(markdown, what);
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
