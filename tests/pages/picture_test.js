// The picture of a solve: its pixels, its values, its controls.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { after, before, test } from "node:test";
import { begin, drawn, end, eventually, expectWell, newPage, pixelsOf } from "./browser.js";
import { colour, scaleOf } from "./colours.js";

let service, browser, page;
const solves = {};
before(async () => {
  [service, browser] = await begin();
  page = await newPage(browser, { width: 640, height: 760, acceptDownloads: true });
  const membrane = { ...(await service.example("paper-nonconforming")), mesh: { divisions: [4, 4], pattern: "right" } };
  solves.constant = await service.solve(membrane);
  solves.fine = await service.solve({ ...membrane, mesh: { divisions: [96, 96], pattern: "right" }, solver: { method: "active_set" } });
  solves.linear = await service.solve({ ...membrane, scheme: "conforming", solver: { method: "active_set" } });
  solves.body = await service.solve({ ...(await service.example("elastic-block")), mesh: { divisions: [8, 4], pattern: "crossed" } });
  const block = await service.example("elastic-block");
  solves.conforming = await service.solve({ ...block, scheme: "conforming", mesh: { divisions: [4, 2], pattern: "crossed" } });
  const tilted = { ...block, mesh: { divisions: [8, 4], pattern: "crossed" }, sweep: [1, 2, 3].map((k) => ({ material: { young: 100 * k } })) };
  solves.sweep = { id: await service.solve(tilted), sweep: tilted.sweep };
  solves.other = await service.solve({ ...(await service.example("elastic-block")), mesh: { divisions: [8, 4], pattern: "crossed" }, material: { young: 100, poisson: 0.3, plane: "strain" } });
});
after(() => end(service, browser));
const wellDone = () => expectWell(page);

const open = async (id, hash = "") => {
  await page.goto("about:blank");
  // Else the triangle would be marked that is where the test before has left the pointer.
  await page.mouse.move(0, 0);
  await page.goto(`${service.url}/v1/solves/${id}${hash && `#${hash}`}`);
  await drawn(page);
  // The controls and all of the picture are in the window.
  await page.locator(".controls").evaluate((own) => own.scrollIntoView());
};
const frame = () => page.locator(".frame").first();
const result = (id, fields) => service.call(`/v1/solves/${id}/result?fields=${fields}`);
const settled = () => page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(resolve))); }));

/// Where a place of the unit square is in its flat picture.
async function projection() {
  const { width, height } = await frame().boundingBox();
  const scale = (0.92 * Math.min(width, height)) / 2;
  return ([x, y]) => [width / 2 + scale * (2 * x - 1), height / 2 - scale * (2 * y - 1)];
}

/// The least distance of a pixel's middle from the edges of a triangle; negative outside.
function inside([x, y], corners) {
  const sides = corners.map((a, k) => {
    const b = corners[(k + 1) % 3];
    return ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / Math.hypot(b[0] - a[0], b[1] - a[1]);
  });
  return Math.max(Math.min(...sides), Math.min(...sides.map((side) => -side)));
}

async function coloursByTriangle(id) {
  const { mesh } = await result(id, "mesh"), at = await projection(), pixels = await pixelsOf(page, frame());
  return mesh.triangles.map((triangle) => {
    const corners = triangle.map((p) => at(mesh.points[p])), found = new Set();
    const [least, most] = [Math.min, Math.max].map((of) => [0, 1].map((c) => Math.floor(of(...corners.map((corner) => corner[c])))));
    for (let y = least[1]; y <= most[1]; ++y)
      for (let x = least[0]; x <= most[0]; ++x)
        if (inside([x + 0.5, y + 0.5], corners) > 3) found.add(pixels.data.subarray(4 * (y * pixels.width + x), 4 * (y * pixels.width + x) + 3).join());
    return found;
  });
}

