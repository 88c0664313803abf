// Choices between ways to the same picture, and what helps development: one set a context, read in one place.
#pragma once

#include <string>

namespace sfumato::gl {

/// Where work is done that the processor does faster itself than through software GL.
enum class Place { automatic, gpu, cpu };
/// What a screen filter becomes (passes/screen_pass.h).
enum class ScreenPassKind { automatic, fragment, compute };
/// How splats become pixels (passes/splat_raster.h).
enum class SplatPath { automatic, points, quads, compute };

struct Preferences {
  std::string shader_folder;  ///< a source checkout, whose shaders win over those built in; empty: none
  std::string
      kept_shaders;  ///< a folder for every variant that is compiled, for other compilers; empty: none
  ScreenPassKind screen_passes = ScreenPassKind::automatic;
  SplatPath splat_path = SplatPath::automatic;
  /// Pictures larger than this many px are drawn in tiles of at most that (techniques/renderer.h); a multiple
  /// of 64, 0: what suits the driver.
  int tile_side = 0;
  /// No more invocations and pixels than that between two places where a frame can be cancelled (gl/pace.h),
  /// for tests; 0: as many as take a few milliseconds.
  int slice_units = 0;
  Place depth_sort = Place::automatic, soft_blend = Place::automatic, stroke_lists = Place::automatic,
        splats = Place::automatic, points = Place::automatic, evidence = Place::automatic,
        finish = Place::automatic;

  /// SFUMATO_SHADER_DIR, SFUMATO_KEEP_SHADERS, SFUMATO_SCREEN_PASS, SFUMATO_SPLAT_PATH, SFUMATO_DEPTH_SORT,
  /// SFUMATO_SOFT_BLEND, SFUMATO_STROKE_LISTS, SFUMATO_SPLATS, SFUMATO_POINTS,
  /// SFUMATO_EVIDENCE, SFUMATO_FINISH, SFUMATO_TILE. Throws Error(usage) for a word that is none of a
  /// variable's.
  static Preferences from_environment();
  /// Those of the contexts that are made from now on have this `shader_folder` instead of the environment's.
  static void take_shaders_from(const std::string& folder);
};

/// Those of the context that is current on this thread (without one, the environment's). Passes read them
/// when they are made or run, so that a change holds for what comes after it.
Preferences& preferences();
/// `preferred`, or where it leaves the choice open, the CPU on software GL unless there is a `shader_folder`.
Place place_of_work(Place preferred);

}  // namespace sfumato::gl
