#include "session/preset.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "core/version.h"
#include "io/atomic_writer.h"
#include "io/bounded_json.h"
#include "io/camera_json.h"
#include "session/request.h"

namespace sfumato {
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

/// Whether a preset may set the option or parameter: what names files, or decides what is reported, is the
/// command line's alone.
bool is_kept(const std::string& option, bool has_files) {
  const std::string name = with_dashes(option);
  if (const Option* known = find_option(name))
    return known->scope == Option::Scope::place ? has_files : known->scope != Option::Scope::command;
  static const std::set<std::string> others = {"quiet", "version", "help", "config", "verbose", "threads"};
  return !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-.") == name.npos &&
         !others.contains(name);
}

/// "a.las", or {"file": "a.las", "transform": [16 numbers, row by row]}.
scene::SceneFile scene_file(const Json& json, const std::filesystem::path& preset) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, preset.string() + ": files: " + what);
  };
  const Json& name = json.is_object() && json.contains("file") ? json["file"] : json;
  if (!name.is_string())
    refuse("each is a name, or {\"file\": name, \"transform\": [16 numbers, row by row]}");
  scene::SceneFile file;
  // A relative name is meant where the scene stands.
  file.name = (preset.parent_path() / name.get<std::string>()).lexically_normal().string();
  if (!json.is_object()) return file;
  for (const auto& [key, value] : json.items()) {
    if (key == "file") continue;
    if (key != "transform") refuse("'" + key + "' is neither file nor transform");
    const bool fits =
        value.is_array() && value.size() == 16 &&
        std::all_of(value.begin(), value.end(), [](const Json& each) { return each.is_number(); });
    if (!fits) refuse("transform: 16 numbers, row by row, are wanted");
    file.transform = transform_of_rows(value.get<std::vector<double>>());
    if (!file.transform) refuse("transform: the last row of a transform is 0 0 0 1, and it flattens nothing");
  }
  return file;
}

}  // namespace

std::optional<dmat4> transform_of_rows(std::span<const double> rows) {
  dmat4 matrix(1);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = rows[std::size_t(4 * row + column)];
  const bool is_finite = std::all_of(rows.begin(), rows.end(), [](double v) { return std::isfinite(v); });
  const bool is_affine =
      is_finite && matrix[0][3] == 0 && matrix[1][3] == 0 && matrix[2][3] == 0 && matrix[3][3] == 1;
  if (!is_affine || !(std::abs(glm::determinant(matrix)) > 1e-300)) return std::nullopt;
  return matrix;
}

std::array<double, 16> rows_of(const dmat4& matrix) {
  std::array<double, 16> rows;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) rows[std::size_t(4 * row + column)] = matrix[column][row];
  return rows;
}

Preset load_preset(const std::filesystem::path& file) {
  auto refuse = [&](const std::string& what) {
    throw Error(ErrorCode::bad_input, file.string() + ": " + what);
  };
  const Json json = io::load_json(file);
  if (!json.is_object()) refuse("not a JSON object");
  const auto check_kept = [&](const std::string& name) {
    if (!is_kept(name, json.contains("files")))
      refuse("'" + name + "' is no look: a preset names no files and sets no reports; pass --" +
             with_dashes(name) + " to the command");
  };
  Preset preset;
  preset.file = file.string();
  for (const auto& [key, value] : json.items()) {
    if (key == "technique" && value.is_string()) {
      preset.technique = value.get<std::string>();
    } else if (key == "parameters" && value.is_object()) {
      for (const auto& [name, setting] : value.items()) {
        check_kept(name);
        if (!setting.is_object()) {
          preset.parameters.emplace_back(name, spell(setting));
          continue;
        }
        for (const auto& [own, of_technique] : setting.items())
          preset.parameters.emplace_back(name + "." + own, spell(of_technique));
      }
    } else if (key == "options" && value.is_object()) {
      for (const auto& [name, setting] : value.items()) {
        check_kept(name);
        const Option* known = find_option(name);
        const bool repeated = known && known->kind == Option::Kind::texts && setting.is_array();
        for (const Json& one : repeated ? setting : Json::array({setting}))
          preset.options.emplace_back(with_dashes(name), spell(one));
      }
    } else if (key == "files" && value.is_array()) {
      for (const Json& each : value) preset.files.push_back(scene_file(each, file));
    } else if (key == "camera" && value.is_object()) {
      preset.camera = io::camera_from_json(value.dump(), file.string());
    } else if (key != "sfumato") {
      refuse("'" + key + "' is not technique, parameters, options, files or camera of the right kind");
    }
  }
  return preset;
}

