#include "csrbf/saddle.h"

#include "base/large.h"
#include "base/pool.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- centres ---- */

static void merge_destroy(merge *m)
{
    if (!m)
        return;
    free(m->sorted);
    free(m->group);
    free(m->share);
    *m = (merge){0};
}

/* false: no memory */
static bool merge_create(merge *out, uint32_t control_capacity)
{
    size_t room = (size_t)control_capacity + 1;
    *out = (merge){0};
    out->sorted = calloc(room, sizeof *out->sorted);
    out->group = calloc(room, sizeof *out->group);
    out->share = calloc(room, sizeof *out->share);
    if (out->sorted && out->group && out->share)
        return true;
    merge_destroy(out);
    return false;
}

/* Sorts the controls of one class, beginning at item[first]. Returns their end. */
static uint32_t sort_class(order_item *item, uint32_t first, const merge *m, const double *centre,
                           const csrbf_class *class, csrbf_class wanted)
{
    uint32_t end = first;
    for (uint32_t control = 0; control < m->control_count; ++control)
        if ((class ? class[control] : CSRBF_TIP) == wanted) {
            item[end].row = control;
            memcpy(item[end].at, centre + (size_t)3 * control, sizeof item[end].at);
            ++end;
        }
    order_item *scratch = item + m->control_count;
    if (end - first <= MRT_MAX_VECTORS) /* the maximum of pulls of a mapping */
        order_sort(item + first, scratch, end - first);
    else
        order_sort_along(item + first, scratch, end - first);
    return end;
}

static void sort_controls(merge *m, order_item *item, const double *centre,
                          const csrbf_class *class)
{
    uint32_t end = sort_class(item, 0, m, centre, class, CSRBF_SKULL);
    end = sort_class(item, end, m, centre, class, CSRBF_JAW);
    end = sort_class(item, end, m, centre, class, CSRBF_TIP);
    for (uint32_t i = 0; i < end; ++i)
        m->sorted[i] = item[i].row;
}

/* During joining, group[] holds for each index in the order an earlier index of its component. The
 * root of a component holds itself. */
static uint32_t root_of(uint32_t *group, uint32_t index)
{
    while (group[index] != index) {
        group[index] = group[group[index]];
        index = group[index];
    }
    return index;
}

static void join(uint32_t *group, uint32_t index, uint32_t other)
{
    uint32_t a = root_of(group, index), b = root_of(group, other);
    if (a < b)
        group[b] = a;
    else
        group[a] = b;
}

static bool is_close(const order_item *a, const order_item *b, double limit)
{
    double dx = a->at[0] - b->at[0], dy = a->at[1] - b->at[1], dz = a->at[2] - b->at[2];
    return dx * dx + dy * dy + dz * dz <= limit;
}

/* Searches along the longest axis: from each item backwards, as far as one can be close. */
static void join_close(merge *m, const order_item *item, order_item *scratch, double distance)
{
    const double limit = distance * distance;
    for (uint32_t index = 0; index < m->control_count; ++index) {
        m->group[index] = index;
        scratch[index] = item[index];
        scratch[index].row = index;
    }
    int axis = order_sort_along(scratch, scratch + m->control_count, m->control_count);
    for (uint32_t i = 0; i < m->control_count; ++i)
        for (uint32_t k = i; k-- > 0;) {
            double way = scratch[i].at[axis] - scratch[k].at[axis];
            if (way * way > limit)
                break;
            if (is_close(&scratch[i], &scratch[k], limit))
                join(m->group, scratch[i].row, scratch[k].row);
        }
}

/* Numbers the groups by the index of their roots. item[].key becomes the group of each control. */
static void number_groups(merge *m, order_item *item)
{
    m->group_count = 0;
    for (uint32_t i = 0; i < m->control_count; ++i)
        if (root_of(m->group, i) == i)
            item[i].key = m->group_count++;
        else
            item[i].key = item[root_of(m->group, i)].key;
    for (uint32_t i = 0; i < m->control_count; ++i)
        m->group[item[i].row] = (uint32_t)item[i].key;
}

