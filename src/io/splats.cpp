#include "io/splats.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>

#include <glm/gtc/packing.hpp>

#include "core/counted.h"
#include "io/flat_records.h"
#include "io/format.h"
#include "io/number_at.h"
#include "io/table.h"

namespace sfumato::io {
namespace {

/// Which Gaussian splats are drawn as points. What covers more than it lets through is solid; fainter ones
/// stand for as many points as they cover, by chance that a hash of their number decides (as stochastic
/// transparency does, Enderton et al. 2010); what adds less than a step of 8 bits is nothing, as for their
/// own renderer (Kerbl et al. 2023).
std::vector<std::uint32_t> visible_splats(std::size_t count,
                                          const std::function<double(std::size_t)>& opacity) {
  constexpr double least = 1.0 / 255, solid = 0.5;
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < count; ++i) {
    const double covers = opacity(i);
    auto hash = std::uint32_t(i) * 2654435761u;
    hash = (hash ^ hash >> 15) * 2246822519u;
    if (std::isnan(covers) || (covers >= least && covers / solid * 0x1p32 > double(hash ^ hash >> 13)))
      kept.push_back(std::uint32_t(i));
  }
  return kept;
}

/// `opacity` of a point, 0 to 1.
void leave_out_faint(ReadResult& result, const std::function<double(std::size_t)>& opacity) {
  PointCloud& cloud = result.cloud;
  const std::vector<std::uint32_t> kept = visible_splats(cloud.size(), opacity);
  std::string faint;
  if (const std::size_t left_out = cloud.size() - kept.size(); left_out > 0 && !kept.empty()) {
    cloud = select(cloud, kept);
    result.report.points_finite -= left_out, result.report.points_dropped += left_out;
    const Bounds box = bounds(cloud);
    result.report.bounds_min = box.min, result.report.bounds_max = box.max;
    faint = "; " + counted(left_out, "faint one") + " left out by their opacity";
  }
  result.report.notes.push_back("Gaussian splats: their centres are drawn, in their mean colours (f_dc)" +
                                faint);
}

/// Of what is read of a splat, colours of 0 to 255 and an opacity of 0 to 1.
std::vector<Column> splat_columns() {
  std::vector<Column> columns;
  for (const char* name : {"x", "y", "z", "red", "green", "blue", "opacity"})
    columns.push_back({name, StoredType::float32});
  assign_roles(columns);
  return columns;
}

constexpr std::uint64_t splats_a_chunk = 256;

const PlyElement* chunks_of(const PlyHeader& header) {
  for (const PlyElement& element : header.elements)
    if (element.name == "chunk" && !element.has_list()) return &element;
  return nullptr;
}

int place_of(const PlyElement& element, std::string_view name) {
  for (std::size_t i = 0; i < element.properties.size(); ++i)
    if (element.properties[i].name == name) return int(i);
  return -1;
}

}  // namespace

