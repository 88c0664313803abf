// Draws in slices of bounded work, between which a frame can be cancelled (gl/pace.h).
#pragma once

#include <epoxy/gl.h>

#include <cstdint>
#include <functional>

#include "gl/program.h"

namespace sfumato::gl {

/// What a splat of a few pixels costs, in pixels of a screen pass: where nothing better is known.
constexpr double splat_units = 8;

/// Items [first, first + count) of `vertices` vertices each, in their order, with a program that is in use.
void draw_items(const Program& program, GLenum mode, std::uint64_t first, std::uint64_t count, int vertices,
                double units = splat_units);
/// The same, indexed by the bound element array of 32-bit words.
void draw_indexed_items(const Program& program, GLenum mode, std::uint64_t count, int indices,
                        double units = splat_units);
/// Rows of as many points, each of `units`, in any order of the rows.
void draw_rows(const Program& program, int rows, int columns, double units);
/// `draw()` for one rectangle of a framebuffer of that size after another, by the scissor, which is off
/// afterwards.
void draw_rectangles(const Program& program, int width, int height, const std::function<void()>& draw);

}  // namespace sfumato::gl
