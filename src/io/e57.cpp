// E57 (ASTM E2807): scans of bit-packed integers, scaled integers and floats, cartesian or spherical, each
// with its pose.
#include <pugixml.hpp>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>

#include "core/counted.h"
#include "core/number_in.h"
#include "io/color_depth.h"
#include "io/e57_file.h"
#include "io/format.h"
#include "io/table.h"

namespace sfumato::io {
namespace {

constexpr int deepest_element = 64;
constexpr std::size_t most_fields = 256, most_scans = 100'000;
constexpr std::uint64_t most_points_per_byte = 64;  // fields of one constant value take no bits at all

struct PrototypeField {
  std::string name;
  enum class Kind { float32, float64, integer } kind = Kind::float64;
  std::int64_t low = 0;
  int bits = 0;
  double scale = 1, offset = 0;
  bool is_scaled = false;
  std::vector<std::byte> stream;
};

struct Data3D {
  std::uint64_t section = 0, points = 0;
  std::vector<PrototypeField> fields;
  double rotation[4] = {1, 0, 0, 0};  // w x y z
  dvec3 translation{0};
  bool has_pose = false;

  /// Without a pose the scanner's place is the origin only where distances are measured from it.
  std::optional<dvec3> scanner() const {
    const bool is_spherical = std::any_of(fields.begin(), fields.end(), [](const PrototypeField& field) {
      return field.name == "sphericalRange";
    });
    return has_pose || is_spherical ? std::optional(translation) : std::nullopt;
  }
};

class E57Reader {
 public:
  explicit E57Reader(const std::filesystem::path& path) : file_(path) {}

  ReadResult read(Progress& progress) {
    read_xml();
    ReadResult result;
    std::uint64_t points = 0;
    for (Data3D& scan : scans_) points += scan.points;
    if (points > 0xFFFFFFFFull)
      file_.fail(0, "found " + std::to_string(points) + " points, expected at most 4294967295");
    Table table(columns(), std::size_t(points));
    std::size_t first = 0;
    for (std::size_t s = 0; s < scans_.size(); ++s) {
      progress.check();
      progress.update(double(s) / double(scans_.size()), "reading scans");
      read_section(scans_[s]);
      fill(scans_[s], table, first, progress);
      part_colors(table, first, std::size_t(scans_[s].points));
      if (std::span<double> scanner = table.column("scanner"); !scanner.empty())
        std::fill_n(scanner.begin() + std::ptrdiff_t(first), scans_[s].points, double(s));
      first += std::size_t(scans_[s].points);
    }
    unite_colors(table);
    table.build(false, progress, result);
    if (no_returns_ > 0)
      result.report.notes.push_back(
          counted(no_returns_, "record") + (no_returns_ == 1 ? " lies" : " lie") +
          " at 0 0 0, in the scanner itself, without being marked: no return, left out");
    // Of several scans each has its place in the list: their points number them.
    const dvec3 unknown(std::numeric_limits<double>::quiet_NaN());
    for (const Data3D& scan : scans_)
      if (scan.scanner() || scans_.size() > 1)
        result.cloud.scanners.push_back(scan.scanner().value_or(unknown));
    if (scans_.size() > 1) result.report.notes.push_back(std::to_string(scans_.size()) + " scans");
    result.cloud.up = UpAxis::pos_z;
    return result;
  }

 private:
  [[noreturn]] void bad_xml(const std::string& what) const {
    file_.fail(24, "the XML part " + what + "; the file is damaged");
  }

  double number(const pugi::xml_node& node, double otherwise) const {
    const std::string_view text = node.child_value();
    if (text.empty()) return node ? 0 : otherwise;
    return parse(text);
  }
  double parse(std::string_view text) const {
    while (!text.empty() && (text.front() == ' ' || text.front() == '+' || text.front() == '\n'))
      text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || !std::isfinite(value))
      bad_xml("holds '" + std::string(text.substr(0, 30)) + "', expected a number");
    return value;
  }
  std::int64_t whole(const pugi::xml_attribute& attribute, std::int64_t otherwise) const {
    const std::string_view text = attribute.value();
    if (text.empty()) return otherwise;
    const std::optional<std::int64_t> value = number_in<std::int64_t>(text);
    if (!value) bad_xml("holds '" + std::string(text.substr(0, 30)) + "', expected a whole number");
    return *value;
  }

