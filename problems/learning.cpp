// Learning problems from their options.
#include "problems/learning.h"

namespace isoline::problems {

using networks::make_network;

Real summed_error(BatchRef x, const Batch& batch) {
  return (x - batch.truth).cwiseAbs().sum() / static_cast<Real>(x.cols());
}

ProblemParts learn(const Learning& options, const NetworkShape& shape, const Draw& draw,
                   ProblemParts parts) {
  if (!parts.network) parts.network = make_network(options.network, shape);
  RandomStream stream = draw.stream("network");
  parts.start = parts.network->start(stream);
  parts.samples.batch = options.batch;
  parts.samples.data = options.data;
  parts.samples.stream = [draw](std::string_view purpose) { return draw.stream(purpose); };
  return parts;
}

}  // namespace isoline::problems
