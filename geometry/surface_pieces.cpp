#include "geometry/surface_pieces.h"

#include <algorithm>
#include <utility>

#include "geometry/edge_contact.h"
#include "geometry/enclosed_volume.h"
#include "geometry/shell_interior.h"

namespace exitance {
namespace {

// A piece that other pieces close, such as a sheet between walls, bounds nothing if its volume is below this share of
// area times diameter: the corners of a flat one are rounded.
constexpr double kNoVolume = 1e-12;
// A point this share of a facet's size above its middle lies in front of it, also after rounding.
constexpr double kAbove = 1e-6;

Box box_of(std::span<const PieceFacet> facets) {
  Box box;
  for (const PieceFacet& f : facets) {
    for (const Vec3& p : f.loop) box.extend(p);
  }
  return box;
}

Vec3 point_in_front(const Loop& facet) {
  Vec3 middle;
  for (const Vec3& p : facet) middle = middle + p;
  const Vec3 area = area_vector(facet);
  const double size = std::sqrt(norm(area));
  return (1 / static_cast<double>(facet.size())) * middle + kAbove * size * normalized(area);
}

class PieceFinder {
 public:
  PieceFinder(std::span<const Polygon> polygons, double near) : polygons_(polygons), near_(near) {}

  SurfacePieces find() {
    EdgeMatching matching = match_edges(polygons_, near_);
    result_.piece_of_polygon = std::move(matching.piece);
    result_.pieces.resize(matching.pieces);
    for (std::uint32_t i = 0; i < polygons_.size(); ++i) {
      result_.pieces[result_.piece_of_polygon[i]].polygons.push_back(i);
    }
    collect_facets();
    judge_edges(matching.open);
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) measure(i);
    find_enclosures();
    return std::move(result_);
  }

 private:
  std::span<const PieceFacet> facets(std::uint32_t piece) const {
    return {facets_.data() + first_facet_[piece], facets_.data() + first_facet_[piece + 1]};
  }

  void collect_facets() {
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) {
      first_facet_.push_back(facets_.size());
      for (const std::uint32_t polygon : result_.pieces[i].polygons) {
        for (Loop& loop : cut_into_facets(polygons_[polygon])) facets_.push_back({std::move(loop), polygon, i});
      }
    }
    first_facet_.push_back(facets_.size());
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) boxes_.push_back(box_of(facets(i)));
  }

  void judge_edges(const std::vector<DirectedEdge>& open) {
    for (SurfacePiece& piece : result_.pieces) piece.closed = true;
    rims_.resize(result_.pieces.size());
    const std::vector<bool> in_contact = edges_in_contact(open, facets_, result_.piece_of_polygon, near_);
    for (std::size_t i = 0; i < open.size(); ++i) {
      result_.open_edges.push_back({open[i], in_contact[i]});
      const std::uint32_t piece = result_.piece_of_polygon[open[i].polygon];
      if (!in_contact[i]) result_.pieces[piece].closed = false;
      rims_[piece].push_back(open[i]);
    }
  }

  // A closed piece's facets, and the cone that closes its rim.
  std::vector<Loop> closed_surface(std::uint32_t piece) const {
    std::vector<Loop> loops;
    for (const PieceFacet& f : facets(piece)) loops.push_back(f.loop);
    for (const DirectedEdge& e : rims_[piece]) {
      const Vec3& apex = rims_[piece].front().from;
      if (e.from != apex && e.to != apex) loops.push_back({e.to, e.from, apex});
    }
    return loops;
  }

  void measure(std::uint32_t i) {
    SurfacePiece& piece = result_.pieces[i];
    for (const PieceFacet& f : facets(i)) piece.area += norm(area_vector(f.loop));
    if (!piece.closed || piece.area == 0) return;
    // Seen from a point of the piece, not from a far origin.
    const Vec3 origin = facets(i).front().loop.front();
    EnclosedVolume volume(origin);
    for (const Loop& loop : closed_surface(i)) volume.add(loop);
    // A closed one that is no thicker than `near` has half its area times that.
    const double diameter = norm(boxes_[i].upper - boxes_[i].lower);
    const double least = piece.area * std::max(0.5 * near_, rims_[i].empty() ? 0 : kNoVolume * diameter);
    if (std::fabs(volume.value()) > least) piece.volume = volume.value();
  }

  void find_enclosures() {
    std::vector<std::uint32_t> rooms;
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) {
      if (result_.pieces[i].volume < 0) rooms.push_back(i);
    }
    // Large rooms first: they hold most of what is asked.
    std::ranges::stable_sort(rooms, {}, [&](std::uint32_t i) { return result_.pieces[i].volume; });
    std::vector<ShellInterior> interiors;
    for (const std::uint32_t i : rooms) interiors.emplace_back(closed_surface(i));
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) {
      for (std::size_t k = 0; k < rooms.size() && !result_.pieces[i].enclosed; ++k) {
        if (rooms[k] == i || !lies_mostly_in(i, interiors[k])) continue;
        result_.pieces[i].enclosed = true;
        result_.pieces[rooms[k]].encloses = true;
      }
    }
    // Solids stand free of things inside them; looked for only where no room explains what they hold.
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) {
      if (result_.pieces[i].volume > 0 && !result_.pieces[i].enclosed) find_contents(i);
    }
  }

  bool lies_mostly_in(std::uint32_t i, const ShellInterior& interior) const {
    if (!interior.box().overlaps(boxes_[i])) return false;
    double inside = 0;
    for (const PieceFacet& f : facets(i)) {
      if (interior.contains(point_in_front(f.loop))) inside += norm(area_vector(f.loop));
    }
    return inside > 0 && inside >= 0.5 * (1 - 1e-9) * result_.pieces[i].area;
  }

  void find_contents(std::uint32_t solid) {
    std::vector<std::uint32_t> candidates;
    for (std::uint32_t i = 0; i < result_.pieces.size(); ++i) {
      const bool within = boxes_[solid].contains(boxes_[i].lower) && boxes_[solid].contains(boxes_[i].upper);
      if (i != solid && within) candidates.push_back(i);
    }
    if (candidates.empty()) return;
    const ShellInterior interior(closed_surface(solid));
    result_.pieces[solid].encloses =
        std::ranges::any_of(candidates, [&](std::uint32_t i) { return lies_mostly_in(i, interior); });
  }

  std::span<const Polygon> polygons_;
  double near_;
  SurfacePieces result_;
  std::vector<PieceFacet> facets_;
  std::vector<std::size_t> first_facet_;
  std::vector<Box> boxes_;
  std::vector<std::vector<DirectedEdge>> rims_;
};

}  // namespace

SurfacePieces find_surface_pieces(std::span<const Polygon> polygons, double near) {
  return PieceFinder(polygons, near).find();
}

}  // namespace exitance