test("A constant field has one colour in each triangle, that of its value, and jumps between them", async () => {
  await open(solves.constant, "surface=0&mesh=0&field=displacement");
  const { displacement: { values } } = await result(solves.constant, "displacement");
  const { low, high, diverges } = scaleOf(Math.min(...values), Math.max(...values));
  const found = await coloursByTriangle(solves.constant);
  found.forEach((own, t) => {
    assert.equal(own.size, 1, `triangle ${t}: ${[...own]}`);
    const expected = colour((values[t] - low) / (high - low), diverges);
    [...own][0].split(",").forEach((each, i) => assert.ok(Math.abs(each - expected[i]) <= 3, `triangle ${t}: ${[...own]}, not ${expected}`));
  });
  assert.ok(new Set(found.map((own) => [...own][0])).size > 10);
  wellDone();
});

test("A linear field has many, and so has a constant one that is smoothed", async () => {
  await open(solves.linear, "surface=0&mesh=0&field=displacement");
  assert.ok((await coloursByTriangle(solves.linear)).filter((own) => own.size > 3).length > 16);
  await open(solves.constant, "surface=0&mesh=0&field=displacement&smooth=1");
  assert.ok((await coloursByTriangle(solves.constant)).filter((own) => own.size > 3).length > 16);
  wellDone();
});

test("The colours are those of the service's own pictures", async () => {
  const svg = await (await fetch(`${service.url}/v1/solves/${solves.body}/picture.svg?field=von_mises`)).text();
  for (let band = 0; band < 32; ++band) {
    const [, hex] = svg.match(new RegExp(`\\.c${band}\\{fill:#([0-9a-f]{6})`));
    const expected = colour(band / 31, false), own = [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16));
    own.forEach((each, i) => assert.ok(Math.abs(each - expected[i]) <= 1, `${band}: ${own} ${expected}`));
  }
});

/// What is told of the place under the pointer.
async function pick(x, y) {
  const box = await frame().boundingBox();
  await page.mouse.move(box.x + x, box.y + y);
  await settled();
  const told = page.locator("figure .readout").first();
  return { ...(await told.evaluate((own) => ({ ...own.dataset }))), text: await told.innerText() };
}
const shown = (text) => {
  const superscripts = { "⁻": "-", "⁰": 0, "¹": 1, "²": 2, "³": 3, "⁴": 4, "⁵": 5, "⁶": 6, "⁷": 7, "⁸": 8, "⁹": 9 };
  const number = text.trim().split("\n").at(-1).match(/(−?[\d.]+)(?:\u202f·\u202f10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+))?$/);
  return Number(`${number[1].replace("−", "-")}e${[...(number[2] ?? "0")].map((c) => superscripts[c] ?? c).join("")}`);
};
const close = (a, b) => assert.ok(Math.abs(a - b) <= 5.1e-6 * Math.max(Math.abs(a), Math.abs(b), 1e-300) , `${a} and ${b}`);

test("The value under the pointer is that of the JSON to six digits", async () => {
  await open(solves.constant, "surface=0&field=displacement");
  const constant = await result(solves.constant, "mesh,displacement"), box = await frame().boundingBox();
  for (const [x, y] of [[0.31, 0.42], [0.5, 0.6], [0.63, 0.2]]) {
    const told = await pick(x * box.width, y * box.height);
    assert.equal(Number(told.value), constant.displacement.values[told.triangle]);
    close(shown(told.text), constant.displacement.values[told.triangle]);
    const corners = constant.mesh.triangles[told.triangle].map((p) => constant.mesh.points[p]);
    assert.ok(inside([Number(told.x), Number(told.y)], corners) > -0.01);
  }
  for (const [field, member] of [["von_mises", (all) => all.von_mises], ["stress_xy", (all) => all.stress.at_centroids.map((own) => own[2])], ["principal_second", (all) => all.principal.map((own) => own[1])], ["error", (all) => all.error_squares.map(Math.sqrt)]]) {
    await open(solves.body, `field=${field}`);
    const values = member(await result(solves.body, "stress,principal,von_mises,error_squares"));
    const told = await pick(box.width / 2, box.height / 2);
    close(shown(told.text), values[told.triangle]);
  }
  await open(solves.linear, "surface=0&field=displacement");
  const linear = await result(solves.linear, "mesh,displacement"), told = await pick(0.45 * box.width, 0.47 * box.height);
  const [a, b, c] = linear.mesh.triangles[told.triangle].map((p) => linear.mesh.points[p]);
  const area = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]), own = [Number(told.x), Number(told.y)];
  const shares = [area(own, b, c), area(a, own, c), area(a, b, own)].map((each) => each / area(a, b, c));
  close(Number(told.value), linear.displacement.values[told.triangle].reduce((sum, value, k) => sum + shares[k] * value, 0));
  wellDone();
});

