/* hands/clutch.h - when the hands take hold of a face, let go of it, and keep what they made: the
 * triggers and pedals of mappings that engage, release and commit. [frame] */
#ifndef MAROTTE_PLUGINS_HANDS_CLUTCH_H
#define MAROTTE_PLUGINS_HANDS_CLUTCH_H
#include <marotte/plugin.h>

/* The parameters, in this order, behind the placement's; ids 20 to 28. */
enum {
    CLUTCH_START = 0, /* engage at once, or wait for the trigger */
    CLUTCH_ENGAGE,
    CLUTCH_RELEASE,
    CLUTCH_COMMIT,
    CLUTCH_ENGAGE_PEDAL, /* 0: none */
    CLUTCH_RELEASE_PEDAL,
    CLUTCH_COMMIT_PEDAL,
    CLUTCH_ON_RELEASE, /* hold or spring back */
    CLUTCH_RELEASE_TIME,
    CLUTCH_COUNT
};
extern const char *const clutch_start_labels[];
extern const char *const clutch_pedal_labels[];
extern const char *const clutch_release_labels[];
/* CLUTCH_PARAMS with another initial value of what comes on release. */
/* clang-format off */
#define CLUTCH_PARAMS CLUTCH_PARAMS_WITH(0)
#define CLUTCH_PARAMS_WITH(on_release) \
    {20, MRT_PARAM_STEPPED, "Start", "Clutch", "", "When the hands first take hold of the face.", \
     0, 1, 0, clutch_start_labels}, \
    {21, MRT_PARAM_TRIGGER, "Engage", "Clutch", "", \
     "Takes hold where the hands are now; the face does not jump.", 0, 1, 0, NULL}, \
    {22, MRT_PARAM_TRIGGER, "Release", "Clutch", "", "Lets go of the face.", 0, 1, 0, NULL}, \
    {23, MRT_PARAM_TRIGGER, "Commit", "Clutch", "", \
     "Keeps the shape shown as the new base, and takes hold anew.", 0, 1, 0, NULL}, \
    {24, MRT_PARAM_STEPPED, "Engage pedal", "Clutch", "", "Pedal that engages.", \
     0, 4, 0, clutch_pedal_labels}, \
    {25, MRT_PARAM_STEPPED, "Release pedal", "Clutch", "", "Pedal that releases.", \
     0, 4, 0, clutch_pedal_labels}, \
    {26, MRT_PARAM_STEPPED, "Commit pedal", "Clutch", "", "Pedal that commits.", \
     0, 4, 0, clutch_pedal_labels}, \
    {27, MRT_PARAM_STEPPED, "On release", "Clutch", "", \
     "Hold: the face stays as it is. Spring back: it eases back to its base.", \
     0, 1, on_release, clutch_release_labels}, \
    {28, 0, "Release time", "Clutch", "s", "How long springing back takes.", 0.02, 5, 0.25, NULL}
/* clang-format on */

typedef struct clutch {
    bool has_started;
    bool was_down[MRT_MAX_PEDALS];
} clutch;

/* For a list of memory.h. */
#define CLUTCH_MEMORY(clutch) MEMORY_BOOLS((clutch).has_started), MEMORY_BOOLS((clutch).was_down)

typedef struct clutch_events {
    bool engage, release, commit; /* asked for in this frame */
} clutch_events;

void clutch_reset(clutch *self);
/* params: the clutch's part of the parameter values. */
clutch_events clutch_step(clutch *self, const mrt_frame *frame, const double *params);

bool clutch_springs_back(const double *params);
/* The rate at which it does, 1/s: after the release time e^-3 = 5 % of the way are left. */
float clutch_release_rate(const double *params);

#endif
