// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists of conversions and what is told of them. Batches that run are tested through the command
// (tests/cli/convert_test.cpp).
#include "prep/batch.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/terminal_progress.hpp"
#include "prep/prep_support.hpp"

namespace tetprep_test {
namespace {

using tetprep::ExitCode;
using tetprep::Job;
using tetprep::JobResult;
using tetprep::parse_jobs;

TEST(Batch, LinesAreConversions) {
  const auto jobs = parse_jobs(
      "a.obj\n"
      "# a comment\n"
      "   # another\n"
      "\r\n"
      " \t \n"
      "deep/b c.PLY \r\n"
      "c.obj\td.glb\tscene.tet\n"
      "e.stl\t f.tet",
      "list");
  ASSERT_EQ(jobs.size(), 4u);
  EXPECT_EQ(jobs[0].inputs, std::vector<std::string>{"a.obj"});
  EXPECT_EQ(jobs[0].output, "a.tet");
  EXPECT_EQ(jobs[0].line, 1u);
  EXPECT_EQ(jobs[1].inputs, std::vector<std::string>{"deep/b c.PLY"});
  EXPECT_EQ(jobs[1].output, "deep/b c.tet");
  EXPECT_EQ(jobs[1].line, 6u);
  EXPECT_EQ(jobs[2].inputs, (std::vector<std::string>{"c.obj", "d.glb"}));
  EXPECT_EQ(jobs[2].output, "scene.tet");
  EXPECT_EQ(jobs[3].inputs, std::vector<std::string>{"e.stl"});
  EXPECT_EQ(jobs[3].output, "f.tet");
}

TEST(Batch, AFolderIsForOutputsWithoutAName) {
  const auto jobs = parse_jobs("deep/a.obj\nb.obj\tb.tet\n", "list", "out");
  EXPECT_EQ(jobs[0].output, "out/a.tet");
  EXPECT_EQ(jobs[1].output, "b.tet");
}

TEST(Batch, OneFileForTwoIsRefused) {
  const auto refused = [](const char* list, const std::vector<std::string>& parts, const char* folder = "") {
    const auto failure = failure_of([&] { parse_jobs(list, "jobs.txt", folder); });
    EXPECT_EQ(failure.code(), ExitCode::invalid);
    EXPECT_TRUE(mentions(failure.what(), parts));
  };
  refused("a.obj\nb.obj\nx/../a.ply\n", {"jobs.txt:3", "as line 1"});
  refused("x/a.obj\ny/a.obj\n", {"jobs.txt:2", "out/a.tet", "as line 1"}, "out");
  refused("a.obj\tb.stl\n./b.stl\n", {"jobs.txt:2", "reads ./b.stl", "line 1 writes"});
  refused("a.obj\t\tb.tet\n", {"jobs.txt:1", "an empty field"});
  refused("a.obj\t\n", {"jobs.txt:1", "an empty field"});
  refused("#\n", {"jobs.txt", "no conversions"});
}

TEST(Batch, TablesAndReportsHaveALineAndAnObjectEach) {
  const std::vector<Job> jobs = parse_jobs("a.obj\nb\nb2\tb3.tet\n", "list");
  JobResult good, bad;
  good.code = ExitCode::ok;
  good.outcome = "ok";
  good.triangles = 12;
  good.tets = 34;
  good.seconds = 1.234;
  good.peak_memory_mb = 56.7;
  good.report = R"({"outcome": "ok"})";
  bad.code = ExitCode::io;
  bad.outcome = "io";
  bad.error = "b: cannot\tbe read";
  bad.report = R"({"outcome": "io"})";
  const std::string table = tetprep::to_table(jobs, {good, bad, good});
  EXPECT_EQ(table,
            "file\ttriangles\toutcome\tseconds\tmemory_mb\ttets\tdetail\n"
            "a.obj\t12\tok\t1.23\t57\t34\ta.tet\n"
            "b\t0\tio\t0.00\t0\t0\tb: cannot\\x09be read\n"
            "b2\t12\tok\t1.23\t57\t34\tb3.tet\n");
  const auto json = nlohmann::json::parse(tetprep::to_json(jobs, {good, bad, good}));
  EXPECT_EQ(json["conversions"], 3);
  EXPECT_EQ(json["failed"], 1);
  EXPECT_EQ(json["jobs"][1]["outcome"], "io");
}

TEST(ProgressLine, TellsShareTimeAndWhatIsLeft) {
  using tetprep::progress_line;
  EXPECT_EQ(progress_line("read", -1, 0.2, 80), "read  0 s");
  EXPECT_EQ(progress_line("sort", 0.5, 10, 80),
            "sort  [############            ] 50 %  10 s, about 10 s left");
  EXPECT_EQ(progress_line("sort", 0.25, 100, 80),
            "sort  [######                  ] 25 %  1 min 40 s, about 5 min 0 s left");
  EXPECT_EQ(progress_line("sort", 0.001, 100, 80), "sort  [                        ] 0 %  1 min 40 s");
  EXPECT_EQ(progress_line("sort", 2, 3, 80), "sort  [########################] 100 %  3 s");
  EXPECT_EQ(progress_line("sort", 0.5, 10, 20), "sort  [############ ");
}

}  // namespace
}  // namespace tetprep_test
