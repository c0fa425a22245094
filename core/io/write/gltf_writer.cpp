extern "C" {
#include "io/write/clip_targets.h"
#include "io/write/components.h"
#include "io/write/export_stream.h"
}

#include "io/write/gltf_source.hpp"
#include "io/write/gltf_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <strings.h>
#include <memory>
#include <new>
#include <string>
#include <vector>

namespace
{

/* The targets of one axis of a column. Players limit a weight to 0..1, so each used direction has a
 * separate target. Its unit is a power of two that keeps all weights at most 1. */
struct axis_targets {
    float most = 0.0f, least = 0.0f; /* range of the weights, metres */
    size_t plus = 0, minus = 0;      /* index among all targets, if the direction is used */
    int exponent = 0;
};

/* Indices of the targets of a segment among all targets. */
struct segment_targets {
    size_t base = 0; /* valid if has_base */
    bool has_base = false;
    std::vector<size_t> axis; /* index in performance.axis: 3 per column, or 3 per pull if frames
                                 have a named part. Equal pulls share an index */
};

/* The targets of a curve: its used directions, and their indices among all targets. */
struct curve_targets {
    bool goes_up = false, goes_down = false;
    size_t up = 0, down = 0;
};

template <typename number> number *room_for(size_t count)
{
    auto *room = static_cast<number *>(std::calloc(count + 1, sizeof(number)));
    if (!room)
        throw std::bad_alloc();
    return room;
}

void list_target(clip_targets &to, const std::string &name, const float *offset,
                 const std::vector<float> &rotation)
{
    auto moves = [&](size_t v) {
        auto is_there = [](float x) { return x != 0.0f; };
        return std::any_of(offset + v * 3, offset + v * 3 + 3, is_there) ||
               std::any_of(&rotation[v * 3], &rotation[v * 3] + 3, is_there);
    };
    std::vector<uint32_t> moved;
    for (size_t v = 0; v * 3 < rotation.size(); ++v)
        if (moves(v))
            moved.push_back(static_cast<uint32_t>(v));
    auto *grown = static_cast<clip_target *>(
        std::realloc(to.target, (size_t{to.count} + 1) * sizeof *to.target));
    if (!grown)
        throw std::bad_alloc();
    to.target = grown;
    clip_target &added = to.target[to.count++] = clip_target{};
    added.name = room_for<char>(name.size());
    std::copy(name.begin(), name.end(), added.name);
    added.count = static_cast<uint32_t>(moved.size());
    added.vertex = room_for<uint32_t>(moved.size());
    added.offset = room_for<float>(moved.size() * 3);
    added.normal = room_for<float>(moved.size() * 3);
    std::copy(moved.begin(), moved.end(), added.vertex);
    for (size_t i = 0; i < moved.size(); ++i) {
        std::copy_n(offset + moved[i] * size_t{3}, 3, added.offset + i * 3);
        std::copy_n(&rotation[moved[i] * size_t{3}], 3, added.normal + i * 3);
    }
}

/* Hash of the content of an export, so that a program can recognise an export that it already has.
 * FNV-1a over words. */
struct content_hash {
    uint64_t value = 14695981039346656037u;

    void add(uint32_t word)
    {
        value = (value ^ word) * 1099511628211u;
        value ^= value >> 32; /* spreads the upper bits of a word */
    }
    void add(const std::string &text)
    {
        for (char letter : text)
            add(static_cast<unsigned char>(letter));
    }
    void add(const float *number, size_t count)
    {
        for (size_t i = 0; i < count; ++i) {
            uint32_t word;
            std::memcpy(&word, &number[i], sizeof word);
            add(word);
        }
    }
    std::string text() const
    {
        char out[20];
        (void)std::snprintf(out, sizeof out, "%016llx", static_cast<unsigned long long>(value));
        return out;
    }
};

/* Destination of targets: a file with the mesh alone, the source file of the mesh, or a list. */
struct target_list {
    gltf_surface surface; /* surface of the mesh */
    gltf_output bare;
    std::unique_ptr<gltf_source> source; /* NULL: none */
    clip_targets *listed = nullptr;      /* NULL: not used */
    content_hash hash;                   /* hash of all targets */
    size_t count = 0;

