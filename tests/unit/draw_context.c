/* Without a context nothing is drawn and nothing ends the process. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "draw/draw.h"
#include "draw/gl.h"
#include "draw_help.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void drawing_without_a_context_is_an_error(void **state)
{
    (void)state;
    error err = {{0}};
    assert_false(gl_is_current());
    assert_null(draw_target_create(10, 10, &err));
    assert_non_null(strstr(err.text, "no OpenGL context"));
    err.text[0] = '\0';
    assert_null(draw_renderer_create(&err));
    assert_non_null(strstr(err.text, "no OpenGL context"));
    mesh m = shapes_wall(1, 0);
    err.text[0] = '\0';
    assert_null(draw_face_create(&m, &err));
    assert_non_null(strstr(err.text, "no OpenGL context"));
    mesh_destroy(&m);
}

/* In a child, before anything here has loaded EGL. */
static void expect_refusal(const char *name, const char *value, const char *package)
{
    (void)fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        error err = {{0}};
        (void)setenv(name, value, 1);
        draw_context *context = draw_context_create(&err);
        if (context)
            _exit(77);
        _exit(strstr(err.text, package) && !gl_is_current() ? 0 : 1);
    }
    int status = -1;
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == 77)
        printf("SKIPPED: this EGL finds a driver in spite of %s\n", name);
    else
        assert_int_equal(WEXITSTATUS(status), 0);
}

static void without_a_driver_the_error_names_the_package(void **state)
{
    (void)state;
    expect_refusal("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json", "install lib");
    expect_refusal("LIBGL_DRIVERS_PATH", "/nowhere", "install lib");
}

static void destroying_nothing_is_allowed(void **state)
{
    (void)state;
    draw_face_destroy(NULL);
    draw_renderer_destroy(NULL);
    draw_target_destroy(NULL);
    draw_context_destroy(NULL);
}

static void contexts_come_and_go(void **state)
{
    (void)state;
    for (int i = 0; i < 3; ++i) {
        error err = {{0}};
        draw_context *context = draw_context_create(&err);
        if (!context) {
            printf("SKIPPED: %s\n", err.text);
            skip();
        }
        assert_true(gl_is_current());
        draw_target *target = draw_target_create(4, 4, &err);
        assert_non_null(target);
        draw_target_destroy(target);
        draw_context_destroy(context);
        assert_false(gl_is_current());
    }
}

static void a_wrong_shader_is_reported_with_its_name(void **state)
{
    (void)state;
    error err = {{0}};
    draw_context *context = draw_context_create(&err);
    if (!context) {
        printf("SKIPPED: %s\n", err.text);
        skip();
    }
    static const char good[] = "void main() { gl_Position = vec4(0.0); }",
                      bad[] = "void main() { x; }";
    const gl_source broken[] = {{"good.vert", good, sizeof good - 1},
                                {"bad.frag", bad, sizeof bad - 1}};
    assert_true(gl_program_create(broken, "", &err) == 0);
    assert_non_null(strstr(err.text, "bad.frag"));
    assert_null(strchr(err.text, '\n'));
    draw_context_destroy(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drawing_without_a_context_is_an_error),
        cmocka_unit_test(without_a_driver_the_error_names_the_package),
        cmocka_unit_test(destroying_nothing_is_allowed),
        cmocka_unit_test(contexts_come_and_go),
        cmocka_unit_test(a_wrong_shader_is_reported_with_its_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
