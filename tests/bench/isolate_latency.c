/* What it costs to have a mapping in a process of its own: isolate_latency [PLUGIN.so]
 * Prints the time of process() in this process, and in another one: called again at once, and 90
 * times a second, when the other process sleeps in between. Median, 99th percentile and worst. Not
 * a test: a clock decides nothing here. */
#include "base/clock.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES = 2000 };

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double took_us[FRAMES];

static double tell(const char *what)
{
    qsort(took_us, FRAMES, sizeof *took_us, by_size);
    printf("%-36s median %7.1f  p99 %7.1f  worst %7.1f us\n", what, took_us[FRAMES / 2],
           took_us[FRAMES * 99 / 100], took_us[FRAMES - 1]);
    return took_us[FRAMES / 2];
}

static void move(mrt_frame *frame, int n)
{
    float way = (float)(n % 100) * 0.2f;
    frame->time_ns += NS_PER_S / 90;
    frame->dt_s = 1.0 / 90;
    frame->hand[MRT_RIGHT].present = true;
    frame->hand[MRT_RIGHT].time_ns = frame->time_ns;
    for (int i = 0; i < MRT_JOINTS; ++i)
        frame->hand[MRT_RIGHT].joint[i] = (mrt_vec3){(float)i * 4, way, 80};
}

static double measure(instance *of, int64_t period_ns, const char *what)
{
    static const mapped_face face = {.about = {.low = {-75, 0, -75}, .high = {75, 300, 75}}};
    const mrt_mapping *mapping = plugin_interface(of->type, MRT_MAPPING);
    mrt_frame frame = {.params = of->params};
    mrt_pull pull = {0};
    error err = {""};
    if (instance_activate(of, &face, &err) < 0)
        return NAN;
    mapping->reset(of->self);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        pull.dof[i] = NAN;
    for (int n = 0; n < FRAMES; ++n) {
        move(&frame, n);
        if (period_ns > 0)
            clock_sleep_until_ns(clock_now_ns() + period_ns);
        int64_t start_ns = clock_now_ns();
        if (mapping->process(of->self, &frame, &pull) < 0)
            return NAN;
        took_us[n] = (double)(clock_now_ns() - start_ns) * 1e-3;
    }
    instance_deactivate(of);
    return tell(what);
}

int main(int argc, char **argv)
{
    const char *path = argc > 1 ? argv[1] : BUILD_DIR "/plugins/anchored.so";
    const isolate_settings settings = {.clock = CLOCK_REAL, .deadline_ns = NS_PER_S};
    const mrt_plugin_type *type;
    plugin_list list = {0};
    isolate *apart = NULL;
    instance here = {0}, there = {0};
    error err = {""};
    log_queue *log = log_queue_create();
    mrt_result result = plugin_list_choose(&list, path, MRT_MAPPING, &type, &err);
    if (result >= 0)
        result = isolate_create_mapping(&apart, type, path, &settings, &err);
    if (result >= 0)
        result = instance_create(&here, type, CLOCK_REAL, log, &err);
    if (result >= 0)
        result = instance_create(&there, isolate_type(apart), CLOCK_REAL, log, &err);
    if (result >= 0) {
        instance_latch(&here);
        instance_latch(&there);
        double plain = measure(&here, NS_PER_S / 90, "in this process, 90 a second");
        (void)measure(&there, 0, "in another, again at once");
        double apart_us = measure(&there, NS_PER_S / 90, "in another, 90 a second");
        printf("added: median %.1f us\n", apart_us - plain);
    } else {
        (void)fprintf(stderr, "isolate_latency: %s\n", err.text);
    }
    instance_destroy(&there);
    instance_destroy(&here);
    isolate_destroy(apart);
    plugin_list_destroy(&list);
    log_queue_destroy(log);
    return result < 0;
}
