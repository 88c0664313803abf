// A value of each option, other than its default.
#pragma once

#include <map>
#include <string>

#include "session/request.h"

namespace sfumato {

/// Empty for an option that is new here: add one.
inline std::string sample_of(const Option& option) {
  static const std::map<std::string, std::string> samples = {
      {"technique", "surface"},
      {"draw", "class 3-5: soft opacity=0.2"},
      {"quality", "71"},
      {"path", "orbit"},
      {"frames", "12"},
      {"degrees", "90.5"},
      {"transform", "2: 1,0,0,12.5,0,1,0,0,0,0,1,-1,0,0,0,1"},
      {"resolution", "640x360"},
      {"view", "top"},
      {"zoom", "2.5"},
      {"roll", "-10"},
      {"look-at", "500000.125,-1,2"},
      {"distance", "12"},
      {"scale", "1:250"},
      {"dpi", "600"},
      {"pixel-size", "0.05"},
      {"vertical-exaggeration", "3"},
      {"camera-position", "1,2,3"},
      {"camera-focal-point", "1,2,4"},
      {"camera-view-up", "0,1,0"},
      {"camera-direction", "0.1,0.2,-0.3"},
      {"camera-azimuth-angle", "33.3"},
      {"camera-elevation-angle", "-20"},
      {"camera-view-angle", "60"},
      {"crop", "-1.5,0,0,1,1e6,0.1"},
      {"crop-relative", "0,0,0,1,1,0.5"},
      {"show-classes", "2,6"},
      {"hide-classes", "none"},
      {"filter", "gps_time 300000000.25..300000000.5"},
      {"max-points", "250k"},
      {"columns", "x,y,z,intensity"},
      {"up", "-Y"},
      {"memory", "2G"},
      {"gpu-memory", "1G"},
      {"color-by", "elevation"},
      {"color", "steelblue"},
      {"colormap", "turbo"},
      {"color-range", "300000000.25,300000000.5"},
      {"class-colors", "2=#aa7744,building=orange"},
      {"exposure", "2.5"},
      {"background-color", "0.1,0.27,0.333"},
      {"legend-title", "Height, above ground"},
      {"legend-unit", "m"},
      {"legend-place", "top-left"},
      {"legend-size", "1.5"},
      {"title", "Site 4"},
      {"caption", "below"},
      {"unit", "ft"},
      {"depth-unit", "mm"},
  };
  if (option.kind == Option::Kind::flag) return "true";
  if (const auto found = samples.find(option.name()); found != samples.end()) return found->second;
  const bool names_file =
      option.metavar.starts_with("FILE") || option.metavar.starts_with("NAME_") || option.metavar == "FOLDER";
  return names_file ? "some.file" : "";
}

}  // namespace sfumato
