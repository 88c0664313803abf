#include "io/text_columns.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include "io/columns.h"
#include "io/text_dialect.h"

namespace sfumato::io {
namespace {

using Names = std::vector<std::string>;

std::string clean_name(std::string_view word) {
  const auto is_around = [](char c) { return c == '"' || c == '\'' || is_blank(c); };
  while (!word.empty() &&
         (word.front() == '/' || word.front() == '#' || word.front() == '%' || is_around(word.front())))
    word.remove_prefix(1);
  if (const std::size_t unit = word.find_first_of("[("); unit != 0) word = word.substr(0, unit);
  while (!word.empty() && (is_around(word.back()) || word.back() == ')')) word.remove_suffix(1);
  return std::string(word);
}

/// Lower case, with German umlauts spelled out, as UTF-8 or Latin-1 has them.
std::string plain_letters(std::string_view name) {
  std::string plain;
  for (std::size_t i = 0; i < name.size(); ++i) {
    auto c = static_cast<unsigned char>(name[i]);
    const bool is_pair = c == 0xC3 && i + 1 < name.size();
    if (is_pair) c = static_cast<unsigned char>(static_cast<unsigned char>(name[++i]) + 0x40);
    switch (c) {
      case 0xD6:
      case 0xF6: plain += "oe"; break;
      case 0xC4:
      case 0xE4: plain += "ae"; break;
      case 0xDC:
      case 0xFC: plain += "ue"; break;
      default: plain += c < 128 ? char(std::tolower(c)) : '_';
    }
  }
  return plain;
}

/// What is left of a name without the words that programs put beside an axis: units, kinds of coordinates,
/// the thing whose place it is. `Points_m_XYZ:0` leaves 0, `POINT_X` x, `Ellipsoidal height` height.
std::string core_of(std::string_view name) {
  static const std::set<std::string_view> beside = {
      "m",        "ft",        "meter", "meters", "metre",      "metres",      "feet",        "utm",
      "wgs84",    "etrs89",    "coord", "coords", "coordinate", "coordinates", "koordinate",  "pos",
      "position", "positions", "point", "points", "xyz",        "loc",         "location",    "local",
      "world",    "map",       "lidar", "laser",  "cartesian",  "ellipsoidal", "orthometric", "deg",
      "degree",   "degrees",   "dd",    "value",  "wert",       "gps",         "projected",   "grid",
      "vertex",   "center",    "mm",    "cm",     "above",      "datum",       "ellipsoid",   "msl",
      "asl",      "amsl"};
  static const std::string_view glued[] = {"coordinate", "koordinate", "coord", "position",
                                           "cartesian",  "points",     "point", "pos"};
  const std::string plain = plain_letters(name);
  std::string core;
  bool has_more = false;
  for (std::size_t at = 0; at < plain.size();) {
    std::size_t end = at;
    while (end < plain.size() && std::isalnum(static_cast<unsigned char>(plain[end]))) ++end;
    std::string_view word = std::string_view(plain).substr(at, end - at);
    at = end + (end == at);
    if (word.empty()) continue;
    if (beside.contains(word)) {
      has_more = true;
      continue;
    }
    for (const std::string_view part : glued) {
      if (word.size() == part.size() + 1 && word.starts_with(part)) word.remove_prefix(part.size());
      if (word.size() == part.size() + 1 && word.ends_with(part)) word.remove_suffix(part.size());
    }
    core += (core.empty() ? "" : " ") + std::string(word);
  }
  // LONGITUDE_CENTROID is one; `centroid_x` stands beside the axes of something else.
  constexpr std::string_view centroid = " centroid";
  if (core.size() > centroid.size() + 2 && core.ends_with(centroid))
    core.resize(core.size() - centroid.size());
  // Bare numbers are names of pandas, and of anything.
  if (core.size() == 1 && core[0] >= '0' && core[0] <= '2')
    return has_more ? std::string(1, "xyz"[core[0] - '0']) : "";
  return core;
}

/// In the order in which they win.
const Names words_of_axes[3] = {
    {"x", "easting", "east", "e", "rechtswert", "rechts", "ostwert", "ost", "este", "est", "longitude", "lon",
     "lng", "long"},
    {"y", "northing", "north", "n", "hochwert", "hoch", "nordwert", "nord", "norte", "latitude", "lat"},
    {"z", "elevation", "height", "altitude", "elev", "ele", "alt", "h", "hoehe", "hoehenwert", "cota",
     "quota", "altura", "rl", "level"}};
/// What counts downwards, as soundings do; z only where no column is called by one of the words above.
const Names words_of_depth = {"depth", "tiefe", "profondeur", "profundidad"};

/// The names of the axes in place of other words for them. Returns whether z is a depth.
bool use_names_of_axes(Names& names) {
  Names low = names, cores;
  for (std::string& name : low) {
    cores.push_back(core_of(name));
    for (char& c : name) c = char(std::tolower(static_cast<unsigned char>(c)));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string own(1, "xyz"[axis]);
    if (std::find(low.begin(), low.end(), own) != low.end()) continue;
    const auto use_where = [&](const auto& is_meant) {
      const auto found = std::find_if(cores.begin(), cores.end(), is_meant);
      if (found != cores.end()) names[std::size_t(found - cores.begin())] = own;
      return found != cores.end();
    };
    const auto use_one_of = [&](const Names& words) {
      return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return use_where([&](const std::string& core) { return core == word; });
      });
    };
    if (use_one_of(words_of_axes[axis]) || axis < 2) continue;
    return use_one_of(words_of_depth) || use_where([&](const std::string& core) {  // seabed depth
             return std::any_of(words_of_depth.begin(), words_of_depth.end(),
                                [&](const std::string& word) { return core.ends_with(" " + word); });
           });
  }
  return false;
}

