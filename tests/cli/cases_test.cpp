#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/form_factor/closed_forms.h"
#include "tests/output/scratch_folder.h"
#include "tests/places.h"

namespace exitance {
namespace {

using Json = nlohmann::json;

struct Outcome {
  int code = 0;
  std::string out, err;
  Json results() const { return Json::parse(out)["results"]; }
};

class Cases : public testing::Test {
 protected:
  Outcome run(const std::string& text, const std::string& options = "") {
    std::ofstream(folder_ / "cases.json") << text;
    return run_file((folder_ / "cases.json").string(), options);
  }
  Outcome run_file(const std::string& file, const std::string& options = "") {
    const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
    const std::string command = program() + " cases " + file + " " + options + " > " + out + " 2> " + err;
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), contents(out), contents(err)};
  }
  /// The answer to one case, which must be the only one.
  Json answer(const std::string& one, const std::string& options = "") {
    const Outcome r = run("{\"cases\":[" + one + "]}", options);
    const Json results = r.results();
    EXPECT_EQ(results.size(), 1u);
    EXPECT_EQ(r.code, results[0]["status"] == "ok" ? 0 : 3);
    return results[0];
  }
  std::string complaint(const std::string& one) {
    const Json a = answer(one);
    return a["status"] == "error" ? a["message"].get<std::string>() : "none";
  }

  ScratchFolder folder_;
};

const std::string kFloor = R"({"polygon":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})";
const std::string kCeiling = R"({"polygon":[[0,1,1],[1,1,1],[1,0,1],[0,0,1]]})";
const std::string kPlate = R"({"polygon":[[0.25,0.25,0.75],[0.75,0.25,0.75],[0.75,0.75,0.75],[0.25,0.75,0.75]]})";

std::string point_case(const std::string& point, const std::string& normal, const std::string& source,
                       const std::string& occluders = "[]", const std::string& id = "\"a\"") {
  return R"({"id":)" + id + R"(,"kind":"point_polygon","receiver":{"point":)" + point + R"(,"normal":)" + normal +
         R"(},"source":)" + source + R"(,"occluders":)" + occluders + "}";
}
std::string with(const std::string& object, const std::string& more) {
  return object.substr(0, object.size() - 1) + "," + more + "}";
}

TEST_F(Cases, PointPolygon) {
  const double F = point_below_corner(1, 1, 1);
  const Json open = answer(point_case("[0,0,0]", "[0,0,7]", kCeiling));
  EXPECT_EQ(open["id"], "a");
  EXPECT_NEAR(open["F"].get<double>(), F, 1e-15);
  EXPECT_LE(open["F_error"].get<double>(), 1e-14);
  // A sheet in the source's plane, and a box in front of all of it but the part nearest to the point.
  const std::string half = R"([{"polygon":[[0,0,1],[1,0,1],[1,0.5,1],[0,0.5,1]]}])";
  EXPECT_NEAR(answer(point_case("[0,0,0]", "[0,0,1]", kCeiling, half))["F"].get<double>(),
              F - point_below_corner(1, 0.5, 1), 1e-15);
  const std::string box = R"([{"polyhedron":[
      [[0,0,0.5],[0,0.25,0.5],[0.5,0.25,0.5],[0.5,0,0.5]],[[0,0,0.75],[0.5,0,0.75],[0.5,0.25,0.75],[0,0.25,0.75]],
      [[0,0,0.5],[0.5,0,0.5],[0.5,0,0.75],[0,0,0.75]],[[0,0.25,0.5],[0,0.25,0.75],[0.5,0.25,0.75],[0.5,0.25,0.5]],
      [[0,0,0.5],[0,0,0.75],[0,0.25,0.75],[0,0.25,0.5]],[[0.5,0,0.5],[0.5,0.25,0.5],[0.5,0.25,0.75],[0.5,0,0.75]]]}])";
  EXPECT_NEAR(answer(point_case("[0,0,0]", "[0,0,1]", kCeiling, box))["F"].get<double>(),
              F - point_below_corner(1, 0.5, 1), 1e-15);
  const std::string frame = with(kCeiling, R"("holes":[[[0.25,0.25,1],[0.5,0.25,1],[0.5,0.5,1],[0.25,0.5,1]]])");
  EXPECT_NEAR(answer(point_case("[0.5,0.5,0]", "[0,0,1]", frame))["F"].get<double>(),
              4 * point_below_corner(0.5, 0.5, 1) - point_below_corner(0.25, 0.25, 1), 1e-15);
  EXPECT_EQ(answer(point_case("[0,0,0]", "[0,0,1]", R"({"polygon":[[0,0,1],[1,0,1],[2,0,1]]})"))["F"], 0);
}

