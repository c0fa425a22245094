#include "cli/rigpicture.h"

#include "base/srgb.h"
#include "draw/offscreen.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { /* pixels */
       MARGIN = 14,
       LABEL_SIZE = 17,
       LABEL_GAP = 19,
       TITLE_SIZE = 24,
       LEGEND_SIZE = 18,
       LEGEND_TOP = 42,
       MADE_TOP = 72,
       MADE_SIZE = 15,
       SWATCH = 16
};
enum { LABELS_MAX = RIGPICTURE_LABELS_MAX, STROKES_PER_LABEL = 3, RIM_STROKES = 96 };
static const float ink[4] = {0.90f, 0.91f, 0.93f, 1.0f}, faint[4] = {0.62f, 0.64f, 0.68f, 1.0f};
static const float leader[4] = {0.85f, 0.86f, 0.90f, 0.45f};
static const float dot[4] = {1.0f, 0.96f, 0.55f, 1.0f}, rim[4] = {0.05f, 0.05f, 0.06f, 1.0f};
static const float axis_ink[4] = {1.0f, 0.35f, 0.75f, 1.0f};
static const float upper_ink[4] = {1.0f, 1.0f, 1.0f, 1.0f},
                   lower_ink[4] = {1.0f, 0.75f, 0.1f, 1.0f};

typedef struct label {
    const char *name;
    float at[2];
    bool is_right; /* the label is at the right edge of its view; half of the labels are */
} label;

typedef struct picture {
    const rig *r;
    const mesh *m;
    const binding *b;
    offscreen offscreen;
    label *label; /* labels of one view */
    uint32_t label_count;
    draw_stroke *stroke;
    uint32_t stroke_count;
    float *number; /* scratch, LABELS_MAX by 2 */
    float *rgb;    /* vertex_count by 3 */
    const rigpicture_about *about;
    uint32_t view_width, view_height; /* pixels */
} picture;

/* ---- colours ---- */

rigpicture_colour rigpicture_bone_colour(const rig *r, uint32_t bone)
{
    static const rigpicture_colour skull = {{0.05f, 0.22f, 0.80f}}, jaw = {{0.85f, 0.08f, 0.04f}};
    static const rigpicture_colour others[] = {{{0.03f, 0.50f, 0.12f}}, {{0.80f, 0.45f, 0.02f}},
                                               {{0.40f, 0.06f, 0.70f}}, {{0.02f, 0.50f, 0.55f}},
                                               {{0.70f, 0.05f, 0.35f}}, {{0.35f, 0.45f, 0.03f}}};
    if (strcmp(r->bone[bone].name, "skull") == 0)
        return skull;
    if (r->bone[bone].kind == BONE_JAW)
        return jaw;
    return others[bone % (sizeof others / sizeof *others)];
}

/* Mixes the colours of the bones by weight, and adds grey where the mobility is low. */
static void colour_vertices(picture *p)
{
    for (uint32_t v = 0; v < p->m->vertex_count; ++v) {
        float mixed[3] = {0.0f, 0.0f, 0.0f};
        for (uint32_t bone = 0; bone < p->b->bone_count; ++bone) {
            rigpicture_colour colour = rigpicture_bone_colour(p->r, bone);
            float weight = p->b->weight[(size_t)bone * p->m->vertex_count + v];
            for (int i = 0; i < 3; ++i)
                mixed[i] += weight * colour.rgb[i];
        }
        float grey = 0.45f, strength = 0.18f + 0.82f * p->b->mobility[v];
        for (int i = 0; i < 3; ++i)
            p->rgb[(size_t)v * 3 + (size_t)i] = grey + strength * (mixed[i] - grey);
    }
}

/* ---- labels ---- */

/* Labels that touch each other and move together. */
typedef struct label_pile {
    double wanted; /* mean of the wanted positions of its first label */
    uint32_t count;
} label_pile;

/* Least squares: piles that would overlap are merged, at the mean of their wanted positions (pool
 * adjacent violators). */
