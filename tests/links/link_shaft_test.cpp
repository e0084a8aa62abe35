// What a moving object does to the shafts of links, where it stood and where it stands (Feng et al., section 5: 1, 0 or
// partial), against truths found with whole and rational numbers: no false 1 and no false 0.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "src/links/link_sight.h"
#include "tests/geometry/rational_points.h"
#include "tests/links/rooms.h"

namespace exitance {
namespace {

using State = Sight::State;

// --- The oracle: everything on a lattice, so that whole numbers decide
// -------------------------------------------------

template <class N>
struct Whole {
  N x = N(0), y = N(0), z = N(0);  // a lazy number that nothing was put in has no value

  template <class M>
  Whole<M> as() const {
    return {M(x), M(y), M(z)};
  }
  friend Whole operator-(const Whole& a, const Whole& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Whole operator+(const Whole& a, const Whole& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Whole operator*(const N& s, const Whole& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Whole&, const Whole&) = default;
};

template <class N>
N dot(const Whole<N>& a, const Whole<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class N>
Whole<N> cross(const Whole<N>& a, const Whole<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

using Big = __int128;
using Int = std::int64_t;
template <class N>
using Loop = std::vector<Whole<N>>;

template <class M, class N>
Loop<M> as(const Loop<N>& loop) {
  Loop<M> result;
  for (const Whole<N>& v : loop) result.push_back(v.template as<M>());
  return result;
}

/// A convex polygon with the normal towards its front.
struct Face {
  Loop<Int> loop;
  Whole<Int> normal;

  explicit Face(Loop<Int> of) : loop(std::move(of)), normal(cross(loop[1] - loop[0], loop[2] - loop[0])) {}
  Int height(const Whole<Int>& p) const { return dot(normal, p - loop[0]); }
};

/// Of lattice points in doubles.
constexpr double kUnit = 64;
Loop<Int> on_lattice(std::span<const Vec3> corners) {
  Loop<Int> loop;
  for (const Vec3& v : corners) {
    std::array<Int, 3> whole{};
    for (int axis = 0; axis < 3; ++axis) {
      whole[static_cast<std::size_t>(axis)] = std::llround(kUnit * v[axis]);
      if (static_cast<double>(whole[static_cast<std::size_t>(axis)]) != kUnit * v[axis])
        throw std::logic_error("a corner is none of the lattice's");
    }
    loop.push_back({whole[0], whole[1], whole[2]});
  }
  return loop;
}

/// A convex piece of an object: a solid by its faces, or one polygon.
struct ConvexPiece {
  std::vector<Face> faces;
  bool solid() const { return faces.size() > 1; }
};

enum class Meeting : std::uint8_t { apart, touching, inside };

/// Of the inside of a hull that is not flat and a polygon. Two convex bodies are apart or touch where, in one of these
/// directions, none reaches farther than the other begins: across a face of the one, across the other, or across an
/// edge of each. Here across all planes through three and all lines through two of the hull's points.
template <class N>
Meeting meeting(const Loop<N>& hull, const Loop<N>& polygon) {
  Meeting found = Meeting::inside;
  const auto reach = [](const Loop<N>& points, const Whole<N>& n) {
    std::pair<N, N> ends{dot(n, points[0]), dot(n, points[0])};
    for (const Whole<N>& p : points) {
      const N at = dot(n, p);
      if (at < ends.first) ends.first = at;
      if (at > ends.second) ends.second = at;
    }
    return ends;
  };
  const auto separates = [&](const Whole<N>& n) {
    if (n == Whole<N>{}) return false;
    const auto [hull_low, hull_high] = reach(hull, n);
    const auto [low, high] = reach(polygon, n);
    if (low > hull_high || hull_low > high) found = Meeting::apart;
    if (found == Meeting::inside && (low == hull_high || hull_low == high)) found = Meeting::touching;
    return found == Meeting::apart;
  };
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    if (separates(cross(polygon[k - 1] - polygon[0], polygon[k] - polygon[0]))) return found;
  }
  for (std::size_t i = 0; i < hull.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Whole<N> edge = hull[j] - hull[i];
      for (std::size_t k = 0; k < j; ++k) {
        if (separates(cross(edge, hull[k] - hull[i]))) return found;
      }
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        if (separates(cross(edge, polygon[(k + 1) % polygon.size()] - polygon[k]))) return found;
      }
    }
  }
  return found;
}

Loop<Q> clip(const Loop<Q>& loop, const Whole<Q>& normal, const Whole<Q>& origin) {
  Loop<Q> kept;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Whole<Q>&p = loop[i], &q = loop[(i + 1) % loop.size()];
    const Q at_p = dot(normal, p - origin), at_q = dot(normal, q - origin);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p > 0 && at_q < 0) || (at_p < 0 && at_q > 0)) kept.push_back(p + Q(at_p / (at_p - at_q)) * (q - p));
  }
  return kept;
}

