#pragma once
// A degenerate question, of a point or of an area.

#include "geometry/polygon_soup.h"
#include "src/form_factor/point_question.h"

namespace exitance {

/// Of points: what the point sees of the source past the occluders. Of areas: how the receiver and the source stand to
/// each other; the point, about which the receiver lies, is then one of many.
struct Question : PointQuestion {
  Polygon receiver;  ///< empty where a point alone is asked about
};

/// Whether no polygon of it has a defect but zero area; the receiver may be empty.
bool has_sound_polygons(const Question& question);

/// The question with coordinates divided by a power of two that brings them near 1; the normal stays. Throws
/// std::invalid_argument when they span too many orders of magnitude (ExactScale).
Question near_one(const Question& question);

/// What a question of areas is about, with coordinates near 1.
struct AreaScene {
  explicit AreaScene(const Question& question);

  Question question;
  PolygonSoup soup;  ///< polygon 0 the receiver, 1 the source, patches; then the faces of the occluders
  /// Polygons of the object that comes and goes in questions of shadows: the first half of the occluders.
  std::uint32_t first_of_object = 2, last_of_object = 2;

  /// A facet of the receiver and one of the source.
  struct Ends {
    std::uint32_t receiver, source;
  };
  static constexpr std::size_t kMostEnds = 4;
  /// All of them; of more than kMostEnds, so many, evenly spread.
  std::vector<Ends> ends() const;
};

/// How many of the occluders are the object.
inline std::size_t object_size(const Question& question) {
  return (question.occluders.size() + 1) / 2;
}

}  // namespace exitance
