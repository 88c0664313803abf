// Folders of pictures: their depth as text, from where they are taken, and what is on the disk at each
// moment.
#include "apps/publish/publication.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/publish/depth_text.h"
#include "core/error.h"
#include "session/first_view.h"

namespace sfumato::publish {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr float nothing = std::numeric_limits<float>::infinity();

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The values of the pixels, as the page takes them out.
std::vector<unsigned> unpacked(const PackedDepth& depth, std::size_t pixels) {
  std::vector<unsigned char> planes(2 * pixels);
  uLongf size = uLong(planes.size());
  EXPECT_EQ(uncompress(planes.data(), &size, reinterpret_cast<const Bytef*>(depth.bytes.data()),
                       uLong(depth.bytes.size())),
            Z_OK);
  EXPECT_EQ(size, planes.size());
  std::vector<unsigned> values;
  for (std::size_t i = 0, value = 0; i < pixels; ++i)
    values.push_back(unsigned(value = (value + planes[i] + 256u * planes[pixels + i]) % 65536));
  return values;
}

TEST(Base64, IsThatOfRfc4648) {
  for (const auto& [bytes, text] : {std::pair("", ""),
                                    {"f", "Zg=="},
                                    {"fo", "Zm8="},
                                    {"foo", "Zm9v"},
                                    {"foob", "Zm9vYg=="},
                                    {"fooba", "Zm9vYmE="},
                                    {"foobar", "Zm9vYmFy"}})
    EXPECT_EQ(base64(bytes), text);
  EXPECT_EQ(base64(std::string("\xff\xfe\xfb\0", 4)), "//77AA==");
}

TEST(PackedDepth, KeepsEveryPixelWithinHalfAStep) {
  Image<float> depth(37, 23);
  for (std::size_t i = 0; i < depth.size(); ++i)
    depth.data()[i] = i % 5 == 0 ? nothing : 2.5f + 40 * float((i * 7919) % 851) / 850;
  const PackedDepth all = packed(depth);
  const std::vector<unsigned> values = unpacked(all, depth.size());
  const double step = (double(all.far) - all.near) / 65534;
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (i % 5 == 0)
      EXPECT_EQ(values[i], 0u) << i;
    else
      EXPECT_NEAR(all.near + (values[i] - 1.0) * step, depth.data()[i], 0.5 * step * (1 + 1e-9)) << i;
}

TEST(PackedDepth, HoldsOnePlaneAndNothingAtAll) {
  Image<float> plane(4, 2, 3.f);
  const PackedDepth flat = packed(plane);
  EXPECT_EQ(flat.near, 3);
  EXPECT_EQ(flat.far, 3);
  EXPECT_THAT(unpacked(flat, 8), ::testing::Each(1u));
  const PackedDepth none = packed(Image<float>(4, 2, nothing));
  EXPECT_EQ(none.near, 0);
  EXPECT_EQ(none.far, 0);
  EXPECT_THAT(unpacked(none, 8), ::testing::Each(0u));
}

TEST(PackedDepth, IsACallWithWhatIsNeededToUnpackIt) {
  Image<float> depth(2, 1, 1.5f);
  depth.at(1, 0) = 2.25f;
  const std::string text = depth_text(7, depth);
  ASSERT_THAT(text, ::testing::StartsWith("takeDepth(7,{"));
  const auto json = nlohmann::json::parse(text.substr(12, text.rfind(')') - 12));
  EXPECT_EQ(json["width"], 2);
  EXPECT_EQ(json["height"], 1);
  EXPECT_EQ(json["near"], 1.5);
  EXPECT_EQ(json["far"], 2.25);
  EXPECT_EQ(json["data"], base64(packed(depth).bytes));
}

class PublicationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    room_ = fs::path(::testing::TempDir()) / ("sfumato_publication_" + std::to_string(getpid()));
    fs::create_directories(room_);
    subject_.box = {{-3, -1, 0}, {3, 1, 2}};
    for (const dvec3& corner : subject_.box.corners()) subject_.points.push_back(corner);
  }
  void TearDown() override { fs::remove_all(room_); }

  Camera first(double elevation_deg, Projection projection = Projection::perspective) const {
    Camera camera = frame(subject_.box, UpAxis::pos_z, 64, 48, 0, glm::radians(elevation_deg),
                          glm::radians(45.0), projection);
    fit(camera, subject_);
    return camera;
  }
  static double elevation_deg(const Camera& camera) { return glm::degrees(std::asin(-camera.direction().z)); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& each : fs::directory_iterator(room_)) all.push_back(each.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }
  /// Of two views, whose pictures show something in so many of the middle columns.
  void publish(const Facts& facts, int columns = 64) {
    Publication publication(web_(), 2, {20});
    for (const Camera& camera : publication.cameras(first(20), UpAxis::pos_z, subject_, true)) {
      Image<float> depth(64, 48, nothing);
      for (int y = 0; y < 48; ++y)
        for (int x = 32 - columns / 2; x < 32 + columns / 2; ++x) depth.at(x, y) = 5;
      publication.add(Image<Rgba8>(64, 48, {200, 100, 50, 255}), depth, camera);
    }
    publication.finish(facts);
    summary_ = publication.summary();
  }
  nlohmann::json data() const {
    const std::string text = text_of(web_() / "data.js"), begin = "const published = ";
    const std::size_t at = text.find(begin) + begin.size();
    return nlohmann::json::parse(text.substr(at, text.rfind(';') - at));
  }
  fs::path web_() const { return room_ / "web"; }

  fs::path room_;
  Subject subject_;
  std::string summary_;
};