/// What a line from one point to another, scaled by `scale` on the lattice, does with a face: meets it with an end or
/// in between.
enum class Crossing : std::uint8_t { misses, in_plane, at_end, between };
Crossing crossing(const Face& face, const Whole<Big>& from, const Whole<Big>& to, Big scale) {
  const Whole<Big> n = face.normal.as<Big>(), origin = scale * face.loop[0].as<Big>();
  const Big at_from = dot(n, from - origin), at_to = dot(n, to - origin);
  if (at_from == 0 && at_to == 0) return Crossing::in_plane;
  if ((at_from > 0 && at_to > 0) || (at_from < 0 && at_to < 0)) return Crossing::misses;
  const Big weight = at_from - at_to;  // the point where it meets the plane, times this
  const Whole<Big> point = at_from * to - at_to * from;
  for (std::size_t k = 0; k < face.loop.size(); ++k) {
    const Whole<Big> u = scale * face.loop[k].as<Big>(), v = scale * face.loop[(k + 1) % face.loop.size()].as<Big>();
    if (dot(cross(v - u, point - weight * u), n) * (weight > 0 ? 1 : -1) < 0) return Crossing::misses;
  }
  return at_from == 0 || at_to == 0 ? Crossing::at_end : Crossing::between;
}

bool meets_solid(const ConvexPiece& solid, const Whole<Int>& from, const Whole<Int>& to) {
  Big first = 0, of_first = 1, last = 1, of_last = 1;  // fractions of the way
  for (const Face& face : solid.faces) {
    const Big at_from = face.height(from), at_to = face.height(to);
    if (at_from > 0 && at_to > 0) return false;
    if (at_from <= 0 && at_to <= 0) continue;
    if (at_from > 0 && at_from * of_first > first * (at_from - at_to)) {
      first = at_from;
      of_first = at_from - at_to;
    }
    if (at_to > 0 && -at_from * of_last < last * (at_to - at_from)) {
      last = -at_from;
      of_last = at_to - at_from;
    }
  }
  return first * of_last <= last * of_first;
}

/// An end of a shaft, and when its object stands in the scene: what is later lies on top in one plane.
struct End {
  Face face;
  std::uint32_t object = 0;
};

/// What an object does to a shaft.
struct Truth {
  Meeting meeting = Meeting::apart;  ///< of its faces with the shaft's inside
  bool in_plane = false;             ///< it has a face in the plane of an end,
  bool covers = false;               ///< which covers some of it
  bool blocks = false;               ///< a piece of it, all lines
  bool misses = false;               ///< no piece meets the lines between all corners
  bool decidable = true;             ///< whether Shaft promises to find that a piece blocks
  bool enters() const { return meeting == Meeting::inside || covers; }
};

class Oracle {
 public:
  Oracle(const End& a, const End& b) : ends_{a, b} {
    for (const End* end : {&a, &b}) hull_.insert(hull_.end(), end->face.loop.begin(), end->face.loop.end());
    for (std::size_t e = 0; e < 2; ++e) {
      bool some = false;
      for (const Whole<Int>& p : ends_[1 - e].face.loop) {
        crosses_ = crosses_ || ends_[e].face.height(p) < 0;
        some = some || ends_[e].face.height(p) > 0;
      }
      facing_ = facing_ && some;
    }
  }

  bool face_each_other() const { return facing_; }
  /// Whether one end crosses the other's plane: only what lies above that is looked at.
  bool crosses() const { return crosses_; }

