#include "running_service.hpp"

namespace signorini::server::downloads_test {
namespace {

using nlohmann::json;

class Downloads : public ServiceTest {
 protected:
  /// The path of an ended solve.
  std::string solved(const std::string& title) {
    return "/v1/solves/" + std::string(json::parse(post(title, "?wait=60&fields=summary")->body).at("id"));
  }
};

const std::vector<std::string> files{"/result.vtu", "/picture.svg", "/history.csv", "/contact.csv",
                                     "/quantities.csv"};

TEST_F(Downloads, AreLinkedFromTheStatus) {
  const std::string path = solved("touches");
  const json links = json::parse(get(path)->body).at("links");
  EXPECT_EQ(links.at("vtu"), path + "/result.vtu");
  EXPECT_EQ(links.at("picture"), path + "/picture.svg");
  EXPECT_EQ(links.at("history_csv"), path + "/history.csv");
  EXPECT_EQ(links.at("contact_csv"), path + "/contact.csv");
  EXPECT_EQ(links.at("quantities_csv"), path + "/quantities.csv");
}

TEST_F(Downloads, SayWhatTheyAreAndHowToCallThem) {
  const std::string path = solved("touches"), id = path.substr(path.rfind('/') + 1);
  const auto expect_file = [&](const std::string& file, const std::string& type, const std::string& name) {
    const auto reply = get(path + file);
    ASSERT_TRUE(reply) << file;
    EXPECT_EQ(reply->status, 200) << reply->body;
    EXPECT_EQ(reply->get_header_value("Content-Type"), type);
    EXPECT_EQ(reply->get_header_value("Content-Disposition"), "attachment; filename=\"" + id + name + "\"");
  };
  expect_file("/result.vtu", "application/vnd.vtk", ".vtu");
  expect_file("/history.csv", "text/csv; charset=utf-8", "-history.csv");
  expect_file("/contact.csv", "text/csv; charset=utf-8", "-contact.csv");
  expect_file("/quantities.csv", "text/csv; charset=utf-8", "-quantities.csv");
}

TEST_F(Downloads, HoldTheResult) {
  const std::string path = solved("touches");
  EXPECT_EQ(get(path + "/contact.csv")->body,
            "part,x,y,clearance,pressure,gap,open\r\nfloor,0.5,0,0,2.5,0.25,false\r\n");
  EXPECT_EQ(get(path + "/quantities.csv")->body,
            "name,value,estimate,lower,upper,guaranteed\r\ngrip,2.5,2.5,2,3,true\r\n");
  const std::string history = get(path + "/history.csv")->body;
  EXPECT_TRUE(history.starts_with("iteration,clearance_change,")) << history;
  EXPECT_NE(history.find("\r\n3,0,"), std::string::npos);
  const std::string vtu = get(path + "/result.vtu")->body;
  EXPECT_NE(vtu.find("<Piece NumberOfPoints=\"9\" NumberOfCells=\"4\">"), std::string::npos);
  EXPECT_TRUE(vtu.ends_with("</VTKFile>\n"));
}

TEST_F(Downloads, HoldThePictureThatIsAskedFor) {
  const std::string path = solved("touches") + "/picture.svg";
  const auto picture = get(path);
  EXPECT_EQ(picture->status, 200) << picture->body;
  EXPECT_EQ(picture->get_header_value("Content-Type"), "image/svg+xml");
  EXPECT_NE(picture->body.find("<title>displacement</title>"), std::string::npos);
  EXPECT_NE(get(path + "?field=contact")->body.find("floor: pressure"), std::string::npos);
  for (const std::string query :
       {"field=strain", "field=von_mises", "deformed=1", "deformed=-1", "scale=2"}) {
    const json problem = expect_problem(get(path + "?" + query), 400);
    EXPECT_EQ(problem.at("errors").at(0).at("parameter"), query.substr(0, query.find('='))) << query;
  }
}

TEST_F(Downloads, AreThereForTheLastIterateOfAMethodThatDiverged) {
  const std::string path = solved("diverges");
  for (const std::string& file : files) EXPECT_EQ(get(path + file)->status, 200) << file;
}

TEST_F(Downloads, HaveTheErrorsOfTheResult) {
  const std::string running = "/v1/solves/" + submit("slow"), failed = solved("no memory");
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    expect_problem(get("/v1/solves/unknown" + file), 404);
    expect_problem(get(running + file), 409);
    expect_problem(get(failed + file), 410);
    expect_problem(get(failed + file + "?fields=mesh"), 400);
    expect_problem(client_.Post(failed + file, "{}", "application/json"), 405);
  }
}

TEST_F(Downloads, HonourTheAcceptHeader) {
  const std::string path = solved("touches");
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    expect_problem(client_.Get(path + file, {{"Accept", "application/json"}}), 406);
    EXPECT_EQ(client_.Get(path + file, {{"Accept", "*/*"}})->status, 200);
    EXPECT_EQ(
        client_.Get(path + file, {{"Accept", "text/csv;q=0.5, application/vnd.vtk, image/*;q=0.1"}})->status,
        200);
  }
}

TEST_F(Downloads, AreStreamedPlainAndCompressed) {
  const std::string path = solved("large") + "/history.csv";
  const auto plain = client_.Get(path);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->get_header_value("Transfer-Encoding"), "chunked");
  EXPECT_EQ(std::ranges::count(plain->body, '\n'), 100'001);
  const auto compressed = client_.Get(path, {{"Accept-Encoding", "gzip"}});
  ASSERT_TRUE(compressed);
  EXPECT_EQ(compressed->get_header_value("Content-Encoding"), "gzip");
  EXPECT_EQ(compressed->body, plain->body);
}

TEST_F(Downloads, SayTheirLengthIfTheyAreShort) {
  const std::string path = solved("touches");
  for (const std::string& file : files) {
    const auto reply = get(path + file);
    EXPECT_EQ(reply->get_header_value("Content-Length"), std::to_string(reply->body.size())) << file;
    EXPECT_FALSE(reply->has_header("Transfer-Encoding")) << file;
    EXPECT_EQ(client_.Head(path + file)->get_header_value("Content-Length"),
              std::to_string(reply->body.size()));
  }
}

TEST_F(Downloads, OfABodyHaveTheInvariantsOfItsStress) {
  const std::string path = solved("elastic");
  EXPECT_NE(get(path + "/result.vtu")->body.find("Name=\"von_mises\""), std::string::npos);
  const json result = json::parse(get(path + "/result?fields=principal,von_mises")->body);
  EXPECT_EQ(result.at("principal"), json::parse("[[2, 0]]"));
  EXPECT_EQ(result.at("von_mises"), json::parse("[2]"));
}

TEST_F(Downloads, RefuseTheInvariantsForAMembrane) {
  const std::string path = solved("touches");
  for (const std::string member : {"principal", "von_mises"}) {
    const json problem = expect_problem(get(path + "/result?fields=" + member), 400);
    EXPECT_EQ(problem.at("errors").at(0).at("parameter"), "fields");
    EXPECT_NE(problem.at("detail").get<std::string>().find("a membrane has no"), std::string::npos);
    expect_problem(post("instant", "?wait=60&fields=" + member), 400);
  }
  EXPECT_EQ(json::parse(get("/v1/solves")->body).at("solves").size(), 1u) << "refused before it is queued";
}

}  // namespace
}  // namespace signorini::server::downloads_test