TEST_F(Cases, PolygonPolygon) {
  const std::string open =
      R"({"id":1,"kind":"polygon_polygon","receiver":)" + kFloor + R"(,"source":)" + kCeiling + "}";
  const Json a = answer(open);
  EXPECT_NEAR(a["F"].get<double>(), opposite_rectangles(1, 1, 1), a["F_error"].get<double>());
  EXPECT_NEAR(a["F_reverse"].get<double>(), opposite_rectangles(1, 1, 1), 1e-12);
  EXPECT_EQ(a["reached"], true);
  const Json blocked = answer(with(open, R"("occluders":[)" + kPlate + "]"));
  EXPECT_NEAR(blocked["F"].get<double>(), kShapiroBlocked, 1e-14);
  EXPECT_LE(blocked["F_error"].get<double>(), 1e-12);
  const Json loose = answer(with(open, R"("occluders":[)" + kPlate + "]"), "--tolerance 1e-3");
  EXPECT_NEAR(loose["F"].get<double>(), kShapiroBlocked, loose["F_error"].get<double>());
  EXPECT_LE(loose["F_error"].get<double>(), 1e-3);

  const std::string line = R"({"polygon":[[0,0,0],[1,0,0],[2,0,0]]})";
  const auto pair = [](const std::string& receiver, const std::string& source) {
    return R"({"kind":"polygon_polygon","receiver":)" + receiver + R"(,"source":)" + source + "}";
  };
  EXPECT_EQ(answer(pair(kFloor, line))["F"], 0);
  EXPECT_EQ(complaint(pair(line, kFloor)), "receiver: it has no area");
}

TEST_F(Cases, EnclosureOfTwoSquaresAndOneAbsent) {
  const Json a = answer(R"({"id":"e","kind":"enclosure","patches":[)" + kFloor + "," +
                        with(kPlate, R"("absent":true)") + "," + kCeiling + "]}");
  const double F = opposite_rectangles(1, 1, 1);
  EXPECT_NEAR(a["F"][0][2].get<double>(), F, 1e-14);
  EXPECT_NEAR(a["F"][2][0].get<double>(), F, 1e-14);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(a["F"][1][k], 0);
    EXPECT_EQ(a["F"][k][k], 0);
    EXPECT_EQ(a["F_error"][k][1], 0);
  }
  EXPECT_EQ(a["A"], Json({1, 0, 1}));
}

/// Two opposite squares, the lower one emitting: B1 = E / (1 − ρ1 ρ2 F²), B2 = ρ2 F B1.
TEST_F(Cases, RadiosityInNumbersAndInBands) {
  const double F = opposite_rectangles(1, 1, 1);
  const Json a = answer(R"({"kind":"radiosity","patches":[)" + with(kFloor, R"("E":2,"rho":0.5)") + "," +
                        with(kCeiling, R"("E":0,"rho":0.25)") + "]}");
  const double B1 = 2 / (1 - 0.125 * F * F), B2 = 0.25 * F * B1;
  EXPECT_NEAR(a["B"][0].get<double>(), B1, 1e-13);
  EXPECT_NEAR(a["B"][1].get<double>(), B2, 1e-13);
  EXPECT_NEAR(a["H"][0].get<double>(), F * B2, 1e-13);
  EXPECT_NEAR(a["H"][1].get<double>(), F * B1, 1e-13);
  EXPECT_LE(a["B_error"][0].get<double>(), 1e-11);
  const Json bands = answer(R"({"kind":"radiosity","patches":[)" + with(kFloor, R"("E":[2,4],"rho":0.5)") + "," +
                            with(kCeiling, R"("E":0,"rho":[0.25,0])") + "]}");
  EXPECT_NEAR(bands["B"][0][0].get<double>(), B1, 1e-13);
  EXPECT_NEAR(bands["B"][1][0].get<double>(), B2, 1e-13);
  EXPECT_EQ(bands["B"][0][1], 4);
  EXPECT_EQ(bands["B"][1][1], 0);
  EXPECT_NEAR(bands["H"][1][1].get<double>(), F * 4, 1e-13);
}