TEST_F(PublicationTest, GoesRoundAtTwoHeightsFromTheFirstView) {
  Publication publication(web_(), 12, {});
  const std::vector<Camera> all = publication.cameras(first(15), UpAxis::pos_z, subject_, false);
  ASSERT_EQ(all.size(), 24u);
  EXPECT_EQ(all[0].view(), first(15).view());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(elevation_deg(all[i]), i < 12 ? 15 : 45, 1e-9) << i;
    const dvec3 from = all[i].position - all[i].target;
    EXPECT_NEAR(glm::length(from), glm::length(all[0].position - all[0].target), 1e-9) << i;
    const double turn = glm::degrees(std::atan2(from.x, -from.y));
    EXPECT_NEAR(std::remainder(turn - 30.0 * double(i % 12), 360), 0, 1e-9) << i;
  }
}

TEST_F(PublicationTest, TakesTheSecondHeightBelowASteepView) {
  Publication publication(web_(), 4, {});
  const std::vector<Camera> all = publication.cameras(first(70), UpAxis::pos_z, subject_, false);
  EXPECT_NEAR(elevation_deg(all[4]), 40, 1e-9);
}

TEST_F(PublicationTest, NeverLooksStraightDown) {
  Publication publication(web_(), 4, {90, -90});
  const std::vector<Camera> all = publication.cameras(first(10), UpAxis::pos_z, subject_, false);
  EXPECT_NEAR(elevation_deg(all[0]), 89, 1e-6);
  EXPECT_NEAR(elevation_deg(all[4]), -89, 1e-6);
}

TEST_F(PublicationTest, StepsBackSoThatEveryPictureHoldsTheScan) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Publication publication(web_(), 10, {0, 30, 80});
    const std::vector<Camera> all = publication.cameras(first(5, projection), UpAxis::pos_z, subject_, true);
    ASSERT_EQ(all.size(), 30u);
    for (const Camera& camera : all) {
      EXPECT_NEAR(glm::length(camera.position - camera.target), glm::length(all[0].position - all[0].target),
                  1e-9);
      EXPECT_EQ(camera.height_world, all[0].height_world);
      const Intrinsics k = camera.intrinsics();
      for (const dvec3& point : subject_.points) {
        const dvec3 eye(camera.view() * glm::dvec4(point, 1));
        const double w = camera.orthographic() ? 1 : -eye.z;
        ASSERT_GT(w, 0);
        EXPECT_LE(std::abs(k.fx * eye.x / w), 32);
        EXPECT_LE(std::abs(k.fy * eye.y / w), 24);
      }
    }
  }
}

