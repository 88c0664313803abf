// Virtual point clouds: lists of files as a STAC FeatureCollection (QGIS, PDAL wrench).
#pragma once

#include <filesystem>
#include <vector>

namespace sfumato::io {

/// Whether the name, without what follows `?`, ends in .vpc.
bool is_vpc_name(const std::filesystem::path& file);
/// The files it lists, those with relative names beside it. Throws Error(bad_input).
std::vector<std::filesystem::path> vpc_files(const std::filesystem::path& file);

}  // namespace sfumato::io