TEST_F(Cases, FurnaceCube) {
  std::string patches;
  const char* const faces[] = {"[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]", "[[0,1,1],[1,1,1],[1,0,1],[0,0,1]]",
                               "[[0,0,0],[0,0,1],[1,0,1],[1,0,0]]", "[[1,1,0],[1,1,1],[0,1,1],[0,1,0]]",
                               "[[0,1,0],[0,1,1],[0,0,1],[0,0,0]]", "[[1,0,0],[1,0,1],[1,1,1],[1,1,0]]"};
  for (const char* face : faces) {
    patches += (patches.empty() ? "" : ",") + (R"({"polygon":)" + std::string(face) + R"(,"E":1,"rho":0.5})");
  }
  const Json a = answer(R"({"kind":"radiosity","patches":[)" + patches + "]}");
  ASSERT_EQ(a["status"], "ok") << a;
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(a["B"][k].get<double>(), 2, 1e-12);
    EXPECT_LE(std::abs(a["B"][k].get<double>() - 2), a["B_error"][k].get<double>());
    EXPECT_LE(a["B_error"][k].get<double>(), 1e-10);
  }
}

/// A plate, black and dark, comes between two squares: R1 = ρ1 (F' − F) B2, and B changes from one pair to the other.
TEST_F(Cases, DynamicOfAPlateThatComesAndGoes) {
  const double F = opposite_rectangles(1, 1, 1), G = kShapiroBlocked;
  const std::string floor = with(kFloor, R"("E":2,"rho":0.5)"), ceiling = with(kCeiling, R"("E":0,"rho":0.25)"),
                    plate = with(kPlate, R"("E":0.5,"rho":0)");
  const std::string absent = with(plate, R"("absent":true)");
  const auto question = [&](const std::string& before, const std::string& after) {
    return R"({"kind":"dynamic","before":{"patches":[)" + floor + "," + ceiling + "," + before +
           R"(]},"after":{"patches":[)" + floor + "," + ceiling + "," + after + "]}}";
  };
  const double B1 = 2 / (1 - 0.125 * F * F), B2 = 0.25 * F * B1;
  const Json comes = answer(question(absent, plate));
  EXPECT_NEAR(comes["R"][0].get<double>(), 0.5 * (G - F) * B2, 1e-12);
  // The ceiling sees the plate's front too, but that had no radiosity before.
  EXPECT_NEAR(comes["R"][1].get<double>(), 0.25 * (G - F) * B1, 1e-12);
  EXPECT_EQ(comes["R"][2], 0);
  EXPECT_NEAR(comes["B_before"][0].get<double>(), B1, 1e-12);
  EXPECT_EQ(comes["B_before"][2], 0);
  EXPECT_EQ(comes["dB"][2], 0.5);
  const Json goes = answer(question(plate, absent));
  EXPECT_EQ(goes["dB"][2], -0.5);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(goes["dB"][k].get<double>(), -comes["dB"][k].get<double>(), 1e-12);
    EXPECT_NEAR(goes["B_after"][k].get<double>(), comes["B_before"][k].get<double>(), 1e-15);
  }
}

/// A x = b by elimination with pivots.
std::vector<long double> eliminate(std::vector<std::vector<long double>> A, std::vector<long double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i) pivot = std::fabs(A[i][k]) > std::fabs(A[pivot][k]) ? i : pivot;
    std::swap(A[k], A[pivot]);
    std::swap(b[k], b[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const long double factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) b[k] /= A[k][k];
  return b;
}