test("Every field can be shown, and every control does what it says", async () => {
  await open(solves.body);
  const choice = page.getByLabel("Field");
  for (const field of await choice.locator("option").evaluateAll((all) => all.map((own) => own.value))) {
    await choice.selectOption(field);
    await settled();
    assert.equal(await page.locator(".field").innerText(), await choice.evaluate((own) => own.selectedOptions[0].text));
  }
  assert.equal(await choice.locator("option").count(), 11);
  const look = async () => (await frame().screenshot()).toString("base64");
  for (const name of ["Mesh", "Unknowns", "Principal directions", "Smoothed"]) {
    const before = await look(), button = page.getByRole("button", { name });
    const pressed = await button.getAttribute("aria-pressed");
    await button.click();
    await settled();
    assert.notEqual(await button.getAttribute("aria-pressed"), pressed);
    assert.notEqual(await look(), before, name);
  }
  let before = await look();
  await page.getByLabel("Deformed ×").fill("9");
  await page.getByLabel("Deformed ×").press("Enter");
  await settled();
  assert.notEqual(await look(), before);
  await page.getByLabel("Lowest value of the scale").fill("0");
  await page.getByLabel("Highest value of the scale").fill("8");
  await page.getByLabel("Highest value of the scale").press("Enter");
  await settled();
  assert.deepEqual(await page.locator(".ticks li").allInnerTexts(), ["8", "6", "4", "2", "0"]);
  assert.ok(await page.getByLabel("Fixed").isChecked());
  await page.getByLabel("Fixed").uncheck();
  await settled();
  before = await look();
  await frame().focus();
  for (const key of ["ArrowLeft", "+", "ArrowUp", "-", "m"]) {
    await page.keyboard.press(key);
    await settled();
    assert.notEqual(await look(), before, key);
    before = await look();
  }
  await page.getByRole("button", { name: "Whole view" }).click();
  await settled();
  assert.notEqual(await look(), before);
  wellDone();
});

test("A membrane is a surface that is turned, moved and laid flat", async () => {
  await open(solves.constant);
  const look = async () => { await settled(); return (await frame().screenshot()).toString("base64"); };
  const box = await frame().boundingBox(), first = await look();
  const drag = async () => {
    await page.mouse.move(box.x + 200, box.y + 120);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 170, { steps: 4 });
    await page.mouse.up();
  };
  await drag();
  const turned = await look();
  assert.notEqual(turned, first);
  await page.keyboard.down("Shift");
  await drag();
  await page.keyboard.up("Shift");
  const moved = await look();
  assert.notEqual(moved, turned);
  await page.mouse.wheel(0, -400);
  await page.waitForFunction(() => location.hash.includes("zoom="));
  assert.notEqual(await look(), moved);
  await page.getByRole("button", { name: "Surface" }).click();
  assert.notEqual(await look(), moved);
  await page.mouse.dblclick(box.x + 200, box.y + 200);
  await page.getByRole("button", { name: "Surface" }).click();
  await page.mouse.move(0, 0);
  assert.equal(await look(), first);
  wellDone();
});

test("A surface has no holes between small triangles", async () => {
  await open(solves.fine, "field=stress&mesh=0");
  const { width, height, data } = await pixelsOf(page, frame()), ground = data.readUInt32LE(0);
  let holes = 0;
  for (let y = Math.round(0.4 * height); y < 0.6 * height; ++y)
    for (let x = Math.round(0.4 * width); x < 0.6 * width; ++x) holes += data.readUInt32LE(4 * (y * width + x)) === ground;
  assert.equal(holes, 0);
  assert.ok((await pick(0.5 * width, 0.5 * height)).triangle);
  wellDone();
});

