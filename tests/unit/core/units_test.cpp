#include "core/units.h"

#include <gtest/gtest.h>

namespace sfumato {
namespace {

constexpr const char* projected_feet =
    R"(PROJCS["x",GEOGCS["g",UNIT["degree",0.0174532925199433]],PARAMETER["false_easting",1312335.958],UNIT["foot",0.3048]])";

TEST(Units, AreThoseOfTheAxesInWkt) {
  EXPECT_EQ(horizontal_unit(projected_feet).symbol, "ft");
  EXPECT_DOUBLE_EQ(horizontal_unit(projected_feet).metres, 0.3048);
  EXPECT_EQ(horizontal_unit(R"(PROJCS["x",UNIT["US survey foot",0.304800609601219]])").symbol, "ft");
  EXPECT_EQ(
      horizontal_unit(R"wkt(PROJCRS["x",CS[Cartesian,2],AXIS["(E)",east,LENGTHUNIT["metre",1]]])wkt").symbol,
      "m");
  EXPECT_EQ(horizontal_unit(R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])").symbol, "°");
  EXPECT_EQ(horizontal_unit("EPSG:2994").symbol, "units");
  EXPECT_EQ(horizontal_unit("").metres, 0);
}

TEST(Units, HeightsHaveTheirOwn) {
  std::string compound = R"(COMPD_CS["c",)";
  compound.append(projected_feet).append(R"(,VERT_CS["h",VERT_DATUM["d",2005],UNIT["metre",1]]])");
  EXPECT_EQ(vertical_unit(compound).symbol, "m");
  EXPECT_EQ(horizontal_unit(compound).symbol, "ft");
  EXPECT_EQ(vertical_unit(projected_feet).symbol, "ft");
  EXPECT_EQ(vertical_unit(R"(GEOGCS["WGS 84",UNIT["degree",0.0174532925199433]])").symbol, "m");
}

TEST(Units, AreNamed) {
  EXPECT_DOUBLE_EQ(unit_named("ft-us").metres, 1200.0 / 3937);
  EXPECT_EQ(unit_named("cubits").symbol, "cubits");
  EXPECT_EQ(unit_named("cubits").metres, 0);
}

}  // namespace
}  // namespace sfumato
