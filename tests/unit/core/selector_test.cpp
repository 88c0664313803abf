#include "core/selector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

using namespace sfumato;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

namespace {

/// Five points along x at 100..104, classes 2, 3, 4, 6, 9 and heights -2..2.
PointCloud row() {
  PointCloud cloud;
  cloud.origin = {100, 0, 0};
  for (int i = 0; i < 5; ++i) cloud.positions.push_back({float(i), 0, float(i - 2)});
  cloud.set_scalar({"classification", 0, {2, 3, 4, 6, 9}, StoredType::uint8});
  cloud.set_scalar({"my height", 0.5, {0, 1, 2, 3, 4}, StoredType::float32});
  return cloud;
}

std::vector<int> chosen(const std::string& text, const PointCloud& cloud = row()) {
  std::vector<int> places;
  const std::vector<bool> flags = Selector::parse(text).matches(cloud);
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (flags[i]) places.push_back(int(i));
  return places;
}

std::string complaint(const std::string& text) {
  try {
    chosen(text);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    return error.what();
  }
  return "";
}

TEST(SelectorTest, TermsChoosePoints) {
  EXPECT_THAT(chosen("*"), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(chosen("classification 3-5"), ElementsAre(1, 2));
  EXPECT_THAT(chosen("class 2,6..9"), ElementsAre(0, 3, 4));
  EXPECT_THAT(chosen("classification ground, high vegetation,water"), ElementsAre(0, 4));
  EXPECT_THAT(chosen("z -2--1"), ElementsAre(0, 1));
  EXPECT_THAT(chosen("z ..-1,2"), ElementsAre(0, 1, 4));
  EXPECT_THAT(chosen("my height 2.5.."), ElementsAre(2, 3, 4)) << "the offset of the scalar counts";
  EXPECT_THAT(chosen("box 101,-1,-9,103,1,9"), ElementsAre(1, 2, 3)) << "in the world, rims included";
}

TEST(SelectorTest, NamesOfGroupsAreEveryClassThatEndsSo) {
  EXPECT_THAT(chosen("class vegetation"), ElementsAre(1, 2));
  EXPECT_THAT(chosen("class vegetation,building"), ElementsAre(1, 2, 3));
  EXPECT_THAT(chosen("class ground"), ElementsAre(0));
  EXPECT_THAT(complaint("class tation"), HasSubstr("tation"));
}

TEST(SelectorTest, TermsAreJoinedByAndAndTurnedByNot) {
  EXPECT_THAT(chosen("not class ground"), ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(chosen("class 3-9 and not z 1.. and x 102.."), ElementsAre(2));
  EXPECT_THAT(chosen("not not z 2"), ElementsAre(4));
  EXPECT_THAT(chosen("not *"), ElementsAre());
}

TEST(SelectorTest, ASingleFileIsTheFirst) {
  EXPECT_THAT(chosen("file 1"), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(chosen("file 2"), ElementsAre());
  PointCloud two = row();
  two.set_scalar({"file", 0, {1, 1, 2, 2, 2}, StoredType::uint16});
  EXPECT_THAT(chosen("file 2", two), ElementsAre(2, 3, 4));
}

TEST(SelectorTest, WhatIsNotUnderstoodIsNamed) {
  EXPECT_THAT(complaint("class grund"), HasSubstr("did you mean 'ground'"));
  EXPECT_THAT(complaint("z 3..1"), HasSubstr("is empty"));
  EXPECT_THAT(complaint("z"), HasSubstr("'z' has no range"));
  EXPECT_THAT(complaint("z 1 and"), HasSubstr("'and' is no number")) << "a joint without a second term";
  EXPECT_THAT(complaint("box 1,2,3"), HasSubstr("six numbers"));
  EXPECT_THAT(complaint("box 1,0,0,0,1,1"), HasSubstr("box is empty"));
  EXPECT_THAT(complaint("hight 3"), HasSubstr("the points have no 'hight'"));
  EXPECT_THAT(complaint("z .."), HasSubstr("is no number"));
}

}  // namespace
