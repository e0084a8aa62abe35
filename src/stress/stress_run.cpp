#include "src/stress/stress_run.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <tuple>

#include "src/stress/shrinking.h"

namespace exitance {
namespace {

using Clock = std::chrono::steady_clock;

const char* const kAnswer = "answer";

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A question and all that is drawn for it come from its name.
struct Named {
  std::string name;
  std::size_t family = 0, departure = 0;
};

/// What an exception says; nothing where none is thrown.
template <class Work>
std::optional<std::string> exception_of(const Work& work) {
  try {
    work();
    return std::nullopt;
  } catch (const std::exception& thrown) {
    return thrown.what();
  }
}

std::string list_of_families() {
  std::string names;
  for (const QuestionFamily& family : question_families()) names += (names.empty() ? "" : ", ") + family.name;
  return names;
}

std::uint64_t& seen_by(const Truth& truth, StressTally& tally) {
  switch (truth.seen) {
    case Truth::Seen::none:
      return tally.none;
    case Truth::Seen::all:
      return tally.all;
    case Truth::Seen::some:
      break;
  }
  return tally.some;
}

class StressRun {
 public:
  explicit StressRun(const StressOptions& options)
      : options_(options), properties_(options.kind->properties()), names_(property_names(*options.kind)) {
    for (const QuestionFamily& family : question_families()) {
      if (options.families.empty() || std::ranges::find(options.families, family.name) != options.families.end())
        families_.push_back(&family);
    }
    for (const std::string& name : options.families) {
      if (std::ranges::find(families_, name, [](const QuestionFamily* f) { return f->name; }) == families_.end())
        throw std::invalid_argument(name + ": there is no such family of questions; there are " + list_of_families());
    }
    StressTally empty;
    empty.properties.resize(names_.size());
    state_.tallies.assign(options.contenders.size() * rows_per_contender(), empty);
    if (!options.resumed) return;
    if (!fits(*options.resumed)) throw std::invalid_argument("run_stress: the state is of a run with other options");
    state_ = *options.resumed;
  }

  StressReport run() {
    const auto start = Clock::now();
    const std::uint64_t batch = options_.kind->of_areas ? 16 : 512;  // so that it can be stopped
    StressReport report;
    report.kind = options_.kind;
    report.resumed = state_.done;
    auto saved = start;
    while (state_.done < options_.count) {
      if (stopped()) {
        report.complete = false;
        if (options_.save) options_.save(state_);
        break;
      }
      const std::uint64_t end = std::min(options_.count, state_.done + batch);
      tbb::parallel_for(tbb::blocked_range<std::uint64_t>(state_.done, end, options_.kind->of_areas ? 1 : 8),
                        [&](const auto& some) {
                          for (std::uint64_t k = some.begin(); k < some.end(); ++k) ask(options_.first + k);
                        });
      state_.done = end;
      if (options_.progress)
        options_.progress(static_cast<double>(end) / static_cast<double>(options_.count), "questions");
      if (options_.save && seconds_since(saved) >= options_.save_every) {
        options_.save(state_);
        saved = Clock::now();
      }
    }
    if (options_.save && report.complete) options_.save(state_);  // making failures small may take long
    report.questions = state_.done;
    report.found = state_.found.size();
    report.failures = failures();
    report.unjudged = unjudged();
    report.complete = report.complete && !stopped();
    for (std::size_t c = 0; c < options_.contenders.size(); ++c) {
      for (std::size_t f = 0; f < families_.size(); ++f) {
        for (std::size_t d = 0; d < departures().size(); ++d) {
          report.rows.push_back(
              {families_[f]->name, departures()[d].name, options_.contenders[c].name, state_.tallies[row(c, f, d)]});
        }
      }
    }
    report.seconds = seconds_since(start);
    return report;
  }

 private:
  bool fits(const StressState& state) const {
    return state.done <= options_.count && state.tallies.size() == state_.tallies.size() &&
           std::ranges::all_of(state.tallies, [&](const auto& t) { return t.properties.size() == names_.size(); }) &&
           std::ranges::all_of(state.found, [&](const StressFinding& f) {
             return f.number - options_.first < state.done && f.contender < options_.contenders.size() &&
                    f.what <= names_.size();
           });
  }
  bool stopped() const { return options_.stop && options_.stop(); }
  std::size_t rows_per_contender() const { return families_.size() * departures().size(); }
  std::size_t row(std::size_t contender, std::size_t family, std::size_t departure) const {
    return contender * rows_per_contender() + family * departures().size() + departure;
  }

