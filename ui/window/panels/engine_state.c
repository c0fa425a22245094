#include "window/panels/engine_state.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { VALUE_TEXT = 64 };

typedef enum value_kind {
    VALUE_BOOL,
    VALUE_ENUM, /* int */
    VALUE_U32,
    VALUE_U64,
    VALUE_I64,
    VALUE_SIZE,
    VALUE_SECONDS, /* int64_t, ns */
    VALUE_DOUBLE
} value_kind;

typedef struct value_field {
    const char *name;
    value_kind kind;
    bool is_of_view; /* of live_view; else of live_status */
    size_t offset;
} value_field;

#define STATUS(kind, field)                                                                        \
    {                                                                                              \
#field, VALUE_##kind, false, offsetof(live_status, field)                                  \
    }
#define VIEW(kind, field)                                                                          \
    {                                                                                              \
        "view." #field, VALUE_##kind, true, offsetof(live_view, field)                             \
    }

static const value_field fields[] = {
    STATUS(BOOL, can_record),
    STATUS(BOOL, is_recording),
    STATUS(I64, take),
    STATUS(SECONDS, recorded_ns),
    STATUS(SECONDS, journal_ns),
    STATUS(SIZE, kept_bytes),
    STATUS(U64, sample_count),
    STATUS(U64, counts.samples),
    STATUS(U64, counts.steps),
    STATUS(U64, counts.solves),
    STATUS(U64, counts.bad_pulls),
    STATUS(U64, counts.held_pulls),
    STATUS(U64, counts.limited_steps),
    STATUS(U64, counts.folded_steps),
    STATUS(U64, counts.substeps),
    STATUS(U64, counts.engagements),
    STATUS(U64, counts.commits),
    STATUS(DOUBLE, counts.min_determinant),
    STATUS(DOUBLE, frame_p50_ms),
    STATUS(DOUBLE, frame_p99_ms),
    STATUS(U32, frame_count),
    STATUS(DOUBLE, lag_p99_ms),
    STATUS(ENUM, writer.state),
    STATUS(BOOL, writer.is_missing),
    STATUS(U32, writer.backlog),
    STATUS(U64, writer.committed_count),
    STATUS(U64, writer.lost_count),
    STATUS(U64, writer.lost_event_count),
    STATUS(SIZE, writer.held_bytes),
    STATUS(U32, isolated.failed),
    STATUS(U32, isolated.restarted),
    STATUS(U32, isolated.late),
    STATUS(BOOL, isolated.is_away),
    STATUS(U32, reload_taken),
    STATUS(U32, reload_refused),
    STATUS(U32, rezeros.done),
    STATUS(U32, rezeros.refused),
    STATUS(U64, patch_speaks),
    STATUS(DOUBLE, code.frame),
    STATUS(DOUBLE, code.fps),
    STATUS(BOOL, is_sound_armed),
    STATUS(ENUM, playing.device.state),
    STATUS(BOOL, playing.is_heard),
    STATUS(DOUBLE, playing.drift_ppm),
    STATUS(U32, playing.jumped_count),
    STATUS(U32, playing.starved_count),
    STATUS(U32, playing.broken_count),
    STATUS(ENUM, listening.device.state),
    VIEW(U64, number),
    VIEW(U32, vertex_count),
    VIEW(U32, contact_count),
    VIEW(ENUM, mode),
    VIEW(BOOL, is_anchored),
    VIEW(DOUBLE, solver.radius),
    VIEW(DOUBLE, min_determinant),
    VIEW(DOUBLE, penetration_mm),
    VIEW(SECONDS, at_ns),
    VIEW(BOOL, is_playing),
    VIEW(BOOL, is_recording_over),
    VIEW(U32, pass),
};

/* Copies the bytes of a field, of any type. */
#define FIELD(type, to)                                                                            \
    type to;                                                                                       \
    memcpy(&to, at, sizeof to)

static void write_value(char out[VALUE_TEXT], value_kind kind, const unsigned char *at)
{
    FIELD(uint32_t, u32);
    switch (kind) {
    case VALUE_BOOL:
        (void)snprintf(out, VALUE_TEXT, "%s", *at ? "true" : "false");
        return;
    case VALUE_ENUM:
    case VALUE_U32:
        (void)snprintf(out, VALUE_TEXT, "%" PRIu32, u32);
        return;
    default:
        break;
    }
    FIELD(uint64_t, u64);
    FIELD(int64_t, i64);
    FIELD(double, number);
    if (kind == VALUE_DOUBLE)
        (void)snprintf(out, VALUE_TEXT, "%.6g", number);
    else if (kind == VALUE_SECONDS)
        (void)snprintf(out, VALUE_TEXT, "%.6f s", 1e-9 * (double)i64);
    else if (kind == VALUE_I64)
        (void)snprintf(out, VALUE_TEXT, "%" PRId64, i64);
    else
        (void)snprintf(out, VALUE_TEXT, "%" PRIu64, u64);
}

void engine_state_draw(ui *on, const live_status *status, const live_view *view)
{
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; ++i) {
        const value_field *field = &fields[i];
        const unsigned char *base =
            field->is_of_view ? (const unsigned char *)view : (const unsigned char *)status;
        char value[VALUE_TEXT];
        write_value(value, field->kind, base + field->offset);
        ui_fact(on, field->name, 188.0f, UI_STYLE_BODY, value);
    }
}
