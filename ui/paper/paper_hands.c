/* Figure 1, a hand and its tree, and Figure 2, the data flow. */
#include "paper/paper.h"

#include "draw/offscreen.h"
#include "hand/hand.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the hand as a surface: rounded bones are blended, and a surface is extracted from a grid by
 * surface nets ---- */

enum { FINGERS = 5, BONES_MAX = 48 };
static const double step_mm = 2.0, air_mm = 8.0;

typedef struct bone {
    vec3 from, to;
    double from_mm, to_mm; /* radii at its ends */
} bone;

typedef struct flesh {
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    bone palm_bone[BONES_MAX], finger[FINGERS][3];
    uint32_t palm_bone_count;
} flesh;

static vec3 wide(mrt_vec3 at)
{
    return (vec3){(double)at.x, (double)at.y, (double)at.z};
}

static vec3 between(vec3 a, vec3 b, double share)
{
    return vec3_add(vec3_scale(a, 1.0 - share), vec3_scale(b, share));
}

/* Poses a hand that is about to take hold: relaxed, slightly spread. Angles in the order of
 * sensors. */
static void pose_hand(flesh *self, const hand_skeleton *skeleton)
{
    static const float angle_rad[MRT_ANGLES] = {
        0.55f, 0.15f, 0.30f, 0.55f,        /* thumb: roll, inner and outer joint, abduction */
        0.32f, 0.42f, 0.22f, 0.26f, 0.38f, /* index, middle: knuckle .. outer joint */
        0.20f, 0.12f, 0.30f, 0.46f, 0.25f, /* and the spread between them; ring */
        0.12f, 0.34f, 0.44f, 0.24f, 0.14f, /* little */
    };
    const rigid still = rigid_identity();
    hand_pose(skeleton, angle_rad, &still, self->joint, self->palm);
}

static void add_palm_bone(flesh *self, vec3 from, vec3 to, double from_mm, double to_mm)
{
    self->palm_bone[self->palm_bone_count++] = (bone){from, to, from_mm, to_mm};
}

static void clothe(flesh *self)
{
    static const double base_mm[FINGERS] = {12.0, 9.6, 9.8, 9.2, 8.0};
    const vec3 wrist = wide(self->joint[0]);
    self->palm_bone_count = 0;
    for (int f = 0; f < FINGERS; ++f) {
        for (int b = 0; b < 3; ++b)
            self->finger[f][b] =
                (bone){wide(self->joint[1 + 4 * f + b]), wide(self->joint[2 + 4 * f + b]),
                       base_mm[f] * (1.0 - 0.11 * b), base_mm[f] * (1.0 - 0.11 * (b + 1))};
        vec3 knuckle = wide(self->joint[1 + 4 * f]);
        vec3 side = between(wrist, knuckle, 0.16);
        add_palm_bone(self, side, knuckle, 14.0, f == 0 ? 14.0 : 11.0);
        if (f > 1)
            add_palm_bone(self, wide(self->joint[1 + 4 * (f - 1)]), knuckle, 8.5, 8.5);
    }
    /* the ball of the thumb, the web, and the forearm's end */
    add_palm_bone(self, wide(self->palm[1]), wide(self->joint[2]), 15.0, 10.5);
    add_palm_bone(self, between(wrist, wide(self->joint[5]), 0.6),
                  between(wide(self->joint[1]), wide(self->joint[2]), 0.5), 10.0, 10.0);
    add_palm_bone(self, wide(self->palm[2]), wide(self->palm[0]), 11.0, 13.0);
    add_palm_bone(self, vec3_add(wrist, (vec3){-9.0, 0.0, -40.0}),
                  vec3_add(wrist, (vec3){-9.0, 0.0, 12.0}), 16.0, 16.0);
    add_palm_bone(self, vec3_add(wrist, (vec3){9.0, 0.0, -40.0}),
                  vec3_add(wrist, (vec3){9.0, 0.0, 12.0}), 16.0, 16.0);
}

