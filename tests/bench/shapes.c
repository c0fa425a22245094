/* How well a head's own shapes answer pulls: bench_shapes NAME.rig.json SET [MIXTURES [SEED]]
 * Random mixtures of one to four of its shapes (weights 0.3 to 1, no eyeLook) are asked for by
 * their contacts alone. Prints the mean residual over the skin, relative to the mixture: by the
 * fields alone, by shapes first, and by shapes first when half of each mixture's shapes (at least
 * one) are unknown; how far the contacts are from their ends; and what a frame costs more. SET: a
 * contact set of the rig, or a number: its first so many contacts. */
#include "base/clock.h"
#include "face/face.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTS_MAX = 4, MIXTURES = 200, SEED = 7, ROUNDS = 400, SHAPES_MAX = 512 };

typedef struct scene {
    face_file file;
    binding bound;
    csrbf_settings settings;
    face_control control[MRT_MAX_VECTORS];
    uint32_t vertex[MRT_MAX_VECTORS], count;
    uint32_t usable[SHAPES_MAX], usable_count; /* targets */
    float *offset;                             /* of the mixture, vertex_count by 3 */
    double end[MRT_MAX_VECTORS * 3];
} scene;

typedef struct mixture {
    uint32_t target[PARTS_MAX], count;
    double weight[PARTS_MAX];
} mixture;

typedef struct outcome {
    double residual, miss_mm, held_mm, determinant;
} outcome;

static uint64_t state;

