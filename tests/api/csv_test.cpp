#include "api/result/csv.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "written_by.hpp"

namespace signorini::api::csv_test {
namespace {

std::string contact_csv(const std::vector<ContactPart>& parts) {
  return written_by([&](const Sink& sink) { return write_contact_csv(parts, sink); });
}

std::string history_csv(const std::vector<Iteration>& history) {
  return written_by([&](const Sink& sink) { return write_history_csv(history, sink); });
}

const std::string contact_header = "part,x,y,clearance,pressure,gap,open\r\n";

/// The first field of the only row of a table, whose part has this name.
std::string field_with_name(const std::string& name) {
  const std::string table = contact_csv({{name, {{0, 0}}, {0}, {0}, {0}, {1}, {false}}});
  EXPECT_TRUE(table.starts_with(contact_header));
  const std::string rest = ",0,0,0,0,0,false\r\n";
  EXPECT_TRUE(table.ends_with(rest)) << table;
  return table.substr(contact_header.size(), table.size() - contact_header.size() - rest.size());
}

TEST(ContactCsv, HasARowAContactEdgeOrNode) {
  const std::vector<ContactPart> parts{
      {"bottom", {{0.5, 0}, {1.5, -1}}, {0.25, 0}, {0, 0.1}, {0.25, 1e-9}, {1, 1}, {true, false}},
      {"top", {{1, 2}}, {3}, {4}, {5}, {1}, {true}}};
  EXPECT_EQ(contact_csv(parts), contact_header +
                                    "bottom,0.5,0,0.25,0,0.25,true\r\n"
                                    "bottom,1.5,-1,0,0.1,1e-09,false\r\n"
                                    "top,1,2,3,4,5,true\r\n");
  EXPECT_EQ(contact_csv({}), contact_header);
}

TEST(ContactCsv, QuotesNamesThatNeedIt) {
  EXPECT_EQ(field_with_name("left, upper"), "\"left, upper\"");
  EXPECT_EQ(field_with_name("the \"foot\""), "\"the \"\"foot\"\"\"");
  EXPECT_EQ(field_with_name("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(field_with_name("a=b-c Fuß"), "a=b-c Fuß");
  EXPECT_EQ(field_with_name(""), "");
}

TEST(ContactCsv, NeverLetsANameBecomeAFormula) {
  EXPECT_EQ(field_with_name("=1+1"), "'=1+1");
  EXPECT_EQ(field_with_name("+1"), "'+1");
  EXPECT_EQ(field_with_name("-1"), "'-1");
  EXPECT_EQ(field_with_name("@sum"), "'@sum");
  EXPECT_EQ(field_with_name("\t=1"), "'\t=1");
  EXPECT_EQ(field_with_name("\r=1"), "\"'\r=1\"");
  EXPECT_EQ(field_with_name("=A1,\"x\""), "\"'=A1,\"\"x\"\"\"");
  EXPECT_EQ(field_with_name("'quoted"), "''quoted");
}

TEST(HistoryCsv, HasTheColumnsOfTheJson) {
  Iteration first, second;
  first.number = 1;
  first.clearance_change = 0.5;
  first.tension = 1e-3;
  first.active = 100'000;
  second.number = 2;
  second.seconds = 0.25;
  EXPECT_EQ(history_csv({first, second}),
            "iteration,clearance_change,equilibrium,penetration,tension,complementarity,active,seconds\r\n"
            "1,0.5,0,0,0.001,0,100000,0\r\n"
            "2,0,0,0,0,0,0,0.25\r\n");
}

TEST(HistoryCsv, HasTheCriterionOfThePaperInThePapersForm) {
  Iteration iteration;
  iteration.number = 1;
  iteration.displacement_change = 0.1;
  EXPECT_TRUE(history_csv({iteration}).starts_with("iteration,displacement_change,clearance_change,"));
  EXPECT_NE(history_csv({iteration}).find("\r\n1,0.1,0,"), std::string::npos);
}

TEST(HistoryCsv, NeverWritesANumberThatIsNotFinite) {
  Iteration iteration;
  iteration.equilibrium = std::nan("");
  EXPECT_THROW(history_csv({iteration}), std::logic_error);
}

TEST(HistoryCsv, ComesInPiecesAndStopsWhenNobodyReads) {
  const std::vector<Iteration> history(50'000);
  int pieces = 0;
  EXPECT_FALSE(write_history_csv(history, [&](std::string_view) { return ++pieces < 3; }));
  EXPECT_EQ(pieces, 3);
}

}  // namespace
}  // namespace signorini::api::csv_test
