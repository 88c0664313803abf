#include "core/param.h"

#include <gtest/gtest.h>

#include "core/error.h"

using namespace sfumato;

namespace {

enum class Mode { adaptive, pixels };

TEST(Param, EveryKindReadsBackItsOwnText) {
  bool flag = false;
  int count = 3;
  float size = 0.1f;
  std::string text = "x";
  std::vector<float> list{0.3f, 0.5f};
  vec3 axis{1, 2, 3};
  Mode mode = Mode::adaptive;
  Auto<float> spacing;
  ParamList p;
  p.add("flag", flag);
  p.add("count", count).range(1, 9);
  p.add("size", size);
  p.add("text", text);
  p.add("list", list).range(0, 1);
  p.add("axis", axis);
  p.add("mode", mode, {"adaptive", "pixels"});
  p.add("spacing", spacing).at_least(0);
  for (auto [name, value] : {std::pair{"flag", "true"},
                             {"count", "7"},
                             {"size", "0.25"},
                             {"text", "hello"},
                             {"list", "0.1,0.2,1"},
                             {"axis", "0,-1,0.5"},
                             {"mode", "pixels"},
                             {"spacing", "0.5"},
                             {"spacing", "auto"}}) {
    p.find(name)->set(value);
    EXPECT_EQ(p.find(name)->get(), value);
  }
  EXPECT_EQ(mode, Mode::pixels);
  EXPECT_TRUE(spacing.is_auto());
  spacing.resolve(0.125f);
  EXPECT_EQ(p.find("spacing")->resolved(), "0.125");
  EXPECT_EQ(p.find("size")->default_text, "0.1");
}

TEST(Param, RefusesAndKeepsTheOldValue) {
  int count = 3;
  Mode mode = Mode::adaptive;
  ParamList p;
  p.add("point_count", count).range(1, 9);
  p.add("mode", mode, {"adaptive", "pixels"});
  EXPECT_THROW(p.find("point-count")->set("10"), Error);
  EXPECT_THROW(p.find("point_count")->set("2.5"), Error);
  EXPECT_EQ(count, 3);
  try {
    p.find("mode")->set("pixel");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_STREQ(error.what(),
                 "parameter 'mode': 'pixel' is not one of: adaptive | pixels; did you mean pixels?");
  }
  EXPECT_EQ(nearest_word("point_siz", {"point_size", "size_mode"}), "point_size");
  EXPECT_EQ(nearest_word("gpu", {"up"}), "") << "two of three letters differ";
  EXPECT_EQ(nearest_word("on", {"off", "hard"}), "");
  EXPECT_EQ(nearest_word("RGB", {"auto", "rgb"}), "rgb") << "case makes no other word";
  EXPECT_EQ(nearest_word("Point-Size", {"point_size", "size_mode"}), "point_size");
  EXPECT_EQ(nearest_word("zebra", {"point_size", "size_mode"}), "");
}

TEST(Param, CountsAreWrittenAsPeopleWriteThem) {
  const std::pair<const char*, double> counts[] = {{"12", 12},  {"1e6", 1e6},   {"250k", 250e3},
                                                   {"2M", 2e6}, {"1.5M", 15e5}, {"2.3M", 2300000},
                                                   {"1G", 1e9}, {"+7", 7}};
  for (const auto& [text, value] : counts) EXPECT_EQ(parse_count(text), value) << text;
  for (const char* text : {"", "M", "1.5", "2MM", "ten", "1e400", "nan", "1,000"})
    EXPECT_FALSE(parse_count(text)) << text;
}

TEST(Param, ASwitchWithKindsIsToldToSayWhich) {
  enum class Kind { off, hard, soft } kind = Kind::off;
  ParamList list;
  Param& param = list.add("shadows", kind, {"off", "hard", "soft"});
  try {
    param.set("on");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("say which: hard or soft"), std::string::npos) << error.what();
  }
}

}  // namespace