  void read_xml() {
    pugi::xml_document document;
    // No entities, no DTD: pugixml knows only the five of XML itself.
    const auto parsed =
        document.load_buffer(file_.xml().data(), file_.xml().size(), pugi::parse_cdata | pugi::parse_escapes);
    if (!parsed) bad_xml(std::string("cannot be parsed (") + parsed.description() + ")");
    const pugi::xml_node root = document.child("e57Root");
    if (!root) bad_xml("has no e57Root");
    for (const pugi::xml_node& node : root.child("data3D").children("vectorChild")) {
      if (scans_.size() >= most_scans) bad_xml("names more than " + std::to_string(most_scans) + " scans");
      read_scan(node);
    }
  }

  void read_scan(const pugi::xml_node& node) {
    const pugi::xml_node points = node.child("points");
    if (!points) return;
    Data3D scan;
    scan.section = std::uint64_t(whole(points.attribute("fileOffset"), -1));
    const std::int64_t count = whole(points.attribute("recordCount"), -1);
    const pugi::xml_node prototype = points.child("prototype");
    if (!prototype || count < 0) bad_xml("describes points without recordCount or prototype");
    scan.points = std::uint64_t(count);
    if (scan.points > file_.size() * most_points_per_byte)
      bad_xml("promises " + std::to_string(count) + " points in a file of " + std::to_string(file_.size()) +
              " bytes");
    read_fields(prototype, scan, 0);
    if (const pugi::xml_node pose = node.child("pose")) {
      scan.has_pose = true;
      const pugi::xml_node rotation = pose.child("rotation"), translation = pose.child("translation");
      const char* names[] = {"w", "x", "y", "z"};
      double square = 0;
      for (int k = 0; k < 4 && rotation; ++k) {
        scan.rotation[k] = number(rotation.child(names[k]), 0);
        square += scan.rotation[k] * scan.rotation[k];
      }
      if (!(std::abs(square - 1) < 0.01)) bad_xml("holds an invalid rotation");
      for (double& q : scan.rotation) q /= std::sqrt(square);
      for (int k = 0; k < 3 && translation; ++k)
        scan.translation[k] = number(translation.child(names[k + 1]), 0);
    }
    scans_.push_back(std::move(scan));
  }

  void read_fields(const pugi::xml_node& structure, Data3D& scan, int depth) {
    if (depth > deepest_element) bad_xml("is nested more than 64 deep");
    for (const pugi::xml_node& node : structure.children()) {
      if (node.type() != pugi::node_element) continue;
      const std::string_view type = node.attribute("type").value();
      if (type == "Structure") {
        read_fields(node, scan, depth + 1);
        continue;
      }
      if (scan.fields.size() >= most_fields)
        bad_xml("names more than " + std::to_string(most_fields) + " fields of a point");
      PrototypeField field;
      field.name = node.name();
      if (type == "Float") {
        field.kind = std::string_view(node.attribute("precision").value()) == "single"
                         ? PrototypeField::Kind::float32
                         : PrototypeField::Kind::float64;
      } else if (type == "Integer" || type == "ScaledInteger") {
        field.kind = PrototypeField::Kind::integer;
        field.low = whole(node.attribute("minimum"), std::numeric_limits<std::int64_t>::min());
        const std::int64_t high = whole(node.attribute("maximum"), std::numeric_limits<std::int64_t>::max());
        if (high < field.low) bad_xml("gives '" + field.name + "' a maximum below its minimum");
        field.bits = int(std::bit_width(std::uint64_t(high) - std::uint64_t(field.low)));
        field.is_scaled = type == "ScaledInteger";
        if (field.is_scaled) {
          if (const auto scale = node.attribute("scale")) field.scale = parse(scale.value());
          if (const auto offset = node.attribute("offset")) field.offset = parse(offset.value());
        }
      } else {
        bad_xml("gives '" + field.name + "' the type '" + std::string(type.substr(0, 20)) +
                "', which points cannot have");
      }
      scan.fields.push_back(std::move(field));
    }
  }

