// Pictures on faces: materials of OBJ files and the PNG and JPEG that they name.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"
#include "core/vec.h"

namespace sfumato::io {

/// A picture that repeats beyond its borders.
struct Texture {
  std::uint32_t width = 0, height = 0;
  std::vector<Rgba8> pixels;  ///< row 0 on top

  /// Half as large, each pixel the mean of four.
  void halve();
  /// Between the four nearest pixels; (0, 0) is the lower left corner.
  Rgba8 at(const vec2& place) const;
};

/// A file that another one names, when it lies beside that or in a folder there.
std::optional<std::filesystem::path> file_beside(const std::filesystem::path& file, std::string_view name);

/// Throws Error(bad_input) for what is neither PNG nor JPEG, is damaged or too large.
Texture read_texture(const std::filesystem::path& file);

struct Material {
  std::optional<Rgba8> color;  ///< Kd
  std::string picture;         ///< map_Kd
};
/// Of a .mtl file, by name; what cannot be understood is passed over.
std::map<std::string, Material, std::less<>> read_materials(const std::filesystem::path& file);

}  // namespace sfumato::io
