#include "io/io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>
#include <tuple>

#include "core/counted.h"
#include "core/lower_case.h"
#include "core/order.h"
#include "io/atomic_writer.h"
#include "io/excerpt.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/las.h"
#include "io/poses.h"
#include "io/nvm.h"
#include "io/splats.h"
#include "io/vtk.h"

namespace sfumato::io {
namespace {

/// Ordered: content decides before the extension, and of two formats that recognise it the first wins.
const std::vector<Format>& table() {
  static const std::vector<Format> formats = {
      {"ply",
       {".ply"},
       "Stanford PLY, ascii and binary",
       is_ply,
       read_ply,
       write_ply,
       excerpt_ply,
       nullptr,
       true},
      {"pcd",
       {".pcd"},
       "Point Cloud Library, ascii, binary and compressed",
       is_pcd,
       read_pcd,
       write_pcd,
       excerpt_pcd},
      {"obj",
       {".obj"},
       "Wavefront OBJ, faces and vertices",
       is_obj,
       read_obj,
       nullptr,
       excerpt_obj,
       nullptr,
       true},
      {"stl",
       {".stl"},
       "STL, text and binary, facets and their corners",
       is_stl,
       read_stl,
       nullptr,
       nullptr,
       nullptr,
       true},
      {"off",
       {".off"},
       "Geomview OFF, faces and vertices",
       is_off,
       read_off,
       nullptr,
       nullptr,
       nullptr,
       true},
      {"copc",
       {".copc.laz"},
       "Cloud Optimized Point Cloud 1.0",
       is_copc,
       read_las,
       nullptr,
       excerpt_las,
       read_part_of_las},
      {"laz",
       {".laz"},
       "LAS compressed by LASzip",
       is_laz,
       read_las,
       write_laz,
       excerpt_las,
       read_part_of_las},
      {"las",
       {".las"},
       "LAS 1.0 to 1.4, point formats 0 to 10",
       is_las,
       read_las,
       write_las,
       excerpt_las,
       read_part_of_las},
      {"expe", {}, "point sets of Expe and MeshLab (.pts), text and binary", is_expe, read_expe},
      {"pts", {".pts"}, "lines of numbers after their count", nullptr, read_text, nullptr, excerpt_text},
      {"npy", {".npy"}, "NumPy array, one row or record per point", is_npy, read_npy_points, write_npy_cloud},
      {"e57", {".e57"}, "ASTM E2807, all scans", is_e57, read_e57},
      {"ptx", {".ptx"}, "Leica PTX, all scans", is_ptx, read_ptx},
      {"npz", {".npz"}, "NumPy arrays in one file: xyz, rgb, normals and scalars by name", is_npz, read_npz},
#ifdef SFUMATO_DRACO
      {"draco",
       {".drc"},
       "Draco point clouds and meshes",
       is_draco,
       read_draco,
       nullptr,
       nullptr,
       nullptr,
       true},
#endif
      {"ept",
       {"ept.json"},
       "Entwine Point Tiles: laszip, binary, zstandard",
       is_ept,
       read_ept,
       nullptr,
       nullptr,
       read_part_of_tiles},
      {"potree",
       {"metadata.json"},
       "Potree 2 octrees, DEFAULT and BROTLI (metadata.json)",
       is_potree,
       read_potree,
       nullptr,
       nullptr,
       read_part_of_tiles},
      {"vpc", {".vpc"}, "virtual point clouds: lists of COPC, LAZ and other files", is_vpc, read_vpc},
      {"depth",
       {".json"},
       "depth image (16-bit PNG or EXR) and its camera as JSON",
       is_depth_image,
       read_depth_image},
      {"colmap",
       {"points3d.bin"},
       "COLMAP points3D.bin (points3D.txt is text)",
       is_colmap_points,
       read_colmap_points},
      {"kitti",
       {".bin"},
       "raw numbers: scans of vehicles (KITTI, nuScenes, NCLT), Easy3D",
       nullptr,
       read_floats},
      {"nvm", {".nvm"}, "models of VisualSFM", is_nvm, read_nvm},
      {"splat", {".splat"}, "3D Gaussian splats, 32 bytes each", nullptr, read_splat},
      {"ksplat", {".ksplat"}, "3D Gaussian splats, in sections of buckets", nullptr, read_ksplat},
      {"spz", {".spz"}, "3D Gaussian splats of SPZ, versions 1 to 3", is_spz, read_spz},
      {"grid", {".grd"}, "height grids: ESRI ASCII (.asc), GRASS, Surfer", is_height_grid, read_height_grid},
      {"vtk",
       {".vtk"},
       "VTK legacy, poly data and points of grids",
       is_vtk,
       read_vtk,
       nullptr,
       nullptr,
       nullptr,
       true},
      {"vtp",
       {".vtp", ".vtu"},
       "VTK XML, poly data and points of grids",
       is_vtk_xml,
       read_vtk_xml,
       nullptr,
       nullptr,
       nullptr,
       true},
      // Last: any lines of numbers are text.
      {"text",
       {".xyz", ".txt", ".csv", ".asc"},
       "lines of numbers, columns from a header or guessed",
       is_text,
       read_text,
       write_text,
       excerpt_text},
  };
  return formats;
}

std::string lower_name(const std::filesystem::path& file) { return lower_case(file.filename().string()); }

/// `.copc.laz` counts as an extension, so the end of the whole name is compared.
bool has_extension(const Format& format, const std::string& name) {
  return std::any_of(format.extensions.begin(), format.extensions.end(),
                     [&](const std::string& extension) { return name.ends_with(extension); });
}

std::string all_extensions(bool writable) {
  std::string list;
  for (const Format& format : table())
    if (!writable || format.write)
      for (const std::string& extension : format.extensions) list += (list.empty() ? "" : " ") + extension;
  return list;
}

const Format& find_format(const std::filesystem::path& file) {
  const File opened(file);
  if (opened.size() == 0)
    throw Error(ErrorCode::bad_input,
                file.string() + ": byte 0: the file is empty; fetch or export it again");
  const std::string head = opened.read_text(0, 4096), name = lower_name(opened.name());
  // Any lines of numbers look like text: a file that is called otherwise is that, damaged, and its reader
  // says where. But tables are handed on as PCD and PLY without a header.
  std::istringstream row(head.substr(0, head.find('\n')));
  double x, y, z;
  const bool is_row = (name.ends_with(".pcd") || name.ends_with(".ply")) && row >> x >> y >> z;
  const auto is_called_otherwise = [&](const Format& format) {
    return format.sniff == is_text && !is_row && !has_extension(format, name) &&
           std::any_of(table().begin(), table().end(),
                       [&](const Format& other) { return other.sniff && has_extension(other, name); });
  };
  for (const Format& format : table())
    if (format.read && format.sniff && format.sniff(head) && !is_called_otherwise(format)) return format;
  for (const Format& format : table())
    if (format.read && has_extension(format, name)) return format;
  throw Error(
      ErrorCode::bad_input,
      file.string() + ": not a point cloud format I know; convert it to one of " + all_extensions(false));
}

/// So many records in one place are no chance.
constexpr std::size_t few_in_one_place = 3;

void keep(ReadResult& result, const std::vector<std::uint32_t>& kept) {
  ReadReport& report = result.report;
  const std::uint64_t left_out = result.cloud.size() - kept.size();
  result.cloud = select(result.cloud, kept);
  report.points_finite -= left_out, report.points_dropped += left_out;
  const Bounds box = bounds(result.cloud);
  report.bounds_min = box.min, report.bounds_max = box.max;
}

template <class Predicate>
void leave_out(ReadResult& result, const Predicate& is_nothing) {
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < result.cloud.size(); ++i)
    if (!is_nothing(result.cloud.positions[i])) kept.push_back(std::uint32_t(i));
  keep(result, kept);
}

/// Beside records that are nothing there are some that are next to nothing: within a fiftieth of the distance
/// of all but a twentieth of the others, and few.
float nearly_at(const std::vector<vec3>& positions, const vec3& nothing) {
  constexpr double nearest = 0.05, as_near = 0.02, few = 0.02;
  std::vector<float> distances;
  for (const vec3& p : positions)
    if (p != nothing) distances.push_back(glm::distance(p, nothing));
  if (distances.empty()) return 0;
  const auto limit = float(as_near * double(value_at_share(distances, nearest)));
  const auto within = std::count_if(distances.begin(), distances.end(), [&](float d) { return d < limit; });
  return within > 0 && double(within) < few * double(distances.size()) ? std::nextafter(limit, 0.0f) : 0;
}

/// Records that a driver writes where nothing came back, as 0 0 0: at a scanner at the origin any, elsewhere
/// more than a few on exactly that place.
void leave_out_no_returns(ReadResult& result, const Format& format, bool is_part) {
  PointCloud& cloud = result.cloud;
  ReadReport& report = result.report;
  for (int k = 0; k < 3; ++k)
    if (report.bounds_min[k] > 0 || report.bounds_max[k] < 0) return;
  const vec3 zero(-cloud.origin);
  const auto zeros = std::size_t(std::count(cloud.positions.begin(), cloud.positions.end(), zero));
  if (zeros <= (format.name == "kitti" ? 0 : few_in_one_place) || (zeros == cloud.size() && !is_part)) return;
  // Each part of a file would find another distance.
  const float nearly = format.read_part ? 0 : nearly_at(cloud.positions, zero);
  const dvec3 low = report.bounds_min, high = report.bounds_max;  // as the file has them
  leave_out(result, [&](const vec3& p) { return glm::distance(p, zero) <= nearly; });
  for (int k = 0; k < 3; ++k) {
    if (low[k] != 0 && nearly == 0) report.bounds_min[k] = low[k];
    if (high[k] != 0 && nearly == 0) report.bounds_max[k] = high[k];
  }
  report.notes.push_back(counted(zeros, "record") + (zeros == 1 ? " is" : " are") +
                         " 0 0 0, as scanners write where nothing returned: left out");
}

/// OpenSfM writes the axes of each camera among the points that it saw, from its place on: so many each of
/// red, green and blue.
void leave_out_camera_axes(ReadResult& result) {
  constexpr std::array<Rgba8, 3> axes{Rgba8{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}};
  constexpr std::size_t least = 5;
  const PointCloud& cloud = result.cloud;
  std::vector<std::uint32_t> pure, others;
  for (std::uint32_t i = 0; i < cloud.colors.size(); ++i)
    (std::find(axes.begin(), axes.end(), cloud.colors[i]) == axes.end() ? others : pure).push_back(i);
  std::size_t each = 0;
  while (each < pure.size() && cloud.colors[pure[each]] == axes[0]) ++each;
  if (each < least || pure.size() % (3 * each) != 0 || others.empty()) return;
  for (std::size_t k = 0; k < pure.size(); ++k) {
    const std::size_t first = k - k % (3 * each);
    const bool is_next = cloud.colors[pure[k]] == axes[k / each % 3] &&
                         (k % each != 0 || cloud.positions[pure[k]] == cloud.positions[pure[first]]);
    if (!is_next) return;
  }
  keep(result, others);
  result.report.notes.push_back("the axes of " + counted(pure.size() / (3 * each), "camera") + ", " +
                                counted(pure.size(), "point") + ", are left out");
}

bool is_before(const vec3& a, const vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

/// Whether more than so many share one place that has the least or the greatest coordinate along an axis.
bool has_place_at_an_end(const std::vector<vec3>& sample, std::size_t most) {
  if (sample.empty()) return false;
  vec3 low = sample[0], high = sample[0];
  for (const vec3& p : sample) low = glm::min(low, p), high = glm::max(high, p);
  std::vector<vec3> at_an_end;
  for (const vec3& p : sample)
    if (glm::any(glm::equal(p, low)) || glm::any(glm::equal(p, high))) at_an_end.push_back(p);
  if (at_an_end.size() <= most) return false;
  std::sort(at_an_end.begin(), at_an_end.end(), is_before);
  for (std::size_t i = most; i < at_an_end.size(); ++i)
    if (at_an_end[i] == at_an_end[i - most]) return true;
  return false;
}

/// Places that many records share exactly, and that are farther from the box of all others than that is long:
/// no thing was measured there.
std::vector<vec3> places_of_nothing(const PointCloud& cloud) {
  constexpr std::size_t sample_size = 65'536;
  constexpr double many = 0.001;  // of all
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / sample_size);
  std::vector<vec3> sample;
  sample.reserve(cloud.size() / stride + 1);
  for (std::size_t i = 0; i < cloud.size(); i += stride) sample.push_back(cloud.positions[i]);
  const std::size_t most = std::max<std::size_t>(few_in_one_place, std::size_t(many * double(sample.size())));
  // Of places beyond all others one has the least or the greatest coordinate along an axis.
  if (!has_place_at_an_end(sample, most)) return {};
  std::sort(sample.begin(), sample.end(), is_before);
  std::vector<vec3> shared;
  constexpr float infinite = std::numeric_limits<float>::infinity();
  vec3 low(infinite), high(-infinite);  // of the others
  std::size_t others = 0;
  for (std::size_t i = 0, end; i < sample.size(); i = end) {
    for (end = i; end < sample.size() && sample[end] == sample[i];) ++end;
    if (end - i > most)
      shared.push_back(sample[i]);
    else
      ++others, low = glm::min(low, sample[i]), high = glm::max(high, sample[i]);
  }
  // Where many places are shared, coordinates are coarse.
  constexpr std::size_t others_each = 100;
  if (others < others_each * shared.size()) return {};
  std::erase_if(shared, [&](const vec3& p) {
    const vec3 away = glm::max(low - p, p - high);
    return !(std::max({away.x, away.y, away.z}) > glm::distance(low, high));
  });
  return shared;
}

/// What simulators and some drivers write where nothing returned: their range itself. No surface is as far as
/// another by a ten thousandth, few returns come from the last tenth, and a line of sight with a return has
/// no other: beside one there are fewer of these than of other returns. They lie in many directions, as no
/// thing does that is as far off as ten thousand times its width. 0 where there is none.
double range_of_nothing(const PointCloud& cloud) {
  constexpr std::size_t sample_size = 65'536, one_in = 100;
  constexpr double equal = 1e-4, nearly = 0.1;
  constexpr int sectors = 512;  // of 0.7 degrees
  constexpr std::ptrdiff_t fewest_directions = 16;
  const std::size_t stride = std::max<std::size_t>(1, cloud.size() / sample_size);
  std::vector<double> ranges;
  ranges.reserve(cloud.size() / stride + 1);
  for (std::size_t i = 0; i < cloud.size(); i += stride) ranges.push_back(glm::length(cloud.world(i)));
  double most = ranges.empty() ? 0 : *std::max_element(ranges.begin(), ranges.end());
  const auto beyond = [&](double less) {
    return std::size_t(
        std::count_if(ranges.begin(), ranges.end(), [&](double range) { return range > (1 - less) * most; }));
  };
  const std::size_t at_most = beyond(equal);
  if (one_in * at_most <= ranges.size() || one_in * (beyond(nearly) - at_most) >= at_most) return 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) most = std::max(most, glm::length(cloud.world(i)));
  std::size_t all = 0, near_most = 0;
  std::vector<std::size_t> of_nothing;                                  // the sectors of each
  std::vector<std::uint32_t> returned(std::size_t(sectors) * sectors);  // azimuth by elevation
  for (std::size_t i = 0; i < cloud.size(); i += stride, ++all) {
    const dvec3 p = cloud.world(i);
    const double range = glm::length(p);
    if (!(range > 0)) continue;
    const auto cell = [&](double turn) { return std::clamp(int(turn * sectors), 0, sectors - 1); };
    const auto sector =
        std::size_t(cell(0.5 + std::atan2(p.y, p.x) / glm::two_pi<double>()) * sectors +
                    cell(0.5 + std::asin(std::clamp(p.z / range, -1.0, 1.0)) / glm::two_pi<double>()));
    if (range > (1 - equal) * most) {
      of_nothing.push_back(sector);
    } else {
      near_most += range > (1 - nearly) * most;
      ++returned[sector];
    }
  }
  const auto beside = double(std::count_if(of_nothing.begin(), of_nothing.end(),
                                           [&](std::size_t sector) { return returned[sector] > 0; }));
  double returns = 0, beside_others = 0;
  for (const std::uint32_t count : returned) returns += count, beside_others += count > 1 ? count : 0;
  const auto nothing = double(of_nothing.size());
  std::sort(of_nothing.begin(), of_nothing.end());
  const auto directions = std::unique(of_nothing.begin(), of_nothing.end()) - of_nothing.begin();
  const bool is_nothing = directions >= fewest_directions && all > 2 * one_in &&
                          one_in * nothing > double(all) && 2 * nothing < double(all) &&
                          double(one_in * near_most) < nothing &&
                          2 * beside / nothing < beside_others / returns;
  return is_nothing ? (1 - equal) * most : 0;
}

