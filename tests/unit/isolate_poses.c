/* stage/mapping/isolate_wire.h: a face and the poses of its rig, as bytes for another process. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stage/mapping/isolate_wire.h"

#include <stdlib.h>
#include <string.h>

enum { CONTACTS = 3, DOFS = 2, POSES = 2 };

static const mrt_contact contacts[CONTACTS] = {
    {"mouth.corner.l", "skull", {30, -40, 70}, {0, 0, 1}},
    {"chin", "jaw", {0, -80, 70}, {0, 0, 1}},
    {"forehead", "skull", {0, 120, 60}, {0, 0, 1}}};
static const mrt_dof dofs[DOFS] = {{"jaw.open", "rad", 0, 0.5f}, {"eye.yaw", "rad", -0.5f, 0.5f}};
static const mrt_face face = {contacts, dofs, CONTACTS, DOFS, {-80, -120, -90}, {80, 150, 100}};
static const mrt_vec3 pulls[POSES][CONTACTS] = {{{1, 2, 3}, {4, 5, 6}, {0, 0, 0}},
                                                {{0, 0, 0}, {0, 0, 0}, {-0.125f, 7, 1e-30f}}};
static const float values[POSES][DOFS] = {{0.25f, 0}, {0, -0.1f}};
static const mrt_rig_pose poses[POSES] = {{"viseme_PP", pulls[0], values[0], MRT_POSE_MOUTH},
                                          {"brow_up", pulls[1], values[1], MRT_POSE_UPPER}};
enum { PART_AT = 3 * sizeof(uint32_t) }; /* of the first pose */

/* In memory of exactly that size. */
static unsigned char *bytes_of(size_t *out_size)
{
    *out_size = isolate_mapped_write(NULL, 0, &face, poses, POSES);
    unsigned char *bytes = malloc(*out_size);
    assert_non_null(bytes);
    assert_int_equal(isolate_mapped_write(bytes, *out_size, &face, poses, POSES), *out_size);
    return bytes;
}

static mrt_result take(const unsigned char *bytes, size_t size)
{
    isolate_mapped out;
    unsigned char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    mrt_result result = isolate_mapped_read(&out, copy, size);
    if (result < 0)
        assert_null(out.pose); /* nothing is left to free */
    isolate_mapped_finish(&out);
    free(copy);
    return result;
}

static void poses_arrive_bit_for_bit(void **state)
{
    (void)state;
    size_t size;
    isolate_mapped out;
    unsigned char *bytes = bytes_of(&size);
    assert_int_equal(isolate_mapped_read(&out, bytes, size), MRT_OK);
    free(bytes); /* what was taken stays */
    assert_int_equal(out.face.face.contact_count, CONTACTS);
    assert_string_equal(out.face.face.contacts[1].bone, "jaw");
    assert_string_equal(out.face.face.dofs[1].name, "eye.yaw");
    assert_int_equal(out.pose_count, POSES);
    for (uint32_t i = 0; i < POSES; ++i) {
        assert_string_equal(out.pose[i].name, poses[i].name);
        assert_int_equal(out.pose[i].part, poses[i].part);
        assert_memory_equal(out.pose[i].pulls, pulls[i], sizeof pulls[i]);
        assert_memory_equal(out.pose[i].dofs, values[i], sizeof values[i]);
    }
    isolate_mapped_finish(&out);
    isolate_mapped_finish(&out);
}

static void a_mesh_without_a_rig_has_no_poses(void **state)
{
    (void)state;
    const mrt_face bare = {.low = {-1, -1, -1}, .high = {1, 1, 1}};
    unsigned char bytes[256];
    isolate_mapped out;
    size_t size = isolate_mapped_write(bytes, sizeof bytes, &bare, NULL, 0);
    assert_int_equal(isolate_mapped_read(&out, bytes, size), MRT_OK);
    assert_int_equal(out.pose_count, 0);
    assert_int_equal(out.face.face.contact_count, 0);
    isolate_mapped_finish(&out);
}