    explicit target_list(const mesh *m) : surface(gltf_surface_of(m))
    {
    }

    void add(const std::string &name, const float *offset)
    {
        gltf_surface_bend_normals(surface, name, offset);
        hash.add(name);
        hash.add(offset, surface.position.size());
        if (listed)
            list_target(*listed, name, offset, surface.normal_offset);
        else if (source)
            source->add_target(name, offset, surface.normal_offset.data());
        else
            gltf_surface_target(bare, surface, name, offset);
        ++count;
    }
    /* Uses the file's own target of that name. Returns false if the file has none. */
    bool add_own(const std::string &name)
    {
        if (listed || !source || !source->add_own_target(name))
            return false;
        ++count;
        return true;
    }
};

struct performance {
    const clip *source;
    clip *left = nullptr; /* remainder without the named targets; NULL: no named targets */
    std::vector<curve_targets> curve;
    std::vector<axis_targets> axis;
    size_t named_axes = 0; /* number of axes whose targets were added */
    std::vector<segment_targets> segment;
    components found{};               /* components of the free frames, or of the remainder */
    std::vector<size_t> first_target; /* first target of each window */
    gltf_report report{};

    explicit performance(const clip *c) : source(c)
    {
    }
    performance(const performance &) = delete;
    performance &operator=(const performance &) = delete;
    ~performance()
    {
        components_finish(&found);
        clip_destroy(left);
    }
    bool is_named() const
    {
        return clip_is_named(source);
    }
};

float in_metres(double mm)
{
    return static_cast<float>(mm * GLTF_METRES_PER_MM);
}

/* Minimum unit of a named pull, so that its target is the same in all performances unless a pull is
 * longer. */
constexpr int NAMED_PULL_EXPONENT = -5; /* 31.25 mm */

/* Returns the vectors of a frame for the targets of its segment; NULL: none. */
const double *vectors_of(const performance &p, uint32_t frame, uint32_t &segment)
{
    if (p.is_named())
        return clip_pulled(p.source, frame, &segment);
    int32_t index = clip_frame_segment(p.source, frame);
    segment = static_cast<uint32_t>(index);
    return index >= 0 ? clip_vector(p.source, frame) : nullptr;
}

bool is_same_pull(const clip_pull &a, const clip_pull &b, size_t vertex_count)
{
    return std::strcmp(a.name, b.name) == 0 &&
           std::memcmp(a.response, b.response, vertex_count * sizeof(float)) == 0;
}

/* Returns the axes of an equal pull in an earlier segment, so that they can be shared. Hands that
 * grip again often grip the same contacts. Searches from the latest segment. SIZE_MAX: none. */
size_t axis_before(const performance &p, uint32_t index, uint32_t pull)
{
    const clip_pull &wanted = clip_segment_at(p.source, index)->pull[pull];
    for (uint32_t i = index; i-- > 0;) {
        const clip_segment *segment = clip_segment_at(p.source, i);
        for (uint32_t k = 0; k < segment->pull_count; ++k)
            if (is_same_pull(segment->pull[k], wanted, clip_mesh(p.source)->vertex_count))
                return p.segment[i].axis[size_t{k} * 3];
    }
    return SIZE_MAX;
}

void list_axes(performance &p)
{
    p.segment.resize(clip_segment_count(p.source));
    for (uint32_t i = 0; i < p.segment.size(); ++i) {
        const clip_segment *segment = clip_segment_at(p.source, i);
        for (uint32_t k = 0; k < (p.is_named() ? segment->pull_count : segment->column_count);
             ++k) {
            size_t first = p.is_named() ? axis_before(p, i, k) : SIZE_MAX;
            if (first == SIZE_MAX) {
                first = p.axis.size();
                p.axis.resize(first + 3);
            }
            for (size_t axis = 0; axis < 3; ++axis)
                p.segment[i].axis.push_back(first + axis);
        }
    }
}

/* Finds the range and the unit of each axis, and the used directions of each curve. */
void measure(performance &p)
{
    for (uint32_t frame = 0; frame < clip_frame_count(p.source); ++frame) {
        const double *value = clip_values(p.source, frame);
        for (size_t i = 0; value && i < p.curve.size(); ++i) {
            p.curve[i].goes_up = p.curve[i].goes_up || value[i] > 0.0;
            p.curve[i].goes_down = p.curve[i].goes_down || value[i] < 0.0;
        }
        uint32_t segment;
        const double *vector = vectors_of(p, frame, segment);
        for (size_t i = 0; vector && i < p.segment[segment].axis.size(); ++i) {
            axis_targets &axis = p.axis[p.segment[segment].axis[i]];
            axis.most = std::max(axis.most, in_metres(vector[i]));
            axis.least = std::min(axis.least, in_metres(vector[i]));
        }
    }
    for (axis_targets &axis : p.axis) {
        (void)std::frexp(std::max(axis.most, -axis.least), &axis.exponent);
        if (p.is_named())
            axis.exponent = std::max(axis.exponent, NAMED_PULL_EXPONENT);
    }
}

struct axis_names {
    std::string plus, minus;
};

void add_axis_targets(target_list &to, axis_targets &at, const float *column, size_t axis,
                      const axis_names &name)
{
    std::vector<float> offset(to.surface.position.size());
    auto add = [&](float unit, const std::string &direction) {
        for (size_t v = 0; v < to.surface.source->vertex_count; ++v)
            offset[v * 3 + axis] = unit * column[v];
        to.add(direction, offset.data());
        return to.count - 1;
    };
    const float unit = std::ldexp(1.0f, at.exponent);
    if (at.most > 0.0f)
        at.plus = add(unit, name.plus);
    if (at.least < 0.0f)
        at.minus = add(-unit, name.minus);
}

void add_segment_targets(target_list &to, performance &p, uint32_t index)
{
    static const char axis_name[] = "xyz";
    const clip_segment *segment = clip_segment_at(p.source, index);
    segment_targets &at = p.segment[index];
    const gltf_surface &s = to.surface;
    size_t vertex_count = s.source->vertex_count;
    std::string prefix = "s" + std::to_string(index + 1) + ".";
    std::vector<float> offset(vertex_count * 3);
    for (size_t i = 0; i < offset.size(); ++i) {
        offset[i] = static_cast<float>(static_cast<double>(segment->base[i]) * GLTF_METRES_PER_MM -
                                       static_cast<double>(s.position[i]));
        at.has_base = at.has_base || segment->base[i] != s.source->position[i];
    }
    at.base = to.count;
    if (at.has_base)
        to.add(prefix + "base", offset.data());
    for (size_t i = 0; i < at.axis.size(); ++i) {
        std::string name = prefix + segment->name[i / 3] + "." + axis_name[i % 3];
        add_axis_targets(to, p.axis[at.axis[i]], segment->column + i / 3 * vertex_count, i % 3,
                         {name + "+", name + "-"});
    }
}

/* Returns the names of the two directions of an axis, from the view of the face. "out" is away from
 * its middle, "left" is its own left. */
axis_names direction_names(const clip_pull &pull, size_t axis, double half_width_mm)
{
    std::string name = std::string(pull.name) + " ";
    if (axis == 1)
        return {name + "up", name + "down"};
    if (axis == 2)
        return {name + "forward", name + "back"};
    if (std::fabs(pull.place_mm[0]) < 0.02 * half_width_mm)
        return {name + "left", name + "right"};
    return pull.place_mm[0] > 0.0 ? axis_names{name + "out", name + "in"}
                                  : axis_names{name + "in", name + "out"};
}

void add_pull_targets(target_list &to, performance &p, uint32_t index)
{
    const clip_segment *segment = clip_segment_at(p.source, index);
    const mesh *m = to.surface.source;
    float low[3], high[3];
    mesh_bounds(m, low, high);
    double half_width_mm = 0.5 * (static_cast<double>(high[0]) - static_cast<double>(low[0]));
    for (size_t i = 0; i < p.segment[index].axis.size(); ++i) {
        const clip_pull &pull = segment->pull[i / 3];
        if (p.segment[index].axis[i] < p.named_axes)
            continue; /* shared with an earlier segment */
        axis_names name = direction_names(pull, i % 3, half_width_mm);
        if (index > 0) {
            std::string prefix = "s" + std::to_string(index + 1) + ".";
            name = {prefix + name.plus, prefix + name.minus};
        }
        add_axis_targets(to, p.axis[p.named_axes++], pull.response, i % 3, name);
    }
}

/* Adds the targets of the curves. A curve with both directions has a target for each. */
void add_curve_targets(target_list &to, performance &p)
{
    for (uint32_t i = 0; i < p.curve.size(); ++i) {
        const clip_curve *curve = clip_curve_at(p.source, i);
        curve_targets &at = p.curve[i];
        bool is_signed = curve->min < 0.0 && curve->max > 0.0;
        std::string name = gltf_utf8(curve->name);
        auto add = [&](const float *moves, const char *way) {
            if (curve->is_own && to.add_own(name))
                return to.count - 1;
            to.add(name + (is_signed ? way : ""),
                   gltf_in_metres(moves, to.surface.position.size()).data());
            return to.count - 1;
        };
        at.goes_up = at.goes_up && curve->at_max;
        at.goes_down = at.goes_down && curve->at_min;
        if (at.goes_up)
            at.up = add(curve->at_max, " +");
        if (at.goes_down)
            at.down = add(curve->at_min, " -");
    }
}

void add_exact_targets(target_list &to, performance &p)
{
    p.curve.resize(clip_curve_count(p.source));
    list_axes(p);
    measure(p);
    add_curve_targets(to, p);
    for (uint32_t i = 0; i < p.segment.size(); ++i) {
        if (p.is_named())
            add_pull_targets(to, p, i);
        else if (clip_segment_at(p.source, i)->frame_count > 0)
            add_segment_targets(to, p, i);
    }
    p.report.exact_target_count = static_cast<uint32_t>(to.count);
}

void add_window_targets(target_list &to, performance &p, uint32_t index)
{
    const component_window &window = p.found.window[index];
    std::string prefix = p.found.window_count > 1 ? "w" + std::to_string(index + 1) + "." : "";
    prefix += p.is_named() ? "remainder" : "";
    std::vector<float> offset(to.surface.position.size());
    p.first_target.push_back(to.count);
    if (window.base)
        to.add(prefix + (p.is_named() ? " base" : "base"), window.base);
    for (uint32_t j = 0; j < window.count; ++j) {
        components_offset(offset.data(), &p.found, &window, j);
        to.add(prefix + (p.is_named() ? " " : "component") + std::to_string(j + 1), offset.data());
    }
}

/* Share of the tolerance for the remainder if it is small. A small remainder can be stored
 * precisely at low cost. */
constexpr double REMAINDER_FINENESS = 0.1;

void add_component_targets(target_list &to, performance &p, const gltf_options &options,
                           const export_progress *progress)
{
    error err;
    clip_remainder remainder;
    mrt_result result = MRT_OK;
    if (p.is_named()) {
        p.left = clip_split(p.source, &remainder, &err);
        if (!p.left)
            gltf_fail(MRT_ERR_IO, "%s", err.text);
        p.report.remainder_mm = remainder.furthest_mm;
        p.report.mean_remainder_mm = remainder.mean_mm;
        if (!(options.tolerance_mm > 0.0) && remainder.loose_mm <= p.report.tolerance_mm)
            p.report.tolerance_mm *= REMAINDER_FINENESS;
    }
    components_request wanted = {to.surface.position.data(), p.report.tolerance_mm,
                                 options.max_targets};
    result = components_find(&p.found, p.left ? p.left : p.source, &wanted, progress, &err);
    if (result < 0)
        gltf_fail(result, "%s", err.text);
    p.report.component_count = p.found.target_count;
    p.report.window_count = p.found.window_count;
    p.report.max_error_mm = p.found.max_error_mm;
    for (uint32_t w = 0; w < p.found.window_count; ++w)
        add_window_targets(to, p, w);
}

/* Writes the weights of the exact targets of a frame: the curves and pulls, or the base and vectors
 * of an anchored frame. */
void write_exact_weights(const performance &p, uint32_t frame, float *weight)
{
    const double *value = clip_values(p.source, frame);
    for (uint32_t i = 0; value && i < p.curve.size(); ++i) {
        double part = clip_curve_part(clip_curve_at(p.source, i), value[i]);
        if (part > 0.0 ? p.curve[i].goes_up : part < 0.0 && p.curve[i].goes_down)
            weight[part > 0.0 ? p.curve[i].up : p.curve[i].down] =
                static_cast<float>(std::fabs(part));
    }
    uint32_t segment;
    const double *vector = vectors_of(p, frame, segment);
    if (!vector)
        return;
    const segment_targets &at = p.segment[segment];
    if (at.has_base)
        weight[at.base] = 1.0f;
    for (size_t index : at.axis) {
        const axis_targets &axis = p.axis[index];
        float along = std::ldexp(in_metres(*vector++), -axis.exponent);
        if (along != 0.0f)
            weight[along > 0.0f ? axis.plus : axis.minus] = std::fabs(along);
    }
}

/* Writes the weights of the frames of a window: its base and its components. */
void write_window_weights(const performance &p, uint32_t index, float *weight, size_t target_count)
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
        write_exact_weights(p, frame, &weight[frame * target_count]);
    for (uint32_t w = 0; w < p.found.window_count; ++w)
        write_window_weights(p, w, weight.data(), target_count);
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
                      "cannot distinguish it from the previous frame",
                      i, clip_fps(c));
    }
    return time_s;
}

