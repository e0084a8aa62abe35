#include "src/scene/toml_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "src/scene/input_error.h"
#include "src/scene/text_cursor.h"

namespace exitance {

namespace {

/// toml++ limits how deep values nest, but not how many parts a dotted key has: each is a table in the one before,
/// and those are freed by recursion, which overflows the stack.
void refuse_long_keys(const std::string& file, std::string_view text) {
  constexpr int kMostParts = 32;
  std::size_t line = 1;
  int parts = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '#') i = std::min(text.find('\n', i), text.size() - 1);
    const char c = text[i];
    if (c == '"' || c == '\'') {  // a part in quotes, or a text
      const std::size_t end = text.find_first_of(std::string{c, '\n'}, i + 1);
      if (end == std::string_view::npos) return;
      i = text[end] == '\n' ? end - 1 : end;
    } else if (c == '.') {
      if (++parts >= kMostParts)
        throw InputError(file, line, fmt::format("a key has more than {} parts; shorten it", kMostParts));
    } else if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '-' && c != ' ' && c != '\t') {
      parts = 0;
      line += c == '\n';
    }
  }
}

}  // namespace

std::uint32_t line_of(const toml::node& node) {
  return node.source().begin.line;
}

TomlTable::TomlTable(const toml::table& table, std::string file, std::string name)
    : table_(table), file_(std::move(file)), name_(std::move(name)) {}

const toml::node* TomlTable::find(std::string_view key) {
  known_.emplace(key);
  return table_.get(key);
}

std::optional<std::string> TomlTable::string(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (!node->is_string()) fail(exitance::line_of(*node), fmt::format("\"{}\" must be a text in quotes", key));
  return node->value<std::string>();
}

std::optional<double> TomlTable::number(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !std::isfinite(*value))
    fail(exitance::line_of(*node), fmt::format("\"{}\" must be a finite number", key));
  return value;
}

std::optional<std::int64_t> TomlTable::integer(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (!node->is_integer()) fail(exitance::line_of(*node), fmt::format("\"{}\" must be a whole number", key));
  return node->value<std::int64_t>();
}

bool TomlTable::flag(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return false;
  if (!node->is_boolean()) fail(exitance::line_of(*node), fmt::format("\"{}\" must be true or false", key));
  return node->value<bool>().value_or(false);
}

std::optional<Vec3> TomlTable::vector(std::string_view key) {
  const toml::node* node = find(key);
  return node ? std::optional(to_vector(*node)) : std::nullopt;
}

Vec3 TomlTable::to_vector(const toml::node& node) const {
  const toml::array* list = node.as_array();
  if (!list || list->size() != 3) fail(exitance::line_of(node), "three numbers [x, y, z] are needed here");
  Vec3 v;
  for (int axis = 0; axis < 3; ++axis) {
    const toml::node& item = (*list)[static_cast<std::size_t>(axis)];
    const auto value = item.is_number() ? item.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value))
      fail(exitance::line_of(item), "a coordinate is not a finite number; correct it");
    v[axis] = *value;
  }
  return v;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (node->is_number()) return std::vector<double>{*node->value<double>()};
  const toml::array* list = node->as_array();
  if (!list || list->empty())
    fail(exitance::line_of(*node), fmt::format("\"{}\" must be a number or a list of numbers", key));
  std::vector<double> values;
  for (const toml::node& item : *list) {
    if (!item.is_number())
      fail(exitance::line_of(item), fmt::format("\"{}\" must be a number or a list of numbers", key));
    values.push_back(*item.value<double>());
  }
  return values;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* node = find(key);
  if (!node) return std::nullopt;
  if (!node->is_table()) fail(exitance::line_of(*node), fmt::format("\"{}\" must be a table", key));
  return TomlTable(*node->as_table(), file_, std::string(key));
}

const toml::array* TomlTable::array(std::string_view key) {
  const toml::node* node = find(key);
  if (node && !node->is_array()) fail(exitance::line_of(*node), fmt::format("\"{}\" must be a list", key));
  return node ? node->as_array() : nullptr;
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) {
  const toml::array* list = array(key);
  if (!list) return {};
  std::vector<TomlTable> all;
  for (const toml::node& item : *list) {
    if (!item.is_table()) fail(exitance::line_of(item), fmt::format("\"{}\" must be tables: [[{}]]", key, key));
    all.emplace_back(*item.as_table(), file_, std::string(key));
  }
  return all;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> all;
  for (const auto& [key, node] : table_) all.emplace_back(key.str());
  return all;
}

void TomlTable::refuse_unknown_keys() const {
  for (const auto& [key, node] : table_) {
    if (known_.contains(key.str())) continue;
    fail(key.source().begin.line,
         fmt::format("\"{}\" is not known in {}; known are: {}", key.str(), name_, fmt::join(known_, ", ")));
  }
}

std::uint32_t TomlTable::line() const {
  return exitance::line_of(table_);
}

std::uint32_t TomlTable::line_of(std::string_view key) const {
  return exitance::line_of(*table_.get(key));
}

void TomlTable::fail(std::uint32_t line, const std::string& what) const {
  throw InputError(file_, line, what);
}

toml::table parse_toml(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  refuse_long_keys(path.string(), bytes);
  try {
    return toml::parse(bytes, path.string());
  } catch (const toml::parse_error& error) {
    throw InputError(path.string(), error.source().begin.line, fmt::format("is not TOML: {}", error.description()));
  }
}

}  // namespace exitance
