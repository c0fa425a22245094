#include "io/clip.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Index of a frame's numbers in clip.number; NO_NUMBERS: none. */
static const size_t NO_NUMBERS = SIZE_MAX;

typedef struct clip_frame {
    int32_t segment;      /* -1: free */
    int32_t pull_segment; /* -1: no pulls */
    size_t first_vector, first_control, first_value, first_pulled, first_pose, first_arkit;
    size_t first_joint[2]; /* of its hands, left and right */
    uint32_t control_count;
    uint64_t free_index; /* of a free frame, in the temporary file */
} clip_frame;

struct clip {
    const mesh *mesh;
    double fps;
    clip_start start;
    clip_arkit arkit;
    char *directory; /* "": the system's */
    clip_segment *segment;
    uint32_t segment_count, segment_capacity;
    clip_curve *curve;
    uint32_t curve_count, curve_capacity;
    clip_bone *bone;
    uint32_t bone_count, bone_capacity;
    clip_frame *frame;
    uint32_t frame_count, frame_capacity;
    double *number; /* of all frames */
    size_t number_count, number_capacity;
    uint64_t free_count;
    int fd; /* the temporary file, -1 until the first free frame */
};

static size_t position_bytes(const clip *c)
{
    return (size_t)c->mesh->vertex_count * 3 * sizeof(float);
}

static mrt_result no_memory(const clip *c, error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for frame %u of the clip", c->frame_count);
}

static mrt_result check_floats(const float *value, size_t count, const char *what, error *err)
{
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(value[i]))
            return error_set(err, MRT_ERR_ARGUMENT, "%s: value %zu is not finite", what, i);
    return MRT_OK;
}

/* Returns the array with space for one more element; NULL: no memory. */
static void *grow(void *array, uint32_t count, uint32_t *capacity, size_t element_size)
{
    if (count < *capacity)
        return array;
    if (*capacity > UINT32_MAX / 2)
        return NULL;
    uint32_t wanted = *capacity ? *capacity * 2 : 64;
    void *grown = realloc(array, wanted * element_size);
    if (grown)
        *capacity = wanted;
    return grown;
}

/* Appends an empty frame. */
static mrt_result add_frame(clip *c, int32_t segment, error *err)
{
    clip_frame *frame = grow(c->frame, c->frame_count, &c->frame_capacity, sizeof *c->frame);
    if (!frame)
        return no_memory(c, err);
    c->frame = frame;
    c->frame[c->frame_count++] = (clip_frame){.segment = segment,
                                              .pull_segment = -1,
                                              .first_vector = NO_NUMBERS,
                                              .first_control = NO_NUMBERS,
                                              .first_value = NO_NUMBERS,
                                              .first_pulled = NO_NUMBERS,
                                              .first_pose = NO_NUMBERS,
                                              .first_arkit = NO_NUMBERS,
                                              .first_joint = {NO_NUMBERS, NO_NUMBERS}};
    return MRT_OK;
}

static clip_frame *newest_frame(const clip *c)
{
    assert(c->frame_count > 0);
    return &c->frame[c->frame_count - 1];
}

static mrt_result append_numbers(clip *c, const double *number, size_t count, size_t *out_first,
                                 error *err)
{
    size_t needed = c->number_count + count;
    if (needed > c->number_capacity) {
        size_t wanted = needed + needed / 2 + 64;
        double *grown = realloc(c->number, wanted * sizeof *grown);
        if (!grown)
            return no_memory(c, err);
        c->number = grown;
        c->number_capacity = wanted;
    }
    if (count > 0)
        memcpy(c->number + c->number_count, number, count * sizeof *number);
    *out_first = c->number_count;
    c->number_count = needed;
    return MRT_OK;
}

/* Appends `count` items of `width` numbers: controls, columns, bones and others. All must be
 * finite. */