nlohmann::ordered_json start_extras(const clip_start &start)
{
    return {{"timecode", start.timecode},
            {"firstFrame", start.frame},
            {"rate", {start.rate_num, start.rate_den}}};
}

nlohmann::ordered_json animation_extras(const performance &p)
{
    nlohmann::ordered_json extras = {
        {"unit", "m"},
        {"fps", clip_fps(p.source)},
        {"frames", clip_frame_count(p.source)},
        {"exactFrames", clip_frame_count(p.source) - p.found.frame_count},
        {"maxErrorMm", p.report.max_error_mm}};
    if (p.found.frame_count > 0)
        extras["toleranceMm"] = p.report.tolerance_mm;
    if (p.is_named())
        extras["remainderMm"] = p.report.remainder_mm;
    return extras;
}

tinygltf::Value value_of(const nlohmann::ordered_json &json)
{
    if (json.is_object()) {
        tinygltf::Value::Object object;
        for (const auto &member : json.items())
            object[member.key()] = value_of(member.value());
        return tinygltf::Value(std::move(object));
    }
    if (json.is_array()) {
        tinygltf::Value::Array array;
        for (const auto &item : json)
            array.push_back(value_of(item));
        return tinygltf::Value(std::move(array));
    }
    if (json.is_string())
        return tinygltf::Value(json.get<std::string>());
    return json.is_number_integer() ? tinygltf::Value(json.get<int>())
                                    : tinygltf::Value(json.get<double>());
}