/// A plate comes, another goes, a floor becomes brighter and a ceiling darker: R and ΔB from the form factors of both
/// enclosures by dense arithmetic.
TEST_F(Cases, DynamicSolvesTheRedistributionEquation) {
  const std::string other = R"({"polygon":[[0.2,0.3,0.25],[0.2,0.6,0.25],[0.7,0.6,0.5],[0.7,0.3,0.5]]})";
  const std::vector<std::string> shapes = {kFloor, kCeiling, kPlate, other};
  const std::vector<double> E = {2, 0, 0.5, 0.25}, rho = {0.5, 0.7, 0.3, 0.6}, E_after = {2.5, 0, 0.5, 0.25},
                            rho_after = {0.5, 0.4, 0.3, 0.6};
  const auto list = [&](bool after, bool enclosure) {
    std::string patches;
    for (std::size_t p = 0; p < 4; ++p) {
      const bool absent = p == (after ? 3u : 2u);
      const std::string values = R"("E":)" + std::to_string(after ? E_after[p] : E[p]) + R"(,"rho":)" +
                                 std::to_string(after ? rho_after[p] : rho[p]);
      patches += (p == 0 ? "" : ",") + with(shapes[p], (enclosure ? std::string(R"("kept":1)") : values) +
                                                           (absent ? R"(,"absent":true)" : ""));
    }
    return R"({"patches":[)" + patches + "]";
  };
  const Json a =
      answer(R"({"kind":"dynamic","before":)" + list(false, false) + R"(},"after":)" + list(true, false) + "}}");
  ASSERT_EQ(a["status"], "ok") << a;
  const auto F_of = [&](bool after) {
    const Json f = answer(R"({"kind":"enclosure",)" + list(after, true).substr(1) + "}");
    EXPECT_EQ(f["status"], "ok") << f;
    return f["F"].get<std::vector<std::vector<double>>>();
  };
  const auto F = F_of(false), F_after = F_of(true);
  const auto solved = [](const auto& f, const std::vector<double>& emitted, const std::vector<double>& reflectance,
                         std::size_t absent) {
    std::vector<std::vector<long double>> A(4, std::vector<long double>(4));
    std::vector<long double> b(4);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) A[i][j] = (i == j ? 1.0L : 0.0L) - reflectance[i] * f[i][j];
      b[i] = i == absent ? 0 : emitted[i];
    }
    return eliminate(A, b);
  };
  const auto B = solved(F, E, rho, 2), B_after = solved(F_after, E_after, rho_after, 3);
  for (std::size_t i = 0; i < 4; ++i) {
    long double R = 0;
    for (std::size_t j = 0; j < 4; ++j) R += (i == 3 ? 0 : rho_after[i]) * (F_after[i][j] - F[i][j]) * B[j];
    if (i != 3) {
      EXPECT_NEAR(a["R"][i].get<double>(), static_cast<double>(R), 1e-12) << i;
    }
    EXPECT_NEAR(a["dB"][i].get<double>(), static_cast<double>(B_after[i] - B[i]), 1e-12) << i;
    EXPECT_LE(a["dB_error"][i].get<double>(), 1e-9);
  }
}

TEST_F(Cases, OneBadCaseLeavesTheOthers) {
  const std::string good = point_case("[0,0,0]", "[0,0,1]", kCeiling);
  const Outcome r =
      run("{\"cases\":[" + good + "," + point_case("[0,0,NaN]", "[0,0,1]", kCeiling, "[]", R"("NaN: \"")") + "," +
          good + "," + point_case("[1e999,0,0]", "[0,0,1]", kCeiling, "[]", "7") + ",5," + good + "]}");
  EXPECT_EQ(r.code, 3);
  const Json results = r.results();
  ASSERT_EQ(results.size(), 6u);
  for (const std::size_t k : {0u, 2u, 5u})
    EXPECT_NEAR(results[k]["F"].get<double>(), point_below_corner(1, 1, 1), 1e-15);
  EXPECT_EQ(results[1]["id"], "NaN: \"");
  EXPECT_EQ(results[1]["message"], "receiver.point[2]: is not a finite number");
  EXPECT_EQ(results[3]["id"], 7);
  EXPECT_EQ(results[3]["message"], "receiver.point[0]: is not a finite number");
  EXPECT_EQ(results[4]["id"], nullptr);
  EXPECT_EQ(results[4]["message"], "a case must be an object");
}

