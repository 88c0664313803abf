#include "preset.h"

#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/file.h"

namespace sfumato::cli {
namespace {

using Json = nlohmann::ordered_json;

/// A JSON value in the spelling of the command line.
std::string spell(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& item : value) text += (text.empty() ? "" : ",") + spell(item);
  return text;
}

}  // namespace

Preset load_preset(const std::filesystem::path& file) {
  const io::File input(file);
  auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, file.string() + ": " + what);
  };
  if (input.size() > (1u << 20)) refuse("too large for a preset");
  const Json json = Json::parse(input.read_text(0, std::size_t(input.size())), nullptr, false);
  if (json.is_discarded() || !json.is_object()) refuse("not a JSON object");
  Preset preset;
  for (const auto& [key, value] : json.items()) {
    if (key == "technique" && value.is_string()) {
      preset.technique = value.get<std::string>();
    } else if ((key == "parameters" || key == "options") && value.is_object()) {
      for (const auto& [name, setting] : value.items())
        preset.words.push_back("--" + with_dashes(name) + "=" + spell(setting));
    } else if (key == "camera" && value.is_object()) {
      preset.camera = io::camera_from_json(value.dump(), file.string());
    } else if (key != "sfumato") {
      refuse("'" + key + "' is not technique, parameters, options or camera of the right kind");
    }
  }
  return preset;
}

void save_preset(const std::filesystem::path& file, const Choice& choice,
                 const std::vector<std::pair<std::string, std::string>>& given,
                 const std::optional<Camera>& camera) {
  static const std::set<std::string> not_looks = {
      "technique", "output",  "output-depth", "output-normal", "output-camera", "preset", "save-preset",
      "camera",    "timings", "json",         "quiet",         "path",          "frames", "degrees"};
  Json json;
  json["sfumato"] = version();
  std::string names;
  for (const auto& chosen : choice.techniques) names += (names.empty() ? "" : ",") + chosen->name;
  json["technique"] = names;
  json["parameters"] = Json::object();
  const bool qualified = choice.techniques.size() > 1;
  for (const auto& chosen : choice.techniques)
    for (const Param& param : chosen->parameters.all())
      json["parameters"][(qualified ? chosen->name + "." : "") + param.name] = param.get();
  for (const Param& param : choice.prepare_parameters.all()) json["parameters"][param.name] = param.get();
  json["options"] = Json::object();
  for (const auto& [name, value] : given) {
    std::string parameter = name;
    std::replace(parameter.begin(), parameter.end(), '-', '_');
    if (not_looks.contains(name) || json["parameters"].contains(parameter) ||
        name.find('.') != std::string::npos)
      continue;
    bool is_parameter = false;  // a plain name, saved above under its qualified ones
    for (const auto& chosen : choice.techniques) is_parameter |= chosen->parameters.find(name) != nullptr;
    if (!is_parameter) json["options"][name] = value;
  }
  if (camera) json["camera"] = Json::parse(io::camera_to_json(*camera));
  io::AtomicWriter writer(file);
  writer.write(json.dump(2) + "\n");
  writer.commit();
}

}  // namespace sfumato::cli
