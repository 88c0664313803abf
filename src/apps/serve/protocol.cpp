#include "protocol.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/error.h"
#include "io/bounded_json.h"

namespace sfumato::serve {
namespace {

using Json = nlohmann::ordered_json;
using view::ViewModel;
using view::ViewRequest;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, "a message of the page: " + what);
}

/// One message, with values that are what they should be.
class Message {
 public:
  explicit Message(std::string_view text) : json_(io::parse_json(text, "a message of the page")) {
    if (!json_.is_object()) refuse("it is no object");
  }
  double number(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_number()) refuse(std::string(name) + " is no number");
    const double value = found->get<double>();
    if (!std::isfinite(value) || std::abs(value) > 1e15) refuse(std::string(name) + " is out of range");
    return value;
  }
  int whole(const char* name, int low, int high) const {
    const double value = number(name);
    if (value < low || value > high)
      refuse(std::string(name) + " is not within " + std::to_string(low) + " to " + std::to_string(high));
    return int(value);
  }
  bool flag(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end()) return false;
    if (!found->is_boolean()) refuse(std::string(name) + " is neither true nor false");
    return found->get<bool>();
  }
  std::string text(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end() || !found->is_string()) refuse(std::string(name) + " is no text");
    return text_of(*found, name);
  }
  static std::string text_of(const Json& json, const char* name) {
    const std::string value = json.get<std::string>();
    if (value.size() > 2000 ||
        std::any_of(value.begin(), value.end(), [](unsigned char c) { return c < 32; }))
      refuse(std::string(name) + " is no plain text");
    return value;
  }
  const Json* list(const char* name, std::size_t most) const {
    const auto found = json_.find(name);
    if (found == json_.end() || found->is_null()) return nullptr;
    if (!found->is_array() || found->size() > most)
      refuse(std::string(name) + " is no list of at most " + std::to_string(most));
    return &*found;
  }
  std::vector<double> numbers(const char* name, std::size_t count) const {
    const Json* all = list(name, count);
    if (!all) return {};
    std::vector<double> values;
    for (const Json& each : *all) {
      if (!each.is_number() || !std::isfinite(each.get<double>()))
        refuse(std::string(name) + " holds what is no number");
      values.push_back(each.get<double>());
    }
    if (values.size() != count)
      refuse(std::string(name) + " is not of " + std::to_string(count) + " numbers");
    return values;
  }

 private:
  Json json_;
};

void set_color(ViewModel& model, const std::string& name, const std::string& value) {
  model.change(name, [&](ViewRequest& next) {
    if (name == "color_by") return next.show_source(value);
    const auto option = color_options.find(name);
    if (option == color_options.end()) refuse("there is no colour setting '" + name + "'");
    set(next, option->second, value);
  });
}

void draw_rows(ViewModel& model, const Json& rows) {
  std::vector<view::DrawRow> wanted;
  for (const Json& each : rows) {
    if (!each.is_object() || !each.contains("rule") || !each["rule"].is_string()) refuse("a row has no rule");
    view::DrawRow row = view::DrawRow::from(Message::text_of(each["rule"], "rule"));
    if (each.contains("visible") && each["visible"].is_boolean()) row.visible = each["visible"].get<bool>();
    wanted.push_back(row);
  }
  model.change("items", [&](ViewRequest& next) { next.items = wanted; });
}

void show_side(ViewModel& model, const std::string& side) {
  model.move(side, [&](view::Navigator& to) {
    if (side == "reset") return to.set_camera(model.request().home);
    if (side == "frame") return to.frame(model.width(), model.height());
    if (side == "parallel") return to.toggle_orthographic();
    to.show(find_view(side, "view"), model.width(), model.height());
  });
}

void path(ViewModel& model, const Message& said, const Limits& limits) {
  const std::string what = said.text("what");
  if (what == "add") {
    if (model.path.keys().size() >= limits.path_keys) return model.say("the path is full", true);
    return model.path.add(model.request().camera);
  }
  if (what == "clear") return model.path.clear();
  if (what == "play") return model.play(true);
  if (what == "stop") return model.play(false);
  if (what == "seconds") {
    model.path.seconds_per_key = std::clamp(said.number("value"), 0.05, 60.0);
    return;
  }
  if (what == "remove" && !model.path.empty())
    return model.path.remove(std::size_t(said.whole("key", 0, int(model.path.keys().size()) - 1)));
  refuse("there is no step '" + what + "' of a path");
}

using Deed = std::function<void(ViewModel&, Hand&, const Message&, const Limits&)>;

