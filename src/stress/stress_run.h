#pragma once
// Many degenerate questions, put to several ways to answer them: what is wrong of which, by family and departure.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "src/output/progress.h"
#include "src/stress/question_kind.h"

namespace exitance {

/// How a property fared.
struct PropertyTally {
  std::uint64_t tried = 0, broken = 0;
  double worst_defect = 0;
};

/// Of one family, departure and contender.
struct StressTally {
  std::uint64_t questions = 0;
  std::uint64_t none = 0, some = 0, all = 0;  ///< how much is seen, as the oracle says
  std::uint64_t unjudged = 0;                 ///< questions that the oracle throws an exception on
  /// Answers that are further from the truth than their margin, or say of what is hidden that it is seen, or that
  /// something is open, hidden or away that is not; and exceptions instead of answers.
  std::uint64_t wrong = 0;
  std::uint64_t classes = 0;        ///< that were compared with the truth's, of shafts and shadow volumes
  double worst_error = 0;           ///< of F, absolute
  double worst_relative_error = 0;  ///< where F ≥ 1e-15
  double worst_margin = 0;
  StageCounts stages;
  std::uint64_t extended = 0;             ///< facets that took more than double precision
  double seconds = 0;                     ///< that the answers took, properties apart
  std::vector<PropertyTally> properties;  ///< in the order of property_names(kind)

  void add(const StressTally& other);
  std::uint64_t tried() const;
  std::uint64_t broken() const;
};

/// Something found wrong, before it is made small.
struct StressFinding {
  std::uint64_t number = 0;                   ///< of the question
  std::size_t contender = 0, what = 0;        ///< what: the property, or their number for the answer
  std::optional<std::string> exception = {};  ///< what it says, where one was thrown instead of an answer
};

/// A question on which the oracle threw.
struct StressUnjudged {
  std::uint64_t number = 0;
  std::string exception;
};

/// What a run knows so far, which is all that it needs to go on.
struct StressState {
  std::uint64_t done = 0;            ///< questions
  std::vector<StressTally> tallies;  ///< by contender, family, departure
  std::vector<StressFinding> found;
  std::vector<StressUnjudged> unjudged;
};

struct StressOptions {
  const QuestionKind* kind = &question_kind_named("points");  ///< not null
  std::vector<std::string> families;                          ///< empty: all
  std::uint64_t count = 1000;  ///< of questions, spread evenly over families and departures
  std::uint64_t first = 0;     ///< number of the first question
  std::uint64_t seed = 1;
  std::vector<Contender> contenders;
  bool oracle = true;      ///< compare with the truth of the kind
  bool properties = true;  ///< of contenders that have them, and closure of the exact one
  std::size_t failures_kept = 1000;
  Progress progress;
  std::function<bool()> stop;  ///< asked between questions and tries to make failures small; true ends the run
  std::optional<StressState> resumed = {};       ///< of a run that differed in nothing but a smaller count
  std::function<void(const StressState&)> save;  ///< called when it is stopped, and after each save_every seconds
  double save_every = 5;
};

struct StressRow {
  std::string family, departure, contender;
  StressTally tally;
};

/// A question that was answered wrong, or a property of it that does not hold, as small as it can be made.
struct StressFailure {
  std::string question;  ///< seed/family/departure/number, and its placement
  std::string contender;
  std::string what;             ///< "answer", or the property
  std::string exception;        ///< what it says, where one was thrown instead of an answer
  std::vector<Question> asked;  ///< the question, and the forms of it that the property compares it with
  double F = 0;                 ///< what the contender says of the first; NaN if it throws
  std::optional<double> truth;  ///< what the oracle says of it
};

/// A question that the oracle has no answer to.
struct UnjudgedQuestion {
  std::string question;  ///< as in StressFailure
  std::string exception;
};

struct StressReport {
  const QuestionKind* kind = nullptr;
  std::vector<StressRow> rows;             ///< by contender, family, departure
  std::vector<StressFailure> failures;     ///< in the order of the questions
  std::uint64_t found = 0;                 ///< wrong answers and broken properties, kept as failures or not
  std::vector<UnjudgedQuestion> unjudged;  ///< likewise, as many as failures may be kept
  std::uint64_t questions = 0;
  std::uint64_t resumed = 0;  ///< of them, those that an earlier run had asked
  double seconds = 0;         ///< of this run
  bool complete = true;       ///< not stopped

  StressTally total(const std::string& contender) const;
};

/// The same options give the same report, times apart, for any number of threads. Of contenders that prove nothing only
/// the first failure of each family is kept, for they have many. An exception of a contender is a failure of its own;
/// where the oracle throws, answers are not judged. A run that is ended and goes on gives the same report. Throws
/// std::invalid_argument on a family that there is not, naming those that there are, and on a state that is not of a
/// run like this one.
StressReport run_stress(const StressOptions& options);

}  // namespace exitance
