/* A rig that is edited: what is laid beside the window, what is saved, what is kept when the
 * program ends without saving. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/clock.h"
#include "base/file.h"
#include "face/rig_edit.h"
#include "stage/perform/face_file.h"
#include "window/rig/model.h"
#include "closed_moai.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[64];

static const char *in_folder(const char *name)
{
    static char path[4][160];
    static int next;
    next = (next + 1) % 4;
    (void)snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

/* The Moai and its rig, in a folder of their own; "keep/" is beside them. */
static int make_folder(void **state)
{
    (void)state;
    char command[512];
    strcpy(folder, "/tmp/marotte_model_XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    (void)snprintf(command, sizeof command, "mkdir %s/keep && cp %s/rigs/moai/moai.* %s/", folder,
                   SOURCE_DIR, folder);
    return system(command);
}

static int remove_folder(void **state)
{
    (void)state;
    char command[128];
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static rig_model *open_model(const char *name)
{
    error err = {""};
    face_file file;
    rig_model *model;
    char keep[160];
    (void)snprintf(keep, sizeof keep, "%s/keep/", folder);
    must(face_file_read(&file, in_folder(name), NULL, FACE_FILE_USABLE, &err), &err);
    must(rig_model_create(&model, &file, in_folder(name), keep, &err), &err);
    face_file_destroy(&file);
    return model;
}

/* Until what is asked is laid. */
static void wait_until_laid(rig_model *model)
{
    int64_t end_ns = clock_now_ns() + 60 * NS_PER_S;
    while (clock_now_ns() < end_ns) {
        (void)rig_model_update(model, 0.1);
        if (rig_model_is_laid(model))
            return;
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    }
    fail_msg("nothing was laid within 60 s");
}

static uint64_t move_chin(rig_model *model, uint32_t vertex)
{
    error err = {""};
    rig *r = rig_model_begin(model, &err);
    assert_non_null(r);
    must(rig_edit_move_contact(r, rig_find_contact(r, "chin"), vertex, &err), &err);
    return rig_model_commit(model);
}

static uint32_t chin_of(const rig_model *model)
{
    const rig *r = rig_model_rig(model);
    return r->contact[rig_find_contact(r, "chin")].vertex;
}

static uint32_t kept_files(void)
{
    uint32_t count = 0;
    DIR *directory = opendir(in_folder("keep"));
    assert_non_null(directory);
    for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory))
        count += entry->d_name[0] != '.';
    (void)closedir(directory);
    return count;
}

static char *text_of_file(const char *path)
{
    error err = {""};
    file_bytes bytes;
    must(file_read(&bytes, path, 1 << 24, &err), &err);
    char *text = strdup((const char *)bytes.data);
    file_bytes_finish(&bytes);
    return text;
}

/* ---- */

static void what_is_on_the_stage_already_is_not_given_to_it(void **state)
{
    (void)state;
    rig_model *model = open_model("moai.rig.json");
    rig_model_request_binding(model);
    wait_until_laid(model);
    const rig_work *work = rig_model_work(model);
    assert_int_equal(work->result, MRT_OK);
    assert_non_null(work->face);
    assert_true(work->region_size[0] > 100);
    assert_null(rig_model_pop_face(model));
    assert_true(rig_model_is_saved(model));
    rig_model_destroy(model);
    assert_int_equal(kept_files(), 0);
}

static void assert_bound_as_it_would_be(const face_file *file)
{
    error err = {""};
    binding b;
    assert_non_null(file->bound);
    must(binding_create(&b, file->rig, &file->mesh, &file->topology, &err), &err);
    size_t count = b.vertex_count;
    assert_memory_equal(b.weight, file->bound->weight, count * b.bone_count * sizeof *b.weight);
    assert_memory_equal(b.mobility, file->bound->mobility, count * sizeof *b.mobility);
    binding_destroy(&b);
}

