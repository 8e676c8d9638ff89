// A physics by the functions of a shared library. Its products receive their x and the data that
// forward() kept for it, so a rejected trial does not cost a further forward pass. Products that
// the library lacks are computed from its Jacobian, if it has one.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/floating_point.h"
#include "core/foreign/isoline.h"
#include "core/foreign/plugin_library.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

constexpr std::uint64_t kMostSize = std::uint64_t{1} << 27;  // a vector of 1 GiB

constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();

// The output of a function, or NaN if it reported that it has no answer.
void judge(int told, BatchOut out) {
  if (told != 0) out.setConstant(kNan);
}

isoline_sizes sizes_of(const PluginInstance& instance) {
  isoline_sizes sizes{};
  sizes.minimum = kNan;
  const std::string words = instance.of().words();
  if (instance.table().dimension(instance.self(), &sizes) != 0)
    throw std::runtime_error(words + ": dimension() failed");
  const auto hold = [&](const char* name, std::uint64_t least, std::uint64_t size) {
    require(size >= least && size <= kMostSize, [&] {
      return fmt::format("{}: dimension() must give {} from {} to {}, got {}", words, name, least,
                         kMostSize, size);
    });
  };
  hold("inputs", 1, sizes.inputs);
  hold("outputs", 1, sizes.outputs);
  hold("kept", 0, sizes.kept);
  if (instance.of().can(ISOLINE_BOUNDS)) {
    require(sizes.lower != nullptr && sizes.upper != nullptr,
            [&] { return words + ": dimension() must give lower and upper, got null"; });
    for (std::uint64_t i = 0; i < sizes.inputs; ++i)
      require(sizes.lower[i] <= sizes.upper[i], [&] {
        return fmt::format("{}: dimension() must give lower ≤ upper, got {} and {} for unknown {}",
                           words, sizes.lower[i], sizes.upper[i], i);
      });
  }
  const bool has_inverse = instance.of().can(ISOLINE_INVERSE);
  const bool is_known = sizes.inverse >= ISOLINE_EXACT && sizes.inverse <= ISOLINE_APPROXIMATE;
  require(!has_inverse || is_known, [&] {
    return fmt::format(
        "{}: dimension() must set inverse to a kind from ISOLINE_EXACT to ISOLINE_APPROXIMATE, got "
        "{}",
        words, sizes.inverse);
  });
  return sizes;
}

class PluginPhysics final : public ByJacobian {
 public:
  PluginPhysics(const PluginComponent& component, const OptionValues& options, std::uint64_t seed)
      : instance_(component, options, seed), sizes_(sizes_of(instance_)) {}

