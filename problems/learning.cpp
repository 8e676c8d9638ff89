// Learning problems from their options.
#include "problems/learning.h"

#include "problems/watches.h"

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
  const Index epoch = options.data > 0 ? 0 : parts.samples.epoch;
  require(epoch % options.batch == 0, "the samples of an epoch must be a multiple of the batch");
  parts.samples.stream = [draw](std::string_view purpose) { return draw.stream(purpose); };
  if (shape.grid > 0) parts.series = joined(std::move(parts.series), half_squared_error());
  if (options.watch == "noise") parts.series = joined(std::move(parts.series), batch_noise());
  if (options.watch == "spectrum") {
    require(shape.grid > 0, "watch=spectrum is for samples that are grids");
    parts.series = joined(std::move(parts.series), spectrum(shape.grid));
  }
  return parts;
}

}  // namespace isoline::problems
