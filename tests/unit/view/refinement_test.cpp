// The policy against a simulated clock and render clients of known speed.
#include "view/refinement.h"

#include <gtest/gtest.h>

namespace sfumato::view {
namespace {

const Quality whole = Refinement::ladder[0];

/// Drags for `seconds` with pictures that take `ms(quality)`; what was drawn last and how many pictures came.
struct Drag {
  template <class Ms>
  Drag(Refinement& policy, double& now, double seconds, Ms ms) {
    double busy_until = 0;
    bool busy = false;
    for (const double end = now + 1000 * seconds; now < end; now += 8) {
      policy.changed(now);
      if (busy && now >= busy_until) {
        policy.done(last, ms(last));
        busy = false;
        ++pictures;
      }
      if (busy) continue;
      if (const auto next = policy.next(now)) {
        last = *next;
        policy.begun(last, now);
        busy = true;
        busy_until = now + ms(last);
      }
    }
    if (busy) policy.done(last, ms(last));
  }
  Quality last;
  int pictures = 0;
};

/// Software GL: points count, and pixels.
double slow(const Quality& q) { return (q.whole_cloud ? 400 : 20) + 200.0 / (q.divisor * q.divisor); }

TEST(Refinement, ShowsTheSampleUntilTheCloudIsThere) {
  Refinement policy;
  policy.set_subject("points");
  policy.changed(0);
  const auto first = policy.next(0);
  ASSERT_TRUE(first);
  EXPECT_FALSE(first->whole_cloud);
  policy.begun(*first, 0);
  EXPECT_FALSE(policy.next(1));  // one at a time
  policy.done(*first, 30);
  EXPECT_FALSE(policy.next(1000));  // nothing better yet
  EXPECT_FALSE(policy.settled());
  policy.set_whole_ready(true);
  ASSERT_TRUE(policy.next(1001));
  EXPECT_EQ(*policy.next(1001), whole);
}

TEST(Refinement, RestsBeforeTheWholePictureAndThenIsSettled) {
  Refinement policy;
  policy.set_subject("points");
  policy.set_whole_ready(true);
  policy.changed(1000);
  const auto moving = policy.next(1000);
  ASSERT_TRUE(moving);
  EXPECT_NE(*moving, whole);
  policy.begun(*moving, 1000);
  policy.done(*moving, 40);
  EXPECT_FALSE(policy.next(1040));
  ASSERT_TRUE(policy.wait_ms(1040));
  EXPECT_NEAR(*policy.wait_ms(1040), Refinement::rest_ms - 40, 1e-9);
  const double rested = 1000 + Refinement::rest_ms;
  ASSERT_EQ(policy.next(rested), whole);
  policy.begun(whole, rested);
  policy.done(whole, 700);
  EXPECT_TRUE(policy.settled());
  EXPECT_FALSE(policy.next(rested + 5000));
  EXPECT_FALSE(policy.wait_ms(rested + 5000));
}

TEST(Refinement, AChangeCallsOffTheWholePictureButNotOneInMotion) {
  Refinement policy;
  policy.set_subject("points");
  policy.set_whole_ready(true);
  policy.changed(0);
  policy.begun(whole, 1000);  // at rest
  policy.changed(1100);
  ASSERT_TRUE(policy.next(1100));
  policy.begun(*policy.next(1100), 1100);
  policy.changed(1110);
  EXPECT_FALSE(policy.next(1110));  // it is shown first
}

TEST(Refinement, FindsTheRungThatMoves) {
  Refinement policy;
  policy.set_subject("splats");
  policy.set_whole_ready(true);
  double now = 0;
  const Drag drag(policy, now, 4, slow);
  EXPECT_FALSE(drag.last.whole_cloud);
  EXPECT_LE(slow(drag.last), 80);
  EXPECT_GE(drag.pictures / 4.0, 12);
}

TEST(Refinement, DoesNotSwingBetweenTwoRungs) {
  Refinement policy;
  policy.set_subject("splats");
  policy.set_whole_ready(true);
  double now = 0;
  const Drag first(policy, now, 4, slow), second(policy, now, 4, slow), third(policy, now, 4, slow);
  EXPECT_EQ(first.last, second.last);
  EXPECT_EQ(second.last, third.last);
}

TEST(Refinement, MovesTheWholeCloudWhereThatIsFast) {
  Refinement policy;
  policy.set_subject("points");
  policy.set_whole_ready(true);
  const auto gpu = [](const Quality&) { return 6.0; };
  double now = 0;
  for (int i = 0; i < 3; ++i) {  // drag, rest, drag
    Drag(policy, now, 0.5, gpu);
    now += 1000;
    policy.begun(whole, now);
    policy.done(whole, 6);
  }
  EXPECT_EQ(Drag(policy, now, 1, gpu).last, whole);
}

TEST(Refinement, PointsStandInOnlyForTheHopeless) {
  const auto speed = [](double ms) { return [ms](const Quality& q) { return q.stand_in ? 20.0 : ms; }; };
  Refinement policy;
  policy.set_whole_ready(true);
  double now = 0;
  policy.set_subject("layers");
  EXPECT_FALSE(Drag(policy, now, 8, speed(150)).last.stand_in);  // slow, but itself
  policy.set_subject("strokes");
  EXPECT_TRUE(Drag(policy, now, 12, speed(600)).last.stand_in);
  policy.set_subject("layers");  // each has its own
  EXPECT_FALSE(Drag(policy, now, 2, speed(150)).last.stand_in);
}

TEST(Refinement, GoesStraightToWhereItCanBeFastEnough) {
  Refinement policy;
  policy.set_subject("layers");
  policy.set_whole_ready(true);
  const auto pixels_only = [](const Quality& q) { return 1600.0 / (q.divisor * q.divisor); };
  double now = 0;
  // Two pictures of 400 ms at half of the resolution, then a quarter of it: a third would not do.
  const Drag drag(policy, now, 1.5, pixels_only);
  EXPECT_EQ(drag.last.divisor, 4);
  EXPECT_LE(drag.pictures, 2 + 7);
}

TEST(Refinement, TheFastWayIsTheLastOfItsOwn) {
  Refinement policy;
  policy.set_subject("layers");
  policy.set_whole_ready(true);
  double now = 0;
  const Drag drag(policy, now, 8, [](const Quality& q) { return q.fast ? 50.0 : 150.0; });
  EXPECT_TRUE(drag.last.fast);
  EXPECT_FALSE(drag.last.stand_in);
  EXPECT_EQ(drag.last.divisor, 4);
}

TEST(Refinement, AStandInIsNotForEver) {
  Refinement policy;
  policy.set_subject("soft");
  policy.set_whole_ready(true);
  double now = 10'000, own_ms = 600;
  const auto speed = [&](const Quality& q) { return q.stand_in ? 20.0 : own_ms; };
  EXPECT_TRUE(Drag(policy, now, 12, speed).last.stand_in);
  now += 20'000;
  const Drag still(policy, now, 3, speed);
  EXPECT_TRUE(still.last.stand_in);
  EXPECT_GT(still.pictures, 3000 / 40);  // one trial, no more
  own_ms = 40;                           // what kept the machine busy is over
  now += 20'000;
  EXPECT_FALSE(Drag(policy, now, 3, speed).last.stand_in);
}

TEST(Refinement, AMistakeIsNotRepeatedUntilSomethingChanges) {
  Refinement policy;
  policy.set_subject("points");
  policy.set_whole_ready(true);
  policy.changed(0);
  policy.begun(whole, 1000);
  policy.failed();
  EXPECT_FALSE(policy.next(1001));
  EXPECT_FALSE(policy.next(9000));
  EXPECT_FALSE(policy.wait_ms(9000));
  policy.changed(9001);
  EXPECT_TRUE(policy.next(9001));
}

}  // namespace
}  // namespace sfumato::view
