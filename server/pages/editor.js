// A problem as text: checked by the service as one types, with its faults at their places, and with what the schema
// lets stand at the cursor.

import { button, bytes, counted, element, seconds } from "/pages/element.js";
import { placesOf } from "/pages/json_places.js";
import { beginning, Schema } from "/pages/schema.js";
import { getJson, pose, postJson, Refusal } from "/pages/service.js";

const pause = 350; // ms without a key before the service is asked

/// `whole`: the element; `fill(text)`.
export function editor({ text }) {
  const area = element("textarea", { spellcheck: false, value: text, autocapitalize: "off", ariaLabel: "Problem, as JSON", ariaAutoComplete: "list", ariaHasPopup: "listbox" });
  area.setAttribute("aria-controls", "offers");
  const marks = element("pre", { ariaHidden: "true" });
  const offers = element("ul", { className: "offers", id: "offers", role: "listbox", hidden: true, ariaLabel: "What may stand here" });
  const said = element("p", { className: "quiet", role: "status" }, "\u00a0");
  const faults = element("ul", { className: "faults" });
  const solve = button("Solve", begin, { className: "main" });
  const whole = element("div", { className: "editor" }, element("div", { className: "text" }, marks, area, offers), said, faults, element("div", { className: "row" }, solve));
  let schema = null, timer = 0, asked = null;
  getJson("/openapi.json").then((api) => { schema = new Schema(api); }, () => {});

  // --- faults

  function show(found) {
    const { places, keys } = placesOf(area.value);
    const placed = found.map((fault) => ({ ...fault, range: fault.range ?? rangeOf(fault.pointer, places, keys) }));
    const ranges = placed.map(({ range }) => range).sort((a, b) => a[0] - b[0]);
    let at = 0;
    marks.replaceChildren(...ranges.flatMap(([start, end]) => {
      const from = Math.max(at, start), pieces = [area.value.slice(at, from), element("mark", {}, area.value.slice(from, end))];
      at = Math.max(from, end);
      return from < end ? pieces : [pieces[0]];
    }), `${area.value.slice(at)}\n`);
    faults.replaceChildren(...placed.map(({ pointer, detail, range }) => {
      const words = [pointer && element("code", {}, pointer), pointer && " ", detail];
      return element("li", {}, button(words, () => { area.focus(); area.setSelectionRange(...range); reveal(range[0]); }));
    }));
    area.ariaInvalid = found.length > 0;
    follow();
  }
  const follow = () => { marks.scrollTop = area.scrollTop; };
  area.onscroll = follow;

  /// The nearest that is written of what the pointer names.
  function rangeOf(pointer, places, keys) {
    for (let own = pointer ?? ""; ; own = own.slice(0, own.lastIndexOf("/"))) {
      const place = places.get(own), long = place && area.value.slice(...place).includes("\n");
      if (keys.has(own) && (long || !place)) return keys.get(own);
      if (place && !long) return place;
      if (place) return [place[0], place[0] + 1];
      if (!own) return [0, Math.min(1, area.value.length)];
    }
  }

  function reveal(offset) {
    const line = area.value.slice(0, offset).split("\n").length;
    area.scrollTop = Math.max(0, line * area.scrollHeight / area.value.split("\n").length - area.clientHeight / 2);
  }

  // --- the check

  async function check() {
    asked?.abort();
    asked = new AbortController();
    const own = asked;
    const { fault } = placesOf(area.value);
    solve.disabled = true;
    if (fault) {
      said.textContent = "This is no JSON yet.";
      return show([{ detail: `line ${area.value.slice(0, fault.place).split("\n").length}: ${fault.what}`, range: [Math.max(0, Math.min(fault.place, area.value.length - 1)), fault.place + 1] }]);
    }
    try {
      const found = await postJson("/v1/validate", area.value, own.signal);
      const { memory_bytes: memory, seconds: time } = found.estimated;
      const unknowns = Object.values(found.unknowns).reduce((a, b) => a + b);
      said.textContent = `Ready: ${counted(found.triangles, "triangle")}, ${counted(unknowns, "unknown")}, about ${bytes(memory)} and ${seconds(time)}.${(found.notes ?? []).map((note) => ` ${note}`).join("")}`;
      solve.disabled = false;
      show([]);
    } catch (error) {
      if (error.name === "AbortError") return;
      said.textContent = error.faults?.length ? `${error.faults.length === 1 ? "One fault" : `${error.faults.length} faults`}:` : "";
      show(error.faults?.length ? error.faults : [{ detail: error.message }]);
    }
  }
  const later = () => { clearTimeout(timer); timer = setTimeout(check, pause); };

  // --- completions

  let shown = [], chosen = 0, place = null;

  function offer() {
    close();
    const caret = area.selectionStart;
    const { at, document, keys } = placesOf(area.value, caret);
    place = at;
    if (!schema || !place) return;
    const own = place.kind === "key" ? schema.members(place.pointer, document) : schema.values(place.pointer, document);
    const written = area.value.slice(place.start, caret).trim().replace(/^"/, "").toLowerCase();
    const present = new Set([...keys].filter(([, [start]]) => start !== place.start).map(([pointer]) => pointer));
    shown = own.filter(({ text: name }) => name.replace(/^"/, "").toLowerCase().startsWith(written) && !(place.kind === "key" && present.has(`${place.pointer}/${name}`)));
    if (!shown.length) return;
    chosen = 0;
    offers.replaceChildren(...shown.map(({ text: name, about }, i) => {
      const line = element("li", { role: "option", id: `offer${i}` }, element("code", {}, name), about && element("small", {}, about));
      line.onpointerdown = (event) => { event.preventDefault(); take(i); };
      return line;
    }));
    const { left, top } = caretPlace(caret);
    offers.style.left = `${Math.max(4, Math.min(left, area.clientWidth - 250))}px`;
    offers.style.top = `${top > area.clientHeight / 2 ? Math.max(0, top - 20 - Math.min(224, 44 * shown.length)) : top + 4}px`;
    offers.hidden = false;
    choose(0);
  }

  function choose(i) {
    chosen = (i + shown.length) % shown.length;
    [...offers.children].forEach((line, k) => { line.ariaSelected = k === chosen; });
    offers.children[chosen].scrollIntoView({ block: "nearest" });
    area.setAttribute("aria-activedescendant", `offer${chosen}`);
  }

  function close() {
    offers.hidden = true;
    area.removeAttribute("aria-activedescendant");
  }

  function take(i) {
    const { text: name, schemas } = shown[i];
    const start = place.start + area.value.slice(place.start, place.end).search(/\S|$/);
    let put = name, caret = name.length;
    if (place.kind === "key") {
      const named = /^\s*:/.test(area.value.slice(place.end));
      const begun = named ? "" : `: ${beginning(schemas)}`;
      put = JSON.stringify(name) + begun;
      caret = put.length - (/[}\]]$/.test(begun) ? 1 : 0);
    }
    const from = area.value.slice(place.start, place.end).trim() ? start : area.selectionStart;
    const to = area.value.slice(place.start, place.end).trim() ? Math.max(place.end - (area.value.slice(start, place.end).match(/\s*$/)[0].length), from) : from;
    area.setRangeText(put, from, to, "end");
    area.setSelectionRange(from + caret, from + caret);
    close();
    area.dispatchEvent(new InputEvent("input"));
  }

  /// Pixels, within the text, by a copy that ends at the cursor.
  function caretPlace(caret) {
    const end = element("span", {}, "\u200b"), copy = element("pre", {}, area.value.slice(0, caret), end);
    marks.after(copy);
    const place = { left: end.offsetLeft, top: end.offsetTop + end.offsetHeight - area.scrollTop };
    copy.remove();
    return place;
  }

  area.oninput = (event) => {
    show([]);
    later();
    if (event.inputType?.startsWith("insert") && /["\w]/.test(event.data ?? "")) offer();
    else close();
  };
  area.onblur = close;
  area.onkeydown = (event) => {
    if (event.key === " " && event.ctrlKey) { event.preventDefault(); return offer(); }
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) { event.preventDefault(); return solve.click(); }
    if (offers.hidden) return;
    const does = { ArrowDown: () => choose(chosen + 1), ArrowUp: () => choose(chosen - 1), Enter: () => take(chosen), Tab: () => take(chosen), Escape: close }[event.key];
    if (does) { event.preventDefault(); does(); }
  };

  async function begin() {
    solve.disabled = true;
    try {
      await pose(area.value);
    } catch (error) {
      if (error instanceof Refusal) show(error.faults.length ? error.faults : [{ detail: error.message }]);
      else said.textContent = "The service cannot be reached.";
      solve.disabled = false;
    }
  }

  // What has been written before it came is kept.
  const fill = (own) => {
    if (area.value) return;
    area.value = own;
    show([]);
    check();
  };
  if (text) check();
  return { whole, fill };
}
