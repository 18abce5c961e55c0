// Every page in both themes, narrow and wide: nothing sticks out, and axe finds nothing to complain about.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { begin, drawn, end, newPage, violations } from "./browser.js";

let service, browser;
const paths = { start: "/", solves: "/v1/solves", docs: "/docs", example: "/v1/examples/elastic-block" };
before(async () => {
  [service, browser] = await begin();
  const solves = await Promise.all(["elastic-block", "paper-nonconforming"].map(async (name) => service.solve(await service.example(name))));
  Object.assign(paths, { body: `/v1/solves/${solves[0]}`, membrane: `/v1/solves/${solves[1]}`, both: `/v1/solves/${solves[0]}#with=${solves[0]}` });
});
after(() => end(service, browser));

const arrived = { start: ".example", solves: "tbody tr", docs: "section h3", example: ".text" };

// At 4K software takes seconds for a picture: one page with one is enough there.
for (const [theme, width, without] of [["light", 320], ["light", 1280], ["dark", 320], ["dark", 1280], ["dark", 3840, ["membrane", "both", "docs"]]])
  test(`Pages in the ${theme} theme, ${width} pixels wide`, async () => {
    for (const [name, path] of Object.entries(paths).filter(([own]) => !without?.includes(own))) {
      const page = await newPage(browser, { width, height: width < 400 ? 640 : 900, theme });
      await page.goto(service.url + path);
      await (arrived[name] ? page.locator(arrived[name]).first().waitFor() : drawn(page));
      if (name === "example" || name === "start") await page.getByText(/^Ready/).waitFor();
      const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(wide <= 0, `${name} sticks out by ${wide} pixels`);
      const intervals = await page.locator("#certified .scroll").evaluateAll((tables) => tables.slice(0, 1).map((own) => own.scrollWidth - own.clientWidth));
      assert.deepEqual(intervals, ["body", "membrane", "both"].includes(name) ? [0] : [], `${name} hides intervals`);
      if (width !== 3840) assert.deepEqual(await violations(page), [], name);
      if (process.env.SCREENSHOTS) await page.screenshot({ path: `${process.env.SCREENSHOTS}/${name}-${theme}-${width}.png`, fullPage: width < 3840 && name !== "docs" });
      assert.deepEqual(page.faults, [], name);
      await page.context().close();
    }
  });

test("The theme of the system can be overruled, and the choice stays", async () => {
  const page = await newPage(browser, { theme: "light" });
  const ground = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.goto(service.url);
  const light = await ground();
  await page.getByRole("button", { name: "Change between dark and light" }).click();
  const dark = await ground();
  assert.notEqual(dark, light);
  await page.goto(`${service.url}/v1/solves`);
  assert.equal(await ground(), dark);
});