/// Of a scanner at the origin.
void leave_out_clamped(ReadResult& result) {
  const ReadReport& report = result.report;
  for (int k = 0; k < 3; ++k)
    if (report.bounds_min[k] > 0 || report.bounds_max[k] < 0) return;
  const double range = range_of_nothing(result.cloud);
  if (!(range > 0)) return;
  const std::size_t before = result.cloud.size();
  const dvec3 origin = result.cloud.origin;
  leave_out(result, [&](const vec3& p) { return glm::length(dvec3(p) + origin) > range; });
  result.report.notes.push_back(counted(before - result.cloud.size(), "record") +
                                " as far from 0 0 0 as the farthest, as where nothing returned: left out");
}

void leave_out_nothing(ReadResult& result) {
  const std::vector<vec3> places = places_of_nothing(result.cloud);
  if (places.empty()) return;
  const std::size_t before = result.cloud.size();
  leave_out(result,
            [&](const vec3& p) { return std::find(places.begin(), places.end(), p) != places.end(); });
  result.report.notes.push_back(counted(before - result.cloud.size(), "record") + " in " +
                                counted(places.size(), "place") +
                                " far from all others, where nothing returned: left out");
}

/// What COLMAP found has the axes of a camera, y down, or of those that it placed around it.
void stand_as_pictures(const std::filesystem::path& file, const Format& format, ReadResult& result) {
  PointCloud& cloud = result.cloud;
  if (cloud.up_is_known || cloud.las) return;
  if (cloud.scalar("POINT3D_ID")) cloud.up = UpAxis::neg_y;
  if (cloud.provenance != Provenance::photographs && format.name != "ply" && !cloud.scalar("POINT3D_ID"))
    return;
  const std::optional<UpAxis> up = up_of_pictures(file);
  if (!up) return;
  cloud.set_up(*up);
  if (*up != UpAxis::neg_y) result.report.notes.push_back(to_string(*up) + " is up, by its pictures");
}

}  // namespace

