#include "io/georeference.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.h"
#include "io/atomic_writer.h"

namespace sfumato::io {
namespace {

/// The code of the outermost AUTHORITY["EPSG","n"] or ID["EPSG",n] of a part of a WKT; 0: none.
int epsg_of_part(const std::string& part) {
  int depth = 0, code = 0;
  for (std::size_t i = 0; i < part.size(); ++i) {
    depth += part[i] == '[' ? 1 : part[i] == ']' ? -1 : 0;
    if (depth != 1) continue;
    for (const std::string keyword : {"AUTHORITY[\"EPSG\",", "ID[\"EPSG\","})
      if (part.compare(i, keyword.size(), keyword) == 0) {
        std::size_t number = i + keyword.size();
        number += part[number] == '"';
        code = std::atoi(part.c_str() + number);
      }
  }
  return code;
}

struct ReferenceSystem {
  int epsg = 0;  ///< 0: not known
  bool is_geographic = false;
};

ReferenceSystem system_of(const std::string& crs) {
  if (crs.starts_with("EPSG:")) {
    const int code = std::atoi(crs.c_str() + 5);
    return {code, code >= 4000 && code < 5000};
  }
  for (const char* keyword : {"PROJCS[", "PROJCRS[", "GEOGCS[", "GEOGCRS["}) {
    const std::size_t start = crs.find(keyword);
    if (start == std::string::npos) continue;
    int depth = 0;
    std::size_t end = start;
    for (; end < crs.size(); ++end) {
      depth += crs[end] == '[' ? 1 : crs[end] == ']' ? -1 : 0;
      if (crs[end] == ']' && depth == 0) break;
    }
    return {epsg_of_part(crs.substr(start, end - start + 1)), keyword[0] == 'G'};
  }
  return {};
}

/// One entry of a TIFF directory; values of more than four bytes stand elsewhere.
struct Entry {
  std::uint16_t tag, type;
  std::uint32_t count;
  std::vector<std::uint8_t> bytes;
};

template <class T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
  bytes.insert(bytes.end(), raw, raw + sizeof value);
}

enum Type : std::uint16_t { ascii = 2, short_ = 3, long_ = 4, rational = 5, double_ = 12 };

template <class T>
Entry entry(std::uint16_t tag, Type type, const std::vector<T>& values) {
  Entry out{tag, type, std::uint32_t(values.size()), {}};
  for (const T& value : values) append(out.bytes, value);
  return out;
}

Entry text_entry(std::uint16_t tag, const std::string& text) {
  Entry out{tag, ascii, std::uint32_t(text.size() + 1), {text.begin(), text.end()}};
  out.bytes.push_back(0);
  return out;
}

/// Tags and keys of OGC 19-008r4.
void add_place(std::vector<Entry>& entries, const Georeference& g) {
  if (g.b == 0 && g.d == 0) {
    entries.push_back(entry<double>(33550, double_, {g.a, -g.e, 0}));
    entries.push_back(entry<double>(33922, double_, {0, 0, 0, g.c, g.f, 0}));
  } else {
    entries.push_back(
        entry<double>(34264, double_, {g.a, g.b, 0, g.c, g.d, g.e, 0, g.f, 0, 0, 0, 0, 0, 0, 0, 1}));
  }
  const ReferenceSystem system = system_of(g.crs);
  constexpr std::uint16_t user_defined = 32767, pixel_is_area = 1;
  // GDAL takes the WKT of a citation where the model is one that users define.
  const std::uint16_t model = system.epsg == 0 ? user_defined : system.is_geographic ? 2 : 1;
  std::vector<std::uint16_t> keys = {1025, 0, 1, pixel_is_area};
  if (!g.crs.empty()) keys.insert(keys.begin(), {1024, 0, 1, model});
  std::string citation;
  if (system.epsg > 0) {
    keys.insert(keys.end(),
                {std::uint16_t(system.is_geographic ? 2048 : 3072), 0, 1, std::uint16_t(system.epsg)});
  } else if (!g.crs.empty()) {
    citation = "ESRI PE String = " + g.crs + "|";
    keys.insert(keys.end(), {3072, 0, 1, user_defined});
    keys.insert(keys.end(), {3073, 34737, std::uint16_t(std::min<std::size_t>(citation.size(), 65535)), 0});
  }
  std::vector<std::uint16_t> directory = {1, 1, 0, std::uint16_t(keys.size() / 4)};
  directory.insert(directory.end(), keys.begin(), keys.end());
  entries.push_back(entry(34735, short_, directory));
  if (!citation.empty()) entries.push_back(text_entry(34737, citation));
}

}  // namespace