static mrt_result add_numbers(clip *c, const double *number, uint32_t count, uint32_t width,
                              const char *what, size_t *out_first, error *err)
{
    for (size_t i = 0; i < (size_t)count * width; ++i)
        if (!isfinite(number[i]))
            return error_set(err, MRT_ERR_ARGUMENT, "frame %u: %s %zu is not finite",
                             c->frame_count, what, i / width + 1);
    return append_numbers(c, number, (size_t)count * width, out_first, err);
}

static const double *numbers_from(const clip *c, size_t first)
{
    return first != NO_NUMBERS ? c->number + first : NULL;
}

static mrt_result open_temporary(clip *c, error *err)
{
    static const char name[] = "/marotte.XXXXXX";
    const char *directory = c->directory;
    if (!*directory)
        directory = getenv("TMPDIR");
    if (!directory || !*directory)
        directory = "/tmp";
    size_t size = strlen(directory) + sizeof name;
    char *path = malloc(size);
    if (!path)
        return no_memory(c, err);
    (void)snprintf(path, size, "%s%s", directory, name);
    mrt_result result = MRT_OK;
    c->fd = mkstemp(path);
    if (c->fd < 0) {
        result = error_set(err, MRT_ERR_IO,
                           "%s: cannot make a temporary file for the frames: %s; set TMPDIR to a "
                           "folder with room",
                           directory, strerror(errno));
    } else {
        (void)unlink(path);
        (void)fcntl(c->fd, F_SETFD, FD_CLOEXEC);
    }
    free(path);
    return result;
}

static mrt_result write_free(clip *c, const float *position, error *err)
{
    const char *bytes = (const char *)position;
    size_t size = position_bytes(c), done = 0;
    off_t start = (off_t)(c->free_count * size);
    while (done < size) {
        ssize_t put = pwrite(c->fd, bytes + done, size - done, start + (off_t)done);
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0)
            return error_set(err, MRT_ERR_IO,
                             "frame %u: cannot write the temporary file after %.1f MB: %s; set "
                             "TMPDIR to a folder with more room",
                             c->frame_count, (double)start / 1e6,
                             put < 0 ? strerror(errno) : "no room left");
        done += (size_t)put;
    }
    return MRT_OK;
}

