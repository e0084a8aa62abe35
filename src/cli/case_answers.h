#pragma once
// Answers to single questions.

#include <nlohmann/json.hpp>

namespace exitance {

/// What was asked of one case. Throws InvalidCase where something is wrong with the question.
nlohmann::ordered_json answer_to(const nlohmann::json& question, double tolerance);

/// The answer to one case: its id and status, and what was asked or the message of what is wrong with it. Throws
/// nothing that one case could cause.
nlohmann::ordered_json answer_case(const nlohmann::json& question, double tolerance);

}  // namespace exitance