static uint32_t pile_up(label_pile *pile, const float *wanted, uint32_t count, double gap)
{
    uint32_t pile_count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        label_pile last = {(double)wanted[i] - gap * (double)i, 1};
        while (pile_count > 0 && pile[pile_count - 1].wanted > last.wanted) {
            label_pile before = pile[--pile_count];
            uint32_t both = before.count + last.count;
            last.wanted = (before.wanted * before.count + last.wanted * last.count) / both;
            last.count = both;
        }
        pile[pile_count++] = last;
    }
    return pile_count;
}

void rigpicture_spread(float *out_y, const float *wanted, uint32_t count, float gap, float low,
                       float high)
{
    label_pile pile[RIGPICTURE_LABELS_MAX];
    uint32_t pile_count = pile_up(pile, wanted, count, (double)gap), i = 0;
    double most = (double)high - (double)gap * ((double)count - 1.0);
    for (uint32_t k = 0; k < pile_count; ++k) {
        double top = fmax(fmin(pile[k].wanted, most), (double)low); /* too many: from `low` on */
        for (uint32_t end = i + pile[k].count; i < end; ++i)
            out_y[i] = (float)(top + (double)gap * (double)i);
    }
}

static int compare_labels(const void *left, const void *right)
{
    const label *a = left, *b = right;
    if (a->is_right != b->is_right)
        return a->is_right ? 1 : -1;
    if (a->at[1] < b->at[1] || a->at[1] > b->at[1])
        return a->at[1] < b->at[1] ? -1 : 1;
    return strcmp(a->name, b->name);
}

static int compare_across(const void *left, const void *right)
{
    const label *a = left, *b = right;
    if (a->at[0] < b->at[0] || a->at[0] > b->at[0])
        return a->at[0] < b->at[0] ? -1 : 1;
    return strcmp(a->name, b->name);
}

static void add_stroke(picture *p, const float from[2], const float to[2], float width_px,
                       const float rgba[4])
{
    draw_stroke *out = &p->stroke[p->stroke_count++];
    *out = (draw_stroke){.from = {from[0], from[1]}, .to = {to[0], to[1]}, .width_px = width_px};
    memcpy(out->rgba, rgba, sizeof out->rgba);
}

static vec3 vertex_position(const mesh *m, uint32_t vertex)
{
    const float *p = m->position + (size_t)vertex * 3;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static double height_of(const mesh *m)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    return (double)high[1] - (double)low[1];
}

/* Returns the distance along the unit direction from a point to the triangle; < 0: no hit. */
static double ray_meets(vec3 from, vec3 direction, const vec3 corner[3])
{
    vec3 a = vec3_sub(corner[1], corner[0]), b = vec3_sub(corner[2], corner[0]);
    vec3 cross = vec3_cross(direction, b);
    double determinant = vec3_dot(a, cross);
    if (!(fabs(determinant) > 1e-12))
        return -1.0;
    vec3 s = vec3_sub(from, corner[0]), t = vec3_cross(s, a);
    double u = vec3_dot(s, cross) / determinant, v = vec3_dot(direction, t) / determinant;
    if (!(u >= 0.0 && v >= 0.0 && u + v <= 1.0))
        return -1.0;
    return vec3_dot(b, t) / determinant;
}

/* Returns whether the contact is visible from the eye. Ignores triangles close to the contact. */
static bool is_visible(const picture *p, vec3 at, const draw_camera *camera)
{
    const double near_mm = 0.05 * height_of(p->m); /* brows are on the skin */
    double yaw = (double)camera->yaw_rad, pitch = (double)camera->pitch_rad;
    vec3 back = {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)};
    vec3 target = {(double)camera->target[0], (double)camera->target[1], (double)camera->target[2]};
    vec3 eye = vec3_add(target, vec3_scale(back, (double)camera->distance_mm));
    vec3 direction = vec3_normalised(vec3_sub(eye, at), back);
    for (uint32_t i = 0; i < p->m->triangle_count; ++i) {
        vec3 corner[3];
        for (size_t k = 0; k < 3; ++k)
            corner[k] = vertex_position(p->m, p->m->triangle[(size_t)i * 3 + k]);
        if (ray_meets(at, direction, corner) > near_mm)
            return false;
    }
    return true;
}

