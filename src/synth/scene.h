// A scene that rays can be cast into: primitives or a triangle mesh, materials, and where the simulated
// devices stand.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/point_cloud.h"
#include "synth/bvh.h"
#include "synth/material.h"
#include "synth/shapes.h"

namespace sfumato::synth {

/// ASPRS classes of the scenes; 64 and above are the user's own.
enum ClassId : std::uint8_t {
  class_never = 0,
  class_unassigned = 1,
  class_ground = 2,
  class_low_vegetation = 3,
  class_high_vegetation = 5,
  class_building = 6,    ///< outer walls, roofs, the tower
  class_stonework = 64,  ///< columns, arches, gate
  class_ceiling = 65,
  class_furniture = 66,  ///< whatever stands around: furniture, fountain, benches
};

struct Hit : SurfacePoint {
  double t = 0;
  std::uint32_t surface = 0;  ///< primitive, or primitives.size() + triangle
};

enum class Sampling {
  automatic,  ///< what suits the scene
  area,       ///< uniform by area, in random order
  scanners,   ///< terrestrial scanners: equal angular steps, one organised grid each
  cameras,    ///< RGB-D cameras: one organised picture each
  airborne,   ///< pulses from flight lines, several returns each, not organised
};

/// The way of an airborne scanner, which looks down across it.
struct FlightLine {
  dvec3 from{0}, to{0};
};

struct Scene {
  std::string name;
  std::vector<Material> materials;
  std::vector<Primitive> primitives;
  Mesh mesh;
  std::uint8_t mesh_class = class_unassigned;
  std::vector<vec3> mesh_normals;  ///< unit, per vertex, weighted by the angle of each corner
  std::vector<dvec3> scanners;     ///< terrestrial scanners, world
  std::vector<Camera> cameras;     ///< RGB-D cameras
  std::vector<FlightLine> flight_lines;
  std::optional<Camera> held_out;     ///< a camera that takes no part in the scan, to judge pictures by
  Sampling natural = Sampling::area;  ///< how `automatic` samples it
  bool equal_counts = false;          ///< every primitive gets as many points, whatever its area
  std::string piece_scalar;   ///< scalar that holds the primitive's number, if any (the tori's `layer`)
  UpAxis up = UpAxis::pos_z;  ///< meshes keep the axis of PLY and OBJ files, +Y
  Bounds box;

  /// Call once after the surfaces are complete: box and search structure.
  void build();

  /// The first crossing with t in (t_min, t_max); the normal is the surface's own (outer) one.
  std::optional<Hit> intersect(const Ray& ray, double t_min = 1e-9,
                               double t_max = std::numeric_limits<double>::infinity()) const;
  /// Every crossing with t > 0, ascending.
  std::vector<Hit> intersect_all(const Ray& ray) const;

  std::size_t surface_count() const { return primitives.size() + mesh.triangles.size(); }
  double surface_area(std::size_t surface) const;
  SurfacePoint sample_surface(std::size_t surface, Random& random) const;
  vec3 surface_albedo(std::uint32_t surface, const SurfacePoint& point) const;
  std::uint8_t surface_alpha(std::uint32_t surface) const;
  std::uint8_t surface_class(std::uint32_t surface) const;

 private:
  dvec3 barycentric(std::size_t triangle, dvec3 position) const;
  SurfacePoint describe_triangle(std::size_t triangle, dvec3 weights) const;
  std::optional<double> triangle_crossing(std::size_t triangle, const Ray& ray) const;
  SurfacePoint describe_surface(std::uint32_t surface, dvec3 position) const;

  Bvh bvh_;
};

/// Names that `make_scene` knows.
std::vector<std::string> scene_names();
/// Throws Error(usage) for an unknown name.
Scene make_scene(const std::string& name);
/// A scene of triangles, at the place of its file. Throws Error(bad_input) when there is nothing to sample.
Scene make_mesh_scene(Mesh mesh);

Scene make_courtyard();
Scene make_room();
Scene make_forest();

}  // namespace sfumato::synth