static double distance_to(const bone *b, vec3 at)
{
    vec3 way = vec3_sub(b->to, b->from), off = vec3_sub(at, b->from);
    double length = vec3_dot(way, way);
    double share = length > 0.0 ? fmin(fmax(vec3_dot(off, way) / length, 0.0), 1.0) : 0.0;
    vec3 beside = vec3_sub(off, vec3_scale(way, share));
    return sqrt(vec3_dot(beside, beside)) - (b->from_mm + share * (b->to_mm - b->from_mm));
}

/* Returns the smaller of two distances, with a fillet of about width k where they meet. */
static double blended(double a, double b, double k)
{
    double h = fmax(k - fabs(a - b), 0.0) / k;
    return fmin(a, b) - 0.25 * h * h * k;
}

/* Returns the distance from the skin in mm; negative inside. */
static double distance_to_skin(const flesh *self, vec3 at)
{
    double palm = INFINITY, out = INFINITY;
    for (uint32_t i = 0; i < self->palm_bone_count; ++i) {
        double d = distance_to(&self->palm_bone[i], at);
        palm = i == 0 ? d : blended(palm, d, 11.0);
    }
    for (int f = 0; f < FINGERS; ++f) {
        double finger = distance_to(&self->finger[f][0], at);
        for (int b = 1; b < 3; ++b)
            finger = blended(finger, distance_to(&self->finger[f][b], at), 4.0);
        out = fmin(out, blended(palm, finger, 9.0));
    }
    return out;
}

typedef struct grid {
    vec3 low;
    uint32_t count[3]; /* of corners */
    float *value;      /* at each corner: distance_to_skin */
    uint32_t *vertex;  /* for each cell: 1 + index of its vertex; 0: the skin does not cross it */
} grid;

static size_t corner_of(const grid *g, uint32_t x, uint32_t y, uint32_t z)
{
    return ((size_t)z * g->count[1] + y) * g->count[0] + x;
}

/* gcc 12 for arm64 fails (an internal error) where it vectorises fmin and fmax of these. */
static void widen(double *low, double *high, double at)
{
    *low = at < *low ? at : *low;
    *high = at > *high ? at : *high;
}

static bool fill_grid(grid *g, const flesh *f)
{
    vec3 low = wide(f->joint[0]), high = low;
    for (int i = 1; i < MRT_JOINTS; ++i) {
        vec3 at = wide(f->joint[i]);
        widen(&low.x, &high.x, at.x);
        widen(&low.y, &high.y, at.y);
        widen(&low.z, &high.z, at.z);
    }
    const double room = 24.0 + air_mm;
    g->low = (vec3){low.x - room, low.y - room, low.z - 24.0}; /* the forearm is cut off here */
    const double size[3] = {high.x - low.x + 2 * room, high.y - low.y + 2 * room,
                            high.z - low.z + room + 24.0};
    for (int i = 0; i < 3; ++i)
        g->count[i] = (uint32_t)(size[i] / step_mm) + 2;
    size_t count = (size_t)g->count[0] * g->count[1] * g->count[2];
    g->value = malloc(count * sizeof *g->value);
    g->vertex = calloc(count, sizeof *g->vertex);
    if (!g->value || !g->vertex)
        return false;
    for (uint32_t z = 0; z < g->count[2]; ++z)
        for (uint32_t y = 0; y < g->count[1]; ++y)
            for (uint32_t x = 0; x < g->count[0]; ++x) {
                vec3 at = vec3_add(g->low, (vec3){step_mm * x, step_mm * y, step_mm * z});
                double d = distance_to_skin(f, at);
                g->value[corner_of(g, x, y, z)] =
                    (float)(z == 0 ? fmax(d, 0.5) : d); /* closes the surface at the cut */
            }
    return true;
}

/* Places a vertex at the mean of the points where the edges of a cell cross the skin. Returns false
 * if none does. */
static bool place_vertex(const grid *g, const uint32_t cell[3], float out[3])
{
    double sum[3] = {0.0};
    uint32_t crossings = 0;
    for (int edge = 0; edge < 12; ++edge) {
        const int axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
        uint32_t a[3] = {cell[0], cell[1], cell[2]}, b[3];
        a[u] += (uint32_t)(edge & 1);
        a[v] += (uint32_t)(edge >> 1 & 1);
        memcpy(b, a, sizeof b);
        b[axis] += 1;
        double from = (double)g->value[corner_of(g, a[0], a[1], a[2])],
               to = (double)g->value[corner_of(g, b[0], b[1], b[2])];
        if ((from < 0.0) == (to < 0.0))
            continue;
        for (int i = 0; i < 3; ++i)
            sum[i] += (double)a[i] + (i == axis ? from / (from - to) : 0.0);
        ++crossings;
    }
    const double low[3] = {g->low.x, g->low.y, g->low.z};
    for (int i = 0; i < 3 && crossings; ++i)
        out[i] = (float)(low[i] + step_mm * sum[i] / crossings);
    return crossings > 0;
}