bool has_axes(const Names& names) {
  std::vector<Column> columns;
  for (const std::string& name : names) columns.push_back({name});
  return assign_roles(columns);
}

/// The names between separators; without one, between blanks and any of them.
Names cells_of(std::string_view line, char separator) {
  Names names;
  if (separator == ' ') {
    for (const std::string_view word : split(line))
      if (std::string name = clean_name(word); !name.empty()) names.push_back(std::move(name));
    return names;
  }
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator, at), line.size());
    names.push_back(clean_name(line.substr(at, end - at)));
    at = end + 1;
  }
  return names;
}

/// Words of sentences, which remarks in front of the numbers are.
bool is_prose(const Names& names) {
  static const std::set<std::string_view> words = {"in",  "of", "the", "and", "with", "as",
                                                   "for", "is", "are", "by",  "from", "to"};
  return std::any_of(names.begin(), names.end(),
                     [](const std::string& name) { return words.contains(name); });
}

/// `# columns: x y z`, `Fields = x y z`: what is named begins behind the word.
std::string_view behind_title(std::string_view line) {
  const std::size_t at = line.find_first_of(":=");
  if (at == std::string_view::npos || at + 1 >= line.size() || !is_blank(line[at + 1])) return line;
  return line.substr(0, at).find_first_of(",;") == std::string_view::npos ? line.substr(at + 1) : line;
}

/// A column of the first lines.
struct Summary {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool is_whole = true, is_complete = true;  ///< whole numbers only; every row has one
  std::size_t distinct = 0;
};

Summary summary_of(const SampleRows& rows, std::size_t column) {
  Summary found;
  std::set<double> values;
  for (const std::vector<double>& row : rows) {
    if (row.size() <= column || !std::isfinite(row[column])) {
      found.is_complete = false;
      continue;
    }
    const double value = row[column];
    found.low = std::min(found.low, value), found.high = std::max(found.high, value);
    found.is_whole = found.is_whole && value == std::floor(value);
    values.insert(value);
  }
  found.distinct = values.size();
  found.is_whole = found.is_whole && !values.empty();
  return found;
}

