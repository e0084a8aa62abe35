#include "src/form_factor/point_question.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/form_factor/closed_forms.h"

namespace exitance {
namespace {

std::vector<Vec3> rectangle(double z, double x0, double y0, double x1, double y1) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}
std::vector<Vec3> reversed(std::vector<Vec3> loop) {
  std::reverse(loop.begin(), loop.end());
  return loop;
}
Obstacle sheet(std::vector<Vec3> loop) {
  return {{{std::move(loop), {}}}, false};
}
Obstacle box(const Vec3& a, const Vec3& b) {
  const auto corner = [&](int i) { return Vec3{i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z}; };
  Obstacle solid{{}, true};
  for (const auto& f : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    solid.faces.push_back({{corner(f[0]), corner(f[1]), corner(f[2]), corner(f[3])}, {}});
  }
  return solid;
}

/// Similarities that round nothing of the coordinates below, so that contacts stay contacts.
struct Similarity {
  const char* name;
  Vec3 u, v, w, origin;
  double scale;
  Vec3 turn(const Vec3& p) const { return p.x * u + p.y * v + p.z * w; }
  Vec3 operator()(const Vec3& p) const { return scale * (turn(p) + origin); }
  Polygon operator()(Polygon p) const {
    for (Vec3& v0 : p.outer) v0 = (*this)(v0);
    for (auto& hole : p.holes) {
      for (Vec3& v0 : hole) v0 = (*this)(v0);
    }
    return p;
  }
  PointQuestion operator()(const PointQuestion& q) const {
    PointQuestion moved{(*this)(q.point), turn(q.normal), (*this)(q.source), q.occluders};
    for (Obstacle& o : moved.occluders) {
      for (Polygon& face : o.faces) face = (*this)(face);
    }
    return moved;
  }
};

const Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1}, kU{1, 2, 2}, kV{2, 1, -2}, kW{-2, 2, -1};  // kU × kV = 3 kW
const std::vector<Similarity> kSimilarities{{"as it is", kX, kY, kZ, {}, 1},
                                            {"turned", kU, kV, kW, {}, 1},
                                            {"turned far away", kU, kV, kW, {1000003, -2000001, 1500007}, 1},
                                            {"huge", kU, kV, kW, {5, -3, 7}, 1e12},
                                            {"tiny", kU, kV, kW, {5, -3, 7}, 0x1p-40},
                                            {"tiny, rounded", kX, kY, kZ, {}, 1e-12},
                                            {"beyond float", kU, kV, kW, {}, 0x1p400},
                                            {"below float", kU, kV, kW, {}, 0x1p-400},
                                            {"near overflow", kU, kV, kW, {}, 0x1p1010},
                                            {"near underflow", kU, kV, kW, {}, 0x1p-1010}};

/// The point looks up from the origin at a source 4 × 4 at height 2, centred above it, that looks down.
const Polygon kCeiling{reversed(rectangle(2, -2, -2, 2, 2)), {}};
const double kQuarter = point_below_corner(2, 2, 2);

struct Question {
  const char* name;
  std::vector<Obstacle> occluders;
  double quarters;  ///< of the ceiling that are seen
};

std::vector<Question> contact_questions() {
  return {
      {"open", {}, 4},
      {"sheet in the source's plane, facing it", {sheet(rectangle(2, -2, -2, 0, 2))}, 2},
      {"sheet in the source's plane, facing away from it", {sheet(reversed(rectangle(2, -2, -2, 0, 0)))}, 3},
      {"solid behind the source, face to face", {box({-2, -2, 2}, {0, 2, 3})}, 4},
      {"point in the interior of a sheet", {sheet(rectangle(0, -1, -1, 1, 1))}, 4},
      {"point on a standing sheet", {sheet({{0, -1, -1}, {0, 1, -1}, {0, 1, 2}, {0, -1, 2}})}, 4},
      {"point on the edge of a leaning sheet", {sheet({{0, -4, 0}, {0, 4, 0}, {4, 4, 4}, {4, -4, 4}})}, 4},
      {"point on a corner of a leaning sheet", {sheet({{0, 0, 0}, {4, 0, 1}, {0, 4, 1}})}, 4},
      {"point on a face of a solid", {box({-1, -1, -1}, {1, 1, 0})}, 4},
      {"point on the edge of a solid", {box({0, -4, 0}, {4, 4, 1})}, 2},
      {"point on a corner of a solid", {box({0, 0, 0}, {4, 4, 1})}, 3},
      {"sheet below the horizon", {sheet(rectangle(-1, -9, -9, 9, 9))}, 4},
      {"sheet behind the source", {sheet(rectangle(3, -9, -9, 9, 9))}, 4},
      {"sheet on the horizon and above", {sheet({{0, -4, 0}, {4, -4, 0}, {4, -4, 1}, {0, -4, 1}})}, 4},
      {"two halves that share an edge", {sheet(rectangle(1, -1, -1, 0, 1)), sheet(rectangle(1, 0, -1, 1, 1))}, 0},
      {"one quarter twice", {sheet(rectangle(1, 0, 0, 1, 1)), sheet(rectangle(1, 0, 0, 1, 1))}, 3},
      {"no area", {sheet({{-1, 0, 1}, {1, 0, 1}, {0, 0, 1}}), sheet({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})}, 4},
      {"a hole just where the source is", {{{{rectangle(1, -4, -4, 4, 4), {rectangle(1, -1, -1, 1, 1)}}}, false}}, 4}};
}

