#include "src/form_factor/form_factor_bound.h"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <cmath>

namespace exitance {

FormFactorBound::FormFactorBound(const PolygonSoup& soup, const Source& receiver, const Source& source)
    : plane_{normalized(soup.facets()[source.facet].plane.normal), soup.facets()[source.facet].plane.origin},
      loop_(corners_of(soup, source)) {
  const Plane& of_receiver = soup.facets()[receiver.facet].plane;
  const CutPlane below{normalized(of_receiver.normal), of_receiver.origin};
  for (const Vec3& v : loop_) highest_ = std::max(highest_, below.at(v));
  for (const AreaCell& cell : cells_of(loop_)) area_ += cell.area();
}

/// Of a point from the source.
double FormFactorBound::distance_from(const Vec3& x) const {
  double nearest = INFINITY;
  bool inside = true;
  for (std::size_t k = 0; k < loop_.size(); ++k) {
    const Vec3 &a = loop_[k], along = loop_[(k + 1) % loop_.size()] - a, to_x = x - a;
    const double share = std::clamp(dot(to_x, along) / dot(along, along), 0.0, 1.0);
    nearest = std::min(nearest, norm(to_x - share * along));
    inside = inside && dot(cross(plane_.normal, along), to_x) >= 0;
  }
  return inside ? std::fabs(plane_.at(x)) : nearest;
}

double FormFactorBound::from(const AreaCell& cell) const {
  Vec3 middle;
  const double share = 1.0 / cell.corners;
  for (const Vec3& v : cell.loop()) middle = middle + share * v;
  double radius = 0, height = 0;
  const auto include = [&](const Vec3& v) {
    radius = std::max(radius, norm(v - middle));
    height = std::max(height, plane_.at(v));
  };
  for (const Vec3& v : cell.loop()) include(v);
  // A conic lies within its ends and where their tangents meet.
  for (const Bend& bend : {cell.bend, cell.opposite}) {
    if (bend.weight != 0) include(bend.control);
  }
  const double distance = distance_from(middle) - radius;
  if (!(distance > 0)) return 1;
  const double cosines = std::min(1.0, height / distance) * std::min(1.0, highest_ / distance);
  return std::min(1.0, 1.01 * cosines * area_ / (boost::math::constants::pi<double>() * distance * distance));
}

}  // namespace exitance
