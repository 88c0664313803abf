// Normals and radii of RGB-D views, from their grids: what belongs together there is known without searching.
#pragma once

#include <optional>

#include "core/point_cloud.h"
#include "core/prepared_cloud.h"
#include "core/progress.h"

namespace sfumato::analysis {

/// Completes those of `needs` (normal, radius) that the cloud lacks altogether, for the points of grids that
/// are pictures: with a viewpoint, seen under less than 150 degrees. Other points get 0, i.e. "missing".
///
/// Normals: cross products on a copy of the range image that a bilateral filter has smoothed, towards the
/// viewpoint; positions stay raw. Radius: the pixel's side at that range times sqrt(4/pi), so that the splats
/// of one view cover a surface four times, like those of Eq. 20 (Seemann 2018) do. For a cloud that has its
/// grids still, i.e. is not sorted.
void complete_from_grids(PointCloud& cloud, Attributes needs, Progress& progress = no_progress());

/// The grid of one depth picture that a file without grids holds (PLY, text): seen from the origin along z,
/// all points lie in the columns and rows of a camera's pixels, in any order, but for a few outliers, and a
/// quarter or more of those have one, nearly all side by side. Sets `grids`, with the origin as viewpoint,
/// and `grid_index`; false, and nothing changed, where there are no such columns and rows.
bool recover_grid(PointCloud& cloud);

/// Of a cloud that has its grids still: nothing where fewer than 95 % of its points are pixels of pictures.
std::optional<DepthPictures> depth_pictures(const PointCloud& cloud);

/// The places of all points of `cloud`, which is to be sorted into `order`: what sorting would lose. Empty
/// when there are no views or the cloud has normals and radii.
ViewPlaces view_places(const PointCloud& cloud, const std::vector<std::uint32_t>& order);
/// As `complete_from_grids`, for a sorted cloud: puts the views side by side again.
void complete_from_views(PointCloud& cloud, const ViewPlaces& views, Attributes needs,
                         Progress& progress = no_progress());

}  // namespace sfumato::analysis