  Truth of(const std::vector<ConvexPiece>& object, std::uint32_t number) const {
    Truth truth;
    truth.misses = true;
    for (const ConvexPiece& piece : object) {
      Meeting meets = Meeting::apart;
      bool holds = false, lies_against = false;
      for (const Face& face : piece.faces) {
        bool in_plane = false;
        for (std::size_t e = 0; e < 2; ++e) {
          if (!lies_in(face, ends_[e].face)) continue;
          in_plane = truth.in_plane = true;
          const bool same_way = dot(face.normal, ends_[e].face.normal) > 0;
          if (same_way ? number < ends_[e].object : !piece.solid()) continue;
          if (!overlaps(face, e)) continue;
          truth.covers = true;
          lies_against = lies_against || !same_way;
          holds = holds || holds_all(face, e);
        }
        if (!in_plane) meets = std::max(meets, meeting_of(face));
      }
      truth.meeting = std::max(truth.meeting, meets);
      const bool meets_all = meets_all_lines(piece);
      truth.misses = truth.misses && !meets_all && !holds;
      // A line that a solid meets ends in the face by which it lies against an end, or goes through another one.
      if (holds || (meets_all && (meets == Meeting::inside || lies_against) && !around_both(piece))) {
        truth.blocks = true;
        truth.decidable = truth.decidable &&
                          (holds || (meets == Meeting::inside && !crosses_ && (!piece.solid() || separated(piece))));
      }
    }
    return truth;
  }

  /// Lines between interior points, drawn at random: how many there were, and how many meet a face in between.
  struct Lines {
    int seen = 0, met = 0;
  };
  Lines look(const std::vector<ConvexPiece>& object, int count, std::mt19937_64& random) const {
    constexpr Big kScale = 64;
    const auto point_in = [&](const Loop<Int>& loop) {
      Whole<Big> sum;
      Big left = kScale;
      for (std::size_t k = 0; k + 1 < loop.size(); ++k) {
        const auto most = static_cast<std::uint64_t>(left) - (loop.size() - 1 - k);  // one each for the others
        const Big weight = Big(1 + random() % most);
        sum = sum + weight * loop[k].as<Big>();
        left -= weight;
      }
      return sum + left * loop.back().as<Big>();
    };
    Lines lines;
    for (int k = 0; k < count; ++k) {
      const Whole<Big> p = point_in(ends_[0].face.loop), q = point_in(ends_[1].face.loop);
      const auto above = [&](const Face& face, const Whole<Big>& point) {
        return dot(face.normal.as<Big>(), point - kScale * face.loop[0].as<Big>()) > 0;
      };
      if (!above(ends_[0].face, q) || !above(ends_[1].face, p)) continue;
      ++lines.seen;
      lines.met += std::ranges::any_of(object, [&](const ConvexPiece& piece) {
        return std::ranges::any_of(piece.faces, [&](const Face& face) {
          const bool at_end = lies_in(face, ends_[0].face) || lies_in(face, ends_[1].face);
          return !at_end && crossing(face, p, q, kScale) == Crossing::between;
        });
      });
    }
    return lines;
  }

 private:
  static bool lies_in(const Face& face, const Face& plane) {
    return std::ranges::all_of(face.loop, [&](const Whole<Int>& p) { return plane.height(p) == 0; });
  }

  /// The parts of both ends above each other's planes alone count.
  Loop<Q> above_ends(const Loop<Int>& loop) const {
    Loop<Q> left = as<Q>(loop);
    for (const End& end : ends_) left = clip(left, end.face.normal.as<Q>(), end.face.loop[0].as<Q>());
    return left;
  }

  Meeting meeting_of(const Face& face) const {
    const Meeting whole = meeting(hull_, face.loop);
    if (whole != Meeting::inside || !crosses_) return whole;
    const Loop<Q> left = above_ends(face.loop);
    if (left.empty()) return Meeting::apart;
    Whole<Q> middle;
    for (const Whole<Q>& p : left) middle = middle + p;
    for (const End& end : ends_) {
      const Q count(static_cast<int>(left.size()));
      if (dot(end.face.normal.as<Q>(), middle - count * end.face.loop[0].as<Q>()) <= 0) return Meeting::touching;
    }
    return meeting(as<Q>(hull_), left);
  }

