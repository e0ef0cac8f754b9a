// The monitor itself: a simulated puncture, replayed faster than it was.

import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { after, before, test } from "node:test";
import { browser as launch, folder, itpms, open, sleep, state, text, until } from "./bench.mjs";

let browser;
before(async () => (browser = await launch()));
after(() => browser?.close());

test("a puncture in a replay turns the front left tire red, and is warned of once", { skip: !process.env.ITPMS && "no itpms" }, async (t) => {
  const room = folder();
  const made = spawnSync(process.env.ITPMS, ["--quiet", "simulate", "drive-puncture", "--seed", "1", "-o", "drive.csv", "--vehicle-out", "car.toml"], { cwd: room.path });
  assert.equal(made.status, 0, String(made.stderr));
  const monitor = itpms(["monitor", "--replay", "drive.csv", "--vehicle", "car.toml", "--speed", "5", "--http", "127.0.0.1:0"], { cwd: room.path });
  const { page, complaints, close } = await open(browser, await monitor.address);
  t.after(async () => {
    await close();
    await monitor.kill();
    room.remove();
  });
  const reds = new Set();
  await until("front left", async () => {
    for (const corner of ["fl", "fr", "rl", "rr"]) if ((await state(page, corner)) === "tire low") reds.add(corner);
    return [...reds];
  }, (seen) => seen.includes("fl"), 60000);
  await until("warning", () => page.locator("#alert-rows tr[data-kind='under-inflated']").count(), (count) => count === 1);
  // To the end of the drive: the fast leak may be said as well, the low tire not again, and no other wheel.
  await until("end", text(page, "#status"), (words) => /^(Ended|No connection)/.test(words), 60000);
  await sleep(500);
  assert.equal(await page.locator("#alert-rows tr[data-kind='under-inflated']").count(), 1);
  assert.deepEqual(await page.locator("#alert-rows tr:not([data-wheels='fl'])").count(), 0);
  for (const other of ["fr", "rl", "rr"]) assert.notEqual(await state(page, other), "tire low");
  assert.match(await text(page, "#last-known")(), /front left was low: 1[34]\d/);
  assert.deepEqual(complaints.filter((words) => !/ERR_(CONNECTION|INCOMPLETE)/.test(words)), []);
});