test("Two fingers zoom", async () => {
  const own = await newPage(browser, { width: 390, height: 800, hasTouch: true });
  await own.goto(`${service.url}/v1/solves/${solves.body}`);
  await drawn(own);
  await own.locator(".frame").scrollIntoViewIfNeeded();
  const box = await own.locator(".frame").boundingBox(), debug = await own.context().newCDPSession(own);
  const points = (far) => [[-far, 0], [far, 0]].map(([x], id) => ({ x: box.x + box.width / 2 + x, y: box.y + 100, id }));
  await debug.send("Input.dispatchTouchEvent", { type: "touchStart", touchPoints: points(20) });
  for (const far of [30, 50, 70]) await debug.send("Input.dispatchTouchEvent", { type: "touchMove", touchPoints: points(far) });
  await debug.send("Input.dispatchTouchEvent", { type: "touchEnd", touchPoints: [] });
  await own.waitForFunction(() => /zoom=[23]/.test(location.hash));
  assert.deepEqual(own.faults, []);
  await own.context().close();
});

test("The address keeps the view", async () => {
  await open(solves.body, "field=stress_yy&mesh=0&zoom=2&x=0.1&lift=3&crosses=1");
  await settled();
  const before = await frame().screenshot();
  await page.getByRole("button", { name: "Unknowns" }).click();
  await page.getByRole("button", { name: "Unknowns" }).click();
  await page.mouse.move(0, 0);
  // It is written anew, its members in their own order.
  await page.waitForFunction(() => location.hash === "#field=stress_yy&zoom=2&x=0.1&lift=3&mesh=0&crosses=1");
  const address = page.url();
  await page.goto("about:blank");
  await page.goto(address);
  await drawn(page);
  await settled();
  assert.ok(before.equals(await frame().screenshot()));
  wellDone();
});

test("The picture is kept as PNG and SVG", async () => {
  await open(solves.body, "field=von_mises");
  const [png] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "PNG" }).click()]);
  assert.match(png.suggestedFilename(), /-von_mises\.png$/);
  assert.deepEqual([...(await readFile(await png.path())).subarray(0, 4)], [0x89, 0x50, 0x4e, 0x47]);
  const [svg] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "SVG" }).click()]);
  const text = await readFile(await svg.path(), "utf8"), { mesh } = await result(solves.body, "mesh");
  const judge = await browser.newPage();
  assert.equal(await judge.evaluate((own) => new DOMParser().parseFromString(own, "image/svg+xml").querySelector("parsererror")?.textContent, text), undefined);
  await judge.close();
  const filled = [...text.matchAll(/<path class="c\d+" d="([^"]*)"/g)].flatMap(([, path]) => path.split("M").slice(1));
  assert.equal(filled.length, mesh.triangles.length);
  wellDone();
});

test("The foundation lies beyond an elastic body by its gap, as many times too far as the body is deformed", async () => {
  await open(solves.body, "lift=3");
  const [svg] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "SVG" }).click()]);
  const lines = [...(await readFile(await svg.path(), "utf8")).matchAll(/<path [^>]*stroke-dasharray="7 4" d="M([^"]*)"/g)].map(([, path]) => path.split("L").map((place) => place.split(" ").map(Number)));
  const { contact: { bottom } } = await result(solves.body, "contact");
  assert.deepEqual(lines.map((line) => line.length), [bottom.points.length]);
  // The bottom is straight and level: what is across tells how large the picture is.
  const [first, last] = [0, -1].map((i) => ({ seen: lines[0].at(i), place: bottom.points.at(i), gap: bottom.gap.at(i) }));
  const scale = (last.seen[0] - first.seen[0]) / (last.place[0] - first.place[0]);
  assert.ok(Math.abs((last.seen[1] - first.seen[1]) / scale - 3 * (last.gap - first.gap)) < 1e-3);
  assert.ok(Math.abs(last.gap - first.gap) > 0.03);
  wellDone();
});

