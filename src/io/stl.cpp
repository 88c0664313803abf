// STL, as programs for printing and metrology write scanned objects: triangles by their corners' places, text
// or binary. Places that several triangles share become one vertex. The normals of facets say what their
// corners say, and are passed over.
#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "core/counted.h"
#include "core/lower_case.h"
#include "io/columns.h"
#include "io/faces.h"
#include "io/file.h"
#include "io/format.h"
#include "io/text_rows.h"

namespace sfumato::io {
namespace {

constexpr std::uint64_t stl_header = 84;  ///< 80 bytes of anything, the number of facets
constexpr std::size_t facet_bytes = 50, normal_bytes = 12;

using Corner = std::array<float, 3>;

/// Three for each facet.
using Corners = std::vector<Corner>;

std::uint64_t facets_of(const File& file) {
  if (file.size() < stl_header) return 0;
  std::uint32_t count = 0;
  std::memcpy(&count, file.read_text(stl_header - sizeof count, sizeof count).data(), sizeof count);
  return count;
}

Corners binary_corners(const File& file, Progress& progress) {
  const std::uint64_t facets = facets_of(file), held = (file.size() - stl_header) / facet_bytes;
  if (facets > held)
    bad_input(file.path(), "header",
              "the file ends after " + counted(held, "facet") + ", expected " + std::to_string(facets) +
                  "; it is cut short, fetch it again");
  constexpr std::size_t step = 1 << 16;
  Corners corners(3 * std::size_t(facets));
  std::vector<std::byte> block;
  for (std::size_t first = 0; first < facets; first += step) {
    progress.check();
    const std::size_t count = std::min<std::size_t>(step, std::size_t(facets) - first);
    block.resize(count * facet_bytes);
    file.read(stl_header + first * facet_bytes, block);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(&corners[3 * (first + i)], block.data() + i * facet_bytes + normal_bytes,
                  3 * sizeof(Corner));
    progress.update(double(first + count) / double(facets), "reading");
  }
  return corners;
}

Corners text_corners(const File& file, Progress& progress) {
  Corners corners;
  LineReader lines(file, 0, 1);
  const auto fail = [&](const std::string& what) {
    bad_input(file.path(), "line " + std::to_string(lines.line_number()), what);
  };
  bool ends = false;
  for (std::string_view line; lines.next(line);) {
    if (lines.line_number() % 65536 == 0) progress.check();
    const char *end = line.data() + line.size(), *at = skip_blanks(line.data(), end), *word_end = at;
    while (word_end < end && !is_blank(*word_end)) ++word_end;
    const std::string word = lower_case(std::string(at, word_end));
    ends = word == "endsolid" || (ends && word.empty());
    if (word == "endloop" && corners.size() % 3 != 0) fail("found a facet of other than three corners");
    if (word != "vertex") continue;
    at = word_end;
    try {
      Corner& corner = corners.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) corner[k] = float(next_number(at, end, "a coordinate"));
    } catch (const LineError& error) {
      fail(std::string(error.what()) + "; the file is damaged, export it again");
    }
  }
  if (!ends) fail("the file ends before its solid; it is cut short, fetch it again");
  if (corners.size() % 3 != 0) fail("found facets of other than three corners");
  return corners;
}

/// The vertices in the order in which the file names them first; returns which one each corner is.
std::vector<std::uint32_t> merge_corners(const Corners& corners, std::vector<Corner>& vertices) {
  std::vector<std::uint32_t> order(corners.size()), vertex_of(corners.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto bits = [&](std::uint32_t i) {
    std::array<std::uint32_t, 3> b;
    for (std::size_t k = 0; k < 3; ++k) {
      const float value = corners[i][k] == 0 ? 0.0f : corners[i][k];  // -0 is 0
      std::memcpy(&b[k], &value, sizeof value);
    }
    return b;
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto first = bits(a), second = bits(b);
    return first != second ? first < second : a < b;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    vertex_of[order[i]] = i > 0 && bits(order[i]) == bits(order[i - 1]) ? vertex_of[order[i - 1]] : order[i];
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    if (vertex_of[i] != i) {
      vertex_of[i] = vertex_of[vertex_of[i]];  // earlier, so numbered already
      continue;
    }
    vertex_of[i] = std::uint32_t(vertices.size());
    vertices.push_back(corners[i]);
  }
  return vertex_of;
}

}  // namespace

bool is_stl(std::string_view head) {
  const std::string text =
      lower_case(std::string(head.substr(std::min(head.find_first_not_of(" \t"), head.size()))));
  return text.starts_with("solid") && text.find("facet") != std::string::npos &&
         text.find('\0') == std::string::npos;
}

ReadResult read_stl(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
  const File file(path);
  const bool is_lines = is_stl(file.read_text(0, 4096));
  if (!is_lines && file.size() < stl_header)
    bad_input(path, "header", "the file ends inside its header; it is cut short, fetch it again");
  const Corners corners = is_lines ? text_corners(file, progress) : binary_corners(file, progress);
  if (corners.empty()) bad_input(path, "facets", "found none; export it with its surface");
  if (corners.size() > std::numeric_limits<std::uint32_t>::max())
    bad_input(path, "facets", "found " + counted(corners.size() / 3, "facet") + ", which are too many");
  std::vector<Corner> vertices;
  const std::vector<std::uint32_t> vertex_of = merge_corners(corners, vertices);
  std::vector<Column> columns;
  for (std::size_t k = 0; k < 3; ++k)
    columns.push_back({std::string(1, "xyz"[k]), StoredType::float32, StoredType::float32, k * sizeof(float),
                       sizeof(Corner)});
  assign_roles(columns);
  ReadResult result;
  CloudBuilder builder(columns, vertices.size(), false, options.faces != nullptr);
  std::vector<CloudBuilder::Cursor> cursors{builder.cursor(0, vertices.size())};
  builder.decode(cursors[0], reinterpret_cast<const std::byte*>(vertices.data()), 0, vertices.size(), 0);
  builder.finish(cursors, result);
  result.cloud.provenance = Provenance::model;
  if (options.faces)
    take_faces(file, options, result, [&] {
      FaceBuilder faces(result.cloud, kept_vertices(result.cloud, vertices.size()));
      for (std::size_t i = 0; i < corners.size(); i += 3)
        faces.add({{vertex_of[i], vertex_of[i + 1], vertex_of[i + 2]}, {}, {}},
                  [&] { return "facet " + std::to_string(i / 3 + 1); });
      return std::move(faces.faces);
    });
  return result;
}

}  // namespace sfumato::io