static mrt_result read_free(const clip *c, uint32_t frame, float *out_position, error *err)
{
    char *bytes = (char *)out_position;
    size_t size = position_bytes(c), done = 0;
    off_t start = (off_t)(c->frame[frame].free_index * size);
    while (done < size) {
        ssize_t got = pread(c->fd, bytes + done, size - done, start + (off_t)done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return error_set(err, MRT_ERR_IO, "frame %u: cannot read the temporary file: %s", frame,
                             got < 0 ? strerror(errno) : "it has become shorter");
        done += (size_t)got;
    }
    return MRT_OK;
}

static void add_column(float *position, const float *column, uint32_t vertex_count,
                       const double *vector)
{
    float x = (float)vector[0], y = (float)vector[1], z = (float)vector[2];
    for (size_t v = 0; v < vertex_count; ++v) {
        position[v * 3] += column[v] * x;
        position[v * 3 + 1] += column[v] * y;
        position[v * 3 + 2] += column[v] * z;
    }
}

static void read_anchored(const clip *c, uint32_t frame, float *out_position)
{
    const clip_segment *segment = &c->segment[c->frame[frame].segment];
    const double *vector = clip_vector(c, frame);
    uint32_t vertex_count = c->mesh->vertex_count;
    memcpy(out_position, segment->base, position_bytes(c));
    for (uint32_t k = 0; k < segment->column_count; ++k)
        add_column(out_position, segment->column + (size_t)k * vertex_count, vertex_count,
                   vector + (size_t)k * 3);
}

static void pull_finish(clip_pull *pull)
{
    free(pull->name);
    free(pull->response);
}

static void curve_finish(clip_curve *curve)
{
    free(curve->name);
    free(curve->unit);
    free(curve->at_min);
    free(curve->at_max);
}

static void segment_finish(clip_segment *segment)
{
    for (uint32_t k = 0; segment->name && k < segment->column_count; ++k)
        free(segment->name[k]);
    for (uint32_t k = 0; k < segment->pull_count; ++k)
        pull_finish(&segment->pull[k]);
    free(segment->pull);
    free(segment->base);
    free(segment->column);
    free(segment->name);
    *segment = (clip_segment){0};
}

/* Returns a copy of `size` bytes. Allocates at least one byte. */
static void *copy_of(const void *data, size_t size)
{
    void *copy = malloc(size + 1);
    if (copy && size)
        memcpy(copy, data, size);
    return copy;
}

clip *clip_create(const mesh *m, double fps, const char *directory, error *err)
{
    if (m->vertex_count == 0) {
        (void)error_set(err, MRT_ERR_ARGUMENT, "a clip needs a mesh with vertices");
        return NULL;
    }
    if (!(fps > 0.0) || !isfinite(fps)) {
        (void)error_set(err, MRT_ERR_ARGUMENT, "%g frames per second: expected a number above 0",
                        fps);
        return NULL;
    }
    clip *c = calloc(1, sizeof *c);
    char *copy = strdup(directory ? directory : "");
    if (!c || !copy) {
        free(c);
        free(copy);
        (void)error_set(err, MRT_ERR_MEMORY, "no memory for the clip");
        return NULL;
    }
    c->mesh = m;
    c->fps = fps;
    c->directory = copy;
    c->fd = -1;
    return c;
}

void clip_destroy(clip *c)
{
    if (!c)
        return;
    for (uint32_t s = 0; s < c->segment_count; ++s)
        segment_finish(&c->segment[s]);
    for (uint32_t i = 0; i < c->curve_count; ++i)
        curve_finish(&c->curve[i]);
    free(c->curve);
    for (uint32_t i = 0; i < c->bone_count; ++i)
        free(c->bone[i].name);
    free(c->bone);
    if (c->fd >= 0)
        (void)close(c->fd);
    free(c->segment);
    free(c->frame);
    free(c->number);
    free(c->directory);
    free(c);
}

static bool name_columns(clip_segment *segment, const char *const *name)
{
    segment->name = calloc((size_t)segment->column_count + 1, sizeof *segment->name);
    for (uint32_t k = 0; segment->name && k < segment->column_count; ++k) {
        char usual[32];
        (void)snprintf(usual, sizeof usual, "control%u", k + 1);
        segment->name[k] = strdup(name ? name[k] : usual);
        if (!segment->name[k])
            return false;
    }
    return segment->name != NULL;
}

mrt_result clip_begin_segment(clip *c, const float *base, const float *column,
                              const char *const *name, uint32_t column_count, error *err)
{
    size_t vertex_count = c->mesh->vertex_count;
    mrt_result result = check_floats(base, vertex_count * 3, "the segment's base shape", err);
    if (result == MRT_OK)
        result = check_floats(column, vertex_count * column_count, "the segment's columns", err);
    if (result < 0)
        return result;
    clip_segment *grown =
        grow(c->segment, c->segment_count, &c->segment_capacity, sizeof *c->segment);
    if (!grown)
        return no_memory(c, err);
    c->segment = grown;
    clip_segment segment = {.base = copy_of(base, position_bytes(c)),
                            .column = copy_of(column, vertex_count * column_count * sizeof *column),
                            .column_count = column_count};
    if (!segment.base || !segment.column || !name_columns(&segment, name)) {
        segment_finish(&segment);
        return no_memory(c, err);
    }
    c->segment[c->segment_count++] = segment;
    return MRT_OK;
}

mrt_result clip_set_pulls(clip *c, const clip_pull *pull, uint32_t count, error *err)
{
    size_t vertex_count = c->mesh->vertex_count;
    if (c->segment_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "pulls need a segment");
    clip_segment *segment = &c->segment[c->segment_count - 1];
    assert(segment->pull_count == 0);
    segment->pull = calloc((size_t)count + 1, sizeof *segment->pull);
    for (uint32_t k = 0; segment->pull && k < count; ++k) {
        clip_pull *to = &segment->pull[k];
        const float *response = pull[k].response;
        mrt_result result =
            response ? check_floats(response, vertex_count, pull[k].name, err) : MRT_OK;
        if (result < 0)
            return result;
        *to = (clip_pull){.name = strdup(pull[k].name),
                          .response =
                              response ? copy_of(response, vertex_count * sizeof(float)) : NULL};
        memcpy(to->place_mm, pull[k].place_mm, sizeof to->place_mm);
        segment->pull_count = k + 1;
        if (!to->name || !to->response != !response)
            return no_memory(c, err);
    }
    return segment->pull ? MRT_OK : no_memory(c, err);
}

mrt_result clip_add_curve(clip *c, const clip_curve *what, error *err)
{
    assert(c->frame_count == 0);
    size_t count = (size_t)c->mesh->vertex_count * 3;
    mrt_result result = MRT_OK;
    if (!isfinite(what->min) || !isfinite(what->max) || what->min > 0.0 || what->max < 0.0 ||
        (what->at_min && !(what->min < 0.0)) || (what->at_max && !(what->max > 0.0)))
        return error_set(err, MRT_ERR_ARGUMENT, "%s: %g to %g: expected limits around 0",
                         what->name, what->min, what->max);
    if (what->at_min)
        result = check_floats(what->at_min, count, what->name, err);
    if (what->at_max && result == MRT_OK)
        result = check_floats(what->at_max, count, what->name, err);
    if (result < 0)
        return result;
    clip_curve *grown = grow(c->curve, c->curve_count, &c->curve_capacity, sizeof *c->curve);
    if (!grown)
        return no_memory(c, err);
    c->curve = grown;
    size_t size = count * sizeof(float);
    clip_curve *to = &c->curve[c->curve_count];
    *to = (clip_curve){.name = strdup(what->name),
                       .unit = strdup(what->unit),
                       .min = what->min,
                       .max = what->max,
                       .is_own = what->is_own,
                       .at_min = what->at_min ? copy_of(what->at_min, size) : NULL,
                       .at_max = what->at_max ? copy_of(what->at_max, size) : NULL};
    c->curve_count += 1;
    bool is_whole =
        to->name && to->unit && !to->at_min == !what->at_min && !to->at_max == !what->at_max;
    return is_whole ? MRT_OK : no_memory(c, err);
}

mrt_result clip_add_bone(clip *c, const clip_bone *what, error *err)
{
    assert(c->frame_count == 0 && (what->parent == CLIP_NO_BONE || what->parent < c->bone_count));
    clip_bone *grown = grow(c->bone, c->bone_count, &c->bone_capacity, sizeof *c->bone);
    char *name = strdup(what->name);
    if (grown)
        c->bone = grown;
    if (!grown || !name) {
        free(name);
        return no_memory(c, err);
    }
    c->bone[c->bone_count] = *what;
    c->bone[c->bone_count++].name = name;
    return MRT_OK;
}

mrt_result clip_add_pose(clip *c, const double *pose, error *err)
{
    return add_numbers(c, pose, c->bone_count, 7, "the pose of bone", &newest_frame(c)->first_pose,
                       err);
}

void clip_set_arkit(clip *c, const bool is_said[ARKIT_CHANNELS])
{
    assert(c->frame_count == 0);
    c->arkit = (clip_arkit){.shape_count = 0};
    for (uint32_t i = 0; i < ARKIT_CHANNELS; ++i) {
        c->arkit.is_said[i] = is_said[i];
        c->arkit.shape_count += is_said[i] && i < ARKIT_SHAPES;
        c->arkit.turn_count += is_said[i] && i >= ARKIT_SHAPES;
    }
}

mrt_result clip_add_arkit(clip *c, const double value[ARKIT_CHANNELS], error *err)
{
    return add_numbers(c, value, ARKIT_CHANNELS, 1, "ARKit's channel",
                       &newest_frame(c)->first_arkit, err);
}

mrt_result clip_add_anchored(clip *c, const double *vector, error *err)
{
    if (c->segment_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "frame %u: an anchored frame needs a segment",
                         c->frame_count);
    clip_segment *segment = &c->segment[c->segment_count - 1];
    size_t first;
    mrt_result result =
        add_numbers(c, vector, segment->column_count, 3, "the vector of column", &first, err);
    if (result == MRT_OK)
        result = add_frame(c, (int32_t)(c->segment_count - 1), err);
    if (result < 0)
        return result;
    newest_frame(c)->first_vector = first;
    segment->frame_count++;
    return MRT_OK;
}

mrt_result clip_add_free(clip *c, const float *position, error *err)
{
    size_t v3 = (size_t)c->mesh->vertex_count * 3;
    for (size_t i = 0; i < v3; ++i)
        if (!isfinite(position[i]))
            return error_set(err, MRT_ERR_ARGUMENT, "frame %u: vertex %zu is not finite",
                             c->frame_count, i / 3);
    mrt_result result = c->fd < 0 ? open_temporary(c, err) : MRT_OK;
    if (result == MRT_OK)
        result = write_free(c, position, err);
    if (result == MRT_OK)
        result = add_frame(c, -1, err);
    if (result == MRT_OK)
        newest_frame(c)->free_index = c->free_count++;
    return result;
}

mrt_result clip_add_controls(clip *c, const double *start_end, uint32_t count, error *err)
{
    if (c->frame_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "control vectors need a frame");
    clip_frame *frame = newest_frame(c);
    mrt_result result =
        add_numbers(c, start_end, count, 6, "the vector of control", &frame->first_control, err);
    frame->control_count = result == MRT_OK ? count : frame->control_count;
    return result;
}

mrt_result clip_add_named(clip *c, const double *value, const double *pulled, error *err)
{
    if (c->frame_count == 0 || (pulled && c->segment_count == 0))
        return error_set(err, MRT_ERR_ARGUMENT, "values need a frame, pulls a segment");
    clip_frame *frame = newest_frame(c);
    size_t first_value = NO_NUMBERS, first_pulled = NO_NUMBERS;
    uint32_t pull_count = pulled ? c->segment[c->segment_count - 1].pull_count : 0;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < c->curve_count && result == MRT_OK; ++i)
        if (isinf(value[i]))
            result = error_set(err, MRT_ERR_ARGUMENT, "frame %u: %s is not finite", c->frame_count,
                               c->curve[i].name);
    if (result == MRT_OK)
        result = append_numbers(c, value, c->curve_count, &first_value, err);
    if (result == MRT_OK)
        result = add_numbers(c, pulled, pull_count, 3, "the pull of control", &first_pulled, err);
    if (result < 0)
        return result;
    frame->first_value = first_value;
    frame->first_pulled = first_pulled;
    frame->pull_segment = pull_count > 0 ? (int32_t)(c->segment_count - 1) : -1;
    return MRT_OK;
}

