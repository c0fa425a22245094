#include "io/read/gltf_material.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>

extern "C" {
#include "base/srgb.h"
#include "io/read/mesh_build.h"
#include "io/read/mesh_images.h"
}

namespace
{

typedef tinygltf::Value value;

const value &extension(const tinygltf::ExtensionMap &extensions, const char *name)
{
    static const value none;
    auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

double number_or(const value &of, double otherwise)
{
    double number = of.IsNumber() ? of.GetNumberAsDouble() : otherwise;
    return std::isfinite(number) ? number : otherwise;
}

float within(double number, double low, double high)
{
    return number > low ? (number < high ? (float)number : (float)high) : (float)low;
}

/* Reads up to `count` numbers of an array; missing numbers keep their value. */
void read_numbers(const value &of, double *out, size_t count)
{
    for (size_t i = 0; of.IsArray() && i < count && i < of.ArrayLen(); ++i)
        out[i] = number_or(of.Get((int)i), out[i]);
}

/* ---- pictures ---- */

struct picture_files {
    const gltf_document &document;
    const char *directory;
    budget bytes;
};

std::vector<unsigned char> copy_of(const unsigned char *at, size_t size)
{
    return std::vector<unsigned char>(at, at + size);
}

/* Reads a file in the folder of the document, or below it. */
std::vector<unsigned char> read_file(const picture_files &from, const std::string &uri)
{
    std::string name = gltf_percent_decoded(uri);
    if (name.find('\0') != std::string::npos)
        gltf_fail(MRT_ERR_UNSUPPORTED, "only files beside the document are read");
    error failed = {""};
    file_bytes bytes;
    mrt_result result =
        file_read_below(&bytes, from.directory, name.c_str(), MESH_IMAGE_SIZE_MAX, &failed);
    if (result < 0)
        gltf_fail(result, "%s", failed.text);
    std::vector<unsigned char> out =
        copy_of(reinterpret_cast<const unsigned char *>(bytes.data), bytes.size);
    file_bytes_finish(&bytes);
    return out;
}

/* The decoder finds out the kind of picture. tinygltf refuses media types that it does not know. */
std::vector<unsigned char> read_uri(const picture_files &from, const std::string &uri)
{
    if (uri.rfind("data:", 0) != 0)
        return read_file(from, uri);
    const std::string mark = ";base64,";
    std::vector<unsigned char> out;
    std::string type;
    size_t at = uri.substr(0, 256).find(mark);
    if (at == std::string::npos || uri.size() > MESH_IMAGE_SIZE_MAX * 4 / 3 ||
        !tinygltf::DecodeDataURI(
            &out, type, "data:application/octet-stream;base64," + uri.substr(at + mark.size()), 0,
            false))
        gltf_fail(MRT_ERR_UNSUPPORTED, "its data URI has no picture in base64");
    return out;
}

std::vector<unsigned char> read_view(const picture_files &from, int index)
{
    const tinygltf::Model &model = from.document.model;
    if (index < 0 || (size_t)index >= model.bufferViews.size())
        gltf_fail(MRT_ERR_FORMAT, "its bufferView does not exist");
    const tinygltf::BufferView &view = model.bufferViews[(size_t)index];
    if (view.buffer < 0 || (size_t)view.buffer >= model.buffers.size())
        gltf_fail(MRT_ERR_FORMAT, "its buffer does not exist");
    const std::vector<unsigned char> &bytes = model.buffers[(size_t)view.buffer].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset ||
        view.byteLength > MESH_IMAGE_SIZE_MAX)
        gltf_fail(MRT_ERR_FORMAT, "its bytes are missing");
    return copy_of(bytes.data() + view.byteOffset, view.byteLength);
}

/* ---- materials ---- */

/* Returns n of TEXCOORD_n. */
template <class Info> int uv_set_of(const Info &info)
{
    return (int)gltf_whole(
        gltf_member(extension(info.extensions, "KHR_texture_transform"), "texCoord"),
        info.texCoord);
}

class material_reader
{
  public:
    material_reader(mesh &out, const gltf_document &document, const char *directory,
                    size_t file_size)
        : out_(out), document_(document),
          model_(document.model), from_{document, directory, budget_of(BUDGET_IMAGE, file_size)}
    {
    }

