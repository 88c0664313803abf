// Messages of a page as edits of a view model, and its state as JSON.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "view/view_model.h"

namespace sfumato::serve {

/// The drag under way, and what else the last message was about.
struct Hand {
  view::Drag drag = view::Drag::none;
  dvec3 grabbed{0};
  std::uint64_t confirmed = 0;  ///< the picture that the page has shown
  bool wants_command = false;
  bool pointed = false;          ///< the last message moved the pointer
  std::optional<dvec3> pointer;  ///< the place under it; nothing: it left
};

/// Limits of what a page may ask for.
struct Limits {
  int side_px = 4096;         ///< of a picture in the page
  int saved_side_px = 16384;  ///< of a picture to keep
  std::size_t path_keys = 1000, draw_rows = 100;
};

/// The options of colours, by what the page calls them.
inline const std::map<std::string, const char*> color_options{{"colormap", "colormap"},
                                                              {"color_range", "color-range"},
                                                              {"exposure", "exposure"},
                                                              {"point_color", "color"},
                                                              {"background_color", "background-color"}};

/// Does what one message asks. Throws Error(usage) for what is no message of ours; what the view model
/// refuses, it says itself.
void obey(view::ViewModel& model, Hand& hand, std::string_view text, const Limits& limits);

/// What panels show, in parts that are sent when they change.
nlohmann::ordered_json state_of(const view::ViewModel& model);

/// Of a server, for programs.
nlohmann::ordered_json info_of(const view::ViewModel& model);

/// A camera as the page calculates with it.
nlohmann::ordered_json camera_json(const Camera& camera);

}  // namespace sfumato::serve
