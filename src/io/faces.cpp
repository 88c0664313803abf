#include "io/faces.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/coloring.h"
#include "core/counted.h"
#include "io/face_normals.h"
#include "io/parallel.h"

namespace sfumato::io {
namespace {

/// A cloud is as high as a picture of so many lines when it is as long as its box's diagonal: then a point is
/// a pixel. Of 1080 lines the picture is the same, and takes twice the time.
constexpr double usual_lines = 720;
/// Of the area, on faces that are wider than a pixel: so little is no hole.
constexpr double seldom_wide = 0.01;
/// Colours of so many vertices are labels where they are few; those of fewer may be corners of a gradient.
constexpr std::size_t least_labelled = 1000;
/// Radii as of points that are measured so densely: twice the side of a point's square over root pi
/// (analysis/attributes.h).
const double radius_of_step = 2 / std::sqrt(M_PI);

/// A part of a triangle, by the shares that its corners have of those of the triangle.
struct Piece {
  std::array<dvec3, 3> shares;
  std::array<dvec3, 3> at;
};

/// Puts a sample where the area that was passed goes beyond k + 1/2, for every whole k. The longest edge is
/// cut in two (M.-C. Rivara, "Algorithms for refining triangular grids", IJNME 20, 1984), which makes slivers
/// compact, and the halves are passed so that the end of one is where the next begins, as along a curve of
/// Sierpinski: what follows each other there lies beside each other, so that samples are evenly spaced.
template <class Emit>
void sample_piece(const Piece& piece, double before, double area, int depth, const Emit& emit) {
  const auto passed = [](double sum) { return std::uint64_t(std::max(0.0, std::ceil(sum - 0.5))); };
  const std::uint64_t first = passed(before), last = passed(before + area);
  if (first == last) return;
  constexpr double small = 0.5;
  constexpr int deepest = 64;
  if (area <= small || depth == deepest) {
    for (std::uint64_t k = first; k < last; ++k)
      emit(k, (piece.shares[0] + piece.shares[1] + piece.shares[2]) / 3.0);
    return;
  }
  const auto length = [&](int a, int b) {
    const dvec3 edge = piece.at[std::size_t(a)] - piece.at[std::size_t(b)];
    return glm::dot(edge, edge);
  };
  // The curve begins at corner 0 and ends at corner 1, or at 2 when the edge to that is the longest.
  const double to_1 = length(0, 1), to_2 = length(0, 2), opposite = length(1, 2);
  const auto half = [&](std::array<int, 3> corners) {  // 3: the middle of the edge
    const auto middle = [&](const std::array<dvec3, 3>& of) {
      const int a = opposite > std::max(to_1, to_2) ? 1 : 0, b = a == 1 || to_2 > to_1 ? 2 : 1;
      return 0.5 * (of[std::size_t(a)] + of[std::size_t(b)]);
    };
    Piece result;
    for (std::size_t k = 0; k < 3; ++k) {
      const int corner = corners[k];
      result.shares[k] = corner == 3 ? middle(piece.shares) : piece.shares[std::size_t(corner)];
      result.at[k] = corner == 3 ? middle(piece.at) : piece.at[std::size_t(corner)];
    }
    return result;
  };
  std::array<int, 3> one, other;
  if (opposite > std::max(to_1, to_2))
    one = {0, 3, 1}, other = {3, 2, 0};
  else if (to_2 > to_1)
    one = {0, 1, 3}, other = {1, 2, 3};
  else
    one = {0, 2, 3}, other = {2, 1, 3};
  sample_piece(half(one), before, area / 2, depth + 1, emit);
  sample_piece(half(other), before + area / 2, area / 2, depth + 1, emit);
}

double area_of(const PointCloud& cloud, const Triangle& t) {
  const dvec3 a(cloud.positions[t[0]]);
  const double area =
      0.5 * glm::length(glm::cross(dvec3(cloud.positions[t[1]]) - a, dvec3(cloud.positions[t[2]]) - a));
  return std::isfinite(area) ? area : 0;
}

double longest_edge(const PointCloud& cloud, const Triangle& t) {
  double longest2 = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const dvec3 edge = dvec3(cloud.positions[t[k]]) - dvec3(cloud.positions[t[(k + 1) % 3]]);
    longest2 = std::max(longest2, glm::dot(edge, edge));
  }
  return std::sqrt(longest2);
}

/// The values that fields named so have at the vertices, as places in a picture.
std::optional<std::array<const ScalarField*, 2>> texture_fields(const PointCloud& cloud) {
  for (const auto& [u, v] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}, {"tu", "tv"}})
    if (cloud.scalar(u) && cloud.scalar(v)) return std::array{cloud.scalar(u), cloud.scalar(v)};
  return std::nullopt;
}

