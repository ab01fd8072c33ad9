#include "delegate/hydra/picture_writer.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <pxr/base/gf/vec2f.h>
#include <pxr/base/gf/vec3f.h>
#include <pxr/base/gf/vec4f.h>
#include <pxr/base/tf/diagnostic.h>
#include <pxr/imaging/hd/tokens.h>

#include "delegate/hydra/render_buffer.h"

namespace msbvh::hydra {

HdAovDescriptor aov_descriptor(const TfToken& name) {
  if (name == HdAovTokens->color) return {HdFormatFloat32Vec4, false, VtValue(GfVec4f(0.0f))};
  const std::optional<Aov> aov = aov_named(name.GetString());
  if (!aov) return {};
  if (form_of(*aov).is_id) return {HdFormatInt32, false, VtValue(-1)};
  if (form_of(*aov).numbers > 4) return {};  // no format of Hydra's has so many
  if (form_of(*aov).numbers == 3) return {HdFormatFloat32Vec3, false, VtValue(GfVec3f(0.0f))};
  if (form_of(*aov).numbers == 2) return {HdFormatFloat32Vec2, false, VtValue(GfVec2f(0.0f))};
  const float nothing = *aov == Aov::kDepth         ? 1.0f
                        : *aov == Aov::kCameraDepth ? std::numeric_limits<float>::infinity()
                                                    : 0.0f;
  return {HdFormatFloat32, false, VtValue(nothing)};
}

std::vector<Aov> aovs_of(const HdRenderPassAovBindingVector& bindings) {
  std::vector<Aov> aovs;
  for (const HdRenderPassAovBinding& binding : bindings) {
    const std::optional<Aov> aov = aov_named(binding.aovName.GetString());
    if (aov && form_of(*aov).numbers <= 4 && std::find(aovs.begin(), aovs.end(), *aov) == aovs.end())
      aovs.push_back(*aov);
  }
  return translate::with_depth(std::move(aovs));
}

void PictureWriter::bind(const HdRenderPassAovBindingVector& bindings, HdRenderIndex& index,
                         const GfRect2i& data_window) {
  const std::scoped_lock lock(mutex_);
  targets_.clear();
  data_window_ = data_window;
  for (const HdRenderPassAovBinding& binding : bindings) {
    HdRenderBuffer* bound = binding.renderBuffer;
    if (!bound && !binding.renderBufferId.IsEmpty())
      bound = static_cast<HdRenderBuffer*>(
          index.GetBprim(HdPrimTypeTokens->renderBuffer, binding.renderBufferId));
    auto* buffer = dynamic_cast<RenderBuffer*>(bound);
    if (!buffer) continue;
    buffer->clear(binding.clearValue);
    if (aov_descriptor(binding.aovName).format != HdFormatInvalid) {
      targets_.push_back({binding.aovName, buffer});
      continue;
    }
    buffer->set_converged(true);
    if (param_.is_news("AOV " + binding.aovName.GetString()))
      TF_WARN("AOV %s is not rendered; its buffer keeps the clear value", binding.aovName.GetText());
  }
}

void PictureWriter::unbind() {
  const std::scoped_lock lock(mutex_);
  targets_.clear();
}

void PictureWriter::forget(const RenderBuffer& buffer) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(targets_, [&](const Target& target) { return target.buffer == &buffer; });
}

void PictureWriter::give_up() {
  const std::scoped_lock lock(mutex_);
  for (const Target& target : targets_) target.buffer->set_converged(true);
}

void PictureWriter::show(const Image& picture, std::uint32_t, bool last) {
  const std::scoped_lock lock(mutex_);
  for (const Target& target : targets_) {
    RenderBuffer::Pixels pixels{picture.width, picture.height, 4, picture.rgba.data(), nullptr};
    if (target.name != HdAovTokens->color) {
      const std::optional<Aov> aov = aov_named(target.name.GetString());
      const auto found = std::find_if(picture.aovs.begin(), picture.aovs.end(),
                                      [&](const AovImage& each) { return each.aov == aov; });
      if (found == picture.aovs.end()) continue;
      pixels.channels = form_of(found->aov).numbers;
      pixels.values = found->values.data();
      pixels.ids = form_of(found->aov).is_id ? found->ids.data() : nullptr;
    }
    target.buffer->write(pixels, data_window_);
    target.buffer->set_converged(last);
  }
}

void PictureWriter::failed(const std::string& why) {
  {
    const std::scoped_lock lock(mutex_);
    failure_ = why;
  }
  give_up();
}

void PictureWriter::tell_failure() {
  std::string why;
  {
    const std::scoped_lock lock(mutex_);
    std::swap(why, failure_);
  }
  if (!why.empty() && param_.is_news(why)) TF_WARN("%s; nothing is rendered", why.c_str());
}

}  // namespace msbvh::hydra
