// Poses of pictures as other programs write them: points stand on the pixels that each format's own
// definition gives, which is written out here and takes nothing from the program's code.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "cli/command.h"

using namespace sfumato;
using namespace sfumato::testing;
using ::testing::HasSubstr;

namespace {

using Vector = std::array<double, 3>;

/// Rows of the rotation from the world to a camera that looks along z with y down.
struct TruePose {
  std::array<Vector, 3> rows;
  Vector place;
};

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vector unit(const Vector& a) {
  const double l = std::sqrt(dot(a, a));
  return {a[0] / l, a[1] / l, a[2] / l};
}

/// w x y z, by the largest of its squares.
std::array<double, 4> quaternion(const std::array<Vector, 3>& m) {
  std::array<double, 4> best{};
  const double squares[4] = {1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2],
                             1 - m[0][0] + m[1][1] - m[2][2], 1 - m[0][0] - m[1][1] + m[2][2]};
  const int k = int(std::max_element(squares, squares + 4) - squares);
  const double s = 2 * std::sqrt(squares[k]);
  const double wx = m[2][1] - m[1][2], wy = m[0][2] - m[2][0], wz = m[1][0] - m[0][1], xy = m[0][1] + m[1][0],
               xz = m[0][2] + m[2][0], yz = m[1][2] + m[2][1];
  const std::array<std::array<double, 4>, 4> all = {
      {{s * s / 4, wx, wy, wz}, {wx, s * s / 4, xy, xz}, {wy, xy, s * s / 4, yz}, {wz, xz, yz, s * s / 4}}};
  for (int i = 0; i < 4; ++i) best[std::size_t(i)] = all[std::size_t(k)][std::size_t(i)] / s;
  return best;
}

class PosesTest : public CommandTest {
 protected:
  static constexpr int dots = 40, width = 400, height = 300;
  static constexpr double fx = 380, fy = 350, cx = 188.5, cy = 161.25;

  void SetUp() override {
    CommandTest::SetUp();
    std::mt19937 random(7);
    const auto real = [&](double a, double b) { return a + (b - a) * double(random()) / 4294967296.0; };
    std::string text = "x y z\n";
    for (int i = 0; i < dots; ++i) {
      points_.push_back({100 + real(-1, 1), 50 + real(-1, 1), real(-0.8, 0.8)});
      text += line(points_.back()) + "\n";
    }
    write("dots.xyz", text);
    for (const Vector& place : {Vector{100, 44, 1}, Vector{105, 52, 2}}) {
      const Vector forward = unit({100 - place[0], 50 - place[1], -place[2]}),
                   right = unit(cross(forward, unit({0.1, 0.05, 1}))), down = cross(forward, right);
      poses_.push_back({{right, down, forward}, place});
    }
  }
  /// Where dots touch, anti-aliasing leaves a dot half red and its corners a tenth.
  static bool is_dot(const Rgba8& c) { return c.g < 192; }
  static std::string real(double v) {
    char text[40];
    std::snprintf(text, sizeof text, "%.12g", v);
    return text;
  }
  static std::string line(const Vector& v) { return real(v[0]) + " " + real(v[1]) + " " + real(v[2]); }
  static Vector column(const TruePose& p, std::size_t k) {
    return {p.rows[0][k], p.rows[1][k], p.rows[2][k]};
  }
  static Vector moved(const TruePose& p) {
    return {-dot(p.rows[0], p.place), -dot(p.rows[1], p.place), -dot(p.rows[2], p.place)};
  }