mrt_result clip_add_hand(clip *c, uint32_t side, const double *joint, error *err)
{
    if (c->frame_count == 0 || side > MRT_RIGHT)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a hand belongs to a frame that was added before, and is left or right");
    return add_numbers(c, joint, MRT_JOINTS, 3, "joint of a hand,",
                       &newest_frame(c)->first_joint[side], err);
}

const mesh *clip_mesh(const clip *c)
{
    return c->mesh;
}

double clip_fps(const clip *c)
{
    return c->fps;
}

void clip_set_start(clip *c, const clip_start *start)
{
    c->start = *start;
}

const clip_start *clip_start_of(const clip *c)
{
    return &c->start;
}

uint32_t clip_frame_count(const clip *c)
{
    return c->frame_count;
}

uint32_t clip_segment_count(const clip *c)
{
    return c->segment_count;
}

const clip_segment *clip_segment_at(const clip *c, uint32_t segment)
{
    assert(segment < c->segment_count);
    return &c->segment[segment];
}

static const clip_frame *frame_at(const clip *c, uint32_t frame)
{
    assert(frame < c->frame_count);
    return &c->frame[frame];
}

int32_t clip_frame_segment(const clip *c, uint32_t frame)
{
    return frame_at(c, frame)->segment;
}

const double *clip_vector(const clip *c, uint32_t frame)
{
    return numbers_from(c, frame_at(c, frame)->first_vector);
}