static void a_change_is_laid_and_given_to_the_stage_once(void **state)
{
    (void)state;
    rig_model *model = open_model("moai.rig.json");
    assert_int_equal(move_chin(model, 794), 1);
    wait_until_laid(model);
    face_file *file = rig_model_pop_face(model);
    assert_non_null(file);
    assert_int_equal(file->rig->contact[rig_find_contact(file->rig, "chin")].vertex, 794);
    assert_int_equal(file->mesh.vertex_count, rig_model_mesh(model)->vertex_count);
    assert_null(rig_model_pop_face(model));
    assert_bound_as_it_would_be(file);
    face_file_destroy(file);
    free(file);
    rig_model_leave(model);
    rig_model_destroy(model);
    assert_int_equal(kept_files(), 0);
}

static void a_rig_that_cannot_be_performed_stays_off_the_stage_and_says_why(void **state)
{
    (void)state;
    error err = {""};
    rig_model *model = open_model("moai.rig.json");
    rig *r = rig_model_begin(model, &err);
    assert_non_null(r);
    while (r->region_count > 0)
        must(rig_edit_remove_region(r, 0, &err), &err);
    (void)rig_model_commit(model);
    wait_until_laid(model);
    const rig_work *work = rig_model_work(model);
    assert_true(work->result < 0);
    assert_null(work->face);
    assert_true(rig_findings_count(&work->findings, RIG_ERROR) > 0);
    assert_null(rig_model_pop_face(model));
    assert_true(rig_model_go(model, 0));
    wait_until_laid(model);
    assert_int_equal(rig_model_work(model)->result, MRT_OK);
    rig_model_destroy(model);
    assert_int_equal(kept_files(), 0); /* undone: as saved */
}

static void what_is_not_saved_is_offered_again(void **state)
{
    (void)state;
    error err = {""};
    uint64_t number;
    rig_model *model = open_model("moai.rig.json");
    assert_false(rig_model_has_recovered(model));
    (void)move_chin(model, 795);
    assert_false(rig_model_is_saved(model));
    rig_model_destroy(model); /* before the worker was asked */
    assert_int_equal(kept_files(), 1);

    model = open_model("moai.rig.json");
    assert_true(rig_model_has_recovered(model));
    assert_int_not_equal(chin_of(model), 795);
    must(rig_model_restore_recovered(model, &number, &err), &err);
    assert_int_equal(chin_of(model), 795);
    assert_false(rig_model_has_recovered(model));
    assert_true(rig_model_go(model, number - 1));
    assert_int_not_equal(chin_of(model), 795);
    assert_true(rig_model_go(model, number));
    must(rig_model_save(model, &err), &err);
    rig_model_destroy(model);
    assert_int_equal(kept_files(), 0);

    model = open_model("moai.rig.json");
    assert_int_equal(chin_of(model), 795);
    rig_model_destroy(model);
}

static void new_work_does_not_write_over_what_was_kept(void **state)
{
    (void)state;
    error err = {""};
    uint64_t number;
    rig_model *model = open_model("moai.rig.json");
    (void)move_chin(model, 801);
    rig_model_destroy(model);
    model = open_model("moai.rig.json");
    (void)move_chin(model, 802); /* without looking at the offer */
    wait_until_laid(model);
    assert_true(rig_model_has_recovered(model));
    assert_int_equal(kept_files(), 2);
    must(rig_model_restore_recovered(model, &number, &err), &err);
    assert_int_equal(chin_of(model), 801);
    rig_model_leave(model);
    rig_model_destroy(model);
    assert_int_equal(kept_files(), 0);
}

static void a_save_after_an_undo_is_the_file_that_was(void **state)
{
    (void)state;
    error err = {""};
    rig_model *model = open_model("moai.rig.json");
    char *before = text_of_file(in_folder("moai.rig.json"));
    (void)move_chin(model, 803);
    must(rig_model_save(model, &err), &err);
    char *changed = text_of_file(in_folder("moai.rig.json"));
    assert_true(strcmp(before, changed) != 0);
    assert_true(rig_model_go(model, 0));
    assert_false(rig_model_is_saved(model));
    must(rig_model_save(model, &err), &err);
    char *after = text_of_file(in_folder("moai.rig.json"));
    assert_string_equal(before, after);
    free(before);
    free(changed);
    free(after);
    rig_model_destroy(model);
}

