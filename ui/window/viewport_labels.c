#include "window/viewport_labels.h"

static const float gap = 4.0f; /* between a dot and its name */

static bool overlap(const ui_rectangle *a, const ui_rectangle *b)
{
    return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height &&
           b->y < a->y + a->height;
}

static bool is_inside(const ui_rectangle *a, const ui_rectangle *of)
{
    return a->x >= of->x && a->y >= of->y && a->x + a->width <= of->x + of->width &&
           a->y + a->height <= of->y + of->height;
}

static ui_rectangle name_of(const viewport_label *l)
{
    return (ui_rectangle){l->at_x, l->at_y, l->width, l->height};
}

static ui_rectangle dot_of(const viewport_label *l, float dot)
{
    return (ui_rectangle){l->x - dot, l->y - dot, 2.0f * dot, 2.0f * dot};
}

/* Where a name may be: right, left, above, below. */
enum { PLACES = 4 };
static void put(viewport_label *l, int place, float dot)
{
    float middle_x = l->x - 0.5f * l->width, middle_y = l->y - 0.5f * l->height;
    float away = dot + gap;
    l->at_x = place == 0 ? l->x + away : place == 1 ? l->x - away - l->width : middle_x;
    l->at_y = place == 2 ? l->y - away - l->height : place == 3 ? l->y + away : middle_y;
}

static bool is_free(const viewport_label *label, uint32_t count, uint32_t self,
                    const ui_rectangle *within, float dot)
{
    ui_rectangle name = name_of(&label[self]);
    if (!is_inside(&name, within))
        return false;
    for (uint32_t i = 0; i < count; ++i) {
        ui_rectangle other_dot = dot_of(&label[i], dot), other = name_of(&label[i]);
        if (i != self && overlap(&name, &other_dot))
            return false;
        if (i < self && label[i].is_placed && overlap(&name, &other))
            return false;
    }
    return true;
}

void viewport_labels_place(viewport_label *label, uint32_t count, ui_rectangle within, float dot)
{
    for (uint32_t i = 0; i < count; ++i) {
        label[i].is_placed = false;
        for (int place = 0; place < PLACES && !label[i].is_placed; ++place) {
            put(&label[i], place, dot);
            label[i].is_placed = is_free(label, count, i, &within, dot);
        }
    }
}
