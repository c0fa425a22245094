/* brush_scene.h - the puppet, and a brush on it, for the tests of the rig panel's strokes. mm.
 * After cmocka.h. */
#ifndef MAROTTE_TEST_BRUSH_SCENE_H
#define MAROTTE_TEST_BRUSH_SCENE_H
#include "face/bind.h"
#include "face/rig_edit.h"
#include "rig_help.h"
#include "stage/perform/face_file.h"
#include "window/rig/brush.h"

static face_file puppet;
static brush *tool;
static const brush_shape wide = {.radius_mm = 14.0, .sides = BRUSH_ONE_SIDE};

static inline void must(mrt_result result, const error *err)
{
    if (result < 0)
        fail_msg("%s", err->text);
}

static inline int open_puppet(void **state)
{
    (void)state;
    error err = {""};
    must(face_file_read(&puppet, SOURCE_DIR "/rigs/puppet/puppet.rig.json", NULL, FACE_FILE_USABLE,
                        &err),
         &err);
    must(brush_create(&tool, &puppet.mesh, &puppet.topology, &err), &err);
    return 0;
}

static inline int close_puppet(void **state)
{
    (void)state;
    brush_destroy(tool);
    face_file_destroy(&puppet);
    return 0;
}

static const float *place_of(uint32_t vertex)
{
    return puppet.mesh.position + (size_t)vertex * 3;
}

static inline uint32_t contact(const char *name)
{
    uint32_t found = rig_find_contact(puppet.rig, name);
    assert_true(found != RIG_NONE);
    return puppet.rig->contact[found].vertex;
}

static inline rig copy_of(const rig *r)
{
    rig out;
    error err = {""};
    must(rig_copy(&out, r, &err), &err);
    return out;
}

static const binding *filled; /* NULL: strokes know nothing of what is there */

/* One press on a vertex. */
static inline rig painted(const rig *r, const brush_shape *shape, rig_stroke_ink ink,
                          uint32_t vertex)
{
    error err = {""};
    rig_stroke *stroke = NULL;
    rig out = copy_of(r);
    uint32_t changed;
    must(rig_stroke_begin(&stroke, r, puppet.mesh.vertex_count, &ink, filled, &err), &err);
    brush_begin(tool, shape);
    must(brush_move(tool, vertex, place_of(vertex), &err), &err);
    rig_stroke_update(stroke, tool);
    must(rig_stroke_end(stroke, &out, &changed, &err), &err);
    rig_stroke_destroy(stroke);
    return out;
}

static inline rig_stroke_ink rides_on(const char *bone)
{
    return (rig_stroke_ink){
        .ink = RIG_INK_RIDES, .bone = rig_find_bone(puppet.rig, bone), .strength = 1.0};
}

#endif