test("The foundation is that of the service's own picture, also where its direction turns", async () => {
  const problem = {
    model: "elasticity", domain: { type: "polygon", vertices: [[0, 1], [0, 0.5], [1, 0], [2, 0.5], [2, 1]], sides: ["left", "foot", "foot", "right", "top"] }, mesh: { size: 0.25 },
    material: { young: 200, poisson: 0.3 }, boundary: { left: { type: "roller" }, foot: { type: "contact", gap: 0.02 }, top: { type: "traction", pressure: 1 } }, scheme: "conforming", solver: { method: "active_set" },
  };
  for (const [direction, rows] of [[undefined, 2], [[0, -2], 1]]) {
    const id = await service.solve({ ...problem, boundary: { ...problem.boundary, foot: { ...problem.boundary.foot, direction } } });
    const { contact: { foot: { points } } } = await result(id, "contact");
    assert.equal(points.filter(([x]) => x === 1).length, rows);
    await open(id, "lift=4");
    const [file] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "SVG" }).click()]);
    const [, path] = (await readFile(await file.path(), "utf8")).match(/<path [^>]*stroke-dasharray="7 4" d="M([^"]*)"/), own = path.split("L").map((place) => place.split(" ").map(Number));
    // Its places are relative, each to the one before.
    const [, steps] = (await (await fetch(`${service.url}/v1/solves/${id}/picture.svg?field=von_mises&deformed=4`)).text()).match(/<path class="foundation" d="M([^"]*)"/);
    const expected = [];
    for (const [dx, dy] of steps.split("l").flatMap((part, i) => [...part.matchAll(/-?[\d.]+/g)].map(Number).flatMap((each, k, all) => (k % 2 ? [[all[k - 1], each]] : [])))) expected.push(expected.length ? [expected.at(-1)[0] + dx, expected.at(-1)[1] + dy] : [dx, dy]);
    assert.equal(own.length, points.length);
    assert.equal(expected.length, points.length);
    const scale = (expected.at(-1)[0] - expected[0][0]) / (own.at(-1)[0] - own[0][0]);
    own.forEach((place, i) => place.forEach((each, c) => assert.ok(Math.abs((each - own[0][c]) * scale - (expected[i][c] - expected[0][c])) < 0.2, `${i}: ${own[i]}, ${expected[i]}`)));
  }
  wellDone();
});

