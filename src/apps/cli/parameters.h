// The chosen techniques and their parameters as options of the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "command_line.h"
#include "session/look.h"
#include "techniques/choose.h"

namespace sfumato::cli {

/// A technique of the command line.
struct ChosenTechnique : Look {
  using Look::Look;
  std::size_t place = 0;   ///< in the list on the command line
  bool candidate = false;  ///< of `auto`: one of several with the same place, until `settle`
  std::string reason;      ///< why `auto` chose it
  float surface_share = 1, line_share = 0;  ///< what it saw
};

struct Choice {
  std::vector<std::unique_ptr<ChosenTechnique>> techniques;  ///< of `auto`, every candidate until `settle`
  std::size_t count = 0;                                     ///< of techniques that will be drawn
  std::vector<std::pair<std::string, std::string>> given;    ///< options of the line, which `auto` must have
  analysis::PrepareOptions prepare;
  ParamList prepare_parameters;

  /// `names`: A,B,C, where `auto` stands for what suits the scan. Throws Error(usage) naming the nearest technique.
  explicit Choice(const std::string& names);
  /// --parameter and --technique.parameter for every parameter.
  void declare(CommandLine& line);
  bool automatic() const { return techniques.size() != count; }
  std::vector<const Look*> looks() const;
  /// Leaves of `auto` the technique that suits the scan, among those that have all parameters `given` on the line.
  void settle(const TechniqueChoice& found);

 private:
  std::vector<Param*> find(const std::string& name);
};

inline constexpr const char* automatic_technique = "auto";
inline std::string default_technique() { return automatic_technique; }
/// A parameter as an option; one that is true or false may stand alone.
void declare_parameter(CommandLine& line, const Param& param, const std::string& name, bool hidden,
                       std::function<void(const std::string&)> apply);
/// "FLOAT [0.1, 64] = 1": kind, range or choices, default.
std::string describe_values(const Param& param);

}  // namespace sfumato::cli