/* Adds an animation with a key per frame. Each key shows exactly the shape of its frame, also at a
 * change of segments. */
void add_animation(gltf_output &out, const std::vector<float> &time_s,
                   const std::vector<float> &weight, const std::string &name,
                   const nlohmann::ordered_json &extras)
{
    tinygltf::AnimationSampler sampler;
    sampler.input = gltf_output_floats(out, time_s.data(), time_s.size(), 1, 0);
    sampler.output = gltf_output_floats(out, weight.data(), weight.size(), 1, 0);
    sampler.interpolation = "LINEAR";
    tinygltf::AnimationChannel channel;
    channel.sampler = 0;
    channel.target_node = 0;
    channel.target_path = "weights";
    tinygltf::Animation animation;
    animation.name = name;
    animation.samplers.push_back(std::move(sampler));
    animation.channels.push_back(std::move(channel));
    animation.extras = value_of(extras);
    out.model.animations.push_back(std::move(animation));
}

/* Adds the nodes of the bones after the node of the mesh. Objects that a user parents to them move
 * with the face. */
void add_bone_nodes(gltf_output &out, const std::vector<gltf_bone> &bones)
{
    size_t first = out.model.nodes.size();
    for (const gltf_bone &bone : bones) {
        tinygltf::Node node;
        node.name = gltf_utf8(bone.name.c_str());
        node.translation.assign(bone.rest_m, bone.rest_m + 3);
        int index = static_cast<int>(out.model.nodes.size());
        if (bone.parent == SIZE_MAX)
            out.model.scenes[0].nodes.push_back(index);
        else
            out.model.nodes[first + bone.parent].children.push_back(index);
        out.model.nodes.push_back(std::move(node));
    }
}

