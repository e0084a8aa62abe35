#include "src/visibility/sample_points.h"

#include <algorithm>
#include <boost/random/sobol.hpp>

#include "src/visibility/seed.h"

namespace exitance {
namespace {

double in_unit_interval(std::uint32_t digits) {
  return (static_cast<double>(digits) + 0.5) * 0x1p-32;
}

/// Two coordinates' digits, for each index others; the seed is white already.
std::array<std::uint32_t, 2> random_digits(std::uint64_t seed, std::uint64_t index) {
  const std::uint64_t bits = mixed(nth_seed(seed, index));
  return {static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)};
}

std::uint32_t reversed(std::uint32_t bits) {
  bits = (bits & 0x55555555u) << 1 | (bits >> 1 & 0x55555555u);
  bits = (bits & 0x33333333u) << 2 | (bits >> 2 & 0x33333333u);
  bits = (bits & 0x0f0f0f0fu) << 4 | (bits >> 4 & 0x0f0f0f0fu);
  return __builtin_bswap32(bits);
}

/// Owen's nested uniform scrambling by a hash in which every digit depends on those above it only (Laine and Karras
/// 2011, as Vegdahl improved it in 2021).
std::uint32_t owen_scrambled(std::uint32_t digits, std::uint32_t seed) {
  std::uint32_t x = reversed(digits);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reversed(x);
}

/// Element `index` of a permutation of 0 … count − 1 that belongs to the seed (Kensler 2013).
std::uint32_t permuted(std::uint32_t index, std::uint32_t count, std::uint32_t seed) {
  std::uint32_t mask = count - 1;
  for (int shift = 1; shift < 32; shift *= 2) mask |= mask >> shift;
  std::uint32_t i = index;
  do {
    i ^= seed;
    i *= 0xe170893du;
    i ^= seed >> 16;
    i ^= (i & mask) >> 4;
    i ^= seed >> 8;
    i *= 0x0929eb3fu;
    i ^= seed >> 23;
    i ^= (i & mask) >> 1;
    i *= 1 | seed >> 27;
    i *= 0x6935fa69u;
    i ^= (i & mask) >> 11;
    i *= 0x74dcb303u;
    i ^= (i & mask) >> 2;
    i *= 0x9e501cc3u;
    i ^= (i & mask) >> 2;
    i *= 0xc860a3dfu;
    i &= mask;
    i ^= i >> 5;
  } while (i >= count);
  return static_cast<std::uint32_t>((std::uint64_t{i} + seed) % count);
}

/// The first points of Sobol's sequence in Morton order, so that the rays of a packet are neighbours. Both kinds of
/// scrambling keep dyadic cubes together, and so this order good.
template <std::size_t D>
std::vector<std::array<std::uint32_t, D>> sobol_points(std::uint32_t count) {
  boost::random::sobol_engine<std::uint32_t, 32> sobol(D);
  std::vector<std::array<std::uint32_t, D>> points(1);  // Boost leaves out the origin, which makes 2^k points a net
  points.reserve(count);
  while (points.size() < count) {
    std::array<std::uint32_t, D> point;
    for (std::uint32_t& digits : point) digits = sobol();
    points.push_back(point);
  }
  const auto morton = [](const auto& point) {
    std::uint64_t key = 0;
    for (unsigned bit = 31; bit >= 16; --bit) {
      for (const std::uint32_t digits : point) key = key << 1 | (digits >> bit & 1u);
    }
    return key;
  };
  std::ranges::stable_sort(points, {}, morton);
  return points;
}

}  // namespace

std::string to_string(Sampler sampler) {
  switch (sampler) {
    case Sampler::random:
      return "random";
    case Sampler::stratified:
      return "stratified";
    case Sampler::sobol:
      return "sobol";
    case Sampler::owen:
      return "owen";
  }
  return "";
}

template <std::size_t D>
SamplePoints<D>::SamplePoints(Sampler sampler, std::uint32_t count) : sampler_(sampler), count_(count) {
  if (sampler == Sampler::sobol || sampler == Sampler::owen) sequence_ = sobol_points<D>(count);
  for (std::uint32_t c = 1; std::uint64_t{c} * c <= count; ++c) {
    if (count % c == 0) columns_ = c;
  }
}

template <std::size_t D>
void SamplePoints<D>::take(std::uint64_t seed, std::uint32_t first, std::span<Point> points) const {
  seed = mixed(seed);
  std::array<std::uint32_t, D> shift{};
  for (std::size_t d = 0; d < D; d += 2) {
    const auto digits = random_digits(seed, d / 2);
    shift[d] = digits[0];
    shift[d + 1] = digits[1];
  }
  const std::uint32_t rows = count_ / columns_;
  for (std::uint32_t k = first; Point & point : points) {
    for (std::size_t d = 0; d < D; d += 2) {
      if (sampler_ == Sampler::sobol || sampler_ == Sampler::owen) {
        const bool owen = sampler_ == Sampler::owen;
        for (const std::size_t axis : {d, d + 1}) {
          const std::uint32_t digits = sequence_[k][axis];
          point[axis] = in_unit_interval(owen ? owen_scrambled(digits, shift[axis]) : digits ^ shift[axis]);
        }
        continue;
      }
      const auto digits = random_digits(seed, 2 + std::uint64_t{k} * D / 2 + d / 2);
      point[d] = in_unit_interval(digits[0]);
      point[d + 1] = in_unit_interval(digits[1]);
      if (sampler_ == Sampler::stratified) {
        const std::uint32_t cell = d == 0 ? k : permuted(k, count_, shift[0]);
        point[d] = (cell % columns_ + point[d]) / columns_;
        point[d + 1] = (cell / columns_ + point[d + 1]) / rows;
      }
    }
    ++k;
  }
}

template class SamplePoints<2>;
template class SamplePoints<4>;

}  // namespace exitance