  /// The union of the fields of all scans, coordinates first.
  std::vector<Column> columns() const {
    std::vector<Column> all{
        {"x", StoredType::float64}, {"y", StoredType::float64}, {"z", StoredType::float64}};
    for (const Data3D& scan : scans_)
      for (const PrototypeField& field : scan.fields) {
        if (is_coordinate(field.name)) continue;
        const auto known =
            std::find_if(all.begin(), all.end(), [&](const Column& c) { return c.name == field.name; });
        const bool small = field.kind == PrototypeField::Kind::integer && !field.is_scaled &&
                           field.low >= 0 && field.bits <= 16;
        const StoredType type = small ? (field.bits <= 8 ? StoredType::uint8 : StoredType::uint16)
                                : field.kind == PrototypeField::Kind::float32 ? StoredType::float32
                                                                              : StoredType::float64;
        if (known == all.end())
          all.push_back({field.name, type});
        else if (known->stored != type)  // scans that differ
          known->stored =
              is_integer(type) && is_integer(known->stored) ? StoredType::uint16 : StoredType::float64;
      }
    if (scans_.size() > 1) all.push_back({"scanner", StoredType::uint32});
    assign_roles(all);
    return all;
  }

  static bool is_coordinate(const std::string& name) {
    return name.starts_with("cartesianX") || name.starts_with("cartesianY") ||
           name.starts_with("cartesianZ") || name == "sphericalRange" || name == "sphericalAzimuth" ||
           name == "sphericalElevation";
  }

  /// Collects the streams of the fields from the packets of a scan's section.
  void read_section(Data3D& scan) {
    if (scan.points == 0) return;
    const auto word = [](const std::vector<std::byte>& bytes, std::size_t at, auto value) {
      std::memcpy(&value, bytes.data() + at, sizeof value);
      return value;
    };
    const std::vector<std::byte> head = file_.read(scan.section, 32);
    if (head[0] != std::byte(1))
      file_.fail(scan.section, "found no section of points here; the file is damaged");
    std::uint64_t left = word(head, 8, std::uint64_t());
    std::uint64_t at = word(head, 16, std::uint64_t());
    left -= std::min<std::uint64_t>(left, 32);
    if (left > file_.size())
      file_.fail(scan.section + 8, "found a section larger than the file; it is damaged");
    const auto is_complete = [&](const PrototypeField& field) {
      return field.stream.size() >= bytes_of(field, scan.points);
    };
    while (left >= 4 && !std::all_of(scan.fields.begin(), scan.fields.end(), is_complete)) {
      const std::vector<std::byte> start = file_.read(at, 4);
      const auto size = std::uint64_t(word(start, 2, std::uint16_t())) + 1;
      if (size > left || size < 4 || size % 4 != 0)
        file_.fail(at, "found a packet of " + std::to_string(size) +
                           " bytes, expected it to fit its section; the file is damaged");
      if (start[0] == std::byte(1))
        take_packet(scan, file_.read(at, size), at);
      else if (start[0] != std::byte(0) && start[0] != std::byte(2))
        file_.fail(at, "found a packet of an unknown kind; the file is damaged");
      at = file_.behind(at, size);
      left -= size;
    }
    for (const PrototypeField& field : scan.fields)
      if (field.stream.size() < bytes_of(field, scan.points))
        file_.fail(scan.section, "found " + std::to_string(field.stream.size()) + " bytes of '" + field.name +
                                     "', expected " + std::to_string(bytes_of(field, scan.points)) + " for " +
                                     std::to_string(scan.points) + " points; the file is damaged");
  }