    mesh_material read(size_t index, bool is_used)
    {
        const tinygltf::Material &source = model_.materials[index];
        const tinygltf::PbrMetallicRoughness &rough = source.pbrMetallicRoughness;
        mesh_material m = mesh_material_grey();
        for (size_t channel = 0; channel < 4; ++channel)
            m.base_colour[channel] = within(rough.baseColorFactor.at(channel), 0, 1);
        m.roughness = within(rough.roughnessFactor, 0, 1);
        m.metallic = within(rough.metallicFactor, 0, 1);
        m.has_roughness = document_.has_roughness[index];
        m.is_single_sided = !source.doubleSided;
        m.alpha = source.alphaMode == "MASK"    ? MESH_ALPHA_MASK
                  : source.alphaMode == "BLEND" ? MESH_ALPHA_BLEND
                                                : MESH_ALPHA_OPAQUE;
        m.alpha_cutoff = within(source.alphaCutoff, 0, 1);
        if (m.alpha == MESH_ALPHA_OPAQUE)
            m.base_colour[3] = 1.0f;
        read_emission(m, source);
        read_lighting(m, source, index);
        if (is_used)
            read_textures(m, source, index);
        m.name = gltf_clean_name(source.name);
        return m;
    }

    void note_others()
    {
        if (note_count_ > NOTES_MAX)
            mesh_note(&out_, "%zu more textures of its materials are not drawn",
                      note_count_ - NOTES_MAX);
    }

  private:
    void read_emission(mesh_material &m, const tinygltf::Material &source)
    {
        double strength =
            number_or(gltf_member(extension(source.extensions, "KHR_materials_emissive_strength"),
                                  "emissiveStrength"),
                      1.0);
        for (size_t i = 0; i < 3 && i < source.emissiveFactor.size(); ++i)
            m.emission_colour[i] = within(source.emissiveFactor[i] * strength, 0, 100);
    }

    void read_lighting(mesh_material &m, const tinygltf::Material &source, size_t index)
    {
        const value &toon = extension(source.extensions, "VRMC_materials_mtoon");
        const value &old = gltf_member(extension(model_.extensions, "VRM"), "materialProperties");
        if (extension(source.extensions, "KHR_materials_unlit").IsObject())
            m.lighting = MESH_LIGHTING_NONE;
        double shade[3] = {0, 0, 0};
        if (toon.IsObject()) {
            m.lighting = MESH_LIGHTING_TOON;
            read_numbers(gltf_member(toon, "shadeColorFactor"), shade, 3);
            m.shade_shift = within(number_or(gltf_member(toon, "shadingShiftFactor"), 0), -1, 1);
            m.shade_toony = within(number_or(gltf_member(toon, "shadingToonyFactor"), 0.9), 0, 1);
        } else if (old.IsArray() && index < old.ArrayLen()) {
            const value &of = old.Get((int)index), &shader = gltf_member(of, "shader");
            if (!shader.IsString() || shader.Get<std::string>() != "VRM/MToon")
                return;
            m.lighting = MESH_LIGHTING_TOON;
            shade[0] = 0.97, shade[1] = 0.81, shade[2] = 0.86; /* default of MToon */
            read_numbers(gltf_member(gltf_member(of, "vectorProperties"), "_ShadeColor"), shade, 3);
            for (double &channel : shade)
                channel = srgb_to_linear(channel);
            const value &numbers = gltf_member(of, "floatProperties");
            read_old_toon(m, number_or(gltf_member(numbers, "_ShadeShift"), 0),
                          number_or(gltf_member(numbers, "_ShadeToony"), 0.9));
        }
        for (size_t i = 0; i < 3; ++i)
            m.shade_colour[i] = within(shade[i], 0, 1);
    }