const double *clip_controls(const clip *c, uint32_t frame, uint32_t *out_count)
{
    *out_count = frame_at(c, frame)->control_count;
    return *out_count ? numbers_from(c, frame_at(c, frame)->first_control) : NULL;
}

const double *clip_hand(const clip *c, uint32_t frame, uint32_t side)
{
    assert(side <= MRT_RIGHT);
    return numbers_from(c, frame_at(c, frame)->first_joint[side]);
}

mrt_result clip_read(const clip *c, uint32_t frame, float *out_position, error *err)
{
    if (frame_at(c, frame)->segment < 0)
        return read_free(c, frame, out_position, err);
    read_anchored(c, frame, out_position);
    return MRT_OK;
}

bool clip_is_named(const clip *c)
{
    bool is_named = false;
    for (uint32_t i = 0; i < c->curve_count; ++i)
        is_named = is_named || c->curve[i].at_min || c->curve[i].at_max;
    for (uint32_t i = 0; i < c->segment_count; ++i)
        is_named = is_named || c->segment[i].pull_count > 0;
    return is_named;
}

uint32_t clip_curve_count(const clip *c)
{
    return c->curve_count;
}

const clip_curve *clip_curve_at(const clip *c, uint32_t curve)
{
    assert(curve < c->curve_count);
    return &c->curve[curve];
}

