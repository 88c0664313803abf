#include "denoise_contest.h"

#include <cmath>

#include "set_parameter.h"
#include "passes/splat_raster.h"
#include "techniques/denoise/worth.h"

namespace sfumato::bench {
namespace {

/// Structural similarity (Wang et al. 2004) of the luma over windows of 8 x 8 pixels at every fourth place.
double structural_similarity(const Image<vec4>& a, const Image<vec3>& b) {
  double sum = 0;
  int windows = 0;
  for (int y = 0; y + 8 <= a.height(); y += 4)
    for (int x = 0; x + 8 <= a.width(); x += 4) {
      double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
      for (int v = y; v < y + 8; ++v)
        for (int u = x; u < x + 8; ++u) {
          const double p = luma(vec3(a.at(u, v))), q = luma(b.at(u, v));
          ma += p / 64, mb += q / 64, aa += p * p / 64, bb += q * q / 64, ab += p * q / 64;
        }
      const double c1 = 1e-4, c2 = 9e-4;
      sum += (2 * ma * mb + c1) * (2 * (ab - ma * mb) + c2) /
             ((ma * ma + mb * mb + c1) * (aa - ma * ma + bb - mb * mb + c2));
      ++windows;
    }
  return windows ? sum / windows : 1;
}

std::string get(Technique& technique, const std::string& name) {
  ParamList params;
  technique.describe(params);
  return params.find(name)->resolved();
}

}  // namespace

void Errors::add(const Errors& e, double share) {
  mae += share * e.mae, rmse += share * e.rmse, missed += share * e.missed;
  psnr += share * e.psnr, ssim += share * e.ssim;
}

double luma(const vec3& linear) {
  const double y = 0.2126 * linear.r + 0.7152 * linear.g + 0.0722 * linear.b;
  return y <= 0.0031308 ? 12.92 * y : 1.055 * std::pow(y, 1 / 2.4) - 0.055;
}

double srgb(double c) {
  c = std::min(std::max(c, 0.0), 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

Errors compare(const RenderOutput& out, const synth::Truth& truth, double bin_size) {
  Errors e;
  double squares = 0, color = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < truth.depth.size(); ++i) {
    const float expected = truth.depth.data()[i], actual = out.depth.data()[i];
    if (std::isinf(expected)) continue;
    ++count;
    const double d = std::isinf(actual) ? 5 : std::min(5.0, std::abs(double(actual) - expected) / bin_size);
    e.missed += std::isinf(actual);
    e.mae += d;
    squares += d * d;
    for (int k = 0; k < 3; ++k) {
      const double c = srgb(out.color_linear.data()[i][k]) - srgb(truth.color.data()[i][k]);
      color += c * c / 3;
    }
  }
  const double n = double(std::max<std::size_t>(count, 1));
  e.mae /= n, e.missed /= n;
  e.rmse = std::sqrt(squares / n);
  e.psnr = -10 * std::log10(std::max(color / n, 1e-10));
  e.ssim = structural_similarity(out.color_linear, truth.color);
  return e;
}

Image<std::uint8_t> interior(const Image<float>& depth, double bin_size, const Image<int>& margin) {
  const int width = depth.width(), height = depth.height();
  Image<std::uint8_t> inside(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float z = depth.at(x, y);
      bool edge = std::isinf(z);
      for (auto [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}})
        if (u >= 0 && u < width && v >= 0 && v < height)
          edge = edge || !(std::abs(depth.at(u, v) - z) <= 5 * bin_size);
      if (!edge) continue;
      const int reach = margin.at(x, y);
      for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u) inside.at(u, v) = 0;
    }
  return inside;
}

TooDeep too_deep(const Image<float>& depth, const Image<float>& reference, const Image<std::uint8_t>& among,
                 double bin_size) {
  TooDeep found;
  found.where = Image<std::uint8_t>(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!among.data()[i]) continue;
    ++found.among;
    found.where.data()[i] = !(depth.data()[i] - reference.data()[i] <= 5 * bin_size);
    found.count += found.where.data()[i];
  }
  return found;
}

std::size_t TooDeep::without(const TooDeep& other) const {
  std::size_t own = 0;
  for (std::size_t i = 0; i < where.size(); ++i) own += where.data()[i] && !other.where.data()[i];
  return own;
}

Image<Rgba8> error_map(const Image<float>& depth, const Image<float>& truth, double bin_size) {
  Image<Rgba8> map(depth.width(), depth.height());
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double error = (double(depth.data()[i]) - truth.data()[i]) / (5 * bin_size);
    const auto rest = std::uint8_t(std::lround(255 * (1 - std::min(1.0, std::abs(error)))));
    if (std::isinf(truth.data()[i]))
      map.data()[i] = std::isinf(depth.data()[i]) ? Rgba8{128, 128, 128, 255} : Rgba8{255, 0, 0, 255};
    else if (std::isinf(depth.data()[i]))
      map.data()[i] = {0, 0, 0, 255};
    else
      map.data()[i] = error < 0 ? Rgba8{255, rest, rest, 255} : Rgba8{rest, rest, 255, 255};
  }
  return map;
}