/// Of a corner of a triangle, the normal that the file has; 0 for none.
vec3 own_normal(const Faces& faces, const PointCloud& cloud, std::size_t t, std::size_t corner) {
  const std::uint32_t own = faces.normal_of.empty() ? Faces::none : faces.normal_of[t][corner];
  if (own < faces.normals.size()) return faces.normals[own];
  return cloud.normals.empty() ? vec3(0) : cloud.normals[faces.triangles[t][corner]];
}

/// Whether the file's normals say no more of its faces than directions at random: as many lie before a face
/// as behind it (shares nearer to that than to one side alone), and their cosine to the face's normal is 1/2
/// at most in the mean, by area. Some exporters number them wrongly.
bool has_random_normals(const Faces& faces, const PointCloud& cloud) {
  if (faces.normals.empty() && cloud.normals.empty()) return false;
  double all = 0, before = 0, cosines = 0;
  for (std::size_t t = 0; t < faces.triangles.size(); ++t) {
    const double area = area_of(cloud, faces.triangles[t]);
    const vec3 of_face = FaceNormals::face(cloud.positions, faces.triangles[t]);
    for (std::size_t k = 0; k < 3; ++k) {
      const vec3 own = own_normal(faces, cloud, t, k);
      if (own == vec3(0)) continue;
      const double cosine = glm::dot(glm::normalize(own), of_face);
      all += area, before += cosine > 0 ? area : 0, cosines += area * std::abs(cosine);
    }
  }
  return before > 0.25 * all && before < 0.75 * all && cosines <= 0.5 * all;
}

/// Samples of all faces: where they are and what they have.
class Samples {
 public:
  Samples(Faces faces, const PointCloud& cloud, std::vector<double> passed, std::uint64_t count)
      : faces_(std::move(faces)),
        cloud_(cloud),
        has_random_normals_(has_random_normals(faces_, cloud)),
        has_labels_(cloud.size() >= least_labelled && are_labels(cloud.colors)),
        passed_(std::move(passed)),
        count_(count),
        step_(passed_.back() / double(count)) {
    if (cloud_.normals.empty() || has_random_normals_) normals_.emplace(cloud_.positions, faces_.triangles);
    if (faces_.texture_of.empty()) fields_ = texture_fields(cloud_);
    fit_textures();
  }

  bool computes_normals() const { return has_random_normals_; }

  PointCloud take(Progress& progress) {
    PointCloud out;
    out.origin = cloud_.origin, out.up = cloud_.up, out.up_is_known = cloud_.up_is_known,
    out.provenance = cloud_.provenance, out.crs = cloud_.crs;
    out.of_faces = true;
    const std::size_t n = std::size_t(count_);
    out.positions.resize(n), out.normals.resize(n), out.radii.resize(n);
    const bool colored = !cloud_.colors.empty() || !faces_.colors.empty() || !faces_.textures.empty();
    if (colored) out.colors.resize(n);
    for (const ScalarField& field : cloud_.scalars) {
      out.scalars.push_back({field.name, field.offset, {}, field.type});
      out.scalars.back().values.resize(n);
    }
    const std::size_t threads = n < 20'000 ? 1 : thread_count(), triangles = faces_.triangles.size();
    in_parallel(threads, [&](std::size_t part) {
      // Each as many samples, not as many faces.
      const auto from = [&](std::size_t k) {
        const double sum = passed_.back() * double(k) / double(threads);
        return std::size_t(std::lower_bound(passed_.begin(), passed_.end(), sum) - passed_.begin());
      };
      const std::size_t first = part == 0 ? 0 : from(part),
                        last = part + 1 == threads ? triangles : from(part + 1);
      for (std::size_t t = first; t < last; ++t) {
        if (t % 4096 == 0) progress.check();
        sample(t, out);
      }
    });
    leave_out_transparent(out);
    return out;
  }