const double *clip_values(const clip *c, uint32_t frame)
{
    return numbers_from(c, frame_at(c, frame)->first_value);
}

uint32_t clip_bone_count(const clip *c)
{
    return c->bone_count;
}

const clip_bone *clip_bone_at(const clip *c, uint32_t bone)
{
    assert(bone < c->bone_count);
    return &c->bone[bone];
}

const clip_arkit *clip_arkit_of(const clip *c)
{
    return &c->arkit;
}

const double *clip_arkit_values(const clip *c, uint32_t frame)
{
    return numbers_from(c, frame_at(c, frame)->first_arkit);
}

const double *clip_pose(const clip *c, uint32_t frame)
{
    return numbers_from(c, frame_at(c, frame)->first_pose);
}

double clip_curve_part(const clip_curve *curve, double value)
{
    if (value > 0.0)
        return curve->max > 0.0 ? fmin(value / curve->max, 1.0) : 0.0;
    return value < 0.0 && curve->min < 0.0 ? -fmin(value / curve->min, 1.0) : 0.0;
}

const double *clip_pulled(const clip *c, uint32_t frame, uint32_t *out_segment)
{
    const clip_frame *f = frame_at(c, frame);
    if (f->pull_segment < 0)
        return NULL;
    *out_segment = (uint32_t)f->pull_segment;
    return numbers_from(c, f->first_pulled);
}

/* Vertices per block: most named parts move only a few blocks. */
enum { BLOCK = 64 };

static bool is_still(const float *value, size_t count)
{
    uint32_t bits = 0;
    for (size_t i = 0; i < count; ++i)
        bits |= value[i] != 0.0f;
    return bits == 0;
}

