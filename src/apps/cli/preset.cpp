#include "preset.h"

#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/version.h"
#include "io/camera_json.h"
#include "io/atomic_writer.h"
#include "io/bounded_json.h"

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

/// Whether a preset may set the option: what names files, or decides what is reported, is the command line's alone.
bool is_look(const std::string& option) {
  static const std::set<std::string> others = {"technique", "preset",  "camera", "path",   "frames", "degrees", "sequence",
                                               "timings",   "json",    "quiet",  "version", "help",  "strict",  "memory",
                                               "config"};
  const std::string name = with_dashes(option);
  const bool is_word = !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") == name.npos;
  return is_word && !others.contains(name) && !name.starts_with("output") && !name.starts_with("save");
}

}  // namespace

Preset load_preset(const std::filesystem::path& file) {
  auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, file.string() + ": " + what);
  };
  const Json json = io::load_json(file);
  if (!json.is_object()) refuse("not a JSON object");
  Preset preset;
  for (const auto& [key, value] : json.items()) {
    if (key == "technique" && value.is_string()) {
      preset.technique = value.get<std::string>();
    } else if ((key == "parameters" || key == "options") && value.is_object()) {
      for (const auto& [name, setting] : value.items()) {
        if (!is_look(name)) refuse("'" + name + "' is no look: a preset names no files and sets no reports; pass --" +
                                   with_dashes(name) + " to the command");
        preset.words.push_back("--" + with_dashes(name) + "=" + spell(setting));
      }
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
    if (!is_look(name) || json["parameters"].contains(parameter) ||
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