NamesAndValues Preset::parameters_for(std::span<const Look* const> looks, const ParamList& analysis) const {
  NamesAndValues found;
  for (const auto& [name, value] : parameters) {
    const std::size_t dot = name.find('.');
    const std::string owner = dot == std::string::npos ? "" : name.substr(0, dot),
                      own = name.substr(owner.empty() ? 0 : dot + 1);
    bool known = false, is_wanted = false;
    for (const TechniqueInfo& info : all_techniques()) {
      if (!owner.empty() && info.name != owner) continue;
      Look other(info);
      known = known || other.parameters.find(own);
    }
    for (const Look* look : looks)
      is_wanted = is_wanted || ((owner.empty() || look->name == owner) && look->parameters.find(own));
    for (const Param& param : analysis.all())
      if (owner.empty() && with_dashes(param.name) == with_dashes(own)) known = is_wanted = true;
    if (is_wanted)
      found.emplace_back(with_dashes(name), value);
    else if (!known)  // not of another technique either, which would wait for its turn
      throw Error(ErrorCode::bad_input, file + ": parameters: no technique has '" + name +
                                            "' (sfumato techniques NAME lists them)");
  }
  return found;
}

Preset load_config() {
  namespace fs = std::filesystem;
  if (const char* file = std::getenv("SFUMATO_CONFIG")) return *file ? load_preset(file) : Preset{};
  const char* home = std::getenv("HOME");
  const char* config = std::getenv("XDG_CONFIG_HOME");
  if (!(config && *config) && !(home && *home)) return {};
  const fs::path file =
      (config && *config ? fs::path(config) : fs::path(home) / ".config") / "sfumato" / "config.json";
  std::error_code error;
  return fs::exists(file, error) ? load_preset(file) : Preset{};
}

void save_preset(const std::filesystem::path& file, std::span<const Look* const> looks,
                 const ParamList& analysis, const NamesAndValues& given, const std::optional<Camera>& camera,
                 const std::vector<scene::SceneFile>& files, bool automatic) {
  Json json;
  json["sfumato"] = version();
  std::string names;
  for (const Look* chosen : looks) names += (names.empty() ? "" : ",") + chosen->name;
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  for (const scene::SceneFile& each : files) {
    const std::string name = std::filesystem::absolute(each.name).lexically_relative(folder).generic_string();
    if (each.transform)
      json["files"].push_back({{"file", name}, {"transform", rows_of(*each.transform)}});
    else
      json["files"].push_back(name);
  }
  json["technique"] = automatic ? "auto" : names;
  json["parameters"] = Json::object();
  const auto add = [&](Json& to, const Param& param) {
    if (!automatic || param.get() != param.default_text) to[param.name] = param.get();
  };
  // A parameter that all chosen techniques share stands once, so that it also holds for others.
  const Look& first = *looks.front();
  for (std::size_t k = first.own_count; k < first.parameters.all().size(); ++k) {
    const Param& param = first.parameters.all()[k];
    const bool agreed = std::all_of(looks.begin(), looks.end(), [&](const Look* chosen) {
      const Param* theirs = chosen->parameters.find(param.name);
      return theirs && theirs->get() == param.get();
    });
    if (agreed) add(json["parameters"], param);
  }
  for (const Param& param : analysis.all()) add(json["parameters"], param);
  for (const Look* chosen : looks) {
    Json own = Json::object();
    for (const Param& param : chosen->parameters.all())
      if (!json["parameters"].contains(param.name)) add(own, param);
    if (!own.empty()) json["parameters"][chosen->name] = own;
  }
  json["options"] = Json::object();
  for (const auto& [name, value] : given) {
    bool is_parameter = name.find('.') != std::string::npos;  // saved above
    for (const Look* chosen : looks) is_parameter |= chosen->parameters.find(name) != nullptr;
    for (const Param& param : analysis.all()) is_parameter |= with_dashes(param.name) == name;
    const Option* known = find_option(name);
    const bool in_camera = !files.empty() && known && known->scope == Option::Scope::camera;
    if (!is_kept(name, !files.empty()) || is_parameter || in_camera) continue;
    Json& kept = json["options"];
    if (!kept.contains(name))
      kept[name] = value;
    else if (kept[name].is_array())
      kept[name].push_back(value);
    else
      kept[name] = Json::array({kept[name], value});  // given several times
  }
  if (camera) json["camera"] = Json::parse(io::camera_to_json(*camera));
  io::AtomicWriter writer(file);
  writer.write(json.dump(2) + "\n");
  writer.commit();
}

}  // namespace sfumato