static void collect_labels(picture *p, const draw_camera *camera, const uint32_t rectangle[4])
{
    p->label_count = 0;
    for (uint32_t i = 0; i < p->r->contact_count && p->label_count < LABELS_MAX; ++i) {
        vec3 at = p->b->contact_position[i];
        float point[3] = {(float)at.x, (float)at.y, (float)at.z};
        label *l = &p->label[p->label_count];
        if (!is_visible(p, at, camera) || !draw_project(l->at, camera, rectangle, point))
            continue;
        l->name = p->r->contact[i].name;
        p->label_count += 1;
    }
    qsort(p->label, p->label_count, sizeof *p->label, compare_across);
    for (uint32_t i = 0; i < p->label_count; ++i)
        p->label[i].is_right = i >= (p->label_count + 1) / 2;
    qsort(p->label, p->label_count, sizeof *p->label, compare_labels);
}

/* Places the labels of one side in a column at the edge of the view, with lines to their
 * contacts. */
static void place_column(picture *p, uint32_t first, uint32_t count, const uint32_t rectangle[4])
{
    float *wanted = p->number, *y = p->number + LABELS_MAX;
    for (uint32_t i = 0; i < count; ++i)
        wanted[i] = p->label[first + i].at[1];
    rigpicture_spread(y, wanted, count, LABEL_GAP, (float)rectangle[1] + MARGIN + LABEL_SIZE,
                      (float)(rectangle[1] + rectangle[3]) - 3 * LABEL_SIZE);
    for (uint32_t i = 0; i < count; ++i) {
        const label *l = &p->label[first + i];
        float width = draw_text_width(p->offscreen.renderer, l->name, LABEL_SIZE);
        float left = l->is_right ? (float)(rectangle[0] + rectangle[2]) - MARGIN - width
                                 : (float)rectangle[0] + MARGIN;
        float end[2] = {l->is_right ? left - 5.0f : left + width + 5.0f, y[i]};
        add_stroke(p, end, l->at, 1.4f, leader);
        add_stroke(p, l->at, l->at, 11.0f, rim);
        add_stroke(p, l->at, l->at, 7.5f, dot);
        draw_text(p->offscreen.renderer, p->offscreen.target, l->name, left,
                  y[i] - 0.55f * LABEL_SIZE, LABEL_SIZE, ink);
    }
}

static void draw_axis(picture *p, const draw_camera *camera, const uint32_t rectangle[4])
{
    for (uint32_t i = 0; i < p->r->bone_count; ++i) {
        const rig_bone *bone = &p->r->bone[i];
        if (bone->kind != BONE_JAW)
            continue;
        vec3 beyond = vec3_scale(vec3_sub(bone->hinge_left, bone->hinge_right), 0.25);
        vec3 ends[4] = {vec3_add(bone->hinge_left, beyond), vec3_sub(bone->hinge_right, beyond),
                        bone->hinge_left, bone->hinge_right};
        float px[4][2];
        for (int k = 0; k < 4; ++k) {
            float point[3] = {(float)ends[k].x, (float)ends[k].y, (float)ends[k].z};
            if (!draw_project(px[k], camera, rectangle, point))
                return;
        }
        add_stroke(p, px[0], px[1], 2.5f, axis_ink);
        add_stroke(p, px[2], px[2], 13.0f, axis_ink);
        add_stroke(p, px[3], px[3], 13.0f, axis_ink);
        return;
    }
}