test("Two solves are side by side with one view and one scale, and their difference is shown", async () => {
  await open(solves.body, `with=${solves.other}&field=displacement_y`);
  await page.waitForFunction(() => document.querySelectorAll("figure .ticks li").length === 10);
  await settled();
  const ticks = () => page.locator("figure").evaluateAll((all) => all.map((own) => own.querySelector(".ticks").innerText));
  const [one, two] = await ticks();
  assert.equal(one, two);
  await page.getByRole("button", { name: "Difference" }).click();
  await settled();
  await page.locator(".frame").nth(1).scrollIntoViewIfNeeded();
  const told = await page.locator(".frame").nth(1).boundingBox();
  await page.mouse.move(told.x + told.width / 2, told.y + told.height / 2);
  await settled();
  const { triangle, value, x, y } = await page.locator("figure .readout").nth(1).evaluate((own) => ({ ...own.dataset }));
  const [a, b] = await Promise.all([solves.body, solves.other].map((id) => result(id, "mesh,displacement")));
  const corners = a.mesh.triangles[triangle].map((p) => a.mesh.points[p]), area = (p, q, r) => (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
  const own = [Number(x), Number(y)], [p, q, r] = corners, shares = [area(own, q, r), area(p, own, r), area(p, q, own)].map((each) => each / area(p, q, r));
  const at = ({ displacement: { values } }) => values[triangle].reduce((sum, pair, k) => sum + shares[k] * pair[1], 0);
  assert.ok(Math.abs(Number(value) - (at(b) - at(a))) <= 1e-9 * Math.abs(at(a)) + 1e-12, `${value} ${at(b) - at(a)}`);
  wellDone();
});

test("Curves are told apart by their colours, and iterations are counted in whole numbers", async () => {
  await open(solves.constant);
  const colours = await page.locator("#history .legend li").evaluateAll((all) => all.map((own) => getComputedStyle(own).color));
  assert.ok(colours.length > 4);
  assert.equal(new Set(colours).size, colours.length);
  await open(solves.linear);
  const told = await page.locator("#history .plot text[text-anchor=middle]").allTextContents();
  assert.ok(told.includes("1") && told.includes("2"));
  assert.deepEqual(told.filter((own) => own.includes(".")), []);
  wellDone();
});

test("Below it stand the bound in words, contact, sweep, levels and study, and their numbers in tables", async () => {
  await open(solves.body);
  await page.locator("#bound").getByText(/^Proved: stress and displacement together are off by at most/).waitFor();
  await page.getByText("Numbers of bottom").click();
  const { contact: { bottom } } = await result(solves.body, "contact");
  assert.equal(await page.locator("#contact tbody tr").count(), bottom.pressure.length);
  const id = await service.solve(await service.example("gap-sweep"));
  await open(id);
  // Of whole edges, whose middles the rows are.
  await page.locator("#contact").getByText("Closed on 0 … 2 (shaded).").waitFor();
  await page.getByLabel("Entry", { exact: true }).last().selectOption("3");
  await page.locator("#sweep h3").first().getByText("tilted", { exact: true }).waitFor();
  await page.waitForFunction(() => location.hash.includes("entry=3"));
  await page.getByText("Numbers of the sweep").click();
  // The others have but other gaps than the entry before them.
  assert.deepEqual(await page.locator("#sweep table").last().locator("tbody td:nth-child(3)").allInnerTexts().then((all) => all.map((own) => /^[\d.]+ %/.test(own))), [true, false, false, true]);
  assert.equal(await page.locator("#sweep .verdict").count(), 0);
  await page.getByLabel("Entry", { exact: true }).last().selectOption("4");
  await page.locator("#sweep .verdict").waitFor();
  await page.getByRole("button", { name: "Solve it alone" }).click();
  await page.waitForURL((url) => !url.pathname.endsWith(id));
  const twice = (await result(new URL(page.url()).pathname.split("/").at(-1), "problem")).problem, sweep = await service.example("gap-sweep");
  assert.deepEqual([twice.sweep, twice.boundary, twice.mesh], [undefined, { ...sweep.boundary, bottom: { type: "contact", gap: "0.01 * x" }, top: { type: "traction", pressure: 2 } }, sweep.mesh]);
  await drawn(page);
  const adaptive = await service.solve(await service.example("adaptive-mesh"));
  await open(adaptive);
  await page.getByLabel("Level", { exact: true }).fill("2");
  const { summary: { levels } } = await result(adaptive, "summary");
  await page.locator("#levels").getByText(`${levels.triangles[1]} triangles`).waitFor();
  const { levels: seen } = await result(adaptive, "levels"), last = levels.level.length;
  assert.deepEqual(seen.map(({ level }) => level), levels.level.slice(0, -1));
  // The mesh of a level may come after its number stands there.
  const tells = async (level, squares) => {
    await page.getByLabel("Level", { exact: true }).fill(String(level));
    await eventually(async () => {
      const box = await frame().boundingBox(), own = await pick(0.5 * box.width, 0.5 * box.height);
      assert.ok(Number(own.triangle) < levels.triangles[level - 1]);
      close(Number(own.value), Math.sqrt(squares[own.triangle]));
    });
  };
  await page.getByLabel("Field").selectOption("error");
  for (const { level, error_squares: squares } of [seen[0], seen.at(-1)]) await tells(level, squares);
  await tells(last, (await result(adaptive, "error_squares")).error_squares);
  wellDone();
  const study = await service.solve(await service.example("convergence-study"));
  await open(study);
  assert.equal(await page.locator("#study .plot").count(), 2);
  await page.getByText(/^Fitted rates/).first().waitFor();
  wellDone();
});

test("Quantities stand in a table with their intervals, and those of a sweep as curves with bands", async () => {
  const block = { ...(await service.example("elastic-block")), mesh: { divisions: [8, 4], pattern: "crossed" } };
  const problem = { ...block, quantities: [{ name: "load <b>", type: "pressure_force", part: "bottom" }], sweep: [{ boundary: { bottom: { gap: 0 } } }, { title: "lower", boundary: { bottom: { gap: 0.01 } } }] };
  const id = await service.solve(problem), all = await result(id, "quantities,sweep"), [{ lower, upper, guaranteed }] = all.quantities;
  assert.ok(lower <= 2 && upper >= 2);
  await open(id);
  const cells = await page.locator("#quantities tbody td").allInnerTexts();
  assert.equal(cells[0], "load <b>");
  assert.equal(cells[3], guaranteed ? "yes" : "no");
  // The ends are told to a hundredth of what lies between them.
  cells[2].split(" … ").forEach((end, i) => assert.ok(Math.abs(shown(end) - [lower, upper][i]) <= 0.01 * (upper - lower) + 1e-15, `${cells[2]}, not ${lower} … ${upper}`));
  const [file] = await Promise.all([page.waitForResponse("**/quantities.csv"), page.locator("#quantities").getByRole("link", { name: "Quantities CSV" }).evaluate((link) => fetch(link.href))]);
  assert.equal(file.status(), 200);
  assert.equal(await page.locator("#sweep .plot").count(), 4 + 2);
  assert.equal((await page.locator("#sweep .band").getAttribute("d")).split("M").length, 2);
  // Gaps alone are new, and yet there is a bound, for quantities need the fields.
  await page.getByLabel("Entry", { exact: true }).last().selectOption("2");
  await page.locator("#sweep .verdict").waitFor();
  assert.equal((await page.locator("#sweep table", { hasText: "Quantities of lower" }).locator("tbody td").first().innerText()), "load <b>");
  wellDone();
});

test("What is guaranteed of an answer stands in its interval, and where contact is sure on its stretches", async () => {
  const read = async (id) => {
    await open(id);
    const rows = (table) => page.locator("#certified table").nth(table).locator("tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((cell) => cell.innerText)));
    return { certified: (await result(id, "summary")).summary.certified, numbers: new Map((await rows(0)).map(([name, ...cells]) => [name, cells])), stretches: await rows(1) };
  };
  // Ends are told to a hundredth of what lies between them.
  const told = ([number, interval], { estimate, lower, upper }) => {
    if (upper === undefined) {
      close(shown(number), estimate);
      return lower === undefined ? assert.equal(interval, "–") : close(shown(interval.match(/^≥ (.*)$/)[1]), lower);
    }
    const near = (text, value) => assert.ok(Math.abs(shown(text) - value) <= 0.01 * (upper - lower) + 1e-15 * Math.abs(value), `${text}, not ${value}`);
    near(number, estimate);
    interval.split(" … ").forEach((end, i) => near(end, [lower, upper][i]));
  };
  const { certified: { energy, work, parts: { left, bottom } }, numbers, stretches } = await read(await service.solve(await service.example("elastic-block")));
  const expected = {
    energy, "work of the loads": work, "left, force x": left.force[0], "left, force y": left.force[1], "left, moment": left.moment,
    "bottom, force x": bottom.force[0], "bottom, force y": bottom.force[1], "bottom, moment": bottom.moment, "bottom, pressure force": bottom.pressure_force,
  };
  assert.deepEqual([...numbers.keys()], Object.keys(expected));
  for (const [name, cells] of numbers) told(cells, expected[name]);
  assert.deepEqual(stretches.map(([part, from, to, touches]) => [part, from, to, touches]), bottom.stretches.map(({ begin, end, touches }) => ["bottom", begin.join(", "), end.join(", "), touches ? "yes" : "–"]));
  assert.ok(stretches.some((row) => row[3] === "yes") && stretches.some((row) => row[3] === "–"));
  stretches.forEach((row, i) => ["carries_at_most", "opens_at_most"].forEach((key, k) => (key in bottom.stretches[i] ? close(shown(row[4 + k]), bottom.stretches[i][key]) : assert.equal(row[4 + k], "–"))));
  // Supports that share a point are bounded together alone, and a pressure from below alone.
  const { certified: { parts, sums: [sum], unmet }, numbers: shared } = await read(solves.constant);
  assert.deepEqual([parts.left.force.lower, parts.bottom.pressure_force.upper], [undefined, undefined]);
  told(shared.get("left, force"), parts.left.force);
  told(shared.get("bottom, pressure force"), parts.bottom.pressure_force);
  told(shared.get(`${sum.parts.join(" + ")}, force`), sum.force);
  assert.deepEqual(await page.locator("#certified li").allInnerTexts(), unmet);
  wellDone();
});

test("Nothing is shown as guaranteed where nothing is", async () => {
  const id = await service.solve({ ...(await service.example("elastic-block")), mesh: { divisions: [8, 4], pattern: "crossed" }, load: { body: ["1 / (x - 0.51)", 0] } });
  const { summary } = await result(id, "summary");
  assert.deepEqual([summary.error_bound.guaranteed, summary.certified], [false, undefined]);
  await open(id);
  await page.locator("#bound .verdict.open").waitFor();
  await page.locator("#figures").waitFor();
  assert.equal(await page.locator("#certified").count(), 0);
  wellDone();
});

test("Whatever an address says, there is a picture", async () => {
  const { length } = solves.sweep.sweep;
  for (const hash of ["fixed=1", "fixed=1&low=5&high=-5", "zoom=0", "zoom=1e300&tilt=99&turn=1e9", "lift=-1", "entry=1.5", "entry=-3", "entry=NaN", "field=none", "level=0.5", "low=&high=x", "with=nobody"]) {
    await open(solves.sweep.id, hash);
    await page.locator("#sweep").waitFor();
    assert.equal(await page.locator(".ticks li").count(), 5, hash);
    const entry = Number(await page.locator("#sweep select").inputValue());
    assert.ok(Number.isInteger(entry) && entry >= 1 && entry <= length, hash);
  }
  await page.getByText("The other solve cannot be shown").waitFor();
  wellDone();
});

test("The size of the displacement is that of its components wherever the pointer is", async () => {
  await open(solves.conforming, "field=displacement&mesh=0&lift=0");
  const { displacement: { values } } = await result(solves.conforming, "displacement");
  const { width, height } = await frame().boundingBox();
  let largest = 0;
  for (const [x, y] of [[0.31, 0.47], [0.5, 0.52], [0.62, 0.44], [0.43, 0.61]]) {
    await frame().hover({ position: { x: x * width, y: y * height } });
    const told = await eventually(async () => { const own = await page.locator("figure .readout").first().evaluate((each) => ({ ...each.dataset })); assert.ok(own.value); return own; });
    const { mesh } = await result(solves.conforming, "mesh"), corners = mesh.triangles[told.triangle].map((p) => mesh.points[p]);
    const det = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]), place = [Number(told.x), Number(told.y)];
    const shares = [0, 1, 2].map((k) => det(place, corners[(k + 1) % 3], corners[(k + 2) % 3]) / det(...corners));
    const own = values[told.triangle], of = (c) => shares.reduce((sum, share, k) => sum + share * own[k][c], 0);
    const expected = Math.hypot(of(0), of(1)), interpolated = shares.reduce((sum, share, k) => sum + share * Math.hypot(...own[k]), 0);
    assert.ok(Math.abs(told.value - expected) <= 1e-6 * expected, `${told.value}, not ${expected}`);
    largest = Math.max(largest, Math.abs(interpolated - expected) / expected);
  }
  assert.ok(largest > 1e-4, "the places tell both apart");
  wellDone();
});

