/* plugins/one_hand on the puppet, by bare hands of people as a Leap Motion saw them, with the
 * tracker's noise and losses: ../shared/data/leap. Points go the way of the camera's and the
 * headset's: hand_read, bare_hand_turn, landmark_filter. Pictures are 60 a second. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "bare_hand.h"
#include "hand_recordings.h"
#include "resume_scene.h"

enum { POINTS_MOST = 40000 };
static const double picture_s = 1.0 / 60.0;

typedef struct person {
    face_file file;
    plugin_list plugins;
    log_queue *log;
    instance mapping;
    performer *performer;
    bare_hand hand;
    mrt_channel channel[MRT_ANGLES];
    channel_route route;
    uint32_t skull;
} person;

static void begin(person *p)
{
    error err = {""};
    const mrt_plugin_type *type;
    *p = (person){.log = log_queue_create(), .hand = {.follows_wrist = true}};
    scene_face(&p->file, "puppet");
    scene_must(plugin_list_add(&p->plugins, BUILD_DIR "/plugins/one_hand.so", &err), &err);
    scene_must(plugin_list_find(&p->plugins, "one_hand", MRT_MAPPING, &type, &err), &err);
    scene_must(instance_create(&p->mapping, type, CLOCK_VIRTUAL, p->log, &err), &err);
    scene_must(
        performer_create(&p->performer, &p->file, &p->mapping, &(performer_settings){0}, &err),
        &err);
    face_set_springs(composer_face(p->performer->composer), 0.0); /* the hand alone is measured */
    while (strcmp(p->file.rig->bone[p->skull].name, "skull") != 0)
        p->skull += 1;
    for (uint32_t i = 0; i < MRT_ANGLES; ++i)
        p->channel[i] =
            (mrt_channel){"angle", MRT_UNIT_LANDMARKS, MRT_CH_ANGLE + i, MRT_RIGHT, -0.7f, 2.2f};
    channel_route_init(&p->route, p->channel, MRT_ANGLES);
    channel_route_call(&p->route, "camera");
}

static void end(person *p)
{
    performer_destroy(p->performer);
    instance_destroy(&p->mapping);
    plugin_list_destroy(&p->plugins);
    log_queue_destroy(p->log);
    face_file_destroy(&p->file);
}

static void show(person *p, const recording *of, uint32_t row)
{
    mrt_hand_reading seen = {.confidence = 1.0f};
    mrt_sample sample = {
        .time_ns = (int64_t)(1e9 * of->time_s[row]), .sequence = row, .count = MRT_ANGLES};
    memcpy(seen.angle, of->angle_rad[row], sizeof seen.angle);
    for (int i = 0; i < 4; ++i)
        seen.wrist[3 + i] = (float)of->wrist_xyzw[row][i];
    bare_hand_turn(&p->hand, MRT_RIGHT, &seen);
    memcpy(sample.value, seen.angle, sizeof seen.angle);
    const sample_step step = sample_step_of(&p->route, &sample);
    frame_run(p->performer, &step);
}

/* The skin in the skull's frame: count by 3, mm; and how the head is turned. */
static rigid look(const person *p, double *out)
{
    const face *f = composer_face(p->performer->composer);
    const points *shown = face_shown(f);
    rigid pose[RIG_BONES_MAX];
    bones_pose(pose, face_bones(f), face_metered(f)->dof);
    const rigid back = rigid_inverse(&pose[p->skull]);
    for (uint32_t i = 0; i < shown->count; ++i) {
        double at[3];
        points_at(at, shown, i);
        const vec3 v = rigid_apply(&back, (vec3){at[0], at[1], at[2]});
        out[3 * i] = v.x;
        out[3 * i + 1] = v.y;
        out[3 * i + 2] = v.z;
    }
    return pose[p->skull];
}

