#include <epoxy/gl.h>  // before anything of VTK that brings other loaders
#include "vtkSfumatoMapper.h"

#include <sfumato/embedded.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <vector>

#include "cloud_of_blocks.h"
#include "gl/host_canvas.h"
#include "levels_of_file.h"
#include "passes/light.h"
#include "ranks.h"
#include "session/choice.h"
#include "session/look.h"
#include "session/part_renderer.h"
#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkMath.h"
#include "vtkMatrix4x4.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkScalarsToColors.h"
#include "vtkSmartPointer.h"
#include "vtkTimerLog.h"
#include "vtkUnsignedCharArray.h"
#include "vtkWeakPointer.h"

namespace {

sfumato::dmat4 columns_of(const vtkMatrix4x4& rows) {
  sfumato::dmat4 out;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) out[column][row] = rows.GetElement(row, column);
  return out;
}

/// Those that differ from the technique's own.
sfumato::Parameters changed_parameters(const std::string& technique,
                                       const std::map<std::string, std::string>& given, bool* casts_shadows = nullptr) {
  const bool is_auto = technique == sfumato::automatic_technique;
  sfumato::Look look(is_auto ? "points" : technique);
  for (const auto& [name, value] : given) {
    const std::size_t dot = name.find('.');
    if (dot == std::string::npos) look.set(name, value);
    else if (!is_auto && name.compare(0, dot, technique) == 0) look.set(name.substr(dot + 1), value);
  }
  look.check();
  if (casts_shadows) *casts_shadows = sfumato::casts_shadows(look.settings.shadows);
  sfumato::Parameters out = look.changed();
  return out;
}

std::vector<vtkPolyData*> blocks_of(vtkDataObject* input) {
  std::vector<vtkPolyData*> out;
  if (auto* composite = vtkCompositeDataSet::SafeDownCast(input)) {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
      if (auto* block = vtkPolyData::SafeDownCast(it->GetCurrentDataObject())) out.push_back(block);
  } else if (auto* block = vtkPolyData::SafeDownCast(input)) {
    out.push_back(block);
  }
  return out;
}

}  // namespace

/// Frames a second that ParaView asks for while somebody moves the view; for the last picture it asks for .002.
constexpr double rate_of_moving = 0.1;

struct vtkSfumatoMapper::State {
  std::unique_ptr<sfumato::EmbeddedRenderer> renderer;
  vtkWeakPointer<vtkWindow> window;  ///< in whose context it draws
  std::string shown;                 ///< as DescribeInput has it
  bool is_empty = true;              ///< there is no point to draw
  // Where points are spread over ranks:
  std::unique_ptr<sfumato::PartRenderer> part;
  std::unique_ptr<sfumato::gl::HostCanvas> canvas;
  std::uint64_t pictures = 0;
  std::shared_ptr<const sfumato::WholeCloud> whole;
  // Of the points that are shown; all: they were gathered.
  bool has_part = false, has_all = false;
  // Of a file with levels what the last view needed, in place of the input.
  std::shared_ptr<LevelsOfFile> levels;
  sfumato::copc::NodeSelection selection;
  vtkSmartPointer<vtkPolyData> detail;
  std::set<std::string> damage;  ///< that was said
};

vtkStandardNewMacro(vtkSfumatoMapper);

vtkSfumatoMapper::vtkSfumatoMapper() : Own(std::make_unique<State>()) {
  this->SetInterpolateScalarsBeforeMapping(0);  // colours of points, and no texture to look them up in
}
vtkSfumatoMapper::~vtkSfumatoMapper() = default;

void vtkSfumatoMapper::ComputeBounds() {
  vtkBoundingBox box;
  for (vtkPolyData* block : blocks_of(this->GetInputDataObject(0, 0)))
    if (block->GetPoints() && block->GetNumberOfPoints() > 0) box.AddBounds(block->GetPoints()->GetBounds());
  vtkMath::UninitializeBounds(this->Bounds);
  if (this->BoundsOfAllRanks.IsValid()) box = this->BoundsOfAllRanks;
  if (box.IsValid()) box.GetBounds(this->Bounds);
}

void vtkSfumatoMapper::SetDistributed(bool distributed) {
  this->IsDistributed = distributed;
  this->BoundsOfAllRanks.Reset();
  if (!distributed) return;
  // Each has to draw where one has points.
  this->ComputeBounds();
  vtkBoundingBox own, all;
  if (vtkMath::AreBoundsInitialized(this->Bounds)) own.SetBounds(this->Bounds);
  vtkMultiProcessController::GetGlobalController()->AllReduce(own, all);
  this->BoundsOfAllRanks = all;
}

