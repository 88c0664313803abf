// Controls made from a list of parameters: no parameter is written a second time for a panel.
#pragma once

#include <string>
#include <vector>

#include "core/option_text.h"
#include "session/look.h"

namespace sfumato::view {

struct Control {
  std::string name;     ///< of the parameter, as Look::set takes it
  std::string label;    ///< "hidden point removal"
  std::string group;    ///< heading in a panel
  std::string tooltip;  ///< help, unit, paper symbol, the option on a command line
  ParamKind kind = ParamKind::real;
  std::vector<std::string> choices;
  double low = 0, high = 1;  ///< of the slider; what may be typed is `limit_low` to `limit_high`
  double limit_low = -1e30, limit_high = 1e30;
  bool logarithmic = false;  ///< the slider spans more than two powers of ten
  bool can_be_auto = false, is_auto = false, is_changed = false;
  std::string value;  ///< as text; what `auto` became where `is_auto` and it is known
  std::string default_value;
};

/// Those whose name, help or symbol contain every word of `search` (any, when it is empty), in the order of
/// the list. The technique's own stand first, in its group; the others are of "Light", "Shadows", "Eye-dome
/// lighting" and "Picture".
std::vector<Control> controls_of(const Look& look, const std::string& search = {});
std::vector<Control> controls_of(const ParamList& parameters, const std::string& group,
                                 const std::string& search = {});

using sfumato::number_text;
/// The numbers of "1,2,3"; empty for a text that holds none.
std::vector<float> numbers_of(const std::string& text);

}  // namespace sfumato::view
