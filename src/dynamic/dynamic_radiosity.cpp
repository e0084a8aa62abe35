#include "src/dynamic/dynamic_radiosity.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/dynamic/importance.h"

namespace exitance {
namespace {

/// Columns of older versions are given up.
constexpr std::size_t kVersionsOfColumns = 8;

}  // namespace

DynamicRadiosity::DynamicRadiosity(std::shared_ptr<const SceneVersion> version, const Scene& scene,
                                   std::uint64_t column_memory)
    : bands_(scene.bands), weights_(luminance_weights(scene.bands)), columns_(column_memory) {
  layers_.push_back({std::move(version), {}, {}, {}});
  fit_arrays();
  for (std::uint32_t object = 0; object < this->version().objects(); ++object) set_materials(scene, object);
}

/// Numbers never shrink; what is new is 0.
void DynamicRadiosity::fit_arrays() {
  const std::size_t patches = version().patches() * bands_;
  H_.resize(version().elements() * bands_);
  rho_.resize(patches);
  E_.resize(patches);
  B_.resize(patches);
  unshot_.resize(patches);
  for (Layer& layer : layers_) layer.shot.resize(patches);
}

void DynamicRadiosity::set_materials(const Scene& scene, std::uint32_t object) {
  const ObjectSlot& slot = version().slot(object);
  for (std::uint32_t p = slot.patch_first; p < slot.patch_first + slot.patch_count; ++p) {
    for (std::uint32_t b = 0; b < bands_; ++b) {
      const std::size_t i = std::size_t{p} * bands_ + b;
      E_[i] = rho_[i] = 0;
      if (!slot.present) continue;
      const Material& material = scene.materials[scene.surfaces[version().mesh().patches[p].surface].material];
      E_[i] = material.E[b];
      rho_[i] = material.rho[b];
    }
    refresh(p);
  }
}

/// By shots and by gathering.
double DynamicRadiosity::received(std::uint32_t element, std::uint32_t band) const {
  CompensatedSum sum = H_[std::size_t{element} * bands_ + band];
  for (const Gathering& gathering : gatherings_) {
    const std::uint32_t first = version().slot(gathering.object).element_first;
    const std::size_t at = std::size_t{element - first} * bands_ + band;
    if (element < first || at >= gathering.G.size()) continue;
    sum.add(gathering.G[at].high());
    sum.add(gathering.G[at].low());
  }
  return sum.value();
}

/// B and ΔB of a patch from what its elements have received.
void DynamicRadiosity::refresh(std::uint32_t p) {
  const bool present = version().object_of_patch(p) != SceneVersion::kVoid;
  const Patch& patch = version().mesh().patches[p];
  for (std::uint32_t b = 0; b < bands_; ++b) {
    const std::size_t i = std::size_t{p} * bands_ + b;
    if (!present) {
      B_[i] = unshot_[i] = 0;
      continue;
    }
    CompensatedSum power;
    double area = 0;
    for (std::uint32_t e = patch.element_first; e < patch.element_first + patch.element_count; ++e) {
      const double a = version().mesh().elements[e].area;
      power.add_product(a, received(e, b));
      area += a;
    }
    B_[i] = E_[i] + rho_[i] * (power.value() / area);
    double left = B_[i];
    const std::uint32_t object = version().object_of_patch(p);
    for (const Layer& layer : layers_) {
      if (!version().same_in(*layer.version, object)) continue;
      left = (left - layer.shot[i].high()) - layer.shot[i].low();
    }
    unshot_[i] = left;
  }
}

void DynamicRadiosity::receive(std::uint32_t element, double F, const double* amount) {
  for (std::uint32_t b = 0; b < bands_; ++b) H_[std::size_t{element} * bands_ + b].add_product(F, amount[b]);
}

/// Ascending.
void DynamicRadiosity::refresh_patches_of(const std::vector<std::uint32_t>& elements) {
  std::vector<std::uint32_t> patches;
  for (const std::uint32_t e : elements) {
    const std::uint32_t p = version().mesh().elements[e].patch;
    if (patches.empty() || patches.back() != p) patches.push_back(p);
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, patches.size(), 64), [&](const auto& some) {
    for (std::size_t k = some.begin(); k < some.end(); ++k) refresh(patches[k]);
  });
}

double DynamicRadiosity::luminance_of(const double* values) const {
  double sum = 0;
  for (std::uint32_t b = 0; b < bands_; ++b) sum += weights_[b] * std::fabs(values[b]);
  return sum;
}

