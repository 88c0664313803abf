// A decoder that dies of what tests want it to die of: the intensity of a chunk's first point says so.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

void die_as_told(const std::uint8_t* input, std::size_t size);

void die_as_told(const std::uint8_t* input, std::size_t size) {
  std::uint32_t head = 0;
  std::uint16_t intensity = 0;
  if (size < 375) return;
  std::memcpy(&head, input + 96,
              sizeof head);  // a LAS file of one chunk: header, records, address of a chunk table
  std::memcpy(&intensity, input + head + 8 + 12, sizeof intensity);
  switch (intensity) {
    case 666: std::abort();
    case 667: std::raise(SIGSEGV); break;
    case 668:
      for (volatile std::uint64_t forever = 0; true;) forever = forever + 1;
    case 669:
      for (std::vector<std::vector<char>> hoard; true;) hoard.emplace_back(64 << 20, 'x');
    case 670: (void)!::open("/etc/passwd", O_RDONLY); break;
    case 671: _exit(0);
    default: break;
  }
}
