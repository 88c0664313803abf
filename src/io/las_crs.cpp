// Coordinate reference systems of LAS files: WKT records (2112) and GeoTIFF keys (34735, 34737).
#include <algorithm>
#include <charconv>
#include <optional>

#include "io/las_header.h"

namespace sfumato::io::las {
namespace {

constexpr std::uint16_t key_citation = 1026, key_geographic = 2048, key_projected = 3072,
                        key_projected_citation = 3073, key_vertical = 4096;
constexpr std::uint16_t record_keys = 34735, record_ascii = 34737, record_wkt = 2112;

std::string text_in(const Vlr& vlr) {
  return {vlr.data.begin(), std::find(vlr.data.begin(), vlr.data.end(), std::uint8_t{0})};
}

struct GeoKey {
  std::uint16_t id, location, count, value;
};

std::vector<GeoKey> geo_keys(const Vlr& vlr) {
  std::vector<GeoKey> keys;
  for (std::size_t byte = 8; byte + 8 <= vlr.data.size(); byte += 8) {
    const std::uint8_t* b = vlr.data.data() + byte;
    keys.push_back({get<std::uint16_t>(b), get<std::uint16_t>(b + 2), get<std::uint16_t>(b + 4),
                    get<std::uint16_t>(b + 6)});
  }
  return keys;
}

// EPSG codes are 1024 to 32766; 0 means undefined and 32767 user-defined.
bool is_epsg(unsigned code) { return code >= 1024 && code <= 32766; }

std::string epsg_text(const std::vector<GeoKey>& keys) {
  auto code = [&](std::uint16_t id) {
    for (const GeoKey& key : keys)
      if (key.id == id && key.location == 0 && is_epsg(key.value)) return unsigned(key.value);
    return 0u;
  };
  const bool user_defined = std::any_of(keys.begin(), keys.end(), [](const GeoKey& key) {
    return key.id == key_projected && key.location == 0 && key.value == 32767;
  });
  const unsigned horizontal = code(key_projected) ? code(key_projected)
                              : user_defined      ? 0
                                                  : code(key_geographic);
  if (!horizontal) return {};
  std::string text = "EPSG:" + std::to_string(horizontal);
  if (const unsigned vertical = code(key_vertical)) text += "+" + std::to_string(vertical);
  return text;
}

std::string citation_text(const std::vector<GeoKey>& keys, const Vlr& ascii) {
  for (std::uint16_t id : {key_projected_citation, key_citation})
    for (const GeoKey& key : keys)
      if (key.id == id && key.location == record_ascii && key.value < ascii.data.size()) {
        const auto first = ascii.data.begin() + key.value;
        const auto last = first + std::min<std::ptrdiff_t>(key.count, ascii.data.end() - first);
        std::string text(first, last);
        return text.substr(0, text.find_first_of(std::string("|\0", 2)));
      }
  return {};
}

struct Epsg {
  unsigned horizontal = 0, vertical = 0;
};

std::optional<Epsg> parse_epsg(const std::string& crs) {
  if (!crs.starts_with("EPSG:")) return std::nullopt;
  Epsg epsg;
  const char* end = crs.data() + crs.size();
  auto result = std::from_chars(crs.data() + 5, end, epsg.horizontal);
  if (result.ec != std::errc()) return std::nullopt;
  if (result.ptr != end && *result.ptr == '+') result = std::from_chars(result.ptr + 1, end, epsg.vertical);
  if (result.ptr != end || !is_epsg(epsg.horizontal) || (epsg.vertical && !is_epsg(epsg.vertical)))
    return std::nullopt;
  return epsg;
}

std::vector<std::uint8_t> key_directory(const std::vector<GeoKey>& keys) {
  std::vector<std::uint8_t> data(8 + 8 * keys.size());
  const std::uint16_t head[4] = {1, 1, 0, std::uint16_t(keys.size())};
  std::memcpy(data.data(), head, sizeof head);
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const std::uint16_t words[4] = {keys[i].id, keys[i].location, keys[i].count, keys[i].value};
    std::memcpy(data.data() + 8 + 8 * i, words, sizeof words);
  }
  return data;
}

}  // namespace

std::string read_crs(const Header& header) {
  const Vlr* wkt = header.vlr("LASF_Projection", record_wkt);
  const bool wkt_bit = (header.global_encoding & 16) != 0;
  if (wkt_bit && wkt) return text_in(*wkt);
  std::vector<GeoKey> keys;
  if (const Vlr* directory = header.vlr("LASF_Projection", record_keys)) keys = geo_keys(*directory);
  if (std::string epsg = epsg_text(keys); !epsg.empty()) return epsg;
  if (wkt) return text_in(*wkt);
  if (const Vlr* liblas = header.vlr("liblas", record_wkt)) return text_in(*liblas);
  if (const Vlr* ascii = header.vlr("LASF_Projection", record_ascii)) return citation_text(keys, *ascii);
  return {};
}

std::vector<CrsRecord> crs_records(const std::string& crs, bool& is_wkt) {
  is_wkt = false;
  if (crs.empty()) return {};
  if (const std::optional<Epsg> epsg = parse_epsg(crs)) {
    // EPSG numbers geographic systems 4000 to 4999 (and a few since); GeoTIFF wants to know which kind it is.
    const bool geographic = epsg->horizontal >= 4000 && epsg->horizontal < 5000;
    std::vector<GeoKey> keys{{1024, 0, 1, std::uint16_t(geographic ? 2 : 1)}};
    keys.push_back({geographic ? key_geographic : key_projected, 0, 1, std::uint16_t(epsg->horizontal)});
    if (epsg->vertical) keys.push_back({key_vertical, 0, 1, std::uint16_t(epsg->vertical)});
    return {{record_keys, key_directory(keys)}};
  }
  std::vector<std::uint8_t> text(crs.begin(), crs.end());
  text.push_back(0);
  if (crs.find('[') != std::string::npos) {
    is_wkt = true;
    return {{record_wkt, std::move(text)}};
  }
  text.insert(text.end() - 1, '|');
  const GeoKey citation{key_citation, record_ascii,
                        std::uint16_t(std::min<std::size_t>(text.size() - 1, 65535)), 0};
  return {{record_keys, key_directory({citation})}, {record_ascii, std::move(text)}};
}

}  // namespace sfumato::io::las
