#include "paper/svg.h"

static const char *const ink_class[SVG_INKS] = {"ink", "calm", "line", "wash", "a", "b"};
static const char *const anchor_name[] = {"start", "middle", "end"};

/* The same colours as the page's (ui/paper/page.c). In full for each class: programs other than
 * browsers know classes, but neither variables nor the dark theme. */
#define FILL_AND_STROKE(name, colour) ".f-" name "{fill:" colour "}.s-" name "{stroke:" colour "}"
#define THEME(ink, calm, line, wash, a, b, paper)                                                  \
    FILL_AND_STROKE("ink", ink)                                                                    \
    FILL_AND_STROKE("calm", calm)                                                                  \
    FILL_AND_STROKE("line", line)                                                                  \
    FILL_AND_STROKE("wash", wash)                                                                  \
    FILL_AND_STROKE("a", a)                                                                        \
    FILL_AND_STROKE("b", b)                                                                        \
    FILL_AND_STROKE("paper", paper)
static const char style[] =
    "<style>\n"
    "svg{font-family:system-ui,\"Segoe UI\",\"Inter\",\"DejaVu Sans\",sans-serif}\n" THEME(
        "#1c1e22", "#5b6068", "#c9ccc6", "#eceee8", "#0a67b1", "#c25400",
        "#fcfcfa") "\n@media(prefers-color-scheme:dark){" THEME("#e6e8ea", "#9ba1a9", "#41464d",
                                                                "#24282d", "#63b0f5", "#ff9e4f",
                                                                "#16181b") "}\n</style>\n";

static void put_escaped(FILE *out, const char *text)
{
    for (; *text; ++text)
        if (*text == '&')
            fputs("&amp;", out);
        else if (*text == '<')
            fputs("&lt;", out);
        else if (*text == '>')
            fputs("&gt;", out);
        else
            fputc(*text, out);
}

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
    put_escaped(stream, title);
    fprintf(stream, "</title>\n%s<rect class=\"f-paper\" width=\"%u\" height=\"%u\"/>\n", style,
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
    /* Along an axis, as all arrows here. */
    double way[2] = {(to[0] > from[0]) - (to[0] < from[0]), (to[1] > from[1]) - (to[1] < from[1])};
    const double neck[2] = {to[0] - 8.0 * way[0], to[1] - 8.0 * way[1]};
    svg_line(self, ink, 1.6, from, neck);
    fprintf(self->writer.stream, "<path class=\"f-%s\" d=\"M%.2f %.2fL%.2f %.2fL%.2f %.2fZ\"/>\n",
            ink_class[ink], to[0], to[1], neck[0] + 4.5 * way[1], neck[1] + 4.5 * way[0],
            neck[0] - 4.5 * way[1], neck[1] - 4.5 * way[0]);
}

static void put_words(svg *self, svg_ink ink, double size, svg_anchor anchor, const char *more,
                      double x, double y, const char *words)
{
    FILE *out = self->writer.stream;
    fprintf(out,
            "<text class=\"f-%s\" font-size=\"%g\" text-anchor=\"%s\" x=\"%.2f\" y=\"%.2f\"%s>",
            ink_class[ink], size, anchor_name[anchor], x, y, more);
    put_escaped(out, words);
    fputs("</text>\n", out);
}

void svg_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
               const char *words)
{
    put_words(self, ink, size, anchor, "", x, y, words);
}

void svg_strong_words(svg *self, svg_ink ink, double size, svg_anchor anchor, double x, double y,
                      const char *words)
{
    put_words(self, ink, size, anchor, " font-weight=\"600\"", x, y, words);
}

void svg_words_upwards(svg *self, svg_ink ink, double size, double x, double y, const char *words)
{
    char turn[64];
    (void)snprintf(turn, sizeof turn, " transform=\"rotate(-90 %.2f %.2f)\"", x, y);
    put_words(self, ink, size, SVG_MIDDLE, turn, x, y, words);
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