Georeference georeference(const Camera& camera, UpAxis up, const std::string& crs, const std::string& who) {
  if (up != UpAxis::pos_z || !camera.orthographic() || camera.direction().z > -1 + 1e-9)
    throw Error(
        ErrorCode::usage,
        who +
            ": only a plan can be georeferenced; add --view top --camera-orthographic, or --pixel-size "
            "with --view top" +
            (up == UpAxis::pos_z ? "" : ", and --up +Z"));
  const Intrinsics k = camera.whole_intrinsics();
  const dmat4 world = camera.inverse_view();
  const auto at = [&](double x, double y) {
    return dvec3(world * glm::dvec4((x - k.cx) / k.fx, -(y - k.cy) / k.fy, 0, 1));
  };
  const dvec3 origin = at(0, 0), column = (at(camera.width, 0) - origin) / double(camera.width),
              row = (at(0, camera.height) - origin) / double(camera.height);
  // Nothing that rounding left stands in the way of a picture that is north-up.
  const double none = 1e-9 * glm::length(column);
  const auto clean = [&](double v) { return std::abs(v) < none ? 0 : v; };
  return {clean(column.x), clean(row.x), origin.x, clean(column.y), clean(row.y), origin.y, crs};
}

std::filesystem::path world_file_name(const std::filesystem::path& picture) {
  const std::string extension = picture.extension().string();
  if (extension.size() < 3) return picture.string() + ".wld";
  std::filesystem::path name = picture;
  return name.replace_extension(std::string{extension[1], extension.back(), 'w'});
}

void write_world_file(const std::filesystem::path& file, const Georeference& g) {
  std::string text;
  const auto line = [&](double value, int digits) {
    char buffer[32];
    text.append(buffer,
                std::to_chars(buffer, std::end(buffer), value, std::chars_format::general, digits).ptr) +=
        '\n';
  };
  for (const double step : {g.a, g.d, g.b, g.e}) line(step, 12);
  line(g.c + 0.5 * (g.a + g.b), 15);
  line(g.f + 0.5 * (g.d + g.e), 15);
  AtomicWriter writer(file);
  writer.write(text);
  writer.commit();
}

struct TiffRows::State {
  std::string file;
  int width, height, channels;
  double dpi;
  std::optional<Georeference> place;
  std::string description;
  AtomicWriter writer;
  std::vector<std::uint32_t> offsets, sizes;
  std::vector<std::uint8_t> strip, packed;
  int rows_in_strip = 0;
  static constexpr int rows_a_strip = 64;

  void write_bytes(const std::uint8_t* bytes, std::size_t count) {
    if (writer.tell() + count > 0xfffffff0u)
      throw Error(ErrorCode::usage, file + ": a TIFF holds 4 GB; make the picture smaller, or write a .png");
    writer.write(std::as_bytes(std::span(bytes, count)));
  }
  void flush() {
    if (rows_in_strip == 0) return;
    packed.resize(compressBound(uLong(strip.size())));
    uLongf size = uLongf(packed.size());
    if (compress2(packed.data(), &size, strip.data(), uLong(strip.size()), 3) != Z_OK)
      throw Error(ErrorCode::out_of_memory, "cannot write " + file + ": zlib is out of memory");
    offsets.push_back(std::uint32_t(writer.tell())), sizes.push_back(std::uint32_t(size));
    write_bytes(packed.data(), size);
    strip.clear(), rows_in_strip = 0;
  }
  void write_directory();
};

