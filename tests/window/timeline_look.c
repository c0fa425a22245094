/* Pictures of the timeline in every state that a person meets, to be looked at; their words neither
 * overlap nor are cut off. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "take/edit_help.h"
#include "timeline_stand.h"

static take named_take(double seconds)
{
    take t = {.id = 3, .start_ns = 1000 * help_s, .duration_ns = (int64_t)(seconds * 1e9)};
    t.fps = 25.0;
    snprintf(t.name, sizeof t.name, "night ride");
    snprintf(t.scene, sizeof t.scene, "1");
    snprintf(t.shot, sizeof t.shot, "a");
    t.number = 3;
    help_do(&t, "{'op':'layer.add','name':'performance'}");
    help_do(&t, "{'op':'clip.add','layer':1,'performance':7}");
    return t;
}

static take five_layers(void)
{
    take t = named_take(30.0);
    help_do(&t, "{'op':'layer.add','name':'jaw again','own':['jaw','chin.*']}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':8,'source_ns':4000m,'start_ns':4000m,"
                "'end_ns':12000m}");
    help_do(&t, "{'op':'clip.add','layer':3,'performance':9,'source_ns':10500m,'start_ns':10500m,"
                "'end_ns':21000m}");
    help_do(&t, "{'op':'layer.add','name':'brows','own':['brow.*','forehead.*']}");
    help_do(&t, "{'op':'clip.add','layer':6,'performance':10,'source_ns':2000m,'start_ns':2000m,"
                "'end_ns':9000m}");
    help_do(&t, "{'op':'clip.speed','clip':7,'speed':0.5}");
    help_do(&t, "{'op':'clip.fade','clip':7,'fade_in_ns':1500m,'fade_out_ns':2500m}");
    help_do(&t, "{'op':'clip.add','layer':6,'performance':10,'source_ns':20000m,'start_ns':20000m,"
                "'end_ns':27000m}");
    help_do(&t, "{'op':'layer.add','name':'the tongue, tried once more in the afternoon'}");
    help_do(&t, "{'op':'clip.add','layer':9,'performance':11,'source_ns':6000m,'start_ns':6000m,"
                "'end_ns':18000m}");
    help_do(&t, "{'op':'layer.mute','layer':9,'muted':true}");
    help_do(&t, "{'op':'layer.add','name':'breath','own':['mouth']}");
    help_do(&t, "{'op':'layer.additive','layer':11,'additive':true}");
    help_do(&t, "{'op':'layer.gain','layer':11,'gain':0.4}");
    help_do(&t, "{'op':'clip.add','layer':11,'performance':12}");
    help_do(&t, "{'op':'clip.split','clip':12,'at_ns':15000m}");
    help_do(&t, "{'op':'clip.mute','clip':12,'muted':true}");
    help_do(&t, "{'op':'marker.add','at_ns':5000m,'text':'breath'}");
    help_do(&t, "{'op':'marker.add','at_ns':14200m,'text':'she turns to the window and laughs'}");
    help_do(&t, "{'op':'marker.add','at_ns':15000m,'text':'cue'}");
    return t;
}

static void result(stand *s, const char *name)
{
    stand_settle(s);
    stand_picture(s, name);
    stand_check_words(s);
}

static void an_empty_show(void **state)
{
    (void)state;
    stand s;
    stand_open(&s, 950.0f, 250.0f, 1.0f);
    result(&s, "empty");
    s.input_count = 2;
    for (int i = 0; i < 90; ++i)
        stand_frame(&s);
    result(&s, "live");
    stand_close(&s);
}

static void one_take(void **state)
{
    (void)state;
    stand s;
    stand_open(&s, 950.0f, 250.0f, 1.0f);
    stand_list(&s, 4);
    stand_choose(&s, named_take(12.0));
    app_seek(NULL, 4 * help_s);
    result(&s, "one");
    stand_close(&s);
}

static void five_layers_with_everything(void **state)
{
    (void)state;
    stand s;
    stand_open(&s, 1280.0f, 330.0f, 1.0f);
    stand_list(&s, 30);
    stand_choose(&s, five_layers());
    s.choice.layer = 6;
    s.choice.clip = 7;
    app_seek(NULL, 11 * help_s);
    app_set_range(NULL, 8 * help_s, 17 * help_s);
    result(&s, "five");
    stand_close(&s);
    stand_open(&s, 950.0f, 330.0f, 2.0f);
    stand_list(&s, 30);
    stand_choose(&s, five_layers());
    result(&s, "five_2x");
    stand_close(&s);
}

static void an_hour(void **state)
{
    (void)state;
    stand s;
    stand_open(&s, 1280.0f, 280.0f, 1.0f);
    stand_list(&s, 3000);
    take t = named_take(3600.0);
    help_do(&t, "{'op':'audio.attach','audio':3,'offset_ns':200m}");
    stand_choose(&s, t);
    result(&s, "hour");
    for (int i = 0; i < 26; ++i)
        stand_wheel(&s, 800.0f, 150.0f, 1.0f);
    result(&s, "sound");
    for (int i = 0; i < 40; ++i)
        stand_wheel(&s, 800.0f, 150.0f, 1.0f);
    result(&s, "samples");
    stand_close(&s);
}

static void other_takes(void **state)
{
    (void)state;
    stand s;
    stand_open(&s, 1280.0f, 320.0f, 1.0f);
    stand_list(&s, 12);
    s.comps = calloc(1, sizeof *s.comps);
    assert_non_null(s.comps);
    s.comps->of = 3;
    s.comps->count = STAND_COMPS;
    for (uint32_t i = 0; i < STAND_COMPS; ++i) {
        s.comps->take[i] = named_take(9.0 + i);
        s.comps->take[i].number = 4 + i;
        s.comps->take[i].rating = i + 1;
        s.comps->take[i].layer[0].clip[0].performance = 20 + i;
    }
    stand_choose(&s, named_take(12.0));
    s.panel->has_comps = true;
    result(&s, "comps");
    stand_close(&s);
    stand_open(&s, 950.0f, 250.0f, 1.0f);
    stand_choose(&s, five_layers());
    stand_click(&s, stand_x(&s, 10.0), stand_y(&s, 0));
    stand_drag(&s, stand_x(&s, 22.0), stand_y(&s, 2), stand_x(&s, 19.0), stand_y(&s, 4));
    result(&s, "narrow");
    stand_double_click(&s, stand_x(&s, 23.0), stand_y(&s, 2));
    stand_picture(&s, "clip_dialog"); /* over what is below it */
    stand_key(&s, UI_KEY_ESCAPE, true);
    stand_key(&s, UI_KEY_ESCAPE, false);
    stand_double_click(&s, 230.0f, s.panel->rows.row[3].y + 8.0f);
    stand_picture(&s, "layer_dialog"); /* over what is below it */
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_show),
        cmocka_unit_test(one_take),
        cmocka_unit_test(five_layers_with_everything),
        cmocka_unit_test(an_hour),
        cmocka_unit_test(other_takes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
