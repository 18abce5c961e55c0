// The list of solves, and texts of clients that look like HTML.

import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { begin, drawn, end, expectWell, newPage, Service } from "./browser.js";

const html = '<img src=x onerror="window.hurt=1"><script>window.hurt=1</script>&amp;"';
const token = "0123456789abcdef0123456789abcdef";
let service, browser, page;
before(async () => {
  [service, browser] = await begin("--workers", "1");
  page = await newPage(browser);
});
after(() => end(service, browser));
const wellDone = () => expectWell(page);
const row = (title) => page.getByRole("row").filter({ hasText: title });
const small = { model: "membrane", domain: { type: "rectangle", size: [1, 1] }, mesh: { divisions: [4, 4] }, material: { stiffness: 1 }, load: { body: -1 }, boundary: { left: { type: "fixed" }, bottom: { type: "contact" } }, scheme: "nonconforming" };
/// Runs until it is cancelled.
const endless = { ...small, mesh: { divisions: [60, 60] }, solver: { method: "uzawa", rho: 1e-9, augmentation: 1, tolerance: 1e-300, max_iterations: 1000000 } };

test("Solves appear, run and end before one's eyes", async () => {
  await page.goto(`${service.url}/v1/solves`);
  await page.getByText("Nothing was posted yet.").waitFor();
  await service.call("/v1/solves", "POST", { ...endless, title: "runs on" });
  await service.call("/v1/solves", "POST", { ...small, title: "waits", tags: ["seal", "b"] });
  await row("runs on").getByText(/iteration [\d\u202f]+/).waitFor();
  await row("waits").getByText("queued").waitFor();
  await row("runs on").getByRole("checkbox").check();
  await page.getByRole("button", { name: "Cancel 1" }).click();
  await row("runs on").getByText("cancelled", { exact: true }).waitFor();
  await row("waits").getByText("succeeded").waitFor();
  await row("waits").getByText(/^[\d.]+ %$/).waitFor();
  wellDone();
});

test("They are picked by status, title and tag", async () => {
  await page.getByLabel("Status").selectOption("succeeded");
  await page.getByText("1 shown").waitFor();
  assert.equal(new URL(page.url()).search, "?status=succeeded");
  await page.getByLabel("Status").selectOption("");
  await page.getByText("2 shown").waitFor();
  await page.getByLabel("Title").fill("RUNS");
  await page.getByText("1 shown").waitFor();
  assert.equal(await row("waits").count(), 0);
  await page.getByLabel("Title").fill("");
  await row("waits").getByRole("link", { name: "seal" }).click();
  await page.getByText("1 shown").waitFor();
  assert.equal(await page.getByLabel("Tag").inputValue(), "seal");
  await page.getByLabel("Tag").fill("none such");
  await page.getByText("None is like that.").waitFor();
  wellDone();
});