bool DynamicRadiosity::is_zero(const Layer& layer, std::uint32_t patch) const {
  for (std::uint32_t b = 0; b < bands_; ++b) {
    const CompensatedSum& s = layer.shot[std::size_t{patch} * bands_ + b];
    if (s.high() != 0 || s.low() != 0) return false;
  }
  return true;
}

void DynamicRadiosity::drop_empty_layers() {
  const auto is_empty = [&](const Layer& layer) {
    if (&layer == &layers_.back()) return false;
    return std::ranges::all_of(layer.shot, [](const CompensatedSum& s) { return s.high() == 0 && s.low() == 0; });
  };
  std::erase_if(layers_, is_empty);
}

/// What was gathered and not shot is forgotten, and who gathers.
void DynamicRadiosity::drop_gathered() {
  for (const Gathering& gathering : std::exchange(gatherings_, {})) {
    const std::uint32_t first = version().slot(gathering.object).patch_first;
    for (std::uint32_t p = first; p < first + gathering.patches; ++p) refresh(p);
  }
}

/// Rows of the present version, of the object that was changed last, as far as they are known.
const ObjectRows& DynamicRadiosity::present_rows() const {
  static const ObjectRows none;
  return !gatherings_.empty() && is_present(gatherings_.back()) ? gatherings_.back().rows : none;
}

void DynamicRadiosity::change_geometry(std::shared_ptr<const SceneVersion> next, const Scene& scene,
                                       std::uint32_t object, const std::string& name) {
  std::erase_if(gatherings_, [&](const Gathering& g) { return g.object == object || g.patches == 0; });
  // What the object received where it was is gone with it.
  const ObjectSlot was = version().slot(object);
  std::fill_n(H_.begin() + static_cast<std::ptrdiff_t>(std::size_t{was.element_first} * bands_),
              std::size_t{was.element_count} * bands_, CompensatedSum{});
  layers_.back().name = name;
  layers_.push_back({std::move(next), {}, {}, {}});
  fit_arrays();
  drop_empty_layers();
  for (Layer& layer : layers_) layer.importance.reset();
  differences_.clear();
  columns_.keep_versions(kVersionsOfColumns);
  for (std::uint32_t p = was.patch_first; p < was.patch_first + was.patch_count; ++p) {
    for (std::uint32_t b = 0; b < bands_; ++b) E_[std::size_t{p} * bands_ + b] = rho_[std::size_t{p} * bands_ + b] = 0;
    refresh(p);
  }
  set_materials(scene, object);
  const ObjectSlot& is = version().slot(object);
  if (is.present)
    gatherings_.push_back({object, shared_version(), ObjectRows(is.element_first, is.element_count), 0, {}});
}

void DynamicRadiosity::forget_changes() {
  has_forgotten_ = has_forgotten_ || pending_changes() > 0;
  for (Gathering& gathering : gatherings_) {
    CompensatedSum* H = H_.data() + std::size_t{version().slot(gathering.object).element_first} * bands_;
    for (const CompensatedSum& G : std::exchange(gathering.G, {})) (H++)->add(G);
  }
  for (std::size_t k = 0; k + 1 < layers_.size(); ++k) {
    for (std::uint32_t p = 0; p < version().patches(); ++p) {
      const std::uint32_t object = version().object_of_patch(p);
      if (object == SceneVersion::kVoid || !version().same_in(*layers_[k].version, object)) continue;
      for (std::size_t i = std::size_t{p} * bands_; i < (std::size_t{p} + 1) * bands_; ++i) {
        layers_.back().shot[i].add(layers_[k].shot[i].high());
        layers_.back().shot[i].add(layers_[k].shot[i].low());
      }
    }
  }
  layers_.erase(layers_.begin(), layers_.end() - 1);
  drop_gathered();
}

void DynamicRadiosity::change_materials(const Scene& scene, std::uint32_t object) {
  set_materials(scene, object);
}

void DynamicRadiosity::start_over() {
  columns_.clear();
  differences_.clear();
  has_forgotten_ = false;
  drop_gathered();
  layers_.erase(layers_.begin(), layers_.end() - 1);
  layers_.back().shot = {};
  fit_arrays();
  std::ranges::fill(H_, CompensatedSum{});
  for (std::uint32_t p = 0; p < version().patches(); ++p) refresh(p);
}

/// What has changed between an older version and the present one.
const VersionDifference& DynamicRadiosity::since(const std::shared_ptr<const SceneVersion>& version) {
  for (const auto& difference : differences_) {
    if (&difference->before() == version.get()) return *difference;
  }
  differences_.push_back(std::make_shared<const VersionDifference>(version, shared_version()));
  return *differences_.back();
}