 private:
  void sample(std::size_t t, PointCloud& out) const {
    const Triangle& corners = faces_.triangles[t];
    const double before = passed_[t] / step_, area = (passed_[t + 1] - passed_[t]) / step_;
    if (!(area > 0)) return;
    Piece whole;
    for (std::size_t k = 0; k < 3; ++k) {
      whole.shares[k] = dvec3(k == 0, k == 1, k == 2);
      whole.at[k] = dvec3(cloud_.positions[corners[k]]);
    }
    bool is_known = false;
    std::array<vec3, 3> normals;
    float radius = 0;
    sample_piece(whole, before, area, 0, [&](std::uint64_t k, const dvec3& shares) {
      if (k >= count_) return;
      if (!is_known) normals = corner_normals(t), radius = radius_in(corners), is_known = true;
      const std::size_t i = std::size_t(k);
      out.radii[i] = radius;
      out.positions[i] = vec3(whole.at[0] * shares.x + whole.at[1] * shares.y + whole.at[2] * shares.z);
      const vec3 share(shares), normal = normals[0] * share.x + normals[1] * share.y + normals[2] * share.z;
      const float length = glm::length(normal);
      out.normals[i] = length > 1e-6f ? normal / length : vec3(0);
      const std::size_t nearest =
          share.x >= share.y ? (share.x >= share.z ? 0 : 2) : (share.y >= share.z ? 1 : 2);
      if (!out.colors.empty()) out.colors[i] = color(t, share, nearest);
      for (std::size_t f = 0; f < out.scalars.size(); ++f)
        out.scalars[f].values[i] = value(cloud_.scalars[f], corners, share, nearest);
    });
  }

  /// Two triangles that are smaller than a step are a square of half their longest edge squared.
  float radius_in(const Triangle& corners) const {
    const double edge = longest_edge(cloud_, corners);
    return float(radius_of_step * std::sqrt(std::min(step_, 0.5 * edge * edge)));
  }