/// Files of 3D Gaussian splats hold colours as spherical harmonics. The constant term, the same from every
/// side: 1/2 + f_dc / sqrt(4 pi), in sRGB (Kerbl et al. 2023, whose program stores it so).
void color_by_harmonics(ReadResult& result) {
  PointCloud& cloud = result.cloud;
  const ScalarField* terms[] = {cloud.scalar("f_dc_0"), cloud.scalar("f_dc_1"), cloud.scalar("f_dc_2")};
  if (!terms[0] || !terms[1] || !terms[2]) return;
  const auto byte = [&](const ScalarField& term, std::size_t i) {
    const double value = 0.5 + term.value(i) / std::sqrt(4 * std::numbers::pi);
    return std::uint8_t(std::lround(255 * std::clamp(std::isnan(value) ? 0.5 : value, 0.0, 1.0)));
  };
  if (cloud.colors.empty()) {
    cloud.colors.resize(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      cloud.colors[i] = {byte(*terms[0], i), byte(*terms[1], i), byte(*terms[2], i), 255};
  }
  const ScalarField* stored = cloud.scalar("opacity");
  leave_out_faint(result, [stored](std::size_t i) {
    return stored ? 1 / (1 + std::exp(-stored->value(i))) : 1;  // stored as its logit
  });
}

bool are_packed_splats(const PlyHeader& header) {
  const PlyElement& vertex = header.elements[header.vertex];
  return !header.ascii && chunks_of(header) && !vertex.has_list() &&
         place_of(vertex, "packed_position") >= 0 && place_of(vertex, "packed_color") >= 0;
}

ReadResult read_packed_splats(const File& file, const PlyHeader& header, Progress& progress) {
  const PlyElement &chunk = *chunks_of(header), &vertex = header.elements[header.vertex];
  const char* corners[] = {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z"};
  const char* limits[] = {"min_r", "min_g", "min_b", "max_r", "max_g", "max_b"};
  for (const char* name : corners)
    if (place_of(chunk, name) < 0)
      bad_input(file.path(), "header",
                std::string("the chunks of packed splats lack ") + name + "; export it again");
  if (vertex.count > chunk.count * splats_a_chunk || vertex.count > file.size() / vertex.record_size() ||
      chunk.count > file.size() / chunk.record_size())
    bad_input(file.path(), "header",
              "found " + std::to_string(vertex.count) + " splats in " + std::to_string(chunk.count) +
                  " chunks of 256 and " + std::to_string(file.size()) +
                  " bytes; the file is cut short or damaged");
  PlyWalker walker(file, header.big_endian, header.data_begin);
  std::vector<double> boxes;
  Table table(splat_columns(), std::size_t(vertex.count));
  for (const PlyElement& element : header.elements) {
    if (&element == &chunk) {
      for (std::uint64_t i = 0; i < element.count * element.properties.size(); ++i)
        boxes.push_back(walker.number(element.properties[std::size_t(i % element.properties.size())].type));
      continue;
    }
    if (&element != &vertex) {
      if (boxes.empty() || &element < &vertex) walker.skip_element(element, progress);
      continue;
    }
    if (boxes.empty() && vertex.count > 0)
      bad_input(file.path(), "header", "found no chunks in front of packed splats; export it again");
    for (std::size_t i = 0; i < vertex.count; ++i) {
      if (i % 65'536 == 0) progress.check();
      std::uint32_t position = 0, color = 0;
      for (const PlyProperty& property : vertex.properties) {
        const double value = walker.number(property.type);
        const bool fits = value >= 0 && value <= 0xFFFFFFFFp0;
        if (property.name == "packed_position") position = fits ? std::uint32_t(value) : 0;
        if (property.name == "packed_color") color = fits ? std::uint32_t(value) : 0;
      }
      const double* box = boxes.data() + i / splats_a_chunk * chunk.properties.size();
      const auto between = [&](const char* const(&names)[6], std::size_t axis, double share) {
        const double low = box[place_of(chunk, names[axis])], high = box[place_of(chunk, names[axis + 3])];
        return low + share * (high - low);
      };
      const double place[3] = {(position >> 21) / 2047.0, (position >> 11 & 1023) / 1023.0,
                               (position & 2047) / 2047.0};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double share = (color >> (24 - 8 * axis) & 255) / 255.0;
        const double value = place_of(chunk, limits[0]) >= 0 ? between(limits, axis, share) : share;
        table.column(axis)[i] = between(corners, axis, place[axis]);
        table.column(3 + axis)[i] = 255 * std::clamp(value, 0.0, 1.0);
      }
      table.column(6)[i] = (color & 255) / 255.0;
    }
  }
  ReadResult result;
  table.build(false, progress, result);
  result.cloud.up = header.up, result.cloud.up_is_known = header.says_up;
  const ScalarField* opacity = result.cloud.scalar("opacity");
  leave_out_faint(result, [opacity](std::size_t i) { return opacity->value(i); });
  return result;
}

ReadResult read_splat(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  constexpr std::size_t record = 32, color = 24;
  const File file(path);
  if (file.size() % record != 0)
    bad_input(path, "byte " + std::to_string(file.size()),
              "the file ends inside a splat of 32 bytes; it is cut short or of another layout");
  std::vector<Column> columns;
  const char* names[] = {"x", "y", "z", "red", "green", "blue"};
  for (std::size_t k = 0; k < 6; ++k) {
    const StoredType type = k < 3 ? StoredType::float32 : StoredType::uint8;
    columns.push_back({names[k], type, type, k < 3 ? 4 * k : color + k - 3, record});
  }
  columns.push_back({"opacity", StoredType::uint8, StoredType::uint8, color + 3, record});
  assign_roles(columns);
  const auto rows = std::size_t(file.size() / record);
  ReadResult result = read_flat_records(file, std::move(columns), rows, record, progress);
  result.cloud.up = UpAxis::neg_y;  // of the cameras that they were trained on, as their viewers show them
  const ScalarField* opacity = result.cloud.scalar("opacity");
  leave_out_faint(result, [opacity](std::size_t i) { return opacity->value(i) / 255; });
  return result;
}

namespace {

/// A part of a .ksplat file: the numbers of splats in its last buckets, the centres of all buckets, the
/// splats.
struct SplatSection {
  std::uint64_t splats = 0, stored = 0, bucket_size = 0, buckets = 0, bucket_bytes = 0, full = 0, partial = 0,
                record = 0, begin = 0;
  double step = 0;   ///< of a place
  double least = 0;  ///< the step that is the centre
  std::uint64_t first_bucket() const { return begin + 4 * partial; }
  std::uint64_t first_splat() const { return first_bucket() + bucket_bytes * buckets; }
  std::uint64_t end() const { return first_splat() + record * stored; }
};

std::vector<SplatSection> sections_of(const File& file, std::size_t& level) {
  constexpr std::uint64_t head_bytes = 4096, section_bytes = 1024, most_sections = 4096;
  const auto refuse = [&](std::uint64_t byte, const std::string& what) {
    bad_input(file.path(), "byte " + std::to_string(byte),
              what + "; the file is cut short or of another layout");
  };
  if (file.size() < head_bytes) refuse(file.size(), "the file ends inside its header of 4096 bytes");
  std::vector<std::byte> head(head_bytes);
  file.read(0, head);
  const auto most = number_at<std::uint32_t>(head.data() + 4),
             used = number_at<std::uint32_t>(head.data() + 8);
  level = number_at<std::uint16_t>(head.data() + 20);
  if (number_at<std::uint8_t>(head.data()) != 0 || level > 2 || used > most || most > most_sections ||
      head_bytes + most * section_bytes > file.size())
    refuse(0, "found no header of version 0, compression 0 to 2 and sections inside the file");
  std::vector<SplatSection> sections;
  std::uint64_t begin = head_bytes + most * section_bytes;
  for (std::uint32_t i = 0; i < used; ++i) {
    std::vector<std::byte> bytes(section_bytes);
    const std::uint64_t at = head_bytes + i * section_bytes;
    file.read(at, bytes);
    const auto whole = [&](std::size_t k) {
      return std::uint64_t(number_at<std::uint32_t>(bytes.data() + 4 * k));
    };
    SplatSection section{whole(0), whole(1), whole(2), whole(3), number_at<std::uint16_t>(bytes.data() + 20),
                         whole(8), whole(9)};
    // Place, scale, rotation, colour, and the coefficients of three channels.
    constexpr std::uint64_t of_level[] = {44, 24, 24}, of_coefficient[] = {4, 2, 1},
                            coefficients[] = {0, 9, 24, 45};
    const std::uint64_t degree = std::min<std::uint64_t>(number_at<std::uint16_t>(bytes.data() + 40), 3);
    section.record = of_level[level] + of_coefficient[level] * coefficients[degree];
    section.begin = begin;
    const double range = whole(6) ? double(whole(6)) : 32767;
    section.step = 0.5 * double(number_at<float>(bytes.data() + 16)) / range, section.least = range;
    if (section.splats > section.stored || section.partial > section.buckets ||
        section.full > section.buckets ||
        (level > 0 && section.splats > 0 && (section.bucket_bytes < 12 || section.bucket_size == 0)) ||
        section.end() > file.size())
      refuse(at, "found a section of " + std::to_string(section.stored) + " splats that ends at byte " +
                     std::to_string(section.end()) + " of " + std::to_string(file.size()));
    begin = section.end();
    sections.push_back(section);
  }
  return sections;
}

}  // namespace

ReadResult read_ksplat(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  const File file(path);
  std::size_t level = 0;
  const std::vector<SplatSection> sections = sections_of(file, level);
  std::size_t rows = 0;
  for (const SplatSection& section : sections) rows += std::size_t(section.splats);
  Table table(splat_columns(), rows);
  std::size_t row = 0;
  const std::size_t color_at = level == 0 ? 40 : 20;
  for (const SplatSection& section : sections) {
    std::vector<std::byte> head(std::size_t(section.first_splat() - section.begin));
    file.read(section.begin, head);
    std::vector<std::uint64_t> ends;  // of the buckets, in splats
    for (std::uint64_t i = 0; level > 0 && i < section.buckets; ++i) {
      const std::uint64_t last = i - section.full;
      ends.push_back((ends.empty() ? 0 : ends.back()) +
                     (i < section.full         ? section.bucket_size
                      : last < section.partial ? number_at<std::uint32_t>(head.data() + std::size_t(4 * last))
                                               : 0));
    }
    if (level > 0 && section.splats > 0 && (ends.empty() || ends.back() < section.splats))
      bad_input(path, "byte " + std::to_string(section.begin),
                "found more splats than the buckets hold; the file is damaged");
    std::size_t bucket = 0;
    constexpr std::uint64_t step = 1 << 14;
    for (std::uint64_t at = 0; at < section.splats; at += step) {
      progress.check();
      const std::uint64_t count = std::min(step, section.splats - at);
      std::vector<std::byte> records(std::size_t(count * section.record));
      file.read(section.first_splat() + at * section.record, records);
      for (std::size_t i = 0; i < count; ++i, ++row) {
        const std::size_t from = i * std::size_t(section.record);
        while (level > 0 && at + i >= ends[bucket]) ++bucket;
        const std::size_t center = std::size_t(4 * section.partial + bucket * section.bucket_bytes);
        for (std::size_t axis = 0; axis < 3; ++axis)
          table.column(axis)[row] =
              level == 0 ? number_at<float>(records.data() + from + 4 * axis)
                         : (number_at<std::uint16_t>(records.data() + from + 2 * axis) - section.least) *
                                   section.step +
                               number_at<float>(head.data() + center + 4 * axis);
        for (std::size_t k = 0; k < 4; ++k)
          table.column(3 + k)[row] =
              double(number_at<std::uint8_t>(records.data() + from + color_at + k)) / (k < 3 ? 1 : 255);
      }
    }
  }
  ReadResult result;
  table.build(false, progress, result);
  result.cloud.up = UpAxis::neg_y;  // as read_splat
  const ScalarField* opacity = result.cloud.scalar("opacity");
  leave_out_faint(result, [opacity](std::size_t i) { return opacity->value(i); });
  return result;
}

bool is_spz(std::string_view head) { return head.starts_with("NGSP"); }

ReadResult read_spz(const std::filesystem::path& path, const ReadOptions&, Progress& progress) {
  constexpr std::uint64_t header_bytes = 16;
  const File file(path);
  std::vector<std::byte> header(header_bytes);
  if (file.size() < header_bytes)
    bad_input(path, "byte " + std::to_string(file.size()), "the file ends inside its header of 16 bytes");
  file.read(0, header);
  const auto version = number_at<std::uint32_t>(header.data() + 4);
  const std::uint64_t count = number_at<std::uint32_t>(header.data() + 8);
  const auto fraction_bits = number_at<std::uint8_t>(header.data() + 13);
  if (version < 1 || version > 3)
    bad_input(path, "byte 4",
              "found version " + std::to_string(version) + " of SPZ, expected 1 to 3; export it as PLY");
  if (version > 1 && fraction_bits > 23)
    bad_input(path, "byte 13",
              "found places with " + std::to_string(fraction_bits) +
                  " bits of 24 behind the point; the file is damaged");
  // All places, then all opacities, all colours; scales, rotations and harmonics are not read.
  const std::uint64_t place_bytes = version == 1 ? 6 : 9;
  if (count > (file.size() - header_bytes) / (place_bytes + 4))
    bad_input(path, "byte 8",
              "found " + std::to_string(count) + " splats in " + std::to_string(file.size()) +
                  " bytes; the file is cut short or damaged");
  Table table(splat_columns(), std::size_t(count));
  std::vector<std::byte> bytes(std::size_t(count * (place_bytes + 4)));
  file.read(header_bytes, bytes);
  const std::byte *places = bytes.data(), *opacities = places + count * place_bytes,
                  *colors = opacities + count;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 65'536 == 0) progress.check();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::byte* place = places + i * place_bytes + axis * place_bytes / 3;
      if (version == 1) {
        table.column(axis)[i] = double(glm::unpackHalf1x16(number_at<std::uint16_t>(place)));
      } else {
        std::uint32_t step = 0;
        std::memcpy(&step, place, 3);
        table.column(axis)[i] = std::ldexp(double(std::int32_t(step << 8) >> 8), -fraction_bits);
      }
      // The constant term in 256 steps from -.5/.15 to .5/.15.
      constexpr double range = 0.15;
      const double term = (double(colors[3 * i + axis]) / 255 - 0.5) / range;
      table.column(3 + axis)[i] = 255 * std::clamp(0.5 + term / std::sqrt(4 * std::numbers::pi), 0.0, 1.0);
    }
    table.column(6)[i] = double(opacities[i]) / 255;
  }
  ReadResult result;
  table.build(false, progress, result);
  result.cloud.up = UpAxis::pos_y;  // axes to the right, upwards and back, says the format
  const ScalarField* opacity = result.cloud.scalar("opacity");
  leave_out_faint(result, [opacity](std::size_t i) { return opacity->value(i); });
  return result;
}

}  // namespace sfumato::io
