#include "src/cli/json_text.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>
#include <string_view>
#include <vector>

#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {
namespace {

/// A number that overflows a double but not the reader's long double.
constexpr std::string_view kOverflow = "1e999";

/// Lists and objects within each other. Questions need nine; functions that call themselves for each level would
/// overflow the stack at some thousands.
constexpr std::size_t kDeepest = 100;

std::size_t line_of(const std::string& text, std::size_t position) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(position, text.size()));
  return static_cast<std::size_t>(std::count(text.begin(), end, '\n')) + 1;
}

/// The words that JSON lacks, outside of strings, as numbers that overflow. Throws InputError on what nests too deep.
std::string without_words_for_non_finite(const std::string& text, const std::string& path) {
  constexpr std::string_view words[] = {"NaN", "Infinity"};
  std::string result;
  result.reserve(text.size());
  bool in_string = false;
  std::size_t depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto word = std::find_if(std::begin(words), std::end(words), [&](std::string_view w) {
      return !in_string && text[i] == w[0] && text.compare(i, w.size(), w) == 0;
    });
    if (word != std::end(words)) {
      result += kOverflow;
      i += word->size() - 1;
      continue;
    }
    result += text[i];
    if (in_string && text[i] == '\\' && i + 1 < text.size()) {
      result += text[++i];
    } else if (text[i] == '"') {
      in_string = !in_string;
    } else if (!in_string && (text[i] == '[' || text[i] == '{')) {
      if (++depth > kDeepest) {
        throw InputError(path, line_of(text, i),
                         "has lists and objects more than " + std::to_string(kDeepest) + " deep; flatten them");
      }
    } else if (!in_string && (text[i] == ']' || text[i] == '}') && depth > 0) {
      --depth;
    }
  }
  return result;
}

/// Values with long double numbers, in which the library's reader does not stop at what overflows a double. They are
/// not used themselves: rounding twice is not rounding once.
using WideJson =
    nlohmann::basic_json<std::map, std::vector, std::string, bool, std::int64_t, std::uint64_t, long double>;

/// Builds a document from the reader's events.
class Builder {
 public:
  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(long double value, const std::string& digits) {
    double rounded = 0;
    const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), rounded);
    if (code == std::errc::result_out_of_range) {  // from_chars leaves `rounded` alone
      rounded = value > 1    ? std::numeric_limits<double>::infinity()
                : value < -1 ? -std::numeric_limits<double>::infinity()
                             : 0;
    }
    return add(rounded);
  }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(std::vector<std::uint8_t>&) { return false; }
  bool start_object(std::size_t) { return open(nlohmann::json::object()); }
  bool start_array(std::size_t) { return open(nlohmann::json::array()); }
  bool key(std::string& name) {
    key_ = std::move(name);
    return true;
  }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    error_position_ = position;
    error_ = error.what();
    return false;
  }

  nlohmann::json take() { return std::move(root_); }
  std::size_t error_position() const { return error_position_; }
  const std::string& error() const { return error_; }

 private:
  nlohmann::json* put(nlohmann::json value) {
    if (open_.empty()) {
      root_ = std::move(value);
      return &root_;
    }
    nlohmann::json& parent = *open_.back();
    if (parent.is_object()) return &(parent[key_] = std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }
  bool add(nlohmann::json value) {
    put(std::move(value));
    return true;
  }
  bool open(nlohmann::json container) {
    open_.push_back(put(std::move(container)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  nlohmann::json root_;
  std::vector<nlohmann::json*> open_;
  std::string key_, error_;
  std::size_t error_position_ = 0;
};

/// The library's message without its own name and position: "syntax error while …".
std::string reason(const std::string& what) {
  const std::size_t start = what.find("syntax error");
  return start == std::string::npos ? what : what.substr(start);
}

}  // namespace

nlohmann::json read_json(const std::string& path) {
  const std::string text = without_words_for_non_finite(read_bytes(path), path);
  Builder builder;
  if (!WideJson::sax_parse(text, &builder)) {
    throw InputError(path, line_of(text, builder.error_position()), "is not JSON: " + reason(builder.error()));
  }
  return builder.take();
}

}  // namespace exitance