test("Several are deleted at once, after a question", async () => {
  await page.goto(`${service.url}/v1/solves`);
  await row("waits").waitFor();
  await page.getByLabel("Choose all").check();
  await page.getByRole("button", { name: "Delete 2" }).click();
  await page.getByRole("button", { name: "Keep" }).click();
  assert.equal((await service.call("/v1/solves")).solves.length, 2);
  await page.getByRole("button", { name: "Delete 2" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Delete" }).click();
  await page.getByText("Nothing was posted yet.").waitFor();
  assert.equal((await service.call("/v1/solves")).solves.length, 0);
  wellDone();
});

test("Titles, tags, names of parts and faults with HTML in them stay texts", async () => {
  const polygon = { type: "polygon", vertices: [[0, 0], [1, 0], [1, 1], [0, 1]], sides: [html, "b", "c", "d"] };
  const problem = { ...small, title: html, tags: ["<b>bold</b>"], domain: polygon, mesh: { size: 0.3 }, boundary: { c: { type: "fixed" }, [html]: { type: "contact" } } };
  const id = await service.solve(problem);
  const failed = await service.call("/v1/solves?wait=60", "POST", { ...problem, title: `fails ${html}`, boundary: { [html]: { type: "contact" } }, load: { body: 1 } });
  assert.equal(failed.status, "failed");
  await page.goto(`${service.url}/v1/solves`);
  await page.getByRole("link", { name: html, exact: true }).waitFor();
  await page.getByRole("link", { name: "<b>bold</b>" }).first().waitFor();
  await page.goto(`${service.url}/v1/solves/${failed.id}`);
  await page.getByRole("heading", { name: `fails ${html}` }).waitFor();
  await page.goto(`${service.url}/v1/solves/${id}`);
  await drawn(page);
  await page.locator("#contact").getByRole("heading", { name: html }).waitFor();
  await page.goto(`${service.url}/v1/examples/gap-sweep`);
  await page.getByLabel("Problem, as JSON").fill(JSON.stringify({ ...small, [html]: 1 }));
  await page.locator(".faults").getByText("<img src=x onerror").waitFor();
  assert.equal(await page.evaluate(() => window.hurt), undefined);
  assert.equal(await page.locator("img[src=x], #main script, #main b").count(), 0);
  wellDone();
});

/// Asks for `token`, and ends with the test, also if that fails: a process that lives holds the run for ever.
async function guardedService(test) {
  const directory = mkdtempSync(join(tmpdir(), "pages-"));
  const file = join(directory, "tokens");
  writeFileSync(file, `${token}\n`);
  const guarded = await Service.start("--token-file", file);
  test.after(async () => { await guarded.end(); rmSync(directory, { recursive: true }); });
  return guarded;
}

test("A token is asked for once", async (test) => {
  const guarded = await guardedService(test);
  const own = await newPage(browser);
  await own.goto(`${guarded.url}/v1/solves`);
  await own.getByLabel("Token").fill("wrong-but-long-enough");
  await own.getByRole("button", { name: "Go on" }).click();
  await own.getByText("holds none of the tokens").waitFor();
  await own.getByLabel("Token").fill(token);
  await own.getByRole("button", { name: "Go on" }).click();
  await own.getByText("Nothing was posted yet.").waitFor();
  await own.goto(`${guarded.url}/v1/examples/given-mesh`);
  await own.getByText(/^Ready: /).waitFor();
  await own.getByRole("button", { name: "Solve" }).click();
  await own.getByText("succeeded").waitFor();
  await drawn(own);
  assert.deepEqual(own.faults, []);
});

test("A token can be given up and forgotten, and only what a request can carry is taken", async (test) => {
  const guarded = await guardedService(test);
  const own = await newPage(browser);
  await own.goto(`${guarded.url}/v1/examples/given-mesh`);
  await own.getByLabel("Token").fill("schlüssel-ключ");
  await own.getByRole("button", { name: "Go on" }).click();
  assert.equal(await own.evaluate(() => sessionStorage.getItem("token")), null);
  await own.keyboard.press("Escape");
  await own.getByRole("alert").getByText("This service wants a token").waitFor();
  await own.reload();
  await own.getByLabel("Token").fill(token);
  await own.getByRole("button", { name: "Go on" }).click();
  await own.getByText(/^Ready: /).waitFor();
  await own.getByRole("button", { name: "Forget token" }).click();
  await own.getByLabel("Token").waitFor();
  assert.equal(await own.evaluate(() => sessionStorage.getItem("token")), null);
  assert.ok(await own.getByRole("button", { name: "Forget token" }).isHidden());
  assert.deepEqual(own.faults, []);
});

test("A title without a blank leaves the other columns in their places, and one that turns the writing only itself", async () => {
  const problem = { ...(await service.example("given-mesh")) };
  for (const title of ["W".repeat(200), "a" + "\u0300".repeat(180), "\u202eotua .tpircs \u2066 end"]) await service.solve({ ...problem, title, tags: ["wide"] });
  for (const width of [820, 1280, 3840]) {
    await page.setViewportSize({ width, height: 900 });
    await page.goto(`${service.url}/v1/solves?tag=wide`);
    await page.waitForFunction(() => document.querySelectorAll(".solves tbody tr").length === 3);
    const sides = await page.evaluate(() => [document.querySelector(".solves").closest(".card, .flush").getBoundingClientRect().right, ...[...document.querySelectorAll(".solves td")].map((own) => own.getBoundingClientRect().right)]);
    assert.ok(sides.every((side) => side <= sides[0] + 1), `${width}: ${sides}`);
  }
  await page.setViewportSize({ width: 1280, height: 900 });
  const [own] = (await service.call("/v1/solves?tag=wide&limit=1")).solves;
  await page.goto(`${service.url}/v1/solves/${own.id}`);
  await drawn(page);
  await page.getByRole("button", { name: "Delete" }).click();
  assert.equal(await page.locator("dialog bdi").textContent(), own.title);
  await page.getByRole("dialog").getByRole("button", { name: "Keep" }).click();
  wellDone();
});

test("A solve is deleted on its page when that is confirmed", async () => {
  const id = await service.solve(await service.example("given-mesh"));
  await page.goto(`${service.url}/v1/solves/${id}`);
  await drawn(page);
  await page.getByRole("button", { name: "Delete" }).click();
  await page.keyboard.press("Escape");
  assert.equal((await service.call(`/v1/solves/${id}`)).status, "succeeded");
  await page.getByRole("button", { name: "Delete" }).click();
  await page.getByRole("dialog").getByRole("button", { name: "Delete" }).click();
  await page.waitForURL(`${service.url}/v1/solves`);
  await assert.rejects(service.call(`/v1/solves/${id}`), /404/);
  wellDone();
});

test("Parts may have any name", async () => {
  const square = { type: "polygon", vertices: [[0, 0], [1, 0], [1, 1], [0, 1]], sides: ["__proto__", "constructor", "toString", "top"] };
  const boundary = JSON.parse('{"__proto__": {"type": "contact", "gap": 0.01}, "constructor": {"type": "traction", "pressure": 0}, "toString": {"type": "fixed"}, "top": {"type": "fixed"}}');
  const id = await service.solve({ ...(await service.example("elastic-block")), domain: square, mesh: { size: 0.3 }, boundary });
  await page.goto(`${service.url}/v1/solves/${id}`);
  await drawn(page);
  await page.locator("#contact").getByText("__proto__").first().waitFor();
  wellDone();
});
