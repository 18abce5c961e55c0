#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "formula/formula.hpp"

namespace signorini {
namespace {

using Instruction = Formula::Instruction;

/// How many arguments a function takes; the last two take any number and are folded.
struct Function {
  Operation operation;
  int arguments;
};
constexpr int kAny = -1;

const std::map<std::string_view, Function>& functions() {
  static const std::map<std::string_view, Function> all{
      {"abs", {Operation::abs, 1}},     {"acos", {Operation::acos, 1}},   {"acosh", {Operation::acosh, 1}},
      {"asin", {Operation::asin, 1}},   {"asinh", {Operation::asinh, 1}}, {"atan", {Operation::atan, 1}},
      {"atan2", {Operation::atan2, 2}}, {"atanh", {Operation::atanh, 1}}, {"avg", {Operation::divide, kAny}},
      {"cos", {Operation::cos, 1}},     {"cosh", {Operation::cosh, 1}},   {"exp", {Operation::exp, 1}},
      {"ln", {Operation::ln, 1}},       {"log", {Operation::log, 1}},     {"log10", {Operation::log10, 1}},
      {"log2", {Operation::log2, 1}},   {"max", {Operation::max, kAny}},  {"min", {Operation::min, kAny}},
      {"rint", {Operation::rint, 1}},   {"sign", {Operation::sign, 1}},   {"sin", {Operation::sin, 1}},
      {"sinh", {Operation::sinh, 1}},   {"sqrt", {Operation::sqrt, 1}},   {"sum", {Operation::add, kAny}},
      {"tan", {Operation::tan, 1}},     {"tanh", {Operation::tanh, 1}}};
  return all;
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Operators with two operands by how strongly they bind.
struct Binary {
  std::string_view sign;
  Operation operation;
  int strength;
};
constexpr int kSum = 4, kProduct = 5, kPower = 6;
constexpr Binary kBinaries[] = {{"||", Operation::either, 1},
                                {"&&", Operation::both, 2},
                                {"<=", Operation::less_equal, 3},
                                {">=", Operation::greater_equal, 3},
                                {"==", Operation::equal, 3},
                                {"!=", Operation::unequal, 3},
                                {"<", Operation::less, 3},
                                {">", Operation::greater, 3},
                                {"+", Operation::add, kSum},
                                {"-", Operation::subtract, kSum},
                                {"*", Operation::multiply, kProduct},
                                {"/", Operation::divide, kProduct},
                                {"^", Operation::power, kPower}};

/// Recursive descent; each function appends the program of what it has read.
class Parser {
 public:
  Parser(std::string_view text, bool on_boundary) : text_(text), on_boundary_(on_boundary) {}

  Formula parse() {
    expression();
    if (peek() == ',') fail("these are several expressions, separated by commas; give one");
    if (at_ < text_.size()) fail("an operator is missing, or something is left over");
    return Formula(std::move(program_));
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::invalid_argument(why + ", at character " + std::to_string(at_ + 1));
  }

  char peek() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos)
      ++at_;
    return at_ < text_.size() ? text_[at_] : '\0';
  }

  bool accept(char c) {
    if (peek() != c) return false;
    ++at_;
    return true;
  }

  void append(Operation operation) { program_.push_back({operation}); }

  void expression() {
    binary(1);
    if (!accept('?')) return;
    expression();
    if (!accept(':')) fail("\"? :\" has no \":\"");
    expression();
    append(Operation::choose);
  }

  const Binary* next_operator() {
    peek();
    const std::string_view rest = text_.substr(at_);
    for (const Binary& own : kBinaries)
      if (rest.starts_with(own.sign)) return &own;
    return nullptr;
  }

  /// Operators that bind at least so strongly.
  void binary(int weakest) {
    if (const char sign = peek(); sign == '-' || sign == '+') {
      ++at_;
      if (const char second = peek(); second == '-' || second == '+') fail("a sign follows a sign");
      binary(kPower);
      if (sign == '-') append(Operation::negate);
    } else {
      operand();
    }
    for (const Binary* own = next_operator(); own && own->strength >= weakest; own = next_operator()) {
      at_ += own->sign.size();
      binary(own->strength == kPower ? kPower : own->strength + 1);
      append(own->operation);
    }
  }

  void operand() {
    const char c = peek();
    if (is_digit(c) || c == '.') return number();
    if (is_letter(c)) return name();
    if (!accept('(')) fail("a number, a name or \"(\" is missing");
    expression();
    if (!accept(')')) fail("a \")\" is missing");
  }

  void number() {
    double value = 0;
    const char* begin = text_.data() + at_;
    const auto [end, fault] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (fault != std::errc() || !std::isfinite(value)) fail("this is no number that a double holds");
    at_ += static_cast<std::size_t>(end - begin);
    if (at_ < text_.size() && (is_letter(text_[at_]) || text_[at_] == '.')) fail("this is no number");
    program_.push_back({Operation::constant, value});
  }

  void name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view own = text_.substr(begin, at_ - begin);
    if (own == "pi") return program_.push_back({Operation::constant, std::numbers::pi});
    if (own == "x") return append(Operation::x);
    if (own == "y") return append(Operation::y);
    if (on_boundary_ && own == "nx") return append(Operation::nx);
    if (on_boundary_ && own == "ny") return append(Operation::ny);
    const auto found = functions().find(own);
    if (found == functions().end()) fail("\"" + std::string(own) + "\" is not known");
    call(own, found->second);
  }

  void call(std::string_view own, const Function& function) {
    if (!accept('(')) fail("the function \"" + std::string(own) + "\" has no argument");
    // Any number of arguments are folded from the left; their mean is a sum at first.
    const bool folds = function.arguments == kAny, is_mean = function.operation == Operation::divide;
    int count = 0;
    do {
      expression();
      if (++count > 1 && folds) append(is_mean ? Operation::add : function.operation);
    } while (accept(','));
    if (!accept(')')) fail("a \")\" is missing");
    if (!folds && count != function.arguments)
      fail("\"" + std::string(own) + "\" takes " + std::to_string(function.arguments) + " argument" +
           (function.arguments == 1 ? "" : "s"));
    if (is_mean) program_.push_back({Operation::constant, static_cast<double>(count)});
    if (is_mean || !folds) append(function.operation);
  }

  std::string_view text_;
  bool on_boundary_;
  std::size_t at_ = 0;
  std::vector<Instruction> program_;
};

}  // namespace

const std::vector<std::string_view>& function_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const auto& [name, function] : functions()) all.push_back(name);
    return all;
  }();
  return names;
}

Formula parse_formula(std::string_view text, bool on_boundary) {
  return Parser(text, on_boundary).parse();
}

}  // namespace signorini
