// What the panels are made of.
#pragma once

#include <imgui.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sfumato::viewer {

/// For the item before it.
void tooltip(const std::string& text);
/// A grey line that wraps.
void note(const std::string& text);
/// A list to choose from; what was chosen, or nothing.
std::optional<std::string> choose(const char* label, const std::string& now,
                                  const std::vector<std::string>& all);
/// 0xRRGGBB.
ImU32 paint(int rgb, float alpha = 1);
/// Light letters on a dark ground, or on red: read on any picture.
void label(ImDrawList* list, ImVec2 at, const std::string& text, bool error = false);
/// A field of text: true when somebody typed another one and left it, by Enter, Tab or a click elsewhere.
bool edit_text(const char* label, const char* hint, std::string& value);
inline float unit(std::uint8_t v) { return float(v) / 255; }

}  // namespace sfumato::viewer
