#include "glove_watch.h"

#include "base/clock.h"

#include <stdio.h>
#include <time.h>

/* What the types below stand in front of, and who watches: there is one performance. */
static struct {
    const mrt_input *input;
    const mrt_mapping *mapping;
    glove_stage *stage;
    int64_t first_ns;
    double first_cpu_s;
} behind;

static double thread_cpu_s(void)
{
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static mrt_result watched_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                               mrt_sample *out)
{
    glove_stage *stage = behind.stage;
    mrt_result result = behind.input->read(self, params, deadline_ns, out);
    if (result != MRT_OK)
        return result;
    if (behind.first_ns == 0) {
        behind.first_ns = clock_now_ns();
        behind.first_cpu_s = thread_cpu_s();
    }
    stage->reader_time_s = (double)(clock_now_ns() - behind.first_ns) * 1e-9;
    stage->reader_cpu_s = thread_cpu_s() - behind.first_cpu_s;
    uint32_t count;
    if (stage->watch.sample)
        stage->watch.sample(stage->watch.data, behind.input->channels(self, &count), out);
    return result;
}

static mrt_result watched_process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_result result = behind.mapping->process(self, frame, pull);
    if (behind.stage->watch.pull)
        behind.stage->watch.pull(behind.stage->watch.data, frame, pull, clock_now_ns());
    return result;
}

static mrt_input input_functions;
static mrt_mapping mapping_functions;
static const mrt_interface input_interfaces[] = {{MRT_INPUT, &input_functions}, {NULL, NULL}};
static const mrt_interface mapping_interfaces[] = {{MRT_MAPPING, &mapping_functions}, {NULL, NULL}};
static mrt_plugin_type input_type, mapping_type;

static void stand_before_input(const mrt_plugin_type *type)
{
    behind.input = plugin_interface(type, MRT_INPUT);
    input_functions = *behind.input;
    input_functions.read = watched_read;
    input_type = *type;
    input_type.interfaces = input_interfaces;
}

static void stand_before_mapping(const mrt_plugin_type *type)
{
    behind.mapping = plugin_interface(type, MRT_MAPPING);
    mapping_functions = *behind.mapping;
    mapping_functions.process = watched_process;
    mapping_type = *type;
    mapping_type.interfaces = mapping_interfaces;
}

static mrt_result find(glove_stage *stage, const char *build, const char *name,
                       const char *interface_id, const mrt_plugin_type **out, error *err)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/plugins/%s.so", build, name);
    mrt_result result = plugin_list_add(&stage->plugins, path, err);
    return result < 0 ? result : plugin_list_find(&stage->plugins, name, interface_id, out, err);
}

mrt_result glove_stage_create(glove_stage *out, const char *build, const char *rig_path,
                              const char *address, const glove_watch *watch, error *err)
{
    const mrt_plugin_type *glove, *map;
    performer_settings settings = {.hand_length_mm = 0};
    *out = (glove_stage){.watch = *watch};
    behind.stage = out;
    behind.first_ns = 0;
    out->log = log_queue_create();
    mrt_result result = out->log ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = find(out, build, "cyberglove", MRT_INPUT, &glove, err);
    if (result >= 0)
        result = find(out, build, "one_hand", MRT_MAPPING, &map, err);
    if (result >= 0)
        result = face_file_read(&out->face, rig_path, NULL, FACE_FILE_USABLE, err);
    if (result < 0)
        goto fail;
    stand_before_input(glove);
    stand_before_mapping(map);
    result = input_create(&out->input, &input_type, address, "", CLOCK_REAL, out->log, err);
    if (result >= 0)
        result = instance_create(&out->mapping, &mapping_type, CLOCK_REAL, out->log, err);
    if (result >= 0)
        result = performer_create(&out->performer, &out->face, &out->mapping, &settings, err);
    if (result >= 0)
        return result;
fail:
    glove_stage_destroy(out);
    return result;
}

void glove_stage_destroy(glove_stage *stage)
{
    performer_destroy(stage->performer);
    instance_destroy(&stage->mapping);
    input_destroy(stage->input);
    face_file_destroy(&stage->face);
    plugin_list_destroy(&stage->plugins);
    log_queue_destroy(stage->log);
    *stage = (glove_stage){0};
}
