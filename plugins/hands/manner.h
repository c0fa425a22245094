/* manner.h - how the paper's two mappings have their field solved: its radius in mm, how far the
 * skin may be stretched, or all of it to the letter of the paper. */
#ifndef MAROTTE_PLUGINS_MANNER_H
#define MAROTTE_PLUGINS_MANNER_H
#include <marotte/plugin.h>

/* Of the parameters, in the order of MANNER_PARAMS. */
enum { MANNER_PRESET, MANNER_RADIUS_MM, MANNER_STRETCH, MANNER_COUNT };

/* The paper to the letter: its linear polynomial, gain 1, no soft reach, one step a sample, and
 * nothing held back: what that folds and tears is counted. */
bool manner_is_paper(const double *manner);

/* The pull's radius and how it is solved. share_mm: the radius where it is not said in mm. */
void manner_set(mrt_pull *pull, const double *manner, float share_mm);

extern const char *const manner_preset_labels[];

/* clang-format off */
#define MANNER_PARAMS                                                                              \
    {40, MRT_PARAM_STEPPED, "Preset", "Solver", "",                                                \
     "Paper: gain 1, a linear polynomial, no soft reach, one step a sample, nothing held back.",   \
     0, 1, 0, manner_preset_labels},                                                               \
    {41, 0, "Radius mm", "Solver", "mm",                                                           \
     "Support radius of each point; 0: the radius in per cent of the face's height.",              \
     0, 1000, 0, NULL},                                                                            \
    {42, 0, "Stretch", "Solver", "times",                                                          \
     "An edge of the skin is stretched so many times at most, and nothing folds: less is given "   \
     "then; 0: never.",                                                                            \
     0, 50, 8, NULL}
/* clang-format on */

#endif
