#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/colormap.h"
#include "protocol.h"
#include "view/controls.h"

namespace sfumato::serve {
namespace {

using Json = nlohmann::ordered_json;
using view::Wishes;
using view::Workbench;

Json json_of(const dvec3& v) { return Json::array({v.x, v.y, v.z}); }

std::string resolved(const Workbench& bench, const view::Control& control) {
  const auto& picture = bench.picture();
  if (control.is_auto && picture && picture->technique == bench.wishes().technique)
    for (const auto& [name, value] : picture->resolved)
      if (name == control.name) return value;
  return control.value;
}

Json control_json(const Workbench& bench, const view::Control& control) {
  const char* const kind = control.kind == ParamKind::boolean   ? "boolean"
                           : control.kind == ParamKind::integer ? "integer"
                           : control.kind == ParamKind::real    ? "real"
                           : control.kind == ParamKind::choice  ? "choice"
                                                                : "text";
  Json json{{"name", control.name},
            {"label", control.label},
            {"group", control.group},
            {"help", control.tooltip},
            {"kind", kind},
            {"value", resolved(bench, control)},
            {"default", control.default_value},
            {"changed", control.is_changed}};
  if (control.can_be_auto) json["auto"] = control.is_auto;
  if (!control.choices.empty()) json["choices"] = control.choices;
  if (control.kind == ParamKind::integer || control.kind == ParamKind::real) {
    json["low"] = std::max(control.low, control.limit_low),
    json["high"] = std::min(control.high, control.limit_high);
    if (control.logarithmic) json["logarithmic"] = true;
  }
  return json;
}

Json controls(const Workbench& bench) {
  Json all = Json::array();
  const Wishes& wishes = bench.wishes();
  for (const view::Control& each : view::controls_of(*wishes.make_look()))
    all.push_back(control_json(bench, each));
  for (const view::Control& each : wishes.analysis_controls("Analysis"))
    all.push_back(control_json(bench, each));
  return all;
}

Json colors(const Workbench& bench) {
  const Wishes& wishes = bench.wishes();
  Json json{{"color_by", wishes.color.color_by},
            {"legend", wishes.furniture.legend},
            {"colormaps", Colormap::choices()}};
  for (const auto& [key, option] : color_options) json[key] = text_of(wishes, option);
  json["sources"] = view::color_sources(bench.scene.loaded());
  if (!bench.picture()) return json;
  const Coloring& coloring = bench.picture()->coloring;
  json["source"] = coloring.source;
  if (coloring.kind == ColorKind::scalar) {
    const Colormap map = coloring.ramp();
    Json bar = Json::array();
    for (int i = 0; i <= 32; ++i) bar.push_back(hex_of(map.at(i / 32.0)));
    const double span = std::abs(coloring.high - coloring.low);
    json["bar"] = bar;
    json["low"] = view::coordinate_text(coloring.low, span),
    json["high"] = view::coordinate_text(coloring.high, span);
  }
  Json swatches = Json::array();
  for (const Swatch& each : coloring.swatches)
    swatches.push_back({{"label", each.label}, {"color", hex_of(each.color)}, {"points", each.points}});
  json["swatches"] = swatches;
  return json;
}

Json scene_json(const Workbench& bench) {
  const view::Loaded* scene = bench.scene.loaded();
  if (!scene) return nullptr;
  const Wishes& wishes = bench.wishes();
  const Selection& selection = wishes.points.selection;
  Json classes = Json::array();
  for (const ClassShare& each : scene->classes) {
    const std::vector<int>& list =
        selection.show_classes.empty() ? wishes.hide_classes : selection.show_classes;
    const bool is_named = std::find(list.begin(), list.end(), each.id) != list.end();
    classes.push_back({{"id", each.id},
                       {"name", class_name(each.id)},
                       {"color", hex_of(bench.picture() ? bench.picture()->coloring.color_of_class(each.id)
                                                        : class_color(each.id))},
                       {"points", each.points},
                       {"shown", selection.show_classes.empty() ? !is_named : is_named}});
  }
  return {{"formats", scene->formats},
          {"points_read", scene->points_read},
          {"points_shown", scene->points_shown},
          {"up", to_string(scene->pose.upright.up)},
          {"crs", scene->crs.substr(0, 200)},
          {"unit", view::unit_of(scene->crs)},
          {"box", Json::array({json_of(scene->box.min), json_of(scene->box.max)})},
          {"is_room", scene->pose.subject.room.has_value() || bench.wishes().whole},
          {"whole", bench.wishes().whole},
          {"classes", classes}};
}

Json picks(const Workbench& bench) {
  const double size = bench.navigator().scene_size();
  Json all = Json::array();
  for (const view::Picked& each : bench.picks.points()) {
    Json attributes = Json::array();
    for (const auto& [name, value] : each.attributes) attributes.push_back({name, value});
    Json one{{"world", json_of(each.world)},
             {"text", Json::array({view::coordinate_text(each.world.x, size),
                                   view::coordinate_text(each.world.y, size),
                                   view::coordinate_text(each.world.z, size)})},
             {"point", each.source},
             {"attributes", attributes}};
    if (!all.empty()) {
      const view::Measure m =
          view::measure(bench.picks.points()[all.size() - 1].world, each.world, bench.navigator().up_axis());
      one["distance"] = m.distance, one["height"] = m.height, one["horizontal"] = m.horizontal;
      one["distance_text"] = view::coordinate_text(m.distance, size);
    }
    all.push_back(one);
  }
  return all;
}

Json profile_json(const Workbench& bench) {
  const auto& profile = bench.picks.profile();
  if (!profile) return nullptr;
  constexpr std::size_t most = 20'000;  // of a drawing a few hundred pixels wide
  const std::size_t step = (profile->points.size() + most - 1) / most;
  Json points = Json::array();
  for (std::size_t i = 0; i < profile->points.size(); i += std::max<std::size_t>(step, 1)) {
    const view::ProfilePoint& each = profile->points[i];
    points.push_back({each.along, each.height, hex_of(each.color)});
  }
  return {{"length", profile->length},
          {"width", profile->width},
          {"count", profile->points.size()},
          {"points", points}};
}

}  // namespace

Json camera_json(const Camera& camera) {
  const view::ViewCamera seen = view::ViewCamera::from(camera);
  return {{"position", json_of(seen.position)},
          {"target", json_of(seen.target)},
          {"up", json_of(seen.up)},
          {"fov_deg", seen.fov_deg},
          {"orthographic", seen.orthographic}};
}

Json state_of(const Workbench& bench) {
  Json state;
  Json techniques = Json::array();
  for (const TechniqueInfo& info : all_techniques())
    techniques.push_back({{"name", info.name}, {"summary", info.summary}});
  state["techniques"] = techniques;
  Json files = Json::array();
  for (const std::string& file : bench.wishes().files)
    files.push_back(file.substr(file.find_last_of('/') + 1));
  state["files"] = files;
  state["technique"] = {{"name", bench.wishes().technique}, {"reason", bench.scene.reason()}};
  state["notes"] = bench.picture() && bench.settled() ? Json(bench.picture()->notes) : Json::array();
  state["scene"] = scene_json(bench);
  state["controls"] = controls(bench);
  state["color"] = colors(bench);
  state["picked"] = picks(bench);
  state["profile"] = profile_json(bench);
  const auto& crop = bench.wishes().points.selection.crop;
  state["clip"] =
      crop ? Json::array({crop->min.x, crop->min.y, crop->min.z, crop->max.x, crop->max.y, crop->max.z})
           : Json();
  Json rows = Json::array();
  for (const view::DrawRow& row : bench.wishes().items) {
    view::DrawRow shown = row;
    shown.visible = true;
    rows.push_back({{"rule", shown.rule()}, {"visible", row.visible}});
  }
  state["draw"] = rows;
  state["history"] = {{"undo", bench.can_undo()}, {"redo", bench.can_redo()}};
  state["activity"] = {{"text", bench.activity().text},
                       {"fraction", std::round(100 * bench.activity().fraction) / 100}};
  state["path"] = {{"keys", bench.path.keys().size()},
                   {"seconds", bench.path.seconds_per_key},
                   {"playing", bench.playing()}};
  state["settled"] = bench.settled();
  return state;
}

Json info_of(const Workbench& bench) {
  const Json state = state_of(bench);
  const view::Memory memory = bench.memory();
  return {{"files", state["files"]},
          {"scene", state["scene"]},
          {"techniques", state["techniques"]},
          {"technique", state["technique"]},
          {"color_sources", state["color"]["sources"]},
          {"renderer", bench.renderer_name()},
          {"memory",
           {{"process", memory.process}, {"process_peak", memory.process_peak}, {"points", memory.points}}}};
}

}  // namespace sfumato::serve
