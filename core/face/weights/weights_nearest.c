#include "face/weights/weights_nearest.h"

#include <math.h>
#include <stdlib.h>

enum { CELLS_MOST = 64 }; /* along one axis */

struct nearest {
    const float *position;
    uint32_t *member;     /* member_count, sorted by cell */
    uint32_t *cell_start; /* cells + 1 */
    double low[3], cell_size;
    int32_t cells[3];
    uint32_t member_count;
};

static void find_box(nearest *n, const uint8_t *is_member, uint32_t vertex_count, double high[3])
{
    for (int a = 0; a < 3; a++) {
        n->low[a] = (double)INFINITY;
        high[a] = -(double)INFINITY;
    }
    for (uint32_t v = 0; v < vertex_count; v++) {
        if (!is_member[v])
            continue;
        n->member_count++;
        for (int a = 0; a < 3; a++) {
            double x = (double)n->position[3 * (size_t)v + (size_t)a];
            n->low[a] = fmin(n->low[a], x);
            high[a] = fmax(high[a], x);
        }
    }
}

static void choose_cells(nearest *n, const double high[3])
{
    double longest = 0;
    for (int a = 0; a < 3; a++)
        longest = fmax(longest, high[a] - n->low[a]);
    double wanted = fmin(CELLS_MOST, 1 + sqrt((double)n->member_count));
    n->cell_size = longest > 0 ? longest / wanted : 1;
    for (int a = 0; a < 3; a++) {
        double count = floor((high[a] - n->low[a]) / n->cell_size) + 1;
        n->cells[a] = (int32_t)fmin(fmax(count, 1), CELLS_MOST + 1);
    }
}

static int32_t cell_along(const nearest *n, const float *at, int axis)
{
    double cell = floor(((double)at[axis] - n->low[axis]) / n->cell_size);
    return (int32_t)fmin(fmax(cell, 0), n->cells[axis] - 1);
}

static size_t cell_index(const nearest *n, const int32_t cell[3])
{
    const size_t x = (size_t)cell[0], y = (size_t)cell[1], z = (size_t)cell[2];
    return (z * (size_t)n->cells[1] + y) * (size_t)n->cells[0] + x;
}

static size_t cell_of(const nearest *n, const float *at)
{
    int32_t cell[3] = {cell_along(n, at, 0), cell_along(n, at, 1), cell_along(n, at, 2)};
    return cell_index(n, cell);
}

static void sort_members(nearest *n, const uint8_t *is_member, uint32_t vertex_count,
                         size_t cell_count)
{
    for (uint32_t v = 0; v < vertex_count; v++)
        if (is_member[v])
            n->cell_start[cell_of(n, n->position + 3 * (size_t)v) + 1]++;
    for (size_t c = 0; c < cell_count; c++)
        n->cell_start[c + 1] += n->cell_start[c];
    for (uint32_t v = vertex_count; v-- > 0;)
        if (is_member[v]) {
            size_t cell = cell_of(n, n->position + 3 * (size_t)v);
            n->member[--n->cell_start[cell + 1]] = v;
        }
    for (size_t c = 0; c < cell_count; c++)
        n->cell_start[c] = n->cell_start[c + 1];
    n->cell_start[cell_count] = n->member_count;
}

nearest *nearest_create(const float *position, const uint8_t *is_member, uint32_t vertex_count)
{
    nearest *n = calloc(1, sizeof *n);
    if (n == NULL)
        return NULL;
    n->position = position;
    double high[3];
    find_box(n, is_member, vertex_count, high);
    if (n->member_count == 0)
        return n;
    choose_cells(n, high);
    size_t cell_count = (size_t)n->cells[0] * (size_t)n->cells[1] * (size_t)n->cells[2];
    n->member = malloc(n->member_count * sizeof *n->member);
    n->cell_start = calloc(cell_count + 2, sizeof *n->cell_start);
    if (n->member == NULL || n->cell_start == NULL) {
        nearest_destroy(n);
        return NULL;
    }
    sort_members(n, is_member, vertex_count, cell_count);
    return n;
}

void nearest_destroy(nearest *n)
{
    if (n == NULL)
        return;
    free(n->member);
    free(n->cell_start);
    free(n);
}

typedef struct search {
    const float *at;
    double distance_squared;
    uint32_t vertex;
} search;

static void search_cell(const nearest *n, search *s, const int32_t cell[3])
{
    size_t index = cell_index(n, cell);
    for (uint32_t i = n->cell_start[index]; i < n->cell_start[index + 1]; i++) {
        uint32_t v = n->member[i];
        double q = 0;
        for (size_t a = 0; a < 3; a++) {
            double d = (double)n->position[3 * (size_t)v + a] - (double)s->at[a];
            q += d * d;
        }
        if (q < s->distance_squared || (q == s->distance_squared && v < s->vertex)) {
            s->distance_squared = q;
            s->vertex = v;
        }
    }
}

static int32_t limited(int32_t cell, int32_t count)
{
    return cell < 0 ? 0 : cell >= count ? count - 1 : cell;
}

/* Searches the cells of one row of the shell that is `shell` steps from the centre. */
static void search_row(const nearest *n, search *s, const int32_t centre[3], int32_t shell,
                       int32_t y, int32_t z)
{
    int32_t first = centre[0] - shell, last = centre[0] + shell;
    bool is_whole = abs(y - centre[1]) == shell || abs(z - centre[2]) == shell;
    if (is_whole) {
        int32_t end = limited(last, n->cells[0]);
        for (int32_t x = limited(first, n->cells[0]); x <= end; x++)
            search_cell(n, s, (int32_t[3]){x, y, z});
        return;
    }
    if (first >= 0)
        search_cell(n, s, (int32_t[3]){first, y, z});
    if (last < n->cells[0])
        search_cell(n, s, (int32_t[3]){last, y, z});
}

static void search_shell(const nearest *n, search *s, const int32_t centre[3], int32_t shell)
{
    int32_t last_y = limited(centre[1] + shell, n->cells[1]);
    int32_t last_z = limited(centre[2] + shell, n->cells[2]);
    for (int32_t z = limited(centre[2] - shell, n->cells[2]); z <= last_z; z++)
        for (int32_t y = limited(centre[1] - shell, n->cells[1]); y <= last_y; y++)
            search_row(n, s, centre, shell, y, z);
}

uint32_t nearest_find(const nearest *n, const float at[3])
{
    search s = {.at = at, .distance_squared = (double)INFINITY, .vertex = UINT32_MAX};
    if (n->member_count == 0)
        return s.vertex;
    int32_t centre[3];
    float inside[3]; /* nearest point of the box, the origin of the shells */
    for (int a = 0; a < 3; a++) {
        double most = n->low[a] + n->cells[a] * n->cell_size;
        inside[a] = (float)fmin(fmax((double)at[a], n->low[a]), most);
        centre[a] = cell_along(n, inside, a);
    }
    for (int32_t shell = 0; shell <= CELLS_MOST + 1; shell++) {
        /* Everything in this shell is at least this far from `inside`, and so from `at`. */
        double least = (shell - 1) * n->cell_size;
        if (shell > 0 && s.distance_squared < least * least)
            break;
        search_shell(n, &s, centre, shell);
    }
    return s.vertex;
}
