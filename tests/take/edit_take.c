/* core/show/edit.h: the take itself, its markers, audio and layers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

/* ---- the take ---- */

static void a_slate_and_words_are_set(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'take.slate','scene':'12','shot':'b','number':3}");
    help_do(&t, "{'op':'take.rename','name':'the good one'}");
    help_do(&t, "{'op':'take.note','note':'too fast'}");
    help_do(&t, "{'op':'take.rate','rating':4}");
    assert_string_equal(t.scene, "12");
    assert_string_equal(t.shot, "b");
    assert_int_equal(t.number, 3);
    assert_string_equal(t.name, "the good one");
    assert_string_equal(t.note, "too fast");
    assert_int_equal(t.rating, 4);
    take_finish(&t);
}

static void a_deleted_take_is_restored_as_it_was(void **state)
{
    (void)state;
    take t = help_take(), before;
    assert_int_equal(take_copy(&before, &t, NULL), MRT_OK);
    help_do(&t, "{'op':'take.delete'}");
    assert_true(t.is_deleted && t.layer_count == 1);
    help_do(&t, "{'op':'take.restore'}");
    assert_true(help_same(&t, &before));
    take_finish(&before);
    take_finish(&t);
}

static void time_code_stays_at_its_instant_when_the_rate_changes(void **state)
{
    (void)state;
    take t = help_take();
    help_refused(&t, "{'op':'take.timecode','frame':90000}", "no frame rate; set it first");
    help_do(&t, "{'op':'take.fps','fps':25}");
    help_do(&t, "{'op':'take.timecode','frame':90000}");
    help_refused(&t, "{'op':'take.timecode','frame':1,'drop':true}", "only 29.97 and 59.94");
    help_do(&t, "{'op':'take.fps','fps':29.97}");
    assert_true(t.fps == 30000.0 / 1001.0);
    assert_true(t.timecode_frame == 107892);
    help_do(&t, "{'op':'take.timecode','frame':107892,'drop':true}");
    assert_true(t.is_drop_frame);
    help_do(&t, "{'op':'take.fps','fps':24}");
    assert_true(!t.is_drop_frame && t.timecode_frame == 86400);
    take_finish(&t);
}

/* ---- markers ---- */

static void markers_stay_in_order_of_time(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'marker.add','at_ns':5000m,'text':'b'}");
    help_do(&t, "{'op':'marker.add','at_ns':1000m,'text':'a'}");
    help_do(&t, "{'op':'marker.add','at_ns':5000m,'text':'c'}");
    assert_int_equal(t.marker_count, 3);
    assert_string_equal(t.marker[0].text, "a");
    assert_string_equal(t.marker[1].text, "b");
    assert_string_equal(t.marker[2].text, "c");
    help_do(&t, "{'op':'marker.move','marker':0,'at_ns':6000m}");
    assert_string_equal(t.marker[2].text, "a");
    help_do(&t, "{'op':'marker.rename','marker':2,'text':'z'}");
    help_do(&t, "{'op':'marker.remove','marker':0}");
    assert_int_equal(t.marker_count, 2);
    assert_string_equal(t.marker[0].text, "c");
    assert_string_equal(t.marker[1].text, "z");
    help_refused(&t, "{'op':'marker.remove','marker':2}", "marker 2: the take has 2 markers");
    take_finish(&t);
}

/* ---- audio ---- */

static void audio_is_attached_moved_and_detached(void **state)
{
    (void)state;
    take t = help_take();
    help_refused(&t, "{'op':'audio.gain','gain':1}", "attach one first");
    help_do(&t, "{'op':'audio.attach','audio':5}");
    assert_true(t.audio.audio == 5 && t.audio.offset_ns == 0 && t.audio.gain == 1.0);
    help_do(&t, "{'op':'audio.offset','offset_ns':-250m}");
    help_do(&t, "{'op':'audio.gain','gain':0.5}");
    assert_true(t.audio.offset_ns == -250 * help_ms && t.audio.gain == 0.5);
    help_do(&t, "{'op':'audio.trim','start_ns':1000m}");
    assert_true(t.audio.in_ns == 1250 * help_ms && t.audio.out_ns == 0);
    help_do(&t, "{'op':'audio.trim','end_ns':3000m}");
    assert_true(t.audio.in_ns == 1250 * help_ms && t.audio.out_ns == 3250 * help_ms);
    help_refused(&t, "{'op':'audio.trim','start_ns':3000m}", "would remove all of it");
    help_refused(&t, "{'op':'audio.trim','end_ns':1000m}", "would remove all of it");
    help_do(&t, "{'op':'audio.offset','offset_ns':500m}"); /* the same of it is heard */
    assert_true(t.audio.in_ns == 1250 * help_ms && t.audio.out_ns == 3250 * help_ms);
    help_do(&t, "{'op':'audio.trim','start_ns':0}"); /* no more than there is */
    assert_true(t.audio.in_ns == 0);
    help_do(&t, "{'op':'audio.detach'}");
    assert_true(t.audio.audio == 0);
    help_refused(&t, "{'op':'audio.trim','start_ns':0}", "attach one first");
    take_finish(&t);
}