TEST(PointQuestion, ContactsAreAnsweredAsDefined) {
  for (const Question& q : contact_questions()) {
    for (const Similarity& move : kSimilarities) {
      const PointAnswer a = answer(move(PointQuestion{{}, {0, 0, 1}, kCeiling, q.occluders}), 1e-12);
      const double expected = q.quarters * kQuarter;
      EXPECT_NEAR(a.F, expected, std::max(a.F_error, 2e-15)) << q.name << ", " << move.name;
      EXPECT_LE(a.F_error, 1e-12) << q.name << ", " << move.name;
    }
  }
}

TEST(PointQuestion, ASolidOnTheSourceHidesWithItsWholeHeight) {
  // Its lower face, at height 1, spans the same directions as twice its size at height 2.
  const Obstacle solid = box({-1, -1, 1}, {0, 1, 2});
  for (const Similarity& move : kSimilarities) {
    EXPECT_NEAR(answer(move(PointQuestion{{}, {0, 0, 1}, kCeiling, {solid}}), 1e-12).F, 2 * kQuarter, 2e-15)
        << move.name;
  }
}

TEST(PointQuestion, SidesAndHorizon) {
  const auto F = [](const Vec3& normal, const Polygon& source) { return answer({{}, normal, source, {}}, 1e-12).F; };
  EXPECT_NEAR(F({0, 0, 1e-300}, kCeiling), 4 * kQuarter, 1e-15);
  EXPECT_NEAR(F({0, 0, 1e300}, kCeiling), 4 * kQuarter, 1e-15);
  EXPECT_EQ(F({0, 0, -1}, kCeiling), 0);
  EXPECT_EQ(F({0, 0, 1}, {reversed(kCeiling.outer), {}}), 0) << "from behind";
  EXPECT_EQ(F({0, 0, 1}, {{{1, -1, 0}, {2, -1, 0}, {2, 1, 0}, {1, 1, 0}}, {}}), 0) << "in the horizon";
  EXPECT_EQ(F({0, 0, 1}, {{{-1, 0, 1}, {1, 0, 1}, {0, 0, 1}}, {}}), 0) << "no area";
  // Half of a wall that crosses the horizon: a point at distance 1 from an infinite strip 0 ≤ z ≤ 1 sees (1 − cos
  // 45°)/2.
  const Polygon wall{{{1, -1e9, -1}, {1, -1e9, 1}, {1, 1e9, 1}, {1, 1e9, -1}}, {}};
  EXPECT_NEAR(F({0, 0, 1}, wall), (1 - std::sqrt(0.5)) / 2, 1e-9);
}

TEST(PointQuestion, ASourceWithAHole) {
  const Polygon frame{kCeiling.outer, {rectangle(2, -1, -1, 1, 1)}};
  EXPECT_NEAR(answer({{}, {0, 0, 1}, frame, {}}, 1e-12).F, 4 * (kQuarter - point_below_corner(1, 1, 2)), 1e-15);
}

std::string complaint(const PointQuestion& question) {
  try {
    answer(question, 1e-12);
  } catch (const std::invalid_argument& wrong) {
    return wrong.what();
  }
  return "none";
}

TEST(PointQuestion, EachBadPartIsNamed) {
  const PointQuestion good{{}, {0, 0, 1}, kCeiling, {sheet(rectangle(1, 0, 0, 1, 1)), box({5, 5, 5}, {6, 6, 6})}};
  EXPECT_EQ(complaint(good), "none");
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto with = [&](const auto& change) {
    PointQuestion q = good;
    change(q);
    return complaint(q);
  };
  EXPECT_EQ(with([&](auto& q) { q.point.y = nan; }), "receiver.point: a coordinate is not a finite number");
  EXPECT_EQ(with([&](auto& q) { q.normal.x = infinity; }), "receiver.normal: a coordinate is not a finite number");
  EXPECT_EQ(with([](auto& q) { q.normal = {}; }), "receiver.normal: zero, so it has no direction");
  EXPECT_EQ(with([&](auto& q) { q.source.outer[2].z = nan; }), "source: a coordinate is not a finite number");
  EXPECT_EQ(with([](auto& q) { q.source.outer.resize(2); }), "source: a loop has fewer than three vertices");
  EXPECT_EQ(with([](auto& q) { std::swap(q.source.outer[0], q.source.outer[1]); }),
            "source: its boundary crosses or touches itself, or a hole lies outside it");
  EXPECT_EQ(with([](auto& q) { std::swap(q.occluders[0].faces[0].outer[0], q.occluders[0].faces[0].outer[1]); }),
            "occluders[0]: its boundary crosses or touches itself, or a hole lies outside it");
  EXPECT_EQ(with([&](auto& q) { q.occluders[1].faces[4].outer[0].x = -infinity; }),
            "occluders[1].polyhedron[4]: a coordinate is not a finite number");
  EXPECT_EQ(with([](auto& q) {
              q.point = {1e300, 0, 0};
              q.source.outer[0].x = 1e-300;
            }),
            "the coordinates span more orders of magnitude than can be computed with");
}

}  // namespace
}  // namespace exitance