static void share_out(merge *m, order_item *scratch, const csrbf_class *class)
{
    /* For each group g: scratch[g].row is its highest class, scratch[g].key the number of its
     * members of that class. */
    for (uint32_t g = 0; g < m->group_count; ++g)
        scratch[g] = (order_item){0};
    for (uint32_t control = 0; control < m->control_count; ++control) {
        order_item *group = &scratch[m->group[control]];
        uint32_t rank = class ? (uint32_t) class[control] : 0;
        if (rank > group->row)
            *group = (order_item){.row = rank};
        group->key += rank == group->row;
    }
    for (uint32_t control = 0; control < m->control_count; ++control) {
        const order_item *group = &scratch[m->group[control]];
        uint32_t rank = class ? (uint32_t) class[control] : 0;
        m->share[control] = rank == group->row ? 1.0 / (double)group->key : 0.0;
    }
}

/* centre: count by 3, finite. class: count, or NULL. scratch: three times count. */
static void merge_find(merge *m, order_item *scratch, const double *centre,
                       const csrbf_class *class, uint32_t count, double distance)
{
    m->control_count = count;
    sort_controls(m, scratch, centre, class);
    join_close(m, scratch, scratch + count, distance);
    number_groups(m, scratch);
    share_out(m, scratch, class);
}

/* Computes the means of the controls' rows of 3. out: group_count by stride; its other columns are
 * set to 0. */
static void merge_means(const merge *m, double *out, uint32_t stride, const double *value)
{
    memset(out, 0, (size_t)m->group_count * stride * sizeof *out);
    for (uint32_t i = 0; i < m->control_count; ++i) {
        uint32_t control = m->sorted[i];
        double *mean = out + (size_t)m->group[control] * stride;
        for (size_t axis = 0; axis < 3; ++axis)
            mean[axis] += value[(size_t)3 * control + axis] * m->share[control];
    }
}

/* ---- the factor ---- */

bool envelope_create(envelope *out, uint32_t row_capacity)
{
    size_t rows = row_capacity;
    *out = (envelope){.row_capacity = row_capacity, .lanes = lanes_now()};
    out->first = calloc(rows + 1, sizeof *out->first);
    out->start = calloc(rows + 1, sizeof *out->start);
    out->value = calloc(rows * (rows + 1) / 2 + 1, sizeof *out->value);
    out->group = large_alloc((rows + 1) * ENVELOPE_GROUPS * ENVELOPE_LANES * sizeof *out->group);
    if (out->first && out->start && out->value && out->group)
        return true;
    envelope_destroy(out);
    return false;
}

void envelope_destroy(envelope *e)
{
    if (!e)
        return;
    free(e->first);
    free(e->start);
    free(e->value);
    large_free(e->group);
    *e = (envelope){0};
}

void envelope_keep(envelope *e, uint32_t row_count)
{
    e->row_count = row_count;
    e->factored_count = row_count;
    e->start[0] = 0;
}

/* Keeps row_count rows: those before `first` are equal in both, the others are copied from
 * `from`. */
static void envelope_take(envelope *e, const envelope *from, uint32_t first, uint32_t row_count)
{
    const size_t begin = from->start[first], end = from->start[row_count];
    memcpy(e->first + first, from->first + first, (row_count - first) * sizeof *e->first);
    memcpy(e->start + first, from->start + first, (row_count - first + 1) * sizeof *e->start);
    memcpy(e->value + begin, from->value + begin, (end - begin) * sizeof *e->value);
    envelope_keep(e, row_count);
}

double *envelope_add_row(envelope *e, uint32_t first)
{
    uint32_t row = e->row_count++;
    e->first[row] = first;
    e->start[row + 1] = e->start[row] + (row - first + 1);
    return e->value + e->start[row];
}

bool envelope_factor(envelope *e, double smallest_pivot, uint32_t *out_row)
{
    if (!e->lanes->factor(e, smallest_pivot, out_row))
        return false;
    e->factored_count = e->row_count;
    return true;
}

void envelope_solve_few(const envelope *e, double *rhs)
{
    e->lanes->solve_few(e, rhs);
}

void envelope_solve_many(const envelope *e, double *rhs)
{
    e->lanes->solve_many(e, rhs);
}

/* ---- the system ---- */

static const double smallest_pivot = 1e-12;
static const double merge_ratio = 1e-3;

