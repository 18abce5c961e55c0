// The start page, the page of an example, and their editor.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { begin, end, expectWell, newPage } from "./browser.js";

let service, browser, page;
before(async () => {
  [service, browser] = await begin();
  page = await newPage(browser);
});
after(() => end(service, browser));

const wellDone = () => expectWell(page);
const area = () => page.getByLabel("Problem, as JSON");
const write = async (text) => {
  await area().fill("");
  await area().pressSequentially(text);
};
const valid = { model: "membrane", domain: { type: "rectangle", size: [1, 1] }, mesh: { divisions: [4, 4] }, material: { stiffness: 1 }, boundary: { left: { type: "fixed" } }, scheme: "conforming" };

test("The gallery shows every example as a picture", async () => {
  await page.goto(service.url);
  const { examples } = await service.call("/v1/examples");
  await page.waitForFunction((count) => document.querySelectorAll(".example").length === count, examples.length);
  for (const card of await page.locator(".example").all()) {
    await card.scrollIntoViewIfNeeded();
    await card.locator("img").evaluate((image) => image.complete || new Promise((resolve) => { image.onload = resolve; }));
    assert.ok(await card.locator("img").evaluate((image) => image.naturalWidth > 100));
  }
  wellDone();
});

test("An example is solved by one click", async () => {
  await page.goto(service.url);
  await page.getByRole("button", { name: "Solve given-mesh" }).click();
  await page.waitForURL("**/v1/solves/*");
  await page.getByText("succeeded").waitFor();
  wellDone();
});

test("A problem is checked as it is typed, and its faults stand at their places", async () => {
  await page.goto(`${service.url}/v1/examples/elastic-block`);
  await page.getByText(/^Ready: 2.048 triangles, .* unknowns, about .*iB and/).waitFor();
  const text = (await area().inputValue()).replace('"poisson": 0.3', '"poisson": 0.7').replace('"plane": "strain"', '"plane": "strains"');
  await area().fill(text);
  await page.getByText("2 faults:").waitFor();
  assert.deepEqual(await page.locator(".text mark").allTextContents(), ["0.7", '"strains"']);
  assert.ok(await page.getByRole("button", { name: "Solve" }).isDisabled());
  await page.getByRole("button", { name: /^\/material\/plane/ }).click();
  assert.equal(await area().evaluate((own) => own.value.slice(own.selectionStart, own.selectionEnd)), '"strains"');
  await area().fill(text.replace("0.7", "0.2").replace("strains", "stress"));
  await page.getByText(/^Ready: /).waitFor();
  assert.equal(await page.locator(".text mark").count(), 0);
  wellDone();
});

test("A text that is no JSON is marked where it ceases to be", async () => {
  await area().fill('{\n  "model": "membrane",\n  "mesh": {"size": 0..1}\n}');
  await page.getByText("This is no JSON yet.").waitFor();
  await page.getByText(/line 3: /).waitFor();
  wellDone();
});

test("What the service does not read as JSON is marked too, however deep", async () => {
  for (const [text, words, marked] of [
    ['{\n  "mesh": {"size": 1e999}\n}', /line 2: this number is too large/, "1"],
    ['{\n  "a": 1,\n  "a": 2\n}', /line 3: this member is there twice/, '"'],
    ["[".repeat(60000), /line 1: it is nested deeper than 64 levels/, "["]]) {
    await area().fill(text);
    await page.getByText(words).waitFor();
    assert.equal((await page.locator(".text mark").first().textContent())[0], marked);
  }
  wellDone();
});

test("The schema says what may stand at the cursor", async () => {
  await write('{"mo');
  await page.getByRole("option", { name: /^model/ }).waitFor();
  await page.keyboard.press("Tab");
  assert.equal(await area().inputValue(), '{"model": ');
  await page.keyboard.press("Control+ ");
  assert.deepEqual(await page.locator(".offers code").allTextContents(), ['"membrane"', '"elasticity"']);
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await page.keyboard.type(', "domain": {"type": "rectangle", "');
  await page.getByRole("option", { name: /^size/ }).waitFor();
  assert.equal(await page.getByRole("option", { name: /^vertices/ }).count(), 0);
  await page.keyboard.press("Escape");
  assert.ok(await page.locator(".offers").isHidden());
  wellDone();
});

test("An own problem is solved", async () => {
  await page.goto(service.url);
  // The example that comes into the empty editor does not meet what is written.
  await page.getByText(/^Ready/).waitFor();
  await area().fill(JSON.stringify({ ...valid, title: "own" }));
  await page.getByRole("button", { name: "Solve", exact: true }).last().click();
  await page.waitForURL("**/v1/solves/*");
  await page.getByRole("heading", { name: "own" }).waitFor();
  wellDone();
});

test("What is not there is said", async () => {
  await page.goto(`${service.url}/v1/examples/none`);
  await page.getByText("There is no example of this name").waitFor();
  await page.goto(`${service.url}/v1/solves/none`);
  await page.getByRole("alert").waitFor();
  wellDone();
});

test("The interface is shown and can be tried", async () => {
  await page.goto(`${service.url}/docs#validateProblem`);
  const call = page.locator("#validateProblem");
  await call.getByText("Try it").click();
  await call.getByRole("button", { name: "Send" }).click();
  await call.locator("pre").filter({ hasText: /^200/ }).waitFor();
  wellDone();
});
