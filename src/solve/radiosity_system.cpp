#include "src/solve/radiosity_system.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "src/solve/compensated.h"

namespace exitance {
namespace {

void require(bool condition, const char* what) {
  if (!condition) throw InvalidSystem(what);
}

void check_materials(std::uint32_t bands, std::size_t patches, std::span<const double> rho, std::span<const double> E) {
  require(bands > 0, "a radiosity system needs at least one band");
  require(rho.size() == patches * bands, "as many reflectances are needed as patches times bands");
  require(E.size() == patches * bands, "as many emissions are needed as patches times bands");
  for (std::size_t i = 0; i < rho.size(); ++i) {
    if (!(rho[i] >= 0 && rho[i] < 1)) {
      throw InvalidSystem("reflectance of patch " + std::to_string(i / bands) + " is " + std::to_string(rho[i]) +
                          "; it must lie in [0, 1)");
    }
    if (!std::isfinite(E[i])) throw InvalidSystem("emission of patch " + std::to_string(i / bands) + " is not finite");
  }
}

void check_areas(std::span<const double> areas) {
  const bool positive = std::all_of(areas.begin(), areas.end(), [](double a) { return a > 0 && std::isfinite(a); });
  require(positive, "every area must be positive and finite");
}

void check_row(const FormFactorMatrix& F, std::size_t i) {
  CompensatedSum sum, error;
  for (std::uint64_t k = F.row_first[i]; k < F.row_first[i + 1]; ++k) {
    require(F.column[k] < F.columns, "a column of the form-factor matrix is out of range");
    require(F.F[k] >= 0 && F.F[k] <= std::numeric_limits<double>::max(), "form factors must be finite and ≥ 0");
    require(F.F_error[k] >= 0, "errors of form factors must be ≥ 0");
    sum.add(F.F[k]);
    error.add(F.F_error[k]);
  }
  if (!(sum.value() <= 1 + error.value() + row_sum_rounding(F.row(i).size()))) {
    std::ostringstream what;
    what << "form factors of patch " << i << " sum to 1 + " << sum.value() - 1 << ", more than their errors ("
         << error.value() << ") explain";
    throw InvalidSystem(what.str());
  }
}

}  // namespace

std::vector<double> luminance_weights(std::uint32_t bands) {
  if (bands == 3) return {0.2126, 0.7152, 0.0722};
  return std::vector<double>(bands, 1.0);
}

void check(const Discretisation& d) {
  require(!d.element_first.empty() && d.element_first.front() == 0 && d.element_first.back() == d.elements(),
          "the elements of the patches must cover all elements");
  const auto no_element = std::adjacent_find(d.element_first.begin(), d.element_first.end(),
                                             [](std::uint32_t first, std::uint32_t next) { return first >= next; });
  require(no_element == d.element_first.end(), "every patch needs at least one element");
  check_areas(d.element_area);
  check_materials(d.bands, d.patches(), d.rho, d.E);
}

std::vector<double> patch_areas(const Discretisation& d) {
  std::vector<double> areas(d.patches());
  for (std::size_t p = 0; p < areas.size(); ++p) {
    CompensatedSum sum;
    for (std::uint32_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) sum.add(d.element_area[e]);
    areas[p] = sum.value();
  }
  return areas;
}

void check(const RadiositySystem& s) {
  check_areas(s.area);
  check_materials(s.bands, s.patches(), s.rho, s.E);
  require(s.F.rows() == s.patches() && s.F.columns == s.patches(), "the form-factor matrix must be patches × patches");
  const std::size_t entries = s.F.row_first.back();
  require(s.F.column.size() == entries && s.F.F.size() == entries && s.F.F_error.size() == entries,
          "the form-factor matrix needs a column and an error for each entry");
  for (std::size_t i = 0; i < s.patches(); ++i) check_row(s.F, i);
}

RadiositySystem make_system(const Discretisation& d, const FormFactorMatrix& element_rows) {
  check(d);
  require(element_rows.rows() == d.elements() && element_rows.columns == d.patches(),
          "the rows of the elements must be elements × patches");
  RadiositySystem system{d.bands, patch_areas(d), d.rho, d.E,
                         average_rows(element_rows, d.element_first, d.element_area)};
  check(system);
  return system;
}

std::vector<double> irradiance(const FormFactorMatrix& rows, std::span<const double> B, std::uint32_t bands) {
  std::vector<double> H(rows.rows() * bands);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.rows(), 16), [&](const auto& some) {
    for (std::size_t i = some.begin(); i < some.end(); ++i) {
      row_product(rows.row_columns(i), rows.row(i), B.data(), bands, H.data() + i * bands);
    }
  });
  return H;
}

std::vector<double> element_exitance(const Discretisation& d, std::span<const double> element_H) {
  std::vector<double> B(element_H.size());
  for (std::size_t p = 0; p < d.patches(); ++p) {
    for (std::size_t e = d.element_first[p]; e < d.element_first[p + 1]; ++e) {
      for (std::size_t b = 0; b < d.bands; ++b) {
        B[e * d.bands + b] = d.E[p * d.bands + b] + d.rho[p * d.bands + b] * element_H[e * d.bands + b];
      }
    }
  }
  return B;
}

}  // namespace exitance
