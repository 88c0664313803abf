#include <gtest/gtest.h>

#include "core/error.h"
#include "synth/synth.h"

using namespace sfumato;
using namespace sfumato::synth;

namespace {

SampleOptions options_for(Sampling sampling, int points) {
  SampleOptions options;
  options.sampling = sampling;
  options.points = points;
  return options;
}

/// Distance from a point to the nearest surface along the point's normal.
double distance_to_surface(const Scene& scene, dvec3 point, dvec3 normal) {
  const double reach = 0.01;
  const Ray ray{point - reach * normal, normal};
  double nearest = 1e9;
  for (const Hit& hit : scene.intersect_all(ray)) nearest = std::min(nearest, std::abs(hit.t - reach));
  return nearest;
}

TEST(Sample, EveryNoiseFreePointLiesOnTheTrueSurface) {
  for (const std::string& name : scene_names()) {
    const Scene scene = make_scene(name);
    const PointCloud cloud = sample(scene, options_for(Sampling::area, 2000));
    ASSERT_EQ(cloud.size(), 2000u);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      // Positions are float: half a unit in the last place of 16 m is 1e-6, a rim may be missed by as much.
      const double distance = distance_to_surface(scene, cloud.world(i), glm::normalize(dvec3(cloud.normals[i])));
      EXPECT_LT(distance, 1e-5) << name << " point " << i;
    }
  }
}

TEST(Sample, UnknownSceneNamesTheKnownOnes) {
  try {
    make_scene("castle");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("courtyard"), std::string::npos);
  }
}

}  // namespace