/* Draws the rims of the mouth: the upper one white, the lower one yellow. */
static void draw_rims(picture *p, const draw_camera *camera, const uint32_t rectangle[4])
{
    const bind_lips *lips = &p->b->lips;
    for (int lip = 0; lip < 2; ++lip) {
        float px[2][2];
        bool was_seen = false;
        for (uint32_t i = 0; i < lips->station_count; ++i) {
            vec3 at = bind_station_position(lip == 0 ? &lips->upper[i] : &lips->lower[i], p->m);
            float point[3] = {(float)at.x, (float)at.y, (float)at.z};
            bool is_seen =
                is_visible(p, at, camera) && draw_project(px[i % 2], camera, rectangle, point);
            if (is_seen && was_seen && p->stroke_count < RIM_STROKES)
                add_stroke(p, px[(i + 1) % 2], px[i % 2], 2.5f, lip == 0 ? upper_ink : lower_ink);
            was_seen = is_seen;
        }
    }
}

/* ---- views ---- */

static void draw_view(picture *p, const rigpicture_view *view, uint32_t index)
{
    const uint32_t rectangle[4] = {index * p->view_width, RIGPICTURE_HEADER, p->view_width,
                                   p->view_height};
    float low[3], high[3];
    mesh_focus(p->m, low, high);
    const float aspect = (float)p->view_width / (float)p->view_height;
    draw_camera camera = draw_camera_framing(low, high, 0.74f * aspect); /* room for labels */
    camera.yaw_rad = view->yaw_rad;
    camera.pitch_rad = view->pitch_rad;
    draw_render(p->offscreen.renderer, p->offscreen.target, p->offscreen.face, &camera,
                rectangle[0], rectangle[1], rectangle[2], rectangle[3]);
    p->stroke_count = 0;
    draw_rims(p, &camera, rectangle);
    draw_axis(p, &camera, rectangle);
    collect_labels(p, &camera, rectangle);
    uint32_t left_count = 0;
    while (left_count < p->label_count && !p->label[left_count].is_right)
        left_count += 1;
    place_column(p, 0, left_count, rectangle);
    place_column(p, left_count, p->label_count - left_count, rectangle);
    draw_strokes(p->offscreen.renderer, p->offscreen.target, p->stroke, p->stroke_count);
    char words[64];
    const double degree = 57.29577951308232;
    (void)snprintf(words, sizeof words, "yaw %.0f°  pitch %.0f°", (double)view->yaw_rad * degree,
                   (double)view->pitch_rad * degree);
    draw_text(p->offscreen.renderer, p->offscreen.target, words, (float)rectangle[0] + MARGIN,
              (float)(rectangle[1] + rectangle[3]) - 30.0f, LABEL_SIZE, faint);
}

static void draw_legend(picture *p)
{
    float x = MARGIN;
    char words[160];
    (void)snprintf(words, sizeof words,
                   "%s: colours show which bone moves the skin; pale: "
                   "cannot be pulled",
                   p->r->name);
    const float room = (float)p->offscreen.width - 2 * MARGIN;
    offscreen_words(&p->offscreen, words, x, 10.0f, TITLE_SIZE, room, ink);
    offscreen_words(&p->offscreen, p->about->made_from, x, MADE_TOP, MADE_SIZE, room, faint);
    p->stroke_count = 0;
    for (uint32_t i = 0; i < p->r->bone_count; ++i) {
        rigpicture_colour colour = rigpicture_bone_colour(p->r, i);
        float rgba[4] = {0.0f, 0.0f, 0.0f, 1.0f};
        for (int k = 0; k < 3; ++k)
            rgba[k] = (float)srgb_from_linear((double)colour.rgb[k]);
        float at[2] = {x + 0.5f * SWATCH, LEGEND_TOP + 0.6f * LEGEND_SIZE};
        float width = draw_text_width(p->offscreen.renderer, p->r->bone[i].name, LEGEND_SIZE);
        if (x + SWATCH + width + 40.0f > (float)p->offscreen.width)
            break;
        add_stroke(p, at, at, SWATCH, rgba);
        draw_text(p->offscreen.renderer, p->offscreen.target, p->r->bone[i].name, x + SWATCH + 6.0f,
                  LEGEND_TOP, LEGEND_SIZE, faint);
        x += SWATCH + width + 30.0f;
    }
    draw_strokes(p->offscreen.renderer, p->offscreen.target, p->stroke, p->stroke_count);
}

