// What every GPU benchmark shares: one context, the tori in random file order, kept until another cloud is
// asked for, and the camera of the peers' scripts; scans as the command opens and first shows them.
#pragma once

#include <benchmark/benchmark.h>

#include <filesystem>
#include <functional>
#include <string>

#include "core/camera.h"
#include "set_parameter.h"
#include "techniques/renderer.h"

namespace sfumato::bench {

/// The renderer of this process with tori of `count` points uploaded, and the attributes in `needs` computed.
/// Kept for the next benchmark of the same count.
Renderer& tori_renderer(std::size_t count, Attributes needs = {});

/// The same renderer with the cloud that `make` returns, prepared once for as long as `name` is asked for.
Renderer& cloud_renderer(const std::string& name, const std::function<PointCloud()>& make,
                         Attributes needs = {});

/// Eye (0,-3.2,2.2), looks at the origin, z up, 45 degrees; one degree of orbit a frame, as in
/// peers/peer_vtk.py.
Camera tori_camera(int frame = 0, int width = 1024, int height = 1024);

/// Where scans are: SFUMATO_TEST_DATA, or shared/data beside the checkout.
std::filesystem::path data_folder();

/// The `frame`-th of 360 cameras of a full turn.
Camera turned(const Camera& start, const dvec3& up, int frame);

/// What a benchmark renders, and from where.
struct Stage {
  Renderer& renderer;
  std::function<Camera(int frame, int width, int height)> camera;
};

/// "1000000": so many tori. Else a file of `data_folder` as the command opens and colours it, seen from its
/// first view, which turns by a degree a frame. Throws Error(io) where there is no such file.
Stage stage_of(const std::string& scene, Attributes needs = {});

/// Registers a benchmark in manual time. What it throws is the reason why it is skipped.
benchmark::internal::Benchmark* add(const std::string& name,
                                    const std::function<void(benchmark::State&)>& run);

/// Settings that only cost what is compared: white background, no eye-dome lighting unless asked for.
RenderSettings plain_settings(Shading shading = Shading::albedo, bool edl = false);

/// Makes shaders and uploads; and a GPU that has idled while a cloud was made takes some time to its full
/// clock.
void warm_up(Renderer& renderer, Technique& technique, const Camera& camera, const RenderSettings& settings);

/// Renders one frame per iteration along the orbit; reports clear to finished RGBA8 on the GPU as the time
/// (manual time), without reading back.
void time_frames(benchmark::State& state, Technique& technique, std::size_t count,
                 const RenderSettings& settings, int width = 1024, int height = 1024);
void time_frames(benchmark::State& state, Technique& technique, const std::string& scene,
                 const RenderSettings& settings, int width = 1024, int height = 1024);

}  // namespace sfumato::bench
