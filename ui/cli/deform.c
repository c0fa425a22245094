#include "cli/command.h"

#include "base/file.h"
#include "cli/deform_case.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_CAP = 1 << 28, READ_STEP = 1 << 16 }; /* bytes */

typedef struct options {
    const char *path; /* "-": stdin */
    deform_precision precision;
    bool is_json; /* accepted, but the result is always JSON */
} options;

static int read_precision(void *to, const command *self, const char *name, const char *text)
{
    if (strcmp(text, "f32") != 0 && strcmp(text, "f64") != 0)
        return command_usage(self, "--%s: expected f32 or f64", name);
    *(deform_precision *)to = strcmp(text, "f32") == 0 ? DEFORM_F32 : DEFORM_F64;
    return COMMAND_DONE;
}

#define AT(member) .offset = offsetof(options, member)
static const command_option option_table[] = {
    {"CASE", COMMAND_WORD, AT(path)},
    {"precision", COMMAND_READ, AT(precision), .read = read_precision},
    {"json", COMMAND_FLAG, AT(is_json)},
    {.name = NULL},
};

static mrt_result read_stdin(file_bytes *out, error *err)
{
    *out = (file_bytes){0};
    size_t capacity = 0, got;
    do {
        if (out->size + READ_STEP + 1 > capacity) {
            capacity = 2 * capacity + READ_STEP + 1;
            unsigned char *larger = realloc(out->data, capacity);
            if (!larger) {
                file_bytes_finish(out);
                return error_set(err, MRT_ERR_MEMORY, "-: no memory for the case");
            }
            out->data = larger;
        }
        got = fread(out->data + out->size, 1, READ_STEP, stdin);
        out->size += got;
    } while (got > 0 && out->size <= FILE_CAP);
    out->data[out->size] = 0;
    mrt_result result = MRT_OK;
    if (ferror(stdin))
        result = error_set(err, MRT_ERR_IO, "-: %s", strerror(errno));
    else if (out->size > FILE_CAP)
        result = error_set(err, MRT_ERR_UNSUPPORTED, "-: standard input is larger than %d MiB",
                           FILE_CAP >> 20);
    if (result < 0)
        file_bytes_finish(out);
    return result;
}

static mrt_result read_case(deform_case *out, const char *path, error *err)
{
    file_bytes bytes;
    mrt_result result =
        strcmp(path, "-") == 0 ? read_stdin(&bytes, err) : file_read(&bytes, path, FILE_CAP, err);
    if (result < 0)
        return result;
    result = deform_case_read(out, bytes.data, bytes.size, path, err);
    file_bytes_finish(&bytes);
    return result;
}

/* position: frame_count by point_count by 3. NULL: no memory. */
static json_t *frames_to_json(const deform_case *c, const double *position)
{
    json_t *frames = json_array();
    for (uint32_t frame = 0; frame < c->frame_count; ++frame) {
        json_t *rows = json_array();
        for (uint32_t i = 0; i < c->point_count; ++i, position += 3)
            json_array_append_new(rows, json_pack("[fff]", position[0], position[1], position[2]));
        json_array_append_new(frames, rows);
    }
    return json_pack("{s:o}", "frames", frames);
}

static mrt_result print_frames(const deform_case *c, const double *position, error *err)
{
    json_t *all = frames_to_json(c, position);
    if (!all)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the result");
    int failed = json_dumpf(all, stdout, JSON_REAL_PRECISION(17));
    json_decref(all);
    putchar('\n');
    if (failed || fflush(stdout) != 0 || ferror(stdout))
        return error_set(err, MRT_ERR_IO, "cannot write the result: %s", strerror(errno));
    return MRT_OK;
}

static mrt_result deform(const deform_case *c, const options *o, error *err)
{
    size_t numbers = (size_t)3 * c->frame_count * c->point_count;
    double *position = calloc(numbers + 1, sizeof *position);
    if (!position)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %zu numbers", numbers);
    mrt_result result = deform_case_run(c, o->precision, position, err);
    if (result < 0)
        error_prefix(err, o->path);
    else
        result = print_frames(c, position, err);
    free(position);
    return result;
}

static int run(int argc, char **argv)
{
    options o = {.precision = DEFORM_F64};
    deform_case c;
    error err = {""};
    int code = command_options(&o, &command_deform, option_table, argc, argv);
    if (code == COMMAND_DONE && !o.path)
        code = command_usage(&command_deform, "expected a case file, or - for standard input");
    if (code != COMMAND_DONE)
        return code;
    if (read_case(&c, o.path, &err) < 0)
        return command_failed(&command_deform, &err);
    if (c.unknown[0])
        fprintf(stderr, "marotte deform: %s: unknown keys, ignored: %s\n", o.path, c.unknown);
    mrt_result result = deform(&c, &o, &err);
    deform_case_destroy(&c);
    return result < 0 ? command_failed(&command_deform, &err) : COMMAND_DONE;
}

const command command_deform = {
    .name = "deform",
    .summary = "apply control vectors to points",
    .help =
        "usage: marotte deform CASE.json [--precision f32|f64] [--json]\n"
        "\n"
        "Reads control vectors and points from CASE.json (- is standard input), deforms the\n"
        "points in every frame, and prints {\"frames\": [frame][point][x, y, z]}.\n"
        "\n"
        "  kernel      wendland_c2, wendland_c0, wendland_c4, wendland_c6\n"
        "  radius      support radius of every centre, > 0\n"
        "  polynomial  none, constant, linear, windowed\n"
        "  mode        anchored: each frame from the points at time 0;\n"
        "              unanchored: each frame from the frame before\n"
        "  starts      [tip][3] at time 0\n"
        "  frames      [frame][tip][3] at times 1, 2, ...\n"
        "  skull       optional: [centre][3], fixed points\n"
        "  jaw         optional: centres [centre][3], axis_point [3], axis_dir [3],\n"
        "              poses [frame]{angle (rad), translation [3]}\n"
        "  points      [point][3]\n"
        "\n"
        "  --precision f64   solve, store and evaluate in double (default)\n"
        "  --precision f32   solve in double, store and evaluate in float\n"
        "  --json            accepted, because other commands have it; the result is always JSON\n",
    .examples = "deform case.json\n"
                "deform case.json --precision f32\n"
                "deform - <case.json\n",
    .run = run,
    .options = option_table,
};
