#include "stage/mapping/isolate_report.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "hand/sensor.h"
#include "stage/mapping/plugins.h"
#include "show/hash.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

static const int64_t report_span_ns = 2 * NS_PER_S;
static const char *const side_names[2] = {"left", "right"};
enum { FOLDERS_MAX = 100 };

void isolate_memory_add(isolate_memory *self, const mrt_frame *frame)
{
    isolate_seen *seen = &self->seen[self->count++ % ISOLATE_REPORT_FRAMES];
    seen->time_ns = frame->time_ns;
    memcpy(seen->pedal, frame->pedal, sizeof seen->pedal);
    for (int side = 0; side < 2; ++side) {
        seen->present[side] = frame->hand[side].present;
        memcpy(seen->angle[side], frame->hand[side].angle, sizeof seen->angle[side]);
    }
}

/* ---- folder ---- */

/* Creates a folder such as "2026-11-21 20-31-07 anchored", with " 2" and so on if it exists. */
static mrt_result make_report_folder(const mrt_plugin_type *type, char *out, size_t capacity,
                                     error *err)
{
    char reports[PATH_MAX], when[32] = "";
    mrt_result result = file_home_path(reports, sizeof reports, FILE_HOME_DATA, "reports", err);
    if (result >= 0)
        result = file_make_folders(reports, err);
    if (result < 0)
        return result;
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc))
        (void)strftime(when, sizeof when, "%Y-%m-%d %H-%M-%S", &utc);
    for (int n = 1; n < FOLDERS_MAX; ++n) {
        char number[16] = "";
        if (n > 1)
            (void)snprintf(number, sizeof number, " %d", n);
        int length = snprintf(out, capacity, "%s/%s %.60s%s", reports, when,
                              plugin_short_name(type), number);
        if (length <= 0 || (size_t)length >= capacity)
            return error_set(err, MRT_ERR_IO, "the path of the folder of reports is too long");
        if (mkdir(out, 0777) == 0)
            return MRT_OK;
        if (errno != EEXIST)
            return error_set(err, MRT_ERR_IO, "cannot create %s: %s", out, strerror(errno));
    }
    return error_set(err, MRT_ERR_IO, "%s: too many reports in one second", reports);
}

static mrt_result open_in(file_writer *out, const char *folder, const char *name, error *err)
{
    char path[PATH_MAX];
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length <= 0 || (size_t)length >= sizeof path)
        return error_set(err, MRT_ERR_IO, "%s: the path is too long", folder);
    return file_writer_open(out, path, err);
}

/* ---- the hands ---- */

static const isolate_seen *seen_at(const isolate_memory *m, uint64_t i)
{
    return &m->seen[i % ISOLATE_REPORT_FRAMES];
}

static uint64_t first_of_span(const isolate_memory *m)
{
    uint64_t first = m->count > ISOLATE_REPORT_FRAMES ? m->count - ISOLATE_REPORT_FRAMES : 0;
    while (m->count > 0 && first + 1 < m->count &&
           seen_at(m, m->count - 1)->time_ns - seen_at(m, first)->time_ns > report_span_ns)
        first += 1;
    return first;
}

static bool is_side_seen(const isolate_memory *m, int side)
{
    for (uint64_t i = first_of_span(m); i < m->count; ++i)
        if (seen_at(m, i)->present[side])
            return true;
    return false;
}

static void print_hand(FILE *to, const isolate_memory *m, int side)
{
    (void)fprintf(to, "time_ns");
    for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
        (void)fprintf(to, ",%s.%s", side_names[side], sensor_table[sensor].name);
    for (int pedal = 1; pedal <= MRT_MAX_PEDALS; ++pedal)
        (void)fprintf(to, ",pedal.%d", pedal);
    (void)fprintf(to, "\n");
    for (uint64_t i = first_of_span(m); i < m->count; ++i) {
        const isolate_seen *seen = seen_at(m, i);
        if (!seen->present[side])
            continue;
        (void)fprintf(to, "%jd", (intmax_t)seen->time_ns);
        for (int sensor = 0; sensor < MRT_ANGLES; ++sensor)
            (void)fprintf(to, ",%.9g", (double)seen->angle[side][sensor]);
        for (int pedal = 0; pedal < MRT_MAX_PEDALS; ++pedal)
            (void)fprintf(to, ",%g", (double)seen->pedal[pedal]);
        (void)fprintf(to, "\n");
    }
}