  void take_packet(Data3D& scan, const std::vector<std::byte>& packet, std::uint64_t at) {
    const auto word = [&](std::size_t i) {
      std::uint16_t value;
      std::memcpy(&value, packet.data() + i, 2);
      return std::size_t(value);
    };
    const std::size_t streams = packet.size() >= 6 ? word(4) : 0;
    if (streams != scan.fields.size() || packet.size() < 6 + 2 * streams)
      file_.fail(at, "found " + std::to_string(streams) + " streams, expected " +
                         std::to_string(scan.fields.size()) + "; the file is damaged");
    std::size_t from = 6 + 2 * streams;
    for (std::size_t i = 0; i < streams; ++i) {
      const std::size_t size = word(6 + 2 * i);
      if (size > packet.size() - from)
        file_.fail(at, "found a stream that leaves its packet; the file is damaged");
      scan.fields[i].stream.insert(scan.fields[i].stream.end(), packet.begin() + std::ptrdiff_t(from),
                                   packet.begin() + std::ptrdiff_t(from + size));
      from += size;
    }
  }

  static std::uint64_t bytes_of(const PrototypeField& field, std::uint64_t points) {
    if (field.kind == PrototypeField::Kind::float32) return 4 * points;
    if (field.kind == PrototypeField::Kind::float64) return 8 * points;
    return (points * std::uint64_t(field.bits) + 7) / 8;
  }

  /// The values of a field; lets go of its stream.
  static void decode(PrototypeField& field, std::span<double> out) {
    std::vector<std::byte> bytes = std::move(field.stream);
    field.stream = {};
    if (field.kind != PrototypeField::Kind::integer) {
      for (std::size_t i = 0; i < out.size(); ++i) {
        if (field.kind == PrototypeField::Kind::float32) {
          float value;
          std::memcpy(&value, bytes.data() + 4 * i, 4);
          out[i] = value;
        } else {
          std::memcpy(&out[i], bytes.data() + 8 * i, 8);
        }
      }
      return;
    }
    bytes.resize(bytes.size() + 16);  // so that words may be read at the end
    const std::uint64_t mask = field.bits == 64 ? ~0ull : (1ull << field.bits) - 1;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::uint64_t bit = i * std::uint64_t(field.bits), shift = bit % 8;
      std::uint64_t low, high = std::uint64_t(bytes[bit / 8 + 8]);
      std::memcpy(&low, bytes.data() + bit / 8, 8);
      const std::uint64_t raw = ((low >> shift) | (shift ? high << (64 - shift) : 0)) & mask;
      const double value = double(std::int64_t(std::uint64_t(field.low) + raw));
      out[i] = field.is_scaled ? value * field.scale + field.offset : value;
    }
  }

