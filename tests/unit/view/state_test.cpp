// Undo, paths, controls, requests, picking and keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <set>

#include "core/error.h"
#include "io/camera_json.h"
#include "session/first_view.h"
#include "session/option_samples.h"
#include "session/request.h"
#include "session/camera_request.h"
#include "view/controls.h"
#include "view/history.h"
#include "view/key_frames.h"
#include "view/keys.h"
#include "view/picking.h"
#include "view/view_request.h"

namespace sfumato::view {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(History, UndoesAndRedoesAndForgetsWhatWasUndone) {
  History<int> history(1);
  history.record(2, "a", 0);
  history.record(3, "b", 5000);
  EXPECT_EQ(history.undo(), 2);
  EXPECT_EQ(history.undo(), 1);
  EXPECT_FALSE(history.can_undo());
  EXPECT_EQ(history.undo(), 1);
  EXPECT_EQ(history.redo(), 2);
  history.record(7, "c", 9000);
  EXPECT_FALSE(history.can_redo());
  EXPECT_EQ(history.undo(), 2);
}

TEST(History, OneDragIsOneStep) {
  History<int> history(0);
  for (int i = 1; i <= 50; ++i) history.record(i, "slider", 16 * i);
  history.record(51, "slider", 5000);  // another drag
  EXPECT_EQ(history.undo(), 50);
  EXPECT_EQ(history.undo(), 0);
  EXPECT_FALSE(history.can_undo());
}

TEST(History, AmendsStatesWithoutAStep) {
  History<int> history(1);
  history.record(2, "a", 0);
  history.record(3, "b", 5000);
  history.undo();
  history.amend([](int& each) { each += 10; });
  EXPECT_EQ(history.redo(), 13);
  EXPECT_EQ(history.undo(), 12);
  EXPECT_EQ(history.undo(), 11);
  EXPECT_FALSE(history.can_undo());
}

TEST(History, KeepsSoManyAndNoMore) {
  History<int> history(0, 5);
  for (int i = 1; i <= 20; ++i) history.record(i, std::to_string(i), 2000 * i);
  int steps = 0;
  while (history.can_undo()) history.undo(), ++steps;
  EXPECT_EQ(steps, 4);
}

ViewCamera key(double x) { return {{x, -5, 1}, {0, 0, 0}, {0, 0, 1}, 45, false}; }

TEST(KeyFrames, ShowWhatTheCommandShows) {
  KeyFrames path;
  for (double x : {0.0, 3.0, 4.0, -2.0}) path.add(key(x));
  EXPECT_EQ(path.duration_s(), 6);
  std::vector<Camera> keys;
  for (const ViewCamera& each : path.keys()) keys.push_back(each.to_camera(1280, 720));
  const int frames = 97;
  const std::vector<Camera> command = interpolate(keys, frames);
  for (int i = 0; i < frames; ++i) {
    const ViewCamera shown = path.at(path.duration_s() * i / (frames - 1));
    EXPECT_LT(glm::length(shown.position - command[std::size_t(i)].position), 1e-12) << i;
  }
  EXPECT_EQ(path.at(-1).position, key(0).position);
  EXPECT_LT(glm::length(path.at(100).position - key(-2).position), 1e-12);
}

TEST(KeyFrames, AreEditedSavedAndRead) {
  KeyFrames path;
  for (double x : {0.0, 1.0, 2.0}) path.add(key(x));
  path.move(0, 2);
  EXPECT_EQ(path.keys()[2].position.x, 0);
  path.replace(0, key(9));
  path.remove(1);
  path.remove(77);
  ASSERT_EQ(path.keys().size(), 2u);
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("path_" + std::to_string(getpid()) + ".json");
  path.save(file, 640, 480);
  KeyFrames back;
  back.load(file);
  std::filesystem::remove(file);
  EXPECT_EQ(back.keys(), path.keys());
  EXPECT_THROW(back.load("no such file"), Error);
  EXPECT_EQ(back.keys().size(), 2u);
}

TEST(Controls, AreThoseOfTheParameterList) {
  for (const TechniqueInfo& info : all_techniques()) {
    const Look look(info);
    const std::vector<Control> controls = controls_of(look);
    EXPECT_EQ(controls.size(), look.parameters.all().size()) << info.name;
    for (const Control& each : controls) {
      const Param* param = look.parameters.find(each.name);
      ASSERT_TRUE(param) << each.name;
      EXPECT_FALSE(each.is_changed) << each.name;
      EXPECT_THAT(each.tooltip, HasSubstr(param->help_text));
      EXPECT_THAT(each.tooltip, HasSubstr(param->paper_text));
      EXPECT_FALSE(each.group.empty());
      if (each.kind == ParamKind::real || each.kind == ParamKind::integer) {
        EXPECT_LT(each.low, each.high) << each.name;
        if (param->min) EXPECT_GE(each.low, *param->min) << each.name;
        if (param->max) EXPECT_LE(each.high, *param->max) << each.name;
      }
      if (each.kind == ParamKind::choice) EXPECT_THAT(each.choices, Contains(each.value)) << each.name;
    }
  }
}

TEST(Controls, GroupsStayTogetherAndTheOwnComeFirst) {
  const Look look("surface");
  std::vector<std::string> groups;
  for (const Control& each : controls_of(look))
    if (groups.empty() || groups.back() != each.group) groups.push_back(each.group);
  EXPECT_EQ(groups.front(), "surface");
  EXPECT_EQ(std::set<std::string>(groups.begin(), groups.end()).size(), groups.size());
}

TEST(Controls, AreSearchedByNameHelpAndSymbol) {
  const Look look("surface");
  const auto names = [&](const std::string& search) {
    std::vector<std::string> found;
    for (const Control& each : controls_of(look, search)) found.push_back(each.name);
    return found;
  };
  EXPECT_THAT(names("Hidden Removal"), Contains("hidden_point_removal"));
  EXPECT_THAT(names("hidden removal"), Not(Contains("ambient")));
  EXPECT_THAT(names("k_a"), Contains("ambient"));
  EXPECT_TRUE(names("no such thing").empty());
}

TEST(Controls, SayWhatIsAutomaticAndWhatChanged) {
  Look look("surface");
  look.set("disc-scale", "2.5");
  look.set("point-spacing", "0.25");
  for (const Control& each : controls_of(look)) {
    if (each.name == "disc_scale") EXPECT_TRUE(each.is_changed && !each.can_be_auto && each.value == "2.5");
    if (each.name == "point_spacing") EXPECT_TRUE(each.is_changed && each.can_be_auto && !each.is_auto);
    if (each.name == "removal_scale") EXPECT_TRUE(!each.is_changed && each.is_auto);
  }
}

TEST(ViewRequest, SaysTheCommandThatItIs) {
  ViewRequest view_request;
  view_request.files = {"a scan.laz"};
  view_request.technique = "surface";
  view_request.camera = {{1.5, -2.25, 0.1}, {0, 0, 0}, {0, 0, 1}, 45, false};
  const std::vector<std::string> plain = view_request.words(640, 480);
  EXPECT_EQ(plain, (std::vector<std::string>{"a scan.laz", "-t", "surface", "--resolution=640x480",
                                             "--camera-position=1.5,-2.25,0.1", "--camera-focal-point=0,0,0",
                                             "--camera-view-up=0,0,1"}));
  view_request.set("disc_scale", "2");
  view_request.set("shadows", "hard");
  view_request.set("neighbors", "16");
  view_request.hide_classes = {2};
  view_request.points.selection.crop = Bounds{{-1, 0, 0}, {1, 2, 3}};
  view_request.color.color_by = "elevation";
  view_request.camera.fov_deg = 30;
  view_request.camera.orthographic = true;
  const std::vector<std::string> words = view_request.words(640, 480);
  for (const char* each :
       {"--disc-scale=2", "--shadows=hard", "--neighbors=16", "--hide-classes=2", "--crop=-1,0,0,1,2,3",
        "--color-by=elevation", "--camera-view-angle=30", "--camera-orthographic"})
    EXPECT_THAT(words, Contains(each));
}

TEST(ViewRequest, SayOrthographicViewsThatTheCommandFinds) {
  ViewRequest view_request;
  view_request.files = {"a.laz"};
  for (const double angle : {45.0, 30.0}) {
    view_request.camera = {{1.5, -2.25, 0.1}, {0, 0.5, 0}, {0, 0, 1}, angle, true};
    Request request;
    for (const std::string& word : view_request.words(640, 480))
      if (const std::size_t end = word.find('='); word.starts_with("--camera-"))
        set(request, word.substr(2, end - 2), end == word.npos ? "true" : word.substr(end + 1));
    request.view.size = {640, 480};
    Pose pose;  // whatever the scan is
    pose.subject.box = {{-40, -40, -3}, {40, 70, 9}};
    pose.subject.points = {pose.subject.box.min, pose.subject.box.max};
    const Camera found = view_of(pose, request.view), shown = view_request.camera.to_camera(640, 480);
    EXPECT_EQ(found.view(), shown.view());
    EXPECT_EQ(found.pixels_per_unit(), shown.pixels_per_unit()) << angle;
  }
}

TEST(ViewRequest, SayItemsAndWhereFilesAre) {
  ViewRequest view_request;
  view_request.files = {"a.laz", "b.laz"};
  view_request.technique = "splats";
  view_request.items = {DrawRow::from("class 3-5:  soft  opacity=0.2"), {"z 3..", "surface", "", false}};
  dmat4 moved(1);
  moved[3] = {12.5, 0, -1, 1};
  view_request.placed = {std::nullopt, moved};
  const std::vector<std::string> words = view_request.words(64, 48);
  EXPECT_THAT(words, Contains("--draw=class 3-5: soft opacity=0.2"));
  EXPECT_THAT(words, Contains("--draw=z 3..: none"));  // what is not visible
  EXPECT_THAT(words, Contains("--transform=2: 1,0,0,12.5,0,1,0,0,0,0,1,-1,0,0,0,1"));
  EXPECT_EQ(view_request.session_options().draw.size(), 2u);
  ViewRequest shown = view_request;
  shown.items[1].visible = true;
  EXPECT_NE(shown.scene_key(), view_request.scene_key());
  EXPECT_THAT(shown.words(64, 48), Contains("--draw=z 3..: surface"));
  view_request.items[0].technique = "sofd";
  EXPECT_THROW((void)view_request.session_options(), Error);
}

TEST(ViewRequest, KeepParametersByTechniqueAndShareWhatIsShared) {
  ViewRequest view_request;
  view_request.technique = "surface";
  view_request.set("disc_scale", "2");
  view_request.set("ambient", "0.5");
  view_request.technique = "points";
  EXPECT_EQ(view_request.parameters_of("points"), (NamesAndValues{{"ambient", "0.5"}}));
  EXPECT_EQ(view_request.parameters_of("surface"), (NamesAndValues{{"ambient", "0.5"}, {"disc_scale", "2"}}));
  EXPECT_THROW(view_request.set("disc_scale", "2"), Error);
  EXPECT_THROW(view_request.set("ambient", "7"), Error);
  view_request.set("ambient", "auto");  // the default is no setting
  EXPECT_TRUE(view_request.parameters_of("points").empty());
}

// A saved scene looks the same in whatever window it is opened.
TEST(ViewRequest, TakeBackTheOptionsThatTheyGave) {
  ViewRequest plain, coloured;
  coloured.color.color_by = "classification", coloured.color.colormap = "turbo";
  coloured.color.exposure = 2, coloured.color.range = {1, 5};
  coloured.background = vec3(0), coloured.whole = true;
  coloured.furniture.legend = coloured.furniture.scale_bar = true, coloured.furniture.title = "Site 4";
  coloured.items = {DrawRow::from("class 3: soft")};
  ViewRequest single;
  set(single, "color", "steelblue");
  for (const ViewRequest& saved : {plain, coloured, single})
    for (ViewRequest window : {plain, coloured, single}) {
      window.take_options(saved.options());
      EXPECT_EQ(window.options(), saved.options());
      EXPECT_EQ(window, saved);
    }
}

// What windows have of a request is in the command that they give, whatever options come.
TEST(ViewRequest, SayEveryOptionThatTheyTake) {
  const ViewRequest plain;
  for (const Option& option : request_options()) {
    if (option.scope != Option::Scope::look && option.scope != Option::Scope::place) continue;
    ViewRequest view_request;
    const std::string text = sample_of(option);
    ASSERT_FALSE(text.empty()) << option.name();
    view_request.take_options({{option.name(), text}});
    if (view_request == plain) continue;  // nothing that windows show
    ViewRequest again;
    again.take_options(view_request.options());
    EXPECT_EQ(again, view_request) << option.name();
    EXPECT_NE(view_request.words(1, 1), plain.words(1, 1)) << option.name();
  }
}

TEST(ViewRequest, KeysTellWhatHasToBeDoneAnew) {
  ViewRequest view_request;
  view_request.files = {"a.laz"};
  view_request.technique = "points";
  ViewRequest other = view_request;
  other.camera.position = {3, 3, 3};
  EXPECT_EQ(other.look(), view_request.look());
  EXPECT_NE(other.camera, view_request.camera);
  other = view_request;
  other.set("ambient", "0.5");
  EXPECT_NE(other.look(), view_request.look());
  EXPECT_EQ(other.scene_key(), view_request.scene_key());
  other = view_request;
  other.hide_classes = {5};
  EXPECT_NE(other.scene_key(), view_request.scene_key());
  other = view_request;
  other.color.colormap = "turbo";
  EXPECT_NE(other.color, view_request.color);
  EXPECT_EQ(other.scene_key(), view_request.scene_key());
  other = view_request;
  other.placed = {std::nullopt};  // said or not, the file stands where its points say
  EXPECT_EQ(other.scene_key(), view_request.scene_key());
  other.placed = {dmat4(2)};
  EXPECT_NE(other.scene_key(), view_request.scene_key());
  other = view_request;
  other.points.read.strict = true;
  EXPECT_EQ(other.scene_key(), view_request.scene_key());
  other.set("neighbors", "31");
  EXPECT_NE(other.scene_key(), view_request.scene_key());
}

TEST(Picking, TakesTheNearestPointInFront) {
  PointCloud cloud;
  cloud.origin = {1000, 2000, 0};
  cloud.positions = {{0, 0, 0}, {0, 3, 0}, {0.5f, 0, 0}};  // the second behind the first
  cloud.source_index = {4, 9, 2};
  cloud.set_scalar({"classification", 0, {2, 5, 6}, StoredType::uint8});
  const Camera camera =
      ViewCamera{{1000, 1990, 0}, {1000, 2000, 0}, {0, 0, 1}, 45, false}.to_camera(600, 600);
  const auto at = nearest_point(cloud, camera, 302, 299);
  ASSERT_TRUE(at);
  EXPECT_EQ(*at, 0u);
  const dvec3 third = project(camera, cloud.world(2));
  EXPECT_EQ(nearest_point(cloud, camera, third.x + 3, third.y), 2u);
  EXPECT_FALSE(nearest_point(cloud, camera, 20, 20));
  const Picked picked = describe(cloud, 2);
  EXPECT_EQ(picked.source, 2u);
  EXPECT_EQ(picked.world, dvec3(1000.5, 2000, 0));
  EXPECT_THAT(picked.attributes,
              Contains(std::pair<std::string, std::string>("classification", "6 (building)")));
}

TEST(Picking, PassesThroughWallsThatAreNotDrawn) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {0, 0, 3}};  // the floor, and the ceiling above it
  Room room;
  room.outside = {{0, 0, 1, -2}};  // z > 2
  const Camera camera = ViewCamera{{0, 0.01, 9}, {0, 0, 0}, {0, 1, 0}, 45, false}.to_camera(600, 600);
  EXPECT_EQ(nearest_point(cloud, camera, 300, 300), 1u);
  EXPECT_EQ(nearest_point(cloud, camera, 300, 300, 12, 0.02, room), 0u);
  const Ceiling ceiling{{0, 0, 1}, {0.5, 0, 0, 0.5}, {0, 0.5, 0, 0.5}, 1, {2}};  // z > 2 about the middle
  EXPECT_EQ(nearest_point(cloud, camera, 300, 300, 12, 0.02, Room{{}, ceiling}), 0u);
}

