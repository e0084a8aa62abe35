#include "src/dynamic/patch_sight.h"

#include <algorithm>

#include "src/visibility/exact_visibility.h"

namespace exitance {
namespace {

/// So few items of a whole facet are asked one by one; among more the index finds those of a patch faster.
constexpr std::size_t kFew = 24;

}  // namespace

PatchSight::PatchSight(const PatchMesh& mesh, const PolygonSoup& soup, const Contacts& contacts)
    : mesh_(mesh), soup_(soup), contacts_(contacts), view_(soup), shaft_(soup) {}

const PatchSight::FromFacet& PatchSight::from_facet(std::uint32_t facet, std::uint32_t piece) {
  const PatchPiece& to = mesh_.pieces[piece];
  FromFacet& known = facets_[piece - mesh_.patches[shooter_].piece_first];
  if (known.facet == facet && known.piece == piece) return known;
  known.facet = facet;
  known.piece = piece;
  shaft_.reset({facet, {}}, {to.facet, mesh_.loop(to)});
  known.faces = shaft_.face_each_other();
  known.blocked = shaft_.find_occluders(known.items) == Shaft::Overlap::blocking;
  return known;
}

/// Appends to items_ what stands between a piece of the receiver and one of the shooter, ascending. False when nothing
/// is seen: they face away, or one item hides all.
bool PatchSight::find_between(const PatchPiece& from, std::uint32_t piece) {
  const PatchPiece& to = mesh_.pieces[piece];
  const FromFacet* of_facet = nullptr;
  if (from.loop_count > 0) {
    of_facet = &from_facet(from.facet, piece);
    if (!of_facet->faces || of_facet->blocked) return false;
    if (of_facet->items.empty()) return true;
  }
  shaft_.reset({from.facet, mesh_.loop(from)}, {to.facet, mesh_.loop(to)});
  if (!shaft_.face_each_other()) return false;
  if (of_facet == nullptr || of_facet->items.size() > kFew) {
    const Shaft::Overlap most = shaft_.find_occluders(found_);
    items_.insert(items_.end(), found_.begin(), found_.end());
    return most != Shaft::Overlap::blocking;
  }
  bool sees = true;
  for (const std::uint32_t item : of_facet->items) {
    const Shaft::Overlap overlap = shaft_.overlap(item);
    if (overlap != Shaft::Overlap::outside) items_.push_back(item);
    sees = sees && overlap != Shaft::Overlap::blocking;
  }
  return sees;
}

void PatchSight::set(std::uint32_t receiver, std::uint32_t shooter) {
  const Patch &r = mesh_.patches[receiver], &s = mesh_.patches[shooter];
  if (shooter != shooter_) {
    shooter_ = shooter;
    facets_.assign(s.piece_count, {});
  }
  ways_.clear();
  items_.clear();
  sees_ = false;
  for (std::uint32_t k = r.piece_first; k < r.piece_first + r.piece_count; ++k) {
    for (std::uint32_t piece = s.piece_first; piece < s.piece_first + s.piece_count; ++piece) {
      const std::size_t first = items_.size();
      const bool sees = find_between(mesh_.pieces[k], piece);
      ways_.push_back({mesh_.pieces[k].facet, piece, !sees, first, items_.size()});
      sees_ = sees_ || sees;
    }
  }
}

/// Of several pieces of the receiver on one facet an element may lie in any: what stands before one of them is looked
/// at for all.
std::span<const std::uint32_t> PatchSight::items_of(std::size_t first) {
  const std::span<const std::uint32_t> own(items_.data() + ways_[first].first, ways_[first].last - ways_[first].first);
  bool one = true;
  for (std::size_t k = first + 1; k < ways_.size(); ++k) {
    const Way& way = ways_[k];
    if (way.facet != ways_[first].facet || way.piece != ways_[first].piece) continue;
    if (one) found_.assign(own.begin(), own.end());
    one = false;
    found_.insert(found_.end(), items_.begin() + static_cast<std::ptrdiff_t>(way.first),
                  items_.begin() + static_cast<std::ptrdiff_t>(way.last));
  }
  if (one) return own;
  std::ranges::sort(found_);
  found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
  return found_;
}

PointFormFactor PatchSight::form_factor(std::uint32_t element) {
  PointFormFactor sum;
  const Element& e = mesh_.elements[element];
  bool looks = false;
  for (std::uint32_t piece = mesh_.patches[shooter_].piece_first, end = piece + mesh_.patches[shooter_].piece_count;
       piece < end; ++piece) {
    const auto of_element = [&](const Way& way) { return way.facet == e.facet && way.piece == piece; };
    const auto way = std::ranges::find_if(ways_, of_element);
    if (std::ranges::none_of(ways_, [&](const Way& w) { return of_element(w) && !w.hidden; })) continue;
    if (!looks) {
      view_.look_from({e.sample, e.normal, e.facet});
      if (view_.covered() || contacts_.touched(e.facet, e.sample)) return {};
      looks = true;
    }
    const PointFormFactor f =
        view_.form_factor({mesh_.pieces[piece].facet, mesh_.loop(mesh_.pieces[piece])},
                          items_of(static_cast<std::size_t>(way - ways_.begin())), kPointTolerance);
    if (f.side != Side::front) continue;
    sum.F += f.F;
    sum.error += f.error;
  }
  return sum;
}

}  // namespace exitance
