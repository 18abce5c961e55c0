// Large meshes: how soon there is a picture, how smoothly it turns, and that two million triangles are drawn at all.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { begin, drawn, end, newPage } from "./browser.js";

let service, browser;
before(async () => { [service, browser] = await begin(); });
after(() => end(service, browser));

/// A page that shows a membrane of so many triangles, twice the square of the divisions.
async function shown(divisions) {
  const { id } = await service.call("/v1/solves", "POST", {
    model: "membrane", domain: { type: "rectangle", size: [1, 1] }, mesh: { divisions: [divisions, divisions] }, material: { stiffness: 1 }, load: { body: "x < 0.5 ? 10 : -10" },
    boundary: { left: { type: "fixed" }, right: { type: "fixed" }, bottom: { type: "contact" }, top: { type: "contact" } }, scheme: "nonconforming", solver: { method: "active_set" },
  });
  while (["queued", "running"].includes((await service.call(`/v1/solves/${id}`)).status)) await new Promise((resolve) => setTimeout(resolve, 500));
  const page = await newPage(browser);
  page.setDefaultTimeout(300000);
  await page.addInitScript(() => {
    new MutationObserver((_, observer) => {
      if (!document.querySelector(".ticks li")) return;
      observer.disconnect();
      // What was drawn then is on the screen when the picture after it is begun.
      requestAnimationFrame(() => requestAnimationFrame(() => { window.firstPicture = performance.now(); }));
    }).observe(document, { subtree: true, childList: true });
  });
  await page.goto(`${service.url}/v1/solves/${id}`);
  await drawn(page);
  await page.waitForFunction(() => window.firstPicture);
  return page;
}

/// Pictures a second while it is turned.
const rate = (page, count) => page.evaluate((pictures) => new Promise((resolve) => {
  const frame = document.querySelector(".frame"), begun = performance.now();
  let left = pictures;
  const turn = () => {
    if (left-- === 0) return resolve((1000 * pictures) / (performance.now() - begun));
    frame.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true }));
    requestAnimationFrame(turn);
  };
  turn();
}), count);

test("524 288 triangles: a picture within 2 s of the last byte, ten a second while it turns", async (context) => {
  const page = await shown(512);
  const late = await page.evaluate(() => window.firstPicture - Math.max(...performance.getEntriesByType("resource").filter(({ name }) => name.includes("/result?")).map(({ responseEnd }) => responseEnd)));
  const pictures = await rate(page, 40);
  context.diagnostic(`${Math.round(late)} ms after the last byte, ${pictures.toFixed(1)} pictures a second`);
  assert.ok(late <= 2000, `${late} ms`);
  assert.ok(pictures >= 10, `${pictures} a second`);
  assert.deepEqual(page.faults, []);
  await page.context().close();
});

test("Two million triangles are drawn, and the pointer finds the one that it is on", async (context) => {
  const page = await shown(1000);
  context.diagnostic(`${(await rate(page, 10)).toFixed(1)} pictures a second`);
  assert.equal(await page.evaluate(() => document.querySelector(".frame canvas").getContext("webgl2").getError()), 0);
  const box = await page.locator(".frame").boundingBox();
  await page.mouse.move(box.x + 0.45 * box.width, box.y + 0.47 * box.height);
  const begun = performance.now();
  await page.locator("figure .readout strong").waitFor();
  context.diagnostic(`${Math.round(performance.now() - begun)} ms until the value under the pointer stands there`);
  assert.deepEqual(page.faults, []);
});
