#include "own_hands.h"

#include "cholesky.h"
#include "mapping.h"

#include <math.h>
#include <string.h>

/* Standard deviations of the prior, degrees. A performer may hold the whole hand differently, move
 * further or less far, and have habits for single faces. The last value is the error of a single
 * answer. */
static const double offset_deg = 4.0, habit_deg = 5.0, noise_deg = 2.0;
static const double share_of_way = 0.25; /* further or less far, per joint */
static const double reach_deg = 60.0;    /* reach of a habit, in distance of the hand poses */
static const double furthest_deg = 30.0; /* limit of the change of a hand pose by an answer */
static const float plausible_deg = 180.0f;

void own_hands_add(own_hands *to, device_kind device, int name, const double deg[JOINT_COUNT])
{
    if (to->device != device)
        memset(to, 0, sizeof *to);
    to->device = device;
    unsigned *rounds = &to->rounds[name];
    if (*rounds < OWN_HANDS_ROUNDS_MAX)
        *rounds += 1;
    for (int i = 0; i < JOINT_COUNT; ++i)
        to->deg[name][i] += ((float)deg[i] - to->deg[name][i]) / (float)*rounds;
}

void own_hands_forget(own_hands *from, int name)
{
    from->rounds[name] = 0;
    memset(from->deg[name], 0, sizeof from->deg[name]);
}

bool own_hands_are_plausible(const own_hands *all)
{
    for (int name = 0; name < FACE_NAMES; ++name)
        for (int i = 0; i < JOINT_COUNT; ++i)
            if (!(fabsf(all->deg[name][i]) <= plausible_deg))
                return false;
    return true;
}

/* Covariance of the changes of two hand poses, at one joint. */
static double covariance(const double *a, const double *b, int joint, int first, int end)
{
    double far2 = 0.0;
    for (int i = first; i < end; ++i)
        far2 += (a[i] - b[i]) * (a[i] - b[i]);
    const double r = sqrt(far2) / reach_deg;
    double near = r < 1.0 ? 8.0 * r + 1.0 : 0.0; /* Wendland C2 in up to 11 dimensions */
    for (int i = 0; i < 8 && r < 1.0; ++i)
        near *= 1.0 - r;
    return offset_deg * offset_deg + share_of_way * share_of_way * a[joint] * b[joint] +
           habit_deg * habit_deg * near;
}

typedef struct lesson { /* an answer for this half */
    double table_deg[JOINT_COUNT];
    const float *deg; /* the answered hand pose */
    unsigned rounds;
} lesson;

/* Returns the share of the answers that the table does not explain. */
static double strangeness(const lesson *lessons, int count, int first, int end)
{
    double off = 0.0, way = 0.0;
    for (int k = 0; k < count; ++k)
        for (int i = first; i < end; ++i) {
            const double by = (double)lessons[k].deg[i] - lessons[k].table_deg[i];
            off += by * by;
            way += lessons[k].table_deg[i] * lessons[k].table_deg[i];
        }
    return way > 0.0 ? off / way : 0.0;
}

static void hand_of_table(double out[JOINT_COUNT], device_kind device, int face)
{
    for (int i = 0; i < JOINT_COUNT; ++i)
        out[i] = (double)posed_hands[device][face].deg[i];
}

own_hands_verdict own_hands_bend(double out_deg[FACE_COUNT][JOINT_COUNT], const own_hands *all,
                                 device_kind device, face_half which)
{
    static const int judged_from = 4;
    static const double strangeness_most = 0.9;
    const int first = half_first_joint[which], end = half_first_joint[which + 1];
    lesson lessons[FACE_COUNT];
    int count = 0;
    for (int f = 0; f < FACE_COUNT; ++f) {
        hand_of_table(out_deg[f], device, f);
        const int name = face_name_of(f);
        if (face_recipes[f].half != which || all->device != device || all->rounds[name] == 0 ||
            posed_hands[device][f].same_as != FACE_IS_ITSELF)
            continue;
        memcpy(lessons[count].table_deg, out_deg[f], sizeof lessons[count].table_deg);
        lessons[count].deg = all->deg[name];
        lessons[count++].rounds = all->rounds[name];
    }
    if (count == 0)
        return OWN_HANDS_NONE;
    if (count >= judged_from && strangeness(lessons, count, first, end) > strangeness_most)
        return OWN_HANDS_NONSENSE;
    for (int joint = first; joint < end; ++joint) {
        cholesky m;
        double by[CHOLESKY_MAX];
        for (int i = 0; i < count; ++i) {
            for (int j = 0; j <= i; ++j)
                m.at[i][j] =
                    covariance(lessons[i].table_deg, lessons[j].table_deg, joint, first, end);
            m.at[i][i] += noise_deg * noise_deg / lessons[i].rounds;
            by[i] = (double)lessons[i].deg[joint] - lessons[i].table_deg[joint];
        }
        if (!cholesky_factor(&m, count))
            continue;
        cholesky_solve(&m, count, by);
        for (int f = 0; f < FACE_COUNT; ++f) {
            double table[JOINT_COUNT], way = 0.0;
            if (face_recipes[f].half != which || posed_hands[device][f].same_as == FACE_IS_MISSING)
                continue;
            hand_of_table(table, device, f);
            for (int i = 0; i < count; ++i)
                way += by[i] * covariance(table, lessons[i].table_deg, joint, first, end);
            out_deg[f][joint] = table[joint] + clamp(way, -furthest_deg, furthest_deg);
        }
    }
    return OWN_HANDS_TAKEN;
}
