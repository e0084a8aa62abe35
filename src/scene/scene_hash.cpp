#include "src/scene/scene_hash.h"

#include <boost/uuid/name_generator_sha1.hpp>
#include <boost/uuid/uuid_io.hpp>
#include <type_traits>

namespace exitance {
namespace {

class Contents {
 public:
  template <class T>
  void add(const T& value) requires std::is_arithmetic_v<T> {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const std::vector<double>& values) {
    add(values.size());
    for (const double value : values) add(value);
  }
  void add(const std::vector<Vec3>& loop) {
    add(loop.size());
    for (const Vec3& p : loop) {
      add(p.x);
      add(p.y);
      add(p.z);
    }
  }
  void add(const std::string& text) {
    add(text.size());
    bytes_ += text;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace

std::string scene_hash(const Scene& scene) {
  Contents contents;
  contents.add(scene.bands);
  contents.add(scene.unit);
  for (const Surface& surface : scene.surfaces) {
    contents.add(surface.obstruction_only);
    contents.add(scene.materials[surface.material].rho);
    contents.add(scene.materials[surface.material].E);
    contents.add(surface.polygon.outer);
    contents.add(surface.polygon.holes.size());
    for (const auto& hole : surface.polygon.holes) contents.add(hole);
  }
  const boost::uuids::name_generator_sha1 name(boost::uuids::ns::oid());
  return to_string(name(contents.bytes().data(), contents.bytes().size()));
}

}  // namespace exitance