  std::array<vec3, 3> corner_normals(std::size_t t) const {
    std::array<vec3, 3> normals{};
    bool are_all = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!has_random_normals_) normals[k] = own_normal(faces_, cloud_, t, k);
      are_all = are_all && normals[k] != vec3(0);
    }
    if (are_all) return normals;
    if (normals_) return normals_->corners(t);
    const vec3 of_face = FaceNormals::face(cloud_.positions, faces_.triangles[t]);
    return {of_face, of_face, of_face};
  }

  static float value(const ScalarField& field, const Triangle& corners, const vec3& share,
                     std::size_t nearest) {
    const bool is_continuous = field.type == StoredType::float32 || field.type == StoredType::float64;
    const float mixed = field.values[corners[0]] * share.x + field.values[corners[1]] * share.y +
                        field.values[corners[2]] * share.z;
    return is_continuous && std::isfinite(mixed) ? mixed : field.values[corners[nearest]];
  }

  Rgba8 color(std::size_t t, const vec3& share, std::size_t nearest) const {
    if (const Texture* texture = texture_of(t))
      if (const std::optional<vec2> place = texture_place(t, share)) return texture->at(*place);
    if (!cloud_.colors.empty()) {
      const Triangle& corners = faces_.triangles[t];
      vec4 sum(0);
      for (std::size_t k = 0; k < 3; ++k) {
        const Rgba8& c = cloud_.colors[corners[k]];
        if (c.a == 0 || has_labels_) return cloud_.colors[corners[nearest]];
        sum += share[int(k)] * vec4(c.r, c.g, c.b, c.a);
      }
      const auto byte = [](float v) { return std::uint8_t(std::clamp(v + 0.5f, 0.0f, 255.0f)); };
      return {byte(sum.x), byte(sum.y), byte(sum.z), byte(sum.w)};
    }
    return faces_.colors.empty() ? no_color : faces_.colors[t];
  }

  const Texture* texture_of(std::size_t t) const {
    if (faces_.textures.empty()) return nullptr;
    const std::uint32_t no = faces_.texture_no.empty() ? 0 : faces_.texture_no[t];
    return no < faces_.textures.size() ? &faces_.textures[no] : nullptr;
  }

  std::optional<std::array<vec2, 3>> texture_corners(std::size_t t) const {
    std::array<vec2, 3> places;
    for (std::size_t k = 0; k < 3; ++k) {
      if (fields_) {
        const std::uint32_t vertex = faces_.triangles[t][k];
        places[k] = vec2((*fields_)[0]->value(vertex), (*fields_)[1]->value(vertex));
        continue;
      }
      const std::uint32_t own = faces_.texture_of.empty() ? Faces::none : faces_.texture_of[t][k];
      if (own >= faces_.texture_places.size()) return std::nullopt;
      places[k] = faces_.texture_places[own];
    }
    return places;
  }

  std::optional<vec2> texture_place(std::size_t t, const vec3& share) const {
    const std::optional<std::array<vec2, 3>> corners = texture_corners(t);
    if (!corners) return std::nullopt;
    return (*corners)[0] * share.x + (*corners)[1] * share.y + (*corners)[2] * share.z;
  }

  /// A sample takes the mean colour of as many pixels as it stands for.
  void fit_textures() {
    std::vector<double> pixels(faces_.textures.size(), 0), samples = pixels;
    for (std::size_t t = 0; t < faces_.triangles.size() && !pixels.empty(); ++t) {
      const Texture* texture = texture_of(t);
      const std::optional<std::array<vec2, 3>> corners = texture ? texture_corners(t) : std::nullopt;
      if (!corners) continue;
      const vec2 a = (*corners)[1] - (*corners)[0], b = (*corners)[2] - (*corners)[0];
      const std::size_t no = std::size_t(texture - faces_.textures.data());
      const double area =
          0.5 * std::abs(double(a.x) * b.y - double(a.y) * b.x) * texture->width * texture->height;
      if (!std::isfinite(area)) continue;
      pixels[no] += area, samples[no] += (passed_[t + 1] - passed_[t]) / step_;
    }
    for (std::size_t no = 0; no < pixels.size(); ++no)
      for (Texture& texture = faces_.textures[no];
           pixels[no] > 2 * samples[no] && std::max(texture.width, texture.height) > 1; pixels[no] /= 4)
        texture.halve();
  }

  /// Leaves are cut out of squares by pictures that are transparent around them.
  void leave_out_transparent(PointCloud& out) const {
    constexpr std::uint8_t half = 128;
    if (faces_.textures.empty()) return;
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < out.size(); ++i)
      if (out.colors[i].a >= half || out.colors[i] == no_color) kept.push_back(std::uint32_t(i));
    if (kept.size() < out.size() && !kept.empty()) out = select(out, kept), out.source_index.clear();
    for (Rgba8& c : out.colors)
      if (c != no_color) c.a = 255;
  }

  Faces faces_;
  const PointCloud& cloud_;
  bool has_random_normals_, has_labels_;
  std::vector<double> passed_;  ///< area of the triangles before each
  std::uint64_t count_ = 0;
  double step_ = 0;  ///< area of a sample
  std::optional<FaceNormals> normals_;
  std::optional<std::array<const ScalarField*, 2>> fields_;
};

