/* Compressed glTF (KHR_draco_mesh_compression, EXT_meshopt_compression): before anything else looks
 * at the model, what is compressed is decoded in the child process, all of it at once, and becomes
 * buffers like any other. */
#include "io/read/gltf_load.hpp"

#include <vector>

extern "C" {
#include "base/budget.h"
#include "io/decode/decode.h"
}

namespace
{

struct job_list {
    std::vector<decode_job> jobs;
    std::vector<std::string> names; /* of what each job decodes, for a person */

    job_list() = default;
    job_list(const job_list &) = delete;
    job_list &operator=(const job_list &) = delete;
    ~job_list()
    {
        for (decode_job &job : jobs)
            decode_job_finish(&job);
    }

    decode_order &add(decode_kind kind, const text_view &bytes, const std::string &name)
    {
        decode_job job = {};
        job.order.kind = kind;
        job.data = bytes.at;
        job.size = (size_t)(bytes.end - bytes.at);
        jobs.push_back(job);
        names.push_back(name);
        return jobs.back().order;
    }

    /* What is sent (it may be named many times) and what the answers take is paid out of the file's
     * budget before there is any. */
    void run(size_t file_size)
    {
        error failed = {""};
        budget all = budget_of(BUDGET_MESH, file_size);
        for (size_t i = 0; i < jobs.size(); ++i) {
            size_t size = decode_answer_size(&jobs[i].order);
            if (size == 0)
                gltf_fail(MRT_ERR_FORMAT, "%s: its compression makes no sense", names[i].c_str());
            if (budget_spend_bytes(&all, size + jobs[i].size, &failed) < 0)
                gltf_fail(MRT_ERR_UNSUPPORTED, "%s: %s", names[i].c_str(), failed.text);
        }
        mrt_result result = decode_run(jobs.data(), (uint32_t)jobs.size(), &failed);
        if (result < 0)
            gltf_fail(result, "%s", failed.text);
        for (size_t i = 0; i < jobs.size(); ++i)
            if (!jobs[i].out)
                gltf_fail(MRT_ERR_FORMAT, "%s: %s", names[i].c_str(), jobs[i].failed.text);
    }
};

/* size bytes in a buffer of the model, or a failure. */
text_view bytes_of(const tinygltf::Model &model, int buffer, size_t offset, size_t size,
                   const std::string &name)
{
    if (buffer < 0 || (size_t)buffer >= model.buffers.size())
        gltf_fail(MRT_ERR_FORMAT, "%s: its buffer is not there", name.c_str());
    const std::vector<unsigned char> &bytes = model.buffers[(size_t)buffer].data;
    if (offset > bytes.size() || size > bytes.size() - offset)
        gltf_fail(MRT_ERR_FORMAT, "%s: it goes past the end of its buffer", name.c_str());
    return text_view_of(bytes.data() + offset, size);
}

/* A buffer of its own, and a view of all of it. */
int add_view(tinygltf::Model &model, const unsigned char *at, size_t size, size_t stride)
{
    tinygltf::Buffer buffer;
    buffer.data.assign(at, at + size);
    model.buffers.push_back(std::move(buffer));
    tinygltf::BufferView view;
    view.buffer = (int)model.buffers.size() - 1;
    view.byteLength = size;
    view.byteStride = stride;
    model.bufferViews.push_back(std::move(view));
    return (int)model.bufferViews.size() - 1;
}

/* ---- meshopt ---- */

const char *const MESHOPT_NAMES[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

const tinygltf::Value *meshopt_of(const tinygltf::BufferView &view)
{
    for (const char *name : MESHOPT_NAMES) {
        auto found = view.extensions.find(name);
        if (found != view.extensions.end())
            return &found->second;
    }
    return nullptr;
}

uint32_t word_of(const tinygltf::Value &value, const char *const *words, uint32_t count)
{
    for (uint32_t i = 0; i < count && value.IsString(); ++i)
        if (value.Get<std::string>() == words[i])
            return i + 1;
    return 0;
}

void add_meshopt(job_list &out, const tinygltf::Model &model, size_t index)
{
    static const char *const modes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    static const char *const filters[] = {"OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
    std::string name = "bufferViews[" + std::to_string(index) + "]";
    const tinygltf::BufferView &view = model.bufferViews[index];
    const tinygltf::Value &how = *meshopt_of(view);
    int64_t offset = gltf_whole(gltf_member(how, "byteOffset"), 0);
    int64_t length = gltf_whole(gltf_member(how, "byteLength"), -1);
    int64_t stride = gltf_whole(gltf_member(how, "byteStride"), -1);
    int64_t count = gltf_whole(gltf_member(how, "count"), -1);
    if (offset < 0 || length <= 0 || stride <= 0 || count <= 0)
        gltf_fail(MRT_ERR_FORMAT, "%s: its compression makes no sense", name.c_str());
    text_view bytes = bytes_of(model, (int)gltf_whole(gltf_member(how, "buffer"), -1),
                               (size_t)offset, (size_t)length, name);
    decode_order &order = out.add(DECODE_MESHOPT, bytes, name);
    order.count = (uint32_t)count;
    order.stride = (uint32_t)stride;
    order.mode = word_of(gltf_member(how, "mode"), modes, 3);
    order.filter = word_of(gltf_member(how, "filter"), filters, 3);
    if (decode_answer_size(&order) != view.byteLength)
        gltf_fail(MRT_ERR_FORMAT, "%s: %zu bytes, but %lld of %lld bytes are compressed in it",
                  name.c_str(), view.byteLength, (long long)count, (long long)stride);
}

void decode_meshopt(tinygltf::Model &model, size_t file_size)
{
    job_list list;
    std::vector<size_t> views;
    for (size_t i = 0; i < model.bufferViews.size(); ++i)
        if (meshopt_of(model.bufferViews[i]))
            views.push_back(i);
    if (views.empty())
        return;
    for (size_t view : views)
        add_meshopt(list, model, view);
    list.run(file_size);
    for (size_t i = 0; i < views.size(); ++i) {
        const decode_job &job = list.jobs[i];
        size_t stride = model.bufferViews[views[i]].byteStride;
        int made =
            add_view(model, static_cast<const unsigned char *>(job.out), job.out_size, stride);
        model.bufferViews[views[i]] = model.bufferViews[(size_t)made];
        model.bufferViews.pop_back();
    }
}

/* ---- Draco ---- */

struct draco_primitive {
    tinygltf::Primitive *primitive;
    int indices;                         /* accessor */
    std::vector<std::string> attributes; /* in the order of the job's */
};

const tinygltf::Accessor &accessor_at(const tinygltf::Model &model, int index)
{
    if (index < 0 || (size_t)index >= model.accessors.size())
        gltf_fail(MRT_ERR_FORMAT, "accessor %d is used, but %zu are there", index,
                  model.accessors.size());
    return model.accessors[(size_t)index];
}

uint32_t count_of(const tinygltf::Accessor &accessor, const std::string &name)
{
    const size_t count_max = (size_t)1 << 26;
    if (accessor.count == 0 || accessor.count > count_max)
        gltf_fail(MRT_ERR_FORMAT, "%s: its counts make no sense", name.c_str());
    return (uint32_t)accessor.count;
}

void add_draco(job_list &out, std::vector<draco_primitive> &patches, const tinygltf::Model &model,
               tinygltf::Primitive &primitive, const std::string &name)
{
    const tinygltf::Value &how = primitive.extensions.at("KHR_draco_mesh_compression");
    auto position = primitive.attributes.find("POSITION");
    int indices = (int)gltf_whole(gltf_member(how, "indices"), -1); /* set aside by gltf_load */
    if (indices < 0)
        return; /* the file has it without compression as well */
    if (position == primitive.attributes.end() || primitive.mode != TINYGLTF_MODE_TRIANGLES)
        gltf_fail(MRT_ERR_UNSUPPORTED, "%s: of Draco only triangles are read", name.c_str());
    int64_t view_index = gltf_whole(gltf_member(how, "bufferView"), -1);
    if (view_index < 0 || (size_t)view_index >= model.bufferViews.size())
        gltf_fail(MRT_ERR_FORMAT, "%s: its compressed data is not there", name.c_str());
    const tinygltf::BufferView &view = model.bufferViews[(size_t)view_index];
    text_view bytes = bytes_of(model, view.buffer, view.byteOffset, view.byteLength, name);
    decode_order &order = out.add(DECODE_DRACO, bytes, name);
    order.count = count_of(accessor_at(model, position->second), name);
    order.index_count = count_of(accessor_at(model, indices), name);
    draco_primitive patch = {&primitive, indices, {}};
    for (const auto &attribute : primitive.attributes) {
        int64_t id =
            gltf_whole(gltf_member(gltf_member(how, "attributes"), attribute.first.c_str()), -1);
        const tinygltf::Accessor &accessor = accessor_at(model, attribute.second);
        if (id < 0) /* it is stored beside the compressed ones */
            continue;
        if (order.attribute_count == DECODE_ATTRIBUTES_MAX || accessor.count != order.count)
            gltf_fail(MRT_ERR_UNSUPPORTED, "%s: its compressed attributes are too many, or differ",
                      name.c_str());
        int components = tinygltf::GetNumComponentsInType((uint32_t)accessor.type);
        order.attribute[order.attribute_count++] = {(uint32_t)id, (uint32_t)accessor.componentType,
                                                    components > 0 ? (uint32_t)components : 0};
        patch.attributes.push_back(attribute.first);
    }
    patches.push_back(std::move(patch));
}

/* The same accessor on bytes of its own. */
int add_accessor(tinygltf::Model &model, int like, const unsigned char *at, size_t size)
{
    tinygltf::Accessor accessor = model.accessors[(size_t)like];
    accessor.bufferView = add_view(model, at, size, 0);
    accessor.byteOffset = 0;
    model.accessors.push_back(std::move(accessor));
    return (int)model.accessors.size() - 1;
}

void patch_draco(tinygltf::Model &model, const draco_primitive &patch, const decode_job &job)
{
    const unsigned char *at = static_cast<const unsigned char *>(job.out);
    size_t size = (size_t)job.order.index_count * sizeof(uint32_t);
    int indices = add_accessor(model, patch.indices, at, size);
    model.accessors[(size_t)indices].componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    patch.primitive->indices = indices;
    at += size;
    for (size_t i = 0; i < patch.attributes.size(); ++i) {
        decode_order alone = {};
        alone.kind = DECODE_DRACO;
        alone.count = job.order.count;
        alone.attribute_count = 1;
        alone.attribute[0] = job.order.attribute[i];
        size = decode_answer_size(&alone);
        int &accessor = patch.primitive->attributes.at(patch.attributes[i]);
        accessor = add_accessor(model, accessor, at, size);
        at += size;
    }
}

void decode_draco(tinygltf::Model &model, size_t file_size)
{
    job_list list;
    std::vector<draco_primitive> patches;
    for (size_t m = 0; m < model.meshes.size(); ++m)
        for (size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
            tinygltf::Primitive &primitive = model.meshes[m].primitives[p];
            if (primitive.extensions.count("KHR_draco_mesh_compression"))
                add_draco(list, patches, model, primitive,
                          "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) +
                              "]");
        }
    if (patches.empty())
        return;
    list.run(file_size);
    for (size_t i = 0; i < patches.size(); ++i)
        patch_draco(model, patches[i], list.jobs[i]);
}

} // namespace

void gltf_decode(tinygltf::Model &model, size_t file_size)
{
    decode_meshopt(model, file_size);
    decode_draco(model, file_size);
}
