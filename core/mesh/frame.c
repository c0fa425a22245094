#include "mesh/frame.h"

#include "base/text.h"

#include <string.h>

bool mesh_unit_parse(double *out_mm, const char *word)
{
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}};
    for (size_t i = 0; i < sizeof units / sizeof *units; ++i)
        if (strcmp(units[i].name, word) == 0) {
            *out_mm = units[i].mm;
            return true;
        }
    double mm;
    if (!text_double(text_view_of(word, strlen(word)), &mm) || !(mm >= 1e-9 && mm <= 1e9))
        return false;
    *out_mm = mm;
    return true;
}

static const char *const axis_names[] = {"", "x", "y", "z", "-x", "-y", "-z"};

bool mesh_axis_parse(mesh_axis *out, const char *word)
{
    const char *plain = word[0] == '+' ? word + 1 : word;
    for (int axis = MESH_AXIS_X; axis <= MESH_AXIS_MINUS_Z; ++axis)
        if (strcmp(axis_names[axis], plain) == 0) {
            *out = (mesh_axis)axis;
            return true;
        }
    return false;
}

const char *mesh_axis_name(mesh_axis axis)
{
    return axis_names[axis];
}
