#include "src/stress/pair_oracle.h"

#include <algorithm>
#include <cmath>

#include "geometry/facets.h"
#include "src/stress/exact_polygon.h"
#include "src/stress/exchange_truth.h"
#include "src/stress/shaft_oracle.h"

namespace exitance {
namespace {

using Vector = ExactKernel::Vector_3;

constexpr double kContact = 1e-11;  ///< of the size of the pair
constexpr double kFlat = 1e-13;     ///< by how much a bent face may leave a plane to be taken for flat
constexpr std::size_t kMostEdgesSampled = 300, kMostEdges = 72, kMostPieces = 40;

Vec3 rounded(const ExactPoint& p) {
  return {CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())};
}

/// A convex planar piece of the receiver, the source or an occluder.
struct Piece {
  ExactLoop loop;
  ExactSide plane;
};

Piece piece_of(const Loop& facet) {
  ExactLoop loop = exact_loop(facet);
  const ExactSide plane = exact_plane(loop);
  return {std::move(loop), plane};
}

/// Distance from a plane, rounded.
double height(const ExactSide& side, const ExactPoint& p) {
  return CGAL::to_double(side.value(p)) / std::sqrt(CGAL::to_double(side.normal.squared_length()));
}

bool is_within(const ExactSide& side, const ExactLoop& loop, double distance) {
  return std::ranges::all_of(loop, [&](const ExactPoint& p) { return std::fabs(height(side, p)) <= distance; });
}

/// The walls over a convex loop along a normal, facing in; none where it has no area as seen along it.
std::vector<ExactSide> walls_over(const ExactLoop& loop, const Vector& normal) {
  ExactLoop turned = loop;
  ExactKernel::FT turn = 0;
  for (std::size_t k = 2; k < loop.size(); ++k)
    turn += CGAL::cross_product(loop[k - 1] - loop[0], loop[k] - loop[0]) * normal;
  if (turn == 0) return {};
  if (turn < 0) std::ranges::reverse(turned);
  std::vector<ExactSide> walls;
  for (std::size_t k = 0; k < turned.size(); ++k) {
    const ExactPoint &u = turned[k], &v = turned[(k + 1) % turned.size()];
    if (u != v) walls.push_back({u, CGAL::cross_product(normal, v - u)});
  }
  return walls;
}

/// Takes away of convex loops what lies within walls.
void subtract(std::vector<ExactLoop>& loops, const std::vector<ExactSide>& walls) {
  if (walls.empty()) return;
  std::vector<ExactLoop> rest;
  for (ExactLoop& loop : loops) {
    std::vector<ExactLoop> outside;
    ExactLoop inside = loop;
    for (const ExactSide& wall : walls) {
      ExactLoop beyond = clipped(inside, {wall.origin, -wall.normal});
      if (has_area(beyond)) outside.push_back(std::move(beyond));
      inside = clipped(inside, wall);
      if (!has_area(inside)) break;
    }
    if (!has_area(inside)) {
      rest.push_back(std::move(loop));  // nothing of it, so it need not be cut
    } else {
      rest.insert(rest.end(), outside.begin(), outside.end());
    }
  }
  loops = std::move(rest);
}

/// What hides: a convex sheet, or a convex solid by its faces.
struct Hider {
  std::vector<Piece> faces;
  bool solid = false;
};

class PairOracle {
 public:
  PairOracle(const Question& question, Care care);
  PairOracleAnswer answer();

 private:
  std::vector<Piece> pieces_of(const Polygon& polygon) const;
  bool is_convex_solid(const std::vector<Piece>& faces) const;
  bool is_deep_in(const ExactLoop& loop, const Hider& solid) const;
  std::vector<ExactLoop> uncovered(const Piece& piece, std::vector<Hider>& hiders, long double& rounding) const;
  void add_pair(const Piece& a, const Piece& b, const std::vector<Hider>& hiders);