bool saddle_create(saddle *out, uint32_t centre_capacity)
{
    size_t room = (size_t)centre_capacity * ENVELOPE_FEW + 1;
    *out = (saddle){.basis = calloc(room, sizeof(double)),
                    .resolved = calloc(room, sizeof(double)),
                    .factored = calloc((size_t)3 * centre_capacity + 1, sizeof(double))};
    bool merge_made = merge_create(&out->merge, centre_capacity);
    bool field_made = field_create(&out->field, centre_capacity);
    bool matrix_made = envelope_create(&out->matrix, centre_capacity);
    if (merge_made && field_made && matrix_made && out->basis && out->resolved && out->factored)
        return true;
    saddle_destroy(out);
    return false;
}

void saddle_destroy(saddle *s)
{
    if (!s)
        return;
    merge_destroy(&s->merge);
    field_destroy(&s->field);
    envelope_destroy(&s->matrix);
    free(s->basis);
    free(s->resolved);
    free(s->factored);
    *s = (saddle){0};
}

/* Returns the first column of row i and its neighbours, which are factored together. */
static uint32_t first_of_rows(const field *f, uint32_t i)
{
    uint32_t start = i / ENVELOPE_ALIKE * ENVELOPE_ALIKE, first = start;
    for (uint32_t row = start; row < start + ENVELOPE_ALIKE && row < f->centre_count; ++row) {
        uint32_t own = f->lanes->first_neighbour(f, row);
        first = own < first ? own : first;
    }
    return first;
}

/* Appends the missing rows of the matrix. Rows that are factored together begin at the same
 * column. */
static void assemble(saddle *s)
{
    const field *f = &s->field;
    uint32_t first = 0;
    for (uint32_t i = s->matrix.row_count; i < f->centre_count; ++i) {
        first = i % ENVELOPE_ALIKE == 0 ? first_of_rows(f, i) : first;
        double *row = envelope_add_row(&s->matrix, first);
        f->lanes->kernel_row(f, row, i, first);
        row[i - first] = 1.0 + f->settings.ridge;
    }
}

/* Returns how many rows of the field's matrix `held` has already factored. */
static uint32_t rows_held(const saddle *held, const field *f)
{
    const csrbf_settings *a = &held->factored_for, *b = &f->settings;
    uint32_t count = 0;
    if (a->kernel != b->kernel || a->radius != b->radius || a->ridge != b->ridge)
        return 0;
    while (count < held->matrix.factored_count && count < f->centre_count &&
           memcmp(held->factored + (size_t)3 * count, f->centre + (size_t)3 * count,
                  3 * sizeof *f->centre) == 0)
        ++count;
    return count / ENVELOPE_ALIKE * ENVELOPE_ALIKE;
}

/* Keeps the rows of the matrix that need not be factored again. */
static void reuse_rows(saddle *s, const saddle *other)
{
    uint32_t own = rows_held(s, &s->field), lent = rows_held(other, &s->field);
    if (own >= lent)
        envelope_keep(&s->matrix, own);
    else
        envelope_take(&s->matrix, &other->matrix, own, lent);
}

/* Returns false if the matrix is singular; out_row is the row where that is detected. */
static bool factor_matrix(saddle *s, const saddle *other, uint32_t *out_row)
{
    const field *f = &s->field;
    reuse_rows(s, other);
    s->factored_for = f->settings;
    memcpy(s->factored, f->centre, (size_t)3 * f->centre_count * sizeof *s->factored);
    assemble(s);
    return envelope_factor(&s->matrix, smallest_pivot, out_row);
}

/* Returns a control of the group, for messages. */
static uint32_t member_of(const merge *m, uint32_t group)
{
    uint32_t control = 0;
    while (control + 1 < m->control_count && m->group[control] != group)
        ++control;
    return control;
}

static uint32_t terms_wanted(const field *f)
{
    if (f->settings.polynomial == CSRBF_NONE || f->centre_count == 0)
        return 0;
    return f->settings.polynomial == CSRBF_CONSTANT ? 1 : 1 + f->hull.dimension;
}

