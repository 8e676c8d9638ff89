// The answer in its record or in the file beside it.
#include "core/records/parts/answer.h"

#include <algorithm>
#include <functional>

#include "core/errors.h"
#include "core/records/npy.h"

namespace isoline {

void require_sound(const AnswerPoints& answer) {
  const bool are_named =
      !answer.points.empty() && answer.points.size() <= 2 &&
      std::ranges::all_of(answer.points,
                          [](const auto& name) { return name == kReturned || name == kBest; }) &&
      (answer.points.size() == 1 || answer.points[0] != answer.points[1]);
  require(answer.unknowns > 0 && are_named, "its answer has no unknowns or unknown points");
  for (const auto* texts : {&answer.names, &answer.units})
    require(texts->empty() || std::ssize(*texts) == answer.unknowns,
            "the names or units of its unknowns differ in number from the unknowns");
  require(answer.scales.empty() || std::ssize(answer.scales) == answer.unknowns,
          "the scales of its unknowns differ in number from the unknowns");
  for (const auto* places : {&answer.at_lower, &answer.at_upper})
    for (const Index i : *places)
      require(i >= 0 && i < answer.unknowns, "an unknown on a bound does not exist");
  if (answer.is_in_file()) return;
  const bool are_all_there =
      answer.x.size() == answer.points.size() && std::ranges::all_of(answer.x, [&](const auto& x) {
        return static_cast<Index>(x.size()) == answer.unknowns;
      });
  require(are_all_there, "the points of its answer differ in length");
}

std::string answer_file(const AnswerPoints& answer) {
  NumberArray array{{static_cast<Index>(answer.points.size()), answer.unknowns}, {}};
  for (const std::vector<Real>& x : answer.x)
    array.values.insert(array.values.end(), x.begin(), x.end());
  return npy_bytes(array);
}

void read_answer_numbers(AnswerPoints& answer, const std::filesystem::path& path) {
  if (!answer.is_in_file()) return;
  const auto points = static_cast<Index>(answer.points.size());
  const NumberArray array = read_npy_beside(path, answer.digest, {points, answer.unknowns});
  answer.x.clear();
  for (Index i = 0; i < points; ++i) {
    const auto first = array.values.begin() + i * answer.unknowns;
    answer.x.emplace_back(first, first + answer.unknowns);
  }
}

}  // namespace isoline
