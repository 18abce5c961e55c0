// The history of a solve while it runs, and a service that dies under an open page.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { begin, end, newPage } from "./browser.js";

let service, browser;
before(async () => { [service, browser] = await begin(); });
after(() => end(service, browser));

/// The paper's iteration, whose every step takes a while.
const slow = (divisions, ending) => ({
  model: "membrane", domain: { type: "rectangle", size: [1, 1] }, mesh: { divisions: [divisions, divisions] }, material: { stiffness: 1 }, load: { body: "x < 0.5 ? 10 : -10" },
  boundary: { left: { type: "fixed" }, right: { type: "fixed" }, bottom: { type: "contact" }, top: { type: "contact" } }, scheme: "nonconforming",
  solver: { method: "uzawa", rho: 0.002, augmentation: 1, tolerance: 1e-12, ...ending },
});

/// Iterations in the table of the page.
async function rowsOf(own) {
  const details = own.locator("#history details");
  if (!(await details.evaluate((each) => each.open))) await details.locator("summary").click();
  await own.locator("#history tbody tr").first().waitFor();
  return (await own.locator("#history tbody tr td:first-child").allInnerTexts()).map((text) => Number(text.replaceAll("\u202f", "")));
}

const kIterations = 400;  // so many that most of them come while the page is open

/// The longest time in ms from the event of a row to its picture, beyond that by which a timer is late.
async function latestRow() {
  const page = await newPage(browser), { id } = await service.call("/v1/solves", "POST", slow(140, { max_iterations: kIterations }));
  // Listens beside the page, and looks when its rows are drawn, by the same clock.
  await page.addInitScript(() => {
    window.came = [];
    window.seen = [];
    // By how much the machine itself is late: other programs may hold it.
    window.lag = 0;
    const tick = () => {
      const due = performance.now() + 50;
      setTimeout(() => requestAnimationFrame(() => { window.lag = Math.max(window.lag, performance.now() - due); tick(); }), 50);
    };
    tick();
    new MutationObserver(() => {
      const rows = Number(document.querySelector("#history [data-rows]")?.dataset.rows ?? 0);
      requestAnimationFrame(() => { for (let i = window.seen.length; i < rows; ++i) window.seen.push(performance.now()); });
    }).observe(document, { subtree: true, childList: true, attributes: true, attributeFilter: ["data-rows"] });
    const events = new EventSource(`${location.pathname}/events`);
    events.addEventListener("progress", ({ data }) => { if (JSON.parse(data).history) window.came.push(performance.now()); });
    events.addEventListener("failed", () => events.close());
  });
  await page.goto(`${service.url}/v1/solves/${id}`);
  await page.getByText(`It ended as iteration limit after ${kIterations} iterations.`).waitFor({ timeout: 60000 });
  // Rows from before the page listened come in one piece.
  const lag = await page.evaluate(() => window.lag);
  const late = await page.evaluate(() => window.seen.map((time, i) => [time, window.came[i]]).filter(([, came]) => came > window.seen[0]).map(([time, came]) => time - came));
  assert.ok(late.length > 10);
  assert.equal(String(await rowsOf(page)), String(Array.from({ length: kIterations }, (_, i) => i + 1)));
  assert.deepEqual(page.faults, []);
  await page.context().close();
  return Math.max(...late) - lag;
}

test("A row is on the screen at most 250 ms after its event", async () => {
  const tries = [];
  // Once more where other programs hold the machine.
  while (tries.length < 3 && !(Math.min(...tries) <= 250)) tries.push(await latestRow());
  assert.ok(Math.min(...tries) <= 250, `${tries} ms`);
});

test("A service that is killed and started again under an open page loses no row, and tells none twice", async () => {
  const own = await newPage(browser);
  // It runs for so long on any machine.
  const { id } = await service.call("/v1/solves", "POST", slow(100, { max_iterations: 1000000, time_limit: 12 }));
  await own.goto(`${service.url}/v1/solves/${id}`);
  await own.waitForFunction(() => Number(document.querySelector("#history [data-rows]")?.dataset.rows) > 5, null, { timeout: 60000 });
  await service.kill();
  await own.getByText("The service cannot be reached").waitFor();
  await service.begin();
  await own.getByText(/It ended as time limit after/).waitFor({ timeout: 60000 });
  const { history } = await service.call(`/v1/solves/${id}/history`);
  assert.equal(String(await rowsOf(own)), String(history.iteration));
  await service.kill();
  await service.begin();
  await own.reload();
  await own.getByText(/It ended as time limit after/).waitFor();
  assert.equal(String(await rowsOf(own)), String(history.iteration));
  assert.deepEqual(own.faults, []);
});
