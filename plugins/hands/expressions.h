/* hands/expressions.h - named expressions of a face (smile, blink, nod ...), each made of the
 * contacts and degrees of freedom that the rig has. Leaves out when they are shown. */
#ifndef MAROTTE_PLUGINS_HANDS_EXPRESSIONS_H
#define MAROTTE_PLUGINS_HANDS_EXPRESSIONS_H
#include <marotte/plugin.h>

typedef enum expression {
    EXPRESSION_NEUTRAL = 0,
    EXPRESSION_SMILE,
    EXPRESSION_FROWN,
    EXPRESSION_JAW_OPEN,
    EXPRESSION_BROWS_UP,
    EXPRESSION_BROWS_DOWN,
    EXPRESSION_PUCKER,
    EXPRESSION_BLINK,
    EXPRESSION_WINK,
    EXPRESSION_NOD,
    EXPRESSION_COUNT
} expression;
/* NULL-ended: also labels of a parameter */
extern const char *const expression_names[EXPRESSION_COUNT + 1];

enum { EXPRESSIONS_CONTACTS_MAX = 32, EXPRESSIONS_DOFS_MAX = 16 };
typedef struct expressions {
    bool can[EXPRESSION_COUNT];
    uint32_t contact_count, dof_count;          /* used by an expression and present in the face */
    uint32_t contact[EXPRESSIONS_CONTACTS_MAX]; /* indices of the face's */
    uint32_t dof[EXPRESSIONS_DOFS_MAX];
    mrt_vec3 rest[EXPRESSIONS_CONTACTS_MAX];
    mrt_vec3 way[EXPRESSION_COUNT][EXPRESSIONS_CONTACTS_MAX]; /* mm, at full */
    float turn[EXPRESSION_COUNT][EXPRESSIONS_DOFS_MAX];       /* in the dof's unit, at full */
} expressions;

/* The poses of a face (MRT_RIG_POSES), one of which a parameter chooses (MRT_PARAM_POSE). Zeroed:
 * none. */
enum { EXPRESSIONS_POSES_MAX = 256 };
typedef struct expression_poses {
    const mrt_face *face;
    const mrt_rig_pose *pose;
    uint32_t count;
    uint32_t value[EXPRESSIONS_POSES_MAX]; /* mrt_pose_value of each */
} expression_poses;
/* [main] The poses stay valid until the next call. Further ones than EXPRESSIONS_POSES_MAX are left
 * out. */
void expression_poses_set(expression_poses *out, const mrt_face *face, const mrt_rig_pose *poses,
                          uint32_t count);
typedef struct expression_played { /* a pose that is shown beside the expressions */
    const mrt_rig_pose *pose;      /* NULL: none was chosen, or the face lacks it */
    double strength;
} expression_played;
/* [frame] value: of the parameter. NULL: see expression_played. */
const mrt_rig_pose *expression_poses_find(const expression_poses *self, double value);

/* [main] Returns false if the face can show no expression. Logs that, and what is missing. */
bool expressions_find(expressions *out, const mrt_face *face, const mrt_host *host);
/* [frame] Writes the anchored pull for a mix of expressions and poses: part 0 not at all .. 1 in
 * full. Does not change contacts and degrees of freedom that no expression uses. A chosen pose
 * holds all contacts. */
void expressions_write(const expressions *self, const double part[EXPRESSION_COUNT],
                       const expression_poses *of, const expression_played *played,
                       uint32_t played_count, mrt_pull *pull);

#endif