  const PluginInstance& instance() const { return instance_; }
  const isoline_sizes& sizes() const { return sizes_; }
  Index inputs() const override { return static_cast<Index>(sizes_.inputs); }
  Index outputs() const override { return static_cast<Index>(sizes_.outputs); }
  Products products() const override {
    const PluginComponent& of = instance_.of();
    return {.has_pushforward = of.can(ISOLINE_PUSHFORWARD) || of.can(ISOLINE_JACOBIAN),
            .has_pullback = of.can(ISOLINE_PULLBACK) || of.can(ISOLINE_JACOBIAN)};
  }
  Inverse inverse_kind() const override {  // of the same numbers
    static_assert(ISOLINE_EXACT == static_cast<int>(Inverse::exact) &&
                  ISOLINE_APPROXIMATE == static_cast<int>(Inverse::approximate));
    return instance_.of().can(ISOLINE_INVERSE) ? static_cast<Inverse>(sizes_.inverse)
                                               : Inverse::none;
  }

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace& w) const override {
    w.saved.resize(2);
    const KeptFloatingPoint around;
    w.saved[1].resize(static_cast<Index>(sizes_.kept), x.cols());
    for (Index b = 0; b < x.cols(); ++b)
      judge(table().forward(self(), x.col(b).data(), y.col(b).data(), w.saved[1].col(b).data()),
            y.col(b));
  }

  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    if (!instance_.of().can(ISOLINE_PUSHFORWARD)) return ByJacobian::pushforward(v, Jv, w);
    const KeptFloatingPoint around;
    for (Index b = 0; b < v.cols(); ++b)
      judge(table().pushforward(self(), w.x.col(b).data(), kept(w, b), v.col(b).data(),
                                Jv.col(b).data()),
            Jv.col(b));
  }

  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    if (!instance_.of().can(ISOLINE_PULLBACK)) return ByJacobian::pullback(u, JTu, w);
    const KeptFloatingPoint around;
    for (Index b = 0; b < u.cols(); ++b)
      judge(table().pullback(self(), w.x.col(b).data(), kept(w, b), u.col(b).data(),
                             JTu.col(b).data()),
            JTu.col(b));
  }

  void jacobian(BatchOut J, Workspace& w) const override {
    instance_.of().can(ISOLINE_JACOBIAN) ? ByJacobian::jacobian(J, w) : Physics::jacobian(J, w);
  }

  Success local_inverse(BatchRef y, BatchRef x0, BatchRef, BatchOut x) const override {
    Success success(y.cols());
    const KeptFloatingPoint around;
    for (Index b = 0; b < y.cols(); ++b)
      success[b] = table().inverse(self(), y.col(b).data(), x0.col(b).data(), x.col(b).data()) == 0;
    return success;
  }

 private:
  const isoline_component& table() const { return instance_.table(); }
  void* self() const { return instance_.self(); }
  const double* kept(const Workspace& w, Index b) const { return w.saved[1].col(b).data(); }

  void form_jacobian(Matrix& J, Workspace& w) const override {
    const KeptFloatingPoint around;
    for (Index b = 0; b < w.x.cols(); ++b) {
      BatchOut of_sample = J.middleCols(b * inputs(), inputs());
      judge(table().jacobian(self(), w.x.col(b).data(), kept(w, b), of_sample.data()), of_sample);
    }
  }

  PluginInstance instance_;
  isoline_sizes sizes_;
};

ProblemParts plugin_parts(const PluginComponent& component, const OptionValues& options,
                          const Draw& draw) {
  auto physics = std::make_unique<PluginPhysics>(component, options, draw.instance_seed());
  const Index k = physics->inputs();
  const bool has_truth = component.can(ISOLINE_TRUTH);
  Vector start = Vector::Zero(k);
  Matrix target = Matrix::Zero(physics->outputs(), 1), truth = Matrix::Zero(has_truth ? k : 0, 1);
  const PluginInstance& instance = physics->instance();
  if (instance.table().instance(instance.self(), start.data(), target.data(),
                                has_truth ? truth.data() : nullptr) != 0)
    throw std::runtime_error(component.words() + ": instance() failed");
  const isoline_sizes sizes = physics->sizes();  // its arrays are the component's
  const Real minimum = sizes.minimum;
  ProblemParts parts{
      .physics = std::move(physics), .start = draw.start(start), .target = std::move(target)};
  if (!std::isnan(minimum)) parts.minimum = minimum;
  if (component.can(ISOLINE_BOUNDS))
    parts.bounds =
        Bounds{Eigen::Map<const Vector>(sizes.lower, k), Eigen::Map<const Vector>(sizes.upper, k)};
  if (has_truth) parts.truth = truth;
  return parts;
}

}  // namespace

void add_plugin_physics(ProblemRegistry& registry, const PluginComponent& component) {
  ProblemEntry entry{.name = component.name,
                     .title = component.title,
                     .formula = component.formula,
                     .source = component.source,
                     .note = component.note,
                     .options = component.options};
  entry.introduce = [foreign = component.foreign](const OptionValues&) { return foreign; };
  entry.make = [component](const OptionValues& options, const Draw& draw) {
    return Problem(plugin_parts(component, options, draw));
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::problems