static double next_random(void) /* 0..1; splitmix64 */
{
    uint64_t z = (state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void draw_mixture(mixture *out, const scene *s)
{
    *out = (mixture){.count = 1 + (uint32_t)(next_random() * PARTS_MAX)};
    for (uint32_t i = 0; i < out->count; ++i) {
        uint32_t at = (uint32_t)(next_random() * s->usable_count);
        out->target[i] = s->usable[at];
        out->weight[i] = 0.3 + 0.7 * next_random();
        for (uint32_t j = 0; j < i; ++j)
            if (out->target[j] == out->target[i])
                out->count = i;
    }
}

static void mix(scene *s, const mixture *m)
{
    size_t numbers = (size_t)3 * s->file.mesh.vertex_count;
    memset(s->offset, 0, numbers * sizeof *s->offset);
    for (uint32_t i = 0; i < m->count; ++i)
        for (size_t n = 0; n < numbers; ++n)
            s->offset[n] += (float)m->weight[i] * s->file.mesh.target[m->target[i]].offset[n];
    for (uint32_t k = 0; k < s->count; ++k)
        for (size_t axis = 0; axis < 3; ++axis) {
            size_t at = (size_t)3 * s->vertex[k] + axis;
            s->end[3 * k + axis] = (double)s->file.mesh.position[at] + (double)s->offset[at];
        }
}

static mrt_result create(face **out, scene *s, const mesh *m, error *err)
{
    binding copy;
    mrt_result result = binding_copy(&copy, &s->bound, s->file.rig->contact_count, err);
    if (result >= 0)
        result = face_create_shaped(out, s->file.rig, m, &copy, MRT_MAX_VECTORS, err);
    return result < 0 ? result : face_engage(*out, &s->settings, s->control, s->count, err);
}

static outcome measure(face *f, const scene *s)
{
    const points_order *order = face_order(f);
    const points *shown = face_shown(f);
    double missed = 0.0, wanted = 0.0;
    outcome out = {0};
    for (uint32_t v = 0; v < order->count; ++v) {
        double at[3];
        if (!(s->bound.mobility[v] > 0.0f))
            continue;
        points_at(at, shown, order->slot_of_file[v]);
        for (size_t axis = 0; axis < 3; ++axis) {
            double want = (double)s->offset[3 * (size_t)v + axis];
            double off = at[axis] - (double)s->file.mesh.position[3 * (size_t)v + axis] - want;
            missed += off * off;
            wanted += want * want;
        }
    }
    out.residual = sqrt(missed / wanted);
    out.held_mm = face_metered(f)->held_back_mm;
    out.determinant = face_min_determinant(f);
    for (uint32_t k = 0; k < s->count; ++k) {
        vec3 at = face_contact_now(f, s->control[k].contact);
        vec3 way = {at.x - s->end[3 * k], at.y - s->end[3 * k + 1], at.z - s->end[3 * k + 2]};
        out.miss_mm = fmax(out.miss_mm, vec3_length(way));
    }
    return out;
}

static mrt_result answer(outcome *out, scene *s, face *f, double amount, error *err)
{
    face_reset(f);
    face_set_shapes(f, amount);
    mrt_result result = face_engage(f, &s->settings, s->control, s->count, err);
    if (result >= 0)
        result = face_pull(f, s->end, NULL, err);
    if (result >= 0)
        *out = measure(f, s);
    return result;
}

/* A face that does not know the first half of the mixture's shapes. */
static mrt_result answer_withheld(outcome *out, scene *s, const mixture *m, error *err)
{
    mesh view = s->file.mesh;
    mesh_target *kept = calloc(view.target_count + 1, sizeof *kept);
    face *f = NULL;
    if (!kept)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    view.target = kept;
    view.target_count = 0;
    for (uint32_t t = 0; t < s->file.mesh.target_count; ++t) {
        bool is_known = true;
        for (uint32_t i = 0; i < (m->count + 1) / 2; ++i)
            is_known = is_known && m->target[i] != t;
        if (is_known)
            kept[view.target_count++] = s->file.mesh.target[t];
    }
    mrt_result result = create(&f, s, &view, err);
    if (result >= 0)
        result = answer(out, s, f, 1.0, err);
    face_destroy(f);
    free(kept);
    return result;
}

static void add(outcome *sum, const outcome *one, uint32_t count)
{
    sum->residual += one->residual / count;
    sum->miss_mm = fmax(sum->miss_mm, one->held_mm > 0.0 ? 0.0 : one->miss_mm);
    sum->held_mm += one->held_mm > 0.0 ? 1.0 : 0.0;
    sum->determinant = fmin(sum->determinant, one->determinant);
}

static void tell(const char *what, const outcome *o, uint32_t count)
{
    printf("%-28s residual %.3f, contacts within %.4f mm, held back in %.0f of %u, least "
           "determinant %.3f\n",
           what, o->residual, o->miss_mm, o->held_mm, count, o->determinant);
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Frames on the way to mixtures and from each to the next, hot: medians. */
static mrt_result measure_cost(scene *s, face *f, error *err)
{
    static double took_ms[2][ROUNDS];
    double from[MRT_MAX_VECTORS * 3] = {0}, way[MRT_MAX_VECTORS * 3];
    mrt_result result = MRT_OK;
    memcpy(from, s->end, sizeof from);
    for (int pass = 0; pass < 2 && result >= 0; ++pass) {
        mixture m;
        state = SEED;
        face_reset(f);
        face_set_shapes(f, pass);
        result = face_engage(f, &s->settings, s->control, s->count, err);
        for (int i = 0; i < ROUNDS && result >= 0; ++i) {
            if (i % 20 == 0) {
                memcpy(from, s->end, sizeof from);
                draw_mixture(&m, s);
                mix(s, &m);
            }
            for (uint32_t n = 0; n < 3 * s->count; ++n)
                way[n] = from[n] + (s->end[n] - from[n]) * (i % 20 + 1) / 20.0;
            int64_t start_ns = clock_now_ns();
            result = face_pull(f, way, NULL, err);
            took_ms[pass][i] = (double)(clock_now_ns() - start_ns) * 1e-6;
        }
        qsort(took_ms[pass], ROUNDS, sizeof(double), by_size);
    }
    printf("a frame: fields alone %.3f ms, shapes first %.3f ms (%.2f times), %+.3f ms with %u "
           "shapes and %u contacts\n",
           took_ms[0][ROUNDS / 2], took_ms[1][ROUNDS / 2],
           took_ms[1][ROUNDS / 2] / took_ms[0][ROUNDS / 2],
           took_ms[1][ROUNDS / 2] - took_ms[0][ROUNDS / 2], face_shape_count(f), s->count);
    return result;
}

static mrt_result choose_contacts(scene *s, const char *set, error *err)
{
    const rig *r = s->file.rig;
    const rig_contact_set *named = rig_find_contact_set(r, set);
    uint32_t count = named ? named->contact_count : (uint32_t)strtoul(set, NULL, 10);
    if (count == 0 || count > r->contact_count || count > MRT_MAX_VECTORS)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: there is no such set of contacts", set);
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t contact = named ? named->contact[k] : k;
        const float *at =
            s->file.mesh.position + (size_t)3 * (s->vertex[k] = r->contact[contact].vertex);
        s->control[k] = (face_control){{(double)at[0], (double)at[1], (double)at[2]}, 1 + contact};
    }
    s->count = count;
    return MRT_OK;
}

/* Those that move skin, and are no look of the eyes. */
static void choose_shapes(scene *s)
{
    for (uint32_t t = 0; t < s->file.mesh.target_count && s->usable_count < SHAPES_MAX; ++t) {
        double square = 0.0;
        for (uint32_t v = 0; v < s->file.mesh.vertex_count; ++v)
            for (size_t a = 0; a < 3 && s->bound.mobility[v] > 0.0f; ++a) {
                double d = (double)s->file.mesh.target[t].offset[3 * (size_t)v + a];
                square += d * d;
            }
        if (square > 1.0 && !strstr(s->file.mesh.target[t].name, "eyeLook"))
            s->usable[s->usable_count++] = t;
    }
}

static mrt_result run(scene *s, const char *set, uint32_t count, error *err)
{
    outcome fields = {.determinant = 1}, first = {.determinant = 1}, half = {.determinant = 1};
    double worst = 0.0;
    face *f = NULL;
    mrt_result result =
        binding_create(&s->bound, s->file.rig, &s->file.mesh, &s->file.topology, err);
    if (result >= 0)
        result = choose_contacts(s, set, err);
    s->offset = calloc((size_t)3 * s->file.mesh.vertex_count, sizeof *s->offset);
    if (result < 0 || !s->offset)
        return result < 0 ? result : MRT_ERR_MEMORY;
    choose_shapes(s);
    s->settings = s->file.rig->solver;
    if (!(s->settings.radius > 0.0))
        s->settings.radius = 60.0;
    int64_t start_ns = clock_now_ns();
    result = create(&f, s, &s->file.mesh, err);
    if (result < 0 || s->usable_count == 0)
        return result;
    printf("%u shapes, %u of them in mixtures, %u contacts; learnt in %.0f ms; seed %u\n",
           face_shape_count(f), s->usable_count, s->count,
           (double)(clock_now_ns() - start_ns) * 1e-6, (unsigned)state);
    for (uint32_t i = 0; i < count && result >= 0; ++i) {
        mixture m;
        outcome by_fields, by_shapes, by_half = {0};
        draw_mixture(&m, s);
        mix(s, &m);
        result = answer(&by_fields, s, f, 0.0, err);
        if (result >= 0)
            result = answer(&by_shapes, s, f, 1.0, err);
        if (result >= 0)
            result = answer_withheld(&by_half, s, &m, err);
        if (result < 0)
            break;
        if (getenv("VERBOSE")) {
            for (uint32_t k = 0; k < m.count; ++k)
                printf("%s %.2f ", s->file.mesh.target[m.target[k]].name, m.weight[k]);
            printf(": fields %.3f shapes %.3f half %.3f held %.2f |", by_fields.residual,
                   by_shapes.residual, by_half.residual, by_shapes.held_mm);
            (void)answer(&by_shapes, s, f, 1.0, err);
            for (uint32_t k = 0; k < face_shape_count(f); ++k)
                if (face_shape_weight(f, k) > 0.02)
                    printf(" %s %.2f", face_shape_name(f, k), face_shape_weight(f, k));
            printf("\n");
        }
        add(&fields, &by_fields, count);
        add(&first, &by_shapes, count);
        add(&half, &by_half, count);
        worst = fmax(worst, by_half.residual / by_fields.residual);
    }
    if (result >= 0) {
        tell("fields alone", &fields, count);
        tell("shapes first", &first, count);
        tell("half of the shapes withheld", &half, count);
        printf("withheld over fields: %.3f of the means, %.3f in the worst mixture\n",
               half.residual / fields.residual, worst);
        result = measure_cost(s, f, err);
    }
    face_destroy(f);
    return result;
}

int main(int argc, char **argv)
{
    static scene s;
    error err = {""};
    if (argc < 3 || argc > 5) {
        fprintf(stderr, "usage: bench_shapes NAME.rig.json SET [MIXTURES [SEED]]\n");
        return 2;
    }
    uint32_t count = argc > 3 ? (uint32_t)strtoul(argv[3], NULL, 10) : MIXTURES;
    state = argc > 4 ? strtoul(argv[4], NULL, 10) : SEED;
    mrt_result result = face_file_read(&s.file, argv[1], NULL, FACE_FILE_USABLE, &err);
    if (result >= 0 && (!s.file.rig || s.file.mesh.target_count == 0))
        result =
            error_set(&err, MRT_ERR_ARGUMENT, "%s: expected a rig of a mesh with shapes", argv[1]);
    if (result >= 0)
        result = run(&s, argv[2], count > 0 ? count : 1, &err);
    binding_destroy(&s.bound);
    face_file_destroy(&s.file);
    free(s.offset);
    if (result < 0)
        fprintf(stderr, "%s\n", err.text);
    return result < 0;
}
