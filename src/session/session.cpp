#include "session/session.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "analysis/attributes.h"
#include "analysis/density.h"
#include "analysis/survey.h"
#include "analysis/whole.h"
#include "core/color.h"
#include "core/error.h"
#include "core/typed_attributes.h"
#include "passes/shadows.h"
#include "techniques/panorama.h"

namespace sfumato {
namespace {

std::shared_ptr<const std::vector<std::uint32_t>> shared_places(PointCloud& cloud) {
  if (cloud.source_index.empty()) return nullptr;
  return std::make_shared<const std::vector<std::uint32_t>>(std::exchange(cloud.source_index, {}));
}

}  // namespace

// Each part counts its points from 0: tables by their places are as long as the part, not as the files.
std::vector<PointCloud> Session::cut(PointCloud cloud, const std::vector<std::uint32_t>& matches) {
  parts_.clear();
  std::vector<PointCloud> clouds;
  const std::vector<DrawRule>& rules = options_.draw;
  if (rules.empty()) {
    parts_.push_back({{}, nullptr, nullptr, cloud.size(), shared_places(cloud)});
    clouds.push_back(std::move(cloud));
    return clouds;
  }
  std::vector<std::size_t> counts(rules.size() + 1);
  for (std::uint32_t rule : matches) ++counts[rule];
  // Rules that draw alike are one part, so that their fragments sort together.
  std::vector<std::vector<std::uint32_t>> members;  // of each part, rules
  if (counts.back() > 0) parts_.push_back({}), members.push_back({std::uint32_t(rules.size())});
  for (std::uint32_t r = 0; r < rules.size(); ++r) {
    if (counts[r] == 0) {
      notes_.push_back("--draw \"" + rules[r].text +
                       "\" draws no point: none is selected, or earlier rules draw them");
      continue;
    }
    if (rules[r].draws_nothing()) continue;
    std::size_t k = 0;
    while (k < parts_.size() && !(parts_[k].rule && parts_[k].rule->draws_like(rules[r]))) ++k;
    if (k == parts_.size()) {
      parts_.push_back({{}, &rules[r], rules[r].look(Look(rules[r].technique)), 0, {}});
      members.emplace_back();
    }
    parts_[k].rules.push_back(rules[r].text);
    members[k].push_back(r);
  }
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    std::vector<std::uint32_t> places;
    for (std::size_t i = 0; i < matches.size(); ++i)
      if (std::find(members[k].begin(), members[k].end(), matches[i]) != members[k].end())
        places.push_back(std::uint32_t(i));
    parts_[k].points = places.size();
    clouds.push_back(select(cloud, places));
    parts_[k].source_index = shared_places(clouds.back());
  }
  return clouds;
}