static void finish(picture *p)
{
    offscreen_finish(&p->offscreen);
    free(p->label);
    free(p->stroke);
    free(p->number);
    free(p->rgb);
}

static mrt_result init(picture *p, uint32_t view_count, error *err)
{
    p->label = calloc(LABELS_MAX, sizeof *p->label);
    p->stroke = calloc((LABELS_MAX + 4) * STROKES_PER_LABEL + RIM_STROKES, sizeof *p->stroke);
    p->number = calloc((size_t)LABELS_MAX * 2, sizeof *p->number);
    p->rgb = calloc((size_t)p->m->vertex_count * 3 + 1, sizeof *p->rgb);
    if (!p->label || !p->stroke || !p->number || !p->rgb)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the picture");
    uint32_t width = p->about->width ? p->about->width : view_count * RIGPICTURE_WIDTH;
    uint32_t height = p->about->height ? p->about->height : RIGPICTURE_HEADER + RIGPICTURE_HEIGHT;
    p->view_width = width / view_count;
    if (height < 2 * RIGPICTURE_HEADER || p->view_width < RIGPICTURE_HEADER)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a picture of a rig and its names takes at least %u by %u pixels",
                         view_count * RIGPICTURE_HEADER, 2 * RIGPICTURE_HEADER);
    p->view_height = height - RIGPICTURE_HEADER;
    return offscreen_init(&p->offscreen, p->m, width, height, err);
}

mrt_result rigpicture_write(const char *path, const rig *r, const mesh *m, const binding *b,
                            const rigpicture_view *view, uint32_t view_count,
                            const rigpicture_about *about, error *err)
{
    picture p = {.r = r, .m = m, .b = b, .about = about};
    mrt_result result = init(&p, view_count, err);
    if (result >= 0) {
        colour_vertices(&p);
        draw_face_colour(p.offscreen.face, p.rgb);
        for (uint32_t i = 0; i < view_count; ++i)
            draw_view(&p, &view[i], i);
        draw_legend(&p);
        result = offscreen_save(&p.offscreen, path, err);
    }
    finish(&p);
    return result;
}

/* ---- portraits of its poses ---- */

/* Shares of the width of a panel, and of the height of a header. */
static const float name_size = 0.065f, name_top = 0.0175f, name_margin = 0.04f;
static const float title_size = 0.28f, made_size = 0.16f, header_margin = 0.13f;
static const float least_px = 9; /* letters smaller than this are unreadable */
static const double field_of_view_rad = 0.42;
static const double air = 0.025; /* margin at each touched edge, as a share of a panel */
static const float title_ink[4] = {0.92f, 0.93f, 0.95f, 1.0f};

rigpicture_view rigportraits_default_view(void)
{
    return (rigpicture_view){.yaw_rad = 0.349f, .pitch_rad = 0.035f}; /* 20 and 2 degrees */
}

/* ---- framing ---- */

typedef struct view_axes {
    vec3 axis[3]; /* right, up, towards the eye */
} view_axes;

static view_axes axes_of(rigpicture_view view)
{
    double yaw = (double)view.yaw_rad, pitch = (double)view.pitch_rad;
    return (view_axes){{{cos(yaw), 0.0, -sin(yaw)},
                        {-sin(yaw) * sin(pitch), cos(pitch), -cos(yaw) * sin(pitch)},
                        {sin(yaw) * cos(pitch), sin(pitch), cos(yaw) * cos(pitch)}}};
}

rigportraits_frame rigportraits_frame_empty(rigpicture_view view)
{
    const double slope = tan(0.5 * field_of_view_rad) * (1.0 - 2.0 * air);
    return (rigportraits_frame){.view = view,
                                .slope = {slope * RIGPORTRAITS_WIDTH / RIGPORTRAITS_HEIGHT, slope},
                                .reach = {-INFINITY, -INFINITY, -INFINITY, -INFINITY},
                                .depth = {INFINITY, -INFINITY}};
}

