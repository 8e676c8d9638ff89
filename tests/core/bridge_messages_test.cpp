// The texts of UM-Bridge: both sides read what the other writes, and refuse what neither would.
#include "core/bridge_messages.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "core/bridge_answers.h"
#include "core/errors.h"

namespace isoline {
namespace {

constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
const BridgeSizes kSizes{{2, 1}, {3}};

std::uint64_t bits(Real value) { return std::bit_cast<std::uint64_t>(value); }

TEST(BridgeNumbers, ComeBackBitForBit) {
  std::mt19937_64 draw(1);
  Numbers numbers = {0.0, -0.0, 0.1, 1e22, 1e23, 5e-324, -1.7976931348623157e308, 1.0 / 3};
  while (numbers.size() < 10'000)
    if (const Real value = std::bit_cast<Real>(draw()); std::isfinite(value))
      numbers.push_back(value);
  const Numbers back = output_in(output_text(numbers));
  ASSERT_EQ(back.size(), numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(bits(back[i]), bits(numbers[i]));
}

TEST(BridgeNumbers, AreReadInEverySpellingOfWhatIsNotFinite) {
  const Numbers found =
      output_in(R"({"output": [NaN, nan, null, -nan, Infinity, inf, -Infinity, -inf, 1e5, -2E3]})");
  ASSERT_EQ(found.size(), 10U);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(std::isnan(found[i])) << i;
  EXPECT_EQ((Numbers{found.begin() + 4, found.end()}),
            (Numbers{kInfinity, kInfinity, -kInfinity, -kInfinity, 1e5, -2e3}));
  EXPECT_EQ(output_text({std::nan(""), kInfinity, -kInfinity, 1}),
            R"({"output":[NaN,Infinity,-Infinity,1.0]})");
}

TEST(BridgeNumbers, LeaveTextsAsTheyAre) {
  EXPECT_EQ(models_in(R"({"protocolVersion": 1.0, "models": ["nan", "a \" NaN", "null"]})"),
            (std::vector<std::string>{"nan", "a \" NaN", "null"}));
}

TEST(BridgeRequests, ReadWhatAClientWrites) {
  const BridgeCall asked{.verb = BridgeVerb::apply_hessian,
                         .input = {{0.1, -2}, {3}},
                         .out_wrt = 0,
                         .in_wrt = 1,
                         .in_wrt2 = 0,
                         .sens = {1, 2, 3},
                         .vec = {4, 5}};
  const BridgeRequest request(call_text("P \"x\"", R"({"a": 1})", asked));
  EXPECT_EQ(request.model(), "P \"x\"");
  const BridgeCall read = request.call(asked.verb, kSizes);
  EXPECT_EQ(read.input, asked.input);
  EXPECT_EQ(read.sens, asked.sens);
  EXPECT_EQ(read.vec, asked.vec);
  EXPECT_EQ(read.in_wrt, 1);
  EXPECT_EQ(read.in_wrt2, 0);
}

TEST(BridgeRequests, RefuseWhatDoesNotFitTheModel) {
  for (const char* body :
       {"", "[", "[]", "3", "{}", R"({"name": 3})", R"({"name": ["P"]})", R"({"name": null})"})
    EXPECT_THROW(BridgeRequest{body}, BridgeRefusal) << body;
  EXPECT_THROW(BridgeRequest{std::string(100'000, '[')}, BridgeRefusal);
  const std::string good = R"("input": [[1, 2], [3]], "outWrt": 0, "inWrt": 0, )";
  for (const std::string& rest : std::vector<std::string>{
           R"("input": [[1, 2], [3, 4]])", R"("input": [[1, 2]])", R"("input": [1, 2, 3])",
           R"("input": [[1, "2"], [3]])", R"("input": [[1, [2]], [3]])", R"("input": {"a": 1})",
           R"("input": null)", R"("none": 1)", good + R"("sens": [1, 2])", good + R"("sens": 3)",
           good + R"("sens": [1, 2, {}])",
           R"("input": [[1, 2], [3]], "outWrt": 1, "inWrt": 0, "sens": [1, 2, 3])",
           R"("input": [[1, 2], [3]], "outWrt": -1, "inWrt": 0, "sens": [1, 2, 3])",
           R"("input": [[1, 2], [3]], "outWrt": 0, "inWrt": 2, "sens": [1, 2, 3])",
           R"("input": [[1, 2], [3]], "outWrt": 0.0, "inWrt": 0, "sens": [1, 2, 3])",
           good + R"("sens": [1, 2, 3], "config": [])"}) {
    const std::string body = R"({"name": "P", )" + rest + "}";
    try {
      BridgeRequest(body).call(BridgeVerb::gradient, kSizes);
      ADD_FAILURE() << body;
    } catch (const BridgeRefusal& refusal) {
      EXPECT_EQ(refusal.kind, "InvalidInput") << body;
      EXPECT_STRNE(refusal.what(), "");
    }
  }
}

TEST(BridgeAnswers, ReadWhatAServerWrites) {
  EXPECT_EQ(models_in(info_text({"a", "b"})), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(input_sizes_in(input_sizes_text(kSizes)), kSizes.inputs);
  EXPECT_EQ(output_sizes_in(output_sizes_text(kSizes)), kSizes.outputs);
  const BridgeSupport support{true, false, true, false};
  EXPECT_EQ(support_in(support_text(support)), support);
  const std::vector<Numbers> outputs = {{1, 2}, {}, {3}};
  EXPECT_EQ(outputs_in(outputs_text(outputs)), outputs);
  EXPECT_EQ(error_in(error_text("InvalidInput", "why \" not")), "InvalidInput: why \" not");
  EXPECT_EQ(error_in(output_text({1})), "");
}

TEST(BridgeAnswers, RefuseWhatNoModelHas) {
  for (const char* sizes : {"[]", "[0]", "[-1]", "[1.5]", "[1e99]", "[\"2\"]", "3", "null",
                            "[99999999999999]", "[100000000, 100000000]"})
    EXPECT_THROW(input_sizes_in(std::string(R"({"inputSizes": )") + sizes + "}"), UsageError)
        << sizes;
  EXPECT_THROW(models_in("<html>"), UsageError);
  EXPECT_THROW(models_in(R"({"protocolVersion": 0.9, "models": []})"), UsageError);
  EXPECT_THROW(models_in(R"({"models": ["a"]})"), UsageError);
  for (const char* output : {"1", "[1]", "[[1], [[2]]]", "[[true]]", "{}"})
    EXPECT_THROW(outputs_in(std::string(R"({"output": )") + output + "}"), UsageError) << output;
}

}  // namespace
}  // namespace isoline