  bool overlaps(const Face& face, std::size_t e) const {
    Loop<Q> left = as<Q>(ends_[e].face.loop);
    const Face& other = ends_[1 - e].face;
    left = clip(left, other.normal.as<Q>(), other.loop[0].as<Q>());
    for (std::size_t k = 0; k < face.loop.size(); ++k) {
      const Whole<Int>& u = face.loop[k];
      left = clip(left, cross(face.normal, face.loop[(k + 1) % face.loop.size()] - u).as<Q>(), u.as<Q>());
    }
    for (std::size_t k = 2; k < left.size(); ++k) {
      if (!(cross(left[k - 1] - left[0], left[k] - left[0]) == Whole<Q>{})) return true;
    }
    return false;
  }

  bool holds_all(const Face& face, std::size_t e) const {
    for (std::size_t k = 0; k < face.loop.size(); ++k) {
      const Whole<Int>& u = face.loop[k];
      const Whole<Int> inner = cross(face.normal, face.loop[(k + 1) % face.loop.size()] - u);
      for (const Whole<Int>& p : ends_[e].face.loop) {
        if (dot(inner, p - u) < 0) return false;
      }
    }
    return true;
  }

  bool meets_all_lines(const ConvexPiece& piece) const {
    for (const Whole<Int>& p : ends_[0].face.loop) {
      for (const Whole<Int>& q : ends_[1].face.loop) {
        if (piece.solid() ? !meets_solid(piece, p, q)
                          : crossing(piece.faces[0], p.as<Big>(), q.as<Big>(), 1) == Crossing::misses) {
          return false;
        }
      }
    }
    return true;
  }

  /// Whether points of both ends lie inside a solid: then a line may stay in it.
  bool around_both(const ConvexPiece& piece) const {
    if (!piece.solid()) return false;
    Loop<Int> corners;
    for (const Face& face : piece.faces) corners.insert(corners.end(), face.loop.begin(), face.loop.end());
    std::ranges::sort(corners, {}, [](const Whole<Int>& p) { return std::array{p.x, p.y, p.z}; });
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    return std::ranges::all_of(ends_,
                               [&](const End& end) { return meeting(corners, end.face.loop) == Meeting::inside; });
  }

  /// Whether a plane of a face, or of an end, lies between the solid and an end.
  bool separated(const ConvexPiece& piece) const {
    const auto in_front = [](const Loop<Int>& loop, const Face& of) {
      return std::ranges::all_of(loop, [&](const Whole<Int>& p) { return of.height(p) >= 0; });
    };
    return std::ranges::any_of(ends_, [&](const End& end) {
      return std::ranges::all_of(piece.faces, [&](const Face& f) { return in_front(f.loop, end.face); }) ||
             std::ranges::any_of(piece.faces, [&](const Face& f) { return in_front(end.face.loop, f); });
    });
  }

  std::array<End, 2> ends_;
  Loop<Int> hull_;
  bool facing_ = true, crosses_ = false;
};

// --- Scenes
// ------------------------------------------------------------------------------------------------------------

using Faces = std::vector<std::vector<Vec3>>;

int whole(std::mt19937_64& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<std::uint64_t>(high - low + 1));
}

/// Along u, v, w, which turn to the right.
Faces parallelepiped(const Vec3& p, const Vec3& u, const Vec3& v, const Vec3& w) {
  Faces faces;
  for (const auto& [o, s, t] :
       {std::tuple{p, v, u}, {p, w, v}, {p, u, w}, {p + w, u, v}, {p + u, v, w}, {p + v, w, u}}) {
    faces.push_back({o, o + s, o + s + t, o + t});
  }
  return faces;
}

