// Lines of numbers: XYZ, TXT and ASC with blanks and a header behind #, CSV with commas and a plain header.
#include <algorithm>

#include "core/lower_case.h"
#include "io/atomic_writer.h"
#include "io/format.h"
#include "io/record.h"

namespace sfumato::io {

WriteReport write_text(const std::filesystem::path& file, const PointCloud& cloud, Progress& progress) {
  const bool commas = lower_case(file.extension().string()) == ".csv";
  const std::vector<OutColumn> columns = columns_to_write(cloud);
  AtomicWriter out(file);
  std::string line = commas ? "" : "#";
  for (const OutColumn& column : columns) {
    std::string name = column.name;
    for (char& c : name)
      if (std::string_view(" \t\r\n,;\"#").find(c) != std::string_view::npos) c = '_';
    line += (commas ? (line.empty() ? "" : ",") : " ") + name;
  }
  out.write(line + "\n");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (i % 65536 == 0) {
      progress.check();
      progress.update(double(i) / double(cloud.size()), "writing");
    }
    line.clear();
    for (const OutColumn& column : columns) {
      if (!line.empty()) line += commas ? ',' : ' ';
      column.print(cloud, i, line);
    }
    line += '\n';
    out.write(line);
  }
  out.commit();
  return {};
}

}  // namespace sfumato::io