  Named named(std::uint64_t number) const {
    const std::size_t family = number % families_.size(), departure = number / families_.size() % departures().size();
    return {fmt::format("{}/{}/{}/{}", options_.seed, families_[family]->name, departures()[departure].name,
                        number / rows_per_contender()),
            family, departure};
  }
  DrawnQuestion drawn(const Named& what) const {
    Random random(what.name), of_receiver(what.name + "/receiver");
    const QuestionFamily& family = *families_[what.family];
    const Departure& departure = departures()[what.departure];
    return options_.kind->of_areas ? draw_area_question(family, departure, random, of_receiver)
                                   : draw_question(family, departure, random);
  }

  std::optional<PropertyTrial> try_one(std::size_t property, const std::string& name, const Contender& contender,
                                       const Question& question, const Opinion& opinion) const {
    if (names_[property] == kClosure) {
      if (contender.is_proven) return try_closure(question);
      return std::nullopt;
    }
    Random random(name + "/" + names_[property]);
    const auto ask = [&](const Question& q) { return contender.ask(q, seed_of(name)); };
    return try_property(properties_[property], question, opinion, ask, random);
  }

  void ask(std::uint64_t number) {
    const Named what = named(number);
    const Question question = drawn(what).question;
    std::optional<Truth> truth;
    if (options_.oracle) {
      if (const auto exception = exception_of([&] { truth = options_.kind->truth(question); })) {
        const std::lock_guard lock(mutex_);
        state_.unjudged.push_back({number, *exception});
      }
    }
    for (std::size_t c = 0; c < options_.contenders.size(); ++c) {
      const Contender& contender = options_.contenders[c];
      StressTally tally;
      tally.properties.resize(names_.size());
      std::vector<StressFinding> wrong;
      Opinion opinion;
      const auto start = Clock::now();
      const auto thrown = exception_of([&] { opinion = contender.ask(question, seed_of(what.name)); });
      tally.seconds = seconds_since(start);
      tally.questions = 1;
      tally.stages = opinion.stages;
      tally.extended = opinion.extended;
      tally.worst_margin = opinion.margin;
      if (options_.oracle && !truth) tally.unjudged = 1;
      if (thrown) {
        tally.wrong = 1;
        wrong.push_back({number, c, names_.size(), thrown});
      } else if (truth) {
        Verdict verdict;
        if (const auto exception = exception_of([&] { verdict = truth->judge(opinion); })) {
          tally.unjudged = 1;
          const std::lock_guard lock(mutex_);
          state_.unjudged.push_back({number, contender.name + ": " + *exception});
        }
        tally.wrong = verdict.is_wrong ? 1 : 0;
        if (tally.unjudged == 0) tally.classes = opinion.classes.size();
        tally.worst_error = verdict.error;
        tally.worst_relative_error = verdict.relative_error;
        if (verdict.is_wrong) wrong.push_back({number, c, names_.size()});
      }
      if (truth && tally.unjudged == 0) seen_by(*truth, tally) = 1;
      for (std::size_t p = 0; !thrown && options_.properties && contender.has_properties && p < names_.size(); ++p) {
        std::optional<PropertyTrial> trial;
        if (const auto of_form = exception_of([&] { trial = try_one(p, what.name, contender, question, opinion); })) {
          tally.properties[p] = {1, 1, 0};
          wrong.push_back({number, c, p, of_form});
        } else if (trial) {
          tally.properties[p] = {1, trial->holds() ? 0u : 1u, trial->defect};
          if (!trial->holds()) wrong.push_back({number, c, p});
        }
      }
      const std::lock_guard lock(mutex_);
      state_.tallies[row(c, what.family, what.departure)].add(tally);
      state_.found.insert(state_.found.end(), wrong.begin(), wrong.end());
    }
  }

  /// The failures that are kept, small.
  std::vector<StressFailure> failures() {
    std::ranges::sort(state_.found, [](const StressFinding& a, const StressFinding& b) {
      return std::tie(a.number, a.contender, a.what) < std::tie(b.number, b.contender, b.what);
    });
    std::set<std::tuple<std::size_t, std::size_t>> had;
    std::vector<StressFinding> kept;
    for (const StressFinding& f : state_.found) {
      if (kept.size() == options_.failures_kept) break;
      const bool is_first = had.emplace(f.contender, named(f.number).family).second;
      if (is_first || options_.contenders[f.contender].is_proven) kept.push_back(f);
    }
    std::vector<StressFailure> failures(kept.size());
    tbb::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t k) { failures[k] = smallest(kept[k]); });
    return failures;
  }