Contest::Contest(gl::Context& context)
    : whole_(context),
      filtered_(context),
      splats_(find_technique("splats").create()),
      denoise_(find_technique("denoise").create()) {
  settings_.shading = Shading::albedo;
  settings_.background = vec3(0);
  wants_.color = wants_.color_linear = wants_.depth = true;
}

void Contest::take(PointCloud cloud, const Camera& camera) {
  PreparedCloud prepared = analysis::prepare(std::move(cloud), denoise_->needs(), prepare_);
  const std::vector<float>& support = prepared.support;
  std::vector<std::uint32_t> kept;
  for (std::uint32_t i = 0; i < support.size(); ++i)
    if (support[i] > denoise::least_support) kept.push_back(i);
  left_out_ = 1 - double(kept.size()) / double(std::max<std::size_t>(support.size(), 1));
  PreparedCloud rest = analysis::prepare(select(prepared.cloud, kept), denoise_->needs(), prepare_);
  rest.median_radius = prepared.median_radius, rest.median_spacing = prepared.median_spacing;
  std::vector<Rgba8> rest_colors = rest.cloud.colors, colors = prepared.cloud.colors;
  if (rest_colors.empty()) rest_colors.assign(rest.cloud.size(), {180, 180, 180, 255});
  if (colors.empty()) colors.assign(prepared.cloud.size(), {180, 180, 180, 255});
  filtered_.set_cloud(std::move(rest), std::move(rest_colors));
  whole_.set_cloud(std::move(prepared), std::move(colors));
  set(*denoise_, "bin_size", "auto");
  automatic(camera);
  bin_size_ = std::stod(get(*denoise_, "bin_size"));
}

double Contest::radius_px(const Camera& camera) {
  const PreparedCloud& prepared = whole_.prepared();
  const double depth = glm::dot(bounds(prepared.cloud).center() - camera.position, camera.direction());
  return 1.5 * prepared.median_radius * camera.pixels_per_unit() /
         (camera.orthographic() ? 1 : std::max(depth, 1e-9));
}

Image<int> Contest::rims(const Camera& camera, const Image<float>& depth) {
  const PreparedCloud& prepared = whole_.prepared();
  const int width = depth.width(), height = depth.height();
  const dmat4 eye_from_cloud = camera.view(prepared.cloud.origin);
  const Intrinsics k = camera.intrinsics();
  Image<int> margin(width, height, 1 + int(std::ceil(radius_px(camera))));
  for (std::size_t i = 0; i < prepared.cloud.size(); ++i) {
    const dvec3 eye = dvec3(eye_from_cloud * glm::dvec4(dvec3(prepared.cloud.positions[i]), 1));
    const double z = -eye.z, by = camera.orthographic() ? 1 : z;
    if (!(z > 0)) continue;
    const int x = int(std::floor(k.fx * eye.x / by + k.cx)), y = int(std::floor(-k.fy * eye.y / by + k.cy));
    if (x < 0 || x >= width || y < 0 || y >= height) continue;
    // What is hidden makes no silhouette.
    if (!(z <= depth.at(x, y) + bin_size_)) continue;
    const double limit = double(largest_disc) * prepared.median_radius;
    const double radius = 1.5 * std::min(double(prepared.cloud.radii[i]), limit) * k.fy / by;
    const int reach = 1 + int(std::ceil(radius));
    for (int v = std::max(0, y - reach); v <= std::min(height - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(width - 1, x + reach); ++u)
        margin.at(u, v) = std::max(margin.at(u, v), reach);
  }
  return margin;
}

RenderOutput Contest::splats(const Camera& camera, bool opaque, bool prefilter) {
  set(*splats_, "epsilon", std::to_string(opaque ? 1e-4 * bin_size_ : bin_size_));
  return renderer(prefilter).render(*splats_, camera, settings_, wants_);
}

RenderOutput Contest::manual(const Camera& camera, double threshold, bool prefilter, bool last_bin) {
  set(*denoise_, "bin_size", std::to_string(bin_size_));
  set(*denoise_, "weight_threshold", std::to_string(threshold));
  set(*denoise_, "miss", last_bin ? "last_bin" : "background");
  RenderOutput out = renderer(prefilter).render(*denoise_, camera, settings_, wants_);
  set(*denoise_, "miss", "background");
  set(*denoise_, "bin_size", "auto");
  return out;
}

RenderOutput Contest::automatic(const Camera& camera) {
  set(*denoise_, "weight_threshold", "auto");
  return whole_.render(*denoise_, camera, settings_, wants_);
}

void Contest::set_denoise(const std::string& name, const std::string& value) { set(*denoise_, name, value); }

}  // namespace sfumato::bench