std::shared_ptr<const FormFactorColumn> DynamicRadiosity::present_column(std::uint32_t patch, ChangeWork& work) {
  std::shared_ptr<const FormFactorColumn> column = columns_.find(patch);
  if (column && column->version == shared_version()) return column;
  if (column && since(column->version).keeps(patch)) {
    const VersionDifference& difference = since(column->version);
    const auto changes =
        difference.column(patch, VersionDifference::Search::shadow_volumes, column.get(), present_rows(), work);
    column = std::make_shared<const FormFactorColumn>(changed_column(*column, difference, changes));
  } else {
    column = std::make_shared<const FormFactorColumn>(make_column(shared_version(), patch, work.visibility_tests));
  }
  columns_.put(patch, column);
  return column;
}

DynamicShot DynamicRadiosity::propagate(std::uint32_t patch) {
  DynamicShot shot{DynamicShot::Kind::propagation, patch, 0, {}};
  const std::vector<double> amount(unshot_.begin() + static_cast<std::ptrdiff_t>(std::size_t{patch} * bands_),
                                   unshot_.begin() + static_cast<std::ptrdiff_t>((std::size_t{patch} + 1) * bands_));
  const auto column = present_column(patch, shot.work);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, column->element.size(), 1024), [&](const auto& some) {
    for (std::size_t k = some.begin(); k < some.end(); ++k) receive(column->element[k], column->F[k], amount.data());
  });
  for (std::size_t k = 0; k < column->element.size(); ++k) {
    const Element& e = version().mesh().elements[column->element[k]];
    const std::size_t p = std::size_t{e.patch} * bands_;
    for (std::uint32_t b = 0; b < bands_; ++b)
      shot.power += weights_[b] * e.area * rho_[p + b] * column->F[k] * std::fabs(amount[b]);
  }
  for (std::uint32_t b = 0; b < bands_; ++b) layers_.back().shot[std::size_t{patch} * bands_ + b].add(amount[b]);
  refresh_patches_of(column->element);
  refresh(patch);
  return shot;
}

DynamicShot DynamicRadiosity::redistribute(std::size_t change, std::uint32_t patch, VersionDifference::Search search) {
  DynamicShot shot{DynamicShot::Kind::redistribution, patch, 0, {}};
  Layer& layer = layers_[change];
  const VersionDifference& difference = since(layer.version);
  auto known = columns_.find(patch);
  if (known && known->version != layer.version) known.reset();
  const std::vector<FormFactorChange> changes =
      difference.column(patch, search, known.get(), present_rows(), shot.work);
  if (known && difference.keeps(patch))
    columns_.put(patch, std::make_shared<const FormFactorColumn>(changed_column(*known, difference, changes)));
  std::vector<std::uint32_t> touched;
  take_from_gathered(layer, patch, touched);
  std::vector<double> high(bands_), low(bands_);
  for (std::uint32_t b = 0; b < bands_; ++b) {
    CompensatedSum& past = layer.shot[std::size_t{patch} * bands_ + b];
    high[b] = past.high();
    low[b] = past.low();
    past = {};
  }
  for (const FormFactorChange& c : changes) {
    // Both by themselves: H takes back to the last digit what it was given.
    for (const double* amount : {high.data(), low.data()}) {
      receive(c.element, -c.before, amount);
      receive(c.element, c.after, amount);
    }
    if (present_rows().has(c.element)) continue;  // G loses the same
    touched.push_back(c.element);
    const std::size_t p = std::size_t{version().mesh().elements[c.element].patch} * bands_;
    for (std::uint32_t b = 0; b < bands_; ++b)
      shot.power += weights_[b] * version().mesh().elements[c.element].area * rho_[p + b] *
                    std::fabs((c.after - c.before) * high[b]);
  }
  if (difference.keeps(patch)) {
    for (std::uint32_t b = 0; b < bands_; ++b) {
      CompensatedSum& now = layers_.back().shot[std::size_t{patch} * bands_ + b];
      now.add(high[b]);
      now.add(low[b]);
    }
  }
  std::ranges::sort(touched);
  refresh_patches_of(touched);
  refresh(patch);
  drop_empty_layers();
  if (pending_changes() == 0) drop_gathered();
  return shot;
}

std::uint32_t DynamicRadiosity::patches_to_gather() const {
  if (pending_changes() == 0 || gatherings_.empty() || !is_present(gatherings_.back())) return 0;
  return version().slot(gatherings_.back().object).patch_count - gatherings_.back().patches;
}

