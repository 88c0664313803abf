#include "publication.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "core/color.h"
#include "core/error.h"
#include "core/version.h"
#include "depth_text.h"
#include "io/atomic_writer.h"
#include "io/image_file.h"

namespace sfumato::publish {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* list_name = "published.txt";
constexpr const char* list_title =
    "Files that sfumato publish wrote; it replaces a folder that holds no others.";
constexpr double other_elevation_deg = 30, steepest_deg = 89;

/// A name in `folder` that no publication wrote; empty: there is none.
std::string stranger_in(const fs::path& folder) {
  std::set<std::string> ours{list_name};
  std::ifstream list(folder / list_name);
  std::string line;
  if (std::getline(list, line) && line == list_title)
    while (std::getline(list, line)) {
      ours.insert(line);
      if (const std::size_t end = line.find('/'); end != line.npos) ours.insert(line.substr(0, end));
    }
  else
    ours.clear();
  for (const fs::directory_entry& each : fs::recursive_directory_iterator(folder))
    if (const std::string name = each.path().lexically_relative(folder).generic_string();
        !ours.contains(name))
      return name;
  return {};
}

Json json_of(const dvec3& v) { return Json::array({v.x, v.y, v.z}); }

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  return out;
}

std::string megabytes(std::uint64_t bytes) { return fmt::format("{:.1f} MB", double(bytes) / 1e6); }

void replace(std::string& text, const std::string& mark, const std::string& with) {
  for (std::size_t at = text.find(mark); at != text.npos; at = text.find(mark, at + with.size()))
    text.replace(at, mark.size(), with);
}

double elevation_of(const Camera& camera, const dvec3& up) {
  return glm::degrees(std::asin(std::clamp(-glm::dot(camera.direction(), up), -1.0, 1.0)));
}

/// How far around `up` one camera is from another, 0 to 360 degrees.
double turn_between(const Camera& from, const Camera& to, const dvec3& up) {
  const auto flat = [&](const Camera& camera) {
    const dvec3 side = glm::cross(camera.direction(), camera.up);
    return side - glm::dot(side, up) * up;
  };
  const dvec3 a = flat(from), b = flat(to);
  const double turn = glm::degrees(std::atan2(glm::dot(glm::cross(a, b), up), glm::dot(a, b)));
  return turn < -1e-6 ? turn + 360 : std::max(0.0, turn);
}

}  // namespace

Publication::Publication(fs::path folder, int around, std::vector<double> elevations_deg)
    : folder_(fs::absolute(folder).lexically_normal()),
      around_(around),
      elevations_deg_(std::move(elevations_deg)) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  const fs::file_status there = fs::status(folder_, error);
  if (fs::exists(there) && !fs::is_directory(there))
    throw Error(ErrorCode::usage, "-o " + folder.string() + ": that is no folder; name a new one");
  if (fs::exists(there))
    if (const std::string stranger = stranger_in(folder_); !stranger.empty())
      throw Error(ErrorCode::usage, "-o " + folder.string() + ": the folder holds " + stranger +
                                        ", which no publication wrote; name a new or an empty folder");
  part_ = folder_.parent_path() / fmt::format(".{}.part-{}", folder_.filename().string(), ::getpid());
  if (!fs::create_directory(part_, error))
    throw Error(ErrorCode::io, "-o " + folder.string() + ": no folder can be made there" +
                                   (error ? ": " + error.message() : std::string()));
  for (const char* name : {"views", "depth"}) fs::create_directory(part_ / name);
}

Publication::~Publication() {
  std::error_code ignored;
  if (!part_.empty()) fs::remove_all(part_, ignored);
}

std::vector<Camera> Publication::cameras(const Camera& first, UpAxis axis, const Subject& subject,
                                         bool may_step_back) {
  const dvec3 up = up_vector(axis);
  const double own = elevation_of(first, up);
  std::vector<double> elevations = elevations_deg_;
  if (elevations.empty())
    elevations = {own, own + (own > steepest_deg - other_elevation_deg ? -1 : 1) * other_elevation_deg};
  std::vector<Camera> starts;
  double distance = 0, height = 0;
  for (const double elevation : elevations) {
    Camera start = first;
    if (std::abs(elevation - own) > 1e-9)
      look_from(start, axis, {}, glm::radians(std::clamp(elevation, -steepest_deg, steepest_deg)), true);
    if (may_step_back) step_back(start, up, subject);
    distance = std::max(distance, glm::length(start.position - start.target));
    height = std::max(height, start.height_world);
    starts.push_back(start);
  }
  std::vector<Camera> all;
  for (Camera& start : starts) {
    if (may_step_back) {
      start.position = start.target - distance * start.direction();
      start.height_world = height;
    }
    for (const Camera& each : orbit(start, up, around_, 360)) {
      views_.push_back({turn_between(first, each, up), elevation_of(each, up), each});
      all.push_back(each);
    }
  }
  return all;
}

void Publication::note(const std::string& name) {
  bytes_ += fs::file_size(part_ / name);
  files_.push_back(name);
}

void Publication::write(const std::string& name, const std::string& text) {
  io::AtomicWriter writer(part_ / name);
  writer.write(text);
  writer.commit();
  note(name);
}