bool has_cloud_name(const std::string& name) {
  return std::any_of(table().begin(), table().end(), [&](const Format& format) {
    return format.read && has_extension(format, lower_name(name));
  });
}

void bad_input(const std::filesystem::path& file, const std::string& place, const std::string& what) {
  std::string line = what;  // which may quote the file
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == 127; }, '?');
  throw Error(ErrorCode::bad_input, file.string() + ": " + place + ": " + line);
}

std::uint64_t held_points(const File& file, const std::string& place, std::uint64_t held,
                          std::uint64_t declared, ReadReport& report) {
  if (held >= declared) return declared;
  const std::string found =
      "the file ends after " + counted(held, "point") + ", expected " + std::to_string(declared);
  if (held == 0) bad_input(file.path(), place, found + "; it is cut short, fetch it again");
  report.damage.push_back(file.path().string() + ": " + place + ": " + found + "; fetch the rest");
  report.points_missing += declared - held;
  return held;
}

ReadResult read(const std::filesystem::path& file, const ReadOptions& options, Progress& progress) {
  const Format& format = find_format(file);
  Faces faces;
  ReadOptions wanted = options;
  if (options.samples_faces) wanted.faces = &faces;
  std::optional<ReadResult> part;
  if (options.part && options.part->count > 1 && format.read_part)
    part = format.read_part(file, wanted, progress);
  const bool is_part = part.has_value();
  wanted.part.reset();
  ReadResult result = is_part ? std::move(*part) : format.read(file, wanted, progress);
  if (options.strict && !result.report.damage.empty())
    throw Error(ErrorCode::bad_input, result.report.damage.front());
  result.report.file = file;
  if (result.report.format.empty()) result.report.format = format.name;
  // E57 knows its scanners itself; the vertices of meshes and of the others are no returns.
  if (!result.has_faces && result.cloud.provenance == Provenance::unknown && format.name != "e57" &&
      format.name != "vtk" && format.name != "vtp" && format.name != "grid") {
    leave_out_no_returns(result, format, is_part);
    leave_out_nothing(result);
    if (!is_part) leave_out_clamped(result);  // of a part nobody knows how far the farthest is
  }
  if (format.name == "ply" && !result.has_faces) leave_out_camera_axes(result);
  stand_as_pictures(file, format, result);
  if (is_part) return result;
  if (options.samples_faces) sample_faces(std::move(faces), result, progress);
  if (options.max_points && result.cloud.size() > *options.max_points)
    result.cloud = subsample(result.cloud, std::size_t(*options.max_points));
  if (options.part && options.part->count > 1) {
    const std::size_t first = std::size_t(options.part->begin(result.cloud.size()));
    std::vector<std::uint32_t> places(std::size_t(options.part->end(result.cloud.size())) - first);
    std::iota(places.begin(), places.end(), std::uint32_t(first));
    result.cloud = select(result.cloud, places);
  }
  return result;
}