std::vector<vtkPolyData*> vtkSfumatoMapper::Blocks() {
  if (this->Own->detail) return {this->Own->detail};
  return blocks_of(this->GetInputDataObject(0, 0));
}

std::string vtkSfumatoMapper::DescribeInput(vtkActor* actor) {
  std::string out;
  const auto add = [&](auto value) { out += std::to_string(value) + ' '; };
  for (vtkPolyData* block : this->Blocks()) {
    add(reinterpret_cast<std::uintptr_t>(block)), add(block->GetMTime());
    add(block->GetPoints() ? block->GetPoints()->GetMTime() : 0);
  }
  add(this->ScalarVisibility), add(this->ScalarMode), add(this->ColorMode), add(this->ArrayId);
  add(this->UseLookupTableScalarRange), add(this->ScalarRange[0]), add(this->ScalarRange[1]);
  if (this->ScalarVisibility && this->LookupTable) add(this->LookupTable->GetMTime());
  out += this->ArrayName ? this->ArrayName : "";
  for (int i = 0; i < 3; ++i) add(actor->GetProperty()->GetDiffuseColor()[i]);
  const vtkMatrix4x4* placement = actor->GetMatrix();
  for (int i = 0; i < 16; ++i) add(placement->GetElement(i / 4, i % 4));
  return out;
}

CloudOfBlocks vtkSfumatoMapper::CloudOf(vtkActor* actor) {
  const double* solid = actor->GetProperty()->GetDiffuseColor();
  const auto byte = [](double value) { return (unsigned char)std::lround(255 * std::clamp(value, 0.0, 1.0)); };
  CloudOfBlocks cloud(columns_of(*actor->GetMatrix()), {byte(solid[0]), byte(solid[1]), byte(solid[2]), 255});
  for (vtkPolyData* block : this->Blocks()) {
    int is_of_cells = 0;
    vtkUnsignedCharArray* colors =
        this->ScalarVisibility ? this->MapScalars(block, 1.0, is_of_cells) : nullptr;
    cloud.Add(block, is_of_cells ? nullptr : colors);
  }
  return cloud;
}

namespace {

/// Colours are the host's: as they are, though they be dark or black.
sfumato::ColorSettings colors_of_host() {
  sfumato::ColorSettings coloring{.color_by = "rgb"};
  coloring.exposure = 1;
  return coloring;
}

sfumato::HostView view_of(vtkRenderer* renderer, int& left, int& bottom) {
  sfumato::HostView view;
  renderer->GetTiledSizeAndOrigin(&view.width, &view.height, &left, &bottom);
  vtkCamera* camera = renderer->GetActiveCamera();
  view.view = columns_of(*camera->GetViewTransformMatrix());
  view.projection =
      columns_of(*camera->GetProjectionTransformMatrix(renderer->GetTiledAspectRatio(), -1, 1));
  return view;
}

/// The view of the picture of which a tile is being drawn, as of screenshots larger than the window.
sfumato::HostView whole_view_of(vtkRenderer* renderer) {
  int left = 0, bottom = 0;
  sfumato::HostView view = view_of(renderer, left, bottom);
  const int* tiles = renderer->GetRenderWindow()->GetTileScale();
  const double* tile = renderer->GetRenderWindow()->GetTileViewport();
  if (tiles[0] <= 1 && tiles[1] <= 1) return view;
  sfumato::dmat4 whole(1);
  for (int k = 0; k < 2; ++k) whole[k][k] = tile[k + 2] - tile[k], whole[3][k] = tile[k + 2] + tile[k] - 1;
  view.projection = whole * view.projection;
  view.width *= tiles[0], view.height *= tiles[1];
  return view;
}

}  // namespace

