// The form factor from a point to a square above it, seen through nothing.
#include <geometry/viewpoint.h>
#include <iostream>

int main() {
  using namespace exitance;
  const Polygon square{{{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}}, {}};
  const PolygonSoup soup({&square, 1});
  Viewpoint view(soup);
  view.look_from({{0, 0, 0}, {0, 0, 1}});
  std::cout << view.form_factor({0, {}}).F << '\n';  // 0.554
}
