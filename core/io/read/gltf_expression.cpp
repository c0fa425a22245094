#include "io/read/gltf_expression.hpp"

#include <algorithm>
#include <cmath>

namespace
{

const size_t ROWS_MAX = 4096;

/* VRM 0's presets, and VRM 1's words for them. */
const char *const preset[][2] = {{"a", "aa"},
                                 {"i", "ih"},
                                 {"u", "ou"},
                                 {"e", "ee"},
                                 {"o", "oh"},
                                 {"joy", "happy"},
                                 {"sorrow", "sad"},
                                 {"fun", "relaxed"},
                                 {"angry", "angry"},
                                 {"surprised", "surprised"},
                                 {"blink", "blink"},
                                 {"blink_l", "blinkLeft"},
                                 {"blink_r", "blinkRight"},
                                 {"lookup", "lookUp"},
                                 {"lookdown", "lookDown"},
                                 {"lookleft", "lookLeft"},
                                 {"lookright", "lookRight"},
                                 {"neutral", "neutral"}};

std::string lower(std::string text)
{
    for (char &c : text)
        c = c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
    return text;
}

std::string text_of(const tinygltf::Value &value)
{
    return value.IsString() ? value.Get<std::string>() : "";
}

/* An expression without a preset may be called like one. */
std::string word_of(const std::string &preset_name, const std::string &name)
{
    for (const std::string &said : {lower(preset_name), lower(name)})
        for (const auto &known : preset)
            if (said == known[0] || said == lower(known[1]))
                return known[1];
    return name;
}

class collector
{
  public:
    explicit collector(const gltf_plan &plan) : plan_(plan)
    {
    }

    /* `weight`: 0..1 */
    void add(const std::string &word, int64_t mesh, int64_t index, double weight)
    {
        auto shown = plan_.meshes.find(mesh < 0 ? SIZE_MAX : (size_t)mesh);
        if (shown == plan_.meshes.end() || index < 0 ||
            (size_t)index >= shown->second.target_slots.size()) {
            out_.lost_count += 1;
            return;
        }
        if (word.empty() || !(weight > 0.0) || out_.weight.size() == ROWS_MAX)
            return;
        float &part = out_.weight[{word, shown->second.target_slots[(size_t)index]}];
        part = std::max(part, (float)std::min(weight, 1.0));
    }

    const gltf_expressions &all() const
    {
        return out_;
    }

  private:
    const gltf_plan &plan_;
    gltf_expressions out_ = {{}, 0};
};

double number_of(const tinygltf::Value &value)
{
    return value.IsNumber() ? value.GetNumberAsDouble() : 0.0;
}

/* A list of {name, presetName, binds: [{mesh, index, weight: 0..100}]}. */
void read_old(collector &to, const tinygltf::Value &vrm)
{
    const tinygltf::Value &groups =
        gltf_member(gltf_member(vrm, "blendShapeMaster"), "blendShapeGroups");
    for (size_t i = 0; groups.IsArray() && i < groups.ArrayLen(); ++i) {
        const tinygltf::Value &group = groups.Get((int)i), &binds = gltf_member(group, "binds");
        std::string word =
            word_of(text_of(gltf_member(group, "presetName")), text_of(gltf_member(group, "name")));
        for (size_t b = 0; binds.IsArray() && b < binds.ArrayLen(); ++b) {
            const tinygltf::Value &bind = binds.Get((int)b);
            to.add(word, gltf_whole(gltf_member(bind, "mesh"), -1),
                   gltf_whole(gltf_member(bind, "index"), -1),
                   number_of(gltf_member(bind, "weight")) / 100.0);
        }
    }
}

/* {preset: {NAME: {morphTargetBinds: [{node, index, weight: 0..1}]}}, custom: likewise}. */
void read_now(collector &to, const tinygltf::Value &vrm, const tinygltf::Model &model)
{
    const tinygltf::Value &expressions = gltf_member(vrm, "expressions");
    for (const char *kind : {"preset", "custom"}) {
        const tinygltf::Value &named = gltf_member(expressions, kind);
        if (!named.IsObject())
            continue;
        for (const std::string &name : named.Keys()) {
            const tinygltf::Value &binds = gltf_member(named.Get(name), "morphTargetBinds");
            for (size_t b = 0; binds.IsArray() && b < binds.ArrayLen(); ++b) {
                const tinygltf::Value &bind = binds.Get((int)b);
                int64_t node = gltf_whole(gltf_member(bind, "node"), -1);
                bool is_node = node >= 0 && (size_t)node < model.nodes.size();
                to.add(word_of("", name), is_node ? model.nodes[(size_t)node].mesh : -1,
                       gltf_whole(gltf_member(bind, "index"), -1),
                       number_of(gltf_member(bind, "weight")));
            }
        }
    }
}

} // namespace

gltf_expressions gltf_expressions_of(const tinygltf::Model &model, const gltf_plan &plan)
{
    collector out(plan);
    auto old = model.extensions.find("VRM"), now = model.extensions.find("VRMC_vrm");
    if (now != model.extensions.end())
        read_now(out, now->second, model);
    else if (old != model.extensions.end())
        read_old(out, old->second);
    return out.all();
}