static uint32_t place_vertices(grid *g, float *out)
{
    uint32_t count = 0;
    for (uint32_t z = 0; z + 1 < g->count[2]; ++z)
        for (uint32_t y = 0; y + 1 < g->count[1]; ++y)
            for (uint32_t x = 0; x + 1 < g->count[0]; ++x) {
                float at[3];
                if (!place_vertex(g, (uint32_t[]){x, y, z}, at))
                    continue;
                if (out)
                    memcpy(out + (size_t)3 * count, at, sizeof at);
                g->vertex[corner_of(g, x, y, z)] = ++count;
            }
    return count;
}

/* For each edge that crosses the skin, joins the four cells around it by two triangles. */
static uint32_t place_triangles(const grid *g, uint32_t *out)
{
    uint32_t count = 0;
    for (uint32_t z = 1; z + 1 < g->count[2]; ++z)
        for (uint32_t y = 1; y + 1 < g->count[1]; ++y)
            for (uint32_t x = 1; x + 1 < g->count[0]; ++x)
                for (int axis = 0; axis < 3; ++axis) {
                    uint32_t a[3] = {x, y, z}, b[3] = {x, y, z};
                    b[axis] += 1;
                    bool from = g->value[corner_of(g, a[0], a[1], a[2])] < 0.0f,
                         to = g->value[corner_of(g, b[0], b[1], b[2])] < 0.0f;
                    if (from == to)
                        continue;
                    uint32_t corner[4];
                    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                    for (uint32_t i = 0; i < 4; ++i) { /* around the edge */
                        uint32_t cell[3] = {x, y, z};
                        cell[u] -= i == 0 || i == 3;
                        cell[v] -= i < 2;
                        corner[from ? i : 3 - i] =
                            g->vertex[corner_of(g, cell[0], cell[1], cell[2])] - 1;
                    }
                    if (out) {
                        const uint32_t two[6] = {corner[0], corner[1], corner[2],
                                                 corner[0], corner[2], corner[3]};
                        memcpy(out + (size_t)3 * count, two, sizeof two);
                    }
                    count += 2;
                }
    return count;
}

static mrt_result make_mesh(mesh *out, const flesh *f, error *err)
{
    static const float skin[4] = {0.52f, 0.36f, 0.28f, 1.0f};
    grid g = {0};
    if (!fill_grid(&g, f)) {
        free(g.value);
        free(g.vertex);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    }
    uint32_t vertex_count = place_vertices(&g, NULL);
    mrt_result result = mesh_create(out, vertex_count, place_triangles(&g, NULL), err);
    if (result >= 0) {
        (void)place_vertices(&g, out->position);
        (void)place_triangles(&g, out->triangle);
        memcpy(out->material[0].base_colour, skin, sizeof skin);
        out->material[0].roughness = 0.75f;
    }
    free(g.value);
    free(g.vertex);
    return result;
}

/* ---- Figure 1: its picture ---- */

static const char *const finger_name[FINGERS] = {"thumb", "index", "middle", "ring", "little"};