DynamicShot DynamicRadiosity::gather() {
  Gathering& gathering = gatherings_.back();
  const ObjectSlot& slot = version().slot(gathering.object);
  gathering.G.resize(std::size_t{slot.element_count} * bands_);
  DynamicShot shot{DynamicShot::Kind::gathering, slot.patch_first + gathering.patches++, 0, {}};
  const Patch& patch = version().mesh().patches[shot.patch];
  std::vector<const VersionDifference*> since_layer;
  for (std::size_t k = 0; k + 1 < layers_.size(); ++k) since_layer.push_back(&since(layers_[k].version));
  std::vector<PointRow> rows(patch.element_count);
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, patch.element_count, 1), [&](const auto& some) {
    for (std::uint32_t k = some.begin(); k < some.end(); ++k) {
      rows[k] = version().row(patch.element_first + k);
      CompensatedSum* G = &gathering.G[std::size_t{patch.element_first + k - slot.element_first} * bands_];
      for (std::size_t layer = 0; layer < since_layer.size(); ++layer) {
        for (std::size_t i = 0; i < rows[k].column.size(); ++i) {
          const std::uint32_t from = rows[k].column[i];
          if (!has_to_redistribute(layer, from) || !since_layer[layer]->keeps(from)) continue;
          for (std::uint32_t b = 0; b < bands_; ++b) {
            const CompensatedSum& past = std::as_const(layers_[layer].shot)[std::size_t{from} * bands_ + b];
            for (const double amount : {past.high(), past.low()}) G[b].add_product(rows[k].F[i], amount);
          }
        }
      }
    }
  });
  for (std::uint32_t k = 0; k < patch.element_count; ++k) {
    const std::uint32_t e = patch.element_first + k;
    shot.work.visibility_tests += rows[k].column.size();
    for (std::uint32_t b = 0; b < bands_; ++b) {
      shot.power += weights_[b] * version().mesh().elements[e].area * rho_[std::size_t{shot.patch} * bands_ + b] *
                    std::fabs(gathering.G[std::size_t{e - slot.element_first} * bands_ + b].value());
    }
    gathering.rows.put(e, std::move(rows[k]));
  }
  refresh(shot.patch);
  return shot;
}

/// What a patch shot in an older version is about to be redistributed: it counts as gathered no longer. Appends to
/// `touched` the elements for which it did by form factors of another version than the present one: of these, what the
/// redistribution shot brings need not be the same.
void DynamicRadiosity::take_from_gathered(const Layer& layer, std::uint32_t patch,
                                          std::vector<std::uint32_t>& touched) {
  const std::uint32_t object = layer.version->object_of_patch(patch);
  for (Gathering& gathering : gatherings_) {
    const SceneVersion& then = *gathering.version;
    if (layer.version->serial() >= then.serial() || !then.same_in(*layer.version, object)) continue;
    const ObjectSlot& slot = version().slot(gathering.object);
    for (std::uint32_t e = slot.element_first; e < slot.element_first + slot.element_count; ++e) {
      const double F = gathering.rows.has(e) ? gathering.rows.F(e, patch) : 0;
      if (F == 0) continue;
      for (std::uint32_t b = 0; b < bands_; ++b) {
        const CompensatedSum& past = layer.shot[std::size_t{patch} * bands_ + b];
        CompensatedSum& G = gathering.G[std::size_t{e - slot.element_first} * bands_ + b];
        for (const double amount : {past.high(), past.low()}) G.add_product(-F, amount);
      }
      if (!is_present(gathering)) touched.push_back(e);
    }
  }
}

void DynamicRadiosity::set_importance(const ImportanceOptions& options) {
  importance_ = options;
  for (Layer& layer : layers_) layer.importance.reset();
}

double DynamicRadiosity::redistribution_energy(std::size_t change, std::uint32_t patch) {
  Layer& layer = layers_[change];
  rank(layer);
  double sum = 0;
  for (std::uint32_t b = 0; b < bands_; ++b)
    sum += weights_[b] * std::fabs(std::as_const(layer.shot)[std::size_t{patch} * bands_ + b].value());
  return sum * (*layer.importance)[patch];
}

bool DynamicRadiosity::has_shot(std::uint32_t patch) const {
  return !is_zero(layers_.back(), patch);
}

bool DynamicRadiosity::has_to_redistribute(std::size_t change, std::uint32_t patch) const {
  return !is_zero(layers_[change], patch);
}

PendingChange DynamicRadiosity::pending(std::size_t change) {
  PendingChange result{layers_[change].name, 0, 0, 0};
  for (std::uint32_t p = 0; p < version().patches(); ++p) {
    if (!has_to_redistribute(change, p)) continue;
    const double energy = redistribution_energy(change, p);
    if (++result.patches == 1 || energy > result.largest_energy) {
      result.largest_energy = energy;
      result.patch = p;
    }
  }
  return result;
}