/// Questions about the columns of the first lines.
class Sample {
 public:
  Sample(const SampleRows& rows, std::size_t width) : rows_(rows) {
    for (std::size_t k = 0; k < width; ++k) columns_.push_back(summary_of(rows, k));
  }
  const Summary& at(std::size_t k) const { return columns_[k]; }
  /// Three columns of whole numbers up to `largest`; each channel of 16 bits passes 255 somewhere, and the
  /// number of a return beside that of all returns, 15 at most, is no colour.
  bool are_colors(std::size_t first, double largest) const {
    for (std::size_t k = first; k < first + 3; ++k) {
      const Summary& c = columns_[k];
      if (!c.is_complete || !c.is_whole || c.low < 0 || c.high > largest || (largest > 255 && c.high <= 255))
        return false;
    }
    return !are_returns(first) && !are_returns(first + 1);
  }
  bool are_fractions(std::size_t first) const {
    for (std::size_t k = first; k < first + 3; ++k)
      if (!columns_[k].is_complete || columns_[k].low < 0 || columns_[k].high > 1) return false;
    return !rows_.empty();
  }
  bool are_normals(std::size_t first) const {
    bool has_unit = false;
    const bool are_all = std::all_of(rows_.begin(), rows_.end(), [&](const std::vector<double>& row) {
      if (row.size() < first + 3) return false;
      const double* v = row.data() + first;
      const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
      const bool is_unit = std::abs(square - 1) < 0.02;
      has_unit = has_unit || is_unit;
      return square == 0 || is_unit || !std::isfinite(square);
    });
    return are_all && has_unit;
  }
  /// Whole numbers of a few kinds, small beside `others` columns from `first` on.
  bool is_label(std::size_t column, std::size_t first, std::size_t others) const {
    const Summary& c = columns_[column];
    if (!c.is_complete || !c.is_whole || c.low < -1 || c.high > 255 || c.distinct > 64) return false;
    double least = others ? std::numeric_limits<double>::infinity() : 256;
    for (std::size_t k = first; k < first + others; ++k) least = std::min(least, columns_[k].high);
    return 4 * c.high < least;
  }

 private:
  bool are_returns(std::size_t column) const {
    constexpr double most_returns = 15;
    const Summary &number = columns_[column], &all = columns_[column + 1];
    return number.low == 1 && all.low >= 1 && all.high <= most_returns && all.high > 1 && rows_.size() > 1 &&
           std::all_of(rows_.begin(), rows_.end(),
                       [&](const std::vector<double>& row) { return row[column] <= row[column + 1]; });
  }
  const SampleRows& rows_;
  std::vector<Summary> columns_;
};

}  // namespace

Naming names_in(std::string_view line, std::size_t width) {
  while (!line.empty() && (is_blank(line.back()) || line.back() == '\n')) line.remove_suffix(1);
  for (const std::string_view text : {line, behind_title(line)})
    for (const char separator : {' ', ';', ',', '\t'}) {
      Names names = cells_of(text, separator);
      if (names.size() != width || (separator == ' ' && is_prose(names))) continue;
      const bool z_is_depth = use_names_of_axes(names);
      std::replace(names.begin(), names.end(), std::string(), std::string("_"));
      return {std::move(names), z_is_depth};
    }
  for (const std::string_view text : {line, behind_title(line)})
    for (const char separator : {';', ',', '\t', ' '}) {
      Names names = cells_of(text, separator);
      const bool z_is_depth = use_names_of_axes(names);
      if (separator == ' ' && names.size() != 3 && (names.size() + 1 != width || is_prose(names))) continue;
      const bool is_list = separator == ' ' || std::count(text.begin(), text.end(), separator) >= 2;
      if (names.size() > width && is_list) names.resize(width);
      if (!is_list || !has_axes(names)) continue;
      std::replace(names.begin(), names.end(), std::string(), std::string("_"));
      return {std::move(names), z_is_depth};
    }
  return {};
}

bool names_degrees(std::string_view line) {
  bool longitude = false, latitude = false;
  for (const char separator : {' ', ';', ',', '\t'})
    for (const std::string& name : cells_of(line, separator)) {
      const std::string core = core_of(name);
      longitude = longitude || core == "longitude" || core == "lon" || core == "lng";
      latitude = latitude || core == "latitude" || core == "lat";
    }
  return longitude && latitude;
}