static double apart(const double *a, const double *b, uint32_t count)
{
    double most2 = 0.0;
    for (uint32_t i = 0; i < count; ++i, a += 3, b += 3)
        most2 = fmax(most2, (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                                (a[2] - b[2]) * (a[2] - b[2]));
    return sqrt(most2);
}

static double turned_deg(const rigid *a, const rigid *b)
{
    const vec3 ahead = {0.0, 0.0, 1.0};
    const vec3 x = rigid_rotate(a, ahead), y = rigid_rotate(b, ahead);
    return 57.29578 * vec3_length(vec3_sub(x, y));
}

/* Root of the sum of the squares, without the wrist. */
static double hand_way_deg(const float *a, const float *b)
{
    double sum = 0.0;
    for (int i = 0; i < 20; ++i)
        sum += (double)((a[i] - b[i]) * (a[i] - b[i]));
    return 57.29578 * sqrt(sum);
}

/* Greatest of all pictures. At rest: the hand went less than 0.8 degrees in each of the last six.
 */
typedef struct seen {
    double moved_mm, step_mm, step_s, rest_step_mm, turn_deg, determinant;
} seen;

enum { REST_PICTURES = 6 };
static const double rest_deg = 0.8;

static seen perform(const recording *of)
{
    static person p;
    static double face_at[3][3 * POINTS_MOST];
    seen out = {.determinant = 1.0};
    double *rest = face_at[0], *last = face_at[1], *now = face_at[2];
    float hand[MRT_ANGLES];
    uint32_t row = 0, still = 0;
    begin(&p);
    const face *f = composer_face(p.performer->composer);
    const uint32_t count = face_shown(f)->count;
    assert_true(count <= POINTS_MOST);
    composer_draw(p.performer->composer);
    rigid head = look(&p, rest);
    memcpy(last, rest, 3 * sizeof *rest * count);
    memcpy(hand, of->angle_rad[0], sizeof hand);
    for (double at_s = of->time_s[0]; row < of->count; at_s += picture_s) {
        while (row < of->count && of->time_s[row] <= at_s)
            show(&p, of, row++);
        composer_draw(p.performer->composer);
        const rigid head_now = look(&p, now);
        const float *hand_now = p.performer->voice[0].layer->frame.hand[MRT_RIGHT].angle;
        const double step_mm = apart(now, last, count), hand_deg = hand_way_deg(hand_now, hand);
        const double turn_deg = turned_deg(&head_now, &head);
        if (step_mm > out.step_mm) {
            out.step_mm = step_mm;
            out.step_s = at_s;
        }
        still = hand_deg < rest_deg ? still + 1 : 0;
        if (still >= REST_PICTURES)
            out.rest_step_mm = fmax(out.rest_step_mm, step_mm);
        out.turn_deg = fmax(out.turn_deg, turn_deg);
        out.moved_mm = fmax(out.moved_mm, apart(now, rest, count));
        out.determinant = fmin(out.determinant, face_measure_surface(f).min_determinant);
        double *spare = last;
        last = now;
        now = spare;
        head = head_now;
        memcpy(hand, hand_now, sizeof hand);
    }
    end(&p);
    return out;
}

static void bare_hands_move_the_face_without_a_fold_or_a_jump(void **state)
{
    (void)state;
    static const char *const name[] = {"HandSplay-110fps.csv",    "grab.csv",        "gun.csv",
                                       "rollAndPitchCropped.csv", "three-claps.csv", "wave.csv"};
    static recording of;
    hand_skeleton *skeleton[2] = {hand_skeleton_create(MRT_LEFT, HAND_LENGTH_MM),
                                  hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM)};
    int missing = 0;
    for (size_t i = 0; i < sizeof name / sizeof *name; ++i) {
        char path[64];
        (void)snprintf(path, sizeof path, "leap/%s", name[i]);
        if (read_leap(&of, path, skeleton) == 0) {
            missing += 1;
            continue;
        }
        const seen s = perform(&of);
        print_message("  %s: the skin moves %.1f mm, in one picture %.1f mm (at %.2f s), at rest "
                      "%.2f mm; the head %.1f degrees; least determinant %.2f\n",
                      name[i], s.moved_mm, s.step_mm, s.step_s, s.rest_step_mm, s.turn_deg,
                      s.determinant);
        assert_true(s.moved_mm > 5.0);
        assert_true(s.determinant > 0.0);
        assert_true(s.step_mm < 10.0 && s.turn_deg < 12.0);
        assert_true(s.rest_step_mm < 0.8);
    }
    for (int side = 0; side < 2; ++side)
        hand_skeleton_destroy(skeleton[side]);
    if (missing == 0)
        return;
    print_message("SKIPPED: %d recordings are not in shared/data/leap (set MAROTTE_SHARED)\n",
                  missing);
    skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bare_hands_move_the_face_without_a_fold_or_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