static void draw_bones(offscreen *e, const draw_camera *camera, const flesh *f, uint32_t size)
{
    static const float line[4] = {0.30f, 0.72f, 1.0f, 0.95f}, dot[4] = {1.0f, 0.86f, 0.35f, 1.0f},
                       ink[4] = {0.95f, 0.96f, 0.98f, 1.0f};
    const uint32_t rectangle[4] = {0, 0, size, size};
    float at[MRT_JOINTS][2];
    draw_stroke stroke[2 * MRT_JOINTS];
    uint32_t count = 0;
    for (int i = 0; i < MRT_JOINTS; ++i) {
        const float point[3] = {f->joint[i].x, f->joint[i].y, f->joint[i].z};
        if (!draw_project(at[i], camera, rectangle, point))
            return;
    }
    float unit = (float)size / 900.0f;
    for (int i = 1; i < MRT_JOINTS; ++i) {
        int parent = (i - 1) % 4 == 0 ? 0 : i - 1;
        draw_stroke s = {.width_px = 5.0f * unit};
        memcpy(s.from, at[parent], sizeof s.from);
        memcpy(s.to, at[i], sizeof s.to);
        memcpy(s.rgba, line, sizeof line);
        stroke[count++] = s;
    }
    for (int i = 0; i < MRT_JOINTS; ++i) {
        draw_stroke s = {.width_px = (i == 0 ? 22.0f : 14.0f) * unit};
        memcpy(s.from, at[i], sizeof s.from);
        memcpy(s.to, at[i], sizeof s.to);
        memcpy(s.rgba, dot, sizeof dot);
        stroke[count++] = s;
    }
    draw_strokes(e->renderer, e->target, stroke, count);
    draw_text(e->renderer, e->target, "Parent (wrist)", at[0][0] + 20.0f * unit,
              at[0][1] - 12.0f * unit, 24.0f * unit, ink);
    for (int finger = 0; finger < FINGERS; ++finger) {
        const float *tip = at[4 + 4 * finger];
        float width = draw_text_width(e->renderer, finger_name[finger], 24.0f * unit);
        draw_text(e->renderer, e->target, finger_name[finger], tip[0] - 0.5f * width,
                  tip[1] - 46.0f * unit, 24.0f * unit, ink);
    }
}

/* Turns the hand upright: its fingers up, its palm away. */
static void stand_up(mesh *m, flesh *f)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        float *p = m->position + (size_t)3 * v, y = p[1];
        p[1] = p[2];
        p[2] = y;
        p[0] = -p[0];
    }
    for (int i = 0; i < MRT_JOINTS; ++i)
        f->joint[i] = (mrt_vec3){-f->joint[i].x, f->joint[i].z, f->joint[i].y};
}

static mrt_result draw_hand(paper *of, const char *path, mesh *m, flesh *f, error *err)
{
    uint32_t size = of->is_quick ? 300 : 900;
    float low[3], high[3];
    offscreen e;
    stand_up(m, f);
    mrt_result result = offscreen_init(&e, m, size, size, err);
    if (result < 0)
        return result;
    mesh_bounds(m, low, high);
    draw_camera camera = draw_camera_framing(low, high, 1.0f);
    camera.yaw_rad = -0.16f;
    camera.pitch_rad = 0.12f;
    draw_render(e.renderer, e.target, e.face, &camera, 0, 0, size, size);
    draw_bones(&e, &camera, f, size);
    result = offscreen_save(&e, path, err);
    offscreen_finish(&e);
    return result;
}

static mrt_result add_hand(paper *of, error *err)
{
    static const char name[] = "figure1_hand.png";
    char path[PATH_MAX];
    mesh m = {0};
    flesh f;
    page_heading(of->page, "Figure 1: a hand and its tree");
    if (!of->drawn_by[0]) {
        page_text(of->page, "No picture of the hand: %s", of->no_drawing.text);
        return MRT_OK;
    }
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM);
    if (!skeleton)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    pose_hand(&f, skeleton);
    hand_skeleton_destroy(skeleton);
    clothe(&f);
    mrt_result result = make_mesh(&m, &f, err);
    if (result >= 0)
        result = paper_add_file(of, path, name, err);
    if (result >= 0)
        result = draw_hand(of, path, &m, &f, err);
    mesh_destroy(&m);
    if (result >= 0)
        page_picture(of->page, name, "A right hand from its back, with the joints of its skeleton",
                     320, 560);
    return result;
}

/* ---- Figure 1: its tree ---- */

enum { TREE_WIDTH = 900, TREE_HEIGHT = 330, TREE_ROW = 52, TREE_TOP = 26, NODE_HEIGHT = 32 };

