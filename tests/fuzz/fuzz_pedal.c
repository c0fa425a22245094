/* Any bytes are a report descriptor with reports after it, or a stored layout, or are refused; what
 * was read keeps its promises, and no report leads outside of itself.
 * First byte 'd': the descriptor's size in two bytes, the descriptor, reports of 8 bytes.
 * First byte 't': a layout's text, a 0, reports of 8 bytes. */
#include "descriptor.h"
#include "layouts.h"
#include "learn.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

enum { REPORT_BYTES = 8, REPORTS = 64 };

static void check_layout(const layout *l)
{
    assert(l->switch_count <= LAYOUT_SWITCHES);
    for (uint32_t i = 0; i < l->switch_count; ++i) {
        const layout_switch *s = &l->switches[i];
        assert(memchr(s->name, '\0', sizeof s->name) && s->name[0] != '\0');
        if (s->kind == LAYOUT_FIELD)
            assert(s->width >= 1 && s->width <= 32 && s->up != s->down);
    }
}

/* Each report in memory of its own, so that a byte too far is found. */
static uint8_t *next_report(const uint8_t **at, const uint8_t *end, size_t *out_size)
{
    size_t left = (size_t)(end - *at);
    *out_size = left < REPORT_BYTES ? left : REPORT_BYTES;
    uint8_t *copy = malloc(*out_size + 1);
    if (copy)
        memcpy(copy, *at, *out_size);
    *at += *out_size;
    return copy;
}

static void check_reports(const layout *l, const uint8_t *at, const uint8_t *end)
{
    float value[LAYOUT_SWITCHES] = {0};
    for (int i = 0; i < REPORTS && at < end; ++i) {
        size_t size;
        uint8_t *report = next_report(&at, end, &size);
        if (report)
            (void)decode_report(l, report, size, value);
        free(report);
        for (int k = 0; k < LAYOUT_SWITCHES; ++k)
            assert(value[k] >= 0.0f && value[k] <= 1.0f);
    }
}

static void check_text_of(const layout *l)
{
    char text[LAYOUT_TEXT_BYTES], again[LAYOUT_TEXT_BYTES], reason[LAYOUT_TEXT_REASON];
    layout back;
    size_t size = layout_text_print(text, l);
    assert(layout_text_parse(&back, text, size, reason) == MRT_OK);
    layout_text_print(again, &back);
    assert(strcmp(text, again) == 0);
}

static void check_learning(const descriptor *fields, const uint8_t *at, const uint8_t *end)
{
    static learn lesson;
    layout of = {.vendor = 1, .product = 2, .name = "thing", .endpoint = 0x81};
    int64_t now_ns = 0;
    learn_start(&lesson, &of, fields, now_ns);
    for (int i = 0; i < REPORTS && at < end; ++i) {
        size_t size;
        uint8_t *report = next_report(&at, end, &size);
        now_ns += 100000000;
        if (report)
            (void)learn_report(&lesson, report, size, now_ns);
        (void)learn_tick(&lesson, now_ns);
        free(report);
    }
    check_layout(&lesson.found);
    if (lesson.found.switch_count > 0)
        check_text_of(&lesson.found);
}

static void check_descriptor(const uint8_t *bytes, size_t size)
{
    descriptor fields;
    char reason[DESCRIPTOR_REASON] = "";
    if (size < 2)
        return;
    size_t told = (size_t)bytes[0] | (size_t)bytes[1] << 8;
    size_t length = told < size - 2 ? told : size - 2;
    if (descriptor_parse(&fields, bytes + 2, length, reason) < 0) {
        assert(reason[0] != '\0' && fields.field_count == 0);
        return;
    }
    assert(fields.field_count <= DESCRIPTOR_FIELDS);
    for (uint32_t i = 0; i < fields.field_count; ++i) {
        const descriptor_field *f = &fields.field[i];
        assert(f->width >= 1 && f->width <= 32 && f->low < f->high && f->count >= 1);
        assert(f->bit + (uint32_t)f->width * f->count <= DESCRIPTOR_REPORT_BYTES * 8);
    }
    layout l = {.axis_skip = (uint8_t)(size & 1)};
    (void)describe_switches(&l, &fields);
    (void)describe_keys(&l, &fields);
    (void)describe_may_be_pedal(&fields);
    check_layout(&l);
    check_reports(&l, bytes + 2 + length, bytes + size);
    check_learning(&fields, bytes + 2 + length, bytes + size);
}

static void check_text(const uint8_t *bytes, size_t size)
{
    char reason[LAYOUT_TEXT_REASON] = "";
    layout l;
    const uint8_t *end = size > 0 ? memchr(bytes, 0, size) : NULL;
    size_t length = end ? (size_t)(end - bytes) : size;
    if (layout_text_parse(&l, (const char *)bytes, length, reason) < 0) {
        assert(reason[0] != '\0' && l.switch_count == 0);
        return;
    }
    check_layout(&l);
    check_text_of(&l);
    check_reports(&l, bytes + length, bytes + size);
    check_learning(NULL, bytes + length, bytes + size);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size > 0 && bytes[0] == 't')
        check_text(bytes + 1, size - 1);
    else if (size > 0)
        check_descriptor(bytes + 1, size - 1);
    return 0;
}
