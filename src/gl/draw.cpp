#include "gl/draw.h"

#include <algorithm>

#include "gl/pace.h"

namespace sfumato::gl {
namespace {

struct Scissor {
  Scissor() = default;
  ~Scissor() { glDisable(GL_SCISSOR_TEST); }
  Scissor(const Scissor&) = delete;
  Scissor& operator=(const Scissor&) = delete;
};

}  // namespace

void draw_items(const Program& program, GLenum mode, std::uint64_t first, std::uint64_t count, int vertices,
                double units) {
  in_slices(program.id(), count, units, [&](std::uint64_t from, std::uint64_t n) {
    glDrawArrays(mode, GLint((first + from) * std::uint64_t(vertices)), GLsizei(n * std::uint64_t(vertices)));
  });
}

void draw_indexed_items(const Program& program, GLenum mode, std::uint64_t count, int indices, double units) {
  in_slices(program.id(), count, units, [&](std::uint64_t from, std::uint64_t n) {
    const void* offset = reinterpret_cast<const void*>(from * std::uint64_t(indices) * 4);
    glDrawElements(mode, GLsizei(n * std::uint64_t(indices)), GL_UNSIGNED_INT, offset);
  });
}

void draw_rows(const Program& program, int rows, int columns, double units) {
  const auto count = std::uint64_t(rows), step = spread_step(count);
  in_slices(program.id(), count, units * columns, [&](std::uint64_t first, std::uint64_t n) {
    if (n == count) return glDrawArrays(GL_POINTS, 0, rows * columns);
    for (std::uint64_t k = first; k < first + n; ++k)
      glDrawArrays(GL_POINTS, GLint(k * step % count) * columns, columns);
  });
}

void draw_rectangles(const Program& program, int width, int height, const std::function<void()>& draw) {
  constexpr int side = 64;         // px: what llvmpipe's threads take at a time
  constexpr int most_width = 512;  // of a piece
  const int columns = (width + most_width - 1) / most_width, rows = (height + side - 1) / side;
  const std::uint64_t pieces = std::uint64_t(columns) * std::uint64_t(rows), step = spread_step(pieces);
  const Scissor scissor;
  in_slices(program.id(), pieces, double(std::min(width, most_width)) * side,
            [&](std::uint64_t first, std::uint64_t count) {
              if (count == pieces) return draw();
              glEnable(GL_SCISSOR_TEST);
              for (std::uint64_t k = first; k < first + count; ++k) {
                const int piece = int(k * step % pieces);
                const int x = piece % columns * most_width;
                glScissor(x, piece / columns * side, std::min(most_width, width - x), side);
                draw();
              }
            });
}

}  // namespace sfumato::gl
