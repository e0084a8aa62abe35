#include "src/stress/shadow_question.h"

#include <algorithm>
#include <cmath>

#include "geometry/shadow_volume.h"
#include "src/stress/shaft_oracle.h"

namespace exitance {
namespace {

/// Of sample points: what of F rounding cannot bring about.
constexpr long double kRoundingOfPoints = 1e-12L;

struct Object {
  std::uint32_t first, last;  ///< facets

  explicit Object(const AreaScene& scene)
      : first(scene.soup.first_facet(scene.first_of_object)), last(scene.soup.first_facet(scene.last_of_object)) {}
  bool has(std::uint32_t facet) const { return first <= facet && facet < last; }
};

/// The question's point, and three in a facet's interior.
std::vector<Receiver> points_of(const AreaScene& scene, std::uint32_t facet) {
  std::vector<Receiver> points{{scene.question.point, scene.question.normal, kNone}};
  const Facet& f = scene.soup.facets()[facet];
  const auto corners = scene.soup.corners(f);
  for (std::size_t most = 0; most < 3; ++most) {
    Vec3 sum;
    double weights = 0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const double weight = k == most ? 14 : 1;
      sum = sum + weight * (corners[k].at - corners[0].at);
      weights += weight;
    }
    points.push_back({corners[0].at + (1 / weights) * sum, f.plane.normal, facet});
  }
  return points;
}

/// Items of the index, none of the object's nor of the ends', ascending.
std::vector<std::uint32_t> screens_of(const AreaScene& scene, const Object& object) {
  const PolygonSoup& soup = scene.soup;
  const auto facets = static_cast<std::uint32_t>(soup.facets().size());
  std::vector<std::uint32_t> items = items_of(soup);
  std::erase_if(items, [&](std::uint32_t item) {
    if (item < facets) return soup.facets()[item].polygon < scene.first_of_object || object.has(item);
    return std::ranges::any_of(soup.shells()[item - facets].facets, [&](std::uint32_t f) { return object.has(f); });
  });
  return items;
}

/// What the oracle allows to be said of a facet of the receiver.
Classes allowed_of_facet(const AreaScene& scene, const ShaftOracle& oracle, const Object& object,
                         const AreaScene::Ends& ends) {
  const PolygonSoup& soup = scene.soup;
  const ExactEnd a = oracle.end({ends.receiver, {}}), b = oracle.end({ends.source, {}});
  if (!oracle.face_each_other(a, b)) return bits(Shade::outside);
  const auto sides = sides_of_hull(a, b);
  Shaft::Overlap most = Shaft::Overlap::outside;
  bool is_certain = false, covers = false;
  for (std::uint32_t f = object.first; f < object.last; ++f) {
    covers = covers || (oracle.in_one_plane(f, b.facet) && oracle.covers(f, b.facet));
    const std::uint32_t s = soup.facets()[f].shell;
    const bool in_shell = s != kNone && soup.shells()[s].convex &&
                          std::ranges::all_of(soup.shells()[s].facets, [&](std::uint32_t t) { return object.has(t); });
    if (in_shell && f != soup.shells()[s].facets.front()) continue;
    const std::uint32_t index = in_shell ? static_cast<std::uint32_t>(soup.facets().size()) + s : f;
    const Shaft::Overlap one = oracle.overlap(a, b, sides, index);
    most = std::max(most, one);
    is_certain =
        is_certain || (one == Shaft::Overlap::blocking && (!in_shell || plainly_separated(a, b, oracle.item(index))));
  }
  switch (most) {
    case Shaft::Overlap::outside:
      return covers ? bits(Shade::outside, Shade::penumbra) : bits(Shade::outside);
    case Shaft::Overlap::partial:
      return bits(Shade::penumbra);
    case Shaft::Overlap::blocking:
      break;
  }
  return is_certain ? bits(Shade::umbra) : bits(Shade::umbra, Shade::penumbra);
}

/// What the point sees of one facet of the source, with the object and without it.
Classes allowed_of_point(const AreaScene& scene, const Receiver& receiver, std::uint32_t source) {
  PointQuestion with{receiver.point, receiver.normal, {}, scene.question.occluders};
  for (const Corner& c : scene.soup.corners(scene.soup.facets()[source])) with.source.outer.push_back(c.at);
  PointQuestion without = with;
  without.occluders.erase(without.occluders.begin(),
                          without.occluders.begin() + static_cast<std::ptrdiff_t>(object_size(scene.question)));
  const OracleAnswer seen = oracle_form_factor(with), free = oracle_form_factor(without);
  const bool is_exact = receiver.facet == kNone;
  const bool changes = is_exact ? seen.visible_area != free.visible_area : free.F - seen.F > kRoundingOfPoints;
  const bool sees = is_exact ? seen.visible_area > 0 : seen.F > kRoundingOfPoints;
  if (changes) return sees ? bits(Shade::penumbra) : bits(Shade::penumbra, Shade::umbra);
  return sees ? bits(Shade::outside, Shade::penumbra) : bits(Shade::outside, Shade::penumbra, Shade::umbra);
}

}  // namespace

Opinion ask_shadows(const Question& question) {
  const AreaScene scene(question);
  const Object object(scene);
  Opinion opinion;
  opinion.visibility = Visibility::open;
  if (object.first == object.last) return opinion;
  const ShadowCaster caster(scene.soup, object.first, object.last);
  ShadowVolume volume(caster);
  const std::vector<std::uint32_t> screens = screens_of(scene, object);
  for (const auto& [receiver, source] : scene.ends()) {
    volume.set_shooter({source, {}});
    const Shade of_facet = volume.of({receiver, {}});
    if (of_facet != Shade::outside) opinion.visibility = Visibility::partial;
    opinion.classes.push_back(static_cast<std::uint8_t>(of_facet));
    for (const Receiver& point : points_of(scene, receiver)) {
      opinion.classes.push_back(static_cast<std::uint8_t>(volume.at(point)));
      opinion.classes.push_back(static_cast<std::uint8_t>(volume.at(point, screens)));
    }
  }
  return opinion;
}

Truth shadow_truth(const Question& question) {
  const AreaScene scene(question);
  const Object object(scene);
  std::vector<Classes> allowed;
  bool all = true, none = true;
  if (object.first != object.last) {
    const ShaftOracle oracle(scene.soup);
    for (const AreaScene::Ends& ends : scene.ends()) {
      allowed.push_back(allowed_of_facet(scene, oracle, object, ends));
      all = all && (allowed.back() & bits(Shade::outside)) != 0;
      none = none && allowed.back() == bits(Shade::umbra);
      for (const Receiver& point : points_of(scene, ends.receiver)) {
        const Classes of_point = allowed_of_point(scene, point, ends.source);
        allowed.insert(allowed.end(), 2, of_point);
      }
    }
  }
  return {all    ? Truth::Seen::all
          : none ? Truth::Seen::none
                 : Truth::Seen::some,
          std::nullopt, [allowed](const Opinion& opinion) { return judge(opinion, allowed); }};
}

}  // namespace exitance