static void a_mesh_alone_is_drafted_and_saved_beside_it(void **state)
{
    (void)state;
    error err = {""};
    rig_model_drafted made;
    char command[256];
    (void)snprintf(command, sizeof command, "cp %s/moai.glb %s/stone.glb", folder, folder);
    assert_int_equal(system(command), 0);
    rig_model *model = open_model("stone.glb");
    assert_null(rig_model_rig(model));
    assert_null(rig_model_begin(model, &err));
    must(rig_model_draft(model, &err), &err);
    assert_true(rig_model_is_drafting(model));
    while (!rig_model_pop_draft(model, &made))
        (void)usleep(1000);
    must(made.result, &made.err);
    assert_false(rig_model_is_drafting(model) || rig_model_pop_draft(model, &made));
    assert_non_null(strstr(made.confirm, "nose"));
    free(made.confirm);
    assert_non_null(rig_model_rig(model));
    wait_until_laid(model);
    assert_int_equal(rig_model_work(model)->result, MRT_OK);
    assert_string_equal(rig_model_path(model), in_folder("stone.rig.json"));
    must(rig_model_save(model, &err), &err);
    assert_true(rig_model_go(model, 0));
    assert_null(rig_model_rig(model));
    rig_model_destroy(model);
    face_file file;
    must(face_file_read(&file, in_folder("stone.rig.json"), NULL, FACE_FILE_USABLE, &err), &err);
    face_file_destroy(&file);
}

static rig_model_drafted wait_for_draft(rig_model *model)
{
    rig_model_drafted made;
    while (!rig_model_pop_draft(model, &made))
        (void)usleep(1000);
    if (made.result < 0)
        fail_msg("%s", made.err.text);
    free(made.confirm);
    return made;
}

static void a_cut_mouth_is_a_change_and_kept_like_one(void **state)
{
    (void)state;
    error err = {""};
    uint64_t number;
    write_closed_moai(in_folder("closed.obj"));
    rig_model *model = open_model("closed.obj");
    const uint32_t whole = rig_model_mesh(model)->vertex_count;
    must(rig_model_draft(model, &err), &err);
    assert_false(wait_for_draft(model).has_cut);
    assert_true(rig_model_asks_mouth(model));
    must(rig_model_cut_mouth(model, &err), &err);
    assert_true(rig_model_go(model, 0)); /* whoever undoes meanwhile has thought better of it */
    assert_false(rig_model_is_drafting(model));
    assert_true(rig_model_go(model, 1));
    must(rig_model_cut_mouth(model, &err), &err);
    assert_true(wait_for_draft(model).has_cut);
    assert_false(rig_model_asks_mouth(model));
    const uint32_t cut = rig_model_mesh(model)->vertex_count;
    assert_true(cut > whole);
    wait_until_laid(model);
    assert_int_equal(rig_model_work(model)->result, MRT_OK);
    assert_true(rig_model_go(model, 1));
    assert_int_equal(rig_model_mesh(model)->vertex_count, whole);
    assert_null(rig_model_work(model)); /* its face is not of this mesh */
    assert_true(rig_model_go(model, 2));
    wait_until_laid(model);
    rig_model_destroy(model);
    model = open_model("closed.obj");
    assert_true(rig_model_has_recovered(model));
    must(rig_model_restore_recovered(model, &number, &err), &err);
    assert_int_equal(rig_model_mesh(model)->vertex_count, cut);
    wait_until_laid(model);
    assert_int_equal(rig_model_work(model)->result, MRT_OK);
    rig_model_leave(model);
    rig_model_destroy(model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_on_the_stage_already_is_not_given_to_it),
        cmocka_unit_test(a_change_is_laid_and_given_to_the_stage_once),
        cmocka_unit_test(a_rig_that_cannot_be_performed_stays_off_the_stage_and_says_why),
        cmocka_unit_test(what_is_not_saved_is_offered_again),
        cmocka_unit_test(new_work_does_not_write_over_what_was_kept),
        cmocka_unit_test(a_save_after_an_undo_is_the_file_that_was),
        cmocka_unit_test(a_mesh_alone_is_drafted_and_saved_beside_it),
        cmocka_unit_test(a_cut_mouth_is_a_change_and_kept_like_one),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
