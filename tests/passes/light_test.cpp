// Lights as text.
#include "passes/light.h"

#include <gtest/gtest.h>

#include <clocale>

#include "core/error.h"

using namespace sfumato;

namespace {

TEST(LightTest, IsReadFromText) {
  EXPECT_EQ(Light::parse("headlight").kind, Light::Kind::headlight);
  EXPECT_EQ(Light::parse("shoulder").kind, Light::Kind::shoulder);
  EXPECT_EQ(Light::parse("500000.25,-3,+1e2").vector, dvec3(500000.25, -3, 100));
  EXPECT_EQ(Light::parse("1, 2, 3").vector, dvec3(1, 2, 3));
  EXPECT_EQ(Light::parse("dir:0,0,2").vector, dvec3(0, 0, 1));
  for (const char* wrong :
       {"", "1,2", "1,2,3,4", "1,2,", "1,2,3 ", "dir:0,0,0", "one,2,3", "1;2;3", "1,2,inf"})
    EXPECT_THROW(Light::parse(wrong), Error) << wrong;
}

// Programs that draw with this library may write numbers with decimal commas; texts of lights do not.
TEST(LightTest, IsTheSameInEveryLocale) {
  const std::string before = std::setlocale(LC_NUMERIC, nullptr);
  bool has_commas = false;
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "it_IT.UTF-8", "es_ES.UTF-8", "ru_RU.UTF-8"})
    has_commas = has_commas || std::setlocale(LC_NUMERIC, name);
  const dvec3 read = Light::parse("0.5,1.5,2.5").vector;
  const std::string written = light_text_of(dvec3(0.6, 0, -0.8));
  std::setlocale(LC_NUMERIC, before.c_str());
  if (!has_commas) GTEST_SKIP() << "this system has no locale with decimal commas";
  EXPECT_EQ(read, dvec3(0.5, 1.5, 2.5));
  EXPECT_EQ(written, "dir:0.600000,0.000000,-0.800000");
}

}  // namespace
