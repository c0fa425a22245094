/* hands/acts.h - what a face can do by name (smile, blink, nod ...): each act made of the contacts
 * and degrees of freedom that a rig names, and of those that it has. Leaves out when. */
#ifndef MAROTTE_PLUGINS_HANDS_ACTS_H
#define MAROTTE_PLUGINS_HANDS_ACTS_H
#include <marotte/plugin.h>

typedef enum act {
    ACT_NEUTRAL = 0,
    ACT_SMILE,
    ACT_FROWN,
    ACT_JAW_OPEN,
    ACT_BROWS_UP,
    ACT_BROWS_DOWN,
    ACT_PUCKER,
    ACT_BLINK,
    ACT_WINK,
    ACT_NOD,
    ACT_COUNT
} act;
extern const char *const act_names[ACT_COUNT + 1]; /* NULL-ended: also labels of a parameter */

enum { ACTS_CONTACTS_MAX = 32, ACTS_DOFS_MAX = 16 };
typedef struct acts {
    bool can[ACT_COUNT];
    uint32_t contact_count, dof_count; /* that any act needs and the face has */
    uint32_t contact[ACTS_CONTACTS_MAX], dof[ACTS_DOFS_MAX]; /* indices of the face's */
    mrt_vec3 rest[ACTS_CONTACTS_MAX];
    mrt_vec3 way[ACT_COUNT][ACTS_CONTACTS_MAX]; /* mm, at full */
    float turn[ACT_COUNT][ACTS_DOFS_MAX];       /* in the degree of freedom's unit, at full */
} acts;

/* [main] False: the face can do nothing of all that; the log says so, and what it misses. */
bool acts_find(acts *out, const mrt_face *face, const mrt_host *host);
/* [frame] The anchored pull in which each act is done in part: 0 not at all .. 1 in full. Contacts
 * and degrees of freedom that no act needs are left alone. */
void acts_write(const acts *self, const double part[ACT_COUNT], mrt_pull *pull);

#endif
