#include "window/mapping_panel_pedal_table.h"

#include <stdio.h>
#include <string.h>

static const char ending[] = " pedal";

bool pedal_table_meaning(const mrt_param *param, char out[PEDAL_MEANING])
{
    size_t length = strlen(param->name), tail = sizeof ending - 1;
    bool is_pedal = (param->flags & MRT_PARAM_STEPPED) && length > tail &&
                    strcmp(param->name + length - tail, ending) == 0 && param->min >= 0.0 &&
                    param->min <= 0.0 && param->max <= MRT_MAX_PEDALS;
    if (is_pedal)
        (void)snprintf(out, PEDAL_MEANING, "%.*s", (int)(length - tail), param->name);
    return is_pedal;
}

void pedal_table_words(const mrt_plugin_type *type, const double *values, uint32_t pedal, char *out,
                       size_t capacity)
{
    char meaning[PEDAL_MEANING];
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < type->param_count && used < capacity; ++i) {
        if (!pedal_table_meaning(&type->params[i], meaning) || (uint32_t)values[i] != pedal)
            continue;
        int length = snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", meaning);
        used += length > 0 ? (size_t)length : 0;
    }
}
