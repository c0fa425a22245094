/* core/show/edit.h: an edit as a line of JSON, there and back, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "edit_help.h"

/* One of every operation, as it is written. */
static const char *const every[] = {
    "{'op':'take.slate','scene':'12','shot':'b','number':3}",
    "{'op':'take.rename','name':'the good one'}",
    "{'op':'take.note','note':'too\\nfast'}",
    "{'op':'take.rate','rating':4}",
    "{'op':'take.fps','fps':25.0}",
    "{'op':'take.timecode','frame':90000}",
    "{'op':'take.timecode','frame':107892,'drop':true}",
    "{'op':'take.delete'}",
    "{'op':'take.restore'}",
    "{'op':'marker.add','at_ns':1500m,'text':'h\u00e9 \u4f60'}",
    "{'op':'marker.move','marker':0,'at_ns':-5}",
    "{'op':'marker.rename','marker':4095,'text':''}",
    "{'op':'marker.remove','marker':2}",
    "{'op':'layer.add','name':'mouth'}",
    "{'op':'layer.add','name':'mouth','own':['mouth.*','jaw.open'],'place':0}",
    "{'op':'layer.remove','layer':1}",
    "{'op':'layer.rename','layer':1,'name':'x'}",
    "{'op':'layer.order','layer':3,'place':15}",
    "{'op':'layer.mute','layer':1,'muted':true}",
    "{'op':'layer.mute','layer':1,'muted':false}",
    "{'op':'layer.solo','layer':1,'solo':true}",
    "{'op':'layer.additive','layer':1,'additive':true}",
    "{'op':'layer.gain','layer':1,'gain':0.5}",
    "{'op':'layer.offset','layer':1,'offset_ns':-40m}",
    "{'op':'layer.colour','layer':1,'colour':0}",
    "{'op':'layer.own','layer':1,'own':[]}",
    "{'op':'layer.own','layer':1,'own':['brow.*']}",
    "{'op':'clip.add','layer':1,'performance':7}",
    "{'op':'clip.add','layer':1,'performance':7,'from_ns':1,'to_ns':2000m,'source_ns':0,"
    "'start_ns':100m,'end_ns':1000m}",
    "{'op':'clip.add','layer':1,'performance':7,'warp':[[0,0],[1000m,500m]]}",
    "{'op':'clip.remove','clip':2}",
    "{'op':'clip.remove','clip':2,'ripple':true}",
    "{'op':'clip.trim','clip':2,'start_ns':0}",
    "{'op':'clip.trim','clip':2,'start_ns':2100m,'end_ns':8000m}",
    "{'op':'clip.trim','clip':2,'end_ns':0,'ripple':true}",
    "{'op':'clip.split','clip':2,'at_ns':5000m}",
    "{'op':'clip.move','clip':2,'start_ns':-1}",
    "{'op':'clip.move','clip':2,'layer':9}",
    "{'op':'clip.move','clip':2,'start_ns':5,'ripple':true}",
    "{'op':'clip.speed','clip':2,'speed':2.0}",
    "{'op':'clip.speed','clip':2,'speed':2.0,'ripple':true}",
    "{'op':'clip.speed','clip':2,'speed':0.25,'at_ns':0}",
    "{'op':'clip.curve','clip':2,'warp':[[0,0],[1000m,500m],[1001m,502m]]}",
    "{'op':'clip.smooth','clip':2,'smooth_s':0.03125}",
    "{'op':'clip.gain','clip':2,'gain':1.0}",
    "{'op':'clip.fade','clip':2,'fade_in_ns':0}",
    "{'op':'clip.fade','clip':2,'fade_in_ns':100m,'fade_out_ns':200m}",
    "{'op':'clip.mute','clip':2,'muted':true}",
    "{'op':'clip.colour','clip':2,'colour':7}",
    "{'op':'clip.perform','clip':2,'performance':9223372036854775807}",
    "{'op':'range.keep','in_ns':1000m,'out_ns':2000m}",
    "{'op':'range.cut','in_ns':1000m,'out_ns':2000m}",
    "{'op':'range.cut','in_ns':1000m,'out_ns':2000m,'ripple':true,'layers':[1,4]}",
    "{'op':'range.insert','at_ns':0,'length_ns':1}",
    "{'op':'mouth','name':'voice mouth','performance':8,'from_ns':0,'to_ns':9000m,"
    "'start_ns':0,'end_ns':9000m}",
    "{'op':'mouth','name':'voice mouth','performance':8,'from_ns':0,'to_ns':9000m,"
    "'start_ns':0,'end_ns':9000m,'layer':3}",
    "{'op':'punch','layer':1,'performance':8,'from_ns':0,'to_ns':9000m,'in_ns':1000m,"
    "'out_ns':2000m,'fade_ns':100m}",
    "{'op':'comp','performance':8,'from_ns':0,'to_ns':9000m,'in_ns':1000m,'out_ns':2000m,"
    "'fade_ns':0,'regions':['mouth','head'],'source_ns':5}",
    "{'op':'comp','performance':8,'from_ns':0,'to_ns':9000m,'in_ns':1000m,'out_ns':2000m,"
    "'fade_ns':0,'own':['jaw.*'],'name':'jaw','warp':[[0,0]]}",
    "{'op':'audio.attach','audio':1}",
    "{'op':'audio.attach','audio':1,'offset_ns':-3,'gain':0.25}",
    "{'op':'audio.offset','offset_ns':0}",
    "{'op':'audio.trim','start_ns':5,'end_ns':9}",
    "{'op':'audio.trim','end_ns':9}",
    "{'op':'audio.gain','gain':2.0}",
    "{'op':'audio.detach'}",
};
enum { EVERY = sizeof every / sizeof every[0] };

