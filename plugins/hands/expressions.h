/* hands/expressions.h - what a face can do by name (smile, blink, nod ...): each expression made of
 * the contacts and degrees of freedom that a rig names, and of those that it has. Leaves out when.
 */
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
    uint32_t contact_count, dof_count;          /* that any expression needs and the face has */
    uint32_t contact[EXPRESSIONS_CONTACTS_MAX]; /* indices of the face's */
    uint32_t dof[EXPRESSIONS_DOFS_MAX];
    mrt_vec3 rest[EXPRESSIONS_CONTACTS_MAX];
    mrt_vec3 way[EXPRESSION_COUNT][EXPRESSIONS_CONTACTS_MAX]; /* mm, at full */
    float turn[EXPRESSION_COUNT][EXPRESSIONS_DOFS_MAX];       /* in the dof's unit, at full */
} expressions;

/* [main] False: the face can do nothing of all that; the log says so, and what it misses. */
bool expressions_find(expressions *out, const mrt_face *face, const mrt_host *host);
/* [frame] The anchored pull in which each expression is done in part: 0 not at all .. 1 in full.
 * Contacts and degrees of freedom that no expression needs are left alone. */
void expressions_write(const expressions *self, const double part[EXPRESSION_COUNT],
                       mrt_pull *pull);

#endif