  /// Of 40 dots, those on whose pixel a dot was drawn. `corner`: where the middle of the first pixel is in
  /// the format's pixels.
  int on_their_pixels(const std::string& picture, const TruePose& pose, double f_x, double f_y, double c_x,
                      double c_y, double corner, int wide = width, int high = height) {
    const Image<Rgba8> image = read_png(picture);
    EXPECT_EQ(image.width(), wide);
    EXPECT_EQ(image.height(), high);
    int right = 0, drawn = 0;
    for (const Rgba8& c : image) drawn += is_dot(c);
    for (const Vector& p : points_) {
      const Vector d{p[0] - pose.place[0], p[1] - pose.place[1], p[2] - pose.place[2]};
      const double z = dot(pose.rows[2], d);
      const double u = f_x * dot(pose.rows[0], d) / z + c_x - corner,
                   v = f_y * dot(pose.rows[1], d) / z + c_y - corner;
      const int x = int(std::lround(u)), y = int(std::lround(v));
      right += x >= 0 && y >= 0 && x < image.width() && y < image.height() && is_dot(image.at(x, y));
    }
    EXPECT_LE(drawn, dots);  // a pixel each
    return right;
  }
  Outcome draw(const std::string& path, std::vector<std::string> more = {}) {
    std::vector<std::string> words{"dots.xyz",     "-t",     "points",  "--size-mode", "pixels",
                                   "--point-size", "1",      "--color", "#ff0000",     "--shading",
                                   "albedo",       "--path", path,      "-o",          "a{n:02}.png",
                                   "--up",         "+Z"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  void expect_dots(const std::string& path, double corner) {
    const Outcome made = draw(path);
    ASSERT_EQ(made.code, 0) << made.err;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      EXPECT_EQ(on_their_pixels("a0" + std::to_string(i) + ".png", poses_[i], fx, fy, cx, cy, corner), dots)
          << path << " " << i;
    EXPECT_FALSE(exists("a02.png"));
  }

  std::vector<Vector> points_;
  std::vector<TruePose> poses_;
};

TEST_F(PosesTest, TransformsOfNerfstudio) {
  std::string frames;
  for (const TruePose& p : poses_) {
    frames += frames.empty() ? "" : ",";
    frames += R"({"file_path": "images/1.png", "transform_matrix": [)";
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector c = column(p, k);
      frames += "[" + real(c[0]) + "," + real(-c[1]) + "," + real(-c[2]) + "," + real(p.place[k]) + "],";
    }
    frames += "[0,0,0,1]]}";
  }
  const std::string head = R"({"camera_model": "OPENCV", "fl_x": 380, "fl_y": 350, "cx": 188.5, "cy": 161.25,
    "w": 400, "h": 300, )";
  write("transforms.json", head + R"("frames": [)" + frames + "]}");
  expect_dots("transforms.json", 0.5);
  write("bent.json", head + R"("k1": 0.1, "frames": [)" + frames + "]}");
  EXPECT_THAT(draw("bent.json").err, HasSubstr("not applied"));
  // Of synthetic data sets: an angle alone, and the size of whoever looks.
  write("angle.json", R"({"camera_angle_x": 0.9, "frames": [)" + frames + "]}");
  const Outcome made = draw("angle.json", {"--resolution", "320x240"});
  ASSERT_EQ(made.code, 0) << made.err;
  const double f = 160 / std::tan(0.45);
  EXPECT_EQ(on_their_pixels("a00.png", poses_[0], f, f, 160, 120, 0.5, 320, 240), dots);
}