void TiffRows::State::write_directory() {
  const auto whole = [](double v) { return std::uint32_t(std::lround(v)); };
  std::vector<Entry> entries = {
      entry<std::uint32_t>(256, long_, {std::uint32_t(width)}),
      entry<std::uint32_t>(257, long_, {std::uint32_t(height)}),
      entry<std::uint16_t>(258, short_, std::vector<std::uint16_t>(std::size_t(channels), 8)),
      entry<std::uint16_t>(259, short_, {8}),  // Deflate
      entry<std::uint16_t>(262, short_, {2}),  // RGB
      entry<std::uint32_t>(273, long_, offsets),
      entry<std::uint16_t>(277, short_, {std::uint16_t(channels)}),
      entry<std::uint32_t>(278, long_, {std::uint32_t(rows_a_strip)}),
      entry<std::uint32_t>(279, long_, sizes),
      entry<std::uint16_t>(284, short_, {1}),  // channels side by side
  };
  if (!description.empty()) entries.push_back(text_entry(270, description));
  if (dpi > 0) {
    entries.push_back(entry<std::uint32_t>(282, rational, {whole(dpi * 1000), 1000}));
    entries.push_back(entry<std::uint32_t>(283, rational, {whole(dpi * 1000), 1000}));
    entries[entries.size() - 2].count = entries.back().count = 1;
    entries.push_back(entry<std::uint16_t>(296, short_, {2}));  // inch
  }
  if (channels == 4) entries.push_back(entry<std::uint16_t>(338, short_, {2}));  // straight alpha
  if (place) add_place(entries, *place);
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.tag < b.tag; });
  std::vector<std::uint8_t> directory;
  append(directory, std::uint16_t(entries.size()));
  for (Entry& each : entries) {
    if (each.bytes.size() > 4) {
      if (writer.tell() % 2) write_bytes(directory.data(), 1);  // values begin at even bytes
      const auto place_of_values = std::uint32_t(writer.tell());
      write_bytes(each.bytes.data(), each.bytes.size());
      each.bytes.clear();
      append(each.bytes, place_of_values);
    }
    each.bytes.resize(4);
    append(directory, each.tag), append(directory, each.type), append(directory, each.count);
    directory.insert(directory.end(), each.bytes.begin(), each.bytes.end());
  }
  append(directory, std::uint32_t(0));
  if (writer.tell() % 2) write_bytes(directory.data(), 1);
  const auto first = std::uint32_t(writer.tell());
  write_bytes(directory.data(), directory.size());
  writer.seek(4);
  write_bytes(reinterpret_cast<const std::uint8_t*>(&first), 4);
}

TiffRows::TiffRows(const std::filesystem::path& file, int width, int height, bool alpha, double dpi,
                   const std::optional<Georeference>& place, const std::string& description)
    : state_(new State{file.string(),
                       width,
                       height,
                       alpha ? 4 : 3,
                       dpi,
                       place,
                       description,
                       AtomicWriter(file),
                       {},
                       {},
                       {},
                       {}}) {
  const std::uint8_t head[8] = {'I', 'I', 42, 0};
  state_->write_bytes(head, 8);
}
TiffRows::~TiffRows() = default;

void TiffRows::write(const Image<Rgba8>& rows) {
  for (int y = 0; y < rows.height(); ++y) {
    for (int x = 0; x < rows.width(); ++x) {
      const Rgba8& c = rows.at(x, y);
      state_->strip.insert(state_->strip.end(), {c.r, c.g, c.b});
      if (state_->channels == 4) state_->strip.push_back(c.a);
    }
    if (++state_->rows_in_strip == State::rows_a_strip) state_->flush();
  }
}

void TiffRows::finish() {
  state_->flush();
  state_->write_directory();
  state_->writer.commit();
}

}  // namespace sfumato::io
