#!/usr/bin/env bash
# oneDNN 2.6.3: NaN is 0 after relu, -1 after clip, infinity after exp, and no maximum sees it.
#
# Guess before the run: a value that is not a number stays one through every elementwise function,
# pooling and reduction, on every instruction set.
# Seen: relu of NaN is 0, with a gradient of 1; clip to [-1, 1] gives -1, exp gives infinity; max
# pooling and reduction_max leave it out. With a slope of 0.1 relu keeps it, as do tanh, logistic
# and sqrt, sums and means. SSE4.1 and AVX2 agree. A network whose values are NaN before a relu has
# a finite loss, so an optimizer's test of the loss does not see it: test the weights.
. "$(dirname "$0")/packages.sh"
debian libdnnl-dev=2.6.3-1
cat >"$work/run.cpp" <<'C'
#include <cmath>
#include <cstdio>
#include <dnnl.hpp>
#include <vector>
using namespace dnnl;
using Type = memory::data_type;
using Tag = memory::format_tag;

static const engine cpu(engine::kind::cpu, 0);
static stream order(cpu);
static void say(const char *name, float v) {
  if (std::isnan(v)) std::printf(" %s NaN,", name);
  else std::printf(" %s %g,", name, v);
}
static void elementwise(const char *name, algorithm which, float alpha, float beta) {
  std::vector<float> x(17, -1.0f), y(17);
  x[8] = NAN;
  const memory::desc shape({17}, Type::f32, Tag::a);
  memory in(shape, cpu, x.data()), out(shape, cpu, y.data());
  eltwise_forward::primitive_desc all(
      eltwise_forward::desc(prop_kind::forward_training, which, shape, alpha, beta), cpu);
  eltwise_forward(all).execute(order, {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, out}});
  order.wait();
  say(name, y[8]);
}
int main() {
  elementwise("relu", algorithm::eltwise_relu, 0, 0);
  elementwise("relu 0.1", algorithm::eltwise_relu, 0.1f, 0);
  elementwise("clip", algorithm::eltwise_clip, -1, 1);
  elementwise("exp", algorithm::eltwise_exp, 0, 0);
  elementwise("tanh", algorithm::eltwise_tanh, 0, 0);
  elementwise("logistic", algorithm::eltwise_logistic, 0, 0);
  elementwise("sqrt", algorithm::eltwise_sqrt, 0, 0);
  float x[4] = {1, NAN, 2, 3}, y;
  const memory::desc wide({1, 1, 1, 4}, Type::f32, Tag::nchw), one({1, 1, 1, 1}, Type::f32, Tag::nchw);
  memory in(wide, cpu, x), out(one, cpu, &y);
  for (bool largest : {true, false}) {
    pooling_forward::primitive_desc all(
        pooling_forward::desc(prop_kind::forward_inference,
                              largest ? algorithm::pooling_max : algorithm::pooling_avg_include_padding, wide,
                              one, {1, 1}, {1, 4}, {0, 0}, {0, 0}), cpu);
    pooling_forward(all).execute(order, {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, out}});
    order.wait();
    say(largest ? "pooled maximum" : "pooled mean", y);
  }
  for (bool largest : {true, false}) {
    reduction::primitive_desc all(
        reduction::desc(largest ? algorithm::reduction_max : algorithm::reduction_sum, wide, one, 0, 0), cpu);
    reduction(all).execute(order, {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, out}});
    order.wait();
    say(largest ? "maximum" : "sum", y);
  }
  float slope = 1, back;
  const memory::desc single({1}, Type::f32, Tag::a);
  memory at(single, cpu, x + 1), from(single, cpu, &slope), to(single, cpu, &back);
  eltwise_forward::primitive_desc hint(
      eltwise_forward::desc(prop_kind::forward_training, algorithm::eltwise_relu, single, 0, 0), cpu);
  eltwise_backward::primitive_desc all(
      eltwise_backward::desc(algorithm::eltwise_relu, single, single, 0, 0), cpu, hint);
  eltwise_backward(all).execute(order, {{DNNL_ARG_SRC, at}, {DNNL_ARG_DIFF_DST, from}, {DNNL_ARG_DIFF_SRC, to}});
  order.wait();
  say("gradient of relu", back);
  std::puts("");
}
C
compile "$work/run.cpp" -ldnnl
run() { for isa in SSE41 AVX2; do ONEDNN_MAX_CPU_ISA=$isa "$work/program"; done; }
expect ' relu 0, relu 0.1 NaN, clip -1, exp inf, tanh NaN, logistic NaN, sqrt NaN, pooled maximum 3, pooled mean NaN, maximum 3, sum NaN, gradient of relu 1,
 relu 0, relu 0.1 NaN, clip -1, exp inf, tanh NaN, logistic NaN, sqrt NaN, pooled maximum 3, pooled mean NaN, maximum 3, sum NaN, gradient of relu 1,' run