TEST_F(Cases, EveryRuleIsNamedWhenBroken) {
  const std::string up = "[0,0,1]", origin = "[0,0,0]";
  EXPECT_EQ(complaint(point_case(origin, "[0,0,0]", kCeiling)), "receiver.normal: zero, so it has no direction");
  EXPECT_EQ(complaint(point_case("[-Infinity,0,0]", up, kCeiling)), "receiver.point[0]: is not a finite number");
  EXPECT_EQ(complaint(point_case("[null,0,0]", up, kCeiling)), "receiver.point[0]: must be a number");
  EXPECT_EQ(complaint(point_case("[\"1\",0,0]", up, kCeiling)), "receiver.point[0]: must be a number");
  EXPECT_EQ(complaint(point_case("[0,0]", up, kCeiling)), "receiver.point: must have three coordinates");
  EXPECT_EQ(complaint(point_case(origin, "3", kCeiling)), "receiver.normal: must be a list");
  EXPECT_EQ(complaint(point_case(origin, up, "{}")), "source: the key \"polygon\" is missing");
  EXPECT_EQ(complaint(point_case(origin, up, "[]")), "source: must be an object");
  EXPECT_EQ(complaint(point_case(origin, up, R"({"polygon":[[0,0,1],[1,1,1],[1,0,1],[0,1,1]]})")),
            "source: its boundary crosses or touches itself, or a hole lies outside it");
  EXPECT_EQ(complaint(point_case(origin, up, with(kCeiling, R"("holes":[[[0,0,1],[1,1,1]]])"))),
            "source: a loop has fewer than three vertices");
  EXPECT_EQ(complaint(point_case(origin, up, kCeiling, "[{}]")),
            "occluders[0]: the key \"polygon\" or \"polyhedron\" is missing");
  EXPECT_EQ(complaint(point_case(origin, up, kCeiling, R"([{"polyhedron":[[[0,0,1],[1,0,1],[0,1,true]]]}])")),
            "occluders[0].polyhedron[0][2][2]: must be a number");
  EXPECT_EQ(complaint(R"({"kind":"point_polygon"})"), "the key \"receiver\" is missing");
  EXPECT_EQ(complaint(R"({"id":1})"), "the key \"kind\" is missing");
  EXPECT_EQ(complaint(R"({"kind":"polygon"})").substr(0, 25), "kind: \"polygon\" is not kn");
  const auto patches = [](const std::string& kind, const std::string& list) {
    return R"({"kind":")" + kind + R"(","patches":[)" + list + "]}";
  };
  EXPECT_EQ(complaint(patches("enclosure", kFloor + R"(,{"polygon":[[0,0,0],[1,0,0],[2,0,0]]})")),
            "patches[1]: it has no area");
  EXPECT_EQ(complaint(patches("radiosity", with(kFloor, R"("E":1)"))), "patches[0]: the key \"rho\" is missing");
  EXPECT_EQ(complaint(patches("radiosity", with(kFloor, R"("E":1,"rho":1)"))),
            "patches[0].rho: must lie in [0, 1), not 1.0");
  EXPECT_EQ(complaint(patches("radiosity", with(kFloor, R"("E":1,"rho":[0.5,-0.25])"))),
            "patches[0].rho: must lie in [0, 1), not -0.25");
  EXPECT_EQ(complaint(patches("radiosity", with(kFloor, R"("E":[1,2],"rho":[0.5,0,0])"))),
            "patches[0].rho: must have as many bands as the others");
  EXPECT_EQ(complaint(R"({"kind":"dynamic","before":{"patches":[]}})"), "the key \"after\" is missing");
  EXPECT_EQ(complaint(R"({"kind":"dynamic","before":{"patches":[]},"after":{"patches":[)" +
                      with(kFloor, R"("E":1,"rho":0)") + "]}}"),
            "after.patches: must list the same patches as before.patches, in the same order");
}

