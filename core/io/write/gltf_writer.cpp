extern "C" {
#include "io/write/components.h"
#include "io/export.h"
}

#include "io/write/gltf_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <string>
#include <vector>

namespace
{

/* One axis of a column as targets: what plays them limits a weight to 0..1, so each direction that
 * is used has its own, in units of a power of two that no weight is above. */
struct axis_targets {
    float most = 0.0f, least = 0.0f; /* of the weights, metres */
    size_t plus = 0, minus = 0;      /* among all targets; only where it is used */
    int exponent = 0;
};

/* Where the targets of a segment are among all targets. */
struct segment_targets {
    size_t base = 0; /* valid if has_base */
    bool has_base = false;
    std::vector<axis_targets> axis; /* 3 per column */
};

struct performance {
    const clip *source;
    std::vector<segment_targets> segment;
    components found{};               /* of the free frames */
    std::vector<size_t> first_target; /* of each of its windows */
    gltf_report report{};

    explicit performance(const clip *c) : source(c)
    {
    }
    performance(const performance &) = delete;
    performance &operator=(const performance &) = delete;
    ~performance()
    {
        components_finish(&found);
    }
};

float in_metres(double mm)
{
    return static_cast<float>(mm * GLTF_METRES_PER_MM);
}

/* How far each axis of each segment goes, and so what it is counted in. */
void measure_axes(performance &p)
{
    for (uint32_t i = 0; i < p.segment.size(); ++i)
        p.segment[i].axis.resize(size_t{clip_segment_at(p.source, i)->column_count} * 3);
    for (uint32_t frame = 0; frame < clip_frame_count(p.source); ++frame) {
        if (clip_frame_segment(p.source, frame) < 0)
            continue;
        const double *vector = clip_vector(p.source, frame);
        for (axis_targets &axis :
             p.segment[static_cast<size_t>(clip_frame_segment(p.source, frame))].axis) {
            float weight = in_metres(*vector++);
            axis.most = std::max(axis.most, weight);
            axis.least = std::min(axis.least, weight);
        }
    }
    for (segment_targets &at : p.segment)
        for (axis_targets &axis : at.axis)
            (void)std::frexp(std::max(axis.most, -axis.least), &axis.exponent);
}

void add_axis_targets(gltf_output &out, gltf_surface &s, axis_targets &at, const float *column,
                      size_t axis, const std::string &name)
{
    std::vector<float> offset(s.position.size());
    auto add = [&](float unit, const char *direction) {
        for (size_t v = 0; v < s.source->vertex_count; ++v)
            offset[v * 3 + axis] = unit * column[v];
        gltf_surface_target(out, s, name + direction, offset.data());
        return s.target.size() - 1;
    };
    const float unit = std::ldexp(1.0f, at.exponent);
    if (at.most > 0.0f)
        at.plus = add(unit, "+");
    if (at.least < 0.0f)
        at.minus = add(-unit, "-");
}

void add_segment_targets(gltf_output &out, gltf_surface &s, performance &p, uint32_t index)
{
    static const char axis_name[] = "xyz";
    const clip_segment *segment = clip_segment_at(p.source, index);
    segment_targets &at = p.segment[index];
    size_t vertex_count = s.source->vertex_count;
    std::string prefix = "s" + std::to_string(index + 1) + ".";
    std::vector<float> offset(vertex_count * 3);
    for (size_t i = 0; i < offset.size(); ++i) {
        offset[i] = static_cast<float>(static_cast<double>(segment->base[i]) * GLTF_METRES_PER_MM -
                                       static_cast<double>(s.position[i]));
        at.has_base = at.has_base || segment->base[i] != s.source->position[i];
    }
    at.base = s.target.size();
    if (at.has_base)
        gltf_surface_target(out, s, prefix + "base", offset.data());
    for (size_t i = 0; i < at.axis.size(); ++i)
        add_axis_targets(out, s, at.axis[i], segment->column + i / 3 * vertex_count, i % 3,
                         prefix + segment->name[i / 3] + "." + axis_name[i % 3]);
}

void add_exact_targets(gltf_output &out, gltf_surface &s, performance &p)
{
    p.segment.resize(clip_segment_count(p.source));
    measure_axes(p);
    for (uint32_t i = 0; i < p.segment.size(); ++i)
        if (clip_segment_at(p.source, i)->frame_count > 0)
            add_segment_targets(out, s, p, i);
    p.report.exact_target_count = static_cast<uint32_t>(s.target.size());
}

void add_window_targets(gltf_output &out, gltf_surface &s, performance &p, uint32_t index)
{
    const component_window &window = p.found.window[index];
    std::string prefix = p.found.window_count > 1 ? "w" + std::to_string(index + 1) + "." : "";
    std::vector<float> offset(s.position.size());
    p.first_target.push_back(s.target.size());
    if (window.base)
        gltf_surface_target(out, s, prefix + "base", window.base);
    for (uint32_t j = 0; j < window.count; ++j) {
        components_offset(offset.data(), &p.found, &window, j);
        gltf_surface_target(out, s, prefix + "component" + std::to_string(j + 1), offset.data());
    }
}

void add_component_targets(gltf_output &out, gltf_surface &s, performance &p,
                           const gltf_options &options, const export_progress *progress)
{
    components_request wanted = {s.position.data(), p.report.tolerance_mm, options.max_targets};
    error err;
    mrt_result result = components_find(&p.found, p.source, &wanted, progress, &err);
    if (result < 0)
        gltf_fail(result, "%s", err.text);
    p.report.component_count = p.found.target_count;
    p.report.window_count = p.found.window_count;
    p.report.max_error_mm = p.found.max_error_mm;
    for (uint32_t w = 0; w < p.found.window_count; ++w)
        add_window_targets(out, s, p, w);
}

/* Weights of an anchored frame: its vectors, and its committed base. */
void put_anchored_weights(const performance &p, uint32_t frame, float *weight)
{
    auto segment = static_cast<uint32_t>(clip_frame_segment(p.source, frame));
    const segment_targets &at = p.segment[segment];
    const double *vector = clip_vector(p.source, frame);
    if (at.has_base)
        weight[at.base] = 1.0f;
    for (const axis_targets &axis : at.axis) {
        float along = std::ldexp(in_metres(*vector++), -axis.exponent);
        if (along != 0.0f)
            weight[along > 0.0f ? axis.plus : axis.minus] = std::fabs(along);
    }
}

/* Weights of a window's frames: its base, and its components. */
void put_window_weights(const performance &p, uint32_t index, float *weight, size_t target_count)
{
    const component_window &window = p.found.window[index];
    for (size_t i = 0; i < window.frame_count; ++i) {
        float *at =
            weight + p.found.frame[window.first_frame + i] * target_count + p.first_target[index];
        if (window.base)
            *at++ = 1.0f;
        std::copy_n(window.weight + i * window.count, window.count, at);
    }
}

std::vector<float> all_weights(const performance &p, size_t target_count)
{
    uint32_t frame_count = clip_frame_count(p.source);
    std::vector<float> weight(frame_count * target_count);
    for (uint32_t frame = 0; frame < frame_count; ++frame)
        if (clip_frame_segment(p.source, frame) >= 0)
            put_anchored_weights(p, frame, &weight[frame * target_count]);
    for (uint32_t w = 0; w < p.found.window_count; ++w)
        put_window_weights(p, w, weight.data(), target_count);
    return weight;
}

std::vector<float> key_times(const clip *c)
{
    std::vector<float> time_s(clip_frame_count(c));
    for (size_t i = 0; i < time_s.size(); ++i) {
        time_s[i] = static_cast<float>(static_cast<double>(i) / clip_fps(c));
        if (!std::isfinite(time_s[i]) || (i > 0 && !(time_s[i] > time_s[i - 1])))
            gltf_fail(MRT_ERR_UNSUPPORTED,
                      "frame %zu at %g frames per second: glTF's float32 times "
                      "cannot tell it from the frame before",
                      i, clip_fps(c));
    }
    return time_s;
}

tinygltf::Value animation_extras(const performance &p)
{
    tinygltf::Value::Object extras;
    extras["unit"] = tinygltf::Value(std::string("m"));
    extras["fps"] = tinygltf::Value(clip_fps(p.source));
    extras["frames"] = tinygltf::Value(static_cast<int>(clip_frame_count(p.source)));
    extras["exactFrames"] =
        tinygltf::Value(static_cast<int>(clip_frame_count(p.source) - p.found.frame_count));
    extras["maxErrorMm"] = tinygltf::Value(p.report.max_error_mm);
    if (p.found.frame_count > 0)
        extras["toleranceMm"] = tinygltf::Value(p.report.tolerance_mm);
    return tinygltf::Value(std::move(extras));
}

/* When the first frame is. */
void add_start(gltf_output &out, const clip_start &start)
{
    if (start.rate_num == 0)
        return;
    tinygltf::Value::Object extras;
    extras["timecode"] = tinygltf::Value(std::string(start.timecode));
    extras["firstFrame"] = tinygltf::Value(static_cast<double>(start.frame));
    extras["rate"] = tinygltf::Value(
        tinygltf::Value::Array{tinygltf::Value(static_cast<double>(start.rate_num)),
                               tinygltf::Value(static_cast<double>(start.rate_den))});
    out.model.asset.extras = tinygltf::Value(std::move(extras));
}

/* A key per frame: each shows exactly its own shape, also where segments change. */
void add_animation(gltf_output &out, const performance &p, size_t target_count, const char *name)
{
    std::vector<float> time_s = key_times(p.source);
    gltf_output_reserve(out, time_s.size() * (target_count + 1) * sizeof(float));
    std::vector<float> weight = all_weights(p, target_count);
    gltf_output_check(weight.data(), weight.size(), "weights of the columns");
    tinygltf::AnimationSampler sampler;
    sampler.input = gltf_output_floats(out, time_s.data(), time_s.size(), 1, 0);
    sampler.output = gltf_output_floats(out, weight.data(), weight.size(), 1, 0);
    sampler.interpolation = "LINEAR";
    tinygltf::AnimationChannel channel;
    channel.sampler = 0;
    channel.target_node = 0;
    channel.target_path = "weights";
    tinygltf::Animation animation;
    animation.name = gltf_utf8(name ? name : "performance");
    animation.samplers.push_back(std::move(sampler));
    animation.channels.push_back(std::move(channel));
    animation.extras = animation_extras(p);
    out.model.animations.push_back(std::move(animation));
}

/* What was asked for, else 0.1 % of the height; never finer than float32 can show. */
double tolerance_of(const mesh *m, double wanted_mm)
{
    float low[3], high[3];
    mesh_bounds(m, low, high);
    double size[3];
    for (int axis = 0; axis < 3; ++axis)
        size[axis] = static_cast<double>(high[axis]) - static_cast<double>(low[axis]);
    double diagonal = std::sqrt(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]);
    double finest_mm = std::max(1e-6 * diagonal, 1e-6);
    if (!(wanted_mm > 0.0))
        wanted_mm = 0.001 * (size[1] > 0.0 ? size[1] : diagonal);
    return std::max(wanted_mm, finest_mm);
}