/// Vertices that no face uses.
std::vector<std::uint32_t> loose_vertices(const Faces& faces, std::size_t vertices) {
  std::vector<bool> used(vertices, false);
  for (const Triangle& triangle : faces.triangles)
    for (const std::uint32_t vertex : triangle) used[vertex] = true;
  std::vector<std::uint32_t> loose;
  for (std::size_t i = 0; i < vertices; ++i)
    if (!used[i]) loose.push_back(std::uint32_t(i));
  return loose;
}

/// The sum of the areas before each, of which one that is not 0 counts for `least` at least.
std::vector<double> sums_before(const std::vector<double>& areas, double least) {
  std::vector<double> before{0};
  before.reserve(areas.size() + 1);
  for (const double area : areas) before.push_back(before.back() + (area > 0 ? std::max(area, least) : 0));
  return before;
}

/// How many samples; 0 where the vertices are as dense as those would be.
std::uint64_t wanted_samples(const Faces& faces, const PointCloud& cloud, double area) {
  const double pixel = robust_bounds(cloud).diagonal() / usual_lines;
  const double wanted = pixel > 0 ? area / (pixel * pixel) : 0;
  if (wanted <= double(cloud.size())) {
    double wide = 0;
    for (const Triangle& triangle : faces.triangles)
      if (longest_edge(cloud, triangle) > pixel) wide += area_of(cloud, triangle);
    if (wide <= seldom_wide * area) return 0;
  }
  return std::uint64_t(
      std::clamp(wanted, double(std::min<std::uint64_t>(cloud.size(), most_samples)), double(most_samples)));
}

}  // namespace

FaceBuilder::FaceBuilder(const PointCloud& cloud, std::vector<std::int64_t> vertex_of)
    : cloud_(cloud), vertex_of_(std::move(vertex_of)) {}

void FaceBuilder::forget_one_color() {
  std::vector<Rgba8>& colors = faces.colors;
  if (std::adjacent_find(colors.begin(), colors.end(), std::not_equal_to<>()) == colors.end()) colors.clear();
}

std::size_t FaceBuilder::start_of(const std::vector<std::int64_t>& vertices) const {
  constexpr std::size_t most_corners = 64;  // each start looks at every corner
  const std::size_t n = vertices.size();
  if (n < 4 || n > most_corners) return 0;
  const auto at = [&](std::size_t k) { return dvec3(cloud_.positions[std::size_t(vertices[k % n])]); };
  dvec3 normal(0);  // of the polygon (Newell)
  for (std::size_t k = 0; k < n; ++k) normal += glm::cross(at(k), at(k + 1));
  for (std::size_t start = 0; start < n; ++start) {
    bool turns_alike = true;
    for (std::size_t k = 1; k + 1 < n && turns_alike; ++k)
      turns_alike =
          glm::dot(normal, glm::cross(at(start + k) - at(start), at(start + k + 1) - at(start))) >= 0;
    if (turns_alike) return start;
  }
  return 0;
}

bool FaceBuilder::add_fan(const Polygon& polygon) {
  std::vector<std::int64_t> vertices;
  bool are_all_kept = true;
  for (const std::int64_t corner : polygon.vertices) {
    if (corner < 0 || corner >= std::int64_t(vertex_of_.size())) return false;
    vertices.push_back(vertex_of_[std::size_t(corner)]);
    are_all_kept = are_all_kept && vertices.back() >= 0;
  }
  const std::size_t n = vertices.size(), start = are_all_kept ? start_of(vertices) : 0;
  const auto place = [](const std::vector<std::int64_t>& places, std::size_t k) {
    return k < places.size() && places[k] >= 0 && places[k] < Faces::none ? std::uint32_t(places[k])
                                                                          : Faces::none;
  };
  for (std::size_t i = 2; i < n; ++i) {
    const std::size_t corners[3] = {start, (start + i - 1) % n, (start + i) % n};
    Triangle triangle, normals, textures;
    bool is_there = true;
    for (std::size_t k = 0; k < 3; ++k) {
      is_there = is_there && vertices[corners[k]] >= 0;
      triangle[k] = std::uint32_t(vertices[corners[k]]);
      normals[k] = place(polygon.normals, corners[k]), textures[k] = place(polygon.textures, corners[k]);
    }
    if (!is_there) continue;
    faces.triangles.push_back(triangle);
    // Filled up from the first polygon on that has some.
    const auto keep = [&](std::vector<Triangle>& of, const Triangle& value, bool any) {
      if (!any && of.empty()) return;
      of.resize(faces.triangles.size() - 1, {Faces::none, Faces::none, Faces::none});
      of.push_back(value);
    };
    keep(faces.normal_of, normals, !polygon.normals.empty());
    keep(faces.texture_of, textures, !polygon.textures.empty());
  }
  return true;
}

