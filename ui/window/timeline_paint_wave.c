#include "window/timeline_state.h"

#include <math.h>

/* Sound that is hardly heard is seen. */
static float swing(float value)
{
    float size = sqrtf(fminf(fabsf(value), 1.0f));
    return value < 0.0f ? -size : size;
}

static int64_t frame_ns(const show_audio *about, int64_t frame)
{
    return (int64_t)((double)frame * 1e9 / about->rate_hz);
}

static void paint_body(panel *self, ui *on, const timeline_row *row, const take *t)
{
    const show_audio *about = &self->seen->about;
    float x0 = timeline_axis_x(&self->axis, t->audio.offset_ns);
    float x1 =
        timeline_axis_x(&self->axis, t->audio.offset_ns + frame_ns(about, about->frame_count));
    float left = self->axis.x - 20.0f, right = self->axis.x + self->axis.width + 20.0f;
    x0 = x0 < left ? left : x0;
    x1 = x1 > right ? right : x1;
    if (x1 > x0)
        ui_draw_box(on, (ui_rectangle){x0, row->y + 2.0f, x1 - x0, row->height - 4.0f}, 0x272631ffu,
                    3.0f);
}

void timeline_paint_wave(panel *self, ui *on, const timeline_row *row, const take *t)
{
    const timeline_seen *seen = self->seen;
    if (seen->audio != t->audio.audio || seen->about.rate_hz == 0)
        return;
    paint_body(self, on, row, t);
    if (!seen->has_wave)
        return;
    float middle = row->y + 0.5f * row->height, half = 0.5f * row->height - 5.0f;
    float gain = (float)t->audio.gain;
    uint32_t count = 0;
    for (size_t i = 0; i < seen->wave.count && count < TIMELINE_COLUMNS_MAX; ++i) {
        int64_t frame = seen->wave.first_frame + (int64_t)i * seen->wave.frames_per_pair;
        float low = middle - half * swing(seen->wave.pair[i].least * gain);
        float high = middle - half * swing(seen->wave.pair[i].greatest * gain);
        if (low - high < 1.0f) {
            low = 0.5f * (low + high) + 0.5f;
            high = low - 1.0f;
        }
        self->column_x[count] =
            timeline_axis_x(&self->axis, t->audio.offset_ns + frame_ns(&seen->about, frame));
        self->column_low[count] = low;
        self->column_high[count] = high;
        count += 1;
    }
    if (count > 1)
        ui_draw_area(on, self->column_x, self->column_low, self->column_high, count,
                     TIMELINE_WAVE_COLOUR);
}
