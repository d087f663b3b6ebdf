// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures are XML that programs can read, whatever the numbers and names in them.
#include "bench/plot.hpp"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <limits>
#include <string_view>

namespace tetfmt_test {
namespace {

using tetbench::Axis;
using tetbench::Panel;
using tetbench::Series;

/// What is not well-formed in an XML document without comments or declarations; empty if all is well.
std::string problem_of(std::string_view xml) {
  std::vector<std::string> open;
  std::size_t roots = 0;
  const auto text_is_fine = [](std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto c = static_cast<unsigned char>(text[i]);
      if (c < 0x20 && c != '\n') return false;
      if (c == '<' || c == '>') return false;
      if (c != '&') continue;
      bool entity = false;
      for (const char* known : {"&amp;", "&lt;", "&gt;", "&quot;"})
        entity = entity || text.substr(i).starts_with(known);
      if (!entity) return false;
    }
    return true;
  };
  std::size_t at = 0;
  while (at < xml.size()) {
    const std::size_t tag = xml.find('<', at);
    const std::string_view text = xml.substr(at, tag == std::string_view::npos ? tag : tag - at);
    if (!text_is_fine(text)) return "text: " + std::string(text);
    if (open.empty() && text.find_first_not_of('\n') != std::string_view::npos) return "text outside";
    if (tag == std::string_view::npos) break;
    // A tag ends at the first > that is not in quotes.
    std::size_t end = tag;
    for (bool quoted = false; end < xml.size() && (quoted || xml[end] != '>'); ++end)
      if (xml[end] == '"') quoted = !quoted;
    if (end == xml.size()) return "a tag does not end";
    std::string_view inner = xml.substr(tag + 1, end - tag - 1);
    at = end + 1;
    if (inner.starts_with('/')) {
      if (open.empty() || inner.substr(1) != open.back())
        return "closes what is not open: " + std::string(inner);
      open.pop_back();
      continue;
    }
    const bool empty = inner.ends_with('/');
    if (empty) inner.remove_suffix(1);
    std::size_t name_end = 0;
    while (name_end < inner.size() && std::isalnum(static_cast<unsigned char>(inner[name_end]))) ++name_end;
    const std::string name(inner.substr(0, name_end));
    if (name.empty()) return "a tag without a name";
    inner.remove_prefix(name_end);
    std::vector<std::string> attributes;
    while (!inner.empty()) {
      if (inner[0] != ' ') return "no space before an attribute of " + name;
      const std::size_t equals = inner.find("=\"");
      if (equals == std::string_view::npos) return "an attribute without a value in " + name;
      const std::string attribute(inner.substr(1, equals - 1));
      for (const std::string& known : attributes)
        if (known == attribute) return "twice: " + attribute;
      attributes.push_back(attribute);
      const std::size_t quote = inner.find('"', equals + 2);
      if (quote == std::string_view::npos) return "a value does not end";
      if (!text_is_fine(inner.substr(equals + 2, quote - equals - 2))) return "value of " + attribute;
      inner.remove_prefix(quote + 1);
    }
    if (open.empty() && ++roots > 1) return "two roots";
    if (!empty) open.push_back(name);
  }
  return open.empty() && roots == 1 ? "" : "not closed";
}

std::size_t count(std::string_view text, std::string_view part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string_view::npos; at += part.size()) ++n;
  return n;
}

TEST(Plot, CheckerOfThisTestFindsWhatIsBroken) {
  EXPECT_EQ(problem_of("<a b=\"1\"><c/>x &amp; y</a>\n"), "");
  for (const char* broken : {"<a>", "<a></b>", "<a b=1/>", "<a>x & y</a>", "<a b=\"1\" b=\"2\"/>", "<a/><b/>",
                             "x", "<a b=\"<\"/>", "<a>\x01</a>"})
    EXPECT_NE(problem_of(broken), "") << broken;
}

TEST(Plot, IsWellFormedWhateverIsInIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), far = std::numeric_limits<double>::infinity();
  const Series plain{"<&\"\x01 name", {"#0072b2"}, true, {{1, 2}, {10, 20}, {nan, 3}, {3, far}}};
  std::vector<Panel> panels = {
      {"both linear & <b>", {"x"}, {"y"}, {plain}},
      {"logs",
       {"x", true, false, "none"},
       {"y", true},
       {plain, {"zeros", {}, false, {{0, 5}, {-1, 5}, {5, 0}}}}},
      {"nothing", {"x", true}, {"y"}, {}},
      {"one point", {"x", false, true}, {"y", true}, {{"one", {}, true, {{4, 4}}}}},
  };
  for (int shape = 0; shape < static_cast<int>(tetbench::kShapes); ++shape)
    for (const bool filled : {false, true})
      panels[0].series.push_back({"shape " + std::to_string(shape) + (filled ? "" : ", hollow"),
                                  {"#000000", static_cast<tetbench::Shape>(shape), filled},
                                  false,
                                  {{5.0 + shape, 7}}});
  const std::string svg = tetbench::figure("title & more", "note <here>", panels);
  EXPECT_EQ(problem_of(svg), "");
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(problem_of(tetbench::figure("", "", {})), "");
}

TEST(Plot, ShowsEveryPointThatAnAxisHasAndEverySeriesInTheLegendOnce) {
  const auto series = [](std::vector<Series::Point> points) {
    return Series{"name", {}, true, std::move(points)};
  };
  const std::string log =
      tetbench::figure("", "", {{"", {"x", true}, {"y"}, {series({{0, 1}, {1, 1}, {2, 1}})}}});
  EXPECT_EQ(count(log, "<circle"), 2U + 1U) << "0 has no place on a log axis; one more in the legend";
  const std::string with_zero =
      tetbench::figure("", "",
                       {{"", {"x", true, false, "none"}, {"y"}, {series({{0, 1}, {1, 1}, {2, 1}})}},
                        {"", {"x"}, {"y"}, {series({{1, 1}})}}});
  EXPECT_EQ(count(with_zero, "<circle"), 3U + 1U + 1U);
  EXPECT_EQ(count(with_zero, ">none</text>"), 1U);
  EXPECT_EQ(count(with_zero, ">name</text>"), 1U);
}

}  // namespace
}  // namespace tetfmt_test