/* gcc 12 for arm64 fails (an internal error) where it vectorises fmin and fmax in such loops. */
static double greater(double a, double b)
{
    return b > a ? b : a;
}

/* A point is inside the right edge of a view at distance d if right <= slope (d - depth). So the
 * greatest value of right + slope depth is stored. The other edges are computed the same way. */
void rigportraits_frame_add(rigportraits_frame *self, const float *position, uint32_t vertex_count)
{
    view_axes axes = axes_of(self->view);
    for (uint32_t v = 0; v < vertex_count; ++v) {
        const float *p = position + (size_t)v * 3;
        vec3 at = {(double)p[0], (double)p[1], (double)p[2]};
        double depth = vec3_dot(at, axes.axis[2]);
        for (int i = 0; i < 2; ++i) {
            double along = vec3_dot(at, axes.axis[i]), nearer = self->slope[i] * depth;
            self->reach[2 * i] = greater(self->reach[2 * i], nearer + along);
            self->reach[2 * i + 1] = greater(self->reach[2 * i + 1], nearer - along);
        }
        self->depth[0] = -greater(-self->depth[0], -depth);
        self->depth[1] = greater(self->depth[1], depth);
    }
}

draw_camera rigportraits_frame_camera(const rigportraits_frame *self)
{
    draw_camera camera = {.distance_mm = 1.0f,
                          .yaw_rad = self->view.yaw_rad,
                          .pitch_rad = self->view.pitch_rad,
                          .field_of_view_rad = (float)field_of_view_rad};
    if (!(self->depth[1] >= self->depth[0]))
        return camera; /* empty frame */
    view_axes axes = axes_of(self->view);
    double middle = 0.5 * (self->depth[0] + self->depth[1]), eye = self->depth[1] + 1.0;
    vec3 target = vec3_scale(axes.axis[2], middle);
    for (int i = 0; i < 2; ++i) {
        const double *reach = self->reach + (size_t)2 * (size_t)i;
        target = vec3_add(target, vec3_scale(axes.axis[i], 0.5 * (reach[0] - reach[1])));
        eye = fmax(eye, 0.5 * (reach[0] + reach[1]) / self->slope[i]);
    }
    camera.target[0] = (float)target.x;
    camera.target[1] = (float)target.y;
    camera.target[2] = (float)target.z;
    camera.distance_mm = (float)(eye - middle);
    return camera;
}

/* ---- the picture ---- */

/* Lays out the panels in this number of columns, as large as possible. */
static rigportraits_grid lay_out_columns(rigportraits_grid g, uint32_t count, uint32_t column_count)
{
    const float caption = (float)RIGPORTRAITS_CAPTION / RIGPORTRAITS_WIDTH;
    const float aspect = (float)RIGPORTRAITS_HEIGHT / RIGPORTRAITS_WIDTH;
    g.columns = column_count;
    g.rows = (count + column_count - 1) / column_count;
    float across = (float)g.width / (float)column_count;
    float down = (float)(g.height - g.header) / (float)g.rows / (aspect + caption);
    float panel = floorf(fmaxf(fminf(across, down) + 1e-3f, 1.0f));
    g.panel_width = (uint32_t)panel;
    g.panel_height = (uint32_t)fmaxf(panel * aspect, 1.0f);
    g.caption = (uint32_t)(panel * caption);
    uint32_t used_across = g.columns * g.panel_width;
    uint32_t used_down = g.header + g.rows * (g.panel_height + g.caption);
    g.left = used_across < g.width ? (g.width - used_across) / 2 : 0;
    g.top = g.header + (used_down < g.height ? (g.height - used_down) / 2 : 0);
    return g;
}

