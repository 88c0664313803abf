// The chosen techniques and their parameters as options of the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/prepare.h"
#include "command_line.h"
#include "techniques/technique.h"

namespace sfumato::cli {

/// One technique with its own settings, and one list of all its parameters: its own, then the shared ones.
struct ChosenTechnique {
  explicit ChosenTechnique(const TechniqueInfo& info);
  ChosenTechnique(const ChosenTechnique&) = delete;
  ChosenTechnique& operator=(const ChosenTechnique&) = delete;

  std::string name;
  std::unique_ptr<Technique> technique;
  RenderSettings settings;
  ParamList parameters;
  std::size_t own_count = 0;  ///< the first of `parameters` that are the technique's own
};

struct Choice {
  std::vector<std::unique_ptr<ChosenTechnique>> techniques;
  analysis::PrepareOptions prepare;
  ParamList prepare_parameters;

  /// `names`: A,B,C. Throws Error(usage) naming the nearest technique.
  explicit Choice(const std::string& names);
  /// --parameter and --technique.parameter for every parameter.
  void declare(CommandLine& line);

 private:
  std::vector<Param*> find(const std::string& name);
};

/// `surface` where it exists, else `points`.
std::string default_technique();
/// A parameter as an option; one that is true or false may stand alone.
void declare_parameter(CommandLine& line, const Param& param, const std::string& name, bool hidden,
                       std::function<void(const std::string&)> apply);
/// "FLOAT [0.1, 64] = 1": kind, range or choices, default.
std::string describe_values(const Param& param);
/// bool, int, float, choice, string, float_list, vec3.
const char* kind_name(ParamKind kind);
std::string with_dashes(std::string name);

}  // namespace sfumato::cli