namespace {

/// Nothing where the overview does not tell: it has no normals, and lacks numbers that are rare.
std::optional<Coloring> coloring_of_overview(const PointCloud& overview, const ColorSettings& settings,
                                             const std::vector<double>& heights) {
  try {
    return color_points(overview, settings, heights);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Colours what is in view as it would be in a picture of everything.
Coloring color_like(const std::optional<Coloring>& of_all, const PointCloud& cloud,
                    const ColorSettings& settings, const std::vector<double>& heights) {
  if (!of_all) return color_points(cloud, settings, heights);
  ColorSettings resolved = settings;
  if (settings.color_by == "auto") resolved.color_by = of_all->source;
  if (of_all->kind == ColorKind::scalar)
    resolved.range = {of_all->low, of_all->high}, resolved.places = of_all->places;
  if (of_all->kind == ColorKind::rgb)
    resolved.exposure = of_all->exposure, resolved.for_black = of_all->for_black;
  resolved.shade = of_all->shade;
  try {
    Coloring coloring = color_points(cloud, resolved);
    coloring.notes = of_all->notes;
    return coloring;
  } catch (const Error&) {
    return color_points(cloud, settings, heights);  // what is in view lacks what the whole has
  }
}

/// Of a few colours black is the label of what has none, or of leaves; no shade shows on it. CIE L* 41.
constexpr Rgba8 black{0, 0, 0, 255}, drawn_for_black{0x60, 0x60, 0x60, 255};

const PreparedCloud& largest_of(const std::vector<const PreparedCloud*>& clouds) {
  return **std::max_element(clouds.begin(), clouds.end(),
                            [](const auto* a, const auto* b) { return a->cloud.size() < b->cloud.size(); });
}

/// What `auto` takes where the file has no colours and light is another matter than it seemed: height where
/// too few points make a surface for light to show, or too little of one, as leaves, whose intensity besides
/// is that of the part of a pulse that each stopped; clay where they have radii of their own, as of a mesh
/// that is no survey, and light shows each fold.
std::string without_colors(const std::string& source, const PreparedCloud& cloud,
                           const std::function<TechniqueChoice()>& choose) {
  const bool is_survey = cloud.cloud.las || !cloud.cloud.crs.empty();
  if (source == "clay" || source == "intensity") {
    const TechniqueChoice choice = choose();
    const bool has_surface = choice.surface_share >= analysis::enough_surface;
    return has_surface && (source == "intensity" || !choice.too_few) ? source : "elevation";
  }
  if (source == "elevation" && !is_survey && !cloud.cloud.radii.empty() &&
      !cloud.computed.has(Attribute::radius))
    return "clay";
  return source;
}

/// Of the points that there are: fewer where they were thinned or a level of detail was read.
void add_density(PointCloud& cloud) {
  if (cloud.scalar(analysis::density_name)) return;
  cloud.set_scalar(
      {analysis::density_name, 0, analysis::surface_density(analysis::NeighborTree(cloud.positions))});
}

}  // namespace

std::vector<std::vector<Rgba8>> Session::color(const std::vector<const PreparedCloud*>& clouds) {
  ColorSettings settings = options_.color;
  settings.file_names = file_names_;
  // An overview without levels is of a sequence, of which the first view frames one file.
  const std::vector<double> heights =
      overview_ && !levels_ && !whole_ ? std::vector<double>{} : shown_heights(pose_);
  std::vector<std::vector<Rgba8>> colors;
  PointCloud joined;
  if (clouds.size() > 1) joined = clouds.front()->cloud;
  for (std::size_t k = 1; k < clouds.size(); ++k) append(joined, clouds[k]->cloud);
  const PointCloud& whole = clouds.size() > 1 ? joined : clouds.front()->cloud;
  std::optional<Coloring> of_all;
  const auto color_all = [&] {
    if (overview_)
      of_all = color_of_overview_.at({overview_, settings},
                                     [&] { return coloring_of_overview(*overview_, settings, heights); });
    if (of_all && whole.empty())
      coloring_ = *of_all, coloring_.colors.clear();
    else
      coloring_ = color_like(of_all, whole, settings, heights);
  };
  color_all();
  if (settings.color_by == "auto" && !settings.solid) {
    const PreparedCloud& largest = largest_of(clouds);
    settings.color_by = without_colors(coloring_.source, largest, [&] {
      return whole_ || levels_ ? suggest(largest, nullptr) : choose_technique(largest, nullptr);
    });
    if (settings.color_by != coloring_.source) color_all();
  }
  const std::vector<Rgba8>& all = of_all ? of_all->colors : coloring_.colors;
  // One part of a cloud may have fewer colours than the next.
  const std::vector<Rgba8>& deciding = whole_ ? all : coloring_.colors;
  are_photographed_ = (of_all ? *of_all : coloring_).is_photographed;
  contrasting_ = are_photographed_ ? background_of_photographs : contrasting_background(all);
  if (!are_photographed_ && coloring_.source == "rgb" && !options_.color.solid)
    for (Rgba8& c : coloring_.colors)
      if (c == black) c = drawn_for_black;
  palette_.clear();
  if (coloring_.kind == ColorKind::classes || coloring_.kind == ColorKind::files)
    for (const Rgba8& c : distinct_colors(deciding, RenderSettings::palette_limit))
      palette_.emplace_back(linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b));
  if (clouds.size() == 1) {
    colors.push_back(std::move(coloring_.colors));
  } else {
    auto from = coloring_.colors.begin();
    for (const PreparedCloud* each : clouds) {
      const auto count = std::ptrdiff_t(each->cloud.size());
      colors.emplace_back(from, from + count);
      from += count;
    }
  }
  coloring_.colors.clear();
  return colors;
}

std::size_t Session::prepared_points() const {
  std::size_t points = 0;
  for (std::size_t k = 0; !is_empty_ && k < parts_.size(); ++k) points += cloud(k).size();
  return points;
}

std::uint64_t Session::point_bytes() const {
  std::uint64_t bytes = 0;
  for (std::size_t k = 0; !is_empty_ && k < parts_.size(); ++k) {
    const PointCloud& points = cloud(k);
    bytes += points.positions.size() * sizeof(vec3) + colors(k).size() * sizeof(Rgba8) +
             points.source_index.size() * sizeof(std::uint32_t);
    for_each_attribute([&](const auto& each) { bytes += each.of(points).size() * sizeof each.missing; });
    if (parts_[k].source_index) bytes += parts_[k].source_index->size() * sizeof(std::uint32_t);
    for (const ScalarField& field : points.scalars) bytes += field.values.size() * sizeof(float);
  }
  return bytes;
}

std::uint64_t Session::source(std::size_t part, std::size_t i) const {
  const std::uint32_t in_part = cloud(part).source_index[i];
  const auto& of_part = parts_[part].source_index;
  return of_part ? (*of_part)[in_part] : in_part;
}

void Session::open(scene::Scene scene, Pose pose, const SessionOptions& options, Choice* choice,
                   Progress& progress, bool measures) {
  set_scene(std::move(scene), std::move(pose), options, progress);
  if (choice && choice->automatic()) choice->resolve(suggest());
  measure(choice && measures ? choice->needs() : Attributes(), progress);
}

void Session::set_scene(scene::Scene scene, Pose pose, const SessionOptions& options, Progress& progress) {
  progress.check();
  // What is refused is refused before anything of the last scene is gone.
  std::vector<std::uint32_t> matches;
  if (!options.draw.empty()) matches = first_matches(options.draw, scene.cloud);
  if (!matches.empty() && std::all_of(matches.begin(), matches.end(), [&](std::uint32_t rule) {
        return rule < options.draw.size() && options.draw[rule].draws_nothing();
      }))
    throw Error(ErrorCode::usage, "--draw: rules with 'none' leave out every point");
  is_empty_ = true;  // until all is there
  options_ = options;
  pose_ = std::move(pose);
  file_names_ = std::move(scene.file_names);
  whole_ = std::move(scene.whole);
  levels_ = scene.overview ? scene.overview->levels : nullptr;
  auto overview =
      whole_ ? std::shared_ptr<const PointCloud>(whole_, &whole_->sample) : std::move(scene.overview);
  if (overview != overview_) choice_of_overview_.forget(), color_of_overview_.forget();
  overview_ = std::move(overview);
  notes_.clear();
  box_ = whole_ ? whole_->box : bounds(scene.cloud);
  shadow_box_.reset();
  unmeasured_.clear();
  around_ = std::move(scene.around);
  std::vector<Unmeasured> unmeasured;
  for (PointCloud& part : cut(std::move(scene.cloud), matches)) {
    Unmeasured& each = unmeasured.emplace_back();
    each.points = part.size();
    if (around_)
      each.part = std::move(part);
    else
      each.sorted = analysis::sort_cloud(std::move(part), options.prepare, progress, whole_);
  }
  unmeasured_ = std::move(unmeasured);
}

void Session::measure(Attributes needs, Progress& progress) {
  if (unmeasured_.empty()) throw Error(ErrorCode::usage, "nothing to measure: set a scene first");
  const std::string& color_by = options_.color.color_by;
  const Attributes shown = color_by == "normal" ? Attributes(Attribute::normal) : Attributes();
  std::vector<ColoredCloud> prepared;
  std::vector<const PreparedCloud*> in_order;
  left_out_ = 0, spacing_ = std::numeric_limits<float>::infinity();
  const std::optional<PointCloud> around = std::exchange(around_, {});
  std::vector<Unmeasured> unmeasured = std::exchange(unmeasured_, {});
  for (std::size_t k = 0; k < unmeasured.size(); ++k) {
    auto& [sorted, part, points] = unmeasured[k];
    const Attributes own = (parts_[k].look ? parts_[k].look->technique->needs() : needs) | shown;
    if (around)
      sorted.cloud =
          analysis::prepare_part(std::move(part), *around, own, options_.prepare, progress, whole_);
    else
      analysis::complete(sorted.cloud, own, options_.prepare, sorted.tree.get(), progress);
    prepared.push_back({std::move(sorted.cloud), {}});
    sorted.tree.reset();
    left_out_ += points - prepared.back().cloud.cloud.size();
    if (color_by == analysis::density_name) add_density(prepared.back().cloud.cloud);
    spacing_ = std::min(spacing_, prepared.back().cloud.median_spacing);
  }
  for (const ColoredCloud& each : prepared) in_order.push_back(&each.cloud);
  std::vector<std::vector<Rgba8>> colors = color(in_order);
  for (std::size_t k = 0; k < prepared.size(); ++k) prepared[k].colors = std::move(colors[k]);
  renderer_.set_clouds(std::move(prepared));
  renderer_.set_room(pose_.subject.room);
  is_empty_ = false;
}

void Session::share_scene(const Session& other) {
  is_empty_ = true;
  unmeasured_.clear(), around_.reset();
  renderer_.share_clouds(other.renderer_);
  options_ = other.options_;
  file_names_ = other.file_names_, notes_ = other.notes_, overview_ = other.overview_, whole_ = other.whole_;
  levels_ = other.levels_;
  parts_.clear();
  for (const Part& each : other.parts_) {
    Part& part = parts_.emplace_back(Part{each.rules, nullptr, nullptr, each.points, each.source_index});
    if (!each.rule) continue;
    part.rule = options_.draw.data() + (each.rule - other.options_.draw.data());
    part.look = part.rule->look(Look(part.rule->technique));
  }
  box_ = other.box_, shadow_box_ = other.shadow_box_, spacing_ = other.spacing_;
  coloring_ = other.coloring_, palette_ = other.palette_, are_photographed_ = other.are_photographed_;
  pose_ = other.pose_, left_out_ = other.left_out_;
  contrasting_ = other.contrasting_;
  is_empty_ = other.is_empty_;
}

TechniqueChoice Session::suggest(const PreparedCloud& sorted, const analysis::NeighborTree* tree) const {
  if (!overview_ || !options_.draw.empty()) return choose_technique(sorted, tree, overview_ != nullptr);
  const std::shared_ptr<const PointCloud>& all = levels_ ? levels_ : overview_;
  return choice_of_overview_.at(all, [&] {
    const analysis::SortedCloud whole = analysis::sort_cloud(*all, options_.prepare);
    return choose_technique(whole.cloud, whole.tree.get(), true);
  });
}

TechniqueChoice Session::suggest() const {
  if (unmeasured_.empty()) {
    if (is_empty_) throw Error(ErrorCode::usage, "nothing to draw: set a scene first");
    return suggest(prepared(), nullptr);
  }
  // Nobody draws by the caller's look, who wants to hear of it all the same.
  if (parts_.front().rule) return {"points", "every point is drawn by a rule"};
  const analysis::SortedCloud& sorted = unmeasured_.front().sorted;
  return suggest(sorted.cloud, sorted.tree.get());
}

void Session::set_color(const ColorSettings& wanted) {
  options_.color = wanted;
  if (is_empty_) return;  // `measure` colours by them
  std::vector<const PreparedCloud*> clouds;
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (wanted.color_by == "normal") complete(k, Attribute::normal, no_progress());
    if (wanted.color_by == analysis::density_name)
      renderer_.complete(
          k, [](const PreparedCloud& of) { return !of.cloud.scalar(analysis::density_name); },
          [](PreparedCloud& of) { add_density(of.cloud); });
    clouds.push_back(&prepared(k));
  }
  std::vector<std::vector<Rgba8>> colors = color(clouds);
  for (std::size_t k = 0; k < parts_.size(); ++k) renderer_.set_colors(std::move(colors[k]), k);
}

