#include "io/write/gltf_bones.hpp"

#include <algorithm>
#include <cmath>

namespace
{

constexpr double METRES_PER_MM = 0.001;
const double NO_TURN[4] = {0.0, 0.0, 0.0, 1.0};

/* conjugate(parent) * own, w >= 0. */
void turn_from(double out[4], const double *own, const double *parent)
{
    double x = -parent[0], y = -parent[1], z = -parent[2], w = parent[3];
    out[0] = w * own[0] + x * own[3] + y * own[2] - z * own[1];
    out[1] = w * own[1] - x * own[2] + y * own[3] + z * own[0];
    out[2] = w * own[2] + x * own[1] - y * own[0] + z * own[3];
    out[3] = w * own[3] - x * own[0] - y * own[1] - z * own[2];
    if (out[3] < 0.0)
        std::for_each(out, out + 4, [](double &part) { part = -part; });
}

/* A way in the parent's frame. */
void way_from(double out[3], const double *own, const double *parent, const double *rotation)
{
    double way[3] = {own[0] - parent[0], own[1] - parent[1], own[2] - parent[2]};
    double q[3] = {-rotation[0], -rotation[1], -rotation[2]}, cross[3];
    for (int i = 0; i < 3; ++i)
        cross[i] = 2.0 * (q[(i + 1) % 3] * way[(i + 2) % 3] - q[(i + 2) % 3] * way[(i + 1) % 3]);
    for (int i = 0; i < 3; ++i)
        out[i] = way[i] + rotation[3] * cross[i] + q[(i + 1) % 3] * cross[(i + 2) % 3] -
                 q[(i + 2) % 3] * cross[(i + 1) % 3];
}

gltf_bone bone_of(const clip *c, uint32_t index)
{
    const clip_bone *bone = clip_bone_at(c, index);
    const double origin[3] = {0.0, 0.0, 0.0};
    bool has_parent = bone->parent != CLIP_NO_BONE;
    const double *from = has_parent ? clip_bone_at(c, bone->parent)->centre_mm : origin;
    gltf_bone out = {bone->name, has_parent ? bone->parent : SIZE_MAX, {}, {}, {}};
    for (int i = 0; i < 3; ++i)
        out.rest_m[i] = (bone->centre_mm[i] - from[i]) * METRES_PER_MM;
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        const double *pose = clip_pose(c, frame);
        double rotation[4] = {0.0, 0.0, 0.0, 1.0}, translation[3];
        std::transform(out.rest_m, out.rest_m + 3, translation,
                       [](double m) { return m / METRES_PER_MM; });
        if (pose) {
            const double *own = pose + size_t{index} * 7;
            const double *parent = has_parent ? pose + size_t{bone->parent} * 7 : nullptr;
            turn_from(rotation, own, parent ? parent : NO_TURN);
            way_from(translation, own + 4, parent ? parent + 4 : origin, parent ? parent : NO_TURN);
        }
        for (double part : rotation)
            out.rotation.push_back(static_cast<float>(part));
        for (double mm : translation)
            out.translation.push_back(static_cast<float>(mm * METRES_PER_MM));
    }
    return out;
}

} // namespace

std::vector<gltf_bone> gltf_bones_of(const clip *c)
{
    std::vector<gltf_bone> out;
    for (uint32_t i = 0; i < clip_bone_count(c); ++i)
        out.push_back(bone_of(c, i));
    return out;
}