  Care care_;
  double size_ = 0;
  std::vector<Piece> receiver_, source_;
  std::vector<Hider> hiders_;
  long double integral_ = 0, error_ = 0, standard_error_ = 0;
  long double receiver_area_ = 0, source_area_ = 0;
};

std::vector<Piece> facets_of(const Polygon& polygon) {
  std::vector<Piece> pieces;
  for (const Loop& facet : cut_into_facets(polygon)) pieces.push_back(piece_of(facet));
  return pieces;
}

/// A quadrilateral that is bent by rounding only is one piece, anything else its facets.
std::vector<Piece> PairOracle::pieces_of(const Polygon& polygon) const {
  std::vector<Piece> pieces = facets_of(polygon);
  if (pieces.size() != 2 || polygon.outer.size() != 4 || !polygon.holes.empty()) return pieces;
  const ExactLoop whole = exact_loop(polygon.outer);
  if (!is_within(pieces[0].plane, whole, kFlat * size_)) return pieces;
  const std::vector<ExactSide> walls = walls_over(whole, pieces[0].plane.normal);
  const bool is_convex = std::ranges::all_of(walls, [&](const ExactSide& wall) {
    return std::ranges::all_of(whole, [&](const ExactPoint& p) { return wall.sign(p) >= 0; });
  });
  return is_convex ? std::vector<Piece>{{whole, pieces[0].plane}} : pieces;
}

bool PairOracle::is_convex_solid(const std::vector<Piece>& faces) const {
  return std::ranges::all_of(faces, [&](const Piece& f) {
    return std::ranges::all_of(faces, [&](const Piece& g) {
      return std::ranges::all_of(g.loop,
                                 [&](const ExactPoint& p) { return height(f.plane, p) <= 0.1 * kContact * size_; });
    });
  });
}

/// Whether a convex solid holds a point of a loop that is no contact.
bool PairOracle::is_deep_in(const ExactLoop& loop, const Hider& solid) const {
  std::vector<ExactSide> inner;
  for (const Piece& f : solid.faces) {
    const double length = std::sqrt(CGAL::to_double(f.plane.normal.squared_length()));
    inner.push_back({f.plane.origin - f.plane.normal * ExactKernel::FT(kContact * size_ / length), -f.plane.normal});
  }
  return meets_open(loop, inner);
}

PairOracle::PairOracle(const Question& given, Care care) : care_(care) {
  const Question question = near_one(given);
  const auto measure = [&](const Loop& loop) {
    for (const Vec3& p : loop) size_ = std::max(size_, norm(p - question.receiver.outer[0]));
  };
  measure(question.receiver.outer);
  measure(question.source.outer);
  receiver_ = pieces_of(question.receiver);
  source_ = pieces_of(question.source);
  // What of a contact lies in front of a plane is decided facet by facet.
  bool of_receiver = false, of_source = false;
  const auto touches = [&](const std::vector<Piece>& pieces, const std::vector<Piece>& end) {
    return std::ranges::any_of(pieces, [&](const Piece& p) {
      return std::ranges::any_of(end, [&](const Piece& e) { return is_within(e.plane, p.loop, kContact * size_); });
    });
  };
  const auto add_sheets = [&](const std::vector<Piece>& pieces) {
    for (const Piece& p : pieces) hiders_.push_back({{p}, false});
  };
  for (const Obstacle& obstacle : question.occluders) {
    std::vector<Piece> faces;
    for (const Polygon& face : obstacle.faces) {
      std::vector<Piece> pieces = pieces_of(face);
      const bool at_receiver = touches(pieces, receiver_), at_source = touches(pieces, source_);
      if (at_receiver || at_source) pieces = facets_of(face);
      of_receiver = of_receiver || at_receiver;
      of_source = of_source || at_source;
      faces.insert(faces.end(), pieces.begin(), pieces.end());
    }
    Hider solid{faces, true};
    const auto holds_some = [&](const std::vector<Piece>& pieces) {
      return std::ranges::any_of(pieces, [&](const Piece& p) { return is_deep_in(p.loop, solid); });
    };
    // A solid is its surface; where lines start outside it, or end there, it hides what it meets.
    if (obstacle.solid && is_convex_solid(faces) && !(holds_some(receiver_) && holds_some(source_))) {
      hiders_.push_back(std::move(solid));
    } else if (!obstacle.solid) {
      add_sheets(faces);
    } else {
      for (const Piece& p : faces) hiders_.push_back({{p}, true});
    }
  }
  if (of_receiver) receiver_ = facets_of(question.receiver);
  if (of_source) source_ = facets_of(question.source);
}

/// What of a piece contacts leave. They are taken out of the hiders, but for whole solids that stand on the piece; so
/// is what lies behind it.
std::vector<ExactLoop> PairOracle::uncovered(const Piece& piece, std::vector<Hider>& hiders,
                                             long double& rounding) const {
  std::vector<ExactLoop> left{piece.loop};
  const double near = kContact * size_;
  std::erase_if(hiders, [&](const Hider& hider) {
    // What lies behind the piece hides what little of it rises in front, by rounding, and no more; so does a contact.
    bool hides_nothing = std::ranges::all_of(hider.faces, [&](const Piece& face) {
      return std::ranges::all_of(face.loop, [&](const ExactPoint& p) { return height(piece.plane, p) <= near; });
    });
    for (const Piece& face : hider.faces) {
      if (!is_within(piece.plane, face.loop, near)) continue;
      const bool faces_it = face.plane.normal * piece.plane.normal < 0;
      const bool is_exact = is_within(piece.plane, face.loop, 0);
      if (hider.faces.size() > 1 && faces_it) continue;  // stands on it: a body that hides all beyond
      hides_nothing = hides_nothing || hider.faces.size() == 1;
      rounding += 4 * near * size_;
      if (is_exact && hider.solid && !faces_it) continue;
      const ExactLoop cover = is_exact || (hider.solid && faces_it) ? face.loop : clipped(face.loop, piece.plane);
      if (has_area(cover)) subtract(left, walls_over(cover, piece.plane.normal));
    }
    return hides_nothing;
  });
  return left;
}

void PairOracle::add_pair(const Piece& a, const Piece& b, const std::vector<Hider>& all) {
  const auto rises_above = [](const Piece& p, const Piece& q) {
    return std::ranges::any_of(p.loop, [&](const ExactPoint& v) { return q.plane.sign(v) > 0; });
  };
  if (!rises_above(a, b) || !rises_above(b, a)) return;
  if (is_within(a.plane, b.loop, kContact * size_) || is_within(b.plane, a.loop, kContact * size_))
    throw OutOfReach("receiver and source lie in one plane but for rounding");
  std::vector<Hider> hiders = all;
  long double rounding = 0;
  const std::vector<ExactLoop> of_a = uncovered(a, hiders, rounding), of_b = uncovered(b, hiders, rounding);
  if (of_a.size() * of_b.size() > kMostPieces) throw OutOfReach("contacts cut the polygons into many pieces");
  std::vector<ConvexBody> bodies;
  std::size_t edges = 0;
  for (const Hider& hider : hiders) {
    ConvexBody body;
    for (const Piece& face : hider.faces) {
      body.emplace_back();
      for (const ExactPoint& p : face.loop) body.back().push_back(rounded(p));
      edges += hider.faces.size() > 1 ? (face.loop.size() + 1) / 2 : face.loop.size();
    }
    bodies.push_back(std::move(body));
  }
  if (edges > (care_ == Care::full ? kMostEdges : kMostEdgesSampled)) throw OutOfReach("many edges stand between");
  const auto loop_of = [](const ExactLoop& exact) {
    Loop loop;
    for (const ExactPoint& p : exact) loop.push_back(rounded(p));
    return loop;
  };
  const bool is_cut = of_a.size() != 1 || of_b.size() != 1;
  for (const ExactLoop& r : of_a) {
    for (const ExactLoop& s : of_b) {
      const Loop one = loop_of(r), other = loop_of(s);
      if (care_ == Care::full) {
        const ExchangeTruth along = exchange_truth(one, other, bodies, {1e-8L, 0}),
                            across = exchange_truth(one, other, bodies, {1e-8L, 1});
        integral_ += along.integral;
        error_ += std::max({along.error, across.error, std::fabs(along.integral - across.integral)});
      } else {
        const ExchangeTruth sampled = sampled_exchange(one, other, bodies, 1);
        integral_ += sampled.integral;
        error_ += sampled.error;
        standard_error_ += sampled.standard_error;  // all pieces have the same shifts
      }
      // Corners where contacts were cut off are rounded.
      if (is_cut) error_ += 16 * kRoundoff * (size_ + norm(one[0])) * size_;
    }
  }
  // exchange_truth takes what lies within 1e-14 of the size of a plane for lying in it.
  error_ += rounding + 4e-14L * size_ * size_;
}

PairOracleAnswer PairOracle::answer() {
  const auto area_of = [](const std::vector<Piece>& pieces) {
    long double area = 0;
    for (const Piece& p : pieces) {
      Vector sum = CGAL::NULL_VECTOR;
      for (std::size_t k = 2; k < p.loop.size(); ++k)
        sum = sum + CGAL::cross_product(p.loop[k - 1] - p.loop[0], p.loop[k] - p.loop[0]);
      area += std::sqrt(static_cast<long double>(CGAL::to_double(sum.squared_length()))) / 2;
    }
    return area;
  };
  receiver_area_ = area_of(receiver_);
  source_area_ = area_of(source_);
  if (!(receiver_area_ > 0) || !(source_area_ > 0)) return {};
  const auto is_bent = [&](const std::vector<Piece>& pieces) {
    return std::ranges::any_of(pieces,
                               [&](const Piece& p) { return !is_within(pieces[0].plane, p.loop, kContact * size_); });
  };
  std::vector<Hider> own;
  for (const std::vector<Piece>* pieces : {&receiver_, &source_}) {
    if (!is_bent(*pieces)) continue;
    for (const Piece& p : *pieces) own.push_back({{p}, false});
  }
  if (receiver_.size() * source_.size() > kMostPieces) throw OutOfReach("receiver and source are of many pieces");
  for (const Piece& a : receiver_) {
    for (const Piece& b : source_) {
      std::vector<Hider> hiders = hiders_;
      for (const Hider& h : own) {
        const ExactLoop& loop = h.faces[0].loop;
        if (loop != a.loop && loop != b.loop) hiders.push_back(h);
      }
      add_pair(a, b, hiders);
    }
  }
  const long double rounding = 16 * static_cast<long double>(kRoundoff) * integral_;
  return {integral_ / receiver_area_,         integral_ / source_area_,         (error_ + rounding) / receiver_area_,
          (error_ + rounding) / source_area_, standard_error_ / receiver_area_, standard_error_ / source_area_};
}

}  // namespace

PairOracleAnswer oracle_pair_form_factors(const Question& question, Care care) {
  return PairOracle(question, care).answer();
}

}  // namespace exitance
