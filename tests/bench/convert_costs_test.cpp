// SPDX-License-Identifier: AGPL-3.0-or-later
// What is told of conversions that were faster than the clock tells.
#include "bench/convert_costs.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tetbench {
namespace {

ConvertCost cost(double tetgen, double reducing) {
  ConvertCost cost;
  cost.file = "mesh.off";
  cost.optimize = "fast";
  cost.seconds = {2, 2};
  cost.tetgen = {1, tetgen};
  cost.reduce_crossings = {reducing, reducing};
  cost.area_before = 3;
  cost.area_after = 2;
  return cost;
}

TEST(ConvertCostsTest, ShareOfTetgensTime) {
  const std::vector<ConvertCost> costs = {cost(1, 0.25)};
  EXPECT_NE(convert_table(costs, 2).find("TetGen  0.250 (0.250 .. 0.250);"), std::string::npos);
  const auto json = nlohmann::json::parse(convert_json(costs, 2));
  EXPECT_EQ(json.at("conversions")[0].at("reduce_crossings_to_tetgen").at("median"), 0.25);
}

TEST(ConvertCostsTest, NoShareOfNoTime) {
  for (const double reducing : {0.0, 0.25}) {
    const std::vector<ConvertCost> costs = {cost(0, reducing)};
    const std::string table = convert_table(costs, 2);
    EXPECT_NE(table.find("TetGen  -;"), std::string::npos) << table;
    EXPECT_EQ(table.find("inf"), std::string::npos) << table;
    EXPECT_EQ(table.find("nan"), std::string::npos) << table;
    const auto json = nlohmann::json::parse(convert_json(costs, 2));
    EXPECT_TRUE(json.at("conversions")[0].at("reduce_crossings_to_tetgen").is_null());
    EXPECT_EQ(json.at("conversions")[0].at("tetgen_seconds").at("low"), 0);
  }
}

}  // namespace
}  // namespace tetbench