void step(const export_progress *progress, double done)
{
    if (progress && progress->step)
        progress->step(progress->data, done);
}

void write_clip(gltf_output &out, const char *path, performance &p, const gltf_options &options,
                const export_progress *progress)
{
    const mesh *m = clip_mesh(p.source);
    p.report.tolerance_mm = tolerance_of(m, options.tolerance_mm);
    gltf_surface s = gltf_surface_of(out, m);
    add_exact_targets(out, s, p);
    add_component_targets(out, s, p, options, progress);
    p.report.target_count = static_cast<uint32_t>(s.target.size());
    gltf_surface_scene(out, s);
    add_start(out, *clip_start_of(p.source));
    if (!s.target.empty())
        add_animation(out, p, s.target.size(), options.name);
    step(progress, 0.9);
    p.report.byte_count = gltf_output_write(out, path);
    step(progress, 1.0);
}

void write_mesh(gltf_output &out, const char *path, const mesh *m)
{
    gltf_surface s = gltf_surface_of(out, m);
    for (uint32_t i = 0; i < m->target_count; ++i) {
        std::vector<float> offset = gltf_in_metres(m->target[i].offset, s.position.size());
        gltf_surface_target(out, s, gltf_utf8(m->target[i].name), offset.data());
    }
    gltf_surface_scene(out, s);
    (void)gltf_output_write(out, path);
}