DynamicRadiosity::Strongest DynamicRadiosity::strongest() const {
  Strongest found;
  for (std::uint32_t p = 0; p < version().patches(); ++p) {
    const double energy = version().mesh().patches[p].area * luminance_of(unshot_.data() + std::size_t{p} * bands_);
    if (energy > found.energy) found = {p, energy};
  }
  return found;
}

DynamicRadiosity::Strongest DynamicRadiosity::strongest_of(std::uint32_t object) const {
  Strongest found;
  const ObjectSlot& slot = version().slot(object);
  for (std::uint32_t p = slot.patch_first; slot.present && p < slot.patch_first + slot.patch_count; ++p) {
    if (luminance_of(E_.data() + std::size_t{p} * bands_) == 0) continue;
    const double energy = version().mesh().patches[p].area * luminance_of(unshot_.data() + std::size_t{p} * bands_);
    if (energy > found.energy) found = {p, energy};
  }
  return found;
}

std::vector<double> DynamicRadiosity::importance_of(const Layer& layer, const VersionDifference& difference) const {
  switch (importance_.kind) {
    case ImportanceOptions::Kind::exact:
      return exact_importance(difference, present_rows());
    case ImportanceOptions::Kind::estimated: {
      std::vector<std::uint32_t> have_shot;
      for (std::uint32_t p = 0; p < difference.before().patches(); ++p) {
        if (!is_zero(layer, p)) have_shot.push_back(p);
      }
      return estimated_importance(difference, importance_.points, have_shot);
    }
    case ImportanceOptions::Kind::total:
      break;
  }
  std::vector<double> areas;
  for (const Patch& patch : version().mesh().patches) areas.push_back(patch.area);
  return areas;
}

void DynamicRadiosity::rank(Layer& layer) {
  if (layer.importance) return;
  layer.importance = std::make_shared<const std::vector<double>>(importance_of(layer, since(layer.version)));
}

DynamicRadiosity::StrongestChange DynamicRadiosity::strongest_change() {
  StrongestChange found;
  for (std::size_t k = 0; k + 1 < layers_.size(); ++k) {
    for (std::uint32_t p = 0; p < version().patches(); ++p) {
      if (!has_to_redistribute(k, p)) continue;
      const double energy = redistribution_energy(k, p);
      if (version().object_of_patch(p) != SceneVersion::kVoid &&
          version().same_in(*layers_[k].version, version().object_of_patch(p)))
        found.of_all += energy;
      if (energy <= found.energy) continue;
      found.change = k;
      found.patch = p;
      found.energy = energy;
    }
  }
  return found;
}

double DynamicRadiosity::error_bound() const {
  std::vector<double> largest_rho(bands_), left(bands_), largest_B(bands_);
  for (std::size_t i = 0; i < B_.size(); ++i) {
    const std::size_t b = i % bands_;
    largest_rho[b] = std::max(largest_rho[b], rho_[i]);
    left[b] = std::max(left[b], std::fabs(unshot_[i]));
    largest_B[b] = std::max(largest_B[b], std::fabs(B_[i]));
  }
  double bound = 0;
  for (std::uint32_t b = 0; b < bands_; ++b) {
    if (left[b] > 0) bound = std::max(bound, left[b] / (1 - largest_rho[b]) / largest_B[b]);
  }
  return bound;
}

std::vector<double> DynamicRadiosity::element_B() const {
  std::vector<double> B(H_.size());
  for (std::uint32_t e = 0; e < version().elements(); ++e) {
    if (!version().has_element(e)) continue;
    const std::size_t p = std::size_t{version().mesh().elements[e].patch} * bands_;
    for (std::uint32_t b = 0; b < bands_; ++b)
      B[std::size_t{e} * bands_ + b] = E_[p + b] + rho_[p + b] * received(e, b);
  }
  return B;
}

double DynamicRadiosity::power_of_sources() const {
  double power = 0;
  for (std::uint32_t p = 0; p < version().patches(); ++p)
    power += version().mesh().patches[p].area * luminance_of(E_.data() + std::size_t{p} * bands_);
  return power;
}

Discretisation DynamicRadiosity::discretisation() const {
  Discretisation d;
  d.bands = bands_;
  d.rho = rho_;
  d.E = E_;
  for (const Patch& patch : version().mesh().patches)
    d.element_first.push_back(patch.element_first + patch.element_count);
  for (const Element& element : version().mesh().elements) d.element_area.push_back(element.area);
  return d;
}

}  // namespace exitance