/// One convex thing in a room of 8 × 8 × 8: a box, one that is turned or oblique, a tetrahedron, or a flat polygon.
Faces random_thing(std::mt19937_64& random) {
  const auto some = [&](int low, int high) { return static_cast<double>(whole(random, low, high)); };
  const Vec3 p{some(0, 6), some(0, 6), random() % 3 == 0 ? 0 : some(0, 6)};
  const auto vector = [&] { return Vec3{some(-2, 2), some(-2, 2), some(-2, 2)}; };
  const int kind = whole(random, 0, 9);
  if (kind < 4) return parallelepiped(p, {some(1, 4), 0, 0}, {0, some(1, 4), 0}, {0, 0, some(1, 4)});
  if (kind < 5) return parallelepiped(p, {1, 2, 2}, {2, -2, 1}, {2, 1, -2});
  const bool along_axes = random() % 2 == 0;
  const Vec3 u = along_axes ? Vec3{some(1, 8), 0, 0} : vector();
  Vec3 v = along_axes ? Vec3{0, some(1, 8), some(-1, 1)} : vector(), w = vector();
  if (kind < 7) {
    if (cross(u, v) == Vec3{}) return {};
    if (random() % 2 == 0) return {{p, p + v, p + u + v, p + u}};
    return random() % 2 == 0 ? Faces{{p, p + u, p + v}} : Faces{{p, p + u, p + u + v, p + v}};
  }
  const double volume = dot(cross(u, v), w);
  if (volume == 0) return {};
  if (volume < 0) std::swap(v, w);
  if (kind < 9) return parallelepiped(p, u, v, w);
  return {{p, p + v, p + u}, {p, p + w, p + v}, {p, p + u, p + w}, {p + u, p + v, p + w}};
}

std::vector<Surface> surfaces_of(const Faces& faces) {
  std::vector<Surface> surfaces;
  for (const auto& loop : faces) {
    Surface s;
    s.polygon.outer = loop;
    surfaces.push_back(s);
  }
  return surfaces;
}

/// Where the lattice is put.
struct Pose {
  Placement placement;
  bool exact = true;  ///< every dyadic corner remains what it is
};

Pose random_pose(std::mt19937_64& random) {
  Pose pose;
  switch (random() % 4) {
    case 0:
      break;
    case 1: {  // turned, and seven times as large
      const std::array<Vec3, 3> axes{Vec3{2, 3, 6}, {-6, -2, 3}, {3, -6, 2}};
      for (std::size_t column = 0; column < 3; ++column) {
        for (int row = 0; row < 3; ++row)
          pose.placement.linear[static_cast<std::size_t>(row)][static_cast<int>(column)] = axes[column][row];
      }
      pose.placement.translation = {1'000'003, -77, 12};
      break;
    }
    case 2:  // far away
      pose.placement.translation = {0x1p30, 0, -0x1p29};
      break;
    default:
      pose.placement = {rotation({uniform(random, -1, 1), uniform(random, -1, 1), 1}, uniform(random, 0, 360)),
                        {uniform(random, -1, 1), 0.1, 0.7}};
      pose.exact = false;
  }
  return pose;
}

struct Tally {
  int scene = 0;
  int pairs = 0, wrong = 0, open = 0, partial = 0, blocked = 0, undecided = 0, touching = 0, rounded = 0, loose = 0,
      lines = 0;
};