const std::map<std::string, Deed>& deeds() {
  static const std::map<std::string, Deed> all{
      {"size",
       [](auto& model, auto&, auto& said, auto& limits) {
         model.set_size(said.whole("width", 1, limits.side_px), said.whole("height", 1, limits.side_px));
       }},
      {"got", [](auto&, auto& hand, auto& said,
                 auto&) { hand.confirmed = std::uint64_t(std::max(0.0, said.number("id"))); }},
      {"pointer",
       [](auto& model, auto& hand, auto& said, auto&) {
         hand.pointed = true;
         hand.pointer.reset();
         if (!said.flag("away")) hand.pointer = model.place_at(said.number("x"), said.number("y"));
       }},
      {"command", [](auto&, auto& hand, auto&, auto&) { hand.wants_command = true; }},
      {"grab",
       [](auto& model, auto& hand, auto& said, auto&) {
         const std::string kind = said.text("kind");
         hand.drag = kind == "rotate"  ? view::Drag::rotate
                     : kind == "light" ? view::Drag::light
                                       : view::Drag::pan;
         hand.grabbed = model.grab(hand.drag, said.number("x"), said.number("y"));
       }},
      {"drag", [](auto& model, auto& hand, auto& said,
                  auto&) { model.drag(hand.drag, hand.grabbed, said.number("dx"), said.number("dy")); }},
      {"zoom",
       [](auto& model, auto&, auto& said, auto&) {
         const dvec3 place = model.place_at(said.number("x"), said.number("y"));
         const double steps = std::clamp(said.number("steps"), -50.0, 50.0);
         model.move("zoom", [&](view::Navigator& to) { to.zoom(steps, place); });
       }},
      {"angle",
       [](auto& model, auto&, auto& said, auto&) {
         const double steps = std::clamp(said.number("steps"), -50.0, 50.0);
         model.move("angle", [&](view::Navigator& to) { to.set_angle(to.camera().fov_deg - 2 * steps); });
       }},
      {"fly",
       [](auto& model, auto&, auto& said, auto&) {
         const std::vector<double> way = said.numbers("way", 3);
         if (way.empty()) refuse("there is no way to fly");
         const dvec3 along = glm::clamp(dvec3(way[0], way[1], way[2]), dvec3(-1), dvec3(1));
         const double seconds = std::clamp(said.number("seconds"), 0.0, 0.25);
         model.move("fly", [&](view::Navigator& to) { to.fly(along, seconds, said.flag("fast") ? 5 : 1); });
       }},
      {"look_at",
       [](auto& model, auto&, auto& said, auto&) {
         const dvec3 place = model.pivot_at(said.number("x"), said.number("y"));
         model.move("pivot", [&](view::Navigator& to) { to.look_at(place); });
       }},
      {"view", [](auto& model, auto&, auto& said, auto&) { show_side(model, said.text("name")); }},
      {"pick", [](auto& model, auto&, auto& said,
                  auto&) { model.pick(said.number("x"), said.number("y"), said.flag("add")); }},
      {"clear", [](auto& model, auto&, auto&, auto&) { model.picks.clear(), model.picks.close_profile(); }},
      {"profile", [](auto& model, auto&, auto& said, auto&) { model.cut_profile(said.number("width")); }},
      {"technique",
       [](auto& model, auto&, auto& said, auto&) {
         const std::string name = said.text("name");
         model.change("technique", [&](ViewRequest& next) { next.technique = find_technique(name).name; });
       }},
      {"set",
       [](auto& model, auto&, auto& said, auto&) {
         const std::string name = said.text("name"), value = said.text("value");
         model.change(name, [&](ViewRequest& next) { next.set(name, value); });
       }},
      {"reset",
       [](auto& model, auto&, auto& said, auto&) {
         const std::string name = said.text("name");
         model.change(name, [&](ViewRequest& next) { name.empty() ? next.reset_all() : next.reset(name); });
       }},
      {"color", [](auto& model, auto&, auto& said,
                   auto&) { set_color(model, said.text("name"), said.text("value")); }},
      {"legend",
       [](auto& model, auto&, auto& said, auto&) {
         model.change("legend", [on = said.flag("on")](ViewRequest& next) { next.furniture.legend = on; });
       }},
      {"whole",
       [](auto& model, auto&, auto& said, auto&) {
         model.change("whole room", [on = said.flag("on")](ViewRequest& next) { next.whole = on; });
       }},
      {"class", [](auto& model, auto&, auto& said,
                   auto&) { model.show_class(said.whole("id", 0, 255), said.flag("shown")); }},
      {"clip",
       [](auto& model, auto&, auto& said, auto&) {
         const std::vector<double> box = said.numbers("box", 6);
         model.change("clip", [&](ViewRequest& next) {
           auto& crop = next.points.selection.crop;
           if (box.empty()) return crop.reset();
           const dvec3 a(box[0], box[1], box[2]), b(box[3], box[4], box[5]);
           crop = Bounds{glm::min(a, b), glm::max(a, b)};
         });
       }},
      {"draw",
       [](auto& model, auto&, auto& said, auto& limits) {
         const Json* rows = said.list("rows", limits.draw_rows);
         draw_rows(model, rows ? *rows : Json::array());
       }},
      {"undo", [](auto& model, auto&, auto&, auto&) { model.undo(); }},
      {"redo", [](auto& model, auto&, auto&, auto&) { model.redo(); }},
      {"path", [](auto& model, auto&, auto& said, auto& limits) { path(model, said, limits); }},
      {"shoot",
       [](auto& model, auto&, auto& said, auto& limits) {
         model.save_picture(said.whole("width", 1, limits.saved_side_px),
                            said.whole("height", 1, limits.saved_side_px));
       }},
  };
  return all;
}

}  // namespace

void obey(ViewModel& model, Hand& hand, std::string_view text, const Limits& limits) {
  const Message said(text);
  const auto deed = deeds().find(said.text("do"));
  if (deed == deeds().end()) refuse("there is no deed '" + said.text("do") + "'");
  deed->second(model, hand, said, limits);
}

}  // namespace sfumato::serve
