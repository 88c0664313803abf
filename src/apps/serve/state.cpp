#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/colormap.h"
#include "protocol.h"
#include "view/controls.h"

namespace sfumato::serve {
namespace {

using Json = nlohmann::ordered_json;
using view::ViewModel;
using view::ViewRequest;

Json json_of(const dvec3& v) { return Json::array({v.x, v.y, v.z}); }

Json control_json(const ViewModel& model, const view::Control& control) {
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
            {"value", control.is_auto ? model.resolved(control.name).value_or(control.value) : control.value},
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

Json controls(const ViewModel& model) {
  Json all = Json::array();
  const ViewRequest& request = model.request();
  for (const view::Control& each : view::controls_of(*request.make_look()))
    all.push_back(control_json(model, each));
  for (const view::Control& each : request.analysis_controls("Analysis"))
    all.push_back(control_json(model, each));
  return all;
}

Json colors(const ViewModel& model) {
  const ViewRequest& request = model.request();
  Json json{{"color_by", request.color.color_by},
            {"legend", request.furniture.legend},
            {"colormaps", Colormap::choices()}};
  for (const auto& [key, option] : color_options) json[key] = text_of(request, option);
  json["sources"] = view::color_sources(model.scene.loaded());
  if (!model.picture()) return json;
  const Coloring& coloring = model.picture()->coloring;
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

Json scene_json(const ViewModel& model) {
  const view::Loaded* scene = model.scene.loaded();
  if (!scene) return nullptr;
  const ViewRequest& request = model.request();
  Json classes = Json::array();
  for (const ClassShare& each : scene->classes)
    classes.push_back({{"id", each.id},
                       {"name", class_name(each.id)},
                       {"color", hex_of(model.picture() ? model.picture()->coloring.color_of_class(each.id)
                                                        : class_color(each.id))},
                       {"points", each.points},
                       {"shown", request.shows_class(each.id)}});
  return {{"formats", scene->formats},
          {"points_read", scene->points_read},
          {"points_shown", scene->points_shown},
          {"up", to_string(scene->pose.upright.up)},
          {"crs", scene->crs.substr(0, 200)},
          {"unit", view::unit_of(scene->crs)},
          {"box", Json::array({json_of(scene->box.min), json_of(scene->box.max)})},
          {"is_room", scene->pose.subject.room.has_value() || model.request().whole},
          {"whole", model.request().whole},
          {"classes", classes}};
}

Json picks(const ViewModel& model) {
  const double size = model.navigator().scene_size();
  Json all = Json::array();
  for (const view::Picked& each : model.picks.points()) {
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
          view::measure(model.picks.points()[all.size() - 1].world, each.world, model.navigator().up_axis());
      one["distance"] = m.distance, one["height"] = m.height, one["horizontal"] = m.horizontal;
      one["distance_text"] = view::coordinate_text(m.distance, size);
    }
    all.push_back(one);
  }
  return all;
}

Json profile_json(const ViewModel& model) {
  const auto& profile = model.picks.profile();
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

Json state_of(const ViewModel& model) {
  Json state;
  Json techniques = Json::array();
  for (const TechniqueInfo& info : all_techniques())
    techniques.push_back({{"name", info.name}, {"summary", info.summary}});
  state["techniques"] = techniques;
  Json files = Json::array();
  for (const std::string& file : model.request().files)
    files.push_back(file.substr(file.find_last_of('/') + 1));
  state["files"] = files;
  state["technique"] = {{"name", model.request().technique}, {"reason", model.scene.reason()}};
  state["notes"] = model.picture() && model.settled() ? Json(model.picture()->notes) : Json::array();
  state["scene"] = scene_json(model);
  state["controls"] = controls(model);
  state["color"] = colors(model);
  state["picked"] = picks(model);
  state["profile"] = profile_json(model);
  const auto& crop = model.request().points.selection.crop;
  state["clip"] =
      crop ? Json::array({crop->min.x, crop->min.y, crop->min.z, crop->max.x, crop->max.y, crop->max.z})
           : Json();
  Json rows = Json::array();
  for (const view::DrawRow& row : model.request().items) {
    view::DrawRow shown = row;
    shown.visible = true;
    rows.push_back({{"rule", shown.rule()}, {"visible", row.visible}});
  }
  state["draw"] = rows;
  state["history"] = {{"undo", model.can_undo()}, {"redo", model.can_redo()}};
  state["activity"] = {{"text", model.activity().text},
                       {"fraction", std::round(100 * model.activity().fraction) / 100}};
  state["path"] = {{"keys", model.path.keys().size()},
                   {"seconds", model.path.seconds_per_key},
                   {"playing", model.playing()}};
  state["settled"] = model.settled();
  return state;
}

Json info_of(const ViewModel& model) {
  const Json state = state_of(model);
  const view::Memory memory = model.memory();
  return {{"files", state["files"]},
          {"scene", state["scene"]},
          {"techniques", state["techniques"]},
          {"technique", state["technique"]},
          {"color_sources", state["color"]["sources"]},
          {"renderer", model.renderer_name()},
          {"memory",
           {{"process", memory.process}, {"process_peak", memory.process_peak}, {"points", memory.points}}}};
}

}  // namespace sfumato::serve