/// A room with things and one that moves, put somewhere; its links' shafts with the object where it was and is.
class MovedThing {
 public:
  explicit MovedThing(std::mt19937_64& random) : pose_(random_pose(random)), straight_(empty()) {
    // Rounding bends quadrilaterals.
    const bool by_triangles = !pose_.exact || random() % 4 == 0;
    const std::size_t things = 2 + random() % 3;
    mover_ = 1 + static_cast<std::uint32_t>(random() % things);
    const Faces floor{{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}}}, around = random() % 4 == 0 ? floor : room();
    add(straight_, "room", surfaces_of(by_triangles ? triangles_of(around) : around));
    for (std::size_t k = 1; k <= things; ++k) {
      Faces faces;
      while (faces.empty()) faces = random_thing(random);
      if (by_triangles) faces = triangles_of(faces);
      if (k == mover_) {
        add_pieces(faces);
        if (random() % 4 == 0) {
          // Not to touch the first one: what several pieces close together is another question.
          Faces more = faces;
          for (std::vector<Vec3>& face : more) {
            for (Vec3& v : face) v = v + Vec3{-16, 0, 0};
          }
          add_pieces(more);
          faces.insert(faces.end(), more.begin(), more.end());
        }
      }
      add(straight_, "thing", surfaces_of(faces));
    }
    const auto step = [&] { return static_cast<double>(whole(random, -3, 3)); };
    move_ = {step(), step(), random() % 2 == 0 ? 0 : step()};
  }

  void check(std::mt19937_64& random, int links, Tally& tally) {
    Scene placed = straight_;
    place(placed, pose_.placement);
    EditedScene scene(placed);
    const EditedScene lattice(straight_);
    const PolygonSoup lattice_soup = make_soup(straight_);
    const PatchTree truths(lattice, lattice_soup, {{}, kSmallest});
    const Obstacles before(scene);
    const double size = std::cbrt(std::fabs(volume_of(pose_.placement)));
    PatchTree tree(scene, before.soup(), {{}, kSmallest * size * size});
    if (tree.nodes().size() != truths.nodes().size()) throw std::logic_error("trees of one scene differ");
    Edit edit;
    edit.object = mover_;
    Placement turn = pose_.placement, moved;
    turn.translation = {};
    moved.translation = turn(move_);
    edit.placement = moved;
    scene.apply(edit);
    const Obstacles now(before, scene, mover_);
    tree.change_geometry(scene, now.soup(), now.polygons(), mover_);

    LinkSight then(tree, before, 2), since(tree, now, 2);
    const std::vector<std::uint32_t> items_then = before.items_of(mover_), items_now = now.items_of(mover_);
    const auto object_then = pieces_at({}), object_now = pieces_at(move_);
    for (int k = 0; k < links; ++k) {
      const auto root = [&] { return truths.root(static_cast<std::uint32_t>(random() % truths.roots().size())); };
      const Root a = root(), b = root();
      if (a.object == mover_ || b.object == mover_) continue;
      std::uint32_t p = a.node_first, q = b.node_first;
      if (p == q || !Oracle(end(truths, p), end(truths, q)).face_each_other()) continue;
      Sight sight_then = then.between_roots(p, q, items_then), sight_now = since.between_roots(p, q, items_now);
      for (int level = 0;; ++level) {
        const Oracle oracle(end(truths, p), end(truths, q));
        if (!oracle.crosses() || random() % 8 == 0) {
          judge(oracle, object_then, sight_then.state, items_then.size() == pieces_.size(), random, tally);
          judge(oracle, object_now, sight_now.state, items_now.size() == pieces_.size(), random, tally);
        }
        const Node &to = truths.node(p), &from = truths.node(q);
        const bool down = to.has_children() && (random() % 2 == 0 || !from.has_children());
        if (level == 5 || (!down && !from.has_children())) break;
        (down ? p : q) = (down ? to : from).first_child + static_cast<std::uint32_t>(random() % 4);
        if (!Oracle(end(truths, p), end(truths, q)).face_each_other()) break;
        sight_then = then.between(p, q, sight_then);
        sight_now = since.between(p, q, sight_now);
      }
    }
  }

 private:
  static constexpr double kSmallest = 0.09;

  static Scene empty() {
    Scene scene;
    scene.bands = 1;
    scene.materials = {grey(0.5, 0)};
    return scene;
  }
  static Faces room() {
    Faces faces = parallelepiped({}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8});
    for (std::vector<Vec3>& loop : faces) std::ranges::reverse(loop);
    return faces;
  }
  static Faces triangles_of(const Faces& faces) {
    Faces triangles;
    for (const auto& face : faces) {
      for (std::size_t k = 2; k < face.size(); ++k) triangles.push_back({face[0], face[k - 1], face[k]});
    }
    return triangles;
  }
  static double volume_of(const Placement& placement) {
    const Vec3 o = placement({}), x = placement({1, 0, 0}) - o, y = placement({0, 1, 0}) - o,
               z = placement({0, 0, 1}) - o;
    return dot(cross(x, y), z);
  }

  static End end(const PatchTree& tree, std::uint32_t n) {
    return {Face(on_lattice(tree.node(n).loop())), tree.object_of(n)};
  }

  /// A solid is one, of a flat polygon each face.
  void add_pieces(const Faces& faces) {
    if (faces.size() > 2) {
      pieces_.push_back(faces);
    } else {
      for (const auto& face : faces) pieces_.push_back({face});
    }
  }

  std::vector<ConvexPiece> pieces_at(const Vec3& offset) const {
    std::vector<ConvexPiece> pieces;
    for (const Faces& faces : pieces_) {
      ConvexPiece piece;
      for (std::vector<Vec3> loop : faces) {
        for (Vec3& v : loop) v = v + offset;
        piece.faces.emplace_back(on_lattice(loop));
      }
      pieces.push_back(piece);
    }
    return pieces;
  }

  /// by_pieces: whether each piece is one item; where a solid shares an edge with others its faces are, and block one
  /// by one only.
  void judge(const Oracle& oracle, const std::vector<ConvexPiece>& object, State state, bool by_pieces,
             std::mt19937_64& random, Tally& tally) const {
    const Truth truth = oracle.of(object, mover_);
    ++tally.pairs;
    ++(state == State::open ? tally.open : state == State::blocked ? tally.blocked : tally.partial);
    tally.touching += truth.meeting == Meeting::touching || truth.in_plane;
    tally.rounded += !pose_.exact;
    std::string wrong;
    if (pose_.exact) {
      if (state == State::open && truth.enters()) wrong = "a false 1";
      if (state != State::open && !truth.enters()) wrong = "what does not enter is said to";
      if (state == State::blocked && !truth.blocks) wrong = "a false 0";
      if (state == State::partial && truth.blocks) {
        ++tally.undecided;
        if (truth.decidable && by_pieces) wrong = "what blocks is called partial";
      }
    } else if (!truth.in_plane) {  // what touches may be anything once it is rounded
      if (state == State::open && truth.meeting == Meeting::inside) wrong = "a false 1, turned";
      // Of two pieces that share a corner, rounded on each by itself, a shaft may lack a side: that costs time only.
      tally.loose += state != State::open && truth.meeting == Meeting::apart;
      if (state == State::blocked && truth.misses) wrong = "a false 0, turned";
    }
    if (!truth.in_plane && state != State::partial && (pose_.exact || truth.meeting != Meeting::touching)) {
      const Oracle::Lines lines = oracle.look(object, 2, random);
      tally.lines += lines.seen;
      if (lines.met != (state == State::open ? 0 : lines.seen)) wrong = "a line tells otherwise";
    }
    if (wrong.empty()) return;
    if (++tally.wrong <= 10)
      ADD_FAILURE() << wrong << ", scene " << tally.scene << (by_pieces ? "" : ", by faces")
                    << (oracle.crosses() ? ", crossing" : "");
  }

  Pose pose_;
  Scene straight_;
  std::uint32_t mover_ = 0;
  std::vector<Faces> pieces_;
  Vec3 move_;
};

