// Ctrl-C while points are measured.
#include "analysis/prepare.h"
#include "clouds.h"
#include "reference/patience.h"

using namespace sfumato;
using sfumato::testing::expect_stops;

namespace {

constexpr Attributes everything = Attributes(Attribute::normal) | Attribute::radius | Attribute::uncertainty |
                                  Attribute::cluster | Attribute::support;

TEST(Cancel, MeasuringStops) {
  PointCloud cloud;
  cloud.positions = test::noisy_sphere(100'000, 1, 0.01f);
  expect_stops("prepare", 8, 8,
               [&](Progress& progress) { analysis::prepare(cloud, everything, {}, progress); });
}

/// Where every point has as many neighbours as one asks for, and the tree cannot be balanced.
TEST(Cancel, ManyPointsInOnePlaceStop) {
  PointCloud cloud;
  cloud.positions = test::noisy_sphere(100'000, 1, 0.01f);
  cloud.positions.resize(200'000, vec3(0.5f));
  expect_stops("coincident", 8, 6,
               [&](Progress& progress) { analysis::prepare(cloud, everything, {}, progress); });
}

}  // namespace
