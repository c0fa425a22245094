#include "face/fit/fit_gram.h"

#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(const fit_gram *g, error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to fit %u columns to %u targets",
                     g->column_count, g->target_count);
}

mrt_result fit_gram_create(fit_gram *out, const bones *b, uint32_t control_count,
                           uint32_t control_column_capacity, uint32_t target_count, error *err)
{
    *out = (fit_gram){.control_count = control_count, .target_count = target_count};
    out->column_capacity = FIT_AFFINE * b->bone_count + control_column_capacity;
    out->column = calloc(out->column_capacity + (size_t)1, sizeof *out->column);
    if (out->column == NULL)
        return no_memory(out, err);
    for (uint32_t bone = 0; bone < b->bone_count; bone++)
        for (uint32_t axis = 0; b->moves[bone] && axis < FIT_AFFINE; axis++)
            out->column[out->column_count++] = (fit_column){bone, RIG_NONE, axis};
    return MRT_OK;
}

void fit_gram_add_column(fit_gram *g, uint32_t bone, uint32_t control)
{
    if (g->column_count < g->column_capacity)
        g->column[g->column_count++] = (fit_column){bone, control, 0};
}

mrt_result fit_gram_begin(fit_gram *g, error *err)
{
    size_t count = g->column_count;
    g->gram = calloc(count * count + 1, sizeof *g->gram);
    g->right = calloc(g->target_count * count * 3 + 1, sizeof *g->right);
    g->energy = calloc(g->target_count + (size_t)1, sizeof *g->energy);
    g->used = malloc((count + 1) * sizeof *g->used);
    if (g->gram != NULL && g->right != NULL && g->energy != NULL && g->used != NULL)
        return MRT_OK;
    fit_gram_destroy(g);
    return no_memory(g, err);
}

void fit_gram_destroy(fit_gram *g)
{
    free(g->column);
    free(g->gram);
    free(g->right);
    free(g->energy);
    free(g->used);
    *g = (fit_gram){0};
}

void fit_gram_add_vertex(fit_gram *g, const double *value, const double *offset)
{
    uint32_t used_count = 0;
    for (uint32_t j = 0; j < g->column_count; j++)
        if (value[j] != 0)
            g->used[used_count++] = j;
    for (uint32_t a = 0; a < used_count; a++) {
        double *row = g->gram + (size_t)g->used[a] * g->column_count;
        double scale = value[g->used[a]];
        for (uint32_t b = 0; b <= a; b++)
            row[g->used[b]] += scale * value[g->used[b]];
    }
    for (uint32_t t = 0; t < g->target_count; t++) {
        const double *to = offset + 3 * (size_t)t;
        double square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
        if (square == 0)
            continue;
        g->energy[t] += square;
        for (uint32_t a = 0; a < used_count; a++) {
            double *right = g->right + 3 * ((size_t)t * g->column_count + g->used[a]);
            for (int axis = 0; axis < 3; axis++)
                right[axis] += value[g->used[a]] * to[axis];
        }
    }
}

void fit_gram_finish(fit_gram *g)
{
    size_t count = g->column_count;
    for (size_t a = 0; a < count; a++)
        for (size_t b = 0; b < a; b++)
            g->gram[b * count + a] = g->gram[a * count + b];
}

/* ---- reducing ---- */

/* The columns of the full form that make up each column of the reduced one, with their factors. */
typedef struct recipe {
    uint32_t *from; /* reduced columns by (choice_count) */
    double *amount;
    uint32_t *length; /* reduced columns */
} recipe;

static uint32_t find_column(const fit_gram *full, uint32_t bone, uint32_t control)
{
    for (uint32_t j = 0; j < full->column_count; j++)
        if (full->column[j].bone == bone && full->column[j].control == control)
            return j;
    return RIG_NONE;
}

static void add_affine(fit_gram *out, recipe *r, const fit_gram *full, uint32_t width)
{
    for (uint32_t j = 0; j < full->column_count && full->column[j].control == RIG_NONE; j++) {
        r->from[(size_t)out->column_count * width] = j;
        r->amount[(size_t)out->column_count * width] = 1;
        r->length[out->column_count] = 1;
        out->column[out->column_count++] = full->column[j];
    }
}

