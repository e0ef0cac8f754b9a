// The page against a made-up car, which does what it is told.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { after, before, test } from "node:test";
import { browser as launch, madeUp, open, sleep, state, text, until } from "./bench.mjs";

let browser;
before(async () => (browser = await launch()));
after(() => browser?.close());

// A made-up car and a page on it; both are gone afterwards.
async function watch(t, options) {
  const car = madeUp();
  const opened = await open(browser, await car.address, options);
  t.after(async () => {
    await opened.close();
    await car.kill();
  });
  return { car, ...opened };
}
const isLive = (page) => until("live", text(page, "#status"), (words) => words.startsWith("Live"));
const isKnown = (page) => until("known", () => state(page, "fl"), (is) => is === "tire fine");

test("nothing is called fine before it is known, and live values change", async (t) => {
  const { page, complaints, asked } = await watch(t);
  await isLive(page);
  assert.equal(await text(page, "#headline")(), "Nothing is known of the tires yet");
  assert.doesNotMatch(await text(page, "#tires")(), /fine|ok\b/i);
  await isKnown(page);
  await until("headline", text(page, "#headline"), (words) => words === "All 4 tires are fine");
  const seen = new Set();
  for (let i = 0; i < 12; i++) {
    seen.add((await text(page, ".card.at-fl .card-number")()) + (await text(page, "#subline")()));
    await sleep(250);
  }
  assert.ok(seen.size >= 5, `${seen.size} different values in three seconds`);
  const frames = await page.evaluate(() => [...document.querySelectorAll("canvas")].filter((canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.some((v) => v)).length);
  assert.ok(frames >= 5, `${frames} charts have something on them`);
  assert.deepEqual(complaints, []);
  const home = new URL(page.url()).origin;
  assert.deepEqual(asked.filter((address) => !address.startsWith(home)), []);
  assert.equal(await page.evaluate(() => document.cookie), "");
});

test("what is found beside the pressures is a table and a sentence", async (t) => {
  const { page, complaints } = await watch(t);
  await isLive(page);
  const rows = () => page.locator("#beside-rows tr").allInnerTexts();
  const [, fr, rl] = await until("rows", rows, (texts) => texts.length === 4);
  assert.match(rl, /^Rear left\s+Worn\s+0\.49\s±\s0\.03 of the reference\s+None\s+no force stands out of the road\s+Fine\s+240 kPa$/);
  assert.match(fr, /Drifts\s+240 kPa, off by 21\s±\s4\skPa$/);
  await until("load", text(page, "#load"), (words) => words === "Load learning: half a minute of driving is needed.");
  assert.deepEqual(complaints, []);
});

test("a low tire turns red, with sign and word, and is said once", async (t) => {
  const { page, car } = await watch(t);
  await isKnown(page);
  await page.evaluate(() => {
    window.spoken = [];
    const note = (list) => list.forEach((record) => record.addedNodes.forEach((node) => window.spoken.push(node.textContent)));
    new MutationObserver(note).observe(document.getElementById("spoken-alerts"), { childList: true });
  });
  car.type("low fl");
  await until("front left", () => state(page, "fl"), (is) => is === "tire low");
  for (const other of ["fr", "rl", "rr"]) assert.equal(await state(page, other), "tire fine");
  const [r, g, b] = await page.locator("#tire-fl > rect").evaluate((rect) => getComputedStyle(rect).stroke.match(/\d+/g).map(Number));
  assert.ok(r > 150 && r > 2 * g && r > 2 * b, `the tire is drawn in ${[r, g, b]}`);
  assert.equal(await page.locator("#tire-fl use").getAttribute("href"), "#sign-low");
  assert.equal(await page.locator("#tire-fl .tire-word").textContent(), "LOW");
  await until("headline", text(page, "#headline"), (words) => /^Front left is low: 1[34]\d/.test(words));
  // Of its 138 kPa 2 K of warmth are 1.8: 105 are to be added.
  await until("cold", text(page, "#cards .at-fl .chilled"), (words) => /^13\d cold at -10 C: add 10\d$/.test(words));
  assert.match(await text(page, "#cards .at-rr .chilled")(), /^2[34]\d cold at -10 C$/);
  await sleep(3000);
  assert.equal(await page.locator("#alert-rows tr").count(), 1);
  assert.match(await text(page, "#alert-rows")(), /Front left[\s\S]*Low[\s\S]*150 ± 8 kPa[\s\S]*active/);
  assert.deepEqual(await page.evaluate(() => window.spoken.length), 1);
  car.type("fine fl");
  await until("over", text(page, "#alert-rows"), (words) => !words.includes("active"));
  assert.equal(await page.locator("#alert-rows tr").count(), 1);
});

test("every state has a sign and a word of its own", async (t) => {
  const { page, car } = await watch(t);
  await isKnown(page);
  ["low fl", "over fr", "malfunction rl", "unknown rr"].forEach((line) => car.type(line));
  await until("rear right", () => state(page, "rr"), (is) => is === "tire unknown");
  const signs = await Promise.all(["fl", "fr", "rl", "rr"].map((c) => page.locator(`#tire-${c} use`).getAttribute("href")));
  const words = await Promise.all(["fl", "fr", "rl", "rr"].map((c) => page.locator(`#tire-${c} .tire-word`).textContent()));
  assert.deepEqual([new Set(signs).size, new Set(words).size], [4, 4], `${signs} ${words}`);
  // What is not known shows no number.
  assert.match(await text(page, ".card.at-rl .card-number")(), /–/);
  assert.match(await text(page, "#sensors")(), /stuck/);
});

for (const [line, means] of [["stale", /^Stale/], ["freeze", /^Stale/], ["end", /^Ended/]]) {
  test(`"${line}": old values are shown as old, and recover`, async (t) => {
    const { page, car } = await watch(t);
    await isKnown(page);
    const color = () => page.locator(".card.at-fl .value").evaluate((node) => getComputedStyle(node).color);
    const live = await color();
    car.type(line);
    await until("status", text(page, "#status"), (words) => means.test(words));
    assert.match(await text(page, "#headline")(), /(No data since|The data ended at) \d\d:\d\d:\d\d/);
    assert.match(await text(page, "#last-known")(), /^When last seen: all 4 tires were fine/);
    assert.equal(await text(page, "#tires-title")(), "Tires when last seen");
    assert.notEqual(await color(), live);
    assert.equal(await page.locator("#tire-fl .tire-word").textContent(), "was fine");
    assert.doesNotMatch(await text(page, "#no-alerts")(), /No active warning/);
    car.type("live");
    await isLive(page);
    assert.equal(await color(), live);
  });
}

test("the server is killed and comes back: the page says so and recovers by itself", async (t) => {
  let car = madeUp();
  const address = await car.address;
  const { page, close } = await open(browser, address);
  t.after(async () => {
    await close();
    await car.kill();
  });
  await isKnown(page);
  car.type("low rr");
  await until("rear right", () => state(page, "rr"), (is) => is === "tire low");
  await car.kill();
  await until("status", text(page, "#status"), (words) => /^No connection/.test(words) && /No data since \d\d:\d\d:\d\d/.test(words));
  assert.match(await text(page, "#headline")(), /^No data since \d\d:\d\d:\d\d/);
  assert.match(await text(page, "#last-known")(), /rear right was low/i);
  await sleep(2500);
  car = madeUp(new URL(address).host);
  await car.address;
  const back_ms = Date.now();
  await isLive(page);
  t.diagnostic(`live again ${Date.now() - back_ms} ms after the server`);
  // The new run knows nothing of the old one's warning, nor does the page pretend to.
  await until("rear right", () => state(page, "rr"), (is) => is === "tire fine");
  assert.equal(await page.locator("#alert-rows tr").count(), 0);
});

test("everything can be reached by keyboard, and where one is can be seen", async (t) => {
  const { page, car } = await watch(t);
  await isKnown(page);
  car.type("low fl");
  await until("warning", () => page.locator("#alert-rows tr").count(), (count) => count === 1);
  const stops = [];
  for (let i = 0; i < 25; i++) {
    await page.keyboard.press("Tab");
    const stop = await page.evaluate(() => {
      const node = document.activeElement;
      if (node === document.body) return null;
      const shown = node.matches("input[type=radio]") ? node.nextElementSibling : node;
      const { outlineStyle, outlineWidth } = getComputedStyle(shown), { width, height } = shown.getBoundingClientRect();
      return { name: node.getAttribute("aria-label") || node.textContent.trim().slice(0, 40) || node.id || node.value, seen: outlineStyle !== "none" && parseFloat(outlineWidth) >= 2 && width > 0 && height > 0 };
    });
    if (stop === null) break;
    stops.push(stop);
  }
  const names = stops.map((stop) => stop.name).join(" | ");
  assert.ok(stops.every((stop) => stop.seen), JSON.stringify(stops));
  for (const wanted of ["Skip to the tires", "Color theme", "900", "The same as a table", "Accelerometers", "metrics"]) assert.ok(names.includes(wanted), `${wanted} in ${names}`);
  // The arrows choose the time shown, Enter opens the table.
  await page.locator("input[value='900']").focus();
  await page.keyboard.press("ArrowRight");
  assert.ok(await page.locator("input[value='60']").isChecked());
  await page.locator("summary").focus();
  await page.keyboard.press("Enter");
  await until("table", text(page, "#table-body"), (words) => /newest\s+1\d\d ± /.test(words));
  // The skip link leads to the tires.
  await page.locator(".skip").focus();
  await page.keyboard.press("Enter");
  assert.equal(await page.evaluate(() => document.activeElement.id), "tires");
});

for (const [name, options] of [
  ["desktop", {}],
  ["dark", { colorScheme: "dark" }],
  ["phone", { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true }],
]) {
  test(`${name}: no complaints of axe, nothing sticks out`, async (t) => {
    const { page, car } = await watch(t, options);
    await isKnown(page);
    ["low fl", "over fr", "malfunction rl", "unknown rr"].forEach((line) => car.type(line));
    await until("rear right", () => state(page, "rr"), (is) => is === "tire unknown");
    await page.locator("summary").click();
    await sleep(700);
    const source = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
    const check = async () => {
      await page.evaluate(source);
      const { violations } = await page.evaluate(() => window.axe.run(document, { runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"] }));
      assert.deepEqual(violations.map((v) => [v.id, v.nodes.map((node) => node.html.slice(0, 120) + " " + node.failureSummary)]), []);
    };
    await check();
    car.type("stale");
    await until("stale", text(page, "#status"), (words) => words.startsWith("Stale"));
    await check();
    const { wide, room } = await page.evaluate(() => ({ wide: document.documentElement.scrollWidth, room: innerWidth }));
    assert.ok(wide <= room, `${wide} pixels in ${room}`);
    const cut = await page.evaluate(() => [...document.querySelectorAll("#alert-table, .card, .facts, #status, .panel")].filter((box) => box.scrollWidth > box.clientWidth + 1).map((box) => box.id || box.className));
    assert.deepEqual(cut, []);
  });
}

test("who wants no motion gets none", async (t) => {
  const { page } = await watch(t, { reducedMotion: "reduce" });
  await isLive(page);
  assert.equal(await page.evaluate(() => document.getAnimations().length), 0);
});

for (const [name, options] of [
  ["desktop", {}],
  ["phone", { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true }],
]) {
  test(`${name}: names of somebody else are text, of one direction, and stay in their place`, async (t) => {
    const { page, car, complaints, asked } = await watch(t, options);
    await isKnown(page);
    car.type("hostile");
    await until("name", text(page, "#subline"), (words) => words.includes("<img src=x"));
    for (const line of ["stale", "live", "low fl"]) {
      car.type(line);
      await sleep(700);
      const { made, taken, wide, room, shown } = await page.evaluate(() => ({
        made: document.querySelectorAll("body img, body script").length,
        taken: window.taken,
        wide: document.documentElement.scrollWidth,
        room: innerWidth,
        shown: document.body.innerText,
      }));
      assert.equal(made, 0, line);
      assert.equal(taken, undefined, line);
      assert.ok(wide <= room, `${line}: ${wide} pixels in ${room}`);
      assert.doesNotMatch(shown, /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u202a-\u202e]/, line);
    }
    assert.deepEqual(complaints, []);
    const home = new URL(page.url()).origin;
    assert.deepEqual(asked.filter((address) => !address.startsWith(home)), []);
  });
}

test("a clock that is set back begins anew, and nothing is shown twice or out of order", async (t) => {
  const { page, car, complaints } = await watch(t);
  await isKnown(page);
  car.type("low fl");
  await until("low", () => state(page, "fl"), (is) => is === "tire low");
  await sleep(4000);
  const seconds = async () => Number(/clock ([0-9.]+) s/.exec(await text(page, "#subline")())?.[1]);
  const before = await seconds();
  car.type("back 6");
  await until("clock", seconds, (now) => now < before - 3);
  await isLive(page);
  assert.equal(await state(page, "fl"), "tire low");
  await sleep(2500);
  await page.locator("summary").click();
  const rows = await until("table", () => page.locator("#table-body th").allInnerTexts(), (rows) => rows.length > 0);
  assert.equal(rows.filter((row) => row === "newest").length, 1, String(rows));
  assert.equal(await page.locator("#alert-rows tr").count(), 1);
  // Set back beyond its own beginning.
  car.type("back 100000");
  await until("before the beginning", text(page, "#subline"), (words) => words.includes("−"));
  await isLive(page);
  assert.doesNotMatch(await text(page, "body")(), /NaN|undefined|null/);
  assert.deepEqual(complaints, []);
});
