#include "tests/fuzz/mutation.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string_view>

namespace exitance {
namespace {

constexpr std::array<std::string_view, 24> kWords{"nan",
                                                  "inf",
                                                  "-inf",
                                                  "1e999",
                                                  "-1e999",
                                                  "1e-999",
                                                  "1e308",
                                                  "-0",
                                                  "0",
                                                  "-1",
                                                  "2147483647",
                                                  "4294967295",
                                                  "18446744073709551616",
                                                  "-2147483649",
                                                  "1e50",
                                                  "1e-50",
                                                  "0x10",
                                                  "1,5",
                                                  "\"",
                                                  "[",
                                                  "}",
                                                  "\xff\xfe",
                                                  "1/2/3",
                                                  "1e5"};
constexpr std::array<std::uint64_t, 8> kNumbers{0,          1,          0x7fffffff,         0x80000000,
                                                0xffffffff, 0x7ff00000, 0x7fffffffffffffff, 0xffffffffffffffff};

class Mutation {
 public:
  Mutation(const std::vector<std::string>& seeds, Random& random) : seeds_(seeds), random_(random) {}

  std::string run() {
    bytes_ = seed();
    for (int changes = random_.whole(1, 6); changes > 0; --changes) change();
    return bytes_;
  }

 private:
  const std::string& seed() const {
    return seeds_[static_cast<std::size_t>(random_.whole(0, static_cast<int>(seeds_.size()) - 1))];
  }
  std::size_t place(std::size_t size) const {
    return static_cast<std::size_t>(random_.whole(0, static_cast<int>(size)));
  }
  std::size_t length() const { return place(random_.whole(0, 3) == 0 ? 256 : 8); }

  void change() {
    if (bytes_.empty()) bytes_ = seed();
    const std::size_t at = place(bytes_.size() - 1);
    switch (random_.whole(0, 9)) {
      case 0:
        bytes_[at] = static_cast<char>(bytes_[at] ^ (1 << random_.whole(0, 7)));
        break;
      case 1:
        bytes_[at] = static_cast<char>(random_.whole(0, 255));
        break;
      case 2:
        bytes_.erase(at, length());
        break;
      case 3:
        bytes_.insert(place(bytes_.size()), bytes_.substr(at, length()));
        break;
      case 4:
        if (random_.whole(0, 3) == 0) bytes_.resize(at);
        break;
      case 5: {
        const std::string& other = seed();
        bytes_.replace(at, length(), other.substr(place(other.size()), length()));
        break;
      }
      case 6:
        put_number(at);
        break;
      case 7:
        exchange_lines();
        break;
      default:
        put_word(at);
    }
  }

  /// In place of the word that stands there.
  void put_word(std::size_t at) {
    const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-'; };
    std::size_t first = at, last = at;
    while (first > 0 && is_word(bytes_[first - 1])) --first;
    while (last < bytes_.size() && is_word(bytes_[last])) ++last;
    bytes_.replace(first, last - first, kWords[place(kWords.size() - 1)]);
  }

  void put_number(std::size_t at) {
    const std::uint64_t number = kNumbers[place(kNumbers.size() - 1)];
    const std::size_t size = random_.whole(0, 1) == 0 ? 4 : 8;
    for (std::size_t k = 0; k < size && at + k < bytes_.size(); ++k)
      bytes_[at + k] = static_cast<char>(number >> (8 * k) & 0xff);
  }

  void exchange_lines() {
    std::vector<std::string> lines(1);
    for (const char c : bytes_) {
      lines.back() += c;
      if (c == '\n') lines.emplace_back();
    }
    std::swap(lines[place(lines.size() - 1)], lines[place(lines.size() - 1)]);
    bytes_.clear();
    for (const std::string& line : lines) bytes_ += line;
  }

  const std::vector<std::string>& seeds_;
  Random& random_;
  std::string bytes_;
};

}  // namespace

std::string mutated(const std::vector<std::string>& seeds, Random& random) {
  return Mutation(seeds, random).run();
}

}  // namespace exitance
