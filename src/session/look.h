// How a cloud is drawn: one technique with its own settings, as every front end keeps it.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "techniques/technique.h"

namespace sfumato {

/// Parameters, which stay in their list, and a value of each.
using ParamValues = std::vector<std::pair<const Param&, std::string>>;

/// A technique, and one list of all its parameters: its own, then those that all techniques share.
struct Look {
  explicit Look(const TechniqueInfo& info);
  /// Throws Error(usage) naming the nearest technique.
  explicit Look(std::string_view technique_name) : Look(find_technique(technique_name)) {}
  Look(const Look&) = delete;
  Look& operator=(const Look&) = delete;

  /// Sets a parameter by name (underscores or dashes) and value as on the command line. Throws Error(usage)
  /// naming the nearest parameter, or what values are allowed.
  void set(std::string_view parameter, std::string_view value);
  /// Every parameter at its default.
  void reset();
  /// Values of `other` for every parameter that both have; `shared_only`: for those that all techniques
  /// share, so that another technique is seen in the same light.
  void take_over(const Look& other, bool shared_only = false);
  /// Those that are not at their defaults, as `set` takes them.
  std::vector<std::pair<std::string, std::string>> changed() const;
  /// The value of each of `parameters`, as Param::resolved, in a picture by these settings (RenderOutput).
  ParamValues resolved(RenderSettings drawn) const;
  /// Throws Error(usage) for values that contradict each other.
  void check() const;

  std::string name;
  std::unique_ptr<Technique> technique;
  RenderSettings settings;
  ParamList parameters;
  std::size_t own_count = 0;  ///< the first of `parameters` that are the technique's own
};

/// "bool", "int", "float", "choice", "string", "float_list", "vec3".
const char* kind_name(ParamKind kind);
/// The spelling of the command line: "point_size" is "point-size".
std::string with_dashes(std::string name);

}  // namespace sfumato