std::vector<std::int64_t> kept_vertices(const PointCloud& cloud, std::uint64_t records) {
  std::vector<std::int64_t> vertex_of(std::size_t(records), -1);
  for (std::size_t i = 0; i < cloud.grid_index.size(); ++i) vertex_of[cloud.grid_index[i]] = std::int64_t(i);
  return vertex_of;
}

std::string vertices_alone(const File& file, const Error& error) {
  std::string text = error.what();
  const std::string place = file.path().string() + ": ";
  if (text.starts_with(place)) text.erase(0, place.size());
  return text + "; drawn without its faces";
}

void sample_faces(Faces faces, ReadResult& result, Progress& progress) {
  ReadReport& report = result.report;
  if (faces.bad > 0)
    report.notes.push_back(counted(faces.bad, "face") + (faces.bad == 1 ? " has" : " have") +
                           " a corner that is no vertex (" + faces.first_bad + "): left out");
  std::vector<double> areas;
  for (const Triangle& triangle : faces.triangles) areas.push_back(area_of(result.cloud, triangle));
  std::vector<double> passed = sums_before(areas, 0);
  const double area = passed.back();
  std::uint64_t count = area > 0 && std::isfinite(area) ? wanted_samples(faces, result.cloud, area) : 0;
  if (count == 0) return;
  progress.check();
  // As fine as the faces are: depth pictures hold their subject in a hundredth of the area of what is behind.
  if (2 * faces.triangles.size() <= most_samples) {
    double step = area / double(count);
    const auto samples = [&] { return passed.back() / step; };
    for (passed = sums_before(areas, step); samples() > 1.01 * double(most_samples);
         passed = sums_before(areas, step))
      step = passed.back() / double(most_samples);  // half of them at most are of small faces
    count = std::min(std::uint64_t(std::ceil(samples())), most_samples);
  }
  const std::uint64_t faces_of_file = faces.count;
  const std::string without_colors = faces.without_colors;
  const std::vector<std::uint32_t> loose = loose_vertices(faces, result.cloud.size());
  Samples samples(std::move(faces), result.cloud, std::move(passed), count);
  PointCloud sampled = samples.take(progress);
  // Points of a scan beside a few faces stay; of a mesh what no face uses is left over from editing.
  const bool stay = 2 * loose.size() > result.cloud.size();
  report.notes.push_back(
      counted(faces_of_file, "face") + " sampled to " + counted(sampled.size(), "point") +
      (loose.empty() || stay ? "" : ", " + counted(loose.size(), "point") + " of no face left out") +
      (samples.computes_normals() ? ", with new normals (the file's do not fit them)" : "") +
      " (--vertices: the vertices alone)" +
      (without_colors.empty() ? "" : "; without colours: " + without_colors));
  if (stay) {
    PointCloud others = select(result.cloud, loose);
    others.grid_index.clear();
    append(sampled, others);
  }
  result.cloud = std::move(sampled);
  report.points_finite = result.cloud.size();
  report.points = report.points_finite + report.points_dropped;
}

}  // namespace sfumato::io
