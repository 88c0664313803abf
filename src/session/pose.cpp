#include "session/pose.h"

#include "analysis/find_room.h"
#include "session/standpoint.h"
#include "session/sweep.h"

namespace sfumato {

void exaggerate(PointCloud& cloud, double factor) {
  const dvec3 up = up_vector(cloud.up);
  if (!cloud.scalar("elevation")) {
    ScalarField heights{"elevation", glm::dot(up, cloud.origin), {}, StoredType::float32};
    heights.values.reserve(cloud.size());
    for (const vec3& p : cloud.positions) heights.values.push_back(glm::dot(vec3(up), p));
    cloud.set_scalar(std::move(heights));
  }
  const UpAxis axis = cloud.up;
  transform(cloud, glm::scale(dmat4(1), dvec3(1) + (factor - 1) * glm::abs(up)));
  cloud.up = axis;
}

namespace {

/// Azimuth and elevation about its vertical: the axis of a scan that is turned as its camera will be.
Standpoint standpoint_on_ground(const Pose& pose) {
  Subject turned = pose.subject;
  const glm::dmat3 turn = turn_between(pose.vertical(), up_vector(pose.upright.up));
  turned.box = {dvec3(1e300), dvec3(-1e300)};
  for (dvec3& p : turned.points) {
    p = turn * p;
    turned.box = {glm::min(turned.box.min, p), glm::max(turned.box.max, p)};
  }
  for (vec3& facing : turned.facing) facing = vec3(turn * dvec3(facing));
  return standpoint_for(turned, pose.upright.up);
}

}  // namespace

Pose stand_upright(scene::Scene& scene, const std::optional<UpAxis>& asked, bool cutaway,
                   double vertical_exaggeration, Progress& progress) {
  analysis::Upright upright;
  const PointCloud& all = scene.before_selection ? *scene.before_selection : scene.cloud;
  if (asked) {
    upright = {*asked, "--up"};
  } else if (!scene.cloud.up_is_known) {
    upright = analysis::guess_upright(all, progress);
  } else {
    upright = {scene.cloud.up, "the file says so"};
    // The pictures say which axis is nearest.
    if (all.provenance == Provenance::photographs)
      upright.vertical = analysis::up_from_ground(all, upright.up);
  }
  scene.cloud.up = upright.up;
  if (vertical_exaggeration != 1) exaggerate(scene.cloud, vertical_exaggeration);
  // Whoever cuts out a box has chosen what is shown.
  const bool whole = !cutaway || scene.selected.cropped > 0;
  Pose pose{upright, subject_of(scene.cloud, whole, progress), horizontal_unit(scene.cloud.crs)};
  pose.vertical_exaggeration = vertical_exaggeration;
  const auto look_from = [&](double azimuth_deg, double elevation_deg) {
    pose.upright.azimuth_deg = azimuth_deg, pose.upright.elevation_deg = elevation_deg;
  };
  if (const auto sensor = sensor_of(scene.cloud, pose.subject)) {
    const Compass compass(upright.up);
    pose.sensor = sensor->place;
    pose.upright.vertical = dvec3(0);  // its picture is as it took it
    look_from(glm::degrees(compass.azimuth(-sensor->along)), glm::degrees(compass.elevation(-sensor->along)));
  } else {
    progress.check();
    if (cutaway) pose.subject.room = analysis::find_room(scene.cloud);
    progress.check();
    Standpoint from = standpoint_for(pose.subject, upright.up);
    if (pose.subject.room || vertical_exaggeration != 1 || pose.subject.points.empty())
      pose.upright.vertical = dvec3(0);
    if (pose.upright.vertical != dvec3(0)) from = standpoint_on_ground(pose);
    look_from(from.azimuth_deg, from.elevation_deg);
  }
  if (whole || pose.subject.room) return pose;
  progress.check();
  const auto usual = [&] { return first_view(pose, 1280, 720); };
  if (const auto view = view_of_sweep(scene.cloud, pose.subject, usual, bool(pose.sensor))) {
    pose.sensor.reset(), pose.around = view->around;
    pose.upright.vertical = dvec3(0);
    look_from(view->from.azimuth_deg, view->from.elevation_deg);
  }
  return pose;
}

namespace {

/// What the first view is fitted to.
Subject fitted_subject(const Pose& pose) {
  return pose.around ? within(pose.subject, pose.around->reach) : pose.subject;
}

}  // namespace

std::vector<double> shown_heights(const Pose& pose) {
  constexpr double nearly_all = 0.99;
  std::vector<double> heights;
  // Exaggerated ones are not those that colours stand for.
  if ((!pose.around && pose.subject.share > nearly_all) || pose.vertical_exaggeration != 1) return heights;
  const Subject subject = fitted_subject(pose);
  const dvec3 up = up_vector(pose.upright.up);
  for (std::size_t i = 0; i < subject.points.size(); ++i)
    if (subject.is_framed(i)) heights.push_back(glm::dot(up, subject.points[i]));
  return heights;
}

Camera first_view(const Pose& pose, int width, int height) {
  const Subject subject = fitted_subject(pose);
  Camera camera = frame(subject.box, pose.upright.up, width, height, glm::radians(pose.upright.azimuth_deg),
                        glm::radians(pose.upright.elevation_deg));
  stand_on(camera, pose.upright.up, pose.vertical());
  if (pose.sensor)
    see_from(camera, *pose.sensor, subject);
  else
    fit(camera, subject);
  if (pose.around) {
    // Where the page is narrower than the one that the move was found for, less of it lies aside.
    dvec3 move = pose.around->move;
    move.x *= std::min(1.0, double(width) / height / FittedTo::width_over_height);
    move_along_axes(camera, move);
  }
  return camera;
}

}  // namespace sfumato