/* Nothing but a result leaves. */
template <typename action> mrt_result guarded(const char *path, error *err, const action &run)
{
    try {
        run();
        return MRT_OK;
    } catch (const gltf_failure &failed) {
        (void)error_set(err, failed.code, "%s", failed.what());
        if (std::strncmp(failed.what(), path, std::strlen(path)) != 0)
            error_prefix(err, path);
        return failed.code;
    } catch (const std::bad_alloc &) {
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", path);
    } catch (const std::exception &unexpected) {
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: cannot write: %s", path, unexpected.what());
    }
}

} // namespace

extern "C" mrt_result gltf_write(const char *path, const clip *c, const gltf_options *options,
                                 const export_progress *progress, gltf_report *out_report,
                                 error *err)
{
    gltf_options chosen = options ? *options : gltf_options{};
    if (!(chosen.tolerance_mm >= 0.0) || !std::isfinite(chosen.tolerance_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "%s: a tolerance of %g mm: expected 0 or more",
                         path, chosen.tolerance_mm);
    return guarded(path, err, [&] {
        gltf_output out;
        performance p(c);
        write_clip(out, path, p, chosen, progress);
        if (out_report)
            *out_report = p.report;
    });
}

extern "C" mrt_result gltf_write_mesh(const char *path, const mesh *m, error *err)
{
    return guarded(path, err, [&] {
        gltf_output out;
        write_mesh(out, path, m);
    });
}