/* Computes S = P^T Y and its Cholesky factor. */
static mrt_result factor_polynomial(saddle *s, error *err)
{
    uint32_t terms = s->field.term_count;
    for (uint32_t i = 0; i < s->field.centre_count; ++i) {
        double term[4] = {0.0};
        field_terms(&s->field, term, s->field.centre + (size_t)3 * i);
        memcpy(s->basis + (size_t)ENVELOPE_FEW * i, term, sizeof term);
    }
    memcpy(s->resolved, s->basis,
           (size_t)ENVELOPE_FEW * s->field.centre_count * sizeof *s->resolved);
    envelope_solve_few(&s->matrix, s->resolved);
    for (uint32_t a = 0; a < terms; ++a)
        for (uint32_t b = 0; b <= a; ++b) {
            double sum = 0.0;
            for (size_t i = 0; i < s->field.centre_count; ++i)
                sum += s->basis[ENVELOPE_FEW * i + a] * s->resolved[ENVELOPE_FEW * i + b];
            double size = sum;
            for (uint32_t k = 0; k < b; ++k)
                sum -= s->schur[a][k] * s->schur[b][k];
            if (b < a)
                s->schur[a][b] = sum / s->schur[b][b];
            else if (sum > smallest_pivot * size)
                s->schur[a][a] = sqrt(sum);
            else
                return error_set(err, MRT_ERR_UNSUPPORTED,
                                 "the polynomial is not determined by these %u controls: use "
                                 "\"constant\" or \"none\", or spread them",
                                 s->merge.control_count);
        }
    return MRT_OK;
}

mrt_result saddle_factor(saddle *s, const saddle *other, order_item *scratch,
                         const csrbf_settings *settings, const double *centre,
                         const csrbf_class *class, uint32_t count, error *err)
{
    field *f = &s->field;
    merge_find(&s->merge, scratch, centre, class, count, merge_ratio * settings->radius);
    f->settings = *settings;
    f->centre_count = s->merge.group_count;
    merge_means(&s->merge, f->centre, 3, centre);
    f->hull = (hull){0};
    if (f->centre_count > 0)
        hull_fit(&f->hull, f->centre, f->centre_count);
    f->term_count = terms_wanted(f);
    s->gain = 0.0;
    s->merged_apart = false;
    field_begin(f);
    uint32_t row = 0;
    if (!factor_matrix(s, other, &row))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "control %u is too close to the others for radius %g: the system is "
                         "singular; use a smaller radius, or spread the controls",
                         member_of(&s->merge, row), settings->radius);
    return f->term_count > 0 ? factor_polynomial(s, err) : MRT_OK;
}

/* beta (terms by width) = S^-1 beta, in place. */
static void solve_schur(const saddle *s, double *beta, uint32_t width)
{
    uint32_t terms = s->field.term_count;
    for (uint32_t column = 0; column < width; ++column) {
        double *b = beta + column;
        for (uint32_t i = 0; i < terms; ++i) {
            for (uint32_t k = 0; k < i; ++k)
                b[i * width] -= s->schur[i][k] * b[k * width];
            b[i * width] /= s->schur[i][i];
        }
        for (uint32_t i = terms; i-- > 0;) {
            for (uint32_t k = i + 1; k < terms; ++k)
                b[i * width] -= s->schur[k][i] * b[k * width];
            b[i * width] /= s->schur[i][i];
        }
    }
}

/* rhs (centre_count by width) -= P beta. */
static void subtract_polynomial(const saddle *s, double *rhs, const double *beta, uint32_t width)
{
    for (size_t i = 0; i < s->field.centre_count; ++i)
        for (size_t column = 0; column < width; ++column)
            for (size_t term = 0; term < s->field.term_count; ++term)
                rhs[i * width + column] -=
                    s->basis[ENVELOPE_FEW * i + term] * beta[term * width + column];
}

static double largest_size(const double *value, size_t count)
{
    double largest = 0.0;
    for (size_t i = 0; i < count; ++i)
        largest = fabs(value[i]) > largest ? fabs(value[i]) : largest;
    return largest;
}

static bool moved_apart(const saddle *s, const double *g, const double *mean)
{
    /* If two differ by more than the distance, one differs by more than half of it from their
     * mean. */
    double limit = 0.5 * merge_ratio * s->field.settings.radius;
    for (size_t control = 0; control < s->merge.control_count; ++control) {
        const double *m = mean + (size_t)ENVELOPE_FEW * s->merge.group[control];
        double square = 0.0;
        for (size_t axis = 0; axis < 3; ++axis) {
            double d = g[3 * control + axis] - m[axis];
            square += d * d;
        }
        if (square > limit * limit)
            return true;
    }
    return false;
}

