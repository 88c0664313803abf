#include "techniques/tiles.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace sfumato {
namespace {

constexpr const char* mark = " (in the busiest tile)";

std::string without_numbers(std::string text) {
  if (text.ends_with(mark)) text.resize(text.size() - std::string(mark).size());
  std::erase_if(text, [](unsigned char c) { return std::isdigit(c); });
  return text;
}

double first_number(const std::string& text) {
  const std::size_t at = text.find_first_of("0123456789");
  return at == std::string::npos ? 0 : std::atof(text.c_str() + at);
}

}  // namespace

std::vector<TileSpan> tile_spans(int size, int side, int overlap) {
  const auto up = [](int px) { return (px + tile_grid - 1) / tile_grid * tile_grid; };
  const int count = (size + side - 1) / side;
  const int step = up((size + count - 1) / count);  // all of about one size
  std::vector<TileSpan> spans;
  for (int first = 0; first < size; first += step) {
    const int last = std::min(first + step, size);
    spans.push_back({first, last, std::max(0, first - up(overlap)), std::min(size, last + up(overlap))});
  }
  return spans;
}

void add_tile_notes(std::vector<std::string>& all, const std::vector<std::string>& of_tile) {
  for (const std::string& note : of_tile) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const std::string& other) {
      return without_numbers(other) == without_numbers(note);
    });
    if (same == all.end()) {
      all.push_back(note);
    } else if (*same != note && *same != note + mark) {
      if (first_number(note) > first_number(*same)) *same = note;
      if (!same->ends_with(mark)) *same += mark;
    }
  }
}

}  // namespace sfumato
