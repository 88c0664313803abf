// Who may ask the server for what, and how good pictures may be on a line: without a network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "apps/serve/access.h"
#include "apps/serve/pace.h"
#include "apps/serve/server.h"

namespace sfumato::serve {
namespace {

TEST(Access, TokensAreLongAndNew) {
  std::set<std::string> all;
  for (int i = 0; i < 1000; ++i) all.insert(new_token());
  EXPECT_EQ(all.size(), 1000u);
  EXPECT_EQ(all.begin()->size(), 32u);
}

TEST(Access, OnlyTheWholeTokenIsOne) {
  const std::string token = "0123456789abcdef0123456789abcdef";
  EXPECT_TRUE(is_token(token, token));
  for (const std::string& wrong :
       {std::string(), token.substr(1), token + "0", std::string(32, '0'), token + token})
    EXPECT_FALSE(is_token(wrong, token)) << wrong;
}

TEST(Access, HostsAreNumbersOrNamed) {
  for (const char* host :
       {"127.0.0.1:8080", "localhost:9000", "LOCALHOST", "[::1]:8080", "192.168.1.5", "scan.example:443"})
    EXPECT_TRUE(is_known_host(host, {"Scan.example"})) << host;
  for (const char* host : {"", "evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "[::1",
                           "[evil]", "1.2.3", ".1.2.3", "1.2.3.x", "scan.example.evil"})
    EXPECT_FALSE(is_known_host(host, {"scan.example"})) << host;
}

TEST(Access, OriginsAreOurOwn) {
  EXPECT_TRUE(is_own_origin("", "127.0.0.1:8080"));
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_TRUE(is_own_origin("https://scan.example", "scan.example"));
  for (const char* origin : {"null", "http://127.0.0.1", "http://127.0.0.1:8081", "http://evil.example",
                             "file://", "127.0.0.1:8080"})
    EXPECT_FALSE(is_own_origin(origin, "127.0.0.1:8080")) << origin;
}

TEST(Access, TargetsAreTakenApart) {
  const auto target = parse_target(
      "/0123456789abcdef0123456789abcdef/render?technique=points&draw=class%206%3A+splats&empty&token=x");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->token, "x");
  EXPECT_EQ(target->path, "/render");
  EXPECT_THAT(target->query, ::testing::ElementsAre(::testing::Pair("technique", "points"),
                                                    ::testing::Pair("draw", "class 6: splats"),
                                                    ::testing::Pair("empty", "")));
  EXPECT_EQ(parse_target("/info")->token, "");
  for (const std::string& wrong :
       {std::string(), std::string("info"), std::string("/%"), std::string("/%0"), std::string("/%00"),
        std::string("/%gg"), std::string("/a?b=%0a"), "/" + std::string(5000, 'a')})
    EXPECT_FALSE(parse_target(wrong)) << wrong;
}

/// A line of so many bytes a millisecond and so long a way, which carries pictures one after the other.
void carry(Pace& pace, double rate, double latency, int pictures, const std::function<std::size_t()>& bytes) {
  double now = 1000, free = 0;
  for (int id = 1; id <= pictures; ++id) {
    ASSERT_TRUE(pace.may_send());
    const std::size_t size = bytes();
    pace.sent(std::uint64_t(id), size, true, now);
    free = std::max(free, now) + double(size) / rate;
    pace.confirmed(std::uint64_t(id), free + latency);
    now = free + latency;
  }
}

TEST(Pace, SlowLinesGetPicturesThatTheyCarry) {
  Pace pace;
  // 10 Mbit/s and 40 ms; a picture of 1280x720 takes 3 kB for each step of quality, less when it is shrunk.
  const auto bytes = [&] { return std::size_t(6000 * pace.quality() / (pace.shrink() * pace.shrink())); };
  carry(pace, 1250, 40, 40, bytes);
  EXPECT_LE(double(bytes()) / 1250,
            Pace::wanted_ms);  // one step of quality may be too much, then it goes back
  EXPECT_GE(double(bytes()) / 1250, 0.1 * Pace::wanted_ms);
  EXPECT_LT(pace.quality(), 75);
  EXPECT_LE(pace.bytes_per_ms(), 1250);
  EXPECT_GE(pace.bytes_per_ms(), 300);
  EXPECT_GE(pace.latency_ms(), 40);
  EXPECT_LE(pace.latency_ms(), 140);
}

TEST(Pace, FastLinesGetTheBest) {
  Pace pace;
  carry(pace, 100'000, 0.5, 20, [] { return 150'000; });
  EXPECT_EQ(pace.quality(), Pace::most_quality);
  EXPECT_EQ(pace.shrink(), 1);
  EXPECT_FALSE(pace.is_slow_for(2'000'000));
}

TEST(Pace, NothingQueues) {
  Pace pace;
  pace.sent(1, 1000, true, 0);
  EXPECT_TRUE(pace.may_send());
  pace.sent(2, 1000, true, 1);
  EXPECT_FALSE(pace.may_send());
  pace.confirmed(7, 2);  // what a page makes up
  pace.confirmed(7, 3);
  pace.confirmed(2, 10);
  EXPECT_TRUE(pace.may_send());
}

TEST(PageFiles, AreWholeAndLoadNothingFromElsewhere) {
  std::set<std::string> names;
  for (const PageFile& file : page_files) {
    names.insert(file.name);
    if (file.name == "openapi.json" || file.name == "icon.svg") continue;
    std::string text = file.text;
    for (std::size_t at; (at = text.find("http://www.w3.org/2000/svg")) != text.npos;) text.erase(at, 26);
    EXPECT_EQ(text.find("http://"), text.npos) << file.name;
    EXPECT_EQ(text.find("https://"), text.npos) << file.name;
  }
  for (const char* name : {"index.html", "style.css", "app.mjs", "panels.mjs", "openapi.json"})
    EXPECT_TRUE(names.contains(name)) << name;
}

}  // namespace
}  // namespace sfumato::serve