TEST(Picking, FindsInBatchesWhatItFindsInAllPoints) {
  PointCloud cloud;
  std::vector<Batch> batches;
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0, 1);
  for (int b = 0; b < 64; ++b) {
    const vec3 corner(b % 4, b / 4 % 4, b / 16);
    Batch batch{std::uint32_t(cloud.size()), 20, corner, corner + vec3(1)};
    for (unsigned i = 0; i < batch.count; ++i)
      cloud.positions.push_back(corner + vec3(place(random), place(random), place(random)));
    batches.push_back(batch);
  }
  int found = 0;
  for (const dvec3& eye : {dvec3(2, -8, 3), dvec3(2.1, 1.7, 2.2)})  // before the points, and among them
    for (const bool is_parallel : {false, true}) {
      const Camera camera = ViewCamera{eye, {2, 2, 2}, {0, 0, 1}, 60, is_parallel}.to_camera(600, 400);
      for (int y = 0; y <= 400; y += 20)
        for (int x = 0; x <= 600; x += 20) {
          const auto all = nearest_point(cloud, camera, x, y);
          EXPECT_EQ(nearest_point(cloud, camera, x, y, 12, 0.02, {}, batches), all) << x << " " << y;
          found += all.has_value();
        }
    }
  EXPECT_GT(found, 300);
}