static void draw_node(svg *s, double x, double y, double width, const char *kind, const char *what)
{
    char words[64];
    (void)snprintf(words, sizeof words, "%s%s%s", kind, what[0] ? "  " : "", what);
    svg_box(s, SVG_WASH, SVG_LINE, x, y, width, NODE_HEIGHT);
    svg_words(s, SVG_INK, 14, SVG_MIDDLE, x + 0.5 * width, y + 21, words);
}

static mrt_result add_tree(paper *of, error *err)
{
    static const char name[] = "figure1_tree.svg",
                      what[] = "The tree of the hand: Parent, a PalmJoint for each finger, Joints "
                               "down to the fingertip";
    static const char *const thumb[4] = {"base", "knuckle", "joint", "tip"}, *const finger[4] = {
                                                                                 "knuckle",
                                                                                 "middle", "outer",
                                                                                 "tip"};
    char path[PATH_MAX];
    svg s;
    mrt_result result = paper_add_file(of, path, name, err);
    if (result >= 0)
        result = svg_open(&s, path, TREE_WIDTH, TREE_HEIGHT, what, err);
    if (result < 0)
        return result;
    const double middle = TREE_TOP + 2 * TREE_ROW + 0.5 * NODE_HEIGHT;
    for (int f = 0; f < FINGERS; ++f) {
        double y = TREE_TOP + f * TREE_ROW, centre = y + 0.5 * NODE_HEIGHT;
        svg_line(&s, SVG_CALM, 1.4, (double[]){176, middle}, (double[]){176, centre});
        svg_line(&s, SVG_CALM, 1.4, (double[]){176, centre}, (double[]){200, centre});
        for (int k = 0; k < 4; ++k) {
            double x = 392 + 124 * k;
            svg_line(&s, SVG_CALM, 1.4, (double[]){x - 24, centre}, (double[]){x, centre});
            draw_node(&s, x, y, 104, "Joint", f == 0 ? thumb[k] : finger[k]);
        }
        draw_node(&s, 200, y, 168, "PalmJoint", finger_name[f]);
    }
    svg_line(&s, SVG_CALM, 1.4, (double[]){144, middle}, (double[]){176, middle});
    draw_node(&s, 20, middle - 0.5 * NODE_HEIGHT, 124, "Parent", "wrist");
    svg_words(&s, SVG_CALM, 13, SVG_START, 20, TREE_HEIGHT - 22,
              "Each node stores its place in its parent in the default shape. A pose is "
              "computed from the wrist outwards, and not stored.");
    result = svg_finish(&s, err);
    if (result < 0)
        return result;
    page_picture(of->page, name, what, 640, 0);
    page_caption(of->page,
                 "Twenty-two angles of a glove turn the Joints (`core/hand/hand.c`). The hand "
                 "is %d mm long, and was given a surface for this picture. A performance needs "
                 "only its fingertips and, optionally, eight points of its palm.",
                 HAND_LENGTH_MM);
    return MRT_OK;
}

/* ---- Figure 2 ---- */

enum { FLOW_WIDTH = 900, FLOW_HEIGHT = 760, FLOW_BOX = 64 };

static void draw_step(svg *s, double x, double y, double width, const char *title,
                      const char *where)
{
    svg_box(s, SVG_WASH, SVG_LINE, x, y, width, FLOW_BOX);
    svg_strong_words(s, SVG_INK, 14.5, SVG_MIDDLE, x + 0.5 * width, y + 27, title);
    svg_words(s, SVG_CALM, 12.5, SVG_MIDDLE, x + 0.5 * width, y + 48, where);
}

static void draw_down(svg *s, double x, double from, double to)
{
    svg_arrow(s, SVG_CALM, (double[]){x, from}, (double[]){x, to});
}

typedef struct flow_step {
    const char *title, *where;
} flow_step;

