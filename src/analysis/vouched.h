// How large a disc the neighbours of a point vouch for, in both directions of its tangent plane.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "analysis/normals.h"

namespace sfumato::analysis {

/// A point's cell among its neighbours, in its tangent plane: what lies nearer to it than to any of them.
/// Where the cell is bounded, measured points surround every place of it, and a disc that reaches its corners
/// closes the surface there; where it is open, nothing was measured.
///
/// The cell is that of T. K. Dey, J. Giesen, "Detecting undersampling in surface reconstruction", SoCG 2001,
/// in the tangent plane; the open angle is the angle criterion of G. Bendels, R. Schnabel, R. Klein,
/// "Detecting holes in point set surfaces", WSCG 2006. It is open beyond 1.7 spacings, where a random sample
/// of a surface is empty once in 10,000 times (exp(-pi 1.7^2)): there lies a hole, or the next line of a
/// scanner whose lines make no surface.
struct VoronoiCell {
  /// To the farthest corner that is bounded, 0 where there is none, no less than that where the cell is
  /// closed; infinite: nobody measured it.
  float radius = std::numeric_limits<float>::infinity();
  /// Share of the directions in which it is bounded: 1 inside a surface, 1/2 at its border.
  float closed = 1;
  /// The widest angle between neighbours that follow each other around the point, radians; 0 where the cell
  /// is closed. A half circle at a straight border, where the cell is a strip that leaves few directions
  /// open.
  float widest_angle = 0;
  /// The neighbourhood's deviation across over that along its longest axis: 1 in a disc, 0 on a line.
  float aspect = 1;
  /// The nearest eight's share of the area of all, over eight's share of the count: about 1 in a plane, 1/3
  /// on a line of 24, less where those beyond the eight are of the next line.
  float evenness = 1;
  /// How far the middle of all neighbours lies aside, over the distance of the farthest: 0 inside a surface,
  /// 0.42 at its straight border; 1: not measured.
  float aside = 1;
  bool is_measured() const { return radius < std::numeric_limits<float>::infinity(); }
};

/// `frame`: of the neighbourhood; `normal`: of the plane, which at an edge is another. Neighbours of another
/// layer, as the other side of a sheet, do not count. Neighbours in any order.
VoronoiCell cell_of(std::span<const vec3> positions, std::uint32_t point,
                    std::span<const std::uint32_t> neighbors, const LocalFrame& frame, const vec3& normal);

/// How far points surround a cell, so that a disc of the usual size covers no more than they do: 1 inside a
/// surface, 0 at its straight border.
float surrounded(const VoronoiCell& cell);

/// The same by the neighbours' directions, from a quarter of a circle without any of them (1) to a half (0):
/// a disc at the border of a surface.
float enclosed(const VoronoiCell& cell);

/// How far the neighbours are spread in both directions, and not along a line.
float two_sided(const VoronoiCell& cell);

/// The radius of a disc that a cell vouches for, from 0. A disc needs no less of a surface around its point
/// than the corner of a rectangle has, a quarter; of less, as on a line, it is so much smaller.
float vouched_radius(const VoronoiCell& cell);

}  // namespace sfumato::analysis
