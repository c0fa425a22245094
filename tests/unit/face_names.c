/* face/face_weights.h on the faces that come with marotte. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/face_weights.h"
#include "stage/perform/face_file.h"

#include <math.h>
#include <string.h>

static void open_face(face_file *out, face_weights **out_weights, const char *path)
{
    error err = {""};
    if (face_file_read(out, path, NULL, FACE_FILE_USABLE, &err) < 0 ||
        face_file_weights(out_weights, out, &err) < 0)
        fail_msg("%s", err.text);
}

static void close_face(face_file *f, face_weights *weights)
{
    face_weights_destroy(weights);
    face_file_destroy(f);
}

/* To its left, the head too: eyes are said beside the head. */
static void the_puppet_looks_where_its_eyes_are_turned(void **state)
{
    (void)state;
    face_file file;
    face_weights *weights;
    float dof[MRT_MAX_DOFS] = {0};
    open_face(&file, &weights, SOURCE_DIR "/rigs/puppet/puppet.rig.json");
    bones b;
    error err = {""};
    assert_true(bones_init(&b, file.rig, (vec3){0, 0, 0}, &err) >= 0);
    for (uint32_t d = 0; d < b.dof_count; ++d) {
        const char *name = b.dof[d].name;
        dof[d] = strcmp(name, "eye.l.yaw") == 0 || strcmp(name, "eye.r.yaw") == 0 ? 0.25f : 0.0f;
        dof[d] = strcmp(name, "skull.turn") == 0 ? 0.5f : dof[d];
    }
    const face_said *s = face_weights_solve(weights, file.mesh.position, dof);
    assert_int_equal(face_weights_source(weights, arkit_find("eyeLookOutLeft")), FACE_NAME_BONES);
    assert_true(s->arkit[arkit_find("eyeLookOutLeft")] > 0.3);
    assert_true(s->arkit[arkit_find("eyeLookInRight")] > 0.3);
    assert_true(s->arkit[arkit_find("eyeLookInLeft")] == 0.0);
    assert_true(s->arkit[arkit_find("eyeLookUpLeft")] < 1e-3);
    assert_true(fabs(s->arkit[arkit_find("HeadYaw")] - 0.5) < 1e-6);
    assert_true(fabs(s->arkit[arkit_find("LeftEyeYaw")] - 0.25) < 1e-6);
    close_face(&file, weights);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_puppet_looks_where_its_eyes_are_turned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