void Session::set_background(const std::optional<vec3>& background) { options_.background = background; }

void Session::complete(std::size_t part, Attributes needs, Progress& progress) {
  renderer_.complete(
      part, [&](const PreparedCloud& of) { return !of.lacking(needs).empty(); },
      [&](PreparedCloud& of) { analysis::complete(of, needs, options_.prepare, progress); });
}

void Session::complete(const Look& look, Progress& progress) {
  for (std::size_t k = 0; !is_empty_ && k < parts_.size(); ++k)
    complete(k, (parts_[k].look ? *parts_[k].look : look).technique->needs(), progress);
}

bool Session::complete(Attributes attributes, Progress& progress) {
  if (is_empty_ || parts_.front().rule || attributes.without(renderer_.prepared().available).empty())
    return false;
  complete(0, attributes, progress);
  return true;
}

void Session::forget_programs() {
  renderer_.forget_programs();
  for (Part& part : parts_)
    if (part.rule) part.look = part.rule->look(Look(part.rule->technique));
}

std::vector<Item> Session::resolve(const Look& look, RenderSettings& settings, const Camera& camera,
                                   Progress& progress) {
  if (is_empty_) throw Error(ErrorCode::usage, "nothing to render: there is no scene yet");
  std::vector<Item> items;
  const bool is_photographed = are_photographed_ && settings.shadows == Shadows::off &&
                               Light::parse(settings.light_text).kind == Light::Kind::shoulder;
  bool has_hard_edges = false;
  // Shadows on a ground show on white, as in the figures of papers; and who asks for no background puts the
  // picture on a page.
  bool is_on_paper = settings.transparent || (settings.ground && casts_shadows(settings.shadows));
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (Look* by_rule = parts_[k].look.get()) {
      by_rule->take_over(look, true);
      for (const auto& [name, value] : parts_[k].rule->parameters) by_rule->set(name, value);
    }
    const Look& own = parts_[k].look ? *parts_[k].look : look;
    RenderSettings& its = parts_[k].look ? parts_[k].look->settings : settings;
    complete(k, own.technique->needs(), progress);
    is_on_paper = is_on_paper || own.technique->is_on_paper();
    has_hard_edges = has_hard_edges || !own.technique->has_soft_edges();
    // Seen in parallel, a plane has one angle to view and light: a highlight would lift all of its colours.
    const bool has_highlights = coloring_.kind == ColorKind::rgb && !camera.orthographic();
    its.phong.resolve(is_photographed, !has_highlights);
    its.palette = palette_;
    items.push_back({k, own.technique.get(), &its});
  }
  settings.background = background_ = options_.background.value_or(is_on_paper ? vec3(1) : contrasting_);
  settings.photographed = are_photographed_;
  const float edl = edl_strength(items, are_photographed_);
  settings.edl.resolve(edl > 0);
  settings.edl_strength.resolve(edl > 0 ? edl : RenderSettings::usual_edl);
  settings.ambient_occlusion.resolve(settings.shading == Shading::lit ? RenderSettings::usual_occlusion : 0);
  settings.radiance_scaling.resolve(
      settings.shading == Shading::lit && !are_photographed_ ? RenderSettings::usual_scaling : 0);
  settings.smooth_outlines.resolve(settings.samples == 1 && has_hard_edges);
  if (casts_shadows(settings.shadows) && !shadow_box_) {
    std::vector<const PointCloud*> clouds;
    for (const Item& item : items) clouds.push_back(&cloud(item.cloud));
    shadow_box_ = bounds_without_strays(clouds);
  }
  resolve_shadow_sizes(settings, shadow_box_.value_or(pose_.subject.box), spacing_);
  return items;
}