std::optional<ReadResult> read_excerpt(const std::filesystem::path& file, std::size_t points,
                                       const ReadOptions& options, Progress& progress) {
  const Format& format = find_format(file);
  if (!format.excerpt) return std::nullopt;
  std::optional<ReadResult> result = format.excerpt(file, points, options, progress);
  if (!result || result->cloud.empty()) return std::nullopt;
  result->report.file = file;
  result->report.format = format.name;
  stand_as_pictures(file, format, *result);
  return result;
}

Mesh read_mesh(const std::filesystem::path& file, Progress& progress) {
  const Format& format = find_format(file);
  if (!format.has_faces)
    throw Error(ErrorCode::bad_input,
                file.string() + ": a " + format.name +
                    " file holds no faces; name a .ply, .obj, .off, .stl, .drc, .vtk or .vtp");
  Faces faces;
  ReadOptions options;
  options.faces = &faces;
  ReadResult vertices = format.read(file, options, progress);
  if (!vertices.report.damage.empty()) throw Error(ErrorCode::bad_input, vertices.report.damage.front());
  if (faces.bad > 0)
    bad_input(file, faces.first_bad,
              "found a face with a corner outside the " + std::to_string(vertices.report.points) +
                  " vertices; the file is damaged, export it again");
  Mesh mesh{{}, std::move(vertices.cloud.colors), std::move(faces.triangles)};
  for (std::size_t i = 0; i < vertices.cloud.size(); ++i)
    mesh.positions.push_back(vec3(vertices.cloud.world(i)));
  return mesh;
}

WriteReport write(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const std::string name = is_standard_output(file) ? "-.ply" : lower_name(file);
  for (const Format& format : table())
    if (format.write && has_extension(format, name)) return format.write(file, cloud, progress);
  throw Error(ErrorCode::usage,
              file.string() + ": clouds are not written in this format; use one of " + all_extensions(true));
}

bool can_write(const std::filesystem::path& file) {
  if (is_standard_output(file)) return true;
  const std::string name = lower_name(file);
  return std::any_of(table().begin(), table().end(),
                     [&](const Format& format) { return format.write && has_extension(format, name); });
}

std::vector<FormatInfo> formats() {
  std::vector<FormatInfo> list;
  for (const Format& format : table()) {
    std::string extensions;
    for (const std::string& extension : format.extensions)
      extensions += (extensions.empty() ? "" : " ") + extension;
    list.push_back(
        {format.name, extensions, format.description, format.read != nullptr, format.write != nullptr});
  }
  return list;
}

}  // namespace sfumato::io