TEST(Picking, MeasuresAlongTheUpAxis) {
  const Measure z = measure({0, 0, 0}, {3, 4, 12}, UpAxis::pos_z);
  EXPECT_DOUBLE_EQ(z.distance, 13);
  EXPECT_DOUBLE_EQ(z.height, 12);
  EXPECT_DOUBLE_EQ(z.horizontal, 5);
  EXPECT_DOUBLE_EQ(measure({0, 0, 0}, {3, 4, 12}, UpAxis::neg_y).height, -4);
  EXPECT_EQ(coordinate_text(637123.456789, 100), "637123.457");
  EXPECT_EQ(unit_of("PROJCS[\"x\",UNIT[\"metre\",1]]"), "m");
  EXPECT_EQ(unit_of("PROJCS[\"x\",UNIT[\"US survey foot\",0.3048]]"), "ft");
  EXPECT_EQ(unit_of(""), "units");
}

TEST(Keys, EachIsBoundOnceAndExplained) {
  std::set<std::pair<int, int>> seen;
  for (const KeyBinding& each : key_bindings()) {
    EXPECT_TRUE(seen.insert({each.code, each.modifiers}).second) << each.keys << " " << each.code;
    EXPECT_EQ(each.keys.empty(), each.what.empty());
    EXPECT_EQ(action_of(each.code, each.modifiers), each.action);
  }
  EXPECT_FALSE(action_of('W', none));  // flies
  EXPECT_THAT(key_tables(), HasSubstr("| P, F9 |"));
}

// The page shows the tables that the code makes.
TEST(Keys, AreThoseOfTheDocumentation) {
  std::ifstream file(std::filesystem::path(SFUMATO_SOURCE_DIR) / "docs" / "viewer.md");
  const std::string page((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(page, HasSubstr(key_tables())) << "docs/viewer.md lacks:\n" << key_tables();
}

}  // namespace
}  // namespace sfumato::view
