#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "export_scene.h"
#include "io/mesh_file.h"

static void what_is_written_is_read_back_in_the_same_order(void **state)
{
    (void)state;
    error err = {""};
    char folder[256], path[300];
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "face.glb");
    mesh m = scene_sheet(9), back;
    m.attribute = calloc(1, sizeof *m.attribute);
    m.attribute_count = 1;
    m.attribute[0].component_count = 1;
    scene_name(&m.attribute[0].name, "_SKULL");
    m.attribute[0].value = calloc(m.vertex_count, sizeof(float));
    m.attribute[0].value[11] = 0.5f;
    m.target = calloc(1, sizeof *m.target);
    m.target_count = 1;
    scene_name(&m.target[0].name, "smile");
    m.target[0].offset = calloc((size_t)m.vertex_count * 3, sizeof(float));
    m.target[0].offset[50] = -3.5f;
    m.material[0].base_colour[1] = 0.125f;
    if (gltf_write_mesh(path, &m, &err) != MRT_OK ||
        mesh_file_read(&back, path, NULL, &err) != MRT_OK)
        fail_msg("%s", err.text);
    assert_int_equal(back.vertex_count, m.vertex_count);
    assert_int_equal(back.triangle_count, m.triangle_count);
    assert_memory_equal(back.triangle, m.triangle, (size_t)m.triangle_count * 3 * sizeof(uint32_t));
    for (size_t i = 0; i < (size_t)m.vertex_count * 3; ++i) {
        assert_true(fabsf(back.position[i] - m.position[i]) < 1e-4f); /* mm: metres in float32 */
        assert_true(fabsf(back.target[0].offset[i] - m.target[0].offset[i]) < 1e-5f);
    }
    assert_int_equal(back.part_count, 2);
    assert_string_equal(back.part[0].name, "brow");
    assert_string_equal(back.part[1].name, "mouth");
    assert_int_equal(back.part[1].first_triangle, m.part[1].first_triangle);
    assert_int_equal(back.part[1].triangle_count, m.part[1].triangle_count);
    assert_string_equal(back.target[0].name, "smile");
    assert_string_equal(back.attribute[0].name, "_SKULL");
    assert_true(back.attribute[0].value[11] == 0.5f && back.attribute[0].value[12] == 0.0f);
    assert_string_equal(back.material[0].name, "skin");
    assert_true(back.material[0].base_colour[1] == 0.125f);
    mesh_destroy(&back);
    mesh_destroy(&m);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(folder), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read_back_in_the_same_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
