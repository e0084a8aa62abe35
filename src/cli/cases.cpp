#include "src/cli/cases.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "src/cli/case_answers.h"
#include "src/cli/console.h"
#include "src/cli/json_text.h"
#include "src/cli/number_range.h"
#include "src/cli/verbs.h"
#include "src/output/whole_file.h"
#include "src/scene/input_error.h"

namespace exitance {
namespace {

using Json = nlohmann::ordered_json;

class Cases {
 public:
  explicit Cases(CLI::App& verb) {
    verb.add_option("FILE", file_, "JSON file {\"cases\": [...]}")->required();
    verb.add_option("-o,--output", output_, "JSON file for the answers; standard output without it");
    verb.add_option("--tolerance", tolerance_, "absolute error wanted of form factors")
        ->check(positive_number())
        ->capture_default_str();
    verb.add_option("--threads", threads_, "number of threads; all without it")
        ->check(whole_number_between(1, kMostThreads));
  }

  void run() const {
    std::optional<tbb::global_control> limit;
    if (threads_ > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, threads_);
    const nlohmann::json given = read_json(file_);
    if (!given.is_object() || !given.contains("cases") || !given["cases"].is_array()) {
      throw InputError(file_, 0, "has no list \"cases\"; it must be {\"cases\": [...]}");
    }
    const nlohmann::json& cases = given["cases"];
    std::vector<Json> answers(cases.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cases.size(), 1), [&](const auto& some) {
      for (std::size_t k = some.begin(); k < some.end(); ++k) answers[k] = answer_case(cases[k], tolerance_);
    });
    write(answers);
    if (std::any_of(answers.begin(), answers.end(), [](const Json& a) { return a["status"] != "ok"; })) {
      throw CLI::RuntimeError(bad_input);
    }
  }

 private:
  /// One answer a line. Ids need not be UTF-8.
  void write(const std::vector<Json>& answers) const {
    std::string text = "{\"results\":[";
    for (std::size_t k = 0; k < answers.size(); ++k) {
      text += k == 0 ? "\n" : ",\n";
      text += answers[k].dump(-1, ' ', false, Json::error_handler_t::replace);
    }
    text += "\n]}\n";
    if (output_.empty()) {
      print_results(text);
    } else {
      write_whole_file(output_, [&](std::ostream& stream) { stream << text; });
    }
  }

  std::string file_, output_;
  double tolerance_ = 1e-12;
  std::size_t threads_ = 0;
};

}  // namespace

void add_cases(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("cases", "Answer a file of single questions");
  const auto cases = std::make_shared<Cases>(*verb);
  verb->callback([cases] { cases->run(); });
}

}  // namespace exitance
