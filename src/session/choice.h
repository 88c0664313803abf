// The techniques that somebody asks for, with their parameters, and what becomes of `auto`.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/prepare.h"
#include "session/look.h"
#include "techniques/choose.h"

namespace sfumato {

/// A technique that is asked for.
struct ChosenTechnique : Look {
  using Look::Look;
  std::size_t place = 0;    ///< in the list of names
  bool candidate = false;   ///< of `auto`: one of several with the same place, until `resolve`
  bool of_auto = false;     ///< before and after it
  std::string reason;       ///< why `auto` chose it
  float surface_share = 1;  ///< what it saw
};

struct Choice {
  std::vector<std::unique_ptr<ChosenTechnique>> techniques;   ///< of `auto`, every candidate until `resolve`
  std::vector<std::unique_ptr<ChosenTechnique>> passed_over;  ///< by `resolve`
  std::size_t count = 0;                                      ///< of techniques that will be drawn
  std::vector<std::pair<std::string, std::string>> given;     ///< names and values, which `auto` must have
  analysis::PrepareOptions prepare;
  ParamList prepare_parameters;

  /// `names`: A,B,C, where `auto` stands for what suits the scan. Throws Error(usage) naming the nearest
  /// technique.
  explicit Choice(const std::string& names);
  Choice(const Choice&) = delete;
  Choice& operator=(const Choice&) = delete;
  bool automatic() const { return techniques.size() != count; }
  std::vector<const Look*> looks() const;
  /// Leaves of `auto` the technique that suits the scan, among those that have all parameters `given`.
  void resolve(const TechniqueChoice& found);
  /// Takes that back, for another scan.
  void reopen();
  /// What any of the techniques needs.
  Attributes needs() const;
  /// The parameters of that name: of the techniques that have it, and of the analysis.
  std::vector<Param*> find(const std::string& name);
};

inline constexpr const char* automatic_technique = "auto";
inline std::string default_technique() { return automatic_technique; }
/// "points, splats": the techniques that have a parameter, with underscores or dashes, maybe qualified by a
/// technique. Empty when none has.
std::string techniques_with(const std::string& parameter);

}  // namespace sfumato
