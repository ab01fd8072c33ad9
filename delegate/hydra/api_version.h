// What differs between the versions of OpenUSD that this delegate is built for: the one header with guards.
// Named steps of HD_API_VERSION (pxr/imaging/hd/version.h):
//
//    68  24.08  SampleFOO() take the interval; 69: geometry subsets are child prims
//    73  24.11  SampleComputedPrimvarValues() takes the interval
//    74  24.11  HdRendererPlugin::IsSupported(bool) is pure virtual (from 46 on)
//    83  25.11  IsSupported(HdRendererCreateArgs const&, std::string*) too
//    90  26.03  GetSceneIndexInputArgs() says which motion scene indices keep
//   101  26.08  it is called GetSceneIndexCreateArgs(), and its schema likewise
//   103  26.08  IsSupported() takes an HdRendererCreateArgsSchema
#pragma once

#include <pxr/imaging/hd/version.h>
#include <pxr/pxr.h>

#if HD_API_VERSION < 69
#error "hdMsbvh needs OpenUSD 24.08 or later (HD_API_VERSION 69)"
#endif

// Whether computed primvars are sampled over the shutter that we say; else over the scene delegate's own.
#define MSBVH_COMPUTES_OVER_INTERVAL (HD_API_VERSION >= 73)

// How a host asks whether the renderer can run.
#define MSBVH_SUPPORTED_BY_SCHEMA (HD_API_VERSION >= 103)
#define MSBVH_SUPPORTED_BY_ARGS (HD_API_VERSION >= 83 && HD_API_VERSION < 103)
#define MSBVH_SUPPORTED_BY_GPU (HD_API_VERSION < 103)  // deprecated from 83 on, but still called

// Whether the plugin says by itself that it wants motion.
#define MSBVH_DECLARES_MOTION (HD_API_VERSION >= 90)
#define MSBVH_HAS_CREATE_ARGS (HD_API_VERSION >= 101)

// Whether cameras say how much they brighten a picture.
#define MSBVH_CAMERAS_EXPOSE (PXR_VERSION >= 2505)

// The reader of usdz packages has moved.
#if __has_include(<pxr/usd/sdf/zipFile.h>)
#include <pxr/usd/sdf/zipFile.h>
#define MSBVH_ZIP_IN_SDF 1
#else
#include <pxr/usd/usd/zipFile.h>
#define MSBVH_ZIP_IN_SDF 0
#endif

namespace msbvh::hydra {

PXR_NAMESPACE_USING_DIRECTIVE

#if MSBVH_ZIP_IN_SDF
using ZipFile = SdfZipFile;
#else
using ZipFile = UsdZipFile;
#endif

}  // namespace msbvh::hydra
