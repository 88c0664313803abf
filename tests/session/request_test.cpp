// The table of what a picture can be asked for (session/request.h).
#include "session/request.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include "core/error.h"
#include "option_samples.h"
#include "session/preset.h"

namespace sfumato {
namespace {

TEST(Request, NamesAndKeywordsStandOnce) {
  std::set<std::string> names, keywords;
  for (const Option& option : request_options()) {
    EXPECT_TRUE(names.insert(option.name()).second) << option.name();
    EXPECT_FALSE(option.help.empty()) << option.name();
    EXPECT_EQ(find_option(option.name()), &option);
    EXPECT_EQ(option.kind == Option::Kind::flag, option.metavar.empty()) << option.name();
    if (option.scope != Option::Scope::command && !option.value.empty())
      EXPECT_TRUE(keywords.insert(option.keyword).second) << option.keyword;
  }
}

TEST(Request, ValuesAreTyped) {
  Request request;
  set(request, "zoom", "2.5");
  set(request, "color-range", "1,3");
  set(request, "filter", "z 3..");
  set(request, "filter", "intensity 1..2");
  set(request, "hide-classes", "none");
  set(request, "background-color", "black");
  EXPECT_EQ(request.view.zoom, 2.5);
  EXPECT_EQ((*request.color.range)[1], 3);
  EXPECT_EQ(request.points.selection.filters.size(), 2u);
  EXPECT_EQ(request.background, vec3(0));
  EXPECT_FALSE(request.scene_options().selection.hide_withheld);
  EXPECT_TRUE(request.scene_options().selection.hide_classes.empty());
  for (const auto& [name, value] : {std::pair("zoom", "0"),
                                    {"exposure", "1000"},
                                    {"color-range", "1,1"},
                                    {"camera-direction", "0,0,0"},
                                    {"crop", "0,0,0,1,-1,1"},
                                    {"no-such", "1"}})
    EXPECT_THROW(set(request, name, value), Error) << name;
}

/// A request said in texts, as in a preset or a command, is read back the same.
TEST(Request, SaysWhatItWasGiven) {
  const Request plain;
  for (const Option& option : request_options()) {
    const std::string text = sample_of(option);
    ASSERT_FALSE(text.empty()) << option.name();
    EXPECT_TRUE(option.texts(plain).empty()) << option.name();
    Request request, again;
    set(request, option.name(), text);
    EXPECT_FALSE(request == plain) << option.name();
    ASSERT_EQ(option.texts(request).size(), 1u) << option.name();
    set(again, option.name(), text_of(request, option.name()));
    EXPECT_TRUE(again == request) << option.name() << ": " << text_of(request, option.name());
    option.reset(request);
    EXPECT_TRUE(request == plain) << option.name();
  }
}

TEST(Request, NoiseIsLeftOutUnlessItIsAskedFor) {
  Request request;
  set(request, "show-classes", "7,2");
  EXPECT_EQ(request.scene_options().selection.hide_classes, std::vector<int>{18});
}

TEST(Request, WhatContradictsItselfIsRefused) {
  Request request;
  set(request, "view", "top");
  set(request, "camera-position", "1,2,3");
  EXPECT_THROW(resolve_view(request), Error);
  Request on_no_paper;
  set(on_no_paper, "scale", "1:200");
  EXPECT_NO_THROW(resolve_view(on_no_paper));
  set(on_no_paper, "dpi", "0");
  EXPECT_THROW(resolve_view(on_no_paper), Error);
  Request one_point;
  set(one_point, "camera-position", "1,2,3");
  set(one_point, "camera-focal-point", "1,2,3");
  EXPECT_THROW(read_camera_file(one_point), Error);
}

/// Presets keep looks, scenes also places, and neither what is the command's alone.
TEST(Request, PresetsKeepWhatTheTableSays) {
  const auto loads = [](const std::string& name, bool has_files) {
    const std::filesystem::path file = std::filesystem::temp_directory_path() / "request_test.json";
    std::ofstream(file) << (has_files ? R"({"files": ["a.ply"], )" : "{") << R"("options": {")" << name
                        << R"(": "1"}})";
    try {
      load_preset(file);
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  for (const Option& option : request_options()) {
    const bool is_place = option.scope == Option::Scope::place,
               is_kept = option.scope != Option::Scope::command;
    EXPECT_EQ(loads(option.name(), false), is_kept && !is_place) << option.name();
    EXPECT_EQ(loads(option.name(), true), is_kept) << option.name();
  }
}

/// A stranger neither reads nor writes files of this machine, nor changes what holds for other pictures.
TEST(Request, WhatIsServedNamesNoFile) {
  int served = 0;
  for (const Option& option : request_options()) {
    if (!option.served) continue;
    ++served;
    EXPECT_NE(option.scope, Option::Scope::file) << option.name();
    for (const char* word : {"FILE", "FOLDER", "NAME_", "BYTES"})
      EXPECT_EQ(option.metavar.find(word), std::string::npos) << option.name();
    EXPECT_EQ(option.help.find(" file with"), std::string::npos) << option.name();
  }
  EXPECT_EQ(served, 32);
}

}  // namespace
}  // namespace sfumato
