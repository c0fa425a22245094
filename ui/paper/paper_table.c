/* Table 1 in all its cells, and Figure 3: frames a second over the radius. */
#include "paper/paper.h"

#include "base/clock.h"
#include "bench/bench.h"
#include "draw/draw.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MODELS = 4, METHODS = 2, ANCHORED = 0, UNANCHORED = 1, CELLS = MODELS * BENCH_RADII };
enum { WINDOW_WIDTH = 640, WINDOW_HEIGHT = 480, SMALL_WIDTH = 160, SMALL_HEIGHT = 120 };
static const int64_t display_budget_ns = 40 * NS_PER_S;
static const char *const method_name[METHODS] = {"anchored", "unanchored"};

typedef struct result {                        /* of one method */
    double engine_fps, display_fps, paper_fps; /* 0: unknown */
} result;

typedef struct row { /* of one model at one radius */
    uint32_t vertex_count, triangle_count;
    double radius_mm;
    uint64_t pairs, paper_pairs;
    result of[METHODS];
} row;

typedef struct table {
    paper *of;
    row row[CELLS];
    uint32_t row_count;
    /* context to draw a cell; NULL: drawing is not possible */
    draw_context *context;
    draw_target *target;
    draw_renderer *renderer;
    draw_face *face;
    uint8_t *pixels;
    float *xyz; /* of the current model, in the order of the file */
    uint32_t width, height, face_vertices;
    draw_camera camera;
    const bench_cell *cell;
    int64_t display_ns; /* time spent on whole frames */
    int decade_low;     /* least decade of the plot: 10^0, or 10^-1 if a rate is below 1 */
} table;

/* ---- the whole frame ---- */