test("A file has all marks that the picture has", async () => {
  await open(solves.body, "crosses=1&nodes=1&field=von_mises");
  const saved = async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "SVG" }).click()]);
    return readFile(await download.path(), "utf8");
  };
  const count = (text, what) => text.split(what).length - 1;
  const all = await saved();
  await page.getByRole("button", { name: "Principal directions" }).click();
  const without = await saved();
  await page.getByRole("button", { name: "Unknowns" }).click();
  const plain = await saved();
  assert.ok(count(all, "<path") > count(without, "<path") + 100);
  assert.ok(count(without, "<path") > count(plain, "<path") + 100);
  const accent = await frame().evaluate((own) => getComputedStyle(own).getPropertyValue("--accent").trim());
  assert.equal(count(plain, `stroke="${accent}"`), 1);
  wellDone();
});

test("Keys read the value in the middle", async () => {
  await open(solves.body);
  await frame().focus();
  await page.keyboard.press("ArrowLeft");
  await eventually(async () => assert.match(await page.locator("figure .readout").first().textContent(), /triangle \d+/));
  wellDone();
});

test("A link that cannot be copied is not said to be", async () => {
  await open(solves.body);
  await page.evaluate(() => Object.defineProperty(navigator, "clipboard", { value: undefined }));
  await page.getByRole("button", { name: "Copy link" }).click();
  await page.getByRole("button", { name: "It is in the address bar" }).waitFor();
  wellDone();
});