int number_of(const char* name, int otherwise) {
  const char* given = std::getenv(name);
  return given != nullptr ? std::atoi(given) : otherwise;
}

// EXITANCE_PAIRS says how many shafts and objects, EXITANCE_FIRST from which scene on.
TEST(LinkShaft, NeverWronglyOpenOrBlockedByWhatMoves) {
  const int pairs = number_of("EXITANCE_PAIRS", 20'000);
  Tally tally;
  for (tally.scene = number_of("EXITANCE_FIRST", 1); tally.pairs < pairs && tally.wrong < 100; ++tally.scene) {
    std::mt19937_64 random(static_cast<std::uint64_t>(tally.scene));
    MovedThing(random).check(random, 40, tally);
  }
  EXPECT_EQ(tally.wrong, 0);
  for (const int some : {tally.open, tally.partial, tally.blocked, tally.touching, tally.rounded, tally.lines})
    EXPECT_GT(some, pairs / 100);
  EXPECT_LT(tally.undecided, tally.blocked / 20);
  EXPECT_LE(tally.loose, tally.rounded / 10'000);
  fmt::print(
      "{} pairs, {} wrong: {} open, {} partial, {} blocked; {} blocked ones are called partial; {} touch; {} are "
      "turned by "
      "any angle, {} of them called partial though nothing enters; {} lines\n",
      tally.pairs, tally.wrong, tally.open, tally.partial, tally.blocked, tally.undecided, tally.touching,
      tally.rounded, tally.loose, tally.lines);
}

}  // namespace
}  // namespace exitance