/// DESIGN.md 7: of zero area, a source or an occluder counts for nothing and a receiver is an error, in every kind.
TEST_F(Cases, WithoutArea) {
  const double F = point_below_corner(1, 1, 1);
  for (const char* nothing : {"[]", "[[0,0,0.5]]", "[[0,0,0.5],[1,1,0.5]]", "[[0,0,0.5],[1,1,0.5],[0.5,0.5,0.5]]",
                              "[[0.1,0.3,0.7],[0.1,0.3,0.7],[0.1,0.3,0.7]]"}) {
    const std::string polygon = R"({"polygon":)" + std::string(nothing) + "}";
    const std::string occluders = "[" + polygon + R"(,{"polyhedron":[)" + nothing + R"(]},{"polyhedron":[]}])";
    EXPECT_EQ(answer(point_case("[0,0,0]", "[0,0,1]", polygon))["F"], 0) << nothing;
    EXPECT_NEAR(answer(point_case("[0,0,0]", "[0,0,1]", kCeiling, occluders))["F"].get<double>(), F, 1e-15) << nothing;
    const auto pair = [&](const std::string& receiver, const std::string& source) {
      return R"({"kind":"polygon_polygon","receiver":)" + receiver + R"(,"source":)" + source + R"(,"occluders":)" +
             occluders + "}";
    };
    EXPECT_NEAR(answer(pair(kFloor, kCeiling))["F"].get<double>(), opposite_rectangles(1, 1, 1), 1e-12) << nothing;
    EXPECT_EQ(answer(pair(kFloor, polygon))["F"], 0) << nothing;
    EXPECT_EQ(complaint(pair(polygon, kFloor)), "receiver: it has no area") << nothing;
    EXPECT_EQ(complaint(R"({"kind":"enclosure","patches":[)" + kFloor + "," + polygon + "]}"),
              "patches[1]: it has no area")
        << nothing;
    EXPECT_EQ(complaint(R"({"kind":"radiosity","patches":[)" + with(polygon, R"("E":1,"rho":0)") + "]}"),
              "patches[0]: it has no area")
        << nothing;
    const std::string absent = with(polygon, R"("absent":true,"E":1,"rho":0)");
    const std::string change = R"({"kind":"dynamic","before":{"patches":[)" + absent + R"(]},"after":{"patches":[)" +
                               with(polygon, R"("E":1,"rho":0)") + "]}}";
    EXPECT_EQ(complaint(change), "after.patches[0]: it has no area") << nothing;
  }
}

TEST_F(Cases, WhatIsAbsentNeedsNoMore) {
  const std::string there = with(kFloor, R"("E":2,"rho":0.5)"), absent = R"({"absent":true})";
  const auto question = [](const std::string& before, const std::string& after) {
    return R"({"kind":"dynamic","before":{"patches":[)" + before + R"(]},"after":{"patches":[)" + after + "]}}";
  };
  EXPECT_EQ(answer(question(there, absent))["dB"], Json({-2}));
  EXPECT_EQ(answer(question(absent, there))["dB"], Json({2}));
  EXPECT_EQ(answer(question(absent, absent))["B_after"], Json({0}));
  EXPECT_EQ(answer(R"({"kind":"enclosure","patches":[)" + absent + "]}")["A"], Json({0}));
  const std::string bands = with(kFloor, R"("E":[2,3],"rho":0.5)");
  EXPECT_EQ(answer(question(absent, bands))["dB"], Json({{2, 3}}));
}

/// Sizes at which products overflow or vanish: the right number, or an error; never null and never a wrong number.
TEST_F(Cases, Sizes) {
  const auto square = [](const std::string& s, const std::string& z, bool up) {
    const std::string a = "[0,0," + z + "]", b = "[" + s + ",0," + z + "]", c = "[" + s + "," + s + "," + z + "]",
                      d = "[0," + s + "," + z + "]";
    return R"({"polygon":[)" + (up ? a + "," + b + "," + c + "," + d : d + "," + c + "," + b + "," + a) + "]}";
  };
  const auto pair = [](const std::string& receiver, const std::string& source) {
    return R"({"kind":"polygon_polygon","receiver":)" + receiver + R"(,"source":)" + source + "}";
  };
  const auto enclosure = [](const std::string& a, const std::string& b) {
    return R"({"kind":"enclosure","patches":[)" + a + "," + b + "]}";
  };
  const double F = opposite_rectangles(1, 1, 1);
  for (const char* s : {"1e-320", "1e-200", "1e-20", "1e20", "1e160", "1e300"}) {
    const Json a = answer(pair(square(s, "0", true), square(s, s, false)));
    EXPECT_NEAR(a["F"].get<double>(), F, s == std::string("1e-320") ? 1e-4 : 1e-12) << s;  // 1e-320 has three digits
    const Json e = answer(enclosure(square(s, "0", true), square(s, s, false)));
    if (e["status"] == "ok") {
      EXPECT_NEAR(e["F"][0][1].get<double>(), F, 1e-12) << s;
      EXPECT_GT(e["A"][0].get<double>(), 0) << s;
    } else {
      EXPECT_NE(e["message"].get<std::string>().find("its area is out of the range of a double"), std::string::npos);
    }
  }
  for (const char* far : {"1e30", "1e80", "1e100", "1e200", "1e300"}) {
    const std::string near_one = square("1", "0", true), far_one = square(far, far, false);
    EXPECT_EQ(complaint(pair(near_one, far_one)).substr(0, 28), "receiver: its area is nothin") << far;
    EXPECT_EQ(complaint(pair(far_one, near_one)).substr(0, 28), "source: its area is nothing ") << far;
    EXPECT_EQ(complaint(enclosure(near_one, far_one)).substr(0, 30), "patches[0]: its area is nothin") << far;
  }
  EXPECT_EQ(complaint(R"({"kind":"radiosity","patches":[)" + with(kFloor, R"("E":1e300,"rho":0.5)") + "]}"),
            "patches[0].E: must be 0 or of a size from 1e-250 to 1e100, not 1e+300");
}

