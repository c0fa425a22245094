#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"
#include "hand/hand.h"

#include <ctype.h>

/* ---- a reader of BVH, after Meredith and Maddock, "Motion capture file formats explained" ---- */

enum { NODES = 64, CHANNELS = 6 };

typedef struct bvh_node {
    char name[64];
    int parent, channel_count;
    double offset[3];
    char channel[CHANNELS]; /* X Y Z: position; x y z: rotation */
} bvh_node;

typedef struct bvh_file {
    bvh_node node[NODES];
    int count, frame_count;
    double frame_s;
    FILE *stream; /* at the first frame */
} bvh_file;

static void word(FILE *stream, char out[64])
{
    assert_int_equal(fscanf(stream, "%63s", out), 1);
}

static void expect(FILE *stream, const char *wanted)
{
    char found[64];
    word(stream, found);
    assert_string_equal(found, wanted);
}

static double number(FILE *stream)
{
    double value;
    assert_int_equal(fscanf(stream, "%lf", &value), 1);
    assert_true(isfinite(value));
    return value;
}

static void read_node(bvh_file *out, int parent, const char *kind)
{
    char text[64];
    assert_in_range(out->count, 0, NODES - 1);
    int self = out->count++;
    bvh_node *n = &out->node[self];
    *n = (bvh_node){.parent = parent};
    word(out->stream, n->name);
    expect(out->stream, "{");
    expect(out->stream, "OFFSET");
    for (int k = 0; k < 3; ++k)
        n->offset[k] = number(out->stream);
    if (strcmp(kind, "End") == 0) {
        expect(out->stream, "}");
        return;
    }
    expect(out->stream, "CHANNELS");
    n->channel_count = (int)number(out->stream);
    assert_in_range(n->channel_count, 1, CHANNELS);
    for (int i = 0; i < n->channel_count; ++i) {
        word(out->stream, text);
        bool is_turn = strcmp(text + 1, "rotation") == 0;
        assert_true(is_turn || strcmp(text + 1, "position") == 0);
        n->channel[i] = is_turn ? (char)tolower(text[0]) : text[0];
    }
    for (word(out->stream, text); strcmp(text, "}") != 0; word(out->stream, text)) {
        assert_true(strcmp(text, "JOINT") == 0 || strcmp(text, "End") == 0);
        read_node(out, self, text);
    }
}

static void open_bvh(bvh_file *out, const char *path)
{
    *out = (bvh_file){.stream = fopen(path, "r")};
    assert_non_null(out->stream);
    expect(out->stream, "HIERARCHY");
    expect(out->stream, "ROOT");
    read_node(out, -1, "ROOT");
    expect(out->stream, "MOTION");
    expect(out->stream, "Frames:");
    out->frame_count = (int)number(out->stream);
    expect(out->stream, "Frame");
    expect(out->stream, "Time:");
    out->frame_s = number(out->stream);
}

/* Turns are multiplied in the order of their channels. */
static void read_frame(bvh_file *of, rigid *out)
{
    static const vec3 origin = {0, 0, 0};
    for (int i = 0; i < of->count; ++i) {
        const bvh_node *n = &of->node[i];
        rigid local = rigid_identity();
        double at[3] = {n->offset[0], n->offset[1], n->offset[2]};
        for (int k = 0; k < n->channel_count; ++k) {
            double value = number(of->stream);
            char of_what = n->channel[k];
            if (isupper(of_what)) {
                at[of_what - 'X'] = value;
                continue;
            }
            vec3 axis = {of_what == 'x', of_what == 'y', of_what == 'z'};
            rigid turn = rigid_turn(origin, axis, value * 3.14159265358979323846 / 180.0);
            local = rigid_compose(&local, &turn);
        }
        local.t = (vec3){at[0], at[1], at[2]};
        out[i] = n->parent < 0 ? local : rigid_compose(&out[n->parent], &local);
    }
}

static int find(const bvh_file *of, const char *name)
{
    for (int i = 0; i < of->count; ++i)
        if (strcmp(of->node[i].name, name) == 0)
            return i;
    fail_msg("no joint %s", name);
    return -1;
}

/* ---- hands ---- */

static char folder[256], path[300];
static mesh sheet;

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "hands.bvh");
    sheet = scene_sheet(3);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    mesh_destroy(&sheet);
    (void)unlink(path);
    return rmdir(folder);
}

/* Every sensor moves, by its own frequency: fists, spreads, arches, thumbs across the palm. */
static void pose_at(double joint[MRT_JOINTS * 3], uint32_t side, double length_mm, int frame,
                    const rigid *wrist)
{
    float angle[MRT_ANGLES];
    mrt_vec3 at[MRT_JOINTS], palm[MRT_PALM];
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle[i] = (float)(0.6 + 0.7 * sin(0.37 * frame * (1.0 + 0.21 * i) + i));
    hand_skeleton *skeleton = hand_skeleton_create(side, length_mm);
    assert_non_null(skeleton);
    hand_pose(skeleton, angle, wrist, at, palm);
    hand_skeleton_destroy(skeleton);
    for (size_t i = 0; i < MRT_JOINTS; ++i) {
        joint[i * 3] = (double)at[i].x;
        joint[i * 3 + 1] = (double)at[i].y;
        joint[i * 3 + 2] = (double)at[i].z;
    }
}

enum { FRAMES = 40 };

