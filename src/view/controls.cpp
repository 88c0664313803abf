#include "view/controls.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include "core/lower_case.h"
#include "core/number_in.h"
#include "core/option_text.h"

namespace sfumato::view {
namespace {

bool matches(const Control& control, const std::string& search) {
  const std::string all =
      lower_case(control.label + " " + control.name + " " + control.tooltip + " " + control.group);
  std::istringstream words(lower_case(search));
  for (std::string word; words >> word;)
    if (all.find(word) == std::string::npos) return false;
  return true;
}

/// The shared parameters by what they do; what is new stands under "Picture" until it has a better place.
std::string shared_group(const std::string& name) {
  if (name.starts_with("shadow") || name.starts_with("light_") || name == "ground") return "Shadows";
  if (name == "light" || name == "ambient" || name == "diffuse" || name == "specular" ||
      name == "shininess" || name == "shading")
    return "Light";
  if (name.starts_with("edl")) return "Eye-dome lighting";
  return "Picture";
}

void set_range(Control& control, const Param& param) {
  double value = 0;
  if (const std::vector<float> numbers = numbers_of(control.value); numbers.size() == 1)
    value = double(numbers[0]);
  if (param.min) control.limit_low = *param.min;
  if (param.max) control.limit_high = *param.max;
  control.low = param.min ? *param.min : std::min(0.0, -4 * std::abs(value));
  // Where nothing ends the range, a slider reaches a few times as far as the value.
  double usual = std::abs(value);
  if (const std::vector<float> numbers = numbers_of(param.default_text); numbers.size() == 1)
    usual = std::max(usual, std::abs(double(numbers[0])));
  control.high = param.max ? *param.max : std::max(control.low, 0.0) + 4 * (usual > 0 ? usual : 1);
  // Limits that guard against nonsense are no range to drag through.
  if (param.max && usual > 0 && *param.max > 50 * usual && param.kind == ParamKind::real)
    control.high = 8 * usual;
  control.high = std::max(control.high, value);
  control.logarithmic = param.kind == ParamKind::real && control.low > 0 && control.high / control.low > 100;
}

Control control_of(const Param& param, const std::string& group) {
  Control control;
  control.name = param.name;
  control.label = param.name;
  std::replace(control.label.begin(), control.label.end(), '_', ' ');
  control.group = group;
  control.kind = param.kind;
  control.choices = param.choices;
  control.can_be_auto = param.can_be_auto;
  const std::string text = param.get();
  control.is_auto = param.can_be_auto && text == "auto";
  control.is_changed = text != param.default_text;
  control.value = control.is_auto ? param.resolved() : text;
  control.default_value = param.default_text;
  control.tooltip = param.help_text + (param.unit_text.empty() ? "" : " (" + param.unit_text + ")") +
                    (param.paper_text.empty() ? "" : "\n[" + param.paper_text + "]") + "\n--" +
                    with_dashes(param.name) + ", default " + param.default_text;
  if (param.kind == ParamKind::integer || param.kind == ParamKind::real) set_range(control, param);
  return control;
}

}  // namespace

std::vector<Control> controls_of(const Look& look, const std::string& search) {
  std::vector<Control> controls;
  for (std::size_t i = 0; i < look.parameters.all().size(); ++i) {
    const Param& param = look.parameters.all()[i];
    Control control = control_of(param, i < look.own_count ? look.name : shared_group(param.name));
    if (matches(control, search)) controls.push_back(std::move(control));
  }
  // Groups stay together.
  const std::vector<std::string> order{look.name, "Light", "Shadows", "Eye-dome lighting", "Picture"};
  const auto place = [&](const Control& c) {
    return std::find(order.begin(), order.end(), c.group) - order.begin();
  };
  std::stable_sort(controls.begin(), controls.end(),
                   [&](const Control& a, const Control& b) { return place(a) < place(b); });
  return controls;
}

std::vector<Control> controls_of(const ParamList& parameters, const std::string& group,
                                 const std::string& search) {
  std::vector<Control> controls;
  for (const Param& param : parameters.all())
    if (Control control = control_of(param, group); matches(control, search))
      controls.push_back(std::move(control));
  return controls;
}

std::vector<float> numbers_of(const std::string& text) {
  std::vector<float> numbers;
  for (const std::string& word : split(text, ',')) {
    const std::optional<float> number = number_in<float>(word);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace sfumato::view
