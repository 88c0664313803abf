#include "session/look.h"

#include <algorithm>

#include "core/error.h"

namespace sfumato {

Look::Look(const TechniqueInfo& info) : name(info.name), technique(info.create()) {
  technique->describe(parameters);
  own_count = parameters.all().size();
  settings.describe(parameters);
}

void Look::set(std::string_view parameter, std::string_view value) {
  Param* param = parameters.find(parameter);
  if (!param) {
    std::vector<std::string> names;
    for (const Param& each : parameters.all()) names.push_back(each.name);
    const std::string near = nearest_word(parameter, names);
    throw Error(ErrorCode::usage, "the technique " + name + " has no parameter '" + std::string(parameter) +
                                      "'" + (near.empty() ? "" : "; did you mean '" + near + "'?"));
  }
  param->set(value);
}

void Look::reset() {
  for (Param& param : parameters.all())
    if (param.get() != param.default_text) param.set(param.default_text);
}

void Look::take_over(const Look& other, bool shared_only) {
  const std::vector<Param>& theirs = other.parameters.all();
  for (std::size_t i = shared_only ? other.own_count : 0; i < theirs.size(); ++i)
    if (Param* param = parameters.find(theirs[i].name)) param->set(theirs[i].get());
}

std::vector<std::pair<std::string, std::string>> Look::changed() const {
  std::vector<std::pair<std::string, std::string>> values;
  for (const Param& param : parameters.all())
    if (param.get() != param.default_text) values.emplace_back(param.name, param.get());
  return values;
}

ParamValues Look::resolved(RenderSettings drawn) const {
  ParamList shared;
  drawn.describe(shared);
  ParamValues values;
  for (std::size_t i = 0; i < parameters.all().size(); ++i) {
    const Param& param = parameters.all()[i];
    values.emplace_back(param, (i < own_count ? param : shared.all()[i - own_count]).resolved());
  }
  return values;
}

void Look::check() const {
  Light::parse(settings.light_text);
  if (settings.ground && !casts_shadows(settings.shadows))
    throw Error(ErrorCode::usage,
                "--ground shows the shadow that falls on it: add --shadows soft, or hard" +
                    std::string(settings.shadows == Shadows::stored ? "; stored are those on points" : ""));
}

const char* kind_name(ParamKind kind) {
  static const char* names[] = {"bool", "int", "float", "choice", "string", "float_list", "vec3"};
  return names[int(kind)];
}

std::string with_dashes(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

}  // namespace sfumato
