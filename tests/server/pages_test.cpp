#include "server/handlers/pages.hpp"

#include <map>
#include <regex>
#include <set>

#include "api/examples.hpp"
#include "running_service.hpp"

namespace signorini::server::pages_test {
namespace {

/// What Chromium and Firefox send for a page.
const httplib::Headers browser{
    {"Accept", "text/html,application/xhtml+xml,application/xml;q=0.9,image/avif,*/*;q=0.8"}};

class PagesTest : public ServiceTest {};

TEST_F(PagesTest, AreForBrowsersAndDocumentsForPrograms) {
  const std::string solve = "/v1/solves/" + submit("instant");
  for (const std::string& path : {std::string("/v1/solves"), solve, std::string("/v1/examples/gap-sweep")}) {
    const auto page = client_.Get(path, browser);
    EXPECT_EQ(page->status, 200) << path;
    EXPECT_EQ(page->get_header_value("Content-Type"), "text/html; charset=utf-8") << path;
    for (const char* accept : {"*/*", "application/json", "application/*, text/html;q=0.9"}) {
      const auto document = client_.Get(path, {{"Accept", accept}});
      EXPECT_EQ(document->get_header_value("Content-Type"), "application/json") << path << accept;
    }
    EXPECT_EQ(get(path)->get_header_value("Content-Type"), "application/json") << path;
    expect_problem(client_.Get(path, {{"Accept", "image/png"}}), 406);
    EXPECT_NE(page->get_header_value("Vary").find("Accept"), std::string::npos);
  }
  expect_problem(client_.Get("/v1/examples", {{"Accept", "text/html"}}), 406);
}

TEST_F(PagesTest, HaveOneShellAndTheirOwnTitlesStylesAndScripts) {
  const std::map<std::string, std::string> titles{{"/", "Signorini"},
                                                  {"/docs", "The interface · Signorini"},
                                                  {"/v1/solves", "Solves · Signorini"},
                                                  {"/v1/solves/" + submit("instant"), "Solve · Signorini"},
                                                  {"/v1/examples/gap-sweep", "Example · Signorini"}};
  std::set<std::string> scripts;
  for (const auto& [path, title] : titles) {
    const auto page = client_.Get(path, browser);
    ASSERT_EQ(page->status, 200) << path;
    EXPECT_NE(page->body.find("<title>" + title + "</title>"), std::string::npos) << page->body;
    EXPECT_EQ(page->get_header_value("Content-Security-Policy"),
              get("/pages/page.css")->get_header_value("Content-Security-Policy"));
    const std::regex loaded("(?:href|src)=\"([^\"]*)\"");
    std::string last;
    for (std::sregex_iterator each(page->body.begin(), page->body.end(), loaded), end; each != end; ++each) {
      last = (*each)[1];
      EXPECT_EQ(get(last)->status, 200) << last;
    }
    scripts.insert(last);
  }
  EXPECT_EQ(scripts.size(), titles.size());
}

TEST_F(PagesTest, LoadNothingFromElsewhere) {
  for (const PageFile& file : page_files()) {
    const auto reply = get("/pages/" + std::string(file.name));
    ASSERT_EQ(reply->status, 200) << file.name;
    EXPECT_EQ(reply->body, file.text);
    const std::string policy = reply->get_header_value("Content-Security-Policy");
    EXPECT_TRUE(policy.starts_with("default-src 'self'; ")) << policy;
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    std::string text(file.text);
    const std::string svg = "http://www.w3.org/2000/svg";
    for (std::size_t at = text.find(svg); at != std::string::npos; at = text.find(svg))
      text.erase(at, svg.size());
    EXPECT_EQ(text.find("://"), std::string::npos) << file.name;
  }
  EXPECT_EQ(get("/pages/page.css")->get_header_value("Content-Type"), "text/css; charset=utf-8");
  EXPECT_EQ(get("/pages/shell.js")->get_header_value("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(get("/pages/icon.svg")->get_header_value("Content-Type"), "image/svg+xml");
  expect_problem(get("/pages/none.js"), 404);
}

TEST_F(PagesTest, AreLight) {
  client_.set_decompress(false);
  std::size_t plain = 0, packed = 0;
  for (const PageFile& file : page_files()) {
    plain += file.text.size();
    packed += client_.Get("/pages/" + std::string(file.name), {{"Accept-Encoding", "gzip"}})->body.size();
  }
  EXPECT_LE(plain, 150 * 1024);
  EXPECT_LE(packed, 50 * 1024);
}

TEST_F(PagesTest, ShowEveryExampleAsAPicture) {
  for (const api::Example& example : api::examples()) {
    const auto reply = get("/v1/examples/" + std::string(example.name) + "/picture.svg");
    ASSERT_EQ(reply->status, 200) << example.name;
    EXPECT_EQ(reply->get_header_value("Content-Type"), "image/svg+xml");
    EXPECT_TRUE(reply->body.starts_with("<svg ")) << example.name;
    EXPECT_TRUE(reply->body.ends_with("</svg>\n")) << example.name;
    const auto plain = client_.Get("/v1/examples/" + std::string(example.name) + "/picture.svg",
                                   {{"Accept-Encoding", "identity"}});
    EXPECT_FALSE(plain->has_header("Content-Encoding")) << example.name;
    EXPECT_EQ(plain->body, reply->body) << example.name;
  }
  expect_problem(get("/v1/examples/none/picture.svg"), 404);
}

}  // namespace
}  // namespace signorini::server::pages_test
