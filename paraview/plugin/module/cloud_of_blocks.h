// Points of ParaView's data as a cloud of ours, and back.
#pragma once

#include <sfumato/cloud.h>
#include <sfumato/io.h>

class vtkPolyData;
class vtkUnsignedCharArray;

/// Field data of what the reader read: floats relative to this origin are those of the file.
inline constexpr const char* origin_name = "sfumato_origin";

/// The points with all that they have, each a vertex of its own, so that it can be selected.
void Fill(const sfumato::io::ReadResult& read, vtkPolyData& out);

class CloudOfBlocks {
 public:
  /// `placement`: from the data to the world. `solid`: of points without colours.
  CloudOfBlocks(const sfumato::dmat4& placement, const sfumato::Rgba8& solid)
      : placement_(placement), solid_(solid) {}
  /// `colors`: three or four bytes a point, or null.
  void Add(vtkPolyData* block, vtkUnsignedCharArray* colors);
  /// The points, numbered as TakeOfOwnRank does.
  sfumato::PointCloud Take();
  /// On rank 0 the points of all ranks, in an order that does not depend on who had them; on the others none.
  /// Every rank has to call it.
  sfumato::PointCloud TakeOfAllRanks();

  /// The points of this rank, with numbers that they have whichever rank they are on, ascending. Every rank has to call
  /// it.
  sfumato::PointCloud TakeOfOwnRank();

 private:
  struct Point {
    double place[3];
    float normal[3];
    sfumato::Rgba8 color;
  };
  sfumato::dmat4 placement_;
  sfumato::Rgba8 solid_;
  std::vector<Point> points_;
  sfumato::dvec3 origin_{-std::numeric_limits<double>::infinity()};  ///< of files; -inf: none is known
  int has_normals_ = 0;
  bool has_doubles_ = false;  ///< places that float may not hold

  /// What holds for one rank holds for all, whoever has the points of which it does.
  void AgreeOnKind();
  static sfumato::dvec3 LeastOf(const std::vector<Point>& points);
  sfumato::PointCloud TakeNumbered(const sfumato::dvec3& least);
  sfumato::PointCloud Take(const std::vector<Point>& points, const sfumato::dvec3& least) const;
};