void add_bone_channels(gltf_output &out, const std::vector<gltf_bone> &bones)
{
    tinygltf::Animation &animation = out.model.animations.back();
    size_t first = out.model.nodes.size() - bones.size();
    auto add = [&](size_t bone, const char *path, const std::vector<float> &value, size_t width) {
        tinygltf::AnimationSampler sampler;
        sampler.input = animation.samplers[0].input;
        sampler.output = gltf_output_floats(out, value.data(), value.size() / width, width, 0);
        sampler.interpolation = "LINEAR";
        tinygltf::AnimationChannel channel;
        channel.sampler = static_cast<int>(animation.samplers.size());
        channel.target_node = static_cast<int>(first + bone);
        channel.target_path = path;
        animation.samplers.push_back(std::move(sampler));
        animation.channels.push_back(std::move(channel));
    };
    for (size_t i = 0; i < bones.size(); ++i) {
        add(i, "rotation", bones[i].rotation, 4);
        add(i, "translation", bones[i].translation, 3);
    }
}

void animate(target_list &to, const performance &p, const gltf_options &options)
{
    const clip_start &start = *clip_start_of(p.source);
    if (to.count == 0)
        return;
    std::vector<float> time_s = key_times(p.source);
    gltf_output_reserve(to.bare, time_s.size() * (to.count + 1) * sizeof(float));
    std::vector<float> weight = all_weights(p, to.count);
    gltf_output_check(weight.data(), weight.size(), "weights of the columns");
    std::string name = gltf_utf8(options.name ? options.name : "performance");
    nlohmann::ordered_json extras = animation_extras(p);
    to.hash.add(time_s.data(), time_s.size());
    to.hash.add(weight.data(), weight.size());
    extras["contentHash"] = to.hash.text();
    if (start.take != 0)
        extras["take"] = {
            {"show", gltf_utf8(start.show)}, {"id", start.take}, {"slate", gltf_utf8(start.slate)}};
    if (to.source && start.rate_num > 0)
        extras.update(start_extras(start));
    if (to.source)
        to.source->animate(name, time_s, weight, extras, gltf_bones_of(p.source));
    if (to.source)
        return;
    const std::vector<gltf_bone> bones = gltf_bones_of(p.source);
    add_bone_nodes(to.bare, bones);
    add_animation(to.bare, time_s, weight, name, extras);
    add_bone_channels(to.bare, bones);
}