/* Computes the rest shape, moved by the named part of a frame. */
static void clip_read_named(const clip *c, uint32_t frame, float *out_position)
{
    size_t vertex_count = c->mesh->vertex_count;
    const double *value = clip_values(c, frame);
    uint32_t segment_index;
    const double *pulled = clip_pulled(c, frame, &segment_index);
    memcpy(out_position, c->mesh->position, position_bytes(c));
    for (uint32_t i = 0; value && i < c->curve_count; ++i) {
        float part = (float)clip_curve_part(&c->curve[i], value[i]), size = fabsf(part);
        const float *moves = part < 0.0f ? c->curve[i].at_min : c->curve[i].at_max;
        for (size_t d = 0; size > 0.0f && moves && d < vertex_count * 3; ++d)
            out_position[d] += size * moves[d];
    }
    for (uint32_t k = 0; pulled && k < c->segment[segment_index].pull_count; ++k) {
        const float *response = c->segment[segment_index].pull[k].response;
        float x = (float)pulled[k * 3], y = (float)pulled[k * 3 + 1], z = (float)pulled[k * 3 + 2];
        for (size_t first = 0; response && first < vertex_count; first += BLOCK) {
            size_t count = vertex_count - first < BLOCK ? vertex_count - first : BLOCK;
            float *out = out_position + first * 3;
            if (is_still(response + first, count))
                continue;
            for (size_t v = 0; v < count; ++v) {
                out[v * 3] += response[first + v] * x;
                out[v * 3 + 1] += response[first + v] * y;
                out[v * 3 + 2] += response[first + v] * z;
            }
        }
    }
}

/* position := rest + position - named. Returns the largest distance of a vertex. */
static double leave_remainder(const clip *c, float *position, const float *named)
{
    const float *rest = c->mesh->position;
    float furthest = 0.0f;
    for (size_t d = 0; d < (size_t)c->mesh->vertex_count * 3; d += 3) {
        float square = 0.0f;
        for (size_t i = d; i < d + 3; ++i) {
            float left = position[i] - named[i];
            position[i] = rest[i] + left;
            square += left * left;
        }
        furthest = fmaxf(furthest, square);
    }
    return sqrt((double)furthest);
}

clip *clip_split(const clip *c, clip_remainder *out, error *err)
{
    size_t size = position_bytes(c);
    float *position = malloc(size), *named = malloc(size);
    clip *left = clip_create(c->mesh, c->fps, c->directory, err);
    mrt_result result = left ? MRT_OK : MRT_ERR_MEMORY;
    uint32_t named_count = 0;
    *out = (clip_remainder){0};
    if (result >= 0 && (!position || !named))
        result = no_memory(c, err);
    if (result >= 0)
        result = clip_begin_segment(left, c->mesh->position, NULL, NULL, 0, err);
    for (uint32_t i = 0; i < c->frame_count && result >= 0; ++i) {
        if (c->frame[i].first_value == NO_NUMBERS && c->frame[i].segment >= 0) {
            result = clip_add_anchored(left, NULL, err);
            continue;
        }
        result = clip_read(c, i, position, err);
        if (result >= 0 && c->frame[i].first_value != NO_NUMBERS) {
            clip_read_named(c, i, named);
            double furthest_mm = leave_remainder(c, position, named);
            out->furthest_mm = fmax(out->furthest_mm, furthest_mm);
            if (c->frame[i].segment < 0 && c->frame[i].pull_segment < 0)
                out->loose_mm = fmax(out->loose_mm, furthest_mm);
            out->mean_mm += furthest_mm;
            named_count += 1;
        }
        if (result >= 0)
            result = clip_add_free(left, position, err);
    }
    out->mean_mm /= named_count ? (double)named_count : 1.0;
    free(position);
    free(named);
    if (result >= 0)
        return left;
    clip_destroy(left);
    return NULL;
}
