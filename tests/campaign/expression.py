"""The expressions of a problem document, as functions of arrays of points.

    ternary = or ["?" ternary ":" ternary]        all operators as in C, but ^ is the power
    power   = atom ["^" unary]                     to the right; -x^2 is -(x^2)
"""
import re

import numpy as np

TOKEN = re.compile(r"\s*(?:((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|([A-Za-z_]\w*)|(&&|\|\||[<>=!]=|[-+*/^()<>?:,]))")

FUNCTIONS = {"sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan,
             "atan2": np.arctan2, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh, "exp": np.exp, "log": np.log,
             "log2": np.log2, "log10": np.log10, "sqrt": np.sqrt, "abs": np.abs, "sign": np.sign, "rint": np.rint,
             "min": lambda *a: np.minimum.reduce(np.broadcast_arrays(*a)),
             "max": lambda *a: np.maximum.reduce(np.broadcast_arrays(*a))}
LEVELS = [{"||": lambda a, b: (a != 0) | (b != 0)}, {"&&": lambda a, b: (a != 0) & (b != 0)},
          {"==": np.equal, "!=": np.not_equal, "<": np.less, ">": np.greater, "<=": np.less_equal,
           ">=": np.greater_equal},
          {"+": np.add, "-": np.subtract}, {"*": np.multiply, "/": np.divide}]


class Parser:
    """Makes a closure over the variables of each part of the text."""

    def __init__(self, text):
        self.tokens, at, text = [], 0, text.strip()
        while at < len(text):
            match = TOKEN.match(text, at)
            if not match:
                raise ValueError(f"cannot read {text[at:]!r}")
            self.tokens.append(match.group(match.lastindex))
            at = match.end()
        self.at = 0

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def take(self, expected=None):
        token = self.peek()
        if expected is not None and token != expected:
            raise ValueError(f"{expected!r} expected, {token!r} found")
        self.at += 1
        return token

    def whole(self):
        value = self.ternary()
        if self.peek():
            raise ValueError(f"{self.peek()!r} is too much")
        return value

    def ternary(self):
        condition = self.binary(0)
        if self.peek() != "?":
            return condition
        self.take()
        yes = self.ternary()
        self.take(":")
        no = self.ternary()
        return lambda v: np.where(condition(v) != 0, yes(v), no(v))

    def binary(self, level):
        if level == len(LEVELS):
            return self.unary()
        value = self.binary(level + 1)
        while self.peek() in LEVELS[level]:
            operator, left, right = LEVELS[level][self.take()], value, self.binary(level + 1)
            # A comparison is a number, 0 or 1, to whatever is made of it.
            value = lambda v, f=operator, a=left, b=right: np.asarray(f(a(v), b(v)), float)
        return value

    def unary(self):
        if self.peek() in ("-", "+"):
            sign, value = self.take(), self.unary()
            return (lambda v: -value(v)) if sign == "-" else value
        return self.power()

    def power(self):
        base = self.atom()
        if self.peek() != "^":
            return base
        self.take()
        exponent = self.unary()
        return lambda v: np.power(np.asarray(base(v), float), exponent(v))

    def atom(self):
        token = self.take()
        if token == "(":
            value = self.ternary()
            self.take(")")
            return value
        if token in FUNCTIONS:
            self.take("(")
            arguments = [self.ternary()]
            while self.peek() == ",":
                self.take()
                arguments.append(self.ternary())
            self.take(")")
            return lambda v, f=FUNCTIONS[token]: f(*(a(v) for a in arguments))
        if token == "pi":
            return lambda v: np.pi
        if token in ("x", "y", "nx", "ny"):
            return lambda v: v[token]
        number = float(token)
        return lambda v: number


class Field:
    """A number or an expression: field(points, normals) with an array (…, 2) of either."""

    def __init__(self, value):
        self.is_constant = not isinstance(value, str)
        self.evaluate = Parser(str(value)).whole() if isinstance(value, str) else (lambda v: float(value))

    def __call__(self, points, normals=None):
        values = self.at(points, normals)
        bad = ~np.isfinite(values)
        if bad.any():  # a removable singularity has the value beside it
            beside = points + 1e-9 * np.max(np.abs(points)) * np.array([1, 0.7])
            values = np.where(bad, self.at(beside, normals), values)
        return values

    def at(self, points, normals):
        variables = {"x": points[..., 0], "y": points[..., 1]}
        if normals is not None:
            variables |= {"nx": normals[..., 0], "ny": normals[..., 1]}
        with np.errstate(all="ignore"):
            return np.asarray(self.evaluate(variables), float) + np.zeros(points.shape[:-1])