/* Draws one of the two ways, from the top down and back again. */
static void draw_way(svg *s, svg_ink ink, double x, double width, const char *title,
                     const flow_step step[4], const char *back, double back_x)
{
    const double top = 270, pitch = 92, middle = x + 0.5 * width;
    svg_strong_words(s, ink, 16, SVG_MIDDLE, middle, top - 14, title);
    for (int i = 0; i < 4; ++i) {
        double y = top + pitch * i;
        draw_step(s, x, y, width, step[i].title, step[i].where);
        if (i > 0)
            draw_down(s, middle, y - pitch + FLOW_BOX, y);
    }
    double last = top + 3 * pitch + 0.5 * FLOW_BOX, first = top + 0.5 * FLOW_BOX;
    double edge = back_x < x ? x : x + width;
    svg_line(s, ink, 1.8, (double[]){edge, last}, (double[]){back_x, last});
    svg_line(s, ink, 1.8, (double[]){back_x, last}, (double[]){back_x, first});
    svg_arrow(s, ink, (double[]){back_x, first}, (double[]){edge, first});
    svg_words_upwards(s, ink, 13, back_x < x ? back_x - 8 : back_x + 18, 0.5 * (first + last),
                      back);
}

static mrt_result add_flow(paper *of, error *err)
{
    static const char name[] = "figure2_data.svg",
                      what[] = "The data flow: from the gloves over the fingertips to the face, "
                               "anchored and unanchored";
    static const flow_step anchored[4] = {
        {"Within radius? Tested once, for the starts", "s := tips; no vertex near: wait"},
        {"Sort, factor, unit responses B", "core/csrbf: once for each hold"},
        {"Shown := base + B (tips − s)", "every frame; never from the last frame"},
        {"Commit: base := shown", "the pedal or key; nothing jumps"},
    };
    static const flow_step unanchored[4] = {
        {"Within radius? Tested for every sample", "no tip near the shape shown: nothing moves"},
        {"s := last tips, e := tips", "every sample of the gloves counts"},
        {"Sort, factor, solve", "core/csrbf: in steps that do not fold"},
        {"Shown := shown + d (shown)", "clay: every push stays"},
    };
    char path[PATH_MAX];
    svg s;
    mrt_result result = paper_add_file(of, path, name, err);
    if (result >= 0)
        result = svg_open(&s, path, FLOW_WIDTH, FLOW_HEIGHT, what, err);
    if (result < 0)
        return result;
    draw_step(&s, 30, 30, 250, "Two gloves: 2 × 22 angles", "plugins: cyberglove, log, osc ...");
    draw_step(&s, 325, 30, 250, "Calibrate, filter, pose", "core/hand");
    draw_step(&s, 620, 30, 250, "Ten fingertips on the face", "plugins: anchored, unanchored");
    svg_arrow(&s, SVG_CALM, (double[]){280, 62}, (double[]){325, 62});
    svg_arrow(&s, SVG_CALM, (double[]){575, 62}, (double[]){620, 62});
    svg_line(&s, SVG_CALM, 1.6, (double[]){745, 94}, (double[]){745, 150});
    svg_line(&s, SVG_CALM, 1.6, (double[]){255, 150}, (double[]){745, 150});
    draw_down(&s, 255, 150, 234);
    draw_down(&s, 645, 150, 234);
    svg_words(&s, SVG_CALM, 13, SVG_MIDDLE, 450, 172, "one mapping or the other; samples are");
    svg_words(&s, SVG_CALM, 13, SVG_MIDDLE, 450, 190, "performed in the order of their times");
    draw_way(&s, SVG_FIRST, 85, 340, "Anchored", anchored,
             "save the shape, return to the first step", 50);
    draw_way(&s, SVG_SECOND, 475, 340, "Unanchored", unanchored, "next sample", 850);
    draw_down(&s, 255, 610, 676);
    draw_down(&s, 645, 610, 676);
    draw_step(&s, 85, 676, 730, "Normals, picture, exports", "core/mesh, ui/draw, core/io");
    result = svg_finish(&s, err);
    if (result < 0)
        return result;
    page_heading(of->page, "Figure 2: the data flow");
    page_picture(of->page, name, what, 640, 0);
    page_caption(
        of->page,
        "“Within Radius?” is a question about end points in the flow chart of the paper. If it "
        "were tested for every frame in the anchored way, the face would freeze as soon as a "
        "finger pulls further than R. So there it is tested once, for the starts, when the "
        "hands take hold. In the unanchored way the end points of a sample are the start points "
        "of the next, and it is tested each time.");
    return MRT_OK;
}

mrt_result paper_hands(paper *of, error *err)
{
    mrt_result result = add_hand(of, err);
    if (result >= 0)
        result = add_tree(of, err);
    return result < 0 ? result : add_flow(of, err);
}
