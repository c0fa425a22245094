#include "manner.h"

static const float least_stretch = 1.1f;

const char *const manner_preset_labels[] = {"Own", "Paper", NULL};

bool manner_is_paper(const double *manner)
{
    return manner[MANNER_PRESET] > 0.5;
}

void manner_set(mrt_pull *pull, const double *manner, float share_mm)
{
    float radius_mm = (float)manner[MANNER_RADIUS_MM], stretch = (float)manner[MANNER_STRETCH];
    bool is_paper = manner_is_paper(manner);
    pull->radius_mm = radius_mm > 0.0f ? radius_mm : share_mm;
    pull->solve = is_paper ? MRT_SOLVE_LINEAR | MRT_SOLVE_ONCE : 0;
    pull->stretch_most = stretch > least_stretch ? stretch : least_stretch;
    if (is_paper || !(stretch > 0.0f))
        pull->stretch_most = -1.0f;
}
