#include "report.h"

#include <nlohmann/json.hpp>

#include "core/version.h"

namespace sfumato::cli {
namespace {

using Json = nlohmann::ordered_json;

Json list(const dvec3& v) { return Json::array({v.x, v.y, v.z}); }

/// The text of a parameter as the JSON value of its kind.
Json value_of(const Param& param, const std::string& text) {
  if (text == "auto" && param.can_be_auto) return "auto";
  switch (param.kind) {
    case ParamKind::boolean: return text == "true";
    case ParamKind::integer:
    case ParamKind::real: return Json::parse(text, nullptr, false);
    case ParamKind::real_list:
    case ParamKind::vector3: return Json::parse("[" + text + "]", nullptr, false);
    default: return text;
  }
}

Json describe(const Param& param) {
  Json json;
  json["name"] = param.name;
  json["kind"] = kind_name(param.kind);
  json["default"] = value_of(param, param.default_text);
  if (param.kind == ParamKind::choice) json["choices"] = param.choices;
  if (param.min || param.max)
    json["range"] = {param.min ? Json(*param.min) : Json(), param.max ? Json(*param.max) : Json()};
  json["auto"] = param.can_be_auto;
  json["unit"] = param.unit_text;
  json["help"] = param.help_text;
  json["paper"] = param.paper_text;
  return json;
}

Json describe(const TechniqueInfo& info) {
  const ChosenTechnique chosen(info);
  Json json;
  json["name"] = info.name;
  json["summary"] = info.summary;
  json["needs"] = names_of(chosen.technique->needs());
  json["parameters"] = Json::array();
  json["shared_parameters"] = Json::array();
  const auto& all = chosen.parameters.all();
  for (std::size_t i = 0; i < all.size(); ++i)
    json[i < chosen.own_count ? "parameters" : "shared_parameters"].push_back(describe(all[i]));
  return json;
}

Json resolved(const ParamList& parameters) {
  Json json = Json::object();
  for (const Param& param : parameters.all()) json[param.name] = value_of(param, param.resolved());
  return json;
}

Json resolved(const RenderReport& report, const Look& look) {
  Json json = Json::object();
  for (const auto& [param, value] : last_values(report, look)) json[param.name] = value_of(param, value);
  return json;
}

Json timings(const TechniqueReport& report) {
  Json json = Json::object();
  for (const PassTiming& pass : report.passes) json[pass.name] = json.value(pass.name, 0.0) + pass.ms;
  json["total"] = report.total_ms;
  return json;
}

Json facts_of(const io::ReadReport& report, std::optional<double> spacing) {
  if (!report.points_finite) spacing.reset();
  Json json;
  json["file"] = report.file.string();
  json["format"] = report.format;
  json["points"] = report.points;
  json["points_finite"] = report.points_finite;
  json["points_dropped"] = report.points_dropped;
  json["points_missing"] = report.points_missing;
  json["bounds_min"] = report.points_finite ? list(report.bounds_min) : Json();
  json["bounds_max"] = report.points_finite ? list(report.bounds_max) : Json();
  json["attributes"] = Json::object();
  for (const io::AttributeStats& a : report.attributes)
    json["attributes"][a.name] = {{"min", a.min}, {"max", a.max}, {"mean", a.mean}};
  json["crs"] = report.crs;
  json["median_spacing"] = spacing ? Json(*spacing) : Json();
  json["density"] = spacing && *spacing > 0 ? Json(1 / (*spacing * *spacing)) : Json();
  return json;
}

}  // namespace

io::ReadReport report_of(const copc::Tree& tree) {
  io::ReadReport report;
  report.file = tree.file;
  report.format = tree.format;
  report.points = report.points_finite = tree.points;
  report.bounds_min = tree.bounds.min, report.bounds_max = tree.bounds.max;
  report.crs = tree.crs;
  return report;
}

std::string info_json(const io::ReadReport& report, double median_spacing,
                      const std::vector<ClassShare>& classes) {
  Json json = facts_of(report, median_spacing);
  json["classes"] = Json::array();
  for (const ClassShare& each : classes)
    json["classes"].push_back({{"id", each.id}, {"name", class_name(each.id)}, {"points", each.points}});
  return json.dump(2) + "\n";
}

std::string tree_json(const copc::Tree& tree) {
  Json json = facts_of(report_of(tree), std::nullopt);
  for (const std::string& name : tree.attributes) json["attributes"][name] = nullptr;
  json["levels"] = Json::array();
  for (const copc::LevelFacts& level : levels_of(tree))
    json["levels"].push_back({{"level", level.level},
                              {"nodes", level.nodes},
                              {"points", level.points},
                              {"spacing", level.spacing}});
  return json.dump(2) + "\n";
}

std::string techniques_json(const std::string& name) {
  if (!name.empty()) return describe(find_technique(name)).dump(2) + "\n";
  Json json = Json::array();
  for (const TechniqueInfo& info : all_techniques()) json.push_back(describe(info));
  return json.dump(2) + "\n";
}

ParamValues last_values(const RenderReport& report, const Look& look) {
  const auto found = report.settings.find(look.name);
  return look.resolved(found == report.settings.end() ? look.settings : found->second);
}

std::string render_json(const RenderReport& report, const Choice& choice, const std::string& camera_json) {
  Json json;
  json["outputs"] = report.outputs;
  if (choice.techniques.size() == 1) {
    json["technique"] = choice.techniques[0]->name;
    json["parameters"] = resolved(report, *choice.techniques[0]);
  } else {
    for (const auto& chosen : choice.techniques) {
      json["technique"].push_back(chosen->name);
      json["parameters"][chosen->name] = resolved(report, *chosen);
    }
  }
  for (const auto& chosen : choice.techniques)
    if (!chosen->reason.empty())
      json["automatic_technique"] = {
          {"technique", chosen->name}, {"reason", chosen->reason}, {"surface_share", chosen->surface_share}};
  json["analysis_parameters"] = resolved(choice.prepare_parameters);
  json["color_by"] = report.color_by;
  json["exposure"] = report.exposure;
  json["background_color"] = list(report.background);
  json["up"] = report.up;
  json["cutaway"] = report.cutaway;
  json["up_reason"] = report.up_reason;
  json["points_read"] = report.points_read;
  json["points_missing"] = report.points_missing;
  json["points_hidden"] = report.points_hidden;
  json["points_left_out"] = report.points_left_out;
  json["points_rendered"] = report.points_rendered;
  if (report.share_outside) json["share_outside"] = *report.share_outside;
  if (report.levels) {
    const scene::LevelsReport& levels = *report.levels;
    json["levels"] = {{"points_in_files", levels.points_in_files},
                      {"points_needed", levels.points_needed},
                      {"points_read", levels.points},
                      {"nodes_in_files", levels.nodes_in_files},
                      {"nodes_needed", levels.nodes_needed},
                      {"nodes_read", levels.nodes},
                      {"widest_spacing_px", levels.widest_px}};
  }
  std::uint64_t drawn = 0, outliers = 0;
  for (const TechniqueReport& one : report.techniques) {
    drawn = std::max(drawn, one.points_drawn);
    outliers = std::max(outliers, one.outliers);
  }
  json["points_drawn"] = drawn;
  json["outliers"] = outliers;
  json["frames"] = report.frames;
  for (const RenderReport::Draw& each : report.draw)
    json["draw"].push_back({{"rule", each.rule}, {"technique", each.technique}, {"points", each.points}});
  json["blank_pictures"] = report.blank_pictures;
  for (std::size_t i = 0; i < report.techniques.size(); ++i) {
    if (report.techniques.size() == 1)
      json["timings_ms"] = timings(report.techniques[i]);
    else
      json["timings_ms"][choice.techniques[i]->name] = timings(report.techniques[i]);
  }
  for (const auto& [stage, ms] : report.stages_ms) json["stages_ms"][stage] = ms;
  Json notes = Json::array();
  for (const TechniqueReport& one : report.techniques)
    for (const std::string& note : one.notes) notes.push_back(note);
  json["notes"] = notes;
  json["camera"] = Json::parse(camera_json);
  json["version"] = version();
  return json.dump(2) + "\n";
}

}  // namespace sfumato::cli
