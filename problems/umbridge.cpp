// A model behind UM-Bridge, the field's protocol for models over HTTP (Seelinger et al. 2023,
// Journal of Open Source Software 8(83), 4748; protocol 1.0): y = P(x) is Evaluate, Jᵀw Gradient,
// J v ApplyJacobian, Σ wᵢ ∇²Pᵢ v ApplyHessian. The protocol knows no target, so that y*, the start
// and x* are given here; of another Isoline's problem P they are its model P.data.
#include "core/bridge_answers.h"
#include "core/digest.h"
#include "core/foreign/foreign.h"
#include "core/records/npy.h"
#include "core/shell.h"
#include "problems/physics/bridged_model.h"
#include "problems/problem.h"

namespace isoline::problems {
namespace {

struct Options {
  std::string url, command, model, config = "{}", start, target, truth, minimum, label;
  Real startup = 30;
};

constexpr const char* kNumbers = ": numbers as \"[1, 2]\", or a file of .npy";

void fields(Options& o, auto& field) {
  static const std::string start = std::string("x₀") + kNumbers,
                           target = std::string("y*") + kNumbers,
                           truth = std::string("x*, where it is known") + kNumbers;
  field("url", o.url, {}, "where models are served: http://127.0.0.1:4242");
  field("command", o.command, {}, "what is started instead, with its port in PORT");
  field("model", o.model, {}, "its name there; empty: the only one");
  field("config", o.config, {}, "a JSON object that goes with every call");
  field("start", o.start, {}, start.c_str());
  field("target", o.target, {}, target.c_str());
  field("truth", o.truth, {}, truth.c_str());
  field("minimum", o.minimum, {}, "the least loss, where it is known");
  field("label", o.label, {}, "what tables call it");
  field("startup", o.startup, above(0), "seconds within which a command must answer");
}

class Umbridge final : public Physics {
 public:
  explicit Umbridge(std::shared_ptr<BridgedModel> model) : model_(std::move(model)) {}

  Index inputs() const override { return model_->inputs(); }
  Index outputs() const override { return model_->outputs(); }
  bool is_elsewhere() const override { return true; }
  Products products() const override {
    return {.has_pushforward = model_->supports(BridgeVerb::apply_jacobian),
            .has_pullback = model_->supports(BridgeVerb::gradient)};
  }

  void forward(BatchRef x, BatchRef, BatchOut y, Workspace&) const override {
    for (Index b = 0; b < x.cols(); ++b) model_->evaluate(x.col(b), y.col(b));
  }
  void pushforward(BatchRef v, BatchOut Jv, Workspace& w) const override {
    for (Index b = 0; b < v.cols(); ++b) model_->apply_jacobian(w.x.col(b), v.col(b), Jv.col(b));
  }
  void pullback(BatchRef u, BatchOut JTu, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b) model_->gradient(w.x.col(b), u.col(b), JTu.col(b));
  }

  // The Hessian of L takes all three.
  bool has_curvature() const override {
    const Products has = products();
    return model_->supports(BridgeVerb::apply_hessian) && has.has_pushforward && has.has_pullback;
  }
  void curvature(BatchRef u, BatchOut out, Workspace& w) const override {
    const Index k = inputs();
    Vector unit = Vector::Zero(k);
    for (Index b = 0; b < u.cols(); ++b)
      for (Index i = 0; i < k; ++i) {
        unit[i] = 1;
        model_->apply_hessian(w.x.col(b), u.col(b), unit, out.col(b * k + i));
        unit[i] = 0;
      }
  }
  void curvature_product(BatchRef u, BatchRef v, BatchOut out, Workspace& w) const override {
    for (Index b = 0; b < u.cols(); ++b)
      model_->apply_hessian(w.x.col(b), u.col(b), v.col(b), out.col(b));
  }

 private:
  std::shared_ptr<BridgedModel> model_;
};

Numbers numbers_of(const std::string& given, const char* option) {
  const bool is_file = given.ends_with(".npy");
  return is_file ? read_npy(given).values : numbers_in(given, std::string("umbridge: ") + option);
}

// As given, else what the model's own data say.
Vector vector_of(const std::string& given, const char* option, Index size, const Numbers* own) {
  require(!given.empty() || own != nullptr, [&] {
    return std::string("umbridge: ") + option + " must be given, as " + option +
           "=\"[1, 2]\" or a file of .npy";
  });
  const Numbers values = given.empty() ? *own : numbers_of(given, option);
  require(static_cast<Index>(values.size()) == size, [&] {
    return std::string("umbridge: ") + option + " must have " + std::to_string(size) +
           " numbers, got " + std::to_string(values.size());
  });
  return Eigen::Map<const Vector>(values.data(), size);
}

ProblemParts make_umbridge(const Options& o, const Draw& draw) {
  const auto model = std::make_shared<BridgedModel>(
      BridgedModel::Place{o.url, o.command, o.startup}, o.model, config_in(o.config, "config"));
  const auto data = o.start.empty() || o.target.empty() ? model->data() : std::nullopt;
  const Vector standard =
      vector_of(o.start, "start", model->inputs(), data ? &(*data)[1] : nullptr);
  ProblemParts parts{
      .start = draw.start(standard),
      .target = vector_of(o.target, "target", model->outputs(), data ? data->data() : nullptr)};
  if (!o.minimum.empty()) parts.minimum = numbers_in("[" + o.minimum + "]", "minimum").at(0);
  if (!o.truth.empty()) {
    const Matrix truth = vector_of(o.truth, "truth", model->inputs(), nullptr);
    parts.truth = truth;
    parts.x_error = [truth](BatchRef x, const Batch&) { return (x - truth).norm(); };
  }
  parts.physics = std::make_unique<Umbridge>(model);
  return parts;
}

// Nothing is asked for it: of a server that others started nothing is known but where it is.
Foreign introduce(const OptionValues& options) {
  const auto o = read_options<Options>(options);
  require(o.url.empty() != o.command.empty(),
          "umbridge needs either url=http://… of a server, or command=\"…\" that starts one");
  config_in(o.config, "umbridge: config");
  std::vector<std::string> words;
  if (!o.command.empty()) words = shell_words(o.command);
  words.insert(words.end(), {o.start, o.target, o.truth});
  return {.door = "umbridge",
          .command = o.command.empty() ? o.url : o.command,
          .digest = digest_of_files(words),
          .label = o.label,
          .note = o.model.empty() ? "" : "model " + o.model};
}

}  // namespace

void register_umbridge(ProblemRegistry& registry) {
  ProblemEntry entry = problem_entry(
      {.name = "umbridge",
       .title = "A model behind UM-Bridge",
       .formula = "y = P(x), each product with J sends x anew,  L = ½‖y − y*‖²",
       .source = "Seelinger et al. (2023), protocol 1.0; the model's own",
       .note = "Several inputs are joined to one x, several outputs to one y. What the model does "
               "not support makes the methods that need it inapplicable. An x that is not finite "
               "has a y that is not a number, unasked.",
       .in_all = false,
       .needs_argument = "umbridge[url=…]",
       .introduce = introduce},
      make_umbridge);
  registry.add(std::move(entry));
}

}  // namespace isoline::problems
