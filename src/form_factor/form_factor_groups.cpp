#include "src/form_factor/form_factor_groups.h"

#include <limits>
#include <map>
#include <stdexcept>

#include "src/scene/scene.h"

namespace exitance {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

struct Sum {
  double F = 0, F_error = 0;
  std::uint32_t terms = 0;
};

}  // namespace

FormFactorGroups make_groups(std::span<const std::uint32_t> named) {
  FormFactorGroups groups;
  std::map<std::uint32_t, std::uint32_t> known;
  for (const std::uint32_t name : named) {
    if (name == kNoGroup) {
      groups.group_of.push_back(groups.count++);
      continue;
    }
    const auto [found, is_new] = known.try_emplace(name, groups.count);
    if (is_new) ++groups.count;
    groups.group_of.push_back(found->second);
  }
  return groups;
}

FormFactorMatrix combine(const FormFactorMatrix& matrix, std::span<const double> area, const FormFactorGroups& groups) {
  const std::size_t patches = matrix.rows();
  if (matrix.columns != patches || area.size() != patches || groups.group_of.size() != patches)
    throw std::invalid_argument("combine: the matrix, its areas and its groups do not match");

  std::vector<std::vector<std::uint32_t>> members(groups.count);
  for (std::uint32_t patch = 0; patch < patches; ++patch) members[groups.group_of[patch]].push_back(patch);

  FormFactorMatrix result;
  result.columns = groups.count;
  for (const std::vector<std::uint32_t>& rows : members) {
    double all = 0;
    for (const std::uint32_t g : rows) all += area[g];
    std::map<std::uint32_t, Sum> sums;
    for (const std::uint32_t g : rows) {
      const double weight = area[g] / all;
      for (std::size_t k = 0; k < matrix.row(g).size(); ++k) {
        Sum& sum = sums[groups.group_of[matrix.row_columns(g)[k]]];
        sum.F += weight * matrix.row(g)[k];
        sum.F_error += weight * matrix.row_error(g)[k];
        ++sum.terms;
      }
    }
    for (const auto& [column, sum] : sums) {
      // k terms are summed; each has the roundings of the area's sum, a quotient and a product. One alone has none.
      const bool is_alone = rows.size() == 1 && sum.terms == 1;
      const double rounding = is_alone ? 0 : (sum.terms + static_cast<double>(rows.size()) + 2) * kUnitRoundoff;
      result.column.push_back(column);
      result.F.push_back(sum.F);
      result.F_error.push_back(sum.F_error * (1 + rounding) + rounding * sum.F);
    }
    result.row_first.push_back(result.column.size());
  }
  return result;
}

}  // namespace exitance