/* ---- layers ---- */

static void layers_are_added_ordered_and_removed(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'mouth','own':['mouth.*','lip.*']}");
    help_do(&t, "{'op':'layer.add','name':'floor','place':0}");
    assert_int_equal(t.layer_count, 3);
    assert_string_equal(t.layer[0].name, "floor");
    assert_string_equal(t.layer[1].name, "face");
    assert_string_equal(t.layer[2].name, "mouth");
    assert_int_equal(t.layer[2].own_count, 2);
    assert_string_equal(t.layer[2].own[1], "lip.*");
    help_do(&t, "{'op':'layer.order','layer':3,'place':0}");
    assert_string_equal(t.layer[0].name, "mouth");
    help_do(&t, "{'op':'layer.order','layer':3,'place':2}");
    assert_string_equal(t.layer[0].name, "floor");
    assert_string_equal(t.layer[2].name, "mouth");
    help_refused(&t, "{'op':'layer.order','layer':3,'place':3}", "0 (the bottom) to 2 (the top)");
    help_do(&t, "{'op':'layer.remove','layer':1}");
    assert_int_equal(t.layer_count, 2);
    help_refused(&t, "{'op':'layer.remove','layer':1}",
                 "layer 1: the take has no such layer; it has 4 'floor', 3 'mouth'");
    help_refused(&t, "{'op':'layer.add','name':''}", "a layer needs a name");
    take_finish(&t);
}

static void ids_are_not_used_again(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.add','name':'a'}");
    assert_int_equal(t.layer[1].id, 3);
    help_do(&t, "{'op':'layer.remove','layer':3}");
    help_do(&t, "{'op':'layer.add','name':'b'}");
    assert_int_equal(t.layer[1].id, 4);
    take_finish(&t);
}

static void a_layer_is_set(void **state)
{
    (void)state;
    take t = help_take();
    help_do(&t, "{'op':'layer.rename','layer':1,'name':'all'}");
    help_do(&t, "{'op':'layer.mute','layer':1,'muted':true}");
    help_do(&t, "{'op':'layer.solo','layer':1,'solo':true}");
    help_do(&t, "{'op':'layer.additive','layer':1,'additive':true}");
    help_do(&t, "{'op':'layer.gain','layer':1,'gain':0.5}");
    help_do(&t, "{'op':'layer.own','layer':1,'own':['brow.*']}");
    help_do(&t, "{'op':'layer.offset','layer':1,'offset_ns':1000m}");
    const take_layer *layer = t.layer;
    assert_string_equal(layer->name, "all");
    assert_true(layer->is_muted && layer->is_solo && layer->is_additive);
    assert_true(layer->gain == 0.5 && layer->offset_ns == help_s && layer->own_count == 1);
    assert_true(t.duration_ns == 11 * help_s);
    assert_string_equal(help_shown(layer, help_s), "2@0*1");
    assert_string_equal(help_shown(layer, help_s - 1), "");
    help_do(&t, "{'op':'layer.own','layer':1,'own':[]}");
    assert_int_equal(t.layer->own_count, 0);
    take_finish(&t);
}

static void there_are_at_most_16_layers(void **state)
{
    (void)state;
    take t = help_take();
    for (int i = 1; i < EDIT_LAYERS_MAX; ++i)
        help_do(&t, "{'op':'layer.add','name':'x'}");
    help_refused(&t, "{'op':'layer.add','name':'x'}", "layers: the limit of 16 is reached");
    take_finish(&t);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slate_and_words_are_set),
        cmocka_unit_test(a_deleted_take_is_restored_as_it_was),
        cmocka_unit_test(time_code_stays_at_its_instant_when_the_rate_changes),
        cmocka_unit_test(markers_stay_in_order_of_time),
        cmocka_unit_test(audio_is_attached_moved_and_detached),
        cmocka_unit_test(layers_are_added_ordered_and_removed),
        cmocka_unit_test(ids_are_not_used_again),
        cmocka_unit_test(a_layer_is_set),
        cmocka_unit_test(there_are_at_most_16_layers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