mrt_result saddle_solve(saddle *s, double *rhs, const double *g, error *err)
{
    double beta[4][ENVELOPE_FEW] = {{0}};
    size_t entries = (size_t)ENVELOPE_FEW * s->field.centre_count;
    merge_means(&s->merge, rhs, ENVELOPE_FEW, g);
    bool apart = moved_apart(s, g, rhs);
    double largest = largest_size(rhs, entries);
    for (size_t i = 0; i < s->field.centre_count; ++i)
        for (size_t term = 0; term < s->field.term_count; ++term)
            for (size_t axis = 0; axis < 3; ++axis)
                beta[term][axis] +=
                    s->resolved[ENVELOPE_FEW * i + term] * rhs[ENVELOPE_FEW * i + axis];
    solve_schur(s, beta[0], ENVELOPE_FEW);
    subtract_polynomial(s, rhs, beta[0], ENVELOPE_FEW);
    envelope_solve_few(&s->matrix, rhs);
    for (size_t i = 0; i < entries; ++i)
        if (!(fabs(rhs[i]) <= 1e30))
            return error_set(err, MRT_ERR_UNSUPPORTED,
                             "the displacements are too large for these control vectors");
    field_set_alpha(&s->field, rhs, ENVELOPE_FEW, largest);
    for (int term = 0; term < 4; ++term)
        memcpy(s->field.beta[term], beta[term], sizeof s->field.beta[term]);
    s->merged_apart = apart;
    return MRT_OK;
}

void saddle_solve_units(const saddle *s, uint32_t first, double *alpha,
                        double beta[4][ENVELOPE_MANY])
{
    memset(alpha, 0, (size_t)ENVELOPE_MANY * s->field.centre_count * sizeof *alpha);
    memset(beta, 0, 4 * sizeof *beta);
    for (size_t column = 0; column < ENVELOPE_MANY; ++column) {
        size_t centre = first + column;
        if (centre >= s->field.centre_count)
            break;
        alpha[centre * ENVELOPE_MANY + column] = 1.0;
        for (size_t term = 0; term < s->field.term_count; ++term)
            beta[term][column] = s->resolved[ENVELOPE_FEW * centre + term];
    }
    solve_schur(s, beta[0], ENVELOPE_MANY);
    subtract_polynomial(s, alpha, beta[0], ENVELOPE_MANY);
    envelope_solve_many(&s->matrix, alpha);
}

/* Returns sum_k |d p(x) / d g_k| = sum_k |(S^-1 q(x)) . Y_k|. */
static double gain_at(const saddle *s, const double x[3])
{
    double term[4], sum = 0.0;
    field_terms(&s->field, term, x);
    solve_schur(s, term, 1);
    for (size_t i = 0; i < s->field.centre_count; ++i) {
        double weight = 0.0;
        for (size_t a = 0; a < s->field.term_count; ++a)
            weight += term[a] * s->resolved[ENVELOPE_FEW * i + a];
        sum += fabs(weight);
    }
    return sum;
}

static double gain_in(const saddle *s, const points_bounds *box)
{
    double largest = 0.0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        double x[3];
        for (unsigned axis = 0; axis < 3; ++axis)
            x[axis] = (double)(corner >> axis & 1u ? box->high[axis] : box->low[axis]);
        double gain = gain_at(s, x);
        largest = gain > largest ? gain : largest;
    }
    return largest;
}