static mrt_result open_display(table *self, error *err)
{
    self->width = self->of->is_quick ? SMALL_WIDTH : WINDOW_WIDTH;
    self->height = self->of->is_quick ? SMALL_HEIGHT : WINDOW_HEIGHT;
    if (!self->of->drawn_by[0])
        return MRT_OK;
    self->pixels = malloc((size_t)self->width * self->height * 4);
    if (!self->pixels)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a picture");
    self->context = draw_context_create(err);
    self->target = self->context ? draw_target_create(self->width, self->height, err) : NULL;
    self->renderer = self->target ? draw_renderer_create(err) : NULL;
    return self->renderer ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

static void close_display(table *self)
{
    draw_face_destroy(self->face);
    draw_renderer_destroy(self->renderer);
    draw_target_destroy(self->target);
    draw_context_destroy(self->context);
    free(self->pixels);
    free(self->xyz);
}

static mrt_result show_model(table *self, const bench_cell *cell, error *err)
{
    mesh m;
    float low[3], high[3];
    mrt_result made = mesh_create(&m, cell->vertex_count, cell->triangle_count, err);
    if (made < 0)
        return made;
    memcpy(m.position, cell->rest, (size_t)m.vertex_count * 3 * sizeof *m.position);
    memcpy(m.triangle, cell->triangle, (size_t)m.triangle_count * 3 * sizeof *m.triangle);
    mesh_bounds(&m, low, high);
    self->camera = draw_camera_framing(low, high, (float)self->width / (float)self->height);
    self->camera.pitch_rad = 0.6f;
    draw_face_destroy(self->face);
    free(self->xyz);
    self->face = draw_face_create(&m, err);
    self->xyz = malloc((size_t)m.vertex_count * 3 * sizeof *self->xyz);
    self->face_vertices = m.vertex_count;
    mesh_destroy(&m);
    if (self->face && !self->xyz)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a model");
    return self->face ? MRT_OK : MRT_ERR_UNSUPPORTED;
}

/* Deforms, shades and draws, and reads the pixels into memory. */
static void run_whole(void *data)
{
    table *self = data;
    const shape *moved = self->cell->shape;
    self->cell->run(self->cell->data);
    points_to_rows(self->xyz, &moved->shown, &moved->order);
    draw_face_update(self->face, self->xyz, NULL);
    draw_render(self->renderer, self->target, self->face, &self->camera, 0, 0, self->width,
                self->height);
    draw_read(self->target, self->pixels);
}

/* Returns the best rate of some frames; each frame warms up the next. If drawing is slow, the last
 * cells get one frame each, to limit the time. */
static double measure_whole(table *self, const bench_cell *cell)
{
    const uint32_t rounds = self->of->is_quick ? 1 : 12,
                   least = self->display_ns < display_budget_ns ? 2 : 1;
    const int64_t begin_ns = clock_now_ns(), end_ns = begin_ns + NS_PER_S / 2;
    int64_t least_ns = INT64_MAX;
    self->cell = cell;
    for (uint32_t i = 0; i < rounds && (i < least || clock_now_ns() < end_ns); ++i) {
        int64_t start_ns = clock_now_ns();
        run_whole(self);
        int64_t took_ns = clock_now_ns() - start_ns;
        least_ns = took_ns < least_ns ? took_ns : least_ns;
    }
    self->display_ns += clock_now_ns() - begin_ns;
    return (double)least_ns;
}

/* ---- cell by cell ---- */

static row *row_of(table *self, const bench_cell *cell)
{
    for (uint32_t i = 0; i < self->row_count; ++i)
        if (self->row[i].vertex_count == cell->vertex_count &&
            fabs(self->row[i].radius_mm - cell->radius_mm) < 0.5)
            return &self->row[i];
    if (self->row_count == CELLS)
        return NULL;
    row *added = &self->row[self->row_count++];
    *added = (row){.vertex_count = cell->vertex_count,
                   .triangle_count = cell->triangle_count,
                   .radius_mm = cell->radius_mm,
                   .pairs = cell->pairs,
                   .paper_pairs = cell->paper_pairs};
    return added;
}

/* The last cell: the largest model at the largest radius. */
static bool is_drawn_in_quick(const bench_cell *cell)
{
    return cell->vertex_count > 33000 && cell->radius_mm > 79.0;
}

static mrt_result on_cell(void *data, const bench_cell *cell, error *err)
{
    table *self = data;
    row *at = row_of(self, cell);
    mrt_result checked = paper_check_stop(err);
    if (checked < 0)
        return checked;
    if (!at)
        return error_set(err, MRT_ERR_UNSUPPORTED, "the bench measures more than Table 1 has");
    result *out = &at->of[cell->is_anchored ? ANCHORED : UNANCHORED];
    out->engine_fps = 1e9 / cell->frame_ns;
    out->paper_fps = cell->paper_fps;
    if (!self->context || (self->of->is_quick && !is_drawn_in_quick(cell)))
        return MRT_OK;
    if (self->face_vertices != cell->vertex_count)
        checked = show_model(self, cell, err);
    if (checked < 0)
        return checked;
    out->display_fps = 1e9 / measure_whole(self, cell);
    progress_show(&self->of->shown, -1.0, "Table 1");
    return MRT_OK;
}

static mrt_result measure(table *self, error *err)
{
    bench of = {.is_quick = true,
                .is_json = true, /* prints nothing */
                .is_paper_alone = true,
                .rounds = self->of->is_quick ? 3 : 25,
                .seconds = self->of->is_quick ? 0.02 : 0.5,
                .on_cell = on_cell,
                .on_cell_data = self,
                .told = facts_create(FACTS_JSON)};
    if (!of.told)
        return error_set(err, MRT_ERR_MEMORY, "no memory for Table 1");
    mrt_result measured = bench_roof_create(&of.roof, (size_t)4 << 20, err);
    if (measured >= 0)
        measured = bench_grid(&of, err);
    bench_roof_destroy(&of.roof);
    facts_abandon(of.told);
    if (measured >= 0 && self->row_count != CELLS)
        measured = error_set(err, MRT_ERR_UNSUPPORTED, "the bench measures not all of Table 1");
    return measured;
}

/* ---- as a table ---- */

/* Writes "39 195", "13.4", "–". */
static void write_rate(char out[32], double fps)
{
    if (fps <= 0.0)
        (void)snprintf(out, 32, "–");
    else if (fps < 100.0)
        (void)snprintf(out, 32, "%.1f", fps);
    else
        paper_count(out, fps);
}

static double pairs_off(const row *r)
{
    return (double)r->pairs / (double)r->paper_pairs - 1.0;
}

static void add_row(table *self, const row *r)
{
    char vertices[32], polygons[32], radius[32], paper_pairs[32], pairs[32], off[32];
    char rate[METHODS][3][32];
    paper_count(vertices, r->vertex_count);
    paper_count(polygons, r->triangle_count);
    (void)snprintf(radius, sizeof radius, "%g", r->radius_mm);
    paper_count(paper_pairs, (double)r->paper_pairs);
    paper_count(pairs, (double)r->pairs);
    (void)snprintf(off, sizeof off, "%+.1f %%", 100.0 * pairs_off(r));
    for (int i = 0; i < METHODS; ++i) {
        write_rate(rate[i][0], r->of[i].paper_fps);
        write_rate(rate[i][1], r->of[i].engine_fps);
        write_rate(rate[i][2], r->of[i].display_fps);
    }
    const char *const cell[] = {polygons,   vertices,   radius,     paper_pairs,
                                pairs,      off,        rate[0][0], rate[0][1],
                                rate[0][2], rate[1][0], rate[1][1], rate[1][2]};
    page_row(self->of->page, cell);
}

static void report_row(table *self, const row *r)
{
    for (int i = 0; i < METHODS; ++i) {
        const facts_cell cells[] = {
            {"method", method_name[i], 0.0, 0},
            {"vertices", NULL, r->vertex_count, 0},
            {"polygons", NULL, r->triangle_count, 0},
            {"radius_mm", NULL, r->radius_mm, 1},
            {"paper_pairs", NULL, (double)r->paper_pairs, 0},
            {"pairs", NULL, (double)r->pairs, 0},
            {"pairs_off", NULL, pairs_off(r), 5},
            {"paper_fps", NULL, r->of[i].paper_fps, 1},
            {"engine_fps", NULL, r->of[i].engine_fps, 1},
            {"display_fps", NULL, r->of[i].display_fps, 1},
        };
        facts_row(self->of->told, "table_1", "", "", cells, sizeof cells / sizeof cells[0]);
    }
}

static void add_table(table *self)
{
    static const char *const head[] = {
        ">polygons",          ">vertices",           ">R, mm",
        ">pairs: paper",      ">pairs: counted",     ">difference",
        ">anchored: paper",   ">anchored: engine",   ">anchored, with display",
        ">unanchored: paper", ">unanchored: engine", ">unanchored, with display"};
    page *on = self->of->page;
    page_heading(on, "Table 1: frames a second");
    page_text(on,
              "Ten control vectors on a plane, without polynomial. “Pairs” are vertices and "
              "controls within the radius of support of each other. The paper does not give the "
              "positions of its ten points. Ours were fitted once to its counts of pairs (square "
              "of 66.12 mm a side), so that the work is that of the paper within 2 %%.");
    page_table(on, head, sizeof head / sizeof head[0]);
    for (uint32_t i = 0; i < self->row_count; ++i) {
        add_row(self, &self->row[i]);
        report_row(self, &self->row[i]);
        double off = fabs(pairs_off(&self->row[i]));
        self->of->worst_pairs_off = fmax(self->of->worst_pairs_off, off);
    }
    page_table_end(on);
    page_caption(
        on,
        "Frames a second, the best of several rounds. Engine: one thread; anchored a frame, "
        "unanchored a whole sample: sort, factor, solve, slope, update. With display: the same "
        "step, then normals, light and %u × %u pixels in memory, drawn by %s%s. –: the paper's "
        "number is not in our notes%s. The pair count that the paper prints for 32 768 polygons "
        "at R = 60, 115 812, is a misprint (see below); the table has 155 812.",
        self->width, self->height,
        self->of->drawn_by[0] ? self->of->drawn_by : "nothing: drawing is not possible here",
        self->of->is_quick ? "; with --quick, only for the last row" : "",
        self->of->drawn_by[0] ? "" : ", or drawing is not possible here");
    facts_number(self->of->told, "worst_pairs_off", "pairs off", self->of->worst_pairs_off, 5, "");
}

/* ---- Figure 3 ---- */

enum {
    PLOT_WIDTH = 900,
    PLOT_HEIGHT = 560,
    PLOT_LEFT = 84,
    PLOT_TOP = 28,
    PLOT_RIGHT = 660,
    PLOT_BOTTOM = 488
};
static const double radius_end_mm = 90.0;
static const int decade_high = 6; /* -1 at least: "0.1" */

static double plot_x(double radius_mm)
{
    return PLOT_LEFT + radius_mm / radius_end_mm * (PLOT_RIGHT - PLOT_LEFT);
}

static double plot_y(const table *self, double fps)
{
    double share = (log10(fps) - self->decade_low) / (decade_high - self->decade_low);
    return PLOT_BOTTOM - share * (PLOT_BOTTOM - PLOT_TOP);
}

static void draw_axes(const table *self, svg *s)
{
    static const char *const decade[] = {"0.1",   "1",      "10",      "100",
                                         "1 000", "10 000", "100 000", "1 000 000"};
    char label[16];
    for (int power = self->decade_low; power <= decade_high; ++power) {
        double y = plot_y(self, pow(10.0, power));
        svg_line(s, SVG_LINE, 1.0, (double[]){PLOT_LEFT, y}, (double[]){PLOT_RIGHT, y});
        svg_words(s, SVG_INK, 14, SVG_END, PLOT_LEFT - 10, y + 5, decade[power + 1]);
        for (int i = 2; i < 10 && power < decade_high; ++i) {
            double minor = plot_y(self, i * pow(10.0, power));
            svg_line(s, SVG_CALM, 1.0, (double[]){PLOT_LEFT, minor},
                     (double[]){PLOT_LEFT + 5, minor});
        }
    }
    for (int radius = 0; radius < (int)radius_end_mm; radius += 20) {
        double x = plot_x(radius);
        svg_line(s, SVG_LINE, 1.0, (double[]){x, PLOT_TOP}, (double[]){x, PLOT_BOTTOM});
        (void)snprintf(label, sizeof label, "%d", radius);
        svg_words(s, SVG_INK, 14, SVG_MIDDLE, x, PLOT_BOTTOM + 22, label);
    }
    svg_line(s, SVG_INK, 1.5, (double[]){PLOT_LEFT, PLOT_BOTTOM},
             (double[]){PLOT_RIGHT, PLOT_BOTTOM});
    svg_line(s, SVG_INK, 1.5, (double[]){PLOT_LEFT, PLOT_TOP}, (double[]){PLOT_LEFT, PLOT_BOTTOM});
    svg_words(s, SVG_INK, 15, SVG_MIDDLE, 0.5 * (PLOT_LEFT + PLOT_RIGHT), PLOT_BOTTOM + 50,
              "radius of support R, mm");
    svg_words_upwards(s, SVG_INK, 15, 20, 0.5 * (PLOT_TOP + PLOT_BOTTOM), "frames a second");
}

typedef enum speed { SPEED_ENGINE = 0, SPEED_DISPLAY, SPEED_PAPER, SPEEDS } speed;
static const char *const dash[SPEEDS] = {"", "7 5", "2 4"};

static double speed_of(const result *r, speed which)
{
    return which == SPEED_ENGINE ? r->engine_fps
                                 : (which == SPEED_DISPLAY ? r->display_fps : r->paper_fps);
}

static svg_mark mark_of(int method, speed which)
{
    return which == SPEED_PAPER ? (method == ANCHORED ? SVG_RING : SVG_SQUARE_RING)
                                : (method == ANCHORED ? SVG_DOT : SVG_SQUARE);
}

/* Draws the curve of the largest model. */
static void draw_curve(const table *self, svg *s, int method, speed which)
{
    double point[2 * BENCH_RADII];
    uint32_t count = 0;
    svg_ink ink = method == ANCHORED ? SVG_FIRST : SVG_SECOND;
    for (uint32_t i = CELLS - BENCH_RADII; i < CELLS; ++i) {
        double fps = speed_of(&self->row[i].of[method], which);
        if (fps <= 0.0)
            continue;
        point[2 * count] = plot_x(self->row[i].radius_mm);
        point[2 * count + 1] = plot_y(self, fps);
        ++count;
    }
    svg_curve(s, ink, 2.5, dash[which], point, count);
    for (uint32_t i = 0; i < count; ++i)
        svg_point(s, ink, mark_of(method, which), point[2 * i], point[2 * i + 1], 4.5);
}

static void draw_legend(const table *self, svg *s)
{
    static const char *const title[SPEEDS] = {"Engine alone", "With display",
                                              "Paper, with display"};
    double x = PLOT_RIGHT + 24, y = PLOT_TOP + 24;
    for (int which = 0; which < SPEEDS; ++which) {
        if (which == SPEED_DISPLAY && !self->context)
            continue;
        svg_strong_words(s, SVG_INK, 15, SVG_START, x, y, title[which]);
        for (int method = 0; method < METHODS; ++method) {
            svg_ink ink = method == ANCHORED ? SVG_FIRST : SVG_SECOND;
            y += 24;
            svg_curve(s, ink, 2.5, dash[which], (double[]){x, y - 5, x + 40, y - 5}, 2);
            svg_point(s, ink, mark_of(method, (speed)which), x + 20, y - 5, 4.5);
            svg_words(s, SVG_INK, 14, SVG_START, x + 52, y, method_name[method]);
        }
        y += 40;
    }
    svg_words(s, SVG_CALM, 13, SVG_START, x, y, "65 536 polygons,");
    svg_words(s, SVG_CALM, 13, SVG_START, x, y + 18, "33 025 vertices, ten controls");
}

static mrt_result plot(table *self, error *err)
{
    static const char name[] = "figure3_frames.svg",
                      what[] = "Frames a second over the radius of support, logarithmic, for the "
                               "anchored and the unanchored way";
    char path[PATH_MAX];
    svg s;
    mrt_result made = paper_add_file(self->of, path, name, err);
    if (made >= 0)
        made = svg_open(&s, path, PLOT_WIDTH, PLOT_HEIGHT, what, err);
    if (made < 0)
        return made;
    self->decade_low = 0;
    for (uint32_t i = CELLS - BENCH_RADII; i < CELLS; ++i)
        for (int method = 0; method < METHODS; ++method) {
            double fps = self->row[i].of[method].display_fps;
            if (fps > 0.0 && fps < 1.0)
                self->decade_low = -1;
        }
    draw_axes(self, &s);
    for (int which = SPEEDS; which-- > 0;)
        for (int method = METHODS; method-- > 0;)
            if (which != SPEED_DISPLAY || self->context)
                draw_curve(self, &s, method, (speed)which);
    draw_legend(self, &s);
    made = svg_finish(&s, err);
    if (made < 0)
        return made;
    page_heading(self->of->page, "Figure 3: frames a second over the radius");
    page_picture(self->of->page, name, what, 640, 0);
    return MRT_OK;
}

static void describe_plot(const table *self)
{
    const row *narrow = &self->row[CELLS - BENCH_RADII], *wide = &self->row[CELLS - 1];
    bool has_order = true;
    double least = INFINITY, most = 0.0; /* paper: gain of anchored over unanchored */
    for (const row *r = narrow; r <= wide; ++r) {
        const result *held = &r->of[ANCHORED], *clay = &r->of[UNANCHORED];
        has_order = has_order && held->engine_fps > clay->engine_fps;
        if (held->paper_fps <= 0.0 || clay->paper_fps <= 0.0)
            continue;
        least = fmin(least, held->paper_fps / clay->paper_fps);
        most = fmax(most, held->paper_fps / clay->paper_fps);
    }
    page_caption(
        self->of->page,
        "As in the paper, %s. There the anchored way is %.0f to %.0f %% faster, display "
        "included. Here the engine alone is %.1f times as fast anchored at R = 10 and %.1f "
        "times at R = 80: an anchored frame adds responses that were computed when the hands "
        "took hold, at any radius. An unanchored frame evaluates its field again, at more "
        "vertices for a larger radius. With the display both are as fast as the display.",
        has_order ? "anchored is the faster way at every radius"
                  : "anchored should be the faster way, but was not in this run",
        100.0 * (least - 1.0), 100.0 * (most - 1.0),
        narrow->of[ANCHORED].engine_fps / narrow->of[UNANCHORED].engine_fps,
        wide->of[ANCHORED].engine_fps / wide->of[UNANCHORED].engine_fps);
    facts_text(self->of->told, "order", "order", has_order ? "as in the paper" : "otherwise");
}

mrt_result paper_table(paper *of, error *err)
{
    table self = {.of = of};
    mrt_result made = open_display(&self, err);
    if (made >= 0)
        made = measure(&self, err);
    if (made >= 0) {
        add_table(&self);
        made = plot(&self, err);
    }
    if (made >= 0)
        describe_plot(&self);
    close_display(&self);
    return made;
}