static void add_field(fit_gram *out, recipe *r, const fit_gram *full, uint32_t bone,
                      const uint32_t *choice, uint32_t width, const double *share)
{
    for (uint32_t i = 0; i < width; i++) {
        uint32_t length = 0;
        size_t at = (size_t)out->column_count * width;
        for (uint32_t j = 0; j < width; j++) {
            double amount = share[((size_t)bone * width + j) * width + i];
            uint32_t column = amount != 0 ? find_column(full, bone, choice[j]) : RIG_NONE;
            if (column == RIG_NONE)
                continue;
            r->from[at + length] = column;
            r->amount[at + length++] = amount;
        }
        if (length == 0)
            continue;
        r->length[out->column_count] = length;
        out->column[out->column_count++] = (fit_column){bone, i, 0};
    }
}

static double reduced_entry(const fit_gram *full, const recipe *r, uint32_t width, uint32_t a,
                            uint32_t b)
{
    double sum = 0;
    for (uint32_t i = 0; i < r->length[a]; i++) {
        const double *row =
            full->gram + (size_t)r->from[(size_t)a * width + i] * full->column_count;
        double inner = 0;
        for (uint32_t j = 0; j < r->length[b]; j++)
            inner += r->amount[(size_t)b * width + j] * row[r->from[(size_t)b * width + j]];
        sum += r->amount[(size_t)a * width + i] * inner;
    }
    return sum;
}

static void reduce_sums(fit_gram *out, const fit_gram *full, const recipe *r, uint32_t width)
{
    size_t count = out->column_count;
    for (uint32_t a = 0; a < count; a++)
        for (uint32_t b = 0; b <= a; b++)
            out->gram[a * count + b] = reduced_entry(full, r, width, a, b);
    fit_gram_finish(out);
    for (uint32_t t = 0; t < out->target_count; t++) {
        out->energy[t] = full->energy[t];
        for (size_t a = 0; a < count; a++)
            for (uint32_t i = 0; i < r->length[a]; i++)
                for (size_t axis = 0; axis < 3; axis++)
                    out->right[3 * (t * count + a) + axis] +=
                        r->amount[a * width + i] *
                        full->right[3 * ((size_t)t * full->column_count + r->from[a * width + i]) +
                                    axis];
    }
}

mrt_result fit_gram_reduce(fit_gram *out, const fit_gram *full, const uint32_t *choice,
                           uint32_t choice_count, const double *share, error *err)
{
    uint32_t affine_count = 0, bone_count = 0;
    for (uint32_t j = 0; j < full->column_count; j++) {
        affine_count += full->column[j].control == RIG_NONE;
        bone_count = full->column[j].bone + 1 > bone_count ? full->column[j].bone + 1 : bone_count;
    }
    *out = (fit_gram){.control_count = choice_count, .target_count = full->target_count};
    out->column_capacity = affine_count + bone_count * choice_count;
    uint32_t width = choice_count > 0 ? choice_count : 1;
    size_t room = (size_t)out->column_capacity + 1;
    recipe r = {.from = malloc(room * width * sizeof *r.from),
                .amount = malloc(room * width * sizeof *r.amount),
                .length = malloc(room * sizeof *r.length)};
    out->column = calloc(room, sizeof *out->column);
    mrt_result result = MRT_OK;
    if (r.from == NULL || r.amount == NULL || r.length == NULL || out->column == NULL) {
        result = no_memory(out, err);
    } else {
        add_affine(out, &r, full, width);
        for (uint32_t bone = 0; choice_count > 0 && bone < bone_count; bone++)
            add_field(out, &r, full, bone, choice, width, share);
        result = fit_gram_begin(out, err);
    }
    if (result == MRT_OK)
        reduce_sums(out, full, &r, width);
    else
        fit_gram_destroy(out);
    free(r.from);
    free(r.amount);
    free(r.length);
    return result;
}