RenderOutput Session::finish(RenderOutput out, const Look& look, RenderSettings settings) const {
  out.settings = std::move(settings);
  if (options_.draw.empty()) return out;
  out.notes.clear();
  for (const Part& part : parts_) {
    const Look& own = part.look ? *part.look : look;
    for (const std::string& note : own.technique->notes()) out.notes.push_back(own.name + ": " + note);
  }
  return out;
}

RenderOutput Session::render(const Look& look, const Camera& camera, const RenderWants& wants,
                             Progress& progress) {
  RenderSettings settings = look.settings;
  const std::vector<Item> items = resolve(look, settings, camera, progress);
  return finish(renderer_.render(items, camera, settings, wants, progress), look, settings);
}

bool Session::merges(const Look& look, const Camera& camera) const {
  return options_.draw.empty() && renderer_.merges(*look.technique, camera, look.settings);
}

VisiblePoints Session::visible(const Look& look, const Camera& camera, const VisiblePoints* merged,
                               Progress& progress) {
  RenderSettings settings = look.settings;
  const std::vector<Item> items = resolve(look, settings, camera, progress);
  VisiblePoints visible = renderer_.visible(*items.front().technique, camera, settings, merged, progress);
  if (const auto& numbers = parts_.front().source_index) {
    for (std::uint32_t& number : visible.number)
      if (number != VisiblePoints::nothing) number = (*numbers)[number];
    for (VisiblePoints::SeenThrough& point : visible.seen_through) point.number = (*numbers)[point.number];
    std::sort(visible.seen_through.begin(), visible.seen_through.end());
  }
  return visible;
}

RenderOutput Session::render_merged(const VisiblePoints& merged, const Look& look, const Camera& camera,
                                    const RenderWants& wants, Progress& progress) {
  RenderSettings settings = look.settings;
  const std::vector<Item> items = resolve(look, settings, camera, progress);
  return finish(renderer_.render_merged(merged, *items.front().technique, camera, settings, wants, progress),
                look, settings);
}

RenderOutput Session::render_rows(const Look& look, const Camera& camera, const RenderWants& wants,
                                  const RowSink& sink, Progress& progress) {
  RenderSettings settings = look.settings;
  const std::vector<Item> items = resolve(look, settings, camera, progress);
  return finish(renderer_.render_rows(items, camera, settings, wants, sink, progress), look, settings);
}

RenderOutput Session::render_panorama(const Look& look, const Camera& camera, const RenderWants& wants,
                                      Progress& progress) {
  RenderSettings settings = look.settings;
  const std::vector<Item> items = resolve(look, settings, camera, progress);
  return finish(sfumato::render_panorama(renderer_, items, camera, up_vector(pose_.upright.up), settings,
                                         wants, progress),
                look, settings);
}

}  // namespace sfumato