void vtkSfumatoMapper::ChooseDetail(vtkRenderer* renderer, vtkActor* actor, bool is_distributed) {
  State& own = *this->Own;
  std::shared_ptr<LevelsOfFile> levels;
  bool is_other = false;
  for (vtkPolyData* block : blocks_of(this->GetInputDataObject(0, 0))) {
    std::shared_ptr<LevelsOfFile> found = LevelsOfFile::Of(*block);
    is_other = is_other || (block->GetNumberOfPoints() > 0 && (!found || (levels && levels != found)));
    if (found) levels = std::move(found);
  }
  // Boxes of nodes are where the file's points are.
  is_other = is_other || columns_of(*actor->GetMatrix()) != sfumato::dmat4(1);
  sfumato::HostView view = whole_view_of(renderer);
  bool is_moving = renderer->GetRenderWindow()->GetDesiredUpdateRate() > rate_of_moving;
  int who = levels ? Ranks::Own() : -1;
  if (is_distributed) {
    is_other = Ranks::Any(is_other), who = Ranks::Most(who);
    // All read for the view of the first.
    Bytes bytes;
    bytes.Put(view), bytes.Put(is_moving);
    Ranks::Broadcast(bytes);
    bytes.Take(view), bytes.Take(is_moving);
  }
  if (is_other || who < 0) {
    own.levels.reset(), own.detail = nullptr;
    return;
  }
  if (is_distributed && Ranks::Any(!levels)) {
    // A rank that got no point of the overview may have some of a view.
    Bytes bytes;
    if (Ranks::Own() == who) {
      const std::string& file = levels->File();
      bytes.PutAll(std::vector<char>(file.begin(), file.end())), bytes.Put(levels->Budget());
    }
    Ranks::Broadcast(bytes, who);
    std::vector<char> file;
    std::uint64_t budget = 0;
    bytes.TakeAll(file), bytes.Take(budget);
    Ranks::Together([&] {
      if (!levels) levels = LevelsOfFile::Named({file.begin(), file.end()}, budget);
    });
  }
  const bool is_new = is_distributed ? Ranks::Any(own.levels != levels) : own.levels != levels;
  if (is_new) own.levels = levels, own.detail = nullptr;
  if (is_moving || view.width <= 0 || view.height <= 0) return;
  const auto read = [&] {
    bool has_shadows = false;
    changed_parameters(sfumato::automatic_technique, this->Parameters, &has_shadows);
    sfumato::copc::NodeSelection wanted = levels->Select(
        sfumato::camera_of_matrices(view.view, view.projection, view.width, view.height), has_shadows);
    if (own.detail && wanted.reads_like(own.selection)) return;
    const sfumato::io::Part part{std::uint64_t(is_distributed ? Ranks::Own() : 0),
                                 std::uint64_t(is_distributed ? Ranks::Count() : 1)};
    const sfumato::io::ReadResult result = levels->Read(wanted, part);
    for (const std::string& line : result.report.damage)
      if (own.damage.insert(line).second) vtkWarningMacro(<< line);
    own.detail = vtkSmartPointer<vtkPolyData>::New();
    Fill(result, *own.detail);
    vtkTimerLog::FormatAndMarkEvent("sfumato: %llu points of %zu nodes for a view",
                                    static_cast<unsigned long long>(wanted.points), wanted.nodes_read);
    own.selection = std::move(wanted);
  };
  if (is_distributed) Ranks::Together(read);
  else read();
}

void vtkSfumatoMapper::ShowInput(vtkActor* actor) {
  CloudOfBlocks cloud = this->CloudOf(actor);
  sfumato::PointCloud points = this->IsDistributed ? cloud.TakeOfAllRanks() : cloud.Take();
  this->Own->is_empty = points.empty();
  if (points.empty()) return;
  if (!this->Own->renderer) this->Own->renderer = std::make_unique<sfumato::EmbeddedRenderer>();
  this->Own->renderer->set_cloud(std::move(points), colors_of_host());
}

void vtkSfumatoMapper::ShowPart(vtkActor* actor, const std::string& technique_with_around) {
  State& own = *this->Own;
  sfumato::PointCloud part = this->CloudOf(actor).TakeOfOwnRank();
  if (!own.has_part) {
    sfumato::analysis::CloudFacts facts = sfumato::analysis::facts_of(part);
    Ranks::MergeForAll(facts);
    own.whole.reset();
    own.is_empty = facts.points == 0;
    own.has_part = own.is_empty;
    if (own.is_empty) return;
    sfumato::analysis::NeighborhoodFacts around = neighborhood_facts_of(part, facts);
    Ranks::MergeForAll(around);
    Ranks::Together([&] { own.whole = whole_of(facts, around, part.origin); });
  }
  std::optional<sfumato::PartRenderer::Around> around;
  if (!technique_with_around.empty()) {
    sfumato::analysis::Share share = Ranks::DealOut(part, *own.whole);
    part = std::move(share.own), around = sfumato::PartRenderer::Around{std::move(share.around), technique_with_around};
  }
  // Until all have one: what failed is tried again from its facts.
  own.has_part = false;
  Ranks::Together([&] {
    if (!own.part) own.part = std::make_unique<sfumato::PartRenderer>();
    own.part->set_part(std::move(part), own.whole, colors_of_host(), std::move(around));
  });
  own.has_part = true;
}

