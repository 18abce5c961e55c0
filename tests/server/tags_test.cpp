// Solves found and deleted by their tags and titles.

#include "becomes.hpp"
#include "running_service.hpp"

#include <algorithm>

#include "temporary_directory.hpp"

namespace signorini::server::tags_test {
namespace {

using nlohmann::json;
using Names = std::vector<std::string>;

/// Both stores.
class Tagged : public testing::TestWithParam<bool> {
 protected:
  Tagged() {
    ServiceOptions options;
    options.queue_limit = 20;
    if (GetParam()) options.data_dir = directory_.path();
    service_ = std::make_unique<RunningService>(options);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", service_->port());
    client_->set_read_timeout(100);
    client_->set_url_encode(false);
  }

  httplib::Result post(const std::string& title, const Names& tags, const std::string& query = "?wait=10") {
    json problem = json::parse(problem_titled(title));
    problem["tags"] = tags;
    return client_->Post("/v1/solves" + query, problem.dump(), "application/json");
  }
  std::string solved(const std::string& title, const Names& tags) {
    return json::parse(post(title, tags)->body).at("id");
  }
  httplib::Result remove(const std::string& query) { return client_->Delete("/v1/solves" + query); }

  /// The titles of all pages.
  Names titles(json next) {
    Names titles;
    while (next.is_string()) {
      const json page = json::parse(client_->Get(next)->body);
      for (const json& solve : page.at("solves")) titles.push_back(solve.at("title"));
      next = page.at("links").at("next");
    }
    return titles;
  }

  TemporaryDirectory directory_;
  std::unique_ptr<RunningService> service_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_P(Tagged, StandInTheStatusDocumentAndFilterLists) {
  const Names odd{"<script>alert(1)</script>", "a&b=c %+", "\xc3\xbc"};
  const json accepted = json::parse(post("one", odd, "")->body);
  EXPECT_EQ(accepted.at("tags"), odd);
  for (const char* title : {"two", "three", "four"}) solved(title, {"t"});
  solved("TWO more", {"t", "\xc3\xbc"});
  EXPECT_EQ(titles("/v1/solves?tag=t&limit=1"), (Names{"TWO more", "four", "three", "two"}));
  EXPECT_EQ(titles("/v1/solves?tag=%C3%BC&limit=1"), (Names{"TWO more", "one"}));
  EXPECT_EQ(titles("/v1/solves?tag=a%26b%3Dc%20%25%2B&limit=1"), (Names{"one"}));
  EXPECT_EQ(titles("/v1/solves?tag=%3Cscript%3Ealert%281%29%3C/script%3E"), (Names{"one"}));
  EXPECT_EQ(titles("/v1/solves?title=two&limit=1"), (Names{"TWO more", "two"}));
  EXPECT_EQ(titles("/v1/solves?title=o%20m&tag=t&status=succeeded"), (Names{"TWO more"}));
  EXPECT_EQ(titles("/v1/solves?tag=none"), Names{});
  // A cursor of another list is a place in time.
  const json page = json::parse(client_->Get("/v1/solves?tag=t&limit=2")->body);
  const std::string last = page.at("solves")[1].at("id");
  EXPECT_EQ(titles("/v1/solves?title=two&after=" + last), (Names{"two"}));
}

TEST_P(Tagged, AreAskedForByWhatATagMayBe) {
  const std::string long_title(801, 'x');
  for (const std::string& query :
       {std::string("tag="), std::string("tag=%00"), std::string("tag=a%0Ab"), "tag=" + std::string(51, 'x'),
        std::string("title="), "title=" + long_title, std::string("tag=a&tag=b")}) {
    const json problem = expect_problem(client_->Get("/v1/solves?" + query), 400);
    EXPECT_TRUE(problem.at("errors").at(0).contains("parameter")) << query;
  }
  // Bytes that are no UTF-8 are in no tag.
  EXPECT_EQ(titles("/v1/solves?tag=%FF%FE&title=%C3"), Names{});
  expect_problem(remove("?tag=%FF%FE"), 409);
}

TEST_P(Tagged, AreDeletedOnceTheirNumberIsConfirmed) {
  for (int i = 0; i < 3; ++i) solved("instant", {"t", "u"});
  solved("instant", {"u"});
  const std::string running = json::parse(post("slow", {"t"}, "")->body).at("id");
  for (const char* query : {"?tag=t", "?tag=t&confirm=3", "?tag=t&confirm=0"}) {
    const json refusal = expect_problem(remove(query), 409);
    EXPECT_EQ(refusal.at("type"), "urn:signorini:problem:confirmation-needed");
    EXPECT_EQ(refusal.at("count"), 4) << refusal;
  }
  EXPECT_EQ(titles("/v1/solves").size(), 5u);
  const auto done = remove("?tag=t&confirm=4");
  ASSERT_EQ(done->status, 200) << done->body;
  EXPECT_EQ(json::parse(done->body), (json{{"cancelled", 1}, {"deleted", 3}}));
  EXPECT_EQ(titles("/v1/solves?tag=u").size(), 1u);
  EXPECT_TRUE(becomes([&] { return titles("/v1/solves?status=running").size() != 1; }));
  EXPECT_EQ(json::parse(client_->Get("/v1/solves/" + running)->body).at("status"), "cancelled");
  EXPECT_EQ(json::parse(remove("?tag=t&confirm=1")->body), (json{{"cancelled", 0}, {"deleted", 1}}));
  EXPECT_EQ(remove("?tag=t&confirm=0")->status, 200);
}

TEST_P(Tagged, AreNeverAllSolvesAtOnce) {
  solved("instant", {});
  for (const char* query : {"", "?tag=", "?confirm=1", "?status=succeeded", "?title=instant&confirm=1",
                            "?tag=t&confirm=-1", "?tag=t&confirm=all", "?tag=t&status=failed"}) {
    EXPECT_EQ(remove(query)->status, 400) << query;
  }
  EXPECT_EQ(titles("/v1/solves").size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Stores, Tagged, testing::Bool());

}  // namespace
}  // namespace signorini::server::tags_test