    /* Converts the two numbers of VRM 0 to those of VRM 1, as UniVRM does. */
    static void read_old_toon(mesh_material &m, double shift, double toony)
    {
        double low = shift, high = 1.0 + (shift - 1.0) * toony;
        m.shade_toony = within((2.0 - (high - low)) * 0.5, 0, 1);
        m.shade_shift = within(-(high + low) * 0.5, -1, 1);
    }

    void read_textures(mesh_material &m, const tinygltf::Material &source, size_t index)
    {
        const tinygltf::PbrMetallicRoughness &rough = source.pbrMetallicRoughness;
        uv_set_ = gltf_material_uv_set(model_, (int)index);
        m.base = read_texture(rough.baseColorTexture, "base texture", source.name);
        m.normal = read_texture(source.normalTexture, "normal map", source.name);
        m.normal_scale = within(source.normalTexture.scale, -10, 10);
        m.surface = read_texture(rough.metallicRoughnessTexture, "texture of roughness and metal",
                                 source.name);
        m.emission = read_texture(source.emissiveTexture, "emission texture", source.name);
    }

    /* A mesh has one set of texture coordinates: a texture that uses another set is not drawn. */
    template <class Info>
    mesh_texture read_texture(const Info &info, const char *what, const std::string &material)
    {
        mesh_texture out = mesh_material_grey().base;
        if (info.index < 0)
            return out;
        if ((size_t)info.index >= model_.textures.size())
            gltf_fail(MRT_ERR_FORMAT, "a material names texture %d, but the file has %zu",
                      info.index, model_.textures.size());
        if (uv_set_of(info) != uv_set_) {
            note(material,
                 "its %s is not drawn: it uses texture coordinates %d, the other textures use %d",
                 what, uv_set_of(info), uv_set_);
            return out;
        }
        const tinygltf::Texture &texture = model_.textures[(size_t)info.index];
        uv_transform(out, extension(info.extensions, "KHR_texture_transform"));
        set_wrap(out, texture.sampler);
        out.image = image_of(texture, material);
        return out;
    }

    /* KHR_texture_transform: shift * rotation * scale. */
    static void uv_transform(mesh_texture &out, const value &transform)
    {
        double shift[2] = {0, 0}, scale[2] = {1, 1};
        read_numbers(gltf_member(transform, "offset"), shift, 2);
        read_numbers(gltf_member(transform, "scale"), scale, 2);
        double angle = number_or(gltf_member(transform, "rotation"), 0);
        double c = std::cos(angle), s = std::sin(angle);
        const double rows[6] = {c * scale[0],  s * scale[1], shift[0],
                                -s * scale[0], c * scale[1], shift[1]};
        for (size_t i = 0; i < 6; ++i)
            out.uv_transform[i] = within(rows[i], -1e6, 1e6);
    }

    void set_wrap(mesh_texture &out, int sampler) const
    {
        if (sampler < 0 || (size_t)sampler >= model_.samplers.size())
            return;
        const int wrap[2] = {model_.samplers[(size_t)sampler].wrapS,
                             model_.samplers[(size_t)sampler].wrapT};
        for (int axis = 0; axis < 2; ++axis)
            out.wrap[axis] = wrap[axis] == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE ? MESH_WRAP_CLAMP
                             : wrap[axis] == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT
                                 ? MESH_WRAP_MIRROR
                                 : MESH_WRAP_REPEAT;
    }

    /* Returns the PNG or JPEG of a texture, else its WebP. Otherwise returns the picture of an
     * extension that is refused by name. */
    uint32_t image_of(const tinygltf::Texture &texture, const std::string &material)
    {
        int64_t source = texture.source;
        for (const char *name : {"EXT_texture_webp", "KHR_texture_basisu", "EXT_texture_avif"})
            if (source < 0)
                source = gltf_whole(gltf_member(extension(texture.extensions, name), "source"), -1);
        if (source < 0 || (size_t)source >= document_.images.size()) {
            note(material, "its picture is missing");
            return 0;
        }
        auto known = known_.find((size_t)source);
        if (known == known_.end())
            known = known_.insert({(size_t)source, add_image((size_t)source)}).first;
        return known->second;
    }