void Publication::add(const Image<Rgba8>& picture, const Image<float>& depth, const Camera& camera) {
  constexpr int quality = 88;
  const std::string picture_name = fmt::format("views/{:03}.webp", added_),
                    depth_name = fmt::format("depth/{:03}.js", added_);
  views_.at(added_).camera = camera;
  for (int y = 0; y < depth.height(); ++y)
    for (int x = 0; x < depth.width(); ++x)
      if (std::isfinite(depth.at(x, y)))
        reach_ = glm::max(reach_, glm::dvec2(std::abs(2 * (x + 0.5) / depth.width() - 1),
                                             std::abs(2 * (y + 0.5) / depth.height() - 1)));
  io::write_webp(part_ / picture_name, picture, false, quality);
  note(picture_name);
  picture_bytes_ += fs::file_size(part_ / picture_name);
  write(depth_name, depth_text(added_, depth));
  depth_bytes_ += fs::file_size(part_ / depth_name);
  ++added_;
}

std::string Publication::data_text(const Facts& facts) const {
  const dvec3 up = up_vector(facts.up);
  // A small window shows no more than the scan.
  const glm::dvec2 reach =
      facts.has_furniture ? glm::dvec2(1) : glm::clamp(1.04 * reach_, glm::dvec2(0.1), glm::dvec2(1));
  Json views = Json::array();
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Camera& camera = views_[i].camera;
    const Intrinsics lens = camera.intrinsics();
    views.push_back({{"picture", fmt::format("views/{:03}.webp", i)},
                     {"depth", fmt::format("depth/{:03}.js", i)},
                     {"turn", std::round(100 * views_[i].turn_deg) / 100},
                     {"elevation", std::round(100 * views_[i].elevation_deg) / 100},
                     {"position", json_of(camera.position)},
                     {"target", json_of(camera.target)},
                     {"up", json_of(camera.up)},
                     {"lens", {lens.fx, lens.fy, lens.cx, lens.cy}},
                     {"orthographic", camera.orthographic()}});
  }
  const Camera& camera = views_.front().camera;
  const Json json{{"title", facts.title},
                  {"width", camera.width},
                  {"height", camera.height},
                  {"reach", {reach.x, reach.y}},
                  {"background", hex_of(to_rgba8(facts.background))},
                  {"unit", {{"symbol", facts.unit.symbol}, {"metres", facts.unit.metres}}},
                  {"up", json_of(up)},
                  {"exaggeration", facts.vertical_exaggeration},
                  {"views", views}};
  return "'use strict';\nconst published = " + json.dump(0, ' ', false, Json::error_handler_t::replace) +
         ";\n";
}

std::string Publication::details_text(const Facts& facts) const {
  std::string rows;
  auto all = facts.rows;
  all.emplace_back("views", fmt::format("{} pictures of {}x{} pixels", views_.size(),
                                        views_.front().camera.width, views_.front().camera.height));
  all.emplace_back("size", fmt::format("{}: pictures {}, depth {} (read when somebody measures)",
                                       megabytes(picture_bytes_ + depth_bytes_), megabytes(picture_bytes_),
                                       megabytes(depth_bytes_)));
  all.emplace_back("made by", std::string("sfumato ") + version());
  for (const auto& [name, value] : all)
    rows += "<tr><th scope=\"row\">" + escaped(name) + "</th><td>" + escaped(value) + "</td></tr>\n";
  const auto found = std::find_if(page_files.begin(), page_files.end(),
                                  [](const PageFile& file) { return file.name == "details.html"; });
  std::string text = found->text;
  replace(text, "{{rows}}", rows);
  replace(text, "{{title}}", escaped(facts.title));
  replace(text, "{{command}}", escaped(facts.command));
  return text;
}

void Publication::finish(const Facts& facts) {
  for (const PageFile& file : page_files) {
    std::string text = file.name == "details.html" ? details_text(facts) : file.text;
    if (file.name == "index.html") replace(text, "{{title}}", escaped(facts.title));
    write(file.name, text);
  }
  write("data.js", data_text(facts));
  std::string list = std::string(list_title) + "\n";
  for (const std::string& name : files_) list += name + "\n";
  write(list_name, list);
  take_place();
}

/// An older folder of ours goes when this one has its name.
void Publication::take_place() {
  const fs::path old = part_.string() + ".old";
  std::error_code error;
  const bool had_one = fs::exists(folder_, error);
  if (had_one) {
    if (const std::string stranger = stranger_in(folder_); !stranger.empty())
      throw Error(ErrorCode::usage, folder_.string() + ": the folder now holds " + stranger +
                                        ", which no publication wrote; name a new or an empty folder");
    fs::rename(folder_, old, error);
  }
  if (!error) fs::rename(part_, folder_, error);
  if (error) {
    std::error_code ignored;
    if (had_one && !fs::exists(folder_, ignored)) fs::rename(old, folder_, ignored);
    throw Error(ErrorCode::io, folder_.string() + ": the folder cannot be named: " + error.message());
  }
  part_.clear();
  if (had_one) fs::remove_all(old, error);
}

std::string Publication::summary() const {
  return fmt::format("{} ({} views, {})", folder_.lexically_proximate(fs::current_path()).string(),
                     views_.size(), megabytes(bytes_));
}

}  // namespace sfumato::publish
