#include <gtest/gtest.h>

#include "server/http/error.hpp"
#include "server/http/field_value.hpp"
#include "server/http/media_type.hpp"
#include "server/http/query.hpp"
#include "server/http/router.hpp"

namespace signorini::server::negotiation_test {
namespace {

TEST(ContentType, KnowsJson) {
  EXPECT_TRUE(is_json("application/json"));
  EXPECT_TRUE(is_json("Application/JSON; charset=utf-8"));
  EXPECT_TRUE(is_json("application/geo+json"));
  EXPECT_FALSE(is_json("text/json"));
  EXPECT_FALSE(is_json("application/jsonp"));
  EXPECT_FALSE(is_json("application/x-www-form-urlencoded"));
  EXPECT_FALSE(is_json(""));
  EXPECT_FALSE(is_json("application/cbor"));
  EXPECT_TRUE(is_cbor("application/cbor"));
  EXPECT_TRUE(is_cbor("application/geo+cbor; q=1"));
  EXPECT_FALSE(is_cbor("application/json"));
}

TEST(Accept, TakesTheMostSpecificRange) {
  const auto accepts = [](const std::optional<std::string>& accept) {
    return preferred(accept, {"application/json"}).has_value();
  };
  EXPECT_TRUE(accepts(std::nullopt));
  EXPECT_TRUE(accepts("*/*"));
  EXPECT_TRUE(accepts("text/html, application/*;q=0.1"));
  EXPECT_FALSE(accepts("text/html"));
  EXPECT_FALSE(accepts("*/*, application/json;q=0"));
  EXPECT_TRUE(accepts("*/*;q=0, application/json"));
}

TEST(Accept, TakesEverythingIfItIsEmpty) {
  EXPECT_EQ(preferred("", {"text/html"}), "text/html");
  EXPECT_EQ(preferred(" , ", {"text/html", "text/csv"}), "text/html");
}

TEST(Accept, PrefersTheLargestWeightThenTheNamedThenTheFirstType) {
  const auto chosen = [](const std::optional<std::string>& accept) {
    return preferred(accept, {"application/json", "application/cbor"}).value_or("none");
  };
  const std::string json = "application/json", cbor = "application/cbor";
  EXPECT_EQ(chosen(std::nullopt), json);
  EXPECT_EQ(chosen("*/*"), json);
  EXPECT_EQ(chosen("application/cbor, */*"), cbor);
  EXPECT_EQ(chosen("application/cbor;q=0.5, */*"), json);
  EXPECT_EQ(chosen("Application/CBOR"), cbor);
  EXPECT_EQ(chosen("application/json;q=0.5, application/cbor;q=0.9"), cbor);
  EXPECT_EQ(chosen("application/*, application/json;q=0"), cbor);
  EXPECT_EQ(chosen("text/html"), "none");
}

TEST(Accept, IsNotSplitWithinQuotes) {
  const std::string json = "application/json", cbor = "application/cbor";
  EXPECT_EQ(preferred(R"(text/html;x="a, application/cbor")", {json, cbor}), std::nullopt);
  EXPECT_EQ(preferred(R"(application/json;x="\"; q=0", text/html)", {json, cbor}), json);
}

TEST(Prefer, IsReadAsItsRfcSays) {
  const auto wait = [](std::string_view prefer) { return preference(prefer, "wait"); };
  for (const char* prefer : {"wait=5", "Wait=5", "WAIT = 5", "wait\t=\t5", R"(wait="5")", R"(wait = "\5")",
                             "respond-async,wait=5", " , wait=5;x=1, wait=7", R"(foo="a,wait=7", wait=5)",
                             R"(foo="\",wait=7", wait=5)", R"(foo; x="a;wait=7,wait=8", wait=5)"})
    EXPECT_EQ(wait(prefer), "5") << prefer;
  for (const char* prefer : {"", "respond-async", R"(foo="a,wait=5")", R"(foo="a,wait=5)",
                             R"(foo="\",wait=5")", "foo;wait=5", "await=5", "wait-5", "wait5"})
    EXPECT_EQ(wait(prefer), std::nullopt) << prefer;
  for (const char* prefer : {"wait", "wait=", R"(wait="")", "wait, wait=5", "wait;x=5, wait=5"})
    EXPECT_EQ(wait(prefer), "") << prefer;
}

TEST(AcceptEncoding, HonoursWeightZero) {
  EXPECT_TRUE(accepts_coding("br, gzip", "gzip"));
  EXPECT_FALSE(accepts_coding("gzip;q=0", "gzip"));
  EXPECT_FALSE(accepts_coding("", "gzip"));
  EXPECT_FALSE(accepts_coding("br, gzip;q=0.0, *", "gzip"));
}

/// RFC 9110, 8.4.1.3.
TEST(AcceptEncoding, KnowsGzipByItsOldName) {
  EXPECT_TRUE(accepts_coding("x-gzip", "gzip"));
  EXPECT_TRUE(accepts_coding("br, X-GZIP;q=0.5", "gzip"));
  EXPECT_FALSE(accepts_coding("x-gzip;q=0, *", "gzip"));
}

TEST(AcceptEncoding, HonoursTheRankOfAPlainBody) {
  EXPECT_TRUE(accepts_coding("*", "gzip"));
  EXPECT_TRUE(accepts_coding("identity;q=0.5, gzip", "gzip"));
  EXPECT_TRUE(accepts_coding("identity;q=0, *;q=0.1", "gzip"));
  EXPECT_FALSE(accepts_coding("gzip;q=0.5, identity", "gzip"));
  EXPECT_FALSE(accepts_coding("deflate, br", "gzip"));
}

TEST(Query, NumbersAreWholeAndInRange) {
  EXPECT_EQ(integer_parameter({{"limit", "7"}}, "limit", 1, 10), 7);
  EXPECT_EQ(integer_parameter({}, "limit", 1, 10), std::nullopt);
  for (const char* bad : {"", "0", "11", "7x", " 7", "1e1", "99999999999999999999"}) {
    EXPECT_THROW(integer_parameter({{"limit", bad}}, "limit", 1, 10), HttpError) << bad;
  }
  for (const char* bad : {"nan", "inf", "-1", "3600.5"}) {
    EXPECT_THROW(number_parameter({{"wait", bad}}, "wait", 0, 3600), HttpError) << bad;
  }
}

TEST(Query, HasNoParameterWithoutAValue) {
  EXPECT_NO_THROW(allow_only({{"limit", "7"}}, {"limit"}));
  for (const char* query : {"limit=", "limit", "limit=&after=x"})
    EXPECT_THROW(allow_only(read_query(query), {"limit", "after"}), HttpError) << query;
}

Request request_for(const std::string& method, const std::string& path) {
  Request request;
  request.method = method;
  request.path = path;
  return request;
}

TEST(Router, BindsPathParameters) {
  Access access;
  const Router router(
      {{"GET",
        "/things/{id}/part",
        {},
        [](const Request& request) { return Response::json(200, request.path_parameters.at("id")); }}},
      access);
  Request request = request_for("HEAD", "/things/7/part");
  EXPECT_EQ(router.route(request).body, "7");
  EXPECT_EQ(request.route, "/things/{id}/part");
  for (const char* path : {"/things/7", "/things/7/part/", "/things/7/parts", "/", "", "//things/7/part"}) {
    Request other = request_for("GET", path);
    EXPECT_THROW(router.route(other), HttpError) << path;
  }
}

}  // namespace
}  // namespace signorini::server::negotiation_test