TEST_F(PosesTest, ColmapAsTextAndBinary) {
  std::string images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n", images_bin, cameras_bin;
  const auto put = [](std::string& out, auto value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(images_bin, std::uint64_t(2));
  // Registered in another order than that of their names.
  for (std::size_t i : {1u, 0u}) {
    const auto q = quaternion(poses_[i].rows);
    const Vector t = moved(poses_[i]);
    const std::string name = "picture " + std::to_string(i) + ".jpg";
    images += std::to_string(9 - i) + " " + real(q[0]) + " " + real(q[1]) + " " + real(q[2]) + " " +
              real(q[3]) + " " + line(t) + " 4 " + name + "\n" + (i ? "1.5 2.5 -1" : "") + "\n";
    put(images_bin, std::uint32_t(9 - i));
    for (double v : q) put(images_bin, v);
    for (double v : t) put(images_bin, v);
    put(images_bin, std::uint32_t(4));
    images_bin += name + '\0';
    put(images_bin, std::uint64_t(i));
    if (i) put(images_bin, 1.5), put(images_bin, 2.5), put(images_bin, std::int64_t(-1));
  }
  put(cameras_bin, std::uint64_t(1));
  put(cameras_bin, std::uint32_t(4));
  put(cameras_bin, std::int32_t(4));
  put(cameras_bin, std::uint64_t(width));
  put(cameras_bin, std::uint64_t(height));
  for (double v : {fx, fy, cx, cy, 0.0, 0.0, 0.0, 0.0}) put(cameras_bin, v);
  write("images.txt", images);
  write("cameras.txt",
        "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n4 PINHOLE 400 300 380 350 188.5 161.25\n");
  expect_dots("images.txt", 0.5);
  write("images.bin", images_bin);
  write("cameras.bin", cameras_bin);
  expect_dots("images.bin", 0.5);
  write("images.bin", images_bin.substr(0, images_bin.size() - 20));
  const Outcome cut = draw("images.bin");
  EXPECT_EQ(cut.code, 2);
  EXPECT_THAT(cut.err, HasSubstr("cut short"));
}

TEST_F(PosesTest, Open3dCameras) {
  std::string all;
  for (const TruePose& p : poses_) {
    const Vector t = moved(p);
    all += all.empty() ? "" : ",";
    all += R"({"class_name": "PinholeCameraParameters", "extrinsic": [)";
    for (std::size_t k = 0; k < 3; ++k)
      all += real(p.rows[0][k]) + "," + real(p.rows[1][k]) + "," + real(p.rows[2][k]) + ",0,";
    all +=
        real(t[0]) + "," + real(t[1]) + "," + real(t[2]) + R"(,1], "intrinsic": {"width": 400, "height": 300,
      "intrinsic_matrix": [380,0,0,0,350,0,188.5,161.25,1]}})";
  }
  write("o3d.json", R"({"class_name": "PinholeCameraTrajectory", "parameters": [)" + all + "]}");
  expect_dots("o3d.json", 0);
}

TEST_F(PosesTest, TrajectoriesWithoutALens) {
  std::string tum = "# timestamp tx ty tz qx qy qz qw\n", kitti, log;
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    const TruePose& p = poses_[i];
    const auto q = quaternion(p.rows);  // of the world to the camera: its inverse is the pose
    tum += std::to_string(1305031102.0 + double(i)) + " " + line(p.place) + " " + real(-q[1]) + " " +
           real(-q[2]) + " " + real(-q[3]) + " " + real(q[0]) + "\n";
    log += std::to_string(i) + " " + std::to_string(i) + " 2\n";
    for (std::size_t k = 0; k < 3; ++k) {
      kitti += line(column(p, k)) + " " + real(p.place[k]) + (k < 2 ? " " : "\n");
      log += line(column(p, k)) + " " + real(p.place[k]) + "\n";
    }
    log += "0 0 0 1\n";
  }
  write("groundtruth.txt", tum);
  write("00.txt", kitti);
  write("trajectory.log", log);
  const double f = 120 / std::tan(0.5 * 50 * M_PI / 180);
  for (const char* name : {"groundtruth.txt", "00.txt", "trajectory.log"}) {
    const Outcome made = draw(name, {"--resolution", "320x240", "--camera-view-angle", "50"});
    ASSERT_EQ(made.code, 0) << made.err;
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_EQ(on_their_pixels("a0" + std::to_string(i) + ".png", poses_[i], f, f, 160, 120, 0.5, 320, 240),
                dots)
          << name << " " << i;
  }
  write("bad.txt", "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 2\n");
  const Outcome bad = draw("bad.txt");
  EXPECT_EQ(bad.code, 2);
  EXPECT_THAT(bad.err, HasSubstr("line 2"));
}

}  // namespace