  void fill(Data3D& scan, Table& table, std::size_t first, Progress& progress) {
    const std::size_t n = std::size_t(scan.points);
    std::map<std::string, std::vector<double>> coordinates;
    for (PrototypeField& field : scan.fields) {
      progress.check();
      if (is_coordinate(field.name)) {
        std::vector<double>& values = coordinates[field.name];
        values.resize(n);
        decode(field, values);
      } else {
        decode(field, table.column(field.name).subspan(first, n));
      }
    }
    const auto find = [&](const char* name) -> const double* {
      const auto found = coordinates.find(name);
      return found == coordinates.end() ? nullptr : found->second.data();
    };
    const double *x = find("cartesianX"), *y = find("cartesianY"), *z = find("cartesianZ");
    const double *range = find("sphericalRange"), *azimuth = find("sphericalAzimuth"),
                 *elevation = find("sphericalElevation");
    const bool cartesian = x && y && z;
    if (n > 0 && !cartesian && !(range && azimuth && elevation))
      file_.fail(scan.section,
                 "found points without cartesian or spherical coordinates; the file is damaged");
    // Nothing returns from 0 0 0 of the scanner's own frame. Without a pose that may be the frame of
    // anything, in which one point may lie there.
    std::size_t at_zero = 0;
    for (std::size_t i = 0; i < n; ++i)
      at_zero += cartesian ? x[i] == 0 && y[i] == 0 && z[i] == 0 : range[i] == 0;
    const bool has_no_returns = at_zero > (scan.scanner() ? 0 : 1);
    const std::span<double> state =
        table.column(cartesian ? "cartesianInvalidState" : "sphericalInvalidState");
    std::span<double> out[3] = {table.column("x"), table.column("y"), table.column("z")};
    std::span<double> normal[3] = {table.column("nor:normalX"), table.column("nor:normalY"),
                                   table.column("nor:normalZ")};
    const bool has_normals = !normal[0].empty() && !normal[1].empty() && !normal[2].empty();
    const auto turned = [&q = scan.rotation](const dvec3& p) {
      const dvec3 v(q[1], q[2], q[3]), t = 2.0 * glm::cross(v, p);
      return p + q[0] * t + glm::cross(v, t);
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (!state.empty() && state[first + i] > 0) continue;  // only a direction, or nothing: stays NaN
      if (has_no_returns && (cartesian ? x[i] == 0 && y[i] == 0 && z[i] == 0 : range[i] == 0)) {
        ++no_returns_;
        continue;
      }
      dvec3 p = cartesian
                    ? dvec3(x[i], y[i], z[i])
                    : range[i] * dvec3(std::cos(elevation[i]) * std::cos(azimuth[i]),
                                       std::cos(elevation[i]) * std::sin(azimuth[i]), std::sin(elevation[i]));
      if (scan.has_pose) {
        p = turned(p) + scan.translation;
        if (has_normals) {
          const std::size_t row = first + i;
          const dvec3 direction = turned({normal[0][row], normal[1][row], normal[2][row]});
          for (int k = 0; k < 3; ++k) normal[k][row] = direction[k];
        }
      }
      for (int k = 0; k < 3; ++k) out[k][first + i] = p[k];
    }
  }

  /// What a scan has of colours: their bits are its own, and where all are zero there are none.
  void part_colors(Table& table, std::size_t first, std::size_t points) {
    const std::span<double> red = table.column("colorRed"), green = table.column("colorGreen"),
                            blue = table.column("colorBlue"), invalid = table.column("isColorInvalid");
    if (red.empty() || green.empty() || blue.empty()) return;
    ScanColors scan{first, first + points, {}};
    for (std::size_t i = first; i < scan.last; ++i) {
      if (!invalid.empty() && invalid[i] > 0) red[i] = green[i] = blue[i] = std::nan("");
      if (!std::isnan(red[i]) && !std::isnan(green[i]) && !std::isnan(blue[i]))
        scan.depth.add(channel(red[i]), channel(green[i]), channel(blue[i]));
    }
    colors_.push_back(std::move(scan));
  }

  /// Scans of 8, 12 and 16 bits side by side have 16.
  void unite_colors(Table& table) {
    int least = 16, most = 0;
    for (const ScanColors& scan : colors_)
      if (const int bits = scan.depth.bits()) least = std::min(least, bits), most = std::max(most, bits);
    if (most == 0) return;  // black everywhere
    for (const ScanColors& scan : colors_)
      for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
        const std::span<double> values = table.column(name);
        const int bits = scan.depth.bits();
        if (bits != 0 && least == most) continue;
        for (std::size_t i = scan.first; i < scan.last; ++i)
          values[i] =
              bits == 0 || std::isnan(values[i]) ? std::nan("") : to_16_bits(channel(values[i]), bits);
      }
  }
  static std::uint32_t channel(double value) { return std::uint32_t(std::clamp(value, 0.0, 65535.0)); }

  struct ScanColors {
    std::size_t first, last;
    ColorDepth depth;
  };

  E57File file_;
  std::vector<Data3D> scans_;
  std::vector<ScanColors> colors_;
  std::uint64_t no_returns_ = 0;
};

}  // namespace

bool is_e57(std::string_view head) { return head.starts_with("ASTM-E57"); }

ReadResult read_e57(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  return E57Reader(path).read(progress);
}

}  // namespace sfumato::io