static void poses_without_room_are_counted_and_not_written(void **state)
{
    (void)state;
    size_t size;
    unsigned char *whole = bytes_of(&size);
    unsigned char *bytes = malloc(size + 1);
    assert_non_null(bytes);
    for (size_t capacity = 0; capacity < size; ++capacity) {
        memset(bytes, 0x5c, size + 1);
        assert_int_equal(isolate_mapped_write(bytes, capacity, &face, poses, POSES), size);
        for (size_t i = capacity; i <= size; ++i)
            assert_int_equal(bytes[i], 0x5c);
    }
    free(bytes);
    free(whole);
}

static void bytes_cut_short_or_with_more_behind_are_refused(void **state)
{
    (void)state;
    size_t size;
    unsigned char *bytes = bytes_of(&size);
    for (size_t cut = 0; cut < size; ++cut)
        assert_int_equal(take(bytes, cut), MRT_ERR_FORMAT);
    unsigned char *longer = calloc(1, size + 1);
    assert_non_null(longer);
    memcpy(longer, bytes, size);
    assert_int_equal(take(longer, size + 1), MRT_ERR_FORMAT);
    free(longer);
    free(bytes);
}

/* Each count as large as it gets: nothing is allocated for what is not there. */
static void counts_that_the_bytes_cannot_hold_are_refused(void **state)
{
    (void)state;
    static const uint32_t wrong[] = {0, 1, 4, 31, 32, 33, 4096, 4097, 0x10000000, UINT32_MAX};
    size_t size;
    unsigned char *bytes = bytes_of(&size);
    for (size_t field = 0; field < 3; ++field)
        for (size_t i = 0; i < sizeof wrong / sizeof *wrong; ++i) {
            uint32_t kept;
            memcpy(&kept, bytes + field * sizeof kept, sizeof kept);
            memcpy(bytes + field * sizeof kept, &wrong[i], sizeof kept);
            assert_int_equal(take(bytes, size), MRT_ERR_FORMAT);
            memcpy(bytes + field * sizeof kept, &kept, sizeof kept);
        }
    assert_int_equal(take(bytes, size), MRT_OK);
    free(bytes);
}

static void a_part_that_is_none_is_refused(void **state)
{
    (void)state;
    size_t size;
    unsigned char *bytes = bytes_of(&size);
    assert_int_equal(bytes[PART_AT], MRT_POSE_MOUTH);
    bytes[PART_AT] = MRT_POSE_UPPER + 1;
    assert_int_equal(take(bytes, size), MRT_ERR_FORMAT);
    free(bytes);
}

/* Whatever comes, it is taken or refused: no read beyond the end, names end. */
static void random_damage_is_taken_or_refused(void **state)
{
    (void)state;
    size_t size;
    unsigned char *bytes = bytes_of(&size);
    unsigned char *damaged = malloc(size);
    uint32_t random = 20261125, taken = 0;
    assert_non_null(damaged);
    for (int round = 0; round < 20000; ++round) {
        memcpy(damaged, bytes, size);
        for (int i = 0; i <= round % 4; ++i) {
            random = random * 1664525u + 1013904223u;
            damaged[(random >> 8) % size] ^= (unsigned char)(1u << (random >> 29));
        }
        isolate_mapped out;
        if (isolate_mapped_read(&out, damaged, size) >= 0) {
            taken += 1;
            for (uint32_t i = 0; i < out.pose_count; ++i)
                assert_true(strlen(out.pose[i].name) < ISOLATE_NAME);
        }
        isolate_mapped_finish(&out);
    }
    assert_true(taken > 0 && taken < 20000);
    free(damaged);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_arrive_bit_for_bit),
        cmocka_unit_test(a_mesh_without_a_rig_has_no_poses),
        cmocka_unit_test(poses_without_room_are_counted_and_not_written),
        cmocka_unit_test(bytes_cut_short_or_with_more_behind_are_refused),
        cmocka_unit_test(counts_that_the_bytes_cannot_hold_are_refused),
        cmocka_unit_test(a_part_that_is_none_is_refused),
        cmocka_unit_test(random_damage_is_taken_or_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