static void every_operation_is_written_as_it_was_read(void **state)
{
    (void)state;
    bool was_seen[EDIT_KIND_COUNT] = {false};
    for (size_t i = 0; i < EVERY; ++i) {
        char json[HELP_JSON], *written;
        error err;
        edit e;
        help_json(json, every[i]);
        if (edit_parse(&e, json, strlen(json), &err) < 0)
            fail_msg("%s: %s", json, err.text);
        assert_int_equal(edit_write(&written, &e, &err), MRT_OK);
        assert_string_equal(written, json);
        was_seen[e.kind] = true;
        free(written);
        edit_finish(&e);
    }
    for (int kind = EDIT_NONE + 1; kind < EDIT_KIND_COUNT; ++kind)
        if (!was_seen[kind])
            fail_msg("%s is not tried", edit_name((edit_kind)kind));
}

static void numbers_come_back_bit_by_bit(void **state)
{
    (void)state;
    static const double gains[] = {0.1, 1.0 / 3.0, 4.9406564584124654e-324, 10.0, 0.0};
    for (size_t i = 0; i < sizeof gains / sizeof gains[0]; ++i) {
        edit e, back;
        error err;
        char *written;
        edit_init(&e, EDIT_AUDIO_GAIN);
        e.gain = gains[i];
        assert_int_equal(edit_write(&written, &e, &err), MRT_OK);
        assert_int_equal(edit_parse(&back, written, strlen(written), &err), MRT_OK);
        assert_memory_equal(&back.gain, &gains[i], sizeof gains[i]);
        free(written);
    }
}

typedef struct refusal {
    const char *brief, *why;
    mrt_result result;
} refusal;

