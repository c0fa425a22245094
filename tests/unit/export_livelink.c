#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "base/file.h"
#include "export_scene.h"
#include "io/export.h"

static char folder[256], path[300];
static mesh sheet;

static int set_up(void **state)
{
    (void)state;
    scene_folder(folder, sizeof folder);
    scene_path(path, sizeof path, folder, "face.livelink.csv");
    sheet = scene_sheet(12);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    mesh_destroy(&sheet);
    (void)unlink(path);
    return rmdir(folder);
}

static clip *performed(void)
{
    error err;
    clip *c = clip_create(&sheet, 25.0, NULL, &err);
    bool is_said[ARKIT_CHANNELS] = {false};
    clip_set_start(
        c, &(clip_start){.timecode = "01:00:00:24", .frame = 90024, .rate_num = 25, .rate_den = 1});
    is_said[arkit_find("jawOpen")] = is_said[arkit_find("jawLeft")] = true;
    is_said[arkit_find("mouthSmile_L")] = is_said[arkit_find("HeadYaw")] = true;
    clip_set_arkit(c, is_said);
    for (int frame = 0; frame < 2; ++frame) {
        double value[ARKIT_CHANNELS] = {0};
        value[arkit_find("jawOpen")] = frame == 0 ? 0.5 : 1.0;
        value[arkit_find("jawLeft")] = frame == 0 ? 0.0 : 0.25;
        value[arkit_find("mouthSmile_L")] = 0.75;
        value[arkit_find("HeadYaw")] = -0.2;
        assert_int_equal(clip_add_free(c, sheet.position, &err), MRT_OK);
        assert_int_equal(clip_add_arkit(c, value, &err), MRT_OK);
    }
    assert_int_equal(clip_add_free(c, sheet.position, &err), MRT_OK); /* says nothing */
    return c;
}

/* The cell of a row under a name; row 0 is the first frame. */
static const char *cell_of(char *text, int row, const char *name)
{
    static char cell[64];
    int column = -1, at = 0;
    char *line = text;
    size_t head = strcspn(line, "\n");
    for (char *field = line; field < line + head; ++at) {
        size_t size = strcspn(field, ",\n");
        if (size == strlen(name) && strncmp(field, name, size) == 0)
            column = at;
        field += size + 1;
    }
    assert_true(column >= 0);
    for (int i = 0; i <= row; ++i)
        line = strchr(line, '\n') + 1;
    for (int i = 0; i < column; ++i)
        line += strcspn(line, ",\n") + 1;
    (void)snprintf(cell, sizeof cell, "%.*s", (int)strcspn(line, ",\n"), line);
    return cell;
}

static void expect(char *text, int row, const char *name, double wanted)
{
    double is = atof(cell_of(text, row, name));
    if (!(fabs(is - wanted) < 1e-6))
        fail_msg("%s in frame %d: %g instead of %g", name, row, is, wanted);
}

static void every_channel_is_there_by_its_name(void **state)
{
    (void)state;
    error err = {""};
    file_bytes bytes;
    clip *c = performed();
    assert_int_equal(livelink_write(path, c, NULL, &err), MRT_OK);
    assert_int_equal(file_read(&bytes, path, 1 << 20, &err), MRT_OK);
    char *text = (char *)bytes.data;
    static const char head[] = "Timecode,BlendShapeCount,EyeBlinkLeft,EyeLookDownLeft,";
    assert_memory_equal(text, head, strlen(head));
    assert_non_null(strstr(text, ",JawForward,JawRight,JawLeft,JawOpen,"));
    assert_non_null(strstr(text, ",TongueOut,HeadYaw,HeadPitch,HeadRoll,LeftEyeYaw,"));
    assert_string_equal(cell_of(text, 0, "Timecode"), "01:00:00:24.000");
    assert_string_equal(cell_of(text, 1, "Timecode"), "01:00:01:00.000");
    expect(text, 0, "BlendShapeCount", 61);
    expect(text, 0, "JawOpen", 0.5);
    expect(text, 1, "JawOpen", 1.0);
    expect(text, 2, "JawOpen", 0.0);
    expect(text, 1, "JawLeft", 0.25);
    expect(text, 0, "JawRight", 0.0);
    expect(text, 0, "MouthSmileLeft", 0.75);
    expect(text, 0, "MouthSmileRight", 0.0);
    expect(text, 1, "HeadYaw", -0.2);
    assert_int_equal(clip_arkit_of(c)->shape_count, 3);
    assert_int_equal(clip_arkit_of(c)->turn_count, 1);
    file_bytes_finish(&bytes);
    clip_destroy(c);
}

static void names_are_known_however_they_are_written(void **state)
{
    (void)state;
    assert_string_equal(arkit_name[arkit_find("jawOpen")], "JawOpen");
    assert_string_equal(arkit_name[arkit_find("eyeBlink_R")], "EyeBlinkRight");
    assert_string_equal(arkit_name[arkit_find("Mouth_Smile_Left")], "MouthSmileLeft");
    assert_int_equal(arkit_find("mouth.corner.l"), ARKIT_NONE);
    assert_int_equal(arkit_find(""), ARKIT_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_channel_is_there_by_its_name),
                                       cmocka_unit_test(names_are_known_however_they_are_written)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
