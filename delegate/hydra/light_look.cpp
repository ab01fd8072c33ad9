#include "delegate/hydra/light_look.h"

#include <algorithm>
#include <cmath>
#include <pxr/imaging/hd/light.h>
#include <pxr/usd/ar/asset.h>
#include <pxr/usd/ar/resolver.h>
#include <pxr/usd/sdf/assetPath.h>

#include "core/base/error.h"
#include "delegate/translate/look/ies_file.h"
#include "delegate/translate/look/light_picture.h"

namespace msbvh::hydra {
namespace {

using translate::message;
using translate::Severity;

constexpr std::size_t kMostProfileBytes = std::size_t(1) << 24;

class LookReader {
 public:
  LookReader(const std::string& path, LightKind kind, const LightParameter& parameter, Diagnostics& said)
      : path_(path), kind_(kind), parameter_(parameter), said_(said) {}

  void add_image(const Textures& textures, LightLook& look) const {
    const std::string file = file_of(HdLightTokens->textureFile);
    if (file.empty()) return;
    if (kind_ != LightKind::kDome && kind_ != LightKind::kRect)
      return warn("inputs:texture:file", "expected a dome or a rect; left out");
    std::optional<ImageMap> map = ImageMap::kRect;
    if (kind_ == LightKind::kDome) {
      const VtValue format = parameter_(HdLightTokens->textureFormat);
      map = translate::dome_map(format.IsHolding<TfToken>() ? format.UncheckedGet<TfToken>().GetString()
                                                            : "automatic");
      if (!map) return warn("inputs:texture:format", "not supported; lit by the plain colour");
    }
    std::optional<translate::ColourImage> image = textures.colours({.path = file, .files = {file}}, "auto");
    if (!image)
      return warn("inputs:texture:file",
                  message("found @", file, "@, which cannot be read; lit by the plain colour"));
    const translate::LightPicture picture =
        translate::light_picture(path_, *map, image->width, image->height, std::move(image->texels));
    look.image = picture.image;
    if (picture.mended > 0)
      warn("inputs:texture:file",
           message("found NaN or infinity in ", picture.mended, " texels; took 0, or 65504"));
  }

  void add_shaping(LightLook& look) const {
    if (kind_ == LightKind::kDistant || kind_ == LightKind::kDome) return;
    look.focus_tint = color(HdLightTokens->shapingFocusTint);
    const std::string file = file_of(HdLightTokens->shapingIesFile);
    if (file.empty()) return;
    try {
      const std::shared_ptr<ArAsset> asset = ArGetResolver().OpenAsset(ArResolvedPath(file));
      if (!asset || asset->GetSize() > kMostProfileBytes) throw Error("no such file, or a huge one");
      const std::shared_ptr<const char> text = asset->GetBuffer();
      look.ies.profile =
          std::make_shared<const IesProfile>(translate::parse_ies({text.get(), asset->GetSize()}));
      look.ies.angle_scale = number(HdLightTokens->shapingIesAngleScale, 0.0f);
      look.ies.normalize = flag(HdLightTokens->shapingIesNormalize, false);
    } catch (const Error& error) {
      warn("inputs:shaping:ies:file",
           message("found @", file, "@, which cannot be read (", error.what(), "); lit without it"));
    }
  }

  void add_shadow(LightLook& look) const {
    const float gamma = number(HdLightTokens->shadowFalloffGamma, 1.0f);
    const bool usable = gamma > 0.0f && std::isfinite(gamma);
    if (!usable) warn("inputs:shadow:falloffGamma", "expected a finite number above 0; took 1");
    look.shadow = {flag(HdLightTokens->shadowEnable, true), color(HdLightTokens->shadowColor),
                   number(HdLightTokens->shadowDistance, -1.0f), number(HdLightTokens->shadowFalloff, -1.0f),
                   usable ? gamma : 1.0f};
  }

 private:
  void warn(const std::string& attribute, const std::string& text) const {
    said_.push_back({Severity::kWarning, path_, attribute, text});
  }
  std::string file_of(const TfToken& name) const {
    const VtValue value = parameter_(name);
    if (!value.IsHolding<SdfAssetPath>()) return {};
    const SdfAssetPath& asset = value.UncheckedGet<SdfAssetPath>();
    return asset.GetResolvedPath().empty() ? asset.GetAssetPath() : asset.GetResolvedPath();
  }
  float number(const TfToken& name, float fallback) const {
    const VtValue value = parameter_(name);
    if (value.IsHolding<float>()) return value.UncheckedGet<float>();
    return value.IsHolding<double>() ? float(value.UncheckedGet<double>()) : fallback;
  }
  bool flag(const TfToken& name, bool fallback) const {
    const VtValue value = parameter_(name);
    return value.IsHolding<bool>() ? value.UncheckedGet<bool>() : fallback;
  }
  Vec3f color(const TfToken& name) const {
    const VtValue value = parameter_(name);
    if (!value.IsHolding<GfVec3f>()) return {};
    const GfVec3f& found = value.UncheckedGet<GfVec3f>();
    return {found[0], found[1], found[2]};
  }

  const std::string& path_;
  LightKind kind_;
  const LightParameter& parameter_;
  Diagnostics& said_;
};

}  // namespace

LightLook light_look(const std::string& path, LightKind kind, const LightParameter& parameter,
                     const Textures& textures, Diagnostics& said) {
  const LookReader reader(path, kind, parameter, said);
  LightLook look;
  reader.add_image(textures, look);
  reader.add_shaping(look);
  reader.add_shadow(look);
  return look;
}

}  // namespace msbvh::hydra