bool is_running_number(const SampleRows& beginning, const std::vector<double>& end) {
  if (beginning.size() < 3 || beginning[0].size() < 4) return false;
  if (summary_of(beginning, 1).is_whole || summary_of(beginning, 2).is_whole) return false;
  std::vector<double> first;
  for (const std::vector<double>& row : beginning) first.push_back(row[0]);
  const auto never_repeats = [](std::vector<double> numbers) {
    if (!std::ranges::all_of(numbers, [](double n) { return n >= 0 && n == std::floor(n); })) return false;
    std::ranges::sort(numbers);
    return std::ranges::adjacent_find(numbers) == numbers.end();
  };
  if (!never_repeats(first) || !never_repeats(end)) return false;
  // Of a hundred coordinates that are whole some repeat, unless they range over thousands.
  constexpr std::size_t enough = 100;
  if (first.size() >= enough) return true;
  const bool falls = first[1] < first[0];
  const auto goes_on = [&](const std::vector<double>& numbers) {
    return falls ? std::ranges::is_sorted(numbers, std::greater()) : std::ranges::is_sorted(numbers);
  };
  return goes_on(first) && goes_on(end);
}

bool are_pixels(const SampleRows& rows) {
  constexpr double most = 65'536;  // pixels a side
  if (rows.size() < 3 || rows[0].size() < 5) return false;
  for (const std::size_t k : {0, 1, 2, 3, 4}) {
    const Summary column = summary_of(rows, k);
    if (!column.is_complete || column.is_whole != (k < 2)) return false;
    if (k < 2 && (column.low < 0 || column.high >= most)) return false;
    // Heights on a grid of whole metres, with normals or colours.
    if (k > 2 && column.low >= -1 && column.high <= 1) return false;
  }
  const auto goes_on = [&](std::size_t slow, std::size_t fast) {
    return std::ranges::is_sorted(rows, std::less_equal(), [&](const std::vector<double>& row) {
      return std::pair(row[slow], row[fast]);
    });
  };
  return goes_on(0, 1) || goes_on(1, 0);
}

std::vector<std::string> guess_columns(const SampleRows& rows, std::size_t width,
                                       std::vector<std::string> names) {
  const Sample sample(rows, width);
  const std::size_t begin = names.size();
  if (begin < 3) names = {"x", "y", "z"};
  bool color = false, normal = false, intensity = false;
  const auto add = [&](std::initializer_list<const char*> group) {
    names.insert(names.end(), group.begin(), group.end());
  };
  while (names.size() < width) {
    const std::size_t at = names.size(), left = width - at;
    // Bytes of 0 and 1 are hardly colours: unit vectors first.
    const bool normals_here = left >= 3 && !normal && sample.are_normals(at);
    bool added = normals_here;
    if (normals_here) add({"nx", "ny", "nz"}), normal = true;
    for (const double largest : {255.0, 65535.0}) {
      if (left < 3 || color || added) break;
      // x y z i r g b: three of one kind behind one more column are the colour, and the column is the
      // intensity, but for a label at the end.
      const bool here = sample.are_colors(at, largest);
      const bool next = left >= 4 && !intensity && sample.are_colors(at + 1, largest);
      const bool label = left == 4 && here && sample.is_label(at + 3, at, 3);
      if (next && !label && (left == 4 || !here)) break;
      if (here) {
        add({"red", "green", "blue"});
        color = added = true;
      }
    }
    if (added) continue;
    const bool shifted = left >= 4 && !intensity && sample.are_colors(at + 1, 255);
    if (left >= 3 && !color && !shifted && sample.are_fractions(at)) {
      add({"red", "green", "blue"});
      color = true;
    } else if (left == 1 && rows.size() > 1 && (at > 3 || sample.at(at).distinct == 1) &&
               sample.is_label(at, 0, 0)) {  // an intensity that never varies is none
      names.push_back("label");
    } else if (shifted && left == 4 && sample.at(at).distinct > 1 && sample.is_label(at, at + 1, 3)) {
      names.push_back("label");
    } else if (!intensity) {
      names.push_back("intensity");
      intensity = true;
    } else {
      names.push_back("column_" + std::to_string(at + 1));
    }
  }
  return names;
}

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",") + name;
  return text;
}

}  // namespace sfumato::io
