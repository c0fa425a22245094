#include "calibrate_screen.h"

#include "hand/sensor.h"

#include <stdarg.h>
#include <string.h>
#include <unistd.h>

enum { BAR_WIDTH = 18, COLUMNS = 2, WIDTH = 78 };

void calibrate_screen_begin(calibrate_screen *self, FILE *stream, bool has_keys, uint32_t sensors)
{
    *self = (calibrate_screen){.stream = stream,
                               .is_terminal = isatty(fileno(stream)) == 1,
                               .has_keys = has_keys,
                               .sensors = sensors,
                               .raw_max = 255.0f};
}

void calibrate_screen_step(calibrate_screen *self, const guide *of)
{
    guide_step step = guide_current(of);
    if (self->is_terminal || step == GUIDE_STEPS)
        return;
    fprintf(self->stream, "step %d of %d, %s: %s\n", (int)step + 1, GUIDE_STEPS,
            guide_step_name[step], guide_step_words[step]);
    fflush(self->stream);
}

void calibrate_screen_news(calibrate_screen *self, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(self->news, sizeof self->news, format, arguments);
    va_end(arguments);
    if (self->is_terminal)
        return;
    fprintf(self->stream, "  %s\n", self->news);
    fflush(self->stream);
}

/* ---- the block ---- */

static void end_line(calibrate_screen *self)
{
    fputs("\033[K\n", self->stream);
    self->line_count += 1;
}

/* At most two lines, so that the block keeps its height. */
static void draw_words(calibrate_screen *self, const char *words)
{
    size_t length = strlen(words), cut = length;
    if (length > WIDTH)
        for (cut = WIDTH; cut > 0 && words[cut] != ' ';)
            cut -= 1;
    if (cut == 0)
        cut = WIDTH;
    fprintf(self->stream, "%.*s", (int)cut, words);
    end_line(self);
    if (cut < length)
        fprintf(self->stream, "%.*s", WIDTH, words + cut + (words[cut] == ' '));
    end_line(self);
}

static int cell_of(const calibrate_screen *self, float raw)
{
    float share = (raw - self->raw_min) / (self->raw_max - self->raw_min);
    float within = share > 0.0f ? share < 1.0f ? share : 1.0f : 0.0f;
    return (int)(within * (float)(BAR_WIDTH - 1) + 0.5f);
}

/* "index.mpj   [...---#--......]  134": what was seen, and where it is now. */
static void draw_bar(calibrate_screen *self, int sensor, float raw, float low, float high)
{
    char bar[BAR_WIDTH + 1];
    int first = cell_of(self, low), last = cell_of(self, high), now = cell_of(self, raw);
    for (int i = 0; i < BAR_WIDTH; ++i)
        bar[i] = i == now ? '#' : i >= first && i <= last ? '-' : '.';
    bar[BAR_WIDTH] = '\0';
    fprintf(self->stream, "%-11s [%s] %4.0f", sensor_table[sensor].name, bar, (double)raw);
}

static void draw_bars(calibrate_screen *self, const guide *of, const float *raw)
{
    float low[MRT_ANGLES], high[MRT_ANGLES];
    guide_range(of, low, high);
    int column = 0;
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor) {
        if (!(self->sensors >> sensor & 1u))
            continue;
        draw_bar(self, sensor, raw[sensor], low[sensor], high[sensor]);
        column = (column + 1) % COLUMNS;
        if (column == 0)
            end_line(self);
        else
            fputs("  ", self->stream);
    }
    if (column != 0)
        end_line(self);
}

void calibrate_screen_draw(calibrate_screen *self, const guide *of, const float *raw)
{
    if (!self->is_terminal)
        return;
    if (self->line_count > 0)
        fprintf(self->stream, "\033[%dA\r", self->line_count);
    self->line_count = 0;
    guide_step step = guide_current(of);
    const char *words = step < GUIDE_STEPS ? guide_step_words[step] : "";
    const char *waits =
        self->is_away ? "the glove is away: waiting for it" : guide_wait_words[guide_waiting(of)];
    int number = (int)step + (step < GUIDE_STEPS);
    fprintf(self->stream, "step %d of %d: %s (%s)", number, GUIDE_STEPS,
            step < GUIDE_STEPS ? guide_step_name[step] : "done", waits);
    end_line(self);
    draw_words(self, words);
    draw_bars(self, of, raw);
    draw_words(self, self->news);
    if (self->has_keys) {
        fputs(step < GUIDE_STEPS
                  ? "Enter takes the pose now, r repeats the last, s skips, q quits"
                  : "Enter saves, r repeats the pose that is named or the last, q quits",
              self->stream);
        end_line(self);
    }
    fflush(self->stream);
}

void calibrate_screen_end(calibrate_screen *self)
{
    self->line_count = 0;
}
