extern "C" {
#include "io/export.h"
#include "io/write/export_stream.h"
}

#include "io/write/gltf_surface.hpp"

#include <cmath>
#include <cstring>

using nlohmann::ordered_json;

namespace
{

struct vrma {
    const clip *source;
    std::vector<gltf_bone> bone_tracks;
    gltf_output out;
    ordered_json nodes = ordered_json::array(), bones = ordered_json::object(),
                 animation = gltf_output_animation("performance"), presets = ordered_json::object(),
                 customs = ordered_json::object();
    int time = -1; /* accessor */
};

size_t add_node(vrma &to, const std::string &name, double y_m, size_t parent)
{
    size_t index = to.nodes.size();
    to.nodes.push_back({{"name", name}, {"translation", {0.0, y_m, 0.0}}});
    if (parent < index)
        to.nodes[parent]["children"].push_back(index);
    return index;
}

void add_track(vrma &to, size_t node, const char *path, const std::vector<float> &value,
               size_t width)
{
    int output = gltf_output_floats(to.out, value.data(), value.size() / width, width, 0);
    gltf_output_channel(to.animation, node, path, to.time, output);
}

uint32_t find_bone(const clip *c, const char *name)
{
    for (uint32_t i = 0; i < clip_bone_count(c); ++i)
        if (std::strcmp(clip_bone_at(c, i)->name, name) == 0)
            return i;
    return CLIP_NO_BONE;
}

/* Returns the rotations of a bone relative to its parent, or the mean rotations of two bones. */
std::vector<float> rotations_of(const vrma &from, uint32_t bone, uint32_t other)
{
    std::vector<float> out = from.bone_tracks[bone == CLIP_NO_BONE ? other : bone].rotation;
    if (bone == CLIP_NO_BONE || other == CLIP_NO_BONE)
        return out;
    for (size_t i = 0; i < out.size(); i += 4) {
        float length = 0.0f;
        for (size_t k = i; k < i + 4; ++k) {
            out[k] += from.bone_tracks[other].rotation[k];
            length += out[k] * out[k];
        }
        for (size_t k = i; k < i + 4; ++k)
            out[k] /= std::sqrt(length);
    }
    return out;
}

void add_bone(vrma &to, const char *called, const char *human, size_t node)
{
    uint32_t bone = find_bone(to.source, called);
    to.bones[human] = {{"node", node}};
    if (bone != CLIP_NO_BONE)
        add_track(to, node, "rotation", rotations_of(to, bone, CLIP_NO_BONE), 4);
}

/* Adds an expression. Its weights are the x translations of a separate node. */
void add_expression(vrma &to, ordered_json &among, const std::string &name, uint32_t channel)
{
    std::vector<float> value;
    for (uint32_t frame = 0; frame < clip_frame_count(to.source); ++frame) {
        const double *of = clip_arkit_values(to.source, frame);
        value.insert(value.end(), {of ? static_cast<float>(of[channel]) : 0.0f, 0.0f, 0.0f});
    }
    size_t node = add_node(to, name, 0.0, SIZE_MAX);
    among[name] = {{"node", node}};
    add_track(to, node, "translation", value, 3);
}

void add_expressions(vrma &to)
{
    static const struct {
        const char *arkit, *preset;
    } presets[] = {
        {"JawOpen", "aa"}, {"EyeBlinkLeft", "blinkLeft"}, {"EyeBlinkRight", "blinkRight"}};
    for (uint32_t i = 0; i < ARKIT_SHAPES; ++i) {
        if (!clip_arkit_of(to.source)->is_said[i])
            continue;
        for (const auto &preset : presets)
            if (std::strcmp(arkit_name[i], preset.arkit) == 0)
                add_expression(to, to.presets, preset.preset, i);
        add_expression(to, to.customs, arkit_name[i], i);
    }
}

void write_vrma(const char *path, const clip *c)
{
    vrma to;
    to.source = c;
    to.bone_tracks = gltf_bones_of(c);
    std::vector<float> time_s;
    for (uint32_t i = 0; i < clip_frame_count(c); ++i)
        time_s.push_back(static_cast<float>(i / clip_fps(c)));
    if (time_s.empty())
        gltf_fail(MRT_ERR_ARGUMENT, "the performance has no frames to write");
    to.time = gltf_output_floats(to.out, time_s.data(), time_s.size(), 1, 0);
    size_t hips = add_node(to, "hips", 1.0, SIZE_MAX), spine = add_node(to, "spine", 0.2, hips),
           neck = add_node(to, "neck", 0.3, spine), head = add_node(to, "head", 0.1, neck);
    to.bones["hips"] = {{"node", hips}};
    to.bones["spine"] = {{"node", spine}};
    add_bone(to, "neck", "neck", neck);
    add_bone(to, find_bone(c, "head") == CLIP_NO_BONE ? "skull" : "head", "head", head);
    if (find_bone(c, "jaw") != CLIP_NO_BONE)
        add_bone(to, "jaw", "jaw", add_node(to, "jaw", 0.0, head));
    add_expressions(to);
    ordered_json extension = {{"specVersion", "1.0"}, {"humanoid", {{"humanBones", to.bones}}}};
    if (!to.customs.empty())
        extension["expressions"] = {{"preset", to.presets}, {"custom", to.customs}};
    uint32_t left = find_bone(c, "eye.l"), right = find_bone(c, "eye.r");
    if (left != CLIP_NO_BONE || right != CLIP_NO_BONE) {
        size_t look = add_node(to, "lookAt", 0.0, SIZE_MAX);
        extension["lookAt"] = {{"node", look}, {"offsetFromHeadBone", {0.0, 0.06, 0.0}}};
        add_track(to, look, "rotation", rotations_of(to, left, right), 4);
    }
    if (to.animation["channels"].empty())
        gltf_fail(MRT_ERR_UNSUPPORTED, "this face has no bone that rotates and no expression; "
                                       "define them in a rig (marotte rig new HEAD)");
    to.out.model.asset.version = "2.0";
    to.out.model.asset.generator = "marotte " MAROTTE_VERSION;
    ordered_json document = ordered_json::parse(gltf_output_json(to.out));
    ordered_json roots = ordered_json::array({hips});
    for (size_t i = head + 1; i < to.nodes.size(); ++i)
        if (to.nodes[i]["name"] != "jaw")
            roots.push_back(i);
    document["nodes"] = to.nodes;
    document["scenes"] = ordered_json::array({{{"nodes", roots}}});
    document["scene"] = 0;
    document["animations"] = ordered_json::array({to.animation});
    document["extensionsUsed"] = {"VRMC_vrm_animation"};
    document["extensions"]["VRMC_vrm_animation"] = extension;
    (void)gltf_output_write(to.out, document.dump(), path);
}

} // namespace

extern "C" mrt_result vrma_write(const char *path, const clip *c, const export_progress *progress,
                                 error *err)
{
    return gltf_guarded(path, err, [&] {
        write_vrma(path, c);
        export_step(progress, 1.0);
    });
}