  std::vector<UnjudgedQuestion> unjudged() {
    std::vector<StressUnjudged> kept = state_.unjudged;
    std::ranges::sort(kept, [](const StressUnjudged& a, const StressUnjudged& b) {
      return std::tie(a.number, a.exception) < std::tie(b.number, b.exception);
    });
    if (kept.size() > options_.failures_kept) kept.resize(options_.failures_kept);
    std::vector<UnjudgedQuestion> questions;
    for (const StressUnjudged& u : kept) {
      const Named what = named(u.number);
      questions.push_back({what.name + " " + drawn(what).placement, u.exception});
    }
    return questions;
  }

  StressFailure smallest(const StressFinding& found) const {
    const Named what = named(found.number);
    const DrawnQuestion drawn_question = drawn(what);
    const Contender& contender = options_.contenders[found.contender];
    const bool is_answer = found.what == names_.size();
    const auto ask = [&](const Question& question) { return contender.ask(question, seed_of(what.name)); };
    const auto throws = [&](const Question& question) {
      return exception_of([&] {
        const Opinion opinion = ask(question);
        if (!is_answer) try_one(found.what, what.name, contender, question, opinion);
      });
    };
    const auto is_wrong = [&](const Question& question) {
      const Opinion opinion = ask(question);
      if (is_answer) return options_.kind->truth(question).judge(opinion).is_wrong;
      const auto trial = try_one(found.what, what.name, contender, question, opinion);
      return trial && !trial->holds();
    };
    const auto fails = [&](const Question& question) {
      if (stopped()) return false;  // then it stays as it is
      if (found.exception) return throws(question) == found.exception;
      bool wrong = false;
      return !exception_of([&] { wrong = is_wrong(question); }) && wrong;
    };
    StressFailure failure{.question = what.name + " " + drawn_question.placement,
                          .contender = contender.name,
                          .what = is_answer ? kAnswer : names_[found.what],
                          .exception = {},
                          .asked = {shrink(drawn_question.question, fails)},
                          .F = std::numeric_limits<double>::quiet_NaN(),
                          .truth = {}};
    const Question question = failure.asked[0];
    failure.exception = found.exception.value_or("");
    exception_of([&] { failure.F = ask(question).F; });
    if (options_.oracle && !stopped()) exception_of([&] { failure.truth = options_.kind->truth(question).F; });
    if (!is_answer && names_[found.what] != kClosure) {
      Random random(what.name + "/" + names_[found.what]);
      const auto forms = properties_[found.what].forms(question, random);
      failure.asked.insert(failure.asked.end(), forms.begin(), forms.end());
    }
    return failure;
  }

  const StressOptions& options_;
  std::span<const Property> properties_;
  std::vector<std::string> names_;  // of properties
  std::vector<const QuestionFamily*> families_;
  std::mutex mutex_;
  StressState state_;
};

}  // namespace

void StressTally::add(const StressTally& other) {
  questions += other.questions;
  none += other.none;
  some += other.some;
  all += other.all;
  unjudged += other.unjudged;
  wrong += other.wrong;
  classes += other.classes;
  worst_error = std::max(worst_error, other.worst_error);
  worst_relative_error = std::max(worst_relative_error, other.worst_relative_error);
  worst_margin = std::max(worst_margin, other.worst_margin);
  stages += other.stages;
  extended += other.extended;
  seconds += other.seconds;
  properties.resize(std::max(properties.size(), other.properties.size()));
  for (std::size_t p = 0; p < other.properties.size(); ++p) {
    properties[p].tried += other.properties[p].tried;
    properties[p].broken += other.properties[p].broken;
    properties[p].worst_defect = std::max(properties[p].worst_defect, other.properties[p].worst_defect);
  }
}

std::uint64_t StressTally::tried() const {
  std::uint64_t sum = 0;
  for (const PropertyTally& p : properties) sum += p.tried;
  return sum;
}

std::uint64_t StressTally::broken() const {
  std::uint64_t sum = 0;
  for (const PropertyTally& p : properties) sum += p.broken;
  return sum;
}

StressTally StressReport::total(const std::string& contender) const {
  StressTally sum;
  for (const StressRow& row : rows) {
    if (row.contender == contender) sum.add(row.tally);
  }
  return sum;
}

StressReport run_stress(const StressOptions& options) {
  return StressRun(options).run();
}

}  // namespace exitance