/* Returns the requested tolerance, or 0.1 % of the height. It is limited by the precision of
 * float32. */
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

bool ends_in(const char *path, const char *end)
{
    size_t length = std::strlen(path), wanted = std::strlen(end);
    return length >= wanted && strcasecmp(path + length - wanted, end) == 0;
}

bool is_gltf_name(const char *path)
{
    return ends_in(path, ".glb") || ends_in(path, ".gltf") || ends_in(path, ".vrm");
}

void open_source(target_list &to, gltf_report &report)
{
    const mesh *m = to.surface.source;
    if (!m->path || !is_gltf_name(m->path))
        return;
    try {
        to.source = std::make_unique<gltf_source>(m->path, m);
    } catch (const gltf_failure &failed) {
        (void)error_set(&report.why_bare, failed.code, "%s", failed.what());
    }
}

void write_clip(const char *path, performance &p, const gltf_options &options,
                const export_progress *progress)
{
    const mesh *m = clip_mesh(p.source);
    const clip_start &start = *clip_start_of(p.source);
    target_list to(m);
    p.report.tolerance_mm = tolerance_of(m, options.tolerance_mm);
    if (!options.is_bare)
        open_source(to, p.report);
    if (!to.source && ends_in(path, ".vrm"))
        gltf_fail(MRT_ERR_UNSUPPORTED, "%s: the performance cannot be added to %s: %s", path,
                  m->path ? m->path : "the face",
                  p.report.why_bare.text[0] ? p.report.why_bare.text : "it is not a .vrm file");
    if (!to.source)
        gltf_surface_begin(to.bare, to.surface);
    add_exact_targets(to, p);
    add_component_targets(to, p, options, progress);
    p.report.target_count = static_cast<uint32_t>(to.count);
    if (!to.source)
        gltf_surface_scene(to.bare, to.surface);
    if (!to.source && start.rate_num > 0)
        to.bare.model.asset.extras = value_of(start_extras(start));
    animate(to, p, options);
    export_step(progress, 0.9);
    p.report.byte_count = to.source ? to.source->write(path)
                                    : gltf_output_write(to.bare, gltf_output_json(to.bare), path);
    export_step(progress, 1.0);
}