/* A windowed polynomial acts only in the supports. */
static points_bounds box_of_effect(const field *f, const points_bounds *box)
{
    points_bounds effect = *box;
    if (f->settings.polynomial != CSRBF_WINDOWED)
        return effect;
    for (size_t axis = 0; axis < 3; ++axis) {
        double low = f->centre[axis], high = f->centre[axis];
        for (size_t i = 1; i < f->centre_count; ++i) {
            double at = f->centre[3 * i + axis];
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        float reach_low = (float)(low - f->settings.radius);
        float reach_high = (float)(high + f->settings.radius);
        effect.low[axis] = effect.low[axis] > reach_low ? effect.low[axis] : reach_low;
        effect.high[axis] = effect.high[axis] < reach_high ? effect.high[axis] : reach_high;
    }
    return effect;
}

void saddle_limit_gain(saddle *s, const points_bounds *box, double limit)
{
    field_begin(&s->field);
    if (s->field.term_count == 0)
        return;
    points_bounds effect = box_of_effect(&s->field, box);
    s->gain = gain_in(s, &effect);
    while (s->gain > limit && s->field.term_count > 1) {
        /* The factor of the smaller S is a corner of the factor of the larger one. */
        --s->field.term_count;
        s->gain = gain_in(s, &effect);
    }
}

/* ---- unit responses ---- */

/* Stores columns first .. first + count - 1 of the centres, for each control that belongs to one of
 * them. */
static void store_block(const merge *m, uint32_t first, uint32_t count, double sum[][POINTS_BLOCK],
                        float *out, size_t stride, uint32_t block)
{
    for (uint32_t control = 0; control < m->control_count; ++control) {
        uint32_t column = m->group[control] - first;
        if (m->group[control] < first || column >= count)
            continue;
        float *restrict row = out + control * stride + (size_t)block * POINTS_BLOCK;
        const double *restrict from = sum[column];
        const double share = m->share[control];
        for (int i = 0; i < POINTS_BLOCK; ++i)
            row[i] = (float)(from[i] * share);
    }
}

/* Solves for alpha and beta (4 by LANES_RESPONSES) of `count` unit displacements, beginning at
 * centre `first`. */
static void solve_columns(const saddle *s, uint32_t first, uint32_t count, double *alpha,
                          double *half, double beta[4][LANES_RESPONSES])
{
    for (uint32_t done = 0; done < count; done += ENVELOPE_MANY) {
        double some[4][ENVELOPE_MANY];
        saddle_solve_units(s, first + done, half, some);
        for (size_t i = 0; i < s->field.centre_count; ++i)
            memcpy(alpha + i * LANES_RESPONSES + done, half + i * ENVELOPE_MANY,
                   ENVELOPE_MANY * sizeof *alpha);
        for (int term = 0; term < 4; ++term)
            memcpy(beta[term] + done, some[term], sizeof some[term]);
    }
}

/* Computing the unit responses of centres first .. r->count - 1 in all blocks. */
typedef struct fill_work {
    const saddle *s;
    lanes_responses responses;
    uint32_t first;
    float *out;
    size_t stride;
    const points *in;
    const uint8_t *wanted;
} fill_work;

static void fill_blocks(void *data, uint32_t first, uint32_t end)
{
    const fill_work *w = data;
    const field *f = &w->s->field;
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) double sum[LANES_RESPONSES][POINTS_BLOCK];
        if (w->wanted && !w->wanted[block])
            memset(sum, 0, sizeof sum);
        else
            f->lanes->responses_block(f, &w->responses, sum, w->in, block);
        store_block(&w->s->merge, w->first, w->responses.count, sum, w->out, w->stride, block);
    }
}

/* The cost of evaluating each centre's kernel at each vertex, and of adding it to each column. */
static double cost_ns(const fill_work *w)
{
    double each_ns = 1.0 + 0.15 * w->responses.count;
    return each_ns * POINTS_BLOCK * w->in->block_count * w->s->field.centre_count;
}

/* Computes all centres in batches. */
static void fill(fill_work *w, double *scratch)
{
    uint32_t centres = w->s->field.centre_count;
    double *alpha = scratch, *half = scratch + (size_t)centres * LANES_RESPONSES;
    for (w->first = 0; w->first < centres; w->first += LANES_RESPONSES) {
        uint32_t left = centres - w->first, count = left < LANES_RESPONSES ? left : LANES_RESPONSES;
        double beta[4][LANES_RESPONSES];
        solve_columns(w->s, w->first, count, alpha, half, beta);
        w->responses = (lanes_responses){
            .alpha = alpha, .stride = LANES_RESPONSES, .count = count, .beta = beta[0]};
        const pool_work work = {.run = fill_blocks,
                                .data = w,
                                .part_count = w->in->block_count,
                                .grain = FIELD_GRAIN,
                                .cost_ns = cost_ns(w)};
        pool_run(&work);
    }
}

void saddle_responses(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                      const uint8_t *wanted)
{
    fill(&(fill_work){.s = s, .out = out, .stride = stride, .in = in, .wanted = wanted}, scratch);
}