TEST_F(PublicationTest, WritesWhatItListsAndNothingElse) {
  publish({.title = "a scan", .command = "sfumato publish a.ply"});
  EXPECT_THAT(names(), ElementsAre("web"));
  std::vector<std::string> there, listed{"published.txt"};
  for (const auto& each : fs::recursive_directory_iterator(web_()))
    if (each.is_regular_file()) there.push_back(each.path().lexically_relative(web_()).generic_string());
  std::istringstream list(text_of(web_() / "published.txt"));
  std::string line;
  for (std::getline(list, line); std::getline(list, line);) listed.push_back(line);
  EXPECT_THAT(there, ::testing::UnorderedElementsAreArray(listed));
  EXPECT_THAT(summary_, HasSubstr("web (2 views, "));
  const auto json = data();
  ASSERT_EQ(json["views"].size(), 2u);
  EXPECT_EQ(json["width"], 64);
  EXPECT_EQ(json["views"][0]["turn"], 0);
  EXPECT_EQ(json["views"][1]["turn"], 180);
  EXPECT_EQ(json["views"][1]["elevation"], 20);
  for (const auto& view : json["views"])
    for (const char* kind : {"picture", "depth"})
      EXPECT_TRUE(fs::exists(web_() / view[kind].get<std::string>())) << view[kind];
}

TEST_F(PublicationTest, SaysHowFarFromTheMiddleThereIsAnything) {
  publish({}, 16);  // of 64 columns, all rows
  EXPECT_NEAR(data()["reach"][0].get<double>(), 1.04 * 15 / 64, 1e-12);
  EXPECT_EQ(data()["reach"][1], 1);
  publish({.has_furniture = true}, 16);
  EXPECT_EQ(data()["reach"][0], 1) << "a legend stands at the border";
}

TEST_F(PublicationTest, ShowsWhatIsWrittenAsText) {
  publish({.title = "</title><script>alert(1)</script>",
           .command = "sfumato publish \"a & <b>.ply\"",
           .rows = {{"points", "<img src=x>"}}});
  for (const char* page : {"index.html", "details.html"}) {
    EXPECT_THAT(text_of(web_() / page), Not(HasSubstr("<script>alert"))) << page;
    EXPECT_THAT(text_of(web_() / page), HasSubstr("&lt;script&gt;alert(1)")) << page;
    EXPECT_THAT(text_of(web_() / page), Not(HasSubstr("{{"))) << page;
  }
  const std::string details = text_of(web_() / "details.html");
  EXPECT_THAT(details, HasSubstr("&quot;a &amp; &lt;b&gt;.ply&quot;"));
  EXPECT_THAT(details, Not(HasSubstr("<img src=x>")));
  EXPECT_EQ(data()["title"], "</title><script>alert(1)</script>");
}

TEST_F(PublicationTest, LeavesNothingOfWhatIsNotFinished) {
  publish({.title = "before"});
  const std::string before = text_of(web_() / "data.js");
  {
    Publication publication(web_(), 2, {20});
    publication.cameras(first(20), UpAxis::pos_z, subject_, true);
    EXPECT_EQ(names().size(), 2u);
  }
  EXPECT_THAT(names(), ElementsAre("web"));
  EXPECT_EQ(text_of(web_() / "data.js"), before);
  publish({.title = "after"});
  EXPECT_THAT(names(), ElementsAre("web"));
  EXPECT_EQ(data()["title"], "after");
}

TEST_F(PublicationTest, NeverReplacesFilesOfOthers) {
  publish({});
  std::ofstream(web_() / "views" / "notes.txt") << "mine";
  EXPECT_THROW(Publication(web_(), 2, {}), Error);
  fs::remove(web_() / "views" / "notes.txt");
  {
    Publication publication(web_(), 1, {20});
    const Camera camera = publication.cameras(first(20), UpAxis::pos_z, subject_, true).front();
    publication.add(Image<Rgba8>(64, 48), Image<float>(64, 48, 5.f), camera);
    std::ofstream(web_() / "notes.txt") << "mine";  // while it draws
    EXPECT_THROW(publication.finish({}), Error);
  }
  EXPECT_EQ(text_of(web_() / "notes.txt"), "mine");
  EXPECT_THAT(names(), ElementsAre("web"));
  EXPECT_THROW(Publication(web_() / "data.js", 2, {}), Error) << "a file is no folder";
  EXPECT_THROW(Publication(room_ / "no" / "such", 2, {}), Error);
}

}  // namespace
}  // namespace sfumato::publish
