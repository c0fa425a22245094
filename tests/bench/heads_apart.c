/* heads_apart FACE FRAMES.pc2: of a performance that was exported as a vertex cache, how far the
 * vertices of one point of the surface ever part, how far what is rigid on a bone (teeth, eyes,
 * hair) is bent (the greatest change of a distance between two of its vertices), and how far the
 * lips pass into each other, further than at rest (0: the rig has no mouth). mm, three numbers. */
#include "face/bind.h"
#include "mesh/position.h"
#include "stage/perform/face_file.h"
#include "unit/slit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct frames {
    FILE *file;
    uint32_t vertex_count, count;
    float *at; /* vertex_count by 3 */
} frames;

static bool open_frames(frames *f, const char *path, uint32_t vertex_count)
{
    struct {
        char magic[12];
        int32_t version, points;
        float start, rate;
        int32_t samples;
    } head;
    f->file = fopen(path, "rb");
    if (!f->file || fread(&head, sizeof head, 1, f->file) != 1 ||
        memcmp(head.magic, "POINTCACHE2", 12) != 0 || head.points != (int32_t)vertex_count)
        return false;
    *f = (frames){f->file, vertex_count, (uint32_t)head.samples,
                  malloc((size_t)vertex_count * 3 * sizeof(float))};
    return f->at != NULL;
}

static double distance(const float *at, uint32_t a, uint32_t b)
{
    double square = 0.0;
    for (size_t i = 0; i < 3; ++i) {
        double d = (double)at[3 * (size_t)a + i] - (double)at[3 * (size_t)b + i];
        square += d * d;
    }
    return sqrt(square);
}

/* ---- lips ---- */

/* Three vertices that are rigid on the skull: they say how the head is turned. */
typedef struct skull {
    uint32_t vertex[3];
    bool is_known;
} skull;

static vec3 row_at(const float *at, uint32_t vertex)
{
    const float *p = at + (size_t)3 * vertex;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static skull find_skull(const face_file *head, const bind_marks *marks)
{
    const mesh *m = &head->mesh;
    const uint32_t bone = rig_find_bone(head->rig, "skull");
    skull out = {{0, 0, 0}, false};
    uint32_t first = 0;
    double longest = 0.0, widest = 0.0;
    while (first < m->vertex_count && marks->rigid_bone[first] != bone)
        ++first;
    if (bone == RIG_NONE || first == m->vertex_count)
        return out;
    out.vertex[0] = out.vertex[1] = first;
    for (int k = 1; k < 3; ++k)
        for (uint32_t v = first; v < m->vertex_count; ++v) {
            if (marks->rigid_bone[v] != bone)
                continue;
            vec3 a = vec3_sub(mesh_position(m, out.vertex[1]), mesh_position(m, first));
            vec3 b = vec3_sub(mesh_position(m, v), mesh_position(m, first));
            double length = vec3_length(b), area = vec3_length(vec3_cross(a, b));
            if (k == 1 ? length > longest : area > widest)
                out.vertex[k] = v;
            longest = k == 1 ? fmax(longest, length) : longest;
            widest = k == 2 ? fmax(widest, area) : widest;
        }
    out.is_known = widest > 1.0;
    return out;
}

static void axes_of(vec3 out[3], const skull *s, const float *at)
{
    const vec3 from = row_at(at, s->vertex[0]);
    const vec3 a = vec3_sub(row_at(at, s->vertex[1]), from);
    const vec3 b = vec3_sub(row_at(at, s->vertex[2]), from);
    out[0] = vec3_normalised(a, (vec3){1, 0, 0});
    out[2] = vec3_normalised(vec3_cross(a, b), (vec3){0, 0, 1});
    out[1] = vec3_cross(out[2], out[0]);
}

typedef struct upright {
    const float *at;
    vec3 now[3], rest[3];
} upright;

/* Turned back with the skull; the place of the head does not matter. */
static vec3 upright_place(const void *of, uint32_t vertex)
{
    const upright *u = of;
    const vec3 p = row_at(u->at, vertex);
    vec3 out = {0, 0, 0};
    for (int i = 0; i < 3; ++i)
        out = vec3_add(out, vec3_scale(u->rest[i], vec3_dot(u->now[i], p)));
    return out;
}

/* False: a rim does not reach from corner to corner. */
static bool measure_lips(slit *out, const face_file *head, const skull *s, const float *at)
{
    upright place = {.at = at};
    axes_of(place.now, s, at);
    axes_of(place.rest, s, head->mesh.position);
    return slit_measure(out, &head->rig->mouth, upright_place, &place);
}

int main(int argc, char **argv)
{
    enum { PAIRS = 4000 };
    face_file head;
    bind_marks marks;
    frames f;
    error err = {""};
    if (argc != 3 || face_file_read(&head, argv[1], NULL, FACE_FILE_USABLE, &err) < 0 ||
        !head.rig || bind_marks_create(&marks, head.rig, &head.mesh, &head.topology, &err) < 0 ||
        !open_frames(&f, argv[2], head.mesh.vertex_count)) {
        fprintf(stderr, "heads_apart FACE FRAMES.pc2: %s\n", err.text);
        return 2;
    }
    const mesh *m = &head.mesh;
    uint32_t last[RIG_BONES_MAX], pair_count = 0;
    static uint32_t pair[PAIRS][2];
    memset(last, 0xff, sizeof last);
    for (uint32_t v = 0; v < m->vertex_count && pair_count < PAIRS;
         v += 1 + m->vertex_count / PAIRS) {
        uint32_t bone = marks.rigid_bone[v];
        if (bone == RIG_NONE)
            continue;
        if (last[bone] != UINT32_MAX) {
            pair[pair_count][0] = last[bone];
            pair[pair_count++][1] = v;
        }
        last[bone] = v;
    }
    const skull on_skull = find_skull(&head, &marks);
    const bool has_mouth = on_skull.is_known && head.rig->mouth.upper && !head.rig->mouth.fault;
    double parted_mm = 0.0, bent_mm = 0.0, overlap_mm = 0.0;
    slit rest = {0.0, 0.0}, lips;
    bool is_measured = !has_mouth || measure_lips(&rest, &head, &on_skull, m->position);
    for (uint32_t i = 0; i < f.count; ++i) {
        if (fread(f.at, 3 * sizeof(float), f.vertex_count, f.file) != f.vertex_count)
            break;
        for (uint32_t v = 0; v < m->vertex_count; ++v)
            parted_mm = fmax(parted_mm, distance(f.at, v, mesh_point(m, v)));
        for (uint32_t k = 0; k < pair_count; ++k)
            bent_mm = fmax(bent_mm, fabs(distance(f.at, pair[k][0], pair[k][1]) -
                                         distance(m->position, pair[k][0], pair[k][1])));
        if (!has_mouth)
            continue;
        is_measured = is_measured && measure_lips(&lips, &head, &on_skull, f.at);
        overlap_mm = is_measured ? fmax(overlap_mm, lips.overlap - rest.overlap) : 1e3;
    }
    printf("%.4f %.4f %.4f\n", parted_mm, bent_mm, overlap_mm);
    fclose(f.file);
    free(f.at);
    bind_marks_destroy(&marks);
    face_file_destroy(&head);
    return 0;
}
