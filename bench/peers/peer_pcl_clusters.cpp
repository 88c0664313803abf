// PCL peer: colour-based region growing (RegionGrowingRGB), one thread as PCL has it.
// usage: peer_pcl_clusters FILE.ply DISTANCE POINT_COLOR REGION_COLOR MIN_SIZE NEIGHBORS [LABELS]
// Prints one JSON line; writes the cluster of every point (uint32, file order) to LABELS.
#include <pcl/io/ply_io.h>
#include <pcl/pcl_config.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing_rgb.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

double now_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 7) return 1;
  auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZRGB>>();
  if (pcl::io::loadPLYFile(argv[1], *cloud) < 0) return 2;
  const double start = now_ms();
  auto tree = std::make_shared<pcl::search::KdTree<pcl::PointXYZRGB>>();
  pcl::RegionGrowingRGB<pcl::PointXYZRGB> growing;
  growing.setInputCloud(cloud);
  growing.setSearchMethod(tree);
  growing.setDistanceThreshold(float(std::atof(argv[2])));
  growing.setPointColorThreshold(float(std::atof(argv[3])));
  growing.setRegionColorThreshold(float(std::atof(argv[4])));
  growing.setMinClusterSize(std::atoi(argv[5]));
  growing.setNumberOfNeighbours(unsigned(std::atoi(argv[6])) + 1);  // the point itself is one of PCL's
  growing.setNumberOfRegionNeighbours(unsigned(std::atoi(argv[6])) + 1);
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  const double clusters_ms = now_ms() - start;
  // PCL leaves clusters below the least size without a label: each such point gets one of its own.
  std::vector<unsigned> labels(cloud->size());
  for (unsigned i = 0; i < labels.size(); ++i) labels[i] = unsigned(clusters.size()) + i;
  for (unsigned c = 0; c < clusters.size(); ++c)
    for (int i : clusters[c].indices) labels[unsigned(i)] = c;
  if (argc > 7)
    if (std::FILE* file = std::fopen(argv[7], "wb")) {
      std::fwrite(labels.data(), 4, labels.size(), file);
      std::fclose(file);
    }
  std::printf("{\"peer\": \"pcl %s\", \"n\": %zu, \"clusters\": %zu, \"clusters_ms\": %.1f}\n",
              PCL_VERSION_PRETTY, cloud->size(), clusters.size(), clusters_ms);
  std::fflush(stdout);
  _exit(0);
}
