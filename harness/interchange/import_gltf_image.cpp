// Imports glTF images and samplers (glTF 2.0, sections 3.8 and 5.26).
#ifdef PTBENCH_HAS_TINYGLTF

#include "harness/interchange/import_gltf_image.h"

#include "harness/json_reader.h"
#include "harness/scene/texture_image.h"

namespace pt {

namespace {

// Decodes percent codes in a URI: "my%20image.png" is the file "my image.png".
std::string without_percents(const std::string& uri) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9'   ? c - '0'
               : c >= 'a' && c <= 'f' ? c - 'a' + 10
               : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                      : -1;
    };
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool is_code = uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0;
        name += is_code ? static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2])) : uri[i];
        i += is_code ? 2 : 0;
    }
    return name;
}

GltfImage no_image(const std::string& refusal) { return {.value = "", .refusal = refusal}; }

}  // namespace

// Why a glTF sampler cannot be imported; empty if it can. Mipmap filters are accepted, since a path tracer averages the
// rays of a pixel instead.
std::string GltfImages::sampler_refusal(int index) {
    if (index < 0) {
        return "";
    }
    if (static_cast<std::size_t>(index) >= model_->samplers.size()) {
        return fmt::format("a sampler from 0 to {}", static_cast<int>(model_->samplers.size()) - 1);
    }
    const tinygltf::Sampler& sampler = model_->samplers[static_cast<std::size_t>(index)];
    if (sampler.wrapS != TINYGLTF_TEXTURE_WRAP_REPEAT || sampler.wrapT != TINYGLTF_TEXTURE_WRAP_REPEAT) {
        return fmt::format("wrapS and wrapT {} of /samplers/{}: images repeat here", TINYGLTF_TEXTURE_WRAP_REPEAT,
                           index);
    }
    if (sampler.magFilter >= 0 && sampler.magFilter != TINYGLTF_TEXTURE_FILTER_LINEAR) {
        return fmt::format("magFilter {} of /samplers/{}: texels are blended here", TINYGLTF_TEXTURE_FILTER_LINEAR,
                           index);
    }
    const bool is_plain = sampler.minFilter < 0 || sampler.minFilter == TINYGLTF_TEXTURE_FILTER_LINEAR;
    if (!is_plain && noted_.insert(index).second) {
        draft_->notes().add(0, fmt::format("/samplers/{}/minFilter {} is left out: many rays meet what it makes the "
                                           "mean of",
                                           index, sampler.minFilter));
    }
    return "";
}

// The bytes of an embedded image: a data URI, or a buffer view checked to lie within its buffer (empty if it does not).
std::string GltfImages::embedded_content(const tinygltf::Image& image) const {
    if (image.bufferView < 0) {
        return {image.image.begin(), image.image.end()};  // content of a data URI, decoded by parse_gltf_model
    }
    const tinygltf::BufferView& part = model_->bufferViews[static_cast<std::size_t>(image.bufferView)];
    const std::vector<unsigned char>& data = model_->buffers[static_cast<std::size_t>(part.buffer)].data;
    if (part.byteOffset > data.size() || part.byteLength > data.size() - part.byteOffset) {
        return {};
    }
    const auto first = data.begin() + static_cast<std::ptrdiff_t>(part.byteOffset);
    return {first, first + static_cast<std::ptrdiff_t>(part.byteLength)};
}

GltfImage GltfImages::read_beside(const std::string& uri) const {
    const std::string file = draft_->path_of(without_percents(uri));
    (void)read_texture_image(file);
    return {.value = image_in_scene(draft_->name_in_scene(file)),
            .has_alpha = texture_has_alpha(read_file(file, largest_texture_file))};
}

GltfImage GltfImages::read(int index) {
    const tinygltf::Image& source = model_->images[static_cast<std::size_t>(index)];
    const std::string pointer = fmt::format("/images/{}", index);
    try {
        if (source.bufferView < 0 && source.image.empty()) {
            return read_beside(source.uri);
        }
        const std::string content = embedded_content(source);
        (void)parse_texture_image(content, pointer);
        const std::string ending = content.starts_with("\x89PNG") ? ".png" : ".jpg";
        const std::string name = draft_->keep_image(content, ending);
        draft_->notes().add(0, fmt::format("{} is written as {}", pointer, name));
        return {.value = image_in_scene(name), .has_alpha = texture_has_alpha(content)};
    } catch (const InputError& error) {
        return no_image(fmt::format("an image that can be read ({})", error.what()));
    }
}

const GltfImage& GltfImages::image(int index) {
    const auto known = known_.find(index);
    return known != known_.end() ? known->second : known_.emplace(index, read(index)).first->second;
}

GltfImage GltfImages::of_texture(int index) {
    if (static_cast<std::size_t>(index) >= model_->textures.size()) {
        return no_image(fmt::format("a texture from 0 to {}", static_cast<int>(model_->textures.size()) - 1));
    }
    const tinygltf::Texture& texture = model_->textures[static_cast<std::size_t>(index)];
    if (texture.source < 0 || static_cast<std::size_t>(texture.source) >= model_->images.size()) {
        return no_image(fmt::format("of /textures/{} a source, PNG or JPEG, from 0 to {}", index,
                                    static_cast<int>(model_->images.size()) - 1));
    }
    const std::string refusal = sampler_refusal(texture.sampler);
    return refusal.empty() ? image(texture.source) : no_image(refusal);
}

}  // namespace pt

#endif