static mrt_result write_hands(const isolate_memory *m, const char *folder, error *err)
{
    mrt_result result = MRT_OK;
    for (int side = 0; side < 2 && result >= 0; ++side) {
        file_writer file;
        if (!is_side_seen(m, side))
            continue;
        result = open_in(&file, folder, side == MRT_LEFT ? "left.csv" : "right.csv", err);
        if (result < 0)
            return result;
        print_hand(file.stream, m, side);
        result = file_writer_commit(&file, err);
    }
    return result;
}

/* ---- report.txt ---- */

static void print_face(FILE *to, const mrt_face *face)
{
    (void)fprintf(to, "face: %g %g %g to %g %g %g mm, %u contacts, %u degrees of freedom\n",
                  (double)face->low.x, (double)face->low.y, (double)face->low.z,
                  (double)face->high.x, (double)face->high.y, (double)face->high.z,
                  face->contact_count, face->dof_count);
    for (uint32_t i = 0; i < face->contact_count; ++i) {
        const mrt_contact *c = &face->contacts[i];
        (void)fprintf(to, "contact: %s on %s, %.6g %.6g %.6g mm\n", c->name, c->bone,
                      (double)c->rest.x, (double)c->rest.y, (double)c->rest.z);
    }
    for (uint32_t i = 0; i < face->dof_count; ++i)
        (void)fprintf(to, "degree of freedom: %s, %g to %g %s\n", face->dofs[i].name,
                      (double)face->dofs[i].min, (double)face->dofs[i].max, face->dofs[i].unit);
}

static void print_report(FILE *to, const isolate_report *r)
{
    char hash[TAKE_HASH] = "-";
    error ignored = {""};
    if (hash_file(hash, r->library, &ignored) < 0)
        (void)snprintf(hash, sizeof hash, "-");
    char library[4 * PATH_MAX]; /* quoted for a shell command */
    program_quote(library, sizeof library, r->library);
    (void)fprintf(to, "plugin: %s %s\nlibrary: %s\nsha256: %s\nreason: %s\n", r->type->id,
                  r->type->version, library, hash, r->reason);
    for (uint32_t i = 0; i < r->type->param_count; ++i)
        (void)fprintf(to, "parameter: %s/%s = %.17g %s\n", r->type->params[i].group,
                      r->type->params[i].name, r->params[i], r->type->params[i].unit);
    print_face(to, r->face);
    (void)fprintf(to,
                  "\nThe mapping failed in the last frame. To reproduce the failure with your "
                  "own face:\nmarotte perform --face FACE --map %s",
                  library);
    for (int side = 0; side < 2; ++side)
        if (is_side_seen(r->memory, side))
            (void)fprintf(to, " --input log:%s.csv", side_names[side]);
    (void)fprintf(to, " --calibration none --isolate off\n");
}

mrt_result isolate_report_write(const isolate_report *report, char *out_folder, size_t capacity,
                                error *err)
{
    file_writer file;
    out_folder[0] = '\0';
    mrt_result result = make_report_folder(report->type, out_folder, capacity, err);
    if (result < 0) {
        out_folder[0] = '\0';
        return result;
    }
    result = write_hands(report->memory, out_folder, err);
    if (result >= 0)
        result = open_in(&file, out_folder, "report.txt", err);
    if (result < 0)
        return result;
    print_report(file.stream, report);
    return file_writer_commit(&file, err);
}
