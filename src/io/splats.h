// 3D Gaussian splats as coloured points: those of PLY files, of SuperSplat's packed PLY files, and of .splat
// files.
#pragma once

#include "io/ply_header.h"

namespace sfumato::io {

/// Colours the points of a PLY by the constant term of their harmonics, where they have such, and leaves out
/// faint ones.
void color_by_harmonics(ReadResult& result);

/// Positions of 11, 10 and 11 bits within the box of each 256 splats (SuperSplat's "compressed PLY").
bool are_packed_splats(const PlyHeader& header);
ReadResult read_packed_splats(const File& file, const PlyHeader& header, Progress& progress);

/// 32 bytes a splat: place and scale as floats, colour and opacity as bytes, rotation as bytes.
ReadResult read_splat(const std::filesystem::path& path, const ReadOptions& options, Progress& progress);

/// GaussianSplats3D's .ksplat: sections of splats, whose places are floats (level 0) or steps of 16 bits
/// around the centres of buckets (levels 1 and 2).
ReadResult read_ksplat(const std::filesystem::path& path, const ReadOptions& options, Progress& progress);

/// Niantic's SPZ, versions 1 to 3, out of its gzip: places in steps of 24 bits (16-bit floats in version 1),
/// opacities and colours as bytes.
bool is_spz(std::string_view head);
ReadResult read_spz(const std::filesystem::path& path, const ReadOptions& options, Progress& progress);

}  // namespace sfumato::io
