#pragma once
// Makes a question that shows something wrong as small as it can be made.

#include <functional>

#include "src/stress/question.h"

namespace exitance {

/// Takes away occluders, faces, holes and vertices and rounds coordinates to fewer bits, one change after another, as
/// long as `fails` still says true; asks it `most_tries` times at most. Solids lose no single faces. What `answer`
/// would refuse is not asked. REQUIRES: fails(question).
Question shrink(Question question, const std::function<bool(const Question&)>& fails, std::size_t most_tries = 2000);

}  // namespace exitance