void list_targets(clip_targets &out, performance &p, const gltf_options &options,
                  const export_progress *progress)
{
    target_list to(clip_mesh(p.source));
    to.listed = &out;
    p.report.tolerance_mm = tolerance_of(clip_mesh(p.source), options.tolerance_mm);
    add_exact_targets(to, p);
    add_component_targets(to, p, options, progress);
    p.report.target_count = out.count;
    if (to.count == 0)
        return;
    std::vector<float> weight = all_weights(p, to.count);
    gltf_output_check(weight.data(), weight.size(), "weights of the columns");
    out.weight = room_for<float>(weight.size());
    std::copy(weight.begin(), weight.end(), out.weight);
}

void write_mesh(const char *path, const mesh *m)
{
    target_list to(m);
    gltf_surface_begin(to.bare, to.surface);
    for (uint32_t i = 0; i < m->target_count; ++i)
        to.add(gltf_utf8(m->target[i].name),
               gltf_in_metres(m->target[i].offset, to.surface.position.size()).data());
    gltf_surface_scene(to.bare, to.surface);
    /* The same in every version: takes know the heads of rigs/ by the hash of the file. */
    to.bare.model.asset.generator = "marotte 0.1.0";
    (void)gltf_output_write(to.bare, gltf_output_json(to.bare), path);
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
    return gltf_guarded(path, err, [&] {
        performance p(c);
        write_clip(path, p, chosen, progress);
        if (out_report)
            *out_report = p.report;
    });
}

extern "C" mrt_result clip_targets_find(clip_targets *out, const clip *c,
                                        const gltf_options *options,
                                        const export_progress *progress, gltf_report *out_report,
                                        error *err)
{
    gltf_options chosen = options ? *options : gltf_options{};
    *out = clip_targets{};
    mrt_result result = gltf_guarded("targets", err, [&] {
        performance p(c);
        list_targets(*out, p, chosen, progress);
        if (out_report)
            *out_report = p.report;
    });
    if (result < 0)
        clip_targets_finish(out);
    return result;
}

extern "C" void clip_targets_finish(clip_targets *targets)
{
    for (uint32_t i = 0; i < targets->count; ++i) {
        std::free(targets->target[i].name);
        std::free(targets->target[i].vertex);
        std::free(targets->target[i].offset);
        std::free(targets->target[i].normal);
    }
    std::free(targets->target);
    std::free(targets->weight);
    *targets = clip_targets{};
}

extern "C" mrt_result gltf_write_mesh(const char *path, const mesh *m, error *err)
{
    return gltf_guarded(path, err, [&] { write_mesh(path, m); });
}