    uint32_t add_image(size_t source)
    {
        const gltf_image &wanted = document_.images[source];
        bool has_file = !wanted.uri.empty() && wanted.uri.rfind("data:", 0) != 0;
        std::string name = !wanted.name.empty() ? wanted.name
                           : has_file           ? wanted.uri
                                                : "images[" + std::to_string(source) + "]";
        try {
            error failed = {""};
            uint32_t image = 0;
            if (mesh_image_room(&out_, &failed) < 0)
                gltf_fail(MRT_ERR_UNSUPPORTED, "%s", failed.text);
            std::vector<unsigned char> bytes =
                wanted.uri.empty() ? read_view(from_, wanted.view) : read_uri(from_, wanted.uri);
            mrt_result result = mesh_image_add(&out_, &image, name.c_str(), bytes.data(),
                                               bytes.size(), &from_.bytes, &failed);
            if (result == MRT_ERR_MEMORY)
                throw std::bad_alloc();
            if (result < 0)
                gltf_fail(result, "%s", failed.text);
            return image;
        } catch (const gltf_failure &failure) {
            mesh_image_note(&out_, name.c_str(), failure.what());
            return 0;
        }
    }

    /* Notes what a material has lost; only the number, once there are many notes. */
    [[gnu::format(printf, 3, 4)]] void note(const std::string &material, const char *format, ...)
    {
        char what[256];
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(what, sizeof what, format, arguments);
        va_end(arguments);
        if (note_count_++ < NOTES_MAX)
            mesh_note(&out_, "material \"%s\": %s", gltf_printable(material).c_str(), what);
    }

    static constexpr size_t NOTES_MAX = 16;
    mesh &out_;
    const gltf_document &document_;
    const tinygltf::Model &model_;
    picture_files from_;
    std::map<size_t, uint32_t> known_;
    int uv_set_ = 0; /* of the material that is read */
    size_t note_count_ = 0;
};

} // namespace

char *gltf_clean_name(const std::string &name)
{
    char *out = static_cast<char *>(calloc(MESH_BUILD_NAME_LENGTH_MAX + 1, 1));
    if (!out)
        throw std::bad_alloc();
    text_copy(out, MESH_BUILD_NAME_LENGTH_MAX + 1, text_view_of(name.data(), name.size()));
    return out;
}

int gltf_material_uv_set(const tinygltf::Model &model, int material)
{
    if (material < 0 || (size_t)material >= model.materials.size())
        return 0;
    const tinygltf::Material &m = model.materials[(size_t)material];
    const tinygltf::TextureInfo &base = m.pbrMetallicRoughness.baseColorTexture;
    const tinygltf::TextureInfo &surface = m.pbrMetallicRoughness.metallicRoughnessTexture;
    return base.index >= 0              ? uv_set_of(base)
           : m.normalTexture.index >= 0 ? uv_set_of(m.normalTexture)
           : surface.index >= 0         ? uv_set_of(surface)
                                        : uv_set_of(m.emissiveTexture);
}

void gltf_materials(mesh &out, const gltf_document &document, const std::vector<bool> &is_used,
                    bool with_default, const char *directory, size_t file_size)
{
    size_t count = document.model.materials.size();
    mesh_material grey = out.material[0];
    mesh_material *material = static_cast<mesh_material *>(calloc(count + 1, sizeof *material));
    if (!material)
        throw std::bad_alloc();
    free(out.material);
    out.material = material;
    out.material_count = (uint32_t)(count + 1);
    material[count] = grey;
    material_reader reader(out, document, directory, file_size);
    for (size_t i = 0; i < count; ++i)
        material[i] = reader.read(i, is_used[i]);
    reader.note_others();
    if (!with_default) {
        free(grey.name);
        out.material_count -= 1;
    }
}