void vtkSfumatoMapper::DrawParts(vtkRenderer* renderer, vtkActor* actor) {
  State& own = *this->Own;
  if (!own.has_part) this->ShowPart(actor, {});
  if (own.is_empty) return;
  int left = 0, bottom = 0;
  sfumato::HostView view = view_of(renderer, left, bottom);
  // All draw the view of the first, as far as its numbers go.
  Bytes bytes;
  bytes.Put(view);
  Ranks::Broadcast(bytes);
  bytes.Take(view);
  if (view.width <= 0 || view.height <= 0) return;
  const sfumato::Camera camera = sfumato::camera_of_matrices(view.view, view.projection, view.width, view.height);
  bool merges = false, lacks = false;
  int rounds = 1;
  std::string technique;
  sfumato::Parameters parameters;
  Ranks::Together([&] {
    technique = own.part->resolve(this->Technique);
    parameters = changed_parameters(technique, this->Parameters);
    merges = own.part->merges(technique, camera, parameters);
    lacks = own.part->lacks(technique, parameters), rounds = own.part->rounds(technique, parameters);
  });
  if (!merges) {
    if (!own.has_all) this->ShowInput(actor);
    own.has_all = true, own.is_empty = false;
    if (Ranks::Own() == 0) this->Draw(renderer);
    return;
  }
  if (Ranks::Any(lacks)) this->ShowPart(actor, technique);
  sfumato::VisiblePoints merged;
  std::size_t sent = 0;
  for (int round = 0; round < rounds; ++round) {
    sfumato::VisiblePoints visible;
    Ranks::Together(
        [&] { visible = own.part->visible(technique, camera, parameters, round > 0 ? &merged : nullptr); });
    // All go on from it, but for the last.
    sent += round + 1 < rounds ? Ranks::MergeForAll(visible) : Ranks::Merge(visible);
    merged.add_round(std::move(visible));
  }
  if (sent > 0) vtkTimerLog::FormatAndMarkEvent("sfumato: %zu bytes to another rank", sent);
  if (Ranks::Own() != 0) return;
  const sfumato::Pictures picture = own.part->picture(merged, technique, camera, parameters);
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  if (!own.canvas) own.canvas = std::make_unique<sfumato::gl::HostCanvas>();
  own.canvas->draw(picture.color, picture.depth, ++own.pictures, view.projection, std::uint32_t(framebuffer),
                  {left, bottom, view.width, view.height}, float(this->Opacity));
}

void vtkSfumatoMapper::Render(vtkRenderer* renderer, vtkActor* actor) {
  if (renderer->GetSelector()) return this->Superclass::Render(renderer, actor);
  this->GetInputAlgorithm()->Update();
  try {
    if (this->Own->window != renderer->GetRenderWindow()) {
      this->ReleaseGraphicsResources(nullptr);
      this->Own->window = renderer->GetRenderWindow();
    }
    const bool is_distributed = this->IsDistributed && Ranks::Count() > 1;
    this->ChooseDetail(renderer, actor, is_distributed);
    const std::string input = this->DescribeInput(actor);
    const bool is_new = input != this->Own->shown;
    if (is_distributed ? Ranks::Any(is_new) : is_new) {
      this->Own->shown = input;
      this->Own->has_part = this->Own->has_all = false;
      if (!is_distributed) this->ShowInput(actor);
      else if (this->Own->renderer) this->Own->renderer->release(), this->Own->renderer.reset();  // what was gathered
    }
    if (is_distributed) this->DrawParts(renderer, actor);
    else if (!this->Own->is_empty) this->Draw(renderer);
  } catch (const sfumato::Error& error) {
    vtkErrorMacro(<< "sfumato: " << error.what());
  }
}

void vtkSfumatoMapper::Draw(vtkRenderer* renderer) {
  int left = 0, bottom = 0;
  const sfumato::HostView view = view_of(renderer, left, bottom);
  if (view.width <= 0 || view.height <= 0) return;
  sfumato::EmbeddedRenderer& points = *this->Own->renderer;
  points.request(this->Technique, view, changed_parameters(this->Technique, this->Parameters));
  // While somebody moves the view, a picture of the view before may do; the last one is always waited for.
  const double rate = renderer->GetRenderWindow()->GetDesiredUpdateRate();
  const bool is_moving = rate > rate_of_moving && !this->IsDistributed;
  while (!points.wait(is_moving ? 1 / rate : 600) && !is_moving) {
  }
  GLint framebuffer = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  points.draw(std::uint32_t(framebuffer), {left, bottom, view.width, view.height}, float(this->Opacity));
}

void vtkSfumatoMapper::ReleaseGraphicsResources(vtkWindow* window) {
  // Names of one context mean something else in another: they are deleted in their own, or left to go with it.
  if (window && window == this->Own->window) {
    window->MakeCurrent();
    if (this->Own->renderer) this->Own->renderer->release();
    if (this->Own->canvas) this->Own->canvas->release();
  } else {
    this->Own->renderer.reset();
    this->Own->part.reset();
    this->Own->canvas.reset();
    this->Own->shown.clear();
  }
  this->Superclass::ReleaseGraphicsResources(window);
}
