// Where things stand in the text of a JSON document, also of one that is not finished.

const deepest = 64; // levels, which is what the service reads

const escaped = (key) => key.replaceAll("~", "~0").replaceAll("/", "~1");

/// `places`: [start, end] of every value and `keys` of every member's name, by JSON pointer; `fault`: where the text is
/// no JSON; `document`: what is written of it; `at`: what stands at the offset `caret`: the pointer of the object or value, whether a `key` or a `value` is
/// written there, the text of it from `start` to `end`.
export function placesOf(text, caret = -1) {
  const places = new Map(), keys = new Map();
  let i = 0, depth = 0, fault = null, at = null;
  const blank = () => { while (i < text.length && " \t\r\n".includes(text[i])) ++i; };
  const failAt = (place, what) => { fault ??= { place: Math.min(place, text.length), what }; };
  const fail = (what) => failAt(i, what);
  const note = (kind, pointer, start, end) => { if (caret >= start && caret <= end) at = { kind, pointer, start, end }; };

  function string() {
    const start = i++;
    while (i < text.length && text[i] !== '"' && text[i] !== "\n") i += text[i] === "\\" ? 2 : 1;
    if (text[i] === '"') ++i;
    else fail("a text ends with \"");
    i = Math.min(i, text.length);
    try { return JSON.parse(text.slice(start, i)); } catch { fail("this is no JSON text"); return text.slice(start + 1, i); }
  }

  function scalar() {
    const start = i;
    if (text[i] === '"') return string();
    while (i < text.length && !",]}: \t\r\n".includes(text[i])) ++i;
    const word = text.slice(start, i);
    if (!word) fail("a value is missing");
    else try {
      const own = JSON.parse(word);
      if (own !== Infinity && own !== -Infinity) return own;
      failAt(start, "this number is too large");
    } catch { failAt(start, "this is no JSON value"); }
    return null;
  }

  /// Members or entries up to the closing sign.
  function list(close, entry) {
    ++i;
    for (let count = 0; ; ++count) {
      const before = i;
      blank();
      if (text[i] === close && count === 0) return void ++i;
      if (i >= text.length) return fail(`${close} is missing`);
      entry(count, before);
      blank();
      if (text[i] === close) return void ++i;
      if (text[i] === ",") ++i;
      else if (i >= text.length) return fail(`${close} is missing`);
      else { fail(`, or ${close} is missing`); if ("]}".includes(text[i])) return; if (i === before || text[i] === ":") ++i; }
    }
  }

  function value(pointer, before) {
    blank();
    const start = i;
    let own;
    if (depth === deepest && "[{".includes(text[i])) { fail(`it is nested deeper than ${deepest} levels`); i = text.length; }
    ++depth;
    if (text[i] === "{") { own = Object.create(null); list("}", (_, from) => member(pointer, from, own)); }
    else if (text[i] === "[") { own = []; list("]", (count, from) => { own[count] = value(`${pointer}/${count}`, from); }); }
    else {
      own = scalar();
      note("value", pointer, start === i ? before : start, i);
    }
    --depth;
    places.set(pointer, [start, i]);
    return own;
  }

  function member(pointer, before, whole) {
    const start = i;
    if (text[i] !== '"') {
      fail("the name of a member is missing");
      while (i < text.length && !",}\":".includes(text[i])) ++i;
      note("key", pointer, text.slice(start, i).trim() ? start : before, i);
      if (text[i] !== ":") return;
    }
    const key = text[i] === '"' ? string() : text.slice(start, i).trim();
    note("key", pointer, start, i);
    const own = `${pointer}/${escaped(key)}`;
    if (keys.has(own)) failAt(start, "this member is there twice");
    keys.set(own, [start, i]);
    blank();
    if (text[i] !== ":") return fail(": is missing");
    whole[key] = value(own, ++i);
  }

  const document = value("", 0);
  blank();
  if (i < text.length) fail("nothing may follow the document");
  if (caret >= 0 && !at) at = around(caret);
  return { places, keys, fault, document, at };

  /// An empty object's inside.
  function around(place) {
    for (const [pointer, [start, end]] of [...places].reverse())
      if (text[start] === "{" && place > start && place < end && !text.slice(start + 1, end - 1).trim()) return { kind: "key", pointer, start: place, end: place };
    return null;
  }
}