/* The left hand is of another length, tracked, and away now and then. */
static clip *hands_clip(void)
{
    error err;
    clip *c = clip_create(&sheet, 25.0, NULL, &err);
    assert_non_null(c);
    for (int frame = 0; frame < FRAMES; ++frame) {
        double joint[MRT_JOINTS * 3];
        const vec3 up = {0, 1, 0};
        rigid still = rigid_identity(), wrist = rigid_turn((vec3){30, 0, 0}, up, 0.1 * frame);
        assert_int_equal(clip_add_free(c, sheet.position, &err), MRT_OK);
        pose_at(joint, MRT_RIGHT, 190, frame, &still);
        assert_int_equal(clip_add_hand(c, MRT_RIGHT, joint, &err), MRT_OK);
        pose_at(joint, MRT_LEFT, 165, frame, &wrist);
        if (frame % 10 != 7)
            assert_int_equal(clip_add_hand(c, MRT_LEFT, joint, &err), MRT_OK);
    }
    return c;
}

static const char *const names[MRT_JOINTS] = {
    "Hand",      "ThumbMetacarpal", "ThumbProximal",      "ThumbDistal",
    "ThumbTip",  "IndexProximal",   "IndexIntermediate",  "IndexDistal",
    "IndexTip",  "MiddleProximal",  "MiddleIntermediate", "MiddleDistal",
    "MiddleTip", "RingProximal",    "RingIntermediate",   "RingDistal",
    "RingTip",   "LittleProximal",  "LittleIntermediate", "LittleDistal",
    "LittleTip"};

static void joints_of_both_hands_stand_where_they_stood(void **state)
{
    (void)state;
    static const char *const side_name[2] = {"Left", "Right"};
    error err;
    bvh_file read;
    rigid at[NODES];
    clip *c = hands_clip();
    assert_int_equal(bvh_write(path, c, 10.0, NULL, &err), MRT_OK);
    open_bvh(&read, path);
    assert_int_equal(read.count, 1 + 2 * (MRT_JOINTS + 5));
    assert_int_equal(read.frame_count, FRAMES);
    assert_true(fabs(read.frame_s - 0.04) < 1e-9);
    double worst_mm = 0.0;
    for (uint32_t frame = 0; frame < FRAMES; ++frame) {
        read_frame(&read, at);
        for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
            const double *hand = clip_hand(c, frame, side);
            assert_true(hand || frame % 10 == 7);
            for (int i = 0; i < MRT_JOINTS; ++i) {
                char name[64];
                const double *wanted =
                    (hand ? hand : clip_hand(c, frame - 1, side)) + (size_t)i * 3;
                (void)snprintf(name, sizeof name, "%s%s", side_name[side], names[i]);
                vec3 found = vec3_scale(at[find(&read, name)].t, 10.0);
                found.x += side == MRT_RIGHT ? 120.0 : 0.0; /* nothing tracks its wrist */
                vec3 off = {found.x - wanted[0], found.y - wanted[1], found.z - wanted[2]};
                worst_mm = fmax(worst_mm, vec3_length(off));
            }
        }
    }
    assert_true(worst_mm < 0.001);
    char rest[8];
    assert_int_equal(fscanf(read.stream, "%7s", rest), EOF);
    (void)fclose(read.stream);
    clip_destroy(c);
}

static void a_hand_that_never_was_there_is_left_out(void **state)
{
    (void)state;
    error err;
    bvh_file read;
    double joint[MRT_JOINTS * 3];
    rigid still = rigid_identity();
    clip *c = clip_create(&sheet, 30.0, NULL, &err);
    assert_non_null(c);
    assert_int_equal(clip_add_free(c, sheet.position, &err), MRT_OK);
    (void)unlink(path);
    assert_int_equal(bvh_write(path, c, 1.0, NULL, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(access(path, F_OK), -1);
    pose_at(joint, MRT_LEFT, 190, 3, &still);
    assert_int_equal(clip_add_hand(c, MRT_LEFT, joint, &err), MRT_OK);
    assert_int_equal(bvh_write(path, c, 1.0, NULL, &err), MRT_OK);
    open_bvh(&read, path);
    assert_int_equal(read.count, 1 + MRT_JOINTS + 5);
    (void)fclose(read.stream);
    joint[7] = (double)NAN;
    assert_int_equal(clip_add_hand(c, MRT_LEFT, joint, &err), MRT_ERR_ARGUMENT);
    clip_destroy(c);
}

/* Of two parts: each cache has the vertices of its part, in the unit that was asked for. */
static void a_part_is_a_cache_of_its_own(void **state)
{
    (void)state;
    error err;
    mesh m = scene_sheet(5);
    clip *c = clip_create(&m, 30.0, NULL, &err);
    assert_non_null(c);
    assert_int_equal(clip_add_free(c, m.position, &err), MRT_OK);
    const cache_options lower = {.mm_per_unit = 1000.0, .first_part = 1, .part_count = 1};
    assert_int_equal(pc2_write(path, c, &lower, NULL, &err), MRT_OK);
    FILE *stream = fopen(path, "rb");
    unsigned char head[32];
    float row[3];
    assert_non_null(stream);
    assert_int_equal(fread(head, 1, sizeof head, stream), sizeof head);
    const mesh_part *part = &m.part[1];
    assert_int_equal(head[16], part->vertex_count);
    for (uint32_t v = part->first_vertex; v < m.vertex_count; ++v) {
        assert_int_equal(fread(row, sizeof row[0], 3, stream), 3);
        for (size_t k = 0; k < 3; ++k)
            assert_true(fabsf(row[k] - 0.001f * m.position[(size_t)v * 3 + k]) < 1e-7f);
    }
    assert_int_equal(fgetc(stream), EOF);
    (void)fclose(stream);
    clip_destroy(c);
    mesh_destroy(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(joints_of_both_hands_stand_where_they_stood),
        cmocka_unit_test(a_hand_that_never_was_there_is_left_out),
        cmocka_unit_test(a_part_is_a_cache_of_its_own),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