rigportraits_grid rigportraits_lay_out(uint32_t count, uint32_t width, uint32_t height)
{
    rigportraits_grid g = {.width = width, .height = height};
    uint32_t usual = count < RIGPORTRAITS_COLUMNS ? count : RIGPORTRAITS_COLUMNS;
    if (width == 0) {
        uint32_t rows = (count + usual - 1) / usual;
        if (count > RIGPORTRAITS_FEW) {
            rows = (count + RIGPORTRAITS_COLUMNS_OF_MANY - 1) / RIGPORTRAITS_COLUMNS_OF_MANY;
            usual = RIGPORTRAITS_COLUMNS_OF_MANY;
        }
        uint32_t part = count > RIGPORTRAITS_FEW ? 2 : 1;
        g.width = usual * RIGPORTRAITS_WIDTH / part;
        g.header = RIGPORTRAITS_HEADER;
        g.height = g.header + rows * (RIGPORTRAITS_HEIGHT + RIGPORTRAITS_CAPTION) / part;
        return lay_out_columns(g, count, usual);
    }
    float header = fminf(RIGPORTRAITS_HEADER * (float)width / (4.0f * RIGPORTRAITS_WIDTH),
                         0.12f * (float)height);
    header = fmaxf(header, least_px / made_size);
    g.header = header < 0.25f * (float)height ? (uint32_t)header : 0;
    rigportraits_grid best = lay_out_columns(g, count, 1);
    for (uint32_t column_count = 2; column_count <= count; ++column_count) {
        rigportraits_grid other = lay_out_columns(g, count, column_count);
        best = other.panel_width > best.panel_width ? other : best;
    }
    return best;
}

/* Writes the title, and two lines that explain how to repeat the picture. */
static void write_header(offscreen *e, const rigportraits_grid *g, const rigpicture_about *about)
{
    const float unit = (float)g->header, margin = header_margin * unit;
    const float width = (float)g->width - 2 * margin;
    const float title = fmaxf(title_size * unit, least_px);
    if (g->header == 0)
        return;
    offscreen_words(e, about->title, margin, 0.5f * margin, title, width, title_ink);
    offscreen_paragraph(e, about->made_from, margin, 0.5f * margin + offscreen_line_px(title),
                        fmaxf(made_size * unit, least_px), width, 2, faint);
}

static mrt_result draw_portrait(offscreen *e, const rigportraits_grid *g, rig_poses_stage *stage,
                                uint32_t pose, const draw_camera *camera, error *err)
{
    mrt_result result = rig_poses_show(stage, pose, err);
    if (result < 0)
        return result;
    const uint32_t x = g->left + pose % g->columns * g->panel_width;
    const uint32_t y = g->top + pose / g->columns * (g->panel_height + g->caption);
    if (x + g->panel_width > g->width || y + g->panel_height > g->height)
        return MRT_OK; /* the picture is too small for this pose */
    const char *name = stage->rig.pose[pose].name;
    const float panel = (float)g->panel_width, size = fmaxf(name_size * panel, least_px);
    const float room = (1.0f - 2.0f * name_margin) * panel;
    draw_face_update(e->face, stage->position, NULL);
    draw_render(e->renderer, e->target, e->face, camera, x, y, g->panel_width, g->panel_height);
    float width = fminf(draw_text_width(e->renderer, name, size), room);
    if ((float)g->caption >= size)
        offscreen_words(e, name, (float)x + 0.5f * (panel - width),
                        (float)(y + g->panel_height) + name_top * panel, size, room, title_ink);
    return MRT_OK;
}

mrt_result rigportraits_write(const char *path, rig_poses_stage *stage, uint32_t count,
                              const rigportraits_frame *frame, const rigpicture_about *about,
                              error *err)
{
    const rigportraits_grid g = rigportraits_lay_out(count, about->width, about->height);
    draw_camera camera = rigportraits_frame_camera(frame);
    offscreen e;
    mrt_result result = offscreen_init(&e, stage->mesh, g.width, g.height, err);
    if (result < 0)
        return result;
    write_header(&e, &g, about);
    for (uint32_t i = 0; result >= 0 && i < count; ++i)
        result = draw_portrait(&e, &g, stage, i, &camera, err);
    if (result >= 0)
        result = offscreen_save(&e, path, err);
    offscreen_finish(&e);
    return result;
}