TEST_F(Cases, DeepNestingIsRefusedInOneLine) {
  const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
  for (const std::size_t depth : {100u, 1000u, 100000u}) {
    const Outcome r = run("{\"cases\":[\n{\"id\":" + nested(depth) + "}]}");
    EXPECT_EQ(r.code, 3);
    EXPECT_EQ(r.out, "");
    EXPECT_NE(r.err.find("cases.json:2: has lists and objects more than 100 deep"), std::string::npos) << r.err;
    EXPECT_EQ(run(std::string(depth, '[')).code, 3);
    EXPECT_EQ(run("{\"cases\":[],\"more\":" + nested(depth) + "}").code, 3);
  }
  EXPECT_EQ(answer(point_case("[0,0,0]", "[0,0,1]", kCeiling, "[]", nested(90)))["status"], "ok");
  const std::string brackets_in_a_text = "\"" + std::string(1000, '[') + "\"";
  EXPECT_EQ(answer(point_case("[0,0,0]", "[0,0,1]", kCeiling, "[]", brackets_in_a_text))["status"], "ok");
}

TEST_F(Cases, FilesThatCannotBeUsedAreRefusedInOneLine) {
  const auto refused = [](const Outcome& r, const std::string& part) {
    EXPECT_EQ(r.code, 3);
    EXPECT_EQ(r.out, "");
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    EXPECT_NE(r.err.find(part), std::string::npos) << r.err;
  };
  refused(run_file("/nowhere/cases.json"), "/nowhere/cases.json: no such file");
  refused(run_file("/"), "is a folder");
  refused(run("{\"cases\":[\n{\"id\":1},\n{\"id\":]}"), "cases.json:3: is not JSON: syntax error");
  refused(run("{\"cases\":[\n"), "is not JSON");
  refused(run(""), "cases.json:1: is not JSON");
  refused(run("[]"), "has no list \"cases\"");
  refused(run("{\"cases\":1}"), "has no list \"cases\"");
  EXPECT_EQ(run("{\"cases\":[]}", "--unknown").code, 2);
  EXPECT_EQ(run("{\"cases\":[]}", "--tolerance -1").code, 2);
  EXPECT_EQ(run("{\"cases\":[]}").code, 0);
}

TEST_F(Cases, AnEarlierAnswerStaysUntilThereIsANewOne) {
  const std::string out = (folder_ / "answers.json").string();
  const Outcome first = run("{\"cases\":[" + point_case("[0,0,0]", "[0,0,1]", kCeiling) + "]}", "-o " + out);
  EXPECT_EQ(first.code, 0);
  EXPECT_EQ(first.out, "");
  const std::string before = contents(out);
  EXPECT_EQ(Json::parse(before)["results"].size(), 1u);
  EXPECT_EQ(run("{", "-o " + out).code, 3);
  EXPECT_EQ(contents(out), before);
  EXPECT_EQ(run("{\"cases\":[]}", "-o /nowhere/answers.json").code, 3);
}

TEST_F(Cases, SameBytesForAnyNumberOfThreads) {
  std::string cases;
  for (int k = 0; k < 40; ++k) {
    cases += point_case("[0." + std::to_string(10 + k) + ",0.3,0]", "[0,0.1,1]", kCeiling, "[" + kPlate + "]") + ",";
  }
  cases += R"({"kind":"enclosure","patches":[)" + kFloor + "," + kPlate + "," + kCeiling + "]}";
  const std::string text = "{\"cases\":[" + cases + "]}";
  EXPECT_EQ(run(text, "--threads 1").out, run(text, "--threads 2").out);
}

}  // namespace
}  // namespace exitance