static void what_is_not_an_edit_is_refused_by_its_place(void **state)
{
    (void)state;
    static const refusal refusals[] = {
        {"", "$: byte 0 is not JSON", MRT_ERR_FORMAT},
        {"{", "is not JSON", MRT_ERR_FORMAT},
        {"[]", "$: expected an object", MRT_ERR_FORMAT},
        {"{}", "$.op: expected the name", MRT_ERR_FORMAT},
        {"{'op':3}", "$.op: expected the name", MRT_ERR_FORMAT},
        {"{'op':''}", "$.op: unknown edit", MRT_ERR_UNSUPPORTED},
        {"{'op':'clip.warble','clip':2}", "unknown edit \"clip.warble\"; a newer",
         MRT_ERR_UNSUPPORTED},
        {"{'op':'clip.split','clip':2,'at_ns':0,'hard':1}",
         "$.hard: unknown argument of clip.split", MRT_ERR_UNSUPPORTED},
        {"{'op':'clip.split','clip':2}", "$.at_ns: expected a whole number", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':2,'at_ns':1.5}", "found 1.5", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':2,'at_ns':'1'}", "found \"1\"", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':2,'at_ns':1000000000000001}",
         "from -1000000000000000 to 1000000000000000", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':2,'at_ns':99999999999999999999}", "is not JSON",
         MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':0,'at_ns':1}", "$.clip: expected", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':4294967298,'at_ns':1}", "$.clip: expected", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':-1,'at_ns':1}", "$.clip: expected", MRT_ERR_FORMAT},
        {"{'op':'clip.split','clip':2,'clip':3,'at_ns':1}", "is not JSON", MRT_ERR_FORMAT},
        {"{'op':'clip.mute','clip':2,'muted':1}", "$.muted: expected true or false",
         MRT_ERR_FORMAT},
        {"{'op':'audio.gain','gain':10.5}", "$.gain: expected a number from 0 to 10",
         MRT_ERR_FORMAT},
        {"{'op':'audio.gain','gain':-1}", "$.gain", MRT_ERR_FORMAT},
        {"{'op':'audio.gain','gain':null}", "found null", MRT_ERR_FORMAT},
        {"{'op':'clip.speed','clip':1,'speed':0}", "$.speed: expected a number from 0.01 to 100",
         MRT_ERR_FORMAT},
        {"{'op':'take.rename','name':'a\\nb'}", "$.name: expected a text of at most 63 bytes",
         MRT_ERR_FORMAT},
        {"{'op':'take.rename','name':'a\\u0000b'}", "is not JSON", MRT_ERR_FORMAT},
        {"{'op':'take.rename','name':"
         "'0123456789012345678901234567890123456789012345678901234567890123'}",
         "at most 63 bytes", MRT_ERR_FORMAT},
        {"{'op':'take.rate','rating':6}", "$.rating: expected a whole number from 0 to 5",
         MRT_ERR_FORMAT},
        {"{'op':'take.fps','fps':0.5}", "$.fps: expected a number from 1 to 1000", MRT_ERR_FORMAT},
        {"{'op':'layer.own','layer':1,'own':['mou*th']}", "$.own: expected up to 64 patterns",
         MRT_ERR_FORMAT},
        {"{'op':'layer.own','layer':1,'own':['']}", "$.own", MRT_ERR_FORMAT},
        {"{'op':'layer.own','layer':1,'own':'mouth.*'}", "$.own", MRT_ERR_FORMAT},
        {"{'op':'layer.own','layer':1,'own':[1]}", "found 1", MRT_ERR_FORMAT},
        {"{'op':'range.cut','in_ns':0,'out_ns':1,'layers':[]}", "$.layers: expected 1 to 16",
         MRT_ERR_FORMAT},
        {"{'op':'range.cut','in_ns':0,'out_ns':1,'layers':[1,1]}", "$.layers", MRT_ERR_FORMAT},
        {"{'op':'range.cut','in_ns':0,'out_ns':1,'layers':[0]}", "$.layers", MRT_ERR_FORMAT},
        {"{'op':'comp','performance':8,'from_ns':0,'to_ns':9,'in_ns':1,'out_ns':2,'fade_ns':0,"
         "'regions':['ear']}",
         "some of mouth, jaw, brows", MRT_ERR_FORMAT},
        {"{'op':'comp','performance':8,'from_ns':0,'to_ns':9,'in_ns':1,'out_ns':2,'fade_ns':0,"
         "'regions':['jaw','jaw']}",
         "each once", MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[]}", "$.warp: expected 1 to 1024 points",
         MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[[0,0],[1,0]]}", "both ascending", MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[[0,0],[0,1]]}", "both ascending", MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[[0,0],[1,1001]]}", "1000 times", MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[[0,0,0]]}", "an array of 3", MRT_ERR_FORMAT},
        {"{'op':'clip.curve','clip':2,'warp':[0,0]}", "$.warp", MRT_ERR_FORMAT},
    };
    for (size_t i = 0; i < sizeof refusals / sizeof refusals[0]; ++i) {
        char json[HELP_JSON];
        error err = {""};
        edit e;
        help_json(json, refusals[i].brief);
        mrt_result result = edit_parse(&e, json, strlen(json), &err);
        if (result != refusals[i].result || !strstr(err.text, refusals[i].why) ||
            strchr(err.text, '\n'))
            fail_msg("%s: %d \"%s\"", json, result, err.text);
        assert_true(!e.own && !e.warp && e.kind == EDIT_NONE);
    }
}

static void an_edit_that_is_too_long_is_refused(void **state)
{
    (void)state;
    static char json[EDIT_BYTES_MAX + 2];
    error err;
    edit e;
    memset(json, ' ', sizeof json);
    assert_int_equal(edit_parse(&e, json, EDIT_BYTES_MAX + 1, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "expected at most 262144"));
}

static void deep_json_is_refused(void **state)
{
    (void)state;
    static char json[100000];
    error err;
    edit e;
    memset(json, '[', sizeof json);
    assert_int_equal(edit_parse(&e, json, sizeof json, &err), MRT_ERR_FORMAT);
}

static void what_could_not_be_read_is_not_written(void **state)
{
    (void)state;
    edit e;
    error err;
    char *written;
    edit_init(&e, EDIT_CLIP_SPLIT);
    e.clip = 1;
    assert_int_equal(edit_write(&written, &e, &err), MRT_ERR_FORMAT);
    assert_non_null(strstr(err.text, "$.at_ns: expected a whole number"));
    assert_non_null(strstr(err.text, "found nothing"));
    edit_init(&e, EDIT_TAKE_RENAME);
    memcpy(e.name, "\xff\xfe", 3);
    assert_int_equal(edit_write(&written, &e, &err), MRT_ERR_FORMAT);
    memset(e.name, 'x', sizeof e.name);
    assert_int_equal(edit_write(&written, &e, &err), MRT_ERR_FORMAT);
    e.kind = EDIT_KIND_COUNT;
    assert_int_equal(edit_write(&written, &e, &err), MRT_ERR_ARGUMENT);
    assert_null(written);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_operation_is_written_as_it_was_read),
        cmocka_unit_test(numbers_come_back_bit_by_bit),
        cmocka_unit_test(what_is_not_an_edit_is_refused_by_its_place),
        cmocka_unit_test(an_edit_that_is_too_long_is_refused),
        cmocka_unit_test(deep_json_is_refused),
        cmocka_unit_test(what_could_not_be_read_is_not_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
