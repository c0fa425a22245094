/* hands/placement.h - placement of a performer's hands in a face, for mappings that pull with
 * points of the hand: which points, their size, posture and position. In the first frame with a
 * hand, the centre of its fingertips is placed at the position set by the parameters. After that
 * the hand moves freely. Pure functions of frame and parameters; [frame]. */
#ifndef MAROTTE_PLUGINS_HANDS_PLACEMENT_H
#define MAROTTE_PLUGINS_HANDS_PLACEMENT_H
#include <marotte/plugin.h>

/* The parameters in this order, first in the table of every mapping that uses them. */
enum {
    PLACEMENT_HANDS = 0, /* which hands pull */
    PLACEMENT_PALM,      /* palm points too */
    PLACEMENT_POSTURE,
    PLACEMENT_SIZE,
    PLACEMENT_ACROSS,
    PLACEMENT_UP,
    PLACEMENT_DEPTH,
    PLACEMENT_APART,
    PLACEMENT_PITCH,
    PLACEMENT_YAW,
    PLACEMENT_ROLL,
    PLACEMENT_COUNT
};
enum { PLACEMENT_POINTS_MAX = 2 * (5 + MRT_PALM) };

extern const char *const placement_hands_labels[];
extern const char *const placement_off_on_labels[];
extern const char *const placement_posture_labels[];
/* PLACEMENT_PARAMS with other initial values: palm, posture, size, up, depth, apart, roll. */
/* clang-format off */
#define PLACEMENT_PARAMS PLACEMENT_PARAMS_WITH(0, 0, 90, 36, 95, 0, -45)
#define PLACEMENT_PARAMS_WITH(palm, posture, size, up, depth, apart, roll) \
    {1, MRT_PARAM_STEPPED, "Hands", "Points", "", "Hands that pull.", \
     0, 2, 0, placement_hands_labels}, \
    {2, MRT_PARAM_STEPPED, "Palm", "Points", "", "Pull with eight points of the palm too.", \
     0, 1, palm, placement_off_on_labels}, \
    {3, MRT_PARAM_STEPPED, "Posture", "Placement", "", \
     "In the head: fingers point out of the face, as in a puppet. Before the face: palm to " \
     "the face, fingers up.", 0, 1, posture, placement_posture_labels}, \
    {4, 0, "Size", "Placement", "%", \
     "Length of the hand, in per cent of the face's height.", 10, 300, size, NULL}, \
    {5, 0, "Across", "Placement", "%", \
     "Position of the fingertips: 0 the subject's right edge of the face, 100 the left.", \
     -100, 200, 50, NULL}, \
    {6, 0, "Up", "Placement", "%", \
     "Position of the fingertips: 0 the lower edge of the face, 100 the top.", \
     -100, 200, up, NULL}, \
    {7, 0, "Depth", "Placement", "%", \
     "Position of the fingertips: 0 the back, 100 the front.", -100, 200, depth, NULL}, \
    {8, 0, "Apart", "Placement", "%", \
     "Distance of two hands, in per cent of the face's width. 0: side by side, scaled to fit, " \
     "thumbs down, fingers up.", \
     0, 200, apart, NULL}, \
    {9, 0, "Pitch", "Placement", "deg", "Turn the hand: fingertips up.", -180, 180, 0, NULL}, \
    {10, 0, "Yaw", "Placement", "deg", "Turn the hand: fingertips to the thumb's side.", \
     -180, 180, 0, NULL}, \
    {11, 0, "Roll", "Placement", "deg", "Turn the hand about its fingers: thumb up.", \
     -180, 180, roll, NULL}
/* clang-format on */

typedef struct placement {
    mrt_vec3 low, size; /* of the face, mm */
    bool is_laid[2];
    mrt_vec3 home[2]; /* hand frame: point placed at the position of the parameters */
    bool has_told;    /* whether the warning about shared points was logged */
} placement;

/* For a memory_list: the state that activate does not derive. */
#define PLACEMENT_MEMORY(placement)                                                                \
    MEMORY_BOOLS((placement).is_laid), MEMORY_FLOATS((placement).home)

void placement_activate(placement *self, const mrt_face *face);
void placement_reset(placement *self); /* the next frame places the hands again */

/* Returns true if this hand is present and selected by the parameters. */
bool placement_pulls(const mrt_frame *frame, uint32_t side);

/* Writes the points of the hands in the face frame, mm: per hand (left first) the fingertips from
 * thumb to little finger, then the palm points. Returns their number; 0 if no selected hand is
 * present. */
uint32_t placement_points(placement *self, const mrt_frame *frame,
                          mrt_vec3 out_point[PLACEMENT_POINTS_MAX]);

/* Groups points that are near to each other compared with the radius, directly or through other
 * points. Such points share one place, because otherwise they would tear the surface; this is
 * logged once. out_leader[i] is the first point of the group of point i. */
void placement_share(placement *self, const mrt_host *host, const mrt_vec3 *point, uint32_t count,
                     float radius_mm, uint32_t out_leader[PLACEMENT_POINTS_MAX]);
/* Replaces each point by the mean of its group. */
void placement_blend(mrt_vec3 *point, uint32_t count, const uint32_t *leader);

/* Returns p, or the nearest point within four sizes of the face: the host rejects a pull beyond
 * ten. For mappings that add up the movements of hands. */
mrt_vec3 placement_within_reach(const placement *self, mrt_vec3 p);

/* Returns the height of the face, mm, at least 1. */
float placement_face_height(const placement *self);

/* ---- solver settings of the paper's two mappings: the radius in mm, the largest stretch of the
 * skin, or the exact method of the paper ---- */

/* Parameter indices, in the order of SOLVER_PARAMS. */
enum { SOLVER_PRESET, SOLVER_RADIUS_MM, SOLVER_STRETCH, SOLVER_COUNT };

/* The exact method of the paper: its linear polynomial, gain 1, no soft reach, one step per sample,
 * and no limits. Folds and tears are only counted. */
bool solver_is_paper(const double *solver);

/* Sets the pull's radius and solver. share_mm: the radius, unless it is set in mm. */
void solver_set(mrt_pull *pull, const double *solver, float share_mm);

extern const char *const solver_preset_labels[];

/* clang-format off */
#define SOLVER_PARAMS                                                                              \
    {40, MRT_PARAM_STEPPED, "Preset", "Solver", "",                                                \
     "Paper: gain 1, linear polynomial, no soft reach, one step per sample, no limits.",   \
     0, 1, 0, solver_preset_labels},                                                               \
    {41, 0, "Radius mm", "Solver", "mm",                                                           \
     "Support radius of each point; 0: the radius in per cent of the face's height.",              \
     0, 1000, 0, NULL},                                                                            \
    {42, 0, "Stretch", "Solver", "times",                                                          \
     "Largest stretch of an edge of the skin. A pull that stretches more, or folds, is reduced. "  \
     "0: no limit.",                                                                               \
     0, 50, 8, NULL}
/* clang-format on */

#endif
